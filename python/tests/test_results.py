"""Results, commands of the program and sweeps in Python. Speaks TAP."""
import builtins
import contextlib
import threading

import h5py
import pandas

from module import *  # noqa: F403


@contextlib.contextmanager
def without(*names):
    """Makes modules appear not to be installed."""
    real = builtins.__import__

    def refuse(name, *arguments, **options):
        if name.split(".")[0] in names:
            raise ImportError(name)
        return real(name, *arguments, **options)

    builtins.__import__ = refuse
    try:
        yield
    finally:
        builtins.__import__ = real


@fact
def results_of_a_run_are_arrays_tables_and_datasets(folder):
    results = gneiss.run(LATTICE, os.path.join(folder, "run"), set={"run.threads": 1})
    with h5py.File(results.path) as file:
        for group in ("history", "particles", "bonds", "events"):
            for name in file[group]:
                assert np.array_equal(results.group(group)[name], file[group][name][()], equal_nan=True), (group, name)
        for name in file["readings"]:
            value = file["readings"][name][0]
            assert results.readings[name] == value or (value != value and name in results.readings.absent)
    assert results.history.table().attrs["units"]["stress"] == "Pa" and results.bonds.table().attrs["units"]["force_1"] == "N"
    assert results.attributes["state_hash"] == results.summary["state_hash"] and results.attributes["finished"] == 1
    table = results.history.table()
    assert isinstance(table, pandas.DataFrame) and np.array_equal(table["time"], results.history.time)
    assert list(results.bonds.table().filter(like="force_")) == ["force_0", "force_1", "force_2"]
    data = results.dataset("history", "particles")
    assert data["history_time"].attrs["unit"] == "s" and data["particles_position"].shape == (150, 3)
    assert results.history.about["stress"].unit == "Pa" and "lattice" in results.scene
    assert raised(KeyError, lambda: results.history["colour"]) and raised(AttributeError, lambda: results.colour)
    assert raised(gneiss.InputError, gneiss.Results, folder)


@fact
def tables_are_structured_arrays_without_pandas(folder):
    with gneiss.World(LATTICE) as world:
        world.run()
        frame = world.history.table()
        with without("pandas"):
            rows = world.history.table()
        assert not isinstance(rows, pandas.DataFrame) and np.array_equal(rows["stress"], frame["stress"])


@fact
def a_dict_runs_again_into_its_folder(folder):
    out = os.path.join(folder, "run")
    for _ in range(2):
        gneiss.run(PAIR, out, folder=folder)
    error = raised(gneiss.InputError, gneiss.run, PAIR | {"title": "another"}, out, folder=folder)
    assert "--" not in str(error) and os.listdir(folder) == ["run"], (str(error), os.listdir(folder))
    threads = [threading.Thread(target=gneiss.run, args=(PAIR, os.path.join(folder, str(k))), kwargs={"folder": folder}) for k in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert sorted(os.listdir(folder)) == ["0", "1", "2", "3", "run"]
    assert all(gneiss.Results(os.path.join(folder, str(k))).attributes["finished"] for k in range(4))


@fact
def a_world_gives_the_dataset_of_its_results(folder):
    with gneiss.World(LATTICE, os.path.join(folder, "run")) as world:
        world.run()
        ours, theirs = world.dataset(), gneiss.Results(os.path.join(folder, "run")).dataset()
    for name in ("history_stress", "particles_position", "bonds_force"):
        assert np.allclose(ours[name], theirs[name]) and ours[name].attrs == theirs[name].attrs, name


@fact
def packings_and_elastic_constants_come_from_dicts(folder):
    specimen = {"rectangle": {"width": "40 mm", "height": "20 mm"}, "particles": 60}
    packing = gneiss.pack({"dimension": 2, "specimen": specimen}, os.path.join(folder, "pack"), set={"run.threads": 1})
    assert packing.particles.position.shape == (60, 3) and 0 < packing.quality.porosity < 0.5
    scene = {"dimension": 2, "specimen": {"file": os.path.join(folder, "pack", "packing.txt"), "group": 1},
             "materials": [{"name": "rock", "density": 2600, "contact_modulus": "20 GPa", "kratio": 2,
                            "tensile_strength": "10 MPa", "shear_strength": "30 MPa"}],
             "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.1}, "time": {"end": "1 ms"}}
    constants = gneiss.stiffness(scene, set={"run.threads": 1})["network"]
    doubled = gneiss.stiffness(scene, set={"run.threads": 1, "materials.rock.contact_modulus": "40 GPa"})["network"]
    assert abs(doubled["young_modulus"] / constants["young_modulus"] - 2) < 1e-6


@fact
def a_sweep_from_a_dict_has_parameters_and_readings(folder):
    what = {"scene": LATTICE, "parameters": {"materials.block.friction": [0.2, 0.6], "output.snapshots": 0}}
    results = gneiss.sweep(what, os.path.join(folder, "sweep"), threads=1)
    assert list(results.parameters["materials.block.friction"]) == [0.2, 0.6]
    assert (results.runs.status == 2).all() and np.isfinite(results.readings["peak_stress"]).all()
    with gneiss.World(LATTICE, set={"materials.block.friction": 0.6}) as world:
        world.run()
        assert world.readings["peak_stress"] == results.readings["peak_stress"][1]


@fact
def plans_and_reports_are_made(folder):
    with gneiss.World(LATTICE) as world:
        for found in (gneiss.plan(LATTICE), gneiss.check(LATTICE)):
            assert (found["particles"], found["bonds"]) == (world.counts.particles, world.counts.bonds) and found["steps"] > 0
    gneiss.run(LATTICE, os.path.join(folder, "run"))
    assert os.path.getsize(gneiss.report(os.path.join(folder, "run"))) > 1000
    assert os.path.getsize(gneiss.view(os.path.join(folder, "run"), instants=2, fields=["velocity"])) > 10000


@fact
def what_the_program_refuses_is_an_exception_with_its_place(folder):
    bad = {**PAIR, "law": {"stiffness": "soft"}}
    error = raised(gneiss.InputError, gneiss.run, bad, os.path.join(folder, "bad"), folder=folder)
    assert error.key == "law.stiffness" and error.line > 0 and error.file.startswith(folder) and os.listdir(folder) == []
    assert raised(gneiss.InputError, gneiss.plan, LATTICE, error="5 apples")
    assert raised(gneiss.InputError, gneiss.calibrate, {"title": "nothing"}, os.path.join(folder, "c"))
    os.mkdir(os.path.join(folder, "shut"))
    assert raised(gneiss.GneissError, gneiss.report, os.path.join(folder, "shut")).status == 2
    assert raised(gneiss.GneissError, gneiss.view, os.path.join(folder, "shut")).status == 2
    error = raised(gneiss.Unstable, gneiss.run, LATTICE, os.path.join(folder, "run"), set={"time.end": "100 s"})
    assert "left the domain" in str(error)


if __name__ == "__main__":
    sys.exit(main())
