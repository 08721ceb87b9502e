"""Cutting tests: the example scenes with larger particles, their forces and works, and what is refused."""
import math
import os
import re

import numpy as np

from program import SCENES, expect, fact, gneiss, history, main, plain_fact, results, resume, run, state_hash, summary, write_scene

EXAMPLES = os.path.join(SCENES, os.pardir, os.pardir, "scenes")


def example(name):
    return os.path.join(EXAMPLES, f"cutting-{name}.yaml")


def sets(**values):
    return [part for key, value in values.items() for part in ("--set", f"{key.replace('__', '.')}={value}")]


COARSE = sets(specimen__mean_radius="5 mm", output__snapshots=0)
FAST = sets(bodies__disc__motion__vx="16 m/s")
# A dozen lattice cells of unbonded or bonded balls under a chisel: a run of seconds that tests only the tool.
BLOCK = """
dimension: 3
specimen:
  lattice: {kind: fcc, radius: 2 mm, cells: [8, 4, 3], origin: [2 mm, -10 mm, -17 mm]}
  material: rock
  group: 1
materials:
  - {name: rock, density: 2650, contact_modulus: 10 GPa, kratio: 3, friction: 0.5, tensile_strength: 5 MPa, shear_strength: 20 MPa}
law: {stiffness: harmonic}
bonds: {interaction_range: 0.05}
sets:
  - {name: base, select: {end: {axis: z, side: lower, depth: 2 mm, by: centre}}, motion: {vx: 0, vy: 0, vz: 0}}
bodies:
  - name: pick
    chisel: {width: 15 mm, rake_angle: 10 deg, clearance_angle: 10 deg, height: 20 mm, length: 15 mm}
    origin: [-2 mm, 0, -5 mm]
    stiffness: 50 MN/m
    motion: {vx: 5 m/s}
test: {kind: cutting, axis: x, normal: z, tool: pick, depth: 5 mm, length: 10 mm}
time: {end: 4 ms}
output: {snapshots: 0}
"""


def reading(folder, name):
    value = summary(folder)["readings"][name]
    assert value is not None, f"{name}: {summary(folder)['absent'][name]}"
    return value


def closes(folder, tools=1):
    """The work of the tools is that of the rolling force along the path, and the ledger closes."""
    h = history(folder)
    work = np.sum(np.diff(h["rolling_impulse"]) * np.diff(h["cut_path"]) / np.diff(h["time"]))
    assert work > 0
    if tools == 1:
        assert abs(h["energy_work_walls"][-1] / work - 1) < 1e-9, (h["energy_work_walls"][-1], work)
    assert abs(summary(folder)["energy_residual"]) < 1e-3, summary(folder)["energy_residual"]
    return h


@plain_fact
def the_work_of_a_rolling_disc_is_its_rolling_force_times_its_path(folder):
    run(example("disc"), folder, *COARSE, *FAST, *sets(test__run_in="45 mm", test__length="60 mm"))
    h, s = closes(folder), summary(folder)
    assert s["stop_reason"].startswith("the tool has reached the end of its path"), s["stop_reason"]
    assert not any(w["name"] == "cutting_path" for w in s["warnings"]), s["warnings"]
    path = [0.045, 0.105]
    mean = {name: np.diff(np.interp(path, h["cut_path"], h[name]))[0] for name in ("normal_impulse", "time")}
    assert abs(reading(folder, "normal_force") / (mean["normal_impulse"] / mean["time"]) - 1) < 1e-9
    assert 0 < reading(folder, "rolling_force") < 0.5 * reading(folder, "normal_force")
    assert reading(folder, "peak_normal_force") > reading(folder, "normal_force")
    assert abs(reading(folder, "predicted_coefficient") - math.tan(0.5 * math.acos(1 - 4 / 216))) < 1e-9
    rows = np.searchsorted(h["cut_path"], 0.045)  # between the row before the path of the means begins and the one behind it
    removed = [h["removed_volume"][-1] - h["removed_volume"][k] for k in (rows, rows - 1)]
    assert removed[0] - 1e-15 <= reading(folder, "removed_volume") <= removed[1] + 1e-15, removed
    assert not any(w["name"] == "nothing_measured" for w in s["warnings"]), s["warnings"]


