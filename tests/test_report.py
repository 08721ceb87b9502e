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
import report  # noqa: E402  (it is in another folder)
import report_beside  # noqa: E402
import report_shapes  # noqa: E402
import report_curves  # noqa: E402
import report_envelope  # noqa: E402
import report_packing  # noqa: E402
import report_page  # noqa: E402
import report_pictures  # noqa: E402
import report_tests  # noqa: E402


def run_report(folder):
    """Runs the report as from the command line, but in this process, because loading matplotlib takes longer than the report.
    Any warning is an error."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("error")
        code = report.main([folder])
    return SimpleNamespace(returncode=code, stdout=out.getvalue(), stderr=err.getvalue())


def the_command_reports_by_its_exit_code(folder):
    command = [sys.executable, os.path.join(TOOLS, "report.py"), folder]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2, f"exit code {done.returncode} without results, expected 2"
    make("two_rows", os.path.join(folder, "results.h5"))
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert done.stdout.strip() == os.path.join(folder, "report.html")


def a_report_without_matplotlib_has_curves_and_a_slice(folder):
    blocked = os.path.join(folder, "blocked")
    os.mkdir(blocked)
    with open(os.path.join(blocked, "sitecustomize.py"), "w") as file:
        file.write("import sys\n\n\nclass Absent:\n    def find_spec(self, name, path=None, target=None):\n"
                   "        if name.split('.')[0] == 'matplotlib':\n            raise ModuleNotFoundError(name)\n\n\n"
                   "sys.meta_path.insert(0, Absent())\n")

    def call():
        return subprocess.run([sys.executable, os.path.join(TOOLS, "report.py"), folder], capture_output=True, text=True, timeout=120,
                              env={**os.environ, "PYTHONPATH": blocked})

    done = call()
    assert done.returncode == 3 and "python3-matplotlib" in done.stderr, done.stderr
    for kind, curves in (("cylinder", 3), ("no_particles", 0), ("two_rows", 0)):
        make(kind, os.path.join(folder, "results.h5"))
        done = call()
        assert done.returncode == 0 and not done.stderr, done.stderr
        with open(os.path.join(folder, "report.html")) as file:
            page = file.read()
        assert page.count("<polyline") >= curves and "python3-matplotlib" in page and "data:image" not in page, (kind, page.count("<polyline"))
        assert ("<circle" in page) == (kind != "no_particles"), kind


def check_png(path):
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and data[-8:-4] == b"IEND", f"{path} is not a whole PNG"
    width, height = struct.unpack(">II", data[16:24])
    assert 200 < width < 5000 and 100 < height < 3000, f"{path} is {width} x {height}"


def check_pictures(folder, page):
    """Every picture of the page is complete and of a sensible size; no other exists."""
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
        expected |= {"energy", "unbalanced", "strains"} | ({"broken_bonds"} if rows > 1 else set()) | ({"stress_strain"} if test else {"forces"})
        expected |= {"events", "bursts"} if kind in WITH_EVENTS else {"breaking"} if rows > 2 else set()
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
    tested = KINDS[kind][2]
    missing = KINDS[kind][5] and tested
    assert tested or ("<b>–</b>" not in page and "Young" not in page), "empty cards of a test that is none"
    for said in ("absent: made-up &lt;reason&gt;", "<small>made-up &lt;reason&gt;"):
        assert (said in page) == missing, said
    assert ("largest stress (no peak)" in page) == missing
    said = "<small>± 6.2 MPa (packing 3 % estimated, velocity 0.5 % measured)</small>"
    assert (said in page) == (not KINDS[kind][5]), "the error budget, its largest cause first"
    if kind == "cylinder":
        for text in ("18.1 GPa", "240 MPa", "0.17", "1.44 %", "100 ns", "40000"):
            assert text in page, f"{text} is missing"


def curves_of_an_envelope_are_those_of_its_readings(folder):
    """35 degrees and 12 MPa; m_i 15 and 100 MPa; an absent reading has its reason, and no curve."""
    path = os.path.join(folder, "sweep.h5")
    with h5py.File(path, "w") as file:
        for name, value, unit in (("friction_angle", 35.0, "degree"), ("cohesion", 12e6, "Pa"), ("hoek_brown_mi", 15.0, "1"),
                                  ("hoek_brown_strength", 100e6, "Pa")):
            file.create_dataset(f"envelope/{name}", data=[value]).attrs["unit"] = unit
            file.create_dataset(f"none/{name}", data=[np.nan]).attrs["absent"] = "too few"
        (label, found), = report_envelope.read(file["envelope"])
        coulomb, hoek = report_envelope.curves(found)
        (_, none), = report_envelope.read(file["none"])
    assert label == ""
    k = (1 + np.sin(np.radians(35))) / (1 - np.sin(np.radians(35)))
    assert abs(coulomb(5e6) / (2 * 12e6 * np.sqrt(k) + k * 5e6) - 1) < 1e-12
    assert abs(hoek(5e6) / (5e6 + 100e6 * np.sqrt(15 * 0.05 + 1)) - 1) < 1e-12
    assert report_envelope.curves(none) == (None, None)
    assert report_envelope.rows_of("", none)[0] == ("", "friction angle", "–", "too few")


def each_of_several_envelopes_has_its_rows_and_its_reason(folder):
    path = os.path.join(folder, "sweep.h5")
    with h5py.File(path, "w") as file:
        for name in report_envelope.TEXTS:
            data = file.create_dataset(f"envelope/{name}", data=[[30.0], [np.nan]])
            data.attrs["unit"], data.attrs["absent"] = "1", "\nthe line falls"
        file["envelope/of"] = "friction = 0.1\nfriction = 0.5"
        first, second = report_envelope.read(file["envelope"])
    assert first[0] == "friction = 0.1" and first[1]["hoek_brown_mi"] == (30.0, "1"), first
    assert second[0] == "friction = 0.5" and second[1]["hoek_brown_mi"] == (None, "the line falls"), second
    caption = report_envelope.plot([1, 2, 3, 1, 2], [5, 7, 9, 2, 1], [0, 0, 0, 1, -1], [first, second], os.path.join(folder, "a.png"))
    assert "a colour for each combination" in caption
    check_png(os.path.join(folder, "a.png"))


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


def names_of_stages_and_legends_do_not_lie_over_each_other(folder):
    """No legend covers the title or the label of a second axis."""
    path, shown = os.path.join(folder, "results.h5"), []
    make("stages", path)
    save, report_curves.save = report_curves.save, lambda figure, _: shown.append(figure)
    try:
        results = report.Results(path)
        for plot in (report_curves.plot_broken, report_curves.plot_strains, report_curves.plot_forces):
            plot(results, "")
    finally:
        report_curves.save = save
    assert shown
    for figure in shown:
        figure.canvas.draw()
        axes = figure.axes[0]
        legend = axes.get_legend().get_window_extent()
        others = [*axes.texts, axes.title, *(a.yaxis.label for a in figure.axes)]
        texts = [t.get_text() for t in others if t.get_text() and legend.overlaps(t.get_window_extent())]
        assert axes.texts and not texts, (axes.get_title(), texts)
        report_curves.plt.close(figure)


def the_line_of_the_modulus_lies_on_the_curve(folder):
    """If the section of the body varies, E differs from the slope of the curve, which the line has."""
    path = os.path.join(folder, "results.h5")
    for factor in (1.0, 0.7):
        make("cylinder", path)
        with h5py.File(path, "r+") as file:
            strain = np.asarray(file["history/strain"])
            stress = np.where(strain < 0.8 * strain.max(), 20e9 * strain, 20e9 * (1.6 * strain.max() - strain))
            file["history/stress"][...] = stress
            file["readings/young_modulus"][...] = factor * 20e9
        drawn = []
        kept, report_curves.save = report_curves.save, lambda figure, path: drawn.extend(figure.axes[0].lines)
        assert report_curves.plot_stress(report.Results(path), os.path.join(folder, "no.png"))
        report_curves.save = kept
        line, = (one for one in drawn if "E = " in one.get_label())
        x, y = (np.asarray(values, float) for values in line.get_data())
        scale = stress.max() / max(np.nanmax(np.asarray(one.get_ydata(), float)) for one in drawn)
        assert abs(scale * (y[1] - y[0]) / (x[1] - x[0]) * 100 / 20e9 - 1) < 0.01, (factor, x, y)
        assert f"E = {20 * factor:.3g} GPa" in line.get_label() and ("slope 20 GPa" in line.get_label()) == (factor < 1), line.get_label()


def curves_of_a_test_are_those_of_the_last_stage(folder):
    """The curves are made from rows 50 to 199, with displacements and strains relative to the first of them."""
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


# For each kind of test: columns of its history (value at the last row, from 0), its readings, and the content of its
# page.
TRIAXIAL = {
    "columns": {"volumetric_strain": 0.004, "lateral_strain": -0.006},
    "readings": {"axial_strength": (250e6, "Pa"), "confinement": (10e6, "Pa"), "crack_initiation_stress": (110e6, "Pa"),
                 "crack_damage_stress": (210e6, "Pa")},
    "figures": "axial_strength peak_stress confinement young_modulus poisson_ratio crack_initiation_stress crack_damage_stress",
    "tiles": [("axial strength", "250 MPa"), ("deviator at the peak", "240 MPa"), ("confinement", "10 MPa"), ("Young's modulus", "18.1 GPa"),
              ("Poisson's ratio", "0.17"), ("stress at which cracks begin", "110 MPa"), ("stress at which damage begins", "210 MPa")],
    "curves": {"confined": ("deviator", "axial strain [%]")}, "marks": 2,
}
SHEAR = {
    "columns": {"normal_stress": 5e6, "dilation": 2e-5},
    "readings": {"shear_strength": (12e6, "Pa"), "normal_stress_at_peak": (5e6, "Pa"), "shear_modulus": (4.5e9, "Pa"), "dilation_at_peak": (-3.2e-6, "m")},
    "figures": "shear_strength normal_stress_at_peak shear_modulus dilation_at_peak",
    "tiles": [("shear strength", "12 MPa"), ("normal stress at the peak", "5 MPa"), ("shear modulus", "4.5 GPa"), ("dilation at the peak", "-3.2 µm")],
    "curves": {"shear": ("normal stress", "shear strain [%]")}, "marks": 0,
}
TESTS = {
    "compression": {
        "columns": {"deflection": 7e-4, "force": 1e4},
        "readings": {"crack_initiation_stress": (94e6, "Pa"), "crack_damage_stress": (132e6, "Pa")},
        "figures": "young_modulus poisson_ratio peak_stress peak_strain crack_initiation_stress crack_damage_stress",
        "tiles": [("Young's modulus", "18.1 GPa"), ("Poisson's ratio", "0.17"), ("peak stress", "240 MPa"), ("strain at the peak", "1.44 %"),
                  ("stress at which cracks begin", "94 MPa"), ("stress at which damage begins", "132 MPa")],
        "curves": {"force_deflection": ("force", "deflection [µm]")}, "marks": 2},
    "tension": {
        "columns": {}, "readings": {"crack_initiation_stress": (np.nan, "Pa"), "fracture_energy": (44.65, "J/m2")},
        "figures": "young_modulus poisson_ratio peak_stress peak_strain crack_initiation_stress fracture_energy",
        "tiles": [("Young's modulus", "18.1 GPa"), ("Poisson's ratio", "0.17"), ("peak stress", "240 MPa"), ("strain at the peak", "1.44 %"),
                  ("stress at which cracks begin", "–"), ("fracture energy", "44.65 J/m2")],
        "curves": {}, "marks": 0},
    "brazilian": {
        "columns": {"centre_stress_xx": 7e6, "centre_stress_yy": -2.1e7},
        "readings": {"indirect_tensile_strength": (8.06e6, "Pa"), "centre_tension": (6.2e6, "Pa"), "centre_ratio": (0.955, "1"),
                     "centre_compression_ratio": (3.006, "1")},
        "figures": "indirect_tensile_strength centre_tension centre_ratio centre_compression_ratio",
        "tiles": [("indirect tensile strength", "8.06 MPa"), ("tension in the middle at the peak", "6.2 MPa"),
                  ("tension in the middle over 2P/πDt", "0.955"), ("pressure in the middle over 2P/πDt", "3.006")],
        "curves": {"centre": ("mean stress", "2P/(πDt) [MPa]")}, "marks": 0},
    "bending": {
        "columns": {"force": 24e3, "deflection": 3e-4, "opening": 2.5e-4},
        "readings": {"flexural_strength": (7.1e6, "Pa"), "flexural_modulus": (np.nan, "Pa"), "fracture_energy": (81.0, "J/m2"), "opening_at_peak": (12e-6, "m")},
        "figures": "flexural_strength flexural_modulus fracture_energy opening_at_peak",
        "tiles": [("flexural strength", "7.1 MPa"), ("flexural modulus", "–"), ("fracture energy", "81 J/m2"), ("opening at the peak", "12 µm")],
        "curves": {"force_opening": ("force", "opening [µm]"), "force_deflection": ("force", "deflection [µm]")}, "marks": 0},
    "triaxial": TRIAXIAL, "biaxial": TRIAXIAL,
    "hydrostatic": {
        "columns": {"volumetric_strain": 0.01}, "readings": {"bulk_modulus": (11e9, "Pa")},
        "figures": "bulk_modulus largest_stress",
        "tiles": [("bulk modulus", "11 GPa"), ("largest mean pressure", "241 MPa")], "curves": {}, "marks": 0},
    "oedometer": {
        "columns": {"stress_xx": -6e7, "stress_yy": -8e7, "stress_zz": -2.4e8},
        "readings": {"oedometric_modulus": (21e9, "Pa"), "lateral_stress_ratio": (0.29, "1")},
        "figures": "oedometric_modulus lateral_stress_ratio largest_stress",
        "tiles": [("oedometric modulus", "21 GPa"), ("lateral over axial stress", "0.29"), ("largest stress", "241 MPa")],
        "curves": {"lateral": ("stress", "axial strain [%]")}, "marks": 0},
    "shear": SHEAR, "simple_shear": SHEAR,
}
OF_KINDS = {"confined", "lateral", "force_opening", "force_deflection", "centre", "shear"}


def tested(kind, folder):
    """A results file of a test of that kind, with ramps for its columns."""
    path, of = os.path.join(folder, "results.h5"), TESTS[kind]
    make("cylinder", path)
    with h5py.File(path, "r+") as file:
        scene = file["scene"][()].decode().replace("kind: compression", f"kind: {kind}")
        del file["scene"]
        file["scene"] = scene
        file.attrs["test_figures"] = "\n".join(f"{name}: {title}" for name, (title, _) in zip(of["figures"].split(), of["tiles"], strict=True))
        file.attrs["test_strain"], file.attrs["test_stress"] = f"strain of {kind}", f"stress of {kind}"
        for name, last in of["columns"].items():
            data = file.create_dataset("history/" + name, data=np.linspace(0, last, 800))
            data.attrs["unit"] = {"force": "N", "deflection": "m", "opening": "m", "dilation": "m"}.get(name, "Pa" if "stress" in name else "1")
        for name, (value, unit) in of["readings"].items():
            file.create_dataset("readings/" + name, data=[value]).attrs.update({"unit": unit, "absent": "" if np.isfinite(value) else "why not"})
    return report.Results(path)


def the_page_of_a_test_has_its_tiles_and_curves(kind, folder):
    results, of = tested(kind, folder), TESTS[kind]
    shown = re.findall(r'<div class="card"><span>(.*?)</span><b>(.*?)</b>(?:<small>(.*?)</small>)?', report.cards(results))
    assert [(html.unescape(title), value) for title, value, _ in shown] == of["tiles"], shown
    assert all(said == "why not" for _, value, said in shown if value == "–")
    figures = {}
    every = {**report_tests.CURVES, **report_curves.CURVES}
    for name, plot in ((name, every[name]) for name in (*sorted(OF_KINDS), "stress_strain")):
        kept = [(module, module.save) for module in (report_tests, report_curves)]
        for module, _ in kept:
            module.save = lambda figure, path, name=name: figures.__setitem__(name, figure)
        try:
            plot(results, "")
        finally:
            for module, save in kept:
                module.save = save
            report_curves.plt.close("all")
    assert OF_KINDS & set(figures) == set(of["curves"]), sorted(figures)
    for name, (y_label, x_label) in of["curves"].items():
        axes = figures[name].axes
        assert axes[0].get_ylabel().startswith(y_label) and axes[-1].get_xlabel() == x_label, (name, axes[0].get_ylabel(), axes[-1].get_xlabel())
        lines = [line for a in axes for line in a.lines if len(line.get_xdata()) > 100]
        assert lines, name
        for line in lines:  # each is a column of the history in the units of its axes
            y = np.asarray(line.get_ydata(), float)
            assert any(is_multiple(y, values) for values in columns_of(results, name)), name
    marks = [line for line in figures["stress_strain"].axes[0].lines if line.get_marker() in "^s"]
    assert len(marks) == of["marks"]
    for mark, name in zip(marks, ("crack_initiation_stress", "crack_damage_stress")):
        strain, stress, level = results.column("strain"), results.column("stress"), of["readings"][name][0]
        assert abs(mark.get_ydata()[0] * 1e6 - level) < 1 and abs(np.interp(mark.get_xdata()[0] / 100, strain, stress) - level) < 3e6, name
    words = results.words
    assert figures["stress_strain"].axes[0].get_xlabel() == words[0] + " [%]" and figures["stress_strain"].axes[0].get_ylabel().startswith(words[1] + " [")


def is_multiple(y, values):
    n = len(y)
    return any(len(v) >= n and np.allclose(y * factor, v[:n], rtol=1e-9, atol=1e-9 * np.nanmax(np.abs(v)))
               for v in (values,) for factor in (1, 1e6, 1e-6, 1e3, 1e-2, 1e9))


def columns_of(results, name):
    columns = [results.column(column) for column in results.history]
    if name == "lateral":
        columns.append(-0.5 * (results.column("stress_xx") + results.column("stress_yy")))
    return columns


def bursts_are_drawn_with_their_number_and_size_beside_the_stress(folder):
    path, drawn = os.path.join(folder, "results.h5"), []
    make("cylinder", path)
    results = report.Results(path)
    kept, report_curves.save = report_curves.save, lambda figure, _: drawn.append(figure)
    try:
        assert "5 bursts" in report_curves.plot_bursts(results, "")
    finally:
        report_curves.save = kept
    above, below, other = drawn[0].axes
    assert sum(bar.get_height() for bar in above.patches) == 5
    points = [line for line in below.lines if line.get_marker() == "o"][0]
    assert list(points.get_ydata()) == [1, 1, 3, 40, 2]
    assert np.allclose(points.get_xdata(), 1.75 * np.array([0.5, 0.7, 0.75, 0.85, 0.9]))  # strains relative to 1.75 % at the end
    assert np.allclose(other.lines[0].get_ydata() * 1e6, results.column("stress"))


def tables_beside_the_page_are_history_bursts_and_fragments(folder):
    make("disc", os.path.join(folder, "results.h5"))
    assert run_report(folder).returncode == 0
    heads, tables = {}, {}
    for name in ("report", "report_bursts", "report_fragments"):
        with open(os.path.join(folder, name + ".csv"), encoding="utf-8") as file:
            heads[name] = file.readline().strip().split(",")
            tables[name] = np.loadtxt(file, delimiter=",", ndmin=2)
    assert heads["report_bursts"] == ["size [1]", "time [s]"] and list(tables["report_bursts"][:, 0]) == [1, 1, 3, 40, 2]
    assert heads["report_fragments"] == ["centre_x [m]", "centre_y [m]", "centre_z [m]", "particles [1]"]
    assert tables["report"].shape == (400, len(heads["report"]))
    assert (tables["report_fragments"][:, 2] == 3 * tables["report_fragments"][:, 3]).all()
    make("no_bonds", os.path.join(folder, "results.h5"))
    with h5py.File(os.path.join(folder, "results.h5"), "r+") as file:
        file["bursts/time"], file["bursts/size"] = np.zeros(0), np.zeros(0, np.int32)  # nothing broke
    assert run_report(folder).returncode == 0
    assert not os.path.exists(os.path.join(folder, "report_bursts.csv")) and not os.path.exists(os.path.join(folder, "report_fragments.csv"))


SCENE = """law:
  stiffness: harmonic
  gamma: auto
  gamma_rule: volume
  pull: true
  softening: none
  softening_curve: linear
