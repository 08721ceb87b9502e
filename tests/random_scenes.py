"""Random small scenes over the whole range of what gneiss runs, at the default settings of the step, and how they end.

    random_scenes.py --seed N --write DIR          writes scene N (scene.yaml and what it reads)
    random_scenes.py PROGRAM --seed N              runs scene N and says how it ended
    random_scenes.py PROGRAM --seeds FIRST LAST    runs FIRST .. LAST - 1; a line for each that did not end well, then a table

A scene is a function of its seed alone. Speeds, forces and times are chosen from the scene's own stiffness and masses so that no
overlap comes near a radius: whatever goes bad then is the doing of the step, not of the scene.
"""
import argparse
import collections
import functools
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

# Environment without the leak checker, if there is one: its tracer occasionally fails after a program with threads
# has ended, and other tests search for leaks.
ENVIRONMENT = {**os.environ, "OMP_WAIT_POLICY": "passive",
               "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"}
KINDS = ("lattice", "gas", "periodic", "sizes", "bodies", "elements", "bonds")
AXES = "xyz"
# Seeds that fail, {seed: reason}: still open (docs/evidence/collisions.md).
OPEN = {}


class Draw(random.Random):
    def log(self, low, high):
        return math.exp(self.uniform(math.log(low), math.log(high)))

    def chance(self, p):
        return self.random() < p

    def direction(self, dim):
        while True:
            v = [self.uniform(-1, 1) for _ in range(dim)]
            size = math.sqrt(sum(x * x for x in v))
            if 0.1 < size < 1:
                return [x / size for x in v]


def rounded(value):
    """Rounds to seven digits, so that a scene is readable."""
    if isinstance(value, float):
        return float(f"{value:.7g}")
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(item) for item in value]
    return value


# --- particles --------------------------------------------------------------------------------------------

def free_place(rows, x, r, allowed=1.0):
    return all(sum((a - b) ** 2 for a, b in zip(x, row)) >= allowed * (r + row[-1]) ** 2 * (1 + 1e-9) for row in rows)


def scattered(d, dim, radii, fill):
    """Places the particles in a box, separate from each other; the lower corner of the box is at 0."""
    volume = sum((math.pi if dim == 2 else 4 / 3 * math.pi) * r**dim for r in radii)
    side = max((volume / fill) ** (1 / dim), 2.5 * max(radii))
    rows = []
    for r in sorted(radii, reverse=True):
        for _ in range(200):
            x = [d.uniform(r, side - r) for _ in range(dim)]
            if free_place(rows, x, r):
                rows.append([*x, r])
                break
    return rows, [0.0] * dim, [side] * dim


def grown(d, dim, radii, gap):
    """Places each particle beside another, at a gap of up to `gap`; if that is negative they overlap."""
    rows, allowed = [], 1 + min(0.0, gap / min(radii))
    for r in sorted(radii, reverse=True):
        for _ in range(50):
            if not rows:
                rows.append([0.0] * dim + [r])
                break
            base, way = d.choice(rows), d.direction(dim)
            far = base[-1] + r + gap * d.random() + 1e-6 * r
            x = [a + far * e for a, e in zip(base, way)]
            if free_place(rows, x, r, allowed):
                rows.append([*x, r])
                break
    lower = [min(row[a] - row[-1] for row in rows) for a in range(dim)]
    upper = [max(row[a] + row[-1] for row in rows) for a in range(dim)]
    return rows, lower, upper


def lattice_section(d, dim, r):
    kind = d.choice(("square", "hexagonal") if dim == 2 else ("cubic", "fcc", "hcp"))
    most = {"square": 14, "hexagonal": 9, "cubic": 6, "fcc": 4, "hcp": 4}[kind]
    cells = [d.randint(1, most) for _ in range(dim)]
    spacing = d.choice((1.0, 1.0001, d.uniform(0.97, 1.0), d.uniform(1.0, 1.05), d.uniform(1.05, 1.2)))
    jitter = d.choice((0.0, 0.0, d.uniform(0, 0.02)))
    return {"kind": kind, "radius": r, "cells": cells, "spacing": spacing, "jitter": jitter}


# Edges of a cell and its last positions, relative to the distance of nearest neighbours.
CELL = {"square": (1, 1), "hexagonal": (1, math.sqrt(3)), "cubic": (1, 1, 1), "fcc": (math.sqrt(2),) * 3,
        "hcp": (1, math.sqrt(3), math.sqrt(8 / 3))}
