"""Robustness of `gneiss calibrate`: kills at random moments, full and read-only disks, two calibrations in a folder, bad and mutated files of
targets. Fills the sections `kills` and `targets` of docs/evidence/calibration.md.

    /usr/bin/python3 validate/calibration_faults.py [kills] [targets] [--kills 20] [--mutations 2000] [--kept]

Without a name both sections are measured. With --kept nothing is run: sections are as they were. Some five CPU minutes.
"""
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time

import calibration_page
import study

FLAGS = ("--kills", "--mutations", "--kept")
FOLDER = study.RUNS / "calibration"
SPECIMEN = "specimen: {cylinder: {diameter: 20 mm, height: 40 mm}, particles: 250}\n"
GOOD = SPECIMEN + """law: linear
seeds: 3
targets:
  young_modulus: {value: 20 GPa, tolerance: 3 %}
  poisson_ratio: {value: 0.2, tolerance: 0.02}
  compressive_strength: {value: 45 MPa, tolerance: 6 %}
  tensile_strength: {value: 10 MPa, tolerance: 6 %}
"""


def option(name, default):
    return int(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else default


def written(folder, text, name="targets.yaml"):
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return str(path)


def command(target, out, *options):
    return [study.PROGRAM, "calibrate", target, "--out", str(out), "--threads", "1", "--quiet", *options]


def called(arguments):
    return subprocess.run(arguments, capture_output=True, text=True, errors="replace", cwd=study.ROOT, check=False)


# --- kills ---------------------------------------------------------------------------------------------

def result(out):
    """calibration.json without its times."""
    whole = json.loads((out / "calibration.json").read_text())
    whole.pop("cpu_seconds")
    return whole


def outcomes(out):
    """Returns {run: time of its outcome}."""
    return {path.parent.name: path.stat().st_mtime_ns for path in (out / "runs").glob("*/outcome.json")}


def killed(target, out, seconds):
    """Starts a calibration and kills its whole process group after this number of seconds; returns whether it was
    still running."""
    process = subprocess.Popen(command(target, out), cwd=study.ROOT, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        process.wait(seconds)
        return False
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return True


def twenty_kills():
    """Rows on the kills and on the calibration that they disturbed."""
    folder, count, generator = FOLDER / "kills", option("--kills", 20), random.Random(7)
    shutil.rmtree(folder, ignore_errors=True)
    target = written(folder, GOOD)
    begun = time.monotonic()
    undisturbed = called(command(target, folder / "undisturbed"))
    span = time.monotonic() - begun
    if undisturbed.returncode:
        sys.exit(undisturbed.stderr)
    out, kills, starts, before, repeated, broken = folder / "killed", 0, 0, {}, 0, 0
    while kills < count:
        starts += 1
        kills += killed(target, out, generator.uniform(0.05, 0.2) * span)
        now = outcomes(out)
        repeated += sum(now.get(name) != when for name, when in before.items())
        before = now
        for path in [*out.glob("calibra*"), *out.glob("runs/*/outcome.json")]:
            try:
                broken += path.suffix == ".json" and not json.loads(path.read_text())
            except ValueError:
                broken += 1
        print(f"{kills} kills, {len(now)} runs kept", file=sys.stderr, flush=True)
    last = called(command(target, out))
    same = result(out) == result(folder / "undisturbed")
    scene = (out / "calibrated.yaml").read_bytes() == (folder / "undisturbed" / "calibrated.yaml").read_bytes()
    left = list(out.rglob(".part-*"))
    return [["kills of the process group", kills], ["starts, with the last one", starts + 1], ["exit code of the last one", last.returncode],
            ["finished runs that were lost or made again", repeated], ["files that were there in part", broken],
            ["calibration.json without times as that of the undisturbed one", "yes" if same else "no"],
            ["calibrated.yaml as that of the undisturbed one", "yes" if scene else "no"],
            ["runs, undisturbed and killed", f"{len(outcomes(folder / 'undisturbed'))}, {len(outcomes(out))}"],
            ["parts of files left in the folder", len(left)]]


MOUNTED = 'mount -t tmpfs -o {options} none "$1" || exit 77; shift; "$@"; code=$?; echo "left: $(ls -A "{folder}" | tr "\\n" " ")"; exit $code'


def on_disk(name, options):
    """Calls the command with a folder on a disk of its own; returns exit code and message."""
    folder = FOLDER / "kills" / name.replace(" ", "-")
    folder.mkdir(parents=True, exist_ok=True)
    target = written(FOLDER / "kills", GOOD)
    script = MOUNTED.format(options=options, folder=folder)
    done = called(["unshare", "-m", "--propagation", "private", "sh", "-c", script, "sh", str(folder), *command(target, folder)])
    return [name, done.returncode, refusal(done)]


def refusal(done):
    lines = (done.stderr.strip() or done.stdout.strip() or "no message").splitlines()
    text = "a traceback" if "Traceback" in done.stderr else next((line for line in lines if line.startswith("gneiss: ")), lines[-1])
    return re.sub(r"/[^ :]*/([^/ :]+)", r"\1", text).replace("|", "/")[:300]


def second_start():
    folder = FOLDER / "kills" / "second"
    shutil.rmtree(folder, ignore_errors=True)
    target = written(FOLDER / "kills", GOOD)
    first = subprocess.Popen(command(target, folder), cwd=study.ROOT, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while not (folder / ".lock").exists():
        time.sleep(0.1)
    second = called(command(target, folder))
    os.killpg(first.pid, signal.SIGTERM)
    said = first.communicate()[1].strip()
    return [["a second start in the folder of a running one", second.returncode, refusal(second)],
            ["SIGTERM to the group", first.returncode, said.splitlines()[-1] if said else "no message"]]


def no_folder():
    target = written(FOLDER / "kills", GOOD)
    done = called(command(target, target))
    return ["--out names a file", done.returncode, refusal(done)]


def kills():
    rows = twenty_kills()
    disks = [*second_start(), on_disk("read-only disk", "ro"), *[on_disk(f"disk of {size}", f"size={size}") for size in ("64k", "600k", "3m")], no_folder()]
    text = f"""One calibration (250 particles, three packings) is killed with SIGKILL of its whole process group at random moments, 5 to 20 % of its
undisturbed duration after each start, and started again. `/usr/bin/python3 validate/calibration_faults.py kills`.

{study.table(['kills', ''], rows)}

{study.table(['folder', 'exit code', 'message'], disks)}
"""
    return "Kills, disks, second starts", text


# --- bad targets ---------------------------------------------------------------------------------------

SCENE = """dimension: 3
specimen: {cylinder: {diameter: 20 mm, height: 40 mm}, particles: 250, density_basis: bulk}
materials: [{name: rock, density: 2600, friction: 0.5, contact_modulus: 14e9, kratio: 5, tensile_strength: 9e6, shear_strength: 14e6}]
law: {stiffness: harmonic}
bonds: {interaction_range: 0.05}
"""
E = SPECIMEN + "law: linear\nseeds: 2\ntargets:\n  young_modulus: 20 GPa\n"
ONE = SPECIMEN + "law: linear\nseeds: 2\ntargets: "

# Each: the mistake, the file of targets, and a base scene beside it.
BAD = (
    ("tension above compression", E + "  compressive_strength: 10 MPa\n  tensile_strength: 20 MPa\n"),
    ("strength above the modulus", E + "  compressive_strength: 30 GPa\n"),
    ("confined strength below the confinement", E + "  triaxial: [{confinement: 50 MPa, value: 20 MPa}]\n"),
    ("the same confinement twice", E + "  triaxial: [{confinement: 5 MPa, value: 60 MPa}, {confinement: 5 MPa, value: 90 MPa}]\n"),
    ("crack initiation without a strength", E + "  crack_initiation_stress: 20 MPa\n"),
    ("friction angle without a strength", E + "  friction_angle: 40\n"),
    ("ratio of strengths out of reach", E + "  compressive_strength: 45 MPa\n  tensile_strength: 1 MPa\n"),
    ("Poisson's ratio out of reach", ONE + "{poisson_ratio: 0.45}\n"),
    ("Poisson's ratio of 0.6", E + "  poisson_ratio: 0.6\n"),
    ("negative strength", E + "  compressive_strength: -60 MPa\n"),
    ("modulus of 0", ONE + "{young_modulus: 0 GPa}\n"),
    ("modulus without a unit", ONE + "{young_modulus: 20}\n"),
    ("tolerance of 0", E + "  poisson_ratio: {value: 0.2, tolerance: 0}\n"),
    ("NaN", E + "  compressive_strength: nan\n"),
    ("infinity", E + "  compressive_strength: inf\n"),
    ("number beyond double", E + "  compressive_strength: 1e400 MPa\n"),
    ("unknown reading", E + "  hardness: 60 MPa\n"),
    ("unknown key", E + "walls: []\n"),
    ("unknown key of a target", E + "  poisson_ratio: {value: 0.2, error: 0.1}\n"),
    ("unknown law", E.replace("linear", "magic")),
    ("length for a stress", E + "  compressive_strength: 60 m\n"),
    ("unknown unit", E + "  compressive_strength: 60 MPx\n"),
    ("a key twice", E + "  young_modulus: 30 GPa\n"),
    ("no targets", SPECIMEN),
    ("empty targets", ONE + "{}\n"),
    ("targets as a list", ONE + "[1, 2]\n"),
    ("empty file", ""),
    ("a comment alone", "# nothing\n"),
    ("bracket without an end", "targets: [1\n"),
    ("tab as indentation", "targets:\n\tyoung_modulus: 20 GPa\n"),
    ("a section that contains itself", "targets: &a [*a]\n"),
    ("10 000 sections in each other", "targets: " + "[" * 10000),
    ("two documents", E + "---\n" + E),
    ("bytes that are no UTF-8", b"targets: \xff\xfe\n"),
    ("bytes of 0", b"targets: \0\n"),
    ("budget of 0", E + "budget: 0\n"),
    ("negative budget", E + "budget: -5 runs\n"),
    ("budget in metres", E + "budget: 10 m\n"),
    ("budget of one run", E + "budget: 1\n"),
    ("budget of 1 ms", E + "budget: 1 ms\n"),
    ("huge budget", E + "budget: 99999999999999999999 runs\n"),
    ("seeds that are no whole numbers", E.replace("seeds: 2", "seeds: [1.5, 2]")),
    ("a seed twice", E.replace("seeds: 2", "seeds: [1, 1]")),
    ("no particles", E.replace("250", "0")),
    ("particles as a word", E.replace("250", "many")),
    ("specimen without a height", E.replace(", height: 40 mm", "")),
    ("specimen of 0 mm", E.replace("20 mm", "0 mm")),
    ("an unknown key of the specimen", E.replace("particles", "porous: yes, particles")),
    ("a cylinder in 2D", "dimension: 2\n" + E),
    ("a rectangle in 3D", E.replace("cylinder: {diameter", "rectangle: {width")),
    ("a disc", E.replace("cylinder: {diameter: 20 mm, height: 40 mm}", "disc: {diameter: 20 mm}")),
    ("specimen and scene", E + "scene: base.yaml\n"),
    ("a scene that is not there", "scene: none.yaml\ntargets: {young_modulus: 20 GPa}\n"),
    ("a folder as the scene", "scene: .\ntargets: {young_modulus: 20 GPa}\n"),
    ("a scene without bonds", "scene: base.yaml\nseeds: 2\ntargets: {young_modulus: 20 GPa}\n", SCENE.replace("bonds: {interaction_range: 0.05}\n", "")),
    ("a scene without a law", "scene: base.yaml\ntargets: {young_modulus: 20 GPa}\n", SCENE.replace("law: {stiffness: harmonic}\n", "")),
    ("a scene with an unknown law", "scene: base.yaml\nseeds: 2\ntargets: {young_modulus: 20 GPa}\n", SCENE.replace("harmonic", "magic")),
    ("a scene with two materials", "scene: base.yaml\ntargets: {young_modulus: 20 GPa}\n", SCENE.replace("14e6}]", "14e6}, {name: steel, density: 7800}]")),
    ("a scene without a density", "scene: base.yaml\ntargets: {young_modulus: 20 GPa}\n", SCENE.replace("density: 2600, ", "")),
    ("a key that is no parameter", "scene: base.yaml\nparameters: {density: [1000, 3000]}\ntargets: {young_modulus: 20 GPa}\n", SCENE),
    ("a range without the value of the scene", "scene: base.yaml\nparameters: {friction: [0.6, 1]}\ntargets: {young_modulus: 20 GPa}\n", SCENE),
    ("parameters without a scene", E + "parameters: {friction: [0.2, 1]}\n"),
    ("a curve that is not there", E + "  curve: none.csv\n"),
    ("a file and a shape in a scene", "scene: base.yaml\ntargets: {young_modulus: 20 GPa}\n", SCENE.replace("particles: 250", "particles: 250, file: rock.txt")),
    ("a scene with a wrong unit", "scene: base.yaml\nseeds: 2\ntargets: {young_modulus: 20 GPa}\n", SCENE.replace("friction: 0.5", "friction: 5 kg")),
)


def message(code, said, printed):
    """Returns the message of a refusal, otherwise what the result says of unreached targets, otherwise its first
    line."""
    lines = [line.strip() for line in (said if code else printed).splitlines()]
    if code:
        return re.sub(r"/[^ :]*/([^/ :]+)", r"\1", lines[0]).replace("|", "/")[:300] if lines else "no message"
    told = [line for line in lines if "not reach" in line and ":" in line and not line.startswith("law")] or lines[:1]
    return re.sub(r"/[^ :]*/([^/ :]+)", r"\1", told[-1]).replace("|", "/")[:300] if told else "no message"


def bad_rows():
    folder = FOLDER / "targets"
    shutil.rmtree(folder, ignore_errors=True)
    texts = []
    for number, (_, text, *scene) in enumerate(BAD):
        target = written(folder / str(number), text)
        if scene:
            written(folder / str(number), scene[0], "base.yaml")
        texts.append([target, str(folder / str(number) / "out"), {}])
    told = harness(folder, texts, study.PROGRAM)
    return [[wrong, code, message(code, said, printed)] for (wrong, *_), (code, said, printed) in zip(BAD, told)]


# --- mutations -----------------------------------------------------------------------------------------

FILES = (SPECIMEN + """title: a rock
density: 2600
friction: 0.5
law: auto
seeds: 3
budget: 10 min
targets:
  young_modulus: {value: 20 GPa, tolerance: 3 %}
  poisson_ratio: {value: 0.2, tolerance: 0.02}
  compressive_strength: 45 MPa
  tensile_strength: {value: 10 MPa, tolerance: 6 %}
  triaxial:
    - {confinement: 5 MPa, value: 70 MPa}
    - {confinement: 10 MPa, value: 90 MPa}
""", """dimension: 2
specimen:
  rectangle: {width: 20 mm, height: 40 mm}
  particles: 300
law: linear
seeds: [1, 2]
targets: {compressive_strength: 45 MPa, brazilian_strength: 5 MPa, crack_initiation_stress: 20 MPa, friction_angle: 40 deg, m_i: 10}
budget: 30 runs
""", """scene: base.yaml
parameters: {friction: [0.2, 1], tensile_strength: [5 MPa, 20 MPa]}
targets: {young_modulus: 20 GPa, friction_angle: 40, compressive_strength: 60 MPa, curve: {file: curve.csv, confinement: 5 MPa, tolerance: 8 %}}
""", SCENE, "strain [%],stress [MPa]\n0,0\n0.1,20\n0.2,35.5\n0.3,20\n")
TOKENS = ("nan", "inf", "-1", "0", "1e400", "[]", "{}", "null", "~", '""', "*a", "&a [*a]", "!!python/object/apply:os.getcwd []", "\0", "yes", "1e-400",
          "0x10", "1_000", "20 GPa", "5 m", "%", "100 %", "-5 %", "[[1]]", "{a: 1}", "1.5", "? x", "- 1", ": ", "|", ">", "1e15", "9" * 20, ".nan", "-.inf",
          "#", '"', "'", "@", "`", "\t", "\ufeff", "$x", "../..", "/dev/null", "/", "\u00b2")
LETTERS = "{}[],:#'\"&*!|>%@`-? \n\t0129.eEnax\u00b5\0\a~"


def mutations(text, generator, count):
    """Truncations, replaced words, omitted, doubled and exchanged lines, and random letters."""
    for end in range(0, len(text), 3):
        yield text[:end]
    for word in re.finditer(r"[^\s{}\[\],:]+( (mm|MPa|GPa|%|min|runs|deg))?", text):
        for token in TOKENS:
            yield text[:word.start()] + token + text[word.end():]
    lines = text.splitlines(True)
    for a, _ in enumerate(lines):
        yield "".join(lines[:a] + lines[a + 1:])
        for b, _ in enumerate(lines):
            yield "".join(lines[b] if k == a else lines[a] if k == b else line for k, line in enumerate(lines))
        yield "".join(lines[:a] + lines[a:a + 1] * 2 + lines[a + 1:])
    for _ in range(count):
        mutated = text
        for _ in range(generator.randint(1, 3)):
            place, kind = generator.randrange(len(mutated)), generator.randrange(3)
            mutated = mutated[:place] + (generator.choice(LETTERS) if kind else "") + mutated[place + (kind != 1):]
        yield mutated


# Calls the command for every file of a list in one process: [exit code, standard error, standard output] of each.
HARNESS = """
import contextlib, io, json, sys, traceback
sys.path[:0] = [{root!r}, {root!r} + "/tools"]
from calibrate import command
told = []
for target, out, files in json.load(open({list!r})):
    for path, text in files.items():
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)
    said, printed = io.StringIO(), io.StringIO()
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(printed):
            code = command.main([target, "--program", {program!r}, "--out", out, "--quiet", "--threads", "1"])
    except (Exception, SystemExit) as error:
        code = "traceback: " + repr(error)[:200]
    told.append([code, said.getvalue(), printed.getvalue()])
json.dump(told, sys.stdout)
"""


def harness(folder, texts, program):
    code = HARNESS.format(root=str(study.ROOT), list=written(folder, json.dumps(texts), "list.json"), program=program)
    done = called([sys.executable, "-c", code])
    if done.returncode:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def mutated():
    """Returns (codes, wrong ones) of all mutations. A substitute for the program refuses every run, so that accepted
    files end there."""
    folder, generator, count = FOLDER / "mutations", random.Random(8), option("--mutations", 2000)
    shutil.rmtree(folder, ignore_errors=True)
    program = written(folder, '#!/bin/sh\ncase $1 in version) echo "gneiss stand-in (0)";; *) echo "a stand-in" >&2; exit 5;; esac\n', "program")
    os.chmod(program, 0o755)
    target, scene, curve = (str(folder / name) for name in ("targets.yaml", "base.yaml", "curve.csv"))
    good = {target: FILES[2], scene: SCENE, curve: FILES[4]}
    texts = [{**good, target: one} for text in FILES[:3] for one in mutations(text, generator, count // 5)]
    texts += [{**good, path: one} for path in (scene, curve) for one in mutations(good[path], generator, count // 5)]
    codes, wrong = {}, []
    for files, (code, said, printed) in zip(texts, harness(folder, [[target, str(folder / "out"), files] for files in texts], program)):
        result = "accepted" if "a stand-in" in said + printed else code  # Searches by keys of the material end with absent readings and exit code 0.
        codes[str(result)] = codes.get(str(result), 0) + 1
        if result != "accepted" and (result not in (2, 3) or not said.startswith("gneiss: ")):
            wrong.append([str(result), said[:200], files])
    (folder / "wrong.json").write_text(json.dumps(wrong, indent=1))
    return codes, wrong


def targets():
    rows, (codes, wrong) = bad_rows(), mutated()
    told = ", ".join(f"{what} {number}" for what, number in sorted(codes.items()))
    text = f"""Files of targets with mistakes, each given to the command as it is. `/usr/bin/python3 validate/calibration_faults.py targets`.

{study.table(['mistake', 'exit code', 'message'], rows)}

Mutations: three good files of targets, a base scene and a measured curve, cut off, with other words in place of each word, with lines left out, doubled and
exchanged, and with random letters; {sum(codes.values())} files. Every file is read by the command; a stand-in for the program refuses all runs, so that
accepted files end there. Exit codes: {told}. Neither refused with a message nor accepted: {len(wrong)}.
"""
    return "Bad targets", text


SECTIONS = {"kills": kills, "targets": targets}


def main(arguments):
    study.reported(arguments, __doc__, FLAGS)
    names = calibration_page.named(arguments, SECTIONS)
    if study.KEPT:
        calibration_page.write()
        return
    for name in names:
        calibration_page.put(name, *SECTIONS[name]())


if __name__ == "__main__":
    main(sys.argv[1:])
