"""Results of runs, packings and sweeps as numpy arrays, pandas tables and xarray datasets."""
from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ._library import files
from .errors import FileError, InputError
from .fields import About

_FILES = ("results.h5", "packing.h5", "sweep.h5")


def _columns(arrays: Mapping[str, Any]) -> dict[str, Any]:
    """Arrays [n] or [n][k] as columns: those of several components as name_0, name_1, ..."""
    found: dict[str, Any] = {}
    for name, values in arrays.items():
        if values.ndim == 1:
            found[name] = values
        else:
            found.update({f"{name}_{k}": part for k, part in enumerate(values.reshape(len(values), -1).T)})
    return found


def table_of(arrays: Mapping[str, Any], about: Mapping[str, About]) -> Any:
    """A copy of columns of one length: a pandas.DataFrame with attrs["units"] {column: unit}, or a structured array where pandas is not
    installed."""
    columns = _columns({name: np.asarray(values) for name, values in arrays.items()})
    try:
        import pandas
    except ImportError:
        kind: Any = [(name, values.dtype) for name, values in columns.items()]
        rows = np.empty(len(next(iter(columns.values()), ())), kind)
        for name, values in columns.items():
            rows[name] = values
        return rows
    frame = pandas.DataFrame({name: values.copy() for name, values in columns.items()})
    frame.attrs["units"] = {column: about[name].unit for name, values in arrays.items() for column in _columns({name: np.asarray(values)})}
    return frame


def dataset_of(groups: Mapping[str, tuple[Mapping[str, Any], Mapping[str, About]]]) -> Any:
    """An xarray.Dataset of {group: (arrays, about)}: variables `group_name`, dimensions `group` and `group_name_component`."""
    import xarray
    variables = {}
    for group, (arrays, about) in groups.items():
        for name, values in arrays.items():
            values = np.array(values)
            parts = [f"{group}_{name}_component_{k}" if k else f"{group}_{name}_component" for k in range(values.ndim - 1)]
            attributes = {"unit": about[name].unit, "description": about[name].description} if name in about else {}
            variables[f"{group}_{name}"] = ((group, *parts), values, attributes)
    return xarray.Dataset(variables)


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


class Group(Mapping[str, Any]):
    """The data sets of a group of a file by name: arrays, read when they are requested; texts as lists of lines. Of a group of single
    numbers (readings, energy, quality) the numbers; NaN: absent, with the reason in `absent`."""

    def __init__(self, path: str, group: str) -> None:
        self._path, self._group = path, group
        self._kept: dict[str, Any] = {}
        self._list: list[str] | None = None

    def _read(self, read: Callable[[Any], Any]) -> Any:
        import h5py
        with files, h5py.File(self._path) as file:
            return read(file[self._group])

    def _names(self) -> list[str]:
        if self._list is None:
            import h5py
            self._list = list(self._read(lambda group: [name for name, item in group.items() if isinstance(item, h5py.Dataset)]))
        return self._list

    def __getitem__(self, name: str) -> Any:
        if name not in self._names():
            raise KeyError(f"{name}: {self._group} has {', '.join(self._names())}")
        if name not in self._kept:
            value = self._read(lambda group: group[name][()])
            if isinstance(value, (bytes, str)):
                value = _text(value).splitlines()
            elif value.shape == (1,) and self._group.split("/")[-1] in ("readings", "energy", "quality", "profile"):
                value = float(value[0])
            self._kept[name] = value
        return self._kept[name]

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and name in self._names():
            return self[name]
        raise AttributeError(f"{self._group} has no {name}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __len__(self) -> int:
        return len(self._names())

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._names()]

    @property
    def about(self) -> dict[str, About]:
        """{name: About(name, unit, description)}."""
        return self._read(lambda group: {name: About(name, _text(group[name].attrs.get("unit", b"")),
                                                     _text(group[name].attrs.get("description", b""))) for name in self._names()})

    @property
    def absent(self) -> dict[str, str]:
        """{name: reason} of readings that the curves cannot give."""
        return self._read(lambda group: {name: _text(group[name].attrs["absent"]) for name in self._names()
                                         if "absent" in group[name].attrs})

    def table(self) -> Any:
        """The columns as a pandas.DataFrame with attrs["units"] {column: unit}, or a structured array where pandas is not installed."""
        return table_of({name: self[name] for name in self if isinstance(self[name], np.ndarray)}, self.about)

    def __repr__(self) -> str:
        return f"<gneiss {self._group}: {', '.join(self._names())}>"


class Results:
    """The results of a run, `pack` or `sweep`: a folder, or its results.h5, packing.h5 or sweep.h5.

    Groups of the file are attributes: `history`, `readings`, `energy`, `particles`, `bonds`, `events`, `stages`, ...; of a packing
    `particles`, `contacts`, `quality`; of a sweep `parameters`, `runs`, `readings`, `statistics`. Each is a Group. docs/results.md,
    docs/packing.md and docs/sweep.md list them. Reading needs h5py. Raises InputError where there is no such file.
    """

    def __init__(self, place: str | os.PathLike[str]) -> None:
        place = os.fspath(place)
        names = [os.path.join(place, name) for name in _FILES] if os.path.isdir(place) else [place]
        self.path = next((name for name in names if os.path.isfile(name)), "")
        if not self.path:
            raise InputError(f"{place}: expected a folder of results or one of {', '.join(_FILES)}, found none")
        self.folder = os.path.dirname(self.path)

    def _read(self, read: Callable[[Any], Any]) -> Any:
        import h5py
        try:
            with files, h5py.File(self.path) as file:
                return read(file)
        except OSError as error:
            raise FileError(f"{self.path}: {error}") from error

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the file: title, version, state_hash, dt, steps, finished, ..."""
        return self._read(lambda file: {name: _text(value) if isinstance(value, (bytes, str)) else np.squeeze(value)[()]
                                        for name, value in file.attrs.items()})

    @property
    def summary(self) -> dict[str, Any]:
        """summary.json as a dict."""
        with open(os.path.join(self.folder, "summary.json"), encoding="utf-8") as file:
            return json.load(file)

    @property
    def scene(self) -> str:
        """The resolved scene as YAML (of a packing its request)."""
        return _text(self._read(lambda file: file["scene" if "scene" in file else "request"][()]))

    @property
    def warnings(self) -> dict[str, str]:
        """{name: text} of warnings about the results."""
        lines = str(self.attributes.get("warnings", "")).splitlines()
        return dict(line.split(": ", 1) for line in lines if ": " in line)

    def groups(self) -> list[str]:
        """Names of the groups."""
        import h5py
        return self._read(lambda file: [name for name, item in file.items() if isinstance(item, h5py.Group)])

    def group(self, path: str) -> Group:
        """A group by its path, such as 'stages/shear/readings'."""
        if not self._read(lambda file: path in file):
            raise KeyError(f"{path}: the file has {', '.join(self.groups())}")
        return Group(self.path, path)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self.group(name)
        except KeyError as error:
            raise AttributeError(*error.args) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.groups()]

    def dataset(self, *names: str) -> Any:
        """An xarray.Dataset of groups (default: history, particles and bonds, as far as they are there), with units and descriptions."""
        wanted = names or [name for name in ("history", "particles", "bonds") if name in self.groups()]
        return dataset_of({name: ({key: value for key, value in self.group(name).items() if isinstance(value, np.ndarray)},
                                  self.group(name).about) for name in wanted})

    def __repr__(self) -> str:
        return f"<gneiss.Results {self.path}: {', '.join(self.groups())}>"
