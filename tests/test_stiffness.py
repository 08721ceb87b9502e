"""gneiss stiffness: constants of a scene's test beside a run of it, JSON, text and what is refused. Speaks TAP."""
from run_reference import *  # noqa: F403

SPECIMEN = """title: small bar
dimension: {dimension}
specimen: {{{shape}, particles: {particles}, packing: {{size_ratio: 2}}, material: m}}
materials:
- {{name: m, density: 2400, contact_modulus: 20 GPa, kratio: 2.5, friction: 0.5, tensile_strength: 1e3 GPa, shear_strength: 1e3 GPa}}
law: {{stiffness: {law}}}
bonds: {{{bonds}}}
damping: {{background: {{model: nonviscous_vector, coefficient: 0.7}}}}
sets:
- {{name: below, select: {{end: {{axis: {axis}, side: lower, depth: 2 mm}}}}, motion: {{v{axis}: [[0, 0], [0.4 ms, -1 mm/s]]}}}}
- {{name: above, select: {{end: {{axis: {axis}, side: upper, depth: 2 mm}}}}, motion: {{v{axis}: [[0, 0], [0.4 ms, 1 mm/s]]}}}}
test: {{kind: tension, axis: {axis}, lower: below, upper: above, length: 40 mm, diameter: 20 mm}}
time: {{end: 2 ms, stop: none}}
output: {{history_rows: 400, snapshots: 0, checkpoint: off}}
run: {{threads: 1}}
"""
SHIPPED = os.path.join(os.path.dirname(SCENES), os.pardir, "scenes")
MOMENTS = "interaction_range: 0.05, radius_multiplier: 1"
CONSTANTS = ("young_modulus", "young_modulus_average", "poisson_ratio")


def bar(folder, dimension=2, law="harmonic", bonds="interaction_range: 0.05", particles=300):
    shape = ("rectangle: {width: 20 mm, height: 40 mm}" if dimension == 2 else "cylinder: {diameter: 20 mm, height: 40 mm}")
    path = os.path.join(folder, "bar.yaml")
    with open(path, "w") as out:
        out.write(SPECIMEN.format(dimension=dimension, shape=shape, particles=particles, law=law, bonds=bonds,
                                  axis="y" if dimension == 2 else "z"))
    return path


def words(*arguments):
    """Exit code, standard output and standard error."""
    done = gneiss(*arguments)
    return done.returncode, done.stdout, done.stderr


def constants(scene, *arguments):
    code, out, err = words("stiffness", scene, "--json", *arguments)
    assert code == 0, err
    assert out.count("\n") == 1, out
    return json.loads(out)


def check_against_run(folder, scene, *arguments):
    """Within 1e-3: the run closes at a fiftieth of a wave's speed times 1e-6, and a wave crosses the specimen two hundred times."""
    static = constants(scene, *arguments)["test"]
    run(scene, os.path.join(folder, "out"), *arguments)
    read = summary(os.path.join(folder, "out"))["readings"]
    for name in CONSTANTS:
        assert abs(static[name] - read[name]) < 1e-3 * abs(read[name]), (name, static[name], read[name])
    return static


@fact
def constants_of_a_bar_of_discs_are_those_of_a_slow_run(folder):
    check_against_run(folder, bar(folder))


@fact
def constants_of_a_bar_of_spheres_are_those_of_a_slow_run(folder):
    check_against_run(folder, bar(folder, 3))


@fact
def bonds_with_moments_agree_with_a_slow_run_too(folder):
    soft = ("--set", "materials.m.kratio=50")  # moments make the larger part of the stiffness
    plain = constants(bar(folder), *soft)["test"]["young_modulus"]
    stiff = check_against_run(folder, bar(folder, bonds=MOMENTS), *soft)["young_modulus"]
    assert stiff > 1.0001 * plain, (stiff, plain)
    check_against_run(folder, bar(folder, 3, bonds=MOMENTS))


@fact
def laws_by_area_agree_with_a_slow_run_too(folder):
    scene = bar(folder)
    with open(scene) as file:
        text = file.read().replace("contact_modulus: 20 GPa, kratio: 2.5", "young: 20 GPa, poisson: 0.2")
    with open(scene, "w") as file:
        file.write(text.replace("stiffness: harmonic", "stiffness: polyhedron"))
    check_against_run(folder, scene)


@fact
def a_shipped_scene_agrees_with_its_own_run(folder):
    check_against_run(folder, os.path.join(SHIPPED, "tension.yaml"), "--set", "output.snapshots=0", "--threads", "1")


