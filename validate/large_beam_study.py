"""A notched beam of 1 x 0.25 x 0.1 m of tetrahedra which turn into spheres of 1 mm where it cracks: docs/evidence/coupling.md.

    /usr/bin/python3 validate/large_beam_study.py [--radius 0.5] [--fresh]

Radii in mm. Only 0.5 writes the page; 2 takes some minutes.
"""
import json
import re
import sys

import numpy as np

import meshes
import study

FOLDER = study.RUNS / "large-beam"
PICTURE = study.ROOT / "docs" / "evidence" / "pictures" / "coupling-large.png"
SMALLEST = 0.5e-3  # m, mean radius
LENGTH, HEIGHT, BREADTH, SPAN, NOTCH, SLOT, CELL = 1.0, 0.25, 0.1, 0.9, 0.075, 0.004, 0.012  # m
SIDE, LOW, TOP = 0.03, 0.045, 0.215  # m: half the length and the heights of the part that is packed


def region():
    """Closed surface of the region to be packed: a prism around the notch, without the notch."""
    mid, half = 0.5 * LENGTH, 0.5 * SLOT
    left = [(mid - SIDE, LOW), (mid - half, LOW), (mid - half, NOTCH), (mid - SIDE, NOTCH)]
    outline = [left[0], left[1], left[2], (mid + half, NOTCH), (mid + half, LOW), (mid + SIDE, LOW), (mid + SIDE, NOTCH), (mid + SIDE, TOP),
               (mid - SIDE, TOP), left[3]]
    faces = [(0, 1, 2), (0, 2, 9), (4, 5, 6), (4, 6, 3), (9, 2, 8), (2, 3, 8), (3, 7, 8), (3, 6, 7)]
    FOLDER.mkdir(parents=True, exist_ok=True)
    return meshes.prism(FOLDER / "region.stl", outline, faces, BREADTH)


def scene(radius):
    mid = 0.5 * LENGTH
    return {"dimension": 3,
            "specimen": {"group": 1, "surface": region(), "mean_radius": radius, "material": "concrete", "density_basis": "bulk",
                         "packing": {"overlap": "passive", "size_variation": 0.1}},
            "materials": [{"name": "concrete", "density": 2400, "contact_modulus": 19.1e9, "kratio": 3, "friction": 0.5, "tensile_strength": 2.7e6,
                           "shear_strength": 8.1e6}],
            "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.1, "passive_gaps": True},
            "elements": {"beam": {"length": LENGTH, "height": HEIGHT, "thickness": BREADTH, "span": SPAN, "notch_depth": NOTCH, "notch_width": SLOT,
                                  "cell": CELL},
                         "materials": [{"young": 30e9, "poisson": 0.16, "density": 2400}],
                         "motions": [{"name": "left", "group": "support_left", "motion": {"vx": 0, "vy": 0, "vz": 0}},
                                     {"name": "right", "group": "support_right", "motion": {"vy": 0}},
                                     {"name": "load", "group": "load", "motion": {"vy": [[0, 0], [1e-3, -6e-3]]}},
                                     {"name": "mouth_left", "group": "mouth_left"}, {"name": "mouth_right", "group": "mouth_right"}]},
            "couple": {"convert": {"box": {"min": [mid - SIDE, LOW, -1e-3], "max": [mid + SIDE, TOP, BREADTH + 1e-3]}, "width": 0.012, "stress": 2e6,
                                   "every": 50}},
            "damping": {"background": {"model": "viscous", "coefficient": 400}},
            "test": {"kind": "bending", "axis": "y", "lower": ["left", "right"], "upper": "load", "span": SPAN, "height": HEIGHT, "notch": NOTCH,
                     "opening": {"axis": "x", "lower": "mouth_left", "upper": "mouth_right"}},
            "time": {"end": 6e-3, "stop": {"peak_drop": 0.4}}, "run": {"seed": 1}}


def written(radius):
    text = json.dumps(scene(radius), indent=1)
    path = FOLDER / f"beam-{1e3 * radius:g}.yaml"
    path.write_text(text)
    return path


def beam(radius):
    return study.run(f"large-beam/beam-{1e3 * radius:g}", written(radius), {"output.history_rows": 300, "output.snapshots": 2})


# --- cost of particles alone --------------------------------------------------------------------------------------

COARSE = 4e-3  # m: a box of these spheres is planned; number and step scale exactly


