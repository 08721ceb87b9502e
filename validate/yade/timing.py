"""Running times of both codes on the same compression tests."""
import json
import os
import statistics
import subprocess
import time

import numpy as np

import jobs
import laboratory as lab
import own
import page
import study

SPECIMENS = ("rock-b", "rock-a")
STEPS, TURNS = 300, 3
SCRIPT = study.ROOT / "bench" / "peers" / "yade_ucs.py"

INTRO = """## Running time

The same compression of the same packing; seconds per step over {steps} steps of the loaded, unbroken specimen, medians of {turns} turns in
which the codes take turns. `to the peak`: the simulated time to the peak in steps of the code's own choice (YADE: 0.4 of
`PWaveTimeStep()`; gneiss: 0.9 of its limit) and in the same steps (gneiss' choice, which YADE bears too), at that speed. gneiss:
double precision, with history rows, without energies. YADE -j2 does not repeat its own results; -j1 does.
"""


def yade_seconds(name, threads):
    """Returns (seconds per step, the code's own step)."""
    folder = jobs.RUNS / "time"
    folder.mkdir(parents=True, exist_ok=True)
    result = folder / "result.json"
    result.unlink(missing_ok=True)
    done = subprocess.run(["yade", "-n", "-x", f"-j{threads}", str(SCRIPT)], cwd=folder, capture_output=True, text=True, check=False,
                          env=dict(os.environ, QT_QPA_PLATFORM="offscreen", PACKING=str(lab.packing(name)), STEPS=str(STEPS),
                                   RESULT=str(result)))
    if not result.exists():
        raise RuntimeError(f"YADE left no time: {done.stderr[-1000:]}")
    found = json.loads(result.read_text())
    return found["seconds"] / found["steps"], found["dt"]


def own_seconds(name, threads):
    job = {**lab.job_for("UCS", name), "threads": threads}
    with own.World(own.scene(job)) as world:
        world.step(50)
        began = time.perf_counter()
        world.step(STEPS)
        return (time.perf_counter() - began) / STEPS, job["dt"]


def section(options):
    codes = [("gneiss, 1 thread", lambda n: own_seconds(n, 1)), ("gneiss, 2 threads", lambda n: own_seconds(n, 2)),
             ("YADE -j1", lambda n: yade_seconds(n, 1)), ("YADE -j2", lambda n: yade_seconds(n, 2))]
    rows, loads = [], [os.getloadavg()[0]]
    for name in SPECIMENS:
        job = lab.job_for("UCS", name)
        run = jobs.run_gneiss(lab.name_for("UCS", name), job)
        strain = lab.readings(job, run)["strain"]
        simulated = strain * lab.LENGTH / lab.TESTS["UCS"]["closing"]
        found = {code: [] for code, _ in codes}
        for _ in range(TURNS):
            for code, measure in codes:
                found[code].append(measure(name))
            loads.append(os.getloadavg()[0])
        base = statistics.median(s for s, _ in found["gneiss, 1 thread"])
        for code, values in found.items():
            per_step, dt = statistics.median(s for s, _ in values), values[0][1]
            low, high = min(s for s, _ in values), max(s for s, _ in values)
            rows.append([name, int(run["bonds"]), code, f"{1e3*per_step:.3g} ({1e3*low:.3g} - {1e3*high:.3g})",
                         f"{per_step/base:.3g}", f"{1e9*dt:.3g}", f"{simulated/dt*per_step:.3g}",
                         f"{simulated/job['dt']*per_step:.3g}"])
    busy = np.max(loads) > 0.5 * (os.cpu_count() or 1) + 1
    note = (f"\nLoad average {min(loads):.1f} to {max(loads):.1f} on {os.cpu_count()} threads"
            + (": **the machine was shared with other work; these times say little**, `./do validate --time` on a quiet one measures "
               "them again." if busy else "."))
    head = ["UCS of", "bonds", "code", "ms per step (least - most)", "over gneiss, 1 thread", "own step ns", "s to the peak, own step",
            "the same step"]
    return "\n".join([INTRO.format(steps=STEPS, turns=TURNS), page.table(head, rows), note])
