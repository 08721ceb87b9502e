"""Runs tools/report.py on made-up results and packings of every kind and on files that cannot be read. Speaks TAP."""
import contextlib
import html
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

from make_results import KINDS, PACKINGS, WITH_EVENTS, figures_of_quality, make, make_packing

TOOLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools")
sys.path.insert(0, TOOLS)
import report  # noqa: E402  (it stands in another folder)
import report_beside  # noqa: E402
import report_curves  # noqa: E402
import report_envelope  # noqa: E402
import report_packing  # noqa: E402
import report_tests  # noqa: E402


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


def check_png(path):
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and data[-8:-4] == b"IEND", f"{path} is not a whole PNG"
    width, height = struct.unpack(">II", data[16:24])
    assert 200 < width < 5000 and 100 < height < 3000, f"{path} is {width} x {height}"


def check_pictures(folder, page):
    """Every picture of the page is there, whole and of a sensible size; none is left over."""
    named = set(re.findall(r'data-file="report/([^"]+)"', page))
    there = set(os.listdir(os.path.join(folder, "report")))
    assert named == there, f"page names {sorted(named)}, folder holds {sorted(there)}"
    for name in named:
        check_png(os.path.join(folder, "report", name))
    return named


def expected_pictures(kind):
    dimension, rows, test, with_bonds, _, _ = KINDS[kind]
    expected = {"profile"}
    if rows:
        expected |= {"broken_bonds", "energy", "unbalanced", "strains"} | ({"stress_strain"} if test else {"forces"})
        expected |= {"events"} if kind in WITH_EVENTS else {"breaking"} if rows > 2 else set()
        expected |= {"forces"} if kind == "stages" else set()
    if kind != "no_particles":
        expected |= {"slice"} | ({"surface"} if dimension == 3 else set()) | ({"rose", "fragments"} if with_bonds else set())
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
    for said in ("Energy residual.</b> 0.03 of 1 J &lt;&amp;&gt;", "End imbalance.</b> by half"):
        assert (said in page) == (kind == "disc"), said
    assert "1.9e-05 m³ (the &lt;shape&gt;)" in page
    missing = KINDS[kind][5]
    for said in ("absent: made-up &lt;reason&gt;", "<small>made-up &lt;reason&gt;"):
        assert (said in page) == missing, said
    assert ("largest stress (no peak)" in page) == missing
    said = "<small>± 6.2 MPa (packing 3 % estimated, velocity 0.5 % measured)</small>"
    assert (said in page) == (not missing), "the error budget, its largest cause first"
    if kind == "cylinder":
        for text in ("18.1 GPa", "240 MPa", "0.17", "1.44 %", "100 ns", "40000"):
            assert text in page, f"{text} is missing"


def curves_of_an_envelope_are_those_of_its_readings(folder):
    """35 degrees and 12 MPa; m_i 15 and 100 MPa; and what is absent has its reason, and no curve."""
    path = os.path.join(folder, "sweep.h5")
    with h5py.File(path, "w") as file:
        for name, value, unit in (("friction_angle", 35.0, "degree"), ("cohesion", 12e6, "Pa"), ("hoek_brown_mi", 15.0, "1"),
                                  ("hoek_brown_strength", 100e6, "Pa")):
            file.create_dataset(f"envelope/{name}", data=[value]).attrs["unit"] = unit
            file.create_dataset(f"none/{name}", data=[np.nan]).attrs["absent"] = "too few"
        coulomb, hoek = report_envelope.curves(report_envelope.read(file["envelope"]))
        none = report_envelope.read(file["none"])
    k = (1 + np.sin(np.radians(35))) / (1 - np.sin(np.radians(35)))
    assert abs(coulomb(5e6) / (2 * 12e6 * np.sqrt(k) + k * 5e6) - 1) < 1e-12
    assert abs(hoek(5e6) / (5e6 + 100e6 * np.sqrt(15 * 0.05 + 1)) - 1) < 1e-12
    assert report_envelope.curves(none) == (None, None)
    assert report_envelope.rows_of(none)[0] == ("friction angle", "–", "too few")


