"""Clumps of spheres: angles of repose beside rolling resistance of spheres, and the cost of a step. Writes docs/evidence/clumps.md; one
thread, some ten minutes of one core.

    /usr/bin/python3 validate/clump_study.py [words of the titles of sections]
"""
import json
import resource
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

import study

D = 3e-3  # m, diameter of the sphere with the volume of every grain
GRAIN = {"name": "grain", "density": 2500, "young": 2e6, "poisson": 0.25, "friction": 0.4, "restitution": 0.5}
# Centres over the radius of the spheres.
SHAPES = {"sphere": [[0, 0, 0]],
          "two spheres": [[-0.6, 0, 0], [0.6, 0, 0]],
          "three in a triangle": [[0, 0, 0], [1.1, 0, 0], [0.55, 0.9526, 0]],
          "four in a tetrahedron": [[0.6, 0.6, 0.6], [0.6, -0.6, -0.6], [-0.6, 0.6, -0.6], [-0.6, -0.6, 0.6]]}


def volume(centres):
    """Volume of the union of spheres of radius 1, counted on a grid: to about 1e-3, and at D no more is needed."""
    low, high = np.min(centres, axis=0) - 1, np.max(centres, axis=0) + 1
    axes = [np.arange(a, b, 0.02) + 0.01 for a, b in zip(low, high)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    inside = np.zeros(x.shape[:3], dtype=bool)
    for c in centres:
        inside |= ((x - c)**2).sum(axis=-1) < 1
    return inside.sum() * 0.02**3


def rows(name, volume_of_grain):
    """The spheres of a shape, m, so that its volume is the given one, m3."""
    centres = np.array(SHAPES[name], dtype=float)
    r = (volume_of_grain / volume(centres))**(1 / 3)
    return [[*(r * c), r] for c in centres.tolist() for c in [np.array(c)]]


def run(name, scene, **settings):
    path = study.RUNS / "clumps" / f"{name}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"dimension": 3, "law": {"stiffness": "hertz"}, "gravity": [0, 0, -9.81], **scene}, indent=1,
                               default=float))
    return study.run(f"clumps/{name}", path, {"run.threads": 1, "output.snapshots": 0, **settings})


# --- angle of repose ---------------------------------------------------------------------------------------

def heap(shape, rolling, seed):
    """Angle, degrees, of the cone whose middle is that of a heap of 400 grains."""
    wide = 16 * D
    grain = {**GRAIN, "rolling_friction": rolling}
    done = run(f"heap-{shape.replace(' ', '-')}-{rolling}-{seed}", {
        "run": {"seed": seed}, "materials": [grain], "damping": {"background": {"model": "viscous", "coefficient": 0.5}},
        "clumps": {"shapes": [{"name": "a", "spheres": rows(shape, np.pi / 6 * D**3)}],
                   "filled": [{"shapes": "a", "box": {"min": [-0.33 * wide, -0.33 * wide, 0.5e-3], "max": [0.33 * wide, 0.33 * wide, 0.07]},
                               "count": 400, "velocity": [0, 0, -0.5]}]},
        "bodies": [{"name": "tube", "cylinder": {"diameter": wide, "height": 0.1, "sides": 48, "open": True}, "origin": [0, 0, 2e-4],
                    "friction": 0.1, "motion": {"vz": [[0, 0], [0.25, 0], [0.3, 0.12], [3, 0.12]]}}],
        "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.9, "rolling_friction": 0.5}],
        "domain": {"min": [-0.4, -0.4, -0.05], "max": [0.4, 0.4, 0.5], "lost": "remove"},
        "time": {"end": 1.1}, "output": {"history_rows": 50}})
    x, mass = done.results("particles/position"), done.results("particles/mass").reshape(-1)
    there = mass > 0
    part = mass[there] / mass[there].sum()
    away = np.hypot(x[there, 0], x[there, 1])
    return float(np.degrees(np.arctan(2 * (part @ x[there, 2]) / (part @ away))))


def repose():
    table = []
    for shape, rolling in [("sphere", 0.0), ("sphere", 0.05), ("sphere", 0.2), *((s, 0.0) for s in SHAPES if s != "sphere")]:
        found = np.array([heap(shape, rolling, seed) for seed in (1, 2, 3)])
        table.append([shape, rolling, f"{found.mean():.1f} +- {found.std(ddof=1) / np.sqrt(3):.1f}"])
    return study.table(("grains", "mu_r", "angle, degrees"), table)


