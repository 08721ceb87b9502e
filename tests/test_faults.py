"""System calls that fail, one at a time (tests/faults.c, the second argument). Speaks TAP."""
import random
import resource

from program import *  # noqa: F403

SHIM = os.path.abspath(sys.argv[2])
MB = 1 << 20


def faulty(*arguments, **faults):
    """One call with faults: open="NAME:ERRNO" is GNEISS_FAULT_OPEN."""
    named = {"GNEISS_RECORD" if name == "record" else "GNEISS_FAULT_" + name.upper(): str(value)
             for name, value in faults.items()}
    return gneiss(*arguments, environment={"LD_PRELOAD": SHIM, "GNEISS_CACHE": "off", **named})


def contents(folder):
    return {name: open(os.path.join(folder, name), "rb").read() for name in sorted(os.listdir(folder))}


# --- checkpoints that cannot be read now -------------------------------------------------------------------

def nothing_is_lost(folder, pattern, **faults):
    _, newer = two_checkpoints(folder)
    before = contents(folder)
    kind, code = next(iter(faults.items()))
    done = faulty("resume", folder, "--quiet", "--set", "time.end=0.4 ms", **{kind: f"{newer}:{code}"})
    expect(done, 3, newer, pattern, "nothing was changed")
    assert contents(folder) == before, "the folder has changed"
    resume(folder, "--set", "time.end=0.4 ms")


@fact
def no_descriptor_for_the_newest_checkpoint_changes_nothing(folder):
    nothing_is_lost(folder, "Too many open files", open=24)


@fact
def no_memory_to_open_the_newest_checkpoint_changes_nothing(folder):
    nothing_is_lost(folder, "Cannot allocate memory", open=12)


@fact
def an_error_of_the_disk_when_the_newest_checkpoint_is_opened_changes_nothing(folder):
    nothing_is_lost(folder, "Input/output error", open=5)


@fact
def an_error_of_the_disk_when_the_newest_checkpoint_is_read_changes_nothing(folder):
    nothing_is_lost(folder, "Input/output error", read=5)


# --- outputs that cannot be written ------------------------------------------------------------------------

def third_snapshot(folder):
    out = os.path.join(folder, "whole")
    run(LATTICE, out, "--set", "output.snapshots=5")
    name = sorted(name for name in os.listdir(out) if re.fullmatch(r"bonds_\d+\.hdf", name))[2]
    return name, int(re.search(r"\d+", name).group())


@fact
def a_snapshot_on_a_full_disk_is_followed_by_a_checkpoint(folder):
    name, step = third_snapshot(folder)
    out = os.path.join(folder, "out")
    done = faulty("run", LATTICE, "--out", out, "--quiet", "--set", "output.snapshots=5", write=f"{name}:28")
    expect(done, 3, name, "No space left", f"at step {step}; the checkpoint of step {step} remains: gneiss resume")
    assert checkpoints(out) == [f"checkpoint_{step:010d}.h5"]
    resume(out)
    assert state_hash(out) == state_hash(os.path.join(folder, "whole"))
    assert len(series(out, "bonds")) == len(series(os.path.join(folder, "whole"), "bonds"))


@fact
def a_full_disk_without_room_for_a_checkpoint_says_that_there_is_none(folder):
    done = faulty("run", LATTICE, "--out", folder, "--quiet", write=".hdf.tmp:28", open="checkpoint:28")
    expect(done, 3, "No space left", "no checkpoint of it", "there is no checkpoint")
    assert os.listdir(folder) == ["status.json"], os.listdir(folder)
    with open(os.path.join(folder, "status.json"), encoding="utf-8") as file:
        said = json.load(file)
    assert (said["state"], said["code"]) == ("failed", 3) and "No space left" in said["message"], said


@fact
def a_full_disk_at_a_later_snapshot_names_the_earlier_checkpoint(folder):
    run(LATTICE, folder, "--set", "time.end=0.2 ms")
    (earlier,) = checkpoints(folder)
    done = faulty("resume", folder, "--quiet", "--set", "time.end=0.4 ms",
                  write="particles_:28", open="h5.tmp:28")
    expect(done, 3, f"the checkpoint of step {int(earlier[11:21])} remains")
    assert checkpoints(folder) == [earlier]


