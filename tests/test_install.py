#!/usr/bin/python3
"""test_install.py BUILD SANITIZERS: installs the finished build into a temporary folder and uses it from there as a
stranger would: headers, pkg-config, shared and static library, the example. One TAP line per fact."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

BUILD, SANITIZERS = os.path.abspath(sys.argv[1]), sys.argv[2]
EXAMPLES = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "examples")
CC, CXX = shutil.which("cc"), shutil.which("c++")
FACTS = []


class Skip(Exception):
    pass


def fact(function):
    FACTS.append(function)
    return function


def run(*command, **options):
    """Returns standard output; an exit code other than 0 fails the fact with the output of the command."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=200, **options)
    assert done.returncode == 0, f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


class Installed:
    """Installs the build below a folder of its own; nothing outside of it changes."""

    def __init__(self, root):
        self.root = root
        run(shutil.which("meson") or "/usr/bin/meson", "install", "-C", BUILD, "--no-rebuild", "--quiet", "--destdir", root)
        self.config = self.find("gneiss.pc")
        text = open(self.config, encoding="utf-8").read()
        self.prefix = root + re.search(r"^prefix=(.*)$", text, re.MULTILINE)[1]
        self.header = self.find("gneiss.h")
        self.library = os.path.dirname(self.find("libgneiss.so"))

    def find(self, name, folder=""):
        """Returns the only file of the name, in a folder of this name."""
        places = [os.path.join(place, name) for place, _, files in os.walk(self.root) if name in files and place.endswith(folder)]
        assert len(places) == 1, f"expected one {name} in the installation, found {places}"
        return places[0]

    def flags(self, *options):
        """The output of pkg-config, with the prefix that the files have in the temporary folder."""
        path = [os.path.dirname(self.config), os.environ.get("PKG_CONFIG_PATH", "")]
        environment = {**os.environ, "PKG_CONFIG_PATH": ":".join(filter(None, path))}
        own = run("pkg-config", *options, "gneiss", env=environment).split()
        return [flag.replace(self.prefix[len(self.root):], self.prefix, 1) if flag[2:].startswith(
            self.prefix[len(self.root):]) else flag for flag in own]

    def example(self, name, flags, **options):
        program = os.path.join(self.root, name)
        run(CC, "-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", os.path.join(EXAMPLES, "two_spheres.c"),
            "-o", program, *flags)
        environment = {**os.environ, **options}
        return run(program, os.path.join(EXAMPLES, "two_spheres.yaml"), program + ".h5", env=environment)


def check_example(text):
    states = re.findall(r"state ([0-9a-f]{16})", text)
    assert len(states) == 2 and states[0] == states[1], text
    modulus = float(re.search(r"young_modulus = (\S+) Pa", text)[1])
    assert abs(modulus - 0.5e9) < 1e-5 * 0.5e9, text


@fact
def the_example_runs_with_the_shared_library(place):
    if SANITIZERS != "none":
        raise Skip("the library is instrumented, a plain program cannot load it")
    check_example(place.example("shared", place.flags("--cflags", "--libs"), LD_LIBRARY_PATH=place.library))


@fact
def the_example_runs_with_the_static_library(place):
    if SANITIZERS != "none":
        raise Skip("the library is instrumented, a plain program cannot hold it")
    if "clang" in run(CC, "--version"):
        raise Skip("cc may bring another OpenMP than the library was built with")
    flags = place.flags("--cflags")
    private = [f for f in place.flags("--libs", "--static") if f != "-lgneiss"]
    check_example(place.example("static", [*flags, place.find("libgneiss.a"), *private]))


@fact
def programs_get_no_flags_of_the_libraries_inside(place):
    """HDF5's header folder would take precedence over that of the program's own HDF5."""
    assert [flag for flag in place.flags("--cflags") if "hdf5" in flag] == [], place.flags("--cflags")
    assert [flag for flag in place.flags("--libs") if flag != "-lgneiss" and not flag.startswith("-L" + place.root)] == []


