"""The Brazilian disc between two plane walls, in discs."""
import planar
import simple

DIAMETER, CLOSING = 0.05, 0.08
LAST = 0.02  # closing at which a run ends at the latest, over the diameter


def motion(v):
    return {"walls.bottom.motion.vy": v / 2, "walls.top.motion.vy": -v / 2, "time.end": LAST * DIAMETER / v}


def more(v):
    plate = {"stiffness": "1 GN/m", "passive": True}
    return {"title": "Brazilian disc",
            "walls": [{"name": "bottom", "point": [0, -DIAMETER / 2], "normal": [0, 1], "motion": {"vy": v / 2}, **plate},
                      {"name": "top", "point": [0, DIAMETER / 2], "normal": [0, -1], "motion": {"vy": -v / 2}, **plate}],
            # 2 F / (pi D): the tension across the middle, per 1 m of thickness
            "test": {"kind": "compression", "axis": "y", "lower": "bottom", "upper": "top", "length": DIAMETER, "area": 3.14159265 * DIAMETER / 2},
            "time": {"end": LAST * DIAMETER / v, "stop": {"peak_drop": 0.3}}}


def section(study, pictures):
    v, count = (4 * CLOSING, 200) if study.quick else (CLOSING, 1000)
    rows = planar.rows_of(study, "brazilian", {"disc": {"diameter": DIAMETER}}, count, motion, more(v),
                          [2 * v, v] if study.quick else [8 * v, 4 * v, 2 * v, v, v / 2],
                          [100, 200] if study.quick else [500, 1000, 2000, 4000])
    case = simple.Case(
        "brazilian", "Brazilian disc",
        f"{1e3 * DIAMETER:g} mm, between plane walls closing at {v:g} m/s, {count} discs. Strength: 2F/(pi D) at the peak"
        f"{' or the end' if study.quick else ''}.",
        {"strength": lambda row: row["largest_stress" if study.quick else "peak_stress"]}, rows, finest={"safety": min(r.value for r in rows["safety"])},
        units={"strength": (1e6, "MPa")}, models=("damping",), groups=planar.GROUPS, scattered=("particles",),
        more=lambda m: planar.size_words(m, "strength", False))
    return simple.section(pictures, case)
