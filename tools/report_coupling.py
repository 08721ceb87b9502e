"""Particles and finite elements that are one body, in one picture (2D)."""
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


def largest_principal(stress):
    """Of rows xx yy zz xy ..., in the plane."""
    middle, half = 0.5 * (stress[:, 0] + stress[:, 1]), 0.5 * (stress[:, 0] - stress[:, 1])
    return middle + np.hypot(half, stress[:, 3])


def quantities(results, mesh, displacement):
    """Title, values of the mesh's elements (None: they have none), values of the particles, unit, colors, symmetric."""
    moved = np.linalg.norm(mesh.displacement, axis=1)[mesh.element].mean(axis=1)
    yield "Displacement", moved, np.linalg.norm(displacement, axis=1), "m", plt.cm.viridis, False
    stress = results.particle("stress")
    if stress is not None and "principal_stress" in mesh.values:
        of_mesh = np.asarray(mesh.values["principal_stress"][0], float)
        of_mesh = of_mesh[:, 0] if of_mesh.ndim == 2 else of_mesh
        yield "Largest principal stress", of_mesh, largest_principal(np.asarray(stress, float)), "Pa", plt.cm.RdBu_r, True
    damage = results.particle("damage")
    if damage is not None and np.any(damage > 0):
        yield "Damage", None, np.asarray(damage, float), "1", plt.cm.Reds, False


def draw_panel(figure, axes, mesh, places, radius, what):
    title, of_mesh, of_particles, unit, colors, symmetric = what
    both = np.concatenate([of_particles] + ([] if of_mesh is None else [of_mesh[mesh.owner]]))
    factor, text = scale_of(both, unit)
    norm = norm_of(both / factor)
    if symmetric:
        top = max(abs(norm.vmin), abs(norm.vmax))
        norm = Normalize(-top, top)
    corners = places[0][mesh.facet]
    faces = "#eceae5" if of_mesh is None else colors(norm(of_mesh[mesh.owner] / factor))
    axes.add_collection(PolyCollection(corners, facecolors=faces, edgecolors=(0, 0, 0, 0.25), linewidths=0.15))
    draw_circles(axes, places[1], radius, colors(norm(of_particles / factor)), "#00000033")
    axes.set_title(title)
    whole = np.concatenate(places)
    low, high = whole.min(axis=0), whole.max(axis=0)
    margin = 0.03 * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin - 0.06 * (high - low)[1], high[1] + margin)
    axes.set_aspect("equal")
    axes.axis("off")
    scale_bar(axes, low, high)
    label = f"{title[0].lower()}{title[1:]}" + (f" [{text}]" if text else "")
    color_bar(figure, axes, norm, colors, label, "both")


def plot_together(results, path):
    """None where particles and elements are not coupled, or in space."""
    position, displacement = results.particle("position"), results.particle("displacement")
    if results.dimension != 2 or results.column("returned_energy") is None or position is None or displacement is None:
        return None
    mesh = Mesh(results)
    factor = mesh.scale()
    start = np.asarray(position, float) - displacement
    places = [np.nan_to_num(mesh.start + factor * mesh.displacement)[:, :2], np.nan_to_num(start + factor * displacement)[:, :2]]
    wanted = list(quantities(results, mesh, displacement))
    size = np.ptp(np.concatenate(places), axis=0)
    height = float(np.clip(9.0 * size[1] / max(size[0], 1e-300) + 0.6, 1.2, 6.0))
    figure, axes = plt.subplots(len(wanted), 1, figsize=(9.0, height * len(wanted)), constrained_layout=True, squeeze=False)
    for a, what in zip(axes[:, 0], wanted):
        draw_panel(figure, a, mesh, places, np.asarray(results.particle("radius"), float), what)
    save(figure, path)
    times = f"displacements drawn {factor:g} times" if factor > 1 else "displacements as they are"
    return f"Particles and elements at the end of the run, {times}."
