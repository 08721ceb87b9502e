"""A notched beam in three-point bending, in discs (to failure) and in elements (stiffness and the opening of the notch)."""
import math

import planar
import simple
from machinery import Axis, key

SPAN, HEIGHT, LONG, DEPTH, WIDTH = 0.16, 0.04, 0.18, 0.012, 0.003
CLOSING = 0.01
LAST = 0.01  # deflection at which a run ends at the latest, over the height

SHAPE = {"polygon": [[0, 0], [LONG / 2 - WIDTH / 2, 0], [LONG / 2 - WIDTH / 2, DEPTH], [LONG / 2 + WIDTH / 2, DEPTH], [LONG / 2 + WIDTH / 2, 0],
                     [LONG, 0], [LONG, HEIGHT], [0, HEIGHT]]}


AREA = LONG * HEIGHT - DEPTH * WIDTH


def motion(v):
    """The load starts slowly: a beam that is hit rings."""
    end = LAST * HEIGHT / v
    return {"sets.load.motion.vy": [[0, 0], [0.1 * end, -v]], "time.end": end}


def boxes(count):
    """Where discs are held and pushed: two or three discs, so that the beam can rotate there."""
    size = 1.6 * math.sqrt(0.85 * AREA / (math.pi * count))
    places = {"left": ((LONG - SPAN) / 2, 0), "right": ((LONG + SPAN) / 2, 0), "load": (LONG / 2, HEIGHT)}
    return {name: {"min": [x - size, y - size], "max": [x + size, y + size]} for name, (x, y) in places.items()}


def number(count):
    keys = {"specimen.particles": count}
    for name, box in boxes(count).items():
        keys.update({f"sets.{name}.select.box.min": box["min"], f"sets.{name}.select.box.max": box["max"]})
    return keys


def more(v, count):
    keys, box = motion(v), boxes(count)
    return {"title": "notched beam",
            "sets": [{"name": "left", "select": {"box": box["left"]}, "motion": {"vy": 0, "vx": 0}},
                     {"name": "right", "select": {"box": box["right"]}, "motion": {"vy": 0}},
                     {"name": "load", "select": {"box": box["load"]}, "motion": {"vy": keys["sets.load.motion.vy"]}}],
            # 3 F S / (2 (H - a)^2) in Pa per 1 m of thickness: the bending stress of a beam of the height above the
            # notch.
            "test": {"kind": "compression", "axis": "y", "lower": ["left", "right"], "upper": "load", "length": HEIGHT,
                     "area": 2 * (HEIGHT - DEPTH) ** 2 / (3 * SPAN)},
            "time": {"end": keys["time.end"], "stop": {"peak_drop": 0.5}}}


def section(study, pictures):
    v, count = (4 * CLOSING, 300) if study.quick else (CLOSING, 1000)
    rows = planar.rows_of(study, "notched", SHAPE, count, motion, more(v, count), [2 * v, v] if study.quick else [8 * v, 4 * v, 2 * v, v, v / 2],
                          [200, 400] if study.quick else [250, 500, 1000, 2000, 4000], number)
    case = simple.Case(
        "notched", "Notched beam in particles",
        f"{1e3 * LONG:g} x {1e3 * HEIGHT:g} mm, span {1e3 * SPAN:g} mm, notch {1e3 * DEPTH:g} mm, pressed at {v:g} m/s, {count} discs. "
        f"Strength: 3FS/(2(H - a)^2) at the largest force. Packings without a "
        f"disc at a support are left out.",
        {"strength": lambda row: row["largest_stress"]}, rows, finest={"safety": min(r.value for r in rows["safety"])},
        units={"strength": (1e6, "MPa")}, models=("damping",), groups=planar.GROUPS, scattered=("particles",),
        more=lambda m: planar.size_words(m, "strength", True))
    return simple.section(pictures, case)


# --- in elements ---

CELLS = [8e-3, 4e-3, 2e-3, 1e-3]


def beam():
    return {"title": "notched beam of elements", "dimension": 2,
            "elements": {"beam": {"length": LONG, "height": HEIGHT, "span": SPAN, "notch_depth": DEPTH, "notch_width": WIDTH, "cell": 2e-3},
                         "materials": [{"young": "20 GPa", "poisson": 0.2, "density": 2600}],
                         "motions": [{"name": "supports", "group": "supports", "motion": {"vy": 0}},
                                     {"name": "pin", "group": "support_left", "motion": {"vx": 0}},
                                     {"name": "load", "group": "load", "motion": {"vy": [[0, 0], [0.2e-3, -0.02], [1e-3, -0.02], [1.2e-3, 0]]}},
                                     {"name": "mouth_left", "group": "mouth_left"}, {"name": "mouth_right", "group": "mouth_right"}]},
            "damping": {"background": {"model": "viscous", "coefficient": 8000}},
            "test": {"kind": "compression", "axis": "y", "lower": "supports", "upper": "load"}, "time": {"end": 4e-3},
            "output": {"history_rows": 100, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


TERMS = ["history.force", "history.deflection", "history.motion_mouth_left_displacement_x", "history.motion_mouth_right_displacement_x", "energy.residual"]
AXES = [Axis("cell", CELLS, key("elements.beam.cell"), CELLS[:3]),
        Axis("cells at the tip", [1, 2, 4], key("elements.beam.notch_cells"), [1, 2]),
        Axis("safety", [0.9, 0.5, 0.2], key("time.safety"), [0.9, 0.5]),
        Axis("precision", ["double", "mixed"], key("run.precision"), ["double", "mixed"])]


def opening(row):
    left, right = (row[f"history.motion_mouth_{side}_displacement_x"] for side in ("left", "right"))
    return (right - left) / row["history.deflection"]


def elements_section(study, pictures):
    rows = {axis.name: study.axis("notched-elements", beam(), axis, readings=TERMS) for axis in AXES}
    case = simple.Case(
        "notched-elements", "Notched beam in elements",
        "The same beam, elastic: force and opening of the notch's mouth over the deflection, at rest. The error is relative to the limit of small cells. "
        "The cell is the largest side; at the notch cells are half its width over `notch_cells`.",
        {"stiffness": lambda row: row["history.force"] / row["history.deflection"],
         "opening": opening},
        rows, units={"stiffness": (1e6, "MN/m")}, finest={"safety": min(r.value for r in rows["safety"])},
        limits={"cell": lambda row: HEIGHT / row.value, "cells at the tip": lambda row: row.value},
        groups={"cell": ("cell / height", lambda row: row.value / HEIGHT), "cells at the tip": ("1 / cells over half the notch", lambda row: 1 / row.value)})
    return simple.section(pictures, case)
