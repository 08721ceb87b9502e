"""Page of a calibration: targets and found values, path, pairs of parameters, curves."""
import base64
import io
import math
import os

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402 (after the choice of its backend)

from calibrate import uncertainty  # noqa: E402
from calibrate.material import is_linear  # noqa: E402
from report_page import STYLE, escape, table  # noqa: E402 (of the pages of runs)

WIDE = 20.0  # largest over smallest value of a region from which its axis is logarithmic
ACCENT, INK, SOFT = "#c8402f", "#22303c", "#9aa7b0"


def embedded(figure, caption):
    """HTML of a figure, with the picture inside."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)
    coded = base64.b64encode(data.getvalue()).decode("ascii")
    return f'<figure><img src="data:image/png;base64,{coded}" alt="{escape(caption)}"><figcaption>{escape(caption)}</figcaption></figure>'


def targets_picture(whole):
    """Found over wanted values, with intervals of the mean and of a new packing."""
    names = list(whole["found"])
    figure, axes = plt.subplots(figsize=(6.5, 0.6 + 0.5 * len(names)))
    for row, name in enumerate(names):
        entry = whole["found"][name]
        wanted = entry["target"]
        half = entry["tolerance"] / wanted
        axes.fill_betweenx([row - 0.35, row + 0.35], 1.0 - half, 1.0 + half, color="#e6ecef", lw=0)
        for key, width, colour in (("prediction", 1.2, SOFT), ("interval", 3.0, INK)):
            if entry[key]:
                axes.plot(np.array(entry[key]) / wanted, [row, row], lw=width, color=colour, solid_capstyle="butt")
        if entry["value"] is not None:
            axes.plot(entry["value"] / wanted, row, "o", color=INK if entry["reached"] else ACCENT, ms=6)
        axes.plot(np.array(entry.get("fresh", {}).get("values", [])) / wanted, [row] * len(entry.get("fresh", {}).get("values", [])), "x", color=ACCENT, ms=5)
    axes.axvline(1.0, color=SOFT, lw=0.8)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel("found over wanted")
    return embedded(figure, "Found over wanted values. Grey area: tolerance; thick line: 95 % interval of the mean; thin line: of a new packing; "
                            "crosses: fresh packings.")


def path_picture(whole):
    """Found over wanted values at every evaluation."""
    figure, axes = plt.subplots(figsize=(5.5, 3.4))
    for name, entry in whole["found"].items():
        values = [step["found"][name] for step in whole["path"]]
        axes.plot(range(1, len(values) + 1), [math.nan if value is None else value / entry["target"] for value in values], "o-", ms=4, label=name)
    axes.axhline(1.0, color=SOFT, lw=0.8)
    axes.set_xlabel("evaluation")
    axes.set_ylabel("mean over wanted")
    axes.legend(fontsize=8, frameon=False)
    return embedded(figure, "Readings at every evaluation: " + ", ".join(f"{step['packings']} packings" for step in whole["path"]) + ".")


def ellipse(covariance, pair, quantile):
    """Points of the ellipse of two parameters where d' Cov^-1 d is the quantile, in the coordinates of the covariance."""
    part = np.array(covariance)[np.ix_(pair, pair)]
    values, vectors = np.linalg.eigh(part)
    angle = np.linspace(0.0, 2.0 * math.pi, 100)
    return vectors @ (np.sqrt(np.maximum(values, 0.0))[:, None] * math.sqrt(quantile) * np.array([np.cos(angle), np.sin(angle)]))


def region_values(covariance, index, differences):
    """Values of a parameter within its limits, from differences of its coordinate: over the found value, and so above 0 as the parameter is, where the
    coordinate is a logarithm."""
    name, value, limits = (covariance[key][index] for key in ("of", "values", "limits"))
    if is_linear(name):
        return np.clip(value + differences, *limits)
    return np.exp(np.clip(differences, *np.log(np.array(limits) / value)))


