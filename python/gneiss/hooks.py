"""Functions that are called between steps, and fields of force."""
from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from ._library import ffi, lib
from .arguments import finite, function_of, rows
from .errors import InputError, checked
from .fields import Array, memory_array

if TYPE_CHECKING:
    from .world import World


class Hook:
    """A function or a field of force that was added to a world. `remove` removes it."""

    def __init__(self, world: World, function: Callable[..., Any]) -> None:
        self._world, self._function = weakref.ref(world), function
        self._number, self._callback = -1, None

    def remove(self) -> None:
        """Ends it. Does nothing if it has ended."""
        world = self._world()
        if world is not None and world._hooks.pop(self._number, None) is not None and not world.closed:
            checked(lib.gneiss_world_remove_hook, world._c, self._number)
            if world._inside:
                world._removed.append(self)  # C code may still be in its callback

    def __call__(self, *arguments: Any) -> Any:
        return self._function(*arguments)


def _keep(world: World, hook: Hook, number: Any) -> Hook:
    hook._number = number[0]
    world._hooks[hook._number] = hook
    return hook


def add_call(world: World, function: Callable[[World], Any], every: int = 0, times: Sequence[float] = ()) -> Hook:
    """Has function(world) called after every `every`th step, and after the step that ends nearest to each of `times`, s."""
    hook = Hook(world, function_of(function))
    reference = hook._world

    def note(kind, error, _trace):
        world = reference()
        if world is not None:
            world._failed = error
        return 1

    @ffi.callback("gneiss_call", error=1, onerror=note)
    def call(_context, _handle):
        world: Any = reference()
        function(world)
        return world._stop

    hook._callback = call
    instants = np.ascontiguousarray(times, float).ravel()
    number = ffi.new("int64_t *")
    checked(lib.gneiss_world_add_call, world._c, every, ffi.cast("double *", instants.ctypes.data), len(instants), call, ffi.NULL, number)
    return _keep(world, hook, number)


class Points:
    """Particles or nodes at the instant of the forces, in their present order; arrays over the engine's memory.

    time       s
    position   [n][3] m, relative to World.origin
    radius     [n] m
    velocity   [n][3] m/s, of the last half step
    inverse_mass  [n] 1/kg; 0: removed
    spin       [n][3] rad/s; None without rotation
    id         [n] place in the specimen, or node of the mesh
    force      [n][3] N, zeros; to be written (or the function returns it)
    moment     [n][3] N m, zeros; to be written; None without rotation
    """

    time: float
    position: Array
    radius: Array
    velocity: Array
    inverse_mass: Array
    spin: Optional[Array]
    id: Array
    force: Array
    moment: Optional[Array]

    def __init__(self) -> None:
        self._places: Any = None

    def _take(self, points: Any) -> None:
        self.time = points.time
        places = (points.position, points.velocity, points.spin, points.id, points.force, points.moment, points.count)
        if places == self._places:
            return
        n = points.count
        self._places = places
        position = memory_array(points.position, (n, 4))
        velocity = memory_array(points.velocity, (n, 4))
        self.position, self.radius, self.velocity, self.inverse_mass = position[:, :3], position[:, 3], velocity[:, :3], velocity[:, 3]
        self.spin = memory_array(points.spin, (n, 4))[:, :3] if points.spin else None
        self.id = memory_array(points.id, (n,), "<i4")
        self.force = memory_array(points.force, (n, 3), writable=True)
        self.moment = memory_array(points.moment, (n, 3), writable=True) if points.moment else None


def add_force(world: World, function: Callable[[Points], Any], stiffness: float = 0.0, on: str = "particles") -> Hook:
    """Adds the field of force function(points), called once in every step."""
    records = {"particles": lib.GNEISS_PARTICLES, "nodes": lib.GNEISS_NODES}
    if on not in records:
        raise InputError(f"on: expected a field of force on {' or '.join(records)}, found {on!r}")
    if on == "nodes" and not world.nodes.count:
        raise InputError("on: expected a scene with finite elements for a field of force on nodes, found one without")
    stiffness = finite(stiffness, "stiffness, N/m")
    hook, points = Hook(world, function_of(function)), Points()
    reference = hook._world

    def note(kind, error, _trace):
        world = reference()
        if world is not None:
            world._failed = world._cause = error
        return 1

    def evaluate():
        force = function(points)
        if force is not None:
            points.force[...] = rows(force, points.force.shape, "field of force")

    @ffi.callback("gneiss_force", error=1, onerror=note)
    def act(_context, c_points):
        points._take(c_points)
        try:
            evaluate()
        except KeyboardInterrupt as error:  # the step is finished first
            own: Any = reference()
            own._failed = error
            points.force[...] = 0.0
            if points.moment is not None:
                points.moment[...] = 0.0
            evaluate()
        return 0

    hook._callback = act
    number = ffi.new("int64_t *")
    checked(lib.gneiss_world_add_force, world._c, records[on], stiffness, act, ffi.NULL, number)
    return _keep(world, hook, number)
