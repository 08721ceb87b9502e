"""The page of `report.py` on a sweep: readings over parameters with their intervals, maps over two of them, tables.
It reads sweep.h5 (the layout is in docs/sweep.md) and writes one page that holds its pictures."""
import base64
import itertools
import os
import re
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

import report_envelope
from report_curves import BLUE, GREY, INK, RED, save
from report_page import STYLE, draw, escape, is_inside, table, write_page
from report_files import FileFault, opened
from report_results import Column, Unreadable, _text, quantity, scale_of

FIRST = ("axial_strength", "indirect_tensile_strength", "flexural_strength", "shear_strength", "peak_stress", "young_modulus", "poisson_ratio", "peak_strain", "largest_stress", "energy.residual")
MOST_READINGS, MOST_PANELS, MOST_MAPS, MOST_LINES, MOST_CURVES = 8, 4, 3, 7, 200
COLOURS = (BLUE, RED, "#2f8f5b", "#8a5fb0", "#c78a1c", "#3d9fb0", "#7a5c45")
STATES = ("new", "interrupted", "done", "failed")


class Parameter:
    """`value`: a number for every run, SI; `names`: the texts of a parameter without numbers."""

    def __init__(self, key, dataset):
        self.key = key
        self.value = np.asarray(dataset[()], float)
        self.unit = _text(dataset.attrs.get("unit", ""))
        self.sampled = bool(np.asarray(dataset.attrs.get("sampled", 0)).reshape(-1)[0])
        self.names = _text(dataset.attrs["values"]).split("\n") if "values" in dataset.attrs else None
        self.levels = np.unique(self.value)

    def text(self, value):
        if self.names:
            return self.names[int(value)]
        return quantity(value, self.unit, 6)

    def axis(self):
        """(values to draw, label, whether the axis is logarithmic, texts of the ticks)."""
        if self.names:
            used = {name: k for k, name in enumerate(dict.fromkeys(self.names[int(v)] for v in self.value))}
            return np.array([used[self.names[int(v)]] for v in self.value], float), self.key, False, list(used)
        sign = -1.0 if np.all(self.value < 0) else 1.0
        factor, unit = scale_of(self.value, self.unit)
        shown = sign * self.value / factor
        log = bool(np.all(shown > 0) and shown.max() / shown.min() > 12)
        label = ("−" if sign < 0 else "") + self.key + (f" [{unit}]" if unit else "")
        return shown, label, log, None


class Sweep:
    def __init__(self, path):
        with opened(path, "of a sweep", "`gneiss sweep` with --collect writes it anew") as file:
            self._read(file)

    def _read(self, file):
        self.attributes = {name: _text(value) for name, value in file.attrs.items()}
        self.sweep, self.scene = _text(file["sweep"][()]), _text(file["scene"][()])
        self.parameters = [Parameter(key, data) for key, data in file.get("parameters", {}).items()]
        self.readings = {name: Column(data) for name, data in file.get("readings", {}).items()}
        self.envelope = report_envelope.read(file["envelope"]) if "envelope" in file else None
        self.statistics = {name: {what: np.asarray(data[()], float) for what, data in group.items()}
                           for name, group in file.get("statistics", {}).items()}
        runs = file["runs"]
        self.combination = np.asarray(runs["combination"][()], int)
        self.envelope_of_run = np.asarray(runs["envelope"][()], int).reshape(-1) if "envelope" in runs else None
        self.seed = np.asarray(runs["seed"][()])
        self.status = np.asarray(runs["status"][()], int)
        self.seconds, self.steps = np.asarray(runs["seconds"][()], float), np.asarray(runs["steps"][()], int)
        lines = {name: _text(runs[name][()]).split("\n") for name in ("state_hash", "folder", "message")}
        self.state_hash, self.folder, self.message = (lines[k] for k in ("state_hash", "folder", "message"))
        # a combination has the parameters of its first run
        self.first = np.array([np.flatnonzero(self.combination == c)[0] for c in np.unique(self.combination)], int)

    @property
    def varied(self):
        return [p for p in self.parameters if len(p.levels) > 1]

    def shown_readings(self):
        """Returns the readings that are drawn: those with numbers, the most usual first."""
        return self.distinct()[:MOST_READINGS]

    def distinct(self):
        """Returns the readings with numbers, the most usual first. Of readings with equal values in every run (the
        axial strength and the largest stress may be equal) only the first is returned."""
        there = [name for name, column in self.readings.items() if np.isfinite(column.value).any()]
        ordered = [name for name in FIRST if name in there] + [name for name in there if name not in FIRST]
        found = []
        for name in ordered:
            values = np.asarray(self.readings[name].value, float)
            if not any(self.readings[n].unit == self.readings[name].unit and
                       np.array_equal(values, np.asarray(self.readings[n].value, float), equal_nan=True) for n in found):
                found.append(name)
        return found

    def label(self, run, without=()):
        return ", ".join(f"{p.key} = {p.text(p.value[run])}" for p in self.varied if p not in without)


