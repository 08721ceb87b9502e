"""Holds the includes of src, bench and validate against the table of docs/design.md: `./do check layers`.

A folder may include itself, base, and what its row names; a row names only folders above it, so that there is no circle.
A name with a slash is one header; `A to B` stands for all rows from A to B. No folder includes a <folder>_private.h of another. Includes that break these rules and are left stand in
tools/layers_upward.txt; a line there that no file needs is refused, so that the list only shrinks. Functions above 60 lines are refused as well.
Prints file:line of whatever is not so.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TABLE = ROOT / "docs" / "design.md"
UPWARD = ROOT / "tools" / "layers_upward.txt"
LONGEST = 60
INCLUDE = re.compile(r'\s*#\s*include\s+[<"]([^">]+)[">]')


def uses_of(cell, above):
    """The names of a cell, with those of `A to B` written out; `above`: the folders of the rows above, in their order."""
    for use in (use.strip() for use in cell.split(",")):
        first, between, last = use.partition(" to ")
        if between and first in above and last in above:
            yield from above[above.index(first) : above.index(last) + 1]
        else:
            yield use


def rows(text):
    """{folder: (line, [what it may use])}, in the order of the table."""
    found = {}
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("| ") and len(cells) == 3 and re.fullmatch(r"[\w/]+/?", cells[0]) and cells[0] != "folder":
            found[cells[0].rstrip("/").removeprefix("src/")] = (number, list(uses_of(cells[2], list(found))))
    return found


def check_table(table):
    above = {"libc"}
    for folder, (number, uses) in table.items():
        for use in uses:
            room = use.rsplit("/", 1)[0] if use.endswith(".h") else use
            if room not in above and use != "everything":
                yield f"{TABLE.relative_to(ROOT)}:{number}: {folder} may use {use}, expected a row above it"
        above.add(folder)
    for folder in sorted(path.name for path in (ROOT / "src").iterdir() if path.is_dir()):
        if folder not in table:
            yield f"{TABLE.relative_to(ROOT)}: src/{folder} has no row"


def room_of(path):
    parts = path.relative_to(ROOT).parts
    return parts[1] if parts[0] == "src" else parts[0]


def check_includes(path, table, known, needed):
    room = room_of(path)
    allowed = {room, "base", *table.get(room, (0, []))[1]}
    for number, line in enumerate(path.read_text().splitlines(), 1):
        found = INCLUDE.match(line)
        if not found or "/" not in found[1] or "everything" in allowed:
            continue
        header = found[1]
        target = "include/gneiss" if header.startswith("gneiss/") else header.split("/")[0]
        private = header.endswith("_private.h") and target != room
        if target in table and (private or not {target, header} & allowed):
            needed.add(f"{room} {header}")
            if f"{room} {header}" in known:
                continue
            yield f"{path.relative_to(ROOT)}:{number}: {room} includes {header}, which its row does not name"


def check_lengths(path):
    start = None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if line and (line[0].isalpha() or line[0] == "_") and line.endswith("{"):
            start = number
        elif line.startswith("}"):
            if start and line == "}" and number - start + 1 > LONGEST:
                yield f"{path.relative_to(ROOT)}:{start}: a function of {number - start + 1} lines, expected at most {LONGEST}"
            start = None


def main():
    table = rows(TABLE.read_text())
    problems = list(check_table(table))
    known, needed = set(UPWARD.read_text().splitlines()), set()
    sources = [path for folder in ("src", "bench", "validate") for path in sorted((ROOT / folder).rglob("*"))
               if path.suffix in (".c", ".h", ".cc", ".cpp")]
    if len(table) < 10 or len(sources) < 100:
        problems.append(f"{len(table)} rows and {len(sources)} files were read: the table or the tree is not what this expects")
    for path in sources:
        problems += check_includes(path, table, known, needed)
        problems += check_lengths(path)
    problems += [f"{UPWARD.relative_to(ROOT)}: no file needs '{line}'" for line in sorted(known - needed)]
    print(*problems, sep="\n", end="\n" if problems else "")
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main())