@plain_fact
def forces_along_the_rim_add_up_to_the_mean_forces(folder):
    run(example("disc"), folder, *COARSE, *FAST)
    with results(folder) as file:
        rim = {name: data[:] for name, data in file["rim"].items()}
    for part in ("normal", "rolling"):  # every tenth step is examined
        assert abs(rim[part].sum() / reading(folder, part + "_force") - 1) < 0.1, part
    arc = math.acos(1 - 4 / 216)
    assert np.allclose(rim["angle"], rim["share"] * arc) and len(rim["share"]) == 40
    assert 0 < np.sum(rim["normal"] * rim["share"]) / rim["normal"].sum() < 1  # the place is ahead of the axis, below the surface


@fact
def a_resumed_cut_has_the_same_bits_and_impulses(folder):
    whole, part = os.path.join(folder, "whole"), os.path.join(folder, "part")
    scene = write_scene(folder, BLOCK)
    run(scene, whole, "--set", "time.end=2.2 ms")  # the path of the means ends at 2.4 ms
    run(scene, part, "--set", "time.end=1 ms")
    resume(part, "--set", "time.end=2.2 ms")
    assert state_hash(part) == state_hash(whole)
    for name in ("normal_impulse", "rolling_impulse", "removed_volume"):  # the rows differ, and the last one is the same
        assert history(part)[name][-1] == history(whole)[name][-1], name
    assert reading(part, "contact_area") == reading(whole, "contact_area")


@fact
def removed_rock_is_what_no_bond_joins_to_the_base_with_its_pores(folder):
    run(write_scene(folder, BLOCK), folder, "--set", "output.fields=[fragment]")
    with results(folder) as file:
        volume, radius, fragment = file["fragments/volume"][:], file["particles/radius"][:], file["particles/fragment"][:]
        height = (file["particles/position"][:] - file["particles/displacement"][:])[:, 2]
        body = float(np.ravel(file.attrs["volume"])[0])
    solid, held = np.sum(4 / 3 * math.pi * radius**3), np.unique(fragment[height < -0.0149])  # the layer that is held at rest
    assert len(volume) > 3 and abs(volume.sum() / solid - 1) < 1e-12
    removed = (solid - volume[held].sum()) * body / solid
    assert removed > 0 and abs(history(folder)["removed_volume"][-1] / removed - 1) < 1e-9, (removed, held)
    # The chisel is 15 mm wide. Nothing has come off when its path of means begins, and the run ends with that path.
    with results(folder) as file:
        side = (file["particles/position"][:] - file["particles/displacement"][:])[:, 1]
    beside = ~np.isin(fragment, held) & (abs(side) > 7.5e-3)
    found = np.sum(4 / 3 * math.pi * radius[beside] ** 3) * body / solid
    assert 0 < found < removed and abs(reading(folder, "removed_beside") / found - 1) < 1e-9, (found, reading(folder, "removed_beside"))


@fact
def removed_rock_and_contact_area_do_not_depend_on_the_rows(folder):
    found = []
    for rows in (11, 400):
        place = os.path.join(folder, str(rows))
        run(write_scene(folder, BLOCK), place, *sets(output__history_rows=rows))
        found.append({name: reading(place, name) for name in ("removed_volume", "contact_area")})
    assert found[0] == found[1] and found[0]["removed_volume"] > 0, found
    balls = found[0]["contact_area"] / (math.pi * 2e-3**2)  # the face of 15 x 5 mm has room for 10; most are pushed off
    assert 0 < balls < 10, balls


@fact
def a_tool_in_rock_that_does_not_break_is_told_as_the_reason(folder):
    scene = write_scene(folder, BLOCK.replace("tensile_strength: 5 MPa, shear_strength: 20 MPa", "tensile_strength: 1 TPa, shear_strength: 1 TPa"))
    failed = gneiss("run", scene, "--out", folder, "--quiet")
    expect(failed, 5, r"body 'pick' was pushed over the centres? of \d+ particles?, which its contacts cannot push aside: its stiffness must be higher, or bonds")
    assert "a smaller time.step" not in failed.stderr, failed.stderr


