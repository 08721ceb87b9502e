"""Strength over confinement: friction angle and cohesion (Coulomb), m_i and sigma_ci (Hoek and Brown 1980), of the triaxial tests of
a sweep.

Coulomb: s1 = C + K s3 with K = (1 + sin phi)/(1 - sin phi), C = 2 c sqrt(K). Hoek-Brown of intact rock: s1 = s3 + s_ci
sqrt(m_i s3/s_ci + 1), so that (s1 - s3)^2 = m_i s_ci s3 + s_ci^2. Both are lines: least squares, over all runs.
"""
import numpy as np

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from report_curves import BLUE, INK, RED, save
from report_results import quantity, scale_of

LEAST = 3  # confinements that differ: a line through two of them has nothing to be held against


def line(x, y):
    """Slope, intercept and the root mean square of what is left."""
    slope, start = np.polyfit(x, y, 1)
    return slope, start, float(np.sqrt(np.mean((y - start - slope * x) ** 2)))


def envelope(confinement, strength):
    """{name: (value, unit) or (None, why not)} and the two curves as functions of the confinement (None: none)."""
    s3, s1 = (np.asarray(v, float).reshape(-1) for v in (confinement, strength))
    good = np.isfinite(s3) & np.isfinite(s1)
    s3, s1 = s3[good], s1[good]
    names = ("friction_angle", "cohesion", "hoek_brown_mi", "hoek_brown_strength")
    different = len(np.unique(np.round(s3 / max(s3.max(initial=0), 1e-300), 6))) if len(s3) else 0
    if different < LEAST:
        reason = f"{different} different confinements with a strength, {LEAST} are needed"
        return {name: (None, reason) for name in names}, None, None
    found, coulomb, hoek = {}, None, None
    k, c, _ = line(s3, s1)
    if k >= 1 and c >= 0:
        found["friction_angle"] = (float(np.degrees(np.arcsin((k - 1) / (k + 1)))), "degree")
        found["cohesion"] = (float(c / (2 * np.sqrt(k))), "Pa")
        coulomb = lambda p: c + k * p  # noqa: E731
    else:
        reason = f"the line has a slope of {k:.3g} (at least 1) and begins at {c:.3g} Pa (at least 0)"
        found["friction_angle"] = found["cohesion"] = (None, reason)
    slope, start, _ = line(s3, (s1 - s3) ** 2)
    if start > 0 and slope > 0:
        strength_fit = float(np.sqrt(start))
        found["hoek_brown_mi"] = (float(slope / strength_fit), "1")
        found["hoek_brown_strength"] = (strength_fit, "Pa")
        hoek = lambda p: p + np.sqrt(np.maximum(0, slope * p + start))  # noqa: E731
    else:
        reason = "the square of the deviator does not grow from above zero along a line"
        found["hoek_brown_mi"] = found["hoek_brown_strength"] = (None, reason)
    return {name: found[name] for name in names}, coulomb, hoek


TEXTS = {"friction_angle": "friction angle", "cohesion": "cohesion", "hoek_brown_mi": "Hoek-Brown m_i",
         "hoek_brown_strength": "Hoek-Brown σ_ci"}


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
