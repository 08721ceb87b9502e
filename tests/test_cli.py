"""Commands, options, messages and output files. Speaks TAP."""
import math
import random
from concurrent.futures import ThreadPoolExecutor

import program
from program import *  # noqa: F403

READINGS = ("young_modulus", "poisson_ratio", "peak_stress", "peak_strain")
OUT = tempfile.mkdtemp(prefix="gneiss-ucs-")


def ucs():
    """The output folder of one run of the small UCS."""
    if not os.path.exists(os.path.join(OUT, "summary.json")):
        run(UCS, OUT, "--threads", 2)
    return OUT


# --- commands that only look ------------------------------------------------------------------------------

@fact
def help_names_every_command_option_and_exit_code(folder):
    out = expect(gneiss("--help"), 0).stdout
    for word in ("run", "check", "plan", "resume", "report", "keys", "info", "--out", "--set", "--threads",
                 "--precision", "--isa", "--force", "--quiet", "--log", "--markdown", "--version"):
        assert re.search(r"(^|\s)" + word + r"\b", out), f"{word} is missing"
    assert all(re.search(rf"\b{code} \w", out.split("exit codes")[1]) for code in range(7))


@fact
def every_command_has_help_of_its_own_with_an_example(folder):
    whole = expect(gneiss("help"), 0).stdout
    assert whole == gneiss("--help").stdout
    commands = re.findall(r"^  (\w+) ", whole.split("commands:")[1].split("options:")[0], re.M)
    assert {"run", "sweep", "report", "help", "version"} <= set(commands), commands
    for name in commands:
        own = expect(gneiss("help", name), 0).stdout
        assert own != whole and own == expect(gneiss(name, "--help"), 0).stdout, name
        assert re.search(rf"examples?:\n  gneiss {name}", own), own
    assert "--error" in gneiss("help", "plan").stdout and "--error" not in gneiss("check", "--help").stdout
    swept = gneiss("help", "sweep").stdout
    assert "--force" in swept and "name of the scene or sweep file" in swept, swept
    expect(gneiss("help", "rn"), 2, "unknown command 'rn'; did you mean 'run'")


@fact
def a_file_for_another_command_is_named(folder):
    scenes = os.path.join(SCENES, "..", "..", "scenes")
    sweep, packing = os.path.join(scenes, "sweep-strength.yaml"), os.path.join(scenes, "pack-uniform.yaml")
    for name in ("run", "check", "plan", "stiffness", "pack"):
        expect(gneiss(name, sweep), 2, "expected a scene.*, found a sweep file.*: gneiss sweep")
    expect(gneiss("sweep", LATTICE), 2, "expected a sweep file, found a scene: gneiss run")
    for name in ("run", "sweep"):
        expect(gneiss(name, packing), 2, "found a specimen alone.*: gneiss pack")
    for name in ("resume", "report", "view"):
        expect(gneiss(name, LATTICE), 2, "expected a folder of results, found a scene: gneiss run")
        expect(gneiss(name, os.path.join(SCENES, "plate.msh")), 2, "expected a folder of results, found a file")
    expect(gneiss("run", folder), 2, "found a folder: gneiss resume")
    expect(gneiss("run", write_scene(folder, "title: a\nspeciment: {}\ntime: {end: 1}\n")), 2, "speciment: unknown key")


@fact
def keys_are_found_by_words_of_the_field_and_of_other_programs(folder):
    for words, key in (("CMOD", "test.control.opening"), ("confining", "membrane.pressure"), ("restart", "output.checkpoint"),
                       ("vtk", "output.snapshots"), ("clumps", "bodies[].free"), ("joint", "contacts[].between"),
                       ("bond strength", "materials[].tensile_strength"), ("servo max", "walls[].servo.max_velocity"),
                       ("dilation", "test.control.lateral_strain"), ("loading rate", "walls[].motion.vz"),
                       ("crack mouth", "test.control.opening"), ("local damping", "damping.background.coefficient"),
                       ("Gf", "materials[].fracture_energy"), ("BTS", "materials[].tensile_strength"),
                       ("flat joint", "bonds.radius_multiplier")):
        found = expect(gneiss("keys", *words.split()), 0).stdout
        assert f"\n{key}\n" in "\n" + found, (words, found)
        assert "run.isa" not in found
    assert "\ntest.opening\n" in gneiss("keys", "crack mouth").stdout  # both words are in one argument
    expect(gneiss("keys", "water"), 2, "no key concerns 'water': no water or other fluid is modelled")
    expect(gneiss("keys", "pore pressure"), 2, "no water or other fluid is modelled")
    expect(gneiss("keys", "servo", "frction"), 2, "expected words that .* found 'servo frction'")


@fact
def readings_of_one_kind_are_in_one_unit(folder):
    out = expect(gneiss("resume", ucs()), 0).stdout
    moduli = re.findall(r"^  (?:\w+ modulus|Young's modulus) +[\d.]+ (\w+)", out, re.M)
    assert len(moduli) >= 3 and set(moduli) == {"GPa"}, out
    stresses = re.findall(r"^  [\w ]*(?:stress|strength) +[\d.]+ (\w+)", out, re.M)
    assert stresses and set(stresses) == {"MPa"}, out
    assert not re.search(r"e\+\d", out.split("energy residual")[0]), out


@fact
def a_misspelled_option_and_a_missing_value_have_different_messages(folder):
    for slip in ("--threds", "--threds=2"):
        expect(gneiss("run", LATTICE, slip), 2, "unknown option '--threds'; did you mean '--threads'")
    expect(gneiss("run", LATTICE, "-x"), 2, "unknown option '-x'")
    expect(gneiss("run", LATTICE, "--out"), 2, "--out: expected a value")
    expect(gneiss("run", LATTICE, "--force=no"), 2, "--force: expected no value, found 'no'")
    assert expect(gneiss("-h"), 0).stdout == gneiss("--help").stdout


@fact
def no_number_of_threads_is_all_cores(folder):
    assert "default, and 0: all cores" in expect(gneiss("--help"), 0).stdout
    for number in (0, "auto"):
        out = os.path.join(folder, f"threads_{number}")
        run(LATTICE, out, "--threads", number)
        assert summary(out)["threads"] == cores(), summary(out)["threads"]
    expect(gneiss("run", LATTICE, "--threads", -1), 2, r"error: --threads: .*\[0, 1024\]")


def cores():
    return int(re.search(r"threads +(\d+)", expect(gneiss("info"), 0).stdout).group(1))


@fact
def version_says_version_and_build(folder):
    out = expect(gneiss("--version"), 0).stdout
    assert re.match(r"gneiss \d+\.\d+\.\d+ \((commit [0-9a-f]{7,}(-dirty)?, )?\w+ [\d.]+ \w+\)\n$", out), out
    assert out == expect(gneiss("version"), 0).stdout
    root = os.path.join(SCENES, "..", "..")
    if os.path.exists(os.path.join(root, ".git")) and shutil.which("git"):
        assert "(commit " in out, out


@fact
def info_says_threads_and_instruction_sets(folder):
    out = expect(gneiss("info"), 0).stdout
    assert "scalar" in out and re.search(r"threads +\d+", out) and "double" in out, out


@fact
def keys_prints_every_key_or_those_that_hold_a_text(folder):
    whole = expect(gneiss("keys"), 0).stdout
    for key in ("specimen.file", "materials[].friction", "time.end", "run.threads"):
        assert key in whole, f"{key} is missing"
    part = expect(gneiss("keys", "time."), 0).stdout
    assert "time.step" in part and "random_velocity" not in part
    expect(gneiss("keys", "no such thing"), 2, "'no such thing'")
    expect(gneiss("keys", "frction"), 2, "'frction'; did you mean 'friction'")
    expect(gneiss("keys", "time.stp"), 2, "did you mean 'time.step'")


@fact
def keys_are_found_by_a_text_anywhere_in_their_names_and_descriptions(folder):
    def found(what):
        return [line for line in expect(gneiss("keys", what), 0).stdout.splitlines() if line and line[0] != " "]

    assert {"materials[].friction", "walls[].friction", "elements.contact.friction"} <= set(found("friction"))
    assert found("FRICTION") == found("friction")
    assert "run.residual_warning" in found("Energy Ledger"), "the text of a key"
    assert "specimen.lattice.kind" in found("hexagonal"), "the values of a key"
    names = found("time")
    assert names[0] == "time" and names.index("time.end") < names.index("gravity" if "gravity" in names else names[-1])


@fact
def pages_of_keys_are_up_to_date(folder):
    done = subprocess.run([os.path.join(SCENES, "../../tools/keys_pages.py"), PROGRAM, "--check"], capture_output=True, text=True, env=ENVIRONMENT)
    assert done.returncode == 0, done.stdout + done.stderr


@fact
def plan_says_effects_storage_kernels_step_and_cost(folder):
    out = expect(gneiss("plan", UCS), 0).stdout
    for pattern in (r"\+ bonds", r"- gravity", r"particles +2000 x", r"bonds +\d{4} x", "kernels", r"dt +[\d.e-]+ s",
                    "rigorous bound", r"steps +\d+ to t = 0.0003 s", r"in all [\d.]+ MB", r"time +\d"):
        assert re.search(pattern, out), f"/{pattern}/ is missing"


