"""Scenes in which contacts at the start require a smaller step: the automatic step has to take them into account."""
from hard.case import *  # noqa: F403


def box_walls(low, high, closing, stiffness=1e6, axes="xyz", **changes):
    """Walls of a box that close at a speed, each with the same law."""
    low, high = (list(x) if isinstance(x, (list, tuple)) else [x] * 3 for x in (low, high))
    made = []
    for a in map("xyz".index, axes):
        for side, at in ((1, low), (-1, high)):
            normal = [0, 0, 0]
            normal[a] = side
            made.append(wall(f"{'lh'[side < 0]}{'xyz'[a]}", at, normal, stiffness, motion={f"v{'xyz'[a]}": closing * side},
                             **changes))
    return made


RUB = {"kratio": 2, "friction": 0.3}
# Heights of 5 x 5 x 5 cells at 1.0001 diameters, from below the lowest to above the highest sphere.
LAYERS = {"cubic": 4, "fcc": 9 / math.sqrt(2), "hcp": 9 * math.sqrt(2 / 3)}


def closing(kind):
    """A lattice without contacts, between walls that close at 0.1 m/s."""
    def scene(folder):
        height = 2e-3 * 1.0001 * LAYERS[kind] + 2e-3 + 2e-7
        return spheres(lattice(kind, [5, 5, 5], spacing=1.0001), 5e-4, {"normal_stiffness": 1e5},
                       walls=box_walls([0, 0, -1e-7], [0, 0, height], 0.1, 1e5, "z", **RUB))
    return scene


def gas_in_a_closing_box(damped):
    def scene(folder):
        made = spheres(lattice("cubic", [5, 5, 5], spacing=1.15, jitter=0.02), 4.3e-3,
                       walls=box_walls(0.0, 0.0115, 0.2, **RUB))
        if damped:
            made["damping"] = {"background": {"model": "nonviscous_vector", "coefficient": 0.7}}
        return made
    return scene


# Height of the lower face: 8 layers of the block are 13.4 mm high, and the plate starts 6.6 mm above them.
PLATE = 20e-3


def plate_at_150(folder):
    """A rigid plate, five times as stiff as the bonds, hits a bonded block on a floor. The bonds break."""
    return spheres(lattice("hcp", [6, 5, 4]), 8e-5,
                   {"normal_stiffness": 1e6, "bond_tension_limit": 100, "bond_shear_limit": 100}, bonds={},
                   domain={"min": [-1] * 3, "max": [1] * 3}, walls=[wall("floor", [0, 0, 0], [0, 0, 1], 1e6, **RUB)],
                   bodies=[{"name": "plate", "box": {"size": [1, 1, 0.01]}, "origin": [-0.5, -0.5, PLATE], "stiffness": 5e6,
                            **RUB, "motion": {"vz": -150}}])


def plate_hits(one):
    """Every sphere stays below the plate, except for the compression of its spring."""
    rows, radius = one.history, 1e-3
    under = PLATE + rows["body_plate_displacement_z"][-1]
    top = one.field("particles/position")[:, 2].max() + radius - under
    assert top < radius, f"a sphere stands {top:.2g} m above the plate's face"
    counts = one.summary["counts"]
    return keeps_ledger(0.05)(one) + f", {counts['broken_tension'] + counts['broken_shear']} of {counts['bonds']} bonds broken"


def hinge(folder):
    """Three discs bonded at a right angle that changes: in a straight line they oscillate 1.22 times as fast. No
    shear."""
    rows = [[0, 0, 1e-3], [2e-3, 0, 1e-3], [2e-3, 2e-3, 1e-3]]
    scene = spheres(rows, 0.9, {"kratio": 10, **STRONG}, bonds={})
    speed = [[7.52e-3, -15.04e-3], [7.52e-3, 7.52e-3], [-15.04e-3, 7.52e-3]]
    scene["sets"] = [{**launched(f"s{k}", [k], v), "initial_spin": 11.28} for k, v in enumerate(speed)]
    return scene


def stays_calm(one):
    """The centrifugal force stores 2e-12 J in a bond."""
    rows = one.history
    most = (rows["energy_elastic_normal"] + rows["energy_elastic_shear"]).max()
    assert most < 1e-10, f"{most:.2g} J in the bonds"
    return f"at most {most:.0e} J in the bonds, {one.summary['steps']} steps"


