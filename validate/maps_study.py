"""Dimensionless maps of packings of bonded particles in the form of Labra 2012, figures 4.18 to 4.47: E, nu, strengths in compression, direct
tension and the Brazilian test, and kinds of breaks, over k_t/k_n, R_t/R_n and friction, in 2D and 3D, and for laws that raise the ratio of the strengths.

    /usr/bin/python3 validate/maps_study.py [--jobs N] [--kept] [--quick]

Writes data/maps.csv, the tables of docs/evidence/strength-maps.md and its pictures. About 1600 runs of a second, made by `gneiss sweep` in
runs/studies/maps; a repeated call makes the runs that are missing. --kept: from the runs that are there; --quick: one seed, few points, no page.
"""
import csv
import io
import json
import sys

import h5py
import numpy as np

import study

sys.path.append(str(study.ROOT))
from calibrate import maps  # noqa: E402

QUICK = "--quick" in sys.argv
FOLDER = study.RUNS / ("maps-quick" if QUICK else "maps")
JOBS = int(sys.argv[sys.argv.index("--jobs") + 1]) if "--jobs" in sys.argv else study.THREADS
SEEDS = (1,) if QUICK else (1, 2, 3)
TESTS = ("compression", "tension", "brazilian")
BASE = {"law": "linear", "rho_k": 0.35, "chi": 1.0, "mu": 0.5, **maps.PLAIN}
NORMAL = {2: 10e9, 3: 35e6}  # k_n, N/m
WIDTH, DENSITY, COUNT = 0.05, 2580.0, 1500  # m, kg/m3 of the assembly, particles
PACKING_KEYS = {2: {"size_ratio": 6}, 3: {"size_ratio": 3, "overlap": "passive", "overlap_size": 0.03}}
FLAT = np.cos(np.radians(5))  # platens of a Brazilian disc stand this far from its centre, over its radius: flats of 10 degrees
INSET = {2: 0.6, 3: 0.0}  # inset of platens in compression, over the mean radius; without it they would touch 2 to 26 of the some 25 discs at an end
WAVE = 2000.0  # m/s, approximate speed of waves along the specimen
# Strain of the test at the peak that R_n is chosen for, and the time to reach it over that of a wave through the specimen.
PEAK = {"compression": 4e-3, "tension": 1e-3, "brazilian": 4e-3}
TRANSITS = {"compression": 75, "tension": 30, "brazilian": 100}


def expected_strain(dimension, test, point):
    """Strain at the peak with R_n = 1e-3 k_n times the mean radius, roughly: it sets R_n, so that all runs take about the same number of steps."""
    chi, rho = point["chi"] + point["bond_friction"], max(point["rho_k"], 0.1)
    if test == "tension":
        return {2: 3e-4, 3: 3e-4}[dimension]
    if test == "brazilian":
        return 2.3e-3 * chi**0.25 if dimension == 2 else 2.3e-3 * chi**0.08
    if dimension == 2:
        return 1.3e-3 * chi**0.42
    stiff = 1 + 4 * point["radius_multiplier"] * (1 - point["moment_share"])  # moments that do not break bonds
    return stiff * min(1.2e-3 * chi**0.5, (2.2e-3 if rho < 0.5 else 6e-3 * rho) * (1 + point["bond_friction"]))


def radius_of(dimension, test):
    """Mean radius of the particles, m, roughly: of a solid fraction of 0.9 (2D) or 0.75."""
    if dimension == 2:
        return np.sqrt(0.9 * WIDTH**2 * (np.pi / 4 if test == "brazilian" else 2) / np.pi / COUNT)
    return np.cbrt(0.75 * np.pi / 4 * WIDTH**3 * (0.5 if test == "brazilian" else 2) / (4 / 3 * np.pi) / COUNT)


