"""Exceptions, with the message of gneiss and the place of the error in the file."""
from __future__ import annotations

import re
from typing import Any, NamedTuple

from ._library import ffi, lib, text

_PLACE = re.compile(r"(?P<file>[^\n]*?):(?P<line>\d+):(?P<column>\d+): (?:(?P<key>[\w.\[\]-]+): )?(?P<message>.*)", re.S)
_OVERRIDE = re.compile(r"--set (?P<key>[\w.\[\]-]+): (?P<message>.*)", re.S)


class Problem(NamedTuple):
    """One problem of an input: `file`, `line` and `column` (base 1) of its place, the `key`, and the `message`. Without a place the
    file and the key are '' and the numbers 0."""
    file: str
    line: int
    column: int
    key: str
    message: str


class GneissError(Exception):
    """Base of all errors of gneiss. `status`: the exit code that the program would have; `problems`: one for each line of the message;
    `file`, `line`, `column`, `key`: of the first."""
    status = 1

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.problems = _problems(message)
        first = self.problems[0]
        self.file, self.line, self.column, self.key = first.file, first.line, first.column, first.key


class InputError(GneissError, ValueError):
    """An invalid scene, specimen, checkpoint or argument."""
    status = 2


class FileError(GneissError, OSError):
    """A file could not be read or written."""
    status = 3


class OutOfMemory(GneissError, MemoryError):
    """There was not enough memory."""
    status = 4


class Unstable(GneissError, ArithmeticError):
    """The run became invalid: the world can be read, but not advanced."""
    status = 5


class Interrupted(GneissError):
    """The program was stopped by a signal; a checkpoint was written if the run had begun."""
    status = 6


_BY_STATUS = {error.status: error for error in (GneissError, InputError, FileError, OutOfMemory, Unstable, Interrupted)}


def _problems(message: str) -> list[Problem]:
    found: list[Problem] = []
    for line in str(message).splitlines() or [""]:
        place = _PLACE.fullmatch(line)
        if place:
            found.append(Problem(place["file"], int(place["line"]), int(place["column"]), place["key"] or "", place["message"]))
        elif change := _OVERRIDE.fullmatch(line):
            found.append(Problem("--set", 0, 0, change["key"], change["message"]))
        elif found and line.startswith(" "):
            found[-1] = found[-1]._replace(message=found[-1].message + "\n" + line)
        else:
            found.append(Problem("", 0, 0, "", line))
    return found


def error_of(status: int, message: str) -> GneissError:
    """The exception for a status, which is also the exit code of the program."""
    return _BY_STATUS.get(status, GneissError)(message)


def error_at(key: str, message: str) -> InputError:
    """The exception for a value that is refused before a text of the scene exists, and thus has no place."""
    error = InputError(f"{key}: {message}" if key else message)
    error.problems, error.key = [Problem("", 0, 0, key, message)], key
    return error


def checked(function: Any, *arguments: Any) -> None:
    """Calls a function of the library with an error added to its arguments. Raises the error that it reports."""
    error = ffi.new("gneiss_error *")
    status = function(*arguments, error)
    if status != lib.GNEISS_OK:
        raise error_of(status, text(error.message))