# --- cost --------------------------------------------------------------------------------------------------

WIDE, R = 0.04, 2.5e-3  # m
REST, TURNS = 0.4, 6  # s, at rest; turns of timing


def bed(shape):
    """A bed of some 1300 spheres of one radius in a box, free or as clumps."""
    size = len(SHAPES[shape]) if shape else 1
    matter = {"specimen": {"lattice": {"kind": "hcp", "radius": R, "cells": [7, 4, 12], "origin": [1e-3, 1e-3, 3e-3], "spacing": 1.03,
                                       "jitter": 0.02}, "group": 0}}
    if shape:
        spheres = [[*(R * np.array(c)), R] for c in SHAPES[shape]]
        matter = {"clumps": {"shapes": [{"name": "a", "spheres": spheres}],
                             "filled": [{"shapes": "a", "box": {"min": [0, 0, 0], "max": [WIDE, WIDE, 1.2]}, "count": 1344 // size,
                                         "velocity": [0, 0, -2]}]}}
    walls = [{"name": f"{axis}{sign}", "point": [WIDE * (axis == "x") * (sign < 0), WIDE * (axis == "y") * (sign < 0), 0],
              "normal": [sign * (axis == "x"), sign * (axis == "y"), 0], "friction": 0.5} for axis in "xy" for sign in (1, -1)]
    return run(f"bed-{(shape or 'free').replace(' ', '-')}", {
        "materials": [{**GRAIN, "young": 1e7}], **matter,
        "walls": [*walls, {"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.5}],
        "domain": {"min": [-1, -1, -1], "max": [1, 1, 3]}, "time": {"end": REST}, "output": {"history_rows": 5}})


def spent(folder, end):
    """(steps, s of processor time) of a copy of a run that is resumed up to an end."""
    with tempfile.TemporaryDirectory() as base:
        copy = Path(base) / "run"
        shutil.copytree(folder, copy)
        before, used = json.loads((copy / "summary.json").read_text())["steps"], resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        study.call(["resume", str(copy), "--quiet", "--set", f"time.end={end}"])
        return json.loads((copy / "summary.json").read_text())["steps"] - before, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - used


def cost():
    names = (None, "two spheres", "three in a triangle", "four in a tetrahedron")
    beds = {name: bed(name) for name in names}
    least = {}
    for _ in range(TURNS):
        for name in names:
            for end in (REST + 0.02, REST + 0.12):
                steps, seconds = spent(beds[name].folder, end)
                least[name, end] = steps, min(seconds, least.get((name, end), (0, np.inf))[1])
    table, free = [], None
    for name in names:
        (a, first), (b, last) = (least[name, end] for end in (REST + 0.02, REST + 0.12))
        count = len(beds[name].results("particles/id"))
        each = 1e9 * (last - first) / (b - a) / count
        free = free or each
        table.append([name or "free spheres", count, f"{each:.0f}", f"{each / free:.2f}"])
    return study.table(("members", "spheres", "ns of a core per sphere and step", "over free spheres"), table)


SECTIONS = {
    "Angle of repose": (repose, """400 grains in a tube, 16 d wide, that is lifted by 0.12 m/s from a rough floor (friction 0.9). All grains have the volume of a sphere with d = 3
mm, the friction 0.4, E = 2 MPa and the restitution 0.5. The angle is that of the cone whose middle is that of the heap, tan = 2 z/r with the means by mass of height and
of distance from the axis: mean of three heaps (seeds) and its standard error, as in the page on [granular flow](granular.md#angle-of-repose)."""),
    "Cost": (cost, """Beds of spheres of one radius (Hertz-Mindlin contacts with friction and damping, energy ledger) at rest in a box, free or as clumps: the difference of
processor time of one thread between 0.52 and 0.42 s over that of steps and spheres, each the least of six turns. Clumps have fewer contacts per sphere than free
spheres."""),
}


def main():
    wanted = [a for a in sys.argv[1:] if not a.startswith("--")]
    for title, (make, words) in SECTIONS.items():
        if not wanted or any(w in title for w in wanted):
            study.section("clumps.md", title, words + "\n\n" + make())


if __name__ == "__main__":
    main()
