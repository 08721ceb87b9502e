#!/usr/bin/python3
"""slopes_table.py SLOPES.csv BASE.csv: the tables of the study of accuracy as C, for src/accuracy/slopes.c, on standard output."""
import csv
import sys

FORMS = {"power": "GN_SLOPE_POWER", "linear": "GN_SLOPE_LINEAR", "exponential": "GN_SLOPE_EXPONENTIAL", "ratio": "GN_SLOPE_RATIO",
         "constant": "GN_SLOPE_CONSTANT"}
NUMBERS = ("coefficient", "coefficient_error", "exponent", "exponent_error", "reference", "low", "high")


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def text(value):
    return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'


def number(value):
    return repr(float(value)) if value else "NAN"


def main(slopes, base):
    print("/* Written from validate/accuracy by tools/slopes_table.py. */")
    print('#include "accuracy/accuracy.h"\n\n#include <math.h>\n')
    print("const gn_slope gn_slopes[] = {")
    for row in rows(slopes):
        names = ", ".join(text(row[name]) for name in ("case", "reading", "effect", "group"))
        scatter = "true" if row["kind"] == "scatter" else "false"
        print(f"    {{{names}, {scatter}, {FORMS[row['form']]}, {', '.join(number(row[name]) for name in NUMBERS)}}},")
    print("};\nconst size_t gn_slope_count = sizeof gn_slopes / sizeof *gn_slopes;\n")
    print("const gn_slope_base gn_slope_bases[] = {")
    for row in rows(base):
        print(f"    {{{text(row['case'])}, {text(row['quantity'])}, {number(row['value'])}}},")
    print("};\nconst size_t gn_slope_base_count = sizeof gn_slope_bases / sizeof *gn_slope_bases;")


if __name__ == "__main__":
    main(*sys.argv[1:])
