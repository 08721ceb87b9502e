"""Particle files with columns, and `gneiss convert`. Speaks TAP. The files of other programs are written here in their formats."""
import base64
import contextlib
import io
import random
import types
import zlib

from program import *  # noqa: F403

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))
from calibrate.problem import Problem  # noqa: E402
from convert import command as converter  # noqa: E402
from convert import meshes  # noqa: E402
from convert import particles as columns_of  # noqa: E402

SCENE = {"specimen": {"file": "particles.txt"},
         "materials": [{"name": "rock", "density": 2600, "contact_modulus": 1e9, "kratio": 2, "friction": 0.5},
                       {"name": "clay", "density": 1500, "contact_modulus": 1e8, "kratio": 2, "friction": 0.5}],
         "law": {"stiffness": "harmonic"}, "time": {"end": 1e-6}}
WITHOUT = types.SimpleNamespace(scale=1.0, renamed={}, columns=None, frame=None)  # no option
# Four particles: columns in SI that all formats below hold.
FOUR = {"x": [0.1, 0.2, -0.3, 4e-3], "y": [1.0, 2.0, 1 / 3, 4.0], "z": [0.5, 0.25, 7.0, 8.0], "radius": [0.01, 0.02, 0.05, 1e-3],
        "id": [3, 1, 4, 2], "type": [1, 2, 2, 1], "density": [2600.0, 2500.0, 1000.0, 1.0], "vx": [1.0, 0.0, -3.5, 0.0], "vy": [0.0] * 4, "vz": [2.0] * 4}
FOUR = {name: np.array(values) for name, values in FOUR.items()}


def rows(names, separator=" ", factors=None):
    return "\n".join(separator.join(repr(v.item() * (factors or {}).get(name, 1)) for name, v in zip(names, one)) for one in zip(*(FOUR[n] for n in names)))


def spill(folder, name, content):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path


def read(path, **options):
    """Columns by name, and what was left out; the program's own checks are applied."""
    found, refuse, _ = converter.read(path, types.SimpleNamespace(**{**vars(WITHOUT), **options}))
    columns_of.check(found, refuse)
    return found


def check_four(found, names, exact=True):
    for name in names:
        same = np.array_equal(found.columns[name], FOUR[name]) if exact else np.allclose(found.columns[name], FOUR[name], rtol=1e-6)
        assert same, f"{name}: {found.columns[name]}, expected {FOUR[name]}"


# --- the files of other programs -----------------------------------------------------------------------

PLACE, MOVING = ("x", "y", "z"), ("vx", "vy", "vz")


def dump(names="id type x y z radius density vx vy vz", body=None, count=4, head="ITEM: BOX BOUNDS ff ff ff\n-1 1\n0 5\n0 10\n"):
    body = rows(names.split()) if body is None else body
    return f"ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n{count}\n{head}ITEM: ATOMS {names}\n{body}\n"


def data(style="Atoms # sphere", extra="", count=4, images=""):
    atoms = "\n".join(f"{i} {t} {2 * r!r} {d!r} {x!r} {y!r} {z!r}{images}" for i, t, r, d, x, y, z in zip(
        *(FOUR[n].tolist() for n in ("id", "type", "radius", "density", "x", "y", "z"))))
    moving = rows(("id",) + MOVING)
    return (f"LAMMPS data file\n\n{count} atoms\n2 atom types\n\n-1 1 xlo xhi\n0 5 ylo yhi\n0 10 zlo zhi\n\n{style}\n\n{atoms}\n\nVelocities\n\n"
            f"{moving}\n{extra}")


def geometry(count=4, end="EndParticles"):
    body = "\n".join(f"{x!r} {y!r} {z!r} {r!r} {i} {t}" for x, y, z, r, i, t in zip(*(FOUR[n].tolist() for n in PLACE + ("radius", "id", "type"))))
    return (f"LSMGeometry 1.2\nBoundingBox -1 0 0 1 5 10\nPeriodicBoundaries 0 0 0\nDimension 3D\nBeginParticles\nSimple\n{count}\n{body}\n{end}\n"
            "BeginConnect\n2\n3 1 0\n1 4 0\nEndConnect\n")


def legacy(binary=False):
    """Points with radii and velocities, in the order of VTK 3.0."""
    places = np.column_stack([FOUR[n] for n in PLACE])
    speeds = np.column_stack([FOUR[n] for n in MOVING])

    def numbers(values, code=">f8"):
        return np.asarray(values).astype(code).tobytes() + b"\n" if binary else (" ".join(repr(float(v)) for v in np.ravel(values)) + "\n").encode()
    return b"".join((b"# vtk DataFile Version 3.0\nanything\n", b"BINARY\n" if binary else b"ASCII\n", b"DATASET POLYDATA\nPOINTS 4 double\n",
                     numbers(places), b"VERTICES 4 8\n", numbers([[1, k] for k in range(4)], ">i4") if binary else b"1 0 1 1 1 2 1 3\n",
                     b"POINT_DATA 4\nSCALARS radius double 1\nLOOKUP_TABLE default\n", numbers(FOUR["radius"]), b"VECTORS v double\n", numbers(speeds),
                     b"FIELD data 1\ntype 1 4 double\n", numbers(FOUR["type"])))


