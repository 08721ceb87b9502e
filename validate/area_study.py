"""Bodies of bonds with sections of their own (law.stiffness dempack and polyhedron): how the sections fill packings,
E and nu beside uniform strain, the sweeps over alpha and beta of Santasusana 2013, 5.1.3, a hydrostatic cube. Fills the
tables of docs/evidence/area-laws.md; some minutes of one core.

    /usr/bin/python3 validate/area_study.py [--fresh]
"""
import csv
import json
import re
import sys

import numpy as np

import study

DISCS = "scenes/elastic-discs.yaml"
ROCKS = ("rock-a", "rock-b", "rock-c")
YOUNG, POISSON = 20e6, 0.25
FOLDER = study.RUNS / "areas"
# From the source: discs, mean radius mm, n_c, e %. The fit of a packing ends early where contacts are to be few.
MESHES = [(2260, 0.72, 5.08, 11.0, 24), (1262, 1.02, 5.14, 9.4, 24), (725, 1.42, 5.24, 6.8, 24), (1343, 1.02, 5.79, 11.1, "auto"),
          (325, 2.0, 3.76, 18.3, None)]
ALPHAS, BETAS = (1, 1.5, 2, 2.5), (0, 0.5, 1, 1.5, 2, 3)


def mesh_settings(mesh):
    count, *_, iterations = mesh
    if iterations is None:  # the regular one: a square lattice
        return {"specimen": "{lattice: {kind: square, radius: 2 mm, cells: [13, 25]}}", "test.length": 0.1, "test.diameter": 0.052}
    return {"specimen.particles": count, "specimen.packing.iterations": iterations}


def checked(scene, settings):
    """The report of `gneiss check` on the sections."""
    done = study.call(["check", str(scene), "--threads", "1", *study.set_arguments(settings)])
    if done.returncode:
        sys.exit(done.stderr)
    wanted = {"filled": r"sections fill +(\S+) of", "whole": r"\(\d V\), (\S+) with", "gamma": r"gamma +(\S+)",
              "source": r"40 e/n_c would be (\S+)", "porosity": r"porosity +(\S+) %", "neighbours": r"bonds +\d+, (\S+) per"}
    found = {name: re.search(pattern, done.stdout) for name, pattern in wanted.items()}
    return {name: float(match.group(1)) if match else float("nan") for name, match in found.items()}


def plane(alpha, beta, poisson=POISSON):
    """E'/(alpha E) and nu' of uniform strain."""
    rho = beta / alpha / (2 * (1 + poisson))
    return 2 * (1 + rho) / (3 + rho), (1 - rho) / (3 + rho)


def space(alpha, beta, poisson):
    rho = beta / alpha / (2 * (1 + poisson))
    return (2 + 3 * rho) / (4 + rho), (1 - rho) / (4 + rho)


# --- how sections fill bodies ---------------------------------------------------------------------------------

def by_area(law):
    return {"law.stiffness": law, "materials.rock.young": 20e9, "materials.rock.poisson": 0.2}


def fill_table():
    rows = []
    bodies = [(name, study.ROCK, {"specimen.file": f"specimens/{name}.txt", "specimen.material": "rock"}) for name in ROCKS]
    bodies += [(f"{count} discs", DISCS, mesh_settings(m)) for m in MESHES for count in m[:1]]
    for name, scene, settings in bodies:
        change = {} if scene == DISCS else by_area("polyhedron")
        shape = checked(scene, {**settings, **change})
        ball = checked(scene, {**settings, **(change or {}), "law.stiffness": "dempack"})
        rows.append([name, f"{shape['porosity']:.1f}", f"{shape['neighbours']:.2f}", f"{shape['filled']:.3f}", f"{shape['whole']:.3f}",
                     f"{ball['gamma']:.3f}", f"{ball['source']:.3f}", f"{ball['source'] / ball['gamma']:.2f}"])
    study.put("area-laws.md", "table fill", study.table(
        ["body", "e %", "n_c", "polyhedra fill", "with free faces", "gamma that fills it", "40 e/n_c", "E by that over E"], rows))


