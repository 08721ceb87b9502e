"""The report on a packing: reads packing.h5 (docs/packing.md), draws the packing and measures of its quality."""
import io
import os

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from report_files import Unreadable, opened, write
from report_curves import BLUE, INK, RED, save, style_for
from report_page import STYLE, draw, escape, figure, table, write_page
from report_pictures import Specimen, Surface, color_bar, cut, draw_circles, scale_bar
from report_results import Column, Results, quantity, scale_of

FILE = "packing.h5"
STAGES = (("spread", "#dbe7f3"), ("compress", "#fbe3d6"), ("decompress", "#e4efdc"), ("close", "#efe3f3"),
          ("separate", "#faf0c8"))
CARDS = (("porosity", "porosity"), ("coordination_1", "contacts per particle at 1 %"),
         ("radius_mean", "mean radius"), ("radius_ratio", "largest / smallest radius"),
         ("anisotropy", "anisotropy of contacts"), ("overlap_max", "largest overlap"))
# Some texts refer to the preceding figure; the file orders figures by name.
ORDER = ("porosity", "porosity_net", "void_ratio", "coordination_01", "coordination_1", "coordination_5", "floating",
         "radius_mean", "radius_volume", "radius_min", "radius_max", "radius_ratio", "radius_ratio_98",
         "radius_variation", "radius_median", "radius_deviation", "radius_skewness", "radius_kurtosis", "fabric_max", "fabric_min", "anisotropy", "distance_mean", "overlap_median",
         "overlap_mean", "overlap_max", "overlaps", "wall_contacts", "wall_gap_rms", "wall_protrusion")
PERCENT = ("porosity", "porosity_net", "floating", "radius_variation", "anisotropy", "overlap_median", "overlap_mean",
           "overlap_max", "wall_contacts", "wall_gap_rms", "wall_protrusion")
NEEDED = {"particles": ("position", "radius"), "contacts": ("pair", "gap"), "quality": ("fabric",),
          "histogram": ("radius_edge", "radius_count", "angle_count")}
TRACE = ("iteration", "stage", "energy", "gap_rms", "overlap_max")
TOUCHING = 1e-9   # tolerance relative to r_i + r_j: less is rounding and neither gap nor overlap
CONTACT = 0.01    # tolerance of contacts in the pictures and directions
WIDE = 5000       # Number of discs above which the picture of the whole packing has no outlines.
DETAIL = 900      # discs in the picture of the contacts


class Packing(Results):
    """packing.h5, read completely and checked; data that it shares with results.h5 have the same names."""

    def __init__(self, path):
        with opened(path, "a packing file", "`gneiss pack` writes it anew") as file:
            self._read(file)
        self._check(path)

    def _read(self, file):
        super()._read(file)
        request = file.get("request")
        self.scene = request.asstr()[()] if isinstance(request, h5py.Dataset) else ""
        for name in ("contacts", "quality", "histogram", "trace"):
            items = file[name].items() if isinstance(file.get(name), h5py.Group) else ()
            setattr(self, name, {key: Column(item) for key, item in items if isinstance(item, h5py.Dataset)})

    def _check(self, path):
        kind = self.attribute("kind")
        if kind != "packing":
            found = f'"{kind}"' if kind else "none"
            raise Unreadable(f'{path}: expected the attribute kind = "packing", found {found}')
        if self.dimension not in (2, 3):
            raise Unreadable(f"{path}: expected dimension 2 or 3, found {self.dimension}")
        for group, names in NEEDED.items():
            for name in (*names, *(("polar_count",) if group == "histogram" and self.dimension == 3 else ())):
                if name not in getattr(self, group):
                    raise Unreadable(f"{path}: expected the data set /{group}/{name}, found none")
        count, pairs = len(np.atleast_1d(self.radius)), len(np.atleast_1d(self.gap))
        for name, value, shape in (
                ("particles/position", self.particles["position"].value, (count, 3)),
                ("particles/radius", self.radius, (count,)),
                ("contacts/pair", self.contacts["pair"].value, (pairs, 2)), ("contacts/gap", self.gap, (pairs,)),
                ("quality/fabric", self.quality["fabric"].value, (9,)),
                ("histogram/radius_edge", self.histogram["radius_edge"].value,
                 (np.size(self.histogram["radius_count"].value) + 1,))):
            if np.shape(value) != shape:
                raise Unreadable(f"{path}: expected the shape {list(shape)} of /{name}, found {list(np.shape(value))}")
        pair = self.contacts["pair"].value
        if pairs and not (0 <= pair.min() and pair.max() < count):
            raise Unreadable(f"{path}: /contacts/pair names particles {pair.min()} to {pair.max()}, there are {count}")
        if not count or not (np.isfinite(self.radius) & (self.radius > 0)).any():
            raise Unreadable(f"{path}: expected particles with positive radii, found none")
        lengths = {np.size(self.trace[name].value) if name in self.trace else 0 for name in TRACE}
        if len(lengths) > 1:
            raise Unreadable(f"{path}: expected columns of one length in /trace, found {sorted(lengths)}")

    @property
    def radius(self):
        return self.particles["radius"].value

    @property
    def gap(self):
        return self.contacts["gap"].value

    @property
    def iterations(self):
        return np.size(self.trace["iteration"].value) if self.trace else 0

    def figure(self, name):
        return self.scalar(self.quality, name)

    def contact_pairs(self):
        return self.contacts["pair"].value.reshape(-1, 2)[self.gap <= CONTACT]

    def test_axis(self):
        return self.dimension - 1  # without a test z is upward, in 2D y


