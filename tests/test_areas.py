"""Laws by area and random properties of bonds in runs: the same bits on any number of threads and after
interruptions, a closed energy ledger, output files. Speaks TAP."""
from program import *  # noqa: F403

# All other options: two materials, values for a pair, scatter, dashpots, background damping, walls, friction,
# gravity.
ROCK = {"name": "rock", "density": 2500, "young": 20e9, "poisson": 0.2, "alpha": 1.2, "friction": 0.5,
        "tensile_strength": 3e6, "shear_strength": 9e6, "strength_scatter": {"distribution": "weibull", "modulus": 4},
        "stiffness_scatter": {"distribution": "normal", "deviation": 0.2}}
SCENE = {
    "specimen": {"lattice": {"kind": "hcp", "radius": 1e-3, "cells": [5, 3, 4], "jitter": 0.03}, "material": "rock"},
    "materials": [ROCK, {"name": "steel", "density": 7800, "young": 200e9, "poisson": 0.3, "friction": 0.3,
                         "tensile_strength": 5e8, "shear_strength": 5e8}],
    "contacts": [{"between": ["steel", "rock"], "friction": 0.2, "tensile_strength": 1e6}],
    "law": {"stiffness": "polyhedron"},
    "bonds": {"interaction_range": 0.1},
    "damping": {"background": {"model": "nonviscous_component", "coefficient": 0.1}, "contact": {"restitution": 0.8}},
    "gravity": [0, 0, -9.81],
    "sets": [{"name": "cap", "select": {"end": {"axis": "z", "side": "upper", "depth": 2e-3}}, "material": "steel"}],
    "walls": [{"name": "bottom", "point": [0, 0, 0], "normal": [0, 0, 1], "stiffness": 5e7, "kratio": 2, "friction": 0.3, "passive": True},
              {"name": "top", "point": [0, 0, 0.0134], "normal": [0, 0, -1], "stiffness": 5e7, "kratio": 2, "friction": 0.3,
               "passive": True, "motion": {"vz": -2}}],
    "test": {"kind": "compression", "axis": "z", "lower": "bottom", "upper": "top"},
    "time": {"end": 1.5e-4, "stop": "none"},  # the spacing is set by rows, which a prolonged run places differently
    "output": {"history_rows": 50, "snapshots": 5},
    "run": {"seed": 3},
}


def scene(folder, **changes):
    return write_scene(folder, {key: value for key, value in {**SCENE, **changes}.items() if value is not None})


def ran(folder, name, *arguments, **changes):
    place = os.path.join(folder, name)
    run(scene(folder, **changes), place, *arguments)
    return place


def breaks(folder):
    counts = summary(folder)["counts"]
    assert counts["broken_tension"] > 20 and counts["broken_shear"] > 20, counts


@fact
def two_threads_give_the_bits_of_one_and_bonds_break(folder):
    one = ran(folder, "one", "--threads", 1)
    breaks(one)
    check_same(ran(folder, "two", "--threads", 2), one)


@fact
def a_resumed_run_has_the_bits_of_one_without_a_break(folder):
    one = ran(folder, "one", "--threads", 1)
    two = ran(folder, "two", "--threads", 1, "--set", "time.end=7e-5")
    resume(two, "--threads", 2, "--set", "time.end=1.5e-4")
    assert state_hash(one) == state_hash(two)


@fact
def bonds_that_hold_beyond_their_strength_in_shear_have_a_finite_share_of_it(folder):
    # A bond pulled beyond R_t/mu_1 has zero shear strength, and its tensile force continues to soften.
    place = os.path.join(folder, "out")
    run(write_scene(folder, {
        "dimension": 2, "specimen": {"particles": [[0, 0, 1e-3], [2e-3, 0, 1e-3], [4e-3, 2e-4, 1e-3]]},
        "materials": [{"name": "a", "density": 1000, "friction": 0.3, "contact_modulus": 1e10, "kratio": 5, "tensile_strength": 3e7,
                       "shear_strength": 3e7, "bond_friction": 0.7, "fracture_ratio": 10}],
        "law": {"stiffness": "arithmetic", "softening": "ratio", "coupling": "linear"}, "bonds": {"interaction_range": 0.1},
        "sets": [{"name": "lo", "select": {"ids": [0]}, "motion": {"vx": 0}}, {"name": "hi", "select": {"ids": [2]}, "motion": {"vx": 1}}],
        "time": {"end": 1e-4}, "domain": {"min": [-1, -1], "max": [1, 1]}}), place)
    with h5py.File(os.path.join(place, "results.h5")) as file:
        share, state = file["bonds/criterion"][()], file["bonds/state"][()]
    assert np.all(np.isfinite(share)) and np.all((share < 1) == ((state == 0) | (state > 3))), (share, state)


