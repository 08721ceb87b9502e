"""An elastic pulse through a row of particles and through elements: its speed and shape against d'Alembert's solution."""
import numpy as np

import simple
from machinery import Axis, key

LENGTH, SPEED, WIDTH, HEIGHT = 1.0, 1000.0, 0.2, 1e-3  # m, m/s of the wave, m of the pulse, m/s
DENSITY, END = 2000.0, 0.7 * LENGTH / SPEED
COUNT = 200


def pulse(t):
    """Velocity of the driven end: a bell of width WIDTH / SPEED, smooth at both ends."""
    u = np.asarray(t) * SPEED / WIDTH
    return np.where((u > 0) & (u < 1), HEIGHT * np.sin(np.pi * np.clip(u, 0, 1)) ** 2, 0.0)


def table():
    times = np.linspace(0, WIDTH / SPEED, 201)
    return [[float(t), float(v)] for t, v in zip(times, pulse(times))] + [[1.0, 0.0]]


COMMON = {"time": {"end": END}, "output": {"history_rows": 50, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


def chain_settings(count):
    """A row of touching particles of the same length; the stiffness is chosen for the same wave speed, whatever their
    mass per length."""
    r = LENGTH / (2 * count)
    mass = DENSITY * 4 / 3 * np.pi * r**3
    return {"specimen.lattice.radius": r, "specimen.lattice.cells": [count, 1, 1],
            "materials.row.normal_stiffness": mass * (SPEED / (2 * r)) ** 2, "sets.end.select.end.depth": 1.5 * r}


def chain():
    s = chain_settings(COUNT)
    return {"title": "a pulse in a row of particles", "dimension": 3,
            "specimen": {"lattice": {"kind": "cubic", "radius": s["specimen.lattice.radius"], "cells": s["specimen.lattice.cells"]}},
            "materials": [{"name": "row", "density": DENSITY, "normal_stiffness": s["materials.row.normal_stiffness"], "kratio": 0,
                           "bond_tension_limit": 1e9, "bond_shear_limit": 1e9}],
            "law": {"stiffness": "uniform", "rotation": "off"}, "bonds": {"interaction_range": 0.05},
            "sets": [{"name": "end", "select": {"end": {"axis": "x", "side": "lower", "depth": s["sets.end.select.end.depth"]}},
                      "motion": {"vx": table()}}], **COMMON}


def strip_settings(count):
    return {"elements.rectangle.size": [LENGTH, LENGTH / count], "elements.rectangle.cells": [count, 1]}


def strip():
    s = strip_settings(COUNT)
    return {"title": "a pulse in a strip of elements", "dimension": 2,
            "elements": {"rectangle": {"size": s["elements.rectangle.size"], "cells": s["elements.rectangle.cells"]},
                         "materials": [{"young": DENSITY * SPEED**2, "poisson": 0.0, "density": DENSITY}],
                         "motions": [{"name": "end", "group": "x_lower", "motion": {"vx": table(), "vy": 0}}]}, **COMMON}


COUNTS = [25, 50, 100, 200, 400, 800]
PARTICLES = [Axis("particles", COUNTS, chain_settings, [50, 100, 200]),
             Axis("safety of particles", [0.9, 0.7, 0.5, 0.3, 0.1], key("time.safety"), [0.9, 0.5]),
             Axis("precision of particles", ["double", "mixed"], key("run.precision"), ["double", "mixed"])]
ELEMENTS = [Axis("elements", COUNTS, strip_settings, [50, 100, 200]),
            Axis("safety of elements", [0.9, 0.7, 0.5, 0.3, 0.1], key("time.safety"), [0.9, 0.5])]


def profile(row):
    """Places from the driven end and velocities at the end of the run."""
    kind = "nodes" if "elements" in row.axis else "particles"
    place = (row.results(f"{kind}/position") - row.results(f"{kind}/displacement"))[:, 0]
    return place - place.min(), row.results(f"{kind}/velocity")[:, 0]


def instant(row):
    """The time of the velocities, which leapfrog has at the middle of the last step."""
    return row["time"] - 0.5 * row["dt"]


def shape(row):
    x, v = profile(row)
    wanted = pulse(instant(row) - x / SPEED)
    return float(np.sqrt(np.sum((v - wanted) ** 2) / np.sum(wanted**2)))


def speed(row):
    """The speed of the middle of the pulse's energy, from where it was half a width behind the front."""
    x, v = profile(row)
    return (np.sum(x * v**2) / np.sum(v**2)) / (instant(row) - 0.5 * WIDTH / SPEED)


def per_width(row):
    count = row.value if row.axis in ("particles", "elements") else COUNT
    return WIDTH / (LENGTH / count)


def section(study, pictures):
    rows = {axis.name: study.axis("wave", chain(), axis) for axis in PARTICLES}
    rows.update({axis.name: study.axis("wave", strip(), axis) for axis in ELEMENTS})
    case = simple.Case(
        "wave", "An elastic pulse", f"Half of a sine squared, {WIDTH} m wide, has travelled 0.7 m through a row of particles, and through a strip of elements "
        f"without lateral strain ({COUNT} over 1 m except where varied). Shape: root of the mean square distance from d'Alembert's solution over the pulse's "
        f"own; speed: of the middle of its energy. Velocities are those of the last half step, and are compared there.",
        {"shape": shape, "speed": speed}, rows, truth={"shape": lambda row: 0.0, "speed": lambda row: SPEED}, absolute=("shape",),
        units={"speed": (1, "m/s")},
        groups={"particles": ("1 / particles per width of the pulse", lambda row: 1 / per_width(row)),
                "elements": ("1 / elements per width of the pulse", lambda row: 1 / per_width(row)),
                "safety of particles": ("1 - safety^2 (a step at the limit makes up for the row's dispersion)", lambda row: 1 - row.value**2)})
    return simple.section(pictures, case)
