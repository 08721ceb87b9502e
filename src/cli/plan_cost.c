#include "cli/plan_cost.h"

#include "base/error.h"
#include "base/resident.h"
#include "base/timer.h"
#include "cli/plan_parts.h"
#include "cli/plan_stages.h"
#include "cli/progress.h"
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
    for (bool warm = false; !warm || gn_now() - start < 0.1;) {
        if (!warm && (steps == PACED || (steps >= WARM_UP && gn_now() - start > 1.0))) {
            warm = true;
            start = gn_now();
            steps = 0;
        }
        if (steps > 0 && world->ctx.time >= until) break;
        /* A failure in a later step will be reported by the run. */
        gneiss_status status = gn_world_step(world, false, error);
        if (status == GNEISS_ERROR_UNSTABLE && steps > 0) break;
        GN_TRY(status);
        steps++;
    }
    *seconds = (gn_now() - start) / steps;
    return GNEISS_OK;
}

gneiss_status gn_time_fixed_steps(gn_world *world, double *seconds, gneiss_error *error) {
    const double work = 2e7; /* number of steps times number of elements and particles */
    const double size =
        (double)(world->dem.particles.soa.count + gn_elements_totals(&world->solids).elements);
    const int most = (int)fmin(fmax(work / fmax(size, 1.0), 20.0), 400.0);
    double start = gn_now();
    int steps = -most / 4; /* number of steps, negative while the speed warms up */
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

/* Returns the bytes of the history. The length of its columns is a power of two; the columns grew
 * from others of half that length, whose memory is not reused, and they are copied once more for
 * writing. */
static double bytes_of_history(const gn_world *world) {
    const double rows = gn_run_rows_expected(world);
    gn_history columns;
    double bytes = 0.0, capacity = 256.0;
    while (capacity < rows) capacity *= 2.0;
    if (gn_history_create_columns(world, &columns, NULL) == GNEISS_OK)
        bytes = (double)columns.column_count * (8.0 * (1.5 * capacity + rows) + sizeof(gn_column));
    gn_history_free(&columns);
    return world->ctx.scene.history_rows > 0 ? bytes : 0.0;
}

/* Returns the bytes needed after the failure of a specimen, for events and for contacts between
 * particles whose bond broke. Both were measured per broken bond; tests have broken a tenth to four
 * tenths of their bonds after the peak. */
static double bytes_of_failure(const gn_world *world) {
    static const double broken = 330.0, share = 0.2;
    const gn_test_descriptor *test = gn_scene_test(&world->ctx.scene);
    const bool crushed = test->prism && test->sign < 0 && !test->sides_stand;
    const bool fails = crushed || test->confined || test->disc || test->sheared;
    return fails ? share * broken * (double)world->dem.bonds.contacts.soa.count : 0.0;
}

/* Returns the bytes that a run holds in addition to the world when it writes. The numbers are those
 * of the fields of a snapshot for each particle, contact and element, and those of HDF5, all
 * measured. */
static double bytes_of_writing(const gn_world *world, double coming) {
    static const double particle = 280.0, contact = 240.0, shown = 420.0, element = 290.0,
                        library = 4e6, listed = 5.0;
    const gn_dem *d = &world->dem;
    const double particles = (double)d->particles.soa.count, contacts = (double)gn_lists_count(d);
    double file = saved(&gn_particle_record, &d->particles.soa) +
                  saved(&gn_contact_record, &d->bonds.contacts.soa) +
                  saved(&gn_contact_record, &d->pairs.contacts.soa) +
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
        listed * (contact +
                  2.0 * (double)gn_record_bytes(&gn_contact_record, d->pairs.contacts.soa.effects));
    return file + arrays + library + bytes_of_history(world) + bytes_of_failure(world) +
           coming * come;
}

void gn_print_plan_memory(const gn_world *world, double coming) {
    gn_resident r;
    const double state =
        (double)gn_world_bytes(&world->ctx, &world->dem, &world->boundary, &world->solids);
    gn_h5_load();
#ifdef __GLIBC__
    (void)malloc_trim(0); /* freed memory would otherwise count as used memory */
#endif
    if (!gn_resident_read(&r)) {
        printf("memory\n  in all %.1f MB of state; further memory of a run is unknown here\n",
               state / 1e6);
        return;
    }
    const double writing = r.now + bytes_of_writing(world, coming);
    printf("memory\n  state            %.1f MB, in fields and the rows of their sums\n",
           state / 1e6);
    printf("  in all %.1f MB at the peak of a run: %.1f MB while it is set up, %.1f MB while it "
           "writes\n",
           fmax(r.peak, writing) / 1e6, r.peak / 1e6, writing / 1e6);
}

/* ---- cost of a run with sources, whose particles do not exist yet ---- */

/* s of computing for the trial, and steps between two readings of the clock */
static const double budget = 2.0;
enum { STEPS_BETWEEN_CLOCK_READS = 20 };

/* --- the trial --- */

/* Totals of a part of the trial. */
typedef struct time_span {
    double seconds, steps, particles; /* `particles` is the sum over the steps */
} time_span;

static gneiss_status take_steps(gn_world *world, time_span *span, bool *over, gneiss_error *error) {
    double start = gn_now();
    for (int k = 0; k < STEPS_BETWEEN_CLOCK_READS && !*over; k++) {
        span->particles += (double)gn_dem_present_count(&world->dem);
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
    double sum = (double)gn_dem_present_count(&world->dem);
    for (size_t k = 0; k < world->ctx.scene.source_count; k++)
        sum += number_by(world, k, time) - world->dem.flow.sources[k].number;
    return sum;
}

/* Fits the seconds of a step by a + b N to both halves of the trial. The fit is proportional to N
 * if the second half has hardly more particles or takes no longer. */
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
    flow->present = gn_dem_present_count(&world->dem);
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