def figure_text(name, column):
    value = float(np.asarray(column.value, float).reshape(-1)[0])
    if name in PERCENT and np.isfinite(value):
        return f"{100 * value:.3g} %" if abs(value) >= 1e-8 or value == 0 else f"{100 * value:.1e} %"
    return quantity(value, column.unit)


def length_unit(radius):
    """(factor, unit) for radii: millimetres down to a tenth of one."""
    return scale_of([10 * np.nanmedian(radius)], "m")


# --- pictures of the packing ---------------------------------------------------------------------------

class View:
    """The packing prepared once, drawn on the page and in the overview."""

    def __init__(self, packing):
        self.specimen = Specimen(packing)
        self.flat = self.specimen.flat
        self.radius_unit = length_unit(self.specimen.radius)
        radius = self.specimen.radius / self.radius_unit[0]
        low, high = np.percentile(radius, (1, 99))
        self.norm = Normalize(low, high) if high > low * (1 + 1e-9) else Normalize(0, high)
        self.extend = "both" if radius.min() < self.norm.vmin and radius.max() > self.norm.vmax else "neither"
        self.colors = plt.cm.viridis(self.norm(radius))
        self.surface = None if self.flat else Surface(self.specimen)
        self.contacts = packing.contact_pairs()

    def radius_bar(self, figure_, axes):
        color_bar(figure_, axes, self.norm, plt.cm.viridis, f"radius [{self.radius_unit[1]}]", self.extend)

    def first(self, axes):
        return self.discs(axes) if self.flat else self.whole(axes)

    def second(self, axes):
        return self.network(axes) if self.flat else self.slice(axes)

    def whole(self, axes):
        low, high = self.surface.low, self.surface.high
        axes.imshow(self.surface.colored(self.colors), origin="lower", interpolation="antialiased",
                    extent=(low[0], high[0], low[1], high[1]))
        axes.set_title("Packing")
        axes.axis("off")
        scale_bar(axes, low, high)

    def plane(self, axes, window):
        """Sets axes in mm (or another suitable unit) around left, right, bottom, top [m]; returns the factor."""
        factor, unit = scale_of([max(window[1] - window[0], window[3] - window[2])], "m")
        axes.set_aspect("equal")
        axes.grid(False)
        axes.set_xlim(window[0] / factor, window[1] / factor)
        axes.set_ylim(window[2] / factor, window[3] / factor)
        axes.set_xlabel(f"{self.specimen.names[0]} [{unit}]")
        axes.set_ylabel(f"{self.specimen.names[1]} [{unit}]")
        return factor

    def circles(self, axes, window, edge, pale=0.0):
        """The discs, or the cut spheres, that reach into the window."""
        index, centres, radii = cut(self.specimen)
        factor = self.plane(axes, window)
        seen = ((centres + radii[:, None] > (window[0], window[2])) &
                (centres - radii[:, None] < (window[1], window[3]))).all(axis=1)
        draw_circles(axes, centres[seen] / factor, radii[seen] / factor,
                     pale + (1 - pale) * self.colors[index[seen]], edge)
        return factor

    def discs(self, axes):
        self.circles(axes, self.specimen.window(), "#00000055" if self.specimen.count < WIDE else "none")
        axes.set_title("Packing")

    def slice(self, axes):
        self.circles(axes, self.specimen.window(), "#00000055")
        axes.set_title(f"Slice through the middle, {self.specimen.names[0]}–{self.specimen.names[1]}")

    def detail(self):
        """left, right, bottom, top of a square with some hundred discs near the middle."""
        s = self.specimen
        if s.count <= DETAIL:
            return s.window()
        middle = 0.5 * (s.lower + s.upper)[:2]
        half = 0.5 * np.sqrt(DETAIL * np.pi * np.mean(s.radius ** 2))
        centre = s.position[np.argmin(np.linalg.norm(s.position[:, :2] - middle, axis=1)), :2]
        half = min(half, 0.5 * (s.upper - s.lower)[:2].max())
        return centre[0] - half, centre[0] + half, centre[1] - half, centre[1] + half

    def network(self, axes):
        window = self.detail()
        factor = self.circles(axes, window, "#00000033", pale=0.5)
        ends = self.specimen.all_position[self.contacts][:, :, :2]
        seen = ((ends.max(axis=1) > (window[0], window[2])) & (ends.min(axis=1) < (window[1], window[3]))).all(axis=1)
        axes.add_collection(LineCollection(ends[seen] / factor, colors=INK, linewidths=0.7))
        axes.set_title("Contacts" + (", a part of it" if self.specimen.count > DETAIL else ""))

    def caption(self):
        if self.flat:
            return ("The discs to scale, coloured by radius (the ends of the scale are the 1 % and 99 % quantiles), and "
                    "the contacts at 1 % as lines from centre to centre.")
        return (f"The particles at the surface, {self.specimen.names[1]} upward, and a slice: its circles are the cut "
                "spheres, coloured by the radius of the sphere (the ends of the scale are the 1 % and 99 % quantiles).")


