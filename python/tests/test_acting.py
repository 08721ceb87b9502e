"""Calls, fields of force, velocities, motions and prepared specimens in Python. Speaks TAP."""
import gc
import signal
import weakref

from module import *  # noqa: F403


class Wrong(Exception):
    pass


# --- calls ---

@fact
def calls_come_every_n_steps_and_at_times(folder):
    with gneiss.World(LATTICE) as world:
        steps, times = [], []

        @world.every(7)
        def note(own):
            assert own is world
            steps.append(own.steps)

        hook = world.at(["0.02 ms", 3e-5], lambda own: times.append(own.time))
        world.step(40)
        assert steps == [7, 14, 21, 28, 35]
        dt = world.dt
        assert len(times) == 2 and abs(times[0] - 2e-5) <= 0.5 * dt and abs(times[1] - 3e-5) <= 0.5 * dt
        note.remove()
        note.remove()
        hook.remove()
        world.step(20)
        assert len(steps) == 5


@fact
def a_call_sees_whole_steps_and_changes_no_bit(folder):
    seen, folder = [], os.path.join(folder, "run")
    with gneiss.World(LATTICE, folder) as world:
        world.every(1, lambda own: seen.append((own.steps, len(own.history["time"]), own.energy["residual"])))
        world.every(50, lambda own: own.save(os.path.join(folder, "kept.h5")))
        world.run()
        assert [step for step, _, _ in seen] == list(range(1, world.steps + 1)) and seen[0][1] == 1
        digits = world.hash
    with gneiss.World.load(os.path.join(folder, "kept.h5")) as again:
        assert again.steps % 50 == 0
        again.run()
        assert again.hash == digits
    run(LATTICE, os.path.join(folder, "plain"))
    assert state_hash(os.path.join(folder, "plain")) == digits


@fact
def a_call_can_stop_the_world_and_its_exceptions_arrive(folder):
    with gneiss.World(LATTICE) as world:
        def act(own):
            if own.steps == 20:
                own.stop()
            if own.steps == 40:
                raise Wrong("at 40")
            if own.steps == 60:
                own.step()
            if own.steps == 80:
                own.close()

        world.every(10, act)
        assert world.step(100) == 20
        assert raised(Wrong, world.step, 100) and world.steps == 40
        assert raised(gneiss.InputError, world.step, 100) and world.steps == 60
        assert raised(RuntimeError, world.run) and world.steps == 80
        world.run()
        assert world.progress.finished
        assert raised(gneiss.InputError, world.every, 0, act)


@fact
def a_call_may_remove_itself_and_add_others(folder):
    with gneiss.World(LATTICE) as world:
        seen = []

        def add(own):
            seen.append(own.steps)
            for hook in list(own._hooks.values()):
                hook.remove()
            del hook
            gc.collect()
            own.every(5, add)

        world.every(5, add)
        assert world.step(30) == 30 and seen == [5, 10, 15, 20, 25, 30]


@fact
def a_world_with_calls_is_freed_when_nothing_refers_to_it(folder):
    world = gneiss.World(PAIR)
    world.every(1, lambda own: None)
    world.force(lambda points: None)
    world.step(3)
    reference = weakref.ref(world)
    del world
    gc.collect()
    assert reference() is None


# --- fields of force ---

@fact
def a_spring_to_a_path_follows_its_closed_form_and_the_ledger_closes(folder):
    """The end of the spring moves along x with v: m y'' = -k y for the lag y, whose amplitude is v/w."""
    k, v = 50.0, 2.0
    with gneiss.World({**PAIR, "time": {"end": "2 ms"}}) as world:
        start, mass = world.particles.position.copy(), world.particles.mass[0]

        @world.force(stiffness=k)
        def pull(points):
            home = start[points.id]
            home[:, 0] += v * points.time
            points.force[:] = -k * (points.position - home)

        world.run()
        w, order = np.sqrt(k / mass), np.argsort(world.particles.id)
        moved = (world.particles.position[order] - start)[:, 0]
        expected = v * world.time - v / w * np.sin(w * world.time)
        # Leap-frog has the frequency to (w dt)^2/24, and its second half step at the start an error of w dt times that of the path.
        assert abs(moved / expected - 1).max() < 2 * w * world.dt, moved / expected
        assert abs(world.energy["work_user"] / world.energy["kinetic"] - 1) < 1e-9 and abs(world.energy["residual"]) < 1e-10