def stages_are_those_of_the_history(folder):
    path = os.path.join(folder, "results.h5")
    make("stages", path)
    results = report.Results(path)
    assert results.stages == [("settle", 0, 50), ("bond", 50, 0), ("load", 50, 150)], results.stages
    assert results.last_stage == ("load", slice(50, 200)), results.last_stage
    assert run_report(folder).returncode == 0
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
        page = file.read()
    assert "Strain counts from the start of the stage." in page
    of_stages = page[page.index("Readings of the stages"):page.index("<h2>Parameters")]
    assert re.findall("<t[hd].*?>(.*?)</t[hd]>", of_stages) == ["reading", "settle", "load", "largest stress", "60 MPa", "241 MPa"], of_stages
    make("disc", path)
    results = report.Results(path)
    assert report.stages_table(results) == "" and results.stages == [] and results.last_stage == ("", slice(0, 400)), results.last_stage


def curves_of_a_test_are_those_of_the_last_stage(folder):
    """From the rows 50 to 199, ways and strains from the first of them."""
    path = os.path.join(folder, "results.h5")
    make("stages", path)
    columns = {"volumetric_strain": 2.0, "lateral_strain": 3.0, "normal_stress": 4.0, "dilation": 5.0, "force": 6.0, "opening": 7.0}
    with h5py.File(path, "r+") as file:
        for name, value in columns.items():
            file["history/" + name] = value + value * np.linspace(0, 1, 200)
    results, drawn = report.Results(path), []
    for module, plot in ((report_tests, "confined"), (report_tests, "shear"), (report_curves, "force_opening")):
        kept, module.save = module.save, lambda figure, path: drawn.extend(line for axes in figure.axes for line in axes.lines)
        assert report_tests.CURVES[plot](results, os.path.join(folder, "no.png"))
        module.save = kept
    assert len(drawn) == 6, drawn
    names = ("stress", "volumetric_strain", "lateral_strain", "normal_stress", "dilation", "force")
    for line, name in zip(drawn, names):
        x, y = (np.asarray(values, float) for values in line.get_data())
        rows = results.column(name)[50:]
        assert len(x) == 150 and x[0] == 0, (name, x)
        grown = np.ptp(rows) / np.ptp(y)  # the unit of the axis
        assert np.allclose(y * grown, rows - (rows[0] if name in ("volumetric_strain", "lateral_strain", "dilation") else 0)), name


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


def a_term_of_the_ledger_is_drawn_by_its_kind_whatever_its_name(folder):
    path, shown = os.path.join(folder, "results.h5"), []
    make("cylinder", path)
    with h5py.File(path, "r+") as file:
        lost = file["history/energy_friction"][()]
        for kind in ("stored", "lost", "input"):
            file[f"history/energy_novel_{kind}"] = lost
            file[f"energy/novel_{kind}"] = 1.0
            file[f"energy/novel_{kind}"].attrs.update({"unit": "J", "kind": kind})
    save, report_curves.save = report_curves.save, lambda figure, _: shown.extend(figure.axes[0].get_legend_handles_labels()[1])
    try:
        report_curves.plot_energy(report.Results(path), "")
    finally:
        report_curves.save = save
    assert {"novel stored", "novel lost"} <= set(shown) and "novel input" not in shown, shown


def old_pictures_are_removed(folder):
    path = os.path.join(folder, "results.h5")
    make("cylinder", path)
    run_report(folder)
    make("no_particles", path)
    assert run_report(folder).returncode == 0
    left = set(os.listdir(os.path.join(folder, "report")))
    assert left == expected_pictures("no_particles"), f"left over: {sorted(left)}"


# --- packings ------------------------------------------------------------------------------------------

def packing_page(kind, folder):
    make_packing(kind, os.path.join(folder, "packing.h5"))
    done = run_report(folder)
    assert done.returncode == 0, done.stderr
    assert not done.stderr, f"warnings: {done.stderr}"
    with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
        return file.read()


def every_packing(kind, folder):
    dimension, _, _, rows, in_time, from_cache = PACKINGS[kind]
    page = packing_page(kind, folder)
    expected = {"packing", "radii", "gaps", "directions"} | ({"polar"} if dimension == 3 else set())
    expected |= {"trace"} if rows else set()
    named = check_pictures(folder, page)
    assert named == {name + ".png" for name in expected}, f"pictures {sorted(named)}"
    check_png(os.path.join(folder, "packing.png"))
    assert f"Made-up {kind} &lt;&amp;&gt; $1" in page and "specimen: &lt;made-up&gt;" in page, "not escaped"
    assert ("Cut short" in page) == (not in_time)
    assert ("from the cache</p>" in page) == bool(from_cache)
    assert ("No iterations of the fit are recorded" in page) == (not rows)
    assert ("19.112 cm³" if dimension == 3 else "100 cm²") in page, "the volume is missing"


