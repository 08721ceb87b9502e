/* A specimen that a membrane, walls or a periodic box presses equally from all sides. */
#include "test_kinds/curves.h"

/* Returns sizes of 1: stress and strain are measured in the specimen and not computed from forces
 * and displacements of ends. */
static gn_tested_shape unit(const gn_test_sizes *t, const gn_tested_specimen *x) {
    (void)t, (void)x;
    return (gn_tested_shape){.length = 1.0, .area = 1.0, .section = 1.0};
}

static void read_hydrostatic(const gn_curves *curves, gn_readings *readings) {
    gn_read_slope(curves, GN_READING_bulk_modulus, &readings->bulk_modulus, readings);
}

const gn_test_descriptor gn_test_hydrostatic = {
    .name = "hydrostatic",
    .isotropic = true,
    .sign = -1,
    .shape = unit,
    .area_source = "",
    .readings = GN_READS_TEST | GN_READS(bulk_modulus) | GN_READS(secant_modulus),
    .read = read_hydrostatic,
    .strain_name = "loss of volume",
    .stress_name = "mean pressure",
    .figures = {{GN_READING_bulk_modulus, "bulk modulus"},
                {GN_READING_largest_stress, "largest mean pressure"}},
};
