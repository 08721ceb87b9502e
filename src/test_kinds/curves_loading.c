/* Readings of any loading along an axis, and those that several kinds of tests have. */
#include "test_kinds/curves.h"

#include <math.h>
#include <stdio.h>

/* At the peak, if there is one. */
void gn_read_at_peak(const gn_curves *c, gn_reading which, const double *column, double factor,
                     double *value, gn_readings *r) {
    const char *reason = gn_no_peak(c);
    if (reason) gn_reading_absent(r, which, "%s", reason);
    if (column) *value = factor * column[c->largest];
}

/* One of the average strain. */
void gn_read_strain_at_peak(const gn_curves *c, gn_reading which, const char *name, double *value,
                            gn_readings *r) {
    const double *column = gn_history_column(c->history, name);
    const char *reason = column ? gn_no_average_strain(column, c->largest) : NULL;
    gn_read_at_peak(c, which, column, 1.0, value, r);
    if (reason) gn_reading_absent(r, which, "%s", reason);
}

const double *gn_curves_tensor(const gn_curves *c, const char *name, int axis) {
    char full[32];
    snprintf(full, sizeof full, "%s_%c%c", name, "xyz"[axis], "xyz"[axis]);
    return gn_history_column(c->history, full);
}

void gn_read_slope(const gn_curves *c, gn_reading which, double *value, gn_readings *r) {
    gn_line_fit f = gn_line(c, c->strain, c->stress, c->elastic);
    const char *none = gn_no_average_strain(c->strain, c->history->row_count - 1);
    *value = f.slope;
    gn_need_elastic_rows(c, which, r);
    if (gn_test_of(c->tested->kind)->isotropic && isnan(f.slope) && none)
        gn_reading_absent(r, which, "%s", none);
    gn_need_modulus(f, which, r);
}

/* --- fracture energy --- */

/* What is left of the load when a section counts as broken through. */
static const double broken_through = 0.1;

/* Trapezoidal, from the first row to the last. */
void gn_read_fracture_energy(const gn_curves *c, gn_readings *r) {
    const gn_reading which = GN_READING_fracture_energy;
    const double *force = gn_history_column(c->history, "force"),
                 *way = gn_history_column(c->history, "deflection");
    const char *reason = gn_no_peak(c);
    size_t rows = c->history->row_count;
    if (reason) gn_reading_absent(r, which, "%s", reason);
    if (c->tested->falls)
        gn_reading_absent(r, which, "gravity does work on the specimen beside the ends");
    if (c->tested->halted)
        gn_reading_absent(r, which,
                          "conversion ended the run (conversion_halted): what elements beside the "
                          "crack would have borne or broken from there on is not known");
    if (!force || !way) return;
    double left = force[rows - 1] / force[c->largest], work = 0;
    if (left > broken_through)
        gn_reading_absent(r, which,
                          "the run ended with %.0f %% of the largest load, at most %.0f %% are "
                          "needed (time.stop.peak_drop, time.end)",
                          100 * left, 100 * broken_through);
    for (size_t k = 1; k < rows; k++)
        work += 0.5 * (force[k] + force[k - 1]) * (way[k] - way[k - 1]);
    r->fracture_energy = work / c->tested->section;
}

/* --- of any loading along an axis --- */

/* Rows from the first with a share of the largest stress to the first with another. */
static gn_row_span between(const gn_curves *c, double low, double high) {
    gn_row_span s = {.first = c->begin};
    const double most = c->stress[c->largest];
    while (s.first < c->largest && !(c->stress[s.first] >= low * most)) s.first++;
    s.last = s.first;
    while (s.last < c->largest && !(c->stress[s.last] > high * most)) s.last++;
    return s;
}

static void slope_between(const gn_curves *c, gn_reading which, double low, double high,
                          double *value, gn_readings *r) {
    gn_row_span s = between(c, low, high);
    gn_line_fit f = gn_line(c, c->strain, c->stress, s);
    *value = gn_modulus_by(c->tested->by_ends, f.slope, which, r);
    if (s.last - s.first < 3)
        gn_reading_absent(r, which,
                          "%zu history rows between %.0f and %.0f %% of the largest stress, 3 are "
                          "needed (output.history_rows)",
                          s.last - s.first, 100 * low, 100 * high);
    gn_need_axial(c, c->loading, which, r);
    gn_need_modulus(f, which, r);
}

