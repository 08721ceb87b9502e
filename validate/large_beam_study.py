"""A notched beam of 1 x 0.25 x 0.1 m of tetrahedra which turn into spheres of 1 mm where it cracks: docs/evidence/coupling.md.

    /usr/bin/python3 validate/large_beam_study.py [--radius 0.5] [--fresh]

Radii in mm. Only a radius of 0.5 writes the page.
"""
import json
import sys

import numpy as np

import study

FOLDER = study.RUNS / "large-beam"
LENGTH, HEIGHT, BREADTH, SPAN, NOTCH, SLOT, CELL = 1.0, 0.25, 0.1, 0.9, 0.075, 0.004, 0.012  # m
SIDE, LOW, TOP = 0.03, 0.045, 0.215  # m: half the length and the heights of the part that is packed


def region():
    """Closed surface around what is packed: a prism around the notch, without the notch."""
    mid, half = 0.5 * LENGTH, 0.5 * SLOT
    left = [(mid - SIDE, LOW), (mid - half, LOW), (mid - half, NOTCH), (mid - SIDE, NOTCH)]
    outline = [left[0], left[1], left[2], (mid + half, NOTCH), (mid + half, LOW), (mid + SIDE, LOW), (mid + SIDE, NOTCH), (mid + SIDE, TOP),
               (mid - SIDE, TOP), left[3]]
    faces = [(0, 1, 2), (0, 2, 9), (4, 5, 6), (4, 6, 3), (9, 2, 8), (2, 3, 8), (3, 7, 8), (3, 6, 7)]
    triangles = []
    for a, b, c in faces:
        triangles += [[(*outline[k], BREADTH) for k in (a, b, c)], [(*outline[k], 0.0) for k in (a, c, b)]]
    for k, here in enumerate(outline):
        there = outline[(k + 1) % len(outline)]
        triangles += [[(*here, 0.0), (*there, 0.0), (*there, BREADTH)], [(*here, 0.0), (*there, BREADTH), (*here, BREADTH)]]
    lines = ["solid region"]
    for corners in triangles:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex " + " ".join(f"{v:.10g}" for v in corner) for corner in corners), "endloop", "endfacet"]
    path = FOLDER / "region.stl"
    FOLDER.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join([*lines, "endsolid region"]) + "\n")
    return str(path)


def scene(radius):
    mid = 0.5 * LENGTH
    return {"dimension": 3,
            "specimen": {"group": 1, "surface": region(), "mean_radius": radius, "material": "concrete", "density_basis": "bulk",
                         "packing": {"overlap": "passive", "size_variation": 0.1}},
            "materials": [{"name": "concrete", "density": 2400, "contact_modulus": 19.1e9, "kratio": 3, "friction": 0.5, "tensile_strength": 4e6,
                           "shear_strength": 12e6}],
            "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.1, "passive_gaps": True},
            "elements": {"beam": {"length": LENGTH, "height": HEIGHT, "thickness": BREADTH, "span": SPAN, "notch_depth": NOTCH, "notch_width": SLOT,
                                  "cell": CELL},
                         "materials": [{"young": 30e9, "poisson": 0.16, "density": 2400}],
                         "motions": [{"name": "left", "group": "support_left", "motion": {"vx": 0, "vy": 0, "vz": 0}},
                                     {"name": "right", "group": "support_right", "motion": {"vy": 0}},
                                     {"name": "load", "group": "load", "motion": {"vy": [[0, 0], [2e-3, -3e-3]]}},
                                     {"name": "mouth_left", "group": "mouth_left"}, {"name": "mouth_right", "group": "mouth_right"}]},
            "couple": {"convert": {"box": {"min": [mid - SIDE, LOW, -1e-3], "max": [mid + SIDE, TOP, BREADTH + 1e-3]}, "width": 0.012, "stress": 2e6,
                                   "every": 50}},
            "damping": {"background": {"model": "viscous", "coefficient": 400}},
            "test": {"kind": "bending", "axis": "y", "lower": ["left", "right"], "upper": "load", "span": SPAN, "height": HEIGHT, "notch": NOTCH,
                     "opening": {"axis": "x", "lower": "mouth_left", "upper": "mouth_right"}},
            "time": {"end": 20e-3, "stop": {"peak_drop": 0.4}}, "run": {"seed": 1}}


def written(radius):
    text = json.dumps(scene(radius), indent=1)
    path = FOLDER / f"beam-{1e3 * radius:g}.yaml"
    path.write_text(text)
    return path


def main():
    radius = 1e-3 * float(sys.argv[sys.argv.index("--radius") + 1]) if "--radius" in sys.argv else 0.5e-3
    print(written(radius))


if __name__ == "__main__":
    main()
