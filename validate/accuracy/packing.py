"""A packing itself: density, coordination and seconds over its settings."""
import numpy as np

import simple
from machinery import Axis, key

DIAMETER, HEIGHT = 0.023, 0.046
VOLUME = np.pi / 4 * DIAMETER**2 * HEIGHT


def scene(count):
    """A run of almost no steps: its time is that of the packing and the set-up."""
    return {"title": "a packing", "dimension": 3,
            "specimen": {"cylinder": {"diameter": DIAMETER, "height": HEIGHT}, "particles": count, "packing": {"overlap": "passive", "size_ratio": 3}},
            "materials": [{"name": "rock", "density": 2650, "contact_modulus": "10 GPa", "kratio": 3.7, "tensile_strength": "40 MPa",
                           "shear_strength": "40 MPa"}],
            "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.01}, "time": {"end": 1e-9},
            "output": {"history_rows": 1, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


def filled(row):
    return float(np.sum(4 / 3 * np.pi * row.results("particles/radius") ** 3) / VOLUME)


def coordination(row):
    return 2 * row["bonds"] / row["particles"]


AXES = [Axis("particles", [250, 500, 1000, 2000, 4000, 8000, 16000], key("specimen.particles"), [100, 200, 400], seeds=5),
        Axis("iterations", ["10", "30", "100", "300", "1000", "auto"], key("specimen.packing.iterations"), ["10", "auto"], seeds=3),
        Axis("residual", [0.03, 0.01, 0.003, 0.001, 0.0003], key("specimen.packing.residual"), [], seeds=3),
        Axis("overlap", ["none", "passive"], key("specimen.packing.overlap"), ["none", "passive"], seeds=5),
        Axis("size ratio", [2, 3, 6, 10], key("specimen.packing.size_ratio"), [3], seeds=3)]


def section(study, pictures):
    count = 200 if study.quick else 2000
    rows = {axis.name: study.axis("packing", scene(count), axis) for axis in AXES}
    rows = {name: same for name, same in rows.items() if same}
    case = simple.Case(
        "packing", "A packing itself",
        f"The cylinder of the tests with {count} spheres except where varied. Filled: volume of the spheres over that of the body, overlaps twice; coordination: "
        f"neighbours within a gap of 1 %. The error is relative to the limit of many particles (with the exponent of a surface "
        f"layer if the runs do not determine it), and to the finest of other axes; settings of the shape (overlap, size ratio) are choices.",
        {"filled": filled, "coordination": coordination}, rows, models=("overlap", "size ratio"),
        limits={"particles": lambda row: row.value ** (1 / 3)},
        groups={"particles": ("1 / particles^(1/3)", lambda row: row.value ** (-1 / 3)), "residual": ("residual", lambda row: row.value)})
    return simple.section(pictures, case)