@fact
def a_full_disk_at_the_end_costs_only_what_it_has_no_room_for(folder):
    whole = os.path.join(folder, "whole")
    run(LATTICE, whole, "--set", "output.snapshots=0")
    files = {"checkpoint_", "results.h5", "summary.json"}
    # A summary exists only together with the results that it summarises.
    cases = (("checkpoint_", {"checkpoint_"}), ("particles", set()), ("results.h5", {"results.h5", "summary.json"}),
             ("summary.json", {"summary.json"}))
    for number, (name, lost) in enumerate(cases):
        out = os.path.join(folder, str(number))
        done = faulty("run", LATTICE, "--out", out, "--quiet", "--set", "output.snapshots=0", write=f"{name}:28")
        expect(done, 3, name, "No space left")
        left = os.listdir(out)
        assert {file for file in files if any(entry.startswith(file) for entry in left)} == files - lost, (name, left)
        if "summary.json" not in lost:
            assert state_hash(out) == state_hash(whole)
            assert summary(out)["finished"]
        if "results.h5" not in lost:
            assert np.array_equal(history(out)["time"], history(whole)["time"])


@fact
def the_series_of_many_snapshots_is_not_written_anew_for_each(folder):
    out, record = os.path.join(folder, "out"), os.path.join(folder, "record")
    expect(faulty("run", LATTICE, "--out", out, "--quiet", "--set", "output.snapshots=300", "--set", "time.end=0.8 ms",
                  record=record), 0)
    names = [name for name in os.listdir(out) if re.fullmatch(r"particles_\d+\.hdf", name)]
    written = sum(kind == "rename" and arguments[1].endswith("particles.hdf.series")
                  for kind, arguments, _ in recorded(record))
    assert len(names) > 250, len(names)
    assert written < 64 + 60, written  # each of the first 64 calls, then every thirty-second
    assert [name for name, _ in series(out)] == sorted(names)


# --- memory ------------------------------------------------------------------------------------------------

def allocations(out, *arguments):
    """The number of calls that the program makes; those of libraries are not counted."""
    file = out + ".count"
    expect(faulty(*arguments, "--out", out, "--quiet", "--threads", 2, count=file), 0)
    return int(open(file).read())


def out_of_memory(folder, arguments, numbers, all_later=""):
    out, without_status = os.path.join(folder, "out"), 0
    for number in numbers(allocations(out, *arguments)):
        shutil.rmtree(out)
        os.mkdir(out)
        done = faulty(*arguments, "--out", out, "--quiet", "--threads", 2, alloc=f"{number}{all_later}")
        names = os.listdir(out)
        assert not [name for name in names if name.endswith(".tmp")], (number, names)
        if done.returncode == 0 and "summary.json" in names:
            without_status += 1  # a status file that cannot be written has no effect; it takes some twenty allocations
            continue
        assert done.returncode == 4 and "out of memory" in done.stderr, (number, done.returncode, done.stderr)
        assert "summary.json" not in names, (number, "a folder that looks finished")
    assert without_status <= 12, without_status


SMALL = ("run", LATTICE, "--set", "time.end=0.05 ms", "--set", "output.snapshots=1", "--set", "output.history_rows=5")


@fact
def allocations_of_the_setup_may_fail(folder):
    # There are some 260 allocations: the test makes the first of them fail (options, scene, threads), and
    # every thirteenth of the lists.
    out_of_memory(folder, SMALL, lambda count: [*range(1, 61), *range(61, 300, 13)])


@fact
def allocations_of_steps_and_outputs_may_fail(folder):
    out_of_memory(folder, SMALL, lambda count: range(300, count + 1, 19))


STAGED = """dimension: 2
specimen: {lattice: {kind: hexagonal, radius: 1 mm, cells: [3, 3]}}
materials: [{name: m, density: 2000, normal_stiffness: 1e6, kratio: 2}]
law: {stiffness: uniform}
walls:
- {name: floor, point: [0, -1 mm, 0], normal: [0, 1, 0], stiffness: 1e6}
- {name: lid, point: [0, 9.7 mm, 0], normal: [0, -1, 0], stiffness: 1e6}
test: {kind: compression, axis: y, lower: floor, upper: lid, length: 10.7 mm, area: 6 mm2}
time: {end: 0.1 ms}
stages:
- {name: wait, end: {steps: 2}}
- {name: load, walls: {lid: {motion: {vy: -1 mm/s}}}}
"""


@fact
def allocations_of_the_readings_of_stages_may_fail(folder):
    # Some of the last calls fail, in pairs.
    scene = write_scene(folder, STAGED)
    out_of_memory(folder, ("run", scene), lambda count: range(count - 80, count + 1, 2))


@fact
def memory_may_run_out_for_good_at_any_time(folder):
    out_of_memory(folder, SMALL, lambda count: range(1, count + 1, 29), "+")


