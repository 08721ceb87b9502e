"""Carries out one job (validate/yade/jobs.py defines jobs) in YADE.

    JOB=job.json OUT=result.npz QT_QPA_PLATFORM=offscreen yade -n -x -j1 validate/yade/peer.py

JCFpm with young = 2 E_c, poisson = k_t/k_n and tensileStrength = 4 sigma_c/pi, cohesion = 4 tau_c/pi is the harmonic law
of gneiss, frictionAngle = atan(bond_friction) its bonds under pressure with `coupling: linear`. What YADE defines in another way is made equal here, each by an option of its own so that its effect can be
measured (`job["yade"]`):
  arms       "contact": shear at the contact point (avoidGranularRatcheting off); "ratcheting": YADE's default
  friction   "completed": broken bonds get their friction in the step in which they break, and it limits their shear
             force in that step already; "none": what YADE does with frictionAngle = 0; "coulomb": frictionAngle =
             atan(mu) from the start whatever bond_friction is, so that pressure strengthens bonds, and nothing set right
  start      "aligned": velocities are given after the first forces, so that no shear is counted before the start, and the
             first kick under gravity is a half one; "plain": given with the particles
  fresh      "aligned": pairs that meet later measure the overlap from zero and count the shear of their first step;
             "plain": from the overlap at the first step in which they touch, without the shear of that step
  increment  "end": shear of a step with the normal and the arms of its end; "middle": with those of its middle, and the
             twist of the step halfway through it, as in gneiss: what differs is added before YADE's law (slow)
  crossing   "whole": contacts without a bond that close or open within a step act at its end with the whole overlap or not
             at all; "part": with gneiss' share of the step (slow)
  damping    "yade": NewtonIntegrator's rule; "past": sign of the velocity before the kick, from Python (slow)
"""
import json
import os
import time
from math import atan, pi

import numpy as np
from yade import O, utils

with open(os.environ["JOB"], encoding="utf-8") as f:
    job = json.load(f)
choice = {"arms": "contact", "friction": "completed", "start": "aligned", "fresh": "plain", "increment": "end",
          "crossing": "whole", "damping": "yade", **job.get("yade", {})}
spheres = np.loadtxt(job["spheres"], ndmin=2)
mu, every, steps, dt = job["friction"], job["every"], job["steps"], job["dt"]
gravity = Vector3(*job.get("gravity", (0, 0, 0)))
snapshot_every = job.get("snapshot_every", 0)

rock = O.materials.append(JCFpmMat(
    type=1, young=2 * job["contact_modulus"], poisson=1 / job["kratio"], density=job["density"],
    tensileStrength=4 * job["tension"] / pi, cohesion=4 * job["shear"] / pi,
    frictionAngle=atan(mu if choice["friction"] == "coulomb" else job.get("bond_friction", 0.0)),
    residualFrictionAngle=atan(mu)))
for x, y, z, r in spheres.tolist():
    O.bodies.append(utils.sphere((x, y, z), r, material=rock))
bodies = [O.bodies[k] for k in range(len(spheres))]
states = [b.state for b in bodies]
for s in job["sets"]:
    blocked = "".join(c for c, v in zip("xyzXYZ", s["v"] + s["w"]) if v is not None)
    for k in s["ids"]:
        states[k].blockedDOFs = "".join(sorted(set(states[k].blockedDOFs) | set(blocked)))


tables = [(s, any(isinstance(v, list) for v in s["v"])) for s in job["sets"]]


def at(value, instant):
    """A prescribed velocity, constant or a table."""
    return np.interp(instant, *np.transpose(value)) if isinstance(value, list) else value


def follow_tables(n):
    """Velocities of the next step, which are those at its middle."""
    for s, changes in tables:
        now = [at(v, (n + 0.5) * dt) for v in s["v"]] if changes else []
        for k in s["ids"] if changes else []:
            states[k].vel = Vector3(*(old if v is None else v for old, v in zip(states[k].vel, now)))


def give_velocities():
    for s in job.get("initial", []):
        for k in s["ids"]:
            states[k].vel, states[k].angVel = Vector3(*s["v"]), Vector3(*s["w"])
    for s in job["sets"]:
        for k in s["ids"]:
            for target, values in (("vel", s["v"]), ("angVel", s["w"])):
                now = list(getattr(states[k], target))
                now = [old if v is None else at(v, 0.5 * dt) for old, v in zip(now, values)]
                setattr(states[k], target, Vector3(*now))
    if choice["start"] == "aligned" and gravity.norm() > 0:
        for state in states:  # The first kick is a whole one in YADE; half of it is subtracted beforehand.
            free = [0 if axis in state.blockedDOFs else 1 for axis in "xyz"]
            kept = 1 - job["damping"]
            state.vel -= Vector3(*(0.5 * dt * kept * g * f for g, f in zip(gravity, free)))