def scene(dimension, test, factor=1.0, count=COUNT, damping=0.2, stretch=1.0, mass=2, packing=None, inset=None):
    """The scene of one test. factor: divides the speed of loading; stretch: of the strain at the peak (with R_n, see `settings`); mass: of
    time.mass_scaling; packing: other settings of the packing; inset: of the platens in compression, over the mean radius."""
    across = test == "brazilian"
    length = WIDTH if across else 2 * WIDTH
    axis = "z" if dimension == 3 and not across else "y"
    if dimension == 2:
        shape = {"disc": {"diameter": WIDTH}} if across else {"rectangle": {"width": WIDTH, "height": length}}
    else:
        shape = {"cylinder": {"diameter": WIDTH, "height": WIDTH / 2 if across else length}}
    speed = PEAK[test] * stretch * WAVE / TRANSITS[test] / factor
    made = {
        "dimension": dimension,
        "specimen": {**shape, "particles": count, "density_basis": "bulk", "packing": {**PACKING_KEYS[dimension], **(packing or {})}},
        "materials": [{"name": "rock", "density": DENSITY, "friction": 0.5, "normal_stiffness": NORMAL[dimension], "kratio": 1.0,
                       "bond_tension_limit": 1.0, "bond_shear_limit": 1.0}],
        "law": {"stiffness": "uniform"}, "bonds": {"interaction_range": 0.05},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": damping}},
        "test": {"kind": test, "axis": axis, "lower": "lower", "upper": "upper", "diameter": WIDTH, **({} if across else {"length": length})},
        "time": {"end": 5 * PEAK[test] * stretch * length / speed, "stop": {"peak_drop": 0.5}, **({"mass_scaling": {"factor": mass}} if mass > 1 else {})},
        "output": {"history_rows": 3000, "snapshots": 0, "checkpoint": "off", "events": "off"}, "run": {"seed": 1}}
    inset = (INSET[dimension] if inset is None else inset) * radius_of(dimension, test)
    return {**made, **ends(dimension, test, axis, (inset, length - inset), speed, 0.05 * TRANSITS[test] * length / WAVE * factor)}


def ends(dimension, test, axis, places, speed, ramp_end):
    """Sets of outer particles that are pulled, or frictionless platens at the places that close, with `speed` together."""
    at, key, sides = "xyz".index(axis), f"v{axis}", (("lower", -1), ("upper", 1))
    motion = {name: {key: [[0, 0], [ramp_end, 0.5 * speed * sign * (1 if test == "tension" else -1)]]} for name, sign in sides}
    if test == "tension":
        return {"sets": [{"name": name, "select": {"end": {"axis": axis, "side": name, "depth": 0.12 * WIDTH}}, "motion": motion[name]}
                         for name, _ in sides]}
    walls = []
    for name, sign in sides:
        point, normal = [0.0] * dimension, [0] * dimension
        point[at] = sign * FLAT * WIDTH / 2 if test == "brazilian" else places[sign > 0]
        normal[at] = -sign
        walls.append({"name": name, "point": point, "normal": normal, "stiffness": 10 * NORMAL[dimension], "passive": True, "motion": motion[name]})
    return {"walls": walls}


def settings(dimension, test, point, stretch=1.0, count=COUNT):
    """Keys of the scene and their values for a point of the maps."""
    limit = 1e-3 * NORMAL[dimension] * radius_of(dimension, test) * PEAK[test] / expected_strain(dimension, test, point)
    limit *= stretch * (COUNT / count) ** (1 / dimension)
    rock = "materials.rock."
    share = {"bonds.moment_share": point["moment_share"]} if point["moment_share"] != maps.PLAIN["moment_share"] else {}
    return {**share, rock + "kratio": 1 / point["rho_k"] if point["rho_k"] else 0.0, rock + "bond_tension_limit": limit,
            rock + "bond_shear_limit": limit * point["chi"], rock + "friction": point["mu"], rock + "bond_friction": point["bond_friction"],
            "bonds.radius_multiplier": point["radius_multiplier"], "bonds.interaction_range": point["interaction_range"]}


