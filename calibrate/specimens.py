"""Scenes of laboratory tests of one material: compression, direct tension, Brazilian disc, compression under pressure."""
import copy
import math
from dataclasses import dataclass

from calibrate import laws, units

SPEED = 0.01         # closing speed over wave speed and strain at the peak: 1 to 2 % of the strength by the study of accuracy
PLATEN = 5.0         # stiffness of platens over that of a contact
START = 0.05         # fraction of the expected duration in which ends come to their speed
DROP = 0.3           # drop of the stress that ends a test, relative to the peak
BEYOND = 1.02        # strain at which a test of a curve ends over that of the curve
SHRUNK = 5.0         # strain by which specimens can shrink away from platens under pressure, over pressure over modulus
DURATION = 4.0       # duration over the expected one
STRAIN = {"compression": 1.3, "tension": 1.1, "brazilian": 9.0, "triaxial": 1.6}  # strain at the peak over strength over modulus
SEAT = 0.1           # depth of platens in discs, in mean radii: platens that only touched would close gaps as wide as the strains of the test
GRIP = 1.5           # depth of glued ends in mean radii
AREA_SHARE, VOLUME_SHARE = 0.85, 0.6  # share of the volume (in 2D: of the area) that the particles fill
FLAT = math.cos(math.radians(5.0))  # Brazilian disc: flats of 10 degrees


@dataclass(frozen=True, order=True)
class Test:
    """One laboratory test: its kind, the confinement of a triaxial one in Pa, and the strain at which it ends (0: at a drop of the stress)."""
    kind: str
    confinement: float = 0.0
    strain: float = 0.0

    @property
    def name(self):
        return self.kind + (f"_{self.confinement / 1e6:.4g}MPa" if self.confinement else "") + (f"_{100.0 * self.strain:.3g}%" if self.strain else "")


@dataclass(frozen=True)
class Size:
    """Height along the axis, width, section (m, m2; 2D: 1 m thick), volume, and mean radius of the particles."""
    height: float
    width: float
    section: float
    radius: float
    diameter: float = 0.0


def metres(value):
    return [units.number(one, "m") for one in value] if isinstance(value, list) else units.number(value, "m")


def size_of(scene):
    """Size of the shape of a scene's specimen: a cylinder or box along z, a rectangle along y."""
    specimen, flat = scene["specimen"], laws.dimension_of(scene) == 2
    if "cylinder" in specimen:
        diameter, height = metres(specimen["cylinder"]["diameter"]), metres(specimen["cylinder"]["height"])
        width, section = diameter, 0.25 * math.pi * diameter**2
    elif "box" in specimen:
        diameter, (width, depth, height) = 0.0, metres(specimen["box"]["size"])
        section = width * depth
    else:
        diameter, width, height = 0.0, metres(specimen["rectangle"]["width"]), metres(specimen["rectangle"]["height"])
        section = width
    if "mean_radius" in specimen:
        radius = metres(specimen["mean_radius"])
    else:
        each = section * height / units.number(specimen["particles"], "1")
        radius = math.sqrt(AREA_SHARE * each / math.pi) if flat else (VOLUME_SHARE * each * 0.75 / math.pi) ** (1.0 / 3.0)
    return Size(height, width, section, radius, diameter)


def particles_of(scene):
    """Number of particles of a scene's specimen, an estimate if their mean radius is given."""
    if "mean_radius" not in scene["specimen"]:
        return units.number(scene["specimen"]["particles"], "1")
    size = size_of(scene)
    if laws.dimension_of(scene) == 2:
        return AREA_SHARE * size.section * size.height / (math.pi * size.radius**2)
    return VOLUME_SHARE * size.section * size.height / (4.0 / 3.0 * math.pi * size.radius**3)


def _axis(scene):
    return "y" if laws.dimension_of(scene) == 2 else "z"


def _origin(scene):
    found = scene["specimen"].get("origin")
    return metres(found) if found else [0.0] * laws.dimension_of(scene)


def _vector(axis, value, others=(0.0, 0.0, 0.0), flat=False):
    vector = list(others)
    vector["xyz".index(axis)] = value
    return vector[:2] if flat else vector


def _ends(travel, speed):
    """Tables of the velocities of the upper and the lower end, which part with the speed (below 0: close), each with half of it; `travel`
    is what they move up to the expected peak."""
    ramp = START * travel / abs(speed)
    return [[0, 0], [ramp, 0.5 * speed]], [[0, 0], [ramp, -0.5 * speed]]


def _platens(scene, axis, low, high, stiffness, motions):
    flat, walls = laws.dimension_of(scene) == 2, []
    for name, place, sign, motion in (("lower", low, 1, motions[1]), ("upper", high, -1, motions[0])):
        walls.append({"name": name, "point": _vector(axis, place, flat=flat), "normal": _vector(axis, sign, flat=flat),
                      "stiffness": stiffness, "passive": True})
        if motion:
            walls[-1]["motion"] = {"v" + axis: motion}
    return walls


