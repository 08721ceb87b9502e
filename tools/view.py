#!/usr/bin/python3
"""view.py [--instants N] [--fields NAME,...] [--paraview] OUTDIR: reads results.h5 and the snapshots of OUTDIR and writes
OUTDIR/view.html, one file in which the run turns and moves in a browser with WebGL 2; with --paraview OUTDIR/paraview_state.py and
OUTDIR/run.vtkhdf instead.

Exit codes: 0 done, 2 there is nothing that can be read, 3 the page cannot be written.
"""
import argparse
import base64
import json
import os
import re
import sys

import report_plain  # noqa: F401  (matplotlib may be missing)
from report_files import Unreadable, printable, write
from report_page import escape
from report_results import Results
from view_data import View
from view_paraview import write_one_file, write_script

HERE = os.path.dirname(os.path.abspath(__file__))
FEW = 5  # instants that give the ranges of colours
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
    parts = {
        "title": escape(view.meta["title"]), "subtitle": escape(subtitle),
        "note": f" {outside} particles that flew far away are not shown." if outside else "",
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


def write_paraview(folder):
    """Writes paraview_state.py and run.vtkhdf; returns the path of the first."""
    target = os.path.join(folder, "paraview_state.py")
    write_script(View(Results(os.path.join(folder, "results.h5")), folder, FEW), folder, target)
    write_one_file(folder, os.path.join(folder, "run.vtkhdf"))
    return target


def write_view(folder, instants, fields):
    view = View(Results(os.path.join(folder, "results.h5")), folder, instants, fields)
    subtitle = f"gneiss {view.results.attribute('version')} · {counts(view)} · {view.results.attribute('stop_reason')}"
    target = os.path.join(folder, "view.html")
    write(target, page(view, subtitle))
    return target


def main(arguments):
    parser = argparse.ArgumentParser(prog="view.py", usage="view.py [--instants N] [--fields NAME,...] [--paraview] OUTDIR (the output folder of a run)")
    parser.add_argument("--instants", default="20")
    parser.add_argument("--fields", default="")
    parser.add_argument("--paraview", action="store_true")
    parser.add_argument("folder")
    given = parser.parse_args(arguments)
    try:
        print(printable(write_paraview(given.folder) if given.paraview else write_view(given.folder, number_of(given.instants), [name for name in given.fields.split(",") if name])))
    except Unreadable as e:
        print(printable(f"gneiss: input error: {e}"), file=sys.stderr)
        return 2
    except OSError as e:
        print(printable(f"gneiss: file error: the page cannot be written: {e}"), file=sys.stderr)
        return 3
    except Exception as e:  # A foreign file can hold anything: it is refused without a traceback.
        print(printable(f"gneiss: input error: {given.folder}: the run cannot be shown: {type(e).__name__}: {e}"), file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
