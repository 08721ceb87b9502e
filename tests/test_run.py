"""Runs that are interrupted, killed, damaged or repeated, and their results. Speaks TAP. (More on equal bits: test_run_bits.py.)"""
import random
import signal

from run_reference import *  # noqa: F403


@fact
def the_small_specimen_breaks_under_load(folder):
    counts = summary(reference())["counts"]
    assert counts["broken_tension"] > 100 and counts["broken_shear"] > 100, counts


@plain_fact
def three_threads_give_the_same_bits_as_one(folder):
    same_with_threads(folder, 3)


@fact
def a_run_in_mixed_precision_resumes_to_the_same_bits(folder):
    straight, broken = os.path.join(folder, "straight"), os.path.join(folder, "broken")
    run(UCS, straight, "--precision", "mixed", "--threads", 2)
    assert summary(straight)["precision"] == "mixed" and abs(summary(straight)["energy_residual"]) < 1e-3
    expect(stop_at_snapshot(broken, 3, signal.SIGINT, "--precision", "mixed", "--threads", 1), 6)
    resume(broken, "--threads", 2)
    check_same(broken, straight)


@fact
def masses_that_followed_contacts_resume_to_the_same_bits(folder):
    raised = ("--set", "time.estimate=bound", "--set", "time.mass_scaling.factor=1.8", "--set", "time.stop.peak_drop=off")
    straight, broken = os.path.join(folder, "straight"), os.path.join(folder, "broken")
    run(UCS, straight, "--threads", 2, *raised)
    said, energy = summary(straight)["mass_scaling"], history(straight)["energy_step_change"]
    assert energy[0] == 0 and energy[-1] > 0  # masses have followed contacts
    assert summary(straight)["dt"] > 0.97 * said["dt_wanted"] and abs(summary(straight)["energy_residual"]) < 1e-3
    expect(stop_at_snapshot(broken, 3, signal.SIGINT, "--threads", 1, *raised), 6)
    resume(broken, "--threads", 2)
    check_same(broken, straight)


@fact
def masses_are_in_the_results_and_what_they_did_not_reach_is_a_warning(folder):
    far = {"specimen": {"particles": [[0, 0, 0, "1 mm"], ["9 mm", 0, 0, "1 mm"]]}, "law": {"stiffness": "uniform"},
           "materials": [{"name": "a", "density": 2000, "normal_stiffness": "1 MN/m", "kratio": 2}],
           "time": {"end": "0.1 ms", "mass_scaling": {"factor": 2}}}
    out = os.path.join(folder, "out")
    done = expect(gneiss("run", write_scene(folder, far), "--out", out, "--quiet"), 0)
    assert [w["name"] for w in summary(out)["warnings"]] == ["mass_scaling"] and "requests a step of" in done.stderr
    with results(out) as file:
        assert np.allclose(file["particles/mass"], 2000 * 4 / 3 * np.pi * 1e-9, rtol=1e-14)


@fact
def a_lost_terminal_writes_a_checkpoint(folder):
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup the signal would be ignored, also in the program
    expect(stop_at_snapshot(folder, 2, signal.SIGHUP), 6)
    assert len(checkpoints(folder)) == 1


@plain_fact
def resume_with_other_threads_gives_the_same_bits(folder):
    interrupted_and_resumed(folder, signal.SIGINT, "--threads", 3)


@plain_fact
def bound_threads_have_a_core_each(folder):
    if len(os.sched_getaffinity(0)) < 2:
        raise Skip("one core")
    environment = {**ENVIRONMENT, "OMP_PROC_BIND": "true"}
    for name in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT"):
        environment.pop(name, None)
    process = subprocess.Popen(command("run", UCS, "--threads", 2, "--quiet", "--out", os.path.join(folder, "run")), env=environment,
                               stdout=subprocess.DEVNULL)
    places = set()

    def bound():
        try:
            threads = [open(f"/proc/{process.pid}/task/{task}/status").read() for task in os.listdir(f"/proc/{process.pid}/task")]
        except OSError:
            return False
        places.update(re.search(r"Cpus_allowed_list:\s*(\S+)", text).group(1) for text in threads)
        return len(threads) > 1 and all("," not in place and "-" not in place for place in places) and len(places) > 1

    wait_until(process, bound)
    process.kill()
    process.wait()
    assert len({place for place in places if place.isdigit()}) > 1, f"threads on cores {places}"


