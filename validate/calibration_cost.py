"""Cost of a calibration beside general optimisers: runs and CPU seconds until every target is within its tolerance, on the same simulator. Fills
the section `cost` of docs/evidence/calibration.md. Runs are kept in runs/studies/calibration-cost; a stopped study is taken up by the same command.

    /usr/bin/python3 validate/calibration_cost.py [--kept] [--most 100] [SET...]

One run at a time; some 40 CPU minutes. --most: evaluations after which a general optimiser is stopped. The Bayesian optimiser needs python3-sklearn, which nothing else here does. With --kept nothing is run:
the section has the sets whose results are there.
"""
import json
import math
import sys
import time
import warnings

import numpy as np
from scipy.optimize import least_squares, minimize
from scipy.stats import norm, qmc

import calibration_page
import study

sys.path.append(str(study.ROOT))
from calibrate import command, elastic, laws, material, simulate, strength, targets  # noqa: E402

FOLDER = study.RUNS / "calibration-cost"
MOST = int(sys.argv[sys.argv.index("--most") + 1]) if "--most" in sys.argv else 100  # evaluations of a general optimiser
PACKINGS = [1, 2, 3]
ABSENT = 100.0          # tolerances by which a reading that a run does not give is off
FREE = ("modulus", "ratio", "tension", "chi")
FACTORS = {"modulus": (0.25, 4.0), "tension": (0.2, 5.0)}      # bounds over the start
BOUNDS = {"ratio": (0.02, 1.5), "chi": strength.BOUNDS["chi"]}
COLLAPSED = 1e-3, 0.01  # size of a simplex, and difference of its sums of squares, at which Nelder-Mead ends by itself
SIMPLEX, DIFFERENCE = 0.2, 0.05  # in logarithms: edge of the first simplex, step of finite differences
FIRST, CANDIDATES, LOCAL = 2 * (len(FREE) + 1), 4096, 0.05  # points of the first design; points among which the next is chosen
CYLINDER = {"specimen": {"cylinder": {"diameter": "20 mm", "height": "40 mm"}, "particles": 400}}
SMALL = {"specimen": {"cylinder": {"diameter": "20 mm", "height": "30 mm"}, "particles": 150}}
SQUARE = {"dimension": 2, "specimen": {"rectangle": {"width": "30 mm", "height": "30 mm"}, "particles": 600}}
SLENDER = {"dimension": 2, "specimen": {"rectangle": {"width": "20 mm", "height": "30 mm"}, "particles": 300,
                                               "packing": {"size_ratio": 3, "overlap": "passive"}}}


def wanted(young, poisson, compressive, kind, strength_value):
    return {"young_modulus": f"{young} GPa", "poisson_ratio": poisson, "compressive_strength": f"{compressive} MPa", kind: f"{strength_value} MPa"}


SETS = {
    "space": {**CYLINDER, "law": "linear", "targets": wanted(45, 0.19, 60, "tensile_strength", 17)},
    "plane": {**SQUARE, "law": "linear", "targets": wanted(23, 0.16, 36, "tensile_strength", 8.4)},
    "moments": {**SMALL, "law": "moments", "targets": wanted(20, 0.2, 60, "tensile_strength", 5)},
    "softening": {**SMALL, "law": "softening", "targets": wanted(20, 0.15, 40, "brazilian_strength", 6.2)},
    "uniform": {**SLENDER, "law": {"stiffness": "uniform"}, "friction": 0.8, "targets": wanted(18.7, 0.2, 80, "brazilian_strength", 11.5)},
}


class Reached(Exception):
    """All targets are within their tolerances."""


class Exhausted(Exception):
    """The evaluations of an optimiser are used up."""


class Watched(material.Material):
    """A material that notes when an evaluation of all packings first has every target within its tolerance."""

    ends, evaluations, reached, nearest = False, 0, None, math.inf

    def evaluate(self, parameters, seeds, names=None):
        found = super().evaluate(parameters, seeds, names)
        self.evaluations += 1
        if list(seeds) == PACKINGS and set(names or self.targets) == set(self.targets):
            self.nearest = min(self.nearest, max(abs(one) for one in self.residuals(found)))
            if self.nearest <= 1.0 and self.reached is None:
                self.reached = spent(self)
        if self.ends and self.reached:
            raise Reached
        if self.ends and self.evaluations >= MOST:
            raise Exhausted
        return found

    def residuals(self, evaluation):
        """Differences of the means from the targets in tolerances; of absent ones ABSENT."""
        means = {name: evaluation.mean(name) for name in self.targets}
        return [ABSENT if mean is None else min(max(self.targets[name].error(mean), -ABSENT), ABSENT) for name, mean in means.items()]


