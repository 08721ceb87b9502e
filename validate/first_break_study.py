"""time.start: first_break beside runs from rest: stress and strain, first breaks, strength, broken bonds, kinetic energy, steps
and seconds. The scatter of a run by rounding is that of runs whose coordinates were changed by 1e-12 of themselves. Fills the
tables of docs/evidence/first-break.md; some ten minutes of one core.

    /usr/bin/python3 validate/first_break_study.py [--fresh] [--changes N] [CASE ...]

The tables have the cases that are named, all without a name. --changes: at most so many runs with changed coordinates of either kind.
"""
import json
import os
import resource
import sys
import time

import numpy as np

import study

ROCK = """materials: [{name: rock, density: 2650 kg/m3, contact_modulus: 10 GPa, kratio: 3.7, friction: 0.5,
             tensile_strength: 40 MPa, shear_strength: 40 MPa}]
law: {stiffness: harmonic}
"""
DISCS = """materials: [{name: rock, density: 2580 kg/m3, normal_stiffness: 10 GN/m, kratio: 2.5, friction: 0.5,
             bond_tension_limit: 1 kN, bond_shear_limit: 1 kN}]
law: {stiffness: uniform}
dimension: 2
"""
COMMON = """bonds: {interaction_range: 0.05}
damping: {background: {model: nonviscous_vector, coefficient: 0.7}}
output: {history_rows: 4000, snapshots: 0, checkpoint: off}
run: {threads: 1}
"""
PLATENS = """walls:
- {name: bottom, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 15 MN/m, passive: true, motion: {vz: 0.1 m/s}}
- {name: top, point: [0, 0, 46 mm], normal: [0, 0, -1], stiffness: 15 MN/m, passive: true, motion: {vz: -0.1 m/s}}
test: {kind: compression, axis: z, lower: bottom, upper: top, length: 46 mm, diameter: 23 mm}
"""
GRIPS = """sets:
- {name: bottom, select: {end: {axis: z, side: lower, depth: 2 mm, by: surface}}, motion: {vx: 0, vy: 0, vz: -0.02 m/s}}
- {name: top, select: {end: {axis: z, side: upper, depth: 2 mm, by: surface}}, motion: {vx: 0, vy: 0, vz: 0.02 m/s}}
test: {kind: tension, axis: z, lower: bottom, upper: top, length: 46 mm, diameter: 23 mm}
"""
PLATES = """walls:
- {name: bottom, point: [0, 0], normal: [0, 1], stiffness: 10 GN/m, passive: true, motion: {vy: 0.005 m/s}}
- {name: top, point: [0, 101.876 mm], normal: [0, -1], stiffness: 10 GN/m, passive: true, motion: {vy: -0.005 m/s}}
test: {kind: compression, axis: y, lower: bottom, upper: top, length: 101.876 mm, diameter: 50 mm}
"""
BENDING = """sets:
- {name: left, select: {box: {min: [-1 mm, 8 mm], max: [1.5 mm, 12 mm]}}, motion: {vx: 0, vy: 0}}
- {name: right, select: {box: {min: [-1 mm, 90 mm], max: [1.5 mm, 94 mm]}}, motion: {vx: 0}}
- {name: punch, select: {box: {min: [48.5 mm, 49 mm], max: [51 mm, 53 mm]}}, motion: {vx: -2 mm/s}}
test: {kind: compression, axis: x, lower: [left, right], upper: punch, length: 50 mm, area: 1 m2}
"""
# Name, description, specimen, scene, end in s, number of further runs with changed coordinates of either kind.
CASES = [("rock-a", "compression, 10 225 spheres", "rock-a", ROCK + PLATENS, 6e-3, 2),
         ("rock-b", "compression, 2 000 spheres", "rock-b", ROCK + PLATENS, 6e-3, 2),
         ("rock-c", "compression, 6 000 spheres, wide sizes", "rock-c", ROCK + PLATENS, 6e-3, 3),
         ("tension", "tension of rock-a between grips", "rock-a", ROCK + GRIPS, 6e-3, 2),
         ("discs", "compression, 4 000 discs", "discs-50x100", DISCS + PLATES, 20e-3, 2),
         ("beam", "bending of a deep beam, the same discs", "discs-50x100", DISCS + BENDING, 100e-3, 2)]
