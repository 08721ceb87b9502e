"""Files that were damaged, changed or made by another program: each is refused or computed again, and named. Speaks TAP."""
import csv
import glob
import random

from program import *  # noqa: F403

FLOW = os.path.join(SCENES, "flow.yaml")
ELEMENTS = os.path.join(SCENES, "elements.yaml")
CHANGED = "damaged or was changed"


def change(path, name, place, value, anew):
    """One value of a data set; with `anew` the digests are updated, as if the program had written it."""
    with h5py.File(path, "r+") as file:
        file[name][place] = value
        if anew:
            report_digest.seal(file)


def interrupted(folder, scene=LATTICE, end="0.1 ms"):
    """The only checkpoint of a run that can continue."""
    run(scene, folder, "--set", f"time.end={end}", "--set", "output.snapshots=0", "--threads", 1)
    (name,) = checkpoints(folder)
    return os.path.join(folder, name)


def go_on(folder, end="0.12 ms"):
    return gneiss("resume", folder, "--quiet", "--threads", 1, "--set", f"time.end={end}", timeout=60)


# --- checkpoints -------------------------------------------------------------------------------------------

@fact
def digests_of_the_program_and_of_the_report_are_the_same(folder):
    interrupted(folder, ELEMENTS, "0.05 ms")
    for path in glob.glob(os.path.join(folder, "*.h5")):
        with h5py.File(path) as file:
            assert report_digest.is_sealed(file) and report_digest.changed(file) == []


@fact
def a_value_of_a_checkpoint_that_was_changed_is_named(folder):
    checkpoint = interrupted(folder)
    whole = open(checkpoint, "rb").read()
    for name, place in (("particles/group", 0), ("particles/pos", (3, 1)), ("bonds/rn", 2), ("run/world_ctx_time", 0),
                        ("run/world_dem_limit_sharp", 0), ("history/time", 4), ("arrays/walls", (0, 2)), ("near", (0, 0))):
        with h5py.File(checkpoint) as file:
            value = file[name][place]
        change(checkpoint, name, place, value + 1, anew=False)
        expect(go_on(folder), 2, f"data set {name} is {CHANGED}")
        with open(checkpoint, "wb") as file:
            file.write(whole)
    with h5py.File(checkpoint, "r+") as file:
        file["particles"].attrs["count"] = file["particles"].attrs["count"] - 1
    expect(go_on(folder), 2, "attributes of particles are damaged or were changed")
    for name in ("scene", "extra", "/"):
        with open(checkpoint, "wb") as file:
            file.write(whole)
        with h5py.File(checkpoint, "r+") as file:
            if name == "extra":
                file["extra"] = 1.0
            else:
                del file[name].attrs["digest_of_attributes"]
                if name == "/":
                    file.attrs["digest_of_attributes"] = "text"
        expect(go_on(folder), 2, f"attributes of {name} cannot be read")
    with open(checkpoint, "wb") as file:
        file.write(whole)
    with h5py.File(checkpoint, "r+") as file:
        del file["run/world_ledger_energy"]
    expect(go_on(folder), 2, "one more or one less")


OUT_OF_RANGE = (("particles/group", 0, -1), ("particles/group", 0, (1 << 31) - 1), ("particles/id", 1, 0), ("particles/material", 0, 5),
                ("particles/vel", (2, 0), np.inf), ("particles/vel", (2, 1), 1e12), ("particles/vel", (2, 3), -1.0),
                ("particles/pos", (1, 3), -0.5), ("bonds/i", 0, -1),
                ("bonds/kn", 0, -1.0), ("bonds/cause", 0, 9), ("run/world_dem_limit_sharp", 0, -1.0), ("run/world_ctx_step", 0, -7),
                ("run/world_dem_ids", 0, 1 << 40), ("run/world_ctx_dt", 0, 0.0), ("run/world_ctx_time", 0, np.nan), ("near", (0, 0), -1.0))


@fact
def values_out_of_their_range_are_named_even_where_the_digest_fits(folder):
    checkpoint = interrupted(folder)
    whole = open(checkpoint, "rb").read()
    for name, place, value in OUT_OF_RANGE:
        change(checkpoint, name, place, value, anew=True)
        done = expect(go_on(folder), 2, os.path.basename(checkpoint) + ": .*expected")
        assert CHANGED not in done.stderr, done.stderr
        with open(checkpoint, "wb") as file:
            file.write(whole)


