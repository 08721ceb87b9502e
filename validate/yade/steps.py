"""Level 1, step by step: two particles, a chain, a small lattice. It lists the definitions that differ, each with the experiment that removes the
difference."""
import numpy as np

import jobs

GRAIN = {"density": 2650.0, "contact_modulus": 10e9, "kratio": 3.7, "friction": 0.5, "tension": 40e6, "shear": 40e6,
         "interaction_range": 0.05, "damping": 0.0, "dt": 1e-7, "every": 1, "snapshot_every": 1, "velocities": True}
FREE, STILL = [None] * 3, [0.0] * 3
# The definitions that peer.py uses by default: all of them equal to those of gneiss.
SAME = {"fresh": "aligned", "increment": "middle", "crossing": "part"}
# Pairs that overlap by 2.6 %, are 2 micrometres apart, or touch.
PAIR = [[0, 0, 0, 1.0e-3], [1.85e-3, 0, 0, 0.9e-3]]
APART = [[0, 0, 0, 1.0e-3], [1.902e-3, 0.01e-3, 0, 0.9e-3]]


def chain():
    rows, x = [], 0.0
    for k in range(12):
        r = 1e-3 * (1 + 0.2 * np.sin(1.7 * k))
        x += 0.98 * (r + rows[-1][3]) if rows else 0.0
        rows.append([x, 2e-5 * np.cos(2.3 * k), 2e-5 * np.sin(0.9 * k), r])
    return rows


def lattice():
    """Face-centred cubic, 3 x 3 x 5 cells, radii and centres shifted at random."""
    rng = np.random.default_rng(7)
    basis = np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]])
    cells = np.array([[i, j, k] for i in range(3) for j in range(3) for k in range(5)])
    centres = (cells[:, None, :] + basis[None]).reshape(-1, 3) * 2.8e-3
    centres += rng.uniform(-4e-5, 4e-5, centres.shape)
    return np.column_stack([centres, 1e-3 * rng.uniform(0.92, 1.06, len(centres))]).tolist()


def specimen(name, rows):
    path = jobs.RUNS / "specimens" / f"{name}.txt"
    text = "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in rows)
    if not path.exists() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return str(path)


def held(ids=(0,), v=STILL, w=FREE, name="held"):
    return {"name": name, "ids": list(ids), "v": list(v), "w": list(w)}


def lattice_job(damping, steps=9000):
    rows = np.array(lattice())
    order = np.argsort(rows[:, 2])
    lower, upper = sorted(order[:18].tolist()), sorted(order[-18:].tolist())
    return {"rows": rows.tolist(), "steps": steps, "damping": damping, "interaction_range": 0.06, "dt": 1.5e-7,
            "every": 10, "snapshot_every": 10, "sets": [held(lower, [None, None, 0.2], name="lower"),
                                                         held(upper, [None, None, -0.2], name="upper")]}


def start(v, w=STILL):
    return [{"ids": [1], "v": v, "w": w}]


# Name: description, job. Unmentioned properties are those of GRAIN.
CASES = {
    "normal": ("free oscillation along the normal", {"rows": PAIR, "steps": 1000, "initial": start([0.1, 0, 0])}),
    "shear": ("free oscillation across the normal, both spin",
              {"rows": PAIR, "steps": 1000, "initial": start([0, 0.1, 0.05])}),
    "rolling": ("spins about all axes, one particle held",
                {"rows": PAIR, "steps": 1000, "sets": [held()], "initial": start(STILL, [30.0, -50.0, 80.0])}),
    "tension": ("pulled apart until the bond breaks",
                {"rows": PAIR, "steps": 4000, "sets": [held(), held([1], [0.05, 0, 0], name="moved")]}),
    "shear break": ("pressed and sheared without spin: the bond breaks, then friction",
                    {"rows": PAIR, "steps": 2000, "sets": [held(w=STILL), held([1], [-0.03, 0.3, 0], STILL, "moved")]}),
    "shear under pressure": ("the same with bonds that pressure strengthens (mu_1 0.5, coupling linear)",
                             {"rows": PAIR, "steps": 2000, "bond_friction": 0.5, "coupling": "linear",
                              "sets": [held(w=STILL), held([1], [-0.03, 0.3, 0], STILL, "moved")]}),
    "shear under tension": ("stretched and sheared: tension takes from the strength in shear",
                            {"rows": PAIR, "steps": 2000, "bond_friction": 0.5, "coupling": "linear",
                             "sets": [held(w=STILL), held([1], [0.01, 0.3, 0], STILL, "moved")]}),
    "rolling along": ("pressed and moved across, both spin freely: they roll on each other, the bond holds",
                      {"rows": PAIR, "steps": 4000, "sets": [held(), held([1], [-0.03, 0.3, 0], name="moved")]}),
    "collision": ("two free particles meet obliquely, no bond",
                  {"rows": APART, "steps": 600, "bonded": False, "initial": start([-1.0, 0.5, 0], [3.0, -5.0, 20.0])}),
    "sliding": ("two free particles meet nearly sideways, no bond: they slide and spin up",
                {"rows": APART, "steps": 600, "bonded": False, "initial": start([-0.5, 3.0, 0.4])}),
    "rebound": ("a weak bond is torn; the free particle falls back under 10 000 times gravity and bounces, spinning up",
                {"rows": PAIR, "steps": 1000, "tension": 4e6, "gravity": [-1e5, 0.0, 0.0], "sets": [held()],
                 "initial": start([1.5, 0.3, 0.1])}),
    "damping": ("oscillation with damping 0.7, one particle held",
                {"rows": PAIR, "steps": 400, "damping": 0.7, "sets": [held()],
                 "initial": start([0.1, 0.05, 0], [3.0, -5.0, 20.0])}),
    "gravity": ("chain of 12 let go at one end under 10 000 times gravity, damping 0.3",
                {"rows": chain(), "steps": 2000, "damping": 0.3, "gravity": [0.0, -9.81e4, -3e4], "sets": [held()]}),
    "chain": ("chain of 12 pulled at one end", {"rows": chain(), "steps": 2000, "damping": 0.1, "sets": [
        held(), held([11], [0.05, 0.02, 0], name="moved")]}),
    "lattice": ("180 spheres compressed until they fail, damping 0.3", lattice_job(0.3)),
    "lattice undamped": ("the same without damping", lattice_job(0.0)),
}

