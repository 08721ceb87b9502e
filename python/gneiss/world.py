"""Worlds: a model that runs."""
from __future__ import annotations

import contextlib
import os
import tempfile
import threading
import time as clock
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import hooks, pictures
from ._library import encoded, ffi, files, lib, text
from .bars import bar
from .errors import InputError, Interrupted, checked
from .fields import Array, History, Particles, Quantities, Record, memory_array
from .hooks import Hook, Points
from .scene import Changes, Scene, Source, as_c, scene_of

_SLICE = 0.05  # s of wall time between two checks for signals
_COMPONENTS = {"vx": 0, "vy": 1, "vz": 2, "wx": 3, "wy": 4, "wz": 5}
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}


Path = Union[str, "os.PathLike[str]"]
Time = Union[float, str]


def seconds_of(value: Time) -> float:
    """A time in s from a number or a text such as '2 ms'."""
    if not isinstance(value, str):
        return float(value)
    for unit in sorted(_SECONDS, key=len, reverse=True):
        if value.strip().endswith(unit):
            with contextlib.suppress(ValueError):
                return float(value.strip()[:-len(unit)]) * _SECONDS[unit]
    try:
        return float(value)
    except ValueError:
        raise InputError(f"expected a time such as '2 ms', found '{value}'") from None


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
    energy: Quantities

    def __init__(self, scene: Scene | Source, folder: Path | None = None, *, prepare: Callable[[Specimen], Any] | None = None,
                 set: Changes = None, allow_gmsh: bool | None = None) -> None:
        made, failed = ffi.new("gneiss_world **"), list[BaseException]()
        scene = scene_of(scene, set=set, allow_gmsh=allow_gmsh)
        callback = _specimen_callback(prepare, failed) if prepare else ffi.NULL
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
        self._failed: Optional[BaseException] = None
        self._chunk, self._lock = 1, threading.Lock()
        for number, name in enumerate(("particles", "bonds", "pairs", "wall_contacts", "nodes", "elements")):
            setattr(self, name, (Particles if number == 0 else Record)(self._c, number))
        self.history = History(self._c)
        self.readings = Quantities(self._c, lib.gneiss_reading_count, lib.gneiss_world_reading_at)
        self.energy = Quantities(self._c, lib.gneiss_energy_count, lib.gneiss_world_energy_at)

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
        """Frees the world without writing anything, as soon as no array shows its memory any more."""
        if self._inside:
            raise RuntimeError("expected no end of a world inside a call of its own hooks")
        self._c = None
        self._hooks.clear()
        for name in ("particles", "bonds", "pairs", "wall_contacts", "nodes", "elements", "history", "readings", "energy"):
            self.__dict__.pop(name, None)

    def __getattr__(self, name: str) -> Any:
        if name in ("particles", "bonds", "pairs", "wall_contacts", "nodes", "elements", "history", "readings", "energy"):
            raise ValueError("the world is closed")
        raise AttributeError(f"a World has no {name}")

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def _pointer(self) -> Any:
        if self._c is None:
            raise ValueError("the world is closed")
        return self._c

    # --- advance ---

    def _advance(self, function: Any, *arguments: Any) -> bool:
        """Makes one call into the engine; returns False if a function of a hook requested to stop."""
        pointer = self._pointer()
        if not self._inside and not self._lock.acquire(blocking=False):
            raise RuntimeError("the world is in use by another thread")
        if self._inside:
            raise InputError("expected no advance of a world inside a call of its own hooks")
        self._inside = bool(self._hooks)
        try:
            if self._writes:
                with files:
                    checked(function, pointer, *arguments)
            else:
                checked(function, pointer, *arguments)
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
        """Takes n steps, also beyond time.end and the stop conditions. Returns how many were taken: fewer if a call stopped the world."""
        before = self.steps
        if n < 0:
            raise InputError(f"expected a number of steps of at least 0, found {n}")
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

        Returns the property `progress`.
        """
        end = None if until is None or callable(until) else seconds_of(until)
        going, stop = True, None
        if callable(until):
            stop = self.every(every, _stop_when(until))
        elif end is not None:
            if self.time >= end - 0.5 * self.dt:
                return self.progress
            stop = self.at([end], World.stop)
        try:
            with bar(progress) as show:
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
            checked(lib.gneiss_world_finish, self._pointer())

    def stop(self) -> None:
        """Inside a call: has `step` or `run` return after it."""
        self._stop = True

    # --- hooks ---

    def every(self, n: int, function: Callable[[World], Any] | None = None) -> Any:
        """Has function(world) called after each step whose number is a multiple of n. Also a decorator. Returns a Hook."""
        if n < 1:
            raise InputError(f"expected a number of steps of at least 1, found {n}")
        return self._hooked(hooks.add_call, function, every=n)

    def at(self, times: Time | Sequence[Time], function: Callable[[World], Any] | None = None) -> Any:
        """Has function(world) called after the step that ends nearest to each of `times` (s, or '2 ms'). Also a decorator."""
        times = [times] if isinstance(times, (str, float, int)) else times
        return self._hooked(hooks.add_call, function, times=sorted({seconds_of(time) for time in times}))

    def force(self, function: Callable[[Points], Any] | None = None, *, stiffness: float = 0.0, on: str = "particles") -> Any:
        """Adds a field of force: function(points) writes points.force [n][3], N, or returns it, in every step. Its work is `work_user` of
        the energy ledger. `stiffness`, N/m: the largest by which it stiffens the motion of a particle; an automatic time step is lowered
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
        rows = [None if value is None else np.ascontiguousarray(np.broadcast_to(np.asarray(value, float), (n, 3)))
                for value in (velocity, spin)]
        pointers = [ffi.NULL if row is None else ffi.cast("double *", row.ctypes.data) for row in rows]
        checked(lib.gneiss_world_set_velocities, self._pointer(), *pointers, n)

    def set_motion(self, name: str, **components: float) -> None:
        """Sets components of the prescribed motion of a wall, set or body from the coming step on: vx vy vz (m/s), wx wy wz (rad/s). The
        scene has to prescribe the component; 0 suffices."""
        for component, value in components.items():
            if component not in _COMPONENTS:
                raise InputError(f"expected one of {', '.join(_COMPONENTS)}, found '{component}'")
            checked(lib.gneiss_world_set_motion, self._pointer(), name.encode(), _COMPONENTS[component], value)

    def end_stage(self) -> None:
        """Ends the present stage of a scene with stages: the next one begins with the coming step; after the last the run is finished."""
        checked(lib.gneiss_world_end_stage, self._pointer())

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
            checked(lib.gneiss_world_save, self._pointer(), encoded(path))

    def checkpoint(self) -> None:
        """Writes a checkpoint into the output folder, which keeps the newest two, and updates results.h5."""
        with files:
            checked(lib.gneiss_world_checkpoint, self._pointer())

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
