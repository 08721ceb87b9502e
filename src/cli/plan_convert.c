#include "cli/plan_convert.h"

#include "base/timer.h"
#include "cli/plan_cost.h"
#include "cli/plan_parts.h"
#include "cli/plan_stages.h"
#include "cli/progress.h"
#include "particles/dormant.h"
#include "scene/stages.h"
#include "solids/dormant_places.h"
#include "timestep/timestep.h"
#include "zones/zone_state.h"

#include <math.h>
#include <stdio.h>

/* Results of a trial run up to the first conversion, and of conversions at that time and after it.
 */
typedef struct trial {
    gn_step_limit all;        /* limits of the step of all particles, without those of elements */
    double collision;         /* s, step that resolves the collisions of all particles */
    double alone;             /* s, step of elements alone at the start */
    double end;               /* s, the latest end of the run */
    double time;              /* s, at which the trial ended */
    double steps;             /* number of steps of the trial */
    double seconds[2];        /* s per step, with elements alone and after conversions */
    bool begun;               /* elements were converted, or conversion would have ended the run */
    gn_most_loaded most, now; /* the most loaded element during the trial, and at its end */
    const char *stage;        /* stage in which the trial ended; NULL: no stages */
    bool guessed;     /* a stage that ends in equilibrium was assumed to end after a certain time */
    const char *open; /* the first stage whose only end cannot be predicted; NULL: none */
    double first, later; /* s, step after the first conversion, and after further ones */
    const char *side[2]; /* what determines the first step and the shortest later step */
    double least;        /* s, the shortest later step, whichever particles are active */
    size_t elements;     /* elements left after further conversions */
    int fronts;          /* number of fronts after the first conversion */
    double part;         /* fraction of the load at the last front */
    char halt[512];      /* reason why the first conversion ends the run; "": it does not end */
    char stop[512];      /* reason why a further conversion ends the run */
} trial;

/* --- the trial run --- */

/* Finds the limits of the step as if all particles were active. */
static gneiss_status find_all(gn_world *world, trial *t, gneiss_error *error) {
    gn_resolution collision;
    const gn_convertible model = gn_world_convertible(world);
    GN_TRY(gn_conversion_limit(&model, &t->all, error));
    gn_dormant_swap(&world->ctx, &world->dem);
    gneiss_status status = gn_resolution_listed(&world->ctx, &world->dem, &world->boundary,
                                                &world->solids, &world->zones, &collision, error);
    gn_dormant_swap(&world->ctx, &world->dem);
    GN_TRY(status);
    t->collision = collision.step;
    return GNEISS_OK;
}

/* Returns the latest end of a stage that begins at a time, s. */
static double stage_end(const gn_world *world, size_t k, double begin) {
    return fmin(begin + gn_stage_length(&world->ctx.given.stages[k], world->ctx.dt),
                world->ctx.scene.end);
}

static double latest_end(const gn_world *world) {
    double end = world->ctx.time;
    for (size_t k = world->stages.now; k < world->ctx.scene.stage_count; k++)
        end = stage_end(world, k, k == world->stages.now ? world->stages.state[k].time : end);
    return world->ctx.scene.stage_count ? end : world->ctx.scene.end;
}

/* Returns the time that waves take along the longest side of the body at the speed in a bar, s. */
static double wave_travel(const gn_world *world) {
    const gn_fem_solid *b = &world->solids.elements[0]->solid;
    double slowest = INFINITY; /* square of the lowest speed */
    for (size_t e = 0; e < b->elements.soa.count; e++) {
        const double l = b->elements.lambda[e], m = b->elements.mu[e];
        const double young = m * (3.0 * l + 2.0 * m) / (l + m);
        slowest = fmin(slowest, young / b->density[b->elements.material[e]]);
    }
    return gn_elements_longest_side(&world->ctx, &world->solids) / sqrt(slowest);
}

/* Enters the next stage after the end of the present one. The trial does not evaluate equilibrium;
 * a stage that ends in equilibrium is assumed to last twenty times the time that waves take through
 * the body. */