FOLDER = study.RUNS / "first-break"


def specimen(name, change):
    """A copy with every coordinate changed by up to 1e-12 of itself, differently for every number; 0: unchanged."""
    path = FOLDER / f"{name}-{change}.txt"
    if not path.exists():
        data = np.loadtxt(study.ROOT / "scenes" / "specimens" / f"{name}.txt")
        if change:
            data[:, :-1] *= 1 + 1e-12 * np.random.default_rng(change).uniform(-1, 1, data[:, :-1].shape)
        np.savetxt(path, data, fmt="%.17g")
    return path


class Done:
    def __init__(self, folder):
        self.run = study.Run(folder, {"code": 0, "message": ""})
        self.seconds = json.loads((folder / "cost.json").read_text())["user"]
        self.history = {k: self.run.results(f"history/{k}") for k in
                        ("time", "strain", "stress", "broken_tension", "broken_shear", "energy_kinetic", "step")}
        self.broken = self.history["broken_tension"] + self.history["broken_shear"]
        times = self.run.results("bonds/broken_time")
        self.first = np.sort(times[times > 0])
        at = np.argmin(np.where(times > 0, times, np.inf))
        self.bond = tuple(sorted((int(self.run.results("bonds/i")[at]), int(self.run.results("bonds/j")[at]))))
        self.start = self.run.summary.get("first_break")

    @property
    def peak(self):
        return float(self.history["stress"].max())

    @property
    def peak_strain(self):
        return float(self.history["strain"][np.argmax(self.history["stress"])])

    @property
    def broken_at_peak(self):
        return int(self.broken[np.argmax(self.history["stress"])])

    @property
    def steps(self):
        return self.run.summary["steps"] - (self.start["steps"] if self.start else 0)

    def stress_at(self, strains):
        return np.interp(strains, self.history["strain"], self.history["stress"])


def run(case, change, first_break, fraction=None):
    name, _, particles, scene, end, _ = case
    start = f"start: first_break, " if first_break else ""
    if fraction:
        start += f"start_fraction: {fraction}, "
    folder = FOLDER / f"{name}-{change}{'-first' if first_break else ''}{fraction or ''}"
    text = (f"specimen: {{file: {specimen(particles, change)}, material: rock, group: 1"
            f"{', density_basis: bulk' if 'dimension: 2' in scene else ''}}}\n"
            f"{scene}{COMMON}time: {{{start}end: {end}, stop: {{peak_drop: 0.5}}}}\n")
    path = FOLDER / f"{folder.name}.yaml"
    if study.FRESH or not (folder / "cost.json").exists() or path.read_text() != text:
        path.write_text(text)
        before, wall = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, time.monotonic()
        done = study.call(["run", str(path), "--quiet", "--force", "--out", str(folder)])
        if done.returncode != 0:
            sys.exit(f"{folder.name}: {done.stderr}")
        user = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        (folder / "cost.json").write_text(json.dumps({"user": user, "wall": time.monotonic() - wall}))
        print(f"{folder.name}: {user:.1f} s", file=sys.stderr, flush=True)
    return Done(folder)


def spread(values):
    return f"{min(values):.4g} to {max(values):.4g}"


def kinetic_ratio(done):
    """Largest kinetic energy from the start to the first break, relative to that of the first instant."""
    t, k = done.history["time"], done.history["energy_kinetic"]
    inside = (t >= done.start["start"] * (1 - 1e-9)) & (t < done.first[0])
    return float(k[inside].max() / k[inside][0])


def rest_ratio(rest, done):
    """The kinetic energy of the run from rest in the same time, over the same energy."""
    t, k = rest.history["time"], rest.history["energy_kinetic"]
    steady = done.history["energy_kinetic"][np.argmax(done.history["time"] >= done.start["start"] * (1 - 1e-9))]
    before = t < done.start["start"]
    return float(k[before].max() / steady)


