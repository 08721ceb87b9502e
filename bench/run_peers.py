"""gneiss beside other codes on the same scenes, in turns, in one session.

run_peers.py --build FOLDER [--out FOLDER] [--repeats N] [--steps N] [--large] [--scene NAME ...]

Scenes: fcc-32k, a frictional lattice (LAMMPS, LIGGGHTS); fcc-500k, the same beyond the caches (LAMMPS; with --large);
rock-a, uniaxial compression of 10 225 bonded spheres (YADE, ESyS-Particle); t4-40k, t3-40k, falling blocks of finite
elements (CalculiX). What is compared is contact-steps, bond-steps or element-steps per second: touching pairs, intact
bonds or elements times the steps per second of wall time; set-up is left out everywhere. A code that is not installed,
or that fails, is left out with a note. Prints tables and writes peers.json, peers.md and peers.csv. Standard library only.
"""
import argparse
import csv
import datetime
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PEERS = os.path.join(ROOT, "bench", "peers")
UCS = os.path.join(ROOT, "scenes", "ucs-rock.yaml")
PACKING = os.path.join(ROOT, "scenes", "specimens", "rock-a.txt")
SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
MIN_TIME = 0.5  # seconds per gneiss measurement
TO_FAILURE = "to failure"  # key of results that are wall seconds of a whole test

# Code: program, Debian package.
CODES = {"LAMMPS": ("lmp", "lammps"), "LIGGGHTS": ("liggghts", "liggghts"), "YADE": ("yade", "yade"),
         "ESyS-Particle": ("esysparticle", "esys-particle"), "CalculiX": ("ccx", "calculix-ccx")}
WITHOUT_MPI = {"YADE", "CalculiX"}
# Scene: the items that it counts, and the rows that others are compared with.
SCENES = {"fcc-32k": ("contact", ["LAMMPS, 2 ranks"]), "fcc-500k": ("contact", ["LAMMPS, 2 ranks"]),
          "rock-a": ("bond", ["YADE -j2", "ESyS-Particle, 2 workers"]),
          "t4-40k": ("element", ["CalculiX, 2 threads", "CalculiX, 1 thread"]),
          "t3-40k": ("element", ["CalculiX, 2 threads", "CalculiX, 1 thread"])}
ELEMENTS = {"t4-40k": ("C3D4", 20), "t3-40k": ("CPE3", 141)}  # kind of element, cells per side, as in bench_step.cpp


class Failed(Exception):
    """A program failed or did not print the expected values."""


