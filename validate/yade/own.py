"""Carries out one job (validate/yade/jobs.py) in gneiss, through the public C API."""
import ctypes
import time

import numpy as np

import study


class View(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("unit", ctypes.c_char_p), ("description", ctypes.c_char_p),
                ("type", ctypes.c_int), ("components", ctypes.c_int32), ("count", ctypes.c_size_t),
                ("item_stride", ctypes.c_size_t), ("component_stride", ctypes.c_size_t), ("data", ctypes.c_void_p)]


class Error(ctypes.Structure):
    _fields_ = [("status", ctypes.c_int), ("message", ctypes.c_char * 2048)]


class Limits(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("dt", "stable", "sharp", "bound", "literature")]


TYPES = {0: np.float64, 1: np.int64, 2: np.int32, 3: np.uint8, 4: np.float32}
PARTICLES, BONDS = 0, 1


def library():
    lib = ctypes.CDLL(str(study.LIBRARY))
    lib.gneiss_version.restype = lib.gneiss_build.restype = ctypes.c_char_p
    return lib


class World:
    """Creates a world from the text of a scene."""

    def __init__(self, text):
        self.lib, self.error = library(), Error()
        scene = ctypes.c_void_p()
        self.world = ctypes.c_void_p()
        self._call("gneiss_scene_parse", text.encode(), b"validate", None, None, ctypes.c_size_t(0), ctypes.byref(scene))
        try:
            self._call("gneiss_world_create", scene, None, ctypes.byref(self.world))
        finally:
            self.lib.gneiss_scene_free(scene)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.lib.gneiss_world_free(self.world)

    def _call(self, name, *arguments):
        if getattr(self.lib, name)(*arguments, ctypes.byref(self.error)) != 0:
            raise RuntimeError(f"{name}: {self.error.message.decode()}")

    def step(self, count):
        self._call("gneiss_world_step", self.world, ctypes.c_int64(count))

    def limits(self):
        found = Limits()
        self._call("gneiss_world_limits", self.world, ctypes.byref(found))
        return found

    def _array(self, view):
        if not view.count:
            return np.zeros((0, view.components), TYPES[view.type])
        size = (view.count - 1) * view.item_stride + (view.components - 1) * view.component_stride + 8
        raw = (ctypes.c_char * size).from_address(view.data)
        shape, strides = (view.count, view.components), (view.item_stride, view.component_stride)
        return np.ndarray(shape, TYPES[view.type], raw, 0, strides).copy()

    def field(self, record, name):
        view = View()
        self._call("gneiss_world_field", self.world, ctypes.c_int(record), name.encode(), ctypes.byref(view))
        return self._array(view)

    def history(self, name):
        view = View()
        self._call("gneiss_world_history", self.world, name.encode(), ctypes.byref(view))
        return self._array(view)[:, 0]

    def particles(self, *names):
        """Fields of the particles side by side, three components each, in the order of the specimen."""
        order = np.argsort(self.field(PARTICLES, "id")[:, 0])
        return np.hstack([self.field(PARTICLES, name)[order, :3] for name in names])


