#!/usr/bin/python3
"""`gneiss view`: the data of the page against results.h5 and the snapshots, to the steps of their quantisation; the page in a browser,
where there is one."""
import base64
import glob
import json
import re
import shutil
import zlib

from program import *

ELEMENTS = os.path.join(SCENES, "elements.yaml")
# Two bonded grains on a floor, grains that fall beside them and run over an edge.
RAIN = {
    "dimension": 3, "specimen": {"particles": [[0, 0, 1e-3, 1e-3], [2e-3, 0, 1e-3, 1e-3], [30e-3, 0, 1e-3, 1e-3]]},
    "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e4, "kratio": 2, "friction": 0.3, "bond_tension_limit": 10, "bond_shear_limit": 10}],
    "law": {"stiffness": "uniform"}, "bonds": {"interaction_range": 0.01}, "gravity": [2, 0, -9.81],
    "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "stiffness": 1e4, "kratio": 2}],
    "sources": [{"name": "rain", "box": {"size": [10e-3, 10e-3, 5e-3]}, "origin": [10e-3, -5e-3, 5e-3], "rate": 2000, "mean_radius": 0.8e-3,
                 "velocity": [0.3, 0, -0.5]}],
    "sinks": [{"name": "edge", "plane": {"point": [20e-3, 0, 0], "normal": [1, 0, 0]}}],
    "time": {"end": 0.05}, "output": {"history_rows": 100, "snapshots": 6}}
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")


class Page:
    """The data of view.html, unpacked by what docs/view.md says of their form."""

    def __init__(self, folder, *options):
        expect(gneiss("view", folder, *options), 0)
        with open(os.path.join(folder, "view.html"), encoding="utf-8") as file:
            self.text = file.read()
        part = {name: re.search(rf'<script type="[^"]*" id="{name}">(.*?)</script>', self.text, re.S)[1] for name in ("meta", "data")}
        self.meta = json.loads(part["meta"])
        self.bytes = zlib.decompress(base64.b64decode(part["data"]))
        self.array = {name: self.unpacked(spec) for name, spec in self.meta["arrays"].items()}

    def unpacked(self, spec):
        (instants, rows, parts), width = spec["shape"], spec["width"]
        count = instants * rows * parts * width
        planes = np.frombuffer(self.bytes[spec["at"]:spec["at"] + count], np.uint8).reshape(instants, parts, width, rows)
        values = sum(planes[:, :, k].astype(np.int64) << 8 * k for k in range(width)).transpose(0, 2, 1)
        if spec["delta"]:
            axis = ("time", "row").index(spec["delta"])
            step = (values >> 1) ^ -(values & 1)
            step[(slice(None),) * axis + (0,)] = values[(slice(None),) * axis + (0,)]
            values = np.cumsum(step, axis=axis) % (1 << 8 * width)
        return values

    def places(self, name):
        """Positions [instants][n][3] of a part, m, and the radii of particles."""
        info = self.meta["particles"] if name == "particles" else next(s for s in self.meta["surfaces"] if s["name"] == name)
        array = self.array[name]
        return np.array(info["low"]) + array[..., :3] / 65535 * info["size"], array[..., 3] / 65535 * info.get("radius", 1), np.array(info["size"]) / 65535

    def field(self, part, name):
        """Values [instants][n], the largest error of those inside the range, and the range."""
        about = next(f for f in self.meta["fields"] if f["name"] == name)
        width = about["high"] - about["low"]
        return about["low"] + self.array[f"{part}/{name}"][..., 0] / 255 * width, 0.51 * width / 255, (about["low"], about["high"])


def snapshot(folder, part, step):
    return h5py.File(os.path.join(folder, f"{part}_{step:010d}.hdf"), "r")["VTKHDF"]


def check_field(page, part, name, instant, expected):
    value, error, (low, high) = page.field(part, name)
    wrong = np.abs(value[instant] - np.clip(expected, low, high)).max()
    assert wrong <= error, f"{part}/{name} is wrong by {wrong} at instant {instant}, quantised to {error}"


