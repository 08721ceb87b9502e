"""Head-on collisions of two grains: the restitution reached relative to the given one, over the number of steps per
contact."""
import numpy as np

import simple
from machinery import Axis, key

R, DENSITY, STIFFNESS, PAIRS, SPEED = 1e-3, 2500.0, 1e5, 40, 0.01
MASS = DENSITY * 4 / 3 * np.pi * R**3
CONTACT = np.pi * np.sqrt(MASS / (2 * STIFFNESS))  # s, without damping
RESTITUTION = 0.5


def scene():
    """Distant pairs, each of which meets at another fraction of a step."""
    rng, rows = np.random.default_rng(5), []
    for k in range(PAIRS):
        gap = SPEED * CONTACT * rng.uniform(0.2, 0.6)
        rows += [[0, 0, 0.01 * k, R], [2 * R + gap, 0, 0.01 * k, R]]
    sets = [{"name": "left", "select": {"ids": list(range(0, 2 * PAIRS, 2))}, "initial_velocity": [SPEED / 2, 0, 0]},
            {"name": "right", "select": {"ids": list(range(1, 2 * PAIRS, 2))}, "initial_velocity": [-SPEED / 2, 0, 0]}]
    return {"title": "pairs of grains", "dimension": 3, "specimen": {"particles": rows, "group": 0},
            "materials": [{"name": "grain", "density": DENSITY, "normal_stiffness": STIFFNESS, "kratio": 0}],
            "law": {"stiffness": "uniform", "rotation": "off"}, "damping": {"contact": {"restitution": RESTITUTION}}, "sets": sets,
            "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "time": {"end": 6 * CONTACT},
            "output": {"history_rows": 100, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


AXES = [Axis("steps per contact", [5, 10, 20, 40, 80, 160], key("time.contact_steps"), [10, 20, 40]),
        Axis("precision", ["double", "mixed"], key("run.precision"), ["double", "mixed"]),
        Axis("restitution", [0.1, 0.3, 0.5, 0.7, 0.9, 1.0], key("damping.contact.restitution"), [0.5, 0.9])]


def parting(row):
    velocity = row.results("particles/velocity")[:, 0]
    return (velocity[1::2] - velocity[0::2]) / SPEED


def wanted(row):
    return row.value if row.axis == "restitution" else RESTITUTION


def section(study, pictures):
    case = simple.Case(
        "collision", "Two grains colliding",
        f"{PAIRS} pairs that collide at different moments of a step, restitution {RESTITUTION} except where it is varied. `rms`: root of the mean square "
        f"of measured minus requested; `worst`: the largest. The exact value is the requested restitution.",
        {"rms": lambda row: float(np.sqrt(np.mean((parting(row) - wanted(row)) ** 2))),
         "worst": lambda row: float(np.max(np.abs(parting(row) - wanted(row))))},
        {axis.name: study.axis("collision", scene(), axis) for axis in AXES},
        truth={"rms": lambda row: 0.0, "worst": lambda row: 0.0}, absolute=("rms", "worst"), models=("restitution",),
        groups={"steps per contact": ("1 / steps per contact", lambda row: 1 / row.value)})
    return simple.section(pictures, case)
