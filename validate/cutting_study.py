#!/usr/bin/env python3
"""Forces on tools over depth, strength, diameter, speed, friction, facets and packings, and the cost of coupling.

    validate/cutting_study.py build/gneiss runs/cutting-study                   # all runs that are not there yet, then the tables
    validate/cutting_study.py build/gneiss runs/cutting-study --only wide       # runs whose name begins so
    validate/cutting_study.py build/gneiss runs/cutting-study --tables          # the tables of the runs that are there

Cuts in space are scenes/cutting-disc.yaml with other blocks and particles; every group varies one quantity of it, and relieved cuts are
those of scenes/cutting-relieved.yaml. Cuts in the plane are scenes/cutting-adaptive.yaml in a larger body, of particles alone, of
particles on elements, and of elements that convert. A run counts once: a folder with a finished summary.json is not computed again."""
import argparse
import json
import math
import os
import subprocess

import numpy as np
import yaml

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, os.pardir, "scenes")
# Rock whose contacts resist ten times as much shear as tension.
OLD = {"materials.rock.contact_modulus": "34.1 GPa", "materials.rock.kratio": 8.6, "materials.rock.tensile_strength": "29.4 MPa",
       "materials.rock.shear_strength": "294 MPa", "materials.rock.bond_friction": 0}
BASE = {**OLD, "specimen.box.size": "[110 mm, 90 mm, 35 mm]", "specimen.origin": "[0 mm, -45 mm, -35 mm]", "specimen.mean_radius": "3.6 mm",
        "output.snapshots": 0, "output.history_rows": 1000, "run.threads": 1}
FINE = {"specimen.box.size": "[130 mm, 120 mm, 45 mm]", "specimen.origin": "[0 mm, -60 mm, -45 mm]", "specimen.mean_radius": "3 mm",
        "bodies.disc.motion.vx": "8 m/s"}
LONG = {"specimen.box.size": "[200 mm, 90 mm, 35 mm]", "bodies.disc.motion.vx": "8 m/s"}
MOMENTS = {"materials.rock.contact_modulus": "34.7 GPa", "materials.rock.kratio": 9.7, "materials.rock.tensile_strength": "10.8 MPa",
           "materials.rock.shear_strength": "25.9 MPa", "materials.rock.bond_friction": 1, "bonds.radius_multiplier": 1, "bonds.moment_share": 0}
CALIBRATED = {"materials.rock.contact_modulus": "37.2 GPa", "materials.rock.kratio": 8.52, "materials.rock.tensile_strength": "11.25 MPa",
              "materials.rock.shear_strength": "35.5 MPa", "materials.rock.bond_friction": 0.5, "bonds.radius_multiplier": 1, "bonds.moment_share": 0}
RADIUS = {"17": 216.0, "19": 241.3, "small": 125.0}  # mm


def disc(inch, depth, facet=None):
    """Overrides that put a disc at a depth, mm: its axis begins where its contact reaches the block."""
    radius = RADIUS[inch]
    ahead = math.sqrt(2 * radius * depth - depth * depth)
    keys = {"bodies.disc.disc_cutter.diameter": f"{2 * radius} mm", "bodies.disc.origin[0]": f"{-(ahead + 1)} mm",
            "bodies.disc.origin[2]": f"{radius - depth} mm", "test.depth": f"{depth} mm", "time.end": f"{(ahead + 110) / 4} ms"}
    if facet:
        keys["bodies.disc.disc_cutter.facet"] = f"{facet} mm"
    return keys


def in_block(inch, depth, size, speed, keys):
    """Overrides for a block of length, width and height in mm, of particles of 5 mm, with the rock of the scene."""
    return {**disc(inch, depth), "specimen.box.size": "[{} mm, {} mm, {} mm]".format(*size), "specimen.mean_radius": "2.5 mm",
            "specimen.origin": f"[0 mm, {-0.5 * size[1]} mm, {-size[2]} mm]", "bodies.disc.motion.vx": f"{speed} m/s", "run.seed": 1,
            "time.end": f"{(size[0] + 2) / speed} ms", "output.energy": "off", "test.spacing": f"{size[1]} mm", **keys}