@fact
def readings_do_not_depend_on_speed_damping_or_start(folder):
    scene = bar(folder)
    one = constants(scene)["test"]
    other = constants(scene, "--set", "sets.below.motion.vy=-3 m/s", "--set", "sets.above.motion.vy=3 m/s", "--set",
                      "damping.contact.fraction=0.9", "--set", "time.start=first_break", "--set", "time.end=1")["test"]
    for name in CONSTANTS:
        assert abs(one[name] - other[name]) < 2e-5 * abs(one[name]), (name, one[name], other[name])


@fact
def json_has_what_the_documentation_names(folder):
    x = constants(bar(folder, 3))
    assert {"test", "network", "uniform_strain", "uniform_stress", "fabric", "particles", "bonds", "solutions", "iterations",
            "seconds"} <= set(x), x.keys()
    for name in ("network", "uniform_strain", "uniform_stress"):
        c = np.array(x[name]["tensor"])
        assert c.shape == (6, 6) and np.allclose(c, c.T, atol=1e-9 * c[0, 0]), name
        assert {"young_modulus", "poisson_ratio", "anisotropy"} <= set(x[name])
    assert x["uniform_stress"]["young_modulus"] < x["network"]["young_modulus"] < x["uniform_strain"]["young_modulus"]
    assert abs(np.trace(x["fabric"]["second"]) - 1) < 1e-12
    assert x["particles"] == 300 and abs(x["fabric"]["coordination"] - 2 * x["bonds"] / 300) < 1e-12
    assert np.array(constants(bar(folder))["network"]["tensor"]).shape == (3, 3)


@fact
def the_table_has_units_and_the_test(folder):
    code, out, err = words("stiffness", bar(folder))
    assert code == 0 and not err, err
    for text in ("test: tension", "young_modulus", "GPa", "network", "uniform strain", "uniform stress", "boundary:"):
        assert text in out, out
    assert os.listdir(folder) == ["bar.yaml"], os.listdir(folder)


@fact
def a_scene_without_a_test_has_the_constants_of_its_packing(folder):
    scene = bar(folder)
    with open(scene) as file:
        lines = [line for line in file if not line.startswith("test:")]
    with open(scene, "w") as file:
        file.writelines(lines)
    x = constants(scene)
    assert x["test"] is None and "no test" in x["test_absent"] and x["network"]["young_modulus"] > 1e9, x


@fact
def platens_that_touch_few_particles_are_followed_for_any_shear_stiffness(folder):
    scene, young = os.path.join(SHIPPED, "compression.yaml"), []
    for ratio in (1, 10, 100, 1e9):
        found = constants(scene, "--strain", "1e-5", "--set", f"materials.rock.kratio={ratio}", "--set", "walls.top.stiffness=10 GN/m", "--set",
                          "walls.bottom.stiffness=10 GN/m")
        assert found["test"], found["test_absent"]
        young.append(found["test"]["young_modulus"])
        assert found["test"]["young_modulus_average"] < 1.05 * found["uniform_strain"]["young_modulus"]
    assert young == sorted(young, reverse=True), young


@fact
def the_strain_is_that_of_both_ends_however_they_move(folder):
    scene = bar(folder)
    one = constants(scene)["test"]
    other = constants(scene, "--set", "sets.below.motion.vy=0")["test"]
    for name in CONSTANTS:
        assert abs(one[name] - other[name]) < 2e-5 * abs(one[name]), (name, one[name], other[name])
    far = constants(scene, "--strain", "1e-3")["test"]  # bonds rotate, and springs are linear
    assert far["strain"] == 1e-3 and 1e-6 < abs(far["young_modulus"] / one["young_modulus"] - 1) < 5e-3, far
    still = constants(scene, "--set", "sets.below.motion.vy=0", "--set", "sets.above.motion.vy=0")
    assert still["test"] is None and "expected walls or sets that move" in still["test_absent"], still["test_absent"]


@fact
def bonds_hold_whatever_their_strength(folder):
    scene = bar(folder)
    one, other = constants(scene), constants(scene, "--set", "materials.m.tensile_strength=1 Pa", "--precision", "mixed")
    for name in CONSTANTS:
        assert abs(one["test"][name] - other["test"][name]) < 2e-5 * abs(one["test"][name]), (name, one["test"], other["test"])


@fact
def platens_without_a_predicted_load_are_noted_and_tests_without_constants_named(folder):
    triaxial = ("stiffness", os.path.join(SHIPPED, "triaxial.yaml"), "--set", "specimen.particles=200")
    note = r"gneiss: note: no strain at the peak is predicted for this test, and platens are seated by the load: E at a strain of 1e-05 may be too low"
    expect(gneiss(*triaxial), 0, note)
    for path, *more in (triaxial[1:] + ("--strain", "1e-3"), (bar(folder),)):
        assert "note: no strain" not in words("stiffness", path, *more)[2]
    disc = constants(os.path.join(SHIPPED, "brazilian.yaml"), "--set", "specimen.particles=200")
    assert disc["test"] is None and disc["test_absent"] == "such a test gives no elastic constants", disc


