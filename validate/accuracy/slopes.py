"""Measured slopes as a table, slopes.csv: contributions to errors over dimensionless groups. The page's table of slopes is made from
it, and a program may read it.

form power:    error = coefficient * (group / reference)^exponent  (error: change of the reading over the reading)
     linear:   error = coefficient * (group - reference)
     exponential: error = coefficient * exp(-group / reference)
     ratio:    error = (group / reference)^exponent - 1
     constant: error = coefficient, whatever the group is
`low`, `high`: the group's range that was measured; *_error: standard errors, that of a power's coefficient relative; `points`: how
many points the fit had, or runs a constant. `kind`: bias (it has a sign; here positive: too large) or scatter (a standard deviation).
"""
import csv
import io

import numpy as np

import fits

COLUMNS = ("case", "reading", "effect", "kind", "group", "form", "coefficient", "coefficient_error", "exponent", "exponent_error",
           "reference", "low", "high", "points")
FORMS = ("power", "linear", "exponential", "ratio", "constant")


def number(value):
    return "" if value is None or not np.isfinite(value) else f"{value:.4g}"


class Slopes:
    def __init__(self, case):
        self.case, self.rows = case, []

    def add(self, reading, effect, kind, group, form, coefficient, coefficient_error=None, exponent=None, exponent_error=None,
            reference=None, low=None, high=None, points=0):
        if not np.isfinite(coefficient):
            return None
        values = (coefficient, coefficient_error, exponent, exponent_error, reference, low, high)
        row = dict(zip(COLUMNS, (self.case, reading, effect, kind, group, form, *map(number, values), str(points))))
        self.rows.append(row)
        return row

    def power(self, reading, effect, kind, group, x, y):
        """Fits a power law to deviations y over x; its sign is that of most deviations."""
        x, y = fits.clean(x, y)
        keep = y != 0
        x, y = x[keep], y[keep]
        if len(np.unique(x)) < 2:
            return None
        middle, coefficient, exponent, a, b = fits.power(x, y)
        sign = np.sign(np.median(np.sign(y))) or 1.0
        return self.add(reading, effect, kind, group, "power", sign * coefficient, a, exponent, b, middle, x.min(), x.max(), len(x))

    def linear(self, reading, effect, kind, group, x, y, reference):
        x, y = fits.clean(x, y)
        if len(np.unique(x)) < 2:
            return None
        _, slope, _, error = fits.line(x, y)
        return self.add(reading, effect, kind, group, "linear", slope, error, None, None, reference, x.min(), x.max(), len(x))

    def exponential(self, reading, effect, kind, group, x, y):
        x, y = fits.clean(x, y)
        if len(np.unique(x)) < 3 or np.ptp(np.sign(y)) > 0:
            return None
        a, slope, a_error, _ = fits.line(x, np.log(np.abs(y)))
        if slope >= 0:
            return None
        c = np.sign(y[0]) * np.exp(a)
        return self.add(reading, effect, kind, group, "exponential", c, abs(c) * a_error, None, None, -1 / slope, x.min(), x.max(), len(x))

    def ratio(self, reading, effect, group, x, y, reference):
        """Returns the slope of a reading relative to its value at the reference."""
        x, y = fits.clean(x, y)
        u, v = np.log(x / reference), np.log(y)
        if not np.sum(u * u) > 0:
            return None
        exponent = np.sum(u * v) / np.sum(u * u)
        spread = np.sqrt(np.sum((v - exponent * u) ** 2) / (len(x) - 2) / np.sum(u * u)) if len(x) > 2 else float("nan")
        return self.add(reading, effect, "bias", group, "ratio", 1.0, None, exponent, spread, reference, x.min(), x.max(), len(x))

    def constant(self, reading, effect, kind, value, count):
        if count < 1:
            return None
        error = value / np.sqrt(2 * max(1, count - 1)) if kind == "scatter" else None
        return self.add(reading, effect, kind, "", "constant", value, error, points=count)


def read(path):
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def write(path, measured, cases):
    """Replaces the rows of the measured cases in the file."""
    fresh = {row["case"] for row in measured}
    rows = [row for row in read(path) if row["case"] not in fresh] + measured
    rows.sort(key=lambda row: (list(cases).index(row["case"]) if row["case"] in cases else len(cases)))
    text = io.StringIO()
    text.write("# Written by ./do accuracy; what the columns are: validate/accuracy/slopes.py\n")
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    path.write_text(text.getvalue())


def law(row):
    """Returns a row as a formula."""
    c = float(row["coefficient"])
    if row["form"] == "power":
        return f"{100 * c:.2g} % x (g / {float(row['reference']):.3g})^{float(row['exponent']):.2f}"
    if row["form"] == "linear":
        return f"{100 * c:.2g} % x (g - {row['reference']})"
    if row["form"] == "exponential":
        return f"{100 * c:.2g} % x exp(-g / {float(row['reference']):.2g})"
    if row["form"] == "ratio":
        return f"(g / {float(row['reference']):.3g})^{float(row['exponent']):.2f} - 1"
    return f"{100 * c:.2g} %"


def at(row, group):
    """Returns the error that a row predicts for a value of its group."""
    c, reference = float(row["coefficient"]), float(row["reference"] or 1)
    if row["form"] == "power":
        return c * (group / reference) ** float(row["exponent"])
    if row["form"] == "linear":
        return c * (group - reference)
    if row["form"] == "exponential":
        return c * np.exp(-group / reference)
    return (group / reference) ** float(row["exponent"]) - 1 if row["form"] == "ratio" else c


def standard_errors(row):
    c, e = row["coefficient_error"], row["exponent_error"]
    if row["form"] == "ratio":
        return f"{float(e):.2f}" if e else "-"
    if not c:
        return "-"
    if row["form"] == "power":
        return f"{100 * float(c):.0f} % of it" + (f"; {float(e):.2f}" if e else "")
    return f"{100 * float(c):.2g} %"


def table_rows(rows):
    return [[row["case"], row["reading"], row["effect"], row["kind"], row["group"] or "-", law(row), standard_errors(row),
             f"{row['low']} to {row['high']}" if row["low"] else "-", row["points"]] for row in rows]
