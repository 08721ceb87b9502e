"""Published specimens in the laboratory's tests: the disc of cement paste (Santasusana 2013), the cylinders, squares and discs of
Labra 2012, specimen 2 of Rojek et al. 2012. Fills the parts on them of docs/evidence/laboratory.md and its pictures.

    /usr/bin/python3 validate/laboratory_study.py [--fresh] [--kept] [--quick] [disc] [labra] [published] [rojek] [rojek-all]

Ten minutes of one core, without `published` and `rojek-all`, which take most of an hour each and are made when they are named. --kept: tables
from the runs that are there; --quick: a tenth of the particles, one packing, and prints what it would have written. Runs stay in runs/studies/laboratory.
"""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import study

QUICK = "--quick" in sys.argv
NAME = "laboratory-quick" if QUICK else "laboratory"
FOLDER = study.RUNS / NAME
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
PAGE = "laboratory.md"
LONG = ("published", "rojek-all")  # Computed only if requested by name.
SEEDS = (1,) if QUICK else (1, 2)
FLAT = np.cos(np.radians(5))  # Distance of the platens of a Brazilian disc from its centre, relative to its radius: flats of 10 degrees.

WIDE = np.cos(np.radians(10))


def few(count):
    return max(300, count // 10) if QUICK else count


def put(name, head, rows):
    study.put_table(PAGE, name, head, rows, QUICK)


def save(figure, name):
    study.save(figure, FOLDER if QUICK else PICTURES, name)


def made(name, scene, **settings):
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.yaml"
    path.write_text(json.dumps(scene, indent=1))
    return study.run(f"{NAME}/{name}", path, {"run.threads": 1, **settings})


def pair(axis, low, high, speed, stiffness, dimension):
    """Two frictionless platens that close with `speed` together, from rest."""
    at, walls = "xyz".index(axis), []
    for name, place, sign in (("lower", low, 1), ("upper", high, -1)):
        point, normal = [0.0] * dimension, [0] * dimension
        point[at], normal[at] = place, sign
        walls.append({"name": name, "point": point, "normal": normal, "stiffness": stiffness, "passive": True,
                      "motion": {f"v{axis}": [[0, 0], [1e-4, sign * 0.5 * speed]]}})
    return walls


def bonds_per_particle(run):
    return 2 * run.bonds / run.summary["counts"]["particles"]


def spread(values, digits=3):
    """Mean and range of the values that exist."""
    values = np.asarray([value for value in values if np.isfinite(value)], float)
    if not len(values):
        return ""
    text = f"{np.mean(values):.{digits}g}"
    return text if len(values) < 2 else f"{text} ({np.min(values):.{digits}g} to {np.max(values):.{digits}g})"


# --- disc of cement paste -----------------------------------------------------------------------------------------

PASTE = {"name": "paste", "density": 1700, "young": 2.85e9, "poisson": 0.1, "friction": 0.4, "bond_friction": 0.3,
         "tensile_strength": 2.9e6, "shear_strength": 6e6, "fracture_ratio": 1.0, "yield_stress_1": 6.7e6, "yield_ratio_1": 18.0}


def without_yield():
    return {key: value for key, value in PASTE.items() if not key.startswith("yield")}


def paste_bar(count, seed):
    """A bar of 25 x 25 x 50 mm that is pulled by its outermost 4 mm."""
    side, length = 0.025, 0.05
    ends = [("low", "lower", -1), ("high", "upper", 1)]
    return {
        "dimension": 3, "specimen": {"box": {"size": [side, side, length]}, "particles": few(count),
                                     "packing": {"size_ratio": 3, "overlap": "passive", "overlap_size": 0.02}},
        "materials": [PASTE], "law": {"softening": "ratio", "stiffness": "dempack", "gamma": 0.8}, "bonds": {},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.2}, "contact": {"fraction": 0.9}},
        "sets": [{"name": name, "select": {"end": {"axis": "z", "side": side_of, "depth": 4e-3}}, "motion": {"vz": [[0, 0], [1e-4, 0.01 * sign]]}}
                 for name, side_of, sign in ends],
        "test": {"kind": "tension", "axis": "z", "lower": "low", "upper": "high", "length": length, "area": side**2},
        "time": {"end": 0.01 * length / 0.02, "stop": {"peak_drop": 0.5}},
        "output": {"history_rows": 1000, "snapshots": 0, "checkpoint": "off"}, "run": {"seed": seed, "threads": 1}}


