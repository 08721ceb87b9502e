"""Geometry of walls, rigid bodies and elements that pictures and the page of a run share; nothing here draws."""
import re

import numpy as np

FOLD = np.cos(np.radians(20))  # edges between facets at a smaller angle are not drawn
FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # corners of the sides of a tetrahedron


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