static gneiss_status follow_stages(gn_world *world, trial *t, double settled, gneiss_error *error) {
    while (world->stages.now + 1 < world->ctx.scene.stage_count) {
        const size_t now = world->stages.now;
        const gn_stage *stage = &world->ctx.given.stages[now];
        double end = stage_end(world, now, world->stages.state[now].time);
        const bool waits =
            (stage->unbalanced > 0.0 || stage->held > 0.0) && end >= world->ctx.scene.end;
        if (waits) end = world->stages.state[now].time + settled;
        if (!waits && end >= world->ctx.scene.end && !t->open) t->open = stage->name;
        if (world->ctx.time < end - 0.5 * world->ctx.dt) return GNEISS_OK;
        t->guessed = t->guessed || waits;
        GN_TRY(gn_world_enter(world, now + 1, error));
    }
    return GNEISS_OK;
}

/* Runs up to the first conversion, or as long as the budget of element steps lasts. */
static gneiss_status run_to_first(gn_world *world, trial *t, gneiss_error *error) {
    enum { WARM_UP = 20 };
    /* The fixed cost of a step is about that of two hundred elements. */
    const double budget = 2e8 / (200.0 + (double)gn_elements_left_count(&world->solids));
    const double settled = 20.0 * wave_travel(world);
    double start = gn_now(),
           untimed = 0.0; /* untimed: computing time, s, of steps before the start of the clock */
    while (!t->begun && t->steps < budget &&
           world->ctx.time < latest_end(world) - 0.5 * world->ctx.dt) {
        GN_TRY(follow_stages(world, t, settled, error));
        const gneiss_status status = gn_world_step(world, false, error);
        if (++t->steps == WARM_UP) {
            start = gn_now();
            untimed = WARM_UP;
        }
        if (status != GNEISS_OK && status != GNEISS_ERROR_UNSTABLE) return status;
        snprintf(t->halt, sizeof t->halt, "%.400s",
                 status == GNEISS_OK ? world->outcome.halt : error->message);
        t->begun = *t->halt || gn_elements_have_left(&world->solids);
    }
    t->seconds[0] = (gn_now() - start) / fmax(t->steps - untimed, 1.0);
    t->time = world->ctx.time;
    if (world->ctx.scene.stage_count) t->stage = world->ctx.scene.stages[world->stages.now].name;
    GN_TRY(gn_conversion_most_loaded(&world->ctx, &world->solids, &(gn_most_loaded){0}, &t->now,
                                     error));
    return gn_conversion_most_loaded(&world->ctx, &world->solids, &world->most_loaded, &t->most,
                                     error);
}

/* True if the load of the body is above rounding. */
static bool is_loaded(const trial *t) {
    return t->begun || t->most.share > 1e-6;
}

/* --- the step after conversions --- */

static bool is_near(double a, double b) {
    return a < INFINITY && b < INFINITY && fabs(a - b) <= 1e-3 * b;
}

static const char by_collisions[] = "collisions";

/* Returns the part, elements or particles, that determines the present step. */
static const char *side_of(const gn_world *world) {
    const gn_step_choice *choice = &world->ctx.choice;
    const double share = gn_nonviscous_share(&world->ctx),
                 elements = gn_elements_stable(&world->solids);
    const int32_t p = choice->limit.sharp_id;
    if (is_near(world->ctx.dt, choice->resolution.step)) return by_collisions;
    if (is_near(world->ctx.dt, 0.98 * choice->listed)) return "contacts that may close";
    if (world->ctx.stable < 0.9 * share * fmin(elements, choice->stable))
        return "slaved spins of the zone";
    if (elements <= choice->stable) return "elements that are left, by their rigorous bound";
    return p >= 0 && gn_coupled_has(world->zones.coupled, p) ? "particles of the zone"
                                                             : "particles";
}

/* Converts the elements whose load is at least a fraction of the limit; `halt` states why this
 * would end the run, for example because a given step is too long for the particles. */
static gneiss_status try_front(gn_world *world, double part, char *halt, size_t size,
                               gneiss_error *error) {
    *world->outcome.halt = '\0';
    const gn_convertible model = gn_world_convertible(world);
    const gneiss_status status = gn_conversion_convert_above(&model, part, error);
    snprintf(halt, size, "%.400s",
             status == GNEISS_ERROR_UNSTABLE ? error->message : world->outcome.halt);
    return status == GNEISS_ERROR_UNSTABLE ? GNEISS_OK : status;
}

