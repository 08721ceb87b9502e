"""gneiss pack, and scenes that request a packing. Speaks TAP."""
import fcntl
import shlex
import signal

from program import *  # noqa: F403

DISC = "disc: {diameter: 20 mm}"
CYLINDER = "cylinder: {diameter: 23 mm, height: 30 mm}"


def request(folder, shape=CYLINDER, particles=200, more="", dimension=3, name="body.yaml"):
    """A file with a specimen only."""
    return write_scene(folder, f"dimension: {dimension}\nspecimen:\n  {shape}\n  particles: {particles}\n{more}", name)


SCENE = """
materials: [{name: ball, density: 2000, normal_stiffness: 1e6, kratio: 2, friction: 0.3,
             bond_tension_limit: 100, bond_shear_limit: 100}]
law: {stiffness: uniform}
bonds: {}
gravity: [0, 0, -10]
damping: {background: {model: nonviscous_vector, coefficient: 0.7}}
time: {end: 0.2 ms}
output: {snapshots: 2, history_rows: 10}
run: {threads: 1}
"""


def cached(folder, **more):
    """Options that keep the cache of a test in its folder."""
    return {"environment": {"GNEISS_CACHE": os.path.join(folder, "cache"), **more}}


def pack(folder, body, *arguments, out="out", **options):
    path = os.path.join(folder, out)
    return path, expect(gneiss("pack", body, "--out", path, *arguments, **cached(folder), **options), 0)


def packing(out):
    """Rows x y z r of packing.h5."""
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        return np.column_stack([file["particles/position"][:], file["particles/radius"][:]])


def scene_of_specimen(folder, specimen, name="scene.yaml", dimension=3):
    """A scene that runs; in 2D without gravity along z."""
    rest = SCENE if dimension == 3 else SCENE.replace("gravity: [0, 0, -10]", "gravity: [0, -10]")
    return write_scene(folder, f"dimension: {dimension}\nspecimen:\n  {specimen}\n{rest}", name)


def check_whole_files(out, particles):
    """Every existing file is complete."""
    for name in os.listdir(out):
        path = os.path.join(out, name)
        assert not name.endswith(".tmp"), os.listdir(out)
        if name.endswith(".txt"):
            assert len(np.loadtxt(path)) == particles, f"{name} is cut short"
        elif name.endswith((".h5", ".hdf")):
            with h5py.File(path) as file:
                assert len(file), f"{name} is empty"
        elif name.endswith(".series"):
            with open(path) as file:
                json.load(file)


# --- output files -----------------------------------------------------------------------------------------

@fact
def the_text_has_the_same_doubles_as_packing_h5(folder):
    for dimension, shape in ((2, DISC), (3, CYLINDER)):
        out, _ = pack(folder, request(folder, shape, dimension=dimension), out=str(dimension))
        rows = np.loadtxt(os.path.join(out, "packing.txt"))
        columns = [0, 1, 3] if dimension == 2 else [0, 1, 2, 3]
        assert rows.shape == (200, len(columns)), rows.shape
        assert np.array_equal(rows, packing(out)[:, columns])


@fact
def the_text_is_a_specimen_with_the_same_doubles(folder):
    for dimension, shape in ((2, DISC), (3, CYLINDER)):
        out, _ = pack(folder, request(folder, shape, dimension=dimension), out=f"packing-{dimension}")
        scene = scene_of_specimen(folder, f"file: packing-{dimension}/packing.txt", dimension=dimension)
        ran = os.path.join(folder, f"run-{dimension}")
        run(scene, ran)
        with results(ran) as file:
            start = file["particles/position"][:] - file["particles/displacement"][:]
            assert np.array_equal(file["particles/radius"][:], packing(out)[:, 3])
        assert np.allclose(start, packing(out)[:, :3], rtol=0, atol=1e-15)
        with h5py.File(os.path.join(ran, "particles_0000000000.hdf")) as file:
            assert np.array_equal(file["VTKHDF/Points"][:], packing(out)[:, :3])


@fact
def packing_h5_has_the_layout_and_units_of_its_document(folder):
    out, _ = pack(folder, request(folder))
    units = {"particles/position": "m", "particles/radius": "m", "contacts/pair": "1", "contacts/gap": "1",
             "quality/porosity": "1", "quality/radius_mean": "m", "quality/fabric": "1",
             "histogram/radius_edge": "m", "histogram/radius_count": "1", "histogram/angle_count": "1",
             "histogram/polar_count": "1", "trace/iteration": "1", "trace/stage": "1", "trace/energy": "1",
             "trace/gap_rms": "1", "trace/overlap_max": "1", "trace/pairs": "1"}
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        for name, unit in units.items():
            assert text(file[name].attrs["unit"]) == unit and text(file[name].attrs["description"]), name
        assert text(file.attrs["kind"]) == "packing" and text(file.attrs["version"]) and text(file.attrs["build"])
        assert [int(file.attrs[k]) for k in ("dimension", "seed", "particles", "in_time", "from_cache")] == \
            [3, 1, 200, 1, 0]
        assert abs(float(file.attrs["volume"]) / (np.pi * 0.0115 ** 2 * 0.03) - 1) < 1e-12
        assert file["contacts/pair"].shape == (int(file.attrs["pairs"]), 2)
        assert np.all(np.diff(file["trace/iteration"][:]) == 1) and set(file["trace/stage"][:]) == {0, 1, 2, 3, 4}


