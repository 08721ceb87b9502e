"""Intervals of readings and parameters from the scatter of packings, with the errors of single runs."""
import math

import numpy as np
from scipy import linalg, stats

from calibrate import elastic
from calibrate.material import scaled, unscaled

LEVEL = 0.95
NORMAL = stats.norm.ppf(0.5 + 0.5 * LEVEL)  # error budgets of runs are errors in 95 of 100
DIFFERENCE = {"chi": 0.25, "bond_friction": 0.3, "ratio": 0.1}  # steps of finite differences, in scaled coordinates
OF_A_KEY = 0.25  # step for all other parameters
LEAST = 3             # packings of an interval: the quantile of two is 12.7
NEGLIGIBLE = 0.01     # smallest change that is listed of a combination whose largest is about 1
SMALLEST_SLOPE = 1e-4  # smallest slope relative to the largest: a parameter with a smaller effect on readings is not determined


def within(interval, low, high):
    """An interval without its part outside of [low, high], None if it has no end there."""
    clipped = [min(max(end, low), high) for end in interval]
    return clipped if all(map(math.isfinite, clipped)) else None


def student(count):
    """Quantile of Student's t for a two-sided interval of LEVEL from `count` values; infinite for one."""
    return float(stats.t.ppf(0.5 + 0.5 * LEVEL, count - 1)) if count > 1 else math.inf


def _half_width(values, share):
    """t s sqrt(share) of values with the standard deviation s; infinite for one value."""
    return student(len(values)) * float(np.std(values, ddof=1)) * math.sqrt(share) if len(values) > 1 else math.inf


def interval_of_mean(values, centre, error=0.0):
    """[low, high] of the mean of packings about `centre`; `error`: possible error of a single reading, added as a square."""
    half = math.hypot(_half_width(values, 1.0 / len(values)), error)
    return [centre - half, centre + half]


def prediction(values, centre):
    """[low, high] between which the same test reads a new packing: t s sqrt(1 + 1/P) about the mean. Errors of the test are in both."""
    half = _half_width(values, 1.0 + 1.0 / len(values))
    return [centre - half, centre + half]


def measured_slopes(search, evaluation, seeds):
    """d outputs/d parameters in scaled coordinates by finite differences on common packings. Derivatives by modulus and tension follow from similarity:
    E and strengths are proportional to them. `ratio` acts on the elastic constants alone: its effect on strengths is that found by the search."""
    slopes, material = search.slopes.copy(), search.material
    for column, parameter in enumerate(search.free):
        if parameter in ("modulus", "tension"):
            slopes[:, column] = search.prior[:, column]
        elif parameter == "ratio":
            _elastic_slopes(search, evaluation, seeds, slopes, column)
        else:
            names = [name for name in search.names if search.by_key or name not in ("young_modulus", "poisson_ratio")]
            names = [name for name in names if search.prior[search.names.index(name), column] != 0.0]
            moved, step = dict(evaluation.parameters), DIFFERENCE.get(parameter, OF_A_KEY)
            here = scaled(parameter, moved[parameter])
            if here + step > scaled(parameter, search.limits[parameter][1]):
                step = -step
            moved[parameter] = unscaled(parameter, here + step)
            there = material.evaluate(moved, seeds, names)
            for name in names:
                pair = there.mean(name), evaluation.mean(name, seeds)
                if None not in pair:
                    slopes[search.names.index(name), column] = (scaled(name, pair[0]) - scaled(name, pair[1])) / step
    return slopes


def _elastic_slopes(search, evaluation, seeds, slopes, column):
    there = [{**evaluation.parameters, "ratio": evaluation.parameters["ratio"] * math.exp(step)} for step in (0.0, DIFFERENCE["ratio"])]
    pairs = [np.array(elastic.constants(search.material, parameters, seeds)) for parameters in there]
    changes = {"young_modulus": np.mean(np.log(pairs[1][:, 0] / pairs[0][:, 0])), "poisson_ratio": np.mean(pairs[1][:, 1] - pairs[0][:, 1])}
    for name, change in changes.items():
        if name in search.names:
            slopes[search.names.index(name), column] = change / DIFFERENCE["ratio"]


