"""Data and dump files of LAMMPS and LIGGGHTS, as text. Formats: LAMMPS manual, read_data, write_data, dump."""
import re

import numpy as np

from convert.particles import ALIASES, Particles, from_mass, scale_lengths

SECTION = re.compile(r"\s*([A-Z][A-Za-z]*(?: [A-Za-z0-9]+)*)\s*(?:#\s*(.*?))?\s*$")
IMAGES = ("ix", "iy", "iz")
STYLES = {"sphere": ("id", "type", "diameter", "density", "x", "y", "z"), "granular": ("id", "type", "diameter", "density", "x", "y", "z"),
          "bpm/sphere": ("id", "molecule", "type", "diameter", "density", "x", "y", "z")}
TYPES = {"sphere", "granular"}


def _sections(source):
    """[(name, comment, line)] of a data file."""
    found = []
    for k in range(1, len(source.lines)):
        text = source.lines[k]
        match = SECTION.match(text) if text[:1].isalpha() else None
        if match:
            found.append((match[1], match[2] or "", k))
    return found


def _rows(source, line, count, name):
    """Numbers of the rows of a section: a blank line, then `count` lines."""
    first = line + 1
    while first < len(source.lines) and not source.lines[first].strip():
        first += 1
    for k in range(first, first + count):
        if k >= len(source.lines) or not source.lines[k].strip() or source.lines[k][0].isalpha():
            found = "the end of the file (cut short?)" if k >= len(source.lines) else f"'{source.lines[k][:40]}'"
            raise source.refuse(min(k, len(source.lines)), 0, f"expected {count} lines of {name}, found {found} after {k - first}")
        source.lines[k] = source.lines[k].split("#")[0]
    return list(range(first, first + count))


def _style(source, comment, line, row):
    """Names of the columns of `Atoms`."""
    style, width = comment.split()[0] if comment else "", len(source.lines[row].split())
    if style and style not in STYLES:
        raise source.refuse(line, source.lines[line].index("#"), f"expected an atom style with radii ({', '.join(STYLES)}), found '{comment}'")
    if not style and width not in (7, 10):
        raise source.refuse(row, 0, f"expected 7 or 10 columns (id type diameter density x y z, images), as no style is named, found {width}")
    names = STYLES[style or "sphere"]
    if width not in (len(names), len(names) + 3):
        raise source.refuse(row, 0, f"expected {len(names)} or {len(names) + 3} columns ({' '.join(names)}, images), found {width}")
    return names + (IMAGES if width > len(names) else ())


def read_data(source, options):
    """Particles of a data file with atoms of a style that has radii."""
    particles = Particles()
    heads = [k for k, text in enumerate(source.lines) if re.match(r"\s*\d+\s+atoms\s*(#.*)?$", text)]
    if not heads:
        raise source.refuse(0, 0, "expected a line 'N atoms', found none")
    count = source.count(heads[0], "number of atoms", len(source.lines))
    sections = _sections(source)
    atoms = [one for one in sections if one[0] == "Atoms"]
    if not atoms:
        raise source.refuse(len(source.lines), 0, "expected a section Atoms, found the end of the file (cut short?)")
    if not count:
        raise source.refuse(heads[0], 0, "no particles: expected at least one atom")
    rows = _rows(source, atoms[0][2], count, "Atoms")
    names = _style(source, atoms[0][1], atoms[0][2], rows[0])
    table = dict(zip(names, source.table(rows, names).T))
    for name, column in table.items():
        if name in ALIASES:
            particles.columns[ALIASES[name][0]] = column * ALIASES[name][1]
    for name, comment, line in sections:
        if name == "Velocities":
            _velocities(source, particles, _rows(source, line, count, name))
        elif name != "Atoms":
            particles.dropped.append(f"section {name}")
    if any(np.any(table[name]) for name in IMAGES if name in table):
        particles.dropped.append("images of a periodic box (positions are those inside of it)")
    scale_lengths(particles, options.scale)

    def refuse(row, column, text):
        at = source.fields(rows[row]) if row is not None else []
        place = [k for k, name in enumerate(names) if ALIASES.get(name, ("",))[0] == column]
        return f"{source.path}:{(rows[row] if at else 0) + 1}:{(at[place[0]][0] if at and place else 0) + 1}: {text}"
    return particles, refuse


