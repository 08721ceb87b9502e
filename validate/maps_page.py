"""Tables and pictures of docs/evidence/strength-maps.md from data/maps.csv; called by maps_study.py, or alone:

    /usr/bin/python3 validate/maps_page.py
"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import study

sys.path.append(str(study.ROOT))
from calibrate import maps  # noqa: E402

PAGE = "strength-maps.md"
PICTURES = study.ROOT / "docs" / "evidence" / "pictures"
COLOURS = ("#9aa5ad", "#2b6cb0", "#3a7d44", "#d69e2e", "#c8402f", "#6b46c1", "#22303c")
LAW_CHI = (1.0, 4.0, 10.0)
NAMES = {"compression": "compression", "tension": "tension", "brazilian": "Brazilian"}


class Table:
    """The maps by point: mean and relative deviation over the packings."""

    def __init__(self):
        self.maps = maps.Maps()

    def at(self, column, dimension, rho_k=0.35, chi=1.0, mu=0.5, law="linear", keys=maps.PLAIN):
        return self.maps.mean(column, law, dimension, rho_k, chi, 0.0 if rho_k == 0 else mu, keys)

    def ratio(self, test, dimension, **point):
        """Mean over the packings of compressive over tensile strength, and its standard error; packings of both tests have the same seed."""
        law, keys = point.get("law", "linear"), point.get("keys", maps.PLAIN)
        cell = self.maps.cells[(law, float(dimension), point["rho_k"], point["chi"], point.get("mu", 0.5), *(keys[name] for name in maps.PLAIN))]
        values = np.array(cell["compression"]) / np.array(cell[test])
        return values.mean(), values.std(ddof=1) / np.sqrt(len(values))

    def rhos(self, dimension):
        return self.maps.axis("rho_k", law="linear", dimension=float(dimension), mu=0.5)

    def chis(self, dimension):
        return self.maps.axis("chi", law="linear", dimension=float(dimension), mu=0.5, rho_k=0.2)


def uniform_strain(dimension, rho):
    """Measure of E, and nu, of an isotropic packing whose particles follow the mean strain."""
    if dimension == 3:
        return (2 + 3 * rho) / (2 * np.pi * (4 + rho)), (1 - rho) / (4 + rho)
    return (1 + rho) * (5 - rho) / (8 * np.pi), (1 - rho) / 4


def elastic_table(table):
    rows = []
    for dimension in (3, 2):
        for rho in (0.0, *table.rhos(dimension)):
            strain = uniform_strain(dimension, rho)
            scatter = [100 * table.maps.deviation(name, "linear", dimension, rho, 1.0, 0.5 if rho else 0.0) for name in ("young", "poisson")]
            rows.append([f"{dimension}D", f"{rho:g}", f"{table.at('young', dimension, rho):.4f}", f"{scatter[0]:.1f}", f"{strain[0]:.4f}",
                         f"{table.at('poisson', dimension, rho):.3f}", f"{scatter[1]:.1f}", f"{strain[1]:.3f}"])
    study.put_table(PAGE, "table elastic", ["", "k_t/k_n", "E measure", "scatter %", "of uniform strain", "nu", "scatter %", "of uniform strain"], rows, False)


def strength_table(table):
    rows = []
    for dimension in (3, 2):
        for test in NAMES:
            for rho in table.rhos(dimension):
                rows.append([f"{dimension}D", NAMES[test], f"{rho:g}", *(f"{table.at(test, dimension, rho, chi):.4f}" for chi in table.chis(dimension))])
    study.put_table(PAGE, "table strength", ["", "strength", "k_t/k_n", *(f"R_t/R_n {chi:g}" for chi in table.chis(3))], rows, False)


def ratio_table(table):
    rows = []
    for dimension in (3, 2):
        for test in ("tension", "brazilian"):
            for rho in table.rhos(dimension):
                pairs = [table.ratio(test, dimension, rho_k=rho, chi=chi) for chi in table.chis(dimension)]
                rows.append([f"{dimension}D", f"over {NAMES[test]}", f"{rho:g}", *(f"{mean:.2f} ± {error:.2f}" for mean, error in pairs)])
    study.put_table(PAGE, "table ratio", ["", "compression", "k_t/k_n", *(f"R_t/R_n {chi:g}" for chi in table.chis(3))], rows, False)


def threshold(table, test, dimension, rho):
    """The smallest chi of the maps from which on the strength stays within 6 % (above the scatter of means) of that at the largest one."""
    chis = table.chis(dimension)
    values = np.array([table.at(test, dimension, rho, chi) for chi in chis])
    apart = np.flatnonzero(np.abs(values / values[-1] - 1) > 0.06)
    first = apart[-1] + 1 if len(apart) else 0
    return f"{chis[first]:g}" if first < len(chis) - 1 else f"above {chis[-2]:g}"


def threshold_table(table):
    rows = [[f"{dimension}D", NAMES[test], *(threshold(table, test, dimension, rho) for rho in table.rhos(dimension))]
            for dimension in (3, 2) for test in NAMES]
    study.put_table(PAGE, "table threshold", ["", "test", *(f"k_t/k_n {rho:g}" for rho in table.rhos(3))], rows, False)


def break_table(table):
    rows = []
    for dimension in (3, 2):
        for test in NAMES:
            for column, name in (("shear_share", "in shear"), ("broken", "of all bonds")):
                rows.append([f"{dimension}D", NAMES[test], f"broken {name} %", *(f"{100 * table.at(f'{test}_{column}', dimension, rho, chi):.0f}"
                             for chi in (1.0, 10.0) for rho in table.rhos(dimension))])
    heads = [f"{rho:g}" for rho in table.rhos(3)]
    study.put_table(PAGE, "table breaks", ["", "test", "", *(f"R_t/R_n 1, k_t/k_n {h}" for h in heads), *(f"10, {h}" for h in heads)], rows, False)


def over_smooth(table, test, dimension, chi, mu):
    """Strength over that without friction, mean of the quotients of the same packings."""
    cells = [table.maps.cells[("linear", float(dimension), 0.35, chi, value, *maps.PLAIN.values())][test] for value in (mu, 0.0)]
    return np.mean(np.divide(*cells))


def friction_table(table):
    rows, mus = [], table.maps.axis("mu", law="linear", dimension=3.0, rho_k=0.35, chi=1.0)
    for dimension in (3, 2):
        for test in NAMES:
            for chi in (1.0, 4.0, 10.0):
                there = table.maps.axis("mu", law="linear", dimension=float(dimension), rho_k=0.35, chi=chi)
                rows.append([f"{dimension}D", NAMES[test], f"{chi:g}", *(f"{over_smooth(table, test, dimension, chi, mu):.3f}" if mu in there else "" for mu in mus)])
    study.put_table(PAGE, "table friction", ["", "strength over that without friction", "R_t/R_n", *(f"mu {mu:g}" for mu in mus)], rows, False)


def described(keys):
    names = {"bond_friction": "mu_1", "radius_multiplier": "radius multiplier", "moment_share": "moment share", "interaction_range": "range"}
    return ", ".join(f"{names[name]} {value:g}" for name, value in keys.items() if value != maps.PLAIN[name]) or "linear"


def law_table(table):
    rows = []
    for dimension in (3, 2):
        for law, keys in table.maps.laws(dimension):
            point = {"rho_k": 0.2, "law": law, "keys": keys}
            row = [f"{dimension}D", described(keys), f"{table.at('n_c', dimension, chi=1.0, **point):.2f}", f"{table.at('poisson', dimension, chi=1.0, **point):.3f}"]
            there = table.maps.axis("chi", law=law, dimension=float(dimension), rho_k=0.2)
            for test in ("tension", "brazilian"):
                pairs = [table.ratio(test, dimension, chi=chi, **point) if chi in there else None for chi in LAW_CHI]
                row += [f"{pair[0]:.2f} ± {pair[1]:.2f}" if pair else "" for pair in pairs]
            rows.append(row)
    study.put_table(PAGE, "table laws", ["", "law", "n_c", "nu", *(f"over {NAMES[test]}, R_t/R_n {chi:g}" for test in ("tension", "brazilian") for chi in LAW_CHI)],
                    rows, False)


def draw_strengths(table):
    figure, axes = plt.subplots(2, 4, figsize=(17, 8))
    for row, dimension in zip(axes, (3, 2)):
        chis = table.chis(dimension)
        for colour, rho in zip(COLOURS, table.rhos(dimension)):
            for axis, test in zip(row, NAMES):
                values = [table.at(test, dimension, rho, chi) for chi in chis]
                errors = [table.maps.deviation(test, "linear", dimension, rho, chi, 0.5) for chi in chis]
                axis.errorbar(chis, values, yerr=np.multiply(values, errors), color=colour, marker="o", ms=3, lw=1.2, label=f"{rho:g}")
                axis.set(xscale="log", title=f"{dimension}D, {NAMES[test]}", xlabel="R_t/R_n", ylabel="strength A/(R_n n_c (1 - e))")
            for test, style in (("tension", "-"), ("brazilian", "--")):
                row[3].plot(chis, [table.ratio(test, dimension, rho_k=rho, chi=chi)[0] for chi in chis], style, color=colour, marker="o", ms=3)
        row[3].set(xscale="log", title=f"{dimension}D, compression/tension\n(dashed: compression/Brazilian)", xlabel="R_t/R_n")
        for axis in row:
            axis.set_ylim(0)
        row[0].legend(title="k_t/k_n", fontsize=8)
    study.save(figure, PICTURES, "strength-maps")


def draw_elastic(table):
    figure, axes = plt.subplots(2, 3, figsize=(14, 8))
    for row, dimension in zip(axes, (3, 2)):
        rhos, line = np.array([0.0, *table.rhos(dimension)]), np.linspace(0, 1, 50)
        for axis, name, k, text in ((row[0], "young", 0, "E rt/(k_n n_c (1 - e))"), (row[1], "poisson", 1, "nu")):
            axis.plot(line, uniform_strain(dimension, line)[k], color=COLOURS[0], label="uniform strain")
            axis.plot(rhos, [table.at(name, dimension, rho) for rho in rhos], "o-", color=COLOURS[1], label="tests")
            axis.set(title=f"{dimension}D", xlabel="k_t/k_n", ylabel=text)
            axis.set_ylim(0)
        row[0].legend()
        for colour, chi in zip(COLOURS, (1.0, 2.0, 4.0, 10.0)):
            for test, style in (("compression", "-"), ("brazilian", "--")):
                share = [100 * table.at(f"{test}_shear_share", dimension, rho, chi) for rho in rhos[1:]]
                row[2].plot([0, *rhos[1:]], [0, *share], style, color=colour, marker="o", ms=3, label=f"{chi:g}" if test == "compression" else None)
        row[2].set(title=f"{dimension}D, compression; dashed: Brazilian", xlabel="k_t/k_n", ylabel="broken in shear, % of broken", ylim=(0, 100))
        row[2].legend(title="R_t/R_n", fontsize=8)
    study.save(figure, PICTURES, "strength-maps-elastic")


def draw_laws(table):
    figure, axes = plt.subplots(1, 3, figsize=(17, 5))
    for dimension, style in ((3, "-"), (2, "--")):
        for colour, chi in zip(COLOURS[1:], (1.0, 4.0, 10.0)):
            mus = table.maps.axis("mu", law="linear", dimension=float(dimension), rho_k=0.35, chi=chi)
            axes[0].plot(mus, [over_smooth(table, "compression", dimension, chi, mu) for mu in mus], style, marker="o", ms=3, color=colour, label=f"{dimension}D, R_t/R_n {chi:g}")
    axes[0].set(xlabel="friction coefficient mu", title="UCS over that without friction, k_t/k_n 0.35", ylim=(0, None))
    axes[0].legend(fontsize=8)
    for axis, dimension in zip(axes[1:], (3, 2)):
        laws = table.maps.laws(dimension)
        for shift, chi, colour in zip((-0.27, 0, 0.27), LAW_CHI, (COLOURS[0], COLOURS[1], COLOURS[4])):
            places = [k for k, (law, _) in enumerate(laws) if chi in table.maps.axis("chi", law=law, dimension=float(dimension), rho_k=0.2)]
            pairs = [table.ratio("tension", dimension, rho_k=0.2, chi=chi, law=laws[k][0], keys=laws[k][1]) for k in places]
            axis.barh(np.array(places) + shift, [p[0] for p in pairs], 0.25, xerr=[p[1] for p in pairs], color=colour, label=f"R_t/R_n {chi:g}")
        axis.set_yticks(np.arange(len(laws)), [described(keys) for _, keys in laws], fontsize=8)
        axis.invert_yaxis()
        axis.set(title=f"{dimension}D, compression over tension, k_t/k_n 0.2")
        axis.legend(fontsize=8)
    study.save(figure, PICTURES, "strength-maps-laws")


# --- other settings and other packings ------------------------------------------------------------------------------

def raw(row, name):
    """A measure without the normalisation by the packing: E r/k_n, strength r^2/R_n (2D: E t/k_n, strength r t/R_n)."""
    disc = "disc_" if name == "brazilian" else ""
    return row[name] * row[f"{disc}n_c"] * (1 - row[f"{disc}porosity"]) / row[f"{disc}{'rt' if name == 'young' else 'area'}"]


def check_table(found, points):
    """found: {dimension: {name: rows}} with `as in the maps` first; strengths over those of the maps' settings, seed by seed."""
    rows = []
    for dimension, kinds in found.items():
        names = list(kinds)
        for name in names[1:]:
            row = [f"{dimension}D", name]
            for measure in ("young", *NAMES):
                pairs = np.array([(one[measure], other[measure]) for one, other in zip(kinds[name], kinds[names[0]])]).reshape(len(points), -1, 2)
                change = 100 * (pairs[:, :, 0] / pairs[:, :, 1] - 1)
                texts = [f"{of_point.mean():+.1f} ± {of_point.std(ddof=1) / np.sqrt(len(of_point)):.1f}" for of_point in change]
                row += texts[:1] if measure == "young" else texts
            rows.append(row)
    labels = [f"{point['rho_k']:g}, {point['chi']:g}" for point in points]
    study.put_table(PAGE, "table check", ["", "changed", "E", *(f"{name} {label}" for name in NAMES.values() for label in labels)], rows, False)


