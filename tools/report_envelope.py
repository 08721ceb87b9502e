"""Strength over confinement: friction angle and cohesion (Coulomb), m_i and sigma_ci (Hoek and Brown 1980), of the triaxial tests of
a sweep, as sweep.h5 has them (src/sweep/envelope.h says how they are found).
"""
import numpy as np

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from report_curves import BLUE, INK, RED, save
from report_results import _text, quantity, scale_of

TEXTS = {"friction_angle": "friction angle", "cohesion": "cohesion", "hoek_brown_mi": "Hoek-Brown m_i",
         "hoek_brown_strength": "Hoek-Brown σ_ci"}


def read(group):
    """Of the group `envelope` of sweep.h5: {name: (value, unit) or (None, why not)}."""
    found = {}
    for name in TEXTS:
        data = group[name]
        value = float(np.asarray(data[()]).reshape(-1)[0])
        known = np.isfinite(value)
        found[name] = (value if known else None, _text(data.attrs["unit" if known else "absent"]))
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


def rows_of(found):
    """Rows of a table: what, value or why there is none."""
    rows = []
    for name, (value, unit) in found.items():
        if value is None:
            rows.append((TEXTS[name], "–", unit))
        else:
            rows.append((TEXTS[name], f"{value:.4g}°" if unit == "degree" else quantity(value, unit), ""))
    return rows


def plot(confinement, strength, coulomb, hoek, path):
    s3, s1 = (np.asarray(v, float).reshape(-1) for v in (confinement, strength))
    factor, unit = scale_of(s1, "Pa")
    figure, axes = plt.subplots(figsize=(5.6, 4.0), constrained_layout=True)
    axes.plot(s3 / factor, s1 / factor, "o", color=INK, label="runs")
    at = np.linspace(0, np.nanmax(s3), 200)
    for curve, colour, label in ((coulomb, BLUE, "Coulomb"), (hoek, RED, "Hoek-Brown")):
        if curve is not None:
            axes.plot(at / factor, curve(at) / factor, color=colour, label=label)
    axes.set_xlabel(f"confinement [{unit}]")
    axes.set_ylabel(f"axial strength [{unit}]")
    axes.legend(loc="best")
    save(figure, path)
    return "Axial strength over confinement, all runs, and the lines that are fitted to them."
