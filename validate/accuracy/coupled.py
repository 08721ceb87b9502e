"""A notched beam of finite elements that turn into particles where it cracks, compared with the same beam of
particles only."""
import simple
import words
from machinery import Axis, key

LONG, HEIGHT, SPAN, DEPTH, WIDTH = 0.44, 0.1, 0.4, 0.03, 0.002
YOUNG, POISSON, DENSITY = 30e9, 0.16, 2400.0  # elastic constants and density of the packing
CELL, ZONE = 8e-3, 24e-3
POLYGON = [[0, 0], [LONG / 2 - WIDTH / 2, 0], [LONG / 2 - WIDTH / 2, DEPTH], [LONG / 2 + WIDTH / 2, DEPTH], [LONG / 2 + WIDTH / 2, 0],
           [LONG, 0], [LONG, HEIGHT], [0, HEIGHT]]


def motion(v):
    """The load starts slowly; a deflection of about 80 um breaks the beam."""
    return [[0, 0], [4e-6 / v, -v]], 80e-6 / v


def body(specimen, v):
    return {"dimension": 2, "specimen": {**specimen, "group": 1},
            "materials": [{"name": "concrete", "density": DENSITY, "contact_modulus": "22.4 GPa", "kratio": 3, "friction": 0.5,
                           "tensile_strength": "4 MPa", "shear_strength": "12 MPa"}],
            "law": {"stiffness": "harmonic"}, "bonds": {"interaction_range": 0.1, "passive_gaps": True},
            "damping": {"background": {"model": "viscous", "coefficient": 400}},
            "test": {"kind": "bending", "axis": "y", "lower": ["left", "right"], "upper": "load", "span": SPAN, "height": HEIGHT, "notch": DEPTH},
            "time": {"end": motion(v)[1], "stop": {"peak_drop": 0.4}},
            "output": {"history_rows": 2000, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


def alone(specimen, v, radius):
    """The beam of particles; supports and load are as wide as five of them."""
    places = {"left": ((LONG - SPAN) / 2, 0, {"vx": 0, "vy": 0}), "right": ((LONG + SPAN) / 2, 0, {"vy": 0}), "load": (LONG / 2, HEIGHT, {"vy": motion(v)[0]})}
    half = 2.5 * radius
    return {**body(specimen, v), "title": "notched beam of particles",
            "sets": [{"name": name, "select": {"box": {"min": [x - half, y - half], "max": [x + half, y + half]}}, "motion": how}
                     for name, (x, y, how) in places.items()]}


def adaptive(specimen, v):
    """The beam of elements; the packing is ready within a hundred millimetres of the notch."""
    return {**body(specimen, v), "title": "notched beam of elements that turn into particles",
            "elements": {"beam": {"length": LONG, "height": HEIGHT, "span": SPAN, "notch_depth": DEPTH, "notch_width": WIDTH, "cell": CELL},
                         "materials": [{"young": YOUNG, "poisson": POISSON, "density": DENSITY}],
                         "motions": [{"name": "left", "group": "support_left", "motion": {"vx": 0, "vy": 0}},
                                     {"name": "right", "group": "support_right", "motion": {"vy": 0}},
                                     {"name": "load", "group": "load", "motion": {"vy": motion(v)[0]}}]},
            "couple": {"convert": {"box": {"min": [LONG / 2 - 0.1, -1e-3], "max": [LONG / 2 + 0.1, HEIGHT + 1e-3]}, "width": ZONE, "stress": 1e6,
                                   "every": 100}}}


def speed(v):
    table, end = motion(v)
    return {"elements.motions.load.motion.vy": table, "time.end": end}


def axes(v):
    return [Axis("stress of conversion", [0.5e6, 1e6, 1.5e6, 2e6, 3e6], key("couple.convert.stress")),
            Axis("zone", [24e-3, 36e-3, 48e-3], key("couple.convert.width")),
            Axis("steps between looks", [50, 100, 400, 1600], key("couple.convert.every")),
            Axis("cell", [4e-3, 6e-3, 8e-3], key("elements.beam.cell")),
            Axis("velocity", [8 * v, 4 * v, 2 * v, v], speed),
            Axis("safety", [0.9, 0.5], key("time.safety")),
            Axis("precision", ["double", "mixed"], key("run.precision"), ["double", "mixed"])]


def strength(row):
    """Strength from a run that has reached its end: the curve after conversion has halted is not known."""
    halted = any(one["name"] == "conversion_halted" for one in row.summary.get("warnings", []))
    return float("nan") if halted else row["flexural_strength"]


def saved(truth, rows):
    """Ratio of the cost of the beam of particles to that of the cheapest coupled beam with the same error."""
    whole, text = truth.seconds, []
    for limit in (0.05, 0.02, 0.01):
        near = [row for same in rows.values() for row in same if abs(strength(row) / strength(truth) - 1) <= limit]
        if near:
            best = min(near, key=lambda row: row.seconds)
            text.append(f"within {words.percent(limit)} of its strength the cheapest takes {words.seconds(best.seconds)} s "
                        f"({best.axis} {words.plain(best.value)}), {best.seconds / whole:.2f} of it")
    return (f"The beam of particles alone takes {words.seconds(whole)} s. " + ("; ".join(text).capitalize() + ". " if text else "")
            + "Runs without a strength ended where conversion would have gone beyond the packing or reached the load.")


def section(study, pictures):
    v, radius = (16e-3, 2e-3) if study.quick else (2e-3, 1e-3)
    packed = {"polygon": POLYGON, "mean_radius": radius, "density_basis": "bulk", "packing": {"overlap": "passive", "size_variation": 0.1}}
    name, request = f"coupled-{radius:g}", {"dimension": 2, "specimen": packed, "run": {"seed": 1}}
    shaken = list(range(2 if study.quick else 5))
    files = {"specimen.file": [str(study.packed(name, request, k)) for k in shaken]}
    specimen = {"file": files["specimen.file"][0], "material": "concrete", "density_basis": "bulk"}
    copies = Axis("round-off", shaken, lambda k: {"specimen.file": files["specimen.file"][k]}, shaken[:1] if study.quick else shaken)
    particles = study.axis("coupled", alone(specimen, v, radius), Axis("particles alone", shaken, copies.settings, shaken[:1]))
    made = [copies, *axes(v)]
    rows = {axis.name: study.axis("coupled", adaptive(specimen, v), axis) for axis in made}
    rows = {axis: found for axis, found in rows.items() if found}
    truth = particles[0]
    case = simple.Case(
        "coupled", "Notched beam of elements that turn into particles",
        f"{1e3 * LONG:g} x {1e3 * HEIGHT:g} mm, span {1e3 * SPAN:g} mm, notch {1e3 * DEPTH:g} mm, discs of {1e3 * radius:g} mm, pressed at {1e3 * v:g} mm/s; "
        f"elements convert at 1 MPa, zones are {1e3 * ZONE:g} mm wide, cells {1e3 * CELL:g} mm. The error is relative to the same packing without elements, "
        "all of which is active from the start; that of the stiffness includes the error of the modulus given to the elements.",
        {"strength": strength, "stiffness": lambda row: row["stiffness"]},
        {"particles alone": particles, **rows}, truth={"strength": lambda row: strength(truth), "stiffness": lambda row: truth["stiffness"]},
        units={"strength": (1e6, "MPa"), "stiffness": (1e6, "MN/m")}, scattered=("particles alone",), more=lambda m: saved(truth, rows))
    return simple.section(pictures, case)
