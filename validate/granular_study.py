"""Grains beside published laws: discharge of a silo (Beverloo et al. 1961), load on the floor of a bin (Janssen 1895), angles of
repose. Writes docs/evidence/granular.md; one thread, some ten minutes of one core.

    /usr/bin/python3 validate/granular_study.py
"""
import json
import sys

import numpy as np

import study

PAGE = study.ROOT / "docs" / "evidence" / "granular.md"
D = 3e-3  # m, mean diameter
GRAIN = {"name": "grain", "density": 2500, "young": 2e6, "poisson": 0.25, "friction": 0.5, "rolling_friction": 0.05,
         "restitution": 0.5}
G = 9.81
SIZES = {"mean_radius": D / 2, "size_ratio": 1.2}


def run(name, scene, snapshots=0):
    """Runs a scene (a dictionary) by one thread; kept as all studies keep theirs."""
    path = study.RUNS / "granular" / f"{name}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"dimension": 3, "law": {"stiffness": "hertz"}, "gravity": [0, 0, -G], **scene}, indent=1))
    return study.run(f"granular/{name}", path, {"run.threads": 1, "output.snapshots": snapshots})


def grains(result):
    """Places and radii of those that are there at the end."""
    there = result.results("particles/removed").reshape(-1) == 0
    return result.results("particles/position")[there], result.results("particles/radius").reshape(-1)[there]


def tube(name, diameter, height, base=0.0, **more):
    return {"name": name, "cylinder": {"diameter": diameter, "height": height, "sides": 48, "open": True},
            "origin": [0, 0, base], "friction": 0.5, **more}


def sides(wide):
    """Four walls about a square."""
    return [{"name": f"{axis}{sign}", "point": [-sign * wide / 2 * (axis == "x"), -sign * wide / 2 * (axis == "y"), 0],
             "normal": [sign * (axis == "x"), sign * (axis == "y"), 0], "friction": 0.5}
            for axis in "xy" for sign in (1, -1)]


# --- silo ----------------------------------------------------------------------------------------------

def silo(ratio, friction=0.5, rolling=0.05, most=3500):
    """A silo with an orifice of `ratio` diameters: filled, then opened. (bulk density, kg/s, grains that left, residual)"""
    grain = {**GRAIN, "friction": friction, "rolling_friction": rolling}
    other = "" if grain == GRAIN else f"-{friction}-{rolling}"
    orifice, wide = ratio * D, (ratio + 10) * D
    deep = 18 * D
    count = int(0.6 * wide**2 * deep / (np.pi / 6 * D**3))
    bodies = [{**tube("bottom", orifice, 1e-4), "cylinder": {
        "diameter": orifice, "upper_diameter": 1.5 * wide, "height": 1e-4, "sides": 48, "open": True}}]
    slide = {"name": "slide", "box": {"size": [2 * orifice, 2 * orifice, 0.01]}, "friction": 0.5,
             "origin": [-orifice, -orifice, -0.0101]}
    domain = {"min": [-wide, -wide, -0.1], "max": [wide, wide, 5 * deep], "lost": "remove"}
    inner = wide - D
    source = {"name": "feed", "box": {"size": [inner, inner, deep]}, "origin": [-inner / 2, -inner / 2, 1.2 * deep],
              "rate": 1e5, "total": count, "velocity": [0, 0, -1.5], **SIZES}
    filled = run(f"silo-{ratio}{other}-fill", {
        "materials": [grain], "sources": [source], "bodies": [*bodies, slide], "walls": sides(wide), "domain": domain,
        "time": {"end": 0.4},
        "output": {"history_rows": 50}})
    x, r = grains(filled)
    low, high, inside = 4 * D, 12 * D, wide / 2 - 3 * D
    # Of every sphere with its centre 3 d from the walls or farther the part between two planes.
    near = np.abs(x[:, :2]).max(axis=1) < inside
    top, bottom = np.clip((high - x[near, 2]) / r[near], -1, 1), np.clip((low - x[near, 2]) / r[near], -1, 1)
    part = np.pi * r[near]**3 * ((top - top**3 / 3) - (bottom - bottom**3 / 3))
    density = GRAIN["density"] * part.sum() / (4 * inside**2 * (high - low))
    rate = 0.58 * density * np.sqrt(G) * (orifice - 1.4 * D)**2.5
    mass = GRAIN["density"] * np.pi / 6 * D**3
    end = min(0.6 * count * mass, most * mass) / rate
    emptied = run(f"silo-{ratio}{other}-empty", {
        "specimen": {"from": str(study.RUNS / f"granular/silo-{ratio}{other}-fill"), "from_velocities": "rest", "group": 0},
        "materials": [grain], "bodies": bodies, "walls": sides(wide), "domain": domain,
        "sinks": [{"name": "out", "plane": {"point": [0, 0, -10 * D], "normal": [0, 0, -1]}}],
        "time": {"end": end}, "output": {"history_rows": 400}})
    time, out = emptied.results("history/time").reshape(-1), emptied.results("history/sink_out_mass").reshape(-1)
    # Behind the onset; both halves of the rows tell how steady it is.
    first = np.searchsorted(out, 0.15 * out[-1])
    half = (first + len(time)) // 2
    slopes = [np.polyfit(time[a:b], out[a:b], 1)[0] for a, b in ((first, len(time)), (first, half), (half, len(time)))]
    return {"ratio": ratio, "friction": friction, "rolling": rolling, "orifice": orifice, "density": density, "rate": slopes[0], "halves": slopes[1] / slopes[2],
            "number": emptied.summary["sinks"][0]["number"], "count": len(r), "residual": emptied.residual,
            "seconds": filled.seconds + emptied.seconds}


