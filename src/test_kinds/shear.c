/* One half of a specimen that is moved along the other: `shear` between two ends, and
 * `simple_shear` throughout the space between them in a periodic box. */
#include "test_kinds/curves.h"

#include <math.h>

static void read_shear(const gn_curves *curves, gn_readings *readings) {
    gn_read_at_peak(curves, GN_READING_shear_strength, curves->stress, 1.0,
                    &readings->shear_strength, readings);
    gn_read_at_peak(curves, GN_READING_normal_stress_at_peak,
                    gn_history_column(curves->history, "normal_stress"), 1.0,
                    &readings->normal_stress_at_peak, readings);
    gn_read_at_peak(curves, GN_READING_dilation_at_peak,
                    gn_history_column(curves->history, "dilation"), 1.0,
                    &readings->dilation_at_peak, readings);
    const double *normal = gn_history_column(curves->history, "normal_stress");
    if (normal)
        readings->friction_angle =
            atan2(curves->stress[curves->largest], normal[curves->largest]) * 180.0 / M_PI;
    gn_need_no_cohesion(curves, readings);
    if (normal && !(normal[curves->largest] > 0.0))
        gn_reading_absent(readings, GN_READING_friction_angle,
                          "the plane is not pressed at the largest shear stress");
    gn_read_slope(curves, GN_READING_shear_modulus, &readings->shear_modulus, readings);
}

/* By friction, a sheared specimen under pressure may keep most of its peak stress, so that a run
 * also ends at a strain. */
#define SHEARED                                                                                    \
    .ends = true, .sheared = true, .sign = 1, .needs = GN_TAKES(normal), .peak_drop = 0.5,         \
    .strain = 0.2, .shape = gn_test_prism,                                                         \
    .readings = GN_READS_LOADED | GN_READS(shear_strength) | GN_READS(normal_stress_at_peak) |     \
                GN_READS(shear_modulus) | GN_READS(friction_angle) | GN_READS(dilation_at_peak) |  \
                GN_READS(secant_modulus) | GN_READS(brittleness),                                  \
    .read = read_shear, .strain_name = "shear strain", .stress_name = "shear stress",              \
    .figures = {{GN_READING_shear_strength, "shear strength"},                                     \
                {GN_READING_normal_stress_at_peak, "normal stress at the peak"},                   \
                {GN_READING_friction_angle, "friction angle"},                                     \
                {GN_READING_shear_modulus, "shear modulus"},                                       \
                {GN_READING_dilation_at_peak, "dilation at the peak"}}

const gn_test_descriptor gn_test_shear = {.name = "shear",
                                          .takes = GN_TAKES_LENGTH | GN_TAKES(normal),
                                          .area_source = "that volume over the height",
                                          SHEARED};

const gn_test_descriptor gn_test_simple_shear = {.name = "simple_shear",
                                                 .periodic_sides = true,
                                                 .takes = GN_TAKES(length) | GN_TAKES(normal),
                                                 .area_source = "the section of the periodic box",
                                                 SHEARED};
