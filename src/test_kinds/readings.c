/* Readings of a laboratory from the curves of a test, and the reasons for absent ones. */
#include "test_kinds/curves.h"

#include "test_kinds/beginning.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Largest ratio of other stresses to the axial one for a modulus and for Poisson's ratio. If other
 * stresses grow by the fraction k of the axial one, (nu - k (1 - nu))/(1 - 2 nu k) is read as nu,
 * and E/(1 - 2 nu k) as E. Rough ends cause this: k is 0.03 in a cylinder with a height of two
 * widths between glued ends, and 0.075 in a cube (with nu 0.2, 0.14 is read, and 1.03 E). */
static const double beside_modulus = 0.1, beside_ratio = 0.05;

/* --- absent readings --- */

/* Removes the sign of zero, for reasons as texts. */
static double unsigned_zero(double x) {
    return x == 0 ? 0 : x;
}

static void all_absent(gn_readings *readings, const char *reason) {
    for (int k = 0; k < GN_READING_COUNT; k++)
        gn_reading_absent(readings, (gn_reading)k, "%s", reason);
}

_Static_assert(offsetof(gn_readings, reason) == GN_READING_COUNT * sizeof(double),
               "doubles in a row, then reasons");

static double *values_of(gn_readings *readings) {
    return &readings->young_modulus; /* the first of all readings */
}

const char *gn_reading_name(gn_reading which) {
#define X(name, unit, text) #name,
    static const char *const names[] = {GN_READINGS(X)};
#undef X
    return names[which];
}

bool gn_reading_belongs(gn_reading which, gn_test_kind kind, bool zones) {
    return which == GN_READING_returned_energy ? zones : gn_test_of(kind)->readings >> which & 1;
}

static void leave_others(const gn_tested *of, gn_readings *readings) {
    for (int k = 0; k < GN_READING_COUNT; k++) {
        if (gn_reading_belongs((gn_reading)k, of->kind, of->zones)) continue;
        readings->reason[k][0] = '\0';
        gn_reading_absent(readings, (gn_reading)k, "a reading of other tests");
    }
}

/* Reads the energy returned by zones, with any test or without one. */
static void read_zones(const gn_tested *of, gn_readings *readings) {
    const gn_reading which = GN_READING_returned_energy;
    if (!of->zones) return;
    readings->reason[which][0] = '\0';
    readings->returned_energy = of->returned_energy;
    if (isnan(of->returned_energy))
        gn_reading_absent(readings, which, "there was no energy beyond rounding");
}

/* Makes readings that have a reason NaN, and gives readings that are NaN a reason. */
static void settle(gn_readings *readings) {
    for (int k = 0; k < GN_READING_COUNT; k++) {
        if (readings->reason[k][0]) values_of(readings)[k] = NAN;
        if (isnan(values_of(readings)[k]))
            gn_reading_absent(readings, (gn_reading)k, "there is nothing to read it from");
    }
}

/* --- rows --- */

static size_t largest_row(const double *stress, size_t begin, size_t rows) {
    size_t largest = rows;
    for (size_t k = begin; k < rows; k++)
        if (stress[k] > 0 && (largest == rows || stress[k] > stress[largest])) largest = k;
    return largest;
}

/* Returns the rows from the first crossing of 1 % to the first crossing of 50 % of the largest
 * stress, both before it. */
static gn_row_span loading_span(const double *stress, size_t begin, size_t largest) {
    gn_row_span s = {.first = begin};
    while (s.first < largest && !(stress[s.first] >= 0.01 * stress[largest])) s.first++;
    s.last = s.first;
    while (s.last < largest && !(stress[s.last] > 0.5 * stress[largest])) s.last++;
    return s;
}

/* Returns the interval between rows in the later half, which consists of time steps whatever the
 * start. */
static double interval_of(const double *time, size_t rows) {
    size_t half = rows / 2;
    return time && rows > half + 1 ? (time[rows - 1] - time[half]) / (double)(rows - 1 - half) : 0;
}

