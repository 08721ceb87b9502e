"""Static references for the finite elements: quadratic elements of CalculiX, refined until they converge.

    /usr/bin/python3 validate/fem_references.py [--case NAME ...] [--threads N]

Writes validate/references/fem.json and the table of docs/evidence/fem.md (section References): about half an hour of two
cores and 8 GB. A reference is the value of the finest mesh after Richardson's extrapolation; its uncertainty is the
spread of what the families of meshes extrapolate to, and at least what the extrapolation added.

Cases (small strain; in SI units, though the membrane is usually given without any):
  cook            Cook's membrane in plane strain, 1 m thick: corners (0, 0), (48, 44), (48, 60), (0, 44) m, left side
                  clamped, right side under a shear traction along y. Compressible: E = 1 Pa, nu = 1/3, 1 N in all,
                  1/16 Pa. Nearly incompressible: E = 240.565 Pa, nu = 0.4999, 6.25 Pa. Read: u_y of the top right
                  corner and of the middle of the right side, and the mean of u_y over that side (twice the work).
  block           a quarter of a block 200 x 200 x 50 mm, on a smooth floor, sides free, pressed on its top by
                  p = p0 cos^2(pi x/2a) cos^2(pi y/2a) over |x|, |y| < a = 50 mm, p0 = 20 kPa; E = 240.565 MPa,
                  nu = 0.4999 and 1/3. Read: u_z in the middle of the pressed part, pressure below it.
"""
import argparse
import json
import math
from pathlib import Path

import numpy as np

import study
from fem_grid import Grid
from peers.calculix import Deck, version

FILE = Path(__file__).resolve().parent / "references" / "fem.json"
COOK = {"compressible": (1.0, 1.0 / 3.0, 1.0 / 16.0), "incompressible": (240.565, 0.4999, 6.25)}
BLOCK = {"compressible": (240.565e6, 1.0 / 3.0), "incompressible": (240.565e6, 0.4999)}
P0, HALF, SIDE, HEIGHT = 20e3, 0.05, 0.1, 0.05
CUBE = SIDE / 6  # m, side of the cubes under the middle over which the pressure is averaged


# --- shapes ----------------------------------------------------------------------------------------------------------


def cook_map(graded):
    def shape(unit):
        s, t = unit[:, 0], unit[:, 1]
        if graded:  # towards the four corners: the clamped ones and those where the traction ends are singular
            half = 2**(graded - 1)
            s, t = (np.where(q < 0.5, half * q**graded, 1 - half * (1 - q)**graded) for q in (s, t))
        return np.stack([48 * s, (44 * s) * (1 - t) + (44 + 16 * s) * t], axis=1)
    return shape


def block_map(unit):
    return unit * [SIDE, SIDE, HEIGHT]


# --- loads: consistent with the shape functions ----------------------------------------------------------------------


def right_side_forces(grid, traction):
    """Constant shear on quadratic edges: 1/6, 4/6, 1/6 of each edge's force."""
    side = grid.where(grid.unit[:, 0] == 1)
    side = side[np.argsort(grid.unit[side, 1])]
    force = np.zeros((len(grid.points), 3))
    for k in range(0, len(side) - 1, 2):
        length = np.linalg.norm(grid.points[side[k + 2]] - grid.points[side[k]])
        force[side[k:k + 3], 1] += traction * length * np.array([1, 4, 1]) / 6
    return force


def pressure_at(x, y):
    inside = (np.abs(x) < HALF) & (np.abs(y) < HALF)
    return np.where(inside, P0 * (np.cos(np.pi * x / (2 * HALF)) * np.cos(np.pi * y / (2 * HALF)))**2, 0.0)


def t6(r, s):
    q = 1 - r - s
    return np.array([q * (2 * q - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * q * r, 4 * r * s, 4 * s * q])


def q8(r, s):
    corner = [(1 + a * r) * (1 + b * s) * (a * r + b * s - 1) / 4 for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    edge = [(1 - r * r) * (1 - s) / 2, (1 + r) * (1 - s * s) / 2, (1 - r * r) * (1 + s) / 2, (1 - r) * (1 - s * s) / 2]
    return np.array(corner + edge)


def quadrature(sides):
    """Points and weights on a face: 6 x 6 Gauss points, for the triangle by Duffy's map of the square."""
    x, w = np.polynomial.legendre.leggauss(6)
    r, s = (a.ravel() for a in np.meshgrid(x, x))
    weight = np.outer(w, w).ravel()
    if sides == 4:
        return q8(r, s), weight
    u, v = (1 + r) / 2, (1 + s) / 2
    return t6(u * (1 - v), v), weight * (1 - v) / 4


def face_nodes(grid):
    """The faces on the top, [faces, 6 or 8], corners first, each followed by the middles of the edges in turn."""
    if grid.kind == "C3D20R":
        faces = grid.element[:, [4, 5, 6, 7, 12, 13, 14, 15]]
    else:
        mids = {frozenset(e): 4 + k for k, e in enumerate([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)])}
        faces = np.vstack([grid.element[:, [a, b, c, *(mids[frozenset(e)] for e in ((a, b), (b, c), (c, a)))]]
                           for a, b, c in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))])
    return faces[np.all(grid.unit[faces, 2] == 1, axis=1)]


