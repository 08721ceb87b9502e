"""Points with radii of VTK files: legacy (text and binary) and XML (.vtp, .vtu). Formats: VTK file formats, VTK User's Guide."""
import base64
import re
import xml.etree.ElementTree as ElementTree
import zlib

import numpy as np

from calibrate.problem import Problem
from convert.particles import ALIASES, SPINS, VELOCITIES, Particles, from_mass, scale_lengths

LEGACY_TYPES = {"unsigned_char": "u1", "char": "i1", "unsigned_short": "u2", "short": "i2", "unsigned_int": "u4", "int": "i4", "float": "f4",
                "double": "f8", "vtktypeint64": "i8", "vtkidtype": "i8", "unsigned_long": "u8", "long": "i8"}
XML_TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8",
             "Float32": "f4", "Float64": "f8"}
VECTORS = {**dict.fromkeys(("v", "vel", "velocity", "linvelvec"), VELOCITIES), **dict.fromkeys(("omega", "spin", "angvelvec", "angvel"), SPINS)}
MOST = 1 << 40  # bytes of one array


def particles_of(points, arrays, renamed, path):
    """Particles of points [n][3] and arrays by name."""
    particles = Particles()
    particles.columns.update({a: np.array(points[:, k], float) for k, a in enumerate("xyz")})
    left_out = []
    for name, values in arrays.items():
        wanted = renamed.get(name, name).lower()
        if len(values) != len(points):
            raise Problem(f"{path}: expected {len(points)} values of '{name}', one for each point, found {len(values)}")
        if values.ndim == 2 and values.shape[1] == 3 and wanted in VECTORS:
            particles.columns.update({column: values[:, k].astype(float) for k, column in enumerate(VECTORS[wanted])})
        elif values.ndim == 1 and wanted in ALIASES and ALIASES[wanted][0] not in particles.columns:
            column, factor = ALIASES[wanted]
            particles.columns[column] = factor * values.astype(float)
        elif wanted != "mass":
            left_out.append(name)
    if left_out:
        particles.dropped.append(f"arrays {', '.join(left_out)}")
    mass = {name.lower(): values for name, values in arrays.items()}.get("mass")
    return particles, mass


def _finish(points, arrays, cells, options, path):
    particles, mass = particles_of(points, arrays, options.renamed, path)
    scale_lengths(particles, options.scale)
    if mass is not None and "radius" in particles.columns:
        from_mass(particles, mass)
    if cells and cells != len(points):
        particles.dropped.append(f"{cells} cells")
    return particles, lambda row, name, text: f"{path}: {text}" if row is None else f"{path}: point {row} (base 0): {text}"


# --- legacy files --------------------------------------------------------------------------------------

class Legacy:
    """Reads words and arrays of a legacy file from a position on."""

    def __init__(self, path, content):
        self.path, self.content, self.at, self.binary = path, content, 0, False

    def refuse(self, text, at=None):
        """An error: line and column in a text, the byte in a binary file."""
        at = self.at if at is None else at
        if self.binary:
            return Problem(f"{self.path}: byte {at}: {text}")
        before = self.content[:at]
        return Problem(f"{self.path}:{before.count(10) + 1}:{len(before) - before.rfind(10)}: {text}")

    def line(self):
        """The next line that is not blank; None at the end."""
        while self.at < len(self.content):
            end = self.content.find(b"\n", self.at)
            end = len(self.content) if end < 0 else end
            text, self.begin = self.content[self.at:end].decode("latin-1").strip(), self.at
            self.at = end + 1
            if text:
                return text
        return None

    def array(self, count, kind, what):
        """`count` numbers of a type of the file."""
        if kind.lower() not in LEGACY_TYPES:
            raise self.refuse(f"expected a type of numbers ({', '.join(LEGACY_TYPES)}) of {what}, found '{kind[:40]}'", self.begin)
        code = LEGACY_TYPES[kind.lower()]
        left = len(self.content) - self.at
        if self.binary:
            size = count * int(code[1])
            if size > left:
                raise self.refuse(f"expected {size} bytes of {what}, found {max(left, 0)} to the end of the file (cut short?)")
            values = np.frombuffer(self.content, ">" + code, count, self.at)
            self.at += size
            return values.astype(code)
        if count > (left + 1) // 2:
            raise self.refuse(f"expected {count} numbers of {what}, found the end of the file (cut short?)", self.begin)
        values = np.empty(count)
        for k in range(count):
            found = re.compile(rb"\s*(\S+)").match(self.content, self.at)
            if not found:
                raise self.refuse(f"expected {count} numbers of {what}, found the end of the file after {k} (cut short?)")
            try:
                values[k] = float(found[1])
            except ValueError:
                raise self.refuse(f"expected a number of {what}, found '{found[1][:40].decode('latin-1')}'", found.start(1)) from None
            self.at = found.end()
        return values