# --- E and nu -------------------------------------------------------------------------------------------------

def box_scene(law, seed, walls):
    """A cube of 2 000 spheres between six frictionless platens, of which the named ones close."""
    side, names = 0.05, [(axis, end) for axis in "xyz" for end in (0, 1)]
    made = []
    for axis, end in names:
        at = "xyz".index(axis)
        point, normal = [0, 0, 0], [0, 0, 0]
        point[at], normal[at] = side * end, 1 - 2 * end
        if axis not in walls:
            continue
        speed = 1.0 * (1 - 2 * end)
        made.append({"name": f"{axis}{end}", "point": point, "normal": normal, "stiffness": 1e9, "passive": True,
                     "motion": {f"v{axis}": [[0, 0], [1e-4, speed]]}})
    return {"dimension": 3, "specimen": {"box": {"size": [side] * 3}, "particles": 2000},
            "materials": [{"name": "m", "density": 2500, "young": 20e9, "poisson": 0.2, "tensile_strength": 1e90,
                           "shear_strength": 1e90}],
            "law": {"stiffness": law}, "bonds": {}, "walls": made,
            "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.5}},
            "test": {"kind": "compression", "axis": "z", "lower": "z0", "upper": "z1", "length": side, "area": side**2},
            "time": {"end": 3e-4}, "output": {"history_rows": 200}, "run": {"seed": seed}}


def made(name, scene):
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.yaml"
    path.write_text(json.dumps(scene, indent=1))
    return path.relative_to(study.ROOT)


def space_table():
    rows, (e, nu) = [], space(1, 1, 0.2)
    for law in ("polyhedron", "dempack"):
        for seed in (1, 2, 3):
            path = made(f"{law}-{seed}", box_scene(law, seed, "z"))
            r = study.run(f"areas/{law}-{seed}", path, {"output.snapshots": 0})
            check = checked(path, {})
            measured = r.young_modulus_average / 20e9
            rows.append([law, seed, f"{check['neighbours']:.2f}", f"{check['filled']:.3f}", f"{measured:.3f}",
                         f"{measured / (e * check['filled']):.3f}", f"{r.poisson_ratio:.3f}"])
    study.put("area-laws.md", "table space", study.table(
        ["law", "packing", "n_c", "filled", "E/E_material", f"over {e:.3f} times filled", f"nu (uniform strain {nu:.3f})"], rows))


def hydrostatic_table():
    rows = []
    for law in ("polyhedron", "dempack"):
        for seed in (1, 2, 3):
            path = made(f"hydrostatic-{law}-{seed}", box_scene(law, seed, "xyz"))
            r = study.run(f"areas/hydrostatic-{law}-{seed}", path, {"output.snapshots": 0})
            stress, area = -r.results("bonds/contact_stress"), r.results("bonds/area")
            names = ("xx", "yy", "zz")
            pressure = -np.mean([r.results(f"history/stress_{n}")[-1] for n in names])
            volume = -np.sum([r.results(f"history/strain_{n}")[-1] for n in names])
            filled = checked(path, {})["filled"]
            mean = np.sum(stress * area) / np.sum(area)
            rows.append([law, seed, f"{filled:.3f}", f"{pressure / volume / (20e9 / 3):.3f}",
                         f"{pressure / volume / (20e9 / 3 * filled):.3f}", f"{mean / pressure * filled:.3f}",
                         f"{np.std(stress) / np.mean(stress):.2f}"])
    study.put("area-laws.md", "table hydrostatic", study.table(
        ["law", "packing", "filled", "K over E/3", "over E/3 times filled", "mean stress of bonds, times filled, over p",
         "scatter of bonds"], rows))


# --- sweeps ---------------------------------------------------------------------------------------------------

