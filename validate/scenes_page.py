"""Random small scenes over the whole range of what gneiss runs: how many end well, and which do not."""
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
no warning; `warned`: a residual above 1 %; `stopped`: a particle left the domain; `went bad`: anything else, above all a ledger that does
not close to 10 %, which stops a run. The largest residual is that of those that ended.
"""


def number(value):
    return "-" if value is None else f"{value:.2g}" if isinstance(value, float) else str(value)


def worst(outcomes):
    """The ones that went bad, then the largest residuals of those that warned."""
    bad = [o for o in outcomes if o.how == random_scenes.BAD]
    warned = sorted((o for o in outcomes if o.how == random_scenes.WARNED and o.residual), key=lambda o: -abs(o.residual))
    rows = [[o.seed, o.kind, o.how, number(o.residual), random_scenes.OPEN.get(o.seed) or o.text[:120].replace("|", " ")]
            for o in bad + warned[:10]]
    return page.table(["seed", "kind", "", "residual", "cause"], rows) if rows else ""


def section(options):
    outcomes = random_scenes.run_all(os.path.abspath(study.PROGRAM), range(SCENES), study.THREADS)
    head, rows = random_scenes.table(outcomes)
    text = INTRO + "\n" + page.table(head, rows)
    text += "\n\nThose that went bad, and the ten largest residuals of the others:\n\n" + worst(outcomes)
    return text + "\n\n`/usr/bin/python3 tests/random_scenes.py build/gneiss --seed N` runs one, `--seed N --write DIR` writes it.\n"