def _whole(file, text, what):
    if not re.fullmatch(r"\d{1,12}", text):
        raise file.refuse(f"expected a number of {what}, found '{text[:40]}'", file.begin)
    return int(text)


def _attribute(file, words, count, arrays):
    """Reads one attribute of points; False: the line is none."""
    kind = words[0].upper()
    if kind == "SCALARS" and len(words) in (3, 4):
        width = _whole(file, words[3], "components") if len(words) == 4 else 1
        back = file.at
        table = (file.line() or "").split()
        if table[:1] != ["LOOKUP_TABLE"]:
            file.at = back
        values = file.array(count * width, words[2], words[1])
        arrays[words[1]] = values if width == 1 else values.reshape(count, width)
    elif kind in ("VECTORS", "NORMALS") and len(words) == 3:
        arrays[words[1]] = file.array(count * 3, words[2], words[1]).reshape(count, 3)
    elif kind == "TENSORS" and len(words) == 3:
        arrays[words[1]] = file.array(count * 9, words[2], words[1]).reshape(count, 9)
    elif kind == "FIELD" and len(words) == 3:
        for _ in range(_whole(file, words[2], "arrays")):
            head = (file.line() or "").split()
            if len(head) != 4:
                raise file.refuse("expected name, components, rows and type of an array", getattr(file, "begin", file.at))
            width, rows = _whole(file, head[1], "components"), _whole(file, head[2], "rows")
            values = file.array(width * rows, head[3], head[0])
            arrays[head[0]] = values if width == 1 else values.reshape(rows, width)
    else:
        return kind in ("METADATA", "LOOKUP_TABLE", "INFORMATION", "NAME", "DATA")
    return True


def _cells(file, words):
    """Skips lines such as VERTICES n size; the number of cells."""
    count = _whole(file, words[1], "cells")
    if len(words) > 2:
        size = _whole(file, words[2], "numbers")
        head = file.at
        offsets = (file.line() or "").split()
        if offsets[:1] == ["OFFSETS"]:
            file.array(count, offsets[1], "offsets")
            connected = (file.line() or "").split()
            file.array(size, connected[1] if len(connected) > 1 else "", "connectivity")
            return count - 1
        file.at = head
        file.array(size, "int", words[0])
    else:
        file.array(count, "int", words[0])
    return count


def read_legacy(path, content, options):
    """Particles of POLYDATA or UNSTRUCTURED_GRID with an array of radii."""
    file = Legacy(path, content)
    file.line(), file.line()
    form = (file.line() or "").upper()
    if form not in ("ASCII", "BINARY"):
        raise file.refuse(f"expected ASCII or BINARY, found '{form[:40]}'", getattr(file, "begin", 0))
    points, arrays, cells, of_points, skipped = None, {}, 0, True, {}
    data = (file.line() or "").split()
    if len(data) != 2 or data[0].upper() != "DATASET" or data[1].upper() not in ("POLYDATA", "UNSTRUCTURED_GRID"):
        raise file.refuse(f"expected DATASET POLYDATA or UNSTRUCTURED_GRID, found '{' '.join(data)[:40]}'", file.begin)
    file.binary = form == "BINARY"
    while (text := file.line()) is not None:
        words = text.split()
        kind = words[0].upper()
        if kind == "POINTS" and len(words) == 3:
            points = file.array(3 * _whole(file, words[1], "points"), words[2], "points").reshape(-1, 3)
        elif kind in ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS") and len(words) == 3:
            cells += _cells(file, words)
        elif kind == "CELL_TYPES" and len(words) == 2:
            _cells(file, words)
        elif kind in ("POINT_DATA", "CELL_DATA") and len(words) == 2:
            of_points, count = kind == "POINT_DATA", _whole(file, words[1], "values")
        elif points is None or not _attribute(file, words, count if "count" in locals() else 0, arrays if of_points else skipped):
            raise file.refuse(f"expected POINTS, cells or data of points, found '{text[:40]}'", file.begin)
    if points is None:
        raise file.refuse("expected POINTS, found the end of the file (cut short?)")
    particles, refuse = _finish(points, arrays, cells, options, path)
    if skipped:
        particles.dropped.append(f"data of cells: {', '.join(skipped)}")
    return particles, refuse


