#!/usr/bin/env python3
"""Forces on tools beside published ones, over depth, strength, friction, diameter, speed and spacing, and the cost of coupling.

    validate/cutting_study.py build/gneiss runs/cutting-study                    # all runs that are not there yet, then the tables
    validate/cutting_study.py build/gneiss runs/cutting-study --only trend base  # runs whose name begins so
    validate/cutting_study.py build/gneiss runs/cutting-study --tables           # the tables of the runs that are there

Rocks are calibrated first (`rock-...`, files in validate/references), and other runs take their contacts from these calibrations; the first
rock is that of the scenes. Cuts in space are scenes/cutting-disc.yaml with other discs, blocks and particles, relieved cuts those of
scenes/cutting-relieved.yaml, cuts in the plane those of scenes/cutting-adaptive.yaml. A run counts once: a folder with a finished
summary.json is not computed again."""
import argparse
import functools
import json
import math
import os
import subprocess

import h5py
import numpy as np
import yaml

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, os.pardir, "scenes")
QUIET = {"output.snapshots": 0, "output.history_rows": 1000, "run.threads": 1}
# Strengths in compression and tension, MPa, and the file from which the contacts of a rock are calibrated.
ROCKS = {"first": (147.3, 10.2, None), "second": (102.6, 11.5, "disc-cutting-rock-second"), "beishan": (169.5, 13, "beishan-granite"),
         "second-moments": (102.6, 11.5, "disc-cutting-rock-second-moments")}
# Contacts with moments that have all strengths of the first rock (validate/references/disc-cutting-rock-moments.yaml).
MOMENTS = {"materials.rock.contact_modulus": "37.2 GPa", "materials.rock.kratio": 8.52, "materials.rock.tensile_strength": "11.25 MPa",
           "materials.rock.shear_strength": "35.5 MPa", "materials.rock.bond_friction": 0.5, "bonds.radius_multiplier": 1, "bonds.moment_share": 0}
# Rings in mm: diameter, width of the tip, radius of its edges, angle of the bevel in degrees. The published 17 inch ring has at a depth of
# 3.9 mm an immersed section that is 75 % larger than that of the bevelled one of 19 inch: with these profiles 73 %.
RINGS = {"17": (431.8, 12.7, 3, 180), "19": (482.6, 16, 0, 120), "17-flat": (431.8, 19, 3, 180), "19-flat": (482.6, 19, 3, 180), "17-round": (431.8, 19, 9, 180),
         "250": (250, 12.5, 3, 180), "432": (432, 12.5, 3, 180), "483": (482.6, 12.5, 3, 180), "120": (120, 12.5, 3, 180)}
SIDES = {"sets.right.motion": "{vy: 0}", "sets.left.motion": "{vy: 0}"}  # held across the cut alone


def ahead(ring, depth):
    """Length by which the contact of a disc reaches ahead of its axis, mm."""
    return math.sqrt(RINGS[ring][0] * depth - depth * depth)


def disc(ring, depth, name="disc", lag=0.0, finer=1):
    """Overrides for a disc at a depth, mm, that begins where its contact, or that of a disc ahead of it by `lag`, reaches the block. Its facets
    are smaller than the radius of the particles, and by `finer` times."""
    diameter, tip, rounding, bevel = RINGS[ring]
    body, facet = f"bodies.{name}", min(2.4, tip / 6) / finer
    return {f"{body}.disc_cutter": f"{{diameter: {diameter} mm, tip_width: {tip} mm, tip_radius: {rounding} mm, bevel_angle: {bevel} deg, facet: {facet} mm}}",
            f"{body}.origin[0]": f"{-(ahead(ring, depth) + 1 + lag)} mm", f"{body}.origin[2]": f"{diameter / 2 - depth} mm"}


def cut(ring, depth, size, radius, speed, leave=0.0, **keys):
    """Overrides for a cut in a block of length, width and height, mm, of particles of a mean radius. The path of the means ends `leave` before
    the contact reaches the rear end."""
    reach = ahead(ring, depth)
    given = {**disc(ring, depth), **block(size), "specimen.mean_radius": f"{radius} mm", "bodies.disc.motion.vx": f"{speed} m/s",
             "time.end": f"{(size[0] + 3) / speed} ms", "test.depth": f"{depth} mm", "test.spacing": f"{size[1]} mm"}
    if leave:
        given["test.length"] = f"{size[0] - reach - leave} mm"
    return given | keys