BONDED = """
specimen: {lattice: {kind: cubic, radius: 1 mm, cells: [40, 40, 40]%s}}
materials: [{name: m, density: 2000, normal_stiffness: 1 MN/m, kratio: 2, bond_tension_limit: 2 N, bond_shear_limit: 5 N}]
law: {stiffness: uniform}
bonds: {interaction_range: 0.1}
"""
GRAINS = """
specimen: {lattice: {kind: cubic, radius: 1 mm, cells: [40, 40, 40], spacing: 1.2}}
materials: [{name: m, density: 2000, normal_stiffness: 1 MN/m, kratio: 2, friction: 0.4}]
law: {stiffness: uniform}
"""
CELLS = """
dimension: 3
elements:
  box: {size: [0.1, 0.1, 0.1], cells: [24, 24, 24]}
  formulation: %s
  materials: [{young: 30 GPa, poisson: 0.2, density: 2400}]
"""
PACKED = """
specimen: {cylinder: {diameter: 23 mm, height: 46 mm}, particles: 20000}
materials: [{name: m, density: 2650, contact_modulus: 10 GPa, kratio: 3.7, friction: 0.5, tensile_strength: 40 MPa, shear_strength: 40 MPa}]
law: {stiffness: harmonic}
bonds: {interaction_range: 0.05}
"""
SHORT = "gravity: [0, 0, -9.81]\ntime: {end: 1 us}\noutput: {snapshots: 1}\n"


@fact
def plan_names_the_memory_that_a_run_takes(folder):
    if "detect_leaks=1" in LEAK_OPTIONS:
        raise Skip("sanitizers take memory of their own")
    kinds = {"lattice": BONDED % "", "jitter": BONDED % ", jitter: 0.05", "grains": GRAINS, "packing": PACKED,
             "elements": CELLS % "displacement", "mixed form": CELLS % "mixed"}
    texts = {name: scene + SHORT for name, scene in kinds.items()}
    texts["contacts"] = GRAINS.replace("1.2", "0.999") + SHORT.replace("snapshots: 1", "snapshots: 1, contacts: true")
    texts["history"] = LOOSE.replace("STEP", "auto").replace("1e-4}", "0.1}") + "output: {history_rows: 8000}\n"
    program.ENVIRONMENT.pop("MALLOC_PERTURB_", None)  # the setting writes to all allocated memory, also where a run does not
    for name, text in texts.items():
        file = write_scene(folder, text)
        said = float(re.search(r"in all ([\d.]+) MB", expect(gneiss("plan", file), 0).stdout).group(1))
        run(file, os.path.join(folder, name))
        taken = summary(os.path.join(folder, name))["peak_memory"] / 1e6
        assert abs(said / taken - 1) < 0.15, (name, said, taken)


LOOSE = """
dimension: 3
specimen: {particles: [[0, 0, 0, 1e-3], [2.1e-3, 0, 0, 1e-3]]}
materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 1, friction: 0}]
law: {stiffness: uniform}
time: {step: STEP, end: 1e-4}
run: {threads: 1}
"""


@fact
def an_end_before_the_first_step_is_warned_of(folder):
    """An automatic step; a given one has to be below the end."""
    scene = write_scene(folder, LOOSE.replace("STEP", "auto"))
    for end, warns in (("1e-12", True), ("1e-4", False)):
        out = os.path.join(folder, "end_" + end)
        result = expect(gneiss("run", scene, "--out", out, "--quiet", "--set", f"time.end={end}"), 0)
        assert ("no step was taken" in result.stderr) == warns, result.stderr
        with open(os.path.join(out, "summary.json")) as file:
            summary = json.load(file)
        assert ("no_steps" in [warning["name"] for warning in summary["warnings"]]) == warns == (summary["steps"] == 0)


@fact
def a_step_that_does_not_resolve_collisions_is_warned_of(folder):
    for step, warns in (("1e-5", True), ("1e-7", False), ("auto", False)):
        scene = write_scene(folder, LOOSE.replace("STEP", step))
        out = os.path.join(folder, "steps_" + step)
        result = expect(gneiss("run", scene, "--out", out), 0)
        assert ("does not resolve collisions" in result.stderr) == warns
        with open(os.path.join(out, "summary.json")) as file:
            summary = json.load(file)
        assert ("time_step" in [warning["name"] for warning in summary["warnings"]]) == warns
        assert (summary["dt"] > summary["dt_resolution"]) == warns
    plan = expect(gneiss("plan", write_scene(folder, LOOSE.replace("STEP", "auto"))), 0).stdout
    assert "between particles 0 and 1, in " in plan


LID = "walls: [{name: lid, point: [0, 0, GAP], normal: [0, 0, -1], stiffness: 1e5, servo: {force: 1, max_velocity: 1, relaxation: R}}]\n"


@fact
def a_step_without_a_limit_so_far_is_described_in_words(folder):
    loose = LOOSE.replace("STEP", "1e-6")
    held = loose + "sets: [{name: a, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
    for text, words in ((loose, "there are no contacts yet"), (held, "can move")):
        scene = write_scene(folder, text)
        for command in (("plan", scene), ("run", scene, "--out", os.path.join(folder, words.replace(" ", "_")))):
            out = expect(gneiss(*command), 0).stdout
            assert words in out and not re.search(r"\b(inf|nan)\b", out), out


@fact
def plan_says_which_servo_is_slower_than_asked(folder):
    # The only contact is the fastest: at 0.99 of the limit the loop is stable up to 2 (1 - 0.99^2).
    text = LOOSE.replace("2.1e-3", "9e-3").replace("{step: STEP, end: 1e-4}", "{end: 1e-4, safety: 0.99, contact_steps: 1}") + LID.replace("GAP", "0.9999 mm")
    for asked, cut in (("1", True), ("0.03", False)):
        out = expect(gneiss("plan", write_scene(folder, text.replace("R}", asked + "}"))), 0).stdout
        assert ("wall 'lid': relaxation 0.0398 instead of" in out) == cut, out


@fact
def check_reports_contact_without_overlap_as_zero(folder):
    text = LOOSE.replace("STEP", "auto") + LID.replace("GAP", "1e-3").replace("R}", "0.03}")
    out = expect(gneiss("check", write_scene(folder, text)), 0).stdout
    assert re.search(r"wall lid .*touch.*, deepest 0 m\n", out), out


BOX = "periodic: {min: [-1, -1, 0], max: [1, 1, SIZE]}\n"


@fact
def errors_of_the_set_up_name_file_line_and_column(folder):
    # LOOSE begins with an empty line: specimen is in line 3, law in 5, time in 6, the addition in 8.
    loose = LOOSE.replace("STEP", "auto")
    held = "sets: [{name: a, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
    wall = "walls: [{name: w, point: [1e9, 0, 1], normal: [0.6, 0, -0.8], stiffness: 1, motion: {vx: 1e-9}}]\norigin: [0, 0, 0]\n"
    open(os.path.join(folder, "empty.msh"), "w").close()
    cases = (
        (loose.replace("2.1e-3", "0"), "3:1: specimen: expected distinct centres"),
        (loose + "domain: {min: [0, -1, -1], max: [1e-3, 1, 1]}\n", "3:1: specimen: expected particles inside the domain"),
        (loose.replace("[[0, 0, 0, 1e-3]", "[[1e8, 0, 0, 1e-3]") + "origin: [0, 0, 0]\n", "3:1: specimen: expected places"),
        (loose.replace("normal_stiffness: 1e5", "contact_modulus: 1e5").replace("uniform", "mean_harmonic").replace("2.1e", "2.2e"), "5:1: law.stiffness"),
        (loose + held, "6:1: time.step: required"),
        (LOOSE.replace("STEP", "9e-5").replace("2.1e-3", "1.9e-3"), "6:1: time.step: expected at most"),
        (loose + wall, "8:9: wall 'w': expected a velocity"),
        (loose + BOX.replace("SIZE", "4e-3"), "8:1: periodic: expected a length of at least 0.0043 m along z (twice the reach of "
         "the largest particles), found 0.004 m"),  # the skin is 0.15 of the radius
        (loose + BOX.replace("SIZE", "5e-3") + "bonds: {enabled: off, interaction_range: 0.5}\n", "8:1: periodic: expected a length of at "
         "least 0.006 m along z (twice the reach of the largest particles, with bonds.interaction_range), found 0.005 m"),
        (loose + BOX.replace("SIZE", "9e-3") + "neighbours: {skin: 4e-3}\n", "8:1: periodic: expected a length of at least 0.012 m "
         "along z (twice the reach of the largest particles, with neighbours.skin), found 0.009 m"),
        ("dimension: 2\ntime: {end: 1e-4}\nelements:\n  mesh: empty.msh\n  materials: [{density: 1, young: 1, poisson: 0}]\n",
         f"4:9: elements.mesh: {folder}/empty.msh: expected a mesh, found an empty file"),
    )
    for text, words in cases:
        result = gneiss("check", write_scene(folder, text))
        assert result.returncode == 2 and ":" + words in result.stderr, (words, result.stderr)


