"""Strength in tension and compression and friction angle that laws of bonds reach on the same packing, five packings of 1 000
spheres; and the dissipation of a body beyond its contacts' fracture energy. Fills the tables of docs/evidence/law-table.md;
a quarter of an hour of one core.

    /usr/bin/python3 validate/law_table_study.py [--fresh] [laws] [count] [energy] [plane]
"""
import json
import sys

import numpy as np

import study

FOLDER = study.RUNS / "law-table"
SEEDS = (1, 2, 3, 4, 5)
PRESSURES = (0.0, 10e6, 20e6)  # Pa
SIDE, HEIGHT, MODULUS, STRENGTH = 0.025, 0.05, 10e9, 20e6  # m, m, Pa, Pa
RAMP, CLOSING, PULLING = 4e-4, 0.25, 0.1  # s, m/s, m/s

# Name, keys of the material, of the law, of the bonds.
LAWS = (
    ("linear, brittle", {}, {}, {}),
    ("linear, gaps to 0.2", {}, {}, {"interaction_range": 0.2}),
    ("friction of bonds, mu_1 1", {"bond_friction": 1.0}, {}, {}),
    ("the same, mean stress", {"bond_friction": 1.0}, {"confinement": "mean"}, {}),
    ("softening, u_f 5 u_l", {"fracture_ratio": 4.0}, {"softening": "ratio"}, {}),
    ("moments", {}, {}, {"radius_multiplier": 1.0}),
    ("moments, mu_1 1, linear", {"bond_friction": 1.0}, {"coupling": "linear"}, {"radius_multiplier": 1.0}),
)


def specimen(seed, law, count=1000):
    _, material, rule, bonds = law
    return {
        "dimension": 3, "specimen": {"box": {"size": [SIDE, SIDE, HEIGHT]}, "particles": count, "packing": {"overlap": "passive"}},
        "materials": [{"name": "rock", "density": 2650, "contact_modulus": MODULUS, "kratio": 3.0, "friction": 0.5,
                       "tensile_strength": STRENGTH, "shear_strength": 2 * STRENGTH, **material}],
        "law": {"stiffness": "harmonic", **rule}, "bonds": {"interaction_range": 0.05, **bonds},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
        "output": {"history_rows": 1000, "snapshots": 0, "checkpoint": "off"}, "run": {"seed": seed, "threads": 1}}


def platen(name, axis, end, pressure):
    """One of six frictionless platens. With a pressure the lateral ones carry it from the start; the axial ones are
    fixed meanwhile."""
    size = (SIDE, SIDE, HEIGHT)
    point, normal = [0.0] * 3, [0] * 3
    point[axis], normal[axis] = size[axis] * end, 1 - 2 * end
    wall = {"name": name, "point": point, "normal": normal, "stiffness": 1.5e7, "passive": True}
    speed = 0.5 * CLOSING * (1 - 2 * end)
    if axis < 2:
        force = pressure * SIDE * HEIGHT
        wall["servo"] = {"force": [[0, 0], [0.7 * RAMP, force]], "max_velocity": 0.2}
    elif pressure:
        wall["motion"] = {"vz": [[0, 0], [RAMP, 0], [1.2 * RAMP, speed]]}
    else:
        wall["motion"] = {"vz": [[0, 0], [0.2 * RAMP, speed]]}
    return wall


def compression(seed, law, pressure, count=1000):
    scene = specimen(seed, law, count)
    walls = [("bottom", 2, 0), ("top", 2, 1)] + ([("x0", 0, 0), ("x1", 0, 1), ("y0", 1, 0), ("y1", 1, 1)] if pressure else [])
    scene["walls"] = [platen(name, axis, end, pressure) for name, axis, end in walls]
    scene["test"] = {"kind": "compression", "axis": "z", "lower": "bottom", "upper": "top", "length": HEIGHT, "area": SIDE**2}
    scene["time"] = {"end": 0.035 * HEIGHT / CLOSING + RAMP, "stop": {"peak_drop": 0.1}}
    return scene


