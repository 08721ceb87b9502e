"""Particles as columns, in SI."""
import math
from dataclasses import dataclass, field

import numpy as np

from calibrate.problem import Problem

PLACES = ("x", "y", "z")
VELOCITIES, SPINS = ("vx", "vy", "vz"), ("wx", "wy", "wz")
NUMBERS = PLACES + ("radius", "density") + VELOCITIES + SPINS
WHOLE = ("id", "type", "matId", "group")
COLUMNS = ("id",) + PLACES + ("radius", "material", "type", "matId", "group", "density") + VELOCITIES + SPINS
LENGTHS = PLACES + ("radius",) + VELOCITIES
# Names in other programs' files, in lower case: column, factor.
ALIASES = {
    **{name.lower(): (name, 1.0) for name in COLUMNS},
    "r": ("radius", 1.0), "rad": ("radius", 1.0), "radii": ("radius", 1.0), "d": ("radius", 0.5), "diameter": ("radius", 0.5), "diam": ("radius", 0.5),
    "omegax": ("wx", 1.0), "omegay": ("wy", 1.0), "omegaz": ("wz", 1.0), "rho": ("density", 1.0), "materialid": ("matId", 1.0),
    "xu": ("x", 1.0), "yu": ("y", 1.0), "zu": ("z", 1.0),
    "particle_id": ("id", 1.0), "atom_id": ("id", 1.0),
}
LONGEST = 2 ** 53


@dataclass
class Particles:
    """Columns by name, equally long, and sentences about what was read and left out."""
    columns: dict = field(default_factory=dict)
    dropped: list = field(default_factory=list)
    notes: list = field(default_factory=list)
    dimension: int = 3

    def __len__(self):
        return len(self.columns["x"]) if "x" in self.columns else 0

    def volume(self):
        """Sum of the volumes of all spheres, m3 (2D: areas of discs, m2)."""
        r = self.columns["radius"]
        return float(np.sum(4.0 / 3.0 * np.pi * r ** 3 if self.dimension == 3 else np.pi * r ** 2))


def from_mass(particles, mass):
    """Takes the density from masses in kg unless it is known."""
    if "density" in particles.columns:
        return
    r = particles.columns["radius"]
    with np.errstate(all="ignore"):
        particles.columns["density"] = mass / (4.0 / 3.0 * np.pi * r ** 3 if particles.dimension == 3 else np.pi * r ** 2)
    particles.notes.append("density: mass over volume")


def rounded(products):
    """[n] products with a factor of units: the numbers of 15 digits where these are within the rounding of factor and product (2**-51).

    The factor 999.9999999999999 of g/cm3 makes 1899.9999999999998 of 1.9, which becomes 1900."""
    short = np.array([float(f"{one:.15g}") for one in products])
    with np.errstate(invalid="ignore"):
        return np.where(np.abs(short - products) <= 2.0 ** -51 * np.abs(products), short, products)


def converted(values, factor):
    """[n] values * factor in SI; products with a power of two are exact and remain."""
    with np.errstate(over="ignore"):  # check refuses inf
        products = values * factor
    return products if math.frexp(factor)[0] == 0.5 else rounded(products)


def scale_lengths(particles, scale):
    """Multiplies lengths and velocities by metres per unit."""
    for name in LENGTHS:
        if name in particles.columns:
            particles.columns[name] = converted(particles.columns[name], scale)


def check(particles, refuse):
    """Checks ranges; `refuse(row, column, text)` makes the error of a row."""
    c = particles.columns
    for name in ("x", "y", "radius") + (("z",) if particles.dimension == 3 else ()):
        if name not in c:
            raise Problem(refuse(None, name, f"expected a column {name}, found {' '.join(c) or 'none'}"))
    if not len(particles):
        raise Problem(refuse(None, "x", "no particles: expected at least one"))
    for name in NUMBERS:
        bad = np.flatnonzero(~np.isfinite(c[name])) if name in c else ()
        if len(bad):
            raise Problem(refuse(int(bad[0]), name, f"expected a finite {name}, found {c[name][bad[0]]:g}"))
    for name in ("radius", "density"):
        bad = np.flatnonzero(~(c[name] > 0)) if name in c else ()
        if len(bad):
            raise Problem(refuse(int(bad[0]), name, f"expected a {name} > 0, found {c[name][bad[0]]:g}"))
    for name in WHOLE:
        if name not in c:
            continue
        value = np.asarray(c[name], float)
        least = 1 if name == "type" else 0
        bad = np.flatnonzero((value != np.floor(value)) | (value < least) | (value > LONGEST))
        if len(bad):
            raise Problem(refuse(int(bad[0]), name, f"expected a whole {name} >= {least}, found {value[bad[0]]:g}"))
        c[name] = value.astype(np.int64)
    if "id" in c:
        order = np.argsort(c["id"], kind="stable")
        twice = np.flatnonzero(np.diff(c["id"][order]) == 0)
        if len(twice):
            row = int(order[twice[0] + 1])
            raise Problem(refuse(row, "id", f"expected every id once, found {c['id'][row]} again"))
