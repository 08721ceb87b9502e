"""Curves and a slice as SVG: what a report has where matplotlib is not installed. To be imported before the modules that draw with it."""
import sys
from unittest import mock

import numpy as np

from report_page import escape
from report_results import scale_of

try:
    import matplotlib  # noqa: F401
    MISSING = False
except ImportError:  # modules that draw with it can then be imported; their functions that draw are not called
    MISSING = True
    for _name in ("", ".collections", ".colors", ".pyplot", ".ticker"):
        sys.modules["matplotlib" + _name] = mock.MagicMock()

NOTE = ('<p class="soft">matplotlib is not installed, so that some curves and pictures are left out: '
        "<code>sudo apt install python3-matplotlib</code>, then <code>gneiss report</code> again.</p>")
WIDTH, HEIGHT, LEFT, TOP, RIGHT, BOTTOM = 520, 320, 64, 34, 14, 44
INK, GRID = "#22303c", "#e5e9ec"
COLOURS = "#c8402f", "#2b6cb0", "#d99a2b", "#41ab5d", "#6a51a3", "#8c510a"
DAMAGED = np.array([[216, 211, 200], [232, 192, 125], [221, 125, 60], [179, 38, 30], [74, 13, 18]])  # from 0 to 1
POINTS = 600        # of a curve
CIRCLES = 6000      # of a slice; of more only the largest are drawn
ENERGIES = 6        # largest terms of the ledger


def ticks(low, high):
    """Round numbers between two, four to nine of them."""
    step = 10 ** np.floor(np.log10((high - low) / 4))
    step *= max(m for m in (1, 2, 5) if (high - low) / (m * step) >= 3.9 or m == 1)
    return np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step + 0.0  # no -0


def chart(title, x, x_label, series, y_label):
    """One drawing of [(label, values)] over x; "" where there is nothing finite to draw."""
    drawn = [(label, np.asarray(y, float)) for label, y in series]
    finite = np.isfinite(x) & np.all([np.isfinite(y) for _, y in drawn], axis=0)
    if finite.sum() < 2:
        return ""
    chosen = np.flatnonzero(finite)[np.unique(np.linspace(0, finite.sum() - 1, POINTS).astype(int))]
    x, drawn = x[chosen], [(label, y[chosen]) for label, y in drawn]
    low, high = np.array([x.min(), min(0.0, *(y.min() for _, y in drawn))]), np.array([x.max(), max(y.max() for _, y in drawn)])
    size = np.where(high > low, high - low, 1.0)

    def place(a, b):
        return LEFT + (a - low[0]) / size[0] * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - (b - low[1]) / size[1] * (HEIGHT - TOP - BOTTOM)

    parts = [f'<text x="{LEFT}" y="18" font-weight="bold">{escape(title)}</text>']
    for tick in ticks(low[1], low[1] + size[1]):
        y = place(low[0], tick)[1]
        parts.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="{GRID}"/><text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{tick:g}</text>')
    for tick in ticks(low[0], low[0] + size[0]):
        a = place(tick, low[1])[0]
        parts.append(f'<text x="{a:.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{tick:g}</text>')
    for k, (label, y) in enumerate(drawn):
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(*place(x, y)))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[k]}" stroke-width="1.6"/>')
        if len(drawn) > 1:
            parts.append(f'<text x="{LEFT + 10}" y="{TOP + 14 + 15 * k}" fill="{COLOURS[k]}">{escape(label)}</text>')
    parts += [f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">{escape(x_label)}</text>',
              f'<text transform="translate(14 {HEIGHT / 2}) rotate(-90)" text-anchor="middle">{escape(y_label)}</text>']
    return f'<figure><svg viewBox="0 0 {WIDTH} {HEIGHT}" font-size="12" font-family="sans-serif" fill="{INK}">{"".join(parts)}</svg></figure>'


def scaled(values, unit):
    factor, text = scale_of(values, unit)
    return values / factor, text


def curves(results, x, x_label):
    """Stress, broken bonds and the largest energies over x, as HTML."""
    drawings, history = [], {name: column.value for name, column in results.history.items()}
    if x is None:
        return ""
    if "stress" in history and results.test_kind:
        stress, unit = scaled(history["stress"], "Pa")
        drawings.append(chart("Stress", x, x_label, [("stress", stress)], f"stress [{unit}]"))
    broken = [(name.replace("broken_", "in "), history[name]) for name in ("broken_tension", "broken_shear") if name in history]
    if broken and any(np.nanmax(values, initial=0) > 0 for _, values in broken):
        drawings.append(chart("Broken bonds", x, x_label, broken, "bonds"))
    terms = {name.removeprefix("energy_").replace("_", " "): values for name, values in history.items()
             if name.startswith("energy_") and name != "energy_residual" and np.isfinite(values).all() and np.any(values)}
    largest = sorted(terms, key=lambda name: -np.abs(terms[name]).max())[:ENERGIES]
    if largest:
        factor, unit = scale_of(np.concatenate([terms[name] for name in largest]), "J")
        drawings.append(chart("Energies, the largest", x, x_label, [(name, terms[name] / factor) for name in largest], f"energy [{unit}]"))
    return "".join(drawings)


def slice_of(specimen, circles):
    """The section through the middle (in 2D all discs), by damage or by the distance moved; circles: index, centres, radii."""
    index, centres, radii = circles
    if not len(radii):
        return ""
    by_damage = specimen.damage is not None and specimen.has_bonds
    value = specimen.damage if by_damage else specimen.moved / (np.percentile(specimen.moved, 98) or 1.0)
    colours = np.stack([np.interp(np.clip(value[index], 0, 1), np.linspace(0, 1, 5), DAMAGED[:, k]) for k in range(3)], axis=1).astype(int)
    left, right, bottom, top = specimen.window()
    scale = 420 / max(right - left, top - bottom)
    chosen = np.argsort(-radii)[:CIRCLES]
    parts = [f'<circle cx="{(centres[k, 0] - left) * scale:.1f}" cy="{(top - centres[k, 1]) * scale:.1f}" r="{radii[k] * scale:.1f}" '
             f'fill="#{colours[k, 0]:02x}{colours[k, 1]:02x}{colours[k, 2]:02x}"/>' for k in chosen]
    what = "damage (broken over initial bonds)" if by_damage else "the distance moved"
    where = "All discs" if specimen.flat else "Section through the middle"
    return (f'<figure><svg viewBox="0 0 {(right - left) * scale:.0f} {(top - bottom) * scale:.0f}" style="max-height: 460px">{"".join(parts)}</svg>'
            f"<figcaption>{where} at the end of the run; darker: more of {what}.</figcaption></figure>")
