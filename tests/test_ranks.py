"""Several ranks of MPI compute the bits of one process. Speaks TAP. The second argument is gneiss-mpi. The ranks share what cores there are."""
import signal

from program import *  # noqa: F403

RANKS = os.path.abspath(sys.argv[2])
QUIET = ("--quiet", "--threads", 1)
# The keys of Open MPI for more ranks than cores, and for root; another MPI ignores them.
OVERSUBSCRIBED = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                  "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

GRAIN = {"name": "grain", "density": 1, "normal_stiffness": 20000, "kratio": 3.5, "friction": 0.5}
SHORT = {"history_rows": 10, "snapshots": 2, "checkpoint": "off"}
# Bonds that break between platens, one of which drives a set of particles.
ROCK = ("--set", "specimen.lattice.cells=[8, 8, 9]", "--set", "walls.top.point=[0, 0, 18 mm]", "--set", "time.end=0.3 ms")
FLOW = {"dimension": 3, "specimen": {"lattice": {"kind": "fcc", "radius": 0.5, "cells": [8, 5, 5], "spacing": 1.02, "jitter": 0.02}},
        "materials": [GRAIN], "law": {"stiffness": "uniform"}, "damping": {"contact": {"restitution": 0.6}}, "gravity": [0.574, 0, -0.819],
        "initial": {"random_velocity": 0.5}, "sets": [{"name": "all", "select": {"all": True}, "initial_velocity": [4, 0, 0]}],
        "periodic": {"min": [0, 0, -1], "max": [11.54, 7.22, 60]},
        "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "stiffness": 20000, "kratio": 3.5, "friction": 0.5}],
        "time": {"step": 1e-4, "end": 0.06, "estimate": "bound", "on_unstable": "warn"}, "output": SHORT}
BOX = {"dimension": 3, "specimen": {"lattice": {"kind": "fcc", "radius": 0.5, "cells": [5, 5, 5], "spacing": 0.99}}, "materials": [GRAIN],
       "law": {"stiffness": "uniform"}, "initial": {"random_velocity": 0.5}, "damping": {"contact": {"fraction": 0.2}},
       "periodic": {"min": [0, 0, 0], "max": [7.0, 7.0, 7.0]}, "time": {"end": 0.1}, "output": SHORT}
# Grains that fall on a body, in stages; then a lid with a servo presses them. Most lists are made between two rows.
PRESS = {"dimension": 3, "specimen": {"lattice": {"kind": "fcc", "radius": "1 mm", "cells": [6, 6, 4], "spacing": 1.02, "jitter": 0.02}},
         "materials": [{"name": "sand", "density": 2500, "normal_stiffness": "20 kN/m", "kratio": 2, "friction": 0.3}],
         "law": {"stiffness": "uniform"}, "damping": {"contact": {"restitution": 0.5}}, "gravity": [0, 0, -9.81],
         "periodic": {"min": [0, 0, -0.01], "max": ["18 mm", "18 mm", 0.05]},
         "walls": [{"name": "floor", "point": [0, 0, "-1 mm"], "normal": [0, 0, 1], "stiffness": "20 kN/m", "kratio": 2, "friction": 0.4},
                   {"name": "lid", "point": [0, 0, "12 mm"], "normal": [0, 0, -1], "stiffness": "20 kN/m"}],
         "time": {"end": "30 ms"}, "output": SHORT,
         "stages": [{"name": "fall", "end": {"time": "10 ms"}},
                    {"name": "press", "walls": {"lid": {"servo": {"force": "5 N", "max_velocity": 0.5}}}, "end": {"time": "20 ms"}}]}
BODIES = {**{key: value for key, value in PRESS.items() if key not in ("stages", "periodic")}, "time": {"end": "10 ms"}, "walls": PRESS["walls"][:1],
          "bodies": [{"name": "block", "box": {"size": ["16 mm", "16 mm", "8 mm"]}, "origin": ["1 mm", "1 mm", "12 mm"], "stiffness": "20 kN/m",
                      "kratio": 2, "friction": 0.4, "free": True, "density": 1500}]}
