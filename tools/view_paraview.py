"""Files for ParaView that `view.py --paraview` writes (docs/view.md): a script that opens the snapshots of a run, and all of them in one
file."""
import os

import h5py
import numpy as np

from report_files import values, write
from view_data import Grid, files_of, snapshot

SCRIPT = '''"""Opens a run of gneiss in ParaView 5.11 or later: File > Load State, or `pvpython {name} [PICTURE.png]`. Written by
`gneiss view --paraview`, which replaces it."""
import os
import sys

from paraview.simple import *

FOLDER = {folder!r}
if "__file__" in globals() and os.path.isdir(os.path.dirname(os.path.abspath(__file__))):
    FOLDER = os.path.dirname(os.path.abspath(__file__))  # the folder may have been moved
FIELDS = {fields!r}  # name: (lowest, highest value of the colours)
UNITS = {units!r}
DAMAGE = [0.85, 0.83, 0.78], [0.91, 0.75, 0.49], [0.87, 0.49, 0.24], [0.70, 0.15, 0.12], [0.29, 0.05, 0.07]
RADIUS = {radius!r}  # m, mean of the particles
UP, RIGHT, LOW, HIGH, TIMES, DIMENSION = {eyes!r}

view = GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.OrientationAxesLabelColor = [0.1, 0.1, 0.1]
view.ViewSize = [1200, 900]


def opened(part):
    """The snapshots of a part with their times; None where there are none."""
    path = os.path.join(FOLDER, part + ".hdf.series")
    if not os.path.exists(path):
        return None
    reader = OpenDataFile(path)
    RenameSource(part, reader)
    return reader


def between(source, array, low, high, name):
    found = Threshold(registrationName=name, Input=source)
    found.Scalars = array
    found.LowerThreshold, found.UpperThreshold, found.ThresholdMethod = low, high, "Between"
    return found


def coloured(shown, place, field, title=None):
    """Colours by a field over the range that its bulk has; a few fragments do not set it."""
    ColorBy(shown, (place, field, "Magnitude") if field in ("velocity", "displacement") else (place, field))
    table = GetColorTransferFunction(field)
    low, high = FIELDS.get(field, (None, None))
    if field == "damage":
        table.RGBPoints = [v for k, colour in enumerate(DAMAGE) for v in (k / 4, *colour)]
    else:
        table.ApplyPreset("Viridis (matplotlib)" if low is not None and low >= 0 else "Cool to Warm", True)
        if low is not None:
            table.RescaleTransferFunction(low, high)
    bar = GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = title or field + UNITS.get(field, ""), ""
    bar.TitleColor = bar.LabelColor = [0.1, 0.1, 0.1]
    shown.SetScalarBarVisibility(view, True)


particles = opened("particles")
if particles is not None:
    particles.UpdatePipeline(TIMES[-1])
    names = particles.PointData.keys()
    there = between(particles, ("POINTS", "removed"), 0, 0, "present particles")
    if "asleep" in names:
        there = between(there, ("POINTS", "asleep"), 0, 0, "active particles")
    shown = Show(there, view)
    shown.SetRepresentationType("Point Gaussian")
    shown.ShaderPreset = "Sphere"
    shown.GaussianRadius = 1.0
    shown.ScaleByArray = 1
    shown.SetScaleArray = ["POINTS", "radius"]
    shown.UseScaleFunction = 0
    field = "damage" if "damage" in FIELDS else "velocity"
    coloured(shown, "POINTS", field)
bonds = opened("bonds")
if bonds is not None:
    bonds.UpdatePipeline(TIMES[-1])
    for name, low, high, array in (("intact bonds", 0, 0, "force"), ("softening bonds", 4, 5, "criterion"), ("broken bonds", 1, 2, "state")):
        if name == "softening bonds" and "tension_damage" not in bonds.CellData.keys():
            continue
        lines = ExtractSurface(Input=between(bonds, ("CELLS", "state"), low, high, name + ", lines"))
        tube = Tube(registrationName=name, Input=lines)
        tube.Radius = (0.2 if array != "state" else 0.35) * RADIUS
        shown = Show(tube, view)
        coloured(shown, "CELLS", array, "broken bonds" if array == "state" else None)
        if array != "state":
            Hide(tube, view)
            HideScalarBarIfNotNeeded(GetColorTransferFunction(array), view)
    states = GetColorTransferFunction("state")
    states.InterpretValuesAsCategories = 1
    states.Annotations = ["1", "in tension", "2", "in shear"]
    states.IndexedColors = [0.78, 0.25, 0.18, 0.17, 0.42, 0.69]
for part in sorted(name[: -len(".hdf.series")] for name in os.listdir(FOLDER) if name.startswith("elements") and name.endswith(".hdf.series")):
    shown = Show(opened(part), view)
    shown.SetRepresentationType("Surface With Edges")
    shown.EdgeColor = [0.35, 0.35, 0.35]
    coloured(shown, "POINTS", "pressure")
bodies = opened("bodies")
if bodies is not None:
    shown = Show(bodies, view)
    shown.ColorArrayName = [None, ""]
    shown.DiffuseColor, shown.Opacity = [0.45, 0.58, 0.7], 0.3
    if DIMENSION == 2:
        shown.LineWidth, shown.Opacity = 3, 1
text = AnnotateTime(registrationName="time")
text.Format = "t = {{time:.4g}} s"
shown = Show(text, view)
shown.Color, shown.WindowLocation = [0.1, 0.1, 0.1], "Lower Center"

GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
view.ViewTime = GetAnimationScene().AnimationTime = TIMES[-1]
middle = [0.5 * (a + b) for a, b in zip(LOW, HIGH)]
size = sum((b - a) ** 2 for a, b in zip(LOW, HIGH)) ** 0.5
up, right = ([1.0 if k == a else 0.0 for k in range(3)] for a in (UP, RIGHT))
back = [right[1] * up[2] - right[2] * up[1], right[2] * up[0] - right[0] * up[2], right[0] * up[1] - right[1] * up[0]]
toward = back if DIMENSION == 2 else [0.88 * b - 0.41 * r + 0.24 * u for b, r, u in zip(back, right, up)]
view.CameraFocalPoint, view.CameraViewUp = middle, up
view.CameraPosition = [m + 2.2 * size * t for m, t in zip(middle, toward)]
view.CameraParallelProjection = int(DIMENSION == 2)
view.CameraParallelScale = 0.4 * size
if len(sys.argv) == 2 and sys.argv[1].endswith(".png"):
    SaveScreenshot(sys.argv[1], view)
'''


