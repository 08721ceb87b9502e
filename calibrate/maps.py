"""Dimensionless maps of bonded packings (data/maps.csv, made by validate/maps_study.py): reading, interpolation, start values of a calibration.

Groups (Labra 2012, eq. 4.20-4.28 and 4.58): rho_k = k_t/k_n; chi = R_t/R_n; mu, the friction coefficient of what has broken. Measures:
E rt/(k_n n_c (1 - e)) and strength A/(R_n n_c (1 - e)), with rt = 4 <r^3>/<l^2>, A = 2 <r^3>/<l> (3D), rt = 4 <r^2> t/<l^2>, A = 2 <r^2> t/<l> (2D,
thickness t), r the radii, l the distances of bonded centres, n_c bonds per particle (twice the bonds over the particles), e the porosity. In 2D E and nu
are those of the material, not of plane strain.

Laws: `linear`; `bond_friction`, `range` (bonds.interaction_range) and `moments` (bonds.radius_multiplier) with values of the key of that name;
`range_friction`, `moments_friction` with both; `moments_only_stiff`: moments with bonds.moment_share 0, which alone raises the ratio of strengths much.

    maps = Maps()
    start = maps.start("linear", 3, poisson=0.2, ratio=8)
    k_n = start.normal_stiffness(20e9, groups)
"""
import csv
import functools
from pathlib import Path
from typing import NamedTuple

import numpy as np

DATA = Path(__file__).resolve().parent.parent / "data" / "maps.csv"
KEYS = ("law", "dimension", "rho_k", "chi", "mu", "bond_friction", "radius_multiplier", "moment_share", "interaction_range")
PLAIN = {"bond_friction": 0.0, "radius_multiplier": 0.0, "moment_share": 1.0, "interaction_range": 0.05}  # values of the law `linear`
STRENGTHS = ("compression", "tension", "brazilian")
MEASURES = ("young", "poisson", *STRENGTHS)


class Groups(NamedTuple):
    """Measures of a packing that the groups contain: bonds per particle, porosity, rt (m) and A (m2)."""

    n_c: float
    porosity: float
    rt: float
    area: float


def groups(radii, branches, volume, dimension, thickness=1.0):
    """Groups of a packing: radii [particles] and distances of bonded centres [bonds] in m, volume of the body in m3 (2D: area in m2)."""
    radii, branches = np.asarray(radii, float), np.asarray(branches, float)
    if dimension not in (2, 3) or not len(radii) or not len(branches) or not volume > 0:
        raise ValueError("expected dimension 2 or 3, particles, bonds and a volume above 0")
    solid = np.pi * np.sum(radii**2) if dimension == 2 else 4 / 3 * np.pi * np.sum(radii**3)
    power = np.mean(radii**dimension) * (thickness if dimension == 2 else 1)
    return Groups(2 * len(branches) / len(radii), 1 - solid / volume, 4 * power / np.mean(branches**2), 2 * power / np.mean(branches))


class Start(NamedTuple):
    """Start values: law parameters, measures at them (means over packings), whether the wanted values are within the maps, else the reason."""

    law: str
    keys: dict  # values of PLAIN's keys
    rho_k: float
    chi: float
    mu: float
    measures: dict  # young, poisson, compression, tension, brazilian: without unit
    ratio: float  # compressive strength over the tensile strength of the requested test
    reached: bool
    reason: str

    def normal_stiffness(self, modulus, packing):
        """k_n in N/m for Young's modulus in Pa, of a packing with these Groups."""
        return modulus * packing.rt / (self.measures["young"] * packing.n_c * (1 - packing.porosity))

    def tension_limit(self, strength, packing, test="compression"):
        """R_n in N for the strength in Pa in compression, tension or the Brazilian test; R_t is chi times that."""
        return strength * packing.area / (self.measures[test] * packing.n_c * (1 - packing.porosity))