# --- recorded results ----------------------------------------------------------------------------------

rows, snapshots = [], []
peak = 0.0


def record(n):
    global peak
    reactions = []
    for s in job["sets"]:
        total = Vector3(0, 0, 0)
        for k in s["ids"]:
            total -= O.forces.f(k) + states[k].mass * gravity  # NewtonIntegrator does not report the weight.
        reactions += list(total)
    rows.append([n, *reactions, law.nbTensCracks, law.nbShearCracks])
    drop = job.get("peak_drop")
    if drop:
        axis, names = job["axis"], [s["name"] for s in job["sets"]]
        a, b = names.index(job["ends"][0]), names.index(job["ends"][1])
        load = 0.5 * abs(reactions[3 * a + axis] - reactions[3 * b + axis])
        peak = max(peak, load)
        if law.nbTensCracks + law.nbShearCracks > 0 and load < (1 - drop) * peak:
            return True
    return False


def snapshot(n):
    values = np.array([[*s.pos, *s.vel, *s.angVel] for s in states])
    snapshots.append((n, values if job.get("velocities") else values[:, :3]))


# --- corrections that make the laws equal --------------------------------------------------------------

cracks, intact, known = 0, [], 0


def dot(a, b):
    return (a * b).sum(axis=0)


def cross(a, b):
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


class Contacts:
    """Quantities of interactions that gneiss' law reads, as arrays [interaction] or [axis, interaction]."""

    def __init__(self, members):
        self.members, self.phys = members, [i.phys for i in members]
        pairs = np.array([(i.id1, i.id2) for i in members], dtype=int).reshape(-1, 2)
        ids, place = np.unique(pairs, return_inverse=True)
        self.states, self.place = [states[k] for k in ids], place.reshape(-1, 2).T
        self.radii = spheres[pairs.T, 3]
        self.kn, self.kt, overlap = np.array([(p.kn, p.ks, p.initD) for p in self.phys]).reshape(-1, 3).T
        self.length0 = self.radii.sum(axis=0) - overlap
        self.normal = np.array([[*i.geom.normal] for i in members]).reshape(-1, 3).T

    def look(self):
        """Called at the end of a step, before its forces: velocities are those of the step."""
        now = np.empty((len(self.states), 9))
        for row, s in enumerate(self.states):
            x, v, w = s.pos, s.vel, s.angVel
            now[row] = x[0], x[1], x[2], v[0], v[1], v[2], w[0], w[1], w[2]
        first, second = now.T[:, self.place[0]], now.T[:, self.place[1]]
        branch, self.velocity = second[:3] - first[:3], second[3:6] - first[3:6]
        self.spins = first[6:], second[6:]
        self.distance = np.sqrt(dot(branch, branch))
        self.before, self.normal = self.normal, branch / self.distance
        self.speed = dot(self.velocity, self.normal)
        self.stretch, self.path = self.distance - self.length0, dt * self.speed

    def twist(self, axis):
        """The twist of the pair about a direction in the step, by its mean spin."""
        return 0.5 * dt * dot(self.spins[0] + self.spins[1], axis)

    def increment(self, at):
        """The increment of the tangential force on the first particle in the step; at its "end" as YADE, its "middle" as gneiss."""
        back = 0.5 * dt if at == "middle" else 0.0
        length = self.distance - back * self.speed
        direction = (self.distance * self.normal - back * self.velocity) / length
        arms = self.radii + 0.5 * (length - self.radii.sum(axis=0))
        v = self.velocity - cross(arms[0] * self.spins[0] + arms[1] * self.spins[1], direction)
        whole = self.kt * dt * (v - dot(v, self.normal) * direction)
        if at == "end":
            return whole
        angle, half = self.twist(direction), 0.5 * whole
        return whole + angle * cross(self.normal, half) - 0.5 * angle**2 * half

    def before_turn(self, force):
        """The force before YADE's rotation of the old shear force, f - f x a about two axes one after the other, to `force`."""
        for a in (self.twist(self.before) * self.before, cross(self.before, self.normal)):
            force = (force - cross(a, force) + dot(a, force) * a) / (1 + dot(a, a))
        return force


