"""The study of accuracy (validate/accuracy): its quick form whole, once, and its fits alone. Speaks TAP."""
import csv

from program import *  # noqa: F403

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
STUDY = os.path.join(ROOT, "validate", "accuracy")
sys.path[:0] = [STUDY, os.path.join(ROOT, "validate")]
os.environ["GNEISS"] = PROGRAM
import fits  # noqa: E402
import run as study_run  # noqa: E402
import slopes  # noqa: E402

MADE = []


def study(folder, *arguments):
    environment = {**ENVIRONMENT, "GNEISS": PROGRAM, "MPLCONFIGDIR": folder}
    return subprocess.run([sys.executable, os.path.join(STUDY, "run.py"), "--quick", "--out", folder, *arguments], env=environment,
                          capture_output=True, text=True, timeout=500)


def quick():
    """Folder of the quick study, made by the first fact that needs it; main() removes it."""
    if not MADE:
        MADE.append(tempfile.mkdtemp(prefix="gneiss-accuracy-"))
        expect(study(MADE[0]), 0)
    return MADE[0]


def page():
    with open(os.path.join(quick(), "accuracy.md"), encoding="utf-8") as file:
        return file.read()


def part(name):
    return re.search(rf"<!-- section {name} -->\n(.*?)(?=<!-- section |\Z)", page(), re.S).group(1)


def summaries(case):
    folder = os.path.join(quick(), case, "runs")
    return {name: summary(os.path.join(folder, name)) for name in os.listdir(folder) if os.path.isdir(os.path.join(folder, name))}


@fact
def every_case_has_a_section_with_a_table_a_picture_and_when_it_was_measured(folder):
    for case in study_run.cases():
        text = part(case)
        assert text.startswith("## ") and "| --- |" in text and "Measured " in text, case
        pictures = re.findall(r"!\[[^]]*\]\((pictures/[^)]+)\)", text)
        assert pictures, case
        for name in pictures:
            with open(os.path.join(quick(), name), "rb") as file:
                assert file.read(8) == b"\x89PNG\r\n\x1a\n", name


@fact
def the_page_begins_with_the_table_of_the_cheapest_settings_and_their_picture(folder):
    text = part("overview")
    assert "| 10 % | 5 % | 2 % | 1 % |" in text
    for case in ("compression", "tension"):
        for reading in ("strength", "E"):
            for contacts in ("calibrated", "constant"):
                assert f"| {case} | {reading} | {contacts} |" in text, (case, reading, contacts)
    assert os.path.getsize(os.path.join(quick(), "pictures", "accuracy-front.png")) > 10000
    assert "nan" not in re.findall(r"[a-z]+", page().lower())


@fact
def the_numbers_of_the_page_are_those_of_the_runs(folder):
    text = part("compression")
    for name, s in summaries("compression").items():
        if s["counts"]["particles"] != 200:  # others are in the page as means over seeds
            continue
        reading = s["readings"]
        row = (f"| 1 | {reading['peak_stress'] / 1e6:.2f} | {reading['young_modulus_average'] / 1e9:.3f} | {reading['poisson_ratio']:.4f} | "
               f"{reading['peak_strain'] / 0.01:.4f} | {s['counts']['broken_tension']} / {s['counts']['broken_shear']} |")
        assert row in text, f"{name}: {row}"
        assert f" | {s['steps']} | " in text, name


@fact
def packings_of_their_own_are_means_over_the_seeds(folder):
    strengths = {}
    for s in summaries("compression").values():
        strengths.setdefault(s["counts"]["particles"], []).append(s["readings"]["peak_stress"] / 1e6)
    assert len(strengths[600]) == 2
    assert f"| 600 | 2 | {np.mean(strengths[600]):.2f} |" in part("compression")