def xml(form="ascii", encoding="raw", compressed=False, wide=False):
    """A .vtp file in one of the forms of VTK."""
    head = "<u8" if wide else "<u4"
    blob, texts = b"", []

    def packed(values):
        raw = np.asarray(values).astype("<f8").tobytes()
        if not compressed:
            return np.array([len(raw)], head).tobytes(), raw
        parts = [raw[k:k + 40] for k in range(0, len(raw), 40)]
        shrunk = [zlib.compress(part) for part in parts]
        return np.array([len(parts), 40, len(raw) % 40] + [len(one) for one in shrunk], head).tobytes(), b"".join(shrunk)

    def array(name, values, width=1):
        nonlocal blob
        tag = f'<DataArray type="Float64" Name="{name}" NumberOfComponents="{width}" format="{form}"'
        if form == "ascii":
            return f'{tag}>{" ".join(repr(float(v)) for v in np.ravel(values))}</DataArray>'
        header, body = packed(values)
        coded = b"".join(base64.b64encode(part) for part in ((header, body) if compressed else (header + body,)))
        if form == "binary":
            return f"{tag}>\n  {coded.decode()}\n</DataArray>"
        offset, blob = len(blob), blob + (header + body if encoding == "raw" else coded)
        return f'{tag} offset="{offset}"/>'
    texts = [array("radii", FOUR["radius"]), array("linVelVec", np.column_stack([FOUR[n] for n in MOVING]), 3), array("id", FOUR["id"])]
    points = array("Points", np.column_stack([FOUR[n] for n in PLACE]), 3)
    made = (f'<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt{64 if wide else 32}"'
            + (' compressor="vtkZLibDataCompressor"' if compressed else "") + '>\n<PolyData><Piece NumberOfPoints="4" NumberOfVerts="4">\n<PointData>'
            + "".join(texts) + f"</PointData>\n<Points>{points}</Points>\n</Piece></PolyData>\n").encode()
    if form == "appended":
        made += f'<AppendedData encoding="{encoding}">\n_'.encode() + blob + b"\n</AppendedData>\n"
    return made + b"</VTKFile>\n"


FILES = {  # name: content, columns that it holds
    "a.dump": (dump(), PLACE + MOVING + ("radius", "id", "type", "density")),
    "b.dump": (dump("id type xu yu zu diameter element", "\n".join(f"{i} {t} {x!r} {y!r} {z!r} {2 * r!r} Si" for i, t, x, y, z, r in zip(
        *(FOUR[n].tolist() for n in ("id", "type") + PLACE + ("radius",))))), PLACE + ("radius", "id", "type")),
    "c.dump": (dump("id x y z radius", "9 9 9 9 9\n8 8 8 8 8\n7 7 7 7 7\n6 6 6 6 6") + dump("id x y z radius"), PLACE + ("radius", "id")),
    "a.data": (data(), PLACE + MOVING + ("radius", "id", "type", "density")),
    "b.data": (data("Atoms", "\nBonds\n\n1 1 3 1\n", images=" 0 0 1"), PLACE + MOVING + ("radius", "id", "type", "density")),
    "a.geo": (geometry(), PLACE + ("radius", "id")),
    "a.vtk": (legacy(), PLACE + MOVING + ("radius", "type")),
    "b.vtk": (legacy(True), PLACE + MOVING + ("radius", "type")),
    "a.vtp": (xml(), PLACE + MOVING + ("radius", "id")),
    "b.vtp": (xml("binary"), PLACE + MOVING + ("radius", "id")),
    "c.vtp": (xml("binary", compressed=True, wide=True), PLACE + MOVING + ("radius", "id")),
    "d.vtp": (xml("appended"), PLACE + MOVING + ("radius", "id")),
    "e.vtp": (xml("appended", "base64", True), PLACE + MOVING + ("radius", "id")),
    "f.vtp": (xml("appended", "raw", True, True), PLACE + MOVING + ("radius", "id")),
    "a.txt": ("#format x_y_z_r_matId\n" + rows(PLACE + ("radius",), "\t").replace("\n", "\t0\n") + "\t1\n", PLACE + ("radius",)),
    "b.txt": ("#format x_y_z_r_attrs\n" + rows(PLACE + ("radius", "vx"), "\t") + "\n", PLACE + ("radius",)),
    "a.csv": ("ID,Radius,x,y,z,force\r\n" + rows(("id", "radius") + PLACE + ("density",), ",") + "\r\n", PLACE + ("radius", "id")),
    "c.txt": ("# x y z radius id\n" + rows(PLACE + ("radius", "id")), PLACE + ("radius", "id")),
    "d.txt": (rows(PLACE + ("radius",)), PLACE + ("radius",)),
}


