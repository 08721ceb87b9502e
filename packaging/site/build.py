#!/usr/bin/python3
"""Builds the site: build.py GNEISS LIBRARY OUT.

OUT/source gets the pages of docs/, the scenes and examples as pages, the help of every command, and the first page; OUT/html the site.
Warnings of Sphinx and Doxygen's missing files are errors. Links to sources that are no page become their name.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
BESIDE = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md", "README.md": "index.md"}


def page_of(path):
    """The page of the site (relative to its source) that shows a file of the project; None without one."""
    name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else ""
    if name.startswith("docs/") and name.endswith(".md"):
        return name.removeprefix("docs/")
    if re.fullmatch(r"(scenes|examples)/[\w-]+\.(yaml|py|c)", name):
        return f"{name.rsplit('.', 1)[0].replace('two_spheres', path.name.replace('.', '_'))}.md"
    return BESIDE.get(name)


def relink(text, origin, place):
    """Links of a page of the project (origin) for its place in the source of the site."""
    def changed(found):
        picture, words, target = found.groups()
        name, _, heading = target.partition("#")
        if re.match(r"[a-z]+:", target) or not name or picture:
            return found.group(0)
        page = page_of((origin.parent / name).resolve())
        if page is None:
            return words if words.startswith(("`", "!")) else f"`{words}`"
        return f"[{words}]({os.path.relpath(page, Path(place).parent)}{'#' + heading if heading else ''})"

    pieces = re.split(r"(^```.*?^```$)", text, flags=re.S | re.M)
    return "".join(piece if k % 2 else LINK.sub(changed, piece) for k, piece in enumerate(pieces))


def stage(source):
    shutil.copytree(ROOT / "docs", source, dirs_exist_ok=True)
    for path in sorted((ROOT / "docs").rglob("*.md")):
        place = path.relative_to(ROOT / "docs")
        (source / place).write_text(relink(path.read_text(), path, place))
    for name, place in BESIDE.items():
        if place != "index.md":
            (source / place).write_text(relink((ROOT / name).read_text(), ROOT / name, place))
    for path in sorted([*(ROOT / "scenes").glob("*.yaml"), *(ROOT / "examples").glob("*.[yc]*"), *(ROOT / "examples").glob("*.py")]):
        page = source / page_of(path)
        page.parent.mkdir(exist_ok=True)
        language = {".yaml": "yaml", ".py": "python", ".c": "c"}[path.suffix]
        page.write_text(f"# {path.parent.name}/{path.name}\n\n```{language}\n{path.read_text()}```\n")
    gallery = source / "gallery.md"
    gallery.write_text("---\nhide-toc: true\n---\n" + gallery.read_text())
    for path in HERE.glob("*.md"):
        shutil.copy(path, source / path.name)
    header = (ROOT / "include" / "gneiss" / "gneiss.h").read_text()
    introduction = re.sub(r"^ \* ?", "", header[3:header.index("*/")].rstrip(), flags=re.M)
    page = source / "c-api.md"
    page.write_text(page.read_text().replace("@introduction@", f"```\n{introduction}\n```"))
    (source / "_static").mkdir()
    shutil.copy(HERE / "style.css", source / "_static")


def write_commands(program, path):
    def said(*arguments):
        return subprocess.run([program, "help", *arguments], check=True, capture_output=True, text=True).stdout

    names = re.findall(r"^  (\w+) ", said().split("commands:")[1].split("options:")[0], re.M)
    parts = ["# Command line", "", "What `gneiss help` prints. [log.md](log.md) has the form of output for programs.", "", "```", said().rstrip(), "```"]
    for name in [*(name for name in names if name != "help"), "exit-codes"]:
        parts += ["", f"## gneiss {name}" if name in names else "## Exit codes", "", "```", said(name).rstrip(), "```"]
    path.write_text("\n".join(parts) + "\n")


def run_doxygen(folder):
    """XML of the public headers, whose comments are plain ones in C."""
    plain = r"sed -e '2,$s|^/\* \([^-]\)|/** \1|' -e 's|\([;,] *\)/\* |\1/**< |'"
    settings = f"""PROJECT_NAME = gneiss
INPUT = {ROOT}/include/gneiss
OUTPUT_DIRECTORY = {folder}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
WARN_IF_DOC_ERROR = NO
EXTRACT_ALL = YES
OPTIMIZE_OUTPUT_FOR_C = YES
TYPEDEF_HIDES_STRUCT = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = GNEISS_API=
INPUT_FILTER = "{plain}"
"""
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)


def main(program, library, out):
    source, out = Path(out).resolve() / "source", Path(out).resolve()
    shutil.rmtree(source, ignore_errors=True)
    shutil.rmtree(out / "html", ignore_errors=True)
    source.mkdir(parents=True)
    stage(source)
    write_commands(program, source / "commands.md")
    (source / "doxygen").mkdir()
    run_doxygen(source / "doxygen")
    environment = {**os.environ, "GNEISS_ROOT": str(ROOT), "GNEISS_STAGED": str(source), "GNEISS_LIBRARY": str(Path(library).resolve()),
                   "PYTHONPATH": str(ROOT / "python")}
    return subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-j", "auto", "-c", str(HERE), "-d", str(out / "doctrees"),
                           str(source), str(out / "html")], env=environment).returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:4]))
