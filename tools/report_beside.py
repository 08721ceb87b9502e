"""Draws rigid bodies and walls into the pictures of a specimen, as seen by the viewer of report_pictures.py."""
import os

import h5py
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from report_files import DAMAGE, values
from report_shapes import folds, walls_of

BODY, WALL = "#3f5f77", "#5d5b55"


class Beside:
    """`order`, `sign`: see Specimen. `snapshot`: the file of the particles that are drawn; None: the particles at the
    end."""

    def __init__(self, results, order, sign, snapshot=None, time=None):
        self.turn = lambda x: np.asarray(x, float).reshape(-1, 3)[:, order] * [1, 1, sign]
        self.facet = np.zeros((0, 3), int)
        self.vertex = np.zeros((0, 3))
        if "facet" in results.bodies and "vertex" in results.bodies:
            self.facet = np.asarray(results.bodies["facet"].value, int)
            self.vertex = self.turn(np.pad(results.bodies["vertex"].value, ((0, 0), (0, 2)))[:, :3])
        of = results.bodies.get("facet_body")  # the body of each facet
        self.owner = np.zeros(len(self.facet), int) if of is None else np.asarray(of.value, int).reshape(-1)
        if snapshot and len(self.facet):
            self._move(snapshot)
        self.walls = [(self.turn(p)[0], self.turn(n)[0]) for p, n in walls_of(results, time)]
        self.there = bool(len(self.facet) or self.walls)

    def _move(self, snapshot):
        folder, name = os.path.split(snapshot)
        try:
            with h5py.File(os.path.join(folder, name.replace("particles_", "bodies_")), "r") as file:
                vertex = values(file, "VTKHDF/Points")
        except DAMAGE:
            return
        if len(vertex) == len(self.vertex):
            self.vertex = self.turn(vertex)

    def bounds(self, lower, upper, most=np.inf):
        """Returns the limits of the picture extended to contain the bodies, by at most `most` on each side."""
        if not len(self.facet):
            return lower, upper
        used = self.vertex[np.unique(self.facet)]
        return (np.minimum(lower, np.maximum(used.min(axis=0), lower - most)),
                np.maximum(upper, np.minimum(used.max(axis=0), upper + most)))

    def draw_cut(self, axes, depth, window, flat):
        """Sections of bodies and walls with the plane z = depth; in 2D their outlines."""
        if len(self.facet):
            axes.add_collection(LineCollection(self._cut(depth, flat), colors=BODY, linewidths=1.4, capstyle="round", zorder=3))
        left, right, bottom, top = window
        middle, reach = np.array([left + right, bottom + top]) / 2, np.hypot(right - left, top - bottom)
        for point, normal in self.walls:
            across = np.hypot(*normal[:2])
            if across < 1e-6 * np.linalg.norm(normal):
                continue  # the wall is in the plane of the picture
            n = normal[:2] / across
            offset = (normal @ (point - [*middle, 0.0 if flat else depth])) / across
            foot, along = middle + offset * n, np.array([-n[1], n[0]])
            ends = np.array([foot - reach * along, foot + reach * along])
            axes.add_collection(LineCollection([ends], colors=WALL, linewidths=1.6, zorder=2))
            behind = np.array([*ends, *(ends[::-1] - 0.02 * reach * n)])
            axes.add_collection(PolyCollection([behind], facecolors="none", edgecolors=WALL, hatch="////", linewidths=0.0, alpha=0.6, zorder=1))

    def _cut(self, depth, flat):
        corner = self.vertex[self.facet]
        if flat or self.facet.shape[1] == 2:
            return corner[:, :2, :2]
        segments = []
        for triangle in corner[(corner[:, :, 2].min(axis=1) <= depth) & (corner[:, :, 2].max(axis=1) >= depth)]:
            points = []
            for p, q in zip(triangle, np.roll(triangle, -1, axis=0)):
                if (p[2] - depth) * (q[2] - depth) < 0:
                    points.append(p[:2] + (depth - p[2]) / (q[2] - p[2]) * (q[:2] - p[:2]))
                elif p[2] == depth:
                    points.append(p[:2])
            if len(points) >= 2:
                segments.append([points[0], points[-1]])
        return segments

    def draw_seen(self, axes, turn, middle, panes=()):
        """Draws edges and translucent facets of bodies and walls before the rest, so that grains inside remain
        visible."""
        if len(panes):
            seen = ((np.asarray(panes) - middle) @ turn.T)[:, :, :2]
            axes.add_collection(PolyCollection(seen, facecolors=WALL, edgecolors="none", alpha=0.05, zorder=2))
            axes.add_collection(LineCollection(seen[:, [0, 1, 2, 3, 0]], colors=WALL, linewidths=0.9, zorder=2))
        if not len(self.facet) or self.facet.shape[1] == 2:
            return
        seen = (self.vertex - middle) @ turn.T
        axes.add_collection(PolyCollection(seen[self.facet][:, :, :2], facecolors=BODY, edgecolors="none", alpha=0.07, zorder=2))
        edges = folds(self.facet, self.vertex[self.facet])
        axes.add_collection(LineCollection(seen[edges][:, :, :2], colors=BODY, linewidths=1.0, capstyle="round", zorder=3))

    def text_seen(self, panes):
        """Caption of the bodies and walls of a picture in space."""
        parts = [["rigid bodies (blue)"], []][not len(self.facet)] + [["walls (grey)"], []][not len(panes)]
        return f" Lines: {' and '.join(parts)}." if parts else ""

    def text(self):
        """Caption of the bodies and walls of a slice."""
        parts = [["rigid bodies (blue)"], []][not len(self.facet)] + [["walls (hatched behind)"], []][not self.walls]
        return f" Lines: {' and '.join(parts)}." if parts else ""
