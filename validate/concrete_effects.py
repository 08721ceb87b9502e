"""Effects of the number of particles, speed, step and round-off on the concrete of concrete_study.py (Santasusana 2013, ch. 5), without
pressure and under 9 MPa. Writes the section on concrete of docs/evidence/accuracy.md and its pictures.

    /usr/bin/python3 validate/concrete_effects.py [--fresh] [--kept] [--quick] [most] [large]

Ten minutes of one core. `most`: 71 852 spheres too, as many as the source's largest specimen; `large`: speeds with 13 500 spheres too; together
twenty minutes more, and shown once they were made. --kept: of the runs that are there; --quick: few spheres, prints what it would have
written. Runs stay in runs/studies/concrete.
"""
import datetime
import json
import sys
from pathlib import Path

import numpy as np

import concrete_study as concrete
import study

sys.path.insert(0, str(Path(__file__).resolve().parent / "accuracy"))
import fits  # noqa: E402
import run as accuracy  # noqa: E402
import words  # noqa: E402

QUICK = concrete.QUICK
PRESSURES = (0, 9)  # MPa
COUNTS = (107, 500) if QUICK else (107, 500, 1500, 4000, 13500)
COUNT = 500 if QUICK else 1500  # Numbers for the studies of speed, step and round-off.
WAVES = np.sqrt(concrete.YOUNG / 2500)  # m/s
SPEEDS = {0: (0.4, 0.2, 0.1, 0.05, 0.02, 0.01), 9: (0.8, 0.4, 0.2, 0.1, 0.05)}
MANY = 13500
MANY_SPEEDS = {0: (0.2, 0.1, 0.05, 0.02), 9: (0.4, 0.2, 0.1)}
BRITTLE_SPEEDS = (1.0, 0.2, 0.1, 0.02, 0.002)  # speeds of the source
SAFETIES = {0: (0.9, 0.45, 0.2, 0.05), 9: (0.9, 0.45, 0.2)}
NEARBY = (0.9, 0.89, 0.88, 0.87)  # Steps whose difference has no physical effect.
COPIES, SHAKEN = 4, 1e-12
USED = []  # runs that tables contain


def taken(run):
    USED.append(run)
    return run


def cpu(curve):
    return curve.run.summary["seconds"]["cpu"]


def reported(pressure):
    return f"under {pressure:g} MPa" if pressure else "without pressure"


# --- number of particles ------------------------------------------------------------------------------------------

def particles():
    """The curves for every number of particles without and with pressure, three packings for the smaller numbers."""
    if "most" in sys.argv:
        for pressure in PRESSURES:
            concrete.tested(concrete.MOST, 1, pressure)
    found = {}
    for count in (*COUNTS, *((concrete.MOST,) if concrete.kept_there(concrete.MOST, PRESSURES) else ())):
        seeds = concrete.SEEDS if count <= 1500 or concrete.kept_there(count, PRESSURES, concrete.SEEDS) else (1,)
        found[count] = {p: [taken(concrete.tested(count, seed, p)) for seed in seeds] for p in PRESSURES}
    return found


def across(count, curves):
    return concrete.DIAMETER / 2 / np.mean([c.run.results("particles/radius").mean() for c in curves])


def particle_rows(found):
    rows = []
    for count, curves in found.items():
        free = curves[0]
        rows.append([count, len(free), f"{across(count, free):.1f}", f"{np.mean([2 * c.run.bonds / c.run.summary['counts']['particles'] for c in free]):.2f}",
                     f"{np.mean([concrete.filled(c.run) for c in free]):.3f}", concrete.spread([c.run.young_modulus_average / 1e9 for c in free]),
                     concrete.spread([c.run.poisson_ratio for c in free], 2), *(concrete.spread([c.peak for c in curves[p]]) for p in PRESSURES),
                     *(words.seconds(np.mean([cpu(c) for c in curves[p]])) for p in PRESSURES)])
    return rows