@fact
def a_magnet_in_20_lines_has_a_closed_ledger(folder):
    """Dipoles along z that draw each other: the force falls with the fourth power of the distance, and their sum is zero."""
    with gneiss.World(UCS, set={"time.end": "1 ms"}) as world:
        strength = 3e-13  # N m^4

        @world.force
        def magnet(p):
            near = p.position[:40]
            d = near[:, None] - near[None]
            r2 = (d ** 2).sum(-1) + np.eye(len(near))
            z = d[..., 2] ** 2 / r2
            f = strength / r2 ** 2.5 * (1 - 5 * z)
            force = f[..., None] * d
            force[..., 2] += 2 * strength / r2 ** 2.5 * d[..., 2]
            p.force[:40] = force.sum(1)
            assert abs(p.force.sum(0)).max() < 1e-9 * abs(p.force).sum()

        world.run()
        work, held = world.energy["work_user"], world.energy["elastic_normal"]
        assert abs(work) > 1e-4 * held, (work, held)
        assert abs(world.energy["residual"]) < 1e-3


@fact
def fields_give_the_same_bits_for_any_number_of_threads(folder):
    for precision in ("double", "mixed"):
        hashes = set()
        for threads in (1, 3):
            with gneiss.World(LATTICE, set={"run.threads": threads, "run.precision": precision}) as world:
                world.force(lambda p: -200.0 * (p.position - [0.02, 0.005, 0.03]), stiffness=200.0)
                world.run()
                hashes.add(world.hash)
                assert world.energy["work_user"] > 1 and abs(world.energy["residual"]) < 1e-3
        assert len(hashes) == 1


@fact
def forces_that_are_returned_broadcast_and_go(folder):
    with gneiss.World(PAIR) as world:
        mass = world.particles.mass[0]
        hook = world.force(lambda points: [0.0, 0.0, mass * 5.0])
        world.step(100)
        half = world.particles.velocity[:, 2].copy()  # a kick of half a step at the start
        assert np.allclose(half, 5.0 * (world.time - 0.5 * world.dt), rtol=1e-12), half
        hook.remove()
        world.step(100)
        assert np.array_equal(world.particles.velocity[:, 2], half)


@fact
def moments_turn_particles_and_are_booked(folder):
    with gneiss.World(PAIR) as world:
        def turn(points):
            points.moment[:, 1] = 1e-6

        world.force(turn)
        world.run()
        spin = world.particles["spin"]
        assert np.allclose(spin[:, 1], 1e-6 * spin[:, 3] * (world.time - 0.5 * world.dt), rtol=1e-9)
        assert world.energy["work_user"] > 0 and abs(world.energy["residual"]) < 1e-10


@fact
def fields_act_on_nodes_of_elements(folder):
    with gneiss.World(os.path.join(SCENES, "elements.yaml")) as world:
        @world.force(on="nodes")
        def push(points):
            assert points.moment is None and len(points.id) == world.nodes.count
            points.force[:, 0] = 1e-3

        world.step(400)
        assert world.energy["work_user"] != 0 and abs(world.energy["residual"]) < 1e-3
        assert raised(gneiss.InputError, world.force, push, on="bonds")
        assert raised(gneiss.InputError, gneiss.World(PAIR).force, push, on="nodes")


@fact
def a_field_that_fails_ends_the_world_with_its_exception(folder):
    def wrong(points):
        raise Wrong("mine")

    for function, kind in ((wrong, Wrong), (lambda p: np.nan, gneiss.InputError), (lambda p: np.zeros((5, 3)), ValueError)):
        with gneiss.World(PAIR) as world:
            world.force(function)
            assert raised(kind, world.step)
            later = raised(gneiss.InputError, world.step)
            assert world.particles.count == 2 and (kind is not Wrong or "Wrong: mine" in str(later) and isinstance(later.__cause__, Wrong))
    with gneiss.World(PAIR) as world:
        assert raised(gneiss.InputError, world.force, wrong, stiffness=-1.0)
        assert world.step() == 1


@fact
def ctrl_c_inside_a_field_leaves_a_valid_world(folder):
    once = []

    def press(points):
        if not once:
            once.append(1)
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.01)
        points.force[:] = 1e-3

    with gneiss.World(PAIR) as world, gneiss.World(PAIR) as plain:
        world.force(press)
        plain.force(lambda points: 1e-3)
        raised(KeyboardInterrupt, world.step, 500)
        plain.step(world.steps)
        assert world.steps > 0 and world.hash == plain.hash
        assert world.step(10) == 10