def shaken(coefficient=0.0, fraction=None):
    """An unbreakable lattice, shaken."""
    def scene(folder):
        made = spheres(lattice("fcc", [3, 3, 3]), 2e-3, STRONG, bonds={}, initial={"random_velocity": 1e-4})
        if coefficient:
            made["damping"] = {"background": {"model": "nonviscous_component", "coefficient": coefficient}}
        if fraction:
            made["damping"] = {"contact": {"fraction": fraction}}
        return made
    return scene


def dies_down(one):
    energy = total(one)
    assert energy.max() < 1.001 * energy[0] and energy[-1] < 0.5 * energy[0], energy
    return f"energy falls to {energy[-1] / energy[0]:.1g}, residual {one.residual:.0e}"


def light_plate(folder):
    """A free plate, lighter than one of the spheres, on a bed of 49 under strong gravity."""
    k, g = 1e5, 1000.0
    rows = [[2.1e-3 * a, 2.1e-3 * b, 1e-3, 1e-3] for a in range(7) for b in range(7)]
    return spheres(rows, 0.004, {"normal_stiffness": k}, gravity=[0, 0, -g], walls=[wall("floor", [0, 0, 0], [0, 0, 1], k)],
                   damping={"contact": {"restitution": 0.5}}, domain={"min": [-1] * 3, "max": [1] * 3},
                   bodies=[{"name": "plate", "box": {"size": [0.02, 0.02, 1e-3]}, "origin": [-4e-3, -4e-3, 2e-3],
                            "stiffness": k, "free": True, "density": 10}])


def lies_on(one):
    """The plate comes to rest on the bed, loaded by its weight alone."""
    rows = one.history
    z, v = rows["body_plate_displacement_z"], rows["body_plate_velocity_z"]
    assert abs(v[-1]) < 1e-3 and -1e-4 < z[-1] < 0, (z[-1], v[-1])
    return keeps_ledger(0.02)(one) + f", the plate at {z[-1] * 1e6:.2g} micrometres"


def stiff_on_elements(folder):
    """Penalty 1000 times as stiff as an element of the soft block below: a sphere falls on its nodes."""
    return spheres([[0.0101, 0.0201 + 1e-3, 1e-3]], 2e-3, {"normal_stiffness": 1e9, "kratio": 0},
                   sets=[launched("ball", [0], [0, -1])],
                   elements={"rectangle": {"size": [0.02, 0.02], "cells": [8, 8]},
                             "materials": [{"young": 1e6, "poisson": 0.3, "density": 1000}],
                             "motions": [{"name": "foot", "group": "y_lower", "motion": {"vx": 0, "vy": 0}}],
                             "contact": {"stiffness": 1e9}})


def servo(rows, end, fastest, **changes):
    """A wall whose servo holds a force on spheres between it and a floor; its relaxation is 1."""
    def scene(folder):
        top = max(row[2] for row in rows) + 1e-3 + 1e-6
        return spheres(rows, end, {"normal_stiffness": 1e5, "kratio": 0, **STRONG},
                       walls=[wall("floor", [0, 0, 0], [0, 0, 1], 1e5),
                              wall("lid", [0, 0, top], [0, 0, -1], 1e5,
                                   servo={"force": 2.0, "max_velocity": fastest, "relaxation": 1.0})], **changes)
    return scene


def holds_force(one):
    rows = one.history
    late = np.abs(rows["wall_lid_force_z"][-20:])
    assert np.abs(late / 2.0 - 1).max() < 0.05, late
    most = np.abs(rows["wall_lid_force_z"]).max()
    assert most < 2 * 2.0, f"overshoots to {most:.3g} N"
    return f"{late.min():.4f} to {late.max():.4f} N of 2, at most {most:.3g} N"


BESIDE = [[0, 0, 1e-3, 1e-3], [2e-3, 0, 1e-3, 1e-3]]
CROWD = [[2.1e-3 * a, 2.1e-3 * b, 1e-3, 1e-3] for a in range(10) for b in range(10)]


