"""Scenes: from a dict, a file or YAML text."""
from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy as np

from . import keys
from ._library import encoded, ffi, files, lib, text
from .errors import checked, error_at


Changes = Union[Mapping[str, Any], Sequence[str], str, None]
Source = Union[keys.Scene, Mapping[str, Any], str, "os.PathLike[str]"]


def _plain(value: Any, key: str) -> Any:
    """A value as JSON has it: numbers and arrays of numpy, paths; True and False as on and off. Refuses other types and numbers that are
    not finite, with the key."""
    if isinstance(value, Mapping):
        return {str(name): _plain(item, f"{key}.{name}" if key else str(name)) for name, item in value.items()}
    if isinstance(value, np.ndarray) and value.dtype.kind in "iuf" and np.isfinite(value).all():
        return value.tolist()
    if isinstance(value, np.ndarray) and value.ndim:
        value = list(value)
    if isinstance(value, (list, tuple)):
        return [_plain(item, f"{key}[{k}]") for k, item in enumerate(value)]
    if isinstance(value, (bool, np.bool_)):
        return "on" if value else "off"
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise error_at(key, f"expected a finite number, found {value}")
    if value is None or isinstance(value, (str, int, float)):
        return value
    raise TypeError(f"{key}: expected numbers, texts, lists and dicts in a scene, found {value!r} ({type(value).__name__})")


def written(values: Mapping[str, Any]) -> str:
    """A dict as YAML text, a line for each value of nested sections, so that messages lead to the key: JSON is YAML."""
    return json.dumps(_plain(values, ""), indent=1, allow_nan=False) + "\n"


def override_text(key: str, value: Any) -> str:
    """An override in the form key=value of `--set`."""
    value = _plain(value, key)
    return f"{key}={value if isinstance(value, str) else json.dumps(value, allow_nan=False)}"


def overrides_of(changes: Changes) -> list[str]:
    """Pairs of key and value, or texts key=value, as texts."""
    if not changes:
        return []
    if isinstance(changes, Mapping):
        return [override_text(key, value) for key, value in changes.items()]
    return [changes] if isinstance(changes, str) else list(changes)


def as_c(changes: Changes) -> tuple[Any, int, list[Any]]:
    """Overrides for a C function: (array, count, what keeps the texts alive)."""
    kept = [ffi.new("char[]", item.encode()) for item in overrides_of(changes)]
    return ffi.new("const char *[]", kept) if kept else ffi.NULL, len(kept), kept


class Scene:
    """A scene that was read and checked.

    source   a dict (keys as in a scene file; values as text with a unit, '2 mm', or numbers in SI), a path, or YAML text (a str with a
             line break)
    set      changes: {'time.end': '2 ms', 'walls.top.motion.vz': -0.05} or a list of 'key=value'
    folder   where relative paths of a dict or a text start; default: the working folder
    name     of a dict or a text in messages and results
    allow_gmsh  lets gmsh mesh a geometry, which can make it execute any command

    Raises InputError with file, line, column and key of every problem, FileError.
    """

    def __init__(self, source: Source, *, set: Changes = None, folder: str | os.PathLike[str] | None = None, name: str = "scene",
                 allow_gmsh: bool = False) -> None:
        overrides, count, _kept = as_c(set)
        made = ffi.new("gneiss_scene **")
        if isinstance(source, Mapping):
            source = written(source)
        with files:
            if isinstance(source, str) and "\n" in source:
                place = encoded(folder) if folder is not None else ffi.NULL
                checked(lib.gneiss_scene_parse, source.encode(), name.encode(), place, overrides, count, made)
            else:
                checked(lib.gneiss_scene_load, encoded(source), overrides, count, made)
        self._c = ffi.gc(made[0], lib.gneiss_scene_free)
        lib.gneiss_scene_allow_gmsh(self._c, bool(allow_gmsh))

    @property
    def text(self) -> str:
        """The resolved scene as YAML: SI units, every default filled in."""
        return text(lib.gneiss_scene_text(self._c))

    def __reduce__(self) -> Any:
        raise TypeError("a Scene cannot be pickled: pickle its `text`, or what it was made from")

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the resolved scene to a file, under a temporary name first."""
        path = os.path.abspath(path)
        with tempfile.NamedTemporaryFile("w", dir=os.path.dirname(path), delete=False, encoding="utf-8") as file:
            file.write(self.text)
        os.replace(file.name, path)

    def __repr__(self) -> str:
        title = next((line.split(":", 1)[1].strip() for line in self.text.splitlines() if line.startswith("title:")), "")
        return f"<gneiss.Scene {title!r}>"


def scene_of(source: Scene | Source, **options: Any) -> Scene:
    """A Scene, or one made from what Scene takes."""
    if isinstance(source, Scene):
        if any(value for value in options.values()):
            raise TypeError("a Scene was read already: give its changes where it is made")
        return source
    return Scene(source, **{name: value for name, value in options.items() if value is not None})
