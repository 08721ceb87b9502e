"""Seconds to the same answer: scenes/ucs-rock.yaml from start to failure as it is, with steps that begin at the first break, with added mass, with
both, in mixed precision, and as `gneiss plan --error 4%` proposes it. Every round runs all of them one after the other on a specimen of its own,
whose coordinates were changed by 1e-12 of themselves: other load on the machine affects all of them equally, and the strengths of a row have the
scatter due to rounding. CPU seconds of one thread, the whole of the program. Fills docs/evidence/performance.md; some five minutes of one core.

    /usr/bin/python3 validate/answer_study.py [--rounds 4] [--step 1.75] [--fresh]

GNEISS_OLD names another program: ratios are then relative to its plain run.
"""
import json
import os
import re
import resource
import statistics
import sys

import numpy as np

import study

FOLDER = study.RUNS / "answer"
OLD = os.environ.get("GNEISS_OLD", study.PROGRAM)
PAGE = "performance.md"


def option(name, default):
    return type(default)(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else default


ROUNDS, LONGER = option("--rounds", 4), option("--step", 1.75)


def ways():
    """Name, program, scene, settings. Added mass: chosen by the bound, for a step that is this multiple of the sharp
    one."""
    dt, proposed = planned()
    start, mixed = {"time.start": "first_break"}, {"run.precision": "mixed"}
    heavier = {"time.estimate": "bound", "time.mass_scaling.step": f"{LONGER * dt:.4g}"}
    return [("as it is", OLD, study.ROCK, {}),
            ("start at the first break", study.PROGRAM, study.ROCK, start),
            (f"added mass, {LONGER:g} times the step", study.PROGRAM, study.ROCK, heavier),
            ("both", study.PROGRAM, study.ROCK, {**start, **heavier}),
            ("both, mixed precision", study.PROGRAM, study.ROCK, {**start, **heavier, **mixed}),
            ("as `plan --error 4%` proposes", study.PROGRAM, proposed, {})]


def planned():
    """s: time of the unchanged scene at the start; the scene proposed for 4 %."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    scene = FOLDER / "proposed.yaml"
    kept = FOLDER / "plan.json"
    if study.FRESH or not kept.exists():
        said = study.call(["plan", study.ROCK, "--error", "4%", "--log", "json", "--threads", "1", "--write", str(scene), "--force"])
        if said.returncode != 0:
            sys.exit(said.stderr)
        kept.write_text(json.dumps(json.loads(said.stdout.splitlines()[-2])["result"]))
    plan = json.loads(kept.read_text())
    print(json.dumps(plan["proposed"]), file=sys.stderr, flush=True)
    return plan["dt"], scene


def specimen(change):
    """The readings of first_break_study.py."""
    path = FOLDER / f"rock-a-{change}.txt"
    if not path.exists():
        FOLDER.mkdir(parents=True, exist_ok=True)
        data = np.loadtxt(study.ROOT / "scenes" / "specimens" / "rock-a.txt")
        if change:
            data[:, :-1] *= 1 + 1e-12 * np.random.default_rng(change).uniform(-1, 1, data[:, :-1].shape)
        np.savetxt(path, data, fmt="%.17g")
    return path


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(way, change):
    name, program, scene, settings = way
    out = FOLDER / f"{re.sub('[^a-z0-9.]+', '-', name)}-{change}"
    kept = out / "cost.json"
    if study.FRESH or not kept.exists():
        before, ours = cpu(), study.PROGRAM
        study.PROGRAM = program
        done = study.call(["run", str(scene), "--out", str(out), "--force", "--quiet", "--threads", "1",
                           *study.set_arguments({"specimen.file": specimen(change), **settings})])
        study.PROGRAM = ours
        if done.returncode != 0:
            sys.exit(f"{name}: {done.stderr}")
        kept.write_text(json.dumps({"cpu": cpu() - before}))
    summary = json.loads((out / "summary.json").read_text())
    seconds = json.loads(kept.read_text())["cpu"]
    first = summary.get("first_break", {}).get("steps", 0)
    print(f"{name}, {change}: {seconds:.2f} s, {summary['steps'] - first} steps, {summary['readings']['peak_stress'] / 1e6:.1f} MPa", file=sys.stderr,
          flush=True)
    return {"seconds": seconds, "steps": summary["steps"] - first, "strength": summary["readings"]["peak_stress"] / 1e6,
            "strain": 100 * summary["readings"]["peak_strain"], "E": summary["readings"]["young_modulus_average"] / 1e9,
            "nu": summary["readings"]["poisson_ratio"], "added": 100 * summary.get("mass_scaling", {}).get("added_share", 0.0),
            "broken": summary["counts"]["broken_tension"] + summary["counts"]["broken_shear"]}


def shown(values, digits):
    return f"{np.mean(values):.{digits}f} +- {np.std(values, ddof=1):.{digits}f}"


def rows(found):
    plain = found[0][1]
    for name, runs in found:
        ratio = statistics.median(r["seconds"] / p["seconds"] for r, p in zip(runs, plain))
        column = {key: [r[key] for r in runs] for key in runs[0]}
        mean = np.mean(column["strength"]) / np.mean([p["strength"] for p in plain]) - 1
        yield [name, f"{np.mean(column['steps']):.0f}", f"{statistics.median(column['seconds']):.2f}", f"{ratio:.2f}", shown(column["strength"], 1),
               f"{100 * mean:+.1f}", shown(column["strain"], 3), shown(column["E"], 3), shown(column["nu"], 4), shown(column["broken"], 0),
               f"{np.mean(column['added']):.2g}"]


if __name__ == "__main__":
    all_ways = ways()
    found = [(way[0], []) for way in all_ways]
    for change in range(ROUNDS):
        for (_, runs), way in zip(found, all_ways):
            runs.append(run(way, change))
    study.put(PAGE, "table answer", study.table(
        ["rock-a from start to failure", "steps", "CPU s", "of the plain run's", "strength MPa", "apart %", "strain at the peak %", "E GPa", "nu",
         "broken bonds", "added mass %"], rows(found)))
