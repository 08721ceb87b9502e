"""Contacts that begin, end and degenerate: collisions, crowds, centres that coincide."""
from hard.case import *  # noqa: F403


def coincident(folder):
    return spheres([[0, 0, 0, 1e-3], [0, 0, 3e-3, 1e-3], [0, 0, 6e-3, 1e-3], [0, 0, 3e-3, 2e-3]], 1e-3)


def coincident_bonded(folder):
    rows = [[1e-3 * k, 0, 0, 0.6e-3] for k in range(9)] + [[4e-3, 0, 0, 0.6e-3]]
    return spheres(rows, 1e-3, STRONG, bonds={})


def nearly_coincident(folder):
    """Centres 1e-9 radii apart: only the rounding of one of them determines the direction."""
    return spheres([[0, 0, 0, 1e-3], [0, 0, 1e-12, 1e-3]], 3e-5, {"kratio": 0})


def flies_apart(one):
    """The energy 1/2 k (2 r)^2 becomes kinetic energy of two spheres, along the line of their centres; with steps of
    y/w, ten per half wave, the scheme gives 1 - y^2/4 of it."""
    v, y = one.field("particles/velocity"), math.pi / 10
    wanted = 2e-3 * math.sqrt(1e6 / (2 * sphere_mass(1e-3)) * (1 - y * y / 4))
    assert np.abs(v[:, :2]).max() == 0 and abs(v[0, 2] + v[1, 2]) < 1e-9, v
    return close(v[1, 2], wanted, 1e-3, "m/s of each") + f", residual {one.residual:.0e}"


def bonded_nearly_coincident(folder):
    return spheres([[0, 0, 0, 1e-3], [0, 0, 5e-6, 1e-3]], 1e-4, STRONG, bonds={})


def through_each_other(folder):
    """The sphere is half as fast again as the springs could stop, and hits a hundredth of a radius off centre; with dashpots."""
    speed = 1.5 * 2e-3 * math.sqrt(1e6 / (2 * sphere_mass(1e-3)))
    return spheres([[0, 0, 0, 1e-3], [1e-5, 0, 2.1e-3, 1e-3]], 2e-5, {"kratio": 0}, damping={"contact": {"restitution": 0.9}},
                   sets=[launched("a", [0], [0, 0, speed]), launched("b", [1], [0, 0, -speed])])


def comes_out_behind(one):
    """Within a step the normal reverses at the largest force: half of the work of that step may be missing, up to a
    tenth of the energy; a larger error would stop the run."""
    x = one.field("particles/position")
    assert x[0, 2] > x[1, 2] + 1e-3, x
    assert one.residual < 0.1, one.residual
    return f"residual {one.residual:.1e}, {one.summary['steps']} steps"


def at_rest_by_rounding(folder):
    """Some neighbours of a hexagonal lattice overlap by an ulp."""
    scene = spheres({"lattice": {"kind": "hexagonal", "radius": 1e-4, "cells": [20, 20]}}, 1e-3, dimension=2)
    scene["damping"] = {"background": {"model": "nonviscous_vector", "coefficient": 0.5}}
    return scene


def rests(one):
    rows = one.history
    assert one.summary["warnings"] == [] and rows["energy_kinetic"].max() == 0, rows["energy_kinetic"].max()
    return "not a bit moves"


def rest_under_damping(form):
    def scene(folder):
        return spheres([[0, 0, 3e-3 * k, 1e-3] for k in range(3)], 1e-3,
                       damping={"background": {"model": "nonviscous_" + form, "coefficient": 0.7}})
    return scene


def does_not_stir(one):
    assert not one.field("particles/velocity").any() and not one.field("particles/displacement").any()
    return "not a bit moves"


def bouncing(folder):
    """The sphere falls by a radius and rebounds, 4 times; one contact every 150 steps."""
    scene = spheres([[0, 0, 2e-3, 1e-3]], 0.1, gravity=[0, 0, -10], walls=[wall("floor", [0, 0, 0], [0, 0, 1], 1e5)])
    scene["output"]["history_rows"] = 2000
    return scene


def comes_back(one):
    """At the sphere's highest point every term of the ledger is nearly zero; a contact takes ten steps."""
    rows = one.history
    tops = int(np.sum(np.diff(np.sign(rows["energy_work_gravity"] - 5e-8)) > 0))
    worst = np.abs(rows["energy_residual"]).max()
    assert tops > 2 and worst < 0.01, (tops, worst)
    return f"{tops} bounces, residual at most {worst:.1e}"


