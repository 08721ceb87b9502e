"""Joints in packings: Coulomb's threshold, direct shear, places from files, refusals. Speaks TAP."""
import json
import math
import os
import re
import sys

import h5py
import numpy as np

from program import expect, fact, gneiss, history, main, run, summary, write_scene

WIDTH, HEIGHT, SIGMA = 0.06, 0.024, 1e6


def packed(joint, count=150, seed=1, modulus=10e6, **more):
    """A bonded packing of discs whose lower half is held; `joint`: keys of its joint at half the height."""
    place = {"name": "plane", "point": [0, HEIGHT / 2], "normal": [0, 1]}
    scene = {
        "dimension": 2,
        "specimen": {"rectangle": {"width": WIDTH, "height": HEIGHT}, "particles": count, "packing": {"size_ratio": 2}},
        "materials": [{"name": "rock", "density": 2600, "contact_modulus": modulus, "kratio": 2, "friction": 0.5,
                       "tensile_strength": 1e15, "shear_strength": 1e15}],
        "law": {"stiffness": "harmonic"},
        "bonds": {"interaction_range": 0.05},
        "sets": [{"name": "below", "select": {"box": {"min": [-1, -1], "max": [1, HEIGHT / 2]}},
                  "motion": {"vx": 0, "vy": 0}},
                 {"name": "above", "select": {"box": {"min": [-1, HEIGHT / 2], "max": [1, 1]}}}],
        "time": {"end": 0.1},
        "output": {"history_rows": 400, "snapshots": 0},
        "run": {"seed": seed, "threads": 1},
        **more}
    if joint is not None:
        scene["joints"] = [{**place, **joint}]
    return scene


# --- a block on an incline ---


