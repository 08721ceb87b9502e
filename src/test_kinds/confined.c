/* Compression along an axis under the pressure of a membrane: triaxial, and biaxial in plane
 * strain. */
#include "test_kinds/curves.h"

static void read_confined(const gn_curves *curves, gn_readings *readings) {
    const double *pressure = gn_history_column(curves->history, "membrane_pressure");
    gn_read_at_peak(curves, GN_READING_confinement, pressure, 1.0, &readings->confinement,
                    readings);
    gn_read_at_peak(curves, GN_READING_axial_strength, curves->stress, 1.0,
                    &readings->axial_strength, readings);
    if (pressure) readings->axial_strength += pressure[curves->largest];
    gn_read_strain_at_peak(curves, GN_READING_volumetric_strain_at_peak, "volumetric_strain",
                           &readings->volumetric_strain_at_peak, readings);
    gn_read_strain_at_peak(curves, GN_READING_lateral_strain_at_peak, "lateral_strain",
                           &readings->lateral_strain_at_peak, readings);
}

#define CONFINED                                                                                   \
    .ends = true, .prism = true, .confined = true, .sign = -1, .takes = GN_TAKES_LENGTH,           \
    .peak_drop = 0.5, .shape = gn_test_prism, .area_source = "that volume over the length",        \
    .readings = GN_READS_AXIAL | GN_READS(confinement) | GN_READS(axial_strength) |                \
                GN_READS(volumetric_strain_at_peak) | GN_READS(lateral_strain_at_peak) |           \
                GN_READS(crack_damage_stress),                                                     \
    .read = read_confined, .stress_name = "deviator",                                              \
    .figures = {{GN_READING_axial_strength, "axial strength"},                                     \
                {GN_READING_peak_stress, "deviator at the peak"},                                  \
                {GN_READING_confinement, "confinement"},                                           \
                GN_FIGURES_ELASTIC,                                                                \
                {GN_READING_crack_initiation_stress, "stress at which cracks begin"},              \
                {GN_READING_crack_damage_stress, "stress at which damage begins"}}

const gn_test_descriptor gn_test_triaxial = {
    .name = "triaxial", .counterpart = "biaxial", .dimension = 3, CONFINED};
const gn_test_descriptor gn_test_biaxial = {
    .name = "biaxial", .counterpart = "triaxial", .dimension = 2, CONFINED};
