#!/usr/bin/python3
"""keys_pages.py GNEISS [DOCS]: writes docs/keys*.md, the key reference by topic, from `gneiss keys --markdown`, and without DOCS the typed
keys of the Python module too, from the library of the same build; --check: exits with 1 if a page differs."""
import os
import re
import subprocess
import sys
from pathlib import Path

# Page, title, first parts of paths; the first page has all others.
PAGES = [("keys.md", "Keys of a scene", ()),
         ("keys-particles.md", "Keys of particles", ("specimen", "sets", "sources", "sinks")),
         ("keys-materials.md", "Keys of materials and contacts", ("materials", "contacts", "law", "bonds", "joints")),
         ("keys-walls.md", "Keys of walls, bodies and membrane", ("walls", "bodies", "membrane")),
         ("keys-clumps.md", "Keys of clumps", ("clumps",)),
         ("keys-elements.md", "Keys of elements and coupling", ("elements", "couple")),
         ("keys-tests.md", "Keys of tests", ("test",))]
TEXT = """# {title}

Written by `tools/keys_pages.py build/gneiss` from the table that also drives the reading of scenes. A number may carry a unit, as in `23 mm`;
without one it is in SI. `[]` stands for an element of a list; `--set` reaches it by index or name, as in `walls.top.motion.vz=0.1`.

{others}

| key | value | default | meaning |
| --- | --- | --- | --- |
"""


def pages(printed):
    """{name of a page: its text} of what `gneiss keys --markdown` printed."""
    rows = re.findall(r"^\| `([\w]+).*$\n", printed, re.MULTILINE), re.findall(r"^\| `[\w]+.*$\n", printed, re.MULTILINE)
    of = {top: name for name, _, tops in PAGES for top in tops}
    found = {}
    for name, title, _ in PAGES:
        others = "Other pages: " + ", ".join(f"[{', '.join(f'`{top}`' for top in tops) or 'all others'}]({page})" for page, _, tops in PAGES if page != name) + "."
        found[name] = TEXT.format(title=title, others=others) + "".join(
            row for top, row in zip(*rows) if of.get(top, PAGES[0][0]) == name)
    return found


def write_typed_keys(program):
    """Writes python/gneiss/keys.py (python/make_keys.py)."""
    root, folder = Path(__file__).resolve().parents[1], Path(program).resolve().parent
    version = re.search(r"version: '([^']*)'", (root / "meson.build").read_text(encoding="utf-8"))[1]
    subprocess.run(["ninja", "--quiet", "-C", folder, f"libgneiss.so.{version}"], check=True)
    subprocess.run(["/usr/bin/python3", root / "python" / "make_keys.py"], check=True,
                   env={**os.environ, "GNEISS_LIBRARY": str(folder / f"libgneiss.so.{version}")})


def main():
    arguments = [one for one in sys.argv[1:] if one != "--check"]
    docs = Path(arguments[1] if len(arguments) > 1 else Path(__file__).resolve().parents[1] / "docs")
    made = pages(subprocess.run([arguments[0], "keys", "--markdown"], check=True, capture_output=True, text=True).stdout)
    if "--check" in sys.argv:
        stale = [name for name, text in made.items() if not (docs / name).exists() or (docs / name).read_text(encoding="utf-8") != text]
        print("".join(f"docs/{name}: stale: tools/keys_pages.py build/gneiss\n" for name in stale), end="")
        return 1 if stale else 0
    for name, text in made.items():
        (docs / name).write_text(text, encoding="utf-8")
    if len(arguments) < 2:
        write_typed_keys(arguments[0])
    return 0


if __name__ == "__main__":
    sys.exit(main())