def paste_disc(count, seed, law, speed, material=None, flat=FLAT):
    diameter, thickness = 0.05, 0.025
    return {
        "dimension": 3, "specimen": {"cylinder": {"diameter": diameter, "height": thickness}, "particles": few(count),
                                     "packing": {"size_ratio": 3, "overlap": "passive", "overlap_size": 0.02}},
        "materials": [material or PASTE], "law": {"softening": "ratio", **law}, "bonds": {},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.2}, "contact": {"fraction": 0.9}},
        "walls": pair("y", -flat * diameter / 2, flat * diameter / 2, speed, 5e7, 3),
        "test": {"kind": "brazilian", "axis": "y", "lower": "lower", "upper": "upper", "diameter": diameter, "thickness": thickness},
        "time": {"end": 0.03 * diameter / speed, "stop": {"peak_drop": 0.5}},
        "output": {"history_rows": 2000, "snapshots": 0, "checkpoint": "off"}, "run": {"seed": seed, "threads": 1}}


def disc_part():
    source, volume, shape = ({"stiffness": "dempack", "gamma": 0.8}, {"stiffness": "dempack", "gamma": "auto"}, {"stiffness": "polyhedron"})
    cases = (("Dempack, gamma 0.8", 500, source, 0.1), ("Dempack, gamma 0.8", 1500, source, 0.1), ("Dempack, gamma 0.8", 4000, source, 0.1),
             ("Dempack, gamma 0.8", 1500, source, 0.25), ("Dempack, gamma 0.8", 1500, source, 0.05),
             ("the same without yield", 1500, source, 0.1), ("the same, flats of 20 degrees", 1500, source, 0.1),
             ("Dempack, sections that fill the disc", 1500, volume, 0.1), ("polyhedra", 1500, shape, 0.1))
    rows, drawn = [], {}
    for number, (name, count, law, speed) in enumerate(cases):
        seeds = SEEDS if speed == 0.1 and count <= 1500 else SEEDS[:1]
        runs = [made(f"disc-{count}-{number}-{seed}", paste_disc(count, seed, law, speed, without_yield() if "without" in name else None,
                                                                    WIDE if "20 degrees" in name else FLAT)) for seed in seeds]
        if number in (0, 1, 2):
            drawn[f"{few(count)} spheres"] = runs[0]
        peaks = sum(np.isfinite(r.peak_stress) for r in runs)
        rows.append([name, few(count), f"{speed:g}", len(seeds) if peaks == len(seeds) else f"{len(seeds)}, peaks in {peaks}", f"{np.mean([bonds_per_particle(r) for r in runs]):.2f}",
                     spread([r.peak_stress / 1e6 for r in runs]), spread([100 * r.peak_strain for r in runs], 2),
                     spread([r.centre_tension / 1e6 for r in runs], 2), spread([r.centre_ratio for r in runs], 2),
                     f"{np.mean([r.broken[0] for r in runs]):.0f} + {np.mean([r.broken[1] for r in runs]):.0f}"])
    bars = [made(f"bar-{seed}", paste_bar(1500, seed)) for seed in SEEDS]
    rows.append(["a bar that is pulled", few(1500), "0.02", len(bars), f"{np.mean([bonds_per_particle(r) for r in bars]):.2f}",
                 spread([r.peak_stress / 1e6 for r in bars]) + " (force over area)", spread([100 * r.peak_strain for r in bars], 2) + " (strain)", "", "",
                 f"{np.mean([r.broken[0] for r in bars]):.0f} + {np.mean([r.broken[1] for r in bars]):.0f}"])
    put("table disc", ["sections", "spheres", "closing m/s", "packings", "n_c", "2 P/(pi D t) MPa", "closing over D %", "tension in the middle then MPa",
                       "the same over 2 P/(pi D t), while it rises", "broken: tension + shear"], rows)
    figure, axes = plt.subplots(figsize=(7, 5))
    for (name, run), colour in zip(drawn.items(), ("#9aa5ad", "#2b6cb0", "#c8402f")):
        axes.plot(100 * run.results("history/strain"), run.results("history/stress") / 1e6, color=colour, label=name)
        axes.plot(100 * run.results("history/strain"), run.results("history/centre_stress_xx") / 1e6, color=colour, lw=0.8, ls=":")
    axes.axhline(2.9, color="#22303c", ls="--", lw=1, label="published")
    axes.set(xlabel="closing over diameter, %", ylabel="2 P/(pi D t) and, dotted, tension in the middle, MPa", title="Disc of cement paste", ylim=(0, None))
    axes.legend()
    save(figure, "laboratory-disc")


