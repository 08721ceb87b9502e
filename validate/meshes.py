"""Grids of triangles in the plane as files of gmsh, format 2.2."""
import numpy as np


def triangles(number, kept=lambda row, column: True):
    """Two in each cell of a grid, with alternating diagonals. number[row][column]: of its nodes, from 1 on."""
    cells = []
    for r in range(len(number) - 1):
        for c in range(len(number[0]) - 1):
            if not kept(r, c):
                continue
            a, b, d, e = number[r][c], number[r][c + 1], number[r + 1][c + 1], number[r + 1][c]
            cells += [(a, b, d), (a, d, e)] if (r + c) % 2 else [(a, b, e), (b, d, e)]
    return cells


def graded(marks, size):
    """Places from the first mark to the last, every mark among them; between two the spacing follows size(place) as closely as whole cells let it."""
    found = [marks[0]]
    for start, end in zip(marks, marks[1:]):
        fine = np.linspace(start, end, 2001)
        density = 1 / size(fine)
        passed = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
        count = max(1, int(np.ceil(passed[-1] - 1e-9)))
        found += [*np.interp(passed[-1] * np.arange(1, count) / count, passed, fine), end]
    return np.round(found, 9)


def write(path, nodes, cells, points):
    """`points`: groups of one node each, by name; the cells are the group body."""
    groups = [f'0 {k + 1} "{name}"' for k, name in enumerate(points)] + [f'2 {len(points) + 1} "body"']
    body, first = len(points) + 1, len(points) + 1
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups)), *groups, "$EndPhysicalNames", "$Nodes", str(len(nodes)),
             *(f"{k + 1} {x:.10g} {y:.10g} 0" for k, (x, y) in enumerate(nodes)), "$EndNodes", "$Elements", str(len(cells) + len(points)),
             *(f"{k + 1} 15 2 {k + 1} {k + 1} {node}" for k, node in enumerate(points.values())),
             *(f"{k + first} 2 2 {body} {body} {a} {b} {d}" for k, (a, b, d) in enumerate(cells)), "$EndElements"]
    path.write_text("\n".join(lines) + "\n")
