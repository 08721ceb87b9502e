"""Draws rigid bodies and walls into the pictures of a specimen, as seen by the viewer of report_pictures.py."""
import os
import re

import h5py
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from report_files import DAMAGE, values

BODY, WALL = "#3f5f77", "#5d5b55"
FOLD = np.cos(np.radians(20))  # edges between facets at a smaller angle are not drawn


def _numbers(text):
    return [float(v) for v in text.split(",")]


def walls_of(results, time):
    """[(point, normal)] of the walls of the scene, where they are at `time` (None: at the end)."""
    block = re.search(r"^walls:\n(.*?)(?=^\S|\Z)", results.scene, re.MULTILINE | re.DOTALL)
    found = []
    for item in re.split(r"^  - ", block[1], flags=re.MULTILINE)[1:] if block else []:
        name = re.search(r'name: "(.*)"', item)
        point, normal = (re.search(rf"^    {key}: \[(.*)\]", item, re.MULTILINE) for key in ("point", "normal"))
        if not (name and point and normal):
            continue
        point, normal = (np.pad(_numbers(v[1]), (0, 3))[:3] for v in (point, normal))
        at, moved = results.column("time"), [results.column(f"wall_{name[1]}_displacement_{axis}") for axis in "xyz"]
        if at is not None:
            point = point + [0.0 if m is None else m[-1] if time is None else np.interp(time, at, m) for m in moved]
        found.append((point, normal))
    return found


def folds(facet, corner):
    """Rows of two vertices: sides of facets that are folded or have no neighbour."""
    if facet.shape[1] == 2:
        return facet
    a, b, c = (corner[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    places, of = {}, []
    sides = np.sort(facet[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    for row, side in enumerate(map(tuple, sides)):
        if side in places:
            of[places[side]].append(row // 3)
        else:
            places[side] = len(of)
            of.append([row // 3])
    shown = [side for side, k in places.items() if len(of[k]) != 2 or abs(normal[of[k][0]] @ normal[of[k][1]]) < FOLD]
    return np.array(shown, int).reshape(-1, 2)


def panes(walls, lower, upper):
    """[walls][4][3]: of each wall that is near the specimen (farther by less than its size) the rectangle before it."""
    corners = np.array([[x, y, z] for x in (lower[0], upper[0]) for y in (lower[1], upper[1]) for z in (lower[2], upper[2])])
    found = []
    for point, normal in walls:
        n = normal / np.linalg.norm(normal)
        away = (corners - point) @ n
        if np.abs(away).min() > np.linalg.norm(upper - lower) or (away < 0).all():
            continue
        u = np.eye(3)[np.argmin(np.abs(n))]
        u = np.cross(n, np.cross(u, n))
        u /= np.linalg.norm(u)
        v = np.cross(n, u)
        foot = corners - away[:, None] * n
        a, b = foot @ u, foot @ v
        (a0, a1), (b0, b1) = ((s.min() - 0.06 * np.ptp(s), s.max() + 0.06 * np.ptp(s)) for s in (a, b))
        base = (point @ n) * n
        found.append([base + p * u + q * v for p, q in ((a0, b0), (a1, b0), (a1, b1), (a0, b1))])
    return np.array(found).reshape(-1, 4, 3)


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