# --- pictures ------------------------------------------------------------------------------------------

def scaled(sweep, name):
    """(mean, interval, values of runs, label) in a unit with a prefix."""
    column, s = sweep.readings[name], sweep.statistics[name]
    factor, unit = scale_of(column.value, column.unit)
    label = name.replace("_", " ") + (f" [{unit}]" if unit else "")
    return s["mean"] / factor, s["interval"] / factor, np.asarray(column.value, float) / factor, label


def dress(parameter, axes, which):
    """Sets the axis x or y: texts for parameters without numbers, a tick for every value if there are few."""
    shown, label, log, ticks = parameter.axis()
    axis = getattr(axes, which + "axis")
    axis.set_label_text(label)
    if log:
        getattr(axes, f"set_{which}scale")("log")
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    few = np.unique(shown)
    if ticks is not None:
        axis.set_ticks(range(len(ticks)), ticks)
    elif len(few) <= 7 and not parameter.sampled:
        axis.set_ticks(few, [f"{value:.4g}" for value in few])
        axis.set_ticks([], minor=True)


def groups(sweep, parameter):
    """Groups of combinations that differ only in this parameter: [(label, places of combinations)]."""
    found = {}
    others = [p for p in sweep.varied if p is not parameter]
    for place, run in enumerate(sweep.first):
        found.setdefault(tuple(p.value[run] for p in others), []).append(place)
    return [(sweep.label(sweep.first[places[0]], (parameter,)), places) for places in found.values()]


def plot_panel(sweep, name, parameter, axes):
    """Mean and 95 % interval over one parameter, single runs behind; points alone if combinations differ in every
    parameter (a sample) or lines would be too many."""
    mean, interval, values, label = scaled(sweep, name)
    x = parameter.axis()[0]
    if np.any(sweep.statistics[name]["count"] > 1):
        axes.plot(x, values, "o", markersize=3, color=GREY, zorder=3)
    lines = groups(sweep, parameter)
    joined = not any(p.sampled for p in sweep.varied) and len(lines) <= MOST_LINES
    if not joined:
        axes.errorbar(x[sweep.first], mean, np.nan_to_num(interval), fmt="o", markersize=4, capsize=2, color=BLUE,
                      elinewidth=1)
    else:
        for (text, places), colour in zip(lines, COLOURS):
            places = np.array(places)[np.argsort(x[sweep.first[places]])]
            axes.errorbar(x[sweep.first[places]], mean[places], np.nan_to_num(interval[places]), marker="o", markersize=4,
                          capsize=3, elinewidth=1, color=colour, label=text or None)
        if any(text for text, _ in lines):
            axes.legend(fontsize=7, loc="lower left", bbox_to_anchor=(0, 1), ncol=1 if len(lines) < 3 else 2, borderaxespad=0.2)
    dress(parameter, axes, "x")
    axes.set_ylabel(label)


