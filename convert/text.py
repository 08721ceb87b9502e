"""Rows of text: those of gneiss with named columns, CSV of any program, YADE's textExt, rows x y z r."""
import re

import numpy as np

from calibrate import units
from convert.particles import ALIASES, COLUMNS, LENGTHS, PLACES, SPINS, VELOCITIES, WHOLE, Particles, converted
from convert.source import NUMBER

WORD = re.compile(r'(?:"(?P<quoted>[^"]*)"|(?P<plain>[^\s,\[(]+))(?:\s*[\[(](?P<unit>[^\])]*)[\])])?')
UNITS = {**dict.fromkeys(PLACES + ("radius",), "m"), **dict.fromkeys(VELOCITIES, "m/s"), **dict.fromkeys(SPINS, "rad/s"), "density": "kg/m3"}


def words_of(text):
    """[(column, name, unit or None)] of a header."""
    return [(found.start(), found["plain"] if found["quoted"] is None else found["quoted"], found["unit"]) for found in WORD.finditer(text)]


def yade_words(text):
    """Words of `#format x_y_z_r`; None: the text is something else."""
    found = re.match(r"\s*#\s*format\s+(\S+)", text)
    return [(found.start(1), name, None) for name in found[1].split("_")] if found else None


def _named(source, line, words, options, particles):
    """[(column or None, factor)] for each word of a header."""
    columns, taken, left_out = [], set(), []
    for at, name, unit in words:
        column, factor = ALIASES.get(options.renamed.get(name, name).lower(), (None, 1.0))
        if name == "-":
            column = None
        if column and column in taken:
            raise source.refuse(line, at, f"expected every column once, found {column} again ('{name}')")
        if column is None:
            left_out.append(name)
        elif unit is not None:
            if column not in UNITS:
                raise source.refuse(line, at, f"expected no unit of {column}, found '{unit}'")
            try:
                factor *= units.factor(unit, UNITS[column])
            except ValueError as error:
                raise source.refuse(line, at, str(error)) from None
        elif column in LENGTHS:
            factor *= options.scale
        taken.add(column)
        columns.append((column, factor))
    if left_out:
        particles.dropped.append(f"columns {', '.join(left_out)}")
    return columns


def _header(source, given):
    """(line of the header or -1, its words, line of the first row)."""
    if given:
        return -1, words_of(given.replace(",", " ")), 0
    comment = None
    for k, text in enumerate(source.lines):
        stripped = text.strip()
        if not stripped:
            continue
        if stripped.startswith("#"):
            words = yade_words(text)
            if not words:
                inner = text.replace("#", " ")
                words = words_of(inner)
                known = [ALIASES.get(name.lower(), (None,))[0] for _, name, _ in words]
                words = words if {"x", "y", "radius"} <= set(known) and None not in known else None
            comment = comment or (words and (k, words))
            continue
        text = source.lines[k] = text.split("#")[0]
        first = source.fields(k)[0][1] if source.fields(k) else ""
        if not NUMBER.fullmatch(first) and (first[0].isalpha() or first[0] in '"_') and first.lower() not in ("nan", "inf", "infinity"):
            return k, words_of(text), k + 1
        if comment:
            return comment[0], comment[1], k
        count = len(source.fields(k))
        if count not in (3, 4):
            raise source.refuse(k, 0, f"expected x y z r, a header, or --columns 'x y z r ...', found {count} column{'s' * (count > 1)} without names")
        return -1, [(0, name, None) for name in ("x", "y", "z", "r")[:2 if count == 3 else 3] + ("r",)], k
    return -1, [(0, name, None) for name in "xyzr"], len(source.lines)


def _attributes(words, width):
    """YADE's `attrs` stands for all columns that follow."""
    if words and words[-1][1] == "attrs" and width >= len(words) - 1:
        return words[:-1] + [(words[-1][0], f"attribute {k + 1}", None) for k in range(width - len(words) + 1)]
    return words


def _numbers(source, rows, cells, name):
    """Finite numbers of a column; one by one only if something is wrong."""
    try:
        values = np.array([text for _, text in cells], float)
        if np.all(np.isfinite(values)) and not any("_" in text for _, text in cells):
            return values
    except ValueError:
        pass
    return np.array([source.number(k, *cell, name) for k, cell in zip(rows, cells)], float)


def read(source, options):
    """Particles of rows of text."""
    particles = Particles()
    line, words, first = _header(source, options.columns)
    rows = [k for k in range(first, len(source.lines)) if source.lines[k].split("#")[0].strip()]
    for k in rows:
        source.lines[k] = source.lines[k].split("#")[0]
    words = _attributes(words, len(source.fields(rows[0])) if rows else 0)
    columns = _named(source, max(line, 0), words, options, particles)
    names = [column for column, _ in columns]
    particles.dimension = 3 if "z" in names else 2
    fields = [source.fields(k) for k in rows]
    for k, row in zip(rows, fields):
        if len(row) != len(columns):
            at = row[len(columns)][0] if len(row) > len(columns) else len(source.lines[k])
            raise source.refuse(k, at, f"expected {len(columns)} columns as above, found {len(row)}")
        if ",," in source.lines[k].replace(" ", "") or source.lines[k].lstrip().startswith(","):
            raise source.refuse(k, source.lines[k].index(","), "expected a value between commas, found none")
    for place, (name, factor) in enumerate(columns):
        if name == "material":
            particles.columns[name] = np.array([row[place][1].strip('"') for row in fields], object)
        elif name:
            particles.columns[name] = converted(_numbers(source, rows, [row[place] for row in fields], name), factor)
    places = {name: k for k, (name, _) in enumerate(columns)}

    def refuse(row, column, text):
        if row is None:
            return f"{source.path}:{max(line, 0) + 1}:1: {text}"
        return f"{source.path}:{rows[row] + 1}:{fields[row][places.get(column, 0)][0] + 1}: {text}"
    return particles, refuse


def _value(particles, name, row):
    value = particles.columns[name][row]
    if name in WHOLE:
        return str(int(value))
    if name == "material":
        return f'"{value}"' if re.search(r"[\s,#]", value) else value
    return repr(float(value))


def names_of(particles):
    """Columns that are written, in their order."""
    return [name for name in COLUMNS if name in particles.columns and not (particles.dimension == 2 and name == "z")]


def written(particles, separator=" "):
    """Text with a header and a row for each particle; numbers are read back as the same doubles."""
    names = names_of(particles)
    lines = [separator.join(names)]
    lines += [separator.join(_value(particles, name, k) for name in names) for k in range(len(particles))]
    return "\n".join(lines) + "\n"


def written_yade(particles):
    """YADE's textExt with the format x_y_z_r, or x_y_z_r_matId."""
    c = particles.columns
    number = c["matId"] if "matId" in c else c["type"] - 1 if "type" in c else None
    lines = ["#format x_y_z_r" + ("_matId" if number is not None else "")]
    z = c.get("z", np.zeros(len(particles)))
    for k in range(len(particles)):
        row = [repr(float(v)) for v in (c["x"][k], c["y"][k], z[k], c["radius"][k])]
        lines.append("\t".join(row + ([str(int(number[k]))] if number is not None else [])))
    return "\n".join(lines) + "\n"