@fact
def a_chisel_that_meets_nothing_has_no_force(folder):
    scene = write_scene(folder, BLOCK.replace("origin: [-2 mm, 0, -5 mm]", "origin: [-2 mm, 0, 5 mm]"))
    run(scene, folder)
    s = summary(folder)
    text = {w["name"]: w["text"] for w in s["warnings"]}
    assert "depth is 0.005 m, the tool begins 0.003858 m above the surface of the rock" in text["cutting_depth"], text  # its top is at 1.142 mm
    assert "the tool 'pick' never touched the rock" in text["nothing_measured"], text
    assert s["readings"]["normal_force"] is None


@plain_fact
def a_tool_pressed_by_a_force_does_its_work(folder):
    pressed = sets(bodies__disc__motion__vz="free", bodies__disc__force="[0, 0, -60 kN]", bodies__disc__mass="1 t", time__end="8 ms")
    run(example("disc"), folder, *COARSE, *FAST, *pressed)
    h, s = history(folder), summary(folder)
    sunk = -h["body_disc_displacement_z"][-1]
    assert abs(h["energy_work_applied"][-1] / (60e3 * sunk) - 1) < 1e-9, (h["energy_work_applied"][-1], sunk)
    assert abs(s["energy_residual"]) < 1e-3, s["energy_residual"]
    push = np.diff(h["normal_impulse"][[0, -1]])[0] - 60e3 * h["time"][-1]  # momentum of the disc upward, as gravity is absent
    assert abs(push - 1000 * h["body_disc_velocity_z"][-1]) < 0.01 * 60e3 * h["time"][-1]
    expect(gneiss("check", example("disc"), *COARSE, *sets(bodies__disc__force="[0, 0, -60 kN]")), 2, "force: expected 0 along z, where motion")


@plain_fact
def every_example_cuts_and_closes_its_ledger(folder):
    coarse = {
        "relieved": COARSE + sets(bodies__first__motion__vx="16 m/s", bodies__second__motion__vx="16 m/s"),
        "coupled": FAST + sets(specimen__mean_radius="5.5 mm", output__snapshots=0, time__end="4 ms"),
        "pick": sets(specimen__mean_radius="3.5 mm", output__snapshots=0, bodies__pick__motion__vx="12 m/s"),
        "pick-plane": sets(specimen__mean_radius="2 mm", output__snapshots=0, bodies__pick__motion__vx="9 m/s"),
    }
    for name, options in coarse.items():
        place = os.path.join(folder, name)
        run(example(name), place, *options)
        h = closes(place, tools=2 if name in ("relieved", "coupled") else 1)
        assert h["removed_volume"][-1] > 0, name
        if name != "coupled":
            assert reading(place, "rolling_force") > 0, name
        damage, height = reading(place, "damage_depth"), {"relieved": 0.03, "coupled": 0.092, "pick": 0.025, "pick-plane": 0.025}[name]
        through = any(w["name"] == "cutting_block" and " m high" in w["text"] for w in summary(place)["warnings"])
        assert through == (damage > 0.75 * height) and damage > 0.2 * height, (name, damage)  # elements are a part of the block


@plain_fact
def elements_turn_into_particles_ahead_of_a_tool(folder):
    run(example("adaptive"), folder, *sets(time__end="3.4 ms", output__snapshots=0))
    h = closes(folder)
    assert h["rolling_impulse"][-1] > 0 and h["removed_volume"][-1] > 0
    assert 0 == h["particles"][0] < h["particles"][-1] < 0.5 * summary(folder)["counts"]["particles"]
    assert not any(w["name"] == "conversion_halted" for w in summary(folder)["warnings"])
    # No element is left within reach of the chisel, which has no contact with elements: its tip ends at 4.2 mm, 5 mm deep.
    with results(folder) as file:
        at = file["nodes/position"][:][np.unique(file["elements/node"][:])]
    assert np.hypot(at[:, 0] - 4.2e-3, at[:, 1] + 5e-3).min() > 4e-3 - 50 * 4e-7 * 3
    without = gneiss("check", example("adaptive"), "--set", "couple.convert.bodies=none")
    expect(without, 2, "bodies: expected no bodies, or couple.convert.bodies beside couple.convert, found bodies without it")


