"""Concrete under compression with pressure around it (Santasusana 2013, ch. 5 and 7, after Sfer et al. 2002): bonds by area that soften and yield,
cylinders of 1 500 and 13 500 spheres. Fills the parts on concrete of docs/evidence/laboratory.md and its pictures. For the effects of number of
particles, speed and step see concrete_effects.py.

    /usr/bin/python3 validate/concrete_study.py [--fresh] [--kept] [--quick] [curves] [large] [choices] [hydrostatic] [oedometer]

Ten minutes of one core, without `large` (two more packings of 13 500 spheres), which takes as much and is made when it is named.
--kept: tables of the runs that are there; --quick: no more than 1 500 spheres, two minutes, and prints what it would have written. Runs stay in
runs/studies/concrete.
"""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import study

QUICK = "--quick" in sys.argv
FOLDER = study.RUNS / "concrete"
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
PAGE = "laboratory.md"
DIAMETER, HEIGHT = 0.15, 0.3  # m
SECTION = np.pi * DIAMETER**2 / 4  # m2
CYLINDER_STRENGTH = 32.8  # strength in the laboratory after 28 days, MPa
YOUNG, POISSON, TENSILE, SHEAR = 27e9, 0.2, 3.2e6, 15e6
YIELD = ((15e6, 3.0), (25e6, 7.0), (30e6, 15.0))  # Stress of a bond in Pa, ratio of slopes beyond it.
CONCRETE = {"name": "concrete", "density": 2500, "young": YOUNG, "poisson": POISSON, "friction": 0.2, "bond_friction": 0.9,
            "tensile_strength": TENSILE, "shear_strength": SHEAR, "fracture_ratio": 0.1,
            **{f"yield_stress_{k + 1}": stress for k, (stress, _) in enumerate(YIELD)},
            **{f"yield_ratio_{k + 1}": ratio for k, (_, ratio) in enumerate(YIELD)}}
LAW = {"stiffness": "dempack", "gamma": 0.8, "softening": "ratio"}
OVERLAP = 0.025  # brings 13 500 spheres to the porosity of the source, 25.7 %, and to 9.6 bonds each
RAMP = 1e-3  # s, duration of the pressure ramp: eleven wave transits of the cylinder.
# Pressure in MPa: strain to which it is loaded, closing speed in m/s.
TESTS = {0: (0.006, 0.05), 1.5: (0.006, 0.1), 4.5: (0.009, 0.1), 9: (0.012, 0.2), 30: (0.02, 0.2), 60: (0.025, 0.2)}
MANY = {9: (0.006, 0.2), 30: (0.0105, 0.4), 60: (0.0105, 0.4)}  # strains and speeds for many spheres, chosen by their cost
LARGE = 1500 if QUICK else 13500
LARGE_TESTS = tuple(TESTS)
MOST = 71852
LONG = ("large",)  # Computed only if requested by name.
MIDDLE = 500 if QUICK else 1500
LOAD_ROWS = 3000  # the start of loading, which is nonlinear from 9 MPa on, then has enough rows; the largest number of spheres is read at its peak only
SEEDS = (1, 2, 3)
RAISED, RAISED_FROM = 2.0, 4000  # Factor of time.mass_scaling with this number of spheres or more: half the number of steps.
COLOURS = {0: "#22303c", 1.5: "#2b6cb0", 4.5: "#2a9d8f", 9: "#6a994e", 30: "#e09f3e", 60: "#c8402f"}


# --- scenes -----------------------------------------------------------------------------------------------------

def mean_radius(count):
    return (0.75 / np.pi * 0.72 * SECTION * HEIGHT / count) ** (1 / 3)


def body(count, seed, material=None, law=None):
    return {
        "dimension": 3, "specimen": {"cylinder": {"diameter": DIAMETER, "height": HEIGHT}, "particles": count,
                                     "packing": {"size_ratio": 3, "overlap": "passive", "overlap_size": OVERLAP}},
        "materials": [{**CONCRETE, **(material or {})}], "law": {**LAW, **(law or {})}, "bonds": {},
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.2}, "contact": {"fraction": 0.9}},
        "output": {"history_rows": 600, "snapshots": 0, "checkpoint": "off"}, "run": {"seed": seed, "threads": 1}}