def block(size):
    return {"specimen.box.size": "[{} mm, {} mm, {} mm]".format(*size), "specimen.origin": f"[0 mm, {-0.5 * size[1]} mm, {-size[2]} mm]"}


def rock(place, name):
    """Overrides for the contacts of a calibrated rock; None: it is not calibrated yet."""
    compression, tension, file = ROCKS[name]
    strengths = {"test.compressive_strength": f"{compression} MPa", "test.tensile_strength": f"{tension} MPa"}
    if not file:
        return strengths
    path = os.path.join(place, f"rock-{name}", "calibration.json")
    if not os.path.exists(path):
        return None
    with open(path) as found:
        parameters = json.load(found)["parameters"]
    bonds = {"bonds.radius_multiplier": 1, "bonds.moment_share": 0} if name.endswith("moments") else {}
    return strengths | bonds | {f"materials.rock.{key}": float(f"{value['value']:.4g}") for key, value in parameters.items()}


def stronger(factor):
    """Overrides for the first rock with other strengths of its contacts."""
    return {"materials.rock.tensile_strength": f"{31.1 * factor} MPa", "materials.rock.shear_strength": f"{61.4 * factor} MPa",
            "test.compressive_strength": f"{147.3 * factor} MPa", "test.tensile_strength": f"{10.2 * factor} MPa"}


# --- scenes that are more than overrides ---


@functools.cache
def text_of(name):
    with open(os.path.join(SCENES, f"cutting-{name}.yaml")) as file:
        return json.dumps(yaml.safe_load(file))


def scene_of(name):
    return json.loads(text_of(name))


def plane(kind, depth=5, speed=3, length=280, height=160, size=4, width=12, stress=8):
    """Scene of a chisel in the plane: 'particles', 'fixed' or 'adaptive', in a body of length and height, with elements of a size and a zone of
    a width, all in mm; elements convert at a stress in MPa."""
    scene = scene_of("adaptive")
    body, elements, tool = scene["specimen"], scene["elements"], scene["bodies"][0]
    layer = 42 + width if kind == "fixed" else height  # mm, with particles
    body["rectangle"] = {"width": f"{length} mm", "height": f"{layer} mm"}
    body["origin"] = ["0 mm", f"{-layer} mm"]
    held = [{"name": "rear", "select": {"end": {"axis": "x", "side": "upper", "depth": "2 mm", "by": "centre"}}, "motion": {"vx": 0, "vy": 0}},
            {"name": "base", "select": {"end": {"axis": "y", "side": "lower", "depth": "2 mm", "by": "centre"}}, "motion": {"vx": 0, "vy": 0}}]
    low = height if kind == "adaptive" else height - 42  # mm, height of the elements
    elements["rectangle"] = {"size": [f"{length} mm", f"{low} mm"], "cells": [int(length / size), math.ceil(low / size)], "origin": ["0 mm", f"{-height} mm"]}
    if kind == "adaptive":
        body["packing"]["region"] = {"min": ["0 mm", f"{-height + 14.9} mm"], "max": [f"{length - 14.9} mm", "0 mm"]}
        scene["couple"]["convert"] |= {"width": f"{width} mm", "stress": f"{stress} MPa"}
    else:
        del body["packing"]["region"]
        scene["sets"] = held if kind == "particles" else held[:1]
        scene["couple"] = {"zones": [{"edges": [{"from": ["0 mm", "-42 mm"], "to": ["0 mm", f"{-layer} mm"]}]}]}
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


