#include "cli/plan_flow.h"

#include "base/timer.h"
#include "cli/plan_stages.h"
#include "cli/progress.h"
#include "world/internal.h"

#include <math.h>

/* s of computing; steps between two looks at the clock. */
static const double budget = 2.0;
enum { LOOK = 20 };

/* --- the trial --- */

/* Of a part of the trial. */
typedef struct span {
    double seconds, steps, particles; /* the last: summed over steps */
} span;

static gneiss_status take(gn_world *w, span *s, bool *over, gneiss_error *error) {
    double start = gn_now();
    for (int k = 0; k < LOOK && !*over; k++) {
        s->particles += (double)gn_world_present(&w->dem);
        gneiss_status status = gn_world_step(w, false, error);
        *over = status == GNEISS_ERROR_UNSTABLE || w->ctx.time >= w->ctx.scene.end;
        if (status != GNEISS_ERROR_UNSTABLE) GN_TRY(status);
        s->steps++;
    }
    s->seconds += gn_now() - start;
    return GNEISS_OK;
}

static bool touching(const gn_world *w) {
    for (size_t c = 0; w->ctx.effects & GN_FX_WALLS && c < w->boundary.contacts.soa.count; c++)
        if (w->boundary.contacts.row[8 * c] != 0.0 || w->boundary.contacts.row[8 * c + 1] != 0.0 ||
            w->boundary.contacts.row[8 * c + 2] != 0.0)
            return true;
    return false;
}

/* --- what is to come --- */

/* Of a source by a time, by its rate and from what it has let in. */
static double number_by(const gn_world *w, size_t k, double time) {
    const gn_source_def *d = &w->ctx.scene.sources[k];
    const gn_source_state *s = &w->dem.flow.sources[k];
    double mean = s->number > 0.0 ? s->mass / s->number : INFINITY;
    double rate = d->mass_rate > 0.0 ? d->mass_rate / mean : d->rate;
    double until = d->end > 0.0 ? fmin(time, d->end) : time;
    double number = rate * fmax(0.0, until - d->start);
    if (d->total > 0) number = fmin(number, (double)d->total);
    return fmax(number, s->number);
}

static double present_by(const gn_world *w, double time) {
    double sum = (double)gn_world_present(&w->dem);
    for (size_t k = 0; k < w->ctx.scene.source_count; k++)
        sum += number_by(w, k, time) - w->dem.flow.sources[k].number;
    return sum;
}

/* Seconds of a step: a + b N through both halves of the trial; where hardly more came in the
 * second, or it shows no growth, in proportion. */
static void fit(const span half[2], double *a, double *b) {
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

gneiss_status gn_plan_flow_try(gn_world *w, gn_plan_flow *p, gneiss_error *error) {
    enum { PIECES = 400 };
    span half[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    bool over = false;
    double a, b;
    *p = (gn_plan_flow){0};
    double start = gn_now();
    for (double gone = 0.0; gone < budget && !over; gone = gn_now() - start) {
        GN_TRY(take(w, &half[gone > 0.5 * budget], &over, error));
        p->touched = p->touched || touching(w);
    }
    fit(half, &a, &b);
    p->tried = w->ctx.time;
    p->step = w->ctx.dt;
    p->present = gn_world_present(&w->dem);
    p->seconds = half[0].seconds + half[1].seconds;
    double left = fmax(0.0, w->ctx.scene.end - w->ctx.time), part = left / PIECES;
    for (int k = 0; k < PIECES; k++)
        p->seconds += part / w->ctx.dt * (a + b * present_by(w, w->ctx.time + (k + 0.5) * part));
    p->most = present_by(w, w->ctx.scene.end);
    p->steps = (double)w->ctx.step + ceil(left / w->ctx.dt);
    return GNEISS_OK;
}

void gn_print_plan_flow(const gn_world *w, const gn_plan_flow *p) {
    char text[32];
    printf("cost, with the particles that sources bring\n");
    printf("  tried            to t = %.4g s: %lld steps, the last of %.4g s, %zu particles%s\n",
           p->tried, (long long)w->ctx.step, p->step, p->present,
           p->touched ? "" : ", of which none has touched a wall or body yet");
    printf("  steps            %.0f to t = %g s, if they stay as long%s%s\n", p->steps,
           w->ctx.scene.end,
           p->touched ? "; faster or deeper contacts make them shorter"
                      : ", which they will not once particles touch",
           w->ctx.scene.stage_count ? " (a stop condition may come first)" : "");
    printf(
        "  time             %s with %d thread%s, for %.4g particles at the end if none left; once "
        "they lie closely each costs more\n",
        gn_format_seconds(p->seconds, text, sizeof text), w->ctx.threads,
        w->ctx.threads > 1 ? "s" : "", p->most);
    gn_print_stages(w, p->steps > 0.0 ? p->seconds / p->steps : 0.0);
}
