"""The part of a report that belongs to a laboratory test: readings as tiles, curves, times and places of broken bonds,
the specimen before, at and after the peak."""
import io
import json
import os
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from report_curves import BLUE, GREY, INK, RED, abscissa, new_axes, plot_force_over, save, style_for
from report_cutting import CURVES as CUTTING_CURVES
from report_files import opened, remove, values as values_of, write
from report_pictures import Specimen, Surface, cut, color_bar, draw_circles, panels, scale_bar
from report_results import quantity, scale_of


def cards_of(results):
    """[(reading, title)]: the readings that a report on this test shows first."""
    tested = [tuple(line.split(": ", 1)) for line in results.attribute("test_figures").splitlines()]
    return (*tested, ("returned_energy", "energy returned by the zone"))


# --- curves --------------------------------------------------------------------------------------------

def plot_confined(results, path):
    """Deviator and loss of volume over the axial strain."""
    strain, stress, volume = (results.in_last_stage(n) for n in ("strain", "stress", "volumetric_strain"))
    lateral = results.in_last_stage("lateral_strain")
    if strain is None or stress is None or volume is None or lateral is None:
        return None
    factor, unit = scale_of(stress, "Pa")
    figure, (above, below) = plt.subplots(2, 1, figsize=(6.4, 5.2), sharex=True, constrained_layout=True,
                                          gridspec_kw={"height_ratios": [2, 1]})
    above.set_title(f"Deviator and volume{results.of_stage}")
    above.plot(100 * strain, stress / factor, color=INK, **style_for(stress))
    above.set_ylabel(f"deviator [{unit}]")
    below.plot(100 * strain, 100 * volume, color=BLUE, label="volumetric", **style_for(volume))
    below.plot(100 * strain, 100 * lateral, color=RED, label="lateral", **style_for(lateral))
    below.set_xlabel("axial strain [%]")
    below.set_ylabel("strain [%]")
    below.legend(loc="best")
    save(figure, path)
    return ("Deviator, loss of volume and lateral strain (averages of the specimen, compression positive) over the platen strain."
            + (" Strains count from the start of the stage." if results.of_stage else ""))


def plot_lateral(results, path):
    """Draws an oedometer test: axial stress and the mean stress across, compression positive, over the strain."""
    strain, stress = results.in_last_stage("strain"), results.in_last_stage("stress")
    across = [results.in_last_stage("stress_" + 2 * a) for k, a in enumerate("xyz"[: results.dimension]) if k != results.test_axis()]
    if "lateral_stress_ratio" not in results.readings or strain is None or stress is None or any(a is None for a in across):
        return None
    lateral = -np.mean(across, axis=0)
    factor, unit = scale_of(np.concatenate([stress, lateral]), "Pa")
    figure, axes = new_axes(f"Stress along and across{results.of_stage}", "axial strain [%]", f"stress [{unit}]")
    for values, color, label in ((stress, INK, "axial, of the ends"), (lateral, BLUE, "across, mean of the specimen")):
        axes.plot(100 * strain, values / factor, color=color, label=label, **style_for(values))
    axes.legend(loc="best")
    save(figure, path)
    return "Axial stress of the ends and mean stress of the specimen across, compression positive."


def plot_opening(results, path):
    return plot_force_over(results, path, "opening", "the opening of the gauge.")


def plot_centre(results, path):
    """Ratio of the stress around the middle of a disc to the theoretical one."""
    stress = results.in_last_stage("stress")
    parts = [(n, results.in_last_stage("centre_stress_" + n)) for n in ("xx", "yy")]
    if stress is None or any(v is None for _, v in parts):
        return None
    factor, unit = scale_of(np.concatenate([stress] + [v for _, v in parts]), "Pa")
    figure, axes = new_axes(f"The middle of the disc{results.of_stage}", f"2P/(πDt) [{unit}]", f"mean stress, tension positive [{unit}]")
    top = np.nanmax(stress) / factor
    for slope, label in ((1, "across, between line loads"), (-3, "along, between line loads")):
        axes.plot([0, top], [0, slope * top], color=GREY, lw=1, dashes=(6, 2), label=label)
    rows = np.arange(len(stress)) <= np.nanargmax(stress)
    for (name, values), color in zip(parts, (RED, BLUE)):
        axes.plot(stress[rows] / factor, values[rows] / factor, color=color, label=f"σ$_{{{name}}}$", **style_for(values))
    axes.legend(loc="best")
    save(figure, path)
    return "Mean stress about the middle of the disc up to the peak, beside Hondros' for two line loads (dashed)."


