"""The part of a report that belongs to a cutting test: forces over the path of the tool, and along the rim of a disc cutter."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from report_curves import BLUE, GREY, INK, RED, new_axes, save
from report_results import scale_of

PARTS = (("normal", INK), ("rolling", RED), ("side", BLUE))
WINDOWS = 120  # along the path


def mean_forces(results):
    """(path, {part: force}): path [n], m, at the middle of windows, and the mean force in each, N; None without a cut."""
    path, time = results.column("cut_path"), results.column("time")
    impulses = {part: results.column(part + "_impulse") for part, _ in PARTS}
    if path is None or time is None or any(values is None for values in impulses.values()) or len(path) < 3 or not path[-1] > path[0]:
        return None
    edges = np.linspace(path[0], path[-1], min(WINDOWS, len(path) - 1) + 1)
    duration = np.diff(np.interp(edges, path, time))
    return 0.5 * (edges[1:] + edges[:-1]), {part: np.diff(np.interp(edges, path, values)) / duration for part, values in impulses.items()}


def plot_cut(results, path):
    """Forces in the axes of the tool over its path, and the detached volume."""
    found = mean_forces(results)
    if found is None:
        return None
    at, forces = found
    factor, unit = scale_of(np.concatenate(list(forces.values())), "N")
    removed, along = results.column("removed_volume"), results.column("cut_path")
    figure, axes = plt.subplots(1 if removed is None else 2, 1, figsize=(6.4, 3.6 if removed is None else 5.2), sharex=True, constrained_layout=True,
                                squeeze=False, gridspec_kw=None if removed is None else {"height_ratios": [2, 1]})
    above, below = axes[0][0], axes[-1][0]
    above.set_title("Forces on the tool")
    for part, color in PARTS:
        if results.dimension == 3 or part != "side":
            above.plot(1e3 * at, forces[part] / factor, color=color, label=part)
    above.set_ylabel(f"mean force [{unit}]")
    above.legend(loc="best")
    if removed is not None:
        scale, volume_unit = (1e6, "cm$^3$") if results.dimension == 3 else (1e4, "cm$^2$ x 1 m")
        below.plot(1e3 * along, scale * removed, color=GREY)
        below.set_ylabel(f"rock that came off\n[{volume_unit}]")
    below.set_xlabel("path of the tool [mm]")
    save(figure, path)
    return (f"Means over {len(at)} windows along the path: out of the rock (normal), against the motion (rolling), along normal x axis (side)."
            + ("" if removed is None else "Below: the volume, with pores, of rock that no intact bond connects to the anchored rest."))


def plot_rim(results, path):
    """Forces along the rim of a disc cutter over the angle from its lowest point."""
    share, normal, rolling = (results.rim.get(name) for name in ("share", "normal", "rolling"))
    if share is None or normal is None or rolling is None or not np.any(normal.value):
        return None
    factor, unit = scale_of(normal.value, "N")
    width = np.diff(share.value).mean()
    figure, axes = new_axes("Forces along the rim", "angle from the lowest point over the arc in the rock", f"mean force in a bin [{unit}]")
    axes.bar(share.value, normal.value / factor, width=0.9 * width, color=INK, label="normal")
    axes.bar(share.value, rolling.value / factor, width=0.5 * width, color=RED, label="rolling")
    for place in (0, 1):
        axes.axvline(place, color=GREY, lw=1, dashes=(6, 2))
    axes.legend(loc="best")
    save(figure, path)
    middle = np.sum(share.value * normal.value) / np.sum(normal.value)
    return ("Mean forces of the contacts by their angle: 0 is below the axis, 1 the surface of the rock ahead (dashed). The normal force "
            f"acts at {middle:.2f} of the arc.")


CURVES = {"cut": plot_cut, "rim": plot_rim}
