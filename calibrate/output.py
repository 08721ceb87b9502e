"""Files and summary of a calibration: calibration.json, calibrated.yaml, report.html."""
import json
import math
import os

import numpy as np
import yaml

from calibrate import laws, report, strength, uncertainty
from calibrate.targets import FREE
from calibrate.material import is_linear
from calibrate.readings import main_test, strength_of
from calibrate.simulate import write_whole

PHYSICAL = {"poisson_ratio": (0.0, 0.5), "friction_angle": (0.0, 90.0)}  # ranges of readings; of all others: above 0
PARAMETERS = {"ratio": "k_t/k_n", "chi": "the shear strength over the tensile strength of bonds"}  # names in sentences
CHANGE = 0.1  # change of a logarithm (of bond_friction: of itself) in sentences on undetermined combinations
FILES = ("calibration.json", "calibrated.yaml", "report.html")
# Scene key: parameters whose scaled coordinates add up to that of the key, with their signs.
ORIGINS = {
    "contact_modulus": {"modulus": 1}, "young": {"modulus": 1}, "normal_stiffness": {"modulus": 1}, "kratio": {"ratio": -1}, "beta": {"ratio": 1},
    "tensile_strength": {"tension": 1}, "bond_tension_limit": {"tension": 1}, "shear_strength": {"tension": 1, "chi": 1},
    "bond_shear_limit": {"tension": 1, "chi": 1}, "bond_friction": {"bond_friction": 1},
    "friction": {"bond_friction": 1.0 / laws.LOWERING},
}


def finite(value):
    """A value that JSON can hold: None for what is no number or infinite."""
    if isinstance(value, (list, tuple)):
        return [finite(one) for one in value]
    return float(value) if value is not None and math.isfinite(value) else None


def parameters_of(result):
    """{scene key: value, unit, 95 % interval or None, free}."""
    free, count = result.search.free, len(result.evaluation.values)
    limits = strength.limits_of(result.material)
    bounds = limits if result.search.by_key else {"bond_friction": (0.0, limits["bond_friction"][1]), "friction": (0.0, laws.FRICTION)}
    found = {}
    for key, value in laws.material_values(result.material.scene, result.evaluation.parameters).items():
        origin = {key: 1} if key in free else ORIGINS.get(key)
        gradient = np.array([(origin or {}).get(name, 0) for name in free], float)
        is_free = bool(np.any(gradient))
        interval = None
        if is_free and result.covariance is not None and count >= uncertainty.LEAST:
            name = "bond_friction" if "bond_friction" in origin else "tension"
            variance = uncertainty.variance_of(result.covariance, gradient)
            if variance != 0.0:  # 0: at a bound
                interval = uncertainty.within(uncertainty.interval_of(name, value, variance, count), *bounds.get(key, (-math.inf, math.inf)))
        found[key] = {"value": value, "unit": FREE[key][0] if FREE[key][0] != "1" else "", "interval": interval, "free": is_free}
    return found


def found_of(result):
    """{target: wanted and found value, intervals, packings, reached}."""
    found = {}
    for name, target in result.search.targets.items():
        mean, column = result.evaluation.mean(name), result.evaluation.column(name)
        error = result.evaluation.errors.get(name, 0.0)
        entry = {"target": target.value, "tolerance": target.tolerance, "unit": "" if target.unit == "1" else target.unit, "value": finite(mean),
                 "interval": None, "prediction": None, "error": error, "packings": finite(list(column)),
                 "reached": mean is not None and abs(target.error(mean)) <= 1.0}
        if mean is not None and len(column) >= uncertainty.LEAST:
            physical = PHYSICAL.get(name, (0.0, math.inf))
            entry["interval"] = uncertainty.within(uncertainty.interval_of_mean(column, mean, error), *physical)
            entry["prediction"] = uncertainty.within(uncertainty.prediction(column, mean), *physical)
        if result.fresh:
            fresh = list(result.fresh.column(name))
            low, high = entry["prediction"] or [None, None]
            entry["fresh"] = {"values": finite(fresh), "inside": None if low is None else int(sum(low <= one <= high for one in fresh))}
        found[name] = entry
    return found


def change_text(name, change):
    """Words for a change of a parameter in scaled coordinates."""
    amount = f"{abs(change):.2g}" if is_linear(name) else f"{100.0 * abs(math.expm1(change)):.2g} %"
    return f"{name} is {amount} {'larger' if change > 0.0 else 'smaller'}"


def undetermined_notes(result, parameters):
    """Sentences on combinations of parameters that the targets do not determine, and on keys whose intervals are the ranges that were given.
    `parameters`: those of `parameters_of`."""
    notes = []
    for one in uncertainty.undetermined(result.search, result.evaluation, result.slopes):
        changes = [change_text(name, CHANGE * change) for name, change in sorted(one.items(), key=lambda pair: -abs(pair[1]))]
        notes.append(f"not determined by the targets: to first order none of them changes if {', '.join(changes[:-1])}{' and ' * (len(changes) > 1)}{changes[-1]}")
    ranges = result.material.request.parameters
    whole = [name for name in ranges if (parameters[name]["interval"] or [None]) == list(ranges[name][:2])]
    if whole:
        notes.append(f"the targets leave the whole range that was given for {', '.join(whole)}")
    return notes


def bound_notes(result):
    """Sentences on parameters at an end of their range, where they count as given."""
    search, notes = result.search, []
    for name in search.free:
        value = result.evaluation.parameters[name]
        for side in sorted(search.ends_at(value, name)):
            key, limit = PARAMETERS.get(name, name), search.limits[name][side > 0]
            if name == "bond_friction" and value < 0.0:
                key, limit = "friction", laws.FRICTION + limit / laws.LOWERING
            notes.append(f"{key} is at the {'upper' if side > 0 else 'lower'} end of its range, {limit:.4g}: it counts as given")
    return notes


