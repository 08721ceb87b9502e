"""Notched beams in mixed mode, of elements that turn into particles where they crack: the measured one of Garcia-Alvarez et al. 2012 and, with
assumed distances, types 1 and 2 of Galvez et al. 1998. Measured properties of their concretes are input. Fills docs/evidence/beams.md.

    /usr/bin/python3 validate/mixed_study.py [--fresh] [--kept]
"""
import dataclasses
import json
import re

import numpy as np

import beam_study
import meshes
import study

BAND = study.ROOT / "validate" / "references" / "beam-mixed-2012.csv"
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
SCENE_MESH = study.ROOT / "scenes" / "specimens" / "beam-mixed.msh"
FOLDER = study.RUNS / "beams"
# Contact parameters relative to those of the concrete: modulus, strength, fracture energy, from the strips of the
# beam of Gregoire et al. (last round of the table of contacts).
OVER = (39.95 / 37.0, 3.274 / 3.9, 105.3 / 143.2)
SEEDS = (1, 2)
SPEED = 0.01  # m/s of the load


@dataclasses.dataclass(frozen=True)
class Concrete:
    young: float      # Pa
    tensile: float    # Pa
    fracture: float   # J/m2

    @property
    def contact(self):
        return tuple(float(f"{v:.4g}") for v in (self.young * OVER[0], 0.2, self.tensile * OVER[1], self.fracture * OVER[2]))


@dataclasses.dataclass(frozen=True)
class Beam:
    """Lengths in m; places along the beam from the middle of the notch."""
    name: str
    concrete: Concrete
    depth: float
    ends: tuple           # left, right
    notch: float          # depth of the notch
    supports: tuple       # left, right
    load: float
    packed: tuple         # range over the whole depth where particles may appear
    cell: float           # largest size of the mesh in that range
    width: float          # width of the zone
    hold: float | None = None   # place where the upper side is held
    slot: float = 0.002
    breadth: float = 0.05
    gauge: float = 0.02
    drop: float = 0.8     # part of the largest load by which the load falls before the end

    @property
    def ligament(self):
        return self.depth - self.notch


GETTU = Beam("gettu", Concrete(33.8e9, 3.5e6, 125.2), depth=0.08, ends=(-0.075, 0.175), notch=0.02, supports=(-0.05, 0.15), load=0.05,
             packed=(-0.075, 0.175), cell=0.004, width=0.0125)
GALVEZ = Beam("galvez-1-near", Concrete(38e9, 3.0e6, 69.0), depth=0.15, ends=(-0.3375, 0.3375), notch=0.075, supports=(-0.075, 0.3), load=0.075,
              packed=(-0.3375, 0.3375), cell=0.005, width=0.025, drop=0.7)
HELD = dataclasses.replace(GALVEZ, name="galvez-2-near", hold=-0.3)
LIMIT = 0.6  # stress at which elements convert, relative to the strength


# --- scenes -------------------------------------------------------------------------------------------------------