def particle_words(found):
    counts = list(found)
    sizes = [across(n, found[n][0]) for n in counts]
    fill = np.array([np.mean([concrete.filled(c.run) for c in found[n][0]]) for n in counts])
    columns = {f"the strength {reported(p)}": [np.mean([c.peak for c in found[n][p]]) for n in counts] for p in PRESSURES}
    columns["E"] = [np.mean([c.run.young_modulus_average for c in found[n][0]]) for n in counts]
    last = len(counts) - 1
    steps = "; ".join(f"{name} by {words.signed(v[last] / v[0] - 1)} over all, {words.signed(v[last] / v[last - 1] - 1)} from {counts[last - 1]} to {counts[last]}"
                      for name, v in columns.items())
    orders = []
    for name, v in columns.items():
        limit, _, order = fits.limit(sizes, v)
        orders.append(f"{name} {words.signed(v[last] / limit - 1)} at exponent {order:.2g}")
    own = "; ".join(f"{name} {words.signed(v[last] / v[0] / (fill[last] / fill[0]) - 1)}" for name, v in columns.items())
    return (f"**Particles.** From {counts[0]} to {counts[last]} spheres change: {steps}. They still rise, but more slowly: against limit x (1 - b n^-p), n particles across, the largest "
            f"specimen is at {', '.join(orders)}; a fit of three numbers to {len(counts)} points of one or three packings, hence uncertain. Sections of bonds add up to {fill[0]:.2f} of the body "
            f"at first and {fill[last]:.2f} at last, as the fraction at the surface falls. In proportion all values should grow by {words.signed(fill[last] / fill[0] - 1)}; the deviations from that are: {own}.")


# --- speed ------------------------------------------------------------------------------------------------------------

def speed_name(count, pressure, speed):
    """The part of the name of a run that states its speed, for the material that softens and yields; "" at the usual
    speed."""
    usual = ({**concrete.TESTS, **concrete.MANY} if count >= concrete.RAISED_FROM else concrete.TESTS)[pressure][1]
    return "" if speed == usual else f"-at{speed:g}"


def there(count, pressure, speed):
    return (concrete.FOLDER / f"{count}-1-{pressure:g}{speed_name(count, pressure, speed)}" / "study.json").exists()


def speeds():
    """Runs at other speeds without and with pressure; with many spheres only if requested or already computed."""
    asked = [(COUNT, p, SPEEDS[p]) for p in PRESSURES]
    if not QUICK:
        asked += [(MANY, p, [v for v in MANY_SPEEDS[p] if "large" in sys.argv or there(MANY, p, v)]) for p in PRESSURES]
    return {(count, p): {v: taken(concrete.tested(count, 1, p, speed_name(count, p, v), speed=v)) for v in found} for count, p, found in asked if len(found) > 1}


def group(speed, curve):
    return speed / WAVES / curve.peak_strain


def speed_rows(found):
    rows = []
    for (count, pressure), curves in found.items():
        slowest = curves[min(curves)]
        for speed, c in curves.items():
            rows.append([f"{pressure:g}", count, f"{speed:g}", f"{group(speed, c):.4f}", f"{c.modulus:.2f}", f"{c.peak:.2f}",
                         "" if c is slowest else words.signed(c.peak / slowest.peak - 1), f"{100 * c.peak_strain:.3f}", concrete.share(c.left(0.002)),
                         c.run.summary["steps"], words.seconds(cpu(c))])
    return rows


def brittle_speeds():
    """Bonds without softening and yield, no confining pressure, as in the source."""
    found = {}
    for speed in BRITTLE_SPEEDS[:4] if QUICK else BRITTLE_SPEEDS:
        scene = concrete.compression(COUNT, 1, 0, speed, 0.006, drop=0.9, law={"softening": "none"})
        scene["materials"] = [concrete.brittle()]
        scene["output"]["history_rows"] = 2000
        found[speed] = taken(concrete.Curve(concrete.made(f"speed-{COUNT}-{speed:g}", scene), 0))
    return found


def brittle_rows(found):
    rows = []
    for speed, c in found.items():
        past = c.axial[(np.arange(len(c.stress)) > c.row) & (c.stress < 0.5 * c.peak)]
        fall = (past[0] / c.peak_strain - 1) if len(past) else float("nan")
        rows.append([f"{speed:g}", f"{group(speed, c):.4f}", f"{c.modulus:.2f}", f"{c.peak:.2f}", f"{100 * c.peak_strain:.3f}", f"{fall:.2f}",
                     f"{100 * c.run.end_imbalance:.1f}", f"{c.run.results('history/energy_kinetic')[: c.row + 1].max():.3g}", c.run.summary["steps"],
                     words.seconds(cpu(c))])
    return rows


