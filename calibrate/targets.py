"""The file of targets: which readings a material is to have, with which specimen and law. Problems are reported with line and column."""
import math
import os
import re
from dataclasses import dataclass, field

import numpy as np
import yaml

from calibrate import curves, units
from calibrate.laws import NAMES as LAWS, modulus_key
from calibrate.problem import Problem, code_of
from calibrate.specimens import particles_of

# Reading: unit, lowest and highest value, default tolerance (a number below 1: of the value; of a ratio or an angle: absolute).
READINGS = {
    "young_modulus": ("Pa", 1e3, 1e13, 0.02),
    "poisson_ratio": ("1", 0.0, 0.5, 0.01),
    "compressive_strength": ("Pa", 1.0, 1e12, 0.05),
    "tensile_strength": ("Pa", 1.0, 1e12, 0.05),
    "brazilian_strength": ("Pa", 1.0, 1e12, 0.05),
    "crack_initiation_stress": ("Pa", 1.0, 1e12, 0.1),
    "friction_angle": ("deg", 1.0, 80.0, 2.0),
    "m_i": ("1", 0.1, 200.0, 0.1),
}
ABSOLUTE = {"poisson_ratio", "friction_angle"}  # readings whose tolerances are differences in the unit of the reading
KEYS = ("title", "dimension", "specimen", "scene", "density", "friction", "law", "bonds", "parameters", "targets", "seeds", "budget")
SHAPES = {"cylinder": 3, "box": 3, "rectangle": 2}
SOURCES = ("file", "from", "lattice", "disc", "polygon", "surface", "mesh")  # keys of a specimen that is not a shape to be packed, and of other shapes
LENGTHS = {"cylinder": ("diameter", "height"), "box": ("size",), "rectangle": ("width", "height")}
MATERIAL = {"density": ("kg/m3", 1.0, 1e5), "contact_modulus": ("Pa", 1.0, 1e15), "young": ("Pa", 1.0, 1e15), "normal_stiffness": ("N/m", 1e-3, 1e15),
            "kratio": ("1", 0.0, 1e6), "alpha": ("1", 1e-6, 1e6), "beta": ("1", 0.0, 1e6), "poisson": ("1", -0.99, 0.5), "bond_friction": ("1", 0.0, 100.0)}
# Keys of the material that `parameters` can name: unit, lowest and highest value.
FREE = {**{key: MATERIAL[key] for key in MATERIAL if key not in ("density", "poisson")}, "friction": ("1", 0.0, 10.0), "poisson": ("1", 0.0, 0.5),
        **{key: ("Pa", 1.0, 1e12) for key in ("tensile_strength", "shear_strength", "yield_stress_1", "yield_stress_2", "yield_stress_3")},
        **{key: ("N", 1e-6, 1e12) for key in ("bond_tension_limit", "bond_shear_limit")},
        **{key: ("1", 1.0, 1e6) for key in ("yield_ratio_1", "yield_ratio_2", "yield_ratio_3")},
        **{key: ("J/m2", 1e-6, 1e9) for key in ("fracture_energy", "shear_fracture_energy")},
        **{key: ("1", 1e-9, 1e6) for key in ("fracture_strain", "shear_fracture_strain", "fracture_ratio")}}
LINEAR = ("bond_friction",)  # parameters that may be 0: all others are searched in their logarithms
STIFFNESSES = ("uniform", "arithmetic", "harmonic", "mean_radius", "mean_arithmetic", "mean_harmonic", "dempack", "polyhedron")
CURVE = 0.1   # tolerance of the points of a curve over its largest stress
MOST_SEEDS = 1000
FEWEST = 50   # particles of a specimen
DEEPEST = 32  # largest number of nested sections, as in a scene


@dataclass(frozen=True)
class Point:
    """A point of a measured curve: its strain, and of the whole curve the confinement, the last strain and the largest stress (Pa)."""
    confinement: float
    strain: float
    last: float
    largest: float


@dataclass(frozen=True)
class Target:
    """A wanted reading: value and tolerance in SI (angles in degrees); the tolerance is a difference in the unit of the value."""
    name: str
    value: float
    tolerance: float
    confinement: float = 0.0  # Pa, lateral pressure for a strength under pressure
    point: Point = None       # point of a curve; value and tolerance are relative to its largest stress

    @property
    def unit(self):
        return "1" if self.point else READINGS["compressive_strength" if self.confinement else self.name][0]

    def error(self, found):
        """Difference of a found value, in tolerances."""
        return (found - self.value) / self.tolerance