@fact
def the_figures_are_those_of_the_particles(folder):
    out, _ = pack(folder, request(folder))
    rows = packing(out)
    away = np.linalg.norm(rows[:, None, :3] - rows[None, :, :3], axis=2)
    both = rows[:, None, 3] + rows[None, :, 3]
    gap = (away - both)[np.triu_indices(len(rows), 1)] / both[np.triu_indices(len(rows), 1)]
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        def figure(name):
            return float(file["quality/" + name][0])
        solid = 4 / 3 * np.pi * np.sum(rows[:, 3] ** 3) / file.attrs["volume"]
        assert abs(figure("porosity") - (1 - solid)) < 1e-12
        assert figure("coordination_1") == 2 * np.count_nonzero(gap <= 0.01) / len(rows)
        assert figure("coordination_5") == 2 * np.count_nonzero(gap <= 0.05) / len(rows)
        assert np.allclose(np.sort(file["contacts/gap"][:]), np.sort(gap[gap <= 0.05]), rtol=0, atol=1e-12)
        assert abs(figure("radius_mean") / np.mean(rows[:, 3]) - 1) < 1e-12
        assert file["histogram/radius_count"][:].sum() == len(rows)


@fact
def the_request_in_packing_h5_gives_the_same_packing(folder):
    more = "  origin: [0, 0, 1 mm]\n  packing: {size_ratio: 3, refine: [{boundary: true, size: 0.7, distance: 3 mm}]}\n"
    out, _ = pack(folder, request(folder, more=more), "--seed", 7)
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        again = write_scene(folder, text(file["request"][()]), "again.yaml")
    other, done = pack(folder, again, out="other")
    assert "from the cache" in done.stdout and np.array_equal(packing(out), packing(other))
    expect(gneiss("pack", again, "--out", os.path.join(folder, "third"), environment={"GNEISS_CACHE": "off"}), 0)
    assert np.array_equal(packing(out), packing(os.path.join(folder, "third")))


@fact
def a_snapshot_for_paraview_has_centres_and_radii(folder):
    out, _ = pack(folder, request(folder))
    (name, _), = series(out)
    with h5py.File(os.path.join(out, name)) as file:
        assert np.array_equal(file["VTKHDF/Points"][:], packing(out)[:, :3])
        assert np.array_equal(file["VTKHDF/PointData/radius"][:], packing(out)[:, 3])


@fact
def packing_again_into_the_same_folder_takes_the_place_of_everything(folder):
    out, _ = pack(folder, request(folder))
    first = packing(out)
    pack(folder, request(folder, particles=90))
    assert len(packing(out)) == 90 and len(first) == 200
    check_whole_files(out, 90)