def spread_table(found, points, names):
    """Scatter over the kinds of packings (means over the seeds) before and after normalisation by the packing, as a mean over the points."""
    rows = []
    for dimension, kinds in found.items():
        there = [kinds[name] for name in names if name in kinds]
        for text, value in (("before: E r/k_n, strength r^2/R_n", raw), ("after: the measures", lambda row, name: row[name])):
            row = [f"{dimension}D, {len(there)} kinds", text]
            for measure in ("young", *NAMES):
                table = np.array([[value(one, measure) for one in kind] for kind in there]).reshape(len(there), len(points), -1)
                of_seeds, means = np.mean(table.std(axis=2, ddof=1)[0] / table.mean(axis=2)[0]), table.mean(axis=2)
                row.append(f"{100 * np.mean(means.std(axis=0, ddof=1) / means.mean(axis=0)):.1f} ({100 * of_seeds:.1f})")
            rows.append(row)
    study.put_table(PAGE, "table spread", ["", "scatter over the kinds (over seeds of the maps' kind), %", "E", *NAMES.values()], rows, False)


def cross_table(parts):
    """Measured and interpolated strengths away from the k_t/k_n at which the effect of a law or of friction was measured; seeds of the maps."""
    table, rows = maps.Maps(), []
    for points, runs in parts:
        for k, point in enumerate(points):
            keys = {name: point[name] for name in maps.PLAIN}
            of_point = runs[k * len(runs) // len(points):(k + 1) * len(runs) // len(points)]
            row = [described(keys), f"{point['mu']:g}", f"{point['rho_k']:g}, {point['chi']:g}"]
            for name in ("young", "poisson", *NAMES):
                found = table.measure(name, point["law"], 3, point["rho_k"], point["chi"], point["mu"], **keys)
                row.append(f"{found / np.mean([one[name] for one in of_point]):.3f}")
            rows.append(row)
    study.put_table(PAGE, "table cross", ["law", "mu", "k_t/k_n, R_t/R_n", "interpolated over measured: E", "nu", *NAMES.values()], rows, False)


def write_page():
    table = Table()
    for part in (elastic_table, strength_table, ratio_table, threshold_table, break_table, friction_table, law_table,
                 draw_strengths, draw_elastic, draw_laws):
        part(table)


if __name__ == "__main__":
    write_page()