def text_of(kind, folder):
    """The page without its pictures."""
    path = os.path.join(folder, "packing.h5")
    make_packing(kind, path)
    return report_packing.page(report_packing.Packing(path), {})


def every_figure_of_a_packing_is_listed_with_its_meaning(folder):
    page = text_of("packed_cylinder", folder)
    figures = figures_of_quality()
    assert "porosity" in figures and len(figures) > 20, sorted(figures)
    for name, (unit, text) in figures.items():
        row = re.search(rf"<tr><td[^>]*>{name.replace('_', ' ')}</td>(.*?)</tr>", page)
        assert row, f"{name} is missing"
        assert html.escape(text) in row[1], f"the meaning of {name} is missing"
        assert unit == "1" or f" {unit}</td>" in row[1], f"the unit of {name} is missing"


def figures_of_a_packing_stand_in_the_order_of_their_texts(folder):
    """Some texts refer to the one before."""
    page = text_of("packed_cylinder", folder)
    listed = re.search(r"<h2>Figures</h2>(.*?)</table>", page, re.DOTALL)[1]
    names = [name.replace(" ", "_") for name in re.findall(r"<tr><td[^>]*>([^<]*)</td>", listed)]
    assert names == list(figures_of_quality()), names


def figures_of_a_packing_have_handy_units(folder):
    page = text_of("packed_cylinder", folder)
    with h5py.File(os.path.join(folder, "packing.h5"), "r") as file:
        radius = 1e3 * file["quality/radius_mean"][0]
    for text in (f">{radius:.4g} mm<", ">32.4 %<", ">1.49 %<", ">3.71 s<"):
        assert text in page, f"{text} is missing"


def the_report_names_only_figures_that_are_measured(_):
    known = {name for name, _ in report_packing.CARDS} | set(report_packing.PERCENT)
    assert known <= set(figures_of_quality()), sorted(known - set(figures_of_quality()))


def a_folder_with_a_run_and_a_packing_gets_the_report_of_the_run(folder):
    make("two_rows", os.path.join(folder, "results.h5"))
    page = packing_page("packed_square", folder)
    assert "Made-up two_rows" in page and not os.path.exists(os.path.join(folder, "packing.png"))