/* --- readings that the scene allows --- */

/* Returns the slope of a mean stress of the specimen over that of the test. */
static double follows(const gn_curves *curves, gn_row_span span, int a, int b) {
    char name[16];
    snprintf(name, sizeof name, "stress_%c%c", "xyz"[a < b ? a : b], "xyz"[a < b ? b : a]);
    return gn_line(curves, curves->stress, gn_history_column(curves->history, name), span).slope;
}

/* Requires uniaxial loading: a modulus is stress over strain along one axis with all other stresses
 * constant, at zero or at the pressure of a cell. Scenes that load or hold the sides, or shear the
 * specimen, violate this. */
static void need_one_axis(const gn_curves *curves, gn_row_span span, gn_reading which, double limit,
                          gn_readings *readings) {
    const int axis = curves->tested->axis;
    double along = curves->tested->sign * follows(curves, span, axis, axis);
    if (isnan(along)) return; /* there is no mean stress */
    if (!(along > 0.5 && along < 2))
        gn_reading_absent(
            readings, which,
            "the mean stress of the specimen along %c changes by %.3g of that of the ends (area "
            "and volume of one specimen?)",
            "xyz"[axis], unsigned_zero(along));
    for (int a = 0; a < curves->tested->dimension; a++)
        for (int b = a; b < curves->tested->dimension; b++) {
            double other = follows(curves, span, a, b) / along;
            if ((a == axis && b == axis) || !(fabs(other) > limit)) continue;
            gn_reading_absent(
                readings, which,
                "the specimen is not loaded along %c alone: stress_%c%c changes by %.2g of the "
                "axial stress (sides held, loaded or sheared)",
                "xyz"[axis], "xyz"[a], "xyz"[b], fabs(other));
        }
}

/* Requires the displacement of the ends to agree with the mean strain. If much of it is bending, or
 * deformation of the ends, the mean strains are not those of a specimen loaded along its axis. */
static void need_ways(const gn_curves *curves, gn_row_span span, gn_reading which,
                      gn_readings *readings) {
    double ways =
        curves->tested->sign *
        gn_line(curves, curves->stress, curves->average[curves->tested->axis], span).slope *
        gn_line(curves, curves->strain, curves->stress, span).slope;
    if (ways < 0.5 || ways > 2)
        gn_reading_absent(
            readings, which,
            "the mean strain of the specimen is %.2g of the platen strain (bending, or soft "
            "ends)",
            unsigned_zero(ways));
}

/* Requires the same, or that the mean stress equals that of the ends: then the whole load passes
 * through the whole section and only the ends are soft, so that the mean strains are those of a
 * specimen loaded along its axis. */
static void need_ways_or_stress(const gn_curves *curves, gn_row_span span, gn_reading which,
                                gn_readings *readings) {
    int axis = curves->tested->axis;
    double along = curves->tested->sign * follows(curves, span, axis, axis);
    if (!(fabs(along - 1) <= beside_modulus)) need_ways(curves, span, which, readings);
}

void gn_need_axial(const gn_curves *curves, gn_row_span span, gn_reading which,
                   gn_readings *readings) {
    if (curves->tested->axis < 0) return; /* a hydrostatic test loads along all axes */
    need_one_axis(curves, span, which, beside_modulus, readings);
    need_ways(curves, span, which, readings);
}

/* --- readings --- */

static double modulus_of(const gn_curves *curves, gn_row_span span) {
    return gn_line(curves, curves->strain, curves->stress, span).slope;
}

static void read_modulus(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_young_modulus;
    gn_line_fit f = gn_line(curves, curves->strain, curves->stress, curves->elastic);
    readings->young_modulus = gn_modulus_by(curves->tested->by_ends, f.slope, which, readings);
    readings->nonlinearity[which] = gn_nonlinearity(curves, modulus_of);
    gn_need_elastic_rows(curves, which, readings);
    need_one_axis(curves, curves->elastic, which, beside_modulus, readings);
    gn_need_modulus(f, which, readings);
    need_ways(curves, curves->elastic, which, readings);
}

