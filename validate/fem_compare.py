"""The explicit finite elements at rest against the references of references/fem.json.

    /usr/bin/python3 validate/fem_compare.py [--form displacement|mixed ...] [--fresh]

Needs build/validate/fem_static. Fills the tables of docs/evidence/fem.md (section References) and draws
docs/evidence/pictures/fem-reference.png; about twenty minutes of one core.
"""
import argparse
import json
import math
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import study

REFERENCES = json.loads((study.ROOT / "validate" / "references" / "fem.json").read_text())["cases"]
PROGRAM = study.ROOT / "build" / "validate" / "fem_static"
FORMS = {"displacement": "plain", "mixed": "mixed"}
# Case: reading of the table, meshes, sizes.
CASES = {"cook": ("mean right", {"": "alternating diagonals", "s": "parallel diagonals"}, (8, 16, 32, 64)),
         "block": ("mean", {"": "five tetrahedra a cell", "s": "six, parallel diagonals"}, (6, 12, 24))}
ALSO = {"cook": "top right", "block": "centre"}


def relax(case, material, form, cells):
    """The result of the program, stored in runs/studies, and the path of its fields."""
    folder = study.RUNS / "fem-static"
    name = f"{case}-{material}-{form}-{cells}"
    result, fields = folder / f"{name}.json", folder / f"{name}.txt"
    if study.FRESH or not result.exists():
        folder.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([PROGRAM, case, material, form, str(cells), str(study.THREADS), str(fields)],
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{name}: {done.stderr}")
        result.write_text(done.stdout)
        print(name, done.stdout, end="", flush=True)
    return json.loads(result.read_text()), fields


def read_fields(path, dimension):
    with open(path, encoding="utf-8") as file:
        nodes, elements = map(int, file.readline().split())
        points = np.loadtxt(file, max_rows=nodes)
        rows = np.loadtxt(file, max_rows=elements)
    return points, rows[:, :dimension + 1].astype(int), rows[:, dimension + 1]


def roughness(path, dimension):
    """Root of the mean square jump of the pressure between elements with a common side, relative to that of the
    pressure."""
    _, element, pressure = read_fields(path, dimension)
    sides = np.vstack([np.delete(element, k, axis=1) for k in range(dimension + 1)])
    owner = np.tile(np.arange(len(element)), dimension + 1)
    order = np.lexsort(np.sort(sides, axis=1).T)
    sides, owner = np.sort(sides, axis=1)[order], owner[order]
    shared = np.flatnonzero(np.all(sides[1:] == sides[:-1], axis=1))
    jump = pressure[owner[shared]] - pressure[owner[shared + 1]]
    return math.sqrt(np.mean(jump**2) / np.mean(pressure**2))


def rows_of(case, forms):
    """Errors of the work of the load (twice the energy, which a displacement method approaches from below)."""
    key, meshes, sizes = CASES[case]
    for material in ("compressible", "incompressible"):
        wanted = {k: REFERENCES[case][material]["reference"][k]["value"] for k in (key, ALSO[case])}
        for mark, mesh in meshes.items():
            for form in forms:
                found = [relax(case, material, form, f"{n}{mark}") for n in sizes]
                off = [[100 * (r["readings"][k] / wanted[k] - 1) for r, _ in found] for k in (key, ALSO[case])]
                ratio = off[0][-2] / off[0][-1]
                order = f"{math.log2(ratio):.2f}" if ratio > 0 else "-"
                rough = roughness(found[-1][1], 2 if case == "cook" else 3)
                yield [material, mesh, FORMS[form], *(f"{x:+.2f} %" for x in off[0]), order,
                       f"{off[1][-1]:+.2f} %", f"{rough:.2f}"]


def tables(forms):
    text = []
    for case, (key, _, sizes) in CASES.items():
        head = [f"{case}: {key}", "mesh", "form", *(f"n = {n}" for n in sizes), "order",
                f"{ALSO[case]}, n = {sizes[-1]}", "jumps of pressure"]
        text.append(study.table(head, rows_of(case, forms)))
    return "\n\n".join(text)


def pressures_of_the_block(forms):
    sizes = CASES["block"][2]
    rows = []
    for material in ("compressible", "incompressible"):
        known = REFERENCES["block"][material]["reference"]
        keys = [k for k in known if k.startswith("pressure")]
        rows.append([material, "CalculiX", *(f"{known[k]['value'] / 1e3:.2f} +- {known[k]['uncertainty'] / 1e3:.1g}"
                                             for k in keys)])
        for form in forms:
            found, _ = relax("block", material, form, sizes[-1])
            rows.append([material, f"{FORMS[form]}, n = {sizes[-1]}",
                         *(f"{found['readings'][k] / 1e3:.2f}" for k in keys)])
    return study.table(["block: mean pressure, kPa", "", "0 to 16.7 mm below the middle", "16.7 to 33.3 mm",
                        "33.3 to 50 mm"], rows)


def picture(forms):
    """Draws the pressure of the nearly incompressible membrane, one colour per element."""
    meshes = CASES["cook"][1]
    figure, axes = plt.subplots(len(meshes), len(forms), figsize=(4.2 * len(forms) + 0.8, 4.2 * len(meshes)),
                                squeeze=False, layout="constrained", sharex=True, sharey=True)
    for row, (mark, mesh) in zip(axes, meshes.items()):
        for ax, form in zip(row, forms):
            _, fields = relax("cook", "incompressible", form, f"32{mark}")
            points, element, pressure = read_fields(fields, 2)
            drawn = ax.tripcolor(points[:, 0], points[:, 1], element, facecolors=pressure, cmap="RdBu_r", vmin=-25,
                                 vmax=25)
            ax.set_title(f"{FORMS[form]} form, {mesh}", fontsize=10)
            ax.set_aspect("equal")
    for ax in axes[-1]:
        ax.set_xlabel("x (m)")
    for ax in axes[:, 0]:
        ax.set_ylabel("y (m)")
    figure.colorbar(drawn, ax=axes, label="pressure (Pa), compression positive", extend="both", shrink=0.7)
    figure.suptitle("Cook's membrane, nu = 0.4999, 32 x 32 cells", fontsize=12)
    path = study.ROOT / "docs" / "evidence" / "pictures" / "fem-reference.png"
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--form", action="append", choices=list(FORMS))
    parser.add_argument("--fresh", action="store_true", help="run again what is there already")
    forms = parser.parse_args().form or list(FORMS)
    study.put("fem.md", "against", tables(forms) + "\n\n" + pressures_of_the_block(forms))
    picture(forms)


if __name__ == "__main__":
    main()
