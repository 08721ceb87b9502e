"""Slopes, limits and floors from measured points."""
import numpy as np


def clean(*columns):
    columns = [np.asarray(c, float) for c in columns]
    keep = np.all([np.isfinite(c) for c in columns], axis=0)
    return [c[keep] for c in columns]


def line(x, y):
    """y = a + b x by least squares: a, b and their standard errors (not a number below three points)."""
    x, y = clean(x, y)
    if len(x) < 2 or np.ptp(x) == 0:
        return (float("nan"),) * 4
    basis = np.column_stack([np.ones_like(x), x])
    (a, b), *_ = np.linalg.lstsq(basis, y, rcond=None)
    if len(x) < 3:
        return a, b, float("nan"), float("nan")
    variance = np.sum((y - a - b * x) ** 2) / (len(x) - 2)
    error = np.sqrt(np.diag(variance * np.linalg.inv(basis.T @ basis)))
    return a, b, *error


def power(x, y):
    """|y| = coefficient (x / middle)^exponent, middle the geometric mean of the x, where both are independent: middle, both, and their
    standard errors, of the coefficient relative."""
    x, y = clean(x, np.abs(np.asarray(y, float)))
    keep = (x > 0) & (y > 0)
    x, y = x[keep], y[keep]
    middle = np.exp(np.mean(np.log(x))) if len(x) else float("nan")
    a, b, a_error, b_error = line(np.log(x / middle), np.log(y))
    return middle, np.exp(a), b, a_error, b_error


STEEPEST, FLATTEST, LAYER = 3.0, 0.5, 1.0


def one_limit(x, y, p):
    basis = np.column_stack([np.ones_like(x), -(x ** -p)])
    found, *_ = np.linalg.lstsq(basis, y, rcond=None)
    return np.sum((y - basis @ found) ** 2), found[0], found[1], p


def limit(x, y, fixed=None):
    """Fits y = limit - a x^-p and returns limit, a, p. The exponent is found by search; it is 1, as for a layer at
    the surface, if the points do not determine it."""
    x, y = clean(x, y)
    if len(np.unique(x)) < 2:
        return (y.mean() if len(y) else float("nan")), float("nan"), float("nan")
    if fixed is None and len(np.unique(x)) > 3:
        best = min((one_limit(x, y, p) for p in np.linspace(FLATTEST, STEEPEST, 101)), key=lambda found: found[0])
        if FLATTEST < best[3] < STEEPEST:
            return best[1:]
    return one_limit(x, y, fixed or LAYER)[1:]


def limit_spread(x, groups, draws=200):
    """Limit, coefficient and exponent of the means of `groups` (values of every seed), their standard errors when the seeds are drawn
    again, and whether the exponent was assumed."""
    rng = np.random.default_rng(1)
    groups = [clean(g)[0] for g in groups]
    keep = [k for k, g in enumerate(groups) if len(g)]
    x, groups = np.asarray(x, float)[keep], [groups[k] for k in keep]
    whole = limit(x, [g.mean() for g in groups])
    again = [limit(x, [rng.choice(g, len(g)).mean() for g in groups]) for _ in range(draws)]
    return whole, np.nanstd(again, axis=0), whole[2] == LAYER


def halved(values, noise):
    """Limit and order of values at steps (or speeds) that double from one to the next, the finest first; `noise` is
    the difference of two values by chance. The mean of the first values if they differ by no more than that (order
    0: converged); otherwise Richardson's extrapolation of the first three, with order 1 if they do not determine
    it."""
    values = clean(values)[0]
    if not len(values):
        return float("nan"), float("nan")
    same = 1
    while same < len(values) and abs(values[same] - values[0]) <= noise * abs(values[0]):
        same += 1
    if same > 1 or len(values) < 2:
        return values[:same].mean(), 0.0
    first, ratio = values[1] - values[0], 2.0
    if len(values) > 2 and 2**FLATTEST < (values[2] - values[1]) / first < 2**STEEPEST:
        ratio = (values[2] - values[1]) / first
    return values[0] - first / (ratio - 1), np.log2(ratio)


def scatter(values):
    """Coefficient of variation of a sample."""
    values = clean(values)[0]
    return values.std(ddof=1) / abs(values.mean()) if len(values) > 1 else float("nan")


def front(points):
    """The points (seconds, error, ...) that no cheaper point improves on, cheapest first."""
    best, kept = np.inf, []
    for point in sorted(points, key=lambda p: (p[0], p[1])):
        if np.isfinite(point[1]) and point[1] < best:
            best = point[1]
            kept.append(point)
    return kept
