/* What a laboratory would read off the curves of a test. */
#include "measure/measure.h"

#include <math.h>

/* Rows [first, last) of the history. */
typedef struct span {
    size_t first, last;
} span;

static size_t peak_row(const double *stress, size_t rows) {
    size_t peak = rows;
    for (size_t k = 0; k < rows; k++)
        if (stress[k] > 0 && (peak == rows || stress[k] > stress[peak])) peak = k;
    return peak;
}

/* From the first crossing of 1 % of the peak up to the first crossing of 50 %, both before the
 * peak. */
static span loading_span(const double *stress, size_t peak) {
    span s = {0};
    while (s.first < peak && !(stress[s.first] >= 0.01 * stress[peak])) s.first++;
    s.last = s.first;
    while (s.last < peak && !(stress[s.last] > 0.5 * stress[peak])) s.last++;
    return s;
}

/* Least-squares slope of y over x; NaN for fewer than 3 points, or all at the same x. */
static double slope(const double *x, const double *y, span s) {
    if (!x || !y || s.last - s.first < 3) return NAN;
    double n = (double)(s.last - s.first), mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (size_t k = s.first; k < s.last; k++) mean_x += x[k] / n, mean_y += y[k] / n;
    for (size_t k = s.first; k < s.last; k++) {
        xx += (x[k] - mean_x) * (x[k] - mean_x);
        xy += (x[k] - mean_x) * (y[k] - mean_y);
    }
    return xx > 0 ? xy / xx : NAN;
}

/* Both strains are fitted over the stress and the slopes divided. Fitting lateral over axial strain
 * instead would be biased towards zero by the vibrations in the axial average; over the stress such
 * scatter averages out of both slopes. */
static double poisson_ratio(const double *stress, const double *const strain[3], int dimension,
                            int axis, span s) {
    double lateral = 0;
    for (int a = 0; a < dimension; a++)
        if (a != axis) lateral += slope(stress, strain[a], s) / (dimension - 1);
    return -lateral / slope(stress, strain[axis], s);
}

void gn_readings_compute(const gn_history *history, int dimension, int axis, int sign,
                         gn_readings *readings) {
#define X(name, unit, text) readings->name = NAN;
    GN_READINGS(X)
#undef X
    const double *strain = gn_history_column(history, "strain");
    const double *stress = gn_history_column(history, "stress");
    const double *average[3] = {gn_history_column(history, "strain_xx"),
                                gn_history_column(history, "strain_yy"),
                                gn_history_column(history, "strain_zz")};
    size_t peak = stress ? peak_row(stress, history->row_count) : 0;
    if (!stress || peak == history->row_count) return;
    span s = loading_span(stress, peak);
    readings->peak_stress = stress[peak];
    if (strain) readings->peak_strain = strain[peak];
    readings->young_modulus = slope(strain, stress, s);
    readings->young_modulus_average = sign * slope(average[axis], stress, s);
    readings->poisson_ratio = poisson_ratio(stress, average, dimension, axis, s);
    if (dimension != 2) return;
    /* Plane strain: E' = E/(1 - nu^2), nu' = nu/(1 - nu), solved for E and nu. */
    double nu = readings->poisson_ratio / (1 + readings->poisson_ratio);
    readings->plane_poisson_ratio = nu;
    readings->plane_young_modulus = readings->young_modulus * (1 - nu * nu);
}
