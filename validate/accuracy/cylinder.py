"""Compression and direct tension of a cylinder of rock: the cost of strength and stiffness. One packing (a file) serves all axes except for the
number of particles and the seed; runs of these make their own packings, whose time is a part of their seconds. """
import copy

import numpy as np

import fits
import slopes
import words
from machinery import Axis, key
from slopes import Slopes

DIAMETER, HEIGHT, DENSITY = 0.023, 0.046, 2650.0
READINGS = {"strength": "peak_stress", "E": "young_modulus_average", "nu": "poisson_ratio", "strain at the peak": "peak_strain"}
TERMS = ["energy.residual", "energy.background_damping", "energy.friction", "energy.bond_breaking", "energy.work_walls",
         "energy.work_prescribed"]
BASE = {"count": 2000, "closing": {"compression": 0.2, "tension": 0.05}, "damping": 0.7, "safety": 0.9, "gap": 0.05}
QUICK = {"count": 200, "closing": {"compression": 0.8, "tension": 0.2}}
LAST = {"compression": 0.03, "tension": 0.012}  # strain at which a run ends at the latest

MATERIAL = {"name": "rock", "density": DENSITY, "contact_modulus": "10 GPa", "kratio": 3.7, "friction": 0.5,
            "tensile_strength": "40 MPa", "shear_strength": "40 MPa"}


class Cylinder:
    def __init__(self, kind, quick):
        self.kind, self.quick = kind, quick
        self.count = (QUICK if quick else BASE)["count"]
        self.closing = (QUICK if quick else BASE)["closing"][kind]

    def motion(self, closing):
        """Keys that move both ends towards each other, `closing` m/s together, and end the run where the strain
        stops."""
        lower, upper, sense = ("walls.bottom", "walls.top", 1) if self.kind == "compression" else ("sets.lower", "sets.upper", -1)
        return {f"{lower}.motion.vz": sense * closing / 2, f"{upper}.motion.vz": -sense * closing / 2,
                "time.end": LAST[self.kind] * HEIGHT / closing}

    def scene(self, specimen):
        ends = self.motion(self.closing)
        lower, upper, end = ends.values()
        scene = {"title": f"{self.kind} of a cylinder", "dimension": 3, "specimen": specimen, "materials": [MATERIAL],
                 "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": BASE["gap"]},
                 "damping": {"background": {"model": "nonviscous_vector", "coefficient": BASE["damping"]}},
                 "test": {"kind": self.kind, "axis": "z", "length": HEIGHT, "diameter": DIAMETER},
                 "time": {"end": end, "safety": BASE["safety"], "stop": {"peak_drop": 0.2}},
                 "output": {"history_rows": 2000, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}
        if self.kind == "compression":
            plate = {"stiffness": "15 MN/m", "passive": True}
            scene["walls"] = [{"name": "bottom", "point": [0, 0, 0], "normal": [0, 0, 1], "motion": {"vz": lower}, **plate},
                              {"name": "top", "point": [0, 0, HEIGHT], "normal": [0, 0, -1], "motion": {"vz": upper}, **plate}]
            scene["test"].update(lower="bottom", upper="top")
        else:
            held = {"axis": "z", "depth": "0.5 mm", "by": "surface"}
            scene["sets"] = [{"name": "lower", "select": {"end": {**held, "side": "lower"}}, "motion": {"vz": lower}},
                             {"name": "upper", "select": {"end": {**held, "side": "upper"}}, "motion": {"vz": upper}}]
            scene["test"].update(lower="lower", upper="upper")
        return scene

    def shape(self):
        return {"cylinder": {"diameter": DIAMETER, "height": HEIGHT}, "particles": self.count,
                "packing": {"size_ratio": 3, "overlap": "passive"}, "material": "rock"}

    # --- the axes: a line each -------------------------------------------------------------------------------

    def axes_of_the_file(self):
        v = self.closing
        speeds = [8 * v, 4 * v, 2 * v, v, v / 2, v / 4] + ([v / 8] if self.kind == "compression" else [])
        model = "damping.background.model"
        return [
            Axis("safety", [0.9, 0.7, 0.5, 0.3, 0.15], key("time.safety"), [0.9, 0.6, 0.3]),
            Axis("precision", ["double", "mixed"], key("run.precision"), ["double", "mixed"]),
            Axis("velocity", speeds, self.motion, [4 * v, 2 * v, v, v / 2]),
            Axis("damping", [0, 0.1, 0.2, 0.4, 0.7, 0.9], key("damping.background.coefficient"), [0.2, 0.7]),
            Axis("form of damping", ["nonviscous_vector", "nonviscous_component"], key(model)),
            Axis("gap", [0.005, 0.05, 0.1, 0.2, 0.3], key("bonds.interaction_range"), [0.05, 0.2]),
            Axis("damping and velocity", [(a, w) for w in (4 * v, v / 4) for a in (0.1, 0.4)],
                 lambda p: {"damping.background.coefficient": p[0], **self.motion(p[1])}),
            Axis("mass scaling", [1, 1.5, 2, 3, 5], key("time.mass_scaling.factor"), [1, 2]),
            Axis("start", [(start, w) for w in (v, v / 4) for start in ("rest", "first_break")],
                 lambda p: {"time.start": p[0], **self.motion(p[1])}, [(start, v) for start in ("rest", "first_break")]),
        ]

    def axes_of_the_packing(self):
        v = self.closing
        counts = [250, 500, 1000, 2000, 4000, 8000]
        fast = [(n, w) for w in (8 * v, 4 * v) for n in counts]
        slow = [(n, v / 4) for n in (250, 500, 1000, 2000)]
        both = lambda p: {"specimen.particles": p[0], **self.motion(p[1])}  # noqa: E731
        return [
            Axis("particles", counts, key("specimen.particles"), [150, 300, 600], seeds=5),
            Axis("more particles", [16000], key("specimen.particles"), seeds=2),
            Axis("particles and velocity", fast, both, seeds=5),
            Axis("particles and slow loading", slow, both, seeds=5),
        ]

    def shaken(self):
        return range(0, 3) if self.quick else range(0, 9)