def slid(folder, name, degrees, friction, **more):
    """Paths in the second half of the run, and the final shear over normal force."""
    tilt = math.radians(degrees)
    scene = packed({"normal_stiffness": 1e8, "shear_stiffness": 1e8, "friction": friction},
                   gravity=[9.81 * math.sin(tilt), -9.81 * math.cos(tilt)],
                   damping={"background": {"model": "nonviscous_vector", "coefficient": 0.7}}, **more)
    run(write_scene(folder, scene, name + ".yaml"), os.path.join(folder, name))
    h = history(os.path.join(folder, name))
    slip = h["joint_plane_slip"]
    return slip[-1] - slip[len(slip) // 2], h["joint_plane_shear"][-1] / h["joint_plane_normal"][-1], h


@fact
def a_block_slides_at_the_friction_of_its_joint_at_any_tilt(folder):
    for degrees in (10, 30, 60):
        tangent = math.tan(math.radians(degrees))
        path, ratio, h = slid(folder, f"rests{degrees}", degrees, 1.005 * tangent)
        assert path == 0 and abs(ratio / tangent - 1) < 1e-6, (degrees, path, ratio)
        assert abs(h["energy_residual"][-1]) < 1e-8
        path, ratio, h = slid(folder, f"slides{degrees}", degrees, 0.995 * tangent)
        assert path > 1e-6 and abs(ratio / (0.995 * tangent) - 1) < 1e-9, (degrees, path, ratio)
        assert abs(h["energy_residual"][-1]) < 1e-8 and h["energy_friction"][-1] > 0


@fact
def a_joint_that_dips_in_the_packing_has_the_same_threshold(folder):
    """The joint goes through the middle at a dip of 35 degrees; the wedge above is free."""
    tilt, middle = math.radians(35), [WIDTH / 2, HEIGHT / 2]
    source = packed(None)
    source["time"]["end"] = 1e-4
    run(write_scene(folder, source, "pack.yaml"), os.path.join(folder, "pack"))
    with h5py.File(os.path.join(folder, "pack", "results.h5")) as file:
        group = file["particles"]
        place = group["position"][:] - group["displacement"][:]
        radius = group["radius"][:]
    turn = np.array([[math.cos(tilt), math.sin(tilt)], [-math.sin(tilt), math.cos(tilt)]])
    turned = (place[:, :2] - middle) @ turn.T
    held = [int(k) for k in np.nonzero(place[:, 1] < middle[1])[0]]
    for factor, moves in ((1.005, False), (0.995, True)):
        scene = packed({"point": [0, 0], "dip": "35 deg", "normal_stiffness": 1e8, "shear_stiffness": 1e8,
                        "friction": factor * math.tan(tilt)}, gravity=[0, -9.81],
                       damping={"background": {"model": "nonviscous_vector", "coefficient": 0.7}})
        del scene["joints"][0]["normal"]
        scene["specimen"] = {"particles": [[*map(float, x), float(r)] for x, r in zip(turned, radius)]}
        scene["sets"] = [{"name": "below", "select": {"ids": held}, "motion": {"vx": 0, "vy": 0}}]
        out = os.path.join(folder, f"dips{moves}")
        run(write_scene(folder, scene), out)
        slip = history(out)["joint_plane_slip"]
        assert (slip[-1] > slip[200]) == moves, (factor, slip[200], slip[-1])


# --- direct shear ---

SHEAR = {"normal_stiffness": 1e11, "shear_stiffness": 5e10, "friction": 0.5, "bond_friction": 0.8, "cohesion": 1e6,
         "tensile_strength": 2e5, "dilation": 0.1, "dilation_end": 1e-4}


def sheared(folder, seed, joint, speed=0.1):
    """A rigid block, pressed by 1 MPa and then pushed along the joint."""
    scene = packed(joint, seed=seed, modulus=1e12,
                   damping={"background": {"model": "viscous", "coefficient": 1e5}})
    scene["sets"][1] |= {"force": [0, -SIGMA * WIDTH], "motion": {"vx": [[2e-4, 0], [3e-4, speed]]}}
    scene["time"]["end"] = 2.5e-3
    scene["output"]["history_rows"] = 1500
    out = os.path.join(folder, f"shear{seed}")
    run(write_scene(folder, scene), out)
    return history(out)


@fact
def direct_shear_follows_its_closed_forms_in_any_packing(folder):
    """Closure sigma/k_n; slope k_s; peak c + sigma tan(phi); then friction; opening tan(psi) times slip up to its end."""
    for seed in (1, 2, 3):
        h = sheared(folder, seed, SHEAR)
        shear, normal, gap, slip = (h["joint_plane_" + name] for name in ("shear", "normal", "gap", "slip"))
        assert abs(h["joint_plane_area"][0] / WIDTH - 1) < 1e-9
        before = np.searchsorted(h["time"], 1.9e-4)
        assert abs(gap[before] * 1e11 / -SIGMA - 1) < 0.002, gap[before]
        peak = int(shear.argmax())
        wanted = 1e6 * WIDTH + 0.8 * normal[peak]
        # A row is one five-hundredth of the path to the peak.
        assert abs(shear[peak] / wanted - 1) < 0.005, (seed, shear[peak] / wanted)
        rise = (h["time"] > 3.2e-4) & (np.arange(len(shear)) < peak)
        slope = np.polyfit(h["time"][rise], shear[rise], 1)[0] / 0.1 / WIDTH
        assert abs(slope / 5e10 - 1) < 0.005, slope
        late = slice(peak + (len(shear) - peak) // 4, None)
        assert np.allclose(shear[late], 0.5 * normal[late], rtol=1e-9)
        assert np.allclose(h["joint_plane_broken"][late], WIDTH)
        opening = (slip > 4e-5) & (slip < 9e-5)
        assert abs(np.polyfit(slip[opening], gap[opening], 1)[0] / 0.1 - 1) < 0.01
        ended = slip > 1.3e-4
        # Less viscous drag on the rise presses on the sides once they have stopped to part.
        assert abs(gap[ended].mean() - (0.1 * 1e-4 - SIGMA / 1e11)) < 0.02 * 0.1 * 1e-4, gap[ended].mean()
        assert abs(h["energy_residual"][-1]) < 1e-7


@fact
def a_smooth_joint_slides_far_at_its_friction_where_particles_ride_over_others(folder):
    """Both sides part by sliding over each other without the law of joints; with it they stay."""
    h = sheared(folder, 1, {"normal_stiffness": 1e11, "shear_stiffness": 5e10, "friction": 0.5}, speed=2.0)
    slip = h["joint_plane_slip"]
    assert slip[-1] > 4e-3 and abs(h["joint_plane_gap"][-1]) < 5e-5
    late = slip > 1e-3
    assert np.allclose(h["joint_plane_shear"][late], 0.5 * h["joint_plane_normal"][late], rtol=1e-9)
    # Contacts of particles that slide off and meet others keep the load.
    assert abs(h["joint_plane_normal"][late].mean() / (SIGMA * WIDTH) - 1) < 0.02
    assert abs(h["energy_residual"][-1]) < 1e-5
    scene = packed(None, modulus=1e12, damping={"background": {"model": "viscous", "coefficient": 1e5}})
    scene["sets"][1] |= {"group": 2, "force": [0, -SIGMA * WIDTH], "motion": {"vx": [[2e-4, 0], [3e-4, 2.0]]}}
    scene["time"]["end"] = 2.5e-3
    out = os.path.join(folder, "rough")
    run(write_scene(folder, scene), out)
    with h5py.File(os.path.join(out, "results.h5")) as file:
        rise = file["particles/displacement"][:, 1].max()
    assert rise > 2e-4, rise


# --- stiffness of a specimen ---


def stretched(folder, name, stiffness, levels=(8, 12, 16)):
    """The modulus in Pa of a packing with horizontal joints at heights in mm, in tension."""
    scene = packed(None, count=300, modulus=20e9, damping={"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
                   test={"kind": "tension", "axis": "y", "lower": "below", "upper": "above", "length": HEIGHT, "diameter": WIDTH})
    scene["sets"] = [{"name": name, "select": {"end": {"axis": "y", "side": side, "depth": 4e-3}}, "motion": {"vy": [[0, 0], [5e-4, speed]]}}
                     for name, side, speed in (("below", "lower", -2e-3), ("above", "upper", 2e-3))]
    scene["joints"] = [{"name": f"j{level}", "point": [0, level / 1e3], "normal": [0, 1], "normal_stiffness": stiffness,
                        "shear_stiffness": stiffness / 2, "cohesion": 1e12, "tensile_strength": 1e12} for level in levels]
    scene["time"]["end"] = 2e-3
    out = os.path.join(folder, name)
    run(write_scene(folder, scene, name + ".yaml"), out)
    h = history(out)
    late = slice(len(h["time"]) // 2, None)
    return np.polyfit(h["strain"][late], h["stress"][late], 1)[0]


@fact
def a_set_of_joints_adds_its_compliance_to_that_of_the_rock(folder):
    """1/E = const + 1/(k_n s) (Amadei & Goodman 1981); the constant is below 1/E of the rock, because joints replace bonds."""
    stiff, soft = 2e12, 2e11
    found = 1 / stretched(folder, "soft", soft) - 1 / stretched(folder, "stiff", stiff)
    wanted = 3 / HEIGHT * (1 / soft - 1 / stiff)
    assert abs(found / wanted - 1) < 0.02, found / wanted


# --- places ---


@fact
def joints_come_from_traces_files_and_surfaces(folder):
    with open(os.path.join(folder, "discs.csv"), "w") as file:
        file.write("x, y, dip, half-length\n# two lines\n0.02, 0.012, 0, 0.01\n0.045, 0.012, 60, 0.004\n")
    stiff = {"normal_stiffness": 1e11, "shear_stiffness": 1e11, "friction": 0.5}
    scene = packed(None)
    scene["joints"] = [{"name": "line", "trace": [[0, 0.004], [0.03, 0.006], [0.1, 0.006]], **stiff},
                       {"name": "file", "discs": "discs.csv", **stiff}]
    scene["time"]["end"] = 1e-3
    run(write_scene(folder, scene), os.path.join(folder, "plane"))
    h = history(os.path.join(folder, "plane"))
    assert abs(h["joint_line_area"][0] / (math.hypot(0.03, 0.002) + 0.03) - 1) < 1e-9
    assert abs(h["joint_file_area"][0] / 0.028 - 1) < 1e-9
    with open(os.path.join(folder, "wavy.obj"), "w") as file:
        file.write("v 0 0 0.004\nv 0.01 0 0.005\nv 0.01 0.01 0.004\nv 0 0.01 0.005\nf 1 2 3\nf 1 3 4\n")
    solid = {**packed(None), "dimension": 3}
    solid["specimen"] = {"box": {"size": [0.01, 0.01, 0.01]}, "particles": 300}
    del solid["sets"]
    solid["joints"] = [{"name": "wavy", "surface": "wavy.obj", **stiff}]
    solid["time"]["end"] = 1e-4
    run(write_scene(folder, solid), os.path.join(folder, "space"))
    side = np.array([[0.01, 0, 0.001], [0.01, 0.01, 0], [0, 0.01, 0.001]])
    area = 0.5 * sum(np.linalg.norm(np.cross(side[k], side[k + 1])) for k in (0, 1))
    assert abs(history(os.path.join(folder, "space"))["joint_wavy_area"][0] / area - 1) < 1e-9
    assert summary(os.path.join(folder, "space"))["steps"] > 0


# --- what a packing resolves ---


def told(folder, joints, **more):
    """The warnings of a run by name, and the output of `gneiss check`."""
    scene = packed(None, **more)
    scene["joints"] = [{"normal_stiffness": 1e11, "shear_stiffness": 1e11, "friction": 0.5, **joint} for joint in joints]
    scene["time"]["end"] = 1e-5
    path, out = write_scene(folder, scene), os.path.join(folder, "told")
    run(path, out)
    with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
        warnings = {w["name"]: w["text"] for w in json.load(file)["warnings"]}
    with h5py.File(os.path.join(out, "results.h5")) as file:
        assert "joints" in np.char.decode(file.attrs["effects"]).item().split()
    text = gneiss("check", path).stdout
    assert "+ joints " in gneiss("plan", path).stdout
    return warnings, text


@fact
def joints_closer_than_particles_are_warned_of(folder):
    apart = [{"name": "a", "point": [0, 0.006], "normal": [0, 1]}, {"name": "b", "point": [0, 0.018], "normal": [0, 1]}]
    warnings, text = told(folder, apart)
    assert not {"joints_close", "joints_area"} & set(warnings) and "warning:" not in text, text
    assert len(re.findall(r"joint +'[ab]': [1-9]\d* contacts, area 0.06 m2 of 0.06 m2", text)) == 2, text
    apart[1]["point"] = [0, 0.006 + 1e-5]
    warnings, text = told(folder, apart)
    few, most = map(int, re.match(r"(\d+) of (\d+) contacts", warnings["joints_close"]).groups())
    assert 0.9 * most < few <= most and warnings["joints_close"] in text, warnings
    # Segments of one surface do not count as several joints.
    warnings, text = told(folder, [{"name": "line", "trace": [[-0.001 + 0.001 * k, 0.012] for k in range(63)]}])
    assert "joints_close" not in warnings, warnings


@fact
def area_that_no_contact_crosses_is_warned_of(folder):
    """Lines of a tenth of the particles, of which most lie between contacts."""
    small = {"name": "net", "dip": 0, "radius": 2e-4, "network": {"intensity": 20}}
    warnings, text = told(folder, [small])
    reached, wanted, less = map(float, re.search(r"'net' (\S+) m2 of (\S+) m2 \(-(\d+) %\)",
                                                 warnings["joints_area"]).groups())
    assert abs(wanted / (20 * WIDTH * HEIGHT) - 1) < 0.02 and abs(1 - reached / wanted - less / 100) < 0.006
    assert abs(history(os.path.join(folder, "told"))["joint_net_area"][0] / reached - 1) < 1e-3
    assert warnings["joints_area"] in text and less > 5


# --- a joint alone fails ---


@fact
def a_break_of_a_joint_is_a_failure_of_the_specimen(folder):
    """No bond can break; the joint at 60 degrees to the load does."""
    height = 0.05
    scene = {
        "dimension": 2,
        "specimen": {"rectangle": {"width": 0.025, "height": height}, "particles": 200},
        "materials": [{"name": "rock", "density": 2600, "contact_modulus": 2e10, "kratio": 2, "friction": 0.5,
                       "tensile_strength": 1e15, "shear_strength": 1e15}],
        "law": {"stiffness": "harmonic"},
        "bonds": {"interaction_range": 0.05},
        "joints": [{"name": "plane", "point": [0.0125, height / 2], "dip": "60 deg", "normal_stiffness": 2e11,
                    "shear_stiffness": 1e11, "friction": 0.3, "cohesion": 2e6, "tensile_strength": 1e6}],
        "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
        "walls": [{"name": "bottom", "point": [0, 0], "normal": [0, 1], "stiffness": 5e10, "passive": True,
                   "motion": {"vy": 0.05}},
                  {"name": "top", "point": [0, height], "normal": [0, -1], "stiffness": 5e10, "passive": True,
                   "motion": {"vy": -0.05}}],
        "test": {"kind": "compression", "axis": "y", "lower": "bottom", "upper": "top", "length": height,
                 "diameter": 0.025},
        "time": {"end": 5e-3, "stop": {"peak_drop": 0.5}},
        "output": {"history_rows": 1000, "snapshots": 0},
        "run": {"threads": 1}}
    out = os.path.join(folder, "weak")
    run(write_scene(folder, scene), out)
    h, end = history(out), summary(out)
    assert h["broken_tension"][-1] + h["broken_shear"][-1] == 0
    assert h["broken_joints"][0] == 0 and h["broken_joints"][-1] >= 5
    assert "stress fell by 0.5 of its peak" in end["stop_reason"], end["stop_reason"]
    peak = end["readings"]["peak_stress"]
    assert abs(peak / h["stress"].max() - 1) < 1e-9, peak
    # Coulomb: 2 c/(sin 2 beta - mu (1 + cos 2 beta)), with beta the dip.
    turn = math.radians(120)
    assert abs(peak / (4e6 / (math.sin(turn) - 0.3 * (1 + math.cos(turn)))) - 1) < 0.1, peak


@fact
def wrong_joints_are_refused_with_their_place(folder):
    good = {"normal_stiffness": 1e11, "shear_stiffness": 1e11}
    with open(os.path.join(folder, "wrong.csv"), "w") as file:
        file.write("0.02, 0.012, 0, 0.01\n0.02, 0.012, x, 0.01\n")
    cases = [({**good, "dip": "20 deg"}, {}, r"scene.yaml:\d+:\d+: joints\[0\].dip: expected normal or dip, found both"),
             ({**good, "discs": "wrong.csv"}, {}, "expected one of point, trace, surface, discs and network"),
             ({**good, "point": [0, 1]}, {}, "expected a joint that contacts between particles cross"),
             (good, {"run": {"precision": "mixed"}}, "expected a scene without run.precision: mixed"),
             ({**good, "network": {"intensity": 10}}, {}, "expected one of point"),
             ({"normal_stiffness": 1e11}, {}, "shear_stiffness"),
             ({**good, "friction": 0.3, "dilation": 0.31}, {}, r"joints\[0\].dilation: expected at most friction, 0.3"),
             ({**good, "dilation": 0.01}, {}, r"scene.yaml:\d+:\d+: joints\[0\].dilation: expected at most friction, 0,")]
    for joint, more, words in cases:
        expect(gneiss("run", write_scene(folder, packed(joint, **more)), "--out", os.path.join(folder, "o")), 2, words)
    scene = packed(None)
    scene["joints"] = [{"name": "file", "discs": "wrong.csv", **good}]
    expect(gneiss("run", write_scene(folder, scene), "--out", os.path.join(folder, "o")), 2,
           r"wrong.csv:2:14: expected 4 numbers")


@fact
def polygons_that_cross_themselves_are_refused(folder):
    square = [[-0.004, -0.004], [0.004, -0.004], [0.004, 0.004], [-0.004, 0.004]]
    slit = [[-0.004, -0.004], [0.004, -0.004], [0.004, 0.004], [0, 0.004], [0, 0], [0, 0.004], [-0.004, 0.004]]
    cases = [(square, None), ([*square, square[0]], None), (slit, None),
             ([square[k] for k in (0, 2, 1, 3)], r"scene.yaml:\d+:\d+: joints\[0\].polygon: .*sides 1 and 3"),
             ([[-0.004, -0.004], [0.004, 0], [0.004, -0.004], [-0.004, 0.004]], "sides 1 and 3"),
             # A corner on another side.
             ([*square[:3], [0, -0.004]], "sides 1 and 3")]
    solid = {**packed(None), "dimension": 3}
    solid["specimen"] = {"box": {"size": [0.01, 0.01, 0.01]}, "particles": 200}
    del solid["sets"]
    for polygon, words in cases:
        solid["joints"] = [{"name": "p", "point": [0.005, 0.005, 0.005], "normal": [0, 0, 1], "polygon": polygon,
                            "normal_stiffness": 1e11, "shear_stiffness": 1e11}]
        done = gneiss("check", write_scene(folder, solid))
        if words:
            expect(done, 2, words)
        else:
            assert done.returncode == 0, done.stderr


@fact
def what_knows_no_joints_refuses_them(folder):
    joint = {"normal_stiffness": 1e11, "shear_stiffness": 1e11, "friction": 0.5}
    scene = packed(joint)
    scene["time"]["end"] = 1e-5
    path = write_scene(folder, scene, "jointed.yaml")
    expect(gneiss("stiffness", path), 2, "found joints")
    expect(gneiss("plan", path, "--error", "5%"), 2, "no plan: the errors of joints are not known")
    run(path, os.path.join(folder, "jointed"))
    later = packed(None)
    later["specimen"] = {"from": "jointed"}
    expect(gneiss("check", write_scene(folder, later, "later.yaml")), 2, "expected a run without joints")


@fact
def keys_of_joints_without_effect_are_noted(folder):
    stiff = {"normal_stiffness": 1e11, "shear_stiffness": 1e11, "friction": 0.5}
    cases = [({"dip": "10 deg", "dip_direction": "20 deg"}, "dip_direction"), ({"bond_friction": 0.7}, "bond_friction"),
             ({"dilation_end": 1e-4}, "dilation_end")]
    idle = r"joints\[0\]\.{}: it changes nothing here"
    for keys, key in cases:
        scene = packed({**stiff, **keys})
        if "dip" in keys:
            del scene["joints"][0]["normal"]
        done = gneiss("check", write_scene(folder, scene))
        assert done.returncode == 0 and re.search(idle.format(key), done.stderr), done.stderr
    done = gneiss("check", write_scene(folder, packed({**stiff, "cohesion": 1e6, "bond_friction": 0.7, "dilation": 0.1,
                                                       "dilation_end": 1e-4})))
    assert done.returncode == 0 and "changes nothing" not in done.stderr, done.stderr


if __name__ == "__main__":
    sys.exit(main())