@dataclass
class Request:
    """Contents of a file of targets; `scene` has the sections that are common to all tests, as texts and numbers."""
    path: str
    title: str
    scene: dict
    law: object                      # a name of laws.NAMES, "auto", or "scene": as the base scene has it
    targets: dict
    seeds: list
    most_runs: float = math.inf
    most_seconds: float = math.inf
    shape: str = ""
    parameters: dict = field(default_factory=dict)  # {key of the material: (lowest, highest, value of the scene)}; empty: those of the law
    notes: list = field(default_factory=list)


class File:
    """Nodes of a YAML file, with places for messages."""

    def __init__(self, path):
        self.path = path
        try:
            with open(path, encoding="utf-8") as file:
                text = file.read()
            self._refuse_loops(text)
            self.root = yaml.compose(text, Loader=yaml.SafeLoader)
        except OSError as error:
            raise Problem(f"{path}: cannot be read: {error.strerror}", code_of(error)) from error
        except UnicodeDecodeError as error:
            raise Problem(f"{path}: expected UTF-8 text: {error.reason}") from error
        except yaml.MarkedYAMLError as error:
            place = error.problem_mark or error.context_mark
            raise Problem(f"{path}:{place.line + 1}:{place.column + 1}: {error.problem}") from error
        except yaml.YAMLError as error:
            raise Problem(f"{path}: expected YAML: {str(error).splitlines()[0]}") from error
        if not isinstance(self.root, yaml.MappingNode):
            raise Problem(f"{path}:1:1: expected keys and values such as 'targets:'")

    def _refuse_loops(self, text):
        """Refuses aliases, with which a section can contain itself, and sections that are nested deeply."""
        depth = 0
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if isinstance(event, yaml.AliasEvent):
                self.fail(event, "YAML aliases are not part of a file of targets; repeat the value")
            if depth > DEEPEST:
                self.fail(event, "nested too deeply")

    def fail(self, node, message, code=2):
        raise Problem(f"{self.path}:{node.start_mark.line + 1}:{node.start_mark.column + 1}: {message}", code)

    def entries(self, node, name):
        """[(key, key's node, value's node)] of a section; a key that stands twice is refused."""
        if not isinstance(node, yaml.MappingNode):
            self.fail(node, f"{name}: expected a section, found {describe(node)}")
        seen = set()
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode) or key.value in seen:
                self.fail(key, f"{name}: expected each key once, found {describe(key)} again")
            seen.add(key.value)
        return [(key.value, key, value) for key, value in node.value]

    def number(self, node, name, unit, low, high):
        """Value of a scalar in the unit, within [low, high]."""
        if not isinstance(node, yaml.ScalarNode):
            self.fail(node, f"{name}: expected a number, found {describe(node)}")
        try:
            value = units.number(node.value, unit)
        except ValueError as error:
            self.fail(node, f"{name}: {error}")
        if not low <= value <= high:
            shown = "" if unit == "1" else " " + unit
            self.fail(node, f"{name}: expected a number in [{low:g}, {high:g}]{shown}, found '{node.value}'")
        return value

    def whole(self, node, name, low, high):
        """Whole number of a scalar within [low, high]."""
        value = self.number(node, name, "1", low, high)
        if value != int(value):
            self.fail(node, f"{name}: expected a whole number, found '{node.value}'")
        return int(value)

    def text(self, node, name):
        if not isinstance(node, yaml.ScalarNode):
            self.fail(node, f"{name}: expected a text, found {describe(node)}")
        return node.value

    def section(self, node, name):
        """{key: node} of a section."""
        return {key: value for key, _, value in self.entries(node, name)}

    def data(self, node):
        """Plain dicts, lists and texts of a node, as a scene takes them."""
        if isinstance(node, yaml.MappingNode):
            return {key: self.data(value) for key, _, value in self.entries(node, "section")}
        if isinstance(node, yaml.SequenceNode):
            return [self.data(one) for one in node.value]
        return node.value


def describe(node):
    if isinstance(node, yaml.ScalarNode):
        return f"'{node.value}'"
    return "a section" if isinstance(node, yaml.MappingNode) else "a list"


# --- targets -------------------------------------------------------------------------------------------

