"""Tests the promise of `gneiss plan --error`: scenes that the study of accuracy did not use, the proposed settings beside a much
finer run. Fills docs/evidence/planner.md; ten minutes of one core.

    /usr/bin/python3 validate/planner_study.py [--fresh] [--again] [--only SCENE] [--seeds 12]

--again repeats the plans and the runs that they propose, for times on an otherwise idle machine; finer runs are kept. Seconds are CPU seconds of one
thread. The scenes were written before any of them was run, and are left as they were. """
import json
import os
import shutil
import subprocess
import sys

import numpy as np

import study

FOLDER = study.RUNS / "planner"
PAGE = study.ROOT / "docs" / "evidence" / "planner.md"
PICTURE = study.ROOT / "docs" / "evidence" / "pictures" / "planner.png"
SLOWER, SAFETY, FIRST = 4, 0.6, 101  # settings of the finer runs: loading, step, the first of their seeds
SEEDS = int(sys.argv[sys.argv.index("--seeds") + 1]) if "--seeds" in sys.argv else 12  # number of seeds and packings
ROWS = 20000  # rows of the history of a finer run
FINER = 4  # cells of the finer runs of elements

SPACE = {"background": {"model": "nonviscous_vector", "coefficient": 0.7}}
OUTPUT = {"history_rows": 400, "snapshots": 0, "checkpoint": "off"}


def rock(**keys):
    return {"name": "rock", "density": 2600, "kratio": 3, "friction": 0.5, **keys}


def plates(axis, low, high, speed, stiffness):
    """Two walls across an axis that close, each at `speed`."""
    unit = [float(a == axis) for a in range(3)][:2 if axis == 1 else 3]
    motion = "v" + "xyz"[axis]
    plate = {"stiffness": stiffness, "passive": True}
    return [{"name": "lower", "point": [low * u for u in unit], "normal": unit, "motion": {motion: speed}, **plate},
            {"name": "upper", "point": [high * u for u in unit], "normal": [-u for u in unit], "motion": {motion: -speed}, **plate}]


def grips(axis, depth, speed):
    """The two ends, drawn apart."""
    held = {"axis": "xyz"[axis], "depth": depth, "by": "surface"}
    return [{"name": name, "select": {"end": {**held, "side": name}}, "motion": {"v" + "xyz"[axis]: sign * speed}}
            for name, sign in (("lower", -1), ("upper", 1))]


def scene(kind, shape, material, law, test, end, dimension=3, **more):
    """A test to failure of a packed shape."""
    return {"dimension": dimension, "specimen": {"material": "rock", **shape}, "materials": [material], "law": {"stiffness": law},
            "bonds": {"interaction_range": 0.05}, "damping": SPACE,
            "test": {"kind": kind, "axis": "z" if dimension == 3 else "y", "lower": "lower", "upper": "upper", **test},
            "time": {"end": end, "stop": {"peak_drop": 0.2}}, "output": OUTPUT, "run": {"threads": 1}, **more}