def pull(scene, height, speed):
    ends = [("low", "lower", -1), ("high", "upper", 1)]
    scene["sets"] = [{"name": name, "select": {"end": {"axis": "z", "side": side, "depth": 0.08 * height}},
                      "motion": {"vz": [[0, 0], [1e-4, sign * 0.5 * speed]]}} for name, side, sign in ends]
    return scene


def tension(seed, law, count=1000):
    scene = pull(specimen(seed, law, count), HEIGHT, PULLING)
    scene["test"] = {"kind": "tension", "axis": "z", "lower": "low", "upper": "high", "length": HEIGHT, "area": SIDE**2}
    scene["time"] = {"end": 0.02 * HEIGHT / PULLING, "stop": {"peak_drop": 0.5}}
    return scene


def made(name, scene):
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.yaml"
    path.write_text(json.dumps(scene, indent=1))
    return study.run(f"law-table/{name}", path, {"run.threads": 1}, must_finish=False)


def mean_text(values, digits=3):
    values = np.asarray(values, float)
    spread = 2.776 * values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else float("nan")  # 95 % interval of the mean of five values
    return f"{values.mean():.{digits}g} ± {spread:.2g}"


def friction_angle(peaks):
    """Degrees, from the slope of the axial stress at failure over the pressure, (1 + sin phi)/(1 - sin phi)."""
    slope = np.polyfit(PRESSURES, peaks, 1)[0]
    return np.degrees(np.arcsin((slope - 1) / (slope + 1)))


def law_row(number, law):
    found = {key: [] for key in ("E", "tension", "peaks", "strain", "angle", "ratio", "residual")}
    for seed in SEEDS:
        pulled = made(f"{number}-tension-{seed}", tension(seed, law))
        pressed = [made(f"{number}-{round(p / 1e6)}-{seed}", compression(seed, law, p)) for p in PRESSURES]
        peaks = [run.largest_stress for run in pressed]
        found["E"].append(pressed[0].young_modulus / 1e9)
        found["tension"].append(pulled.largest_stress / 1e6)
        found["peaks"].append([p / 1e6 for p in peaks])
        found["ratio"].append(peaks[0] / pulled.largest_stress)
        found["angle"].append(friction_angle(peaks))
        found["residual"].append(max(abs(run.residual) for run in (pulled, *pressed)))
    peaks = np.array(found["peaks"])
    print(law[0], found, file=sys.stderr, flush=True)
    return [law[0], mean_text(found["E"]), mean_text(found["tension"]), *(mean_text(peaks[:, k]) for k in range(3)),
            mean_text(found["ratio"]), mean_text(found["angle"]), f"{max(found['residual']):.0e}"]


def laws_table():
    rows = [law_row(number, law) for number, law in enumerate(LAWS)]
    heads = ["law", "E GPa", "tension MPa", *(f"axial stress at failure, {p / 1e6:g} MPa around" for p in PRESSURES),
             "UCS over tension", "friction angle", "largest residual"]
    study.put("law-table.md", "table laws", study.table(heads, rows))


def finer_table():
    """The linear law and friction of bonds for more and fewer particles; tension is equal for both, because nothing
    is compressed."""
    rows = []
    for count in (500, 1000):
        pulled = np.array([made(f"count-{count}-tension-{s}", tension(s, LAWS[0], count)).largest_stress for s in SEEDS]) / 1e6
        linear, friction = (np.array([made(f"count-{count}-{n}-{s}", compression(s, LAWS[n], 0.0, count)).largest_stress for s in SEEDS]) / 1e6
                            for n in (0, 2))
        rows.append([count, mean_text(pulled), mean_text(linear), mean_text(linear / pulled), mean_text(friction), mean_text(friction / linear)])
    heads = ["particles", "tension MPa", "compression MPa", "the same over tension", "compression with mu_1 1", "that over the linear law's, same packing"]
    study.put("law-table.md", "table count", study.table(heads, rows))


# --- fracture energy of bodies --------------------------------------------------------------------------------

YOUNG, TENSILE, FRACTURE = 20e9, 3e6, 15.0  # Pa, Pa, J/m2: E G/sigma^2 is 33 mm
WIDTH, LENGTH = 0.02, 0.03  # m, sizes of the largest strips
OPENED = FRACTURE / TENSILE  # half of the opening at which a contact has softened, m


