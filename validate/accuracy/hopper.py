"""A silo that discharges through a hole in its flat bottom: flow rate and dissipated energy."""
import simple
from machinery import Axis, key

RADIUS, DENSITY, YOUNG, POISSON, GRAVITY = 1.5e-3, 2500.0, 2e6, 0.25, 9.81
SILO, HOLE, GRAINS, OPENS, END = 0.03, 0.018, 1000, 0.3, 1.0  # m, m, s, s
FEW = {"grains": 60, "end": 0.3, "opens": 0.15, "young": 2e5}  # settings of the quick form
TERMS = ["energy.work_gravity", "energy.friction", "energy.contact_damping", "energy.residual"]
PRESSURE = DENSITY * GRAVITY * SILO  # pressure of grains as deep as the silo is wide, without their voids


def scene(quick):
    take = FEW if quick else {"grains": GRAINS, "end": END, "opens": OPENS, "young": YOUNG}
    t = take["opens"]
    opens = [[0, 0], [t, 0], [t + 0.01, 1], [t + 0.04, 1], [t + 0.05, 0]]
    return {"title": "a silo empties", "dimension": 3,
            "materials": [{"name": "grain", "density": DENSITY, "young": take["young"], "poisson": POISSON, "friction": 0.5, "restitution": 0.5}],
            "law": {"stiffness": "hertz"}, "gravity": [0, 0, -GRAVITY],
            "sources": [{"name": "feed", "cylinder": {"diameter": SILO - 4e-3, "height": 0.01}, "origin": [0, 0, 0.15], "rate": 20000, "total": take["grains"],
                         "mean_radius": RADIUS, "size_ratio": 1.2, "velocity": [0, 0, -1]}],
            "sinks": [{"name": "outlet", "plane": {"point": [0, 0, -0.02], "normal": [0, 0, -1]}}],
            "bodies": [{"name": "silo", "cylinder": {"diameter": SILO, "height": 0.17, "sides": 24, "open": True}, "friction": 0.5},
                       {"name": "bottom", "cylinder": {"diameter": HOLE, "upper_diameter": SILO, "height": 1e-4, "sides": 24, "open": True}, "friction": 0.5},
                       {"name": "slide", "box": {"size": [0.024, 0.024, 0.004]}, "origin": [-0.012, -0.012, -0.0041], "friction": 0.5, "motion": {"vx": opens}}],
            "domain": {"min": [-0.2, -0.2, -0.05], "max": [0.2, 0.2, 0.25], "lost": "remove"},
            "time": {"end": take["end"]}, "output": {"history_rows": 400, "snapshots": 0, "checkpoint": "off"}, "run": {"threads": 1}}


def sides(count):
    """Settings for the number of sides of the prisms that represent the silo and its hole."""
    return {"bodies.silo.cylinder.sides": count, "bodies.bottom.cylinder.sides": count}


AXES = [Axis("steps per contact", [48, 24, 12, 6], key("time.contact_steps"), [24, 12], seeds=6),
        Axis("stiffness", [2e5, 2e6, 2e7], key("materials.grain.young"), seeds=6),
        Axis("sides", [12, 24, 48], sides, seeds=6),
        Axis("restitution", [0.2, 0.5, 0.8], key("materials.grain.restitution"), seeds=6),
        Axis("precision", ["double", "mixed"], key("run.precision"), seeds=6),
        Axis("round-off", [0.0, 1e-12, 2e-12, 3e-12, 4e-12, 5e-12], lambda x: {"sources.feed.origin": [x * RADIUS, 0, 0.15]})]


def rate(row):
    """Mean flow in kg/s between a quarter and three quarters of the discharge."""
    found = row.summary["sinks"][0]["steady_rate"]
    return float("nan") if found is None else found


def out(row):
    """Share of the grains that run out; the others lie on the bottom."""
    return row.summary["sinks"][0]["number"] / row.summary["sources"][0]["number"]


def dissipated(row):
    """Share of the energy supplied by gravity and the source that friction and dashpots dissipated; the grains
    carried the rest away."""
    return (row["energy.friction"] + row["energy.contact_damping"]) / (row["energy.work_gravity"] + row.summary["sources"][0]["energy"])


def section(study, pictures):
    rows = {axis.name: study.axis("hopper", scene(study.quick), axis, readings=TERMS) for axis in AXES}
    rows = {name: found for name, found in rows.items() if found}
    case = simple.Case(
        "hopper", "A silo that empties",
        f"{GRAINS} grains of {RADIUS * 1e3:g} mm (Hertz-Mindlin, friction 0.5, restitution 0.5, {YOUNG / 1e6:g} MPa) fill a silo of {SILO * 1e3:g} mm with a flat "
        f"bottom; at {OPENS:g} s a slide frees a hole of {HOLE * 1e3:g} mm. The error is relative to the most steps, the stiffest grains, "
        "the most sides, and the first value of other axes.",
        {"rate": rate, "share that runs out": out, "dissipated": dissipated, "worst residual": lambda row: row["energy_residual"]}, rows,
        finest={"steps per contact": max((row.value for row in rows.get("steps per contact", [])), default=0), "precision": "double", "round-off": 0.0},
        truth={"worst residual": lambda row: 0.0}, absolute=("worst residual",), models=("restitution",), units={"rate": (1, "kg/s")},
        groups={"steps per contact": ("1 / steps per contact", lambda row: 1 / row.value),
                "stiffness": ("density x g x width / Young's modulus", lambda row: PRESSURE / row.value),
                "sides": ("1 / sides", lambda row: 1 / row.value)},
        more=lambda m: simple.chance_words(m, "steps per contact", "rate"))
    return simple.section(pictures, case)
