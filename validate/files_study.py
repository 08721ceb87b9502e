"""Real files of other programs: makes them with YADE, LAMMPS, LIGGGHTS, ESyS-Particle's GenGeo, Voro++, gmsh, meshio and Blender, reads them with
gneiss and compares number and volume with those that the program was given; reads files of gneiss with LAMMPS, LIGGGHTS, YADE and gmsh. Programs
that are not installed are named and left out. Writes docs/evidence/files.md; two minutes of one core.

    /usr/bin/python3 validate/files_study.py
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import study

PAGE = study.ROOT / "docs" / "evidence" / "files.md"
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1"}
COUNT, SIX_DIGITS, SINGLE, EXACT = 120, 2e-5, 1e-6, 1e-12  # digits that a writer keeps bound the error of the volume

# --- spheres that all programs are given ---------------------------------------------------------------


def spheres():
    """[COUNT][4]: places in a box of 0.1 m and radii of 1 to 2 mm with six digits; types 1 and 2 by turns."""
    rng = np.random.default_rng(7)
    return np.round(np.column_stack([rng.uniform(0.005, 0.095, (COUNT, 3)), rng.uniform(0.001, 0.002, COUNT)]), 6)


SPHERES = spheres()
VOLUME = float(np.sum(4 / 3 * np.pi * SPHERES[:, 3] ** 3))


def call(folder, *command, text=None):
    """Output of a program; its failure ends the study."""
    done = subprocess.run(command, cwd=folder, env={**ENVIRONMENT, "PWD": str(folder)},  # Blender takes PWD for the folder
                          capture_output=True, text=True, input=text, timeout=300, errors="replace")
    return done.returncode, done.stdout + done.stderr


def version(*command, pattern=r"(\d+\.\d+[\w.]*)"):
    found = re.search(pattern, call("/tmp", *command)[1])
    return found[1] if found else "?"


def of_package(name):
    """Version of a Debian package."""
    return call("/tmp", "dpkg-query", "-W", "-f", "${Version}", name)[1]


def lammps(folder, program, data):
    """Data and dumps of LAMMPS or LIGGGHTS, and their names."""
    old = program == "liggghts"
    lines = ["units si", "atom_style " + ("granular" if old else "sphere"), "boundary f f f", "newton off",
             "communicate single vel yes" if old else "comm_modify vel yes", "region box block 0 0.1 0 0.1 0 0.1 units box", "create_box 2 box",
             "neighbor 0.002 bin"]
    if old:
        for name, value in (("youngsModulus peratomtype", "5e6 5e6"), ("poissonsRatio peratomtype", "0.4 0.4"),
                            ("coefficientRestitution peratomtypepair 2", "0.9 0.9 0.9 0.9"), ("coefficientFriction peratomtypepair 2", "0.1 0.1 0.1 0.1")):
            lines.append(f"fix {name.split()[0]} all property/global {name} {value}")
    lines += ["pair_style " + ("gran model hertz tangential history" if old else "gran/hooke/history 2e5 NULL 50 NULL 0.5 0"), "pair_coeff * *", "timestep 1e-9"]
    lines += [f"create_atoms {1 + k % 2} single {x} {y} {z} units box" for k, (x, y, z, _) in enumerate(SPHERES)]
    lines += [f"set atom {k + 1} diameter {2 * r:.6f} density 2600" for k, (_, _, _, r) in enumerate(SPHERES)]
    lines += ["velocity all set 0.1 0.2 -0.3 units box", f"write_data {data}", "fix move all nve/sphere"]
    kinds = {"plain": "id type x y z radius vx vy vz omegax omegay omegaz mass", "scaled": "id type xs ys zs diameter", "unwrapped": "id type xu yu zu radius"}
    lines += [f"dump {name} all custom 10 {data}.{name} {columns}" for name, columns in kinds.items()] + ["run 10"]
    (folder / f"in.{program}").write_text("\n".join(lines) + "\n")
    command = ("mpirun", "--allow-run-as-root", "-np", "1", "liggghts") if old else ("lmp",)
    code, said = call(folder, *command, "-in", f"in.{program}", "-log", "none")
    if code:
        sys.exit(f"{program}: {said[-2000:]}")
    return [(data, "data", EXACT)] + [(f"{data}.{name}", f"dump, {columns}", SIX_DIGITS) for name, columns in kinds.items()]


YADE = """
from yade import *
from yade import export, pack
import json, os
rows = json.load(open('spheres.json'))
a = O.materials.append(FrictMat(density=2600, label='a')); b = O.materials.append(FrictMat(density=2600, label='b'))
for k, (x, y, z, r) in enumerate(rows): O.bodies.append(sphere((x, y, z), r, material='ab'[k % 2]))
for one in O.bodies: one.state.vel = (0.1, 0.2, -0.3)
export.text('yade.txt')
for form in ('x_y_z_r', 'x_y_z_r_matId', 'id_x_y_z_r_matId'): export.textExt('yade_' + form + '.txt', form)
export.textExt('yade_attrs.txt', 'x_y_z_r_attrs', attrs=['b.state.vel', 'b.mask'])
export.VTKExporter('yade_vtk').exportSpheres(what={'vel': 'b.state.vel'})
made = pack.SpherePack(); made.fromSimulation(); made.save('yade_pack.txt')
O.dt = 1e-12
O.engines = [InsertionSortCollider([Bo1_Sphere_Aabb()])] + [
    VTKRecorder(fileName='yade_' + name + '-', recorders=['spheres', 'velocity', 'id', 'materialId', 'mass'], iterPeriod=1, **how) for name, how in
    (('ascii', dict(ascii=True)), ('binary', dict(ascii=False)), ('compressed', dict(compress=True)))] + [NewtonIntegrator()]