@dataclass(frozen=True)
class Bench:
    """Builds the scenes of all tests of one material with one law. `modulus` (Pa) is that of the material, from which speeds and times
    follow."""
    scene: dict
    modulus: float

    def wave_speed(self):
        return math.sqrt(self.modulus / units.number(self.scene["materials"][0]["density"], "kg/m3"))

    def build(self, test, parameters, expected, seed):
        """The scene of a test of the packing with a seed. `expected` (Pa): about the strength that will be found."""
        scene, size = copy.deepcopy(self.scene), size_of(self.scene)
        scene["materials"][0].update(laws.material_values(scene, parameters))
        scene.setdefault("damping", {"background": {"model": "nonviscous_vector", "coefficient": 0.7}})
        scene["run"] = {"seed": seed, "threads": 1}
        scene["output"] = {"snapshots": 0, "history_rows": 1500}
        strain = max(STRAIN[test.kind] * expected / self.modulus, 1e-6)
        if test.kind == "brazilian":
            size = self.disc(scene, size)
        length = size.width if test.kind == "brazilian" else size.height
        speed = SPEED * self.wave_speed() * strain
        stiffness = PLATEN * laws.contact_stiffness(scene, size.radius)
        getattr(self, test.kind)(scene, test, size, (length * strain, speed), stiffness)
        beyond = BEYOND * test.strain + SHRUNK * test.confinement / self.modulus if test.strain else 0.0
        before, end = 0.0, {"strain": beyond} if test.strain else {"peak_drop": DROP}
        if "stages" in scene:
            before = scene["stages"][0]["end"]["time"]
            scene["stages"][-1]["end"] = end
        scene["time"] = {"end": before + DURATION * length * max(strain, beyond) / speed, **({} if before else {"stop": end})}
        return scene

    def _test(self, scene, kind, size):
        scene["test"] = {"kind": kind, "axis": _axis(scene), "lower": "lower", "upper": "upper", "length": size.height}
        scene["test"].update({"diameter": size.diameter} if size.diameter else {"area": size.section})

    def compression(self, scene, _, size, closing, stiffness):
        axis = _axis(scene)
        low = _origin(scene)["xyz".index(axis)]
        depth = SEAT * size.radius if laws.dimension_of(scene) == 2 else 0.0
        scene["walls"] = _platens(scene, axis, low + depth, low + size.height - depth, stiffness, _ends(closing[0], -closing[1]))
        self._test(scene, "compression", size)

    def tension(self, scene, _, size, closing, __):
        axis = _axis(scene)
        upper, lower = _ends(*closing)
        scene["sets"] = [{"name": name, "select": {"end": {"axis": axis, "side": name, "depth": GRIP * size.radius, "by": "surface"}},
                          "motion": {"v" + axis: motion}} for name, motion in (("lower", lower), ("upper", upper))]
        self._test(scene, "tension", size)

    def disc(self, scene, size):
        """Replaces the specimen by a disc as wide as the specimen is high, half as thick, of equal particles. Returns its size."""
        specimen, flat = scene["specimen"], laws.dimension_of(scene) == 2
        for key in ("cylinder", "box", "rectangle", "origin", "particles"):
            specimen.pop(key, None)
        specimen["mean_radius"] = size.radius
        diameter = size.height
        specimen.update({"disc": {"diameter": diameter}} if flat else {"cylinder": {"diameter": diameter, "height": 0.5 * diameter}})
        return Size(0.5 * diameter, diameter, 0.25 * math.pi * diameter**2, size.radius, diameter)

    def brazilian(self, scene, _, size, closing, stiffness):
        half = 0.5 * size.diameter * FLAT
        scene["walls"] = _platens(scene, "y", -half, half, stiffness, _ends(closing[0], -closing[1]))
        scene["test"] = {"kind": "brazilian", "axis": "y", "lower": "lower", "upper": "upper", "diameter": size.diameter}
        if laws.dimension_of(scene) == 3:
            scene["test"]["thickness"] = size.height

    def triaxial(self, scene, test, size, closing, stiffness):
        self.compression(scene, test, size, closing, stiffness)
        scene["test"]["kind"] = "biaxial" if laws.dimension_of(scene) == 2 else "triaxial"
        ramp = 10.0 * size.height / self.wave_speed()
        scene["membrane"] = {"pressure": test.confinement, "ramp": ramp}
        motions = {wall["name"]: {"motion": wall.pop("motion")} for wall in scene["walls"]}
        scene["stages"] = [{"name": "confine", "end": {"held": "1 %", "time": 4.0 * ramp}},
                           {"name": "load", "walls": motions}]
