"""Results of the study's own tests over the predictions of `gneiss plan --error` from their specimens: validate/accuracy/base.csv, with which
the program corrects the estimates of other scenes.

    /usr/bin/python3 validate/accuracy/base.py      measures and writes it: some minutes of one core; ./do accuracy does so as well
    /usr/bin/python3 validate/accuracy/base.py --scatter      only how packings scatter by the law of the bonds (scatter.py)
"""
import csv
import io
import json
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import cylinder  # noqa: E402
import fits  # noqa: E402
import machinery  # noqa: E402
import scatter  # noqa: E402
import slopes  # noqa: E402
import study as shared  # noqa: E402
from machinery import Axis  # noqa: E402

HEAD = "# Written by ./do accuracy (validate/accuracy/base.py): what the study's own tests found over what is foretold from their specimens.\n"
FIXED = 0.03  # s: time of a run apart from its steps and the creation of its world, as in src/plan/propose.c.
FRACTION = 0.9  # share of the load at the first break at which statics ends
COLUMNS = ("case", "quantity", "value")
AGAIN = 5  # number of measurements of each cost


def plan(study, scene_file, again=AGAIN):
    """The figures that `gneiss plan` prints; the smallest of the costs, because other processes only increase them."""
    said = [json.loads(study.call(["plan", scene_file, "--error", "5%", "--reading", "stiffness", "--log", "json", "--threads", 1]).stdout.splitlines()[-2])["result"]
            for _ in range(again)]
    reported = said[0]
    reported["cost"] = {name: min(one["cost"][name] for one in said) for name in reported["cost"]}
    return reported


def particle_step(reported):
    return reported["cost"]["particle"] + reported["cost"]["contact"] * reported["contacts"] / reported["particles"]


def lattice_seconds(reported, steps, rows):
    return reported["particles"] * (steps * particle_step(reported) + rows * reported["cost"]["row"])


def first_break(row):
    """Strain between the ends when the first bond has broken."""
    broken = row.results("history/broken_tension") + row.results("history/broken_shear")
    return row.results("history/strain")[np.argmax(broken > 0)]


def power_of_strain(study, kind, c):
    """The strain at the peak over the number of particles, beside that by uniform strain of the same packings: the means are
    of three packings, loaded at four times the speed."""
    counts = [100, 200] if study.quick else [500, 1000, 2000, 4000]
    fast = c.motion(4 * c.closing)
    axis = Axis("base over particles", counts, lambda n: {"specimen.particles": n, **fast}, counts, seeds=3)
    found, said = {}, {}
    for row in study.axis(kind, c.scene(c.shape()), axis):
        found.setdefault(row.value, []).append(row["peak_strain"])
    for n in counts:
        scene = c.scene({**c.shape(), "particles": n})
        said[n] = plan(study, study.file(f"{kind}/base-plan-{n}.yaml", json.dumps(scene)), 1)["estimate"]["breaking_strain"]
    return fits.line(np.log(counts), [np.log(np.mean(found[n]) / said[n]) for n in counts])[1]


def scatter_over_law(study, kind, c):
    """Ratio of the scatter over many packings to the scatter law of the study, which is based on five packings of
    every number; loaded at four times the speed."""
    count, seeds = (100, 2) if study.quick else (500, 24)
    scene = c.scene({**c.shape(), "particles": count})
    rows = study.axis(kind, {**scene, **timed(scene)}, Axis("base, many packings", [0.9], machinery.key("time.safety"), [0.9], seeds=seeds))
    laws = {row["reading"]: row for row in slopes.read(HERE / "slopes.csv") if row["case"] == kind and row["effect"] == "packing"}
    return {f"scatter over its law: {reading}": fits.scatter([row[key] for row in rows]) / slopes.at(laws[reading], count)
            for reading, key in cylinder.READINGS.items() if reading in laws}


def run_over_lattice(study, kind, scene_file):
    """Ratio of the time of a run to the time predicted from a lattice, measured alternately, because other programs
    may use the machine."""
    ratios = []
    for _ in range(AGAIN):
        reported, out = plan(study, scene_file, 1), study.path(kind, "base-timed")
        study.call(["run", scene_file, "--out", out, "--force", "--quiet", "--threads", 1])
        summary = json.loads((out / "summary.json").read_text())
        rows = summary["steps"] // max(1, int(reported["estimate"]["path"] * cylinder.HEIGHT / reported["estimate"]["closing"] / reported["dt"] / 2000))
        ratios.append((summary["seconds"]["cpu"] - FIXED - reported["cost"]["setup"]) / lattice_seconds(reported, summary["steps"], rows))
    return np.median(ratios)


def timed(scene):
    """The parts of a scene that are loaded, four times as fast."""
    fast = json.loads(json.dumps({key: scene[key] for key in ("walls", "sets", "time") if key in scene}))
    for part in fast.get("walls", []) + fast.get("sets", []):
        part["motion"] = {channel: 4 * value for channel, value in part["motion"].items()}
    fast["time"]["end"] /= 4
    return fast


