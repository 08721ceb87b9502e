"""gneiss calibrate: parameters recovered from readings that known parameters gave, interruptions, budgets, bad
targets. Speaks TAP."""
import contextlib
import io
import re
import signal
import subprocess
from types import SimpleNamespace

from program import *  # noqa: F403 (the module is made for that)

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))
from calibrate import command as calibrate_command  # noqa: E402
from calibrate import output, readings, report, simulate, specimens, strength, targets, uncertainty  # noqa: E402

SPECIMEN = {"cylinder": {"diameter": "20 mm", "height": "40 mm"}, "particles": 250}
KNOWN = {"contact_modulus": 14e9, "kratio": 5.0, "tensile_strength": 9e6, "shear_strength": 14e6}
TARGETS = """
specimen: {cylinder: {diameter: 20 mm, height: 40 mm}, particles: 250}
law: linear
seeds: 3
targets:
  young_modulus: {value: 20 GPa, tolerance: 3 %}
  poisson_ratio: {value: 0.2, tolerance: 0.02}
  compressive_strength: {value: 45 MPa, tolerance: 6 %}
  tensile_strength: {value: 10 MPa, tolerance: 6 %}
"""


def calibration(folder):
    with open(os.path.join(folder, "calibration.json"), encoding="utf-8") as file:
        return json.load(file)


def outcomes(folder):
    """Finished runs and solutions in the folder of a calibration."""
    runs = os.path.join(folder, "runs")
    return sorted(name for name in (os.listdir(runs) if os.path.isdir(runs) else []) if os.path.exists(os.path.join(runs, name, "outcome.json")))


def calibrated(folder, text=TARGETS, name="a", *options, code=0):
    targets = write_scene(folder, text, name + ".yaml")
    out = os.path.join(folder, name)
    return out, expect(gneiss("calibrate", targets, "--out", out, *options), code)


def refused(folder, message, text, name="bad"):
    """Reads targets in this process, which saves hundreds of imports of libraries; they must be refused with a message that matches."""
    told, targets_file = io.StringIO(), write_scene(folder, text, name + ".yaml")
    with contextlib.redirect_stderr(told):
        code = calibrate_command.main([targets_file, "--out", os.path.join(folder, name), "--program", PROGRAM])
    assert code == 2 and re.search(message, told.getvalue()), f"expected /{message}/ and exit code 2 in: {code} {told.getvalue()}"


def known_readings(folder):
    """Mean readings of three packings with the parameters KNOWN, by `gneiss run` alone."""
    base = {"dimension": 3, "specimen": {**SPECIMEN, "density_basis": "bulk", "packing": {"size_ratio": 3, "overlap": "passive"}},
            "materials": [{"name": "rock", "density": 2600, "friction": 0.5, **KNOWN}], "law": {"stiffness": "harmonic"},
            "bonds": {"interaction_range": 0.05}, "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
            "output": {"snapshots": 0, "history_rows": 1500}}
    ends = [("lower", 0, 1, "lower"), ("upper", 0.04, -1, "upper")]
    speed = {"compression": 0.1, "tension": -0.02}
    # Platens are five times as stiff as a contact, as those of a calibration are: softer ones lower the modulus that is read.
    walls = [{"name": name, "point": [0, 0, z], "normal": [0, 0, sign], "stiffness": 2.7e8, "passive": True,
              "motion": {"vz": [[0, 0], [1e-4, 0.5 * sign * speed["compression"]]]}} for name, z, sign, _ in ends]
    sets = [{"name": name, "select": {"end": {"axis": "z", "side": side, "depth": 3.2e-3, "by": "surface"}},
             "motion": {"vz": [[0, 0], [1e-4, 0.5 * sign * speed["tension"]]]}} for name, _, sign, side in ends]
    found = {"young_modulus": [], "poisson_ratio": [], "compressive_strength": [], "tensile_strength": []}
    for seed in (11, 12, 13):
        for kind, driven in (("compression", {"walls": walls}), ("tension", {"sets": sets})):
            scene = {**base, **driven, "test": {"kind": kind, "axis": "z", "lower": "lower", "upper": "upper", "length": 0.04, "diameter": 0.02},
                     "time": {"end": 6e-3, "stop": {"peak_drop": 0.3}}}
            out = os.path.join(folder, f"{kind}{seed}")
            run(write_scene(folder, scene), out, "--seed", seed, "--threads", 1)
            readings = summary(out)["readings"]
            found["compressive_strength" if kind == "compression" else "tensile_strength"].append(readings["peak_stress"])
            if kind == "compression":
                found["young_modulus"].append(readings["young_modulus"])
                found["poisson_ratio"].append(readings["poisson_ratio"])
    return {name: float(np.mean(values)) for name, values in found.items()}


