#include "cli/plan_convert.h"

#include "cli/plan_couple.h"
#include "cli/plan_time.h"
#include "cli/progress.h"

#include <math.h>
#include <stdio.h>

static void print_sleepers(const gn_world *world, const gn_foreseen *foreseen) {
    printf("particles that sleep\n  asleep           %zu, with %zu bonds put by; above is the step "
           "of the elements alone\n",
           gn_conversion_asleep(world), world->dem.prepared.soa.count);
    if (foreseen->all.sharp < INFINITY)
        printf("  sharp limit      %.6g s of all of them by themselves, rigorous bound %.6g s\n",
               foreseen->all.sharp, foreseen->all.bound);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(world, watched, sizeof watched)) printf("  warning: %s\n", watched);
}

/* Where a stage has an end that may come at another time, what comes after it does as well. */
static void print_stages(const gn_world *world, const gn_foreseen *foreseen) {
    const gn_course *c = &foreseen->course;
    for (size_t k = 0; world->scene.stage_count && k < c->count; k++) {
        const gn_course_part *part = &c->part[k];
        const bool last = k + 1 == world->scene.stage_count;
        printf("  stage %-10s from %.4g s to %.4g s%s\n", world->scene.stages[k].name, part->begin,
               part->end,
               part->guessed         ? ", a guess: it waits for rest, here for twenty times what "
                                       "waves take along the body"
               : part->open && !last ? " at the latest: it may end before, by what is not foretold"
               : part->open          ? " at the latest"
                                     : "");
    }
    if (c->count < world->scene.stage_count)
        printf("  stage %-10s not reached before time.end\n", world->scene.stages[c->count].name);
}

/* Looks come every so many steps: a limit may be reached so much before it is seen. */
static double look_of(const gn_world *world, const gn_foreseen *foreseen) {
    return (double)world->scene.couple.convert.every * foreseen->course.part[foreseen->stage].dt;
}

/* s: how far a limit may be off by waves. A body lags behind a load that grows evenly, and swings
 * about it, by 1/omega of its slowest motion; one that is pulled at once has stress in steps, as
 * waves come by, of what the first of them brings. */
static double lag_of(const gn_foreseen *foreseen) {
    const double pi = 3.14159265358979323846, most = 0.5 * foreseen->period;
    if (foreseen->rise < foreseen->period) return most;
    return fmax(foreseen->period / (2.0 * pi), fmin(foreseen->burst * foreseen->rise, most));
}

static void print_waves(const gn_foreseen *foreseen) {
    const double fast = 0.2, lag = lag_of(foreseen);
    const double share = foreseen->rise > 0.0 ? lag / foreseen->rise : (double)INFINITY;
    printf("  waves            shift that by some %.2g s (slowest period %.3g s; the load comes "
           "within %.3g s)\n",
           lag, foreseen->period, foreseen->rise);
    if (foreseen->time < INFINITY && share > fast)
        printf("  warning: the load is fast beside waves: they may bring a limit first, at another "
               "time and place than at rest\n");
    if (foreseen->time == INFINITY &&
        (foreseen->most * (1.0 + fmin(1.0, share)) >= 1.0 || foreseen->burst >= 1.0))
        printf("  warning: the load is fast beside waves, which may bring a limit that it does not "
               "come to at rest\n");
}

static void print_when(const gn_world *world, const gn_foreseen *foreseen) {
    if (foreseen->time < INFINITY)
        printf("  first            at %.3g s", foreseen->time);
    else
        printf("  first            none before the end: %.3g of a limit at most", foreseen->most);
    if (world->scene.stage_count)
        printf(", in stage '%s'", world->scene.stages[foreseen->stage].name);
    if (foreseen->time < INFINITY && look_of(world, foreseen) > 0.02 * foreseen->time)
        printf(", seen up to %.2g s later (couple.convert.every)", look_of(world, foreseen));
    printf("%s\n", foreseen->time < INFINITY ? "" : "; below is what one would make of the step");
}

/* Less than so much apart they are one number. */
static const double one_number = 0.95;

