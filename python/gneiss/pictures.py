"""Pictures and films of a world, with matplotlib."""
from __future__ import annotations

import base64
import html
import io
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np

from .arguments import finite, rows, whole
from .errors import InputError
from .fields import Array

if TYPE_CHECKING:
    from .world import World

Colour = Union[str, Array]
Cut = Union[tuple[str, float], None]


class Discs(NamedTuple):
    """The circles of a picture, from back to front: places [n][2] m, radii [n] m, values [n]."""
    place: Array
    radius: Array
    value: Array


def values_of(world: World, colour: Colour) -> tuple[Array, str]:
    """[particles] in their present order, and a label. A field or an output by its name (of vectors the size), or an array."""
    if not isinstance(colour, str):
        return rows(colour, (world.particles.count,), "colour"), ""
    particles = world.particles
    if colour in ("position", "radius", "velocity"):
        values, unit = getattr(particles, colour), "m/s" if colour == "velocity" else "m"
    elif colour in particles:
        values, unit = particles[colour], particles.about[colour].unit
    elif colour in particles.outputs:  # the values are sorted by id
        place = np.searchsorted(particles.output("id"), particles["id"])
        values, unit = particles.output(colour)[place], particles.outputs[colour].unit
    else:
        raise KeyError(f"{colour}: expected a field ({', '.join(particles)}) or an output ({', '.join(particles.outputs)})")
    values = np.asarray(values, float)
    return values if values.ndim == 1 else np.linalg.norm(values, axis=1), f"{colour}, {unit}"


def discs_of(world: World, colour: Colour, cut: Cut, view: str) -> tuple[Discs, str, str]:
    """Discs, the label of their values and the two axes. `cut` ('y', 0.01): the section by a plane; else seen along `view`."""
    value, label = values_of(world, colour)
    if cut is not None:
        if isinstance(cut, str) or len(cut) != 2:
            raise InputError(f"cut: expected an axis and a height such as ('y', 0.01), found {cut!r}")
        finite(cut[1], "cut, m")
    for name, axis in (("cut", cut[0] if cut else "x"), ("view", view)):
        if axis not in ("x", "y", "z"):
            raise InputError(f"{name}: expected an axis, 'x', 'y' or 'z', found {axis!r}")
    position, radius = world.particles.position + world.origin, world.particles.radius.copy()
    there = np.isfinite(world.particles.mass)
    along = "xyz".index(cut[0] if cut else view)
    across = [axis for axis in range(3) if axis != along]
    if cut is not None:
        height = radius ** 2 - (position[:, along] - cut[1]) ** 2
        there &= height > 0
        radius = np.sqrt(np.maximum(height, 0.0))
    # Seen along y the viewer stands at low y, else at high coordinates, so that the axes are right-handed.
    order = np.argsort(position[:, along] * (-1 if along == 1 else 1), kind="stable")
    order = order[there[order]]
    return Discs(position[order][:, across], radius[order], value[order]), label, "".join("xyz"[axis] for axis in across)


def _is_plane(world: World) -> bool:
    return not np.ptp(world.particles["pos"][:, 2]) > 0.0


def _axes(figure: Any, discs: Discs, axes_names: str) -> Any:
    axes = figure.add_subplot()
    if len(discs.place):
        low, high = (discs.place - discs.radius[:, None]).min(0), (discs.place + discs.radius[:, None]).max(0)
        margin = 0.02 * max(high - low)
        axes.set_xlim(low[0] - margin, high[0] + margin)
        axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_xlabel(f"{axes_names[0]}, m")
    axes.set_ylabel(f"{axes_names[1]}, m")
    return axes


def _collection(axes: Any, discs: Discs, limits: tuple[float, float] | None) -> Any:
    from matplotlib.collections import EllipseCollection
    size = 2.0 * discs.radius
    shown = EllipseCollection(size, size, np.zeros(len(size)), units="xy", offsets=discs.place, transOffset=axes.transData,
                              array=discs.value, cmap="viridis", linewidths=0.3, edgecolors="k")
    if limits is not None:
        shown.set_clim(*limits)
    axes.add_collection(shown)
    return shown