def spent(watched):
    """{runs, seconds of the runs and of `gneiss stiffness`, evaluations} so far."""
    laboratory = watched.laboratory
    return {"runs": len(laboratory.used), "seconds": sum(laboratory.seconds.values()), "evaluations": watched.evaluations}


# --- optimisers ----------------------------------------------------------------------------------------

def begin(watched):
    """The start of all of them: formulas of uniform strain and the wanted strengths, without any computation."""
    return strength.start(watched, laws.start(watched.scene, watched.modulus, watched.targets["poisson_ratio"].value, watched.size.radius))


def objective(watched, start):
    """(residuals over logarithms of the parameters relative to the start, their bounds)."""
    low, high = zip(*(np.log(np.array(BOUNDS[name]) / start[name]) if name in BOUNDS else np.log(FACTORS[name]) for name in FREE))

    def residuals(position):
        parameters = {**start, **{name: float(f"{start[name] * math.exp(x):.6g}") for name, x in zip(FREE, position)}}
        return np.array(watched.residuals(watched.evaluate(parameters, PACKINGS)))
    return residuals, np.array(low), np.array(high)


def own(watched, start):
    """The search of the program, then its intervals and checks; the elastic constants are part of it."""
    del start
    first = strength.start(watched, elastic.fit(watched, PACKINGS, print))
    result = command.solve(watched.request, strength.Search(watched, first, print))
    searched = spent(watched)
    command.examine(watched.request, result, print)
    return {"searched": searched}


def nelder_mead(watched, start):
    residuals, low, high = objective(watched, start)
    simplex = np.vstack([np.zeros(len(FREE)), SIMPLEX * np.eye(len(FREE))])
    minimize(lambda x: float(np.sum(residuals(x)**2)), simplex[0], method="Nelder-Mead", bounds=list(zip(low, high)),
             options={"initial_simplex": simplex, "maxfev": MOST, "xatol": COLLAPSED[0], "fatol": COLLAPSED[1]})
    return {}


