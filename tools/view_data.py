"""Data of the page that `view.py` writes: a run's snapshots, quantised and packed (docs/view.md)."""
import contextlib
import os
import re
import zlib

import h5py
import numpy as np

from report_files import DAMAGE, Unreadable, check_access, values
from report_results import Results, scale_for
from report_shapes import FACES, folds, panes, walls_of

FILE = re.compile(r"(particles|bonds|bodies|elements(?:_\d+)?)_(\d{10})\.hdf")
STEPS = 65535            # of a position, over the size of the box of all positions
LEVELS = 255             # of a value that is shown as a colour
SHARE = 1, 99            # percentiles between which colours span
SAMPLE = 20000           # values of an instant from which they are taken
FAR = 1.5                # particles are shown up to this many sizes of the bulk away from it
FORCES = 2_000_000       # most values of forces of bonds that are written unasked
ROWS = 2000              # most rows of the history
AXES = "xyz"
HIDDEN = ("id", "radius", "removed", "asleep", "orientation")  # fields that are not shown as colours
WHOLE = ("material", "group", "fragment")                      # colours without an order
TEXTS = {"velocity": "speed", "pressure": "pressure, compression +", "tension": "largest principal stress, tension +"}


# --- snapshots --------------------------------------------------------------------------------------------

class Vanished(Exception):
    """A snapshot that was listed is gone: a run thins its snapshots while it goes on."""


@contextlib.contextmanager
def snapshot(path):
    """Opens a snapshot; every error on the way becomes Vanished, FileFault or Unreadable."""
    try:
        with h5py.File(path, "r") as file:
            yield file
    except DAMAGE as e:
        if not os.path.exists(path):
            raise Vanished(f"{path}: the run removed this snapshot while it was read; try again") from None
        check_access(path, e)
        raise Unreadable(f"{path}: damaged or not a snapshot: {' '.join(str(e).split())}") from None


class Grid:
    """One snapshot: points [n][3], connectivity, time, step, and the arrays of points and cells by their names."""

    def __init__(self, path):
        with snapshot(path) as file:
            self.points = values(file, "VTKHDF/Points").astype(float).reshape(-1, 3)
            self.time = float(values(file, "VTKHDF/FieldData/TimeValue")[0])
            self.links = values(file, "VTKHDF/Connectivity").astype(np.int64)
            self.point, self.cell, self.unit = {}, {}, {}
            for group, found in (("PointData", self.point), ("CellData", self.cell)):
                for name in file["VTKHDF"][group]:
                    found[name] = values(file, f"VTKHDF/{group}/{name}").astype(float)
                    unit = file["VTKHDF"][group][name].attrs.get("unit", "1")
                    self.unit[name] = unit.decode() if isinstance(unit, bytes) else str(unit)
        lengths = [len(v) == len(self.points) for v in self.point.values()]
        if not all(lengths) or (len(self.links) and not 0 <= self.links.min() <= self.links.max() < len(self.points)):
            raise Unreadable(f"{path}: expected an array entry for every point and cells of these points, found others")


def files_of(folder):
    """{part: {step: path}} of the snapshots of a folder."""
    found = {}
    for name in sorted(os.listdir(folder)):
        match = FILE.fullmatch(name)
        if match:
            found.setdefault(match[1], {})[int(match[2])] = os.path.join(folder, name)
    return found


def chosen(files, count):
    """At most `count` of the steps, evenly, with the first and the last."""
    steps = sorted({step for part, of in files.items() if part != "bonds" for step in of})
    if len(steps) <= count:
        return steps
    return [steps[k] for k in np.unique(np.linspace(0, len(steps) - 1, count).round().astype(int))]


def at_step(of, step):
    """The file of a part at a step; what does not move is written once, so that an earlier one holds."""
    earlier = [s for s in of if s <= step]
    return of[max(earlier)] if earlier else of[min(of)]


