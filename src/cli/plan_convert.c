#include "cli/plan_convert.h"

#include "cli/plan_couple.h"
#include "cli/plan_time.h"
#include "cli/progress.h"

#include <math.h>
#include <stdio.h>

static void print_sleepers(const gn_world *w, const gn_foreseen *f) {
    printf("particles that sleep\n  asleep           %zu, with %zu bonds put by; above is the step "
           "of the elements alone\n",
           gn_conversion_asleep(&w->dem), w->dem.prepared.soa.count);
    if (f->all.sharp < INFINITY)
        printf("  sharp limit      %.6g s of all of them by themselves, rigorous bound %.6g s\n",
               f->all.sharp, f->all.bound);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(&w->ctx, &w->solids, watched, sizeof watched))
        printf("  warning: %s\n", watched);
}

/* Where a stage has an end that may come at another time, what comes after it does as well. */
static void print_stages(const gn_world *w, const gn_foreseen *f) {
    const gn_course *c = &f->course;
    for (size_t k = 0; w->ctx.scene.stage_count && k < c->count; k++) {
        const gn_course_part *p = &c->part[k];
        const bool last = k + 1 == w->ctx.scene.stage_count;
        printf("  stage %-10s from %.4g s to %.4g s%s\n", w->ctx.scene.stages[k].name, p->begin,
               p->end,
               p->guessed         ? ", a guess: it waits for rest, here for twenty times what "
                                    "waves take along the body"
               : p->open && !last ? " at the latest: it may end before, by what is not foretold"
               : p->open          ? " at the latest"
                                  : "");
    }
    if (c->count < w->ctx.scene.stage_count)
        printf("  stage %-10s not reached before time.end\n", w->ctx.scene.stages[c->count].name);
}

/* Looks come every so many steps: a limit may be reached so much before it is seen. */
static double look_of(const gn_world *w, const gn_foreseen *f) {
    return (double)w->ctx.scene.couple.convert.every * f->course.part[f->stage].dt;
}

/* s: how far a limit may be off by waves. A body lags behind a load that grows evenly, and swings
 * about it, by 1/omega of its slowest motion; one that is pulled at once has stress in steps, as
 * waves come by, of what the first of them brings. */
static double lag_of(const gn_foreseen *f) {
    const double pi = 3.14159265358979323846, most = 0.5 * f->period;
    if (f->rise < f->period) return most;
    return fmax(f->period / (2.0 * pi), fmin(f->burst * f->rise, most));
}

static void print_waves(const gn_foreseen *f) {
    const double fast = 0.2, lag = lag_of(f);
    const double share = f->rise > 0.0 ? lag / f->rise : (double)INFINITY;
    printf("  waves            shift that by some %.2g s (slowest period %.3g s; the load comes "
           "within %.3g s)\n",
           lag, f->period, f->rise);
    if (f->time < INFINITY && share > fast)
        printf("  warning: the load is fast beside waves: they may bring a limit first, at another "
               "time and place than at rest\n");
    if (f->time == INFINITY && (f->most * (1.0 + fmin(1.0, share)) >= 1.0 || f->burst >= 1.0))
        printf("  warning: the load is fast beside waves, which may bring a limit that it does not "
               "come to at rest\n");
}

static void print_when(const gn_world *w, const gn_foreseen *f) {
    if (f->time < INFINITY)
        printf("  first            at %.3g s", f->time);
    else
        printf("  first            none before the end: %.3g of a limit at most", f->most);
    if (w->ctx.scene.stage_count) printf(", in stage '%s'", w->ctx.scene.stages[f->stage].name);
    if (f->time < INFINITY && look_of(w, f) > 0.02 * f->time)
        printf(", seen up to %.2g s later (couple.convert.every)", look_of(w, f));
    printf("%s\n", f->time < INFINITY ? "" : "; below is what one would make of the step");
}

/* Less than so much apart they are one number. */
static const double one_number = 0.95;

static void print_dt(const gn_foreseen *f) {
    printf("  dt               %.6g s then, set by the %s\n", f->first.dt, f->first.side);
    printf("                   %.6g", f->least.dt);
    if (f->least.dt < one_number * f->grown.dt) printf(" to %.6g", f->grown.dt);
    printf(" s when more has gone, set by the %s\n", f->least.side);
}