def check_folders_without_dpkg_dev(folder):
    stubs, build = os.path.join(folder, "stubs"), os.path.join(folder, "build")
    os.makedirs(stubs)
    with open(os.path.join(stubs, "dpkg-architecture"), "w", encoding="utf-8") as file:
        file.write("#!/bin/sh\nexit 1\n")
    os.chmod(file.name, 0o755)
    meson = shutil.which("meson") or "/usr/bin/meson"
    environment = {**os.environ, "PATH": stubs + ":" + os.environ["PATH"]}
    run(meson, "setup", build, os.path.dirname(EXAMPLES), env=environment)
    installed = json.loads(run(meson, "introspect", "--installed", build))
    places = {target for target in installed.values() if os.path.basename(target) in ("libgneiss.so", "libgneiss.a", "gneiss.pc")}
    assert places and all("/lib64/" not in target for target in places), places
    with open(os.path.join(build, "meson-private", "gneiss.pc"), encoding="utf-8") as file:
        assert not re.search("^Libs: .*lib64", file.read(), re.M)


@fact
def libraries_go_where_the_linker_looks_also_without_dpkg_dev(place):
    """Meson asks dpkg-architecture for the folder, and uses lib64 if that command is absent."""
    if not os.path.exists("/etc/debian_version"):
        raise Skip("not Debian")
    with tempfile.TemporaryDirectory() as folder:
        check_folders_without_dpkg_dev(folder)


@fact
def the_header_is_strict_c99(place):
    run(CC, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wstrict-prototypes", "-Werror", "-fsyntax-only",
        "-I", os.path.dirname(os.path.dirname(place.header)), "-x", "c", place.header)


@fact
def the_header_is_cxx_with_c_linkage(place):
    if not CXX:
        raise Skip("no c++")
    source, made = os.path.join(place.root, "user.cpp"), os.path.join(place.root, "user.o")
    with open(source, "w", encoding="utf-8") as file:
        file.write('#include <gneiss/gneiss.h>\n'
                   'int main() { gneiss_error e; gneiss_world *w = NULL; gneiss_view v; e.status = GNEISS_OK;\n'
                   'gneiss_world_free(w); return gneiss_world_field(w, GNEISS_PARTICLES, "pos", &v, &e); }\n')
    for standard in ("c++11", "c++20"):
        run(CXX, "-std=" + standard, "-pedantic", "-Wall", "-Wextra", "-Werror", "-c", source, "-o", made,
            "-I", os.path.dirname(os.path.dirname(place.header)))
    wanted = re.findall(r"U (\S*gneiss\S*)", run("nm", made))
    assert sorted(wanted) == ["gneiss_world_field", "gneiss_world_free"], wanted


@fact
def the_shared_library_shows_what_the_header_declares_and_nothing_else(place):
    if SANITIZERS != "none":
        raise Skip("sanitizers add symbols of their own")
    shown = {line.split()[2] for line in run("nm", "-D", "--defined-only", place.find("libgneiss.so")).splitlines()}
    text = open(place.header, encoding="utf-8").read()
    declared = set(re.findall(r"GNEISS_API [^;(]*?\b(gneiss_\w+)\(", text))
    assert declared and shown == declared, f"only shown: {shown - declared}, only declared: {declared - shown}"


@fact
def the_report_is_where_the_program_looks_for_it(place):
    program = place.find("gneiss", "/bin")
    script = os.path.join(os.path.dirname(program), "../share/gneiss/report.py")
    for name in os.listdir(os.path.join(os.path.dirname(EXAMPLES), "tools")):
        if re.fullmatch(r"report.*\.py|view.*", name):
            assert os.path.exists(os.path.join(os.path.dirname(script), name)), f"{name} is not installed"
    for folder in ("calibrate", "convert"):
        for name in os.listdir(os.path.join(os.path.dirname(EXAMPLES), folder)):
            if name.endswith(".py"):
                assert os.path.exists(os.path.join(os.path.dirname(script), folder, name)), f"{folder}/{name} is not installed"
    done = subprocess.run([program, "report", place.root], capture_output=True, text=True, timeout=100)
    assert done.returncode == 2 and "results.h5" in done.stderr, (done.returncode, done.stderr)


