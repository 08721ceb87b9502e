"""Pictures of finite elements: the deformed mesh, coloured by stress."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize

from report_curves import GREY, save
from report_pictures import color_bar, oblique, panels, scale_bar
from report_results import scale_of
from report_shapes import FACES

LINES_UP_TO = 4000    # Largest number of facets that are drawn with their edges.
SHOWN = 0.05          # Least apparent size of the largest displacement, relative to the size of the body.


class Mesh:
    """Facets to draw (all triangles in 2D, the boundary in 3D), deformed, with values per element."""

    def __init__(self, results):
        nodes, elements = results.nodes, results.elements
        self.flat = results.dimension == 2
        self.up = results.up_axis()
        self.element = np.asarray(elements["node"].value, int)
        self.displacement = np.asarray(nodes["displacement"].value, float)
        self.start = np.asarray(nodes["position"].value, float) - self.displacement
        self.values = {name: (column.value, column.unit) for name, column in elements.items()}
        good = np.isfinite(self.start).all(axis=1) & np.isfinite(self.displacement).all(axis=1)
        self.keep = good[self.element].all(axis=1)
        used = self.start[good]
        self.size = float(np.ptp(used, axis=0).max()) if len(used) else 0.0
        self.facet, self.owner = self.facets()

    def facets(self):
        """Returns the corners of each facet and the element to which it belongs."""
        owner = np.flatnonzero(self.keep)
        if self.flat:
            return self.element[owner], owner
        faces = self.element[owner][:, FACES].reshape(-1, 3)
        owner = np.repeat(owner, 4)
        _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        outside = first[count == 1]
        return faces[outside], owner[outside]

    def scale(self):
        """Returns a round factor that makes displacements visible in a picture; 1 if they are visible without it."""
        moved = np.linalg.norm(self.displacement, axis=1)
        largest = float(moved[np.isfinite(moved)].max(initial=0.0))
        wanted = SHOWN * self.size / largest if largest > 0 else 1.0
        if not np.isfinite(wanted) or wanted <= 1:
            return 1.0
        power = 10 ** np.floor(np.log10(wanted))
        return float(max(m * power for m in (1, 2, 5) if m * power <= wanted))


def view(mesh, position):
    """Returns the directions right, up and towards the viewer: normal to the plane in 2D, otherwise oblique."""
    if mesh.flat:
        return position
    order = ([1, 0, 2], [0, 1, 2], [0, 2, 1])[mesh.up]
    return (position[:, order] * [1, 1, 1 if mesh.up == 1 else -1]) @ oblique(None).T


def shade(corners):
    """Facets turned to the viewer are brighter; those turned away are not drawn."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    toward = normal[:, 2] / np.where(length > 0, length, 1)
    return 0.55 + 0.45 * np.abs(toward)


def norm_of(values):
    """Limits that a few elements at a support or a notch do not set."""
    low, high = np.percentile(values, [1, 99])
    if not high > low:
        low, high = low - 0.5 * (abs(low) or 1), high + 0.5 * (abs(high) or 1)
    return Normalize(low, high)


def draw_panel(figure, axes, mesh, place, title, name, colors, symmetric):
    values, unit = mesh.values[name]
    values = np.asarray(values, float)
    values = values[:, 0] if values.ndim == 2 else values.reshape(-1)
    values = np.nan_to_num(values[mesh.owner])
    factor, text = scale_of(values, unit)
    values = values / factor
    norm = norm_of(values)
    if symmetric:
        top = max(abs(norm.vmin), abs(norm.vmax))
        norm = Normalize(-top, top)
    corners = place[mesh.facet]
    order = np.arange(len(corners)) if mesh.flat else np.argsort(corners[:, :, 2].mean(axis=1))
    face = colors(norm(values))
    if not mesh.flat:
        face[:, :3] *= shade(corners)[:, None]
    lines = len(corners) <= LINES_UP_TO
    axes.add_collection(PolyCollection(corners[order][:, :, :2], facecolors=face[order], linewidths=0.15 if lines else 0.3,
                                       edgecolors=(0, 0, 0, 0.35) if lines else face[order]))
    axes.set_title(title)
    low, high = place[:, :2].min(axis=0), place[:, :2].max(axis=0)
    margin = 0.03 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin - 0.06 * (high - low)[1], high[1] + margin)
    axes.axis("off")
    scale_bar(axes, low, high)
    color_bar(figure, axes, norm, colors, f"{title[0].lower()}{title[1:]} [{text}]", "both")


def outline(mesh, axes):
    """Draws the boundary at the start, 2D only."""
    edges = np.sort(mesh.facet[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    axes.add_collection(LineCollection(mesh.start[edges[count == 1]][:, :, :2], colors=GREY, linewidths=0.8, zorder=0))


def plot_elements(results, path):
    if "node" not in results.elements or not {"position", "displacement"} <= results.nodes.keys():
        return None
    mesh = Mesh(results)
    if not len(mesh.facet) or not mesh.size > 0:
        return None
    factor = mesh.scale()
    place = view(mesh, np.nan_to_num(mesh.start + factor * mesh.displacement))
    wanted = [("Von Mises stress", "von_mises", plt.cm.viridis, False),
              ("Largest principal stress", "principal_stress", plt.cm.RdBu_r, True)]
    wanted = [w for w in wanted if w[1] in mesh.values]
    if not wanted:
        return None
    size = place[:, :2].max(axis=0) - place[:, :2].min(axis=0)
    tall = size[1] > 0.8 * size[0]
    if tall:
        figure, axes = panels(len(wanted), size[0] / size[1])
    else:
        height = float(np.clip(7.5 * size[1] / size[0] + 0.6, 1.6, 6.0))
        figure, axes = plt.subplots(len(wanted), 1, figsize=(9.0, height * len(wanted)), constrained_layout=True,
                                    squeeze=False)
        axes = axes[:, 0]
        for a in axes:
            a.set_aspect("equal")
            a.grid(False)
    for a, (title, name, colors, symmetric) in zip(axes, wanted):
        if mesh.flat:
            outline(mesh, a)
        draw_panel(figure, a, mesh, place, title, name, colors, symmetric)
    save(figure, path)
    times = f"displacements drawn {factor:g} times" if factor > 1 else "displacements as they are"
    return f"The mesh at the end of the run, {times}" + ("; grey: its outline at the start." if mesh.flat else ".")
