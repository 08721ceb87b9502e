"""Parameters that give the wanted strengths: steps in the logarithms of parameters and readings on common packings. A step is the bounded
least squares solution of a linear model, whose slopes are those of similarity and uniform strain, corrected by all evaluations so far."""
import math

import numpy as np
from scipy.optimize import lsq_linear

from calibrate import elastic, laws, readings, uncertainty
from calibrate.material import scaled, unscaled

PARAMETERS = ("modulus", "ratio", "tension", "chi", "bond_friction")
BOUNDS = {"modulus": (1e-3, 1e15), "ratio": elastic.RATIO, "tension": (1e-6, 1e15), "chi": (0.3, 10.0),
          "bond_friction": (-laws.LOWERING * laws.FRICTION, 4.0)}  # the lowest one is 0 if friction is given
START_CHI, START_FRICTION = 2.0, 0.5
SCOUTS = 2                # packings of the first steps
MOST_STEPS = 8
ACCEPTED, OUTNUMBERED = 1.0 / 3.0, 0.75  # share of a tolerance at which the search ends, with enough parameters and with fewer than targets
NEAR = 0.05               # distance from the targets, with the packings of SCOUTS, below which all packings are used
PATIENCE, GAIN = 3, 0.9   # steps without a sum of squares below this part of the least one end a search
LARGEST_STEP = 1.2        # largest step of a logarithm, or of bond_friction
LARGEST_OF_KEYS = 0.5     # limit for keys of the material, whose slopes follow only from differences of this size
PRIORITY = 10.0           # weight of elastic constants and strengths in compression over all others
NOISE, SMOOTH_NOISE = 0.03, 0.003  # noise of the logarithm of a strength, because of single breaks; of elastic constants
REACH = 0.7               # distance in scaled coordinates over which an evaluation loses weight
MOVE = 0.5                # largest change due to noise, in scaled coordinates
LEAST_DOUBT = 0.1         # standard deviation of prior slopes: half of them, at least this
CONFINED_SLOPE = 0.15     # addition to the slope of ln strength over ln chi under pressure
LEAST_SLOPE = 0.02        # keeps the sign of a slope that breaks of single bonds hide
STRENGTHS = ("compressive_strength", "tensile_strength", "brazilian_strength", "crack_initiation_stress")
ELASTIC = ("young_modulus", "poisson_ratio")
FRICTIONAL = ("friction_angle", "m_i")
LINE = 3                  # strengths over pressure that determine chi and bond_friction without a tensile strength


def free_parameters(targets):
    """The parameters that the targets determine, in the order of PARAMETERS."""
    tensile = "tensile_strength" in targets or "brazilian_strength" in targets
    pressures = sum(1 for target in targets.values() if target.confinement)
    pressures += len({target.point.confinement for target in targets.values() if target.point and target.point.confinement})
    compressive = pressures + ("compressive_strength" in targets or any(target.point and not target.point.confinement for target in targets.values()))
    confined = any(name in targets for name in FRICTIONAL) or pressures > 0
    free = {"modulus": "young_modulus" in targets, "ratio": "poisson_ratio" in targets, "tension": tensile or compressive,
            "chi": compressive and tensile or compressive >= LINE, "bond_friction": confined}
    return [name for name in PARAMETERS if free[name]]


def limits_of(material):
    """{parameter: (lowest, highest)} of a material."""
    if material.request.parameters:
        return {name: (low, high) for name, (low, high, _) in material.request.parameters.items()}
    low, high = BOUNDS["bond_friction"]
    given = "friction" in material.request.scene["materials"][0] or material.law is None
    return {**BOUNDS, "bond_friction": (0.0 if given else low, material.law.most_friction if material.law else high)}


def priority(name):
    return PRIORITY if name in (*ELASTIC, "compressive_strength") or name.startswith("triaxial") else 1.0



def prior_slopes(names, free, dimension, ratio, law):
    """d output/d parameter in scaled coordinates, [outputs, parameters]: similarity, uniform strain, and usual slopes of a law."""
    young, poisson = elastic.slopes(dimension, ratio)
    angle, compression = law.friction_slopes
    table = {("young_modulus", "modulus"): 1.0, ("young_modulus", "ratio"): young, ("poisson_ratio", "ratio"): poisson}
    for name in names:
        confined, curve = name.startswith("triaxial"), name.startswith("curve")
        if curve:  # the slope is between that of a modulus and that of a strength
            table.update({(name, "modulus"): 0.5, (name, "tension"): 0.5, (name, "chi"): 0.5 * law.slope, (name, "bond_friction"): 0.5 * angle})
        if confined or name in STRENGTHS:
            table[name, "tension"] = 1.0
        if confined or name == "compressive_strength":
            table[name, "chi"] = law.slope + CONFINED_SLOPE * confined
        if confined or name in FRICTIONAL or name == "compressive_strength":
            table[name, "bond_friction"] = angle if name in FRICTIONAL else compression + angle * confined
    return np.array([[table.get((name, parameter), 0.0) for parameter in free] for name in names])