def call(command, extra=None, timeout=900):
    """Runs the command in a folder of its own and returns its output. Waiting OpenMP threads of all codes spin
    briefly."""
    environment = {"GOMP_SPINCOUNT": "20000", **os.environ, **(extra or {})}
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run(command, env=environment, cwd=folder, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, timeout=timeout, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise Failed(f"{' '.join(command)}: {error}") from error
    if done.returncode != 0:
        raise Failed(f"{' '.join(command)} failed ({done.returncode}):\n{done.stdout[-2000:]}")
    return done.stdout


def mpirun(processes):
    root = ["--allow-run-as-root"] if os.geteuid() == 0 else []
    # Open MPI requires ssh even if it starts no process on another machine.
    return ["mpirun", *root, "--mca", "plm_rsh_agent", "/bin/false", "--oversubscribe", "--bind-to", "none", "-np",
            str(processes)]


def result(items, steps, seconds, **more):
    return dict(more, items=items, steps=steps, seconds=seconds, speed=items * steps / seconds)


# --- gneiss -------------------------------------------------------------------------------------------


def kind_of_bench(unit):
    return "fem" if unit == "element" else "step"


def gneiss_models(bench, scene):
    """Models of the bench harness that represent the scene, by precision (or form)."""
    names = call([bench, "--large", "--benchmark_list_tests"]).split()
    kind = kind_of_bench(SCENES[scene][0])
    present = {name.split("/")[1] for name in names if name.startswith(kind + "/")}
    if kind == "fem":
        wanted = {"plain form": scene, "mixed form": scene + "-mixed"}
    else:
        wanted = {"double": scene, "mixed": scene + "-mixed"}
    return {precision: model for precision, model in wanted.items() if model in present}


def gneiss_steps(bench, model, precision, unit):
    """Times steps of gneiss with the widest instruction set, on 2 threads and on 1, by the bench harness."""
    text = call([bench, "--large", f"--benchmark_min_time={MIN_TIME}", "--benchmark_format=json",
                 f"--benchmark_filter=^{kind_of_bench(unit)}/{model}/threads:[12]/"])
    results = json.loads(text[text.index("{"):text.rindex("}") + 1])
    widest, rows = results["context"]["isa"], {}
    for entry in results["benchmarks"]:
        if entry.get("error_occurred"):
            raise Failed(f"{entry['name']}: {entry['error_message']}")
        if f"/{widest}/" in entry["name"]:
            threads = int(entry["threads"])
            label = f"gneiss, {threads} thread{'s' if threads > 1 else ''}, {precision}, {widest}"
            steps = entry["iterations"]
            rows[label] = result(entry[unit + "s"], steps,
                                 entry["real_time"] * SECONDS[entry["time_unit"]] * steps,
                                 threads=threads, precision=precision, isa=widest)
    if not rows:
        raise Failed(f"bench_step has no {kind_of_bench(unit)}/{model} with {widest}:\n{text[-2000:]}")
    return dict(sorted(rows.items(), key=lambda row: -row[1]["threads"]))


def gneiss_summary(program, *options):
    with tempfile.TemporaryDirectory() as folder:
        call([program, "run", UCS, "--quiet", "--threads", "2", "--out", folder, *options])
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as f:
            return json.load(f)


def gneiss_run(program):
    """A tenth of the real run, with its readings, history and snapshots at their normal pace."""
    summary = gneiss_summary(program, "--set", "time.end=0.6 ms", "--set", "output.history_rows=200",
                             "--set", "output.snapshots=2")
    seconds = summary["seconds"]
    return {"gneiss, whole run, 2 threads": result(summary["counts"]["bonds"], summary["steps"],
                                                   seconds["total"] - seconds["setup"], dt=summary["dt"],
                                                   phases=seconds)}


def gneiss_to_failure(program):
    """Runs the scene unchanged to its end; set-up and output are included."""
    summary = gneiss_summary(program)
    return {TO_FAILURE: {"seconds": summary["seconds"]["total"], "steps": summary["steps"], "time": summary["time"],
                         "dt": summary["dt"], "stop_reason": summary["stop_reason"]}}


# --- other codes --------------------------------------------------------------------------------------


def loop_of_lammps(text):
    """(steps, seconds) of the second run, contacts: LIGGGHTS reports them in the same words."""
    loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps", text)
    contacts = re.search(r"RESULT contacts ([\d.]+)", text)
    if len(loops) < 2 or not contacts:
        raise Failed(f"expected two `Loop time` lines and `RESULT contacts`, found:\n{text[-2000:]}")
    return int(loops[1][1]), float(loops[1][0]), float(contacts.group(1))


def granular(code, script, cells, ranks, steps):
    text = call([*mpirun(ranks), CODES[code][0], "-in", os.path.join(PEERS, script), "-log", "none", "-var", "cells",
                 str(cells), "-var", "steps", str(steps), "-var", "warm", str(steps // 6 + 1)],
                {"OMP_NUM_THREADS": "1"})
    steps, seconds, contacts = loop_of_lammps(text)
    return {f"{code}, {ranks} rank{'s' if ranks > 1 else ''}": result(contacts, steps, seconds, ranks=ranks)}


def scripted(label, command, items, steps, **settings):
    """Runs a Python script inside or in front of the other code; the script leaves its result in a file."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "result.json")
        call(command, {"STEPS": str(steps), "RESULT": path, **settings})
        try:
            with open(path, encoding="utf-8") as f:
                r = json.load(f)
        except (OSError, ValueError) as error:
            raise Failed(f"{' '.join(command)} left no result: {error}") from error
    return {label: result(r.pop(items), r.pop("steps"), r.pop("seconds"), **r)}


def bonded(label, command, steps):
    return scripted(label, command, "bonds", steps, QT_QPA_PLATFORM="offscreen", PACKING=PACKING)


def elements(scene, threads, steps):
    kind, cells = ELEMENTS[scene]
    return scripted(f"CalculiX, {threads} thread{'s' if threads > 1 else ''}",
                    [sys.executable, os.path.join(PEERS, "calculix_fem.py")], "elements", steps, KIND=kind,
                    CELLS=str(cells), THREADS=str(threads))


# --- measurements ---------------------------------------------------------------------------------


def missing_codes():
    found = {code for code, (program, _) in CODES.items() if shutil.which(program)}
    if not shutil.which("mpirun"):
        found &= WITHOUT_MPI
    return [code for code in CODES if code not in found]


def peers_of(scene, steps):
    """(code, measurement) of the other codes that have the scene."""
    lammps, liggghts = "lammps_fcc.in", "liggghts_fcc.in"
    yade, esys = os.path.join(PEERS, "yade_ucs.py"), os.path.join(PEERS, "esys_ucs.py")
    if scene == "fcc-32k":
        return [("LAMMPS", lambda: granular("LAMMPS", lammps, 20, 2, steps)),
                ("LAMMPS", lambda: granular("LAMMPS", lammps, 20, 1, steps)),
                ("LIGGGHTS", lambda: granular("LIGGGHTS", liggghts, 20, 2, steps))]
    if scene == "fcc-500k":
        return [("LAMMPS", lambda: granular("LAMMPS", lammps, 50, 2, max(steps // 6, 20)))]
    if scene in ELEMENTS:
        few = max(steps // 5, 20)  # A step of CalculiX takes as long as hundreds of steps of gneiss.
        return [("CalculiX", lambda: elements(scene, 2, few)), ("CalculiX", lambda: elements(scene, 1, few))]
    return [("YADE", lambda: bonded("YADE -j2", ["yade", "-n", "-x", "-j2", yade], steps)),
            ("YADE", lambda: bonded("YADE -j1", ["yade", "-n", "-x", "-j1", yade], steps)),
            ("ESyS-Particle", lambda: bonded("ESyS-Particle, 2 workers", [*mpirun(3), "esysparticle", esys], steps))]


def measurements(scene, build, steps, missing):
    """(code, measurement) in the order of a turn; each measurement returns rows {label: result}."""
    bench, program = os.path.join(build, "bench", "bench_step"), os.path.join(build, "gneiss")
    unit = SCENES[scene][0]
    own = [("gneiss", lambda m=model, p=precision: gneiss_steps(bench, m, p, unit))
           for precision, model in gneiss_models(bench, scene).items()]
    if scene == "rock-a":
        own += [("gneiss", lambda: gneiss_run(program)), ("gneiss", lambda: gneiss_to_failure(program))]
    return own + [(code, measure) for code, measure in peers_of(scene, steps) if code not in missing]


def progress(turn, repeats, scene, rows, unit):
    for label, row in rows.items():
        amount = f"{row['seconds']:.1f} s" if label == TO_FAILURE else f"{row['speed'] / 1e6:.2f} M {unit}-steps/s"
        print(f"  {turn + 1}/{repeats}  {scene}  {label}: {amount}", file=sys.stderr, flush=True)


def measure_scene(scene, options, missing, notes):
    """{label: results of all turns}; a peer that fails is dropped, with a note."""
    work, runs = measurements(scene, options.build, options.steps, missing), {}
    for turn in range(options.repeats):
        for entry in list(work):
            code, measure = entry
            try:
                rows = measure()
            except Failed as error:
                if code == "gneiss":
                    sys.exit(f"run_peers.py: {error}")
                notes.append(f"{code} failed on {scene} and is left out.")
                print(f"run_peers.py: {notes[-1]} {error}", file=sys.stderr)
                work.remove(entry)
                continue
            for label, row in rows.items():
                runs.setdefault(label, []).append(row)
            progress(turn, options.repeats, scene, rows, SCENES[scene][0])
    return runs


# --- tables -------------------------------------------------------------------------------------------


def summarise(scene, runs):
    """Rows {code, items, median, least, most, times: {reference: ratio}} of the codes' speeds."""
    unit, references = SCENES[scene]
    speeds = {label: sorted(r["speed"] for r in results) for label, results in runs.items() if label != TO_FAILURE}
    middle = {label: statistics.median(s) for label, s in speeds.items()}

    def times(label, reference):
        """Median of the ratios within the turns: a slow phase of the machine affects both programs."""
        pairs = zip(runs[label], runs[reference])
        return statistics.median(own["speed"] / other["speed"] for own, other in pairs)

    rows = [{"code": label, "items": runs[label][0]["items"], "median": middle[label], "least": s[0], "most": s[-1],
             "times": {r: times(label, r) for r in references if r in middle}}
            for label, s in speeds.items()]
    return {"scene": scene, "unit": f"{unit}-steps/s", "references": [r for r in references if r in middle],
            "rows": rows}


def to_failure(runs):
    """Wall seconds of the whole test: measured for gneiss, worked out from speed and step for YADE."""
    if TO_FAILURE not in runs:
        return None
    own = sorted(runs[TO_FAILURE], key=lambda r: r["seconds"])
    steps, time, reason = own[0]["steps"], own[0]["time"], own[0]["stop_reason"]
    seconds = [r["seconds"] for r in own]
    rows = [{"code": "gneiss, 2 threads, from start to failure", "steps": steps, "median": statistics.median(seconds),
             "least": seconds[0], "most": seconds[-1], "estimate": False}]
    for label in ("YADE -j2", "YADE -j1"):
        if label in runs:
            needed = time / runs[label][0]["dt"]
            estimates = sorted(needed * r["seconds"] / r["steps"] for r in runs[label])
            rows.append({"code": f"{label}, estimate", "steps": needed, "median": statistics.median(estimates),
                         "least": estimates[0], "most": estimates[-1], "estimate": True})
    return {"time": time, "stop_reason": reason, "rows": rows}


def speed_table(table):
    counts = [row["items"] for row in table["rows"]]
    unit = table["unit"].split("-")[0]
    what = {"bond": "bonds, elastic part", "contact": "frictional contacts", "element": "elements"}[unit]
    heads = "".join(f" times {r} |" for r in table["references"])
    lines = [f"| {table['scene']}, {counts[0]:.0f} {what} | M {table['unit']} | least - most |{heads}",
             "| --- | ---: | ---: |" + " ---: |" * len(table["references"])]
    for row in table["rows"]:
        times = "".join(f" {row['times'][r]:.1f} |" for r in table["references"])
        lines.append(f"| {row['code']} | {row['median'] / 1e6:.2f} | {row['least'] / 1e6:.2f} - "
                     f"{row['most'] / 1e6:.2f} |{times}")
    other = [f"{row['code']} has {row['items']:.0f}" for row in table["rows"]
             if abs(row["items"] - counts[0]) > 1e-3 * counts[0]]
    return lines + (["", "Counts differ: " + ", ".join(other) + "."] if other else [])


def failure_table(failure):
    lines = ["| rock-a, seconds from start to failure | steps | seconds | least - most |",
             "| --- | ---: | ---: | ---: |"]
    for row in failure["rows"]:
        lines.append(f"| {row['code']} | {row['steps']:.0f} | {row['median']:.1f} | {row['least']:.1f} - "
                     f"{row['most']:.1f} |")
    return lines + ["", f"gneiss: the whole program until \"{failure['stop_reason']}\", after "
                    f"{1e3 * failure['time']:.3g} ms of the test. Estimate: the same time in steps of the other code, "
                    "at the speed of its elastic part."]


def markdown(conditions, notes, tables, failure):
    parts = [[conditions]] + [speed_table(t) for t in tables]
    if failure:
        parts.append(failure_table(failure))
    if notes:
        parts.append([" ".join(dict.fromkeys(notes))])
    return "\n\n".join("\n".join(p) for p in parts) + "\n"


def spread(row):
    return [f"{row[k]:.6g}" for k in ("median", "least", "most")]


def write_csv(path, stamp, tables, failure):
    with open(path, "w", encoding="utf-8", newline="") as f:
        out = csv.writer(f)
        out.writerow(["date", "gneiss", "load_before", "scene", "code", "unit", "items", "median", "least", "most",
                      "reference_1", "times_1", "reference_2", "times_2"])
        for table in tables:
            for row in table["rows"]:
                times = [x for r in table["references"] for x in (r, f"{row['times'][r]:.4g}")]
                out.writerow([*stamp, table["scene"], row["code"], table["unit"], f"{row['items']:.0f}",
                              *spread(row), *(times + 4 * [""])[:4]])
        for row in failure["rows"] if failure else []:
            out.writerow([*stamp, "rock-a to failure", row["code"], "s", "", *spread(row), "", "", "", ""])


# --- main ---------------------------------------------------------------------------------------------


def version_of(package):
    done = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=False) if shutil.which("dpkg-query") else None
    if not done or done.returncode != 0 or not done.stdout:
        return "of unknown version"
    return re.split(r"[+-]|\.git", done.stdout)[0]  # the version without the suffix of Debian


def gneiss_version(build):
    """Name, compiler and build kind, from the harness itself."""
    text = call([os.path.join(build, "bench", "bench_step"), "--benchmark_format=json", "--benchmark_min_time=0.001",
                 "--benchmark_filter=^step/rock-a/threads:1/scalar/"])
    return json.loads(text[text.index("{"):text.rindex("}") + 1])["context"]["gneiss"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--build", required=True, help="build folder with bench/bench_step and gneiss")
    parser.add_argument("--out", default=os.path.join(ROOT, "bench", "out"))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--steps", type=int, default=300, help="timed steps of the other codes")
    parser.add_argument("--large", action="store_true", help="fcc-500k as well")
    parser.add_argument("--scene", action="append", choices=list(SCENES), help="this scene only (may be repeated)")
    options = parser.parse_args()
    options.build = os.path.abspath(options.build)
    return options


def main():
    options = arguments()
    scenes = options.scene or [s for s in SCENES if options.large or s != "fcc-500k"]
    missing = missing_codes()
    notes = [f"{code} is not installed (Debian package {CODES[code][1]}) and is left out." for code in missing]
    for note in notes:
        print(note, file=sys.stderr)

    try:
        version = f"gneiss {gneiss_version(options.build)}"
    except Failed as error:
        sys.exit(f"run_peers.py: {error}")
    load_before = os.getloadavg()[0]
    runs = {scene: measure_scene(scene, options, missing, notes) for scene in scenes}
    load_after, cores = os.getloadavg()[0], os.cpu_count()

    versions = ", ".join([version] + [f"{code} {version_of(package)}" for code, (_, package) in CODES.items()
                                      if code not in missing])
    conditions = (f"{datetime.date.today()}, {versions}, {cores} cores, medians of {options.repeats} turns "
                  f"(ratios: of those within a turn); load average {load_before:.1f} before and {load_after:.1f} after"
                  + (" (**the machine was shared with other work**)." if load_before > 0.5 * cores else "."))
    tables = [summarise(scene, runs[scene]) for scene in scenes]
    failure = to_failure(runs.get("rock-a", {}))
    text = markdown(conditions, notes, tables, failure)
    os.makedirs(options.out, exist_ok=True)
    with open(os.path.join(options.out, "peers.md"), "w", encoding="utf-8") as f:
        f.write(text)
    with open(os.path.join(options.out, "peers.json"), "w", encoding="utf-8") as f:
        json.dump({"conditions": conditions, "notes": notes, "load_before": load_before, "load_after": load_after,
                   "tables": tables, "to_failure": failure, "runs": runs}, f, indent=1)
    write_csv(os.path.join(options.out, "peers.csv"), [datetime.date.today(), version, f"{load_before:.2f}"], tables,
              failure)
    print(text, end="")


if __name__ == "__main__":
    main()
