"""Draws particles and finite elements that form one body in one picture: the plane, or a section through the middle
of a body in space."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from report_curves import save
from report_elements import Mesh, norm_of
from report_pictures import color_bar, draw_circles, scale_bar
from report_results import scale_of

EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
MIDDLE = 0.4987  # place of the section relative to the extent across it; it lies in no layer of nodes


def largest_principal(stress, flat):
    """Largest principal stress of rows xx yy zz xy yz xz; in the plane if the model is plane."""
    if flat:
        middle, half = 0.5 * (stress[:, 0] + stress[:, 1]), 0.5 * (stress[:, 0] - stress[:, 1])
        return middle + np.hypot(half, stress[:, 3])
    return np.linalg.eigvalsh(stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]])[:, 2]


def cut(start, place, element, level):
    """Sections of tetrahedra, corners in order, where the third coordinate at the start is `level`; which elements."""
    depth = start[element][:, :, 2] - level
    polygons, owner = [], []
    for e in np.flatnonzero((depth.min(axis=1) < 0) & (depth.max(axis=1) > 0)):
        points = []
        for a, b in EDGES:
            if (depth[e, a] < 0) != (depth[e, b] < 0):
                part = depth[e, a] / (depth[e, a] - depth[e, b])
                points.append(((1 - part) * place[element[e, a]] + part * place[element[e, b]])[:2])
        points = np.array(points)
        away = points - points.mean(axis=0)
        polygons.append(points[np.argsort(np.arctan2(away[:, 1], away[:, 0]))])
        owner.append(e)
    return polygons, np.array(owner, int)


class Section:
    """Faces of elements and discs of particles to draw, displaced `factor` times, with the owner of each."""

    def __init__(self, results, mesh, factor):
        moved = np.asarray(results.particle("displacement"), float)
        start, radius = np.asarray(results.particle("position"), float) - moved, np.asarray(results.particle("radius"), float).reshape(-1)
        removed = results.particle("removed")
        there = np.isfinite(start).all(axis=1) if removed is None else np.asarray(removed).reshape(-1) == 0
        there &= ~results.dormant  # the elements that contain them are drawn
        order, self.where = [0, 1, 2], ""
        if not mesh.flat:
            both = np.concatenate([mesh.start, start[there]])
            across = int(np.argmin(np.ptp(both, axis=0)))
            right, up = (k for k in range(3) if k != across)
            order = [right, up, across]
            level = both[:, across].min() + MIDDLE * np.ptp(both[:, across])
            self.where = f" In the plane {'xyz'[across]} = {level:.4g} m."
        nodes, node_places = mesh.start[:, order], np.nan_to_num(mesh.start + factor * mesh.displacement)[:, order]
        start, places = start[:, order], np.nan_to_num(start + factor * moved)[:, order]
        if mesh.flat:
            self.faces, self.owner, shown = list(node_places[mesh.facet][:, :, :2]), mesh.owner, there
        else:
            self.faces, self.owner = cut(nodes, node_places, mesh.element, level)
            shown = there & (np.abs(start[:, 2] - level) < radius)
            radius = np.sqrt(np.maximum(radius**2 - (start[:, 2] - level) ** 2, 0))
        self.shown = np.flatnonzero(shown)
        self.places, self.radius = places[self.shown, :2], radius[self.shown]
        corners = np.concatenate(self.faces) if self.faces else np.empty((0, 2))
        at_start = np.concatenate([corners, start[self.shown, :2]])
        near = np.linalg.norm(self.places - start[self.shown, :2], axis=1) < 0.2 * np.ptp(at_start, axis=0).max()  # others are chips that flew away
        whole = np.concatenate([corners, start[self.shown, :2][~near], self.places[near]])
        self.low, self.high = whole.min(axis=0), whole.max(axis=0)


def quantities(results, mesh):
    """Title, values of the elements of the mesh (None: no values), values of the particles, unit, colors, symmetric."""
    moved = np.linalg.norm(mesh.displacement, axis=1)[mesh.element].mean(axis=1)
    displacement = np.asarray(results.particle("displacement"), float)
    yield "Displacement", moved, np.linalg.norm(displacement, axis=1), "m", plt.cm.viridis, False
    stress = results.particle("stress")
    if stress is not None and "principal_stress" in mesh.values:
        of_mesh = np.asarray(mesh.values["principal_stress"][0], float)
        of_mesh = of_mesh[:, 0] if of_mesh.ndim == 2 else of_mesh
        yield "Largest principal stress", of_mesh, largest_principal(np.asarray(stress, float), mesh.flat), "Pa", plt.cm.RdBu_r, True
    damage = results.particle("damage")
    if damage is not None and np.any(damage > 0):
        yield "Damage", None, np.asarray(damage, float), "1", plt.cm.Reds, False


def draw_panel(figure, axes, section, what):
    title, of_mesh, of_particles, unit, colors, symmetric = what
    of_particles = of_particles[section.shown]
    both = np.concatenate([of_particles] + ([] if of_mesh is None else [of_mesh[section.owner]]))
    factor, text = scale_of(both, unit)
    norm = norm_of(both / factor)
    if unit == "1":  # A share, which may be zero except at a few times.
        factor, text, norm = 1.0, "1", Normalize(0, 1)
    if symmetric:
        top = max(abs(norm.vmin), abs(norm.vmax))
        norm = Normalize(-top, top)
    faces = "#eceae5" if of_mesh is None else colors(norm(of_mesh[section.owner] / factor))
    axes.add_collection(PolyCollection(section.faces, facecolors=faces, edgecolors=(0, 0, 0, 0.25), linewidths=0.15))
    draw_circles(axes, section.places, section.radius, colors(norm(of_particles / factor)), "#00000033")
    axes.set_title(title)
    low, high = section.low, section.high
    margin = 0.03 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin - 0.06 * (high - low)[1], high[1] + margin)
    axes.set_aspect("equal")
    axes.axis("off")
    scale_bar(axes, low, high)
    label = f"{title[0].lower()}{title[1:]}" + (f" [{text}]" if text else "")
    color_bar(figure, axes, norm, colors, label, "both")


def plot_together(results, path):
    """Returns None if particles and elements are not coupled."""
    position, displacement = results.particle("position"), results.particle("displacement")
    coupled = results.column("returned_energy") is not None or results.column("elements") is not None
    if not coupled or position is None or displacement is None:
        return None
    mesh = Mesh(results)
    factor = mesh.scale()
    section = Section(results, mesh, factor)
    wanted = list(quantities(results, mesh))
    size = section.high - section.low
    height = float(np.clip(9.0 * size[1] / max(size[0], 1e-300) + 0.6, 1.2, 6.0))
    figure, axes = plt.subplots(len(wanted), 1, figsize=(9.0, height * len(wanted)), constrained_layout=True, squeeze=False)
    for a, what in zip(axes[:, 0], wanted):
        draw_panel(figure, a, section, what)
    save(figure, path)
    times = f"displacements drawn {factor:g} times" if factor > 1 else "displacements as they are"
    left_out = " Dormant particles are left out: the elements that contain them are drawn." if results.dormant.any() else ""
    return f"Particles and elements at the end of the run, {times}.{section.where}{left_out}"
