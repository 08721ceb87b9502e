"""A bed of 32 000 grains that flows down a rough incline, in gneiss, LAMMPS and LIGGGHTS, in turns.

    bench/grains.py --build FOLDER [--law linear|hertz] [--turns N] [--ranks 1|2] [--out FOLDER] [--update]

The constants are those of LAMMPS' chute bench: d 1, density 1, gravity 1 at 26 degrees, k_n 2e5, k_t 2/7 k_n, gamma_n 50 (no tangential
dashpot), mu 0.5, step 1e-4, skin 0.1, periodic along and across (40 x 20), a base of 800 frozen grains. gneiss pours and lets flow the bed once
(some minutes; kept in --out); every code gets its places, velocities and spins. `hertz`: the same bed by Hertz and Mindlin with E 2e7, nu 0.25,
restitution 0.9.

By --ranks 1 time is the processor time of one process, a longer run less a shorter one, so that other work on the machine
counts little; by --ranks 2 it is what the programs report of the steps by the clock, and waiting threads spin, as waiting ranks do. Ratios are taken within a turn. --update puts the
table into docs/evidence/performance.md.
"""
import argparse
import json
import os
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

import run_peers

WIDE, ACROSS, BASE, GRAINS = 40, 20, 800, 31200
GRAVITY = [0.4383711467890774, 0.0, -0.8987940462991670]  # 26 degrees
# m_eff gamma_n v_n = 2 a sqrt(k_n m_eff) v_n with m_eff = pi/12: a = gamma_n/2 sqrt(m_eff/k_n)
LAWS = {"linear": {"materials": [{"name": "grain", "density": 1, "normal_stiffness": 2e5, "kratio": 3.5, "friction": 0.5}],
                   "law": {"stiffness": "uniform"}, "damping": {"contact": {"fraction": 0.02860285102699278}}},
        "hertz": {"materials": [{"name": "grain", "density": 1, "young": 2e7, "poisson": 0.25, "friction": 0.5, "restitution": 0.9}],
                  "law": {"stiffness": "hertz"}}}
HELD = {"vx": 0, "vy": 0, "vz": 0, "wx": 0, "wy": 0, "wz": 0}
LENGTHS = 1220, 20  # steps of a longer and a shorter run, the same for all: two lists of gneiss and eight of the others are made in them
CODES = {"LAMMPS": ("lmp", "lammps_bed.in"), "LIGGGHTS": ("liggghts", "liggghts_bed.in")}


def scene(law, **more):
    return {"title": "chute", "dimension": 3, **LAWS[law], "gravity": GRAVITY,
            "sets": [{"name": "base", "select": {"ids": list(range(BASE))}, "motion": HELD}],
            "periodic": {"min": [0, 0, -2], "max": [WIDE, ACROSS, 120]}, **more}


def write(path, what):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(what, file)


def pour(program, out):
    """Returns the folder of the run that made the bed: a rough base, loose grains over it, ten units of time of gravity."""
    bed = os.path.join(out, "bed")
    if os.path.exists(os.path.join(bed, "results.h5")):
        return bed
    dice = random.Random(1)
    rows = [[x + 0.5, y + 0.5, dice.uniform(-0.25, 0.25), 0.5] for x in range(WIDE) for y in range(ACROSS)]
    across, along = ACROSS - 1, WIDE - 1
    for k in range(GRAINS):
        z, rest = divmod(k, across * along)
        x, y = divmod(rest, across)
        rows.append([(x + 0.5) * WIDE / along + dice.uniform(-0.01, 0.01), (y + 0.5) * ACROSS / across + dice.uniform(-0.01, 0.01),
                     1.3 + 1.03 * z + dice.uniform(-0.01, 0.01), 0.5])
    particles = os.path.join(out, "loose.txt")
    with open(particles, "w", encoding="utf-8") as file:
        file.writelines(" ".join(map(repr, row)) + "\n" for row in rows)
    path = os.path.join(out, "pour.yaml")
    write(path, scene("linear", specimen={"file": particles, "group": 0}, initial={"random_velocity": 0.3}, time={"end": 10},
                      output={"history_rows": 20, "snapshots": 0}))
    run_peers.call([program, "run", path, "--quiet", "--threads", "1", "--out", bed], timeout=3600)
    return bed


def data_file(bed, path):
    """The input of LAMMPS and LIGGGHTS for the bed."""
    import h5py

    with h5py.File(os.path.join(bed, "results.h5"), "r") as file:
        x, v, w = (file[f"particles/{name}"][()] for name in ("position", "velocity", "spin"))
    with open(path, "w", encoding="utf-8") as out:
        out.write(f"bed\n\n{len(x)} atoms\n1 atom types\n\n0 {WIDE} xlo xhi\n0 {ACROSS} ylo yhi\n-2 120 zlo zhi\n\nAtoms\n\n")
        out.writelines(f"{k + 1} 1 1.0 1.0 {p[0] % WIDE:.17g} {p[1] % ACROSS:.17g} {p[2]:.17g}\n" for k, p in enumerate(x))
        out.write("\nVelocities\n\n")
        out.writelines(f"{k + 1} " + " ".join(f"{c:.17g}" for c in (*a, *b)) + "\n" for k, (a, b) in enumerate(zip(v, w)))


def spent(command):
    """(processor seconds, output) of one program."""
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile("w+") as text:
        child = subprocess.Popen(command, cwd=folder, stdout=text, stderr=subprocess.STDOUT, env={**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "active"})
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = status
        text.seek(0)
        said = text.read()
    if status:
        raise run_peers.Failed(f"{' '.join(command)} failed:\n{said[-2000:]}")
    return usage.ru_utime + usage.ru_stime, said


