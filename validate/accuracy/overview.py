"""The first section: the table of the cheapest settings and the picture of errors over seconds; and the table of slopes."""
import cylinder
import machinery
import slopes
import words


def section(pictures, measured):
    yade = machinery.yade()
    rows = [row for m in measured for row in cylinder.front_rows(m, yade)]
    table = words.table(["case", "reading", "error", "the cheapest of the settings that were run", "seconds", "seconds of YADE"], rows)
    limits = "; ".join(f"{m.case}: strength {m.limit('strength') / 1e6:.1f} MPa, E {m.limit('E') / 1e9:.2f} GPa" for m in measured)
    counts = measured[0].by_count
    return "\n\n".join([
        "## For an error, the cheapest settings",
        table,
        f"The error is that of the mean over so many packings: its distance from the limit, and the scatter of packings over the root of their "
        f"number, as the root of the sum of squares. The limit is that of many particles and slow loading, by the fits below, at the same contact "
        f"strength and damping ({limits}). YADE's seconds are not measured here: particle-steps times its measured seconds for one "
        f"({1e6 / yade['particle_steps']:.2f} us, one thread) and its {yade['longer']:.1f} times as many steps "
        f"([both on rock-a](evidence/performance.md#beside-other-codes)); its packing is not counted.",
        cylinder.draw_front(pictures, measured),
        f"Crosses: runs of one packing, an axis each, against the finest of that axis. Green: {min(counts)} to {max(counts)} particles at "
        f"several speeds, bias and scatter against the limit. Black: what nothing cheaper is better than. Dotted: the floors."])


def slopes_section(rows):
    table = words.table(["case", "reading", "effect", "kind", "group g", "error", "standard error (of the exponent)", "measured for g", "points"],
                        slopes.table_rows(rows))
    return ("## Slopes\n\nThe same as numbers in `validate/accuracy/slopes.csv`. Bias: positive is too large. Powers hold within the range measured.\n\n"
            + table)