def sweep(name, dimension, test, points, seeds, **variant):
    """Runs the points with all seeds in one sweep; [seeds of a point] of folders of runs, for each point, and its settings."""
    place = f"{name}-{dimension}-{test}"
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / f"{place}.scene.yaml").write_text(json.dumps(scene(dimension, test, **variant), indent=1))
    of = {key: variant[key] for key in ("stretch", "count") if key in variant}
    values = [settings(dimension, test, point, **of) for point in points]
    text = {"scene": f"{place}.scene.yaml", "combine": "zipped", "parameters": {key: [v[key] for v in values] for key in values[0]}, "seeds": list(seeds)}
    (FOLDER / f"{place}.yaml").write_text(json.dumps(text, indent=1))
    how = ["--collect"] if study.KEPT else ["--jobs", str(JOBS), "--threads", str(JOBS)]
    folder = FOLDER / "runs" / place
    done = study.call(["sweep", str(FOLDER / f"{place}.yaml"), "--out", str(folder), "--quiet", *how])
    if done.returncode:
        sys.exit(f"{place}: exit code {done.returncode}\n{done.stderr[-3000:]}")
    with open(folder / "sweep.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    bad = [row for row in rows if row["status"] != "done"]
    if bad:
        sys.exit(f"{place}: {len(bad)} of {len(rows)} runs are not done: {bad[0]['status']} {bad[0]['message']}")
    return [[(folder / row["folder"], values[k]) for row in rows if int(row["combination"]) == k + 1] for k in range(len(points))]


GRID_RHO, GRID_CHI = (0.1, 0.2, 0.35, 0.6, 1.0), (1.0, 2.0, 4.0, 7.0, 10.0, 20.0)
FRICTIONS, FRICTION_CHI = {2: (0.0, 0.25, 1.0, 3.0), 3: (0.0, 0.25, 0.75, 1.0, 1.5, 3.0)}, (1.0, 4.0, 10.0)
LAW_RHO, LAW_CHI = 0.2, {2: (1.0, 10.0), 3: (1.0, 4.0, 10.0)}


def laws_of(frictions, multipliers, ranges):
    """(law, keys) of the laws that have one more parameter than the linear one."""
    return [(name, {key: value}) for name, key, values in (("bond_friction", "bond_friction", frictions), ("moments", "radius_multiplier", multipliers),
                                                           ("range", "interaction_range", ranges)) for value in values]


LAWS = {2: laws_of((1.0,), (0.5, 1.0), (0.2, 0.3)),
        3: [*laws_of((0.5, 1.0, 2.0), (0.5, 1.0), (0.1, 0.2, 0.3, 0.5)), ("range_friction", {"interaction_range": 0.2, "bond_friction": 1.0}),
            ("moments_friction", {"radius_multiplier": 1.0, "bond_friction": 1.0})]}
SHARE_CHI = {2: (1.0, 4.0, 10.0), 3: (1.0, 2.0, 4.0, 10.0)}
SHARES = {2: (0.5, 1.0), 3: (0.25, 0.5, 1.0)}  # radius_multiplier


# Columns of data/maps.csv after the keys of a point and the seed; all without unit.
PACKING = ("n_c", "porosity", "rt", "area")
READ = ("strength", "shear_share", "broken", "shear_share_at_peak", "broken_at_peak")
COLUMNS = (*maps.KEYS, "seed", *PACKING, *(f"disc_{name}" for name in PACKING), "young", "poisson",
           *(test if name == "strength" else f"{test}_{name}" for test in TESTS for name in READ))
HEAD = """# Dimensionless maps of bonded packings (docs/evidence/strength-maps.md); a row for each packing of a point; all columns are without unit.
# Written by: /usr/bin/python3 validate/maps_study.py
# n_c, porosity, rt (3D rt/r, 2D rt/t), area (3D A/r^2, 2D A/(r t); r the mean radius, t the thickness): of the packing in compression and tension;
# disc_...: of that in the Brazilian test. young: E rt/(k_n n_c (1 - e)). compression, tension, brazilian: strength A/(R_n n_c (1 - e)).
# _broken: broken over initial bonds at the end, once the stress has fallen to half its peak; _shear_share: part of them that broke in shear.
"""


def grid_points(dimension):
    """k_t/k_n by R_t/R_n. Without tangential springs R_t has no effect and there is no friction."""
    return [{**BASE, "rho_k": 0.0, "mu": 0.0}] + [{**BASE, "rho_k": rho, "chi": chi} for rho in GRID_RHO for chi in GRID_CHI]


def friction_points(dimension):
    return [{**BASE, "mu": mu, "chi": chi} for mu in FRICTIONS[dimension] for chi in FRICTION_CHI]


def law_points(dimension):
    return [{**BASE, "rho_k": LAW_RHO, "chi": chi, "law": law, **keys} for law, keys in LAWS[dimension] for chi in LAW_CHI[dimension]]


def share_points(dimension):
    """Moments that resist rotation but do not count for the strength."""
    point = {**BASE, "rho_k": LAW_RHO, "law": "moments_only_stiff", "moment_share": 0.0}
    return [{**point, "chi": chi, "radius_multiplier": value} for value in SHARES[dimension] for chi in SHARE_CHI[dimension]]


PARTS = {"grid": grid_points, "friction": friction_points, "laws": law_points, "shares": share_points}


def packing_of(file, dimension, test):
    """Groups of the specimen of a run, made dimensionless by its mean radius and the thickness of 1 m."""
    x, r = file["particles/position"][()] - file["particles/displacement"][()], file["particles/radius"][()]
    branches = np.linalg.norm(x[file["bonds/j"][()]] - x[file["bonds/i"][()]], axis=1)
    volume = WIDTH**2 * (2 if test != "brazilian" else np.pi / 4)
    if dimension == 3:
        volume = np.pi / 4 * WIDTH**3 * (2 if test != "brazilian" else 0.5)
    found = maps.groups(r, branches, volume, dimension)
    unit = r.mean() if dimension == 3 else 1.0
    return found._replace(rt=found.rt / unit, area=found.area / (unit * r.mean())), unit, r.mean()


def measures(folder, dimension, test, keys):
    """Columns that one run gives."""
    readings = json.loads((folder / "summary.json").read_text())["readings"]
    with h5py.File(folder / "results.h5", "r") as file:
        packing, unit, radius = packing_of(file, dimension, test)
        stress, tension, shear = (file[f"history/{name}"][()] for name in ("stress", "broken_tension", "broken_shear"))
        bonds = len(file["bonds/i"])
    limit = keys["materials.rock.bond_tension_limit"]
    part = packing.n_c * (1 - packing.porosity)
    strength = readings["peak_stress"]
    row = {f"disc_{name}" if test == "brazilian" else name: getattr(packing, name) for name in PACKING}
    row[test] = np.nan if strength is None else strength * packing.area * unit * radius / (limit * part)
    for name, at in (("", -1), ("_at_peak", int(np.argmax(stress)))):
        broken = tension[at] + shear[at]
        row[f"{test}_broken{name}"], row[f"{test}_shear_share{name}"] = broken / bonds, shear[at] / broken if broken else 0.0
    if test == "compression":
        nu, modulus = readings["poisson_ratio"], readings["young_modulus_average"]
        if dimension == 2:  # converts values of plane strain to those of the material
            nu = nu / (1 + nu)
            modulus *= 1 - nu**2
        row["young"], row["poisson"] = modulus * packing.rt * unit / (NORMAL[dimension] * part), nu
    return row


def rows_of(name, dimension, points, seeds=SEEDS, tests=TESTS, **variant):
    """A dict of all columns for every point and seed."""
    rows = [[{**point, "dimension": dimension, "seed": seed} for seed in seeds] for point in points]
    for test in tests:
        for of_point, runs in zip(rows, sweep(name, dimension, test, points, seeds, **variant)):
            for row, (folder, keys) in zip(of_point, runs):
                row.update(measures(folder, dimension, test, keys))
    print(f"{name}, {dimension}D: {len(points)} points", file=sys.stderr, flush=True)
    return [row for of_point in rows for row in of_point]


def text_of(value):
    """A cell: five digits; nothing where a run gave no number."""
    if isinstance(value, str):
        return value
    return "" if not np.isfinite(value) else f"{value:.5g}"


def write(rows, path):
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(COLUMNS)
    out.writerows([text_of(row[column]) for column in COLUMNS] for row in rows)
    path.parent.mkdir(exist_ok=True)
    path.write_text(HEAD + text.getvalue())


# Settings and packings beside those of the maps, at a few points; the first is that of the maps.
CHECK_POINTS = [{**BASE, "rho_k": rho, "chi": chi} for rho, chi in ((0.2, 1.0), (0.6, 4.0))]
KINDS = {"3000 particles": {"count": 2 * COUNT}, "sizes 1 to 10": {"packing": {"size_ratio": 10}}}
SMALL_OVERLAP = {"overlap 1 %": {"packing": {"overlap": "passive", "overlap_size": 0.01}}}
VARIANTS = {3: {"half the speed": {"factor": 2.0}, "damping 0.7": {"damping": 0.7}, "R_n and speed a quarter": {"stretch": 0.25}, **KINDS, **SMALL_OVERLAP},
            2: {"half the speed": {"factor": 2.0}, "platens laid on": {"inset": 0.0}, **KINDS}}
# Points at another k_t/k_n than that at which the effects of laws and friction were measured, for the interpolation.
CROSS = [{**BASE, "rho_k": 0.6, "chi": 4.0, "law": law, **keys} for law, keys in
         (("bond_friction", {"bond_friction": 1.0}), ("moments", {"radius_multiplier": 1.0}), ("range", {"interaction_range": 0.3}))]
CROSS_SHARE = [{**BASE, "rho_k": 0.6, "chi": 4.0, "law": "moments_only_stiff", "radius_multiplier": 0.5, "moment_share": 0.0}]
CROSS_FRICTION = [{**BASE, "rho_k": 0.6, "mu": mu} for mu in (0.0, 1.0)]


def check_part(page, rows):
    """`rows`: rows of the maps."""
    found = {}
    for dimension, variants in VARIANTS.items():
        of_maps = [row for point in CHECK_POINTS for row in rows if {**row, **point, "dimension": dimension} == row]
        found[dimension] = {"as in the maps": of_maps}
        for name, variant in variants.items():
            found[dimension][name] = rows_of(f"check-{name.replace(' ', '-').replace('%', 'percent')}", dimension, CHECK_POINTS, **variant)
    page.check_table(found, CHECK_POINTS)
    page.spread_table(found, CHECK_POINTS, ("as in the maps", *KINDS, *SMALL_OVERLAP))
    page.cross_table([(points, rows_of(f"cross-{k}", 3, points)) for k, points in enumerate((CROSS, CROSS_SHARE, CROSS_FRICTION))])


def main():
    study.reported(sys.argv[1:], __doc__, ("--jobs", "--kept", "--quick"))
    rows = []
    for name, points in PARTS.items():
        for dimension in (3, 2):
            chosen = points(dimension)[::12] if QUICK else points(dimension)
            rows += rows_of(name, dimension, chosen)
    write(rows, FOLDER / "maps.csv" if QUICK else maps.DATA)
    if not QUICK:
        import maps_page

        maps_page.write_page()
        check_part(maps_page, rows)


if __name__ == "__main__":
    main()
