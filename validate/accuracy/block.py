"""A block of discs between two plane walls: compression in the plane."""
import planar
import simple

WIDTH, HEIGHT, CLOSING = 0.05, 0.1, 0.1
LAST = 0.02  # strain at which a run ends at the latest


def motion(v):
    return {"walls.bottom.motion.vy": v / 2, "walls.top.motion.vy": -v / 2, "time.end": LAST * HEIGHT / v}


def more(v):
    plate = {"stiffness": "1 GN/m", "passive": True}
    return {"title": "compression of a block of discs",
            "walls": [{"name": "bottom", "point": [0, 0], "normal": [0, 1], "motion": {"vy": v / 2}, **plate},
                      {"name": "top", "point": [0, HEIGHT], "normal": [0, -1], "motion": {"vy": -v / 2}, **plate}],
            "test": {"kind": "compression", "axis": "y", "lower": "bottom", "upper": "top", "length": HEIGHT, "area": WIDTH},
            "time": {"end": LAST * HEIGHT / v, "stop": {"peak_drop": 0.2}}}


def section(study, pictures):
    v, count = (4 * CLOSING, 200) if study.quick else (CLOSING, 1000)
    rows = planar.rows_of(study, "compression-plane", {"rectangle": {"width": WIDTH, "height": HEIGHT}}, count, motion, more(v),
                          [2 * v, v] if study.quick else [8 * v, 4 * v, 2 * v, v, v / 2],
                          [100, 200] if study.quick else [250, 500, 1000, 2000, 4000], seeds=5 if study.quick else 10)
    case = simple.Case(
        "compression-plane", "Compression of a block of discs",
        f"{1e3 * WIDTH:g} by {1e3 * HEIGHT:g} mm, between plane walls closing at {v:g} m/s, {count} discs.",
        {"strength": lambda row: row["largest_stress" if study.quick else "peak_stress"], "E": lambda row: row["young_modulus_average"]}, rows, finest={"safety": min(r.value for r in rows["safety"])},
        units={"strength": (1e6, "MPa"), "E": (1e9, "GPa")}, models=("damping",), groups=planar.GROUPS, scattered=("particles",),
        more=lambda m: planar.size_words(m, "strength", False))
    return simple.section(pictures, case)