@fact
def positions_and_fields_of_particles_are_those_of_the_snapshots(folder):
    run(LATTICE, folder, "--threads", "1")
    page = Page(folder, "--fields", "all")
    place, radius, step = page.places("particles")
    assert page.meta["steps"] == sorted(page.meta["steps"]) and len(page.meta["steps"]) == len(series(folder)) > 3
    for k, at in enumerate(page.meta["steps"]):
        grid = snapshot(folder, "particles", at)
        assert abs(page.meta["times"][k] - grid["FieldData/TimeValue"][0]) == 0
        assert (np.abs(place[k] - grid["Points"][:]) <= 0.51 * step + 1e-15).all()
        point = {name: data[:] for name, data in grid["PointData"].items()}
        assert np.abs(radius[k] - point["radius"]).max() < page.meta["particles"]["radius"] / 65535
        check_field(page, "particles", "damage", k, point["damage"])
        check_field(page, "particles", "displacement", k, np.linalg.norm(point["displacement"], axis=1))
        check_field(page, "particles", "velocity", k, np.linalg.norm(point["velocity"], axis=1))
        check_field(page, "particles", "stress_xx", k, point["stress"][:, 0])
        xx, yy, zz, xy, yz, xz = point["stress"].T
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1)[:, :page.meta["dimension"], :page.meta["dimension"]]
        check_field(page, "particles", "tension", k, np.linalg.eigvalsh(tensor)[:, -1])
        check_field(page, "particles", "pressure", k, -np.trace(tensor, axis1=1, axis2=2) / page.meta["dimension"])
    with results(folder) as file:  # the last snapshot is the end of the run
        assert (np.abs(place[-1] - file["particles/position"][:]) <= 0.51 * step + 1e-15).all()


@fact
def bonds_have_their_ends_times_causes_and_forces(folder):
    run(LATTICE, folder, "--threads", "1", "--set", "materials.block.tensile_strength=20 kPa")
    page = Page(folder)
    with results(folder) as file:
        i, j, state, time = (file["bonds/" + name][:] for name in ("i", "j", "state", "broken_time"))
    first = page.array["bond_first"].ravel()
    second = (first + page.array["bond_reach"].ravel()) % 2**32
    broken, cause = page.meta["bonds"]["broken"], page.array["bond_cause"].ravel()
    when = page.array["bond_time"].ravel().astype(np.uint32).view(np.float32)
    assert 0 < broken == np.isfinite(time).sum() and (np.diff(when) <= 0).all() and (cause[:-broken] == 0).all()
    expected = {(a, b): (s, np.float32(t)) for a, b, s, t in zip(i, j, state, time) if np.isfinite(t)}
    found = {(a, b): (s, t) for a, b, s, t in zip(first[-broken:], second[-broken:], cause[-broken:], when)}
    assert found == expected and {*zip(first, second)} == {*zip(i, j)}
    for k, step in enumerate(page.meta["steps"]):
        grid = snapshot(folder, "bonds", step)
        force = dict(zip(map(tuple, grid["Connectivity"][:].reshape(-1, 2)), grid["CellData/force"][:]))
        check_field(page, "bonds", "force", k, np.array([force[pair] for pair in zip(first, second)]))


@fact
def particles_of_sources_are_known_by_their_numbers_and_hidden_when_absent(folder):
    run(write_scene(folder, RAIN), folder, "--threads", "1")
    page = Page(folder)
    place, radius, step = page.places("particles")
    ids = np.unique(np.concatenate([snapshot(folder, "particles", at)["PointData/id"][:] for at in page.meta["steps"]]))
    there = radius > 0
    assert len(ids) == place.shape[1] and not there[0].all() and not there[-1].all() and there.sum() > there[0].sum()
    for k, at in enumerate(page.meta["steps"]):
        grid = snapshot(folder, "particles", at)
        kept = grid["PointData/removed"][:] == 0
        rows = np.searchsorted(ids, grid["PointData/id"][:][kept])
        assert set(rows) == set(np.flatnonzero(there[k]))
        assert (np.abs(place[k][rows] - grid["Points"][:][kept]) <= 0.51 * step + 1e-15).all()
    ends = {(page.array["bond_first"][0, 0, 0], page.array["bond_first"][0, 0, 0] + page.array["bond_reach"][0, 0, 0])}
    assert {tuple(ids[list(pair)]) for pair in ends} == {(0, 1)}