def runs(study, kind):
    """Rows of every axis, by its name."""
    c = Cylinder(kind, study.quick)
    packed = c.shape()
    file = study.packed(f"cylinder-{c.count}", {"specimen": packed, "run": {"seed": 1}})
    found = {"round-off": study.axis(kind, c.scene({"file": str(file), "material": "rock"}), Axis(
        "round-off", list(c.shaken()), lambda k: {"specimen.file": str(study.packed(f"cylinder-{c.count}", {"specimen": packed, "run": {"seed": 1}}, k))},
        list(c.shaken())), readings=TERMS)}
    for axis in c.axes_of_the_file():
        found[axis.name] = study.axis(kind, c.scene({"file": str(file), "material": "rock"}), axis, readings=TERMS)
    for axis in c.axes_of_the_packing():
        found[axis.name] = study.axis(kind, c.scene(copy.deepcopy(packed)), axis, readings=TERMS)
    return c, found, np.loadtxt(file)


# --- readings ----------------------------------------------------------------------------------------------

def column(rows, reading):
    return np.array([row[READINGS.get(reading, reading)] for row in rows], float)


def groups(rows):
    """Rows by the value of their axis, in its order."""
    found = {}
    for row in rows:
        found.setdefault(row.value, []).append(row)
    return found


def across(count, rows_of_file):
    """Particles across the diameter, from the mean radius of a packing: other numbers of particles of the same shape
    follow by volume."""
    return DIAMETER / (2 * rows_of_file[:, 3].mean()) * (count / len(rows_of_file)) ** (1 / 3)


MUCH = 0.4  # damping above which it hardly affects strength


def m_base(rows, reading):
    """Returns a reading at the damping of the base."""
    return next(row for row in rows if row.value == BASE["damping"])[READINGS.get(reading, reading)]


