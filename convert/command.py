"""The command `gneiss convert`: recognises a file by its beginning, reads it, checks it and writes another."""
import argparse
import math
import os
import re
import sys

from calibrate import units
from calibrate.problem import Problem, code_of
from calibrate.simulate import write_whole
from convert import esys, lammps, meshes, particles, run, text, vtk
from convert.source import Source

ERRORS = {2: "input error", 3: "file error"}
WRITERS = {".txt": text.written, ".csv": lambda one: text.written(one, ","), ".yade": text.written_yade, ".data": lammps.written_data,
           ".dump": lammps.written_dump, ".geo": esys.written, ".vtp": vtk.written}
KEPT = {".yade": ("x", "y", "z", "radius", "type", "matId"), ".geo": ("x", "y", "z", "radius", "id", "group", "type"),
        ".vtp": tuple(name for name in particles.COLUMNS if name != "material"), ".txt": particles.COLUMNS, ".csv": particles.COLUMNS,
        ".data": tuple(name for name in particles.COLUMNS if name != "group"), ".dump": tuple(name for name in particles.COLUMNS if name != "group")}
DUMP = "dump of LAMMPS or LIGGGHTS"
READERS = (  # beginning of a text, reader
    (r"ITEM:", lammps.read_dump, DUMP),
    (r"LSMGeometry", esys.read, "geometry of ESyS-Particle"),
    (r"[^\n]*\n(?:[^\n]*\n){0,20}?\s*\d+\s+atoms\s*(?:#[^\n]*)?\n", lammps.read_data, "data file of LAMMPS or LIGGGHTS"),
)

# Files without particles: beginning, endings, kind.
SURFACE, MESH = "a surface", "a mesh"
OTHERS = ((rb"ply\r?\n", (".ply", ".stl", ".obj"), SURFACE),
          (rb"\s*\*(\*|[A-Za-z])|\$(MeshFormat|NOD|PhysicalNames|Comments)", (".inp", ".msh", ".bdf", ".nas", ".xdmf", ".med", ".exo"), MESH))


def positive(option, expected, given, value):
    """value(given), a finite number > 0, of an option."""
    try:
        found = value(given)
    except ValueError as error:
        raise Problem(f"{option}: expected {expected}, found '{given}' ({error})") from None
    if not (math.isfinite(found) and found > 0):
        raise Problem(f"{option}: expected {expected}, found '{given}'")
    return found


def options_of(arguments):
    """Options of the command."""
    parser = argparse.ArgumentParser(prog="gneiss convert", allow_abbrev=False)
    parser.add_argument("source")
    parser.add_argument("target")
    parser.add_argument("--length", default="m")
    parser.add_argument("--density")
    parser.add_argument("--as", dest="renamed", action="append", default=[])
    parser.add_argument("--columns")
    parser.add_argument("--frame")
    parser.add_argument("--force", action="store_true")
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    options.scale = positive("--length", "a unit of length such as mm", options.length, lambda one: units.factor(one, "m"))
    if options.density is not None:
        options.density = positive("--density", "a density > 0 such as '2600 kg/m3'", options.density,
                                   lambda one: float(particles.rounded([units.number(one, "kg/m3")])[0]))
    if options.frame is not None and not re.fullmatch("[1-9][0-9]{0,8}", options.frame):
        raise Problem(f"--frame: expected a whole number from 1 on, found '{options.frame}'")
    options.frame = int(options.frame) if options.frame else None
    pairs = [one.partition("=") for one in options.renamed]
    for name, _, column in pairs:
        if not name or column.lower() not in particles.ALIASES:
            raise Problem(f"--as: expected NAME=COLUMN with one of {' '.join(particles.COLUMNS)}, found '{name}={column}'")
    options.renamed = {name: column for name, _, column in pairs}
    return options