/* What comes when the body follows its motions and loads slowly. */
static void print_first(const gn_world *w, const gn_foreseen *f) {
    printf("conversion, as the body would be at rest under its motions and loads\n");
    print_stages(w, f);
    if (!f->place) {
        printf("  first            none: nothing loads it\n");
        return;
    }
    print_when(w, f);
    print_waves(f);
    if (*f->halt) {
        printf("  warning: the first would end the run: %s\n", f->halt);
        return;
    }
    print_dt(f);
    if (w->ctx.scene.couple.spins == GN_COUPLE_SLAVED)
        printf(
            "                   roughly: what slaved spins take goes by single elements of fronts; "
            "runs had 0.4 to 2 times that\n");
    if (*f->stop && f->time < INFINITY && f->part * f->reach >= 1.0)
        printf(
            "  warning: at some %.3g times that load conversion would end the run (roughly: where "
            "elements are smaller than particles, 0.4 to 1.6 times as much): %s\n",
            1.0 / f->part, f->stop);
}

/* s: the run ends with a first conversion that comes to the end of the box. */
static double end_of(const gn_foreseen *f) {
    const double end = gn_course_end(&f->course);
    return *f->halt ? fmin(f->time, end) : end;
}

/* Steps of elements alone and, from the time on that was foreseen, with what has converted: with
 * the longest step that is foretold, and with the shortest. */
typedef struct foreseen_steps {
    double alone, least, most;
} foreseen_steps;

/* Of a part of the course that lies between two times. */
static double steps_between(const gn_course_part *p, double from, double to, double dt) {
    const double length = fmin(p->end, to) - fmax(p->begin, from);
    return length > 0.0 ? ceil(length / dt) : 0.0;
}

static void find_steps(const gn_foreseen *f, foreseen_steps *steps) {
    const double end = end_of(f), until = f->place ? fmin(f->time, end) : end;
    const gn_course *c = &f->course;
    *steps = (foreseen_steps){0};
    for (size_t k = 0; k < c->count; k++) {
        const gn_course_part *p = &c->part[k];
        steps->alone += steps_between(p, 0.0, until, p->dt);
        if (!(until < end)) continue;
        /* A stage may have a step of its own. */
        const double dt = p->later > 0.0 ? p->later : p->dt;
        steps->least += steps_between(p, until, end, dt);
        steps->most += steps_between(p, until, end, dt * f->least.dt / f->grown.dt);
    }
}

static void print_steps(const gn_world *w, const gn_foreseen *f, const foreseen_steps *s) {
    printf("cost\n  steps            %.0f", s->alone + s->least);
    if (s->least < one_number * s->most) printf(" to %.0f", s->alone + s->most);
    printf(" to t = %g s", end_of(f));
    if (s->most > 0.0) printf(", %.0f of them of elements alone", s->alone);
    bool open = w->ctx.scene.stop_peak_drop > 0.0 || w->ctx.scene.stop_strain > 0.0;
    for (size_t k = 0; k < f->course.count; k++) open = open || f->course.part[k].open;
    printf("%s\n", open ? " (a stop condition may come first)" : "");
}

static void print_foreseen(const gn_world *w, const gn_foreseen *f, const double per_step[2]) {
    char text[32], most[32];
    foreseen_steps s;
    find_steps(f, &s);
    print_first(w, f);
    print_steps(w, f, &s);
    printf("  per step         %.1f us with %d thread%s", per_step[0] * 1e6, w->ctx.threads,
           w->ctx.threads > 1 ? "s" : "");
    if (per_step[1] > 0.0)
        printf(" of elements alone, %.1f us once %zu of them are left", per_step[1] * 1e6, f->some);
    const double alone = s.alone * per_step[0];
    printf("\n  time             %s",
           gn_format_seconds(alone + s.least * per_step[1], text, sizeof text));
    if (s.least < one_number * s.most)
        printf(" to %s", gn_format_seconds(alone + s.most * per_step[1], most, sizeof most));
    printf("%s\n", s.most > 0.0 ? ", and what more converts costs" : "");
}