def mesh(beam, path):
    """Cells of the notch's width at its tip that grow to `cell`."""
    half, tip = 0.5 * beam.slot, (0.0, beam.notch)
    marks = sorted({beam.ends[0], *beam.supports, *beam.packed, -half, half, beam.load, beam.ends[1], *([beam.hold] if beam.hold else [])})
    x = meshes.graded(marks, lambda at: np.minimum(beam.cell, beam.slot + 0.2 * np.maximum(np.abs(at) - half, 0.0)))
    y = meshes.graded([0.0, tip[1], beam.depth], lambda at: np.minimum(beam.cell, beam.slot + 0.2 * np.abs(at - tip[1])))
    inside = np.abs(x) <= half + 1e-9
    number = np.arange(1, len(x) * len(y) + 1).reshape(len(y), len(x))
    cells = meshes.triangles(number, lambda r, c: not (inside[c] and inside[c + 1] and y[r + 1] <= beam.notch + 1e-9))
    places = {"support_left": (beam.supports[0], 0), "support_right": (beam.supports[1], 0), "load": (beam.load, -1),
              **({"hold": (beam.hold, -1)} if beam.hold else {})}
    points = {name: number[row, int(np.argmin(np.abs(x - at)))] for name, (at, row) in places.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    before = path.read_text() if path.exists() else ""
    meshes.write(path, [(round(at - beam.ends[0], 7), round(up, 7)) for up in y for at in x], cells, points)
    if path.read_text() != before:  # a kept run knows its scene, not its mesh
        for note in FOLDER.glob(f"mixed-{beam.name}-[0-9]*/study.json"):
            note.unlink()
    return str(path)


def outline(beam, start, end):
    half, notch, depth = 0.5 * beam.slot, beam.notch, beam.depth
    at = [(start, 0), (-half, 0), (-half, notch), (half, notch), (half, 0), (end, 0), (end, depth), (start, depth)]
    return [[float(f"{x - beam.ends[0]:.10g}"), y] for x, y in at]


def scene(beam, radius, seed, speed, end):
    """The beam begins at x = 0; elements all over."""
    young, poisson = beam_study.plane(beam.concrete.young, 0.168)
    from_left = -beam.ends[0]
    wide = 2 * max(1.5e-3, 1.5 * radius)
    mouth = {side: from_left + sign * 0.5 * beam.gauge - 0.5 * wide for side, sign in (("left", -1), ("right", 1))}
    fall = {"vy": [[0, 0], [2e-3, -speed]]}
    motions = {"left": ("support_left", {"vx": 0, "vy": 0}), "right": ("support_right", {"vy": 0}), "load": ("load", fall),
               **({"hold": ("hold", {"vy": 0})} if beam.hold else {})}
    return {**beam_study.body({"polygon": outline(beam, *beam.packed)}, radius, seed, beam.concrete.contact),
            "elements": {"mesh": mesh(beam, FOLDER / f"{beam.name}.msh"),
                         "materials": [{"young": young, "poisson": poisson, "density": beam_study.DENSITY}],
                         "motions": [{"name": name, "group": group, "motion": motion} for name, (group, motion) in motions.items()]},
            "couple": {"convert": {"box": {"min": [beam.packed[0] + from_left, 0], "max": [beam.packed[1] + from_left, beam.depth]}, "width": beam.width,
                                   "stress": LIMIT * beam.concrete.tensile, "every": 100}},
            "sets": [{"name": f"mouth_{side}", "select": {"box": {"min": [low, 0], "max": [low + wide, wide]}}} for side, low in mouth.items()],
            "damping": {"background": {"model": "viscous", "coefficient": 1000}},
            "test": {"kind": "bending", "axis": "y", "lower": ["left", "right"], "upper": ["load", "hold"] if beam.hold else "load",
                     "span": beam.supports[1] - beam.supports[0], "height": beam.depth, "notch": beam.notch,
                     "opening": {"axis": "x", "lower": "mouth_left", "upper": "mouth_right"}},
            "time": {"end": end, "stop": {"peak_drop": beam.drop}}}


def run(beam, radius, seed=1, speed=SPEED, end=25e-3, settings=None, note=""):
    made = scene(beam, radius, seed, speed, end * SPEED / speed)
    return beam_study.made(f"mixed-{beam.name}-{1e3 * radius:g}-{seed}-{speed:g}{note}", made,
                           {"output.history_rows": 2000, "run.residual_limit": "off", **(settings or {})})


def whole(beam, radius, seed=1):
    """The run of particles alone, held and loaded by sets of them."""
    ends = (0.0, beam.ends[1] - beam.ends[0])
    made = scene(beam, radius, seed, SPEED, 25e-3)
    moved = {motion["name"]: motion["motion"] for motion in made["elements"]["motions"]}
    places = {"left": (beam.supports[0], 0.0), "right": (beam.supports[1], 0.0), "load": (beam.load, beam.depth - 2e-3)}
    boxes = {name: {"min": [x - beam.ends[0] - 2e-3, low], "max": [x - beam.ends[0] + 2e-3, low + 2e-3]} for name, (x, low) in places.items()}
    made["sets"] += [{"name": name, "select": {"box": box}, "motion": moved[name]} for name, box in boxes.items()]
    made["specimen"]["polygon"] = outline(beam, ends[0] + beam.ends[0], ends[1] + beam.ends[0])
    del made["elements"], made["couple"]
    return beam_study.made(f"mixed-{beam.name}-{1e3 * radius:g}-{seed}-alone", made, {"output.history_rows": 2000, "run.residual_limit": "off"})


def never(beam, radius):
    """The run of elements alone."""
    return run(beam, radius, end=3e-3, settings={"couple.convert.stress": 1e12}, note="-never")


# --- readings -----------------------------------------------------------------------------------------------------

def curve(found):
    """Opening in mm, load in N on the beam's breadth (minus the force of a hold-down), force of the hold-down over the load."""
    force, hold = found.results("history/force"), 0.0
    try:
        hold = np.abs(found.results("history/motion_hold_reaction_y"))
    except KeyError:
        pass
    load = GALVEZ.breadth * (force - hold)
    return 1e3 * found.results("history/opening"), load, GALVEZ.breadth * hold / np.where(load > 1, load, np.inf)


def opened(found, beam):
    """Places (m, from the notch) of the middles of bonds that are damaged by four fifths at least, and the separations of their ends, m."""
    x, d = found.results("particles/position"), found.results("particles/displacement")
    i, j, state = (found.results(f"bonds/{name}") for name in ("i", "j", "state"))
    damage = np.maximum(found.results("bonds/tension_damage"), found.results("bonds/shear_damage"))
    part = (damage > 0.8) | (state == 1) | (state == 2)
    start = x - d
    return (0.5 * (start[i] + start[j]) + [beam.ends[0], 0, 0])[part, :2], np.linalg.norm(d[j] - d[i], axis=1)[part]


def path(found, beam):
    """Where the crack is, in layers of the ligament: heights over the notch and distances from it along the beam, m. An opening farther from the
    layer below than 45 degrees and 5 mm allow belongs to another crack."""
    at, by = opened(found, beam)
    count = 15
    layer, last, found_at = beam.ligament / count, 0.0, []
    for k in range(count):
        height = (k + 0.5) * layer
        part = (np.abs(at[:, 1] - beam.notch - height) < 0.5 * layer) & (np.abs(at[:, 0] - last) < layer + 5e-3)
        if not part.any():
            break
        last = float(np.average(at[part, 0], weights=by[part]))
        found_at.append((height, last))
    return np.array(found_at).reshape(-1, 2)


def leaning(found, beam):
    """Angles (degrees) between the vertical and the chord from the notch to the crack at a third and at two thirds of the ligament; the height up to
    which the crack is open."""
    crack = path(found, beam)
    angles = []
    for part in (1 / 3, 2 / 3):
        height = part * beam.ligament
        reached = len(crack) and crack[-1, 0] > height
        angles.append(f"{np.degrees(np.arctan2(np.interp(height, crack[:, 0], crack[:, 1]), height)):.0f}" if reached else "-")
    return [*angles, f"{1e3 * crack[-1, 0]:.0f} of {1e3 * beam.ligament:.0f}" if len(crack) else "-"]


# --- forces of a rigid hinge ----------------------------------------------------------------------------------------

def hinged(beam, degrees, energy=None):
    """Load (N) at which a straight crack from the notch opens as a hinge about its upper end, which leans towards the load: that end is where the moment of the
    left support is taken. With two supports only."""
    left, right = beam.supports
    lean = np.radians(degrees)
    end = beam.ligament * np.tan(lean)
    share = (right - beam.load) / (right - left)
    law = beam_study.linear(energy or beam.concrete.fracture, beam.concrete.tensile)
    return beam.breadth * beam_study.hinge_moment(law, beam.ligament / np.cos(lean), beam.concrete.young) / (share * (end - left))


def least_hinge(beam, energy=None):
    """The least of these loads over the angle, and the angle."""
    angles = np.arange(0.0, np.degrees(np.arctan2(beam.load, beam.ligament)), 1.0)
    loads = [hinged(beam, angle, energy) for angle in angles]
    return min(loads), angles[int(np.argmin(loads))]


# --- tables -------------------------------------------------------------------------------------------------------

STRIPS = ((1e-3, (1, 2, 3)), (5e-4, (1, 2)))


def strip_table():
    rows = []
    for name, beam in (("Garcia-Alvarez", GETTU), ("Galvez", GALVEZ)):
        contact = beam.concrete.contact
        for radius, seeds in STRIPS:
            found = np.array([beam_study.elastic(beam_study.strip(radius, seed, contact)) for seed in seeds])
            apart = [beam_study.strip(radius, seed, contact, 8 * contact[3] / contact[2]) for seed in seeds]
            across = contact[3] * np.array([beam_study.crack_energy(strip, contact)[1] for strip in apart])
            rows.append([name, f"{contact[0] / 1e9:.2f}", f"{contact[2] / 1e6:.3f}", f"{contact[3]:.1f}", f"{1e3 * radius:g}", beam_study.text(found[:, 0] / 1e9),
                         beam_study.text(found[:, 2] / 1e6), beam_study.text(across)])
        rows.append([name + ", given", "", "", "", "", f"{beam.concrete.young / 1e9:g}", f"{beam.concrete.tensile / 1e6:g}", f"{beam.concrete.fracture:g}"])
    return study.table(["concrete", "E of contacts, GPa", "their strength, MPa", "their G_f, N/m", "strips of r, mm", "modulus, GPa", "strength, MPa",
                        "across the crack, N/m"], rows)


def load_at(found, opening):
    """The mean load around an opening, mm, in N."""
    at, load, _ = curve(found)
    near = np.abs(at - opening) < 0.02 * opening
    return float(np.mean(load[near])) if near.any() else float("nan")


OPENINGS = (0.005, 0.01, 0.015, 0.02, 0.03, 0.05, 0.075, 0.1)  # mm


def measured_table(found):
    """Loads at some openings, and their deviations from the measured ones."""
    measured = np.loadtxt(BAND, delimiter=",", comments="#", skiprows=3)
    most = measured[:, 1].max(), measured[:, 2].max()
    low, high = (np.interp(OPENINGS, measured[:, 0], measured[:, k]) for k in (1, 2))
    rows = [["measured", "", f"{most[0]:.0f} to {most[1]:.0f}", "19 to 21", *(f"{a:.0f} to {b:.0f}" for a, b in zip(low, high))]]
    for name, run_of_it in found:
        at, load, _ = curve(run_of_it)
        peak, ended = int(np.argmax(load)), "never" not in run_of_it.folder.name
        loads = [load_at(run_of_it, opening) for opening in OPENINGS]
        cells = [f"{v:.0f}, {beam_study.beside(v, a, b)}" if np.isfinite(v) else "-" for v, a, b in zip(loads, low, high)]
        count = run_of_it.summary["counts"]["particles"] if ended else 0
        rows.append([name, count, f"{load[peak]:.0f}, {beam_study.beside(load[peak], *most)}" if ended else "-", f"{1e3 * at[peak]:.0f}" if ended else "-", *cells])
    return study.table(["", "particles packed", "peak, N", "opening there, um", *(f"load at {w:g} mm, N" for w in OPENINGS)], rows)


def crack_table(found):
    rows = []
    for name, beam, run_of_it in found:
        at, load, share = curve(run_of_it)
        peak = int(np.argmax(load))
        bend = 1e6 * np.abs(run_of_it.results("history/motion_load_displacement_y")[peak])
        rows.append([name, f"{load[peak]:.0f}", f"{1e3 * at[peak]:.0f}", f"{bend:.0f}", f"{share[peak]:.3f}" if beam.hold else "-", *leaning(run_of_it, beam),
                     ending(run_of_it)])
    return study.table(["", "peak, N", "opening there, um", "the load's way there, um", "held down there, of the load",
                        "leaning over a third of the ligament, degrees", "over two thirds", "cracked, mm", "end"], rows)


def ending(run_of_it):
    """The reason why a run ended, in a few words, and the share of its largest load at the end."""
    _, load, _ = curve(run_of_it)
    why = run_of_it.summary.get("stop_reason", "")
    left = f"{100 * load[-1] / load.max():.0f} % of the peak"
    return f"{left}: elements at the load" if "motion" in why else f"{left}: beyond the box" if "convert.box" in why else left


def cost_table(found):
    rows = []
    for name, run_of_it in found:
        summary = run_of_it.summary
        active = run_of_it.results("history/particles") if "alone" not in run_of_it.folder.name else [summary["counts"]["particles"]]
        elements = run_of_it.results("history/elements") if "alone" not in run_of_it.folder.name else [0]
        rows.append([name, summary["counts"]["particles"], f"{int(active[0])} to {int(active[-1])}", f"{int(elements[0])} to {int(elements[-1])}", summary["steps"],
                     f"{1e9 * summary['dt']:.0f}", f"{summary['seconds']['cpu']:.0f}", f"{100 * run_of_it.residual:.0e}"])
    return study.table(["", "particles packed", "active", "elements", "steps", "last step, ns", "s of a core", "residual, %"], rows)


def estimate_table():
    """The table for a section at the notch, upright or leaning; of elements alone."""
    rows = []
    for name, beam in (("Garcia-Alvarez", GETTU), ("Galvez, type 1", GALVEZ), ("Galvez, type 2", HELD)):
        c, lever = beam.concrete, notch_moment(beam)
        section = c.tensile * beam.breadth * beam.ligament**2 / 6
        least = [f"{load:.0f} at {angle:.0f}" for load, angle in (least_hinge(beam), least_hinge(beam, c.fracture / beam_study.INITIAL))] if not beam.hold else ["-", "-"]
        upright = f"{hinged(beam, 0.0):.0f}" if not beam.hold else "-"
        rows.append([name, f"{1e3 * lever:.1f}", f"{section / abs(lever):.0f}", upright, *least])
    return study.table(["beam", "moment over the notch for 1 N, mm", "without a crack: f b h2/6 there, N", "hinge over the notch, N", "leaning hinge, least, N at degrees",
                        "the same with G_f/2.5"], rows)


def notch_moment(beam):
    """Moment over the notch for a unit load, m; tension below is positive. With a hold-down it follows from the shares of the load that elements
    alone carry at the end."""
    left, right = beam.supports
    if not beam.hold:
        return -left * (right - beam.load) / (right - left)
    share = curve(never(beam, NEVER[beam.name]))[2][-1]
    support = (right - beam.load + share * (right - beam.hold)) / (right - left)
    return -left * support + share * beam.hold


NEVER = {"gettu": 1e-3, "galvez-1-near": 2e-3, "galvez-2-near": 2e-3}


def alone_seconds(beam, radius, upto):
    """Particles of the whole beam, and seconds of one thread in which `gneiss plan` has them come as far as `upto`, s."""
    made = scene(beam, radius, 1, SPEED, upto)
    for key in ("elements", "couple", "test"):
        del made[key]
    made["specimen"]["polygon"] = outline(beam, *beam.ends)
    made["sets"] = []
    del made["time"]["stop"]
    path = FOLDER / f"mixed-{beam.name}-{1e3 * radius:g}-plan.yaml"
    path.write_text(json.dumps(made, indent=1))
    done = study.call(["plan", str(path), "--threads", "1"])
    number = {name: float(re.search(pattern, done.stdout).group(1)) for name, pattern in (
        ("particles", r"\n  particles +(\d+) x"), ("dt", r"\n  dt +(\S+) s"), ("step", r"per step +(\S+) us"))}
    return int(number["particles"]), f"{1e-6 * number['step'] * upto / number['dt']:.0f}"


# --- pictures -----------------------------------------------------------------------------------------------------

def draw_curves(measured_runs, cracked):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    band = np.loadtxt(BAND, delimiter=",", comments="#", skiprows=3)
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), constrained_layout=True)
    axes[0].fill_between(band[:, 0], band[:, 1], band[:, 2], color="0.8", label="measured (Garcia-Alvarez et al. 2012)")
    for name, found in measured_runs:
        at, load, _ = curve(found)
        axes[0].plot(at, load, linewidth=0.9, label=name, linestyle="--" if "alone" in name else "-")
    axes[0].set(xlabel="opening of the notch's mouth over 20 mm, mm", ylabel="load, N", xlim=(0, 0.2), ylim=(0, 7500))
    for name, _, found in cracked:
        at, load, _ = curve(found)
        axes[1].plot(at, load, linewidth=0.9, label=name)
    axes[1].set(xlabel="opening of the notch's mouth over 20 mm, mm", xlim=(0, 0.25), ylim=(0, None))
    for axis in axes:
        axis.legend(fontsize=7)
    figure.savefig(PICTURES / "beams-mixed-curves.png", dpi=110, metadata={"Software": None})


