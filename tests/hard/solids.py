"""Finite elements: nearly incompressible, slivers, inverted, and degenerate meshes."""
from hard.case import *  # noqa: F403

YOUNG = 1e9
RUBBER = {"young": 1e6, "poisson": 0.3, "density": 2000}


def solid(elements, end, **changes):
    return {"dimension": 2, "elements": elements, "time": {"end": end}, **copy.deepcopy(QUIET), **changes}


def squeezed(formulation, poisson=0.4999):
    """A square without lateral strain, compressed by 1e-4 of its height: the modulus of uniaxial strain."""
    def scene(folder):
        held = [{"name": name, "group": name, "motion": {"vx": 0}} for name in ("x_lower", "x_upper")]
        ends = [{"name": "y_lower", "group": "y_lower", "motion": {"vy": 0}},
                {"name": "y_upper", "group": "y_upper", "motion": {"vy": [[0, 0], [1e-3, -1e-2], [2e-3, 0]]}}]
        for one in held + ends:
            if one["name"][0] == "y":
                one["motion"]["vx"] = 0
        return solid({"rectangle": {"size": [0.1, 0.1], "cells": [4, 4]}, "formulation": formulation,
                      "materials": [{"young": YOUNG, "poisson": poisson, "density": 2000}], "motions": held + ends}, 3e-3,
                     damping={"background": {"model": "viscous", "coefficient": 1e4}},
                     test={"kind": "compression", "axis": "y", "lower": "y_lower", "upper": "y_upper"})
    return scene


def pushes_back(poisson=0.4999):
    """E (1 - nu)/((1 + nu)(1 - 2 nu)) times the strain 1e-4, over 0.1 m; terms of second order are a part in 1e4."""
    def check(one):
        modulus = YOUNG * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
        found = abs(one.history["motion_y_upper_reaction_y"][-1])
        return close(found, modulus * 1e-4 * 0.1, 2e-3, "N/m") + f", {one.summary['steps']} steps"
    return check


def msh(folder, nodes, triangles):
    text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + f"{len(nodes)}\n"
    text += "".join(f"{k + 1} {x!r} {y!r} 0\n" for k, (x, y) in enumerate(nodes))
    text += f"$EndNodes\n$Elements\n{len(triangles)}\n"
    text += "".join(f"{k + 1} 2 2 1 1 {a + 1} {b + 1} {c + 1}\n" for k, (a, b, c) in enumerate(triangles))
    with open(os.path.join(folder, "body.msh"), "w") as file:
        file.write(text + "$EndElements\n")


def from_mesh(nodes, triangles, end=2e-4):
    """A body whose left side is held and whose other nodes move at the start: pulled along x."""
    def scene(folder):
        msh(folder, nodes, triangles)
        width = max(x for x, _ in nodes)
        tall = max(y for _, y in nodes)
        return solid({"mesh": "body.msh", "materials": [{"young": YOUNG, "poisson": 0.3, "density": 2000}],
                      "motions": [{"name": "left", "box": {"min": [0, 0], "max": [0, tall]}, "motion": {"vx": 0, "vy": 0}},
                                  {"name": "right", "box": {"min": [width, 0], "max": [width, tall]},
                                   "motion": {"vx": [[0, 0], [2e-5, 0.1]]}}]}, end)
    return scene


def grid(n, m, at):
    nodes = [at(i, j) for j in range(m + 1) for i in range(n + 1)]
    triangles = []
    for j in range(m):
        for i in range(n):
            a, b, c, d = (j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i)
            triangles += [(a, b, c), (a, c, d)]
    return nodes, triangles


def sliver():
    """One column of cells is 1e-4 times as wide as the others."""
    return grid(6, 3, lambda i, j: (0.01 * (i if i < 3 else i - 1 + 1e-4), 0.01 * j))


def inside_out():
    """Every other triangle has its corners in the wrong sense."""
    nodes, triangles = grid(6, 3, lambda i, j: (0.01 * i, 0.01 * j))
    return nodes, [(a, c, b) if k % 2 else (a, b, c) for k, (a, b, c) in enumerate(triangles)]


def pulls(one):
    """Energy enters through the right side only."""
    rows = one.history
    assert rows["energy_elastic_elements"][-1] > 0
    return keeps_ledger(1e-4)(one)