def top_forces(grid):
    """Faces are flat with straight sides: the area is the same all over."""
    force = np.zeros((len(grid.points), 3))
    faces = face_nodes(grid)
    sides = 4 if faces.shape[1] == 8 else 3
    shape, weight = quadrature(sides)  # [nodes, points], [points]
    for face in faces:
        x = grid.points[face]
        area = np.linalg.norm(np.cross(x[1] - x[0], x[sides - 1] - x[0])) / (4 if sides == 4 else 1)
        p = pressure_at(*(shape.T @ x[:, :2]).T)
        np.add.at(force[:, 2], face, -area * (shape * (weight * p)).sum(axis=1))
    return force


# --- one solution ----------------------------------------------------------------------------------------------------


def cook(kind, n, material, graded, threads):
    # ccx 2.20 came out hundreds of times too soft on some fine meshes at moduli near 1, never at 1e6 times that: times
    # the same factor the load gives the same displacement.
    young, poisson, traction = COOK[material]
    young, traction = 1e6 * young, 1e6 * traction
    grid = Grid(kind, (n, n), cook_map(graded))
    deck = Deck(f"Cook's membrane, {material}, {n} x {n} {kind}")
    deck.nodes(grid.points)
    deck.elements(kind, grid.element)
    side = grid.where(grid.unit[:, 0] == 1)
    deck.node_set("CLAMPED", grid.where(grid.unit[:, 0] == 0))
    deck.node_set("LOADED", side)
    deck.material(young, poisson)
    deck.boundary([("CLAMPED", 1, 2)])
    force = right_side_forces(grid, traction)
    deck.static(force, "LOADED")
    u = deck.run(threads).displacement
    return {"top right": u[grid.at(1, 1)][1], "middle right": u[grid.at(1, 0.5)][1],
            "mean right": float(sum(force[k, 1] * u[k][1] for k in side) / force[:, 1].sum())}


