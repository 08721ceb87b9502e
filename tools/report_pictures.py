"""Pictures of the specimen: its surface (spheres cast into a depth buffer), a slice, its cracks."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize

from report_beside import Beside
from report_curves import BLUE, INK, RED, save
from report_results import scale_of
from report_shapes import panes

DAMAGE = LinearSegmentedColormap.from_list(
    "damage", ["#d8d3c8", "#e8c07d", "#dd7d3c", "#b3261e", "#4a0d12"])
PICTURE_HEIGHT = 900  # pixels of the cast picture
MARGIN = 0.05         # margin around the specimen relative to its size; fragments farther out are cut off


def quantiles(values, unit):
    """Returns (factor, unit, norm). Colours span the 2nd to the 98th percentile, so that a few fragments do not hide
    differences among the rest; the span starts from zero if zero is near."""
    low, high = np.percentile(values, (2, 98))
    high = float(high) or float(np.max(values))
    low = float(low) if low > 0.5 * high else 0.0
    factor, unit = scale_of([high], unit)
    low, high = low / factor, (high / factor) or 1.0
    return factor, unit, Normalize(low, high if high > low else low + 1.0)


def extend_of(values, norm):
    """Returns at which ends of the colour bar there are values beyond its range."""
    beyond = values.min() < norm.vmin - 1e-9 * abs(norm.vmin), values.max() > norm.vmax * (1 + 1e-9)
    return {(True, True): "both", (True, False): "min", (False, True): "max"}.get(beyond, "neither")


# A body beside a bonded specimen, such as a disc cutter, is shown up to this share of the size of the specimen away from it.
SHARE_OF_TOOL = 0.5


class Specimen:
    """Final state without removed particles, with the axis of the test upward: right, up, toward the viewer."""

    def __init__(self, results, snapshot=None, time=None):
        position = np.asarray(results.particle("position"), float)
        radius = np.asarray(results.particle("radius"), float).reshape(-1)
        position = np.pad(position.reshape(len(radius), -1), ((0, 0), (0, 2)))[:, :3]
        displacement = results.particle("displacement")
        displacement = np.zeros_like(position) if displacement is None else np.asarray(displacement, float)
        displacement = np.pad(displacement.reshape(len(radius), -1), ((0, 0), (0, 2)))[:, :3]
        damage = results.particle("damage")
        removed = results.particle("removed")
        keep = np.isfinite(position).all(axis=1) & np.isfinite(radius) & (radius > 0)
        if removed is not None:
            keep &= np.asarray(removed).reshape(-1) == 0
        self.flat = results.dimension == 2
        up = 1 if self.flat else results.up_axis()
        right = 0 if self.flat else (up + 1) % 3
        if not self.flat and "indirect_tensile_strength" in results.readings and up < 2:
            right = 1 - up  # a disc is viewed from its face
        toward = 3 - up - right
        self.names = "xyz"[right], "xyz"[up], "xyz"[toward]
        order = [right, up, toward]
        # The viewer looks along `toward` from its negative side if this makes a right-handed picture.
        self.sign = 1.0 if (right, up, toward) in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1.0
        self.keep = keep
        self.all_position = position[:, order] * [1, 1, self.sign]
        self.all_radius = radius
        self.position = self.all_position[keep]
        self.start = self.position - displacement[keep][:, order] * [1, 1, self.sign]
        self.radius = radius[keep]
        self.moved = np.linalg.norm(np.nan_to_num(displacement[keep]), axis=1)
        self.damage = None if damage is None else np.nan_to_num(np.asarray(damage, float).reshape(-1)[keep])
        self.has_bonds = len(results.bond_state) > 0
        self.count = len(self.radius)
        # A broken specimen is shown at its original place without the fragments that flew away; loose particles are
        # shown where they are.
        self.framed = self.start if self.has_bonds else self.position
        self.beside = Beside(results, order, self.sign, snapshot, time)
        velocity = results.particle("velocity")
        speed = np.zeros(len(radius)) if velocity is None else np.linalg.norm(np.asarray(velocity, float).reshape(len(radius), -1), axis=1)
        self.speed = np.nan_to_num(speed[keep])
        if self.count:
            self.lower = (self.framed - self.radius[:, None]).min(axis=0)
            self.upper = (self.framed + self.radius[:, None]).max(axis=0)
            self.middle = 0.5 * (self.lower + self.upper) if self.has_bonds else 0.5 * sum(self.beside.bounds(self.lower, self.upper))
            self.plane = self.plane_of_slice()

    def is_bed(self):
        """A specimen that is lower than wide: its upper side is shown."""
        size = self.upper - self.lower
        return bool(not self.flat and size[1] < 0.7 * max(size[0], size[2]))

    def plane_of_slice(self):
        """The slice is through the middle; if a tool is smaller than the specimen it is through the tool, along its groove."""
        owner = self.beside.owner
        depths = [self.beside.vertex[np.unique(self.beside.facet[owner == body])][:, 2] for body in np.unique(owner)]
        small = [z for z in depths if np.ptp(z) < 0.6 * (self.upper[2] - self.lower[2])]
        middles = [0.5 * (z.min() + z.max()) for z in small]
        within = [m for m in middles if self.lower[2] < m < self.upper[2]]
        return float(within[0]) if within else self.middle[2]

    def held(self):
        """True for the particles that a bond still holds, if there are any, as chips fly far; else for all."""
        held = self.damage < 1 if self.damage is not None and self.has_bonds else np.ones(len(self.moved), bool)
        return held if held.any() else ~held

    def displacement_quantiles(self):
        return quantiles(self.moved[self.held()], "m")

    def displacement_scale(self):
        """(factor, unit, top of the colours)."""
        factor, unit, norm = self.displacement_quantiles()
        return factor, unit, norm.vmax

    def colorings(self):
        """Returns (title, values, colour map, norm, label of the colour bar): damage of bonded particles, heights of
        a bed under a body, speeds of freely moving particles, and displacements."""
        factor, unit, norm = self.displacement_quantiles()
        result = [("Displacement", self.moved / factor, plt.cm.viridis, norm, f"displacement [{unit}]")]
        if self.damage is not None and self.has_bonds:
            result.insert(0, ("Damage", self.damage, DAMAGE, Normalize(0, 1), "damage, broken / initial bonds [1]"))
        elif np.percentile(self.speed, 90) > 1e-3:
            factor, unit, norm = quantiles(self.speed, "m/s")
            result.insert(0, ("Speed", self.speed / factor, plt.cm.magma, norm, f"speed [{unit}]"))
        if self.is_bed() and len(self.beside.facet):
            height = self.position[:, 1] - self.lower[1]
            factor, unit, _ = quantiles(height[self.held()], "m")
            low, high = np.percentile(height[self.held()] / factor, (50, 99.5))
            result.insert(0, ("Height", height / factor, plt.cm.cividis, Normalize(low, max(high, low + 1e-12)), f"height [{unit}]"))
        return result

    def window(self):
        """Left, right, bottom and top of the slice and of 2D pictures, m."""
        most = SHARE_OF_TOOL * (self.upper - self.lower).max() if self.has_bonds else np.inf
        lower, upper = self.beside.bounds(self.lower, self.upper, most)
        margin = MARGIN * (upper - lower)[:2].max()
        low, high = lower[:2] - margin, upper[:2] + margin
        return low[0], high[0], low[1], high[1]


# --- the surface ---------------------------------------------------------------------------------------

def oblique(specimen, azimuth=25.0, elevation=14.0, above=48.0):
    """Coordinates seen by a viewer turned about the axis and raised a little, over a bed more: right, up, toward."""
    a, e = np.radians(azimuth), np.radians(above if specimen and specimen.is_bed() else elevation)
    turn = np.array([[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]])
    raise_ = np.array([[1, 0, 0], [0, np.cos(e), -np.sin(e)], [0, np.sin(e), np.cos(e)]])
    return raise_ @ turn


def cast(centre, radius, low, pixel, shape):
    """Depth buffer of spheres seen along -z: (depth, nearest sphere or -1, normals) per pixel."""
    rows, columns = shape
    depth = np.full(shape, -np.inf)
    nearest = np.full(shape, -1)
    xs = low[0] + (np.arange(columns) + 0.5) * pixel
    ys = low[1] + (np.arange(rows) + 0.5) * pixel
    first = np.floor((centre[:, :2] - radius[:, None] - low) / pixel).astype(int)
    last = np.ceil((centre[:, :2] + radius[:, None] - low) / pixel).astype(int) + 1
    first = np.clip(first, 0, [columns, rows])
    last = np.clip(last, 0, [columns, rows])
    seen = np.flatnonzero((last > first).all(axis=1))
    for p in seen[np.argsort(-(centre[seen, 2] + radius[seen]))]:
        (x0, y0), (x1, y1) = first[p], last[p]
        view = depth[y0:y1, x0:x1]
        top = centre[p, 2] + radius[p]
        if view.min() >= top:
            continue
        height = radius[p] ** 2 - (xs[x0:x1] - centre[p, 0]) ** 2 - (ys[y0:y1, None] - centre[p, 1]) ** 2
        z = np.where(height > 0, centre[p, 2] + np.sqrt(np.maximum(height, 0)), -np.inf)
        front = z > view
        view[front] = z[front]
        nearest[y0:y1, x0:x1][front] = p
    hit = nearest >= 0
    normal = np.zeros(shape + (3,))
    y, x = np.nonzero(hit)
    p = nearest[hit]
    point = np.stack([xs[x], ys[y], depth[hit]], axis=1)
    normal[hit] = (point - centre[p]) / radius[p, None]
    return depth, nearest, normal


def occlusion(depth, reach):
    """Brightness: 1 at exposed points, less in cracks and between spheres. It follows from the depth relative to the blurred depth around it."""
    from_infinity = np.isfinite(depth)
    low = depth[from_infinity].min()
    filled = np.where(from_infinity, depth, low)
    blurred = filled
    for axis in (0, 1):
        sums = np.cumsum(np.pad(blurred, [(reach + 1, reach) if k == axis else (0, 0) for k in (0, 1)], "edge"), axis)
        window = 2 * reach + 1
        take = [slice(None), slice(None)]
        take[axis] = slice(window, None)
        back = [slice(None), slice(None)]
        back[axis] = slice(None, -window)
        blurred = (sums[tuple(take)] - sums[tuple(back)]) / window
    return blurred - filled


class Surface:
    """The specimen, cast once and coloured several times."""

    def __init__(self, specimen):
        self.turn = turn = oblique(specimen)
        self.middle = middle = specimen.middle
        self.beside = specimen.beside
        framed = ((specimen.framed - middle) @ turn.T)[:, :2]
        self.panes = panes(specimen.beside.walls, specimen.lower, specimen.upper)
        beside = np.vstack([self.beside.vertex[np.unique(self.beside.facet)], self.panes.reshape(-1, 3)])
        beside = ((beside - middle) @ turn.T)[:, :2]
        if specimen.has_bonds and specimen.count:
            most = SHARE_OF_TOOL * np.ptp(framed, axis=0).max()
            beside = np.clip(beside, framed.min(axis=0) - most, framed.max(axis=0) + most)
        self.low = np.vstack([framed - specimen.radius[:, None], beside]).min(axis=0)
        self.high = np.vstack([framed + specimen.radius[:, None], beside]).max(axis=0)
        margin = 0.04 * (self.high - self.low).max()
        self.low, self.high = self.low - margin, self.high + margin
        size = self.high - self.low
        pixel = size.max() / PICTURE_HEIGHT
        shape = tuple(np.maximum(1, np.ceil(size[::-1] / pixel).astype(int)))
        self.high = self.low + pixel * np.array(shape[::-1])
        centre = (specimen.position - middle) @ turn.T
        depth, self.nearest, normal = cast(centre, specimen.radius, self.low, pixel, shape)
        hit = self.nearest >= 0
        self.shade = np.ones(shape)
        if hit.any():
            light = np.array([-0.45, 0.55, 0.75])
            lambert = np.clip(normal @ (light / np.linalg.norm(light)), 0, 1)
            scale = np.median(specimen.radius)
            reach = int(np.clip(2.0 * scale / pixel, 2, 60))
            dark = np.clip(occlusion(depth, reach) / (2.5 * scale), 0, 1)
            self.shade = (0.42 + 0.62 * lambert) * (1 - 0.55 * dark)

    def colored(self, colors):
        """Returns an RGBA picture with one row of `colors` per particle; transparent without particles."""
        hit = self.nearest >= 0
        picture = np.zeros(self.nearest.shape + (4,))
        picture[hit] = colors[self.nearest[hit]]
        picture[..., :3] = np.clip(picture[..., :3] * self.shade[..., None], 0, 1)
        return picture


    def draw(self, axes, colors):
        axes.imshow(self.colored(colors), origin="lower", interpolation="antialiased", extent=(self.low[0], self.high[0], self.low[1], self.high[1]))
        self.beside.draw_seen(axes, self.turn, self.middle, self.panes)
        axes.set_xlim(self.low[0], self.high[0])
        axes.set_ylim(self.low[1], self.high[1])
        axes.axis("off")
        scale_bar(axes, self.low, self.high)


def scale_bar(axes, low, high):
    """Draws a scale bar of a round length in the lower left corner, in place of axes."""
    wanted = 0.3 * (high[0] - low[0])
    power = 10 ** np.floor(np.log10(wanted))
    length = max(m * power for m in (1, 2, 5) if m * power <= wanted)
    factor, unit = scale_of([length], "m")
    y = low[1] - 0.02 * (high[1] - low[1])
    axes.plot([low[0], low[0] + length], [y, y], color=INK, lw=2.5, solid_capstyle="butt", clip_on=False)
    axes.text(low[0] + length / 2, y - 0.012 * (high[1] - low[1]), f"{length / factor:g} {unit}", ha="center", va="top")


def panels(count, aspect, height=5.6):
    """Figure with `count` pictures side by side, long ones one above the other; aspect is width over height of a picture."""
    width = np.clip(height * aspect + 1.4, 3.4, 8.0)
    long = aspect > 2.4
    size = (11.0, count * (0.9 + 8.5 / aspect)) if long else (count * width, height)
    figure, axes = plt.subplots(count if long else 1, 1 if long else count, figsize=size, constrained_layout=True, squeeze=False)
    for a in axes.flat:
        a.set_aspect("equal")
        a.grid(False)
        for side in a.spines.values():
            side.set_visible(False)
        a.set_xticks([])
        a.set_yticks([])
    return figure, axes.ravel()


def color_bar(figure, axes, norm, colors, label, extend):
    mappable = plt.cm.ScalarMappable(norm, colors)
    bar = figure.colorbar(mappable, ax=axes, shrink=0.7, pad=0.03, extend=extend, aspect=24)
    bar.set_label(label)
    bar.outline.set_visible(False)


def plot_surface(specimen, path):
    if specimen.flat:
        return None
    surface = Surface(specimen)
    size = surface.high - surface.low
    colorings = specimen.colorings()
    figure, axes = panels(len(colorings), size[0] / size[1])
    for a, (title, values, colors, norm, label) in zip(axes, colorings):
        surface.draw(a, colors(norm(values)))
        a.set_title(title)
        color_bar(figure, a, norm, colors, label, extend_of(values, norm))
    save(figure, path)
    return f"The surface at the end of the run, {specimen.names[1]} upward.{specimen.beside.text_seen(surface.panes)}"


# --- the slice -----------------------------------------------------------------------------------------

def cut(specimen):
    """(indices, centres, radii) of the circles in the slice through the middle; all discs in 2D."""
    if specimen.flat:
        return np.arange(specimen.count), specimen.position[:, :2], specimen.radius
    height = specimen.radius ** 2 - (specimen.position[:, 2] - specimen.plane) ** 2
    index = np.flatnonzero(height > 0)
    return index, specimen.position[index, :2], np.sqrt(height[index])


def cracks(specimen, results, state):
    """[n][2][2]: broken bonds as segments: the disc midway between the two spheres, across the bond, of the
    radius of the smaller one, where it crosses the slice."""
    i, j = (np.asarray(results.bonds[k].value, int).reshape(-1) for k in ("i", "j"))
    wanted = results.bond_state == state
    i, j = i[wanted], j[wanted]
    both = specimen.keep[i] & specimen.keep[j]
    i, j = i[both], j[both]
    xi, xj = specimen.all_position[i], specimen.all_position[j]
    ri, rj = specimen.all_radius[i], specimen.all_radius[j]
    branch = xj - xi
    length = np.linalg.norm(branch, axis=1)
    near = (length > 0) & (length < 2 * (ri + rj))  # Fragments that have separated leave no crack to draw.
    xi, branch, length, ri, rj = xi[near], branch[near], length[near], ri[near], rj[near]
    normal = branch / length[:, None]
    centre = xi + normal * (0.5 * (length + ri - rj))[:, None]
    half = np.minimum(ri, rj)
    in_plane = np.hypot(normal[:, 0], normal[:, 1])
    if not specimen.flat:
        offset = centre[:, 2] - specimen.plane
        crossing = (in_plane > 1e-6) & (np.abs(offset) < half * in_plane)
        centre, normal, half, in_plane, offset = (v[crossing] for v in (centre, normal, half, in_plane, offset))
        half = np.sqrt(half ** 2 - (offset / in_plane) ** 2)
        centre = centre[:, :2] + normal[:, :2] * (normal[:, 2] * offset / in_plane ** 2)[:, None]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1) / np.maximum(in_plane, 1e-300)[:, None]
    return np.stack([centre[:, :2] - along * half[:, None], centre[:, :2] + along * half[:, None]], axis=1)


def draw_circles(axes, centres, radii, faces, edge):
    if not len(radii):
        return
    axes.add_collection(EllipseCollection(2 * radii, 2 * radii, np.zeros(len(radii)), units="xy", offsets=centres,
                                          transOffset=axes.transData, facecolors=faces, edgecolors=edge,
                                          linewidths=0.25))


# Draws bonds by state. Intact bonds are drawn thinner and below the others, if there are any.
CRACKS = ((5, "#8c510a", 0.7, "yielded"), (4, "#d99a2b", 0.9, "softening"), (1, RED, 1.3, "broken in tension"),
          (2, BLUE, 1.3, "broken in shear"))


def draw_cracks(axes, specimen, results):
    """Draws the bonds that broke, soften or yielded."""
    if "i" not in results.bonds or "j" not in results.bonds:
        return
    for state, color, width, label in CRACKS:
        segments = cracks(specimen, results, state)
        if state > 2 and not len(segments):
            continue
        axes.add_collection(LineCollection(segments, colors=color, linewidths=width, capstyle="round"))
        axes.plot([], [], color=color, lw=2, label=f"{label} ({len(segments)})")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), title="bonds", title_fontsize=9, alignment="left")


def plot_slice(specimen, results, path):
    index, centres, radii = cut(specimen)
    left, right, bottom, top = specimen.window()
    colorings = specimen.colorings()
    with_cracks = specimen.has_bonds
    figure, axes = panels(len(colorings) + with_cracks, (right - left) / (top - bottom))
    for a, (title, values, colors, norm, label) in zip(axes, colorings):
        draw_circles(a, centres, radii, colors(norm(values[index])), "#00000055")
        a.set_title(title)
        color_bar(figure, a, norm, colors, label, extend_of(values, norm))
    if with_cracks:
        draw_circles(axes[-1], centres, radii, "#eceae5", "#b9b5ab")
        draw_cracks(axes[-1], specimen, results)
        axes[-1].set_title("Cracks")
    for a in axes:
        specimen.beside.draw_cut(a, specimen.plane, (left, right, bottom, top), specimen.flat)
        a.set_xlim(left, right)
        a.set_ylim(bottom, top)
        scale_bar(a, np.array([left, bottom]), np.array([right, top]))
    save(figure, path)
    if specimen.flat:
        drawn = " Cracks: bonds that broke, soften or yielded, drawn across the bond." if with_cracks else ""
        return "The specimen at the end of the run." + specimen.beside.text() + drawn
    where = "the middle" if specimen.plane == specimen.middle[2] else "the tool"
    text = f"Slice through {where}, plane {specimen.names[0]}–{specimen.names[1]}: the circles are the cut spheres.{specimen.beside.text()}"
    return text + (" Cracks: where the discs of bonds that broke, soften or yielded cross the slice." if with_cracks else "")
