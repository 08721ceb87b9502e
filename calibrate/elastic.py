"""Elastic constants without breaking bonds, and the parameters that give wanted ones."""
import math

import numpy as np

from calibrate import laws
from calibrate.problem import Problem
from calibrate.readings import COMPRESSION, MODULUS

ELASTIC = 0.4         # strain of the constants over compressive strength over modulus: within the elastic rows of a test
UNBREAKABLE = 1e30
STRAIN = 1e-3         # the same strain if there is no compressive strength
RATIO = (0.005, 3.0)  # bounds of k_t/k_n
MOST = 6             # evaluations of Poisson's ratio


def constants(material, parameters, seeds):
    """[(E in Pa, nu)] of the packings with these stiffnesses, by equilibria of the compression test without breaking bonds."""
    strong = {**parameters, "tension": UNBREAKABLE, "chi": 1.0} if "tension" in parameters or "modulus" in parameters else parameters
    scenes = [material.bench().build(COMPRESSION, strong, 0.003 * material.modulus, seed) for seed in seeds]
    strength = material.targets.get("compressive_strength")
    strain = float(f"{ELASTIC * strength.value / material.modulus:.3g}") if strength else STRAIN
    found = []
    for outcome in material.laboratory.constants(scenes, strain):
        pair = (outcome.reading(MODULUS[material.flat]), outcome.reading("poisson_ratio"))
        if None in pair:
            raise Problem(f"no elastic constants of this specimen: {outcome.message or outcome.absent.get('young_modulus', '')}", 5)
        found.append(pair)
    return found


def slopes(dimension, ratio):
    """d ln E/d ln rho and d nu/d ln rho of an isotropic packing in uniform strain (3D: E as (2 + 3 rho)/(4 + rho), nu = (1 - rho)/(4 + rho);
    2D: (1 + rho)(5 - rho), (1 - rho)/4; after Kruyt & Rothenburg 2002 and Liao et al. 1997)."""
    if dimension == 2:
        return ratio / (1.0 + ratio) - ratio / (5.0 - ratio), -0.25 * ratio
    return 3.0 * ratio / (2.0 + 3.0 * ratio) - ratio / (4.0 + ratio), -5.0 * ratio / (4.0 + ratio)**2


def bounded(ratio):
    return min(max(ratio, RATIO[0]), RATIO[1])


def fit(material, seeds, progress):
    """Parameters `modulus` and `ratio` with the wanted E and mean nu, by secants of nu over ln rho and by proportion of E. For keys of the material:
    their start values, and the modulus of the packings with these."""
    targets = material.targets
    if material.request.parameters:
        start = {name: value for name, (_, _, value) in material.request.parameters.items()}
        if "young_modulus" not in targets:
            material.modulus = math.exp(np.mean([math.log(young) for young, _ in constants(material, start, seeds)]))
        return start
    wanted_e = targets["young_modulus"].value if "young_modulus" in targets else None
    wanted_nu = targets["poisson_ratio"].value if "poisson_ratio" in targets else None
    parameters = laws.start(material.scene, material.modulus, wanted_nu, material.size.radius)
    parameters.update(given_stiffness(material))
    if wanted_nu is not None and wanted_e is None and "modulus" not in given_stiffness(material):
        material.modulus = parameters["modulus"]
    before = None
    for _ in range(MOST):
        pairs = constants(material, parameters, seeds)
        young, nu = math.exp(np.mean([math.log(pair[0]) for pair in pairs])), float(np.mean([pair[1] for pair in pairs]))
        progress(f"elastic constants: k_t/k_n {parameters['ratio']:.4g}: E {young / 1e9:.4g} GPa, nu {nu:.4f}")
        if wanted_e:
            parameters["modulus"] *= wanted_e / young
        else:
            material.modulus = young
        if wanted_nu is None or abs(nu - wanted_nu) < 0.1 * targets["poisson_ratio"].tolerance:
            break
        slope = slopes(laws.dimension_of(material.scene), parameters["ratio"])[1]
        if before and abs(math.log(parameters["ratio"] / before[0])) > 1e-3:
            slope = min((nu - before[1]) / math.log(parameters["ratio"] / before[0]), 0.2 * slope)
        before = (parameters["ratio"], nu)
        parameters["ratio"] = bounded(parameters["ratio"] * math.exp(min(max((wanted_nu - nu) / slope, -1.5), 1.5)))
        if parameters["ratio"] == before[0]:
            break  # the parameter is at a bound: the reading does not reach the target
    return parameters


def given_stiffness(material):
    """`modulus` and `ratio` of a base scene, for those that no target determines."""
    values, found = material.scene["materials"][0], {}
    if material.law is not None:
        return found
    key, unit = laws.modulus_key(material.scene)
    if "young_modulus" not in material.targets and key in values:
        found["modulus"] = laws.units.number(values[key], unit)
    if "poisson_ratio" not in material.targets:
        of = {name: laws.units.number(values[name], "1") for name in ("kratio", "alpha", "beta", "poisson") if name in values}
        if key == "young":
            found["ratio"] = of.get("beta", 1.0) / of.get("alpha", 1.0) / (2.0 * (1.0 + of.get("poisson", 0.2)))
        elif of.get("kratio"):
            found["ratio"] = 1.0 / of["kratio"]
    return found
