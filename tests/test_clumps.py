"""Clumps in the program: files, checkpoints, precision, outputs, removal, messages. Speaks TAP."""
from program import *  # noqa: F403

SCENE = """dimension: 3
clumps:
  shapes:
    - {{name: a, spheres: [[0, 0, 0, 2 mm], [2.4 mm, 0, 0, 1.6 mm], [0, 1.8 mm, 0.8 mm, 1.4 mm]]}}
    - {{name: b, spheres: [[0, 0, 0, 2 mm], [2.6 mm, 0, 0, 2 mm]]}}
{clumps}
materials: [{{name: m, density: 2500, young: 5 MPa, poisson: 0.25, friction: 0.4, restitution: 0.5}}]
law: {{stiffness: hertz}}
gravity: [0, 0, -9.81]
walls: [{{name: floor, point: [0, 0, 0], normal: [0, 0, 1], friction: 0.4}}]
domain: {{min: [-0.1, -0.1, -0.01], max: [0.1, 0.1, 0.3], lost: remove}}
time: {{end: {end}}}
output: {{history_rows: 20, snapshots: 2, orientation: on}}
"""
CLOUD = "  filled: [{shapes: [a, b], box: {min: [-12 mm, -12 mm, 1 mm], max: [12 mm, 12 mm, 60 mm]}, count: 60}]"


def scene(folder, clumps=CLOUD, end="0.06 s", name="s.yaml"):
    path = os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(SCENE.format(clumps=clumps, end=end))
    return path


def state(folder):
    return summary(folder)["state_hash"]


def fields(folder, *names):
    with h5py.File(os.path.join(folder, "results.h5")) as file:
        return [file[f"particles/{name}"][()] for name in names]


@fact
def a_resumed_run_has_the_same_bits(folder):
    path, whole, part = scene(folder), os.path.join(folder, "whole"), os.path.join(folder, "part")
    run(path, whole, "--threads", "2")
    run(path, part, "--threads", "1", "--set", "time.end=0.045 s")
    resume(part, "--threads", "2", "--set", "time.end=0.06 s")
    assert state(part) == state(whole)


@fact
def clumps_of_a_file_are_those_of_the_list(folder):
    with open(os.path.join(folder, "clumps.txt"), "w") as file:
        file.write("# name, centre, quaternion, velocity, spin\n"
                   "a 0 0 0.01\n"
                   "b 0.01, 0, 0.02, 0.70710678118654757, 0, 0.70710678118654757, 0\n"
                   "b -0.01 0 0.02 1 0 0 0 0.1 0 0 0 0 5\n")
    listed = ("  placed: [{shape: a, centre: [0, 0, 0.01]}, {shape: b, centre: [0.01, 0, 0.02], rotation: [0, 1.5707963267948966, 0]}, "
              "{shape: b, centre: [-0.01, 0, 0.02], velocity: [0.1, 0, 0], spin: [0, 0, 5]}]")
    found = []
    for k, clumps in enumerate(("  file: clumps.txt", listed)):
        out = os.path.join(folder, f"out{k}")
        run(scene(folder, clumps, "5 ms", f"{k}.yaml"), out)
        found.append(fields(out, "position", "velocity", "mass", "clump"))
    for a, b in zip(*found):
        assert np.allclose(a, b, rtol=1e-9, atol=1e-12)
    assert found[0][3].reshape(-1).tolist() == [0, 0, 0, 1, 1, 2, 2]


@fact
def mixed_precision_stays_close(folder):
    place = []
    for precision in ("double", "mixed"):
        out = os.path.join(folder, precision)
        run(scene(folder, end="0.02 s"), out, "--precision", precision)
        place += fields(out, "position")
    assert np.abs(place[0] - place[1]).max() < 2e-6


@fact
def members_keep_their_distances_and_share_a_rotation(folder):
    out = os.path.join(folder, "out")
    run(scene(folder), out)
    place, clump, turn = fields(out, "position", "clump", "orientation")
    clump = clump.reshape(-1)
    for c in np.unique(clump):
        own = np.flatnonzero(clump == c)
        apart = np.linalg.norm(place[own[0]] - place[own[1]])
        assert min(abs(apart - 2.4e-3), abs(apart - 2.6e-3)) < 1e-12, apart
        assert np.ptp(turn[own], axis=0).max() == 0
    assert abs(summary(out)["energy_residual"]) < 0.01
    names = [name for name in os.listdir(out) if name.endswith(".hdf")]
    with h5py.File(os.path.join(out, sorted(names)[-1])) as file:
        assert sorted(set(file["VTKHDF/PointData/clump"][()].reshape(-1).tolist())) == list(range(60))


@fact
def a_clump_leaves_the_domain_as_a_whole(folder):
    out = os.path.join(folder, "out")
    run(scene(folder, "  placed: [{shape: a, centre: [0.09, 0, 0.05], velocity: [2, 0, 0], spin: [3, 4, 5]}, {shape: b, centre: [0, 0, 0.01]}]",
              "0.03 s"), out)
    removed, clump = fields(out, "removed", "clump")
    assert removed.reshape(-1).tolist() == [1, 1, 1, 0, 0]
    assert abs(summary(out)["energy_residual"]) < 1e-3