def brittle():
    """The material without softening and yield."""
    return {key: value for key, value in CONCRETE.items() if not key.startswith(("yield", "fracture"))}


def end_sets(count, speed=None):
    """The particles at both ends; with a speed they close, held across, as the platens of the source hold them."""
    made = []
    for name, side, sign in (("bottom", "lower", 1), ("top", "upper", -1)):
        end = {"name": name, "select": {"end": {"axis": "z", "side": side, "depth": 0.5 * mean_radius(count), "by": "surface"}}}
        if speed:
            end["motion"] = closing(sign * speed)
        made.append(end)
    return made


def closing(speed):
    """Both ends together close with |speed|, after 0.2 ms."""
    return {"vx": 0, "vy": 0, "vz": [[0, 0], [2e-4, 0.5 * speed]]}


def compression(count, seed, pressure, speed=None, strain=None, drop=0.6, **change):
    """Pressure from 0 to `pressure` (MPa), rest until the mean resultant is a thousandth of the contact forces, then the ends close."""
    usual = {**TESTS, **MANY}[pressure] if count >= RAISED_FROM else TESTS[pressure]
    strain, speed = strain or usual[0], speed or usual[1]
    scene, time = body(count, seed, **change), 1.5 * strain * HEIGHT / speed
    ends = {"axis": "z", "lower": "bottom", "upper": "top", "length": HEIGHT, "diameter": DIAMETER}
    if not pressure:
        return {**scene, "sets": end_sets(count, speed), "test": {"kind": "compression", **ends},
                "time": {"end": time, "stop": {"strain": strain, "peak_drop": drop}}}
    load = {"bottom": {"motion": closing(speed)}, "top": {"motion": closing(-speed)}}
    return {**scene, "sets": end_sets(count), "test": {"kind": "triaxial", **ends},
            "membrane": {"pressure": pressure * 1e6, "ramp": RAMP}, "time": {"end": time + 6e-3},
            "stages": [{"name": "ramp", "end": {"time": RAMP}, "output": {"history_rows": 50}},
                       {"name": "rest", "end": {"unbalanced": 1e-3, "time": 4e-3}, "output": {"history_rows": 200}},
                       {"name": "load", "sets": load, "end": {"strain": strain, "peak_drop": drop, "time": time},
                        **({} if count > LARGE else {"output": {"history_rows": LOAD_ROWS}})}]}


def made(name, scene, settings=None):
    if scene["specimen"]["particles"] >= RAISED_FROM:
        scene["time"]["mass_scaling"] = {"factor": RAISED}
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.yaml"
    path.write_text(json.dumps(scene, indent=1))
    return study.run(f"concrete/{name}", path, {"run.threads": 1, **(settings or {})})


def tested(count, seed, pressure, label="", settings=None, **change):
    return Curve(made(f"{count}-{seed}-{pressure:g}{label}", compression(count, seed, pressure, **change), settings), pressure)


