/* Warnings about servos that miss their targets. */
#include "run/stages.h"
#include "run/warnings.h"

#include <math.h>

/* Returns the means of force and target over `count` rows up to `last`. */
static gn_servo_row mean_of(const gn_run *run, int wall, int axis, size_t last, size_t count) {
    gn_servo_row mean = {0};
    for (size_t r = last + 1 - count; r <= last; r++) {
        gn_servo_row row =
            wall >= 0 ? gn_run_wall_servo(run, (size_t)wall, r) : gn_run_side_servo(run, axis, r);
        mean.found += row.found / (double)count;
        mean.wanted += row.wanted / (double)count;
    }
    return mean;
}

/* The largest relative error of a servo, and the largest share of the stage, since the target was
 * first reached, in which the error may be larger. */
static const double servo_limit = 0.1, share_limit = 0.1;

/* A force without a target has no error. */
static bool is_off(gn_servo_row row) {
    return row.wanted != 0.0 && fabs(row.found - row.wanted) > servo_limit * fabs(row.wanted);
}

/* Returns the mean of the last rows of the present stage, and the share of means of as many rows
 * that are off since the first that is not (0: there is none). */
static gn_servo_row look_at_servo(const gn_run *run, int wall, int axis, double *share) {
    const size_t rows = run->history.row_count,
                 begun = gn_run_staged(run)
                             ? (size_t)run->world.stages.state[run->world.stages.now].row
                             : 0;
    const size_t count = rows - begun < GN_ROWS_HELD ? rows - begun : GN_ROWS_HELD;
    size_t means = 0, off = 0;
    gn_servo_row mean = {0};
    *share = 0.0;
    if (count == 0) return mean;
    for (size_t last = begun + count - 1; last < rows; last++) {
        mean = mean_of(run, wall, axis, last, count);
        off += means > 0 && is_off(mean);
        means += means > 0 || !is_off(mean);
    }
    if (means > 0) *share = (double)off / (double)means;
    return mean;
}

/* At most this number of servos is named. */
enum { SERVOS_NAMED = 2 };

static size_t tell_of_servo(const gn_run *run, int wall, int axis, gn_servo_row mean, double share,
                            char *text, size_t size) {
    const char *name =
        axis >= 0 ? (const char *[]){"x", "y", "z"}[axis] : run->world.ctx.scene.walls[wall].name;
    const char *unit = axis >= 0 ? "Pa" : "N";
    size_t used = (size_t)snprintf(
        text, size,
        "%s '%.40s' has %.4g %s in the mean of the last rows, and its target is %.4g %s",
        axis >= 0 ? "side" : "wall", name, mean.found, unit, mean.wanted, unit);
    if (share > share_limit && used < size)
        used += (size_t)snprintf(
            text + used, size - used,
            " (and was off by more than a tenth in %.0f %% of the %s since it was first reached)",
            100.0 * share, gn_run_staged(run) ? "stage" : "run");
    return used < size ? used : size - 1;
}

void gn_warn_of_servos(const gn_run *run, gn_warnings *list) {
    const gn_scene *s = &run->world.ctx.scene;
    char text[400] = "";
    size_t used = 0, count = 0;
    bool pulls = false;
    for (int k = 0; run->finished && k < 3 + (int)s->wall_count; k++) {
        const int wall = k - 3, axis = k < 3 ? k : -1;
        bool active = axis >= 0 ? s->box[axis].stress.count > 0 : s->walls[wall].servo.active;
        double share = 0.0;
        gn_servo_row mean = active ? look_at_servo(run, wall, axis, &share) : (gn_servo_row){0};
        if (!is_off(mean) && share <= share_limit) continue;
        pulls = pulls || (wall >= 0 && mean.wanted < 0.0);
        if (count++ >= SERVOS_NAMED) continue;
        if (used) used += (size_t)snprintf(text + used, sizeof text - used, "; ");
        used += tell_of_servo(run, wall, axis, mean, share, text + used, sizeof text - used);
    }
    if (!count) return;
    gn_warning *to = gn_warnings_add(list, "servo_not_held");
    size_t at = (size_t)snprintf(to->text, sizeof to->text, "%s", text);
    if (count > SERVOS_NAMED)
        at += (size_t)snprintf(to->text + at, sizeof to->text - at, "; and %zu more",
                               count - SERVOS_NAMED);
    snprintf(to->text + at, sizeof to->text - at, ": %s",
             pulls ? "a wall can only push, and its target is a pull"
                   : "there was too little time, or the loaded material yields faster than the "
                     "servo follows; use a later end, a larger max_velocity, max_rate or "
                     "relaxation, or a wall that is less stiff");
}
