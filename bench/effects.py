"""Measures the cost of every effect where it is on, and that it is zero where it is off: docs/evidence/effects.md.

    ./do bench --effects [--each [EFFECT,...]]

Instructions are counted by callgrind, as the difference of two runs of the same scene with more and fewer steps: set-up drops
out, and a busy machine does not matter. Seconds are the least of several runs in turns, at a high priority where
the user may. --each builds every effect by itself, beside nothing else, and only makes that table.
"""
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "bench" / "out" / ("each" if "--each" in sys.argv else "effects")
PAGE = ROOT / "docs" / "evidence" / "effects.md"
SETS = "avx2"
TURNS, FEW, MANY = 7, 20, 60
STEP = 1e-6

EFFECTS = ("rotation", "shear", "friction", "bonds", "contact_damping", "viscous", "nonviscous_vector", "nonviscous_component",
           "gravity", "applied", "prescribed", "walls", "wall_shear", "periodic", "orientation", "energy", "mixed", "pressure",
           "elements", "facets", "mass_scaling")

# --- scenes ---

BASE = {"lattice": "{kind: fcc, radius: 1e-3, cells: [9, 9, 9], spacing: 0.999}", "stiffness": "kratio: 2", "rotation": "off",
        "rest": "", "time": f"step: {STEP}", "output": "energy: off", "run": "precision: double"}
SIDE = 5 * 0.999 * 2e-3 * 2**0.5
FLOOR = "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6%s}]\n"
BONDS = {"stiffness": "kratio: 2, bond_tension_limit: 1e9, bond_shear_limit: 1e9", "rest": "bonds: {interaction_range: 0.05}\n"}
FEM = ("elements: {box: {size: [40e-3, 40e-3, 40e-3], cells: [8, 8, 8], origin: [0.1, 0, 0]}, formulation: %s, "
       "materials: [{young: 1e8, poisson: 0.3, density: 2500}]}\n")
TURNING = {"rotation": "on", "stiffness": "kratio: 2, friction: 0.5"}


def background(model):
    return {"rest": f"damping: {{background: {{model: {model}, coefficient: 0.1}}}}\n"}


# Scenes of 500 grains, for a set-up of acceptable length under callgrind.
SMALL = "{kind: fcc, radius: 1e-3, cells: [5, 5, 5], spacing: 0.999}"
# Name: the row that it is compared with, the scene keys that it adds, the passes that it adds.
COSTS = {
    "rotation": ({}, {"rotation": "on"}, "rows of 8 instead of 4; a second half of each motion block"),
    "shear": ({**BONDS, "stiffness": "kratio: 0, bond_tension_limit: 1e9, bond_shear_limit: 1e9"}, {**BONDS, "stiffness": "kratio: 2, bond_tension_limit: 1e9, bond_shear_limit: 1e9"}, "none"),
    "friction": ({"rotation": "on"}, TURNING, "none; with it tangential springs (shear)"),
    "bonds": ({}, {**BONDS, "stiffness": "kratio: 0, bond_tension_limit: 1e9, bond_shear_limit: 1e9"}, "a second list of contacts; pairs only where they are not bonded"),
    "contact_damping": ({}, {"rest": "damping: {contact: {fraction: 0.1}}\n"}, "coefficients anew when the step changes"),
    "viscous": ({}, background("viscous"), "none"),
    "nonviscous_vector": ({}, background("nonviscous_vector"), "none"),
    "nonviscous_component": ({}, background("nonviscous_component"), "none"),
    "gravity": ({}, {"rest": "gravity: [0, 0, -9.81]\n"}, "none"),
    "applied": ({}, {"rest": "sets: [{name: s, select: {all: true}, force: [0, 0, 1e-3]}]\n"}, "none"),
    "prescribed": ({}, {"rest": "sets: [{name: s, select: {box: {min: [-1, -1, -1], max: [1, 1, 2e-3]}}, motion: {vx: 0, vy: 0, vz: 0}}]\n"},
                   "velocities of sets before each step, reactions after it"),
    "walls": ({}, {"rest": FLOOR % ""}, "a list, contacts with walls before the motion, forces on walls"),
    "wall_shear": ({"rest": FLOOR % ""}, {"rest": FLOOR % ", kratio: 2, friction: 0.3"}, "none"),
    "facets": ({"rest": FLOOR % ""}, {"rest": "bodies: [{name: b, box: {size: [1, 1, 0.1]}, origin: [-0.5, -0.5, -0.1], stiffness: 1e6}]\n"},
               "a tree over facets when lists are made, contacts with facets, forces on bodies"),
    "periodic": ({}, {"rest": "periodic: {min: [0, 0, 0], max: [%.15g, %.15g, %.15g]}\n" % (SIDE, SIDE, SIDE)}, "none; particles wrapped with the lists"),
    "orientation": (TURNING, {**TURNING, "output": "energy: off, orientation: on"}, "none"),
    "energy": ({}, {"output": "energy: on"}, "ledger booked after each step"),
    "mixed": ({}, {"run": "precision: mixed"}, "none; single copies with the lists"),
    "elements": ({}, {"rest": FEM % "displacement"}, "elements and motion of their nodes, after the particles"),
    "pressure": ({"rest": FEM % "displacement"}, {"rest": FEM % "mixed"}, "dilations, pressures and their projection, three sweeps"),
    "mass_scaling": ({"rest": "gravity: [0, 0, -9.81]\n", "time": "step: auto"},
                     {"rest": "gravity: [0, 0, -9.81]\n", "time": "mass_scaling: {factor: 1, gravity: own_mass}"}, "none; masses once, at the start"),
}