def scene(job):
    """Returns the job as text of a scene."""
    rows = np.loadtxt(job["spheres"], ndmin=2)
    choice = job.get("gneiss", {})
    lines = ["dimension: 3", "specimen:"]
    if len(rows) <= 64:
        lines += ["  particles:", *(f"    - [{', '.join(repr(v) for v in row)}]" for row in rows.tolist())]
    else:
        lines += [f"  file: {job['spheres']}"]
    lines += ["materials:", "  - name: rock", f"    density: {job['density']!r}",
              f"    contact_modulus: {job['contact_modulus']!r}", f"    kratio: {job['kratio']!r}",
              f"    friction: {job['friction']!r}", f"    tensile_strength: {job['tension']!r}",
              f"    shear_strength: {job['shear']!r}", f"    bond_friction: {job.get('bond_friction', 0.0)!r}", "law:", "  stiffness: harmonic",
              f"  contact_arm: {choice.get('contact_arm', 'midpoint')}", f"  coupling: {job.get('coupling', 'none')}", "bonds:",
              f"  enabled: {'on' if job.get('bonded', True) else 'off'}",
              f"  interaction_range: {job['interaction_range']!r}"]
    if job["damping"]:
        lines += ["damping:", "  background:", f"    model: {choice.get('damping', 'nonviscous_component')}",
                  f"    coefficient: {job['damping']!r}"]
        if choice.get("damping", "nonviscous_component") == "nonviscous_component":
            lines += [f"    velocity: {choice.get('velocity', 'instant')}"]
    if "gravity" in job:
        lines += [f"gravity: {job['gravity']}"]
    sets = [*job["sets"], *({"name": f"start{k}", **s} for k, s in enumerate(job.get("initial", [])))]
    lines += ["sets:"] if sets else []
    for s in sets:
        lines += [f"  - name: {s['name']}", f"    select: {{ids: {list(map(int, s['ids']))}}}"]
        if s["name"].startswith("start"):
            lines += [f"    initial_velocity: {list(s['v'])}", f"    initial_spin: {list(s['w'])}"]
            continue
        motion = [f"{c}: {v!r}" for c, v in zip(("vx", "vy", "vz", "wx", "wy", "wz"), s["v"] + s["w"]) if v is not None]
        lines += [f"    motion: {{{', '.join(motion)}}}"]
    if "pressure" in job:
        lines += [f"membrane: {{pressure: {job['pressure']['value']!r}, ramp: {job['pressure']['ramp']!r}, follow: false}}"]
    rows_wanted = max(job["steps"] // job["every"], 1)
    lines += ["time:", f"  step: {job['dt']!r}" if job["dt"] else "  step: auto",
              f"  end: {job['dt'] * job['steps']!r}" if job["dt"] else "  end: 1", "output:",
              f"  history_rows: {rows_wanted}", "  energy: off", "run:", f"  threads: {job.get('threads', 1)}"]
    return "\n".join(lines) + "\n"


def stable_step(job):
    """The step that gneiss would choose for the job: 0.9 of its sharp limit."""
    with World(scene({**job, "dt": 0, "steps": 1, "every": 1})) as world:
        return world.limits().dt


def skin(job):
    """Areas (m2, outward) by which the membrane of the job presses on its particles, [particles, 3]."""
    with World(scene({**job, "dt": 0, "steps": 1, "every": 1})) as world:
        return world.particles("skin")


def fallen(job, reaction, broken, peak):
    """Returns whether the load has fallen by the given part of its peak, and the peak."""
    names = [s["name"] for s in job["sets"]]
    a, b = (names.index(end) for end in job["ends"])
    load = 0.5 * np.abs(reaction[:, a, job["axis"]] - reaction[:, b, job["axis"]])
    peaks = np.maximum.accumulate(np.append(peak, load))[1:]
    return bool(np.any((broken > 0) & (load < (1 - job["peak_drop"]) * peaks))), peaks[-1]


def broken_pairs(world, job):
    """Particles of every broken bond, by their index in the specimen, [n, 2]."""
    if not job.get("bonded", True):
        return np.zeros((0, 2), int)
    place = world.field(PARTICLES, "id")[:, 0]
    pairs = np.column_stack([place[world.field(BONDS, end)[:, 0]] for end in "ij"])
    pairs = np.sort(pairs[world.field(BONDS, "cause")[:, 0] != 0], axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def run(job):
    """Leaves arrays as peer.py does."""
    snapshots, fields = [], ["pos", "vel", "spin"] if job.get("velocities") else ["pos"]
    apart = job.get("snapshot_every", 0)
    with World(scene(job)) as world:
        names = [s["name"] for s in job["sets"]]

        def histories():
            reaction = np.stack([np.stack([world.history(f"set_{n}_reaction_{c}") for c in "xyz"], axis=1)
                                 for n in names], axis=1) if names else np.zeros((len(world.history("step")), 0, 3))
            none = np.zeros(len(reaction))
            return (reaction, *(world.history(f"broken_{cause}") if job.get("bonded", True) else none
                                for cause in ("tension", "shear")))

        taken, seconds, peak, stop = 0, 0.0, 0.0, False
        if apart:
            snapshots.append((0, world.particles(*fields)))
        chunk = apart or max(job["steps"] // 50, job["every"])
        while taken < job["steps"] and not stop:
            count = min(chunk, job["steps"] - taken)
            began = time.perf_counter()
            world.step(count)
            seconds += time.perf_counter() - began
            taken += count
            if apart:
                snapshots.append((taken, world.particles(*fields)))
            if job.get("peak_drop"):
                reaction, tension, shear = histories()
                stop, peak = fallen(job, reaction, tension + shear, 0.0)
        reaction, tension, shear = histories()
        return {"step": world.history("step").astype(int), "reaction": reaction,
                "broken_tension": tension.astype(int), "broken_shear": shear.astype(int),
                "snapshot_step": np.array([n for n, _ in snapshots], dtype=int),
                "snapshot": np.array([v for _, v in snapshots]), "broken": broken_pairs(world, job), "bonds": len(world.field(BONDS, "i")) if
                job.get("bonded", True) else 0, "seconds": seconds, "steps_taken": taken,
                "version": world.lib.gneiss_version().decode(), "threads": job.get("threads", 1)}
