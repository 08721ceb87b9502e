#include "plan/setting.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *gn_plan_no_pace(const gn_scene *s) {
    for (size_t k = 0; k < s->wall_count; k++)
        if (s->walls[k].servo.active) return "a wall with a servo has a course of its own in time";
    for (size_t k = 0; s->has_elements && k < s->elements.load_count; k++)
        for (int a = 0; a < 3; a++)
            if (s->elements.loads[k].traction[a].count > 1 ||
                s->elements.loads[k].force[a].count > 1)
                return "a load of elements has a course of its own in time";
    for (int a = 0; a < 3; a++)
        if (s->gravity[a] != 0.0) return "gravity has a course of its own in time";
    return NULL;
}

gneiss_status gn_settings_add(gn_settings *q, const char *key, const char *value,
                              gneiss_error *error) {
    char *own_key = strdup(key), *own_value = strdup(value);
    if (own_key && own_value && q->count < GN_SETTINGS_MAX) {
        gn_override *to = &q->setting[q->count++];
        to->key = own_key;
        to->value = own_value;
        return GNEISS_OK;
    }
    free(own_key);
    free(own_value);
    return q->count < GN_SETTINGS_MAX
               ? gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a setting")
               : gn_fail(error, GNEISS_ERROR_INPUT, "expected at most %d settings to change",
                         GN_SETTINGS_MAX);
}

void gn_settings_free(gn_settings *q) {
    for (size_t k = 0; k < q->count; k++) {
        free((char *)q->setting[k].key);
        free((char *)q->setting[k].value);
    }
    q->count = 0;
}

__attribute__((format(printf, 4, 5))) static gneiss_status
put(gn_settings *q, gneiss_error *error, const char *key, const char *format, ...) {
    char value[256];
    va_list args;
    va_start(args, format);
    vsnprintf(value, sizeof value, format, args);
    va_end(args);
    return gn_settings_add(q, key, value, error);
}

/* Values are as many times larger as times are shorter, so that the path stays what it is. */
static gneiss_status put_table(gn_settings *q, const char *key, const gn_table *table, double pace,
                               const char *unit, gneiss_error *error) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %s", key);
    if (table->count == 1 && table->time[0] == 0.0)
        fprintf(out, "%.6g %s", table->value[0] * pace, unit);
    else
        for (size_t k = 0; k < table->count; k++)
            fprintf(out, "%s[%.6g, %.6g]", k ? ", " : "[", table->time[k] / pace,
                    table->value[k] * pace);
    if (table->count != 1 || table->time[0] != 0.0) fputc(']', out);
    fclose(out);
    gneiss_status status = text ? gn_settings_add(q, key, text, error)
                                : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %s", key);
    free(text);
    return status;
}

static bool moves(const gn_table *table) {
    for (size_t k = 0; k < table->count; k++)
        if (table->value[k] != 0.0) return true;
    return false;
}

static gneiss_status put_motion(gn_settings *q, const char *list, size_t place,
                                const gn_motion *motion, double pace, gneiss_error *error) {
    char key[128];
    for (int a = 0; a < 6; a++) {
        const gn_table *table = a < 3 ? &motion->velocity[a] : &motion->spin[a - 3];
        snprintf(key, sizeof key, "%s.%zu.motion.%c%c", list, place, "vw"[a / 3], "xyz"[a % 3]);
        if (moves(table)) GN_TRY(put_table(q, key, table, pace, a < 3 ? "m/s" : "rad/s", error));
    }
    return GNEISS_OK;
}

double gn_plan_end(const gn_plan *plan, const gn_scene *s, double pace) {
    const gn_estimate *e = &plan->estimate;
    const double peaks = 4.0;
    double far = isfinite(e->strain) ? e->path / (peaks * e->strain) : 1.0;
    return s->end / pace / (pace < 1.0 ? fmax(1.0, far) : 1.0);
}

double gn_plan_history_rows(const gn_plan *plan, const gn_scene *s, double pace) {
    const gn_estimate *e = &plan->estimate;
    const double least = 100.0, most = 1e6;
    double rows = (double)s->history_rows;
    if (!isfinite(e->strain) || !(rows > 0.0)) return rows;
    double path = e->path * gn_plan_end(plan, s, pace) * pace / s->end;
    return fmin(fmax(rows, ceil(least * path / e->strain)), fmax(rows, most));
}

