"""Worlds: a model that runs."""
from __future__ import annotations

import contextlib
import math
import os
import tempfile
import threading
import time as clock
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import hooks, pictures
from ._library import encoded, ffi, files, lib, text
from .arguments import finite, function_of, rows, whole
from .bars import bar
from .errors import GneissError, InputError, Interrupted, checked
from .fields import Array, Energy, History, Particles, Quantities, Record, memory_array
from .hooks import Hook, Points
from .scene import Changes, Scene, Source, as_c, scene_of

_SLICE = 0.05  # s of wall time between two checks for signals
_COMPONENTS = {"vx": 0, "vy": 1, "vz": 2, "wx": 3, "wy": 4, "wz": 5}
_RECORDS = ("particles", "bonds", "pairs", "wall_contacts", "nodes", "elements")
_SHOWN = (*_RECORDS, "history", "readings", "energy")
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}


Path = Union[str, "os.PathLike[str]"]
Time = Union[float, str]


def seconds_of(value: Time) -> float:
    """A finite time in s from a number or a text such as '2 ms'."""
    if not isinstance(value, str):
        return finite(value, "time, s")
    for unit in sorted(_SECONDS, key=len, reverse=True):
        if value.strip().endswith(unit):
            with contextlib.suppress(ValueError):
                return finite(float(value.strip()[:-len(unit)]), f"time, {unit}") * _SECONDS[unit]
    with contextlib.suppress(ValueError):
        if math.isfinite(number := float(value)):
            return number
    raise InputError(f"expected a time such as '2 ms', found '{value}'")


class Progress(NamedTuple):
    """The progress of a run. `eta`: s of wall time; `stress`, `strain`, `unbalanced`, `energy_residual`: of the last history row."""
    step: int
    time: float
    end: float
    dt: float
    wall_seconds: float
    eta: float
    unbalanced: float
    energy_residual: float
    stress: float
    strain: float
    finished: int
    stop_reason: str
    stage: int
    stages: int
    stage_name: str


class Limits(NamedTuple):
    """s: the step in use, the limit that it is compared with, 2/w_max by Lanczos iteration, a rigorous bound, and one spring a particle."""
    dt: float
    stable: float
    sharp: float
    bound: float
    literature: float


class Counts(NamedTuple):
    """Items of the records (broken bonds included), broken bonds by cause, removed particles, rebuilds of lists, rows of the history."""
    particles: int
    bonds: int
    pairs: int
    wall_contacts: int
    walls: int
    sets: int
    broken_tension: int
    broken_shear: int
    removed: int
    list_rebuilds: int
    history_rows: int


class ElementCounts(NamedTuple):
    """Present nodes and elements, and dormant particles inside of elements."""
    nodes: int
    elements: int
    asleep: int


def _read(kind: Any, name: str, function: Any, world: Any) -> Any:
    """A struct of the library as a named tuple with the members of the same names."""
    values = ffi.new(name + " *")
    checked(function, world, values)
    found = [getattr(values, field) for field in kind._fields]
    return kind(*(text(value) if isinstance(value, ffi.CData) else value for value in found))


def _specimen_callback(prepare, failed):
    """The C function that has `prepare` change a specimen; errors go to the list `failed`."""

    @ffi.callback("gneiss_prepare", error=1, onerror=lambda kind, error, trace: failed.append(error) or 1)
    def call(_context, c_specimen):
        n = c_specimen.count
        position = memory_array(c_specimen.position, (n, 4), writable=True)
        prepare(Specimen(position[:, :3], position[:, 3], memory_array(c_specimen.material, (n,), "<i4", writable=True),
                         memory_array(c_specimen.group, (n,), "<i4", writable=True), np.array(list(c_specimen.origin))))
        return 0

    return call


class Specimen(NamedTuple):
    """Particles of a specimen before masses, bonds and lists are made: writable arrays position [n][3] m (relative to origin [3]), radius
    [n] m, material [n] (place in the scene's list) and group [n] (0: without bonds)."""
    position: Array
    radius: Array
    material: Array
    group: Array
    origin: Array