def _velocities(source, particles, rows):
    width = len(source.lines[rows[0]].split())
    names = ("id", "vx", "vy", "vz") + (("wx", "wy", "wz") if width == 7 else ())
    table = source.table(rows, names)
    row_of = {int(one): k for k, one in enumerate(particles.columns["id"])}
    order = np.empty(len(rows), int)
    for k, one in enumerate(table[:, 0]):
        if int(one) not in row_of:
            raise source.refuse(rows[k], 0, f"expected an id of Atoms, found {one:g}")
        order[row_of[int(one)]] = k
    for place, name in enumerate(names[1:], 1):
        particles.columns[name] = table[order, place]


# --- dumps ---------------------------------------------------------------------------------------------

def _frames(source):
    """Lines at which frames begin."""
    starts = [k for k, text in enumerate(source.lines) if text.startswith("ITEM: TIMESTEP")]
    if not starts:
        raise source.refuse(0, 0, "expected ITEM: TIMESTEP, found none")
    return starts


def _box(source, line):
    """Lower corner and edges [3][3] (rows) of the box of a frame, as the manual's page `dump` defines them."""
    tilted = "xy" in source.lines[line]
    names = ("low", "high") + (("tilt",) if tilted else ())
    for k in range(3):
        source.line(line + 1 + k, "bounds of the box")
    table = source.table(range(line + 1, line + 4), names)
    low, high = table[:, 0].copy(), table[:, 1].copy()
    xy, xz, yz = table[:, 2] if tilted else (0.0, 0.0, 0.0)
    low[0] -= min(0.0, xy, xz, xy + xz)
    high[0] -= max(0.0, xy, xz, xy + xz)
    low[1] -= min(0.0, yz)
    high[1] -= max(0.0, yz)
    edges = np.diag(high - low)
    edges[1, 0], edges[2, 0], edges[2, 1] = xy, xz, yz
    return low, edges


def _items(source, first, last):
    """{name of an item: (rest of its line, line)} of a frame."""
    found = {}
    for k in range(first, last):
        match = re.match(r"ITEM: (TIMESTEP|NUMBER OF ATOMS|BOX BOUNDS|ATOMS|UNITS|TIME|LABEL)\s*(.*)$", source.lines[k])
        if match:
            found[match[1]] = (match[2], k)
    for name in ("NUMBER OF ATOMS", "ATOMS"):
        if name not in found:
            raise source.refuse(last, 0, f"expected ITEM: {name} in the frame that begins in line {first + 1}, found its end (cut short?)")
    return found


def read_dump(source, options):
    """Particles of a frame of a dump: the last one unless options.frame counts another, base 1."""
    particles = Particles()
    starts = _frames(source)
    number = options.frame or len(starts)
    if number > len(starts):
        raise source.refuse(starts[-1], 0, f"expected at least {number} frames (--frame), found {len(starts)}")
    first = starts[number - 1]
    last = starts[number] if number < len(starts) else len(source.lines)
    items = _items(source, first, last)
    line = items["NUMBER OF ATOMS"][1]
    names, head = items["ATOMS"][0].split(), items["ATOMS"][1]
    count = source.count(line + 1, "number of atoms", len(source.lines))
    rows = list(range(head + 1, head + 1 + count))
    if head + 1 + count > last:
        raise source.refuse(last, 0, f"expected {count} lines of atoms, found the end of the frame after {last - head - 1} (cut short?)")
    if len(starts) > 1:
        particles.notes.append(f"frame {number} of {len(starts)}, time step {source.line(first + 1, 'time step').strip()}")
    words = [name for name in names if name in ("element", "mol")]
    table = _columns(source, rows, names, words)
    left_out = []
    for name, column in table.items():
        known = ALIASES.get(options.renamed.get(name, name).lower())
        if known and known[0] not in particles.columns:
            particles.columns[known[0]] = column * known[1]
        elif name not in ("mass", "xs", "ys", "zs", "xsu", "ysu", "zsu"):
            left_out.append(name)
    _unscale(source, particles, table, items)
    scale_lengths(particles, options.scale)
    if left_out + words:
        particles.dropped.append(f"columns {', '.join(left_out + words)}")

    def refuse(row, column, text):
        if row is None:
            return f"{source.path}:{head + 1}:1: {text}"
        place = [k for k, name in enumerate(names) if ALIASES.get(name.lower(), ("",))[0] == column]
        return f"{source.path}:{rows[row] + 1}:{source.fields(rows[row])[place[0] if place else 0][0] + 1}: {text}"
    if "mass" in table and "radius" in particles.columns:
        from_mass(particles, table["mass"])
    return particles, refuse