@fact
def every_command_has_a_page_of_the_manual_and_completions(place):
    """`gneiss help` prints the names of the commands; the pages have the texts of `gneiss help NAME`."""
    program, folder = place.find("gneiss", "/bin"), os.path.dirname(place.find("gneiss.1"))
    commands = re.findall(r"^  (\w+) ", run(program, "help").split("commands:")[1].split("options:")[0], re.MULTILINE)
    assert sorted(os.listdir(folder)) == sorted(["gneiss.1", *(f"gneiss-{name}.1" for name in commands)]), os.listdir(folder)
    for name in commands:
        with open(os.path.join(folder, f"gneiss-{name}.1"), encoding="utf-8") as file:
            assert file.read() == run(program, "help", name, "--man"), name
    script = place.find("gneiss", "/bash-completion/completions")
    done = run("bash", "-c", f"PATH={os.path.dirname(program)}:$PATH; source {script}; COMP_WORDS=(gneiss explain time.st); COMP_CWORD=2; _gneiss; "
               "echo ${COMPREPLY[@]}; COMP_WORDS=(gneiss pack --qu); _gneiss; echo ${COMPREPLY[@]}; COMP_WORDS=(gneiss swe); COMP_CWORD=1; _gneiss; echo ${COMPREPLY[@]}")
    assert done.splitlines()[0].startswith("time.step time.start ") and done.splitlines()[1:] == ["--quiet", "sweep"], done
    for name in (place.find("_gneiss"), place.find("gneiss.fish")):
        with open(name, encoding="utf-8") as file:
            text = file.read()
        assert all(name in text for name in commands), name


@fact
def scenes_pages_and_examples_are_installed_and_run(place):
    program = place.find("gneiss", "/bin")
    scenes = os.path.join(os.path.dirname(program), "../share/gneiss/scenes")
    assert "can run" in run(program, "check", os.path.join(scenes, "hydrostatic.yaml"), "--quiet")
    page = run(program, "explain", "time.step").split("pages:\n")[1].split()[0].split("#")[0]
    documents = os.path.dirname(os.path.dirname(place.find("keys.md")))
    for name in (page, "README.md", "CHANGELOG.md", "CITATION.cff", "examples/two_spheres.c"):
        assert os.path.exists(os.path.join(documents, name)), name


@fact
def the_python_module_finds_its_library_and_its_program(place):
    if SANITIZERS != "none":
        raise Skip("the library is instrumented, Python cannot load it")
    module = os.path.dirname(place.find("keys.py"))
    for name in os.listdir(os.path.join(os.path.dirname(EXAMPLES), "python", "gneiss")):
        if name.endswith(".py"):
            assert os.path.exists(os.path.join(module, name)), f"python/gneiss/{name} is not installed"
    script = ("import gneiss, sys\n"
              "with gneiss.World(sys.argv[1]) as world: world.run(); print(world.readings['young_modulus'])\n"
              "print(gneiss.__file__, gneiss._library.program())\n")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GNEISS_")}
    text = run("/usr/bin/python3", "-c", script, os.path.join(EXAMPLES, "two_spheres.yaml"), cwd=place.root,
               env={**environment, "PYTHONPATH": os.path.dirname(module)})
    modulus, places = text.splitlines()
    assert abs(float(modulus) - 0.5e9) < 1e-5 * 0.5e9
    assert all(os.path.realpath(path).startswith(os.path.realpath(place.root)) for path in places.split()), places


@fact
def nothing_of_the_inside_is_installed(place):
    headers = [name for _, _, files in os.walk(place.root) for name in files if name.endswith(".h")]
    assert sorted(headers) == ["gneiss.h", "status.h"], headers
    libraries = [name for _, _, files in os.walk(place.root) for name in files if ".a" in name or ".so" in name]
    assert all(name.startswith("libgneiss.") for name in libraries), libraries


def main():
    missing = [name for name in ("cc", "pkg-config", "nm") if not shutil.which(name)]
    if missing:
        print(f"1..0 # SKIP {' and '.join(missing)} missing", flush=True)
        return 0
    print(f"1..{len(FACTS)}", flush=True)
    failed = 0
    with tempfile.TemporaryDirectory() as root:
        place = Installed(root)
        for number, test in enumerate(FACTS, 1):
            try:
                test(place)
                print(f"ok {number} - {test.__name__}", flush=True)
            except Skip as e:
                print(f"ok {number} - {test.__name__} # SKIP {e}", flush=True)
            except Exception as e:  # every failure is reported and counted
                failed += 1
                print(f"not ok {number} - {test.__name__}", flush=True)
                print(f"{test.__name__}: {type(e).__name__}: {e}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
