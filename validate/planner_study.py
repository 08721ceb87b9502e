"""Whether `gneiss plan --error` keeps what it promises: scenes that the study of accuracy did not use, the proposed settings beside a much
finer run. Fills docs/evidence/planner.md; ten minutes of one core.

    /usr/bin/python3 validate/planner_study.py [--fresh] [--only SCENE]

Seconds are CPU seconds of one thread. The scenes were written before any of them was run, and are left as they were.
"""
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
SLOWER, SAFETY, SEEDS, FIRST = 4, 0.6, 8, 101  # of the finer runs: loading, step, packings, the first of their seeds
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
    """{name: (what it is, wanted error, reading, the scene)}"""
    yield "prism", "compression of a prism, arithmetic law, strong in shear", 0.10, "strength", scene(
        "compression", {"box": {"size": [0.02, 0.02, 0.04]}, "particles": 500},
        rock(contact_modulus=30e9, tensile_strength=20e6, shear_strength=60e6), "arithmetic", {"length": 0.04, "area": 4e-4}, 6e-3,
        walls=plates(2, 0, 0.04, 0.1, 2e7))
    yield "cube", "compression of a cube, harmonic law", 0.08, "strength", scene(
        "compression", {"box": {"size": [0.03, 0.03, 0.03]}, "particles": 600},
        rock(contact_modulus=15e9, kratio=2, friction=0.3, tensile_strength=30e6, shear_strength=30e6), "harmonic",
        {"length": 0.03, "area": 9e-4}, 8e-3, walls=plates(2, 0, 0.03, 0.05, 3e7))
    yield "stub", "compression of a large stout cylinder, wide sizes", 0.10, "strength", scene(
        "compression", {"cylinder": {"diameter": 0.1, "height": 0.12}, "particles": 700, "packing": {"size_ratio": 5, "overlap": "passive"}},
        rock(contact_modulus=20e9, kratio=4, tensile_strength=15e6, shear_strength=25e6), "harmonic",
        {"length": 0.12, "diameter": 0.1}, 20e-3, walls=plates(2, 0, 0.12, 0.1, 2e8))
    yield "sections", "compression of a prism, law by area (polyhedra)", 0.10, "strength", scene(
        "compression", {"box": {"size": [0.03, 0.03, 0.06]}, "particles": 400},
        rock(kratio=0, young=40e9, poisson=0.2, tensile_strength=8e6, shear_strength=20e6), "polyhedron",
        {"length": 0.06, "area": 9e-4}, 6e-3, walls=plates(2, 0, 0.06, 0.05, 5e8))
    yield "bar", "tension of a bar, arithmetic law", 0.05, "strength", scene(
        "tension", {"box": {"size": [0.015, 0.015, 0.045]}, "particles": 500},
        rock(contact_modulus=25e9, tensile_strength=12e6, shear_strength=30e6), "arithmetic", {"length": 0.045, "area": 2.25e-4}, 4e-3,
        sets=grips(2, 1e-3, 0.02))
    yield "soft core", "tension of a large soft cylinder, mean radius", 0.05, "strength", scene(
        "tension", {"cylinder": {"diameter": 0.08, "height": 0.16}, "particles": 600},
        rock(contact_modulus=2e9, kratio=2.5, tensile_strength=3e6, shear_strength=6e6), "mean_radius", {"length": 0.16, "diameter": 0.08}, 60e-3,
        sets=grips(2, 4e-3, 0.02))
    yield "core stiffness", "stiffness of that core", 0.03, "stiffness", scene(
        "tension", {"cylinder": {"diameter": 0.08, "height": 0.16}, "particles": 600},
        rock(contact_modulus=2e9, kratio=2.5, tensile_strength=3e6, shear_strength=6e6), "mean_radius", {"length": 0.16, "diameter": 0.08}, 60e-3,
        sets=grips(2, 4e-3, 0.02))
    yield "plate", "compression of discs, harmonic law", 0.10, "strength", scene(
        "compression", {"rectangle": {"width": 0.05, "height": 0.1}, "particles": 600},
        rock(contact_modulus=20e9, kratio=2.5, tensile_strength=10e6, shear_strength=40e6), "harmonic", {"length": 0.1, "area": 0.05}, 20e-3, 2,
        walls=plates(1, 0, 0.1, 0.02, 2e9))
    yield "strip", "tension of discs, uniform law", 0.10, "strength", scene(
        "tension", {"rectangle": {"width": 0.04, "height": 0.1}, "particles": 500},
        rock(normal_stiffness=1e10, kratio=2, bond_tension_limit=3e3, bond_shear_limit=9e3), "uniform", {"length": 0.1, "area": 0.04}, 10e-3, 2,
        sets=grips(1, 2e-3, 0.01))
    yield "chamfered", "compression of discs in an octagon, arithmetic law", 0.10, "strength", scene(
        "compression", {"polygon": [[0.01, 0], [0.05, 0], [0.06, 0.01], [0.06, 0.09], [0.05, 0.1], [0.01, 0.1], [0, 0.09], [0, 0.01]],
                        "particles": 600},
        rock(contact_modulus=40e9, tensile_strength=20e6, shear_strength=40e6), "arithmetic", {"length": 0.1, "area": 0.06}, 20e-3, 2,
        walls=plates(1, 0, 0.1, 0.03, 4e9))
    beam = {"motions": [{"name": "supports", "group": "supports", "motion": {"vy": 0}}, {"name": "pin", "group": "support_left", "motion": {"vx": 0}},
                        {"name": "load", "group": "load", "motion": {"vy": [[0, -0.01], [1e-3, -0.01], [1.001e-3, 0]]}}]}
    yield "beam", "stiffness of a notched beam of elements", 0.05, "stiffness", {
        "dimension": 2, "elements": {"beam": {"length": 0.3, "height": 0.06, "span": 0.26, "notch_depth": 0.02, "notch_width": 0.002, "cell": 0.004},
                                     "materials": [{"young": 25e9, "poisson": 0.25, "density": 2300}], **beam},
        "damping": {"background": {"model": "viscous", "coefficient": 16000}},
        "test": {"kind": "compression", "axis": "y", "lower": "supports", "upper": "load"}, "time": {"end": 4e-3},
        "output": OUTPUT, "run": {"threads": 1}}
    yield "bent strip", "stiffness of a strip of elements that is bent", 0.05, "stiffness", {
        "dimension": 2, "elements": {"rectangle": {"size": [0.4, 0.05], "cells": [32, 4]}, "materials": [{"young": 70e9, "poisson": 0.3, "density": 2700}],
                                     "motions": [{"name": "clamp", "group": "x_lower", "motion": {"vx": 0, "vy": 0}},
                                                 {"name": "tip", "group": "x_upper", "motion": {"vy": [[0, -0.01], [4e-3, -0.01], [4.001e-3, 0]]}}]},
        "damping": {"background": {"model": "viscous", "coefficient": 3000}},
        "test": {"kind": "compression", "axis": "y", "lower": "clamp", "upper": "tip", "length": 0.05, "area": 0.05}, "time": {"end": 15e-3},
        "output": OUTPUT, "run": {"threads": 1}}