def plot_view(view, path):
    size = (view.surface.high - view.surface.low) if view.surface else np.ptp(
        np.reshape(view.specimen.window(), (2, 2)), axis=1)
    width = 2 * np.clip(5.6 * size[0] / size[1], 2.4, 6.0) + 1.9
    figure_, axes = plt.subplots(1, 2, figsize=(width, 5.8 if size[1] > 0.8 * size[0] else 4.2),
                                 constrained_layout=True)
    view.first(axes[0])
    view.second(axes[1])
    view.radius_bar(figure_, axes[0 if view.flat else 1])
    save(figure_, path)
    return view.caption()


# --- figures of quality --------------------------------------------------------------------------------

def draw_radii(packing, axes):
    factor, unit = length_unit(packing.radius)
    edge = packing.histogram["radius_edge"].value / factor
    count = packing.histogram["radius_count"].value
    if edge[-1] > edge[0]:
        axes.bar(edge[:-1], count, np.diff(edge), align="edge", color=BLUE, alpha=0.75, edgecolor="white", lw=0.5)
    else:
        axes.bar(edge[:1], count.sum(), 0.02 * edge[0], color=BLUE, alpha=0.75)
        axes.set_xlim(0.9 * edge[0], 1.1 * edge[0])
    radius = packing.radius[np.isfinite(packing.radius)] / factor
    top = max(1, count.max())
    axes.vlines(radius.mean(), 0, 1.08 * top, color=RED, lw=1.8, label=f"mean {radius.mean():.3g} {unit}")
    for quantile, dashes in ((1, (2, 2)), (50, (6, 2)), (99, (2, 1, 6, 1))):
        value = np.percentile(radius, quantile)
        name = "median" if quantile == 50 else f"{quantile} % quantile"
        axes.vlines(value, 0, 1.08 * top, color=INK, lw=1.2, linestyles=[(0, dashes)],
                    label=f"{name} {value:.3g} {unit}")
    axes.set_title("Radii")
    axes.set_xlabel(f"radius [{unit}]")
    axes.set_ylabel("particles")
    axes.set_ylim(0, 1.36 * top)
    axes.legend(loc="upper right", ncols=2, handlelength=1.7, columnspacing=1.2)
    return "Number of particles by radius, in equal steps from the smallest to the largest."


