"""A notched beam of particles, with fixed zones, of elements that turn into particles, and of elements alone: docs/evidence/coupling.md. A few minutes.

    /usr/bin/python3 validate/conversion_study.py [--fresh]
"""
import sys

import numpy as np

import coupling_study
import meshes
import study

ADAPTIVE = "scenes/bending-adaptive.yaml"
PICTURE = study.ROOT / "docs" / "evidence" / "pictures" / "coupling-beam.png"
MESH = study.ROOT / "scenes" / "specimens" / "beam-notched.msh"
LIMITS, WIDTHS = ("1.0 MPa", "1.5 MPa", "2.0 MPa"), ("14 mm", "24 mm")


def places(start, sizes):
    return np.round(start + np.concatenate([[0.0], np.cumsum(sizes)]), 9)


def mesh():
    """The mesh of the scene, in mm: cells of 2 mm over the notch's width and at its tip, growing away from it; supports at 20 and 420 mm."""
    half = [10, 10, *[151.5 / 13] * 13, 12, 10, 8, 6, 4.5, 3, 2, 2]
    x = places(0, [*half, 2, *half[::-1]])
    y = places(0, [7, 7, 6, 5, 3, 2, 2, 3, 5, 6, 7, 7, *[8] * 5])
    number = np.arange(1, len(x) * len(y) + 1).reshape(len(y), len(x))
    cells = meshes.triangles(number, lambda r, c: not (x[c] > 218.5 and x[c + 1] < 221.5 and y[r + 1] < 30.5))
    feet = {f"support_{side}": number[0, int(np.argmin(abs(x - at)))] for side, at in (("left", 20), ("right", 420))}
    meshes.write(MESH, [(at, up) for up in y for at in x], cells, feet)


def runs():
    """Name and run; all use the packing of the first."""
    alone, fixed = coupling_study.beams()
    found = [("particles alone", alone), ("fixed zones", fixed)]
    for width in WIDTHS:
        for limit in LIMITS:
            name = f"coupling/adaptive-{limit.split()[0]}-{width.split()[0]}"
            found.append((f"adaptive, {limit}, {width}", study.run(name, ADAPTIVE, {"couple.convert.stress": limit, "couple.convert.width": width})))
    found.append((NEVER, study.run("coupling/adaptive-never", ADAPTIVE, {"couple.convert.stress": "1 TPa", "time.end": "15 ms"})))
    return found


def curve(result):
    return result.results("history/deflection"), result.results("history/force")


def stiffness(result, top):
    """Stiffness in MN/m, from 5 to 50 % of `top` (N) of the rising branch."""
    bend, force = curve(result)
    last = int(np.argmax(force > 0.5 * top))
    part = np.arange(len(force)) < last
    part &= force > 0.05 * top
    return np.polyfit(bend[part], force[part], 1)[0] / 1e6


def counts(result):
    """Particles and elements at the start and at the end."""
    try:
        return [f"{int(h[0])} to {int(h[-1])}" for h in (result.results(f"history/{name}") for name in ("particles", "elements"))]
    except KeyError:
        groups = [len(result.results("particles/radius"))]
        try:
            groups.append(len(result.results("elements/material")))
        except KeyError:
            groups.append(0)
        return groups


NEVER = "elements alone"


def apart(cracked, broke):
    """Mean distance of the bonds broken in one run from the nearest broken in another, m."""
    return np.mean([np.min(np.linalg.norm(broke - at, axis=1)) for at in cracked])


def head(unit):
    return ["", "particles", "elements", "stiffness, MN/m", f"peak, {unit}", "off, %", "deflection there, um", "opening there, um", "bonds broken",
            "from the crack of particles alone, mm", "residual, %", "s of a core", "times cheaper"]


def lines(found, unit="kN"):
    """A line of the table for each of (name, run), compared with the first, which has particles only."""
    alone = found[0][1]
    scale, digits = (1e3, 0) if unit == "kN" else (1.0, 2)
    top, seconds, broke = np.max(curve(alone)[1]), alone.summary["seconds"]["cpu"], coupling_study.crack(alone)
    rows = []
    for name, result in found:
        bend, force = curve(result)
        peak = int(np.argmax(force))
        row = [name, *counts(result), f"{stiffness(result, top):.{digits}f}"]
        if name == NEVER:
            row += ["-"] * 6
        else:
            cracked = coupling_study.crack(result)
            row += [f"{force[peak] / scale:.{2 if scale > 1 else 1}f}", f"{100 * (force[peak] / top - 1):+.1f}", f"{1e6 * bend[peak]:.1f}",
                    f"{1e6 * result.results('history/opening')[peak]:.1f}", len(cracked), f"{1e3 * apart(cracked, broke):.1f}" if len(cracked) else "-"]
        cost = result.summary["seconds"]["cpu"]
        rows.append([*row, f"{100 * result.residual:.3f}", f"{cost:.1f}", f"{seconds / cost:.1f}" if name != NEVER else "-"])
    return rows