def strip(dimension, count, seed, scale):
    """A strip that is pulled until its opening is seven times the softening displacement of its bonds, with its
    section and length."""
    width, length = scale * WIDTH, scale * LENGTH
    shape = {"rectangle": {"width": width, "height": length}} if dimension == 2 else {"box": {"size": [width, width, length]}}
    across = {"v" + other: 0 for other in "xyz"[:dimension - 1]}  # Grips without lateral restraint allow the middle to rotate, and a second crack opens.
    axis, grip = "xyz"[dimension - 1], 2.0 * (0.7 * length * width ** (dimension - 1) / count) ** (1 / dimension)
    scene = {
        "dimension": dimension, "specimen": {**shape, "particles": count, "packing": {"overlap": "passive"}},
        "materials": [{"name": "m", "density": 2500, "young": YOUNG, "poisson": 0.2, "tensile_strength": TENSILE,
                       "shear_strength": TENSILE, "fracture_energy": FRACTURE, "shear_fracture_energy": FRACTURE}],
        "law": {"stiffness": "dempack", "softening": "energy", "coupling": "quadratic"}, "bonds": {"interaction_range": 0.05},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.5}},
        "sets": [{"name": name, "select": {"end": {"axis": axis, "side": side, "depth": grip}},
                  "motion": {**across, "v" + axis: [[0, 0], [2e-4, sign * 0.03]]}} for name, side, sign in (("low", "lower", -1), ("high", "upper", 1))],
        "test": {"kind": "tension", "axis": axis, "lower": "low", "upper": "high", "length": length, "area": width ** (dimension - 1)},
        "time": {"end": 1.2e-3, "stop": "none"},
        "output": {"history_rows": 400, "snapshots": 0, "checkpoint": "off"}, "run": {"seed": seed, "threads": 1}}
    return scene, width ** (dimension - 1), length


def parts_of_energy(run, axis, section, length):
    """Energies relative to G_f and the section: the whole dissipated energy; that of bonds across the crack, whose ends have separated by half of
    their softening displacement (one or many planes, and loose pieces between them); that of the rest. Further the bond area that planes cut. A bond
    with damage kappa has dissipated kappa G_f A in tension, up to twice that in slip: this is why the parts do not add up to the whole."""
    x, d = run.results("particles/position"), run.results("particles/displacement")
    i, j, area, state = (run.results(f"bonds/{name}") for name in ("i", "j", "area", "state"))
    damage = np.where((state == 1) | (state == 2), 1.0, run.results("bonds/shear_damage"))
    lost = sum(run.results(f"energy/{term}")[0] for term in ("damage", "bond_breaking")) / (FRACTURE * section)
    apart = np.linalg.norm(d[j] - d[i], axis=1) > OPENED
    crack = np.sum((area * damage)[apart]) / section
    cut = np.sum(area * np.abs(((x - d)[j] - (x - d)[i])[:, axis])) / (section * length)
    return lost, crack, lost - crack, cut


def energy_row(dimension, count, scale):
    found, radii = [], []
    for seed in SEEDS:
        scene, section, length = strip(dimension, count, seed, scale)
        run = made(f"energy-{dimension}-{count}-{scale}-{seed}", scene)
        found.append(parts_of_energy(run, dimension - 1, section, length))
        radii.append(np.mean(run.results("particles/radius")) * 1e3)
    lost, crack, rest, cut = np.array(found).T
    print(dimension, count, scale, found, file=sys.stderr, flush=True)
    return [f"{dimension}D", count, f"{np.mean(radii):.3f}", f"{scale * LENGTH * TENSILE**2 / (YOUNG * FRACTURE):.2g}", mean_text(lost),
            mean_text(crack), mean_text(rest), f"{np.mean(cut):.3f}", mean_text(crack / cut)], crack


