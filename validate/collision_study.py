"""Oblique collisions with friction, and rows of balls, beside the same law integrated finely: the errors of rebounds over the number of steps per
contact; the ledger of one dropped grain. Fills tables of docs/evidence/collisions.md; a few minutes of one core.

    /usr/bin/python3 validate/collision_study.py [rows] [oblique] [drop]

The integrator here shares nothing with the engine: explicit, of contacts alone (no places, no turning normals), with
8000 steps per contact, all collisions at once.
"""
import json
import shutil
import sys

import numpy as np

import study

R, DENSITY, KN = 1e-3, 2500.0, 1e5
MASS = DENSITY * 4 / 3 * np.pi * R**3
FINE = 8000
FRICTIONS, KRATIOS, RESTITUTIONS = [0.1, 0.3, 0.5, 1.0], [1.0, 2.0, 3.7, 10.0], [1.0, 0.8, 0.5]
STEPS = [10, 20, 40, 100, 400]
PAIRS = 60  # number of pairs of every combination; two spheres each
ROWS = 20  # number of rows of balls, for every length and restitution; the first has equal ones
SPEED = 1e-4 * R * np.sqrt(2 * KN / MASS)  # Speed of approach for overlaps of 1e-4 of the radius, with normals that hardly turn.


def damping_fraction(restitution):
    return 0.0 if restitution == 1 else -np.log(restitution) / np.hypot(np.pi, np.log(restitution))


# --- oblique collisions ---

def rebounds(slip, mu, kratio, restitution):
    """Slip [n][2] and speed of parting over that of approach; all arguments are arrays over collisions. Linear
    springs along and across the normal, a dashpot along it, radial return at mu times the compressive force."""
    inverse_n, inverse_t = 2 / MASS, 7 / MASS  # inverse mass: 1/m + r^2/I = 3.5/m for each sphere
    omega = np.sqrt(KN * inverse_n)
    dt = np.pi / omega / FINE
    dashpot = 2 * np.array([damping_fraction(c) for c in restitution]) * np.sqrt(KN / inverse_n)
    overlap, speed, slip = np.zeros(len(mu)), np.full(len(mu), SPEED), SPEED * slip
    force, open_ = np.zeros_like(slip), np.zeros(len(mu), bool)
    for _ in range(2 * FINE):
        along = np.where(open_, 0.0, KN * overlap + dashpot * speed)
        speed -= along * inverse_n * dt
        overlap += speed * dt
        open_ |= overlap <= 0
        if open_.all():
            return slip / SPEED, -speed / SPEED
        force -= (KN / kratio * dt)[:, None] * slip
        limit, size = mu * np.maximum(along, 0), np.hypot(*force.T)
        force *= np.minimum(1.0, limit / np.maximum(size, 1e-300))[:, None]
        slip += np.where(open_[:, None], 0.0, force * inverse_t * dt)
    raise RuntimeError("a contact lasts")


def oblique_scene(random, mu, kratio, restitution, slips):
    """Pairs far from each other, with the slip of each from velocities and spins, that collide at any phase of a step."""
    contact = np.pi / np.sqrt(2 * KN / MASS)
    rows, sets = [], []
    for k, slip in enumerate(slips):
        gap = SPEED * contact / 10 * random.uniform(1, 2)
        rows += [[0, 0, 0.01 * k, R], [2 * R + gap, 0, 0.01 * k, R]]
        sliding = random.uniform(-2, 2, 2)  # the rest of the slip is spin
        spin = (sliding - slip) * SPEED / R
        split = random.uniform(0, 1)
        sets += [{"name": f"a{k}", "select": {"ids": [2 * k]},
                  "initial_velocity": [SPEED / 2, *(SPEED * sliding)],
                  "initial_spin": [0, *(split * np.array([spin[1], -spin[0]]))]},
                 {"name": f"b{k}", "select": {"ids": [2 * k + 1]}, "initial_velocity": [-SPEED / 2, 0, 0],
                  "initial_spin": [0, *((1 - split) * np.array([spin[1], -spin[0]]))]}]
    return {"dimension": 3, "specimen": {"particles": rows, "group": 0},
            "materials": [{"name": "m", "density": DENSITY, "normal_stiffness": KN, "kratio": kratio, "friction": mu}],
            "law": {"stiffness": "uniform", "contact_arm": "radius"}, "damping": {"contact": {"restitution": restitution}},
            "sets": sets, "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "time": {"end": 4 * contact},
            "output": {"snapshots": 0, "history_rows": 2}, "run": {"threads": 1}}