@fact
def elements_are_drawn_by_their_outer_facets(folder):
    run(ELEMENTS, folder, "--threads", "1")
    page = Page(folder, "--fields", "displacement")
    surface = next(s for s in page.meta["surfaces"] if s["kind"] == "elements")
    place, _, step = page.places(surface["name"])
    grid = snapshot(folder, "elements", page.meta["steps"][-1])
    cells = grid["Connectivity"][:].reshape(-1, page.meta["dimension"] + 1)
    corners = page.array[surface["name"] + "/0"].reshape(-1, 3)
    if page.meta["dimension"] == 3:
        faces = {}
        for cell in cells:
            for k in range(4):
                face = tuple(sorted(np.delete(cell, k)))
                faces[face] = faces.get(face, 0) + 1
        outer = [face for face, count in faces.items() if count == 1]
    else:
        outer = [tuple(sorted(cell)) for cell in cells]
    assert len(corners) == len(outer)
    used = np.unique(outer)
    assert (np.abs(place[-1] - grid["Points"][:][used]) <= 0.51 * step + 1e-15).all()
    assert {tuple(sorted(used[face])) for face in corners} == set(outer)
    check_field(page, surface["name"], "displacement", len(page.meta["steps"]) - 1, np.linalg.norm(grid["PointData/displacement"][:][used], axis=1))


@fact
def walls_move_as_the_history_says_and_curves_are_the_history(folder):
    run(UCS, folder, "--threads", "1")
    page = Page(folder)
    place, _, step = page.places("walls")
    columns = [column["name"] for column in page.meta["history"]["columns"]]
    table = {name: np.ascontiguousarray(page.array["history"][k, :, 0].astype(np.uint32)).view(np.float32) for k, name in enumerate(columns)}
    said = history(folder)
    for name in ("time", "strain", "stress"):
        assert np.allclose(table[name], said[name], rtol=1e-6, equal_nan=True)
    assert page.meta["plots"][0] == ["strain", "stress"]
    moved = {name: np.interp(page.meta["times"][-1], said["time"], said[name]) for name in said if re.fullmatch(r"wall_.*_displacement_[xyz]", name)}
    largest = max(moved.values(), key=abs)
    travel = (place[-1] - place[0]).reshape(-1, 4, 3).mean(axis=1)
    assert largest and np.abs(np.abs(travel).max() - abs(largest)) < 1.1 * step.max(), (largest, travel)


@fact
def options_choose_instants_and_fields(folder):
    run(LATTICE, folder, "--threads", "1")
    page = Page(folder, "--instants", "2", "--fields", "velocity,stress_xx")
    steps = [int(name[10:20]) for name, _ in series(folder)]
    assert page.meta["steps"] == [steps[0], steps[-1]] and [f["name"] for f in page.meta["fields"]] == ["velocity", "stress_xx"]
    expect(gneiss("view", folder, "--instants", "1"), 2, "--instants: expected a whole number from 2, found '1'")
    expect(gneiss("view", folder, "--instants", "many"), 2, "--instants: expected a whole number from 2, found 'many'")
    expect(gneiss("view", folder, "--fields", "colour"), 2, "--fields: expected names among .*velocity.*, found 'colour'")
    assert [f["name"] for f in Page(folder, "--fields", "damage, velocity ").meta["fields"]] == ["damage", "velocity"]
    for empty in ("", " ", "damage,,velocity"):
        expect(gneiss("view", folder, "--fields", empty), 2, f"--fields: expected names separated by commas, found an empty name in '{empty}'")


