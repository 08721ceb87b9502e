"""Porosity and number of neighbours over the number of particles, as in Labra 2012 (figures 3.12 and 3.15), beside what is published of
single packings. Fills a table of docs/evidence/packing.md and draws its picture.

    /usr/bin/python3 validate/packing_size_study.py [--quick]

Three seeds of 300 to 30 000 discs and spheres, two minutes of one core; --quick: up to 1 000, one seed, and prints what it would have written.
Packings stay in runs/studies/packing-size and are made once.
"""
import hashlib
import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import study

QUICK = "--quick" in sys.argv
FOLDER = study.RUNS / "packing-size"
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
PAGE = "packing.md"
SIZES = (300, 1000) if QUICK else (300, 1000, 3000, 10000, 30000)
SEEDS = (1,) if QUICK else (1, 2, 3)
SQUARE, ROUND = {"rectangle": {"width": "50 mm", "height": "50 mm"}}, {"cylinder": {"diameter": "50 mm", "height": "50 mm"}}
# Name, dimension, shape, packing; published (number, e %, n_c) of such packings (Labra 2012).
KINDS = (
    ("discs", 2, SQUARE, {"size_ratio": 10},
     ((11180, 9.44, 5.94), (15436, 9.27, 5.93), (20836, 9.08, 5.96), (30480, 9.21, 5.98), (56084, 9.03, 5.97))),
    ("spheres without overlap", 3, ROUND, {"size_ratio": 9}, ((30130, 31.30, 8.24),)),
    ("spheres, passive overlap", 3, ROUND, {"overlap": "passive"},
     ((10395, 23.34, 9.48), (17870, 21.27, 9.40), (19563, 21.61, 9.52), (24970, 24.14, 9.77))),
)
COLOURS = ("#2b6cb0", "#3a7d44", "#c8402f")


def packed(dimension, shape, packing, count, seed):
    """The report of `gneiss pack` on a packing."""
    scene = {"dimension": dimension, "specimen": {**shape, "particles": count, "packing": packing}}
    text = json.dumps(scene, indent=1)
    program = hashlib.sha256(Path(study.PROGRAM).read_bytes()).hexdigest()
    folder = FOLDER / hashlib.sha256(f"{text}{seed}{program}".encode()).hexdigest()[:12]
    note = folder / "quality.json"
    if study.FRESH or not note.exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "body.yaml").write_text(text)
        done = study.call(["pack", str(folder / "body.yaml"), "--out", str(folder), "--seed", str(seed), "--log", "json", "--threads", "1"])
        if done.returncode:
            sys.exit(done.stderr)
        note.write_text(json.dumps(json.loads(done.stdout.splitlines()[-2])["result"]))
    return json.loads(note.read_text())


def spread(values, digits):
    mean = f"{np.mean(values):.{digits}f}"
    return mean if len(values) < 2 else f"{mean} ± {np.std(values, ddof=1):.{digits}f}"


def figures(name, dimension, shape, packing):
    """[sizes][seeds] of porosity (%), neighbours, and particles on the surface over all."""
    made = [[packed(dimension, shape, packing, count, seed) for seed in SEEDS] for count in SIZES]
    return [np.array([[q[key] for q in row] for row in made]) * factor
            for key, factor in (("porosity", 100), ("coordination_1", 1), ("particles", 1))]


def draw(found):
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2))
    for (name, _, _, _, published), (e, n_c, count), colour in zip(KINDS, found, COLOURS):
        for axis, value, k, text in ((axes[0], e, 1, "porosity, %"), (axes[1], n_c, 2, "neighbours")):
            axis.errorbar(count.mean(axis=1), value.mean(axis=1), yerr=value.std(axis=1), color=colour, marker="o", ms=4, label=name)
            axis.plot([p[0] for p in published], [p[k] for p in published], "x", color=colour, ms=8, label="published" if axis is axes[1] else None)
            axis.set(xscale="log", xlabel="particles", ylabel=text)
    axes[0].legend(fontsize=8)
    study.save(figure, FOLDER if QUICK else PICTURES, "packing-size")


def main():
    study.reported(sys.argv[1:], __doc__, ("--quick", "--fresh"))
    found, rows = [], []
    for name, dimension, shape, packing, published in KINDS:
        e, n_c, count = figures(name, dimension, shape, packing)
        found.append((e, n_c, count))
        for k in range(len(SIZES)):
            rows.append([name, f"{count[k].mean():.0f}", spread(e[k], 2), spread(n_c[k], 2), ""])
        rows += [[name, number, "", "", f"e {porosity:.2f} %, n_c {neighbours:.2f}"] for number, porosity, neighbours in published]
    rows.sort(key=lambda row: ([kind[0] for kind in KINDS].index(row[0]), int(row[1])))
    study.put_table(PAGE, "table sizes", ["packing", "particles", "e %", "n_c at 1 %", "published"], rows, QUICK)
    draw(found)


main()
