"""The contents of results.h5 (layout: docs/results.md), read at once and checked."""
import json
import re

import h5py
import numpy as np

from report_files import Unreadable, opened

REMEDY = "`gneiss resume` on the folder writes the results of its last checkpoint again"


def _text(value):
    if isinstance(value, np.ndarray):
        value = value.reshape(-1)[0] if value.size else ""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


class Column:
    """A data set with its unit and its description."""

    def __init__(self, dataset):
        self.value = np.asarray(dataset[()])
        self.unit = _text(dataset.attrs.get("unit", ""))
        self.text = _text(dataset.attrs.get("description", dataset.attrs.get("text", "")))
        self.kind = _text(dataset.attrs.get("kind", ""))  # kind of a term of the ledger: stored, input, lost
        self.absent = _text(dataset.attrs.get("absent", ""))  # Reason why there is no number.
        error = np.asarray(dataset.attrs.get("error", np.nan), float).reshape(-1)  # error budget of a reading
        self.error = float(error[0]) if error.size else float("nan")
        self.error_causes = _text(dataset.attrs.get("error_causes", ""))


def _group(file, name):
    group = file.get(name)
    if not isinstance(group, h5py.Group):
        return {}
    return {key: Column(item) for key, item in group.items() if isinstance(item, h5py.Dataset)}


def _without_free_overlaps(bonds):
    """Returns the rows of bonds; state 7 marks initial overlaps that never were bonds."""
    state = bonds.get("state")
    if state is None or not np.any(np.asarray(state.value) == 7):
        return bonds
    kept = np.asarray(state.value).reshape(-1) != 7
    for column in bonds.values():
        column.value = np.asarray(column.value)[kept]
    return bonds


# Quantities that the history counts since the start of the run, and that readings and their pictures count since the
# start of the last stage.
FROM_START = ("strain", "volumetric_strain", "lateral_strain", "dilation", "deflection", "opening")