@fact
def effects_that_are_off_take_no_storage(folder):
    out = expect(gneiss("plan", UCS), 0).stdout
    assert re.search(r"bonds .*\bshear\b", out) and re.search(r"particles .*\bspin\b", out)
    scene = """
specimen: {lattice: {kind: cubic, radius: 1 mm, cells: [3, 3, 3]}}
materials: [{name: a, density: 2000, normal_stiffness: 1e6, kratio: 2}]
law: {stiffness: uniform, rotation: off}
time: {end: 1 ms}
"""
    out = expect(gneiss("plan", write_scene(folder, scene)), 0).stdout
    storage = out[out.index("storage"):out.index("kernels")]
    for field in ("shear", "kt", "mu", "spin", "rn", "length0", "cn", "bonds", "wall"):
        assert not re.search(rf"\b{field}\b", storage), f"{field} is stored without use:\n{storage}"
    assert "- shear" in out and "- friction" in out and not re.search(r"(pairs|motion) .*(shear|rotation)", out)


@fact
def check_says_what_the_specimen_is(folder):
    out = expect(gneiss("check", UCS), 0).stdout
    for pattern in (r"particles +2000,", r"porosity +2[34]\.\d+ %", r"coordination", r"overlaps", r"wall top", "can run"):
        assert re.search(pattern, out), f"/{pattern}/ is missing"


@fact
def check_warns_of_overlaps_under_stress(folder):
    scene = open(LATTICE).read().replace("jitter: 0.05", "spacing: 0.97").replace("{interaction_range: 0.1}",
                                                                                   "{passive_gaps: false}")
    out = expect(gneiss("check", write_scene(folder, scene)), 0).stdout
    assert "warning: overlaps" in out and "see the warnings" in out, out


APART = """
dimension: DIM
specimen: {particles: ROWS}
materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 1}]
law: {stiffness: uniform}
bodies: [{name: tool, stiffness: 1e5, SHAPE}]
time: {end: 1e-4}
run: {threads: 1}
"""


@fact
def check_says_that_nothing_overlaps(folder):
    scene = APART.replace("DIM", "3").replace("ROWS", "[[0, 0, 0, 1e-3], [2.1e-3, 0, 0, 1e-3]]")
    scene = scene.replace("SHAPE", "box: {size: [1, 1, 1]}, origin: [1, 0, 0]")
    out = expect(gneiss("check", write_scene(folder, scene)), 0).stdout
    assert re.search(r"overlaps +none\n", out) and not re.search(r"particles? -1", out), out
    assert re.search(r"body tool .*; no particle touches it\n", out), out


@fact
def check_says_how_particles_lie_on_bodies(folder):
    # One particle overlaps a flat side by 0.1 mm, one lies in the middle, one is far.
    skew = 0.0109 / 2 ** 0.5
    square = "[[-0.01, -0.01], [0.01, -0.01], [0.01, 0.01], [-0.01, 0.01]]"
    cases = [(3, "box: {size: [0.02, 0.02, 0.02]}, origin: [-0.01, -0.01, -0.01]", 0.0109, 0, True),
             (3, "box: {size: [0.02, 0.02, 0.02]}, origin: [0, -0.0141421356, -0.01], rotation: [0, 0, 45 deg]", skew, skew,
              True),
             (3, "cylinder: {diameter: 0.0282842712, height: 0.02, open: true, sides: 4}, origin: [0, 0, -0.01]", skew, skew,
              False),
             (2, f"polygon: {square}", 0.0109, 0, True), (2, f"polyline: {square}", 0.0109, 0, False)]
    in_centimetres = square.replace("0.01", "1")
    cases += [(3, "box: {size: [2, 2, 2]}, scale: 0.01, origin: [-0.01, -0.01, -0.01]", 0.0109, 0, True),
              (3, "cylinder: {diameter: 2.82842712, height: 2, open: true, sides: 4}, scale: 0.01, origin: [0, 0, -0.01]", skew, skew,
               False),
              (2, f"polygon: {in_centimetres}, scale: 0.01", 0.0109, 0, True),
              (2, f"polyline: {in_centimetres}, scale: 0.01", 0.0109, 0, False)]
    for dimension, shape, x, y, closed in cases:
        rows = [[x, y, *([1e-4] * (dimension - 2)), 1e-3], [0, 0, *([1e-4] * (dimension - 2)), 1e-3],
                [0.05, 0, *([1e-4] * (dimension - 2)), 1e-3]]
        scene = APART.replace("DIM", str(dimension)).replace("ROWS", json.dumps(rows)).replace("SHAPE", shape)
        out = expect(gneiss("check", write_scene(folder, scene)), 0).stdout
        assert re.search(r"body tool .*; 1 particle touches it, deepest 0\.0001 m\n", out), out
        assert ("warning: 1 particle has its centre inside body 'tool'" in out) == closed, out


@fact
def a_run_warns_of_particles_behind_a_wall_and_names_those_that_flew_off(folder):
    scene = write_scene(folder, """
dimension: 3
specimen: {particles: [[0, 0, 0, 1e-3], [0.01, 0, 0, 1e-3], [0.03, 0, 0, 1e-3]]}
materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]
law: {stiffness: uniform}
walls: [{name: end, point: [0.02, 0, 0], normal: [-1, 0, 0], stiffness: 1e6}]
time: {end: 1e-3}
run: {threads: 1}
""")
    done = expect(gneiss("run", scene, "--out", os.path.join(folder, "out"), "--quiet"), 5,
                  r"warning: 1 particle has its centre behind wall 'end' at the start",
                  r"particle 2 moved farther in one step .* its centre is behind wall 'end'")
    assert done.stderr.count("warning") == 1, done.stderr
    passive = ["--set", "walls.end.passive=true"]
    again = expect(gneiss("run", scene, "--out", os.path.join(folder, "out"), "--quiet", *passive), 0)
    assert "behind" not in again.stderr, again.stderr


@plain_fact
def check_accepts_every_scene_that_comes_with_the_program(folder):
    shipped = os.path.join(SCENES, "../../scenes")
    scenes = [os.path.join(shipped, name) for name in sorted(os.listdir(shipped)) if name.endswith(".yaml")]
    keys = {path: set(re.findall(r"^(\w+):", open(path).read(), re.M)) for path in scenes}
    whole = [path for path in scenes if {"time", "dimension"} <= keys[path]]  # others are sweeps, targets, or the part for `pack`
    assert len(whole) > 25 and all({"scene", "targets"} & keys[path] or "pack" in path for path in set(scenes) - set(whole))
    with ThreadPoolExecutor(2) as pool:
        for path, call in zip(whole, pool.map(lambda path: gneiss("check", path), whole)):
            said = [line for line in call.stderr.splitlines() if line.startswith("gneiss:")]  # other lines report progress
            assert call.returncode == 0 and not said, f"{path}: {call.stderr}"


@fact
def plan_and_check_write_nothing(folder):
    shutil.copy(LATTICE, folder)
    for name in ("plan", "check"):
        expect(gneiss(name, "lattice-small.yaml", cwd=folder), 0)
    assert os.listdir(folder) == ["lattice-small.yaml"], os.listdir(folder)


@fact
def a_set_that_moves_as_prescribed_has_no_other_velocity_at_the_start(folder):
    text = """
dimension: 3
specimen: {particles: [[0, 0, 0, 0.01]], group: 0}
materials: [{name: m, density: 2500, normal_stiffness: 1 MN/m, kratio: 2}]
law: {stiffness: uniform}
sets: [{name: a, select: {all: true}, initial_velocity: [START, 3, 0], motion: {vx: 2}}]
time: {end: 0.01, step: 1e-4}
"""
    scene = write_scene(folder, text.replace("START", "5"))
    expect(gneiss("check", scene), 2, r":6:\d+: sets\[0\]\.initial_velocity: .*motion\.vx gives, found 5")
    for start in ("0", "2"):
        expect(gneiss("check", write_scene(folder, text.replace("START", start))), 0)


@fact
def an_empty_material_is_not_one_left_out(folder):
    with open(os.path.join(SCENES, "plane.yaml")) as file:
        scene = file.read()
    for after, path in (("specimen:\n", "specimen"), ("- name: left\n  ", r"sets\[0\]")):
        text = scene.replace(after, after + "  material: ''\n" + "  " * (path != "specimen"), 1)
        done = gneiss("check", write_scene(folder, text))
        expect(done, 2, path + r"\.material: expected a name, or the key left out, found ''")


@fact
def a_finished_run_says_on_resume_that_no_step_was_taken(folder):
    run(LATTICE, folder, "--set", "time.end=0.05 ms")
    for more in ([], ["--seed", "4"], ["--set", "run.seed=4"]):
        expect(gneiss("resume", folder, "--quiet", *more), 0, r"finished before \(t = 5e-05 s reached\): no step was taken")
    done = expect(gneiss("resume", folder, "--quiet", "--set", "time.end=0.1 ms"), 0)
    assert "no step" not in done.stderr, done.stderr
    before = summary(folder)
    expect(gneiss("resume", folder, "--quiet", "--set", "time.end=0.02 ms"), 2,
           r"--set time\.end: expected a time after the 0\.0001\d* s that the run has reached, found 2e-05 s")
    assert summary(folder) == before


