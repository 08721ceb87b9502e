"""Uniaxial compression of a bonded packing in ESyS-Particle, the model of scenes/ucs-rock.yaml, timed.

    mpirun -np 3 esysparticle bench/peers/esys_ucs.py      (one master, two workers)

Settings come from the environment:
  PACKING  rows x y z r in metres      WORKERS  2
  STEPS    timed steps (300)           WARM     steps before the clock starts (50)
  RESULT   file for the JSON result

BrittleBeam bonds: beams with normal and shear force, bending and twisting moments between spheres that rotate (Wang,
Abe, Latham and Mora 2006, Pure Appl. Geophys. 163). gneiss' harmonic bonds carry no moments, so this is the nearest
law and not the same one. The bonds are the same pairs, written into the geometry file. Frictional contacts between
grains without a bond are looked for, as in gneiss. Damping: local (non-viscous) 0.7. Platens: bonded walls on the
particles that reach beyond the end planes, driven along z.

A beam's rest length is the sum of the radii and cannot be set, so beams across a gap or an overlap (nearly all of a
packed specimen) are strained from the start: at the true stiffness the specimen would fly apart at 290 m/s, and the
neighbour lists would be made anew all the time. The beams are therefore made softer by SOFTER: the grains creep, the
lists stay, no bond breaks, and a step computes all that it would compute otherwise (still softer, its rotations would
round to none and their arc cosines be left out). This times steps; it simulates no test.
"""
import json
import os
import tempfile
import time
from math import pi, sqrt

from esys.lsm import (BrittleBeamPrms, InteractionScalarFieldSaverPrms, LocalDampingPrms, LsmMpi, NRotBondedWallPrms,
                      ParticleScalarFieldSaverPrms, RotFrictionPrms, RotLocalDampingPrms)
from esys.lsm.util import BoundingBox, Vec3

packing = os.environ.get("PACKING", "scenes/specimens/rock-a.txt")
steps = int(os.environ.get("STEPS", "300"))
warm = int(os.environ.get("WARM", "50"))
workers = int(os.environ.get("WORKERS", "2"))

density, contact_modulus, kratio, friction, strength = 2650.0, 10e9, 3.7, 0.5, 40e6
interaction_range, damping, platen_speed, length = 0.05, 0.7, 0.1, 46e-3
SOFTER = 1e-4  # see above
LOWER, UPPER = 1, 2  # tags of the particles that reach beyond the end planes


def read_packing():
    with open(packing, encoding="utf-8") as rows:
        numbers = [row.split("#")[0].split() for row in rows]
    return [tuple(float(x) for x in row[:4]) for row in numbers if row]


