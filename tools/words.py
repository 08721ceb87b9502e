"""Checks the language of comments and pages: `./do check words`.

words.py             prints file:line: and the word for every find in the places of CLEAN; exits with 1 if there are any
words.py PATH ...    the finds in these files and folders, clean or not
words.py --count     prints the number of finds of every folder
words.py --strings   reads string literals of C in place of comments; with PATH or --count

Comments are those of C, Python, shell, meson and YAML files; docstrings count as comments. Code is not read. Of Markdown
the prose is read, without code, and the length of its lines.
"""
import argparse
import io
import re
import sys
import tokenize
from collections import Counter
from pathlib import Path

# The places that have no finds and must stay so, one line each: a file, a folder, or "folder/*.md" for its files alone.
CLEAN = [
    "README.md",
    "CONTRIBUTING.md",
    "tools",
    "calibrate",
    "convert",
    "docs",
    "bench",
    "examples",
    "findings",
    "include",
    "python",
    "scenes",
    "tests",
    "validate",
    "src/accuracy",
    "src/api",
    "src/base",
    "src/boundary",
    "src/cli",
    "src/conversion",
    "src/couple",
    "src/drive",
    "src/fem",
    "src/frame",
    "src/inflow",
    "src/io",
    "src/kernels",
    "src/laboratory",
    "src/limit",
    "src/measure",
    "src/membrane",
    "src/mesh",
    "src/neigh",
    "src/pack",
    "src/particles",
    "src/plan",
    "src/run",
    "src/scene",
    "src/ranks",
    "src/sched",
    "src/soa",
    "src/solids",
    "src/static",
    "src/surfaces",
    "src/world",
    "src/sweep",
    "src/test_kinds",
    "src/timestep",
    "src/zones",
]
# Pages that are written by a program from texts elsewhere: their words and lines are those of the texts.
GENERATED = {f"docs/{name}.md" for name in ("keys", "keys-particles", "keys-materials", "keys-walls", "keys-clumps", "keys-elements", "keys-tests",
                                               "quantities", "quantities-readings", "quantities-fields")}

# First words of a comment: it then describes a thing without a sentence.
OPENINGS = re.compile(r"(What|Who|Whose|Of|Whether|The same)\b")
# Particles, bonds and functions are "it"; "whose" may refer to things. Pages may speak of people.
PERSONS = re.compile(r"\b(who|whom|nobody|somebody|everybody)\b", re.I)
# Words that a term of the field has replaced.
RETIRED = {
    r"sleepers?|sleeps|sleeping|asleep": "dormant",
    r"awake|wakes|woken|waking": "active, or activate",
    r"put by|puts by|putting by": "store",
    r"lays? down|laid down": "deactivate",
    r"rehears\w+": "dry run",
    r"foresee\w*|foreseen|foretold|foretells?": "predict",
    r"told": "passed, given, reported or stated",
    r"barred": "disabled",
}
RETIRED = {re.compile(rf"\b({words})\b".replace(" ", r"\s+"), re.I): instead for words, instead in RETIRED.items()}

FOLDERS = ("src", "include", "bench", "tests", "tools", "calibrate", "convert", "validate", "examples", "scenes", "docs")
KINDS = {".c": "c", ".h": "c", ".cpp": "c", ".in": "c", ".py": "python", ".md": "page", ".build": "hash", ".sh": "hash",
         ".yaml": "hash", ".txt": "hash", "": "hash"}
WIDTH = 160  # characters of a line of Markdown
PIECES_OF_C = re.compile(r"""/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'""", re.S)


def pieces_of_c(text, strings):
    """Comments, lines of // that follow each other as one; or string literals."""
    last_end = None
    pending = None
    for match in PIECES_OF_C.finditer(text):
        piece = match.group()
        line = text.count("\n", 0, match.start()) + 1
        if strings:
            if piece[0] == '"':
                yield line, piece[1:-1]
        elif piece.startswith("/*"):
            yield line, re.sub(r"(?m)^[ \t]*\*(?!/)", "", piece[2:-2])
        elif piece.startswith("//"):
            if pending and text[last_end : match.start()].strip() == "" and text.count("\n", last_end, match.start()) == 1:
                pending = pending[0], pending[1] + "\n" + piece[2:]
            else:
                if pending:
                    yield pending
                pending = line, piece[2:]
            last_end = match.end()
    if pending:
        yield pending