def sweep(mesh):
    """Rows (alpha, beta, E over the mean strain, E over that of the platens, nu') of all runs."""
    name = f"sweep-{mesh[0]}"
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.yaml"
    parameters = {"materials.rubber.alpha": list(ALPHAS), "materials.rubber.beta": list(BETAS)}
    path.write_text(json.dumps({"scene": str(study.ROOT / DISCS), "parameters": parameters}))
    out = FOLDER / name
    done = study.call(["sweep", str(path), "--out", str(out), "--quiet", "--threads", str(study.THREADS),
                       *study.set_arguments(mesh_settings(mesh)), *(["--force"] if study.FRESH else [])])
    if done.returncode:
        sys.exit(done.stderr)
    with open(out / "sweep.csv", newline="") as file:
        table = list(csv.DictReader(file))
    columns = {key.split()[0]: key for key in table[0]}

    def value(row, key):
        text = row[columns[key]]
        return float(text) if text else float("nan")
    return np.array([[value(row, key) for key in ("materials.rubber.alpha", "materials.rubber.beta", "young_modulus_average",
                                                  "young_modulus", "poisson_ratio")] for row in table])


def crossing(alpha, modulus):
    """The alpha at which E is that of the material, from a line through the points."""
    slope, at = np.polyfit(alpha, modulus / YOUNG, 1)
    return (1 - at) / slope


def sweep_tables():
    one, both, of_alpha = [], [], []
    for mesh in MESHES:
        runs = sweep(mesh)
        label = str(mesh[0])
        unit = runs[np.isclose(runs[:, 1], 1)]
        single = unit[np.isclose(unit[:, 0], 1)][0]
        straight = np.corrcoef(unit[:, 0], unit[:, 2])[0, 1]
        one.append([label, f"{single[2] / YOUNG:.3f}", f"{single[3] / YOUNG:.3f}", f"{single[4]:.3f}",
                    f"{1 / (single[2] / YOUNG):.2f}", f"{crossing(unit[:, 0], unit[:, 2]):.2f}",
                    f"{crossing(unit[:, 0], unit[:, 3]):.2f}", f"{straight:.4f}"])
        at = runs[np.isclose(runs[:, 0], 1)]
        at = at[np.argsort(at[:, 1])]
        both.append([label, *(f"{row[2] / YOUNG:.2f}, {row[4]:.2f}" for row in at)])
        of_alpha.append([label, *(f"{row[2] / YOUNG:.2f}, {row[4]:.2f}" for row in unit[np.argsort(unit[:, 0])])])
    theory = [plane(1, b) for b in BETAS]
    both.append(["uniform strain", *(f"{e:.2f}, {nu:.2f}" for e, nu in theory)])
    theory = [(a * plane(a, 1)[0], plane(a, 1)[1]) for a in ALPHAS]
    of_alpha.append(["uniform strain", *(f"{e:.2f}, {nu:.2f}" for e, nu in theory)])
    e = plane(1, 1)[0]
    root = np.roots([2, 2 * 0.4 - 3, -0.4])  # alpha 2 (1 + rho)/(3 + rho) = 1 with rho = 0.4/alpha
    one.append(["uniform strain", f"{e:.3f}", f"{e:.3f}", f"{plane(1, 1)[1]:.3f}", f"{1 / e:.2f}", f"{np.max(root):.2f}", "", ""])
    study.put("area-laws.md", "table alpha", study.table(
        ["discs", "E'/E at alpha 1, beta 1", "over the strain of the platens", "nu'", "alpha wanted, if k_t has it too",
         "alpha wanted", "alpha wanted, platens", "correlation of E with alpha"], one))
    study.put("area-laws.md", "table beta", study.table(["discs: E'/E, nu' at alpha 1", *(f"beta {b}" for b in BETAS)], both))
    study.put("area-laws.md", "table alphas", study.table(["discs: E'/E, nu' at beta 1", *(f"alpha {a}" for a in ALPHAS)], of_alpha))


if __name__ == "__main__":
    fill_table()
    space_table()
    hydrostatic_table()
    sweep_tables()
