"""Two particles, a chain and a lattice in YADE and in gneiss, step by step. Speaks TAP; skipped without YADE.

Both take shear increments in the middle of a step and let contacts act from the instant at which they close: peer.py changes YADE accordingly, and
its own behaviour counts as another definition here.

1e-9 in the first steps: round-off of positions over displacements, and YADE's turn of the shear force, which is of first order in the angle of a
step. Later differences grow by themselves; another definition makes a difference of 0.1 % and more, so that 1e-4 distinguishes the two."""
import os
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path[:0] = [os.path.join(ROOT, "validate"), os.path.join(ROOT, "validate", "yade")]
from program import *  # noqa: E402, F403

import jobs  # noqa: E402
import steps  # noqa: E402

FIRST, TOGETHER, APART = 1e-9, 1e-4, 1e-3
# Steps, of 9 000: the comparison ends half way to the first break, at step 2 420; many bonds have to break after it.
ENOUGH = {"lattice": 4000, "lattice undamped": 4000}


def skip_without_yade():
    if not jobs.yade_program():
        raise Skip("YADE is not installed")


def check_case(case):
    skip_without_yade()
    found, own, peer, job = steps.measure(case, steps=ENOUGH.get(case))
    assert own["bonds"] == peer["bonds"], (own["bonds"], peer["bonds"])
    first = jobs.worst(found, 10)
    assert first <= FIRST, f"{case}: {first:.2e} in the first 10 steps"
    until = steps.calm(job, own, peer)
    assert case not in ENOUGH or 1000 < until < job["steps"], until
    whole = jobs.worst(found, until)
    assert whole <= TOGETHER, f"{case}: {whole:.2e} within {until} steps"
    if until == job["steps"]:
        assert steps.broken(own) == steps.broken(peer), (steps.broken(own), steps.broken(peer))


def check_difference(number):
    skip_without_yade()
    what, _, case, change, removes = steps.DIFFERENCES[number]
    found, _, _, job = steps.measure(case, change)
    size = jobs.worst(found, job["steps"])
    if removes:
        assert size <= TOGETHER, f"{what}: {size:.2e}"
    else:
        assert size >= APART, f"{what}: only {size:.2e}"


def add(name, check, argument):
    def function(folder):
        check(argument)

    function.__name__ = name
    fact(function)


for name in steps.CASES:
    add(f"both codes agree: {name}", check_case, name)
for index, entry in enumerate(steps.DIFFERENCES):
    verb = "is made equal" if entry[4] else "is another definition"
    add(f"{entry[0]} {verb}", check_difference, index)


def check_order(increment):
    """The difference is of first order in YADE: half the step, half the difference."""
    skip_without_yade()
    (_, whole), (_, half), (_, quarter) = steps.order(increment)
    if increment == "middle":
        assert whole <= TOGETHER, whole
    assert 1.8 < whole / half < 2.2 and 1.8 < half / quarter < 2.2, (whole, half, quarter)


add("what remains, the turn of the shear force, shrinks with the step", check_order, "middle")
add("what the increments of the end differ by shrinks with the step", check_order, "end")

sys.exit(main())