def alone(radius):
    """Particles, bonds, bytes, step and seconds of one thread a step of the whole beam as particles, by `gneiss plan`."""
    whole = scene(COARSE)
    for key in ("elements", "couple", "test"):
        del whole[key]
    del whole["specimen"]["surface"]
    whole["specimen"]["box"] = {"size": [LENGTH, HEIGHT, BREADTH]}
    whole["time"]["stop"] = "none"
    path = FOLDER / "alone.yaml"
    path.write_text(json.dumps(whole, indent=1))
    done = study.call(["plan", str(path), "--threads", "1"])
    if done.returncode != 0:
        sys.exit(done.stderr)
    more = (COARSE / radius)**3
    number = {name: float(re.search(pattern, done.stdout).group(1)) for name, pattern in (
        ("particles", r"\n  particles +(\d+) x"), ("bonds", r"\n  bonds +(\d+) x"), ("megabytes", r"in all ([\d.]+) MB"), ("dt", r"\n  dt +(\S+) s"), ("step", r"per step +(\S+) us"))}
    return {"particles": more * number["particles"], "bonds": more * number["bonds"], "bytes": 1e6 * more * number["megabytes"],
            "dt": number["dt"] * radius / COARSE, "step": 1e-6 * more * number["step"]}


# --- tables and picture -------------------------------------------------------------------------------------------

def moments(run):
    """Rows of the history: the first conversion, the peak, the end."""
    h = {name: run.results(f"history/{name}") for name in COLUMNS}
    first, peak, last = int(np.argmax(h["particles"] > 0)), int(np.argmax(h["force"])), len(h["force"]) - 1
    return [(name, {key: value[k] for key, value in h.items()}) for name, k in (("first conversion", first), ("largest load", peak), ("end", last))]


COLUMNS = ("time", "step", "force", "deflection", "opening", "particles", "elements", "broken_tension", "broken_shear")


def beam_table(runs):
    rows = []
    for radius, run in runs:
        for name, h in moments(run):
            rows.append([f"{1e3 * radius:g}", name, f"{1e3 * h['time']:.3f}", f"{int(h['step'])}", f"{h['force'] / 1e3:.3f}", f"{1e6 * h['deflection']:.1f}",
                         f"{1e6 * h['opening']:.1f}", f"{int(h['particles'])}", f"{int(h['elements'])}", f"{int(h['broken_tension'] + h['broken_shear'])}"])
    return study.table(["r, mm", "", "time, ms", "steps", "load, kN", "deflection, um", "opening, um", "particles", "elements", "bonds broken"], rows)


def cost_table(runs):
    rows = []
    for radius, run in runs:
        seconds, counts, lone = run.summary["seconds"], run.summary["counts"], alone(radius)
        rows.append([f"{1e3 * radius:g}", counts["particles"], f"{run.summary['steps']}", f"{run.summary['dt']:.3g}", f"{seconds['total']:.0f}",
                     f"{seconds['cpu']:.0f}", f"{seconds['conversion']:.0f}", f"{100 * run.residual:.1g}", f"{run.summary['peak_memory'] / 1e9:.1f}",
                     f"{lone['particles'] / 1e6:.2f}", f"{lone['bonds'] / 1e6:.1f}", f"{lone['bytes'] / 1e9:.1f}", f"{lone['dt']:.3g}",
                     f"{lone['step'] * moments(run)[-1][1]['time'] / lone['dt'] / 3600:.0f}"])
    return study.table(["r, mm", "packed", "steps", "last step, s", "wall s", "s of cores", "of it conversion, wall s", "residual, %", "GB",
                        "particles alone, million", "their bonds, million", "their GB", "their step, s",
                        "their hours, one thread"], rows)


def cut(nodes, tetrahedra, z):
    """Polygons in which a plane of constant z cuts tetrahedra, and the mean of their corners' numbers for colours."""
    polygons, owners = [], []
    for k, corners in enumerate(tetrahedra):
        x = nodes[corners]
        points = []
        for a in range(4):
            for b in range(a):
                da, db = x[a, 2] - z, x[b, 2] - z
                if da * db < 0:
                    points.append(x[a, :2] + (x[b, :2] - x[a, :2]) * da / (da - db))
        if len(points) < 3:
            continue
        points = np.array(points)
        around = points - points.mean(axis=0)
        polygons.append(points[np.argsort(np.arctan2(around[:, 1], around[:, 0]))])
        owners.append(k)
    return polygons, owners


MAGNIFIED, Z = 100, 0.0487  # displacements in the picture; m: where it is cut, between planes of nodes


