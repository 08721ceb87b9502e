"""Quality of packings, their time, their differences from seed to seed, and beside YADE's.

    /usr/bin/python3 validate/packing_study.py --gneiss build/gneiss [--yade] [--quick] --out FOLDER

Leaves packing.md, one CSV file per table and the pictures in FOLDER; docs/evidence/packing.md is made from them by hand.
Runs are kept in FOLDER/runs and reused while program and settings stay the same. --quick: smaller and fewer; --parts picks some of cases, time, seeds, peers.
About twenty minutes of two cores, --yade ten more. GNEISS_CACHE is off: every packing is made and timed.
"""
import argparse
import csv
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import packing_measures as measures
import study

SCENE = study.ROOT / "scenes" / "ucs-packed.yaml"
YADE_SCRIPT = study.ROOT / "validate" / "peers" / "yade_pack.py"
SMALL_OVERLAP = 0.007  # overlap_size that stands in when none keeps every overlap below 2 %
YADE_RADIUS = 0.59e-3  # about 10 000 of them stay in the cylinder
PARTS = ("cases", "time", "seeds", "peers")
INK, BLUE, RED, GREY, GREEN = "#22303c", "#2b6cb0", "#c8402f", "#9aa5ad", "#3a7d44"

ROCK = "cylinder: {diameter: 23 mm, height: 46 mm}"
ROUND = "cylinder: {diameter: 50 mm, height: 50 mm}"


# --- runs -------------------------------------------------------------------------------------------------


def program_hash(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


def peak_memory(pid):
    """kB, of a running process; 0 when it is gone. (ru_maxrss would count what Python held when it forked.)"""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("VmHWM")), 0)


