"""Meshes of CalculiX and Abaqus (.inp), and of formats that meshio reads, as gmsh files with sets as physical groups."""
import os
import re
from dataclasses import dataclass, field

import numpy as np

from calibrate.problem import Problem
from convert.source import Source

# Corners of an element: type of gmsh, dimension, name.
SHAPES = {"point": (15, 0, 1), "line": (1, 1, 2), "triangle": (2, 2, 3), "quadrangle": (3, 2, 4), "tetrahedron": (4, 3, 4), "hexahedron": (5, 3, 8),
          "prism": (6, 3, 6), "pyramid": (7, 3, 5)}
# Names in .inp: shape, nodes. Letters for integration and formulation may follow.
ABAQUS = ((r"C3D4", "tetrahedron", 4), (r"C3D10", "tetrahedron", 10), (r"C3D8", "hexahedron", 8), (r"C3D20", "hexahedron", 20),
          (r"C3D27", "hexahedron", 27), (r"C3D6", "prism", 6), (r"C3D15", "prism", 15), (r"C3D5", "pyramid", 5),
          (r"(CPS|CPE|CPEG|CAX|M3D|S|R3D|STRI|DS)3", "triangle", 3), (r"((CPS|CPE|CPEG|CAX|M3D|S)6|STRI65)", "triangle", 6),
          (r"(CPS|CPE|CPEG|CAX|M3D|S|R3D|DS)4", "quadrangle", 4), (r"(CPS|CPE|CPEG|CAX|M3D|S|DS)8", "quadrangle", 8),
          (r"(M3D|S)9", "quadrangle", 9),
          (r"(T2D2|T3D2|B21|B31|R2D2)", "line", 2), (r"(T2D3|T3D3|B22|B32)", "line", 3))
MESHIO = {"vertex": "point", "line": "line", "line3": "line", "triangle": "triangle", "triangle6": "triangle", "triangle7": "triangle",
          "quad": "quadrangle", "quad8": "quadrangle", "quad9": "quadrangle", "tetra": "tetrahedron", "tetra10": "tetrahedron",
          "hexahedron": "hexahedron", "hexahedron20": "hexahedron", "hexahedron27": "hexahedron", "wedge": "prism", "wedge15": "prism",
          "wedge18": "prism", "pyramid": "pyramid", "pyramid13": "pyramid", "pyramid14": "pyramid"}
# Faces S1, S2, ... by corners from 0 on (Abaqus Analysis User's Guide, 28.1.4 and 28.1.3).
FACES = {"tetrahedron": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
         "hexahedron": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
         "prism": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
         "triangle": ((0, 1), (1, 2), (2, 0)), "quadrangle": ((0, 1), (1, 2), (2, 3), (3, 0))}
# Numbers of nodes that elements of a shape may have: gmsh 4.8 writes prisms of 18 nodes as C3D6.
COUNTS = {"tetrahedron": (4, 10), "hexahedron": (8, 20, 27), "prism": (6, 15, 18), "pyramid": (5, 13, 14), "triangle": (3, 6, 7),
          "quadrangle": (4, 8, 9), "line": (2, 3)}
OF_CORNERS = {2: "line", 3: "triangle", 4: "quadrangle"}
LONGEST_NAME = 63


@dataclass
class Mesh:
    """Nodes by number, elements as (shape, corners), and sets: numbers of nodes and of elements by name."""
    nodes: dict = field(default_factory=dict)
    elements: dict = field(default_factory=dict)
    node_sets: dict = field(default_factory=dict)
    element_sets: dict = field(default_factory=dict)
    faces: dict = field(default_factory=dict)     # name: [(shape, corners)]
    inner: set = field(default_factory=set)       # nodes between corners
    dropped: list = field(default_factory=list)
    higher: int = 0


# --- .inp ----------------------------------------------------------------------------------------------