def plot_shear(results, path):
    strain, normal, dilation = (results.in_last_stage(n) for n in ("strain", "normal_stress", "dilation"))
    if strain is None or normal is None or dilation is None:
        return None
    n_factor, n_unit = scale_of(normal, "Pa")
    d_factor, d_unit = scale_of(dilation, "m")
    figure, (above, below) = plt.subplots(2, 1, figsize=(6.4, 4.4), sharex=True, constrained_layout=True)
    above.set_title(f"Normal stress and dilation{results.of_stage}")
    above.plot(100 * strain, normal / n_factor, color=INK, **style_for(normal))
    above.set_ylabel(f"normal stress [{n_unit}]")
    below.plot(100 * strain, dilation / d_factor, color=BLUE, **style_for(dilation))
    below.set_ylabel(f"dilation [{d_unit}]")
    below.set_xlabel("shear strain [%]")
    save(figure, path)
    return "Across the sheared plane: stress, and how far the ends came apart."


def plot_breaking(results, path):
    """Plots the number of bonds broken per row, like the rate of acoustic events, if there is no list of events."""
    x, label = abscissa(results)
    tension, shear = results.column("broken_tension"), results.column("broken_shear")
    if x is None or tension is None or shear is None or results.rows < 3 or "time" in results.events:
        return None
    rate = np.maximum(0, np.diff(tension)), np.maximum(0, np.diff(shear))
    if not np.nansum(rate[0] + rate[1]) > 0:
        return None
    there = np.isfinite(x[1:])
    count = int(there.sum())
    if count < 2:
        return None
    bins = min(120, count)
    group = (np.arange(count) * bins) // count
    at, rate = x[1:][there], [values[there] for values in rate]
    centre = np.array([at[group == k].mean() for k in range(bins)])
    width = (np.ptp(at) or 1.0) / bins
    figure, axes = new_axes("Breaking bonds", label, "bonds that break per interval", 3.2)
    bottom = np.zeros(bins)
    for values, color, name in ((rate[0], RED, "in tension"), (rate[1], BLUE, "in shear")):
        height = np.array([np.nansum(values[group == k]) for k in range(bins)])
        axes.bar(centre, height, width=width, bottom=bottom, color=color, label=name)
        bottom += height
    axes.legend(loc="upper left")
    save(figure, path)
    return f"Bonds that broke in each of {bins} equal intervals of the history, by cause."


def broken_normals(results):
    """Directions of the bonds that broke, as they are at the end; None where there are none."""
    state, position = results.bond_state, results.particle("position")
    if position is None or "i" not in results.bonds or not np.isin(state, (1, 2)).any():
        return None
    i, j = (np.asarray(results.bonds[k].value, int).reshape(-1) for k in ("i", "j"))
    displacement = results.particle("displacement")
    start = np.asarray(position, float) - (0 if displacement is None else np.asarray(displacement, float))
    branch = np.pad(start.reshape(len(start), -1), ((0, 0), (0, 2)))[:, :3]
    branch = (branch[j] - branch[i])[np.isin(state, (1, 2))]
    length = np.linalg.norm(branch, axis=1)
    good = np.isfinite(length) & (length > 0)
    return branch[good] / length[good, None] if good.any() else None


