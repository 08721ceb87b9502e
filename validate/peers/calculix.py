"""Decks for CalculiX (Debian package calculix-ccx): written from arrays, run without a window, results read back.

    deck = Deck("a block")
    deck.nodes(points)                                 # [n, 3], base 0 everywhere on this side
    deck.elements("C3D20R", connectivity)              # [n, 20], the order of CalculiX
    deck.node_set("BASE", places)
    deck.material(young, poisson, density)
    deck.boundary([("BASE", 1, 3)])
    deck.static(force, watch="NALL", stress=True)      # force[n, 3]
    result = deck.run(threads=2)
    result.displacement[node], result.stress[element]

Missing program, failed run and unreadable results raise CalculixError with the last lines of the log.
"""
import os
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

PROGRAM = os.environ.get("CCX", "ccx")
CORNERS = {"CPE3": 3, "CPE4": 4, "CPE6": 6, "CPE8": 8, "CPE8R": 8, "CPS8R": 8, "C3D4": 4, "C3D8": 8, "C3D10": 10,
           "C3D20": 20, "C3D20R": 20}
PER_LINE = 15  # numbers; CalculiX takes 16


class CalculixError(RuntimeError):
    """The program is missing, stopped, or left results that cannot be read."""


def version():
    """Version as the program prints it, "2.20"."""
    if not shutil.which(PROGRAM):
        raise CalculixError(f"expected the program {PROGRAM} (Debian package calculix-ccx, or the environment variable "
                            "CCX), found none in PATH")
    said = subprocess.run([PROGRAM, "-v"], capture_output=True, text=True, check=False).stdout
    found = re.search(r"Version\s+(\S+)", said)
    if not found:
        raise CalculixError(f"expected a version from {PROGRAM} -v, found {said!r}")
    return found.group(1)


def exact(x):
    """A number of at most 20 characters: CalculiX cuts off the rest, exponents included."""
    return f"{float(x):.12e}"


def wrapped(numbers):
    """Comma-separated, broken into lines that CalculiX accepts; a comma at the end of a line continues it."""
    rows = [", ".join(str(int(x)) for x in numbers[k:k + PER_LINE]) for k in range(0, len(numbers), PER_LINE)]
    return ",\n".join(rows)