def scenes():
    """(name, description, wanted error, reading, the scene)"""
    yield "column", "compression of a column, harmonic law", 0.10, "strength", scene(
        "compression", {"box": {"size": [0.015, 0.015, 0.045]}, "particles": 600},
        rock(contact_modulus=12e9, kratio=2.5, tensile_strength=25e6, shear_strength=35e6), "harmonic", {"length": 0.045, "area": 2.25e-4}, 18e-3,
        walls=plates(2, 0, 0.045, 0.05, 5e7))
    yield "stout", "compression of a stout cylinder, arithmetic law", 0.12, "strength", scene(
        "compression", {"cylinder": {"diameter": 0.05, "height": 0.05}, "particles": 500},
        rock(contact_modulus=8e9, kratio=3.5, tensile_strength=10e6, shear_strength=15e6), "arithmetic", {"length": 0.05, "diameter": 0.05}, 20e-3,
        walls=plates(2, 0, 0.05, 0.05, 1e8))
    yield "block", "compression of a large block, mean radius", 0.10, "strength", scene(
        "compression", {"box": {"size": [0.2, 0.2, 0.3]}, "particles": 600},
        rock(contact_modulus=25e9, tensile_strength=8e6, shear_strength=12e6), "mean_radius", {"length": 0.3, "area": 0.04}, 60e-3,
        walls=plates(2, 0, 0.3, 0.1, 1.5e9))
    yield "sections", "compression of a cylinder, law by area (Dempack)", 0.10, "strength", scene(
        "compression", {"cylinder": {"diameter": 0.054, "height": 0.108}, "particles": 500},
        rock(kratio=0, young=30e9, poisson=0.2, tensile_strength=6e6, shear_strength=12e6), "dempack", {"length": 0.108, "diameter": 0.054}, 40e-3,
        walls=plates(2, 0, 0.108, 0.05, 5e8))
    yield "rod", "tension of a slender rod, harmonic law", 0.06, "strength", scene(
        "tension", {"cylinder": {"diameter": 0.01, "height": 0.04}, "particles": 500},
        rock(contact_modulus=15e9, tensile_strength=15e6, shear_strength=15e6), "harmonic", {"length": 0.04, "diameter": 0.01}, 20e-3,
        sets=grips(2, 8e-4, 0.02))
    yield "slab", "tension of a slab, law by area (Dempack)", 0.06, "strength", scene(
        "tension", {"box": {"size": [0.03, 0.01, 0.05]}, "particles": 600},
        rock(kratio=0, young=40e9, poisson=0.25, tensile_strength=5e6, shear_strength=10e6), "dempack", {"length": 0.05, "area": 3e-4}, 10e-3,
        sets=grips(2, 1.5e-3, 0.02))
    yield "stiffness", "stiffness of a prism in compression, harmonic law", 0.03, "stiffness", scene(
        "compression", {"box": {"size": [0.02, 0.02, 0.04]}, "particles": 500},
        rock(contact_modulus=20e9, tensile_strength=20e6, shear_strength=20e6), "harmonic", {"length": 0.04, "area": 4e-4}, 16e-3,
        walls=plates(2, 0, 0.04, 0.05, 1.5e8))
    yield "plane block", "compression of a square of discs, arithmetic law", 0.12, "strength", scene(
        "compression", {"rectangle": {"width": 0.06, "height": 0.06}, "particles": 700},
        rock(contact_modulus=30e9, tensile_strength=15e6, shear_strength=30e6), "arithmetic", {"length": 0.06, "area": 0.06}, 24e-3, 2,
        walls=plates(1, 0, 0.06, 0.05, 6e10))
    yield "plane bar", "tension of a bar of discs, harmonic law", 0.10, "strength", scene(
        "tension", {"rectangle": {"width": 0.03, "height": 0.12}, "particles": 600},
        rock(contact_modulus=20e9, tensile_strength=12e6, shear_strength=24e6), "harmonic", {"length": 0.12, "area": 0.03}, 40e-3, 2,
        sets=grips(1, 2e-3, 0.02))
    yield "plane hexagon", "compression of a hexagon of discs, mean radius", 0.12, "strength", scene(
        "compression", {"polygon": [[0.01, 0], [0.05, 0], [0.06, 0.05], [0.05, 0.1], [0.01, 0.1], [0, 0.05]], "particles": 500},
        rock(contact_modulus=10e9, kratio=2, tensile_strength=8e6, shear_strength=12e6), "mean_radius", {"length": 0.1, "area": 0.04}, 40e-3, 2,
        walls=plates(1, 0, 0.1, 0.05, 2e10))
    parts = [{"name": "supports", "group": "supports", "motion": {"vy": 0}}, {"name": "pin", "group": "support_left", "motion": {"vx": 0}},
             {"name": "load", "group": "load", "motion": {"vy": [[0, -0.01], [1e-3, -0.01], [1.001e-3, 0]]}}]
    yield "beam", "stiffness of a notched beam of elements", 0.04, "stiffness", {
        "dimension": 2, "elements": {"beam": {"length": 0.5, "height": 0.1, "span": 0.4, "notch_depth": 0.03, "notch_width": 0.004, "cell": 0.01},
                                     "materials": [{"young": 35e9, "poisson": 0.2, "density": 2400}], "motions": parts},
        "damping": {"background": {"model": "viscous", "coefficient": 12000}},
        "test": {"kind": "compression", "axis": "y", "lower": "supports", "upper": "load"}, "time": {"end": 5e-3},
        "output": OUTPUT, "run": {"threads": 1}}
    parts = [{"name": "clamp", "group": "x_lower", "motion": {"vx": 0, "vy": 0}},
             {"name": "tip", "group": "x_upper", "motion": {"vy": [[0, -0.01], [5e-3, -0.01], [5.001e-3, 0]]}}]
    yield "strip", "stiffness of a strip of elements that is bent, mixed form", 0.06, "stiffness", {
        "dimension": 2, "elements": {"rectangle": {"size": [0.6, 0.06], "cells": [30, 3]}, "formulation": "mixed",
                                     "materials": [{"young": 70e9, "poisson": 0.3, "density": 2700}], "motions": parts},
        "damping": {"background": {"model": "viscous", "coefficient": 1700}},
        "test": {"kind": "compression", "axis": "y", "lower": "clamp", "upper": "tip", "length": 0.06, "area": 0.06}, "time": {"end": 25e-3},
        "output": OUTPUT, "run": {"threads": 1}}