def bayesian(watched, start):
    """Expected improvement of the logarithm of the sum of squares, of a Gaussian process with a Matern kernel of one length a parameter
    (Jones, Schonlau & Welch 1998; Snoek, Larochelle & Adams 2012), from the start and a Sobol set."""
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor, kernels

    warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound: the parameter hardly matters
    residuals, low, high = objective(watched, start)
    generator, count = np.random.default_rng(1), len(FREE)
    points = [(-low) / (high - low), *qmc.Sobol(count, seed=1).random(FIRST - 1)]
    values = [math.log(np.sum(residuals(low + x * (high - low))**2)) for x in points]
    kernel = kernels.ConstantKernel(1.0) * kernels.Matern(np.full(count, 0.3), (0.02, 20.0), nu=2.5) + kernels.WhiteKernel(1e-3, (1e-6, 1.0))
    while True:
        process = GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=2, random_state=1).fit(points, values)
        near = points[int(np.argmin(values))] + LOCAL * generator.standard_normal((CANDIDATES // 2, count))
        candidates = np.clip(np.vstack([generator.random((CANDIDATES // 2, count)), near]), 0.0, 1.0)
        mean, deviation = process.predict(candidates, return_std=True)
        gain = min(values) - mean
        scaled = gain / np.maximum(deviation, 1e-12)
        points.append(candidates[int(np.argmax(gain * norm.cdf(scaled) + deviation * norm.pdf(scaled)))])
        values.append(math.log(np.sum(residuals(low + points[-1] * (high - low))**2)))


def gauss_newton(watched, start):
    """Least squares of the residuals themselves in a trust region, slopes by finite differences."""
    residuals, low, high = objective(watched, start)
    least_squares(lambda x: residuals(x - 1.0), np.ones(len(FREE)), bounds=(low + 1.0, high + 1.0), diff_step=DIFFERENCE, max_nfev=MOST)
    return {}


PEERS = ("Nelder-Mead", "Bayesian")
METHODS = {"gneiss calibrate": own, "Nelder-Mead": nelder_mead, "Bayesian": bayesian, "least squares": gauss_newton}


# --- the study -----------------------------------------------------------------------------------------

def measured(name, method):
    """Costs of a method for a set of targets, kept in a file."""
    place = FOLDER / f"{name}-{method.split()[0].lower()}"
    path = place / "cost.json"
    if path.exists():
        return json.loads(path.read_text())
    if study.KEPT:
        raise study.Missing(f"{name}, {method}")
    place.mkdir(parents=True, exist_ok=True)
    file = place / "targets.yaml"
    file.write_text(json.dumps({**SETS[name], "seeds": len(PACKINGS)}, indent=1))
    request = targets.read(str(file))
    laboratory = simulate.Laboratory(study.PROGRAM, str(place), 1, math.inf, math.inf)
    watched = Watched(request, None if request.law == "scene" else laws.named(request.law), laboratory)
    watched.ends = METHODS[method] is not own
    begun, more = time.process_time(), {}
    try:
        more = METHODS[method](watched, begin(watched))
    except (Reached, Exhausted):
        pass
    found = {"reached": watched.reached, "whole": spent(watched), "nearest": watched.nearest, "optimiser": time.process_time() - begun, **more}
    path.write_text(json.dumps(found))
    print(name, method, found, file=sys.stderr, flush=True)
    return found


def cell(found):
    """Runs and CPU seconds until the targets were reached."""
    if found is None:
        return ""
    at = found["reached"]
    if at is None:
        at = found["whole"]
        return f"not in {at['runs']}, {at['seconds']:.0f} s (off by {found['nearest']:.1f} tolerances)"
    return f"{at['runs']}, {at['seconds']:.0f} s"


def section(names):
    rows, missing, shares = [], [], []
    for name in names:
        found = {method: study.if_there(measured, name, method) for method in METHODS}
        missing += [f"{name} by {method}" for method, one in found.items() if one is None]
        if found["gneiss calibrate"] is None:
            continue
        whole, at = found["gneiss calibrate"]["whole"], found["gneiss calibrate"]["reached"]
        text = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in SETS[name]["targets"].items())
        peers = [(found[one]["reached"] or found[one]["whole"])["runs"] for one in PEERS if found[one]]
        if at and len(peers) == len(PEERS):
            shares.append(at["runs"] / min(peers))
        rows.append([name, text, *(cell(one) for one in found.values()), f"{whole['runs']}, {whole['seconds']:.0f} s",
                     f"{shares[-1]:.2f}" if at and len(peers) == len(PEERS) else ""])
    return rows, missing, shares


def main():
    study.reported(sys.argv[1:], __doc__, ("--kept", "--most"))
    names = [one for one in sys.argv[1:] if not one.startswith("--") and not one.isdigit()]
    if set(names) - set(SETS):
        sys.exit(f"expected some of {', '.join(SETS)}, found {' '.join(names)}; --help says what they do")
    rows, missing, shares = section(names or SETS)
    if names or not shares:
        print(study.table(["set", "targets", *METHODS, "with intervals and checks", "share"], rows))
        return
    text = f"""Runs of tests and their CPU seconds until the means of three packings are within all tolerances (the default ones), one run at a time, the same
packings, scenes and kept runs. All methods begin at the same parameters (formulas of uniform strain, the wanted strengths).
`/usr/bin/python3 validate/calibration_cost.py`.

{study.table(["set", "targets", *METHODS, "gneiss calibrate with intervals and checks", "share"], rows)}

- An evaluation takes two tests of three packings, {2 * len(PACKINGS)} runs; general optimisers are stopped after at most {MOST} of them
  ("not in" so many runs). `share`: runs of
  `gneiss calibrate` over those of the better one of Nelder-Mead and the Bayesian optimiser. The largest is {max(shares):.2f}.
- General optimisers search the logarithms of four parameters: E contact and tensile strength within factors of 4 and 5 of the start, k_t/k_n from
  {BOUNDS['ratio'][0]:g} to {BOUNDS['ratio'][1]:g}, chi from {BOUNDS['chi'][0]:g} to {BOUNDS['chi'][1]:g}. They minimise the sum of squares of differences over tolerances; an absent
  reading counts as {ABSENT:g} tolerances, so that no NaN reaches them. Nelder-Mead is scipy's, from a simplex of {100 * SIMPLEX:g} %; the Bayesian optimiser is
  expected improvement on scikit-learn's Gaussian process (Matern 5/2, one length a parameter, fitted at every step to the logarithm of the sum) after
  {FIRST} points; its own fits are not in the seconds. Least squares is scipy's trust region with finite differences of {100 * DIFFERENCE:g} %: it knows each
  reading by itself, as `gneiss calibrate` does, but neither slopes nor elastic constants without runs.
- Elastic constants by `gneiss stiffness` count in the seconds and not in the runs."""
    if missing:
        text += f"\n- Without a result: {'; '.join(missing)}."
    calibration_page.put("cost", "Cost beside general optimisers", text)


if __name__ == "__main__":
    main()
