"""Running the gneiss program from tests: one TAP line per fact. The program is the first argument."""
import fcntl
import json
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import traceback

import h5py
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "tools"))
import report_digest  # noqa: E402 (`seal` makes what a test changed in a file look as if the program had written it)

PROGRAM = os.path.abspath(sys.argv[1])
SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes")
UCS, LATTICE = os.path.join(SCENES, "ucs-small.yaml"), os.path.join(SCENES, "lattice-small.yaml")
# Environment without the leak checker of a sanitizer: its tracer occasionally fails after a program with threads
# has ended, and changes the exit code. `gneiss` below runs with the leak checker.
LEAK_OPTIONS = os.environ.get("ASAN_OPTIONS", "")
ENVIRONMENT = {**os.environ, "OMP_WAIT_POLICY": "passive", "ASAN_OPTIONS": LEAK_OPTIONS + ":detect_leaks=0"}
ENVIRONMENT.pop("GNEISS_ISA", None)
FACTS = []
with open(PROGRAM, "rb") as _program:
    SANITIZED = b"__asan_init" in _program.read()


class Skip(Exception):
    pass


def fact(function):
    FACTS.append(function)
    return function


def plain_fact(function):
    """Registers a fact that is skipped with sanitizers: it takes many steps through C code that another fact covers
    in less time, or it tests Python code."""
    return function if SANITIZED else fact(function)


def command(*arguments):
    return [PROGRAM, *map(str, arguments)]


def gneiss(*arguments, environment=None, **options):
    """Exit code and texts of one call; a call that does not end is a failure."""
    options.setdefault("timeout", 120)
    for checked in ({"ASAN_OPTIONS": LEAK_OPTIONS}, {}):
        done = subprocess.run(command(*arguments), capture_output=True, text=True, errors="replace",
                              env={**ENVIRONMENT, **checked, **(environment or {})}, **options)
        if "LeakSanitizer has encountered a fatal error" not in done.stderr:
            return done
    raise AssertionError("the leak checker dies where it is switched off")


def logged(printed, level="result"):
    """The contents of the objects of one level, of the text that --log json printed."""
    return [line[level] for line in map(json.loads, printed.splitlines()) if line["level"] == level]


def isas():
    """Names of the instruction sets and whether this machine has them."""
    line = re.search(r"instruction sets +(.*)", gneiss("info").stdout).group(1)
    return {name: not missing for name, missing in re.findall(r"(\w+)( \(not on this machine\))?", line)}


def expect(done, code, *patterns):
    """The exit code, and regular expressions that standard error must match."""
    assert done.returncode == code, f"exit code {done.returncode}, expected {code}: {done.stderr.strip()[:500]}"
    for pattern in patterns:
        assert re.search(pattern, done.stderr), f"expected /{pattern}/ in: {done.stderr.strip()[:500]}"
    return done


def on_terminal(columns, *arguments, interrupt=False):
    """Returns what a call writes to a terminal of this number of columns as standard error, and its exit code. The
    call can be interrupted at its first output."""
    main_end, end = pty.openpty()
    fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    process = subprocess.Popen(command(*arguments), stdout=subprocess.DEVNULL, stderr=end, env=ENVIRONMENT)
    os.close(end)
    shown = b""
    while True:
        try:
            more = os.read(main_end, 1 << 16)
        except OSError:  # Linux: the other end is closed
            break
        if not more:
            break
        if interrupt and not shown:
            process.send_signal(signal.SIGINT)
        shown += more
    os.close(main_end)
    return shown.decode(errors="replace"), process.wait(timeout=60)


def run(scene, folder, *arguments, **options):
    return expect(gneiss("run", scene, "--out", folder, "--quiet", *arguments, **options), 0)


def resume(folder, *arguments, **options):
    return expect(gneiss("resume", folder, "--quiet", *arguments, **options), 0)


def summary(folder):
    with open(os.path.join(folder, "summary.json")) as file:
        return json.load(file)


def state_hash(folder):
    return summary(folder)["state_hash"]


def text(attribute):
    """Fixed-length strings are bytes if they are plain ASCII."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


def results(folder):
    return h5py.File(os.path.join(folder, "results.h5"), "r")


def history(folder):
    with results(folder) as file:
        return {name: data[:] for name, data in file["history"].items()}


def series(folder, name="particles"):
    with open(os.path.join(folder, name + ".hdf.series")) as file:
        return [(entry["name"], entry["time"]) for entry in json.load(file)["files"]]


def two_checkpoints(folder):
    """A run of the lattice with two checkpoints, 'killed' before its end; their names, the newer last."""
    run(LATTICE, folder, "--set", "time.end=0.2 ms")
    older = checkpoints(folder)[0]
    shutil.copy(os.path.join(folder, older), os.path.join(folder, "kept"))
    resume(folder, "--set", "time.end=0.3 ms")
    os.rename(os.path.join(folder, "kept"), os.path.join(folder, older))
    assert len(checkpoints(folder)) == 2
    return checkpoints(folder)


def checkpoints(folder):
    return sorted(name for name in os.listdir(folder) if re.fullmatch(r"checkpoint_\d+\.h5", name))


def check_same(folder, reference):
    """Two runs that must have computed the same bits."""
    a, b = history(folder), history(reference)
    assert a.keys() == b.keys(), f"columns differ: {sorted(a.keys() ^ b.keys())}"
    for name in a:
        assert a[name].tobytes() == b[name].tobytes(), f"history/{name} differs"
    one, two = summary(folder), summary(reference)
    for key in ("state_hash", "readings", "counts", "energy_residual", "steps", "time"):
        assert one[key] == two[key], f"{key}: {one[key]} against {two[key]}"


def write_scene(folder, scene, name="scene.yaml"):
    """JSON is valid YAML."""
    path = os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(scene if isinstance(scene, str) else json.dumps(scene))
    return path


def wait_until(process, condition, seconds=60):
    """Returns True once the condition holds; False if the process ended before."""
    end = time.monotonic() + seconds
    while process.poll() is None:
        if condition():
            return True
        assert time.monotonic() < end, "nothing happened for a minute"
        time.sleep(0.002)
    return False


def place_of(number):
    """A folder for one fact. Its name has no random letters, because messages that contain it are searched for words and signs."""
    place = os.path.join(tempfile.gettempdir(), f"gneiss.{os.getpid()}.{number}")
    shutil.rmtree(place, ignore_errors=True)
    os.mkdir(place, 0o700)
    return place


def main():
    print(f"1..{len(FACTS)}")
    failures = 0
    for number, function in enumerate(FACTS, 1):
        name, outcome, note = function.__name__.replace("_", " "), "ok", ""
        folder = place_of(number)
        try:
            function(folder)
        except Skip as reason:
            note = f" # SKIP {reason}"
        except Exception:
            failures += 1
            outcome = "not ok"
            for line in traceback.format_exc().splitlines():
                print("# " + line)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        print(f"{outcome} {number} {name}{note}", flush=True)
    return 1 if failures else 0


__all__ = [name for name in dir() if not name.startswith("_")]