class Runner:
    """Runs programs one at a time; time and memory of each are stored in FOLDER/runs/<name>/record.json."""

    def __init__(self, options):
        self.options, self.out = options, Path(options.out).resolve()
        self.gneiss = str(Path(options.gneiss).resolve())
        self.hash = program_hash(self.gneiss)
        self.environment = dict(os.environ, GNEISS_CACHE="off", QT_QPA_PLATFORM="offscreen")

    def spend(self, folder, command, limit, extra):
        """Runs a command in a folder; returns exit code, output, time and memory. code None: the limit was reached."""
        begun, load = time.monotonic(), os.getloadavg()[0]
        with open(folder / "stdout", "w+") as out, open(folder / "stderr", "w+") as err:
            child = subprocess.Popen(command, cwd=folder, env=dict(self.environment, **extra), stdout=out, stderr=err)
            code, memory = None, 0
            while True:
                memory = max(memory, peak_memory(child.pid))
                pid, status, usage = os.wait4(child.pid, os.WNOHANG)
                if pid:
                    child.returncode = code = os.waitstatus_to_exitcode(status)
                    break
                if time.monotonic() - begun > limit:
                    child.kill()
                    _, _, usage = os.wait4(child.pid, 0)
                    child.returncode = -9
                    break
                time.sleep(0.02)
        return {"code": code, "wall": time.monotonic() - begun, "cpu": usage.ru_utime + usage.ru_stime,
                "memory_mb": memory / 1024, "load_before": load}

    def cached(self, name, asked, work):
        folder = self.out / "runs" / name
        note = folder / "record.json"
        if note.exists() and not self.options.fresh:
            record = json.loads(note.read_text())
            if record["asked"] == json.loads(json.dumps(asked)):
                return folder, record
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        record = {"asked": asked, **work(folder)}
        note.write_text(json.dumps(record, indent=1))
        return folder, record

    def pack(self, name, specimen, dimension=3, seed=1):
        """Packs; the JSON line of `gneiss pack` with what the process used, and `rows` of x y z r."""
        text = f"dimension: {dimension}\nspecimen:\n" + "".join(f"  {line}\n" for line in specimen.splitlines())

        def work(folder):
            (folder / "body.yaml").write_text(text)
            command = [self.gneiss, "pack", "body.yaml", "--out", ".", "--seed", str(seed), "--log", "json",
                       "--threads", str(self.options.threads)]
            used = self.spend(folder, command, 3600, {})
            if used["code"] != 0:
                sys.exit(f"{name}: exit code {used['code']}\n{(folder / 'stderr').read_text()}")
            used["quality"] = json.loads((folder / "stdout").read_text().splitlines()[-2])["result"]
            for other in folder.glob("particles*"):
                other.unlink()
            return used

        asked = {"text": text, "seed": seed, "threads": self.options.threads, "program": self.hash}
        key = hashlib.sha256(f"{text}{seed}".encode()).hexdigest()[:12]  # one packing serves several tables
        folder, record = self.cached(f"pack-{key}", asked, work)
        figures = {**record["quality"], **{k: record[k] for k in ("wall", "cpu", "memory_mb", "load_before")}}
        say(f"{name}: e {100 * figures['porosity']:.2f} %, n_c {figures['coordination_1']:.2f} at 1 %, "
            f"{figures['seconds']:.1f} s")
        return figures, folder / "packing.txt"

    def crush(self, name, seed, settings):
        """Readings of scenes/ucs-packed.yaml with `settings`; history as (strain, stress)."""
        settings = {"output.snapshots": 0, "output.checkpoint": "off", "run.seed": seed, **settings}

        def work(folder):
            command = [self.gneiss, "run", str(SCENE), "--force", "--quiet", "--out", str(folder / "run"), "--threads",
                       str(self.options.threads), *study.set_arguments(settings)]
            used = self.spend(folder, command, 3600, {})
            if used["code"] != 0:
                sys.exit(f"{name}: exit code {used['code']}\n{(folder / 'stderr').read_text()}")
            return {**used, "summary": json.loads((folder / "run" / "summary.json").read_text())}

        asked = {"settings": settings, "scene": SCENE.read_text(), "threads": self.options.threads,
                 "program": self.hash}
        folder, record = self.cached(name, asked, work)
        summary = record["summary"]
        say(f"{name}: UCS {summary['readings']['peak_stress'] / 1e6:.1f} MPa, {summary['seconds']['total']:.0f} s")
        return summary, folder / "run" / "results.h5"

    def yade(self, name, cell, seed=1):
        """YADE's packing; record has its result, or says that the time limit was reached."""

        def work(folder):
            settings = {"OUT": "packing.txt", "RESULT": "result.json", "RADIUS": repr(YADE_RADIUS), "FUZZ": "0.3",
                        "CELL": str(cell), "DIAMETER": repr(measures.DIAMETER), "HEIGHT": repr(measures.HEIGHT),
                        "SEED": str(seed)}
            command = ["yade", "-n", "-x", f"-j{self.options.threads}", str(YADE_SCRIPT)]
            used = self.spend(folder, command, self.options.yade_limit, settings)
            result = folder / "result.json"
            return {**used, "result": json.loads(result.read_text()) if result.exists() else None}

        asked = {"cell": cell, "seed": seed, "radius": YADE_RADIUS, "threads": self.options.threads,
                 "limit": self.options.yade_limit, "script": YADE_SCRIPT.read_text()}
        folder, record = self.cached(name, asked, work)
        say(f"{name}: {record['result'] or 'no packing after %.0f s' % record['wall']}")
        return record, folder / "packing.txt"


def say(text):
    print(text, file=sys.stderr, flush=True)


# --- the document -------------------------------------------------------------------------------------------


class Document:
    def __init__(self, out):
        self.out, self.text = Path(out), []

    def add(self, text):
        self.text.append(text)

    def table(self, name, head, rows, raw=None):
        """Writes the table as Markdown, and as FOLDER/<name>.csv: `raw` (dictionaries with full digits) where it is given."""
        self.text.append(study.table(head, rows))
        with open(self.out / f"{name}.csv", "w", newline="", encoding="utf-8") as out:
            if raw:
                writer = csv.DictWriter(out, list(dict.fromkeys(key for row in raw for key in row)))
                writer.writeheader()
                writer.writerows(raw)
            else:
                csv.writer(out).writerows([head, *rows])

    def picture(self, figure, name, caption):
        figure.tight_layout()
        figure.savefig(self.out / f"{name}.png", dpi=100)
        plt.close(figure)
        self.text.append(f"![{caption}]({name}.png)\n\n{caption}")

    def write(self):
        (self.out / "packing.md").write_text("\n\n".join(self.text) + "\n")