def read(path, options):
    """(particles, function that makes the message of a row, name of the format)."""
    if os.path.isdir(path):
        return (*run.read(path, options), "run or packing of gneiss")
    with open(path, "rb") as file:
        content = file.read()
    for beginning, endings, kind in OTHERS:
        if re.match(beginning, content) or os.path.splitext(path)[1].lower() in endings:
            own = "; surface of a scene reads it as it is" if kind == SURFACE else ""
            raise Problem(f"{path}: expected particles, found {kind}: OUT must end with .msh{own}")
    if content[:4] == b"\x89HDF":
        raise Problem(f"{path}: expected the folder of a run, found a file of HDF5: gneiss convert {os.path.dirname(path) or '.'} ...")
    if content.startswith(b"# vtk DataFile"):
        return (*vtk.read_legacy(path, content, options), "legacy VTK file")
    if re.match(rb"\s*(<\?xml|<VTKFile)", content):
        return (*vtk.read_xml(path, content, options), "VTK file in XML")
    source = Source(path, content)
    for pattern, reader, name in READERS:
        if re.match(pattern, source.text):
            return (*reader(source, options), name)
    return (*text.read(source, options), "text with columns")


def convert(options):
    """Converts; prints what was read, what it amounts to, and what was left out."""
    ending = os.path.splitext(options.target)[1].lower()
    if ending not in WRITERS and ending != ".msh":
        raise Problem(f"{options.target}: expected a file that ends with {', '.join(WRITERS)}, or .msh for a mesh, found '{ending}'")
    if os.path.exists(options.target) and not options.force:
        raise Problem(f"{options.target}: expected a new file, found an existing one: --force replaces it")
    if ending == ".msh":
        convert_mesh(options)
        return
    found, refuse, name = read(options.source, options)
    if options.frame is not None and name != DUMP:
        raise Problem(f"--frame: expected a {DUMP} as IN, found {options.source}: {name}")
    particles.check(found, refuse)
    if options.density is not None and "density" not in found.columns:
        found.columns["density"] = particles.np.full(len(found), options.density)
    if ending == ".data" and "density" not in found.columns:
        raise Problem(f"{options.target}: expected densities for a data file of atom style sphere, found none: --density 2600 gives one")
    lost = [column for column in found.columns if column not in KEPT[ending]]
    if lost:
        found.dropped.append(f"columns {', '.join(lost)}, which {ending} has no place for")
    write_whole(options.target, WRITERS[ending](found))
    if not options.quiet:
        report(found, name, options)


def convert_mesh(options):
    """Converts a mesh; prints its size and its groups."""
    for option, given in (("density", options.density), ("as", options.renamed), ("columns", options.columns), ("frame", options.frame)):
        if given:
            raise Problem(f"--{option}: expected particles, found a mesh as OUT: {options.target}")
    mesh = meshes.read(options.source)
    content, groups = meshes.written(mesh, options.scale)
    write_whole(options.target, content)
    if options.quiet:
        return
    size, unit = meshes.volume(mesh)
    print(f"mesh               {len(mesh.nodes)} nodes, {len(mesh.elements)} elements, {size * options.scale ** int(unit[1]):.9g} {unit}")
    for dimension, name, elements in groups:
        print(f"group              {name}: {len(elements)} of dimension {dimension}")
    for one in mesh.dropped:
        print(f"left out           {one}")
    print(f"written            {options.target}")


def report(found, name, options):
    """Prints number, sizes, columns, and what has no place in the new file."""
    r = found.columns["radius"]
    names = " ".join(column for column in particles.COLUMNS if column in found.columns)
    print(f"read               {options.source}: {name}")
    print(f"particles          {len(found)}, radii {r.min():.6g} to {r.max():.6g} m, volume {found.volume():.9g} {'m3' if found.dimension == 3 else 'm2'}")
    print(f"columns            {names}")
    for note in found.notes:
        print(f"note               {note}")
    for one in found.dropped:
        print(f"left out           {one}")
    print(f"written            {options.target}")


def main(arguments):
    """Exit code of the command."""
    try:
        convert(options_of(arguments))
        return 0
    except Problem as error:
        code, message = error.code, str(error)
    except OSError as error:
        code, message = code_of(error), f"{error.filename}: cannot be read: {error.strerror}"
    except MemoryError:
        code, message = 4, "no memory for this file"
    print(f"gneiss: {ERRORS.get(code, 'out of memory')}: {message}", file=sys.stderr)
    return code