class Curve:
    """The readings while the ends closed; strains from the start of that, compression positive, stresses in MPa."""

    def __init__(self, run, pressure):
        self.run, self.pressure = run, pressure
        rows = slice(None)
        if pressure:
            rows = run.results("history/stage") == 2
        self.stress = run.results("history/stress")[rows] / 1e6
        self.stress[0] = 0.0  # Under pressure the first row contains the force that stops the ends, which were still moving slightly.
        self.axial = self.since_start(run.results("history/strain")[rows])
        across = [run.results(f"history/strain_{d}")[rows] for d in ("xx", "yy")]
        self.lateral = self.since_start(-0.5 * (across[0] + across[1]))
        self.volumetric = self.since_start(-sum(run.results(f"history/strain_{d}")[rows] for d in ("xx", "yy", "zz")))
        self.broken = run.results("history/broken_tension")[rows] + run.results("history/broken_shear")[rows]
        self.row = int(np.argmax(self.stress))
        self.peak, self.peak_strain = self.stress[self.row], self.axial[self.row]

    @staticmethod
    def since_start(values):
        return values - values[0]

    def left(self, further):
        """Share of the peak that remains at a strain larger by `further`. For runs that ended earlier: at their end
        if the stress had fallen, otherwise none."""
        beyond = self.axial >= self.peak_strain + further
        if beyond.any():
            return self.stress[np.argmax(beyond)] / self.peak
        return self.stress[-1] / self.peak if self.stress[-1] < 0.6 * self.peak else float("nan")

    @property
    def modulus(self):
        """GPa, of the deviator over the strain of the ends, 5 to 20 % of the peak."""
        used = self.rising(0.05, 0.2)
        return np.polyfit(self.axial[used], self.stress[used], 1)[0] / 1e3

    @property
    def ratio(self):
        used = self.rising(0.05, 0.2)
        return -np.polyfit(self.axial[used], self.lateral[used], 1)[0]

    def at(self, strain):
        """Deviator at a strain that was reached, MPa."""
        return float(np.interp(strain, self.axial, self.stress)) if self.axial[-1] >= strain else float("nan")

    @property
    def fell(self):
        """True if the largest deviator was a peak, and not where the run ended or shortly before."""
        return self.stress[-1] < 0.95 * self.peak

    def rising(self, low, high):
        return (np.arange(len(self.stress)) < self.row) & (self.stress > low * self.peak) & (self.stress < high * self.peak)


def start_of_uniform_strain(pressure, fill):
    """Ratio of slopes of bonds, E (GPa) and nu at the start of loading: the bonds carry pressure/fill, and all of
    them continue along their branch."""
    branch = sum(pressure * 1e6 / fill > limit for limit, _ in YIELD)
    slope = 1.0 if branch == 0 else 1 / YIELD[branch - 1][1]
    rho = 1 / (2 * (1 + POISSON)) / slope
    return slope, slope * fill * YOUNG / 1e9 * (2 + 3 * rho) / (4 + rho), (1 - rho) / (4 + rho)


def richart(pressure):
    """Axial stress at failure minus the pressure, MPa: f_c + 4.1 P (Richart et al. 1928), valid for low pressures."""
    return CYLINDER_STRENGTH + 3.1 * pressure


def spread(values, digits=3):
    values = np.asarray(values, float)
    text = f"{np.mean(values):.{digits}g}"
    return text if len(values) < 2 else f"{text} ({np.min(values):.{digits}g} to {np.max(values):.{digits}g})"


def share(value):
    return "" if np.isnan(value) else f"{value:.2f}"


def put(name, head, rows):
    study.put_table(PAGE, name, head, rows, QUICK)


def save(figure, name):
    study.save(figure, FOLDER if QUICK else PICTURES, name)


# --- curves and peaks -------------------------------------------------------------------------------------------

def draw_curves(axes, curves, title):
    for pressure, curve in curves.items():
        colour, label = COLOURS[pressure], f"{pressure:g} MPa" if pressure else "none"
        axes.plot(100 * curve.axial, curve.stress, color=colour, label=label)
        axes.plot(100 * curve.lateral, curve.stress, color=colour, lw=1)
        if curve.fell:
            axes.plot(100 * curve.peak_strain, curve.peak, "o", color=colour, ms=4)
    axes.axvline(0, color="#9aa5ad", lw=0.8)
    axes.set(xlabel="lateral (thin) and axial strain since the start of loading, %", ylabel="deviator, MPa", title=title, ylim=(0, None))
    axes.legend(title="pressure around", loc="lower right")


