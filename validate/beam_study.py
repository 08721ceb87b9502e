"""A measured beam: Gregoire et al. 2013, depth 50 mm, notched to half of it. The measured properties of its concrete are reproduced before a beam is
computed, by strips of the same packings that are pulled apart; nothing is fitted to the beam. Fills docs/evidence/beams.md; some half an hour of one
core.

    /usr/bin/python3 validate/beam_study.py [--fresh] [linear] [bilinear]

Without a word: both; bilinear: the tables of bonds that soften along two lines alone.
"""
import sys

import numpy as np

import meshes
import study

BAND = study.ROOT / "validate" / "references" / "beam-gregoire-2013.csv"
PICTURE = study.ROOT / "docs" / "evidence" / "pictures" / "beams-gregoire.png"
FOLDER = study.RUNS / "beams"
SEEDS = (1, 2, 3)
RADII = (0.5e-3, 0.25e-3)
COUNT = {RADII[0]: 3, RADII[1]: 2}  # Packings; one with the smaller particles takes some minutes.
# Measured properties of the concrete (37 GPa, 3.9 MPa, 143.2 N/m, 2346 kg/m3) and of the beam, m.
MODULUS, POISSON, TENSILE, FRACTURE, DENSITY = 37e9, 0.2, 3.9e6, 143.2, 2346.0
LENGTH, DEPTH, BREADTH, SPAN, NOTCH, SLOT, GAUGE = 0.175, 0.05, 0.05, 0.125, 0.025, 0.002, 0.020
# Assumed, not measured: strength in shear over that in tension of a contact, energy in shear over that in tension, friction of bonds, by which compressed bonds carry more shear.
SHEAR, SHEAR_ENERGY, FRICTION = 1.0, 1.0, 1.0
INITIAL = 2.5  # fracture energy over the area under the first tangent of the softening (Bazant and Becq-Giraudon 2002)
MIDDLE, WIDTH, SIDE = 0.5 * LENGTH, 0.008, 0.0025  # m: mid-span, zone, cells of the mesh
FREE = 0.0125                                      # m, half the length of the region of particles only.
SPEED = 0.01                                       # m/s of the load


def material(contact):
    """`contact`: young, Pa, poisson, tensile strength, Pa, fracture energy, J/m2, of contacts."""
    young, poisson, tensile, energy = contact[:4]
    return {"name": "concrete", "density": DENSITY, "young": young, "poisson": poisson, "friction": 0.5, "tensile_strength": tensile,
            "shear_strength": SHEAR * tensile, "fracture_energy": energy, "shear_fracture_energy": SHEAR_ENERGY * energy,
            "bond_friction": FRICTION}


def made(name, scene, settings=None):
    """`scene`: as a dictionary, which YAML reads as JSON has it."""
    import json

    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.yaml"
    path.write_text(json.dumps(scene, indent=1))
    return study.run(f"beams/{name}", path, settings or {}, must_finish=False)


def body(shape, radius, seed, contact):
    """`contact`: see material(); a fifth value names the softening curve of bonds."""
    curve = {"softening_curve": contact[4]} if len(contact) > 4 else {}
    return {"dimension": 2,
            "specimen": {**shape, "mean_radius": radius, "density_basis": "bulk", "material": "concrete", "group": 1,
                         "packing": {"overlap": "passive", "size_variation": 0.1}},
            "materials": [material(contact)], "law": {"stiffness": "dempack", "softening": "energy", "coupling": "quadratic", **curve},
            "bonds": {"interaction_range": 0.1, "passive_gaps": True}, "run": {"seed": seed, "threads": 1}}


# --- properties of packings -------------------------------------------------------------------------------------

STRIP = (0.025, 0.0375)  # m, the first as wide as the ligament