@fact
def an_output_folder_that_is_a_link_to_nothing_is_named_as_such(folder):
    link = os.path.join(folder, "link")
    os.symlink("nowhere", link)
    expect(gneiss("run", LATTICE, "--out", link), 2, r"link: expected an output folder, found a symbolic link to 'nowhere'")


@fact
def the_report_is_found_in_tools_beside_the_program(folder):
    shutil.copy(PROGRAM, os.path.join(folder, "gneiss"))
    os.mkdir(os.path.join(folder, "tools"))
    with open(os.path.join(folder, "tools", "report.py"), "w") as file:
        file.write("print('moved along')\n")
    done = subprocess.run([os.path.join(folder, "gneiss"), "report", folder], capture_output=True, text=True,
                          env={k: v for k, v in ENVIRONMENT.items() if k != "GNEISS_REPORT"})
    assert done.stdout == "moved along\n", done


@fact
def an_installed_report_goes_before_tools_that_stand_beside_by_chance(folder):
    for place, said in (("share/gneiss", "installed"), ("tools", "somebody's"), ("bin/tools", "moved along")):
        os.makedirs(os.path.join(folder, place))
        with open(os.path.join(folder, place, "report.py"), "w") as file:
            file.write(f"print({said!r})\n")
    shutil.copy(PROGRAM, os.path.join(folder, "bin", "gneiss"))
    done = subprocess.run([os.path.join(folder, "bin", "gneiss"), "report", folder], capture_output=True, text=True,
                          env={k: v for k, v in ENVIRONMENT.items() if k != "GNEISS_REPORT"})
    assert done.stdout == "installed\n", done


# --- options ----------------------------------------------------------------------------------------------

@fact
def the_output_folder_follows_the_name_of_the_scene(folder):
    shutil.copy(LATTICE, folder)
    expect(gneiss("run", "lattice-small.yaml", "--quiet", cwd=folder), 0)
    assert os.path.exists(os.path.join(folder, "runs/lattice-small/results.h5"))
    expect(gneiss("run", "lattice-small.yaml", "--quiet", "--set", "output.directory=else/where", cwd=folder), 0)
    assert os.path.exists(os.path.join(folder, "else/where/results.h5"))


@fact
def quiet_prints_what_came_out_and_nothing_else(folder):
    done = run(LATTICE, folder)
    for word in ("Young's modulus", "Poisson's ratio", "peak stress", "bonds broken", "energy residual", state_hash(folder)):
        assert word in done.stdout, f"{word} is missing"
    assert not re.search(r"profile|output:|written to|^step|steps", done.stdout, re.M), done.stdout
    assert done.stderr == "", done.stderr


@fact
def a_folder_that_is_not_there_is_an_input_error_as_a_scene_is(folder):
    for name in ("run", "check", "plan", "stiffness", "pack"):
        expect(gneiss(name, os.path.join(folder, "nothing.yaml")), 2, "No such file")
    for name in ("resume", "report"):
        expect(gneiss(name, os.path.join(folder, "nothing")), 2, "(?i)no such file")


@fact
def the_progress_line_fits_any_terminal(folder):
    for columns in (20, 40, 60, 80, 110, 200):
        shown, code = on_terminal(columns, "run", LATTICE, "--out", folder, "--threads", 1)
        assert code == 0 and shown.startswith("\r\x1b[K") and shown.count("\n") == 1 and shown.endswith("\n"), shown
        lines = [line.strip("\r\n") for line in shown.split("\r\x1b[K")[1:]]
        assert max(map(len, lines)) < columns, (columns, lines)
        for least, word in ((20, r"step \d+"), (40, r"100 %|t [\d.e-]+/"), (40, "ETA"), (80, r"\d MPa"), (80, "broken"),
                            (110, r"/s\b"), (200, "particle-steps/s"), (200, "strain"), (200, "unbalanced")):
            assert columns < least or re.search(word, lines[-1]), (columns, word, lines[-1])


@fact
def messages_after_a_progress_line_begin_a_new_line(folder):
    scene = write_scene(folder, LOOSE.replace("STEP", "1e-7"))
    shown, code = on_terminal(80, "run", scene, "--out", folder + "/out", "--set", "time.end=10", interrupt=True)
    assert code == 6, shown
    assert re.search(r"^gneiss: interrupted", shown.replace("\r", ""), re.MULTILINE), shown


@fact
def log_json_prints_json_lines_and_the_summary_last(folder):
    done = expect(gneiss("run", LATTICE, "--out", folder, "--log", "json"), 0)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert [line["level"] for line in lines[-3:]] == ["progress", "result", "end"] and lines[-1]["code"] == 0, lines[-3:]
    result, last = lines[-2]["result"], lines[-3]["progress"]
    assert result == summary(folder)
    assert last["finished"] is True and last["step"] == result["steps"], last
    assert {"time", "end", "seconds", "eta", "unbalanced", "broken", "energy_residual"} <= last.keys()
    assert done.stderr == "", done.stderr


@fact
def a_run_ends_with_readings_and_a_profile(folder):
    done = expect(gneiss("run", LATTICE, "--out", folder), 0)
    for word in ("Young's modulus", "Poisson's ratio", "peak stress", "bonds broken", "energy residual",
                 state_hash(folder), "profile", "bond kernels", folder):
        assert word in done.stdout, f"{word} is missing"
    assert re.search(r"step \d+ .*particle-steps/s .*ETA .*unbalanced .*broken .*residual", done.stderr), done.stderr


@fact
def set_overrides_the_scene(folder):
    run(LATTICE, folder, "--set", "time.end=0.1ms", "--set", "title=other", "--set", "walls.top.friction=0",
        "--threads", 2, "--isa", "scalar", "--precision", "double")
    s = summary(folder)
    assert (s["title"], s["threads"], s["isa"], s["precision"]) == ("other", 2, "scalar", "double"), s
    assert abs(s["time"] - 1e-4) < 3e-6
    with results(folder) as file:
        assert "wall_shear" not in text(file.attrs["effects"])


@fact
def wrong_calls_are_refused(folder):
    wrong = {
        (): "expected a command",
        ("fly",): "unknown command 'fly'",
        ("run",): "expected SCENE",
        ("resume",): "expected DIR",
        ("run", LATTICE, "more"): "'more'",
        ("info", "more"): "'more'",
        **{("report", folder, option, *value): f"{option} is for gneiss view" for option, *value in (("--fields", "a"), ("--instants", "2"), ("--paraview",))},
        ("run", LATTICE, "--fast"): "--fast",
        ("run", LATTICE, "--out"): "--out",
        ("run", LATTICE, "--out", ""): "--out: expected a folder",
        ("run", LATTICE, "--log", "xml"): "expected json or text, found 'xml'",
        ("run", LATTICE, "--threads", "many"): "error: --threads: .*many",
        ("run", LATTICE, "--seed", "x", "--threads", "-1"): r"--seed: expected a whole number[^\n]*\n--threads: ",
        ("run", LATTICE, "--set", "run.threads=many"): "error: --set run.threads: .*many",
        ("run", LATTICE, "--isa", "mmx"): "error: --isa: .*mmx",
        ("run", LATTICE, "--precision", "half"): "error: --precision: .*half",
        **{(name, LATTICE, "--out", "x"): f"gneiss {name}: --out is for gneiss run, pack" for name in ("check", "plan", "stiffness", "report", "view")},
        ("run", LATTICE, "--set", "time.end"): "KEY=VALUE",
        ("run", LATTICE, "--set", "=1"): "KEY=VALUE",
        ("run", LATTICE, "--set", "time.ende=1"): "--set time.ende",
        ("run", LATTICE, "--set", "time.end=1 kg"): "--set time.end.*kg",
        ("run", LATTICE, "--set", "walls.left.friction=1"): "left",
        ("run", LATTICE, *["--set", "title=x"] * 65): "at most|too many",
    }
    for arguments, pattern in wrong.items():
        expect(gneiss(*arguments, cwd=folder), 2, pattern)
    assert not os.listdir(folder), os.listdir(folder)


@fact
def wrong_scenes_are_named_by_file_line_and_column(folder):
    good = open(LATTICE).read()
    wrong = {
        r"s\.yaml:\d+:\d+: .*frictoin": good.replace("friction: 0.4", "frictoin: 0.4"),
        r"s\.yaml:\d+:\d+: time\.end: .*kg": good.replace("end: 0.4 ms", "end: 0.4 kg"),
        r"s\.yaml:\d+:\d+: .*density": good.replace("density: 2000", "density: -1"),
        r"s\.yaml:\d+:\d+: .*stiffness.*elastic": good.replace("stiffness: uniform", "stiffness: elastic"),
        r"s\.yaml:\d+:\d+": good.replace("title: small lattice", "title: [small"),
        r"s\.yaml:1:1: expected a scene": "\n",
    }
    for pattern, scene in wrong.items():
        assert scene != good
        path = write_scene(folder, scene, "s.yaml")
        expect(gneiss("run", path, "--out", os.path.join(folder, "out")), 2, pattern)
    assert os.listdir(folder) == ["s.yaml"]


