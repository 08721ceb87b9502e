"""The page docs/evidence/calibration.md: its sections and their order. Every study writes its own sections and leaves the others as they are."""
import sys

import study
from sections import Page

NAMES = ("published", "rocks", "synthetic", "coverage", "cost", "kills", "targets")
HEAD = """# Calibration: how right, how sure, how robust

Written by `validate/calibration_*.py`; do not edit. Each section names the command that measures it. The command and its file of
targets: [../calibrate.md](../calibrate.md).

"""
PAGE = Page(study.ROOT / "docs" / "evidence" / "calibration.md", study.RUNS / "calibration" / "sections", HEAD, "validate/calibration_statistics.py")


def named(arguments, sections):
    """Returns the sections named by the arguments of a study, all of them if none is named; numbers and options are
    skipped."""
    names = [one for one in arguments if not one.startswith("--") and not one.isdigit()] or list(sections)
    if set(names) - set(sections):
        sys.exit(f"expected some of {', '.join(sections)}, found {' '.join(names)}; --help says what they do")
    return names


def put(name, title, text):
    """Keeps a section and writes the page."""
    PAGE.keep(name, f"## {title}\n\n{text.strip()}")
    write()


def write():
    """Writes the page with the sections that were measured, here or elsewhere."""
    PAGE.write([name for name in NAMES if PAGE.kept(name) or PAGE.there(name)])
