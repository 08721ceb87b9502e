"""Level 1 as text: step by step, and the definitions that differ."""
import numpy as np

import jobs
import page
import steps

INTRO = """## Step by step

Both codes take the same steps from the same start; differences are the largest over particles and components of displacement,
velocity, spin and reaction, over the largest value in the same steps. YADE runs JCFpm with `young = 2 E_c`,
`poisson = k_t/k_n`, `tensileStrength = 4 sigma_c/pi`, `cohesion = 4 tau_c/pi`, `neverErase = True`, `avoidGranularRatcheting = False`,
one thread, and the corrections of `validate/yade/peer.py`; gneiss the harmonic law with
`damping.background: {model: nonviscous_component, velocity: instant}`.
"""

AFTER = """
All agree to 1e-9 in the first ten steps. What is left comes from round-off of positions over small displacements, and from the turn of
the shear force with the normal, which YADE does to first order in the angle of a step and gneiss to third: with spins of 3000 to 8000
rad/s the difference after 0.1 ms is {turn}, half of it with half the step. YADE's increments of shear, with the normal and the arms of
the end of a step where gneiss has those of the middle, are of first order too and would make it {increments}; `validate/yade/peer.py`
adds what they lack before YADE's law sees them. The cylinders and the beam below leave YADE its own increments and its own way of closing
and opening contacts: Python at every contact would take longer than YADE. A damped velocity component that
passes zero changes the sign of its damping force; where round-off decides in which step, two runs part (`damping`, `lattice`), which is
why the undamped lattice stays together until its bonds break, and the damped one does not."""

DIFFERENCES = """
### Definitions that differ

Each difference is put back alone; beside it stands what is left when it is removed.
"""


def cases():
    rows = []
    for name, (text, _) in steps.CASES.items():
        found, own, peer, job = steps.measure(name)
        last = job["steps"]
        until = steps.calm(job, own, peer)
        rows.append([name, text, last, *(f"{jobs.worst(found, n):.0e}" for n in (10, 100, until)), until,
                     "{} + {}".format(*steps.broken(own)), "{} + {}".format(*steps.broken(peer))])
    return page.table(["case", "what", "steps", "first 10", "first 100", "until step n", "n", "gneiss broke (tension + shear)",
                       "YADE broke"], rows)


def differences():
    rows = []
    for what, text, case, change, _ in steps.DIFFERENCES:
        found, _, _, job = steps.measure(case, change)
        same, *_ = steps.measure(case)
        rows.append([what, text, case, f"{jobs.worst(found, job['steps']):.0e}", f"{jobs.worst(same, job['steps']):.0e}"])
    return page.table(["definition", "what differs", "case", "differs by", "removed"], rows)


def growth(options):
    plt = page.figures()
    figure, axes = plt.subplots(1, 2, figsize=(8, 3), sharey=True)
    for axis, name in zip(axes, ("lattice", "lattice undamped")):
        found, own, _, _ = steps.measure(name)
        for part, (instants, difference, size) in found.items():
            size = np.maximum.accumulate(size)
            good = (instants > 0) & (size > 0)
            axis.semilogy(instants[good], np.maximum(difference[good] / size[good], 1e-17), label=part)
        first = own["step"][np.argmax(own["broken_tension"] + own["broken_shear"] > 0)]
        axis.axvline(first, color="k", linestyle=":", label="first bond breaks")
        axis.set(xlabel="step", title=name, ylim=(1e-12, 10))
    axes[0].set_ylabel("difference over the largest value so far")
    axes[1].legend(fontsize=6)
    text = page.save(figure, "steps", docs=not options["quick"])
    plt.close(figure)
    return text


def section(options):
    turn, increments = (" / ".join(f"{d:.1e}" for _, d in steps.order(at)) for at in ("middle", "end"))
    return "\n".join([INTRO, cases(), AFTER.format(turn=turn, increments=increments), "", growth(options), DIFFERENCES, differences()])
