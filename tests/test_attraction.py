"""Attractive grains, in the program: resumed, stages, resolved scenes, refusals. Speaks TAP."""
import os

import numpy as np

from program import expect, fact, gneiss, history, main, resume, results, run, state_hash, text, write_scene

LAWS = {"jkr": {"cohesion": "jkr"}, "dmt": {"cohesion": "dmt"},
        "liquid": {"cohesion": "liquid", "surface_tension": 0.073, "liquid_content": 0.02}}


def heap(law, **more):
    """A few soft grains that fall onto a floor."""
    grain = {"name": "grain", "density": 2500, "young": 2e6, "poisson": 0.25, "friction": 0.5, "restitution": 0.5}
    if law != "liquid":
        grain["adhesion"] = 0.02
    return {"specimen": {"lattice": {"kind": "cubic", "radius": 1e-3, "cells": [2, 2, 2], "origin": [0, 0, 1e-5]},
                         "material": "grain", "group": 0},
            "materials": [grain], "law": {"stiffness": "hertz", **LAWS[law]}, "gravity": [0, 0, -9.81],
            "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.5}],
            "time": {"end": 4e-3, "step": 1e-5}, "output": {"snapshots": 2}, "run": {"threads": 1}, **more}


@fact
def the_resolved_scene_of_every_law_runs_and_resumes(folder):
    for law in LAWS:
        here = os.path.join(folder, law)
        os.mkdir(here)
        whole, first = os.path.join(here, "whole"), os.path.join(here, "first")
        scene = write_scene(here, heap(law))
        run(scene, whole)
        run(scene, first, "--set", "time.end=2 ms")
        with results(whole) as file:
            again = os.path.join(here, "again.yaml")
            with open(again, "w") as out:
                out.write(text(file["scene"][()]))
        run(again, os.path.join(here, "again"))
        assert state_hash(os.path.join(here, "again")) == state_hash(whole), law
        resume(first, "--set", "time.end=4 ms")
        assert history(first)["time"][-1] >= 3.99e-3, law
        staged = os.path.join(here, "staged")
        run(again, staged, "--set", "stages=[{name: a, end: {time: 2 ms}}, {name: b}]")
        assert state_hash(staged) == state_hash(whole), law


@fact
def wet_grains_may_not_be_removed_and_joints_do_not_attract(folder):
    scene = write_scene(folder, heap("liquid"))
    expect(gneiss("check", scene, "--set", "domain.lost=remove"), 2, r"law\.cohesion: expected none .*are removed")
    scene = write_scene(folder, heap("jkr", joints=[{"name": "j", "point": [0, 0, 0], "normal": [0, 1, 0],
                                                     "normal_stiffness": 1e9, "shear_stiffness": 1e9}]))
    expect(gneiss("check", scene), 2, r"law\.cohesion: expected none beside it, found joints")


if __name__ == "__main__":
    main()
