/* A disc under two opposite line loads P across its diameter D. In its middle the tension across
 * the load is 2 P/(pi D t), with the thickness t (Hondros 1959, Aust. J. Appl. Sci. 10, 243-268;
 * ISRM 1978). */
#include "test_kinds/curves.h"

#include <math.h>

static gn_tested_shape disc(const gn_test_sizes *t, const gn_tested_specimen *x) {
    const bool plane = x->dimension == 2;
    gn_tested_shape s = {0};
    s.diameter = t->diameter > 0.0 ? t->diameter : x->side[x->axis];
    s.thickness = plane ? 1.0 : t->thickness > 0.0 ? t->thickness : x->side[2];
    s.length = s.diameter;
    s.area = 0.5 * M_PI * s.diameter * s.thickness;
    s.section = s.diameter * s.thickness;
    if (t->diameter > 0.0 && (plane || t->thickness > 0.0))
        s.volume = 0.25 * M_PI * s.diameter * s.diameter * s.thickness;
    return s;
}

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
    const double *across = gn_curves_tensor(curves, "centre_stress", 1 - axis),
                 *along = gn_curves_tensor(curves, "centre_stress", axis);
    gn_read_at_peak(curves, GN_READING_indirect_tensile_strength, curves->stress, 1.0,
                    &readings->indirect_tensile_strength, readings);
    if (!across || !along) {
        gn_reading_absent(readings, GN_READING_centre_tension, "%s", none);
        gn_reading_absent(readings, GN_READING_centre_ratio, "%s", none);
        gn_reading_absent(readings, GN_READING_centre_compression_ratio, "%s", none);
        return;
    }
    gn_read_at_peak(curves, GN_READING_centre_tension, across, 1.0, &readings->centre_tension,
                    readings);
    ratio_in_the_middle(curves, GN_READING_centre_ratio, across, 1.0, &readings->centre_ratio,
                        readings);
    ratio_in_the_middle(curves, GN_READING_centre_compression_ratio, along, -1.0,
                        &readings->centre_compression_ratio, readings);
}

const gn_test_descriptor gn_test_brazilian = {
    .name = "brazilian",
    .ends = true,
    .disc = true,
    .sign = -1,
    .takes = GN_TAKES(diameter) | GN_TAKES(thickness) | GN_TAKES(centre),
    .peak_drop = 0.5,
    .shape = disc,
    .area_source = "pi/2 times diameter and thickness: the force over it is 2 P/(pi D t)",
    .readings = GN_READS_LOADED | GN_READS(indirect_tensile_strength) | GN_READS(centre_tension) |
                GN_READS(centre_ratio) | GN_READS(centre_compression_ratio) | GN_READS(brittleness),
    .read = read_brazilian,
    .strain_name = "closing over the diameter",
    .stress_name = "2P/(πDt)",
    .figures = {{GN_READING_indirect_tensile_strength, "indirect tensile strength"},
                {GN_READING_centre_tension, "tension in the middle at the peak"},
                {GN_READING_centre_ratio, "tension in the middle over 2P/πDt"},
                {GN_READING_centre_compression_ratio, "pressure in the middle over 2P/πDt"}},
};
