"""Output and builds of `./do`, in a root of its own with a build folder whose program is a stub. Speaks TAP."""
import select

from program import *  # noqa: F403

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COUNT = os.path.join(ROOT, "tools", "count_tests.py")
LAYERS = os.path.join(ROOT, "tools", "layers.py")
LINKS = os.path.join(ROOT, "tools", "links.py")
WORDS = os.path.join(ROOT, "tools", "words.py")

# Has the form of meson's file but compiles nothing.
NINJA = """
rule make
  command = {command} && touch $out
  description = making $out
rule program
  command = printf '#!/bin/sh\\necho "stub $$*"\\n' > $out && chmod +x $out
  description = making $out
build compiled.o: make
build gneiss: program compiled.o
build tests/test_all: make
default gneiss tests/test_all
"""


def make_root(folder, command="true"):
    """A copy of `do` beside a build folder that counts as configured."""
    build = os.path.join(folder, "build")
    os.makedirs(build)
    shutil.copy(os.path.join(ROOT, "do"), folder)
    write_scene(build, NINJA.format(command=command), "build.ninja")
    mpi = "enabled" if shutil.which("mpicc") else "disabled"
    write_scene(build, f" --buildtype=release -Dmpi={mpi}", ".do-options")
    return build


def call(folder, *arguments, **options):
    if shutil.which("dpkg-query") is None:
        raise Skip("not Debian")
    environment = {**os.environ}
    environment.pop("CC", None)
    return subprocess.run([os.path.join(folder, "do"), *arguments], text=True, env=environment, timeout=120, cwd=folder,
                          **{"capture_output": True, **options})


@fact
def run_builds_the_program_and_no_tests(folder):
    build = make_root(folder)
    done = expect(call(folder, "run", "scene.yaml"), 0)
    assert done.stdout == "stub run --force scene.yaml\n", done.stdout
    assert os.path.exists(os.path.join(build, "compiled.o"))
    assert not os.path.exists(os.path.join(build, "tests")), "tests were built"


@fact
def a_build_says_what_it_builds_and_when_it_is_done(folder):
    make_root(folder)
    assert re.fullmatch(r"building gneiss in build: 2 steps\nbuilt in \d+ s\n", call(folder, "keys").stderr)
    assert call(folder, "keys").stderr == "", "there was nothing to build"


@fact
def a_build_on_a_terminal_shows_every_step(folder):
    make_root(folder)
    main_end, end = pty.openpty()
    expect(call(folder, "keys", capture_output=False, stdout=subprocess.PIPE, stderr=end), 0)
    os.close(end)
    shown = ""
    while select.select([main_end], [], [], 1.0)[0]:
        try:
            shown += os.read(main_end, 4096).decode()
        except OSError:
            break
    os.close(main_end)
    steps = re.findall(r"(\d+) % of the work, \d+ s: (making [\w.]+)", shown)
    assert steps == [("50", "making compiled.o"), ("100", "making gneiss")], shown


@fact
def a_long_build_says_how_long_it_takes_and_counts_work_not_files(folder):
    """Twelve kernels and two short steps: the stub compiles none of them."""
    build = make_root(folder)
    kernels = [f"src/kernels/libgneiss_kernels_avx2_contact{k}.a.p/contact_template.c.o" for k in range(12)]
    text = NINJA.format(command="mkdir -p $$(dirname $out)").replace("build gneiss: program compiled.o", "build gneiss: program compiled.o " + " ".join(kernels))
    text += "rule compile\n  command = true\n  description = Compiling C object $out\n"
    write_scene(build, text + "".join(f"build {kernel}: compile\n" for kernel in kernels), "build.ninja")
    main_end, end = pty.openpty()
    done = call(folder, "keys", capture_output=False, stdout=subprocess.PIPE, stderr=end)
    os.close(end)
    shown = ""
    while select.select([main_end], [], [], 1.0)[0]:
        try:
            shown += os.read(main_end, 4096).decode()
        except OSError:
            break
    os.close(main_end)
    expect(subprocess.CompletedProcess([], done.returncode, "", shown), 0)
    if os.cpu_count() <= 2:  # with more cores the estimate would be too short to be printed
        assert re.search(r"14 steps, about \d+ s on \d+ idle cores?", shown), shown
    shares = [int(share) for share in re.findall(r"(\d+) % of the work, \d+ s: kernels of contact for avx2_contact\d+", shown)]
    assert len(shares) == 12 and all(7 <= b - a <= 9 for a, b in zip(shares, shares[1:])) and shares[-1] >= 98, shown


