"""Structured meshes of quadratic and linear elements, with the same triangles and tetrahedra as the structured meshes
of gneiss: elements use points of a grid of (2 n + 1) points per direction. Kinds have the names of CalculiX."""
import numpy as np


def chess(cells):
    """Cells of a grid [m, dimension] and whether the sum of their indices is odd."""
    cell = np.stack(np.meshgrid(*[np.arange(c) for c in cells], indexing="ij"), axis=-1).reshape(-1, len(cells))
    return cell, cell.sum(axis=1) % 2 == 1


def grid_elements(kind, cells):
    """Places [elements, nodes, dimension] in the grid of half cells."""
    cell, odd = chess(cells)
    if kind in ("CPE8", "CPE8R", "CPS8R"):
        corner = np.array([[0, 0], [2, 0], [2, 2], [0, 2]])
        return [(cell, np.vstack([corner, (corner + np.roll(corner, -1, axis=0)) // 2]), None)]
    if kind == "C3D20R":
        flat = np.array([[0, 0], [2, 0], [2, 2], [0, 2]])
        low, high = np.c_[flat, np.zeros(4, int)], np.c_[flat, 2 * np.ones(4, int)]
        corner = [low, high, (low + np.roll(low, -1, axis=0)) // 2, (high + np.roll(high, -1, axis=0)) // 2,
                  (low + high) // 2]
        return [(cell, np.vstack(corner), None)]
    if kind in ("CPE3", "CPE6"):
        simplices, edges = [[0, 1, 3], [0, 3, 2]], [(0, 1), (1, 2), (2, 0)]
    else:
        simplices = [[0, 1, 3, 5], [0, 3, 2, 6], [0, 4, 5, 6], [3, 6, 5, 7], [0, 5, 3, 6]]
        edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    edges = edges if kind in ("CPE6", "C3D10") else []
    pieces, dimension = [], len(cells)
    for simplex in simplices:
        corner = np.array([[2 * (c >> k & 1) for k in range(dimension)] for c in simplex])
        for mirrored in (False, True):  # the diagonals alternate like the colours of a chess-board
            place = corner.copy()
            if mirrored:
                place[:, 0] = 2 - place[:, 0]
            edge = place[1:] - place[0]
            if np.linalg.det(edge) < 0:
                place[[0, 1]] = place[[1, 0]]
            middle = [(place[a] + place[b]) // 2 for a, b in edges]
            pieces.append((cell, np.vstack([place, *middle]), mirrored))
    return [(c[odd == m], place, m) for c, place, m in pieces]


class Grid:
    """Nodes of the elements only, numbered along the grid; shape(unit [n, dimension]) takes the unit square or
    cube to the body."""

    def __init__(self, kind, cells, shape):
        self.kind, self.dimension = kind, len(cells)
        full = np.array(cells) * 2 + 1
        places = np.concatenate([2 * cell[:, None, :] + offset[None] for cell, offset, _ in grid_elements(kind, cells)])
        stride = np.array([np.prod(full[k + 1:], dtype=int) for k in range(len(cells))])
        used, element = np.unique(places @ stride, return_inverse=True)
        self.element = element.reshape(places.shape[:2])
        self.place = np.stack(np.unravel_index(used, full), axis=-1)  # [nodes, dimension]
        self.unit = self.place / (full - 1)
        self.points = np.zeros((len(used), 3))
        self.points[:, :self.dimension] = straight(self.place, full, shape)

    def where(self, condition):
        return np.flatnonzero(condition)

    def at(self, *unit):
        return int(self.where(np.all(np.abs(self.unit - unit) < 1e-12, axis=1))[0])


def straight(place, full, shape):
    """Corners are mapped by the shape, nodes on edges are at their middle, those on diagonals at the mean of the
    corners of the face: edges are straight, and so are diagonals if opposite sides are parallel."""
    sums = np.zeros((len(place), len(full)))
    low, high = place - place % 2, place + place % 2
    for corner in np.ndindex(*(2,) * len(full)):
        sums += shape(np.where(np.array(corner) == 1, high, low) / (full - 1))
    return sums / 2**len(full)
