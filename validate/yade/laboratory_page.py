"""Level 2 as text: compression and tension of cylinders."""
import numpy as np

import jobs
import laboratory as lab
import page

INTRO = """## Cylinders in compression and tension

D 23 mm, L 46 mm, the contact parameters of `scenes/ucs-rock.yaml` with damping 0.7 in the component form. The ends are the
particles whose surface lies within a mean radius of the end planes: the same lists in both codes, moved along z alone, free across and in
spin. Compression closes at {ucs} m/s (twice the speed of `scenes/ucs-rock.yaml`, alike in both codes, to save YADE's time), tension
opens at {tension} m/s. Both codes take the same steps: 0.9 of the limit that gneiss finds. `E`: slope from 1 to 50 % of the peak over the
motion of the ends; `nu`: affine fit to the displacements of the middle half over the same rows, the same script for both. Broken
bonds: in tension + in shear.
"""

HEADS = ["specimen", "spheres", "bonds", "E GPa gneiss", "YADE", "%", "nu gneiss", "YADE", "%", "strength MPa gneiss", "YADE", "%",
         "strain at peak % gneiss", "YADE"]
BREAKS = ["specimen", "broken at the peak gneiss", "YADE", "at half the peak, past it gneiss", "YADE", "strain there % gneiss",
          "YADE", "first bonds that differ at stress over peak"]


def own_row(name, job, g, y):
    spheres = len(np.loadtxt(job["spheres"]))
    cells = [name, spheres, g["bonds"]]
    for key, scale, digits in (("E", 1e9, 4), ("nu", 1, 5), ("strength", 1e6, 2)):
        cells += [f"{g[key]/scale:.{digits}f}", f"{y[key]/scale:.{digits}f}", page.percent(y[key], g[key])]
    return cells + [f"{100*g['strain']:.3f}", f"{100*y['strain']:.3f}"]


def parting(job, own, peer):
    """Stress over peak at which the two codes' counts of broken bonds first differ."""
    n = min(len(own["step"]), len(peer["step"]))
    differ = [own[k][:n] != peer[k][:n] for k in ("broken_tension", "broken_shear")]
    both = differ[0] | differ[1]
    stress = lab.curve(job, own)[1]
    return f"{stress[np.argmax(both)] / stress.max():.2f}" if both.any() else "none"


def break_row(name, job, own, peer, g, y):
    return [name, *("{} + {}".format(r["tension" + at], r["shear" + at]) for at in ("", "_end") for r in (g, y)),
            *(f"{100*r['half_strain']:.3f}" for r in (g, y)), parting(job, own, peer)]


def plot(test, found, docs):
    plt = page.figures()
    columns = min(3, len(found))
    lines = -(-len(found) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(3.1 * columns, 2.6 * lines), squeeze=False)
    for axis in axes.flat[len(found):]:
        axis.axis("off")
    for axis, (name, (job, own, peer, _)) in zip(axes.flat, found.items()):
        for run, label, style in ((own, "gneiss", "-"), (peer, "YADE", "--")):
            strain, stress = lab.curve(job, run)
            axis.plot(100 * strain, stress / 1e6, style, label=label)
        axis.set(title=name, xlabel="strain %", ylabel="stress MPa")
    axes.flat[0].legend()
    text = page.save(figure, test.lower(), docs)
    plt.close(figure)
    return text


def chaos_rows(found):
    rows = []
    for name, (job, own, peer, shifts) in found.items():
        g, y = lab.readings(job, own), lab.readings(job, peer)
        cells = [name]
        for code, r in (("gneiss", g), ("YADE", y)):
            values = [r["strength"], *(s[0] for s in shifts[code])]
            if len(values) > 1:
                cells += [len(values), f"{np.mean(values)/1e6:.2f}", f"{page.spread(values):.2f}",
                          f"{min(values)/1e6:.2f} to {max(values)/1e6:.2f}"]
            else:
                cells += [1, f"{values[0]/1e6:.2f}", "", ""]
        rows.append(cells)
    return page.table(["specimen", "gneiss runs", "UCS MPa mean", "scatter %", "from - to", "YADE runs", "UCS MPa mean",
                       "scatter %", "from - to"], rows)


def packing_text(packings):
    rows = []
    for test, runs in packings.items():
        for key, label, scale, digits in (("strength", "strength MPa", 1e6, 2), ("E", "E GPa", 1e9, 3), ("nu", "nu", 1, 4)):
            values = np.array([r[key] for name, r in runs.items() if name in lab.PACKED])
            rows.append([test, label, len(values), f"{values.mean()/scale:.{digits}f}", f"{page.spread(values):.2f}",
                         f"{values.min()/scale:.{digits}f} to {values.max()/scale:.{digits}f}"])
    return page.table(["test", "reading", "packings", "mean", "scatter %", "from - to"], rows)


def frictional_text(found):
    rows, chaos = [], []
    for name, (job, own, peer, strengths) in found.items():
        g, y = lab.readings(job, own), lab.readings(job, peer)
        rows.append(own_row(name, job, g, y))
        values = [g["strength"], *strengths]
        chaos.append([name, len(values), f"{np.mean(values)/1e6:.2f}", f"{page.spread(values):.2f}",
                      f"{min(values)/1e6:.2f} to {max(values)/1e6:.2f}", f"{y['strength']/1e6:.2f}",
                      page.percent(y["strength"], np.mean(values)), *(f"{r['tension_end']} + {r['shear_end']}" for r in (g, y))])
    return page.table(HEADS, rows) + "\n\n" + page.table(
        ["specimen", "gneiss runs", "UCS MPa mean", "scatter %", "from - to", "YADE", "% from that mean",
         "broken at half the peak gneiss", "YADE"], chaos)