def pieces_of_python(text, strings):
    """Comments, those of whole lines that follow each other as one, and docstrings."""
    if strings:
        return
    pending, whole = None, False
    starts = True  # The next token begins a statement.
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        line, column = token.start
        if token.type == tokenize.COMMENT:
            alone = token.line[:column].strip() == ""
            if pending and alone and whole and line == pending[0] + pending[1].count("\n") + 1:
                pending = pending[0], pending[1] + "\n" + token.string.lstrip("#!")
            else:
                if pending:
                    yield pending
                pending, whole = (line, token.string.lstrip("#!")), alone
        elif token.type == tokenize.STRING and starts:
            yield line, token.string.strip("rRbBuU").strip("\"'")
        if token.type not in (tokenize.COMMENT, tokenize.NL):
            starts = token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING)
    if pending:
        yield pending


def pieces_of_hash(text, strings):
    """Comments from # to the end of a line, those of whole lines that follow each other as one."""
    if strings:
        return
    pending, whole = None, False
    for number, line in enumerate(text.splitlines(), 1):
        match = re.search(r"(?:^|\s)#(?![!{])(?=[ #]|$)(.*)", line)
        if not match:
            continue
        alone = line[: match.start(1) - 1].strip() == ""
        if pending and alone and whole and number == pending[0] + pending[1].count("\n") + 1:
            pending = pending[0], pending[1] + "\n" + match.group(1)
        else:
            if pending:
                yield pending
            pending, whole = (number, match.group(1)), alone
    if pending:
        yield pending


def finds_of_words(line, text, rules):
    """Returns findings (line, word, advice), also for words that are separated by a line break."""
    for pattern, instead in rules:
        for match in pattern.finditer(text):
            yield line + text.count("\n", 0, match.start()), " ".join(match.group(1).split()), instead


def finds_of_comment(line, text, strings):
    start = len(text) - len(text.lstrip())
    opening = None if strings else OPENINGS.match(text, start)
    if opening:
        yield line + text.count("\n", 0, start), opening.group(1), "begin with the subject of a sentence"
    rules = [(PERSONS, "particles, bonds and functions are it"), *RETIRED.items()]
    yield from finds_of_words(line, text, rules)


def finds_of_page(text, generated):
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
            continue
        if fenced or re.match(r"    (?! *[-*\d])", line):
            continue
        table = line.lstrip().startswith("|") or line.startswith("![")
        if len(line) > WIDTH and not table and not generated:
            yield number, f"{len(line)} characters", f"at most {WIDTH}; tools/wrap.py wraps paragraphs"
        if not generated:
            prose = re.sub(r"`[^`]*`|\]\([^)]*\)", "``", line)
            yield from finds_of_words(number, prose, RETIRED.items())


def finds_of_file(path, name, strings):
    kind = KINDS[path.suffix]
    text = path.read_text(encoding="utf-8", errors="replace")
    if kind == "page":
        yield from [] if strings else finds_of_page(text, name in GENERATED)
        return
    if path.suffix == "" and not text.startswith("#!"):
        return
    pieces = {"c": pieces_of_c, "python": pieces_of_python, "hash": pieces_of_hash}[kind]
    for line, piece in pieces(text, strings):
        yield from finds_of_comment(line, piece, strings)


def files(root):
    yield from (path for path in sorted(root.iterdir()) if path.is_file() and path.suffix in KINDS)
    for folder in FOLDERS:
        yield from (path for path in sorted((root / folder).rglob("*")) if path.is_file() and path.suffix in KINDS)


def is_in(name, places):
    return any(name == place or name.startswith(place.rstrip("/") + "/") or
               ("*" in place and re.fullmatch(place.replace(".", r"\.").replace("*", "[^/]*"), name)) for place in places)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs="*", metavar="PATH", help="a file or folder, named from the root")
    parser.add_argument("--count", action="store_true", help="the number of finds of every folder")
    parser.add_argument("--strings", action="store_true", help="string literals of C in place of comments")
    parser.add_argument("--root", type=Path, default=Path(__file__).parent.parent)
    options = parser.parse_args()
    root, counts = options.root.resolve(), Counter()
    for path in files(root):
        name = path.relative_to(root).as_posix()
        if (options.paths or not options.count) and not is_in(name, options.paths or CLEAN):
            continue
        for line, word, instead in sorted(finds_of_file(path, name, options.strings)):
            counts[path.parent.relative_to(root).as_posix()] += 1
            if not options.count:
                print(f"{name}:{line}: {word}: {instead}")
    if options.count:
        print(*(f"{count:6} {folder}" for folder, count in sorted(counts.items())), f"{sum(counts.values()):6}", sep="\n")
        return False
    return bool(counts)


if __name__ == "__main__":
    sys.exit(main())
