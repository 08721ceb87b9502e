#include "cli/plan_cost.h"

#include "base/error.h"
#include "base/resident.h"
#include "base/timer.h"
#include "cli/plan_parts.h"
#include "cli/plan_stages.h"
#include "cli/progress.h"
#include "conversion/conversion.h"
#include "frame/parts.h"
#include "io/h5.h"
#include "particles/flow.h"
#include "run/history_rows.h"
#include "run/spacing.h"
#include "scene/flow_def.h"
#include "world/world.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>

gneiss_status gn_time_steps(gn_world *world, double until, double *seconds, gneiss_error *error) {
    enum { WARM_UP = 20, PACED = 192 };
    double start = gn_now();
    int steps = 0;
    for (bool warm = false; !warm || gn_now() - start < 0.25;) {
        if (!warm && (steps == PACED || (steps >= WARM_UP && gn_now() - start > 1.0))) {
            warm = true;
            start = gn_now();
            steps = 0;
        }
        if (steps > 0 && world->ctx.time >= until) break;
        /* Failure in a later step is left to the run. */
        gneiss_status status = gn_world_step(world, false, error);
        if (status == GNEISS_ERROR_UNSTABLE && steps > 0) break;
        GN_TRY(status);
        steps++;
    }
    *seconds = (gn_now() - start) / steps;
    return GNEISS_OK;
}

/* Measures a number of steps that depends on the model alone, so that the world is in the same
 * state each time afterwards. */
static gneiss_status time_fixed_steps(gn_world *world, double *seconds, gneiss_error *error) {
    const double work = 2e7; /* element and particle steps */
    const double size =
        (double)(world->dem.particles.soa.count + gn_elements_totals(&world->solids).elements);
    const int most = (int)fmin(fmax(work / fmax(size, 1.0), 20.0), 400.0);
    double start = gn_now();
    int steps = -most / 4; /* warm-up */
    for (; steps < most; steps++) {
        if (steps == 0) start = gn_now();
        gneiss_status status = gn_world_step(world, false, error);
        if (status == GNEISS_ERROR_UNSTABLE) break;
        GN_TRY(status);
    }
    *seconds = steps > 0 ? (gn_now() - start) / steps : 0.0;
    return GNEISS_OK;
}

/* ---- `plan` makes the world as a run makes it: packing, lists, limit and strain gauge take the
 * same memory. The peak is therefore read from the system and includes the memory of libraries.
 * Added to it is the memory that a run holds beside the world when it writes: each file, and the
 * arrays of one kind of item, are formed in memory ---- */

static double saved(const gn_record *record, const gn_soa *soa) {
    return (double)soa->count * (double)gn_record_bytes(record, soa->effects);
}

/* Bytes of the history: its columns, grown to a power of two of rows from columns of half that
 * length, whose place is lost, and once more where it stands in a file. */
static double bytes_of_history(const gn_world *world, double growth) {
    const double rows = growth * gn_run_rows_expected(world);
    gn_history columns;
    double bytes = 0.0, capacity = 256.0;
    while (capacity < rows) capacity *= 2.0;
    if (gn_history_begin(world, &columns, NULL) == GNEISS_OK)
        bytes = (double)columns.column_count * (8.0 * (1.5 * capacity + rows) + sizeof(gn_column));
    gn_history_free(&columns);
    return world->ctx.scene.history_rows > 0 ? bytes : 0.0;
}

/* Bytes of what follows the failure of a specimen: events, and contacts between what had bonds.
 * Measured per broken bond; a share of the bonds that tests have broken behind their peak (a tenth
 * to four tenths). */
static double bytes_of_failure(const gn_world *world) {
    static const double broken = 330.0, share = 0.2;
    const gn_test_descriptor *test = gn_scene_test(&world->ctx.scene);
    const bool crushed = test->prism && test->sign < 0 && !test->sides_stand;
    const bool fails = crushed || test->confined || test->disc || test->sheared;
    return fails ? share * broken * (double)world->dem.bonds.soa.count : 0.0;
}

/* Returns the bytes that a run holds beside the world when it writes. The numbers are those of the
 * fields of a snapshot, for each particle, contact and element, and of HDF5 itself, all measured.
 */
