"""Values of targets from the readings of tests of one packing."""
import math

import numpy as np
from scipy.optimize import nnls

from calibrate import curves
from calibrate.specimens import Test

ENVELOPE = (0.1, 0.2, 0.4)  # confinements of an envelope over the compressive strength, beside the test without confinement
COMPRESSION, TENSION, BRAZILIAN = Test("compression"), Test("tension"), Test("brazilian")
_PLAIN = {
    "young_modulus": (COMPRESSION, "young_modulus"), "poisson_ratio": (COMPRESSION, "poisson_ratio"),
    "compressive_strength": (COMPRESSION, "peak_stress"), "crack_initiation_stress": (COMPRESSION, "crack_initiation_stress"),
    "tensile_strength": (TENSION, "peak_stress"), "brazilian_strength": (BRAZILIAN, "indirect_tensile_strength"),
}
MODULUS = {False: "young_modulus", True: "young_modulus_average"}
OF_ENVELOPE = ("friction_angle", "m_i")


def _place(name, flat):
    """(test, reading) of a target. In 2D the modulus is over the average strain: few discs touch a platen, and its ends are soft."""
    test, reading = _PLAIN[name]
    return test, MODULUS[flat] if name == "young_modulus" else reading


def confined(pressure):
    return Test("triaxial", pressure)


def envelope_tests(targets):
    """Tests of the envelope: those of the target `triaxial` if there are three, else at fractions of the compressive strength."""
    given = sorted(target.confinement for target in targets.values() if target.confinement)
    if len(given) < 3:
        given = [float(f"{part * targets['compressive_strength'].value:.3g}") for part in ENVELOPE]
    return [COMPRESSION] + [confined(pressure) for pressure in given]


def of_curve(target):
    """The test of a curve, which continues to the end of the curve."""
    point = target.point
    return Test("triaxial" if point.confinement else "compression", point.confinement, point.last)


def tests_of(name, targets):
    """The tests that are needed for the value of a target."""
    if name in OF_ENVELOPE:
        return envelope_tests(targets)
    target = targets[name]
    if target.point:
        return [of_curve(target)]
    return [confined(target.confinement)] if target.confinement else [_PLAIN[name][0]]


def tests_for(targets):
    """All tests of the targets, in a fixed order."""
    return sorted({test for name in targets for test in tests_of(name, targets)})


def main_test(targets):
    """The test of the specimen whose scene a calibration hands out: compression if it is among the tests, else that of the first target."""
    return COMPRESSION if COMPRESSION in tests_for(targets) else tests_of(next(iter(targets)), targets)[0]


def off_envelopes(targets):
    """Names of the strengths in compression that no concave envelope fits within their tolerances: least squares of s0 + sum d_k min(p, p_k) over the
    confinements p_k, d_k >= 0, which represents all concave polylines with corners at the given confinements."""
    line = {name: target for name, target in targets.items() if target.confinement or name == "compressive_strength"}
    if len(line) < 4:
        return []
    pressure, value, tolerance = np.array([(one.confinement, one.value, one.tolerance) for one in line.values()]).T
    table = np.column_stack([np.ones(len(line))] + [np.minimum(pressure, one) for one in pressure if one > 0.0])
    fit = table @ nnls(table / tolerance[:, None], value / tolerance)[0]
    return [name for name, off in zip(line, np.abs(fit - value) > tolerance) if off]


def friction_angle(confinement, strength):
    """Coulomb's angle in degrees of a line through axial strengths over confinements: slope K = (1 + sin phi)/(1 - sin phi)."""
    slope = np.polyfit(confinement, strength, 1)[0]
    return math.degrees(math.asin((slope - 1.0) / (slope + 1.0))) if slope > 0.0 else None


def hoek_brown_mi(confinement, strength):
    """m_i of Hoek & Brown (1980), (s1 - s3)^2 = m_i s_ci s3 + s_ci^2, a line fitted by least squares."""
    slope, square = np.polyfit(confinement, (np.asarray(strength) - confinement)**2, 1)
    return slope / math.sqrt(square) if square > 0.0 else None


def strength_of(test, outcome):
    """The strength that sets the speed of a test; None if the run has no peak. Tests up to a given strain need none."""
    if test.strain:
        return outcome.reading("largest_stress")
    return outcome.reading("indirect_tensile_strength" if test.kind == "brazilian" else "peak_stress")


def _envelope(name, targets, outcomes):
    tests = envelope_tests(targets)
    strengths = [outcomes[test].reading("axial_strength" if test.confinement else "peak_stress") for test in tests]
    if None in strengths:
        return None
    fit = friction_angle if name == "friction_angle" else hoek_brown_mi
    return fit(np.array([test.confinement for test in tests]), np.array(strengths))


def value_of(name, targets, outcomes, flat=False):
    """Value of a target from {test: Outcome} of one packing; None if it is absent."""
    if name in OF_ENVELOPE:
        return _envelope(name, targets, outcomes)
    if targets[name].point:
        outcome, point = outcomes[of_curve(targets[name])], targets[name].point
        stress = None if outcome.message else curves.stress_at(outcome.folder, point.strain)
        return None if stress is None else stress / point.largest
    if targets[name].confinement:
        return outcomes[confined(targets[name].confinement)].reading("axial_strength")
    test, reading = _place(name, flat)
    value = outcomes[test].reading(reading)
    return value if value is None or value > 0.0 or name == "poisson_ratio" else None


def error_of(name, targets, outcomes, flat=False):
    """Possible error of a value by its run's budget (speed, step, rows, round-off), without packings; 0 if the run has none."""
    if name in OF_ENVELOPE or targets[name].confinement or targets[name].point:
        return 0.0
    test, reading = _place(name, flat)
    return outcomes[test].errors.get(reading, 0.0)
