#include "cli/plan_convert.h"

#include "cli/plan_couple.h"
#include "cli/plan_time.h"
#include "cli/progress.h"

#include <math.h>
#include <stdio.h>

static void print_dormant(const gn_world *world, const gn_foreseen *foreseen) {
    printf("dormant particles\n  dormant          %zu, with %zu stored bonds; the step above is "
           "that of the elements alone\n",
           gn_conversion_asleep(&world->dem), world->dem.prepared.soa.count);
    if (foreseen->all.sharp < INFINITY)
        printf("  sharp limit      %.6g s of all of them without elements, rigorous bound %.6g s\n",
               foreseen->all.sharp, foreseen->all.bound);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(&world->ctx, &world->solids, watched, sizeof watched))
        printf("  warning: %s\n", watched);
}

/* Prints the stages. An end that may come at another time shifts all later stages. */
static void print_stages(const gn_world *world, const gn_foreseen *foreseen) {
    const gn_course *c = &foreseen->course;
    for (size_t k = 0; world->ctx.scene.stage_count && k < c->count; k++) {
        const gn_course_part *part = &c->part[k];
        const bool last = k + 1 == world->ctx.scene.stage_count;
        printf(
            "  stage %-10s from %.4g s to %.4g s%s\n", world->ctx.scene.stages[k].name, part->begin,
            part->end,
            part->guessed
                ? ", a guess: it waits for equilibrium, assumed after twenty transit times of waves"
            : part->open && !last
                ? " at the latest: it may end earlier, by a condition that is not predicted"
            : part->open ? " at the latest"
                         : "");
    }
    if (c->count < world->ctx.scene.stage_count)
        printf("  stage %-10s not reached before time.end\n",
               world->ctx.scene.stages[c->count].name);
}

/* Returns the interval between evaluations of the limits, s: the delay after which a reached limit
 * is seen. */
static double detection_delay(const gn_world *world, const gn_foreseen *foreseen) {
    return (double)world->ctx.scene.couple.convert.every *
           foreseen->course.part[foreseen->stage].dt;
}

/* Returns the uncertainty of the time of a limit by waves, s. A body lags behind a steadily growing
 * load, and oscillates about it, by 1/omega of its slowest mode; under a sudden load the stress
 * rises in steps, as waves pass, of the size of the first. */
static double wave_uncertainty(const gn_foreseen *foreseen) {
    const double pi = 3.14159265358979323846, most = 0.5 * foreseen->period;
    if (foreseen->rise < foreseen->period) return most;
    return fmax(foreseen->period / (2.0 * pi), fmin(foreseen->burst * foreseen->rise, most));
}

static void print_waves(const gn_foreseen *foreseen) {
    const double fast = 0.2, lag = wave_uncertainty(foreseen);
    const double share = foreseen->rise > 0.0 ? lag / foreseen->rise : (double)INFINITY;
    printf("  waves            shift that by about %.2g s (slowest period %.3g s; the load rises "
           "within %.3g s)\n",
           lag, foreseen->period, foreseen->rise);
    if (foreseen->time < INFINITY && share > fast)
        printf("  warning: the load is fast relative to waves: they may reach a limit earlier, at "
               "another time and place than in equilibrium\n");
    if (foreseen->time == INFINITY &&
        (foreseen->most * (1.0 + fmin(1.0, share)) >= 1.0 || foreseen->burst >= 1.0))
        printf("  warning: the load is fast relative to waves, which may reach a limit that is not "
               "reached in equilibrium\n");
}

static void print_when(const gn_world *world, const gn_foreseen *foreseen) {
    if (foreseen->time < INFINITY)
        printf("  first            at %.3g s", foreseen->time);
    else
        printf("  first            none before the end: %.3g of a limit at most", foreseen->most);
    if (world->ctx.scene.stage_count)
        printf(", in stage '%s'", world->ctx.scene.stages[foreseen->stage].name);
    if (foreseen->time < INFINITY && detection_delay(world, foreseen) > 0.02 * foreseen->time)
        printf(", detected up to %.2g s later (couple.convert.every)",
               detection_delay(world, foreseen));
    printf("%s\n", foreseen->time < INFINITY ? "" : "; the step after one is below");
}

