#!/usr/bin/env python3
"""Forces on disc cutters over depth, strength, diameter, speed, friction, facets and packings, in a block small enough for minutes.

    validate/cutting_study.py build/gneiss runs/cutting-study            # all runs that are not there yet, then the tables
    validate/cutting_study.py build/gneiss runs/cutting-study --tables   # the tables of the runs that are there

The base is scenes/cutting-disc.yaml with larger particles; every group varies one quantity of it. A run counts once: a folder with a
finished summary.json is not computed again."""
import argparse
import json
import math
import os
import subprocess

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, os.pardir, "scenes", "cutting-disc.yaml")
BASE = {"specimen.box.size": "[110 mm, 90 mm, 35 mm]", "specimen.origin": "[0 mm, -45 mm, -35 mm]", "specimen.mean_radius": "3.6 mm",
        "output.snapshots": 0, "output.history_rows": 1000, "run.threads": 1}
RADIUS, CENTRE = {"17": 216.0, "19": 241.3}, {"17": 0.212, "19": 0.2373}  # mm; m, of a cut of 4 mm


def disc(inch, depth, facet=None):
    """Overrides that put a disc at a depth, mm: its axis begins where its contact reaches the block."""
    radius = RADIUS[inch]
    ahead = math.sqrt(2 * radius * depth - depth * depth)
    keys = {"bodies.disc.disc_cutter.diameter": f"{2 * radius} mm", "bodies.disc.origin[0]": f"{-(ahead + 1)} mm",
            "bodies.disc.origin[2]": f"{radius - depth} mm", "test.depth": f"{depth} mm", "time.end": f"{(ahead + 110) / 4} ms"}
    if facet:
        keys["bodies.disc.disc_cutter.facet"] = f"{facet} mm"
    return keys


def strength(factor):
    return {"materials.rock.tensile_strength": f"{29.4 * factor} MPa", "materials.rock.shear_strength": f"{294 * factor} MPa"}


def speed(value):
    return {"bodies.disc.motion.vx": f"{value} m/s", "time.end": f"{(41.4 + 110) / value} ms"}


def runs():
    """{name: overrides}, in the order of importance."""
    found = {f"seed-{seed}": {**disc("17", 4), "run.seed": seed} for seed in (1, 2, 3)}
    for depth in (3, 6, 8):
        found |= {f"depth-{depth}-seed-{seed}": {**disc("17", depth), "run.seed": seed} for seed in (1, 2)}
    for factor in (0.5, 0.7, 1.4):
        found |= {f"strength-{factor}-seed-{seed}": {**disc("17", 4), **strength(factor), "run.seed": seed} for seed in (1, 2)}
    found |= {f"19-inch-seed-{seed}": {**disc("19", 4), "run.seed": seed} for seed in (1, 2, 3)}
    found |= {f"speed-{value}-seed-{seed}": {**disc("17", 4), **speed(value), "run.seed": seed} for value in (2, 8) for seed in (1, 2)}
    found |= {f"friction-{value}-seed-{seed}": {**disc("17", 4), "bodies.disc.friction": value, "run.seed": seed} for value in (0.1, 0.5) for seed in (1, 2)}
    found |= {f"facet-{value}-seed-1": {**disc("17", 4, value), "run.seed": 1} for value in (1.33, 5.33)}
    found |= {"radius-2.5-seed-1": {**disc("17", 4), "specimen.mean_radius": "2.5 mm", "run.seed": 1}}
    return found


def finished(folder):
    path = os.path.join(folder, "summary.json")
    if not os.path.exists(path):
        return None
    with open(path) as file:
        summary = json.load(file)
    return summary if summary["finished"] else None


def compute(program, place):
    for name, keys in runs().items():
        folder = os.path.join(place, name)
        if finished(folder):
            continue
        options = [part for key, value in {**BASE, **keys}.items() for part in ("--set", f"{key}={value}")]
        subprocess.run([program, "run", SCENE, "--out", folder, "--quiet", "--force", *options], check=False)


def readings(place, start):
    """[n] summaries of the runs whose name begins so."""
    found = [finished(os.path.join(place, name)) for name in runs() if name.startswith(start)]
    return [s for s in found if s and s["readings"]["normal_force"] is not None]


def row(place, label, start):
    some = readings(place, start)
    if not some:
        return f"| {label} | not run | | | | | |"
    columns = {name: np.array([s["readings"][name] for s in some], float)
               for name in ("normal_force", "rolling_force", "cutting_coefficient", "predicted_coefficient", "specific_energy_removed")}
    spread = f" ± {columns['normal_force'].std(ddof=1) / 1e3:.0f}" if len(some) > 1 else ""
    cost = sum(s["seconds"]["cpu"] for s in some)
    return (f"| {label} | {len(some)} | {columns['normal_force'].mean() / 1e3:.0f}{spread} | {columns['rolling_force'].mean() / 1e3:.1f} "
            f"| {columns['cutting_coefficient'].mean():.3f} | {columns['predicted_coefficient'].mean():.3f} "
            f"| {np.nanmean(columns['specific_energy_removed']) / 3.6e6:.1f} | {cost:.0f} |")


def slope(x, y):
    """Exponent of a power law and r2 of a straight line."""
    power = np.polyfit(np.log(x), np.log(y), 1)[0]
    line = np.polyfit(x, y, 1)
    off = y - np.polyval(line, x)
    return power, 1 - np.sum(off**2) / np.sum((y - np.mean(y))**2)


def means(place, starts, name):
    return np.array([np.mean([s["readings"][name] for s in readings(place, start)]) for start in starts])


def tables(place):
    print("| case | runs | normal force, kN | rolling, kN | coefficient | tan(arc/2) | energy, kWh/m3 | CPU s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    labels = {"seed": "17 inch, 4 mm, 147 MPa, 4 m/s, friction 0.3", "depth-3": "depth 3 mm", "depth-6": "depth 6 mm", "depth-8": "depth 8 mm",
              "strength-0.5": "strengths times 0.5", "strength-0.7": "strengths times 0.7", "strength-1.4": "strengths times 1.4",
              "19-inch": "19 inch", "speed-2": "2 m/s", "speed-8": "8 m/s", "friction-0.1": "friction 0.1", "friction-0.5": "friction 0.5",
              "facet-1.33": "facets halved", "facet-5.33": "facets doubled", "radius-2.5": "mean radius 2.5 mm"}
    for start, label in labels.items():
        print(row(place, label, start))
    depth, strengths = ("depth-3", "seed", "depth-6", "depth-8"), ("strength-0.5", "strength-0.7", "seed", "strength-1.4")
    for name in ("normal_force", "rolling_force"):
        if all(readings(place, start) for start in depth + strengths):
            power, _ = slope(np.array([3, 4, 6, 8.0]), means(place, depth, name))
            _, straight = slope(np.array([0.5, 0.7, 1, 1.4]), means(place, strengths, name))
            print(f"\n{name}: exponent of the depth {power:.2f}; over the strength r2 of a line {straight:.3f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("place")
    parser.add_argument("--tables", action="store_true", help="no runs")
    asked = parser.parse_args()
    if not asked.tables:
        compute(os.path.abspath(asked.program), asked.place)
    tables(asked.place)