static double bytes_of_writing(const gn_world *world, const gn_plan_growth *growth) {
    static const double particle = 280.0, contact = 240.0, shown = 420.0, element = 290.0,
                        library = 4e6, listed = 3.0;
    const gn_dem *d = &world->dem;
    const double particles = (double)d->particles.soa.count,
                 contacts = (double)(d->bonds.soa.count + d->pairs.soa.count);
    double file = saved(&gn_particle_record, &d->particles.soa) +
                  saved(&gn_contact_record, &d->bonds.soa) +
                  saved(&gn_contact_record, &d->pairs.soa) +
                  saved(&gn_wall_contact_record, &world->boundary.contacts.soa);
    double arrays = fmax(particle * particles, contact * contacts);
    if (world->ctx.scene.contact_rows == GN_SWITCH_ON)
        arrays = fmax(arrays, 0.5 * particle * particles + shown * contacts);
    for (size_t k = 0; k < world->solids.count; k++) {
        const gn_fem_solid *solid = &world->solids.elements[k]->solid;
        file += saved(&gn_particle_record, &solid->nodes.soa) +
                saved(&gn_element_record, &solid->elements.soa);
        arrays = fmax(arrays, element * (double)solid->elements.soa.count);
    }
    const double come =
        particle + 2.0 * (double)gn_record_bytes(&gn_particle_record, world->ctx.effects) +
        listed *
            (contact + 2.0 * (double)gn_record_bytes(&gn_contact_record, d->pairs.soa.effects));
    return file + arrays + library + bytes_of_history(world, growth->rows) +
           bytes_of_failure(world) + growth->particles * come;
}

void gn_print_plan_memory(const gn_world *world, const gn_plan_growth *growth) {
    gn_resident r;
    const double state =
        (double)gn_world_bytes(&world->ctx, &world->dem, &world->boundary, &world->solids);
    gn_h5_load();
#ifdef __GLIBC__
    (void)malloc_trim(0); /* freed memory would otherwise count as used */
#endif
    if (!gn_resident_read(&r)) {
        printf("memory\n  in all %.1f MB of state; further memory of a run is unknown here\n",
               state / 1e6);
        return;
    }
    const double writing = r.now + bytes_of_writing(world, growth);
    printf("memory\n  state            %.1f MB, in fields and the rows of their sums\n",
           state / 1e6);
    printf("  in all %.1f MB at the peak of a run: %.1f MB while it is set up, %.1f MB while it "
           "writes\n",
           fmax(r.peak, writing) / 1e6, r.peak / 1e6, writing / 1e6);
}

/* ---- cost of a run with sources, whose particles do not exist yet ---- */

/* s of computing; steps between two readings of the clock. */
static const double budget = 2.0;
enum { STEPS_BETWEEN_CLOCK_READS = 20 };

/* --- the trial --- */

/* Totals of a part of the trial. */
typedef struct time_span {
    double seconds, steps, particles; /* the last one is a sum over steps */
} time_span;

static gneiss_status take_steps(gn_world *world, time_span *span, bool *over, gneiss_error *error) {
    double start = gn_now();
    for (int k = 0; k < STEPS_BETWEEN_CLOCK_READS && !*over; k++) {
        span->particles += (double)gn_world_present(&world->dem);
        gneiss_status status = gn_world_step(world, false, error);
        *over = status == GNEISS_ERROR_UNSTABLE || world->ctx.time >= world->ctx.scene.end;
        if (status != GNEISS_ERROR_UNSTABLE) GN_TRY(status);
        span->steps++;
    }
    span->seconds += gn_now() - start;
    return GNEISS_OK;
}

static bool has_wall_contact(const gn_world *world) {
    for (size_t c = 0; world->ctx.effects & GN_FX_WALLS && c < world->boundary.contacts.soa.count;
         c++)
        if (world->boundary.contacts.row[8 * c] != 0.0 ||
            world->boundary.contacts.row[8 * c + 1] != 0.0 ||
            world->boundary.contacts.row[8 * c + 2] != 0.0)
            return true;
    return false;
}

/* --- extrapolation --- */

