"""make_results.py KIND FILE [PACKING]: a made-up results.h5 (docs/results.md) or packing.h5 (docs/packing.md), for the
tests of the report. Nothing in it is a result of the engine. Kinds: see KINDS and PACKINGS.
"""
import os
import re
import sys

import h5py
import numpy as np


def lattice(dimension):
    """Positions and radii of a small specimen with its axis along the last direction used."""
    rng = np.random.default_rng(7)
    spacing = 2e-3
    if dimension == 2:
        x, y = np.meshgrid(np.arange(14), np.arange(24))
        x = x + 0.5 * (y % 2)
        y = y * np.sqrt(0.75)
        grid = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    else:
        grid = np.stack(np.meshgrid(np.arange(9), np.arange(9), np.arange(18), indexing="ij"), axis=-1)
        grid = grid.reshape(-1, 3).astype(float)
        grid = grid[np.hypot(*(grid[:, :2] - 4).T) < 4.4]
    radius = spacing * rng.uniform(0.44, 0.5, len(grid))
    return grid * spacing, radius


def bonds_of(position, radius):
    """Pairs with a gap of up to 5 % of the sum of radii, in blocks to bound the memory."""
    found = []
    for start in range(0, len(radius), 256):
        block = slice(start, start + 256)
        distance = np.linalg.norm(position[block, None] - position[None], axis=2)
        i, j = np.nonzero(distance <= 1.05 * (radius[block, None] + radius[None]))
        found.append(np.stack([i + start, j], axis=1))
    pairs = np.concatenate(found)
    return pairs[pairs[:, 0] < pairs[:, 1]]


class Writer:
    def __init__(self, path):
        self.file = h5py.File(path, "w")

    def put(self, name, value, unit="1", text="made up", **more):
        data = self.file.create_dataset(name, data=np.asarray(value))
        data.attrs.update({"unit": unit, "description": text, **more})


def put_history(writer, rows, test, dimension):
    t = np.linspace(0, 4e-3, rows)
    s = t / 4e-3
    rng = np.random.default_rng(3)
    writer.put("history/step", (s * 40000).astype(np.int64))
    writer.put("history/time", t, "s")
    peak = 0.82
    stress = np.where(s < peak, 240e6 * (s / peak) * (1 - 0.06 * (s / peak) ** 3) / 0.94,
                      240e6 * np.exp(-((s - peak) / 0.05) ** 2))
    strain = 1.75e-2 * s
    if test:
        writer.put("history/strain", strain)
        writer.put("history/stress", stress + 2e5 * rng.standard_normal(rows), "Pa")
        writer.put("history/stress_lower", stress + 2e6 * rng.standard_normal(rows), "Pa")
        writer.put("history/stress_upper", stress + 2e6 * rng.standard_normal(rows), "Pa")
    axial, lateral = -strain, 0.17 * strain + 2e-2 * np.maximum(0, s - peak)
    values = {"xx": lateral, "yy": axial if dimension == 2 else 0.98 * lateral, "zz": 0 * s if dimension == 2 else axial}
    for name, value in values.items():
        writer.put(f"history/strain_{name}", value)
    writer.put("history/unbalanced", 1e-3 + 0.02 * np.exp(-((s - peak - 0.04) / 0.03) ** 2) + 1e-2 * np.exp(-s * 30))
    broken = 6000 / (1 + np.exp(-(s - peak - 0.03) * 60))
    writer.put("history/broken_tension", np.round(0.55 * broken).astype(np.int64))
    writer.put("history/broken_shear", np.round(0.45 * broken).astype(np.int64))
    work = np.concatenate([[0], np.cumsum(0.5 * (stress[1:] + stress[:-1]) * np.diff(strain))]) * 1.9e-5 if rows else s
    released = np.maximum(0, work - stress ** 2 / 2 / 20e9 * 1.9e-5)
    stored = work - released
    for name, kind, part, total in (
            ("elastic_normal", "stored", 0.7, stored), ("elastic_shear", "stored", 0.22, stored),
            ("elastic_wall", "stored", 0.07, stored), ("kinetic", "stored", 0.01, stored), ("rotational", "stored", 0.0, stored),
            ("friction", "lost", 0.35, released), ("background_damping", "lost", 0.3, released),
            ("bond_breaking", "lost", 0.35, released), ("work_walls", "input", 1.0, work)):
        writer.put(f"history/energy_{name}", part * total, "J")
        writer.put(f"energy/{name}", float((part * total)[-1]) if rows else 0.0, "J", kind=kind)
    writer.put("history/energy_residual", 1e-4 * s * np.sin(9 * s))
    for axis in "xyz":
        writer.put(f"history/wall_top_force_{axis}", -stress * 4.15e-4 * (axis == "z"), "N")
    writer.put("energy/residual", 1e-4)
    writer.put("energy/stored_at_start", 0.0, "J")