def scatter(count):
    """Relative counts and twice their standard deviation if directions were independent."""
    count = np.asarray(count, float).reshape(-1)
    mean = count.mean()
    return count / mean, 2 / np.sqrt(mean)


def draw_rose(packing, axes):
    count = packing.histogram["angle_count"].value
    axes.set_title("Directions of contacts, x–y" if packing.dimension == 3 else "Directions of contacts", pad=14)
    axes.set_axisbelow("line")  # The numbers are written above the bars.
    axes.set_xticks(np.radians(np.arange(0, 360, 45)))
    if not count.sum():
        axes.text(0.5, 0.5, "no contacts", transform=axes.transAxes, ha="center", va="center")
        axes.set_yticks([])
        return "There are no contacts at 1 %."
    density, band = scatter(count)
    step = 2 * np.pi / len(density)
    around = np.linspace(0, 2 * np.pi, 361)
    axes.bar((np.arange(len(density)) + 0.5) * step, density, step, color=BLUE, alpha=0.75, edgecolor="white", lw=0.5)
    axes.fill_between(around, max(0, 1 - band), 1 + band, color=RED, alpha=0.18, lw=0)
    axes.plot(around, np.ones_like(around), color=RED, lw=1.5)
    top = 1.25 * max(1, density.max())
    axes.set_ylim(0, top)
    ticks = [0.5, 1.0] if top < 2 else [1.0, np.floor(top)]
    axes.set_yticks(ticks, [f"{t:g}" for t in ticks])
    axes.set_rlabel_position(67.5)
    for label in axes.get_yticklabels():
        label.set_bbox({"facecolor": "white", "alpha": 0.75, "lw": 0, "pad": 0.8})
    axes.text(1.0, -0.02, f"fabric, times {packing.dimension}:\n{fabric_range(packing)}\n(isotropic: 1)",
              transform=axes.transAxes, fontsize=9, ha="left", va="bottom")
    return ("Contacts at 1 % by the direction of the line between the centres"
            + (" in the x–y plane" if packing.dimension == 3 else "") + ", both ways, over the mean. The red circle is "
            "an isotropic packing, with the scatter (two standard deviations) that so many independent directions have.")


def fabric_range(packing):
    low, high = (packing.dimension * packing.figure("fabric_" + end) for end in ("min", "max"))
    return f"{low:.3f} … {high:.3f}"


def draw_polar(packing, axes):
    count = packing.histogram["polar_count"].value
    axes.set_title("Inclination of contacts")
    axes.set_xlabel("|cos θ|, θ between contact and z [1]")
    axes.set_ylabel("contacts over the mean [1]")
    axes.set_xlim(0, 1)
    if not count.sum():
        axes.text(0.5, 0.5, "no contacts", transform=axes.transAxes, ha="center", va="center")
        return "There are no contacts at 1 %."
    # Each contact is counted in both directions but is one axis here.
    density, band = scatter(np.asarray(count) / 2)
    step = 1 / len(density)
    axes.bar((np.arange(len(density)) + 0.5) * step, density, step, color=BLUE, alpha=0.75, edgecolor="white", lw=0.5)
    axes.axhspan(max(0, 1 - band), 1 + band, color=RED, alpha=0.18, lw=0)
    axes.axhline(1, color=RED, lw=1.5, label="isotropic")
    axes.set_ylim(0, 1.3 * max(1 + band, density.max()))
    axes.legend(loc="upper right")
    return ("Contacts at 1 % in equal steps of the cosine: 0 is across z, 1 along z. Equal numbers (red, with the "
            "scatter of two standard deviations) are an isotropic packing.")


