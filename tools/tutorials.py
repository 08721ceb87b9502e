#!/usr/bin/python3
"""Runs a tutorial: writes the files that its page shows, and calls the commands in their order.

tutorials.py PAGE FOLDER    prints what each command says; programs come from PATH

In a page a block `yaml`, `python` or `bash` whose first line is a comment with a file name is that file, a block `sh` holds commands, and
a block `text` holds lines that the commands before it print. A line `...` in it stands for lines that are left out, and `...` at the end of
a line for the rest of that line.
"""
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

FENCE = re.compile(r"```(\w+)\n(.*?)```", re.S)
FILE = re.compile(r"(?:#!.*\n)?# ([\w.-]+\.\w+)(?::.*)?\n")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


class Block(NamedTuple):
    kind: str   # file, commands, output
    name: str   # of a file
    text: str
    line: int   # in the page, base 1


def blocks(page):
    """Blocks of a page in their order; YAML and Python without a file name are excerpts and left out."""
    text = Path(page).read_text()
    for found in FENCE.finditer(text):
        line = text.count("\n", 0, found.start(2)) + 1
        language, content = found.groups()
        name = FILE.match(content)
        if language in ("yaml", "python", "bash") and name:
            yield Block("file", name.group(1), content, line)
        elif language == "sh":
            yield Block("commands", "", content, line)
        elif language == "text":
            yield Block("output", "", content, line)


def run(page, folder, change=lambda text: text, environment=None, timeout=120):
    """Yields (block, printed) of every block of commands, with the shown lines that follow it as second block or None."""
    waiting = None
    for block in [*blocks(page), None]:
        if waiting and (block is None or block.kind != "file"):
            shown = block if block and block.kind == "output" else None
            yield waiting[0], waiting[1], shown
            waiting = None
        if block and block.kind == "file":
            (Path(folder) / block.name).write_text(change(block.text))
        elif block and block.kind == "commands":
            commands = change(block.text)
            if not commands:
                continue
            done = subprocess.run(["sh", "-e", "-c", commands], cwd=folder, env={**os.environ, **(environment or {})}, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=timeout)
            if done.returncode:
                raise RuntimeError(f"{page}:{block.line}: exit code {done.returncode}: {done.stdout[-1500:]}")
            waiting = block, done.stdout


def words_and_numbers(line):
    """The words of a line with # for every number, and the numbers."""
    return NUMBER.sub("#", " ".join(line.split())), [float(number) for number in NUMBER.findall(line)]


def alike(shown, printed, tolerance):
    """True where both lines have the same words, and numbers that agree within the tolerance (None: any numbers).

    Seconds are those of a machine, and numbers below 1e-3 may be errors of rounding: of these two any will do."""
    (a, numbers), (b, others) = words_and_numbers(shown.removesuffix("...")), words_and_numbers(printed)
    if a != b and not (shown.endswith("...") and b.startswith(a)):
        return False
    if tolerance is None or re.search(r"\bseconds\b|# s\b", a):
        return True
    return all(abs(x - y) <= tolerance * max(abs(x), abs(y)) or max(abs(x), abs(y)) < 1e-3 for x, y in zip(numbers, others))


def missing(shown, printed, tolerance=0.01):
    """Lines of the page that no line of the output is like, searched for in their order."""
    lines, absent = iter(printed.splitlines()), []
    for line in shown.splitlines():
        if line.strip() in ("", "..."):
            continue
        if not any(alike(line, other, tolerance) for other in lines):
            absent.append(line)
            lines = iter(printed.splitlines())
    return absent


def main():
    for block, printed, shown in run(Path(sys.argv[1]).resolve(), sys.argv[2]):
        print(f"--- {block.line}\n{block.text}--- prints\n{printed}", flush=True)
        for line in missing(shown.text, printed) if shown else []:
            print(f"*** {sys.argv[1]}:{shown.line}: not printed: {line}", flush=True)


if __name__ == "__main__":
    main()
