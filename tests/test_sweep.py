"""Sweeps: the runs that are made, the files that are kept, the effect of kills and failures, the summary. Speaks TAP."""
import contextlib
import csv
import random
import signal

from program import *  # noqa: F403

QUICK = ("--set", "time.end=0.1 ms", "--set", "output.snapshots=0", "--set", "output.history_rows=30")


def sweep_file(folder, name="sweep.yaml", **keys):
    return write_scene(folder, {"scene": LATTICE, **keys}, name)


def sweep(folder, keys, *arguments, code=0, name="out", quick=True, **options):
    """Runs a sweep of the small lattice into FOLDER/NAME; returns the rows of sweep.csv."""
    out = os.path.join(folder, name)
    expect(gneiss("sweep", sweep_file(folder, **keys), "--out", out, "--quiet", *(QUICK if quick else ()), *arguments, **options),
           code)
    return rows(out)


def rows(out, name="sweep.csv"):
    with open(os.path.join(out, name), newline="") as file:
        return list(csv.DictReader(file))


def kill(pid):
    with contextlib.suppress(ProcessLookupError):  # the process may have ended since it was listed
        os.kill(pid, signal.SIGKILL)


def is_gneiss(pid):
    with contextlib.suppress(FileNotFoundError, ProcessLookupError), open(f"/proc/{pid}/cmdline", "rb") as file:
        return b"gneiss" in file.read()
    return False


def without_seconds(table):
    return [{key: value for key, value in row.items() if not key.startswith("seconds")} for row in table]


def folders(out):
    return sorted(name for name in os.listdir(out) if re.fullmatch(r"[0-9a-f]{16}", name))


def single(folder, *arguments):
    """State hash of `gneiss run` on the same scene."""
    out = tempfile.mkdtemp(dir=folder)
    run(LATTICE, out, *QUICK, *arguments)
    return state_hash(out)


def children(pid):
    found = []
    for name in os.listdir("/proc"):
        if not name.isdigit():
            continue
        try:
            with open(f"/proc/{name}/stat") as file:
                if int(file.read().rpartition(")")[2].split()[1]) == pid:
                    found.append(int(name))
        except (OSError, IndexError):
            pass
    return found


