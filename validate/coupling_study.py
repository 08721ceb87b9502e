"""Waves through zones that particles and elements share, and a patch of a disordered packing: docs/evidence/coupling.md. Some ten minutes.

    /usr/bin/python3 validate/coupling_study.py [--fresh]
"""
import h5py
import numpy as np

import coupling_packings
import study

SCENE = "scenes/wave-zone.yaml"
LENGTH, MODULUS, DENSITY, SPACING = 0.6, 24e9, 7800.0, 1e-3
SPEED = np.sqrt(MODULUS / DENSITY)
WIDTHS = (5, 10, 20, 40, 80, 120)  # mm
CONSTRAINTS = ("lumped", "consistent", "penalty")


def zone(width, mirrored):
    """Ends of elements and particles, in m: in the middle, the elements at a multiple of 5 mm."""
    half = width / 2
    reach = 5e-3 * np.ceil((LENGTH / 2 + half) / 5e-3 - 1e-6)
    return (LENGTH - reach, LENGTH - reach + width) if mirrored else (reach, reach - width)


def wave_settings(width, wave, side, constraint, mirrored):
    """Settings of the strip of the scene, in m: elements first, or particles."""
    start, end = (round(place, 9) for place in zone(width, mirrored))
    columns = 1 + round((end if mirrored else LENGTH - end) / SPACING)
    size = LENGTH - start if mirrored else start
    return {"specimen.lattice.cells": f"[{columns}, 10]",
            "specimen.lattice.origin": f"[{(0 if mirrored else end) - SPACING / 2}, 0]",
            "elements.rectangle.origin": f"[{start if mirrored else 0}, 0]", "elements.rectangle.size": f"[{size}, 0.01]",
            "elements.rectangle.cells": f"[{round(size / side)}, {round(0.01 / side)}]",
            "couple.zones[0].edges[0].from": f"[{start}, 0]", "couple.zones[0].edges[0].to": f"[{end}, 0]",
            "couple.constraint": constraint, "initial.pulse.length": wave, "initial.pulse.size": 1e-6}


def columns_of(result, kind, step):
    """Means over the columns of points with equal initial x: positions, displacements half a step earlier,
    velocities."""
    u, v = result.results(f"{kind}/displacement")[:, 0], result.results(f"{kind}/velocity")[:, 0]
    x = np.round((result.results(f"{kind}/position")[:, 0] - u) / 1e-5).astype(int)
    places, which = np.unique(x, return_inverse=True)
    count = np.bincount(which)
    return places * 1e-5, np.bincount(which, u - 0.5 * step * v) / count, np.bincount(which, v) / count


def step_of(result):
    with h5py.File(result.folder / "results.h5", "r") as file:
        return float(np.ravel(file.attrs["dt"])[0])


def returned(result, mirrored, end):
    """Reflected energy before the zone relative to that of the pulse, in %."""
    if not mirrored:
        return 100 * result.returned_energy
    x, u, v = columns_of(result, "particles", step_of(result))
    before = x[1:] <= end
    wave = 0.5 * (0.5 * (v[1:] + v[:-1]) + SPEED * np.diff(u) / np.diff(x))[before]
    whole = sum(result.results(f"history/energy_{name}")[0] for name in ("kinetic", "elastic_normal", "elastic_elements"))
    return 100 * np.sum(DENSITY * 0.01 * SPACING * wave**2) / whole


LATE = 240e-6  # s: time at which the reflection from the far end of a zone of 120 mm has left the zone


def wave_result(width, length, side, constraint, mirrored=False, end=None):
    name = f"coupling/{constraint}-{width}-{length}-{side}-{'back' if mirrored else 'forth'}{f'-{1e6 * end:g}' if end else ''}"
    settings = wave_settings(width * 1e-3, length * 1e-3, side * 1e-3, constraint, mirrored)
    end = end or coupling_packings.read_at(length * 1e-3, min(zone(width * 1e-3, mirrored)) if mirrored else None)
    return study.run(name, SCENE, {**settings, "time.end": end, "output.history_rows": 40})


def wave(width, length, side, constraint, mirrored=False, end=None):
    result = wave_result(width, length, side, constraint, mirrored, end)
    return returned(result, mirrored, min(zone(width * 1e-3, mirrored)))


def wave_table(mirrored):
    rows = []
    for constraint in CONSTRAINTS:
        for length, side in ((30, 5), (60, 5), (120, 5), (60, 2.5)):
            late = [] if mirrored else [f"{wave(WIDTHS[-1], length, side, constraint, end=LATE):.3f}"]
            rows.append([constraint, length, side, *(f"{wave(w, length, side, constraint, mirrored):.3f}" for w in WIDTHS), *late])
    late = [] if mirrored else [f"L {WIDTHS[-1]}, after {1e6 * LATE:g} us"]
    return study.table(["constraint", "wave, mm", "h, mm", *(f"L {w}" for w in WIDTHS), *late], rows)