def plot_curves(sweep, name, path):
    panels = sweep.varied[:MOST_PANELS]
    if not panels:
        return plot_seeds(sweep, name, path)
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(5.6 * columns, 3.7 * rows), constrained_layout=True, squeeze=False)
    for k, parameter in enumerate(panels):
        plot_panel(sweep, name, parameter, axes.flat[k])
    for rest in axes.flat[len(panels):]:
        rest.axis("off")
    save(figure, path)
    repeated = np.any(sweep.statistics[name]["count"] > 1)
    return f"{name.replace('_', ' ')}: {sweep.readings[name].text}" + (
        "; mean and its 95 % interval over the seeds, single runs in grey" if repeated else "")


def plot_seeds(sweep, name, path):
    mean, interval, values, label = scaled(sweep, name)
    figure, axes = plt.subplots(figsize=(5.6, 3.7), constrained_layout=True)
    axes.plot(np.arange(len(values)), values, "o", color=BLUE)
    axes.axhline(mean[0], color=RED)
    if np.isfinite(interval[0]):
        axes.axhspan(mean[0] - interval[0], mean[0] + interval[0], color=RED, alpha=0.15)
    axes.set_xticks(np.arange(len(values)), [str(int(s)) for s in sweep.seed], fontsize=8)
    axes.set_xlabel("seed")
    axes.set_ylabel(label)
    save(figure, path)
    return f"{name.replace('_', ' ')} over the seeds; mean and its 95 % interval in red"


def edges(x, log):
    """Borders of cells around values, halfway between neighbours."""
    u = np.log(x) if log else x
    middle = 0.5 * (u[1:] + u[:-1])
    border = np.concatenate(([u[0] - (middle[0] - u[0])], middle, [u[-1] + (u[-1] - middle[-1])]))
    return np.exp(border) if log else border


def plot_map(sweep, name, pair, path):
    """Plots means over two parameters: cells of a grid (averaged over the other parameters), or points of a sample."""
    mean, _, _, label = scaled(sweep, name)
    if not np.isfinite(mean).sum() > 3:
        return None
    (x, _, x_log, _), (y, _, y_log, _) = (p.axis() for p in pair)
    x, y = x[sweep.first], y[sweep.first]
    figure, axes = plt.subplots(figsize=(6.0, 4.4), constrained_layout=True)
    axes.grid(False)
    if any(p.sampled for p in pair):
        drawn = axes.scatter(x, y, c=mean, s=60, edgecolors=INK, linewidths=0.4)
    else:
        across, up = np.unique(x), np.unique(y)
        cells = np.full((len(up), len(across)), np.nan)
        for j, i in itertools.product(range(len(up)), range(len(across))):
            here = mean[(x == across[i]) & (y == up[j])]
            if np.isfinite(here).any():
                cells[j, i] = np.nanmean(here)
        drawn = axes.pcolormesh(edges(across, x_log), edges(up, y_log), cells)
        if cells.size <= 64:
            write_cells(axes, across, up, cells)
    figure.colorbar(drawn, label=label)
    dress(pair[0], axes, "x")
    dress(pair[1], axes, "y")
    save(figure, path)
    return f"{name.replace('_', ' ')} over {pair[0].key} and {pair[1].key}" + (
        "" if len(sweep.varied) == 2 else ", mean over the other parameters")


def write_cells(axes, across, up, cells):
    low, high = np.nanmin(cells), np.nanmax(cells)
    for j, i in itertools.product(range(len(up)), range(len(across))):
        if np.isfinite(cells[j, i]):
            dark = cells[j, i] < low + 0.55 * (high - low)
            axes.text(across[i], up[j], f"{cells[j, i]:.4g}", ha="center", va="center", fontsize=8,
                      color="white" if dark else INK)


def draw_pictures(sweep, folder):
    jobs = {"sweep_curves": lambda path: plot_runs(sweep, folder, path)}
    for name in sweep.shown_readings():
        file = re.sub(r"[^\w]", "_", name)
        jobs[f"sweep_{file}"] = lambda path, name=name: plot_curves(sweep, name, path)
        for k, pair in enumerate(itertools.islice(itertools.combinations(sweep.varied, 2), MOST_MAPS)):
            jobs[f"sweep_{file}_map{k + 1}"] = lambda path, name=name, pair=pair: plot_map(sweep, name, pair, path)
    return draw(jobs, folder)


# --- curves of the runs --------------------------------------------------------------------------------