@fact
def every_case_has_slopes_and_the_page_shows_those_of_the_file(folder):
    with open(os.path.join(quick(), "slopes.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert {row["case"] for row in rows} == set(study_run.cases())
    text = part("slopes")
    for row in rows:
        assert np.isfinite(float(row["coefficient"])) and row["form"] in slopes.FORMS, row
        assert f"| {row['case']} | {row['reading']} | {row['effect']} | {row['kind']} |" in text, row
        assert slopes.law(row) in text, row


@fact
def kept_runs_are_not_computed_again(folder):
    def state():
        return {name: os.stat(os.path.join(quick(), "collision", "runs", name, "results.h5")).st_mtime_ns for name in summaries("collision")}

    before, text = state(), part("collision")
    expect(study(quick(), "--only", "collision"), 0)
    assert state() == before and part("collision") == text


@fact
def one_case_alone_leaves_the_others_on_the_page(folder):
    before = {case: part(case) for case in study_run.cases()}
    expect(study(quick(), "--only", "wave"), 0)
    assert {case: part(case) for case in study_run.cases()} == before


@fact
def a_case_that_is_not_known_is_refused_with_those_that_are(folder):
    done = study(folder, "--only", "compresion")
    assert done.returncode == 1 and "compresion" in done.stderr and "compression, tension" in done.stderr, done.stderr


# --- fits ------------------------------------------------------------------------------------------------------

@fact
def a_power_law_is_found_again(folder):
    x = np.array([0.01, 0.03, 0.1, 0.4])
    middle, coefficient, exponent, a, b = fits.power(x, -0.2 * x**1.7)
    assert abs(exponent - 1.7) < 1e-12 and abs(coefficient - 0.2 * middle**1.7) < 1e-14 and max(a, b) < 1e-7  # roots of rounding


@fact
def a_limit_is_found_again_with_its_exponent(folder):
    x = np.array([5.0, 8, 12, 20, 33])
    limit, a, p = fits.limit(x, 200 - 900 * x**-1.5)
    assert abs(p - 1.5) <= 0.0125 + 1e-12  # half a step of the search grid
    assert abs(limit - 200) < 0.1 and abs(a / 900 - 1) < 0.05


@fact
def a_limit_undetermined_by_points_has_the_exponent_of_a_layer(folder):
    limit, a, p = fits.limit([5.0, 10, 20], [100 - 50 / 5, 100 - 50 / 10, 100 - 50 / 20])
    assert p == 1 and abs(limit - 100) < 1e-10 and abs(a - 50) < 1e-10


@fact
def halved_speeds_are_extrapolated_with_their_order(folder):
    limit, order = fits.halved([100 + 3 * v**2 for v in (0.5, 1, 2, 4)], 1e-4)
    assert abs(limit - 100) < 1e-12 and abs(order - 2) < 1e-12


@fact
def halved_speeds_that_change_nothing_have_reached_their_limit(folder):
    assert fits.halved([100.1, 99.9, 100, 104], 0.01) == (100.0, 0.0)


@fact
def the_front_holds_what_nothing_cheaper_is_better_than(folder):
    assert fits.front([(3, 0.1), (1, 0.5), (2, 0.6), (4, 0.2), (2, 0.3), (5, float("nan"))]) == [(1, 0.5), (2, 0.3), (3, 0.1)]


@fact
def measured_slopes_replace_those_of_their_case_alone(folder):
    path = slopes_path(folder)
    for case, coefficient in (("tension", 0.1), ("compression", 0.2), ("tension", 0.3)):
        s = slopes.Slopes(case)
        s.add("strength", "precision", "bias", "", "constant", coefficient)
        slopes.write(path, s.rows, ["compression", "tension"])
    assert [(row["case"], row["coefficient"]) for row in slopes.read(path)] == [("compression", "0.2"), ("tension", "0.3")]


def slopes_path(folder):
    from pathlib import Path

    return Path(folder) / "slopes.csv"


if __name__ == "__main__":
    status = main()
    for place in MADE:
        shutil.rmtree(place, ignore_errors=True)
    sys.exit(status)