class Results:
    """history, readings, stage_readings (by the name of the stage), energy, particles, bonds, nodes, elements, profile: dictionaries of Column; empty if
    absent."""

    def __init__(self, path):
        with opened(path, "a results file", REMEDY) as file:
            self._read(file)
        if not self.history and not self.particles and not self.elements:
            raise Unreadable(f"{path}: expected groups /history and /particles, found neither")

        self._check_places(path)

    def _check_places(self, path):
        """Checks that the rows of particles, nodes and bursts exist to which other data refer."""
        for group, name, count in (("bonds", "i", self.particle_count), ("bonds", "j", self.particle_count),
                                   ("elements", "node", len(getattr(self.nodes.get("position"), "value", ())))):
            column = getattr(self, group).get(name)
            values = np.zeros(0) if column is None else np.asarray(column.value).reshape(-1)
            outside = values[(values < 0) | (values >= count)]
            if outside.size:
                raise Unreadable(f"{path}: {group}/{name}: expected numbers below {count}, found {outside[0]}; {REMEDY}")

    def _read(self, file):
        self.attributes = dict(file.attrs)
        scene = file.get("scene")
        self.scene = _text(scene[()]) if isinstance(scene, h5py.Dataset) else ""
        self.history = _group(file, "history")
        self.readings = _group(file, "readings")
        stages = file.get("stages")
        self.stage_readings = ({name: _group(stages, f"{name}/readings") for name in stages} if isinstance(stages, h5py.Group) else {})
        self.energy = _group(file, "energy")
        self.particles = _group(file, "particles")
        self.bonds = _without_free_overlaps(_group(file, "bonds"))
        self.events = _group(file, "events")
        self.bursts = _group(file, "bursts")
        self.fragments = _group(file, "fragments")
        self.rim = _group(file, "rim")  # rim of a disc cutter
        self.nodes = _group(file, "nodes")
        self.elements = _group(file, "elements")
        self.bodies = _group(file, "bodies")
        self.profile = _group(file, "profile")
        lengths = [np.size(c.value) for c in self.history.values()]
        self.rows = min(lengths, default=0)
        for column in self.history.values():
            column.value = np.asarray(column.value, float).reshape(-1)[: self.rows]

    def check_summary(self, path):
        """Refuses results that do not belong to the summary of a finished run. The summary of an unfinished run may
        be older."""
        try:
            with open(path, encoding="utf-8") as file:
                said = json.load(file)
        except (OSError, ValueError):
            return
        expected = said.get("state_hash") if isinstance(said, dict) else None
        if self.finished and expected and self.attribute("state_hash") != expected:
            raise Unreadable(f"{path}: expected the summary of the run that results.h5 is of (state_hash {self.attribute('state_hash')}), "
                             f"found that of another run ({expected}); {REMEDY}")

    def attribute(self, name, default=""):
        return _text(self.attributes[name]) if name in self.attributes else default

    @property
    def dimension(self):
        try:
            return int(self.attribute("dimension", "3"))
        except ValueError:
            return 3

    @property
    def stages(self):
        """Returns (name, first row, rows) of the stages that have begun; empty without stages."""
        numbers, names = self.column("stage"), self.attribute("stages").split("\n")
        if numbers is None:
            return []
        begins = [int(np.searchsorted(numbers, k)) for k in range(len(names) + 1)]
        return [(name, begins[k], begins[k + 1] - begins[k]) for k, name in enumerate(names)
                if begins[k] < len(numbers)]

    @property
    def last_stage(self):
        """Returns (name, slice of rows) of the last stage that has rows; ("", all rows) without stages."""
        name, first, count = ([s for s in self.stages if s[2]] or [("", 0, self.rows)])[-1]
        return name, slice(first, first + count)

    @property
    def finished(self):
        return self.attribute("finished", "0") == "1"

    def column(self, name):
        """Returns the values of a history column, None if there is no such column or none of its values is finite."""
        column = self.history.get(name)
        if column is None or not np.isfinite(column.value).any():
            return None
        return column.value

    def in_last_stage(self, name):
        """Returns the values of a column in the last stage; displacements and strains count from its start."""
        stage, rows = self.last_stage
        values = self.column(name)
        if values is None or not np.isfinite(values[rows]).any():
            return None
        return values[rows] - (values[rows][0] if stage and name in FROM_START else 0.0)

    @property
    def of_stage(self):
        """Returns the part of a title that names the stage, ", stage load"; "" without stages."""
        return self.last_stage[0] and ", stage " + self.last_stage[0]

    def scalar(self, group, name):
        column = group.get(name)
        return float(np.asarray(column.value).reshape(-1)[0]) if column is not None else float("nan")

    def particle(self, name):
        column = self.particles.get(name)
        return column.value if column is not None else None

    @property
    def particle_count(self):
        radius = self.particle("radius")
        return 0 if radius is None else len(radius)

    @property
    def dormant(self):
        """True for dormant particles, whose elements have not been converted. Their bonds are not included."""
        value = self.particle("asleep")
        return np.zeros(self.particle_count, bool) if value is None else np.asarray(value).reshape(-1) != 0

    @property
    def element_count(self):
        node = self.elements.get("node")
        return 0 if node is None else len(node.value)

    @property
    def bond_state(self):
        column = self.bonds.get("state")
        return np.zeros(0, int) if column is None else column.value.astype(int)

    @property
    def test_kind(self):
        """Returns the kind of test given by the scene; "" without a test."""
        block = re.search(r"^test:.*?(?=^\S|\Z)", self.scene, re.MULTILINE | re.DOTALL)
        kind = block and re.search(r"\bkind:\s*[\"']?(\w+)", block[0])
        return kind[1] if kind else ""

    @property
    def words(self):
        """Names of the strain and of the stress of the test."""
        return self.attribute("test_strain", "axial strain"), self.attribute("test_stress", "axial stress")

    def test_axis(self):
        """Returns the axis of the test given by the scene (0, 1, 2), otherwise the vertical axis."""
        block = re.search(r"^test:.*?(?=^\S|\Z)", self.scene, re.MULTILINE | re.DOTALL)
        axis = block and re.search(r"\baxis:\s*[\"']?([xyz])", block[0])
        return "xyz".index(axis[1]) if axis else self.up_axis()

    def up_axis(self):
        """Returns the vertical axis (0, 1, 2): that of gravity, otherwise z, in 2D y; for a specimen loaded along an
        axis this axis. Components that vary with time count by their mean."""
        gravity = re.search(r"^gravity:\s*\[(.*)\]\s*$", self.scene, re.MULTILINE)
        times = self.history["time"].value if "time" in self.history else np.linspace(0.0, 1.0, 101)
        pull = [abs(mean_of(g, times)) for g in split_list(gravity[1])] if gravity else [0.0]
        if max(pull) > 0:
            return pull.index(max(pull))
        stands = "stress_lower" in self.history and "normal_stress" not in self.history
        return self.test_axis() if stands else min(2, self.dimension - 1)


