"""Curves over strain (or time, when there is no test): stress, broken bonds, energies, quality."""
import io
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

from report_files import write
from report_results import scale_of

INK = "#22303c"
RED, BLUE, GREY = "#c8402f", "#2b6cb0", "#9aa5ad"
SHADES = {  # colours of terms of the ledger, by kind and name
    "stored": ("#41b6c4", "#9ecae1", "#1d4f91", "#2c7fb8", "#7fcdbb", "#c7e9b4", "#6a51a3", "#bcbddc"),
    "lost": ("#fec44f", "#b2182b", "#fff1a8", "#c7a76c", "#ef8a62", "#d95f0e", "#8c510a", "#bdbdbd", "#d6604d"),
}

plt.rcParams.update({
    "font.size": 10, "axes.labelcolor": INK, "axes.edgecolor": "#5c6b76", "text.color": INK,
    "axes.titlesize": 11, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": "#e5e9ec",
    "xtick.color": INK, "ytick.color": INK, "legend.frameon": False, "legend.fontsize": 9,
    "lines.linewidth": 1.6, "figure.dpi": 110, "savefig.dpi": 130,
})


def abscissa(results):
    """Returns (values, label) of the abscissa: strain in per cent of a test, otherwise time; with stages time, which
    always increases."""
    strain = results.column("strain")
    if strain is not None and not results.stages:
        return 100 * strain, f"{results.words[0]} [%]"
    time = results.column("time")
    if time is None:
        return None, ""
    factor, unit = scale_of(time, "s")
    return time / factor, f"time [{unit}]"


def new_axes(title, x_label, y_label, height=3.9):
    figure, axes = plt.subplots(figsize=(6.4, height), constrained_layout=True)
    axes.set_title(title)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    return figure, axes


def mark_stages(results, axes, x):
    """Marks where a stage begins, with its name, if x increases throughout."""
    for name, first, count in results.stages:
        axes.axvline(x[first], color=GREY, lw=0.8, dashes=(2, 2), zorder=0)
        if count:
            axes.annotate(name, (x[first], 1.0), xycoords=("data", "axes fraction"), xytext=(3, -2),
                          textcoords="offset points", rotation=90, va="top", fontsize=8, color="#5c6b76")


def place_legend(results, axes, loc="best"):
    """Places the legend clear of the curves if names of stages are drawn along the upper edge: above it beside a
    short title, otherwise at the right."""
    names = axes.get_legend_handles_labels()[1]
    if not results.stages:
        axes.legend(loc=loc)
    elif len("".join(names)) <= 30:
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(names), frameon=False, borderaxespad=0.2)
    else:
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def style_for(values):
    """One or two rows are drawn as points, because their line would be invisible."""
    return {"marker": "o", "markersize": 4} if np.isfinite(values).sum() < 3 else {}


def save(figure, path):
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png")
    write(path, drawn.getvalue())
    plt.close(figure)


def fit_line(results, strain, stress):
    """(slope, intercept, highest stress, E) from 1 % of the largest stress to elastic_stress; None when E could not be read. Where the
    section varies E is not the slope of the curve, which is that of a prism of the area: the line is fitted to the curve."""
    modulus = results.scalar(results.readings, "young_modulus")
    peak = int(np.nanargmax(stress))
    if not np.isfinite(modulus) or not stress[peak] > 0:
        return None
    rising = np.arange(len(stress)) <= peak
    until = results.scalar(results.readings, "elastic_stress")
    until = until if np.isfinite(until) else 0.5 * stress[peak]
    used = rising & (stress >= 0.01 * stress[peak]) & (stress <= until) & np.isfinite(strain)
    if not used.any():
        return None
    slope, over = modulus, strain[used] - np.mean(strain[used])
    if used.sum() > 2 and np.ptp(over) > 0:
        fitted = float(over @ stress[used] / (over @ over))
        slope = fitted if abs(fitted / modulus - 1) > 0.02 else modulus
    return slope, float(np.mean(stress[used] - slope * strain[used])), until, modulus