/* Two values with a larger ratio are printed as one. */
static const double equal_ratio = 0.95;

static void print_dt(const gn_foreseen *foreseen) {
    printf("  dt               %.6g s then, set by the %s\n", foreseen->first.dt,
           foreseen->first.side);
    printf("                   %.6g", foreseen->least.dt);
    if (foreseen->least.dt < equal_ratio * foreseen->grown.dt)
        printf(" to %.6g", foreseen->grown.dt);
    printf(" s after further conversions, set by the %s\n", foreseen->least.side);
}

/* Prints the prediction for a body that follows its motions and loads quasi-statically. */
static void print_first(const gn_world *world, const gn_foreseen *foreseen) {
    printf("conversion, with the body in equilibrium under its motions and loads\n");
    print_stages(world, foreseen);
    if (!foreseen->place) {
        printf("  first            none: there is no load\n");
        return;
    }
    print_when(world, foreseen);
    print_waves(foreseen);
    if (*foreseen->halt) {
        printf("  warning: the first would end the run: %s\n", foreseen->halt);
        return;
    }
    print_dt(foreseen);
    if (world->ctx.scene.couple.spins == GN_COUPLE_SLAVED)
        printf("                   roughly: the effect of slaved spins depends on single elements "
               "of fronts; runs had 0.4 to 2 times that\n");
    if (*foreseen->stop && foreseen->time < INFINITY && foreseen->part * foreseen->reach >= 1.0)
        printf("  warning: at about %.3g times that load conversion would end the run (roughly: "
               "where elements are smaller than particles, 0.4 to 1.6 times as much): %s\n",
               1.0 / foreseen->part, foreseen->stop);
}

/* Returns the end of the prediction, s: a first conversion that reaches the end of the box ends the
 * run. */
static double prediction_end(const gn_foreseen *foreseen) {
    const double end = gn_course_end(&foreseen->course);
    return *foreseen->halt ? fmin(foreseen->time, end) : end;
}

/* Steps of elements alone and, from the predicted time on, of elements and converted particles:
 * with the longest predicted step, and with the shortest. */
typedef struct foreseen_steps {
    double alone, least, most;
} foreseen_steps;

/* Counts the steps in a part of the course between two times. */
static double steps_between(const gn_course_part *part, double from, double to, double dt) {
    const double length = fmin(part->end, to) - fmax(part->begin, from);
    return length > 0.0 ? ceil(length / dt) : 0.0;
}

static void find_steps(const gn_foreseen *foreseen, foreseen_steps *steps) {
    const double end = prediction_end(foreseen),
                 until = foreseen->place ? fmin(foreseen->time, end) : end;
    const gn_course *c = &foreseen->course;
    *steps = (foreseen_steps){0};
    for (size_t k = 0; k < c->count; k++) {
        const gn_course_part *part = &c->part[k];
        steps->alone += steps_between(part, 0.0, until, part->dt);
        if (!(until < end)) continue;
        /* A stage may have its own step. */
        const double dt = part->later > 0.0 ? part->later : part->dt;
        steps->least += steps_between(part, until, end, dt);
        steps->most +=
            steps_between(part, until, end, dt * foreseen->least.dt / foreseen->grown.dt);
    }
}

static void print_steps(const gn_world *world, const gn_foreseen *foreseen,
                        const foreseen_steps *steps) {
    printf("cost\n  steps            %.0f", steps->alone + steps->least);
    if (steps->least < equal_ratio * steps->most) printf(" to %.0f", steps->alone + steps->most);
    printf(" to t = %g s", prediction_end(foreseen));
    if (steps->most > 0.0) printf(", %.0f of them with elements alone", steps->alone);
    bool open = world->ctx.scene.stop_peak_drop > 0.0 || world->ctx.scene.stop_strain > 0.0;
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
    printf("  per step         %.1f us with %d thread%s", per_step[0] * 1e6, world->ctx.threads,
           world->ctx.threads > 1 ? "s" : "");
    if (per_step[1] > 0.0)
        printf(" with elements alone, %.1f us once %zu of them are left", per_step[1] * 1e6,
               foreseen->some);
    const double alone = s.alone * per_step[0];
    printf("\n  time             %s",
           gn_format_seconds(alone + s.least * per_step[1], text, sizeof text));
    if (s.least < equal_ratio * s.most)
        printf(" to %s", gn_format_seconds(alone + s.most * per_step[1], most, sizeof most));
    printf("%s\n", s.most > 0.0 ? ", plus the cost of further conversions" : "");
}

