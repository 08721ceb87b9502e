"""Jobs: the same test for YADE and for gneiss, carried out once and kept in runs/validate.

A job is a dictionary (JSON):
  spheres             file of rows x y z r, m
  density, contact_modulus, kratio, friction, tension, shear      kg/m3, Pa, 1, 1, Pa (sigma_c), Pa (tau_c); harmonic law
  bond_friction, coupling   mu_1 of intact bonds, 1; law.coupling of gneiss; left out: none (YADE's own is linear)
  interaction_range   bonds over gaps up to this times r_i + r_j; passive gaps
  bonded              False: no bonds
  damping             coefficient of the component form; gravity [3] m/s2
  dt, steps           s; both codes take exactly these steps
  every               rows of reactions and broken bonds every so many steps; snapshot_every: positions
  velocities          True: velocities and spins in the snapshots too
  sets                [{name, ids, v: [3], w: [3]}] prescribed components, None: free; a table [[time, value], ...]: linear
                      between its points
  pressure            {value, ramp}: of a membrane, Pa, that comes from 0 in `ramp` s and keeps its directions; gneiss finds the
                      skin. yade["skin"]: the same areas as rows [3] of all particles, m2 (own.skin)
  initial             [{ids, v, w}] velocities at the start
  ends, axis, peak_drop    of a laboratory test: names of two sets, 0 to 2, stop once the load fell by this part
  yade, gneiss        choices of one code alone (peer.py, own.py)

Result: step[n], reaction[n, sets, 3] (N, on the set), broken_tension[n], broken_shear[n], snapshot_step[m],
snapshot[m, particles, 3 or 9], broken[b, 2] (particles of broken bonds at the end), bonds, seconds, steps_taken. Row n belongs to the instant after n steps.
"""
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import own
import study

HERE = Path(__file__).resolve().parent
RUNS = Path(os.environ.get("GNEISS_VALIDATE", study.ROOT / "runs" / "validate"))
YADE_TIME = 4 * 3600
STARTED = time.time()
KEPT_ONLY = False  # missing YADE runs raise NotKept


class NotKept(Exception):
    """A run of YADE that was not allowed to start."""


def yade_program():
    return shutil.which("yade")


def digest(*things):
    h = hashlib.sha256()
    for thing in things:
        h.update(thing if isinstance(thing, bytes) else str(thing).encode())
    return h.hexdigest()[:16]


def packed(name, text, cut=None):
    """The folder under runs/validate/specimens with the packing.txt that `gneiss pack` makes of the text, made again if the text or the program has
    changed; then cut(folder) is called, which may write more files."""
    folder = RUNS / "specimens" / name
    stamp, note = digest(text, Path(study.PROGRAM).read_bytes()), folder / "made-from"
    if note.exists() and note.read_text() == stamp:
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pack.yaml").write_text(text)
    done = study.call(["pack", str(folder / "pack.yaml"), "--out", str(folder)])
    if done.returncode != 0:
        raise RuntimeError(f"gneiss pack {name}: {done.stderr}")
    if cut:
        cut(folder)
    note.write_text(stamp)
    return folder


def write_rows(path, rows):
    path.write_text("".join(" ".join(repr(v) for v in row) + "\n" for row in rows.tolist()))


def own_half(job):
    return {k: v for k, v in job.items() if k != "yade"}


def peer_half(job):
    return {k: v for k, v in job.items() if k not in ("gneiss", "threads")}


def kept(path, key):
    if not path.exists() or (study.FRESH and path.stat().st_mtime < STARTED):
        return None
    with np.load(path, allow_pickle=False) as found:
        return dict(found) if str(found["key"]) == key else None


def keep(path, key, result):
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part.npz")
    np.savez(part, **{**result, "key": key})
    part.rename(path)
    return kept_now(path)


def kept_now(path):
    with np.load(path, allow_pickle=False) as found:
        return dict(found)


def text_of(job):
    return json.dumps(job, sort_keys=True, default=lambda v: v.item())


def run_gneiss(name, job):
    """Runs the job in gneiss; a new build repeats it."""
    key = digest(text_of(own_half(job)), Path(job["spheres"]).read_bytes(), Path(own.__file__).read_bytes(),
                 Path(study.LIBRARY).read_bytes())
    path = RUNS / name / "gneiss.npz"
    found = kept(path, key)
    if found is None:
        print(f"  {name}: gneiss", file=sys.stderr, flush=True)
        found = keep(path, key, {**own.run(job), "load": os.getloadavg()[0]})
    return found


def run_yade(name, job):
    """Runs the job in YADE on one thread, because two runs on several threads differ."""
    script = HERE / "peer.py"
    key = digest(text_of(peer_half(job)), Path(job["spheres"]).read_bytes(), script.read_bytes())
    folder = RUNS / name
    path = folder / "yade.npz"
    found = kept(path, key)
    if found is not None:
        return found
    if KEPT_ONLY:
        raise NotKept(name)
    print(f"  {name}: YADE", file=sys.stderr, flush=True)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "job.json").write_text(text_of(peer_half(job)))
    out = folder / "out.npz"
    out.unlink(missing_ok=True)
    done = subprocess.run([yade_program(), "-n", "-x", f"-j{job.get('yade_threads', 1)}", str(script)], cwd=folder,
                          env=dict(os.environ, JOB=str(folder / "job.json"), OUT=str(out), QT_QPA_PLATFORM="offscreen"),
                          text=True, capture_output=True, timeout=YADE_TIME)
    if done.returncode != 0 or not out.exists():
        raise RuntimeError(f"{name}: YADE failed ({done.returncode}):\n{done.stdout[-1500:]}\n{done.stderr[-1500:]}")
    result = kept_now(out)
    out.unlink()
    return keep(path, key, result)


def both(name, job):
    peer = run_yade(name, job)
    return run_gneiss(name, job), peer


# --- comparing step by step ------------------------------------------------------------------------------

PARTS = {"displacement": slice(0, 3), "velocity": slice(3, 6), "spin": slice(6, 9)}


def apart(job, a, b):
    """Differences of two runs: {part: (steps, largest difference, largest value)}, at each instant over particles and components;
    parts that never move are left out. Reactions of prescribed components only: the others are not reactions."""
    n = min(len(a["snapshot_step"]), len(b["snapshot_step"]))
    assert np.array_equal(a["snapshot_step"][:n], b["snapshot_step"][:n])
    found = {}

    def add(part, steps, p, q):
        axes = tuple(range(1, p.ndim))
        if p.size and np.abs(q).max() > 0:
            found[part] = steps, np.abs(p - q).max(axis=axes), np.abs(q).max(axis=axes)

    for part, columns in PARTS.items():
        p, q = a["snapshot"][:n, :, columns], b["snapshot"][:n, :, columns]
        if part == "displacement":
            p, q = p - p[0], q - q[0]
        add(part, a["snapshot_step"][:n], p, q)
    n = min(len(a["step"]), len(b["step"]))
    assert np.array_equal(a["step"][:n], b["step"][:n])
    if job["sets"]:
        driven = np.array([[v is not None for v in s["v"]] for s in job["sets"]])
        add("reaction", a["step"][:n], a["reaction"][:n, driven], b["reaction"][:n, driven])
    return found


def worst(found, steps):
    """Largest difference within this number of steps relative to the largest value within them, over all components."""
    values = [0.0]
    for instants, difference, size in found.values():
        inside = (instants > 0) & (instants <= steps)  # at the start the codes keep different half-step velocities
        if size[inside].max() > 0:
            values.append(float(difference[inside].max() / size[inside].max()))
    return max(values)