def document(request, laboratory, result, tried):
    """All of calibration.json."""
    law, free = result.material.law, result.search.free
    few = ["intervals need at least three packings"] if len(request.seeds) < uncertainty.LEAST else []
    path = [{"parameters": step.parameters, "packings": len(step.values), "found": {name: finite(step.mean(name)) for name in request.targets}}
            for step in result.search.steps]
    other, parameters = None, parameters_of(result)
    if result.other:
        other = {"test": result.other[0].name, "strengths": finite(result.other[1]), "unit": "Pa"}
    return {"version": laboratory.version, "title": request.title, "law": laws.label(law), "law_text": law.text if law else "", "tried": tried,
            "reached": result.reached, "notes": result.notes + few + bound_notes(result) + undetermined_notes(result, parameters), "runs": len(laboratory.used), "cpu_seconds": sum(laboratory.seconds.values()),
            "seeds": request.seeds, "parameters": parameters, "found": found_of(result), "other_test": other,
            "covariance": {"of": free, "coordinates": "logarithms; bond_friction itself", "packings": len(result.evaluation.values),
                           "values": [result.evaluation.parameters[name] for name in free],
                           "limits": [finite(result.search.limits[name]) for name in free],
                           "region": finite(uncertainty.region(len(free), len(result.evaluation.values))),
                           "matrix": None if result.covariance is None else finite(result.covariance.tolist())},
            "slopes": {"of": result.search.names, "over": free, "matrix": finite(result.slopes.tolist())}, "path": path}


def scene_of(request, result):
    """The scene of the main test of the first packing, as it was run."""
    test = main_test(request.targets)
    with open(os.path.join(result.evaluation.outcomes[request.seeds[0]][test].folder, "scene.yaml"), encoding="utf-8") as file:
        scene = json.load(file)
    scene["run"].pop("threads")
    return {"title": request.title or f"Calibrated by gneiss: {test.name}", **scene}


def scene_text(request, found, scene):
    """YAML of the scene, with what it was calibrated for as comments."""
    lines = ["# Written by gneiss calibrate. Mean readings of the packings with these parameters, and targets:"]
    for name, entry in found.items():
        value = "absent" if entry["value"] is None else f"{entry['value']:.5g}"
        lines.append(f"# {name}: {value} for {entry['target']:.5g} {entry['unit']}".rstrip() + ("" if entry["reached"] else " (not reached)"))
    return "\n".join(lines) + "\n" + yaml.safe_dump(scene, sort_keys=False, default_flow_style=None, width=120)


def write(folder, request, laboratory, result, tried):
    """Writes the three files; each is there in full or not at all."""
    whole = document(request, laboratory, result, tried)
    write_whole(os.path.join(folder, "calibrated.yaml"), scene_text(request, whole["found"], scene_of(request, result)))
    curves = [(test.name, outcome.folder) for test, outcome in result.evaluation.outcomes[request.seeds[0]].items() if strength_of(test, outcome)]
    write_whole(os.path.join(folder, "report.html"), report.page(whole, curves))
    write_whole(os.path.join(folder, "calibration.json"), json.dumps(whole, indent=1))
    return whole


def with_unit(value, unit):
    """A value as it is printed: stresses in MPa, moduli in GPa."""
    if value is None:
        return "absent"
    if unit == "Pa":
        return f"{value / 1e9:.4g} GPa" if abs(value) >= 1e9 else f"{value / 1e6:.4g} MPa"
    return f"{value:.4g} {unit}".rstrip()


def interval_text(entry):
    """The 95 % interval of a reading or parameter as it is printed, "-" if there is none."""
    return ", 95 %: " + (" .. ".join(with_unit(one, entry["unit"]) for one in entry["interval"]) if entry["interval"] else "-")


def checks(whole):
    """Lines on the fresh packings and on the test that was not fitted, as far as there are any."""
    fresh, other, lines = [one["fresh"] for one in whole["found"].values() if "fresh" in one], whole["other_test"], []
    if fresh:
        count, values = max(len(one["values"]) for one in fresh), sum(len(one["values"]) for one in fresh)
        known = all(one["inside"] is not None for one in fresh)
        share = f"{sum(one['inside'] for one in fresh)} of {values} readings inside the prediction intervals" if known else "no prediction intervals"
        lines.append(f"check with {count} fresh packing{'s' if count > 1 else ''}: {share}")
    if other:
        lines.append(f"check with a test that was not fitted: strength in {other['test']} "
                     + ", ".join(with_unit(one, other["unit"]) for one in other["strengths"]))
    return lines


def show(folder, whole):
    """The result on standard output."""
    print(f"law {whole['law']}: " + ("all targets are reached" if whole["reached"] else "not all targets are reached"))
    for sentence in whole["tried"] + whole["notes"]:
        print("  " + sentence)
    for name, entry in whole["found"].items():
        print(f"  {name:24s} {with_unit(entry['value'], entry['unit']):>12s} for {with_unit(entry['target'], entry['unit'])}" + interval_text(entry))
    for name, entry in whole["parameters"].items():
        print(f"  {name:24s} {with_unit(entry['value'], entry['unit']):>12s}" + (interval_text(entry) if entry["free"] else ""))
    for line in checks(whole):
        print("  " + line)
    print(f"{whole['runs']} runs, {whole['cpu_seconds']:.0f} CPU seconds; written to {folder}: {', '.join(FILES)}")