def is_confined(name):
    """True if the value of a target takes tests under pressure."""
    return name in FRICTIONAL or name.startswith("triaxial") or name.startswith("curve") and "MPa" in name


class Search:
    """Steps towards the targets of a material from given parameters; `steps` lists the evaluations for the report."""

    def __init__(self, material, parameters, progress, targets=None):
        self.material, self.progress = material, progress
        self.targets = targets or material.targets
        self.by_key = bool(material.request.parameters)  # parameters are keys of the material, without usual slopes
        self.names, self.free = list(self.targets), list(material.request.parameters) or free_parameters(self.targets)
        self.parameters = dict(parameters)
        if self.by_key:
            self.slopes = np.ones((len(self.names), len(self.free)))
        else:
            self.slopes = prior_slopes(self.names, self.free, laws.dimension_of(material.scene), parameters["ratio"],
                                       material.law or laws.LAWS[0])
        self.prior = self.slopes.copy()
        self.limits, self.off = limits_of(material), readings.off_envelopes(self.targets)
        self.steps = []
        self.aims = np.array([scaled(name, self.targets[name].value) for name in self.names])
        self.allowed = np.array([abs(scaled(name, target.value + 0.5 * target.tolerance) - scaled(name, target.value - 0.5 * target.tolerance))
                                 for name, target in self.targets.items()])

    # --- coordinates -----------------------------------------------------------------------------------

    def position(self, parameters):
        return np.array([scaled(name, parameters[name]) for name in self.free])

    def at(self, position):
        return {**self.parameters, **{name: float(f"{unscaled(name, x):.6g}") for name, x in zip(self.free, position)}}

    def bounds(self):
        low, high = zip(*(self.limits[name] for name in self.free))
        return tuple(np.array([scaled(name, value) for name, value in zip(self.free, side)]) for side in (low, high))

    def outputs(self, evaluation, seeds=None):
        """Means over packings in scaled coordinates; NaN for a reading that any of them does not give."""
        means = [evaluation.mean(name, seeds) for name in self.names]
        return np.array([math.nan if mean is None else scaled(name, mean) for name, mean in zip(self.names, means)])

    # --- steps -----------------------------------------------------------------------------------------

    def model(self):
        """(expected outputs at the present evaluation, slopes) of a line through all evaluations on the packings of the first, near ones
        with more weight: least squares with the prior slopes as further observations. Single values scatter by NOISE."""
        now, seeds = self.steps[-1], list(self.steps[0].values)
        moved = np.array([self.position(step.parameters) - self.position(now.parameters) for step in self.steps])
        found = np.array([self.outputs(step, seeds) for step in self.steps])
        centre, slopes = np.full(len(self.names), math.nan), self.prior.copy()
        weight = np.exp(-0.5 * np.sum((moved / REACH)**2, axis=1))
        for k, name in enumerate(self.names):
            known = np.isfinite(found[:, k])
            if not known.any():
                continue
            noise = SMOOTH_NOISE if name in ELASTIC else NOISE
            table = np.column_stack([np.ones(known.sum()), moved[known]]) * (np.sqrt(weight[known]) / noise)[:, None]
            values = found[known, k] * np.sqrt(weight[known]) / noise
            doubt = np.maximum(0.5 * np.abs(self.prior[k]), LEAST_DOUBT)
            prior = np.column_stack([np.zeros(len(self.free)), np.diag(1.0 / doubt)])
            solution = np.linalg.lstsq(np.vstack([table, prior]), np.concatenate([values, self.prior[k] / doubt]), rcond=None)[0]
            centre[k], slopes[k] = solution[0], solution[1:]
        weak = (self.prior != 0.0) & (slopes * np.sign(self.prior) < LEAST_SLOPE * np.abs(self.prior))
        slopes[weak] = (LEAST_SLOPE * self.prior)[weak]
        whole = [step for step in self.steps if len(step.values) > len(seeds)]
        if whole:  # packings that were added later differ from the first by the same ratio
            centre = centre + np.mean([self.outputs(step) - self.outputs(step, seeds) for step in whole], axis=0)
        return centre, slopes

    def weights(self):
        """Weights of the outputs in the least squares."""
        return np.array([priority(name) for name in self.names]) / self.allowed

    def step(self, evaluation):
        """The next position: least squares of the residuals in tolerances, those of high priority first, within bounds."""
        centre, self.slopes = self.model()
        residual = centre - self.aims
        known = np.isfinite(residual)
        weight = self.weights()
        position, (low, high) = self.position(evaluation.parameters), self.bounds()
        largest = LARGEST_OF_KEYS if self.by_key else LARGEST_STEP
        low, high = np.maximum(low, position - largest), np.minimum(high, position + largest)
        matrix = (self.slopes * weight[:, None])[known]
        aim = -(residual * weight)[known]
        steady = 1e-3  # among equal solutions the shortest step
        if len(self.names) > len(self.free):  # changes due to noise stay below MOVE
            steady = NOISE / MOVE * float(np.median(weight))
        solution = lsq_linear(np.vstack([matrix, steady * np.eye(len(self.free))]), np.concatenate([aim, np.zeros(len(self.free))]),
                              bounds=(low - position - 1e-12, high - position + 1e-12))
        return self.at(np.clip(position + solution.x, low, high))

    def residuals(self, evaluation, names=None):
        """{target: difference of the mean from its value in tolerances}; None where it is absent."""
        means = {name: evaluation.mean(name) for name in (self.names if names is None else names)}
        return {name: None if mean is None else self.targets[name].error(mean) for name, mean in means.items()}

    def given_up(self, evaluation):
        """The targets that are not reached because the parameters that move them are at bounds. The compressive strength is always reached, by
        similarity."""
        found, residuals = set(), self.residuals(evaluation)
        for name, residual in residuals.items():
            if residual is None or abs(residual) <= 1.0 or name in ("young_modulus", "compressive_strength"):
                continue
            column = zip(self.free, self.prior[self.names.index(name)])
            moving = [(parameter, slope) for parameter, slope in column if slope and parameter not in ("modulus", "tension")]
            if name in self.off or moving and all(-np.sign(slope * residual) in self.ends_at(evaluation.parameters[parameter], parameter) for parameter, slope in moving):
                found.add(name)
        if "chi" in self.free and {"tensile_strength", "brazilian_strength"} & set(self.names):
            ends = self.ends_at(evaluation.parameters["chi"], "chi")
            found |= {name for name in ("tensile_strength", "brazilian_strength") if name in self.names and residuals[name] is not None
                      and ((1 in ends and residuals[name] > 1.0) or (-1 in ends and residuals[name] < -1.0))}
        return found

    def ends_at(self, value, parameter):
        """{1}: the parameter is at its upper bound, {-1}: at the lower one."""
        low, high = self.limits[parameter]
        return ({-1} if value <= low + 0.01 * abs(low) + 1e-9 else set()) | ({1} if value >= high / 1.01 else set())

    def accepted(self, evaluation):
        """True if every target that is not given up is well within its tolerance, or within half a standard error of its mean."""
        given_up = self.given_up(evaluation)
        share = OUTNUMBERED if len(self.names) - len(given_up) > len(self.free) else ACCEPTED
        for name, residual in self.residuals(evaluation).items():
            column = evaluation.column(name)
            noise = float(np.std(column, ddof=1)) / math.sqrt(len(column)) if len(column) > 1 else 0.0
            allowed = max(share, 0.5 * noise / self.targets[name].tolerance)
            if name not in given_up and (residual is None or abs(residual) > allowed):
                return False
        return True

    def cost(self, evaluation, away):
        """(number of absent readings, sum of squares that steps reduce) without the targets in `away`."""
        residuals = self.residuals(evaluation, [name for name in self.names if name not in away])
        present = {name: one for name, one in residuals.items() if one is not None}
        return len(residuals) - len(present), sum((priority(name) * one)**2 for name, one in present.items())

    def best(self):
        """The evaluation on the most packings that is nearest to the targets, but for those given up at the end."""
        most, away = max(len(one.values) for one in self.steps), self.given_up(self.steps[-1])
        return min((one for one in self.steps if len(one.values) == most), key=lambda one: self.cost(one, away))

    def near(self, evaluation):
        """True if targets that are not given up are so near that all packings should be evaluated."""
        given_up = self.given_up(evaluation)
        offs = np.abs(self.outputs(evaluation) - self.aims)
        return all(off < max(NEAR, 0.5 * allowed) for name, off, allowed in zip(self.names, offs, self.allowed) if name not in given_up)

    def met(self, evaluation):
        """True if every strength is as near as a few packings can show. Laws hardly differ in the elastic constants that they reach."""
        offs = np.abs(self.outputs(evaluation) - self.aims)
        return all(off <= max(NEAR, allowed) for name, off, allowed in zip(self.names, offs, self.allowed)
                   if name not in ELASTIC and name not in self.off)

    def misfit(self, evaluation):
        """Root of the mean square of the residuals in tolerances; infinite if a reading is absent."""
        residuals = self.residuals(evaluation).values()
        return math.inf if None in residuals else math.sqrt(np.mean([one**2 for one in residuals]))

    def stuck(self, parameters, following):
        """True if the next step would change nothing: bounds are reached, or no step reduces the residuals."""
        return bool(np.all(np.abs(self.position(parameters) - self.position(following)) < 2e-3))

    def idle(self):
        """True if the last steps on as many packings have not come nearer: with this law the targets contradict each other."""
        count = len(self.steps[-1].values)
        away = self.given_up(self.steps[-1])
        costs = [self.cost(one, away) for one in self.steps if len(one.values) == count]
        if len(costs) <= PATIENCE:
            return False
        absent, least = min(costs[:-PATIENCE])
        return min(costs[-PATIENCE:]) > (absent, GAIN * least)

    def approach(self, seeds):
        """Brings a few packings near the targets, once; first near those without pressure, whose tests are shorter. Keys of the material have
        the slopes of finite differences at their start."""
        plain = {name: target for name, target in self.targets.items() if not is_confined(name)}
        if self.steps or len(plain) == len(self.targets) and not self.by_key:
            return
        if self.by_key:
            self.slopes = self.prior = uncertainty.measured_slopes(self, self.advance(seeds[:SCOUTS]), seeds[:SCOUTS])
            self.parameters = self.step(self.steps[-1])
        elif plain:
            first = Search(self.material, self.parameters, self.progress, plain)
            first.scout(seeds)
            self.parameters = first.parameters
        self.scout(seeds)

    def scout(self, seeds):
        """Steps until a few packings are near the targets, or a step changes nothing; `parameters` are those of the next step."""
        for _ in range(MOST_STEPS):
            self.advance(seeds[:SCOUTS])
            following = self.step(self.steps[-1])
            done = self.near(self.steps[-1]) or self.stuck(self.parameters, following) or self.idle()
            self.parameters = following
            if done:
                break

    def advance(self, seeds):
        """Evaluates the present parameters."""
        self.steps.append(self.material.evaluate(self.parameters, seeds, self.names))
        self.progress(self.describe(self.steps[-1]))
        return self.steps[-1]

    def run(self, seeds):
        """The best evaluation on all packings."""
        everyone = len(seeds) <= SCOUTS or bool(self.steps)
        for _ in range(MOST_STEPS):
            evaluation = self.advance(seeds if everyone else seeds[:SCOUTS])
            if everyone and (self.accepted(evaluation) or self.idle()):
                break
            following = self.step(evaluation)
            if self.stuck(self.parameters, following):
                if everyone:
                    break
                everyone = True
                continue
            everyone = everyone or self.near(evaluation)
            self.parameters = following
        return self.best()

    def describe(self, evaluation):
        """A line on an evaluation: parameters and means."""
        shown = [f"{name} {self.parameters[name]:.4g}" for name in self.free]
        found = []
        for name in self.names:
            mean = evaluation.mean(name)
            scale, unit = (1e6, " MPa") if self.targets[name].unit == "Pa" else (1.0, "")
            found.append(f"{name} {'absent' if mean is None else f'{mean / scale:.4g}{unit}'}")
        return f"{len(evaluation.values)} packings: {', '.join(shown)}: {', '.join(found)}"


def start(material, parameters):
    """Adds strengths to elastic parameters: the tensile one from the targets by that of packed spheres, and chi in the middle."""
    if material.request.parameters:
        return parameters
    values = {name: target.value for name, target in material.targets.items()}
    tension = values.get("tensile_strength", values.get("brazilian_strength", values.get("compressive_strength", 0.003 * material.modulus) / 6.0))
    if laws.stiffness_of(material.scene) == "uniform":
        tension *= 2.0 * material.size.radius if laws.dimension_of(material.scene) == 2 else 4.0 * material.size.radius**2
    friction = material.law.bond_friction if material.law else laws.units.number(material.scene["materials"][0].get("bond_friction", 0.0), "1")
    if "bond_friction" in free_parameters(material.targets):
        friction = min(START_FRICTION, limits_of(material)["bond_friction"][1])
    return {**parameters, "tension": tension, "chi": START_CHI, "bond_friction": friction}
