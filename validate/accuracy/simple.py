"""A case of a few axes and readings, each against a closed form, or against the finest run of its axis."""
from dataclasses import dataclass, field

import numpy as np

import fits
import words
from slopes import Slopes, at

NOTHING = 1e-12  # an error of rounding: no slope is read from it


@dataclass
class Case:
    """readings {label: row -> value}; truth {label: row -> value}, without it the finest value of the axis, `finest` {axis: value} or the
    last; groups {axis: (text, row -> dimensionless)}: slopes are read over these; several errors of one run may be readings with truth 0 and
    `absolute`."""
    name: str
    title: str
    intro: str
    readings: dict
    rows: dict
    truth: dict = field(default_factory=dict)
    finest: dict = field(default_factory=dict)
    limits: dict = field(default_factory=dict)  # axis: row -> x; the reference is the limit of large x, y = limit - a x^-p
    scattered: tuple = ()  # axes over which only the scatter has a slope
    groups: dict = field(default_factory=dict)
    absolute: tuple = ()
    units: dict = field(default_factory=dict)  # label: (factor, text)
    models: tuple = ()  # axes that are choices of a model: no errors
    others: dict = field(default_factory=dict)  # label: [(seconds, error)] of other programs, for the picture
    more: object = None  # function: Measured -> further text


def by_value(rows):
    found = {}
    for row in rows:
        found.setdefault(row.value, []).append(row)
    return found


class Measured:
    def __init__(self, case):
        self.case, self.slopes = case, Slopes(case.name)
        self.errors = {}  # (axis, reading): [(value, group, mean error, scatter, seconds, runs)]
        for axis, rows in case.rows.items():
            for reading, of in case.readings.items():
                self.errors[axis, reading] = self.of_axis(axis, reading, of, by_value(rows))
        self.fit()

    def reference(self, axis, reading, of, same):
        if reading in self.case.truth:
            return None
        first, means = axis in ("precision", "round-off"), {value: np.nanmean([of(row) for row in rows]) for value, rows in same.items()}
        if axis in self.case.limits:
            return fits.limit([self.case.limits[axis](rows[0]) for rows in same.values()], list(means.values()))[0]
        if axis == "velocity":  # speeds halve from one to the next
            shaken = np.array([of(row) for row in self.case.rows.get("round-off", [])], float)
            noise = 2 * np.sqrt(2) * fits.scatter(shaken) if np.isfinite(shaken).sum() > 2 else 0.0
            return fits.halved([means[value] for value in sorted(means)], noise)[0]
        return means[self.case.finest.get(axis, list(same)[0 if first else -1])]

    def of_axis(self, axis, reading, of, same):
        found, reference = [], self.reference(axis, reading, of, same) if same else None
        for value, rows in same.items():
            wanted = [self.case.truth[reading](row) if reference is None else reference for row in rows]
            off = np.array([of(row) - w if reading in self.case.absolute else of(row) / w - 1 for row, w in zip(rows, wanted)], float)
            off = off[np.isfinite(off)]
            if not len(off):
                continue
            group = self.case.groups[axis][1](rows[0]) if axis in self.case.groups else float("nan")
            found.append((value, group, off.mean(), off.std(ddof=1) if len(off) > 1 else float("nan"), np.mean([row.seconds for row in rows]), len(off)))
        return found

    def fit(self):
        for (axis, reading), points in self.errors.items():
            if axis in self.case.models or axis not in self.case.groups:
                if len(points) == 2 and axis == "precision":
                    if np.isfinite(points[1][3]) and abs(points[1][2]) <= self.chance(axis, reading, points[1]):
                        continue  # in means over seeds the difference may be random
                    self.slopes.constant(reading, axis, "bias", points[1][2] - points[0][2], 1)
                elif points and points[0][5] > 2 and axis not in self.case.models:
                    self.slopes.constant(reading, axis, "scatter", points[0][3], points[0][5])
                elif axis == "round-off" and len(points) > 2:
                    self.slopes.constant(reading, axis, "scatter", float(np.std([p[2] for p in points], ddof=1)), len(points))
                continue
            beyond = [p for p in points if abs(p[2]) > max(NOTHING, self.chance(axis, reading, p))]
            if axis not in self.case.scattered:
                self.slopes.power(reading, axis, "bias", self.case.groups[axis][0], [p[1] for p in beyond], [p[2] for p in beyond])
            scattered = [p for p in points if np.isfinite(p[3]) and p[3] > NOTHING]
            if len(scattered) > 2:
                self.slopes.power(reading, axis, "scatter", self.case.groups[axis][0], [p[1] for p in scattered], [p[3] for p in scattered])

    def chance(self, axis, reading, point):
        """The possible error by chance of a mean over seeds: two standard errors of the mean and of its reference;
        for single runs the difference of two runs by round-off."""
        if np.isfinite(point[3]):
            return 2 * np.sqrt(2) * point[3] / np.sqrt(point[5]) if reading not in self.case.absolute else 0.0
        shaken = [p[2] for p in self.errors.get(("round-off", reading), [])]
        return 2 * np.sqrt(2) * float(np.std(shaken, ddof=1)) if len(shaken) > 2 else 0.0

    def sentences(self):
        text = []
        for row in self.slopes.rows:
            if row["form"] != "power" or row["kind"] != "bias":
                continue
            points = [p for p in self.errors[row["effect"], row["reading"]]
                      if abs(p[2]) > max(NOTHING, self.chance(row["effect"], row["reading"], p))]
            least, most = min(points, key=lambda p: abs(p[2])), max(points, key=lambda p: abs(p[2]))
            error = f" (+- {float(row['exponent_error']):.2f})" if row["exponent_error"] else ""
            text.append(f"{row['reading']}, {row['effect']}: {words.percent(abs(most[2]))} at {words.plain(most[0])} ({words.seconds(most[4])} s), "
                        f"{words.percent(abs(least[2]))} at {words.plain(least[0])} ({words.seconds(least[4])} s); as g^{float(row['exponent']):.2f}{error}")
        return text