def plane(kind, depth=5, speed=3, length=280, height=160, size=4, width=12):
    """Scene of a chisel in the plane: 'particles', 'fixed' or 'adaptive', in a body of length and height, with elements of a size and a zone of
    a width, all in mm."""
    with open(os.path.join(SCENES, "cutting-adaptive.yaml")) as file:
        scene = yaml.safe_load(file)
    body, elements, tool = scene["specimen"], scene["elements"], scene["bodies"][0]
    layer = 54 if kind == "fixed" else height  # mm, with particles
    body["rectangle"] = {"width": f"{length} mm", "height": f"{layer} mm"}
    body["origin"] = ["0 mm", f"{-layer} mm"]
    held = [{"name": "rear", "select": {"end": {"axis": "x", "side": "upper", "depth": "2 mm", "by": "centre"}}, "motion": {"vx": 0, "vy": 0}},
            {"name": "base", "select": {"end": {"axis": "y", "side": "lower", "depth": "2 mm", "by": "centre"}}, "motion": {"vx": 0, "vy": 0}}]
    low = height if kind == "adaptive" else height - 42  # mm, height of the elements
    elements["rectangle"] = {"size": [f"{length} mm", f"{low} mm"], "cells": [int(length / size), math.ceil(low / size)], "origin": ["0 mm", f"{-height} mm"]}
    if kind == "adaptive":
        body["packing"]["region"] = {"min": ["0 mm", f"{-height + 14.9} mm"], "max": [f"{length - 14.9} mm", "0 mm"]}
        scene["couple"]["convert"]["width"] = f"{width} mm"
    else:
        del body["packing"]["region"]
        scene["sets"] = held if kind == "particles" else held[:1]
        scene["couple"] = {"zones": [{"edges": [{"from": ["0 mm", "-42 mm"], "to": ["0 mm", "-54 mm"]}]}]}
    if kind == "particles":
        del scene["elements"], scene["couple"]
    tool["origin"] = ["-6 mm", f"{-depth} mm"]
    tool["motion"] = {"vx": f"{speed} m/s"}
    scene["test"]["depth"] = f"{depth} mm"
    scene["output"]["snapshots"] = 0
    return scene


def chisel(depth):
    scene = plane("particles", depth, 6, 160, 100)
    scene["test"] |= {"run_in": "16 mm", "length": "60 mm"}
    scene["time"]["end"] = "30 ms"
    return scene


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
    calibrated = CALIBRATED | {"bodies.disc.disc_cutter.tip_width": "16 mm", "output.energy": "on", "test.spacing": "80 mm"}
    narrow = {"bodies.disc.disc_cutter.tip_width": "12.5 mm"}
    brittle = {key: None for key in OLD}
    found |= {f"calibrated-{depth}": in_block("17", depth, (130, 90, 45), 8, calibrated) for depth in (7.5, 10, 12.5, 15)}
    wide = {"wide": (16, {}), "second-rock": (16, {"materials.rock.tensile_strength": "21.7 MPa", "materials.rock.shear_strength": "42.8 MPa",
                                                   "test.compressive_strength": "102.6 MPa", "test.tensile_strength": "11.5 MPa"}),
            "smooth": (16, {"bodies.disc.friction": 0.1}), "slow": (8, {})}
    for name, (value, keys) in wide.items():
        found |= {f"{name}-{depth}-seed-{seed}": in_block("small", depth, (150, 130, 70), value, {**brittle, **narrow, **keys, "run.seed": seed})
                  for depth in ((5, 7.5, 10, 15) if name == "wide" else (10,)) for seed in ((1, 2) if name == "wide" else (1,))}
    found |= {f"chisel-{depth}-seed-{seed}": {"scene": chisel(depth), "run.seed": seed} for depth in (2.5, 5, 7.5, 10) for seed in (1, 2)}
    found |= {f"plane-{kind}": {"scene": plane(kind), "run.seed": 1} for kind in ("particles", "fixed", "adaptive")}
    found["plane-fine"] = {"scene": plane("adaptive", size=2.5, width=8), "run.seed": 1}
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
    os.makedirs(place, exist_ok=True)
    for name, keys in runs().items():
        folder = os.path.join(place, name)
        if finished(folder) or not name.startswith(only):
            continue
        scene = os.path.join(SCENES, "cutting-relieved.yaml" if name.startswith("spacing") else "cutting-disc.yaml")
        if "scene" in keys:
            scene = os.path.join(place, f"{name}.yaml")
            with open(scene, "w") as file:
                yaml.safe_dump(keys["scene"], file)
        given = {**({} if "scene" in keys else BASE), **keys, "run.threads": 1}
        options = [part for key, value in given.items() if key != "scene" and value is not None for part in ("--set", f"{key}={value}")]
        subprocess.run([program, "run", scene, "--out", folder, "--quiet", "--force", *options], check=False)


def readings(place, start):
    """[n] summaries of the runs whose name begins so."""
    found = [finished(os.path.join(place, name)) for name in runs() if name == start or name.startswith(start if start.endswith("-") else start + "-")]
    return [s for s in found if s and s["readings"]["normal_force"] is not None]