O.step()
os._exit(0)
"""


def yade(folder):
    (folder / "spheres.json").write_text(json.dumps(SPHERES.tolist()))
    (folder / "make.py").write_text(YADE)
    call(folder, "yade", "-n", "-x", "make.py")
    names = ["yade.txt", "yade_x_y_z_r.txt", "yade_x_y_z_r_matId.txt", "yade_id_x_y_z_r_matId.txt", "yade_attrs.txt"]
    out = [(name, "text", SIX_DIGITS) for name in names] + [("yade_pack.txt", "SpherePack.save", SIX_DIGITS)]
    out.append((next(folder.glob("yade_vtk*.vtk")).name, "VTKExporter", SIX_DIGITS))
    return out + [(f"yade_{name}-spheres.0.vtu", f"VTKRecorder, {name}", EXACT) for name in ("ascii", "binary", "compressed")]


def gengeo(folder):
    """GenGeo is a Python module of Debian's python."""
    lines = ["from gengeo import *", "import json", "t = MNTable3D(Vector3(0, 0, 0), Vector3(0.1, 0.1, 0.1), 0.01, 1)"]
    lines += [f"t.insert(Sphere(Vector3({x}, {y}, {z}), {r}), 0)" for x, y, z, r in SPHERES]
    lines += ["t.generateBonds(0, 1e-3, 0)", "t.write('gengeo.geo', 1)", "t.write('gengeo.vtu', 2)"]
    code, said = call(folder, "/usr/bin/python3", "-", text="\n".join(lines))
    if code:
        sys.exit(f"gengeo: {said[-500:]}")
    return [("gengeo.geo", "LSMGeometry 1.2", SINGLE), ("gengeo.vtu", "VTK, text", SINGLE)]


def voro(folder):
    (folder / "voro").write_text("".join(f"{k} {x} {y} {z} {r}\n" for k, (x, y, z, r) in enumerate(SPHERES)))
    call(folder, "voro++", "-r", "-c", "%i %x %y %z %r", "0", "0.1", "0", "0.1", "0", "0.1", "voro")
    return [("voro.vol", "output %i %x %y %z %r", SIX_DIGITS)]