@plain_fact
def killed_early_and_resumed_gives_the_same_bits(folder):
    killed_and_resumed(folder, 1)


@plain_fact
def killed_at_ten_random_moments_and_resumed_gives_the_same_bits(folder):
    pick = random.Random(20)
    process = start(folder, "--set", "output.checkpoint=5 ms", "--threads", "1")
    kills = 0
    while kills < 10:
        ready = wait_until(process, lambda: len(checkpoints(folder)) > 0)
        time.sleep(pick.uniform(0.0, 0.05))
        if not ready or process.poll() is not None:
            break
        process.kill()
        process.communicate()
        kills += 1
        process = subprocess.Popen(command("resume", folder, "--quiet"), env=ENVIRONMENT, stdout=subprocess.DEVNULL)
    assert process.wait(timeout=120) == 0
    assert kills >= 3, f"killed only {kills} times"
    check_same(folder, reference())
    assert series(folder) == series(reference())


@fact
def a_finished_run_resumes_to_nothing_new(folder):
    run(UCS, folder)
    resume(folder)
    check_same(folder, reference())


@fact
def a_run_ended_by_a_stop_condition_stays_ended(folder):
    run(UCS, folder, "--set", "time.stop.strain=0.2 %")
    before = summary(folder)
    resume(folder)
    after = summary(folder)
    assert before["steps"] == after["steps"] and before["state_hash"] == after["state_hash"]
    assert before["stop_reason"] == after["stop_reason"] == "strain reached 0.002", after["stop_reason"]


@plain_fact
def a_stop_condition_lifted_on_resume_equals_a_run_without_it(folder):
    run(UCS, folder, "--set", "time.stop.strain=0.2 %")
    resume(folder, "--set", "time.stop.strain=off")
    check_same(folder, reference())


@plain_fact
def a_later_end_on_resume_equals_a_straight_run(folder):
    run(UCS, folder, "--set", "time.end=0.1 ms", "--set", "output.history_rows=100")
    resume(folder, "--set", "time.end=0.3 ms")
    check_same(folder, reference())


@fact
def a_skin_below_the_path_of_a_step_is_widened_alike_after_resume_and_named(folder):
    scene = os.path.join(folder, "gas.yaml")
    with open(scene, "w") as file:
        file.write("dimension: 2\n"
                   "specimen: {lattice: {kind: hexagonal, radius: 1e-3, cells: [6, 5], spacing: 1.1}, group: 0}\n"
                   "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: 0.3}]\n"
                   "law: {stiffness: uniform}\ninitial: {random_velocity: 2}\ndomain: {min: [-1, -1], max: [1, 1]}\n"
                   "neighbours: {skin: 1e-9}\ntime: {end: 0.5 ms}\nrun: {threads: 1}\n")
    straight, parts = os.path.join(folder, "straight"), os.path.join(folder, "parts")
    run(scene, straight, "--set", "output.history_rows=50")
    run(scene, parts, "--set", "time.end=0.2 ms", "--set", "output.history_rows=50")
    resume(parts, "--set", "time.end=0.5 ms")
    assert state_hash(straight) == state_hash(parts)
    for where in (straight, parts):
        assert [w["name"] for w in summary(where)["warnings"]] == ["neighbours_skin", "contacts_too_deep"], summary(where)["warnings"]


