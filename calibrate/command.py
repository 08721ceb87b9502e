"""The command `gneiss calibrate`: reads targets, tries laws, finds parameters, and writes what it found."""
import argparse
import fcntl
import json
import os
import re
import sys
import time
from dataclasses import dataclass, field

from calibrate import elastic, laws, output, schema, strength, targets, uncertainty
from calibrate.material import Material
from calibrate.problem import OutOfBudget, Problem
from calibrate.readings import BRAZILIAN, COMPRESSION, TENSION, tests_for
from calibrate.simulate import Laboratory, kept_runs

SURE_RATIO = 4.5      # compressive over tensile strength that brittle bonds reach in any packing of spheres
SCATTER = 0.08        # scatter of one packing's ratio of strengths
FRESH = 3             # packings of the check
ERRORS = {1: "internal error", 2: "input error", 3: "file error", 4: "out of memory", 5: "unstable run", 6: "interrupted"}  # kind of error by exit code
OF_A_RUN = ("results.h5", "summary.json")


@dataclass
class Result:
    """Parameters found with one law, and how they were examined."""
    material: Material
    search: strength.Search
    evaluation: object
    reached: bool = False
    notes: list = field(default_factory=list)
    covariance: object = None
    slopes: object = None
    fresh: object = None
    other: object = None


def threads_of(text):
    """Number of the option --threads, as that of a scene; 0 stands for all cores."""
    if text == "auto":
        return 0
    if not re.fullmatch("[0-9]{1,4}", text) or int(text) > 1024:
        raise Problem(f"--threads: expected a whole number in [0, 1024] or 'auto', found '{text}'")
    return int(text)


def options_of(arguments):
    """Options of the command; a value may begin with a minus."""
    arguments = list(arguments)
    for name in ("--program", "--out", "--seeds", "--threads"):
        if name in arguments[:-1]:
            place = arguments.index(name)
            arguments[place:place + 2] = [f"{name}={arguments[place + 1]}"]
    parser = argparse.ArgumentParser(prog="gneiss calibrate", allow_abbrev=False)
    parser.add_argument("target")
    parser.add_argument("--program", default=os.environ.get("GNEISS_PROGRAM", "gneiss"))
    parser.add_argument("--out")
    parser.add_argument("--seeds")
    parser.add_argument("--threads", default="0")
    parser.add_argument("--force", action="store_true")
    parser.add_argument("--quiet", action="store_true")
    return parser.parse_args(arguments)


class Progress:
    """A line for each step on standard error, with the runs so far."""

    def __init__(self, laboratory, quiet):
        self.laboratory, self.quiet, self.begun = laboratory, quiet, time.monotonic()

    def __call__(self, text):
        if not self.quiet:
            seconds = time.monotonic() - self.begun
            print(f"[{seconds:6.0f} s, {len(self.laboratory.used):3d} runs] {text}", file=sys.stderr, flush=True)


# --- laws ----------------------------------------------------------------------------------------------

def wanted_ratio(wanted):
    """Compressive over tensile strength of the targets; None if either is not wanted."""
    tensile = wanted.get("tensile_strength", wanted.get("brazilian_strength"))
    return wanted["compressive_strength"].value / tensile.value if tensile and "compressive_strength" in wanted else None


def largest_ratio(material, parameters, seed):
    """Compressive over tensile strength of one packing whose bonds are much stronger in shear than in tension; None if the test has no peak."""
    tensile = "tensile_strength" if "tensile_strength" in material.targets else "brazilian_strength"
    found = material.evaluate({**parameters, "chi": strength.BOUNDS["chi"][1]}, [seed], ["compressive_strength", tensile]).values[seed]
    if found["compressive_strength"] is None or found[tensile] is None:
        return None
    return found["compressive_strength"] / found[tensile]


def candidates(request):
    """Laws in the order in which they are tried; None: as the base scene has it."""
    if request.law == "scene":
        return [None]
    if request.law != "auto":
        return [laws.named(request.law)]
    frictional = "bond_friction" in strength.free_parameters(request.targets)
    return [law for law in laws.LAWS if frictional or law.name != "friction"]  # without pressure strong bonds break only in tension


def lacking_ratio(request, material, start, progress):
    """(a sentence if the bonds of a law do not reach the wanted ratio of strengths, else "", the largest ratio)."""
    ratio, law = wanted_ratio(request.targets), material.law
    if ratio is None or ratio < SURE_RATIO:
        return "", 0.0
    most = largest_ratio(material, start, request.seeds[0])
    progress(f"law {law.name}: compressive over tensile strength at most {'unknown' if most is None else f'{most:.3g}'}, wanted {ratio:.3g}")
    if most is not None and most * (1.0 + SCATTER) >= ratio:
        return "", most
    return f"law {law.name} ({law.text}): compressive over tensile strength is at most about {most or 0.0:.3g}, wanted {ratio:.3g}", most or 0.0