def with_meshio(folder):
    import meshio
    points = meshio.Mesh(SPHERES[:, :3], [("vertex", np.arange(COUNT)[:, None])], point_data={"radius": SPHERES[:, 3]})
    forms = {"meshio.vtk": ("legacy, binary", {"binary": True}), "meshio_a.vtk": ("legacy, text", {"binary": False}), "meshio.vtu": ("XML, zlib", {}),
             "meshio_r.vtu": ("XML, binary", {"compression": None}), "meshio_a.vtu": ("XML, text", {"binary": False})}
    for name, (_, how) in forms.items():
        meshio.write(folder / name, points, **how)
    return [(name, text, EXACT) for name, (text, _) in forms.items()]


def with_numpy(folder):
    np.savetxt(folder / "numpy.txt", SPHERES, header="x y z radius")
    np.savetxt(folder / "numpy.csv", np.column_stack([np.arange(COUNT), SPHERES * 1000]), header="id,x[mm],y[mm],z[mm],r[mm]", comments="", delimiter=",")
    return [("numpy.txt", "savetxt, header in a comment", EXACT), ("numpy.csv", "savetxt, CSV in mm", EXACT)]


COLUMNS = {"yade_pack.txt": "x y z r -", "voro.vol": "id x y z r"}


def read_particles(folder, name):
    """Number and volume of the spheres that gneiss convert writes; the number counts those at the right place."""
    done = study.call(["convert", str(folder / name), str(folder / "out.txt"), "--force", *([f"--columns={COLUMNS[name]}"] if name in COLUMNS else [])])
    if done.returncode:
        return 0, 0.0, done.stderr.strip()
    lines = (folder / "out.txt").read_text().splitlines()
    place = [lines[0].split().index(column) for column in ("x", "y", "z", "radius")]
    found = np.array([line.split() for line in lines[1:]], float)[:, place]
    right = [bool(np.any(np.all(np.abs(SPHERES - one) < 2e-6, axis=1))) for one in found]
    return (sum(right) if len(found) == COUNT else len(found)), float(np.sum(4 / 3 * np.pi * found[:, 3] ** 3))


# --- meshes and surfaces -------------------------------------------------------------------------------

SOLID = """SetFactory("OpenCASCADE");
Box(1) = {0,0,0,2,1,1}; Box(2) = {2,0,0,1,1,1};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume("rock") = {1}; Physical Volume("soft") = {2}; Physical Surface("left", 1) = {1};
Mesh.CharacteristicLengthMax = 0.5;
"""
BRICK = """Point(1)={0,0,0,0.5}; Point(2)={2,0,0,0.5}; Point(3)={2,1,0,0.5}; Point(4)={0,1,0,0.5};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1}; Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1};
Transfinite Surface{1}; %s
e[]=Extrude{0,0,1}{Surface{1}; Layers{3}; Recombine;};
Physical Volume("rock")={e[1]}; Physical Surface("left")={1};
"""


def gmsh(folder):
    """(name, text, volume, tetrahedra per element of the file) of meshes; groups are compared too."""
    (folder / "solid.geo").write_text(SOLID)
    (folder / "brick.geo").write_text(BRICK % "Recombine Surface{1};")
    (folder / "wedge.geo").write_text(BRICK % "")
    made = []
    for geometry, volume, each in (("solid", 3.0, 1), ("brick", 2.0, 6), ("wedge", 2.0, 3)):
        for form in ("msh22", "msh40", "msh41"):
            for name, how in (("", ()), ("_order2", ("-order", "2")), ("_parts", ("-part", "3")), ("_binary", ("-bin",))):
                if (geometry != "solid" and name in ("_parts", "_binary")) or (form, name) == ("msh40", "_binary"):
                    continue
                path = f"{geometry}{name}_{form}.msh"
                call(folder, "gmsh", "-3", *how, "-format", form, "-o", path, f"{geometry}.geo", "-nopopup")
                made.append((path, f"{geometry}, {form}{name.replace('_', ', ')}", volume, each))
        for order in ("1", "2"):
            path = f"{geometry}{order}.inp"
            call(folder, "gmsh", "-3", "-order", order, "-format", "inp", "-o", path, f"{geometry}.geo", "-nopopup")
            made.append((path, f"{geometry}, CalculiX .inp, order {order}", volume, each))
    return made