def others():
    """A second dozen, by other laws, shapes, sizes and stiffnesses: written when the results of the first were known, and before any of the second
    was run."""
    yield "tower", "compression of a tower, mean arithmetic stiffness", 0.10, "strength", scene(
        "compression", {"box": {"size": [0.1, 0.1, 0.25]}, "particles": 900},
        rock(contact_modulus=30e9, kratio=2, tensile_strength=20e6, shear_strength=40e6), "mean_arithmetic", {"length": 0.25, "area": 0.01}, 40e-3,
        walls=plates(2, 0, 0.25, 0.1, 8e8))
    yield "coin", "compression of a flat cylinder, harmonic law", 0.12, "strength", scene(
        "compression", {"cylinder": {"diameter": 0.03, "height": 0.02}, "particles": 600},
        rock(contact_modulus=15e9, kratio=3, tensile_strength=12e6, shear_strength=24e6), "harmonic", {"length": 0.02, "diameter": 0.03}, 12e-3,
        walls=plates(2, 0, 0.02, 0.04, 1e8))
    yield "pebble", "compression of a small cube, law by area (polyhedra)", 0.12, "strength", scene(
        "compression", {"box": {"size": [0.012, 0.012, 0.012]}, "particles": 500},
        rock(kratio=0, young=15e9, poisson=0.15, tensile_strength=8e6, shear_strength=16e6), "polyhedron", {"length": 0.012, "area": 1.44e-4}, 12e-3,
        walls=plates(2, 0, 0.012, 0.02, 3e7))
    yield "weak", "compression of a weak cylinder, arithmetic law", 0.10, "strength", scene(
        "compression", {"cylinder": {"diameter": 0.1, "height": 0.2}, "particles": 800},
        rock(contact_modulus=3e9, kratio=4, tensile_strength=1e6, shear_strength=2e6), "arithmetic", {"length": 0.2, "diameter": 0.1}, 60e-3,
        walls=plates(2, 0, 0.2, 0.05, 1.5e8))
    yield "square bar", "tension of a square bar, mean radius", 0.06, "strength", scene(
        "tension", {"box": {"size": [0.03, 0.03, 0.09]}, "particles": 700},
        rock(contact_modulus=25e9, kratio=2.5, tensile_strength=10e6, shear_strength=30e6), "mean_radius", {"length": 0.09, "area": 9e-4}, 20e-3,
        sets=grips(2, 2e-3, 0.02))
    yield "round bar", "tension of a round bar, arithmetic law", 0.06, "strength", scene(
        "tension", {"cylinder": {"diameter": 0.05, "height": 0.1}, "particles": 800},
        rock(contact_modulus=8e9, kratio=3.5, tensile_strength=4e6, shear_strength=8e6), "arithmetic", {"length": 0.1, "diameter": 0.05}, 25e-3,
        sets=grips(2, 3e-3, 0.02))
    yield "core", "stiffness of a core in compression, law by area (Dempack)", 0.03, "stiffness", scene(
        "compression", {"cylinder": {"diameter": 0.05, "height": 0.1}, "particles": 600},
        rock(kratio=0, young=50e9, poisson=0.2, tensile_strength=30e6, shear_strength=60e6), "dempack", {"length": 0.1, "diameter": 0.05}, 20e-3,
        walls=plates(2, 0, 0.1, 0.1, 8e8))
    yield "pulled stiffness", "stiffness of a bar in tension, harmonic law", 0.03, "stiffness", scene(
        "tension", {"box": {"size": [0.02, 0.02, 0.05]}, "particles": 600},
        rock(contact_modulus=12e9, kratio=2, tensile_strength=12e6, shear_strength=20e6), "harmonic", {"length": 0.05, "area": 4e-4}, 15e-3,
        sets=grips(2, 1.5e-3, 0.02))
    yield "plane column", "compression of a column of discs, law by area (Dempack)", 0.12, "strength", scene(
        "compression", {"rectangle": {"width": 0.05, "height": 0.1}, "particles": 600},
        rock(kratio=0, young=20e9, poisson=0.2, tensile_strength=6e6, shear_strength=18e6), "dempack", {"length": 0.1, "area": 0.05}, 30e-3, 2,
        walls=plates(1, 0, 0.1, 0.05, 4e10))
    yield "plane tie", "tension of a short tie of discs, arithmetic law", 0.10, "strength", scene(
        "tension", {"rectangle": {"width": 0.05, "height": 0.08}, "particles": 700},
        rock(contact_modulus=40e9, kratio=3, tensile_strength=8e6, shear_strength=24e6), "arithmetic", {"length": 0.08, "area": 0.05}, 25e-3, 2,
        sets=grips(1, 2e-3, 0.02))
    parts = [{"name": "supports", "group": "supports", "motion": {"vy": 0}}, {"name": "pin", "group": "support_left", "motion": {"vx": 0}},
             {"name": "load", "group": "load", "motion": {"vy": [[0, -0.02], [1e-3, -0.02], [1.001e-3, 0]]}}]
    yield "deep beam", "stiffness of a deep notched beam of elements", 0.05, "stiffness", {
        "dimension": 2, "elements": {"beam": {"length": 0.7, "height": 0.2, "span": 0.6, "notch_depth": 0.05, "notch_width": 0.005, "cell": 0.02},
                                     "materials": [{"young": 20e9, "poisson": 0.25, "density": 2300}], "motions": parts},
        "damping": {"background": {"model": "viscous", "coefficient": 9000}},
        "test": {"kind": "compression", "axis": "y", "lower": "supports", "upper": "load"}, "time": {"end": 6e-3},
        "output": OUTPUT, "run": {"threads": 1}}
    parts = [{"name": "clamp", "group": "x_lower", "motion": {"vx": 0, "vy": 0}},
             {"name": "tip", "group": "x_upper", "motion": {"vy": [[0, -0.02], [4e-3, -0.02], [4.001e-3, 0]]}}]
    yield "shelf", "stiffness of a shelf of elements that is bent", 0.08, "stiffness", {
        "dimension": 2, "elements": {"rectangle": {"size": [0.4, 0.05], "cells": [32, 4]},
                                     "materials": [{"young": 30e9, "poisson": 0.2, "density": 2400}], "motions": parts},
        "damping": {"background": {"model": "viscous", "coefficient": 2200}},
        "test": {"kind": "compression", "axis": "y", "lower": "clamp", "upper": "tip", "length": 0.05, "area": 0.05}, "time": {"end": 20e-3},
        "output": OUTPUT, "run": {"threads": 1}}