def lacking_targets(search):
    """A sentence on the targets that a few packings of a law do not reach, "" if there are none."""
    law, nearest = search.material.law, search.best()
    if search.met(nearest):
        return ""
    away = []
    for name, residual in search.residuals(nearest).items():
        if residual is None:
            away.append(f"{name} absent")
        elif abs(residual) > 1.0:
            mean, wanted = nearest.mean(name), search.targets[name].value
            away.append(f"{name} {100.0 * (mean / wanted - 1.0):+.3g} %")
    return f"law {law.name} ({law.text}): two packings do not reach the targets: {', '.join(away)}"


def choose(request, laboratory, progress):
    """(Search, [sentence on each law that was left out]): the first law that reaches the wanted ratio of strengths, and the strengths under
    pressure; else the one that is nearest."""
    tried, best = [], None
    for law in candidates(request):
        material = Material(request, law, laboratory)
        start = strength.start(material, elastic.fit(material, request.seeds, progress))
        search = strength.Search(material, start, progress)
        if request.law != "auto":
            return search, tried
        lacking, most = lacking_ratio(request, material, start, progress)
        rank = (1, -most)
        if not lacking:
            if not any(map(strength.is_confined, request.targets)):
                return search, tried
            try:
                search.approach(request.seeds)
            except OutOfBudget:
                return search if best is None or best[0][0] == 1 else best[1], tried
            lacking, rank = lacking_targets(search), (0, search.misfit(search.best()))
            if not lacking:
                return search, tried
            progress(lacking)
        tried.append(lacking)
        if best is None or rank < best[0]:
            best = (rank, search)
    name = best[1].material.law.name
    return best[1], [one for one in tried if not (best[0][0] == 0 and one.startswith(f"law {name} "))]


# --- one law -------------------------------------------------------------------------------------------

def solve(request, search):
    """Result with the parameters of one law; it says why a target is not reached."""
    result = Result(search.material, search, None)
    try:
        search.approach(request.seeds)
        result.evaluation = search.run(request.seeds)
    except OutOfBudget as end:
        if not search.steps:
            raise Problem(f"budget of {end}: expected at least one evaluation of the targets, found no run finished within it") from end
        result.evaluation = search.best()
        result.notes.append(f"the budget of {end} is used up: parameters are the best ones found so far")
    search.parameters = dict(result.evaluation.parameters)
    residuals = search.residuals(result.evaluation)
    result.reached = all(one is not None and abs(one) <= 1.0 for one in residuals.values())
    result.notes += [why for name, one in residuals.items() if one is None or abs(one) > 1.0 for why in reasons(search, result, name)]
    return result


def shown(value, target):
    return output.with_unit(value, "" if target.unit == "1" else target.unit)


def reasons(search, result, name):
    """Sentences on a target that is not reached."""
    mean, target = result.evaluation.mean(name), search.targets[name]
    if mean is None:
        absent = next((text for by_test in result.evaluation.outcomes.values() for one in by_test.values() for text in [one.message, *one.absent.values()] if text), "")
        return [f"{name}: a run has no such reading: {absent}"]
    if name in search.off:
        return [f"{name}: no concave envelope meets the wanted strengths within their tolerances: found {shown(mean, target)}, "
                f"wanted {shown(target.value, target)}"]
    parameters, law = result.evaluation.parameters, laws.label(search.material.law)
    chi = parameters.get("chi", 1.0)
    low, high = strength.BOUNDS["chi"]
    if name in ("tensile_strength", "brazilian_strength", "compressive_strength") and wanted_ratio(search.targets) and "chi" in search.free and not low * 1.02 < chi < high / 1.02:
        ratio = (result.evaluation.mean("compressive_strength") or mean) / (result.evaluation.mean("tensile_strength") or result.evaluation.mean("brazilian_strength") or mean)
        bound = "at most" if chi > 1.0 else "at least"
        return [f"{name}: not reachable with the law {law}: compressive over tensile strength is {bound} {ratio:.3g}, wanted {wanted_ratio(search.targets):.3g}"]
    ends = [f"{'friction' if parameters[key] < 0.0 else key} at the end of the range" for key in search.free
            if key not in ("modulus", "tension") and name in search.given_up(result.evaluation) and search.ends_at(parameters[key], key)]
    why = f"not reachable with the law {law}: {' and '.join(ends)}" if ends else "not reached"
    if not ends and len(search.free) < len(search.targets):
        why = f"not reached: {len(search.free)} parameters ({', '.join(search.free)}) for {len(search.targets)} targets"
    return [f"{name}: {why}: found {shown(mean, target)}, wanted {shown(target.value, target)}"]


