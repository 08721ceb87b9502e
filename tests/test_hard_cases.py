"""Runs that cannot succeed and the messages of gneiss; difficult physics is in test_hard.py. Speaks TAP."""
import resource
import shlex
import signal

from program import *  # noqa: F403


def spheres(particles, **changes):
    """A 3D scene of the given particles [x, y, z, r]."""
    scene = {
        "specimen": {"particles": particles},
        "materials": [{"name": "ball", "density": 2000, "normal_stiffness": 1e6, "kratio": 2, "friction": 0.3,
                       "bond_tension_limit": 100, "bond_shear_limit": 100}],
        "law": {"stiffness": "uniform"},
        "time": {"end": "1 ms"},
        "output": {"snapshots": 0, "history_rows": 10, "checkpoint": "off"},
        "run": {"threads": 1},
    }
    scene.update(changes)
    return scene


THREE = [[0, 0, 0, 1e-3], [0, 0, 3e-3, 1e-3], [0, 0, 6e-3, 1e-3]]


def refused(folder, scene, code, *patterns):
    """Checks that a run fails with the patterns and leaves no folder behind."""
    path, out = write_scene(folder, scene), os.path.join(folder, "out")
    expect(gneiss("run", path, "--out", out), code, *patterns)
    assert not os.path.exists(out), f"written all the same: {os.listdir(out)}"
    expect(gneiss("check", path), code, *patterns)


def done(folder, scene, *arguments):
    """Runs a scene to its end; returns the output folder, in which every number is finite."""
    out = os.path.join(folder, "out")
    run(write_scene(folder, scene), out, *arguments)
    with results(out) as file:
        for name in ("position", "velocity", "displacement", "spin"):
            assert np.all(np.isfinite(file["particles/" + name][:])), f"particles/{name} is not finite"
    return out


# --- the ledger ---------------------------------------------------------------------------------------------

@fact
def the_residual_of_a_scene_at_rest_is_that_of_its_run(folder):
    # Neighbours overlap by an ulp. The ledger does not explain energies of rounding, which are negligible.
    scene = spheres([], specimen={"lattice": {"kind": "fcc", "radius": 7.899042e-3, "cells": [2, 4, 4]}},
                    damping={"background": {"model": "viscous", "coefficient": 100}})
    out = done(folder, scene)
    said = [warning["name"] for warning in summary(out)["warnings"]]
    assert said == ["key_without_effect"], said  # the strengths of the material: there are no bonds
    assert abs(summary(out)["energy_residual"]) < 1e-2, summary(out)["energy_residual"]


# --- specimens --------------------------------------------------------------------------------------------

@fact
def an_empty_specimen_is_refused(folder):
    write_scene(folder, "# nothing but a comment\n", "empty.txt")
    refused(folder, spheres([], specimen={"file": "empty.txt"}), 2, r"empty\.txt", "expected")
    refused(folder, spheres([]), 2, r"scene\.yaml:1:\d+")


@fact
def a_nan_in_the_specimen_is_named_by_line_and_column(folder):
    write_scene(folder, "# x y z r\n0 0 0 1e-3\n0 0 nan 1e-3\n", "balls.txt")
    refused(folder, spheres([], specimen={"file": "balls.txt"}), 2, r"balls\.txt:3:5")
    write_scene(folder, "0 0 0 1e-3\n0 0 5e-3 0\n", "balls.txt")
    refused(folder, spheres([], specimen={"file": "balls.txt"}), 2, r"balls\.txt:2:\d+")


@fact
def a_missing_specimen_is_named_at_its_key(folder):
    text = 'specimen:\n  file: nowhere.txt\nmaterials: [{name: a, density: 1, normal_stiffness: 1, kratio: 0}]\n' \
           'law: {stiffness: uniform}\ntime: {end: 1}\n'
    refused(folder, text, 2, r"scene\.yaml:2:9: specimen\.file.*nowhere\.txt.*No such file")


@fact
def a_single_particle_flies_its_path(folder):
    scene = spheres([[0, 0, 0, 1e-3]], gravity=[0, 0, -10],
                    sets=[{"name": "ball", "select": {"all": True}, "initial_velocity": [1, 0, 0]}])
    with results(done(folder, scene)) as file:
        t = file["history/time"][:]
        moved = file["particles/displacement"][0]
    assert t[0] == 0.0 and abs(moved[0] - 1e-3) < 2e-5, moved
    assert abs(moved[2] + 0.5 * 10 * 1e-6) < 2e-7, moved


