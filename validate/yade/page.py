"""Shared by the sections of docs/evidence/validation.md: tables, pictures, versions, and sections kept between runs."""
import datetime
import os
import platform
import re
import subprocess

import numpy as np

import jobs
import own
import sections
import study

PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
SECTIONS = jobs.RUNS / "sections"


def table(head, rows):
    return study.table(head, rows)


def percent(a, b):
    """a over b, as a signed difference in per cent."""
    return f"{100 * (a / b - 1):+.2g}" if b else "-"


def figures():
    """matplotlib, without a screen."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"font.size": 8, "axes.grid": True, "grid.alpha": 0.3, "lines.linewidth": 1.1})
    return plt


def save(figure, name, docs=True):
    folder = PICTURES if docs else jobs.RUNS / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    figure.tight_layout()
    figure.savefig(folder / f"validation-{name}.png", dpi=100, metadata={"Software": None})
    figure.clf()
    return f"![{name}](pictures/validation-{name}.png)"


def yade_version():
    done = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", "yade"], capture_output=True, text=True, check=False)
    return done.stdout or "of unknown version"


def processor():
    try:
        text = open("/proc/cpuinfo", encoding="utf-8").read()
        return re.search(r"model name\s*:\s*(.*)", text).group(1)
    except (OSError, AttributeError):
        return platform.processor() or "unknown processor"


def conditions():
    lib = own.library()
    return (f"{datetime.date.today()}; gneiss {lib.gneiss_version().decode()} ({lib.gneiss_build().decode()}); YADE "
            f"{yade_version()}; {processor()}, {os.cpu_count()} threads")


def page(head=""):
    return sections.Page(study.ROOT / "docs" / "evidence" / "validation.md", SECTIONS, head, "./do validate --only")


def keep(name, text):
    page().keep(name, f"{text.rstrip()}\n\nMeasured {conditions()}.")


def spread(values):
    """Coefficient of variation of a sample, per cent."""
    values = np.asarray(values)
    return 100 * values.std(ddof=1) / values.mean()
