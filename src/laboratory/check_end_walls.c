/* How walls that are ends of a test stand to its specimen at the start. */
#include "base/point.h"
#include "base/vec3.h"
#include "frame/step_context.h"
#include "laboratory/ends.h"
#include "particles/dem.h"
#include "particles/observe.h"
#include "scene/laboratory.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "solids/elements.h"
#include "world/world.h"

#include <math.h>
#include <stdio.h>

/* A flat of a disc takes little of it: one of 30 degrees 1.7 % of the diameter. */
static const double deep = 0.025, far = 0.1, tilted = 2.0; /* shares of the extent, degrees */

static int way_of(const gn_step_context *ctx) {
    return (int)ctx->scene.test.axis;
}

/* Walls of an end: their mean normal along the axis, over its length; 1: there are none. */
static double cosine_of(const gn_step_context *ctx, const gn_test_end *end) {
    double sum[3] = {0.0};
    size_t walls = 0;
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(&ctx->scene, end->name[k]);
        for (int a = 0; wall >= 0 && a < 3; a++) sum[a] += ctx->scene.walls[wall].normal[a];
        walls += wall >= 0;
    }
    const double length = sqrt(gn_dot3(sum, sum));
    return walls && length > 0.0 ? fmin(1.0, fabs(sum[way_of(ctx)]) / length) : 1.0;
}

/* m by which a wall is inside the specimen, below 0 outside of it. */
static double depth_of(const gn_step_context *ctx, const gn_wall_def *wall) {
    const int way = way_of(ctx);
    return wall->normal[way] > 0.0 ? wall->point[way] - ctx->lower[way]
                                   : ctx->upper[way] - wall->point[way];
}

/* What falls, comes in, is set or is brought by a servo gets there by itself. */
static bool may_come(const gn_step_context *ctx, const gn_wall_def *wall) {
    const gn_scene *s = &ctx->scene;
    return wall->servo.active || s->source_count || gn_dot3(s->gravity, s->gravity) > 0.0;
}

static bool doubt_of_wall(const gn_step_context *ctx, const gn_dem *dem, const gn_wall_def *wall,
                          char *text, size_t size) {
    const int way = way_of(ctx);
    const double extent = ctx->upper[way] - ctx->lower[way], depth = depth_of(ctx, wall),
                 radius = dem->particles.soa.count ? gn_dem_mean_radius(dem) : 0.0;
    const bool inside = depth > fmax(deep * extent, radius),
               outside = -depth > fmax(far * extent, radius) && !may_come(ctx, wall);
    if (fabs(wall->normal[way]) <= 0.9 || (!inside && !outside)) return false;
    snprintf(text, size,
             "wall '%.60s', an end, begins %.4g m %s the specimen, which is %.4g m long along %c",
             wall->name, fabs(depth), inside ? "inside" : "away from", extent, "xyz"[way]);
    return true;
}

static bool doubt_of_end(const gn_step_context *ctx, const gn_dem *dem, const gn_test_end *end,
                         char *text, size_t size) {
    const double tilt = acos(cosine_of(ctx, end)) * 180.0 / M_PI;
    for (size_t k = 0; k < end->count; k++) {
        const int wall = gn_scene_find_wall(&ctx->scene, end->name[k]);
        if (wall < 0) continue;
        if (doubt_of_wall(ctx, dem, &ctx->scene.walls[wall], text, size)) return true;
        if (tilt <= tilted) continue;
        snprintf(text, size,
                 "wall '%.60s', an end, is tilted by %.3g degrees against the axis of the test, %c",
                 end->name[k], tilt, "xyz"[way_of(ctx)]);
        return true;
    }
    return false;
}

bool gn_ends_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                    char *text, size_t size) {
    const gn_test *t = &ctx->scene.test;
    const gn_test_end *ends[] = {&t->lower, &t->upper};
    char doubt[240];
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    if (!d->ends || d->sign > 0 || d->beam) return false;
    /* What begins loose is another specimen once stages have settled and bonded it. */
    if (ctx->given.stage_count && ctx->given.bonds != GN_SWITCH_ON) return false;
    /* Of particles beside elements either may be what is tested. */
    if (!dem->particles.soa.count == !solids->count) return false;
    for (int e = 0; e < 2; e++) {
        if (!doubt_of_end(ctx, dem, ends[e], doubt, sizeof doubt)) continue;
        const gn_scene_place where = ends[e]->where.line ? ends[e]->where : t->where;
        snprintf(text, size, "%s: %s",
                 gn_scene_at(&ctx->scene, where, e ? "test.upper" : "test.lower").text, doubt);
        return true;
    }
    return false;
}