def beverloo():
    found = [silo(ratio) for ratio in (6, 9, 12)]
    other = silo(9, 0.2, 0.0, 2000)
    effective = np.array([f["orifice"] - 1.4 * D for f in found])
    rate = np.array([f["rate"] / f["density"] for f in found])
    exponent = np.polyfit(np.log(effective), np.log(rate), 1)[0]
    for f in [*found, other]:
        f["constant"] = f["rate"] / (f["density"] * np.sqrt(G) * (f["orifice"] - 1.4 * D)**2.5)
    rows = [[f["ratio"], f["friction"], f["rolling"], f["count"], f"{f['density']:.0f}", f"{f['number']}", f"{f['rate']:.4g}", f"{f['halves']:.3f}",
             f"{f['constant']:.3f}", f"{f['residual']:.1e}"] for f in [*found, other]]
    text = study.table(("D/d", "mu", "mu_r", "grains", "bulk density, kg/m3", "grains out", "W, kg/s", "first over second half", "C", "residual"), rows)
    return text + (f"\n\nExponent of W/rho_b over D - 1.4 d, of the first three: {exponent:.3f} (wanted 2.5 +- 0.1). C with 2.5: "
                   f"{min(f['constant'] for f in found):.3f} to {max(f['constant'] for f in found):.3f} with friction 0.5 among grains and rolling "
                   f"0.05, {other['constant']:.3f} with 0.2 and none (wanted 0.55 to 0.65).")


# --- bin -----------------------------------------------------------------------------------------------

def bin_of(count):
    """Floor force while the floor goes down slowly, and what is in the bin."""
    wide, speed = 12 * D, 2e-2
    high = 1.2 * count * np.pi / 6 * D**3 / 0.55 / wide**2
    fill, inner = 0.15 + 0.25 * count / 2000, wide - D
    done = run(f"bin-{count}", {
        "materials": [GRAIN], "walls": [*sides(wide), {"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.5,
                   "motion": {"vz": [[0, 0], [fill, 0], [fill + 0.01, -speed]]}}],
        "sources": [{"name": "feed", "box": {"size": [inner, inner, 20 * D]}, "origin": [-inner / 2, -inner / 2, high + 5 * D],
                     "rate": 2e4, "total": count, "velocity": [0, 0, -1], **SIZES}],
        "domain": {"min": [-0.1, -0.1, -0.05], "max": [0.1, 0.1, 4 * high + 0.3]},
        "time": {"end": fill + 0.35}, "output": {"history_rows": 400}})
    time = done.results("history/time").reshape(-1)
    force = -done.results("history/wall_floor_force_z").reshape(-1)
    mass = done.results("history/source_feed_mass").reshape(-1)[-1]
    late = time > fill + 0.1
    x, r = grains(done)
    depth = np.percentile(x[:, 2], 99) + D / 2 - x[:, 2].min() + D / 2
    return count, mass * G, force[late].mean(), force[late].std(), force[(time > fill - 0.03) & (time < fill)].mean(), depth, wide


def janssen():
    found = [bin_of(count) for count in (500, 1000, 2000, 4000)]
    weight, force = np.array([f[1] for f in found]), np.array([f[2] for f in found])
    # F = F_s (1 - exp(-W/F_s)): one number to fit.
    tried = np.linspace(0.05, 2, 4000) * weight[-1]
    missed = [(((s * (1 - np.exp(-weight / s))) / force - 1)**2).sum() for s in tried]
    most = tried[int(np.argmin(missed))]
    wide = found[0][-1]
    density = np.mean([f[1] / G / (wide**2 * f[5]) for f in found])
    length = most / (density * G * wide**2)
    k = wide / (4 * 0.5 * length)
    rows = [[f[0], f"{f[5] / wide:.2f}", f"{f[1]:.3f}", f"{f[4]:.3f}", f"{f[2]:.3f} +- {f[3]:.3f}",
             f"{most * (1 - np.exp(-f[1] / most)):.3f}"] for f in found]
    return study.table(("grains", "depth over diameter", "weight, N", "floor before, N", "floor going down, N", "Janssen, N"), rows) + (
        f"\n\nFitted: saturation at {most:.3f} N, so K = {k:.2f} with the friction 0.5 of the wall (wanted 0.4 to 0.6).")