def percent(x, digits=2):
    return f"{100 * x:.{digits}f}"


FIGURES = [("e %", lambda q: percent(q["porosity"])), ("e %, lenses once", lambda q: percent(q["porosity_net"])),
           ("n_c 0.1 %", lambda q: f"{q['coordination_01']:.2f}"), ("1 %", lambda q: f"{q['coordination_1']:.2f}"),
           ("5 %", lambda q: f"{q['coordination_5']:.2f}"),
           ("fabric eigenvalues", lambda q: f"{q['fabric_min']:.4f} to {q['fabric_max']:.4f}"),
           ("off isotropic %", lambda q: percent(q["anisotropy"])),
           ("overlap median %", lambda q: percent(q["overlap_median"])), ("max %", lambda q: percent(q["overlap_max"]))]
PROCESS = [("r_max/r_min", lambda q: f"{q['radius_ratio']:.1f}"),
           ("inner 98 %", lambda q: f"{q['radius_ratio_98']:.1f}"),
           ("variation of r", lambda q: f"{q['radius_variation']:.3f}"),
           ("floating %", lambda q: percent(q["floating"])),
           ("protrusion % r", lambda q: percent(q["wall_protrusion"])), ("iterations", lambda q: q["iterations"]),
           ("s", lambda q: f"{q['seconds']:.2f}"), ("CPU s", lambda q: f"{q['cpu']:.2f}"),
           ("peak MB", lambda q: f"{q['memory_mb']:.0f}"), ("load before", lambda q: f"{q['load_before']:.1f}")]


# --- 1: the cases -------------------------------------------------------------------------------------------


def find_overlap_size(runner, particles):
    """The largest overlap_size, in steps of 0.1 % from 1.2 % down to 0, whose largest overlap stays at or below 2 %
    for every seed; None when there is none."""
    tried = []
    for tenths in range(12, -1, -1):
        size = tenths / 1000
        worst, seeds = 0.0, 0
        for seed in runner.options.seeds:
            body = rock(particles, f"overlap: passive, overlap_size: {size}")
            q, _ = runner.pack(f"two-{tenths}-{seed}", body, 3, seed)
            worst, seeds = max(worst, q["overlap_max"]), seeds + 1
            if q["overlap_max"] > 0.02:
                break
        tried.append([f"{size * 100:.1f}", percent(worst), seeds, "yes" if worst <= 0.02 else "no"])
        if worst <= 0.02:
            return size, tried
    return None, tried


def rock(particles, packing=""):
    return f"{ROCK}\nparticles: {particles}" + (f"\npacking: {{{packing}}}" if packing else "")


def below(key, reach, aim, text, scale=100.0):
    return text, key, "<=", reach, aim, scale


def above(key, reach, aim, text):
    return text, key, ">=", reach, aim, 1.0


