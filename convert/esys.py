"""Geometries of ESyS-Particle and GenGeo (LSMGeometry 1.2): particles x y z radius id tag, and connections."""
import re

import numpy as np

from convert.particles import Particles, scale_lengths

NAMES = ("x", "y", "z", "radius", "id", "tag")


def read(source, options):
    """Particles of a geometry; tags are left out unless options.renamed names a column for them."""
    particles = Particles()
    begin = [k for k, text in enumerate(source.lines) if text.strip() == "BeginParticles"]
    if not begin:
        raise source.refuse(len(source.lines), 0, "expected BeginParticles, found the end of the file (cut short?)")
    kind = source.line(begin[0] + 1, "kind of particles").strip()
    if kind != "Simple":
        raise source.refuse(begin[0] + 1, 0, f"expected particles of the kind Simple, found '{kind[:40]}'")
    count = source.count(begin[0] + 2, "number of particles", len(source.lines))
    first = begin[0] + 3
    if first + count >= len(source.lines):
        raise source.refuse(len(source.lines), 0, f"expected {count} particles and EndParticles, found the end of the file (cut short?)")
    if source.lines[first + count].strip() != "EndParticles":
        raise source.refuse(first + count, 0, f"expected EndParticles, found '{source.lines[first + count][:40]}'")
    rows = range(first, first + count)
    table = dict(zip(NAMES, source.table(rows, NAMES).T))
    column = options.renamed.get("tag")
    if column:
        particles.columns[column] = table["tag"]
    elif np.any(table["tag"] != 0):
        particles.dropped.append(f"tags ({len(np.unique(table['tag']))} different ones; --as tag=group or --as tag=type keeps them)")
    particles.columns.update({name: table[name] for name in NAMES[:5]})
    bonds = [k for k, text in enumerate(source.lines) if text.strip() == "BeginConnect"]
    if bonds:
        particles.dropped.append(f"{source.count(bonds[0] + 1, 'number of connections')} connections (the section bonds of a scene makes its own)")
    if any(re.match(r"PeriodicBoundaries.*1", text) for text in source.lines[:begin[0]]):
        particles.dropped.append("periodic boundaries (the section periodic of a scene)")
    scale_lengths(particles, options.scale)
    return particles, lambda row, name, text: f"{source.path}:{(first + row if row is not None else 0) + 1}:1: {text}"


def written(particles):
    """A geometry of simple particles; the tag is the group, else the type, else 0."""
    c, n = particles.columns, len(particles)
    r, zero = c["radius"], np.zeros(n)
    tag = c.get("group", c.get("type", zero))
    ids = c.get("id", np.arange(n))
    places = [c["x"], c["y"], c.get("z", zero)]
    box = [repr(float(np.min(x - r))) for x in places] + [repr(float(np.max(x + r))) for x in places]
    lines = ["LSMGeometry 1.2", "BoundingBox " + " ".join(box), "PeriodicBoundaries 0 0 0", f"Dimension {particles.dimension}D",
             "BeginParticles", "Simple", str(n)]
    lines += [" ".join(repr(float(x[k])) for x in places + [r]) + f" {int(ids[k])} {int(tag[k])}" for k in range(n)]
    return "\n".join(lines + ["EndParticles", "BeginConnect", "0", "EndConnect"]) + "\n"