def slip_of(velocity, spin):
    """Slip of the first sphere's surface over the second's at the contact between them, along y and z."""
    v, w = velocity[0::2] - velocity[1::2], spin[0::2] + spin[1::2]
    return np.stack([v[:, 1] + R * w[:, 2], v[:, 2] - R * w[:, 1]], axis=1)


def state_after(scene, steps):
    folder = study.RUNS / "collisions"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "scene.yaml").write_text(json.dumps(scene))
    done = study.call(["run", str(folder / "scene.yaml"), "--out", str(folder / "out"), "--quiet",
                       "--set", f"time.contact_steps={steps}"])
    if done.returncode:
        raise RuntimeError(done.stderr)
    import h5py

    with h5py.File(folder / "out" / "results.h5", "r") as file:
        return file["particles/velocity"][()], file["particles/spin"][()]


def oblique():
    """Errors of the slip after the collision, over the speed of approach: {mu: {steps: array}}, and of the normal speed."""
    random = np.random.default_rng(20)
    across, along = ({mu: {n: [] for n in STEPS} for mu in FRICTIONS} for _ in range(2))
    for mu in FRICTIONS:
        for kratio in KRATIOS:
            for restitution in RESTITUTIONS:
                angle, size = random.uniform(0, 2 * np.pi, PAIRS), random.uniform(0, 6, PAIRS)
                slips = size[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
                want, parting = rebounds(slips, *(np.full(PAIRS, x) for x in (mu, kratio, restitution)))
                scene = oblique_scene(random, mu, kratio, restitution, slips)
                for n in STEPS:
                    velocity, spin = state_after(scene, n)
                    got = slip_of(velocity, spin) / SPEED
                    across[mu][n] += list(np.hypot(*(got - want).T))
                    normal = (velocity[1::2, 0] - velocity[0::2, 0]) / SPEED
                    along[mu][n] += list(np.abs(normal - parting))
    return across, along


def oblique_table():
    across, along = oblique()
    rows = []
    for mu in FRICTIONS:
        for n in STEPS:
            e = np.array(across[mu][n])
            rows.append([mu, n, f"{e.mean():.3f}", f"{np.quantile(e, 0.9):.3f}", f"{e.max():.3f}",
                         f"{100 * np.mean(e > 0.1):.1f}", f"{np.max(along[mu][n]):.4f}"])
    text = study.table(["mu", "steps per contact", "mean error", "nine in ten below", "worst", "% beyond 0.1",
                        "worst along the normal"], rows)
    return f"Of {len(KRATIOS) * len(RESTITUTIONS) * PAIRS} collisions each:\n\n{text}"


# --- rows of balls ---

def mass_of(radius):
    return DENSITY * 4 / 3 * np.pi * radius**3


def shortest(mass):
    """Duration of the shortest contact of each row."""
    return np.pi / np.sqrt(KN * (1 / mass[..., :-1] + 1 / mass[..., 1:]).max(axis=-1))


def rows_after(mass, restitution):
    """Velocities [row][ball] of balls in rows: the first ball hits, at speed 1, the others, which rest and touch."""
    dashpot = 2 * np.array([damping_fraction(c) for c in restitution])[:, None] * np.sqrt(
        KN / (1 / mass[:, :-1] + 1 / mass[:, 1:]))
    dt = shortest(mass)[:, None] / FINE
    x, v = np.zeros(mass.shape), np.zeros(mass.shape)
    v[:, 0] = 1.0
    for _ in range(40 * FINE):
        u, closing = x[:, :-1] - x[:, 1:], v[:, :-1] - v[:, 1:]
        force = np.where(u > 0, KN * u + dashpot * closing, 0.0) * dt
        v[:, :-1] -= force / mass[:, :-1]
        v[:, 1:] += force / mass[:, 1:]
        x += v * dt
    return v


def row_scene(random, radius, restitution):
    contact = shortest(mass_of(radius))
    speed = 1e-4 * R * np.sqrt(KN / MASS)
    at = np.concatenate([[0], np.cumsum(radius[:-1] + radius[1:])])
    gap = speed * contact / 10 * random.uniform(1, 2)
    at[0] -= gap
    return speed, {
        "dimension": 3, "specimen": {"particles": [[x, 0, 0, r] for x, r in zip(at, radius)], "group": 0},
        "materials": [{"name": "m", "density": DENSITY, "normal_stiffness": KN, "kratio": 0}],
        "law": {"stiffness": "uniform", "rotation": "off"}, "damping": {"contact": {"restitution": restitution}},
        "sets": [{"name": "a", "select": {"ids": [0]}, "initial_velocity": [speed, 0, 0]}],
        "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "time": {"end": 40 * contact + gap / speed},
        "output": {"snapshots": 0, "history_rows": 2}, "run": {"threads": 1}}


def rows_table():
    random = np.random.default_rng(21)
    rows = []
    for count in (3, 4, 5):
        cases = [(c, random.uniform(0.6, 1.5, count) * R if k else np.full(count, R))
                 for c in RESTITUTIONS for k in range(ROWS)]
        want = rows_after(mass_of(np.array([radius for _, radius in cases])), [c for c, _ in cases])
        errors = {n: [] for n in STEPS[:4]}
        for (c, radius), ideal in zip(cases, want):
            speed, scene = row_scene(random, radius, c)
            for n in errors:
                velocity, _ = state_after(scene, n)
                errors[n].append(np.max(np.abs(velocity[:, 0] / speed - ideal)))
        rows.append([count, *(f"{np.mean(errors[n]):.3f}, {np.max(errors[n]):.3f}" for n in errors)])
    return study.table(["balls", *(f"{n} steps per contact" for n in STEPS[:4])], rows)


# --- one grain by Hertz's law, dropped on a plane ---

DROP = {"radius": 5e-4, "young": 1e7, "poisson": 0.2, "height": 0.05, "end": 0.15}
G = 9.81


def dropped(restitution, steps):
    """(residual of the ledger, step) of gneiss."""
    path = study.RUNS / "collision" / "drop.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    r = DROP["radius"]
    path.write_text(json.dumps({
        "dimension": 3, "specimen": {"particles": [[0, 0, DROP["height"] + r, r]], "group": 0}, "gravity": [0, 0, -G], "law": {"stiffness": "hertz"},
        "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "m"}], "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]},
        "materials": [{"name": "m", "density": DENSITY, "young": DROP["young"], "poisson": DROP["poisson"], "restitution": restitution}],
        "time": {"end": DROP["end"], "contact_steps": steps}, "output": {"snapshots": 0, "history_rows": 100}}))
    done = study.run(f"collision/drop-{restitution}-{steps}", path, {"run.threads": 1})
    return done.residual, done.summary["dt"]


