#include "cli/shown.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static gn_shown pressure(double value, bool modulus) {
    static const gn_shown units[] = {{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}};
    /* For rock, moduli and stresses of 0.5 GPa and 0.5 MPa are usual, and strengths of 200 MPa. */
    for (size_t k = modulus ? 0 : 1; k < sizeof units / sizeof *units; k++)
        if (fabs(value) >= 0.1 * units[k].factor) return units[k];
    return (gn_shown){1.0, "Pa"};
}

gn_shown gn_shown_unit(const gn_readings *readings, const char *name, const char *unit,
                       double value) {
    if (strcmp(unit, "Pa") != 0) return (gn_shown){1.0, strcmp(unit, "1") == 0 ? "" : unit};
    const bool modulus = strstr(name, "modulus") != NULL;
    const double kin = modulus ? readings->young_modulus : readings->largest_stress;
    return pressure(isfinite(kin) && kin != 0.0 ? kin : value, modulus);
}

double gn_two_digits(double value) {
    if (!isfinite(value) || value == 0.0) return value;
    const double unit = pow(10.0, floor(log10(fabs(value))) - 1.0);
    return round(value / unit) * unit;
}