@fact
def steps_and_rates_of_a_checkpoint_far_from_those_of_its_run_are_named(folder):
    checkpoint = interrupted(folder)
    whole = open(checkpoint, "rb").read()
    with h5py.File(checkpoint) as file:
        step = file["run/world_ctx_dt"][0]
    for name, value, pattern in (("world_ctx_dt", 1e-6 * step, "at least .* of the mean step so far, found"),
                                 ("world_dem_surface_rate", 1e12, "a rate of at most .* found 1e"),
                                 ("world_dem_vertex_rate", 1e12, "a rate of at most .* found 1e")):
        change(checkpoint, "run/" + name, 0, value, anew=True)
        expect(go_on(folder), 2, rf"{os.path.basename(checkpoint)}: run/{name}: expected {pattern}")
        with open(checkpoint, "wb") as file:
            file.write(whole)
    expect(go_on(folder), 0)


@fact
def a_checkpoint_of_another_run_is_not_continued(folder):
    first, second = (os.path.join(folder, name) for name in "ab")
    for other in (("--set", "materials.block.friction=0.1"), ("--set", "run.seed=7"), None):
        for out in (first, second):
            shutil.rmtree(out, ignore_errors=True)
        shutil.copy(LATTICE, os.path.join(folder, "other.yaml"))
        run(LATTICE, first, "--set", "time.end=0.05 ms", "--threads", 1)
        run(LATTICE if other else os.path.join(folder, "other.yaml"), second, "--set", "time.end=0.1 ms", "--threads", 1, *(other or ()))
        (own,), (checkpoint,) = checkpoints(first), checkpoints(second)
        assert checkpoint > own
        shutil.copy(os.path.join(second, checkpoint), first)
        before = {name: open(os.path.join(first, name), "rb").read() for name in os.listdir(first)}
        expect(gneiss("resume", first, "--quiet"), 2, rf"{checkpoint}: expected a checkpoint of the run that wrote .*results.h5, found one of another run")
        os.remove(os.path.join(first, "results.h5"))
        expect(gneiss("resume", first, "--quiet"), 2, rf"{checkpoint}: expected a checkpoint of the run that wrote .*{own}, found one of another run")
        del before["results.h5"]
        assert before == {name: open(os.path.join(first, name), "rb").read() for name in os.listdir(first)}
        os.remove(os.path.join(first, checkpoint))
        resume(first, "--set", "time.end=0.06 ms", "--set", "output.history_rows=50", "--set", "run.residual_limit=0.2")


@fact
def results_of_another_run_are_neither_reported_nor_resumed_over(folder):
    first, second = (os.path.join(folder, name) for name in "ab")
    for out, friction in ((first, 0.1), (second, 0.3)):
        run(LATTICE, out, "--set", "time.end=0.05 ms", "--set", "output.snapshots=0", "--set", f"materials.block.friction={friction}")
    shutil.copy(os.path.join(second, "results.h5"), first)
    expect(gneiss("report", first), 2, rf"summary.json: expected the summary of the run that results.h5 is of \(state_hash {state_hash(second)}\), "
                                       rf"found that of another run \({state_hash(first)}\)")
    expect(gneiss("resume", first, "--quiet"), 2, "results.h5, found one of another run")
    os.remove(os.path.join(first, "results.h5"))
    resume(first)
    expect(gneiss("report", first), 0)


EXTREMES = {"f": (-1.0, 0.0, np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-300, 3e9, -7.5),
            "i": (-1, 0, 1, 1000, -(1 << 31), (1 << 31) - 1, -(1 << 63), (1 << 63) - 1), "u": (0, 1, 7, 255)}
# Stiffnesses and masses of any size are possible, and decide how many steps a run takes.
MATTER = re.compile(r"(kn|kt|cn|lag|fade|crush|lambda|mu|gradient\d|tau|volume)$|arrays/(bodies|walls)$")