def split_list(inner):
    """Returns the texts between the commas of a list in brackets, without those in inner lists and in quotes."""
    return re.findall(r"\[(?:\[[^\]]*\]|[^\[\]])*\]|\"[^\"]*\"|[^,\s\"\[\]]+", inner)


FUNCTIONS = {name: getattr(np, name) for name in (
    "sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log10", "log2", "sqrt", "abs", "sign", "rint")}
FUNCTIONS |= {"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "ln": np.log, "log": np.log,
              "min": np.minimum, "max": np.maximum, "pi": np.pi, "_pi": np.pi, "_e": np.e}


def mean_of(component, times):
    """Returns the mean over the times of a number, a table or a formula of a scene as text; 0 for a formula with other
    operators and functions than those above."""
    numbers = [float(n) for n in re.findall(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?", component)] if '"' not in component else []
    if component.startswith("["):
        return float(np.mean(np.interp(times, numbers[::2], numbers[1::2])))
    if numbers:
        return numbers[0]
    number, name = r"\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?", r"[A-Za-z_]\w*"
    parts = re.findall(rf"{number}|{name}|[-+*/^(),]", component)
    allowed = all(p in FUNCTIONS or p == "t" for p in parts if re.fullmatch(name, p))
    if not allowed or "".join(parts) != re.sub(r"[\s\"]", "", component):
        return 0.0
    code = "".join(f"float({p})" if re.fullmatch(number, p) else "**" if p == "^" else p for p in parts)
    try:
        with np.errstate(all="ignore"):
            value = np.mean(eval(code, {"__builtins__": {}, "float": np.float64, **FUNCTIONS, "t": np.asarray(times)}))
    except (ArithmeticError, SyntaxError, TypeError, ValueError):
        return 0.0
    return float(value) if np.isfinite(value) else 0.0


# --- numbers for people --------------------------------------------------------------------------------

PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
SCALED_UNITS = ("Pa", "J", "N", "m", "s")


def scale_for(largest, unit):
    """(factor, unit text): value/factor has a handy size in the unit text, as 20.1 GPa or 241 MPa."""
    if unit not in SCALED_UNITS:
        return 1.0, "" if unit in ("", "1") else unit
    if not np.isfinite(largest) or largest == 0:
        return 1.0, unit
    for factor, prefix in PREFIXES:
        if abs(largest) >= factor and not (prefix == "k" and unit in ("m", "s")):
            return factor, prefix + unit
    return PREFIXES[-1][0], PREFIXES[-1][1] + unit


def scale_of(values, unit):
    values = np.abs(np.asarray(values, float))
    values = values[np.isfinite(values)]
    return scale_for(values.max() if values.size else 0.0, unit)


def quantity(value, unit, digits=4):
    """Returns `20.13 GPa`, `0.168`, or `-` for a reading without a value."""
    if not np.isfinite(value):
        return "–"
    factor, text = scale_for(value, unit)
    return f"{value / factor:.{digits}g} {text}".strip()