def plot_rose(results, path):
    """Cracks by their angle with the axis of the test: a bond that broke is a crack across it."""
    normals = broken_normals(results)
    if normals is None:
        return None
    axis = results.test_axis()
    along = np.abs(normals[:, axis])
    angle = np.degrees(np.arcsin(np.clip(along, 0, 1)))  # angle of the crack's plane with the axis
    edges = np.linspace(0, 90, 19)
    counts, _ = np.histogram(angle, edges)
    sines = np.sin(np.radians(edges))
    share = np.diff(edges) / 90 if results.dimension == 2 else np.diff(sines)  # share of uniformly distributed directions
    figure = plt.figure(figsize=(6.4, 4.0), constrained_layout=True)
    axes = figure.add_subplot(projection="polar")
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    axes.set_thetamin(0)
    axes.set_thetamax(90)
    density = counts / share / counts.sum()
    axes.bar(np.radians(0.5 * (edges[1:] + edges[:-1])), density, width=np.radians(5), color=RED, alpha=0.8)
    axes.plot(np.radians(np.linspace(0, 90, 50)), np.ones(50), color=GREY, lw=1)
    axes.set_title("Directions of cracks")
    save(figure, path)
    return (f"{counts.sum()} broken bonds by the angle of their crack with the axis {'xyz'[axis]}, at the places of the start; 1 "
            "(grey): as many as if cracks had no preferred direction.")


def fragment_sizes(results):
    """Particles in the pieces that bonds still hold, the most first; None without bonds."""
    sizes = results.fragments.get("particles")
    return np.sort(np.asarray(sizes.value, int).reshape(-1))[::-1] if sizes is not None and np.size(sizes.value) else None


def plot_fragments(results, path):
    sizes = fragment_sizes(results)
    if sizes is None or len(sizes) < 2:
        return None
    figure, axes = new_axes("Fragments", "particles in a fragment", "fragments with as many or more", 3.2)
    axes.loglog(sizes, np.arange(1, len(sizes) + 1), "o", color=INK, ms=3)
    save(figure, path)
    return f"{len(sizes)} pieces that bonds connect at the end, including single particles; the largest has {sizes[0]} particles."


CURVES = {
    "confined": plot_confined,
    "lateral": plot_lateral,
    "force_opening": plot_opening,
    "centre": plot_centre,
    "shear": plot_shear,
    "breaking": plot_breaking,
    "rose": plot_rose,
    "fragments": plot_fragments,
    **CUTTING_CURVES,
}
STATES = ("rose", "fragments")  # pictures of the state at the end, which need no rows of the history


# --- before, at and after the peak ----------------------------------------------------------------------

def snapshots(folder):
    """[(time, path)] of particles; empty where there are none."""
    try:
        with open(os.path.join(folder, "particles.hdf.series"), encoding="utf-8") as file:
            entries = json.load(file)["files"]
        named = [(float(e["time"]), os.path.join(folder, os.path.basename(e["name"]))) for e in entries]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    return [(time, path) for time, path in named if os.path.isfile(path)]


class At:
    """Results with the particles of a snapshot."""

    def __init__(self, results, path):
        self._results = results
        self._found = {}
        with opened(path, "a snapshot", "without particles.hdf.series the report does without snapshots") as file:
            self._found["position"] = values_of(file, "VTKHDF/Points")
            for name in ("radius", "displacement", "damage", "removed"):
                if "PointData/" + name in file["VTKHDF"]:
                    self._found[name] = values_of(file, "VTKHDF/PointData/" + name)

    def particle(self, name):
        return self._found.get(name)

    def __getattr__(self, name):
        return getattr(self._results, name)


def moments(results, folder):
    """[(title, results, file, time)]: the first snapshot, the one with most of the peak's stress, the last."""
    time, stress = results.in_last_stage("time"), results.in_last_stage("stress")
    taken = snapshots(folder)
    if time is None or stress is None or len(taken) < 3 or not results.particle_count:
        return []
    peak = np.nanmax(stress)
    held = [float(np.interp(at, time, np.nan_to_num(stress))) for at, _ in taken]  # a broken bar would be near its peak in time as well
    most = int(np.argmax(held))
    share = f"near the peak ({held[most] / peak:.2f} of it)" if peak > 0 else "near the peak"
    chosen = []
    for title, (at, path) in (("before", taken[0]), (share, taken[most]), ("at the end", taken[-1])):
        factor, unit = scale_of([max(taken[-1][0], 1e-30)], "s")
        try:
            chosen.append((f"{title}, {float(f'{at / factor:.3g}'):g} {unit}", At(results, path), path, at))
        except (OSError, KeyError):
            return []
    return chosen


