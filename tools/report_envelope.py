"""Strength over confinement: friction angle and cohesion (Coulomb), m_i and sigma_ci (Hoek and Brown 1980), of the triaxial tests of
a sweep, as sweep.h5 has them (src/sweep/envelope.h says how they are found).
"""
import numpy as np

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from report_curves import BLUE, GREY, INK, RED, save
from report_results import _text, quantity, scale_of

MOST_ENVELOPES = 7
COLOURS = (BLUE, RED, "#2f8f5b", "#8a5fb0", "#c78a1c", "#3d9fb0", "#7a5c45")
TEXTS = {"friction_angle": "friction angle", "cohesion": "cohesion", "hoek_brown_mi": "Hoek-Brown m_i",
         "hoek_brown_strength": "Hoek-Brown σ_ci"}


def read(group):
    """Returns the envelopes of the group `envelope` of sweep.h5 as a list of (label, {name: (value, unit) or (None,
    reason)})."""
    values = {name: np.asarray(group[name][()], float).reshape(-1) for name in TEXTS}
    count = max(len(column) for column in values.values())
    labels = _text(group["of"][()]).split("\n") if "of" in group else []
    found = []
    for k in range(count):
        one = {}
        for name, column in values.items():
            attributes = group[name].attrs
            reasons = _text(attributes["absent"]).split("\n") if "absent" in attributes else []
            known = bool(np.isfinite(column[k]))
            one[name] = (float(column[k]), _text(attributes["unit"])) if known else (None, reasons[k] if k < len(reasons) else "")
        found.append((labels[k] if k < len(labels) else "", one))
    return found


def curves(found):
    """Coulomb's line and Hoek and Brown's curve as functions of the confinement; None: none."""
    coulomb = hoek = None
    if found["friction_angle"][0] is not None:
        sine, cohesion = np.sin(np.radians(found["friction_angle"][0])), found["cohesion"][0]
        slope = (1 + sine) / (1 - sine)
        coulomb = lambda p: 2 * cohesion * np.sqrt(slope) + slope * p  # noqa: E731
    if found["hoek_brown_mi"][0] is not None:
        m, strength = found["hoek_brown_mi"][0], found["hoek_brown_strength"][0]
        hoek = lambda p: p + np.sqrt(np.maximum(0, m * strength * p + strength**2))  # noqa: E731
    return coulomb, hoek


def rows_of(label, found):
    """Returns rows of a table: label, quantity, value or the reason why there is no value."""
    rows = []
    for name, (value, unit) in found.items():
        if value is None:
            rows.append((label, TEXTS[name], "–", unit))
        else:
            rows.append((label, TEXTS[name], f"{value:.4g}°" if unit == "degree" else quantity(value, unit), ""))
    return rows


def plot(confinement, strength, place, envelopes, path):
    """`place`: the envelope to which each run belongs, -1: none."""
    s3, s1, place = (np.asarray(v, float).reshape(-1) for v in (confinement, strength, place))
    factor, unit = scale_of(s1, "Pa")
    figure, axes = plt.subplots(figsize=(5.6, 4.0), constrained_layout=True)
    several = len(envelopes) > 1
    at = np.linspace(0, np.nanmax(s3), 200)
    if np.any(place < 0):
        axes.plot(s3[place < 0] / factor, s1[place < 0] / factor, "o", color=GREY)
    for k, (label, found) in enumerate(envelopes[:MOST_ENVELOPES]):
        coulomb, hoek = curves(found)
        colour = COLOURS[k % len(COLOURS)]
        mine = place == k
        axes.plot(s3[mine] / factor, s1[mine] / factor, "o", color=colour if several else INK, label=label or "runs")
        if coulomb is not None:
            axes.plot(at / factor, coulomb(at) / factor, color=colour, label=None if several else "Coulomb")
        if hoek is not None:
            axes.plot(at / factor, hoek(at) / factor, "--" if several else "-", color=colour if several else RED,
                      label=None if several else "Hoek-Brown")
    axes.set_xlabel(f"confinement [{unit}]")
    axes.set_ylabel(f"axial strength [{unit}]")
    axes.legend(loc="best", fontsize=7 if several else None)
    save(figure, path)
    if not several:
        return "Axial strength over confinement, all runs, and the lines that are fitted to them."
    left = len(envelopes) - MOST_ENVELOPES
    return ("Axial strength over confinement: a colour for each combination of the other parameters, Coulomb's lines solid, Hoek and Brown's "
            "curves dashed." + (f" {left} more combinations are in the table alone." if left > 0 else ""))