def text(changes, steps, step=STEP):
    s = {**BASE, **changes}
    return (f"dimension: 3\nspecimen: {{lattice: {s['lattice']}}}\n"
            f"materials: [{{name: m, density: 2500, normal_stiffness: 1e6, {s['stiffness']}}}]\n"
            f"law: {{stiffness: uniform, rotation: {s['rotation']}}}\ninitial: {{random_velocity: 1e-3}}\n{s['rest']}"
            f"time: {{end: {steps * step:.17g}, {s['time']}}}\n"
            f"output: {{snapshots: 0, checkpoint: off, history_rows: 1, {s['output']}}}\nrun: {{threads: 1, {s['run']}}}\n")


# Effects that the scene of a row requires; the other build omits all others.
FREE = (("grains that only push", BASE, ()),
        ("grains with friction that fall on a floor", {**TURNING, "rest": "gravity: [0, 0, -9.81]\n" + FLOOR % ", kratio: 2, friction: 0.3",
                                                     "output": "energy: on"},
         ("rotation", "shear", "friction", "gravity", "walls", "wall_shear", "energy")),
        ("bonded specimen", {**BONDS, "rotation": "on", "rest": BONDS["rest"] + background("nonviscous_vector")["rest"] + FLOOR % "", "output": "energy: on"},
         ("rotation", "shear", "bonds", "nonviscous_vector", "walls", "energy")))

# --- runs ---


def call(command, **options):
    done = subprocess.run([str(c) for c in command], text=True, capture_output=True, **options)
    if done.returncode:
        sys.exit(f"bench: {' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr}")
    return done


def scene_file(name, changes, steps):
    path = OUT / f"{name}-{steps}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text(changes, steps))
    return path


ENVIRONMENT = {**os.environ, "GNEISS_ISA": SETS, "OMP_WAIT_POLICY": "passive"}


def run(program, scene, before=()):
    folder = OUT / "run"
    shutil.rmtree(folder, ignore_errors=True)
    call([*before, program, "run", scene, "--out", folder, "--quiet"], env=ENVIRONMENT)
    return json.loads((folder / "summary.json").read_text())


COUNTED = {}


def instructions(program, name, changes):
    """Counts per step."""
    key = (program, text(changes, MANY))
    if key not in COUNTED:
        COUNTED[key] = count(program, name, changes)
    return COUNTED[key]


def count(program, name, changes):
    counts = []
    for steps in (FEW, MANY):
        file = OUT / "callgrind"
        said = run(program, scene_file(name, changes, steps), ("valgrind", "--tool=callgrind", f"--callgrind-out-file={file}"))
        counts.append((int(re.search(r"^(?:summary|totals): (\d+)", file.read_text(), re.M).group(1)), said["steps"]))
    return (counts[1][0] - counts[0][0]) / (counts[1][1] - counts[0][1])


PRIORITY = ("nice", "-n", "-10") if os.geteuid() == 0 else ()


def seconds(cases, steps=3000, turns=TURNS):
    """Counts per step of each (program, name, changes): the smallest of alternating runs."""
    least = [float("inf")] * len(cases)
    for _ in range(turns):
        for k, (program, name, changes) in enumerate(cases):
            said = run(program, scene_file(name, changes, steps), PRIORITY)
            spent = said["seconds"]
            work = spent["total"] - spent["setup"] - spent["output"] - spent["measure"]
            least[k] = min(least[k], work / said["steps"])
    return least