def figure_of(world: World, colour: Colour = "velocity", cut: Cut = None, view: str | None = None,
              limits: tuple[float, float] | None = None, size: float = 6.0) -> Any:
    """A matplotlib figure of the particles."""
    from matplotlib.figure import Figure
    discs, label, names = discs_of(world, colour, cut, view or ("z" if _is_plane(world) else "y"))
    figure = Figure(figsize=(size, size), layout="constrained")
    axes = _axes(figure, discs, names)
    figure.colorbar(_collection(axes, discs, limits), ax=axes, label=label, shrink=0.7)
    axes.set_title(f"step {world.steps}, t = {world.time:.4g} s", fontsize="medium")
    return figure


def png_of(world: World) -> bytes | None:
    """A picture as PNG; None without particles or matplotlib."""
    if not world.particles.count:
        return None
    try:
        figure = figure_of(world, size=4.5)
    except ImportError:
        return None
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=100)
    return data.getvalue()


def html_of(world: World) -> str:
    """A table of the properties of a world, and its picture."""
    progress, counts = world.progress, world.counts
    rows = {"step": progress.step, "time": f"{progress.time:.6g} of {progress.end:.6g} s", "particles": counts.particles,
            "bonds": f"{counts.bonds}, {counts.broken_tension + counts.broken_shear} broken", "time step": f"{progress.dt:.4g} s",
            "energy residual": f"{progress.energy_residual:.3g}", "ended": progress.stop_reason or "not yet", "state": world.hash}
    table = "".join(f"<tr><th>{name}</th><td>{html.escape(str(value))}</td></tr>" for name, value in rows.items())
    picture = png_of(world)
    image = f'<img src="data:image/png;base64,{base64.b64encode(picture).decode()}">' if picture else ""
    return f"<table>{table}</table>{image}"


class Film:
    """Frames of a run. `save` writes a GIF, or what the name says and ffmpeg can; in Jupyter it shows itself with a slider."""

    def __init__(self, frames: list[tuple[Discs, str]], label: str, names: str, size: float) -> None:
        from matplotlib.animation import FuncAnimation
        from matplotlib.figure import Figure
        values = np.concatenate([discs.value for discs, _ in frames])
        limits = (float(values.min()), float(values.max()))
        self.frames = len(frames)
        figure = Figure(figsize=(size, size), layout="constrained")
        self._every = Discs(*(np.concatenate(parts) for parts in zip(*(discs for discs, _ in frames))))
        axes = _axes(figure, self._every, names)
        figure.colorbar(_collection(axes, frames[0][0], limits), ax=axes, label=label, shrink=0.7)

        def draw(k: int) -> list[Any]:
            discs, title = frames[k]
            for old in list(axes.collections):
                old.remove()
            axes.set_title(title, fontsize="medium")
            return [_collection(axes, discs, limits)]

        from matplotlib.backends.backend_agg import FigureCanvasAgg
        FigureCanvasAgg(figure)
        self.animation = FuncAnimation(figure, draw, frames=len(frames), interval=60, blit=False)

    def save(self, path: str, fps: int = 15) -> None:
        """Writes a .gif (Pillow), .mp4 (ffmpeg), ..."""
        self.animation.save(path, writer="pillow" if str(path).endswith(".gif") else None, fps=fps)

    def _repr_html_(self) -> str:
        return str(self.animation.to_jshtml())


def film_of(world: World, frames: int, until: Any, colour: Colour, cut: Cut, view: str | None, size: float) -> Film:
    """Advances the world and takes frames that are equally apart in time."""
    from .world import seconds_of
    frames = whole(frames, "number of frames", 1)
    end = world.progress.end if until is None else seconds_of(until)
    times = np.linspace(world.time, end, frames)
    seen = view or ("z" if _is_plane(world) else "y")
    taken, label, names = [], "", ""
    for time in times:
        if time > world.time:
            world.run(until=float(time))
        discs, label, names = discs_of(world, colour, cut, seen)
        taken.append((discs, f"step {world.steps}, t = {world.time:.4g} s"))
        if world.progress.finished:
            break
    return Film(taken, label, names, size)