def energy_tables():
    heads = ["", "particles", "mean radius mm", "length over E G_f/sigma^2", "dissipated over G_f times section", "across the crack",
             "beside it", "cut by a plane", "across the crack over that"]
    rows = []
    for dimension, count in ((2, 900), (3, 1000)):
        first = None
        for scale in (1.0, 0.5, 0.25):
            row, crack = energy_row(dimension, count, scale)
            first = crack if first is None else first
            rows.append([*row, "1" if first is crack else mean_text(crack / first)])
    study.put("law-table.md", "table energy", study.table([*heads, "of the same packing, over that of the largest"], rows))
    rows = [energy_row(dimension, count, 0.25)[0] for dimension, counts in ((2, (450, 900, 1800)), (3, (500, 1000, 2000))) for count in counts]
    study.put("law-table.md", "table finer", study.table(heads, rows))


def parted(dimension, count, seed, scale):
    """The strip in two parts whose bonds hold, joined halfway by the bonds of the strip above: one crack at a given
    place."""
    scene, section, length = strip(dimension, count, seed, scale)
    weak, far = scene["materials"][0], 10.0
    strong = {**weak, "tensile_strength": 100 * TENSILE, "shear_strength": 100 * TENSILE, "fracture_energy": 1e4 * FRACTURE,
              "shear_fracture_energy": 1e4 * FRACTURE}
    between = {key: weak[key] for key in ("tensile_strength", "shear_strength", "fracture_energy", "shear_fracture_energy")}
    scene["materials"] = [strong, {**strong, "name": "n"}]
    scene["specimen"]["material"] = "m"
    scene["contacts"] = [{"between": ["m", "n"], **between}]
    low = [-far] * (dimension - 1) + [0.5 * length]
    scene["sets"].append({"name": "above", "select": {"box": {"min": low, "max": [far] * dimension}}, "material": "n"})
    return scene, section, length


def plane_row(dimension, count, scale):
    """Dissipated energy relative to G_f and the section, to G_f and the area of cut bonds, and the part outside the
    plane."""
    found, radii = [], []
    for seed in SEEDS:
        scene, section, length = parted(dimension, count, seed, scale)
        run = made(f"plane-{dimension}-{count}-{scale}-{seed}", scene)
        x = (run.results("particles/position") - run.results("particles/displacement"))[:, dimension - 1] > 0.5 * length
        i, j, area, state = (run.results(f"bonds/{name}") for name in ("i", "j", "area", "state"))
        crosses = x[i] != x[j]
        cut, elsewhere = np.sum(area[crosses]) / section, np.count_nonzero(state[~crosses])
        open_share = np.sum(area[crosses & ((state == 1) | (state == 2))]) / section / cut
        lost = parts_of_energy(run, dimension - 1, section, length)[0]
        found.append((lost, cut, lost / cut, open_share, elsewhere))
        radii.append(np.mean(run.results("particles/radius")) * 1e3)
    lost, cut, share, broken, elsewhere = np.array(found).T
    print(dimension, count, scale, found, file=sys.stderr, flush=True)
    return [f"{dimension}D", count, f"{np.mean(radii):.3f}", mean_text(lost), mean_text(cut), mean_text(share, 4), f"{broken.min():.3f}",
            int(elsewhere.sum())]


def plane_table():
    heads = ["", "particles", "mean radius mm", "dissipated over G_f times section", "bond area cut over section", "dissipated over G_f times that",
             "broken of it, least", "bonds damaged elsewhere"]
    for name, strips in (("plane", [(d, n, scale) for d, n in ((2, 900), (3, 1000)) for scale in (1.0, 0.5, 0.25)]),
                         ("plane finer", [(d, n, 0.25) for d, some in ((2, (450, 900, 1800)), (3, (500, 1000, 2000))) for n in some])):
        study.put("law-table.md", f"table {name}", study.table(heads, [plane_row(*one) for one in strips]))


if __name__ == "__main__":
    asked = [a for a in sys.argv[1:] if not a.startswith("-")]
    if not asked or "laws" in asked:
        laws_table()
    if not asked or "count" in asked:
        finer_table()
    if not asked or "energy" in asked:
        energy_tables()
    if not asked or "plane" in asked:
        plane_table()
