"""Boxes of five tetrahedra a cell and of six round one diagonal (elements.box.diagonals): bending and torsion of a square bar beside closed forms,
the effect of a preferred direction, the step, and a notched beam with finer cells. Fills the tables of docs/evidence/fem.md; some minutes.

    /usr/bin/python3 validate/diagonals_study.py [--fresh]

The meshes are those of the program; the solutions at rest are solved for directly, with the linear tetrahedra of the displacement form.
"""
import itertools
import json

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import LinearOperator, cg

import beam_space_study as beam
import meshes
import study

LENGTH = 2.0  # length of a bar of side 1
YOUNG, POISSON = 29.13e9, 0.166  # E and nu of the beam
SPLITS = {"alternating": "five", "parallel": "six"}
SCENE = """dimension: 3
elements:
  box: {{size: {size}, origin: {origin}, cells: {cells}, diagonals: {diagonals}}}
  materials: [{{young: 1e9, poisson: {poisson}, density: 1000}}]
time: {{end: {end}}}
output: {{snapshots: 0, checkpoint: off, history_rows: 2}}
"""


def run(name, diagonals, size, origin, cells, poisson=0.2, end=1e-9):
    folder = study.RUNS / "diagonals"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}-{diagonals}.yaml"
    path.write_text(SCENE.format(size=list(size), origin=list(origin), cells=list(cells), diagonals=diagonals, poisson=poisson, end=end))
    return study.run(f"diagonals/{name}-{diagonals}", path, {"run.threads": 1})


def mesh(diagonals, cells, length=LENGTH):
    """Nodes [n, 3] and tetrahedra [m, 4] of a bar of side 1 about the x axis, `cells` over its side."""
    result = run(f"bar-{cells}", diagonals, (length, 1, 1), (0, -0.5, -0.5), (max(1, round(length * cells)), cells, cells))
    return result.results("nodes/position") - result.results("nodes/displacement"), result.results("elements/node")


# --- bodies at rest -------------------------------------------------------------------------------------------------

def stiffness(x, element, poisson):
    """Stiffness of linear tetrahedra with E = 1, [3 n, 3 n]."""
    lame, shear = poisson / ((1 + poisson) * (1 - 2 * poisson)), 0.5 / (1 + poisson)
    edges = x[element][:, 1:] - x[element][:, :1]
    slope = np.empty((len(element), 4, 3))  # gradients of the shape functions
    slope[:, 1:] = np.transpose(np.linalg.inv(edges), (0, 2, 1))
    slope[:, 0] = -slope[:, 1:].sum(axis=1)
    both = np.einsum("eai,ebj->eaibj", slope, slope)
    block = lame * both + shear * np.einsum("eaibj->eajbi", both)
    for k in range(3):
        block[:, :, k, :, k] += shear * np.einsum("eai,ebi->eab", slope, slope)
    block *= (np.linalg.det(edges) / 6)[:, None, None, None, None]
    freedom = (3 * element[:, :, None] + np.arange(3)).reshape(-1, 12)
    rows, columns = np.repeat(freedom, 12, axis=1).ravel(), np.tile(freedom, (1, 12)).ravel()
    return sparse.csr_matrix((block.ravel(), (rows, columns)), shape=(3 * len(x), 3 * len(x)))


def solved(matrix, given):
    """Displacements and reactions [n, 3] of a body at rest; `given` {freedom: displacement}."""
    u, held = np.zeros(matrix.shape[0]), np.array(list(given))
    u[held] = list(given.values())
    free = np.setdiff1d(np.arange(len(u)), held)
    part, load = matrix[free][:, free], -matrix[free][:, held] @ u[held]
    diagonal = part.diagonal()
    u[free], missed = cg(part, load, tol=1e-10, maxiter=20000, M=LinearOperator(part.shape, lambda r: r / diagonal))
    assert missed == 0
    return u.reshape(-1, 3), (matrix @ u).reshape(-1, 3)


def spin(x, u):
    """Mean rotation of a section about the x axis."""
    return np.sum(u[:, 2] * x[:, 1] - u[:, 1] * x[:, 2]) / np.sum(x[:, 1:] ** 2)