def edits(checkpoint, pick, count):
    """[(data set, index, value)] of values that differ from the stored ones."""
    with h5py.File(checkpoint) as file:
        names = []
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) and item.size
                        and item.dtype.kind in EXTREMES and not MATTER.search(name) else None)
        found = []
        while len(found) < count:
            data = file[pick.choice(names)]
            place = tuple(pick.randrange(n) for n in data.shape)
            fitting = [v for v in EXTREMES[data.dtype.kind] if data.dtype.kind == "f"
                       or np.iinfo(data.dtype).min <= v <= np.iinfo(data.dtype).max]
            value = pick.choice(fitting)
            if data[place] != value and not (value != value and data[place] != data[place]):
                found.append((data.name[1:], place, value))
    return found


def try_values(folder, scene, end, later, count, seed):
    """Makes every edit twice: with the old digest, and with new digests, so that range checks are tested as well.
    Errors of memory access are found under a sanitizer; without one a half of the edits is made."""
    count = count if SANITIZED else count // 2
    checkpoint = interrupted(folder, scene, end)
    whole = open(checkpoint, "rb").read()
    for name, place, value in edits(checkpoint, random.Random(seed), count):
        for anew in (False, True):
            with open(checkpoint, "wb") as file:
                file.write(whole)
            change(checkpoint, name, place, value, anew)
            done = go_on(folder, later)
            said = f"{name}{list(place)} = {value}: exit code {done.returncode}: {done.stderr.strip()[:300]}"
            if anew:  # the edit may result in a valid state, or in one that fails later
                assert done.returncode in (0, 2, 5), said
            else:
                assert done.returncode == 2 and f"{name} is {CHANGED}" in done.stderr, said
            for left in os.listdir(folder):
                if not os.path.samefile(os.path.join(folder, left), checkpoint):
                    os.remove(os.path.join(folder, left))
            assert os.path.exists(checkpoint)


@fact
def edited_values_of_particles_and_bonds_never_crash_or_hang(folder):
    try_values(folder, LATTICE, "0.1 ms", "0.12 ms", 20, 23)


@fact
def edited_values_of_elements_never_crash_or_hang(folder):
    try_values(folder, ELEMENTS, "0.05 ms", "0.055 ms", 12, 24)


@fact
def edited_values_of_grains_that_flow_never_crash_or_hang(folder):
    try_values(folder, FLOW, "0.5 ms", "0.52 ms", 12, 25)


# --- another run's particles, packings -----------------------------------------------------------------------

FROM = """dimension: {dimension}
specimen: {{from: {out}, material: rock}}
materials: [{{name: rock, density: 2500, normal_stiffness: 1e6, kratio: 2}}]
law: {{stiffness: uniform}}
time: {{end: 0.01 ms}}
"""


def scene_from(folder, out, dimension=2):
    return write_scene(folder, FROM.format(out=out, dimension=dimension), "from.yaml")


def dimension_of(out):
    with results(out) as file:
        return int(file.attrs["dimension"])


@fact
def results_that_were_changed_are_not_taken_as_a_specimen(folder):
    out = os.path.join(folder, "out")
    run(LATTICE, out, "--set", "time.end=0.02 ms", "--set", "output.snapshots=0")
    scene = scene_from(folder, out, dimension_of(out))
    expect(gneiss("check", scene), 0)
    path = os.path.join(out, "results.h5")
    whole = open(path, "rb").read()
    for name, place, value in (("particles/radius", 2, -1.0), ("particles/radius", 0, 1000.0), ("particles/radius", 0, 1e-9),
                               ("particles/position", (1, 0), np.nan), ("particles/velocity", (0, 1), 1e30)):
        for anew, pattern in ((False, CHANGED), (True, "expected")):
            change(path, name, place, value, anew)
            expect(gneiss("check", scene), 2, rf"from.yaml:2:\d+: specimen.from: .*{name}.*{pattern}|specimen.from: .*{pattern}.*{name}")
            with open(path, "wb") as file:
                file.write(whole)


