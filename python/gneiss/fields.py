"""Fields of a world as numpy arrays over the engine's own memory."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._library import ffi, lib, text
from .errors import InputError, checked

Array = NDArray[Any]

_TYPES = {lib.GNEISS_F64: "<f8", lib.GNEISS_I64: "<i8", lib.GNEISS_I32: "<i4", lib.GNEISS_U8: "|u1", lib.GNEISS_F32: "<f4"}


class _Memory:
    """Memory of the engine for numpy. An array holds it, and it keeps the memory readable, whatever becomes of the world."""

    def __init__(self, pointer: Any, shape: tuple[int, ...], strides: tuple[int, ...] | None, kind: str, writable: bool) -> None:
        self._pointer = None
        checked(lib.gneiss_view_pin, ffi.new("gneiss_view *", {"data": pointer}))
        self._pointer, self._unpin = pointer, lib.gneiss_view_unpin
        address = int(ffi.cast("uintptr_t", pointer))
        self.__array_interface__ = {"version": 3, "data": (address, not writable), "shape": shape, "strides": strides, "typestr": kind}

    def __del__(self) -> None:
        if self._pointer is not None:
            self._unpin(self._pointer)


def memory_array(pointer: Any, shape: tuple[int, ...], kind: str = "<f8", strides: tuple[int, ...] | None = None,
                 writable: bool = False) -> Array:
    """An array over a block of memory of the engine, without a copy."""
    if not pointer or 0 in shape:
        return np.zeros(shape, kind)
    return np.asarray(_Memory(pointer, shape, strides, kind, writable))


def view_array(view: Any) -> Array:
    """A read-only array over a view of the library: [items] or [items][components]."""
    if view.components == 1:
        return memory_array(view.data, (view.count,), _TYPES[view.type], (view.item_stride,))
    return memory_array(view.data, (view.count, view.components), _TYPES[view.type], (view.item_stride, view.component_stride))


class About(NamedTuple):
    """Name, unit and description of a field, column or quantity."""
    name: str
    unit: str
    description: str


class _Shown:
    """Base of objects that show the memory of a world: they have no other attributes and cannot be pickled."""
    __slots__ = ()

    def __reduce__(self) -> Any:
        raise TypeError(f"{type(self).__name__} shows the memory of a World and cannot be pickled or copied: pickle the World, or a dict of "
                        "its arrays")


class Record(_Shown, Mapping[str, Array]):
    """The fields of particles, bonds, pairs, wall_contacts, nodes or elements by name: read-only arrays over the engine's memory, [items]
    or [items][components]. They show the present order of the items; `id` of particles is their place in the specimen. Ask for them again
    after an advance: the engine may then use other memory, and an older array keeps what it showed last. `about[name]` has unit and
    description."""
    __slots__ = ("_c", "_number")

    def __init__(self, world: Any, number: int) -> None:
        self._c, self._number = world, number

    @property
    def name(self) -> str:
        return text(lib.gneiss_record_name(self._number))

    def _view(self, name: str) -> Any:
        view = ffi.new("gneiss_view *")
        checked(lib.gneiss_world_field, self._c, self._number, name.encode(), view)
        return view

    def __getitem__(self, name: str) -> Array:
        try:
            return view_array(self._view(name))
        except InputError as error:
            raise KeyError(str(error)) from None

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(*error.args) from None

    def _each(self) -> Iterator[Any]:
        view = ffi.new("gneiss_view *")
        for index in range(lib.gneiss_world_field_count(self._c, self._number)):
            checked(lib.gneiss_world_field_at, self._c, self._number, index, view)
            yield view

    def _names(self) -> list[str]:
        return [text(view.name) for view in self._each()]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __len__(self) -> int:
        return lib.gneiss_world_field_count(self._c, self._number)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._names()]

    @property
    def count(self) -> int:
        """The number of items."""
        return next((view.count for view in self._each()), 0)

    @property
    def about(self) -> dict[str, About]:
        """{name: About(name, unit, description)} of the fields."""
        return {text(view.name): About(text(view.name), text(view.unit), text(view.description)) for view in self._each()}

    @property
    def outputs(self) -> dict[str, About]:
        """{name: About} of what `output` computes: the fields of results.h5."""
        view = ffi.new("gneiss_view *")
        found = {}
        for index in range(lib.gneiss_world_output_count(self._c, self._number)):
            checked(lib.gneiss_world_output_at, self._c, self._number, index, view)
            found[text(view.name)] = About(text(view.name), text(view.unit), text(view.description))
        return found

    def output(self, name: str) -> Array:
        """Computes a field of results.h5 for the present state: a new array [items] or [items][components], in the order of the specimen
        or mesh."""
        view = ffi.new("gneiss_view *")
        for index in range(lib.gneiss_world_output_count(self._c, self._number)):
            checked(lib.gneiss_world_output_at, self._c, self._number, index, view)
            if text(view.name) == name:
                values = np.empty((view.count, view.components) if view.components > 1 else view.count)
                pointer = ffi.cast("double *", values.ctypes.data)
                checked(lib.gneiss_world_output, self._c, self._number, name.encode(), pointer, values.size)
                return values
        raise KeyError(f"{name}: {self.name} have the outputs {', '.join(self.outputs)}")

    def __repr__(self) -> str:
        return f"<gneiss {self.name}: {self.count} with {', '.join(self._names())}>"


class Particles(Record):
    """The particles, with parts of their rows by name."""
    __slots__ = ()

    @property
    def position(self) -> Array:
        """[n][3] m: centres relative to `World.origin`."""
        return self["pos"][:, :3]

    @property
    def radius(self) -> Array:
        """[n] m."""
        return self["pos"][:, 3]

    @property
    def velocity(self) -> Array:
        """[n][3] m/s, of the last half step. Set World.velocities to change them."""
        return self["vel"][:, :3]

    @property
    def mass(self) -> Array:
        """[n] kg, a new array, read-only; infinite for removed particles."""
        with np.errstate(divide="ignore"):
            mass = 1.0 / self["vel"][:, 3]
        mass.flags.writeable = False
        return mass


class History(_Shown, Mapping[str, Array]):
    """Columns of the history by name: read-only arrays [rows] over the engine's memory, to be obtained again after an advance."""
    __slots__ = ("_c",)

    def __init__(self, world: Any) -> None:
        self._c = world

    def _each(self) -> Iterator[Any]:
        view = ffi.new("gneiss_view *")
        for index in range(lib.gneiss_world_history_count(self._c)):
            checked(lib.gneiss_world_history_at, self._c, index, view)
            yield view

    def __getitem__(self, name: str) -> Array:
        for view in self._each():
            if text(view.name) == name:
                return view_array(view)
        raise KeyError(f"{name}: the history has {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        return iter([text(view.name) for view in self._each()])

    def __len__(self) -> int:
        return lib.gneiss_world_history_count(self._c)

    @property
    def about(self) -> dict[str, About]:
        """{name: About(name, unit, description)} of the columns."""
        return {text(view.name): About(text(view.name), text(view.unit), text(view.description)) for view in self._each()}

    def table(self) -> Any:
        """A copy as a pandas.DataFrame with attrs["units"] {column: unit}, or a structured array where pandas is not installed."""
        from .results import table_of
        return table_of({name: self[name] for name in self}, self.about)


class Quantities(_Shown, Mapping[str, float]):
    """Numbers by name: readings, or terms of the energy ledger. NaN: absent. `about[name]` has unit and description."""
    __slots__ = ("_c", "_count", "_at")

    def __init__(self, world: Any, count: Any, at: Any) -> None:
        self._c, self._count, self._at = world, count, at

    def _each(self) -> Iterator[Any]:
        quantity = ffi.new("gneiss_quantity *")
        for index in range(self._count()):
            checked(self._at, self._c, index, quantity)
            yield quantity

    def __getitem__(self, name: str) -> float:
        for quantity in self._each():
            if text(quantity.name) == name:
                return quantity.value
        raise KeyError(f"{name}: there are {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        return iter([text(quantity.name) for quantity in self._each()])

    def __len__(self) -> int:
        return self._count()

    @property
    def about(self) -> dict[str, About]:
        """{name: About(name, unit, description)}."""
        return {text(q.name): About(text(q.name), text(q.unit), text(q.description)) for q in self._each()}

    def __repr__(self) -> str:
        return repr({name: value for name, value in self.items() if value == value})


class Energy(Quantities):
    """Terms of the energy ledger by name, J, and `residual` (1), at the last measured instant: that of the last history row, or of the last
    step of a run. `step` and `time` say which."""
    __slots__ = ()

    def __init__(self, world: Any) -> None:
        super().__init__(world, lib.gneiss_energy_count, lib.gneiss_world_energy_at)

    def _instant(self) -> tuple[int, float]:
        step, time = ffi.new("int64_t *"), ffi.new("double *")
        checked(lib.gneiss_world_energy_instant, self._c, step, time)
        return step[0], time[0]

    @property
    def step(self) -> int:
        """Steps done at the measured instant; -1: unknown (before the first row, without output.energy)."""
        return self._instant()[0]

    @property
    def time(self) -> float:
        """s: the measured instant; NaN where `step` is -1."""
        return self._instant()[1]
