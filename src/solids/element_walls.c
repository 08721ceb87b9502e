#include "solids/element_walls.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "conversion/conversion.h"
#include "conversion/load_course.h"
#include "conversion/rest_state.h"
#include "fem/solid.h"
#include "frame/step_context.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/elements.h"
#include "world/world.h"
#include "zones/zones_private.h"

#include <math.h>
#include <string.h>

/* Of the longest side of the body: nearer is on the wall. */
static const double on_wall = 1e-6;

/* A plane that nodes are held against. */
typedef struct plane {
    double point[3], normal[3], near; /* m */
} plane;

static double near_of(const gn_step_context *ctx, const gn_solids *solids) {
    return on_wall * gn_elements_longest_side(ctx, solids);
}

static double gap_of(const gn_fem_solid *b, const plane *p, size_t n) {
    double gap = 0.0;
    for (int a = 0; a < b->dimension; a++)
        gap += (b->nodes.pos[4 * n + (size_t)a] - p->point[a]) * p->normal[a];
    return gap;
}

/* Whether a motion holds a node along a wall's normal. */
static bool is_held(const gn_fem_solid *b, const plane *p, size_t n) {
    const int32_t slot = b->prescribed.count ? b->nodes.slot[n] : -1;
    for (int a = 0; slot >= 0 && a < b->dimension; a++)
        if (p->normal[a] != 0.0 && b->channel[slot][a] < 0) return false;
    return slot >= 0;
}

/* Marks the nodes of elements that are there. */
static uint8_t *find_nodes(const gn_fem_solid *b) {
    uint8_t *used = gn_alloc(b->nodes.soa.count + 1);
    for (size_t e = 0; used && e < b->elements.soa.count; e++)
        for (int a = 0; a <= b->dimension; a++) used[gn_elements_node(&b->elements, a)[e]] = 1;
    return used;
}

/* Who is on it and behind it; *least: m, the smallest gap. */
static gn_wall_passed look(const gn_fem_solid *b, const uint8_t *used, const plane *p,
                           double *least) {
    gn_wall_passed found = {0};
    *least = INFINITY;
    for (size_t n = 0; n < b->nodes.soa.count; n++) {
        if (!used[n]) continue;
        const double gap = gap_of(b, p, n);
        *least = fmin(*least, gap);
        found.touching += fabs(gap) <= p->near && !is_held(b, p, n);
        if (gap >= -p->near) continue;
        found.behind++;
        found.deepest = fmax(found.deepest, -gap);
    }
    return found;
}

gn_wall_passed gn_wall_passed_now(const gn_step_context *ctx, const gn_boundary *boundary,
                                  const gn_solids *solids, size_t wall) {
    const gn_fem_solid *b = gn_coupled_solid(solids);
    const gn_wall *at = &boundary->walls[wall];
    plane p = {.near = near_of(ctx, solids)};
    double least;
    uint8_t *used = find_nodes(b);
    gn_wall_passed found = {.time = ctx->time};
    for (int a = 0; a < 3; a++) {
        p.point[a] = at->point[a];
        p.normal[a] = at->normal[a];
    }
    if (used) found = look(b, used, &p, &least);
    found.time = ctx->time;
    gn_free(used);
    return found;
}

/* --- before a run --- */

typedef struct foresight {
    gn_rest *rest;
    const uint8_t *used;
    double near, blur;
    gn_wall_passed *passed; /* [walls] */
    double *least;          /* [walls] m, gaps at the last look */
    double last;            /* s, of it */
} foresight;

/* m: the solution is known to a part of what it moves. */
static double blur_of(const gn_fem_solid *b) {
    const double known = 1e-4;
    double most = 0.0;
    for (size_t n = 0; n < b->nodes.soa.count; n++) {
        double d[3];
        for (size_t a = 0; a < 3; a++) d[a] = b->nodes.pos[4 * n + a] - b->nodes.start[4 * n + a];
        most = fmax(most, gn_dot3(d, d));
    }
    return known * sqrt(most);
}

