"""Equal bits on any threads and instruction sets, after interruptions and kills. Speaks TAP. It runs no code that test_run.py does not, so that
sanitizers leave it out."""
import signal

from run_reference import *  # noqa: F403


@fact
def a_rerun_gives_the_same_bits(folder):
    run(UCS, folder, "--threads", 1)
    check_same(folder, reference())


@fact
def two_threads_give_the_same_bits_as_one(folder):
    same_with_threads(folder, 2)


@fact
def four_threads_give_the_same_bits_as_one(folder):
    same_with_threads(folder, 4)


@fact
def threads_that_the_openmp_library_does_not_give_change_no_bit(folder):
    for limit, asked in ((1, 2), (2, 4)):
        out = os.path.join(folder, str(limit))
        done = run(UCS, out, "--threads", asked, environment={"OMP_THREAD_LIMIT": str(limit)})
        expect(done, 0, f"run.threads: {asked} requested, the OpenMP library gives {limit}")
        check_same(out, reference())


@fact
def particles_without_contacts_move_when_fewer_threads_come_than_asked(folder):
    loose = ("--set", "specimen.lattice.spacing=1.5", "--set", "specimen.lattice.cells=[12, 12, 12]",
             "--set", "walls.top.point=[0, 0, 1 m]", "--set", "gravity=[0, 0, -9.81]")
    for limit in (1, 2):
        run(LATTICE, os.path.join(folder, str(limit)), *loose, "--threads", 2, environment={"OMP_THREAD_LIMIT": str(limit)})
    assert state_hash(os.path.join(folder, "1")) == state_hash(os.path.join(folder, "2"))


@fact
def threads_that_follow_the_load_of_the_machine_change_no_bit(folder):
    run(UCS, folder, "--threads", 4, environment={"OMP_DYNAMIC": "true"})
    check_same(folder, reference())


def same_with_isa(folder, isa):
    """Only energies are summed over lanes, in an order that depends on the width; the state is the same for all."""
    if not isas()[isa]:
        raise Skip(f"no {isa} on this machine")
    run(UCS, folder, "--threads", 2, environment={"GNEISS_ISA": isa})
    assert summary(folder)["isa"] == isa
    assert state_hash(folder) == state_hash(reference())


def hash_fact(isa):
    def check(folder):
        same_with_isa(folder, isa)

    check.__name__ = f"{isa}_kernels_give_the_same_hash"
    return check


for name in isas():
    fact(hash_fact(name))


@fact
def how_often_is_written_does_not_change_the_state(folder):
    run(UCS, folder, "--threads", 2, "--set", "output.snapshots=0", "--set", "output.history_rows=7",
        "--set", "output.checkpoint=10 ms")
    assert state_hash(folder) == state_hash(reference())


@fact
def mixed_precision_agrees_with_double_until_something_breaks(folder):
    # These runs have no background damping: its direction at rest depends on rounding, so that it differs from the
    # first step on.
    undamped = ("--set", "damping.background.model=none", "--set", "damping.background.coefficient=0")
    stress = {}
    for precision in ("double", "mixed"):
        out = os.path.join(folder, precision)
        run(UCS, out, "--precision", precision, *undamped)
        rows = history(out)
        whole = next(k for k, n in enumerate(rows["broken_tension"] + rows["broken_shear"]) if n)
        stress[precision] = rows["stress"][:whole]
    assert len(stress["double"]) == len(stress["mixed"]) > 50
    error = max(abs(stress["double"] - stress["mixed"])) / max(abs(stress["double"]))
    assert 0 < error < 1e-6, error


@fact
def raised_masses_resume_to_the_same_bits_and_say_what_was_added(folder):
    raised = ("--set", "time.mass_scaling.factor=1.5", "--precision", "mixed")
    straight, broken = os.path.join(folder, "straight"), os.path.join(folder, "broken")
    run(UCS, straight, "--threads", 2, *raised)
    said, rows = summary(straight)["mass_scaling"], history(straight)
    assert abs(said["dt_wanted"] / said["dt_without"] - 1.5) < 1e-9 and summary(straight)["dt"] <= said["dt_wanted"]
    assert 0 < said["added_share"] < 0.2 and said["largest_factor"] > 1 and 0 < said["particles"] < 2000
    # Each particle has the same share of its energy in added mass: the total is within their range.
    assert max(rows["added_kinetic"]) < 1 - 1 / said["largest_factor"] and min(rows["added_kinetic"]) >= 0
    assert abs(summary(straight)["energy_residual"]) < 1e-3
    with results(straight) as file:
        share = file.attrs["added_mass"][()] / file.attrs["own_mass"][()]
        assert abs(share / said["added_share"] - 1) < 1e-12
    expect(stop_at_snapshot(broken, 3, signal.SIGINT, "--threads", 1, *raised), 6)
    resume(broken, "--threads", 2)
    check_same(broken, straight)


@fact
def ctrl_c_writes_a_checkpoint_and_resume_gives_the_same_bits(folder):
    interrupted_and_resumed(folder, signal.SIGINT)


@fact
def sigterm_writes_a_checkpoint_and_resume_gives_the_same_bits(folder):
    interrupted_and_resumed(folder, signal.SIGTERM)


@fact
def killed_half_way_and_resumed_gives_the_same_bits(folder):
    killed_and_resumed(folder, 3)


@fact
def killed_late_and_resumed_gives_the_same_bits(folder):
    killed_and_resumed(folder, 5)


if __name__ == "__main__":
    sys.exit(main())