# --- runs --------------------------------------------------------------------------------------------------

READINGS = {"strength": "peak_stress", "stiffness": "young_modulus_average"}


def call(arguments):
    """The program; packings are made anew by every run, so that each pays for its own."""
    environment = dict(os.environ, OMP_WAIT_POLICY="passive", GNEISS_CACHE="off")
    done = subprocess.run([study.PROGRAM, *map(str, arguments)], cwd=study.ROOT, env=environment, text=True, capture_output=True)
    if done.returncode:
        sys.exit(f"gneiss {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stderr[-2000:]}")
    return done.stdout


def planned(name, wanted, reading, keys):
    """The plan, and the file of the scene with what it proposes."""
    folder = FOLDER / name.replace(" ", "-")
    if study.FRESH:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.yaml").write_text(json.dumps({"title": name, **keys}, indent=1))
    kept = folder / "plan.json"
    if not kept.exists():
        said = call(["plan", folder / "scene.yaml", "--error", wanted, "--reading", reading, "--threads", 1, "--write", folder / "planned.yaml",
                     "--force", "--log", "json"])
        kept.write_text(said.splitlines()[-1])
    return folder, json.loads(kept.read_text())


def one(folder, scene_file, settings, reading):
    """Reading and CPU seconds of a run; kept."""
    out = FOLDER / folder
    if not (out / "summary.json").exists():
        call(["run", scene_file, "--out", out, "--threads", 1, "--quiet", "--force", *study.set_arguments(settings)])
    summary = json.loads((out / "summary.json").read_text())
    if "elements" in summary["counts"]:  # the stress of the way that the ends were moved, at rest
        value = study.Run(out, {"code": 0, "message": ""}).results("history/stress")[-1]
    else:
        value = summary["readings"][READINGS[reading]]
    return float("nan") if value is None else value, summary["seconds"]["cpu"], summary["steps"]


def motions(keys, slower):
    """Everything that moves, slower, and the end as much later."""
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
        return {"elements.rectangle.cells": f"[{layers * 8}, {layers}]"}
    return {**motions(keys, SLOWER / p["pace"]), "time.safety": SAFETY}


def measured(name, what, wanted, reading, keys):
    """A row of the table."""
    folder, plan = planned(name, wanted, reading, keys)
    p, place = plan["proposed"], folder.name
    elements = "elements" in keys
    ours = [one(f"{place}/run-{seed}", folder / "planned.yaml", {"run.seed": seed}, reading) for seed in range(1, p["packings"] + 1)]
    settings = finer_settings(name, keys, plan)
    seeds = [FIRST] if elements else range(FIRST, FIRST + SEEDS)
    fine = [one(f"{place}/fine-{seed}", folder / "scene.yaml", {**settings, "run.seed": seed}, reading) for seed in seeds]
    value, truth = np.mean([row[0] for row in ours]), np.mean([row[0] for row in fine])
    doubt = np.std([row[0] for row in fine], ddof=1) / np.sqrt(len(fine)) / truth if len(fine) > 1 else 0.0
    found, seconds = abs(value / truth - 1), sum(row[1] for row in ours)
    print(f"{name}: predicted {p['error']:.3f}, found {found:.3f} (+- {doubt:.3f}); {p['seconds']:.2f} s, {seconds:.2f} s; steps {p['steps']:.0f}, "
          f"{np.mean([row[2] for row in ours]):.0f}; {json.dumps(plan['estimate'])}", flush=True)
    return {"name": name, "what": what, "wanted": wanted, "reading": reading, "plan": plan, "found": found, "doubt": doubt, "seconds": seconds,
            "signed": value / truth - 1, "steps": np.mean([row[2] for row in ours]), "value": truth, "fine_seconds": sum(row[1] for row in fine)}


def only():
    return sys.argv[sys.argv.index("--only") + 1] if "--only" in sys.argv else None


if __name__ == "__main__":
    rows = [measured(*entry) for entry in scenes() if only() in (None, entry[0])]
