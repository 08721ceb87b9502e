"""A chain of spheres bonded by rotational bonds, held at one end, under its own weight, in ESyS-Particle.

    mpirun -np 2 esysparticle validate/peers/esys_beams.py      (one master, one worker)

Settings come from the environment as JSON in CHAIN: bonds, radius, density, gravity, kn, kt, kb, kw (spring constants of a
bond: normal, tangential, bending, twist), dt, steps, damping. The last line printed is `tip X Y Z`, the place of the last sphere.
"""
import json
import os
import tempfile

from esys.lsm import GravityPrms, LocalDampingPrms, LsmMpi, RotBondPrms, RotLocalDampingPrms
from esys.lsm.util import BoundingBox, Vec3

HELD = 1  # tag of the sphere that stays where it is


def geometry(bonds, radius):
    room = 4 * radius * (bonds + 1)
    lines = ["LSMGeometry 1.2", f"BoundingBox {-room} {-room} {-room} {room} {room} {room}", "PeriodicBoundaries 0 0 0",
             "Dimension 3D", "BeginParticles", "Simple", str(bonds + 1)]
    lines += [f"{2 * radius * k:.17g} 0 0 {radius:.17g} {k} {0 if k else HELD}" for k in range(bonds + 1)]
    lines += ["EndParticles", "BeginConnect", str(bonds), *(f"{k} {k + 1} 0" for k in range(bonds)), "EndConnect"]
    return "\n".join(lines) + "\n"


def main():
    chain = json.loads(os.environ["CHAIN"])
    radius, bonds, strong = chain["radius"], chain["bonds"], 1e30
    room = 4 * radius * (bonds + 1)
    simulation = LsmMpi(1, [1, 1, 1])
    simulation.initNeighbourSearch(particleType="RotSphere", gridSpacing=2.5 * radius, verletDist=0.2 * radius)
    simulation.setSpatialDomain(BoundingBox(Vec3(-room, -room, -room), Vec3(room, room, room)))
    simulation.setTimeStepSize(chain["dt"])
    with tempfile.NamedTemporaryFile("w", suffix=".geo") as file:
        file.write(geometry(bonds, radius))
        file.flush()
        simulation.readGeometry(file.name)
    for tag in (0, HELD):
        simulation.setParticleDensity(tag=tag, mask=-1, Density=chain["density"])
    simulation.createInteractionGroup(RotBondPrms(
        name="bonds", normalK=chain["kn"], shearK=chain["kt"], torsionK=chain["kw"], bendingK=chain["kb"],
        normalBrkForce=strong, shearBrkForce=strong, torsionBrkForce=strong, bendingBrkForce=strong, tag=0, scaling=False))
    simulation.createInteractionGroup(GravityPrms(name="weight", acceleration=Vec3(0, -chain["gravity"], 0)))
    simulation.createInteractionGroup(LocalDampingPrms(name="damping", viscosity=chain["damping"]))
    simulation.createInteractionGroup(RotLocalDampingPrms(name="turning", viscosity=chain["damping"]))
    simulation.setParticleNonDynamic(HELD)
    for _ in range(chain["steps"]):
        simulation.runTimeStep()
    tip = simulation.getParticlePosn(bonds)
    simulation.exit()  # the workers would wait for ever otherwise
    print(f"tip {tip[0]:.17g} {tip[1]:.17g} {tip[2]:.17g}", flush=True)


main()