@plain_fact
def a_reserve_that_ends_before_the_path_is_told_by_check(folder):
    def said(*options):
        return " ".join(re.findall("warning: .*", gneiss("check", example("adaptive"), *options).stdout))

    assert "couple.convert.bodies" not in said(), said()
    # The chisel moves 15 mm into the rock; it is 0.15 mm ahead of its origin at the surface, and 4 + 8 mm more convert or are a zone.
    short = said(*sets(specimen__packing__region="{min: [0 mm, -65.1 mm], max: [25.1 mm, 0 mm]}"))
    found = re.search(r"would cross the upper x side of couple.convert.box after a path of (\S+) m, before means end at 0.021 m", short)
    assert found and 0.0185 < float(found[1]) < 0.0200 and "or a smaller test.length" in short, short
    shallow = said(*sets(specimen__packing__region="{min: [0 mm, -15.1 mm], max: [125.1 mm, 0 mm]}"))
    assert "would cross the lower y side of couple.convert.box after a path of 0 m" in shallow, shallow


@fact
def the_section_of_a_chisel_is_its_width_times_the_depth(folder):
    run(write_scene(folder, BLOCK), folder)
    closes(folder)
    energy = reading(folder, "rolling_force") / (15e-3 * 5e-3)
    assert abs(reading(folder, "specific_energy") / energy - 1) < 1e-12
    h = history(folder)  # of the stress, too, and `check` prints it
    assert np.allclose(h["stress"], h["rolling_force"] / (15e-3 * 5e-3), rtol=1e-12)
    assert "area 7.5e-05 m2" in gneiss("check", write_scene(folder, BLOCK)).stdout
    absent = summary(folder)["absent"]
    assert "tensile_strength" in absent["predicted_peak_evans"] and "no closed form" in absent["predicted_coefficient"]


@fact
def tools_that_cannot_cut_are_refused_with_their_place(folder):
    cases = [
        (("origin: [-2 mm, 0, -5 mm]", "origin: [15 mm, 0, -5 mm]"), r"scene.yaml:\d+:\d+: test.tool: expected a tool that begins outside .* inside 'pick'"),
        (("length: 10 mm}", "length: 90 mm}"), r"scene.yaml:\d+:\d+: test.length: expected at most 0.04\d* m, after which .* found 0.09 m"),
        (("length: 10 mm}", "run_in: 90 mm}"), r"scene.yaml:\d+:\d+: test.run_in: expected a tool that is in the rock"),
        (("motion: {vx: 5 m/s}", "motion: {vz: 5 m/s}"), r"scene.yaml:\d+:\d+: test.tool: expected a body whose motion prescribes a velocity along x"),
        (("tool: pick", "tool: pikc"), r"scene.yaml:\d+:\d+: test.tool: expected the name of a body, found 'pikc'.*pick"),
        (("tool: pick, ", ""), r"test.tool: required by a cutting test"),
        (("depth: 5 mm, ", ""), r"test.depth: required by a cutting test"),
        (("normal: z", "normal: x"), r"test.normal: expected another direction than axis"),
        (("tool: pick", "tool: pick, lower: base"), r"test.lower: expected none: a cutting test has no ends, but a tool"),
        (("tool: pick", "tool: pick, span: 2 mm"), r"test.span: expected in tests of the kind bending, found cutting"),
        (("width: 15 mm, ", ""), r"bodies\[0\].chisel.width: required in a 3D scene"),
        (("rake_angle: 10 deg", "rake_angle: 85 deg"), r"bodies\[0\] \(pick\): clearance_angle: expected less than 90 degrees"),
    ]
    for (old, new), pattern in cases:
        assert old in BLOCK, old
        expect(gneiss("check", write_scene(folder, BLOCK.replace(old, new))), 2, pattern)
    expect(gneiss("check", example("pick-plane"), *sets(**{"test.spacing": "20 mm"})), 2,
           "test.spacing: expected none in a 2D scene, whose cut is 1 m wide, found 0.02 m")
    scene = BLOCK.replace("kind: cutting", "kind: tension").replace("tool: pick", "lower: base, upper: pick, tool: pick")
    expect(gneiss("check", write_scene(folder, scene)), 2, r"test.(depth|normal|tool): expected in tests of the kind")


@fact
def a_locked_disc_and_another_depth_are_doubted(folder):
    locked = gneiss("check", example("disc"), *COARSE, *sets(bodies__disc__motion__wy=0))
    assert "the disc cutter 'disc' cannot turn about its axis" in locked.stdout, locked.stdout[-2000:]
    deep = gneiss("check", example("disc"), *COARSE, *sets(test__depth="8 mm"))
    assert "depth is 0.008 m, the tool begins 0.004" in deep.stdout, deep.stdout[-2000:]
    fine = re.findall("warning:.*", gneiss("check", example("disc"), *COARSE).stdout)
    assert len(fine) == 1 and re.search(r"test: depth is 0.004 m, 0.4 mean diameters of particles \(0.0099", fine[0]), fine