@fact
def overlapping_particles_at_rest_move_apart_under_non_viscous_damping(folder):
    for model in ("nonviscous_vector", "nonviscous_component"):
        scene = spheres([[0, 0, 0, 1e-3], [0, 0, 1.99e-3, 1e-3]],
                        damping={"background": {"model": model, "coefficient": 0.7}})
        with results(done(folder, scene)) as file:
            moved = file["particles/displacement"][:]
        assert moved[1, 2] > 1e-6 and abs(moved[0, 2] + moved[1, 2]) < 1e-12 and not np.any(moved[:, :2]), moved


# --- runs that go bad -------------------------------------------------------------------------------------

LEAVING = dict(time={"end": "2 ms"},
               domain={"min": [-0.01] * 3, "max": [0.01, 0.01, 0.02]},
               sets=[{"name": "leaver", "select": {"ids": [1]}, "initial_velocity": [10, 0, 0]}])


def failed_outputs(out):
    names = os.listdir(out)
    assert [n for n in names if re.fullmatch(r"failed_particles_\d+\.hdf", n)], names
    assert "summary.json" not in names, "a summary of a run that failed"
    with results(out) as file:
        assert file.attrs["finished"] == 0 and text(file.attrs["stop_reason"]).startswith("failed: ")
        return text(file.attrs["stop_reason"])


@fact
def a_particle_that_leaves_the_domain_stops_the_run(folder):
    out = os.path.join(folder, "out")
    call = gneiss("run", write_scene(folder, spheres(THREE, **LEAVING)), "--out", out, "--quiet")
    expect(call, 5, "particle 1 left the domain", "domain.lost: remove", r"failed_\*\.hdf")
    assert "particle 1 left the domain" in failed_outputs(out)


@fact
def a_particle_that_leaves_the_domain_can_be_removed(folder):
    scene = spheres(THREE, **LEAVING)
    scene["domain"]["lost"] = "remove"
    out = done(folder, scene)
    assert summary(out)["counts"]["removed"] == 1
    with results(out) as file:
        assert list(file["particles/removed"][:]) == [0, 1, 0]
        assert not np.any(file["particles/velocity"][1]), "a removed particle moves"
        assert abs(file["energy/residual"][0]) < 1e-9, file["energy/residual"][0]


@fact
def snapshots_say_which_particles_were_removed(folder):
    scene = spheres(THREE, **LEAVING)
    scene["domain"]["lost"] = "remove"
    out = done(folder, scene, "--set", "output.snapshots=4")
    seen = []
    for name, _ in series(out):
        with h5py.File(os.path.join(out, name)) as file:
            seen.append(list(file["VTKHDF/PointData/removed"][:]))
    assert seen[0] == [0, 0, 0] and seen[-1] == [0, 1, 0], seen


@fact
def a_step_above_the_limit_is_refused_with_both_numbers(folder):
    scene = spheres([[0, 0, 1.99e-3 * k, 1e-3] for k in range(5)], bonds={}, time={"end": "1 s", "step": "1 ms"})
    refused(folder, scene, 2, r"time\.step: expected at most [\d.e-]+ s", r"particle \d", r"found 0\.001 s")


@fact
def a_step_above_the_limit_runs_on_request_and_its_failure_is_named(folder):
    scene = spheres([[0, 0, 1.99e-3 * k, 1e-3] for k in range(5)], bonds={"passive_gaps": False},
                    time={"end": "1 s", "step": "1 ms", "on_unstable": "warn"})
    scene["materials"][0]["bond_tension_limit"] = scene["materials"][0]["bond_shear_limit"] = 1e30
    out = os.path.join(folder, "out")
    expect(gneiss("run", write_scene(folder, scene), "--out", out, "--quiet"), 5, r"particle \d", "stability limit")
    failed_outputs(out)