class Deck:
    """An input deck in the making; numbers are base 0 in calls and base 1 in the file."""

    def __init__(self, title):
        self.title, self.lines, self.element_count, self.node_count = title, [], 0, 0

    def nodes(self, points):
        points = np.asarray(points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 3:
            raise CalculixError(f"{self.title}: expected points of shape (n, 3), found {points.shape}")
        self.node_count = len(points)
        self.lines.append("*NODE, NSET=NALL")
        self.lines += [f"{n}, {exact(x)}, {exact(y)}, {exact(z)}" for n, (x, y, z) in enumerate(points, 1)]

    def elements(self, kind, connectivity):
        connectivity = np.asarray(connectivity)
        if kind not in CORNERS or connectivity.ndim != 2 or connectivity.shape[1] != CORNERS[kind]:
            raise CalculixError(f"{self.title}: expected elements of a kind in {sorted(CORNERS)} with their number of "
                                f"nodes, found {kind} and shape {connectivity.shape}")
        if connectivity.min() < 0 or connectivity.max() >= self.node_count:
            raise CalculixError(f"{self.title}: expected nodes from 0 to {self.node_count - 1} in elements, found "
                                f"{connectivity.min()} to {connectivity.max()}")
        self.lines.append(f"*ELEMENT, TYPE={kind}, ELSET=EALL")
        self.lines += [wrapped([e, *row]) for e, row in enumerate(connectivity + 1, self.element_count + 1)]
        self.element_count += len(connectivity)

    def node_set(self, name, places):
        places = np.asarray(places)
        if not len(places):
            raise CalculixError(f"{self.title}: expected nodes in the set {name}, found none")
        self.lines.append(f"*NSET, NSET={name}")
        self.lines += [wrapped(places[k:k + PER_LINE] + 1) for k in range(0, len(places), PER_LINE)]

    def material(self, young, poisson, density=None):
        """One linear elastic material for all elements; plane elements are 1 thick."""
        self.lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{exact(young)}, {exact(poisson)}"]
        if density is not None:
            self.lines += ["*DENSITY", exact(density)]
        self.lines += ["*SOLID SECTION, ELSET=EALL, MATERIAL=M"]

    def boundary(self, fixed):
        """Components first to last (1 x, 2 y, 3 z) of sets held at zero."""
        self.lines.append("*BOUNDARY")
        self.lines += [f"{name}, {first}, {last}" for name, first, last in fixed]

    def forces(self, force):
        """force[n, 3] on nodes; zeros are left out."""
        force = np.asarray(force)
        self.lines.append("*CLOAD")
        self.lines += [f"{n + 1}, {k + 1}, {exact(force[n, k])}" for n, k in zip(*np.nonzero(force))]

    def static(self, force, watch, stress=False):
        """A linear static step; displacements of the set `watch`, and stresses of all elements if requested."""
        self.lines += ["*STEP", "*STATIC"]
        self.forces(force)
        self.lines += [f"*NODE PRINT, NSET={watch}", "U"]
        if stress:
            self.lines += ["*EL PRINT, ELSET=EALL", "S"]
        self.lines.append("*END STEP")

    def explicit(self, time, gravity, most=1000000):
        """An explicit step of that duration under gravity[3]; displacements of all nodes at its end. ccx 2.20 uses its own stable increment whatever
        is requested (Result.increment), and stops at once when DIRECT is given or the least increment is left out."""
        size = float(np.linalg.norm(gravity))
        self.lines += [f"*STEP, INC={most}", "*DYNAMIC, EXPLICIT",
                       f"{exact(time)}, {exact(time)}, {exact(1e-6 * time)}",
                       "*DLOAD", "EALL, GRAV, " + ", ".join(exact(x) for x in [size, *np.divide(gravity, size)]),
                       f"*NODE PRINT, NSET=NALL, FREQUENCY={most}", "U", "*END STEP"]

    def text(self):
        return "\n".join(["*HEADING", self.title, *self.lines]) + "\n"

    def run(self, threads=1, timeout=3600, folder=None):
        """Runs in `folder`, or in one that is removed afterwards."""
        if folder is None:
            with tempfile.TemporaryDirectory() as made:
                return run_job(Path(made), self.text(), self.title, threads, timeout)
        Path(folder).mkdir(parents=True, exist_ok=True)
        return run_job(Path(folder), self.text(), self.title, threads, timeout)


class Result:
    """Results of the last increment: displacement {node: [3]}; stress {element: [points, 6]}, xx yy zz xy xz yz at the
    integration points; and the log, the seconds of wall, and the increment of an explicit step, if there is one."""

    def __init__(self, folder, log, seconds):
        self.log, self.seconds = log, seconds
        self.displacement, self.stress = read_dat(folder / "job.dat")
        increment = re.search(r"COURANT initial stable time increment:\s*(\S+)", log)
        self.increment = float(increment.group(1)) if increment else None


def run_job(folder, text, title, threads, timeout):
    version()
    (folder / "job.inp").write_text(text)
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads), "CCX_NPROC_RESULTS": str(threads),
                   "CCX_NPROC_STIFFNESS": str(threads), "CCX_NPROC_EQUATION_SOLVER": str(threads)}
    begin = time.monotonic()
    try:
        done = subprocess.run([PROGRAM, "-i", "job"], cwd=folder, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=timeout, check=False, errors="replace")
    except subprocess.TimeoutExpired as error:
        raise CalculixError(f"{title}: {PROGRAM} took longer than {timeout} s") from error
    seconds = time.monotonic() - begin
    # The program returns 0 after some errors too.
    if done.returncode != 0 or "*ERROR" in done.stdout or "Job finished" not in done.stdout:
        raise CalculixError(f"{title}: {PROGRAM} failed (exit code {done.returncode}):\n{done.stdout[-2000:]}")
    return Result(folder, done.stdout, seconds)


def read_dat(path):
    """Displacements and stresses of the last blocks of a .dat file; {} for missing ones."""
    displacement, stress, reading = {}, {}, None
    if not path.exists():
        return displacement, stress
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            words = line.split()
            if not words:
                continue
            if words[0] == "displacements":
                displacement, reading = {}, "displacement"
            elif words[0] == "stresses":
                stress, reading = {}, "stress"
            elif not words[0].isdigit():
                reading = None
            elif reading == "displacement" and len(words) == 4:
                displacement[int(words[0]) - 1] = np.array([float(x) for x in words[1:]])
            elif reading == "stress" and len(words) == 8:
                stress.setdefault(int(words[0]) - 1, []).append([float(x) for x in words[2:]])
    return displacement, {e: np.array(rows) for e, rows in stress.items()}