def pressed_rows(folder):
    """Rows of 3 bonded particles touch from the start; a row of 12 is closed by two platens that move slowly."""
    return spheres([[2.0001e-3 * k, 0, 0, 1e-3] for k in range(12)], 6e-3, {"normal_stiffness": 1e5, "kratio": 0},
                   walls=[wall("left", [-1.0001e-3, 0, 0], [1, 0, 0], 1e5, motion={"vx": 0.01}),
                          wall("right", [23.0012e-3, 0, 0], [-1, 0, 0], 1e5, motion={"vx": -0.01})])


NEAR = "whatever is near enough to touch before the next lists counts in the step, whether it touches or not"
RESOLVED = "the step resolves the shortest collision of what is loose"
CASES = [
    *[Case(f"walls that close on a loose {kind} lattice", "nothing touches at the start, all of it at once soon after",
           "the ledger closes", closing(kind), keeps_ledger(0.01), NEAR + "; collisions are resolved", without,
           more="test_new_contacts.c") for kind, without in (
        ("cubic", "without both: none was found whose absence it shows (residual 1e-4)"),
        ("fcc", "without both: 87 % of the energy unexplained"),
        ("hcp", "without both: all of the energy unexplained"))],
    Case("a row that is pressed", "none of 12 touch, later all do", "the ledger closes", pressed_rows,
         keeps_ledger(0.01), "the step resolves the shortest collision of what is loose",
         "a stable step alone: ledger off by 0.74, stopped; that of what touches: flies off at 42 m/s"),
    Case("loose spheres in a closing box", "125 that nothing touches; six walls", "the ledger closes",
         gas_in_a_closing_box(False), keeps_ledger(0.01), RESOLVED,
         "without that and the limit of what is near: all of the energy unexplained, stopped",
         more="test_new_contacts.c"),
    Case("loose spheres in a closing box, damped", "non-viscous damping of 0.7 hides what goes wrong",
         "the ledger closes", gas_in_a_closing_box(True), keeps_ledger(0.01), RESOLVED,
         "without that and the limit of what is near: ledger off by 0.47, stopped"),
    Case("a plate that hits at 150 m/s", "a plate 5 times as stiff as the bonds",
         "bonds break, the ledger closes, nothing passes the plate", plate_at_150, plate_hits,
         "lists are made anew before a body can have come near unseen",
         "with the lists of the start: it goes through the block untouched"),
    Case("bonds that turn against each other", "a bent row that stretches out swings 1.22 times as fast",
         "nothing grows", hinge, stays_calm, "the limit is found anew for springs that have turned",
         "ledger off by 0.45, stopped", more="test_step_limit.c"),
    Case("non-viscous damping of 0.9", "it makes the fastest mode 1.9 times as stiff", "energy falls", shaken(0.9),
         dies_down, "the limit falls by sqrt(1 + a)", "spins of 4e5 rad/s after 14 steps, stopped",
         more="test_step_limit.c"),
    Case("critical contact damping in a lattice", "dashpots see velocities of half a step before", "energy falls",
         shaken(fraction=1.0), dies_down, "dashpots are in the stability limit", "flies apart after 14 steps, stopped"),
    Case("a light free plate on a heavy bed", "every sphere adds its spring to a plate of a tenth of its mass",
         "it comes to rest on them", light_plate, lies_on, "free bodies count in the step with all that is near them",
         "it keeps shaking at 2 mm/s; without the limit of what is near as well it flies off at 4.5 m/s",
         more="test_bodies.c"),
    Case("a stiff sphere on soft elements", "penalty of 1e9 N/m on nodes of 1e6 Pa", "it bounces, the ledger closes",
         stiff_on_elements, keeps_ledger(0.02),
         "the step resolves the shortest collision of what is loose, nodes included", "residual 0.098"),
    Case("a servo that takes up all at once", "relaxation 1 on two bonded spheres, whose step is near the limit",
         "the force is reached and held",
         servo(BESIDE, 0.01, 0.05, bonds={}, damping={"background": {"model": "viscous", "coefficient": 3e3}}),
         holds_force, "relaxation is cut to what the step bears", "1.79 and 2.19 N in turns, for ever",
         more="test_servo.c"),
    Case("a servo that meets a crowd", "100 spheres in one step: K is 100 times what it was",
         "the force is reached without overshoot", servo(CROWD, 4e-3, 10.0, damping={"contact": {"restitution": 0.5}}),
         holds_force, "what the wall will reach within the step counts", "overshoots to 27 N of 2", more="test_servo.c"),
]
