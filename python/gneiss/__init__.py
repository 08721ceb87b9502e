"""gneiss: bonded discrete and finite elements for rock and concrete, from Python.

    import gneiss
    with gneiss.World("scenes/compression.yaml") as world:
        world.run()
        print(world.readings["peak_stress"])

docs/python.md describes the module; every class and function has its own text.
"""
from ._library import lib as _lib, text as _text
from . import keys
from .commands import calibrate, check, pack, plan, report, run, stiffness, sweep, view
from .errors import FileError, GneissError, InputError, Interrupted, OutOfMemory, Problem, Unstable
from .results import Results
from .scene import Scene
from .world import Specimen, World

__version__ = _text(_lib.gneiss_version())
__all__ = ["FileError", "GneissError", "InputError", "Interrupted", "OutOfMemory", "Problem", "Results", "Scene", "Specimen", "Unstable",
           "World", "calibrate", "check", "keys", "pack", "plan", "report", "run", "stiffness", "sweep", "view"]