# --- velocities, motions, specimens ---

@fact
def velocities_are_set_as_a_whole_and_refused_in_part(folder):
    with gneiss.World(LATTICE) as world:
        world.step(100)
        before, kinetic = world.velocities.copy(), world.particles.mass @ (world.velocities ** 2).sum(1) / 2
        assert raised(ValueError, world.velocities.__setitem__, 0, 0.0)
        world.velocities = 0.5 * before
        after = world.particles.mass @ (world.velocities ** 2).sum(1) / 2
        assert np.array_equal(world.velocities[before.any(1)], 0.5 * before[before.any(1)])
        world.step(100)
        assert abs(world.energy["work_user"] / (after - kinetic) - 1) < 1e-9
        assert abs(world.energy["residual"]) < 2e-3
        world.spins = 0.0
        assert not world.spins.any()
        assert raised(gneiss.InputError, setattr, world, "velocities", np.nan)
        assert raised(ValueError, setattr, world, "velocities", np.zeros((3, 3)))


@fact
def velocities_before_the_first_step_are_stored_at_the_start(folder):
    with gneiss.World(PAIR) as world:
        world.velocities = [3.0, 0.0, 0.0]
        world.run()
        kinetic = 0.5 * world.particles.mass.sum() * 9.0
        assert abs(world.energy["stored_at_start"] / kinetic - 1) < 1e-12 and world.energy["work_user"] == 0


@fact
def a_motion_that_is_set_drives_its_wall(folder):
    with gneiss.World(LATTICE) as world:
        world.step(10)
        for k in range(20):
            world.set_motion("top", vz=-0.5 if k % 2 else 0.25)
            world.step(20)
        assert abs(world.energy["residual"]) < 1e-3
        other = world.copy()
        world.step(50)
        other.step(50)
        assert world.hash == other.hash
        error = raised(gneiss.InputError, world.set_motion, "top", vx=1.0)
        assert "prescribes" in str(error)
        assert raised(gneiss.InputError, world.set_motion, "top", up=1.0)
        assert raised(gneiss.InputError, world.set_motion, "bottom", vz=1.0)


@fact
def a_call_ends_a_stage(folder):
    staged = {**PAIR, "gravity": [0, 0, -10], "stages": [{"name": "fall"}, {"name": "rise", "gravity": [0, 0, 10]}]}
    staged["stages"][0]["end"] = {"time": "5 ms"}
    with gneiss.World(staged) as world:
        world.at("1 ms", gneiss.World.end_stage)
        world.run(until="3 ms")
        assert world.progress.stage_name == "rise" and world.progress.stages == 2
        speed = world.velocities[:, 2]
        assert np.allclose(speed, 10 * 1e-3, atol=30 * world.dt), speed  # 1 ms down, 2 ms up
    with gneiss.World(PAIR) as world:
        assert raised(gneiss.InputError, world.end_stage)


@fact
def radii_are_writable_before_the_start_and_read_only_after(folder):
    def grow(specimen):
        specimen.radius[::2] *= 1.01
        specimen.group[:] = 1

    with gneiss.World(LATTICE) as plain, gneiss.World(LATTICE, prepare=grow) as world:
        order = np.argsort(world.particles["id"])
        radius, mass = world.particles.radius[order], world.particles.mass[order]
        assert np.allclose(radius[::2], 1.01e-3) and np.allclose(radius[1::2], 1e-3)
        assert np.allclose(mass, 2000 * 4 / 3 * np.pi * radius ** 3)
        assert world.dt != plain.dt and world.hash != plain.hash  # the limit follows, and lists
        assert raised(ValueError, world.particles.radius.__setitem__, 0, 2e-3)
        world.run()
        assert abs(world.energy["residual"]) < 1e-3

    def spoil(specimen):
        specimen.radius[3] = -1.0

    error = raised(gneiss.InputError, gneiss.World, LATTICE, prepare=spoil)
    assert error.key == "specimen" and error.line == 3 and "particle 3" in str(error)

    def fail(specimen):
        raise Wrong

    assert raised(Wrong, gneiss.World, LATTICE, prepare=fail)


if __name__ == "__main__":
    sys.exit(main())