def envelope_picture(groups):
    figure, axes = plt.subplots(figsize=(7, 5))
    pressure = np.linspace(0, CYLINDER_STRENGTH, 10)  # the line is valid for pressures below f_c
    axes.plot(pressure, richart(pressure), color="#9aa5ad", ls="--", label="Richart: 32.8 MPa + 4.1 P, less P")
    axes.plot(0, CYLINDER_STRENGTH, "*", color="#22303c", ms=13, label="measured f_c (Sfer et al. 2002)")
    for (count, seeds), marker in zip(groups.items(), "so^"):
        for number, curves in enumerate(seeds):
            axes.plot(list(curves), [c.peak for c in curves.values()], marker, color="#c8402f", mfc="none" if number else "#c8402f",
                      ls="-" if not number else "", lw=1, label=f"{count} spheres" if not number else None)
    axes.set(xlabel="pressure around, MPa", ylabel="largest deviator, MPa", title="Largest deviator (at 30 and 60 MPa at the end of the runs: it rises)", ylim=(0, None))
    axes.legend()
    save(figure, "concrete-envelope")


def large_cells(curve):
    if curve is None:
        return [""] * 5
    if not curve.fell:
        return ["rises"] + [""] * 4
    return [f"{curve.peak:.1f}", f"{100 * curve.peak_strain:.2f}", f"{100 * curve.lateral[curve.row]:.3f}", share(curve.left(0.002)), share(curve.left(0.005))]


def curves_part():
    large = {p: tested(LARGE, 1, p) for p in LARGE_TESTS}
    others = [{p: tested(MIDDLE, seed, p) for p in TESTS} for seed in SEEDS]
    figure, axes = plt.subplots(1, 2, figsize=(13, 5.5))
    draw_curves(axes[0], large, f"{LARGE} spheres")
    draw_curves(axes[1], others[0], f"{MIDDLE} spheres, packing 1")
    save(figure, "concrete-curves")
    envelope_picture({LARGE: [large], MIDDLE: others})
    rows = []
    for p in TESTS:
        three = [curves[p] for curves in others]
        fell = all(c.fell for c in three)
        rows.append([f"{p:g}", f"{richart(p):.1f}" if p <= 9 else "", *large_cells(large.get(p)), spread([c.peak for c in three]) if fell else "rises",
                     spread([100 * c.peak_strain for c in three], 2) if fell else "", share(np.mean([c.left(0.002) for c in three])),
                     share(np.mean([c.left(0.005) for c in three])),
                     "" if fell else (f"{large[p].at(0.01):.1f}; " if p in large else "") + spread([c.at(0.01) for c in three]),
                     "" if fell else spread([c.stress[-1] for c in three])])
    put("table peaks", ["pressure MPa", "Richart", f"deviator {LARGE}", "strain there %", "lateral %", "left 0.2 % later", "0.5 % later",
                        f"deviator {MIDDLE}, three packings", "strain there %", "left 0.2 % later", "0.5 % later", f"at 1 % of strain: {LARGE}; {MIDDLE}",
                        f"{MIDDLE} at the end (2 and 2.5 %)"], rows)
    rows = []
    for name, curves in ((f"{LARGE}", large), *((f"{MIDDLE}, packing {k + 1}", c) for k, c in enumerate(others))):
        free, low = curves[0], [p for p in TESTS if p <= 9]
        slope = np.polyfit(low, [curves[p].peak + p for p in low], 1)[0]
        counts = free.run.summary["counts"]
        rows.append([name, f"{2 * free.run.bonds / counts['particles']:.2f}", f"{free.modulus:.1f}", f"{free.run.young_modulus_average / 1e9:.1f}",
                     f"{free.ratio:.3f}", f"{free.peak:.1f}", f"{slope:.2f}",
                     f"{max(abs(c.run.residual) for c in curves.values()):.0e}",
                     f"{sum(c.run.summary['steps'] for c in curves.values()) / 1e3:.0f}", f"{sum(c.run.summary['seconds']['cpu'] for c in curves.values()):.0f}"])
    put_starts(large, others)
    put("table specimens", ["spheres", "n_c", "E of the ends GPa", "E average GPa", "nu", "UCS MPa", "axial stress over pressure, 0 to 9 MPa",
                            "largest residual", "thousand steps", "CPU s"], rows)