class Inp:
    """Reads the cards of a file one by one."""

    def __init__(self, source):
        self.source, self.mesh, self.skipped, self.parts = source, Mesh(), {}, 0

    def read(self):
        """The mesh of the file."""
        line = 0
        lines = self.source.lines
        while line < len(lines):
            text = lines[line].strip()
            if not text.startswith("*") or text.startswith("**"):
                if text and not text.startswith("**") and line == 0:
                    raise self.source.refuse(line, 0, f"expected a card such as *NODE, found '{text[:40]}'")
                line += 1
                continue
            last = line + 1
            while last < len(lines) and (not lines[last].lstrip().startswith("*") or lines[last].lstrip().startswith("**")):
                last += 1
            rows = [k for k in range(line + 1, last) if lines[k].strip() and not lines[k].lstrip().startswith("**")]
            self._card(line, text, rows)
            line = last
        if not self.mesh.nodes or not self.mesh.elements:
            raise self.source.refuse(len(lines), 0, f"expected *NODE and *ELEMENT, found {len(self.mesh.nodes)} nodes and {len(self.mesh.elements)} elements")
        if self.skipped:
            self.mesh.dropped.append("cards " + ", ".join(f"*{name} ({count})" for name, count in sorted(self.skipped.items())))
        return self.mesh

    def _card(self, line, text, rows):
        words = [word.strip() for word in text[1:].split(",")]
        name = re.sub(r"\s+", " ", words[0]).upper()
        given = {}
        for word in words[1:]:
            key, _, value = word.partition("=")
            given[key.strip().upper()] = value.strip().strip('"')
        readers = {"NODE": self._nodes, "ELEMENT": self._elements, "NSET": self._set, "ELSET": self._set, "SURFACE": self._surface}
        if name == "INCLUDE":
            raise self.source.refuse(line, 0, "expected the mesh in one file, found *INCLUDE: put the other file in its place")
        if name in ("INSTANCE", "PART"):
            self.parts += name == "INSTANCE"
            if self.parts > 1 or (name == "INSTANCE" and rows):
                raise self.source.refuse(line, 0, "expected one part in its own coordinates, found several instances or one that is moved")
        elif name in readers:
            readers[name](line, name, given, rows)
        elif name not in ("HEADING", "END PART", "END INSTANCE", "ASSEMBLY", "END ASSEMBLY"):
            self.skipped[name] = self.skipped.get(name, 0) + 1

    @staticmethod
    def _spelled(sets, name):
        """The name as it was first written: capitals do not matter in these files."""
        return next((one for one in sets if one.upper() == name.upper()), name)

    def _named(self, sets, name):
        """The set of a name, which is made if there is none."""
        return sets.setdefault(self._spelled(sets, name), set())

    def _cells(self, row):
        """[(column, text)] of the values of a line; a comma at its end adds none."""
        text, out, at = self.source.lines[row], [], 0
        for part in text.split(","):
            if part.strip():
                out.append((at + len(part) - len(part.lstrip()), part.strip()))
            at += len(part) + 1
        return out

    def _whole(self, row, cell, what):
        if not re.fullmatch(r"\+?\d{1,15}", cell[1]):
            raise self.source.refuse(row, cell[0], f"expected {what}, found '{cell[1][:40]}'")
        return int(cell[1])

    def _nodes(self, line, _, given, rows):
        if given.get("SYSTEM", "R").upper() not in ("R", ""):
            raise self.source.refuse(line, 0, f"expected Cartesian coordinates, found SYSTEM={given['SYSTEM']}")
        for row in rows:
            cells = self._cells(row)
            number = self._whole(row, cells[0], "the number of a node")
            if not 3 <= len(cells) <= 4:
                raise self.source.refuse(row, 0, f"expected number and 2 or 3 coordinates, found {len(cells)} values")
            if number in self.mesh.nodes:
                raise self.source.refuse(row, cells[0][0], f"expected every node once, found node {number} again")
            x = [self.source.number(row, column, text.upper().replace("D", "E"), "coordinate") for column, text in cells[1:]]
            self.mesh.nodes[number] = tuple(x + [0.0] * (3 - len(x)))
            if "NSET" in given:
                self._named(self.mesh.node_sets, given["NSET"]).add(number)

    def _elements(self, line, _, given, rows):
        kind = given.get("TYPE", "").upper()
        found = [(shape, count) for pattern, shape, count in ABAQUS if re.fullmatch(pattern + "[A-Z]*", kind)]
        if not found:
            raise self.source.refuse(line, 0, f"expected elements of a known type (C3D4, C3D8, C3D10, CPS3, S4, T3D2, ...), found TYPE={kind or 'none'}")
        shape, count = found[0]
        corners = SHAPES[shape][2]
        cells, first = [], None
        for row in rows:
            first = row if first is None else first
            cells += [(row, cell) for cell in self._cells(row)]
            if len(cells) < count + 1 or (len(cells) > count + 1 and self.source.lines[row].rstrip().endswith(",")):
                continue
            if len(cells) - 1 != count and len(cells) - 1 not in COUNTS[shape]:
                raise self.source.refuse(*((cells[count + 1][0], cells[count + 1][1][0])), f"expected number and {count} nodes, found {len(cells)} values")
            values = [self._whole(at, cell, "the number of an element or node") for at, cell in cells]
            self._element(first, shape, values[0], values[1:corners + 1], values[corners + 1:])
            if "ELSET" in given:
                self._named(self.mesh.element_sets, given["ELSET"]).add(values[0])
            cells, first = [], None
        if cells:
            raise self.source.refuse(first, 0, f"expected number and {count} nodes, found {len(cells)} values before the next card (cut short?)")

    def _element(self, row, shape, number, corners, inner):
        if number in self.mesh.elements:
            raise self.source.refuse(row, 0, f"expected every element once, found element {number} again")
        for one in corners + inner:
            if one not in self.mesh.nodes:
                raise self.source.refuse(row, 0, f"expected a node of *NODE, found {one} in element {number}")
        if len(set(corners)) < len(corners):
            raise self.source.refuse(row, 0, f"expected different corners, found one twice in element {number}")
        self.mesh.elements[number] = (shape, corners)
        self.mesh.inner.update(inner)
        self.mesh.higher += bool(inner)

    def _set(self, line, card, given, rows):
        sets, items, what = ((self.mesh.node_sets, self.mesh.nodes, "node") if card == "NSET" else
                             (self.mesh.element_sets, self.mesh.elements, "element"))
        name = given.get(card, "")
        if not name:
            raise self.source.refuse(line, 0, f"expected *{card}, {card}=NAME, found no name")
        members = self._named(sets, name)
        for row in rows:
            cells = self._cells(row)
            if "GENERATE" in given:
                bounds = [self._whole(row, cell, "a number") for cell in cells]
                if len(bounds) not in (2, 3) or bounds[-1] == 0 and len(bounds) == 3:
                    raise self.source.refuse(row, 0, f"expected first, last and step, found {len(bounds)} numbers")
                step = bounds[2] if len(bounds) == 3 else 1
                members.update(one for one in items if bounds[0] <= one <= bounds[1] and (one - bounds[0]) % step == 0)
                continue
            for cell in cells:
                known = self._spelled(sets, cell[1])
                if known in sets:
                    members |= sets[known]
                    continue
                one = self._whole(row, cell, f"the number of a {what} or the name of a set above")
                if one not in items:
                    raise self.source.refuse(row, cell[0], f"expected a known {what}, found {one}")
                members.add(one)

    def _surface(self, line, _, given, rows):
        name = given.get("NAME", "")
        if given.get("TYPE", "ELEMENT").upper() != "ELEMENT" or not name:
            self.skipped["SURFACE"] = self.skipped.get("SURFACE", 0) + 1
            return
        faces = self.mesh.faces.setdefault(name, [])
        for row in rows:
            cells = self._cells(row)
            face = re.fullmatch(r"S(\d)", cells[1][1].upper()) if len(cells) == 2 else None
            if not face:
                raise self.source.refuse(row, 0, "expected an element or a set of elements, and a face S1 to S6")
            key = self._spelled(self.mesh.element_sets, cells[0][1])
            for number in sorted(self.mesh.element_sets[key]) if key in self.mesh.element_sets else [self._whole(row, cells[0], "an element or a set above")]:
                shape, corners = self.mesh.elements.get(number, ("", ()))
                sides = FACES.get(shape, ())
                if not 1 <= int(face[1]) <= len(sides):
                    raise self.source.refuse(row, cells[1][0], f"expected a face of element {number} ({shape or 'unknown'}), found {cells[1][1]}")
                side = [corners[k] for k in sides[int(face[1]) - 1]]
                faces.append((OF_CORNERS[len(side)], side))