def curve_of(path):
    """Returns (strain, stress) of a run; None, with a message, if it has no test or its results cannot be read."""
    try:
        with opened(path, "a results file", "`gneiss sweep` computes the run again") as file:
            history = file["history"]
            if "strain" in history and "stress" in history:
                strain, stress = history["strain"][()], history["stress"][()]
                return (strain, stress) if np.isfinite(strain).any() and np.isfinite(stress).any() else None
    except (FileFault, Unreadable, KeyError) as e:
        print(f"gneiss: warning: a curve is left out: {e}", file=sys.stderr)
    return None


def plot_runs(sweep, folder, path):
    """Stress over strain of all runs, those of one combination in one colour."""
    done = [k for k in range(len(sweep.status)) if sweep.status[k] == 2 and is_inside(sweep.folder[k])][:MOST_CURVES]
    curves = [(k, curve_of(os.path.join(folder, sweep.folder[k], "results.h5"))) for k in done]
    curves = [(k, c) for k, c in curves if c]
    if not curves:
        return None
    factor, unit = scale_of(np.concatenate([stress for _, (_, stress) in curves]), "Pa")
    combinations = list(dict.fromkeys(int(sweep.combination[k]) for k, _ in curves))
    colours = COLOURS if len(combinations) <= len(COLOURS) else plt.cm.viridis(np.linspace(0, 0.95, len(combinations)))
    figure, axes = plt.subplots(figsize=(8.0, 4.6), constrained_layout=True)
    named = set()
    for k, (strain, stress) in curves:
        place = combinations.index(int(sweep.combination[k]))
        label = sweep.label(k) if place not in named and len(combinations) <= 12 else None
        named.add(place)
        axes.plot(100 * strain, stress / factor, color=colours[place], lw=1.1, alpha=0.85, label=label or None)
    axes.set_xlabel("strain of the test [%]")
    axes.set_ylabel(f"stress of the test [{unit}]")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    save(figure, path)
    left = sum(sweep.status == 2) - len(curves)
    return "Stress over strain of every run, those of one combination in one colour." + (f" {left} runs have no curve here." if left else "")


def strengths(sweep):
    """(confinements, axial strengths) of the runs."""
    return [np.asarray(sweep.readings[name].value, float).reshape(-1) for name in ("confinement", "axial_strength")]


def envelope_part(sweep, folder):
    """Friction angle, cohesion and m_i with their picture; "" without an envelope."""
    if sweep.envelope is None:
        return ""
    envelopes, both = sweep.envelope, strengths(sweep)
    place = sweep.envelope_of_run if sweep.envelope_of_run is not None else np.zeros(len(both[0]))
    captions = draw({"sweep_envelope": lambda path: report_envelope.plot(*both, place, envelopes, path)}, folder)
    several = len(envelopes) > 1
    rows = [row if several else row[1:] for label, found in envelopes for row in report_envelope.rows_of(label, found)]
    head = ("of the runs with", "of the envelope", "value", "absent because")
    return (f"<h2>Strength envelope{'s' if several else ''}</h2>{embedded(folder, 'sweep_envelope', captions['sweep_envelope'])}"
            f"{table(rows, head if several else head[1:])}")


# --- the page ------------------------------------------------------------------------------------------

def embedded(folder, name, caption):
    with open(os.path.join(folder, "report", name + ".png"), "rb") as file:
        data = base64.b64encode(file.read()).decode()
    return (f'<figure class="wide"><img src="data:image/png;base64,{data}" alt="{escape(name)}">'
            f"<figcaption>{escape(caption)}</figcaption></figure>")


def mean_text(sweep, name, c):
    s, unit = sweep.statistics[name], sweep.readings[name].unit
    mean, interval = s["mean"][c], s["interval"][c]
    if not np.isfinite(mean):
        return "–"
    factor, prefixed = scale_of([mean], unit)
    spread = f" ± {interval / factor:.2g}" if np.isfinite(interval) else ""
    return f"{mean / factor:.4g}{spread} {prefixed}".strip()