def draw_gaps(packing, axes):
    gap = 100 * np.where(np.abs(packing.gap) <= TOUCHING, 0.0, packing.gap)
    axes.set_title("Gaps and overlaps")
    axes.set_xlabel("gap over rᵢ + rⱼ, negative: overlap [%]")
    axes.set_ylabel("pairs")
    if not len(gap):
        axes.text(0.5, 0.5, "no pairs within 5 %", transform=axes.transAxes, ha="center", va="center")
        return "No two particles are within 5 % of the sum of their radii."
    high = max(5.0, gap.max())
    step = next(s for s in (0.1, 0.2, 0.25, 0.5, 1, 2, 5, 10, 25, 100) if (high - gap.min()) / s <= 80)
    below = max(0, int(np.ceil(-gap.min() / step - 1e-9)))
    edge = step * np.arange(-below, int(np.ceil(high / step - 1e-9)) + 1)
    for part, color, label in ((gap < 0, RED, "overlap"), (gap >= 0, BLUE, "gap")):
        if part.any():
            axes.hist(gap[part], edge, color=color, alpha=0.75, edgecolor="white", lw=0.5, log=True, label=label)
    axes.set_ylim(0.7, 8 * axes.get_ylim()[1])
    axes.set_xlim(edge[0] - 0.5 * step, edge[-1])
    axes.set_ylabel(f"pairs in steps of {step:g} %")
    other = axes.twinx()
    other.grid(False)
    other.spines["right"].set_visible(True)
    order = np.sort(gap)
    contacts = 2 * np.arange(1, len(order) + 1) / packing.particle_count
    thin = np.unique(np.linspace(0, len(order) - 1, 2000).astype(int))
    other.plot(np.append(order[thin], high), np.append(contacts[thin], contacts[-1]), color=INK, lw=1.1,
               drawstyle="steps-post")
    other.set_ylim(0, 1.45 * contacts[-1])
    other.set_ylabel("contacts per particle up to this gap (line)")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    figures = [f"{packing.figure('coordination_' + n):.3g} at {t} %" for n, t in (("01", 0.1), ("1", 1), ("5", 5))]
    axes.text(0.985, 0.975, "contacts per particle: " + ", ".join(figures), transform=axes.transAxes, fontsize=9,
              ha="right", va="top")
    return ("Pairs of particles by the gap between them, up to 5 %; the line is the number of contacts per particle when "
            "a gap up to this value counts as contact.")


def draw_trace(packing, axes):
    axes.set_title("Fit")
    axes.set_xlabel("iteration")
    axes.set_ylabel("residuals [1]")
    iteration, stage = (packing.trace[n].value.reshape(-1) for n in ("iteration", "stage"))
    starts = np.flatnonzero(np.diff(stage.astype(int), prepend=-1))
    ends = np.append(starts[1:], len(stage))
    named = {}
    for a, b in zip(starts, ends):
        name, color = STAGES[stage[a]] if stage[a] < len(STAGES) else (f"stage {stage[a]}", "#eeeeee")
        axes.axvspan(iteration[a] - 0.5, iteration[b - 1] + 0.5, color=color, lw=0, zorder=0)
        named[name] = (color, named.get(name, (color, 0))[1] + int(b - a))
    shown = (("overlap_max", "largest overlap, of rᵢ + rⱼ", RED), ("gap_rms", "gap, r.m.s., of rᵢ + rⱼ", BLUE),
             ("energy", "energy, relative", INK))
    for name, label, color in shown:
        value = np.asarray(packing.trace[name].value, float).reshape(-1)
        value = np.where(value > 0, value, np.nan)  # a logarithmic axis follows
        axes.plot(iteration, value, color=color, lw=1.3, label=label, **style_for(value))
    axes.set_yscale("log")
    axes.set_xlim(iteration[0] - 0.5, iteration[-1] + 0.5)
    patches = [plt.Rectangle((0, 0), 1, 1, facecolor=c) for c, _ in named.values()]
    curves = axes.legend(loc="lower left", framealpha=0.75, frameon=True, edgecolor="none")
    axes.add_artist(curves)
    axes.legend(patches, [f"{name} ({count})" for name, (_, count) in named.items()], loc="lower center",
                bbox_to_anchor=(0.5, 1.0), ncols=5, handlelength=1.0, handletextpad=0.4, columnspacing=1.0)
    axes.set_title("Fit", pad=24)
    return ("Residuals over the iterations of the fit; the background shows the stages, with the number of iterations "
            "of each. The energy is the sum of squares over that of a packing with every sphere overlapping by its size.")