# --- runs --------------------------------------------------------------------------------------------------

READINGS = {"strength": "peak_stress", "stiffness": "young_modulus_average"}


class NoStart(Exception):
    """time.start: first_break found no equilibrium."""


def call(arguments):
    """The program; packings are made anew by every run, so that each pays for its own."""
    environment = dict(os.environ, OMP_WAIT_POLICY="passive", GNEISS_CACHE="off")
    done = subprocess.run([study.PROGRAM, *map(str, arguments)], cwd=study.ROOT, env=environment, text=True, capture_output=True)
    if done.returncode:
        if "time.start: expected an equilibrium" in done.stderr:
            raise NoStart
        sys.exit(f"gneiss {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stderr[-2000:]}")
    return done.stdout


def planned(name, wanted, reading, keys):
    """The plan, and the file of the scene with the proposed settings."""
    folder = FOLDER / name.replace(" ", "-")
    if study.FRESH:
        shutil.rmtree(folder, ignore_errors=True)
    if "--again" in sys.argv:
        for old in [*folder.glob("run-*"), *folder.glob("plan.json")]:
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.yaml").write_text(json.dumps({"title": name, **keys}, indent=1))
    kept = folder / "plan.json"
    if not kept.exists():
        said = call(["plan", folder / "scene.yaml", "--error", wanted, "--reading", reading, "--threads", 1, "--write", folder / "planned.yaml",
                     "--force", "--log", "json"])
        kept.write_text(json.dumps(json.loads(said.splitlines()[-2])["result"]))
    return folder, json.loads(kept.read_text())