def table(found):
    return study.table(head("kN"), lines(found))


def panels(axes, found, unit, bends, openings, most):
    """Plots the load over the deflection and over the opening, up to the given limits in um and units of load."""
    for name, result in found:
        bend, force = curve(result)
        opening = result.results("history/opening")
        for axis, at, end in ((axes[0], bend, bends), (axes[1], opening, openings)):
            shown = (bend < 1e-6 * bends) & (at < 1e-6 * end)
            axis.plot(1e6 * at[shown], force[shown] / (1e3 if unit == "kN" else 1), label=name, linewidth=1, linestyle="--" if name == NEVER else "-")
    axes[0].set(xlabel="deflection, um", ylabel=f"load, {unit}", ylim=(-0.03 * most, most))
    axes[1].set(xlabel="opening of the notch's mouth, um")
    axes[0].legend(loc="upper left", fontsize=8)


def draw(found):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True, constrained_layout=True)
    panels(axes, found, "kN", 45, 30, 30)
    figure.savefig(PICTURE, dpi=110)


MOTION = "[[0 ms, 0 m/s], [1 ms, -10 mm/s]]"
FAST = {"time.end": "8 ms", "damping.background.coefficient": "2000 1/s"}


def fast(name, **more):
    """Particles only and one of the adaptive runs, with five times the loading speed."""
    alone = study.run(f"coupling/beam-particles-{name}", "scenes/bending-particles.yaml", {"sets.load.motion.vy": MOTION, **FAST, **more})
    found = [("particles alone", alone)]
    for limit in LIMITS[:1 if more else 3]:
        settings = {"couple.convert.stress": limit, "couple.convert.width": WIDTHS[0], "elements.motions.load.motion.vy": MOTION, **FAST, **more}
        found.append((f"adaptive, {limit}, {WIDTHS[0]}", study.run(f"coupling/adaptive-{name}-{limit.split()[0]}", ADAPTIVE, settings)))
    return table(found)


FINE = {"specimen.mean_radius": "0.5 mm"}
VARIED = {"": {}, ", steps of 0.89": {"time.safety": 0.89}, ", of 0.88": {"time.safety": 0.88}, ", packing 2": {"run.seed": 2}, ", packing 3": {"run.seed": 3},
          ", packing 3, steps of 0.89": {"run.seed": 3, "time.safety": 0.89}, ", packing 3, of 0.88": {"run.seed": 3, "time.safety": 0.88}}


def fine_pairs():
    """Name, run with particles only, and adaptive run, with particles of half the size and the slow load: other
    packings and other rounding."""
    found = []
    for name, more in VARIED.items():
        note = "-".join(["slow", *(str(value) for value in more.values())])
        settings = {**FINE, **more}
        alone = study.run(f"coupling/beam-particles-fine-{note}", "scenes/bending-particles.yaml", settings)
        adaptive = study.run(f"coupling/adaptive-fine-{note}", ADAPTIVE, {**settings, "couple.convert.stress": LIMITS[0], "couple.convert.width": WIDTHS[0]})
        found.append((name, alone, adaptive))
    return found


def fine_table(pairs):
    """Compares each adaptive run with particles only, for the same packing and the same fraction of the limit of the
    step."""
    rows = [line for name, alone, adaptive in pairs
            for line in lines([(f"particles alone{name}", alone), (f"adaptive, {LIMITS[0]}, {WIDTHS[0]}{name}", adaptive)])]
    return study.table(head("kN"), rows)


def main():
    if "--mesh" in sys.argv:
        return mesh()
    found = runs()
    draw(found)
    study.put("coupling.md", "table adaptive", table(found))
    study.put("coupling.md", "table fast", fast("fast"))
    study.put("coupling.md", "table fine", fast("fine", **FINE))
    study.put("coupling.md", "table fine slow", fine_table(fine_pairs()))


if __name__ == "__main__":
    main()
