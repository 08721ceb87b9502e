#include "cli/shown.h"

#include <math.h>
#include <string.h>

/* From a tenth of a unit on, so that 0.5 GPa is not 500 MPa beside 20 GPa of another run. */
static gn_shown pressure(double value) {
    static const gn_shown units[] = {{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}};
    for (size_t k = 0; k < sizeof units / sizeof *units; k++)
        if (fabs(value) >= 0.1 * units[k].factor) return units[k];
    return (gn_shown){1.0, "Pa"};
}

gn_shown gn_shown_unit(const gn_readings *r, const char *name, const char *unit, double value) {
    if (strcmp(unit, "Pa") != 0) return (gn_shown){1.0, strcmp(unit, "1") == 0 ? "" : unit};
    const double kin = strstr(name, "modulus") ? r->young_modulus : r->largest_stress;
    return pressure(isfinite(kin) && kin != 0.0 ? kin : value);
}

double gn_two_digits(double value) {
    if (!isfinite(value) || value == 0.0) return value;
    const double unit = pow(10.0, floor(log10(fabs(value))) - 1.0);
    return round(value / unit) * unit;
}
