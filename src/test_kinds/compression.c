/* Uniaxial compression of a prism along an axis. */
#include "test_kinds/curves.h"

const gn_test_descriptor gn_test_compression = {
    .name = "compression",
    .ends = true,
    .prism = true,
    .general = true,
    .sign = -1,
    .takes = GN_TAKES_LENGTH,
    .peak_drop = 0.5, /* beyond the rows from which a strength is read */
    .study = "compression",
    .shape = gn_test_prism,
    .area_source = "that volume over the length",
    .readings = GN_READS_AXIAL | GN_READS(crack_damage_stress),
    .figures = {GN_FIGURES_ELASTIC,
                GN_FIGURES_PEAK,
                {GN_READING_crack_initiation_stress, "stress at which cracks begin"},
                {GN_READING_crack_damage_stress, "stress at which damage begins"}},
};
