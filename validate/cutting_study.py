#!/usr/bin/env python3
"""Forces on disc cutters over depth, strength, diameter, speed, friction, facets and packings, in a block small enough for minutes.

    validate/cutting_study.py build/gneiss runs/cutting-study            # all runs that are not there yet, then the tables
    validate/cutting_study.py build/gneiss runs/cutting-study --tables   # the tables of the runs that are there

The base is scenes/cutting-disc.yaml with larger particles; every group varies one quantity of it, and relieved cuts are those of
scenes/cutting-relieved.yaml. A run counts once: a folder with a
finished summary.json is not computed again."""
import argparse
import json
import math
import os
import subprocess

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, os.pardir, "scenes")
BASE = {"specimen.box.size": "[110 mm, 90 mm, 35 mm]", "specimen.origin": "[0 mm, -45 mm, -35 mm]", "specimen.mean_radius": "3.6 mm",
        "output.snapshots": 0, "output.history_rows": 1000, "run.threads": 1}
FINE = {"specimen.box.size": "[130 mm, 120 mm, 45 mm]", "specimen.origin": "[0 mm, -60 mm, -45 mm]", "specimen.mean_radius": "3 mm",
        "bodies.disc.motion.vx": "8 m/s"}
LONG = {"specimen.box.size": "[200 mm, 90 mm, 35 mm]", "bodies.disc.motion.vx": "8 m/s"}
MOMENTS = {"materials.rock.contact_modulus": "34.7 GPa", "materials.rock.kratio": 9.7, "materials.rock.tensile_strength": "10.8 MPa",
           "materials.rock.shear_strength": "25.9 MPa", "materials.rock.bond_friction": 1, "bonds.radius_multiplier": 1, "bonds.moment_share": 0}
RADIUS = {"17": 216.0, "19": 241.3}  # mm


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
    found |= {f"friction-{value}-seed-{seed}": {**disc("17", 4), "bodies.disc.friction": value, "run.seed": seed}
              for value in (0.1, 0.5) for seed in (1, 2)}
    found |= {f"facet-{value}-seed-1": {**disc("17", 4, value), "run.seed": 1} for value in (1.33, 5.33)}
    for depth in (4.5, 6, 9, 12):  # three particles and more per depth
        found[f"fine-{depth}-seed-1"] = {**disc("17", depth), **FINE, "time.end": f"{(math.sqrt(432 * depth) + 130) / 8} ms", "run.seed": 1}
    for depth in (3, 4, 6, 8):  # depths of which the contact is a fifth to a third
        found[f"long-{depth}-seed-1"] = {**disc("17", depth), **LONG, "time.end": f"{(math.sqrt(432 * depth) + 200) / 8} ms", "run.seed": 1}
    for spacing in (20, 40, 60):
        found[f"spacing-{spacing}-seed-1"] = {"bodies.first.origin[1]": f"{spacing} mm", "test.spacing": f"{spacing} mm", "run.seed": 1,
                                              "specimen.box.size": "[110 mm, 130 mm, 35 mm]", "specimen.origin": "[0 mm, -45 mm, -35 mm]"}
    found |= {f"moments-seed-{seed}": {**disc("17", 4), **MOMENTS, "run.seed": seed} for seed in (1, 2)}
    found |= {"radius-2.5-seed-1": {**disc("17", 4), "specimen.mean_radius": "2.5 mm", "run.seed": 1}}
    return found


def finished(folder):
    path = os.path.join(folder, "summary.json")
    if not os.path.exists(path):
        return None
    with open(path) as file:
        summary = json.load(file)
    return summary if summary["finished"] else None


def compute(program, place, only):
    for name, keys in runs().items():
        folder = os.path.join(place, name)
        if finished(folder) or not name.startswith(only):
            continue
        options = [part for key, value in {**BASE, **keys}.items() for part in ("--set", f"{key}={value}")]
        scene = os.path.join(SCENES, "cutting-relieved.yaml" if name.startswith("spacing") else "cutting-disc.yaml")
        subprocess.run([program, "run", scene, "--out", folder, "--quiet", "--force", *options], check=False)


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
              **{f"fine-{p}": f"mean radius 3 mm, 8 m/s, depth {p} mm" for p in (4.5, 6, 9, 12)},
              **{f"long-{p}": f"block of 200 mm, 8 m/s, depth {p} mm" for p in (3, 4, 6, 8)},
              "spacing-20": "relieved, spacing 20 mm", "spacing-40": "relieved, spacing 40 mm", "spacing-60": "relieved, spacing 60 mm",
              "moments": "bonds with moments and friction, 149 and 10.3 MPa",
              "facet-1.33": "facets halved", "facet-5.33": "facets doubled", "radius-2.5": "mean radius 2.5 mm"}
    for start, label in labels.items():
        print(row(place, label, start))
    depths = {"mean radius 3.6 mm": {3: "depth-3", 4: "seed", 6: "depth-6", 8: "depth-8"},
              "mean radius 3 mm": {p: f"fine-{p}" for p in (4.5, 6, 9, 12)}, "block of 200 mm": {p: f"long-{p}" for p in (3, 4, 6, 8)}}
    strengths = ("strength-0.5", "strength-0.7", "seed", "strength-1.4")
    for name in ("normal_force", "rolling_force"):
        for title, starts in depths.items():
            there = [value for value, start in starts.items() if readings(place, start)]
            if len(there) > 2:
                power, _ = slope(np.array(there), means(place, [starts[value] for value in there], name))
                print(f"{name}: exponent of the depth {power:.2f}, {title}")
        if all(readings(place, start) for start in strengths):
            _, straight = slope(np.array([0.5, 0.7, 1, 1.4]), means(place, strengths, name))
            print(f"{name}: over the strength r2 of a line {straight:.3f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("place")
    parser.add_argument("--only", default="", metavar="NAME", help="runs whose name begins so")
    parser.add_argument("--tables", action="store_true", help="no runs")
    asked = parser.parse_args()
    if not asked.tables:
        compute(os.path.abspath(asked.program), asked.place, asked.only)
    tables(asked.place)
