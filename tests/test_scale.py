"""Files whose lengths are read as metres and are probably millimetres. Speaks TAP."""
from program import *  # noqa: F403

SIDES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def box_file(folder, name, *size):
    corners = [[(k >> a & 1) * size[a] for a in range(3)] for k in range(8)]
    with open(os.path.join(folder, name), "w") as file:
        file.write("solid s\n")
        for a, b, c, d in SIDES:
            for triangle in ((a, b, c), (a, c, d)):
                file.write("facet normal 0 0 0\nouter loop\n")
                file.writelines("vertex %g %g %g\n" % tuple(corners[k]) for k in triangle)
                file.write("endloop\nendfacet\n")
        file.write("endsolid s\n")


def core(folder, size=100, speed=0.05, end=0.01, depth=10, density=2500, **more):
    """A block of half the usual height, loaded between its ends."""
    box_file(folder, "core.stl", size / 2, size / 2, size)
    ends = [{"name": side, "select": {"end": {"axis": "z", "side": side, "depth": depth}}, "motion": {"vz": v}}
            for side, v in (("lower", 0), ("upper", -speed))]
    return {"dimension": 3, "specimen": {"surface": "core.stl", "particles": 60, **more.pop("specimen", {})},
            "materials": [{"name": "m", "density": density, "contact_modulus": 1e10, "kratio": 2, "tensile_strength": 1e7,
                           "shear_strength": 1e7}],
            "law": {"stiffness": "arithmetic"}, "bonds": {}, "sets": ends, "time": {"end": end},
            "output": {"snapshots": 0, "history_rows": 5}, "run": {"threads": 1}, **more}


def check(folder, scene, word="check", *options):
    return expect(gneiss(word, write_scene(folder, scene), *options, environment={"GNEISS_CACHE": os.path.join(folder, "cache")}), 0)


@fact
def a_core_in_millimetres_without_a_scale_is_warned_of(folder):
    words = r"warning: .*scene\.yaml:1:\d+: specimen\.surface: 100 m long, particles from [\d.]+ m in diameter on, without a scale.*" \
            r"a path of 0\.0005 m, 5e-06 of that, in the 0\.01 s.*scale: 0\.001"
    done = check(folder, core(folder))
    assert re.search(words, done.stdout) and "see the warnings" in done.stdout, done.stdout
    done = check(folder, core(folder), "run", "--out", os.path.join(folder, "out"), "--quiet")
    assert re.search(words, done.stderr), done.stderr


@fact
def consistent_sizes_are_not_warned_of(folder):
    millimetres = core(folder, depth=0.01, specimen={"scale": 0.001})
    fast = core(folder, speed=0.5, end=10)  # 5 m in 10 s
    other_units = core(folder, density=2.5e-9)  # t/mm3: lengths in mm, speeds in mm/s
    for scene in (millimetres, fast, other_units):
        assert "without a scale" not in check(folder, scene).stdout
    small = core(folder, size=1, depth=0.1)
    assert "without a scale" not in check(folder, small).stdout


@fact
def a_run_too_short_for_a_wave_or_a_fall_is_warned_of(folder):
    assert re.search(r"0\.01 s of the run are [\d.]+ steps, and a wave needs", check(folder, core(folder, speed=50)).stdout)
    loose = core(folder, end=0.1, sets=[], gravity=[0, 0, -9.81])
    del loose["bonds"]
    assert "gravity moves it by no more than 0.049 m" in check(folder, loose).stdout


@fact
def a_test_of_a_large_file_is_warned_of(folder):
    test = {"kind": "compression", "axis": "z", "lower": "lower", "upper": "upper"}
    assert "it is tested as in a laboratory" in check(folder, core(folder, speed=50, end=1, test=test)).stdout


@fact
def a_test_of_a_file_of_four_metres_is_warned_of_unless_it_is_bending(folder):
    test = {"kind": "compression", "axis": "z", "lower": "lower", "upper": "upper"}
    tested = core(folder, size=4, speed=50, end=1, depth=0.5, test=test)
    assert re.search(r"specimen\.surface: 4\.?\d* m long.*it is tested as in a laboratory", check(folder, tested).stdout)
    test.update(kind="bending", span=1, height=2)
    assert "without a scale" not in check(folder, tested).stdout