def as_turned(one):
    """A mesh with all corners in order has the same result, to rounding."""
    folder = os.path.join(one.folder, "turned")
    os.makedirs(folder, exist_ok=True)
    nodes, triangles = grid(6, 3, lambda i, j: (0.01 * i, 0.01 * j))
    other = start(folder, from_mesh(nodes, triangles)(folder), "one")
    a, b = one.field("nodes/displacement"), other.field("nodes/displacement")
    off = np.abs(a - b).max() / np.abs(b).max()
    assert off < 1e-9, off
    return pulls(one) + f", within {off:.0e} of the mesh in order"


def flat_element():
    nodes, triangles = grid(3, 2, lambda i, j: (0.01 * i, 0.01 * j))
    return [*nodes, (0.015, 0.0)], [*triangles, (1, 2, len(nodes))]


def crushed(folder):
    """One element after another is pressed through itself by a lid."""
    return solid({"rectangle": {"size": [0.1, 0.1], "cells": [4, 4]}, "materials": [RUBBER],
                  "motions": [{"name": "foot", "group": "y_lower", "motion": {"vx": 0, "vy": 0}},
                              {"name": "lid", "group": "y_upper", "motion": {"vx": 0, "vy": -10}}]}, 0.02)


def distorted(folder):
    """The worst mesh that the scene may request, vibrating under its own weight."""
    return solid({"rectangle": {"size": [0.1, 0.05], "cells": [8, 4], "distortion": 0.2499},
                  "materials": [RUBBER],
                  "motions": [{"name": "foot", "group": "x_lower", "motion": {"vx": 0, "vy": 0}}]}, 0.3, gravity=[0, -10])


def fast_node(folder):
    """A lid sets the surface of the elements in motion towards a sphere of a micrometre, which it hits."""
    made = spheres([[0.01, 0.0201, 1e-6]], 1e-4, {"normal_stiffness": 1e-3, "kratio": 0})
    made["elements"] = {"rectangle": {"size": [0.02, 0.02], "cells": [4, 4]}, "materials": [RUBBER],
                        "motions": [{"name": "all", "group": "y_upper", "motion": {"vy": 1000.0}}], "contact": {"stiffness": 1e3}}
    return made


CASES = [
    Case("nu of 0.4999, displacement form", "pressure waves 70 times as fast as shear", "the modulus of uniaxial strain",
         squeezed("displacement"), pushes_back(), "the limit knows the bulk stiffness of elements",
         "a limit that knows the shear stiffness alone: inside out after 3 steps"),
    Case("nu of 0.4999, mixed form", "pressures with an inertia of their own", "the modulus of uniaxial strain",
         squeezed("mixed"), pushes_back(), "the limit knows the bulk stiffness of elements",
         "a limit that knows the shear stiffness alone: inside out after 4 steps", more="test_fem_pressure.c"),
    Case("nu of 0.5", "no explicit scheme has a step for it", "refused", squeezed("mixed", 0.5),
         refuses(r"poisson: expected a value below 0\.5"), "materials are looked at before elements are made",
         "refused all the same when elements are made", ends=2),
    Case("slivers", "cells 1e-4 times as wide as the others", "the ledger closes", from_mesh(*sliver()), pulls,
         "the limit knows every element", "a limit that leaves out the small ones: inside out after 4 steps"),
    Case("elements with their corners in the wrong sense", "every other triangle of a mesh",
         "they are turned: the same as a mesh in order", from_mesh(*inside_out()), as_turned,
         "elements are turned when the mesh is read", "velocities that are no numbers in the first step, stopped"),
    Case("an element without an area", "three nodes in a line", "refused, the element named", from_mesh(*flat_element()),
         refuses("expected elements with a volume, found triangle"), "areas are held against rounding",
         "velocities that are no numbers in the first step, stopped", ends=2),
    Case("elements that are crushed", "a lid goes through the body", "stopped, the element named", crushed,
         says("is turned inside out: det F"), "the least det F is looked at whenever a node may have come far",
         "velocities that are no numbers some steps later, stopped", ends=5),
    Case("a distorted mesh", "nodes moved by up to a quarter of a cell, swinging under its weight", "the ledger closes",
         distorted, keeps_ledger(1e-3), "the limit knows the bulk stiffness of elements",
         "a limit that knows the shear stiffness alone: inside out after 17 steps"),
    Case("a node that passes a sphere", "1000 m/s at a sphere of a micrometre", "stopped, the elements named", fast_node,
         says("elements: a node moved farther in one step than half the smallest radius"),
         "a node's path in a step is bounded", "it passes, and the elements are inside out some steps later", ends=5,
         more="test_paths.c"),
]