static void print_dt(const gn_foreseen *foreseen) {
    printf("  dt               %.6g s then, set by the %s\n", foreseen->first.dt,
           foreseen->first.side);
    printf("                   %.6g", foreseen->least.dt);
    if (foreseen->least.dt < one_number * foreseen->grown.dt)
        printf(" to %.6g", foreseen->grown.dt);
    printf(" s when more has gone, set by the %s\n", foreseen->least.side);
}

/* What comes when the body follows its motions and loads slowly. */
static void print_first(const gn_world *world, const gn_foreseen *foreseen) {
    printf("conversion, as the body would be at rest under its motions and loads\n");
    print_stages(world, foreseen);
    if (!foreseen->place) {
        printf("  first            none: nothing loads it\n");
        return;
    }
    print_when(world, foreseen);
    print_waves(foreseen);
    if (*foreseen->halt) {
        printf("  warning: the first would end the run: %s\n", foreseen->halt);
        return;
    }
    print_dt(foreseen);
    if (world->scene.couple.spins == GN_COUPLE_SLAVED)
        printf(
            "                   roughly: what slaved spins take goes by single elements of fronts; "
            "runs had 0.4 to 2 times that\n");
    if (*foreseen->stop && foreseen->time < INFINITY && foreseen->part * foreseen->reach >= 1.0)
        printf(
            "  warning: at some %.3g times that load conversion would end the run (roughly: where "
            "elements are smaller than particles, 0.4 to 1.6 times as much): %s\n",
            1.0 / foreseen->part, foreseen->stop);
}

/* s: the run ends with a first conversion that comes to the end of the box. */
static double end_of(const gn_foreseen *foreseen) {
    const double end = gn_course_end(&foreseen->course);
    return *foreseen->halt ? fmin(foreseen->time, end) : end;
}

/* Steps of elements alone and, from the time on that was foreseen, with what has converted: with
 * the longest step that is foretold, and with the shortest. */
typedef struct foreseen_steps {
    double alone, least, most;
} foreseen_steps;

/* Of a part of the course that lies between two times. */
static double steps_between(const gn_course_part *part, double from, double to, double dt) {
    const double length = fmin(part->end, to) - fmax(part->begin, from);
    return length > 0.0 ? ceil(length / dt) : 0.0;
}

static void find_steps(const gn_foreseen *foreseen, foreseen_steps *steps) {
    const double end = end_of(foreseen), until = foreseen->place ? fmin(foreseen->time, end) : end;
    const gn_course *c = &foreseen->course;
    *steps = (foreseen_steps){0};
    for (size_t k = 0; k < c->count; k++) {
        const gn_course_part *part = &c->part[k];
        steps->alone += steps_between(part, 0.0, until, part->dt);
        if (!(until < end)) continue;
        /* A stage may have a step of its own. */
        const double dt = part->later > 0.0 ? part->later : part->dt;
        steps->least += steps_between(part, until, end, dt);
        steps->most +=
            steps_between(part, until, end, dt * foreseen->least.dt / foreseen->grown.dt);
    }
}

static void print_steps(const gn_world *world, const gn_foreseen *foreseen,
                        const foreseen_steps *steps) {
    printf("cost\n  steps            %.0f", steps->alone + steps->least);
    if (steps->least < one_number * steps->most) printf(" to %.0f", steps->alone + steps->most);
    printf(" to t = %g s", end_of(foreseen));
    if (steps->most > 0.0) printf(", %.0f of them of elements alone", steps->alone);
    bool open = world->scene.stop_peak_drop > 0.0 || world->scene.stop_strain > 0.0;
    for (size_t k = 0; k < foreseen->course.count; k++)
        open = open || foreseen->course.part[k].open;
    printf("%s\n", open ? " (a stop condition may come first)" : "");
}

