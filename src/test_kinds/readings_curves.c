/* Analysis of curves that the readings of all tests use: slopes, peaks, and the reasons for absent
 * ones. */
#include "test_kinds/curves.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Fraction by which a stress must have decreased to be a peak: more than vibrations and single
 * bonds cause on a rising curve. */
static const double fall = 0.05;

/* --- absent --- */

char *gn_reason_of(gn_readings *readings, gn_reading which) {
    return readings->reason[which];
}

void gn_reading_absent(gn_readings *readings, gn_reading which, const char *format, ...) {
    va_list args;
    va_start(args, format);
    if (!gn_reason_of(readings, which)[0])
        vsnprintf(gn_reason_of(readings, which), GN_REASON_SIZE, format, args);
    va_end(args);
}

static void need_rows(const gn_curves *curves, gn_reading which, gn_readings *readings) {
    size_t rows = curves->loading.last - curves->loading.first;
    if (rows < 3)
        gn_reading_absent(
            readings, which,
            "%zu history row%s between 1 and 50 %% of the largest stress, 3 are needed "
            "(output.history_rows)",
            rows, rows == 1 ? "" : "s");
}

double gn_modulus_by(double factor, double slope, gn_reading which, gn_readings *readings) {
    if (isnan(factor))
        gn_reading_absent(
            readings, which,
            "the section of the specimen varies along the axis by too much or too fast "
            "for a slender bar");
    return factor > 0 ? factor * slope : slope;
}

void gn_need_elastic_rows(const gn_curves *curves, gn_reading which, gn_readings *readings) {
    const size_t rows = curves->elastic.last - curves->elastic.first;
    if (!curves->cut_reason) need_rows(curves, which, readings);
    if (rows < 3 && curves->cut_reason)
        gn_reading_absent(
            readings, which,
            "%s at %.2g %% of the largest stress: %zu history row%s before that, 3 are needed "
            "(output.history_rows)",
            curves->cut_reason,
            100 * curves->stress[curves->elastic.last] / curves->stress[curves->largest], rows,
            rows == 1 ? "" : "s");
}

void gn_need_modulus(gn_line_fit fit, gn_reading which, gn_readings *readings) {
    if (fit.slope <= 0)
        gn_reading_absent(readings, which, "the stress falls while the strain grows");
    if (fit.error > gn_scatter_allowed * fit.slope)
        gn_reading_absent(readings, which, "the rows scatter: standard error of the slope %.0f %%",
                          100 * fit.error / fit.slope);
}

/* --- the elastic rows --- */

/* Fraction of the largest stress below which platens break single protruding grains, which is not
 * the failure of the specimen. */
static const double seating = 0.1;

/* Largest share of dissipation in bonds in the work, which is then the error of the slope of the
 * work over the square of the strain. */
static const double dissipated = 0.01;

double gn_breaks_until(const gn_curves *curves, size_t row) {
    const double *tension = gn_history_column(curves->history, "broken_tension"),
                 *shear = gn_history_column(curves->history, "broken_shear"),
                 *joints = gn_history_column(curves->history, "broken_joints");
    return (tension && shear ? tension[row] + shear[row] : 0) + (joints ? joints[row] : 0);
}

/* Returns a hundredth of the bonds through a section of the specimen. */
static double few_bonds(const gn_curves *curves) {
    const double *intact = gn_history_column(curves->history, "bonds_intact"),
                 d = curves->tested->dimension;
    return intact ? 0.01 * pow(fmax(intact[curves->begin], 0), (d - 1) / d) : 0;
}

/* Returns the first row of the span after a significant number of breaks; the end of the span if
 * there is none. */
static size_t first_break(const gn_curves *curves) {
    const double few = few_bonds(curves), most = curves->stress[curves->largest];
    double before = gn_breaks_until(curves, curves->loading.first);
    bool seated = false;
    size_t row = curves->loading.first;
    for (; row < curves->loading.last; row++) {
        if (gn_breaks_until(curves, row) - before > (seated ? 0 : few)) break;
        if (seated || curves->stress[row] < seating * most) continue;
        seated = true;
        before = gn_breaks_until(curves, row);
    }
    return row;
}

static double grown(const gn_curves *curves, const char *column, size_t row) {
    const double *e = gn_history_column(curves->history, column);
    return e ? e[row] - e[curves->begin] : 0;
}

static double stored(const gn_curves *curves, size_t row) {
    double sum = 0;
    for (size_t k = 0; k < curves->history->column_count; k++) {
        const gn_column *column = &curves->history->columns[k];
        if (strncmp(column->name, "energy_elastic_", 15) == 0)
            sum += column->value[row] - column->value[curves->begin];
    }
    return sum;
}

/* Returns the first row of the span in which a loss exceeds its share of the work. Without the
 * energy ledger losses are unknown. */
static size_t first_loss(const gn_curves *curves, const char *column) {
    size_t row = curves->loading.first;
    for (; row < curves->loading.last; row++) {
        const double lost = grown(curves, column, row);
        if (lost > dissipated * (lost + fmax(stored(curves, row), 0))) break;
    }
    return row;
}

