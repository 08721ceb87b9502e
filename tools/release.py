#!/usr/bin/python3
"""release.py [ROOT]: checks that all files name the version of meson.build, and that CHANGELOG.md has an entry for it: `./do check release`."""
import re
import sys
from pathlib import Path

# File, and the expression whose group is the version; the first one counts.
PLACES = [("meson.build", r"version: '([^']*)'"), ("CITATION.cff", r"^version: (\S+)"), ("CHANGELOG.md", r"^## (\S+)"),
          ("packaging/debian/changelog", r"^gneiss \(([^)-]*)")]


def problems(root):
    """Messages, none if all agree."""
    found = {}
    for name, form in PLACES:
        match = re.search(form, (root / name).read_text(encoding="utf-8"), re.MULTILINE)
        found[name] = match[1] if match else "none"
    version = found["meson.build"]
    wrong = [f"{name}: expected version {version} as in meson.build, found {own}" for name, own in found.items() if own != version]
    entry = re.search(rf"^## {re.escape(version)} \(([^)]*)\)\n(.*?)(?=^## |\Z)", (root / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    if entry and not re.search(r"^(- |\| )", entry[2], re.MULTILINE):
        wrong.append(f"CHANGELOG.md: expected a list of changes under {version}, found none")
    return wrong


def main():
    wrong = problems(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[1]))
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