@fact
def a_run_that_failed_goes_on_from_its_checkpoint(folder):
    out, late = os.path.join(folder, "out"), [[0, 0, 0, 1e-3], [9e-3, 0, 0, 1e-3]]
    scene = spheres(late, domain={"min": [-0.1] * 3, "max": [0.1] * 3}, time={"end": "1 ms"},
                    sets=[{"name": "leaver", "select": {"ids": [1]}, "initial_velocity": [10, 0, 0]}])
    run(write_scene(folder, scene), out)
    expect(gneiss("resume", out, "--quiet", "--set", "time.end=20 ms"), 5, "particle 1 left the domain")
    resume(out, "--set", "time.end=2 ms")
    assert abs(summary(out)["time"] - 2e-3) < 1e-5


# --- disks ------------------------------------------------------------------------------------------------

def contents(folder):
    return {name: open(os.path.join(folder, name), "rb").read() for name in sorted(os.listdir(folder))}


@fact
def a_file_in_the_place_of_the_folder_is_an_error(folder):
    place = write_scene(folder, "mine", "taken")
    expect(gneiss("run", LATTICE, "--out", place), 3, "taken: cannot be made a folder: there is a file")
    expect(gneiss("run", LATTICE, "--out", os.path.join(place, "below")), 3, "taken")
    assert open(place).read() == "mine"


@fact
def a_folder_in_the_place_of_a_file_is_an_error(folder):
    os.mkdir(os.path.join(folder, "summary.json"))
    expect(gneiss("run", LATTICE, "--out", folder, "--quiet"), 2, "summary.json")
    expect(gneiss("run", LATTICE, "--out", folder, "--quiet", "--force"), 3, "summary.json")


def in_namespace(script, *arguments):
    """Writes a shell script with its own mount table."""
    call = ["unshare", "-m", "--propagation", "private", "sh", "-c", script, "sh", *arguments]
    try:
        if subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode != 0:
            raise Skip("no mount namespaces for this user")
    except FileNotFoundError:
        raise Skip("no unshare on this machine") from None
    return subprocess.run(call, capture_output=True, text=True, env=ENVIRONMENT, timeout=120)


def gneiss_in(call):
    return "; ".join([" ".join(map(shlex.quote, call)), "echo code $?"])


@fact
def a_read_only_folder_is_an_error(folder):
    script = f'mount -t tmpfs -o ro none "$1" || exit 77; {gneiss_in(command("run", LATTICE, "--quiet"))} --out "$1"'
    script = script.replace("; echo code $? --out", " --out") + "; echo code $?"
    call = in_namespace(script, folder)
    if call.returncode == 77:
        raise Skip("tmpfs cannot be mounted")
    assert "code 3" in call.stdout and "Read-only file system" in call.stderr, call.stdout + call.stderr


@fact
def a_full_disk_is_an_error_and_leaves_whole_files_only(folder):
    program, scene = map(shlex.quote, (PROGRAM, UCS))
    script = f'mount -t tmpfs -o size=2500k none "$1" || exit 77; {program} run {scene} --out "$1" --quiet; ' \
             'echo code $?; for file in "$1"/*; do cp "$file" "$2" && rm "$file"; done'
    disk, out = os.path.join(folder, "disk"), os.path.join(folder, "copy")
    os.mkdir(disk)
    os.mkdir(out)
    call = in_namespace(script, disk, out)
    if call.returncode == 77:
        raise Skip("tmpfs cannot be mounted")
    assert "code 3" in call.stdout, call.stdout + call.stderr
    assert "No space left on device" in call.stderr, call.stderr
    names = os.listdir(out)
    assert names and not [name for name in names if name.endswith(".tmp")], names
    for name in names:
        if name.endswith((".hdf", ".h5")):
            with h5py.File(os.path.join(out, name)) as file:
                assert len(file), f"{name} is empty"


@fact
def a_file_size_limit_is_an_error_and_leaves_earlier_files_alone(folder):
    out = os.path.join(folder, "out")
    run(LATTICE, out, "--set", "time.end=0.2 ms")
    before = contents(out)
    limit = min(len(before[checkpoints(out)[0]]), len(before["results.h5"])) // 2

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    call = gneiss("resume", out, "--quiet", "--set", "time.end=0.4 ms", preexec_fn=limited)
    expect(call, 3, "File too large", re.escape(out))
    after = contents(out)
    assert not [name for name in after if name.endswith(".tmp")], after.keys()
    for name in before:
        if name == "status.json" or name.endswith(".series") or (name.endswith(".hdf") and name not in after):
            continue  # a snapshot of the peak is removed when a later one at a larger stress exists
        assert after.get(name) == before[name], f"{name} has changed"
    resume(out, "--set", "time.end=0.4 ms")
    straight = os.path.join(folder, "straight")
    run(LATTICE, straight)
    assert state_hash(out) == state_hash(straight)


