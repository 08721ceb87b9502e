"""Level 3: tests by name beside YADE on small specimens: triaxial under two confinements, Brazilian, and a notched beam. Ends are the same
lists of particles, moved along one axis, in both codes; the confinement is the same forces on the same particles: gneiss finds the
skin (own.skin), YADE gets its areas."""
import numpy as np

import beam
import jobs
import laboratory as lab
import own

ROCK = {**lab.ROCK, "yade": {"fresh": "aligned"}}
SEEDS = (1, 2, 3, 4, 5)  # packings
PAIRED = SEEDS[:3]       # Kinds that are run in YADE as well.
PRESSURES = (5e6, 20e6)
RAMP, HELD = 0.05e-3, 0.1e-3  # s: duration of the pressure ramp, during which the ends are fixed
DISC, THICK = 0.050, 0.025    # m
SHIFTS, PEER_SHIFTS = 4, 2  # Copies of packings changed by round-off: in gneiss of each of PAIRED, in YADE of the first.


def packing(name, shape, count, seed):
    """File of a packing of this number of particles, made by `gneiss pack`."""
    text = (f"specimen:\n  cylinder: {shape}\n  particles: {count}\n  packing: {{size_ratio: 3, overlap: passive}}\n"
            f"run: {{seed: {seed}}}\n")
    return jobs.packed(f"{name}-{seed}", text) / "packing.txt"


