"""Differences of the step limits from each other and from the true limit. Fills the tables of docs/evidence/timestep.md and
draws docs/evidence/pictures/timestep-damping.png; about ten minutes of one core.

    /usr/bin/python3 validate/timestep_study.py [--fresh]
"""
import json
import math

import numpy as np

import study

STEPS = 4000
SPEED = 1e-6  # m/s: far from any change of geometry
FACTOR = {2: 0.3, 3: 0.17}  # factor of the literature, by dimension
COEFFICIENTS = [0.0, 0.2, 0.5, 0.7, 0.9]
FORMS = {"vector": "nonviscous_vector", "component": "nonviscous_component"}


def elastic_scene(name, dimension, specimen):
    """A free elastic body shaken at random: bonds that never break, no walls."""
    model = {
        "title": f"stability of {name}", "dimension": dimension, "specimen": specimen,
        "materials": [{"name": "rock", "density": 2650, "contact_modulus": 10e9, "kratio": 3.7, "friction": 0.5,
                       "tensile_strength": 1e30, "shear_strength": 1e30}],
        "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.05},
        "initial": {"random_velocity": SPEED}, "damping": {"background": {"model": "none"}},
        "time": {"end": 1.0}, "output": {"history_rows": 400}}
    path = study.RUNS / "timestep" / f"{name}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(model, indent=1))  # JSON is YAML
    return path


def specimen_file(name):
    return {"file": str(study.ROOT / "scenes" / "specimens" / name)}


def lattice(kind, cells, **more):
    return {"lattice": {"kind": kind, "radius": 1e-3, "cells": cells, **more}}


def bodies():
    """name -> (dimension, scene)"""
    return {
        "hexagonal": (2, elastic_scene("hexagonal", 2, lattice("hexagonal", [12, 12]))),
        "fcc": (3, elastic_scene("fcc", 3, lattice("fcc", [5, 5, 5]))),
        "discs": (2, elastic_scene("discs", 2, specimen_file("discs-50x100.txt"))),
        "rock-b": (3, elastic_scene("rock-b", 3, specimen_file("rock-b.txt"))),
        "rock-a": (3, elastic_scene("rock-a", 3, specimen_file("rock-a.txt"))),
        "rock-c": (3, elastic_scene("rock-c", 3, specimen_file("rock-c.txt")))}


def stored(result):
    """Elastic energy over the kinetic energy at the start, at every row; and the drift of their sum."""
    elastic = result.results("history/energy_elastic_normal") + result.results("history/energy_elastic_shear")
    total = elastic + result.results("history/energy_kinetic") + result.results("history/energy_rotational")
    return elastic / total[0], total / total[0]


def shake(name, scene, step, form=None, coefficient=0.0, steps=STEPS):
    settings = {"time.step": f"{step:.9g}", "time.end": f"{step*steps:.9g}", "time.on_unstable": "warn"}
    if coefficient > 0.0:
        settings["damping.background.model"] = FORMS[form]
        settings["damping.background.coefficient"] = coefficient
    return study.run(f"timestep/{name}", scene, settings, must_finish=False)


def grows(result):
    """The elastic energy of a mode just below its limit rises to some hundred times its value and falls again, because the velocities of the scheme
    lie between the positions; in an unstable run it grows without bound."""
    if result.code == 5:
        return True
    if result.code != 0:
        raise SystemExit(f"{result.folder}: exit code {result.code}: {result.message}")
    elastic, _ = stored(result)
    return bool(not np.all(np.isfinite(elastic)) or elastic.max() > 1e4)


def limit_table(everything):
    rows = []
    for name, (dimension, scene) in everything.items():
        found = study.limits(scene)
        sharp, factor = found["sharp"], FACTOR[dimension]
        rows.append([name, f"{dimension}D", f"{sharp:.4g}", f"{found['bound']/sharp:.3f}",
                     f"{found['literature']/sharp:.3f}", f"{factor*found['literature']/sharp:.3f} ({factor})",
                     f"{0.9*sharp/(factor*found['literature']):.1f}"])
    return study.table(["body", "", "sharp limit s", "bound", "literature", "with its factor",
                        "0.9 of sharp over that"], rows)