class Measured:
    """Floors, references and slopes of a case, from its rows."""

    def __init__(self, case, c, found, packing):
        self.case, self.c, self.found, self.packing = case, c, found, packing
        self.slopes = Slopes(case)
        self.base = found["round-off"][0]
        volume = np.pi / 4 * DIAMETER**2 * HEIGHT
        self.bulk = DENSITY * np.sum(4 / 3 * np.pi * packing[:, 3] ** 3) / volume
        self.wave = np.sqrt(self.base["young_modulus_average"] / self.bulk)
        self.floor = {r: fits.scatter(column(found["round-off"], r)) for r in READINGS}
        # Difference of two single runs by round-off only, two standard deviations.
        self.noise = {r: 2 * np.sqrt(2) * floor for r, floor in self.floor.items()}
        self.by_count = groups(found["particles"] + found["more particles"])
        self.packing_scatter = {r: {n: fits.scatter(column(rows, r)) for n, rows in groups(found["particles"]).items()} for r in READINGS}
        self.n = {n: across(n, packing) for n in self.by_count}
        self.limits = {r: fits.limit_spread(list(self.n.values()), [column(rows, r) for rows in self.by_count.values()])
                       for r in ("strength", "E")}
        self.still = {r: self.at_rest(r) for r in READINGS}
        self.measure()

    def group(self, closing):
        """Closing speed over wave speed and strain at the peak: transits of a wave that the loading does not last."""
        return closing / (self.wave * self.base["peak_strain"])

    def at_rest(self, reading):
        """The limit of the reading for slow loading, its change from there to every speed of the axis, and the order
        (0: converged)."""
        rows = sorted(self.found["velocity"], key=lambda row: row.value)
        values = column(rows, reading)
        still, order = fits.halved(values, self.noise[reading])
        return still, {row.value: value / still - 1 for row, value in zip(rows, values)}, order

    def limit(self, reading):
        """Returns the limit of the reading for many particles and slow loading."""
        at_base = self.still[reading][1].get(self.c.closing, 0.0)
        return self.limits[reading][0][0] / (1 + at_base)

    def measure(self):
        s, found = self.slopes, self.found
        for r in READINGS:
            change = self.still[r][1]
            beyond = {v: d for v, d in change.items() if abs(d) > self.noise[r]}
            s.power(r, "velocity", "bias", "closing speed / (wave speed x strain at the peak)", [self.group(v) for v in beyond],
                    list(beyond.values()))
            ours = {row.value: row[READINGS[r]] for row in found["safety"]}
            s.linear(r, "safety", "bias", "safety", list(ours), np.array(list(ours.values())) / ours[min(ours)] - 1, min(ours))
            a = {row.value: row[READINGS[r]] / m_base(found["damping"], r) - 1 for row in found["damping"]}
            high, low = [x for x in a if x >= MUCH], [x for x in a if x < MUCH and abs(a[x]) > self.noise[r]]
            s.linear(r, "damping", "bias", f"coefficient of the damping, {MUCH} and more", high, [a[x] for x in high], BASE["damping"])
            s.exponential(r, "little damping", "bias", f"coefficient of the damping, below {MUCH}", low, [a[x] for x in low])
            double, mixed = column(found["precision"], r)[:2]
            s.constant(r, "precision", "bias", mixed / double - 1, 1)
            s.constant(r, "round-off", "scatter", self.floor[r], len(found["round-off"]))
            bonds = column(found["gap"], "bonds") * 2 / len(self.packing)
            middle = next(row for row in found["gap"] if row.value == BASE["gap"])
            s.ratio(r, "gap", "bonds per particle", bonds, column(found["gap"], r) / middle[READINGS[r]], 2 * middle["bonds"] / len(self.packing))
            s.power(r, "packing", "scatter", "number of particles", list(self.packing_scatter[r]), list(self.packing_scatter[r].values()))
            self.measure_ways(r)
        for r, ((last, a, p), error, _) in self.limits.items():
            n = list(self.n.values())
            middle = np.exp(np.mean(np.log(n)))
            s.add(r, "size", "bias", "particles across the diameter", "power", -a * middle**-p / last, error[0] / (abs(a) * middle**-p), -p, error[2],
                  middle, min(n), max(n), len(n))

    def measure_ways(self, r):
        """Methods that need fewer steps, compared with the same run without them: the change of a reading over the factor of the step, and, for
        starts at the first break, the mean over both speeds."""
        rows = {row.value: row[READINGS[r]] for row in self.found["mass scaling"]}
        if 1 in rows:
            self.slopes.linear(r, "mass scaling", "bias", "step over that without added mass", list(rows), [y / rows[1] - 1 for y in rows.values()], 1)
        pairs = [both for speed in {row.value[1] for row in self.found["start"]} for both in started(self, speed)]
        change = np.array([b[READINGS[r]] / a[READINGS[r]] - 1 for a, b in pairs])
        if len(change):
            self.slopes.add(r, "start", "bias", "", "constant", change.mean(), np.sqrt(np.mean(change**2)), points=len(change))


