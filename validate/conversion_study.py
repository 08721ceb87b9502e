"""A notched beam of particles, with fixed zones, of elements that turn into particles, and of elements alone: docs/evidence/coupling.md. A few minutes.

    /usr/bin/python3 validate/conversion_study.py [--fresh]
"""
import numpy as np

import coupling_study
import study

WHOLE, ADAPTIVE = "scenes/bending-particles.yaml", "scenes/bending-adaptive.yaml"
PICTURE = study.ROOT / "docs" / "evidence" / "pictures" / "coupling-beam.png"
LIMITS = ("1.2 MPa", "1.5 MPa", "2 MPa")


def runs():
    """Name and run, all of the packing of the first."""
    alone, fixed = coupling_study.beams()
    found = [("particles alone", alone), ("fixed zones", fixed)]
    for limit in LIMITS:
        found.append((f"adaptive, {limit}", study.run(f"coupling/adaptive-{limit.replace(' ', '-')}", ADAPTIVE, {"couple.convert.stress": limit})))
    found.append(("elements alone", study.run("coupling/adaptive-never", ADAPTIVE, {"couple.convert.stress": "1 TPa"})))
    return found


def curve(result):
    return result.results("history/deflection"), result.results("history/force")


def stiffness(result, top):
    """MN/m, from 5 to 50 % of `top` (N) on the way up."""
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


def table(found):
    alone = found[0][1]
    top, seconds, broke = np.max(curve(alone)[1]), alone.seconds, coupling_study.crack(alone)
    rows = []
    for name, result in found:
        bend, force = curve(result)
        cracked = coupling_study.crack(result)
        peak = int(np.argmax(force))
        real = name != "elements alone"
        apart = np.mean([np.min(np.linalg.norm(broke - at, axis=1)) for at in cracked]) if real and len(cracked) else np.nan
        rows.append([name, *counts(result), f"{stiffness(result, top):.0f}", f"{force[peak] / 1e3:.2f}" if real else "-",
                     f"{100 * (force[peak] / top - 1):+.1f}" if real else "-", f"{1e6 * bend[peak]:.1f}" if real else "-", len(cracked) if real else "-",
                     f"{1e3 * apart:.1f}" if real else "-", f"{100 * result.residual:.3f}", f"{result.seconds:.1f}", f"{seconds / result.seconds:.1f}"])
    return study.table(["", "particles", "elements", "stiffness, MN/m", "peak, kN", "off, %", "deflection there, um", "bonds broken",
                        "from the crack of particles alone, mm", "residual, %", "s", "times faster"], rows)


def draw(found):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 4.2), constrained_layout=True)
    for name, result in found:
        bend, force = curve(result)
        shown = bend < 45e-6
        axes.plot(1e6 * bend[shown], force[shown] / 1e3, label=name, linestyle="--" if name == "elements alone" else "-")
    axes.set(xlabel="deflection, um", ylabel="force, kN", ylim=(-1, 30))
    axes.legend()
    figure.savefig(PICTURE, dpi=110)


def main():
    found = runs()
    draw(found)
    study.put("coupling.md", "table adaptive", table(found))


if __name__ == "__main__":
    main()
