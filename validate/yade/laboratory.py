"""Level 2: uniaxial compression and tension of cylinders, the ends moved as the same lists of particles in both codes."""
from pathlib import Path

import numpy as np

import jobs
import own
import study

ROCK = {"density": 2650.0, "contact_modulus": 10e9, "kratio": 3.7, "friction": 0.5, "tension": 40e6, "shear": 40e6,
        "interaction_range": 0.05, "damping": 0.7}
DIAMETER, LENGTH = 0.023, 0.046
AREA = np.pi / 4 * DIAMETER**2
CLOSING = 0.4  # m/s, both ends together


def end_lists(rows):
    """Particles whose surface lies within a mean radius of an end plane."""
    z, r = rows[:, 2], rows[:, 3]
    depth = r.mean()
    return np.flatnonzero(z - r < depth).tolist(), np.flatnonzero(z + r > LENGTH - depth).tolist()


def job_of(spheres, sign=-1, closing=CLOSING, safety=0.9, until=0.03, **more):
    """sign -1: compression, 1: tension. `until`: strain at which the run ends at the latest. The step is `safety`
    times the one gneiss would choose."""
    rows = np.loadtxt(spheres)
    lower, upper = end_lists(rows)
    free = [None] * 3
    job = {"spheres": str(Path(spheres).resolve()), **ROCK,
           "sets": [{"name": "lower", "ids": lower, "v": [None, None, -sign * closing / 2], "w": free},
                    {"name": "upper", "ids": upper, "v": [None, None, sign * closing / 2], "w": free}],
           "ends": ["lower", "upper"], "axis": 2, "peak_drop": 0.5, **more}
    if "dt" not in job:
        job["dt"] = float(f"{safety * own.stable_step(job):.3g}")
    job["steps"] = int(until * LENGTH / (closing * job["dt"]))
    job["every"] = max(1, job["steps"] // 1500)
    job["steps"] -= job["steps"] % job["every"]
    job["snapshot_every"] = job["every"] * max(1, job["steps"] // job["every"] // 60)
    return job


def curve(job, run):
    """Strain and stress (Pa), both positive in the sense of the test."""
    closing = abs(job["sets"][0]["v"][2]) + abs(job["sets"][1]["v"][2])
    strain = run["step"] * job["dt"] * closing / LENGTH
    force = 0.5 * (run["reaction"][:, 0, 2] - run["reaction"][:, 1, 2])
    sign = 1 if job["sets"][0]["v"][2] > 0 else -1
    return strain, sign * force / AREA


def mean_strain(start, now):
    """Axial and mean lateral strain: affine fit of the displacements in the middle half."""
    middle = np.abs(start[:, 2] - LENGTH / 2) < LENGTH / 4
    basis = np.column_stack([np.ones(middle.sum()), start[middle]])
    slope = np.linalg.lstsq(basis, (now - start)[middle], rcond=None)[0]
    return slope[3, 2], 0.5 * (slope[1, 0] + slope[2, 1])


def readings(job, run):
    strain, stress = curve(job, run)
    peak = int(np.argmax(stress))
    rising = slice(0, peak + 1)
    part = (stress[rising] >= 0.01 * stress[peak]) & (stress[rising] <= 0.5 * stress[peak])
    modulus = np.polyfit(strain[rising][part], stress[rising][part], 1)[0]
    first, last = run["step"][rising][part][[0, -1]]
    inside = (run["snapshot_step"] >= first) & (run["snapshot_step"] <= last)
    start = run["snapshot"][0]
    axial, lateral = np.array([mean_strain(start, now) for now in run["snapshot"][inside]]).T
    half = stress[peak:] <= 0.5 * stress[peak]
    end = peak + int(np.argmax(half)) if half.any() else len(stress) - 1  # gneiss continues to the next snapshot
    return {"E": modulus, "nu": -np.polyfit(axial, lateral, 1)[0], "strength": stress[peak], "strain": strain[peak],
            "tension": int(run["broken_tension"][peak]), "shear": int(run["broken_shear"][peak]),
            "tension_end": int(run["broken_tension"][end]), "shear_end": int(run["broken_shear"][end]),
            "half_strain": strain[end] if half.any() else float("nan"),
            "bonds": int(run["bonds"]), "steps": int(run["steps_taken"]), "seconds": float(run["seconds"])}


# --- specimens -------------------------------------------------------------------------------------------

PACKED = {"pack-1": 1, "pack-2": 2, "pack-3": 3, "pack-4": 4, "pack-5": 5}  # name: seed
BESIDE_YADE = ("rock-b", "pack-1", "pack-2", "rock-c", "rock-a")
PACK_SCENE = """specimen:
  cylinder: {{diameter: 23 mm, height: 46 mm}}
  particles: 2000
  packing: {{size_ratio: 3, overlap: passive}}
run: {{seed: {seed}}}
"""


def packing(name):
    """File of a packing; made by `gneiss pack` when it is not there. Made again when its scene or the program changes."""
    if name not in PACKED:
        return study.ROOT / "scenes" / "specimens" / f"{name}.txt"
    return jobs.packed(name, PACK_SCENE.format(seed=PACKED[name])) / "packing.txt"


def shifted(name, number):
    """The packing with every coordinate changed by a relative 1e-12: shows the effect of chaos."""
    rows = np.loadtxt(packing(name))
    rows[:, :3] *= 1 + 1e-12 * np.random.default_rng(number).uniform(-1, 1, rows[:, :3].shape)
    path = jobs.RUNS / "specimens" / f"{name}-shifted-{number}.txt"
    text = "".join(" ".join(repr(v) for v in row) + "\n" for row in rows.tolist())
    if not path.exists() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return path


TESTS = {"UCS": {"sign": -1, "closing": 0.4, "until": 0.03}, "tension": {"sign": 1, "closing": 0.1, "until": 0.008}}
EQUAL = {"yade": {"fresh": "aligned"}}


def job_for(test, name, number=0, **more):
    path = shifted(name, number) if number else packing(name)
    return job_of(path, **TESTS[test], **{**EQUAL, **more})


def name_for(test, name, number=0, mark=""):
    return f"{test.lower()}-{name}" + (f"-shifted-{number}" if number else "") + mark


# Bonds that pressure strengthens and tension weakens: YADE's frictionAngle = atan(bond_friction). Friction as before once broken.
FRICTIONAL = {"bond_friction": 0.5, "coupling": "linear"}
FRICTIONAL_ROCKS = ("rock-b", "rock-c", "rock-a")


# --- runs ------------------------------------------------------------------------------------------------

CHAOS = {"rock-b": (8, 3), "pack-2": (8, 3)}  # shifted copies run in gneiss and in YADE; elsewhere:
CHAOS_ELSEWHERE = (4, 0)

# On rock-b: the effect of YADE's own definitions, and of gneiss' own, on the test.
VARIANTS = [
    ("the same definitions", {}),
    ("YADE's shear arms (avoidGranularRatcheting)", {"yade": {"fresh": "aligned", "arms": "ratcheting"}}),
    ("YADE's new pairs", {"yade": {"fresh": "plain"}}),
    ("YADE's start (shear before the first step)", {"yade": {"fresh": "aligned", "start": "plain"}}),
    ("YADE: no friction on broken bonds (frictionAngle = 0)", {"yade": {"fresh": "aligned", "friction": "none"}}),
    ("YADE: frictionAngle = atan(mu): pressure strengthens bonds", {"yade": {"fresh": "aligned", "friction": "coulomb"}}),
    ("YADE as most scripts have it: its arms, pairs, start, frictionAngle = atan(mu)",
     {"yade": {"fresh": "plain", "start": "plain", "arms": "ratcheting", "friction": "coulomb"}}),
    ("gneiss: damping by the velocity of the last half step", {"gneiss": {"velocity": "half_step"}}),
    ("gneiss: vector form of the damping", {"gneiss": {"damping": "nonviscous_vector"}}),
    ("gneiss: law.contact_arm: radius", {"gneiss": {"contact_arm": "radius"}}),
]


def changes_yade(change):
    return "yade" in change


def run_test(test, name):
    """Job and both codes' runs; gneiss' and YADE's strength, E and nu on the shifted copies: {code: [(UCS, E, nu)]}."""
    job = job_for(test, name)
    own_run, peer_run = jobs.both(name_for(test, name), job)
    shifts = {"gneiss": [], "YADE": []}
    if test == "UCS":
        copies = CHAOS.get(name, CHAOS_ELSEWHERE)
        for code, run, count in zip(shifts, (jobs.run_gneiss, jobs.run_yade), copies):
            for number in range(1, count + 1):
                other = job_for(test, name, number, dt=job["dt"])
                try:
                    r = readings(other, run(name_for(test, name, number), other))
                except jobs.NotKept:
                    continue
                shifts[code].append((r["strength"], r["E"], r["nu"]))
    return job, own_run, peer_run, shifts


def run_variants():
    """(description, job, readings of gneiss or None, readings of YADE or None) of each variant on rock-b."""
    rows = []
    for number, (what, change) in enumerate(VARIANTS):
        job = job_for("UCS", "rock-b", **change)
        mark = "" if number == 0 else f"-variant-{number}"
        name = name_for("UCS", "rock-b", mark=mark)
        try:
            peer_run = jobs.run_yade(name, job) if number == 0 or changes_yade(change) else None
        except jobs.NotKept:
            continue
        own_run = jobs.run_gneiss(name, job) if number == 0 or not changes_yade(change) else None
        rows.append((what, *(readings(job, r) if r is not None else None for r in (own_run, peer_run))))
    return rows


def run_frictional():
    """{name: (job, gneiss' run, YADE's run, strengths on shifted copies in gneiss)} with FRICTIONAL."""
    found = {}
    for name in FRICTIONAL_ROCKS:
        job = job_for("UCS", name, **FRICTIONAL)
        try:
            own_run, peer_run = jobs.both(name_for("UCS", name, mark="-frictional"), job)
        except jobs.NotKept:
            continue
        strengths = []
        for number in range(1, CHAOS_ELSEWHERE[0] + 1):
            other = job_for("UCS", name, number, dt=job["dt"], **FRICTIONAL)
            strengths.append(readings(other, jobs.run_gneiss(name_for("UCS", name, number, "-frictional"), other))["strength"])
        found[name] = job, own_run, peer_run, strengths
    return found


def run_packings():
    """Strength, E and nu in gneiss over all packings of 2000 spheres: {name: readings}, per test."""
    found = {}
    for test in TESTS:
        found[test] = {}
        for name in ("rock-b", *PACKED):
            job = job_for(test, name)
            found[test][name] = readings(job, jobs.run_gneiss(name_for(test, name), job))
    return found
