"""Two spheres that collide by YADE's Hertz-Mindlin law: `yade -n -x yade_hertz.py`, told by the environment variable JOB
(json) where to write. Started by validate/hertz_study.py."""
import json
import os

from yade import (BoundDispatcher, FrictMat, ForceResetter, GlobalStiffnessTimeStepper, Ig2_Sphere_Sphere_ScGeom,  # noqa: F401
                  InsertionSortCollider, InteractionLoop, Ip2_FrictMat_FrictMat_MindlinPhys, Law2_ScGeom_MindlinPhys_Mindlin, NewtonIntegrator,
                  O, Bo1_Sphere_Aabb)
from yade.utils import sphere
from yade import Vector3
import math

job = json.loads(os.environ["JOB"])
material = O.materials.append(FrictMat(young=job["young"], poisson=job["poisson"], density=job["density"], frictionAngle=math.atan(job["friction"])))
r, gap = job["r"], job["gap"]
for side in (1, -1):
    O.bodies.append(sphere((0, 0, side * (r + gap / 2)), r, material=material))
for body, side in zip(O.bodies, (1, -1)):
    body.state.vel = Vector3(*[side * v for v in job["v"]])
    body.state.angVel = Vector3(*[side * w for w in job["spin"]]) if job["opposite"] else Vector3(*job["spin"])
physics = Ip2_FrictMat_FrictMat_MindlinPhys(en=job["restitution"]) if job["restitution"] < 1 else Ip2_FrictMat_FrictMat_MindlinPhys()
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb()]),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [physics], [Law2_ScGeom_MindlinPhys_Mindlin()]),
             NewtonIntegrator(damping=0)]
O.dt = job["dt"]
rows = []
for _ in range(job["steps"]):
    O.step()
    a, b = O.bodies
    rows.append([O.time, *a.state.pos, *a.state.vel, *a.state.angVel, *b.state.pos, *b.state.vel, *b.state.angVel, *O.forces.f(0)])
with open(job["out"], "w") as file:
    json.dump(rows, file)
os._exit(0)
