"""Joints: the strength of a specimen with one weak plane over the dip of the plane, beside the curve of Jaeger (1960), and the friction of a
smooth joint beside that of a plane without bonds. Fills docs/evidence/joints.md.

    /usr/bin/python3 validate/joint_study.py [--fresh] [--kept] [--quick] [--rough] [--plane]
"""
import math
import re
import sys

import numpy as np

import study

PLANE = "scenes/joint-plane.yaml"
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
DIPS = {2e6: (0, 20, 40, 50, 60)}  # degrees, by cohesion; steeper planes meet the platens
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
    """The largest axial stress, Pa; a plane that slides by friction alone has no peak."""
    name = f"joints/plane-{dip}-{cohesion:g}-{seed}"
    run = study.run(name, PLANE, {"joints.plane.dip": f"{dip} deg", "joints.plane.cohesion": cohesion, "run.seed": seed,
                                   "joints.plane.tensile_strength": cohesion / 2, "output.contacts": "off"})
    return float(run.results("history/stress").max()) + SIGMA  # the history has the deviator


def curve(cohesion, seeds):
    """Rows (dip, Jaeger's strength, strengths of the packings)."""
    rows, missing = [], []
    for dip in DIPS[cohesion]:
        found = {seed: study.if_there(strength, dip, cohesion, seed) for seed in seeds}
        missing += [f"c = {cohesion / 1e6:g} MPa, {dip} deg, packing {seed}" for seed, value in found.items() if value is None]
        values = [value for value in found.values() if value is not None]
        if values:
            rows.append((dip, jaeger(dip, cohesion), np.array(values)))
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
            mean, scatter = values.mean(), f"{values.std(ddof=1) / 1e6:.2f}" if len(values) > 1 else ""
            rows.append((f"{cohesion / 1e6:g} MPa", dip, "none" if math.isinf(wanted) else f"{wanted / 1e6:.2f}",
                         f"{mean / 1e6:.2f}", scatter, len(values), "" if math.isinf(wanted) else f"{mean / wanted - 1:+.1%}"))
    study.put_table("joints.md", "jaeger", ("cohesion", "dip, deg", "Jaeger, MPa", "measured, MPa", "scatter, MPa", "packings",
                                           "difference"),
                    rows, QUICK, missing)
    if not QUICK and rows:
        draw(curves)


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
    path = study.RUNS / "joints" / f"shear-{kind}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    run = study.run(f"joints/shear-{kind}-{seed}", path, {"run.seed": seed, "output.contacts": "off"})
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


if __name__ == "__main__":
    study.reported(sys.argv[1:], __doc__, ("--fresh", "--kept", "--quick", "--rough", "--plane", "--help", "-h"))
    chosen = SEEDS[:1] if QUICK else SEEDS
    parts = {"--rough": lambda: roughness(chosen), "--plane": lambda: plane(chosen)}
    for flag, part in parts.items():
        if flag in sys.argv or not set(parts) & set(sys.argv):
            part()