def start(*arguments):
    return subprocess.Popen(command(*arguments), env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


# --- runs of a sweep --------------------------------------------------------------------------------------

@fact
def every_run_is_the_one_that_set_gives(folder):
    table = sweep(folder, {"parameters": {"materials.block.friction": [0.1, 0.4], "walls.top.motion.vz": ["-1 m/s", "-2000 mm/s"]}})
    assert [row["status"] for row in table] == ["done"] * 4
    for row in table:
        assert row["state_hash"] == single(
            folder, "--set", f"materials.block.friction={row['materials.block.friction']}",
            "--set", f"walls.top.motion.vz={row['walls.top.motion.vz [m/s]']}"), row


@fact
def a_note_on_a_parameter_stands_at_its_place_in_the_sweep_file(folder):
    with open(sweep_file(folder), "w") as file:
        file.write(f"scene: {LATTICE}\nparameters:\n  materials.block.beta: [1, 2]\n")
    done = expect(gneiss("sweep", os.path.join(folder, "sweep.yaml"), "--dry-run"), 0)
    notes = re.findall(r"note: (.*)", done.stderr)
    assert len(notes) == 1, notes
    assert re.search(r"sweep\.yaml:3:\d+: parameters\.materials\.block\.beta: materials\[0\]\.beta: it changes nothing here", notes[0]), notes


@fact
def a_range_of_angles_of_friction_is_even_in_the_coefficient(folder):
    table = sweep(folder, {"parameters": {"materials.block.friction": {"from": "20 deg", "to": "40 deg", "count": 3}}})
    angles = [np.degrees(np.arctan(float(next(value for key, value in row.items() if "friction" in key)))) for row in table]
    assert np.allclose(angles, [20, 31.03, 40], atol=0.01), angles


@fact
def a_component_is_varied_of_a_vector_that_the_scene_leaves_out(folder):
    table = sweep(folder, {"parameters": {"gravity[2]": [0, -9.81]}})
    assert [row["state_hash"] for row in table] == [single(folder), single(folder, "--set", "gravity=[0, 0, -9.81]")]


@fact
def a_component_is_varied_of_a_vector_that_is_the_same_in_every_run(folder):
    table = sweep(folder, {"parameters": {"gravity": ["[0, 0, -9.81]"], "gravity[0]": [0, 1]}})
    assert [row["state_hash"] for row in table] == [
        single(folder, "--set", f"gravity=[{x}, 0, -9.81]") for x in (0, 1)]
    assert sweep(folder, {"parameters": {"gravity[0]": [0, 1]}}, "--set", "gravity=[0, 0, -9.81]", name="set")[1]["state_hash"] == \
        table[1]["state_hash"]


@fact
def crossed_lists_give_every_pair_the_last_fastest(folder):
    table = sweep(folder, {"parameters": {"materials.block.friction": [0.1, 0.2], "run.precision": ["double", "mixed"]}})
    assert [(row["materials.block.friction"], row["run.precision"]) for row in table] == [
        ("0.1", "double"), ("0.1", "mixed"), ("0.2", "double"), ("0.2", "mixed")]
    assert [row["combination"] for row in table] == ["1", "2", "3", "4"]


@fact
def zipped_lists_go_together_and_single_values_with_all(folder):
    table = sweep(folder, {"combine": "zipped", "parameters": {
        "materials.block.friction": [0.1, 0.2], "walls.top.friction": [0.3, 0.5], "time.safety": 0.8}})
    assert [(row["materials.block.friction"], row["walls.top.friction"], row["time.safety"]) for row in table] == [
        ("0.1", "0.3", "0.8"), ("0.2", "0.5", "0.8")]


def plan(folder, keys, *arguments):
    """The labels of the runs that --dry-run lists."""
    done = expect(gneiss("sweep", sweep_file(folder, **keys), "--out", os.path.join(folder, "none"), "--dry-run", *QUICK, *arguments), 0)
    assert not os.path.exists(os.path.join(folder, "none")), "--dry-run wrote something"
    return [dict(item.split(" ")[0:3:2] if " = " in item else item.split(" ") for item in line.split("  ")[-1].strip().split(", "))
            for line in done.stdout.splitlines() if re.match(r" *\d+  [0-9a-f]{16} ", line)]


@fact
def ranges_hold_their_ends_and_equal_steps(folder):
    def values(given):
        return [float(run["materials.block.density"]) for run in plan(folder, {"parameters": {"materials.block.density": given}})]

    assert values({"from": 1000, "to": "3 g/cm3", "count": 5}) == [1000, 1500, 2000, 2500, 3000]
    logarithmic = values({"from": 10, "to": 10000, "count": 4, "spacing": "log"})
    assert np.allclose(logarithmic, [10, 100, 1000, 10000], rtol=1e-14) and logarithmic[0] == 10 and logarithmic[-1] == 10000


@fact
def ranges_of_negative_numbers_may_be_logarithmic(folder):
    runs = plan(folder, {"parameters": {"walls.top.motion.vz": {"from": -0.4, "to": "-25 mm/s", "count": 5, "spacing": "log"}}})
    assert np.allclose([float(run["walls.top.motion.vz"]) for run in runs], [-0.4, -0.2, -0.1, -0.05, -0.025], rtol=1e-14)


@fact
def ranges_of_whole_numbers_are_whole(folder):
    runs = plan(folder, {"parameters": {"specimen.lattice.cells[2]": {"from": 3, "to": 12, "count": 4, "spacing": "log"}}})
    assert [run["specimen.lattice.cells[2]"] for run in runs] == ["3", "5", "8", "12"]  # 3, 4.76, 7.56, 12


@fact
def lists_may_hold_vectors_and_words(folder):
    table = sweep(folder, {"parameters": {"gravity": [[0, 0, "-9.81 m/s2"], [0, 0, 0]], "time.step": ["auto", "0.3 us"]}})
    assert table[0]["state_hash"] == single(folder, "--set", "gravity=[0, 0, -9.81]")
    assert table[3]["state_hash"] == single(folder, "--set", "time.step=0.3 us")


@fact
def seeds_begin_at_that_of_the_scene(folder):
    table = sweep(folder, {"seeds": 3, "parameters": {"walls.top.friction": [0.3]}}, "--seed", 7)
    assert [row["seed"] for row in table] == ["7", "8", "9"]
    assert table[1]["state_hash"] == single(folder, "--seed", 8)
    assert len({row["state_hash"] for row in table}) == 3 and {row["combination"] for row in table} == {"1"}


@fact
def seeds_may_be_a_list_and_the_command_line_goes_first(folder):
    assert [row["seed"] for row in sweep(folder, {"seeds": [4, 2]})] == ["4", "2"]
    assert [row["seed"] for row in sweep(folder, {"seeds": [4, 2]}, "--seeds", "9,5,1")] == ["9", "5", "1"]


@fact
def seeds_of_a_scene_without_random_numbers_are_warned_of(folder):
    out = os.path.join(folder, "out")
    done = gneiss("run", LATTICE, "--seeds", 2, "--out", out, "--quiet", *QUICK, "--set", "specimen.lattice.jitter=0")
    expect(done, 0, "warning: seeds: this scene draws no random numbers")


@fact
def overrides_of_the_command_line_are_of_every_run(folder):
    table = sweep(folder, {"parameters": {"walls.top.friction": [0.3, 0.5]}}, "--set", "materials.block.density=3000")
    assert table[0]["state_hash"] == single(folder, "--set", "materials.block.density=3000")


@fact
def a_sweep_of_one_run_has_a_summary(folder):
    table = sweep(folder, {"parameters": {"time.safety": 0.9}})
    assert len(table) == 1 and table[0]["status"] == "done"
    mean = rows(os.path.join(folder, "out"), "sweep-means.csv")[0]
    assert mean["runs"] == "1" and mean["largest_stress mean [Pa]"] == table[0]["largest_stress [Pa]"]
    assert mean["largest_stress interval [Pa]"] == ""


@fact
def thousands_of_runs_are_listed_and_more_are_refused(folder):
    many = {"from": 0.1, "to": 1, "count": 40}
    keys = {"parameters": {"materials.block.friction": many, "walls.top.friction": many}}
    assert len(plan(folder, keys)) == 1600
    keys["parameters"]["time.safety"] = {"from": 0.1, "to": 0.9, "count": 100}
    expect(gneiss("sweep", sweep_file(folder, **keys), "--dry-run"), 2, r"sweep.yaml:1:\d+: parameters.time.safety: expected at most 100000 runs")


# --- samples ----------------------------------------------------------------------------------------------

def sampled(folder, method, count, **parameters):
    runs = plan(folder, {"sampling": {"method": method, "count": count, "seed": 3}, "parameters": parameters})
    assert len(runs) == count
    return runs


@fact
def a_sample_fills_every_stratum_between_its_ends(folder):
    for method in ("latin", "sobol"):
        runs = sampled(folder, method, 16, **{"materials.block.friction": {"from": 0.2, "to": 1}, "walls.top.stiffness": {
            "from": "0.1 MN/m", "to": "10 MN/m", "spacing": "log"}})
        even = [int(16 * (float(run["materials.block.friction"]) - 0.2) / 0.8) for run in runs]
        ratios = [int(16 * np.log(float(run["walls.top.stiffness"]) / 1e5) / np.log(100)) for run in runs]
        assert sorted(even) == sorted(ratios) == list(range(16)), (method, even, ratios)
        assert even != ratios


@fact
def a_sample_of_a_list_takes_all_as_often(folder):
    runs = sampled(folder, "latin", 12, **{"run.precision": {"of": ["double", "mixed"]},
                                              "specimen.lattice.cells[2]": {"from": 4, "to": 6}, "time.safety": {"from": 0.1, "to": 0.9}})
    for key, count in (("run.precision", 2), ("specimen.lattice.cells[2]", 3)):
        values = [run[key] for run in runs]
        assert all(values.count(value) == 12 // count for value in set(values)) and len(set(values)) == count, values


@fact
def a_normal_sample_has_its_mean_and_deviation_and_keeps_to_its_ends(folder):
    key = "materials.block.density"
    values = [float(run[key]) for run in sampled(folder, "latin", 200, **{key: {"mean": 2000, "deviation": 100}})]
    # One point in each of 200 strata: the mean is off by far less than deviation/sqrt(200) = 7.
    assert abs(np.mean(values) - 2000) < 2 and abs(np.std(values) - 100) < 5, (np.mean(values), np.std(values))
    cut = [float(run[key]) for run in sampled(folder, "sobol", 64, **{key: {"mean": 2000, "deviation": 100, "from": 2000, "to": "2100 kg/m3"}})]
    assert 2000 <= min(cut) < 2005 and 2090 < max(cut) <= 2100


@fact
def every_point_of_a_sample_goes_with_every_list_and_seed(folder):
    runs = plan(folder, {"sampling": {"method": "latin", "count": 3}, "seeds": 2, "parameters": {
        "materials.block.friction": {"from": 0, "to": 1}, "time.safety": [0.5, 0.9]}})
    assert len(runs) == 12 and len({run["materials.block.friction"] for run in runs}) == 3
    assert len({tuple(run.items()) for run in runs}) == 12


# --- kept files -------------------------------------------------------------------------------------------

FRICTIONS = {"parameters": {"materials.block.friction": [0.1, 0.2, 0.3]}}


def stamps(out):
    return {name: os.stat(os.path.join(out, name, "results.h5")).st_mtime_ns for name in folders(out)}


@fact
def nothing_is_computed_twice(folder):
    first = sweep(folder, FRICTIONS)
    out = os.path.join(folder, "out")
    before = stamps(out)
    assert sweep(folder, FRICTIONS) == first, "seconds included"
    assert stamps(out) == before
    wider = sweep(folder, {"seeds": 2, "parameters": {"materials.block.friction": [0.3, 0.1], "time.safety": [0.9, 0.8]}})
    after = stamps(out)
    assert len(wider) == 8 and len(after) == 9 and all(after[name] == before[name] for name in before)
    assert wider[0]["folder"] == first[2]["folder"] and wider[0]["state_hash"] == first[2]["state_hash"]


@fact
def force_computes_again(folder):
    sweep(folder, FRICTIONS)
    before = stamps(os.path.join(folder, "out"))
    sweep(folder, FRICTIONS, "--force")
    after = stamps(os.path.join(folder, "out"))
    assert before.keys() == after.keys() and all(after[name] > before[name] for name in before)


@fact
def equal_runs_of_one_sweep_are_computed_once(folder):
    table = sweep(folder, {"parameters": {"materials.block.friction": [0.25, "25 %", 0.3]}})
    assert len(table) == 3 and table[0]["folder"] == table[1]["folder"] and len(folders(os.path.join(folder, "out"))) == 2
    assert table[0]["state_hash"] == table[1]["state_hash"]


@fact
def a_folder_is_named_by_the_computation_not_by_names_and_threads(folder):
    base = sweep(folder, FRICTIONS)
    for more in (("--set", "title=another"), ("--threads", 1), ("--set", "output.checkpoint=1 min"), ("--set", "materials.block.density=2 g/cm3")):
        assert [row["folder"] for row in sweep(folder, FRICTIONS, *more)] == [row["folder"] for row in base], more
    assert sweep(folder, FRICTIONS, "--set", "materials.block.density=2001")[0]["folder"] != base[0]["folder"]


def packed_file(folder):
    positions = "\n".join(f"{0.002 * k} 0 0 0.001" for k in range(4))
    with open(os.path.join(folder, "grains.txt"), "w") as file:
        file.write(positions + "\n")
    return write_scene(folder, {
        "specimen": {"file": "grains.txt", "material": "m"}, "law": {"stiffness": "uniform"},
        "materials": [{"name": "m", "density": 2000, "normal_stiffness": 1e5, "kratio": 2, "friction": 0}],
        "initial": {"random_velocity": "1 mm/s"}, "time": {"end": "0.1 ms"}}, "grains.yaml")


@fact
def the_contents_of_files_count_not_their_places(folder):
    def table(scene):
        return sweep(folder, {"scene": scene, "parameters": {"materials.m.friction": [0, 0.1]}}, quick=False)

    scene = packed_file(folder)
    first = table(scene)
    moved = os.path.join(folder, "moved")
    os.mkdir(moved)
    for name in ("grains.yaml", "grains.txt"):
        shutil.copy(os.path.join(folder, name), moved)
    assert table(os.path.join(moved, "grains.yaml")) == first
    with open(os.path.join(moved, "grains.txt"), "a") as file:
        file.write("0.008 0 0 0.001\n")
    assert table(os.path.join(moved, "grains.yaml"))[0]["folder"] != first[0]["folder"]


@fact
def deleted_scenes_do_not_stop_a_sweep(folder):
    scene = packed_file(folder)
    out = os.path.join(folder, "out")
    sweep(folder, {"scene": scene, "seeds": 2}, quick=False)
    os.rename(os.path.join(out, folders(out)[0], "outcome.json"), os.path.join(out, "kept"))
    assert {row["status"] for row in sweep(folder, {"scene": scene, "seeds": 2}, "--collect", quick=False)} == {"done", "interrupted"}
    assert {row["status"] for row in sweep(folder, {"scene": scene, "seeds": 2}, quick=False)} == {"done"}


@fact
def packings_are_parameters_and_shared_between_runs(folder):
    scene = write_scene(folder, {
        "dimension": 2, "specimen": {"rectangle": {"width": 1, "height": 1}, "particles": 60, "material": "m"},
        "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e5, "kratio": 1, "friction": 0}],
        "law": {"stiffness": "uniform"}, "time": {"end": "1 ms"}, "output": {"history_rows": 5, "snapshots": 0}}, "packed.yaml")
    cache = os.path.join(folder, "cache")
    keys = {"scene": scene, "seeds": 2, "parameters": {"specimen.particles": {"from": 50, "to": 60, "count": 2}, "materials.m.friction": [0, 0.5]},
            "readings": "energy.kinetic"}
    file = sweep_file(folder, **keys)
    out = os.path.join(folder, "out")
    expect(gneiss("sweep", file, "--out", out, "--quiet", environment={"GNEISS_CACHE": cache}), 0)
    table = rows(out)
    assert len(table) == 8 and {row["status"] for row in table} == {"done"}
    assert len(os.listdir(cache)) == 4, "one packing for every number of particles and seed"
    with results(os.path.join(out, table[0]["folder"])) as data:
        assert data["particles/radius"].shape[0] == 50


# --- failures ---------------------------------------------------------------------------------------------

BAD = {"parameters": {"time.step": ["auto", "50 us", "0.3 us"]}}


@fact
def a_run_that_fails_is_listed_and_the_others_are_done(folder):
    out = os.path.join(folder, "out")
    done = gneiss("sweep", sweep_file(folder, **BAD), "--out", out, *QUICK)
    expect(done, 0, r"warning: run 2 \(time.step = 50 us\) failed: .*stability limit")
    assert re.search(r"failed: run 2 \(time.step = 50 us\): ", done.stdout), done.stdout
    table = rows(out)
    assert [row["status"] for row in table] == ["done", "failed", "done"]
    assert "stability limit" in table[1]["message"] and table[1]["largest_stress [Pa]"] == "" and table[1]["state_hash"] == ""


def stamps_of_outcomes(out):
    return {name: os.stat(os.path.join(out, name, "outcome.json")).st_mtime_ns for name in folders(out)}


@fact
def a_run_that_went_bad_is_not_tried_again(folder):
    # A ledger that does not close: the limit is far below rounding.
    keys = {"parameters": {"run.residual_limit": ["1e-30", "10 %"]}}
    table = sweep(folder, keys)
    assert [row["status"] for row in table] == ["failed", "done"] and "ledger" in table[0]["message"], table
    before = stamps_of_outcomes(os.path.join(folder, "out"))
    assert sweep(folder, keys) == table
    assert stamps_of_outcomes(os.path.join(folder, "out")) == before


@fact
def a_sweep_of_which_no_run_comes_to_its_end_says_so(folder):
    done = gneiss("sweep", sweep_file(folder, parameters={"run.residual_limit": ["1e-30", "1e-31"]}), "--out",
                  os.path.join(folder, "out"), "--quiet", *QUICK)
    expect(done, 5, "none of 2 runs was completed")
    assert [row["status"] for row in rows(os.path.join(folder, "out"))] == ["failed", "failed"]


@fact
def a_run_with_missing_or_truncated_results_is_computed_again(folder):
    before = sweep(folder, FRICTIONS)
    out = os.path.join(folder, "out")
    for row, checkpoint in zip(before, (True, False, True)):
        path = os.path.join(out, row["folder"], "results.h5")
        with open(path, "rb") as file:
            half = file.read()[:os.path.getsize(path) // 2]
        os.remove(path)
        if row is not before[0]:
            with open(path, "wb") as file:
                file.write(half)
        if not checkpoint:
            for name in os.listdir(os.path.dirname(path)):
                if name.startswith("checkpoint_"):
                    os.remove(os.path.join(out, row["folder"], name))
    file = sweep_file(folder, **FRICTIONS)
    dry = expect(gneiss("sweep", file, "--out", out, "--dry-run", *QUICK), 0).stdout
    assert "3 to do" in dry, dry
    collected = expect(gneiss("sweep", file, "--out", out, "--collect", *QUICK), 0).stdout
    assert collected.count("its results cannot be read") == 3, collected
    expect(gneiss("sweep", file, "--out", out, "--quiet", *QUICK), 0, r"warning: run 2 \(.*friction = 0.2\) lost: its results cannot be read")
    assert without_seconds(rows(out)) == without_seconds(before)


# --- kills ------------------------------------------------------------------------------------------------

LONG = ("--set", "output.snapshots=2", "--set", "output.history_rows=50", "--set", "output.checkpoint=20 ms")
EIGHT = {"seeds": 2, "parameters": {"materials.block.friction": [0.1, 0.2, 0.3, 0.4]}}


@fact
def ten_kills_of_sweeps_and_runs_lose_nothing(folder):
    unkilled = sweep(folder, EIGHT, *LONG, name="unkilled", quick=False)
    file, out, pick, kills = sweep_file(folder, **EIGHT), os.path.join(folder, "killed"), random.Random(5), 0
    process = start("sweep", file, "--out", out, "--quiet", "--jobs", 1, "--threads", 1, *LONG)
    while kills < 10:
        time.sleep(pick.uniform(0.01, 0.12))
        runs = children(process.pid)
        if process.poll() is not None:
            break
        if runs and kills % 2:
            kill(pick.choice(runs))
        else:
            process.kill()
            process.communicate()
            process = start("sweep", file, "--out", out, "--quiet", "--jobs", 1, "--threads", 1, *LONG)
        kills += 1
    out_text, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert kills >= 5, f"killed only {kills} times"
    assert without_seconds(rows(out)) == without_seconds(unkilled)
    for row in unkilled[:2]:
        check_same(os.path.join(out, row["folder"]), os.path.join(folder, "unkilled", row["folder"]))


@fact
def runs_end_when_their_sweep_is_killed(folder):
    process = start("sweep", sweep_file(folder, **EIGHT), "--out", os.path.join(folder, "out"), "--quiet", "--set", "time.end=4 ms")
    assert wait_until(process, lambda: children(process.pid))
    runs = children(process.pid)
    process.kill()
    process.communicate()
    end = time.monotonic() + 20
    while any(is_gneiss(pid) for pid in runs):
        assert time.monotonic() < end, "a run goes on without its sweep"
        time.sleep(0.01)


@fact
def ctrl_c_leaves_checkpoints_and_a_summary_and_the_same_command_continues(folder):
    unkilled = sweep(folder, EIGHT, *LONG, name="unkilled", quick=False)
    file, out = sweep_file(folder, **EIGHT), os.path.join(folder, "out")
    process = start("sweep", file, "--out", out, "--quiet", *LONG, "--set", "output.checkpoint=off")

    def steps():
        return os.path.isdir(out) and any(os.path.exists(os.path.join(out, name, "bonds_0000000000.hdf")) for name in folders(out))

    assert wait_until(process, steps)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 6 and re.search(r"\d of 8 runs are done", err), err
    states = {row["status"] for row in rows(out)}
    assert states <= {"done", "interrupted", "new"} and len(states) > 1, states
    assert without_seconds(sweep(folder, EIGHT, *LONG, quick=False)) == without_seconds(unkilled)


@fact
def a_run_that_is_killed_again_and_again_is_given_up(folder):
    file, out = sweep_file(folder, seeds=1), os.path.join(folder, "out")
    process = start("sweep", file, "--out", out, "--quiet", "--set", "time.end=1 s", "--set", "output.checkpoint=off")
    while process.poll() is None:
        for pid in children(process.pid):
            kill(pid)
        time.sleep(0.005)
    _, err = process.communicate()
    assert process.returncode == 5 and "ended by signal 9" in err, err
    assert rows(out)[0]["status"] == "failed"
    assert sweep(folder, {"seeds": 1})[0]["status"] == "done"


@fact
def a_folder_takes_one_sweep_at_a_time(folder):
    file, out = sweep_file(folder, **EIGHT), os.path.join(folder, "out")
    process = start("sweep", file, "--out", out, "--quiet", "--set", "time.end=2 ms")
    assert wait_until(process, lambda: os.path.isdir(out) and folders(out))
    expect(gneiss("sweep", file, "--out", out), 2, "another run")
    process.terminate()
    process.communicate(timeout=60)
    assert process.returncode == 6


@fact
def folders_of_runs_and_files_of_others_are_left_alone(folder):
    out = os.path.join(folder, "out")
    run(LATTICE, out, *QUICK)
    file = sweep_file(folder, **FRICTIONS)
    expect(gneiss("sweep", file, "--out", out, "--quiet"), 2, "expected a folder for several runs, found a run in it")
    other = os.path.join(folder, "other")
    os.mkdir(other)
    with open(os.path.join(other, "sweep.csv"), "w") as text_file:
        text_file.write("mine")
    expect(gneiss("sweep", file, "--out", other, "--quiet", *QUICK), 2, "another program", "--force")
    assert os.listdir(other) == ["sweep.csv"]
    expect(gneiss("sweep", file, "--out", other, "--quiet", "--force", *QUICK), 0)
    assert len(rows(other)) == 3


@fact
def a_run_does_not_go_into_the_folder_of_a_sweep(folder):
    table = sweep(folder, FRICTIONS)
    out, packing = os.path.join(folder, "out"), os.path.join(folder, "packing.yaml")
    with open(packing, "w") as file:
        file.write("specimen: {box: {size: [1, 1, 1]}, particles: 50}\n")
    for name in ("", "sweep.h5", "sweep.csv", "sweep-means.csv"):  # folders without a summary: shards, or a sweep that was killed
        if name:
            os.remove(os.path.join(out, name))
        expect(gneiss("run", LATTICE, "--out", out, *QUICK), 2, "expected a folder for one run, found several runs in it")
        expect(gneiss("pack", packing, "--out", out), 2, "expected a folder for a packing, found several runs in it")
    assert sorted(os.listdir(out)) == sorted(row["folder"] for row in table)
    assert sweep(folder, FRICTIONS) == table


# --- shards -----------------------------------------------------------------------------------------------

@fact
def shards_side_by_side_are_together_the_whole(folder):
    keys = {"seeds": 2, **FRICTIONS}
    whole = sweep(folder, keys, name="whole")
    file, out = sweep_file(folder, **keys), os.path.join(folder, "out")
    processes = [start("sweep", file, "--out", out, "--quiet", *QUICK, f"--array={k}/3") for k in (1, 2)]
    for process in processes:
        _, err = process.communicate(timeout=60)
        assert process.returncode == 0, err
    assert not os.path.exists(os.path.join(out, "sweep.csv")) and len(folders(out)) == 4
    expect(gneiss("sweep", file, "--out", out, "--quiet", *QUICK, "--array", environment={
        "SLURM_ARRAY_TASK_ID": "14", "SLURM_ARRAY_TASK_COUNT": "3", "SLURM_ARRAY_TASK_MIN": "10", "SLURM_ARRAY_TASK_STEP": "2"}), 0)
    expect(gneiss("sweep", file, "--out", out, "--quiet", *QUICK, "--collect"), 0)
    assert without_seconds(rows(out)) == without_seconds(whole)


@fact
def collecting_says_what_is_still_to_be_done(folder):
    file, out = sweep_file(folder, **FRICTIONS), os.path.join(folder, "out")
    expect(gneiss("sweep", file, "--out", out, "--quiet", *QUICK, "--array", "2/3"), 0)
    expect(gneiss("sweep", file, "--out", out, "--quiet", *QUICK, "--collect"), 0)
    assert [row["status"] for row in rows(out)] == ["new", "done", "new"]


@fact
def shards_that_cannot_be_are_refused(folder):
    file = sweep_file(folder, **FRICTIONS)
    for given in ("0/3", "4/3", "1/0", "x", "1", "1/2/3", "-1/2"):
        expect(gneiss("sweep", file, f"--array={given}"), 2, "--array: expected I/N")
    expect(gneiss("sweep", file, "--array"), 2, "SLURM_ARRAY_TASK_ID")
    expect(gneiss("sweep", file, "--array=1/2", "--collect"), 2, "found both")


# --- the summary ------------------------------------------------------------------------------------------

@fact
def means_and_intervals_are_those_of_the_rows(folder):
    table = sweep(folder, {"seeds": 4, "parameters": {"materials.block.friction": [0.1, 0.4]}})
    means = rows(os.path.join(folder, "out"), "sweep-means.csv")
    assert len(means) == 2
    for mean in means:
        values = [float(row["largest_stress [Pa]"]) for row in table if row["combination"] == mean["combination"]]
        deviation = np.std(values, ddof=1)
        assert np.isclose(float(mean["largest_stress mean [Pa]"]), np.mean(values), rtol=1e-12)
        assert np.isclose(float(mean["largest_stress deviation [Pa]"]), deviation, rtol=1e-9)
        # t of 3 degrees of freedom, Abramowitz & Stegun table 26.10: 3.182
        assert np.isclose(float(mean["largest_stress interval [Pa]"]), 3.182 * deviation / 2, rtol=2e-4)
        assert mean["runs"] == "4" == mean["largest_stress count"] and mean["materials.block.friction"] in ("0.1", "0.4")


@fact
def readings_are_those_of_the_results_of_each_run(folder):
    table = sweep(folder, {"readings": ["largest_stress", "energy.friction", "history.broken_tension"], **FRICTIONS})
    out = os.path.join(folder, "out")
    assert [key for key in table[0] if key.startswith(("largest", "energy", "history"))] == [
        "largest_stress [Pa]", "energy.friction [J]", "history.broken_tension"]
    for row in table:
        with results(os.path.join(out, row["folder"])) as file:
            assert float(row["largest_stress [Pa]"]) == file["readings/largest_stress"][()]
            assert float(row["energy.friction [J]"]) == file["energy/friction"][()]
            assert float(row["history.broken_tension"]) == file["history/broken_tension"][-1]
            assert int(row["steps"]) == file.attrs["steps"] and float(row["dt [s]"]) == file.attrs["dt"]


@fact
def every_column_of_a_history_can_be_a_reading(folder):
    table = sweep(folder, {"parameters": {"time.safety": 0.5}})
    with results(os.path.join(folder, "out", table[0]["folder"])) as file:
        last = {f"history.{name}": column[-1] for name, column in file["history"].items()}
    again = sweep(folder, {"parameters": {"time.safety": 0.5}, "readings": list(last)})[0]
    found = {key.split(" [")[0]: float(value or "nan") for key, value in again.items() if key.startswith("history.")}
    assert found.keys() == last.keys() and all(found[name] == last[name] or np.isnan(last[name]) for name in last)


@fact
def a_reading_that_no_run_has_is_warned_of(folder):
    file = sweep_file(folder, readings=["history.wall_roof_force_z", "history.wall_top_force_z"], seeds=1)
    done = expect(gneiss("sweep", file, "--out", os.path.join(folder, "out"), "--quiet", *QUICK), 0,
                  "warning: readings: no completed run has a number for history.wall_roof_force_z")
    assert "wall_top_force_z" not in done.stderr


@fact
def warnings_of_a_run_are_in_its_row(folder):
    table = sweep(folder, {"parameters": {"run.residual_warning": ["1e-30", "off"]}})
    assert [row["status"] for row in table] == ["done", "done"]
    assert "energy_residual: " in table[0]["message"] and "energy_residual" not in table[1]["message"], table


@fact
def sweep_h5_holds_the_same_numbers(folder):
    table = sweep(folder, {"seeds": 2, "parameters": {"run.precision": ["double", "mixed"], "walls.top.stiffness": ["1 MN/m", "2 MN/m"]}})
    with h5py.File(os.path.join(folder, "out", "sweep.h5"), "r") as file:
        assert text(file.attrs["kind"]) == "sweep" and file.attrs["runs"] == 8 and file.attrs["done"] == 8
        assert list(file["parameters/walls.top.stiffness"][:]) == [float(row["walls.top.stiffness [N/m]"]) for row in table]
        assert text(file["parameters/walls.top.stiffness"].attrs["unit"]) == "N/m"
        names = text(file["parameters/run.precision"].attrs["values"]).split("\n")
        assert [names[int(k)] for k in file["parameters/run.precision"]] == [row["run.precision"] for row in table]
        assert list(file["readings/largest_stress"][:]) == [float(row["largest_stress [Pa]"]) for row in table]
        assert text(file["runs/folder"][()]).split("\n") == [row["folder"] for row in table]
        mean = file["statistics/largest_stress/mean"][:]
        assert np.allclose(mean, file["readings/largest_stress"][:].reshape(4, 2).mean(axis=1), rtol=1e-14)


@fact
def run_with_seeds_prints_mean_and_interval_of_every_reading(folder):
    out = os.path.join(folder, "out")
    done = expect(gneiss("run", LATTICE, "--seeds", 3, "--out", out, "--quiet", *QUICK), 0)
    assert re.search(r"largest_stress +[\d.]+ \+- [\d.]+ [kM]?Pa +\(95 %, 3 runs; deviation", done.stdout), done.stdout
    assert [row["seed"] for row in rows(out)] == ["1", "2", "3"]
    assert rows(out)[1]["state_hash"] == single(folder, "--seed", 2)


@fact
def json_lines_report_every_event_and_the_means(folder):
    done = expect(gneiss("sweep", sweep_file(folder, seeds=2, **FRICTIONS), "--out", os.path.join(folder, "out"), "--log", "json", *QUICK), 0)
    lines = logged(done.stdout, "progress") + logged(done.stdout)
    assert [line["sweep"] for line in lines].count("done") == 6 and [line["sweep"] for line in lines].count("started") == 6
    assert lines[-1]["sweep"] == "summary" and len(lines[-1]["combinations"]) == 3
    assert lines[-1]["combinations"][0]["largest_stress"]["count"] == 2
    last = [line for line in lines if line["sweep"] == "done"][-1]
    assert last["done"] == last["total"] == 6 and re.fullmatch(r"[0-9a-f]{16}", last["folder"])


@fact
def a_terminal_has_one_line_of_progress(folder):
    shown, code = on_terminal(70, "sweep", sweep_file(folder, **EIGHT), "--out", os.path.join(folder, "out"))
    assert code == 0 and "8/8 runs done" in shown
    assert shown.count("\n") == 1 and all(len(line) < 75 for line in re.split(r"\r\x1b\[K|\r\n", shown)), shown


@fact
def the_report_is_one_page_that_holds_its_pictures(folder):
    sweep(folder, {"seeds": 2, "readings": "largest_stress", "parameters": {
        "materials.block.friction": [0.1, 0.4], "walls.top.motion.vz": [-1, -2]}})
    out = os.path.join(folder, "out")
    expect(gneiss("report", out), 0)
    with open(os.path.join(out, "report.html")) as file:
        page = file.read()
    assert page.count('src="data:image/png;base64,') == 3 and 'src="report/' not in page
    assert "materials.block.friction" in page and "Means and 95 % intervals" in page
    assert sorted(os.listdir(os.path.join(out, "report"))) == ["sweep_curves.png", "sweep_largest_stress.png", "sweep_largest_stress_map1.png"]
    runs = page[page.index("Every run"):]
    with h5py.File(os.path.join(out, "sweep.h5")) as file:
        folders = file["runs/folder"][()].decode().split("\n")
    assert all(f'href="{name}/"' in runs for name in folders[:8]), folders
    assert len(re.findall(r"largest stress", runs.split("</tr>")[0])) == 1 and re.search(r"<td class=\"number\">[\d.]+ [kM]?Pa</td>", runs)


@fact
def readings_that_are_the_same_in_every_run_have_one_picture(folder):
    sweep(folder, {"seeds": 2, "parameters": {"materials.block.friction": [0.1, 0.4]}})
    out = os.path.join(folder, "out")
    expect(gneiss("report", out), 0)
    with h5py.File(os.path.join(out, "sweep.h5")) as file:
        values = {name: data[()] for name, data in file["readings"].items()}
    drawn = [re.sub("^sweep_|.png$", "", name) for name in os.listdir(os.path.join(out, "report")) if "_map" not in name]
    known = [values[name] for name in drawn if name in values]
    assert len({v.tobytes() for v in known}) == len(known), drawn


@fact
def as_many_runs_as_processors_are_pinned_to_one_each(folder):
    cores = sorted(os.sched_getaffinity(0))
    process = start("sweep", sweep_file(folder, seeds=2 * len(cores)), "--out", os.path.join(folder, "out"), "--quiet", "--set", "time.end=4 ms")

    def pinned():
        try:
            return sorted(next(iter(os.sched_getaffinity(pid))) for pid in children(process.pid)
                          if len(os.sched_getaffinity(pid)) == 1)
        except ProcessLookupError:
            return []

    assert wait_until(process, lambda: pinned() == cores), "runs are not one to a processor"
    process.terminate()
    process.communicate(timeout=60)


@fact
def jobs_says_how_many_runs_there_are_at_a_time(folder):
    process = start("sweep", sweep_file(folder, **EIGHT), "--out", os.path.join(folder, "out"), "--quiet", "--jobs", 3, *QUICK)
    most = 0
    while process.poll() is None:
        most = max(most, len(children(process.pid)))
        time.sleep(0.002)
    process.communicate()
    assert process.returncode == 0 and most == 3, most


# --- unreadable input -------------------------------------------------------------------------------------

BROKEN = [  # (text after the line `scene: ...`, message)
    ("parameters: {materials.block.frictoin: [0.1]}", r":2:14: parameters.materials.block.frictoin: unknown key; did you mean 'friction'"),
    ("parameters: {materials.blok.friction: [0.1]}", r":2:40: parameters.materials.blok.friction: no element 'blok' .*did you mean 'block'"),
    ("parameters:\n  materials.block.friction: [0.1, -1]", r":3:35: parameters.materials.block.friction: materials\[0\].friction: expected a value in \[0, 1e30\], found '-1'"),
    ("parameters:\n  time.end: [1 ms, 2 kg]", r":3:20: parameters.time.end: expected a time .*found '2 kg'"),
    ("parameters:\n  run.precision: [double, mixd]", r":3:27: parameters.run.precision: .*did you mean 'mixed'"),
    ("parameters: {time: [1]}", r":2:14: parameters.time: expected a key with a value, found a section"),
    ("parameters: {time.end: []}", r":2:24: parameters.time.end: expected a list of values, a range or a distribution"),
    ("parameters: {time.end: }", r":2:14: parameters.time.end: expected a list of values"),
    ("parameters: [time.end]", r":2:13: parameters: expected keys of the scene"),
    ("parameters: {time.safety: {from: 0.1, to: 2, count: 3}}", r":2:43: parameters.time.safety.to: expected a value in \(0, 1\], found '2'"),
    ("parameters: {time.safety: {from: 0.1, two: 0.2, count: 3}}", r":2:39: parameters.time.safety.two: unknown key 'two'; did you mean 'to'"),
    ("parameters: {time.safety: {from: 0.1, count: 3}}", r":2:27: parameters.time.safety: expected a range \{from, to, count\}"),
    ("parameters: {time.safety: {from: 0.1, to: 0.2, count: 1}}", r":2:55: parameters.time.safety.count: expected a whole number in \[2, 100000\], found '1'"),
    ("parameters: {time.safety: {from: 0.1, to: 0.1, count: 2}}", r":2:27: .*expected different numbers at start and end"),
    ("parameters: {time.safety: {from: 0.1, to: 0.2, count: 2.5}}", r":2:55: parameters.time.safety.count: expected a whole number"),
    ("parameters: {time.safety: {from: 0.1, to: 0.2, count: 3, spacing: lg}}", r":2:67: .*did you mean 'log'"),
    ("parameters: {walls.top.motion.vz: {from: -1, to: 1, count: 3, spacing: log}}", r":2:35: .*one sign, not 0, for logarithmic"),
    ("parameters: {'specimen.lattice.cells[2]': {from: 3, to: 5, count: 9}}", r":2:43: .*9 different whole numbers, found 3 twice"),
    ("parameters: {run.precision: {from: 1, to: 2, count: 2}}", r":2:29: parameters.run.precision: expected a list of values: the key takes no number"),
    ("parameters: {time.safety: {from: 0.1, to: 0.2}}", r":2:27: parameters.time.safety: expected a count .* or the section sampling"),
    ("parameters: {time.safety: {mean: 0.5, deviation: 0}}\nsampling: {method: latin, count: 3}", r":2:27: .*a deviation above 0"),
    ("parameters: {time.safety: {mean: 0.5, deviation: 0.1, count: 3}}\nsampling: {method: latin, count: 3}", r":2:27: .*no count and no spacing"),
    ("parameters: {time.safety: {from: 0.5, to: 0.1}}\nsampling: {method: latin, count: 3}", r":2:27: .*from the smaller to the larger"),
    ("parameters: {time.safety: {of: 0.5}}\nsampling: {method: latin, count: 3}", r":2:32: .*a list of values for `of`"),
    ("parameters: {time.safety: {of: [0.5], from: 1}}\nsampling: {method: latin, count: 3}", r":2:27: .*no key beside `of`"),
    ("parameters: {time.safety: [0.5]}\nsampling: {method: latin, count: 3}", r":3:1: sampling: expected a distribution among the parameters"),
    ("parameters: {time.safety: [0.5]}\nsampling: {method: halton, count: 3}", r":3:20: sampling.method: expected one of latin, sobol"),
    ("parameters: {time.safety: [0.5]}\nsampling: {method: latin}", r":3:1: sampling.count: required"),
    ("parameters: {time.safety: [0.5, 0.9], time.end: [1, 2, 3]}\ncombine: zipped", r":2:39: parameters.time.end: expected 2 values, as zipped with time.safety, found 3"),
    ("parameters: {time.safety: [0.5]}\ncombine: crosed", r":3:10: combine: .*did you mean 'crossed'"),
    ("parameters: {time.safety: [0.5], time.safety: [0.6]}", r":2:34: parameters.time.safety: expected once, found again"),
    ("parameters:\n  materials.block.friction: [0.1, 0.2]\n  materials[0].friction: [0.3]",
     r":4:3: parameters.materials\[0\].friction: expected once, found again; first given as materials.block.friction in line 3, column 3"),
    ("parameters: {'walls[0].motion.vz': [-1], walls.top.motion.vz: [-3]}", r":2:42: .*first given as walls\[0\].motion.vz in line 2"),
    ("parameters: {gravity: ['[0, 0, 1]', '[0, 0, 2]'], 'gravity[2]': [3]}", r":2:\d+: parameters.gravity\[2\]: expected once"),
    ("parameters: {'run[seed]': [1, 2]}\nseeds: 2", r":2:14: parameters.run.seed: given by seeds as well"),
    ("parameters: {title: [a, b]}", r":2:14: parameters.title: cannot be varied"),
    ("parameters: {run.seed: [1, 2]}\nseeds: 2", r":2:14: parameters.run.seed: given by seeds as well"),
    ("seeds: 0", r":2:8: seeds: expected a number of seeds"),
    ("seeds: -3", r":2:8: seeds: expected a number"),
    ("seeds: [1, 2, 1]", r":2:8: seeds: expected .* different seeds"),
    ("seeds: {a: 1}", r":2:\d+: seeds: expected"),
    ("seeds: 2\nreadings: [peak_stres]", r":3:12: readings: unknown reading 'peak_stres'; did you mean 'peak_stress'"),
    ("seeds: 2\nreadings: energy.fricton", r":3:11: readings: .*did you mean 'energy.friction'"),
    ("seeds: 2\nreadings: [peak_stress, energy.friction, peak_stress]", r":3:42: readings: expected 'peak_stress' once, found it again"),
    ("seeds: 2\nreadings: history.strss", r":3:11: readings: unknown reading 'history.strss'; did you mean 'history.stress'"),
    ("seeds: 2\nreadings: [history.time, history.wall_top_forc_z]", r":3:26: readings: unknown reading 'history.wall_top_forc_z'"),
    ("seeds: 2\nreadings: [history.]", r":3:12: readings: unknown reading 'history.'"),
    ("sedes: 2", r":2:1: sedes: unknown key 'sedes'; did you mean 'seeds'"),
    ("title: nothing varied", r":1:1: expected parameters or seeds, found neither"),
    ("seeds: 2\nseeds: 3", r":3:1: seeds: expected once, found again; first given in line 2"),
    ("parameters: {gravity: [0, 0, -9.81]}", r":2:24: parameters.gravity: expected a list of 3 components"),
    ("parameters: {time.safety: [0.5", r"not valid YAML"),
    ("parameters: {time.end: [*a]}", r"YAML aliases are not part"),
    ("parameters: {materials.block.kratio: [0], walls.top.kratio: [none]}", r":2:62: parameters.walls.top.kratio: walls\[0\].kratio: required by friction"),
    ("parameters: {damping.contact.fraction: [0.1]}", r":2:41: .*expected restitution or fraction, found both"),
    ("parameters: {law.stiffness: [harmonic]}", r"sweep.yaml:2:14: with law.stiffness = harmonic: .*lattice-small.yaml:6:5: materials"),
]


@fact
def bad_files_are_refused_with_the_place(folder):
    path, failures = os.path.join(folder, "sweep.yaml"), []
    for lines, pattern in BROKEN:
        with open(path, "w") as file:
            file.write(f"scene: {LATTICE}\n{lines}\n")
        try:
            expect(gneiss("sweep", path, "--out", os.path.join(folder, "out")), 2, pattern)
        except AssertionError as failure:
            failures.append(f"{lines!r}: {failure}")
    assert not failures, "\n".join(failures)
    assert os.listdir(folder) == ["sweep.yaml"]


@fact
def several_slips_are_reported_at_once(folder):
    path = write_scene(folder, f"scene: {LATTICE}\nparameters:\n  time.ned: [1]\n  time.safety: {{from: 3, to: 0.2, count: 3}}\nreadings: x\n", "s.yaml")
    expect(gneiss("sweep", path), 2, r"s.yaml:3:3: parameters.time.ned", r"s.yaml:4:23: parameters.time.safety.from", r"s.yaml:5:11: readings")


@fact
def units_of_another_kind_are_refused_as_in_a_scene(folder):
    def refused(key, values, message):
        expect(gneiss("sweep", sweep_file(folder, parameters={key: values}, **({"sampling": {"method": "latin", "count": 3}}
                                          if "mean" in values else {})), "--dry-run"), 2, message)

    slope = "expected a coefficient such as '0.5' or an angle of friction such as '30 deg', found '0.5 m/m'"
    refused("materials.block.friction", [0.5, "0.5 m/m"], slope)
    refused("materials.block.friction", {"from": 0.1, "to": "0.5 m/m", "count": 3}, slope)
    refused("materials.block.friction", {"mean": "30 deg", "deviation": "5 deg"}, "deviation: expected a number")
    refused("walls.top.motion.vz", ["-1 m/s", "-1 m rad/s"], r"it contains an angle")
    for command in ("check", "plan"):
        expect(gneiss(command, LATTICE, "--set", "materials.block.friction=0.5 m/m"), 2, slope)
        done = gneiss(command, LATTICE, "--set", "materials.block.density=2.5 ton/m3")
        assert "note: --set materials.block.density: materials[0].density: ton is the short ton" in done.stderr, done.stderr
    done = expect(gneiss("sweep", sweep_file(folder, parameters={"materials.block.density": {"from": "1 ton/m3", "to": "2 t/m3", "count": 2}}),
                         "--dry-run"), 0)
    assert "parameters.materials.block.density.from: ton is the short ton" in done.stderr, done.stderr


@fact
def missing_files_and_files_of_no_sweep_are_reported(folder):
    expect(gneiss("sweep", os.path.join(folder, "none.yaml")), 2, "none.yaml: cannot open the sweep")
    expect(gneiss("sweep", folder), 2)
    expect(gneiss("sweep", write_scene(folder, "", "empty.yaml")), 2, "empty.yaml:1:1: expected a sweep, found an empty file")
    expect(gneiss("sweep", write_scene(folder, "seeds: 2\n", "a.yaml")), 2, "a.yaml:1:1: scene: required")
    expect(gneiss("sweep", write_scene(folder, "scene: none.yaml\nseeds: 2\n", "b.yaml")), 2, "b.yaml:1:8: scene: cannot open 'none.yaml'")
    expect(gneiss("sweep", LATTICE), 2, "lattice-small.yaml: expected a sweep file, found a scene: gneiss run")
    bad = write_scene(folder, "time: {end: 1, safty: 2}\n", "bad.yaml")
    expect(gneiss("sweep", write_scene(folder, f"scene: {bad}\nseeds: 2\n", "c.yaml")), 2, r"bad.yaml:1:16: time.safty: unknown key")
    expect(gneiss("run", LATTICE, "--seeds", "0"), 2, "--seeds: expected a number of seeds")
    expect(gneiss("run", LATTICE, "--seeds", "1,1"), 2, "--seeds: ")
    expect(gneiss("run", os.path.join(folder, "none.yaml"), "--seeds", "2"), 2, "none.yaml: cannot open the scene")


@fact
def options_of_sweeps_are_refused_elsewhere(folder):
    for option in ("--collect", "--array=1/2"):
        expect(gneiss("run", LATTICE, option), 2, f"gneiss run: {option.split('=')[0]} is for gneiss sweep")
    for option in (("--jobs", 2), ("--dry-run",)):
        expect(gneiss("run", LATTICE, *option), 2, f"{option[0]} is for gneiss sweep and gneiss run --seeds")
    expect(gneiss("plan", LATTICE, "--seeds", 3), 2, "--seeds is for")
    expect(gneiss("sweep", sweep_file(folder, **FRICTIONS), "--jobs", 0), 2, "--jobs: expected a whole number")
    expect(gneiss("sweep", sweep_file(folder, **FRICTIONS), "--set", "materials.block.friction=1"), 2, "given on the command line as well")
    expect(gneiss("sweep", sweep_file(folder, **FRICTIONS), "--set", "materials[0].friction=1"), 2,
           r"parameters.materials.block.friction: given on the command line as well: --set materials\[0\].friction")


if __name__ == "__main__":
    sys.exit(main())