class Bar:
    """Stiffnesses relative to those of beam theory, minus 1."""

    def __init__(self, diagonals, cells, poisson):
        self.x, element = mesh(diagonals, cells)
        self.poisson, self.matrix = poisson, stiffness(self.x, element, poisson)
        self.low, self.high = (np.flatnonzero(np.abs(self.x[:, 0] - end) < 1e-9) for end in (0, LENGTH))

    def bent(self):
        """The ends are planes rotated by a curvature about z, then y, and free to contract: the exact state is pure
        bending. Returns the stiffnesses along the stiffest and softest directions of the section, and the largest twist relative to the curvature."""
        x, low, high = self.x, self.low, self.high
        corner, beside = (low[np.argmin(np.hypot(x[low, 1] - y, x[low, 2] + 0.5))] for y in (-0.5, 0.5))
        moments, twist = np.zeros((2, 2)), 0.0
        for k in (1, 2):
            given = {**{3 * n: 0.0 for n in low}, **{3 * n: -LENGTH * x[n, k] for n in high}, 3 * corner + 1: 0.0, 3 * corner + 2: 0.0, 3 * beside + 2: 0.0}
            u, force = solved(self.matrix, given)
            moments[k - 1] = [-np.sum(force[high, 0] * x[high, i]) * 12 for i in (1, 2)]
            twist = max(twist, abs(spin(x[high], u[high]) - spin(x[low], u[low])) / LENGTH)
        soft, stiff = np.linalg.eigvalsh(moments)
        return moments[0, 0] - 1, soft - 1, stiff - 1, twist

    def twisted(self):
        """The ends rotate rigidly in their planes and can warp: St Venant's torsion, 0.14058 G a^4."""
        given = {3 * self.low[0]: 0.0}
        for nodes, part in ((self.low, 0.0), (self.high, LENGTH)):
            for n in nodes:
                given[3 * n + 1], given[3 * n + 2] = -part * self.x[n, 2], part * self.x[n, 1]
        _, force = solved(self.matrix, given)
        moment = np.sum(force[self.high, 2] * self.x[self.high, 1] - force[self.high, 1] * self.x[self.high, 2])
        return moment / (0.1405770 * 0.5 / (1 + self.poisson)) - 1


def rest_table():
    rows = []
    for poisson in (0.2, 0.4):
        for cells in (2, 4, 8, 16):
            for diagonals, count in SPLITS.items():
                bar = Bar(diagonals, cells, poisson)
                bend, soft, stiff, twist = bar.bent()
                rows.append([poisson, cells, count, f"{100 * bend:+.1f} %", f"{100 * soft:+.1f}, {100 * stiff:+.1f} %", f"{twist:.3f}", f"{100 * bar.twisted():+.1f} %"])
    return study.table(["nu", "cells over the side", "tetrahedra a cell", "bending", "in the softest and the stiffest direction", "twist over curvature", "torsion"],
                       rows)


# --- step -------------------------------------------------------------------------------------------------------------

def step_table():
    """The table of steps for cubic cells; times in sides of a cell over the speed of sound of a bar, sqrt(E/rho)."""
    rows = []
    for poisson in (0.0, 0.2, 0.4):
        found = []
        for diagonals, count in SPLITS.items():
            result = run(f"step-{poisson:g}", diagonals, (20, 20, 20), (0, 0, 0), (20, 20, 20), poisson)
            sharp, bound = (result.summary[f"dt_limit_{kind}"] * np.sqrt(1e9 / 1000) for kind in ("sharp", "bound"))
            elements = len(result.results("elements/node"))
            found.append(elements / sharp)
            rows.append([poisson, count, f"{elements / 20**3:.0f}", f"{sharp:.3f}", f"{bound:.3f}", f"{found[-1] / found[0]:.2f}"])
    return study.table(["nu", "tetrahedra a cell", "elements a node inside", "sharp limit", "bound", "elements times steps, over five"], rows)


# --- a notched beam -------------------------------------------------------------------------------------------------