@plain_fact
def a_cut_that_cannot_be_read_as_given_is_doubted(folder):
    cases = [
        ("bodies.disc.rotation=[0, 0, 90 deg]", "axis of the disc cutter 'disc' is 90 degrees off y"),
        ("bodies.disc.origin=[-42 mm, 200 mm, 212 mm]", "the tool 'disc' passes beside the rock: along y it is from 0.192 m to 0.208 m"),
        ("test.spacing=10 m", "spacing is 10 m, the rock is 0.08"),
        ("test.tensile_strength=200 MPa", r"compressive_strength is 1.47e\+08 Pa, below tensile_strength of 2e\+08 Pa"),
        ("test.peak_window=1 m", "peak_window is 1 m, longer than the path of the means"),
        ("time.end=1 ms", r"until time.end \(0.001 s\) the tool moves 0.004 m, means are taken from 0.04"),
        ("bodies.disc.motion.vz=0.1 m/s", r"the tool is 0.00[23]\d* m below the surface of the rock where means begin and 0.00[12]\d* m below it where they end"),
    ]
    for setting, words in cases:
        said = gneiss("check", example("disc"), *COARSE, "--set", setting)
        assert said.returncode == 0 and re.search("warning: .*" + words, said.stdout), (setting, re.findall("warning:.*", said.stdout), said.stderr)


@fact
def a_cut_in_stages_is_followed_and_read(folder):
    rest = "stages:\n  - {name: rest, bodies: {pick: {motion: {vx: 0}}}, end: {time: 0.4 ms}}\n"
    cut = "  - {name: cut, bodies: {pick: {motion: {vx: [[0, 0], [0.2 ms, 5]]}}}}\n"
    scene = write_scene(folder, BLOCK + rest + cut)
    checked = gneiss("check", scene).stdout  # 14 mm at 5 m/s after 0.4 ms of rest and 0.2 ms of acceleration: 3.3 ms
    assert "the tool comes" not in checked and "where they end" not in checked, checked
    short = gneiss("check", scene, "--set", "time.end=3 ms").stdout
    assert re.search(r"until time.end \(0.003 s\) the tool moves 0.0125 m, means are taken from 0.004", short), short
    rise = gneiss("check", scene, "--set", "stages.cut.bodies.pick.motion.vz=0.5 m/s").stdout
    # The upper face is at 1.142 mm; the tool rises for 0.9 ms until means begin, and for 2.9 ms until they end.
    assert re.search(r"the tool is 0.00569\d* m below .* begin and 0.00469\d* m below it where they end", rise), rise
    long = "test.length=90 mm"
    expect(gneiss("check", scene, "--set", long), 2, r"test.length: expected at most 0.04\d* m, after which .* found 0.09 m")
    run(scene, folder)
    assert reading(folder, "rolling_force") > 0 and reading(folder, "removed_volume") > 0
    h = history(folder)
    assert h["cut_path"][h["time"] < 0.4e-3].max() == 0 and h["cut_path"][-1] > 14e-3


BACK = "  - {name: back, select: {end: {axis: x, side: upper, depth: 2 mm, by: centre}}, motion: {vx: 0, vy: 0, vz: 0}}\n"


