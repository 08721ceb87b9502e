"""The notched beam of scenes/bending-particles.yaml in both codes: a packing of its outline, as one layer of spheres that stay in their plane. Supports and load
are the same lists of particles."""
import numpy as np

import beam
import jobs
import own

LENGTH, HEIGHT, NOTCH, SLOT, SPAN = 0.44, 0.1, 0.03, 0.002, 0.4  # m
RADIUS = 0.002  # m, twice that of the scene, so that YADE takes minutes only
CONTACT = {"density": 2400.0, "contact_modulus": 22.4e9, "kratio": 3.0, "friction": 0.5, "tension": 4e6, "shear": 12e6, "interaction_range": 0.1,
           "damping": 0.2}
SPEED = 0.01  # m/s
SHIFTS = 3


def packing():
    left, right = 0.5 * (LENGTH - SLOT), 0.5 * (LENGTH + SLOT)
    outline = [[0, 0], [left, 0], [left, NOTCH], [right, NOTCH], [right, 0], [LENGTH, 0], [LENGTH, HEIGHT], [0, HEIGHT]]
    text = (f"dimension: 2\nspecimen: {{polygon: {outline}, mean_radius: {RADIUS}, packing: {{overlap: passive, size_variation: 0.1}}}}\n"
            "run: {seed: 1}\n")

    def lay(folder):
        rows = np.loadtxt(folder / "packing.txt")
        jobs.write_rows(folder / "layer.txt", np.c_[rows[:, 0], np.zeros(len(rows)), rows[:, 1], rows[:, -1]])

    return jobs.packed("plane-beam", text, lay) / "layer.txt"