# --- errors and costs of settings ---------------------------------------------------------------------------

KINDS = {"calibrated": "contact strength and stiffness calibrated with that number of particles",
         "constant": "contact strength and stiffness the same for every number"}


def bias_of(m, reading, kind, rows, count, spread):
    """Bias of a reading. Calibrated: that of the speed alone, from the same seeds at the speed of the base. Constant: that of the number of particles
    relative to the limit as well; the two do not cancel. The random error of the mean is not its bias and is subtracted."""
    base = {row.seed: row[READINGS[reading]] for row in m.by_count[count]}
    change = fits.clean([np.log(row[READINGS[reading]] / base.get(row.seed, float("nan"))) for row in rows])[0]
    chance = change.std(ddof=1) / np.sqrt(len(change)) if len(change) > 1 else 0.0
    bias = np.sqrt(max(0.0, (change.mean() + m.still[reading][1].get(m.c.closing, 0.0)) ** 2 - chance**2))
    if kind == "calibrated":
        return bias
    alone = fits.clean(list(base.values()))[0]
    off = alone.mean() / m.limits[reading][0][0] - 1
    return bias + np.sqrt(max(0.0, off**2 - spread**2 / len(alone)))


def settings(m, reading, kind):
    """(seconds, error, count, speed, seeds, steps): the error of a mean over this number of packings is the bias plus
    the scatter over the square root of the number. The scatter follows the fitted law over all numbers of
    particles, if there is one, because five seeds determine a standard deviation only to a third."""
    found, law = [], slope_of(m, reading, "packing")
    base = m.c.closing
    for name, speed in (("particles", lambda v: base), ("more particles", lambda v: base), ("particles and velocity", lambda v: v[1]),
                        ("particles and slow loading", lambda v: v[1])):
        for value, rows in groups(m.found[name]).items():
            count = value[0] if isinstance(value, tuple) else value
            values = fits.clean(column(rows, reading))[0]
            if len(values) < 2:
                continue
            spread = slopes.at(law, count) if law else values.std(ddof=1) / values.mean()
            bias = bias_of(m, reading, kind, rows, count, spread)
            seconds, steps = np.mean([row.seconds for row in rows]), np.mean([row["steps"] for row in rows])
            for seeds in (1, 2, 3, 5, 10):
                found.append((seeds * seconds, float(np.hypot(bias, spread / np.sqrt(seeds))), count, speed(value), seeds, seeds * steps))
    return found


def cheapest(m, reading, kind, wanted, yade):
    known = sorted(settings(m, reading, kind))
    good = [point for point in known if point[1] <= wanted]
    if not good:
        return f"none (best: {words.percent(min(point[1] for point in known))})"
    seconds, _, count, speed, seeds, steps = good[0]
    theirs = count * steps * yade["longer"] / yade["particle_steps"]
    return (f"{count} particles, {words.plain(speed)} m/s, {seeds} packing{'s' if seeds > 1 else ''}: **{words.seconds(seconds)} s** (YADE "
            f"{words.seconds(theirs)} s)")


def front_rows(m, yade):
    """The cheapest settings for every error, for gneiss and YADE."""
    return [[m.case, reading, kind, *(cheapest(m, reading, kind, wanted, yade) for wanted in WANTED)]
            for reading in ("strength", "E") for kind in KINDS]


WANTED = (0.10, 0.05, 0.02, 0.01)


def started(m, speed):
    """Rows of a speed, from rest and from the first break."""
    rows = {row.value: row for row in m.found["start"]}
    both = [rows.get((start, speed)) for start in ("rest", "first_break")]
    return [both] if all(both) else []