def write_script(view, folder, target):
    """Writes the script; the ranges of its colours are those of the page."""
    fields = {f["name"]: (f["low"], f["high"]) for f in view.meta["fields"]}
    units = {name: f" [{field.unit}]" for name, field in view.fields.items() if field.unit != "1"}
    radius = view.results.particle("radius")
    eyes = (*(view.meta[name] for name in ("up", "right", "low", "high", "times")), view.dimension)
    write(target, SCRIPT.format(name=os.path.basename(target), folder=os.path.abspath(folder), fields=fields, units=units, eyes=eyes,
                                radius=0.0 if radius is None or not len(radius) else float(np.mean(radius))))


# --- one file ---------------------------------------------------------------------------------------------

CHUNK = 1 << 16  # bytes that are compressed together


class Pool:
    """Rows of an array over all instants; equal arrays are written once and found again by their offset."""

    def __init__(self, group, name):
        self.group, self.name, self.known, self.rows, self.data = group, name, {}, 0, None

    def offset(self, array, shared=True):
        key = hash(array.tobytes())
        if shared and key in self.known:
            return self.known[key]
        if self.data is None:
            chunk = max(1, CHUNK // max(1, array[:1].nbytes)), *array.shape[1:]
            self.data = self.group.create_dataset(self.name, data=array, maxshape=(None, *array.shape[1:]), chunks=chunk, compression="gzip", compression_opts=1)
        else:
            self.data.resize(self.rows + len(array), axis=0)
            self.data[self.rows:] = array
        self.known[key] = self.rows
        self.rows += len(array)
        return self.known[key]


def counts_of(path):
    """Numbers of points, cells and ids of the connectivity in a snapshot."""
    with snapshot(path) as file:
        return tuple(len(values(file, "VTKHDF/" + name)) for name in ("Points", "Types", "Connectivity"))


def write_part(group, files, index):
    """One part over time: VTKHDF 2.0, UnstructuredGrid with Steps. With a constant number of points and cells there is one entry of
    their counts, which all instants share; what does not change is written once. Otherwise types and offsets of cells are written for
    every instant, because readers find both by the same number."""
    counts = [counts_of(path) for path in files]
    same = len(set(counts)) == 1
    group.attrs["Version"] = np.array([2, 1], np.int64)
    group.attrs.create("Type", b"UnstructuredGrid", dtype="S16")
    group.attrs["Index"] = np.int64(index)
    for name in ("PointData", "CellData", "Steps/PointDataOffsets", "Steps/CellDataOffsets"):
        group.create_group(name, track_order=True)
    pools, steps, times = {}, {}, []

    def add(place, name, array):
        pool = pools.setdefault(name, Pool(group, name))
        steps.setdefault(place, []).append(pool.offset(array, same or name not in ("Types", "Offsets")))

    for path in files:
        with snapshot(path) as file:
            raw = {name: values(file, "VTKHDF/" + name) for name in ("Connectivity", "Offsets", "Types")}
        grid = Grid(path)
        times.append(grid.time)
        for place, name, array in (("PointOffsets", "Points", grid.points), ("ConnectivityIdOffsets", "Connectivity", raw["Connectivity"]),
                                   ("CellOffsets", "Types", raw["Types"]), ("", "Offsets", raw["Offsets"])):
            add(place, name, array)
        for kind, found in (("PointData", grid.point), ("CellData", grid.cell)):
            for name, array in found.items():
                add(f"{kind}Offsets/{name}", f"{kind}/{name}", array)
    for k, name in enumerate(("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")):
        group[name] = np.array([c[k] for c in (counts[:1] if same else counts)], np.int64)
    count = len(files)
    group["Steps"].attrs["NSteps"] = np.int64(count)
    group["Steps/Values"] = np.array(times)
    group["Steps/NumberOfParts"] = np.ones(count, np.int64)
    group["Steps/PartOffsets"] = np.zeros(count, np.int64) if same else np.arange(count)
    for place, offsets in steps.items():
        if place:
            array = np.array(offsets, np.int64)
            group["Steps/" + place] = array[:, None] if place in ("CellOffsets", "ConnectivityIdOffsets") else array


def write_one_file(folder, target):
    """Writes all snapshots of a folder as a collection of parts that change in time."""
    temporary = target + ".part"
    try:
        with h5py.File(temporary, "w") as file:
            root = file.create_group("VTKHDF", track_order=True)
            root.attrs["Version"] = np.array([2, 1], np.int64)
            root.attrs.create("Type", b"PartitionedDataSetCollection", dtype="S28")
            assembly = root.create_group("Assembly", track_order=True)  # readers go by the order of creation
            for index, (part, of) in enumerate(sorted(files_of(folder).items())):
                write_part(root.create_group(part, track_order=True), [of[step] for step in sorted(of)], index)
                assembly.create_group(part, track_order=True)[part] = h5py.SoftLink(f"/VTKHDF/{part}")
        os.replace(temporary, target)
    except BaseException:
        if os.path.exists(temporary):
            os.unlink(temporary)
        raise


__all__ = ["write_one_file", "write_script"]