# --- Labra's specimens -----------------------------------------------------------------------------------------------

SIDE = 0.05  # m
LABRA = {2: {"normal_stiffness": 10e9, "kratio": 2.5, "bond_tension_limit": 1e3, "bond_shear_limit": 1e3},
         3: {"normal_stiffness": 35e6, "kratio": 1 / 0.3, "bond_tension_limit": 100.0, "bond_shear_limit": 100.0}}
# For the check: target E GPa, nu, UCS MPa; published result with the parameters that follow.
RAISED = {"time.mass_scaling.factor": 2}  # steps twice as long
TARGETS = {2: (18.630, 0.2009, 126.38), 3: (18.652, 0.2012, 126.12)}
CHECK = {2: {"normal_stiffness": 14.392e9, "kratio": 14.392 / 2.868, "bond_tension_limit": 4962.3, "bond_shear_limit": 49623.0, "friction": 0.8},
         3: {"normal_stiffness": 27.889e6, "kratio": 27.889 / 5.3681, "bond_tension_limit": 91.971, "bond_shear_limit": 643.80, "friction": 0.8}}
SIZES = {2: 5.92, 3: 6}  # largest over smallest radius


def labra_specimen(dimension, shape, seed, constants, many, overlap=None):
    packing = {"size_ratio": SIZES[dimension], **({"overlap": "passive", "overlap_size": overlap} if overlap else {})}
    return {
        "dimension": dimension, "specimen": {**shape, **many, "packing": packing, "density_basis": "bulk"},
        "materials": [{"name": "rock", "density": 2580, "friction": 0.5, **constants}],
        "law": {"stiffness": "uniform"}, "bonds": {},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
        "output": {"history_rows": 2000, "snapshots": 0, "checkpoint": "off"}, "run": {"seed": seed, "threads": 1}}


def crushed(dimension, seed, speed, constants, many, overlap=None, strain=0.02):
    shape = {"rectangle": {"width": SIDE, "height": SIDE}} if dimension == 2 else {"cylinder": {"diameter": SIDE, "height": SIDE}}
    axis = "y" if dimension == 2 else "z"
    scene = labra_specimen(dimension, shape, seed, constants, many, overlap)
    return {**scene, "walls": pair(axis, 0, SIDE, speed, 10 * constants["normal_stiffness"], dimension),
            "test": {"kind": "compression", "axis": axis, "lower": "lower", "upper": "upper", "length": SIDE, "diameter": SIDE},
            "time": {"end": strain * SIDE / speed, "stop": {"peak_drop": 0.5}}}


