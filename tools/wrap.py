"""Wraps the prose of Markdown pages: paragraphs with a line above 160 characters get lines of at most 150.

    wrap.py PATH ...    wraps these files in place

Tables, code, headings, comments and pictures stay as they are. Programs that write pages call `prose`.
"""
import re
import sys
from pathlib import Path

WIDTH, FILLED = 160, 150
ITEM = re.compile(r" *(?:[-*+]|\d+[.)]) +")
# Lines that belong to no paragraph: blank, headings, tables, comments, quotes, pictures, fences.
APART = re.compile(r"\s*$|#|\s*\||\s*<!--|\s*>|!\[|\s*```")
# Words that would begin a list, a heading or a table at the start of a line.
STICKS = re.compile(r"(?:[-+*=#|>]+|\d+[.)])$")


def filled(lines):
    """The lines of one paragraph or item, at most FILLED characters each where words allow it."""
    item = ITEM.match(lines[0])
    first = item.group() if item else re.match(r" *", lines[0]).group()
    rest = " " * len(first)
    text = " ".join(line.strip() for line in [lines[0][len(first):], *lines[1:]])
    # Code keeps its blanks: they are masked while the text is split into words.
    text = re.sub(r"`[^`]*`", lambda code: code.group().replace(" ", "\0"), text)
    out, now = [], first
    for word in text.split():
        if len(now) + len(word) < FILLED or now.strip() == first.strip() or STICKS.match(word):
            now += ("" if now in (first, rest) else " ") + word
        else:
            out.append(now)
            now = rest + word
    return [line.replace("\0", " ") for line in [*out, now]]


def prose(text):
    """The text with its long paragraphs wrapped."""
    out, block, fenced = [], [], False

    def end():
        out.extend(filled(block) if any(len(line) > WIDTH for line in block) else block)
        block.clear()

    for line in text.split("\n"):
        code = fenced or (not block and line.startswith("    ") and not ITEM.match(line))
        if line.lstrip().startswith("```"):
            fenced = not fenced
        if code or APART.match(line):
            end()
            out.append(line)
            continue
        if ITEM.match(line):
            end()
        block.append(line)
    end()
    return "\n".join(out)


if __name__ == "__main__":
    for path in map(Path, sys.argv[1:]):
        path.write_text(prose(path.read_text(encoding="utf-8")), encoding="utf-8")