def job_of(**more):
    path = packing()
    rows = np.loadtxt(path)
    x, z, r = rows[:, 0], rows[:, 2], rows[:, 3]
    bottom, top = z - r < RADIUS, z + r > HEIGHT - RADIUS
    feet = (np.abs(x - 0.5 * (LENGTH - SPAN)) < 1.5 * RADIUS) | (np.abs(x - 0.5 * (LENGTH + SPAN)) < 1.5 * RADIUS)
    free = [None] * 3
    job = {"spheres": str(path), **CONTACT,
           "sets": [{"name": "rollers", "ids": np.flatnonzero(bottom & feet).tolist(), "v": [None, None, 0.0], "w": free},
                    {"name": "punch", "ids": np.flatnonzero(top & (np.abs(x - 0.5 * LENGTH) < 2.5 * RADIUS)).tolist(), "v": [None, None, -SPEED], "w": free},
                    {"name": "plane", "ids": list(range(len(rows))), "v": [None, 0.0, None], "w": [0.0, None, 0.0]}],
           "ends": ["rollers", "punch"], "axis": 2, "peak_drop": 0.5, "yade": {"fresh": "aligned"}, **more}
    job["dt"] = float(f"{0.9 * own.stable_step(job):.3g}")
    job["steps"] = int(8e-5 / (SPEED * job["dt"]))
    job["every"] = max(1, job["steps"] // 600)
    job["steps"] -= job["steps"] % job["every"]
    job["snapshot_every"] = 10 * job["every"]
    return job


def opening(job, run):
    """Deflection and opening of the mouth of the notch, m, from particles at both sides of it, about 3 mm high."""
    start = run["snapshot"][0]
    moved = run["snapshot"][:, :, 0] - start[:, 0]
    off = start[:, 0] - 0.5 * LENGTH
    sides = [(start[:, 2] < 0.004) & (off * sign > 0) & (off * sign < 0.007) for sign in (-1, 1)]
    return run["snapshot_step"] * job["dt"] * SPEED, moved[:, sides[1]].mean(axis=1) - moved[:, sides[0]].mean(axis=1)


def readings(job, run):
    deflection, load = beam.load_curve(job, run)
    peak = int(np.argmax(load))
    part = (load[:peak + 1] > 0.1 * load[peak]) & (load[:peak + 1] < 0.5 * load[peak])
    at, mouth = opening(job, run)
    return {"stiffness": np.polyfit(deflection[:peak + 1][part], load[:peak + 1][part], 1)[0], "load": load[peak], "deflection": deflection[peak],
            "opening": np.interp(deflection[peak], at, mouth), "broken": (int(run["broken_tension"][peak]), int(run["broken_shear"][peak])),
            "end": (int(run["broken_tension"][-1]), int(run["broken_shear"][-1]))}


def apart(a, b):
    """Mean distance of the bonds broken in one run from the nearest broken in the other, and back, m."""
    first, second = beam.crack(a), beam.crack(b)
    distance = np.linalg.norm(first[:, None] - second[None], axis=2)
    return 0.5 * (distance.min(axis=0).mean() + distance.min(axis=1).mean())


def pictures(job, own_run, peer_run):
    import page

    plt = page.figures()
    figure, axes = plt.subplots(1, 3, figsize=(11, 3))
    for run, label, style in ((own_run, "gneiss", "-"), (peer_run, "YADE", "--")):
        deflection, load = beam.load_curve(job, run)
        axes[0].plot(1e6 * deflection, load, style, label=label)
        at, mouth = opening(job, run)
        axes[1].plot(1e6 * mouth, np.interp(at, deflection, load), style, label=label)
        points = beam.crack(run)
        axes[2].plot(1e3 * points[:, 0], 1e3 * points[:, 2], "o" if label == "gneiss" else "x", markersize=4, fillstyle="none", label=label)
    axes[0].set(xlabel="deflection of the punch, micrometres", ylabel="load N")
    axes[1].set(xlabel="opening of the mouth, micrometres", ylabel="load N")
    axes[2].set(xlabel="x mm", ylabel="z mm", title="broken bonds at the end", aspect="equal", xlim=(190, 250), ylim=(0, 100))
    for axis in axes:
        axis.legend()
    text = page.save(figure, "plane-beam")
    plt.close(figure)
    return text


INTRO = """## The notched beam of scenes/bending-particles.yaml

Its outline ({length:g} x {height:g} mm, notch of {notch:g} mm, supports {span:g} mm apart) packed with mean radius {radius:g} mm, as one layer of {spheres} spheres that stay in
their plane, {bonds} bonds; contacts of that scene, load at {speed:g} mm/s. Supports ({rollers} particles) and punch ({punch}) are the same lists in both codes.
"""


def section(_):
    import page

    job = job_of()
    own_run, peer_run = jobs.both("plane-beam", job)
    g, y = (readings(job, run) for run in (own_run, peer_run))
    copies = [jobs.run_gneiss(f"plane-beam-shifted-{k}", beam.shifted(job, k)) for k in range(1, SHIFTS + 1)]
    loads = [g["load"], *(readings(job, run)["load"] for run in copies)]
    rows = [[what, f"{g[k] / s:.{d}f}", f"{y[k] / s:.{d}f}", page.percent(y[k], g[k])]
            for what, k, s, d in (("stiffness, N/micrometre", "stiffness", 1e6, 3), ("peak load, N", "load", 1, 2),
                                  ("deflection at the peak, micrometres", "deflection", 1e-6, 2), ("opening at the peak, micrometres", "opening", 1e-6, 2))]
    rows += [[what, "{} + {}".format(*g[k]), "{} + {}".format(*y[k]), ""]
             for what, k in (("broken at the peak (tension + shear)", "broken"), ("broken at the end", "end"))]
    intro = INTRO.format(length=1e3 * LENGTH, height=1e3 * HEIGHT, notch=1e3 * NOTCH, span=1e3 * SPAN, radius=1e3 * RADIUS,
                         spheres=own_run["snapshot"].shape[1], bonds=int(own_run["bonds"]), speed=1e3 * SPEED, rollers=len(job["sets"][0]["ids"]),
                         punch=len(job["sets"][1]["ids"]))
    after = (f"Of all bonds broken in either code {100 * beam.agreement(own_run, peer_run):.0f} % are broken in both; their mean distance from the nearest of the other "
             f"code is {apart(own_run, peer_run) / (2 * RADIUS):.2f} mean diameters (of gneiss and its own copies with coordinates changed by a relative 1e-12: "
             f"{max(apart(own_run, run) for run in copies) / (2 * RADIUS):.2f} at most). Peak load over these {len(loads)} runs of gneiss: {min(loads):.2f} to "
             f"{max(loads):.2f} N. Asked for: peak within 3 %, the same path.")
    return "\n".join([intro, page.table(["", "gneiss", "YADE", "%"], rows), "", pictures(job, own_run, peer_run), "", after])