def plot_moments(results, folder, path):
    chosen = [(title, Specimen(at, file, time)) for title, at, file, time in moments(results, folder)]
    if not chosen or any(s.count == 0 for _, s in chosen):
        return None
    last = chosen[-1][1]
    by_name = [{c[0]: c for c in s.colorings()} for _, s in chosen]
    name = "Damage" if all("Damage" in found for found in by_name) else "Displacement"
    colorings = [found[name] for found in by_name]
    _, _, colors, norm, label = colorings[-1]
    size = (last.upper - last.lower)[:2]
    figure, axes = panels(3, size[0] / size[1], min(4.6, 1.2 + 7.0 * size[1] / size[0]))
    factors = [s.displacement_scale()[0] for _, s in chosen]
    for a, (title, specimen), (name, values, *_), factor in zip(axes, chosen, colorings, factors):
        if name == "Displacement":
            values = values * factor / factors[-1]
        left, right, bottom, top = specimen.window()
        if specimen.flat:
            index, centres, radii = cut(specimen)
            draw_circles(a, centres, radii, colors(norm(values[index])), "#00000055")
            specimen.beside.draw_cut(a, specimen.middle[2], (left, right, bottom, top), True)
            a.set_xlim(left, right)
            a.set_ylim(bottom, top)
            scale_bar(a, np.array([left, bottom]), np.array([right, top]))
        else:
            Surface(specimen).draw(a, colors(norm(values)))
        a.set_title(title)
    color_bar(figure, axes[-1], norm, colors, label, "neither")
    save(figure, path)
    return "The specimen at the first snapshot, at the one with most of the stress of the peak, and at the last."


# --- parameters and tables -------------------------------------------------------------------------------

UNITS = {  # units by the last word of a key
    "density": "kg/m3", "contact_modulus": "Pa", "normal_stiffness": "N/m", "young": "Pa", "tensile_strength": "Pa", "shear_strength": "Pa",
    "bond_tension_limit": "N", "bond_shear_limit": "N", "fracture_energy": "J/m2", "shear_fracture_energy": "J/m2", "yield_stress_1": "Pa",
    "yield_stress_2": "Pa", "yield_stress_3": "Pa", "pressure": "Pa", "ramp": "s", "length": "m", "area": "m2", "diameter": "m",
    "thickness": "m", "span": "m", "load_span": "m", "height": "m", "notch": "m", "depth": "m", "spacing": "m", "run_in": "m",
    "peak_window": "m", "compressive_strength": "Pa",
}
BY_AREA = ("dempack", "polyhedron")
NOTHING = ("none", "auto", "off", "same", "free", "test", "false", "[]")


def _is(scene, path, *values):
    return scene.get(path) in values


def _above(scene, path):
    return any(float(v) > 0 for p, v in scene.items() if p.split("/")[0] + "/" + p.split("/")[-1] == path and re.fullmatch(r"[-+.\de]+", v))


# Conditions under which a key has an effect, by its place; keys not listed always have one.
NEEDS = {
    "materials/alpha": lambda s: _is(s, "law/stiffness", *BY_AREA), "materials/beta": lambda s: _is(s, "law/stiffness", *BY_AREA),
    "materials/young": lambda s: _is(s, "law/stiffness", "hertz", *BY_AREA), "materials/poisson": lambda s: _is(s, "law/stiffness", "hertz", *BY_AREA),
    "materials/contact_modulus": lambda s: not _is(s, "law/stiffness", "uniform", "hertz", *BY_AREA),
    "materials/kratio": lambda s: not _is(s, "law/stiffness", "hertz", *BY_AREA),
    "materials/normal_stiffness": lambda s: _is(s, "law/stiffness", "uniform"),
    "materials/tensile_strength": lambda s: not _is(s, "law/stiffness", "uniform", "hertz") and _is(s, "bonds/enabled", "on"),
    "materials/shear_strength": lambda s: not _is(s, "law/stiffness", "uniform", "hertz") and _is(s, "bonds/enabled", "on"),
    "law/gamma": lambda s: _is(s, "law/stiffness", *BY_AREA), "law/gamma_rule": lambda s: _is(s, "law/stiffness", *BY_AREA),
    "law/pull": lambda s: _is(s, "law/stiffness", "hertz"),
    "law/confinement": lambda s: _above(s, "materials/bond_friction"),
    **{f"law/{key}": (lambda s: not _is(s, "law/softening", "none")) for key in ("softening_curve", "fracture_energy_of")},
    **{f"law/{key}": (lambda s: _is(s, "law/softening_curve", "bilinear")) for key in ("kink_stress", "initial_energy")},
    **{f"bonds/{key}": (lambda s: _is(s, "bonds/enabled", "on")) for key in ("interaction_range", "overlap_range", "passive_gaps", "radius_multiplier")},
    "bonds/moment_share": lambda s: _above(s, "bonds/radius_multiplier"),
    **{f"damping/background/{key}": (lambda s: not _is(s, "damping/background/model", "none")) for key in ("coefficient", "rotation")},
    "damping/background/velocity": lambda s: _is(s, "damping/background/model", "nonviscous_component"),
    "test/centre": lambda s: _is(s, "test/kind", "brazilian"),
}
# For these keys 0 is equivalent to leaving them out.
ZEROS = ("friction", "rolling_friction", "twisting_friction", "bond_friction", "radius_multiplier", "interaction_range")