/* Returns the number of particles of a source by a time, from its rate and the number so far. */
static double number_by(const gn_world *world, size_t k, double time) {
    const gn_source_def *source = &world->ctx.scene.sources[k];
    const gn_source_state *s = &world->dem.flow.sources[k];
    double mean = s->number > 0.0 ? s->mass / s->number : INFINITY;
    double rate = source->mass_rate > 0.0 ? source->mass_rate / mean : source->rate;
    double until = source->end > 0.0 ? fmin(time, source->end) : time;
    double number = rate * fmax(0.0, until - source->start);
    if (source->total > 0) number = fmin(number, (double)source->total);
    return fmax(number, s->number);
}

static double present_by(const gn_world *world, double time) {
    double sum = (double)gn_world_present(&world->dem);
    for (size_t k = 0; k < world->ctx.scene.source_count; k++)
        sum += number_by(world, k, time) - world->dem.flow.sources[k].number;
    return sum;
}

/* Fits the seconds of a step by a + b N through both halves of the trial; if the second has hardly
 * more particles, or shows no growth, in proportion to N. */
static void fit_cost(const time_span half[2], double *a, double *b) {
    double n[2], t[2];
    for (int k = 0; k < 2; k++) {
        n[k] = half[k].steps > 0.0 ? half[k].particles / half[k].steps : 0.0;
        t[k] = half[k].steps > 0.0 ? half[k].seconds / half[k].steps : 0.0;
    }
    int last = half[1].steps > 0.0 ? 1 : 0;
    *b = n[1] > 1.2 * n[0] ? (t[1] - t[0]) / (n[1] - n[0]) : 0.0;
    *a = t[0] - *b * n[0];
    if (*b > 0.0 && *a >= 0.0) return;
    *a = 0.0;
    *b = n[last] > 0.0 ? t[last] / n[last] : 0.0;
}

gneiss_status gn_plan_flow_try(gn_world *world, gn_plan_flow *flow, gneiss_error *error) {
    enum { PIECES = 400 };
    time_span half[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    bool over = false;
    double a, b;
    *flow = (gn_plan_flow){0};
    double start = gn_now();
    for (double gone = 0.0; gone < budget && !over; gone = gn_now() - start) {
        GN_TRY(take_steps(world, &half[gone > 0.5 * budget], &over, error));
        flow->touched = flow->touched || has_wall_contact(world);
    }
    fit_cost(half, &a, &b);
    flow->tried = world->ctx.time;
    flow->step = world->ctx.dt;
    flow->present = gn_world_present(&world->dem);
    flow->seconds = half[0].seconds + half[1].seconds;
    double left = fmax(0.0, world->ctx.scene.end - world->ctx.time), part = left / PIECES;
    for (int k = 0; k < PIECES; k++)
        flow->seconds +=
            part / world->ctx.dt * (a + b * present_by(world, world->ctx.time + (k + 0.5) * part));
    flow->most = present_by(world, world->ctx.scene.end);
    flow->steps = (double)world->ctx.step + ceil(left / world->ctx.dt);
    return GNEISS_OK;
}

void gn_print_plan_flow(const gn_world *world, const gn_plan_flow *flow) {
    char text[32];
    printf("cost, with the particles from sources\n");
    printf("  trial            to t = %.4g s: %lld steps, the last of %.4g s, %zu particles%s\n",
           flow->tried, (long long)world->ctx.step, flow->step, flow->present,
           flow->touched ? "" : ", of which none has touched a wall or body yet");
    printf("  steps            %.0f to t = %g s, at the present step%s%s\n", flow->steps,
           world->ctx.scene.end,
           flow->touched ? "; faster or deeper contacts shorten it"
                         : ", which contacts of particles will shorten",
           world->ctx.scene.stage_count ? " (a stop condition may come first)" : "");
    printf("  time             %s with %d thread%s, for %.4g particles at the end if none leave; "
           "densely packed ones cost more each\n",
           gn_format_seconds(flow->seconds, text, sizeof text), world->ctx.threads,
           world->ctx.threads > 1 ? "s" : "", flow->most);
    gn_print_stages(world, flow->steps > 0.0 ? flow->seconds / flow->steps : 0.0);
}

/* ---- output of `plan` and `check` on elements that turn into particles ---- */

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
    GN_TRY(time_fixed_steps(world, &per_step[1], error));
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
