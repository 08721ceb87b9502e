/* Readings of single test kinds. */
#include "measure/readings.h"

#include <math.h>
#include <stdio.h>

/* Reads a column at the peak, if there is one. */
static void at_peak(const gn_curves *curves, gn_reading which, const double *column, double factor,
                    double *value, gn_readings *readings) {
    const char *reason = gn_no_peak(curves);
    if (reason) gn_reading_absent(readings, which, "%s", reason);
    if (column) *value = factor * column[curves->largest];
}

/* Reads an average strain at the peak. */
static void strain_at_peak(const gn_curves *curves, gn_reading which, const char *name,
                           double *value, gn_readings *readings) {
    const double *column = gn_history_column(curves->history, name);
    const char *reason = column ? gn_no_average_strain(column, curves->largest) : NULL;
    at_peak(curves, which, column, 1.0, value, readings);
    if (reason) gn_reading_absent(readings, which, "%s", reason);
}

static const double *tensor(const gn_curves *curves, const char *name, int axis) {
    char full[32];
    snprintf(full, sizeof full, "%s_%c%c", name, "xyz"[axis], "xyz"[axis]);
    return gn_history_column(curves->history, full);
}

/* --- brazilian --- */

static void ratio_in_the_middle(const gn_curves *curves, gn_reading which, const double *column,
                                double sign, double *value, gn_readings *readings) {
    gn_line_fit f = gn_line(curves, curves->stress, column, curves->elastic);
    *value = sign * f.slope;
    gn_need_elastic_rows(curves, which, readings);
    if (f.error > gn_scatter_allowed * fmax(1.0, fabs(f.slope)))
        gn_reading_absent(readings, which, "the rows scatter: standard error of the slope %.2g",
                          f.error);
}

static void read_brazilian(const gn_curves *curves, gn_readings *readings) {
    static const char none[] = "the scene has no particles in the middle of the disc";
    int axis = curves->tested->axis;
    const double *across = tensor(curves, "centre_stress", 1 - axis),
                 *along = tensor(curves, "centre_stress", axis);
    at_peak(curves, GN_READING_indirect_tensile_strength, curves->stress, 1.0,
            &readings->indirect_tensile_strength, readings);
    if (!across || !along) {
        gn_reading_absent(readings, GN_READING_centre_tension, "%s", none);
        gn_reading_absent(readings, GN_READING_centre_ratio, "%s", none);
        gn_reading_absent(readings, GN_READING_centre_compression_ratio, "%s", none);
        return;
    }
    at_peak(curves, GN_READING_centre_tension, across, 1.0, &readings->centre_tension, readings);
    ratio_in_the_middle(curves, GN_READING_centre_ratio, across, 1.0, &readings->centre_ratio,
                        readings);
    ratio_in_the_middle(curves, GN_READING_centre_compression_ratio, along, -1.0,
                        &readings->centre_compression_ratio, readings);
}

/* --- bending --- */

static void read_bending(const gn_curves *curves, gn_readings *readings) {
    const gn_reading modulus = GN_READING_flexural_modulus, opening = GN_READING_opening_at_peak;
    gn_line_fit f = gn_line(curves, curves->strain, curves->stress, curves->elastic);
    const double *gauge = gn_history_column(curves->history, "opening");
    const double *force = gn_history_column(curves->history, "force"),
                 *way = gn_history_column(curves->history, "deflection");
    at_peak(curves, GN_READING_flexural_strength, curves->stress, 1.0, &readings->flexural_strength,
            readings);
    at_peak(curves, GN_READING_peak_force, force, 1.0, &readings->peak_force, readings);
    gn_need_elastic_rows(curves, GN_READING_stiffness, readings);
    if (force && way) {
        gn_line_fit s = gn_line(curves, way, force, curves->elastic);
        readings->stiffness = s.slope;
        gn_need_modulus(s, GN_READING_stiffness, readings);
    }
    readings->flexural_modulus = f.slope;
    gn_need_elastic_rows(curves, modulus, readings);
    gn_need_modulus(f, modulus, readings);
    if (curves->tested->notched)
        gn_reading_absent(readings, modulus,
                          "a notch: the strain of the fibre above it is not known");
    if (!gauge) gn_reading_absent(readings, opening, "the test has no gauge (test.opening)");
    at_peak(curves, opening, gauge, 1.0, &readings->opening_at_peak, readings);
}

/* --- fracture energy --- */

/* Fraction of the largest load below which a section counts as separated. */
static const double broken_through = 0.1;