def peak_name(results):
    """A largest stress from which the curve has not fallen is not a peak."""
    known = "peak_stress" in results.readings
    return "largest" if known and not np.isfinite(results.scalar(results.readings, "peak_stress")) else "peak"


def plot_stress(results, path):
    strain, stress = results.in_last_stage("strain"), results.in_last_stage("stress")
    if strain is None or stress is None:
        return None
    factor, unit = scale_of(stress, "Pa")
    words = results.words
    figure, axes = new_axes(f"Stress and strain{results.of_stage}", f"{words[0]} [%]", f"{words[1]} [{unit}]")
    for name, style in (("stress_lower", "--"), ("stress_upper", ":")):
        end = results.in_last_stage(name)
        if end is not None:
            axes.plot(100 * strain, end / factor, style, color=GREY, lw=1,
                      label=name.replace("stress_", "at the ") + " end")
    axes.plot(100 * strain, stress / factor, color=INK, label="mean of both ends" if "stress_lower" in results.history else "in the specimen", **style_for(stress))
    peak = int(np.nanargmax(stress))
    line = fit_line(results, strain, stress)
    if line:
        slope, start, until, modulus = line
        top = np.array([0.0, 0.9 * stress[peak]])
        e_factor, e_unit = scale_of([modulus], "Pa")
        drawn = "" if slope == modulus else f"slope {slope / e_factor:.3g} {e_unit}, "
        axes.plot(100 * (top - start) / slope, top / factor, color=BLUE, lw=1.2, dashes=(6, 2), zorder=4,
                  label=f"{drawn}E = {modulus / e_factor:.3g} {e_unit} (fit 1–{100 * until / stress[peak]:.0f} %)")
        axes.axhspan(0.01 * stress[peak] / factor, until / factor, color=BLUE, alpha=0.05, lw=0)
    if stress[peak] > 0 and np.isfinite(strain[peak]):
        axes.plot(100 * strain[peak], stress[peak] / factor, "o", color=RED, ms=6, zorder=5,
                  label=f"{peak_name(results)} {stress[peak] / factor:.4g} {unit} at {100 * strain[peak]:.3g} %")
    for name, marker, text in (("crack_initiation_stress", "^", "cracks begin"), ("crack_damage_stress", "s", "damage: least volume")):
        level = results.scalar(results.readings, name)
        rows = np.flatnonzero(stress[: peak + 1] >= level) if np.isfinite(level) else []
        if len(rows):
            axes.plot(100 * strain[rows[0]], level / factor, marker, color=GREY, mec=INK, ms=6, zorder=5,
                      label=f"{text}, {level / factor:.3g} {unit}")
    axes.margins(x=0.02)
    axes.legend(loc="best")
    save(figure, path)
    return (f"{words[1][0].upper() + words[1][1:]} over {words[0]}, both positive in the sense of the test."
            + (" Strain counts from the start of the stage." if results.of_stage else ""))


def draw_stress_beside(results, axes, x, stress):
    """Draws a thin line with an axis of its own at the right, under the name of the stress if that is short."""
    factor, unit = scale_of(stress, "Pa")
    other = axes.twinx()
    other.grid(False)
    other.spines["right"].set_visible(True)
    other.plot(x, stress / factor, color=INK, lw=1, alpha=0.7)
    name = results.words[1] if len(results.words[1]) < 15 else "stress"
    other.set_ylabel(f"{name} [{unit}]\n(thin line)")
    other.set_ylim(bottom=min(0.0, float(np.nanmin(stress)) / factor))