@fact
def a_folder_in_which_a_run_works_takes_no_packing(folder):
    out = os.path.join(folder, "out")
    process = subprocess.Popen(command("run", UCS, "--out", out, "--quiet", "--set", "output.checkpoint=off"),
                               env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    assert wait_until(process, lambda: os.path.exists(os.path.join(out, "particles.hdf.series"))), process.stderr.read()
    done = gneiss("pack", request(folder), "--out", out, **cached(folder))
    assert process.wait(timeout=120) == 0, process.stderr.read()
    expect(done, 2, "found another run or packing that writes into it")
    assert "packing.h5" not in os.listdir(out) and len(series(out)) > 2


@fact
def a_folder_takes_one_packing_at_a_time(folder):
    out = os.path.join(folder, "out")
    os.mkdir(out)
    held = os.open(out, os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    expect(gneiss("pack", request(folder), "--out", out, **cached(folder)), 2, "another run or packing that writes into it")
    assert not os.listdir(out), os.listdir(out)
    os.close(held)
    pack(folder, request(folder))


@fact
def a_folder_with_checkpoints_takes_no_packing(folder):
    out = os.path.join(folder, "out")
    os.mkdir(out)
    open(os.path.join(out, "checkpoint_0000000048.h5"), "w").close()
    expect(gneiss("pack", request(folder), "--out", out, **cached(folder)), 2, "found a run in it")


@fact
def a_temporary_file_that_another_process_writes_is_left_alone(folder):
    out = os.path.join(folder, "out")
    os.mkdir(out)
    names = [os.path.join(out, name + ".tmp") for name in ("packing.h5", "particles_0000000007.hdf")]
    held = [open(name, "w") for name in names]
    for file in held:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.write("mine")
        file.flush()
    pack(folder, request(folder))
    assert [open(name).read() for name in names] == ["mine", "mine"]
    for file in held:
        file.close()
    pack(folder, request(folder))
    assert not [name for name in os.listdir(out) if name.endswith(".tmp")], "temporary files are left"


# --- printed output ---------------------------------------------------------------------------------------

@fact
def figures_are_printed(folder):
    out, done = pack(folder, request(folder))
    for pattern in (r"200 spheres in [\d.e-]+ m3, packed in [\d.]+ s, \d+ iterations", r"porosity +[\d.]+ % .*once",
                    r"coordination +[\d.]+ at gaps up to 0\.1 % of r_i \+ r_j, [\d.]+ up to 1 %", r"floating +[\d.]+ %",
                    r"radii +[\d.e-]+ to [\d.e-]+ m, mean", r"fabric +xx [\d.]+ yy [\d.]+ zz [\d.]+",
                    r"overlaps +median", r"boundary +[\d.]+ %", "written to " + re.escape(out)):
        assert re.search(pattern, done.stdout), f"/{pattern}/ is missing:\n{done.stdout}"
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        percent = 100 * float(file["quality/porosity"][0])
    assert f"{percent:.2f} % (overlaps counted twice)" in done.stdout, done.stdout
    assert not done.stderr, done.stderr


@fact
def figures_of_discs_are_printed(folder):
    _, done = pack(folder, request(folder, DISC, dimension=2))
    assert re.search(r"200 discs in [\d.e-]+ m2", done.stdout), done.stdout
    assert re.search(r"fabric +xx [\d.]+ yy [\d.]+ xy", done.stdout), done.stdout


@fact
def quiet_prints_the_figures_and_nothing_else(folder):
    out, done = pack(folder, request(folder), "--quiet")
    assert "porosity" in done.stdout and "written to" not in done.stdout and not done.stderr and len(packing(out)) == 200


@fact
def a_log_as_json_has_valid_lines(folder):
    out, done = pack(folder, request(folder, particles=3000), "--log", "json", "--threads", 1)
    last, = logged(done.stdout)
    assert last["particles"] == 3000 and last["in_time"] is True and last["from_cache"] is False
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        for name in ("porosity", "coordination_1", "radius_mean", "overlap_max", "anisotropy"):
            assert last[name] == float(file["quality/" + name][0]), name
    for line in logged(done.stdout, "progress"):
        assert line["packing"] in ("spread", "compress", "decompress", "close", "separate"), line
        assert 0 < line["fraction"] <= 1 and line["particles"] == 3000 and line["iteration"] > 0, line
    assert not done.stderr, done.stderr


@fact
def a_seed_gives_a_packing_of_its_own(folder):
    body = request(folder)
    one, _ = pack(folder, body)
    two, _ = pack(folder, body, "--seed", 2, out="two")
    three, done = pack(folder, body, "--set", "run.seed=2", out="three")
    assert not np.array_equal(packing(one), packing(two)) and np.array_equal(packing(two), packing(three))
    assert "from the cache" in done.stdout


@fact
def keys_of_the_shape_can_be_set_on_the_command_line(folder):
    keys = "specimen.particles=50", "specimen.cylinder.diameter=46 mm"
    out, _ = pack(folder, request(folder), "--set", keys[0], "--set", keys[1])
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        assert len(file["particles/radius"]) == 50
        assert abs(file.attrs["volume"] / (np.pi * 0.023 ** 2 * 0.03) - 1) < 1e-12


@fact
def a_packing_cut_short_by_time_says_so(folder):
    out, done = pack(folder, request(folder, more="  packing: {time: 1e-9}\n"))
    assert "cut short by packing.time" in done.stdout
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        assert file.attrs["in_time"] == 0
    assert not os.path.exists(os.path.join(folder, "cache"))


# --- the cache --------------------------------------------------------------------------------------------

@fact
def a_second_packing_comes_from_the_cache_with_the_same_bits(folder):
    body = request(folder)
    one, done = pack(folder, body, "--threads", 1)
    assert "packed in" in done.stdout
    two, done = pack(folder, body, "--threads", 2, out="two")
    assert "from the cache; made in" in done.stdout and np.array_equal(packing(one), packing(two))
    with h5py.File(os.path.join(two, "packing.h5")) as file:
        assert file.attrs["from_cache"] == 1 and len(file["trace/energy"]) > 20


@fact
def what_is_split_of_a_mesh_is_said_of_a_packing_from_the_cache_too(folder):
    corners = [(x, y, z) for z in (0, 0.02) for x, y in ((0, 0), (0.02, 0), (0.02, 0.02), (0, 0.02))]
    nodes = "\n".join(f"{k + 1} {x} {y} {z}" for k, (x, y, z) in enumerate(corners))
    with open(os.path.join(folder, "cube.msh"), "w", encoding="utf-8") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n{nodes}\n$EndNodes\n$Elements\n1\n1 5 2 0 1 1 2 3 4 5 6 7 8\n$EndElements\n")
    scene = scene_of_specimen(folder, "mesh: cube.msh\n  particles: 40")
    for out, source in (("one", "packed in"), ("two", "from the cache")):
        _, done = pack(folder, scene, out=out)
        assert source in done.stdout and "note: specimen: 1 hexahedra split into tetrahedra" in done.stderr, (done.stdout, done.stderr)


@fact
def a_damaged_cache_file_is_warned_of_and_replaced(folder):
    body = request(folder)
    one, _ = pack(folder, body)
    (name,) = os.listdir(os.path.join(folder, "cache"))
    with open(os.path.join(folder, "cache", name), "r+b") as file:
        file.truncate(1000)
    two, done = pack(folder, body, out="two")
    assert re.search(r"gneiss: warning: \S+" + re.escape(name) + ": not used: ", done.stderr), done.stderr
    assert "packed in" in done.stdout and np.array_equal(packing(one), packing(two))
    _, done = pack(folder, body, out="three")
    assert not done.stderr and "from the cache" in done.stdout


@fact
def a_cache_that_cannot_be_written_is_warned_of(folder):
    taken = write_scene(folder, "a file", "taken")
    done = gneiss("pack", request(folder), "--out", os.path.join(folder, "out"), environment={"GNEISS_CACHE": taken})
    expect(done, 0, "gneiss: warning: packing not cached: .*taken")
    assert len(packing(os.path.join(folder, "out"))) == 200


# --- scenes -----------------------------------------------------------------------------------------------

@fact
def a_scene_packs_its_specimen_once(folder):
    for dimension, shape in ((2, DISC), (3, CYLINDER)):
        scene = scene_of_specimen(folder, f"{shape}\n  particles: 100", dimension=dimension)
        outs = [os.path.join(folder, f"{dimension}-{k}") for k in range(2)]
        first, second = (expect(gneiss("run", scene, "--out", out, **cached(folder)), 0) for out in outs)
        assert "100 particles packed\n" in first.stdout, first.stdout
        assert "100 particles packed before (from the cache)" in second.stdout, second.stdout
        check_same(outs[1], outs[0])
        assert summary(outs[0])["counts"]["particles"] == 100


@fact
def a_scene_runs_the_particles_that_pack_writes(folder):
    scene = scene_of_specimen(folder, f"{CYLINDER}\n  particles: 100")
    out, _ = pack(folder, scene)
    ran = os.path.join(folder, "run")
    assert "from the cache" in expect(gneiss("run", scene, "--out", ran, **cached(folder)), 0).stdout
    with h5py.File(os.path.join(ran, "particles_0000000000.hdf")) as file:
        assert np.array_equal(file["VTKHDF/Points"][:], packing(out)[:, :3])


@fact
def a_specimen_may_come_from_the_folder_of_a_packing(folder):
    """Bits and volume are those of the scene that makes the packing, also after a stop. The packing is at rest, and the new scene has no bonds of its
    own."""
    own = scene_of_specimen(folder, f"{CYLINDER}\n  particles: 200", "own.yaml")
    path, _ = pack(folder, own)
    other = scene_of_specimen(folder, f"from: {path}", "other.yaml")
    runs = []
    for name, given in (("one", own), ("two", other)):
        runs.append(os.path.join(folder, name))
        run(given, runs[-1], "--set", "origin=[0, 0, 0]", **cached(folder))
    one, two = (summary(r) for r in runs)
    assert one["state_hash"] == two["state_hash"] and one["volume"] == two["volume"], (one, two)
    assert (one["volume_of"], two["volume_of"]) == ("the shape", "the shape that was packed")
    shutil.rmtree(path)
    resume(runs[1], "--set", "time.end=0.3 ms")
    assert summary(runs[1])["volume_of"] == "the shape that was packed" and summary(runs[1])["volume"] == one["volume"]
    path, _ = pack(folder, own)
    place = r"other.yaml:\d+:\d+: specimen.from: "
    expect(gneiss("check", other, "--set", "specimen.from_bonds=keep"), 2, place + "expected the folder of a run beside from_bonds: keep, found that of a packing")
    expect(gneiss("check", scene_of_specimen(folder, f"from: {path}", "other.yaml", 2)), 2, place + "expected a packing of a 2D scene, found one of a 3D scene")


@fact
def a_scene_runs_without_a_cache(folder):
    scene = scene_of_specimen(folder, f"{CYLINDER}\n  particles: 100")
    outs = [os.path.join(folder, name) for name in ("on", "off")]
    run(scene, outs[0], **cached(folder))
    run(scene, outs[1], environment={"GNEISS_CACHE": "off"})
    check_same(outs[1], outs[0])


@fact
def check_and_plan_pack_what_they_look_at(folder):
    scene = scene_of_specimen(folder, f"{CYLINDER}\n  particles: 100")
    out = expect(gneiss("check", scene, **cached(folder)), 0).stdout
    assert "100 particles packed\n" in out and "can run" in out, out
    out = expect(gneiss("plan", scene, **cached(folder)), 0).stdout
    assert "from the cache" in out and re.search(r"particles +100 x", out), out
    assert sorted(os.listdir(folder)) == ["cache", "scene.yaml"], os.listdir(folder)


@fact
def a_resumed_run_needs_neither_cache_nor_shape(folder):
    nowhere = {"environment": {"GNEISS_CACHE": os.path.join(folder, "taken", "below")}}
    write_scene(folder, "a file, so that no cache can be made", "taken")
    write_cube(folder, "cube.stl", 20)
    scene = scene_of_specimen(folder, "surface: cube.stl\n  scale: 1e-3\n  particles: 100")
    straight, out = os.path.join(folder, "straight"), os.path.join(folder, "out")
    run(scene, straight, **cached(folder))
    run(scene, out, "--set", "time.end=0.1 ms", **cached(folder))
    shutil.rmtree(os.path.join(folder, "cache"))
    os.remove(os.path.join(folder, "cube.stl"))
    os.remove(scene)
    done = resume(out, "--set", "time.end=0.2 ms", **nowhere)
    assert not done.stderr, done.stderr
    assert state_hash(out) == state_hash(straight)
    assert not os.path.exists(os.path.join(folder, "cache"))


# --- interrupted ------------------------------------------------------------------------------------------

def interrupted(folder, *arguments):
    """Starts the program, waits for the first line of progress and interrupts it; returns the finished process."""
    environment = {**ENVIRONMENT, "GNEISS_CACHE": os.path.join(folder, "cache")}
    with subprocess.Popen(command(*arguments, "--log", "json"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, env=environment) as process:
        line = process.stdout.readline()
        assert json.loads(line)["progress"]["packing"], line
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=120)
    assert process.returncode == 6, f"exit code {process.returncode}: {stderr}"
    assert re.search("packing interrupted|before the first step", stderr), stderr
    for line in stdout.splitlines():
        json.loads(line)


@fact
def an_interrupted_packing_leaves_no_files(folder):
    out = os.path.join(folder, "out")
    interrupted(folder, "pack", request(folder, particles=30000), "--out", out)
    assert not os.path.exists(out), os.listdir(out)
    assert not os.path.exists(os.path.join(folder, "cache"))


@fact
def a_run_interrupted_while_packing_leaves_no_folder(folder):
    out = os.path.join(folder, "out")
    interrupted(folder, "run", scene_of_specimen(folder, f"{CYLINDER}\n  particles: 30000"), "--out", out)
    assert sorted(os.listdir(folder)) == ["scene.yaml"], os.listdir(folder)


# --- folders and disks ------------------------------------------------------------------------------------

@fact
def a_folder_with_results_of_a_run_is_refused(folder):
    out = os.path.join(folder, "out")
    run(LATTICE, out, "--set", "time.end=0.1 ms")
    before = {name: os.path.getmtime(os.path.join(out, name)) for name in os.listdir(out)}
    done = gneiss("pack", request(folder), "--out", out, **cached(folder))
    expect(done, 2, re.escape(out) + ": expected a folder for a packing, found a run in it")
    assert {name: os.path.getmtime(os.path.join(out, name)) for name in os.listdir(out)} == before
    assert not os.path.exists(os.path.join(folder, "cache")), "packed before it was refused"


@fact
def a_file_in_the_place_of_the_folder_is_an_error(folder):
    place = write_scene(folder, "mine", "taken")
    expect(gneiss("pack", request(folder), "--out", place, **cached(folder)), 3, "taken")
    assert open(place).read() == "mine"


@fact
def a_folder_in_the_place_of_a_file_is_an_error(folder):
    for name in ("packing.txt", "packing.h5"):
        out = os.path.join(folder, name)
        os.makedirs(os.path.join(out, name))
        expect(gneiss("pack", request(folder), "--out", out, "--quiet", **cached(folder)), 3, re.escape(name))
        assert not [entry for entry in os.listdir(out) if entry.endswith(".tmp")], os.listdir(out)


def in_namespace(script, *arguments, cache):
    """Writes a shell script with its own mount table; `$1` is a folder on a small disk."""
    try:
        if subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode != 0:
            raise Skip("no mount namespaces for this user")
    except FileNotFoundError:
        raise Skip("no unshare on this machine") from None
    call = subprocess.run(["unshare", "-m", "--propagation", "private", "sh", "-c", script, "sh", *arguments],
                          capture_output=True, text=True, env={**ENVIRONMENT, "GNEISS_CACHE": cache}, timeout=120)
    if call.returncode == 77:
        raise Skip("tmpfs cannot be mounted")
    return call


@fact
def a_read_only_folder_is_an_error(folder):
    disk = os.path.join(folder, "disk")
    os.mkdir(disk)
    program, body = map(shlex.quote, (PROGRAM, request(folder)))
    for out in ('"$1"', '"$1/below"'):
        script = f'mount -t tmpfs -o ro none "$1" || exit 77; {program} pack {body} --quiet --out {out}; echo code $?'
        call = in_namespace(script, disk, cache=os.path.join(folder, "cache"))
        assert "code 3" in call.stdout and "Read-only file system" in call.stderr, call.stdout + call.stderr


@fact
def a_full_disk_is_an_error_and_leaves_whole_files_only(folder):
    particles = 2000
    body = request(folder, particles=particles)
    out, _ = pack(folder, body)
    size = {name: os.path.getsize(os.path.join(out, name)) for name in os.listdir(out)}
    snapshot, = (name for name in size if name.endswith(".hdf"))
    text, listed = "packing.txt", "particles.hdf.series"
    room = ((size[text] // 2, set()), (size[text] + size[snapshot] // 2, {text}),
            (size[text] + size[snapshot] + size["packing.h5"] // 2, {text, snapshot, listed}))
    program, path = map(shlex.quote, (PROGRAM, body))
    for number, (bytes_free, left) in enumerate(room):
        disk, copy = os.path.join(folder, "disk"), os.path.join(folder, f"copy-{number}")
        os.makedirs(disk, exist_ok=True)
        os.mkdir(copy)
        script = f'mount -t tmpfs -o size={bytes_free // 4096 * 4096} none "$1" || exit 77; ' \
                 f'{program} pack {path} --quiet --out "$1"; echo code $?; cp -a "$1"/. "$2"'
        call = in_namespace(script, disk, copy, cache=os.path.join(folder, "cache"))
        assert "code 3" in call.stdout and "No space left on device" in call.stderr, call.stdout + call.stderr
        assert set(os.listdir(copy)) == left, os.listdir(copy)
        check_whole_files(copy, particles)


@fact
def a_full_disk_under_the_cache_is_a_warning(folder):
    program, body = map(shlex.quote, (PROGRAM, request(folder, particles=2000)))
    disk, out = os.path.join(folder, "disk"), os.path.join(folder, "out")
    os.mkdir(disk)
    script = f'mount -t tmpfs -o size=40k none "$1" || exit 77; {program} pack {body} --quiet --out "$2"; ' \
             'echo code $?; ls -A "$1"'
    call = in_namespace(script, disk, out, cache=disk)
    assert call.stdout.endswith("\ncode 0\n"), call.stdout + call.stderr
    assert re.search("gneiss: warning: packing not cached: .*No space left on device", call.stderr), call.stderr
    check_whole_files(out, 2000)


# --- bad input --------------------------------------------------------------------------------------------

CUBE = ((0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
        (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5))


def write_cube(folder, name, side, faces=CUBE):
    lines = ["solid cube"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {side * (c & 1)} {side * (c >> 1 & 1)} {side * (c >> 2)}" for c in face]
        lines += ["endloop", "endfacet"]
    return write_scene(folder, "\n".join([*lines, "endsolid cube", ""]), name)


FLAT = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n" \
       "$Elements\n2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n$EndElements\n"


@fact
def errors_name_the_place_in_the_scene(folder):
    cases = (("dimension: 3\nspecimen:\n  box: {size: [1, 1]}\n  particles: 9\n", r"body\.yaml:3:\d+: "),
             ("dimension: 3\nspecimen:\n  box: {size: [1, 1, 1]}\n  particles: 3\n", r"body\.yaml:4:14: "),
             ("dimension: 3\nspecimen:\n  box: {size: [1, 1, 1]}\n", r"body\.yaml:2:1: .*mean_radius"),
             ("dimension: 3\nspecimen:\n  disc: {diameter: 1}\n  particles: 9\n", r"body\.yaml:3:3: "),
             ("dimension: 3\nspecimen:\n  surface: none.stl\n  particles: 9\n", r"body\.yaml:3:12: .*none\.stl"),
             ("dimension: 3\nspecimen:\n  lattice: {kind: cubic, radius: 1, cells: [2, 2, 2]}\n", r"body\.yaml:2:1: "),
             ("dimension: 3\nspecimen:\n  box: {size: [1, 1, 1]}\n  mean_radius: 0.7\n",
              r"body\.yaml:2:1: .*mean radius is too large"),
             ("dimension: 2\nspecimen:\n  polygon: [[0, 0], [1, 1], [1, 0], [0, 1]]\n  particles: 9\n",
              r"body\.yaml:2:1: .*edge 1 from \(0, 0\) to \(1, 1\)"),
             ("dimension: 3\nspecimen:\n  box: {size: [1, 1, 1]}\n  particles: 9\n  packing: {gapp: 1}\n",
              r"body\.yaml:5:\d+: .*gapp"))
    out = os.path.join(folder, "out")
    for scene, pattern in cases:
        done = gneiss("pack", write_scene(folder, scene, "body.yaml"), "--out", out, **cached(folder))
        expect(done, 2, pattern)
        assert not os.path.exists(out) or not os.listdir(out), os.listdir(out)


@fact
def errors_in_mesh_files_name_the_file(folder):
    write_cube(folder, "open.stl", 1, CUBE[:-1])
    write_scene(folder, "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 zero\n", "word.stl")
    write_scene(folder, FLAT, "flat.msh")
    write_scene(folder, FLAT.replace("2 1 0 0", "2 1 0 nan"), "nan.msh")
    cases = (("surface: open.stl", r"open\.stl: .*expected a closed surface"),
             ("surface: word.stl", r"word\.stl:4:\d+: "),
             ("mesh: flat.msh", r"flat\.msh: .*tetrahedra"), ("mesh: nan.msh", r"nan\.msh:\d+:\d+: "))
    for shape, pattern in cases:
        out = os.path.join(folder, "out")
        expect(gneiss("pack", request(folder, shape), "--out", out, **cached(folder)), 2, pattern)
        for verb in ("run", "check", "plan"):
            scene = scene_of_specimen(folder, f"{shape}\n  particles: 9")
            ran = ("--out", os.path.join(folder, "ran")) if verb == "run" else ()
            expect(gneiss(verb, scene, *ran, **cached(folder)), 2, pattern)
    assert not os.path.exists(os.path.join(folder, "ran"))


@fact
def a_packing_too_large_for_the_memory_is_an_error(folder):
    body = write_scene(folder, "dimension: 3\nspecimen:\n  box: {size: [1, 1, 1]}\n  mean_radius: 1e-9\n", "body.yaml")
    done = gneiss("pack", body, "--out", os.path.join(folder, "out"), **cached(folder))
    expect(done, 4, r"body\.yaml.*particles need about [\d.e+]+ GB to be packed; this machine has [\d.e+]+ GB")


@fact
def pack_needs_a_file(folder):
    expect(gneiss("pack"), 2, "expected FILE")
    expect(gneiss("pack", os.path.join(folder, "none.yaml")), 2, r"none\.yaml: cannot open")


# --- volume ------------------------------------------------------------------------------------------------

L_CORNERS = ((0, 0), (20, 0), (20, 8), (8, 8), (8, 20), (0, 20))  # in mm; the area is 256 mm2, that of the hull 328 mm2
L_AREA, L_HULL = 256e-6, 328e-6


def write_prism(folder, name, corners, height):
    """An L as a closed surface: two rectangles make each end."""
    ends = ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5))
    facets = [[(*corners[k], 0) for k in reversed(t)] for t in ends] + [[(*corners[k], height) for k in t] for t in ends]
    for a, b in zip(corners, corners[1:] + corners[:1]):
        facets += [[(*a, 0), (*b, 0), (*b, height)], [(*a, 0), (*b, height), (*a, height)]]
    lines = ["solid l"]
    for facet in facets:
        lines += ["facet normal 0 0 0", "outer loop"] + ["vertex %g %g %g" % v for v in facet] + ["endloop", "endfacet"]
    with open(os.path.join(folder, name), "w") as file:
        file.write("\n".join(lines + ["endsolid l", ""]))


def concave(folder, more=""):
    write_prism(folder, "l.stl", L_CORNERS, 20)
    scene = scene_of_specimen(folder, f"surface: l.stl\n  scale: 1e-3\n  particles: 300\n  density_basis: bulk\n{more}")
    return scene, L_AREA * 20e-3


def found(pattern, text):
    match = re.search(pattern, text)
    assert match, f"/{pattern}/ is not in: {text}"
    return float(match[1])


@fact
def check_and_pack_say_the_same_porosity_of_a_concave_surface(folder):
    scene, volume = concave(folder)
    packed = pack(folder, scene)[1].stdout
    checked = expect(gneiss("check", scene, **cached(folder)), 0).stdout
    assert found(r"porosity +([\d.]+) %", packed) == found(r"porosity +([\d.]+) %", checked), packed + checked
    assert "m3, of the shape" in checked and abs(found(r"volume +(\S+) m3", checked) / volume - 1) < 1e-5, checked


@fact
def bulk_density_gives_a_concave_surface_the_mass_of_its_volume(folder):
    scene, volume = concave(folder)
    checked = expect(gneiss("check", scene, **cached(folder)), 0).stdout
    assert abs(found(r"mass (\S+) kg", checked) / (2000 * volume) - 1) < 1e-5, checked


@fact
def the_area_of_a_test_is_the_mean_section_of_the_shape(folder):
    test = """walls:
  - {name: low, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6}
  - {name: up, point: [0, 0, 20 mm], normal: [0, 0, -1], stiffness: 1e6}
test: {kind: compression, axis: z, lower: low, upper: up, length: 20 mm}
"""
    scene = concave(folder, test)[0]
    checked = expect(gneiss("check", scene, **cached(folder)), 0).stdout
    assert abs(found(r"area (\S+) m2", checked) / L_AREA - 1) < 1e-5, checked


@fact
def a_mean_stress_is_over_the_volume_of_the_shape(folder):
    """The file states the change, and a run that makes the packing itself (without a file of particles) agrees."""
    scene, volume = concave(folder)
    out = os.path.join(folder, "out")
    run(scene, out, **cached(folder))
    with results(out) as file:
        assert abs(file.attrs["volume"] / volume - 1) < 1e-9 and text(file.attrs["volume_of"]) == "the shape"
    assert summary(out)["volume_of"] == "the shape"


@fact
def particles_from_a_file_have_the_volume_of_their_hull_and_say_so(folder):
    scene = concave(folder)[0]
    made, _ = pack(folder, scene)
    shutil.copy(os.path.join(made, "packing.txt"), folder)
    checked = expect(gneiss("check", scene_of_specimen(folder, "file: packing.txt")), 0).stdout
    assert "of the convex hull of the particles" in checked, checked
    # The hull of spheres inside the L: smaller than the hull of the L, and nearer to it than to the L.
    assert 0.5 * (L_AREA + L_HULL) < found(r"volume +(\S+) m3", checked) / 20e-3 < L_HULL, checked


# --- sizes that are asked for -----------------------------------------------------------------------------

def sized(folder, packing, name):
    """Radii of 1200 spheres in a cube, ascending; their figures."""
    scene = {"dimension": 3, "specimen": {"box": {"size": [1, 1, 1]}, "particles": 1200, "packing": packing}, "run": {"threads": 1}}
    out = os.path.join(folder, name)
    expect(gneiss("pack", write_scene(folder, scene), "--out", out, "--quiet"), 0)
    with h5py.File(os.path.join(out, "packing.h5")) as file:
        return np.sort(file["particles/radius"][:].reshape(-1)), {k: float(np.ravel(v[()])[0]) for k, v in file["quality"].items()}


def check_law(radii, law):
    """Radii that may change by a tenth of themselves have the quantiles of the law, in some unit, to a tenth; the
    quantiles of 1200 draws are within 5 % of their range."""
    unit = np.median(radii / law)
    assert np.all(np.abs(radii / unit - law) < 0.1 * law + 0.05 * (law.max() - law.min())), np.abs(radii / unit / law - 1).max()


@fact
def uniform_sizes_come_out_uniform(folder):
    for overlap in ("none", "passive"):
        radii, quality = sized(folder, {"sizes": "uniform", "size_ratio": 4, "overlap": overlap}, overlap)
        check_law(radii, 1 + 3 * (np.arange(1200) + 0.5) / 1200)
        assert abs(quality["radius_kurtosis"] - 1.8) < 0.25 and abs(quality["radius_skewness"]) < 0.25, quality
        assert abs(quality["radius_median"] / np.median(radii) - 1) < 1e-12
        assert abs(quality["radius_deviation"] / radii.std() - 1) < 1e-9
        assert abs(quality["void_ratio"] / (quality["porosity"] / (1 - quality["porosity"])) - 1) < 1e-9


@fact
def no_size_that_is_asked_for_changes_by_more_than_a_tenth(folder):
    """Sizes are compared in a common unit; the last overlaps may change them by a thousandth more. Discs between which others have no space would
    have to shrink by a third (radii of 1 to 4.7 where 1 to 3 were requested), so all discs become smaller instead. The warning states both."""
    for dimension, shape, overlap, law in ((2, {"rectangle": {"width": 1, "height": 1}}, "none", {"sizes": "uniform"}),
                                           (2, {"disc": {"diameter": 1}}, "none", {"sizes": "sieve", "sieve": [[1 / 3, 0], [0.5, 0.4], [1, 1]]}),
                                           (2, {"rectangle": {"width": 1, "height": 1}}, "passive", {"sizes": "uniform"}),
                                           (3, {"box": {"size": [1, 1, 1]}}, "none", {"sizes": "uniform"})):
        packing = {**law, "overlap": overlap, **({} if "sieve" in law else {"size_ratio": 3})}
        scene = {"dimension": dimension, "specimen": {**shape, "particles": 1000, "packing": packing}}
        out = os.path.join(folder, f"{dimension}-{overlap}-{law['sizes']}")
        said = expect(gneiss("pack", write_scene(folder, scene), "--out", out, "--threads", "1"), 0).stdout
        with h5py.File(os.path.join(out, "packing.h5")) as file:
            radii = file["particles/radius"][:].reshape(-1)
            assert overlap == "passive" or file["contacts/gap"][:].min() > -1e-12, file["contacts/gap"][:].min()
        assert radii.max() / radii.min() < 3 * 1.1 / 0.9 * 1.003, (dimension, overlap, radii.max() / radii.min())
        found = re.search(r"sizes +requested 1 to 3, found 1 to (\S+); shares by (number|mass) off by at most (\S+) %, at", said)
        assert abs(float(found[1]) / (radii.max() / radii.min()) - 1) < 1e-3 and found[2] == ("mass" if "sieve" in law else "number") and 0 < float(found[3]) < 8, said


@fact
def normal_sizes_come_out_normal(folder):
    """A standard deviation of a fifth of the mean: the ratio of 4 truncates at three of them."""
    radii, quality = sized(folder, {"sizes": "normal", "size_ratio": 4, "size_variation": 0.2}, "normal")
    assert abs(quality["radius_variation"] - 0.2) < 0.03, quality["radius_variation"]
    assert abs(quality["radius_skewness"]) < 0.3 and abs(quality["radius_kurtosis"] - 3) < 0.5, quality


@fact
def a_sieve_curve_comes_out_by_mass(folder):
    """Half of the mass between 0.25 and 0.5 of the largest size, half above. The fit changes sizes by a tenth; of the fifth of the particles
    that has the upper half of the mass, 240, a share of it scatters by 3 %."""
    sieve = [[0.25, 0], [0.5, 0.5], [1, 1]]
    radii, _ = sized(folder, {"sizes": "sieve", "sieve": sieve}, "sieve")
    share = np.cumsum(radii**3) / np.sum(radii**3)
    passing = np.interp(0.5 * radii[-1], radii, share)
    assert abs(passing - 0.5) < 0.1, passing


@fact
def sieve_curves_that_are_none_are_refused(folder):
    for packing, pattern in (({"sizes": "sieve"}, "specimen.packing.sizes: needs a key sieve with sizes and shares; found none"),
                             ({"sieve": [[0.1, 0], [1, 1]]}, "specimen.packing.sieve: needs sizes: sieve"),
                             ({"sizes": "sieve", "sieve": [[0.5, 0], [0.4, 1]]}, "specimen.packing.sieve: expected increasing sizes"),
                             ({"sizes": "sieve", "sieve": [[0.5, 0.1], [1, 1]]}, r"specimen.packing.sieve: expected a first row \[size, 0\]"),
                             ({"sizes": "even"}, "specimen.packing.sizes: expected one of fitted, uniform, normal, sieve")):
        scene = {"dimension": 3, "specimen": {"box": {"size": [1, 1, 1]}, "particles": 100, "packing": packing}}
        expect(gneiss("pack", write_scene(folder, scene), "--out", os.path.join(folder, "out")), 2, r"scene.yaml:\d+:\d+: " + pattern)


@fact
def a_variation_beside_sizes_that_have_their_own_is_refused(folder):
    for packing in ({"sizes": "uniform"}, {"sizes": "sieve", "sieve": [[0.5, 0], [1, 1]]}):
        scene = {"dimension": 2, "specimen": {"disc": {"diameter": 1}, "particles": 20, "packing": {**packing, "size_variation": 0.3}}}
        expect(gneiss("pack", write_scene(folder, scene), "--out", os.path.join(folder, "out")), 2,
               r"scene.yaml:\d+:\d+: specimen.packing.size_variation: needs sizes: fitted or normal; found " + packing["sizes"])


@fact
def sizes_that_too_few_particles_cannot_have_are_warned_of(folder):
    """The scene has 40 discs; one in 400 would be above half the largest size. The run has no more than a step."""
    def reported(name, packing, particles):
        specimen = {"disc": {"diameter": 1}, "particles": particles, "packing": packing}
        scene = {"dimension": 2, "specimen": specimen, "materials": [{"name": "a", "density": 1, "young": 1, "poisson": 0.2}], "law": {"stiffness": "dempack"},
                 "time": {"step": 1e-6, "end": 1e-6}, "run": {"threads": 1}}
        path, pattern = write_scene(folder, scene), r"scene.yaml:\d+:\d+: specimen.packing.(size_ratio|sieve) asks for radii of 1 to (\S+), and the \d+ particles have 1 to ([\d.]+)"
        packed = gneiss("pack", path, "--out", os.path.join(folder, "pack" + name), "--quiet")
        expect(packed, 0)
        expect(checked := gneiss("check", path), 0)
        expect(gneiss("run", path, "--out", os.path.join(folder, "run" + name), "--quiet"), 0)
        warned = [w["text"] for w in summary(os.path.join(folder, "run" + name))["warnings"] if w["name"] == "packing_sizes"]
        found = [re.findall(pattern, text) for text in (packed.stderr, checked.stdout, *warned)]
        assert len(found) == 2 + len(warned) and len(set(map(str, found))) == 1, (found, packed.stderr)
        return found[0]
    [(key, asked, got)] = reported("wide", {"sizes": "sieve", "sieve": [[0.02, 0], [1, 1]]}, 40)
    assert key == "sieve" and float(asked) == 50 and float(got) < 50 * 0.9 / 1.1, (asked, got)
    assert not reported("even", {"sizes": "uniform", "size_ratio": 3}, 200)
    assert not reported("narrow", {"sizes": "sieve", "sieve": [[0.5, 0], [1, 1]]}, 200)


@fact
def files_of_others_are_replaced_by_a_packing_only_with_force(folder):
    scene = write_scene(folder, {"dimension": 2, "specimen": {"disc": {"diameter": 1}, "particles": 20}})
    out = os.path.join(folder, "out")
    os.mkdir(out)
    for name in ("packing.txt", "packing.h5", "particles_0000000000.hdf", "particles.hdf.series"):
        path = os.path.join(out, name)
        with open(path, "w") as file:
            file.write("0.1 0.2 0.3\n")
        expect(gneiss("pack", scene, "--out", out), 2, rf"out: expected an empty folder .*found {name} in it, which .*--force replaces it")
        assert os.listdir(out) == [name] and open(path).read() == "0.1 0.2 0.3\n"
        expect(gneiss("pack", scene, "--out", out, "--force"), 0)
        expect(gneiss("pack", scene, "--out", out), 0)  # own files are replaced
        os.remove(os.path.join(out, "packing.h5"))
        expect(gneiss("pack", scene, "--out", out), 0)  # folders as killed calls leave them
        shutil.rmtree(out)
        os.mkdir(out)


if __name__ == "__main__":
    sys.exit(main())