def undamped_table(everything):
    rows = []
    for name, (_, scene) in everything.items():
        sharp = study.limits(scene)["sharp"]
        for ratio in (0.99, 1.05):
            r = shake(f"{name}-{ratio}", scene, ratio * sharp)
            if r.code == 5:
                rows.append([name, ratio, "stopped: exit code 5", "", "lost"])
                continue
            elastic, total = stored(r)
            rows.append([name, ratio, f"{elastic.max():.3g}", f"{np.abs(total - 1).max():.1e}",
                         "lost" if grows(r) else "stable"])
    return study.table(["body", "step over sharp limit", "largest elastic energy over energy at the start",
                        "drift of the sum of energies", f"after {STEPS} steps"], rows)


def threshold(name, scene, sharp, form, coefficient, steps=STEPS):
    """Largest step that did not grow and smallest that did, over the sharp limit, 0.5 % apart."""
    low, high = 0.5, 1.1
    tag = f"{name}-{form}-{coefficient}-{steps}"
    if grows(shake(f"{tag}-{low}", scene, low * sharp, form, coefficient, steps)):
        return 0.0, low
    while high - low > 0.005:
        ratio = round(0.5 * (low + high), 5)
        if grows(shake(f"{tag}-{ratio}", scene, ratio * sharp, form, coefficient, steps)):
            high = ratio
        else:
            low = ratio
    return low, high


def damped(everything, names):
    rows, curves = [], {}
    for name in names:
        scene = everything[name][1]
        sharp = study.limits(scene)["sharp"]
        for form in FORMS:
            for coefficient in COEFFICIENTS:
                low, high = threshold(name, scene, sharp, form, coefficient)
                predicted = 1 / math.sqrt(1 + coefficient)
                measured = 0.5 * (low + high)
                curves.setdefault((name, form), []).append((coefficient, measured))
                rows.append([name, form, coefficient, f"{predicted:.3f}", f"{low:.3f} to {high:.3f}",
                             f"{measured/predicted:.3f}"])
    return study.table(["body", "form", "a", "1/sqrt(1 + a)", "limit measured", "measured over predicted"], rows), curves


def picture(curves):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (upper, lower) = plt.subplots(2, 1, figsize=(6.4, 5.6), dpi=110, sharex=True, height_ratios=(3, 2))
    a = np.linspace(0, 0.95, 100)
    upper.plot(a, 1 / np.sqrt(1 + a), color="0.3", label="predicted: $1/\\sqrt{1 + a}$")
    lower.axhline(1.0, color="0.3")
    colours = {"hexagonal": "C0", "fcc": "C1", "rock-b": "C2"}
    for k, ((name, form), points) in enumerate(curves.items()):
        x, y = (np.array(v) for v in zip(*points))
        x = x + 0.009 * (k - 2.5)  # the two lines are drawn side by side, because one would hide the other
        style = {"color": colours[name], "markersize": 5, "linestyle": "none", "marker": "o" if form == "vector" else "s",
                 "markerfacecolor": "white" if form == "vector" else colours[name]}
        upper.plot(x, y, label=f"{name}, {form} form", **style)
        lower.plot(x, y * np.sqrt(1 + np.array(points)[:, 0]), **style)
    upper.set(ylabel="largest stable step\nover the sharp undamped limit", ylim=(0.68, 1.03))
    lower.set(xlabel="coefficient a of non-viscous damping", ylabel="measured over predicted", ylim=(0.98, 1.05))
    upper.legend(fontsize=8)
    for axes in (upper, lower):
        axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(study.ROOT / "docs" / "evidence" / "pictures" / "timestep-damping.png")


def main():
    everything = bodies()
    study.put("timestep.md", "table limits", limit_table(everything))
    study.put("timestep.md", "table undamped", undamped_table(everything))
    text, curves = damped(everything, ["hexagonal", "fcc", "rock-b"])
    study.put("timestep.md", "table damped", text)
    picture(curves)


if __name__ == "__main__":
    main()