def strip(radius, seed, contact, opened=None):
    """A strip that is pulled apart until its load has fallen by half, with grips that are free laterally; or until it has opened by `opened` m, with
    grips that are held laterally, because otherwise the middle rotates and a second crack opens."""
    width, length = STRIP
    motion = {side: {**({"vx": 0} if opened else {}), "vy": [[0, 0], [5e-4, sign * 0.02]]} for side, sign in (("lower", -1), ("upper", 1))}
    scene = {**body({"rectangle": {"width": width, "height": length}}, radius, seed, contact),
             "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.5}},
             "sets": [{"name": side, "select": {"end": {"axis": "y", "side": side, "depth": 4 * radius}}, "motion": motion[side]} for side in motion],
             "test": {"kind": "tension", "axis": "y", "lower": "lower", "upper": "upper", "length": length, "area": width},
             "time": {"end": opened / 0.04 if opened else 3e-3, "stop": "none" if opened else {"peak_drop": 0.3}}}
    name = f"strip-{1e3 * radius:g}-{seed}-" + "-".join(v if isinstance(v, str) else f"{v:.4g}" for v in contact) + ("-apart" if opened else "")
    return made(name, scene, {"output.history_rows": 600, "run.residual_limit": "off"})


def elastic(run):
    """Modulus (Pa) and Poisson's ratio in the plane, from the mean strain, from 5 to 30 % of the peak; strength (Pa)."""
    stress, along, across = (run.results(f"history/{name}") for name in ("stress", "strain_yy", "strain_xx"))
    peak = int(np.argmax(stress))
    part = (np.arange(len(stress)) < peak) & (stress > 0.05 * stress[peak]) & (stress < 0.3 * stress[peak])
    return np.polyfit(along[part], stress[part], 1)[0], -np.polyfit(along[part], across[part], 1)[0], stress[peak]


def crack_energy(run, contact):
    """Energies relative to the fracture energy of the contacts times the section: the whole dissipated energy, and that of bonds whose ends have
    separated."""
    x, d = run.results("particles/position"), run.results("particles/displacement")
    i, j, area, state = (run.results(f"bonds/{name}") for name in ("i", "j", "area", "state"))
    damage = np.where((state == 1) | (state == 2), 1.0, run.results("bonds/shear_damage"))
    if len(contact) > 4:  # dissipated energy: 0.6 of the strength's share that is lost along the first line, 1.8 along the second; for one line both are equal
        damage = np.where(damage < 2 / 3, 0.6 * damage, 0.4 + 1.8 * (damage - 2 / 3))
    apart = np.linalg.norm(d[j] - d[i], axis=1) > contact[3] / contact[2]
    lost = sum(run.results(f"energy/{term}")[0] for term in ("damage", "bond_breaking"))
    return lost / (contact[3] * STRIP[0]), np.sum((area * damage)[apart]) / STRIP[0]


def calibrate(*curve, radius=RADII[0], start=None, rounds=3):
    """Finds contact parameters for which strips have the measured modulus, strength and, across their cracks,
    fracture energy, and elements with the modulus and Poisson's ratio of the strips. All rounds but the last
    correct them; the last one shows the agreement. `start`: parameters of the first round."""
    contact, rows = start or (MODULUS / 0.75, 0.2, TENSILE, FRACTURE / 1.38, *curve), []
    seeds = SEEDS[:COUNT[radius]]
    for number in range(rounds):
        found = np.array([elastic(strip(radius, seed, contact)) for seed in seeds])
        opened = (7.2 if curve else 4) * 2 * contact[3] / contact[2]  # Twice, if nothing is left.
        lost = np.array([crack_energy(strip(radius, seed, contact, opened), contact) for seed in seeds])
        modulus, contraction, strength = found.mean(axis=0)
        factor = lost[:, 1].mean()
        rows.append([number + 1, f"{contact[0] / 1e9:.2f}", f"{contact[2] / 1e6:.3f}", f"{contact[3]:.1f}", text(found[:, 0] / 1e9), text(found[:, 1]),
                     text(found[:, 2] / 1e6), text(lost[:, 1]), text(lost[:, 0]), f"{factor * contact[3]:.1f}"])
        print(rows[-1], flush=True)
        if number < rounds - 1:
            contact = tuple(float(f"{v:.4g}") for v in (contact[0] * MODULUS / modulus, contact[1], contact[2] * TENSILE / strength, FRACTURE / factor)) + curve
    return contact, (modulus, contraction), study.table(
        ["round", "E of contacts, GPa", "their strength, MPa", "their G_f, N/m", "modulus of strips, GPa", "contraction", "strength, MPa",
         "lost across the crack, over G_f of contacts", "lost in all, over the same", "across the crack, N/m"], rows)


def text(values):
    return f"{np.mean(values):.3g} ± {np.std(values, ddof=1):.2g}" if len(values) > 1 else f"{values[0]:.3g}"


