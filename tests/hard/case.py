"""One hard case: a scene, the expected result, and the part of the engine that ensures it. Also runs a case."""
import copy
import dataclasses
import math
from collections.abc import Callable

from program import *  # noqa: F403

# Common keys of the hard scenes. The step and everything else that affects a result keep their defaults.
QUIET = {"output": {"snapshots": 0, "history_rows": 100, "checkpoint": "off"}, "run": {"threads": 1}}
DENSITY = 2500.0
# Relative rounding of a double, and its growth in a few thousand steps.
EPS = 2.0**-52


@dataclasses.dataclass(frozen=True)
class Case:
    """A row of the table."""
    name: str        # name of the case and of its test
    hard: str        # the difficulty
    should: str      # the expected result
    scene: Callable  # folder -> scene; may write files into the folder
    check: Callable  # Seen -> figures, in words; asserts
    guard: str       # the part of the engine that it tests
    without: str     # the result without that part; or the reason why no part can be removed
    others: str = ""  # the result of other codes, where it is known
    ends: int = 0     # exit code of a run
    more: str = ""    # tests that run variants of it
    long: float = 0.0  # Length of its long form relative to that of its short form; 0: no long form.
    long_check: Callable | None = None  # check of the long form; None: the same


def sphere_mass(radius, density=DENSITY):
    return 4 / 3 * math.pi * radius**3 * density


def material(**changes):
    friction = 0.3 if changes.get("kratio", 2) else 0  # without a tangential spring no friction is possible
    return {"name": "ball", "density": DENSITY, "normal_stiffness": 1e6, "kratio": 2, "friction": friction, **changes}


STRONG = {"bond_tension_limit": 1e30, "bond_shear_limit": 1e30}


def spheres(particles, end, ball=None, **changes):
    """Particles [x, y, z, r], in 2D [x, y, r]; `ball`: changes of their material."""
    specimen = particles if isinstance(particles, dict) else {"particles": particles}
    scene = {"dimension": 3, "specimen": specimen, "materials": [material(**(ball or {}))],
             "law": {"stiffness": "uniform"}, "time": {"end": end}, **copy.deepcopy(QUIET)}
    if isinstance(particles, list) and particles and len(particles[0]) == 3:
        scene["dimension"] = 2
    scene.update(changes)
    return scene


def add_material(scene, **changes):
    """A material other than that of the specimen."""
    scene["specimen"]["material"] = "ball"
    scene["materials"].append(material(**changes))


def lattice(kind, cells, **changes):
    return {"lattice": {"radius": 1e-3, **changes, "kind": kind, "cells": cells}}


def launched(name, ids, velocity=None, spin=None):
    """A set with a velocity or a spin at the start."""
    one = {"name": name, "select": {"all": True} if ids is None else {"ids": ids}}
    if velocity is not None:
        one["initial_velocity"] = velocity
    if spin is not None:
        one["initial_spin"] = spin
    return one


def wall(name, point, normal, stiffness=1e6, **changes):
    return {"name": name, "point": point, "normal": normal, "stiffness": stiffness, **changes}


def stl(folder, name, triangles):
    """A surface as text; the reader computes the normals."""
    lines = ["solid s"]
    for corners in triangles:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(repr(float(x)) for x in point) for point in corners]
        lines += ["endloop", "endfacet"]
    with open(os.path.join(folder, name), "w") as file:
        file.write("\n".join(lines + ["endsolid s"]) + "\n")
    return name


class Seen:
    """The outcome of a run: exit code, message, summary, history, fields."""

    def __init__(self, folder, out, done):
        self.folder, self.out, self.code, self.message = folder, out, done.returncode, " ".join(done.stderr.split())

    @property
    def summary(self):
        return summary(self.out)

    @property
    def residual(self):
        return abs(self.summary["energy_residual"])

    @property
    def history(self):
        return history(self.out)

    def field(self, name):
        with results(self.out) as file:
            return file[name][()]

    def again(self, scene, name, *arguments):
        """Runs another scene, to compare it with this one."""
        return start(self.folder, scene, name, *arguments)

    def state(self):
        """State that must not depend on threads, instruction sets or interruptions."""
        if self.code == 0:
            return self.summary["state_hash"]
        return re.sub(re.escape(self.out), "", self.message)


def start(folder, scene, name, *arguments, **options):
    out = os.path.join(folder, name)
    done = gneiss("run", write_scene(folder, scene, name + ".yaml"), "--out", out, "--quiet", *arguments, **options)
    return Seen(folder, out, done)