# --- meshio --------------------------------------------------------------------------------------------

def of_meshio(path):
    """The mesh of a file that meshio reads."""
    try:
        import meshio
    except ModuleNotFoundError:
        raise Problem(f"{path}: expected a file of particles or an .inp mesh; meshes of other formats need the Python module meshio: "
                      "Debian package python3-meshio", 3) from None
    try:
        found = meshio.read(path)
    except (Exception, SystemExit) as error:  # pylint: disable=broad-except
        raise Problem(f"{path}: expected a mesh that meshio reads, found something else ({str(error)[:200] or type(error).__name__})") from None
    mesh = Mesh()
    points = np.asarray(found.points, float)
    if not np.all(np.isfinite(points)):
        raise Problem(f"{path}: expected finite coordinates, found others")
    mesh.nodes = {k + 1: tuple(list(x) + [0.0] * (3 - len(x))) for k, x in enumerate(points.tolist())}
    number, begin, unknown = 0, [], {}
    for block in found.cells:
        begin.append(number)
        shape = MESHIO.get(block.type)
        for cell in block.data:
            number += 1
            if not shape:
                unknown[block.type] = unknown.get(block.type, 0) + 1
                continue
            corners = [int(one) + 1 for one in cell]
            mesh.elements[number] = (shape, corners[:SHAPES[shape][2]])
            mesh.inner.update(corners[SHAPES[shape][2]:])
            mesh.higher += len(corners) > SHAPES[shape][2]
    mesh.dropped += [f"{count} elements of the type {kind}" for kind, count in unknown.items()]
    for name, blocks in found.cell_sets.items():
        members = {begin[b] + int(k) + 1 for b, rows in enumerate(blocks) if rows is not None for k in rows} & set(mesh.elements)
        mesh.element_sets.setdefault(str(name), set()).update(members)
    for name, rows in found.point_sets.items():
        mesh.node_sets.setdefault(str(name), set()).update(int(k) + 1 for k in rows)
    names = {(int(tag), int(dimension)): name for name, (tag, dimension) in found.field_data.items()}
    for b, tags in enumerate(found.cell_data.get("gmsh:physical", [])):
        for k, tag in enumerate(tags):
            one = begin[b] + k + 1
            if one in mesh.elements and tag:
                dimension = SHAPES[mesh.elements[one][0]][1]
                mesh.element_sets.setdefault(names.get((int(tag), dimension), f"group{int(tag)}"), set()).add(one)
    return mesh