def fixed_points(m, reading):
    """(axis, seconds, error) of runs of the one packing, each against the finest of its axis."""
    points, found = [], m.found
    for row, in ((row,) for row in found["velocity"]):
        points.append(("velocity", row.seconds, abs(m.still[reading][1][row.value])))
    finest = min(found["safety"], key=lambda row: row.value)
    for name, reference in (("safety", finest), ("precision", found["precision"][0]), ("round-off", m.base)):
        for row in found[name]:
            if row is not reference:
                points.append((name, row.seconds, abs(row[READINGS[reading]] / reference[READINGS[reading]] - 1)))
    points += [("mass scaling", row.seconds, abs(row[READINGS[reading]] / m.base[READINGS[reading]] - 1)) for row in found["mass scaling"]
               if row.value != 1]
    for speed in sorted({row.value[1] for row in found["start"]}):
        points += [("start", b.seconds, abs(b[READINGS[reading]] / a[READINGS[reading]] - 1)) for a, b in started(m, speed)]
    at_base = m_base(found["damping"], READINGS[reading])
    points += [("damping", row.seconds, abs(row[READINGS[reading]] / at_base - 1)) for row in found["damping"] if row.value != BASE["damping"]]
    return [p for p in points if p[2] > 0]


def draw_front(pictures, measured):
    plt = pictures.plt()
    drawn, panels = plt.subplots(len(measured), 2, figsize=(11.5, 4.1 * len(measured)), squeeze=False)
    for line, m in zip(panels, measured):
        for axes, reading in zip(line, ("strength", "E")):
            draw_panel(axes, m, reading)
            pictures.seconds_axis(axes)
        line[1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5))
    return pictures.save(drawn, "front", "Error against seconds, all runs by axis, with the front of the cheapest")


def draw_panel(axes, m, reading):
    for name in ("velocity", "safety", "precision", "mass scaling", "start", "damping", "round-off"):
        points = [p for p in fixed_points(m, reading) if p[0] == name]
        axes.loglog([p[1] for p in points], [p[2] for p in points], "x", ms=5, color=words.COLOURS[name],
                    label=f"{name} (one packing)" if name != "damping" else f"damping, against {BASE['damping']}")
    every = settings(m, reading, "calibrated")
    for mark, speed in zip(words.MARKS, sorted({p[3] for p in every})):
        points = [p for p in every if p[3] == speed and p[4] == 1]
        axes.loglog([p[0] for p in points], [p[1] for p in points], mark, ms=5, color="#2ca02c", label=f"particles at {words.plain(speed)} m/s")
    averaged = [p for p in every if p[4] > 1]
    axes.loglog([p[0] for p in averaged], [p[1] for p in averaged], ".", ms=3, color="#98df8a", label="means over 2 to 10 packings")
    for kind, style in (("calibrated", "-"), ("constant", "--")):
        best = fits.front(settings(m, reading, kind))
        axes.step([p[0] for p in best], [p[1] for p in best], style, where="post", color="black", lw=1.4, label=f"the cheapest, {kind}")
    axes.axhline(m.floor[reading], color="#7f7f7f", ls=":", lw=1)
    axes.text(0.01, m.floor[reading], "round-off", transform=axes.get_yaxis_transform(), va="bottom", color="#555555", fontsize=7)
    largest = max(m.packing_scatter[reading])
    for count in sorted({largest, m.c.count} & set(m.packing_scatter[reading])):
        level = m.packing_scatter[reading][count]
        axes.axhline(level, color="#2ca02c", ls=":", lw=1)
        axes.text(0.99, level, f"packing, {count}", transform=axes.get_yaxis_transform(), ha="right", va="bottom", color="#1d6b1d", fontsize=7)
    axes.set_title(f"{m.case}: {reading}")
    axes.set_ylabel("error")


# --- the sections ------------------------------------------------------------------------------------------

UNITS = {"strength": 1e6, "E": 1e9, "nu": 1, "strain at the peak": 0.01}