def in_space(kind, size=(130, 230, 120), cells=10, width=15, stress=27):
    """Scene of a disc of 120 mm in a body of length, width and height, mm: 'particles', 'fixed' (particles 55 mm deep, and a zone of a width) or
    'adaptive' (elements of 10 mm that convert at a stress, MPa, or within 6 mm of the disc)."""
    scene = scene_of("coupled")
    length, across, high = size
    deep = 55 + width if kind == "fixed" else high
    scene["specimen"] |= {"box": {"size": [f"{length} mm", f"{across} mm", f"{deep} mm"]}, "origin": ["0 mm", f"{-across / 2} mm", f"{-deep} mm"],
                          "mean_radius": "2.5 mm", "packing": {"size_ratio": 2, "overlap": "passive"}}
    low = high - 55 if kind == "fixed" else high
    scene["elements"]["box"] = {"size": [f"{length} mm", f"{across} mm", f"{low} mm"], "cells": [round(length / cells), round(across / cells), round(low / cells)],
                                "origin": ["0 mm", f"{-across / 2} mm", f"{-high} mm"]}
    scene["couple"] = {"zones": [{"edges": [{"from": [0, 0, "-55 mm"], "to": [0, 0, f"{-deep} mm"]}]}]}
    if kind == "adaptive":
        edge = cells + 0.1
        scene["specimen"]["packing"]["region"] = {"min": ["-0.1 mm", f"{-across / 2 + edge} mm", f"{-high + edge} mm"],
                                                  "max": [f"{length + 0.1} mm", f"{across / 2 - edge} mm", "0.1 mm"]}
        scene["couple"] = {"convert": {"width": f"{width} mm", "bodies": "6 mm", "stress": f"{stress} MPa", "every": 50}}
    if kind != "adaptive":
        scene["sets"] = [{"name": name, "select": {"end": {"axis": axis, "side": side, "depth": "5 mm", "by": "centre"}}, "motion": {"vx": 0, "vy": 0, "vz": 0}}
                         for name, axis, side in (("lower side", "y", "lower"), ("upper side", "y", "upper"), ("lower end", "z", "lower"))][:2 if kind == "fixed" else 3]
    for motion in scene["elements"]["motions"]:
        motion["motion"] = {"vx": 0, "vy": 0, "vz": 0}
    if kind == "particles":
        del scene["elements"], scene["couple"]
    return scene


def full_size():
    """Scene of the published size: particles down to 62 mm in a block of 400 x 150 x 400 mm, elements below 40 mm."""
    scene = scene_of("coupled")
    scene["specimen"] |= {"box": {"size": ["400 mm", "150 mm", "62 mm"]}, "origin": ["0 mm", "-75 mm", "-62 mm"], "mean_radius": "2.55 mm"}
    scene["elements"]["box"] = {"size": ["400 mm", "150 mm", "360 mm"], "cells": [20, 8, 18], "origin": ["0 mm", "-75 mm", "-400 mm"]}
    scene["couple"] = {"zones": [{"edges": [{"from": [0, 0, "-40 mm"], "to": [0, 0, "-60 mm"]}]}]}
    scene["sets"] = [{"name": side, "select": {"end": {"axis": "y", "side": end, "depth": "5 mm", "by": "centre"}}, "motion": {"vy": 0}}
                     for side, end in (("beside right", "lower"), ("beside left", "upper"))]
    scene["test"] |= {"compressive_strength": "147.3 MPa", "tensile_strength": "10.2 MPa"}
    return scene


# --- runs ---


def published(place):
    """Unrelieved cuts of the published simulation and the measured cut in Beishan granite: blocks of 130 x 150 x 60 mm, 8 m/s."""
    found = {}
    for stone, depth, rings in (("first", 3.9, ("19", "17")), ("beishan", 4, ("19-flat", "17-flat")), ("second", 3.2, ("19", "17"))):
        contacts = rock(place, stone)
        for seed in (1, 2, 3) if contacts is not None else ():
            for ring in rings:
                sides = {} if stone == "beishan" else SIDES
                found[f"published-{stone}-{ring}-seed-{seed}"] = cut(ring, depth, (130, 150, 60), 2.55, 8, 15, **sides, **contacts, **{"run.seed": seed})
            if stone == "beishan":  # a round edge, and smaller particles around the path
                found[f"published-beishan-17-round-seed-{seed}"] = cut("17-round", depth, (130, 150, 60), 2.55, 8, 15, **contacts, **{"run.seed": seed})
                found[f"published-beishan-17-fine-seed-{seed}"] = found[f"published-beishan-17-flat-seed-{seed}"] | {
                    "specimen.packing.refine": "[{from: [0 mm, -16 mm, -8 mm], to: [130 mm, 16 mm, 0 mm], size: 0.5, distance: 8 mm}]"}
    return found


