#!/usr/bin/python3
"""report.py OUTDIR: reads OUTDIR/results.h5, writes OUTDIR/report.html and OUTDIR/report/*.png. Where there is no
run but a packing, OUTDIR/packing.h5, the report is on that, and OUTDIR/packing.png shows it at a glance; of a sweep,
OUTDIR/sweep.h5, the page holds its pictures.

Exit codes: 0 done, 2 there is no results file that can be read, 3 a file may not be read or the report cannot be written.
"""
import os
import sys

import numpy as np

import report_plain  # before the modules that draw with matplotlib
from report_curves import CURVES, abscissa
from report_coupling import plot_together
from report_elements import plot_elements
from report_packing import write_packing_report
from report_page import STYLE, draw, escape, figure, table, write_page
from report_pictures import Specimen, cut, plot_slice, plot_surface
from report_files import FileFault, Unreadable, printable
from report_results import Results, quantity
from report_sweep import write_sweep_report
from report_tests import CURVES as TEST_CURVES
from report_tests import STATES, cards_of, parameters, plot_moments, write_csv

LARGEST = {"largest_stress": "largest stress (no peak)", "largest_strain": "strain at it"}


def error_text(name, column):
    """Returns "± 3.1 MPa" of the error budget, "" without an estimate."""
    if not np.isfinite(column.error):
        return ""
    if column.unit in ("", "1"):
        return f"± {100 * column.error:.2g} %" if "strain" in name else f"± {column.error:.2g}"
    return f"± {quantity(float(f'{column.error:.2g}'), column.unit)}"


def reading_text(name, column):
    value = float(np.asarray(column.value, float).reshape(-1)[0])
    shares = ("end_imbalance", "brittleness", "largest_fragment", "returned_energy")
    if column.unit in ("", "1") and ("strain" in name or name in shares) and np.isfinite(value):
        return f"{100 * value:.3g} %"
    return quantity(value, column.unit)


# --- tables --------------------------------------------------------------------------------------------

def readings_table(results):
    rows = []
    for name, column in results.readings.items():
        value = float(np.asarray(column.value, float).reshape(-1)[0])
        if not results.test_kind and not np.isfinite(value):
            continue  # Scenes without a test have none of them.
        si = f"{value:.6g} {'' if column.unit == '1' else column.unit}".strip() if np.isfinite(value) else ""
        meaning = f"absent: {column.absent}. ({column.text})" if column.absent else column.text
        rows.append((name.replace("_", " "), (reading_text(name, column), "number"), (error_text(name, column), "number"), (si, "si"), meaning))
    return table(rows, ("reading", "value", "error (95 of 100)", "in SI units", "meaning")) if rows else "<p>The run has no readings.</p>"


def stages_table(results):
    """A column for each stage that has rows; quantities without a value in any stage are left out. Empty for a single
    stage."""
    names = [name for name, _, rows in results.stages if rows and name in results.stage_readings]
    listed = [results.stage_readings[name] for name in names]
    if len(names) < 2:
        return ""
    rows = []
    for reading in dict.fromkeys(key for readings in listed for key in readings):
        columns = [readings.get(reading) for readings in listed]
        if any(c is not None and np.isfinite(np.asarray(c.value, float)).all() for c in columns):
            rows.append((reading.replace("_", " "), *((reading_text(reading, c) if c is not None else "–", "number") for c in columns)))
    if not rows:
        return ""
    return ('<h2>Readings of the stages</h2>\n<p class="soft">Strains, displacements and broken bonds count from the start of each stage. If a value '
            "is absent (–), the reason is in <code>results.h5</code> and <code>summary.json</code>.</p>\n" + table(rows, ("reading", *names)))


def count_rows(results):
    state = results.bond_state
    rows = [("particles", results.particle_count)] if results.particle_count or not results.element_count else []
    if results.element_count:
        rows += [("nodes", len(results.nodes["position"].value) if "position" in results.nodes else 0),
                 ("elements", results.element_count)]
    if not results.particle_count and results.element_count:
        return count_cells(rows)
    removed = results.particle("removed")
    if removed is not None and np.any(removed):
        rows.append(("removed particles", int(np.count_nonzero(removed))))
    if len(state):
        broken, left = int(np.isin(state, (1, 2)).sum()), int((state == 3).sum())
        dormant = int(results.dormant.sum())
        if dormant:
            rows += [("dormant particles, in elements", dormant), ("active particles", results.particle_count - dormant)]
        rows += [("bonds of active particles" if dormant else "bonds at the start", len(state)),
                 ("bonds per particle", f"{2 * len(state) / max(1, results.particle_count - dormant):.3g}"),
                 ("broken in tension", int((state == 1).sum())),
                 ("broken in shear", int((state == 2).sum())),
                 ("broken, of all", f"{100 * broken / len(state):.3g} %")]
        for number, text in ((4, "bonds that soften"), (5, "bonds that yielded")):
            if np.any(state == number):
                rows.append((text, int((state == number).sum())))
        if left:
            rows.append(("bonds that left with removed particles", left))
    else:
        rows.append(("bonds", 0))
    return count_cells(rows)