def _tolerance(file, node, name, unit, value):
    """Absolute tolerance of a target; a percentage, and a plain number for stresses and moduli below 1, is of the value."""
    relative = isinstance(node, yaml.ScalarNode) and node.value.strip().endswith("%")
    if relative or (name not in ABSOLUTE and unit == "1"):
        return value * file.number(node, f"targets.{name}.tolerance", "1", 1e-4, 1.0)
    return file.number(node, f"targets.{name}.tolerance", unit, 1e-4 * value, max(value, 1e-3))


def _target(file, name, node, label=None, reading=None, confinement=0.0, extra=()):
    unit, low, high, default = READINGS[reading or name]
    fields = {"value": node}
    if isinstance(node, yaml.MappingNode):
        fields = {}
        for key, where, value in file.entries(node, f"targets.{name}"):
            if key not in ("value", "tolerance", *extra):
                file.fail(where, f"targets.{name}.{key}: expected value or tolerance, found '{key}'")
            fields[key] = value
    if "value" not in fields:
        file.fail(node, f"targets.{name}.value: expected a value, found none")
    value = file.number(fields["value"], f"targets.{name}.value", unit, low, high)
    tolerance = default if name in ABSOLUTE else default * value
    if "tolerance" in fields:
        tolerance = _tolerance(file, fields["tolerance"], name, unit, value)
    return Target(label or name, value, tolerance, confinement)


def _triaxial(file, node):
    """Peak stresses at confinements: a list of sections {confinement, value, tolerance}."""
    if not isinstance(node, yaml.SequenceNode) or not node.value:
        file.fail(node, f"targets.triaxial: expected a list of {{confinement, value}}, found {describe(node)}")
    found = []
    for one in node.value:
        pressure = file.section(one, "targets.triaxial").get("confinement")
        if pressure is None:
            file.fail(one, "targets.triaxial.confinement: expected a pressure, found none")
        confinement = file.number(pressure, "targets.triaxial.confinement", "Pa", 1.0, 1e12)
        target = _target(file, "triaxial", one, f"triaxial_{confinement / 1e6:g}MPa", "compressive_strength", confinement, ("confinement",))
        if target.value <= confinement:
            file.fail(one, f"targets.triaxial.value: expected an axial strength above the confinement of {confinement:g} Pa, found {target.value:g} Pa")
        found.append(target)
    return found


def _curve(file, node):
    """Points of a measured curve: a file, or a section {file, confinement, tolerance}."""
    keys = {"file": node} if isinstance(node, yaml.ScalarNode) else file.section(node, "targets.curve")
    for key in keys:
        if key not in ("file", "confinement", "tolerance"):
            file.fail(keys[key], f"targets.curve.{key}: expected file, confinement or tolerance, found '{key}'")
    if "file" not in keys:
        file.fail(node, "targets.curve.file: expected a file of strains and stresses, found none")
    confinement = file.number(keys["confinement"], "targets.curve.confinement", "Pa", 0.0, 1e12) if "confinement" in keys else 0.0
    name = file.text(keys["file"], "targets.curve.file")
    try:
        strains, stresses = curves.read(os.path.join(os.path.dirname(os.path.abspath(file.path)), name))
    except OSError as error:
        file.fail(keys["file"], f"targets.curve.file: {name} cannot be read: {error.strerror}", code_of(error))
    except ValueError as error:
        file.fail(keys["file"], f"targets.curve.file: {name}: {error}")
    most = float(np.max(stresses))
    if not most > 0.0:
        file.fail(keys["file"], f"targets.curve.file: {name}: expected stresses above 0 in compression, found at most {most:g} Pa")
    tolerance = file.number(keys["tolerance"], "targets.curve.tolerance", "1", 1e-4, 1.0) if "tolerance" in keys else CURVE
    found, label = [], f"curve_{confinement / 1e6:g}MPa" if confinement else "curve"
    for strain in np.linspace(0.0, strains[-1], curves.POINTS + 1)[1:]:
        if np.interp(strain, strains, stresses) <= 0.0:
            file.fail(keys["file"], f"targets.curve.file: {name}: expected stresses above 0, found none at a strain of {strain:.3g}")
        found.append(Target(f"{label}_{100.0 * strain:.3g}%", float(np.interp(strain, strains, stresses)) / most, tolerance,
                            point=Point(confinement, float(strain), float(strains[-1]), most)))
    return found