/* Between two rows, whatever broke or yielded from the one to the other. */
static void read_secant(const gn_curves *c, gn_readings *r) {
    const gn_reading which = GN_READING_secant_modulus;
    const gn_row_span s = c->loading;
    double way = c->strain ? c->strain[s.last] - c->strain[s.first] : NAN;
    r->secant_modulus =
        gn_modulus_by(c->tested->by_ends, (c->stress[s.last] - c->stress[s.first]) / way, which, r);
    if (!(way > 0)) gn_reading_absent(r, which, "the strain does not grow up to half the stress");
    if (gn_reading_belongs(GN_READING_young_modulus, c->tested->kind, false))
        gn_need_axial(c, c->loading, which, r);
}

static void read_initiation(const gn_curves *c, gn_readings *r) {
    const gn_reading which = GN_READING_crack_initiation_stress;
    const char *reason = gn_no_peak(c);
    double all = gn_breaks_until(c, c->largest);
    size_t row = c->begin;
    while (row < c->largest && !(gn_breaks_until(c, row) >= 0.01 * all)) row++;
    r->crack_initiation_stress = c->stress[row];
    if (isnan(c->tested->fragments)) gn_reading_absent(r, which, "the scene has no bonds");
    if (reason) gn_reading_absent(r, which, "%s", reason);
    if (all < 100)
        gn_reading_absent(r, which, "%.0f bonds are broken at the peak, of 100 the first is 1 %%",
                          all);
}

/* The row of the least volume, if there are rows behind it before the peak. */
static void read_damage(const gn_curves *c, gn_readings *r) {
    const gn_reading which = GN_READING_crack_damage_stress;
    const char *reason = gn_no_peak(c);
    size_t row = c->begin;
    double least = INFINITY;
    for (size_t k = c->begin; k <= c->largest; k++) {
        double volume = 0;
        for (int a = 0; a < c->tested->dimension; a++)
            volume += c->average[a] ? c->average[a][k] : NAN;
        if (volume < least) least = volume, row = k;
    }
    r->crack_damage_stress = least < INFINITY ? c->stress[row] : NAN;
    if (reason) gn_reading_absent(r, which, "%s", reason);
    if (row == c->largest) gn_reading_absent(r, which, "the specimen loses volume up to the peak");
    if (row < c->loading.first || row == 0)
        gn_reading_absent(r, which, "the specimen gains volume from the start of loading on");
}

static void read_brittleness(const gn_curves *c, gn_readings *r) {
    const char *reason = gn_no_peak(c);
    double last = c->stress[c->history->row_count - 1];
    r->brittleness = 1 - fmax(last, 0) / c->stress[c->largest];
    if (reason) gn_reading_absent(r, GN_READING_brittleness, "%s", reason);
}

void gn_readings_of_loading(const gn_curves *c, gn_readings *r) {
    slope_between(c, GN_READING_tangent_modulus, 0.4, 0.6, &r->tangent_modulus, r);
    slope_between(c, GN_READING_average_modulus, 0.2, 0.8, &r->average_modulus, r);
    read_secant(c, r);
    read_initiation(c, r);
    read_damage(c, r);
    read_brittleness(c, r);
}

void gn_readings_of_breaks(const gn_tested *tested, gn_readings *r) {
    const gn_reading which[] = {GN_READING_events, GN_READING_b_value, GN_READING_fragments,
                                GN_READING_largest_fragment};
    for (size_t k = 0; k < sizeof which / sizeof *which; k++) gn_reason_of(r, which[k])[0] = '\0';
    gn_readings_of_bursts(tested, r);
    r->fragments = tested->fragments;
    r->largest_fragment = tested->largest_fragment;
    if (isnan(r->fragments)) {
        gn_reading_absent(r, GN_READING_fragments, "the scene has no bonds");
        gn_reading_absent(r, GN_READING_largest_fragment, "the scene has no bonds");
    }
}
