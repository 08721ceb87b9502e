#include "plan/setting.h"
#include "base/new.h"
#include "io/io.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *gn_plan_pace_refusal(const gn_scene *scene) {
    for (size_t k = 0; k < scene->wall_count; k++)
        if (scene->walls[k].servo.active) return "a wall with a servo varies independently in time";
    for (size_t k = 0; scene->has_elements && k < scene->elements.load_count; k++)
        for (int a = 0; a < 3; a++)
            if (scene->elements.loads[k].traction[a].count > 1 ||
                scene->elements.loads[k].force[a].count > 1)
                return "a load of elements varies independently in time";
    if (gn_scene_has_gravity(scene)) return "gravity acts independently of the loading speed";
    if (scene->formulas) return "a formula of t keeps its times";
    return NULL;
}

gneiss_status gn_settings_add(gn_settings *settings, const char *key, const char *value,
                              gneiss_error *error) {
    char *own_key = strdup(key), *own_value = strdup(value);
    if (own_key && own_value && settings->count < GN_SETTINGS_MAX) {
        gn_override *to = &settings->setting[settings->count++];
        to->key = own_key;
        to->value = own_value;
        return GNEISS_OK;
    }
    free(own_key);
    free(own_value);
    return settings->count < GN_SETTINGS_MAX
               ? gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a setting")
               : gn_fail(error, GNEISS_ERROR_INPUT, "expected at most %d settings to change",
                         GN_SETTINGS_MAX);
}

void gn_settings_free(gn_settings *settings) {
    for (size_t k = 0; k < settings->count; k++) {
        free((char *)settings->setting[k].key);
        free((char *)settings->setting[k].value);
    }
    settings->count = 0;
}

__attribute__((format(printf, 4, 5))) static gneiss_status
put(gn_settings *settings, gneiss_error *error, const char *key, const char *format, ...) {
    char value[256];
    va_list args;
    va_start(args, format);
    vsnprintf(value, sizeof value, format, args);
    va_end(args);
    return gn_settings_add(settings, key, value, error);
}

/* Writes a table with its values divided by the factor of its times, so that the path is unchanged.
 */
static gneiss_status put_table(gn_settings *settings, const char *key, const gn_table *table,
                               double pace, const char *unit, gneiss_error *error) {
    GN_FREED char *text = NULL;
    size_t size;
    FILE *out;
    GN_TRY(gn_text_open(&text, &size, &out, key, error));
    if (table->count == 1 && table->time[0] == 0.0)
        fprintf(out, "%.6g %s", table->value[0] * pace, unit);
    else
        for (size_t k = 0; k < table->count; k++)
            fprintf(out, "%s[%.6g, %.6g]%s", k ? ", " : "[", table->time[k] / pace,
                    table->value[k] * pace, k + 1 == table->count ? "]" : "");
    GN_TRY(gn_text_close(out, key, error));
    return gn_settings_add(settings, key, text, error);
}

static bool moves(const gn_table *table) {
    for (size_t k = 0; k < table->count; k++)
        if (table->value[k] != 0.0) return true;
    return false;
}

static gneiss_status put_motion(gn_settings *settings, const char *list, size_t place,
                                const gn_motion *motion, double pace, gneiss_error *error) {
    char key[128];
    for (int a = 0; a < 6; a++) {
        const gn_table *table = a < 3 ? &motion->velocity[a] : &motion->spin[a - 3];
        snprintf(key, sizeof key, "%s.%zu.motion.%c%c", list, place, "vw"[a / 3], "xyz"[a % 3]);
        if (moves(table))
            GN_TRY(put_table(settings, key, table, pace, a < 3 ? "m/s" : "rad/s", error));
    }
    return GNEISS_OK;
}

double gn_plan_end(const gn_plan *plan, const gn_scene *scene, double pace) {
    const gn_estimate *estimate = &plan->estimate;
    const double peaks = 4.0;
    double far =
        isfinite(estimate->strain) ? estimate->path_strain / (peaks * estimate->strain) : 1.0;
    return scene->end / pace / (pace < 1.0 ? fmax(1.0, far) : 1.0);
}

double gn_plan_history_rows(const gn_plan *plan, const gn_scene *scene, double pace) {
    const gn_estimate *estimate = &plan->estimate;
    const double least = 100.0, most = 1e6;
    double rows = (double)scene->history_rows;
    if (!isfinite(estimate->strain) || !(rows > 0.0)) return rows;
    double path = estimate->path_strain * gn_plan_end(plan, scene, pace) * pace / scene->end;
    return fmin(fmax(rows, ceil(least * path / estimate->strain)), fmax(rows, most));
}