class NoResults(Results):
    """Stands for results.h5 before the first checkpoint: bonds of the last snapshot; no history, scene or walls."""

    def __init__(self, folder, files):
        last = [Grid(of[max(of)]) for part, of in files.items() if part != "bonds"]
        flat = all((grid.points[:, 2] == 0).all() for grid in last)
        with h5py.File("results", "w", driver="core", backing_store=False) as file:
            file.attrs.update(title=os.path.basename(os.path.abspath(folder)), dimension=2 if flat else 3)
            both = set(files.get("particles", ())) & set(files.get("bonds", ()))
            if both:
                particles, bonds = (Grid(files[part][max(both)]) for part in ("particles", "bonds"))
                for name in ("id", "radius"):
                    file[f"particles/{name}"] = particles.point[name]
                for name in ("state", "broken_time"):
                    file[f"bonds/{name}"] = bonds.cell[name]
                file["bonds/i"], file["bonds/j"] = bonds.links.reshape(-1, 2).T
            self._read(file)


def results_of(folder):
    """Results of a folder; NoResults where there are snapshots and the run has not written results.h5 yet."""
    path = os.path.join(folder, "results.h5")
    files = {} if os.path.exists(path) or not os.path.isdir(folder) else files_of(folder)
    check_access(path)
    return NoResults(folder, files) if set(files) - {"bonds"} else Results(path)


# --- packing ----------------------------------------------------------------------------------------------

def zigzag(difference, kind):
    """Whole numbers around zero as small ones without sign."""
    signed = difference.astype({1: np.int8, 2: np.int16, 4: np.int32}[kind.itemsize])
    return ((signed << 1) ^ (signed >> (8 * kind.itemsize - 1))).astype(kind)


class Pack:
    """Arrays [instants][rows][components] of unsigned numbers in one compressed text. Values are stored as differences
    along `delta` ("time", "row" or ""), and bytes by component and place, because neighbours are then alike."""

    def __init__(self):
        self.index, self.parts, self.size = {}, [], 0

    def add(self, name, array, delta=""):
        array = np.ascontiguousarray(array)
        array = array.reshape(array.shape + (1,) * (3 - array.ndim))
        coded, kind = array.copy(), array.dtype
        if delta:
            axis = 0 if delta == "time" else 1
            after = (slice(1, None),) if axis == 0 else (slice(None), slice(1, None))
            coded[after] = zigzag(np.diff(array.astype(np.int64), axis=axis), kind)
        planes = coded.transpose(0, 2, 1)[..., None].copy().view(np.uint8).reshape(*coded.shape[:1], array.shape[2], -1, kind.itemsize)
        data = planes.transpose(0, 1, 3, 2).tobytes()
        self.index[name] = {"shape": list(array.shape), "width": kind.itemsize, "delta": delta, "at": self.size}
        self.parts.append(data)
        self.size += len(data)

    def compressed(self):
        return zlib.compress(b"".join(self.parts), 6)


def quantised(points, low, size):
    """Positions as whole numbers up to STEPS."""
    return np.clip(np.rint((points - low) / np.where(size > 0, size, 1) * STEPS), 0, STEPS).astype(np.uint16)


# --- fields -----------------------------------------------------------------------------------------------

def colours_of(grid, dimension):
    """{name: (unit, values)} of the points of a grid: sizes of vectors, stresses by their invariants."""
    found = {}
    for name, value in grid.point.items():
        if name in HIDDEN:
            continue
        unit = grid.unit[name]
        if name == "stress" and value.ndim == 2 and value.shape[1] == 6:
            found["pressure"] = (unit, -value[:, :dimension].mean(axis=1))
            found["tension"] = (unit, largest_principal(value, dimension))
            found.update({f"stress_{2 * AXES[a]}": (unit, value[:, a]) for a in range(dimension)})
        elif value.ndim == 1 and name not in found:
            found[name] = (unit, value)
        elif value.ndim == 2:
            found[name] = (unit, np.linalg.norm(value, axis=1))
            if name == "displacement":
                found.update({f"{name}_{AXES[a]}": (unit, value[:, a]) for a in range(dimension)})
    return found


def largest_principal(stress, dimension):
    """The largest eigenvalue of tensors xx yy zz xy yz xz; in 2D of the plane."""
    xx, yy, zz, xy, yz, xz = stress.T
    if dimension == 2:
        return 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
    return np.linalg.eigvalsh(np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3))[:, 2]