def _columns(source, rows, names, words):
    """Columns by name; those that hold words are checked for their number alone."""
    if not words:
        return dict(zip(names, source.table(rows, names).T))
    for k in rows:
        fields = source.lines[k].split()
        if len(fields) == len(names):
            source.lines[k] = " ".join("0" if name in words else text for name, text in zip(names, fields))
    table = dict(zip(names, source.table(rows, names).T))
    return {name: column for name, column in table.items() if name not in words}


def _unscale(source, particles, table, items):
    """Positions from those in units of the box."""
    for ending in ("s", "su"):
        if "x" in particles.columns or not all(a + ending in table for a in "xyz"):
            continue
        if "BOX BOUNDS" not in items:
            raise source.refuse(items["ATOMS"][1], 0, "expected ITEM: BOX BOUNDS for positions in units of the box, found none")
        low, edges = _box(source, items["BOX BOUNDS"][1])
        places = low + np.column_stack([table[a + ending] for a in "xyz"]) @ edges
        particles.columns.update(zip("xyz", places.T))


# --- writing -------------------------------------------------------------------------------------------

def _bounds(particles):
    """(low, high) of all spheres along each axis."""
    c, r = particles.columns, particles.columns["radius"]
    out = []
    for a in "xyz":
        x = c.get(a, np.zeros(len(particles)))
        out.append((float(np.min(x - r)), float(np.max(x + r))))
    return out


def _ids(particles):
    """Ids from 1 on: LAMMPS has no atom 0."""
    given = particles.columns.get("id")
    if given is None or np.min(given) < 1:
        return np.arange(1, len(particles) + 1) if given is None else given + 1
    return given


def _types(particles):
    """Types from 1 on: those given, or names of materials numbered in the order of their first row, which a note then states."""
    c = particles.columns
    if "material" in c and ("type" in c or "matId" in c):
        particles.dropped.append("column material: types are those of the column " + ("type" if "type" in c else "matId"))
    if "type" in c:
        return c["type"]
    if "matId" in c:
        return c["matId"] + 1
    if "material" not in c:
        return np.ones(len(particles), int)
    names = list(dict.fromkeys(c["material"]))
    if all(re.fullmatch("[1-9][0-9]{0,8}", name) for name in names):
        number = {name: int(name) for name in names}
    else:
        number = {name: k for k, name in enumerate(names, 1)}
    particles.notes.append("types: " + ", ".join(f"{number[name]} = {name}" for name in names))
    return np.array([number[name] for name in c["material"]], int)


def written_data(particles):
    """A data file of atom style sphere."""
    c, n = particles.columns, len(particles)
    ids, types, zero = _ids(particles), _types(particles), np.zeros(n)
    lines = ["LAMMPS data file, written by gneiss convert", "", f"{n} atoms", f"{int(np.max(types))} atom types", ""]
    lines += [f"{low!r} {high!r} {a}lo {a}hi" for a, (low, high) in zip("xyz", _bounds(particles))]
    lines += ["", "Atoms # sphere", ""]
    for k in range(n):
        values = (2.0 * c["radius"][k], c["density"][k], c["x"][k], c["y"][k], c.get("z", zero)[k])
        lines.append(f"{int(ids[k])} {int(types[k])} " + " ".join(repr(float(v)) for v in values))
    if any(name in c for name in ("vx", "vy", "vz", "wx", "wy", "wz")):
        lines += ["", "Velocities", ""]
        moving = [c.get(name, zero) for name in ("vx", "vy", "vz", "wx", "wy", "wz")]
        lines += [f"{int(ids[k])} " + " ".join(repr(float(one[k])) for one in moving) for k in range(n)]
    return "\n".join(lines) + "\n"


def written_dump(particles):
    """A dump of style custom with one frame."""
    c, n = particles.columns, len(particles)
    ids, types, zero = _ids(particles), _types(particles), np.zeros(n)
    names = [name for name in ("radius", "density", "vx", "vy", "vz", "wx", "wy", "wz") if name in c]
    shown = [{"wx": "omegax", "wy": "omegay", "wz": "omegaz"}.get(name, name) for name in names]
    lines = ["ITEM: TIMESTEP", "0", "ITEM: NUMBER OF ATOMS", str(n), "ITEM: BOX BOUNDS ff ff ff"]
    lines += [f"{low!r} {high!r}" for low, high in _bounds(particles)]
    lines.append("ITEM: ATOMS id type x y z " + " ".join(shown))
    columns = [c["x"], c["y"], c.get("z", zero)] + [c[name] for name in names]
    lines += [f"{int(ids[k])} {int(types[k])} " + " ".join(repr(float(one[k])) for one in columns) for k in range(n)]
    return "\n".join(lines) + "\n"
