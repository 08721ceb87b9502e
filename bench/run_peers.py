"""gneiss beside other codes on the same scene, in turns, in one session.

run_peers.py --build FOLDER [--out FOLDER] [--repeats N] [--steps N]

The scene is rock-a: uniaxial compression of 10 225 bonded spheres. What is compared is bond-steps per second, the
number of intact bonds times the steps per second of wall time; set-up is left out everywhere. Prints a table and
writes peers.json and peers.md. Standard library only.
"""
import argparse
import datetime
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCENE = os.path.join(ROOT, "scenes", "ucs-rock.yaml")
PACKING = os.path.join(ROOT, "scenes", "specimens", "rock-a.txt")


def call(command, extra=None, timeout=900):
    environment = dict(os.environ, **(extra or {}))
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=timeout, check=False)
    if done.returncode != 0:
        sys.exit(f"run_peers.py: {' '.join(command)} failed ({done.returncode}):\n{done.stdout[-2000:]}")
    return done.stdout


def gneiss_steps(build, threads, isa):
    """Steps alone, through the bench harness."""
    text = call([os.path.join(build, "bench", "bench_step"), "--benchmark_min_time=0.5", "--benchmark_format=json",
                 f"--benchmark_filter=^step/rock-a/threads:{threads}/{isa}/"])
    results = json.loads(text[text.index("{"):])
    entries = results["benchmarks"]
    if not entries or entries[0].get("error_occurred"):
        sys.exit(f"run_peers.py: bench_step gave no rock-a at {threads} threads with {isa}:\n{text[-2000:]}")
    entry = entries[0]
    seconds = entry["real_time"] * {"ns": 1e-9, "us": 1e-6, "ms": 1e-3}[entry["time_unit"]]
    return {"bonds": entry["bonds"], "bond_steps_per_second": entry["bonds"] / seconds, "steps": entry["iterations"],
            "isa": results["context"]["isa"], "version": results["context"]["gneiss"]}


def gneiss_run(build, threads):
    """A tenth of the real run, with its readings, history and snapshots at their normal pace."""
    with tempfile.TemporaryDirectory() as folder:
        call([os.path.join(build, "gneiss"), "run", SCENE, "--quiet", "--threads", str(threads), "--out", folder,
              "--set", "time.end=0.6 ms", "--set", "output.history_rows=200", "--set", "output.snapshots=2"])
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as f:
            summary = json.load(f)
    seconds, bonds = summary["seconds"], summary["counts"]["bonds"]
    return {"bonds": bonds, "steps": summary["steps"], "dt": summary["dt"], "phases": seconds,
            "bond_steps_per_second": bonds * summary["steps"] / (seconds["total"] - seconds["setup"])}


def yade(threads, steps):
    with tempfile.TemporaryDirectory() as folder:
        result = os.path.join(folder, "yade.json")
        call(["yade", "-n", "-x", f"-j{threads}", os.path.join(ROOT, "bench", "peers", "yade_ucs.py")],
             {"QT_QPA_PLATFORM": "offscreen", "PACKING": PACKING, "STEPS": str(steps), "RESULT": result})
        with open(result, encoding="utf-8") as f:
            r = json.load(f)
    r["bond_steps_per_second"] = r["bonds"] * r["steps"] / r["seconds"]
    return r


def summarise(runs, reference):
    """Rows [label, median, least, most, times the reference or None]."""
    speed = {label: sorted(r["bond_steps_per_second"] for r in results) for label, results in runs.items()}
    base = statistics.median(speed[reference]) if reference in speed else None
    return [[label, statistics.median(s), s[0], s[-1], statistics.median(s) / base if base else None]
            for label, s in speed.items()]


def markdown(rows, conditions, bonds):
    lines = [conditions, "", f"| rock-a, {bonds:.0f} bonds, elastic part | M bond-steps/s | least - most | "
             "times YADE -j2 |", "| --- | ---: | ---: | ---: |"]
    for label, middle, least, most, ratio in rows:
        times = f"{ratio:.1f}" if ratio else ""
        lines.append(f"| {label} | {middle / 1e6:.2f} | {least / 1e6:.2f} - {most / 1e6:.2f} | {times} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", required=True, help="build folder with bench/bench_step and gneiss")
    parser.add_argument("--out", default=os.path.join(ROOT, "bench", "out"))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--steps", type=int, default=300, help="timed steps of the peers")
    options = parser.parse_args()
    have_yade = shutil.which("yade") is not None
    if not have_yade:
        print("YADE is not installed: `./do bench --peers` installs it (or apt-get install yade). gneiss alone:")

    widest = gneiss_steps(options.build, 1, "(scalar|avx2|avx512)")["isa"]
    candidates = {f"gneiss, steps, 2 threads, {widest}": lambda: gneiss_steps(options.build, 2, widest),
                  f"gneiss, steps, 1 thread, {widest}": lambda: gneiss_steps(options.build, 1, widest),
                  "gneiss, steps, 2 threads, scalar": lambda: gneiss_steps(options.build, 2, "scalar"),
                  "gneiss, whole run, 2 threads": lambda: gneiss_run(options.build, 2)}
    if have_yade:
        candidates["YADE -j2"] = lambda: yade(2, options.steps)
        candidates["YADE -j1"] = lambda: yade(1, options.steps)

    load_before = os.getloadavg()[0]
    runs = {label: [] for label in candidates}
    for turn in range(options.repeats):
        for label, measure in candidates.items():
            runs[label].append(measure())
            print(f"  {turn + 1}/{options.repeats}  {label}: {runs[label][-1]['bond_steps_per_second'] / 1e6:.2f} M "
                  "bond-steps/s", file=sys.stderr, flush=True)
    load_after = os.getloadavg()[0]

    cores = os.cpu_count()
    first = next(iter(runs.values()))[0]
    versions = f"gneiss {first['version']}" + (f", YADE {runs['YADE -j2'][0]['version']}" if have_yade else "")
    conditions = (f"{datetime.date.today()}, {versions}, {cores} cores, medians of {options.repeats} turns; load average "
                  f"{load_before:.1f} before and {load_after:.1f} after"
                  + (" (**the machine was shared with other work**)." if load_before > 0.5 * cores else "."))
    rows = summarise(runs, "YADE -j2")
    text = markdown(rows, conditions, first["bonds"])
    os.makedirs(options.out, exist_ok=True)
    with open(os.path.join(options.out, "peers.md"), "w", encoding="utf-8") as f:
        f.write(text)
    with open(os.path.join(options.out, "peers.json"), "w", encoding="utf-8") as f:
        json.dump({"conditions": conditions, "load_before": load_before, "load_after": load_after, "runs": runs}, f,
                  indent=1)
    print(text, end="")


if __name__ == "__main__":
    main()
