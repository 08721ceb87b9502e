#include "cli/plan_couple.h"

#include "sim/coupling.h"

#include <stdio.h>

static void warn(int *warnings, const char *text) {
    printf("  warning: %s\n", text);
    (*warnings)++;
}

/* Zones this wide return what docs/coupling.md says. */
static const double elements_least = 3.0, diameters_least = 6.0;
/* A modulus 12 % off. */
static const double returned_most = 1e-3;

static void print_zone(const gn_world *w, size_t k, int *warnings) {
    gn_zone_figures f;
    gn_zone_measure(w, k, &f);
    double elements = f.width / f.element, diameters = f.width / f.diameter;
    printf("zone %zu\n  width            %.6g m = %.3g elements = %.3g particles\n", k, f.width,
           elements, diameters);
    printf("  particles        %zu in elements, %zu of them where they have no weight\n",
           f.particles, f.beyond);
    printf("  modulus          %.4g Pa of particles that follow elements, %.4g Pa of these "
           "(confined)\n",
           f.modulus[0], f.modulus[1]);
    printf("  density          %.4g kg/m3, %.4g kg/m3 of the elements\n", f.density[0],
           f.density[1]);
    printf("  returned         %.2g %% of the energy of a wave, by that difference alone\n",
           100.0 * f.returned);
    if (elements < elements_least || diameters < diameters_least)
        warn(warnings, "the zone is thin: three elements and six particles across are advised");
    if (f.returned > returned_most)
        warn(warnings, "particles and elements differ: calibrate the particles to the elements' E "
                       "and nu, and their density");
    if (f.least > 1e-6) {
        char text[128];
        snprintf(text, sizeof text,
                 "the elements end where they still have a weight of %.2g: `from` "
                 "is beyond their end",
                 f.least);
        warn(warnings, text);
    }
    if (f.beyond)
        warn(warnings, "particles reach beyond the plane through `to`, where elements carry all");
}

void gn_print_zones(const gn_world *w, int *warnings) {
    for (size_t k = 0; w->scene.has_couple && k < w->scene.couple.zone_count; k++)
        print_zone(w, k, warnings);
}