def alternatives(request, result, progress):
    """Sentences on the other laws that could reach the wanted ratio of strengths, by one packing of each."""
    law, ratio, found = result.material.law, wanted_ratio(request.targets), []
    if law is None or ratio is None or request.law == "auto" or not any("compressive over tensile strength is at most" in one for one in result.notes):
        return []
    try:
        for other in laws.LAWS[laws.NAMES.index(law.name) + 1:]:
            if other.name == "friction":
                continue
            material = Material(request, other, result.material.laboratory)
            start = strength.start(material, elastic.fit(material, request.seeds[:1], progress))
            most = largest_ratio(material, start, request.seeds[0])
            if most:
                found.append(f"law {other.name} ({other.text}): compressive over tensile strength up to about {most:.3g}")
    except OutOfBudget:
        pass
    return found


def examine(request, result, progress):
    """Adds slopes, covariance and checks on fresh packings and on a test that was not fitted, as far as the budget goes."""
    search, evaluation, seeds = result.search, result.evaluation, request.seeds
    result.slopes = search.slopes
    try:
        if not search.by_key:  # otherwise the search has measured them
            result.slopes = uncertainty.measured_slopes(search, evaluation, seeds[:strength.SCOUTS])
        fresh = [max(seeds) + 1 + k for k in range(min(FRESH, len(seeds)))]
        progress(f"check on {len(fresh)} fresh packings")
        result.fresh = result.material.evaluate(evaluation.parameters, fresh)
        fitted = tests_for(request.targets)
        spare = [test for test in (COMPRESSION, TENSION, BRAZILIAN) if test not in fitted]
        if spare:
            progress(f"check on a test that was not fitted: {spare[0].name}")
            result.other = spare[0], result.material.measure(spare[0], evaluation.parameters, seeds[:strength.SCOUTS])
    except OutOfBudget as end:
        result.notes.append(f"the budget of {end} is used up: checks are incomplete")
    result.notes += alternatives(request, result, progress)
    result.covariance = uncertainty.covariance(search, evaluation, result.slopes)


def calibrate(request, laboratory, progress):
    """(Result, [sentence on each law that was left out])."""
    search, tried = choose(request, laboratory, progress)
    result = solve(request, search)
    examine(request, result, progress)
    return result, tried


# --- the program ---------------------------------------------------------------------------------------

def refuse_other_files(folder):
    """Problem if a folder holds a run, or the results of a calibration without its runs: these may be another's files."""
    others = OF_A_RUN if kept_runs(folder) else OF_A_RUN + output.FILES
    for name in others:
        if os.path.exists(os.path.join(folder, name)):
            raise Problem(f"{os.path.join(folder, name)}: expected a new folder or that of a calibration, found this file (--force replaces files)", 3)


def folder_of(options):
    stem = os.path.splitext(os.path.basename(options.target))[0]
    folder = options.out or os.path.join("runs", stem)
    if not options.force:
        refuse_other_files(folder)
    try:
        os.makedirs(folder, exist_ok=True)
        lock = open(os.path.join(folder, ".lock"), "w", encoding="utf-8")
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise Problem(f"{folder}: expected a folder that no other calibration uses, found a running one", 3) from error
    except OSError as error:
        raise Problem(f"{folder}: cannot be written: {error.strerror}", 3) from error
    return folder, lock


def work(options):
    request = targets.read(options.target)
    threads = threads_of(options.threads)
    if options.seeds is not None:
        request.seeds = targets.seeds_of(options.seeds)
    folder, lock = folder_of(options)
    with lock:
        laboratory = Laboratory(options.program, folder, threads or len(os.sched_getaffinity(0)), request.most_runs, request.most_seconds)
        if options.force:
            laboratory.forget()
        result, tried = calibrate(request, laboratory, Progress(laboratory, options.quiet))
        whole = output.write(folder, request, laboratory, result, tried)
    output.show(folder, whole)


def main(arguments):
    if arguments == ["--schema"]:
        print(json.dumps(schema.schema(), indent=1))
        return 0
    options = options_of(arguments)
    try:
        work(options)
    except Problem as problem:
        print(f"gneiss: {ERRORS[problem.code]}: {problem}", file=sys.stderr)
        return problem.code
    except OutOfBudget as end:
        print(f"gneiss: input error: budget of {end}: used up before the targets were evaluated", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("gneiss: interrupted: the same command continues", file=sys.stderr)
        return 6
    except OSError as error:
        print(f"gneiss: file error: {error}", file=sys.stderr)
        return 3
    return 0