@fact
def a_seed_decides_what_is_drawn_for_bonds(folder):
    done = gneiss("run", scene(folder), "--seeds", 2, "--out", os.path.join(folder, "seeds"), "--quiet", "--set", "time.end=1e-6")
    assert done.returncode == 0 and "no random number" not in done.stderr, done.stderr


@fact
def single_precision_keeps_bits_and_readings(folder):
    mixed = {**SCENE["run"], "precision": "mixed"}
    one, two = ran(folder, "one", "--threads", 1, run=mixed), ran(folder, "two", "--threads", 2, run=mixed)
    check_same(one, two)
    breaks(one)
    # Rounding decides which bond breaks first: compared without breaks, over which rounding (6e-8) grows in
    # proportion to the steps.
    strong = [{**m, "tensile_strength": 1e12, "shear_strength": 1e12} for m in SCENE["materials"]]
    held = [ran(folder, precision, "--threads", 1, materials=strong, contacts=None, run={**mixed, "precision": precision})
            for precision in ("double", "mixed")]
    a, b = (history(place)["stress"] for place in held)
    assert np.max(np.abs(a - b)) < 6e-8 * summary(held[0])["steps"] * np.max(np.abs(a)), np.max(np.abs(a - b)) / np.max(np.abs(a))
    assert abs(summary(one)["energy_residual"]) < 0.01, summary(one)["energy_residual"]


@fact
def the_energy_ledger_closes(folder):
    for law in ("polyhedron", "dempack"):
        one = ran(folder, law, "--threads", 1, law={"stiffness": law})
        breaks(one)
        assert abs(summary(one)["energy_residual"]) < 0.01, summary(one)["energy_residual"]


@fact
def another_seed_draws_other_bonds(folder):
    still = {**SCENE["specimen"], "lattice": {**SCENE["specimen"]["lattice"], "jitter": 0}}  # the random shifts of the lattice depend on the seed as well
    one, two = (ran(folder, str(seed), "--threads", 1, specimen=still, run={"seed": seed}) for seed in (3, 4))
    assert state_hash(one) != state_hash(two)


@fact
def sections_and_stresses_of_bonds_are_written(folder):
    one = ran(folder, "one", "--threads", 1)
    with results(one) as file:
        area, stress, force = (file["bonds"][name][:] for name in ("area", "contact_stress", "force"))
        state = file["bonds/state"][:]
    assert np.all(area > 0) and np.all(np.isfinite(stress))
    held = state == 0
    assert np.any(stress[held] < 0)
    assert np.all(np.abs(stress) * area <= np.linalg.norm(force, axis=1) * (1 + 1e-9) + 1e-12)


@fact
def check_shows_what_parameters_follow(folder):
    done = expect(gneiss("check", scene(folder)), 0)
    for words in (r"sections fill +0\.\d+ of the body: sum\(A L\)/\(3 V\)", r"k_n of bonds +\S+ to \S+, mean \S+ N/m",
                  r"k_t +\S+ to", r"R_n +\S+ to", r"R_t +\S+ to", r"section A"):
        assert re.search(words, done.stdout), words


@fact
def check_warns_of_sections_that_do_not_fill_the_body(folder):
    path = scene(folder, law={"stiffness": "dempack", "gamma": 2}, contacts=[])
    assert re.search(r"warning: sections fill \d\S* of the body instead of 1", expect(gneiss("check", path), 0).stdout)


@fact
def uniform_strain_is_given_for_one_material(folder):
    lattice = {"lattice": {"kind": "cubic", "radius": 1e-3, "cells": [4, 4, 4]}, "material": "rock"}
    path = scene(folder, specimen=lattice, materials=[ROCK], contacts=[], sets=[], walls=[], test=None, law={"stiffness": "dempack"})
    found = re.search(r"uniform strain +E (\S+) Pa, nu (\S+),", expect(gneiss("check", path), 0).stdout)
    rho = 1 / 1.2 / 2.4
    assert abs(float(found.group(1)) / (1.2 * 20e9 * (2 + 3 * rho) / (4 + rho)) - 1) < 1e-5, found.group(0)
    assert abs(float(found.group(2)) - (1 - rho) / (4 + rho)) < 1e-4, found.group(0)


sys.exit(main())
