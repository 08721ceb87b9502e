"""Scenes, worlds, fields, errors and saving in Python. Speaks TAP."""
import contextlib
import copy
import gc
import pickle
import resource
import signal
import threading

import yaml

from module import *  # noqa: F403


# --- scenes ---

@fact
def a_scene_is_the_same_from_a_file_a_text_and_a_dict(folder):
    with open(LATTICE, encoding="utf-8") as file:
        text = file.read()
    scenes = [gneiss.Scene(LATTICE), gneiss.Scene(text, name=LATTICE), gneiss.Scene(yaml.safe_load(text), name=LATTICE)]
    hashes = set()
    for scene in scenes:
        with gneiss.World(scene) as world:
            world.step(50)
            hashes.add(world.hash)
    assert len(hashes) == 1 and len({scene.text for scene in scenes}) == 1


@fact
def values_carry_units_as_text_or_are_in_si(folder):
    changed = {**PAIR, "time": {"end": 0.01}, "specimen": {"particles": np.array([[0, 0, 0, 1e-3], [9e-3, 0, 0, 1e-3]])}}
    assert gneiss.Scene(changed).text == gneiss.Scene(PAIR).text
    assert "end: 0.002" in gneiss.Scene(PAIR, set={"time.end": "2 ms"}).text
    assert yaml.safe_load(gneiss.Scene(PAIR, set={"gravity": [0, 0, -9.8]}).text)["gravity"] == [0, 0, -9.8]
    assert raised(ValueError, gneiss.Scene, {**PAIR, "time": {"end": float("nan")}})
    assert raised(TypeError, gneiss.Scene, {**PAIR, "time": {"end": 1j}})