def planned(program, name, changes):
    """Returns number and bytes of the records."""
    out = call([program, "plan", scene_file(name, changes, FEW)], env=ENVIRONMENT).stdout
    return {kind: (int(count), int(size)) for kind, count, size in
            re.findall(r"^  (particles|bonds|pairs|wall contacts|nodes|elements) +(\d+) x +(\d+) bytes", out, re.M)}


# --- builds ---


def build(name, without=()):
    folder = ROOT / f"build-effects-{name}"
    options = ["--buildtype=release", f"-Dsets={SETS}", f"-Dwithout={','.join(without)}"]
    wipe = ["--wipe"] if (folder / "build.ninja").exists() else []
    stamp = folder / ".options"
    if not (folder / "build.ninja").exists() or not stamp.exists() or stamp.read_text() != " ".join(options):
        call(["meson", "setup", *wipe, folder, ROOT, *options])
        stamp.write_text(" ".join(options))
    call(["ninja", "--quiet", "-C", folder, "gneiss"])
    return folder / "gneiss"


def kernel_sizes(folder):
    """Bytes of code by the name of a kernel's function, of one instruction set."""
    sizes = {}
    for library in (folder / "src" / "kernels").glob(f"libgneiss_kernels_{SETS}*.a"):
        for size, name in re.findall(r"^[0-9a-f]+ ([0-9a-f]+) [tT] (\w+)", call(["nm", "-S", library]).stdout, re.M):
            key = (library.name, name)
            sizes[key] = sizes.get(key, 0) + int(size, 16)
    return sizes


def code_size(program):
    return int(call(["size", program]).stdout.splitlines()[1].split()[0])


# Bit of an effect in the numbers of contact and motion kernels; kinds of lists.
CONTACT_BITS = {"rotation": 1, "contact_damping": 2, "energy": 3, "periodic": 4}
MOTION_BITS = {"rotation": 1, "viscous": 2, "nonviscous_vector": 3, "nonviscous_component": 4, "gravity": 5, "energy": 6}
KINDS = {"friction": ("smooth", "frictional"), "shear": ("bond_normal", "bond"), "bonds": ("smooth", "bond_normal")}


def grown(effect, sizes):
    """Mean bytes by which a contact kernel and a motion kernel grow."""
    found = {"contact": [], "motion": []}
    for (library, name), size in sizes.items():
        other = None
        match = re.fullmatch(r"(contact_\w+?|motion)_(0x[0-9a-f]+)", name)
        if not match:
            continue
        stem, number = match[1], int(match[2], 16)
        bits = MOTION_BITS if stem == "motion" else CONTACT_BITS
        if effect in bits and number >> bits[effect] & 1:
            other = f"{stem}_0x{number & ~(1 << bits[effect]):02x}"
        elif effect in KINDS and stem == "contact_" + KINDS[effect][1]:
            other = f"contact_{KINDS[effect][0]}_{match[2]}"
        base = sizes.get((library, other))
        if base and size > 200 and base > 200: # variants that make no sense are empty
            found[stem.split("_")[0]].append(size - base)
    return [f"{sum(v) / len(v):+.0f}" if v else "" for v in found.values()]


# --- tables ---


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + " --- |" * len(head),
                      *("| " + " | ".join(map(str, row)) + " |" for row in rows)])


def added(one, two, kind):
    (_, before), (_, after) = one.get(kind, (0, 0)), two.get(kind, (0, 0))
    return after - before if before and after else after


def cost_row(program, effect, sizes):
    base, more, passes = COSTS[effect]
    base, more = {"lattice": SMALL, **base}, {"lattice": SMALL, **more}
    one, two = planned(program, effect + "-off", base), planned(program, effect + "-on", more)
    contacts, items = ("bonds" if "bonds" in two else "pairs"), "particles"
    count = max(two[contacts][0], 1)
    off, on = (instructions(program, effect + tag, c) for tag, c in (("-off", base), ("-on", more)))
    before, after = seconds([(program, effect + "-off", base), (program, effect + "-on", more)], 1500, 3)
    extra = {kind: two[kind] for kind in ("wall contacts", "nodes", "elements") if kind in two}
    beside = ", ".join(f"{n} {kind} of {size}" for kind, (n, size) in extra.items())
    old = "pairs" if effect == "bonds" else contacts
    change = two[contacts][1] - one[old][1] if old in one else two[contacts][1]
    print(f"bench: {effect}: {on - off:.0f} instructions a step", file=sys.stderr, flush=True)
    return [effect, f"{added(one, two, items):+d}", f"{change:+d}", beside, f"{(on - off) / two[items][0]:+.1f}", f"{(on - off) / count:+.2f}",
            f"{100 * (on / off - 1):+.1f}", f"{1e9 * (after - before) / two[items][0]:+.2f}", f"{1e9 * (after - before) / count:+.3f}",
            f"{100 * (after / before - 1):+.0f}", *grown(effect, sizes), passes]


