#include "cli/plan_convert.h"

#include "cli/plan_couple.h"
#include "sim/conversion.h"

#include <math.h>
#include <stdio.h>

/* As of fixed zones (plan_couple.c). */
static const double elements_least = 3.0, diameters_least = 6.0;

gneiss_status gn_print_sleepers(gn_world *w, gneiss_error *error) {
    gn_step_limit limit;
    const double share = gn_world_nonviscous_share(w) * w->scene.safety;
    if (!gn_converts(w)) return GNEISS_OK;
    GN_TRY(gn_conversion_limit(w, &limit, error));
    printf(
        "particles that sleep\n  asleep           %zu, with %zu bonds put by; above is the step of "
        "the elements alone\n",
        w->dem.particles.soa.count, w->dem.prepared.soa.count);
    if (!(limit.sharp < INFINITY)) return GNEISS_OK;
    printf("  sharp limit      %.6g s of all of them, rigorous bound %.6g s\n", limit.sharp,
           limit.bound);
    printf("  dt               %.6g s or a little more, once some are awake\n",
           fmin(w->dt, share * limit.sharp));
    return GNEISS_OK;
}

/* Steps become shorter with the first conversion, not before. */
static void warn_of_looks(const gn_world *w, int *warnings) {
    const double steps = w->scene.end / w->dt, every = (double)w->scene.couple.convert.every;
    if (every < steps) return;
    printf(
        "  warning: couple.convert.every (%.0f steps) is no less than the %.0f steps of the run: "
        "nothing will be converted\n",
        every, steps);
    (*warnings)++;
}

void gn_print_conversion(const gn_world *w, int *warnings) {
    gn_conversion_figures f;
    if (!gn_converts(w) || gn_conversion_measure(w, &f, NULL) != GNEISS_OK) return;
    const double width = w->scene.couple.convert.width;
    printf("conversion\n  width of a zone  %.6g m = %.3g elements = %.3g particles\n", width,
           width / f.element, width / f.diameter);
    printf("  in the box       %zu of %zu elements, %zu of %zu particles\n", f.elements,
           gn_conversion_elements(w), f.particles, w->dem.particles.soa.count);
    printf("  held             %zu elements there, of motions and loads\n", f.held);
    printf("  masses           %.4g times those of the elements\n", f.mass);
    const gn_convert_def *def = &w->scene.couple.convert;
    if (def->relax > 0.0)
        printf("  relaxation       to %g of the mean contact force, %lld iterations at most\n",
               def->relax, (long long)def->relax_iterations);
    for (size_t k = 0; k < f.materials; k++)
        gn_print_zone_material(&f.material[k], f.materials > 1, warnings);
    warn_of_looks(w, warnings);
    const double advised = fmax(elements_least * f.element, diameters_least * f.diameter);
    if (width < advised)
        printf(
            "  warning: the zone is thin: three elements and six particles across are advised\n");
    if (width > f.side)
        printf(
            "  warning: the zone is wider than the shortest side of the body, %.4g m: it spans all "
            "of the section, where no element is left by itself; %.2g m are advised\n",
            f.side, advised);
    *warnings += (width < advised) + (width > f.side);
}
