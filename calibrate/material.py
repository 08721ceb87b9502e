"""A material with one law: evaluates parameters by tests of given packings. Parameters are dicts as in laws.material_values: those of the
laws, or keys of the material where the request names them."""
import math
from dataclasses import dataclass, field

import numpy as np

from calibrate import laws, readings
from calibrate.specimens import Bench, size_of

LONGER = 2.5       # a test without a peak is repeated with an expected strength that is larger by this factor
REPEATS = 3
LINEAR = {"poisson_ratio", "bond_friction"}


def is_linear(name):
    """True for values that are compared by their difference; all others are compared by the logarithm of their ratio. Points of curves are shares of its peak."""
    return name in LINEAR or name.startswith("curve")


def scaled(name, value):
    """Coordinate in which outputs and parameters are nearly linear in each other."""
    return value if is_linear(name) else math.log(value)


def unscaled(name, coordinate):
    return float(coordinate) if is_linear(name) else math.exp(coordinate)


@dataclass
class Evaluation:
    """Values of the targets by packing, with the parameters that gave them. `values[seed][target]` is None if absent."""
    parameters: dict
    values: dict
    errors: dict = field(default_factory=dict)
    outcomes: dict = field(default_factory=dict)

    def column(self, name, seeds=None):
        """Present values of a target over the packings."""
        found = [self.values[seed].get(name) for seed in (seeds or self.values)]
        return np.array([value for value in found if value is not None])

    def mean(self, name, seeds=None):
        """Mean over the packings in the coordinates of `scaled`, as a value; None if any packing has no value."""
        found = self.column(name, seeds)
        if len(found) < len(seeds or self.values):
            return None
        return unscaled(name, np.mean([scaled(name, value) for value in found]))


class Material:
    """The scene of a request with one law, in a laboratory."""

    def __init__(self, request, law, laboratory):
        self.request, self.law, self.laboratory = request, law, laboratory
        self.scene = laws.with_law(request.scene, law) if law else request.scene
        self.size, self.flat = size_of(self.scene), laws.dimension_of(self.scene) == 2
        self.targets = request.targets
        self.modulus = self.targets["young_modulus"].value if "young_modulus" in self.targets else 20e9
        self.expected = {}

    def bench(self):
        return Bench(self.scene, self.modulus)

    def first_guess(self, test):
        """Strength of a test before any was made: that of the target, else by usual ratios of the strengths of rock."""
        value = {name: target.value for name, target in self.targets.items()}
        tension = value.get("tensile_strength", value.get("brazilian_strength"))
        compression = value.get("compressive_strength", 8.0 * tension if tension else 0.003 * self.modulus)
        for target in self.targets.values():
            if target.point and readings.of_curve(target) == test:
                return target.point.largest
        if test.kind == "triaxial":
            return compression + 3.0 * test.confinement
        return compression if test.kind == "compression" else tension or 0.1 * compression

    def _expectation(self, test, parameters):
        if test not in self.expected:
            return self.first_guess(test)
        tension, strength = self.expected[test]
        return strength * (parameters.get("tension", 1.0) / tension)

    def _measure(self, tests, parameters, seeds, expectation):
        """{(test, seed): Outcome}; tests without a peak are repeated with a longer duration."""
        bench, found = self.bench(), {}
        wanted = [(test, seed) for test in tests for seed in seeds]
        for repeat in range(REPEATS):
            scenes = [bench.build(test, parameters, expectation[test] * LONGER**repeat, seed) for test, seed in wanted]
            found.update(zip(wanted, self.laboratory.run(scenes)))
            wanted = [pair for pair in wanted if readings.strength_of(pair[0], found[pair]) is None and not found[pair].message]
            if not wanted:
                break
        return found

    def measure(self, test, parameters, seeds):
        """Strengths of packings in a test; None where there is no peak."""
        found = self._measure([test], parameters, seeds, {test: float(f"{self._expectation(test, parameters):.3g}")})
        return [readings.strength_of(test, found[test, seed]) for seed in seeds]

    def evaluate(self, parameters, seeds, names=None):
        """Evaluation of the targets (or of those named) by their tests of the packings."""
        targets = self.targets
        names = list(names or targets)
        tests = sorted({test for name in names for test in readings.tests_of(name, targets)})
        expectation = {test: float(f"{self._expectation(test, parameters):.3g}") for test in tests}
        found = self._measure(tests, parameters, seeds, expectation)
        for test in tests:
            strengths = [readings.strength_of(test, found[test, seed]) for seed in seeds]
            if None not in strengths:
                self.expected[test] = (parameters.get("tension", 1.0), float(np.mean(strengths)))
        by_seed = {seed: {test: found[test, seed] for test in tests} for seed in seeds}
        return Evaluation(dict(parameters),
                          {seed: {name: readings.value_of(name, targets, by_seed[seed], self.flat) for name in names} for seed in seeds},
                          {name: float(np.mean([readings.error_of(name, targets, by_seed[seed], self.flat) for seed in seeds])) for name in names},
                          by_seed)