def pairs_picture(whole):
    """Regions of all pairs of parameters; None with fewer than two, or without a covariance."""
    covariance = whole["covariance"]
    names, matrix = covariance["of"], covariance["matrix"]
    if matrix is None or len(names) < 2 or any(None in row for row in matrix):
        return ""
    size, quantile = len(names) - 1, uncertainty.region(2, covariance["packings"])
    if math.isinf(quantile):
        return ""
    figure, axes = plt.subplots(size, size, figsize=(2.0 * size + 1.0, 2.0 * size + 0.6), squeeze=False)
    for row in range(size):
        for column in range(size):
            ax, pair = axes[row, column], (column, row + 1)
            if column > row:
                ax.axis("off")
                continue
            points = [region_values(covariance, k, one) for k, one in zip(pair, ellipse(matrix, pair, quantile))]
            ax.plot(*points, color=INK)
            ax.plot(*(region_values(covariance, k, 0.0) for k in pair), "+", color=ACCENT)
            for k, one, side, shown in zip(pair, points, "xy", (row == size - 1, column == 0)):
                if not is_linear(names[k]) and max(one) > WIDE * min(one):
                    ax.set(**{side + "scale": "log"})
                    getattr(ax, side + "axis").set_major_formatter("{x:g}")
                if shown:
                    ax.set(**{side + "label": names[k] + ("" if is_linear(names[k]) else " over found")})
            ax.tick_params(labelsize=7)
    return embedded(figure, "95 % regions of pairs of parameters, within their limits: ellipses of logarithms (of bond_friction, of its values).")


def curves_picture(curves):
    """Stress over strain of the first packing in every test."""
    figure, axes = plt.subplots(figsize=(5.5, 3.4))
    for name, folder in curves:
        with h5py.File(os.path.join(folder, "results.h5"), "r") as file:
            strain, stress = file["history/strain"][:], file["history/stress"][:]
        axes.plot(100.0 * np.abs(strain), stress / 1e6, lw=1.2, label=name)
    axes.set_xlabel("strain, %")
    axes.set_ylabel("stress, MPa")
    axes.legend(fontsize=8, frameon=False)
    return embedded(figure, "Tests of the first packing with the found parameters.")


def _shown(value, entry):
    if value is None:
        return "absent"
    return f"{value / 1e6:.5g} MPa" if entry["unit"] == "Pa" else f"{value:.4g} {entry['unit']}".rstrip()


def _interval(entry, key):
    return "–".join(_shown(one, entry) for one in entry[key]) if entry[key] else "-"


def page(whole, curves):
    """HTML of the page."""
    found = table([[name, _shown(one["target"], one), _shown(one["value"], one), _interval(one, "interval"), _interval(one, "prediction"),
                    "" if "fresh" not in one else ", ".join(_shown(value, one) for value in one["fresh"]["values"]), "yes" if one["reached"] else "no"]
                   for name, one in whole["found"].items()],
                  ["reading", "wanted", "found", "95 % of the mean", "95 % of a new packing", "fresh packings", "reached"])
    values = table([[name, _shown(one["value"], one), _interval(one, "interval") if one["free"] else "given"] for name, one in whole["parameters"].items()],
                   ["key of the material", "value", "95 % interval"])
    notes = "".join(f'<div class="warning">{escape(text)}</div>' for text in whole["tried"] + whole["notes"])
    other = whole["other_test"]
    beside = "" if not other else f"<p>Not fitted: strength in {escape(other['test'])} {', '.join(_shown(one, other) for one in other['strengths'])}.</p>"
    pictures = [targets_picture(whole), path_picture(whole), curves_picture(curves) if curves else "", pairs_picture(whole)]
    title = escape(whole["title"] or "Calibration")
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>{STYLE}</style></head><body><h1>{title}</h1>'
            f'<p class="soft">law {escape(whole["law"])}{": " if whole["law_text"] else ""}{escape(whole["law_text"])}; {whole["runs"]} runs, '
            f'{whole["cpu_seconds"]:.0f} CPU seconds; {escape(whole["version"])}</p>{notes}<h2>Readings</h2>{found}{beside}<h2>Parameters</h2>{values}'
            f'<h2>Pictures</h2><div class="grid">{"".join(pictures)}</div></body></html>\n')
