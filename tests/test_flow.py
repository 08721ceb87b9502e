"""Sources and sinks in the files of a run: rows that change in number, ids that stay, resumed runs. Speaks TAP."""
from program import *  # noqa: F403

REFERENCE = tempfile.mkdtemp(prefix="gneiss-flow-")

# Two bonded grains on a floor, grains that fall beside them and run over an edge.
SCENE = {
    "dimension": 3, "specimen": {"particles": [[0, 0, 1e-3, 1e-3], [2e-3, 0, 1e-3, 1e-3], [30e-3, 0, 1e-3, 1e-3]]},
    "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e4, "kratio": 2, "friction": 0.3,
                   "bond_tension_limit": 10, "bond_shear_limit": 10}],
    "law": {"stiffness": "uniform"}, "bonds": {"interaction_range": 0.01},
    "damping": {"contact": {"restitution": 0.5}}, "gravity": [2, 0, -9.81],
    "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "stiffness": 1e4, "kratio": 2, "friction": 0.2}],
    "sets": [{"name": "a", "select": {"ids": [2]}, "initial_velocity": [3, 0, 0]}],
    "sources": [{"name": "rain", "box": {"size": [10e-3, 10e-3, 5e-3]}, "origin": [10e-3, -5e-3, 5e-3], "rate": 2000,
                 "mean_radius": 0.8e-3, "size_ratio": 1.5, "velocity": [0.3, 0, -0.5]}],
    "sinks": [{"name": "edge", "plane": {"point": [30e-3, 0, 0], "normal": [1, 0, 0]}}],
    "domain": {"min": [-0.1, -0.01, -0.1], "max": [0.1, 0.01, 0.1], "lost": "remove"},
    "time": {"end": 0.12}, "output": {"history_rows": 100, "snapshots": 6}, "run": {"threads": 1}}


def reference():
    """A run that was never stopped, made once."""
    folder = os.path.join(REFERENCE, "run")
    if not os.path.exists(os.path.join(folder, "summary.json")):
        run(write_scene(REFERENCE, SCENE), folder)
    return folder


@fact
def rows_are_by_id_and_no_id_comes_twice(folder):
    with results(reference()) as file:
        ids = file["particles/id"][:].reshape(-1)
        assert (np.diff(ids) > 0).all() and ids[0] == 0
        assert ids[-1] > len(ids), "rows of those that are gone are used again"
        assert len(file["particles/position"]) == len(ids)


@fact
def energy_removed_by_a_sink_before_the_first_step_was_stored_at_the_start(folder):
    """A moving grain is in the sink at the start, another passes it."""
    given = {key: SCENE[key] for key in ("dimension", "materials", "law", "bonds", "run")}
    given.update(specimen={"particles": [[0, 0, 0, 1e-3], [10e-3, 0, 0, 1e-3]], "group": 0},
                 sets=[{"name": "all", "select": {"all": True}, "initial_velocity": [1, 0, 0]}],
                 sinks=[{"name": "here", "box": {"size": [4e-3, 4e-3, 4e-3]}, "origin": [-2e-3, -2e-3, -2e-3]}], time={"end": 1e-3})
    run(write_scene(folder, given), os.path.join(folder, "out"))
    with results(os.path.join(folder, "out")) as file:
        assert file["history/sink_here_number"][-1] == 1
        assert abs(file["history/energy_residual"][:]).max() < 1e-12, file["history/energy_residual"][:]


@fact
def bonds_are_between_rows(folder):
    with results(reference()) as file:
        i, j = file["bonds/i"][:].reshape(-1), file["bonds/j"][:].reshape(-1)
        ids = file["particles/id"][:].reshape(-1)
        assert list(ids[i]) == [0] and list(ids[j]) == [1]


@fact
def snapshots_have_as_many_points_as_there_were_rows(folder):
    sizes = []
    for name, _ in series(reference()):
        with h5py.File(os.path.join(reference(), name), "r") as file:
            points, ids = file["VTKHDF/Points"], file["VTKHDF/PointData/id"][:]
            assert len(points) == len(ids) and (np.diff(ids) > 0).all()
            sizes.append(len(points))
    with results(reference()) as file:
        assert sizes[-1] == len(file["particles/id"]) and len(set(sizes)) > 3, sizes


@fact
def particles_balance_sources_and_sinks_in_every_row(folder):
    h = history(reference())
    came, went, there = h["source_rain_number"], h["sink_edge_number"], h["particles"]
    with results(reference()) as file:
        lost = np.searchsorted(np.sort(file["lost/time"][:].reshape(-1)), h["time"], side="right") if "lost" in file else 0
    assert (there == came + 3 - went - lost).all()
    assert went[-1] > 50 and (np.diff(came) >= 0).all() and (np.diff(went) >= 0).all()
    # The rate of a row refers to the interval before it: the sum of rates times intervals is the mass.
    between = np.diff(h["time"])
    assert abs((h["sink_edge_rate"][1:] * between).sum() - h["sink_edge_mass"][-1]) < 0.02 * h["sink_edge_mass"][-1]