def add_increment():
    """Called before YADE's law: sets shear forces such that YADE's increment leads to the force of gneiss, which then
    decides on bonds and friction."""
    contacts.look()
    if choice["increment"] == "middle":
        more = contacts.before_turn(contacts.increment("middle") - contacts.increment("end"))
        for phys, x, y, z in zip(contacts.phys, *more.tolist()):
            phys.shearForce -= Vector3(x, y, z)  # acts on the second particle


def change_shear(i, new):
    """Replaces the shear force of this step, with the corresponding change of the forces on the particles."""
    change, n = new - i.phys.shearForce, i.geom.normal
    overlap = i.geom.penetrationDepth
    O.forces.addF(i.id1, -change)
    O.forces.addF(i.id2, change)
    O.forces.addT(i.id1, (i.geom.refR1 - 0.5 * overlap) * n.cross(-change))
    O.forces.addT(i.id2, (i.geom.refR2 - 0.5 * overlap) * n.cross(-change))
    i.phys.shearForce = new


def limit_shear(i):
    force, limit = i.phys.shearForce, mu * max(i.phys.normalForce.dot(i.geom.normal), 0.0)
    size = force.norm()
    if size > limit:
        change_shear(i, force * (limit / size))


def change_normal(i, new):
    change = new - i.phys.normalForce
    i.phys.normalForce = new
    O.forces.addF(i.id1, -change)
    O.forces.addF(i.id2, change)


def broken_now():
    """Interactions whose bonds broke in this step."""
    global cracks, intact
    now = law.nbTensCracks + law.nbShearCracks
    if now == cracks:
        return []
    cracks = now
    gone = [i for i, phys in intact if not phys.isCohesive]
    intact = [pair for pair in intact if pair[1].isCohesive]
    return gone


def complete_broken(broken):
    """Friction for bonds that broke in this step."""
    for i in broken:
        i.phys.tanFrictionAngle = mu
        limit_shear(i)


def complete_fresh(real):
    """Pairs that touch for the first time: overlap from zero, shear of this step."""
    fresh = [i for i in real if not i.phys.isCohesive and i.phys.initD != 0.0 and (i.id1, i.id2) not in bonded]
    for i in fresh:
        i.phys.initD = 0.0
    met = Contacts(fresh)
    met.look()
    for i, shear in zip(fresh, met.increment(choice["increment"]).T.tolist()):
        change_normal(i, i.phys.kn * i.geom.penetrationDepth * i.geom.normal)
        change_shear(i, -Vector3(*shear))
        limit_shear(i)


def ends_along(i):
    """The inverse mass of both ends of a contact along its normal, 1/kg, and the acceleration by which their weights open it, m/s2: prescribed
    components contribute to neither."""
    n, inverse, opens = i.geom.normal, 0.0, 0.0
    for k, sign in ((i.id1, -1), (i.id2, 1)):
        free = [a for a, c in enumerate("xyz") if c not in states[k].blockedDOFs]
        inverse += sum(n[a]**2 for a in free) / states[k].mass
        opens += sign * sum(gravity[a] * n[a] for a in free)
    return inverse, opens


def complete_crossing(broken):
    """Contacts without a bond that closed or opened within this step: see src/kernels/contact_law.h. Bonds
    that broke in it were springs until then."""
    c, sprung = contacts, {(i.id1, i.id2) for i in broken}
    start = c.stretch - c.path
    for k in np.flatnonzero((c.stretch < 0) != (start < 0)).tolist():
        i, u, gap = c.members[k], float(c.stretch[k]), float(start[k])
        closed = u < 0
        if c.phys[k].isCohesive or closed and (gap < 2**-48 * c.distance[k] or (i.id1, i.id2) in sprung):
            continue
        s = u / float(c.path[k])
        inverse, opens = ends_along(i)
        bend = min(0.25 * dt**2 * float(c.kn[k]) * inverse, 0.125) * s * (1 - s)
        first = 0.5 * min(0.5, max(-0.5, dt**2 * opens / float(c.path[k])))
        pressing = -u * (1 + s) * (1 - bend + first * (1 - s) / (1 + s)) if closed else gap * s * (1 + bend - first)
        change_normal(i, 0.5 * float(c.kn[k]) * pressing * i.geom.normal)
        limit_shear(i)


def complete_pairs():
    """Pairs that touch for the first time, once the law has seen them."""
    global known, contacts
    now = O.interactions.countReal()
    if now == known:
        return
    known = now
    real = [i for i in O.interactions if i.isReal]
    if choice["fresh"] == "aligned":
        complete_fresh(real)
    if followed:
        contacts = Contacts(real)
        contacts.look()