def energy_before(result, kind, edges=None):
    """Energy of the columns of points up to the end of the zone between edges = (where elements end, where particles do), with their share in it;
    J. Without a zone up to the same place, edges = (that place,)."""
    x, u, v = columns_of(result, kind, step_of(result))
    middle, size = 0.5 * (x[1:] + x[:-1]), np.diff(x)
    elements = np.clip((edges[0] - middle) / (edges[0] - edges[1]), 0, 1) if len(edges) > 1 else float(kind == "nodes")
    share = elements if kind == "nodes" else 1 - elements
    energy = 0.5 * DENSITY * 0.5 * (v[1:] ** 2 + v[:-1] ** 2) + 0.5 * MODULUS * (np.diff(u) / size) ** 2
    return np.sum((0.01 * size * share * energy)[x[1:] <= max(edges) + 1e-9])


def left_alone(mirrored, length, side, place):
    """Energy that a mesh without particles (or a lattice without elements) leaves before a given x, in %."""
    if mirrored:
        alone = coupling_packings.wave_run(f"strip-lattice-{length}", False, False, 0.0, LENGTH, None, MODULUS, length * 1e-3, side * 1e-3)
    else:
        alone = coupling_packings.wave_run(f"strip-mesh-{length}-{side:g}", False, False, None, None, (0.0, LENGTH), MODULUS, length * 1e-3, side * 1e-3)
    return 100 * energy_before(alone, "particles" if mirrored else "nodes", (place,)) / coupling_packings.stored(alone)


def behind_table(mirrored, widths=(20, 40, 80)):
    rows = []
    for length, side in ((30, 5), (60, 5), (120, 5), (60, 2.5)):
        for constraint in CONSTRAINTS:
            cells = []
            for width in widths:
                result, edges = wave_result(width, length, side, constraint, mirrored), zone(width * 1e-3, mirrored)
                left = 100 * sum(energy_before(result, kind, edges) for kind in ("nodes", "particles")) / coupling_packings.stored(result)
                alone = left_alone(mirrored, length, side, max(edges))
                cells += [f"{left:.3f}", f"{left - alone:.3f}"]
            rows.append([constraint, length, side, *cells, f"{alone:.3f}"])
    return study.table(["constraint", "wave, mm", "h, mm", *(name for width in widths for name in (f"L {width}, %", "more than alone, %")),
                        f"alone, to the end of L {widths[-1]}, %"], rows)


# --- a patch of a disordered packing --------------------------------------------------------------------------

PATCH = """dimension: 2
specimen: {{group: 1, rectangle: {{width: {length}, height: 0.02}}, origin: [0.04, 0], mean_radius: {radius}, density_basis: bulk,
  packing: {{overlap: passive, size_variation: 0.1}}}}
materials: [{{name: m, density: 7800, contact_modulus: 24e9, kratio: 3, friction: 0, tensile_strength: 1e15, shear_strength: 1e15}}]
law: {{stiffness: harmonic}}
bonds: {{interaction_range: 0.1, passive_gaps: true}}
elements:
  rectangle: {{size: [{end}, 0.02], cells: [{cells}, {rows}]}}
  materials: [{{young: {young}, poisson: {poisson}, density: 7800}}]
  motions:
    - {{name: held, group: x_lower, motion: {{vx: 0}}}}
    - {{name: foot, box: {{min: [0, 0], max: [0, 0]}}, motion: {{vy: 0}}}}
sets: [{{name: pulled, select: {{end: {{axis: x, side: upper, depth: 2 mm, by: centre}}}}, motion: {{vx: [[0, 0], [0.1 ms, 1e-3], [0.4 ms, 1e-3], [0.5 ms, 0]]}}}}]
couple: {{zones: [{{edges: [{{from: [{end}, 0], to: [{start}, 0]}}]}}]}}
damping: {{background: {{model: viscous, coefficient: 3e4}}}}
time: {{end: 2 ms}}
run: {{residual_limit: off}}
"""


def patch_run(radius, width, side, young, poisson, number):
    start = 0.04 + radius
    cells = round((start + width) / side)
    values = {"length": 0.08, "radius": radius, "end": start + width, "start": start, "cells": cells, "rows": round(0.02 / side),
              "young": young, "poisson": poisson}
    path = study.RUNS / "coupling" / f"patch-{radius}-{width}-{side}-{number}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(PATCH.format(**values))
    return start, start + width, study.run(f"coupling/patch-{radius}-{width}-{side}-{number}", path, {})


def places(result, kind):
    u = result.results(f"{kind}/displacement")[:, :2]
    return result.results(f"{kind}/position")[:, :2] - u, u


def slope(x, u, low, high):
    inside = (x > low) & (x < high)
    return np.polyfit(x[inside], u[inside], 1)[0]