static gneiss_status put_pace(gn_settings *q, const gn_plan *plan, const gn_scene *s, double pace,
                              gneiss_error *error) {
    for (size_t k = 0; k < s->wall_count; k++)
        GN_TRY(put_motion(q, "walls", k, &s->walls[k].motion, pace, error));
    for (size_t k = 0; k < s->set_count; k++)
        GN_TRY(put_motion(q, "sets", k, &s->sets[k].motion, pace, error));
    for (size_t k = 0; k < s->body_count; k++)
        GN_TRY(put_motion(q, "bodies", k, &s->bodies[k].motion, pace, error));
    for (size_t k = 0; s->has_elements && k < s->elements.motion_count; k++)
        GN_TRY(put_motion(q, "elements.motions", k, &s->elements.motions[k].motion, pace, error));
    return put(q, error, "time.end", "%.9g s", gn_plan_end(plan, s, pace));
}

static gneiss_status put_cells(gn_settings *q, const gn_scene *s, double cell,
                               gneiss_error *error) {
    const gn_element_def *e = &s->elements;
    if (e->has_beam) return put(q, error, "elements.beam.cell", "%.6g", e->beam.cell * cell);
    return put(q, error, "elements.rectangle.cells", "[%.0f, %.0f]",
               fmax(1.0, round((double)e->cells[0] / cell)),
               fmax(1.0, round((double)e->cells[1] / cell)));
}

/* As a step in seconds, so that other packings take the same one. */
static gneiss_status put_masses(gn_settings *q, const gn_plan *plan, const gn_scene *s,
                                const gn_proposal *p, gneiss_error *error) {
    if (plan->groups.mesh || fabs(p->masses / plan->groups.masses - 1.0) <= 1e-3) return GNEISS_OK;
    if (s->scaled_step > 0.0 && p->masses == 1.0)
        GN_TRY(put(q, error, "time.mass_scaling.step", "none"));
    if (p->masses == 1.0) return put(q, error, "time.mass_scaling.factor", "1");
    if (s->scaled_factor > 0.0) GN_TRY(put(q, error, "time.mass_scaling.factor", "none"));
    if (s->estimate != GN_STEP_BOUND) GN_TRY(put(q, error, "time.estimate", "bound"));
    double finer = pow(p->particles / plan->groups.particles, -1.0 / (double)s->dimension);
    return put(q, error, "time.mass_scaling.step", "%.4g s",
               plan->unscaled * p->masses * finer * p->safety / plan->groups.safety);
}

gneiss_status gn_settings_make(const gn_step_context *ctx, const gn_plan *plan,
                               const gn_proposal *p, gn_settings *q, gneiss_error *error) {
    const gn_scene *s = &ctx->given;
    const gn_test_groups *g = &plan->groups;
    if (p->pace != 1.0) GN_TRY(put_pace(q, plan, s, p->pace, error));
    double rows = gn_plan_history_rows(plan, s, p->pace);
    if (rows > (double)s->history_rows) GN_TRY(put(q, error, "output.history_rows", "%.0f", rows));
    if (p->particles != g->particles)
        GN_TRY(put(q, error, "specimen.particles", "%.0f", p->particles));
    if (p->cell != 1.0) GN_TRY(put_cells(q, s, p->cell, error));
    if (s->step > 0.0) GN_TRY(put(q, error, "time.step", "auto"));
    if (fabs(p->safety - s->safety) > 1e-9) GN_TRY(put(q, error, "time.safety", "%g", p->safety));
    if (p->mixed != (s->precision == GN_PRECISION_MIXED))
        GN_TRY(put(q, error, "run.precision", "%s", p->mixed ? "mixed" : "double"));
    if (p->first_break != (s->start == GN_START_FIRST_BREAK))
        GN_TRY(put(q, error, "time.start", "%s", p->first_break ? "first_break" : "rest"));
    return put_masses(q, plan, s, p, error);
}