static plane plane_at(const foresight *q, size_t wall, size_t part, double time) {
    const gn_wall_def *def = &q->rest->w->ctx.scene.walls[wall];
    plane p = {.near = q->near + q->blur};
    for (size_t a = 0; a < 3; a++) {
        p.point[a] = def->point[a] + gn_course_wall_path(&q->rest->course, part, wall, a, time);
        p.normal[a] = def->normal[a];
    }
    return p;
}

/* Whoever nothing holds goes u = 1/2 f/m t^2. */
static void put_at(const foresight *q, size_t part, double time) {
    if (time > 0.0) q->rest->inertia = 2.0 / (time * time);
    gn_rest_find(q->rest, part, time);
    gn_rest_put(q->rest, time > 0.0 ? 1.0 : 0.0);
}

static void look_at_walls(foresight *q, size_t part, double time) {
    const gn_world *w = q->rest->w;
    put_at(q, part, time);
    q->blur = blur_of(gn_coupled_solid(&w->solids));
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++) {
        const plane p = plane_at(q, k, part, time);
        gn_wall_passed *to = &q->passed[k];
        double least;
        const gn_wall_passed now = look(gn_coupled_solid(&w->solids), q->used, &p, &least);
        if (time == 0.0) to->touching = now.touching;
        if (now.behind && !to->behind) {
            const double before = fmax(q->least[k], 0.0);
            to->time = time - (time - q->last) * least / fmin(least - before, -p.near);
        }
        if (now.behind > to->behind) to->behind = now.behind;
        to->deepest = fmax(to->deepest, now.deepest);
        q->least[k] = least;
    }
    q->last = time;
}

static gneiss_status foresee(foresight *q, gneiss_error *error) {
    enum { LOOKS = 8 };
    const gn_course *c = &q->rest->course;
    q->least = gn_alloc_array(q->rest->w->ctx.scene.wall_count + 1, sizeof *q->least);
    if (!q->least) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to look at walls");
    for (size_t part = 0; part < c->count; part++)
        for (int k = part > 0; k <= LOOKS; k++) {
            const gn_course_part *p = &c->part[part];
            look_at_walls(q, part, p->begin + (p->end - p->begin) * k / LOOKS);
        }
    gn_free(q->least);
    return GNEISS_OK;
}

/* With the nodes put back where they were, which may be off their start. */
static gneiss_status foresee_and_return(foresight *q, gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(&q->rest->w->solids);
    const size_t size = 4 * b->nodes.soa.count;
    double *place = gn_alloc_array_raw(size + 1, sizeof *place);
    if (!place) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for places of nodes");
    memcpy(place, b->nodes.pos, size * sizeof *place);
    gneiss_status status = foresee(q, error);
    memcpy(b->nodes.pos, place, size * sizeof *place);
    gn_fem_positions_changed(b);
    gn_free(place);
    return status;
}

gneiss_status gn_wall_foresee_passed(gn_world *w, gn_wall_passed *passed, gneiss_error *error) {
    const gn_fem_solid *b = gn_coupled_solid(&w->solids);
    gn_course course = {0};
    gn_rest rest = {0};
    foresight q = {.rest = &rest, .near = near_of(&w->ctx, &w->solids), .passed = passed};
    for (size_t k = 0; k < w->ctx.scene.wall_count; k++) passed[k] = (gn_wall_passed){0};
    if (b->form != GN_FEM_DISPLACEMENT) {
        for (size_t k = 0; k < w->ctx.scene.wall_count; k++)
            passed[k] = gn_wall_passed_now(&w->ctx, &w->boundary, &w->solids, k);
        return GNEISS_OK;
    }
    uint8_t *used = find_nodes(b);
    gneiss_status status =
        used ? gn_course_make(w, GN_SETTLING * gn_wave_travel(&w->ctx, &w->solids), &course, error)
             : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to look at walls");
    q.used = used;
    if (status == GNEISS_OK) status = gn_rest_make(w, &course, &rest, error);
    rest.unloaded = !gn_converts(&w->ctx);
    if (status == GNEISS_OK) status = foresee_and_return(&q, error);
    gn_rest_free(&rest);
    gn_course_free(&course);
    gn_free(used);
    return status;
}
