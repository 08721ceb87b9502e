"""The average strain of a specimen that loses particles is that of the remaining particles. Speaks TAP."""
from program import *  # noqa: F403

ROCK = {"name": "a", "density": 2600, "contact_modulus": "20 GPa", "kratio": 2.5, "friction": 0.5, "tensile_strength": "10 MPa",
        "shear_strength": "40 MPa"}
BEYOND = {"min": [-0.01, -1], "max": [1, 1], "lost": "remove"}


def block(chip, **more):
    """Discs in a hexagonal lattice, 12 wide; those of `chip` are pulled away to the left at 20 m/s, 40 mm in all."""
    given = {"dimension": 2, "specimen": {"lattice": {"kind": "hexagonal", "radius": 1e-3, "cells": [12, 8, 1]}}, "materials": [ROCK],
             "law": {"stiffness": "harmonic"}, "bonds": {}, "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
             "sets": [{"name": "chip", "select": chip, "motion": {"vx": -20.0, "vy": 0.0}}], "time": {"end": 2e-3},
             "output": {"history_rows": 200, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}
    return {**given, **more}


def run_scene(folder, given, *arguments, name="out", code=0):
    out = os.path.join(folder, name)
    expect(gneiss("run", write_scene(folder, given), "--out", out, "--quiet", *arguments), code)
    return out


def strains(out):
    rows = history(out)
    return {part: rows["strain_" + part] for part in ("xx", "yy", "xy")}


CORNER = {"ids": [0, 1, 2]}


@fact
def detached_particles_do_not_count_as_strain_of_the_rest(folder):
    """Three discs of a corner, which fly off or leave the model: the remaining body is not loaded. (The error was 20
    % if they flew on and 8 % if they were removed, due to the strain of their last position.)"""
    for name, more in (("flies", {}), ("goes", {"domain": BEYOND})):
        found = strains(run_scene(folder, block(CORNER, **more), name=name))
        assert max(abs(e[-1]) for e in found.values()) < 1e-6, (name, [e[-1] for e in found.values()])
        assert max(np.abs(e).max() for e in found.values()) < 0.01, name


@fact
def grains_that_were_never_bonded_count_until_they_are_taken_out(folder):
    """One of the grains, which do not touch, flies off, and leaves the model if it has a domain."""
    given = block({"ids": [0]}, bonds={"enabled": "off"}, specimen={"particles": [[2.1e-3 * i, 2.1e-3 * j, 1e-3] for i in range(12) for j in range(8)]})
    assert strains(run_scene(folder, given, name="flies"))["xx"][-1] > 0.05
    found = strains(run_scene(folder, {**given, "domain": BEYOND}, name="goes"))
    assert not any(e[-1] for e in found.values()), [e[-1] for e in found.values()]


@fact
def there_is_no_average_strain_once_half_has_left(folder):
    """Eight of twelve columns are removed from the model: rows are no longer numbered by id, and the run continues."""
    out = run_scene(folder, block({"box": {"min": [-1, -1], "max": [0.0155, 1]}}, domain=BEYOND))
    found, rows = strains(out), history(out)
    gone = np.isnan(found["xx"])
    assert np.isfinite(found["xx"][:10]).all() and gone[-1] and (np.diff(gone.astype(int)) >= 0).all(), found["xx"]
    assert all((np.isnan(e) == gone).all() for e in found.values())
    assert abs(rows["time"][-1] - 2e-3) < 2e-5, rows["time"][-1]
    expect(gneiss("report", out), 0)


@fact
def a_block_that_lies_apart_from_the_start_has_not_come_off(folder):
    """A sixteenth of the other body, moving to the right at 1 m/s from the start, while a chip of the large one is
    pulled off to the left: its weight in the mean is the same as without a chip."""
    large = [[2e-3 * i, 2e-3 * j, 1e-3] for i in range(12) for j in range(8)]
    small = [[0.03 + 2e-3 * i, 2e-3 * j, 1e-3] for i in range(3) for j in range(2)]
    found = {}
    for name, pull in (("stays", 0.0), ("goes", -20.0)):
        given = block({"ids": [0, 8]}, specimen={"particles": large + small})
        given["sets"] = [{"name": "chip", "select": {"ids": [0, 8]}, "motion": {"vx": pull, "vy": 0.0}},
                         {"name": "small", "select": {"ids": list(range(96, 102))}, "motion": {"vx": 1.0, "vy": 0.0}}]
        found[name] = strains(run_scene(folder, given, name=name))["xx"]
    assert found["stays"][-1] > 0.01 and abs(found["goes"][-1] / found["stays"][-1] - 1) < 0.2, (found["goes"][-1], found["stays"][-1])


@fact
def the_strain_of_the_remaining_specimen_is_the_same_after_a_stop_and_on_two_threads(folder):
    given = block(CORNER, domain=BEYOND)
    whole = run_scene(folder, given, name="whole")
    found = {"threads": strains(run_scene(folder, given, "--threads", "2", name="threads"))}
    for rows in (13, 80):  # rows as far apart
        part = run_scene(folder, given, "--set", f"time.end={rows / 100} ms", "--set", f"output.history_rows={rows}", name=f"part{rows}")
        resume(part, "--set", "time.end=2 ms")
        found[rows] = strains(part)
    for name, rows in found.items():
        assert all(np.array_equal(rows[part], wanted) for part, wanted in strains(whole).items()), (name, len(rows["xx"]))


if __name__ == "__main__":
    sys.exit(main())
