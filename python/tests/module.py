"""What the tests of the module share: the module from the tree, with the library and program of the build, and tests/program.py."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TREE = os.path.dirname(os.path.dirname(HERE))
sys.path[:0] = [os.path.join(TREE, "tests"), os.path.join(TREE, "python")]
os.environ["GNEISS_PROGRAM"] = os.path.abspath(sys.argv[1])
os.environ["GNEISS_LIBRARY"] = os.path.abspath(sys.argv[2])
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

from program import *  # noqa: E402, F401, F403
import gneiss  # noqa: E402, F401

# Two spheres far apart that nothing holds, as a dict.
PAIR = {"specimen": {"particles": [[0, 0, 0, "1 mm"], ["9 mm", 0, 0, "1 mm"]]},
        "materials": [{"name": "a", "density": 2000, "normal_stiffness": "1 MN/m", "kratio": 2}],
        "law": {"stiffness": "uniform"}, "time": {"end": "10 ms"}, "output": {"history_rows": 100}, "run": {"threads": 1}}


def raised(kind, function, *arguments, **options):
    """The exception of this kind that a call raises."""
    try:
        function(*arguments, **options)
    except kind as error:
        return error
    raise AssertionError(f"expected {kind.__name__}, found none")


__all__ = [name for name in dir() if not name.startswith("_")]
