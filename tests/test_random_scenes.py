"""Random small scenes over the whole range of what gneiss runs, at the default settings of the step: none fails. Speaks TAP.
A number behind the program: only so many scenes are run, without the hard ones of MORE. `random_scenes.py PROGRAM --seed N` runs one
of them, `--seed N --write DIR` writes it."""
import functools
import os
import sys

import random_scenes

PROGRAM = os.path.abspath(sys.argv[1])
SCENES = int(sys.argv[2]) if len(sys.argv) > 2 else 200
# Crowds in exact touch, in single precision and a periodic box (with sides all round): contacts without a path in the first steps.
MORE = (1003, 1395, 2067)
# A specimen that disintegrates long before its lists are rebuilt.
MORE += (560,)
# Undamped bodies of few bonds each, some of them broken or damaged: collisions last half the steps of a
# contact.
MORE += (1673, 3639, 13405)


def main():
    print(f"1..{len(random_scenes.KINDS)}")
    more = MORE if len(sys.argv) == 2 else ()
    outcomes, failed = random_scenes.run_all(functools.partial(random_scenes.run, PROGRAM), [*range(SCENES), *more]), 0
    for seed in sorted(set(random_scenes.OPEN) & set(range(SCENES))):
        print(f"# left open: seed {seed}: {random_scenes.OPEN[seed]}")
    for number, kind in enumerate(random_scenes.KINDS, 1):
        bad = [o for o in outcomes if o.kind == kind and o.how == random_scenes.BAD and o.seed not in random_scenes.OPEN]
        for o in bad:
            print(f"# seed {o.seed}: {o.text}")
        failed += bool(bad)
        count = sum(o.kind == kind for o in outcomes)
        print(f"{'not ok' if bad else 'ok'} {number} none of {count} random scenes goes bad: {kind}", flush=True)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