materials:
  - name: "my_rock"
    density: 2650
    contact_modulus: 10000000000
    kratio: 3.7000000000000002
    young: none
    alpha: 1
    friction: 0.29999999999999999
    rolling_friction: 0
    tensile_strength: 30000000
bonds:
  enabled: on
  radius_multiplier: 0
  moment_share: 1
damping:
  background:
    model: none
    coefficient: 0
  contact:
    restitution: 0.5
test:
  kind: compression
  length: 0.040000000000000001
  centre: 0.20000000000000001
"""


def parameters_have_units_and_few_digits_and_no_idle_keys(_):
    shown = dict(report_tests.parameters(SimpleNamespace(scene=SCENE)))
    assert shown == {"law · stiffness": "harmonic", "materials · density": "2650 kg/m3", "materials · contact modulus": "10 GPa",
                     "materials · kratio": "3.7", "materials · friction": "0.3", "materials · tensile strength": "30 MPa", "bonds · enabled": "on",
                     "damping · contact · restitution": "0.5", "test · kind": "compression", "test · length": "40 mm"}, shown
    two = SCENE.replace("bonds:", '  - name: "b_2"\n    density: 7800\nbonds:').replace("harmonic", "polyhedron").replace("radius_multiplier: 0", "radius_multiplier: 0.5")
    shown = dict(report_tests.parameters(SimpleNamespace(scene=two)))
    assert shown["materials · my_rock · density"] == "2650 kg/m3" and shown["materials · b_2 · density"] == "7800 kg/m3", shown
    assert shown["materials · my_rock · alpha"] == "1" and shown["bonds · moment share"] == "1" and shown["law · gamma rule"] == "volume"
    assert "materials · my_rock · contact modulus" not in shown


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
    """Some texts refer to the preceding one."""
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
    assert abs(length.sum() - 16) < 1e-12 and len(beside()._cut(5.0, False)) == 0, segments  # perimeter of 2 x 6 m
    low, high = beside().bounds(np.zeros(3), np.ones(3))
    assert (low == 0).all() and (high == [2, 6, 4]).all(), (low, high)
    low, high = beside().bounds(np.zeros(3), np.ones(3), most=2.5)  # a tool that is larger than the specimen is shown in part
    assert (low == 0).all() and (high == [2, 3.5, 3.5]).all(), (low, high)


def folds_of_bodies_are_drawn(folder):
    edges = report_shapes.folds(CUBE_FACETS, CUBE[CUBE_FACETS])
    assert len(edges) == 12 and (np.count_nonzero(CUBE[edges[:, 0]] != CUBE[edges[:, 1]], axis=1) == 1).all(), edges
    assert len(report_shapes.folds(CUBE_FACETS[1:], CUBE[CUBE_FACETS[1:]])) == 13  # a hole has sides


def walls_are_where_they_have_come_to(folder):
    import matplotlib.pyplot as plt

    axes = plt.figure().add_subplot()
    seen = beside()
    seen.draw_cut(axes, 1.0, (0, 2, -2, 6), False)
    lines = axes.collections[1].get_segments()  # edges behind the body; the wall in the plane of the picture has none
    assert len(axes.collections) == 3 and np.allclose(np.array(lines)[0][:, 1], -0.5), lines
    assert "rigid bodies" in seen.text() and "walls" in seen.text()
    assert beside(np.zeros((0, 3), int), "").text() == ""


def seen(scene, size, dimension=3, **given):
    """The data of the pictures for grains in a box of this size."""
    rng = np.random.default_rng(1)
    results = report.Results.__new__(report.Results)
    position = rng.uniform(0, 1, (400, 3)) * size
    columns = {"position": position, "radius": np.full(400, 0.01 * max(size)), **given}
    results.particles = {name: SimpleNamespace(value=value) for name, value in columns.items()}
    results.bodies, results.bonds, results.history, results.energy, results.scene = {}, {}, {}, {}, scene
    results.attributes, results.readings = {"dimension": str(dimension)}, {}
    return results


def gravity_or_z_is_up_unless_a_specimen_stands(folder):
    """The longest side gives no information."""
    ends, test = ("stress_lower", "stress_upper"), "test:\n  axis: x\n"
    varying = (('0, "9.81*(1 + 0.5*sin(2*pi*30*t))", 0', "y"), ("[[0, -9.81], [0.1, -5]], 0, 3", "x"), ('"500*sin(300*t)", -9.81, 0', "y"),
               ('0, "1 + t?", 9', "z"), ('"t.size", "9^9^9^9", 0', "z"))
    for given, up in varying:
        assert "xyz"[seen(f"gravity: [{given}]\n", (1.0, 1.0, 1.0)).up_axis()] == up, given
    for scene, columns, up in (("gravity: [0, 0, 0]\n", (), "z"), ("gravity: [0, -9.81, 0]\n", (), "y"), (test, (*ends, "normal_stress"), "z"), (test, ends, "x")):
        results = seen(scene, (9.0, 1.0, 1.0))
        results.history = dict.fromkeys(columns)
        assert "xyz"[results.up_axis()] == up, scene
    assert seen("", (9.0, 1.0, 0.0), dimension=2).up_axis() == 1


def a_bed_is_drawn_from_above_and_moving_grains_by_speed(folder):
    speed = np.linspace(0, 2, 1200).reshape(400, 3)
    low, high = (report_pictures.Specimen(seen("", size, velocity=speed)) for size in ((5.0, 4.0, 1.0), (1.0, 1.0, 3.0)))
    assert low.is_bed() and not high.is_bed()
    above, beside_it = (report_pictures.oblique(s)[2, 1] for s in (low, high))
    assert above > 0.7 > 0.3 > beside_it, (above, beside_it)
    assert [c[0] for c in low.colorings()] == ["Speed", "Displacement"]
    assert [c[0] for c in report_pictures.Specimen(seen("", (1.0, 1.0, 3.0))).colorings()] == ["Displacement"]


def colours_are_those_of_quantiles(folder):
    values = np.concatenate([np.linspace(10.0, 11.0, 1000), [0.0, 500.0]])  # all particles have moved, two have flown away
    _, _, norm = report_pictures.quantiles(values, "m")
    assert 10 <= norm.vmin < 10.1 and 10.9 < norm.vmax <= 11.1, (norm.vmin, norm.vmax)
    assert report_pictures.extend_of(values, norm) == "both"
    _, _, norm = report_pictures.quantiles(np.linspace(0, 1, 100), "1")
    assert norm.vmin == 0 and norm.vmax < 1


def links_lead_below_the_page(folder):
    assert report_page.linked("1", "run 1/report.html") == '<a href="run%201/report.html">1</a>'
    for path in ("/etc/passwd", "../x", "a/../../x", "javascript:alert(1)", "http://example.org"):
        assert report_page.linked("<1>", path) == "&lt;1&gt;", path


def panes_of_walls_are_before_the_specimen(folder):
    """Seen along y: the floor at -0.5 and a side at 0; a distant wall, or one with the whole specimen behind it, is
    not drawn."""
    panes = report_shapes.panes(beside().walls, np.zeros(3), np.array([2.0, 6.0, 1.0]))
    assert panes.shape == (2, 4, 3) and np.allclose(panes[0, :, 1], -0.5) and np.allclose(panes[1, :, 2], 0), panes
    for a, size in ((0, 2), (2, 1)):
        assert np.isclose(panes[0, :, a].min(), -0.06 * size) and np.isclose(panes[0, :, a].max(), 1.06 * size), panes
    assert len(report_shapes.panes(beside().walls, np.array([0, -9.0, 20.0]), np.array([2.0, -8.0, 21.0]))) == 0


def main():
    tests = [(f"report of {kind}", lambda folder, kind=kind: every_kind(kind, folder)) for kind in KINDS]
    tests += [(f"page of {kind}", lambda folder, kind=kind: the_page_of_a_test_has_its_tiles_and_curves(kind, folder)) for kind in TESTS]
    tests += [(f.__name__, f) for f in (
        bursts_are_drawn_with_their_number_and_size_beside_the_stress, tables_beside_the_page_are_history_bursts_and_fragments,
        parameters_have_units_and_few_digits_and_no_idle_keys,
        panes_of_walls_are_before_the_specimen, a_missing_file_is_refused, a_truncated_file_is_refused, a_text_file_is_refused, a_foreign_hdf5_file_is_refused,
        a_damaged_chunk_is_refused, stages_are_those_of_the_history, names_of_stages_and_legends_do_not_lie_over_each_other, curves_of_a_test_are_those_of_the_last_stage,
        the_line_of_the_modulus_lies_on_the_curve,
        curves_of_an_envelope_are_those_of_its_readings, each_of_several_envelopes_has_its_rows_and_its_reason, old_pictures_are_removed,
        a_term_of_the_ledger_is_drawn_by_its_kind_whatever_its_name,
        gravity_or_z_is_up_unless_a_specimen_stands, a_bed_is_drawn_from_above_and_moving_grains_by_speed, colours_are_those_of_quantiles,
        links_lead_below_the_page, a_report_without_matplotlib_has_curves_and_a_slice, bodies_are_cut_where_the_slice_is, folds_of_bodies_are_drawn, walls_are_where_they_have_come_to,
        the_command_reports_by_its_exit_code)]
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
