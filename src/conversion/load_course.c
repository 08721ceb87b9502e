#include "conversion/load_course.h"

#include "base/error.h"
#include "base/memory.h"
#include "frame/step_context.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "scene/table.h"
#include "solids/elements.h"
#include "timestep/step_limit.h"
#include "world/world.h"

#include <math.h>
#include <stdlib.h>

/* --- how long parts last --- */

static bool is_open(const gn_stage *e) {
    return e->strain > 0.0 || e->stress > 0.0 || e->peak_drop > 0.0 || e->unbalanced > 0.0 ||
           e->held > 0.0;
}

static bool table_varies(const gn_table *table) {
    return table->count > 1;
}

/* Whether elements are moved or loaded otherwise later on in a part than at its start. */
static bool goes_on(const gn_scene *s) {
    const gn_element_def *e = &s->elements;
    for (size_t k = 0; k < e->motion_count; k++)
        for (int a = 0; a < 3; a++) {
            const gn_table *v = &e->motions[k].motion.velocity[a];
            if (table_varies(v) || (v->count && v->value[0] != 0.0)) return true;
        }
    for (size_t k = 0; k < e->load_count; k++)
        for (int a = 0; a < 3; a++)
            if (table_varies(&e->loads[k].force[a]) || table_varies(&e->loads[k].traction[a]))
                return true;
    return false;
}

/* s: of a step of elements alone, their sharp limit being what it is; the first part has the
 * world's. */
static double step_of(const gn_step_context *ctx, const gn_solids *solids, const gn_scene *s) {
    if (s == &ctx->scene) return ctx->dt;
    if (s->step > 0.0) return s->step;
    return s->safety * gn_scene_nonviscous_share(s, gn_scene_effects(s)) *
           gn_elements_stable(solids);
}

static void set_end(const gn_step_context *ctx, const gn_solids *solids, double settle, size_t k,
                    gn_course_part *p) {
    const gn_stage *e = &ctx->given.stages[k];
    double length = INFINITY;
    if (e->time >= 0.0) length = e->time;
    p->dt = step_of(ctx, solids, p->scene);
    if (e->steps >= 0) length = fmin(length, (double)e->steps * p->dt);
    p->open = is_open(e);
    p->guessed = p->open && length == INFINITY && !goes_on(p->scene);
    if (p->guessed) length = settle;
    p->end = fmin(p->begin + length, ctx->scene.end);
}

/* --- making it --- */

static gneiss_status scene_of(gn_world *w, size_t k, double begin, gn_scene **scene,
                              gneiss_error *error) {
    *scene = calloc(1, sizeof **scene); /* too large for a stack */
    if (!*scene) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a stage");
    const size_t stage = w->stages.now;
    w->stages.now = k;
    w->stages.state[k].time = begin;
    gneiss_status status = gn_stages_scene(w, *scene, error);
    w->stages.now = stage;
    if (status == GNEISS_OK) return status;
    free(*scene);
    *scene = NULL;
    return status;
}

static gneiss_status add_stage(gn_world *w, double settle, gn_course *c, gneiss_error *error) {
    gn_course_part *p = &c->part[c->count];
    *p = (gn_course_part){.scene = &w->ctx.scene, .begin = c->count ? p[-1].end : w->ctx.time};
    if (c->count) GN_TRY(scene_of(w, c->count, p->begin, &p->scene, error));
    set_end(&w->ctx, &w->solids, settle, c->count++, p);
    return GNEISS_OK;
}

gneiss_status gn_course_make(gn_world *w, double settle, gn_course *c, gneiss_error *error) {
    const size_t stages = w->ctx.scene.stage_count;
    gneiss_status status = GNEISS_OK;
    *c = (gn_course){.part = gn_alloc_array(stages + 1, sizeof *c->part)};
    if (!c->part) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu stages", stages);
    if (!stages) {
        c->part[c->count++] = (gn_course_part){
            .scene = &w->ctx.scene, .begin = w->ctx.time, .end = w->ctx.scene.end, .dt = w->ctx.dt};
        return GNEISS_OK;
    }
    while (status == GNEISS_OK && c->count < stages &&
           (c->count == 0 || gn_course_end(c) < w->ctx.scene.end))
        status = add_stage(w, settle, c, error);
    for (size_t k = 1; k < c->count; k++) w->stages.state[k].time = 0.0;
    return status;
}

void gn_course_free(gn_course *c) {
    for (size_t k = 1; k < c->count; k++) {
        if (c->part[k].scene) gn_scene_free(c->part[k].scene);
        free(c->part[k].scene);
    }
    gn_free(c->part);
    *c = (gn_course){0};
}

double gn_course_end(const gn_course *c) {
    return c->part[c->count - 1].end;
}

static double path_in(const gn_course *c, size_t k, size_t part, const gn_table *velocity,
                      double time) {
    const gn_course_part *p = &c->part[k];
    return gn_table_between(velocity, p->begin, k < part ? p->end : fmin(time, p->end));
}

double gn_course_path(const gn_course *c, size_t part, size_t motion, size_t component,
                      double time) {
    double path = 0.0;
    for (size_t k = 0; k <= part; k++) {
        const gn_element_motion *m = &c->part[k].scene->elements.motions[motion];
        path += path_in(c, k, part, &m->motion.velocity[component], time);
    }
    return path;
}

double gn_course_wall_path(const gn_course *c, size_t part, size_t wall, size_t component,
                           double time) {
    double path = 0.0;
    for (size_t k = 0; k <= part; k++) {
        const gn_wall_def *d = &c->part[k].scene->walls[wall];
        if (!d->servo.active) path += path_in(c, k, part, &d->motion.velocity[component], time);
    }
    return path;
}

static double velocity_at(const gn_course *c, size_t motion, size_t component, double time) {
    size_t at = 0;
    if (time < c->part[0].begin) return 0.0;
    while (at + 1 < c->count && time >= c->part[at + 1].begin) at++;
    return gn_table_at(&c->part[at].scene->elements.motions[motion].motion.velocity[component],
                       time);
}

/* Between two points of a table, or of two tables, it is largest at one of them. */
static double jump_about(const gn_course *c, size_t motion, size_t component, double time,
                         double within) {
    double most = 0.0;
    for (int k = 0; k < 2; k++, time += within)
        most = fmax(most, fabs(velocity_at(c, motion, component, time) -
                               velocity_at(c, motion, component, time - within)));
    return most;
}

double gn_course_jump(const gn_course *c, double within) {
    double most = 0.0;
    for (size_t k = 0; k < c->count; k++) {
        const gn_course_part *p = &c->part[k];
        const gn_element_def *e = &p->scene->elements;
        for (size_t m = 0; m < e->motion_count; m++)
            for (size_t a = 0; a < 3; a++) {
                const gn_table *v = &e->motions[m].motion.velocity[a];
                most = fmax(most, jump_about(c, m, a, p->begin, within));
                for (size_t n = 0; n < v->count; n++)
                    if (v->time[n] >= p->begin && v->time[n] <= p->end)
                        most = fmax(most, jump_about(c, m, a, v->time[n], within));
            }
    }
    return most;
}