/* Requires average strains in the rows of the fit. */
static void need_average_strain(const gn_curves *curves, gn_reading which, gn_readings *readings) {
    const size_t last = curves->elastic.last;
    const char *reason =
        gn_no_average_strain(curves->average[0], last > curves->elastic.first ? last - 1 : 0);
    if (reason) gn_reading_absent(readings, which, "%s", reason);
}

static double average_modulus_of(const gn_curves *curves, gn_row_span span) {
    return gn_line(curves, curves->average[curves->tested->axis], curves->stress, span).slope;
}

static void read_average_modulus(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_young_modulus_average;
    gn_line_fit f =
        gn_line(curves, curves->average[curves->tested->axis], curves->stress, curves->elastic);
    f.slope *= curves->tested->sign;
    readings->young_modulus_average =
        gn_modulus_by(curves->tested->by_mean, f.slope, which, readings);
    readings->nonlinearity[which] = gn_nonlinearity(curves, average_modulus_of);
    gn_need_elastic_rows(curves, which, readings);
    need_average_strain(curves, which, readings);
    need_one_axis(curves, curves->elastic, which, beside_modulus, readings);
    gn_need_modulus(f, which, readings);
    need_ways_or_stress(curves, curves->elastic, which, readings);
}

/* Requires a possible Poisson's ratio: an elastic solid has -1 to 0.5; in 2D up to 1, because of
 * plane strain. */
static void need_possible_ratio(int dimension, double nu, gn_reading which, gn_readings *readings) {
    double most = dimension == 2 ? 1 : 0.5;
    if (!(fabs(nu) <= 1))
        gn_reading_absent(readings, which, "the sides move more than the ends (%.3g)", nu);
    if (nu > most)
        gn_reading_absent(
            readings, which,
            "the volume grows under pressure (%.3g, an elastic solid has at most %.1g)", nu, most);
}

/* Fits both strains over the stress and divides the slopes. In a fit of lateral over axial strain,
 * vibrations of the axial average would bias the slope towards zero; over the stress, such scatter
 * averages out in both slopes. */
static gn_line_fit ratio_fit(const gn_curves *curves, gn_row_span span) {
    int axis = curves->tested->axis, dimension = curves->tested->dimension;
    double lateral = 0, variance = 0;
    for (int a = 0; a < dimension; a++) {
        if (a == axis) continue;
        gn_line_fit f = gn_line(curves, curves->stress, curves->average[a], span);
        lateral += f.slope / (dimension - 1);
        variance += f.error * f.error / ((dimension - 1) * (dimension - 1));
    }
    gn_line_fit axial = gn_line(curves, curves->stress, curves->average[axis], span);
    const double ratio = -lateral / axial.slope;
    return (gn_line_fit){ratio, hypot(sqrt(variance), ratio * axial.error) / fabs(axial.slope)};
}

static double ratio_of(const gn_curves *curves, gn_row_span span) {
    return ratio_fit(curves, span).slope;
}

static void read_poisson(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_poisson_ratio;
    const gn_line_fit f = ratio_fit(curves, curves->elastic);
    readings->poisson_ratio = f.slope;
    (void)gn_modulus_by(curves->tested->by_mean, f.slope, which, readings);
    readings->nonlinearity[which] = gn_nonlinearity(curves, ratio_of);
    gn_need_elastic_rows(curves, which, readings);
    need_average_strain(curves, which, readings);
    need_one_axis(curves, curves->elastic, which, beside_ratio, readings);
    if (f.error > gn_scatter_allowed)
        gn_reading_absent(readings, which, "the rows scatter: standard error %.2g", f.error);
    need_ways_or_stress(curves, curves->elastic, which, readings);
    need_possible_ratio(curves->tested->dimension, f.slope, which, readings);
}