# --- writing -------------------------------------------------------------------------------------------

def read(path):
    """The mesh of a file."""
    with open(path, "rb") as file:
        content = file.read()
    if os.path.splitext(path)[1].lower() == ".inp" or re.match(rb"\s*\*(\*|[A-Za-z])", content):
        return Inp(Source(path, content)).read()
    if content.startswith((b"$MeshFormat", b"$NOD", b"$PhysicalNames", b"$Comments")):
        raise Problem(f"{path}: expected a mesh of another program, found one of gmsh: gneiss reads .msh itself (of format 1: gmsh -save -format msh41)")
    mesh = of_meshio(path)
    if not mesh.elements:
        raise Problem(f"{path}: expected a mesh with elements, found {len(mesh.nodes)} nodes and no element")
    return mesh


def _groups(mesh):
    """[(dimension, name, [(shape, corners)])]; an element set of several dimensions becomes several groups."""
    out = []
    for name, members in mesh.node_sets.items():
        points = [("point", [one]) for one in sorted(members - mesh.inner)]
        if len(points) < len(members):
            mesh.dropped.append(f"{len(members) - len(points)} nodes between corners in the set {name}")
        out.append((0, name + " nodes" if name in mesh.element_sets or name in mesh.faces else name, points))
    for name, members in mesh.element_sets.items():
        for dimension in (1, 2, 3):
            out.append((dimension, name, [mesh.elements[one] for one in sorted(members) if SHAPES[mesh.elements[one][0]][1] == dimension]))
    for name, faces in mesh.faces.items():
        for dimension in (1, 2):
            out.append((dimension, name + " faces" if name in mesh.element_sets else name, [one for one in faces if SHAPES[one[0]][1] == dimension]))
    return [(dimension, name[:LONGEST_NAME].replace('"', "'"), elements) for dimension, name, elements in out if elements]