@fact
def a_free_body_of_spheres_has_the_mass_of_the_union(folder):
    out = os.path.join(folder, "out")
    run(scene(folder, "  placed: [{shape: b, centre: [0, 0, 0.05]}]", "1 ms"), out)
    (mass,) = fields(out, "mass")
    r, d = 2e-3, 2.6e-3
    union = 8 / 3 * np.pi * r**3 - np.pi / 12 * (4 * r + d) * (2 * r - d)**2
    assert abs(mass.sum() / (2500 * union) - 1) < 1e-10


ALL = """dimension: 3
specimen:
  lattice: {kind: cubic, radius: 2 mm, cells: [6, 6, 3], origin: [-12 mm, -12 mm, 0]}
  group: 1
clumps:
  shapes:
    - {name: a, spheres: [[0, 0, 0, 2 mm], [2.4 mm, 0, 0, 1.6 mm], [0, 1.8 mm, 0.8 mm, 1.4 mm]]}
    - {name: one, spheres: [[1, 0, 0, 2 mm]]}
  filled:
    - {shapes: [a, one], box: {min: [-12 mm, -12 mm, 13 mm], max: [12 mm, 12 mm, 40 mm]}, count: 30}
materials:
  - {name: m, density: 2500, contact_modulus: 5 MPa, kratio: 2, friction: 0.4, tensile_strength: 20 kPa, shear_strength: 20 kPa}
law: {stiffness: arithmetic}
bonds: {interaction_range: 0.01}
gravity: [0, 0, -9.81]
damping: {contact: {restitution: 0.6}, background: {model: nonviscous_component, coefficient: 0.05}}
sources: [{name: s, box: {size: [20 mm, 20 mm, 5 mm]}, origin: [-10 mm, -10 mm, 45 mm], rate: 500, total: 20, mean_radius: 1.5 mm}]
bodies:
  - {name: b, box: {size: [6 mm, 6 mm, 6 mm]}, origin: [-3 mm, -3 mm, 55 mm], stiffness: 1e5, free: true, density: 8000}
walls:
  - {name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5, kratio: 2, friction: 0.4}
  - {name: w1, point: [-13 mm, 0, 0], normal: [1, 0, 0], stiffness: 1e5}
  - {name: w2, point: [13 mm, 0, 0], normal: [-1, 0, 0], stiffness: 1e5}
  - {name: w3, point: [0, -13 mm, 0], normal: [0, 1, 0], stiffness: 1e5}
  - {name: w4, point: [0, 13 mm, 0], normal: [0, -1, 0], stiffness: 1e5}
domain: {min: [-0.1, -0.1, -0.01], max: [0.1, 0.1, 0.3], lost: remove}
stages: [{name: down, end: {time: 0.02}}, {name: aslant, gravity: [1, 0, -9.81], end: {time: 0.02}}]
time: {end: 0.05}
output: {history_rows: 50, snapshots: 2}
"""


@fact
def beside_bonds_sources_bodies_and_stages_the_ledger_closes(folder):
    path, whole, part = (os.path.join(folder, name) for name in ("all.yaml", "whole", "part"))
    with open(path, "w") as file:
        file.write(ALL)
    run(path, whole, "--threads", "1")
    assert abs(summary(whole)["energy_residual"]) < 1e-3
    run(path, part, "--threads", "2", "--set", "time.end=0.045")
    resume(part, "--threads", "1", "--set", "time.end=0.05")
    assert state(part) == state(whole)


@fact
def bad_files_are_named_by_line(folder):
    for text, words in (("a 0 0\n", "clumps.txt:1:1: expected a name and 3, 7, 10 or 13"),
                        ("# none\n", "expected rows of clumps, found none"),
                        ("\nz 0 0 0\n", "clumps.txt:2:1: expected the name of a shape of clumps, found 'z'"),
                        ("a 0 0 0 2 0 0 0\n", "clumps.txt:1:1: expected a unit quaternion, found one of length 2"),
                        ("a 0 0 nan\n", "clumps.txt:1:1: expected a name and")):
        with open(os.path.join(folder, "clumps.txt"), "w") as file:
            file.write(text)
        done = gneiss("run", scene(folder, "  file: clumps.txt"), "--quiet", "--out", os.path.join(folder, "none"))
        assert done.returncode == 2 and words in done.stderr, done.stderr
        assert not os.path.exists(os.path.join(folder, "none", "results.h5"))


@fact
def a_surface_without_room_is_refused_with_its_place(folder):
    with open(os.path.join(folder, "t.stl"), "w") as file:
        x = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        file.write("solid t\n" + "".join(
            "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % x[c] for c in f) + "endloop\nendfacet\n"
            for f in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))) + "endsolid t\n")
    path = scene(folder, "    - {name: c, surface: t.stl, scale: 0.01, spheres: 9999}\n  placed: [{shape: c, centre: [0, 0, 0.02]}]")
    done = gneiss("check", path)
    assert done.returncode == 2 and "s.yaml:6:7: clumps.shapes[2] (c): expected at most" in done.stderr, done.stderr
    expect(gneiss("check", path, "--set", "clumps.shapes.c.spheres=12"), 0)


