"""Pictures of the bench results.

plots.py RESULTS PICTURES    from RESULTS/steps.json and RESULTS/peers.json to PICTURES/performance-*.png

  performance-threads.png   speed-up from one thread to two, by scene
  performance-size.png      cost of a contact-step over the number of particles (needs --sweep)
  performance-effects.png   cost of each effect on top of the bare step
  performance-peers.png     gneiss beside other codes (needs --peers)

A picture whose results are not there is left as it is.
"""
import io
import json
import math
import os
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter
from PIL import Image

from table import MILLISECONDS, medians

INK, BLUE, RED, GREY = "#22303c", "#2b6cb0", "#c8402f", "#9aa5ad"
WIDTH, DPI = 8.0, 100  # 800 pixels
COLOURS = {"double": BLUE, "mixed": RED}

plt.rcParams.update({
    "font.size": 11, "axes.labelcolor": INK, "axes.edgecolor": "#5c6b76", "text.color": INK, "axes.titlesize": 12,
    "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "grid.color": "#e5e9ec", "xtick.color": INK, "ytick.color": INK,
    "legend.frameon": False, "lines.linewidth": 1.8, "savefig.dpi": DPI,
})


class Step:
    """Returns the result of one whole-step bench with the widest instruction set."""

    def __init__(self, name, entry):
        self.model = name.split("/")[1]
        self.scene = self.model.removesuffix("-mixed")
        self.precision = "mixed" if self.model.endswith("-mixed") else "double"
        self.threads = int(entry["threads"])
        self.particles = entry["particles"]
        self.ns = 1e9 * entry["per contact-step"]
        self.seconds = 1e-3 * MILLISECONDS[entry["time_unit"]] * entry["real_time"]


def widest_steps(results):
    isa = results["context"]["isa"]
    split = [(name, name.split("/"), entry) for name, entry in medians(results).items()]
    return [Step(name, entry) for name, words, entry in split
            if words[0] == "step" and words[2] != "copies" and words[3] == isa]


def read(path):
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8") as f:
        return json.load(f)


def made_with(results):
    """Version, instruction set, processor, date and load, which a figure needs to be comparable."""
    c = results["context"]
    return (f"gneiss {c['gneiss']}, {c['isa']}, {c['num_cpus']} x {c['cpu']}, {c['date'][:10]}, "
            f"load {c['load_at_start'].split()[0]}")


def save(figure, folder, name, note):
    figure.supxlabel(note, fontsize=8, color="#5c6b76")
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    plt.close(figure)
    # 40 colours are enough for bars and lines, and make a third of the bytes.
    Image.open(picture).convert("RGB").quantize(40).save(os.path.join(folder, name), optimize=True)


def grouped(count):
    """12345 -> '12 345'."""
    return f"{count:,.0f}".replace(",", " ")


def bars(axes, names, values, colours, text, whiskers=None):
    """Horizontal bars, the first on top, each with its text at its end."""
    places = range(len(names) - 1, -1, -1)
    axes.barh(places, values, color=colours, height=0.68, xerr=whiskers,
              error_kw={"ecolor": INK, "elinewidth": 1, "capsize": 2})
    axes.set_yticks(list(places), names)
    axes.grid(axis="y", visible=False)
    for k, (place, value) in enumerate(zip(places, values)):
        end = value + (whiskers[1][k] if whiskers else 0.0)
        axes.annotate(text[k], (end, place), xytext=(4, 0), textcoords="offset points", va="center", fontsize=10,
                      bbox={"facecolor": "white", "edgecolor": "none", "pad": 1})


def lattice(step):
    """True for the frictional lattices that differ in size only."""
    return re.fullmatch(r"fcc-\d+k?", step.scene) is not None


def plot_threads(results, folder):
    steps = {(s.model, s.threads): s for s in widest_steps(results)}
    both = [(one, steps[model, 2]) for (model, threads), one in steps.items()
            if threads == 1 and (model, 2) in steps]
    if not both:
        return False
    scenes = list(dict.fromkeys(one.scene for one, _ in both))
    both.sort(key=lambda pair: pair[0].particles if lattice(pair[0]) else scenes.index(pair[0].scene) - len(scenes))
    figure, axes = plt.subplots(figsize=(WIDTH, 1.3 + 0.3 * len(both)), constrained_layout=True)
    ratios = [one.seconds / two.seconds for one, two in both]
    bars(axes, [f"{one.model} ({grouped(one.particles)})" for one, _ in both], ratios,
         [COLOURS[one.precision] for one, _ in both], [f"{r:.2f}" for r in ratios])
    axes.axvline(2.0, color=INK, linewidth=1, linestyle="--")
    axes.set_xlim(0, max(2.2, 1.1 * max(ratios)))
    axes.set_xlabel("speed-up from 1 thread to 2 [-]")
    axes.set_ylabel("scene (particles)")
    axes.set_title("Two threads against one, whole steps")
    save(figure, folder, "performance-threads.png", made_with(results))
    return True