def run_table(rows, what, name=words.plain):
    head = [what, "runs", "strength, MPa", "E, GPa", "nu", "strain at the peak, %", "broken in tension / shear", "energy residual",
            "background damping takes, of the work", "seconds", "steps", "MB"]
    lines = []
    for value, same in groups(rows).items():
        means = {r: np.nanmean(column(same, r)) / UNITS[r] for r in READINGS}
        work = np.nanmean(np.abs(column(same, "energy.work_walls"))) + np.nansum([np.nanmean(np.abs(column(same, "energy.work_prescribed")))])
        lines.append([name(value), len(same), f"{means['strength']:.2f}", f"{means['E']:.3f}", f"{means['nu']:.4f}",
                      f"{means['strain at the peak']:.4f}",
                      f"{np.mean(column(same, 'broken_tension')):.0f} / {np.mean(column(same, 'broken_shear')):.0f}",
                      f"{np.mean(column(same, 'energy_residual')):.1e}",
                      words.percent(np.nanmean(column(same, "energy.background_damping")) / work),
                      words.seconds(np.mean([row.seconds for row in same])), f"{np.mean(column(same, 'steps')):.0f}",
                      f"{np.mean(column(same, 'peak_memory')) / 1e6:.0f}"])
    return words.table(head, lines)


def pair(value):
    return f"{words.plain(value[0])}, {words.plain(value[1])}"


def slope_of(m, reading, effect):
    return next((row for row in m.slopes.rows if row["reading"] == reading and row["effect"] == effect), None)


def sentence_velocity(m):
    row = slope_of(m, "strength", "velocity")
    text = (f"**Velocity** {m.c.closing:g} m/s is g = {m.group(m.c.closing):.2g} (closing speed over wave speed, {m.wave:.0f} m/s, and strain at "
            f"the peak). ")
    still, changes, order = m.still["strength"]
    reached = ("the value at which halving the speed changes no more than round-off does" if order == 0 else
               f"Richardson's extrapolation of the slowest, of order {order:.1f}")
    text += f"The limit of slow loading is {still / 1e6:.2f} MPa ({reached}): the errors are "
    text += ", ".join(f"{words.signed(changes[v])} at {v:g} m/s (g = {m.group(v):.2g})" for v in sorted(changes)) + "."
    if row and row["exponent_error"]:
        text += f" Errors above round-off scale as g^{float(row['exponent']):.2f} (+- {float(row['exponent_error']):.2f})."
    return text


def sentence_size(m):
    (last, a, p), error, assumed = m.limits["strength"]
    n = max(m.n.values())
    gone = np.mean(column(m.by_count[max(m.by_count)], "strength")) / last - 1
    counts = sorted(m.by_count)[-3:]
    _, slope, _, slope_error = fits.line(np.log([m.n[k] for k in counts for _ in m.by_count[k]]),
                                         np.log([row["peak_stress"] for k in counts for row in m.by_count[k]]))
    law = (f"{last / 1e6:.1f} (+- {error[0] / 1e6:.1f}) MPa x (1 - {a / last:.2g} n^-{p:.2f})" +
           (", the exponent assumed (a layer at the surface)" if assumed else f", the exponent +- {error[2]:.2f}"))
    text = (f"**Particles.** At a constant contact strength the mean strength follows {law}; n: particles across the diameter, {n:.0f} with "
            f"{max(counts)}, which are {words.signed(gone)} from that limit. ")
    if abs(slope) <= 2 * slope_error:
        return text + (f"From {min(counts)} to {max(counts)} particles it no longer depends on their number (it goes as n^{slope:.2f} +- "
                       f"{slope_error:.2f}): keep contact strength constant.")
    text += (f"**It has not converged**: from {min(counts)} to {max(counts)} particles it still goes as n^{slope:.2f} (+- {slope_error:.2f}), so as r^"
             f"{-slope:.2f}. ")
    if abs(slope + 0.5) <= 2 * slope_error:
        return text + "That is the slope of a fracture toughness: hold contact strength times the root of the radius constant when the number is changed."
    worse = "and make the drift larger" if abs(slope + 0.5) > abs(slope) else "and make the drift smaller"
    return text + (f"Were it ruled by fracture toughness, contact strength times the root of the radius, it would go as n^-0.50: to hold that constant "
                   f"would give n^{slope + 0.5:.2f} {worse}. In a body without a notch calibrate with the number of particles that is used; "
                   f"between these numbers keep contact strength times n^{slope:.2f} constant.")