/* Reads Poisson's ratio between two rows, whatever has broken or yielded in between. */
static void read_secant_ratio(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_secant_poisson_ratio;
    const gn_row_span s = curves->loading;
    int axis = curves->tested->axis, dimension = curves->tested->dimension;
    double lateral = 0, axial = NAN;
    for (int a = 0; a < dimension; a++) {
        const double way =
            curves->average[a] ? curves->average[a][s.last] - curves->average[a][s.first] : NAN;
        if (a == axis)
            axial = way;
        else
            lateral += way / (dimension - 1);
    }
    readings->secant_poisson_ratio = -lateral / axial;
    (void)gn_modulus_by(curves->tested->by_mean, -lateral / axial, which, readings);
    const char *reason = gn_no_average_strain(curves->average[0], s.last);
    if (reason) gn_reading_absent(readings, which, "%s", reason);
    need_one_axis(curves, s, which, beside_ratio, readings);
    if (!(curves->tested->sign * axial > 0))
        gn_reading_absent(readings, which, "the strain does not grow up to half the stress");
    need_ways_or_stress(curves, s, which, readings);
    need_possible_ratio(dimension, readings->secant_poisson_ratio, which, readings);
}

/* Reads the constants in plane strain: E' = E/(1 - nu^2) and nu' = nu/(1 - nu) are solved for E and
 * nu. */
static void read_plane(const gn_curves *curves, gn_readings *readings) {
    const gn_reading modulus = GN_READING_plane_young_modulus,
                     ratio = GN_READING_plane_poisson_ratio;
    if (curves->tested->dimension != 2) {
        gn_reading_absent(readings, modulus, "a reading of 2D scenes");
        gn_reading_absent(readings, ratio, "a reading of 2D scenes");
        return;
    }
    double nu = readings->poisson_ratio / (1 + readings->poisson_ratio);
    readings->plane_poisson_ratio = nu;
    readings->plane_young_modulus = readings->young_modulus * (1 - nu * nu);
    const char *no_ratio = gn_reason_of(readings, GN_READING_poisson_ratio),
               *no_modulus = gn_reason_of(readings, GN_READING_young_modulus);
    if (*no_modulus) gn_reading_absent(readings, modulus, "%s", no_modulus);
    if (*no_ratio) gn_reading_absent(readings, modulus, "%s", no_ratio);
    if (*no_ratio) gn_reading_absent(readings, ratio, "%s", no_ratio);
    if (nu < -1)
        gn_reading_absent(readings, modulus, "plane strain does not allow a ratio of %.3g",
                          readings->poisson_ratio);
    if (nu < -1)
        gn_reading_absent(readings, ratio, "plane strain does not allow a ratio of %.3g",
                          readings->poisson_ratio);
}

/* Records the spacing of the rows around the largest stress, and the decrease after it. */
static void note_rows(const gn_curves *curves, gn_readings *readings) {
    const size_t k = curves->largest, last = curves->history->row_count - 1;
    readings->peak_fall = 1.0 - curves->stress[last] / curves->stress[k];
    readings->peak_rise = k > 0 ? fmin(1.0, 1.0 - curves->stress[k - 1] / curves->stress[k]) : 1.0;
    if (!curves->strain) return;
    readings->peak_strain_least = curves->strain[k > 0 ? k - 1 : k] + 0.0; /* avoids -0 */
    readings->peak_strain_most = curves->strain[k < last ? k + 1 : k];
}

static void read_peak(const gn_curves *curves, gn_readings *readings) {
    readings->largest_stress = readings->peak_stress = curves->stress[curves->largest];
    readings->largest_strain = readings->peak_strain =
        curves->strain ? curves->strain[curves->largest] : NAN;
    note_rows(curves, readings);
    const char *reason = gn_no_peak(curves);
    if (reason) gn_reading_absent(readings, GN_READING_peak_stress, "%s", reason);
    if (reason) gn_reading_absent(readings, GN_READING_peak_strain, "%s", reason);
}

/* Reads the imbalance of the ends. Sums are signed, so that waves between the ends cancel and a
 * missing part remains. */
