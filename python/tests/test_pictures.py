"""Pictures and films of worlds. Speaks TAP."""
import re

from module import *  # noqa: F403

pictures = gneiss.pictures

PNG = b"\x89PNG\r\n\x1a\n"


@fact
def a_section_shows_the_circles_that_a_plane_cuts(folder):
    with gneiss.World(LATTICE) as world:
        world.step(20)
        discs, label, names = pictures.discs_of(world, "radius", ("y", 3e-3), "y")
        position, radius = world.particles.position, world.particles.radius
        cut = np.abs(position[:, 1] - 3e-3) < radius
        assert len(discs.radius) == cut.sum() > 10 and names == "xz" and label == "radius, m"
        expected = np.sqrt(radius[cut] ** 2 - (position[cut, 1] - 3e-3) ** 2)
        assert np.allclose(np.sort(discs.radius), np.sort(expected)) and (discs.radius < 1e-3).any()


@fact
def particles_in_front_are_drawn_last_with_their_own_values(folder):
    with gneiss.World(LATTICE) as world:
        world.step(300)  # the particles then have another order than in the specimen
        position = world.particles.position.copy()
        for view, back_first in (("x", position[:, 0]), ("y", -position[:, 1]), ("z", position[:, 2])):
            discs, _, _ = pictures.discs_of(world, back_first, None, view)
            assert (np.diff(discs.value) >= 0).all() and len(discs.value) == len(position)
        moved, _ = pictures.values_of(world, "displacement")
        start = world.particles["start"][:, :3]
        assert np.allclose(moved, np.linalg.norm(position - start, axis=1), rtol=1e-9, atol=1e-15)
        assert np.allclose(pictures.values_of(world, "velocity")[0], np.linalg.norm(world.velocities, axis=1))
        assert raised(KeyError, world.plot, "beauty")


@fact
def a_world_shows_itself_and_its_film(folder):
    with gneiss.World(LATTICE, set={"time.end": "0.05 ms"}) as world:
        assert world._repr_png_().startswith(PNG)
        page = world._repr_html_()
        assert world.hash in page and "data:image/png;base64," in page
        world.plot("stress", cut=("x", 2e-3)).savefig(os.path.join(folder, "a.png"))
        with open(os.path.join(folder, "a.png"), "rb") as file:
            assert file.read().startswith(PNG)
        film = world.animate(3)
        assert film.frames == 3 and world.progress.finished
        film.save(os.path.join(folder, "a.gif"))
        with open(os.path.join(folder, "a.gif"), "rb") as file:
            assert file.read(6) == b"GIF89a"
        assert "<img" in film._repr_html_()
    assert world._repr_html_() is None and world._repr_png_() is None
    with gneiss.World(os.path.join(SCENES, "elements.yaml")) as world:
        assert world._repr_png_() is None and "<table>" in world._repr_html_()


@fact
def a_progress_bar_is_shown_with_and_without_tqdm(folder):
    script = ("import sys, gneiss\n"
              "if sys.argv[1] == 'plain': sys.modules['tqdm'] = sys.modules['tqdm.auto'] = None\n"
              f"with gneiss.World({LATTICE!r}) as world: world.run(progress=True)\n"
              f"gneiss.run({LATTICE!r}, {folder!r} + '/' + sys.argv[1], progress=True)\n")
    for kind in ("bar", "plain"):
        done = subprocess.run([sys.executable, "-c", script, kind], capture_output=True, text=True,
                              env={**ENVIRONMENT, "PYTHONPATH": os.path.join(TREE, "python"), "GNEISS_LIBRARY": os.environ["GNEISS_LIBRARY"]})
        assert done.returncode == 0 and "step 418" in done.stderr and "100 %" in done.stderr, done.stderr
        assert len(re.findall("step 418", done.stderr)) >= 2, done.stderr  # progress of the world, and of the command


if __name__ == "__main__":
    sys.exit(main())
