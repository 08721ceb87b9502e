"""Grids of triangles in the plane and of tetrahedra in space as files of gmsh, format 2.2, and prisms as STL."""
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


CENTRAL, CORNERS = ((0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1)), ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1))


def tetrahedra(number, kept=lambda column, row, layer: True):
    """Five in each cell of a grid, the one in its middle turned from cell to cell. number[column, row, layer]: of its nodes, from 1 on."""
    found = []
    for start in np.ndindex(*(n - 1 for n in number.shape)):
        if not kept(*start):
            continue
        odd = sum(start) % 2
        node = lambda corner: number[start[0] + (corner[0] ^ odd), start[1] + corner[1], start[2] + corner[2]]  # noqa: E731
        shapes = [CENTRAL, *((c, *(near for near in CENTRAL if sum(abs(a - b) for a, b in zip(c, near)) == 1)) for c in CORNERS)]
        for shape in shapes:
            right = np.linalg.det([np.subtract(corner, shape[0]) for corner in shape[1:]]) > 0
            a, b, c, d = (node(corner) for corner in shape)
            found.append((a, b, c, d) if right != bool(odd) else (a, c, b, d))
    return found


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
    """`points`: groups of one node each, by name; the cells, triangles or tetrahedra, are the group body."""
    dimension, kind = (3, 4) if len(cells[0]) == 4 else (2, 2)
    groups = [f'0 {k + 1} "{name}"' for k, name in enumerate(points)] + [f'{dimension} {len(points) + 1} "body"']
    body, first = len(points) + 1, len(points) + 1
    places = ((*place, 0)[:3] for place in nodes)
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups)), *groups, "$EndPhysicalNames", "$Nodes", str(len(nodes)),
             *(f"{k + 1} {x:.10g} {y:.10g} {z:.10g}" for k, (x, y, z) in enumerate(places)), "$EndNodes", "$Elements", str(len(cells) + len(points)),
             *(f"{k + 1} 15 2 {k + 1} {k + 1} {node}" for k, node in enumerate(points.values())),
             *(f"{k + first} {kind} 2 {body} {body} " + " ".join(map(str, cell)) for k, cell in enumerate(cells)), "$EndElements"]
    path.write_text("\n".join(lines) + "\n")


def prism(path, outline, faces, height):
    """Closed surface between z = 0 and `height` over an outline [x, y], counter-clockwise, and the triangles that fill it; the path as text."""
    triangles = []
    for a, b, c in faces:
        triangles += [[(*outline[k], height) for k in (a, b, c)], [(*outline[k], 0.0) for k in (a, c, b)]]
    for k, here in enumerate(outline):
        there = outline[(k + 1) % len(outline)]
        triangles += [[(*here, 0.0), (*there, 0.0), (*there, height)], [(*here, 0.0), (*there, height), (*here, height)]]
    lines = ["solid region"]
    for corners in triangles:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex " + " ".join(f"{v:.10g}" for v in corner) for corner in corners), "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid region"]) + "\n")
    return str(path)
