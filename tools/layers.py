"""Holds the includes of src, bench and validate against the table of docs/design.md: `./do check layers`; layers.py [ROOT].

A folder may include itself, base, and what its row names; a row names only folders above it, so that there is no circle.
A name with a slash is one header; `A to B` stands for all rows from A to B. No folder includes a <folder>_private.h of another.
A function is declared in a header of the folder that defines it, so that calls follow the includes. Fields of the parts (PARTS) are assigned
in the folder of the part alone. A header that more than 15 files of other folders include is a door, <folder>/<folder>.h, or one of OPEN.
Functions above 60 lines are refused as well.
Prints file:line of every violation.
"""
import re
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
TABLE = ROOT / "docs" / "design.md"
PARTS = {"dem": "particles", "boundary": "boundary", "solids": "solids", "membrane": "membrane", "zones": "zones"}
LONGEST = 60
READERS = 15
OPEN = ("base", "soa", "frame/parts.h")
INCLUDE = re.compile(r'\s*#\s*include\s+[<"]([^">]+)[">]')
COMMENT = re.compile(r"/\*.*?\*/", re.S)
FUNCTION = re.compile(r"^(?!static|typedef|extern)[A-Za-z_][\w \*]*?[ \*](gn_\w+)\((?:[^(){};]|\([^()]*\))*\)\s*([;{])", re.M)
PART = "|".join(PARTS)
POINTER = re.compile(rf"\bgn_({PART}) \*(\w+)")
WRITTEN = r"[\w.]+(?:->\w+|\[(?:[^\[\]]|\[[^\]]*\])*\]|\.\w+)*\s*(?:[-+*/|&^]=|=(?!=)|\+\+|--)"
MEMBER_WRITE = re.compile(rf"\b(?:w|world)(?:->|\.)({PART})\.{WRITTEN}")
POINTER_WRITE = re.compile(rf"(?<![\w.>])(\w+)->{WRITTEN}")


def uses_of(cell, above):
    """Returns the names in a cell, with those of `A to B` written out; `above`: the folders of the rows above, in
    their order."""
    for use in (use.strip() for use in cell.split(",")):
        first, between, last = use.partition(" to ")
        if between and first in above and last in above:
            yield from above[above.index(first) : above.index(last) + 1]
        else:
            yield use


def rows(text):
    """Returns {folder: (line, [folders that it may use])}, in the order of the table."""
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


def check_includes(path, table):
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
            yield f"{path.relative_to(ROOT)}:{number}: {room} includes {header}, which its row does not name"


def check_declarations(sources):
    """Lists functions that are declared in one folder and defined in another: calls of them would bypass the
    includes."""
    texts = {path: COMMENT.sub("", path.read_text()) for path in sources}
    defined = {name: path for path, text in texts.items() if path.suffix == ".c" for name, end in FUNCTION.findall(text) if end == "{"}
    for path, text in texts.items():
        for name, end in FUNCTION.findall(text) if path.suffix == ".h" else ():
            if end == ";" and name in defined and room_of(defined[name]) != room_of(path):
                yield f"{path.relative_to(ROOT)}: declares {name}, which {defined[name].relative_to(ROOT)} defines: expected one folder"


def check_writes(path):
    """Refuses assignments to fields of a part in other folders, by the world or by a pointer to the part under any name."""
    text = COMMENT.sub(lambda comment: "\n" * comment[0].count("\n"), path.read_text())
    line = 1
    for function in re.split(r"(?<=\n}\n)", text):
        pointers = {name: part for part, name in POINTER.findall(function)}
        writes = [(write, write[1]) for write in MEMBER_WRITE.finditer(function)]
        writes += [(write, pointers.get(write[1])) for write in POINTER_WRITE.finditer(function)]
        for write, part in writes:
            if part and PARTS[part] != room_of(path):
                yield (f"{path.relative_to(ROOT)}:{line + function.count(chr(10), 0, write.start())}: writes to a field of the part {part}: "
                       f"expected a function of src/{PARTS[part]} that does it")
        line += function.count("\n")


def check_doors(sources):
    readers = Counter(header for path in sources for header in set(INCLUDE.findall(path.read_text()))
                      if "/" in header and header.split("/")[0] not in (room_of(path), "gneiss"))
    for header, count in sorted(readers.items()):
        folder, name = header.split("/", 1)
        if count > READERS and name != f"{folder}.h" and not {folder, header} & set(OPEN):
            yield f"src/{header}: {count} files of other folders include it, expected at most {READERS}, or src/{folder}/{folder}.h that includes it"


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
    sources = [path for folder in ("src", "bench", "validate") for path in sorted((ROOT / folder).rglob("*"))
               if path.suffix in (".c", ".h", ".cc", ".cpp")]
    if len(table) < 10 or len(sources) < 100:
        problems.append(f"{len(table)} rows and {len(sources)} files were read: the table or the tree is not what this expects")
    for path in sources:
        problems += check_includes(path, table)
        problems += check_lengths(path)
    code = [path for path in sources if path.relative_to(ROOT).parts[0] == "src"]
    problems += [*check_declarations(code), *check_doors(code)]
    for path in code:
        problems += check_writes(path) if path.suffix == ".c" else ()
    print(*problems, sep="\n", end="\n" if problems else "")
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main())
