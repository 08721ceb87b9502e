"""Progress bars: tqdm's, or a line on standard error if tqdm is not installed."""
from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def bar(wanted: bool = True) -> Iterator[Callable[[float, str], None]]:
    """Yields a function that shows the completed fraction, 0 to 1, and a text."""
    if not wanted:
        yield lambda share, text: None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield _line
        print(file=sys.stderr)
        return
    with tqdm(total=1.0, bar_format="{percentage:3.0f} %|{bar}| {desc}[{elapsed}<{remaining}]") as shown:
        def show(share: float, text: str) -> None:
            shown.set_description_str(text + " ", refresh=False)
            shown.update(min(share, 1.0) - shown.n)
            shown.refresh()

        yield show


def _line(share: float, text: str) -> None:
    print(f"\r{100.0 * min(share, 1.0):3.0f} %, {text}", end="", file=sys.stderr, flush=True)