def plot_broken(results, path):
    x, label = abscissa(results)
    tension, shear = results.column("broken_tension"), results.column("broken_shear")
    if x is None or tension is None or shear is None:
        return None
    if not np.nanmax(tension + shear) > 0:
        return None
    figure, axes = new_axes("Broken bonds", label, "broken bonds")
    axes.fill_between(x, tension + shear, color=GREY, alpha=0.18, lw=0, label="all")
    axes.plot(x, tension, color=RED, label="in tension", **style_for(tension))
    axes.plot(x, shear, color=BLUE, label="in shear", **style_for(shear))
    axes.set_ylim(bottom=0)
    stress = results.column("stress")
    if stress is not None:
        draw_stress_beside(results, axes, x, stress)
    axes.margins(x=0.02)
    place_legend(results, axes, "upper left")
    mark_stages(results, axes, x)
    save(figure, path)
    return "Broken bonds so far by cause, with the stress (thin line) for orientation."


EVENTS = ((4, "began to soften", "#e8c07d"), (5, "began to yield", "#8c510a"), (1, "broke in tension", RED), (2, "broke in shear", BLUE))


def plot_events(results, path):
    """Events of bonds per span of the run, by cause."""
    x, label = abscissa(results)
    time = results.column("time")
    if x is None or time is None or "time" not in results.events or not len(results.events["time"].value):
        return None
    known = np.isfinite(x) & np.isfinite(time)
    if np.count_nonzero(known) < 2 or np.ptp(x[known]) == 0:
        return None
    cause = np.asarray(results.events["cause"].value, int)
    at = np.interp(np.asarray(results.events["time"].value, float), time[known], x[known])
    edges = np.linspace(x[known].min(), x[known].max(), 81)
    shown = [event for event in EVENTS if np.any(cause == event[0])]
    figure, axes = new_axes("Events", label, "bonds per 1/80 of the run")
    axes.hist([at[cause == number] for number, _, _ in shown], edges, stacked=True, color=[color for _, _, color in shown],
              label=[f"{text} ({np.count_nonzero(cause == number)})" for number, text, _ in shown])
    axes.margins(x=0.02)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(loc="best")
    save(figure, path)
    return "How many bonds broke, and began to soften or to yield, as the test went on."


def plot_bursts(results, path):
    """Plots bursts per interval of the run beside the stress, with the numbers of broken bonds."""
    x, label = abscissa(results)
    time, stress = results.column("time"), results.column("stress")
    if x is None or time is None or "time" not in results.bursts or not len(results.bursts["time"].value):
        return None
    known = np.isfinite(x) & np.isfinite(time)
    if np.count_nonzero(known) < 2 or np.ptp(x[known]) == 0:
        return None
    at = np.interp(np.asarray(results.bursts["time"].value, float), time[known], x[known])
    size = np.asarray(results.bursts["size"].value, float)
    edges = np.linspace(x[known].min(), x[known].max(), 61)
    figure, (above, below) = plt.subplots(2, 1, figsize=(6.4, 4.8), sharex=True, constrained_layout=True)
    above.set_title("Bursts")
    above.hist(at, edges, color=BLUE)
    above.set_ylabel("bursts per 1/60 of the run")
    above.yaxis.set_major_locator(MaxNLocator(integer=True))
    few = size.max() < 10
    below.vlines(at, 0 if few else 0.7, size, color=RED, lw=0.8)
    below.plot(at, size, "o", color=RED, ms=2.5)
    if not few:
        below.set_yscale("log")
        below.yaxis.set_major_formatter("{x:g}")
    below.set_ylim(bottom=0 if few else 0.7)
    below.set_ylabel("bonds broken in a burst")
    below.set_xlabel(label)
    if stress is not None:
        draw_stress_beside(results, above, x, stress)
    above.margins(x=0.02)
    mark_stages(results, above, x)
    save(figure, path)
    return f"{len(at)} bursts of breaks that are near each other in place and time, with the stress (thin line); below, how many bonds each broke."


def energy_columns(results):
    columns = {name[len("energy_"):]: c.value for name, c in results.history.items()
               if name.startswith("energy_") and name != "energy_residual"}
    return {name: np.nan_to_num(v) for name, v in columns.items() if np.isfinite(v).any()}