def gneiss(options, bed, steps, short):
    path, rows = os.path.join(options.out, f"flow-{options.law}.yaml"), {}

    def one(count):
        write(path, scene(options.law, specimen={"from": bed, "group": 0}, neighbours={"skin": 0.1},
                          time={"step": 1e-4, "end": 1e-4 * count, "estimate": "bound", "on_unstable": "warn"},
                          output={"energy": "off", "history_rows": 1, "snapshots": 0, "checkpoint": "off"}))
        folder = os.path.join(options.out, "flow")
        shutil.rmtree(folder, ignore_errors=True)
        cpu, said = spent([options.program, "run", path, "--threads", str(options.ranks), "--out", folder])
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        seconds = summary["seconds"]
        rows.update(touching=summary["counts"]["contacts"], listed=int(re.search(r"(\d+) other pairs", said).group(1)),
                    rebuilds=1000 * summary["list_rebuilds"] / summary["steps"])
        return cpu, (seconds["total"] - seconds["setup"] - seconds["output"]) / summary["steps"]
    return finish(one, steps, short, rows, options.ranks)


def peer(code, options, data, steps, short):
    program, script = CODES[code]
    rows = {}

    def one(count):
        start = run_peers.mpirun(options.ranks) if options.ranks > 1 else []
        cpu, said = spent([*start, program, "-in", os.path.join(run_peers.PEERS, script), "-log", "none", "-var", "bed", data, "-var", "hertz",
                           str(int(options.law == "hertz")), "-var", "base", str(BASE), "-var", "steps", str(count)])
        found = re.search(r"RESULT contacts ([\d.e+]+)", said)
        loop = re.search(r"Loop time of (\S+) on \d+ procs for (\d+) steps", said)
        if not found or not loop:
            raise run_peers.Failed(f"{code}: expected `Loop time` and `RESULT contacts`, found:\n{said[-2000:]}")
        builds = re.search(r"Neighbor list builds = (\d+)", said)
        rows.update(touching=float(found.group(1)), listed=int(re.search(r"Total # of neighbors = (\d+)", said).group(1)),
                    rebuilds=1000 * int(builds.group(1)) / count if builds else float("nan"))
        return cpu, float(loop.group(1)) / int(loop.group(2))
    return finish(one, steps, short, rows, options.ranks)


def finish(one, steps, short, rows, ranks):
    first = one(short)[0] if ranks == 1 else 0.0
    last, clock = one(steps)
    rows["seconds"] = (last - first) / (steps - short) if ranks == 1 else clock
    return rows


def table(options, turns):
    labels = list(turns[0])
    what = "processor time of one process" if options.ranks == 1 else f"{options.ranks} threads or ranks, by the clock"
    lines = [f"| {options.law}, {GRAINS} grains on {BASE}, {what} | touching | listed | lists per 1000 steps | ms a step | M touching-steps/s | "
             "gneiss over it | least - most | fastest turn, ms | gneiss over it |", "| --- |" + " ---: |" * 9]
    fastest = {label: min(t[label]["seconds"] for t in turns) for label in labels}
    for label in labels:
        seconds = statistics.median(t[label]["seconds"] for t in turns)
        ratios = sorted(t[label]["seconds"] / t["gneiss"]["seconds"] for t in turns)
        row = turns[-1][label]
        lines.append(f"| {label} | {row['touching']:.0f} | {row['listed']} | {row['rebuilds']:.1f} | {1e3 * seconds:.2f} | "
                     f"{row['touching'] / seconds / 1e6:.1f} | {statistics.median(ratios):.2f} | {ratios[0]:.2f} - {ratios[-1]:.2f} | "
                     f"{1e3 * fastest[label]:.2f} | {fastest[label] / fastest['gneiss']:.2f} |")
    load = os.getloadavg()[0]
    return "\n".join(lines + ["", f"{len(turns)} turns, load average {load:.1f} on {os.cpu_count()} cores."])


def update(name, text):
    path = os.path.join(run_peers.ROOT, "docs", "evidence", "performance.md")
    with open(path, encoding="utf-8") as file:
        page = file.read()
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    if begin not in page:
        sys.exit(f"{path} has no place for {name}")
    with open(path, "w", encoding="utf-8") as file:
        file.write(page[:page.index(begin) + len(begin)] + f"\n\n{text}\n\n" + page[page.index(end):])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--build", required=True, help="build folder with gneiss")
    parser.add_argument("--law", choices=list(LAWS), default="linear")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--ranks", type=int, choices=(1, 2), default=1)
    parser.add_argument("--out", default=os.path.join(run_peers.ROOT, "bench", "out"))
    parser.add_argument("--update", action="store_true", help="put the table into the page")
    options = parser.parse_args()
    options.out, options.program = os.path.abspath(options.out), os.path.join(os.path.abspath(options.build), "gneiss")
    os.makedirs(options.out, exist_ok=True)
    bed = pour(options.program, options.out)
    data = os.path.join(options.out, "bed.data")
    if not os.path.exists(data):
        data_file(bed, data)
    codes = [code for code, (program, _) in CODES.items() if shutil.which(program)]
    turns = []
    for turn in range(options.turns):
        rows = {"gneiss": gneiss(options, bed, *LENGTHS), **{code: peer(code, options, data, *LENGTHS) for code in codes}}
        turns.append(rows)
        print(f"{turn + 1}/{options.turns} " + ", ".join(f"{k} {1e3 * r['seconds']:.2f} ms" for k, r in rows.items()), file=sys.stderr, flush=True)
    text = table(options, turns)
    print(text)
    if options.update:
        update(f"bed {options.law} {options.ranks}", text)


if __name__ == "__main__":
    main()