def split(dimension, seed, speed, constants, many, overlap=None):
    shape = {"disc": {"diameter": SIDE}} if dimension == 2 else {"cylinder": {"diameter": SIDE, "height": SIDE}}
    scene = labra_specimen(dimension, shape, seed, constants, many, overlap)
    return {**scene, "walls": pair("y", -FLAT * SIDE / 2, FLAT * SIDE / 2, speed, 10 * constants["normal_stiffness"], dimension),
            "test": {"kind": "brazilian", "axis": "y", "lower": "lower", "upper": "upper", "diameter": SIDE},
            "time": {"end": 0.02 * SIDE / speed, "stop": {"peak_drop": 0.5}}}


def groups(run, disc=False):
    """n_c, porosity, and rt = 4 <r^3>/<l^2> (2D: 4 <r^2>/<l^2>, times 1 m), A = 2 <r^3>/<l> (2D: 2 <r^2>/<l>) of the groups."""
    dimension = run.summary["dimension"] if "dimension" in run.summary else (2 if np.ptp(run.results("particles/position")[:, 2]) == 0 else 3)
    x, d = run.results("particles/position"), run.results("particles/displacement")
    length = np.linalg.norm((x - d)[run.results("bonds/j")] - (x - d)[run.results("bonds/i")], axis=1)
    r = run.results("particles/radius")
    body = (np.pi / 4 if disc or dimension == 3 else 1) * SIDE**dimension
    solid = np.pi * np.sum(r**2) if dimension == 2 else 4 / 3 * np.pi * np.sum(r**3)
    power = np.mean(r**dimension)
    return bonds_per_particle(run), 1 - solid / body, 4 * power / np.mean(length**2), 2 * power / np.mean(length), 1e3 * r.mean()


def plane(run):
    """Constants of the material, of discs in plane strain: E GPa and nu."""
    if "plane_young_modulus" in run.summary["readings"]:
        nu = run.poisson_ratio / (1 + run.poisson_ratio)
        return run.young_modulus_average * (1 - nu**2) / 1e9, nu
    return run.young_modulus_average / 1e9, run.poisson_ratio


def uniform_strain(run, constants, dimension):
    """E GPa and nu of the material if every particle followed the mean strain of an isotropic packing with these bonds."""
    n_c, porosity, size, *_ = groups(run)
    rho, normal = 1 / constants["kratio"], constants["normal_stiffness"]
    if dimension == 2:
        a = 2 * normal * n_c * (1 - porosity) / (np.pi * size)
        return a * (1 + rho) * (5 - rho) / 16 / 1e9, (1 - rho) / 4
    a = 3 * normal * n_c * (1 - porosity) / (2 * np.pi * size)
    return a * (2 + 3 * rho) / (3 * (4 + rho)) / 1e9, (1 - rho) / (4 + rho)