@fact
def what_cannot_be_shown_is_refused_by_its_reason(folder):
    expect(gneiss("view", folder), 2, "results.h5: no such file")
    run(LATTICE, folder, "--threads", "1", "--set", 'title="</script><script>alert(1)</script>{{meta}}"')
    page = Page(folder)
    assert page.text.count("</script>") == 3 and "alert(1)" in page.meta["title"]
    path = os.path.join(folder, series(folder)[1][0])
    with h5py.File(path, "r+") as file:
        del file["VTKHDF/Points"]
    expect(gneiss("view", folder), 2, "particles_.*damaged or not a snapshot")
    for name in glob.glob(os.path.join(folder, "*.hdf")):
        os.remove(name)
    expect(gneiss("view", folder), 2, "expected snapshots, found none")


@fact
def a_page_without_results_has_what_the_snapshots_have(folder):
    for number, scene in enumerate((LATTICE, ELEMENTS, write_scene(folder, RAIN))):
        out = os.path.join(folder, f"run{number}")
        run(scene, out, "--threads", "1")
        full = Page(out)
        os.remove(os.path.join(out, "results.h5"))
        expect(gneiss("view", out), 0, "note: results.h5 is written at the first checkpoint")
        bare = Page(out)
        assert bare.meta["title"] == f"run{number}" and "results.h5 is written at the first checkpoint" in bare.text
        assert not bare.meta["history"]["columns"] and not bare.meta["plots"] and "walls" not in bare.array
        same = [name for name in full.array if name != "history" and not name.startswith("walls")]
        assert same and same == list(bare.array) and all(np.array_equal(full.array[name], bare.array[name]) for name in same)
        assert all(full.meta[name] == bare.meta[name] for name in ("steps", "times", "dimension", "particles", "bonds", "fields", "up", "right", "low", "high"))
    expect(gneiss("view", out, "--paraview"), 0)


@fact
def snapshots_that_a_run_removes_meanwhile_are_left_out(folder):
    run(LATTICE, folder, "--threads", "1")
    name = series(folder)[1][0]
    script = f"""
import os, sys
sys.path.insert(0, {os.path.dirname(report_digest.__file__)!r})
import view, view_data
listed, calls = view_data.files_of, []
def files_of(folder):
    found = listed(folder)
    calls.append(0)
    if len(calls) == 1:
        os.remove(os.path.join(folder, {name!r}))
    elif sys.argv[1:] == ["always"]:
        found["particles"][7] = os.path.join(folder, "gone.hdf")
    return found
view_data.files_of = files_of
sys.exit(view.main([{folder!r}]))
"""
    for arguments, code, said in (((), 0, ""), (("always",), 2, "gone.hdf: the run removed this snapshot while it was read; try again")):
        shutil.copy(os.path.join(folder, name), os.path.join(folder, "kept"))
        expect(subprocess.run(["/usr/bin/python3", "-c", script, *arguments], capture_output=True, text=True, timeout=60), code, said)
        os.rename(os.path.join(folder, "kept"), os.path.join(folder, name))


