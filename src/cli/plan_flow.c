#include "cli/plan_flow.h"

#include "base/error.h"
#include "base/timer.h"
#include "cli/plan_stages.h"
#include "cli/progress.h"
#include "particles/flow.h"
#include "scene/flow_def.h"
#include "world/world.h"

#include <math.h>

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
