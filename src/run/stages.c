/* Stages of a run: their ends and the change from one to the next. Their definition is in
 * scene/stages.h, the changes of the world are in world/stages.c. */
#include "run/stages.h"

#include "base/error.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/balance.h"
#include "inflow/sources.h"
#include "particles/flow.h"
#include "run/spacing.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "scene/values.h"
#include "world/world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Number of samples (spacing.h) of the stage after which unbalanced forces, and a fall from a peak,
 * are evaluated, because the first ones oscillate about zero. Servos must hold for ROWS_HELD
 * samples. */
enum { ROWS_BEFORE = 20, ROWS_HELD = GN_ROWS_HELD, ROWS_MOST = ROWS_BEFORE + 1 };

static gn_stage_state *state_of(const gn_run *run) {
    return &run->world.stages.state[run->world.stages.now];
}

static const gn_stage *stage_of(const gn_run *run) {
    return &run->world.ctx.scene.stages[run->world.stages.now];
}

static bool is_last(const gn_run *run) {
    return run->world.stages.now + 1 == run->world.ctx.scene.stage_count;
}

bool gn_run_staged(const gn_run *run) {
    return run->world.ctx.scene.stage_count > 0;
}

bool gn_run_stages_left(const gn_run *run) {
    return gn_run_staged(run) &&
           !(is_last(run) && (state_of(run)->ended != 0 || !gn_stage_has_end(stage_of(run))));
}

/* --- conditions --- */

static double in_row(const gn_run *run, const char *column, size_t row) {
    const double *values = gn_history_column(&run->history, column);
    return values ? values[row] : NAN;
}

/* Returns the mean stress of the specimen and its target. */
static gn_servo_row mean_row(const gn_run *run, const gn_table *stress, size_t row) {
    static const char *const names[] = {"stress_xx", "stress_yy", "stress_zz"};
    const int dimension = (int)run->world.ctx.scene.dimension;
    double sum = 0.0;
    for (int a = 0; a < dimension; a++) sum -= in_row(run, names[a], row) / dimension;
    return (gn_servo_row){sum, gn_table_at(stress, in_row(run, "time", row))};
}

gn_servo_row gn_run_wall_servo(const gn_run *run, size_t wall, size_t row) {
    const gn_world *w = &run->world;
    const gn_wall_def *def = &w->ctx.scene.walls[wall];
    static const char *const axes[] = {"x", "y", "z"};
    double part,
        pressed = 0.0,
        wanted = gn_wall_wanted(&w->ctx, &w->boundary, wall, in_row(run, "time", row), &part);
    if (def->servo.of_mean) return mean_row(run, &def->servo.stress, row);
    for (int a = 0; a < (int)w->ctx.scene.dimension; a++) {
        char name[GN_COLUMN_NAME_SIZE];
        snprintf(name, sizeof name, "wall_%s_force_%s", def->name, axes[a]);
        pressed -= in_row(run, name, row) * def->normal[a];
    }
    return (gn_servo_row){pressed, wanted};
}

gn_servo_row gn_run_side_servo(const gn_run *run, int axis, size_t row) {
    static const char *const stresses[] = {"stress_xx", "stress_yy", "stress_zz"};
    const gn_box_side *side = &run->world.ctx.scene.box[axis];
    double wanted = gn_table_at(&side->stress, in_row(run, "time", row));
    if (side->of_mean) return mean_row(run, &side->stress, row);
    return (gn_servo_row){-in_row(run, stresses[axis], row), wanted};
}

static bool holds(const gn_run *run, gn_servo_row servo) {
    return fabs(servo.found - servo.wanted) <= stage_of(run)->held * fabs(servo.wanted);
}

/* Returns the ratio of the volume to that at the start; stresses refer to the latter. */
static double volume_left(const gn_run *run, size_t row) {
    static const char *const strains[] = {"strain_xx", "strain_yy", "strain_zz"};
    double sum = 1.0;
    for (int a = 0; a < (int)run->world.ctx.scene.dimension; a++)
        sum += in_row(run, strains[a], row);
    return sum > 0.0 ? sum : 1.0; /* unknown: as at the start */
}

/* Returns the stress and target of the membrane, which are compared if there is no servo: the mean
 * stress of the specimen, or under a membrane on the sides the mean stress across their axis. */
static gn_servo_row membrane_row(const gn_run *run, size_t row) {
    static const char *const stresses[] = {"stress_xx", "stress_yy", "stress_zz"};
    const gn_scene *s = &run->world.ctx.scene;
    const bool sides = s->membrane.faces == GN_FACES_SIDES;
    double sum = 0.0, count = 0.0;
    for (int a = 0; a < (int)s->dimension; a++) {
        if (sides && a == gn_scene_membrane_axis(s)) continue;
        sum -= in_row(run, stresses[a], row);
        count += 1.0;
    }
    /* Under a membrane that follows a single body the mean stress refers to the enclosed volume. */
    const bool follows = s->membrane.follow && run->world.membrane.state->bodies == 1;
    return (gn_servo_row){sum / count / (follows ? 1.0 : volume_left(run, row)),
                          gn_table_at(&s->membrane.pressure, in_row(run, "time", row))};
}

