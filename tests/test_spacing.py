"""Rows of the history, snapshots and the remaining time follow the end of a test, which time.end only bounds. Speaks
TAP."""
import signal

from run_reference import *  # noqa: F403

LATE = ("--set", "time.end=1.5 ms", "--set", "time.stop.peak_drop=0.6", "--set", "output.history_rows=100",
        "--set", "output.snapshots=10")


def early(folder, *arguments):
    """A test that ends at a sixth of time.end."""
    run(UCS, folder, "--threads", 1, *LATE, *arguments)
    done = summary(folder)
    assert done["time"] < 0.25 * 1.5e-3 and "of its peak" in done["stop_reason"], done["stop_reason"]
    return history(folder)


def share_of_peak(folder):
    """Returns for every snapshot: time over that of the peak, stress over the peak."""
    rows = history(folder)
    peak = rows["stress"].argmax()
    return [(time / rows["time"][peak], np.interp(time, rows["time"], rows["stress"]) / rows["stress"][peak])
            for _, time in series(folder)]


def check_snapshots_of_peak(folder):
    shares = share_of_peak(folder)
    assert any(0.9 < time < 1.1 and stress > 0.93 for time, stress in shares), shares
    assert any(time < 1 and 0.4 < stress < 0.6 for time, stress in shares), shares
    assert any(time > 1 and 0.3 < stress < 0.6 for time, stress in shares), shares


@fact
def a_test_that_ends_early_has_as_many_rows_as_are_wanted(folder):
    steps = early(folder)["step"]
    assert 100 <= len(steps) < 200, f"{len(steps)} rows"
    apart = np.diff(steps)
    assert apart.max() <= 2 * np.median(apart), apart


@plain_fact
def rows_between_looks_do_not_change_the_step_of_the_end(folder):
    """A run whose rows have the spacing of time.end, because a resume with the same number of rows sets it."""
    wide, close = os.path.join(folder, "wide"), os.path.join(folder, "close")
    early(close)
    run(UCS, wide, "--threads", 1, *LATE, "--set", "time.stop=none", "--set", "time.end=1 us")
    resume(wide, *LATE[:4], "--set", "output.history_rows=100")
    assert summary(wide)["steps"] == summary(close)["steps"] and state_hash(wide) == state_hash(close)
    looks, rows = history(wide)["step"], history(close)["step"]
    assert set(looks[looks > 10]) <= set(rows), set(looks) - set(rows)


@fact
def a_run_that_reaches_its_time_has_rows_and_snapshots_at_the_steps_that_it_asks_for(folder):
    run(UCS, folder, "--threads", 1, "--set", "time.step=0.15 us", "--set", "time.stop.peak_drop=0.999999",
        "--set", "output.history_rows=20", "--set", "output.snapshots=5")
    steps = history(folder)["step"]
    assert list(steps) == [100 * k for k in range(20)], steps
    shares = [time / 0.3e-3 for _, time in series(folder)]
    for wanted in range(5):
        assert min(abs(share - wanted / 5) for share in shares) < 0.005, shares
    assert len(shares) <= 5 + 3 + 1, shares


@plain_fact
def rows_of_a_source_are_equal_times_apart_while_the_step_shrinks(folder):
    """The step of the first grains in flight is twenty times that of the heap; a run that continues has the same rows."""
    scene = os.path.join(os.path.dirname(os.path.dirname(SCENES)), "scenes/drum.yaml")

    def drum(name, end, rows):
        run(scene, os.path.join(folder, name), "--threads", 1, "--set", f"time.end={end} s", "--set", f"output.history_rows={rows}",
            "--set", "output.snapshots=0")

    drum("whole", 0.15, 30)
    drum("continued", 0.08, 16)
    resume(os.path.join(folder, "continued"), "--set", "time.end=0.15 s")
    rows, again = (history(os.path.join(folder, name)) for name in ("whole", "continued"))
    assert 30 <= len(rows["time"]) <= 36, len(rows["time"])
    apart, steps = np.diff(rows["time"])[:-1], np.diff(rows["step"])
    assert apart.max() < 1.02 * apart.min() and steps.max() > 10 * steps.min(), (apart, steps)
    assert list(rows["step"]) == list(again["step"]), (rows["step"], again["step"])
    assert not [name for name in rows if np.isnan(rows[name]).any() or name.startswith("strain")], list(rows)