def work_of_spring(restitution, dt, phase):
    """Work of the forces of the spring over the collision by leap-frog, relative to the work of gravity; over a
    closed path it should be 0."""
    beta, r = damping_fraction(restitution), DROP["radius"]
    k = 4 / 3 * DROP["young"] / (2 * (1 - DROP["poisson"]**2)) * np.sqrt(r)
    m, x, v, spring, work, t, before = DENSITY * 4 / 3 * np.pi * r**3, DROP["height"], 0.0, 0.0, 0.0, 0.0, 0.0
    x += phase * dt * np.sqrt(2 * G * x)
    start = x
    while t < DROP["end"]:
        spring = k * max(-x, 0.0)**1.5
        c = 2 * np.sqrt(5 / 6) * beta * np.sqrt(m * 1.5 * k * np.sqrt(max(-x, 0.0)))
        work += 0.5 * (spring + before) * v * dt
        v += dt * ((spring - c / (1 + c * dt / (4 * m)) * v) / m - G) * (1 if t else 0.5)
        before = spring
        x += v * dt
        t += dt
    return work / (m * G * (start - x))


def drop_table():
    lines = []
    for restitution in (0.3, 0.5, 0.8, 1.0):
        for steps in (12, 24, 48, 96):
            residual, dt = dropped(restitution, steps)
            works = [work_of_spring(restitution, dt, phase) for phase in np.arange(8) / 8]
            lines.append([f"{restitution:g}", steps, f"{residual:.1e}", f"{min(works):.1e} to {max(works):.1e}"])
    return study.table(["restitution", "`time.contact_steps`", "residual over the work", "work of the spring alone, over the phase of the first contact"], lines)


TABLES = {"rows": rows_table, "oblique": oblique_table, "drop": drop_table}


def main():
    for name in [a for a in sys.argv[1:] if a in TABLES] or TABLES:
        study.put("collisions.md", f"table {name}", TABLES[name]())


if __name__ == "__main__":
    main()
