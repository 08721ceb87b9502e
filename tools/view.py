#!/usr/bin/python3
"""view.py [--instants N] [--fields NAME,...] [--paraview] OUTDIR: reads results.h5 and the snapshots of OUTDIR and writes
OUTDIR/view.html, one file in which the run turns and moves in a browser with WebGL 2; with --paraview OUTDIR/paraview_state.py and
OUTDIR/run.vtkhdf instead.

Exit codes: 0 done, 2 there is nothing that can be read, 3 a file may not be read or cannot be written.
"""
import argparse
import base64
import json
import os
import re
import sys

from report_files import FileFault, Unreadable, printable, write
from report_page import escape
from view_data import NoResults, Vanished, View, results_of
from view_paraview import write_one_file, write_script

HERE = os.path.dirname(os.path.abspath(__file__))
INSTANTS = 20  # most snapshots of a page, unless an option gives another number
FEW = 5  # instants that give the ranges of colours
TRIES = 3  # a run that goes on may remove snapshots while they are read
NOTE = "results.h5 is written at the first checkpoint; until then the page has the snapshots alone, without curves, walls and the title of the scene"
SCRIPTS = ("view_data.js", "view_gl.js", "view.js")


def source(name):
    with open(os.path.join(HERE, name), encoding="utf-8") as file:
        return file.read()


def counts(view):
    """Returns "1 500 particles, 6 881 bonds, 17 instants"."""
    parts = [(view.meta["particles"]["count"], "particles"), (view.meta["bonds"]["count"], "bonds"), (len(view.steps), "instants")]
    return ", ".join(f"{count:,} {name}".replace(",", " ") for count, name in parts if count)


def page(view, subtitle):
    outside = view.meta["particles"].get("outside", 0)
    notes = [f" {outside} particles that flew far away are not shown."] if outside else []
    notes += [f" {NOTE}."] if isinstance(view.results, NoResults) else []
    parts = {
        "title": escape(view.meta["title"]), "subtitle": escape(subtitle),
        "note": "".join(notes),
        "meta": json.dumps(view.meta, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"),
        "data": base64.b64encode(view.pack.compressed()).decode("ascii"),
        "script": "\n".join(source(name) for name in SCRIPTS),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda mark: parts[mark[1]], source("view.html"))


def number_of(text):
    """The number of instants that an option gives."""
    if not text.isdecimal() or int(text) < 2:
        raise Unreadable(f"--instants: expected a whole number from 2, found '{text}'")
    return int(text)


def fields_of(text):
    """The names that an option gives; none where it is not given."""
    names = [] if text is None else [name.strip() for name in text.split(",")]
    if not all(names):
        raise Unreadable(f"--fields: expected names separated by commas, found an empty name in '{text}'")
    return names


def written(target, writing, *arguments):
    """Calls a function that writes the target and returns the path; the reason why it cannot does not name a temporary file."""
    try:
        writing(*arguments)
    except OSError as e:
        raise FileFault(f"{target}: cannot be written: {os.strerror(e.errno) if e.errno else e}") from None
    return target


def write_paraview(folder, results):
    """Writes paraview_state.py and run.vtkhdf; returns their paths."""
    script, data = (os.path.join(folder, name) for name in ("paraview_state.py", "run.vtkhdf"))
    return [written(script, write_script, View(results, folder, FEW), folder, script), written(data, write_one_file, folder, data)]


def write_view(folder, results, instants, fields):
    view = View(results, folder, instants, fields)
    version, reason = (results.attribute(name) for name in ("version", "stop_reason"))
    subtitle = " · ".join(filter(None, (version and f"gneiss {version}", counts(view), reason)))
    target = os.path.join(folder, "view.html")
    return [written(target, write, target, page(view, subtitle))]


def write_all(given):
    """Writes what the options ask for; returns the paths. The list of snapshots is read again if one of them is gone meanwhile."""
    for name in ("instants", "fields"):
        if given.paraview and getattr(given, name) is not None:
            raise Unreadable(f"--{name}: --paraview writes every instant and every field, of which ParaView shows what is chosen there; expected one of them, found both")
    instants, fields = INSTANTS if given.instants is None else number_of(given.instants), fields_of(given.fields)
    for left in reversed(range(TRIES)):
        try:
            results = results_of(given.folder)
            paths = write_paraview(given.folder, results) if given.paraview else write_view(given.folder, results, instants, fields)
            if isinstance(results, NoResults):
                print(f"gneiss: note: {NOTE}", file=sys.stderr)
            return paths
        except Vanished as e:
            if not left:
                raise Unreadable(str(e)) from None


def main(arguments):
    parser = argparse.ArgumentParser(prog="view.py", usage="view.py [--instants N] [--fields NAME,...] [--paraview] OUTDIR (the output folder of a run)")
    parser.add_argument("--instants")
    parser.add_argument("--fields")
    parser.add_argument("--paraview", action="store_true")
    parser.add_argument("folder")
    given = parser.parse_args(arguments)
    try:
        print(printable("\n".join(write_all(given))))
    except Unreadable as e:
        print(printable(f"gneiss: input error: {e}"), file=sys.stderr)
        return 2
    except FileFault as e:
        print(printable(f"gneiss: file error: {e}"), file=sys.stderr)
        return 3
    except OSError as e:
        print(printable(f"gneiss: file error: {e.filename or given.folder}: {e.strerror or e}"), file=sys.stderr)
        return 3
    except Exception as e:  # A foreign file can hold anything: it is refused without a traceback.
        print(printable(f"gneiss: input error: {given.folder}: the run cannot be shown: {type(e).__name__}: {e}"), file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
