"""A membrane whose pressure stages change, or that begins in one. Speaks TAP."""
from program import *  # noqa: F403

STIFFNESS = 1e8
ROCK = {"name": "m", "density": 2600, "normal_stiffness": STIFFNESS, "kratio": 2.5, "bond_tension_limit": 1e30, "bond_shear_limit": 1e30}


def block(stages, **more):
    """A square lattice of discs: chains that carry the pressure on the faces of their cells, so that it closes by p/k_n along both axes."""
    return {"dimension": 2, "specimen": {"lattice": {"kind": "square", "radius": "1 mm", "cells": [8, 8]}}, "materials": [ROCK],
            "law": {"stiffness": "uniform"}, "bonds": {}, "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
            "test": {"kind": "hydrostatic"}, "time": {"end": "20 ms"}, "output": {"history_rows": 200, "snapshots": 0, "checkpoint": "off"},
            "run": {"threads": 1}, "stages": stages, **more}


def run_scene(folder, given, *arguments, name="out"):
    out = os.path.join(folder, name)
    expect(gneiss("run", write_scene(folder, given), "--out", out, "--quiet", *arguments), 0)
    return out


def stage(name, end, **changes):
    return {"name": name, "end": end, **changes}


MANY = [stage("settle", {"time": "0.2 ms"}),
        stage("confine", {"held": 0.001}, membrane={"pressure": "0.1 MPa", "ramp": "1 ms"}),
        stage("go on", {"time": "0.2 ms"}),
        stage("less", {"held": 0.001}, membrane={"pressure": "0.04 MPa"}),
        stage("table", {"time": "2 ms"}, membrane={"pressure": [[0, "0.04 MPa"], ["0.5 ms", "0.2 MPa"]], "ramp": 0}),
        stage("at once", {"time": "2 ms"}, membrane={"pressure": "0.1 MPa"})]


def part(rows, number):
    chosen = rows["stage"] == number
    return {name: values[chosen] for name, values in rows.items()}


@fact
def the_pressure_of_a_stage_comes_from_what_there_is(folder):
    """Times count from the start of the stage, and its settings hold in later stages; the pressure starts from 0 if
    there was none before."""
    out = run_scene(folder, block(MANY))
    rows, begun = history(out), [stage["time"] for stage in summary(out)["stages"]]
    assert len(begun) == 6
    whole, ramp = 1e5, 1e-3
    for number, wanted in ((0, lambda t: 0 * t), (1, lambda t: whole * np.minimum(1, t / ramp)), (2, lambda t: whole + 0 * t),
                           (3, lambda t: whole - 6e4 * np.minimum(1, t / ramp)), (4, lambda t: 4e4 + 1.6e5 * np.minimum(1, t / 5e-4)),
                           (5, lambda t: whole + 0 * t)):
        inside = part(rows, number)
        after = inside["time"] > begun[number]  # the first row is of the step that led there
        assert after.sum() > 3, number
        assert np.allclose(inside["membrane_pressure"][after], wanted(inside["time"][after] - begun[number]), rtol=1e-9, atol=1e-3), number


@fact
def a_membrane_without_pressure_holds_that(folder):
    """The result equals that of a membrane in a list of confinements, of one whose pressure ends at 0 after its ramp, and of a table at its end."""
    table = [[0, "0.1 MPa"], ["1 ms", 0], ["2 ms", 0], ["3 ms", "0.1 MPa"]]
    out = run_scene(folder, block([stage("none", {"held": 0.01, "time": "5 ms"}, membrane={"pressure": 0}),
                                   stage("some", {"held": 0.01}, membrane={"pressure": "0.1 MPa", "ramp": "1 ms"}),
                                   stage("off", {"held": 0.01}, membrane={"pressure": 0, "ramp": "1 ms"}),
                                   stage("back", {"held": 0.01}, membrane={"pressure": table, "ramp": 0})]))
    stages, rows = summary(out)["stages"], history(out)
    assert all(s["ended"] == "the mean stress held the pressure of the membrane to 0.01" for s in stages), [s["ended"] for s in stages]
    times = [part(rows, k)["time"] for k in range(4)]
    assert times[0][-1] - times[0][0] < 1.3e-3 and 1e-3 < times[2][-1] - times[2][0] < 2.3e-3 and times[3][-1] - times[3][0] > 3e-3, times


@fact
def a_stage_that_ends_by_held_waits_for_the_pressure_and_has_it(folder):
    """The stage does not end during the ramp, although the stress follows it; then the lattice is compressed by
    p/k_n."""
    out = run_scene(folder, block(MANY))
    rows, stages = history(out), summary(out)["stages"]
    for number, pressure in ((1, 1e5), (3, 4e4)):
        inside = part(rows, number)
        assert inside["time"][-1] - inside["time"][0] > 1e-3
        assert stages[number]["ended"] == "the mean stress held the pressure of the membrane to 0.001", stages[number]["ended"]
        for name in ("xx", "yy"):
            assert abs(inside["stress_" + name][-1] / -pressure - 1) < 0.002
            assert abs(inside["strain_" + name][-1] / (-pressure / STIFFNESS) - 1) < 0.005, (name, inside["strain_" + name][-1])
    assert abs(rows["energy_residual"][-1]) < 1e-3 and not summary(out)["warnings"], summary(out)["warnings"]