/* Elements alone as far as they go, and what converts first; [2]: s, of a step of either. */
static gneiss_status try_converting(gn_world *w, bool print, gn_foreseen *f, double per_step[2],
                                    gneiss_error *error) {
    GN_TRY(gn_conversion_foresee(w, f, error));
    if (print) print_sleepers(w, f);
    GN_TRY(gn_time_steps(w, fmin(w->ctx.scene.end, 0.5 * f->time), &per_step[0], error));
    if (!f->place) return GNEISS_OK;
    GN_TRY(gn_conversion_try(w, f, error));
    if (*f->halt) return GNEISS_OK;
    GN_TRY(gn_time_some(w, &per_step[1], error));
    return gn_conversion_try_more(w, f, error);
}

gneiss_status gn_plan_converting(gn_world *w, bool print, double *seconds, gneiss_error *error) {
    gn_foreseen f = {0};
    foreseen_steps steps;
    double per_step[2] = {0.0};
    gneiss_status status = try_converting(w, print, &f, per_step, error);
    if (status == GNEISS_OK) {
        find_steps(&f, &steps);
        *seconds = steps.alone * per_step[0] + 0.5 * (steps.least + steps.most) * per_step[1];
    }
    if (status == GNEISS_OK && print) print_foreseen(w, &f, per_step);
    gn_foreseen_free(&f);
    return status;
}

/* Steps become shorter with the first conversion, not before. */
static void warn_of_looks(const gn_world *w, int *warnings) {
    const double steps = w->ctx.scene.end / w->ctx.dt,
                 every = (double)w->ctx.scene.couple.convert.every;
    if (every < steps) return;
    printf(
        "  warning: couple.convert.every (%.0f steps) is no less than the %.0f steps of the run: "
        "nothing will be converted\n",
        every, steps);
    (*warnings)++;
}

static void print_places(gn_world *w, int *warnings) {
    gn_conversion_places_seen seen;
    if (gn_conversion_begun(&w->solids) || gn_conversion_see_places(w, &seen, NULL) != GNEISS_OK)
        return;
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
    if (!gn_converts(&w->ctx) ||
        gn_conversion_measure(&w->ctx, &w->dem, &w->boundary, &w->solids, &f, NULL) != GNEISS_OK)
        return;
    const double width = w->ctx.scene.couple.convert.width;
    printf("conversion\n  width of a zone  %.6g m = %.3g elements (%.3g of the smallest) = %.3g "
           "particles\n",
           width, width / f.element, width / f.smallest, width / f.diameter);
    printf("  in the box       %zu of %zu elements, %zu of %zu particles\n", f.elements,
           gn_conversion_elements(&w->solids), f.particles, w->dem.particles.soa.count);
    printf("  held             %zu elements there, of motions and loads\n", f.held);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(&w->ctx, &w->solids, watched, sizeof watched)) {
        printf("  warning: %s\n", watched);
        (*warnings)++;
    }
    printf("  masses           %.4g times those of the elements\n", f.mass);
    const gn_convert_def *def = &w->ctx.scene.couple.convert;
    if (def->relax > 0.0)
        printf("  relaxation       to %g of the mean contact force, %lld iterations at most\n",
               def->relax, (long long)def->relax_iterations);
    for (size_t k = 0; k < f.materials; k++)
        gn_print_zone_material(&f.material[k], f.materials > 1, warnings);
    print_places(w, warnings);
    warn_of_looks(w, warnings);
    const double advised = gn_zone_advised(f.element, f.diameter);
    const bool thin = gn_zone_is_thin(width, advised);
    if (thin)
        printf(
            "  warning: the zone is thin%s: three elements and six particles across are advised\n",
            width >= gn_zone_advised(f.smallest, f.diameter)
                ? " for elements of the mean size in the box, not for the smallest; what counts "
                  "is where it converts"
                : "");
    if (width > f.side)
        printf(
            "  warning: the zone is wider than the shortest side of the body, %.4g m: it spans all "
            "of the section, where no element is left by itself; %.2g m are advised\n",
            f.side, advised);
    *warnings += thin + (width > f.side);
}