@fact
def errors_have_the_place_and_the_key_of_every_problem(folder):
    bad = {**PAIR, "materials": [{"name": "a", "densty": 1}], "law": {"stiffness": "soft"}}
    error = raised(gneiss.InputError, gneiss.Scene, bad, name="mine")
    by_key = {problem.key: problem for problem in error.problems}
    assert "materials[0].densty" in by_key and "did you mean 'density'" in by_key["materials[0].densty"].message
    lines = gneiss.scene.written(bad).splitlines()
    assert '"densty"' in lines[by_key["materials[0].densty"].line - 1]
    assert "law.stiffness" in by_key and '"soft"' in lines[by_key["law.stiffness"].line - 1]
    assert error.file == "mine" and error.status == 2 and isinstance(error, ValueError)
    path = os.path.join(folder, "s.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write("time: {end: 3 kg}\n")
    error = raised(gneiss.InputError, gneiss.World, path)
    assert (error.file, error.line) == (path, 1) and any(problem.key == "time.end" for problem in error.problems), error.problems
    error = raised(gneiss.InputError, gneiss.Scene, PAIR, set={"time.end": "-1 s"})
    assert error.key == "time.end" and error.file == "--set"
    assert raised(gneiss.InputError, gneiss.World, os.path.join(folder, "none.yaml"))


# --- worlds ---

@fact
def a_world_stepped_from_python_has_the_bits_of_the_program(folder):
    for name in ("lattice-small", "elements", "polygon"):
        path = os.path.join(SCENES, name + ".yaml")
        run(path, os.path.join(folder, name), "--threads", 1)
        with gneiss.World(path, set={"run.threads": 1}) as world:
            world.run()
            assert world.progress.finished
            assert world.hash == state_hash(os.path.join(folder, name)), name


@fact
def a_run_in_a_folder_leaves_the_files_of_the_program(folder):
    ours, theirs = os.path.join(folder, "ours"), os.path.join(folder, "theirs")
    run(LATTICE, theirs)
    with gneiss.World(LATTICE, ours) as world:
        world.run(progress=False)
    assert sorted(os.listdir(ours)) == sorted(name for name in os.listdir(theirs) if name != "status.json")  # files of the process
    assert summary(ours)["readings"] == summary(theirs)["readings"]


@fact
def steps_and_times_end_an_advance(folder):
    with gneiss.World(LATTICE) as world:
        assert world.step(7) == 7 == world.steps and world.step() == 1
        world.run(until="0.1 ms")
        assert abs(world.time - 1e-4) <= 0.5 * world.dt and not world.progress.finished
        world.run(until=lambda w: w.counts.broken_tension > 3, every=5)
        assert world.counts.broken_tension > 3 and world.steps % 5 == 0
        world.run()
        assert world.progress.finished and "reached" in world.progress.stop_reason
        assert raised(gneiss.InputError, world.step, -1) and raised(gneiss.InputError, world.run, "2 parsecs")


@fact
def a_closed_world_is_refused_and_its_arrays_stay(folder):
    with gneiss.World(LATTICE) as world:
        position, particles = world.particles["pos"], world.particles
        kept = position.copy()
    assert world.closed and "closed" in repr(world)
    assert raised(ValueError, world.step) and raised(ValueError, lambda: world.particles) and raised(ValueError, lambda: world.time)
    del particles
    gc.collect()
    with gneiss.World(LATTICE) as other:  # takes the memory that is free
        other.step(100)
        assert (position == kept).all()


# --- fields ---

@fact
def fields_are_views_of_the_engines_own_memory(folder):
    with gneiss.World(LATTICE) as world:
        for record in (world.particles, world.bonds, world.pairs, world.wall_contacts):
            for name, values in record.items():
                view = record._view(name)
                if values.size:
                    assert values.ctypes.data == int(gneiss._library.ffi.cast("uintptr_t", view.data)), (record.name, name)
                    assert not values.flags.owndata
                assert not values.flags.writeable or not values.size
                assert values.shape == ((view.count,) if view.components == 1 else (view.count, view.components))
                assert record.about[name].unit
        assert raised(ValueError, world.particles["pos"].__setitem__, (0, 0), 1.0)
        before = gneiss._library.lib.gneiss_world_hash(world._c)
        assert world.particles.position.base is not None and world.hash == f"{before:016x}"


@fact
def an_array_outlives_the_memory_that_it_shows(folder):
    with gneiss.World(LATTICE) as world:
        old = [world.particles.position, world.pairs["i"], world.bonds["kn"], world.history["time"]]
        kept = old[0].copy()
        world.step(600)  # lists were rebuilt: particles have other places in memory
        assert world.counts.list_rebuilds > 1
        assert all(np.isfinite(values.astype(float)).all() for values in old)
        new = world.particles
        order = np.argsort(new["id"])
        assert np.abs(new.position[order]).max() < 1.0 and not np.array_equal(kept, new.position)


@fact
def parts_of_rows_have_names_and_outputs_are_those_of_the_files(folder):
    with gneiss.World(LATTICE, os.path.join(folder, "run")) as world:
        p = world.particles
        assert np.array_equal(p.position, p.pos[:, :3]) and np.array_equal(p.radius, p.pos[:, 3])
        assert np.allclose(p.mass, 2000 * 4 / 3 * np.pi * p.radius ** 3, rtol=1e-12)
        world.run()
        results = gneiss.Results(os.path.join(folder, "run"))
        for name in world.particles.outputs:
            assert np.allclose(world.particles.output(name), results.particles[name], rtol=1e-12, atol=0), name
        assert np.array_equal(world.history["time"], results.history["time"])
        for name, value in world.readings.items():
            assert value != value or value == results.readings[name]
        assert world.energy["work_walls"] == results.energy["work_walls"]
    assert raised(KeyError, lambda: p["colour"]) and raised(AttributeError, lambda: p.colour)
    assert raised(KeyError, p.output, "colour")


@fact
def energies_say_of_which_step_they_are(folder):
    with gneiss.World(LATTICE) as world:
        assert world.energy.step == -1 and np.isnan(world.energy.time)
        stale = 0
        for _ in range(60):
            world.step()
            row = {name: world.history[name][-1] for name in ("step", "time", "energy_kinetic")}
            assert world.energy.step == row["step"] and world.energy.time == row["time"] and world.energy["kinetic"] == row["energy_kinetic"]
            stale += world.steps - 1 != world.energy.step
        assert 0 < stale < 60
        other = world.copy()
        assert other.energy.step == world.energy.step and other.energy.time == world.energy.time
        world.run()
        assert world.energy.step == world.steps - 1 and abs(world.energy.time + world.dt - world.time) < 1e-9 * world.time
    with gneiss.World(LATTICE, set={"output.energy": "off"}) as world:
        world.step()
        assert world.energy.step == -1


@fact
def attributes_that_have_no_effect_are_refused(folder):
    with gneiss.World(LATTICE) as world:
        for thing, name in ((world, "velocity"), (world, "gravity"), (world, "particles"), (world, "step"), (world, "time"),
                            (world.energy, "kinetic"), (world.readings, "peak_stress"), (world.particles, "mass"), (world.particles, "size"),
                            (world.history, "stress")):
            assert raised(AttributeError, setattr, thing, name, 5), name
        assert raised(ValueError, world.particles.mass.__setitem__, 0, 99.0)
        for thing in (world.particles, world.history, world.energy, gneiss.Scene(PAIR)):
            assert "pickle" in str(raised(TypeError, pickle.dumps, thing))


@fact
def arguments_are_refused_with_what_was_expected_and_found(folder):
    with gneiss.World(LATTICE) as world:
        for kind, text, function, *arguments in (
                (TypeError, "1.5", world.step, 1.5), (TypeError, "'3'", world.step, "3"), (TypeError, "'5'", world.every, "5"),
                (TypeError, "function", world.every, 5, 3), (TypeError, "function", world.force, 3),
                (TypeError, "complex", setattr, world, "velocities", 1j), (ValueError, "(7, 3)", setattr, world, "velocities", np.zeros((7, 3))),
                (TypeError, "complex", world.run, 1j), (ValueError, "nan", world.run, "nan"), (ValueError, "inf", world.at, np.inf, print),
                (ValueError, "number of frames", world.animate, 0), (ValueError, "(7,)", world.plot, np.zeros(7))):
            assert text in str(raised(kind, function, *arguments)), (function, arguments)
        assert "vz of 'top', m/s" in str(raised(TypeError, world.set_motion, "top", vz="1 m"))
        for options in ({"cut": ("q", 0)}, {"cut": "y"}, {"view": "q"}):
            assert raised(gneiss.InputError, world.plot, **options)
        assert "without" in str(raised(gneiss.InputError, world.force, print, on="nodes"))
        world.step(100)
        assert "present" in str(raised(gneiss.InputError, world.at, [1e-9, 1.0], print))
        assert "present" in str(raised(gneiss.InputError, world.run, 1e-9)) and world.steps == 100
        world.run(world.time)
        assert world.steps == 100
    spoiled = {**PAIR, "specimen": {"particles": np.array([[0, 0, 0, 1e-3], [np.nan, 0, 0, 1e-3]])}}
    assert raised(gneiss.InputError, gneiss.Scene, spoiled).key == "specimen.particles[1][0]"
    assert raised(gneiss.InputError, gneiss.Scene, PAIR, set={"time.end": np.inf}).key == "time.end"
    assert "time.end" in str(raised(TypeError, gneiss.Scene, {**PAIR, "time": {"end": 1j}}))


# --- signals, threads, saving ---

@fact
def ctrl_c_ends_a_run_between_two_steps(folder):
    with gneiss.World(PAIR, set={"time.end": "100 s"}) as world:
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        raised(KeyboardInterrupt, world.run)
        timer.join()
        reached = world.steps
        assert reached > 0 and world.step(3) == 3 and world.steps == reached + 3


@fact
def ctrl_c_leaves_a_checkpoint_in_the_folder(folder):
    def press(world):
        if not world.steps % 80:
            raise KeyboardInterrupt

    for k, advance in enumerate((gneiss.World.run, lambda world: world.step(200))):
        with gneiss.World(LATTICE, os.path.join(folder, str(k))) as world:
            world.every(1, press)
            raised(KeyboardInterrupt, advance, world)
        with gneiss.World.resume(os.path.join(folder, str(k))) as again:
            assert again.steps == 80
    with contextlib.suppress(KeyboardInterrupt), gneiss.World(LATTICE, os.path.join(folder, "own")) as world:
        world.step(30)
        raise KeyboardInterrupt
    with gneiss.World.resume(os.path.join(folder, "own")) as again:
        assert again.steps == 30


@fact
def threads_step_different_worlds_and_not_one(folder):
    expected = []
    with gneiss.World(LATTICE) as world:
        world.step(300)
        expected = [world.hash] * 4
    worlds = [gneiss.World(LATTICE) for _ in range(4)]
    threads = [threading.Thread(target=world.step, args=(300,)) for world in worlds]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert [world.hash for world in worlds] == expected
    world, refused = worlds[0], []
    inside = threading.Event()
    world.every(1, lambda w: (inside.set(), time.sleep(0.05)))
    thread = threading.Thread(target=world.step, args=(2,))
    thread.start()
    assert inside.wait(20)
    refused.append(raised((RuntimeError, gneiss.InputError), world.step))
    thread.join()
    [world.close() for world in worlds]


@fact
def a_world_is_copied_pickled_saved_and_resumed_to_the_same_bits(folder):
    with gneiss.World(LATTICE) as world:
        world.step(120)
        others = [world.copy(), copy.copy(world), copy.deepcopy(world), pickle.loads(pickle.dumps(world))]
        world.save(os.path.join(folder, "w.h5"))
        others.append(gneiss.World.load(os.path.join(folder, "w.h5")))
        world.step(100)
        for other in others:
            other.step(100)
            assert other.hash == world.hash
            other.close()
    with gneiss.World(LATTICE, os.path.join(folder, "run")) as world:
        world.step(100)
        world.checkpoint()
    with gneiss.World.resume(os.path.join(folder, "run")) as again:
        assert again.steps == 100
        again.run()
    run(LATTICE, os.path.join(folder, "whole"))
    assert summary(os.path.join(folder, "run"))["state_hash"] == summary(os.path.join(folder, "whole"))["state_hash"]
    with open(os.path.join(folder, "none.h5"), "w", encoding="utf-8") as file:
        file.write("no checkpoint")
    assert raised(gneiss.InputError, gneiss.World.load, os.path.join(folder, "none.h5"))


@fact
def worlds_that_are_made_and_freed_leak_nothing(folder):
    scene = gneiss.Scene(LATTICE)

    def make(count):
        for k in range(count):
            world = gneiss.World(scene)
            world.every(5, lambda w: w.particles["pos"])
            world.force(lambda p: None)
            world.step(10)
            if k % 2:
                world.close()
        del world
        gc.collect()
        with open("/proc/self/statm", encoding="utf-8") as file:
            return int(file.read().split()[1]) * resource.getpagesize()

    first = make(60)
    grown = make(120) - first
    assert grown < 2e6, f"{grown / 120:.0f} bytes a world"  # a world has about 1 MB


if __name__ == "__main__":
    sys.exit(main())