# --- heap ----------------------------------------------------------------------------------------------

def heap(friction, rolling, young=2e6):
    """Angle of the flank of a heap left by a tube that was lifted, degrees."""
    wide, count = 16 * D, 800
    grain = {**GRAIN, "friction": friction, "rolling_friction": rolling, "young": young}
    done = run(f"heap-{friction}-{rolling}-{young:.0e}", {
        "materials": [grain], "damping": {"background": {"model": "viscous", "coefficient": 0.5}},
        "bodies": [{**tube("tube", wide, 0.3, 2e-4), "friction": 0.1,
                    "motion": {"vz": [[0, 0], [0.25, 0], [0.3, 0.12], [3, 0.12]]}}],
        "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.9, "rolling_friction": 0.5}],
        "sources": [{"name": "feed", "cylinder": {"diameter": wide - 2 * D, "height": 40 * D}, "origin": [0, 0, 10 * D],
                     "rate": 1e5, "total": count, "velocity": [0, 0, -1], **SIZES}],
        "domain": {"min": [-0.4, -0.4, -0.05], "max": [0.4, 0.4, 0.5], "lost": "remove"},
        "time": {"end": 1.1}, "output": {"history_rows": 50}})
    x, r = grains(done)
    away = np.hypot(x[:, 0], x[:, 1])
    rings = np.arange(0, np.percentile(away, 95), 1.5 * D)
    tops = [((a + 0.75 * D), (x[near, 2] + r[near]).max()) for a in rings
            if (near := (away >= a) & (away < a + 1.5 * D)).sum() > 3]
    tops = np.array(tops)
    flank = tops[(tops[:, 1] > 0.2 * tops[:, 1].max()) & (tops[:, 0] > 1.5 * D)]
    return float(np.degrees(np.arctan(-np.polyfit(flank[:, 0], flank[:, 1], 1)[0]))) if len(flank) > 2 else float("nan")


def repose():
    rollings = (0.0, 0.2)
    rows = [[mu, *(f"{heap(mu, roll):.1f}" for roll in rollings)] for mu in (0.15, 0.4, 0.8)]
    text = study.table(("mu", *(f"mu_r {roll}" for roll in rollings)), rows)
    stiff = heap(0.4, 0.2, 8e6)
    return text + f"\n\nWith four times the stiffness (E 8 MPa), mu 0.4 and mu_r 0.2: {stiff:.1f} degrees."


SECTIONS = {
    "Discharge of a silo": (beverloo, """Beverloo et al. 1961: W = C rho_b sqrt(g) (D - k d)^2.5, k = 1.4 held. Square silos 10 d wider than the round orifice in their flat
bottom, filled 18 d deep by a source, d = 3 mm (sizes 1:1.2), Hertz-Mindlin, E 2 MPa, friction 0.5 throughout, rolling 0.05, restitution 0.5. The bulk density is that of the
filled silo, 4 to 12 d above the floor and 3 d from its wall; W is the slope of the mass through a sink after the first 15 % of it."""),
    "Load on the floor of a bin": (janssen, """Janssen 1895: F = F_s (1 - exp(-W/F_s)), W the weight, F_s = rho_b g A D/(4 mu_w K). Four walls 12 d apart, the same grains; once they lie
still the floor goes down by 20 mm/s for 0.35 s, so that they slide along the walls; means of the last 0.25 s (they have moved by 0.7 to 2.3 d then). Poured
grains are wedged between the walls: before that the floor bears more than the weight."""),
    "Angle of repose": (repose, """800 grains in a tube, 16 d wide, that is lifted by 0.12 m/s from a rough floor: slope of a line through the tops of rings (1.5 d) of the heap, degrees.
There is no law to hold it against but that it rises with mu and mu_r, and then no more. One heap each: so few grains leave the slope uncertain by some two degrees, as
neighbouring cells show; only between the corners of the table is the rise beyond that."""),
}


def main():
    wanted = [a for a in sys.argv[1:] if not a.startswith("--")]
    page = PAGE.read_text() if PAGE.exists() else ""
    parts = {}
    for title, (make, words) in SECTIONS.items():
        old = page.partition(f"## {title}\n\n")[2].partition("\n## ")[0]
        if wanted and not any(w in title for w in wanted):
            parts[title] = old.rstrip()
            continue
        parts[title] = words + "\n\n" + make()
    text = "\n\n".join(f"## {title}\n\n{part}" for title, part in parts.items() if part)
    PAGE.write_text(f"# Granular flow\n\nWritten by `validate/granular_study.py`; do not edit.\n\n{text}\n")


if __name__ == "__main__":
    main()
