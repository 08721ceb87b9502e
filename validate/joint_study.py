"""Joints: the strength of a specimen with one weak plane over the dip of the plane, beside the curve of Jaeger (1960), and the stiffness of a block
with many joints beside Amadei & Goodman (1981) and estimates for cracks (Kachanov 1992). Fills docs/evidence/joints.md.

    /usr/bin/python3 validate/joint_study.py [--fresh] [--kept] [--quick] [--rough] [--plane] [--block]
"""
import math
import re
import sys

import numpy as np

import study

PLANE = "scenes/joint-plane.yaml"
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
DIPS = {2e6: (0, 20, 40, 50, 60, 70), 0: (40, 50, 60, 70)}  # degrees, by cohesion
SEEDS = (1, 2, 3)
SIGMA, FRICTION = 2e6, math.radians(30)
QUICK = "--quick" in sys.argv


def jaeger(dip, cohesion):
    """The axial stress in Pa at which a plane at `dip` degrees slides: sigma_3 + 2 (c + sigma_3 tan(phi))/((1 - tan(phi)/tan(dip)) sin(2 dip))."""
    angle, tangent = math.radians(dip), math.tan(FRICTION)
    if math.tan(angle) <= tangent or dip == 90:
        return math.inf
    return SIGMA + 2 * (cohesion + SIGMA * tangent) / ((1 - tangent / math.tan(angle)) * math.sin(2 * angle))


def strength(dip, cohesion, seed):
    name = f"joints/plane-{dip}-{cohesion:g}-{seed}"
    return study.run(name, PLANE, {"joints.plane.dip": f"{dip} deg", "joints.plane.cohesion": cohesion, "run.seed": seed,
                                   "joints.plane.tensile_strength": cohesion / 2, "output.contacts": "off"}).peak_stress


def curve(cohesion, seeds):
    """Rows (dip, Jaeger's strength, strengths of the packings)."""
    rows, missing = [], []
    for dip in DIPS[cohesion]:
        found = [study.if_there(strength, dip, cohesion, seed) for seed in seeds]
        if None in found:
            missing.append(f"{dip} deg")
        else:
            rows.append((dip, jaeger(dip, cohesion), np.array(found)))
    return rows, missing


def draw(curves):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(6, 3.6))
    for (rows, _), cohesion, colour in zip(curves, DIPS, ("tab:blue", "tab:orange")):
        fine = np.linspace(31, 89.5, 300)
        axes.plot(fine, [jaeger(d, cohesion) / 1e6 for d in fine], color=colour, label=f"Jaeger, c = {cohesion / 1e6:g} MPa")
        for dip, _, found in rows:
            axes.plot([dip] * len(found), found / 1e6, "o", color=colour, markersize=4)
    axes.set(xlabel="dip of the plane, degrees", ylabel="strength, MPa", ylim=(0, 60), xlim=(-3, 93))
    axes.legend()
    study.save(figure, PICTURES, "joints-jaeger")


def plane(seeds):
    curves = [curve(cohesion, seeds) for cohesion in DIPS]
    rows, missing = [], []
    for (found, gone), cohesion in zip(curves, DIPS):
        missing += gone
        for dip, wanted, values in found:
            mean, scatter = values.mean(), values.std(ddof=1) if len(values) > 1 else math.nan
            rows.append((f"{cohesion / 1e6:g} MPa", dip, "none" if math.isinf(wanted) else f"{wanted / 1e6:.2f}",
                         f"{mean / 1e6:.2f}", f"{scatter / 1e6:.2f}", "" if math.isinf(wanted) else f"{mean / wanted - 1:+.1%}"))
    study.put_table("joints.md", "jaeger", ("cohesion", "dip, deg", "Jaeger, MPa", "mean of the packings, MPa", "scatter, MPa", "difference"),
                    rows, QUICK, missing)
    if not QUICK and not missing:
        draw(curves)


# --- a smooth joint and a plane without bonds ---

SHEAR = "scenes/joint-shear.yaml"