static void print_foreseen(const gn_world *world, const gn_foreseen *foreseen,
                           const double per_step[2]) {
    char text[32], most[32];
    foreseen_steps s;
    find_steps(foreseen, &s);
    print_first(world, foreseen);
    print_steps(world, foreseen, &s);
    printf("  per step         %.1f us with %d thread%s", per_step[0] * 1e6, world->threads,
           world->threads > 1 ? "s" : "");
    if (per_step[1] > 0.0)
        printf(" of elements alone, %.1f us once %zu of them are left", per_step[1] * 1e6,
               foreseen->some);
    const double alone = s.alone * per_step[0];
    printf("\n  time             %s",
           gn_format_seconds(alone + s.least * per_step[1], text, sizeof text));
    if (s.least < one_number * s.most)
        printf(" to %s", gn_format_seconds(alone + s.most * per_step[1], most, sizeof most));
    printf("%s\n", s.most > 0.0 ? ", and what more converts costs" : "");
}

/* Elements alone as far as they go, and what converts first; [2]: s, of a step of either. */
static gneiss_status try_converting(gn_world *world, bool print, gn_foreseen *foreseen,
                                    double per_step[2], gneiss_error *error) {
    GN_TRY(gn_conversion_foresee(world, foreseen, error));
    if (print) print_sleepers(world, foreseen);
    GN_TRY(gn_time_steps(world, fmin(world->scene.end, 0.5 * foreseen->time), &per_step[0], error));
    if (!foreseen->place) return GNEISS_OK;
    GN_TRY(gn_conversion_try(world, foreseen, error));
    if (*foreseen->halt) return GNEISS_OK;
    GN_TRY(gn_time_some(world, &per_step[1], error));
    return gn_conversion_try_more(world, foreseen, error);
}

gneiss_status gn_plan_converting(gn_world *world, bool print, double *seconds,
                                 gneiss_error *error) {
    gn_foreseen f = {0};
    foreseen_steps steps;
    double per_step[2] = {0.0};
    gneiss_status status = try_converting(world, print, &f, per_step, error);
    if (status == GNEISS_OK) {
        find_steps(&f, &steps);
        *seconds = steps.alone * per_step[0] + 0.5 * (steps.least + steps.most) * per_step[1];
    }
    if (status == GNEISS_OK && print) print_foreseen(world, &f, per_step);
    gn_foreseen_free(&f);
    return status;
}

/* Steps become shorter with the first conversion, not before. */
static void warn_of_looks(const gn_world *world, int *warnings) {
    const double steps = world->scene.end / world->dt,
                 every = (double)world->scene.couple.convert.every;
    if (every < steps) return;
    printf(
        "  warning: couple.convert.every (%.0f steps) is no less than the %.0f steps of the run: "
        "nothing will be converted\n",
        every, steps);
    (*warnings)++;
}

static void print_places(gn_world *world, int *warnings) {
    gn_conversion_places_seen seen;
    if (gn_conversion_begun(world) || gn_conversion_see_places(world, &seen, NULL) != GNEISS_OK)
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

void gn_print_conversion(gn_world *world, int *warnings) {
    gn_conversion_figures f;
    if (!gn_converts(world) || gn_conversion_measure(world, &f, NULL) != GNEISS_OK) return;
    const double width = world->scene.couple.convert.width;
    printf("conversion\n  width of a zone  %.6g m = %.3g elements (%.3g of the smallest) = %.3g "
           "particles\n",
           width, width / f.element, width / f.smallest, width / f.diameter);
    printf("  in the box       %zu of %zu elements, %zu of %zu particles\n", f.elements,
           gn_conversion_elements(world), f.particles, world->dem.particles.soa.count);
    printf("  held             %zu elements there, of motions and loads\n", f.held);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(world, watched, sizeof watched)) {
        printf("  warning: %s\n", watched);
        (*warnings)++;
    }
    printf("  masses           %.4g times those of the elements\n", f.mass);
    const gn_convert_def *def = &world->scene.couple.convert;
    if (def->relax > 0.0)
        printf("  relaxation       to %g of the mean contact force, %lld iterations at most\n",
               def->relax, (long long)def->relax_iterations);
    for (size_t k = 0; k < f.materials; k++)
        gn_print_zone_material(&f.material[k], f.materials > 1, warnings);
    print_places(world, warnings);
    warn_of_looks(world, warnings);
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