def figures_of(packing):
    """Returns {name: (function, projection)} of the pictures that this packing allows."""
    plots = {"radii": (draw_radii, None), "gaps": (draw_gaps, None), "directions": (draw_rose, "polar")}
    if packing.dimension == 3:
        plots["polar"] = (draw_polar, None)
    if packing.iterations:
        plots["trace"] = (draw_trace, None)
    return plots


def plot_one(packing, plot, projection, path):
    figure_, axes = plt.subplots(figsize=(6.4, 4.2), constrained_layout=True, subplot_kw={"projection": projection})
    caption = plot(packing, axes)
    save(figure_, path)
    return caption


def plot_overview(packing, view, path):
    """Draws the overview: two rows of pictures with 3 columns, or 4 if there are enough pictures."""
    plots = figures_of(packing)
    columns = 4 if len(plots) > 4 else 3
    figure_ = plt.figure(figsize=(5.4 * columns, 9.8), constrained_layout=True)
    grid = figure_.add_gridspec(2, columns)
    places = {"radii": grid[0, 2], "directions": grid[1, 0], "polar": grid[1, 1], "trace": grid[1, 2:]}
    if columns == 4:
        places["gaps"] = grid[0, 3]
    elif "polar" in plots:
        places["gaps"] = grid[1, 2]
    else:
        places["gaps"] = grid[1, 1] if "trace" in plots else grid[1, 1:]
    axes = [figure_.add_subplot(grid[0, k]) for k in (0, 1)]
    view.first(axes[0])
    view.second(axes[1])
    view.radius_bar(figure_, axes[0 if view.flat else 1])
    for name, (plot, projection) in plots.items():
        plot(packing, figure_.add_subplot(places[name], projection=projection))
    figure_.suptitle(headline(packing), fontsize=15, fontweight="bold", x=0.01, ha="left")
    drawn = io.BytesIO()
    figure_.savefig(drawn, format="png", dpi=100)
    plt.close(figure_)
    write(path, drawn.getvalue())


def headline(packing):
    title = packing.attribute("title") or "Packing"
    kind = "disc" if packing.dimension == 2 else "sphere"
    parts = [title.replace("$", r"\$"),
             f"{spaced(packing.particle_count)} {kind}{'' if packing.particle_count == 1 else 's'}"]
    if np.isfinite(packing.figure("porosity")):
        parts.append(f"porosity {100 * packing.figure('porosity'):.3g} %")
    if np.isfinite(packing.figure("coordination_1")):
        parts.append(f"{packing.figure('coordination_1'):.3g} contacts per particle at 1 %")
    return " · ".join(parts)


# --- the page ------------------------------------------------------------------------------------------

def spaced(count):
    return f"{int(count):,}".replace(",", " ")


def volume_text(packing):
    """The volume of the body in m, cm or mm to the power of the dimension."""
    d = packing.dimension
    try:
        value = float(packing.attribute("volume", "nan"))
    except ValueError:
        return ""
    if not np.isfinite(value):
        return ""
    factor, unit = next(((f, u) for f, u in ((1.0, "m"), (1e-2, "cm")) if value >= f ** d), (1e-3, "mm"))
    return f"{value / factor ** d:.6g} {unit}{'²' if d == 2 else '³'}"