def dropped(restitution):
    """The spheres touch the floor at different phases of a step."""
    def scene(folder):
        rows = [[5e-3 * k, 0, 1e-3 + 1e-5 * (1 + 0.618 * k % 1), 1e-3] for k in range(40)]
        return spheres(rows, 1e-4, {"kratio": 0}, sets=[launched("all", None, [0, 0, -1])],
                       damping={"contact": {"restitution": restitution}},
                       walls=[wall("floor", [0, 0, 0], [0, 0, 1], 1e6)])
    return scene


def restitution_is(wanted):
    def check(one):
        v = one.field("particles/velocity")[:, 2]
        off = np.abs(v - wanted).max()
        assert off <= 0.01 * max(wanted, 0.5) + 1e-9, f"{v.min():.5g} to {v.max():.5g}, expected {wanted}"
        return f"rebound with {v.min():.4f} to {v.max():.4f} of the speed"
    return check


def gas(folder):
    """A periodic box contains 216 spheres; each collides some fifty times."""
    return spheres(lattice("cubic", [6, 6, 6], spacing=1.1, jitter=0.05), 5e-3,
                   {"normal_stiffness": 1e5}, periodic={"min": [0] * 3, "max": [13.2e-3] * 3},
                   initial={"random_velocity": 5}, damping={"contact": {"restitution": 1.0}})


def crowd(folder):
    """The gaps are 1e-4 diameters: after the first motion all twelve neighbours are in contact."""
    edge = 3 * 2e-3 * 1.0001 * math.sqrt(2)
    return spheres(lattice("fcc", [3, 3, 3], spacing=1.0001), 6e-3,
                   {"normal_stiffness": 1e5, "kratio": 1, "friction": 0}, periodic={"min": [0] * 3, "max": [edge] * 3},
                   initial={"random_velocity": 0.05})


def torn(folder):
    """Bonded pairs that are torn apart, in a closed box in which their halves bounce: bonds alone would allow steps of half
    a contact."""
    pairs = [[4.2e-3 * a, 2.2e-3 * b, 2.2e-3 * c] for a in range(2) for b in range(4) for c in range(4)]
    rows = [[x + 2e-3 * k, y, z, 1e-3] for x, y, z in pairs for k in range(2)]
    low, high = [-1.2e-3] * 3, [7.6e-3] * 3
    walls = [wall("xyz"[a] + str(k), side, [s if a == b else 0 for b in range(3)], 1e5)
             for a in range(3) for k, (side, s) in enumerate(((low, 1), (high, -1)))]
    return spheres(rows, 5e-3, {"normal_stiffness": 1e5, "kratio": 0, "bond_tension_limit": 1e-6, "bond_shear_limit": 1e-6},
                   bonds={}, walls=walls,
                   sets=[launched("left", list(range(0, 64, 2)), [-1, 0.3, 0.2]),
                         launched("right", list(range(1, 64, 2)), [1, 0.1, -0.4])])


def in_pieces(one):
    counts = one.summary["counts"]
    broken = counts["broken_tension"] + counts["broken_shear"]
    assert broken > 0.95 * counts["bonds"], counts
    return keeps_ledger(0.02)(one) + f", {broken} of {counts['bonds']} bonds broken"


def heavy_and_light(folder):
    """Two heavy spheres in contact set the step; a light one flies towards them. Masses 1 to 1000."""
    return spheres([[0, 0, 0, 1e-2], [0.01999, 0, 0, 1e-2], [0, 0.015, 0, 1e-3]], 0.012,
                   {"normal_stiffness": 1e5, "kratio": 0}, sets=[launched("light", [2], [0, -1, 0])],
                   domain={"min": [-1] * 3, "max": [1] * 3})


def light_one_rebounds(one):
    """The light sphere rebounds from the heavy one, whose neighbour does not restrain it perpendicular to its line."""
    wanted = collision_speed(1.0, 1000.0)
    v = one.field("particles/velocity")[2, 1]
    assert abs(v - wanted) < 0.01, v
    return f"{v:.4f} m/s ({wanted:.4f})"


def collision_speed(speed, ratio):
    return speed * (ratio - 1) / (ratio + 1)


def bullet(speed):
    """A row of spheres is hit by one that passes a diameter in a few steps or less."""
    def scene(folder):
        rows = [[2e-3 * k, 0, 0, 1e-3] for k in range(5)] + [[-0.01, 0, 0, 1e-3]]
        return spheres(rows, 1e-4, {"kratio": 0}, sets=[launched("bullet", [5], [speed, 0, 0])],
                       domain={"min": [-1] * 3, "max": [1] * 3})
    return scene