def plot_energy(results, path):
    x, label = abscissa(results)
    terms = energy_columns(results)
    if x is None or not terms:
        return None
    kinds = {n: c.kind for n, c in results.energy.items() if n in terms}
    inputs = sum((terms[n] for n in terms if kinds.get(n) == "input"), np.zeros(results.rows))
    at_start = results.scalar(results.energy, "stored_at_start")
    inputs = inputs + (at_start if np.isfinite(at_start) else 0.0)
    shade = {n: colors[k % len(colors)] for kind, colors in SHADES.items()
             for k, n in enumerate(n for n in kinds if kinds[n] == kind)}
    stack = [n for kind in SHADES for n in kinds if kinds[n] == kind]
    largest = max([np.abs(terms[n]).max() for n in stack] + [np.abs(inputs).max()])
    shown = [n for n in stack if np.abs(terms[n]).max() > 2e-3 * largest]
    factor, unit = scale_of([largest], "J")
    residual = results.column("energy_residual")
    figure, (axes, below) = plt.subplots(2, 1, figsize=(7.2, 5.2), sharex=True, constrained_layout=True,
                                         gridspec_kw={"height_ratios": [3.4, 1]})
    axes.set_title("Energy")
    if shown and results.rows > 1 and all(terms[n].min() >= -1e-6 * largest for n in shown):
        axes.stackplot(x, [terms[n] / factor for n in shown], lw=0,
                       labels=[n.replace("_", " ") for n in shown],
                       colors=[shade[n] for n in shown])
    else:
        for n in shown:
            axes.plot(x, terms[n] / factor, label=n.replace("_", " "), color=shade[n], **style_for(terms[n]))
    axes.plot(x, inputs / factor, color=INK, lw=1.4, dashes=(5, 2), label="put in")
    axes.set_ylabel(f"energy [{unit}]")
    handles, names = axes.get_legend_handles_labels()
    # The legend is beside the plot, because the curves fill it and the names of stages are along its upper edge.
    axes.legend(handles[::-1], names[::-1], loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    if residual is not None:
        below.plot(x, residual, color=RED, lw=1.2, **style_for(residual))
        below.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2))
    below.axhline(0, color=INK, lw=0.6)
    below.set_ylabel("residual [1]")
    below.set_xlabel(label)
    axes.margins(x=0.02)
    mark_stages(results, axes, x)
    save(figure, path)
    return ("Stored and dissipated energies, stacked; the dashed line is the energy that was put in and should be the upper "
            "edge of the stack. Below: the residual over the energy throughput. Terms below 0.2 % are omitted.")


def plot_flow(results, path):
    """Masses that sources added and sinks removed, and their rates."""
    x, label = abscissa(results)
    time = results.column("time")
    names = [n for n in results.history if re.fullmatch(r"(source|sink)_.*_mass", n)]
    if x is None or not names:
        return None
    factor, unit = scale_of([max(np.abs(results.column(n)).max() for n in names)], "kg")
    figure, (axes, below) = plt.subplots(2, 1, figsize=(6.4, 5.2), sharex=True, constrained_layout=True)
    axes.set_title("Sources and sinks")
    for k, name in enumerate(names):
        kind, owner = name[:-len("_mass")].split("_", 1)
        mass = results.column(name)
        dashes = {"dashes": (5, 2)} if kind == "source" else {}
        axes.plot(x, mass / factor, color=f"C{k}", label=f"{kind} {owner}", **dashes, **style_for(mass))
        steps = np.linspace(0, results.rows - 1, min(results.rows, 60)).astype(int)
        if len(steps) > 1 and (np.diff(time[steps]) > 0).all():
            rate = np.diff(mass[steps]) / np.diff(time[steps])
            below.step(x[steps], np.append(rate, rate[-1]), where="post", color=f"C{k}", lw=1.2, **dashes)
    axes.set_ylabel(f"mass [{unit}]")
    below.set_ylabel("rate [kg/s]")
    below.set_xlabel(label)
    place_legend(results, axes)
    axes.margins(x=0.02)
    mark_stages(results, axes, x)
    save(figure, path)
    return "Masses that sources inserted (dashed) and sinks removed; below, their rates over a sixtieth of the run."