def damp_past():
    """-a |F_k| sign(v_k) with the velocity before the kick, on free components."""
    for k, state in enumerate(states):
        blocked = state.blockedDOFs
        f, m, v, w = O.forces.f(k) + state.mass * gravity, O.forces.t(k), state.vel, state.angVel
        O.forces.addF(k, Vector3(*(0 if c in blocked else -job["damping"] * abs(f[a]) * np.sign(v[a])
                                   for a, c in enumerate("xyz"))))
        O.forces.addT(k, Vector3(*(0 if c in blocked else -job["damping"] * abs(m[a]) * np.sign(w[a])
                                   for a, c in enumerate("XYZ"))))


def press(n):
    """The membrane: outward areas with fixed directions and particles. (gneiss removes those of particles that no
    longer touch the body.)"""
    if not skin:
        return
    share = min(n * dt / job["pressure"]["ramp"], 1.0)
    for k, area in skin.items():
        O.forces.addF(k, -share * job["pressure"]["value"] * area)


def tick():
    """Between forces and motion: n steps have been taken, the forces are those at the present positions."""
    n = O.iter - first_iteration
    broken = broken_now()
    if choice["friction"] == "completed":
        complete_broken(broken)
    complete_pairs()
    if choice["crossing"] == "part":
        complete_crossing(broken)
    press(n)
    follow_tables(n)
    if n == 0 and choice["start"] == "aligned":
        give_velocities()
    if snapshot_every and n % snapshot_every == 0:
        snapshot(n)
    if n % every == 0 and record(n):
        raise_stop()
    if choice["damping"] == "past":
        damp_past()


def raise_stop():
    global stopped
    stopped = True
    O.pause()


stopped = False
law = Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM(neverErase=True)
reach = 1 + (job["interaction_range"] if job.get("bonded", True) else 0)
bounds = Bo1_Sphere_Aabb(aabbEnlargeFactor=reach)
detection = Ig2_Sphere_Sphere_ScGeom(interactionDetectionFactor=reach,
                                     avoidGranularRatcheting=choice["arms"] == "ratcheting")
newton = NewtonIntegrator(damping=0 if choice["damping"] == "past" else job["damping"], gravity=gravity)
O.engines = [ForceResetter(), InsertionSortCollider([bounds]),
             InteractionLoop([detection], [Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(
                 cohesiveTresholdIteration=1 if job.get("bonded", True) else 0)], [law]),
             newton]
O.dt = 0
O.step()  # forms the bonds
bounds.aabbEnlargeFactor = 1
detection.interactionDetectionFactor = 1
bonded = {(i.id1, i.id2) for i in O.interactions if i.isReal and i.phys.isCohesive}
known = O.interactions.countReal()
intact = [(i, i.phys) for i in O.interactions if i.isReal and i.phys.isCohesive]
skin = {k: Vector3(*area) for k, area in enumerate(job["yade"].get("skin", [])) if any(area)} if "pressure" in job else {}
if choice["start"] == "plain":
    give_velocities()
first_iteration = O.iter
followed = choice["increment"] == "middle" or choice["crossing"] == "part"
contacts = Contacts([i for i in O.interactions if i.isReal]) if followed else None
ahead = [PyRunner(command="add_increment()", iterPeriod=1, initRun=True)] if followed else []
O.engines = (O.engines[:2] + ahead + O.engines[2:3] + [PyRunner(command="tick()", iterPeriod=1, initRun=True)]
             + O.engines[3:])
O.dt = dt
started = time.perf_counter()
O.run(steps + 1, True)  # The last tick has the forces after `steps` steps.
seconds = time.perf_counter() - started
rows = np.array(rows)
broken = [pair for pair in sorted(bonded) if not O.interactions[pair].phys.isCohesive]
sets = len(job["sets"])
np.savez(os.environ["OUT"], step=rows[:, 0].astype(int), reaction=rows[:, 1:1 + 3 * sets].reshape(len(rows), sets, 3),
         broken_tension=rows[:, -2].astype(int), broken_shear=rows[:, -1].astype(int),
         snapshot_step=np.array([n for n, _ in snapshots], dtype=int), snapshot=np.array([v for _, v in snapshots]),
         broken=np.array(broken, dtype=int).reshape(-1, 2), bonds=len(bonded), seconds=seconds, steps_taken=O.iter - 1 - first_iteration, version=version,
         threads=int(os.environ["OMP_NUM_THREADS"]), pwave_step=utils.PWaveTimeStep(), load=os.getloadavg()[0])
