"""The first section: the table of the cheapest settings and the picture of errors over seconds; and the table of slopes."""
import cylinder
import machinery
import slopes
import words


def section(pictures, measured):
    yade = machinery.yade()
    rows = [row for m in measured for row in cylinder.front_rows(m, yade)]
    table = words.table(["case", "reading", "contacts", *(f"{100 * wanted:.0f} %" for wanted in cylinder.WANTED)], rows)
    limits = "; ".join(f"{m.case}: strength {m.limit('strength') / 1e6:.1f} MPa, E {m.limit('E') / 1e9:.2f} GPa" for m in measured)
    counts = measured[0].by_count
    return "\n\n".join([
        "## For an error, the cheapest settings",
        table,
        "Contacts **calibrated**: their strength and stiffness are chosen for the number of particles that is used; only speed and packings cause errors. "
        "**Constant**: they are the same for every number, and the error is relative to the limit "
        f"of many particles from the fits below ({limits}){distant(measured)} The error is that of the mean over the given number of packings: "
        "the root of the sum of squares of bias and of scatter over the root of their number. Only settings that were run are included, with damping and bonds of the sections below. "
        f"YADE's seconds are computed, not measured: particle-steps times its measured seconds for one "
        f"({1e6 / yade['particle_steps']:.2f} us, one thread) and its {yade['longer']:.1f} times as many steps "
        f"([both on rock-a](performance.md#beside-other-codes)); its packing is not counted.",
        cylinder.draw_front(pictures, measured),
        f"Crosses: runs of one packing, one axis at a time, relative to the finest run of that axis (for damping, which is a choice, to the base). "
        f"Green: {min(counts)} to {max(counts)} particles at several speeds, calibrated. Black: the front, the smallest error at each cost. Dotted: the floors."])


def distant(measured):
    """The distance of the largest runs from their limits, where it is large."""
    far = []
    for m in measured:
        for reading in ("strength", "E"):
            off = cylinder.column(m.by_count[max(m.by_count)], reading).mean() / m.limit(reading) - 1
            if abs(off) > 0.05:
                far.append(f"{reading} in {m.case} {words.signed(off)}")
    if not far:
        return "."
    return f", from which {max(measured[0].by_count)} particles are still far: {', '.join(far)}. Such a limit is uncertain; calibrate."


def slopes_section(rows):
    head = ["case", "reading", "effect", "kind", "group g", "error", "standard error (of the exponent)", "measured for g", "points"]
    first = [row for row in rows if row["case"] in ("compression", "tension") and row["reading"] in ("strength", "E")]
    return "\n\n".join([
        "## Slopes",
        "Contributions to the error, as laws over dimensionless groups that are valid in the measured range. They are available as numbers in "
        "`validate/accuracy/slopes.csv`. Bias: positive is too large; scatter: a standard deviation.",
        words.table(head, slopes.table_rows(first)),
        "<details><summary>All slopes</summary>", words.table(head, slopes.table_rows(rows)), "</details>"])
