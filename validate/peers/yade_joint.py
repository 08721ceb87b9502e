"""Direct shear of a plane in a packing of spheres by YADE's jointed cohesive model with smooth joints: `yade -n -x yade_joint.py`, with the environment
variable JOB (json) for the packing, the joint and where to write. Started by validate/joint_study.py."""
import json
import os

from yade import (Bo1_Sphere_Aabb, ForceResetter, Ig2_Sphere_Sphere_ScGeom, InsertionSortCollider, InteractionLoop, Ip2_JCFpmMat_JCFpmMat_JCFpmPhys,
                  JCFpmMat, Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM, NewtonIntegrator, O, Vector3)
from yade.utils import sphere

job = json.loads(os.environ["JOB"])
joint = job["joint"]
rock = O.materials.append(JCFpmMat(type=1, young=20e9, poisson=0.4, frictionAngle=0.5, density=2600, tensileStrength=1e15, cohesion=1e15,
                                   jointNormalStiffness=joint["normal"], jointShearStiffness=joint["shear"], jointCohesion=joint["cohesion"],
                                   jointTensileStrength=joint["tension"], jointFrictionAngle=joint["friction"], jointDilationAngle=joint["dilation"]))
above = []
for x, y, z, radius in job["spheres"]:
    body = O.bodies[O.bodies.append(sphere((x, y, z), radius, material=rock))]
    body.state.blockedDOFs = "xyzXYZ"
    body.state.onJoint, body.state.joint = True, 1
    body.state.jointNormal1 = Vector3(0, 0, 1 if z > job["plane"] else -1)
    if z > job["plane"]:
        above.append(body)
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=job["reach"])]),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom(interactionDetectionFactor=job["reach"])],
                             [Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)],
                             [Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM(smoothJoint=True)]),
             NewtonIntegrator(damping=0)]
O.dt = job["dt"]
rows = []
O.step()  # forms the contacts, which stay
on_joint = [i.phys for i in O.interactions if i.isReal and i.phys.isOnJoint]
for velocity, steps in job["paths"]:
    for body in above:
        body.state.vel = Vector3(*velocity)
    for _ in range(steps // job["every"]):
        for _ in range(job["every"]):
            O.step()
        rows.append((len(on_joint), sum(abs(p.normalForce[2]) for p in on_joint), sum(abs(p.shearForce[0]) for p in on_joint)))
with open(job["out"], "w") as file:
    json.dump(rows, file)
os._exit(0)