@fact
def intervals_follow_the_overrides_of_resume(folder):
    run(LATTICE, folder, "--set", "time.end=0.2 ms", "--set", "output.history_rows=2")
    resume(folder, "--set", "time.end=0.4 ms", "--set", "output.history_rows=100")
    steps = history(folder)["step"]
    assert len(steps) > 40 and np.all(np.diff(steps) > 0), steps


@fact
def a_smaller_step_on_resume_takes_hold(folder):
    run(LATTICE, folder, "--set", "time.end=0.1 ms")
    dt = summary(folder)["dt"]
    resume(folder, "--set", "time.end=0.2 ms", "--set", f"time.step={dt / 4:g}")
    assert abs(summary(folder)["dt"] / dt - 0.25) < 1e-5, summary(folder)["dt"]
    expect(gneiss("resume", folder, "--set", "time.end=0.3 ms", "--set", "time.step=0.1 ms"), 2, "stability limit")


@fact
def resume_needs_neither_the_scene_nor_the_specimen_file(folder):
    text = open(UCS).read().replace("../../scenes/specimens/rock-b.txt", "rock.txt")
    shutil.copy(os.path.join(SCENES, "../../scenes/specimens/rock-b.txt"), os.path.join(folder, "rock.txt"))
    scene, out = write_scene(folder, text), os.path.join(folder, "out")
    run(scene, out, "--set", "time.end=0.1 ms", "--set", "output.history_rows=100")
    os.remove(scene)
    os.remove(os.path.join(folder, "rock.txt"))
    resume(out, "--set", "time.end=0.3 ms")
    check_same(out, reference())


@fact
def resume_takes_only_what_does_not_change_the_model(folder):
    run(LATTICE, folder)
    for key in ("materials.block.friction=0.1", "output.directory=x", "output.energy=off", "gravity=[0,0,1]", "run.precision=mixed",
                "time.mass_scaling.factor=2"):
        expect(gneiss("resume", folder, "--set", key), 2, re.escape(key.split("=")[0]))
    expect(gneiss("resume", folder, "--out", "elsewhere"), 2, "--out")
    expect(gneiss("resume", folder, "--set", "time.end=soon"), 2, "time.end")


def two_paths(folder):
    return [os.path.join(folder, name) for name in two_checkpoints(folder)]