def solids_of(path):
    """Solid elements in a file, counted from its text or by gmsh: lines of types 4, 5, 6 and of second order in a copy of format 2.2."""
    if path.suffix == ".inp":
        count, solid = 0, False
        text = re.sub(r",\s*\n\s*", ", ", path.read_text())
        for line in text.splitlines():
            if line.startswith("*"):
                solid = "C3D" in line.upper() and line.upper().startswith("*ELEMENT")
            elif solid and line.strip():
                count += 1
        return count
    copy = path.with_suffix(".copy.msh")
    call(path.parent, "gmsh", path.name, "-save", "-format", "msh22", "-o", copy.name)
    rows = copy.read_text().split("$Elements\n")[1].splitlines()[1:] if copy.exists() else []
    return len({tuple(row.split()[3 + int(row.split()[2]):]) for row in rows if len(row.split()) > 2 and row.split()[1] in ("4", "5", "6", "11", "12", "13", "17", "18")})


def read_mesh(folder, name):
    """Number of tetrahedra, volume and groups that gneiss check prints."""
    if not name.endswith(".msh"):
        done = study.call(["convert", str(folder / name), str(folder / "converted.msh"), "--force"])
        if done.returncode:
            return 0, 0.0, done.stderr.strip()
        name = "converted.msh"
    scene = {"elements": {"mesh": name, "materials": [{"young": 1e9, "poisson": 0.2, "density": 2000}], "motions": [{"name": "a", "group": "left", "motion": {"vx": 0}}]},
             "time": {"end": 1e-5}}
    (folder / "scene.yaml").write_text(json.dumps(scene))
    done = study.call(["check", str(folder / "scene.yaml")])
    found = re.search(r"(\d+) tetrahedra[\s\S]*?volume +(\S+) m3", done.stdout)
    return (int(found[1]), float(found[2])) if found else (0, 0.0, done.stderr.strip())


BLENDER = """
import bpy, json
shapes = {'cube': bpy.ops.mesh.primitive_cube_add, 'cylinder': bpy.ops.mesh.primitive_cylinder_add, 'torus': bpy.ops.mesh.primitive_torus_add,
          'ball': bpy.ops.mesh.primitive_ico_sphere_add}
import bmesh
volumes = {}
for name, add in shapes.items():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add()
    whole = bmesh.new(); whole.from_mesh(bpy.context.object.data); volumes[name] = whole.calc_volume()
    bpy.ops.wm.obj_export(filepath=f'{name}.obj')
    bpy.ops.export_mesh.ply(filepath=f'{name}.ply', use_ascii=False)
    bpy.ops.export_mesh.ply(filepath=f'{name}_a.ply', use_ascii=True)
    bpy.ops.export_mesh.stl(filepath=f'{name}.stl')
json.dump(volumes, open('volumes.json', 'w'))
"""


def blender(folder):
    (folder / "blender.py").write_text(BLENDER)
    call(folder, "blender", "--background", "--python", "blender.py")
    volumes = json.loads((folder / "volumes.json").read_text())
    return [(f"{shape}{ending}", f"{shape}{ending}", volumes[shape], None) for shape in volumes for ending in (".obj", ".ply", "_a.ply", ".stl")]


def meshio_surfaces(folder):
    import meshio
    if not (folder / "ball.stl").exists():
        return []
    ball = meshio.read(folder / "ball.stl")
    volume = json.loads((folder / "volumes.json").read_text())["ball"]
    for name, how in (("meshio.ply", {}), ("meshio_a.ply", {"binary": False}), ("meshio.obj", {}), ("meshio.stl", {"binary": True})):
        meshio.write(folder / name, meshio.Mesh(ball.points, ball.cells), **how)
    return [(name, name, volume, None) for name in ("meshio.ply", "meshio_a.ply", "meshio.obj", "meshio.stl")]