def cost_table(program):
    sizes = kernel_sizes(program.parent)
    head = ["effect", "bytes per particle", "per contact", "beside them (bytes each)", "instructions per particle and step", "per contact and step",
            "of a step %", "ns per particle and step", "per contact and step", "of a step %", "code of a contact kernel, bytes", "of a motion kernel",
            "passes"]
    return table(head, [cost_row(program, effect, sizes) for effect in COSTS])


def refuses(program, effect):
    scene = scene_file("refused", COSTS[effect][1], FEW)
    done = subprocess.run([str(program), "plan", str(scene)], text=True, capture_output=True, env=ENVIRONMENT)
    return done.returncode == 2 and effect in done.stderr and "which this build leaves out" in done.stderr


def free_row(full, lean, name, label, changes, without):
    hashes = {run(p, scene_file(name, changes, MANY))["state_hash"] for p in (full, lean)}
    counts = [instructions(p, name, changes) for p in (full, lean)]
    times = seconds([(full, name, changes), (lean, name, changes)])
    refused = all(refuses(lean, effect) for effect in without if effect in COSTS)
    print(f"bench: {label}: {counts[0] / counts[1]:.4f}", file=sys.stderr, flush=True)
    return [label, ", ".join(without), "the same" if len(hashes) == 1 else "OTHERS", f"{counts[0]:.0f}", f"{counts[1]:.0f}", f"{counts[0] / counts[1]:.4f}",
            f"{times[0] / times[1]:.3f}", f"{code_size(full) / 1e6:.2f}", f"{code_size(lean) / 1e6:.2f}", "all" if refused else "NOT ALL"]


def free_table(full):
    rows = []
    for k, (label, changes, uses) in enumerate(FREE):
        without = [e for e in EFFECTS if e not in uses]
        rows.append(free_row(full, build(f"free{k}", without), f"free{k}", label, changes, without))
    head = ["scene", "left out of the other build", "state", "instructions a step", "left out", "ratio", "seconds, ratio", "code MB", "left out",
            "scenes that call for them are refused"]
    return table(head, rows)


def each_table():
    """Measures one effect at a time: a build with that effect only, run on a scene without it, is compared with the
    build without effects."""
    rows, changes = [], {"lattice": SMALL}
    bare = build("free0", EFFECTS)
    only = sys.argv[sys.argv.index("--each") + 1:]
    for effect in only[0].split(",") if only else EFFECTS:
        other = build("only", [e for e in EFFECTS if e != effect])
        COUNTED.pop((other, text(changes, MANY)), None)
        hashes = {run(p, scene_file("each", changes, MANY))["state_hash"] for p in (bare, other)}
        counts = [instructions(p, "each", changes) for p in (other, bare)]
        print(f"bench: {effect} off: {counts[0] / counts[1]:.4f}", file=sys.stderr, flush=True)
        rows.append([effect, "the same" if len(hashes) == 1 else "OTHERS", f"{counts[0]:.0f}", f"{counts[1]:.0f}", f"{counts[0] / counts[1]:.4f}",
                     code_size(other) - code_size(bare)])
        put("table each", table(["effect", "state", "instructions a step, off", "left out", "ratio", "code, bytes"], rows))


def put(name, new):
    page = PAGE.read_text()
    PAGE.write_text(re.sub(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", lambda m: m[1] + new + "\n" + m[2], page, flags=re.S))


def main():
    os.environ.setdefault("CC", "ccache cc" if shutil.which("ccache") else "cc")
    if "--each" in sys.argv:
        each_table()
        return
    full = build("full")
    if "--costs-only" not in sys.argv:
        put("table free", free_table(full))
    if "--free-only" not in sys.argv:
        put("table costs", cost_table(full))


if __name__ == "__main__":
    main()
