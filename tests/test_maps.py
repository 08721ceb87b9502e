"""The dimensionless maps (data/maps.csv): fresh runs give the same rows, and calibrate/maps.py reads and interpolates them. Speaks TAP."""
import csv
from pathlib import Path

from program import *  # noqa: F403

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir)
sys.path[:0] = [os.path.join(ROOT, "validate"), ROOT]
os.environ["GNEISS"] = PROGRAM
import maps_study  # noqa: E402
from calibrate import maps  # noqa: E402

NAMES = ("young", "poisson", "compression", "tension", "brazilian")


def stored():
    with open(maps.DATA, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def at(rows, **wanted):
    """The rows with these cells."""
    return [row for row in rows if all(row[key] == maps_study.text_of(value) for key, value in wanted.items())]


def same_as_stored(folder, dimension, test, point):
    """Fresh runs with the first two seeds give the stored cells, digit for digit."""
    maps_study.FOLDER = Path(folder)
    rows = maps_study.rows_of("fresh", dimension, [point], (1, 2), (test,))
    kept = stored()
    for row in rows:
        match = at(kept, **{key: row[key] for key in (*maps.KEYS, "seed")})
        assert len(match) == 1, f"{len(match)} rows of {point}"
        assert test in row and f"{test}_broken" in row, sorted(row)
        for column, value in row.items():
            assert match[0][column] == maps_study.text_of(value), f"{column}: stored {match[0][column]}, now {maps_study.text_of(value)}"


@fact
def a_fresh_compression_test_of_spheres_gives_the_stored_row(folder):
    same_as_stored(folder, 3, "compression", maps_study.BASE)


@fact
def a_fresh_tension_test_of_discs_gives_the_stored_row(folder):
    same_as_stored(folder, 2, "tension", {**maps_study.BASE, "rho_k": 1.0, "chi": 20.0})


@fact
def a_fresh_brazilian_test_with_friction_of_bonds_gives_the_stored_row(folder):
    same_as_stored(folder, 2, "brazilian", {**maps_study.BASE, "law": "bond_friction", "bond_friction": 1.0, "rho_k": 0.2})


@fact
def every_point_of_the_study_has_a_row_for_each_seed_and_all_columns(folder):
    rows = stored()
    assert tuple(rows[0]) == maps_study.COLUMNS
    points = [{**point, "dimension": dimension} for of in maps_study.PARTS.values() for dimension in (2, 3) for point in of(dimension)]
    assert len(rows) == len(points) * len(maps_study.SEEDS)
    for point in points:
        assert len(at(rows, **point)) == len(maps_study.SEEDS), point
    empty = [(row["law"], column) for row in rows for column, cell in row.items() if cell == ""]
    assert not empty, empty[:5]


@fact
def no_point_has_a_seed_twice(folder):
    """Means over packings would hide a doubled row."""
    keys = [tuple(row[key] for key in (*maps.KEYS, "seed")) for row in stored()]
    assert len(set(keys)) == len(keys)


@fact
def interpolation_gives_the_means_at_the_points_of_the_maps(folder):
    table = maps.Maps()
    for dimension in (2, 3):
        for name in NAMES:
            for rho, chi, mu in ((0.0, 1.0, 0.0), (0.2, 1.0, 0.5), (0.6, 7.0, 0.5), (1.0, 20.0, 0.5), (0.35, 4.0, 3.0)):
                exact, found = table.mean(name, "linear", dimension, rho, chi, mu), table.measure(name, "linear", dimension, rho, chi, mu)
                assert abs(found / exact - 1) < 1e-12, (dimension, name, rho, chi, mu, exact, found)
            for law, keys in table.laws(dimension):
                exact = table.mean(name, law, dimension, 0.2, 10.0, 0.5, keys)
                found = table.measure(name, law, dimension, 0.2, 10.0, 0.5, **keys)
                assert abs(found / exact - 1) < 1e-12, (dimension, law, keys, exact, found)


@fact
def a_start_has_the_wanted_poisson_ratio_and_strength_ratio(folder):
    table = maps.Maps()
    for dimension, law, keys in ((3, "linear", {}), (2, "linear", {}), (3, "bond_friction", {"bond_friction": 0.7})):
        for test in ("tension", "brazilian"):
            low = table.start(law, dimension, 0.15, 1e-3, test=test, **keys)
            high = table.start(law, dimension, 0.15, 1e9, test=test, **keys)
            wanted = 0.5 * (low.ratio + high.ratio)
            start = table.start(law, dimension, 0.15, wanted, test=test, **keys)
            assert start.reached and not start.reason and low.chi < start.chi < high.chi, (low, start, high)
            assert abs(start.ratio / wanted - 1) < 0.01 and abs(start.measures["poisson"] - 0.15) < 0.005, (wanted, start)
            least, most = map(float, re.search(r"is beyond ([\d.]+) to ([\d.]+) at", high.reason).groups())
            assert not low.reached and not high.reached and abs(low.ratio - least) < 0.01 and 0.98 * most < high.ratio < 1.01 * most, (low, high)


@fact
def poisson_ratios_beyond_the_maps_are_said(folder):
    table = maps.Maps()
    for poisson, rho in ((0.45, 0.0), (-0.3, 1.0)):
        start = table.start("linear", 3, poisson, 5)
        assert start.rho_k == rho and not start.reached and "Poisson's ratio" in start.reason, start


@fact
def stiffness_and_strength_of_a_start_give_back_the_wanted_values(folder):
    """A square of equal touching discs: n_c, e, rt and A in closed form; then E and strength by the definition of the measures."""
    n, r = 40, 0.5e-3
    packing = maps.groups(np.full(n * n, r), np.full(2 * n * (n - 1), 2 * r), (2 * n * r) ** 2, 2)
    assert np.allclose(packing, (4 * (n - 1) / n, 1 - np.pi / 4, 1.0, r), rtol=1e-12), packing
    start = maps.Maps().start("linear", 2, 0.15, 6)
    k_n, limit = start.normal_stiffness(20e9, packing), start.tension_limit(5e6, packing, "tension")
    part = packing.n_c * (1 - packing.porosity)
    assert abs(start.measures["young"] * k_n * part / packing.rt / 20e9 - 1) < 1e-12
    assert abs(start.measures["tension"] * limit * part / packing.area / 5e6 - 1) < 1e-12


@fact
def values_that_mean_nothing_are_refused(folder):
    table = maps.Maps()
    for call, word in ((lambda: table.measure("young", "linear", 4, 0.2, 1), "found 4"), (lambda: table.measure("young", "linear", 3, np.nan, 1), "nan"),
                       (lambda: table.measure("young", "linear", 3, 0.2, 0), "chi > 0"), (lambda: table.measure("young", "glue", 3, 0.2, 1), "glue"),
                       (lambda: table.measure("young", "range", 3, 0.2, 1, interaction_range=0.9), r"found 0.9"),
                       (lambda: table.measure("young", "linear", 3, 0.2, 1, cohesion=1), "cohesion"),
                       (lambda: table.start("linear", 3, np.nan, 5), "nan"), (lambda: table.start("linear", 3, 0.2, -1), "found tension, -1"),
                       (lambda: table.start("linear", 3, 0.2, 5, test="shear"), "shear"), (lambda: maps.groups([], [], 1, 3), "particles")):
        try:
            call()
        except ValueError as error:
            assert word in str(error), error
        else:
            raise AssertionError(f"accepted: {word}")


sys.exit(main())
