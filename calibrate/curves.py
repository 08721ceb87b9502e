"""Measured stress-strain curves: files of two columns, and stresses at given strains of a run."""
import csv
import os
import re

import h5py
import numpy as np

from calibrate import units

TOUCHED = 0.01  # stress above which a curve begins, relative to its largest stress
POINTS = 8  # number of points of a curve, at equal distances of strain up to its end
_UNIT = re.compile(r"[\[(]([^\])]*)[\])]\s*$")


def read(path):
    """(strains, stresses in Pa) of a text file: two columns in a row, strain and stress, compression positive, rising strains. A first line of
    names may have units in brackets, as `strain [%], stress [MPa]`; the default units are 1 and Pa. ValueError where a row is wrong."""
    factors, rows = [1.0, 1.0], []
    with open(path, encoding="utf-8", newline="") as file:
        for number, row in enumerate(csv.reader(line for line in file if line.strip() and not line.startswith("#")), 1):
            try:
                rows.append([float(one) for one in row])
            except ValueError as error:
                if rows or number > 1:
                    raise ValueError(f"row {number}: expected two numbers, found '{','.join(row)}'") from error
                found = [_UNIT.search(cell) for cell in row[:2]]
                factors = [units.factor(unit[1], to) if unit else 1.0 for unit, to in zip(found, ("1", "Pa"))]
                continue
            if len(row) != 2 or not np.isfinite(rows[-1]).all():
                raise ValueError(f"row {number}: expected two numbers, found '{','.join(row)}'")
    table = np.array(rows, float).reshape(-1, 2) * factors
    if len(table) < 2 or np.any(np.diff(table[:, 0]) <= 0.0) or table[-1, 0] <= 0.0:
        raise ValueError(f"expected at least two rows whose strains rise to above 0, found {len(table)} row{'s' if len(table) != 1 else ''}")
    return table[:, 0], table[:, 1]


def since_contact(strain, stress):
    """The curve from where the stress exceeds TOUCHED of its largest on: a specimen under pressure has shrunk away from platens that stood still."""
    first = int(np.argmax(stress > TOUCHED * np.max(stress)))
    return strain[first:] - strain[max(first - 1, 0)], stress[first:]


def of_run(folder):
    """(axial strains, stresses less the confinement) of a finished run since its ends began to close on it."""
    with h5py.File(os.path.join(folder, "results.h5"), "r") as file:
        history = file["history"]
        strain, stress = history["strain"][:], history["stress"][:]
        if "stage" in history:
            loaded = history["stage"][:] == history["stage"][-1]
            return since_contact(strain[loaded], stress[loaded])
    return strain, stress


def stress_at(folder, strain):
    """Stress of a run at a strain in Pa; None if the run did not come so far."""
    strains, stresses = of_run(folder)
    return float(np.interp(strain, strains, stresses)) if strains[-1] >= strain else None