def labra_part():
    rows, curves = [], []
    for dimension, pressed, split_count, speeds, overlap in ((2, 11180, 3000, (0.01, 0.01), None), (3, 4000, 4000, (0.1, 0.05), 0.03)):
        constants = LABRA[dimension]
        crush = [made(f"labra-{dimension}-ucs-{s}", crushed(dimension, s, speeds[0], constants, {"particles": few(pressed)}, overlap),
                      **(RAISED if dimension == 3 else {})) for s in SEEDS[:4 - dimension]]
        across = [made(f"labra-{dimension}-brazilian-1", split(dimension, 1, speeds[1], constants, {"particles": few(split_count)}, overlap), **RAISED)]
        n_c, porosity, _, _, radius = groups(crush[0])
        law = uniform_strain(crush[0], constants, dimension)
        measures = []  # Strengths divided by the quantity that scales them, so that specimens of different numbers of particles are comparable.
        for runs, disc in ((crush, False), (across, True)):
            of_bonds, voids, _, section, _ = groups(runs[0], disc)
            measures.append(np.mean([r.peak_stress for r in runs]) * section / (constants["bond_tension_limit"] * of_bonds * (1 - voids)))
        rows.append([f"{dimension}D", few(pressed), f"{100 * porosity:.1f}", f"{n_c:.2f}", f"{radius:.3f}", spread([plane(r)[0] for r in crush]),
                     f"{law[0]:.3g}", spread([plane(r)[1] for r in crush]), f"{law[1]:.3f}", spread([r.peak_stress / 1e6 for r in crush]),
                     f"{measures[0]:.3f}", f"{100 * np.mean([r.broken[1] / sum(r.broken) for r in crush]):.0f}", few(split_count),
                     spread([r.peak_stress / 1e6 for r in across]), f"{measures[1]:.3f}",
                     f"{100 * np.mean([r.broken[1] / sum(r.broken) for r in across]):.0f}", f"{measures[0] / measures[1]:.2f}"])
        curves.append((dimension, crush[0], across[0]))
    put("table labra", ["", "particles", "e %", "n_c", "mean radius mm", "E GPa", "of uniform strain", "nu", "of uniform strain", "UCS MPa",
                        "UCS A/(R_n n_c (1 - e))", "broken in shear %", "particles, Brazilian", "2 P/(pi D t) MPa", "the same times A/(R_n n_c (1 - e))", "broken in shear %",
                        "ratio of these measures"], rows)
    figure, axes = plt.subplots(1, 2, figsize=(12, 5))
    for ax, (dimension, crush, across) in zip(axes, curves):
        for run, colour, label in ((crush, "#c8402f", "compression"), (across, "#2b6cb0", "Brazilian, 2 P/(pi D t)")):
            ax.plot(100 * run.results("history/strain"), run.results("history/stress") / 1e6, color=colour, label=label)
        ax.set(xlabel="closing over length, %", ylabel="MPa", title=f"Labra 2012, {dimension}D, base parameters", ylim=(0, None))
        ax.legend()
    save(figure, "laboratory-labra")


BY_RADIUS = {"mean_radius": 0.8431e-3 * (2.15 if QUICK else 1)}  # published for 28 371 spheres
CHECKS = (("3D, published mean radius", 3, "", BY_RADIUS, 0.1), ("the same, a fifth of the speed", 3, "-slow", BY_RADIUS, 0.02),
          ("the same, damping 0.2", 3, "-damping", BY_RADIUS, 0.1), ("3D, published number", 3, "-number", {"particles": few(28371)}, 0.1),
          ("2D", 2, "", {"particles": few(30480)}, 0.1))


def check_runs(dimension, name, many, speed):
    """Runs both tests with the published result of the calibration; None if a run does not exist (--kept)."""
    overlap = 0.017 if dimension == 3 else None
    more = {**RAISED, **({"damping.background.coefficient": 0.2} if name == "-damping" else {})}
    crush = study.if_there(made, f"check-{dimension}{name}-1", crushed(dimension, 1, speed, CHECK[dimension], many, overlap), **more)
    across = study.if_there(made, f"check-{dimension}{name}-brazilian-1", split(dimension, 1, speed, CHECK[dimension], many, overlap), **more)
    return crush, across


def published_part():
    """The check of the calibration: published E, nu and strengths beside those of our packings with the published
    parameters."""
    rows, missing = [], []
    for title, dimension, name, many, speed in CHECKS:
        crush, across = check_runs(dimension, name, many, speed)
        missing += [f"{title}: {kind}" for run, kind in ((crush, "compression"), (across, "Brazilian")) if run is None]
        if crush is None and across is None:
            continue
        one, wanted = crush or across, TARGETS[dimension]
        n_c, porosity, _, _, radius = groups(one, disc=crush is None)
        row = [title, one.summary["counts"]["particles"], f"{100 * porosity:.2f}", f"{n_c:.3f}", f"{radius:.4f}"]
        if crush:
            law = uniform_strain(crush, CHECK[dimension], dimension)
            row += [f"{plane(crush)[0]:.2f}", f"{law[0]:.2f}", f"{wanted[0]}", f"{plane(crush)[1]:.4f}", f"{law[1]:.3f}", f"{wanted[1]}",
                    f"{crush.peak_stress / 1e6:.1f}", f"{wanted[2]}"]
        else:
            row += [""] * 8
        row += [f"{across.peak_stress / 1e6:.2f}" if across else "", f"{crush.peak_stress / across.peak_stress:.2f}" if crush and across else ""]
        rows.append(row)
    study.put_table(PAGE, "table check", ["", "particles", "e %", "n_c", "mean radius mm", "E GPa", "of uniform strain", "published", "nu", "of uniform strain", "published",
                                          "UCS MPa", "published", "2 P/(pi D t) MPa (wanted 12.30)", "UCS over it (wanted 10.39)"], rows, QUICK, missing)