static bool has_servo(const gn_world *world) {
    bool any = false;
    for (int a = 0; a < 3; a++) any = any || world->ctx.scene.box[a].stress.count;
    for (size_t k = 0; k < world->ctx.scene.wall_count; k++)
        any = any || world->ctx.scene.walls[k].servo.active;
    return any;
}

/* Tells whether the membrane has been unloaded: it has no pressure, its ramp is over, and no
 * pressure follows. A value of a series may be zero. */
static bool released(const gn_run *run, size_t row) {
    const gn_table *given = &run->world.ctx.scene.membrane.pressure;
    const size_t last = given->count ? given->count - 1 : 0;
    if (in_row(run, "membrane_pressure", row) != 0.0) return false;
    if (!given->count) return true;
    return given->value[last] == 0.0 && (!last || in_row(run, "time", row) >= given->time[last]);
}

static bool membrane_holds(const gn_run *run, size_t rows) {
    if (rows < ROWS_HELD || !run->world.ctx.scene.has_membrane || has_servo(&run->world))
        return false;
    for (size_t r = 1; r <= ROWS_HELD; r++) {
        const size_t sample = gn_run_sample_row(run, r);
        const gn_servo_row row = membrane_row(run, sample);
        if (!(row.wanted > 0.0 ? holds(run, row) : released(run, sample))) return false;
    }
    return true;
}

static bool servos_hold(const gn_run *run, size_t rows) {
    const gn_world *w = &run->world;
    if (rows < ROWS_HELD || !has_servo(w)) return false;
    for (int a = 0; a < 3; a++)
        for (size_t r = 1; w->ctx.scene.box[a].stress.count && r <= ROWS_HELD; r++)
            if (!holds(run, gn_run_side_servo(run, a, gn_run_sample_row(run, r)))) return false;
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++)
        for (size_t r = 1; w->ctx.scene.walls[k].servo.active && r <= ROWS_HELD; r++)
            if (!holds(run, gn_run_wall_servo(run, k, gn_run_sample_row(run, r)))) return false;
    return true;
}

bool gn_run_loaded(const gn_run *run, double peak) {
    const gn_test_descriptor *d = gn_scene_test(&run->world.ctx.scene);
    const size_t row = run->history.row_count - 1;
    if (d->confined) return peak > 0.1 * in_row(run, "membrane_pressure", row);
    return !d->sheared || !(peak <= 0.05 * in_row(run, "normal_stress", row));
}

static bool fell(const gn_run *run, size_t rows, double stress) {
    const gn_dem *d = &run->world.dem;
    bool counts = run->world.ctx.effects & GN_FX_BONDS ? gn_dem_breaks(d) > 0 : rows > ROWS_BEFORE;
    double peak = state_of(run)->peak;
    return counts && peak > 0.0 && gn_run_loaded(run, peak) &&
           stress < (1.0 - stage_of(run)->peak_drop) * peak;
}

/* A specimen is not settled in free fall, before it has carried any load, or if particles are still
 * to come. */
bool gn_run_balanced(const gn_run *run, size_t rows, double limit) {
    const gn_balance *b = &run->world.ledger.balance;
    return limit > 0.0 && rows > ROWS_BEFORE && b->carries && !b->falls && b->ratio < limit &&
           !gn_flow_brings(&run->world.ctx, &run->world.dem);
}

static gn_stage_cause cause_in_row(gn_run *run) {
    const gn_world *w = &run->world;
    const gn_stage *e = stage_of(run);
    gn_stage_state *s = state_of(run);
    size_t row = run->history.row_count - 1,
           rows = gn_run_sample_count(run, (size_t)s->row, ROWS_MOST);
    if (gn_scene_tested(&w->ctx.scene)) {
        double strain = in_row(run, "strain", row), stress = in_row(run, "stress", row);
        /* The first row of a stage is at the instant of the change; its stress may be due to moving
         * ends that were stopped. */
        if (rows == 1)
            s->strain = strain;
        else
            s->peak = fmax(s->peak, stress);
        if (e->strain > 0.0 && strain - s->strain >= e->strain) return GN_STAGE_STRAIN;
        if (e->stress > 0.0 && stress >= e->stress) return GN_STAGE_STRESS;
        if (e->peak_drop > 0.0 && fell(run, rows, stress)) return GN_STAGE_PEAK_DROP;
    }
    if (gn_run_balanced(run, rows, e->unbalanced)) return GN_STAGE_UNBALANCED;
    if (e->held > 0.0 && servos_hold(run, rows)) return GN_STAGE_HELD;
    if (e->held > 0.0 && membrane_holds(run, rows)) return GN_STAGE_PRESSED;
    return GN_STAGE_RUNS;
}