def without_rights(*arguments):
    """A call without the rights of root, for which no file is closed."""
    try:
        return gneiss(*arguments, **({"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}))
    except PermissionError:
        raise Skip("only root can start the program") from None


@fact
def missing_rights_are_named_without_names_of_temporary_files(folder):
    os.chmod(folder, 0o755)
    run(LATTICE, folder, "--threads", "1")
    for name in ("results.h5", series(folder)[1][0]):
        path = os.path.join(folder, name)
        os.chmod(path, 0)
        for command in ("view", "report") if name == "results.h5" else ("view",):
            expect(without_rights(command, folder), 3, f"file error: .*{name}: cannot be read: Permission denied")
        if name == "results.h5":
            expect(without_rights("convert", folder, os.path.join(folder, "a.txt")), 3, f"{name}: cannot be read: Permission denied")
        os.chmod(path, 0o644)
    os.chmod(folder, 0o555)
    for options, name in (((), "view.html"), (("--paraview",), "paraview_state.py")):
        done = expect(without_rights("view", folder, *options), 3, f"file error: .*/{name}: cannot be written: Permission denied")
        assert ".report-" not in done.stderr and "matplotlib" not in done.stderr.lower(), done.stderr
    os.chmod(folder, 0o755)


@fact
def options_that_paraview_does_not_need_are_refused(folder):
    run(LATTICE, folder, "--threads", "1")
    for option, value in (("--instants", "5"), ("--fields", "damage")):
        expect(gneiss("view", folder, "--paraview", option, value), 2, f"{option}: --paraview writes every instant and every field")
    assert not os.path.exists(os.path.join(folder, "run.vtkhdf"))


@fact
def the_page_is_made_without_matplotlib(folder):
    tools = os.path.dirname(report_digest.__file__)
    done = subprocess.run(["/usr/bin/python3", "-X", "importtime", os.path.join(tools, "view.py"), folder], capture_output=True, text=True, timeout=60)
    assert "view_data" in done.stderr and not re.search(r"\| +matplotlib", done.stderr)


# Two grains fall on a ledge; their bond breaks there.
LEDGES = {
    "dimension": 3, "specimen": {"particles": [[0, 0, 3e-3, 1e-3], [0, 0, 5e-3, 1e-3]], "material": "m"},
    "materials": [{"name": name, "density": 2500, "normal_stiffness": 1e4, "kratio": 2, "bond_tension_limit": 1e-4, "bond_shear_limit": 1e-4} for name in "mn"],
    "law": {"stiffness": "uniform"}, "bonds": {"interaction_range": 0.01}, "gravity": [0, 0, -9.81],
    "bodies": [{"name": "still", "box": {"size": [4e-3, 4e-3, 1e-3]}, "origin": [-2e-3, -2e-3, 0], "stiffness": 1e4, "kratio": 2}],
    "time": {"end": 25e-3}, "output": {"history_rows": 20, "snapshots": 12}}


@fact
def surfaces_that_do_not_move_are_written_once(folder):
    run(write_scene(folder, LEDGES), os.path.join(folder, "still"), "--threads", "1")
    moving = {**LEDGES["bodies"][0], "motion": {"vz": [[0, 0], [9e-3, 0], [10e-3, 0.1], [1, 0.1]]}}
    run(write_scene(folder, {**LEDGES, "bodies": [moving]}, "moving.yaml"), os.path.join(folder, "moving"), "--threads", "1")
    steps = {name: [series(os.path.join(folder, name), part) for part in ("particles", "bodies")] for name in ("still", "moving")}
    assert len(steps["still"][1]) == 1 and len(steps["still"][0]) > 4
    late = [time for _, time in steps["moving"][1]]
    assert late[0] == 0 and len(late) < len(steps["moving"][0]) and late[1:] == [time for _, time in steps["moving"][0] if time > 9e-3], steps["moving"]
    page = Page(os.path.join(folder, "moving"))
    place = page.places("bodies")[0]
    first = [k for k, time in enumerate(page.meta["times"]) if time <= 9e-3]
    assert (place[first] == place[0]).all() and (place[-1] > place[0]).any()


@fact
def snapshots_say_when_bonds_broke_and_tell_materials_and_groups_apart(folder):
    runs = {"one": LEDGES, "two": {**LEDGES, "sets": [{"name": "upper", "select": {"ids": [1]}, "material": "n", "group": 2}]}}
    for name, scene in runs.items():
        run(write_scene(folder, scene, name + ".yaml"), os.path.join(folder, name), "--threads", "1")
    of = {name: snapshot(os.path.join(folder, name), "particles", 0)["PointData"] for name in runs}
    assert "group" not in of["one"] and list(of["one"]["material"][:]) == [0, 0]
    assert list(of["two"]["material"][:]) == [0, 1] and list(of["two"]["group"][:]) == [1, 2]
    with results(os.path.join(folder, "one")) as file:
        broken = file["bonds/broken_time"][:]
    assert np.isfinite(broken).all() and broken.min() > 0
    for name, _ in series(os.path.join(folder, "one"), "bonds"):
        with h5py.File(os.path.join(folder, "one", name)) as file:
            now, time = file["VTKHDF/FieldData/TimeValue"][0], file["VTKHDF/CellData/broken_time"][:]
        assert np.array_equal(time, np.where(broken <= now, broken, np.nan), equal_nan=True), (now, time, broken)


class Steps:
    """A part of run.vtkhdf as the specification of VTKHDF 2 says that it is read."""

    def __init__(self, file, part):
        self.group = file["VTKHDF"][part]
        self.steps = self.group["Steps"]

    def at(self, k):
        """{name: rows} of an instant, of points, cells and their arrays."""
        step, part = self.steps, self.steps["PartOffsets"][k]
        points, cells, links = (self.group[name][part] for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"))
        cell = step["CellOffsets"][k, 0]
        ranges = {"Points": (step["PointOffsets"][k], points), "Connectivity": (step["ConnectivityIdOffsets"][k, 0], links),
                  "Types": (cell, cells), "Offsets": (cell + part, cells + 1)}
        for kind, count in (("PointData", points), ("CellData", cells)):
            ranges.update({f"{kind}/{name}": (step[f"{kind}Offsets/{name}"][k], count) for name in self.group[kind]})
        return {name: self.group[name][begin:begin + count] for name, (begin, count) in ranges.items()}


@fact
def one_file_for_paraview_holds_all_snapshots(folder):
    for number, scene in enumerate((LATTICE, write_scene(folder, RAIN), ELEMENTS)):
        out = os.path.join(folder, str(number))
        run(scene, out, "--threads", "1")
        done = expect(gneiss("view", out, "--paraview"), 0)
        assert done.stdout.split() == [os.path.join(out, "paraview_state.py"), os.path.join(out, "run.vtkhdf")] and not os.path.exists(os.path.join(out, "view.html"))
        with h5py.File(os.path.join(out, "run.vtkhdf")) as file:
            parts = [name for name in file["VTKHDF"] if name != "Assembly"]
            assert parts == sorted(name for name in ("bonds", "elements", "particles") if os.path.exists(f"{out}/{name}.hdf.series"))
            for part in parts:
                listed, steps = series(out, part), Steps(file, part)
                assert list(steps.steps["Values"]) == [time for _, time in listed] and steps.steps.attrs["NSteps"] == len(listed)
                for k, (name, _) in enumerate(listed):
                    with h5py.File(os.path.join(out, name)) as grid:
                        for array, rows in steps.at(k).items():
                            assert np.array_equal(rows, grid["VTKHDF"][array], equal_nan=True), (part, k, array)
                if scene in (LATTICE, ELEMENTS):  # constant arrays are written once
                    assert len(steps.group["Types"]) == steps.group["NumberOfCells"][0] and len(steps.group["NumberOfCells"]) == 1
        compile(open(os.path.join(out, "paraview_state.py"), encoding="utf-8").read(), "paraview_state.py", "exec")


@fact
def a_browser_draws_all_kinds(folder):
    if not BROWSER:
        raise Skip("there is no chromium")
    for number, (scene, hash) in enumerate(((LATTICE, "bonds=1"), (write_scene(folder, RAIN), "time=0.5"), (ELEMENTS, "magnify=10"), (UCS, "cutx=0.5&cracks=time"))):
        out = os.path.join(folder, str(number))
        run(scene, out, "--threads", "1")
        page = Page(out)
        done = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=700,500",
                               f"--user-data-dir={folder}/browser", "--virtual-time-budget=20000", "--dump-dom", f"file://{out}/view.html#{hash}"],
                              capture_output=True, text=True, timeout=120)
        data = dict(re.findall(r'data-(\w+)="([^"]*)"', re.search(r"<body[^>]*>", done.stdout)[0]))
        assert "ready" in data and "fault" not in data, (data, done.stderr[-500:])
        assert int(data["vertices"]) >= 4 * page.meta["particles"]["count"] + sum(s["count"] for s in page.meta["surfaces"]) > 0, data


sys.exit(main())