def put_starts(large, others):
    """E and nu with which the ends begin to close, beside uniform strain of the larger packing where it was tested."""
    rows = []
    for p in TESTS:
        three = [curves[p] for curves in others]
        of_large, of_middle = (start_of_uniform_strain(p, filled(run)) for run in (large[p].run if p in large else large[0].run, three[0].run))
        slope = of_middle[0]
        rows.append([f"{p:g}", f"1/{1 / slope:.0f}" if slope < 1 else "1", f"{of_large[1]:.1f}" if p in large else "", f"{large[p].modulus:.1f}" if p in large else "",
                     f"{of_middle[1]:.1f}", spread([c.modulus for c in three]),
                     f"{of_middle[2]:.3f}", f"{large[p].ratio:.3f}" if p in large else "", spread([c.ratio for c in three], 2)])
    put("table starts", ["pressure MPa", "slope of bonds over E", f"E GPa {LARGE}, uniform strain", "found", f"{MIDDLE}, uniform strain", "found, three packings",
                         "nu, uniform strain", f"{LARGE}", f"{MIDDLE}, three packings"], rows)


# --- the larger packings ------------------------------------------------------------------------------------------

def large_part():
    """Three packings of the larger number of spheres at all pressures."""
    rows, missing = [], []
    for p in TESTS:
        found = {seed: study.if_there(tested, LARGE, seed, p) for seed in SEEDS}
        missing += [f"{p:g} MPa, packing {seed}" for seed, curve in found.items() if curve is None]
        there = [curve for curve in found.values() if curve]
        if not there:
            continue
        fell = all(c.fell for c in there)
        rows.append([f"{p:g}", f"{richart(p):.1f}" if p <= 9 else "", len(there), spread([c.peak for c in there]) if fell else "rises",
                     spread([100 * c.peak_strain for c in there], 2) if fell else "", spread([c.modulus for c in there]), spread([c.ratio for c in there], 2),
                     share(np.mean([c.left(0.002) for c in there])), "" if fell else spread([c.at(0.01) for c in there])])
    study.put_table(PAGE, "table large", ["pressure MPa", "Richart", f"packings of {LARGE}", "deviator", "strain there %", "E of the ends GPa", "nu", "left 0.2 % later",
                                          "at 1 % of strain"], rows, QUICK, missing)


# --- choices that the source does not state ---------------------------------------------------------------------

def choices_part():
    count = 500 if QUICK else 1500
    text = {"friction": 0.9}
    cases = (("as above", {}), ("friction of what has broken 0.9, as the text says", {"material": text}),
             ("mean stress around bonds", {"law": {"confinement": "mean"}}), ("tension takes from shear by squares", {"law": {"coupling": "quadratic"}}),
             ("gamma such that sections fill the body", {"law": {"gamma": "auto"}}))
    rows = []
    for number, (name, change) in enumerate(cases):
        curves = [tested(count, 1, p, f"-choice{number}" if number else "", **change) for p in (0, 9, 60)]
        rows.append([name, f"{curves[0].run.young_modulus_average / 1e9:.1f}", *(f"{c.peak:.1f}" for c in curves[:2]), f"{curves[2].at(0.01):.1f}",
                     *(share(c.left(0.002)) for c in curves[:2])])
    put("table choices", [f"{count} spheres", "E average GPa", "largest deviator, 0 MPa", "9 MPa", "at 1 % of strain, 60 MPa",
                          "left 0.2 % after the peak, 0 MPa", "9 MPa"], rows)


def kept_there(count, pressures, seeds=(1,)):
    """True if these runs were made before."""
    return all((FOLDER / f"{count}-{seed}-{pressure:g}" / "study.json").exists() for pressure in pressures for seed in seeds)


# --- hydrostatic and oedometric states --------------------------------------------------------------------------