# --- Rojek's specimen 2 --------------------------------------------------------------------------------------------------

MODELS = (("arithmetic", "1"), ("harmonic", "2"), ("mean_radius", "3a"), ("mean_arithmetic", "3b"), ("mean_harmonic", "3c"))
SPECIMEN = {"cylinder": {"diameter": 0.023, "height": 0.046}, "particles": 5868, "packing": {"sizes": "uniform", "size_ratio": 10.8, "overlap": "passive"}}
WANTED = {"specimen 1": 11.89, "specimen 2": 10.7}


def packed(seed, overlap, count=SPECIMEN["particles"]):
    """Path of x y z r of specimen 2, or of fewer spheres of the same distribution in the same cylinder."""
    folder = FOLDER / (f"pack-{seed}-{overlap:g}" + ("" if count == SPECIMEN["particles"] else f"-{count}"))
    if not (folder / "packing.txt").exists() or study.FRESH:
        if study.KEPT:
            raise study.Missing(folder.name)
        specimen = {**SPECIMEN, "particles": count, "packing": {**SPECIMEN["packing"], "overlap_size": overlap}}
        FOLDER.mkdir(parents=True, exist_ok=True)
        scene = FOLDER / f"pack-{seed}.yaml"
        scene.write_text(json.dumps({"dimension": 3, "specimen": specimen, "run": {"seed": seed}}))
        done = study.call(["pack", str(scene), "--out", str(folder), "--threads", "1", "--force"])
        if done.returncode:
            sys.exit(done.stderr)
    return folder / "packing.txt"


def neighbours(path, reach=2.5):
    """Radii, the two of each pair up to a gap of `reach` times the sum of the radii, and that gap, m."""
    from scipy.spatial import cKDTree

    rows = np.loadtxt(path)
    x, r = rows[:, :3], rows[:, 3]
    first, second = [], []
    for part in np.array_split(np.argsort(r), 12):  # For particles of equal size: the search range of each is as small as possible.
        near = cKDTree(x[part]).query_ball_point(x, (1 + reach) * (r + r[part].max()))
        first.append(np.repeat(np.arange(len(r)), [len(k) for k in near]))
        second.append(part[np.concatenate(near).astype(int)])
    i, j = np.concatenate(first), np.concatenate(second)
    i, j = i[j > i], j[j > i]
    gap = np.linalg.norm(x[i] - x[j], axis=1) - r[i] - r[j]
    near = gap <= reach * (r[i] + r[j])
    return r, i[near], j[near], gap[near]


def reach_for(measure, wanted, count):
    """The measure up to which there are `wanted` neighbours per particle."""
    need = int(round(0.5 * wanted * count))
    return np.sort(measure)[need - 1] if need <= len(measure) else float("nan")


