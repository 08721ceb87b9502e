/* Readings of single test kinds. */
#include "measure/readings.h"

#include <math.h>
#include <stdio.h>

/* Reads a column at the peak, if there is one. */
static void at_peak(const gn_curves *c, gn_reading which, const double *column, double factor,
                    double *value, gn_readings *r) {
    const char *reason = gn_no_peak(c);
    if (reason) gn_reading_absent(r, which, "%s", reason);
    if (column) *value = factor * column[c->largest];
}

/* Reads an average strain at the peak. */
static void strain_at_peak(const gn_curves *c, gn_reading which, const char *name, double *value,
                           gn_readings *r) {
    const double *column = gn_history_column(c->history, name);
    const char *reason = column ? gn_no_average_strain(column, c->largest) : NULL;
    at_peak(c, which, column, 1.0, value, r);
    if (reason) gn_reading_absent(r, which, "%s", reason);
}

static const double *tensor(const gn_curves *c, const char *name, int axis) {
    char full[32];
    snprintf(full, sizeof full, "%s_%c%c", name, "xyz"[axis], "xyz"[axis]);
    return gn_history_column(c->history, full);
}

/* --- brazilian --- */

static void ratio_in_the_middle(const gn_curves *c, gn_reading which, const double *column,
                                double sign, double *value, gn_readings *r) {
    gn_line_fit f = gn_line(c, c->stress, column, c->elastic);
    *value = sign * f.slope;
    gn_need_elastic_rows(c, which, r);
    if (f.error > gn_scatter_allowed * fmax(1.0, fabs(f.slope)))
        gn_reading_absent(r, which, "the rows scatter: standard error of the slope %.2g", f.error);
}

static void read_brazilian(const gn_curves *c, gn_readings *r) {
    static const char none[] = "the scene has no particles in the middle of the disc";
    int axis = c->tested->axis;
    const double *across = tensor(c, "centre_stress", 1 - axis),
                 *along = tensor(c, "centre_stress", axis);
    at_peak(c, GN_READING_indirect_tensile_strength, c->stress, 1.0, &r->indirect_tensile_strength,
            r);
    if (!across || !along) {
        gn_reading_absent(r, GN_READING_centre_tension, "%s", none);
        gn_reading_absent(r, GN_READING_centre_ratio, "%s", none);
        gn_reading_absent(r, GN_READING_centre_compression_ratio, "%s", none);
        return;
    }
    at_peak(c, GN_READING_centre_tension, across, 1.0, &r->centre_tension, r);
    ratio_in_the_middle(c, GN_READING_centre_ratio, across, 1.0, &r->centre_ratio, r);
    ratio_in_the_middle(c, GN_READING_centre_compression_ratio, along, -1.0,
                        &r->centre_compression_ratio, r);
}

/* --- bending --- */

static void read_bending(const gn_curves *c, gn_readings *r) {
    const gn_reading modulus = GN_READING_flexural_modulus, opening = GN_READING_opening_at_peak;
    gn_line_fit f = gn_line(c, c->strain, c->stress, c->elastic);
    const double *gauge = gn_history_column(c->history, "opening");
    const double *force = gn_history_column(c->history, "force"),
                 *way = gn_history_column(c->history, "deflection");
    at_peak(c, GN_READING_flexural_strength, c->stress, 1.0, &r->flexural_strength, r);
    at_peak(c, GN_READING_peak_force, force, 1.0, &r->peak_force, r);
    gn_need_elastic_rows(c, GN_READING_stiffness, r);
    if (force && way) {
        gn_line_fit s = gn_line(c, way, force, c->elastic);
        r->stiffness = s.slope;
        gn_need_modulus(s, GN_READING_stiffness, r);
    }
    r->flexural_modulus = f.slope;
    gn_need_elastic_rows(c, modulus, r);
    gn_need_modulus(f, modulus, r);
    if (c->tested->notched)
        gn_reading_absent(r, modulus, "a notch: the strain of the fibre above it is not known");
    if (!gauge) gn_reading_absent(r, opening, "the test has no gauge (test.opening)");
    at_peak(c, opening, gauge, 1.0, &r->opening_at_peak, r);
}

/* --- fracture energy --- */

/* Fraction of the largest load below which a section counts as separated. */
static const double broken_through = 0.1;

