#!/usr/bin/python3
"""The gallery: its pictures, and the page that shows them.

gallery.py                     writes docs/gallery.md from docs/gallery.yaml
gallery.py --run GNEISS [NAME ...]   runs the scenes (all, or those named) as the page says, one thread each; remakes their pictures and
                               the seconds in docs/gallery.yaml, then writes the page
gallery.py --tutorials         remakes the pictures of docs/tutorials; programs and module as tools/tutorials.py finds them
gallery.py --picture RUN FILE  draws the last state of a finished run as FILE (PNG)
"""
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import yaml
from PIL import Image

import report_coupling
import tutorials
from report_elements import Mesh, draw_panel, view
from report_pictures import Specimen, Surface, cut, draw_circles
from report_results import Results

ROOT = Path(__file__).resolve().parent.parent
TABLE, PAGE, PICTURES = ROOT / "docs" / "gallery.yaml", ROOT / "docs" / "gallery.md", ROOT / "docs" / "pictures" / "gallery"
SIZE = 3.2, 2.5   # inches
FIRST = "ucs-rock"  # on the first page of the site, larger
DPI = 110
# The run of a tutorial whose last state is drawn, or the picture that the page's own program writes.
TUTORIALS = {"ucs": "runs/ucs", "silo": "runs/silo", "cut": "runs/cut", "beam": "beam.png", "force": "force.png"}
COLOURS = 48      # of a picture, so that it stays below 30 kB


def draw_particles(axes, results):
    """The surface in space, all discs in the plane: coloured by damage, else as the report does first."""
    specimen = Specimen(results)
    ways = {way[0]: way[1:4] for way in specimen.colorings()}
    values, colours, norm = ways["Damage"] if "Damage" in ways else next(iter(ways.values()))
    if not specimen.flat:
        Surface(specimen).draw(axes, colours(norm(values)))
        return
    index, centres, radii = cut(specimen)
    draw_circles(axes, centres, radii, colours(norm(values[index])), "#00000055")
    left, right, bottom, top = specimen.window()
    specimen.beside.draw_cut(axes, specimen.plane, (left, right, bottom, top), True)
    axes.set(xlim=(left, right), ylim=(bottom, top))


def draw_state(figure, axes, results):
    if results.column("elements") is not None or results.column("returned_energy") is not None:
        mesh = Mesh(results)
        section = report_coupling.Section(results, mesh, mesh.scale())
        report_coupling.draw_panel(figure, axes, section, next(iter(report_coupling.quantities(results, mesh))))
    elif results.element_count and not results.particle_count:
        mesh = Mesh(results)
        place = view(mesh, np.nan_to_num(mesh.start + mesh.scale() * mesh.displacement))
        draw_panel(figure, axes, mesh, place, "Von Mises stress", "von_mises", plt.cm.viridis, False)
    else:
        draw_particles(axes, results)


def picture(folder, path, size=SIZE):
    """Draws the last state of a run without frame, title and colour bar; size in inches."""
    results = Results(Path(folder) / "results.h5")
    figure, axes = plt.subplots(figsize=size)
    axes.set_aspect("equal")
    draw_state(figure, axes, results)
    for other in figure.axes[1:]:
        other.remove()
    for text in [*axes.texts, axes.title]:
        text.set_visible(False)
    for line in [line for line in axes.lines if line.get_linewidth() == 2.5]:  # the scale bar
        line.remove()
    axes.axis("off")
    axes.set_position([0, 0, 1, 1])
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=DPI, facecolor="white")
    plt.close(figure)
    reduce(path)


def reduce(path):
    """Few colours make a picture of bodies and curves a third as large."""
    with Image.open(path) as image:
        small = image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    small.save(path, optimize=True)


def run(entry, program, folder):
    """Runs a scene as the page says, with one thread; sets its seconds and remakes its picture."""
    name = entry["scene"]
    subprocess.run([program, "run", ROOT / "scenes" / f"{name}.yaml", "--out", folder, "--threads", "1", "--quiet", "--force"], check=True)
    entry["seconds"] = float(f"{json.loads((Path(folder) / 'summary.json').read_text())['seconds']['cpu']:.2g}")
    picture(folder, PICTURES / f"{name}.png")
    if name == FIRST:
        picture(folder, PICTURES / "first.png", (4.2, 5.4))


def set_seconds(text, name, seconds):
    """The table with other seconds for one scene; all else stays as it is, comments included."""
    head, entry, tail = re.match(rf"(.*\n)(- scene: {name}\n(?:  [^\n]*\n)+)(.*)", text, re.S).groups()
    entry = re.sub(r"  seconds: .*\n", "", entry)
    return f"{head}{entry}  seconds: {seconds:g}\n{tail}"


def page(entries):
    rows = ["# Gallery", "",
            f"{len(entries)} scenes that come with gneiss, each with one command. Seconds are those of one core; several threads take less. The picture shows",
            "the state at the end of the run. `gneiss report` draws curves beside it, and ParaView opens the snapshots.", "",
            "In a clone the program is `build/gneiss`; from the Debian package the scenes are in `/usr/share/gneiss/scenes`. [Tutorials](tutorials/ucs.md)",
            "build scenes from nothing, [tests](tests.md) has all kinds of tests. Written by `tools/gallery.py` from `docs/gallery.yaml`; do not edit.", ""]
    for entry in entries:
        name, warns = entry["scene"], entry.get("warns", [])
        note = f" It warns ([`{warns[0]}`](warnings.md)): read the comment in the scene." if warns else ""
        rows += [f"## {entry['title']}", "", f"[![{entry['title']}](pictures/gallery/{name}.png)](../scenes/{name}.yaml)", "",
                 f"    gneiss run scenes/{name}.yaml", "",
                 f"{entry['seconds']:g} s. [scenes/{name}.yaml](../scenes/{name}.yaml).{note}", "", f"Change: {entry['change']}.", ""]
    return "\n".join(rows)


def remake_tutorials():
    for name, source in TUTORIALS.items():
        target = ROOT / "docs" / "tutorials" / "pictures" / f"{name}.png"
        target.parent.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory() as folder:
            for _ in tutorials.run(ROOT / "docs" / "tutorials" / f"{name}.md", folder):
                pass
            if source.endswith(".png"):
                shutil.copy(Path(folder) / source, target)
                reduce(target)
            else:
                picture(Path(folder) / source, target)


def table():
    return yaml.safe_load(TABLE.read_text())


def main():
    if sys.argv[1:2] == ["--picture"]:
        picture(sys.argv[2], Path(sys.argv[3]))
        return
    if sys.argv[1:2] == ["--tutorials"]:
        remake_tutorials()
        return
    if sys.argv[1:2] == ["--run"]:
        for entry in table():
            if not sys.argv[3:] or entry["scene"] in sys.argv[3:]:
                with tempfile.TemporaryDirectory() as folder:
                    run(entry, sys.argv[2], folder)
                TABLE.write_text(set_seconds(TABLE.read_text(), entry["scene"], entry["seconds"]))
    PAGE.write_text(page(table()))


if __name__ == "__main__":
    main()
