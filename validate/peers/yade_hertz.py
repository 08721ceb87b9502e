"""Collisions of two spheres, or of a sphere and a plane (z = 0), by YADE's Hertz-Mindlin law: `yade -n -x yade_hertz.py`, with
the environment variable JOB (json) for where to write and which jobs to do. Started by validate/hertz_study.py."""
import json
import math
import os

from yade import (Bo1_Facet_Aabb, Bo1_Sphere_Aabb, FrictMat, ForceResetter, Ig2_Facet_Sphere_ScGeom, Ig2_Sphere_Sphere_ScGeom,
                  InsertionSortCollider, InteractionLoop, Ip2_FrictMat_FrictMat_MindlinPhys, Law2_ScGeom_MindlinPhys_Mindlin,
                  NewtonIntegrator, O, Vector3)
from yade.utils import facet, sphere


def material(m):
    return O.materials.append(FrictMat(young=m["young"], poisson=m["poisson"], density=m["density"], frictionAngle=math.atan(m["friction"])))


def carry_out(job):
    """For every step: time, then position, velocity and spin of each sphere; only for the last step if no rows are requested."""
    O.reset()
    for s in job["spheres"]:
        k = O.bodies.append(sphere(s["at"], s["r"], material=material(s)))
        O.bodies[k].state.vel = Vector3(*s["v"])
        O.bodies[k].state.angVel = Vector3(*s["spin"])
    if job.get("plane"):
        wide = 50 * job["spheres"][0]["r"]
        O.bodies.append(facet([(-wide, -wide, 0), (wide, -wide, 0), (0, wide, 0)], material=material(job["plane"])))
    e = job["spheres"][0]["restitution"]
    physics = Ip2_FrictMat_FrictMat_MindlinPhys(en=e) if e < 1 else Ip2_FrictMat_FrictMat_MindlinPhys()
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()]),
                 InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(hertzian=True)], [physics],
                                 [Law2_ScGeom_MindlinPhys_Mindlin(preventGranularRatcheting=False)]),
                 NewtonIntegrator(damping=0)]
    O.dt = job["dt"]
    rows = []
    for step in range(job["steps"]):
        O.step()
        if job.get("rows", True) or step + 1 == job["steps"]:
            row = [O.time]
            for k in range(len(job["spheres"])):
                state = O.bodies[k].state
                row += [*state.pos, *state.vel, *state.angVel]
            rows.append(row)
    return rows


asked = json.loads(os.environ["JOB"])
found = [carry_out(job) for job in asked["jobs"]]
with open(asked["out"], "w") as file:
    json.dump(found, file)
os._exit(0)