/* Integrates by the trapezoidal rule from the first row to the last. */
static void read_fracture_energy(const gn_curves *curves, gn_readings *readings) {
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

/* --- confined, hydrostatic, oedometer, shear --- */

static void read_confined(const gn_curves *curves, gn_readings *readings) {
    const double *pressure = gn_history_column(curves->history, "membrane_pressure");
    at_peak(curves, GN_READING_confinement, pressure, 1.0, &readings->confinement, readings);
    at_peak(curves, GN_READING_axial_strength, curves->stress, 1.0, &readings->axial_strength,
            readings);
    if (pressure) readings->axial_strength += pressure[curves->largest];
    strain_at_peak(curves, GN_READING_volumetric_strain_at_peak, "volumetric_strain",
                   &readings->volumetric_strain_at_peak, readings);
    strain_at_peak(curves, GN_READING_lateral_strain_at_peak, "lateral_strain",
                   &readings->lateral_strain_at_peak, readings);
}

static void slope_of_loading(const gn_curves *curves, gn_reading which, double *value,
                             gn_readings *readings) {
    gn_line_fit f = gn_line(curves, curves->strain, curves->stress, curves->elastic);
    const char *none = gn_no_average_strain(curves->strain, curves->history->row_count - 1);
    *value = f.slope;
    gn_need_elastic_rows(curves, which, readings);
    if (curves->tested->kind == GN_TEST_HYDROSTATIC && isnan(f.slope) && none)
        gn_reading_absent(readings, which, "%s", none);
    gn_need_modulus(f, which, readings);
}

static void read_oedometer(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_lateral_stress_ratio;
    int axis = curves->tested->axis, dimension = curves->tested->dimension;
    double lateral = 0;
    slope_of_loading(curves, GN_READING_oedometric_modulus, &readings->oedometric_modulus,
                     readings);
    for (int a = 0; a < dimension; a++)
        if (a != axis)
            lateral += gn_line(curves, curves->stress, tensor(curves, "stress", a), curves->elastic)
                           .slope /
                       (dimension - 1);
    readings->lateral_stress_ratio =
        lateral /
        gn_line(curves, curves->stress, tensor(curves, "stress", axis), curves->elastic).slope;
    gn_need_elastic_rows(curves, which, readings);
}

static void read_shear(const gn_curves *curves, gn_readings *readings) {
    at_peak(curves, GN_READING_shear_strength, curves->stress, 1.0, &readings->shear_strength,
            readings);
    at_peak(curves, GN_READING_normal_stress_at_peak,
            gn_history_column(curves->history, "normal_stress"), 1.0,
            &readings->normal_stress_at_peak, readings);
    at_peak(curves, GN_READING_dilation_at_peak, gn_history_column(curves->history, "dilation"),
            1.0, &readings->dilation_at_peak, readings);
    slope_of_loading(curves, GN_READING_shear_modulus, &readings->shear_modulus, readings);
}

/* --- of any loading along an axis --- */

/* Returns the rows from the first with one fraction of the largest stress to the first with
 * another. */
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

/* Reads the modulus between two rows, whatever broke or yielded in between. */
static void read_secant(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_secant_modulus;
    const gn_row_span s = curves->loading;
    double way = curves->strain ? curves->strain[s.last] - curves->strain[s.first] : NAN;
    readings->secant_modulus =
        gn_modulus_by(curves->tested->by_ends,
                      (curves->stress[s.last] - curves->stress[s.first]) / way, which, readings);
    if (!(way > 0))
        gn_reading_absent(readings, which, "the strain does not grow up to half the stress");
    if (GN_OF_PRISMS >> curves->tested->kind & 1)
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
                          "%.0f bonds are broken at the peak, of 100 the first is 1 %%", all);
}

/* Finds the row of the least volume, if rows follow it before the peak. */
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

static void read_any(const gn_curves *curves, gn_readings *readings) {
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

void gn_readings_by_kind(const gn_curves *curves, gn_readings *readings) {
    read_any(curves, readings);
    switch (curves->tested->kind) {
    case GN_TEST_BRAZILIAN:
        read_brazilian(curves, readings);
        break;
    case GN_TEST_BENDING:
        read_bending(curves, readings);
        read_fracture_energy(curves, readings);
        break;
    case GN_TEST_TENSION:
        read_fracture_energy(curves, readings);
        break;
    case GN_TEST_TRIAXIAL:
    case GN_TEST_BIAXIAL:
        read_confined(curves, readings);
        break;
    case GN_TEST_HYDROSTATIC:
        slope_of_loading(curves, GN_READING_bulk_modulus, &readings->bulk_modulus, readings);
        break;
    case GN_TEST_OEDOMETER:
        read_oedometer(curves, readings);
        break;
    case GN_TEST_SHEAR:
    case GN_TEST_SIMPLE_SHEAR:
        read_shear(curves, readings);
        break;
    case GN_TEST_NONE:
    case GN_TEST_COMPRESSION:
    case GN_TEST_KINDS:
        break;
    }
}