def _curves(file, node):
    """Points of one measured curve, or of several in a list."""
    return [target for one in (node.value if isinstance(node, yaml.SequenceNode) else [node]) for target in _curve(file, one)]


LISTS = {"triaxial": _triaxial, "curve": _curves}  # wanted readings that are several targets


def _contradictions(file, places, targets):
    def above(high, low):
        if high in targets and low in targets and targets[low].value >= targets[high].value:
            file.fail(places[low], f"targets.{low}: expected a value below {high} ({targets[high].value:g} Pa), found {targets[low].value:g} Pa")
    for low in ("tensile_strength", "brazilian_strength", "crack_initiation_stress"):
        above("compressive_strength", low)
    above("young_modulus", "compressive_strength")
    confined = sum(1 for target in targets.values() if target.confinement)
    for name in ("crack_initiation_stress", "friction_angle", "m_i"):
        if name in targets and "compressive_strength" not in targets and (name == "crack_initiation_stress" or confined < 3):
            file.fail(places[name], f"targets.{name}: needs compressive_strength; found none")


def read_targets(file, node):
    """{name: Target} of the section `targets`."""
    targets, places = {}, {}
    for name, where, value in file.entries(node, "targets"):
        if name not in LISTS and name not in READINGS:
            file.fail(where, f"targets.{name}: expected one of {', '.join([*READINGS, *LISTS])}; found '{name}'")
        for target in LISTS[name](file, value) if name in LISTS else [_target(file, name, value)]:
            if target.name in targets:
                file.fail(where, f"targets.{name}: expected each confinement once, found {target.point.confinement if target.point else target.confinement:g} Pa again")
            targets[target.name], places[target.name] = target, value
    if not targets:
        file.fail(node, f"targets: expected at least one of {', '.join([*READINGS, *LISTS])}; found none")
    _contradictions(file, places, targets)
    return targets


# --- the rest of the file ------------------------------------------------------------------------------

def _budget(file, node, request):
    """`60` or `60 runs`, or a time such as `10 min`."""
    text = node.value.strip() if isinstance(node, yaml.ScalarNode) else ""
    count = text.removesuffix("runs").strip()
    if re.fullmatch(r"[-+]?[0-9]+", count):
        if int(count) < 1:
            file.fail(node, f"budget: expected at least one run, found '{text}'")
        request.most_runs = int(count)
        return
    try:
        request.most_seconds = units.number(text, "s")
    except ValueError:
        file.fail(node, f"budget: expected a number of runs (60) or a time (10 min), found {describe(node)}")
    if not request.most_seconds > 0:
        file.fail(node, f"budget: expected a time above 0, found '{text}'")


def _seeds(file, node):
    """`seeds: 5` means 1 to 5."""
    if isinstance(node, yaml.SequenceNode):
        seeds = [file.whole(one, "seeds", 0, 2**53) for one in node.value]
        if not seeds or len(set(seeds)) < len(seeds):
            file.fail(node, "seeds: expected different whole numbers")
        return seeds
    return list(range(1, 1 + file.whole(node, "seeds", 1, MOST_SEEDS)))


def seeds_of(text):
    """Seeds of the option --seeds: a number of them from 1 on, or a list such as 3,7,11."""
    parts = text.split(",")
    seeds = [int(one) for one in parts if re.fullmatch(" *[0-9]{1,16} *", one)]
    if len(seeds) < len(parts) or (len(seeds) == 1 and not 1 <= seeds[0] <= MOST_SEEDS):
        raise Problem(f"--seeds: expected a number of seeds in [1, {MOST_SEEDS}] or a list such as 3,7,11, found '{text}'")
    if len(set(seeds)) < len(seeds) or max(seeds) > 2**53:
        raise Problem(f"--seeds: expected different whole numbers up to 2^53, found '{text}'")
    return seeds if len(seeds) > 1 else list(range(1, 1 + seeds[0]))