def read(path=DATA):
    """Rows of the maps: dicts of numbers, and of text for `law`; an empty cell is NaN. Lines that begin with # are comments."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return [{key: value if key == "law" else float(value) if value else np.nan for key, value in row.items()} for row in rows]


class Maps:
    def __init__(self, path=DATA):
        self.cells = {}  # (values of KEYS) -> {column: values of the packings}
        for row in read(path):
            cell = self.cells.setdefault(tuple(row[key] for key in KEYS), {})
            for column in row.keys() - set(KEYS):
                cell.setdefault(column, []).append(row[column])

    def mean(self, column, law, dimension, rho_k, chi, mu, keys=PLAIN):
        """Mean of a column over the packings at a point of the maps; KeyError if there is no such point."""
        at = (law, float(dimension), rho_k, chi, mu, *(keys[name] for name in PLAIN))
        if at not in self.cells:
            raise KeyError(at)
        return float(np.mean(self.cells[at][column]))

    def deviation(self, column, law, dimension, rho_k, chi, mu, keys=PLAIN):
        """Standard deviation over the packings, relative to the mean."""
        values = self.cells[(law, float(dimension), rho_k, chi, mu, *(keys[name] for name in PLAIN))][column]
        return float(np.std(values, ddof=1) / abs(np.mean(values)))

    def laws(self, dimension):
        """(law, keys) that the maps have, the linear law first."""
        found = dict.fromkeys((cell[0], cell[5:]) for cell in self.cells if cell[1] == dimension)
        return [(law, dict(zip(PLAIN, keys))) for law, keys in found]

    @functools.lru_cache(maxsize=None)
    def axis(self, key, **where):
        """Sorted values of a key at the points of the maps where the others have the given values."""
        points = [dict(zip(KEYS, cell)) for cell in self.cells]
        return sorted({point[key] for point in points if all(point[name] == value for name, value in where.items())})

    def _grid(self, column, dimension, rho_k, chi):
        """Bilinear in rho_k and log chi; without tangential springs (rho_k 0) chi and mu are without effect."""
        rhos = self.axis("rho_k", law="linear", dimension=float(dimension), mu=0.5)
        chis = self.axis("chi", law="linear", dimension=float(dimension), mu=0.5, rho_k=rhos[0])
        table = [np.interp(np.log(chi), np.log(chis), [self.mean(column, "linear", dimension, rho, c, 0.5) for c in chis]) for rho in rhos]
        return float(np.interp(rho_k, [0.0, *rhos], [self.mean(column, "linear", dimension, 0.0, 1.0, 0.0), *table]))

    def _friction(self, column, dimension, chi, mu):
        """Factor of a friction coefficient other than 0.5, measured at one rho_k, over log chi; flat beyond the largest mu."""
        where = {"law": "linear", "dimension": float(dimension), "mu": 0.0}
        rho = max(self.axis("rho_k", **where))
        chis = self.axis("chi", **where, rho_k=rho)
        mus = self.axis("mu", law="linear", dimension=float(dimension), rho_k=rho, chi=chis[0])
        factors = [np.interp(mu, mus, [self.mean(column, "linear", dimension, rho, c, m) for m in mus]) / self.mean(column, "linear", dimension, rho, c, 0.5)
                   for c in chis]
        return float(np.interp(np.log(chi), np.log(chis), factors))

    def _law(self, column, law, keys, dimension, chi):
        """Factor of a law other than the linear one, measured at one rho_k, over log chi; linear in a single key that the maps have more than once."""
        cells = [cell for cell in self.cells if cell[0] == law and cell[1] == dimension]
        if not cells:
            raise ValueError(f"expected a law of the maps ({', '.join(dict.fromkeys(name for name, _ in self.laws(dimension)))}), found {law}")
        rho, mu = cells[0][2], cells[0][4]
        chis = self.axis("chi", law=law, dimension=float(dimension), rho_k=rho)
        known = list(dict.fromkeys(cell[5:] for cell in cells))
        free = [k for k, name in enumerate(PLAIN) if any(values[k] != PLAIN[name] for values in known)]
        wanted = tuple(keys[name] for name in PLAIN)
        if len(free) == 1 and all(wanted[k] == PLAIN[name] for k, name in enumerate(PLAIN) if k not in free):
            places = free[0]
            known = sorted([tuple(PLAIN.values()), *known], key=lambda values: values[places])
            steps = [values[places] for values in known]
            if not steps[0] <= wanted[places] <= steps[-1]:
                raise ValueError(f"expected {list(PLAIN)[places]} in [{steps[0]:g}, {steps[-1]:g}] with the law {law}, found {wanted[places]:g}")
        elif wanted in known:
            known, steps, places = [wanted], [0.0], None
        else:
            raise ValueError(f"expected keys of the law {law} that the maps have ({known}), found {wanted}")

        def factor(values, c):
            name = "linear" if values == tuple(PLAIN.values()) else law
            return self.mean(column, name, dimension, rho, c, mu, dict(zip(PLAIN, values))) / self.mean(column, "linear", dimension, rho, c, mu)

        found = [np.interp(wanted[places] if places is not None else 0.0, steps, [factor(values, c) for values in known]) for c in chis]
        return float(np.interp(np.log(chi), np.log(chis), found))

    def measure(self, column, law, dimension, rho_k, chi, mu=0.5, **keys):
        """Measure interpolated at any rho_k in [0, 1], chi (held at the ends of the maps), mu >= 0. Effects of friction (at rho_k 0.35) and of other laws
        (at 0.2) are factors: at rho_k 0.6 compression is off by a tenth, with moments_only_stiff by two thirds (docs/evidence/strength-maps.md)."""
        if dimension not in (2, 3) or not 0 <= rho_k <= 1 or not chi > 0 or not mu >= 0 or set(keys) - set(PLAIN):
            raise ValueError(f"expected dimension 2 or 3, rho_k in [0, 1], chi > 0, mu >= 0 and keys of {', '.join(PLAIN)}, "
                             f"found {dimension}, {rho_k}, {chi}, {mu}, {', '.join(keys)}")
        value = self._grid(column, dimension, rho_k, chi)
        if rho_k > 0:
            value *= self._friction(column, dimension, chi, mu)
        return value if law == "linear" else value * self._law(column, law, {**PLAIN, **keys}, dimension, chi)

    def start(self, law, dimension, poisson, ratio, mu=0.5, test="tension", **keys):
        """Start for Poisson's ratio and the ratio of compressive strength to that of `test` (tension, or brazilian): rho_k from nu, then the smallest
        chi with the ratio. Beyond the maps it is the nearest point, with the reason."""
        if test not in ("tension", "brazilian") or not ratio > 0 or not -1 < poisson < 0.5:
            raise ValueError(f"expected tension or brazilian, a ratio above 0 and nu in (-1, 0.5), found {test}, {ratio}, {poisson}")
        reasons = []
        rhos = np.linspace(0, 1, 201)
        nus = np.minimum.accumulate([self.measure("poisson", law, dimension, rho, 4.0, mu, **keys) for rho in rhos])
        if not nus[-1] <= poisson <= nus[0]:
            reasons.append(f"Poisson's ratio {poisson:g} is beyond {nus[-1]:.3f} to {nus[0]:.3f}")
        rho_k = float(np.interp(-poisson, -nus, rhos))
        chis = np.geomspace(1, 20, 121)
        found = [self.measure("compression", law, dimension, rho_k, chi, mu, **keys) / self.measure(test, law, dimension, rho_k, chi, mu, **keys)
                 for chi in chis]
        rising = np.maximum.accumulate(found)
        if not rising[0] <= ratio <= rising[-1]:
            reasons.append(f"strength ratio {ratio:g} is beyond {rising[0]:.2f} to {rising[-1]:.2f} at k_t/k_n {rho_k:.3f}")
        at = int(np.searchsorted(rising, ratio if ratio <= rising[-1] else 0.99 * rising[-1]))
        chi = float(chis[at])
        if 0 < at and rising[at] > ratio:
            chi = float(np.exp(np.interp(ratio, rising[at - 1:at + 1], np.log(chis[at - 1:at + 1]))))
        measures = {name: self.measure(name, law, dimension, rho_k, chi, mu, **keys) for name in MEASURES}
        return Start(law, {**PLAIN, **keys}, rho_k, chi, mu, measures, measures["compression"] / measures[test], not reasons, "; ".join(reasons))

    def largest_ratios(self, dimension, poisson, mu=0.5, test="tension"):
        """[(largest ratio within the maps, law, keys)], the linear law first, for a choice of the law: each at the rho_k of Poisson's ratio."""
        return [(self.start(law, dimension, poisson, 1e9, mu, test, **keys).ratio, law, keys) for law, keys in self.laws(dimension)]