def bond_stress(strain):
    """Stress of a bond along the path of largest compression, Pa, strain compression positive."""
    stress, slope, kink = np.zeros_like(strain), YOUNG, 0.0
    result, left = stress, np.array(strain, float)
    for limit, ratio in YIELD:
        part = np.clip(left, 0, (limit - kink) / slope)
        result, left = result + slope * part, left - part
        slope, kink = YOUNG / ratio, limit
    return result + slope * np.clip(left, 0, None)


def filled(run):
    """Sum of the sections times lengths of bonds over dim V."""
    x, d = run.results("particles/position"), run.results("particles/displacement")
    i, j = run.results("bonds/i"), run.results("bonds/j")
    length = np.linalg.norm((x - d)[j] - (x - d)[i], axis=1)
    import h5py

    with h5py.File(run.folder / "results.h5", "r") as file:
        volume = float(file.attrs["volume"])
    return float(np.sum(run.results("bonds/area") * length) / (3 * volume))


def hydrostatic_part():
    rows, curves = [], {}
    cases = (("own", 30, {}), ("mean", 30, {"confinement": "mean"}), ("own, no yield", 30, {}), ("own", 60, {}))
    for name, pressure, law in cases:
        scene = body(MIDDLE, 1, law=law)
        if "no yield" in name:
            scene["materials"] = [{**brittle(), "fracture_ratio": 0.1}]
        scene.update({"membrane": {"pressure": pressure * 1e6, "ramp": 4e-3}, "test": {"kind": "hydrostatic"}, "time": {"end": 5e-3}})
        label = name.replace(", ", "-").replace(" ", "-")
        run = made(f"hydrostatic-{MIDDLE}-{label}-{pressure}", scene)
        criterion = run.results("bonds/criterion")
        state = run.results("bonds/state")
        criterion = criterion[(state != 1) & (state != 2)]
        strain, stress = run.results("history/strain"), run.results("history/stress")
        start = (stress > 2e6) & (stress < 10e6)
        rows.append([name, pressure, f"{np.polyfit(strain[start], stress[start], 1)[0] / 1e9:.2f}", f"{filled(run) * YOUNG / 3e9:.2f}",
                     *(f"{np.quantile(criterion, q):.3f}" for q in (0.5, 0.9, 0.99)), f"{criterion.max():.2f}",
                     f"{sum(run.broken)} of {run.bonds}", f"{np.std(run.results('bonds/contact_stress')) / abs(np.mean(run.results('bonds/contact_stress'))):.2f}"])
        curves[name, pressure] = run
    put("table hydrostatic", ["confinement", "pressure MPa", "K GPa, 2 to 10 MPa", "of uniform strain", "criterion, median", "90 %", "99 %", "largest of whole bonds",
                              "broken", "scatter of bond stresses"], rows)
    return curves


def oedometer_scene():
    side, walls = 0.1, []
    for axis in "xyz":
        for end in (0, 1):
            at, point, normal = "xyz".index(axis), [0, 0, 0], [0, 0, 0]
            point[at], normal[at] = side * end, 1 - 2 * end
            wall = {"name": f"{axis}{end}", "point": point, "normal": normal, "stiffness": 1e9, "passive": True}
            if axis == "z":
                wall["motion"] = {"vz": [[0, 0], [2e-4, 0.1 * (1 - 2 * end)]]}
            walls.append(wall)
    scene = body(MIDDLE, 1)
    scene["specimen"] = {**scene["specimen"], "box": {"size": [side] * 3}}
    del scene["specimen"]["cylinder"]
    return {**scene, "walls": walls, "test": {"kind": "oedometer", "axis": "z", "lower": "z0", "upper": "z1", "length": side, "area": side**2},
            "time": {"end": 0.02 * side / 0.2, "stop": {"strain": 0.015}}}


