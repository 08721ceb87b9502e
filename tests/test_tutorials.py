"""The tutorials as they are written: every file and command, and what the pages say is printed. Speaks TAP.

The second argument is the library that the Python module needs."""
import glob

from program import *  # noqa: F403

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.append(os.path.join(ROOT, "tools"))
import tutorials  # noqa: E402

# Slow commands that other tests run as well.
LEFT_OUT = ["gneiss report runs/ucs\n", "gneiss sweep rake.yaml\n"]


def environment_of(folder):
    """With the program as `gneiss` in PATH, and what the Python module looks for."""
    programs = os.path.join(folder, "bin")
    os.mkdir(programs)
    os.symlink(PROGRAM, os.path.join(programs, "gneiss"))
    return {**ENVIRONMENT, "PATH": ":".join([programs, "/usr/bin", os.environ["PATH"]]), "PYTHONPATH": os.path.join(ROOT, "python"),
            "GNEISS_PROGRAM": PROGRAM, "GNEISS_LIBRARY": os.path.abspath(sys.argv[2]), "GNEISS_CACHE": folder, "MPLCONFIGDIR": folder}


def check(page, folder):
    compared = 0
    for block, printed, shown in tutorials.run(page, folder, lambda text: "" if text in LEFT_OUT else text, environment_of(folder)):
        assert "gneiss: warning" not in printed, f"{page}:{block.line}: {printed}"
        if shown:
            absent = tutorials.missing(shown.text, printed)
            assert not absent, f"{page}:{shown.line}: not printed: {absent} but: {printed}"
            compared += len(shown.text.splitlines())
    assert compared >= 2, f"{page}: {compared} lines compared"


def add(page):
    def function(folder):
        check(page, folder)

    function.__name__ = "the commands of " + os.path.basename(page)
    fact(function)


for found in sorted(glob.glob(os.path.join(ROOT, "docs", "tutorials", "*.md"))):
    add(found)


@fact
def a_page_that_shows_something_else_fails(folder):
    page = write_scene(folder, "```python\n# a.py\nfor _ in range(3):\n    print('grains 12, 0.5 MPa')\n```\n```sh\npython3 a.py\n```\n"
                               "```text\ngrains 12, 0.51 MPa\ngrains ...\ngrains 12, 0.5 GPa\n```\n", "page.md")
    (_, printed, shown), = tutorials.run(page, folder)
    assert tutorials.missing(shown.text, printed) == ["grains 12, 0.51 MPa", "grains 12, 0.5 GPa"]
    assert tutorials.missing(shown.text, printed, 0.05) == ["grains 12, 0.5 GPa"]


if __name__ == "__main__":
    sys.exit(main())
