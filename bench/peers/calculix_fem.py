"""A block of linear triangles or tetrahedra that falls freely, by the explicit dynamics of CalculiX: the meshes of
gneiss' own benches (side 1 m, gravity), the same number of elements and nodes.

    /usr/bin/python3 bench/peers/calculix_fem.py

Settings come from the environment, as for the other peers:
  KIND     CPE3 or C3D4          CELLS  per side       THREADS  (1)
  STEPS    timed steps (10)      RESULT file for the JSON result

Set-up is left out: the time is the difference of a run of three steps and one of 3 + STEPS. Steps are of the length
that CalculiX chooses (Courant's, a part of what is stable); it scales no masses here. The fall of the block shows that all of them were done.
"""
import json
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "validate"))
from fem_grid import Grid
from peers.calculix import Deck

GRAVITY = 9.81


def fall(grid, time, threads):
    deck = Deck(f"falling block of {grid.kind}")
    deck.nodes(grid.points)
    deck.elements(grid.kind, grid.element)
    deck.material(20e9, 0.2, 2650.0)
    deck.explicit(time, [0.0, -GRAVITY, 0.0])
    result = deck.run(threads)
    fallen = -np.array([u[1] for n, u in result.displacement.items() if n < len(grid.points)])
    # The program's increments end at `time` up to the rounding of its printed values.
    if np.max(np.abs(fallen / (0.5 * GRAVITY * time**2) - 1.0)) > 1e-3:
        sys.exit(f"expected a fall by {0.5 * GRAVITY * time**2} m, found {fallen.min()} to {fallen.max()} m")
    return result


def main():
    kind, cells, steps = os.environ["KIND"], int(os.environ["CELLS"]), int(os.environ.get("STEPS", "10"))
    threads = int(os.environ.get("THREADS", "1"))
    grid = Grid(kind, (cells,) * (2 if kind == "CPE3" else 3), lambda unit: unit)
    dt = fall(grid, 1e-9, threads).increment
    few, many = (fall(grid, n * dt, threads) for n in (3, 3 + steps))
    with open(os.environ["RESULT"], "w", encoding="utf-8") as file:
        json.dump({"elements": len(grid.element), "steps": steps, "seconds": many.seconds - few.seconds, "dt": dt,
                   "threads": threads, "setup": few.seconds}, file)


if __name__ == "__main__":
    main()