def uniform_oedometer(strain, fill, elastic=False):
    """Axial and lateral stress (Pa) of bonds in all directions alike that follow an axial strain; shear elastic up to tau + mu N."""
    z = (np.arange(400) + 0.5) / 400  # cosine to the axis: alike on the sphere
    axial, lateral = [], []
    rho = 1 / (2 * (1 + POISSON))
    for value in strain:
        normal = YOUNG * value * z**2 if elastic else bond_stress(value * z**2)
        shear = np.minimum(rho * YOUNG * value * z * np.sqrt(1 - z**2), np.inf if elastic else SHEAR + CONCRETE["bond_friction"] * normal)
        axial.append(3 * fill * np.mean(normal * z**2 + shear * z * np.sqrt(1 - z**2)))
        lateral.append(3 * fill * np.mean(0.5 * normal * (1 - z**2) - 0.5 * shear * z * np.sqrt(1 - z**2)))
    return np.array(axial), np.array(lateral)


def oedometer_part(hydrostatic):
    run = made(f"oedometer-{MIDDLE}", oedometer_scene())
    strain = -run.results("history/strain_zz")
    axial = -run.results("history/stress_zz") / 1e6
    across = -0.5 * (run.results("history/stress_xx") + run.results("history/stress_yy")) / 1e6
    theory = np.linspace(0, strain.max(), 60)
    fill = filled(run)
    upper, side = uniform_oedometer(theory, fill)
    rows = []
    for value in (0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01):
        if value > strain.max():
            continue
        measured = [np.interp(value, strain, column) for column in (axial, across)]
        predicted = [float(part[0]) / 1e6 for part in uniform_oedometer([value], fill)]
        rows.append([f"{100 * value:g}", f"{measured[0]:.1f}", f"{predicted[0]:.1f}", f"{measured[1]:.1f}", f"{predicted[1]:.1f}",
                     f"{measured[1] / measured[0]:.3f}", f"{predicted[1] / predicted[0]:.3f}"])
    put("table oedometer", ["axial strain %", "axial stress MPa", "of uniform strain", "lateral MPa", "of uniform strain", "lateral over axial", "of uniform strain"], rows)
    figure, axes = plt.subplots(1, 2, figsize=(12, 5))
    for (name, pressure), colour in ((("own", 60), "#c8402f"), (("own, no yield", 30), "#2b6cb0")):
        found = hydrostatic[name, pressure]
        label = "bonds that yield" if pressure == 60 else "without yield"
        volume = found.results("history/strain")
        axes[0].plot(100 * volume, found.results("history/stress") / 1e6, color=colour, label=label)
        line = np.linspace(0, volume.max(), 100)
        stress = filled(found) * (bond_stress(line / 3) if pressure == 60 else YOUNG * line / 3)
        axes[0].plot(100 * line, stress / 1e6, color=colour, ls="--", lw=1, label="the same, uniform strain")
    axes[0].set(xlabel="volume lost, %", ylabel="pressure, MPa", title="Hydrostatic", ylim=(0, None))
    axes[0].legend()
    axes[1].plot(100 * strain, axial, color="#c8402f", label="axial stress")
    axes[1].plot(100 * strain, across, color="#2b6cb0", label="lateral stress")
    axes[1].plot(100 * theory, upper / 1e6, color="#c8402f", ls="--", lw=1, label="uniform strain")
    axes[1].plot(100 * theory, side / 1e6, color="#2b6cb0", ls="--", lw=1)
    axes[1].set(xlabel="axial strain, %", ylabel="MPa", title="Oedometric", ylim=(0, None))
    axes[1].legend()
    save(figure, "concrete-states")


def main():
    known = ("curves", "large", "choices", "hydrostatic", "oedometer")
    asked = [a for a in sys.argv[1:] if not a.startswith("-")]
    if set(asked) - set(known):
        sys.exit(f"concrete_study: expected some of {', '.join(known)}, found {' '.join(asked)}")
    simple = {"curves": curves_part, "large": large_part, "choices": choices_part}
    for name in asked or [name for name in known if name not in LONG]:
        if name in simple:
            simple[name]()
    if not asked or {"hydrostatic", "oedometer"} & set(asked):
        oedometer_part(hydrostatic_part())


if __name__ == "__main__":
    main()
