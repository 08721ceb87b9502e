/* What conversions could not keep: sim/conversion_masses.c, conversion_momentum.c. */
#include "run/verdict.h"
#include "sim/conversion.h"

#include <math.h>

/* Of the most angular momentum that the body had, or m v r of its vibration. */
static const double turned_most = 0.01;

void gn_warn_of_jumps(const gn_run *run, gn_warnings *list) {
    const gn_world *w = &run->world;
    const gn_corrections *c = &w->couple.corrected;
    if (!gn_converts(w) || !(c->most > turned_most * c->scale)) return;
    gn_warning *to = gn_warnings_add(list, "conversion_missed");
    snprintf(to->text, sizeof to->text,
             "elements that turned into particles changed the body's angular momentum by up to "
             "%.3g kg m2/s in all, %.2g %% of the most that it had (or of m v r of how it "
             "vibrates), its moment of inertia by %.2g %% and the place of its centre of mass by "
             "%.2g m: zones were too small to keep them; elements of two diameters of particles "
             "and more, with a zone of three and more of them, or six (couple.convert.width), "
             "keep more",
             c->most, 100.0 * c->most / c->scale, 100.0 * c->inertia,
             sqrt(gn_dot3(c->centre, c->centre)));
}