def trends():
    """A disc of 120 mm 10 mm deep, two particles over the depth, in a block of 110 x 110 x 60 mm: one quantity is varied at a time."""
    cases = {"base": (16, {}), "strength-0.7": (16, stronger(0.7)), "strength-1.4": (16, stronger(1.4)), "strength-0.5": (16, stronger(0.5)),
             "friction-0.1": (16, {"bodies.disc.friction": 0.1}), "friction-0.5": (16, {"bodies.disc.friction": 0.5}),
             "speed-8": (8, {}), "facets": (16, disc("120", 10, finer=2)), "speed-4": (4, {}),
             "inertia": (16, {"bodies.disc.inertia": "[0.25, 0.25, 0.25]"}),
             "radius": (16, {"specimen.packing.refine": "[{from: [0 mm, -12 mm, -15 mm], to: [110 mm, 12 mm, 0 mm], size: 0.5, distance: 10 mm}]"})}
    found = {}
    for name, (speed, keys) in cases.items():
        for seed in (1, 2, 3, 4, 5):
            if seed <= {"base": 5, "speed-4": 1, "radius": 2, "inertia": 2}.get(name, 3):
                found[f"trend-{name}-seed-{seed}"] = cut("120", 10, (110, 110, 60), 2.5, speed, 25, **keys, **{"run.seed": seed, "output.energy": "off"})
    return found


RELIEVED = {"ring": "120", "depth": 7.5, "size": (90, 150, 50), "lag": 95, "leave": 15}  # mm


def relieved():
    """Two discs of 120 mm 7.5 mm deep in a block of 90 x 150 x 50 mm, the second one beside the groove that the first one has left; `alone`:
    without the first."""
    ring, depth, size, lag, leave = RELIEVED.values()
    found = {}
    for spacing in (40, 80, 20, 60, "alone"):
        off, behind = (0, 0) if spacing == "alone" else (spacing / 2, lag)
        given = disc(ring, depth, "first") | disc(ring, depth, "second", behind) | block(size)
        given |= {"bodies.first.origin[1]": f"{off} mm", "bodies.second.origin[1]": f"{-off} mm", "test.depth": f"{depth} mm",
                  "test.spacing": f"{off * 2 or size[1]} mm", "test.length": f"{size[0] - ahead(ring, depth) - leave} mm", "specimen.mean_radius": "2.5 mm",
                  "bodies.first.motion.vx": "16 m/s", "bodies.second.motion.vx": "16 m/s", "time.end": "14 ms", "run.seed": 1, "output.energy": "off"}
        if spacing == "alone":
            given["bodies.first.origin[2]"] = "400 mm"
        found[f"relieved-{spacing}"] = {"from": "relieved", **given}
    return found


def depths():
    """Discs of 250 mm in a block of 150 x 130 x 70 mm, and other diameters with the same tip."""
    found = {}
    for ring, depth, seeds in (("250", 5, 2), ("250", 7.5, 2), ("250", 10, 2), ("250", 15, 2), ("432", 10, 2), ("483", 10, 2)):
        for seed in range(1, seeds + 1):
            name = f"wide-{depth}-seed-{seed}" if ring == "250" else f"diameter-{ring}-seed-{seed}"
            found[name] = cut(ring, depth, (150, 130, 70), 2.5, 16, **{"run.seed": seed, "output.energy": "off"})
    found |= {f"chisel-{depth}-seed-{seed}": {"scene": chisel(depth), "run.seed": seed} for depth in (2.5, 5, 7.5, 10) for seed in (1, 2)}
    return found


def coupled():
    """Coupling in the plane with other zones and limits, and in space; the published size."""
    cases = {"adaptive": ("adaptive", {}), "fixed": ("fixed", {}), "particles": ("particles", {}), "fine": ("adaptive", {"size": 2.5, "width": 8}),
             "zone-6": ("adaptive", {"width": 6}), "zone-18": ("adaptive", {"width": 18}), "limit-6.4": ("adaptive", {"stress": 6.4}),
             "limit-9.6": ("adaptive", {"stress": 9.6}), "fixed-6": ("fixed", {"width": 6}), "fixed-18": ("fixed", {"width": 18})}
    found = {f"plane-{name}-seed-{seed}": {"scene": plane(kind, **keys), "run.seed": seed} for name, (kind, keys) in cases.items() for seed in (1, 2, 3)}
    small = cut("120", 10, (130, 230, 120), 2.5, 16, 35)
    drop = {key for key in small if key.startswith("specimen.")}
    found |= {f"space-{kind}": {"scene": in_space(kind), **{key: value for key, value in small.items() if key not in drop}, "run.seed": 1}
              for kind in ("adaptive", "fixed", "particles")}
    reach = ahead("19", 3.9)
    found["full"] = {"scene": full_size(), **disc("19", 3.9), "bodies.disc.motion.vx": "16 m/s", "test.depth": "3.9 mm", "test.spacing": "150 mm",
                     "test.run_in": f"{reach + 101} mm", "test.length": "150 mm", "time.end": "60 ms", "run.seed": 1}
    return found


