"""Grains beside seven codes: the three cases of Dosta et al. 2024 (Comput. Phys. Commun. 296, 109066) from the input files of that
comparison, which the project does not have (they come with MercuryDPM's drivers): the folder that holds them is an argument.

    /usr/bin/python3 validate/dem8_study.py FOLDER [penetration] [inputs] [yade] [drum] [silo]

Writes sections of docs/evidence/granular.md. A part of an hour of one core each; `yade` times YADE and gneiss in turns on the
penetration, a few minutes.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np

import study

PEER = study.ROOT / "validate" / "peers" / "yade_dem8.py"
PAGE = "granular.md"
G = 9.8
M1 = {"name": "m1", "density": 2500, "young": 1e9, "poisson": 0.2, "friction": 0.3, "restitution": 0.5}
M2 = {"name": "m2", "density": 2000, "young": 0.5e9, "poisson": 0.2, "friction": 0.4, "restitution": 0.4}
STEEL = {"name": "steel", "density": 7200, "young": 210e9, "poisson": 0.2, "friction": 0.2, "restitution": 0.4}
BETWEEN = [{"between": ["m1", "m2"], "friction": 0.2, "restitution": 0.45},
           {"between": ["m1", "steel"], "friction": 0.2, "restitution": 0.4},
           {"between": ["m2", "steel"], "friction": 0.2, "restitution": 0.4}]
# The files contain the grains only; the steel sphere (the 25 001st particle of the comparison) starts here, 109 mm
# above the place where it stops.
BALL = {"at": [0, 0, 0.06], "radius": 0.01, "speed": -5.0}


def folder_of():
    given = [a for a in sys.argv[1:] if Path(a).is_dir()]
    if not given:
        sys.exit("expected the folder with the input files of the comparison (Penetration_25KParticles.txt, ...), found none")
    return Path(given[0]).resolve()


def converted(name, rows):
    """Rows x y z r as a specimen file."""
    path = study.RUNS / "dem8" / f"{name}.txt"
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, rows, fmt="%.17g")
    return str(path)


def particles(file):
    """Rows x y z r of a file of rows r x y z."""
    rows = np.loadtxt(file, skiprows=1)
    return rows[:, [1, 2, 3, 0]]


def surface(name, file):
    """Rows of three corners as an STL file; (path, triangles)."""
    corners = np.loadtxt(file, skiprows=1).reshape(-1, 3, 3)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    keep = size > 0
    records = np.zeros(keep.sum(), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    records["n"], records["v"] = normal[keep] / size[keep, None], corners[keep]
    path = study.RUNS / "dem8" / f"{name}.stl"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(bytes(80) + np.uint32(len(records)).tobytes() + records.tobytes())
    return str(path), int(keep.sum())


def run(name, scene, **settings):
    path = study.RUNS / "dem8" / f"{name}.yaml"
    path.write_text(json.dumps({"dimension": 3, "law": {"stiffness": "hertz"}, "gravity": [0, 0, -G], **scene}, indent=1))
    return study.run(f"dem8/{name}", path, {"run.threads": 1, **settings})


def snapshots(done, *fields):
    """Returns (time, positions, fields) of each snapshot."""
    series = json.loads((done.folder / "particles.hdf.series").read_text())["files"]
    for entry in series:
        with h5py.File(done.folder / entry["name"], "r") as file:
            yield (entry["time"], file["VTKHDF/Points"][()], *(file[f"VTKHDF/PointData/{f}"][()] for f in fields))


# --- penetration ---------------------------------------------------------------------------------------

def penetration_scene(folder):
    grains = particles(folder / "Penetration_25KParticles.txt")
    rows = np.vstack([grains, [*BALL["at"], BALL["radius"]]])
    walls, _ = surface("penetration", folder / "Penetration_walls.txt")
    return {"materials": [M1, STEEL], "contacts": [BETWEEN[1]],
            "specimen": {"file": converted("penetration", rows), "material": "m1", "group": 0},
            "sets": [{"name": "ball", "select": {"ids": [len(grains)]}, "material": "steel",
                      "initial_velocity": [0, 0, BALL["speed"]]}],
            "bodies": [{"name": "box", "surface": walls, "material": "steel"}]}


def heights(done, ball):
    """Time and path of the sphere, stored beside the run; its snapshots are deleted."""
    kept = done.folder / "ball.json"
    if not kept.exists():
        rows = [(t, float(x[np.flatnonzero(ids == ball)[0], 2])) for t, x, ids in snapshots(done, "id")]
        kept.write_text(json.dumps(rows))
        for file in done.folder.glob("*_[0-9]*.hdf"):
            file.unlink()
    return np.array(json.loads(kept.read_text()))


def speed_at(t, z, begin, end):
    """Mean velocity of a ballistic path, corrected for gravity: m/s at `begin`."""
    part = (t >= begin) & (t <= end)
    return np.polyfit(t[part] - begin, z[part] + 0.5 * G * (t[part] - begin)**2, 1)[0]


def picture(curve, found, name):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.figure(figsize=(6, 4))
    t, mean, code, initial = curve.T
    plt.fill_between(1e3 * t, 1e3 * (mean - 2 * code), 1e3 * (mean + 2 * code), color="0.8", label="seven codes, mean +- 2 s.d.")
    plt.plot(1e3 * t, 1e3 * mean, "k-", lw=0.8)
    for label, z in found.items():
        plt.plot(1e3 * z[:, 0], 1e3 * z[:, 1], lw=1.2, label=label)
    plt.xlabel("time, ms")
    plt.ylabel("way of the steel sphere, mm")
    plt.legend(fontsize=8)
    plt.tight_layout()
    plt.savefig(study.ROOT / "docs" / "evidence" / "pictures" / name, dpi=110)


def penetration(folder):
    scene = penetration_scene(folder)
    done = run("penetration", {**scene, "time": {"end": 0.1}, "output": {"history_rows": 200}}, **{"output.snapshots": 100})
    z = heights(done, 25000)
    z[:, 1] -= BALL["at"][2]
    curve = np.loadtxt(folder / "penetration_25k_curve.csv", delimiter=",", skiprows=2)
    t, mean, code, initial = curve.T
    ours = np.interp(t, z[:, 0], z[:, 1])
    other = in_liggghts(folder, "on")
    theirs = np.interp(t, other[:, 0], other[:, 1], left=np.nan, right=np.nan)
    rows = []
    for at in (0.005, 0.015, 0.022, 0.023, 0.024, 0.026, 0.028, 0.029, 0.030, 0.032, 0.036, 0.04, 0.05, 0.07, 0.099):
        k = int(np.argmin(abs(t - at)))
        off = 1e3 * (ours[k] - mean[k])
        rows.append([f"{1e3 * t[k]:.0f}", f"{1e3 * ours[k]:.2f}", f"{1e3 * theirs[k]:.2f}" if np.isfinite(theirs[k]) else "", f"{1e3 * mean[k]:.2f}", f"{2e3 * code[k]:.2f}", f"{2e3 * initial[k]:.2f}",
                     f"{off:+.2f}"])
    # Both the curve of the codes and ours are read by the lowest point and the flight that follows.
    up = [speed_at(a, b, 0.034, 0.06) for a, b in ((z[:, 0], z[:, 1]), (t, mean))]
    inside = np.mean(abs(ours - mean)[t > 0.0225] <= 2 * code[t > 0.0225])
    bed = (t > 0.0215) & (t < 0.0295)
    apart = 1e3 * np.max(abs(ours - theirs)[bed])
    picture(curve, {"gneiss": z, "LIGGGHTS": other}, "dem8-penetration.png")
    return (study.table(("t, ms", "gneiss, mm", "LIGGGHTS here, mm", "mean of codes", "2 s.d. of codes", "2 s.d. of packings", "off, mm"), rows)
            + f"\n\nLowest {1e3 * z[:, 1].min():.2f} mm at {1e3 * z[np.argmin(z[:, 1]), 0]:.1f} ms, codes {1e3 * mean.min():.2f} mm at "
              f"{1e3 * t[np.argmin(mean)]:.1f} ms; upwards at 34 ms {up[0]:.3f} m/s, codes {up[1]:.3f} m/s. {100 * inside:.0f} % of the rows after 22 ms lie "
              f"within 2 standard deviations of the codes. Residual {done.residual:.1e}, {done.summary['steps']} steps, the last of {done.summary['dt']:.3g} s, "
              f"{done.seconds:.0f} s on one thread of a machine that others used.\n\n"
              f"The published curve is missed: from 1 ms after the touch on the sphere is braked less than in the mean of the codes, and comes back faster. The cause is not in gneiss' law or "
              f"steps: LIGGGHTS (its Hertz law with its tangential dashpot, planes for the walls, step 1 us, from the touch on) takes the same path with the same inputs, "
              f"{apart:.2f} mm apart at most until the sphere nears the floor. So what differs is an input, and hardly a coefficient: "
              "MercuryDPM's drivers and YADE's script of the comparison have the same ones (but for gravity, 9.81 in YADE's). Left are the packing, a file of one of the codes, and the place of the "
              "sphere, the last row of a file that is not at hand. After 30 ms the sphere presses grains against the floor, "
              "where paths part.\n\n![Way of the sphere](pictures/dem8-penetration.png)")


def in_liggghts(folder, damped, until=0.0315, dt=1e-6):
    """Time and path of the sphere in LIGGGHTS from the impact on; before the impact it falls freely."""
    start = -0.047
    speed = -np.sqrt(BALL["speed"]**2 + 2 * G * (BALL["at"][2] - start))
    fallen = (BALL["speed"] - speed) / G
    kept = study.RUNS / "dem8" / f"liggghts-{damped}.json"
    if kept.exists() and not study.FRESH:
        return np.array(json.loads(kept.read_text()))
    rows = particles(folder / "Penetration_25KParticles.txt")
    lines = [f"bed\n\n{len(rows) + 1} atoms\n2 atom types\n\n-0.06 0.06 xlo xhi\n-0.04 0.04 ylo yhi\n-0.1 0.15 zlo zhi\n\nAtoms\n"]
    lines += [f"{k + 1} 1 {2 * r:.17g} 2500 {x:.17g} {y:.17g} {z:.17g}" for k, (x, y, z, r) in enumerate(rows)]
    lines.append(f"{len(rows) + 1} 2 {2 * BALL['radius']} 7200 0 0 {start}\n\nVelocities\n")
    lines += [f"{k + 1} 0 0 0 0 0 0" for k in range(len(rows))] + [f"{len(rows) + 1} 0 0 {speed:.17g} 0 0 0"]
    data = study.RUNS / "dem8" / "liggghts.data"
    data.write_text("\n".join(lines) + "\n")
    command = ["liggghts", "-in", str(PEER.parent / "liggghts_dem8.in"), "-log", "none"]
    for name, value in {"data": data, "damped": damped, "dt": dt, "every": 100, "steps": int((until - fallen) / dt)}.items():
        command += ["-var", name, str(value)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=study.RUNS)
    found = [[float(a) + fallen, float(b) - BALL["at"][2]] for a, b in re.findall(r"^RESULT (\S+) (\S+)$", done.stdout, re.M)]
    if len(found) < 50:
        sys.exit(f"liggghts: {done.stdout[-1500:]}{done.stderr[-1500:]}")
    kept.write_text(json.dumps(found))
    return np.array(found)


VARIED = {"as above": {}, "friction among grains 0.5 (0.3)": {"m1": {"friction": 0.5}}, "friction with steel 0.4 (0.2)": {"pair": {"friction": 0.4}},
          "rolling friction 0.05 (none)": {"m1": {"rolling_friction": 0.05}}, "restitution among grains 0.2 (0.5)": {"m1": {"restitution": 0.2}},
          "E 10 GPa (1)": {"m1": {"young": 1e10}}, "grains of material 2": {"m1": {key: M2[key] for key in ("young", "density", "friction", "restitution")}},
          "sphere at x 20, y 5 mm (on the axis)": {"at": (0.02, 0.005)}, "sphere at x -10, y -4 mm": {"at": (-0.01, -0.004)}}


def inputs(folder):
    """The effect of one changed input on the path of the sphere, from shortly before the contact to 30 ms: mm off the mean of the codes."""
    curve = np.loadtxt(folder / "penetration_25k_curve.csv", delimiter=",", skiprows=2)
    begin = -0.046
    speed = np.sqrt(BALL["speed"]**2 + 2 * G * (BALL["at"][2] - begin))
    fallen = (speed + BALL["speed"]) / G
    moments, rows = (0.022, 0.023, 0.024, 0.026, 0.028, 0.030), []
    for number, (title, changed) in enumerate(VARIED.items()):
        scene = penetration_scene(folder)
        grains = np.loadtxt(scene["specimen"]["file"])
        grains[-1, :3] = [*changed.get("at", (0, 0)), begin]
        scene["specimen"]["file"] = converted(f"inputs-{number}", grains)
        scene["sets"][0]["initial_velocity"] = [0, 0, -speed]
        scene["materials"] = [{**M1, **changed.get("m1", {})}, STEEL]
        scene["contacts"] = [{**BETWEEN[1], **changed.get("pair", {})}]
        done = run(f"inputs-{number}", {**scene, "time": {"end": 0.0301 - fallen}, "output": {"history_rows": 50}}, **{"output.snapshots": 40, "output.checkpoint": "off"})
        way = heights(done, 25000)
        rows.append([title, *(f"{1e3 * (np.interp(at, way[:, 0] + fallen, way[:, 1] - BALL['at'][2]) - np.interp(at, curve[:, 0], curve[:, 1])):+.2f}" for at in moments)])
    spread = [f"{2e3 * np.interp(at, curve[:, 0], curve[:, 2]):.2f}" for at in moments], [f"{2e3 * np.interp(at, curve[:, 0], curve[:, 3]):.2f}" for at in moments]
    return study.table(("input (as above in brackets)", *(f"{1e3 * at:.0f} ms" for at in moments)), [*rows, ["2 s.d. of codes", *spread[0]], ["2 s.d. of packings", *spread[1]]])


# --- drum and silo -------------------------------------------------------------------------------------

def softer(material, by):
    return {**material, "young": material["young"] / by}


def counted(done, of):
    """(time, numbers) of each snapshot, stored beside the run; its snapshots are deleted. `of` counts."""
    kept = done.folder / "counted.json"
    if not kept.exists():
        kept.write_text(json.dumps([(t, of(x, r)) for t, x, r in snapshots(done, "radius")]))
        for file in done.folder.glob("*_[0-9]*.hdf"):
            file.unlink()
    return json.loads(kept.read_text())


def by_quadrants(x, r):
    """Large and small grains with x, z both positive, both negative, and in the two other quadrants (x positive first)."""
    right, upper = x[:, 0] > 0, x[:, 2] > 0
    return [int(np.sum(size & a & b)) for size in (r > 1.5e-3, r < 1.5e-3)
            for a, b in ((right, upper), (~right, ~upper), (right, ~upper), (~right, upper))]


def turning(folder, by, end, rows):
    """The drum of the comparison with moduli divided by `by`; (run, [(time, counts)])."""
    grains = particles(folder / "Drum_PartCoordinates.txt")
    walls, _ = surface("drum", folder / "Drum_walls.txt")
    large = [int(k) for k in np.flatnonzero(grains[:, 3] > 1.5e-3)]
    done = run(f"drum-{by}", {
        "materials": [softer(M1, by), softer(M2, by), STEEL], "contacts": BETWEEN,
        "specimen": {"file": converted("drum", grains), "material": "m1", "group": 0},
        "sets": [{"name": "large", "select": {"ids": large}, "material": "m2"}],
        # Shows that the heap leans to where x and z are positive, as the counted quadrants suggest.
        "bodies": [{"name": "drum", "surface": walls, "material": "steel", "motion": {"wy": -2.0}}],
        "time": {"end": end}, "output": {"history_rows": 200}}, **{"output.snapshots": rows, "output.checkpoint": "off"})
    return done, counted(done, by_quadrants)


def drum(folder):
    """Whole with soft grains, its beginning with stiffer ones."""
    (soft, found), (hard, first) = (turning(folder, *of) for of in DRUMS)
    at = [0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2]
    rows = [[f"{found[k][0]:.2f}", *found[k][1]] for k in (int(np.argmin([abs(row[0] - t) for row in found])) for t in at)]
    names = [f"{size}, {where}" for size in ("d 4", "d 2") for where in ("x, z > 0", "x, z < 0", "x > 0 > z", "x < 0 < z")]
    times, counts = np.array([row[0] for row in found]), np.array([row[1] for row in found])
    apart = max(np.max(abs(np.array(count) - [np.interp(t, times, one) for one in counts.T])) for t, count in first)
    late = counts[times >= 1]
    means = [f"{m:.0f} +- {s:.0f}" for m, s in zip(late.mean(0), late.std(0))]
    return (study.table(("t, s", *names), [*rows, ["1 to 2", *means]])
            + f"\n\nModuli a {DRUMS[0][0]}th of those of the comparison: {soft.summary['steps']} steps of {soft.summary['dt']:.3g} s, {soft.summary['seconds']['cpu']:.0f} s of one core; residual "
              f"{soft.residual:.1e}. With a {DRUMS[1][0]}th of the moduli, {DRUMS[1][1]:g} s long ({hard.summary['seconds']['cpu']:.0f} s), no count of {len(first)} moments is "
              f"farther apart than {apart:.0f} of {sum(found[0][1])}. With the whole moduli the case would be some {5 / soft.summary['dt'] * DRUMS[0][0]**0.5 * soft.summary['seconds']['cpu'] / soft.summary['steps'] / 3600:.0f} hours of one core.")


def emptying(folder, name, material, by, end):
    """One of the silos of the comparison, filled by a source, opened at OPENED s; (run, [(time, [spheres above the outlet])])."""
    low = SILOS[name][1]
    walls, _ = surface(f"silo-{name}", folder / f"Silo_walls_{name}_orifice.txt")
    grain = softer(material, by)
    done = run(f"silo-{name}-{grain['name']}-{by}", {
        "materials": [grain, STEEL], "contacts": [c for c in BETWEEN if c["between"] == [grain["name"], "steel"]],
        "sources": [{"name": "feed", "cylinder": {"diameter": 0.19, "height": 0.08}, "origin": [0, 0, 0.23], "rate": 4e5, "total": 100000,
                     "mean_radius": 0.002, "size_ratio": 1, "material": grain["name"], "velocity": [0, 0, -2.0]}],
        "sinks": [{"name": "out", "plane": {"point": [0, 0, low - 0.06], "normal": [0, 0, -1]}}],
        "bodies": [{"name": "silo", "surface": walls, "material": "steel"},
                   {"name": "slide", "box": {"size": [0.1, 0.1, 0.005]}, "origin": [-0.05, -0.05, low - 0.0051], "material": "steel",
                    "motion": {"vx": [[0, 0], [OPENED, 0], [OPENED + 0.005, 4], [OPENED + 0.035, 4], [OPENED + 0.04, 0]]}}],
        "domain": {"min": [-0.3, -0.3, low - 0.1], "max": [0.3, 0.3, 0.5], "lost": "remove"},
        "time": {"end": end}, "output": {"history_rows": 200}}, **{"output.snapshots": 100, "output.checkpoint": "off"})
    return done, counted(done, lambda x, r: [int(np.sum(x[:, 2] > low))])


def silo(folder):
    """The mass above the outlet over the time since it was opened, in the runs of SILO_RUNS."""
    at = np.arange(0, SILO_RUNS[0][-1] - OPENED, 0.5)
    rows = []
    for name, material, by, end in SILO_RUNS:
        done, counts = emptying(folder, name, material, by, end)
        t, above = np.array([row[0] for row in counts]) - OPENED, np.array([row[1][0] for row in counts])
        lying = above[np.searchsorted(t, 0)]
        part = (t > 0) & (above < 0.8 * lying) & (above > 0.4 * lying)
        rate = -np.polyfit(t[part], above[part], 1)[0]
        radius, mass = SILOS[name][0], material["density"] * np.pi / 6 * 0.004**3
        law = 0.58 * 0.6 * material["density"] * np.sqrt(G) * (2 * radius - 1.4 * 0.004)**2.5 / mass
        rows.append([f"{name}, {material['name']}", *(f"{np.interp(moment, t, above):.0f}" for moment in at), f"{rate:.0f}", f"{law:.0f}",
                     f"{done.residual:.1e}", f"{done.summary['seconds']['cpu'] / 60:.0f}"])
    return study.table(("orifice, grains", *(f"{moment:g} s" for moment in at), "left per s, from 80 to 40 %", "Beverloo, flat floor, C 0.58", "residual", "minutes of one core"), rows)


DRUMS = ((100, 2.0, 80), (25, 0.2, 8))  # moduli divided by, s, snapshots
SILOS = {"large": (0.03, -0.0554), "small": (0.02, -0.0593)}  # radius and height of the orifice, m
OPENED = 0.5  # s
SILO_RUNS = (("large", M1, 100, 2.6),)


# --- beside YADE ---------------------------------------------------------------------------------------

def yade_seconds(job, threads, steps, warm):
    out = study.RUNS / "dem8" / "yade.json"
    out.unlink(missing_ok=True)
    text = json.dumps({**job, "steps": steps, "warm": warm, "out": str(out)})
    done = subprocess.run(["yade", "-n", "-x", f"-j{threads}", str(PEER)], capture_output=True, text=True,
                          env={**os.environ, "JOB": text, "QT_QPA_PLATFORM": "offscreen"})
    if not out.exists():
        sys.exit(f"yade: {done.stdout[-1500:]}{done.stderr[-1500:]}")
    return json.loads(out.read_text())


def own_cpu(scene, step, steps):
    """Processor seconds of a run of this number of steps on one thread."""
    folder = study.RUNS / "dem8" / "timed"
    path = study.RUNS / "dem8" / "timed.yaml"
    shutil.rmtree(folder, ignore_errors=True)
    path.write_text(json.dumps({"dimension": 3, "law": {"stiffness": "hertz"}, "gravity": [0, 0, -G], **scene,
                                "time": {"step": step, "end": step * steps}, "output": {"history_rows": 10, "snapshots": 0}}))
    done = study.call(["run", str(path), "--quiet", "--out", str(folder), "--threads", "1", "--set", "output.checkpoint=off"])
    if done.returncode:
        sys.exit(done.stderr)
    said = json.loads((folder / "summary.json").read_text())
    return said["seconds"]["cpu"], said["steps"], said["counts"]["contacts"]


def yade(folder, turns=3):
    scene = penetration_scene(folder)
    step, steps, warm = 5e-7, 60, 10
    # The sphere starts in touch with the bed, so that the timed steps are those of the penetration.
    rows = np.loadtxt(scene["specimen"]["file"])
    rows[-1, 2] = -0.0472
    scene["specimen"]["file"] = converted("penetration-low", rows)
    job = {"particles": scene["specimen"]["file"], "walls": str(folder / "Penetration_walls.txt"), "dt": step, "g": G, "speed": BALL["speed"]}
    lines, ratios = [], []
    for turn in range(turns):
        (first, few, _), (last, many, touching) = (own_cpu(scene, step, n) for n in (60, 1260))
        own, peer = (last - first) / (many - few), yade_seconds(job, 1, steps, warm)
        ratios.append(peer["seconds"] / steps / own)
        lines.append([turn + 1, f"{1e3 * own:.2f}", touching, f"{1e3 * peer['seconds'] / steps:.1f}", peer["interactions"], f"{ratios[-1]:.1f}"])
    return (study.table(("turn", "gneiss, ms a step", "pairs that touch", "YADE, ms a step", "its interactions", "ratio"), lines)
            + f"\n\nMedian {np.median(ratios):.1f} at equal steps (wanted 20)." + whole_case(peer["seconds"] / steps, step))


def whole_case(peer, step):
    """Cost of 0.1 s of simulated time: gneiss with its own steps, from the run of the penetration; YADE with the step
    of the comparison."""
    summary = study.RUNS / "dem8" / "penetration" / "summary.json"
    if not summary.exists():
        return ""
    said = json.loads(summary.read_text())
    own, theirs = said["seconds"]["cpu"], said["time"] / step * peer
    return (f" The whole case: gneiss took {said['steps']} steps of its own choice and {own:.0f} s of processor time, YADE would need {theirs:.0f} s for {said['time'] / step:.0f} steps of the "
            f"comparison's: {theirs / own:.1f} times.")


SECTIONS = {
    "penetration": ("Penetration of a bed (Dosta et al. 2024)", penetration, """Written by `validate/dem8_study.py`. 25 000 grains, d 2 mm, lie in a box; a steel sphere, d 20 mm, comes down with 5 m/s. Packing