def truncate(path):
    os.truncate(path, os.path.getsize(path) // 2)


@fact
def a_truncated_checkpoint_gives_way_to_the_older_one(folder):
    out, straight = os.path.join(folder, "out"), os.path.join(folder, "straight")
    older, newer = two_paths(out)
    truncate(newer)
    size = os.path.getsize(newer)
    done = gneiss("resume", out, "--set", "time.end=0.4 ms", "--quiet")
    expect(done, 0, "warning: .*" + os.path.basename(newer), "continuing from the checkpoint of step")
    assert not os.path.exists(newer), "a damaged checkpoint is still listed"
    assert os.path.getsize(newer + ".damaged") == size, "the damaged checkpoint was not kept"
    run(LATTICE, straight)
    assert state_hash(out) == state_hash(straight)


@fact
def two_truncated_checkpoints_are_an_error_and_stay_as_they_are(folder):
    paths = two_paths(folder)
    for path in paths:
        truncate(path)
    before = sorted((name, os.path.getsize(os.path.join(folder, name))) for name in os.listdir(folder))
    expect(gneiss("resume", folder), 2, "none of 2 checkpoints can be used", os.path.basename(paths[1]))
    assert before == sorted((name, os.path.getsize(os.path.join(folder, name))) for name in os.listdir(folder))


@fact
def resume_without_checkpoints_is_an_error(folder):
    expect(gneiss("resume", folder), 2, "checkpoint")
    expect(gneiss("resume", os.path.join(folder, "nowhere")), 2, "nowhere")


def flipped(path, data, pick):
    broken = bytearray(data)
    for _ in range(pick.choice((1, 1, 2, 16))):
        broken[pick.randrange(len(broken))] ^= 1 << pick.randrange(8)
    if pick.random() < 0.1:
        broken = broken[:pick.randrange(len(broken))]
    with open(path, "wb") as file:
        file.write(broken)


@fact
def damaged_checkpoints_are_refused_or_give_the_same_hash(folder):
    good, bad, straight = (os.path.join(folder, name) for name in ("good", "bad", "straight"))
    run(LATTICE, good, "--set", "time.end=0.2 ms")
    run(LATTICE, straight)
    name, wanted, pick = checkpoints(good)[0], state_hash(straight), random.Random(6)
    data = open(os.path.join(good, name), "rb").read()
    outcomes = {0: 0, 2: 0, 3: 0}
    for _ in range(60):
        shutil.rmtree(bad, ignore_errors=True)
        os.mkdir(bad)
        flipped(os.path.join(bad, name), data, pick)
        done = gneiss("resume", bad, "--quiet", "--set", "time.end=0.4 ms", timeout=30)
        assert done.returncode in outcomes, f"exit code {done.returncode}: {done.stderr}"
        if done.returncode == 0:
            assert state_hash(bad) == wanted, "a damaged checkpoint was taken for a good one"
        else:
            assert name in done.stderr, done.stderr
        outcomes[done.returncode] += 1
    assert outcomes[2] + outcomes[3] > 10, f"the damage was not noticed: {outcomes}"


@fact
def a_folder_takes_one_run_at_a_time(folder):
    process = start(folder)
    assert wait_until(process, lambda: snapshots(folder) > 0)
    expect(gneiss("run", UCS, "--out", folder), 2, "another run")
    expect(gneiss("resume", folder), 2, "another run")
    assert process.wait(timeout=60) == 0
    assert state_hash(folder) == state_hash(reference())


@fact
def an_output_folder_that_is_too_long_leaves_no_folders_behind(folder):
    # No file system of Linux takes a name of more than 255 bytes; the path as a whole is limited by gneiss.
    expect(gneiss("run", LATTICE, "--out", os.path.join(folder, "a", "b", 300 * "x"), "--quiet"), 3, "File name too long")
    deep = os.path.join(folder, *(["a" * 200] * 20))
    expect(gneiss("run", LATTICE, "--out", deep, "--quiet"), 2, "less than 4032 characters")
    assert not os.listdir(folder), os.listdir(folder)


@plain_fact
def snapshots_keep_their_pace_when_the_step_changes(folder):
    """A light grain hits two heavy ones in contact: from then on the step is a thirtieth of the former."""
    scene = f"{folder}.yaml"
    with open(scene, "w", encoding="utf-8") as file:
        file.write("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm], [1.999 mm, 0, 0, 1 mm], [25 mm, 0, 0, 0.1 mm]], group: 0}\n"
                   "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 1}]\nlaw: {stiffness: uniform}\n"
                   "sets: [{name: light, select: {ids: [2]}, initial_velocity: [-10, 0, 0]}]\n"
                   "time: {end: 8 ms}\noutput: {snapshots: 20, checkpoint: off}\n")
    run(scene, folder)
    times = np.array([time for _, time in series(folder)])
    assert 20 <= len(times) <= 23 and np.diff(times).max() < 1.1 * 0.4e-3, times


@fact
def a_run_of_the_same_scene_replaces_the_earlier_one(folder):
    run(LATTICE, folder, "--set", "output.snapshots=9")
    relative = os.path.relpath(LATTICE)
    run(relative, folder, "--set", "output.snapshots=2", "--set", "time.end=0.1 ms")
    with results(folder) as file:
        assert file["history/time"][-1] < 0.1001e-3
    times = [time for _, time in series(folder)]
    assert len(times) == 3 or len(times) == 4, f"snapshots of the earlier run are left: {times}"
    assert len(checkpoints(folder)) == 1


@fact
def results_of_another_scene_are_not_overwritten(folder):
    run(LATTICE, folder)
    before = {name: open(os.path.join(folder, name), "rb").read() for name in os.listdir(folder)}
    expect(gneiss("run", UCS, "--out", folder), 2, "lattice-small.yaml", "ucs-small.yaml", "--out")
    assert before == {name: open(os.path.join(folder, name), "rb").read() for name in os.listdir(folder)}


@fact
def foreign_files_are_replaced_only_by_force(folder):
    names = ("summary.json", "report.html", "bonds.hdf.series", "particles_0000000000.hdf", "failed_bodies_0000000012.hdf")
    for name in names:
        out = os.path.join(folder, name + " of others")
        os.mkdir(out)
        with open(os.path.join(out, name), "w") as file:
            file.write("mine")
        expect(gneiss("run", LATTICE, "--out", out, "--quiet"), 2, re.escape(name), "--out", "--force")
        assert os.listdir(out) == [name]
        with open(os.path.join(out, name)) as file:
            assert file.read() == "mine"
    run(LATTICE, out, "--force")
    assert names[-1] not in os.listdir(out) and "results.h5" in os.listdir(out)


@fact
def folders_of_packings_and_of_runs_without_a_checkpoint_are_taken_over(folder):
    run(LATTICE, folder)
    for name in os.listdir(folder):  # files of a run that is killed before its first checkpoint
        if name == "results.h5" or name == "summary.json" or name.startswith("checkpoint"):
            os.remove(os.path.join(folder, name))
    assert snapshots(folder) > 0
    with open(os.path.join(folder, "notes.txt"), "w") as file:
        file.write("mine")
    run(LATTICE, folder)
    assert "notes.txt" in os.listdir(folder)
    packed = write_scene(folder, """
dimension: 2
specimen: {rectangle: {width: 1, height: 1}, mean_radius: 0.1, packing: {iterations: 5}}
materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 1, friction: 0}]
law: {stiffness: uniform}
time: {step: 1e-6, end: 1e-5}
run: {threads: 1}
""")
    expect(gneiss("pack", packed, "--out", os.path.join(folder, "packed"), "--quiet"), 0)
    run(packed, os.path.join(folder, "packed"))


@plain_fact
def a_grain_that_falls_far_bounces_by_hertz_at_default_settings(folder):
    """The particle's automatic step is that of a contact that does not exist yet, and the particle is fast when it touches."""
    grain = {"specimen": {"particles": [[0, 0, 0.5, 0.001]], "material": "a"}, "law": {"stiffness": "hertz"},
             "materials": [{"name": "a", "density": 2500, "young": 1e7, "poisson": 0.25, "friction": 0.5, "restitution": 0.5}],
             "gravity": [0, 0, -9.81], "walls": [{"name": "f", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "a"}],
             "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "time": {"end": 0.5}}
    out = os.path.join(folder, "out")
    run(write_scene(folder, grain), out)
    assert abs(summary(out)["energy_residual"]) < 0.01
    with results(out) as file:  # 0.319 s to the floor, then up at half the speed of 3.129 m/s
        assert abs(file["particles/position"][0, 2] - (0.001 + 1.5645 * 0.181 - 0.5 * 9.81 * 0.181**2)) < 0.01


@plain_fact
def resuming_a_finished_run_leaves_its_results_with_mean_confinement(folder):
    out, again = os.path.join(folder, "out"), os.path.join(folder, "again")
    run(UCS, out, "--set", "law.confinement=mean", "--set", "materials.0.bond_friction=0.8")
    shutil.copytree(out, again)
    resume(again)
    with results(out) as one, results(again) as other:
        for name in ("bonds/criterion", "bonds/force", "particles/stress"):
            assert np.array_equal(one[name][:], other[name][:], equal_nan=True), name


@fact
def a_specimen_is_not_taken_from_a_run_that_did_not_end(folder):
    out = os.path.join(folder, "out")
    expect(stop_at_snapshot(out, 2, signal.SIGINT), 6)
    with open(UCS) as file:
        text = file.read()
    start, end = text.index("specimen:"), text.index("\nmaterials:")
    path = write_scene(folder, text[:start] + f"specimen: {{from: {out}, material: rock}}" + text[end:])
    expect(gneiss("check", path), 2, r"expected a run that came to its end|cannot open")


@plain_fact
def grains_that_begin_fast_take_steps_that_resolve_their_motion(folder):
    """By Hertz's law the properties of contacts depend on the speed alone: two clumps that collide head-on, from 1
    to 50 m/s."""
    r = 1e-3
    places = [[side + 2.05 * r * i, 2.05 * r * j, 2.05 * r * k, r] for side in (0, 0.03) for i in range(3) for j in range(3) for k in range(3)]
    for speed in (1.0, 10.0, 50.0):
        given = {"dimension": 3, "specimen": {"particles": places},
                 "materials": [{"name": "m", "density": 2500, "young": "50 MPa", "poisson": 0.25, "friction": 0.3, "restitution": 0.8}],
                 "law": {"stiffness": "hertz"}, "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]},
                 "sets": [{"name": name, "select": {"ids": list(range(first, first + 27))}, "initial_velocity": [sense * speed, 0, 0]}
                          for name, first, sense in (("left", 0, 1), ("right", 27, -1))],
                 "time": {"end": 0.03 / speed}, "output": {"snapshots": 0}}
        out = os.path.join(folder, f"at-{speed}")
        run(write_scene(folder, given), out)
        assert abs(summary(out)["energy_residual"]) < 0.01, speed
        # A grain that passes through the others has touched none of them.
        with results(out) as file:
            left = file["particles/position"][:27, 0].mean()
        assert left < 0.018, (speed, left)


@plain_fact
def a_fast_body_takes_steps_that_grains_resolve(folder):
    """A plate at 30 m/s hits grains at rest, whose speed does not show the coming impact."""
    r = 1e-3
    places = [[2.05 * r * i, 2.05 * r * j, 2.05 * r * k, r] for i in range(3) for j in range(3) for k in range(3)]
    given = {"dimension": 3, "specimen": {"particles": places},
             "materials": [{"name": "m", "density": 2500, "young": "50 MPa", "poisson": 0.25, "friction": 0.3, "restitution": 0.8}],
             "law": {"stiffness": "hertz"}, "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]},
             "bodies": [{"name": "plate", "box": {"size": [2e-3, 0.02, 0.02]}, "origin": [-8e-3, -8e-3, -8e-3], "friction": 0.3, "motion": {"vx": 30}}],
             "time": {"end": 1e-3}, "output": {"snapshots": 0}}
    out = os.path.join(folder, "out")
    run(write_scene(folder, given), out)
    assert abs(summary(out)["energy_residual"]) < 0.01
    with results(out) as file:  # the plate is at 24 mm: all grains are in front of it
        assert (file["particles/position"][:, 0] > 0.024).all()


@fact
def a_pulse_does_not_start_in_a_zone_and_a_zone_has_edges(folder):
    wave = os.path.join(SCENES, "..", "..", "scenes", "wave-zone.yaml")
    inside = ("--set", "initial.pulse.centre=[300 mm, 0 mm]", "--set", "initial.pulse.length=20 mm")
    expect(gneiss("check", wave, *inside), 2, r"--set initial.pulse.*: expected one that starts outside of zones")
    expect(gneiss("check", wave, "--set", "couple.zones=[{edges: }]"), 2, r"expected at least one, found none")


@fact
def a_step_too_long_for_later_contacts_is_reported_without_a_bound(folder):
    scene = {"dimension": 3, "specimen": {"particles": [[0, 0, 0, 1e-3]], "group": 0}, "law": {"stiffness": "uniform"},
             "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e4, "kratio": 2}], "time": {"step": 0.1, "end": 1}}
    done = gneiss("check", write_scene(folder, scene))
    expect(done, 2, r"time.step: expected at most \S+ s \(stability limit at step 0, set by a contact that may form\), found 0.1 s")


if __name__ == "__main__":
    sys.exit(main())