def watch(case, folder):
    """Runs a case once and compares it with the expected result; returns the figures."""
    one = start(folder, case.scene(folder), "one")
    assert one.code == case.ends, f"exit code {one.code}, expected {case.ends}: {one.message[:600]}"
    return one, case.check(one)


def present_sets():
    return [name for name, there in isas().items() if there]


def half_way(one, scene):
    """Returns the index of the row in the middle of a run, whether it reached its end or stopped at a time stated in
    its message; 0: there is none. (A run up to that row has rows at the same spacing as the whole run.)"""
    found = re.search(r"step \d+, t = (\S+) s", one.message)
    last = one.summary["time"] if one.code == 0 else float(found.group(1)) if found else 0.0
    return int(0.5 * last / scene["time"]["end"] * scene["output"]["history_rows"])


def taken_up(one, scene, row, sets):
    """Runs the case again up to a row, and continues it with another number of threads and another instruction set."""
    end, rows = scene["time"]["end"], scene["output"]["history_rows"]
    part = start(one.folder, scene, "part", "--threads", 2, "--set", f"run.isa={sets[len(sets) // 2]}", "--set",
                 f"time.end={row * end / rows!r}", "--set", f"output.history_rows={row}")
    assert part.code == 0, part.message
    done = gneiss("resume", part.out, "--quiet", "--threads", 3, "--set", f"run.isa={sets[-1]}", "--set", f"time.end={end}")
    return Seen(one.folder, part.out, done)


def same_everywhere(case, one, sets):
    """Checks that other threads and sets, and a run resumed half way, give the same state, or the same message of a run
    that stopped. A scene that is refused has to be refused by `gneiss check` as well."""
    scene, wanted = case.scene(one.folder), one.state()
    if one.code == 2:
        checked = gneiss("check", os.path.join(one.folder, "one.yaml"))
        assert checked.returncode == 2 and " ".join(checked.stderr.split()) == one.message, checked.stderr
        return
    other = start(one.folder, scene, "other", "--threads", 3, "--set", f"run.isa={sets[0]}")
    assert other.state() == wanted, f"3 threads, {sets[0]}: {other.state()}, expected {wanted}"
    row = half_way(one, scene)
    rest = taken_up(one, scene, row, sets) if row > 0 else one
    assert rest.state() == wanted, f"taken up at row {row}: {rest.state()}, expected {wanted}"


# --- checks that many cases share ------------------------------------------------------------------------------

def keeps_ledger(limit):
    """The energy ledger of a run closes."""
    def check(one):
        assert one.residual < limit, f"residual {one.residual:.2g}, expected below {limit}"
        return f"residual {one.residual:.1e}, {one.summary['steps']} steps"
    return check


def kinetic(one):
    rows = one.history
    return rows["energy_kinetic"] + rows["energy_rotational"]


def total(one):
    """Kinetic and elastic energy, at every row."""
    rows = one.history
    return kinetic(one) + rows["energy_elastic_normal"] + rows["energy_elastic_shear"]


def swing(values):
    """The largest deviation from the first value, relative to it."""
    return float(np.abs(values / values[0] - 1).max())


def keeps_energy(limit):
    """The sum of kinetic and elastic energy keeps its initial value."""
    def check(one):
        off = swing(total(one))
        assert off < limit, f"energy changes by {off:.2g} of itself, expected below {limit}"
        return f"energy within {off:.1e} of its start, {one.summary['steps']} steps"
    return check


def says(*patterns):
    """Checks that the run ends with a message that has these words and no "nan"."""
    def check(one):
        for pattern in patterns:
            assert re.search(pattern, one.message), f"expected /{pattern}/ in: {one.message[:600]}"
        assert not re.search(r"\bnan\b", one.message), one.message
        return "exit code " + str(one.code) + ": " + shortened(re.search(patterns[0], one.message).group(0))
    return check


def refuses(*patterns):
    """Nothing is written."""
    def check(one):
        assert not os.path.exists(one.out), f"written all the same: {os.listdir(one.out)}"
        return says(*patterns)(one)
    return check


def shortened(words):
    return words if len(words) <= 90 else words[:87] + "..."


def close(found, expected, relative, what):
    assert abs(found - expected) <= relative * abs(expected), f"{what}: {found:.9g}, expected {expected:.9g}"
    return f"{found:.6g} {what} ({expected:.6g})"