def plot_joints(results, path):
    """Shear over normal force of joints, and the shares of their areas that are broken, open and sliding."""
    x, label = abscissa(results)
    owners = [n[len("joint_"):-len("_area")] for n in results.history if re.fullmatch(r"joint_.*_area", n)][:6]
    if x is None or not owners:
        return None
    figure, (axes, below) = plt.subplots(2, 1, figsize=(6.4, 5.2), sharex=True, constrained_layout=True)
    axes.set_title("Joints")
    for k, owner in enumerate(owners):
        area, normal, shear, broken, opened, sliding = (
            results.column(f"joint_{owner}_{name}") for name in ("area", "normal", "shear", "broken", "opened", "sliding"))
        pressed = normal > 1e-3 * np.abs(normal).max()
        ratio = np.divide(shear, normal, out=np.full(len(shear), np.nan), where=pressed)
        axes.plot(x, ratio, color=f"C{k}", label=owner, **style_for(ratio))
        for values, dashes in ((broken, {}), (opened, {"dashes": (5, 2)}), (sliding, {"dashes": (1, 1.5)})):
            below.plot(x, np.divide(values, area, out=np.zeros(len(area)), where=area > 0), color=f"C{k}", lw=1.2, **dashes)
    axes.set_ylabel("shear over normal force")
    below.set_ylabel("share of the area")
    below.set_ylim(0, 1.05)
    below.set_xlabel(label)
    place_legend(results, axes)
    axes.margins(x=0.02)
    mark_stages(results, axes, x)
    save(figure, path)
    return ("Magnitude of the sum of the shear forces over the sum of the normal forces of each joint that is pressed; below, the shares of its "
            "area that are broken (full), open (dashed) and sliding (dotted).")


def plot_unbalanced(results, path):
    x, label = abscissa(results)
    ratio = results.column("unbalanced")
    if x is None or ratio is None:
        return None
    if (ratio[np.isfinite(ratio)] > 0).any():
        ratio = np.where(ratio > 0, ratio, np.nan)  # a logarithmic axis follows
    figure, axes = new_axes("Unbalanced force", label, "unbalanced force ratio [1]", 3.2)
    axes.plot(x, ratio, color=INK, lw=1.2, **style_for(ratio))
    if np.isfinite(ratio).any() and np.nanmin(ratio) > 0:
        axes.set_yscale("log")
    axes.margins(x=0.02)
    mark_stages(results, axes, x)
    save(figure, path)
    return "Mean resultant over mean contact or element force: small values mean quasi-static loading, jumps mean fracture."


def plot_strains(results, path):
    x, label = abscissa(results)
    names = [n for n in ("strain_xx", "strain_yy", "strain_zz") if results.column(n) is not None]
    if x is None or not names:
        return None
    figure, axes = new_axes("Average strains", label, "average strain, tension positive [%]", 3.2)
    for name, color in zip(names, (RED, "#e09f3e", BLUE)):
        values = 100 * results.column(name)
        axes.plot(x, values, color=color, label=f"ε$_{{{name[-2:]}}}$", **style_for(values))
    axes.axhline(0, color=INK, lw=0.6)
    axes.margins(x=0.02)
    place_legend(results, axes, "best")
    mark_stages(results, axes, x)
    save(figure, path)
    return "Volume averages over the specimen's triangulation (Bagi 1996)."


def plot_force_over(results, path, way, caption):
    """Plots the force of a test over a displacement of its history, as for bending, where stress and strain are
    nominal."""
    force, length = results.in_last_stage("force"), results.in_last_stage(way)
    if force is None or length is None:
        return None
    f_factor, f_unit = scale_of(force, "N")
    l_factor, l_unit = scale_of(length, "m")
    figure, axes = new_axes(f"Force and {way}{results.of_stage}", f"{way} [{l_unit}]", f"force [{f_unit}]", 3.2)
    axes.plot(length / l_factor, force / f_factor, color=INK, **style_for(force))
    axes.margins(x=0.02)
    save(figure, path)
    return "Mean force of both ends over " + caption


