#include "solids/element_walls.h"

#include "base/error.h"
#include "base/memory.h"
#include "boundary/boundary.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "scene/scene.h"
#include "scene/stages.h"
#include "soa/records.h"
#include "solids/solids.h"

#include <math.h>
#include <string.h>

/* Largest distance of nodes that are on a wall, over the longest side of the body. */
static const double on_wall = 1e-6;

/* A plane on which nodes are held. */
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

/* Tells whether a motion holds a node along a wall's normal. */
static bool is_held(const gn_fem_solid *b, const plane *p, size_t n) {
    const int32_t slot = b->prescribed.count ? b->nodes.slot[n] : -1;
    for (int a = 0; slot >= 0 && a < b->dimension; a++)
        if (p->normal[a] != 0.0 && b->channel[slot][a] < 0) return false;
    return slot >= 0;
}

/* Marks the nodes of the remaining elements. */
static uint8_t *find_nodes(const gn_fem_solid *b) {
    uint8_t *used = gn_alloc(b->nodes.soa.count + 1);
    for (size_t e = 0; used && e < b->elements.soa.count; e++)
        for (int a = 0; a <= b->dimension; a++) used[gn_elements_node(&b->elements, a)[e]] = 1;
    return used;
}

/* Counts nodes on and behind the plane. *least: the smallest gap, m. */
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

/* Adds the paths of motions from the start to a time to the positions of the driven nodes, m. */
static void move_driven(gn_element_model *q, double time) {
    gn_fem_solid *b = &q->solid;
    for (size_t n = 0; b->prescribed.count && n < b->nodes.soa.count; n++)
        for (size_t a = 0, k; b->nodes.slot[n] >= 0 && a < (size_t)b->dimension; a++) {
            const int32_t motion = b->channel[b->nodes.slot[n]][a];
            for (k = 0; k < q->def->motion_count && q->motion[k] != motion;) k++;
            if (motion < 0 || k == q->def->motion_count) continue;
            b->nodes.pos[4 * n + a] =
                b->nodes.start[4 * n + a] +
                gn_table_between(&q->def->motions[k].motion.velocity[a], 0.0, time);
        }
}

static plane plane_at(const gn_step_context *ctx, const gn_solids *solids, size_t wall,
                      double time) {
    const gn_wall_def *def = &ctx->scene.walls[wall];
    plane p = {.near = near_of(ctx, solids)};
    for (size_t a = 0; a < 3; a++) {
        p.point[a] = def->point[a];
        p.normal[a] = def->normal[a];
        if (!def->servo.active) p.point[a] += gn_table_between(&def->motion.velocity[a], 0.0, time);
    }
    return p;
}

/* Moves driven nodes to their positions at the last time. */
static gn_wall_passed predict(const gn_step_context *ctx, const gn_solids *solids,
                              const uint8_t *used, const uint8_t *driven, size_t wall) {
    enum { TIMES = 8 };
    gn_wall_passed found = {0};
    double before = 0.0, end = ctx->scene.end;
    /* Later stages may have other motions. */
    if (ctx->given.stage_count && ctx->given.stages[0].time >= 0.0)
        end = fmin(end, ctx->given.stages[0].time);
    for (int k = 0; k <= TIMES; k++) {
        const double time = end * k / TIMES;
        const plane p = plane_at(ctx, solids, wall, time);
        double least;
        move_driven(solids->elements[0], time);
        const gn_wall_passed now = look(gn_coupled_solid(solids), k ? driven : used, &p, &least);
        if (k == 0) found.touching = now.touching;
        if (k && now.behind && !found.behind)
            found.time = time - end / TIMES * least / fmin(least - fmax(before, 0.0), -p.near);
        found.behind = now.behind > found.behind ? now.behind : found.behind;
        found.deepest = fmax(found.deepest, now.deepest);
        before = least;
    }
    return found;
}

gneiss_status gn_wall_predict_passed(const gn_step_context *ctx, const gn_solids *solids,
                                     gn_wall_passed *passed, gneiss_error *error) {
    gn_fem_solid *b = gn_coupled_solid(solids);
    const size_t nodes = b->nodes.soa.count, size = 4 * nodes * sizeof *b->nodes.pos;
    uint8_t *used = find_nodes(b), *driven = gn_alloc(nodes + 1);
    double *place = gn_alloc_array_raw(4 * nodes + 1, sizeof *place);
    const bool memory = used && driven && place;
    for (size_t n = 0; memory && n < nodes; n++)
        driven[n] = used[n] && b->prescribed.count && b->nodes.slot[n] >= 0;
    if (memory) memcpy(place, b->nodes.pos, size);
    for (size_t k = 0; memory && k < ctx->scene.wall_count; k++)
        passed[k] = predict(ctx, solids, used, driven, k);
    if (memory) memcpy(b->nodes.pos, place, size);
    gn_free(used);
    gn_free(driven);
    gn_free(place);
    return memory ? GNEISS_OK : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to check walls");
}
