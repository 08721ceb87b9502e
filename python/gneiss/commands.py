"""Commands of the program as functions: runs in processes of their own, packings, plans, elastic constants, sweeps, calibrations."""
from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Union

from ._library import program
from .bars import bar
from .errors import error_of
from .results import Results
from .scene import Changes, Scene, Source, overrides_of, written

Path = Union[str, "os.PathLike[str]"]
Seeds = Union[int, Sequence[int], None]


def _shared(name: str) -> int:
    """Opens a file that calls of the same content share: the last one that holds it may remove it."""
    while True:
        file = os.open(name, os.O_RDWR | os.O_CREAT, 0o600)
        fcntl.flock(file, fcntl.LOCK_SH)
        with contextlib.suppress(FileNotFoundError):
            if os.stat(name).st_ino == os.fstat(file).st_ino:
                return file
        os.close(file)


@contextlib.contextmanager
def _file_of(source: Scene | Source, folder: Path | None = None) -> Iterator[str]:
    """The path of a file with a dict, text or Scene, for the duration of a command; a path is not changed. Its name follows from its
    content, by which a folder of results knows its scene again."""
    if isinstance(source, os.PathLike) or (isinstance(source, str) and "\n" not in source):
        yield os.fspath(source)
        return
    text = source.text if isinstance(source, Scene) else written(source) if isinstance(source, Mapping) else source
    data = text.encode()
    name = os.path.join(folder or os.getcwd(), f"gneiss-{hashlib.sha256(data).hexdigest()[:16]}.yaml")
    file = _shared(name)
    try:
        os.pwrite(file, data, 0)
        yield name
    finally:
        with contextlib.suppress(BlockingIOError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            os.unlink(name)
        os.close(file)


def _share(progress: Mapping[str, Any]) -> tuple[float, str]:
    """The completed fraction of a command, from its line of progress, and a text."""
    if "time" in progress:
        return progress["time"] / progress["end"], f"step {progress['step']}, t = {progress['time']:.4g} s"
    if "total" in progress:
        return progress.get("done", 0) / max(1, progress["total"]), f"{progress.get('done', 0)} of {progress['total']} runs"
    return progress.get("fraction", 0.0), str(progress.get("packing", ""))


def _lines(process: Any, show: Any) -> list[dict[str, Any]]:
    """The JSON lines of a command; the progress is shown while it runs."""
    found = []
    for text in process.stdout:
        if not text.startswith("{"):
            continue
        found.append(json.loads(text))
        if found[-1]["level"] == "progress":
            show(*_share(found[-1]["progress"]))
    return found


def _call(command: str, target: Path, *options: str, changes: Changes = None, progress: bool = False, **named: Any) -> dict[str, Any]:
    """Runs the program. Returns its result (docs/log.md), {} of commands without one. Raises its errors as exceptions."""
    line = [program(), command, os.fspath(target), "--log", "json", *options]
    for change in overrides_of(changes):
        line += ["--set", change]
    for name, value in named.items():
        if value is None or value is False:
            continue
        line.append("--" + name.replace("_", "-"))
        if value is not True:
            line.append(",".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value))
    with tempfile.TemporaryFile("w+", errors="replace") as messages:
        process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=messages, text=True, errors="replace")
        try:
            with bar(progress) as show:
                lines = _lines(process, show)
            process.wait()
        except BaseException:  # Ctrl-C has reached the program as well: it writes its checkpoint
            with contextlib.suppress(KeyboardInterrupt):
                process.terminate()
                process.communicate()
            raise
        messages.seek(0)
        if process.returncode != 0:
            errors = [entry["text"] for entry in lines if entry["level"] == "error"]
            message = "\n".join(errors) or messages.read().strip()
            raise error_of(process.returncode, message.replace("with --out", "as `out`").replace("--force replaces", "force=True replaces"))
    return next((dict(entry["result"]) for entry in reversed(lines) if entry["level"] == "result"), {})