def _base_scene(file, node):
    """The sections of another scene that do not belong to its own test, as nodes and as data; paths become absolute."""
    folder = os.path.dirname(os.path.abspath(file.path))
    path = os.path.join(folder, file.text(node, "scene"))
    try:
        open(path, "rb").close()
    except OSError as error:
        file.fail(node, f"scene: {node.value} cannot be read: {error.strerror}", code_of(error))
    base = File(path)
    nodes = base.section(base.root, "scene")
    for key in ("specimen", "materials", "law"):
        if key not in nodes:
            file.fail(node, f"scene: expected a scene with the section {key}, found none in {node.value}")
    materials = nodes["materials"]
    if not isinstance(materials, yaml.SequenceNode) or len(materials.value) != 1:
        base.fail(materials, f"materials: expected a list with one material, found {describe(materials)}")
    material = base.section(materials.value[0], "materials")
    if "density" not in material:
        base.fail(materials.value[0], "materials.density: expected a density, found none")
    for key in MATERIAL.keys() & material.keys():
        base.number(material[key], f"materials.{key}", *MATERIAL[key])
    scene = {key: base.data(nodes[key]) for key in ("dimension", "specimen", "materials", "contacts", "law", "bonds", "damping", "neighbours") if key in nodes}
    for key in ("file", "from", "surface", "mesh"):
        if key in base.section(nodes["specimen"], "specimen"):
            scene["specimen"][key] = os.path.join(os.path.dirname(os.path.abspath(base.path)), scene["specimen"][key])
    return base, nodes, scene


def _new_scene(file, found):
    scene = {"dimension": file.whole(found["dimension"], "dimension", 2, 3) if "dimension" in found else 3,
             "specimen": dict(file.data(found["specimen"])), "materials": [{"name": "rock"}]}
    scene["specimen"].setdefault("density_basis", "bulk")
    scene["specimen"].setdefault("packing", {"size_ratio": 3, **({"overlap": "passive"} if scene["dimension"] == 3 else {})})
    scene["materials"][0]["density"] = file.number(found["density"], "density", "kg/m3", 1.0, 1e5) if "density" in found else 2600.0
    return scene


def _scene(file, found):
    """(scene, its shape)"""
    if ("scene" in found) == ("specimen" in found):
        file.fail(file.root, "expected either specimen (a shape and its number of particles) or scene (a file)")
    if "scene" in found:
        for key in ("dimension", "density"):
            if key in found:
                file.fail(found[key], f"{key}: expected this section in the scene itself, found it beside the key scene")
        base, nodes, scene = _base_scene(file, found["scene"])
        _law(base, nodes["law"], "law" not in found or found["law"].value == "scene")
        scene["dimension"] = base.whole(nodes["dimension"], "dimension", 2, 3) if "dimension" in nodes else 3
        shape = _shape(base, nodes["specimen"], scene["dimension"])
    else:
        shape = _shape(file, found["specimen"], file.whole(found["dimension"], "dimension", 2, 3) if "dimension" in found else 3)
        scene = _new_scene(file, found)
    if "bonds" in found:
        file.section(found["bonds"], "bonds")
        scene["bonds"] = file.data(found["bonds"])
    if "friction" in found:
        scene["materials"][0]["friction"] = file.number(found["friction"], "friction", "1", 0.0, 10.0)
    return scene, shape


def _law(file, node, is_used=True):
    """A section `law`, as a scene has it; bonds need one of STIFFNESSES."""
    keys = file.section(node, "law")
    if "stiffness" not in keys:
        file.fail(node, "law.stiffness: expected the stiffness of contacts, found none")
    if is_used and file.text(keys["stiffness"], "law.stiffness") not in STIFFNESSES:
        file.fail(keys["stiffness"], f"law.stiffness: expected one of {', '.join(STIFFNESSES)}, which have bonds; found '{keys['stiffness'].value}'")
    return file.data(node)