NAMES = """
dimension: 2
specimen: {lattice: {kind: square, radius: 1 mm, cells: [4, 4, 1]}, material: SPECIMEN}
materials:
  - {name: granite, density: 2500, normal_stiffness: 1e5, kratio: 2}
  - {name: shale, density: 2500, normal_stiffness: 1e5, kratio: 2}
law: {stiffness: uniform}
sets:
  - {name: inlay, select: {all: true}, material: SET}
walls:
  - {name: ceiling, point: [0, 1], normal: [0, -1], stiffness: 1e5, motion: {vy: -1}}
bodies:
  - {name: anvil, polygon: [[0, -1], [1, -1], [0, -2]], stiffness: 1e5, kratio: KRATIO}
test: {kind: compression, axis: y, lower: LOWER, upper: UPPER}
time: {end: 1e-4}
"""
RIGHT = {"SPECIMEN": "granite", "SET": "shale", "LOWER": "anvil", "UPPER": "ceiling", "KRATIO": "2"}


def with_names(**names):
    scene = NAMES
    for name, value in {**RIGHT, **names}.items():
        scene = scene.replace(name, value)
    return scene


@fact
def for_wrong_names_a_similar_name_is_suggested(folder):
    expect(gneiss("check", write_scene(folder, with_names())), 0)
    wrong = {("SPECIMEN", "granit"): "specimen.material: .*'granit'; did you mean 'granite'[?]",
             ("SPECIMEN", "basalt"): "specimen.material: .*'basalt'; there are granite, shale",
             ("SET", "shael"): r"sets\[0\].material: .*'shael'; did you mean 'shale'[?]",
             ("LOWER", "anvill"): "test.lower: .*'anvill'; did you mean 'anvil'[?]",
             ("UPPER", "cieling"): "test.upper: .*'cieling'; did you mean 'ceiling'[?]",
             ("UPPER", "inlaid"): "test.upper: .*'inlaid'; did you mean 'inlay'[?]",
             ("UPPER", "roof"): "test.upper: .*'roof'; there are ceiling, anvil, inlay"}
    for (key, name), pattern in wrong.items():
        expect(gneiss("check", write_scene(folder, with_names(**{key: name}))), 2, pattern)
    right = write_scene(folder, with_names())
    expect(gneiss("check", right, "--set", "walls.cieling.friction=0"), 2, "'cieling'.*; did you mean 'ceiling'[?]")
    expect(gneiss("check", right, "--set", "law.stiffness=unifrom"), 2, "'unifrom'; did you mean 'uniform'[?]")
    expect(gneiss("chekc", right), 2, "'chekc'; did you mean 'check'[?]")


@fact
def for_unknown_groups_of_a_mesh_a_similar_name_is_suggested(folder):
    scene = open(os.path.join(SCENES, "elements.yaml")).read()
    group = re.search(r"group: (\w{4,})", scene)[1]
    scene = scene.replace("plate.msh", os.path.join(SCENES, "plate.msh")).replace(f"group: {group}", f"group: {group}x")
    expect(gneiss("check", write_scene(folder, scene)), 2, f"'{group}x'.*; did you mean '{group}'[?]")


@fact
def all_errors_of_a_scene_are_shown_in_their_order_with_their_places(folder):
    scene = with_names(SET="shael", LOWER="anvill", KRATIO="much").replace("density: 2500", "densty: 2500", 1)
    scene = scene.replace("law: {stiffness: uniform}", "law: {stiffness: uniform, rotatoin: off}")
    done = expect(gneiss("check", write_scene(folder, scene, "s.yaml"), cwd=folder), 2)
    lines = done.stderr.replace("gneiss: input error: ", "").replace(folder + "/", "").splitlines()
    at = [re.match(r"s\.yaml:(\d+):(\d+): ([\w.\[\]]+): ", line) for line in lines]
    assert all(at), done.stderr
    assert [(int(m[1]), m[3]) for m in at] == [
        (5, "materials[0].densty"), (7, "law.rotatoin"), (9, "sets[0].material"), (13, "bodies[0].kratio"),
        (14, "test.lower")], done.stderr


@fact
def one_slip_is_one_error(folder):
    # Errors that follow from the wrong word are not reported in addition.
    for old, new in (("materials:", "material:"), ("law:", "lwa:"), ("walls:", "wals:"), ("specimen:", "spcimen:"),
                     ("name: granite", "nmae: granite"), ("dimension: 2", "dimension: 4"), ("time:", "tiem:"),
                     ("name: ceiling", "name: ceiling.x"), ("stiffness: uniform", "stiffness: elastic"),
                     ("normal_stiffness: 1e5", "normal_stifness: 1e5")):
        assert old in NAMES
        done = expect(gneiss("check", write_scene(folder, with_names().replace(old, new, 1))), 2)
        assert len(done.stderr.splitlines()) == 1, done.stderr


@fact
def a_scene_of_nothing_but_errors_is_cut_short(folder):
    scene = with_names() + "".join(f"nonsense{k}: 1\n" for k in range(40))
    lines = expect(gneiss("check", write_scene(folder, scene)), 2).stderr.splitlines()
    assert 6 < len(lines) < 15 and re.fullmatch(r"and \d+ more", lines[-1]), lines
    assert len(lines) - 1 + int(lines[-1].split()[1]) == 40, lines


@fact
def a_scene_that_is_no_file_is_an_error(folder):
    expect(gneiss("run", folder), 2, "expected a scene file, found a folder")
    expect(gneiss("run", os.path.join(folder, "nothing.yaml")), 2, r"nothing\.yaml: .*No such file")
    binary = os.path.join(folder, "binary")
    with open(binary, "wb") as file:
        file.write(bytes(range(256)) * 20)
    expect(gneiss("run", binary), 2, "binary")