@fact
def allocations_of_a_packing_may_fail(folder):
    body = write_scene(folder, "specimen: {cylinder: {diameter: 20 mm, height: 30 mm}, particles: 60}\n")
    out_of_memory(folder, ("pack", body), lambda count: range(1, count + 1, 23))


CONVERTING = ("run", os.path.join(SCENES, "../../scenes/bending-adaptive.yaml"), "--set", "time.end=0.003 ms",
              "--set", "specimen.mean_radius=1.4 mm", "--set", "output.history_rows=5", "--set", "output.snapshots=1")


@fact
def allocations_of_measured_steps_of_zones_may_fail(folder):
    # The allocations between the set-up and the final files, among them those of the mean stress of zones. A few
    # failures have no effect, because the program has an alternative.
    out, codes = os.path.join(folder, "out"), {}
    for number in range(1000, allocations(out, *CONVERTING) - 250, 199):
        shutil.rmtree(out)
        os.mkdir(out)
        done = faulty(*CONVERTING, "--out", out, "--quiet", "--threads", 1, alloc=number)
        codes.setdefault(done.returncode, []).append(number)
    assert set(codes) <= {0, 4} and len(codes.get(0, ())) < 3 < len(codes[4]), codes


TRIAXIAL = ("run", os.path.join(SCENES, "../../scenes/triaxial.yaml"), "--set", "time.end=0.003 ms",
            "--set", "specimen.particles=60", "--set", "output.history_rows=5", "--set", "output.snapshots=1")


@fact
def allocations_of_the_reading_of_stages_may_fail(folder):
    # The scene is read first; its stages are read whole, one after the other.
    out_of_memory(folder, TRIAXIAL, lambda count: range(1, 400, 7))


@fact
def a_library_that_reads_the_scene_or_units_may_lack_memory(folder):
    # Memory fails permanently, so that libraries that continue with half of their data cannot give a valid result.
    # Some libraries allocate thousands of times for the units; a crash within them is not an error of gneiss.
    count = os.path.join(folder, "count")
    expect(faulty("check", LATTICE, all=1, count=count), 0)
    codes = {}
    for number in range(200, int(open(count).read()), 997):
        done = faulty("check", LATTICE, "--threads", 1, all=1, alloc=f"{number}")
        codes.setdefault(done.returncode, []).append(number)
        assert done.returncode != 2, (number, done.stderr)
    assert len(codes.get(4, ())) > 10, codes


