"""Writes gneiss/keys.py from the keys that the library lists: `/usr/bin/python3 python/make_keys.py [FILE]`."""
import keyword
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from gneiss._library import ffi, lib, text  # noqa: E402

HEAD = '''"""The keys of scene files as dicts that an editor completes and mypy checks. Written by python/make_keys.py; do not edit.

    scene = gneiss.keys.Scene(materials=[gneiss.keys.Material(name="rock", density="2600 kg/m3")], ...)

Each is an ordinary dict at run time, as gneiss.Scene takes it. docs/keys.md has the same list.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypedDict, Union

Number = Union[float, str]  # in SI, or a text with a unit
Vector = Sequence[Number]
Rows = Any  # rows of numbers, also as an array of numpy, or their number
Table = Union[float, str, Sequence[Sequence[Number]]]  # constant, [[time, value], ...], or a formula of t in a text
Tables = Sequence[Table]
'''
TYPES = {"number": "Number", "integer": "int | str", "text": "str", "vector": "Vector", "tables": "Tables", "spin": "Number | Vector", "table": "Table",
         "numbers": "Sequence[int]", "rows": "Rows", "names": "str | Sequence[str]", "tree": "Any"}


def keys():
    """(path, kind, value, fallback, word, text) of every key."""
    key, error, found = ffi.new("gneiss_key *"), ffi.new("gneiss_error *"), []
    while lib.gneiss_key_at(len(found), key, error) == lib.GNEISS_OK:
        found.append(tuple(text(part) for part in (key.path, key.kind, key.value, key.fallback, key.word, key.text)))
    return found


def class_of(path):
    """The name of the dict of a section: elements.motions[].box -> ElementsMotionBox."""
    words = []
    for step in path.split("."):
        name = step.removesuffix("[]")
        if step != name:
            name = name[:-3] + "y" if name.endswith("ies") else name.removesuffix("s")
        words += name.split("_")
    return "".join(word.capitalize() for word in words) or "Scene"


def type_of(path, kind, value, word):
    if kind == "section":
        return class_of(path) + (" | str" if word else "")
    if kind == "list":
        return f"Sequence[{class_of(path + '[]')}]"
    if kind == "choice":
        words = value.split(", ")
        return f"Literal[{', '.join(map(repr, words))}]" + (" | bool" if {"on", "true"} & set(words) else "")
    own = TYPES[kind]
    return own + " | str" if word and "str" not in own and own in ("Vector", "Rows") else own


def line_of(entry):
    path, kind, value, fallback, word, meaning = entry
    about = meaning if kind in ("section", "list", "choice", "tree") else f"{value}: {meaning}"
    return type_of(path, kind, value, word), about + (f" (default {fallback})" if fallback else "")


def section_text(name, entries, stage):
    """A class; names that Python reserves come from a dict of their own. Lists of a stage may also be dicts by name."""
    lines, reserved = [], []
    for entry in entries:
        key = entry[0].rsplit(".", 1)[-1]
        kind, about = line_of(entry)
        if stage and entry[1] == "list" and "." not in entry[0]:
            kind = f"{kind} | dict[str, {class_of(entry[0] + '[]')}]"
        (reserved if keyword.iskeyword(key) else lines).append((key, kind, about))
    base = "TypedDict"
    text_of = ""
    if reserved:
        base = f"_{name}"
        pairs = ", ".join(f"{key!r}: {kind!r}" for key, kind, _ in reserved)
        text_of = f"\n\n{base} = TypedDict({base!r}, {{{pairs}}}, total=False)"
    body = "".join(f"    {key}: {kind}  # {about}\n" for key, kind, about in lines) or "    pass\n"
    return f"{text_of}\n\nclass {name}({base}, total=False):\n{body}"


def module_text():
    found = keys()
    sections = [""] + [path + ("[]" if kind == "list" else "") for path, kind, *_ in found if kind in ("section", "list")]
    text_of = HEAD
    top = [entry for entry in found if "." not in entry[0]]
    for section in sections:
        inside = [entry for entry in found if entry[0].startswith(section + "." if section else "")
                  and "." not in entry[0][len(section) + bool(section):] and not entry[0].endswith("*")]
        if section == "stages[]":
            inside += [entry for entry in top if entry[0] not in {own[0].rsplit(".", 1)[-1] for own in inside} | {"stages"}]
        text_of += section_text(class_of(section), inside, section == "stages[]")
    return text_of


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "gneiss" / "keys.py"
    target.write_text(module_text(), encoding="utf-8")
