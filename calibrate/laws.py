"""Laws of bonds that a calibration can use, and the values of a scene that follow from its parameters."""
import copy
import math
from dataclasses import dataclass, field

from calibrate import units

BY_AREA = ("dempack", "polyhedron")
FRICTION = 0.5  # friction of contacts that are not bonded, unless it is given
LOWERING = 3.0  # divisor of FRICTION at bond_friction below 0: strengths under pressure are as sensitive to a third as to bond_friction above 0


@dataclass(frozen=True)
class Law:
    """Sections of a scene, and what the law adds to a simpler one."""
    name: str
    text: str
    law: dict = field(default_factory=dict)
    bonds: dict = field(default_factory=dict)
    material: dict = field(default_factory=dict)
    bond_friction: float = 0.0  # value unless a target determines it
    most_friction: float = 4.0  # largest bond_friction
    slope: float = 0.35         # slope of ln compressive strength over ln chi, at the start
    friction_slopes: tuple = (0.12, 0.1)  # slopes of ln friction angle, and of ln compressive strength, over mu_1, at the start


# The simplest law is the first: `auto` takes the first one that reaches the targets.
LAWS = (
    Law("linear", "brittle bonds", {"stiffness": "harmonic"}, {"interaction_range": 0.05}, most_friction=0.0),
    Law("friction", "brittle bonds whose shear strength grows with pressure", {"stiffness": "harmonic"}, {"interaction_range": 0.05},
        bond_friction=1.0),
    Law("moments", "bonds that carry moments, as parallel bonds, and whose shear strength grows with pressure", {"stiffness": "harmonic"},
        {"interaction_range": 0.05, "radius_multiplier": 1.0, "moment_share": 0.0}, bond_friction=1.0, slope=0.9, friction_slopes=(0.35, 0.5)),
    Law("softening", "bonds by area that soften, and whose shear strength grows with pressure", {"stiffness": "dempack", "softening": "ratio"},
        {"interaction_range": 0.05}, {"poisson": 0.2, "fracture_ratio": 1.0}, bond_friction=1.0),
)
NAMES = tuple(law.name for law in LAWS)


def named(name):
    return LAWS[NAMES.index(name)]


def label(law):
    """Name of a law in texts; None stands for the sections of a base scene."""
    return law.name if law else "of the scene"


def with_law(scene, law):
    """The scene with the sections of a law; of a base scene these are kept as they are."""
    scene = copy.deepcopy(scene)
    for section in ("law", "bonds"):
        scene[section] = {**scene.get(section, {}), **getattr(law, section)}
    scene["materials"][0].update(law.material)
    scene["materials"][0].setdefault("friction", FRICTION)
    return scene


def stiffness_of(scene):
    return scene["law"]["stiffness"]


def dimension_of(scene):
    return int(scene.get("dimension", 3))


def material_values(scene, parameters):
    """Keys of the material for the parameters. The parameters are keys themselves, or `modulus` (Pa; N/m with the uniform law), `ratio` (k_t/k_n),
    `tension` (Pa, N with the uniform law), `chi` (shear over tensile strength of a contact), `bond_friction` (below 0: bonds have none, and friction
    is lower than FRICTION by its part 1/LOWERING)."""
    if "tension" not in parameters:
        return dict(parameters)
    kind, shear = stiffness_of(scene), parameters["tension"] * parameters["chi"]
    friction = parameters.get("bond_friction", 0.0)
    values = {"bond_friction": friction} if friction > 0.0 else {"friction": round(FRICTION + friction / LOWERING, 9)} if friction < 0.0 else {}
    if kind == "uniform":
        return {"normal_stiffness": parameters["modulus"], "kratio": 1.0 / parameters["ratio"],
                "bond_tension_limit": parameters["tension"], "bond_shear_limit": shear, **values}
    strengths = {"tensile_strength": parameters["tension"], "shear_strength": shear, **values}
    if kind in BY_AREA:  # k_t/k_n = beta/(2 (1 + nu)) with alpha = 1
        poisson = units.number(scene["materials"][0].get("poisson", 0.2), "1")
        return {"young": parameters["modulus"], "poisson": poisson, "alpha": 1.0, "beta": 2.0 * (1.0 + poisson) * parameters["ratio"], **strengths}
    return {"contact_modulus": parameters["modulus"], "kratio": 1.0 / parameters["ratio"], **strengths}


def modulus_key(scene):
    """(key of the material that is proportional to the stiffness of contacts, its unit)."""
    kind = stiffness_of(scene)
    return ("normal_stiffness", "N/m") if kind == "uniform" else ("young" if kind in BY_AREA else "contact_modulus", "Pa")


def contact_stiffness(scene, radius):
    """Normal stiffness of a contact of two particles of the mean radius (N/m) of the scene's material."""
    kind, (key, unit) = stiffness_of(scene), modulus_key(scene)
    modulus = units.number(scene["materials"][0][key], unit)
    if kind == "uniform" or dimension_of(scene) == 2:
        return modulus
    return modulus * (0.5 * math.pi if kind in BY_AREA else 2.0) * radius


def start(scene, wanted_modulus, wanted_poisson, radius):
    """Parameters from which a calibration starts: uniform strain of an isotropic packing for k_t/k_n (3D raised by 0.03, because a packing
    is softer in shear than that), and the modulus itself."""
    flat, nu = dimension_of(scene) == 2, wanted_poisson
    ratio = 0.3 if nu is None else 1.0 - 4.0 * nu if flat else (1.0 - 4.0 * nu) / (1.0 + nu) + 0.03
    modulus = wanted_modulus
    if stiffness_of(scene) == "uniform":
        modulus = wanted_modulus * (1.0 if flat else 2.0 * radius)
    return {"modulus": modulus, "ratio": min(max(ratio, 0.02), 1.5)}
