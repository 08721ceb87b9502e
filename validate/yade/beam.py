"""Level 3: a notched beam of bonded spheres in three-point bending; punch and rollers are the same lists of particles, moved or
held along z, in both codes. Contact parameters of YADE's own example of the test (examples/AcousticEmissions/bendingTest.py):
E_c = young/2 = 15 GPa, k_t/k_n = 0.3, tensile strength 10 MPa, cohesion 40 MPa, density 5000 kg/m3, damping 0.2, 20 mm/s there."""
from pathlib import Path

import numpy as np

import jobs
import own

PROPORTIONS = np.array([6.0, 1.0, 2.0])  # length x, thickness y, height z over the thickness: 240 x 40 x 80 mm
SPAN = 5.0                               # span over the thickness
CONTACT = {"density": 5000.0, "contact_modulus": 15e9, "kratio": 1 / 0.3, "friction": float(np.tan(np.radians(19))),
           "tension": np.pi / 4 * 10e6, "shear": np.pi / 4 * 40e6, "interaction_range": 0.05, "damping": 0.2}
SPEED = 0.01  # m/s of the punch


def sizes(options):
    """Thickness (m) and mean radius (m): a beam of half the example's size with its radius, or the example's own; small: coarser."""
    return (0.040, 0.0015) if options.get("large") else (0.020, 0.0024 if options.get("small") else 0.0015)


def packing(options):
    thickness, radius = sizes(options)
    length, width, height = PROPORTIONS * thickness
    seed = options.get("seed", 1)
    text = (f"specimen:\n  box: {{size: [{length}, {width}, {height}]}}\n  origin: [{-length / 2}, 0, 0]\n"
            f"  mean_radius: {radius}\n  packing: {{size_ratio: 3, overlap: passive}}\nrun: {{seed: {seed}}}\n")

    def notch(folder):
        """A slot as wide as a mean particle and a quarter of the height deep, at mid-span."""
        rows = np.loadtxt(folder / "packing.txt")
        inside = (np.abs(rows[:, 0]) < radius) & (rows[:, 2] < height / 4)
        jobs.write_rows(folder / "notched.txt", rows[~inside])

    name = "beam" + "".join(f"-{size}" for size in ("large", "small") if options.get(size)) + (f"-{seed}" if seed > 1 else "")
    return jobs.packed(name, text, notch) / "notched.txt"