const char *gn_stage_reason(const gn_stage *stage, gn_stage_cause cause, char *text, size_t size) {
    const struct {
        const char *format;
        double value;
    } texts[] = {{"not over", 0.0},
                 {"%g s passed", stage->time},
                 {"%.0f steps done", (double)stage->steps},
                 {"strain grew by %g", stage->strain},
                 {"stress reached %g Pa", stage->stress},
                 {"stress fell by %g of its peak", stage->peak_drop},
                 {"unbalanced force ratio fell below %g", stage->unbalanced},
                 {"servos held their forces to %g", stage->held},
                 {"the mean stress held the pressure of the membrane to %g", stage->held},
                 {"a program ended it", 0.0}};
    snprintf(text, size, texts[cause].format, texts[cause].value);
    return text;
}

static void name_stage(const gn_run *run, char *text, size_t size) {
    snprintf(text, size, "stage '%s' (%zu of %zu)", stage_of(run)->name, run->world.stages.now + 1,
             run->world.ctx.scene.stage_count);
}

static void end(gn_run *run, gn_stage_cause cause) {
    char reason[96], name[GN_NAME_SIZE + 64];
    gn_stage_state *s = state_of(run);
    if (cause == GN_STAGE_RUNS) return;
    s->ended = cause;
    if (!is_last(run)) return;
    name_stage(run, name, sizeof name);
    run->finished = true;
    snprintf(run->stop_reason, sizeof run->stop_reason, "%s, %s",
             gn_stage_reason(stage_of(run), cause, reason, sizeof reason), name);
}

void gn_run_stage_row(gn_run *run) {
    if (state_of(run)->ended == 0) end(run, cause_in_row(run));
}

void gn_run_stage_time(gn_run *run) {
    const gn_world *w = &run->world;
    const gn_stage *e = stage_of(run);
    const gn_stage_state *s = state_of(run);
    if (s->ended != 0) {
        end(run, (gn_stage_cause)s->ended);
        return;
    }
    if (e->steps >= 0 && w->ctx.step - s->step >= e->steps) end(run, GN_STAGE_STEPS);
    /* A stage with a time above 0, however short, takes a step. */
    bool begun = e->time == 0.0 || w->ctx.step > s->step;
    bool over = begun && w->ctx.time - s->time >= e->time - 0.5 * w->ctx.dt;
    if (s->ended == 0 && e->time >= 0.0 && over) end(run, GN_STAGE_TIME);
}

void gn_run_end_stage(gn_run *run) {
    if (state_of(run)->ended == 0) end(run, GN_STAGE_ASKED);
}

double gn_run_stage_duration(const gn_run *run) {
    const gn_world *w = &run->world;
    const gn_stage *e = stage_of(run);
    return fmin(w->ctx.scene.end - state_of(run)->time, gn_stage_length(e, w->ctx.dt));
}

double gn_run_time_left(const gn_run *run) {
    const gn_world *w = &run->world;
    double end = w->ctx.scene.end - w->ctx.time, left = 0.0;
    for (size_t k = w->stages.now; gn_run_staged(run) && k < w->ctx.scene.stage_count; k++) {
        const double most = gn_stage_length(&w->ctx.scene.stages[k], w->ctx.dt);
        left += k == w->stages.now ? fmax(0.0, w->stages.state[k].time + most - w->ctx.time) : most;
    }
    return gn_run_staged(run) ? fmin(end, left) : end;
}

void gn_run_out_of_time(gn_run *run) {
    char name[GN_NAME_SIZE + 64] = "";
    if (gn_run_staged(run)) name_stage(run, name, sizeof name);
    run->finished = true;
    snprintf(run->stop_reason, sizeof run->stop_reason, "t = %g s reached%s%s%s",
             run->world.ctx.scene.end, *name ? " in " : "", name,
             !*name                                     ? ""
             : gn_run_stages_left(run) && !is_last(run) ? ": later stages were not reached"
             : gn_run_stages_left(run)                  ? ", which was not over"
                                                        : "");
}

/* --- change of the stage --- */

gneiss_status gn_run_stages_go(gn_run *run, bool *entered, gneiss_error *error) {
    gn_world *w = &run->world;
    *entered = false;
    gn_run_stage_time(run);
    while (!run->finished && state_of(run)->ended != 0) {
        GN_TRY(gn_world_enter(w, w->stages.now + 1, error));
        state_of(run)->row = (int64_t)run->history.row_count;
        *entered = true;
        gn_run_stage_time(run);
    }
    return GNEISS_OK;
}