def plot_size(results, folder):
    lattices = [s for s in widest_steps(results) if lattice(s)]
    if len({s.particles for s in lattices}) < 3:
        return False
    figure, axes = plt.subplots(figsize=(WIDTH, 4.4), constrained_layout=True)
    for precision in COLOURS:
        for threads, line in ((1, {"linestyle": "--", "markerfacecolor": "white"}), (2, {})):
            series = sorted((s.particles, s.ns) for s in lattices if (s.precision, s.threads) == (precision, threads))
            if series:
                axes.plot(*zip(*series), marker="o", markersize=6, color=COLOURS[precision],
                          label=f"{precision}, {threads} thread{'s' if threads > 1 else ''}", **line)
    axes.set_xscale("log")
    axes.set_ylim(bottom=0)
    axes.set_xlabel("particles [-]")
    axes.set_ylabel("cost of a contact-step [ns]")
    axes.set_title("Frictional fcc lattice, 6 contacts per particle")
    axes.legend()
    save(figure, folder, "performance-size.png", made_with(results))
    return True


def plot_effects(results, folder):
    """Plots processor time on one thread, like the table."""
    effects = {n.split("/")[1]: e for n, e in medians(results).items() if n.startswith("effect/")}
    if "none" not in effects:
        return False
    cost = {n: 1e6 * MILLISECONDS[e["time_unit"]] * e["cpu_time"] / e["contacts"] for n, e in effects.items()}
    bare = cost["none"]
    figure, axes = plt.subplots(figsize=(WIDTH, 1.3 + 0.29 * len(cost)), constrained_layout=True)
    bars(axes, ["bare step" if n == "none" else "+ " + n.replace("_", " ").replace("+", " + ") for n in cost],
         list(cost.values()), [GREY if n == "none" else BLUE for n in cost],
         [f"{ns:.1f}" if n == "none" else f"{ns:.1f}  (x {ns / bare:.2f})" for n, ns in cost.items()])
    axes.axvline(bare, color=INK, linewidth=1, linestyle="--")
    axes.set_xlim(0, 1.25 * max(cost.values()))
    axes.set_xlabel("cost of a contact-step, 1 thread [ns of processor time]")
    axes.set_title("Each effect by itself on the bare lattice")
    save(figure, folder, "performance-effects.png", made_with(results))
    return True


def colour_of(code):
    if not code.startswith("gneiss"):
        return GREY
    return COLOURS["mixed"] if "mixed" in code else COLOURS["double"]


def peers_panel(axes, table):
    speed, low, high = ([1e-6 * row[k] for row in table["rows"]] for k in ("median", "least", "most"))
    reference, item = table["references"][0], table["unit"].split("-")[0]
    bars(axes, [row["code"] for row in table["rows"]], speed, [colour_of(row["code"]) for row in table["rows"]],
         [f"{s:.3g}  (x {row['times'][reference]:.1f})" for s, row in zip(speed, table["rows"])],
         [[s - a for s, a in zip(speed, low)], [b - s for s, b in zip(speed, high)]])
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))  # The scalar variant would print 0 instead of 0.1.
    axes.set_xlabel(f"million {item}-steps per second (x: times {reference})")
    axes.set_title(f"{table['scene']}, {grouped(table['rows'][0]['items'])} {item}s")


def plot_peers(peers, folder):
    tables = [t for t in peers.get("tables", []) if t["references"]]
    if not tables:
        return False
    rows = [len(t["rows"]) for t in tables]
    figure, panels = plt.subplots(len(tables), 1, figsize=(WIDTH, 0.5 + 0.95 * len(tables) + 0.3 * sum(rows)),
                                  height_ratios=[r + 0.5 for r in rows], constrained_layout=True, squeeze=False)
    speeds = [1e-6 * row["median"] for t in tables for row in t["rows"]]
    lowest = 10.0 ** math.floor(math.log10(min(speeds)))
    for axes, table in zip(panels[:, 0], tables):
        peers_panel(axes, table)
        axes.set_xlim(lowest, 6 * max(speeds))  # the same range in every panel
    note = peers["conditions"].replace("**", "")
    cut = note.find(", medians")
    save(figure, folder, "performance-peers.png", note[:cut] + ",\n" + note[cut + 2:])
    return True


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, folder = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    steps, peers = read(os.path.join(source, "steps.json")), read(os.path.join(source, "peers.json"))
    drawn = {"threads": steps and plot_threads(steps, folder), "size": steps and plot_size(steps, folder),
             "effects": steps and plot_effects(steps, folder), "peers": peers and plot_peers(peers, folder)}
    for name, done in drawn.items():
        print(f"performance-{name}.png: " + ("drawn" if done else "no results for it, left as it is"))


if __name__ == "__main__":
    main()
