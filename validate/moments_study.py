"""A chain of bonds that carry moments under its own weight: gneiss, ESyS-Particle's rotational bonds, closed form.

    /usr/bin/python3 validate/moments_study.py BUILD_FOLDER

Prints a table for docs/evidence/models.md; half a minute. ESyS-Particle (Debian package esys-particle) is left out where there is none.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
from math import pi
from pathlib import Path

import h5py

HERE = Path(__file__).resolve().parent
BONDS, RADIUS, DENSITY, KN, KT, TIMES = 6, 1.0, 1.0, 1e6, 4e5, 1.0
KB, KW = KN * (TIMES * RADIUS) ** 2 / 4, KT * (TIMES * RADIUS) ** 2 / 2


def closed_form(gravity):
    """Bond k carries the weight of the spheres behind it, at its contact, half a length before each sphere."""
    weight, length, turn, down = DENSITY * 4 / 3 * pi * RADIUS ** 3 * gravity, 2 * RADIUS, 0.0, 0.0
    for k in range(1, BONDS + 1):
        moment = weight * length * sum(j - k + 0.5 for j in range(k, BONDS + 1))
        down += weight * (BONDS - k + 1) / KT + length / 2 * (2 * turn + moment / KB)
        turn += moment / KB
    return down


def scene(gravity):
    rows = ", ".join(f"[{2 * RADIUS * k}, 0, 0, {RADIUS}]" for k in range(BONDS + 1))
    return f"""dimension: 3
specimen: {{particles: [{rows}]}}
materials: [{{name: m, density: {DENSITY}, normal_stiffness: {KN}, kratio: {KN / KT}, bond_tension_limit: 1e15, bond_shear_limit: 1e15}}]
law: {{stiffness: uniform}}
bonds: {{radius_multiplier: {TIMES}}}
gravity: [0, {-gravity}, 0]
sets: [{{name: held, select: {{ids: [0]}}, motion: {{vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}}}]
damping: {{background: {{model: viscous, coefficient: 20}}}}
time: {{end: 8}}
run: {{threads: 1}}
output: {{snapshots: 0, checkpoint: off}}
"""


def by_gneiss(build, gravity):
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder) / "chain.yaml", Path(folder) / "out"
        path.write_text(scene(gravity))
        subprocess.run([Path(build).resolve() / "gneiss", "run", path, "--set", f"output.directory={out}"], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with h5py.File(out / "results.h5") as results:
            return -results["particles/displacement"][BONDS][1]


def by_esys(gravity, bending):
    """Returns None if the program is not installed."""
    if not shutil.which("esysparticle"):
        return None
    chain = {"bonds": BONDS, "radius": RADIUS, "density": DENSITY, "gravity": gravity, "kn": KN, "kt": KT, "kb": bending, "kw": KW,
             "dt": 2e-4, "steps": 40000, "damping": 0.3}
    extra = {"CHAIN": json.dumps(chain), "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    done = subprocess.run(["mpirun", "--oversubscribe", "-np", "2", "esysparticle", str(HERE / "peers" / "esys_beams.py")],
                          env={**os.environ, **extra}, capture_output=True, text=True, check=True)
    return -float(done.stdout.split("tip")[1].split()[1])


def main(build):
    print("| weight | closed form, m | gneiss | ESyS-Particle, bendingK = k_b | bendingK = 2 k_b |\n| --- | --- | --- | --- | --- |")
    for gravity in (0.1, 1.0):
        exact = closed_form(gravity)
        cells = [by_gneiss(build, gravity), by_esys(gravity, KB), by_esys(gravity, 2 * KB)]
        shown = ["not installed" if c is None else f"{c:.7g} ({c / exact - 1:+.1e})" for c in cells]
        print(f"| {gravity} m/s2 | {exact:.7g} | " + " | ".join(shown) + " |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