def one(folder, scene_file, settings, reading):
    """Reading and CPU seconds of a run; kept. A packing without an equilibrium to start from begins at rest."""
    out = FOLDER / folder
    if not (out / "summary.json").exists():
        arguments = ["run", scene_file, "--out", out, "--threads", 1, "--quiet", "--force", *study.set_arguments(settings)]
        try:
            call(arguments)
        except NoStart:
            call([*arguments, "--set", "time.start=rest"])
            (out / "from-rest").touch()
    summary = json.loads((out / "summary.json").read_text())
    if "elements" in summary["counts"]:  # the stress, at rest, of the displacement of the ends
        value = study.Run(out, {"code": 0, "message": ""}).results("history/stress")[-1]
    else:
        value = summary["readings"][READINGS[reading]]
    return float("nan") if value is None else value, summary["seconds"]["cpu"], summary["steps"], summary


def motions(keys, slower):
    """Reduces all prescribed velocities by a factor, and extends the end by the same factor."""
    changed = {"time.end": keys["time"]["end"] * slower}
    for group in ("walls", "sets"):
        for part in keys.get(group, []):
            for channel, value in part["motion"].items():
                changed[f"{group}.{part['name']}.motion.{channel}"] = value / slower
    return changed


def finer_settings(name, keys, plan):
    p = plan["proposed"]
    if "elements" in keys:
        e = keys["elements"]
        if "beam" in e:
            return {"elements.beam.cell": e["beam"]["cell"] * p["cell"] / FINER, "elements.beam.notch_cells": 4}
        layers = round(e["rectangle"]["cells"][1] / p["cell"]) * FINER
        return {"elements.rectangle.cells": f"[{layers * 10}, {layers}]"}
    # The rows suffice for a peak early in the run: with 400 rows over the whole run a peak in tension would be read some
    # percent too low.
    return {**motions(keys, SLOWER / p["pace"]), "time.safety": SAFETY, "output.history_rows": ROWS}


def measured(name, what, wanted, reading, keys):
    """A row of the table."""
    folder, plan = planned(name, wanted, reading, keys)
    p, place = plan["proposed"], folder.name
    elements = "elements" in keys
    ours = [one(f"{place}/run-{seed}", folder / "planned.yaml", {"run.seed": seed}, reading) for seed in range(1, p["packings"] + 1)]
    settings = finer_settings(name, keys, plan)
    seeds = [FIRST] if elements else range(FIRST, FIRST + SEEDS)
    fine = [one(f"{place}/fine-{p.get('cell', p['pace']):.4g}-{seed}", folder / "scene.yaml", {**settings, "run.seed": seed}, reading) for seed in seeds]
    value, truth = np.nanmean([row[0] for row in ours]), np.nanmean([row[0] for row in fine])
    doubt = np.nanstd([row[0] for row in fine], ddof=1) / np.sqrt(len(fine)) / truth if len(fine) > 1 else 0.0
    found, seconds = abs(value / truth - 1), sum(row[1] for row in ours)
    print(f"{name}: predicted {p['error']:.3f}, found {found:.3f} (+- {doubt:.3f}); {p['seconds']:.2f} s, {seconds:.2f} s; steps {p['steps']:.0f}, "
          f"{np.mean([row[2] for row in ours]):.0f}; {json.dumps(plan['estimate'])}", flush=True)
    rest = sum((FOLDER / place / f"run-{seed}" / "from-rest").exists() for seed in range(1, p["packings"] + 1))
    return {"name": name, "what": what, "wanted": wanted, "rest": rest, "reading": reading, "plan": plan, "found": found, "doubt": doubt, "seconds": seconds,
            "signed": value / truth - 1, "steps": np.mean([row[2] for row in ours]), "fine": [row[3] for row in fine],
            "scatter": doubt * np.sqrt(len(fine))}


# --- the page ----------------------------------------------------------------------------------------------

def within(row):
    return row["found"] <= row["plan"]["proposed"]["error"]


def on_time(row):
    return abs(row["seconds"] / row["plan"]["proposed"]["seconds"] - 1) <= 0.25


def proposal(p):
    if "cell" in p:
        return f"cells {p['cell']:.2g} x"
    parts = [f"{p['closing']:.3g} m/s", f"{p['packings']} packing{'s' if p['packings'] > 1 else ''}", p["precision"]]
    if p["start"] != "rest":
        parts.append("first break")
    if p["mass_scaling"] > 1:
        parts.append(f"step {p['mass_scaling']:g} x")
    return ", ".join(parts)