def a_truncated_packing_is_refused(folder):
    path = os.path.join(folder, "packing.h5")
    make_packing("packed_square", path)
    os.truncate(path, os.path.getsize(path) // 2)
    refused(folder, "damaged or not a packing file")


def a_text_file_for_a_packing_is_refused(folder):
    with open(os.path.join(folder, "packing.h5"), "w", encoding="utf-8") as file:
        file.write("0 0 0 1\n" * 100)
    refused(folder, "damaged or not a packing file")


def results_named_packing_are_refused(folder):
    make("disc", os.path.join(folder, "packing.h5"))
    refused(folder, 'kind = "packing", found none')


def change(name, value):
    """A test that the packing with the data set `name` replaced, or without it, is refused for that."""
    def test(folder):
        path = os.path.join(folder, "packing.h5")
        make_packing("packed_square", path)
        with h5py.File(path, "r+") as file:
            del file[name]
            if value is not None:
                file[name] = value
        refused(folder, "/trace" if name.startswith("trace") else "/" + name)
        assert not os.path.exists(os.path.join(folder, "packing.png")), "a picture was drawn"
    test.__name__ = f"a packing {'without' if value is None else 'with another'} {name} is refused"
    return test


CHANGES = (("particles/radius", None), ("particles/position", np.ones((7, 2))),
           ("contacts/pair", np.full((3, 2), 1)), ("contacts/gap", None), ("quality/fabric", np.ones(4)),
           ("histogram/angle_count", None), ("histogram/radius_edge", np.arange(3.0)), ("trace/energy", np.ones(3)))


def a_packing_of_no_known_dimension_is_refused(folder):
    path = os.path.join(folder, "packing.h5")
    make_packing("packed_square", path)
    with h5py.File(path, "r+") as file:
        file.attrs["dimension"] = 5
    refused(folder, "dimension 2 or 3, found 5")


def particles_that_are_not_a_number_are_left_out(folder):
    path = os.path.join(folder, "packing.h5")
    for kind in ("packed_square", "packed_cylinder"):
        make_packing(kind, path)
        with h5py.File(path, "r+") as file:
            file["particles/position"][3] = np.nan
            file["particles/radius"][4] = np.nan
            file["quality/overlap_median"][0] = np.nan
        done = run_report(folder)
        assert done.returncode == 0 and not done.stderr, done.stderr


def a_pair_of_particles_that_are_not_there_is_refused(folder):
    path = os.path.join(folder, "packing.h5")
    make_packing("packed_square", path)
    with h5py.File(path, "r+") as file:
        file["contacts/pair"][5, 1] = 100000
    refused(folder, "/contacts/pair names particles")


CUBE = np.array([[x, y, z] for x in (0, 2) for y in (0, 4) for z in (0, 6)], float)
CUBE_FACETS = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
WALLS = 'walls:\n  - name: "low"\n    point: [0, 0, -1]\n    normal: [0, 0, 1]\n    motion:\n      vz: 1\n  - name: "side"\n    point: [9, 0, 0]\n    normal: [0, 1, 0]\n'


def beside(facet=CUBE_FACETS, scene=WALLS):
    """Seen along y: x to the right, z upward."""
    moved = {"time": np.array([0.0, 2.0]), "wall_low_displacement_z": np.array([0.0, 0.5])}
    bodies = {"vertex": SimpleNamespace(value=CUBE), "facet": SimpleNamespace(value=facet)}
    return report_beside.Beside(SimpleNamespace(bodies=bodies, scene=scene, column=moved.get), [0, 2, 1], 1.0)


def bodies_are_cut_where_the_slice_is(folder):
    segments = np.array(beside()._cut(1.0, False))
    length = np.linalg.norm(segments[:, 0] - segments[:, 1], axis=1)
    assert abs(length.sum() - 16) < 1e-12 and len(beside()._cut(5.0, False)) == 0, segments  # round 2 x 6 m
    low, high = beside().bounds(np.zeros(3), np.ones(3))
    assert (low == 0).all() and (high == [2, 6, 4]).all(), (low, high)


def of_bodies_the_folds_are_drawn(folder):
    edges = report_beside._edges(CUBE_FACETS, CUBE[CUBE_FACETS])
    assert len(edges) == 12 and (np.count_nonzero(CUBE[edges[:, 0]] != CUBE[edges[:, 1]], axis=1) == 1).all(), edges
    assert len(report_beside._edges(CUBE_FACETS[1:], CUBE[CUBE_FACETS[1:]])) == 13  # a hole has sides


def walls_are_where_they_have_come_to(folder):
    import matplotlib.pyplot as plt

    axes = plt.figure().add_subplot()
    seen = beside()
    seen.draw_cut(axes, 1.0, (0, 2, -2, 6), False)
    lines = axes.collections[1].get_segments()  # behind the body; the wall whose plane is that of the picture has none
    assert len(axes.collections) == 3 and np.allclose(np.array(lines)[0][:, 1], -0.5), lines
    assert "rigid bodies" in seen.text() and "walls" in seen.text()
    assert beside(np.zeros((0, 3), int), "").text() == ""


def main():
    tests = [(f"report of {kind}", lambda folder, kind=kind: every_kind(kind, folder)) for kind in KINDS]
    tests += [(f.__name__, f) for f in (
        a_missing_file_is_refused, a_truncated_file_is_refused, a_text_file_is_refused, a_foreign_hdf5_file_is_refused,
        a_damaged_chunk_is_refused, stages_are_those_of_the_history, curves_of_a_test_are_those_of_the_last_stage,
        curves_of_an_envelope_are_those_of_its_readings, old_pictures_are_removed,
        a_term_of_the_ledger_is_drawn_by_its_kind_whatever_its_name,
        bodies_are_cut_where_the_slice_is, of_bodies_the_folds_are_drawn, walls_are_where_they_have_come_to,
        the_command_tells_by_its_exit_code)]
    tests += [(f"report of {kind}", lambda folder, kind=kind: every_packing(kind, folder)) for kind in PACKINGS]
    tests += [(f.__name__, f) for f in (
        every_figure_of_a_packing_is_listed_with_its_meaning, figures_of_a_packing_stand_in_the_order_of_their_texts,
        figures_of_a_packing_have_handy_units,
        the_report_names_only_figures_that_are_measured, a_folder_with_a_run_and_a_packing_gets_the_report_of_the_run,
        a_truncated_packing_is_refused, a_text_file_for_a_packing_is_refused, results_named_packing_are_refused,
        a_packing_of_no_known_dimension_is_refused, particles_that_are_not_a_number_are_left_out,
        a_pair_of_particles_that_are_not_there_is_refused, *(change(*c) for c in CHANGES))]
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