def speed_words(found, brittle):
    parts = []
    for (count, pressure), curves in found.items():
        slow = min(curves)
        others = ", ".join(f"{words.signed(c.peak / curves[slow].peak - 1)} at {v:g} m/s (g = {group(v, c):.2g})" for v, c in curves.items() if v != slow)
        parts.append(f"{reported(pressure)}, {count} spheres: {others}")
    fast, slow = brittle[max(brittle)], brittle[min(brittle)]
    return (f"**Speed**, strength against that at the slowest, {'; '.join(parts)}. g: closing speed over wave speed and strain at the peak. "
            f"Bonds that break at once, as in this study of the source: from {min(brittle):g} to {max(brittle):g} m/s E is {words.signed(fast.modulus / slow.modulus - 1)}, the strength "
            f"{words.signed(fast.peak / slow.peak - 1)}. According to the source the elastic part is correct at all of these speeds, fast loading increases the strength and makes the descending "
            "branch look ductile, and the slowest loading is brittle: the column after the strain is the additional strain to half of the strength.")


# --- step and round-off -----------------------------------------------------------------------------------------------

def steps():
    found = {p: {s: concrete.tested(COUNT, 1, p, f"-safety{s:g}", {"time.safety": s}) for s in SAFETIES[p] if s > 0.1 or not QUICK} for p in PRESSURES}
    for curves in found.values():
        USED.extend(curves.values())
    return found


def nearby():
    return {p: [taken(concrete.tested(COUNT, 1, p, f"-safety{s:g}", {"time.safety": s})) for s in NEARBY] for p in PRESSURES}


def step_rows(found):
    rows = []
    for pressure, curves in found.items():
        finest = curves[min(curves)]
        for safety, c in curves.items():
            step = c.run.results("history/time")[-1] / c.run.results("history/step")[-1]
            rows.append([f"{pressure:g}", f"{safety:g}", f"{1e9 * step:.0f}", f"{c.modulus:.2f}", f"{c.peak:.2f}", "" if c is finest else words.signed(c.peak / finest.peak - 1),
                         f"{100 * c.peak_strain:.3f}", f"{c.run.residual:.0e}", c.run.summary["steps"], words.seconds(cpu(c))])
    return rows


def shaken():
    """One packing as a file, as packed and with coordinates changed by round-off; under pressure the membrane is on
    the particles."""
    folder = concrete.FOLDER / f"shaken-{COUNT}"
    if not (folder / "packing.txt").exists() or study.FRESH:
        if study.KEPT:
            return {}
        concrete.FOLDER.mkdir(parents=True, exist_ok=True)
        scene = concrete.FOLDER / f"shaken-{COUNT}.yaml"
        scene.write_text(json.dumps({key: concrete.body(COUNT, 1)[key] for key in ("dimension", "specimen", "run")}))
        done = study.call(["pack", str(scene), "--out", str(folder), "--force"])
        if done.returncode:
            sys.exit(done.stderr)
    found = {p: [] for p in PRESSURES}
    packed = np.loadtxt(folder / "packing.txt")
    for copy in range(COPIES):
        rows = packed.copy()
        if copy:
            rows[:, :3] *= 1 + SHAKEN * np.random.default_rng(copy).uniform(-1, 1, rows[:, :3].shape)
        np.savetxt(folder / f"copy-{copy}.txt", rows, fmt="%.17g")
        for pressure in PRESSURES:
            scene = concrete.compression(COUNT, 1, pressure)
            scene["specimen"] = {"file": f"shaken-{COUNT}/copy-{copy}.txt", "material": "concrete"}
            path = concrete.FOLDER / f"shaken-{COUNT}-{copy}-{pressure:g}.yaml"
            path.write_text(json.dumps(scene, indent=1))
            found[pressure].append(taken(concrete.Curve(study.run(f"concrete/shaken-{COUNT}-{copy}-{pressure:g}", path, {"run.threads": 1}), pressure)))
    return found