def sheared(kind, seed):
    """Shear over normal force (mean and standard deviation) and rise of the upper half in m, over the last half of a path of 2 mm."""
    text = (study.ROOT / SHEAR).read_text().replace("100 mm/s", "500 mm/s")
    head, _, rest = text.partition("joints:\n")
    joint, _, tail = rest.partition("damping:")
    if kind == "rough":
        text = head + "damping:" + tail.replace("max: [1, 1]}}, force", "max: [1, 1]}}, group: 2, force")
    else:
        text = head + "joints:\n" + re.sub(r"    (bond_friction|cohesion|tensile_strength|dilation|dilation_end):.*\n", "", joint) + "damping:" + tail
    path = study.RUNS / "joints" / f"shear-{kind}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    run = study.run(f"joints/shear-{kind}-{seed}", path, {"run.seed": seed, "output.contacts": "off"})
    force = run.results("history/set_above_reaction_x")
    late = force[len(force) // 2:] / 60e3
    return float(late.mean()), float(late.std()), float(np.median(run.results("particles/displacement")[:, 1]) * 2)


def roughness(seeds):
    rows = []
    for kind, name in (("smooth", "smooth joint, friction 0.5"), ("rough", "no bonds, friction of particles 0.5")):
        found = np.array([sheared(kind, seed) for seed in seeds])
        for seed, (mean, deviation, rise) in zip(seeds, found):
            rows.append((name, seed, f"{mean:.4f}", f"{deviation:.4f}", f"{1e3 * rise:.3f}"))
    study.put_table("joints.md", "roughness", ("plane", "packing", "shear over normal force", "its standard deviation in time", "rise, mm"), rows, QUICK)


# --- stiffness of a block with many joints ---

SIDE, DISCS = 0.06, 3000  # m; discs of about 0.6 mm
BLOCK = """title: Square with joints in tension
dimension: 2
specimen:
  rectangle: {{width: 60 mm, height: 60 mm}}
  particles: {discs}
  packing: {{size_ratio: 2}}
materials:
  - {{name: rock, density: 2600 kg/m3, contact_modulus: 20 GPa, kratio: 2.5, friction: 0, tensile_strength: 1 TPa, shear_strength: 1 TPa}}
law: {{stiffness: harmonic}}
bonds: {{interaction_range: 0.05}}
{joints}
damping: {{background: {{model: nonviscous_vector, coefficient: 0.7}}}}
sets:
  - {{name: below, select: {{end: {{axis: y, side: lower, depth: 1 mm}}}}, motion: {{vy: [[0, 0], [0.5 ms, -5 mm/s]]}}}}
  - {{name: above, select: {{end: {{axis: y, side: upper, depth: 1 mm}}}}, motion: {{vy: [[0, 0], [0.5 ms, 5 mm/s]]}}}}
test: {{kind: tension, axis: y, lower: below, upper: above, length: 60 mm, diameter: 60 mm}}
time: {{end: 2 ms}}
output: {{history_rows: 200, snapshots: 0}}
"""
NORMAL, SHEAR = 4e12, 2e12  # Pa/m
PERSISTENT, LINES = (0, 30, 45), 100  # degrees; m of line per m2
CRACKS, HALF = (0.1, 0.2, 0.3), 0.006  # densities N a^2/A; a in m


def modulus(name, joints, seed):
    """The slope of the stress over the strain along the axis in the second half of the run, Pa, and m of joint per m2."""
    path = study.RUNS / "joints" / f"{name}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(BLOCK.format(discs=DISCS, joints=f"joints:\n  - {{name: set, {joints}}}\n" if joints else ""))
    run = study.run(f"joints/{name}-{seed}", path, {"run.seed": seed})
    stress, strain = run.results("history/stress_yy"), run.results("history/strain_yy")
    late = slice(len(stress) // 2, None)
    area = run.results("history/joint_set_area")[0] / SIDE ** 2 if joints else 0
    return float(np.polyfit(strain[late], stress[late], 1)[0]), float(area)


def amadei(whole, dip, area):
    """Modulus of a rock with one set of through-going joints (Amadei & Goodman 1981): their compliances add up."""
    c, s = math.cos(math.radians(dip)), math.sin(math.radians(dip))
    return 1 / (1 / whole + area * (c ** 4 / NORMAL + s ** 2 * c ** 2 / SHEAR))


def block(seeds):
    rows = []
    for seed in seeds:
        whole, _ = modulus("whole", "", seed)
        for dip in PERSISTENT:
            joints = (f"dip: {dip} deg, radius: 1 m, network: {{intensity: {LINES} 1/m}}, normal_stiffness: {NORMAL}, shear_stiffness: {SHEAR}, "
                      "cohesion: 1 TPa, tensile_strength: 1 TPa")
            found, area = modulus(f"through-{dip}", joints, seed)
            rows.append((f"through-going, {dip} deg", seed, f"{area:.1f} 1/m", f"{found / whole:.3f}", f"{amadei(whole, dip, area) / whole:.3f}", ""))
        for density in CRACKS:
            joints = (f"dip: 0, radius: {HALF}, network: {{intensity: {2 * density / HALF} 1/m, fisher: 0}}, normal_stiffness: {NORMAL}, "
                      f"shear_stiffness: {SHEAR}")
            found, area = modulus(f"cracks-{density}", joints, seed)
            density = area * HALF / 2
            rows.append((f"open cracks, N a^2/A = {density:.3f}", seed, f"{area:.1f} 1/m", f"{found / whole:.3f}",
                         f"{1 / (1 + math.pi * density):.3f}", f"{math.exp(-math.pi * density):.3f}"))
    rows.sort(key=lambda row: (row[0].split(",")[0] != "through-going", row[0].split(" = ")[0], row[0]))
    study.put_table("joints.md", "block", ("joints", "packing", "length per area", "modulus over that of the rock", "closed form",
                                           "differential scheme"), rows, QUICK)


if __name__ == "__main__":
    study.reported(sys.argv[1:], __doc__, ("--fresh", "--kept", "--quick", "--rough", "--plane", "--block", "--help", "-h"))
    chosen = SEEDS[:1] if QUICK else SEEDS
    parts = {"--rough": lambda: roughness(chosen), "--plane": lambda: plane(chosen), "--block": lambda: block(chosen[:2])}
    for flag, part in parts.items():
        if flag in sys.argv or not set(parts) & set(sys.argv):
            part()