def gap_part():
    rows = []
    bodies = [("specimen 1", "our rock-a", study.ROOT / "scenes" / "specimens" / "rock-a.txt")]
    bodies += [("specimen 2", f"packing {seed}, overlap {100 * size:g} %", packed(seed, size))
               for seed, size in ((1, 0.02), (2, 0.02), (3, 0.02), (1, 0.01), (1, 0.03))]
    for name, label, path in bodies:
        r, i, j, gap = neighbours(path)
        total, smaller = r[i] + r[j], np.minimum(r[i], r[j])
        solid = 4 / 3 * np.pi * np.sum(r**3) / (np.pi / 4 * 0.023**2 * 0.046)
        wanted, count = WANTED[name], len(r)
        held = np.bincount(np.concatenate([i[gap <= 0.05 * total], j[gap <= 0.05 * total]]), minlength=count)
        rows.append([name, label, count, f"{100 * (1 - solid):.1f}", f"{2 * np.sum(gap <= 0.05 * total) / count:.2f}", wanted,
                     f"{reach_for(gap / total, wanted, count):.3f}", f"{reach_for(gap, wanted, count) * 1e3:.3f}",
                     f"{reach_for(gap, wanted, count) / r.mean():.3f}", f"{reach_for(gap / smaller, wanted, count):.3f}",
                     f"{np.mean(held[held >= 4]):.2f}", f"{np.mean(held[r >= np.median(r)]):.2f}"])
    put("table gap", ["published", "packing", "spheres", "e %", "n_c within 5 % of r_i + r_j", "published n_c", "gap over r_i + r_j that gives it", "the same gap for all, mm",
                      "that over the mean radius", "gap over the smaller radius", "n_c of particles with 4 or more", "of the larger half"], rows)


def five_models(count, name):
    """The five models on packing 1 of this number of spheres, with bonds over gaps of 5 % and over the gap that gives
    their published number."""
    path, rows, missing = study.if_there(packed, 1, 0.02, count), [], []
    if path is None:
        study.put_table(PAGE, f"table {name}", [], [], QUICK, [f"any, with {count} spheres"])
        return
    r, i, j, gap = neighbours(path)
    wide = round(float(reach_for(gap / (r[i] + r[j]), WANTED["specimen 2"], len(r))), 3)
    for label, reach in (("gaps up to 5 %", 0.05), (f"gaps up to {100 * wide:.1f} %", wide)):
        settings = {"specimen.file": path, "specimen.material": "rock", "bonds.interaction_range": reach, "run.threads": 1,
                    "time.mass_scaling.factor": 2}
        base = None
        for model, number in MODELS:
            run = study.if_there(study.run, f"{NAME}/{name}-{model}-{reach:g}", study.ROCK, {**settings, "law.stiffness": model})
            if run is None:
                missing.append(f"{label}, {model}")
                continue
            base = base or run
            rows.append([label, f"{model} ({number})", f"{bonds_per_particle(run):.2f}", f"{run.peak_stress / 1e6:.1f}", f"{run.young_modulus_average / 1e9:.2f}",
                         f"{run.poisson_ratio:.3f}", f"{run.peak_stress / base.peak_stress:.3f}",
                         f"{run.young_modulus_average / base.young_modulus_average:.3f}", f"{100 * run.broken[0] / sum(run.broken):.0f}"])
    study.put_table(PAGE, f"table {name}", ["bonds over", "model", "n_c", "UCS MPa", "E average GPa", "nu", "UCS over arithmetic", "E over arithmetic",
                                            "broken in tension %"], rows, QUICK, missing)


def rojek_part():
    """The five models on as many spheres as cost little."""
    gap_part()
    five_models(1500, "rojek")


def whole_part():
    """The five models on all spheres of the specimen."""
    five_models(few(SPECIMEN["particles"]), "rojek-all")


def main():
    known = {"disc": disc_part, "labra": labra_part, "published": published_part, "rojek": rojek_part, "rojek-all": whole_part}
    asked = [a for a in sys.argv[1:] if not a.startswith("-")]
    if set(asked) - set(known):
        sys.exit(f"laboratory_study: expected some of {', '.join(known)}, found {' '.join(asked)}")
    for name in asked or [name for name in known if name not in LONG]:
        known[name]()


if __name__ == "__main__":
    main()