def runs(place):
    """{name: overrides}, in the order of importance."""
    found = published(place) | trends() | relieved() | coupled() | depths()
    granite = {**MOMENTS, "materials.rock.contact_modulus": "36.2 GPa", "materials.rock.tensile_strength": "12.95 MPa",
               "materials.rock.shear_strength": "40.9 MPa", "test.compressive_strength": "169.5 MPa", "test.tensile_strength": "13 MPa"}  # by proportion
    found["moments-beishan-seed-1"] = cut("17-flat", 4, (130, 150, 60), 2.55, 16, 15, **granite, **{"run.seed": 1})
    return found | {"moments-first-seed-1": cut("17", 3.9, (130, 150, 60), 2.55, 8, 15, **SIDES, **MOMENTS, **rock(place, "first"), **{"run.seed": 1})}


def finished(folder):
    path = os.path.join(folder, "summary.json")
    if not os.path.exists(path):
        return None
    with open(path) as file:
        summary = json.load(file)
    return summary if summary["finished"] else None


def calibrate(program, place, only):
    for name, (_, _, file) in ROCKS.items():
        folder = os.path.join(place, f"rock-{name}")
        if file and f"rock-{name}".startswith(only) and not os.path.exists(os.path.join(folder, "calibration.json")):
            subprocess.run([program, "calibrate", os.path.join(HERE, "references", f"{file}.yaml"), "--out", folder, "--threads", "1"], check=False)


def compute(program, place, only):
    os.makedirs(place, exist_ok=True)
    calibrate(program, place, only)
    for name, keys in runs(place).items():
        folder = os.path.join(place, name)
        if not name.startswith(only) or finished(folder):
            continue
        scene = os.path.join(SCENES, f"cutting-{keys.pop('from', 'disc')}.yaml")
        if "scene" in keys:
            scene = os.path.join(place, f"{name}.yaml")
            with open(scene, "w") as file:
                yaml.safe_dump(keys.pop("scene"), file)
        options = [part for key, value in {**QUIET, **keys}.items() for part in ("--set", f"{key}={value}")]
        subprocess.run([program, "run", scene, "--out", folder, "--quiet", "--force", *options], check=False)


# --- tables ---


def readings(place, start):
    """[n] summaries of the finished runs of a case, by packing."""
    names = [name for name in sorted(os.listdir(place)) if name == start or name.startswith(f"{start}-seed-")]
    found = [(name, finished(os.path.join(place, name))) for name in names]
    return [s | {"folder": os.path.join(place, name)} for name, s in found if s and s["readings"]["normal_force"] is not None]


def centre(summary):
    """Place along the arc, as a share of it, at which the force on a disc acts; NaN: no disc."""
    path = os.path.join(summary["folder"], "results.h5")
    with h5py.File(path) as file:
        if "rim" not in file:
            return math.nan
        force = np.hypot(file["rim/normal"][:], file["rim/rolling"][:])
        return float(np.sum(force * file["rim/share"][:]) / force.sum())


COLUMNS = {"normal_force": 1e3, "rolling_force": 1e3, "side_force": 1e3, "cutting_coefficient": 1, "predicted_coefficient": 1, "peak_normal_force": 1e3,
           "peak_rolling_force": 1e3, "peak_side_force": 1e3, "predicted_normal_force": 1e3, "predicted_rolling_force": 1e3, "removed_volume": 1e-9,
           "specific_energy": 3.6e6, "specific_energy_removed": 3.6e6, "damage_depth": 1e-3}


def columns(place, start):
    """{reading: values of the packings}, in kN, mm, kWh/m3."""
    some = readings(place, start)
    found = {name: np.array([np.nan if s["readings"][name] is None else s["readings"][name] / unit for s in some]) for name, unit in COLUMNS.items()}
    return found | {"centre": np.array([centre(s) for s in some]), "cpu": np.array([s["seconds"]["cpu"] for s in some]), "count": len(some)}


def spread(values, digits=0):
    """Mean and standard deviation of the packings."""
    some = values[np.isfinite(values)]
    if not len(some):
        return "-"
    return f"{some.mean():.{digits}f}" + (f" ± {some.std(ddof=1):.{digits}f}" if len(some) > 1 else "")


