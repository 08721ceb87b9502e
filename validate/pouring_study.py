"""Many small pourings at default settings: the study checks that each closes its ledger, reproduces the requested restitution, and loses no grain. It
writes a section of docs/evidence/granular.md; two to three seconds of one core each.

    /usr/bin/python3 validate/pouring_study.py [--count 500] [--quick] [--finished]

Scenes are drawn at random: material, sizes, container, rate, speed, rolling resistance, linear law or Hertz's, with and without
pull; step, time of a contact, skin and everything else are left to gneiss. --quick does 20, --finished runs nothing
and writes the table of those that an unfinished study has left. The scene of a number is always the same.
"""
import json
import random
import shutil
import sys

import numpy as np

import study

sys.path.insert(0, str(study.ROOT / "validate" / "yade"))
import own  # noqa: E402


def log(dice, low, high):
    return float(np.exp(dice.uniform(np.log(low), np.log(high))))


def drawn(number):
    """A scene; grains fall `high` into a box, a tube or a funnel."""
    dice = random.Random(number)
    d, density = log(dice, 3e-4, 3e-2), log(dice, 500, 8000)
    hertz, count = dice.random() < 0.7, dice.randrange(30, 120)
    speed, across = dice.uniform(0, 2), dice.uniform(5, 9) * d
    high = 3 * count * d**3 / across**2 + 6 * d
    fall = np.sqrt(speed**2 + 2 * 9.81 * (high + 4 * d))
    top = high + 30 * d + 1.5 * fall**2 / (2 * 9.81)  # small fast grains rebound high
    grain = {"name": "m", "density": density, "friction": dice.choice([0, dice.uniform(0.05, 1)])}
    e = dice.choice([dice.uniform(0.2, 0.95), 0.5, 0.8])
    if dice.random() < 0.4:
        grain["rolling_friction"] = dice.uniform(0.01, 0.4)
    scene = {"dimension": 3, "materials": [grain], "gravity": [0, 0, -9.81], "run": {"seed": number, "threads": 1}}
    side = {"friction": grain["friction"]}
    if hertz:
        # The range is from a soft grain, which a fall of that height compresses by 3 % of the radius, to a
        # thousand times its stiffness.
        soft = 1.25 * density * fall**2 * 0.03**-2.5
        grain.update(young=soft * log(dice, 1, 1000), poisson=dice.uniform(0, 0.45), restitution=e)
        scene["law"] = {"stiffness": "hertz", "pull": dice.random() < 0.7}
    else:
        mass = density * np.pi / 6 * d**3
        grain.update(normal_stiffness=mass * (fall / (0.01 * d))**2 * log(dice, 1, 100), kratio=dice.uniform(1, 5))
        scene["law"] = {"stiffness": "uniform"}
        scene["damping"] = {"contact": {"restitution": e}}
        side.update(stiffness=grain["normal_stiffness"], kratio=grain["kratio"])
    vessel = dice.choice(["box", "tube", "funnel"])
    if vessel == "box":
        scene["walls"] = [{"name": f"{a}{s}", "point": [(-s * across / 2) * (a == "x"), (-s * across / 2) * (a == "y"), 0],
                           "normal": [s * (a == "x"), s * (a == "y"), 0], **side} for a in "xy" for s in (1, -1)]
        region = {"box": {"size": [across - 1.5 * d, across - 1.5 * d, 3 * d]}, "origin": [-(across - 1.5 * d) / 2, -(across - 1.5 * d) / 2, high]}
    else:
        cylinder = {"diameter": across, "height": top, "sides": 24, "open": True}
        if vessel == "funnel":
            cylinder["upper_diameter"], cylinder["diameter"] = 1.6 * across, across
        scene["bodies"] = [{"name": "vessel", "cylinder": cylinder, **side}]
        region = {"cylinder": {"diameter": across - 2.5 * d, "height": 3 * d}, "origin": [0, 0, high]}
    scene.setdefault("walls", []).append({"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], **side})
    scene["sources"] = [{"name": "feed", **region, "rate": count / dice.uniform(0.2, 1.0) / np.sqrt(high), "total": count, "mean_radius": d / 2,
                         "size_ratio": dice.choice([1, 1.2, 2]), "velocity": [0, 0, -speed]}]
    wide = 4 * across + high
    scene["domain"] = {"min": [-wide, -wide, -wide], "max": [wide, wide, top], "lost": "remove"}
    scene["time"] = {"end": 1.5 * np.sqrt(high) + np.sqrt(2 * high / 9.81)}
    scene["output"] = {"history_rows": 60, "snapshots": 0}
    return scene, e, count, fall


def rebound(scene, fall):
    """Restitution of two grains of the scene that collide in flight, at its own step and half the speed of the fall."""
    r = scene["sources"][0]["mean_radius"]
    lines = {key: scene[key] for key in ("dimension", "materials", "law", "damping") if key in scene}
    lines.update(specimen={"particles": [[0, 0, 0, r], [0, 0, 2.2 * r, r]], "group": 0}, run={"threads": 1},
                 sets=[{"name": "a", "select": {"ids": [1]}, "initial_velocity": [0, 0, -fall / 2]}], time={"end": 2 * r / fall})
    with own.World(json.dumps(lines)) as world:
        for _ in range(100000):
            world.step(1)
            state = world.particles("pos", "vel")
            approach = state[1, 5] - state[0, 5]
            if approach > 0 and state[1, 2] - state[0, 2] > 2.05 * r:  # the error of an opening within a step is corrected in the next one
                return approach / (fall / 2)
    return float("nan")


def pour(number):
    scene, e, count, fall = drawn(number)
    path = study.RUNS / "pouring" / f"{number}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(scene))
    folder = study.RUNS / "pouring" / "run"
    shutil.rmtree(folder, ignore_errors=True)
    done = study.call(["run", str(path), "--quiet", "--out", str(folder), "--set", "output.checkpoint=off"])
    if done.returncode not in (0, 5):
        sys.exit(f"pouring {number}: {done.returncode}\n{done.stderr}")
    if not (folder / "summary.json").exists():  # the run failed
        return {"number": number, "code": done.returncode, "residual": 1.0, "came": 0, "lost": 0, "late": 0, "e": e, "found": rebound(scene, fall),
                "warnings": ["went bad"], "cpu": 0.0, "steps": 0}
    said = json.loads((folder / "summary.json").read_text())
    came, there = said["sources"][0]["number"], said["counts"]["particles"]
    return {"number": number, "code": done.returncode, "residual": abs(said["energy_residual"]), "came": came, "lost": came - there,
            "late": count - came, "e": e, "found": rebound(scene, fall), "warnings": [w if isinstance(w, str) else w["name"] for w in said["warnings"]],
            "cpu": said["seconds"]["cpu"], "steps": said["steps"]}


def kept_rows(count):
    """Adds one row for each number; rows are stored in a file, so that a longer study continues."""
    path = study.RUNS / "pouring" / "rows.json"
    rows = {} if study.FRESH or not path.exists() else {r["number"]: r for r in json.loads(path.read_text())}
    for number in range(1, count + 1):
        if number in rows or "--finished" in sys.argv:
            continue
        rows[number] = pour(number)
        path.write_text(json.dumps(list(rows.values())))
        if number % 10 == 0:
            print(f"{number} of {count}", file=sys.stderr, flush=True)
    return [rows[k] for k in range(1, count + 1) if k in rows]


def main():
    asked = [int(b) for a, b in zip(sys.argv, sys.argv[1:]) if a == "--count"]
    count = asked[0] if asked else 20 if "--quick" in sys.argv else 500
    rows = kept_rows(count)
    count = len(rows)
    if not rows:
        sys.exit("none is finished")
    residual = np.array([r["residual"] for r in rows])
    # From 0.5 on the error is relative, below it is absolute (docs/physics.md).
    off = np.array([abs(r["found"] - r["e"]) / (r["e"] if r["e"] >= 0.5 else 1) for r in rows])
    named = sorted({w for r in rows for w in r["warnings"]})
    bad = [r for r, miss in zip(rows, off) if r["code"] or r["residual"] > 0.01 or r["lost"] or not miss < 0.01]
    table = study.table(("", "median", "of a hundred the worst", "worst", "limit", "beyond it"), [
        ["residual of the ledger", *(f"{v:.1e}" for v in (np.median(residual), np.percentile(residual, 99), residual.max())), "1e-2", int((residual > 0.01).sum())],
        ["restitution: off by (of 1 below 0.5)", *(f"{v:.1e}" for v in (np.median(off), np.percentile(off, 99), off.max())), "1e-2", int((~(off < 0.01)).sum())],
        ["grains lost", 0, "", max(r["lost"] for r in rows), 0, sum(r["lost"] > 0 for r in rows)]])
    words = (f"Written by `validate/pouring_study.py`: {count} scenes drawn at random, {sum(r['came'] for r in rows)} grains, {sum(r['steps'] for r in rows)} steps. "
             "Density, size (0.3 to 30 mm), stiffness, friction, restitution (0.2 to 0.95), rolling resistance, vessel (box, tube, funnel), rate and speed are drawn; Hertz's law, with and without "
             "pull, in seven of ten, else the linear one; step and all other settings are the defaults. Restitution: two grains of the scene that meet at half the speed of the fall.\n\n")
    reported = ', '.join(f"{w} ({sum(w in r['warnings'] for r in rows)})" for w in named) or 'none'
    after = f"\n\nExit codes other than 0: {sum(r['code'] != 0 for r in rows)}. Warnings: {reported}."
    if bad:
        after += " Beyond a limit: " + ", ".join(f"{r['number']} (residual {r['residual']:.1e}, restitution {r['found']:.3f} of {r['e']:.3f}, lost {r['lost']})" for r in bad[:12]) + "."
    study.section("granular.md", "Random pourings at default settings", words + table + after)
    print(table + after)


if __name__ == "__main__":
    main()