def variant_text(variants):
    _, base_own, base_peer = variants[0]
    rows = []
    for what, g, y in variants:
        for code, r, base in (("gneiss", g, base_own), ("YADE", y, base_peer)):
            if r:
                rows.append([what, code, f"{r['E']/1e9:.3f}", page.percent(r["E"], base_own["E"]), f"{r['nu']:.4f}",
                             f"{r['strength']/1e6:.1f}", page.percent(r["strength"], base_own["strength"]),
                             f"{100*r['strain']:.3f}", f"{r['tension_end']} + {r['shear_end']}"])
    return page.table(["rock-b, UCS", "code", "E GPa", "% from gneiss", "nu", "UCS MPa", "% from gneiss", "strain at peak %",
                       "broken at half the peak"], rows)


def verdict(found, packings):
    """The content of the tables, in numbers."""
    lines = []
    for test, runs in found.items():
        pairs = [(lab.readings(job, own), lab.readings(job, peer)) for job, own, peer, _ in runs.values()]
        worst = {k: max(abs(100 * (y[k] / g[k] - 1)) for g, y in pairs) for k in ("E", "nu", "strength")}
        lines.append(f"{test}: largest differences between the codes: E {worst['E']:.2g} %, nu {worst['nu']:.2g} %, strength "
                     f"{worst['strength']:.2g} %")
    text = "; ".join(lines) + ". Asked for: elastic constants within 0.5 %, strength within the scatter over packings"
    if packings:
        scatter = [f"{test} {page.spread([r['strength'] for n, r in runs.items() if n in lab.PACKED]):.1f} %"
                   for test, runs in packings.items()]
        text += f" ({', '.join(scatter)}, below)"
    return text + "."


def section(options):
    names = ("rock-b",) if options["quick"] else lab.BESIDE_YADE
    tests = ("UCS",) if options["quick"] else tuple(lab.TESTS)
    docs = not options["quick"]
    found, missing = {test: {} for test in tests}, []
    for test in tests:
        for name in names:
            try:
                found[test][name] = lab.run_test(test, name)
            except jobs.NotKept as what:
                missing.append(str(what))
    parts = [INTRO.format(ucs=lab.TESTS["UCS"]["closing"], tension=lab.TESTS["tension"]["closing"])]
    for test in tests:
        rows, breaks = [], []
        for name, (job, own, peer, _) in found[test].items():
            g, y = lab.readings(job, own), lab.readings(job, peer)
            rows.append(own_row(name, job, g, y))
            breaks.append(break_row(name, job, own, peer, g, y))
        parts += [f"### {test}\n", page.table(HEADS, rows), "", page.table(BREAKS, breaks), "", plot(test, found[test], docs), ""]
    if missing:
        parts += [f"Not run in YADE yet: {', '.join(missing)}.\n"]
    parts += [verdict(found, None if options["quick"] else lab.run_packings()), "", CHAOS, chaos_rows(found["UCS"])]
    if not options["quick"]:
        parts += ["", PACKINGS, packing_text(lab.run_packings()), "", VARIANTS, variant_text(lab.run_variants()), "", AFTER,
                  "", FRICTIONAL, frictional_text(lab.run_frictional()), "", CONCRETE]
    return "\n".join(parts)


CHAOS = """### What round-off does to the strength

Until bonds break, the two codes differ by round-off. Breaking multiplies it: the same packing with its coordinates changed by a relative
1e-12 gives another strength, in either code. Agreement closer than this scatter cannot be asked for.
"""

PACKINGS = """### Scatter over packings

Five packings of 2000 spheres by `gneiss pack` (seeds 1 to 5), in gneiss. Scatter: standard deviation over the mean.
"""

VARIANTS = """### What each definition is worth on rock-b

The first rows are the same definitions in both codes; then one difference at a time is put back.
"""

AFTER = """With `frictionAngle = atan(mu)` YADE's bonds are stronger in shear under pressure, and weaker under tension; the bonds of the first rows
are not, with `frictionAngle = 0` and friction given to broken bonds from Python. gneiss has that strength as well (next table)."""

FRICTIONAL = """### Bonds that pressure strengthens

JCFpm's own strength in shear, R_t - mu_1 f_n, with `frictionAngle = atan(0.5)` in YADE, `bond_friction: 0.5` and `law.coupling: linear` in gneiss;
broken bonds have friction 0.5 in both. Scatter: gneiss on the packing and four copies shifted by a relative 1e-12.
"""

CONCRETE = """YADE's Cpm (`CpmMat`, for concrete) is another law, and was not compared. In the form that is published one damage follows the largest
root of stretch strain squared plus (weighted) shear strain squared, linearly or exponentially, and takes both the pulled stiffness and
the cohesion, which is the tensile strength; slip beyond cohesion and friction is plastic, and does no damage unless its weight is set.
Here stretch and slip soften by energies of their own. It gives ductility as a ratio of strains (`relDuctility`), so that what a crack
dissipates grows with the particles (`law.softening: strain` or `ratio` here; `energy` does not). Under pressure it has one slope beyond
`epsSoft` and unloads elastically, as `yield_stress_1` does. Its section is pi r_min^2. It can have a viscosity of damage and of slip, and
a prestress, which are not here."""