/* Integrates by the trapezoidal rule from the first row to the last. */
static void read_fracture_energy(const gn_curves *c, gn_readings *r) {
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

/* --- confined, hydrostatic, oedometer, shear --- */

static void read_confined(const gn_curves *c, gn_readings *r) {
    const double *pressure = gn_history_column(c->history, "membrane_pressure");
    at_peak(c, GN_READING_confinement, pressure, 1.0, &r->confinement, r);
    at_peak(c, GN_READING_axial_strength, c->stress, 1.0, &r->axial_strength, r);
    if (pressure) r->axial_strength += pressure[c->largest];
    strain_at_peak(c, GN_READING_volumetric_strain_at_peak, "volumetric_strain",
                   &r->volumetric_strain_at_peak, r);
    strain_at_peak(c, GN_READING_lateral_strain_at_peak, "lateral_strain",
                   &r->lateral_strain_at_peak, r);
}

static void slope_of_loading(const gn_curves *c, gn_reading which, double *value, gn_readings *r) {
    gn_line_fit f = gn_line(c, c->strain, c->stress, c->elastic);
    const char *none = gn_no_average_strain(c->strain, c->history->row_count - 1);
    *value = f.slope;
    gn_need_elastic_rows(c, which, r);
    if (c->tested->kind == GN_TEST_HYDROSTATIC && isnan(f.slope) && none)
        gn_reading_absent(r, which, "%s", none);
    gn_need_modulus(f, which, r);
}

static void read_oedometer(const gn_curves *c, gn_readings *r) {
    const gn_reading which = GN_READING_lateral_stress_ratio;
    int axis = c->tested->axis, dimension = c->tested->dimension;
    double lateral = 0;
    slope_of_loading(c, GN_READING_oedometric_modulus, &r->oedometric_modulus, r);
    for (int a = 0; a < dimension; a++)
        if (a != axis)
            lateral +=
                gn_line(c, c->stress, tensor(c, "stress", a), c->elastic).slope / (dimension - 1);
    r->lateral_stress_ratio =
        lateral / gn_line(c, c->stress, tensor(c, "stress", axis), c->elastic).slope;
    gn_need_elastic_rows(c, which, r);
}

static void read_shear(const gn_curves *c, gn_readings *r) {
    at_peak(c, GN_READING_shear_strength, c->stress, 1.0, &r->shear_strength, r);
    at_peak(c, GN_READING_normal_stress_at_peak, gn_history_column(c->history, "normal_stress"),
            1.0, &r->normal_stress_at_peak, r);
    at_peak(c, GN_READING_dilation_at_peak, gn_history_column(c->history, "dilation"), 1.0,
            &r->dilation_at_peak, r);
    slope_of_loading(c, GN_READING_shear_modulus, &r->shear_modulus, r);
}

/* --- of any loading along an axis --- */

/* Returns the rows from the first with one fraction of the largest stress to the first with
 * another. */
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

/* Reads the modulus between two rows, whatever broke or yielded in between. */
static void read_secant(const gn_curves *c, gn_readings *r) {
    const gn_reading which = GN_READING_secant_modulus;
    const gn_row_span s = c->loading;
    double way = c->strain ? c->strain[s.last] - c->strain[s.first] : NAN;
    r->secant_modulus =
        gn_modulus_by(c->tested->by_ends, (c->stress[s.last] - c->stress[s.first]) / way, which, r);
    if (!(way > 0)) gn_reading_absent(r, which, "the strain does not grow up to half the stress");
    if (GN_OF_PRISMS >> c->tested->kind & 1) gn_need_axial(c, c->loading, which, r);
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

/* Finds the row of the least volume, if rows follow it before the peak. */
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

static void read_any(const gn_curves *c, gn_readings *r) {
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

void gn_readings_by_kind(const gn_curves *c, gn_readings *r) {
    read_any(c, r);
    switch (c->tested->kind) {
    case GN_TEST_BRAZILIAN:
        read_brazilian(c, r);
        break;
    case GN_TEST_BENDING:
        read_bending(c, r);
        read_fracture_energy(c, r);
        break;
    case GN_TEST_TENSION:
        read_fracture_energy(c, r);
        break;
    case GN_TEST_TRIAXIAL:
    case GN_TEST_BIAXIAL:
        read_confined(c, r);
        break;
    case GN_TEST_HYDROSTATIC:
        slope_of_loading(c, GN_READING_bulk_modulus, &r->bulk_modulus, r);
        break;
    case GN_TEST_OEDOMETER:
        read_oedometer(c, r);
        break;
    case GN_TEST_SHEAR:
    case GN_TEST_SIMPLE_SHEAR:
        read_shear(c, r);
        break;
    case GN_TEST_NONE:
    case GN_TEST_COMPRESSION:
    case GN_TEST_KINDS:
        break;
    }
}
