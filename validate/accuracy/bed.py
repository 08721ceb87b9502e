"""A bed of grains that falls and comes to rest: final depth and dissipated energy."""
import numpy as np

import simple
from machinery import Axis, key

R, DENSITY, STIFFNESS, GRAVITY, END = 1e-3, 2500.0, 1e4, 9.81, 0.3
MASS = DENSITY * 4 / 3 * np.pi * R**3
TERMS = ["energy.work_gravity", "energy.friction", "energy.contact_damping", "energy.residual", "energy.kinetic"]
SIDE, TALL = 6, 6


def scene(quick):
    side = SIDE * 2.2 * R
    lattice = {"kind": "cubic", "radius": R, "cells": [SIDE, SIDE, 3 if quick else TALL], "origin": [0.1 * R, 0.1 * R, 3 * R], "spacing": 1.1, "jitter": 0.08}
    wall = {"stiffness": STIFFNESS, "kratio": 2, "friction": 0.3}
    planes = {"floor": ([0, 0, 0], [0, 0, 1]), "left": ([0, 0, 0], [1, 0, 0]), "right": ([side + 0.2 * R, 0, 0], [-1, 0, 0]),
              "front": ([0, 0, 0], [0, 1, 0]), "back": ([0, side + 0.2 * R, 0], [0, -1, 0])}
    return {"title": "a bed of grains", "dimension": 3, "specimen": {"lattice": lattice, "group": 0},
            "materials": [{"name": "grain", "density": DENSITY, "normal_stiffness": STIFFNESS, "kratio": 2, "friction": 0.3}],
            "law": {"stiffness": "uniform"}, "gravity": [0, 0, -GRAVITY], "damping": {"contact": {"restitution": 0.5}},
            "walls": [{"name": name, "point": point, "normal": normal, **wall} for name, (point, normal) in planes.items()],
            "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]},
            "time": {"end": 0.1 if quick else END}, "output": {"history_rows": 100, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


def stiffness(k):
    """Settings of one stiffness for grains and walls."""
    return {"materials.grain.normal_stiffness": k, **{f"walls.{name}.stiffness": k for name in ("floor", "left", "right", "front", "back")}}


AXES = [Axis("steps per contact", [40, 20, 10, 5], key("time.contact_steps"), [20, 10], seeds=6),
        Axis("stiffness", [1e2, 1e3, 1e4, 1e5], stiffness, [1e3, 1e4], seeds=6),
        Axis("restitution", [0.2, 0.5, 0.8], key("damping.contact.restitution"), [0.5], seeds=5),
        Axis("precision", ["double", "mixed"], key("run.precision"), ["double", "mixed"], seeds=5),
        Axis("round-off", [0.0, 1e-12, 2e-12, 3e-12, 4e-12, 5e-12], lambda x: {"specimen.lattice.origin": [(0.1 + x) * R, 0.1 * R, 3 * R]}, [0.0, 1e-12])]


def drop(row):
    """Fall of the centre of mass, in radii."""
    return row["energy.work_gravity"] / (row["particles"] * MASS * GRAVITY * R)


def dissipated(row):
    """Share of gravity's work that friction and dashpots took."""
    return (row["energy.friction"] + row["energy.contact_damping"]) / row["energy.work_gravity"]


def section(study, pictures):
    rows = {axis.name: study.axis("bed", scene(study.quick), axis, readings=TERMS) for axis in AXES}
    case = simple.Case(
        "bed", "A bed of grains",
        f"{SIDE} x {SIDE} grains in layers fall from {3 * R * 1e3:g} mm into a box and come to rest; friction 0.3, restitution 0.5, "
        f"{STIFFNESS:g} N/m. The error is relative to the most steps, the stiffest grains, and the first value of other axes.",
        {"fall of the centre": drop, "dissipated": dissipated, "worst residual": lambda row: row["energy_residual"]}, rows,
        finest={"steps per contact": max(row.value for row in rows["steps per contact"]), "precision": "double", "round-off": 0.0},
        truth={"worst residual": lambda row: 0.0}, absolute=("worst residual",), models=("restitution",), units={"fall of the centre": (1, "radii")},
        groups={"steps per contact": ("1 / steps per contact", lambda row: 1 / row.value),
                "stiffness": ("weight of a grain / (stiffness x radius)", lambda row: MASS * GRAVITY / (row.value * R))},
        more=lambda m: simple.chance_words(m, "steps per contact", "fall of the centre"))
    return simple.section(pictures, case)
