"""Runs tools/report.py on made-up results of every kind and on files that cannot be read. Speaks TAP."""
import contextlib
import io
import os
import re
import struct
import subprocess
import sys
import tempfile
import warnings
from types import SimpleNamespace

import h5py
import numpy as np

from make_results import KINDS, make

TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools")
sys.path.insert(0, TOOLS)
import report  # noqa: E402  (it stands in another folder)


def run_report(folder):
    """As from the command line, in this process: loading matplotlib takes longer than the report. Any warning
    is an error."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("error")
        code = report.main([folder])
    return SimpleNamespace(returncode=code, stdout=out.getvalue(), stderr=err.getvalue())


def the_command_tells_by_its_exit_code(folder):
    command = [sys.executable, os.path.join(TOOLS, "report.py"), folder]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2, f"exit code {done.returncode} without results, expected 2"
    make("two_rows", os.path.join(folder, "results.h5"))
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert done.stdout.strip() == os.path.join(folder, "report.html")


def check_pictures(folder, page):
    """Every picture of the page is there, whole and of a sensible size; none is left over."""
    named = set(re.findall(r'src="report/([^"]+)"', page))
    there = set(os.listdir(os.path.join(folder, "report")))
    assert named == there, f"page names {sorted(named)}, folder holds {sorted(there)}"
    for name in named:
        with open(os.path.join(folder, "report", name), "rb") as file:
            data = file.read()
        assert data[:8] == b"\x89PNG\r\n\x1a\n" and data[-8:-4] == b"IEND", f"{name} is not a whole PNG"
        width, height = struct.unpack(">II", data[16:24])
        assert 200 < width < 5000 and 100 < height < 3000, f"{name} is {width} x {height}"
    return named


def expected_pictures(kind):
    dimension, rows, test, with_bonds, _, _ = KINDS[kind]
    expected = {"profile"}
    if rows:
        expected |= {"broken_bonds", "energy", "unbalanced", "strains"} | ({"stress_strain"} if test else {"forces"})
    if kind != "no_particles":
        expected |= {"slice"} | ({"surface"} if dimension == 3 else set())
    return {name + ".png" for name in expected}


def every_kind(kind, folder):
    make(kind, os.path.join(folder, "results.h5"))
    done = run_report(folder)
    assert done.returncode == 0, done.stderr
    assert not done.stderr, f"warnings: {done.stderr}"
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
        page = file.read()
    named = check_pictures(folder, page)
    assert named == expected_pictures(kind), f"pictures {sorted(named)}"
    assert f"Made-up {kind} &lt;&amp;&gt;" in page, "the title is not escaped"
    assert "<details>" in page and "0123456789abcdef" in page
    assert ("Unfinished" in page) == (kind == "unfinished")
    if kind == "cylinder":
        for text in ("18.1 GPa", "240 MPa", "0.17", "1.44 %", "100 ns", "40000"):
            assert text in page, f"{text} is missing"


def refused(folder, wanted):
    done = run_report(folder)
    assert done.returncode == 2, f"exit code {done.returncode}, expected 2"
    assert len(done.stderr.strip().splitlines()) == 1 and wanted in done.stderr, done.stderr
    assert not os.path.exists(os.path.join(folder, "report.html")), "a report was written"


def a_missing_file_is_refused(folder):
    refused(folder, "no such file")


def a_truncated_file_is_refused(folder):
    path = os.path.join(folder, "results.h5")
    make("cylinder", path)
    os.truncate(path, os.path.getsize(path) // 2)
    refused(folder, "damaged")


def a_text_file_is_refused(folder):
    with open(os.path.join(folder, "results.h5"), "w", encoding="utf-8") as file:
        file.write("not HDF5\n" * 100)
    refused(folder, "damaged or not a results file")


def a_foreign_hdf5_file_is_refused(folder):
    with h5py.File(os.path.join(folder, "results.h5"), "w") as file:
        file["other"] = np.zeros(3)
    refused(folder, "/history")


def a_damaged_chunk_is_refused(folder):
    path = os.path.join(folder, "results.h5")
    with h5py.File(path, "w") as file:
        data = file.create_dataset("history/time", data=np.linspace(0, 1, 4096), chunks=(4096,), fletcher32=True)
        offset = data.id.get_chunk_info(0).byte_offset
    with open(path, "r+b") as file:
        file.seek(offset + 1000)
        file.write(b"\xff\xff\xff\xff")
    refused(folder, "damaged")


def old_pictures_are_removed(folder):
    path = os.path.join(folder, "results.h5")
    make("cylinder", path)
    run_report(folder)
    make("no_particles", path)
    assert run_report(folder).returncode == 0
    left = set(os.listdir(os.path.join(folder, "report")))
    assert left == expected_pictures("no_particles"), f"left over: {sorted(left)}"


def main():
    tests = [(f"report of {kind}", lambda folder, kind=kind: every_kind(kind, folder)) for kind in KINDS]
    tests += [(f.__name__, f) for f in (
        a_missing_file_is_refused, a_truncated_file_is_refused, a_text_file_is_refused, a_foreign_hdf5_file_is_refused,
        a_damaged_chunk_is_refused, old_pictures_are_removed,
        the_command_tells_by_its_exit_code)]
    print(f"1..{len(tests)}", flush=True)
    failed = 0
    for number, (name, test) in enumerate(tests, 1):
        with tempfile.TemporaryDirectory() as folder:
            try:
                test(folder)
                print(f"ok {number} - {name}", flush=True)
            except Exception as e:  # every failure is reported and counted
                failed += 1
                print(f"not ok {number} - {name}", flush=True)
                print(f"{name}: {type(e).__name__}: {e}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