@plain_fact
def files_of_other_programs_are_read(folder):
    for name, (content, names) in FILES.items():
        found = read(spill(folder, name, content))
        assert len(found) == 4, name
        check_four(found, names)
        volume = float(np.sum(4 / 3 * np.pi * FOUR["radius"] ** 3))
        assert abs(found.volume() - volume) < 1e-14 * volume


@plain_fact
def what_is_left_out_is_named_and_counted(folder):
    for name, words in {"b.dump": "columns element", "b.data": "section Bonds; images", "a.geo": "tags (2 different ones", "b.txt": "attribute 1",
                        "a.csv": "columns force"}.items():
        said = "; ".join(read(spill(folder, name, FILES[name][0])).dropped)
        assert words in said, f"{name}: {said}"
    assert "2 connections" in read(os.path.join(folder, "a.geo")).dropped[1]
    assert "frame 2 of 2, time step 100" in read(spill(folder, "c.dump", FILES["c.dump"][0])).notes[0]
    assert read(os.path.join(folder, "c.dump"), frame=1).columns["x"][0] == 9


@plain_fact
def positions_in_units_of_a_tilted_box_are_those_of_the_box(folder):
    """The edges are a = (4, 0, 0), b = (1, 5, 0), c = (-2, 3, 6) from (10, 20, 30); the bounds are those of its corners."""
    low, a, b, c = np.array([10., 20, 30]), np.array([4., 0, 0]), np.array([1., 5, 0]), np.array([-2., 3, 6])
    corners = np.array([low + i * a + j * b + k * c for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    bounds = "\n".join(f"{corners[:, k].min()} {corners[:, k].max()} {tilt}" for k, tilt in enumerate((1, -2, 3)))
    path = spill(folder, "a.dump", dump("id xs ys zs radius", "1 0.5 0.25 0.125 1\n2 0 0 0 1", 2, f"ITEM: BOX BOUNDS xy xz yz ff ff ff\n{bounds}\n"))
    found = read(path)
    places = np.column_stack([found.columns[n] for n in PLACE])
    assert np.allclose(places, [low + 0.5 * a + 0.25 * b + 0.125 * c, low], rtol=1e-14), places


@plain_fact
def units_and_names_of_columns_can_be_given(folder):
    found = read(spill(folder, "a.dump", dump()), scale=1e-3)
    assert np.array_equal(found.columns["x"], 1e-3 * FOUR["x"]) and np.array_equal(found.columns["vx"], 1e-3 * FOUR["vx"])
    assert np.array_equal(found.columns["density"], FOUR["density"])
    found = read(spill(folder, "a.geo", geometry()), renamed={"tag": "group"})
    assert np.array_equal(found.columns["group"], FOUR["type"])
    check_four(read(spill(folder, "a.txt", rows(("id",) + PLACE + ("radius",))), columns="id x y z r"), PLACE + ("radius", "id"))
    found = read(spill(folder, "b.txt", "x[mm],y[mm],z[mm],d [mm],rho[g/cm3]\n1000,2000,3000,500,2.5\n"))
    assert np.allclose([found.columns[n][0] for n in PLACE + ("radius", "density")], [1, 2, 3, 0.25, 2500], rtol=1e-14)


@plain_fact
def every_format_is_written_and_read_back_exactly(folder):
    source = spill(folder, "source.dump", dump())
    for ending, names in {"txt": FOUR, "csv": FOUR, "dump": FOUR, "data": FOUR, "vtp": FOUR, "geo": PLACE + ("radius", "id"),
                          "yade": PLACE + ("radius",)}.items():
        path = os.path.join(folder, "out." + ending)
        converter.convert(converter.options_of(["--quiet", "--", source, path]))
        check_four(read(path), names)
        again = os.path.join(folder, "again.txt")
        converter.convert(converter.options_of(["--quiet", "--force", "--", path, again]))
        check_four(read(again), names)


@plain_fact
def names_of_materials_become_types_in_the_order_of_the_file(folder):
    for names, types, said in ((("soft b", "a", "soft b", "c"), [1, 2, 1, 3], "types: 1 = soft b, 2 = a, 3 = c"),
                               (("7", "2", "2", "7"), [7, 2, 2, 7], "types: 7 = 7, 2 = 2")):
        source = spill(folder, "in.txt", "x y z r density material\n" + "\n".join(f'{k} 0 0 0.1 2000 "{name}"' for k, name in enumerate(names)))
        for ending in ("data", "dump"):
            shown = io.StringIO()
            with contextlib.redirect_stdout(shown):
                converter.convert(converter.options_of(["--force", "--", source, f"{folder}/out.{ending}"]))
            assert f"note               {said}\n" in shown.getvalue(), shown.getvalue()
            assert list(read(f"{folder}/out.{ending}").columns["type"]) == types


@plain_fact
def numbers_with_units_are_not_longer_than_those_of_the_file(folder):
    """Products are rounded within the error of their multiplication alone, so that a third keeps all its digits."""
    c = read(spill(folder, "a.txt", f"x[mm] y[mm] z r density[g/cm3]\n1.1 {1 / 3!r} {0.1 + 0.2!r} 1 1.9\n")).columns
    assert (c["x"][0], c["density"][0], c["z"][0]) == (0.0011, 1900, 0.1 + 0.2) and c["y"][0] == 1e-3 * (1 / 3), c
    assert converter.options_of(["--density=1.9 g/cm3", "a", "b"]).density == 1900


@plain_fact
def comments_may_follow_rows_and_headers(folder):
    for content in ("0 1 2 3 # a\n4 5 6 7\n", "0 1 2 3# a b c\n4 5 6 7 # d\n", "x y z r # four, 4\n0 1 2 3\n4 5 6 7 # r\n"):
        c = read(spill(folder, "a.txt", content)).columns
        assert [list(c[name]) for name in ("x", "y", "z", "radius")] == [[0, 4], [1, 5], [2, 6], [3, 7]], c


@plain_fact
def wrong_files_are_refused_by_what_is_wrong(folder):
    cases = (
        (dump(count=5), r":14:1: expected 5 lines of atoms, found the end of the frame after 4 \(cut short\?\)"),
        (dump(count=10 ** 14), r":4:1: expected at most \d+ \(number of atoms; the rest of the file\), found 1"),
        (dump("id x y z radius", "1 2 3 4"), r"expected 4 lines of atoms"),
        (dump("id x y z radius", "1 2 3 4 nan", 1), r":10:9: expected a finite number \(radius\), found 'nan'"),
        (dump("id x y z radius", "1 2 3 4 0", 1), r":10:9: expected a radius > 0, found 0"),
        (dump("id x y z radius", "1 2 3 4 5 6", 1), r":10:11: expected 5 columns \(id x y z radius\), found 6"),
        (dump("id x y z", "1 2 3 4", 1), r":9:1: expected a column radius, found id x y z"),
        (dump("id x y z radius", "1 2 3 4 1\n1 2 3 4 1", 2), r":11:1: expected every id once, found 1 again"),
        (dump("id xs ys zs radius", "1 0 0 0 1", 1, ""), "expected ITEM: BOX BOUNDS"),
        ("ITEM: TIMESTEP\n0\n", r"expected ITEM: NUMBER OF ATOMS in the frame that begins in line 1"),
        (data("Atoms # atomic"), r":10:7: expected an atom style with radii \(.*\), found 'atomic'"),
        (data(count=6), r"expected 6 lines of Atoms, found '' after 4"),
        (data().replace("\n3 1 0.02", "\n3.5 1 0.02"), r":12:1: expected a whole id >= 0, found 3.5"),
        (data()[:170], "expected 4 lines of Atoms, found the end of the file"),
        (data().replace("Velocities\n\n3", "Velocities\n\n9"), r":19:1: expected an id of Atoms, found 9"),
        (geometry(count=6), r":14:1: expected EndParticles, found '2'"),
        (geometry(count=3), r":11:1: expected EndParticles, found '0.004"),
        (geometry(count=999), r":7:1: expected at most \d+ \(number of particles; the rest of the file\), found 999"),
        (geometry().replace("Simple", "Rotational"), r":6:1: expected particles of the kind Simple, found 'Rotational'"),
        (legacy(True)[:150], r"byte \d+: expected \d+ bytes of points, found \d+ to the end"),
        (legacy().replace(b"POINTS 4", b"POINTS 400000000"), "expected 1200000000 numbers of points, found the end of the file"),
        (legacy().replace(b"radius double 1\nLOOKUP_TABLE default\n", b"radius double 1\nLOOKUP_TABLE default\nx"), r":12:1: expected a number of radius, found 'x0.01'"),
        (xml().replace(b"0.01 0.02", b"nan 0.02"), r"point 0 \(base 0\): expected a finite radius, found nan"),
        (xml()[:300], r":4:\d+: "),
        (xml("appended", "raw", True)[:-250], r"cut short"),
        (b'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "c">]><VTKFile/>', "expected no DOCTYPE"),
        ("x,y,z,r\n1,2,3\n", r":2:6: expected 4 columns as above, found 3"),
        ("x,y,z,r\n1,,3,4\n", r":2:"),
        ("x,y,z,r\n1,2,3,inf\n", r":2:7: expected a finite number \(radius\), found 'inf'"),
        ("x,y,z\n1,2,3\n", r":1:1: expected a column radius"),
        ("1 2 3 4 5\n", r"expected x y z r, a header, or --columns 'x y z r ...', found 5 columns"),
        ("x y z r x\n1 2 3 4 5\n", r":1:9: expected every column once, found x again"),
        ("", r"no particles"), (b"x\0y", r":1:2: expected text, found a zero byte"), (b"\x89HDF\r\n", "expected the folder of a run"),
    )
    for content, message in cases:
        path = spill(folder, "bad", content)
        try:
            read(path)
        except Problem as error:
            assert re.search(message, str(error)) and str(error).startswith(path), f"expected /{message}/, found: {error}"
        else:
            raise AssertionError(f"read without an error, expected /{message}/")


@plain_fact
def damaged_files_are_sound_or_refused(folder):
    random.seed(3)
    counts = {"read": 0, "refused": 0}
    for name, (content, _) in FILES.items():
        content = content if isinstance(content, bytes) else content.encode()
        for trial in range(60):
            bad = bytearray(content[:random.randrange(len(content))] if trial % 3 == 0 else content)
            for _ in range(random.randrange(1, 4) if trial % 3 else 0):
                bad[random.randrange(len(bad))] = random.choice(b"0123456789.-+eE \n\"<>ax") if trial % 2 else random.randrange(256)
            try:
                found = read(spill(folder, name, bytes(bad)))
            except Problem as error:
                assert error.code in (2, 3), error
                counts["refused"] += 1
                continue
            counts["read"] += 1
            assert np.all(found.columns["radius"] > 0) and all(np.all(np.isfinite(found.columns[n])) for n in ("x", "y"))
    assert min(counts.values()) > 100, counts


# --- meshes ---------------------------------------------------------------------------------------------

INP = """*HEADING
 two bricks and a wedge, of second order and first
** comment
*Node, nset=All nodes
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1.d0
8, 0, 1, 1
9, 2, 0, 0
10, 2, 0, 1
11, 2, 1, 0
12, 2, 1, 1
13, 3, 0, 0
14, 3, 1, 0
15, 0.5, 0, 0
*ELEMENT, TYPE=C3D8R, ELSET=Rock
 7, 1,2,3,4,
 5,6,7,8
8, 2, 9, 11, 3, 6, 10, 12, 7
*Element, type=C3D6, elset=soft
 20, 11, 14, 12, 9, 13, 10
*nset, nset=Bottom, generate
1, 4, 1
*elset, elset=both
ROCK, SOFT,
*Surface, name=left, type=ELEMENT
7, S6
*Material, name=steel
*Elastic
 210000., .3
"""


def mesh_of(path, text, **options):
    """Text of the gmsh file and the mesh."""
    with open(path, "w") as file:
        file.write(text)
    found = meshes.read(path)
    return meshes.written(found, options.get("scale", 1.0)), found


@plain_fact
def meshes_of_calculix_become_those_of_gmsh(folder):
    (content, groups), mesh = mesh_of(folder + "/a.inp", INP)
    assert [(d, name, len(some)) for d, name, some in groups] == [
        (0, "All nodes", 15), (0, "Bottom", 4), (3, "Rock", 2), (3, "soft", 1), (3, "both", 3), (2, "left", 1)], groups
    assert abs(meshes.volume(mesh)[0] - 2.5) < 1e-14 and "*ELASTIC (1), *MATERIAL (1)" in mesh.dropped[0]
    assert "$Elements\n5 19 1 19\n" in content, content
    quadratic = INP.split("*ELEMENT")[0] + "*ELEMENT, TYPE=C3D10, ELSET=t\n1, 1, 2, 4, 5, 15, 15, 15, 15, 15, 15\n*NSET, NSET=in\n15, 1\n"
    (content, groups), mesh = mesh_of(folder + "/b.inp", quadratic, scale=0.5)
    assert mesh.dropped == ["1 nodes between the corners of 1 elements of higher order", "1 nodes between corners in the set All nodes",
                            "1 nodes between corners in the set in"], mesh.dropped
    assert "0.5 0.0 0.0" in content and len(groups) == 3


@plain_fact
def wrong_meshes_are_refused_by_what_is_wrong(folder):
    for change, message in (
            (("7, 1, 1, 1.d0", "7, 1, x, 1"), r"a.inp:11:7: expected a finite number \(coordinate\), found 'X'"),
            (("7, 1, 1, 1.d0", "6, 1, 1, 1"), r":11:1: expected every node once, found node 6 again"),
            (("5,6,7,8\n", "5,6,7,99\n"), r":21:1: expected a node of \*NODE, found 99 in element 7"),
            (("5,6,7,8\n", "5,6,7\n*NODE\n"), r":21:1: expected number and 8 nodes, found 8 values before the next card \(cut short"),
            (("5,6,7,8\n", "5,6,7,8,9\n"), r":22:10: expected number and 8 nodes, found 10 values"),
            (("C3D8R", "DCOUP3D"), r":20:1: expected elements of a known type .*, found TYPE=DCOUP3D"),
            (("ROCK, SOFT", "ROCK, SAND"), r":29:7: expected the number of a element or the name of a set above, found 'SAND'"),
            (("7, S6", "7, S9"), r":31:4: expected a face of element 7 \(hexahedron\), found S9"),
            (("*Material, name=steel", "*INCLUDE, INPUT=other.inp"), r":32:1: expected the mesh in one file, found \*INCLUDE"),
            (("1, 4, 1\n", "1\n"), r"expected first, last and step, found 1 numbers")):
        try:
            mesh_of(folder + "/a.inp", INP.replace(*change))
        except Problem as error:
            assert re.search(message, str(error)), f"expected /{message}/, found: {error}"
        else:
            raise AssertionError(f"read without an error, expected /{message}/")
    random.seed(4)
    refused = 0
    for trial in range(300):
        bad = list(INP[:random.randrange(len(INP))] if trial % 3 == 0 else INP)
        for _ in range(random.randrange(1, 4) if bad and trial % 3 else 0):
            bad[random.randrange(len(bad))] = random.choice("0123456789,*=. \nxS")
        try:
            mesh_of(folder + "/a.inp", "".join(bad))
        except Problem as error:
            assert error.code == 2, error
            refused += 1
    assert 50 < refused < 300, refused


# --- the program ---------------------------------------------------------------------------------------

def scene(folder, content, **changes):
    spill(folder, "particles.txt", content)
    return write_scene(folder, {key: value for key, value in {**SCENE, **changes}.items() if value is not None})


@fact
def columns_set_material_density_velocity_and_group(folder):
    """Four spheres in a row that touch: the first two are of one group."""
    table = ("id,material,x[mm],y[mm],z[mm],d[mm],density[g/cm3],vx[mm/s],wz,group\n3,clay,3,0,0,1,2,0,0,0\n0,rock,0,0,0,1,2.5,10,3,1\n"
             "1,rock,1,0,0,1,2.5,10,0,1\n2,clay,2,0,0,1,2,0,0,2\n")
    run(scene(folder, table, bonds={}, materials=[{**one, "tensile_strength": 1e6, "shear_strength": 1e6} for one in SCENE["materials"]],
              time={"end": 1e-9, "step": 1e-9}), folder + "/out")
    with results(folder + "/out") as file:
        held = {name: file["particles"][name][:] for name in ("mass", "velocity", "spin", "bonds_at_start", "radius")}
        assert np.array_equal(file["bonds"]["i"][:], [0]) and np.array_equal(file["bonds"]["j"][:], [1])
    volume = np.pi / 6 * 1e-9
    assert np.allclose(held["mass"], [2500 * volume] * 2 + [2000 * volume] * 2, rtol=1e-14)
    assert np.allclose(held["velocity"][:, 0], [0.01, 0.01, 0, 0], atol=1e-6) and abs(held["spin"][0, 2] - 3) < 1e-3
    assert list(held["bonds_at_start"]) == [1, 1, 0, 0]


def grains(far=0.0):
    """27 grains of two materials and densities that move apart and spin, in a box of 4 mm; ids run backwards."""
    lines = ["id type x y z r density vx vy vz wx group"]
    for k in range(27):
        x = [far + 1e-3 * (0.7 + k // 3 ** a % 3) for a in range(3)]
        lines.append(f"{26 - k} {1 + k % 2} {x[0]!r} {x[1]!r} {x[2]!r} 0.0005 {2000 + 10 * k} {0.1 * (k % 5 - 2)} {0.05 * (k % 3)} -0.1 {k} {k % 4}")
    return "\n".join(lines) + "\n"


BESIDE = {"bonds": {"interaction_range": 0.05}, "gravity": [0, 0, -9.81], "initial": {"random_velocity": 0.01},
          "materials": [{**one, "tensile_strength": 1e5, "shear_strength": 1e5} for one in SCENE["materials"]],
          "periodic": {"min": [0, 0, 0], "max": [4e-3, 4e-3, 4e-3]}, "sets": [{"name": "one", "select": {"ids": [3, 26]}, "group": 2, "material": "rock"}],
          "time": {"end": 2e-4}}


@fact
def columns_work_beside_other_parts_and_a_run_of_them_is_resumed(folder):
    """Bonds, a periodic box, a set by ids, a random velocity on top of that of the file; ids are those of the file."""
    path = scene(folder, grains(), **BESIDE)
    run(path, folder + "/whole", "--threads", 1)
    run(path, folder + "/cut", "--threads", 2, "--set", "time.end=0.08 ms")
    os.remove(folder + "/particles.txt")
    resume(folder + "/cut", "--set", "time.end=0.2 ms")
    assert state_hash(folder + "/cut") == state_hash(folder + "/whole")
    with results(folder + "/whole") as file:
        held = {name: file["particles"][name][:] for name in ("id", "mass")}
    assert np.array_equal(held["id"], np.arange(27))
    assert np.allclose(held["mass"], np.pi / 6 * 1e-9 * (2000 + 10 * (26 - np.arange(27))), rtol=1e-14)


@fact
def a_far_origin_and_single_precision_change_velocities_by_rounding_alone(folder):
    """Grains 1 km away, and in mixed precision, move as those near the origin; without contacts of a box, which would be elsewhere."""
    ends = []
    for name, far, precision in (("near", 0.0, "double"), ("far", 1000.0, "double"), ("mixed", 0.0, "mixed")):
        path = scene(folder, grains(far), **{**BESIDE, "periodic": None})
        run(path, f"{folder}/{name}", "--threads", 1, "--precision", precision)
        with results(f"{folder}/{name}") as file:
            ends.append((file["particles"]["position"][:] - far, file["particles"]["velocity"][:], file["particles"]["mass"][:]))
    for position, velocity, mass in ends[1:]:
        assert np.allclose(position, ends[0][0], atol=1e-8) and np.allclose(velocity, ends[0][1], atol=1e-3)
        assert np.allclose(mass, ends[0][2], rtol=1e-6)


@fact
def a_header_changes_no_bit_of_a_run(folder):
    with open(os.path.join(SCENES, os.pardir, os.pardir, "scenes", "specimens", "rock-b.txt")) as file:
        plain = file.read()
    body = "\n".join(line for line in plain.splitlines() if not line.startswith("#"))
    hashes = set()
    for k, content in enumerate((plain, "x y z r\n" + body, "x,y,z,radius,material,group\n" + "\n".join(
            ",".join(line.split() + ["rock", "1"]) for line in body.splitlines()))):
        path = scene(folder, content, specimen={"file": "particles.txt", "material": "rock"})
        run(path, f"{folder}/{k}", "--threads", 1)
        hashes.add(state_hash(f"{folder}/{k}"))
    assert len(hashes) == 1, hashes


@fact
def columns_and_the_scene_have_to_agree(folder):
    chosen = {"sets": [{"name": "one", "select": {"ids": [7]}, "group": 3}]}
    for content, changes, message in (
            ("x y z r material\n0 0 0 1 iron\n", {}, r"particles.txt:2:9: expected the name of a material of the scene, found 'iron'"),
            ("0 0 0 1\n", {}, r"specimen: expected specimen.material, or a column material in particles.txt, found neither and 2 materials"),
            ("x y z r id type\n0 0 0 1 7 1\n", chosen, r"set 'one': select.ids: expected ids 0, 1, 2, ... in particles.txt, found others"),
            ("x[mm] y[mm] z[mm] r[mm] type\n0 0 0 1 1\n", {"specimen": {"file": "particles.txt", "scale": 2}}, r":1:3: expected units of lengths either"),
            ("x[stone] y z r type\n0 0 0 1 1\n", {}, r"particles.txt:1:3: expected a unit such as m, found 'stone'"),
            (dump(), {}, r"particles.txt:1:1: expected rows x y z r or named columns, found a dump of LAMMPS or LIGGGHTS: gneiss convert ")):
        expect(gneiss("check", scene(folder, content, **changes)), 2, message)


@fact
def units_of_a_header_suppress_the_doubt_about_metres(folder):
    for content, doubted in (("x y z r type\n0 0 0 1 1\n9 0 0 1 1\n", True), ("x[m] y[m] z[m] r[m] type\n0 0 0 1 1\n9 0 0 1 1\n", False)):
        said = gneiss("check", scene(folder, content, gravity=[0, 0, -9.81]))
        assert ("without a scale" in said.stdout) == doubted, said.stdout


@fact
def the_program_converts_and_runs_what_it_converted(folder):
    source, target = spill(folder, "a.dump", dump()), os.path.join(folder, "particles.txt")
    said = expect(gneiss("convert", source, target), 0).stdout
    assert "particles          4, radii 0.001 to 0.05 m, volume 0.000561302" in said and "dump of LAMMPS" in said, said
    expect(gneiss("convert", source, target), 2, "expected a new file, found an existing one: --force replaces it")
    path = write_scene(folder, SCENE)
    run(path, folder + "/out")
    expect(gneiss("convert", folder + "/out", folder + "/end.csv", "--quiet"), 0)
    with results(folder + "/out") as file:
        held, found = file["particles"], read(folder + "/end.csv")
        assert np.array_equal(found.columns["x"], held["position"][:, 0]) and np.array_equal(found.columns["vx"], held["velocity"][:, 0])
        assert np.allclose(found.columns["density"], FOUR["density"][np.argsort(FOUR["id"])], rtol=1e-14)


@fact
def meshes_are_converted_and_what_is_split_is_said(folder):
    """The bricks and the wedge of the file as elements: 6, 6 and 3 tetrahedra of 2.5 m3; its sets are groups."""
    said = expect(gneiss("convert", spill(folder, "a.inp", INP), folder + "/a.msh"), 0).stdout
    assert "mesh               15 nodes, 3 elements, 2.5 m3" in said and "group              both: 3 of dimension 3" in said, said
    body = {"mesh": "a.msh", "materials": [{"group": "Rock", "density": 2000, "young": 1e9, "poisson": 0.2},
                                           {"group": "soft", "density": 1000, "young": 1e8, "poisson": 0.2}],
            "motions": [{"name": "base", "group": "left", "motion": {"vx": 0, "vy": 0, "vz": 0}}],
            "loads": [{"group": "Bottom", "force": {"fx": 0, "fy": 0, "fz": 1}}]}
    path = write_scene(folder, {"elements": body, "time": {"end": 1e-5}})
    said = expect(gneiss("check", path), 0).stdout
    assert "of the file      1 quadrangles split into triangles, 2 hexahedra split into tetrahedra, 1 prisms split into" in said, said
    assert "15 tetrahedra" in said and "volume           2.5 m3, mass 4500 kg" in said, said
    expect(gneiss("run", path, "--out", folder + "/out", "--quiet"), 0, "gneiss: note: elements.mesh: 1 quadrangles split")
    expect(gneiss("check", write_scene(folder, {"elements": {**body, "mesh": "a.inp"}, "time": {"end": 1e-5}})), 2,
           "expected a section .*gneiss convert writes meshes of others as .msh")


@fact
def calls_that_cannot_be_carried_out_write_nothing(folder):
    source, target = spill(folder, "a.dump", dump("id x y z radius")), os.path.join(folder, "out.txt")
    table = spill(folder, "rows.txt", "0 0 0 1\n")
    for arguments, code, message in (
            ((source,), 2, "expected two arguments, IN OUT, found 1"),
            ((source, folder + "/out.xyz"), 2, "expected a file that ends with .txt, .csv"),
            ((folder + "/none", target), 2, "none: cannot be read: No such file"),
            ((source, folder + "/none/out.txt"), 3, "cannot be written"),
            ((source, folder + "/out.data"), 2, "expected densities for a data file"),
            ((source, target, "--frame", 2), 2, r"expected at least 2 frames \(--frame\), found 1"),
            ((source, target, "--frame", "x"), 2, "--frame: expected a whole number from 1 on, found 'x'"),
            *(((source, target, f"--frame={one}"), 2, f"--frame: expected a whole number from 1 on, found '{one}'") for one in (0, -1, 1.5)),
            ((table, target, "--frame", 1), 2, "--frame: expected a dump of LAMMPS or LIGGGHTS as IN, found .*rows.txt: text with columns"),
            *(((source, target, f"--length={one}"), 2, f"--length: expected a unit of length such as mm, found '{one}'") for one in ("kg", "-1 m", "0", "")),
            *(((source, target, f"--density={one}"), 2, f"--density: expected a density > 0 such as '2600 kg/m3', found '{one}'")
              for one in (-1, 0, "1e400", "nan", "inf", "abc", "5 m", "")),
            ((spill(folder, "a.ply", "ply\n"), target), 2, r"a.ply: expected particles, found a surface: OUT must end with .msh; surface of a scene"),
            ((spill(folder, "b.inp", INP), target), 2, r"b.inp: expected particles, found a mesh: OUT must end with .msh$"),
            ((folder + "/b.inp", folder + "/b.msh", "--frame", 1), 2, "--frame: expected particles, found a mesh as OUT"),
            ((source, target, "--as", "a=b"), 2, "--as: expected NAME=COLUMN with one of"),
            ((folder, target), 2, "expected a folder with results.h5 or packing.h5")):
        expect(gneiss("convert", *arguments), code, message)
    expect(gneiss("check", source, "--length", "mm"), 2, "gneiss check: --length is for gneiss convert")
    assert sorted(os.listdir(folder)) == ["a.dump", "a.ply", "b.inp", "rows.txt"], os.listdir(folder)
    expect(gneiss("convert", source, folder + "/out.data", "--density", "2 g/cm3"), 0)
    assert abs(read(folder + "/out.data").columns["density"][0] - 2000) < 1e-9


if __name__ == "__main__":
    sys.exit(main())
