"""An effect that `gneiss plan` reports as unnecessary changes nothing when it is off: the same positions, bit for bit."""
import os
import re
import sys

import numpy as np

from program import expect, fact, gneiss, main, results, run, write_scene

SCENE = """dimension: 3
specimen: {lattice: {kind: fcc, radius: 1e-3, cells: [3, 3, 3], spacing: 0.999}, material: m}
materials: [{name: m, density: 2500, normal_stiffness: 1e6MATERIAL}]
law: {stiffness: uniform, rotation: ROTATION}
initial: {random_velocity: 0.1}
DAMPINGSETStime: {end: 1 ms, MORE}
output: {snapshots: 0, OUTPUT}
run: {threads: 1}
"""
PLAIN = {"MATERIAL": ", kratio: 2", "ROTATION": "on", "DAMPING": "", "SETS": "", "MORE": "step: 1e-6", "OUTPUT": "energy: off"}
FRICTION = ", kratio: 2, friction: 0.5"
UNUSED = ", kratio: 2}, {name: u, density: 1, normal_stiffness: 1e6, kratio: 2, friction: 0.5"
HELD = "sets: [{name: s, select: {all: true}, motion: {wx: 0, wy: 0, wz: 0}}]\n"
# Name, keys with the effect, keys without it.
CASES = (("rotation", {}, {"ROTATION": "off"}),
         ("friction", {"MATERIAL": UNUSED}, {}),
         ("contact_damping", {"DAMPING": "damping: {contact: {restitution: 1}}\n"}, {}),
         ("viscous", {"DAMPING": "damping: {background: {model: viscous, coefficient: 0}}\n"}, {}),
         ("nonviscous_vector", {"DAMPING": "damping: {background: {model: nonviscous_vector, coefficient: 0}}\n"}, {}),
         ("nonviscous_component", {"DAMPING": "damping: {background: {model: nonviscous_component, coefficient: 0}}\n"}, {}),
         ("applied", {"SETS": "sets: [{name: s, select: {all: true}, force: [0, 0, 0]}]\n"}, {}),
         ("mass_scaling", {"MORE": "mass_scaling: {factor: 1}"}, {"MORE": "step: auto"}),
         ("energy", {"OUTPUT": "energy: on"}, {}),
         ("orientation", {"OUTPUT": "energy: off, orientation: on"}, {}))
# Scenes in which an effect changes something.
NEEDED = (("rotation", {"MATERIAL": FRICTION}), ("friction", {"MATERIAL": FRICTION}),
          ("rotation", {"SETS": "sets: [{name: s, select: {all: true}, initial_spin: [0, 0, 1]}]\n"}),
          ("contact_damping", {"DAMPING": "damping: {contact: {restitution: 0.9}}\n"}),
          ("viscous", {"DAMPING": "damping: {background: {model: viscous, coefficient: 1}}\n"}),
          ("applied", {"SETS": "sets: [{name: s, select: {all: true}, force: [0, 0, 1e-9]}]\n"}),
          ("mass_scaling", {"MORE": "mass_scaling: {factor: 1.1}"}))


def scene(folder, changes):
    text = SCENE
    for word, value in {**PLAIN, **changes}.items():
        text = text.replace(word, value)
    return write_scene(folder, text)


def could_go(folder, changes):
    out = expect(gneiss("plan", scene(folder, changes)), 0).stdout
    section = re.search(r"^could be switched off\n((?:  .*\n)+)", out, re.M)
    return {line.split()[0] for line in section.group(1).splitlines()} if section else set()


def positions(folder, name, changes):
    out = os.path.join(folder, name)
    run(scene(folder, changes), out)
    with results(out) as file:
        return file["particles/position"][:].tobytes(), file["particles/velocity"][:].tobytes()


@fact
def effects_reported_as_unnecessary_change_no_bit(folder):
    for k, (name, carried, without) in enumerate(CASES):
        assert name in could_go(folder, carried), (name, carried)
        assert name not in could_go(folder, without), (name, without)
        assert positions(folder, f"with{k}", carried) == positions(folder, f"without{k}", without), name


@fact
def held_spins_could_be_switched_off_to_rounding(folder):
    carried, without = {"MATERIAL": FRICTION, "SETS": HELD}, {"MATERIAL": FRICTION, "ROTATION": "off"}
    assert "rotation" in could_go(folder, carried)
    at, there = (np.frombuffer(positions(folder, name, c)[0]) for name, c in (("with", carried), ("without", without)))
    # A thousand steps, each rounded to an ulp of a centimetre.
    assert 0 <= abs(at - there).max() < 1000 * 2e-18


@fact
def needed_effects_are_not_reported_as_unnecessary(folder):
    for name, carried in NEEDED:
        assert name not in could_go(folder, carried), (name, carried)


if __name__ == "__main__":
    sys.exit(main())
