"""Uniaxial compression of a bonded packing in YADE, the same model as scenes/ucs-rock.yaml, timed.

    QT_QPA_PLATFORM=offscreen yade -n -x -j2 bench/peers/yade_ucs.py

Settings come from the environment, because yade keeps the command line to itself:
  PACKING  rows x y z r in metres
  STEPS    timed steps (300)       WARM  steps before the clock starts (50)
  RESULT   file for the JSON result

The contact law equals gneiss' harmonic law: JCFpm with young = 2 E_c, poisson = k_t/k_n and tensileStrength =
cohesion = 4 sigma_c/pi gives kn = 2 E_c 2 r1 r2/(r1 + r2), ks = kn/kappa and limits 4 sigma_c r_min^2. Only the
timed, unbroken part of the test is run, so the friction of broken bonds (which JCFpm fixes at creation) is left
out. Platens: the particles that reach beyond the end planes get the platen's velocity along z and stay free
across it, as frictionless platens that are stress-free at the start would move them.
"""
import json
import os
import time
from math import atan, pi

from yade import O, utils

packing = os.environ.get("PACKING", "scenes/specimens/rock-a.txt")
steps = int(os.environ.get("STEPS", "300"))
warm = int(os.environ.get("WARM", "50"))

density, contact_modulus, kratio, friction, strength = 2650.0, 10e9, 3.7, 0.5, 40e6
interaction_range, damping, platen_speed, length = 0.05, 0.7, 0.1, 46e-3

spheres = []
with open(packing, encoding="utf-8") as rows:
    for row in rows:
        numbers = row.split("#")[0].split()
        if numbers:
            spheres.append([float(x) for x in numbers[:4]])

O.materials.append(JCFpmMat(
    type=1, young=2 * contact_modulus, poisson=1 / kratio, density=density,
    tensileStrength=4 * strength / pi, cohesion=4 * strength / pi,
    frictionAngle=0, residualFrictionAngle=atan(friction), label="rock"))
driven = [0, 0]
for x, y, z, r in spheres:
    body = O.bodies[O.bodies.append(utils.sphere((x, y, z), r, material="rock"))]
    end = -1 if z - r < 0 else 1 if z + r > length else 0
    if end:
        body.state.blockedDOFs = "z"
        body.state.vel = (0, 0, -end * platen_speed)
        driven[end > 0] += 1

O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1 + interaction_range, label="bounds")]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(interactionDetectionFactor=1 + interaction_range, label="detection")],
        [Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)],
        [Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM(neverErase=True)]),
    NewtonIntegrator(damping=damping),
]
O.dt = 0
O.step()  # forms the bonds
bounds.aabbEnlargeFactor = 1
detection.interactionDetectionFactor = 1
O.dt = 0.4 * utils.PWaveTimeStep()
O.run(warm, True)


def intact():
    return sum(1 for i in O.interactions if i.isReal and i.phys.isCohesive)


bonds_before, pairs_before = intact(), O.interactions.countReal()
started = time.perf_counter()
O.run(steps, True)
seconds = time.perf_counter() - started
bonds, pairs = intact(), O.interactions.countReal()

result = {
    "code": "yade", "version": version, "threads": int(os.environ["OMP_NUM_THREADS"]),  # set by -j
    "particles": len(spheres), "bonds": bonds, "bonds_at_start": bonds_before, "contacts": pairs,
    "driven_lower": driven[0], "driven_upper": driven[1], "dt": O.dt, "steps": steps, "seconds": seconds,
    # Every interaction that was worked on counts, bonded or not, as for gneiss.
    "contact_steps_per_second": 0.5 * (pairs_before + pairs) * steps / seconds,
    "particle_steps_per_second": len(spheres) * steps / seconds,
    "load_average": os.getloadavg()[0],
}
with open(os.environ["RESULT"], "w", encoding="utf-8") as out:
    json.dump(result, out)