def table(rows):
    yield "| scene | wanted % | proposed | predicted % (largest causes) | found % | seconds predicted | found | steps predicted | found |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for row in rows:
        p = row["plan"]["proposed"]
        largest = sorted(p["causes"].items(), key=lambda cause: -cause[1])[:2]
        causes = ", ".join(f"{name} {100 * error:.1f}" for name, error in largest)
        miss = "" if within(row) else " (more)"
        late = "" if on_time(row) else " (off)"
        rest = f" ({row['rest']} of the packings has no equilibrium to start from: from rest)" if row["rest"] else ""
        yield (f"| {row['name']}: {row['what']} | {100 * row['wanted']:.0f} | {proposal(p)}{rest} | {100 * p['error']:.1f} ({causes}) | "
               f"{100 * row['signed']:+.1f}{miss} | {p['seconds']:.2f} | {row['seconds']:.2f}{late} | {p['steps']:.0f} | {row['steps']:.0f} |")


def mean_of(summaries, key):
    values = [s["readings"][key] for s in summaries if s["readings"][key] is not None]
    return np.mean(values) if values else float("nan")


def shown(value):
    return f"{value:.3g}" if np.isfinite(value) else "-"


def guesses(rows):
    yield "| scene | E predicted, GPa | found | strength predicted, MPa | found | scatter of strength by the law % | of the finer runs % |"
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for row in rows:
        e, p = row["plan"]["estimate"], row["plan"]["proposed"]
        if e["modulus"] is None or "packing" not in p["causes"]:
            continue
        law = p["causes"]["packing"] * np.sqrt(p["packings"]) / 2
        found = [mean_of(row["fine"], key) for key in READINGS.values()]
        yield (f"| {row['name']} | {e['modulus'] / 1e9:.3g} | {shown(found[1] / 1e9)} | {e['strength'] / 1e6:.3g} | {shown(found[0] / 1e6)} | {100 * law:.1f} | "
               f"{100 * row['scatter']:.1f} |")


def draw(rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    drawn, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.2), layout="constrained")
    for axes, x, y, label in (
            (left, [100 * r["plan"]["proposed"]["error"] for r in rows], [100 * max(r["found"], 1e-4) for r in rows], "error, %"),
            (right, [r["plan"]["proposed"]["seconds"] for r in rows], [r["seconds"] for r in rows], "CPU seconds")):
        low, high = 0.6 * min(x + y), 1.6 * max(x + y)
        axes.loglog([low, high], [low, high], color="#555555", lw=1)
        axes.loglog(x, y, "o", color="#1f77b4")
        for row, a, b in zip(rows, x, y):
            axes.annotate(row["name"], (a, b), textcoords="offset points", xytext=(4, 3), fontsize=7)
        axes.set_xlabel(f"predicted {label}")
        axes.set_ylabel(f"found {label}")
    left.errorbar([100 * r["plan"]["proposed"]["error"] for r in rows], [100 * max(r["found"], 1e-4) for r in rows], yerr=[100 * r["doubt"] for r in rows],
                  fmt="none", ecolor="#9ecae1", lw=1)
    right.fill_between([low, high], [0.75 * low, 0.75 * high], [1.25 * low, 1.25 * high], color="#2ca02c", alpha=0.15, lw=0)
    PICTURE.parent.mkdir(parents=True, exist_ok=True)
    drawn.savefig(PICTURE, dpi=110)


def summary_line(rows):
    return (f"Found error at most the predicted one in **{sum(map(within, rows))} of {len(rows)}** (wanted: 10 of 12), seconds within 25 % in "
            f"**{sum(map(on_time, rows))} of {len(rows)}** (wanted: all).")


def fill(rows, more):
    """The parts of the page between its markers."""
    text = PAGE.read_text()
    for name, lines in (("summary", [summary_line(rows)]), ("scenes", table(rows)), ("summary of others", [summary_line(more)]),
                        ("others", table(more)), ("guesses", guesses(rows + more))):
        begin, end = f"<!-- table {name} -->", f"<!-- /table {name} -->"
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = f"{before}{begin}\n" + "\n".join(lines) + f"\n{end}{after}"
    PAGE.write_text(text)


def only():
    return sys.argv[sys.argv.index("--only") + 1] if "--only" in sys.argv else None


if __name__ == "__main__":
    rows, more = ([measured(*entry) for entry in dozen() if only() in (None, entry[0])] for dozen in (scenes, others))
    if not only():
        fill(rows, more)
        draw(rows + more)
