"""Checks the links of the pages: `./do check links`.

links.py [ROOT]: every relative link and picture of README.md, CONTRIBUTING.md and docs/ is there, with the heading that it
names; every page and picture under docs/ that a source, a script or a page names is there, and every source that a page
names, also by its folder in src and its name alone; every picture is shown on a page; every page
is in the navigation of the site; no page outside docs/evidence is too long to be
read at once. Prints file:line of every violation.
"""
import re
import sys
from pathlib import Path

LINK = re.compile(r"\]\(([^)\s]+)\)")
NAMED = re.compile(r"(?<![\w./-])docs/[\w./-]+\.(?:md|png)\b")
SOURCE = re.compile(r"(?<![\w./-])(?:src|include|tests|bench|validate|tools|scenes|examples)/[\w./-]+\.(?:c|h|cpp|py|yaml|txt|sh|json|build)\b")
FOLDERS = ("docs", "scenes", "include", "src", "tests", "bench", "validate", "tools", "examples")
TEXTS = {".md", ".c", ".h", ".cc", ".cpp", ".py", ".sh", ".yaml", ".build", ""}


def texts(root):
    """Files of the project that may name a page."""
    yield from (path for path in sorted(root.iterdir()) if path.is_file() and path.suffix in TEXTS)
    for folder in FOLDERS:
        yield from (path for path in sorted((root / folder).rglob("*")) if path.is_file() and path.suffix in TEXTS)


def lines_outside_code(text):
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            yield number, line


def headings(page):
    """Names by which links reach the headings of a page: lower case, without punctuation, blanks as hyphens."""
    titles = [line.lstrip("#").strip() for _, line in lines_outside_code(page.read_text()) if re.match(r"#+ ", line)]
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def check_links(page, root, shown):
    for number, line in lines_outside_code(page.read_text()):
        for link in LINK.findall(line):
            if re.match(r"[a-z]+:", link):
                continue
            name, _, heading = link.partition("#")
            target = (page.parent / name).resolve() if name else page
            shown.add(target)
            if not target.exists() or not target.is_relative_to(root):
                yield f"{page.relative_to(root)}:{number}: {link} is not there"
            elif heading and heading not in headings(target):
                yield f"{page.relative_to(root)}:{number}: {link}: there is no such heading"


def check_names(path, root):
    is_page = path.suffix == ".md"
    rooms = "|".join(sorted(folder.name for folder in (root / "src").glob("*/")))
    in_src = re.compile(rf"(?<![\w./-])(?:{rooms})/\w+\.[ch]\b") if is_page and rooms else None
    for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        if is_page:
            line = re.sub(r"\[[^]]*\]\([^)]*\)", "", line)
        short = [f"src/{name}" for name in in_src.findall(line)] if in_src else []
        for name in NAMED.findall(line) + (SOURCE.findall(line) if is_page else []) + short:
            if not (root / name).exists():
                yield f"{path.relative_to(root)}:{number}: {name} is not there"


def check_length(page, root):
    name, text = page.relative_to(root), page.read_text()
    lines, words = len(text.splitlines()), len(text.split())
    most = 120 if str(name) == "README.md" else 300
    if name.parts[:2] != ("docs", "evidence") and (lines > most or words > 3000):
        yield f"{name}:1: expected at most {most} lines and 3000 words, found {lines} and {words}"


def check_navigation(root):
    """Every page outside docs/evidence is in the navigation of the site."""
    index = root / "packaging" / "site" / "index.md"
    if not index.exists():
        return
    listed = set(index.read_text().splitlines())
    for page in sorted((root / "docs").rglob("*.md")):
        name = page.relative_to(root / "docs")
        if name.parts[0] != "evidence" and name.with_suffix("").as_posix() not in listed:
            yield f"docs/{name}:1: expected it in packaging/site/index.md, which does not name it"


def main(root):
    problems, shown = [], set()
    for path in texts(root):
        if path.suffix == ".md":
            problems += [*check_links(path, root, shown), *check_length(path, root)]
        problems += check_names(path, root)
    problems += check_navigation(root)
    for picture in sorted((root / "docs").rglob("*.png")):
        if picture not in shown:
            problems.append(f"{picture.relative_to(root)}: no page shows it")
    print(*problems, sep="\n", end="\n" if problems else "")
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()))