@fact
def a_membrane_of_the_first_stage_is_one_of_the_scene(folder):
    """Both runs have the same bits, also beside a membrane of the scene that a stage repeats."""
    membrane = {"pressure": [[0, "0.1 MPa"], ["1 ms", "0.2 MPa"]], "ramp": "0.3 ms"}
    end = [stage("all", {"time": "1 ms"})]
    plain = block([], membrane=membrane, time={"end": "1 ms"})
    del plain["stages"]
    whole = run_scene(folder, plain, name="plain")
    for k, given in enumerate((block(end, membrane=membrane), block([{**end[0], "membrane": membrane}]),
                               block([{**end[0], "membrane": membrane}], membrane={"pressure": "7 MPa"}))):
        assert state_hash(run_scene(folder, given, name=f"s{k}")) == state_hash(whole), k


@fact
def grains_that_pivot_are_found_when_bonds_form(folder):
    """At the start no bonds exist; supported particles are selected after bonds are formed."""
    given = block([stage("rest", {"steps": 20}), stage("bond", {"time": "0.05 ms"}, bonds={"enabled": "on"}),
                   stage("confine", {"time": "0.2 ms"}, membrane={"pressure": "10 MPa", "ramp": "0.1 ms"})],
                  specimen={"polygon": [[0, 0], [0.04, 0], [0.005, 0.02]], "particles": 500}, bonds={"enabled": "off"},
                  materials=[{"name": "rock", "density": 2600, "contact_modulus": "10 GPa", "kratio": 2.5, "friction": 0.5,
                              "tensile_strength": "300 MPa", "shear_strength": "300 MPa"}], law={"stiffness": "harmonic"})
    out = run_scene(folder, given)
    rows = history(out)
    assert abs(rows["membrane_area"][-1] / 0.0985 - 1) < 0.05 and abs(rows["membrane_area"][-1] / rows["membrane_area"][0] - 1) < 0.003
    for name in ("xx", "yy"):
        assert abs(rows["stress_" + name][-1] / -1e7 - 1) < 0.01, rows["stress_" + name][-1]
    work, held = rows["energy_work_applied"][-1], sum(rows["energy_elastic_" + name][-1] for name in ("normal", "shear"))
    assert abs(work / held - 1) < 0.05, (work, held)


@fact
def confinements_of_a_test_go_to_the_stage_that_confines(folder):
    given = block([stage("settle", {"time": "0.05 ms"}), stage("confine", {"time": "0.2 ms"}, membrane={"pressure": "1 MPa", "ramp": "0.1 ms"})],
                  test={"kind": "biaxial", "axis": "y", "lower": "low", "upper": "high", "length": "16 mm", "area": "0.016 m2",
                        "confinement": ["0.1 MPa", "0.2 MPa", "0.4 MPa"]},
                  walls=[{"name": "low", "point": [0, "-1 mm"], "normal": [0, 1], "stiffness": 1e8},
                         {"name": "high", "point": [0, "15 mm"], "normal": [0, -1], "stiffness": 1e8}])
    path = write_scene(folder, given)
    done = expect(gneiss("run", path, "--out", os.path.join(folder, "all"), "--quiet"), 0)
    found = sorted(history(os.path.join(folder, "all", name))["membrane_pressure"][-1] for name in os.listdir(os.path.join(folder, "all"))
                   if os.path.exists(os.path.join(folder, "all", name, "results.h5")))
    assert np.allclose(found, [1e5, 2e5, 4e5]), (found, done.stdout)
    out = os.path.join(folder, "one")
    expect(gneiss("run", path, "--out", out, "--quiet", "--set", "stages.confine.membrane.pressure=0.3 MPa"), 0)
    assert np.isclose(history(out)["membrane_pressure"][-1], 3e5)
    given["membrane"] = {"pressure": "0.05 MPa"}
    expect(gneiss("run", write_scene(folder, given), "--out", os.path.join(folder, "two")), 2,
           r"scene.yaml:\d+:\d+: test.confinement: expected one membrane pressure")


@fact
def changes_of_a_membrane_that_stages_cannot_make_are_refused(folder):
    confine = stage("b", {"held": 0.01}, membrane={"pressure": "1 MPa"})
    first = stage("a", {"time": "1 ms"})
    for stages, more, pattern in (
            ([first, {**confine, "membrane": {"ramp": "1 ms"}}], {}, r"membrane.pressure: "),
            ([first, {**confine, "membrane": "off"}], {"membrane": {"pressure": 1}}, r"stages\[1\].membrane: expected a key that a stage may change"),
            ([first, {**confine, "membrane": {"follow": False}}], {"membrane": {"pressure": 1}},
             r"stages\[1\].membrane.follow: expected the value before this stage"),
            ([stage("a", {"held": 0.01}), confine], {"membrane": {"pressure": 0}}, r"stages\[0\].end.held: expected a wall or a periodic box with a servo, or a membrane"),
            ([first, {**confine, "membrane": {"pressure": "-1 MPa"}}], {}, r"stages\[1\].membrane.pressure: expected .*\[0, 1e18\]"),
            ([stage("a", {"held": 0.01}), confine], {}, r"stages\[0\].end.held: expected a wall")):
        expect(gneiss("check", write_scene(folder, block(stages, **more))), 2, r"scene.yaml:\d+:\d+: " + pattern)


if __name__ == "__main__":
    sys.exit(main())