static gneiss_status put_pace(gn_settings *settings, const gn_plan *plan, const gn_scene *scene,
                              double pace, gneiss_error *error) {
    for (size_t k = 0; k < scene->wall_count; k++)
        GN_TRY(put_motion(settings, "walls", k, &scene->walls[k].motion, pace, error));
    for (size_t k = 0; k < scene->set_count; k++)
        GN_TRY(put_motion(settings, "sets", k, &scene->sets[k].motion, pace, error));
    for (size_t k = 0; k < scene->body_count; k++)
        GN_TRY(put_motion(settings, "bodies", k, &scene->bodies[k].motion, pace, error));
    for (size_t k = 0; scene->has_elements && k < scene->elements.motion_count; k++)
        GN_TRY(put_motion(settings, "elements.motions", k, &scene->elements.motions[k].motion, pace,
                          error));
    return put(settings, error, "time.end", "%.9g s", gn_plan_end(plan, scene, pace));
}

static gneiss_status put_cells(gn_settings *settings, const gn_scene *scene, double cell,
                               gneiss_error *error) {
    const gn_element_def *elements = &scene->elements;
    if (elements->has_beam)
        return put(settings, error, "elements.beam.cell", "%.6g", elements->beam.cell * cell);
    return put(settings, error, "elements.rectangle.cells", "[%.0f, %.0f]",
               fmax(1.0, round((double)elements->cells[0] / cell)),
               fmax(1.0, round((double)elements->cells[1] / cell)));
}

/* Writes the target step in seconds, so that other packings have the same step. */
static gneiss_status put_masses(gn_settings *settings, const gn_plan *plan, const gn_scene *scene,
                                const gn_proposal *proposal, gneiss_error *error) {
    if (plan->groups.mesh || fabs(proposal->step_ratio / plan->groups.step_ratio - 1.0) <= 1e-3)
        return GNEISS_OK;
    if (scene->scaled_step > 0.0 && proposal->step_ratio == 1.0)
        GN_TRY(put(settings, error, "time.mass_scaling.step", "none"));
    if (proposal->step_ratio == 1.0) return put(settings, error, "time.mass_scaling.factor", "1");
    if (scene->scaled_factor > 0.0)
        GN_TRY(put(settings, error, "time.mass_scaling.factor", "none"));
    if (scene->estimate != GN_STEP_BOUND) GN_TRY(put(settings, error, "time.estimate", "bound"));
    double finer =
        pow(proposal->particles / plan->groups.particles, -1.0 / (double)scene->dimension);
    return put(settings, error, "time.mass_scaling.step", "%.4g s",
               plan->unscaled_step * proposal->step_ratio * finer * proposal->safety /
                   plan->groups.safety);
}

gneiss_status gn_settings_make(const gn_step_context *ctx, const gn_plan *plan,
                               const gn_proposal *proposal, gn_settings *settings,
                               gneiss_error *error) {
    const gn_scene *scene = &ctx->given;
    const gn_test_groups *groups = &plan->groups;
    if (proposal->pace != 1.0) GN_TRY(put_pace(settings, plan, scene, proposal->pace, error));
    double rows = gn_plan_history_rows(plan, scene, proposal->pace);
    if (rows > (double)scene->history_rows)
        GN_TRY(put(settings, error, "output.history_rows", "%.0f", rows));
    if (proposal->particles != groups->particles)
        GN_TRY(put(settings, error, "specimen.particles", "%.0f", proposal->particles));
    if (proposal->cell != 1.0) GN_TRY(put_cells(settings, scene, proposal->cell, error));
    if (scene->step > 0.0) GN_TRY(put(settings, error, "time.step", "auto"));
    if (fabs(proposal->safety - scene->safety) > 1e-9)
        GN_TRY(put(settings, error, "time.safety", "%g", proposal->safety));
    if (proposal->mixed != (scene->precision == GN_PRECISION_MIXED))
        GN_TRY(put(settings, error, "run.precision", "%s", proposal->mixed ? "mixed" : "double"));
    if (proposal->first_break != (scene->start == GN_START_FIRST_BREAK))
        GN_TRY(put(settings, error, "time.start", "%s",
                   proposal->first_break ? "first_break" : "rest"));
    return put_masses(settings, plan, scene, proposal, error);
}