def count_cells(rows):
    return [(a, (f"{b:,}".replace(",", " ") if isinstance(b, int) else b, "number")) for a, b in rows]


def fact_rows(results):
    step, time = results.column("step"), results.column("time")
    steps = results.attribute("steps") or (f"{int(np.nanmax(step))}" if step is not None else "")
    dt = results.attribute("dt")
    if not dt and step is not None and time is not None and np.nanmax(step) > 0:
        dt = np.nanmax(time) / np.nanmax(step)
    phases = [np.nan_to_num(float(np.asarray(c.value).reshape(-1)[0])) for c in results.profile.values()]
    seconds = float(results.attribute("seconds") or sum(phases))
    cpu = results.attribute("cpu_seconds")
    rows = [(label, results.attribute(name)) for label, name in (
        ("version", "version"), ("build", "build"), ("instruction set", "isa"), ("precision", "precision"),
        ("threads", "threads"))]
    rows += [("dimension", results.dimension), ("time step", quantity(float(dt), "s") if dt else ""),
             ("steps", steps), ("simulated time", quantity(float(np.nanmax(time)), "s") if time is not None else ""),
             ("wall time", f"{seconds:.3g} s" if seconds else ""),
             ("processor time, all threads", f"{float(cpu):.3g} s" if cpu else ""),
             ("energy residual", residual_text(results)),
             ("volume", volume_text(results)),
             ("stopped because", results.attribute("stop_reason")), ("state hash", results.attribute("state_hash")),
             ("scene file", results.attribute("scene_file"))]
    return [(a, (b, "number" if a != "scene file" else "")) for a, b in rows if str(b)]


def volume_text(results):
    value, of = results.attribute("volume"), results.attribute("volume_of")
    return f"{float(value):.4g} m³ ({of})" if value else ""


def residual_text(results):
    value = results.scalar(results.energy, "residual")
    if not np.isfinite(value):
        return ""
    unit = results.energy["residual"].unit
    return f"{value:.2e} of the energy throughput" if unit in ("", "1") else quantity(value, unit)


# --- figures -------------------------------------------------------------------------------------------

def specimen_of(results):
    """Returns None without particles."""
    specimen = Specimen(results) if results.particle_count and results.particle("position") is not None else None
    return specimen if specimen and specimen.count else None


def draw_figures(results, folder):
    """Removes old pictures and draws all possible ones into folder/report; returns {name: caption}."""
    specimen = specimen_of(results)
    there = specimen is not None
    jobs = {name: (lambda path, plot=plot: plot(results, path) if results.rows or plot is CURVES["profile"] else None)
            for name, plot in CURVES.items()}
    jobs.update({name: (lambda path, plot=plot, at_end=name in STATES: plot(results, path) if results.rows or at_end else None)
                 for name, plot in TEST_CURVES.items()})
    jobs["moments"] = lambda path: plot_moments(results, folder, path) if there else None
    jobs["surface"] = lambda path: plot_surface(specimen, path) if there else None
    jobs["elements"] = lambda path: plot_elements(results, path)
    jobs["together"] = lambda path: plot_together(results, path)
    jobs["slice"] = lambda path: plot_slice(specimen, results, path) if there else None
    return draw(jobs, folder)


# --- the page ------------------------------------------------------------------------------------------

def banner(results):
    lines = [line.partition(": ") for line in results.attribute("warnings").splitlines()]
    warnings = "".join(f'<p class="warning"><b>{escape(name.replace("_", " ").capitalize())}.</b> {escape(said)}</p>'
                       for name, _, said in lines)
    if results.finished:
        return warnings
    return warnings + ('<p class="warning"><b>Unfinished.</b> The run is in progress or was interrupted; '
            "this page shows its state when the file was written.</p>")


def percent(share):
    """"20", "0.4": never an exponent."""
    return f"{100 * share:.0f}" if share >= 0.01 else f"{100 * share:.1g}"


def in_unit_of(column):
    """The causes of an error as shares of it, "(packing 2.4e+06 estimated, ...)", so that the largest is seen."""
    parts = [part.split() for part in column.error_causes.strip("()").split(", ") if part]
    value = abs(float(np.asarray(column.value, float).reshape(-1)[0]))
    named = [(" ".join(words[:-2]), float(words[-2]) / value, words[-1]) for words in parts if len(words) > 2]
    largest = sorted(named, key=lambda cause: -cause[1])
    return "(" + ", ".join(f"{name} {percent(share)} % {how}" for name, share, how in largest) + ")" if largest else ""


def cards_without_test(results):
    """Figures of a scene that is not a test: simulated time, moving bodies, broken bonds."""
    shown, time = [], results.column("time")
    if time is not None:
        shown.append(("simulated time", quantity(float(np.nanmax(time)), "s"), ""))
    for name, title in (("kinetic", "kinetic energy at the end"), ("friction", "lost by friction")):
        value = results.scalar(results.energy, name)
        if np.isfinite(value) and value != 0:
            shown.append((title, quantity(value, "J"), ""))
    broken = int(np.isin(results.bond_state, (1, 2)).sum())
    if len(results.bond_state):
        shown.append(("broken bonds", f"{broken} of {len(results.bond_state)}", ""))
    return shown


