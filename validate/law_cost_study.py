"""The cost of laws of bonds beside the linear one: instructions of the contact kernel by callgrind (valgrind), where it is installed, and
its time, one thread, AVX2. A periodic fcc lattice of 5 184 bonds, with spins, friction, dashpots and ledger, which its box stretches
beyond their strength and then lets back, or presses on. Fills the table of docs/evidence/law-table.md; two minutes.

    /usr/bin/python3 validate/law_cost_study.py
"""
import json
import os
import re
import shutil
import subprocess

import h5py

import study

FOLDER = study.RUNS / "law-cost"
CELLS, STEP, STRETCHING = 6, 2e-7, 10  # s, steps in which the box grows
FEW, MANY, TIMED, TURNS = 20, 40, 400, 12
SOFT = {"softening": "ratio"}
SOFT_MATERIAL = {"fracture_ratio": 50.0}
# Name, strength in Pa, keys of the law, of the material, of the bonds, rate of the box after it was stretched (1/s; when timed).
LAWS = (
    ("linear", 1e12, {}, {}, {}, (-20, -20)),
    ("friction of bonds", 1e12, {}, {"bond_friction": 1.0}, {}, (-20, -20)),
    ("moments", 1e12, {}, {}, {"radius_multiplier": 1.0}, (-20, -20)),
    ("softening, bonds whole", 1e12, SOFT, SOFT_MATERIAL, {}, (-20, -20)),
    ("softening, all damaged", 1e6, SOFT, SOFT_MATERIAL, {}, (-20, -20)),
    ("softening, all damaged and yielding in every step", 1e6, SOFT, {**SOFT_MATERIAL, "yield_stress_1": 1e-3, "yield_ratio_1": 1.01}, {},
     (-3000, -200)),
)
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive", "GNEISS_ISA": "avx2"}


def scene(law, steps):
    _, strength, rule, material, bonds, rates = law
    rate, end, side = rates[steps == TIMED], STRETCHING * STEP, CELLS * 2e-3 * 2**0.5
    motion = {"rate": [[0, 1000], [end, 1000], [1.001 * end, rate], [1, rate]]}
    return {
        "dimension": 3, "specimen": {"lattice": {"kind": "fcc", "radius": 1e-3, "cells": [CELLS] * 3}},
        "materials": [{"name": "m", "density": 2650, "contact_modulus": 1e9, "kratio": 2, "friction": 0.5, "tensile_strength": strength,
                       "shear_strength": strength, **material}],
        "law": {"stiffness": "harmonic", **rule}, "bonds": {"interaction_range": 0.05, **bonds},
        "periodic": {"min": [0, 0, 0], "max": [side] * 3, "x": motion, "y": motion, "z": motion},
        "damping": {"contact": {"restitution": 0.5}}, "time": {"end": STEP * steps, "step": STEP}, "run": {"threads": 1},
        "output": {"snapshots": 0, "checkpoint": "off", "history_rows": 2, "events": "off"}}


def run(law, steps, before=()):
    FOLDER.mkdir(parents=True, exist_ok=True)
    path, out = FOLDER / "scene.yaml", FOLDER / "out"
    path.write_text(json.dumps(scene(law, steps)))
    shutil.rmtree(out, ignore_errors=True)
    subprocess.run([*before, study.PROGRAM, "run", path, "--out", out, "--quiet"], env=ENVIRONMENT, check=True, capture_output=True)
    return out / "results.h5"


def instructions(law):
    """Millions of instructions in the kernel of bonds, including the functions that it calls, of the last MANY - FEW
    steps."""
    counts = []
    for steps in (FEW, MANY):
        file = FOLDER / "callgrind"
        run(law, steps, ("valgrind", "--tool=callgrind", f"--callgrind-out-file={file}"))
        said = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", file], check=True, capture_output=True, text=True).stdout
        counts.append(max(int(n.replace(",", "")) for n in re.findall(r"([\d,]+) \([ \d.%]+\) +\S*:gn_contact_avx2_", said)))
    return (counts[1] - counts[0]) / 1e6


def milliseconds():
    """Cost per step of each law: the smallest of alternating runs, because other processes only increase it."""
    least = [float("inf")] * len(LAWS)
    for _ in range(TURNS):
        for k, law in enumerate(LAWS):
            with h5py.File(run(law, TIMED), "r") as results:
                least[k] = min(least[k], 1e3 * float(results["profile/bonds"][()].ravel()[0]) / TIMED)
    return least


def main():
    counted = [instructions(law) for law in LAWS] if shutil.which("valgrind") else None
    spent = milliseconds()
    rows = [[law[0], f"{counted[k] / counted[0]:.2f}" if counted else "-", f"{1e6 * spent[k] / (4 * 6 * 2 * CELLS**3 / 2):.1f}",
             f"{spent[k] / spent[0]:.2f}"] for k, law in enumerate(LAWS)]
    study.put("law-table.md", "table cost", study.table(["law", "instructions over the linear law's", "ns per bond and step", "over the linear law's"], rows))


if __name__ == "__main__":
    main()