def row(place, label, start):
    c = columns(place, start)
    if not c["count"]:
        return None
    angle = np.degrees(np.arctan(c["cutting_coefficient"]))
    return (f"| {label} | {c['count']} | {spread(c['normal_force'])} | {spread(c['rolling_force'], 1)} | {spread(c['cutting_coefficient'], 3)} "
            f"| {angle.mean():.2f} | {c['predicted_coefficient'].mean():.3f} | {spread(c['centre'], 2)} "
            f"| {spread(c['predicted_normal_force'][:1])}, {spread(c['predicted_rolling_force'][:1], 1)} | {spread(c['specific_energy_removed'], 1)} "
            f"| {spread(c['damage_depth'])} | {c['cpu'].sum():.0f} |")


HEAD = ("| case | packings | normal, kN | rolling, kN | coefficient | angle, degrees | tan(arc/2) | centre over arc | model: normal, rolling "
        "| energy by volume, kWh/m3 | damage, mm | CPU s |\n" + "| --- " * 12 + "|")


def table(place, title, cases):
    rows = [line for label, start in cases.items() if (line := row(place, label, start))]
    if rows:
        print("", title, HEAD, *rows, sep="\n")


def slope(x, y):
    """Exponent of a power law and r2 of a straight line."""
    power = np.polyfit(np.log(x), np.log(y), 1)[0]
    off = y - np.polyval(np.polyfit(x, y, 1), x)
    return power, 1 - np.sum(off**2) / np.sum((y - np.mean(y))**2)


def trend(place, title, cases, names=("normal_force", "rolling_force", "cutting_coefficient")):
    """Prints exponent and straightness of readings over a value; `cases`: {value: start}."""
    found = {value: columns(place, start) for value, start in cases.items()}
    there = [value for value, c in found.items() if c["count"]]
    if len(there) < 3:
        return
    for name in names:
        power, straight = slope(np.array(there), np.array([np.nanmean(found[value][name]) for value in there]))
        print(f"{title}: {name} as the power {power:.2f}, r2 of a line {straight:.3f}")


def early_force(summary, path):
    """Mean normal force, N, up to a path, m."""
    with h5py.File(os.path.join(summary["folder"], "results.h5")) as file:
        impulse, time = (np.interp(path, file["history/cut_path"][:], file[f"history/{name}"][:]) for name in ("normal_impulse", "time"))
    return impulse / time


def beside_base(place, labels):
    """Ratios of forces to those of the base with the same packings, mean and standard error; the first: up to a path of 4 mm, where some 250
    bonds are broken and the courses of breakage have not separated yet."""
    def seeds(start):
        return {s["folder"].split("seed-")[-1]: (early_force(s, 4e-3), s["readings"]["normal_force"], s["readings"]["rolling_force"])
                for s in readings(place, start)}

    base = seeds("trend-base")
    print("\n| case | pairs | normal up to 4 mm, over base | normal over base | rolling over base |\n| --- | --- | --- | --- | --- |")
    for label, start in labels.items():
        some = seeds(start)
        pairs = sorted(set(base) & set(some))
        ratios = np.array([np.divide(some[seed], base[seed]) for seed in pairs]).reshape(-1, 3)
        error = [f" ± {r.std(ddof=1) / math.sqrt(len(r)):.2f}" if len(r) > 1 else "" for r in ratios.T]
        if pairs:
            print(f"| {label} | {len(pairs)} | " + " | ".join(f"{mean:.{3 - (k > 0)}f}{error[k]}" for k, mean in enumerate(ratios.mean(axis=0))) + " |")


def beishan(place):
    print("\n| Beishan | mean normal, side, rolling, kN | peaks |\n| --- | --- | --- |")
    print("| measured | 163.2, 13.4, 19.4 | 417, 50, 65 |")
    for ring in ("17-flat", "19-flat", "17-round", "17-fine", "moments"):
        c = columns(place, "moments-beishan" if ring == "moments" else f"published-beishan-{ring}")
        if c["count"]:
            parts = [", ".join(spread(np.abs(c[f"{kind}{name}_force"]), 1) for name in ("normal", "side", "rolling")) for kind in ("", "peak_")]
            print(f"| {ring} | {parts[0]} | {parts[1]} |")