def cards(results):
    """The main readings. A missing reading is shown with the reason; a stress that is no peak has a name of its own."""
    shown = []
    for name, title in cards_of(results):
        other = name.replace("peak", "largest")
        if name != other and other in results.readings and not np.isfinite(results.scalar(results.readings, name)):
            name, title = other, LARGEST[other]
        if name in results.readings:
            column = results.readings[name]
            budget = f"{error_text(name, column)} {in_unit_of(column)}".strip()
            shown.append((title, reading_text(name, column), column.absent or budget))
    shown += [] if results.test_kind else cards_without_test(results)
    inside = "".join(f'<div class="card"><span>{escape(title)}</span><b>{escape(value)}</b>'
                     + (f'<small>{escape(absent)}</small>' if absent else "") + "</div>"
                     for title, value, absent in shown)
    return f'<div class="cards">{inside}</div>' if inside else ""


def bodies_text(results):
    dormant = int(results.dormant.sum())
    parts = [f"{results.particle_count} particles" + (f" ({dormant} dormant)" if dormant else "")] if results.particle_count or not results.element_count else []
    return ", ".join(parts + ([f"{results.element_count} elements"] if results.element_count else []))


def page(results, captions):
    title = results.attribute("title") or "gneiss run"
    curves = "".join(figure(n, captions) for n in (*TEST_CURVES, *CURVES) if n != "profile" and n not in STATES)
    if report_plain.MISSING:
        curves = report_plain.curves(results, *abscissa(results))
    if not curves:
        curves = "<p>The history has no rows: there is no curve to draw.</p>"
    pictures = figure("moments", captions, "wide") + figure("surface", captions, "wide") + figure("slice", captions, "wide")
    broken = "".join(figure(n, captions) for n in STATES)
    pictures += f'<div class="grid">{broken}</div>' if broken else ""
    pictures += figure("together", captions, "wide") + figure("elements", captions, "wide")
    if report_plain.MISSING:
        specimen = specimen_of(results)
        pictures = report_plain.NOTE + (report_plain.slice_of(specimen, cut(specimen)) if specimen else "")
    scene = ""
    if results.scene:
        scene = ("<details><summary>The resolved scene: every key, SI units</summary>"
                 f"<pre>{escape(results.scene)}</pre></details>")
    subtitle = " · ".join(filter(None, (
        f"gneiss {results.attribute('version')}", f"{results.dimension}D", bodies_text(results),
        results.attribute("stop_reason"))))
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title><style>{STYLE}</style></head><body>
<h1>{escape(title)}</h1>
<p class="soft">{escape(subtitle)}</p>
{banner(results)}
{cards(results)}
<h2>Curves</h2>
<div class="grid">{curves}</div>
<h2>Specimen</h2>
{pictures or "<p>There are no particles to draw.</p>"}
<h2>Readings</h2>
{readings_table(results)}
{stages_table(results)}
<h2>Parameters</h2>
{table(parameters(results)) if results.scene else "<p>The file holds no scene.</p>"}
<h2>Run</h2>
<div class="tables"><div>{table(fact_rows(results))}</div><div>{table(count_rows(results))}</div>
{figure("profile", captions)}</div>
<h2>Scene</h2>
{scene or "<p>The file holds no scene.</p>"}
<p class="soft">Numbers and arrays: <code>results.h5</code>, next to this page; the history also as <code>report.csv</code>, bursts and fragments as <code>report_bursts.csv</code> and <code>report_fragments.csv</code> where there are some.</p>
</body></html>
"""


def write_report(folder):
    path, packing = (os.path.join(folder, name) for name in ("results.h5", "packing.h5"))
    if report_plain.MISSING and not os.path.exists(path):
        raise OSError("packings and sweeps are drawn by matplotlib: sudo apt install python3-matplotlib")
    if os.path.exists(packing) and not os.path.exists(path):
        return write_packing_report(folder)
    if os.path.exists(os.path.join(folder, "sweep.h5")) and not os.path.exists(path):
        return write_sweep_report(folder)
    results = Results(path)
    results.check_summary(os.path.join(folder, "summary.json"))
    write_csv(results, folder)
    return write_page(folder, page(results, {} if report_plain.MISSING else draw_figures(results, folder)))


def main(arguments):
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("usage: report.py OUTDIR (the output folder of a run, a packing or a sweep)", file=sys.stderr)
        return 2
    try:
        print(printable(write_report(arguments[0])))
    except Unreadable as e:
        print(printable(f"gneiss: input error: {e}"), file=sys.stderr)
        return 2
    except FileFault as e:
        print(printable(f"gneiss: file error: {e}"), file=sys.stderr)
        return 3
    except OSError as e:
        print(printable(f"gneiss: file error: the report cannot be written: {e}"), file=sys.stderr)
        return 3
    except Exception as e:  # A foreign file can hold anything: it is refused without a traceback.
        print(printable(f"gneiss: input error: {arguments[0]}: the results cannot be drawn: {type(e).__name__}: {e}"), file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