@fact
def a_snapshot_is_kept_at_the_peak_and_at_half_of_it_before_and_after(folder):
    early(folder)
    check_snapshots_of_peak(folder)
    assert len(series(folder)) <= 10 + 4


@plain_fact
def snapshots_of_the_peak_are_kept_however_late_time_end_is(folder):
    """At 70 and 700 times the time of the peak rows and regular snapshots are far apart."""
    for end in ("15 ms", "150 ms"):
        shutil.rmtree(folder, ignore_errors=True)
        run(UCS, folder, "--threads", 1, *LATE, "--set", "output.history_rows=400", "--set", f"time.end={end}")
        check_snapshots_of_peak(folder)
        assert len(series(folder)) <= 10 + 4


@fact
def few_snapshots_have_those_of_the_peak_as_well(folder):
    early(folder, "--set", "output.snapshots=1")
    check_snapshots_of_peak(folder)
    assert len(series(folder)) <= 1 + 4
    early(folder, "--set", "output.snapshots=0")
    assert len(series(folder)) == 1


@fact
def a_test_that_does_not_stop_at_its_peak_has_snapshots_of_it(folder):
    run(UCS, folder, "--threads", 1, "--set", "output.snapshots=3")
    check_snapshots_of_peak(folder)


@fact
def a_stage_that_ends_early_has_its_rows_and_snapshots(folder):
    with open(UCS) as file:
        scene = file.read().replace("../../scenes", os.path.join(SCENES, "..", "..", "scenes")).replace(", stop: none", "")
    scene = scene.replace("time: {end: 0.3 ms}", "time: {end: 3 ms}").replace("history_rows: 300", "history_rows: 100")
    scene += "stages:\n  - {name: begin, end: {steps: 50}}\n  - {name: load, end: {peak_drop: 0.6}}\n"
    out = os.path.join(folder, "out")
    run(write_scene(folder, scene), out, "--threads", 1)
    rows = history(out)
    count = np.count_nonzero(rows["stage"] == 1)
    assert summary(out)["time"] < 0.6e-3 and 90 <= count < 200, (summary(out)["time"], count)
    check_snapshots_of_peak(out)


@plain_fact
def threads_and_interruptions_leave_the_same_rows_and_snapshots(folder):
    straight, threads, broken = (os.path.join(folder, name) for name in ("straight", "threads", "broken"))
    early(straight)
    run(UCS, threads, "--threads", 2, *LATE)
    check_same(threads, straight)
    for count in (4, 9):
        shutil.rmtree(broken, ignore_errors=True)
        expect(stop_at_snapshot(broken, count, signal.SIGINT, "--threads", 1, *LATE), 6)
        resume(broken)
        check_same(broken, straight)
        for name in ("particles", "bonds"):
            assert series(broken, name) == series(straight, name) == series(threads, name), name
            assert all(os.path.exists(os.path.join(broken, file)) for file, _ in series(broken, name))


@plain_fact
def rows_are_evenly_apart_when_a_resumed_run_has_no_stop_any_more(folder):
    """The close rows of the beginning are thinned as before, and later rows are at the same steps."""
    arguments = ("--threads", 1, "--set", "time.end=0.3 ms", "--set", "output.history_rows=50", "--set", "output.snapshots=10")
    expect(stop_at_snapshot(folder, 2, signal.SIGINT, *arguments, "--set", "time.stop.peak_drop=0.9999"), 6)
    resume(folder, "--set", "time.stop=none")
    apart = np.diff(history(folder)["step"])
    assert len(apart) >= 49 and apart[:-1].max() <= 2 * apart[:-1].min(), apart


@fact
def the_time_left_is_that_to_the_end_which_is_expected(folder):
    """The peak is predicted from the specimen; behind that, and without a prediction, it is at most the time to time.end."""
    done = expect(gneiss("run", UCS, "--out", folder, "--threads", 1, "--log", "json", *LATE, "--set", "time.end=15 ms"), 0)
    for line in logged(done.stdout, "progress"):
        left = line["end"] - line["time"]
        bound = line["seconds"] / line["time"] * left
        assert line["eta_at_most"] or line["eta"] < 0.2 * bound, line


if __name__ == "__main__":
    sys.exit(main())