@fact
def nothing_is_read_through_links_into_other_files(folder):
    out = os.path.join(folder, "out")
    run(LATTICE, out, "--set", "time.end=0.02 ms", "--set", "output.snapshots=0")
    path, elsewhere = os.path.join(out, "results.h5"), os.path.join(folder, "elsewhere.h5")
    shutil.copy(path, elsewhere)
    scene = scene_from(folder, out, dimension_of(out))
    with h5py.File(path, "r") as file:
        radius = file["particles/radius"][:]
    radius.tofile(os.path.join(folder, "raw"))
    for kind in ("external", "soft", "raw"):
        shutil.copy(elsewhere, path)
        with h5py.File(path, "r+") as file:
            del file["particles/radius"]
            if kind == "raw":
                file.create_dataset("particles/radius", shape=radius.shape, dtype="<f8",
                                    external=[(os.path.join(folder, "raw"), 0, radius.nbytes)])
            else:
                file["particles/radius"] = (h5py.ExternalLink(elsewhere, "particles/radius") if kind == "external"
                                            else h5py.SoftLink("/particles/other"))
                file["particles/other"] = radius
            for name in (report_digest.OF_ATTRIBUTES, report_digest.OF_NAMES):
                del file.attrs[name]
        expect(gneiss("check", scene), 2, "particles/radius.*(is missing|another file)")
        expect(gneiss("report", out), 2, r"particles/radius \((a link to elsewhere|stored in another file)\)")


SPECIMEN = "dimension: 3\nspecimen:\n  cylinder: {diameter: 23 mm, height: 30 mm}\n  particles: 60\nrun: {seed: %d}\n"


@fact
def a_packing_in_the_cache_that_was_changed_is_made_again(folder):
    body, cache = write_scene(folder, SPECIMEN % 1), os.path.join(folder, "cache")
    pack = lambda name: gneiss("pack", body, "--out", os.path.join(folder, name), environment={"GNEISS_CACHE": cache})
    expect(pack("first"), 0)
    (kept,) = glob.glob(os.path.join(cache, "*.h5"))
    for anew, pattern in ((False, "data set sphere is " + CHANGED), (True, "data set sphere: expected")):
        change(kept, "sphere", (5, 3), -1.0, anew)
        expect(pack("second"), 0, "warning: .*not used: .*" + pattern)
        assert open(os.path.join(folder, "first", "packing.txt")).readlines()[1:] == \
            open(os.path.join(folder, "second", "packing.txt")).readlines()[1:]


@fact
def a_packing_that_ends_between_its_files_leaves_none_that_a_specimen_is_taken_from(folder):
    out = os.path.join(folder, "out")
    for seed in (1, 2):
        done = gneiss("pack", write_scene(folder, SPECIMEN % seed), "--out", out, environment={"GNEISS_CACHE": "off"})
        expect(done, 0 if seed == 1 else 3)
        if seed == 1:
            before = open(os.path.join(out, "packing.txt")).read()
            os.mkdir(os.path.join(out, "packing.h5.tmp"))  # the file cannot be written
    assert open(os.path.join(out, "packing.txt")).read() != before
    expect(gneiss("check", scene_from(folder, out, 3)), 2, "specimen.from: ")


# --- sweeps ----------------------------------------------------------------------------------------------------

SWEEP = {"scene": LATTICE, "parameters": {"materials.block.friction": [0.1, 0.2, 0.3]}}
QUICK = ("--set", "time.end=0.1 ms", "--set", "output.snapshots=0", "--set", "output.history_rows=30")


def sweep(folder, *arguments, code=0):
    """(message, rows of sweep.csv, folder) of one call."""
    out = os.path.join(folder, "out")
    done = expect(gneiss("sweep", write_scene(folder, SWEEP, "sweep.yaml"), "--out", out, "--quiet", *QUICK, *arguments), code)
    with open(os.path.join(out, "sweep.csv"), newline="") as file:
        return done, list(csv.DictReader(file)), out


def reported(rows):
    return [{key: value for key, value in row.items() if not key.startswith("seconds")} for row in rows]


def compute_again(folder, spoil, pattern):
    """The second run of a sweep is damaged: it is named, counted as missing, and computed again."""
    _, before, out = sweep(folder)
    first, second = (os.path.join(out, before[k]["folder"]) for k in (0, 1))
    spoil(first, second)
    done, rows, _ = sweep(folder, "--collect")
    assert re.search(r"lost: run 2 .*" + pattern, done.stdout), done.stdout
    assert rows[1]["status"] != "done" and rows[1]["largest_stress [Pa]"] == "" and re.search(pattern, rows[1]["message"])
    done, rows, _ = sweep(folder)
    assert re.search(r"warning: run 2 \(.*\) lost: .*" + pattern, done.stderr), done.stderr
    assert reported(rows) == reported(before)