LAST = {"square": (0, 0), "hexagonal": (0.5, math.sqrt(3) / 2), "cubic": (0, 0, 0), "fcc": (math.sqrt(0.5),) * 3,
        "hcp": (0.5, math.sqrt(4 / 3), math.sqrt(2 / 3))}


def lattice_cells(part):
    return [2 * part["radius"] * part["spacing"] * c * n for c, n in zip(CELL[part["kind"]], part["cells"])]


def lattice_box(part):
    """Corners of the box around the particles, which walls need and a scene does not state."""
    edge, r, shift = 2 * part["radius"] * part["spacing"], part["radius"], part["jitter"] * part["radius"]
    cells = zip(CELL[part["kind"]], LAST[part["kind"]], part["cells"])
    return [-shift] * len(part["cells"]), [2 * r + edge * (c * (n - 1) + last) + shift for c, last, n in cells]


# --- one scene --------------------------------------------------------------------------------------------

class Maker:
    """Draws one scene. Time and length scales are drawn first; all other quantities are relative to them."""

    def __init__(self, seed):
        self.d = d = Draw(f"gneiss {seed}")
        self.beams = Draw(f"beams {seed}")  # a generator of its own, so that other draws keep their values
        self.kind = KINDS[seed % len(KINDS)]
        self.dim = d.choice((2, 3, 3))
        self.r = d.log(1e-4, 1e-1)
        self.files = {}
        self.scene = {"title": f"random scene {seed} ({self.kind})", "dimension": self.dim}
        self.particles()
        self.material()
        self.damping()
        self.scales()
        self.motion()
        if self.kind == "bodies":
            self.bodies()
        if self.kind == "elements":
            self.elements()
        self.walls()
        self.settings()
        self.open_box(Draw(f"open along an axis {seed}"))
        if d.chance(0.15):
            self.far()
        self.by_area(Draw(f"gneiss by area {seed}"))
        self.bond_laws(Draw(f"gneiss laws of bonds {seed}"))
        self.outputs(Draw(f"gneiss outputs {seed}"))

    # Particles of small and large size in one scene, or all of almost equal size.
    def particles(self):
        d, dim = self.d, self.dim
        ratio = d.log(1.5, 100) if self.kind == "sizes" else d.choice((1.0, 1.0, d.log(1.0, 5.0)))
        count = d.randint(2, 200)
        if self.kind == "sizes":
            large = d.randint(1, 6)
            radii = [self.r * d.uniform(0.7, 1) for _ in range(large)]
            radii += [self.r / ratio * d.uniform(1, 1.3) for _ in range(count // 2)]
        else:
            radii = [self.r / d.log(1.0, ratio) for _ in range(count)]
        self.lattice = self.kind == "lattice" or self.kind in ("bonds", "bodies", "elements", "periodic") and d.chance(0.5)
        self.rmin, self.rmax, self.touching = min(radii), max(radii), False
        self.gap = self.rmin * d.log(1e-4, 0.5)
        if self.lattice:
            self.rmin = self.rmax = self.r
            part = lattice_section(d, dim, self.r)
            self.scene["specimen"] = {"lattice": part}
            self.lower, self.upper = lattice_box(part)
            self.gap = self.r * max(2 * (part["spacing"] - 1), 1e-4)
            self.touching = part["spacing"] <= 1 and part["jitter"] == 0 and max(part["cells"]) > 1
        else:
            if self.kind in ("gas", "periodic") and d.chance(0.7):
                rows, self.lower, self.upper = scattered(d, dim, radii, d.uniform(0.05, 0.3))
                self.gap = 0.3 * self.rmin
            else:
                self.touching = d.chance(0.4)
                rows, self.lower, self.upper = grown(d, dim, radii, -0.01 * self.rmin if self.touching else self.gap)
            self.scene["specimen"] = {"particles": rows}
            self.rmin, self.rmax = min(row[-1] for row in rows), max(row[-1] for row in rows)
        self.bonded = self.kind == "bonds" or self.kind in ("lattice", "bodies", "elements", "sizes") and d.chance(0.2)
        if self.bonded:
            self.scene["bonds"] = {"interaction_range": d.choice((0.05, d.uniform(0, 0.3))),
                                   "passive_gaps": d.chance(0.7)}

    def material(self):
        d = self.d
        laws = ("uniform", "arithmetic", "harmonic", "mean_radius", "mean_arithmetic", "mean_harmonic")
        law = d.choice(laws if self.touching else laws[:3])
        self.scene["law"] = {"stiffness": law, "contact_arm": d.choice(("midpoint", "midpoint", "radius")),
                             "rotation": d.choice(("auto", "auto", "auto", "off"))}
        self.density, self.modulus = d.log(1e2, 2e4), d.log(1e5, 1e11)
        self.kratio, self.mu = d.choice((0.0, d.log(0.8, 20))), d.choice((0.0, d.uniform(0, 1)))
        self.k = self.modulus * self.r
        self.uniform = law == "uniform"
        if self.bonded and self.kratio > 0 and self.scene["law"]["rotation"] != "off" and self.beams.chance(0.5):
            self.scene["bonds"].update(radius_multiplier=self.beams.log(0.05, 5), moment_share=self.beams.choice((0, 0.5, 1)))
        self.scene["materials"] = [self.one_material("a", self.density)]
        self.light = self.heavy = self.density
        if d.chance(0.4):
            self.second()

    def one_material(self, name, density):
        d, strain = self.d, self.d.log(1e-4, 1e-1)
        m = {"name": name, "density": density, "kratio": self.kratio, "friction": self.mu}
        if self.uniform:
            m["normal_stiffness"] = self.k
            if self.bonded:
                m["bond_tension_limit"] = self.k * self.r * strain
                m["bond_shear_limit"] = m["bond_tension_limit"] * d.uniform(0.5, 3)
        else:
            m["contact_modulus"] = self.modulus
            if self.bonded:
                m["tensile_strength"] = self.modulus * strain
                m["shear_strength"] = m["tensile_strength"] * d.uniform(0.5, 3)
        return m

    def second(self):
        """Another material for some of the particles: denser or lighter, harder or softer."""
        d = self.d
        density = self.density * d.log(1e-3, 1e3) if d.chance(0.5) else self.density
        m = self.one_material("b", density)
        if not self.uniform:
            m["contact_modulus"] *= d.log(0.1, 10)
            self.modulus = min(self.modulus, m["contact_modulus"])
        self.light, self.heavy = min(density, self.density), max(density, self.density)
        self.scene["materials"].append(m)
        self.scene["specimen"]["material"] = "a"
        self.scene.setdefault("sets", []).append({"name": "other", "select": self.some(), "material": "b"})

    def by_area(self, d):
        """Replaces the drawn law by a law by area, and draws bonds and contacts for it: with a separate generator, so
        that the other scenes keep their values."""
        materials, law = self.scene["materials"], self.scene["law"]
        if not self.uniform and d.chance(0.3):
            law["stiffness"] = d.choice(("dempack", "polyhedron"))
            if not self.lattice or d.chance(0.5):
                law["gamma"] = d.uniform(0.3, 1.5)
            for m in materials:
                m.update(young=m.pop("contact_modulus"), poisson=d.uniform(0, 0.45), alpha=d.uniform(0.5, 2))
                m["beta"] = d.uniform(0, 2) if m.pop("kratio") else 0
        if self.bonded and d.chance(0.3):
            materials[0]["strength_scatter"] = {"distribution": "weibull", "modulus": d.log(1, 20)}
        if self.bonded and d.chance(0.2):
            materials[0]["stiffness_scatter"] = {"distribution": "normal", "deviation": d.uniform(0.01, 0.3)}
        if d.chance(0.15):
            self.scene["contacts"] = [{"between": materials[-1]["name"], "friction": d.uniform(0, 1)}]
        for m in materials:
            if not (m.get("kratio") or m.get("beta")):
                m["friction"] = 0  # a load that no spring could carry, which is refused
                for contact in self.scene.get("contacts", []):
                    contact["friction"] = 0

    def outputs(self, d):
        """Output on request, drawn separately."""
        if d.chance(0.3):
            self.scene["output"]["contacts"] = "on"
        if self.bonded and d.chance(0.2):
            self.scene["output"]["fields"] = ["fragment", "fragment_size"]

    def bond_laws(self, d):
        """Friction of bonds, couplings, softening and yield, with a separate generator; with the keys that bonds with
        moments require."""
        materials, law, beams = self.scene["materials"], self.scene["law"], "radius_multiplier" in self.scene.get("bonds", {})
        if not self.bonded or not d.chance(0.6) or not all(m.get("kratio") or m.get("beta") for m in materials):
            return
        if d.chance(0.7):
            for m in materials:
                m["bond_friction"] = d.log(0.05, 2)
            law["coupling"] = d.choice(("none", "quadratic", "linear"))
            law["confinement"] = d.choice(("own", "own", "mean"))
        else:
            law["coupling"] = d.choice(("none", "quadratic"))
        if d.chance(0.2):
            self.scene["output"]["events"] = "off"
        if beams:
            return
        law["softening"] = d.choice(("none", "energy", "strain", "ratio"))
        for m in materials:
            self.softening_of(m, law["softening"], d)
        if d.chance(0.4):
            self.yield_of(d.choice(materials), d)
        if law["softening"] == "energy" and d.chance(0.5):
            law["softening_curve"] = "bilinear"
            if d.chance(0.5):
                law.update(kink_stress=d.uniform(0.05, 0.9), initial_energy=d.uniform(0.05, 0.95))

    def softening_of(self, m, softening, d):
        """0.01 to 50 times the elastic stretch of a bond of the largest particles; some are too short to soften at
        all."""
        width, wide = 2 * self.r, 1 + d.log(0.01, 50)
        if self.uniform:
            strength, strain = m["bond_tension_limit"] / width ** (self.dim - 1), m["bond_tension_limit"] / self.k / width
        else:
            strength = m["tensile_strength"]
            strain = strength / (m.get("contact_modulus") or m["young"] * m["alpha"])
        across = wide * d.log(0.3, 10)
        if softening == "ratio":
            m["fracture_ratio"] = wide - 1
        elif softening == "strain":
            m["fracture_strain"] = strain * wide
            if d.chance(0.7):
                m["shear_fracture_strain"] = strain * across
        elif softening == "energy":
            m["fracture_energy"] = 0.5 * strength * strain * width * wide
            if d.chance(0.7):
                m["shear_fracture_energy"] = 0.5 * strength * strain * width * across

    def yield_of(self, m, d):
        stress = m["bond_tension_limit"] / (2 * self.r) ** (self.dim - 1) if self.uniform else m["tensile_strength"]
        ratio = 1.0
        for k in range(d.randint(1, 3)):
            stress, ratio = stress * d.log(1.05 if k else 0.1, 10), ratio * d.log(1, 5)
            m.update({f"yield_stress_{k + 1}": stress, f"yield_ratio_{k + 1}": ratio})

    def count(self):
        if not self.lattice:
            return len(self.scene["specimen"]["particles"])
        part = self.scene["specimen"]["lattice"]
        return math.prod(part["cells"]) * {"hexagonal": 2, "fcc": 4, "hcp": 4}.get(part["kind"], 1)

    def some(self, exact=False):
        """Half of the particles; of a lattice those on one side, which may be all."""
        d = self.d
        if not self.lattice or exact:
            n = self.count()
            return {"ids": sorted(d.sample(range(n), max(1, n // 2)))}
        axis = d.randrange(self.dim)
        low, high = [x - 1e3 * self.r for x in self.lower], [x + 1e3 * self.r for x in self.upper]
        high[axis] = 0.5 * (self.lower[axis] + self.upper[axis]) + 0.2 * self.r
        return {"box": {"min": low, "max": high}}

    def damping(self):
        d = self.d
        part = {}
        self.restitution = 1.0
        if d.chance(0.6):
            if d.chance(0.75):
                part["contact"] = {"restitution": d.choice((1.0, 0.0, 0.9, 0.5, 0.2, d.random()))}
                self.restitution = part["contact"]["restitution"]
            else:
                part["contact"] = {"fraction": d.uniform(0.01, 1)}
                self.restitution = 0.3
        self.background = d.choice(("none", "none", "viscous", "nonviscous_vector", "nonviscous_component"))
        if self.background != "none":
            part["background"] = {"model": self.background, "coefficient": d.uniform(0, 0.9)}
            if self.background == "nonviscous_component":
                part["background"]["velocity"] = d.choice(("half_step", "instant"))
        if part:
            self.scene["damping"] = part

    def mass(self, r, density):
        return density * (math.pi * r * r if self.dim == 2 else 4 / 3 * math.pi * r**3)

    def scales(self):
        """Shortest and longest half wave of a contact, and how long the run is: a few thousand steps."""
        d = self.d
        soft = self.k if self.uniform else self.modulus * self.rmin
        stiff = self.k if self.uniform else max(m["contact_modulus"] for m in self.scene["materials"]) * self.rmax
        least, most = self.mass(self.rmin, self.light), self.mass(self.rmax, self.heavy)
        self.short = math.pi * math.sqrt(0.5 * least / (stiff if self.rmin * 3 > self.rmax or self.uniform else
                                                        stiff * self.rmin / self.rmax))
        self.long = math.pi * math.sqrt(most / soft)
        steps = d.randint(500, 3000)
        each = self.short / (12 if self.restitution > 0.95 else 30 if self.restitution > 0.6 else 100)
        if self.bonded and self.kind != "sizes":
            each = self.short / 12
        self.end = steps * each
        self.scene["time"] = {"end": self.end}
        # Limits the overlap to a tenth of the smallest radius: speed times the duration of a contact.
        self.speed = d.log(1e-3, 0.1) * self.rmin / min(self.long, self.end)
        self.soft, self.stiff, self.least, self.most = soft, stiff, least, most
        if self.background == "viscous":
            self.scene["damping"]["background"]["coefficient"] = d.log(1e-2, 1) / self.short

    def motion(self):
        d, sets = self.d, self.scene.setdefault("sets", [])
        if d.chance(0.6) or self.kind in ("gas", "periodic"):
            self.scene["initial"] = {"random_velocity": self.speed}
        if d.chance(0.3):
            # The lowest particle carries the whole weight: its overlap must be small.
            height = (self.upper[-1] - self.lower[-1]) / self.rmin
            sag = d.log(1e-4, 2e-2) * self.rmin
            self.scene["gravity"] = [0.0] * (self.dim - 1) + [-sag * self.soft / (self.most * height)]
        if d.chance(0.4):
            spin = {"initial_spin": self.vector(self.speed / self.rmax) if self.dim == 3 else self.speed / self.rmax}
            sets.append({"name": "thrown", "select": self.some(), "initial_velocity": self.vector(self.speed),
                         **({} if self.scene["law"]["rotation"] == "off" else spin)})
        if d.chance(0.3) and self.count() > 1:
            held = {"v" + a: 0.0 for a in AXES[:self.dim]}
            if d.chance(0.5):
                held[d.choice(list(held))] = d.choice((self.speed, -self.speed, [[0, 0], [self.end, self.speed]]))
            if d.chance(0.2):
                held.pop(d.choice(list(held)))
            sets.append({"name": "held", "select": self.some(exact=True), "motion": held})
        if d.chance(0.1):
            sets.append({"name": "pushed", "select": {"all": True},
                         "force": self.vector(1e-3 * self.soft * self.rmin)})
        if not sets:
            del self.scene["sets"]

    def vector(self, size):
        return [size * x for x in self.d.direction(self.dim)]

    def surface_law(self):
        """Stiffness and friction of walls, bodies and elements."""
        d = self.d
        part = {"stiffness": d.choice((self.stiff, self.stiff, self.soft * d.log(0.3, 10)))}
        if d.chance(0.6):
            part.update(kratio=d.log(0.8, 10), friction=d.uniform(0, 0.8))
        return part

    def walls(self):
        """Draws the walls: none, a floor, or a box that is at rest, closes, shears or is loaded."""
        d, dim = self.d, self.dim
        if self.kind == "periodic":
            if self.lattice:
                part = self.scene["specimen"]["lattice"]
                part["cells"] = [max(c, 3) for c in part["cells"]]
                self.scene["periodic"] = {"min": [0.0] * dim, "max": lattice_cells(part)}
            else:
                room = max(0.0, 6 * self.rmax - min(b - a for a, b in zip(self.lower, self.upper)))
                self.scene["periodic"] = {"min": self.lower, "max": [x + room + self.gap for x in self.upper]}
            return
        free = {"bodies": 0.7, "elements": 0.7, "bonds": 0.4}.get(self.kind, 0.1)
        if d.chance(free):
            return
        law, sides = self.surface_law(), []
        axes = range(dim) if d.chance(0.6) else [dim - 1]
        if self.kind in ("bodies", "elements"):
            axes = range(dim - 1)
        for axis in axes:
            sides += [(axis, -1), (axis, 1)]
        style = d.choice(("stand", "close", "close", "shear", "servo"))
        self.scene["walls"] = [self.wall(axis, side, style, law) for axis, side in sides]

    def open_box(self, d):
        """Two in five periodic boxes are open along one axis, most of them with plates there that are at rest, close,
        shear or press."""
        if self.kind != "periodic" or not d.chance(0.4):
            return
        axis = d.choice(range(self.dim))
        self.scene["periodic"]["open"] = AXES[axis]
        if self.lattice:  # the lattice may have grown for the box
            self.lower, self.upper = lattice_box(self.scene["specimen"]["lattice"])
        if d.chance(0.7):
            law = {"stiffness": self.stiff, "kratio": d.log(0.8, 10), "friction": d.uniform(0, 0.8)}
            style, kept, self.d = d.choice(("stand", "close", "shear", "servo")), self.d, d
            self.scene["walls"] = [self.wall(axis, side, style, law) for side in (-1, 1)]
            self.d = kept

    def wall(self, axis, side, style, law):
        d = self.d
        normal = [0.0] * self.dim
        normal[axis] = -float(side)
        point = list(self.lower if side < 0 else self.upper)
        point[axis] += side * self.gap * d.random()
        w = {"name": f"{AXES[axis]}{'lower' if side < 0 else 'upper'}", "point": point, "normal": normal, **law}
        path = min(self.speed, (0.05 * self.rmin + self.gap) / self.end)
        if style == "close":
            w["motion"] = {"v" + AXES[axis]: -side * path}
        elif style == "shear":
            w["motion"] = {"v" + AXES[(axis + 1) % self.dim]: side * self.speed}
        elif style == "servo" and side > 0:
            w["servo"] = {"force": d.log(1e-4, 1e-2) * self.soft * self.rmin, "max_velocity": self.speed}
            if d.chance(0.3):
                w["servo"]["relaxation"] = d.random()
        return w

    # Bodies below and above the particles, of which the upper one may be free.
    def bodies(self):
        d, dim = self.d, self.dim
        up = dim - 1
        size = [b - a for a, b in zip(self.lower, self.upper)]
        margin = 2 * self.rmax
        under = self.lower[up] - self.gap * d.random()
        low = [self.lower[a] - margin for a in range(dim)]
        bodies = [{"name": "base", **self.base_shape(low, size, margin, under), **self.surface_law()}]
        style = d.choice(("stand", "push", "shake"))
        if style == "push":
            bodies[0]["motion"] = {"v" + AXES[up]: min(self.speed, (0.05 * self.rmin + self.gap) / self.end)}
        elif style == "shake":
            bodies[0]["motion"] = {"vx": [[0, 0], [0.5 * self.end, self.speed], [self.end, -self.speed]]}
        if d.chance(0.7):
            bodies.append(self.free_body(size))
        self.scene["bodies"] = bodies

    def base_shape(self, low, size, margin, under):
        d, thick = self.d, self.rmax
        if self.dim == 2:
            if d.chance(0.5):
                steps = 5
                width = size[0] + 2 * margin
                points = [[low[0] + width * i / steps, under - d.random() * thick * 0.5] for i in range(steps + 1)]
                return {"polyline": points}
            return {"polygon": [[low[0], under - thick], [low[0] + size[0] + 2 * margin, under - thick],
                                [low[0] + size[0] + 2 * margin, under], [low[0], under]]}
        if d.chance(0.4):
            self.files["base.stl"] = rough_ground(d, low, [s + 2 * margin for s in size], under, 0.5 * thick)
            return {"surface": "base.stl"}
        return {"box": {"size": [size[0] + 2 * margin, size[1] + 2 * margin, thick]},
                "origin": [low[0], low[1], under - thick]}

    def free_body(self, size):
        d, dim = self.d, self.dim
        edge = max(2 * self.rmax, 0.5 * size[0])
        middle = 0.5 * (self.lower[0] + self.upper[0]) - 0.5 * edge
        over = self.upper[-1] + self.gap * d.random() + 1e-3 * self.rmin
        body = {"name": "block", "free": True, "density": d.log(self.light, self.heavy * 1.001) * d.log(0.3, 3),
                **self.surface_law()}
        if dim == 2:
            body["polygon"] = [[middle, over], [middle + edge, over], [middle + 0.8 * edge, over + 0.7 * edge]]
        else:
            body["box"] = {"size": [edge, edge * d.uniform(0.5, 1), edge * d.uniform(0.3, 1)]}
            body["origin"] = [middle, 0.5 * (self.lower[1] + self.upper[1]) - 0.4 * edge, over]
        # The speed is limited as for particles: the body is stopped within a tenth of the smallest radius.
        heavy = body["density"] * edge**dim
        slow = 0.1 * self.rmin / min(self.end, math.pi * math.sqrt(heavy / body["stiffness"]))
        speed = min(self.speed, slow)
        body["initial_velocity"] = self.vector(speed)[:-1] + [-speed]
        if d.chance(0.5):
            body["initial_spin"] = self.vector(speed / edge) if dim == 3 else speed / edge
        return body

    # A block of elements below the particles; its wave speed is limited by the size of its cells.
    def elements(self):
        d, dim = self.d, self.dim
        cells = [d.randint(2, 4) for _ in range(dim)]
        size = [b - a + 2 * self.rmax for a, b in zip(self.lower, self.upper)]
        size[-1] = max(self.rmax, 0.2 * max(size)) * d.uniform(0.5, 2)
        origin = [self.lower[a] - self.rmax for a in range(dim - 1)]
        origin.append(self.lower[-1] - size[-1] - self.gap * d.random())
        least = min(s / c for s, c in zip(size, cells))
        density = self.light * d.log(0.3, 3)
        cross = self.short * d.log(0.1, 3)
        part = {"rectangle" if dim == 2 else "box": {"size": size, "cells": cells, "origin": origin,
                                                    "distortion": d.choice((0.0, 0.1))},
                "formulation": d.choice(("displacement", "displacement", "mixed")),
                "materials": [{"young": density * (least / cross) ** 2, "poisson": d.uniform(0, 0.4), "density": density}],
                "motions": [{"name": "foot", "group": AXES[dim - 1] + "_lower",
                             "motion": {"v" + a: 0.0 for a in AXES[:dim]}}],
                "contact": self.surface_law()}
        self.scene["elements"] = part

    def settings(self):
        d = self.d
        self.scene["output"] = {"snapshots": 0, "history_rows": 50, "checkpoint": "off"}
        self.scene["run"] = {"seed": d.randint(1, 10**6), "threads": 1,
                             "precision": d.choice(("double", "double", "mixed"))}
        if d.chance(0.1):
            self.scene["time"]["estimate"] = "bound"

    def far(self):
        """Moves the scene to a place where a double has lost some digits."""
        extent = max(b - a for a, b in zip(self.lower, self.upper))
        away = [x * extent * self.d.log(1e2, 1e6) for x in self.d.direction(self.dim)]
        move_scene(self.scene, away)
        self.files = {name: moved_stl(text, away) for name, text in self.files.items()}


def rough_ground(d, low, size, under, depth, n=3):
    """Open sheet of triangles below z = under."""
    z = [[under - depth * d.random() for _ in range(n + 1)] for _ in range(n + 1)]
    at = [[(low[0] + size[0] * i / n, low[1] + size[1] * j / n, z[i][j]) for j in range(n + 1)] for i in range(n + 1)]
    text = ["solid ground"]
    for i in range(n):
        for j in range(n):
            a, b, c, e = at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]
            for corners in ((a, b, c), (a, c, e)):
                text += ["facet normal 0 0 1", "outer loop"]
                text += ["vertex " + " ".join(f"{x:.9g}" for x in p) for p in corners]
                text += ["endloop", "endfacet"]
    return "\n".join(text + ["endsolid ground"]) + "\n"


def moved_stl(text, away):
    def vertex(match):
        return "vertex " + " ".join(f"{float(x) + s:.17g}" for x, s in zip(match.group(1).split(), away))
    return re.sub(r"vertex (.*)", vertex, text)


def move_scene(scene, away):
    def moved(x):
        return [a + s for a, s in zip(x, away)]
    specimen = scene["specimen"]
    if "particles" in specimen:
        specimen["particles"] = [moved(row[:-1]) + row[-1:] for row in specimen["particles"]]
    else:
        specimen["lattice"]["origin"] = moved([0.0] * len(away))
    boxes = [s["select"]["box"] for s in scene.get("sets", []) if "box" in s["select"]]
    boxes += [scene["periodic"]] if "periodic" in scene else []
    for box in boxes:
        box.update(min=moved(box["min"]), max=moved(box["max"]))
    for wall in scene.get("walls", []):
        wall["point"] = moved(wall["point"])
    for body in scene.get("bodies", []):
        for shape in ("polyline", "polygon"):
            if shape in body:
                body[shape] = [moved(x) for x in body[shape]]
        if "box" in body:
            body["origin"] = moved(body["origin"])
        if "surface" in body:
            body["reference"] = moved([0.0] * len(away))
    for mesh in ("rectangle", "box"):
        if mesh in scene.get("elements", {}):
            scene["elements"][mesh]["origin"] = moved(scene["elements"][mesh]["origin"])


def exact(scene):
    """Removes superfluous digits if nothing is far away."""
    largest = max((abs(x) for row in scene["specimen"].get("particles", []) for x in row[:-1]), default=0.0)
    largest = max(largest, *map(abs, scene["specimen"].get("lattice", {}).get("origin", [0.0])))
    extent = max((row[-1] for row in scene["specimen"].get("particles", [])), default=0.0)
    extent = max(extent, scene["specimen"].get("lattice", {}).get("radius", 0.0))
    return scene if largest > 1e3 * extent else rounded(scene)


def make(seed):
    """The scene, the files it reads {name: text}, and its kind."""
    maker = Maker(seed)
    return exact(maker.scene), maker.files, maker.kind


def write(seed, folder):
    scene, files, _ = make(seed)
    os.makedirs(folder, exist_ok=True)
    for name, text in files.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)
    path = os.path.join(folder, "scene.yaml")
    with open(path, "w", encoding="utf-8") as file:
        lines = [f"{key}: {json.dumps(value)}" for key, value in scene.items()]
        file.write("\n".join(lines) + "\n")
    return path


# --- how a run ends ---------------------------------------------------------------------------------------

WELL, WARNED, STOPPED, BAD = "ended well", "warned", "stopped with its cause", "went bad"
Outcome = collections.namedtuple("Outcome", "seed kind how text residual steps seconds")
# Errors due to the scene and not to the step.
NAMED = ("left the domain",)


def judged(done, folder):
    """The end of a run, its message, residual and steps."""
    message = " ".join(done.stderr.split())[-400:]
    if done.returncode == 0:
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
            s = json.load(file)
        residual = s["energy_residual"]
        if residual is None or not abs(residual) <= 0.1:
            return BAD, f"residual {residual}, exit code 0", residual, s["steps"]
        warnings = "; ".join(w if isinstance(w, str) else w["name"] for w in s["warnings"])
        return (WARNED if warnings else WELL), warnings, residual, s["steps"]
    if done.returncode == 5 and any(cause in message for cause in NAMED):
        return STOPPED, message, None, None
    return BAD, f"exit code {done.returncode}: {message}", None, None


def run(program, seed, limit=60):
    with tempfile.TemporaryDirectory(prefix="gneiss-") as folder:
        path, out = write(seed, folder), os.path.join(folder, "out")
        kind = KINDS[seed % len(KINDS)]
        start = os.times().elapsed
        try:
            done = subprocess.run([program, "run", path, "--out", out, "--quiet"], capture_output=True, text=True,
                                  errors="replace", timeout=limit, check=False,
                                  env=ENVIRONMENT)
            how, text, residual, steps = judged(done, out)
        except subprocess.TimeoutExpired:
            how, text, residual, steps = BAD, f"not done after {limit} s", None, None
        return Outcome(seed, kind, how, text, residual, steps, os.times().elapsed - start)


def run_all(run_seed, seeds, jobs=2, note=lambda outcome: None):
    """The results of run_seed(seed) for every seed, several of them run at the same time; `note` is called with each
    in turn."""
    with ThreadPoolExecutor(jobs) as pool:
        outcomes = []
        for outcome in pool.map(run_seed, seeds):
            note(outcome)
            outcomes.append(outcome)
        return outcomes


def table(outcomes):
    """Rows: kind, number of scenes, number of each kind of end, the largest residual of completed runs and its seed."""
    rows = []
    for kind in (*KINDS, "all"):
        some = [o for o in outcomes if kind in (o.kind, "all")]
        worst = max((o for o in some if o.residual is not None and o.how != BAD), key=lambda o: abs(o.residual), default=None)
        rows.append([kind, len(some), *(sum(o.how == how for o in some) for how in (WELL, WARNED, STOPPED, BAD)),
                     f"{abs(worst.residual):.2g}" if worst else "-", worst.seed if worst else "-"])
    return ["kind", "scenes", WELL, WARNED, STOPPED, BAD, "largest residual", "its seed"], rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--seeds", type=int, nargs=2)
    parser.add_argument("--write", metavar="DIR")
    options = parser.parse_args()
    if options.write:
        print(write(options.seed, options.write))
        return 0
    seeds = range(*options.seeds) if options.seeds else [options.seed]
    outcomes = run_all(functools.partial(run, options.program), seeds, note=lambda o: (o.how != WELL or options.seed is not None) and print(
        f"seed {o.seed} ({o.kind}, {o.steps} steps, {o.seconds:.1f} s, residual {o.residual}): {o.how}: {o.text}", flush=True))
    head, rows = table(outcomes)
    for row in [head, *rows]:
        print(" | ".join(str(cell) for cell in row))
    return any(o.how == BAD for o in outcomes)


if __name__ == "__main__":
    sys.exit(main())