def read_surface(folder, name):
    """The volume that gneiss pack prints."""
    (folder / "pack.yaml").write_text(json.dumps({"specimen": {"surface": name, "particles": 30}}))
    done = subprocess.run([study.PROGRAM, "pack", str(folder / "pack.yaml"), "--out", str(folder / "packed"), "--force"], capture_output=True, text=True,
                          env={**ENVIRONMENT, "GNEISS_CACHE": "off"}, check=False)
    found = re.search(r"spheres in (\S+) m3", done.stdout)
    return (None, float(found[1])) if found else (None, 0.0, done.stderr.strip())


# --- files of gneiss in other programs -----------------------------------------------------------------

def back(folder):
    """(program, file, number, volume) that other programs find in files of gneiss."""
    np.savetxt(folder / "own.txt", np.column_stack([np.arange(1, COUNT + 1), SPHERES]), header="id x y z radius", comments="", fmt=["%d"] + ["%.17g"] * 4)
    for ending in ("data", "dump", "yade", "geo", "vtp", "csv"):
        done = study.call(["convert", str(folder / "own.txt"), str(folder / f"own.{ending}"), "--force", "--density", "2600"])
        if done.returncode:
            sys.exit(done.stderr)
    out = []
    for program in ("lmp", "liggghts"):
        if not shutil.which(program):
            continue
        old = program == "liggghts"
        script = ("units si\natom_style " + ("granular" if old else "sphere") + "\nboundary f f f\nnewton off\n" + ("communicate single vel yes\n" if old else "comm_modify vel yes\n")
                  + "read_data own.data\ncompute r all property/atom radius\nvariable v atom 4/3*PI*c_r^3\ncompute v all reduce sum v_v\nvariable n equal count(all)\nvariable s equal c_v\n"
                  + "neighbor 0.002 bin\nthermo_style custom atoms c_v\nthermo_modify format float %.15g\nrun 0\nprint \"FOUND ${n} $(c_v)\"\n")
        if old:
            script = script.replace("neighbor", "".join(f"fix {n.split()[0]} all property/global {n} {v}\n" for n, v in (
                ("youngsModulus peratomtype", "5e6"), ("poissonsRatio peratomtype", "0.4"), ("coefficientRestitution peratomtypepair 1", "0.9"),
                ("coefficientFriction peratomtypepair 1", "0.1"))) + "pair_style gran model hertz tangential history\npair_coeff * *\ntimestep 1e-9\nneighbor")
            script = script.replace('print "FOUND ${n} $(c_v)"', 'print "FOUND ${n} ${s}"')
        else:
            script = script.replace("neighbor", "pair_style gran/hooke/history 2e5 NULL 50 NULL 0.5 0\npair_coeff * *\nneighbor", 1)
        (folder / "back.in").write_text(script)
        _, said = call(folder, *(("mpirun", "--allow-run-as-root", "-np", "1") if old else ()), program, "-in", "back.in", "-log", "none")
        found = re.search(r"^FOUND (\d+) (\S+)", said, re.M)
        out.append((program, "own.data", int(found[1]) if found else 0, float(found[2]) if found else 0.0))
    if shutil.which("yade"):
        (folder / "back.py").write_text("from yade import *\nfrom yade import ymport\nimport math, os\nb = ymport.textExt('own.yade', 'x_y_z_r')\n"
                                        "print('FOUND', len(b), repr(sum(4/3*math.pi*x.shape.radius**3 for x in b)), flush=True)\nos._exit(0)\n")
        found = re.search(r"FOUND (\d+) (\S+)", call(folder, "yade", "-n", "-x", "back.py")[1])
        out.append(("yade", "own.yade", int(found[1]) if found else 0, float(found[2]) if found else 0.0))
    for ending in ("dump", "geo", "vtp", "csv"):
        out.append(("gneiss", f"own.{ending}", *read_particles(folder, f"own.{ending}")[:2]))
    return out


# --- the page ------------------------------------------------------------------------------------------