@fact
def a_reading_of_a_run_of_a_sweep_that_was_changed_is_computed_again(folder):
    compute_again(folder, lambda first, second: change(os.path.join(second, "results.h5"), "readings/largest_stress", 0, 1.0, False),
                  "data set readings/largest_stress is " + CHANGED)


@plain_fact
def particles_of_a_run_of_a_sweep_that_were_changed_or_damaged_are_computed_again(folder):
    def flip(first, second):
        path = os.path.join(second, "results.h5")
        with h5py.File(path) as file:
            offset = file["particles/position"].id.get_chunk_info(0).byte_offset
        with open(path, "r+b") as file:
            file.seek(offset + 3)
            byte = file.read(1)
            file.seek(offset + 3)
            file.write(bytes([byte[0] ^ 1]))
    compute_again(folder, lambda first, second: change(os.path.join(second, "results.h5"), "particles/position", (0, 0), 1.0, False),
                  "data set particles/position is " + CHANGED)
    shutil.rmtree(os.path.join(folder, "out"))
    compute_again(folder, flip, "particles/position is damaged")


@fact
def a_damaged_reading_of_a_run_of_a_sweep_is_no_empty_cell(folder):
    def spoil(first, second):
        path = os.path.join(second, "results.h5")
        with h5py.File(path) as file:
            data = file["history/strain"]
            offset = data.id.get_chunk_info(0).byte_offset if data.chunks else None
        assert offset
        with open(path, "r+b") as file:
            file.seek(offset + 3)
            byte = file.read(1)
            file.seek(offset + 3)
            file.write(bytes([byte[0] ^ 1]))
    global QUICK
    few, QUICK = QUICK, (*QUICK[:4], "--set", "output.history_rows=200")  # more than fit into a header
    try:
        compute_again(folder, spoil, "history/strain is damaged")
    finally:
        QUICK = few


@plain_fact
def results_of_another_run_are_not_those_of_a_run_of_a_sweep(folder):
    compute_again(folder, lambda first, second: shutil.copy(os.path.join(first, "results.h5"), second), "belongs to another run")


@plain_fact
def other_results_of_the_same_scene_are_not_those_that_a_run_of_a_sweep_ended_with(folder):
    def spoil(first, second):
        expect(gneiss("run", os.path.join(second, "scene.yaml"), "--out", second, "--force", "--quiet", "--set", "materials.block.friction=0.9"), 0)
    compute_again(folder, spoil, "they differ from the results at the end of the run")


@fact
def an_outcome_that_was_changed_or_says_nothing_is_named_and_the_run_computed_again(folder):
    def put(text):
        def spoil(first, second):
            with open(os.path.join(second, "outcome.json"), "w") as file:
                file.write(text)
        return spoil

    def leave_out(first, second):
        path = os.path.join(second, "outcome.json")
        with open(path) as file:
            said = json.load(file)
        del said["results"]
        put(json.dumps(said))(first, second)
    for spoil, pattern in ((leave_out, "they differ from the results at the end of the run, which outcome.json does not name"),
                           (put(""), "its outcome cannot be read: .*outcome.json: expected status"),
                           (put('{"status": "do'), "its outcome cannot be read: .*outcome.json: expected status")):
        compute_again(folder, spoil, pattern)
        shutil.rmtree(os.path.join(folder, "out"))


@fact
def a_checkpoint_of_another_run_is_set_aside_by_a_sweep(folder):
    _, before, out = sweep(folder)
    first, second = (os.path.join(out, before[k]["folder"]) for k in (0, 1))
    for name in os.listdir(second):
        if name.startswith("checkpoint") or name in ("results.h5", "outcome.json"):
            os.remove(os.path.join(second, name))
    (checkpoint,) = checkpoints(first)
    shutil.copy(os.path.join(first, checkpoint), second)
    done, rows, _ = sweep(folder)
    assert re.search(r"run 2 .*lost: its checkpoint .*belongs to another run", done.stderr), done.stderr
    assert reported(rows) == reported(before)
    assert os.path.exists(os.path.join(second, checkpoint + ".damaged"))