static void read_balance(const gn_curves *curves, gn_readings *readings) {
    const double *lower = gn_history_column(curves->history, "stress_lower"),
                 *upper = gn_history_column(curves->history, "stress_upper");
    if (curves->tested->one_sided)
        gn_reading_absent(readings, GN_READING_end_imbalance,
                          "one end has the other's force by definition");
    if (!lower || !upper) return;
    size_t rows = curves->largest + 1 - curves->loading.first;
    if (rows < 3)
        gn_reading_absent(readings, GN_READING_end_imbalance,
                          "%zu history row%s up to the largest stress", rows, rows == 1 ? "" : "s");
    double difference = 0, sum = 0;
    for (size_t k = curves->loading.first; k <= curves->largest; k++) {
        difference += upper[k] - lower[k];
        sum += 0.5 * (fabs(upper[k]) + fabs(lower[k]));
    }
    readings->end_imbalance = fabs(difference) / sum;
}

static const double held = 0.05; /* relative fluctuation of a constant load */

/* Finds the beginning of the test. If the ends never moved in the sense of the test, all rows
 * belong to it, and there is no strength. */
static void find_beginning(gn_curves *curves, gn_readings *readings) {
    gn_beginning b = {0};
    gn_beginning_update(&b, curves->strain, curves->stress, curves->history->row_count);
    curves->never_strained =
        !b.moved && curves->strain && curves->history->row_count && !isnan(curves->strain[0]);
    if (!b.moved) return;
    readings->initial_stress = curves->stress[b.first];
    readings->initial_fall = curves->stress[b.first] - curves->stress[b.least];
    curves->begin = b.begun ? b.least : b.first;
    if (b.begun || !(readings->initial_fall > held * readings->initial_stress))
        return; /* a dead load */
    char reason[GN_REASON_SIZE];
    snprintf(reason, sizeof reason,
             "the stress has only fallen from the %.4g Pa that acted on the ends before they moved",
             readings->initial_stress);
    all_absent(readings, reason);
}

void gn_readings_compute(const gn_history *history, const gn_tested *tested,
                         gn_readings *readings) {
    memset(readings, 0, sizeof *readings);
    for (int k = 0; k < GN_READING_COUNT; k++) values_of(readings)[k] = NAN;
    gn_curves c = {.tested = tested, .history = history};
    c.strain = gn_history_column(history, "strain");
    c.stress = gn_history_column(history, "stress");
    c.time = gn_history_column(history, "time");
    c.interval = interval_of(c.time, history->row_count);
    c.average[0] = gn_history_column(history, "strain_xx");
    c.average[1] = gn_history_column(history, "strain_yy");
    c.average[2] = gn_history_column(history, "strain_zz");
    if (!c.stress) all_absent(readings, "the scene has no test");
    if (history->row_count == 0) all_absent(readings, "the history has no rows");
    if (c.stress) find_beginning(&c, readings);
    if (c.stress) c.largest = largest_row(c.stress, c.begin, history->row_count);
    if (c.stress && c.largest == history->row_count)
        all_absent(readings, "the stress never had the sense of the test");
    if (!gn_reason_of(readings, GN_READING_largest_stress)[0]) {
        c.loading = loading_span(c.stress, c.begin, c.largest);
        gn_find_elastic_rows(&c);
        readings->elastic_stress = c.stress[c.elastic.last];
        read_peak(&c, readings);
        if (tested->axis >= 0) {
            read_modulus(&c, readings);
            read_average_modulus(&c, readings);
            read_poisson(&c, readings);
            read_secant_ratio(&c, readings);
            read_plane(&c, readings);
        }
        read_balance(&c, readings);
        gn_readings_of_loading(&c, readings);
        if (gn_test_of(tested->kind)->read) gn_test_of(tested->kind)->read(&c, readings);
    }
    if (c.stress && history->row_count) gn_readings_of_breaks(tested, readings);
    read_zones(tested, readings);
    leave_others(tested, readings);
    settle(readings);
}
