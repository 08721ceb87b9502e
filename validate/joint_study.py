"""Joints: the strength of a specimen with one weak plane over the dip of the plane, beside the curve of Jaeger (1960); the friction of a smooth joint
beside that of a plane without bonds; the modulus of a block with sets of joints, beside Amadei & Goodman (1981), and with cracks, beside Kachanov (1992);
the law beside that of YADE in one packing; the time of a contact across a joint over that of a bond. Fills docs/evidence/joints.md.

    /usr/bin/python3 validate/joint_study.py [--fresh] [--kept] [--quick] [--rough] [--plane] [--block] [--yade] [--cost]
"""
import json
import math
import os
import re
import subprocess
import sys

import numpy as np

import study

PLANE = "scenes/joint-plane.yaml"
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
# Pa, background damping, degrees; planes steeper than 60 degrees meet the platens.
PLANES = ((2e6, 0.7, (0, 20, 40, 50, 60)), (2e6, 0.1, (50, 60)), (0, 0.1, (50, 60)))
SEEDS = (1, 2, 3)
SIGMA, FRICTION = 2e6, math.radians(30)
QUICK = "--quick" in sys.argv


def scene_file(name, text):
    path = study.RUNS / "joints" / f"{name}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


# --- one weak plane ---


def jaeger(dip, cohesion):
    """The axial stress in Pa at which a plane at `dip` degrees slides: sigma_3 + 2 (c + sigma_3 tan(phi))/((1 - tan(phi)/tan(dip)) sin(2 dip))."""
    angle, tangent = math.radians(dip), math.tan(FRICTION)
    if math.tan(angle) <= tangent or dip == 90:
        return math.inf
    return SIGMA + 2 * (cohesion + SIGMA * tangent) / ((1 - tangent / math.tan(angle)) * math.sin(2 * angle))


def compressed(dip, cohesion, damping, seed, name="plane", **more):
    settings = {"joints.plane.dip": f"{dip} deg", "joints.plane.cohesion": cohesion, "run.seed": seed, "joints.plane.tensile_strength": cohesion / 2,
                "output.contacts": "off"}
    if damping != 0.7:
        name, settings["damping.background.coefficient"] = f"{name}-{damping}", damping
    return study.run(f"joints/{name}-{dip}-{cohesion:g}-{seed}", PLANE, {**settings, **more})