@fact
def a_file_size_limit_at_the_start_is_an_error(folder):
    def limited():
        # Leaves room for the shared memory of an OpenMP runtime, but not for a snapshot.
        resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))

    expect(gneiss("run", LATTICE, "--out", folder, "--quiet", preexec_fn=limited), 3, "File too large")
    assert os.listdir(folder) == ["status.json"], os.listdir(folder)
    with open(os.path.join(folder, "status.json"), encoding="utf-8") as file:
        assert json.load(file)["state"] == "failed"


# --- energy without a source -------------------------------------------------------------------------------

def warnings(folder):
    return {w["name"]: w["text"] for w in summary(folder)["warnings"]}


@fact
def a_residual_beyond_its_warning_is_named_everywhere(folder):
    done = expect(gneiss("run", LATTICE, "--out", folder, "--quiet", "--set", "run.residual_warning=1e-15"), 0,
                  "warning: energy_residual: .*unexplained.*run.residual_warning: 1e-15")
    reported = [f"{name}: {words}" for name, words in warnings(folder).items()]
    assert done.stderr.splitlines() == ["gneiss: warning: " + line for line in reported], done.stderr
    with results(folder) as file:
        assert text(file.attrs["warnings"]).split("\n") == reported


@fact
def a_ledger_that_closes_has_no_warning(folder):
    assert run(UCS, folder).stderr == "" and warnings(folder) == {}
    with results(folder) as file:
        assert text(file.attrs["warnings"]) == ""


@fact
def a_residual_that_stays_beyond_its_limit_stops_the_run(folder):
    call = expect(gneiss("run", LATTICE, "--out", folder, "--quiet", "--set", "run.residual_limit=1e-15"), 5,
                  r"ledger does not close.*run.residual_limit: 1e-15\), since step \d+", r"failed_\*\.hdf")
    with results(folder) as file:
        assert file.attrs["finished"] == 0 and "ledger does not close" in text(file.attrs["stop_reason"])
        assert file["history/time"][-1] < 0.39e-3, call.stderr
    assert not os.path.exists(os.path.join(folder, "summary.json"))


@fact
def a_run_that_ends_beyond_the_limit_is_written_and_fails(folder):
    """The run is too short to be stopped in between: the onset of contacts is resolved by a hundred steps."""
    arguments = ("--quiet", "--set", "time.step=1 us", "--set", "time.end=95 us", "--set", "output.history_rows=95",
                 "--set", "run.residual_limit=1e-15")
    expect(gneiss("run", LATTICE, "--out", folder, *arguments), 5, "ledger does not close.* at the end")
    assert summary(folder)["finished"] is True and summary(folder)["steps"] < 100
    expect(gneiss("resume", folder, "--quiet"), 5, "ledger does not close")
    resume(folder, "--set", "run.residual_limit=off")


# --- runs without end, signals before the first step, small stacks --------------------------------------

@fact
def a_run_that_would_never_end_is_refused_at_its_place(folder):
    text = json.dumps(spheres(THREE, time=None)).replace('"time": null', '\n"time": {"end": END, "step": STEP}')
    for end, step in (("1e308", "1e-6"), ("2e-5", "5e-24"), ("1e15", "1e-6")):
        refused(folder, text.replace("END", end).replace("STEP", step), 2,
                r"scene\.yaml:2:\d+: time: expected an end within 1e\+15 steps, found \S+ steps of " + f"{float(step):.4g} s")


@fact
def a_safety_that_leaves_no_step_is_refused(folder):
    out = os.path.join(folder, "out")
    for safety in ("1e-308", "5e-324"):
        expect(gneiss("run", LATTICE, "--out", out, "--set", f"time.safety={safety}"), 2, "time: expected an end within")
    assert not os.path.exists(out)