def draw_paths(panels):
    """Damage of bonds, and the cracks of other runs as lines; `panels`: title, beam, the run that is drawn, others by name."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(len(panels), 1, figsize=(10, 3.1 * len(panels)), constrained_layout=True)
    for axis, (title, beam, found, others) in zip(axes, panels):
        draw_body(axis, beam)
        draw_damage(axis, found, beam, figure)
        for name, other in others:
            crack = 1e3 * path(other, beam)
            axis.plot(crack[:, 1], crack[:, 0] + 1e3 * beam.notch, linewidth=1.1, label=name)
        axis.set(title=title, xlabel="from the notch, mm", ylabel="height, mm", aspect="equal", xlim=(1e3 * beam.ends[0] - 5, 1e3 * beam.ends[1] + 5),
                 ylim=(-12, 1e3 * beam.depth + 12))
        axis.title.set_fontsize(9)
        axis.legend(fontsize=7, loc="center right")
    figure.savefig(PICTURES / "beams-mixed-cracks.png", dpi=110, metadata={"Software": None})


def draw_body(axis, beam):
    half, top = 0.5 * beam.slot, beam.depth
    corners = [(beam.ends[0], 0), (-half, 0), (-half, beam.notch), (half, beam.notch), (half, 0), (beam.ends[1], 0), (beam.ends[1], top), (beam.ends[0], top),
               (beam.ends[0], 0)]
    axis.plot(*(1e3 * np.array(corners).T), color="k", linewidth=0.8)
    for at, height, down in ((beam.supports[0], 0, False), (beam.supports[1], 0, False), (beam.load, top, True), (beam.hold, top, True)):
        if at is not None:
            axis.plot(1e3 * at, 1e3 * height + (5 if down else -5), marker="v" if down else "^", color="C3" if at == beam.load else "k", markersize=7)


def draw_damage(axis, found, beam, figure):
    x, d = found.results("particles/position"), found.results("particles/displacement")
    start = 1e3 * (x - d)[:, :2] + [1e3 * beam.ends[0], 0]
    i, j, state = (found.results(f"bonds/{name}") for name in ("i", "j", "state"))
    damage = np.maximum(found.results("bonds/tension_damage"), found.results("bonds/shear_damage"))
    damage = np.where((state == 1) | (state == 2), 1.0, damage)
    active = found.results("particles/asleep") == 0
    axis.scatter(*start[active].T, s=0.4, color="0.85")
    part = np.flatnonzero(damage > 0.1)
    part = part[np.argsort(damage[part])]
    dots = axis.scatter(*(0.5 * (start[i] + start[j]))[part].T, s=1.5, c=damage[part], cmap="inferno_r", vmin=0, vmax=1)
    figure.colorbar(dots, ax=axis, label="damage of bonds", shrink=0.8)


def variants(coarse):
    """Name, beam and run of every case; a missing run (with --kept) is None."""
    first = dataclasses.replace(GETTU, name="gettu-first",
                                concrete=dataclasses.replace(GETTU.concrete, fracture=GETTU.concrete.fracture / beam_study.INITIAL))
    measured = [("r 1 mm, packing 1", GETTU, coarse, 1), ("r 1 mm, packing 2", GETTU, coarse, 2), ("r 0.5 mm, packing 1", GETTU, 0.5 * coarse, 1),
                ("r 1 mm, packing 1, G_f/2.5", first, coarse, 1)]
    types = [(f"type {number}, r {1e3 * radius:g} mm, packing {seed}", beam, radius, seed)
             for number, beam in ((1, GALVEZ), (2, HELD)) for radius, seed in ((2e-3, 1), (2e-3, 2), (coarse, 1))]
    others = [(f"type {number}, {said}, r 2 mm", dataclasses.replace(beam, name=f"galvez-{number}{note}", **change), 2e-3, 1)
              for said, note, change in (("left support 150 mm from the notch", "-far", {"supports": (-0.15, 0.3)}),
                                         ("load 150 mm from the notch", "", {"load": 0.15, "packed": (-0.2, 0.3375)}))
              for number, beam in ((1, GALVEZ), (2, HELD))]
    return [[(name, beam, study.if_there(run, beam, radius, seed)) for name, beam, radius, seed in group] for group in (measured, types, others)]


def main():
    coarse = 1e-3
    measured, types, others = variants(coarse)
    absent = [name for name, _, found in (*measured, *types, *others) if not found]
    measured, types, others = ([row for row in group if row[2]] for group in (measured, types, others))
    alone = study.if_there(whole, GETTU, coarse)
    beside = [(name, found) for name, _, found in measured] + ([("particles alone, r 1 mm, packing 1", alone)] if alone else [])
    study.put("beams.md", "table mixed strips", strip_table())
    study.put("beams.md", "table mixed measured", measured_table([*beside, ("elements alone", never(GETTU, coarse))]))
    study.put("beams.md", "table mixed estimates", estimate_table())
    named = [*((f"Garcia-Alvarez, {name}", beam, found) for name, beam, found in measured), *types, *others]
    study.put("beams.md", "table mixed cracks", crack_table(named) + ("\n" + study.not_run(absent) if absent else ""))
    study.put("beams.md", "table mixed cost", cost_table([(f"Garcia-Alvarez, {name}", found) for name, found in beside] + [(name, found) for name, _, found in types]))
    planned = [("Garcia-Alvarez, r 1 mm", GETTU, coarse, measured[0][2])] + [(name, beam, coarse, found) for name, beam, found in types if "r 1 mm" in name]
    study.put("beams.md", "table mixed plan", study.table(["beam", "particles of the whole beam", "s of one thread by the plan"], [
        [name, *alone_seconds(beam, radius, found.summary["time"])] for name, beam, radius, found in planned]))
    draw_curves(beside, [*types, *others[:2]])
    panels = [("Garcia-Alvarez et al. 2012, r 1 mm, packing 1", GETTU, measured[0][2], beside[:3])]
    for number, beam in ((1, GALVEZ), (2, HELD)):
        own = [(name.split(", ", 1)[1], found) for name, its, found in types if its is beam]
        panels.append((f"Galvez et al. 1998, type {number}, distances taken, {own[-1][0]}", beam, own[-1][1], own))
    draw_paths(panels)


if __name__ == "__main__":
    main()
