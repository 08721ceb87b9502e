"""Shared by the cases: runs by `gneiss sweep`, stored under their hashes, and their readings."""
import csv
import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

import study


@dataclass
class Axis:
    """A setting that is varied alone, or several when `settings` sets several keys: values, and for each the keys of the scene. `quick`: the values
    of the quick form (none: left out there). A new axis needs only its line in the table of its case."""
    name: str
    values: list
    settings: object  # value -> {key: value}
    quick: list = field(default_factory=list)
    seeds: int = 0
    quick_seeds: int = 2

    def taken(self, quick):
        return self.quick if quick else self.values


def key(name):
    """Settings of an axis that is one key."""
    return lambda value: {name: value}


class Row:
    """A run: `value` of its axis, seed and results."""

    def __init__(self, axis, value, record, folder, terms):
        self.axis, self.value, self.seed, self.folder = axis, value, int(record["seed"]), folder
        self.status, self.message, self.terms = record["status"], record["message"], terms
        path = folder / "summary.json"
        self.summary = json.loads(path.read_text()) if path.exists() else {}

    @property
    def done(self):
        return self.status == "done" and bool(self.summary)

    def __getitem__(self, name):
        """Returns a reading, count, term of the ledger or cost; not a number if the run does not have it."""
        places = ({**self.terms, **self.summary.get("readings", {})}, self.summary.get("counts", {}), self.summary)
        for place in places:
            if name in place:
                return float("nan") if place[name] is None else place[name]
        return float("nan")

    @property
    def seconds(self):
        return self.summary["seconds"]["cpu"] if self.summary else float("nan")

    def results(self, path):
        with h5py.File(self.folder / "results.h5", "r") as file:
            return np.asarray(file[path][()])


class Study:
    """Folder of the runs, sections and numbers of a study. `quick`: the form that takes seconds."""

    def __init__(self, folder, quick):
        self.folder, self.quick, self.rows = Path(folder), quick, []

    def path(self, *names):
        path = self.folder.joinpath(*names)
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def file(self, name, text):
        """A file of the study, written only when it changes."""
        path = self.path(name)
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
        return path

    def call(self, arguments):
        """The program. Every run makes its packing anew, so that its cost is included."""
        environment = dict(os.environ, OMP_WAIT_POLICY="passive", GNEISS_CACHE="off")
        done = subprocess.run([study.PROGRAM, *map(str, arguments)], env=environment, text=True, capture_output=True)
        if done.returncode not in (0, 5):
            sys.exit(f"accuracy: gneiss {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stderr[-2000:]}")
        return done

    def sweep(self, case, name, scene, columns, seeds=0, readings=("energy.residual",)):
        """Runs of a scene (a dict) with columns {key: values}, row by row; the rows of the sweep's table in that order."""
        scene_file = self.file(f"{case}/{name}-scene.yaml", json.dumps(scene, indent=1))
        keys = {"scene": str(scene_file), "combine": "zipped", "parameters": columns, "readings": list(readings)}
        if seeds:
            keys["seeds"] = seeds
        out, sweep_file = self.path(case, "runs"), self.file(f"{case}/{name}.yaml", json.dumps(keys, indent=1))
        print(f"accuracy: {case}, {name}", file=sys.stderr, flush=True)
        self.call(["sweep", sweep_file, "--out", out, "--jobs", 1, "--threads", 1, "--quiet"])
        with open(out / "sweep.csv", newline="", encoding="utf-8") as file:
            records = list(csv.DictReader(file))
        with h5py.File(out / "sweep.h5", "r") as file:
            terms = {reading: file[f"readings/{reading}"][()] for reading in file["readings"]}
        return records, out, terms

    def axis(self, case, scene, axis, **options):
        """Returns the rows of an axis: for every value and every seed."""
        values = axis.taken(self.quick)
        if not values:
            return []
        settings = [axis.settings(value) for value in values]
        keys = list(settings[0])
        seeds = (self.quick_seeds_of(axis) if self.quick else axis.seeds)
        columns = {k: [s[k] for s in settings] for k in keys}
        records, out, terms = self.sweep(case, axis.name, scene, columns, seeds=seeds, **options)
        each = max(1, seeds)
        rows = [Row(axis.name, values[k // each], record, out / record["folder"],
                    {name: float(column[k]) for name, column in terms.items()}) for k, record in enumerate(records)]
        self.rows += [(case, row) for row in rows]
        for row in rows:
            if not row.done:
                print(f"accuracy: {case}, {axis.name} {row.value}: {row.status}: {row.message}", file=sys.stderr)
        return [row for row in rows if row.done]

    @staticmethod
    def quick_seeds_of(axis):
        return axis.quick_seeds if axis.seeds else 0

    def packed(self, name, scene, shake=0):
        """File of the packing that a scene asks for; `shake`: every coordinate changed by a relative 1e-12 at most."""
        request = self.file(f"specimens/{name}.yaml", json.dumps(scene, indent=1))
        out = self.path("specimens", name)
        if not (out / "packing.txt").exists():
            self.call(["pack", request, "--out", out, "--quiet", "--threads", 1])
        if not shake:
            return out / "packing.txt"
        rows = np.loadtxt(out / "packing.txt")
        rows[:, :-1] *= 1 + 1e-12 * np.random.default_rng(shake).uniform(-1, 1, rows[:, :-1].shape)
        text = "".join(" ".join(repr(v) for v in row) + "\n" for row in rows.tolist())
        return self.file(f"specimens/{name}-shaken-{shake}.txt", text)


# --- time that YADE would need ----------------------------------------------------------------------------

def yade():
    """Measured on rock-a, one thread each (docs/evidence/performance.md): M bond-steps/s of YADE, and its steps over ours."""
    text = (study.ROOT / "docs" / "evidence" / "performance.md").read_text()

    def number(pattern):
        found = re.search(pattern, text)
        if not found:
            sys.exit(f"accuracy: docs/evidence/performance.md has no {pattern}")
        return float(found.group(1).replace(" ", ""))

    rate = 1e6 * number(r"\| YADE -j1 \| ([\d.]+) \|")
    particles, bonds = number(r"\| rock-a [^|]*\| ([\d ]+) \|"), number(r"rock-a, (\d+) bonds, elastic part")
    longer = number(r"\| YADE -j1, estimate \| (\d+) \|") / number(r"\| gneiss, 2 threads, from start to failure \| (\d+) \|")
    return {"particle_steps": rate * particles / bonds, "longer": longer}
