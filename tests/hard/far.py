"""Positions far from the origin, slow and fast motion, many steps at rest: effects of rounding."""
from hard.case import *  # noqa: F403

# Dyadic, so that the scene has the same digits at every position.
R, WIDTH = 2.0**-9, 2.0**-6


def at(place, point):
    return [p + x for p, x in zip(place, point)]


def loaded_block(place):
    """A bonded block on a floor, hit by a falling wall; some bonds break."""
    return spheres({"lattice": {"kind": "fcc", "radius": R, "cells": [3, 3, 4], "origin": at(place, (-WIDTH / 2, -WIDTH / 2, 0))}},
                   1e-3, {"bond_tension_limit": 5, "bond_shear_limit": 5}, bonds={}, gravity=[0, 0, -10],
                   sets=[{"name": "hit", "select": {"box": {"min": at(place, (-1, -1, WIDTH)), "max": at(place, (1, 1, 1))}},
                          "initial_velocity": [0.01, 0, 0]}],
                   walls=[wall("floor", at(place, (0, 0, 0)), [0, 0, 1]),
                          wall("lid", at(place, (0, 0, 0.0234375)), [0, 0, -1], kratio=2, friction=0.4, motion={"vz": -0.05})])


def moved(make, place):
    return lambda folder: make(place)


def as_near(make, dimension=3):
    """Checks that the bits are the same, apart from the shift of positions."""
    def check(one):
        near = one.again(make([0.0] * dimension), "near")
        assert near.code == 0, near.message
        kind = "particles" if one.summary["counts"].get("particles") else "nodes"
        for name in ("displacement", "velocity"):
            a, b = one.field(f"{kind}/{name}"), near.field(f"{kind}/{name}")
            assert a.any() and a.tobytes() == b.tobytes(), f"{name} differs by {np.abs(a - b).max():.2g}"
        assert one.residual == near.residual and one.residual < 0.01
        return f"the same bits as at 0, {one.summary['steps']} steps"
    return check


def elements_at(place):
    low, high = at(place, (0, 0)), at(place, (0.125, 0.125))
    return {"dimension": 2, **copy.deepcopy(QUIET), "time": {"end": 1e-3},
            "elements": {"rectangle": {"size": [0.125, 0.125], "cells": [6, 6], "origin": low},
                         "materials": [{"young": 30e9, "poisson": 0.2, "density": 2400}],
                         "motions": [{"name": "lo", "box": {"min": low, "max": [high[0], low[1]]}, "motion": {"vy": 0}},
                                     {"name": "hi", "box": {"min": [low[0], high[1]], "max": high}, "motion": {"vy": -1e-3}}]},
            "damping": {"background": {"model": "viscous", "coefficient": 1e5}},
            "test": {"kind": "compression", "axis": "y", "lower": "lo", "upper": "hi"}}


def periodic_gas(place):
    low, high = at(place, [-6 * R] * 3), at(place, [6 * R] * 3)
    return spheres({"lattice": {"kind": "cubic", "radius": R, "cells": [4, 4, 4], "spacing": 1.5, "origin": low}}, 4e-3,
                   periodic={"min": low, "max": high}, initial={"random_velocity": 1})


def one_ball(place, speed, **changes):
    return spheres([[*place, 1e-3]], 1e-3, sets=[launched("ball", [0], [speed, 0, 0])], **changes)


def flies_as_far_as_it_should(one):
    """Coordinates 5000 km away are spaced by 1e-9 m, and it moves by 1e-6 m."""
    path = one.field("particles/displacement")[0, 0]
    return close(path, 1e-3 * one.summary["time"], 1e-9, "m of path")


# --- quiet steps ---------------------------------------------------------------------------------------------

def quiet(folder):
    """A bonded block hangs at rest with its bonds loaded by its weight: in single precision it stays at rest."""
    scene = spheres(lattice("cubic", [3, 3, 4]), 0.05, STRONG, bonds={}, gravity=[0, 0, -10],
                    sets=[{"name": "top", "select": {"end": {"axis": "z", "side": "upper", "depth": 1.5e-3}},
                           "motion": {"vx": 0, "vy": 0, "vz": 0}}],
                    damping={"background": {"model": "viscous", "coefficient": 2e3}})
    scene["run"]["precision"] = "mixed"
    return scene


def hangs(one):
    """Each of 3 layers hangs on its bond: m g/k, 2 m g/k, 3 m g/k of stretch. Forces have errors of at most 1e-7 of the largest."""
    sink = sphere_mass(1e-3) * 10 / 1e6
    wanted = -sink * np.array([6, 5, 3, 0])
    layer = np.rint((one.field("particles/position")[:, 2] - 1e-3) / 2e-3).astype(int)
    off = np.abs(one.field("particles/displacement")[:, 2] - wanted[layer]).max() / (6 * sink)
    speed = np.abs(one.field("particles/velocity")).max()
    assert off < 1e-3 and speed < 1e-9, (off, speed)
    return f"stretches within {off:.0e} of {6 * sink:.1e} m, fastest {speed:.0e} m/s, {one.summary['steps']} steps"