def sizes_of(pairs, count):
    """Particles in the pieces that pairs hold together, the most first."""
    label = np.arange(count)
    for _ in range(count):
        new = label.copy()
        np.minimum.at(new, pairs[:, 0], label[pairs[:, 1]])
        np.minimum.at(new, pairs[:, 1], label[pairs[:, 0]])
        if np.array_equal(new, label):
            break
        label = new
    return np.sort(np.unique(label, return_counts=True)[1])[::-1]


def put_state(writer, position, radius, dimension, with_bonds):
    rng = np.random.default_rng(5)
    axis = dimension - 1
    middle = 0.5 * (position.min(axis=0) + position.max(axis=0))
    span = np.ptp(position, axis=0)
    across = (position - middle)[:, 0] / span[0] + 0.62 * (position - middle)[:, axis] / span[axis]
    side = np.tanh(25 * across)
    displacement = np.zeros_like(position)
    displacement[:, 0] = 3e-4 * side
    displacement[:, axis] = -1.75e-2 * (position - middle)[:, axis] - 2e-4 * side
    loose = rng.random(len(radius)) < 0.004
    displacement[loose] *= 6
    writer.put("particles/position", position + displacement, "m")
    writer.put("particles/radius", radius, "m")
    writer.put("particles/displacement", displacement, "m")
    writer.put("particles/velocity", 0 * position, "m/s")
    writer.put("particles/removed", np.zeros(len(radius), np.uint8))
    pairs = bonds_of(position, radius) if with_bonds else np.zeros((0, 2), int)
    at_plane = np.exp(-(0.5 * (across[pairs[:, 0]] + across[pairs[:, 1]]) / 0.05) ** 2)
    broken = rng.random(len(pairs)) < 0.02 + 0.85 * at_plane
    state = np.where(broken, np.where(rng.random(len(pairs)) < 0.55, 1, 2), 0).astype(np.uint8)
    at_start = np.bincount(pairs.ravel(), minlength=len(radius))
    if with_bonds:
        sizes = sizes_of(pairs[~broken], len(radius))
        writer.put("fragments/particles", sizes.astype(np.int32))
        writer.put("fragments/centre", np.outer(sizes, [1.0, 2.0, 3.0]), "m")
    lost = np.bincount(pairs[broken].ravel(), minlength=len(radius))
    writer.put("particles/damage", lost / np.maximum(1, at_start))
    if with_bonds:
        writer.put("bonds/i", pairs[:, 0].astype(np.int32))
        writer.put("bonds/j", pairs[:, 1].astype(np.int32))
        writer.put("bonds/state", state)
        writer.put("bonds/broken_time", np.where(broken, 3.4e-3, np.nan), "s")


WITH_EVENTS = ("cylinder", "disc")


def put_events(writer):
    """Bonds break late in the run; some soften before, so that the report draws their state."""
    time = np.asarray(writer.file["history/time"])
    state = np.asarray(writer.file["bonds/state"])
    state[:40][state[:40] == 0] = 4
    state[40:60][state[40:60] == 0] = 5
    writer.file["bonds/state"][...] = state
    some = np.flatnonzero(state)
    writer.put("events/time", np.sort(time[-1] * np.random.default_rng(7).random(len(some)) ** 0.3), "s")
    writer.put("events/cause", state[some])
    for name in "ij":
        writer.put(f"events/{name}", np.asarray(writer.file[f"bonds/{name}"])[some])
    writer.put("bursts/time", time[-1] * np.array([0.5, 0.7, 0.75, 0.85, 0.9]), "s")
    writer.put("bursts/size", np.array([1, 1, 3, 40, 2], np.int32))


def put_readings(writer, missing):
    nan = float("nan")
    for name, value, unit in (("young_modulus", 18.1e9, "Pa"), ("poisson_ratio", 0.17, "1"),
                              ("peak_stress", 240e6, "Pa"), ("peak_strain", 1.435e-2, "1"),
                              ("plane_young_modulus", nan, "Pa")):
        writer.put(f"readings/{name}", nan if missing else value, unit)
        if missing:
            writer.file[f"readings/{name}"].attrs["absent"] = "made-up <reason>"
    if not missing:  # an error budget
        budget = writer.file["readings/peak_stress"].attrs
        budget["error"], budget["error_causes"] = 6.24e6, "(velocity 1.2e+06 measured, packing 6.1e+06 estimated)"
    writer.put("readings/largest_stress", 241e6, "Pa")
    writer.put("readings/largest_strain", 1.5e-2)