def cases(quick, size, beam):
    """(name, title, dimension, specimen, questions: (text, figure, sense, reach, aim, scale))."""
    n = (lambda k: max(1000, k // 10)) if quick else (lambda k: k)
    size = SMALL_OVERLAP if size is None else size
    seconds = ("seconds as printed", "seconds", "<=", None)
    return [
        ("square", f"2D square 100 mm, {n(56000)} discs, size_ratio 10", 2,
         f"rectangle: {{width: 100 mm, height: 100 mm}}\nparticles: {n(56000)}\npacking: {{size_ratio: 10}}",
         [below("porosity", 9.1, 9.0, "e %"), above("coordination_01", None, None, "n_c at 0.1 %"),
          above("coordination_1", 5.9, 5.97, "n_c at 1 %"), (*seconds, 5, 1.0)]),
        ("round", f"3D cylinder 1 x 1, {n(30000)} spheres, size_ratio 9 as published", 3,
         f"{ROUND}\nparticles: {n(30000)}\npacking: {{size_ratio: 9}}",
         [below("porosity", 31, None, "e %"), above("coordination_01", None, None, "n_c at 0.1 %"),
          above("coordination_1", 8.2, None, "n_c at 1 %"),
          above("coordination_5", 8.2, None, "n_c at 5 %"), below("anisotropy", 1, None, "off isotropic %"),
          (*seconds, 10, 1.0)]),
        ("rock-two", f"3D cylinder 23 x 46 mm, {n(10000)} spheres, overlap passive, overlap_size {100 * size:.1f} %", 3,
         rock(n(10000), f"overlap: passive, overlap_size: {size}"),
         [below("porosity", 33, 30, "e %"), above("coordination_1", 8.2, 9, "n_c at 1 %"),
          below("overlap_max", 2, 2, "largest overlap %"), (*seconds, 5, 1.0)]),
        ("rock-passive", "the same, overlap passive as it comes", 3, rock(n(10000), "overlap: passive"),
         [below("porosity", 24, 24, "e %"), above("coordination_1", 9.5, None, "n_c at 1 %"),
          above("coordination_5", None, 11, "n_c at 5 %"), below("overlap_median", 5, 2.5, "median overlap %"),
          below("overlap_max", 13, 6.5, "largest overlap %"), (*seconds, 5, 1.0)]),
        ("rock-half", "the same, size_ratio 12, overlap_size 2.4 %: half the overlap", 3,
         rock(n(10000), "overlap: passive, overlap_size: 0.024, size_ratio: 12"),
         [below("porosity", 24, 24, "e %"), above("coordination_1", 9.5, None, "n_c at 1 %"),
          below("overlap_median", 5, 2.5, "median overlap %"), below("overlap_max", 13, 6.5, "largest overlap %")]),
        ("rock-none", "the same, no overlaps (not in the list)", 3, rock(n(10000)), []),
        ("wide", f"3D cylinder 1 x 1, {n(30000)} spheres, size_ratio 15", 3,
         f"{ROUND}\nparticles: {n(30000)}\npacking: {{size_ratio: 15}}",
         [below("anisotropy", 2, None, "off isotropic %"), above("radius_ratio", 10, None, "r_max/r_min (about 10)"),
          above("radius_ratio_98", 10, None, "the same without the outer 1 %")]),
        ("block", "3D block 40 x 40 x 30 mm, mean_radius 0.9 mm, refined to 0.33 at its upper face over 20 mm", 3,
         "box: {size: [40 mm, 40 mm, 30 mm]}\nmean_radius: 0.9 mm\npacking: {refine: [{from: [0, 0, 30 mm], "
         "to: [40 mm, 40 mm, 30 mm], size: 0.33, distance: 20 mm}]}",
         [below("layer_rms", 5, None, "rms gap of the outer layer, % r"),
          below("wall_protrusion", 5, None, "largest protrusion, % r")]),
        ("beam", f"3D notched beam 160 x 40 x 40 mm from STL, {n(20000)} spheres", 3,
         f"surface: {beam}\nscale: 1e-3\nparticles: {n(20000)}",
         [below("layer_rms", 5, None, "rms gap of the outer layer, % r"),
          below("wall_protrusion", 5, None, "largest protrusion, % r")]),
        ("many", f"3D cylinder 1 x 1, {n(300000)} spheres", 3, f"{ROUND}\nparticles: {n(300000)}",
         [(*seconds, 120, 1.0)]),
    ]


def verdict(sense, limit, value):
    if limit is None:
        return ""
    return "yes" if (value <= limit if sense == "<=" else value >= limit) else "no"


def bound(sense, limit):
    return "" if limit is None else f"{'≤' if sense == '<=' else '≥'} {limit:g}"


def layer_row(name, q, path):
    rows = np.loadtxt(path)
    depth = measures.block_depth(rows) if name == "block" else measures.beam_depth(rows)
    count, near, rms = measures.layer(rows, depth)
    q["layer_rms"], q["layer_near"], q["layer_count"] = rms, near, count
    return [count, percent(near), percent(rms), percent(q["wall_protrusion"])]


def case_tables(runner, document):
    quick = runner.options.quick
    size, tried = find_overlap_size(runner, 1000 if quick else 10000)
    beam = runner.out / "beam.stl"
    measures.write_beam(beam)
    asked, rows, process, layers, raw = [], [], [], [], []
    for name, title, dimension, specimen, asks in cases(quick, size, beam):
        q, path = runner.pack(f"case-{name}", specimen, dimension)
        if name in ("block", "beam"):
            layers.append([title, *layer_row(name, q, path)])
        for k, (text, key, sense, reach, aim, scale) in enumerate(asks):
            value = q[key] * scale
            asked.append(["" if k else title, text, bound(sense, reach), bound(sense, aim), f"{value:.2f}",
                          verdict(sense, reach, value), verdict(sense, aim, value)])
        rows.append([title, q["particles"], *(f(q) for _, f in FIGURES)])
        process.append([title, *(f(q) for _, f in PROCESS)])
        raw.append({"case": title, **q})
    document.add("## What was asked for and what was measured\nSeed 1. n_c is 2 N_c/N over all particles, the outer "
                 "ones included; its tolerances are gaps over r_i + r_j. Porosity counts overlaps twice.")
    document.table("cases-asked", ["case", "figure", "reach", "aim", "measured", "reached", "aim met"], asked)
    document.add("### All figures")
    document.table("cases", ["case", "N", *(h for h, _ in FIGURES)], rows, raw)
    document.table("cases-process", ["case", *(h for h, _ in PROCESS)], process)
    document.add("### Outer layer\nSpheres whose gap to the boundary is below half their radius.")
    document.table("layers", ["case", "spheres", "within 5 % of the radius, %", "rms gap, % of the radius",
                              "largest protrusion, % of the radius"], layers)
    found = f"taken: {100 * size:.1f} %" if size else f"none does; {100 * SMALL_OVERLAP:.1f} % stands in for it above"
    document.add(f"### overlap_size for at most 2 % of overlap\nFrom 1.2 % downward in steps of 0.1 %, seeds until one "
                 f"fails; {found}.")
    document.table("overlap-size", ["overlap_size %", "largest overlap of any pair %", "seeds tried",
                                    "all at most 2 %"], tried)
    return size


# --- 2: time ------------------------------------------------------------------------------------------------


KEPT = ("seconds", "wall", "cpu", "memory_mb", "iterations", "porosity", "coordination_1", "anisotropy", "load_before")


def time_table(runner, document):
    counts = [1000, 3000, 10000, 30000] if runner.options.quick else [1000, 3000, 10000, 30000, 100000, 300000]
    rows, raw = [], []
    for n in counts:
        q, _ = runner.pack(f"time-{n}", f"{ROUND}\nparticles: {n}")
        raw.append({"particles": n, **{k: q[k] for k in KEPT}})
        rows.append([n, f"{q['seconds']:.2f}", f"{1e6 * q['seconds'] / n:.0f}", f"{q['cpu']:.2f}", q["iterations"],
                     f"{q['memory_mb']:.0f}", percent(q["porosity"]), f"{q['coordination_1']:.2f}",
                     percent(q["anisotropy"]), f"{q['load_before']:.1f}"])
    n, s = np.array(counts, float), np.array([row["seconds"] for row in raw])
    late = n >= 10000
    slope, slope_cpu = (np.polyfit(np.log(n[late]), np.log(v[late]), 1)[0]
                        for v in (s, np.array([row["cpu"] for row in raw])))
    document.add("## Time against N\n3D cylinder 1 x 1, settings as they come, seed 1, one run each.")
    document.table("time", ["N", "s as printed", "µs per sphere", "CPU s of the process", "iterations", "peak MB",
                            "e %", "n_c 1 %", "off isotropic %", "load before"], rows, raw)
    document.add(f"Exponent of N from 10 000 on: {slope:.2f} (wall), {slope_cpu:.2f} (CPU).")
    figure, axes = plt.subplots(figsize=(6.4, 4.2))
    axes.loglog(n, s, "o-", color=BLUE, label="seconds as printed")
    axes.loglog(n, [row["cpu"] for row in raw], "s--", color=GREY, label="CPU seconds of the process")
    anchor = int(np.argmin(np.abs(n - 30000)))
    axes.loglog(n, s[anchor] * n / n[anchor], ":", color=INK, label="slope 1")
    axes.set(xlabel="spheres", ylabel="s")
    axes.legend(frameon=False)
    axes.grid(alpha=0.3, which="both")
    document.picture(figure, "time", "Time of `gneiss pack` against the number of spheres, "
                     f"{runner.options.threads} threads")


# --- 3: seeds -----------------------------------------------------------------------------------------------

SCATTER = [("porosity", "e %", 100, 2), ("porosity_net", "e %, lenses once", 100, 2),
           ("coordination_1", "n_c at 1 %", 1, 3), ("coordination_5", "n_c at 5 %", 1, 3),
           ("anisotropy", "off isotropic %", 100, 2), ("overlap_median", "median overlap %", 100, 2),
           ("overlap_max", "largest overlap %", 100, 2), ("young_modulus", "E GPa", 1e-9, 3),
           ("poisson_ratio", "nu", 1, 4),
           ("peak_stress", "UCS MPa", 1e-6, 2), ("peak_strain", "strain at peak %", 100, 4)]


def seed_rows(runner, variants, seeds, particles):
    """{variant: [figures of one seed]} and {variant: [(strain, stress)]}."""
    import h5py

    found, curves = {}, {}
    for label, slug, packing in variants:
        settings = {f"specimen.packing.{k}": v for k, v in packing.items()}
        text = ", ".join(f"{k}: {v}" for k, v in packing.items())
        found[label], curves[label] = [], []
        for seed in seeds:
            q, _ = runner.pack(f"seed-{slug}-{seed}", rock(particles, text), 3, seed)
            summary, results = runner.crush(f"crush-{slug}-{seed}", seed, {**settings, "specimen.particles": particles})
            found[label].append({"variant": label, "seed": seed, **q, **summary["readings"],
                                 "bonds": summary["counts"]["bonds"], "run_seconds": summary["seconds"]["total"],
                                 "stop_reason": summary["stop_reason"]})
            with h5py.File(results, "r") as file:
                curves[label].append((file["history/strain"][()], file["history/stress"][()]))
    return found, curves


def seed_tables(runner, document, size):
    quick = runner.options.quick
    variants = [("none", "none", {"overlap": "none"}), ("passive", "passive", {"overlap": "passive"})]
    size = SMALL_OVERLAP if size is None else size
    if not quick:
        variants.insert(1, (f"passive {100 * size:.1f} %", "two", {"overlap": "passive", "overlap_size": size}))
    found, curves = seed_rows(runner, variants, runner.options.seeds, 1000 if quick else 10000)
    document.add("## Seeds\nscenes/ucs-packed.yaml with seeds "
                 f"{runner.options.seeds[0]} to {runner.options.seeds[-1]}; s.d. over n - 1. Overlaps: "
                 "none, passive with a small overlap_size, passive as it comes.")
    rows = []
    for label, results in found.items():
        for key, text, scale, digits in SCATTER:
            v = scale * np.array([r[key] for r in results], float)
            spread = 100 * v.std(ddof=1) / v.mean() if v.mean() else 0.0
            rows.append([label, text, f"{v.mean():.{digits}f}", f"{v.std(ddof=1):.{digits}f}", f"{spread:.2f}",
                         f"{v.min():.{digits}f} to {v.max():.{digits}f}"])
    document.table("seeds-scatter", ["overlaps", "figure", "mean", "s.d.", "s.d. % of mean", "range"], rows)
    document.add("### Seed by seed")
    rows = [[label, r["seed"], *(f"{scale * r[key]:.{digits}f}" for key, _, scale, digits in SCATTER),
             f"{2 * r['bonds'] / r['particles']:.2f}", f"{r['seconds']:.1f}", f"{r['run_seconds']:.0f}"]
            for label, results in found.items() for r in results]
    document.table("seeds", ["overlaps", "seed", *(text for _, text, _, _ in SCATTER), "bonds per particle (2 N_b/N)",
                             "pack s", "run s"], rows, [r for results in found.values() for r in results])
    figure, axes = plt.subplots(figsize=(6.4, 4.2))
    for (label, lines), colour in zip(curves.items(), (BLUE, GREEN, RED) if len(curves) > 2 else (BLUE, RED)):
        for k, (strain, stress) in enumerate(lines):
            axes.plot(100 * strain, stress / 1e6, color=colour, lw=1, label=f"overlaps: {label}" if k == 0 else None)
    axes.set(xlabel="strain, %", ylabel="stress, MPa")
    axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    document.picture(figure, "seeds-curves", "Uniaxial compression of packings that differ in the seed alone")


# --- 4: YADE ------------------------------------------------------------------------------------------------


def peer_rows(runner, document, size):
    """[(label, seconds, path of rows, figures of gneiss or None)]; failures go into the document."""
    n = 1000 if runner.options.quick else 10000
    own = [("gneiss, no overlaps", ""),
           ("gneiss, no overlaps, radii as in YADE's", "size_ratio: 1.857143, size_variation: 0.1732"),
           ("gneiss, passive", "overlap: passive")]
    size = SMALL_OVERLAP if size is None else size
    own.insert(2, (f"gneiss, passive {100 * size:.1f} %", f"overlap: passive, overlap_size: {size}"))
    found = []
    for k, (label, packing) in enumerate(own):
        q, path = runner.pack(f"peer-gneiss-{k}", rock(n, packing))
        found.append((label, q["seconds"], path, q))
    if runner.options.yade:
        kinds = [(f"YADE, periodic cell of 2000, seed {seed}", 2000, seed) for seed in runner.options.seeds]
        if not runner.options.quick:
            kinds += [("YADE, periodic cell of 10 000", 10000, 1), ("YADE, between walls (TriaxialTest)", 0, 1)]
        for label, cell, seed in kinds:
            record, path = runner.yade(f"peer-yade-{cell}-{seed}", cell, seed)
            if record["result"]:
                found.append((label, record["result"]["seconds"], path, None))
            else:
                found.append((f"{label}: no packing", record["wall"], None, None))
                document.add(f"{label}: exit code {record['code']}, stopped after {record['wall']:.0f} s "
                             f"({record['cpu']:.0f} CPU s).")
    found.append(("specimens/rock-a.txt, as published", None, study.ROOT / "scenes" / "specimens" / "rock-a.txt", None))
    return found


SHARED = ("porosity", "porosity_net", "coordination_01", "coordination_1", "coordination_5", "anisotropy",
          "overlap_max")


def peer_table(runner, document, size):
    document.add("## Beside YADE\nOne cylinder of 23 x 46 mm, `pack.randomDensePack(inCylinder, radius "
                 f"{1e3 * YADE_RADIUS:.2f} mm, rRelFuzz 0.3)`; all figures by the same Python code from rows "
                 "x y z r, porosity over the volume of the whole cylinder; core: at least 4 mean radii inside it, "
                 "overlaps once (from random points, standard error 0.1 %). YADE leaves out spheres that reach "
                 "beyond the cylinder.")
    rows, raw, worst, curves = [], [], 0.0, []
    for label, seconds, path, q in peer_rows(runner, document, size):
        took = "" if seconds is None else f"{seconds:.1f}"
        if path is None:
            rows.append([label, *[""] * 17, took])
            continue
        m = measures.measure(path)
        if q:
            worst = max(worst, *(abs(m[k] - q[k]) for k in SHARED))
        raw.append({"packing": label, **m, "seconds": seconds})
        rows.append([label, m["particles"], percent(m["porosity"]), percent(m["porosity_net"]),
                     percent(m["core_porosity"]), f"{m['coordination_01']:.2f}",
                     f"{m['coordination_1']:.2f}", f"{m['coordination_5']:.2f}",
                     f"{m['core_coordination_1']:.2f}", percent(m["few_contacts"]),
                     f"{m['fabric_min']:.4f} to {m['fabric_max']:.4f}", percent(m["anisotropy"]),
                     percent(m["overlap_median"]), percent(m["overlap_max"]), f"{m['overlaps']:.2f}",
                     f"{1e3 * m['radius_mean']:.3f}",
                     f"{m['radius_ratio']:.2f}", percent(m["protrusion"]), took])
        if "seed" in label and not label.endswith("seed 1"):
            continue
        gap = np.sort(measures.pairs_within(np.loadtxt(path, ndmin=2), 0.1)[2])
        curves.append((label, gap, 2 * np.arange(1, len(gap) + 1) / m["particles"]))
    document.table("peers", ["packing", "N", "e %", "e %, lenses once", "core e %", "n_c 0.1 %", "1 %", "5 %",
                             "core n_c 1 %", "fewer than 4 contacts %", "fabric eigenvalues", "off isotropic %",
                             "overlap median %", "max %", "overlaps per sphere", "mean r mm", "r_max/r_min",
                             "protrusion % r", "s"], rows, raw)
    document.add("Largest difference between this code and `gneiss pack` in porosity, n_c, fabric and overlap of its "
                 f"own packings: {worst:.1e}. Protrusion is negative when every sphere stays clear of the boundary.")
    figure, axes = plt.subplots(figsize=(7.2, 4.6))
    for k, (label, gap, n_c) in enumerate(curves):
        style = "--" if "YADE," in label else ":" if "rock-a" in label else "-"
        axes.plot(100 * gap, n_c, color=f"C{k}", ls=style, label=label)
    axes.set(xlabel="gap tolerance, % of r_i + r_j (negative: overlap)", ylabel="n_c up to it", xlim=(-10, 10))
    axes.legend(frameon=False, fontsize=8)
    axes.grid(alpha=0.3)
    document.picture(figure, "peers-coordination", "Coordination number against the gap up to which pairs count")


# --- main program -------------------------------------------------------------------------------------------


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gneiss", default=study.PROGRAM)
    parser.add_argument("--out", required=True)
    parser.add_argument("--yade", action="store_true", help="also YADE's randomDensePack")
    parser.add_argument("--yade-limit", type=float, default=900, help="s for each packing of YADE")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--fresh", action="store_true", help="reuse nothing")
    parser.add_argument("--threads", type=int, default=study.THREADS)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    options = parser.parse_args()
    options.seeds = [1, 2] if options.quick else [1, 2, 3, 4, 5]
    return options


def main():
    options = arguments()
    runner = Runner(options)
    (runner.out / "runs").mkdir(parents=True, exist_ok=True)
    document = Document(runner.out)
    version = subprocess.run([runner.gneiss, "--version"], text=True, capture_output=True).stdout.strip()
    document.add(f"# Packings\n{version}, {options.threads} threads, {os.cpu_count()} cores; GNEISS_CACHE=off. "
                 "Seconds are those that the program prints; CPU s is all that its process used. The load average "
                 "before each run tells whether other work shared the machine.")
    size = None
    if set(options.parts) & {"cases", "seeds", "peers"}:
        if "cases" in options.parts:
            size = case_tables(runner, document)
            document.write()
        else:
            size, _ = find_overlap_size(runner, 1000 if options.quick else 10000)
    if "time" in options.parts:
        time_table(runner, document)
        document.write()
    if "seeds" in options.parts:
        seed_tables(runner, document, size)
        document.write()
    if "peers" in options.parts:
        peer_table(runner, document, size)
    document.write()
    say(f"written: {runner.out / 'packing.md'}")


if __name__ == "__main__":
    main()