void gn_find_elastic_rows(gn_curves *curves) {
    const size_t breaks = first_break(curves), yields = first_loss(curves, "energy_plasticity"),
                 softens = first_loss(curves, "energy_damage");
    curves->elastic = curves->loading;
    if (breaks < curves->elastic.last)
        curves->elastic.last = breaks, curves->cut_reason = "bonds break";
    if (yields < curves->elastic.last)
        curves->elastic.last = yields, curves->cut_reason = "bonds yield";
    if (softens < curves->elastic.last)
        curves->elastic.last = softens, curves->cut_reason = "bonds soften";
}

double gn_nonlinearity(const gn_curves *curves, gn_slope_of *slope) {
    const gn_row_span all = curves->elastic;
    const size_t middle = all.first + (all.last - all.first) / 2;
    if (all.last - all.first < 6) return 0;
    const double first = slope(curves, (gn_row_span){all.first, middle}),
                 second = slope(curves, (gn_row_span){middle, all.last});
    return fabs(0.5 * (second - first) / slope(curves, all));
}

/* --- slopes and peaks --- */

/* Returns the number of rows that the interval before a row replaces: 1 for time steps. */
static size_t parts_of(const gn_curves *curves, size_t row, gn_row_span span) {
    const double wide = 1.5, most = 1e4;
    if (row == span.first || !(curves->interval > 0)) return 1;
    double gap = (curves->time[row] - curves->time[row - 1]) / curves->interval;
    return gap > wide ? (size_t)round(fmin(gap, most)) : 1;
}

static double part_of(const double *column, size_t row, size_t part, size_t parts) {
    if (part == parts) return column[row];
    double share = (double)part / (double)parts;
    return column[row - 1] + share * (column[row] - column[row - 1]);
}

gn_line_fit gn_line(const gn_curves *curves, const double *x, const double *y, gn_row_span span) {
    if (!x || !y || span.last - span.first < 3) return (gn_line_fit){NAN, NAN};
    double n = 0, rows = (double)(span.last - span.first), mean_x = 0, mean_y = 0, xx = 0, xy = 0,
           yy = 0;
    for (size_t k = span.first; k < span.last; k++) n += (double)parts_of(curves, k, span);
    for (size_t k = span.first; k < span.last; k++)
        for (size_t p = 1, parts = parts_of(curves, k, span); p <= parts; p++)
            mean_x += part_of(x, k, p, parts) / n, mean_y += part_of(y, k, p, parts) / n;
    for (size_t k = span.first; k < span.last; k++)
        for (size_t p = 1, parts = parts_of(curves, k, span); p <= parts; p++) {
            double dx = part_of(x, k, p, parts) - mean_x, dy = part_of(y, k, p, parts) - mean_y;
            xx += dx * dx;
            xy += dx * dy;
            yy += dy * dy;
        }
    if (!(xx > 0)) return (gn_line_fit){NAN, NAN};
    double slope = xy / xx,
           rest = fmax(0, yy - slope * xy) * (rows / n); /* scaled to the actual number of rows */
    return (gn_line_fit){slope, sqrt(rest / (rows - 2) / xx)};
}

/* Tells whether the history counts breaks, and has none. */
static bool is_whole(const gn_curves *curves) {
    const gn_history *history = curves->history;
    return (gn_history_column(history, "broken_tension") ||
            gn_history_column(history, "broken_joints")) &&
           gn_breaks_until(curves, history->row_count - 1) == 0;
}

/* Tells whether the sheared specimen slides by friction over a third or more of the displacement of
 * its ends: after the stress has first come within `fall` of its largest value, most of the work of
 * the ends is friction. */
static bool slides(const gn_curves *curves) {
    const double *friction = gn_history_column(curves->history, "energy_friction"),
                 *force = gn_history_column(curves->history, "force"),
                 *way = gn_history_column(curves->history, "deflection");
    const size_t last = curves->history->row_count - 1;
    if (!gn_test_of(curves->tested->kind)->sheared || !friction || !force || !way) return false;
    size_t first = 0;
    while (first < curves->largest &&
           !(curves->stress[first] >= (1 - fall) * curves->stress[curves->largest]))
        first++;
    double work = 0;
    for (size_t k = first + 1; k <= last; k++)
        work += 0.5 * (force[k] + force[k - 1]) * (way[k] - way[k - 1]);
    return work > 0 && friction[last] - friction[first] > 0.5 * work &&
           way[last] - way[first] > (way[last] - way[0]) / 3;
}

const char *gn_no_peak(const gn_curves *curves) {
    double least = curves->stress[curves->largest];
    for (size_t k = curves->largest; k < curves->history->row_count; k++)
        least = fmin(least, curves->stress[k]);
    if (curves->tested->elastic) return "finite elements do not fail";
    if (curves->never_strained) return "the ends never moved in the sense of the test";
    if (slides(curves)) return NULL;
    if (is_whole(curves)) return "no bond has broken";
    if (least > (1 - fall) * curves->stress[curves->largest])
        return "the run ended before the peak: the stress has not fallen by 5 % from its largest";
    return NULL;
}

const char *gn_no_average_strain(const double *strain, size_t row) {
    if (!strain || isnan(strain[0])) return "the scene has no average strain";
    return isnan(strain[row]) ? "less than half of the specimen remained: no average strain" : NULL;
}
