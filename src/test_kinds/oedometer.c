/* Compression along an axis between fixed sides. */
#include "test_kinds/curves.h"

static void read_oedometer(const gn_curves *curves, gn_readings *readings) {
    const gn_reading which = GN_READING_lateral_stress_ratio;
    int axis = curves->tested->axis, dimension = curves->tested->dimension;
    double lateral = 0;
    gn_read_slope(curves, GN_READING_oedometric_modulus, &readings->oedometric_modulus, readings);
    for (int a = 0; a < dimension; a++)
        if (a != axis)
            lateral += gn_line(curves, curves->stress, gn_curves_tensor(curves, "stress", a),
                               curves->elastic)
                           .slope /
                       (dimension - 1);
    readings->lateral_stress_ratio =
        lateral /
        gn_line(curves, curves->stress, gn_curves_tensor(curves, "stress", axis), curves->elastic)
            .slope;
    gn_need_elastic_rows(curves, which, readings);
}

const gn_test_descriptor gn_test_oedometer = {
    .name = "oedometer",
    .ends = true,
    .prism = true,
    .sides_stand = true,
    .sign = -1,
    .takes = GN_TAKES_LENGTH,
    .shape = gn_test_prism,
    .area_source = "that volume over the length",
    .readings = GN_READS_LOADED | GN_READS(oedometric_modulus) | GN_READS(lateral_stress_ratio) |
                GN_READS(secant_modulus),
    .read = read_oedometer,
    .figures = {{GN_READING_oedometric_modulus, "oedometric modulus"},
                {GN_READING_lateral_stress_ratio, "lateral over axial stress"},
                {GN_READING_largest_stress, "largest stress"}},
};