def six(number, kept):
    """Tetrahedra as those of meshes.tetrahedra (six around the diagonal of a cell), mirrored at mid-span as those of elements.beam."""
    found = []
    for start in filter(lambda start: kept(*start), np.ndindex(*(n - 1 for n in number.shape))):
        mirrored = start[0] >= (number.shape[0] - 1) // 2
        for order in itertools.permutations(range(3)):
            path = np.array([[axis in order[:k] for axis in range(3)] for k in range(4)], int)
            right = np.linalg.det(path[1:]) > 0
            path[:, 0] ^= mirrored
            a, b, c, d = (number[tuple(start + corner)] for corner in path)
            found.append((a, b, c, d) if right != mirrored else (a, c, b, d))
    return found


def beam_mesh(split, along, high, broad):
    """Nodes and elements of the beam of beam_space_study.py with cells of a fraction of their size in each direction."""
    x = beam.both_sides(meshes.graded([beam.SLOT / 2, beam.SPAN / 2, beam.LENGTH / 2], lambda x: along * np.minimum(2e-3 + 0.2 * np.maximum(x - 2e-3, 0), 8e-3)))
    y = meshes.graded([0, beam.NOTCH, beam.HEIGHT], lambda y: high * np.minimum(2e-3 + 0.25 * np.abs(y - beam.NOTCH), 6e-3))
    z = np.linspace(0, beam.BREADTH, 1 + round(2 / broad))
    nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(nodes)).reshape(len(x), len(y), len(z))
    element = np.array(split(number, lambda c, r, _: abs(x[c] + x[c + 1] - 2 * beam.MID) > beam.SLOT or y[r] + y[r + 1] > 2 * beam.NOTCH))
    used, element = np.unique(element, return_inverse=True)
    return nodes[used], element.reshape(-1, 4)


def beam_step(name, x, element):
    """The step that the program chooses, s."""
    folder = study.RUNS / "diagonals"
    folder.mkdir(parents=True, exist_ok=True)
    meshes.write(folder / f"{name}.msh", x, [tuple(nodes + 1) for nodes in element], {})
    scene = {"dimension": 3, "time": {"end": 1e-9}, "elements": {"mesh": f"{name}.msh", "materials": [{"young": YOUNG, "poisson": POISSON, "density": 2400}],
                                                                 "motions": [beam.node_motion(motion) for motion in beam.MOTIONS]}}
    (folder / f"{name}.yaml").write_text(json.dumps(scene))
    return study.run(f"diagonals/{name}", folder / f"{name}.yaml", {"run.threads": 1}).summary["dt"]


def beam_stiffness(x, element):
    """Force per deflection under the load, N/m."""
    given, loaded = {}, []
    for motion, held in beam.MOTIONS.items():
        box = beam.node_motion(motion)["box"]
        nodes = np.flatnonzero(np.all((x > np.array(box["min"])) & (x < np.array(box["max"])), axis=1))
        given |= {3 * n + "xyz".index(key[1]): -1.0 if motion == "load" else 0.0 for n in nodes for key in held}
        loaded = nodes if motion == "load" else loaded
    _, force = solved(stiffness(x, element, POISSON), given)
    return -YOUNG * np.sum(force[loaded, 1])


def beam_table():
    rows, first = [], None
    for parts in ((1, 1, 1), (1, 2 / 3, 1), (1, 1 / 2, 1), (2 / 3, 2 / 3, 2 / 3), (1 / 2, 1 / 2, 1 / 2)):
        for count, split in (("five", meshes.tetrahedra), ("six", six)):
            x, element = beam_mesh(split, *parts)
            step = beam_step(f"beam-{count}-" + "-".join(f"{part:.2g}" for part in parts), x, element)
            cost = len(element) / step
            first = first or cost
            rows.append([", ".join(f"{part:.3g}" for part in parts), count, len(element), f"{beam_stiffness(x, element) / 1e6:.2f}", f"{1e7 * step:.2f}", f"{cost / first:.1f}"])
    return study.table(["cells, parts along, over the height, over the breadth", "tetrahedra a cell", "elements", "stiffness, MN/m", "step, 1e-7 s",
                        "elements times steps"], rows)


def main():
    study.put("fem.md", "table diagonals", rest_table())
    study.put("fem.md", "table diagonals step", step_table())
    study.put("fem.md", "table diagonals beam", beam_table())


if __name__ == "__main__":
    main()