def draw_cut(axes, run, figure):
    from matplotlib.collections import EllipseCollection, PolyCollection

    low, high = (0.5 * LENGTH - 0.06, 0.03), (0.5 * LENGTH + 0.06, HEIGHT)
    d, x = run.results("particles/displacement"), run.results("particles/position")
    radius, active = run.results("particles/radius"), run.results("particles/asleep") == 0
    shown = active & (np.abs(x[:, 2] - Z) < 0.5 * radius.mean())
    nd, nx, tetrahedra = run.results("nodes/displacement"), run.results("nodes/position"), run.results("elements/node")
    nx = nx - nd
    middle = nx[tetrahedra].mean(axis=1)
    near = np.all((middle[:, :2] > low) & (middle[:, :2] < high), axis=1)
    near &= (nx[tetrahedra][:, :, 2].min(axis=1) < Z) & (nx[tetrahedra][:, :, 2].max(axis=1) > Z)
    tetrahedra = tetrahedra[near]
    moved = nx + np.array([MAGNIFIED, MAGNIFIED, 0.0]) * nd
    polygons, owners = cut(moved, tetrahedra, Z)
    along = 1e6 * nd[tetrahedra[owners]][:, :, 0].mean(axis=1)
    span = tuple(np.percentile(along, (1, 99)))
    axes.add_collection(PolyCollection([1e3 * p for p in polygons], array=along, cmap="coolwarm", edgecolors="0.35", linewidths=0.3, clim=span))
    places = 1e3 * (x - d + MAGNIFIED * d)[shown, :2]
    size = 2e3 * radius[shown]
    balls = EllipseCollection(size, size, np.zeros(len(size)), units="xy", offsets=places, offset_transform=axes.transData, array=1e6 * d[shown, 0],
                              cmap="coolwarm", edgecolors="k", linewidths=0.05, clim=span)
    axes.add_collection(balls)
    figure.colorbar(balls, ax=axes, label="displacement along the beam, um", shrink=0.7)
    axes.set(xlim=(1e3 * low[0], 1e3 * high[0]), ylim=(1e3 * low[1], 1e3 * high[1]), aspect="equal", xlabel="x, mm", ylabel="y, mm",
             title=f"cut at mid-breadth, displacements x {MAGNIFIED}")


def draw_crack(axes, run, figure):
    """Broken bonds, seen along the beam."""
    y, z, t = (run.results(f"events/{name}") for name in ("y", "z", "time"))
    dots = axes.scatter(1e3 * z, 1e3 * y, c=1e3 * t, s=1.0, cmap="viridis")
    figure.colorbar(dots, ax=axes, label="broken at, ms", shrink=0.7)
    axes.axhline(1e3 * NOTCH, color="k", linewidth=0.8)
    axes.set(xlim=(0, 1e3 * BREADTH), ylim=(60, 1e3 * HEIGHT), aspect="equal", xlabel="z, mm", ylabel="y, mm", title="broken bonds, seen along the beam")


def draw(run, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(12, 11), constrained_layout=True)
    h = {name: run.results(f"history/{name}") for name in COLUMNS}
    axes[0, 0].plot(1e6 * h["deflection"], h["force"] / 1e3, linewidth=1, label="over the deflection")
    axes[0, 0].plot(1e6 * h["opening"], h["force"] / 1e3, linewidth=1, label="over the opening of the notch's mouth")
    axes[0, 0].set(xlabel="um", ylabel="load, kN")
    axes[0, 0].legend(fontsize=8)
    axes[0, 1].plot(1e3 * h["time"], h["particles"] / 1e3, linewidth=1, label="active particles")
    axes[0, 1].plot(1e3 * h["time"], h["elements"] / 1e3, linewidth=1, label="elements")
    axes[0, 1].plot(1e3 * h["time"], (h["broken_tension"] + h["broken_shear"]) / 1e3, linewidth=1, label="bonds broken")
    axes[0, 1].set(xlabel="time, ms", ylabel="thousand")
    axes[0, 1].legend(fontsize=8)
    draw_cut(axes[1, 0], run, figure)
    draw_crack(axes[1, 1], run, figure)
    figure.savefig(path, dpi=100, metadata={"Software": None})


def main():
    radius = 1e-3 * float(sys.argv[sys.argv.index("--radius") + 1]) if "--radius" in sys.argv else SMALLEST
    if "--scene" in sys.argv:
        return print(written(radius))
    runs = [(radius, beam(radius))]
    print(beam_table(runs), "\n\n", cost_table(runs), sep="")
    draw(runs[0][1], PICTURE if radius == SMALLEST else FOLDER / f"beam-{1e3 * radius:g}.png")
    if radius == SMALLEST:
        study.put("coupling.md", "table large", beam_table(runs))
        study.put("coupling.md", "table large cost", cost_table(runs))


if __name__ == "__main__":
    main()
