"""Progress of a run: tqdm's bar, or a line on standard error where tqdm is not installed."""
from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import Any


@contextlib.contextmanager
def bar_of(world: Any, until: float | None) -> Iterator[Callable[[], None]]:
    """Gives a function that shows how far the world is on its way to `until`, s, or to time.end."""
    end = min(until, world.progress.end) if until is not None else world.progress.end
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield lambda: _line(world, end)
        print(file=sys.stderr)
        return
    with tqdm(total=end, initial=world.time, unit="s", bar_format="{percentage:3.0f} %|{bar}| {desc}[{elapsed}<{remaining}]") as bar:
        def show() -> None:
            bar.set_description_str(f"step {world.steps}, t = {world.time:.4g} s ", refresh=False)
            bar.update(min(world.time, end) - bar.n)

        yield show


def _line(world: Any, end: float) -> None:
    share = 100.0 * min(1.0, world.time / end) if end > 0.0 else 100.0
    print(f"\r{share:3.0f} %, step {world.steps}, t = {world.time:.4g} s", end="", file=sys.stderr, flush=True)
