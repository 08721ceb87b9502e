"""Shared by the studies: runs of the program, kept and reused, and tables between markers of a document.

A run goes to runs/studies/<name>. It is repeated if its settings have changed, if it is missing, or with --fresh. The program is build/gneiss, or the
one that the environment variable GNEISS names. With --kept nothing is run: tables have the rows whose runs exist, and name the others. """
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "tools"))
from wrap import prose  # noqa: E402
RUNS = Path(os.environ.get("GNEISS_STUDIES", ROOT / "runs" / "studies"))
PROGRAM = os.environ.get("GNEISS", str(ROOT / "build" / "gneiss"))
LIBRARY = os.environ.get("GNEISS_LIBRARY", str(ROOT / "build" / "libgneiss.so"))
THREADS = int(os.environ.get("GNEISS_THREADS", "2"))
FRESH = "--fresh" in sys.argv
KEPT = "--kept" in sys.argv
ROCK = "scenes/ucs-rock.yaml"


def reported(arguments, text, flags):
    """Ends the program with the text if help is requested, with a message if a flag is unknown."""
    if {"-h", "--help"} & set(arguments):
        print(text.strip())
        sys.exit(0)
    unknown = [argument for argument in arguments if argument.startswith("-") and argument not in flags]
    if unknown:
        sys.exit(f"expected some of {', '.join(flags)}, found {' '.join(unknown)}; --help says what they do")


def call(arguments):
    """Calls the program from the root of the project; the finished process, whatever its exit code."""
    environment = dict(os.environ, OMP_WAIT_POLICY=os.environ.get("OMP_WAIT_POLICY", "passive"))
    return subprocess.run([PROGRAM, *arguments], cwd=ROOT, env=environment, text=True, capture_output=True)


def set_arguments(settings):
    arguments = []
    for key, value in settings.items():
        arguments += ["--set", f"{key}={value}"]
    return arguments


class Missing(Exception):
    """A run is missing, with --kept."""


def if_there(make, *arguments, **named):
    """The result of make(...); None if a run that it needs is missing (with --kept)."""
    try:
        return make(*arguments, **named)
    except Missing as gone:
        print(f"not there: {gone}", file=sys.stderr)
        return None


def kept(path, make):
    """Returns the result of make(), stored as JSON in a file when it is first made; the file is there in full or not at all."""
    if not path.exists():
        if KEPT:
            raise Missing(path.name)
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(path.name + ".part")
        part.write_text(json.dumps(make()))
        part.replace(path)
    return json.loads(path.read_text())


def not_run(names):
    """A line below a table on the rows that it lacks; nothing if it lacks none."""
    names = list(names)
    return f"\nNot run: {'; '.join(names)}." if names else ""


class Run:
    """A finished run: summary, exit code, folder; history(column) reads results.h5."""

    def __init__(self, folder, record):
        self.folder, self.code, self.message = folder, record["code"], record["message"]
        path = folder / "summary.json"
        self.summary = json.loads(path.read_text()) if path.exists() else {}

    def __getattr__(self, name):
        readings = self.summary.get("readings", {})
        if name in readings:
            return float("nan") if readings[name] is None else readings[name]
        raise AttributeError(name)

    def results(self, path):
        import h5py

        with h5py.File(self.folder / "results.h5", "r") as file:
            return np.asarray(file[path][()])

    @property
    def bonds(self):
        return self.summary["counts"]["bonds"]

    @property
    def broken(self):
        return self.summary["counts"]["broken_tension"], self.summary["counts"]["broken_shear"]

    @property
    def residual(self):
        return self.summary["energy_residual"]

    @property
    def worst_residual(self):
        """Largest residual while the work done was at least 1 % of its end value."""
        history = self.results("history/energy_residual")
        work = np.abs(self.results("history/energy_work_walls"))
        late = work > 0.01 * work[-1]
        return float(np.max(np.abs(history[late]))) if late.any() else float("nan")

    @property
    def seconds(self):
        return self.summary["seconds"]["total"]


def run(name, scene, settings, must_finish=True):
    folder = RUNS / name
    settings = {"output.snapshots": 0, "output.checkpoint": "off", "run.threads": THREADS, **settings}
    asked = {"scene": str(scene), "text": (ROOT / scene).read_text(), "settings": settings}
    asked = json.loads(json.dumps(asked, default=str))
    note = folder / "study.json"
    if not FRESH and note.exists():
        record = json.loads(note.read_text())
        if record["asked"] == asked and record["code"] in (0, 5):
            return Run(folder, record)
    if KEPT:
        raise Missing(name)
    shutil.rmtree(folder, ignore_errors=True)
    done = call(["run", str(scene), "--quiet", "--out", str(folder), *set_arguments(settings)])
    if must_finish and done.returncode != 0:
        sys.exit(f"{name}: exit code {done.returncode}\n{done.stderr}")
    record = {"asked": asked, "code": done.returncode, "message": done.stderr.strip()}
    folder.mkdir(parents=True, exist_ok=True)
    note.write_text(json.dumps(record))
    result = Run(folder, record)
    print(f"{name}: exit code {done.returncode}", file=sys.stderr, flush=True)
    return result


def limits(scene, settings=None):
    """Step limits in s as `gneiss plan` prints them: sharp, bound, literature."""
    done = call(["plan", str(scene), "--threads", str(THREADS), *set_arguments(settings or {})])
    if done.returncode != 0:
        sys.exit(f"plan {scene}: exit code {done.returncode}\n{done.stderr}")
    found = {}
    for key, label in (("sharp", "sharp limit"), ("bound", "rigorous bound"), ("literature", "literature")):
        found[key] = float(re.search(rf"{label}\s+(\S+) s", done.stdout).group(1))
    return found


def closing(total):
    """Settings for platens of scenes/ucs-rock.yaml that close with `total` m/s together."""
    return {"walls.bottom.motion.vz": total / 2, "walls.top.motion.vz": -total / 2, "time.end": 6e-3 * 0.2 / total}


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


def put(document, name, text):
    """Replaces the text between <!-- name --> and <!-- /name --> in a page of docs/evidence."""
    path = ROOT / "docs" / "evidence" / document
    whole = path.read_text() if path.exists() else ""
    pattern = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.S)
    if not pattern.search(whole):
        print(f"docs/evidence/{document} has no place for {name}:\n{text}\n")
        return
    path.write_text(pattern.sub(lambda m: m.group(1) + prose(text.rstrip()) + "\n" + m.group(2), whole))


def put_table(document, name, head, rows, quick, missing=()):
    """Prints a table, with the names of rows that are missing, and, unless quick, puts it into the page."""
    text = "\n".join(([table(head, rows)] if rows else []) + ([not_run(missing)] if missing else [])).strip()
    print(f"{name}\n{text}\n", flush=True)
    if not quick:
        put(document, name, text)


def save(figure, folder, name):
    """The figure as a PNG in the folder; closes it."""
    import matplotlib.pyplot as plt

    figure.tight_layout()
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.png", dpi=100)
    plt.close(figure)


def section(document, title, text):
    """Replaces the text under `## title` in a page of docs/evidence, or puts it at its end."""
    path = ROOT / "docs" / "evidence" / document
    whole = path.read_text()
    head, found, rest = whole.partition(f"## {title}\n\n")
    rest = rest[rest.index("\n## ") + 1:] if "\n## " in rest else ""
    path.write_text(head.rstrip() + f"\n\n## {title}\n\n{prose(text.rstrip())}\n" + ("\n" + rest if rest else ""))