@fact
def collisions_that_leave_no_step_are_refused(folder):
    # The spheres start with and without contacts; each collision lasts 1e17 steps.
    for radius in (0.01, 0.001):
        particles = [[0, 0, 0, radius], [0.019, 0, 0, radius]]
        refused(folder, json.dumps(spheres(particles, time={"end": 1e-3, "contact_steps": 1e17})), 2,
                r"time: expected an end within 1e\+15 steps, found \S+ steps")


@fact
def a_resumed_run_that_would_never_end_is_refused(folder):
    run(LATTICE, folder, "--set", "time.end=0.1 ms")
    before = contents(folder)
    expect(gneiss("resume", folder, "--set", "time.end=1e300"), 2, "time: expected an end within")
    assert contents(folder) == before


@fact
def a_time_of_a_century_is_given_in_years(folder):
    # 4e13 steps of 1600 particles: even at 3 microseconds each, which no machine reaches, four years.
    done = expect(gneiss("plan", UCS, "--set", "time.end=1e7"), 0)
    assert re.search(r"\n  time +\d\S* years\n", done.stdout), done.stdout


def signalled(folder, *arguments):
    """The run is interrupted half a second after its start, long before its preparation ends."""
    process = subprocess.Popen(command(*arguments), env={**ENVIRONMENT, "GNEISS_CACHE": "off"},
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(0.5)
    assert process.poll() is None, process.stderr.read()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 6, (process.returncode, err)
    return err


@fact
def a_signal_while_particles_are_seeded_ends_the_packing(folder):
    body = write_scene(folder, "specimen:\n  cylinder: {diameter: 20 mm, height: 30 mm}\n  particles: 3000000\n")
    out = os.path.join(folder, "out")
    assert "packing interrupted" in signalled(folder, "pack", body, "--out", out)
    assert not os.path.exists(out), os.listdir(out)


@fact
def a_signal_while_elements_are_made_leaves_nothing(folder):
    scene = {"elements": {"box": {"size": [1, 1, 1], "cells": [40, 40, 40]},
                          "materials": [{"density": 2500, "young": 1e10, "poisson": 0.25}]},
             "time": {"end": 1e-3}, "output": {"snapshots": 0}, "run": {"threads": 1}}
    out = os.path.join(folder, "out")
    assert "before the first step" in signalled(folder, "run", write_scene(folder, scene), "--out", out)
    assert not os.path.exists(out), os.listdir(out)


@fact
def a_stack_of_128_kb_is_enough(folder):
    if SANITIZED:
        raise Skip("frames of a sanitizer are larger")

    def limited():
        resource.setrlimit(resource.RLIMIT_STACK, (131072, 131072))

    body = write_scene(folder, "specimen: {cylinder: {diameter: 20 mm, height: 30 mm}, particles: 60}\n")
    for name in ("lattice-small", "beam-small", "elements"):
        out = os.path.join(folder, name)
        scene = os.path.join(SCENES, name + ".yaml")
        expect(gneiss("run", scene, "--out", out, "--quiet", "--threads", 2, preexec_fn=limited), 0)
        expect(gneiss("resume", out, "--quiet", preexec_fn=limited), 0)
    expect(gneiss("pack", body, "--out", os.path.join(folder, "p"), "--quiet", preexec_fn=limited,
                  environment={"GNEISS_CACHE": os.path.join(folder, "cache")}), 0)


# --- finished runs ------------------------------------------------------------------------------------------

@fact
def a_finished_long_run_is_replaced_only_by_force(folder):
    run(LATTICE, folder)
    with h5py.File(os.path.join(folder, "results.h5"), "r+") as file:
        file.attrs["seconds"] = 3723.0  # attribute of a run that took this time
        report_digest.seal(file)
    before = contents(folder)
    expect(gneiss("run", LATTICE, "--out", folder, "--quiet"), 2, "finished run that took 62 min 03 s", "--force", "--out")
    assert contents(folder) == before
    run(LATTICE, folder, "--force", "--set", "time.end=0.1 ms")
    assert contents(folder) != before


@fact
def a_long_run_that_did_not_end_is_replaced_as_it_is(folder):
    run(LATTICE, folder)
    with h5py.File(os.path.join(folder, "results.h5"), "r+") as file:
        file.attrs["seconds"] = 3723.0
        file.attrs["finished"] = 0
        report_digest.seal(file)
    run(LATTICE, folder)


if __name__ == "__main__":
    sys.exit(main())