def _entities(mesh, groups):
    """{(dimension, tags of groups): {shape: [corners]}}: elements with the same groups are an entity; an element is written once."""
    tags_of = {}
    for tag, (_, _, elements) in enumerate(groups, 1):
        for shape, nodes in elements:
            tags_of.setdefault((shape, tuple(nodes)), []).append(tag)
    for shape, nodes in mesh.elements.values():
        tags_of.setdefault((shape, tuple(nodes)), [])
    entities = {}
    for (shape, nodes), tags in tags_of.items():
        entities.setdefault((SHAPES[shape][1], tuple(sorted(set(tags)))), {}).setdefault(shape, []).append(nodes)
    return entities


def written(mesh, scale):
    """A gmsh file of format 4.1, and its groups."""
    mesh.inner -= {one for _, nodes in mesh.elements.values() for one in nodes}
    if mesh.higher:
        mesh.dropped.append(f"{len(mesh.inner)} nodes between the corners of {mesh.higher} elements of higher order")
    kept = sorted(one for one in mesh.nodes if one not in mesh.inner)
    place = {one: k + 1 for k, one in enumerate(kept)}
    groups = _groups(mesh)
    entities = sorted(_entities(mesh, groups).items())
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
    lines += [f'{dimension} {tag} "{name}"' for tag, (dimension, name, _) in enumerate(groups, 1)]
    lines += ["$EndPhysicalNames", "$Entities", " ".join(str(sum(key[0] == d for key, _ in entities)) for d in range(4))]
    for number, ((dimension, tags), _) in enumerate(entities, 1):
        lines.append(f"{number} " + "0 " * (6 if dimension else 3) + " ".join(map(str, (len(tags),) + tags)) + (" 0" if dimension else ""))
    last = entities[-1][0][0]
    lines += ["$EndEntities", "$Nodes", f"1 {len(kept)} 1 {len(kept)}", f"{last} {len(entities)} 0 {len(kept)}"]
    lines += [str(place[one]) for one in kept] + [" ".join(repr(scale * x) for x in mesh.nodes[one]) for one in kept]
    blocks = [(number, dimension, shape, rows) for number, ((dimension, _), shapes) in enumerate(entities, 1) for shape, rows in shapes.items()]
    count = sum(len(rows) for _, _, _, rows in blocks)
    lines += ["$EndNodes", "$Elements", f"{len(blocks)} {count} 1 {count}"]
    at = 0
    for number, dimension, shape, rows in blocks:
        lines.append(f"{dimension} {number} {SHAPES[shape][0]} {len(rows)}")
        for nodes in rows:
            at += 1
            lines.append(f"{at} " + " ".join(str(place[one]) for one in nodes))
    return "\n".join(lines + ["$EndElements"]) + "\n", groups


def volume(mesh):
    """Volume of the solid elements, or area of the plane ones if there are no others."""
    total = {2: 0.0, 3: 0.0}
    for shape, nodes in mesh.elements.values():
        x = np.array([mesh.nodes[one] for one in nodes])
        if shape in ("triangle", "quadrangle"):
            total[2] += 0.5 * np.linalg.norm(sum(np.cross(x[k] - x[0], x[k + 1] - x[0]) for k in range(1, len(x) - 1)))
        elif shape in FACES or shape == "pyramid":
            total[3] += _solid(shape, x)
    return (total[3], "m3") if total[3] else (total[2], "m2")


PYRAMID = ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4))


def _solid(shape, x):
    """Sum of the tetrahedra from the mean of the corners to its faces, each divided from its mean."""
    middle, total = x.mean(axis=0), 0.0
    for side in FACES.get(shape, PYRAMID):
        face, centre = x[list(side)], x[list(side)].mean(axis=0)
        total += sum(abs(np.dot(centre - middle, np.cross(face[k] - middle, face[(k + 1) % len(face)] - middle))) for k in range(len(face))) / 6.0
    return total