def means_table(sweep):
    names = sweep.distinct()
    head = [p.key for p in sweep.varied] + ["runs"] + [name.replace("_", " ") for name in names]
    rows = []
    for c, run in enumerate(sweep.first):
        done = int(np.sum(sweep.status[sweep.combination == c] == 2))
        rows.append([p.text(p.value[run]) for p in sweep.varied] + [(done, "number")]
                    + [(mean_text(sweep, name, c), "number") for name in names])
    return table(rows, head)


def link_of(sweep, folder, k):
    """The report of a run where it was made, else its folder."""
    inside = sweep.folder[k]
    report = os.path.join(inside, "report.html")
    return report if os.path.exists(os.path.join(folder, report)) else inside + "/"


def reading_of(sweep, name, k):
    value = float(np.asarray(sweep.readings[name].value, float).reshape(-1)[k])
    return quantity(value, sweep.readings[name].unit) if np.isfinite(value) else "–"


def runs_table(sweep, folder):
    names = sweep.shown_readings()
    head = ("run", "parameters", "seed", "status", *(name.replace("_", " ") for name in names), "seconds", "steps", "state hash")
    rows = [((k + 1, "number", link_of(sweep, folder, k)), sweep.label(k), (int(sweep.seed[k]), "number"), STATES[sweep.status[k]],
             *((reading_of(sweep, name, k), "number") for name in names),
             (f"{sweep.seconds[k]:.3g}" if np.isfinite(sweep.seconds[k]) else "", "number"),
             (int(sweep.steps[k]) or "", "number"), sweep.state_hash[k])
            for k in range(len(sweep.status))]
    return table(rows, head)


def banner(sweep):
    failed = np.flatnonzero(sweep.status == 3)
    left = int(np.sum(sweep.status < 2))
    parts = "".join(f'<p class="warning"><b>Run {k + 1} failed.</b> {escape(sweep.label(k))}: {escape(sweep.message[k])}</p>'
                    for k in failed[:20])
    if len(failed) > 20:
        parts += f'<p class="warning">and {len(failed) - 20} more failed runs: see sweep.csv</p>'
    if left:
        parts += f'<p class="warning"><b>Unfinished.</b> {left} of {len(sweep.status)} runs are still to be done.</p>'
    return parts


def page(sweep, folder, captions):
    title = sweep.attributes.get("title") or "gneiss sweep"
    pictures = "".join(embedded(folder, name, caption) for name, caption in captions.items())
    seeds = int(sweep.attributes.get("seeds", "0").strip("[]") or 0)
    subtitle = " · ".join(filter(None, (
        f"gneiss {sweep.attributes.get('version', '')}", f"{len(sweep.status)} runs", f"{len(sweep.first)} combinations",
        f"{seeds} seeds" if seeds else "", sweep.attributes.get("scene_file", ""))))
    details = "".join(f"<details><summary>{name}</summary>{body}</details>" for name, body in (
        ("Every run: its readings and its report or folder", runs_table(sweep, folder)),
        ("The sweep file", f"<pre>{escape(sweep.sweep)}</pre>" if sweep.sweep else ""),
        ("The scene that was varied", f"<pre>{escape(sweep.scene)}</pre>")) if body)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title><style>{STYLE} .scroll {{ overflow-x: auto; }}</style></head><body>
<h1>{escape(title)}</h1>
<p class="soft">{escape(subtitle)}</p>
{banner(sweep)}
<h2>Readings</h2>
{f'<div class="grid">{pictures}</div>' if pictures else "<p>No run is done: there is nothing to draw.</p>"}
{envelope_part(sweep, folder)}
<h2>Means and 95 % intervals</h2>
<div class="scroll">{means_table(sweep)}</div>
<h2>Runs</h2>
<div class="scroll">{details}</div>
<p class="soft">Numbers: <code>sweep.csv</code>, <code>sweep-means.csv</code>, <code>sweep.h5</code>, next to this page.</p>
</body></html>
"""


def write_sweep_report(folder):
    sweep = Sweep(os.path.join(folder, "sweep.h5"))
    return write_page(folder, page(sweep, folder, draw_pictures(sweep, folder)))
