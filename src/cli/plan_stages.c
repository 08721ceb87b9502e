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

/* Writes the conditions that end a stage, such as "5e-05 s or unbalanced < 0.01". */
static void conditions(const gn_stage *stage, char *text, size_t size) {
    *text = '\0';
    if (stage->time >= 0.0) add(text, size, "%g s", stage->time);
    if (stage->steps >= 0) add(text, size, "%.0f steps", (double)stage->steps);
    if (stage->strain > 0.0) add(text, size, "strain + %g", stage->strain);
    if (stage->stress > 0.0) add(text, size, "stress %g Pa", stage->stress);
    if (stage->peak_drop > 0.0) add(text, size, "stress %g below its peak", stage->peak_drop);
    if (stage->unbalanced > 0.0) add(text, size, "unbalanced < %g", stage->unbalanced);
    if (stage->held > 0.0) add(text, size, "servos or membrane within %g", stage->held);
    if (!*text) snprintf(text, size, "time.end");
}

/* Returns the largest number of steps of a stage with the present step. */
static double steps_of(const gn_world *world, const gn_stage *stage) {
    double time =
        stage->time >= 0.0 ? fmin(stage->time, world->ctx.scene.end) : world->ctx.scene.end;
    double steps = ceil(time / world->ctx.dt);
    return stage->steps >= 0 ? fmin(steps, (double)stage->steps) : steps;
}

double gn_plan_steps(const gn_world *world) {
    double all = ceil((world->ctx.scene.end - world->ctx.time) / world->ctx.dt), sum = 0.0;
    for (size_t k = 0; k < world->ctx.scene.stage_count; k++)
        sum += steps_of(world, &world->ctx.scene.stages[k]);
    return world->ctx.scene.stage_count ? fmin(all, sum) : all;
}

/* A given step is checked when the scene is read; an automatic step may become shorter, so that
 * this is a warning and no error. */
bool gn_stage_is_overlong(const gn_world *world, char *text, size_t size) {
    for (size_t k = world->stages.now; k < world->ctx.scene.stage_count; k++) {
        const gn_stage *stage = &world->ctx.scene.stages[k];
        gn_stage other = *stage;
        other.steps = -1;
        if (stage->steps < 0 || gn_stage_has_end(&other) ||
            (double)stage->steps * world->ctx.dt <= world->ctx.scene.end * (1.0 + 1e-9))
            continue;
        snprintf(text, size,
                 "%s: stage '%s' ends by its steps alone, which with the present step of %.3g s "
                 "take %.4g s: time.end, %.4g s, comes first",
                 gn_scene_at(&world->ctx.scene, stage->where, "stages").text, stage->name,
                 world->ctx.dt, (double)stage->steps * world->ctx.dt, world->ctx.scene.end);
        return true;
    }
    return false;
}

void gn_print_stages(const gn_world *world, double per_step) {
    char text[192], time[32];
    if (!world->ctx.scene.stage_count) return;
    printf("stages (upper bound of steps at the step of the first%s)\n",
           world->ctx.scene.source_count ? ", as far as the trial went" : "");
    for (size_t k = 0; k < world->ctx.scene.stage_count; k++) {
        const gn_stage *stage = &world->ctx.scene.stages[k];
        double steps = steps_of(world, stage);
        conditions(stage, text, sizeof text);
        printf("  %-16s %12.0f steps, %s; until %s\n", stage->name, steps,
               gn_format_seconds(per_step * steps, time, sizeof time), text);
    }
    char overlong[GNEISS_MESSAGE_SIZE];
    if (gn_stage_is_overlong(world, overlong, sizeof overlong)) printf("  warning: %s\n", overlong);
}

void gn_print_stages_done(const gn_run *run) {
    const gn_world *world = &run->world;
    char reason[96];
    for (size_t k = 0; gn_run_staged(run) && k < world->ctx.scene.stage_count; k++) {
        const gn_stage *stage = &world->ctx.scene.stages[k];
        if (k > world->stages.now) {
            printf("  stage %-16s       not reached\n", stage->name);
            continue;
        }
        const gn_stage_state *s = &world->stages.state[k],
                             *next = k < world->stages.now ? s + 1 : NULL;
        const double steps = (double)((next ? next->step : world->ctx.step) - s->step);
        printf("  stage %-16s %10.0f steps from t = %.4g s: %s\n", stage->name, steps, s->time,
               gn_stage_reason(stage, (gn_stage_cause)s->ended, reason, sizeof reason));
    }
}
