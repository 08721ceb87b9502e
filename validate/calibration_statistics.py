"""Statistics of `gneiss calibrate`: parameters drawn at random are found again from readings of other packings, and prediction intervals are
counted over fresh packings. Fills the sections `synthetic` and `coverage` of docs/evidence/calibration.md. Runs are kept in
runs/studies/calibration; a stopped study is taken up by the same command.

    /usr/bin/python3 validate/calibration_statistics.py [synthetic] [coverage] [--sets 20] [--fresh-packings 100] [--kept]

Without a name both sections are measured. With --kept nothing is run: the sections have the sets whose results are there. One run at a
time; some 50 CPU seconds for a set, and 50 for 100 fresh packings.
"""
import json
import math
import sys
from dataclasses import dataclass

import numpy as np
from scipy import stats

import calibration_page
import study

sys.path.append(str(study.ROOT))
from calibrate import laws, material, problem, simulate, targets  # noqa: E402

FLAGS = ("--sets", "--fresh-packings", "--kept")
FOLDER = study.RUNS / "calibration"
CALIBRATED, PACKINGS = 5, 20  # packings of a calibration; whose mean readings are the targets
COVERED = (0, 2, 5)     # sets whose intervals are counted over fresh packings
MORE = 20               # packings of a second interval
SUBSETS = 4000
KINDS = ("space", "space", "plane", "space", "moments")  # kinds of the sets, repeated cyclically
SPECIMENS = {"space": {"specimen": {"cylinder": {"diameter": "20 mm", "height": "40 mm"}, "particles": 400}, "law": "linear"},
             "plane": {"dimension": 2, "specimen": {"rectangle": {"width": "30 mm", "height": "30 mm"}, "particles": 600,
                                                      "packing": {"size_ratio": 3, "overlap": "passive"}}, "law": "linear"},
             "moments": {"specimen": {"cylinder": {"diameter": "20 mm", "height": "40 mm"}, "particles": 400}, "law": "moments"}}
READINGS = ("young_modulus", "poisson_ratio", "compressive_strength", "tensile_strength")
PARAMETERS = {"modulus": "E contact", "ratio": "k_t/k_n", "tension": "tensile strength", "chi": "shear/tensile", "bond_friction": "bond friction"}
RANGES = {"modulus": (10e9, 60e9), "ratio": (0.05, 0.6), "tension": (3e6, 20e6), "chi": (0.7, 2.5), "bond_friction": (0.3, 1.5)}


