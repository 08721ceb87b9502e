/* Direct tension of a prism along an axis. */
#include "test_kinds/curves.h"

/* The fracture energy requires a load of at most a tenth of the peak. The peak drop is larger than
 * the corresponding 0.9 because broken parts vibrate. */
const gn_test_descriptor gn_test_tension = {
    .name = "tension",
    .ends = true,
    .prism = true,
    .general = true,
    .sign = 1,
    .takes = GN_TAKES_LENGTH,
    .peak_drop = 0.95,
    .study = "tension",
    .shape = gn_test_prism,
    .area_source = "that volume over the length",
    .readings = GN_READS_AXIAL | GN_READS(fracture_energy),
    .read = gn_read_fracture_energy,
    .figures = {GN_FIGURES_ELASTIC,
                GN_FIGURES_PEAK,
                {GN_READING_crack_initiation_stress, "stress at which cracks begin"},
                {GN_READING_fracture_energy, "fracture energy"}},
};