def job_of(options, speed=SPEED, **more):
    thickness, radius = sizes(options)
    _, _, height = PROPORTIONS * thickness
    path = packing(options)
    rows = np.loadtxt(path)
    x, z, r = rows[:, 0], rows[:, 2], rows[:, 3]
    half, reach = SPAN * thickness / 2, 1.5 * radius
    bottom, top = z - r < radius, z + r > height - radius
    rollers = np.flatnonzero(bottom & (np.abs(np.abs(x) - half) < reach)).tolist()
    punch = np.flatnonzero(top & (np.abs(x) < reach)).tolist()
    free = [None] * 3
    job = {"spheres": str(path), **CONTACT, "sets": [{"name": "rollers", "ids": rollers, "v": [None, None, 0.0], "w": free},
                                                     {"name": "punch", "ids": punch, "v": [None, None, -speed], "w": free}],
           "ends": ["rollers", "punch"], "axis": 2, "peak_drop": 0.7, "yade": {"fresh": "aligned"}, **more}
    job["dt"] = float(f"{0.9 * own.stable_step(job):.3g}")
    job["steps"] = int(2.5e-3 * thickness / (speed * job["dt"]))  # deflections up to 1/400 of the thickness
    job["every"] = max(1, job["steps"] // 1500)
    job["steps"] -= job["steps"] % job["every"]
    job["snapshot_every"] = 10 * job["every"]
    return job


def load_curve(job, run):
    """Deflection (m) of the punch and load (N)."""
    speed = -job["sets"][1]["v"][2]
    return run["step"] * job["dt"] * speed, 0.5 * (run["reaction"][:, 0, 2] - run["reaction"][:, 1, 2])


def opening(job, run, options):
    """Deflection and crack mouth opening (m): particles beside the mouth of the notch."""
    _, radius = sizes(options)
    start = run["snapshot"][0]
    mouth = start[:, 2] < 2 * radius
    left = mouth & (start[:, 0] < 0) & (start[:, 0] > -4 * radius)
    right = mouth & (start[:, 0] > 0) & (start[:, 0] < 4 * radius)
    moved = run["snapshot"][:, :, 0] - start[:, 0]
    speed = -job["sets"][1]["v"][2]
    return run["snapshot_step"] * job["dt"] * speed, moved[:, right].mean(axis=1) - moved[:, left].mean(axis=1)


def crack(run):
    """Middles of the broken bonds at the start, [n, 3]."""
    start = run["snapshot"][0]
    return 0.5 * (start[run["broken"][:, 0]] + start[run["broken"][:, 1]])


INTRO = """## Three-point bending of a notched beam

{spheres} spheres (mean radius {radius:g} mm) in {length:g} x {height:g} x {thickness:g} mm, packed by `gneiss pack`, {bonds} bonds; a slot of a quarter of the
height is cut by leaving particles out. Rollers ({rollers} particles) are held and the punch ({punch}) is moved at {speed:g} mm/s along z, the same lists in
both codes, everything else free. Contact parameters of YADE's own example of the test: E_c 15 GPa, k_t/k_n 0.3, tensile
strength 10 MPa, cohesion 40 MPa, friction 19 degrees, damping 0.2. Opening: the particles on both sides of the slot's mouth.
"""


def readings(job, run, options):
    deflection, load = load_curve(job, run)
    peak = int(np.argmax(load))
    part = (load[:peak + 1] > 0.1 * load[peak]) & (load[:peak + 1] < 0.5 * load[peak])
    at, mouth = opening(job, run, options)
    return {"stiffness": np.polyfit(deflection[:peak + 1][part], load[:peak + 1][part], 1)[0], "load": load[peak],
            "deflection": deflection[peak], "opening": np.interp(deflection[peak], at, mouth),
            "broken": (int(run["broken_tension"][peak]), int(run["broken_shear"][peak])), "end": (int(run["broken_tension"][-1]),
                                                                                           int(run["broken_shear"][-1]))}


def agreement(a, b):
    """Broken bonds of one run that are broken in the other too, over those broken in either."""
    first, second = ({tuple(sorted(pair)) for pair in run["broken"].tolist()} for run in (a, b))
    return len(first & second) / len(first | second)


def path(run, options):
    """Mean x of the broken bonds per slice of the height, and z of the slices, m; NaN where nothing broke."""
    thickness, _ = sizes(options)
    height = PROPORTIONS[2] * thickness
    edges = np.linspace(height / 4, height, 9)
    points = crack(run)
    slot = np.digitize(points[:, 2], edges)
    near = np.abs(points[:, 0]) < thickness / 2
    mean = [points[(slot == k) & near, 0].mean() if ((slot == k) & near).any() else np.nan for k in range(1, len(edges))]
    return np.array(mean), 0.5 * (edges[1:] + edges[:-1])


def pictures(job, own_run, peer_run, options):
    import page

    plt = page.figures()
    figure, axes = plt.subplots(2, 2, figsize=(8, 5.2))
    for run, label, style in ((own_run, "gneiss", "-"), (peer_run, "YADE", "--")):
        deflection, load = load_curve(job, run)
        axes[0, 0].plot(1e6 * deflection, load, style, label=label)
        at, mouth = opening(job, run, options)
        axes[0, 1].plot(1e6 * mouth, np.interp(at, deflection, load), style, label=label)
    axes[0, 0].set(xlabel="deflection of the punch, micrometres", ylabel="load N")
    axes[0, 1].set(xlabel="opening of the mouth, micrometres", ylabel="load N")
    axes[0, 0].legend()
    for axis, run, label in ((axes[1, 0], own_run, "gneiss"), (axes[1, 1], peer_run, "YADE")):
        start, points = run["snapshot"][0], crack(run)
        axis.plot(1e3 * start[:, 0], 1e3 * start[:, 2], ".", color="0.8", markersize=1)
        axis.plot(1e3 * points[:, 0], 1e3 * points[:, 2], "r.", markersize=3)
        for s in job["sets"]:
            axis.plot(1e3 * start[s["ids"], 0], 1e3 * start[s["ids"], 2], "b.", markersize=3)
        axis.set(title=f"{label}: broken bonds at the end", aspect="equal", xlabel="x mm", ylabel="z mm")
    text = page.save(figure, "beam")
    plt.close(figure)
    return text


SHIFTS = 5


def shifted(job, number):
    rows = np.loadtxt(job["spheres"])
    rows[:, :3] *= 1 + 1e-12 * np.random.default_rng(number).uniform(-1, 1, rows[:, :3].shape)
    path = jobs.RUNS / "specimens" / f"{Path(job['spheres']).parent.name}-shifted-{number}.txt"
    text = "".join(" ".join(repr(v) for v in row) + "\n" for row in rows.tolist())
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    return {**job, "spheres": str(path)}


def section(options):
    import page

    job, name = job_of(options), "beam-large" if options.get("large") else "beam"
    own_run, peer_run = jobs.both(name, job)
    g, y = (readings(job, run, options) for run in (own_run, peer_run))
    copies = [jobs.run_gneiss(f"{name}-shifted-{k}", shifted(job, k)) for k in range(1, SHIFTS + 1)]
    loads = [g["load"], *(readings(job, run, options)["load"] for run in copies)]
    rows = [[what, f"{g[k]/s:.{d}f}", f"{y[k]/s:.{d}f}", page.percent(y[k], g[k])]
            for what, k, s, d in (("stiffness, N/micrometre", "stiffness", 1e6, 3), ("peak load, N", "load", 1, 1),
                                  ("deflection at the peak, micrometres", "deflection", 1e-6, 2),
                                  ("opening at the peak, micrometres", "opening", 1e-6, 2))]
    rows += [[what, "{} + {}".format(*g[k]), "{} + {}".format(*y[k]), ""]
             for what, k in (("broken at the peak (tension + shear)", "broken"), ("broken at the end", "end"))]
    thickness, radius = sizes(options)
    size = 1e3 * PROPORTIONS * thickness
    intro = INTRO.format(spheres=len(np.loadtxt(job["spheres"])), radius=1e3 * radius, length=size[0], height=size[2],
                         thickness=size[1], bonds=int(own_run["bonds"]), rollers=len(job["sets"][0]["ids"]),
                         punch=len(job["sets"][1]["ids"]), speed=1e3 * SPEED)
    (a, _), (b, _) = path(own_run, options), path(peer_run, options)
    both = np.isfinite(a) & np.isfinite(b)
    off = np.abs(a - b)[both].max() / radius if both.any() else float("nan")
    same = [agreement(own_run, run) for run in copies]
    after = (f"Of all bonds broken in either code {100*agreement(own_run, peer_run):.0f} % are broken in both; of gneiss and its own copies "
             f"with coordinates changed by a relative 1e-12, {100*min(same):.0f} to {100*max(same):.0f} %. The middle of the crack, in eight slices of the "
             f"height above the slot, differs by at most {off:.1f} mean radii between the codes. Peak load over these {len(loads)} runs of gneiss: "
             f"{min(loads):.1f} to {max(loads):.1f} N, scatter {page.spread(loads):.2f} %. Asked for: peak within 3 %, the same path.")
    return "\n".join([intro, page.table(["", "gneiss", "YADE", "%"], rows), "", pictures(job, own_run, peer_run, options), "", after])