def wanted_fields(there, bonded, asked):
    """Names of the fields to write: those asked for, "all", or the ones that tell most."""
    if asked and asked != ["all"]:
        missing = [name for name in asked if name not in there and name != "force"]
        if missing:
            raise Unreadable(f"--fields: expected names among {', '.join(there)}, force or all, found '{missing[0]}'")
        return [name for name in asked if name in there]
    if asked:
        return list(there)
    usual = ["damage", "displacement", "velocity", "pressure", "tension", "von_mises"] if bonded else \
        ["velocity", "displacement", "pressure", "coordination"]
    return [name for name in (*usual, *WHOLE, "fragment_size") if name in there]


class Field:
    """Values of one colour on several parts, gathered by instants, then quantised over a common range."""

    def __init__(self, name, unit):
        self.name, self.unit = name, unit
        self.seen, self.values = [], {}

    def add(self, part, value, shown):
        """`value` [n]; rows that are not `shown` do not count for the range of colours."""
        self.values.setdefault(part, []).append(value.astype(np.float32))
        count = value[shown]
        self.seen.append(count[:: max(1, len(count) // SAMPLE)])

    def limits(self):
        seen = np.concatenate(self.seen) if self.seen else np.zeros(1)
        seen = seen[np.isfinite(seen)]
        if not seen.size:
            return 0.0, 1.0
        if self.name in ("damage", *WHOLE):
            return 0.0, 1.0 if self.name == "damage" else float(LEVELS)
        low, high = (float(v) for v in np.percentile(seen, SHARE))
        if low < 0 < high and min(-low, high) > 0.1 * max(-low, high):
            low, high = -max(-low, high), max(-low, high)  # both signs: colours around zero
        elif -0.01 * high <= low < 0.5 * high:
            low = 0.0
        elif 0.5 * low < high <= -0.01 * low:
            high = 0.0
        return (low, high) if high > low else (low - 0.5 * (abs(low) or 1), low + 0.5 * (abs(low) or 1))

    def write(self, pack):
        """Adds the arrays; returns what the page has to know of the field."""
        low, high = self.limits()
        factor, unit = scale_for(max(abs(low), abs(high)), self.unit)
        for part, instants in self.values.items():
            levels = [np.clip(np.rint((np.nan_to_num(v) - low) / (high - low) * LEVELS), 0, LEVELS).astype(np.uint8) for v in instants]
            pack.add(f"{part}/{self.name}", np.stack(levels), "" if self.name in WHOLE else "time")
        kind = "whole" if self.name in WHOLE else "signed" if low == -high else "damage" if self.name == "damage" else "plain"
        return {"name": self.name, "label": TEXTS.get(self.name, self.name.replace("_", " ")), "unit": unit, "factor": factor, "low": low,
                "high": high, "kind": kind, "parts": list(self.values)}


# --- the run ----------------------------------------------------------------------------------------------

class View:
    """A run as the page shows it: `meta` becomes JSON, `pack` its arrays."""

    def __init__(self, results, folder, instants, asked=()):
        self.results, self.pack, self.fields, self.asked = results, Pack(), {}, list(asked)
        self.files = files_of(folder)
        self.steps = chosen(self.files, instants)
        if not self.steps:
            raise Unreadable(f"{folder}: expected snapshots, found none (output.snapshots sets their number)")
        self.dimension = results.dimension
        self.bonded = len(results.bond_state) > 0
        self.boxes = []
        self.meta = {"dimension": self.dimension, "title": results.attribute("title") or "gneiss run", "steps": self.steps}
        self._particles()
        self.meta["surfaces"] = [*self._elements(), *self._bodies(), *self._walls()]
        self._write_fields()
        self._bonds()
        self._history()
        self.meta.update(self._eyes(), arrays=self.pack.index, bytes=self.pack.size)

    def _take(self, part, grid, shown, rows=None, count=None):
        """Adds the fields of a grid; `rows` are the places of its points among `count`."""
        for name, (unit, value) in colours_of(grid, self.dimension).items():
            if rows is not None:
                value, given = np.zeros(count), value
                value[rows] = given
            self.fields.setdefault(name, Field(name, unit)).add(part, value, shown)

    # Particles are identified by `id`: with sources and sinks their number differs between snapshots.
    def _particles(self):
        of = self.files.get("particles", {})
        grids = [Grid(at_step(of, step)) for step in self.steps] if of else []
        self.times = [grid.time for grid in grids]
        self.ids = np.unique(np.concatenate([grid.point["id"] for grid in grids])) if grids else np.zeros(0)
        count = len(self.ids)
        self.meta["particles"] = {"count": count}
        if not count:
            return
        place, radius = np.zeros((len(grids), count, 3)), np.zeros((len(grids), count))
        for t, grid in enumerate(grids):
            rows = np.searchsorted(self.ids, grid.point["id"])
            gone = grid.point.get("removed", np.zeros(len(rows))) + grid.point.get("asleep", 0) > 0
            good = np.isfinite(grid.points).all(axis=1) & (grid.point["radius"] > 0) & ~gone
            place[t, rows[good]], radius[t, rows[good]] = grid.points[good], grid.point["radius"][good]
        low, high = self._bulk(place, radius)
        outside = ((place < low) | (place > high)).any(axis=2) & (radius > 0)
        radius[outside] = 0
        largest = float(radius.max())
        coded = np.zeros((*radius.shape, 4), np.uint16)
        coded[..., :3] = np.where(radius[..., None] > 0, quantised(place, low, high - low), 0)
        coded[..., 3] = np.where(radius > 0, np.maximum(1, np.rint(radius / (largest or 1) * STEPS)), 0)
        for t in range(1, len(coded)):  # hidden particles stay where they were: small differences
            hidden = coded[t, :, 3] == 0
            coded[t, hidden, :3] = coded[t - 1, hidden, :3]
        self.pack.add("particles", coded, "time")
        for t, grid in enumerate(grids):
            whole = np.ones(count, bool)
            whole[np.searchsorted(self.ids, grid.point["id"])] = grid.point.get("damage", np.zeros(len(grid.points))) < 1
            self._take("particles", grid, (radius[t] > 0) & whole, np.searchsorted(self.ids, grid.point["id"]), count)
        self.meta["particles"].update(low=low.tolist(), size=(high - low).tolist(), radius=largest, outside=int(outside[-1].sum()))
        start = radius[0] > 0 if self.bonded else radius > 0
        framed = place[0][start] if self.bonded else place[start]
        self.boxes.append((framed.min(axis=0) - largest, framed.max(axis=0) + largest) if len(framed) else (low, high))

    def _bulk(self, place, radius):
        """Limits of the positions that are shown: fragments far away would take the resolution of the rest."""
        seen = place[radius > 0]
        if not len(seen):
            return np.zeros(3), np.ones(3)
        inner = np.percentile(seen[:: max(1, len(seen) // 200000)], (0.5, 99.5), axis=0)
        reach = FAR * np.ptp(inner, axis=0).max()
        return np.maximum(seen.min(axis=0), inner[0] - reach), np.minimum(seen.max(axis=0), inner[1] + reach)

    def _surface(self, name, kind, place, sets, of, edges=None, frame=False):
        """Adds the moving points [instants][n][3] of a surface, the corners of its facets and the ends of its edges; the page finds
        those of elements."""
        flat = place.reshape(-1, 3)
        low, high = flat.min(axis=0), flat.max(axis=0)
        coded = np.full((*place.shape[:2], 4), STEPS, np.uint16)
        coded[..., :3] = quantised(place, low, high - low)
        self.pack.add(name, coded, "time")
        for k, corners in enumerate(sets):
            self.pack.add(f"{name}/{k}", corners.astype(np.uint32).reshape(1, -1, 1), "row")
        if edges is not None:
            self.pack.add(f"{name}/edges", edges.astype(np.uint32).reshape(1, -1, 1), "row")
        if frame:
            self.boxes.append((place[0].min(axis=0), place[0].max(axis=0)))
        return {"name": name, "kind": kind, "count": place.shape[1], "low": low.tolist(), "size": (high - low).tolist(),
                "sets": len(sets), "of": of}

    def _same_points(self, part):
        """The grids of a part at the instants; those with another number of points are left out."""
        of = self.files[part]
        grids = [Grid(at_step(of, step)) for step in self.steps]
        if not self.times:
            self.times = [grid.time for grid in grids]
        return grids if len({len(grid.points) for grid in grids}) == 1 and len(grids[0].points) else []

    def _elements(self):
        found = []
        for part in sorted(p for p in self.files if p.startswith("elements")):
            grids, sets, of, known = self._same_points(part), [], [], {}
            for grid in grids:
                key = grid.links.tobytes()
                if key not in known:
                    known[key] = len(sets)
                    sets.append(outside_of(grid.links.reshape(-1, self.dimension + 1)))
                of.append(known[key])
            if not grids:
                continue
            used = np.zeros(len(grids[0].points), bool)
            used[np.concatenate([s.ravel() for s in sets])] = True
            row = np.cumsum(used) - 1  # inner nodes are not drawn
            place = np.stack([grid.points[used] for grid in grids])
            found.append(self._surface(part, "elements", place, [row[s] for s in sets], of, frame=True))
            for grid in grids:
                grid.point = {name: value[used] for name, value in grid.point.items()}
                self._take(part, grid, np.ones(int(used.sum()), bool))
        return found

    def _bodies(self):
        grids = self._same_points("bodies") if "bodies" in self.files else []
        if not grids:
            return []
        if not self.boxes or not self.bonded:
            self.boxes.append((grids[0].points.min(axis=0), grids[0].points.max(axis=0)))
        corners = grids[0].links.reshape(-1, self.dimension)
        place = np.stack([grid.points for grid in grids])
        facets = corners if self.dimension == 3 else np.zeros((0, 3), int)
        return [self._surface("bodies", "bodies", place, [facets], [0] * len(grids), folds(corners, place[0][corners]))]

    def _walls(self):
        walls = [walls_of(self.results, time) for time in self.times]
        if not walls[0] or not self.boxes:
            return []
        low, high = (f([b[k] for b in self.boxes], axis=0) for k, f in ((0, np.min), (1, np.max)))
        corners = panes(walls[0], low, high)
        if not len(corners):
            return []
        kept = [k for k, wall in enumerate(walls[0]) if len(panes([wall], low, high))]
        moved = np.array([[wall[k][0] - walls[0][k][0] for k in kept] for wall in walls])
        place = (corners[None] + moved[:, :, None, :]).reshape(len(walls), -1, 3)
        facets, edges = (np.concatenate([np.array(of) + 4 * k for k in range(len(kept))])
                         for of in ([[0, 1, 2], [0, 2, 3]], [[0, 1], [1, 2], [2, 3], [3, 0]]))
        return [self._surface("walls", "walls", place, [facets], [0] * len(walls), edges)]

    def _write_fields(self):
        names = wanted_fields(list(self.fields), self.bonded, self.asked)
        varied = [n for n in names if n not in WHOLE or len(np.unique(np.concatenate(self.fields[n].seen))) > 1]
        self.meta["fields"] = [self.fields[name].write(self.pack) for name in varied]

    # Intact bonds first, then those that broke, the latest first: the bonds that are intact at an instant are the first ones, and
    # those that have broken the last ones.
    def _bonds(self):
        self.meta["bonds"] = {"count": 0}
        if not self.bonded or not len(self.ids):
            return
        ids = np.asarray(self.results.particles["id"].value).reshape(-1) if "id" in self.results.particles else np.arange(self.results.particle_count)
        first, second = (np.searchsorted(self.ids, ids[np.asarray(self.results.bonds[end].value, int).reshape(-1)]) for end in "ij")
        state = self.results.bond_state
        time = np.asarray(self.results.bonds["broken_time"].value, float).reshape(-1)
        there = (first < len(self.ids)) & (second < len(self.ids))
        time = np.where(np.isfinite(time), time, np.inf)
        order = np.lexsort((second, first, -time))
        order = order[there[order]]
        first, second, state, time = (v[order] for v in (first, second, state, time))
        count, broken = len(order), np.isfinite(time)
        self.pack.add("bond_first", first.astype(np.uint32)[None], "row")
        self.pack.add("bond_reach", (second - first).astype(np.uint32)[None])
        self.pack.add("bond_cause", np.where(broken, state, 0).astype(np.uint8)[None])
        self.pack.add("bond_time", time[broken].astype(np.float32).view(np.uint32)[None])
        self.meta["bonds"] = {"count": count, "broken": int(broken.sum()), "tension": int((state[broken] == 1).sum()), "shear": int((state[broken] == 2).sum())}
        if {"force", "all"} & set(self.asked) or not self.asked and count * len(self.steps) <= FORCES:
            self._forces(first, second)

    def _forces(self, first, second):
        """Normal forces of the bonds at the instants, from files whose rows may be others."""
        of = self.files.get("bonds", {})
        if not of:
            return
        key, field = first * len(self.ids) + second, Field("force", "N")
        order = np.argsort(key)
        for step in self.steps:
            path = at_step(of, step)
            grid = Grid(path)
            with snapshot(os.path.join(os.path.dirname(path), os.path.basename(path).replace("bonds_", "particles_"))) as file:
                ids = np.searchsorted(self.ids, values(file, "VTKHDF/PointData/id"))
            ends = np.sort(ids[grid.links.reshape(-1, 2)], axis=1)
            row = np.searchsorted(key[order], ends[:, 0] * len(self.ids) + ends[:, 1])
            row = order[np.minimum(row, len(order) - 1)]
            same = (first[row] == ends[:, 0]) & (second[row] == ends[:, 1])
            value = np.zeros(len(key))
            value[row[same]] = grid.cell["force"][same]
            field.add("bonds", value, value != 0)
        self.meta["fields"].append({**field.write(self.pack), "label": "force of bonds, tension +"})

    def _history(self):
        columns = {n: c for n, c in self.results.history.items() if np.isfinite(c.value).any() and np.ptp(c.value[np.isfinite(c.value)]) > 0}
        rows = np.unique(np.linspace(0, self.results.rows - 1, ROWS).round().astype(int)) if self.results.rows else np.zeros(0, int)
        self.meta["history"] = {"rows": len(rows), "columns": [{"name": n, "unit": c.unit, "text": c.text} for n, c in columns.items()]}
        if len(rows) and columns:
            table = np.stack([c.value[rows] for c in columns.values()]).astype(np.float32).view(np.uint32)
            self.pack.add("history", table[:, :, None])
        self.meta["plots"] = plots_of(list(columns), self.results)
        self.meta["words"] = dict(zip(("strain", "stress"), self.results.words)) if self.results.test_kind else {}

    def _eyes(self):
        """How the specimen is seen at first: directions up and right, limits, and whether from above as a bed."""
        flat = self.dimension == 2
        up = 1 if flat else self.results.up_axis()
        right = 0 if flat else (up + 1) % 3
        if not flat and "indirect_tensile_strength" in self.results.readings and up < 2:
            right = 1 - up  # a disc is viewed from its face
        low, high = (f([b[k] for b in self.boxes], axis=0) for k, f in ((0, np.min), (1, np.max)))
        size = high - low
        bed = not flat and size[up] < 0.7 * np.delete(size, up).max()
        return {"times": self.times, "up": up, "right": right, "low": low.tolist(), "high": high.tolist(), "bed": bool(bed),
                "test": self.results.test_kind}


def outside_of(elements):
    """Facets [n][3] of triangles, or the faces of tetrahedra that have no neighbour."""
    if elements.shape[1] == 3:
        return elements
    faces = elements[:, FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def plots_of(names, results):
    """[[column along, column up]] of the two curves at first, by what the run has."""
    along = "strain" if "strain" in names and results.test_kind else "time"
    up = AXES[results.up_axis()]
    first = [n for n in ("stress", "normal_force", "force") if n in names] + [n for n in names if re.match(rf"sink_.*_mass|(body|wall)_.*_force_{up}", n)]
    second = [n for n in ("damage", "broken_tension", "rolling_force", "energy_kinetic", "unbalanced") if n in names and n not in first[:1]]
    if along == "strain" and "normal_force" in names:
        along = "cut_path" if "cut_path" in names else "time"
    return [[along, ups[0]] for ups in (first or second[1:], second) if ups]


__all__ = ["NoResults", "Vanished", "View", "results_of"]