def plane(modulus, contraction):
    """E and nu of elements in plane strain with this modulus and Poisson's ratio in the plane."""
    poisson = contraction / (1 + contraction)
    return modulus * (1 - poisson**2), poisson


# --- the beam ---------------------------------------------------------------------------------------------------

def mesh():
    """Two blocks of triangles at both sides of the middle; supports at their lower side."""
    path = FOLDER / "sides.msh"
    FOLDER.mkdir(parents=True, exist_ok=True)
    nodes, cells, feet = [], [], {}
    for side, start, end, at in (("left", 0.0, MIDDLE - FREE, 0.5 * (LENGTH - SPAN)), ("right", MIDDLE + FREE, LENGTH, 0.5 * (LENGTH + SPAN))):
        columns, rows, first = round((end - start) / SIDE), round(DEPTH / SIDE), len(nodes)
        nodes += [(start + SIDE * c, SIDE * r) for r in range(rows + 1) for c in range(columns + 1)]
        cells += meshes.triangles(first + 1 + np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1))
        feet[f"support_{side}"] = first + 1 + round((at - start) / SIDE)
    meshes.write(path, nodes, cells, feet)
    return str(path)


def outline(start, end):
    left, right = MIDDLE - 0.5 * SLOT, MIDDLE + 0.5 * SLOT
    return [[start, 0], [left, 0], [left, NOTCH], [right, NOTCH], [right, 0], [end, 0], [end, DEPTH], [start, DEPTH]]


def beam_scene(radius, seed, contact, bulk, speed):
    reach, edges = FREE + WIDTH, (MIDDLE - FREE, MIDDLE + FREE)
    young, poisson = plane(*bulk)
    box = {"left": [MIDDLE - 0.5 * GAUGE - 1e-3, 0], "right": [MIDDLE + 0.5 * GAUGE - 1e-3, 0]}
    return {**body({"polygon": outline(MIDDLE - reach, MIDDLE + reach)}, radius, seed, contact),
             "elements": {"mesh": mesh(), "materials": [{"young": young, "poisson": poisson, "density": DENSITY}],
                          "motions": [{"name": "left", "group": "support_left", "motion": {"vx": 0, "vy": 0}},
                                      {"name": "right", "group": "support_right", "motion": {"vy": 0}}]},
             "couple": {"zones": [{"edges": [{"from": [edges[0], 0], "to": [MIDDLE - reach + radius, 0]}]},
                                  {"edges": [{"from": [edges[1], 0], "to": [MIDDLE + reach - radius, 0]}]}]},
             "sets": [{"name": "load", "select": {"box": {"min": [MIDDLE - 2.5e-3, DEPTH - 1.5e-3], "max": [MIDDLE + 2.5e-3, DEPTH]}},
                       "motion": {"vy": [[0, 0], [2e-3, -speed]]}},
                      *({"name": f"mouth_{side}", "select": {"box": {"min": low, "max": [low[0] + 2e-3, 1.5e-3]}}} for side, low in box.items())],
             "damping": {"background": {"model": "viscous", "coefficient": 1000}},
             "test": {"kind": "bending", "axis": "y", "lower": ["left", "right"], "upper": "load", "span": SPAN, "height": DEPTH, "notch": NOTCH,
                      "opening": {"axis": "x", "lower": "mouth_left", "upper": "mouth_right"}},
             "time": {"end": 0.16e-3 / speed, "stop": {"peak_drop": 0.9}}}


def beam(radius, seed, contact, bulk, speed=SPEED, note=""):
    """Particles in the middle, elements at both sides; the loading point moves down at `speed`, m/s."""
    scene = beam_scene(radius, seed, contact, bulk, speed)
    return made(f"beam-{1e3 * radius:g}-{seed}-{speed:g}{note}", scene, {"output.history_rows": 2000, "run.residual_limit": "off"})


