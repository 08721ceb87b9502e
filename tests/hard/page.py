"""Writes docs/evidence/hard-cases.md from the table and from runs of the cases: a minute of one core.

    /usr/bin/python3 tests/hard/page.py build/gneiss [docs/evidence/hard-cases.md]
"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
PAGE = os.path.join(os.path.dirname(os.path.dirname(HERE)), "docs", "evidence", "hard-cases.md")

HEAD = """# Hard cases

Written by `tests/hard/page.py` from the table in `tests/hard/` and from runs; do not edit. Small scenes in which engines of this kind go
wrong, at the settings that a scene has when it says nothing of them. `tests/test_hard.py` runs every one in every test run, and again
on three threads, on every instruction set, and stopped half way and taken up by others: what a run leaves, or says where it is
stopped, is the same to the bit. What is refused leaves nothing behind. Long forms, of up to 1e7 steps, are in
[validation.md](validation.md) (`./do validate --only hard`, which writes this page as well).

*Without it*: what was seen when the guard was taken out of the program, in a build made for that. Where no guard was found whose absence the
case shows, it says so. *Other codes*: only what was tried here. Figures are of one machine; in brackets what a closed form says.
"""
COLUMNS = ["case", "what is hard", "what should happen", "what happens", "what guards it", "without it", "other codes"]


def cell(text):
    return text.replace("|", "\\|").replace("\n", " ") or "-"


def reported(case):
    """The row of a case on the page, without its figures."""
    return f"| {cell(case.name)} | {cell(case.hard)} | {cell(case.should)} |"


def kept(case):
    guard = case.guard + (f" (variants: `tests/{case.more}`)" if case.more else "")
    return f"| {cell(guard)} | {cell(case.without)} | {cell(case.others)} |"


def row(case, figures):
    return f"{reported(case)} {cell(figures)} {kept(case)}"


def text_of(families, seen):
    parts = [HEAD]
    for family, cases in families.items():
        parts += [f"## {family}", "| " + " | ".join(COLUMNS) + " |\n|" + " --- |" * len(COLUMNS) + "\n" +
                  "\n".join(row(case, seen(case)) for case in cases)]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def figures(number, case):
    import program
    from hard.case import watch

    folder = program.place_of(number)
    try:
        return watch(case, folder)[1]
    finally:
        program.shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    from hard import table

    written = text_of(table.FAMILIES, lambda case: figures(table.CASES.index(case), case))
    with open(sys.argv[2] if len(sys.argv) > 2 else PAGE, "w", encoding="utf-8") as file:
        file.write(written)