def _shape(file, node, dimension):
    """Name of the shape of a section `specimen`; its lengths and the size of its particles are numbers."""
    keys = file.section(node, "specimen")
    shapes = [shape for shape in SHAPES if shape in keys]
    if len(shapes) != 1 or SHAPES[shapes[0]] != dimension:
        file.fail(node, "specimen: expected a cylinder or a box (dimension 3) or a rectangle (dimension 2), which is tested along its height")
    for key in SOURCES:
        if key in keys:
            file.fail(keys[key], f"specimen.{key}: expected a shape alone, which can be packed with any seed, found {key} beside {shapes[0]}")
    shape = file.section(keys[shapes[0]], f"specimen.{shapes[0]}")
    for key in LENGTHS[shapes[0]]:
        name = f"specimen.{shapes[0]}.{key}"
        if key not in shape:
            file.fail(keys[shapes[0]], f"{name}: expected a length, found none")
        if shapes[0] == "box" and (not isinstance(shape[key], yaml.SequenceNode) or len(shape[key].value) != 3):
            file.fail(shape[key], f"{name}: expected three lengths, found {describe(shape[key])}")
        for one in shape[key].value if shapes[0] == "box" else [shape[key]]:
            file.number(one, name, "m", 1e-9, 1e9)
    if "mean_radius" in keys:
        file.number(keys["mean_radius"], "specimen.mean_radius", "m", 1e-9, 1e9)
    elif "particles" in keys:
        file.whole(keys["particles"], "specimen.particles", 1, 1e9)
    else:
        file.fail(node, "specimen.particles: expected a number of particles or mean_radius, found neither")
    size = "mean_radius" if "mean_radius" in keys else "particles"
    count = particles_of({"dimension": dimension, "specimen": file.data(node)})
    if count < FEWEST:
        file.fail(keys[size], f"specimen.{size}: expected at least {FEWEST} particles, since fewer have no strength of a material, found about {count:.3g}")
    return shapes[0]


def _parameters(file, node, scene):
    """{key of the material: (lowest, highest, value of the scene)} of the section `parameters`."""
    found, values = {}, scene["materials"][0]
    modulus, unit = modulus_key(scene)
    if modulus not in values:
        file.fail(node, f"parameters: expected a scene whose material has the {modulus} ({unit}) of its law, found none there")
    for key, where, value in file.entries(node, "parameters"):
        name = f"parameters.{key}"
        if key not in FREE:
            file.fail(where, f"{name}: expected one of {', '.join(FREE)}; found '{key}'")
        if not isinstance(value, yaml.SequenceNode) or len(value.value) != 2:
            file.fail(value, f"{name}: expected the lowest and the highest value, found {describe(value)}")
        low, high = (file.number(one, name, *FREE[key]) for one in value.value)
        if not low < high or low == 0.0 and key not in LINEAR:
            file.fail(value, f"{name}: expected a lowest value above 0 and below the highest one, found [{low:g}, {high:g}]")
        try:
            there = units.number(values.get(key), FREE[key][0])
        except ValueError:
            there = math.nan
        if not low <= there <= high:
            file.fail(value, f"{name}: expected a range that holds the value of the scene, found {values.get(key, 'none')} there")
        found[key] = (low, high, there)
    if not found:
        file.fail(node, "parameters: expected at least one key of the material, found none")
    return found


def read(path):
    """The Request of a file of targets; Problem with the place of the first mistake."""
    file = File(path)
    found = {}
    for key, where, value in file.entries(file.root, "file"):
        if key not in KEYS:
            file.fail(where, f"{key}: expected one of {', '.join(KEYS)}; found '{key}'")
        found[key] = value
    if "targets" not in found:
        file.fail(file.root, "targets: expected a section of wanted readings, found none")
    targets = read_targets(file, found["targets"])
    scene, shape = _scene(file, found)
    law = "scene" if "scene" in found else "auto"
    if "law" in found and not isinstance(found["law"], yaml.ScalarNode):
        scene["law"], law = _law(file, found["law"]), "scene"
        scene.setdefault("bonds", {"interaction_range": 0.05})
    elif "law" in found:
        law = found["law"].value
        if law not in ("auto", "scene", *LAWS) or (law == "scene" and "scene" not in found):
            file.fail(found["law"], f"law: expected auto, {', '.join(LAWS)} or a section as in a scene, found '{law}'")
    if "bonds" in found and law != "scene":
        file.fail(found["bonds"], f"bonds: needs a section law; found {describe(found['law']) if 'law' in found else 'none'}")
    if law == "scene" and "bonds" not in scene:
        file.fail(found["scene"], "scene: expected a scene with the section bonds, or a law, found neither")
    request = Request(path, file.text(found["title"], "title") if "title" in found else "", scene, law, targets,
                      _seeds(file, found["seeds"]) if "seeds" in found else [1, 2, 3, 4, 5], shape=shape)
    if "parameters" in found:
        if law != "scene" or "scene" not in found or "law" in found:
            file.fail(found["parameters"], "parameters: expected a scene, whose law and material are taken, and no law of its own")
        request.parameters = _parameters(file, found["parameters"], scene)
    if "budget" in found:
        _budget(file, found["budget"], request)
    return request