def automatic_step(curve):
    """The step that the program chooses, for a run whose steps scaled masses may have lengthened, ns."""
    steps = curve.run.results("history/time")[-1] / curve.run.results("history/step")[-1]
    return 1e9 * steps / (concrete.RAISED if curve.run.summary["counts"]["particles"] >= concrete.RAISED_FROM else 1)


RANGES = {2: 1.13, 3: 1.69, 4: 2.06, 5: 2.33, 6: 2.53}  # Expected range of this number of normally distributed values, in standard deviations.


def bounded(copies):
    """Cases in which round-off is not amplified."""
    kept = [reported(p) for p, curves in copies.items() if fits.scatter([c.peak for c in curves]) < 1e-6]
    return f" ({' and '.join(kept)} it is not multiplied: bonds soften and contacts damp)" if kept else ""


def judged(name, values, near):
    """Range over different steps, and range over the same number of nearly equal steps."""
    mean = np.mean(values)
    return (f"{name} steps have a range of {words.percent(np.ptp(values) / mean)}, where as many that are nearly the same have "
            f"{words.percent(RANGES[len(values)] * fits.scatter(near))}")


def step_words(found, copies, near, packings, many):
    parts = []
    for pressure, curves in found.items():
        values = np.array([c.peak for c in curves.values()])
        parts.append(f"{reported(pressure)} all are within {words.percent(np.ptp(values) / values[-1])}, E within {words.percent(np.ptp([c.modulus for c in curves.values()]) / curves[min(curves)].modulus)}")
    off = "; ".join(f"{reported(p)} {words.percent(fits.scatter([c.peak for c in curves]))}" for p, curves in copies.items())
    jitter = "; ".join(f"{reported(p)} {words.percent(fits.scatter([c.peak for c in curves]))}" for p, curves in near.items())
    scatter = "; ".join(f"{reported(p)} {words.percent(fits.scatter([c.peak for c in packings[p]]))}" for p in PRESSURES)
    bounds = ", ".join(f"{max(curves):g} to {min(curves):g} {reported(p)}" for p, curves in found.items())
    return (f"**Step**, over the stable one {bounds}: {'; '.join(parts)}. The source's 1e-8 to 1e-7 s are stable and 5e-7 s is not, for spheres of the size of the 13 500: the automatic step of "
            f"{many.run.summary['counts']['particles']} spheres is {automatic_step(many):.0f} ns, where an undamped one would be more than twice as long: contact damping of 0.9 of the critical takes sqrt(1 + 0.9^2) - 0.9 = 0.445 of it.\n\n"
            f"**Floors** of the strength, standard deviations. Coordinates changed by a relative {SHAKEN:g} ({COPIES} runs each): {off}{bounded(copies)}. Steps of {NEARBY[0]:g} to {NEARBY[-1]:g} of "
            f"the stable one ({len(NEARBY)}): {jitter}. Packings ({len(packings[0])} of 1500 spheres): {scatter}. Changes by speed and step are to be compared with the second: "
            f"{'; '.join(judged(reported(p), [c.peak for c in found[p].values()], [c.peak for c in near[p]]) for p in PRESSURES)}.")


# --- the section -------------------------------------------------------------------------------------------------------

def picture(found, fast, fine, place):
    plt = place.plt()
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.4))
    for pressure, colour in zip(PRESSURES, ("#22303c", "#6a994e")):
        counts = list(found)
        finest = np.mean([c.peak for c in found[counts[-1]][pressure]])
        for count in counts:
            axes[0].plot([across(count, found[count][0])] * len(found[count][pressure]), [c.peak / finest for c in found[count][pressure]], "o", ms=3, color=colour)
        axes[0].plot([across(n, found[n][0]) for n in counts], [np.mean([c.peak for c in found[n][pressure]]) / finest for n in counts], color=colour, label=reported(pressure))
        for (count, p), curves in fast.items():
            if p == pressure:
                slow = curves[min(curves)].peak
                axes[1].plot([group(v, c) for v, c in curves.items()], [c.peak / slow for c in curves.values()], "o-" if count == COUNT else "s--", ms=3, color=colour,
                             label=f"{reported(p)}, {count}")
        curves = fine[pressure]
        axes[2].plot(list(curves), [c.peak / curves[min(curves)].peak for c in curves.values()], "o-", ms=3, color=colour, label=reported(pressure))
    for ax, label, over in zip(axes, ("particles across", "g of the closing speed", "step over the stable one"), ("the largest number", "the slowest", "the finest")):
        ax.set(xlabel=label, ylabel=f"strength over that of {over}", xscale="log")
        ax.legend()
    return place.save(figure, "concrete", "Strength of concrete over particles, speed and step")