def sentence_floors(m):
    r, packings = m.floor, m.packing_scatter
    count = m.c.count if m.c.count in packings["strength"] else max(packings["strength"])
    return (f"**Floors.** Coordinates changed by a relative 1e-12 ({len(m.found['round-off'])} runs): strength {words.percent(r['strength'])}, E "
            f"{words.percent(r['E'])}. Packings of {count} particles ({len(m.by_count[count])} seeds): strength "
            f"{words.percent(packings['strength'][count])}, E {words.percent(packings['E'][count])} (standard deviations). Smaller differences between single "
            f"runs are not significant.")


def sentence_step(m):
    rows = {e: slope_of(m, "strength", e) for e in ("safety", "precision", "damping")}
    spread = np.ptp(column(m.found["safety"], "strength")) / np.mean(column(m.found["safety"], "strength"))
    range_ = max(r.value for r in m.found["safety"]) - min(r.value for r in m.found["safety"])
    s = float(rows["safety"]["coefficient"]) * range_
    e = float(rows["safety"]["coefficient_error"] or "nan") * range_
    mixed = float(rows["precision"]["coefficient"]) if rows["precision"] else 0.0
    a = {row.value: row["peak_stress"] for row in m.found["damping"]}
    ends = (min(a), max(a))
    below = "no more than" if abs(mixed) < m.noise["strength"] else "more than"
    return (f"**Step and precision**: {words.trend(s, e, 'strength over safety')}, all within {words.percent(spread)}; mixed precision changes it by "
            f"{words.signed(mixed)}, {below} round-off does to two runs. **Damping** is a choice of model, not an error that converges to zero: from "
            f"{ends[0]:g} to {ends[1]:g} the strength goes from {a[ends[0]] / 1e6:.1f} to {a[ends[1]] / 1e6:.1f} MPa, E changes by "
            f"{words.signed(m.found['damping'][-1]['young_modulus_average'] / m.found['damping'][0]['young_modulus_average'] - 1)}.")


def sentence_pairs(m):
    rows, v = {row.value: row["peak_stress"] for row in m.found["damping and velocity"]}, m.c.closing
    if not rows:
        return ""
    speeds = sorted({value[1] for value in rows})
    slow, fast = speeds[0], speeds[-1]
    faster = [f"{words.signed(rows[a, fast] / rows[a, slow] - 1)} with {a:g}" for a in sorted({value[0] for value in rows})]
    change = m.still["strength"][1]
    if fast in change and slow in change:
        faster.append(f"{words.signed((1 + change[fast]) / (1 + change[slow]) - 1)} with {BASE['damping']:g}")
    return (f"**Damping and velocity together**: from {slow:g} to {fast:g} m/s the strength changes by " + ", ".join(faster) +
            f" (the base is {v:g} m/s).")


def sentence_masses(m):
    rows = {row.value: row for row in m.found["mass scaling"]}
    if 1 not in rows or len(rows) < 2:
        return ""
    reported = [f"{value:g}: {words.signed(row['peak_stress'] / rows[1]['peak_stress'] - 1)}, {words.signed(row['young_modulus_average'] / rows[1]['young_modulus_average'] - 1)}, "
            f"{row['steps'] / rows[1]['steps']:.2f}" for value, row in sorted(rows.items()) if value != 1]
    beyond = [value for value, row in rows.items() if abs(row["peak_stress"] / rows[1]["peak_stress"] - 1) > m.noise["strength"]]
    return (f"**Mass scaling** (`time.mass_scaling.factor`: change of strength, of E, steps over those without) " + "; ".join(reported) + ". " +
            (f"Strength is changed by more than round-off does to two runs with {', '.join(f'{x:g}' for x in sorted(beyond))}." if beyond
             else "None changes strength by more than round-off does to two runs."))


def sentence_start(m):
    reported = []
    for speed in sorted({row.value[1] for row in m.found["start"]}, reverse=True):
        reported += [f"at {speed:g} m/s strength by {words.signed(b['peak_stress'] / a['peak_stress'] - 1)}, E by "
                 f"{words.signed(b['young_modulus_average'] / a['young_modulus_average'] - 1)}, seconds by "
                 f"{words.signed(b.seconds / a.seconds - 1)}" for a, b in started(m, speed)]
    return f"**Start at the first break** (`time.start: first_break`) changes " + "; ".join(reported) + "." if reported else ""


