"""Shared by the tests of discs in the plane: the Brazilian disc, the block and the notched beam of particles. Strength over every axis, the floors,
and its dependence on the number of particles."""
import copy

import numpy as np

import fits
import simple
import words
from machinery import Axis, key

MATERIAL = {"name": "rock", "density": 2600.0, "contact_modulus": "20 GPa", "kratio": 2.5, "friction": 0.5, "tensile_strength": "10 MPa",
            "shear_strength": "40 MPa"}


def scene(specimen, more):
    return {"dimension": 2, "specimen": specimen, "materials": [MATERIAL], "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.05},
            "damping": {"background": {"model": "nonviscous_vector", "coefficient": 0.7}},
            "output": {"history_rows": 2000, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}, **more}


def rows_of(study, case, shape, count, motion, more, speeds, counts, number=key("specimen.particles"), seeds=5):
    """Rows of the axes: `speeds` down to the slowest, `counts` with a number of seeds each, `number` the keys of a
    count."""
    quick = study.quick
    packed = {**shape, "particles": count, "packing": {"size_ratio": 3}, "material": "rock"}
    request = {"dimension": 2, "specimen": packed, "run": {"seed": 1}}
    name = f"{case}-{packed['particles']}"
    file = {"file": str(study.packed(name, request)), "material": "rock"}
    shaken = list(range(3 if quick else 7))
    axes = [(Axis("round-off", shaken, lambda k: {"specimen.file": str(study.packed(name, request, k))}, shaken), file),
            (Axis("velocity", speeds, motion, speeds), file),
            (Axis("safety", [0.9, 0.6, 0.3], key("time.safety"), [0.9, 0.5]), file),
            (Axis("precision", ["double", "mixed"], key("run.precision"), ["double", "mixed"]), file),
            (Axis("damping", [0.1, 0.4, 0.7], key("damping.background.coefficient"), [0.2, 0.7]), file),
            (Axis("particles", counts, number, counts, seeds=seeds), packed)]
    return {axis.name: study.axis(case, scene(copy.deepcopy(specimen), more), axis) for axis, specimen in axes}


def exponent(m, reading):
    """The exponent of a reading over the number of particles across: d ln(reading)/d ln(n), n ~ sqrt(count), over all runs of the axis."""
    rows, of = m.case.rows["particles"], m.case.readings[reading]
    _, slope, _, error = fits.line([0.5 * np.log(row.value) for row in rows], np.log([of(row) for row in rows]))
    return slope, error


def size_words(m, reading, notched):
    slope, error = exponent(m, reading)
    rows = simple.by_value(m.case.rows["particles"])
    spread = {n: fits.scatter([m.case.readings[reading](row) for row in same]) for n, same in rows.items()}
    floor = fits.scatter([m.case.readings[reading](row) for row in m.case.rows["round-off"]])
    text = (f"**Floors** of the strength: round-off {words.percent(floor)}, packing " +
            ", ".join(f"{words.percent(value)} ({n})" for n, value in spread.items()) + ".\n\n")
    text += f"**Particles.** At a constant contact strength the strength goes as n^{slope:.2f} (+- {error:.2f}), n the particles across: as r^{-slope:.2f}. "
    if not error < 0.2:
        return text + "These runs are too few to tell a law from that."
    if abs(slope + 0.5) <= 2 * error and abs(slope) > 2 * error:
        return text + ("It does not converge. That is the slope of fracture toughness: hold contact strength times the root of the radius constant, "
                       "and the strength does not depend on the radius.")
    if abs(slope) <= 2 * error:
        return text + "So within its error it does not depend on the number of particles: hold contact strength constant."
    held = fits.scatter([np.nanmean([m.case.readings[reading](row) for row in same]) * n**0.25 for n, same in rows.items()])
    plain = fits.scatter([np.nanmean([m.case.readings[reading](row) for row in same]) for same in rows.values()])
    better = "contact strength times the root of the radius (fracture toughness)" if held < plain else "contact strength"
    return text + (f"It has not converged over these numbers. Means scatter by {words.percent(plain)} over them at constant contact strength, and would by "
                   f"{words.percent(held)} if contact strength times the root of the radius were: hold {better}. "
                   + ("Linear fracture mechanics gives r^0.5 for a notch that is long compared with the particles." if notched else
                      "Linear fracture mechanics gives r^0.5 for a crack that is long compared with the particles; there is none at the start."))


def rate(row):
    """Speed of the loading over that of waves (root of contact modulus over density) and strain at the largest stress."""
    return row.value / (np.sqrt(20e9 / MATERIAL["density"]) * row["largest_strain"])


GROUPS = {"particles": ("1 / particles", lambda row: 1 / row.value),
          "velocity": ("closing speed / (root of contact modulus over density x strain of the ends at the peak)", rate)}