def stiff_in_single(folder):
    """A block far from its origin is stretched by 1e-7 of its length: single precision resolves 6e-8 of a length."""
    scene = spheres(lattice("cubic", [2, 2, 6], origin=[0.5, 0.5, 0.5]), 4e-3, {"normal_stiffness": 1e7, **STRONG}, bonds={},
                    sets=[{"name": side, "select": {"end": {"axis": "z", "side": side, "depth": 1.5e-3}},
                           "motion": {"vx": 0, "vy": 0, "vz": [[0, 0], [1e-3, v], [2e-3, 0]]}}
                          for side, v in (("lower", 0.0), ("upper", 1.2e-6))],
                    damping={"background": {"model": "viscous", "coefficient": 3e3}})
    scene["run"]["precision"] = "mixed"
    return scene


def pulls_as_springs(one):
    """Five springs in a row, four rows, pulled by 1.2e-9 m: 4 k u/5."""
    found = one.history["set_upper_reaction_z"][-1]
    return close(abs(found), 4 * 1e7 * 1.2e-9 / 5, 1e-3, "N") + ", in single precision"


# --- slow and fast -------------------------------------------------------------------------------------------

def loaded_at(speed, strain, **changes):
    """A bonded block between platens that close."""
    def scene(folder):
        made = spheres(lattice("cubic", [3, 3, 5]), strain * 0.01 / speed, {"normal_stiffness": 1e6, **STRONG}, bonds={},
                       walls=[wall("lower", [0, 0, 0], [0, 0, 1], 1e6),
                              wall("upper", [0, 0, 0.01], [0, 0, -1], 1e6, motion={"vz": -speed})], **changes)
        return made
    return scene


def six_springs(one):
    """Four bonds and two walls in a row of springs, nine rows; the platens have moved by v t."""
    rows = one.history
    moved_by = -rows["wall_upper_displacement_z"][-1]
    found = np.mean([abs(rows["wall_upper_force_z"][-1]), abs(rows["wall_lower_force_z"][-1])])
    words = close(found, 9 * 1e6 * moved_by / 6, 0.02, "N")
    return f"{moved_by:.1e} m in {one.summary['steps']} steps, " + words


def too_slow(folder):
    return spheres([[0.1, 0, 0, 1e-3]], 1e-3, sets=[{"name": "slow", "select": {"all": True}, "motion": {"vx": 1e-12}}])


CASES = [
    Case("a bonded block 1e6 m away", "doubles are 1e-10 m apart there", "the same bits as at 0",
         moved(loaded_block, [2.0**20, -2.0**21, 2.0**20]), as_near(loaded_block),
         "positions are relative to an origin near the model", "displacements off by 3e-9 m", more="test_origin.py"),
    Case("finite elements 1e8 m away", "doubles are 1.5e-8 m apart there, motions 1e-6 m", "the same bits as at 0",
         moved(elements_at, [2.0**27, 0]), as_near(elements_at, 2), "positions are relative to an origin near the model",
         "displacements off by 4e-8 m of 1e-6", more="test_origin.py"),
    Case("a periodic box 1e6 m away", "particles leave it on one side and come back on the other",
         "the same bits as at 0", moved(periodic_gas, [2.0**20, 2.0**20, -2.0**20]), as_near(periodic_gas),
         "positions are relative to an origin near the model", "displacements off by 1e-6 m"),
    Case("slow flight at 5000 km", "1 mm/s: 2e-9 m a step, doubles 1e-9 m apart", "it flies as far as it should",
         lambda folder: one_ball([5e6, -3e6, 1e6], 1e-3), flies_as_far_as_it_should,
         "positions are relative to an origin near the model", "0.90 of its path"),
    Case("an origin that loses the model", "given at 0, the model at 5000 km", "refused, with the place and the numbers",
         lambda folder: one_ball([5e6, 0, 0], 1e-3, origin=[0, 0, 0]),
         refuses(r"expected places .* 1e-08 of the smallest radius"), "places are held against the smallest radius",
         "stops in the first step: too coarse for the smallest radius", ends=2),
    Case("motion below the rounding of places", "1e-12 m/s at 0.1 m", "refused, with the place and the numbers",
         too_slow, refuses(r"set 'slow': expected a velocity .* its motion would be lost"),
         "velocities are held against the rounding of places", "runs, and nothing moves", ends=2),
    Case("a sphere that flies out of reach", "beyond 65 km doubles are too coarse for 1 mm", "stopped, the place named",
         lambda folder: one_ball([65535.95, 0, 0], 100, origin=[0, 0, 0], domain={"min": [-1e9] * 3, "max": [1e9] * 3}),
         says("particle 0 left the domain", "places are too coarse"), "the domain ends where doubles are too coarse",
         "flies on", ends=5),
    Case("quiet steps in mixed precision", "a block that hangs at rest on its bonds",
         "it stays; 1e7 steps in `./do validate --only hard`", quiet, hangs,
         "in single precision a stretch comes from the travel since the lists were made",
         "difference of two lengths: ledger off by more than 1 after 500 steps, stopped", long=397),
    Case("small strain in single precision", "1e-7 of the length, 0.9 m from the origin",
         "the force of the springs to 0.1 %", stiff_in_single, pulls_as_springs,
         "in single precision a stretch comes from the travel since the lists were made",
         "difference of two lengths: ledger off by more than 1, stopped"),
    Case("very slow loading", "platens at 1e-6 m/s: 3e-12 m a step", "the force of the springs to 2 %",
         loaded_at(1e-6, 5e-7, damping={"background": {"model": "viscous", "coefficient": 5e3}}), six_springs, "",
         "no guard to take out"),
    Case("very fast loading", "platens at 100 m/s, near the speed of sound of the lattice", "the ledger closes",
         loaded_at(100.0, 0.4), keeps_ledger(0.01), "", "none was found whose absence it shows"),
]