def with_steps(job, travel, speed, after):
    """A displacement of `travel` m at `speed` m/s, after an interval at rest, in s."""
    job["dt"] = float(f"{0.9 * own.stable_step(job):.3g}")
    job["steps"] = int((after + travel / speed) / job["dt"])
    job["every"] = max(1, job["steps"] // 1500)
    job["steps"] -= job["steps"] % job["every"]
    job["snapshot_every"] = job["every"] * max(1, job["steps"] // job["every"] // 100)
    return job


def ends_of(job, lists, axis, speed, after, across=None):
    """Two sets that close along an axis, free in spin; across free as well, or held with `across` 0."""
    free = [None] * 3
    for name, ids, sign in (("lower", lists[0], 1), ("upper", lists[1], -1)):
        v = [across] * 3
        v[axis] = [[after, 0.0], [1.5 * after, sign * speed / 2]] if after else sign * speed / 2
        job["sets"].append({"name": name, "ids": ids, "v": v, "w": free})
    return {**job, "ends": ["lower", "upper"], "axis": axis}


def triaxial(seed, pressure):
    path = packing("triaxial", "{diameter: 23 mm, height: 46 mm}", 1000, seed)
    job = {"spheres": str(path), **ROCK, "sets": [], "pressure": {"value": pressure, "ramp": RAMP}, "peak_drop": 0.3}
    # Held laterally, as by rough platens: loads of fixed directions would turn over a specimen without lateral
    # support.
    job = ends_of(job, lab.end_lists(np.loadtxt(path)), 2, 0.4, HELD, 0.0)
    job["yade"] = {**job["yade"], "skin": own.skin(job).tolist()}
    return with_steps(job, 0.035 * lab.LENGTH, 0.4, 1.5 * HELD)


def brazilian(seed):
    """A disc about z that is pressed along y by the particles that reach furthest to both sides."""
    path = packing("brazilian", "{diameter: 50 mm, height: 25 mm}", 1000, seed)
    rows = np.loadtxt(path)
    y, r = rows[:, 1], rows[:, 3]
    depth = 0.5 * r.mean()
    lists = [np.flatnonzero(side * y + r > DISC / 2 - depth).tolist() for side in (-1, 1)]
    job = ends_of({"spheres": str(path), **ROCK, "sets": [], "tension": 10e6, "peak_drop": 0.5}, lists, 1, 0.1, 0.0)
    return with_steps(job, 0.012 * DISC, 0.1, 0.0)


def bending(seed):
    return beam.job_of({"small": True, "seed": seed})


# --- readings ------------------------------------------------------------------------------------------------


def closing(job, run):
    """Approach of the ends, m: the sum of the velocities at the middles of steps."""
    tables = [s["v"][job["axis"]] for s in job["sets"]]
    middle = (np.arange(run["step"][-1]) + 0.5) * job["dt"]
    total = np.zeros(len(middle))
    for table, sign in zip(tables, (1, -1)):
        total += sign * (np.interp(middle, *np.transpose(table)) if isinstance(table, list) else table)
    return np.concatenate([[0.0], np.cumsum(total) * job["dt"]])[run["step"]]


def load(job, run):
    return 0.5 * (run["reaction"][:, 0, job["axis"]] - run["reaction"][:, 1, job["axis"]])


def middle_strain(job, run, size):
    """Strains of the middle (affine fit to the particles within a quarter of `size` along the axis): along the axis and across."""
    axis, start = job["axis"], run["snapshot"][0]
    centre = 0.5 * (start.min(axis=0) + start.max(axis=0))
    inside = np.abs(start - centre)[:, axis] < size / 4
    if axis == 1:
        inside &= np.abs(start - centre)[:, 0] < size / 4
    basis = np.column_stack([np.ones(inside.sum()), start[inside]])
    gradient = np.array([np.linalg.lstsq(basis, (now - start)[inside], rcond=None)[0][1:] for now in run["snapshot"]])
    across = gradient[:, 0, 0] if axis == 1 else 0.5 * (gradient[:, 0, 0] + gradient[:, 1, 1])
    return gradient[:, axis, axis], across


def rising(job, curve, after):
    """Rows from 10 to 50 % of the peak, after the ends have begun to move."""
    peak = int(np.argmax(curve))
    rows = np.arange(len(curve))
    return peak, (rows <= peak) & (curve > 0.1 * curve[peak]) & (curve < 0.5 * curve[peak]) & after


def readings(job, run, area, size):
    """Stiffness over the closing of the ends, ratio of the strains in the middle, largest load and where it is."""
    strain, stress = closing(job, run) / size, load(job, run) / area
    peak, part = rising(job, stress, strain > 0)
    along, across = middle_strain(job, run, size)
    first, last = run["step"][part][[0, -1]]
    inside = (run["snapshot_step"] >= first) & (run["snapshot_step"] <= last)
    return {"E": np.polyfit(strain[part], stress[part], 1)[0], "nu": -np.polyfit(along[inside], across[inside], 1)[0],
            "strength": stress[peak], "strain": strain[peak], "tension": int(run["broken_tension"][peak]),
            "shear": int(run["broken_shear"][peak])}


def of_beam(job, run):
    """Readings of a beam: stiffness N/m, opening of the mouth over the deflection, peak load N, deflection there."""
    r = beam.readings(job, run, {"small": True})
    return {"E": r["stiffness"], "nu": r["opening"] / r["deflection"], "strength": r["load"], "strain": r["deflection"],
            "tension": r["broken"][0], "shear": r["broken"][1]}


TESTS = {f"triaxial, {p/1e6:g} MPa": {"job": lambda seed, p=p: triaxial(seed, p), "read": lambda job, run: readings(job, run, lab.AREA, lab.LENGTH),
                                      "file": f"triaxial-{p/1e6:g}", "stress": lab.AREA} for p in PRESSURES}
TESTS["Brazilian"] = {"job": brazilian, "read": lambda job, run: readings(job, run, np.pi / 2 * DISC * THICK, DISC), "file": "brazilian",
                      "stress": np.pi / 2 * DISC * THICK}
TESTS["bending"] = {"job": bending, "read": of_beam, "file": "bending", "stress": None}


def run_test(name):
    """Job and both codes' runs of the first packing; strengths per paired packing in both codes, the copies shifted by round-off among
    them; strengths in gneiss over packings."""
    test, part = TESTS[name], f"kind-{TESTS[name]['file']}"
    first, pairs, packings = None, [], []
    for seed in SEEDS if test["stress"] else PAIRED:
        job, label = test["job"](seed), part if seed == SEEDS[0] else f"{part}-packing-{seed}"
        mine = jobs.run_gneiss(label, job)
        packings.append(test["read"](job, mine)["strength"])
        if seed not in PAIRED:
            continue
        peer = jobs.run_yade(label, job)
        first = first or (job, mine, peer)
        copies = [(f"{label}-shifted-{k}", beam.shifted(job, k)) for k in range(1, SHIFTS + 1)]
        pairs.append(([packings[-1], *(test["read"](job, jobs.run_gneiss(*copy))["strength"] for copy in copies)],
                      [test["read"](job, peer)["strength"], *(test["read"](job, jobs.run_yade(*copy))["strength"]
                                                              for copy in (copies[:PEER_SHIFTS] if seed == SEEDS[0] else ()))]))
    return *first, pairs, packings


# --- the section ---------------------------------------------------------------------------------------------

INTRO = """## Tests by name

About 1000 spheres each, packed by `gneiss pack` (the first packing, where nothing is said), the contact parameters of the cylinders above; the ends are the same lists of particles,
moved along the axis. **Triaxial**: D 23 mm, L 46 mm, a membrane over the whole surface, whose areas gneiss finds and YADE reads, so that
the same forces, of fixed directions, act on the same particles; they come in {ramp:g} ms, then the ends, which are held across, close at 0.4 m/s. Stiffness is that of the deviator. A particle keeps its
share in YADE, and in gneiss as long as it touches the body. **Brazilian**: a disc of 50 x 25 mm, pressed along y at 0.1 m/s, strength of bonds in tension 10 MPa; stress 2 P/(pi D t) over
closing/D, and beside it the strain across over that along the load in the middle of the disc. **Bending**: the notched beam of the next section
with spheres of 2.4 mm; stiffness in N/m, the ratio is that of the mouth's opening to the deflection, strength the largest load in N.
Slopes from 10 to 50 % of the peak. Scatter in per cent of the strength: of gneiss on {copies} copies with coordinates changed by a relative 1e-12, and over {seeds} packings.
"""

STRENGTHS = """### Strengths of the tests by name, over packings and round-off

Packings in both codes: {paired}; copies of each with coordinates changed by a relative 1e-12: {copies} in gneiss, {peer_copies} (of the first) in YADE. Smallest to largest
of these runs in brackets, MPa (bending: N). Scatter: standard deviation of such copies about their mean, of all packings together. The last column is the difference of the means over
its own standard deviation by that scatter.
"""

HEADS = ["test", "spheres", "bonds", "stiffness gneiss", "YADE", "%", "ratio gneiss", "YADE", "%", "strength gneiss", "YADE", "%",
         "scatter: round-off", "packings", "broken at the peak gneiss", "YADE"]


STRENGTH_HEADS = ["test", "packing", "gneiss", "runs", "YADE", "runs", "difference of the means %", "scatter of a run %", "over what round-off makes of it"]


def within(own_values, peer_values):
    """Degrees of freedom and sum of squares of runs about the means of their code, relative."""
    parts = [np.asarray(values) / np.mean(values) for values in (own_values, peer_values)]
    return sum(len(part) - 1 for part in parts), sum(np.sum((part - 1) ** 2) for part in parts)


def strength_rows(name, pairs):
    scale = 1e6 if TESTS[name]["stress"] else 1
    free, squares = np.sum([within(*pair) for pair in pairs], axis=0)
    scatter, rows = np.sqrt(squares / free), []
    for seed, (mine, peer) in zip(PAIRED, pairs):
        difference = np.mean(peer) / np.mean(mine) - 1
        rows.append([name, seed, *(cell for values in (mine, peer) for cell in (ranged(np.asarray(values) / scale), len(values))),
                     f"{100 * difference:+.2g}", f"{100 * scatter:.2g}", f"{abs(difference) / (scatter * np.sqrt(1 / len(mine) + 1 / len(peer))):.1f}"])
    if len(pairs) < 2:
        return rows
    means = [np.mean([np.mean(pair[code]) for pair in pairs]) for code in (0, 1)]
    counts = [sum(1 / len(pair[0]) + 1 / len(pair[1]) for pair in pairs)]
    difference = means[1] / means[0] - 1
    return [*rows, [name, "all", f"{means[0] / scale:.2f}", sum(len(p[0]) for p in pairs), f"{means[1] / scale:.2f}", sum(len(p[1]) for p in pairs),
                    f"{100 * difference:+.2g}", f"{100 * scatter:.2g}", f"{abs(difference) / (scatter * np.sqrt(counts[0]) / len(pairs)):.1f}"]]


def ranged(values):
    return f"{values.mean():.2f}" + (f" ({values.min():.2f} to {values.max():.2f})" if len(values) > 1 else "")


def row(name, job, own_run, peer_run, pairs, packings):
    import page

    g, y = TESTS[name]["read"](job, own_run), TESTS[name]["read"](job, peer_run)
    stress = TESTS[name]["stress"]
    units = (("E", 1e9 if stress else 1e6, " GPa" if stress else " MN/m", 4), ("nu", 1, "", 4),
             ("strength", 1e6 if stress else 1, " MPa" if stress else " N", 2))
    cells = [name, len(np.loadtxt(job["spheres"])), int(own_run["bonds"])]
    for key, scale, unit, digits in units:
        cells += [f"{g[key]/scale:.{digits}f}{unit}", f"{y[key]/scale:.{digits}f}", page.percent(y[key], g[key])]
    return cells + [f"{page.spread(pairs[0][0]):.2f}", f"{page.spread(packings):.1f}" if len(packings) > len(PAIRED) else "", *(f"{r['tension']} + {r['shear']}" for r in (g, y))]


def picture(found):
    import page

    plt = page.figures()
    figure, axes = plt.subplots(2, 2, figsize=(8, 5.6))
    for axis, (name, (job, own_run, peer_run, *_)) in zip(axes.flat, found.items()):
        stress = TESTS[name]["stress"]
        for run, label, style in ((own_run, "gneiss", "-"), (peer_run, "YADE", "--")):
            if stress:
                axis.plot(1e3 * closing(job, run), load(job, run) / stress / 1e6, style, label=label)
            else:
                deflection, force = beam.load_curve(job, run)
                axis.plot(1e3 * deflection, force, style, label=label)
        axis.set(title=name, xlabel="closing mm" if stress else "deflection mm", ylabel="stress MPa" if stress else "load N")
    axes.flat[0].legend()
    text = page.save(figure, "kinds")
    plt.close(figure)
    return text


def section(options):
    import page

    found = {name: run_test(name) for name in TESTS}
    rows = [row(name, *parts) for name, parts in found.items()]
    pairs = [(TESTS[n]["read"](job, a), TESTS[n]["read"](job, b)) for n, (job, a, b, *_) in found.items()]
    worst = {key: max(abs(100 * (y[key] / g[key] - 1)) for g, y in pairs) for key in ("E", "nu", "strength")}
    table = [line for name, parts in found.items() for line in strength_rows(name, parts[3])]
    whole = {line[0]: line for line in table}  # the last line of a test, over all its packings
    after = (f"Largest differences between the codes: stiffness {worst['E']:.2g} %, ratio {worst['nu']:.2g} %, strength of one run "
             f"{worst['strength']:.2g} %. Asked for: elastic constants within 0.5 %, strengths within the scatter. Means over all packings, YADE's over "
             f"gneiss': {', '.join(f'{name} {line[6]} % ({line[8]} standard deviations)' for name, line in whole.items())}.")
    intro = INTRO.format(ramp=1e3 * RAMP, copies=SHIFTS, seeds=len(SEEDS))
    second = STRENGTHS.format(paired=len(PAIRED), copies=SHIFTS, peer_copies=PEER_SHIFTS)
    return "\n".join([intro, page.table(HEADS, rows), "", picture(found), "", second, page.table(STRENGTH_HEADS, table), "", after])