def patch_error(radius, width, side):
    """Elements get the E and nu for which free particles beside them have these strains; returns the largest
    deviation of the nodes and particles of the zone from a linear field, relative to strain times width, and that
    of the two strains, in %."""
    young, poisson = 2e10, 0.2
    for number in range(4):
        start, end, result = patch_run(radius, width, side, young, poisson, number)
        (x, u), (y, v) = places(result, "nodes"), places(result, "particles")
        elements = slope(x[:, 0], u[:, 0], 0.005, start - 0.005), slope(x[:, 1], u[:, 1], -1, 1)
        particles = slope(y[:, 0], v[:, 0], end + 0.005, 0.112), slope(y[y[:, 0] > end, 1], v[y[:, 0] > end, 1], -1, 1)
        error = 100 * (particles[0] / elements[0] - 1)
        if number < 3:
            young, poisson = young * elements[0] / particles[0], float(np.clip(-particles[1] / particles[0] / (1 - particles[1] / particles[0]), 0.0, 0.4))
    near = (x[:, 0] >= start - 1e-9)
    fit = np.polyfit(x[near, 0], u[near, 0], 1)
    deviation = np.max(np.abs(u[near, 0] - np.polyval(fit, x[near, 0])))
    mean = np.mean(np.abs(u[near, 0] - np.polyval(fit, x[near, 0])))
    return 100 * deviation / (abs(fit[0]) * width), 100 * mean / (abs(fit[0]) * width), error, young, poisson


def patch_table():
    rows = []
    for radius, width, side in ((1e-3, 0.012, 4e-3), (0.5e-3, 0.012, 4e-3), (0.5e-3, 0.024, 4e-3), (0.25e-3, 0.012, 4e-3),
                                (0.25e-3, 0.024, 4e-3)):
        largest, mean, error, young, poisson = patch_error(radius, width, side)
        rows.append([1e3 * radius, 1e3 * width, 1e3 * side, f"{side / radius:.0f}", f"{young / 1e9:.2f}, {poisson:.2f}", f"{error:+.1f}", f"{largest:.2f}", f"{mean:.2f}"])
    return study.table(["r, mm", "L, mm", "h, mm", "h/r", "E, GPa, and nu of the elements", "strains differ, %", "largest, %", "mean, %"], rows)


# --- a notched beam of one packing, with and without elements at its sides --------------------------------------

BEAM = "scenes/bending-coupled.yaml"
FEET = """sets:
  - {name: left, select: {box: {min: [17 mm, 0 mm], max: [20.5 mm, 2 mm]}}, motion: {vx: 0, vy: 0}}
  - {name: right, select: {box: {min: [419.5 mm, 0 mm], max: [423 mm, 2 mm]}}, motion: {vy: 0}}
"""


def sections(text):
    """{name: lines} of a scene."""
    found = {}
    for line in text.splitlines(keepends=True):
        if line[0] not in " #\n":
            name = line.split(":")[0]
        if line[0] not in "#\n":
            found[name] = found.get(name, "") + line
    return found


def beams(settings=None, note=""):
    """The beam of particles only, and the same with elements beside its middle; `note` is a part of the names of runs
    with settings."""
    folder, parts = study.RUNS / "coupling", sections((study.ROOT / BEAM).read_text())
    folder.mkdir(parents=True, exist_ok=True)
    whole = dict(parts, sets=parts["sets"].replace("sets:\n", FEET))
    del whole["elements"], whole["couple"]
    for old, new in (("[150 mm, ", "[0 mm, "), ("[290 mm, ", "[440 mm, ")):
        whole["specimen"] = whole["specimen"].replace(old, new)
    path = folder / "beam-particles.yaml"
    path.write_text("".join(whole.values()))
    alone = study.run(f"coupling/beam-particles{note}", path, settings or {})
    position, radius = alone.results("particles/position") - alone.results("particles/displacement"), alone.results("particles/radius")
    keep = (position[:, 0] >= 0.15) & (position[:, 0] <= 0.29)
    np.savetxt(folder / "middle.txt", np.c_[position[keep, :2], radius[keep]], fmt="%.17g")
    porosity = 1 - np.sum(np.pi * radius**2) / (0.44 * 0.1 - 0.002 * 0.03)
    parts["specimen"] = f"specimen: {{file: middle.txt, group: 1, material: concrete, density_basis: bulk, porosity: {porosity:.6f}}}\n"
    parts["elements"] = parts["elements"].replace("specimens/", str(study.ROOT / "scenes/specimens") + "/")
    parts["couple"] = parts["couple"].replace("150.8 mm", "150.2 mm").replace("289.2 mm", "289.8 mm")
    path = folder / "beam-coupled.yaml"
    path.write_text("".join(parts.values()))
    return alone, study.run(f"coupling/beam-coupled{note}", path, settings or {})


def crack(result):
    """Initial positions of broken bonds."""
    x = result.results("particles/position") - result.results("particles/displacement")
    broken = result.results("bonds/state") > 0
    return 0.5 * (x[result.results("bonds/i")[broken]] + x[result.results("bonds/j")[broken]])


def main():
    study.put("coupling.md", "table short", coupling_packings.short_table(lambda width, length, side, how: wave(width, length, side, how, True)))
    study.put("coupling.md", "table behind", behind_table(False))
    study.put("coupling.md", "table behind back", behind_table(True))
    study.put("coupling.md", "table bar", coupling_packings.bar_table())
    study.put("coupling.md", "table packing", coupling_packings.packing_table())
    study.put("coupling.md", "table forth", wave_table(False))
    study.put("coupling.md", "table back", wave_table(True))
    study.put("coupling.md", "table patch", patch_table())


if __name__ == "__main__":
    main()