@fact
def tests_install_what_locales_are_made_from(folder):
    """The package is missing: stubs replace the commands that query and install."""
    make_root(folder)
    bin = os.path.join(folder, "bin")
    os.makedirs(bin)
    for name, text in (("dpkg-query", 'for last; do :; done; [ "$last" = locales ] || printf installed'),
                       ("apt-get", f'echo "$@" >> {folder}/asked'), ("sudo", 'exec "$@"')):
        path = os.path.join(bin, name)
        write_scene(bin, f"#!/bin/sh\n{text}\n", name)
        os.chmod(path, 0o755)
    environment = {**os.environ, "PATH": bin + ":" + os.environ["PATH"]}
    subprocess.run([os.path.join(folder, "do"), "test"], capture_output=True, text=True, timeout=120, cwd=folder, env=environment)
    with open(os.path.join(folder, "asked")) as file:
        assert re.search(r"install .* locales$", file.read(), re.M)


@fact
def a_build_that_fails_shows_why_and_ends_in_an_error(folder):
    make_root(folder, "echo what went wrong; false")
    done = call(folder, "keys")
    assert done.returncode != 0 and "what went wrong" in done.stderr and "built in" not in done.stderr, done.stderr


@fact
def failures_of_meson_are_counted(folder):
    entries = [{"name": "good", "result": "OK", "stdout": "1..2\nok 1 a\nok 2 b # SKIP no such thing\n"},
               {"name": "bad", "result": "FAIL", "returncode": 0, "stdout": "1..2\nok 1 - a\n# why\nnot ok 2 # SKIP b\n"}]
    log = write_scene(folder, "\n".join(json.dumps(entry) for entry in entries), "log.json")
    done = subprocess.run([sys.executable, COUNT, log], capture_output=True, text=True)
    reported = "failed: bad (FAIL)\n    # why\n    not ok 2 # SKIP b\n2 passed, 1 failed, 1 skipped\n"
    assert (done.returncode, done.stdout) == (1, reported), done.stdout


@fact
def links_and_pictures_that_are_not_there_are_named(folder):
    docs = "docs"  # a name that is no page of this project, because the links of this file would be checked
    os.makedirs(os.path.join(folder, docs, "pictures"))
    page = "# A page: what, how\n[a](#a-page-what-how) [b](#no) [c](../README.md) [d](gone.md)\n"
    write_scene(folder, page + "![e](pictures/e.png) ![f](pictures/f.png)\n", f"{docs}/page.md")
    first = f"See [the page]({docs}/page.md#a-page-what-how), `{docs}/gone.md` and [the net](https://example.org).\n"
    write_scene(folder, first, "README.md")
    write_scene(folder, "many words " * 2000, f"{docs}/long.md")
    os.makedirs(os.path.join(folder, "packaging", "site"))
    write_scene(folder, "```{toctree}\npage\n```\n", "packaging/site/index.md")
    for name in ("e.png", "g.png"):
        write_scene(folder, "", f"{docs}/pictures/{name}")
    done = subprocess.run([sys.executable, LINKS, folder], capture_output=True, text=True)
    reported = (f"README.md:1: {docs}/gone.md is not there\n{docs}/long.md:1: expected at most 300 lines and 3000 words, found 1 and 4000\n"
            f"{docs}/page.md:2: #no: there is no such heading\n"
            f"{docs}/page.md:2: gone.md is not there\n{docs}/page.md:3: pictures/f.png is not there\n"
            f"{docs}/long.md:1: expected it in packaging/site/index.md, which does not name it\n"
            f"{docs}/pictures/g.png: no page shows it\n")
    assert (done.returncode, done.stdout) == (1, reported), done.stdout + done.stderr