def option(name, default):
    return int(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else default


# --- sets ----------------------------------------------------------------------------------------------

@dataclass
class Set:
    """A kind of specimen and law with parameters drawn at random; `truth`: mean readings of packings with them."""
    number: int
    kind: str
    parameters: dict

    @property
    def folder(self):
        return FOLDER / f"set-{self.number:02d}"

    def seeds(self, use, count):
        """Seeds of packings that no other set and no other use has (those behind the calibration's are its check)."""
        first = 1000 * (self.number + 1) + {"calibration": 1, "truth": 101, "fresh": 201}[use]
        return list(range(first, first + count))


def drawn(number):
    """A set; logarithms of the parameters are uniform (of bond_friction: itself)."""
    generator, kind = np.random.default_rng([40, number]), KINDS[number % len(KINDS)]
    found = {}
    for name, ends in RANGES.items():
        low, high = (material.scaled(name, end) for end in ends)
        found[name] = float(f"{material.unscaled(name, generator.uniform(low, high)):.4g}")
    if kind != "moments":
        found["bond_friction"] = 0.0
    return Set(number, kind, found)


def confinement(wanted):
    """Confinement in Pa of the triaxial test that determines bond_friction."""
    return float(f"{0.2 * wanted['compressive_strength']:.2g}")


def targets_text(one, wanted):
    """File of targets of a set with default tolerances; `wanted`: values by reading, `triaxial` among them with moments."""
    names = {name: float(f"{wanted[name]:.8g}") for name in READINGS}
    if one.kind == "moments":
        names["triaxial"] = [{"confinement": confinement(wanted), "value": float(f"{wanted['triaxial']:.8g}")}]
    return json.dumps({**SPECIMENS[one.kind], "seeds": one.seeds("calibration", CALIBRATED), "targets": names}, indent=1) + "\n"


def material_of(one, wanted, folder):
    """The material of the calibration, with the speeds and times that follow from these readings."""
    path = one.folder / "rough.yaml"
    path.write_text(targets_text(one, wanted))
    request = targets.read(str(path))
    laboratory = simulate.Laboratory(study.PROGRAM, str(folder), 1, math.inf, math.inf)
    return material.Material(request, laws.named(request.law), laboratory)


def measured(one, wanted, seeds, folder):
    """{reading: values by packing} for a set of parameters, in the tests made for these target readings."""
    evaluation = material_of(one, wanted, folder).evaluate(one.parameters, seeds)
    return {"triaxial" if name.startswith("triaxial") else name: [evaluation.values[seed][name] for seed in seeds] for name in evaluation.values[seeds[0]]}


def means(values):
    return {name: None if None in column else material.unscaled(name, np.mean([material.scaled(name, one) for one in column]))
            for name, column in values.items()}


def truth(one):
    """{reading: values of PACKINGS packings with the drawn parameters}; a reading is None where a test has no peak."""
    def make():
        strength = 5.0 * one.parameters["tension"]
        rough = {"young_modulus": one.parameters["modulus"], "poisson_ratio": 0.2, "compressive_strength": strength,
                 "tensile_strength": one.parameters["tension"], "triaxial": 2.0 * strength}
        seeds = one.seeds("truth", PACKINGS)
        about = means(measured(one, rough, seeds[:2], one.folder / "truth"))
        if None in about.values():
            return {name: [None] for name in about}
        return measured(one, {name: float(f"{value:.2g}") for name, value in about.items()}, seeds, one.folder / "truth")
    one.folder.mkdir(parents=True, exist_ok=True)
    return study.kept(one.folder / "truth.json", make)


def calibration(one):
    """Returns calibration.json of a set; the program continues from what its folder has."""
    path, out = one.folder / "targets.yaml", one.folder / "out"
    if not study.KEPT:
        path.write_text(targets_text(one, means(truth(one))))
        done = study.call(["calibrate", str(path), "--out", str(out), "--threads", "1", "--quiet"])
        if done.returncode:
            raise study.Missing(f"{one.number} ({one.kind}): exit code {done.returncode}: {done.stderr.strip().splitlines()[-1]}")
    if not (out / "calibration.json").exists():
        raise study.Missing(str(out))
    return json.loads((out / "calibration.json").read_text())


def sets():
    """[(Set, calibration)] whose tests all have their readings, and the numbers of the others."""
    found, without, missing = [], [], []
    for number in range(option("--sets", 20)):
        one = drawn(number)
        try:
            if None in means(truth(one)).values():
                without.append(number)
                continue
            found.append((one, calibration(one)))
        except study.Missing as gone:
            missing.append(f"{number}" if study.KEPT else str(gone))
        print(f"set {number}: {one.kind}", file=sys.stderr, flush=True)
    return found, without, missing


# --- parameters found again ----------------------------------------------------------------------------

def found_parameters(result):
    """Converts the keys of the material to the parameters of the calibration."""
    value = {key: entry["value"] for key, entry in result["parameters"].items()}
    return {"modulus": value["contact_modulus"], "ratio": 1.0 / value["kratio"], "tension": value["tensile_strength"],
            "chi": value["shear_strength"] / value["tensile_strength"], "bond_friction": value.get("bond_friction", 0.0)}


def recovery(one, result):
    """{parameter: (difference from the drawn value, standard error)} in the coordinates of the covariance, the number of packings, and
    Hotelling's T2 over its 95 % quantile (None where packings are too few for so many parameters). The targets are means of packings themselves: their
    variance adds to that of the calibration."""
    names, there = result["covariance"]["of"], found_parameters(result)
    packings = min(len(entry["packings"]) for entry in result["found"].values())  # Fewer than requested if the search ends early.
    matrix = np.array(result["covariance"]["matrix"], float) * (1.0 + packings / PACKINGS)
    difference = np.array([material.scaled(name, there[name]) - material.scaled(name, one.parameters[name]) for name in names])
    whole, count = None, len(names)
    if packings > count and np.isfinite(matrix).all():
        quantile = count * (packings - 1) / (packings - count) * stats.f.ppf(0.95, count, packings - count)
        whole = float(difference @ np.linalg.solve(matrix, difference)) / quantile
    return {name: (float(d), float(v)**0.5) for name, d, v in zip(names, difference, np.diag(matrix))}, packings, whole


def synthetic():
    found, without, missing = sets()
    rows, inside = [], {name: [] for name in PARAMETERS}
    regions, each, half = [], [], []
    for one, result in found:
        differences, packings, whole = recovery(one, result)
        quantile = stats.t.ppf(0.975, packings - 1)
        simultaneous = stats.t.ppf(1.0 - 0.025 / len(differences), packings - 1)
        within = {name: abs(d) <= quantile * error for name, (d, error) in differences.items()}
        each.append(all(abs(d) <= simultaneous * error for d, error in differences.values()))
        half += [abs(d) <= stats.t.ppf(0.75, packings - 1) * error for d, error in differences.values()]
        for name, yes in within.items():
            inside[name].append(yes)
        if whole is not None:
            regions.append(whole <= 1.0)
        cells = [f"{100.0 * differences[name][0]:+.1f} ± {100.0 * quantile * differences[name][1]:.1f}{'' if within[name] else ' out'}" if name in differences
                 else "" for name in PARAMETERS]
        rows.append([one.number, one.kind, "yes" if result["reached"] else "no", result["runs"], f"{result['cpu_seconds']:.0f}", *cells,
                     "" if whole is None else f"{whole:.3f}"])
    counts = ", ".join(f"{PARAMETERS[name]} {sum(yes)} of {len(yes)}" for name, yes in inside.items() if yes)
    everything = [one for column in inside.values() for one in column]
    text = f"""Parameters are drawn at random ({'; '.join(f'{PARAMETERS[name]} {low:g} to {high:g}' for name, (low, high) in RANGES.items())};
uniform in their logarithms, bond friction in itself). Mean readings of {PACKINGS} packings with them become the targets of a calibration on
five other packings, with default tolerances; no packing is used twice. Space: cylinders of 400 particles; plane: squares of 600 discs, which overlap
without forces as spheres do by default; moments: cylinders of 400 particles, law of bonds
with moments and friction, with a triaxial test beside the others. `/usr/bin/python3 validate/calibration_statistics.py synthetic`.

Found minus drawn, in per cent (bond friction: hundredths), with the half-width of the 95 % interval. Both are those of the difference:
the targets scatter as means of {PACKINGS} packings, so the stated variance is multiplied by 1 + 5/{PACKINGS}. The last column is Hotelling's T2
of all parameters over its 95 % quantile: below 1 is inside the region. It needs more packings than parameters, and with only one more the quantile is
some thousand, so that this region excludes little: simultaneous intervals (Bonferroni) and the intervals of 50 % exclude more.

{study.table(['set', 'kind', 'reached', 'runs', 'CPU s', *PARAMETERS.values(), 'T2'], rows)}

- Single intervals hold in {sum(everything)} of {len(everything)} cases ({counts}); 95 % of them are {0.95 * len(everything):.0f}.
- Intervals of 50 % hold in {sum(half)} of {len(half)} cases; half of them are {0.5 * len(half):g}.
- All parameters of a set at once: within the joint region in {sum(regions)} of {len(regions)} sets, within simultaneous intervals (Bonferroni)
  in {sum(each)} of {len(each)}."""
    if without:
        text += f"\n- Without calibration, as a test of the drawn parameters has no peak: sets {', '.join(map(str, without))}."
    if missing:
        text += f"\n- Without a result: sets {'; '.join(missing)}."
    return "Parameters found again", text


# --- prediction intervals ------------------------------------------------------------------------------

def fresh(one, result, count):
    """{reading: values} of fresh packings with the found parameters, in the tests of the calibration."""
    found = Set(one.number, one.kind, found_parameters(result))
    return study.kept(one.folder / f"fresh-{count}.json", lambda: measured(found, means(truth(one)), one.seeds("fresh", count), one.folder / "fresh"))


def of_subsets(name, values, count, generator):
    """Mean share of all other values that the prediction interval of `count` random ones holds."""
    values, shares = np.array([material.scaled(name, one) for one in values]), []
    quantile = stats.t.ppf(0.975, count - 1) * math.sqrt(1.0 + 1.0 / count)
    for _ in range(SUBSETS):
        order = generator.permutation(len(values))
        some, others = values[order[:count]], values[order[count:]]
        shares.append(np.mean(np.abs(others - some.mean()) <= quantile * some.std(ddof=1)))
    return shares


def entry_of(result, name):
    return next(entry for key, entry in result["found"].items() if key == name or key.startswith(name))


def coverage():
    count, rows, missing, held = option("--fresh-packings", 100), [], [], []
    generator = np.random.default_rng(41)
    for number in COVERED:
        one = drawn(number)
        try:
            result = calibration(one)
            values = fresh(one, result, count)
        except study.Missing:
            missing.append(number)
            continue
        for name, column in values.items():
            entry = entry_of(result, name)
            low, high = entry["prediction"]
            present = [value for value in column if value is not None]
            shares = [of_subsets(name, present + entry["packings"], packings, generator) for packings in (len(entry["packings"]), MORE)]
            rows.append([number, one.kind, name, f"{100.0 * np.std(present, ddof=1) / np.mean(present):.1f}",
                         f"{100.0 * np.std(entry['packings'], ddof=1) / np.mean(entry['packings']):.1f}",
                         f"{sum(low <= value <= high for value in present)} of {count}",
                         *(cell for one in shares for cell in (f"{100.0 * np.mean(one):.1f}", f"{100.0 * np.mean([0.9 <= share <= 0.99 for share in one]):.0f}"))])
            held.append([np.mean(one) for one in shares])
    spans = [f"{100.0 * np.mean(column):.1f} % ({100.0 * min(column):.1f} to {100.0 * max(column):.1f})" for column in zip(*held)] or ["-", "-"]
    text = f"""The 95 % prediction interval of each reading (five packings) and the readings of {count} fresh packings with the found parameters.
`/usr/bin/python3 validate/calibration_statistics.py coverage`.

{study.table(['set', 'kind', 'reading', 'scatter, %', 'of the five, %', 'inside', 'five at random, %', '90 to 99, %', f'{MORE} at random, %', '90 to 99, %'], rows)}

An interval from five packings holds 95 % of new ones on average over calibrations, not in each of them: its width follows a standard deviation
with four degrees of freedom. The last columns therefore form {SUBSETS} intervals, each from five (or {MORE}) of all these packings at random, and count
the others: the mean share inside, and how many of these intervals hold 90 to 99 %. With normal scatter the latter is 33 % for five packings, 60 %
for ten, 82 % for twenty: an interval that by itself is to hold 90 to 99 % takes `--seeds {MORE}`. Averages over readings and sets:
{spans[0]} from five, {spans[1]} from {MORE}. Intervals from five packings at random hold fewer than 95 % where readings are skewed: in the plane some packings bend, which
lowers E, Poisson's ratio and strength together.
"""
    study.KEPT = True
    found, _, _ = sets()  # Only those that exist.
    inside = [(entry["fresh"]["inside"], len(entry["fresh"]["values"])) for _, result in found for entry in result["found"].values() if "fresh" in entry]
    text += f"\nThe checks of all {len(found)} calibrations on three fresh packings each: {sum(a for a, _ in inside)} of {sum(b for _, b in inside)} " \
            f"readings are inside ({100.0 * sum(a for a, _ in inside) / max(1, sum(b for _, b in inside)):.1f} %)."
    if missing:
        text += f"\n\nNot run: sets {', '.join(map(str, missing))}."
    return "Prediction intervals", text


SECTIONS = {"synthetic": synthetic, "coverage": coverage}


def main(arguments):
    study.reported(arguments, __doc__, FLAGS)
    names = calibration_page.named(arguments, SECTIONS)
    try:
        for name in names:
            calibration_page.put(name, *SECTIONS[name]())
    except problem.Problem as trouble:
        sys.exit(str(trouble))


if __name__ == "__main__":
    main(sys.argv[1:])