DISCS = {"dimension": 2, "specimen": {"lattice": {"kind": "hexagonal", "radius": "1 mm", "cells": [16, 24], "jitter": 0.05}},
         "materials": [{"name": "rock", "density": 2000, "normal_stiffness": 1e7, "kratio": 2, "friction": 0.4, "bond_tension_limit": 20,
                        "bond_shear_limit": 50}],
         "law": {"stiffness": "uniform"}, "bonds": {"interaction_range": 0.1, "radius_multiplier": 0.5},
         "damping": {"background": {"model": "nonviscous_component", "coefficient": 0.3}},
         "sets": [{"name": "foot", "select": {"end": {"axis": "y", "side": "lower", "depth": "1.5 mm"}}, "motion": {"vx": 0, "vy": 0}}],
         "walls": [{"name": "top", "point": [0, "82 mm"], "normal": [0, -1], "stiffness": 1e7, "motion": {"vy": -2}}],
         "time": {"end": "0.4 ms"}, "output": SHORT}


def on_ranks(count, *arguments, **options):
    return subprocess.run(["mpirun", "-n", str(count), RANKS, *map(str, arguments)], capture_output=True, text=True, errors="replace",
                          env={**ENVIRONMENT, **OVERSUBSCRIBED}, timeout=120, **options)


def check_ranks(folder, scene, *arguments, counts=(2, 3)):
    """Ranks, the last count with two threads each, against one process."""
    alone = os.path.join(folder, "alone")
    run(scene, alone, "--threads", 1, *arguments)
    for count in counts:
        out, threads = os.path.join(folder, str(count)), 2 if count == counts[-1] else 1
        expect(on_ranks(count, "run", scene, "--out", out, "--quiet", "--threads", threads, *arguments), 0)
        check_same(out, alone)
        check_tables(out, alone)
        assert series(out) == series(alone)


def check_tables(folder, reference):
    with results(folder) as a, results(reference) as b:
        for group in ("events", "particles", "bonds", "contacts"):
            assert (group in a) == (group in b)
            for name in a[group] if group in a else ():
                assert a[group][name][()].tobytes() == b[group][name][()].tobytes(), f"{group}/{name} differs"


@fact
def bonds_that_break_do_so_alike(folder):
    check_ranks(folder, LATTICE, *ROCK)
    with results(os.path.join(folder, "2")) as file:
        assert len(file["events/step"]) > 20


@fact
def grains_that_flow_along_a_wall_do_so_alike(folder):
    check_ranks(folder, write_scene(folder, FLOW))
    assert summary(os.path.join(folder, "2"))["list_rebuilds"] > 3


@fact
def a_periodic_box_has_the_same_bits(folder):
    check_ranks(folder, write_scene(folder, BOX), counts=(3,))


@fact
def discs_with_moments_in_bonds_have_the_same_bits(folder):
    check_ranks(folder, write_scene(folder, DISCS), counts=(2,))


@fact
def a_servo_in_a_later_stage_has_the_same_bits(folder):
    check_ranks(folder, write_scene(folder, PRESS), counts=(3,))


@fact
def a_rigid_body_on_grains_has_the_same_bits(folder):
    check_ranks(folder, write_scene(folder, BODIES), counts=(3,))
    with results(os.path.join(folder, "3")) as file:
        assert any(np.any(data[()] != 0) for name, data in file["history"].items() if name.startswith("body_block_force"))


@fact
def mixed_precision_has_the_same_bits(folder):
    check_ranks(folder, LATTICE, *ROCK, "--set", "run.precision=mixed", counts=(2,))


@fact
def more_ranks_than_blocks_of_particles_work(folder):
    check_ranks(folder, LATTICE, "--set", "time.end=0.1 ms", counts=(4,))


@fact
def without_mpirun_it_is_one_process(folder):
    run(LATTICE, os.path.join(folder, "a"), "--threads", 1)
    done = subprocess.run([RANKS, "run", LATTICE, "--out", os.path.join(folder, "b"), "--quiet", "--threads", "1"], capture_output=True, text=True,
                          env={**ENVIRONMENT, **OVERSUBSCRIBED}, timeout=120)
    expect(done, 0)
    check_same(os.path.join(folder, "b"), os.path.join(folder, "a"))


