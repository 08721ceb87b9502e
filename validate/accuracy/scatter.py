"""Scatter of packings by the law of the bonds: many packings of one number of particles, made by the default settings of packing, relative to the
study's law of scatter, which is based on overlapping spheres and one law. Rows of base.csv: `scatter over its law: READING, LAW`.

Loaded at four times the speed of the study.
"""
from pathlib import Path

import numpy as np

import cylinder
import fits
import planar
import slopes
from machinery import Axis, key

HERE = Path(__file__).resolve().parent
COUNT, SEEDS = 500, 24
LAWS = {"harmonic": {}, "arithmetic": {}, "mean_radius": {}, "dempack": {"contact_modulus": None, "kratio": 0, "young": "20 GPa", "poisson": 0.2}}
WIDTH, HEIGHT = 0.04, 0.08  # width and height of the bodies in the plane
CLOSING = {"compression": 0.4, "tension": 0.1}
LAST = {"compression": 0.03, "tension": 0.01}  # strain at which a run ends at the latest


def material(given, law):
    return {name: value for name, value in {**given, **LAWS[law]}.items() if value is not None}


def in_space(study, kind, law):
    c = cylinder.Cylinder(kind, study.quick)
    c.closing *= 4
    shape = {name: value for name, value in c.shape().items() if name != "packing"}
    return {**c.scene({**shape, "particles": 100 if study.quick else COUNT}), "law": {"stiffness": law}, "materials": [material(cylinder.MATERIAL, law)]}


def in_plane(study, kind, law):
    v = CLOSING[kind]
    more = {"title": f"{kind} of a rectangle of discs", "law": {"stiffness": law}, "materials": [material(planar.MATERIAL, law)],
            "test": {"kind": kind, "axis": "y", "lower": "lower", "upper": "upper", "length": HEIGHT, "area": WIDTH},
            "time": {"end": LAST[kind] * HEIGHT / v, "stop": {"peak_drop": 0.2}}}
    if kind == "compression":
        plate = {"stiffness": "40 GN/m", "passive": True}
        more["walls"] = [{"name": "lower", "point": [0, 0], "normal": [0, 1], "motion": {"vy": v / 2}, **plate},
                         {"name": "upper", "point": [0, HEIGHT], "normal": [0, -1], "motion": {"vy": -v / 2}, **plate}]
    else:
        more["sets"] = [{"name": side, "select": {"end": {"axis": "y", "side": side, "depth": 1e-3, "by": "surface"}}, "motion": {"vy": sense * v / 2}}
                        for side, sense in (("lower", -1), ("upper", 1))]
    return planar.scene({"rectangle": {"width": WIDTH, "height": HEIGHT}, "particles": 100 if study.quick else COUNT, "material": "rock"}, more)


# Among the planar cases the disc represents all tests in tension, as in src/accuracy/accuracy.c.
CASES = {"compression": (in_space, "compression"), "tension": (in_space, "tension"), "compression-plane": (in_plane, "compression"),
         "brazilian": (in_plane, "tension")}


def law_of(rows, case, reading):
    """(law, its group at a number of particles)"""
    for row in rows:
        if (row["case"], row["reading"], row["kind"]) == (case, reading, "scatter") and row["effect"] in ("packing", "particles"):
            return row, (lambda n: n) if row["effect"] == "packing" else (lambda n: 1 / n)
    return None, None


def rows_of(study, case, law):
    make, kind = CASES[case]
    axis = Axis(f"scatter by {law}", [0.9], key("time.safety"), [0.9], seeds=SEEDS)
    return study.axis(case, make(study, kind, law), axis)


def of_case(study, case):
    """{quantity: value} of all laws."""
    known, found = slopes.read(HERE / "slopes.csv"), {}
    for law in LAWS:
        rows = rows_of(study, case, law)
        count = np.median([row["particles"] for row in rows])
        for reading, name in cylinder.READINGS.items():
            said, group = law_of(known, case, reading)
            values = [row[name] for row in rows if np.isfinite(row[name])]
            if said and len(values) > len(rows) / 2:
                found[f"scatter over its law: {reading}, {law}"] = fits.scatter(values) / slopes.at(said, group(count))
    return found