def fact_rows(packing):
    seconds = packing.attribute("seconds")
    cached = packing.attribute("from_cache", "0") == "1"
    rows = [("version", packing.attribute("version")), ("build", packing.attribute("build")),
            ("dimension", packing.dimension), ("seed", packing.attribute("seed")),
            ("particles", spaced(packing.particle_count)), ("pairs within 5 %", spaced(len(packing.gap))),
            ("area of the body" if packing.dimension == 2 else "volume of the body", volume_text(packing)),
            ("iterations", packing.iterations or ""),
            ("time, when it was made" if cached else "time", f"{float(seconds):.3g} s" if seconds else ""),
            ("from the cache", "yes" if cached else "no"),
            ("cut short by the time limit", "no" if packing.attribute("in_time", "1") == "1" else "yes")]
    return [(label, (text, "number" if label != "build" else "")) for label, text in rows if str(text)]


def figures_table(packing):
    rows = []
    for name in (*ORDER, *(n for n in packing.quality if n not in ORDER)):
        column = packing.quality.get(name)
        if column is None or np.size(column.value) != 1:
            continue
        value = float(np.asarray(column.value, float).reshape(-1)[0])
        si = f"{value:.6g} {'' if column.unit == '1' else column.unit}".strip() if np.isfinite(value) else ""
        rows.append((name.replace("_", " "), (figure_text(name, column), "number"), (si, "si"), column.text))
    return table(rows, ("figure", "value", "in SI units", "meaning"))


def fabric_table(packing):
    d = packing.dimension
    fabric = np.asarray(packing.quality["fabric"].value, float).reshape(3, 3)[:d, :d]
    rows = [[("xyz"[k], "si")] + [(f"{value:.5f}", "number") for value in row] for k, row in enumerate(fabric)]
    return table(rows, ["", *"xyz"[:d]])


def banner(packing):
    if packing.attribute("in_time", "1") == "1":
        return ""
    return ('<p class="warning"><b>Cut short.</b> The time limit ended the fit: the packing may be looser than it could '
            "be, and another machine would give another one.</p>")


def page(packing, captions):
    title = packing.attribute("title") or "gneiss packing"
    cards = "".join(
        f'<div class="card"><span>{escape(t)}</span><b>{escape(figure_text(name, packing.quality[name]))}</b></div>'
        for name, t in CARDS if name in packing.quality)
    subtitle = " · ".join(filter(None, (
        f"gneiss {packing.attribute('version')}", f"{packing.dimension}D", f"{spaced(packing.particle_count)} particles",
        "from the cache" if packing.attribute("from_cache", "0") == "1" else "")))
    request = "<p>The file holds no request.</p>"
    if packing.scene:
        request = f"<pre>{escape(packing.scene)}</pre>"
    plots = "".join(figure(name, captions) for name in ("radii", "gaps", "directions", "polar", "trace"))
    nothing = "" if packing.iterations else '<p class="soft">No iterations of the fit are recorded.</p>'
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title><style>{STYLE}</style></head><body>
<h1>{escape(title)}</h1>
<p class="soft">{escape(subtitle)}</p>
{banner(packing)}
<div class="cards">{cards}</div>
<h2>Packing</h2>
{figure("packing", captions, "wide")}
<h2>Quality</h2>
<div class="grid">{plots}</div>
{nothing}
<h2>Figures</h2>
{figures_table(packing)}
<div class="tables"><div><h2>Making</h2>{table(fact_rows(packing))}</div>
<div><h2>Fabric tensor, contacts at 1 %</h2>{fabric_table(packing)}</div></div>
<h2>Request</h2>
{request}
<p class="soft">Numbers and arrays: <code>{FILE}</code>, next to this page; all pictures in one: <code>packing.png</code>.</p>
</body></html>
"""


def write_packing_report(folder):
    packing = Packing(os.path.join(folder, FILE))
    view = View(packing)
    plots = figures_of(packing)
    jobs = {"packing": lambda path: plot_view(view, path)}
    for name in ("radii", "gaps", "directions", "polar", "trace"):
        jobs[name] = lambda path, name=name: plot_one(packing, *plots[name], path) if name in plots else None
    captions = draw(jobs, folder)
    plot_overview(packing, view, os.path.join(folder, "packing.png"))
    return write_page(folder, page(packing, captions))