def hits(one):
    """Momentum is conserved to rounding; the row is hit, and no sphere has passed another one."""
    v, x = one.field("particles/velocity")[:, 0], one.field("particles/position")[:, 0]
    assert abs(v.sum() / BULLET - 1) < 1e-9 and v[:5].max() > 0.5 * BULLET, v
    assert x[5] < x[0] and np.all(np.diff(x[:5]) > 0), x
    return keeps_ledger(0.02)(one)


BULLET = 150.0
RESOLVED = "the step resolves the shortest collision of what is loose"
CASES = [
    Case("coincident centres", "no direction of contact", "refused, both particles named", coincident,
         refuses("particles 1 and 3 at the same place"), "centres are held against each other when lists are made",
         "runs, and the two lie in each other for ever", ends=2),
    Case("coincident centres of bonded spheres", "a bond without a direction", "refused, both named", coincident_bonded,
         refuses("particles 4 and 9 at the same place"), "centres are held against each other when lists are made",
         "runs, with a bond that has no direction", ends=2),
    Case("nearly coincident centres", "1e-9 radii apart, unbonded",
         "they fly apart along their line with the energy of the overlap", nearly_coincident, flies_apart,
         "the step resolves the shortest collision of what is loose",
         "a stable step alone: moved 1.6 radii in the first step, stopped"),
    Case("nearly coincident centres that would be bonded",
         "0.005 radii apart: the line of centres turns by any angle in a step", "refused, both named",
         bonded_nearly_coincident, refuses("particles 0 and 1 .* apart"), "bonded centres stand apart by 0.01 radii",
         "runs, as if it were a bond", ends=2),
    Case("spheres that pass through each other", "half as fast again as their springs can stop",
         "they come out behind, the ledger closes to a tenth", through_each_other, comes_out_behind,
         "the step resolves the shortest collision of what is loose",
         "a stable step alone: moved 2.6 radii in the first step, stopped"),
    Case("a lattice that touches by rounding", "overlaps of an ulp, non-viscous damping", "it rests",
         at_rest_by_rounding, rests, "overlaps within the rounding of coordinates are none", "it stirs, with 3e-28 J"),
    *[Case(f"rest under non-viscous damping, {form} form", "the direction of a velocity of zero", "nothing moves",
           rest_under_damping(form), does_not_stir, "", "no guard to take out: zero has no sign")
      for form in ("vector", "component")],
    Case("a ball that comes back to where it fell from", "there every term of the ledger is nearly zero",
         "the residual stays below 1 %", bouncing, comes_back,
         "contacts that close or open within a step act for their part of it", "residual 0.02 instead of 1e-5"),
    Case("restitution 0.5 in ten steps", "40 spheres, each in another phase of a step", "the speed asked for to 1 %",
         dropped(0.5), restitution_is(0.5), "dashpots are those of an oscillator in steps",
         "dashpot of small steps: 0.487 to 0.492; contacts of whole steps: 0.486 to 0.566", more="test_rebound.c"),
    Case("restitution 0", "critical damping", "they come to rest to 0.01 of their speed", dropped(0.0),
         restitution_is(0.0), RESOLVED, "a stable step alone: up to 0.11 of the speed", more="test_rebound.c"),
    Case("a gas for 1e4 collisions", "216 spheres, restitution 1: errors add up", "the residual stays below 1 %", gas,
         keeps_ledger(0.01), "the step resolves the shortest collision of what is loose",
         "without that and the limit of what is near: residual 0.022", more="test_new_contacts.c"),
    Case("a crowd that rattles", "all contacts of a dense lattice open and close", "the residual stays below 2 %", crowd,
         keeps_ledger(0.02), "crowds that no dashpot calms get more steps", "residual 0.043", more="test_new_contacts.c"),
    Case("pairs that are torn apart", "what was bonded collides", "the residual stays below 2 %", torn, in_pieces,
         "what has come apart is resolved as loose particles are", "ledger off by 0.22, stopped",
         more="test_new_contacts.c"),
    Case("a light sphere that meets heavy ones", "the step was set by two that press, 1000 times as heavy",
         "it comes back with its speed", heavy_and_light, light_one_rebounds,
         "the step resolves the shortest collision of what is loose, looked at before it touches", "a stable step "
         "alone: ledger off by 0.16, stopped; without the limit of what is near as well: thrown back at 292 m/s"),
    Case("a bullet", "150 m/s at a row of spheres", "the row is hit, momentum and energy stay", bullet(BULLET), hits,
         "lists are made anew before anything can have come near unseen",
         "with the lists of the start: it goes through the row"),
    Case("a bullet of 1e5 m/s", "farther in a step than it is large", "stopped, the particle named", bullet(1e5),
         says("particle 5 moved farther in one step than half the smallest radius"),
         "a particle's path in a step is bounded", "it flies through the row and out of the domain", ends=5),
]