def strength(dip, cohesion, damping, seed):
    """The largest axial stress, Pa; without cohesion, where there is no peak, the mean in the second half of the run."""
    stress = compressed(dip, cohesion, damping, seed).results("history/stress") + SIGMA  # the history has the deviator
    return float(stress.max() if cohesion else stress[len(stress) // 2:].mean())


def curve(cohesion, damping, dips, seeds):
    """Rows (dip, Jaeger's strength, strengths of the packings), and the names of runs that are missing."""
    rows, missing = [], []
    for dip in dips:
        found = {seed: study.if_there(strength, dip, cohesion, damping, seed) for seed in seeds}
        missing += [f"c = {cohesion / 1e6:g} MPa, damping {damping}, {dip} deg, packing {seed}" for seed, value in found.items() if value is None]
        values = [value for value in found.values() if value is not None]
        if values:
            rows.append((dip, jaeger(dip, cohesion), np.array(values)))
    return rows, missing


def draw(curves):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(6, 3.6))
    colours = {2e6: "tab:blue", 0: "tab:orange"}
    for cohesion, colour in colours.items():
        fine = np.linspace(31, 89.5, 300)
        axes.plot(fine, [jaeger(d, cohesion) / 1e6 for d in fine], color=colour, label=f"Jaeger, c = {cohesion / 1e6:g} MPa")
    for (rows, _), (cohesion, damping, _) in zip(curves, PLANES):
        for k, (dip, _, found) in enumerate(rows):
            axes.plot([dip] * len(found), found / 1e6, "o" if damping == 0.7 else "+", color=colours[cohesion], markersize=4,
                      label="" if k else f"c = {cohesion / 1e6:g} MPa, damping {damping}")
    axes.set(xlabel="dip of the plane, degrees", ylabel="strength, MPa", ylim=(0, 60), xlim=(-3, 93))
    axes.legend()
    study.save(figure, PICTURES, "joints-jaeger")


def plane(seeds):
    curves = [curve(*row, seeds) for row in PLANES]
    rows, missing = [], []
    for (found, gone), (cohesion, damping, _) in zip(curves, PLANES):
        missing += gone
        for dip, wanted, values in found:
            mean, scatter = values.mean(), f"{values.std(ddof=1) / 1e6:.2f}" if len(values) > 1 else ""
            rows.append((f"{cohesion / 1e6:g} MPa", damping, dip, "none" if math.isinf(wanted) else f"{wanted / 1e6:.2f}", f"{mean / 1e6:.2f}", scatter,
                         len(values), "" if math.isinf(wanted) else f"{mean / wanted - 1:+.1%}"))
    head = ("cohesion", "damping", "dip, deg", "Jaeger, MPa", "measured, MPa", "scatter, MPa", "packings", "difference")
    study.put_table("joints.md", "jaeger", head, rows, QUICK, missing)
    if not QUICK and rows:
        draw(curves)
    parts_of_difference(seeds)


VARIANTS = (("as in the table above, damping 0.7", "plane", 0.7, {}), ("as in the table above, damping 0.1", "plane", 0.1, {}),
            ("damping 0.1, half the speed", "slow", 0.1, {"walls.bottom.motion.vy": "[[0.4 ms, 0], [0.5 ms, 25 mm/s]]",
                                                          "walls.top.motion.vy": "[[0.4 ms, 0], [0.5 ms, -25 mm/s]]"}),
            ("damping 0.1, joint stiffness / 3", "soft", 0.1, {"joints.plane.normal_stiffness": "33 GPa/m", "joints.plane.shear_stiffness": "16.7 GPa/m"}),
            ("damping 0.1, joint stiffness x 10", "stiff", 0.1, {"joints.plane.normal_stiffness": "1 TPa/m", "joints.plane.shear_stiffness": "500 GPa/m"}))


def ratios(run, dip, cohesion):
    """Peak over Jaeger's strength; then, where the shear force of the joint is nearest to its strength (c A + N tan(phi)): their ratio, the axial stress
    across the joint over that of the platens, and the lateral stress over sigma_3."""
    stress, area = run.results("history/stress") + SIGMA, run.results("history/joint_plane_area")
    shear, normal = run.results("history/joint_plane_shear"), run.results("history/joint_plane_normal")
    used = shear / (cohesion * area + math.tan(FRICTION) * normal)
    most, tangent = int(used.argmax()), math.tan(math.radians(dip))
    axial, lateral = (normal + shear * tangent) / area, (normal - shear / tangent) / area
    return stress.max() / jaeger(dip, cohesion), used[most], axial[most] / stress[most], lateral[most] / SIGMA


def parts_of_difference(seeds):
    rows = []
    for text, name, damping, more in VARIANTS:
        found = np.array([ratios(compressed(60, 2e6, damping, seed, name, **more), 60, 2e6) for seed in seeds])
        rows.append((text, *(f"{value:.3f}" for value in found.mean(axis=0))))
    head = ("plane at 60 degrees, c = 2 MPa", "peak over Jaeger", "shear force over strength", "axial stress over platens'", "lateral stress over 2 MPa")
    study.put_table("joints.md", "parts", head, rows, QUICK)


# --- a smooth joint and a plane without bonds ---

DIRECT = "scenes/joint-shear.yaml"


def sheared(kind, seed):
    """Shear over normal force (mean and standard deviation) and rise of the upper half in m, over the last half of a path of 2 mm."""
    text = (study.ROOT / DIRECT).read_text().replace("100 mm/s", "500 mm/s")
    head, _, rest = text.partition("joints:\n")
    joint, _, tail = rest.partition("damping:")
    if kind == "rough":
        text = head + "damping:" + tail.replace("max: [1, 1]}}, force", "max: [1, 1]}}, group: 2, force")
    else:
        text = head + "joints:\n" + re.sub(r"    (bond_friction|cohesion|tensile_strength|dilation|dilation_end):.*\n", "", joint) + "damping:" + tail
    run = study.run(f"joints/shear-{kind}-{seed}", scene_file(f"shear-{kind}", text), {"run.seed": seed, "output.contacts": "off"})
    force = run.results("history/set_above_reaction_x")
    late = force[len(force) // 2:] / 60e3
    moved, place = run.results("particles/displacement")[:, 1], run.results("particles/position")[:, 1]
    return float(late.mean()), float(late.std()), float(moved[place - moved > 0.012].mean())


def roughness(seeds):
    rows = []
    for kind, name in (("smooth", "smooth joint, friction 0.5"), ("rough", "no bonds, friction of particles 0.5")):
        found = np.array([sheared(kind, seed) for seed in seeds])
        for seed, (mean, deviation, rise) in zip(seeds, found):
            rows.append((name, seed, f"{mean:.4f}", f"{deviation:.4f}", f"{1e3 * rise:.3f}"))
    study.put_table("joints.md", "roughness", ("plane", "packing", "shear over normal force", "its standard deviation in time", "rise, mm"), rows, QUICK)


# --- stiffness of a block with many joints ---

SIDE, SPACING = 0.06, 0.005  # m; 3000 discs with a mean radius of 0.58 mm
BLOCK = """title: Square with joints in tension
dimension: 2
specimen:
  rectangle: {{width: 60 mm, height: 60 mm}}
  particles: 3000
  packing: {{size_ratio: 2}}
materials:
  - {{name: rock, density: 2600 kg/m3, contact_modulus: 20 GPa, kratio: 2.5, friction: 0, tensile_strength: 1 TPa, shear_strength: 1 TPa}}
law: {{stiffness: harmonic}}
bonds: {{interaction_range: 0.05}}
{joints}
damping: {{background: {{model: nonviscous_vector, coefficient: 0.7}}}}
sets:
  - {{name: below, select: {{end: {{axis: y, side: lower, depth: 2 mm}}}}, motion: {{vy: [[0, 0], [0.5 ms, -5 mm/s]]}}}}
  - {{name: above, select: {{end: {{axis: y, side: upper, depth: 2 mm}}}}, motion: {{vy: [[0, 0], [0.5 ms, 5 mm/s]]}}}}
test: {{kind: tension, axis: y, lower: below, upper: above, length: 60 mm, diameter: 60 mm}}
time: {{end: 2 ms}}
output: {{history_rows: 200, snapshots: 0}}
"""
THROUGH, STIFFNESSES = (0, 30, 60), (8e12, 2e12, 5e11)  # degrees; Pa/m, the shear stiffness is half of it
CRACKS, HALF = (0.1, 0.2, 0.3), 0.005  # densities N a^2/A; a in m


def modulus(name, joints, seed, inner):
    """Stress of the ends over the strain along the axis at the end of the run, Pa, and m of joint per m2. The strain is that of the ends or, if `inner`, the
    gradient of a plane through the displacements in the middle, which joints that meet the ends do not disturb."""
    text = BLOCK.format(joints="joints:\n" + "".join(f"  - {{{joint}}}\n" for joint in joints) if joints else "")
    run = study.run(f"joints/{name}-{seed}", scene_file(name, text), {"run.seed": seed})
    strain = abs(run.results("history/strain")[-1])
    if inner:
        moved = run.results("particles/displacement")
        place = run.results("particles/position") - moved
        middle = np.abs(place[:, 1] - SIDE / 2) < SIDE / 3
        plane_of = np.column_stack([np.ones(len(place)), place[:, :2]])[middle]
        strain = np.linalg.lstsq(plane_of, moved[middle, 1], rcond=None)[0][2]
    length = sum(run.results(f"history/joint_{re.match('name: (.+?),', joint)[1]}_area")[0] for joint in joints)
    return abs(float(run.results("history/stress")[-1])) / float(strain), float(length) / SIDE ** 2


def through(dip, stiffness):
    """A set of joints through the square, SPACING apart; one goes through the middle."""
    c, s = math.cos(math.radians(dip)), math.sin(math.radians(dip))
    most = int((SIDE / 2 * (c + s) - 2.5e-3) / SPACING)
    return [f"name: j{k + most}, point: [{SIDE / 2 + s * SPACING * k}, {SIDE / 2 + c * SPACING * k}], dip: {dip} deg, "
            f"normal_stiffness: {stiffness}, shear_stiffness: {stiffness / 2}, cohesion: 1 TPa, tensile_strength: 1 TPa" for k in range(-most, most + 1)]


def per_length(dip, stiffness):
    """The compliance in 1/Pa per m of joint in a m2 that joints at `dip` degrees add along the axis (Amadei & Goodman 1981)."""
    c2 = math.cos(math.radians(dip)) ** 2
    return c2 ** 2 / stiffness + (1 - c2) * c2 / (stiffness / 2)


def persistent(seed, whole):
    """Rows of sets of through-going joints; the last column is the part of the compliance of the rock that is left with rigid joints."""
    rows = []
    for dip in THROUGH:
        found = [modulus(f"through-{dip}-{k:g}", through(dip, k), seed, True) for k in STIFFNESSES]
        added = np.array([per_length(dip, k) / SPACING for k in STIFFNESSES])
        slope, rest = np.polyfit(added, [1 / value for value, _ in found], 1)
        for k, more, (value, _) in zip(STIFFNESSES, added, found):
            rows.append((dip, seed, f"{k / 1e12:g}", f"{value / whole:.3f}", f"{1 / (1 + more * whole):.3f}", f"{slope:.3f}",
                         f"{1 - rest * whole:.3f}"))
    return rows


def cracked(seed, whole):
    rows = []
    for density in CRACKS:
        joint = (f"name: set, dip: 0, radius: {HALF}, network: {{intensity: {2 * density / HALF} 1/m, fisher: 0}}, normal_stiffness: {STIFFNESSES[1]}, "
                 f"shear_stiffness: {STIFFNESSES[1] / 2}")
        value, length = modulus(f"cracks-{density}", [joint], seed, False)
        there = length * HALF / 2
        rows.append((f"{there:.3f}", seed, f"{value / whole:.3f}", f"{1 / (1 + math.pi * there):.3f}", f"{math.exp(-math.pi * there):.3f}"))
    return rows


def block(seeds):
    whole = {inner: {seed: modulus("whole", [], seed, inner)[0] for seed in seeds} for inner in (True, False)}
    study.put_table("joints.md", "through", ("dip, deg", "packing", "k_n, TPa/m", "E over that of the rock", "Amadei & Goodman",
                                             "added compliance over theirs", "compliance of rock that is gone"),
                    sorted(row for seed in seeds for row in persistent(seed, whole[True][seed])), QUICK)
    study.put_table("joints.md", "cracks", ("N a^2/A", "packing", "E over that of the rock", "no interaction", "differential scheme"),
                    sorted(row for seed in seeds for row in cracked(seed, whole[False][seed])), QUICK)


# --- one joint in one packing, by two programs ---

EDGE, STIFF = 0.01, {"normal": 1e11, "shear": 5e10, "cohesion": 1e6, "tension": 2e5, "friction": FRICTION, "dilation": 0}
CLOSING, PUSHING = ((0, 0, -0.1), 1000), ((0.5, 0, 0), 2000)  # m/s and steps of 0.1 us: a closure of 10 um, then a path of 100 um
SHEARED = """title: Direct shear of a joint between two held halves
dimension: 3
specimen:
  box: {{size: [10 mm, 10 mm, 10 mm]}}
  particles: 600
materials: [{{name: rock, density: 2600 kg/m3, contact_modulus: 20 GPa, kratio: 2.5, friction: 0.5, tensile_strength: 1 TPa, shear_strength: 1 TPa}}]
law: {{stiffness: harmonic}}
bonds: {{interaction_range: 0.05}}
joints:
  - {{name: plane, point: [5 mm, 5 mm, 5 mm], normal: [0, 0, 1], normal_stiffness: {normal}, shear_stiffness: {shear}, cohesion: {cohesion},
     tensile_strength: {tension}, friction: {slope}, dilation: {rise}}}
sets:
  - {{name: below, select: {{box: {{min: [-1, -1, -1], max: [1, 1, 5 mm]}}}}, motion: {{vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}}}
  - {{name: above, select: {{box: {{min: [-1, -1, 5 mm], max: [1, 1, 1]}}}},
     motion: {{vx: [[0.1 ms, 0], [0.1001 ms, 0.5]], vy: 0, vz: [[0.1 ms, -0.1], [0.1001 ms, 0]], wx: 0, wy: 0, wz: 0}}}}
time: {{step: 100 ns, end: 0.3 ms}}
output: {{history_rows: 1500, snapshots: 0}}
"""


def by_yade(spheres, joint):
    """Normal and shear force in N, every two steps."""
    out = study.RUNS / "joints" / f"yade-{joint['dilation']:g}.json"
    if not out.exists() or study.FRESH:
        job = {"spheres": spheres.tolist(), "joint": joint, "plane": EDGE / 2, "reach": 1.05, "dt": 1e-7, "every": 2, "paths": [CLOSING, PUSHING],
               "out": str(out)}
        subprocess.run(["yade", "-n", "-x", str(study.ROOT / "validate" / "peers" / "yade_joint.py")], env={**os.environ, "JOB": json.dumps(job)},
                       check=True, capture_output=True)
    return np.array(json.loads(out.read_text()))[:, 1:].T


def marks(normal, shear):
    """Normal stress after the closure, Pa; slope of the shear stress over the path, Pa/m; peak, Pa; shear over normal force at the end; slope of the normal
    stress over the path behind the peak, Pa/m."""
    closed, path = len(normal) // 3, np.arange(1, len(normal) * 2 // 3 + 1) * 1e-7
    normal, shear = normal / EDGE ** 2, shear / EDGE ** 2
    pushed, pressed = shear[closed:], normal[closed:]
    rise = slice(25, 200)
    return (normal[closed - 1], np.polyfit(path[rise], pushed[rise], 1)[0], pushed.max(), pushed[-1] / pressed[-1],
            np.polyfit(path[-500:], pressed[-500:], 1)[0])


def beside_yade():
    rows = []
    for dilation in (0, 0.1):
        joint, mu, ratio = {**STIFF, "dilation": math.atan(dilation)}, math.tan(FRICTION), STIFF["normal"] / STIFF["shear"]
        text = SHEARED.format(**joint, slope=mu, rise=dilation)
        run = study.run(f"joints/held-{dilation}", scene_file(f"held-{dilation}", text), {})
        place = run.results("particles/position") - run.results("particles/displacement")
        spheres = np.column_stack([place, run.results("particles/radius")])
        times = np.arange(1, 1501) * 2e-7
        ours = marks(*(np.interp(times, run.results("history/time"), run.results(f"history/joint_plane_{name}")) for name in ("normal", "shear")))
        theirs = marks(*by_yade(spheres, joint))
        sigma = STIFF["normal"] * 1e-5
        wanted = (sigma, STIFF["shear"], STIFF["cohesion"] + mu * sigma, mu, STIFF["normal"] * dilation / (1 + mu * ratio * dilation))
        names = ("normal stress, MPa", "slope of the shear stress, GPa/m", "peak, MPa", "shear over normal force", "slope of the normal stress, GPa/m")
        for name, unit, values in zip(names, (1e6, 1e9, 1e6, 1, 1e9), zip(wanted, ours, theirs)):
            rows.append((dilation, name, *(f"{value / unit:.4f}" for value in values)))
    study.put_table("joints.md", "yade", ("tan(dilation)", "reading", "closed form", "gneiss", "YADE"), rows, QUICK)


# --- time ---

LATTICE = """title: Lattice in which half of the contacts are across joints
dimension: 3
specimen: {{lattice: {{kind: hcp, radius: 1 mm, cells: [16, 10, 15]}}}}
materials: [{{name: rock, density: 2500 kg/m3, contact_modulus: 10 GPa, kratio: 2, friction: 0.5, tensile_strength: 1 TPa, shear_strength: 1 TPa}}]
law: {{stiffness: harmonic}}
bonds: {{interaction_range: 0.05}}
gravity: [3, 0, -9.81]
damping: {{background: {{model: nonviscous_vector, coefficient: 0.7}}}}
sets: [{{name: floor, select: {{box: {{min: [-1, -1, -1], max: [1, 1, 2.1 mm]}}}}, motion: {{vx: 0, vy: 0, vz: 0}}}}]
time: {{step: 100 ns, end: 60 us}}
output: {{history_rows: 2, snapshots: 0}}
{joints}"""
LAYERS, STATES = 30, (("none", None), ("intact", "cohesion: 1 TPa, tensile_strength: 1 TPa"), ("broken, held by friction", "friction: 0.5"),
                      ("broken, sliding", "friction: 0"))


def lattice(state):
    if not state:
        return LATTICE.format(joints="")
    height = 0.002 * math.sqrt(2 / 3)
    planes = [f"  - {{name: j{k}, point: [0, 0, {0.001 + height * (k + 0.5)}], normal: [0, 0, 1], normal_stiffness: 2 TPa/m, "
              f"shear_stiffness: 1 TPa/m, {state}}}\n" for k in range(LAYERS - 1)]
    return LATTICE.format(joints="joints:\n" + "".join(planes))


def cost(turns):
    """Least times of the turns, on one thread; a run of each kind in each turn. The least is the one that other load has disturbed least."""
    found = {name: [] for name, _ in STATES}
    for turn in range(turns):
        for k, (name, state) in enumerate(STATES):
            run = study.run(f"joints/cost-{k}-{turn}", scene_file(f"cost-{k}", lattice(state)), {"run.threads": 1})
            seconds = run.summary["seconds"]
            found[name].append((seconds["bonds"], seconds["bonds"] + seconds["motion"] + seconds["walls"], run.bonds))
    of_bonds, of_step, bonds = np.min(found["none"], axis=0)
    rows = []
    for name, _ in STATES[1:]:
        contacts, step, left = np.min(found[name], axis=0)
        rows.append((name, f"{(bonds - left) / bonds:.3f}", f"{step / of_step:.2f}", f"{(contacts / of_bonds - left / bonds) / (1 - left / bonds):.2f}"))
    study.put_table("joints.md", "cost", ("joints", "part of the contacts", "step over a step without joints", "contact over a bond"), rows, QUICK)


if __name__ == "__main__":
    parts_of_page = {"--rough": lambda: roughness(chosen), "--plane": lambda: plane(chosen), "--block": lambda: block(chosen),
                     "--yade": beside_yade, "--cost": lambda: cost(1 if QUICK else 5)}
    study.reported(sys.argv[1:], __doc__, ("--fresh", "--kept", "--quick", *parts_of_page, "--help", "-h"))
    chosen = SEEDS[:1] if QUICK else SEEDS
    for flag, part in parts_of_page.items():
        if flag in sys.argv or not set(parts_of_page) & set(sys.argv):
            part()
