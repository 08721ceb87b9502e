"""Random small scenes over the whole range of what gneiss runs: how many end as they should, and which do not."""
import collections
import functools
import os
import sys

import page
import study

sys.path.append(str(study.ROOT / "tests"))
import random_scenes  # noqa: E402

SCENES = 2100

INTRO = """## Random scenes

Scenes of 1 to 500 particles drawn at random: lattices, gases, periodic boxes, sizes of up to 1 to 100, rigid bodies, finite elements, bonds; every law,
friction, restitution 0 to 1, every background damping, gravity, walls that stand, close, shear or carry a force, held and thrown sets,
densities of up to 1 to 1000, both precisions, up to 1e6 extents from 0. A scene follows from its seed (`tests/random_scenes.py`), speeds and forces from
its stiffness and masses, so that overlaps stay well below the smallest radius. The step is the automatic one with nothing set. `ended well`: exit code 0,
no warning; `warned`: exit code 0 with a warning, of the energy ledger (`energy_residual`: its residual is above 1 %) or of the scene alone, which the
second table counts; `stopped`: a particle left the domain; `went bad`: anything else, above all a ledger that does not close to 10 %, which
stops a run. The largest residual is that of those that ended.
"""


def number(value):
    return "-" if value is None else f"{value:.2g}" if isinstance(value, float) else str(value)


def worst(outcomes):
    """The scenes that failed, then the largest residuals of those that warned of energy."""
    bad = [o for o in outcomes if o.how == random_scenes.BAD]
    warned = sorted((o for o in outcomes if of_energy(o) and o.residual), key=lambda o: -abs(o.residual))
    rows = [[o.seed, o.kind, o.how, number(o.residual), random_scenes.OPEN.get(o.seed) or o.text[:120].replace("|", " ")]
            for o in bad + warned[:10]]
    return page.table(["seed", "kind", "", "residual", "cause"], rows) if rows else ""


def of_energy(outcome):
    """True where a warning of the energy ledger is among those of an outcome."""
    return outcome.how == random_scenes.WARNED and "energy_" in outcome.text


def counts(outcomes):
    """The table of tests/random_scenes.py with the scenes that warned in two columns: of the energy ledger, and of the scene alone."""
    head, rows = random_scenes.table(outcomes)
    at = head.index(random_scenes.WARNED)
    for row in rows:
        energy = sum(of_energy(outcome) for outcome in outcomes if row[0] in (outcome.kind, "all"))
        row[at:at + 1] = [energy, row[at] - energy]
    return page.table([*head[:at], "warned of energy", "of the scene alone", *head[at + 1:]], rows)


def warnings(outcomes):
    """Number of scenes with each warning, the most frequent first."""
    names = collections.Counter(name for o in outcomes if o.how == random_scenes.WARNED for name in o.text.split("; "))
    return page.table(["warning", "scenes"], [[f"`{name}`", number] for name, number in names.most_common()])


def section(options):
    outcomes = random_scenes.run_all(functools.partial(random_scenes.run, os.path.abspath(study.PROGRAM)), range(SCENES), study.THREADS)
    text = "\n\n".join([INTRO.rstrip(), counts(outcomes), warnings(outcomes)])
    text += "\n\nThose that went bad, and the ten largest residuals of those that warned of energy:\n\n" + worst(outcomes)
    return text + "\n\n`/usr/bin/python3 tests/random_scenes.py build/gneiss --seed N` runs one, `--seed N --write DIR` writes it.\n"