def brittle_picture(curves):
    plt = concrete.plt
    figure, axes = plt.subplots(figsize=(7, 5))
    for (speed, curve), colour in zip(curves.items(), ("#c8402f", "#e09f3e", "#6a994e", "#2b6cb0", "#22303c")):
        axes.plot(100 * curve.axial, curve.stress, color=colour, label=f"{speed:g} m/s")
    axes.set(xlabel="axial strain, %", ylabel="stress, MPa", title=f"Speed of closing, brittle bonds, {COUNT} spheres", ylim=(0, None))
    axes.legend()
    concrete.save(figure, "concrete-speed")


INTRO = """## Concrete under pressure

The cylinder of 150 x 300 mm of [laboratory](laboratory.md#concrete-what-is-computed), whose bonds soften and yield and contacts damp, closed between ends that hold it
across, without pressure and under 9 MPa: largest deviator, and E and nu at the start of loading. The source (Santasusana 2013, ch. 5) studies the number of particles (107 to 71 852), the speed and the step. Speed, step and
round-off with {count} spheres of one packing. Written by `validate/concrete_effects.py`."""


def section():
    place = words.Pictures(concrete.FOLDER if QUICK else study.ROOT / "docs" / "evidence" / "pictures", "pictures")
    found, fast, brittle, fine, near, copies = particles(), speeds(), brittle_speeds(), steps(), nearby(), shaken()
    packings = found[1500 if 1500 in found else COUNTS[-1]]
    brittle_picture(brittle)
    deviators = ["largest deviator MPa, no pressure", "9 MPa"]
    runs = list({str(c.run.folder): c.run for c in USED}.values())
    parts = [
        INTRO.format(count=COUNT), picture(found, fast, fine, place), particle_words(found), speed_words(fast, brittle), step_words(fine, copies, near, packings, found[COUNTS[-1]][0][0]),
        "Number of particles; in brackets the smallest and the largest of the packings:",
        words.table(["spheres", "packings", "across", "n_c", "sections over the body", "E GPa", "nu", *deviators, "CPU s, no pressure", "9 MPa"], particle_rows(found)),
        "Speed. Left: share of the peak 0.2 % of strain later; from 4 000 spheres on steps are twice as long by scaled masses:",
        words.table(["pressure MPa", "spheres", "closing m/s", "g", "E of the ends GPa", "largest deviator MPa", "against the slowest", "strain there %", "left", "steps", "CPU s"],
                    speed_rows(fast)),
        f"Speed, brittle bonds without yield, no pressure around, {COUNT} spheres ([curves](pictures/concrete-speed.png)):",
        words.table(["closing m/s", "g", "E of the ends GPa", "UCS MPa", "strain there %", "strain to half of it, over that", "ends differ by %",
                     "largest kinetic energy before J", "steps", "CPU s"], brittle_rows(brittle)),
        f"Step, {COUNT} spheres:",
        words.table(["pressure MPa", "of the stable step", "ns", "E of the ends GPa", "largest deviator MPa", "against the finest", "strain there %", "residual", "steps", "CPU s"], step_rows(fine)),
        f"Measured {datetime.date.today()}, one thread of a shared machine; {len(runs)} runs, {sum(r.summary['seconds']['cpu'] for r in runs):.0f} CPU seconds."]
    return "\n\n".join(parts)


def main():
    asked = [a for a in sys.argv[1:] if not a.startswith("-")]
    if set(asked) - {"most", "large"}:
        sys.exit(f"concrete_effects: expected most or large, found {' '.join(asked)}")
    text = section()
    if QUICK:
        print(text)
    else:
        accuracy.put_elsewhere("concrete", text)


if __name__ == "__main__":
    main()