WRITERS = {  # program: (makes files, version)
    "lmp": (lambda folder: lammps(folder, "lmp", "lammps.data"), "LAMMPS", "lammps"),
    "liggghts": (lambda folder: lammps(folder, "liggghts", "liggghts.data"), "LIGGGHTS", "liggghts"),
    "yade": (yade, "YADE", "yade"), "esysparticle": (gengeo, "GenGeo", "python3-gengeo"), "voro++": (voro, "Voro++", "voro++"),
}


def row(writer, text, wanted, found, tolerance):
    """A row of the table, and whether number and volume are right."""
    number, volume = found[:2]
    error = abs(volume / wanted[1] - 1.0)
    right = number == wanted[0] and error <= tolerance and len(found) == 2
    shown = found[2][-200:].replace("|", "/") if len(found) > 2 else f"{volume:.9g}"
    return f"| {writer} | {text} | {'' if wanted[0] is None else f'{number} of {wanted[0]}'} | {shown} | {error:.1e} | {'' if right else '**wrong**'} |", right


def main():
    folder = Path(tempfile.mkdtemp(prefix="files-"))
    rows, versions, absent = [], [], []
    for program, (make, name, package) in WRITERS.items():
        if not shutil.which(program):
            absent.append(name)
            continue
        versions.append(f"{name} {of_package(package)}")
        for file, text, tolerance in make(folder):
            rows.append(row(name, text, (COUNT, VOLUME), read_particles(folder, file), tolerance))
    rows += [row("numpy", text, (COUNT, VOLUME), read_particles(folder, file), tolerance) for file, text, tolerance in with_numpy(folder)]
    try:
        rows += [row("meshio", text, (COUNT, VOLUME), read_particles(folder, file), tolerance) for file, text, tolerance in with_meshio(folder)]
        versions.append(f"meshio {of_package('python3-meshio')}")
    except ModuleNotFoundError:
        absent.append("meshio")
    if shutil.which("gmsh"):
        versions.append(f"gmsh {of_package('gmsh')}")
        for file, text, volume, each in gmsh(folder):
            rows.append(row("gmsh", text, (each * solids_of(folder / file), volume), read_mesh(folder, file), SINGLE))
    if shutil.which("blender"):
        versions.append(f"Blender {of_package('blender')}")
        rows += [row("Blender", text, (None, volume), read_surface(folder, file), SIX_DIGITS) for file, text, volume, _ in blender(folder)]
        rows += [row("meshio", text, (None, volume), read_surface(folder, file), SIX_DIGITS) for file, text, volume, _ in meshio_surfaces(folder)]
    returned = [row(program, f"reads {file} of gneiss", (COUNT, VOLUME), found, EXACT if program != "lmp" else SINGLE) for program, file, *found in back(folder)]
    shutil.rmtree(folder)
    wrong = sum(not right for _, right in rows + returned)
    head = "| written by | file | number | volume, m3 | error | |\n| --- | --- | --- | --- | --- | --- |\n"
    PAGE.write_text(
        "# Files of other programs\n\n" + study.prose(
            f"{len(rows)} files that other programs wrote, read by gneiss ([files.md](../files.md)): number and volume beside those that the program was given, "
            f"and {len(returned)} files of gneiss read by others. {'All are right' if not wrong else f'{wrong} are wrong'} to the digits that the writer keeps (six in texts of "
            "LAMMPS, LIGGGHTS, YADE and OBJ). Spheres: 120 of 1 to 2 mm. Meshes: number of tetrahedra beside that of the solid elements in the file times 1, 6 or 3. "
            f"Versions: {', '.join(versions)}.{' Not installed: ' + ', '.join(absent) + '.' if absent else ''} Made by `validate/files_study.py`.")
        + "\n\n" + head + "\n".join(text for text, _ in rows) + "\n\n## Files of gneiss\n\n" + head.replace("written by", "read by")
        + "\n".join(text for text, _ in returned) + "\n")
    print(f"{len(rows)} files and {len(returned)} of gneiss, {wrong} wrong: {PAGE}")
    return 1 if wrong else 0


if __name__ == "__main__":
    study.reported(sys.argv[1:], __doc__, ("--fresh", "--kept"))
    sys.exit(main())
