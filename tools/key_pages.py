#!/usr/bin/python3
"""key_pages.py DOCS OUT.c OUT.d: writes the table of src/cli/explain.h, which pages mention which key, and what it depends on.

A page mentions a key in code, by its path or the end of it: `walls.motion.vz`, `walls.top.motion.vz`, `motion.vz`. The name alone counts
where no other key has it, and in an example of YAML."""
import re
import sys
from collections import Counter
from pathlib import Path

ANCHOR = re.compile(r"[^\w\- ]")


def keys_of(page):
    """Returns the paths of the generated reference, such as walls[].motion.vz."""
    return re.findall(r"^\| `([^`*]+)` \|", page.read_text(encoding="utf-8"), re.MULTILINE)


def mentions(text):
    """Returns {words in code: heading above their first occurrence}."""
    heading, found, fenced = "", {}, False
    for line in text.splitlines():
        if line.startswith("```"):
            fenced = not fenced
        title = re.match(r"#+ +(.*)", line) if not fenced else None
        if title:
            heading = ANCHOR.sub("", title[1].lower()).replace(" ", "-")
        code = [line] if fenced or line.startswith("    ") else re.findall(r"`([^`]+)`", line)
        for word in re.findall(r"[A-Za-z_][\w.\[\]]*", " ".join(code)):
            found.setdefault(word.rstrip("."), heading)
    return found


def forms_of(path, counts):
    """Patterns by which a page may name a key."""
    parts = path.split(".")
    whole = r"\.".join(re.escape(part).replace(r"\[\]", r"(?:\[\w*\]|\.\w+)?") for part in parts)
    ends = [re.escape(".".join(parts[k:]).replace("[]", "")) for k in range(len(parts) - 1, 0, -1)]
    return re.compile("|".join([whole] + [end for end in ends if counts[end.replace("\\", "")] == 1]) + "$")


def main():
    docs = Path(sys.argv[1])
    reference = sorted(docs.glob("keys*.md"))
    keys = [key for page in reference for key in keys_of(page)]
    counts = Counter(".".join(key.split(".")[k:]).replace("[]", "") for key in keys for k in range(key.count(".") + 1))
    pages = [(Path(page), mentions(Path(page).read_text(encoding="utf-8"))) for page in sorted(set(docs.glob("*.md")) - set(reference))]
    lines = ['#include "cli/explain.h"\n\nconst gn_key_page gn_key_pages[] = {']
    for key in keys:
        form = forms_of(key, counts)
        for page, words in pages:
            heading = next((heading for word, heading in words.items() if form.fullmatch(word)), None)
            if heading is not None:
                place = "/".join(page.parts[page.parts.index("docs"):]) + ("#" + heading if heading else "")
                lines.append(f'    {{"{key}", "{place}"}},')
    Path(sys.argv[2]).write_text("\n".join([*lines, "    {0, 0}};\n"]), encoding="utf-8")
    needed = [docs, *reference, *(page for page, _ in pages)]
    Path(sys.argv[3]).write_text(f"{sys.argv[2]}: {' '.join(map(str, needed))}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
