"""Types, installation, the page and the example of the Python module. Speaks TAP."""
import re

from module import *  # noqa: F403

PYTHON = os.path.join(TREE, "python")
MODULE = {**ENVIRONMENT, "PYTHONPATH": PYTHON, "GNEISS_LIBRARY": os.environ["GNEISS_LIBRARY"], "GNEISS_PROGRAM": os.environ["GNEISS_PROGRAM"]}
USER = '''import gneiss
from gneiss import keys

rock: keys.Material = {"name": "rock", "density": "2600 kg/m3", "friction": 0.5}
scene = keys.Scene(materials=[rock], walls=[keys.Wall(name="top", point=[0, 0, "1 mm"], normal=[0, 0, 1])], bonds={})
with gneiss.World(scene) as world:
    steps: int = world.step(3)
    time: float = world.run(until="2 ms").time
    column: float = world.readings["peak_stress"] + world.energy["kinetic"] + float(world.particles.radius.mean())
'''
WRONG = '''from gneiss import keys
a = keys.Material(name="rock", densty=3)
b = keys.Law(stiffness="soft")
c = keys.Time(end=[1])
'''


def checked(path, *more):
    return subprocess.run(["/usr/bin/python3", "-m", "mypy", "--config-file", os.path.join(PYTHON, "pyproject.toml"),
                           "--cache-dir", os.path.join(os.path.dirname(path), "cache"), path, *more],
                          capture_output=True, text=True, env={**MODULE, "MYPYPATH": PYTHON}, cwd=PYTHON)


@fact
def mypy_accepts_the_module_and_finds_wrong_keys(folder):
    right, wrong = os.path.join(folder, "right.py"), os.path.join(folder, "wrong.py")
    for path, text in ((right, USER), (wrong, WRONG)):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    done = checked(right, wrong, os.path.join(PYTHON, "gneiss"))
    found = re.findall(r"^(.*?):(\d+): error: (.*)$", done.stdout, re.M)
    assert [(os.path.basename(path), int(line)) for path, line, _ in found] == [("wrong.py", 2), ("wrong.py", 3), ("wrong.py", 4)], done.stdout
    assert "densty" in found[0][2]


@fact
def the_typed_keys_are_those_of_the_library(folder):
    path = os.path.join(folder, "keys.py")
    subprocess.run(["/usr/bin/python3", os.path.join(PYTHON, "make_keys.py"), path], check=True, env=MODULE)
    with open(path, encoding="utf-8") as made, open(os.path.join(PYTHON, "gneiss", "keys.py"), encoding="utf-8") as kept:
        assert made.read() == kept.read(), "tools/keys_pages.py build/gneiss has to be run"


@fact
def pip_installs_the_module_with_its_library_and_program(folder):
    tree, target = os.path.join(folder, "tree"), os.path.join(folder, "site")
    shutil.copytree(PYTHON, os.path.join(tree, "python"), ignore=shutil.ignore_patterns("build", "*.egg-info", "tests"))
    for name in ("include", "tools", "calibrate", "data", "meson.build"):
        os.symlink(os.path.join(TREE, name), os.path.join(tree, name))
    done = subprocess.run(["/usr/bin/python3", "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--quiet",
                           "--target", target, os.path.join(tree, "python")], capture_output=True, text=True,
                          env={**ENVIRONMENT, "GNEISS_BUILD": os.path.dirname(PROGRAM)})
    assert done.returncode == 0, done.stderr
    script = ("import gneiss, sys\n"
              "results = gneiss.run(sys.argv[1], 'out')\n"
              "with gneiss.World(sys.argv[1]) as world: world.run(); print(world.hash == results.attributes['state_hash'])\n"
              "print(gneiss.report('out')); print(gneiss.__file__, gneiss._library.program())\n")
    environment = {name: value for name, value in ENVIRONMENT.items() if not name.startswith("GNEISS_")}
    done = subprocess.run(["/usr/bin/python3", "-c", script, LATTICE], capture_output=True, text=True, cwd=folder,
                          env={**environment, "PYTHONPATH": target})
    assert done.returncode == 0, done.stderr
    same, page, places = done.stdout.splitlines()
    assert same == "True" and os.path.getsize(os.path.join(folder, page)) > 1000
    assert all(os.path.realpath(path).startswith(os.path.realpath(target)) for path in places.split()), places


@fact
def the_snippets_of_the_page_run_one_after_the_other(folder):
    with open(os.path.join(TREE, "docs", "python.md"), encoding="utf-8") as file:
        snippets = re.findall(r"^```python\n(.*?)^```", file.read(), re.M | re.S)
    assert len(snippets) > 10
    for name in ("scenes", "tests"):
        os.symlink(os.path.join(TREE, name), os.path.join(folder, name))
    path = os.path.join(folder, "page.py")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(snippets))
    done = subprocess.run(["/usr/bin/python3", path], capture_output=True, text=True, cwd=folder, env=MODULE)
    assert done.returncode == 0, done.stderr
    assert "\nTrue\n" in done.stdout
    assert re.search(r"^grains (\d+ \d+) law.stiffness$", done.stdout, re.M)[1] in "".join(snippets), "place in the page"


@fact
def the_lines_of_the_start_page_read_a_run(folder):
    with open(os.path.join(TREE, "docs", "start.md"), encoding="utf-8") as file:
        lines = re.search(r"^```python\n(.*?)^```", file.read(), re.M | re.S)[1]
    run(LATTICE, os.path.join(folder, "runs", "ucs-rock"))
    done = subprocess.run(["/usr/bin/python3", "-c", lines + "print(data.sizes['bonds'])"], capture_output=True, text=True, cwd=folder, env=MODULE)
    assert done.returncode == 0, done.stderr
    assert os.path.getsize(os.path.join(folder, "curve.png")) > 1000
    with h5py.File(os.path.join(folder, "runs", "ucs-rock", "results.h5")) as file:
        assert done.stdout.splitlines()[-1] == str(len(file["bonds/i"])) and f"{file['readings/peak_stress'][0]}" in done.stdout


@fact
def the_magnet_lifts_grains_and_its_ledger_closes(folder):
    done = subprocess.run(["/usr/bin/python3", os.path.join(TREE, "examples", "magnet.py")], capture_output=True, text=True, env=MODULE)
    assert done.returncode == 0, done.stderr
    heights = [float(height) for height in re.findall(r"highest grain at (\S+) mm", done.stdout)]
    assert len(heights) == 5 and max(heights) > 25
    assert abs(float(re.search(r"residual (\S+)", done.stdout)[1])) < 1e-3


if __name__ == "__main__":
    sys.exit(main())