def bonded_pairs(spheres):
    """Pairs with a gap up to the interaction range times the sum of their radii, found through a grid of cells."""
    edge = 2.0 * max(s[3] for s in spheres) * (1.0 + interaction_range)
    cells = {}
    for i, s in enumerate(spheres):
        cells.setdefault(tuple(int(x // edge) for x in s[:3]), []).append(i)
    around = [(a, b, c) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1)]
    pairs = []
    for (a, b, c), members in cells.items():
        near = [j for da, db, dc in around for j in cells.get((a + da, b + db, c + dc), ())]
        for i in members:
            x, y, z, r = spheres[i]
            for j in near:
                u, v, w, q = spheres[j]
                reach = (1.0 + interaction_range) * (r + q)
                if i < j and (x - u) ** 2 + (y - v) ** 2 + (z - w) ** 2 <= reach ** 2:
                    pairs.append((i, j))
    return pairs


def tag_of(sphere):
    return LOWER if sphere[2] - sphere[3] < 0 else UPPER if sphere[2] + sphere[3] > length else 0


def geometry(spheres, pairs, lower, upper):
    box = " ".join(f"{x:.17g}" for x in (*lower, *upper))
    lines = ["LSMGeometry 1.2", f"BoundingBox {box}", "PeriodicBoundaries 0 0 0", "Dimension 3D", "BeginParticles",
             "Simple", str(len(spheres))]
    lines += [f"{s[0]:.17g} {s[1]:.17g} {s[2]:.17g} {s[3]:.17g} {i} {tag_of(s)}" for i, s in enumerate(spheres)]
    lines += ["EndParticles", "BeginConnect", str(len(pairs))]
    lines += [f"{i} {j} 0" for i, j in pairs] + ["EndConnect"]
    return "\n".join(lines) + "\n"


def specimen(spheres, pairs, dt):
    """The simulation with its particles, bonds, contacts, damping and platens."""
    largest, smallest = max(s[3] for s in spheres), min(s[3] for s in spheres)
    lower = [min(s[k] - s[3] for s in spheres) - 4 * largest for k in range(3)]
    upper = [max(s[k] + s[3] for s in spheres) + 4 * largest for k in range(3)]
    simulation = LsmMpi(workers, [1, 1, workers])
    simulation.initNeighbourSearch(particleType="RotSphere", gridSpacing=2.5 * largest, verletDist=0.25 * smallest)
    simulation.setSpatialDomain(BoundingBox(Vec3(*lower), Vec3(*upper)))
    simulation.setTimeStepSize(dt)
    with tempfile.NamedTemporaryFile("w", suffix=".geo") as file:
        file.write(geometry(spheres, pairs, lower, upper))
        file.flush()
        simulation.readGeometry(file.name)
    for tag in (0, LOWER, UPPER):
        simulation.setParticleDensity(tag=tag, mask=-1, Density=density)

    # k_n = E pi r^2/(2 r) = 2 E_c r for equal spheres; k_n/k_t = 2 (1 + nu) = kappa
    simulation.createInteractionGroup(BrittleBeamPrms(
        name="bonds", youngsModulus=SOFTER * 4.0 * contact_modulus / pi, poissonsRatio=0.5 * kratio - 1.0,
        cohesion=strength, tanAngle=friction, tag=0))
    simulation.createInteractionGroup(RotFrictionPrms(
        name="grains", normalK=4.0 * contact_modulus / pi, dynamicMu=friction, staticMu=friction,
        shearK=4.0 * contact_modulus / pi / kratio, scaling=True))
    simulation.createExclusion("bonds", "grains")
    simulation.createInteractionGroup(LocalDampingPrms(name="damping", viscosity=damping))
    simulation.createInteractionGroup(RotLocalDampingPrms(name="turning", viscosity=damping))
    for name, z, direction, tag in (("lower", 0.0, 1, LOWER), ("upper", length, -1, UPPER)):
        simulation.createWall(name=name, posn=Vec3(0, 0, z), normal=Vec3(0, 0, direction))
        simulation.createInteractionGroup(NRotBondedWallPrms(
            name=name + "_platen", wallName=name, normalK=SOFTER * contact_modulus * smallest, particleTag=tag))
    return simulation


def run(simulation, dt, count):
    for _ in range(count):
        simulation.moveWallBy("lower", Vec3(0, 0, platen_speed * dt))
        simulation.moveWallBy("upper", Vec3(0, 0, -platen_speed * dt))
        simulation.runTimeStep()


def last_number(path):
    with open(path, encoding="utf-8") as file:
        return float(file.read().split()[-1])


def main():
    spheres = read_packing()
    pairs = bonded_pairs(spheres)
    dt = 0.1 * min(s[3] for s in spheres) * sqrt(density / contact_modulus)
    simulation = specimen(spheres, pairs, dt)
    with tempfile.TemporaryDirectory() as folder:
        counts, speeds = os.path.join(folder, "bonds"), os.path.join(folder, "speed")
        after = {"fileFormat": "SUM", "beginTimeStep": warm + steps, "endTimeStep": warm + steps + 2,
                 "timeStepIncr": 1}
        simulation.createFieldSaver(InteractionScalarFieldSaverPrms(
            interactionName="bonds", fieldName="count", fileName=counts, **after))
        simulation.createFieldSaver(ParticleScalarFieldSaverPrms(
            fieldName="v_abs", fileName=speeds, **dict(after, fileFormat="MAX")))
        run(simulation, dt, warm)
        started = time.perf_counter()
        run(simulation, dt, steps)
        seconds = time.perf_counter() - started
        run(simulation, dt, 2)  # writes the counts, outside the clock
        version, particles = simulation.getLsmVersion(), simulation.getNumParticles()
        simulation.exit()  # the workers wait for ever otherwise
        result = {"code": "esys-particle", "version": version, "workers": workers, "particles": particles,
                  "bonds": last_number(counts), "bonds_at_start": len(pairs), "greatest_speed": last_number(speeds),
                  "dt": dt, "steps": steps, "seconds": seconds, "load_average": os.getloadavg()[0]}
    with open(os.environ["RESULT"], "w", encoding="utf-8") as out:
        json.dump(result, out)


main()