def refused(folder, clumps, words, more=()):
    done = gneiss("run", scene(folder, clumps), "--quiet", "--out", os.path.join(folder, "none"), *more)
    assert done.returncode == 2 and words in done.stderr, done.stderr


@fact
def faults_of_shapes_and_places_are_named_with_their_lines(folder):
    one = "  placed: [{shape: b, centre: [0, 0, 0.05]}"
    refused(folder, f"    - {{name: c, spheres: [[0, 0, 0, 2 mm], [0, 0, 0, 1 mm]]}}\n{one}]",
            "s.yaml:6:26: clumps.shapes[2].spheres: expected distinct centres, found rows 0 and 1")
    refused(folder, one + ", {shape: b, centre: [0, 0, 0.05]}]", "s.yaml:6:46: clumps.placed[1]: expected distinct centres, found clump 1")
    refused(folder, "  filled: [{shapes: [a], box: {min: [0, 0, 0.01], max: [2 mm, 2 mm, 0.02]}, count: 3}]",
            "s.yaml:6:12: clumps.filled[0].box: expected a box with room for a clump, found none in 2000 random places")
    refused(folder, one + "]\njoints: [{name: j, point: [0, 0, 0], normal: [0, 0, 1]}]", "clumps: expected a scene without joints")
    path = scene(folder, one + "]")
    with open(path) as file:
        text = file.read().replace("materials: [", "materials: [{name: n, density: 2000, young: 5 MPa, poisson: 0.25, restitution: 0.5}, ")
    with open(path, "w") as file:
        file.write(text)
    done = gneiss("check", path)
    assert done.returncode == 2 and "clumps.shapes[0].material: required beside several materials, but not given" in done.stderr, done.stderr


@fact
def clumps_that_overlap_at_the_start_are_warned_of(folder):
    for height, warned in ((0.051, True), (0.06, False)):
        path = scene(folder, f"  placed: [{{shape: b, centre: [0, 0, 0.05], velocity: [0, 0, -1]}}, {{shape: b, centre: [0, 0, {height}]}}]", "1 us")
        done = gneiss("run", path, "--out", os.path.join(folder, f"{warned}"))
        assert ("warning: clumps or particles overlap each other" in done.stderr) == warned, done.stderr
        shown = gneiss("check", path).stdout
        assert ("porosity         none" in shown) == warned, shown


@fact
def a_clump_longer_than_half_of_a_periodic_box_is_refused(folder):
    path = scene(folder, "  placed: [{shape: b, centre: [0, 0, 0.05]}]", "1 ms")
    with open(path) as file:
        text = re.sub("domain: .*", "periodic: {min: [-6.4 mm, -6.7 mm, 0], max: [6.4 mm, 6.7 mm, 0.2]}", file.read())
    with open(path, "w") as file:
        file.write(re.sub("walls: .*|gravity: .*", "", text))
    done = gneiss("check", path)
    assert done.returncode == 2 and ("s.yaml:5:7: clumps.shapes[1] (b): expected a clump of at most half the length of the periodic box along x, "
                                     "which is 0.0064 m, found one of 0.0066 m") in done.stderr, done.stderr
    expect(gneiss("check", path, "--set", "periodic.min=[-6.7 mm, -6.7 mm, 0]", "--set", "periodic.max=[6.7 mm, 6.7 mm, 0.2]"), 0)


@fact
def a_shape_of_no_clump_is_noted(folder):
    done = gneiss("check", scene(folder, "  placed: [{shape: b, centre: [0, 0, 0.05]}]"))
    words = " ".join((done.stdout + done.stderr).split())
    assert "clumps.shapes[0].name" in words and "no clump has this shape" in words and "clumps.shapes[1].name" not in words, words


@fact
def other_programs_and_runs_do_not_lose_clumps_silently(folder):
    out, text = os.path.join(folder, "out"), os.path.join(folder, "from.yaml")
    run(scene(folder, CLOUD, "1 ms"), out)
    done = expect(gneiss("convert", out, os.path.join(folder, "p.csv")), 0)
    members = int((fields(out, "clump")[0] >= 0).sum())
    assert f"60 clumps (their {members} members" in done.stdout, done.stdout
    with open(text, "w") as file:
        file.write("specimen: {from: out, material: m}\nmaterials: [{name: m, density: 2500, young: 5 MPa, poisson: 0.25, restitution: 0.5}]\n"
                   "law: {stiffness: hertz}\ndomain: {min: [-1, -1, -1], max: [1, 1, 1]}\ntime: {end: 1 ms}\n")
    done = gneiss("check", text)
    assert done.returncode == 2 and "from.yaml:1:18: specimen.from: expected a run without clumps" in done.stderr, done.stderr
    assert f"found {members} members of clumps" in done.stderr, done.stderr


if __name__ == "__main__":
    sys.exit(main())