@fact
def memory_that_runs_out_within_a_library_is_an_error_and_no_crash(folder):
    if "detect_leaks=1" in LEAK_OPTIONS:
        raise Skip("sanitizers take memory of their own")

    def code_within(limit):
        out = os.path.join(folder, "out")
        shutil.rmtree(out, ignore_errors=True)
        return gneiss(*SMALL, "--out", out, "--quiet", "--threads", 1, environment={"GNEISS_CACHE": "off"},
                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit))).returncode

    enough = 20 * MB
    while code_within(enough):
        enough += 4 * MB
    for least in range(enough - 4 * MB, enough, MB // 2):
        if not code_within(least):
            break
    codes = {limit: code_within(limit) for limit in range(least - 2 * MB, least, MB // 32)}
    assert set(codes.values()) <= {0, 4}, codes


# --- threads -------------------------------------------------------------------------------------------------

@fact
def more_threads_than_the_system_gives_are_refused_with_their_number(folder):
    few = dict(thread=3)
    done = faulty(*SMALL, "--out", folder, "--quiet", "--threads", 8, **few)
    expect(done, 2, "at most 3 threads.*found 8.*--threads")
    expect(faulty(*SMALL, "--out", folder, "--quiet", "--threads", 2, **few), 0)
    body = write_scene(folder, "specimen: {cylinder: {diameter: 20 mm, height: 30 mm}, particles: 60}\n")
    done = faulty("pack", body, "--out", os.path.join(folder, "pack"), "--threads", 8, **few)
    expect(done, 2, "at most 3 threads.*found 8.*--threads")


@fact
def threads_without_memory_for_their_stacks_are_refused_as_a_lack_of_memory(folder):
    if "detect_leaks=1" in LEAK_OPTIONS:
        raise Skip("sanitizers take memory of their own")

    def limited():
        resource.setrlimit(resource.RLIMIT_STACK, (256 * MB, 256 * MB))
        resource.setrlimit(resource.RLIMIT_AS, (1000 * MB, 1000 * MB))

    expect(gneiss(*SMALL, "--out", folder, "--quiet", "--threads", 8, preexec_fn=limited), 4, "--threads")


# --- power loss ----------------------------------------------------------------------------------------------

class Disk:
    """A folder as POSIX allows it to be after a loss of power: each file has its synced content and any part of later
    writes, the folder its synced names and any of the names created, changed and removed since."""

    def __init__(self):
        self.files, self.serial, self.names, self.durable, self.pending = [], {}, {}, {}, []

    def entry(self, path, file):
        self.pending.append((path, file))
        if file is None:
            self.names.pop(path, None)
        else:
            self.names[path] = file

    def apply(self, kind, arguments, data):
        if kind == "open":
            number, how, path = arguments
            if how == "2":
                self.serial[number] = path
                return
            if path not in self.names:
                self.files.append([bytearray(), b""])
                self.entry(path, len(self.files) - 1)
            self.serial[number] = self.names[path]
        elif kind in ("write", "cut"):
            content = self.files[self.serial[arguments[0]]][0]
            if kind == "write":
                content += data
            else:
                del content[int(arguments[1]):]
        elif kind == "sync" and isinstance(self.serial.get(arguments[0]), str):
            folder = self.serial[arguments[0]]
            self.settle([op for op in self.pending if os.path.dirname(op[0]) == folder])
            self.pending = [op for op in self.pending if os.path.dirname(op[0]) != folder]
        elif kind == "sync":
            file = self.files[self.serial[arguments[0]]]
            file[1] = bytes(file[0])
        elif kind == "rename" and arguments[0] in self.names:
            self.entry(arguments[1], self.names[arguments[0]])
            self.entry(arguments[0], None)
        elif kind == "unlink" and arguments[0] in self.names:
            self.entry(arguments[0], None)

    def settle(self, operations):
        for path, file in operations:
            if file is None:
                self.durable.pop(path, None)
            else:
                self.durable[path] = file

    def has_checkpoint(self):
        return any(re.search(r"checkpoint_\d+\.h5$", path) for path in self.durable)

    def after_power_loss(self, pick, folder):
        """Writes one of the possible states."""
        names = dict(self.durable)
        for path, file in self.pending:
            if pick.random() < 0.5:
                names.pop(path, None) if file is None else names.update({path: file})
        for path, file in names.items():
            written, synced = self.files[file]
            content = bytes(written) if pick.random() < 0.3 else synced
            if content == synced and len(written) > len(synced):
                more = pick.randrange(len(written) - len(synced))
                content += pick.choice((bytes(more), bytes(written[len(synced):len(synced) + more])))
            with open(os.path.join(folder, os.path.basename(path)), "wb") as out:
                out.write(content)


def recorded(path):
    """(kind, arguments, data) in order."""
    events, data = [], open(path, "rb").read()
    while data:
        line, data = data.split(b"\n", 1)
        kind, *arguments = line.decode().split("\t")
        size = int(arguments[1]) if kind == "write" else 0
        events.append((kind, arguments, data[:size]))
        data = data[size:]
    return events


@fact
def after_a_power_loss_at_any_moment_a_run_goes_on_from_its_last_checkpoint(folder):
    whole, again, log = (os.path.join(folder, name) for name in ("whole", "again", "log"))
    more = "--set", "output.snapshots=6"
    done = faulty("run", LATTICE, "--out", whole, "--quiet", "--threads", 1, *more, "--set", "output.checkpoint=0.1 ms",
                  record=log)
    expect(done, 0)
    wanted, disk, pick, resumed = state_hash(whole), Disk(), random.Random(18), 0
    events = recorded(log)
    moments = set(pick.sample(range(len(events)), 40))
    assert sum(kind == "rename" and "checkpoint" in arguments[1] for kind, arguments, _ in events) > 5
    for moment, event in enumerate(events):
        disk.apply(*event)
        if moment not in moments:
            continue
        os.mkdir(again)
        disk.after_power_loss(pick, again)
        done = gneiss("resume", again, "--quiet", "--threads", 1, "--set", "output.checkpoint=off")
        if disk.has_checkpoint():
            expect(done, 0)
            assert state_hash(again) == wanted, f"event {moment}: another state"
            assert len(series(again)) >= 6 and all(os.path.exists(os.path.join(again, name)) for name, _ in series(again))
            resumed += 1
        else:
            assert done.returncode in (0, 2), (moment, done.returncode, done.stderr)
        shutil.rmtree(again)
    assert resumed > 20, f"only {resumed} moments had a checkpoint"


if __name__ == "__main__":
    sys.exit(main())