@fact
def a_plan_counts_the_steps_that_grains_will_need(folder):
    """By Hertz's law steps become shorter once grains touch, and at first there are no grains."""
    scene = {
        "dimension": 3, "materials": [{"name": "m", "density": 2500, "young": 1e7, "poisson": 0.25, "friction": 0.3, "restitution": 0.5}],
        "law": {"stiffness": "hertz"}, "gravity": [0, 0, -9.81],
        "walls": [{"name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "sources": [{"name": "rain", "box": {"size": [20e-3, 20e-3, 5e-3]}, "origin": [0, 0, 40e-3], "rate": 1000, "total": 60,
                     "mean_radius": 1e-3}],
        "domain": {"min": [-1, -1, -0.1], "max": [1, 1, 0.2]}, "time": {"end": 0.3}, "output": {"snapshots": 0}, "run": {"threads": 1}}
    path = write_scene(folder, scene)
    said = gneiss("plan", path).stdout
    steps = float(re.search(r"^  steps +(\d+) to", said, re.M)[1])
    run(path, os.path.join(folder, "out"))
    took = summary(os.path.join(folder, "out"))["steps"]
    assert "60 particles" in said and 0.7 < steps / took < 1.4, (steps, took, said)


@fact
def every_column_of_the_history_has_numbers(folder):
    """If particles enter and leave there is no average strain, in scenes with sources only or with other particles as
    well."""
    alone = {key: value for key, value in SCENE.items() if key not in ("specimen", "sets", "bonds")}
    alone.update(time={"end": 0.02}, materials=[{k: v for k, v in SCENE["materials"][0].items() if "bond" not in k}])
    run(write_scene(folder, alone), os.path.join(folder, "alone"))
    for out in (reference(), os.path.join(folder, "alone")):
        rows = history(out)
        assert not [name for name in rows if name.startswith("strain")], list(rows)
        assert all(np.isfinite(values).all() for values in rows.values()), [n for n, v in rows.items() if not np.isfinite(v).all()]


@fact
def the_summary_counts_them(folder):
    said = summary(reference())
    source, sink = said["sources"][0], said["sinks"][0]
    h = history(reference())
    assert source["name"] == "rain" and source["number"] == h["source_rain_number"][-1]
    assert sink["name"] == "edge" and sink["steady_rate"] > 0
    assert said["counts"]["particles"] == h["particles"][-1]
    assert abs(said["energy_residual"]) < 0.005


@fact
def a_later_end_on_resume_equals_a_straight_run(folder):
    place = os.path.join(folder, "run")
    run(write_scene(folder, SCENE), place, "--set", "time.end=0.05", "--set", "output.history_rows=41",
        "--set", "output.snapshots=2")
    resume(place, "--set", "time.end=0.12")
    assert state_hash(place) == state_hash(reference())
    assert summary(place)["sources"] == summary(reference())["sources"]


@fact
def another_run_begins_with_those_that_are_left(folder):
    scene = {key: value for key, value in SCENE.items() if key not in ("sources", "sinks", "sets")}
    scene["domain"] = {"min": [-1, -1, -1], "max": [1, 1, 1]}  # particles that left the domain slightly since the last lists are not yet removed
    scene["specimen"] = {"from": reference(), "from_bonds": "keep"}
    run(write_scene(folder, {**scene, "time": {"end": 0.001}}), os.path.join(folder, "run"))
    with results(os.path.join(folder, "run")) as file:
        assert len(file["particles/id"]) == summary(reference())["counts"]["particles"]
        assert len(file["bonds/i"]) == 1


@fact
def the_report_draws_what_flows(folder):
    expect(gneiss("report", reference()), 0)
    assert os.path.getsize(os.path.join(reference(), "report", "flow.png")) > 10000


@fact
def a_source_in_a_sink_is_warned_of_by_name(folder):
    scene = {k: v for k, v in SCENE.items() if k not in ("specimen", "sets", "bonds", "output", "domain")}
    scene["sinks"] = [{"name": "all", "plane": {"point": [0, 0, -0.01], "normal": [0, 0, 1]}}]
    expect(gneiss("check", write_scene(folder, scene)), 2, r": sources\[0\]: expected particles that no sink removes on entry, found that sink 'all' removes those of source 'rain'")
    scene["sinks"] = SCENE["sinks"]
    expect(gneiss("check", write_scene(folder, scene)), 0, "")


if __name__ == "__main__":
    code = main()
    shutil.rmtree(REFERENCE, ignore_errors=True)
    sys.exit(code)