def run(scene: Scene | Source, out: Path, *, set: Changes = None, folder: Path | None = None, threads: int | None = None,
        seeds: Seeds = None, error: str | None = None, force: bool = False, progress: bool = False) -> Results:
    """Runs a scene in a process of its own, as `gneiss run`. `out`: folder of results. With `seeds` it runs several packings side by side,
    with `error` ('5%') it plans first. progress: a bar. Returns its Results."""
    with _file_of(scene, folder) as path:
        _call("run", path, changes=set, out=out, threads=threads, seeds=seeds, error=error, force=force, progress=progress)
    return Results(out)


def check(scene: Scene | Source, *, set: Changes = None, folder: Path | None = None) -> dict[str, Any]:
    """The findings of `gneiss check` about a scene and its specimen: warnings, particles, bonds, dt, ... (docs/log.md)."""
    with _file_of(scene, folder) as path:
        return _call("check", path, changes=set)


def pack(specimen: Scene | Source, out: Path, *, set: Changes = None, folder: Path | None = None, threads: int | None = None,
         seed: int | None = None, force: bool = False, progress: bool = False) -> Results:
    """Fills the shape of a specimen (a scene, or the part `specimen` of one) with particles, as `gneiss pack`. Returns its Results:
    particles.position [n][3], particles.radius [n], quality. A scene takes it by specimen: {file: OUT/packing.txt}."""
    with _file_of(specimen, folder) as path:
        _call("pack", path, changes=set, out=out, threads=threads, seed=seed, force=force, progress=progress)
    return Results(out)


def plan(scene: Scene | Source, *, error: str | None = None, reading: str | None = None, particles: str | None = None,
         set: Changes = None, folder: Path | None = None, threads: int | None = None) -> dict[str, Any]:
    """Without `error` what a run consists of: particles, bonds, dt, steps, ... With `error` ('5%') the cheapest settings for it: proposed,
    as_is, estimate, cost. reading: 'strength' or 'stiffness'; particles: 'any'. docs/log.md and docs/plan.md have the members."""
    with _file_of(scene, folder) as path:
        return _call("plan", path, changes=set, error=error, reading=reading, particles=particles, threads=threads)


def stiffness(scene: Scene | Source, *, strain: float | None = None, set: Changes = None, folder: Path | None = None,
              threads: int | None = None) -> dict[str, Any]:
    """Elastic constants of a bonded packing without a run, as a dict (docs/stiffness.md)."""
    with _file_of(scene, folder) as path:
        return _call("stiffness", path, changes=set, strain=strain, threads=threads)


def sweep(what: Mapping[str, Any] | Path, out: Path, *, set: Changes = None, folder: Path | None = None, seeds: Seeds = None,
          jobs: int | None = None, threads: int | None = None, force: bool = False, progress: bool = False) -> Results:
    """Runs a scene with several values of its keys, side by side (docs/sweep.md): a dict as a sweep file has it ({'scene': ...,
    'parameters': {...}, 'seeds': 3}; the scene is a path), or a file. Runs that were done are not done again. Returns its Results:
    parameters, readings, statistics, runs."""
    with _file_of(what, folder) as path:
        _call("sweep", path, changes=set, out=out, seeds=seeds, jobs=jobs, threads=threads, force=force, progress=progress)
    return Results(out)


def calibrate(targets: Mapping[str, Any] | Path, out: Path, *, folder: Path | None = None, seeds: Seeds = None, threads: int | None = None,
              force: bool = False) -> dict[str, Any]:
    """Finds the parameters that give a material the wanted readings (docs/calibrate.md), from a dict or a file of targets. Returns
    calibration.json as a dict; the folder `out` has calibrated.yaml too."""
    with _file_of(targets, folder) as path:
        _call("calibrate", path, out=out, seeds=seeds, threads=threads, force=force)
    with open(os.path.join(out, "calibration.json"), encoding="utf-8") as file:
        return json.load(file)


def report(folder: Path) -> str:
    """Makes report.html of a folder of results. Returns its path."""
    _call("report", folder)
    return os.path.join(folder, "report.html")


def view(folder: Path, *, instants: int | None = None, fields: Sequence[str] | None = None, paraview: bool = False) -> str:
    """Makes view.html, in which a run turns and moves in a browser (docs/view.md); with `paraview` a script that opens it in ParaView.
    Returns the path."""
    _call("view", folder, instants=instants, fields=fields, paraview=paraview)
    return os.path.join(folder, "paraview_state.py" if paraview else "view.html")