# dimension, rows, test, bonds, finished, broken readings
KINDS = {
    "cylinder": (3, 800, True, True, True, False),
    "disc": (2, 400, True, True, True, False),
    "no_test": (3, 300, False, True, True, True),
    "no_bonds": (3, 300, True, False, True, False),
    "no_rows": (3, 0, False, True, True, True),
    "one_row": (2, 1, True, True, True, True),
    "two_rows": (3, 2, True, True, True, True),
    "unfinished": (3, 120, True, True, False, True),
    "not_a_number": (3, 200, True, True, True, True),
    "stages": (2, 200, True, True, True, True),
    "no_particles": (3, 50, False, False, True, True),
}


WARNINGS = {"disc": "energy_residual: 0.03 of 1 J <&>\nend_imbalance: by half"}


def make(kind, path, packing=None):
    dimension, rows, test, with_bonds, finished, missing = KINDS[kind]
    writer = Writer(path)
    attributes = dict(title=f"Made-up {kind} <&>", scene_file="made-up.yaml", version="0.1.0", build="gcc 12 release",
                      isa="avx2", precision="double", threads=2, effects="space bonds", state_hash="0123456789abcdef",
                      finished=int(finished), stop_reason="peak_drop: stress fell to half its peak" if finished else "",
                      dimension=dimension, volume=1.9e-5, volume_of="the <shape>", warnings=WARNINGS.get(kind, ""))
    for name, value in attributes.items():
        writer.file.attrs[name] = value
    if test:
        writer.file.attrs["test_figures"] = "young_modulus: Young's modulus\npoisson_ratio: Poisson's ratio\npeak_stress: peak stress\npeak_strain: strain at the peak"
    axis = "y" if dimension == 2 else "z"
    scene = f"title: made-up <&>\ndimension: {dimension}\n"
    writer.file["scene"] = scene + (f"test:\n  kind: compression\n  axis: {axis}\nseed: 1\n" if test else "")
    put_history(writer, rows, test, dimension)
    if kind == "stages":  # the second stage has no rows, the fourth has not begun
        writer.file.attrs["stages"] = "settle\nbond\nload\nunload"
        writer.put("history/stage", np.where(np.arange(rows) < rows // 4, 0.0, 2.0))
        for name, largest in (("settle", 60e6), ("bond", float("nan")), ("load", 241e6)):
            writer.put(f"stages/{name}/readings/largest_stress", largest, "Pa")
            writer.put(f"stages/{name}/readings/peak_stress", float("nan"), "Pa", absent="no bond has broken")
    if packing:
        data = np.loadtxt(packing)
        position, radius = data[:, :3], data[:, 3]
    else:
        position, radius = lattice(dimension)
    if kind != "no_particles":
        put_state(writer, position, radius, dimension, with_bonds)
    if kind in WITH_EVENTS:
        put_events(writer)
    put_readings(writer, missing)
    for name, seconds in (("contacts", 12.1), ("gather", 3.2), ("motion", 2.1), ("neighbours", 0.8), ("measure", 0.4),
                          ("output", 0.2)):
        writer.put(f"profile/{name}", seconds, "s", "")
    if kind == "not_a_number":
        for name in ("stress", "strain", "unbalanced"):
            writer.file[f"history/{name}"][100:] = np.nan
        writer.file["history/broken_shear"][...] = 0
        writer.file["history/strain_yy"][...] = np.nan
        writer.file["particles/position"][3] = np.nan
    writer.file.close()


# --- packing.h5 ----------------------------------------------------------------------------------------

QUALITY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "src", "pack", "quality.h")


def figures_of_quality():
    """{name: (unit, text)} of GN_PACK_FIGURES, as the program writes them."""
    with open(QUALITY, encoding="utf-8") as file:
        macro = re.search(r"#define GN_PACK_FIGURES\(X\)(.*?[^\\])\n", file.read(), re.DOTALL)[1]
    found = re.findall(r'X\((\w+),\s*"([^"]*)",((?:[\s\\]*"[^"]*")+)\)', macro)
    assert len(found) == len(re.findall(r"X\(\w+,", macro)), "GN_PACK_FIGURES could not be read"
    return {name: (unit, "".join(re.findall(r'"([^"]*)"', text))) for name, unit, text in found}


def measure(position, radius, pairs, gap, dimension):
    """Some figures are real, the others invented: small and all different."""
    figures = {name: 0.011 + 0.001 * k for k, name in enumerate(figures_of_quality())}
    figures.update(porosity=0.3236, anisotropy=0.0149, radius_mean=radius.mean(), radius_min=radius.min(),
                   radius_max=radius.max(), radius_ratio=radius.max() / radius.min(), radius_volume=radius.mean(),
                   fabric_min=0.99 / dimension, fabric_max=1.01 / dimension)
    for name, tolerance in (("01", 0.001), ("1", 0.01), ("5", 0.05)):
        figures["coordination_" + name] = 2 * np.count_nonzero(gap <= tolerance) / len(radius)
    overlap = -gap[gap < -1e-9]
    if not len(overlap):
        figures.update(overlap_median=0.0, overlap_mean=0.0, overlap_max=0.0, overlaps=0.0)
    return figures


def count_directions(normal):
    turn = np.arctan2(normal[:, 1], normal[:, 0]) / (2 * np.pi)
    around = np.concatenate([turn, turn + 0.5]) % 1
    return (np.histogram(around, 36, (0, 1))[0], 2 * np.histogram(np.abs(normal[:, 2]), 36, (0, 1))[0])


def put_quality(writer, position, radius, dimension):
    pairs = bonds_of(position, radius)
    branch = position[pairs[:, 1]] - position[pairs[:, 0]]
    length, reach = np.linalg.norm(branch, axis=1), radius[pairs].sum(axis=1)
    gap = (length - reach) / reach
    near = gap <= 0.01
    normal = branch[near] / length[near, None]
    writer.put("contacts/pair", pairs.astype(np.int32).reshape(-1, 2))
    writer.put("contacts/gap", gap)
    values = measure(position, radius, pairs, gap, dimension)
    for name, (unit, text) in figures_of_quality().items():
        writer.put(f"quality/{name}", [values[name]], unit, text)
    writer.put("quality/fabric", (normal.T @ normal / max(1, len(normal))).ravel())
    count, edge = np.histogram(radius, np.linspace(radius.min(), max(radius.max(), radius.min()), 25))
    writer.put("histogram/radius_edge", edge, "m")
    writer.put("histogram/radius_count", count.astype(np.int64))
    angle, polar = count_directions(normal)
    writer.put("histogram/angle_count", angle.astype(np.int64))
    writer.put("histogram/polar_count", polar.astype(np.int64))
    return len(pairs)


def put_trace(writer, rows):
    k = np.arange(rows)
    writer.put("trace/iteration", (k + 1).astype(np.int64))
    writer.put("trace/stage", np.minimum(4, 5 * k // max(1, rows)).astype(np.uint8))
    writer.put("trace/energy", 0.3 * np.exp(-0.1 * k) + 1e-6)
    writer.put("trace/gap_rms", 0.3 * np.exp(-0.06 * k))
    writer.put("trace/overlap_max", np.where(k == rows - 1, 0.0, 0.9 * np.exp(-0.05 * k)))
    writer.put("trace/pairs", np.full(rows, 4000, np.int64))


# dimension, factor on the radii, particles at most, iterations, in time, from the cache
PACKINGS = {
    "packed_cylinder": (3, 1.09, None, 90, 1, 0),
    "packed_square": (2, 1.09, None, 60, 1, 0),
    "cached": (3, 1.0, None, 0, 1, 1),
    "cached_square": (2, 1.09, None, 0, 1, 1),
    "cut_short": (3, 1.09, None, 1, 0, 0),
    "no_contacts": (3, 0.5, None, 20, 1, 0),
    "one_disc": (2, 1.0, 1, 2, 1, 0),
    "equal_radii": (3, None, None, 20, 1, 0),
}


def make_packing(kind, path):
    dimension, factor, most, rows, in_time, from_cache = PACKINGS[kind]
    position, radius = lattice(dimension)
    position = position[:most]
    radius = radius[:most] * factor if factor else np.full(len(radius), 1e-3)
    writer = Writer(path)
    pairs = put_quality(writer, position, radius, dimension)
    attributes = dict(kind="packing", version="0.1.0", build="gcc 12 release", title=f"Made-up {kind} <&> $1",
                      dimension=np.int64(dimension), seed=np.int64(11), particles=np.int64(len(radius)),
                      pairs=np.int64(pairs), volume=1.9112e-5 if dimension == 3 else 0.01, seconds=3.71,
                      in_time=np.int64(in_time), from_cache=np.int64(from_cache))
    for name, value in attributes.items():
        writer.file.attrs[name] = value
    writer.file["request"] = f"dimension: {dimension}\nspecimen: <made-up>\n"
    writer.put("particles/position", position, "m")
    writer.put("particles/radius", radius, "m")
    put_trace(writer, rows)
    writer.file.close()


if __name__ == "__main__":
    (make_packing if sys.argv[1] in PACKINGS else make)(*sys.argv[1:])