def sensitivity(search, evaluation, slopes):
    """(indices of outputs, indices of parameters, weights of the outputs, weighted slopes [outputs, parameters]) without outputs that are absent or given
    up and without parameters at a bound."""
    away = search.given_up(evaluation)
    present = [k for k, name in enumerate(search.names) if evaluation.mean(name) is not None and name not in away]
    moving = [k for k, name in enumerate(search.free) if not search.ends_at(evaluation.parameters[name], name)]
    weight = search.weights()[present]
    return present, moving, weight, weight[:, None] * slopes[np.ix_(present, moving)]


def undetermined(search, evaluation, slopes):
    """[{parameter: change in scaled coordinates}]: combinations of parameters that no output depends on to first order, the null space of the slopes. Each
    has the change 1 in a parameter that the others leave as it is, chosen by a QR decomposition with pivots; changes below NEGLIGIBLE are left out."""
    _, moving, _, matrix = sensitivity(search, evaluation, slopes)
    if not moving:
        return []
    basis = linalg.null_space(matrix, rcond=SMALLEST_SLOPE) if len(matrix) else np.eye(len(moving))
    if not basis.size:
        return []
    pivots = linalg.qr(basis.T, mode="r", pivoting=True)[1][:basis.shape[1]]
    changes = basis @ np.linalg.inv(basis[pivots])
    return [{search.free[moving[k]]: float(change) for k, change in enumerate(one) if abs(change) > NEGLIGIBLE} for one in changes.T]


def covariance(search, evaluation, slopes):
    """Covariance of the parameters in scaled coordinates, J^-1 (S/P + E) J^-T: S that of the outputs over P packings, E the squares of what
    all packings share: errors of the test, and the distance that is left to the targets. With more outputs than parameters J^-1 is that of the
    weighted least squares of the search. Parameters at a bound count as given, and outputs that they keep from their targets are left out. A
    parameter that no output determines has an infinite variance. None if nothing is left."""
    present, moving, weight, matrix = sensitivity(search, evaluation, slopes)
    names = [search.names[k] for k in present]
    if not names or not moving:
        return None
    table = np.array([[scaled(name, value) for value in evaluation.column(name)] for name in names])
    count = table.shape[1]
    scatter = np.atleast_2d(np.cov(table)) / count if count > 1 else np.full((len(names),) * 2, np.nan)
    for k, name in enumerate(names):
        value = evaluation.mean(name)
        error = evaluation.errors.get(name, 0.0) / NORMAL
        left = scaled(name, value) - scaled(name, search.targets[name].value)
        scatter[k, k] += (error if scaled(name, 1.0) == 1.0 else error / value)**2 + left**2
    inverse = np.linalg.pinv(matrix, rcond=SMALLEST_SLOPE) * weight
    found = inverse @ scatter @ inverse.T
    unknown = np.linalg.norm(np.eye(len(moving)) - np.linalg.pinv(matrix, rcond=SMALLEST_SLOPE) @ matrix, axis=0) > 1e-6
    found[unknown, :] = found[:, unknown] = math.inf
    whole = np.zeros((len(search.free),) * 2)
    whole[np.ix_(moving, moving)] = found
    return whole


def variance_of(covariance, gradient):
    """Variance of a sum of parameters with these factors."""
    used = np.flatnonzero(gradient)
    return float(gradient[used] @ covariance[np.ix_(used, used)] @ gradient[used])


def region(parameters, count):
    """Hotelling's 95 % quantile of d' Cov^-1 d for some parameters at once, from `count` packings (Hotelling 1931); infinite if there are too
    few packings."""
    if count <= parameters:
        return math.inf
    return parameters * (count - 1) / (count - parameters) * float(stats.f.ppf(LEVEL, parameters, count - parameters))


def interval_of(name, value, variance, count):
    """[low, high] of a parameter with this variance in scaled coordinates, from `count` packings."""
    half = student(count) * math.sqrt(variance) if variance >= 0.0 else math.inf
    if half > 100.0:
        return [-math.inf if scaled(name, 1.0) == 1.0 else 0.0, math.inf]
    return [unscaled(name, scaled(name, value) - half), unscaled(name, scaled(name, value) + half)]