@fact
def platens_are_seated_by_the_predicted_load(folder):
    """A run fits rows of equal time while its platens gain speed, and its first breaks soften it: 1 %; at a strain of 1e-5 E is 12 % less."""
    scene, out = os.path.join(SHIPPED, "compression.yaml"), os.path.join(folder, "out")
    run(scene, out, "--set", "output.snapshots=0", "--threads", 1)
    read, found = summary(out)["readings"], constants(scene)["test"]
    small = constants(scene, "--strain", "1e-5")["test"]
    assert found["strain"] > 5e-3 and small["strain"] == 1e-5
    for name in CONSTANTS:
        assert abs(found[name] - read[name]) < 0.01 * read[name], (name, found[name], read[name])
    assert small["young_modulus"] < 0.95 * read["young_modulus"], (small, read["young_modulus"])


@fact
def triaxial_stages_and_membranes_leave_the_loading_alone(folder):
    x = constants(os.path.join(SHIPPED, "triaxial.yaml"))
    y = constants(os.path.join(SHIPPED, "compression.yaml"), "--strain", "1e-5", "--set", "walls.top.stiffness=15 MN/m", "--set",
                  "walls.bottom.stiffness=15 MN/m")
    for name in CONSTANTS:
        assert abs(x["test"][name] - y["test"][name]) < 1e-4 * abs(y["test"][name]), (name, x["test"], y["test"])


@fact
def scenes_without_bonded_particles_are_refused(folder):
    for scene, text in (("hopper.yaml", "no bonds"), ("stages.yaml", "no bonds"), ("beam-elements.yaml", "finite elements"),
                         ("bending-mixed.yaml", "finite elements")):
        code, out, err = words("stiffness", os.path.join(SHIPPED, scene), "--json")
        assert code == 2 and text in err and not out, (scene, code, err)


@fact
def a_box_that_is_periodic_along_some_axes_is_refused(folder):
    scene = os.path.join(folder, "slab.yaml")
    with open(os.path.join(SHIPPED, "simple-shear.yaml")) as file:
        text = file.read().replace("    kratio: 2\n", "    kratio: 2\n    tensile_strength: 1 GPa\n    shear_strength: 1 GPa\n")
    with open(scene, "w") as file:
        file.write(text.replace("\nlaw:", "\nbonds: {}\nlaw:"))
    code, out, err = words("stiffness", scene, "--json")
    assert code == 2 and not out and "slab.yaml: stiffness: expected a box that is periodic along all axes, or none, found 1 of 2" in err, err


@fact
def a_strain_may_have_a_unit(folder):
    scene = bar(folder)
    tests = [constants(scene, "--strain", strain)["test"] for strain in ("1e-3", "0.1%", "1 mm/m")]
    assert tests[0]["strain"] == 1e-3 and tests[1] == tests[0] and tests[2] == tests[0], tests


@fact
def round_off_in_a_tensor_is_printed_as_zero(folder):
    scene = (LATTICE, "--set", "specimen.lattice.jitter=0")
    c = np.array(constants(*scene)["network"]["tensor"])
    small = np.abs(c) < 1e-6 * np.abs(c).max()
    code, out, err = words("stiffness", *scene)
    table = out[out.index("rows and columns"):].splitlines()[1:1 + len(c)]
    printed = np.array([[float(one) for one in line.split()] for line in table])
    assert small.any() and np.array_equal(printed == 0.0, small), (c, printed)


@fact
def options_that_are_wrong_are_refused(folder):
    scene = bar(folder)
    for arguments, text in ((("stiffness", scene, "--strain", "x"), "--strain: expected"),
                             (("stiffness", scene, "--strain", "0.5"), "--strain: expected"),
                             (("stiffness", scene, "--strain", "1 kPa"), "--strain: expected"),
                             (("stiffness", scene, "--strain", "-0.1 %"), "--strain: expected"),
                             (("run", scene, "--json"), "--json is for gneiss stiffness"),
                             (("run", scene, "--strain", "1e-5"), "--strain is for gneiss stiffness"),
                             (("stiffness",), "expected SCENE"),
                             (("stiffness", folder), "found a folder")):
        code, out, err = words(*arguments)
        assert code == 2 and text in err, (arguments, err)


if __name__ == "__main__":
    sys.exit(main())
