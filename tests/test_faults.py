"""Calls of the system that fail, one at a time (tests/faults.c, the second argument). Speaks TAP."""
from program import *  # noqa: F403

SHIM = os.path.abspath(sys.argv[2])


def faulty(*arguments, **faults):
    """One call with faults: open="NAME:ERRNO" is GNEISS_FAULT_OPEN."""
    named = {"GNEISS_RECORD" if name == "record" else "GNEISS_FAULT_" + name.upper(): str(value)
             for name, value in faults.items()}
    return gneiss(*arguments, environment={"LD_PRELOAD": SHIM, "GNEISS_CACHE": "off", **named})


def contents(folder):
    return {name: open(os.path.join(folder, name), "rb").read() for name in sorted(os.listdir(folder))}


# --- checkpoints that cannot be read now -------------------------------------------------------------------

def two_checkpoints(folder):
    """A run with two checkpoints; their names, the newer last."""
    run(LATTICE, folder, "--set", "time.end=0.2 ms")
    older = checkpoints(folder)[0]
    shutil.copy(os.path.join(folder, older), os.path.join(folder, "kept"))
    resume(folder, "--set", "time.end=0.3 ms")
    os.rename(os.path.join(folder, "kept"), os.path.join(folder, older))
    return checkpoints(folder)


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
def a_snapshot_that_meets_a_full_disk_is_followed_by_a_checkpoint(folder):
    name, step = third_snapshot(folder)
    out = os.path.join(folder, "out")
    done = faulty("run", LATTICE, "--out", out, "--quiet", "--set", "output.snapshots=5", write=f"{name}:28")
    expect(done, 3, name, "No space left", f"at step {step}; the checkpoint of step {step} stands: gneiss resume")
    assert checkpoints(out) == [f"checkpoint_{step:010d}.h5"]
    resume(out)
    assert state_hash(out) == state_hash(os.path.join(folder, "whole"))
    assert len(series(out, "bonds")) == len(series(os.path.join(folder, "whole"), "bonds"))


@fact
def a_full_disk_without_room_for_a_checkpoint_says_that_there_is_none(folder):
    done = faulty("run", LATTICE, "--out", folder, "--quiet", write=".hdf.tmp:28", open="checkpoint:28")
    expect(done, 3, "No space left", "no checkpoint of it", "there is no checkpoint")
    assert not os.listdir(folder), os.listdir(folder)


@fact
def a_full_disk_at_a_later_snapshot_names_the_earlier_checkpoint(folder):
    run(LATTICE, folder, "--set", "time.end=0.2 ms")
    (earlier,) = checkpoints(folder)
    done = faulty("resume", folder, "--quiet", "--set", "time.end=0.4 ms",
                  write="particles_:28", open="h5.tmp:28")
    expect(done, 3, f"the checkpoint of step {int(earlier[11:21])} stands")
    assert checkpoints(folder) == [earlier]


if __name__ == "__main__":
    sys.exit(main())