# Spins a hundred times those of "rolling", so that terms of first order in the angle of a step exceed round-off; the bonds
# hold. Not held to 1e-9 from the first steps on: YADE's own turn of the shear force is one of these.
FAST = {
    "fast rolling": ("spins of 3000 to 8000 rad/s, one particle held",
                     {"rows": PAIR, "steps": 1000, "sets": [held()], "initial": start(STILL, [3e3, -5e3, 8e3]),
                      "tension": 1e12, "shear": 1e12}),
}

# The definition; that of YADE; the case that shows the difference; choices that leave the codes different; whether
# these choices instead make the codes equal in another way.
DIFFERENCES = [
    ("shear arms", "YADE multiplies the translation by (r1 + r2)/d and turns with full radii (avoidGranularRatcheting); "
     "off: both use the contact point", "shear", {"yade": {"arms": "ratcheting"}}, False),
    ("start", "YADE counts v dt of shear before the first step; here velocities are given after the first forces",
     "shear", {"yade": {"start": "plain"}}, False),
    ("start under gravity", "YADE's first kick is a whole one, gneiss' a half one: half of it is taken back beforehand",
     "gravity", {"yade": {"start": "plain"}}, False),
    ("new pairs", "YADE measures the overlap of a pair from that at its first step in contact, and skips that step's "
     "shear; here both are set right from Python", "collision", {"yade": {"fresh": "plain"}}, False),
    ("increments", "YADE takes the shear of a step with the normal and the arms of its end, and twists the old force "
     "alone; gneiss with those of its middle, and twists half the increment too; here added before YADE's law",
     "fast rolling", {"yade": {"increment": "end"}}, False),
    ("contacts that close or open within a step", "YADE gives them the whole overlap at its end, or nothing; gneiss their "
     "share of the step; here set from Python", "rebound", {"yade": {"crossing": "whole"}}, False),
    ("friction of broken bonds", "YADE keeps the friction angle a bond was made with (0 here) and limits the breaking "
     "step by the bond's strength; here set from Python in the step of the break", "shear break",
     {"yade": {"friction": "none"}}, False),
    ("strength under pressure", "with frictionAngle = atan(mu) pressure strengthens YADE's bonds in shear and tension weakens "
     "them; in gneiss so do bond_friction and coupling linear, here left out", "shear break",
     {"yade": {"friction": "coulomb"}}, False),
    ("damping sign", "YADE takes the sign of v + dt F/(2 m); gneiss that of the last half step, or YADE's with "
     "damping.background.velocity: instant", "damping", {"gneiss": {"velocity": "half_step"}}, False),
    ("damping sign, the other way", "YADE made to take the sign of the last half step, from Python",
     "damping", {"gneiss": {"velocity": "half_step"}, "yade": {"damping": "past"}}, True),
    ("damping form", "gneiss' vector form, against the velocity as a whole", "damping", {"gneiss": {"damping": "nonviscous_vector"}}, False),
    ("arms at the radius", "gneiss with law.contact_arm: radius", "shear", {"gneiss": {"contact_arm": "radius"}}, False),
]


def job_of(case, **more):
    given = {**CASES, **FAST}[case][1]
    job = {**GRAIN, "sets": [], **{k: v for k, v in given.items() if k != "rows"}, **more}
    job["yade"] = {**SAME, **more.get("yade", {})}
    job["spheres"] = specimen(case.replace(" ", "-"), given["rows"])
    return job


def folder(case, change=None, steps=None):
    mark = "-".join([f"{v}" for half in (change or {}).values() for v in half.values()] + ([str(steps)] if steps else []))
    return f"steps/{case.replace(' ', '-')}{'-' + mark if mark else ''}"


def measure(case, change=None, steps=None):
    """The result of jobs.apart, the two runs and the job; `steps` in place of the job's own number."""
    job = job_of(case, **(change or {}), **({"steps": steps} if steps else {}))
    own, peer = jobs.both(folder(case, change, steps), job)
    return jobs.apart(job, own, peer), own, peer, job


def broken(run):
    return int(run["broken_tension"][-1]), int(run["broken_shear"][-1])


def calm(job, own, peer):
    """The time over which two runs are compared: all of it, or half the time to the first break if many bonds break,
    after which round-off decides which bond breaks next."""
    many = [run["step"][np.argmax(run["broken_tension"] + run["broken_shear"] > 0)] for run in (own, peer)
            if sum(broken(run)) > 10]
    return int(min(many)) // 2 if many else job["steps"]


def order(increment):
    """The difference over the step: [(dt, difference at the end)]. With "middle" only YADE's rotation of the shear
    force remains, of first order; with "end" the increments add to it."""
    found = []
    for halvings in range(3):
        job = job_of("fast rolling", yade={"increment": increment})
        job.update(dt=job["dt"] / 2**halvings, steps=job["steps"] * 2**halvings, snapshot_every=2**halvings,
                   every=2**halvings)
        own, peer = jobs.both(f"steps/fast-rolling-{increment}-dt{halvings}", job)
        found.append((job["dt"], jobs.worst(jobs.apart(job, own, peer), job["steps"])))
    return found
