"""The cost of accuracy in time; writes docs/evidence/accuracy.md, its pictures, and validate/accuracy/slopes.csv and base.csv,
which `gneiss plan --error` and the error budget of runs are compiled from.

    ./do accuracy                everything; what is kept in runs/accuracy is not run again: an hour of one core
    ./do accuracy --quick        the same on coarse models, into runs/accuracy-quick: a minute or two
    ./do accuracy --only CASE    some cases, then the page
  --out DIR  runs, page and slopes into this folder

Runs are kept by `gneiss sweep` under the hash of their scene and the version of the program: to measure another build, remove the folder.
"""
import datetime
import platform
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import base  # noqa: E402
import machinery  # noqa: E402
import overview  # noqa: E402
import slopes  # noqa: E402
import study  # noqa: E402
import words  # noqa: E402
from sections import Page  # noqa: E402

HEAD = """# What accuracy costs

Written by `./do accuracy` (`validate/accuracy/`); do not edit. Every time is in **CPU seconds of one thread**, packing included where
packings are varied, and the start of the program (0.02 s): wall times of a shared machine are not
comparable. Each section states when and with what it was measured. The section on [concrete](#concrete-under-pressure), whose bonds soften and yield, is written by
`validate/concrete_effects.py`.

"""
ELSEWHERE = ("concrete",)  # sections that other studies write, between those of the cases and the slopes


def cases():
    import bed
    import block
    import brazilian
    import cantilever
    import collision
    import coupled
    import cylinder
    import hopper
    import notched
    import packing
    import wave

    return {"compression": lambda s, p: cylinder.section(s, p, "compression"),
            "tension": lambda s, p: cylinder.section(s, p, "tension"), "compression-plane": block.section,
            "collision": collision.section, "wave": wave.section,
            "cantilever": cantilever.section, "bed": bed.section, "hopper": hopper.section, "notched": notched.section,
            "notched-elements": notched.elements_section, "coupled": coupled.section, "brazilian": brazilian.section, "packing": packing.section}


def page_at(path, folder):
    return Page(path, folder / "sections", HEAD, "./do accuracy --only")


def write(page):
    page.write(["overview", *cases(), *(name for name in ELSEWHERE if page.kept(name) or page.there(name)), "slopes"])


def put_elsewhere(name, text):
    """A section of the page that another study has measured."""
    page = page_at(study.ROOT / "docs" / "evidence" / "accuracy.md", study.ROOT / "runs" / "accuracy")
    page.keep(name, text)
    write(page)


def conditions(s, case):
    rows = {row.folder: row for name, row in s.rows if name == case and row.done}.values()
    said = study.call(["info"]).stdout
    version = re.search(r"^gneiss +(\S+)", said, re.M)
    try:
        processor = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text(encoding="utf-8")).group(1)
    except (OSError, AttributeError):
        processor = platform.processor() or "unknown processor"
    return (f"Measured {datetime.date.today()}, gneiss {version.group(1) if version else 'of unknown version'}, {processor}, one thread; {len(rows)} "
            f"runs, {sum(row.seconds for row in rows):.0f} CPU seconds" + (", quick form." if s.quick else "."))


def option(arguments, name):
    return arguments[arguments.index(name) + 1] if name in arguments and arguments.index(name) + 1 < len(arguments) else None


def wanted_cases(arguments, known):
    if "--only" not in arguments:
        return list(known)
    wanted = []
    for name in arguments[arguments.index("--only") + 1:]:
        if name.startswith("--"):
            break
        wanted.append(name)
    if not wanted or set(wanted) - set(known):
        sys.exit(f"accuracy: --only expects some of {', '.join(known)}, found {' '.join(wanted) or 'nothing'}")
    return wanted


def places(arguments, quick):
    """Folder of the runs, the page, the folder of the pictures and the link to it, the slopes."""
    out = option(arguments, "--out")
    folder = Path(out).resolve() if out else study.ROOT / "runs" / ("accuracy-quick" if quick else "accuracy")
    if out or quick:
        return folder, folder / "accuracy.md", folder / "pictures", folder / "slopes.csv"
    docs = study.ROOT / "docs" / "evidence"
    return folder, docs / "accuracy.md", docs / "pictures", HERE / "slopes.csv"


def main(arguments):
    study.reported(arguments, __doc__, ("--quick", "--only", "--out"))
    quick, known = "--quick" in arguments, cases()
    wanted = wanted_cases(arguments, known)
    folder, path, pictures, table = places(arguments, quick)
    folder.mkdir(parents=True, exist_ok=True)
    s, p = machinery.Study(folder, quick), words.Pictures(pictures, "pictures")
    page = page_at(path, folder)
    measured, found = [], {}
    for name in wanted:
        text, found[name] = known[name](s, p)
        page.keep(name, f"{text}\n\n{conditions(s, name)}")
        measured += found[name].slopes.rows
        slopes.write(table, measured, known)
    if {"compression", "tension"} <= set(wanted) and not quick:
        base.measure(s, table.with_name("base.csv"))
    if {"compression", "tension"} <= set(wanted):
        page.keep("overview", overview.section(p, [found["compression"], found["tension"]]))
    page.keep("slopes", overview.slopes_section(slopes.read(table)))
    write(page)


if __name__ == "__main__":
    main(sys.argv[1:])
