/* Readings of any loading along an axis, and those that several kinds of tests have. */
#include "test_kinds/curves.h"

#include <math.h>
#include <stdio.h>

/* Reads the column at the peak, if there is one. */
void gn_read_at_peak(const gn_curves *curves, gn_reading which, const double *column, double factor,
                     double *value, gn_readings *readings) {
    const char *reason = gn_no_peak(curves);
    if (reason) gn_reading_absent(readings, which, "%s", reason);
    if (column) *value = factor * column[curves->largest];
}

/* Reads a component of the average strain at the peak. */
void gn_read_strain_at_peak(const gn_curves *curves, gn_reading which, const char *name,
                            double *value, gn_readings *readings) {
    const double *column = gn_history_column(curves->history, name);
    const char *reason = column ? gn_no_average_strain(column, curves->largest) : NULL;
    gn_read_at_peak(curves, which, column, 1.0, value, readings);
    if (reason) gn_reading_absent(readings, which, "%s", reason);
}

const double *gn_curves_tensor(const gn_curves *curves, const char *name, int axis) {
    char full[32];
    snprintf(full, sizeof full, "%s_%c%c", name, "xyz"[axis], "xyz"[axis]);
    return gn_history_column(curves->history, full);
}

void gn_read_slope(const gn_curves *curves, gn_reading which, double *value,
                   gn_readings *readings) {
    gn_line_fit f = gn_line(curves, curves->strain, curves->stress, curves->elastic);
    const char *none = gn_no_average_strain(curves->strain, curves->history->row_count - 1);
    *value = f.slope;
    gn_need_elastic_rows(curves, which, readings);
    if ((gn_test_of(curves->tested->kind)->isotropic ||
         gn_test_of(curves->tested->kind)->enclosed) &&
        isnan(f.slope) && none)
        gn_reading_absent(readings, which, "%s", none);
    gn_need_modulus(f, which, readings);
}

void gn_need_no_cohesion(const gn_curves *curves, gn_readings *readings) {
    const bool bonds = !isnan(curves->tested->fragments);
    if (bonds || curves->tested->attracts)
        gn_reading_absent(readings, GN_READING_friction_angle,
                          "%s: an angle needs tests at several confinements (test.confinement, "
                          "gneiss sweep)",
                          bonds ? "bonds have cohesion" : "the contacts attract each other");
}

/* --- fracture energy --- */

/* Fraction of the largest load below which a section counts as separated. */
static const double broken_through = 0.1;

/* Integrates by the trapezoidal rule from the first row to the last. */
void gn_read_fracture_energy(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_fracture_energy;
    const double *force = gn_history_column(curves->history, "force"),
                 *way = gn_history_column(curves->history, "deflection");
    const char *reason = gn_no_peak(curves);
    size_t rows = curves->history->row_count;
    if (reason) gn_reading_absent(readings, which, "%s", reason);
    if (curves->tested->under_gravity)
        gn_reading_absent(readings, which,
                          "gravity does work on the specimen in addition to the ends");
    if (curves->tested->conversion_halted)
        gn_reading_absent(
            readings, which,
            "conversion ended the run (conversion_halted): the further load of elements beside the "
            "crack is not known");
    if (!force || !way) return;
    double left = force[rows - 1] / force[curves->largest], work = 0;
    if (left > broken_through)
        gn_reading_absent(readings, which,
                          "the run ended with %.0f %% of the largest load, at most %.0f %% are "
                          "needed (time.stop.peak_drop, time.end)",
                          100 * left, 100 * broken_through);
    for (size_t k = 1; k < rows; k++)
        work += 0.5 * (force[k] + force[k - 1]) * (way[k] - way[k - 1]);
    readings->fracture_energy = work / curves->tested->section;
}

/* --- of any loading along an axis --- */

/* Returns the rows from the first one with the fraction `low` of the largest stress to the first
 * one with `high`. */
static gn_row_span between(const gn_curves *curves, double low, double high) {
    gn_row_span s = {.first = curves->begin};
    const double most = curves->stress[curves->largest];
    while (s.first < curves->largest && !(curves->stress[s.first] >= low * most)) s.first++;
    s.last = s.first;
    while (s.last < curves->largest && !(curves->stress[s.last] > high * most)) s.last++;
    return s;
}

