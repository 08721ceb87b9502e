#!/usr/bin/python3
"""A magnet that passes over a heap of iron grains and lifts them: a field of force in Python, with its ledger.

    python3 examples/magnet.py [PICTURE.gif]

Grains are drawn to the magnet with F = m C/(r^2 + a^2)^2, as small magnetisable bodies are far from a pole. The work of the field is a
term of the energy ledger, which closes.
"""
import sys

import gneiss

GRAINS = {
    "dimension": 2,
    "specimen": {"lattice": {"kind": "hexagonal", "radius": "1 mm", "cells": [14, 3], "jitter": 0.05}},
    "materials": [{"name": "iron", "density": "7800 kg/m3", "normal_stiffness": "0.1 MN/m", "kratio": 3, "friction": 0.4}],
    "law": {"stiffness": "uniform"},
    "damping": {"contact": {"restitution": 0.3}},
    "gravity": [0, -9.81],
    "walls": [{"name": "table", "point": [0, 0], "normal": [0, 1], "stiffness": "0.1 MN/m", "kratio": 3, "friction": 0.4}],
    "domain": {"min": [-1, -1], "max": [1, 1]},
    "time": {"end": "0.1 s"},
    "run": {"threads": 1},
}


def main():
    with gneiss.World(GRAINS) as world:
        mass = world.particles.mass.max()

        @world.force
        def magnet(p):
            to = [-0.01 + 0.5 * p.time, 0.025, 0.0] - p.position
            r2 = (to ** 2).sum(1, keepdims=True) + 0.005 ** 2
            return mass * 1.5e-4 * to / r2 ** 2

        def highest(own):
            print(f"t = {own.time:.3f} s: highest grain at {1e3 * own.particles.position[:, 1].max():.1f} mm")

        world.at([0.02, 0.04, 0.06, 0.08, 0.1], highest)
        if len(sys.argv) > 1:
            world.animate(40).save(sys.argv[1])
        world.run()
        print(f"work of the magnet {world.energy['work_user']:.3g} J, of gravity {world.energy['work_gravity']:.3g} J, "
              f"friction {world.energy['friction']:.3g} J, residual {world.energy['residual']:.1e}")


if __name__ == "__main__":
    main()