# --- XML -----------------------------------------------------------------------------------------------

class Xml:
    """An XML file of VTK; appended data are cut off before it is parsed, as they may be raw bytes."""

    def __init__(self, path, content):
        self.path = path
        found = re.search(rb"<AppendedData[^>]*>", content)
        self.appended, self.encoding = b"", ""
        text = content
        if found:
            start = content.find(b"_", found.end())
            if start < 0:
                raise Problem(f"{path}: AppendedData: expected data behind '_', found the end of the file (cut short?)")
            self.appended = content[start + 1:]
            self.encoding = (re.search(rb'encoding\s*=\s*"([^"]*)"', found[0]) or [b"", b"raw"])[1].decode("latin-1")
            text = content[:found.start()] + b"</VTKFile>"
        if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
            raise Problem(f"{path}: expected no DOCTYPE in a VTK file, found one")
        try:
            self.root = ElementTree.fromstring(text)
        except ElementTree.ParseError as error:
            line, column = error.position
            raise Problem(f"{path}:{line}:{column + 1}: {error.msg}") from None
        if self.root.tag != "VTKFile":
            raise Problem(f"{path}:1:1: expected VTKFile, found {self.root.tag}")
        self.order = "<" if self.root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self.head = self.order + ("u8" if self.root.get("header_type") == "UInt64" else "u4")
        self.compressor = self.root.get("compressor")
        if self.compressor not in (None, "vtkZLibDataCompressor"):
            raise Problem(f"{path}: expected data without compression or by zlib, found {self.compressor}")

    def _encoded(self, text, what):
        """The bytes of an array in base64: header and data are encoded one after the other."""
        try:
            width = int(self.head[2])
            first = base64.b64decode(text[:64].split(b"<")[0].strip()[:(width + 2) // 3 * 4])
            count = int(np.frombuffer(first, self.head, 1)[0]) if len(first) >= width else 0
            if self.compressor:
                size = (3 + count) * width
                if size > len(text):
                    raise ValueError
                mark = (size + 2) // 3 * 4
                head = base64.b64decode(text[:mark])
                rest = sum(int(n) for n in np.frombuffer(head, self.head, 3 + count)[3:])
                return head[:size] + base64.b64decode(text[mark:mark + (rest + 2) // 3 * 4])
            return base64.b64decode(text[:(width + count + 2) // 3 * 4])
        except ValueError:  # binascii.Error is one
            raise Problem(f"{self.path}: {what}: expected data in base64, found something else (cut short?)") from None

    def _decode(self, data, what):
        """The bytes of an array from its header and blocks."""
        width = int(self.head[2])
        heads = np.frombuffer(data[:width * (len(data[:3 * width]) // width)], self.head)
        if not self.compressor:
            if len(heads) < 1 or int(heads[0]) > len(data) - width:
                raise Problem(f"{self.path}: {what}: expected {int(heads[0]) if len(heads) else 'some'} bytes, found {max(len(data) - width, 0)} (cut short?)")
            return data[width:width + int(heads[0])]
        if len(heads) < 3 or (3 + int(heads[0])) * width > len(data):
            raise Problem(f"{self.path}: {what}: expected the sizes of compressed blocks, found the end of the data (cut short?)")
        sizes = np.frombuffer(data, self.head, 3 + int(heads[0]))[3:]
        at, out = (3 + len(sizes)) * width, []
        for size in sizes:
            try:
                unpacker = zlib.decompressobj()
                out.append(unpacker.decompress(data[at:at + int(size)], max(int(heads[1]), 1)))
            except zlib.error as error:
                raise Problem(f"{self.path}: {what}: {error} (cut short?)") from None
            at += int(size)
        return b"".join(out)

    def array(self, element):
        """Values of a DataArray, [n] or [n][components]."""
        what = f"array '{element.get('Name', '')}'"
        kind, form = XML_TYPES.get(element.get("type")), element.get("format", "ascii")
        if not kind:
            raise Problem(f"{self.path}: {what}: expected numbers, found {element.get('type')}")
        if form == "ascii":
            try:
                values = np.array((element.text or "").split(), float)
            except ValueError as error:
                raise Problem(f"{self.path}: {what}: {error}") from None
        else:
            if form == "appended":
                offset = int(element.get("offset", "0")) if element.get("offset", "0").isdigit() else 0
                data = self.appended[offset:]
                data = self._decode(data if self.encoding == "raw" else self._encoded(data, what), what)
            else:
                data = self._decode(self._encoded((element.text or "").strip().encode(), what), what)
            values = np.frombuffer(data[:len(data) // int(kind[1]) * int(kind[1])], self.order + kind).astype(kind)
        width = element.get("NumberOfComponents", "1")
        width = int(width) if width.isdigit() and int(width) > 0 else 1
        if len(values) % width:
            raise Problem(f"{self.path}: {what}: expected a multiple of {width} values, found {len(values)} (cut short?)")
        return values.reshape(-1, width) if width > 1 else values


def read_xml(path, content, options):
    """Particles of PolyData or UnstructuredGrid with an array of radii; pieces are put one after the other."""
    file = Xml(path, content)
    if file.root.get("type") not in ("PolyData", "UnstructuredGrid"):
        raise Problem(f"{path}:1:1: expected VTKFile of the type PolyData or UnstructuredGrid, found {file.root.get('type')}")
    points, arrays, cells = [], {}, 0
    for piece in file.root.iter("Piece"):
        place = piece.find("Points/DataArray")
        if place is None:
            raise Problem(f"{path}: expected Points in every Piece, found none")
        points.append(np.array(file.array(place), float).reshape(-1, 3))
        wanted = piece.get("NumberOfPoints", "")
        if wanted.isdigit() and int(wanted) != len(points[-1]):
            raise Problem(f"{path}: expected {wanted} points in a Piece, found {len(points[-1])} (cut short?)")
        cells += sum(int(piece.get(name, "0")) for name in ("NumberOfCells", "NumberOfVerts", "NumberOfLines", "NumberOfPolys")
                     if piece.get(name, "0").isdigit())
        for element in piece.iterfind("PointData/DataArray"):
            arrays.setdefault(element.get("Name", ""), []).append(file.array(element))
    if not points:
        raise Problem(f"{path}: expected a Piece, found none (cut short?)")
    return _finish(np.concatenate(points), {name: np.concatenate(parts) for name, parts in arrays.items()}, cells, options, path)


def written(particles):
    """A .vtp file with a vertex for each particle; numbers as text, so that they are read back as the same doubles."""
    c, n = particles.columns, len(particles)
    zero = np.zeros(n)

    def array(name, values, width=1, kind="Float64"):
        numbers = " ".join(str(int(v)) if kind == "Int64" else repr(float(v)) for v in np.ravel(values))
        return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" format="ascii">{numbers}</DataArray>'
    lines = ['<?xml version="1.0"?>', '<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">', "<PolyData>",
             f'<Piece NumberOfPoints="{n}" NumberOfVerts="{n}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">', "<PointData>"]
    for name in ("radius", "density"):
        if name in c:
            lines.append(array(name, c[name]))
    for name in ("id", "type", "matId", "group"):
        if name in c:
            lines.append(array(name, c[name], kind="Int64"))
    for name, columns in (("velocity", VELOCITIES), ("spin", SPINS)):
        if any(one in c for one in columns):
            lines.append(array(name, np.column_stack([c.get(one, zero) for one in columns]), 3))
    lines += ["</PointData>", "<Points>", array("points", np.column_stack([c["x"], c["y"], c.get("z", zero)]), 3), "</Points>", "<Verts>",
              array("connectivity", np.arange(n), kind="Int64"), array("offsets", np.arange(1, n + 1), kind="Int64"), "</Verts>",
              "</Piece>", "</PolyData>", "</VTKFile>"]
    return "\n".join(lines) + "\n"