def block(kind, n, material, graded, threads):
    del graded  # No singularity in this case.
    young, poisson = BLOCK[material]
    grid = Grid(kind, (n, n, n // 2), block_map)
    deck = Deck(f"block under pressure, {material}, {n} x {n} x {n // 2} {kind}")
    deck.nodes(grid.points)
    deck.elements(kind, grid.element)
    for k, name in enumerate(("PLANEX", "PLANEY", "FLOOR")):
        deck.node_set(name, grid.where(grid.unit[:, k] == 0))
    deck.material(young, poisson)
    deck.boundary([("PLANEX", 1, 1), ("PLANEY", 2, 2), ("FLOOR", 3, 3)])
    force = top_forces(grid)
    deck.static(force, "NALL", stress=True)
    result = deck.run(threads)
    u = result.displacement
    values = {"centre": u[grid.at(0, 0, 1)][2],
              "mean": float(sum(f * u[k][2] for k, f in enumerate(force[:, 2]) if f) / force[:, 2].sum())}
    for layer, pressure in enumerate(column_pressure(grid, result.stress), 1):
        values[f"pressure {layer}"] = pressure
    return values


def column_pressure(grid, stress):
    """Mean pressure of the cubes under the middle, from the top; integration points of an element weigh the same."""
    corners = grid.points[grid.element[:, :8 if grid.kind == "C3D20R" else 4]]
    centre = corners.mean(axis=1)
    edges = corners[:, [1, 3, 4] if grid.kind == "C3D20R" else [1, 2, 3]] - corners[:, :1]
    weight = np.abs(np.linalg.det(edges))
    pressure = np.array([-stress[e][:, :3].mean() for e in range(len(weight))])
    under = (centre[:, 0] < CUBE) & (centre[:, 1] < CUBE)
    layer = ((HEIGHT - centre[:, 2]) / CUBE).astype(int)
    return [float(np.average(pressure[under & (layer == k)], weights=weight[under & (layer == k)]))
            for k in range(round(HEIGHT / CUBE))]


# --- limits ----------------------------------------------------------------------------------------------------------


def richardson(n, values):
    """(limit, order) from the three finest meshes, whose n grow by one factor; (last, None) when they do not converge
    monotonically."""
    a, b, c = values[-3:]
    if (b - a) * (c - b) <= 0 or abs(c - b) >= abs(b - a):
        return c, None
    ratio = n[-1] / n[-2]
    order = math.log(abs((b - a) / (c - b)), ratio)
    return c + (c - b) / (ratio**order - 1), order
# --- the study -------------------------------------------------------------------------------------------------------

GRADINGS = {0: "even", 2: "graded, power 2", 3: "graded, power 3"}
CASES = {
    "cook": (cook, [("CPE8R", 0), ("CPE8R", 2), ("CPE8R", 3), ("CPE8", 2), ("CPE6", 2)], (8, 16, 32, 64, 128)),
    "block": (block, [("C3D20R", 0), ("C3D10", 0)], (6, 12, 24)),
}


def solve(name, kind, n, material, grading, threads):
    """Reuses the results of an earlier run in runs/studies, unless --fresh is given."""
    store = study.RUNS / "fem-references.json"
    known = json.loads(store.read_text()) if store.exists() else {}
    key = f"{name} {material} {kind} {grading} {n}"
    if key not in known or study.FRESH:
        known[key] = CASES[name][0](kind, n, material, grading, threads)
        store.parent.mkdir(parents=True, exist_ok=True)
        store.write_text(json.dumps(known, indent=1))
        print(key, known[key], flush=True)
    return known[key]


def family(name, kind, grading, sizes, material, threads):
    runs = [solve(name, kind, n, material, grading, threads) for n in sizes]
    readings = {}
    for key in runs[0]:
        values = [run[key] for run in runs]
        limit, order = richardson(sizes, values)
        readings[key] = {"values": values, "limit": limit, "order": order}
    return {"elements": kind, "mesh": GRADINGS[grading], "cells": list(sizes), "readings": readings}


def reference(families, key):
    """The limit of the family with the smallest last extrapolation; the spread of the others is the uncertainty."""
    readings = [f["readings"][key] for f in families]
    steps = [abs(r["limit"] - r["values"][-1]) or abs(r["values"][-1] - r["values"][-2]) for r in readings]
    best = int(np.argmin(steps))
    limit = readings[best]["limit"]
    return {"value": limit, "uncertainty": max([steps[best], *(abs(r["limit"] - limit) for r in readings)]),
            "from": f"{families[best]['elements']}, {families[best]['mesh']}"}


def study_case(name, material, threads):
    function, kinds, sizes = CASES[name]
    families = [family(name, kind, grading, sizes, material, threads) for kind, grading in kinds]
    trusted = [f for f, (_, grading) in zip(families, kinds) if grading or name == "block"]
    return {"reference": {key: reference(trusted, key) for key in families[0]["readings"]}, "families": families}


def short(x, digits=6):
    return f"{x:.{digits}g}"


def tables(results):
    summary = [[f"{name}, {material}", key, short(r["value"]), short(r["uncertainty"], 1), r["from"]]
               for name, materials in results.items() for material, case in materials.items()
               for key, r in case["reference"].items()]
    text = [study.table(["case", "reading (SI)", "reference", "+-", "extrapolated from"], summary)]
    for name, materials in results.items():
        key = "top right" if name == "cook" else "centre"
        rows = [[material, f["elements"], f["mesh"], *map(short, f["readings"][key]["values"]),
                 short(f["readings"][key]["limit"]),
                 "-" if f["readings"][key]["order"] is None else f"{f['readings'][key]['order']:.2f}"]
                for material, case in materials.items() for f in case["families"]]
        text.append(study.table([f"{name}: {key}", "elements", "mesh", *(f"n = {n}" for n in CASES[name][2]), "limit",
                                 "order"], rows))
    return "\n\n".join(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--case", action="append", choices=list(CASES))
    parser.add_argument("--threads", type=int, default=study.THREADS)
    parser.add_argument("--fresh", action="store_true", help="solve again what is there already")
    options = parser.parse_args()
    whole = json.loads(FILE.read_text()) if FILE.exists() else {}
    results = whole.get("cases", {})
    for name in options.case or CASES:
        results[name] = {m: study_case(name, m, options.threads) for m in ("compressible", "incompressible")}
    results = {name: results[name] for name in CASES if name in results}
    # The decks themselves against a published number: the membrane in plane stress.
    known = family("cook", "CPS8R", 2, CASES["cook"][2], "compressible", options.threads)
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(json.dumps({"program": f"CalculiX ccx {version()}", "command": "ccx -i job",
                                "made by": "validate/fem_references.py", "cases": results, "plane stress": known},
                               indent=1) + "\n")
    check = (f"The same decks in plane stress (CPS8R) come to {known['readings']['middle right']['limit']:.3f} at the "
             "middle of the loaded side, published as 23.96.")
    study.put("fem.md", "references", tables(results) + "\n\n" + check)


if __name__ == "__main__":
    main()