/* Tries steps of elements alone as far as they last, and steps after the first conversion;
 * seconds[2]: s, of a step of each. */
static gneiss_status try_converting(gn_world *world, bool print, gn_foreseen *foreseen,
                                    double per_step[2], gneiss_error *error) {
    GN_TRY(gn_conversion_foresee(world, foreseen, error));
    if (print) print_dormant(world, foreseen);
    GN_TRY(gn_time_steps(world, fmin(world->ctx.scene.end, 0.5 * foreseen->time), &per_step[0],
                         error));
    if (!foreseen->place) return GNEISS_OK;
    GN_TRY(gn_conversion_try(world, foreseen, error));
    if (*foreseen->halt) return GNEISS_OK;
    GN_TRY(gn_time_fixed_steps(world, &per_step[1], error));
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
    const double steps = world->ctx.scene.end / world->ctx.dt,
                 every = (double)world->ctx.scene.couple.convert.every;
    if (every < steps) return;
    printf("  warning: couple.convert.every (%.0f steps) is at least the %.0f steps of the run: "
           "nothing will be converted\n",
           every, steps);
    (*warnings)++;
}

static void print_places(gn_world *world, int *warnings) {
    gn_conversion_places_seen seen;
    if (gn_conversion_begun(&world->solids) ||
        gn_conversion_see_places(world, &seen, NULL) != GNEISS_OK)
        return;
    printf("  places           %zu checked", seen.looked);
    if (seen.along)
        printf(
            ": at %zu neighbouring elements convert as well, as there are too few particles in one",
            seen.along);
    printf("\n");
    if (!seen.too_few) return;
    printf("  warning: at %zu of %zu checked places there are too few particles to take over the "
           "mass of converting elements: conversion there ends the run (use a wider zone, or "
           "larger elements)\n",
           seen.too_few, seen.looked);
    (*warnings)++;
}

void gn_print_conversion(gn_world *world, int *warnings) {
    gn_conversion_figures f;
    if (!gn_converts(&world->ctx) ||
        gn_conversion_measure(&world->ctx, &world->dem, &world->boundary, &world->solids, &f,
                              NULL) != GNEISS_OK)
        return;
    const double width = world->ctx.scene.couple.convert.width;
    printf("conversion\n  width of a zone  %.6g m = %.3g elements (%.3g of the smallest) = %.3g "
           "particles\n",
           width, width / f.element, width / f.smallest, width / f.diameter);
    printf("  in the box       %zu of %zu elements, %zu of %zu particles\n", f.elements,
           gn_conversion_elements(&world->solids), f.particles, world->dem.particles.soa.count);
    printf("  excluded         %zu elements there, with motions and loads\n", f.held);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(&world->ctx, &world->solids, watched, sizeof watched)) {
        printf("  warning: %s\n", watched);
        (*warnings)++;
    }
    printf("  masses           %.4g times those of the elements\n", f.mass);
    const gn_convert_def *def = &world->ctx.scene.couple.convert;
    if (def->relax > 0.0)
        printf("  relaxation       to %g of the mean contact force, %lld iterations at most\n",
               def->relax, (long long)def->relax_iterations);
    for (size_t k = 0; k < f.materials; k++)
        gn_print_zone_material(&f.material[k], f.materials > 1, warnings);
    print_places(world, warnings);
    warn_of_looks(world, warnings);
    const double advised = gn_zone_advised_width(f.element, f.diameter);
    const bool thin = gn_zone_is_thin(width, advised);
    if (thin)
        printf(
            "  warning: the zone is thin%s: three elements and six particles across are advised\n",
            width >= gn_zone_advised_width(f.smallest, f.diameter)
                ? " for elements of the mean size in the box, not for the smallest; the size at "
                  "the place of conversion counts"
                : "");
    if (width > f.side)
        printf("  warning: the zone is wider than the shortest side of the body, %.4g m: it spans "
               "the whole section and leaves no pure elements; %.2g m are advised\n",
               f.side, advised);
    *warnings += thin + (width > f.side);
}