@fact
def what_breaks_the_order_of_the_folders_is_named(folder):
    for path in ("src", "docs/design.md"):
        os.makedirs(os.path.dirname(os.path.join(folder, path)) or folder, exist_ok=True)
        (shutil.copytree if path == "src" else shutil.copy)(os.path.join(ROOT, path), os.path.join(folder, path))

    def reported():
        done = subprocess.run([sys.executable, LAYERS, folder], capture_output=True, text=True)
        assert done.returncode == bool(done.stdout), done.stdout + done.stderr
        return done.stdout

    assert reported() == "", reported()
    long = "void gn_long(void);\nvoid gn_long(void) {\n" + "    ;\n" * 60 + "}\n"
    for path, text, words in (
            ("src/soa/field.c", '#include "world/world.h"\n', "soa includes world/world.h, which its row does not name"),
            ("src/world/step.c", '#include "boundary/boundary_private.h"\n', "world includes boundary/boundary_private.h"),
            ("src/soa/field.h", "void gn_world_free(gn_world *world);\n", "declares gn_world_free, which src/world/world.c defines"),
            ("src/world/step.c", "static void f(gn_dem *d) { d->loose[d->particles.id[0]] = 1; }\n",
             "writes to a field of the part dem: expected a function of src/particles"),
            ("src/cli/main.c", "static void f(gn_run *run) { run->world.zones.state.turned++; }\n", "writes to a field of the part zones"),
            ("src/soa/field.c", long, "a function of 62 lines, expected at most 60"),
            ("src/new/new.c", "\n", "src/new has no row")):
        path = os.path.join(folder, path)
        before = open(path).read() if os.path.exists(path) else None
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "a") as file:
            file.write(text)
        said = reported()
        assert words in said and said.count("\n") == 1, said
        if before is None:
            shutil.rmtree(os.path.dirname(path))
        else:
            with open(path, "w") as file:
                file.write(before)
    assert reported() == "", reported()
    for k in range(16):
        write_scene(folder, '#include "pack/shape.h"\n', f"src/world/reader_{k}.c")
    assert "src/pack/shape.h: " in reported() and "expected at most 15, or src/pack/pack.h" in reported(), reported()


@fact
def every_page_leads_to_what_is_there(folder):
    done = subprocess.run([sys.executable, LINKS], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), done.stdout + done.stderr


@fact
def words_of_comments_and_pages_are_checked_and_code_is_not(folder):
    os.makedirs(os.path.join(folder, "src"))
    write_scene(folder, 'int who; /* Told\n * by hand. */\n/* A grain that was put\n * by. */\nf("asleep"); // What it is\n', "src/a.c")
    write_scene(folder, 'def who():\n    """Of a body."""\n    return "told"  # nobody\n', "src/b.py")
    write_scene(folder, "A page. `told` [told](awake.md)\n\n    code is told\n\n" + "long " * 40 + "\n", "src/c.md")
    done = subprocess.run([sys.executable, WORDS, "--root", folder, "src"], capture_output=True, text=True)
    found = [line.split(": ")[:2] for line in done.stdout.splitlines()]
    assert found == [["src/a.c:1", "Told"], ["src/a.c:3", "put by"], ["src/a.c:5", "What"], ["src/b.py:2", "Of"],
                     ["src/b.py:3", "nobody"], ["src/c.md:1", "told"], ["src/c.md:5", "200 characters"]], done.stdout
    assert done.returncode == 1
    counts = subprocess.run([sys.executable, WORDS, "--root", folder, "--count"], capture_output=True, text=True)
    assert (counts.returncode, counts.stdout.split()) == (0, ["7", "src", "7"]), counts.stdout


@fact
def files_that_name_another_version_are_named(folder):
    tool = os.path.join(ROOT, "tools", "release.py")
    done = subprocess.run([sys.executable, tool], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), done.stdout + done.stderr
    for name in ("meson.build", "CITATION.cff", "CHANGELOG.md", "packaging/debian/changelog"):
        os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
        shutil.copy(os.path.join(ROOT, name), os.path.join(folder, name))
    write_scene(folder, "cff-version: 1.2.0\nversion: 9.9\n", "CITATION.cff")
    done = subprocess.run([sys.executable, tool, folder], capture_output=True, text=True)
    assert done.returncode == 1 and re.fullmatch(r"CITATION.cff: expected version \S+ as in meson.build, found 9.9\n", done.stdout), done.stdout
    with open(os.path.join(folder, "CHANGELOG.md"), "w", encoding="utf-8") as file:
        file.write("# Changes\n\n## 0.2.0 (soon)\n\nNothing.\n")
    done = subprocess.run([sys.executable, tool, folder], capture_output=True, text=True)
    assert done.returncode == 1 and "CHANGELOG.md: expected" in done.stdout, done.stdout


@fact
def places_that_are_clean_stay_clean(_):
    done = subprocess.run([sys.executable, WORDS], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), done.stdout + done.stderr


if __name__ == "__main__":
    sys.exit(main())