@fact
def output_to_a_full_device_is_an_error(folder):
    for arguments in (("keys",), ("run", LATTICE, "--out", folder)):
        with open("/dev/full", "w") as full:
            done = subprocess.run(command(*arguments), stdout=full, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        expect(done, 3, "standard output")
    assert summary(folder)["finished"]


@fact
def a_reader_that_goes_away_does_not_end_a_run(folder):
    process = subprocess.Popen(command("run", UCS, "--out", folder, "--log", "json"), env=ENVIRONMENT,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.close()
    process.stderr.read()
    assert process.wait(timeout=60) == 3, process.returncode
    assert state_hash(folder) == state_hash(ucs())


# --- output files -----------------------------------------------------------------------------------------

@fact
def results_have_units_and_descriptions(folder):
    def look(name, item):
        if isinstance(item, h5py.Dataset) and name != "scene":
            assert text(item.attrs.get("unit", "")), f"{name} has no unit"
            assert text(item.attrs.get("description", "")), f"{name} has no description"

    with results(ucs()) as file:
        file.visititems(look)


@fact
def results_hold_what_the_document_lists(folder):
    with results(ucs()) as file:
        for name in ("title", "scene_file", "version", "build", "isa", "precision", "threads", "effects", "state_hash",
                     "finished", "stop_reason", "dimension"):
            assert name in file.attrs, f"attribute {name} is missing"
        pairs = ("xx", "yy", "zz", "xy", "yz", "xz")
        history = ["step", "time", "strain", "stress", "stress_lower", "stress_upper", "unbalanced", "bonds_intact",
                   "broken_tension", "broken_shear", "damage", "energy_residual", "energy_kinetic"]
        history += [f"{what}_{pair}" for what in ("strain", "stress") for pair in pairs]
        history += [f"wall_top_{what}_{axis}" for what in ("force", "displacement") for axis in "xyz"]
        names = [f"history/{name}" for name in history] + [f"readings/{name}" for name in READINGS]
        names += ["energy/residual", "energy/stored_at_start", "profile/bonds", "scene"]
        names += [f"particles/{name}" for name in ("position", "radius", "displacement", "velocity", "spin", "damage",
                                                   "stress", "bonds_at_start", "removed")]
        names += [f"bonds/{name}" for name in ("i", "j", "state", "broken_time", "force", "criterion")]
        missing = [name for name in names if name not in file]
        assert not missing, missing
        assert len({data.shape for data in file["history"].values()}) == 1, "columns differ in length"
        assert file["particles/position"].shape == (2000, 3) and file["particles/stress"].shape == (2000, 6)


@fact
def particles_are_in_the_order_of_the_specimen_file(folder):
    rows = np.loadtxt(os.path.join(SCENES, "../../scenes/specimens/rock-b.txt"))
    with results(ucs()) as file:
        assert np.array_equal(file["particles/radius"][:], rows[:, 3])
        start = file["particles/position"][:] - file["particles/displacement"][:]
        i, j = file["bonds/i"][:], file["bonds/j"][:]
    assert np.abs(start - rows[:, :3]).max() < 1e-12
    gap = np.linalg.norm(rows[i, :3] - rows[j, :3], axis=1) / (rows[i, 3] + rows[j, 3]) - 1
    assert gap.max() <= 0.05 + 1e-12, "bonds across wider gaps than the interaction range"


@fact
def breaking_times_agree_with_the_counts_of_the_history(folder):
    with results(ucs()) as file:
        state, when = file["bonds/state"][:], file["bonds/broken_time"][:]
        time_, tension, shear = (file["history/" + n][:] for n in ("time", "broken_tension", "broken_shear"))
        intact, damage = file["history/bonds_intact"][:], file["history/damage"][:]
    assert np.array_equal(np.isnan(when), state == 0)
    for kind, counted in ((1, tension), (2, shear)):
        times = np.sort(when[state == kind])
        assert np.array_equal(np.searchsorted(times, time_, side="right"), counted), f"kind {kind}"
    assert np.array_equal(intact, len(state) - tension - shear)
    assert np.allclose(damage, (tension + shear) / len(state), rtol=0, atol=1e-15)
    counts = summary(ucs())["counts"]
    assert counts["bonds"] == len(state)
    assert (counts["broken_tension"], counts["broken_shear"]) == (np.sum(state == 1), np.sum(state == 2))


@fact
def the_summary_has_its_keys_and_agrees_with_the_results(folder):
    s = summary(ucs())
    assert set(READINGS) <= s["readings"].keys()
    assert {"particles", "contacts", "bonds", "broken_tension", "broken_shear"} <= s["counts"].keys()
    for key in ("energy_residual", "state_hash", "steps", "dt", "seconds", "contact_steps_per_second", "threads", "isa",
                "precision", "version"):
        assert key in s, f"{key} is missing"
    assert s["counts"]["particles"] == 2000 and s["threads"] == 2 and s["finished"] is True
    with results(ucs()) as file:
        for name in READINGS:
            assert file["readings/" + name][0] == s["readings"][name], name
        assert text(file.attrs["state_hash"]) == s["state_hash"]
        stress = file["history/stress"][:]
    assert s["readings"]["peak_stress"] == stress.max() and 1e7 < stress.max() < 1e9
    # Phases are measured in one step of seven, and their sum need not equal the total on a machine with other
    # processes.
    assert all(value >= 0 for value in s["seconds"].values()) and s["seconds"]["total"] > 0, s["seconds"]


@fact
def processor_seconds_are_those_of_the_threads(folder):
    start = time.monotonic()
    run(LATTICE, folder, "--threads", 1)
    s, wall = summary(folder), time.monotonic() - start
    # One thread cannot have a processor for longer than the process lasts; clocks of processors tick in ms at the worst.
    assert 0 < s["seconds"]["cpu"] < wall + 0.01, (s["seconds"], wall)
    with results(folder) as file:
        assert 0 < file.attrs["cpu_seconds"] <= s["seconds"]["cpu"]


@fact
def one_thread_waits_for_no_other(folder):
    run(LATTICE, folder, "--threads", 1)
    assert summary(folder)["seconds"]["waiting"] == 0


@fact
def the_most_memory_of_a_run_holds_at_least_its_particles(folder):
    run(LATTICE, folder)
    s = summary(folder)
    assert s["peak_memory"] > 200 * s["counts"]["particles"], s["peak_memory"]


@fact
def processor_seconds_go_on_over_a_resume(folder):
    run(LATTICE, folder, "--set", "time.end=0.2 ms")
    with h5py.File(os.path.join(folder, checkpoints(folder)[-1]), "r+") as file:
        file.attrs["cpu_seconds"] = 3723.0  # attribute of a run that took this time
        report_digest.seal(file)
    resume(folder, "--set", "time.end=0.3 ms")
    assert 3723 < summary(folder)["seconds"]["cpu"] < 3723 + 100, summary(folder)["seconds"]


@fact
def the_energy_ledger_of_the_small_ucs_closes(folder):
    residual = summary(ucs())["energy_residual"]
    assert 0 < abs(residual) < 1e-3, residual
    values = history(ucs())["energy_residual"]
    assert values[-1] == residual or np.nanmax(np.abs(values[len(values) // 2:])) < 1e-3


@fact
def the_resolved_scene_in_the_results_gives_the_same_run(folder):
    with results(ucs()) as file:
        scene = file["scene"][()].decode()
    out = os.path.join(folder, "out")
    run(write_scene(folder, scene), out, "--threads", 1)
    assert state_hash(out) == state_hash(ucs())


@fact
def a_number_of_rows_that_is_none_is_named_before_stops_that_need_rows(folder):
    for rows in ("-1", "many"):
        expect(gneiss("check", UCS, "--set", "time.stop.peak_drop=0.5", "--set", f"output.history_rows={rows}"), 2,
               "output.history_rows: expected a whole number in", f"found '{rows}'")
    expect(gneiss("check", UCS, "--set", "time.stop.peak_drop=0.5", "--set", "output.history_rows=0"), 2, "it would never stop the run")


@fact
def no_rows_and_no_snapshots_leave_the_first_row_and_the_last_state(folder):
    run(LATTICE, folder, "--set", "output.history_rows=0", "--set", "output.snapshots=0")
    assert list(history(folder)["step"]) == [0.0]
    assert len(series(folder)) == 1
    assert summary(folder)["readings"]["young_modulus"] is None, "a modulus from a single row"


@fact
def the_ledger_is_looked_at_at_the_end_with_or_without_rows(folder):
    """The values equal a row of the last step; the bits of the state are equal."""
    whole, none, ledgers = os.path.join(folder, "whole"), os.path.join(folder, "none"), {}
    for out, rows in ((whole, 10**7), (none, 0)):
        run(LATTICE, out, "--set", f"output.history_rows={rows}", "--set", "output.snapshots=0")
        with results(out) as file:
            ledgers[out] = {name: data[0] for name, data in file["energy"].items() if name != "residual"}
    assert len(history(none)["step"]) == 1 and state_hash(whole) == state_hash(none)
    assert ledgers[whole] == ledgers[none] and ledgers[none]["work_walls"] > 0, ledgers
    assert ledgers[none]["kinetic"] == history(whole)["energy_kinetic"][-1]
    expect(gneiss("run", LATTICE, "--out", none, "--quiet", "--set", "output.history_rows=0", "--set", "run.residual_limit=1e-15"), 5,
           "ledger does not close.* at the end")


@fact
def a_servo_that_never_reaches_its_target_is_warned_of(folder):
    scene = {"specimen": {"particles": [[0, 0, "1 mm", "1 mm"]]}, "law": {"stiffness": "uniform"}, "time": {"end": "20 ms"},
             "materials": [{"name": "m", "density": 2000, "normal_stiffness": 1e5, "kratio": 0}],
             "sets": [{"name": "held", "select": {"all": True}, "motion": {"vz": 0}}], "output": {"history_rows": 50},
             "walls": [{"name": "lid", "point": [0, 0, "2.5 mm"], "normal": [0, 0, -1], "stiffness": 1e6, "servo": {"force": 1, "max_velocity": 0.1}}]}
    for speed, reported in ((0.01, True), (1, False)):
        scene["walls"][0]["servo"]["max_velocity"] = speed
        done = expect(gneiss("run", write_scene(folder, scene), "--out", os.path.join(folder, str(reported)), "--quiet"), 0)
        assert ("servo_not_held: wall 'lid' has 0 N in the mean of the last rows, and its target is 1 N" in done.stderr) == reported, done.stderr


@fact
def a_warning_names_two_servos_and_explains_a_pulling_target(folder):
    lids = [{"name": f"lid_with_a_long_name_{k}", "point": [0, 0, "2.5 mm"], "normal": [0, 0, -1], "stiffness": 1e6,
             "servo": {"force": 1, "max_velocity": 0.01}} for k in range(3)]
    scene = {"specimen": {"particles": [[0, 0, "1 mm", "1 mm"]]}, "law": {"stiffness": "uniform"}, "time": {"end": "20 ms"},
             "materials": [{"name": "m", "density": 2000, "normal_stiffness": 1e5, "kratio": 0}],
             "sets": [{"name": "held", "select": {"all": True}, "motion": {"vz": 0}}], "output": {"history_rows": 50}, "walls": lids}
    done = expect(gneiss("run", write_scene(folder, scene), "--out", os.path.join(folder, "three"), "--quiet"), 0)
    assert re.search(r"servo_not_held: wall 'lid_with_a_long_name_0' .*; wall 'lid_with_a_long_name_1' .*; and 1 more: there was too little time.* less stiff\n",
                     done.stderr), done.stderr
    scene["walls"] = [{**lids[0], "servo": {"force": -1, "max_velocity": 0.01}}]
    done = expect(gneiss("run", write_scene(folder, scene), "--out", os.path.join(folder, "pull"), "--quiet"), 0)
    assert "and its target is -1 N: a wall can only push, and its target is a pull" in done.stderr, done.stderr


@fact
def a_membrane_below_its_pressure_is_warned_of(folder):
    scene = {"dimension": 2, "specimen": {"lattice": {"kind": "hexagonal", "radius": "1 mm", "cells": [6, 6]}}, "law": {"stiffness": "uniform"},
             "materials": [{"name": "m", "density": 2000, "normal_stiffness": 1e8, "kratio": 2, "bond_tension_limit": 1e12, "bond_shear_limit": 1e12}],
             "bonds": {}, "membrane": {"pressure": "1 MPa", "ramp": "1 s"}, "time": {"end": "1 ms"}}
    for ramp, reported in (("1 s", True), ("0.5 ms", False)):
        scene["membrane"]["ramp"] = ramp
        done = expect(gneiss("run", write_scene(folder, scene), "--out", os.path.join(folder, str(reported)), "--quiet"), 0)
        assert bool(re.search(r"membrane_ramp: the pressure had reached \d+(\.\d+)? Pa, 0\.001 of its target", done.stderr)) == reported, done.stderr


@fact
def a_box_that_a_servo_shrinks_to_nothing_is_a_run_that_went_bad(folder):
    """Soft grains do not carry the stress; a box that is too narrow from the start is an error of the scene, and a rate has its own place."""
    grains = [[2.2e-3 * i + 1e-3, 2.2e-3 * j + 1e-3, 2.2e-3 * k + 1e-3, 1e-3] for i in range(6) for j in range(6) for k in range(6)]
    scene = {"specimen": {"particles": grains}, "law": {"stiffness": "harmonic"}, "time": {"end": 0.5},
             "materials": [{"name": "m", "density": 2650, "contact_modulus": 1e5, "kratio": 3, "friction": 0, "tensile_strength": 1, "shear_strength": 1}],
             "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
             "periodic": {"min": [0, 0, 0], "max": [13.2e-3] * 3, "z": {"stress": 1e9, "max_rate": 2000}}}
    expect(gneiss("run", write_scene(folder, scene), "--out", os.path.join(folder, "away"), "--quiet"), 5,
           r"unstable run: step \d+, t = .*the servo of side 'z' has shrunk the box to 0\.\d+ of its length \(periodic box: expected a length")
    scene["periodic"]["z"] = {"rate": -1e5}
    path = write_scene(folder, scene)
    with open(path) as file:
        line = next(k for k, text in enumerate(file, 1) if "rate" in text)
    expect(gneiss("run", path, "--out", os.path.join(folder, "fast"), "--quiet"), 2, rf"scene.yaml:{line}:\d+: periodic.z.rate: expected a strain of at most")


@fact
def a_servo_that_misses_its_target_for_a_while_is_warned_of(folder):
    """A grain under a lid is pulled away from it in the middle of the run, faster than the lid may follow, and comes back."""
    scene = {"specimen": {"particles": [[0, 0, "1 mm", "1 mm"]]}, "law": {"stiffness": "uniform"}, "time": {"end": "40 ms"},
             "materials": [{"name": "m", "density": 2000, "normal_stiffness": 1e5, "kratio": 0}],
             "sets": [{"name": "held", "select": {"all": True}, "motion": {"vz": 0}}], "output": {"history_rows": 200},
             "walls": [{"name": "lid", "point": [0, 0, "2 mm"], "normal": [0, 0, -1], "stiffness": 1e6, "servo": {"force": 1, "max_velocity": 0.02}}]}
    away = [[0, 0], ["15 ms", 0], ["15.1 ms", -0.1], ["17 ms", -0.1], ["17.1 ms", 0], ["24 ms", 0], ["24.1 ms", 0.1], ["25 ms", 0.1], ["25.1 ms", 0]]
    for name, motion in (("stays", 0), ("leaves", away)):
        scene["sets"][0]["motion"]["vz"] = motion
        done = expect(gneiss("run", write_scene(folder, scene), "--out", os.path.join(folder, name), "--quiet"), 0)
        reported = re.search(r"servo_not_held: wall 'lid' has 1 N in the mean of the last rows, and its target is 1 N \(and was off by more than a tenth in (\d+) % of the run since it was first reached\)", done.stderr)
        assert bool(reported) == (name == "leaves"), done.stderr


@fact
def errors_caused_by_set_name_the_option(folder):
    """This holds also for errors that appear only after particles are created."""
    for given, pattern in (("time.step=1", "input error: --set time.step: expected a step below the end"),
                           ("time.step=1e-4", "input error: --set time.step: expected at most .*stability limit"),
                           ("sets=[{name: foot, select: {ids: [999]}, motion: {vz: 0}}]", "input error: --set sets: set 'foot': select.ids: expected numbers from 0 to 149, found 999"),
                           ("periodic={min: [0, 0, 0], max: [1 mm, 1, 1]}", "input error: --set periodic: expected a box longer along x than the centres of the specimen are apart"),
                           ("periodic={min: [0, 0, 0], max: [1, 1, 1], open: w}", "input error: --set periodic: periodic.open: expected one of none, x, y, z, found 'w'")):
        expect(gneiss("run", LATTICE, "--out", os.path.join(folder, "out"), "--quiet", "--set", given), 2, pattern)
    expect(gneiss("run", LATTICE, "--out", os.path.join(folder, "out"), "--quiet", "--set", "sets.foot.select.end.by=centre", "--set", "sets.foot.select.end.depth=1e-9 m"), 2,
           r"lattice-small.yaml:\d+:\d+: sets: set 'foot': select: expected particles")
    with open(LATTICE, encoding="utf-8") as file:
        scene = write_scene(folder, file.read().replace("foot", "foot" * 12))
    others = ("--set", f"sets.{'foot' * 12}.select.end.depth=1.5 mm") * 40 + ("--set", "time.end=0.4 ms") * 20  # 3 000 characters before the wrong one
    expect(gneiss("run", scene, "--out", os.path.join(folder, "out"), "--quiet", *others, "--set", "time.step=1e-4"), 2,
           "input error: --set time.step: expected at most .*stability limit")


@fact
def errors_in_specimen_from_are_reported_with_their_place(folder):
    sweep, empty, other = (os.path.join(folder, name) for name in ("sweep", "empty", "other.h5"))
    for name in (sweep, empty):
        os.makedirs(name)
    solid = os.path.join(folder, "solid")
    run(os.path.join(SCENES, "elements.yaml"), solid, "--set", "time.end=1e-6", "--set", "output.snapshots=0")
    for path in (os.path.join(sweep, "sweep.h5"), other):
        with h5py.File(path, "w") as file:
            file["x"] = 1
    scene = "title: from\nspecimen:\n  from_bonds: none\n  from: {}\n{}materials: [{{name: m, density: 2000, normal_stiffness: 1e5, kratio: 0}}]\n" \
            "law: {{stiffness: uniform}}\ntime: {{end: 1}}\n"
    for target, more, pattern in ((sweep, "", r":4:9: specimen.from: cannot open .*it is the folder of a sweep, expected that of one of its runs"),
                                  (empty, "", r":4:9: specimen.from: cannot open .*it is a folder without results.h5"),
                                  (other, "", r":4:9: specimen.from: .*other.h5: expected an HDF5 file of gneiss"),
                                  (solid, "", r":4:9: specimen.from: expected the results of a run with particles, found none of them"),
                                  (other, "  scale: 2\n", r":5:10: specimen.scale: needs file, surface or mesh")):
        expect(gneiss("check", write_scene(folder, scene.format(target, more))), 2, "scene.yaml" + pattern)
    expect(gneiss("check", write_scene(folder, scene.format(empty, "")), "--set", f"specimen.from={other}"), 2,
           "input error: --set specimen.from: .*other.h5: expected an HDF5 file of gneiss")


@fact
def without_the_ledger_there_is_no_energy(folder):
    done = expect(gneiss("run", LATTICE, "--out", folder, "--set", "output.energy=off"), 0)
    assert "nan" not in done.stdout + done.stderr, done.stderr
    assert summary(folder)["energy_residual"] is None
    with results(folder) as file:
        assert "energy" not in file and not [name for name in file["history"] if name.startswith("energy")]


@fact
def snapshots_are_grids_with_their_time(folder):
    out = ucs()
    listed = series(out)
    assert 7 <= len(listed) <= 11 and listed[0][1] == 0.0, listed  # the list includes the snapshot at the peak
    for name, when in listed:
        with h5py.File(os.path.join(out, name)) as file:
            assert file["VTKHDF/FieldData/TimeValue"][0] == when
            for data in ("id", "radius", "displacement", "velocity", "damage", "stress", "coordination"):
                assert len(file["VTKHDF/PointData/" + data]) == 2000, data
    with h5py.File(os.path.join(out, series(out, "bonds")[-1][0])) as file, results(out) as final:
        assert np.array_equal(file["VTKHDF/CellData/state"][:], final["bonds/state"][:])


ASKED = {"spin": 3, "group": 1, "material": 1, "total_force": 3, "total_moment": 3, "damping_force": 3, "damping_moment": 3}


@fact
def fields_are_in_snapshots_and_results_where_they_are_asked_for(folder):
    """The damping force is a v m at mid-step; unrequested fields are absent, and requesting them changes no bit."""
    states = []
    for asked in ((), ASKED):
        out = os.path.join(folder, str(len(asked)))
        more = ("--set", f"output.fields=[{', '.join(asked)}]") if asked else ()
        run(LATTICE, out, "--set", "damping.background={model: viscous, coefficient: 1000}", *more)
        states.append(state_hash(out))
        with results(out) as file, h5py.File(os.path.join(out, series(out)[-1][0])) as grid:
            data, particles = grid["VTKHDF/PointData"], file["particles"]
            for name, components in ASKED.items():
                assert (name in data) == (name in asked), name
                assert (name in particles) == (name in asked or name == "spin"), name
                if name in asked:
                    assert np.array_equal(data[name][:].reshape(-1, components), particles[name][:].reshape(-1, components)), name
                    assert text(particles[name].attrs["unit"]) in ("1", "N", "N m", "rad/s")
    assert states[0] == states[1]
    with results(out) as file:
        total, damping, v = (file["particles/" + name][:] for name in ("total_force", "damping_force", "velocity"))
        assert set(file["particles/group"][:].ravel()) == {1} and set(file["particles/material"][:].ravel()) == {0}
    assert np.abs(total).max() > 0 and (np.einsum("ij,ij->i", damping, v) <= 0).all() and np.abs(damping).max() > 0


@fact
def bonds_have_sections_and_stresses_where_they_are_asked_for(folder):
    scene = {"specimen": {"lattice": {"kind": "cubic", "radius": "1 mm", "cells": [3, 3, 3]}}, "law": {"stiffness": "dempack", "gamma": 1.0},
             "materials": [{"name": "m", "density": 2000, "young": 1e7, "poisson": 0.2, "friction": 0.3, "tensile_strength": 1e9, "shear_strength": 1e9}],
             "bonds": {"interaction_range": 0.05}, "time": {"end": 1e-3}, "output": {"fields": ["area", "shear_stress"]},
             "sets": [{"name": "s", "select": {"end": {"axis": "z", "side": "upper", "depth": 1e-3}}, "motion": {"vx": 0.1}}]}
    out = os.path.join(folder, "out")
    run(write_scene(folder, scene), out)
    with results(out) as file, h5py.File(os.path.join(out, series(out, "bonds")[-1][0])) as grid:
        data, bonds = grid["VTKHDF/CellData"], file["bonds"]
        assert np.array_equal(data["area"][:].ravel(), bonds["area"][:].ravel()) and (data["area"][:] > 0).all()
        assert np.allclose(data["shear_stress"][:] * data["area"][:], data["shear_force"][:], rtol=1e-12)
        assert np.array_equal(data["shear_stress"][:].ravel(), bonds["shear_stress"][:].ravel()) and data["shear_stress"][:].max() > 0


@fact
def fields_that_there_are_not_are_refused_with_their_place(folder):
    for asked, pattern in (("[spim]", "output.fields: expected the name of a field, found 'spim'; did you mean 'spin'"),
                           ("[spin, group, spin]", "output.fields: expected every name once, found 'spin' again"),
                           ("area", r"output.fields: expected sections of bonds \(law.stiffness dempack or polyhedron\) beside 'area', found none"),
                           ("skin", "output.fields: expected a membrane beside 'skin', found none")):
        expect(gneiss("check", LATTICE, "--set", f"output.fields={asked}"), 2, "--set " + pattern)


@fact
def orientations_are_written_where_they_are_asked_for(folder):
    # Spin w about a fixed axis: the rotation is cos(w t/2), axis sin(w t/2). Each step is of first order in the angle
    # with an error of (w dt/2)^2/3 of it, 7.5e-9 here. After 4 rad the quaternion of the shorter rotation is
    # expected.
    spin = np.array([100.0, 200.0, 200.0])
    scene = LOOSE.replace("STEP", "1e-6").replace("end: 1e-4", "end: 4/300 s".replace("4/300", repr(4 / 300)))
    scene += "sets: [{name: turned, select: {ids: [1]}, motion: {wx: 100, wy: 200, wz: 200}}]\n"
    for asked in ("off", "on"):
        out = os.path.join(folder, asked)
        run(write_scene(folder, scene), out, "--set", f"output.orientation={asked}")
        last = os.path.join(out, series(out)[-1][0])
        with results(out) as file, h5py.File(last) as grid:
            assert ("orientation" in file["particles"]) == (asked == "on")
            assert ("orientation" in grid["VTKHDF/PointData"]) == (asked == "on")
            if asked == "on":
                turn = file["particles/orientation"][:]
                assert text(file["particles/orientation"].attrs["unit"]) == "1"
                assert np.array_equal(turn, grid["VTKHDF/PointData/orientation"][:])
    half = np.linalg.norm(spin) * summary(out)["time"] / 2
    expected = -np.array([np.cos(half), *(np.sin(half) * spin / np.linalg.norm(spin))])
    assert np.array_equal(turn[0], [1, 0, 0, 0]) and expected[0] > 0 and np.abs(turn[1] - expected).max() < 1e-7, turn



@fact
def the_limit_that_is_written_is_that_of_the_grains_as_they_lie(folder):
    """Three balls in a row that collide: there is no contact at the start, and the collision ends before the step is
    checked again. A pair has w^2 = 2 k/m, the row 3 k/m; there are no dashpots. The overlap is largest after half
    the contact time."""
    k, r, rho, v = 1e5, 1e-3, 2500.0, 0.01
    m = rho * 4 / 3 * math.pi * r**3
    w = math.sqrt(k / m)  # the middle ball does not move
    scene = write_scene(folder, {
        "dimension": 3, "specimen": {"particles": [[-2.001e-3, 0, 0, r], [0, 0, 0, r], [2.001e-3, 0, 0, r]]},
        "law": {"stiffness": "uniform"},
        "materials": [{"name": "a", "density": rho, "normal_stiffness": k, "kratio": 0}],
        "sets": [{"name": n, "select": {"ids": [i]}, "initial_velocity": [s * v, 0, 0]} for n, i, s in (("l", 0, 1), ("r", 2, -1))],
        "time": {"end": 1e-6 / v + 0.5 * math.pi / w}, "run": {"threads": 1}})
    out = os.path.join(folder, "row")
    expect(gneiss("run", scene, "--out", out, "--quiet"), 0)
    with open(os.path.join(out, "summary.json")) as file:
        found = json.load(file)
    assert 50 < found["steps"] < 1000, found["steps"]
    for key in ("dt_limit", "dt_limit_sharp"):
        assert abs(found[key] / (2 / math.sqrt(3 * k / m)) - 1) < 2e-3, (key, found[key], 2 / math.sqrt(3 * k / m))


@fact
def a_body_that_is_absurdly_light_is_warned_of_before_the_run(folder):
    """1e-21 kg among grains of 1e-5 kg: steps fall to 1e-14 s when it makes contact, which no plan can predict."""
    scene = write_scene(folder, {
        "dimension": 3, "specimen": {"lattice": {"kind": "cubic", "radius": 1e-3, "cells": [3, 3, 1]}},
        "law": {"stiffness": "uniform"},
        "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e5, "kratio": 0}],
        "bodies": [{"name": "feather", "free": True, "mass": 1e-21, "stiffness": 1e5, "box": {"size": [4e-3, 4e-3, 2e-3]},
                    "origin": [0, 0, 2.5e-3]}],
        "time": {"end": 1e-5}, "run": {"threads": 1}})
    out = os.path.join(folder, "feather")
    for mass, warns in (("1e-21", True), ("1e-7", False)):
        light = ("--set", f"bodies.feather.mass={mass}")
        reported = [expect(gneiss("check", scene, *light), 0).stdout,
                expect(gneiss("run", scene, "--out", out, "--quiet", "--force", *light), 0).stderr]
        for text in reported:
            assert text.count("body 'feather' of 1e-21 kg on 1e+05 N/m asks") == warns, text

# --- damage -----------------------------------------------------------------------------------------------

def mutated(source, pick):
    tokens = re.split(r"(\s+|[\[\]{},:])", source)
    words = ["", "-1", "0", "1e400", "nan", "[", "}", "&a", "*a", "!!int", "time", "99999999999999999999", "\t", "~", "kg",
             "'", "|", "? ", "- - -", "off", "[[0, 0]]", "\u00fc"]
    for _ in range(pick.choice((1, 1, 2, 3))):
        k = pick.randrange(len(tokens))
        tokens[k] = pick.choice(words + [tokens[pick.randrange(len(tokens))], tokens[k] * 2])
    return "".join(tokens)


@fact
def scenes_with_random_edits_are_checked_or_refused(folder):
    source, pick = open(LATTICE).read(), random.Random(3)
    source = source.replace("[5, 5, 6]", "[3, 3, 3]")
    scenes = [write_scene(folder, mutated(source, pick), f"s{k}.yaml") for k in range(60)]
    with ThreadPoolExecutor(2) as pool:
        calls = list(pool.map(lambda path: gneiss("check", path, timeout=30), scenes))
    for path, call in zip(scenes, calls):
        assert call.returncode in (0, 2, 5), f"exit code {call.returncode}: {call.stderr}\n{open(path).read()}"
        assert (call.returncode == 0) == (call.stderr == ""), call.stderr
    refused = sum(call.returncode == 2 for call in calls)
    assert 10 < refused < 60, f"{refused} of 60 refused"


if __name__ == "__main__":
    code = main()
    shutil.rmtree(OUT, ignore_errors=True)
    sys.exit(code)