/* Converts, as if the load grew, the elements of ever lower load, front by front, down to a
 * fraction of the limit. */
static gneiss_status try_fronts(gn_world *world, trial *t, double load, double least,
                                gneiss_error *error) {
    enum { FRONTS = 30 };
    const double next = 0.94;
    for (; t->fronts < FRONTS && t->part * next >= least && !*t->stop; t->fronts++) {
        t->part *= next;
        GN_TRY(try_front(world, t->part * load, t->stop, sizeof t->stop, error));
        if (*t->stop || world->ctx.dt >= t->later) continue;
        t->later = world->ctx.dt;
        t->side[1] = side_of(world);
    }
    return GNEISS_OK;
}

/* Two steps with a larger ratio are printed as one. */
static const double equal_ratio = 0.95;

/* Finds the shortest step. Any particle may become active as a crack grows, including the one with
 * the shortest period. */
static void find_least(const gn_world *world, trial *t) {
    const double all = gn_nonviscous_share(&world->ctx) * world->ctx.scene.safety * t->all.sharp;
    t->least = t->later;
    if (world->ctx.scene.step > 0.0 || fmin(all, t->collision) >= t->least) return;
    t->least = fmin(all, t->collision);
    t->side[1] = all <= t->collision ? "particles" : by_collisions;
    if (t->least >= equal_ratio * t->later) t->later = t->least;
}

static gneiss_status try_converting(gn_world *world, trial *t, gneiss_error *error) {
    GN_TRY(run_to_first(world, t, error));
    t->end = latest_end(world);
    if (!is_loaded(t) || *t->halt) return GNEISS_OK;
    const double load = t->begun ? 1.0 : t->now.share;
    if (!t->begun) GN_TRY(try_front(world, load, t->halt, sizeof t->halt, error));
    if (*t->halt) return GNEISS_OK;
    t->part = 1.0;
    t->later = t->first = world->ctx.dt;
    t->side[0] = t->side[1] = side_of(world);
    GN_TRY(try_fronts(world, t, load, 0.7, error));
    t->elements = gn_elements_left_count(&world->solids);
    GN_TRY(gn_time_fixed_steps(world, &t->seconds[1], error));
    GN_TRY(try_fronts(world, t, load, t->begun ? t->time / t->end : 1.0, error));
    find_least(world, t);
    return GNEISS_OK;
}

/* --- number of steps --- */

/* Fewest and most steps, and the seconds that they take. */
typedef struct cost {
    double steps[2], seconds[2];
} cost;

/* Returns the cost of a run. If nothing was converted in the trial, the fewest steps are those of
 * elements alone. */
static cost cost_of(const trial *t) {
    const double left = *t->halt ? 0.0 : fmax(t->end - t->time, 0.0);
    const double dt[2] = {t->begun ? t->later : t->alone, t->least > 0.0 ? t->least : t->alone};
    cost c;
    for (int k = 0; k < 2; k++) {
        /* A remaining time of less than half a step is due to rounding. */
        const double more = left > 0.5 * dt[k] ? ceil(left / dt[k] - 1e-9) : 0.0;
        const bool with_particles = t->least > 0.0 && (k || t->begun);
        c.steps[k] = t->steps + more;
        c.seconds[k] = t->steps * t->seconds[0] + more * t->seconds[with_particles];
    }
    return c;
}

/* --- output --- */

static void print_dormant(const gn_world *world, const trial *t) {
    printf("dormant particles\n  dormant          %zu, with %zu stored bonds; the step above is "
           "that of the elements alone\n",
           gn_dormant_count(&world->dem), world->dem.prepared.soa.count);
    if (t->all.sharp < INFINITY)
        printf("  sharp limit      %.6g s of all of them without elements, rigorous bound %.6g s\n",
               t->all.sharp, t->all.bound);
    char watched[GNEISS_MESSAGE_SIZE];
    if (*gn_conversion_watches(&world->ctx, &world->solids, watched, sizeof watched))
        printf("  warning: %s\n", watched);
}

