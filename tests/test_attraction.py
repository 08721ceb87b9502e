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
def grains_that_fall_into_their_attraction_are_resolved(folder):
    """Two resting grains that just touch: by Hertz's force 2/3 k u^(3/2) less a constant A the kinetic energy has the
    maximum 3/5 A u_e at the equilibrium u_e = (3 A/(2 k))^(2/3), in every cycle."""
    radius, poisson, first = 1e-3, 0.25, 1e-10  # first overlap, m
    for law, adhesion in (("dmt", 1e-3), ("dmt", 0.1), ("liquid", 0.0)):
        for young in (2e6, 1e9):
            scene = heap(law, gravity=[0, 0, 0], walls=[])
            scene["specimen"] = {"particles": [[0, 0, 0, radius], [2 * radius - first, 0, 0, radius]], "group": 0}
            scene["materials"][0].update({"young": young, "restitution": 1, "friction": 0})
            if law == "dmt":
                scene["materials"][0]["adhesion"] = adhesion
            modulus = young / (2 * (1 - poisson**2))
            k = 2 * modulus * (radius / 2)**0.5
            pull = 2 * np.pi * (radius / 2) * (adhesion if law == "dmt" else 2 * 0.073)
            rest = (1.5 * pull / k)**(2 / 3)
            period = 2 * np.pi * (2 / 3 * np.pi * radius**3 * 2500 / (k * rest**0.5))**0.5
            scene["time"] = {"end": 6 * period}
            scene["output"] = {"history_rows": 5000, "snapshots": 0}
            here = os.path.join(folder, f"{law}-{adhesion}-{young}")
            os.mkdir(here)
            run(write_scene(here, scene), here)
            moving = history(here)["energy_kinetic"] / (0.6 * pull * rest - pull * first + 4 / 15 * k * first**2.5)
            peaks = moving[1:-1][(moving[1:-1] >= moving[:-2]) & (moving[1:-1] > moving[2:])]
            assert len(peaks) >= 6 and max(abs(peaks - 1)) < 0.03, (law, adhesion, young, peaks)


@fact
def wet_grains_may_not_be_removed_and_joints_do_not_attract(folder):
    scene = write_scene(folder, heap("liquid"))
    expect(gneiss("check", scene, "--set", "domain.lost=remove"), 2, r"law\.cohesion: expected none .*are removed")
    scene = write_scene(folder, heap("jkr", joints=[{"name": "j", "point": [0, 0, 0], "normal": [0, 1, 0],
                                                     "normal_stiffness": 1e9, "shear_stiffness": 1e9}]))
    expect(gneiss("check", scene), 2, r"law\.cohesion: expected none beside it, found joints")


if __name__ == "__main__":
    main()