def sentence_gap(m):
    found = {r: slope_of(m, r, "gap") for r in ("strength", "E")}
    if not all(found.values()):
        return ""
    bonds = column(m.found["gap"], "bonds") * 2 / len(m.packing)
    text = ", ".join(f"{r} goes as its power {float(row['exponent']):.2f}" + (f" (+- {float(row['exponent_error']):.2f})" if row["exponent_error"] else "")
                     for r, row in found.items())
    return (f"**Gap of the bonds** is a choice of model as well: from {min(bonds):.1f} to {max(bonds):.1f} bonds per particle; {text}.")


def draw_axes(pictures, m):
    plt = pictures.plt()
    drawn, panels = plt.subplots(2, 3, figsize=(10.5, 5.6))
    plots = [("velocity", "closing speed, m/s", True), ("damping", "coefficient of the damping", False), ("safety", "safety", False),
             ("gap", "interaction range", False), ("particles", "particles", True)]
    for axes, (name, label, log) in zip(panels.flat, plots):
        rows = m.found[name] + (m.found["more particles"] if name == "particles" else [])
        axes.plot([row.value for row in rows], column(rows, "strength") / 1e6, ".", color=words.COLOURS[name])
        by = groups(rows)
        axes.plot(list(by), [np.nanmean(column(same, "strength")) / 1e6 for same in by.values()], "-", color=words.COLOURS[name])
        if log:
            axes.set_xscale("log")
        axes.set_xlabel(label)
        axes.set_ylabel("strength, MPa")
        if name == "safety":  # The scatter of packings: smaller deviations are not significant.
            middle = m.base["peak_stress"] / 1e6
            width = 2 * middle * m.packing_scatter["strength"].get(m.c.count, 0.02)
            axes.set_ylim(middle - width, middle + width)
            axes.axhspan(middle * (1 - 2 * m.floor["strength"]), middle * (1 + 2 * m.floor["strength"]), color="#7f7f7f", alpha=0.3, lw=0)
    axes = panels.flat[5]
    for reading, colour in (("strength", "#d62728"), ("E", "#1f77b4"), ("nu", "#2ca02c")):
        axes.loglog(list(m.packing_scatter[reading]), [100 * x for x in m.packing_scatter[reading].values()], "o-", color=colour, label=reading)
    axes.set_xlabel("particles")
    axes.set_ylabel("scatter over packings, %")
    axes.legend()
    return pictures.save(drawn, m.case, f"{m.case}: strength over every axis, scatter over packings")


def section(study, pictures, kind):
    c, found, packing = runs(study, kind)
    m = Measured(kind, c, found, packing)
    parts = [f"## {kind.capitalize()} of a cylinder",
             f"23 x 46 mm, {c.count} spheres of one packing (except where particles are varied), closing at {c.closing:g} m/s (both ends together), "
             f"`nonviscous_vector` damping {BASE['damping']}, safety {BASE['safety']}, bonds over gaps up to {100 * BASE['gap']:g} %, harmonic law, "
             f"contact strengths of 40 MPa. A run ends when the stress has fallen by a fifth; E is that over the average strain.",
             draw_axes(pictures, m)]
    parts += [sentence_floors(m), sentence_velocity(m), sentence_step(m), sentence_pairs(m), sentence_masses(m), sentence_start(m),
              sentence_gap(m), sentence_size(m)]
    details = []
    labels = {"velocity": "closing, m/s", "gap": "interaction range", "round-off": "changed copy (0: as packed)", "damping and velocity": "damping, m/s",
              "particles and velocity": "particles, m/s", "particles and slow loading": "particles, m/s", "start": "start, closing m/s", "mass scaling": "factor of mass scaling"}
    for name, rows in found.items():
        if rows:
            details += [f"{name.capitalize()}:", run_table(rows, labels.get(name, name), pair if isinstance(rows[0].value, tuple) else words.plain)]
    parts += ["<details><summary>All runs of this case</summary>", *details, "</details>"]
    return "\n\n".join(part for part in parts if part), m