@fact
def known_parameters_are_recovered_from_their_readings_within_the_stated_intervals(folder):
    wanted = known_readings(folder)
    text = json.dumps({"specimen": SPECIMEN, "law": "linear", "seeds": 3, "targets": wanted})
    out, done = calibrated(folder, text)
    found = calibration(out)
    assert found["reached"] and "all targets are reached" in done.stdout, found["notes"]
    assert found["runs"] <= 60, found["runs"]
    inside = sum(one["fresh"]["inside"] for one in found["found"].values())
    assert f"check with 3 fresh packings: {inside} of 12 readings inside the prediction intervals\n" in done.stdout, done.stdout
    assert re.search(r"check with a test that was not fitted: strength in brazilian [\d.]+ MPa, [\d.]+ MPa\n", done.stdout), done.stdout
    for name, value in wanted.items():
        entry = found["found"][name]
        assert abs(entry["value"] - value) <= entry["tolerance"] and len(entry["packings"]) == 3, (name, entry, value)
        low, high = entry["interval"]
        assert low < entry["value"] < high and entry["prediction"][0] < min(entry["packings"]) and entry["prediction"][1] > max(entry["packings"]), entry
    for key, value in KNOWN.items():
        low, high = found["parameters"][key]["interval"]
        middle, wider = (low * high)**0.5, (high / low)**(0.5 * 2.0**0.5)  # the targets scatter as much: they are means over the same number of packings
        assert middle / wider <= value <= middle * wider, f"{key}: {value} outside of {middle / wider} .. {middle * wider}"
        # An interval that contains every value would prove nothing: the scatter of packings of 250 particles is some
        # per cent.
        assert high / low < {"kratio": 3.0, "shear_strength": 3.0}.get(key, 1.5), (key, low, high)