def relieved_table(place):
    ring, depth, size, _, leave = RELIEVED.values()
    length = size[0] - ahead(ring, depth) - leave
    print("\n| spacing, mm | over depth | normal, kN | rolling, kN | side, kN | coefficient | removed, mm2 | energy by spacing | by volume, kWh/m3 |\n" + "| --- " * 9 + "|")
    for spacing in (20, 40, 60, 80, "alone"):
        c = columns(place, f"relieved-{spacing}")
        if c["count"]:
            print(f"| {spacing} | {'-' if spacing == 'alone' else f'{spacing / depth:.1f}'} | {spread(c['normal_force'])} | {spread(c['rolling_force'], 1)} "
                  f"| {spread(c['side_force'], 1)} | {spread(c['cutting_coefficient'], 3)} | {spread(c['removed_volume'] / length)} "
                  f"| {spread(c['specific_energy'], 1)} | {spread(c['specific_energy_removed'], 1)} |")


def tables(place):
    inches = {"19": "19 inch", "17": "17 inch"}
    table(place, "Published", {f"{stone} rock, {text}": f"published-{stone}-{ring}" for stone in ("first", "second") for ring, text in inches.items()}
          | {f"Beishan, {ring}": f"published-beishan-{ring}" for ring in ("19-flat", "17-flat", "17-round", "17-fine")}
          | {"published size, 19 inch": "full", "first rock with moments, 17 inch": "moments-first", "Beishan with moments, 17 inch": "moments-beishan"})
    beishan(place)
    labels = {"base": "trend-base", **{f"strengths times {f}": f"trend-strength-{f}" for f in (0.5, 0.7, 1.4)}, "friction 0.1": "trend-friction-0.1",
              "friction 0.5": "trend-friction-0.5", "8 m/s": "trend-speed-8", "4 m/s": "trend-speed-4", "facets halved": "trend-facets",
              "particles halved around the path": "trend-radius", "inertia 0.25 kg m2": "trend-inertia"}
    table(place, "Trends", labels)
    beside_base(place, labels)
    trend(place, "strength", {0.5: "trend-strength-0.5", 0.7: "trend-strength-0.7", 1: "trend-base", 1.4: "trend-strength-1.4"})
    table(place, "Depth and diameter", {f"250 mm, {p} mm deep": f"wide-{p}" for p in (5, 7.5, 10, 15)} | {"432 mm, 10 mm deep": "diameter-432",
                                                                                                 "483 mm, 10 mm deep": "diameter-483"})
    trend(place, "depth", {p: f"wide-{p}" for p in (5, 7.5, 10, 15)})
    trend(place, "depth of a chisel", {p: f"chisel-{p}" for p in (2.5, 5, 7.5, 10)})
    relieved_table(place)
    table(place, "Chisel in the plane", {name: f"plane-{name}" for name in ("particles", "fixed", "adaptive", "fine", "zone-6", "zone-18", "limit-6.4", "limit-9.6",
                                                                            "fixed-6", "fixed-18")} | {f"{p} mm": f"chisel-{p}" for p in (2.5, 5, 7.5, 10)})
    table(place, "Disc in space", {kind: f"space-{kind}" for kind in ("particles", "fixed", "adaptive")})


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
        depths_there = [depth for depth in (2.5, 5, 7.5, 10, 15) if readings(place, f"{group}-{depth:g}")]
        of = [readings(place, f"{group}-{depth:g}") for depth in depths_there]
        for name, text, color in names:
            axis.plot(depths_there, [factor * np.mean([s["readings"][name] for s in some]) for some in of], "o-", color=color, label=text)
            guess = {"cutting_coefficient": "predicted_coefficient", "peak_rolling_force": "predicted_peak_evans"}.get(name, "predicted_" + name)
            model = [some[0]["readings"].get(guess) for some in of]
            if model and None not in model:
                axis.plot(depths_there, factor * np.array(model), "--", color=color, label=f"{text}, closed form")
        axis.set(xlabel="depth of the cut [mm]", ylabel=label, xlim=(0, None), ylim=(0, None))
        axis.legend(fontsize=7)
    axes[0].set_title("disc of 250 mm")
    axes[2].set_title("chisel in the plane")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("place")
    parser.add_argument("--only", default=[""], nargs="+", metavar="NAME", help="runs whose name begins so")
    parser.add_argument("--tables", action="store_true", help="no runs")
    parser.add_argument("--picture", metavar="FILE", help="write forces over depth as an image")
    asked = parser.parse_args()
    if not asked.tables:
        compute(os.path.abspath(asked.program), asked.place, tuple(asked.only))
    tables(asked.place)
    if asked.picture:
        picture(asked.place, asked.picture)