@fact
def a_damaged_sweep_file_is_written_anew_from_the_runs(folder):
    _, before, out = sweep(folder)
    path = os.path.join(out, "sweep.h5")
    with open(path, "r+b") as file:
        file.truncate(os.path.getsize(path) // 2)
    expect(gneiss("report", out), 2, "sweep.h5: damaged or not of a sweep")
    _, rows, _ = sweep(folder)
    assert rows == before, "seconds included: nothing was computed"
    with h5py.File(path) as file:
        assert text(file.attrs["kind"]) == "sweep"


@fact
def a_sweep_follows_no_link_when_it_writes(folder):
    _, before, out = sweep(folder)
    second, victim = os.path.join(out, before[1]["folder"]), os.path.join(folder, "victim")
    os.remove(os.path.join(second, "outcome.json"))
    names = ("messages.txt", "progress.jsonl", "outcome.json", "outcome.json.tmp", "results.h5", "results.h5.tmp", "summary.json.tmp")
    for name in names:
        path = os.path.join(second, name)
        if os.path.lexists(path):
            os.remove(path)
        with open(victim, "w") as file:
            file.write("of somebody")
        os.symlink(victim, path)
    sweep(folder)
    assert open(victim).read() == "of somebody"
    shutil.move(second, os.path.join(folder, "moved"))
    os.mkdir(os.path.join(folder, "elsewhere"))
    os.symlink(os.path.join(folder, "elsewhere"), second)
    done, _, _ = sweep(folder, code=2)
    assert "expected a folder for a run, found a symbolic link" in done.stderr, done.stderr
    assert os.listdir(os.path.join(folder, "elsewhere")) == []


# --- reports and terminals ---------------------------------------------------------------------------------------

@plain_fact
def a_report_names_what_it_cannot_read_instead_of_leaving_it_out(folder):
    run(LATTICE, folder, "--set", "time.end=0.1 ms", "--set", "output.snapshots=0", "--set", "output.history_rows=200")
    path = os.path.join(folder, "results.h5")
    whole = open(path, "rb").read()
    with h5py.File(path) as file:
        offset = file["history/stress"].id.get_chunk_info(0).byte_offset
        head = h5py.h5o.get_info(file["history/strain"].id).addr
    for flipped, name in ((offset + 5, "history/stress"), (head + 12, "history/strain")):
        with open(path, "wb") as file:
            file.write(whole[:flipped] + bytes([whole[flipped] ^ 4]) + whole[flipped + 1:])
        done = expect(gneiss("report", folder), 2, rf"damaged or changed: {name} \(damaged\)")
        assert "Traceback" not in done.stderr
    with open(path, "wb") as file:
        file.write(whole)
    change(path, "readings/largest_stress", 0, 1.0, False)
    expect(gneiss("report", folder), 2, r"damaged or changed: readings/largest_stress \(changed\); .*gneiss resume")
    expect(gneiss("resume", folder, "--quiet"), 0)
    expect(gneiss("report", folder), 0)


@plain_fact
def a_report_names_the_data_set_with_invalid_indices(folder):
    for scene, end, sets in ((LATTICE, "0.05 ms", ("bonds/i", "bonds/j")), (ELEMENTS, "0.05 ms", ("elements/node",))):
        run(scene, folder, "--set", f"time.end={end}", "--set", "output.snapshots=0", "--force")
        path = os.path.join(folder, "results.h5")
        whole = open(path, "rb").read()
        for name in sets:
            for value in (100_000_000, -1):
                with h5py.File(path) as file:
                    place = (0,) * file[name].ndim
                change(path, name, place, value, anew=True)
                expect(gneiss("report", folder), 2, rf"{name}: expected numbers below \d+, found {value}")
                with open(path, "wb") as file:
                    file.write(whole)
        expect(gneiss("report", folder), 0)
        shutil.rmtree(folder)
        os.mkdir(folder)


@plain_fact
def a_report_follows_no_link_when_it_writes(folder):
    out, victim = os.path.join(folder, "out"), os.path.join(folder, "victim")
    run(LATTICE, out, "--set", "time.end=0.1 ms", "--set", "output.snapshots=0")
    os.mkdir(os.path.join(out, "report"))
    for name in ("report.html", "report.html.tmp", "report.csv", "report.csv.tmp", "report/stress_strain.png", "report/surface.png", "report/profile.png"):
        os.symlink(victim, os.path.join(out, name))  # truncated, which opening it for writing would do
    expect(gneiss("report", out), 0)
    assert not os.path.exists(victim)
    assert not os.path.islink(os.path.join(out, "report.html"))
    shutil.rmtree(os.path.join(out, "report"))
    os.mkdir(victim)
    os.symlink(victim, os.path.join(out, "report"))
    expect(gneiss("report", out), 3, "found a symbolic link")
    assert os.listdir(victim) == []


@plain_fact
def a_report_is_made_in_an_active_virtual_environment(folder):
    out, place = os.path.join(folder, "out"), os.path.join(folder, "venv")
    run(LATTICE, out, "--set", "time.end=0.05 ms", "--set", "output.snapshots=0")
    os.makedirs(os.path.join(place, "bin"))
    os.symlink("/usr/bin/python3", os.path.join(place, "bin", "python3"))
    with open(os.path.join(place, "pyvenv.cfg"), "w") as file:
        file.write("home = /usr/bin\ninclude-system-site-packages = false\n")
    active = {"VIRTUAL_ENV": place, "PATH": os.path.join(place, "bin") + os.pathsep + os.environ["PATH"]}
    expect(gneiss("report", out, environment=active), 0)


@fact
def control_characters_do_not_reach_a_terminal(folder):
    with open(LATTICE) as file:
        rest = re.sub(r"(?m)^title:.*\n", "", file.read())
    scene = write_scene(folder, 'title: "clear \\e[2J screen"\n' + rest)
    done = expect(gneiss("check", scene), 2, r"scene.yaml:1:\d+: title: expected text without control characters, found 'clear .\[2J screen'")
    assert "\x1b" not in done.stderr + done.stdout
    done = expect(gneiss("check", write_scene(folder, rest + '"\\e[31mkey": 1\n')), 2)
    assert "\x1b" not in done.stderr + done.stdout
    out = os.path.join(folder, "out")
    run(LATTICE, out, "--set", "time.end=0.05 ms", "--set", "output.snapshots=0")
    with h5py.File(os.path.join(out, "results.h5"), "r+") as file:
        file["history/\x1b[2J"] = np.zeros(3)
    done = expect(gneiss("report", out), 2)
    assert "\x1b" not in done.stderr
    for sign in "\u061c\u200b\u200e\u202e\u2028\u2066\x9b":
        done = expect(gneiss("check", write_scene(folder, f'title: "a \\u{ord(sign):04x} b"\n' + rest)), 2, "title: expected text without control characters")
        assert sign not in done.stderr
    expect(gneiss("check", write_scene(folder, 'title: "m\\u200Cn \\u00e9 \\u4e2d"\n' + rest)), 0)  # joiners between letters belong to words
    place, small = os.path.join(folder, "a\x1b[2Jb"), ("--set", "time.end=0.05 ms", "--set", "output.snapshots=0")
    specimen = write_scene(folder, SPECIMEN % 1, "specimen.yaml")
    for call in (("run", LATTICE, "--out", place, *small), ("resume", place), ("pack", specimen, "--out", place + "2"),
                 ("sweep", write_scene(folder, SWEEP, "sweep.yaml"), "--out", place + "3", *small)):
        done = expect(gneiss(*call), 0)
        assert "\x1b" not in done.stdout + done.stderr, (call, done.stdout, done.stderr)
    with h5py.File(os.path.join(place, "results.h5"), "r+") as file:
        file.attrs.create("title", np.bytes_(b"a \x1b[2J title"))
        report_digest.seal(file)
    expect(gneiss("report", place), 0)
    assert b"\x1b" not in open(os.path.join(place, "report.html"), "rb").read()


if __name__ == "__main__":
    sys.exit(main())
