"""The small UCS test without interruption, and comparisons of other runs with it: for test_run.py and
test_run_bits.py."""
import atexit

from program import *  # noqa: F403

REFERENCE = tempfile.mkdtemp(prefix="gneiss-reference-")
atexit.register(shutil.rmtree, REFERENCE, ignore_errors=True)


def reference():
    """An uninterrupted run of the small UCS with one thread, made once."""
    if not os.path.exists(os.path.join(REFERENCE, "summary.json")):
        run(UCS, REFERENCE, "--threads", 1)
    return REFERENCE


def start(folder, *arguments):
    return subprocess.Popen(command("run", UCS, "--out", folder, "--quiet", *arguments), env=ENVIRONMENT,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def snapshots(folder):
    if not os.path.isdir(folder):
        return 0
    return sum(1 for name in os.listdir(folder) if re.fullmatch(r"bonds_\d+\.hdf", name))


def stop_at_snapshot(folder, count, number, *arguments):
    """Sends a signal when there are `count` snapshots; returns the finished process."""
    process = start(folder, *arguments)
    assert wait_until(process, lambda: snapshots(folder) >= count), process.stderr.read()
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    return subprocess.CompletedProcess([], process.returncode, out, err)


def same_with_threads(folder, threads):
    run(UCS, folder, "--threads", threads)
    assert summary(folder)["threads"] == threads
    check_same(folder, reference())


def interrupted_and_resumed(folder, number, *arguments):
    done = expect(stop_at_snapshot(folder, 3, number, "--threads", 1), 6, r"interrupted: at step \d+", "gneiss resume")
    assert len(checkpoints(folder)) == 1, checkpoints(folder)
    assert not os.path.exists(os.path.join(folder, "summary.json")), "a summary before the end"
    with results(folder) as file:
        assert file.attrs["finished"] == 0 and text(file.attrs["stop_reason"]) == "interrupted"
        rows = file["history/step"].shape[0]
    assert 0 < rows < len(history(reference())["step"]), done.stderr
    resume(folder, *arguments)
    check_same(folder, reference())
    assert series(folder) == series(reference()), "the snapshots are not those of the uninterrupted run"
    with results(folder) as file:
        assert file.attrs["finished"] == 1 and "reached" in text(file.attrs["stop_reason"])


def killed_and_resumed(folder, count):
    process = start(folder, "--set", "output.checkpoint=20 ms", "--threads", "2")
    ready = wait_until(process, lambda: snapshots(folder) >= count and checkpoints(folder))
    process.kill()
    process.communicate()
    assert ready, "the run ended before it could be killed"
    resume(folder, "--set", "output.checkpoint=off")
    check_same(folder, reference())
    for name in ("particles", "bonds"):
        listed = series(folder, name)
        times = [time for _, time in listed]
        assert all(a < b for a, b in zip(times, times[1:])), f"times of {name} do not increase: {times}"
        there = {file for file in os.listdir(folder) if re.fullmatch(name + r"_\d+\.hdf", file)}
        assert {file for file, _ in listed} == there, "the series and the folder differ"
    assert series(folder) == series(reference())
    assert not [name for name in os.listdir(folder) if name.endswith(".tmp")], os.listdir(folder)