def adaptive(radius, seed, contact, bulk):
    """Elements all over at first, which become particles where a third of the strength is reached; loaded at one node."""
    young, poisson = plane(*bulk)
    other = beam_scene(radius, seed, contact, bulk, SPEED)
    shape = {"length": LENGTH, "height": DEPTH, "span": SPAN, "notch_depth": NOTCH, "notch_width": SLOT, "cell": SIDE}
    motions = [*other["elements"]["motions"], {"name": "load", "group": "load", "motion": other["sets"][0]["motion"]}]
    scene = {**other, "specimen": {**other["specimen"], "polygon": outline(0, LENGTH)}, "sets": other["sets"][1:],
             "elements": {"beam": shape, "materials": [{"young": young, "poisson": poisson, "density": DENSITY}], "motions": motions},
             "couple": {"convert": {"box": {"min": [MIDDLE - 0.03, -1e-3], "max": [MIDDLE + 0.03, DEPTH + 1e-3]}, "width": WIDTH, "stress": TENSILE / 3,
                                    "every": 100}}}
    return made(f"adaptive-{1e3 * radius:g}-{seed}", scene, {"output.history_rows": 2000, "run.residual_limit": "off"})


def curve(run):
    """Opening in mm, load for the breadth of the beam in N."""
    return 1e3 * run.results("history/opening"), BREADTH * run.results("history/force")


def band():
    return np.loadtxt(BAND, delimiter=",", comments="#", skiprows=3)


def load_at(run, opening):
    """Mean load around an opening, which oscillates slightly, N."""
    at, load = curve(run)
    near = np.abs(at - opening) < 0.02 * opening
    return float(np.mean(load[near])) if near.any() else float("nan")


def beside(value, low, high):
    """Distance of a load from the band, per cent."""
    off = value / high - 1 if value > high else value / low - 1 if value < low else 0.0
    return "in" if off == 0.0 else f"{100 * off:+.0f} %"


# --- a hinge model for comparison ---------------------------------------------------------------------------------

def linear(energy, tensile=TENSILE):
    """Openings and stresses at the corners of a softening law."""
    return [(0.0, tensile), (2 * energy / tensile, 0.0)]


def bilinear(energy):
    """Petersson 1981: a third of the strength at 0.8 G/f, zero at 3.6 G/f."""
    return [(0.0, TENSILE), (0.8 * energy / TENSILE, TENSILE / 3), (3.6 * energy / TENSILE, 0.0)]


def turned(corners, height, young):
    """Angles, heights of the compressed part (m) and moments (N m per m of breadth) of a section whose crack distributes its opening over a layer of
    half its height (Olesen 2001): strains are linear over the height; a fibre is longer by stress over modulus times the layer, plus the opening at
    that stress."""
    count, tensile = 400, corners[0][1]
    layer, y = 0.5 * height, (np.arange(count) + 0.5) / count * height
    opened, stress = np.array(corners).T
    longer = opened + layer * stress / young  # the angle grows along the law, as the layer is stiff
    found = []
    for curvature in np.geomspace(1e-3, 60, 300):
        low, high = 0.0, height
        for _ in range(60):
            centre = 0.5 * (low + high)
            strain = curvature * (y - centre)
            carried = np.where(strain * young <= tensile, strain * young, np.interp(strain * layer, longer, stress, right=0.0))
            low, high = (centre, high) if carried.sum() > 0 else (low, centre)
        found.append((curvature * layer, centre, np.sum(carried * (y - centre)) * height / count))
    return np.array(found).T


def hinge_moment(corners, height, young):
    """Largest moment, N m per m of breadth."""
    return turned(corners, height, young)[2].max()


def hinge(corners):
    """Openings of the mouth (m), ascending, and loads of the beam (N). Bending outside the layer is neglected."""
    angle, pressed, moment = turned(corners, DEPTH - NOTCH, MODULUS)
    return angle * (DEPTH - pressed), 4 * BREADTH * moment / SPAN


OPENINGS = (0.005, 0.01, 0.03, 0.05, 0.075, 0.1, 0.15, 0.2)  # mm
TAIL = OPENINGS[3:]


def hinge_table():
    laws = (("linear, G_f", linear(FRACTURE)), ("linear, G_f/2.5", linear(FRACTURE / INITIAL)), ("bilinear, G_f", bilinear(FRACTURE)))
    measured, none = band(), ["" for _ in TAIL]
    rows = [["without a crack, 2 f b h2/(3 S)", f"{2 * TENSILE * BREADTH * (DEPTH - NOTCH)**2 / (3 * SPAN):.0f}", *none]]
    for name, corners in laws:
        at, load = hinge(corners)
        tail = [(np.interp(1e-3 * w, at, load), *(np.interp(w, measured[:, 0], measured[:, k]) for k in (1, 2))) for w in TAIL]
        rows.append([name, f"{load.max():.0f}, {beside(load.max(), measured[:, 1].max(), measured[:, 2].max())}",
                     *(f"{value:.0f}, {beside(value, low, high)}" for value, low, high in tail)])
    rows.append(["never, 2 f b h2/S", f"{2 * TENSILE * BREADTH * (DEPTH - NOTCH)**2 / SPAN:.0f}", *none])
    return study.table(["softening", "peak, N", *(f"load at {w:g} mm, N" for w in TAIL)], rows)


