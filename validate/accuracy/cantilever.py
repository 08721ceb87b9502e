"""A cantilever of finite elements: the deflection of its end over the size of the elements, beside CalculiX where it is installed."""
import resource
import shutil
import sys

import numpy as np

import simple
import study as shared
import words
from machinery import Axis, key

LENGTH, HEIGHT, YOUNG, POISSON, DENSITY, TRACTION = 1.0, 0.1, 30e9, 0.2, 2400.0, 1e4
PLANE = YOUNG / (1 - POISSON**2)
SLOWEST = 3.516 * HEIGHT / np.sqrt(12) / LENGTH**2 * np.sqrt(PLANE / DENSITY)  # frequency of the beam, rad/s
LAYERS = 4


def deflection():
    """Timoshenko's beam in plane strain, shear coefficient 5/6, clamped."""
    force, shear = TRACTION * HEIGHT, YOUNG / (2 * (1 + POISSON))
    return force * LENGTH**3 / (3 * PLANE * HEIGHT**3 / 12) + force * LENGTH / (5 / 6 * shear * HEIGHT)


def layers(count):
    return {"elements.rectangle.cells": [count * int(LENGTH / HEIGHT), count]}


def scene():
    return {"title": "a cantilever of elements", "dimension": 2,
            "elements": {"rectangle": {"size": [LENGTH, HEIGHT], "cells": [LAYERS * 10, LAYERS]}, "formulation": "displacement",
                         "materials": [{"young": YOUNG, "poisson": POISSON, "density": DENSITY}],
                         "motions": [{"name": "clamp", "group": "x_lower", "motion": {"vx": 0, "vy": 0}}, {"name": "tip", "group": "x_upper"}],
                         "loads": [{"name": "tip", "group": "x_upper", "traction": {"ty": -TRACTION}}]},
            "damping": {"background": {"model": "viscous", "coefficient": 2 * SLOWEST}}, "time": {"end": 20 / SLOWEST},
            "output": {"history_rows": 50, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


AXES = [Axis("elements", [1, 2, 4, 8, 16, 32], layers, [1, 2, 4]),
        Axis("elements, mixed form", [(n, "mixed") for n in (1, 2, 4, 8, 16)], lambda p: {**layers(p[0]), "elements.formulation": p[1]},
             [(n, "mixed") for n in (1, 2, 4)]),
        Axis("safety", [0.9, 0.5, 0.2], key("time.safety"), [0.9, 0.5]),
        Axis("precision", ["double", "mixed"], key("run.precision"), ["double", "mixed"]),
        Axis("time to rest", [3, 5, 8, 12, 20], lambda t: {"time.end": t / SLOWEST}, [5, 10, 20])]


def by_calculix(kind, counts):
    """[(layers, deflection, its CPU seconds)] of a static step of CalculiX, nothing where it is not installed."""
    if not shutil.which("ccx"):
        return []
    sys.path[:0] = [str(shared.ROOT / "validate"), str(shared.ROOT / "validate" / "peers")]
    import calculix
    import fem_grid

    found = []
    for count in counts:
        grid = fem_grid.Grid(kind, [count * int(LENGTH / HEIGHT), count], lambda unit: unit * [LENGTH, HEIGHT])
        end = grid.where(grid.unit[:, 0] > 1 - 1e-9)
        end = end[np.argsort(grid.unit[end, 1])]
        force = np.zeros((len(grid.points), 3))
        share = np.zeros(len(end))  # consistent: linear sides 1/2 1/2, quadratic 1/6 4/6 1/6
        weights, step = ((0.5, 0.5), 1) if kind == "CPE3" else ((1 / 6, 4 / 6, 1 / 6), 2)
        for first in range(0, len(end) - 1, step):
            for k, w in enumerate(weights):
                share[first + k] += w
        force[end, 1] = -TRACTION * HEIGHT * share / share.sum()
        deck = calculix.Deck("a cantilever")
        deck.nodes(grid.points)
        deck.elements(kind, grid.element)
        deck.node_set("CLAMP", grid.where(grid.unit[:, 0] < 1e-9))
        deck.node_set("TIP", end)
        deck.material(YOUNG, POISSON)
        deck.boundary([("CLAMP", 1, 3)])
        deck.static(force, watch="TIP")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        result = deck.run(threads=1)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        found.append((count, -np.mean([result.displacement[n][1] for n in end]), seconds))
    return found


KINDS = {"CPE3": "CalculiX, the same triangles", "CPE8": "CalculiX, quadratic"}


def others(study, truth):
    """Returns {label: [(seconds, error)]} of CalculiX, and the rows of its table."""
    points, lines = {}, []
    for kind, label in KINDS.items():
        for count, found, seconds in by_calculix(kind, (1, 2, 4) if study.quick else (1, 2, 4, 8, 16, 32)):
            points.setdefault(label, []).append((seconds, found / truth - 1))
            lines.append([f"{label} ({kind})", count, f"{1e6 * found:.3f}", words.signed(found / truth - 1), words.seconds(seconds)])
    return points, lines


def beside(finest, truth, lines):
    text = (f"The deflection of Timoshenko's beam is {1e6 * deflection():.3f} um, without the effect of restrained lateral strain at the clamp. The finest elements give "
            f"{1e6 * finest:.3f} um, their limit by Richardson's extrapolation of the two finest (order 2) is {1e6 * truth:.3f} um, the reference of the error.")
    if not lines:
        return text + " CalculiX is not installed here."
    return text + ("\n\nA static step of CalculiX solves one linear system, where explicit steps pass the whole motion to rest:\n\n" +
                   words.table(["CalculiX", "layers", "deflection, um", "error", "seconds"], lines))


def section(study, pictures):
    term = "history.motion_tip_displacement_y"
    rows = {axis.name: study.axis("cantilever", scene(), axis, readings=(term, "energy.residual")) for axis in AXES}
    found = {row.value: -row[term] for row in rows["elements"]}
    coarse, fine = sorted(found)[-2:]
    truth = found[fine] + (found[fine] - found[coarse]) / 3
    points, lines = others(study, truth)
    case = simple.Case(
        "cantilever", "A cantilever of elements",
        f"{LENGTH} x {HEIGHT} m, plane strain, nu {POISSON}, a traction at its end, brought to rest by viscous damping that is critical for its slowest "
        f"motion. Elements: layers over the height. Axes with a fixed mesh ({LAYERS} layers) are relative to the same mesh at rest.",
        {"deflection": lambda row: -row[term]}, rows, truth={"deflection": lambda row: truth if "elements" in row.axis else found[LAYERS]},
        units={"deflection": (1e-6, "um")}, others=points,
        groups={"elements": ("1 / layers", lambda row: 1 / row.value), "elements, mixed form": ("1 / layers", lambda row: 1 / row.value[0]),
                "time to rest": ("e^-(slowest frequency x time)", lambda row: np.exp(-row.value))},
        more=lambda m: beside(found[fine], truth, lines))
    return simple.section(pictures, case)
