#include "cli/plan_stages.h"

#include "cli/progress.h"
#include "run/stages.h"

#include <math.h>
#include <string.h>

static void add(char *text, size_t size, const char *format, double value) {
    size_t used = strlen(text);
    if (used >= size) return;
    used += (size_t)snprintf(text + used, size - used, "%s", used ? " or " : "");
    if (used < size) snprintf(text + used, size - used, format, value);
}

/* "5e-05 s or unbalanced < 0.01" */
static void conditions(const gn_stage *e, char *text, size_t size) {
    *text = '\0';
    if (e->time >= 0.0) add(text, size, "%g s", e->time);
    if (e->steps >= 0) add(text, size, "%.0f steps", (double)e->steps);
    if (e->strain > 0.0) add(text, size, "strain + %g", e->strain);
    if (e->stress > 0.0) add(text, size, "stress %g Pa", e->stress);
    if (e->peak_drop > 0.0) add(text, size, "stress %g below its peak", e->peak_drop);
    if (e->unbalanced > 0.0) add(text, size, "unbalanced < %g", e->unbalanced);
    if (e->held > 0.0) add(text, size, "servos or membrane within %g", e->held);
    if (!*text) snprintf(text, size, "time.end");
}

/* Steps at the present length, the most that a stage may take. */
static double steps_of(const gn_world *w, const gn_stage *e) {
    double time = e->time >= 0.0 ? fmin(e->time, w->ctx.scene.end) : w->ctx.scene.end;
    double steps = ceil(time / w->ctx.dt);
    return e->steps >= 0 ? fmin(steps, (double)e->steps) : steps;
}

double gn_plan_steps(const gn_world *w) {
    double all = ceil((w->ctx.scene.end - w->ctx.time) / w->ctx.dt), sum = 0.0;
    for (size_t k = 0; k < w->ctx.scene.stage_count; k++)
        sum += steps_of(w, &w->ctx.scene.stages[k]);
    return w->ctx.scene.stage_count ? fmin(all, sum) : all;
}

/* A given step is looked at with the scene; one that is found may become shorter, so this is said
 * and not refused. */
bool gn_stage_is_overlong(const gn_world *w, char *text, size_t size) {
    for (size_t k = w->stages.now; k < w->ctx.scene.stage_count; k++) {
        const gn_stage *e = &w->ctx.scene.stages[k];
        gn_stage other = *e;
        other.steps = -1;
        if (e->steps < 0 || gn_stage_has_end(&other) ||
            (double)e->steps * w->ctx.dt <= w->ctx.scene.end * (1.0 + 1e-9))
            continue;
        snprintf(text, size,
                 "%s: stage '%s' ends by its steps alone, which with the present step of %.3g s "
                 "take %.4g s: time.end, %.4g s, comes before",
                 gn_scene_at(&w->ctx.scene, e->where, "stages").text, e->name, w->ctx.dt,
                 (double)e->steps * w->ctx.dt, w->ctx.scene.end);
        return true;
    }
    return false;
}

void gn_print_stages(const gn_world *w, double per_step) {
    char text[192], time[32];
    if (!w->ctx.scene.stage_count) return;
    printf("stages (the most that each may take, with the step of the first%s)\n",
           w->ctx.scene.source_count ? ", as far as it was tried" : "");
    for (size_t k = 0; k < w->ctx.scene.stage_count; k++) {
        const gn_stage *e = &w->ctx.scene.stages[k];
        double steps = steps_of(w, e);
        conditions(e, text, sizeof text);
        printf("  %-16s %12.0f steps, %s; until %s\n", e->name, steps,
               gn_format_seconds(per_step * steps, time, sizeof time), text);
    }
    char overlong[GNEISS_MESSAGE_SIZE];
    if (gn_stage_is_overlong(w, overlong, sizeof overlong)) printf("  warning: %s\n", overlong);
}

void gn_print_stages_done(const gn_run *run) {
    const gn_world *w = &run->world;
    char reason[96];
    for (size_t k = 0; gn_run_staged(run) && k < w->ctx.scene.stage_count; k++) {
        const gn_stage *e = &w->ctx.scene.stages[k];
        if (k > w->stages.now) {
            printf("  stage %-16s       not reached\n", e->name);
            continue;
        }
        const gn_stage_state *s = &w->stages.state[k], *next = k < w->stages.now ? s + 1 : NULL;
        double steps = (next ? next->step : (double)w->ctx.step) - s->step;
        printf("  stage %-16s %10.0f steps from t = %.4g s: %s\n", e->name, steps, s->time,
               gn_stage_reason(e, (gn_stage_cause)s->ended, reason, sizeof reason));
    }
}