def fractions():
    """The table of starts near the first break, on rock-b."""
    case, rows = CASES[1], []
    for fraction in (0.5, 0.8, 0.9, 0.95, 0.99):
        done = run(case, 0, True, fraction)
        rows.append([fraction, f"{1e3 * done.start['time']:.5g}", f"{1e3 * done.first[0]:.5g}", f"{done.peak / 1e6:.1f}",
                     done.broken_at_peak, done.steps, done.start["iterations"], f"{kinetic_ratio(done):.3f}"])
    study.put("first-break.md", "table fractions", study.table(
        ["start_fraction", "first break predicted, ms", "found, ms", "strength MPa", "broken at the peak", "steps",
         "iterations", "kinetic energy over that of steady loading"], rows))


def main():
    os.makedirs(FOLDER, exist_ok=True)
    most = int(sys.argv[sys.argv.index("--changes") + 1]) if "--changes" in sys.argv else 9
    wanted = [a for a in sys.argv[1:] if not a.startswith("-") and not a.isdigit()]
    agree, breaks, cost, quiet = [], [], [], []
    if not wanted or "fractions" in wanted:
        fractions()
    for case in CASES:
        if wanted and case[0] not in wanted:
            continue
        rest = [run(case, k, False) for k in range(min(case[5], most) + 1)]
        first = [run(case, k, True) for k in range(min(case[5], most) + 1)]
        rise = np.linspace(0.1, 0.9, 17) * min(d.peak_strain for d in rest + first)
        mean = np.mean([d.stress_at(rise) for d in rest], axis=0)
        apart = lambda runs: 100 * max(np.max(np.abs(d.stress_at(rise) - mean)) for d in runs) / max(mean)
        agree.append([case[0], case[1], spread([d.peak / 1e6 for d in rest]), spread([d.peak / 1e6 for d in first]),
                      f"{apart(rest):.2g}", f"{apart(first):.2g}", spread([100 * d.peak_strain for d in rest]),
                      spread([100 * d.peak_strain for d in first]), spread([d.broken_at_peak for d in rest]),
                      spread([d.broken_at_peak for d in first]), f"{max(abs(d.run.residual) for d in first):.0e}"])
        predicted = first[0].start
        breaks.append([case[0], f"{1e3 * predicted['time']:.5g}, {min(predicted['first'], predicted['second'])}-"
                       f"{max(predicted['first'], predicted['second'])}",
                       "; ".join(f"{1e3 * t:.5g}" for t in first[0].first[:3]) + f", {first[0].bond[0]}-{first[0].bond[1]}",
                       "; ".join(f"{1e3 * t:.5g}" for t in rest[0].first[:3]) + f", {rest[0].bond[0]}-{rest[0].bond[1]}"])
        cost.append([case[0], rest[0].run.summary["steps"], first[0].steps, predicted["steps"], predicted["iterations"],
                     f"{np.mean([d.seconds for d in rest]):.1f}", f"{np.mean([d.seconds for d in first]):.1f}"])
        quiet.append([case[0], f"{kinetic_ratio(first[0]):.3f}", f"{rest_ratio(rest[0], first[0]):.3f}",
                      f"{predicted['unbalanced']:.0e}"])
    study.put("first-break.md", "table agree", study.table(
        ["case", "what", "strength MPa from rest", "first_break", "stress apart on the rise, % of the peak: from rest",
         "first_break", "strain at the peak %, from rest", "first_break", "broken at the peak, from rest", "first_break",
         "energy residual"], agree))
    study.put("first-break.md", "table breaks", study.table(
        ["case", "predicted, ms and bond", "found from there, the first three", "from rest, the first three"], breaks))
    study.put("first-break.md", "table cost", study.table(
        ["case", "steps from rest", "steps with first_break", "steps that statics stood for", "iterations",
         "CPU s from rest", "CPU s with first_break"], cost))
    study.put("first-break.md", "table quiet", study.table(
        ["case", "largest kinetic energy up to the first break over that of steady loading", "from rest, before the start",
         "loads left over contact forces"], quiet))


if __name__ == "__main__":
    main()