static void print_first(const trial *t) {
    if (t->begun)
        printf("  first            at %.3g s", t->time);
    else if (!is_loaded(t))
        printf("  first            none in %.0f steps, to %.3g s: nothing loads the elements",
               t->steps, t->time);
    else
        printf("  first            none in %.0f steps, to %.3g s: %.3g of a limit at most",
               t->steps, t->time, t->most.share);
    if (t->stage) printf(", in stage '%s'", t->stage);
    printf("%s\n", t->begun || !is_loaded(t)
                       ? ""
                       : "; the step below is that after a conversion of the most loaded elements");
    if (t->open)
        printf(
            "  stages           '%s' was assumed to last to the end of the run: strain and stress "
            "of the test end it otherwise\n",
            t->open);
    if (t->guessed)
        printf("  stages           one that waits for equilibrium was assumed to last twenty "
               "transit times of waves\n");
}

static void print_dt(const gn_world *world, const trial *t) {
    printf("  dt               %.6g s then, set by the %s\n", t->first, t->side[0]);
    printf("                   %.6g", t->least);
    if (t->least < equal_ratio * t->later) printf(" to %.6g", t->later);
    printf(" s after further conversions, set by the %s\n", t->side[1]);
    if (world->ctx.scene.couple.spins == GN_COUPLE_SLAVED)
        printf("                   roughly: the effect of slaved spins depends on single elements "
               "of fronts\n");
    if (*t->stop)
        printf("  warning: at about %.3g times that load conversion would end the run (roughly, "
               "where elements are smaller than particles): %s\n",
               1.0 / t->part, t->stop);
}

static bool has_open_end(const gn_scene *scene) {
    bool open = gn_scene_may_end_early(scene, 0);
    for (size_t k = 1; k < scene->stage_count; k++) open |= gn_scene_may_end_early(scene, k);
    return open;
}

static void print_cost(const gn_world *world, const trial *t) {
    const cost c = cost_of(t);
    char text[32];
    printf("cost\n  steps            %.0f", c.steps[0]);
    if (c.steps[0] < equal_ratio * c.steps[1]) printf(" to %.0f", c.steps[1]);
    printf(" to t = %g s", *t->halt ? t->time : t->end);
    if (t->begun) printf(", %.0f of them with elements alone", t->steps);
    printf("%s\n", has_open_end(&world->ctx.scene) ? " (a stop condition may come first)" : "");
    printf("  per step         %.1f us with %d thread%s", t->seconds[0] * 1e6, world->ctx.threads,
           world->ctx.threads > 1 ? "s" : "");
    const bool converts = t->seconds[1] > 0.0 && (t->begun || c.steps[1] > t->steps);
    if (converts)
        printf(" with elements alone, %.1f us once %zu of them are left", t->seconds[1] * 1e6,
               t->elements);
    printf("\n  time             %s", gn_format_seconds(c.seconds[0], text, sizeof text));
    if (c.steps[0] < equal_ratio * c.steps[1])
        printf(" to %s", gn_format_seconds(c.seconds[1], text, sizeof text));
    printf("%s\n", converts ? ", plus the cost of further conversions" : "");
}

gneiss_status gn_plan_converting(gn_world *world, bool print, double *seconds,
                                 gneiss_error *error) {
    trial t = {.alone = world->ctx.dt};
    GN_TRY(find_all(world, &t, error));
    if (print) print_dormant(world, &t);
    GN_TRY(try_converting(world, &t, error));
    const cost c = cost_of(&t);
    *seconds = 0.5 * (c.seconds[0] + c.seconds[1]);
    if (!print) return GNEISS_OK;
    printf("conversion, by a trial run\n");
    print_first(&t);
    if (*t.halt)
        printf("  warning: the first would end the run: %s\n", t.halt);
    else if (t.least > 0.0)
        print_dt(world, &t);
    print_cost(world, &t);
    world->ctx.dt = t.alone; /* the list of stages uses the step of the first stage */
    gn_print_stages(world, t.seconds[0]);
    return GNEISS_OK;
}

/* Warns if the time between two checks for conversion is longer than the run with the step of
 * elements alone; steps become shorter only with the first conversion. */
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
    gn_conversion_places_checked seen;
    const gn_convertible model = gn_world_convertible(world);
    if (gn_elements_have_left(&world->solids) ||
        gn_conversion_check_places(&model, &seen, NULL) != GNEISS_OK)
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
           gn_elements_left_count(&world->solids), f.particles, world->dem.particles.soa.count);
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