@fact
def a_given_scale_of_one_needs_no_warning(folder):
    test = {"kind": "compression", "axis": "z", "lower": "lower", "upper": "upper"}
    for scene in (core(folder), core(folder, size=40, speed=50, end=1, test=test)):  # the second scene is a pillar
        assert "without a scale" in check(folder, scene).stdout
        scene["specimen"]["scale"] = 1
        assert "without a scale" not in check(folder, scene).stdout
        del scene["specimen"]["scale"]
        assert "without a scale" not in check(folder, scene, "check", "--set", "specimen.scale=1").stdout
    # The stored scene of a run has the given value.
    out = os.path.join(folder, "out")
    check(folder, core(folder), "run", "--out", out, "--quiet")
    with h5py.File(os.path.join(out, "results.h5")) as file:
        kept = file["scene"][()]
    assert "  scale:" not in (kept.decode() if isinstance(kept, bytes) else str(kept))


@fact
def errors_that_may_follow_from_millimetres_name_the_size(folder):
    """Ends, sets and radii in metres do not fit a body whose millimetres are read as metres."""
    test = {"kind": "compression", "axis": "z", "lower": "lower", "upper": "upper"}
    said = r"specimen\.surface is 100 m long without a scale: with scale: 0\.001 its lengths are millimetres"
    walls = [{"name": name, "point": [0, 0, z], "normal": [0, 0, n], "stiffness": 1e8, "motion": {"vz": v}}
             for name, z, n, v in (("lower", 0, 1, 0), ("upper", 0.1, -1, -0.05))]
    for scene in (core(folder, depth=0.01), core(folder, test=test, sets=[], walls=walls)):
        expect(gneiss("check", write_scene(folder, scene), environment={"GNEISS_CACHE": "off"}), 2, said)
        scene["specimen"]["scale"] = 0.001
        assert "without a scale" not in check(folder, scene).stdout
    scene = core(folder, depth=0.01)
    scene["specimen"] = {"surface": "core.stl", "mean_radius": 5e-3}
    expect(gneiss("check", write_scene(folder, scene)), 4, r"need about \S+ GB.* \(without a scale the lengths of the file count as metres; scale: 0\.001 if")
    scene["specimen"]["scale"] = 0.001
    check(folder, scene)


@fact
def sizes_of_packings_and_of_particles_of_files_are_warned_of(folder):
    done = check(folder, core(folder), "pack", "--out", os.path.join(folder, "p"))
    assert re.search(r"note: specimen\.surface: [\d.]+ m long with lengths of the file taken as metres", done.stdout), done.stdout
    scene = core(folder)
    scene["specimen"] = {"from": "p"}
    assert re.search(r"specimen\.from: 100 m long.*pack it with scale: 0\.001", check(folder, scene).stdout)
    scene["specimen"] = {"file": "p/packing.txt"}
    assert re.search(r"specimen\.file: 100 m long.*; scale: 0\.001", check(folder, scene).stdout)


@fact
def the_sizes_of_a_mesh_of_elements_and_a_tool_are_warned_of(folder):
    with open(os.path.join(folder, "m.msh"), "w") as file:
        file.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 50 0 0\n3 50 100 0\n4 0 100 0\n$EndNodes\n"
                   "$Elements\n2\n1 2 2 0 1 1 2 3\n2 2 2 0 1 1 3 4\n$EndElements\n")
    motion = {"name": "top", "box": {"min": [0, 100], "max": [50, 100]}, "motion": {"vy": -0.01}}
    scene = {"dimension": 2, "elements": {"mesh": "m.msh", "materials": [{"young": 1e10, "poisson": 0.2, "density": 2500}],
                                          "motions": [motion]}, "time": {"end": 0.01}, "output": {"snapshots": 0}}
    assert re.search(r"elements\.mesh: 100 m long, elements down to [\d.]+ m high", check(folder, scene).stdout)
    box_file(folder, "tool.stl", 300, 300, 20)
    grain = {"dimension": 3, "specimen": {"particles": [[0.1, 0.1, 0.5, 0.01], [0.1, 0.2, 0.5, 0.01]]},
             "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e6, "kratio": 2}],
             "law": {"stiffness": "uniform"}, "time": {"end": 0.01}, "gravity": [0, 0, -9.81], "output": {"snapshots": 0},
             "bodies": [{"name": "tool", "surface": "tool.stl", "origin": [0, 0, -20.1], "stiffness": 1e6}]}
    assert re.search(r"bodies\[0\]\.surface: 300 m long, without a scale.*the specimen is 0\.12 m long", check(folder, grain).stdout)
    box_file(folder, "tool.stl", 4, 4, 2)
    grain["specimen"] = {"particles": [[0.01, 0.01, 0.5, 0.01], [0.03, 0.01, 0.5, 0.01]]}
    assert re.search(r"bodies\[0\]\.surface: 4 m long, without a scale.*the specimen is 0\.04 m long", check(folder, grain).stdout)
    grain["bodies"][0]["scale"] = 1
    assert "without a scale" not in check(folder, grain).stdout


if __name__ == "__main__":
    sys.exit(main())