@fact
def a_path_ends_two_depths_before_a_held_back(folder):
    held = BLOCK.replace("bodies:\n", BACK + "bodies:\n", 1)
    free = held.replace(", length: 10 mm", "")
    run(write_scene(folder, free), folder, "--set", "time.end=8 ms")
    assert summary(folder)["stop_reason"].startswith("the tool has reached the end of its path"), summary(folder)["stop_reason"]
    closes(folder)
    with results(folder) as file:
        x, radius = (file["particles/position"][:] - file["particles/displacement"][:])[:, 0], file["particles/radius"][:]
    last = x > x.max() - 1e-4
    end = (x - radius)[last].min() + 2e-3 - 2 * 5e-3  # the tool begins at -2 mm and cuts 5 mm deep
    assert abs(history(folder)["cut_path"][-1] - end) < 1e-4, (history(folder)["cut_path"][-1], end)
    # Nearer to it a given length is doubted, and beyond it refused; a set that only holds the back across the cut is no obstacle.
    near, far = (held.replace("length: 10 mm", f"length: {1e3 * (end + more):.3f} mm, run_in: 1 um") for more in (6e-3, 11e-3))
    said = gneiss("check", write_scene(folder, near)).stdout
    found = re.search(r"after a path of (\S+) m the tool reaches particles that are held along the cut, and the path of the means ends at (\S+) m", said)
    assert found and abs(float(found[1]) - end - 10e-3) < 1e-5 and abs(float(found[2]) - end - 6e-3) < 1e-5, re.findall("warning:.*", said)
    expect(gneiss("check", write_scene(folder, far)), 2, r"test.length: expected at most 0.0\d+ m, after which .* reaches particles that are held along the cut")
    across = write_scene(folder, free.replace(BACK, BACK.replace("vx: 0, ", "")))
    assert "held along the cut" not in gneiss("check", across).stdout
    assert float(re.search(r"length (\S+) m", gneiss("check", across).stdout)[1]) > end + 10e-3


@fact
def a_block_that_breaks_as_a_whole_is_reported(folder):
    def stronger(tension, layers, height):
        block = BLOCK.replace("5 MPa, shear_strength: 20 MPa", f"{tension} MPa, shear_strength: {4 * tension} MPa")
        return block.replace("[8, 4, 3]", f"[8, 8, {layers}]").replace("-17 mm", f"-{height} mm")

    shallow = stronger(20, 4, 23).replace("width: 15 mm", "width: 5 mm").replace("0, -5 mm]", "6 mm, -2 mm]").replace("depth: 5 mm", "depth: 2 mm")
    said = {}
    for name, scene in (("through", BLOCK), ("wide", stronger(10, 6, 34)), ("little", shallow)):
        place = os.path.join(folder, name)
        run(write_scene(folder, scene), place, "--set", "time.end=2.2 ms")
        said[name] = {w["name"]: w["text"] for w in summary(place)["warnings"]}.get("cutting_block", "")
    found = re.match(r"bonds are broken down to (\S+) m below the surface of the rock, which is (\S+) m high: the block broke as a whole", said["through"])
    assert found and float(found[1]) > 0.75 * float(found[2]), said
    assert abs(float(found[1]) / reading(os.path.join(folder, "through"), "damage_depth") - 1) < 1e-3, said
    assert reading(os.path.join(folder, "wide"), "damage_depth") < 0.75 * 0.035, said
    found = re.match(r"the section of the removed rock is (\S+) m2, depth times (\S+) m, and the rock is (\S+) m wide", said["wide"])
    length = history(os.path.join(folder, "wide"))["cut_path"][-1] - 4e-3  # means begin where the rock does, 4 mm after the start
    assert found and abs(float(found[1]) / (reading(os.path.join(folder, "wide"), "removed_volume") / length) - 1) < 1e-2, (said, length)
    assert abs(float(found[1]) / float(found[2]) / 5e-3 - 1) < 1e-3 and float(found[2]) >= float(found[3]) > 0.045, said
    assert not said["little"] and reading(os.path.join(folder, "little"), "damage_depth") < 0.01, said


@fact
def means_over_a_part_of_the_path_and_a_tool_that_rises_are_reported(folder):
    run(write_scene(folder, BLOCK.replace("vx: 5 m/s", "vx: 5 m/s, vz: 1 m/s")), folder, "--set", "time.end=1.4 ms")  # 7 of 14 mm, 4 of which are before the rock
    text = {w["name"]: w["text"] for w in summary(folder)["warnings"]}
    means = re.search(r"had come (\S+) m: means are over (\S+) m of the 0.01 m from 0.004 m to 0.014 m of its path, 30 %", text["cutting_path"])
    assert means and abs(float(means[1]) - 7e-3) < 2e-5 and abs(float(means[2]) - 3e-3) < 2e-5, text
    found = re.search(r"the tool is (\S+) m below .* begin and (\S+) m below it where they end", text["cutting_depth"])
    assert abs(float(found[1]) - float(found[2]) - 0.2 * 3e-3) < 5e-6, text  # it rises by a fifth of its path


main()