@fact
def a_killed_calibration_is_taken_up_and_gives_the_result_of_an_undisturbed_one_with_any_number_of_workers(folder):
    undisturbed, _ = calibrated(folder, TARGETS, "a", "--threads", 2)
    targets, out = os.path.join(folder, "a.yaml"), os.path.join(folder, "b")
    for kill in (signal.SIGKILL, signal.SIGINT, signal.SIGKILL, signal.SIGTERM):
        number = len(outcomes(out)) + 2
        process = subprocess.Popen(command("calibrate", targets, "--out", out, "--threads", 1, "--quiet"), env=ENVIRONMENT,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        assert wait_until(process, lambda: len(outcomes(out)) >= number), process.communicate()
        process.send_signal(kill)
        said = process.communicate(timeout=60)[1]
        if kill != signal.SIGKILL:
            assert process.returncode == 6 and "the same command continues" in said, (process.returncode, said)
        assert not os.path.exists(os.path.join(out, "calibration.json"))
    before = {name: os.stat(os.path.join(out, "runs", name, "outcome.json")).st_mtime_ns for name in outcomes(out)}
    expect(gneiss("calibrate", targets, "--out", out, "--threads", 1), 0)
    after = {name: os.stat(os.path.join(out, "runs", name, "outcome.json")).st_mtime_ns for name in before}
    assert before == after, "a finished run was computed again"
    one, two = calibration(undisturbed), calibration(out)
    for entry in (one, two):
        entry.pop("cpu_seconds")
    assert one == two, "results differ"
    for name in ("calibrated.yaml",):
        with open(os.path.join(undisturbed, name)) as a, open(os.path.join(out, name)) as b:
            assert a.read() == b.read()


@fact
def the_calibrated_scene_gives_the_readings_that_are_stated(folder):
    out, done = calibrated(folder, TARGETS.replace("seeds: 3", "seeds: [4]"), "a")
    whole = calibration(out)
    found = whole["found"]
    run(os.path.join(out, "calibrated.yaml"), os.path.join(folder, "run"))
    readings = summary(os.path.join(folder, "run"))["readings"]
    for name, reading in (("young_modulus", "young_modulus"), ("poisson_ratio", "poisson_ratio"), ("compressive_strength", "peak_stress")):
        assert found[name]["packings"] == [readings[reading]], (name, found[name]["packings"], readings[reading])
    assert all(one["interval"] is None for one in (*found.values(), *whole["parameters"].values())), "one packing has no interval"
    assert all(one["prediction"] is None for one in found.values()), found
    assert whole["notes"] == ["intervals need at least three packings"] and done.stdout.count("95 %: -") == 8, (whole["notes"], done.stdout)
    with open(os.path.join(out, "report.html"), encoding="utf-8") as file:
        page = file.read()
    assert page.count("data:image/png") == 3 and "compressive_strength" in page and "<script" not in page


def base_scene(folder, **material):
    return write_scene(folder, {"specimen": SPECIMEN, "materials": [{"name": "rock", "density": 2600, "friction": 0.5, **KNOWN, **material}],
                                "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.05}}, "base.yaml")


def curve_of(folder):
    """Strains and stresses of a run, read from its history."""
    with h5py.File(os.path.join(folder, "results.h5")) as file:
        return file["history/strain"][:], file["history/stress"][:]


@fact
def keys_of_the_material_are_found_from_a_measured_curve(folder):
    text = "scene: base.yaml\nseeds: [5]\nparameters: {contact_modulus: [5 GPa, 60 GPa], tensile_strength: [2 MPa, 40 MPa]}\ntargets: {curve: {file: curve.csv, tolerance: 8 %}}\n"
    with open(base_scene(folder)) as file:
        scene = {"dimension": 3, "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}}, **json.load(file)}
    known = specimens.Bench(scene, 18e9).build(specimens.Test("compression"), {}, 45e6, 5)
    run(write_scene(folder, known, "known.yaml"), os.path.join(folder, "known"))
    strain, stress = curve_of(os.path.join(folder, "known"))
    end = 1.1 * strain[np.argmax(stress)]
    measured = [(x, np.interp(x, strain, stress)) for x in np.linspace(0, end, 50)]
    with open(os.path.join(folder, "curve.csv"), "w") as file:
        file.write("strain [%],stress [MPa]\n" + "".join(f"{100 * x},{y / 1e6}\n" for x, y in measured))
    base_scene(folder, contact_modulus=20e9, tensile_strength=14e6)
    out, _ = calibrated(folder, text, "found")
    whole = calibration(out)
    assert whole["reached"] and len(whole["found"]) == 8 and list(whole["parameters"]) == ["contact_modulus", "tensile_strength"], whole["notes"]
    for key, value in (("contact_modulus", KNOWN["contact_modulus"]), ("tensile_strength", KNOWN["tensile_strength"])):
        assert abs(whole["parameters"][key]["value"] / value - 1) < {"contact_modulus": 0.03, "tensile_strength": 0.06}[key], (key, value, whole["parameters"])
    run(os.path.join(out, "calibrated.yaml"), os.path.join(folder, "again"))
    strain, stress = curve_of(os.path.join(folder, "again"))
    for (name, one), at in zip(whole["found"].items(), np.linspace(0, end, 9)[1:]):
        assert abs(one["value"] - np.interp(at, strain, stress) / max(y for _, y in measured)) < 1e-6, (name, one, at)


@fact
def a_combination_of_keys_that_the_targets_do_not_determine_is_named(folder):
    base_scene(folder)
    out, done = calibrated(folder, "scene: base.yaml\nseeds: 1\nbudget: 12\nparameters: {contact_modulus: [5 GPa, 60 GPa], kratio: [1, 20]}\n"
                                   "targets: {young_modulus: 20 GPa}\n")
    said = r"not determined by the targets: to first order none of them changes if kratio is 11 % larger and contact_modulus is ([\d.]+) % larger"
    assert re.search(said, done.stdout) and calibration(out)["reached"], done.stdout
    # Uniform strain: d ln E over d ln (k_t/k_n) is 0.18 at k_t/k_n 0.2, so that 10 % in the one are balanced by about 2 % in the other.
    assert 1.0 <= float(re.search(said, done.stdout)[1]) <= 3.0, done.stdout


@plain_fact
def a_curve_under_pressure_counts_from_where_platens_touch_the_specimen(folder):
    with open(base_scene(folder)) as file:
        scene = {"dimension": 3, "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}}, **json.load(file)}
    known = specimens.Bench(scene, 18e9).build(specimens.Test("triaxial", 20e6), {}, 100e6, 5)
    run(write_scene(folder, known, "known.yaml"), os.path.join(folder, "known"))
    with h5py.File(os.path.join(folder, "known", "results.h5")) as file:
        loaded = file["history/stage"][:] == 1
        strain, stress = file["history/strain"][:][loaded], file["history/stress"][:][loaded]
    touch = strain[np.argmax(stress > 0.01 * stress.max())]  # the pressure shortens the specimen by some 20 MPa/30 GPa, walls stand still
    assert 2e-4 < touch < 2e-3, touch
    end = 0.9 * (strain[np.argmax(stress)] - touch)
    with open(os.path.join(folder, "curve.csv"), "w") as file:
        file.write("strain [mm/m],stress [MPa]\n" + "".join(f"{1e3 * x},{np.interp(x + touch, strain, stress) / 1e6}\n" for x in np.linspace(0, end, 50)))
    out, _ = calibrated(folder, "scene: base.yaml\nseeds: [5]\nbudget: 1 runs\nparameters: {friction: [0.2, 1]}\n"
                                "targets: {curve: {file: curve.csv, confinement: 20 MPa, tolerance: 4 %}}\n", "found")
    assert calibration(out)["reached"] and len(calibration(out)["found"]) == 8, calibration(out)["notes"]


@fact
def wrong_parameters_and_curves_are_refused_with_their_place(folder):
    base_scene(folder)
    for name, text in (("falls", "0,0\n2e-3,1\n1e-3,2\n"), ("word", "strain,stress\n0,0\n1e-3,high\n"), ("unit", "strain [kg],stress\n0,0\n1,1\n"),
                       ("pulled", "0,0\n1e-3,-1e6\n"), ("short", "strain,stress\n"), ("gone to 0", "0,0\n1e-3,1e6\n2e-3,0\n"), ("wide", "0,0,0\n1,1,1\n")):
        with open(os.path.join(folder, name + ".csv"), "w") as file:
            file.write(text)
    for line, message in (("parameters: {hardness: [1, 2]}", r"1:14: parameters\.hardness: expected one of contact_modulus.*found 'hardness'"),
                          ("parameters: {friction: 0.5}", r"1:24: parameters\.friction: expected the lowest and the highest value, found '0\.5'"),
                          ("parameters: {friction: [0.6, 1]}", r"1:24: parameters\.friction: expected a range that holds the value of the scene, found 0\.5 there"),
                          ("parameters: {friction: [0, 1]}", r"1:24: parameters\.friction: expected a lowest value above 0"),
                          ("parameters: {yield_ratio_1: [1, 9]}", r"1:29: .*holds the value of the scene, found none there"),
                          ("parameters: {friction: [1 m, 2 m]}", r"1:25: parameters\.friction: 'm' cannot be converted"),
                          ("parameters: {}", r"1:13: parameters: expected at least one key"),
                          ("law: linear\nparameters: {friction: [0.1, 1]}", r"2:13: parameters: expected a scene, .*, and no law"),
                          ("curve: gone.csv", r"3:18: targets\.curve\.file: gone\.csv cannot be read: No such file"),
                          ("curve: {confinement: 1 MPa}", r"3:18: targets\.curve\.file: expected a file of strains and stresses, found none"),
                          ("curve: {file: falls.csv, stress: 1}", r"3:44: targets\.curve\.stress: expected file, confinement or tolerance"),
                          ("curve: falls.csv", r"3:18: targets\.curve\.file: falls\.csv: expected at least two rows whose strains rise"),
                          ("curve: word.csv", r"3:18: .*word\.csv: row 3: expected two numbers, found '1e-3,high'"),
                          ("curve: unit.csv", r"3:18: .*unit\.csv: 'kg' cannot be converted"),
                          ("curve: pulled.csv", r"3:18: .*pulled\.csv: expected stresses above 0 in compression"),
                          ("curve: gone to 0.csv", r"3:18: .*gone to 0\.csv: expected stresses above 0, found none at a strain of 0\.002"),
                          ("curve: short.csv", r"3:18: .*short\.csv: expected at least two rows .*, found 0 rows"),
                          ("curve: wide.csv", r"3:18: .*wide\.csv: row 1: expected two numbers")):
        text = f"{line}\nscene: base.yaml\ntargets: {{compressive_strength: 45 MPa}}\n" if "parameters" in line else f"title: a\nscene: base.yaml\ntargets: {{{line}}}\n"
        refused(folder, message, text)
    write_scene(folder, {"specimen": SPECIMEN, "materials": [{"name": "rock", "density": 2600, "friction": 0.5}], "law": {"stiffness": "harmonic"}, "bonds": {}}, "base.yaml")
    _, done = calibrated(folder, "scene: base.yaml\nparameters: {friction: [0.2, 1]}\ntargets: {compressive_strength: 45 MPa}\n", "bad", code=2)
    assert re.search(r":2:13: parameters: expected a scene whose material has the contact_modulus \(Pa\) of its law, found none there", done.stderr), done.stderr
    assert not os.path.exists(os.path.join(folder, "bad"))


@plain_fact
def runs_of_another_commit_are_not_taken(folder):
    keys = []
    for number, commit in enumerate(("commit 0123abcd", "commit 0123abce", "commit 0123abcd")):
        stand_in = os.path.join(folder, "stand-in")
        with open(stand_in, "w") as file:
            file.write(f"#!/bin/sh\necho 'gneiss 0.1.0 ({commit}, gcc)'\n")
        os.chmod(stand_in, 0o755)
        keys.append(simulate.Laboratory(stand_in, os.path.join(folder, str(number)), 1, 9, 9.0).key({"scene": 1}, 0.0))
    assert keys[0] == keys[2] != keys[1], keys


@plain_fact
def the_calibrated_scene_is_the_compression_test_or_that_of_the_first_target(_):
    for names, kind in (("brazilian_strength young_modulus", "compression"), ("tensile_strength compressive_strength", "compression"),
                        ("brazilian_strength tensile_strength", "brazilian"), ("tensile_strength brazilian_strength", "tension")):
        wanted = {name: targets.Target(name, 1e6, 1e4) for name in names.split()}
        assert readings.main_test(wanted).kind == kind, names


@fact
def a_ratio_of_strengths_that_the_law_does_not_reach_is_said_and_compression_is_met(folder):
    text = TARGETS.replace("tensile_strength: {value: 10 MPa", "tensile_strength: {value: 2 MPa").replace("seeds: 3", "seeds: 2")
    out, done = calibrated(folder, text)
    found = calibration(out)
    assert not found["reached"] and not found["found"]["tensile_strength"]["reached"]
    assert found["found"]["compressive_strength"]["reached"], found["found"]["compressive_strength"]
    said = re.search(r"tensile_strength: not reachable with the law linear: compressive over tensile strength is at most ([\d.]+), wanted 22.5", done.stdout)
    assert said and 4.0 < float(said[1]) < 12.0, done.stdout
    assert "moments" in done.stdout, "the law that can is named"


@fact
def strengths_under_pressure_are_met_without_a_tensile_one_by_friction_below_the_usual(folder):
    head = TARGETS.split("  compressive")[0].replace("law: linear", "law: auto").replace("seeds: 3", "seeds: 1")
    line = "  compressive_strength: {value: 60 MPa, tolerance: 5 %}\n  triaxial:\n" + "".join(
        f"  - {{confinement: {pressure} MPa, value: {value} MPa, tolerance: 5 %}}\n" for pressure, value in ((6, 76), (12, 90), (24, 115)))
    out, done = calibrated(folder, head + line)
    found = calibration(out)
    assert found["reached"] and found["law"] == "linear", (done.stdout, found["path"])
    value = {key: one["value"] for key, one in found["parameters"].items()}
    assert 0.0 < value["friction"] < 0.45 and "bond_friction" not in value, value
    assert value["shear_strength"] < 1.8 * value["tensile_strength"], value
    out, _ = calibrated(folder, "friction: 0.5\nbudget: 16\n" + head + line, "given")
    assert "friction" not in calibration(out)["parameters"], "a friction that is given is kept"


@plain_fact
def strengths_under_pressure_that_no_envelope_meets_are_named(_):
    def off(tolerance, *pairs):
        line = {f"triaxial_{p}MPa": targets.Target(f"triaxial_{p}MPa", value, tolerance * value, p) for p, value in pairs}
        return readings.off_envelopes({"young_modulus": targets.Target("young_modulus", 1e3, 1.0), **line})

    parabola = [(p, 100.0 + 12.0 * p**0.5 + p) for p in (5, 10, 20, 40, 80)]
    assert off(1e-9, *parabola) == [], "an envelope of the shape of a rock's"
    assert off(1e-9, *((p, 50.0 + 3.0 * p) for p in (1, 2, 30, 400))) == [], "a straight one"
    dip = [(p, value * (0.7 if p == 20 else 1.0)) for p, value in parabola]
    assert "triaxial_20MPa" in off(0.02, *dip), off(0.02, *dip)
    assert off(0.4, *dip) == [], "a wide tolerance"
    assert off(0.001, *dip[1:4]) == [], "three strengths are no line"


@fact
def a_budget_ends_the_search_with_the_best_so_far(folder):
    out, done = calibrated(folder, TARGETS + "budget: 14\n")
    found = calibration(out)
    assert found["runs"] <= 14 and "the budget of 14 runs is used up" in done.stdout, done.stdout
    calibrated(folder, TARGETS + "budget: 1\n", "b", code=2)


@plain_fact
def bad_targets_are_refused_with_line_key_expected_and_found(folder):
    head = "specimen: {cylinder: {diameter: 20 mm, height: 40 mm}, particles: 250}\ntargets:\n  young_modulus: 20 GPa\n"
    for text, message in (
            (head + "  strength: 60 MPa\n", r":4:3: targets\.strength: expected one of young_modulus.*found 'strength'"),
            (head + "  poisson_ratio: 0.6\n", r":4:18: targets\.poisson_ratio\.value: expected a number in \[0, 0\.5\], found '0\.6'"),
            (head + "  compressive_strength: -60 MPa\n", r":4:25: .*expected a number in .*found '-60 MPa'"),
            (head + "  compressive_strength: 60 m\n", r":4:25: .*'m' cannot be converted to Pa"),
            (head + "  compressive_strength: nan\n", r":4:25: .*expected a number, found 'nan'"),
            (head + "  compressive_strength: 60 MPa\n  tensile_strength: 70 MPa\n",
             r":5:21: targets\.tensile_strength: expected a value below compressive_strength"),
            (head + "  compressive_strength: 30 GPa\n", r":4:25: targets\.compressive_strength: expected a value below young_modulus"),
            (head + "  poisson_ratio: {tolerance: 0.1}\n", r":4:18: targets\.poisson_ratio\.value: expected a value, found none"),
            (head + "  poisson_ratio: {value: 0.2, error: 0.1}\n", r":4:31: .*expected value or tolerance, found 'error'"),
            (head + "  young_modulus: 30 GPa\n", r":4:3: .*found 'young_modulus' again"),
            (head + "budget: 0\n", r":4:9: budget: expected at least one run, found '0'"),
            (head + "budget: 0 min\n", r":4:9: budget: expected a time above 0"),
            (head + "budget: much\n", r":4:9: budget: expected a number of runs"),
            (head + "seeds: [1, 1]\n", r":4:8: seeds: expected different"),
            (head + "law: magic\n", r":4:6: law: expected auto.*found 'magic'"),
            (head + "walls: []\n", r":4:1: walls: expected one of"),
            (head + "scene: base.yaml\n", r"expected either specimen .* or scene"),
            (head + "  friction_angle: 40\n", r":4:19: targets\.friction_angle: needs compressive_strength"),
            (head + "title: &a [*a]\n", r":4:12: YAML aliases are not part of a file of targets"),
            (head + "title: " + 40 * "[" + "\n", r":4:39: nested too deeply"),
            (head + "title: [a]\n", r":4:8: title: expected a text, found a list"),
            (head + "law: {}\n", r":4:6: law\.stiffness: expected the stiffness of contacts, found none"),
            (head + "bonds: {interaction_range: 0.1}\n", r":4:8: bonds: needs a section law; found none"),
            (head + "law: linear\nbonds: {}\n", r":5:8: bonds: needs a section law; found 'linear'"),
            (head + "law: {stiffness: hertz}\n", r":4:18: law\.stiffness: expected one of uniform.*found 'hertz'"),
            (head.replace("250", "49"), r":1:67: specimen\.particles: expected at least 50 particles, .* found about 49"),
            (head.replace("particles: 250", "mean_radius: 5 mm"), r":1:69: specimen\.mean_radius: expected at least 50 particles, .* found about 14\.4"),
            (head + "budget: --5\n", r":4:9: budget: expected a number of runs"),
            (head + "seeds: 1.5\n", r":4:8: seeds: expected a whole number, found '1\.5'"),
            (head.replace("20 mm", "nan"), r":1:33: specimen\.cylinder\.diameter: expected a number, found 'nan'"),
            (head.replace("height", "high"), r":1:22: specimen\.cylinder\.height: expected a length, found none"),
            (head.replace("particles: 250", "porosity: 0.4"), r":1:11: specimen\.particles: expected a number of particles or mean_radius"),
            (head.replace("250", "0"), r":1:67: specimen\.particles: expected a number in"),
            (head.split("targets")[0], r":1:1: targets: expected a section"),
            (head.split("  young")[0] + "  {}\n", r"targets: expected at least one of"),
            ("targets: [1\n", r":2:1: .*expected"),
            (head.replace("cylinder: {diameter: 20 mm, height: 40 mm}", "disc: {diameter: 20 mm}"), r":1:11: specimen: expected a cylinder")):
        refused(folder, message, text)
    scene = {"specimen": SPECIMEN, "materials": [{"name": "rock", "density": 2600, **KNOWN}], "law": {"stiffness": "harmonic"}, "bonds": {}}
    for key, value, message in (("materials", [{**scene["materials"][0], "density": "5 m"}], r"base\.yaml:.*materials\.density: 'm' cannot be converted"),
                                ("materials", [{"name": "rock"}], r"base\.yaml:.*materials\.density: expected a density, found none"),
                                ("materials", [{}, {}], r"base\.yaml:.*materials: expected a list with one material, found a list"),
                                ("law", [], r"base\.yaml:.*law: expected a section, found a list"),
                                ("specimen", {**SPECIMEN, "file": "rock.txt"}, r"base\.yaml:\d+:\d+: specimen\.file: expected a shape alone.*found file beside cylinder"),
                                ("bonds", None, r"bad\.yaml:1:8: scene: expected a scene with the section bonds")):
        write_scene(folder, {name: part for name, part in {**scene, key: value}.items() if part is not None}, "base.yaml")
        refused(folder, message, "scene: base.yaml\ntargets: {young_modulus: 20 GPa}\n")
    expect(gneiss("calibrate", os.path.join(folder, "none.yaml")), 2, "cannot be read")
    calibrated(folder, "targets: {young_modulus: 20 GPa}\nscene: none.yaml\n", "gone", code=2)
    expect(gneiss("calibrate", os.path.join(folder, "gone.yaml")), 2, r"gone\.yaml:2:8: scene: none\.yaml cannot be read: No such file")
    expect(gneiss("calibrate", os.path.join(folder, "bad.yaml"), "--set", "time.end=1"), 2, "file of targets")
    good = write_scene(folder, TARGETS, "good.yaml")
    for option, values, expected in (("--seeds", ("-x", "1001"), "a number of seeds in"), ("--seeds", ("1,1",), "different"),
                                     ("--threads", ("-2", "1.5"), r"a whole number in \[0, 1024\] or 'auto'")):
        for value in values:
            expect(gneiss("calibrate", good, "--out", os.path.join(folder, "bad"), option, value), 2, f"^gneiss: input error: {option}: expected {expected}.*found '{value}'\n$")
    assert not os.path.exists(os.path.join(folder, "bad")), "nothing is written for bad input"


@plain_fact
def intervals_end_where_a_reading_can_be(_):
    assert uncertainty.within([-2.0, 5.0], 0.0, np.inf) == [0.0, 5.0]
    assert uncertainty.within([0.1, 0.7], *output.PHYSICAL["poisson_ratio"]) == [0.1, 0.5]
    assert uncertainty.within([-np.inf, 5.0], -np.inf, np.inf) is None
    scattered = {name: np.array(values) for name, values in (("poisson_ratio", [0.05, 0.2, 0.45]), ("tensile_strength", [1e6, 3e6, 9e6]))}
    evaluation = SimpleNamespace(errors={}, column=scattered.get, mean=lambda name: float(np.mean(scattered[name])))
    wanted = {name: targets.Target(name, 1.0, 1.0) for name in scattered}
    entries = output.found_of(SimpleNamespace(search=SimpleNamespace(targets=wanted), evaluation=evaluation, fresh=None))
    assert entries["poisson_ratio"]["prediction"] == [0.0, 0.5] and entries["tensile_strength"]["prediction"][0] == 0.0, entries
    assert entries["tensile_strength"]["prediction"][1] > 9e6, entries


@plain_fact
def files_of_others_are_kept_without_force(folder):
    other = os.path.join(folder, "a")
    os.makedirs(os.path.join(other, "runs", "mine"))
    for name in ("results.h5", "summary.json", "calibration.json", "calibrated.yaml", "report.html"):
        path = write_scene(other, "kept", name)
        _, done = calibrated(folder, TARGETS, "a", code=3)
        assert path in done.stderr and "--force" in done.stderr, done.stderr
        assert sorted(os.listdir(other)) == sorted([name, "runs"]), os.listdir(other)
        os.unlink(path)
    path = write_scene(other, "kept", "calibrated.yaml")
    calibrated(folder, TARGETS + "budget: 1\n", "a", "--force", code=2)
    assert os.path.isdir(os.path.join(other, "runs", "mine")), "a folder that no calibration made"
    calibrated(folder, TARGETS + "budget: 1\n", "a", code=2)  # the folder is that of a calibration by now


class Means:
    """Search and evaluation of outputs that are linear in the parameters, as calibrate.uncertainty takes them."""

    def __init__(self, slopes, values):
        self.names, self.free = ["compressive_strength", "tensile_strength"], ["tension", "chi"]
        self.parameters = {"tension": 1.0, "chi": 1.0}
        self.slopes, self.logs = slopes, values
        self.targets = {name: targets.Target(name, self.mean(name), 0.1) for name in self.names}
        self.errors = {}

    def column(self, name):
        return np.exp(self.logs[:, self.names.index(name)])

    def mean(self, name):
        return float(np.exp(np.mean(np.log(self.column(name)))))

    def weights(self):
        return np.ones(2)

    def given_up(self, _):
        return set()

    def ends_at(self, *_):
        return set()


@plain_fact
def intervals_and_regions_of_normal_scatter_hold_what_they_state(_):
    generator, count, draws = np.random.default_rng(3), 5, 3000
    slopes = np.array([[1.0, 0.35], [1.0, -0.02]])
    scatter = np.linalg.cholesky(np.array([[0.0025, 0.001], [0.001, 0.0009]]))
    held = {"tension": 0, "chi": 0, "region": 0, "prediction": 0, "mean": 0}
    for _ in range(draws):
        logs = generator.normal(size=(count + 1, 2)) @ scatter.T
        one = Means(slopes, logs[:count])
        matrix = uncertainty.covariance(one, one, slopes)
        off = np.linalg.solve(slopes, logs[:count].mean(axis=0))  # parameters that the means give, where all are 0
        for k, name in enumerate(one.free):
            low, high = uncertainty.interval_of(name, np.exp(off[k]), uncertainty.variance_of(matrix, np.eye(2)[k]), count)
            held[name] += low <= 1.0 <= high
        held["region"] += off @ np.linalg.solve(matrix, off) <= uncertainty.region(2, count)
        low, high = uncertainty.prediction(logs[:count, 0], logs[:count, 0].mean())
        held["prediction"] += low <= logs[count, 0] <= high
        low, high = uncertainty.interval_of_mean(logs[:count, 0], logs[:count, 0].mean())
        held["mean"] += low <= 0.0 <= high
    for name, number in held.items():  # 0.4 % is the standard error of the share of 3000 draws
        assert abs(number / draws - 0.95) < 0.016, (name, number / draws)


@plain_fact
def a_parameter_that_no_reading_determines_has_no_interval(_):
    logs = 0.02 * np.random.default_rng(4).normal(size=(5, 2))
    one = Means(np.array([[1.0, 0.0], [1.0, 0.0]]), logs)
    matrix = uncertainty.covariance(one, one, one.slopes)
    assert 0.0 < matrix[0, 0] < 0.02**2, matrix
    assert np.isinf(uncertainty.variance_of(matrix, np.array([1.0, 1.0])))
    assert uncertainty.interval_of("chi", 1.0, uncertainty.variance_of(matrix, np.array([0.0, 1.0])), 5) == [0.0, np.inf]
    assert uncertainty.undetermined(one, one, one.slopes) == [{"chi": 1.0}]
    for slopes, expected in (([[1.0, 0.35], [1.0, -0.02]], []), ([[1.0, 0.25], [1.0, 0.25]], [{"tension": -0.25, "chi": 1.0}]),
                             ([[0.0, 0.0], [0.0, 0.0]], [{"tension": 1.0}, {"chi": 1.0}])):
        found = uncertainty.undetermined(one, one, np.array(slopes))
        assert [sorted((name, round(change, 9)) for name, change in each.items()) for each in found] == [sorted(each.items()) for each in expected], (slopes, found)


@plain_fact
def a_parameter_at_an_end_of_its_range_is_named(_):
    class Ended:
        free, limits = ["tension", "chi", "bond_friction"], {"tension": (1e-6, 1e15), "chi": (0.3, 10.0), "bond_friction": (-1.5, 4.0)}
        ends_at = strength.Search.ends_at

    for chi, friction, notes in ((2.0, 0.5, []), (10.0, 0.5, ["the shear strength over the tensile strength of bonds is at the upper end of its range, 10"]),
                                 (0.3, -1.5, ["the shear strength over the tensile strength of bonds is at the lower end of its range, 0.3",
                                              "friction is at the lower end of its range, 0"])):
        result = SimpleNamespace(search=Ended(), evaluation=SimpleNamespace(parameters={"tension": 1e6, "chi": chi, "bond_friction": friction}))
        assert output.bound_notes(result) == [f"{note}: it counts as given" for note in notes], output.bound_notes(result)


@plain_fact
def regions_of_parameters_stay_within_what_these_can_be(_):
    shape = report.ellipse([[0.01, 0.0], [0.0, 4.0]], [0, 1], uncertainty.region(2, 3))  # three packings: 2 (2/1) F(2, 1) = 798
    assert abs(shape[0].max() / (0.1 * 798.0**0.5) - 1.0) < 2e-3 and shape[1].min() < -50.0, shape
    covariance = {"of": ["chi", "bond_friction"], "values": [2.0, 0.5], "limits": [[0.3, 10.0], [0.0, 4.0]]}
    chi, friction = (report.region_values(covariance, k, shape[1]) for k in (0, 1))
    assert np.allclose([chi.min(), chi.max(), friction.min(), friction.max()], [0.15, 5.0, 0.0, 4.0]), (chi, friction)
    assert np.allclose(report.region_values(covariance, 0, np.array([-0.1, 0.0, 0.1])), np.exp([-0.1, 0.0, 0.1])), "small ones are as they are"


if __name__ == "__main__":
    sys.exit(main())