def scene_values(text, sections):
    """{"law/stiffness": "harmonic", "materials/rock/density": "2650", ..}: values of the resolved scene in these sections."""
    found = {}
    for section in sections:
        block = re.search(rf"^{section}:\n(.*?)(?=^\S|\Z)", text, re.MULTILINE | re.DOTALL)
        above, name = [], ""
        for line in block[1].splitlines() if block else []:
            depth = (len(line) - len(line.lstrip(" -"))) // 2
            key, _, value = line.strip().lstrip("- ").partition(":")
            value = value.strip().strip('"')
            if key == "name" and line.strip().startswith("-"):
                name, above = value, [value]
                continue
            above = above[: depth - 1] + [key]
            if value:
                inner = above[1:] if name else above
                found["/".join([section, *([name] if name else []), *inner])] = value
    return found


def parameter_text(key, value):
    """A value as text with few digits and its unit: 10 GPa, 0.7."""
    try:
        number = float(value)
    except ValueError:
        return value
    return quantity(number, UNITS.get(key, "1"), 6)


def parameters(results):
    """(name, value) of the most important settings that have an effect in this scene: test, materials, bonds, damping, membrane."""
    scene = scene_values(results.scene, ("test", "membrane", "materials", "law", "bonds", "damping"))
    several = len({path.split("/")[1] for path in scene if path.startswith("materials/")}) > 1
    rows = []
    for path, value in scene.items():
        parts = path.split("/")
        place = "materials/" + "/".join(parts[2:]) if parts[0] == "materials" else path
        if value in NOTHING or not NEEDS.get(place, lambda s: True)(scene) or (parts[-1] in ZEROS and float(value) == 0):
            continue
        shown = parts if several or parts[0] != "materials" else [parts[0], *parts[2:]]
        name = parts[1] if several and parts[0] == "materials" else None  # the name of a material, which is shown unchanged
        rows.append((" · ".join(part if part == name else part.replace("_", " ") for part in shown), parameter_text(parts[-1], value)))
    return rows


def write_columns(path, columns):
    """A table with a column each, and its unit in the header; vectors are shown as x y z."""
    table, heads = [], []
    for name, column in columns.items():
        values = np.asarray(column.value, float)
        values = values.reshape(len(values), -1)
        for k in range(values.shape[1]):
            heads.append(f"{name}{'_' + 'xyz'[k] if values.shape[1] > 1 else ''} [{column.unit}]")
            table.append(values[:, k])
    text = io.StringIO()
    np.savetxt(text, np.stack(table, axis=1), delimiter=",", header=",".join(heads), comments="", fmt="%.10g")
    write(path, text.getvalue())


def write_csv(results, folder):
    """Links to the history beside the page, and to bursts and fragments if there are some."""
    for name, columns in (("report", results.history if results.rows else {}), ("report_bursts", results.bursts),
                          ("report_fragments", results.fragments)):
        path = os.path.join(folder, name + ".csv")
        if any(np.size(column.value) for column in columns.values()):
            write_columns(path, columns)
        else:
            remove(path)


__all__ = ["CURVES", "STATES", "cards_of", "parameters", "plot_moments", "write_csv"]