def beam_table(found):
    measured = band()
    rows = [["measured", "", f"{measured[:, 1].max():.0f} to {measured[:, 2].max():.0f}", "",
             *(f"{np.interp(w, measured[:, 0], measured[:, 1]):.0f} to {np.interp(w, measured[:, 0], measured[:, 2]):.0f}" for w in OPENINGS)]]
    for name, run in found:
        at, load = curve(run)
        peak = int(np.argmax(load))
        cells = []
        for w in OPENINGS:
            value, low, high = load_at(run, w), *(np.interp(w, measured[:, 0], measured[:, k]) for k in (1, 2))
            cells.append(f"{value:.0f}, {beside(value, low, high)}" if np.isfinite(value) else "-")
        rows.append([name, len(run.results("particles/radius")), f"{load[peak]:.0f}, {beside(load[peak], measured[:, 1].max(), measured[:, 2].max())}",
                     f"{1e3 * at[peak]:.0f}", *cells])
    return study.table(["", "particles", "peak, N", "opening there, um", *(f"load at {w:g} mm, N" for w in OPENINGS)], rows)


def draw(found, picture):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    measured = band()
    figure, axes = plt.subplots(figsize=(7, 4.2), constrained_layout=True)
    axes.fill_between(measured[:, 0], measured[:, 1], measured[:, 2], color="0.8", label="measured (Gregoire et al. 2013)")
    for name, run in found:
        at, load = curve(run)
        axes.plot(at, load, linewidth=0.9, label=name)
    axes.set(xlabel="opening of the notch's mouth over 20 mm, mm", ylabel="load, N", xlim=(0, 0.2), ylim=(0, 2000))
    axes.legend(loc="upper right", fontsize=8)
    figure.savefig(picture, dpi=110, metadata={"Software": None})


def of_one_line():
    contact, bulk, calibration = calibrate()
    study.put("beams.md", "table contacts", calibration)
    found = [(f"r {1e3 * radius:g} mm, packing {seed}", beam(radius, seed, contact, bulk)) for radius in RADII for seed in SEEDS[:COUNT[radius]]]
    others = [(f"r {1e3 * RADII[0]:g} mm, packing 1, half as fast", beam(RADII[0], 1, contact, bulk, 0.5 * SPEED)),
              ("the same with G_f/2.5, packing 1", beam(RADII[0], 1, (*contact[:3], float(f"{contact[3] / INITIAL:.4g}")), bulk, note="-first")),
              ("elements that become particles, packing 1", adaptive(RADII[0], 1, contact, bulk))]
    own, _, smaller = calibrate(radius=RADII[1], start=contact, rounds=2)
    study.put("beams.md", "table smaller", smaller)
    found += [(f"r {1e3 * RADII[1]:g} mm, its own contacts, packing {seed}", beam(RADII[1], seed, own, bulk, note="-own")) for seed in SEEDS[:COUNT[RADII[1]]]]
    study.put("beams.md", "table hinge", hinge_table())
    study.put("beams.md", "table beam", beam_table([*found, *others]))
    draw([*found, *others[1:]], PICTURE)


def of_two_lines():
    """The table with bonds that soften by Petersson's law."""
    contact, bulk, calibration = calibrate("bilinear")
    study.put("beams.md", "table bilinear contacts", calibration)
    found = [(f"r {1e3 * RADII[0]:g} mm, packing {seed}", beam(RADII[0], seed, contact, bulk, note="-bilinear")) for seed in SEEDS]
    found.append((f"r {1e3 * RADII[1]:g} mm, packing 1", beam(RADII[1], 1, contact, bulk, note="-bilinear")))
    study.put("beams.md", "table bilinear beam", beam_table(found))
    draw(found, PICTURE.with_name("beams-bilinear.png"))


def main():
    parts = {"linear": of_one_line, "bilinear": of_two_lines}
    for name in [word for word in sys.argv[1:] if word in parts] or parts:
        parts[name]()


if __name__ == "__main__":
    main()