def chance_words(m, axis, reading):
    """Words on whether the ends of an axis differ by more than seeds do, for grains, which come to rest in other positions after every change."""
    points = m.errors[axis, reading]
    least, most = min(points, key=lambda p: p[0]), max(points, key=lambda p: p[0])
    means = np.hypot(least[3] / np.sqrt(least[5]), most[3] / np.sqrt(most[5]))
    if not np.isfinite(means):
        return ""
    apart = abs(least[2] - most[2])
    clear = "is no more than" if apart <= 2 * means else "is more than"
    return (f"Grains come to rest at other positions after every change, so single runs scatter: {words.percent(most[3])} in the {reading} over {most[5]} seeds. "
            f"Between {least[0]:g} and {most[0]:g} {axis} the means differ by {words.percent(apart)}, which {clear} their scatter allows "
            f"({words.percent(2 * means)} at two standard errors).")


def axis_table(m, axis):
    case, same = m.case, by_value(m.case.rows[axis])
    head = [axis, "runs"] + [name + (f", {case.units[name][1]}" if name in case.units else "") for name in case.readings]
    head += [f"error: {name}" for name in case.readings if axis not in case.models and name not in case.absolute]
    bonded = any(row["bonds"] > 0 and row["steps"] > 0 for rows in same.values() for row in rows)
    head += (["broken in tension / shear"] if bonded else []) + ["energy residual", "seconds", "steps", "MB"]
    lines = []
    for value, rows in same.items():
        line = [words.plain(value), len(rows)]
        for name, of in case.readings.items():
            values = np.array([of(row) for row in rows], float) / case.units.get(name, (1,))[0]
            spread = f" +- {np.nanstd(values, ddof=1):.2g}" if len(values) > 1 else ""
            line.append(words.figure(np.nanmean(values)) + spread)
        for name in case.readings:
            if axis not in case.models and name not in case.absolute:
                point = next((p for p in m.errors[axis, name] if p[0] == value), None)
                line.append(words.signed(point[2]) if point else "-")
        residual = np.array([row["energy_residual"] for row in rows], float)
        if bonded:
            line.append(f"{np.mean([row['broken_tension'] for row in rows]):.0f} / {np.mean([row['broken_shear'] for row in rows]):.0f}")
        line += [f"{np.max(np.abs(residual)):.1e}" if np.isfinite(residual).all() else "-",
                 words.seconds(np.mean([row.seconds for row in rows])), f"{np.mean([row['steps'] for row in rows]):.0f}",
                 f"{np.mean([row['peak_memory'] for row in rows]) / 1e6:.0f}"]
        lines.append(line)
    return words.table(head, lines)


def draw(pictures, m):
    plt, names = pictures.plt(), list(m.case.readings)
    drawn, panels = plt.subplots(1, len(names), figsize=(4.6 * len(names), 3.6), squeeze=False)
    for axes, name in zip(panels.flat, names):
        for k, axis in enumerate(a for a in m.case.rows if a not in m.case.models):
            points = [p for p in m.errors[axis, name] if abs(p[2]) > NOTHING]
            if not points:
                continue
            mark = words.MARKS[k % len(words.MARKS)] + ("" if axis == "round-off" else "-")
            axes.loglog([p[4] for p in points], [abs(p[2]) for p in points], mark, ms=4, lw=0.7, color=words.COLOURS.get(axis, f"C{k}"), label=axis)
        for (label, points), mark in zip(m.case.others.items(), "x+1"):
            axes.loglog([p[0] for p in points], [abs(p[1]) for p in points], mark + "--", lw=0.7, color="black", label=label)
        floor = np.std([p[2] for p in m.errors["round-off", name]], ddof=1) if len(m.errors.get(("round-off", name), [])) > 2 else 0.0
        if floor > NOTHING:
            axes.axhline(floor, color=words.COLOURS["round-off"], ls=":", lw=1, label="scatter by round-off")
        if axes.lines:
            axes.legend(fontsize=6)
        axes.set_title(name)
        pictures.seconds_axis(axes)
        axes.set_ylabel("error")
    return pictures.save(drawn, m.case.name, f"{m.case.title}: error over seconds, by axis")


def section(pictures, case):
    m = Measured(case)
    found = m.sentences()
    parts = [f"## {case.title}", case.intro, draw(pictures, m)]
    if case.more:
        parts.append(case.more(m))
    if found:
        parts.append("\n".join(f"- {line}" for line in found))
    details = "\n\n".join(f"{axis.capitalize()}:\n\n{axis_table(m, axis)}" for axis in case.rows if case.rows[axis])
    parts.append(f"<details><summary>All runs of this case</summary>\n\n{details}\n\n</details>")
    return "\n\n".join(parts), m


__all__ = ["Case", "Measured", "section", "at"]
