"""Geometries meshed by gmsh, which runs only where the command line allows it. Here a script called gmsh, first in
PATH, writes a prepared file, so that the tests do not depend on the real program. Speaks TAP."""
from program import *  # noqa: F403

SQUARE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
2
1 2 2 0 1 1 2 3
2 2 2 0 1 1 3 4
$EndElements
"""
SCENE = {
    "dimension": 2,
    "specimen": {"mesh": "body.geo", "particles": 30},
    "materials": [{"name": "m", "density": 2500, "normal_stiffness": 1e6, "kratio": 0}],
    "law": {"stiffness": "uniform"},
    "time": {"end": 1e-5},
    "output": {"snapshots": 0, "history_rows": 2},
    "run": {"threads": 1},
}


def geometry(folder, name="body.geo", scene=SCENE):
    """A scene of a geometry, a gmsh that leaves `folder`/called, and how programs are started to find it."""
    with open(os.path.join(folder, "square.msh"), "w") as file:
        file.write(SQUARE)
    with open(os.path.join(folder, name), "w") as file:
        file.write("// a square\n")
    os.mkdir(os.path.join(folder, "bin"))
    program = os.path.join(folder, "bin", "gmsh")
    with open(program, "w") as file:
        file.write(f'#!/bin/sh\necho "$@" >> {folder}/called\ncat "$8" >> {folder}/called\ncp {folder}/square.msh "$5"\n')
    os.chmod(program, 0o755)
    scene = {**scene, "specimen": {**scene["specimen"], "mesh": name}}
    environment = {"PATH": os.path.dirname(program) + ":/usr/bin:/bin", "GNEISS_CACHE": os.path.join(folder, "cache")}
    return write_scene(folder, scene), {"environment": environment}


def called(folder):
    """The calls of gmsh since the previous query."""
    path = os.path.join(folder, "called")
    if not os.path.exists(path):
        return ""
    with open(path) as file:
        words = file.read()
    os.remove(path)
    return words


def commands(folder, scene):
    sweep = write_scene(folder, {"scene": scene, "parameters": {"materials.m.density": [2000, 3000]}}, "sweep.yaml")
    out = ("--out", os.path.join(folder, "out"))
    return [("check", scene), ("plan", scene), ("run", scene, *out), ("run", scene, "--seeds", "2", *out),
            ("pack", scene, *out), ("sweep", sweep, *out), ("sweep", sweep, "--dry-run", *out)]


@fact
def no_command_runs_gmsh_unless_it_is_allowed(folder):
    for name in ("body.geo", "body.STEP", "body.brep", "body.igs"):
        place = os.path.join(folder, name)
        os.mkdir(place)
        scene, options = geometry(place, name)
        for words in commands(place, scene):
            expect(gneiss(*words, **options), 2, r"scene\.yaml:\d+:\d+: specimen\.mesh: expected .*--allow-gmsh",
                   rf"found the geometry '{name}'", rf"this is run: gmsh -2 -format msh41 -o FILE -nopopup /.*/{name} LINEAR.geo, with Mesh.ElementOrder = 1; in LINEAR.geo$")
            assert not called(place), words
        assert not os.path.exists(os.path.join(place, "out"))


@fact
def every_command_runs_gmsh_where_it_is_allowed(folder):
    scene, options = geometry(folder)
    for words in commands(folder, scene):
        shutil.rmtree(os.path.join(folder, "cache"), ignore_errors=True)
        shutil.rmtree(os.path.join(folder, "out"), ignore_errors=True)
        expect(gneiss(*words, "--allow-gmsh", **options), 0)
        assert bool(called(folder)) == ("--dry-run" not in words), words


@fact
def a_packing_in_the_cache_is_no_permission(folder):
    scene, options = geometry(folder)
    expect(gneiss("check", scene, "--allow-gmsh", **options), 0)
    called(folder)
    expect(gneiss("check", scene, **options), 2, "--allow-gmsh")
    expect(gneiss("check", scene, "--allow-gmsh", **options), 0)
    assert not called(folder)  # the geometry was packed before


@fact
def a_run_is_resumed_with_or_without_the_permission(folder):
    scene, options = geometry(folder)
    out = os.path.join(folder, "out")
    run(scene, out, "--allow-gmsh", **options)
    called(folder)
    resume(out, "--set", "time.end=2e-5", **options)
    resume(out, "--set", "time.end=3e-5", "--allow-gmsh", **options)
    assert not called(folder)


@fact
def commands_that_read_no_scene_refuse_the_permission(folder):
    for words in (("report", folder), ("keys",), ("info",)):
        expect(gneiss(*words, "--allow-gmsh"), 2, "--allow-gmsh is for commands that read a scene")


@fact
def a_mesh_file_needs_no_permission(folder):
    scene, options = geometry(folder)
    expect(gneiss("check", scene, "--set", "specimen.mesh=square.msh", **options), 0)
    assert not called(folder)


@fact
def gmsh_is_asked_for_linear_elements_behind_the_geometry(folder):
    scene, options = geometry(folder)
    expect(gneiss("check", scene, "--allow-gmsh", **options), 0)
    assert re.search(r"body\.geo /\S*order\.geo\nMesh\.ElementOrder = 1;", called(folder))


@fact
def a_geometry_of_second_order_is_meshed(folder):
    if not shutil.which("gmsh"):
        raise Skip("no gmsh")
    with open(os.path.join(folder, "body.geo"), "w") as file:
        file.write('SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\nMesh.MeshSizeMax = 0.5;\n'
                   "Mesh.ElementOrder = 2;\n")
    expect(gneiss("check", write_scene(folder, SCENE), "--allow-gmsh", environment={"GNEISS_CACHE": "off"}), 0)


@fact
def messages_about_a_mesh_by_gmsh_name_the_geometry(folder):
    scene, options = geometry(folder)
    with open(os.path.join(folder, "square.msh"), "w") as file:
        file.write(SQUARE.replace("1 2 2 0 1 1 2 3", "1 34 2 0 1 1 2 3 4"))
    done = expect(gneiss("check", scene, "--allow-gmsh", **options), 2,
                  r"/body\.geo: in the mesh that gmsh made of it:13:3: expected points, .* of type 34")
    assert "gneiss-mesh" not in done.stderr


if __name__ == "__main__":
    sys.exit(main())
