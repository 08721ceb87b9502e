"""Steps of the penetration case of Dosta et al. 2024 in YADE, timed: `yade -n -x yade_dem8.py`, with the environment variable
JOB (json) for what to read and where to write. Started by validate/dem8_study.py."""
import json
import math
import os
import time

from yade import (Bo1_Facet_Aabb, Bo1_Sphere_Aabb, ForceResetter, FrictMat, Ig2_Facet_Sphere_ScGeom, Ig2_Sphere_Sphere_ScGeom,
                  InsertionSortCollider, InteractionLoop, Ip2_FrictMat_FrictMat_MindlinPhys, Law2_ScGeom_MindlinPhys_Mindlin, MatchMaker,
                  NewtonIntegrator, O)
from yade.utils import facet, sphere

job = json.loads(os.environ["JOB"])
steel = O.materials.append(FrictMat(young=210e9, poisson=0.2, density=7200, frictionAngle=math.atan(0.2)))
grain = O.materials.append(FrictMat(young=1e9, poisson=0.2, density=2500, frictionAngle=math.atan(0.3)))
with open(job["walls"]) as file:
    for line in file.readlines()[1:]:
        v = [float(word) for word in line.split()]
        O.bodies.append(facet([v[0:3], v[3:6], v[6:9]], material=steel))
with open(job["particles"]) as file:
    rows = [[float(word) for word in line.split()] for line in file]
O.bodies.append([sphere(row[:3], row[3], material=grain) for row in rows[:-1]])
ball = O.bodies.append(sphere(rows[-1][:3], rows[-1][3], material=steel))
O.bodies[ball].state.vel = (0, 0, job["speed"])
O.dt = job["dt"]
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], verletDist=-0.1),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(hertzian=True)],
                             [Ip2_FrictMat_FrictMat_MindlinPhys(en=MatchMaker(matches=((1, 1, 0.5), (0, 1, 0.4), (0, 0, 0.4))))],
                             [Law2_ScGeom_MindlinPhys_Mindlin(preventGranularRatcheting=False)]),
             NewtonIntegrator(damping=0, gravity=(0, 0, -job["g"]))]
O.run(job["warm"], wait=True)
start = time.process_time()
O.run(job["steps"], wait=True)
seconds = time.process_time() - start  # processor time of all threads
with open(job["out"], "w") as file:
    json.dump({"seconds": seconds, "interactions": O.interactions.countReal(), "z": O.bodies[ball].state.pos[2]}, file)
os._exit(0)
