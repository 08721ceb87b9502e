#include "cli/plan_convert.h"

#include "cli/plan_couple.h"
#include "cli/progress.h"
#include "sim/conversion.h"

#include <math.h>
#include <stdio.h>

/* As of fixed zones (plan_couple.c). */
static const double elements_least = 3.0, diameters_least = 6.0;

void gn_print_sleepers(const gn_world *w, const gn_foreseen *f) {
    printf("particles that sleep\n  asleep           %zu, with %zu bonds put by; above is the step "
           "of the elements alone\n",
           gn_conversion_asleep(w), w->dem.prepared.soa.count);
    if (f->all.sharp < INFINITY)
        printf("  sharp limit      %.6g s of all of them by themselves, rigorous bound %.6g s\n",
               f->all.sharp, f->all.bound);
}

/* What comes when the body follows its motions and loads slowly. */
static void print_first(const gn_world *w, const gn_foreseen *f) {
    const char *stage = w->scene.stage_count ? " of the first stage" : "";
    printf("conversion, as the body would be at rest under its motions and loads\n");
    if (!f->place) {
        printf("  first            none: nothing loads it%s\n",
               *stage ? " in the first stage" : "");
        return;
    }
    if (f->time < INFINITY)
        printf("  first            at %.3g s\n", f->time);
    else
        printf(
            "  first            none before the end%s; below is what one would make of the step\n",
            stage);
    if (*f->halt) {
        printf("  warning: the first would end the run: %s\n", f->halt);
        return;
    }
    printf("  dt               %.6g s then, set by the %s\n", f->first.dt, f->first.side);
    printf("                   %.6g s when more has gone, set by the %s\n", f->grown.dt,
           f->grown.side);
}

/* s: the run ends with a first conversion that comes to the end of the box. */
static double end_of(const gn_world *w, const gn_foreseen *f) {
    return *f->halt ? fmin(f->time, w->scene.end) : w->scene.end;
}

void gn_foreseen_steps(const gn_world *w, const gn_foreseen *f, double dt, double steps[2]) {
    const double end = end_of(w, f), until = f->place ? fmin(f->time, end) : end;
    steps[0] = ceil(until / dt);
    steps[1] = until < end ? ceil((end - until) / f->grown.dt) : 0.0;
}

void gn_print_foreseen(const gn_world *w, const gn_foreseen *f, const double steps[2],
                       const double per_step[2]) {
    char text[32];
    print_first(w, f);
    if (w->scene.couple.spins == GN_COUPLE_SLAVED && f->place && !*f->halt)
        printf("                   or less: slaved spins may take more of it with every front\n");
    printf("cost\n  steps            %.0f to t = %g s", steps[0] + steps[1], end_of(w, f));
    if (steps[1] > 0.0) printf(", %.0f of them of elements alone", steps[0]);
    printf("%s\n",
           w->scene.stage_count || w->scene.stop_peak_drop > 0.0 || w->scene.stop_strain > 0.0
               ? " (a stop condition may come first)"
               : "");
    printf("  per step         %.1f us with %d thread%s", per_step[0] * 1e6, w->threads,
           w->threads > 1 ? "s" : "");
    if (per_step[1] > 0.0)
        printf(" of elements alone, %.1f us with what converts first", per_step[1] * 1e6);
    printf("\n  time             %s%s\n",
           gn_format_seconds(steps[0] * per_step[0] + steps[1] * per_step[1], text, sizeof text),
           steps[1] > 0.0 ? ", and what more converts costs" : "");
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

static void print_places(gn_world *w, int *warnings) {
    gn_conversion_places_seen seen;
    if (gn_conversion_begun(w) || gn_conversion_see_places(w, &seen, NULL) != GNEISS_OK) return;
    printf("  places           %zu looked at", seen.looked);
    if (seen.along)
        printf(": at %zu elements around go along, as particles in one are too few", seen.along);
    printf("\n");
    if (!seen.too_few) return;
    printf(
        "  warning: at %zu of %zu places that were looked at particles are too few to weigh what "
        "elements do that would go: conversion there ends the run (a wider zone, or larger "
        "elements)\n",
        seen.too_few, seen.looked);
    (*warnings)++;
}

void gn_print_conversion(gn_world *w, int *warnings) {
    gn_conversion_figures f;
    if (!gn_converts(w) || gn_conversion_measure(w, &f, NULL) != GNEISS_OK) return;
    const double width = w->scene.couple.convert.width;
    printf("conversion\n  width of a zone  %.6g m = %.3g elements (%.3g of the smallest) = %.3g "
           "particles\n",
           width, width / f.element, width / f.smallest, width / f.diameter);
    printf("  in the box       %zu of %zu elements, %zu of %zu particles\n", f.elements,
           gn_conversion_elements(w), f.particles, w->dem.particles.soa.count);
    printf("  held             %zu elements there, of motions and loads\n", f.held);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(w, watched, sizeof watched)) {
        printf("  warning: %s\n", watched);
        (*warnings)++;
    }
    printf("  masses           %.4g times those of the elements\n", f.mass);
    const gn_convert_def *def = &w->scene.couple.convert;
    if (def->relax > 0.0)
        printf("  relaxation       to %g of the mean contact force, %lld iterations at most\n",
               def->relax, (long long)def->relax_iterations);
    for (size_t k = 0; k < f.materials; k++)
        gn_print_zone_material(&f.material[k], f.materials > 1, warnings);
    print_places(w, warnings);
    warn_of_looks(w, warnings);
    const double advised = fmax(elements_least * f.element, diameters_least * f.diameter);
    if (width < advised)
        printf(
            "  warning: the zone is thin%s: three elements and six particles across are advised\n",
            width >= fmax(elements_least * f.smallest, diameters_least * f.diameter)
                ? " for elements of the mean size in the box, not for the smallest; what counts "
                  "is where it converts"
                : "");
    if (width > f.side)
        printf(
            "  warning: the zone is wider than the shortest side of the body, %.4g m: it spans all "
            "of the section, where no element is left by itself; %.2g m are advised\n",
            f.side, advised);
    *warnings += (width < advised) + (width > f.side);
}
