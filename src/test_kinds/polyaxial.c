/* Compression along an axis of a specimen that walls with servos or a periodic box enclose, with a
 * stress on every pair of its sides: a true triaxial test (in 2D a biaxial one) without a membrane.
 * The principal stresses are those along the axes, because the sides are frictionless or, in a
 * periodic box, absent. The friction angle of a material without cohesion is sin(phi) = (s1 -
 * s3)/(s1 + s3) with the largest and the smallest principal stress (Coulomb 1776, by Mohr's
 * circle). */
#include "test_kinds/curves.h"

#include <math.h>

/* Returns sizes of 1: stress and strain are measured in the specimen. */
static gn_tested_shape unit(const gn_test_sizes *t, const gn_tested_specimen *x) {
    (void)t, (void)x;
    return (gn_tested_shape){.length = 1.0, .area = 1.0, .section = 1.0};
}

static void read_polyaxial(const gn_curves *curves, gn_readings *readings) {
    double most = -INFINITY, least = INFINITY, sum = 0.0;
    for (int a = 0; a < curves->tested->dimension; a++) {
        const double *column = gn_curves_tensor(curves, "stress", a);
        const double stress = column ? -column[curves->largest] : NAN;
        most = fmax(most, stress);
        least = fmin(least, stress);
        sum += stress;
    }
    readings->friction_angle = asin((most - least) / (most + least)) * 180.0 / M_PI;
    gn_need_no_cohesion(curves, readings);
    if (!(least > 0.0))
        gn_reading_absent(readings, GN_READING_friction_angle,
                          "a principal stress is not compressive at the largest deviator");
    readings->least_stress = least;
    readings->mean_stress = sum / curves->tested->dimension;
    gn_read_strain_at_peak(curves, GN_READING_volumetric_strain_at_peak, "volumetric_strain",
                           &readings->volumetric_strain_at_peak, readings);
}

const gn_test_descriptor gn_test_polyaxial = {
    .name = "polyaxial",
    .enclosed = true,
    .sign = -1,
    .peak_drop = 0.5,
    .shape = unit,
    .area_source = "",
    .readings = GN_READS_TEST | GN_READS(secant_modulus) | GN_READS(friction_angle) |
                GN_READS(least_stress) | GN_READS(mean_stress) |
                GN_READS(volumetric_strain_at_peak),
    .read = read_polyaxial,
    .stress_name = "deviator",
    .figures = {{GN_READING_largest_stress, "largest deviator"},
                {GN_READING_friction_angle, "friction angle"},
                {GN_READING_mean_stress, "mean stress at the largest deviator"},
                {GN_READING_volumetric_strain_at_peak, "loss of volume at the peak"}},
};