def plot_deflection(results, path):
    return plot_force_over(results, path, "deflection",
                           "the change of their distance, both positive in the sense of the test.")


def plot_forces(results, path):
    """Plots forces on walls and reactions of sets over time, for scenes without a test."""
    time = results.column("time")
    names = [n for n in results.history if "_force_" in n or "_reaction_" in n]
    names = [n for n in names if results.column(n) is not None]
    if time is None or not names or (results.column("stress") is not None and not results.stages):
        return None
    peaks = {n: np.nanmax(np.abs(results.column(n))) for n in names}
    largest = max(peaks.values())
    shown = sorted((n for n in names if peaks[n] > 0.05 * largest), key=peaks.get, reverse=True)[:8]
    factor, unit = scale_of([largest], "N")
    t_factor, t_unit = scale_of(time, "s")
    figure, axes = new_axes("Forces on walls, sets and motions", f"time [{t_unit}]", f"force [{unit}]")
    for name in shown:
        values = results.column(name) / factor
        axes.plot(time / t_factor, values, lw=1.2, label=name.replace("_", " "), **style_for(values))
    if shown:
        place_legend(results, axes, "best")
    mark_stages(results, axes, time / t_factor)
    save(figure, path)
    return "The largest components; those below 5 % of the largest are omitted."


def plot_conversion(results, path):
    """Plots the conversion of elements into particles over time."""
    time, elements, particles = (results.column(name) for name in ("time", "elements", "particles"))
    if time is None or elements is None or particles is None:
        return None
    factor, unit = scale_of(time, "s")
    figure, axes = new_axes("Particles and elements", f"time [{unit}]", "number")
    axes.step(time / factor, particles, where="post", color=INK, label="active particles", **style_for(particles))
    axes.step(time / factor, elements, where="post", color=BLUE, dashes=(5, 2), label="elements that are left", **style_for(elements))
    axes.set_ylim(bottom=0)
    axes.margins(x=0.02)
    place_legend(results, axes, "best")
    mark_stages(results, axes, time / factor)
    save(figure, path)
    return f"Elements that turned into particles: {int(elements[0])} to {int(elements[-1])} elements, {int(particles[0])} to {int(particles[-1])} particles."


def plot_profile(results, path):
    phases = sorted((float(np.asarray(c.value).reshape(-1)[0]), c.text or name.replace("_", " "))
                    for name, c in results.profile.items())
    phases = [(s, name) for s, name in phases if np.isfinite(s) and s > 0]
    if not phases:
        return None
    total = float(results.attribute("seconds") or sum(s for s, _ in phases))
    figure, axes = plt.subplots(figsize=(6.4, 0.9 + 0.28 * len(phases)), constrained_layout=True)
    axes.set_title("Time per phase")
    bars = axes.barh([name for _, name in phases], [s for s, _ in phases], color=BLUE, height=0.68)
    axes.bar_label(bars, [f" {s:.3g} s, {100 * s / total:.3g} %" for s, _ in phases], fontsize=9)
    axes.set_xlabel("wall time [s]")
    axes.grid(axis="y", visible=False)
    axes.margins(x=0.4)
    axes.set_xlim(left=0)
    save(figure, path)
    return f"Wall time of the phases, {total:.3g} s in all."


CURVES = {
    "stress_strain": plot_stress,
    "broken_bonds": plot_broken,
    "events": plot_events,
    "bursts": plot_bursts,
    "force_deflection": plot_deflection,
    "forces": plot_forces,
    "flow": plot_flow,
    "joints": plot_joints,
    "conversion": plot_conversion,
    "energy": plot_energy,
    "unbalanced": plot_unbalanced,
    "strains": plot_strains,
    "profile": plot_profile,
}
