/* Whether an oedometer holds its specimen at both sides, where the specimen is. */
#include "laboratory/ends.h"
#include "particles/observe.h"
#include "scene/acts.h"

#include "base/error.h"
#include "base/point.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "boundary/surface_lists.h"
#include "fem/solid.h"
#include "frame/step_context.h"
#include "particles/dem.h"
#include "particles/sets.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "solids/elements.h"
#include "world/world.h"

#include <math.h>

/* What is farther from the specimen than this share of its width, or a particle, holds nothing. */
static const double near_by = 0.1;

static double reach_beside(const gn_step_context *ctx, const gn_dem *dem, int a) {
    const double share = near_by * (ctx->upper[a] - ctx->lower[a]);
    return dem->particles.soa.count ? fmax(share, 2.0 * gn_dem_mean_radius(dem)) : share;
}

/* sense -1: the lower side, +1: the upper one. */
static double face(const gn_step_context *ctx, int a, int sense) {
    return sense < 0 ? ctx->lower[a] : ctx->upper[a];
}

static bool wall_beside(const gn_step_context *ctx, const gn_dem *dem, size_t wall, int a,
                        int sense) {
    const gn_wall_def *def = &ctx->scene.walls[wall];
    const gn_particles *q = &dem->particles;
    double gap = INFINITY;
    if (!gn_scene_wall_is_fixed(&ctx->scene, wall, a) || -sense * def->normal[a] <= 0.1)
        return false;
    for (size_t p = 0; p < q->soa.count; p++) {
        double d[3];
        for (int b = 0; b < 3; b++) d[b] = q->pos[4 * p + b] - def->point[b];
        gap = fmin(gap, gn_dot3(d, def->normal) - q->pos[4 * p + 3]);
    }
    if (!q->soa.count) gap = sense * (def->point[a] - face(ctx, a, sense));
    return gap <= reach_beside(ctx, dem, a);
}

static bool body_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        size_t body, int a, int sense) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    size_t first = 0;
    if (!gn_scene_body_is_fixed(&ctx->scene, body, a)) return false;
    for (size_t k = 0; k < body; k++) first += (size_t)boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)boundary->body_shape[body][0]; n++) {
        double corner[3];
        gn_rigid_place(&boundary->bodies[body], boundary->body_vertex + 4 * n, corner);
        for (int b = 0; b < 3; b++) low[b] = fmin(low[b], corner[b]);
        for (int b = 0; b < 3; b++) high[b] = fmax(high[b], corner[b]);
    }
    const double at = face(ctx, a, sense);
    bool beside =
        low[a] <= at + reach_beside(ctx, dem, a) && high[a] >= at - reach_beside(ctx, dem, a);
    for (int b = 0; b < (int)ctx->scene.dimension; b++)
        beside = beside && low[b] <= ctx->upper[b] + reach_beside(ctx, dem, b) &&
                 high[b] >= ctx->lower[b] - reach_beside(ctx, dem, b);
    return beside;
}

static bool at_face(const gn_step_context *ctx, const gn_dem *dem, double x, int a, int sense) {
    return sense * (face(ctx, a, sense) - x) <= reach_beside(ctx, dem, a);
}

static bool set_beside(const gn_step_context *ctx, const gn_dem *dem, size_t set, int a,
                       int sense) {
    const gn_particles *q = &dem->particles;
    bool beside = false;
    if (!gn_scene_set_is_fixed(&ctx->scene, set, a)) return false;
    for (size_t p = 0; p < q->soa.count; p++)
        beside = beside || (gn_set_selected(ctx, dem, set, p) &&
                            at_face(ctx, dem, q->start[4 * p + a], a, sense));
    return beside;
}

static bool motion_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                          size_t motion, int a, int sense) {
    const gn_particles *nodes;
    const gn_fem_set *set = gn_elements_motion_set(solids, motion, &nodes);
    bool beside = false;
    if (!gn_scene_motion_is_fixed(&ctx->scene, motion, a)) return false;
    for (size_t k = 0; k < set->count; k++)
        beside = beside ||
                 at_face(ctx, dem, nodes->start[4 * (size_t)set->node[k] + (size_t)a], a, sense);
    return beside;
}

static bool held_beside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, int a, int sense) {
    const gn_scene *s = &ctx->scene;
    bool held = false;
    for (size_t k = 0; !held && k < s->wall_count; k++) held = wall_beside(ctx, dem, k, a, sense);
    for (size_t k = 0; !held && k < s->body_count; k++)
        held = body_beside(ctx, dem, boundary, k, a, sense);
    for (size_t k = 0; !held && k < s->set_count; k++) held = set_beside(ctx, dem, k, a, sense);
    for (size_t k = 0; !held && k < s->elements.motion_count; k++)
        held = motion_beside(ctx, dem, solids, k, a, sense);
    return held;
}

gneiss_status gn_sides_check(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_solids *solids,
                             gneiss_error *error) {
    const gn_scene *s = &ctx->scene;
    /* Stages may bring sides closer; elements beside particles may be what holds them. */
    if (!gn_scene_test(s)->sides_stand || s->stage_count || s->source_count ||
        (s->has_specimen && solids->count))
        return GNEISS_OK;
    for (int a = 0; a < (int)s->dimension; a++)
        for (int sense = -1; sense <= 1; sense += 2) {
            if (a == s->test.axis || gn_scene_periodic_along(s, a) ||
                held_beside(ctx, dem, boundary, solids, a, sense))
                continue;
            return gn_fail(error, GNEISS_ERROR_INPUT,
                           "%s: expected something that stands beside the specimen of an %s "
                           "test at its %s side along %c, %.4g m (a wall, a body, a set that is "
                           "held there), found none within %.2g m",
                           gn_scene_at(s, s->test.where, "test.kind").text, gn_scene_test(s)->name,
                           sense < 0 ? "lower" : "upper", "xyz"[a],
                           gn_point_out(s->origin[a], face(ctx, a, sense)),
                           reach_beside(ctx, dem, a));
        }
    return GNEISS_OK;
}
