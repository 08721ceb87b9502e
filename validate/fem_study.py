"""Cook's membrane, nearly incompressible (nu = 0.4999), by both forms of the finite elements: effects of the diagonals and of refinement on the
deflection, and the pressures. Prints the table of docs/evidence/fem.md and draws its pictures; some minutes of one core.

    /usr/bin/python3 validate/fem_study.py [--build BUILD_FOLDER]
"""
import argparse
import os
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CUTS = ["chess", "rising", "falling"]
FORMS = ["displacement", "mixed"]
CELLS = [4, 8, 16, 32]


def run(program, form, cut, cells):
    text = subprocess.run([program, form, cut, str(cells)], check=True, capture_output=True, text=True).stdout
    first, *rows = text.splitlines()
    deflection, checkerboard, steps, dt = map(float, first.split())
    grid = np.array([r.split() for r in rows], float).reshape(cells + 1, cells + 1, 3)
    return {"deflection": deflection, "checkerboard": checkerboard, "steps": int(steps), "dt": dt, "grid": grid}


def table(results):
    lines = ["| cells are cut | form | " + " | ".join(f"{n} cells" for n in CELLS) + " | checkerboard, 16 cells |",
             "| --- | --- |" + " ---: |" * (len(CELLS) + 1)]
    for cut in CUTS:
        for form in FORMS:
            row = [f"{results[form, cut, n]['deflection']:.3f}" for n in CELLS]
            lines.append(f"| {cut} | {form} | " + " | ".join(row) +
                         f" | {100 * results[form, cut, 16]['checkerboard']:.2g} % |")
    return "\n".join(lines)


def draw_pressure(results, path):
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.6), sharey=True, layout="constrained")
    cases = [(form, cut) for cut in ("rising", "falling") for form in FORMS]
    for axis, (form, cut) in zip(axes, cases):
        grid = results[form, cut, 16]["grid"]
        image = axis.pcolormesh(grid[..., 0], grid[..., 1], grid[..., 2], cmap="RdBu_r", vmin=-20, vmax=20,
                                shading="gouraud")
        axis.set_title(f"{form} form, {cut} cuts", fontsize=10)
        axis.set_aspect("equal")
        axis.set_xlabel("x, m")
    axes[0].set_ylabel("y, m")
    figure.colorbar(image, ax=axes, label="nodal pressure, Pa (tension positive)")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_deflection(results, path):
    figure, axis = plt.subplots(figsize=(6.4, 4), layout="constrained")
    for form, line in zip(FORMS, ("--", "-")):
        for cut, mark in zip(CUTS, "os^"):
            axis.plot(CELLS, [results[form, cut, n]["deflection"] for n in CELLS], line + mark,
                      color="tab:red" if form == "displacement" else "tab:blue", label=f"{form} form, {cut}")
    axis.set_xscale("log", base=2)
    axis.set_xticks(CELLS, [str(n) for n in CELLS])
    axis.set_xlabel("cells per side")
    axis.set_ylabel("deflection of the upper right corner, m")
    axis.legend(fontsize=8)
    axis.grid(alpha=0.3)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build"))
    program = os.path.join(parser.parse_args().build, "tests", "fem_study")
    results = {(form, cut, n): run(program, form, cut, n) for form in FORMS for cut in CUTS for n in CELLS}
    pictures = os.path.join(ROOT, "docs", "evidence", "pictures")
    draw_pressure(results, os.path.join(pictures, "fem-pressure.png"))
    draw_deflection(results, os.path.join(pictures, "fem-cook.png"))
    print(table(results))
    for form in FORMS:
        r = results[form, "chess", 32]
        print(f"{form}: {r['steps']} steps of {r['dt']:.3g} s")


if __name__ == "__main__":
    main()