static void slope_between(const gn_curves *curves, gn_reading which, double low, double high,
                          double *value, gn_readings *readings) {
    gn_row_span s = between(curves, low, high);
    gn_line_fit f = gn_line(curves, curves->strain, curves->stress, s);
    *value = gn_modulus_by(curves->tested->by_ends, f.slope, which, readings);
    if (s.last - s.first < 3)
        gn_reading_absent(readings, which,
                          "%zu history rows between %.0f and %.0f %% of the largest stress, 3 are "
                          "needed (output.history_rows)",
                          s.last - s.first, 100 * low, 100 * high);
    gn_need_axial(curves, curves->loading, which, readings);
    gn_need_modulus(f, which, readings);
}

/* Reads the modulus between two rows, whatever has broken or yielded in between. */
static void read_secant(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_secant_modulus;
    const gn_row_span s = curves->loading;
    double way = curves->strain ? curves->strain[s.last] - curves->strain[s.first] : NAN;
    readings->secant_modulus =
        gn_modulus_by(curves->tested->by_ends,
                      (curves->stress[s.last] - curves->stress[s.first]) / way, which, readings);
    if (!(way > 0))
        gn_reading_absent(readings, which, "the strain does not grow up to half the stress");
    if (gn_reading_belongs(GN_READING_young_modulus, curves->tested->kind, false))
        gn_need_axial(curves, curves->loading, which, readings);
}

static void read_initiation(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_crack_initiation_stress;
    const char *reason = gn_no_peak(curves);
    double all = gn_breaks_until(curves, curves->largest);
    size_t row = curves->begin;
    while (row < curves->largest && !(gn_breaks_until(curves, row) >= 0.01 * all)) row++;
    readings->crack_initiation_stress = curves->stress[row];
    if (isnan(curves->tested->fragments))
        gn_reading_absent(readings, which, "the scene has no bonds");
    if (reason) gn_reading_absent(readings, which, "%s", reason);
    if (all < 100)
        gn_reading_absent(readings, which,
                          "%.0f bonds are broken at the peak, 100 are needed (1 %% is one)", all);
}

/* Reads the row of the least volume, if rows follow it before the peak. */
static void read_damage(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_crack_damage_stress;
    const char *reason = gn_no_peak(curves);
    size_t row = curves->begin;
    double least = INFINITY;
    for (size_t k = curves->begin; k <= curves->largest; k++) {
        double volume = 0;
        for (int a = 0; a < curves->tested->dimension; a++)
            volume += curves->average[a] ? curves->average[a][k] : NAN;
        if (volume < least) least = volume, row = k;
    }
    readings->crack_damage_stress = least < INFINITY ? curves->stress[row] : NAN;
    if (reason) gn_reading_absent(readings, which, "%s", reason);
    if (row == curves->largest)
        gn_reading_absent(readings, which, "the specimen loses volume up to the peak");
    if (row < curves->loading.first || row == 0)
        gn_reading_absent(readings, which, "the specimen gains volume from the start of loading");
}

static void read_brittleness(const gn_curves *curves, gn_readings *readings) {
    const char *reason = gn_no_peak(curves);
    double last = curves->stress[curves->history->row_count - 1];
    readings->brittleness = 1 - fmax(last, 0) / curves->stress[curves->largest];
    if (reason) gn_reading_absent(readings, GN_READING_brittleness, "%s", reason);
}

void gn_readings_of_loading(const gn_curves *curves, gn_readings *readings) {
    slope_between(curves, GN_READING_tangent_modulus, 0.4, 0.6, &readings->tangent_modulus,
                  readings);
    slope_between(curves, GN_READING_average_modulus, 0.2, 0.8, &readings->average_modulus,
                  readings);
    read_secant(curves, readings);
    read_initiation(curves, readings);
    read_damage(curves, readings);
    read_brittleness(curves, readings);
}

void gn_readings_of_breaks(const gn_tested *tested, gn_readings *readings) {
    const gn_reading which[] = {GN_READING_events, GN_READING_b_value, GN_READING_fragments,
                                GN_READING_largest_fragment};
    for (size_t k = 0; k < sizeof which / sizeof *which; k++)
        gn_reason_of(readings, which[k])[0] = '\0';
    gn_readings_of_bursts(tested, readings);
    readings->fragments = tested->fragments;
    readings->largest_fragment = tested->largest_fragment;
    if (isnan(readings->fragments)) {
        gn_reading_absent(readings, GN_READING_fragments, "the scene has no bonds");
        gn_reading_absent(readings, GN_READING_largest_fragment, "the scene has no bonds");
    }
}