class World:
    """A model that runs, made from a Scene or from what Scene takes.

    folder   place of results, snapshots and checkpoints; '': the scene's own; None: nothing is written
    prepare  function(Specimen) that changes radii, places, materials and groups before masses, bonds and lists are made
    set, allow_gmsh  as for Scene

    Use it in a `with` statement, or close it, to free its memory at once. Steps run without the lock of the interpreter, so that threads
    may step different worlds at a time; one world belongs to one thread at a time.
    """

    particles: Particles
    bonds: Record
    pairs: Record
    wall_contacts: Record
    nodes: Record
    elements: Record
    history: History
    readings: Quantities
    energy: Energy

    def __init__(self, scene: Scene | Source, folder: Path | None = None, *, prepare: Callable[[Specimen], Any] | None = None,
                 set: Changes = None, allow_gmsh: bool | None = None) -> None:
        made, failed = ffi.new("gneiss_world **"), list[BaseException]()
        scene = scene_of(scene, set=set, allow_gmsh=allow_gmsh)
        callback = _specimen_callback(function_of(prepare), failed) if prepare is not None else ffi.NULL
        with files:
            lib.gneiss_scene_prepare(scene._c, callback, ffi.NULL)
            try:
                checked(lib.gneiss_world_create, scene._c, encoded(folder) if folder is not None else ffi.NULL, made)
            except InputError:
                if failed:
                    raise failed[0]
                raise
            finally:
                lib.gneiss_scene_prepare(scene._c, ffi.NULL, ffi.NULL)
        self._take(made[0], folder is not None)

    def _take(self, pointer: Any, writes: bool) -> None:
        self._c = ffi.gc(pointer, lib.gneiss_world_free)
        self._writes, self._stop, self._inside = writes, False, False
        self._hooks: dict[int, Hook] = {}
        self._removed: list[Hook] = []
        self._failed: Optional[BaseException] = None  # to be raised when the present call returns
        self._cause: Optional[BaseException] = None  # what a field of force raised, which ended the world
        self._kept = self.steps  # of the last checkpoint
        self._chunk, self._lock = 1, threading.Lock()
        shown = {name: (Record if number else Particles)(self._c, number) for number, name in enumerate(_RECORDS)}
        self.__dict__.update(shown, history=History(self._c), energy=Energy(self._c),
                             readings=Quantities(self._c, lib.gneiss_reading_count, lib.gneiss_world_reading_at))

    @classmethod
    def _from(cls, function: Any, place: Path, changes: Changes, writes: bool) -> World:
        overrides, count, _kept = as_c(changes)
        made, world = ffi.new("gneiss_world **"), cls.__new__(cls)
        with files:
            checked(function, encoded(place), overrides, count, made)
        world._take(made[0], writes)
        return world

    @classmethod
    def load(cls, path: Path, set: Changes = None) -> World:
        """Continues from a file of `save` or a checkpoint of a run, without an output folder. `set`: of time.*, output.* and run.*."""
        return cls._from(lib.gneiss_world_load, path, set, False)

    @classmethod
    def resume(cls, folder: Path, set: Changes = None) -> World:
        """Continues from the newest checkpoint in the output folder of a run, in that folder."""
        return cls._from(lib.gneiss_world_resume, folder, set, True)

    # --- end ---

    @property
    def closed(self) -> bool:
        return self._c is None

    def close(self) -> None:
        """Frees the world as soon as no array shows its memory any more. It writes nothing: `run` to the end, `finish` and `checkpoint`
        do."""
        if self._inside:
            raise RuntimeError("expected no end of a world inside a call of its own hooks")
        self._c = None
        self._hooks.clear()
        for name in _SHOWN:
            self.__dict__.pop(name, None)

    def __getattr__(self, name: str) -> Any:
        if name in _SHOWN:
            raise ValueError("the world is closed")
        raise AttributeError(f"a World has no {name}")

    def __setattr__(self, name: str, value: Any) -> None:
        if type(self) is World and not name.startswith("_") and not isinstance(getattr(World, name, None), property):
            raise AttributeError(f"{name} of a World cannot be set: expected velocities or spins, or keys of the scene when it is made")
        super().__setattr__(name, value)

    def __enter__(self) -> World:
        return self

    def __exit__(self, kind: Any, *_: Any) -> None:
        try:
            if kind is not None and issubclass(kind, KeyboardInterrupt):
                self._keep()
        finally:
            self.close()

    def _keep(self) -> None:
        """Writes a checkpoint if the world has a folder and has moved since the last one."""
        if not self.closed and self._writes and self._cause is None and self.steps > self._kept:
            self.checkpoint()

    @contextlib.contextmanager
    def _kept_on_interrupt(self) -> Iterator[None]:
        """Ctrl-C writes a checkpoint, as it does in the program."""
        try:
            yield
        except KeyboardInterrupt as stop:
            try:
                if not self._inside:
                    self._keep()
            except GneissError as error:
                raise KeyboardInterrupt(f"no checkpoint was written: {error}") from stop
            raise

    def _pointer(self) -> Any:
        if self._c is None:
            raise ValueError("the world is closed")
        return self._c

    def _checked(self, function: Any, *arguments: Any) -> None:
        """Calls a function of the library; errors of a world that a field of force has ended have what that raised as their cause."""
        try:
            checked(function, self._pointer(), *arguments)
        except GneissError as error:
            cause = self._cause
            if cause is None or self._failed is not None:
                raise
            raise type(error)(f"{error}: {type(cause).__name__}: {cause}") from cause

    # --- advance ---

    def _advance(self, function: Any, *arguments: Any) -> bool:
        """Makes one call into the engine; returns False if a function of a hook requested to stop."""
        self._pointer()
        if not self._inside and not self._lock.acquire(blocking=False):
            raise RuntimeError("the world is in use by another thread")
        if self._inside:
            raise InputError("expected no advance of a world inside a call of its own hooks")
        self._inside = bool(self._hooks)
        try:
            if self._writes:
                with files:
                    self._checked(function, *arguments)
            else:
                self._checked(function, *arguments)
            return True
        except Interrupted:
            return False
        finally:
            self._inside, self._stop = False, False
            self._removed.clear()
            self._lock.release()
            self._raise_failed()

    def _raise_failed(self) -> None:
        if self._failed is not None:
            error, self._failed = self._failed, None
            raise error

    def step(self, n: int = 1) -> int:
        """Takes n steps, also beyond time.end and the stop conditions. Returns how many were taken: fewer if a call stopped the world.
        Ctrl-C ends it between two steps, with a checkpoint if there is an output folder."""
        before, n = self.steps, whole(n, "number of steps", 0)
        with self._kept_on_interrupt():
            while n > 0:
                count = min(n, self._chunk)
                began = clock.perf_counter()
                if not self._advance(lib.gneiss_world_step, count):
                    break
                n -= count
                took = clock.perf_counter() - began
                if took < 0.5 * _SLICE and count == self._chunk:
                    self._chunk *= 2
                elif took > 2.0 * _SLICE:
                    self._chunk = max(1, self._chunk // 2)
        return self.steps - before

    def run(self, until: Time | Callable[[World], Any] | None = None, *, every: int = 100, progress: bool = False) -> Progress:
        """Runs to time.end or a stop condition, and then writes the files of a finished run if there is an output folder.

        until     a time (s, or '2 ms') or a function(world) that is asked every `every` steps: stops there instead, without finishing
        progress  a bar, with tqdm if that is installed

        Returns the property `progress`. Ctrl-C ends the run between two steps, with a checkpoint if there is an output folder.
        """
        end = None if until is None or callable(until) else seconds_of(until)
        going, stop = True, None
        if callable(until):
            stop = self.every(every, _stop_when(until))
        elif end is not None:
            if end < self.time - 0.5 * self.dt:
                raise InputError(f"until: expected a time after the present {self.time:.9g} s, found {end:.9g} s")
            if self.time >= end - 0.5 * self.dt:
                return self.progress
            stop = self.at([end], World.stop)
        try:
            with self._kept_on_interrupt(), bar(progress) as show:
                last = min(end, self.progress.end) if end is not None else self.progress.end
                while going and not self.progress.finished:
                    going = self._advance(lib.gneiss_world_advance, _SLICE)
                    show(self.time / last if last > 0.0 else 1.0, f"step {self.steps}, t = {self.time:.4g} s")
        finally:
            if stop is not None:
                stop.remove()
        if going and self.progress.finished:
            self.finish()
        return self.progress

    def finish(self) -> None:
        """Writes the last snapshot, a checkpoint, results.h5 and summary.json, if there is an output folder."""
        with files:
            self._checked(lib.gneiss_world_finish)
        self._kept = self.steps

    def stop(self) -> None:
        """Inside a call: has `step` or `run` return after it."""
        self._stop = True

    # --- hooks ---

    def every(self, n: int, function: Callable[[World], Any] | None = None) -> Any:
        """Has function(world) called after each step whose number is a multiple of n. Also a decorator. Returns a Hook."""
        return self._hooked(hooks.add_call, function, every=whole(n, "number of steps", 1))

    def at(self, times: Time | Sequence[Time], function: Callable[[World], Any] | None = None) -> Any:
        """Has function(world) called after the step that ends nearest to each of `times` (s, or '2 ms'), which have to be
        after the present one. Also a decorator."""
        several: Any = [times] if isinstance(times, str) or np.ndim(times) == 0 else times
        instants = sorted({seconds_of(time) for time in several})
        if instants and not instants[0] > self.time:
            raise InputError(f"times: expected times after the present {self.time:.9g} s, found {instants[0]:.9g} s")
        return self._hooked(hooks.add_call, function, times=instants)

    def force(self, function: Callable[[Points], Any] | None = None, *, stiffness: float = 0.0, on: str = "particles") -> Any:
        """Adds a field of force: function(points) writes points.force [n][3], N, or returns it, in every step. Its work is `work_user` of
        the energy ledger. `stiffness`, N/m: the largest stiffness that it adds to the motion of a particle; an automatic time step is lowered
        for it. on: 'particles', or 'nodes' of finite elements. Also a decorator. Returns a Hook."""
        return self._hooked(hooks.add_force, function, stiffness=stiffness, on=on)

    def _hooked(self, add: Any, function: Any, **options: Any) -> Any:
        if function is None:
            return lambda own: add(self, own, **options)
        self._pointer()
        return add(self, function, **options)

    # --- changes ---

    @property
    def velocities(self) -> Array:
        """[n][3] m/s of the last half step, in the present order: read-only. To be set as a whole: lists and the step follow, the change of
        kinetic energy is booked as `work_user`."""
        return self.particles.velocity

    @velocities.setter
    def velocities(self, values: Any) -> None:
        self._set_velocities(values, None)

    @property
    def spins(self) -> Array:
        """[n][3] rad/s. To be set as `velocities`."""
        return self.particles["spin"][:, :3]

    @spins.setter
    def spins(self, values: Any) -> None:
        self._set_velocities(self.velocities, values)

    def _set_velocities(self, velocity: Any, spin: Any) -> None:
        n = self.particles.count
        given = [None if value is None else np.ascontiguousarray(rows(value, (n, 3), what))
                 for value, what in ((velocity, "velocities"), (spin, "spins"))]
        pointers = [ffi.NULL if row is None else ffi.cast("double *", row.ctypes.data) for row in given]
        self._checked(lib.gneiss_world_set_velocities, *pointers, n)

    def set_motion(self, name: str, **components: float) -> None:
        """Sets components of the prescribed motion of a wall, set or body from the coming step on: vx vy vz (m/s), wx wy wz (rad/s). The
        scene has to prescribe the component; 0 suffices."""
        for component, value in components.items():
            if component not in _COMPONENTS:
                raise InputError(f"expected one of {', '.join(_COMPONENTS)}, found '{component}'")
            value = finite(value, f"{component} of '{name}', {'m/s' if component[0] == 'v' else 'rad/s'}")
            self._checked(lib.gneiss_world_set_motion, str(name).encode(), _COMPONENTS[component], value)

    def end_stage(self) -> None:
        """Ends the present stage of a scene with stages: the next one begins with the coming step; after the last the run is finished."""
        self._checked(lib.gneiss_world_end_stage)

    # --- state ---

    @property
    def time(self) -> float:
        """s."""
        return lib.gneiss_world_time(self._pointer())

    @property
    def steps(self) -> int:
        """Steps taken."""
        return lib.gneiss_world_steps(self._pointer())

    @property
    def hash(self) -> str:
        """The hash of the state as 16 hexadecimal digits, as `state_hash` of summary.json: equal for equal bits."""
        return f"{lib.gneiss_world_hash(self._pointer()):016x}"

    @property
    def progress(self) -> Progress:
        """step, time, end, dt, stress, strain, finished, stop_reason, stage, ..."""
        return _read(Progress, "gneiss_progress", lib.gneiss_world_progress, self._pointer())

    @property
    def dt(self) -> float:
        """s: the coming step."""
        return self.progress.dt

    @property
    def limits(self) -> Limits:
        """Limits of the step by the last estimate."""
        return _read(Limits, "gneiss_limits", lib.gneiss_world_limits, self._pointer())

    @property
    def counts(self) -> Counts:
        """particles, bonds, pairs, broken_tension, broken_shear, removed, ..."""
        return _read(Counts, "gneiss_counts", lib.gneiss_world_counts, self._pointer())

    @property
    def element_counts(self) -> ElementCounts:
        """nodes, elements, asleep."""
        return _read(ElementCounts, "gneiss_element_counts", lib.gneiss_world_element_counts, self._pointer())

    @property
    def origin(self) -> Array:
        """[3] m: positions in fields are relative to it."""
        origin = ffi.new("double[3]")
        checked(lib.gneiss_world_origin, self._pointer(), origin)
        return np.array(list(origin))

    # --- pictures ---

    def plot(self, colour: pictures.Colour = "velocity", *, cut: pictures.Cut = None, view: str | None = None,
             limits: tuple[float, float] | None = None, size: float = 6.0) -> Any:
        """A matplotlib Figure of the particles.

        colour  a field or an output of particles by name (of vectors the size: 'velocity', 'displacement', 'damage'), or an array [n] in
                the present order
        cut     ('y', 0.01): the section by the plane y = 0.01 m
        view    axis along which it is seen; default z in 2D, y in 3D
        limits  values of the ends of the colour scale
        size    inches
        """
        return pictures.figure_of(self, colour, cut, view, limits, size)

    def animate(self, frames: int = 40, until: Time | None = None, colour: pictures.Colour = "velocity", *, cut: pictures.Cut = None,
                view: str | None = None, size: float = 5.0) -> pictures.Film:
        """Advances the world to `until` (default: its end) and returns a Film of pictures that are equally apart in time."""
        return pictures.film_of(self, frames, until, colour, cut, view, size)

    def _repr_png_(self) -> bytes | None:
        return None if self.closed else pictures.png_of(self)

    def _repr_html_(self) -> str | None:
        return None if self.closed else pictures.html_of(self)

    def dataset(self) -> Any:
        """History, particles and bonds of the present state as an xarray.Dataset with units and descriptions: a copy."""
        from .results import dataset_of
        fields = {name: ({key: getattr(self, name).output(key) for key in getattr(self, name).outputs}, getattr(self, name).outputs)
                  for name in ("particles", "bonds")}
        return dataset_of({"history": (self.history, self.history.about), **fields})

    # --- saving ---

    def save(self, path: Path) -> None:
        """Writes the whole state to one file, under a temporary name first. A world loaded from it continues with the same bits; hooks are
        not part of it."""
        with files:
            self._checked(lib.gneiss_world_save, encoded(path))

    def checkpoint(self) -> None:
        """Writes a checkpoint into the output folder, which keeps the newest two, and updates results.h5."""
        with files:
            self._checked(lib.gneiss_world_checkpoint)
        self._kept = self.steps

    def copy(self) -> World:
        """Another world with the same state, without hooks and output folder."""
        return self.__reduce__()[0](*self.__reduce__()[1])

    def __reduce__(self) -> tuple[Any, ...]:
        with tempfile.TemporaryDirectory(prefix="gneiss-") as folder:
            path = os.path.join(folder, "world.h5")
            self.save(path)
            with open(path, "rb") as file:
                return _unpickled, (file.read(),)

    def __repr__(self) -> str:
        if self.closed:
            return "<gneiss.World, closed>"
        counts, progress = self.counts, self.progress
        return f"<gneiss.World: {counts.particles} particles, {counts.bonds} bonds, step {progress.step}, t = {progress.time:.4g} s>"


def _stop_when(condition: Callable[[World], Any]) -> Callable[[World], None]:
    def ask(world: World) -> None:
        if condition(world):
            world.stop()

    return ask


def _unpickled(data: bytes) -> World:
    with tempfile.TemporaryDirectory(prefix="gneiss-") as folder:
        path = os.path.join(folder, "world.h5")
        with open(path, "wb") as file:
            file.write(data)
        return World.load(path)