@fact
def a_run_continues_on_another_number_of_ranks_and_without_mpi(folder):
    scene = write_scene(folder, FLOW)
    run(scene, os.path.join(folder, "whole"), "--threads", 1)
    for first, second in ((2, 3), (3, None), (None, 2)):
        out = os.path.join(folder, f"{first}-{second}")
        begin = ("run", scene, "--out", out, *QUIET, "--set", "time.end=0.03")
        go_on = ("resume", out, *QUIET, "--set", "time.end=0.06")
        expect(on_ranks(first, *begin) if first else gneiss(*begin), 0)
        expect(on_ranks(second, *go_on) if second else gneiss(*go_on), 0)
        assert state_hash(out) == state_hash(os.path.join(folder, "whole"))


def started(count, folder, *arguments):
    """mpirun with its ranks, once a checkpoint is there."""
    process = subprocess.Popen(["mpirun", "-n", str(count), RANKS, "run", LATTICE, "--out", folder, *map(str, QUIET + ROCK + arguments)],
                               stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env={**ENVIRONMENT, **OVERSUBSCRIBED})
    assert wait_until(process, lambda: os.path.isdir(folder) and checkpoints(folder)), process.stderr.read()
    with open(f"/proc/{process.pid}/task/{process.pid}/children") as file:
        return process, [int(pid) for pid in file.read().split()]


@fact
def a_killed_rank_ends_all_and_the_checkpoint_is_whole(folder):
    out, whole = os.path.join(folder, "killed"), os.path.join(folder, "whole")
    process, ranks = started(2, out, "--set", "output.checkpoint=1 ms")
    os.kill(ranks[-1], signal.SIGKILL)
    _, said = process.communicate(timeout=60)
    assert process.returncode != 0 and "Killed" in said, said
    end = time.monotonic() + 20
    while any(os.path.exists(f"/proc/{rank}") for rank in ranks):
        assert time.monotonic() < end, "a rank lives on"
        time.sleep(0.01)
    resume(out, "--threads", 1)
    run(LATTICE, whole, "--threads", 1, *ROCK)
    check_same(out, whole)


@fact
def a_signal_to_one_rank_saves_the_run_of_all(folder):
    out = os.path.join(folder, "stopped")
    process, ranks = started(2, out, "--set", "output.checkpoint=1 ms")
    os.kill(ranks[-1], signal.SIGTERM)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 6 and said.count("continue with: gneiss resume") == 1, said
    assert checkpoints(out)


@fact
def a_run_that_goes_bad_says_so_once(folder):
    done = on_ranks(2, "run", LATTICE, "--out", folder, *QUIET, *ROCK, "--set", "time.step=1e-4", "--set", "time.on_unstable=warn")
    expect(done, 5, r"unstable run: step \d+")
    assert done.stderr.count("unstable run") == 1
    assert os.path.exists(os.path.join(folder, "results.h5"))


@fact
def what_ranks_cannot_do_is_refused_with_its_place(folder):
    moving = write_scene(folder, {**FLOW, "walls": [], "periodic": {**FLOW["periodic"], "x": {"rate": 0.1}}})
    for scene, option, words in ((moving, (), r"scene.yaml:1:\d+: periodic.*: expected .*, found periodic boxes that move"),
                                 (os.path.join(SCENES, "elements.yaml"), (), r"elements.yaml:\d+:1: elements: expected .*, found finite elements"),
                                 (LATTICE, ("--set", "time.start=first_break", "--set", "walls.top.motion.vz=-2"), "--set time.start: expected .*, found starts at the first break")):
        expect(on_ranks(2, "run", scene, "--out", os.path.join(folder, "out"), *QUIET, *option), 2, words)
    expect(on_ranks(2, "check", LATTICE), 2, "found gneiss check")


if __name__ == "__main__":
    sys.exit(main())
