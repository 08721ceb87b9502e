"""A text file with positions, for messages that name file, line and column."""
import re

import numpy as np

from calibrate.problem import Problem

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
SHOWN = 40  # characters of a field that a message shows


class Source:
    """Lines of a file. Lines and columns are counted from 0 here and from 1 in messages."""

    def __init__(self, path, content):
        self.path = path
        if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
            raise Problem(f"{path}:1:1: expected plain text, found UTF-16")
        if b"\0" in content:
            before = content[:content.index(b"\0")]
            raise Problem(f"{path}:{before.count(10) + 1}:{len(before) - before.rfind(10)}: expected text, found a zero byte")
        self.text = content.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
        self.lines = self.text.split("\n")
        if self.lines[-1] == "":
            self.lines.pop()

    def refuse(self, line, column, text):
        """An error at a place in the file, to be raised."""
        return Problem(f"{self.path}:{line + 1}:{column + 1}: {text}")

    def line(self, number, expected):
        """Text of a line; refused behind the end of the file."""
        if number >= len(self.lines):
            raise self.refuse(len(self.lines), 0, f"expected {expected}, found the end of the file (cut short?)")
        return self.lines[number]

    def count(self, number, expected, most=None):
        """The whole number >= 0 with which a line begins; `most`: what the rest of the file has room for."""
        text = self.line(number, expected)
        found = re.match(r"\s*(\d{1,15})(?=\s|$)", text)
        if not found:
            raise self.refuse(number, len(text) - len(text.lstrip()), f"expected {expected}, found '{text.strip()[:SHOWN]}'")
        value = int(found[1])
        if most is not None and value > most:
            raise self.refuse(number, found.start(1), f"expected at most {most} ({expected}; the rest of the file), found {value}")
        return value

    def fields(self, number):
        """[(column, text)] of the fields of a line, which blanks or commas separate; quotes hold a field together."""
        return [(found.start(), found[0]) for found in re.finditer(r'"[^"]*"|[^\s,]+', self.lines[number])]

    def number(self, line, column, text, name):
        """A finite number of a field."""
        if NUMBER.fullmatch(text):
            value = float(text)
            if np.isfinite(value):
                return value
        raise self.refuse(line, column, f"expected a finite number ({name}), found '{text[:SHOWN]}'")

    def table(self, rows, names):
        """[len(rows)][columns] numbers of lines with the fields `names`; further fields of a line are refused. Lines are numbers."""
        split = [self.lines[k].split() for k in rows]
        try:
            if not all(len(row) == len(names) for row in split):
                raise ValueError
            table = np.array(split, float).reshape(len(split), len(names))
            if not np.all(np.isfinite(table)) or any("_" in self.lines[k] for k in rows):
                raise ValueError
            return table
        except ValueError:
            return np.array([self._row(k, names) for k in rows], float).reshape(len(split), len(names))

    def _row(self, line, names):
        fields = self.fields(line)
        if len(fields) != len(names):
            at = fields[len(names)][0] if len(fields) > len(names) else len(self.lines[line])
            raise self.refuse(line, at, f"expected {len(names)} columns ({' '.join(names)}), found {len(fields)}")
        return [self.number(line, column, text, name) for (column, text), name in zip(fields, names)]