and walls are the files of the comparison, which came with MercuryDPM and are not part of the project; the materials are theirs (E 1 GPa, nu 0.2, friction 0.3, restitution 0.5
among grains; steel 0.2 and 0.4). All settings are the defaults: step, restitution that may pull, no rolling friction. The files have
no steel sphere: it starts on the axis at z = 60 mm, as the onset of the published curve asks for (first touch at -47.25 mm after 21.0 ms)."""),
    "inputs": ("Penetration: what the inputs do", inputs, """Written by `validate/dem8_study.py`. The same case with one input changed at a time: way of the sphere less the mean of the codes, mm. Friction among grains, with steel
and against rolling brake the sphere, stiffness and restitution hardly matter, and where it hits matters as much as packings scatter. No single input brings the curve between the codes'; one millisecond
after the touch it is too high in all rows, which the place of the bed or of the sphere at the start would make up, not a coefficient."""),
    "drum": ("Drum of two kinds of grains (Dosta et al. 2024)", drum, """Written by `validate/dem8_study.py`. 8 000 grains (d 4 mm, material 2) and 30 000 (d 2 mm, material 1) lie in a drum (R 100, length 60 mm, end panes with it),
the small ones above, that turns by 2 rad/s from the start; places, walls and coefficients are those of the comparison, the moduli softened. The wall rises where x is positive (YADE's
script turns the other way and counts in the quadrants that mirror these). Grains by quadrants about the axis; the codes' own counts are not at hand. The grains, which slip on the smooth
wall, still swing to and fro as a whole after two seconds."""),
    "silo": ("Silo of 100 000 grains (Dosta et al. 2024)", silo, """Written by `validate/dem8_study.py`. Cylinder (R 100 mm) over a cone of 45 degrees, triangles of the comparison; grains of 4 mm from a source of our own rain into it; 0.5 s after the start a
slide opens the orifice. Material and coefficients are those of the comparison, moduli a hundredth. Grains above the orifice over the time since then; the codes' own counts are not at hand. From a cone more
flows than through the flat floor of Beverloo's law."""),
    "yade": ("Penetration: time beside YADE", yade, """Written by `validate/dem8_study.py`. The same grains, walls, materials and step (0.5 us, that of the comparison) for both, the sphere just in touch
with the bed; programs in turns, one thread each, processor time, which other work on the machine changes little. YADE: `Law2_ScGeom_MindlinPhys_Mindlin`, facets, Verlet distance a tenth of
the radius as in its script of the comparison; 60 steps after 10. gneiss: 1260 steps less 60, with ledger, lists and looks at the step. Two threads each were not measured."""),
}


def main():
    folder = folder_of()
    wanted = [a for a in sys.argv[1:] if a in SECTIONS] or list(SECTIONS)
    for name in wanted:
        title, make, words = SECTIONS[name]
        start = time.time()
        study.section(PAGE, title, words + "\n\n" + make(folder))
        print(f"{name}: {time.time() - start:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
