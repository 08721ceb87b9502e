/* What the readings of all tests look at: slopes, peaks, and why there is none. */
#include "measure/readings.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* A stress is a peak once it has fallen by this share: more than what vibrations and single bonds
 * take off a rising curve. */
static const double fall = 0.05;

/* --- absent --- */

char *gn_reason_of(gn_readings *r, gn_reading which) {
    return r->reason[which];
}

void gn_reading_absent(gn_readings *r, gn_reading which, const char *format, ...) {
    va_list args;
    va_start(args, format);
    if (!gn_reason_of(r, which)[0]) vsnprintf(gn_reason_of(r, which), GN_REASON_SIZE, format, args);
    va_end(args);
}

void gn_need_rows(const gn_curves *c, gn_reading which, gn_readings *r) {
    size_t rows = c->loading.last - c->loading.first;
    if (rows < 3)
        gn_reading_absent(
            r, which,
            "%zu history row%s between 1 and 50 %% of the largest stress, 3 are needed "
            "(output.history_rows)",
            rows, rows == 1 ? "" : "s");
}

void gn_need_modulus(gn_line_fit f, gn_reading which, gn_readings *r) {
    if (f.slope <= 0) gn_reading_absent(r, which, "the stress falls while the strain grows");
    if (f.error > gn_scatter_allowed * f.slope)
        gn_reading_absent(r, which, "the rows scatter: standard error of the slope %.0f %%",
                          100 * f.error / f.slope);
}

/* --- slopes and peaks --- */

/* How many parts of the way from the row before count each as a row: 1 where steps went on. */
static size_t parts_of(const gn_curves *c, size_t row, gn_row_span s) {
    const double wide = 1.5, most = 1e4;
    if (row == s.first || !(c->interval > 0)) return 1;
    double gap = (c->time[row] - c->time[row - 1]) / c->interval;
    return gap > wide ? (size_t)round(fmin(gap, most)) : 1;
}

static double part_of(const double *column, size_t row, size_t part, size_t parts) {
    if (part == parts) return column[row];
    double share = (double)part / (double)parts;
    return column[row - 1] + share * (column[row] - column[row - 1]);
}

gn_line_fit gn_line(const gn_curves *c, const double *x, const double *y, gn_row_span s) {
    if (!x || !y || s.last - s.first < 3) return (gn_line_fit){NAN, NAN};
    double n = 0, rows = (double)(s.last - s.first), mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
    for (size_t k = s.first; k < s.last; k++) n += (double)parts_of(c, k, s);
    for (size_t k = s.first; k < s.last; k++)
        for (size_t p = 1, parts = parts_of(c, k, s); p <= parts; p++)
            mean_x += part_of(x, k, p, parts) / n, mean_y += part_of(y, k, p, parts) / n;
    for (size_t k = s.first; k < s.last; k++)
        for (size_t p = 1, parts = parts_of(c, k, s); p <= parts; p++) {
            double dx = part_of(x, k, p, parts) - mean_x, dy = part_of(y, k, p, parts) - mean_y;
            xx += dx * dx;
            xy += dx * dy;
            yy += dy * dy;
        }
    if (!(xx > 0)) return (gn_line_fit){NAN, NAN};
    double slope = xy / xx,
           rest = fmax(0, yy - slope * xy) * (rows / n); /* over the rows there are */
    return (gn_line_fit){slope, sqrt(rest / (rows - 2) / xx)};
}

static double last_of(const gn_history *history, const char *name) {
    const double *column = gn_history_column(history, name);
    return column ? column[history->row_count - 1] : NAN;
}

/* Whether what is sheared slides by friction, over a third of the way of its ends or more: from
 * where the stress first comes within `fall` of its largest on, most of the work of the ends is
 * friction. */
static bool slides(const gn_curves *c) {
    const double *friction = gn_history_column(c->history, "energy_friction"),
                 *force = gn_history_column(c->history, "force"),
                 *way = gn_history_column(c->history, "deflection");
    const size_t last = c->history->row_count - 1;
    if (!gn_test_in(c->tested->kind, GN_TESTS_SHEARED) || !friction || !force || !way) return false;
    size_t first = 0;
    while (first < c->largest && !(c->stress[first] >= (1 - fall) * c->stress[c->largest])) first++;
    double work = 0;
    for (size_t k = first + 1; k <= last; k++)
        work += 0.5 * (force[k] + force[k - 1]) * (way[k] - way[k - 1]);
    return work > 0 && friction[last] - friction[first] > 0.5 * work &&
           way[last] - way[first] > (way[last] - way[0]) / 3;
}

const char *gn_no_peak(const gn_curves *c) {
    double least = c->stress[c->largest];
    for (size_t k = c->largest; k < c->history->row_count; k++) least = fmin(least, c->stress[k]);
    if (c->tested->elastic) return "finite elements do not fail";
    if (c->still) return "the ends never moved in the sense of the test";
    if (slides(c)) return NULL;
    if (last_of(c->history, "broken_tension") + last_of(c->history, "broken_shear") == 0)
        return "no bond has broken";
    if (least > (1 - fall) * c->stress[c->largest])
        return "the run ended before the peak: the stress has not fallen by 5 % from its largest";
    return NULL;
}

const char *gn_no_average_strain(const double *strain, size_t row) {
    if (!strain || isnan(strain[0])) return "the scene has no average strain";
    return isnan(strain[row]) ? "less than half of the specimen was left by then: no average strain"
                              : NULL;
}
