/* Where the ends of a test begin away from the specimen, their way through the air is no strain. */
#include "boundary/boundary.h"
#include "boundary/surface_lists.h"
#include "frame/step_context.h"
#include "laboratory/ends.h"
#include "laboratory/geometry.h"
#include "particles/dem.h"
#include "particles/observe.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "world/world.h"

#include <math.h>

/* Nearer than this share of a mean radius (without particles, of the length) an end touches. */
static const double touching = 1e-3, touching_elements = 1e-6;

/* m from the specimen to a wall that stands across the axis. `sense` +1: the lower end. */
static double wall_gap(const gn_step_context *ctx, const gn_wall_def *wall, double sense,
                       double surface) {
    const int axis = (int)ctx->scene.test.axis;
    return sense * wall->normal[axis] > 0.99 ? sense * (surface - wall->point[axis]) : 0.0;
}

/* m to the plane across the axis that touches a body, so that it is no more than the gap. */
static double body_gap(const gn_step_context *ctx, const gn_boundary *boundary, size_t body,
                       double sense, double surface) {
    const int axis = (int)ctx->scene.test.axis;
    size_t first = 0;
    double gap = INFINITY;
    if (!boundary->body_vertex) return 0.0;
    for (size_t k = 0; k < body; k++) first += (size_t)boundary->body_shape[k][0];
    for (size_t n = first; n < first + (size_t)boundary->body_shape[body][0]; n++) {
        double corner[3];
        gn_rigid_place(&boundary->bodies[body], boundary->body_vertex + 4 * n, corner);
        gap = fmin(gap, sense * (surface - corner[axis]));
    }
    return gap;
}

/* The least of all parts: sets and motions are in the specimen. */
static double end_gap(const gn_step_context *ctx, const gn_boundary *boundary,
                      const gn_solids *solids, const gn_test_end *end, double sense) {
    const gn_scene *s = &ctx->scene;
    double lower[3], upper[3], gap = INFINITY;
    gn_world_body(ctx, solids, lower, upper);
    const double surface = sense > 0.0 ? lower[s->test.axis] : upper[s->test.axis];
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(s, end->name[k]),
                  body = gn_scene_find_body(s, end->name[k]);
        double part = 0.0;
        if (wall >= 0) part = wall_gap(ctx, &s->walls[wall], sense, surface);
        if (body >= 0) part = body_gap(ctx, boundary, (size_t)body, sense, surface);
        gap = fmin(gap, part);
    }
    if (gap > 0.0 && s->has_specimen && !s->specimen_given) return INFINITY; /* yet to come in */
    return gap;
}

/* m: of how much it may be away and still count as touching. Loose grains fill the space between
 * their walls: they touch nothing, and the nearest wall no less than each other. */
static double allowed_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids) {
    const double count = (double)dem->particles.soa.count, d = (double)ctx->scene.dimension;
    if (!(count > 0.0))
        return touching_elements * gn_world_side(ctx, solids, (int)ctx->scene.test.axis);
    if (ctx->effects & GN_FX_BONDS) return touching * gn_dem_mean_radius(dem);
    return pow(ctx->volume / count, 1.0 / d);
}

void gn_ends_gaps(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                  const gn_solids *solids, double *lower, double *upper, bool away[2]) {
    const gn_test *t = &ctx->scene.test;
    *lower = *upper = 0.0;
    away[0] = away[1] = false;
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    if (!d->ends || d->sign > 0) return;
    const double allowed = allowed_gap(ctx, dem, solids);
    *lower = fmax(0.0, end_gap(ctx, boundary, solids, &t->lower, 1.0));
    *upper = fmax(0.0, end_gap(ctx, boundary, solids, &t->upper, -1.0));
    away[0] = *lower > allowed;
    away[1] = *upper > allowed;
}

void gn_ends_begin(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   const gn_solids *solids, gn_approach *approach) {
    double lower, upper;
    bool away[2];
    gn_ends_gaps(ctx, dem, boundary, solids, &lower, &upper, away);
    *approach = (gn_approach){.away = {away[0], away[1]},
                              .gap = (away[0] ? lower : 0.0) + (away[1] ? upper : 0.0)};
}

void gn_ends_look(gn_world *w, bool still) {
    gn_approach *a = &w->approach;
    double lower, upper;
    if (a->away[0] == 0.0 && a->away[1] == 0.0) return;
    gn_ends_forces(w, &lower, &upper);
    /* Both in one step: what one end has thrown off flies to the other. */
    if ((a->away[0] != 0.0 && lower == 0.0) || (a->away[1] != 0.0 && upper == 0.0)) return;
    a->away[0] = a->away[1] = 0.0;
    a->way = gn_ends_deflection(w);
    if (still) a->way = fmin(a->way, a->gap);
}

double gn_ends_shortening(const gn_world *w) {
    const gn_approach *a = &w->approach;
    return a->away[0] != 0.0 || a->away[1] != 0.0 ? 0.0 : gn_ends_deflection(w) - a->way;
}