def row(place, label, start):
    some = readings(place, start)
    if not some:
        return f"| {label} | not run | | | | | |"
    columns = {name: np.array([s["readings"][name] for s in some], float)
               for name in ("normal_force", "rolling_force", "cutting_coefficient", "predicted_coefficient", "specific_energy_removed")}
    spread = f" ± {columns['normal_force'].std(ddof=1) / 1e3:.0f}" if len(some) > 1 else ""
    cost = sum(s["seconds"]["cpu"] for s in some)
    model = columns["predicted_coefficient"].mean()
    return (f"| {label} | {len(some)} | {columns['normal_force'].mean() / 1e3:.0f}{spread} | {columns['rolling_force'].mean() / 1e3:.1f} "
            f"| {columns['cutting_coefficient'].mean():.3f} | {'-' if np.isnan(model) else f'{model:.3f}'} "
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
              **{f"calibrated-{p}": f"calibrated to all strengths, block of 130 x 90 x 45 mm, {p} mm" for p in (7.5, 10, 12.5, 15)},
              **{f"wide-{p}": f"disc of 250 mm, block of 150 x 130 x 70 mm, {p} mm" for p in (5, 7.5, 10, 15)},
              "second-rock-10": "the same, 10 mm, second rock", "smooth-10": "the same, 10 mm, friction 0.1", "slow-10": "the same, 10 mm, 8 m/s",
              **{f"chisel-{p}": f"chisel in the plane, {p} mm" for p in (2.5, 5, 7.5, 10)},
              **{f"plane-{kind}": f"chisel in the plane, 5 mm, {kind}" for kind in ("particles", "fixed", "adaptive", "fine")},
              "facet-1.33": "facets halved", "facet-5.33": "facets doubled", "radius-2.5": "mean radius 2.5 mm"}
    for start, label in labels.items():
        print(row(place, label, start))
    depths = {"mean radius 3.6 mm": {3: "depth-3", 4: "seed", 6: "depth-6", 8: "depth-8"},
              "mean radius 3 mm": {p: f"fine-{p}" for p in (4.5, 6, 9, 12)}, "block of 200 mm": {p: f"long-{p}" for p in (3, 4, 6, 8)},
              "calibrated": {p: f"calibrated-{p}" for p in (7.5, 10, 12.5, 15)}, "wide block": {p: f"wide-{p}" for p in (5, 7.5, 10, 15)},
              "chisel": {p: f"chisel-{p}" for p in (2.5, 5, 7.5, 10)}}
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


def picture(place, path):
    """Forces and coefficient over the depth beside the model of the Colorado School of Mines, and of a chisel beside Evans."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.3), constrained_layout=True)
    panels = ((axes[0], "wide", (("normal_force", "normal", "#333333"), ("rolling_force", "rolling", "#b3261e")), 1e-3, "mean force [kN]"),
              (axes[1], "wide", (("cutting_coefficient", "rolling over normal", "#333333"),), 1, "coefficient [1]"),
              (axes[2], "chisel", (("rolling_force", "mean", "#b3261e"), ("peak_rolling_force", "peak", "#333333")), 1e-3, "force along the cut [kN/m]"))
    for axis, group, names, factor, label in panels:
        found = {float(name.split("-")[1]): name for name in runs() if name.startswith(group)}
        depths = [depth for depth in sorted(found) if readings(place, f"{group}-{depth:g}")]
        of = [readings(place, f"{group}-{depth:g}") for depth in depths]
        for name, text, color in names:
            axis.plot(depths, [factor * np.mean([s["readings"][name] for s in some]) for some in of], "o-", color=color, label=text)
            guess = {"cutting_coefficient": "predicted_coefficient", "peak_rolling_force": "predicted_peak_evans"}.get(name, "predicted_" + name)
            model = [some[0]["readings"].get(guess) for some in of]
            if model and None not in model:
                axis.plot(depths, factor * np.array(model), "--", color=color, label=f"{text}, closed form")
        axis.set(xlabel="depth of the cut [mm]", ylabel=label, xlim=(0, None), ylim=(0, None))
        axis.legend(fontsize=7)
    axes[0].set_title("disc of 250 mm")
    axes[2].set_title("chisel in the plane")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("place")
    parser.add_argument("--only", default="", metavar="NAME", help="runs whose name begins so")
    parser.add_argument("--tables", action="store_true", help="no runs")
    parser.add_argument("--picture", metavar="FILE", help="write forces over depth as an image")
    asked = parser.parse_args()
    if not asked.tables:
        compute(os.path.abspath(asked.program), asked.place, asked.only)
    tables(asked.place)
    if asked.picture:
        picture(asked.place, asked.picture)