def of_case(study, kind):
    """Rows of base.csv: means over several runs of the base of a case, and of a start at the first break."""
    c = cylinder.Cylinder(kind, study.quick)
    shape = {"specimen": c.shape(), "run": {"seed": 1}}
    name = f"cylinder-{c.count}"
    scene = c.scene({"file": str(study.packed(name, shape)), "material": "rock"})
    shaken = Axis("base", [0, 1, 2], lambda k: {"specimen.file": str(study.packed(name, shape, k))}, [0, 1, 2])
    rows = study.axis(kind, scene, shaken)
    started = study.axis(kind, scene, Axis("base at the first break", ["first_break"], lambda s: {"time.start": s}, ["first_break"]))
    reported = plan(study, study.file(f"{kind}/base-plan.yaml", json.dumps(scene, indent=1)))
    mean = {r: np.mean([row[r] for row in rows]) for r in ("peak_stress", "peak_strain", "young_modulus", "young_modulus_average", "time", "steps")}
    estimate, seconds = reported["estimate"], min(row.seconds for row in rows)
    # The number of particles that press on the walls grows during a test: the share of the ends in both moduli.
    ends = 1 / mean["young_modulus"] - 1 / mean["young_modulus_average"] if estimate["compliance"] > 0 else 0.0
    body = mean["peak_strain"] - mean["peak_stress"] * ends
    run = seconds - FIXED - reported["cost"]["setup"]
    found = {"particles": reported["particles"],
             "modulus over uniform strain": mean["young_modulus_average"] / estimate["uniform_modulus"],
             "strain at the peak over breaking strain": body / estimate["breaking_strain"],
             "power of strain over particles": power_of_strain(study, kind, c),
             "strength over modulus and strain": mean["peak_stress"] / mean["young_modulus_average"] / body,
             "end over peak": mean["time"] * c.closing / cylinder.HEIGHT / mean["peak_strain"],
             "first break over peak": np.mean([first_break(row) for row in rows]) / mean["peak_strain"],
             "steps over those of the first": mean["steps"] * reported["dt"] / mean["time"],
             "run over lattice": run_over_lattice(study, kind, study.path(kind, "base-plan.yaml"))}
    found.update(scatter_over_law(study, kind, c))
    if estimate["compliance"] > 0:
        found["strain of the ends over that foretold"] = ends / estimate["compliance"]
    raised = Axis("base with added mass", [1, 2], lambda f: {"time.mass_scaling.factor": f, "time.estimate": "bound"}, [1, 2])
    heavier = {row.value: row for row in study.axis(kind, scene, raised)}
    found["power of added mass"] = np.log2(heavier[1]["steps"] / heavier[2]["steps"])
    if started:
        s = started[0]
        stood_for = s.summary["first_break"]["steps"]
        per_step = run / mean["steps"]
        found["statics in steps"] = (s.seconds - FIXED - reported["cost"]["setup"]) / per_step - (s["steps"] - stood_for)
    return {name: float(value) for name, value in found.items()}


def of_packing(study):
    """Measures the cost of making a packing in units of a step of its particles, alternating with the predicted cost
    of a step."""
    count, found = (200 if study.quick else 2000), []
    c = cylinder.Cylinder("compression", study.quick)
    scene = {**c.scene({**c.shape(), "particles": count}), "time": {"end": 1e-9}}
    request = study.file("packing/base-plan.yaml", json.dumps({**scene, "time": c.scene({})["time"]}))
    for seed in range(1, 1 + AGAIN):
        reported, out = plan(study, request, 1), study.path("packing", "base-timed")
        once = study.file("packing/base-run.yaml", json.dumps({**scene, "run": {"threads": 1, "seed": seed}}))
        study.call(["run", once, "--out", out, "--force", "--quiet"])
        seconds = json.loads((out / "summary.json").read_text())["seconds"]["cpu"]
        found.append((seconds - FIXED - reported["cost"]["setup"]) / count / particle_step(reported))
    return {"particle steps": np.median(found)}


def write(path, found):
    text = io.StringIO()
    text.write(HEAD)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for case, quantities in found.items():
        writer.writerows([case, name, f"{value:.4g}"] for name, value in quantities.items())
    path.write_text(text.getvalue())


def measure(study, path):
    found = {kind: of_case(study, kind) for kind in ("compression", "tension")}
    found["packing"] = of_packing(study)
    return with_scatter(study, path, found)


def with_scatter(study, path, found):
    for case in scatter.CASES:
        found.setdefault(case, {}).update(scatter.of_case(study, case))
    write(path, found)
    return found


def written(path):
    """Returns the content of the table in the form that `write` expects."""
    found = {}
    for row in slopes.read(path):
        found.setdefault(row["case"], {})[row["quantity"]] = float(row["value"])
    return found


if __name__ == "__main__":
    table, of = HERE / "base.csv", machinery.Study(shared.ROOT / "runs" / "accuracy", "--quick" in sys.argv)
    print(with_scatter(of, table, written(table)) if "--scatter" in sys.argv else measure(of, table))
