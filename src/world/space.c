#include "world/space.h"

#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "laboratory/ends.h"
#include "membrane/membrane.h"
#include "particles/flow.h"
#include "particles/particles.h"
#include "scene/acts.h"
#include "scene/laboratory.h"
#include "scene/scene.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>

/* Distances of two walls, or of the sides of a periodic box, along an axis, m. */
typedef struct span {
    double lower, upper; /* present positions of the sides */
    double now, start;   /* 0: not applicable */
} span;

/* Returns the displacement of a wall since the start along an axis, m. */
static double moved(const gn_boundary *boundary, int wall, int axis) {
    if (!boundary->walls) return 0.0;
    return boundary->walls[wall].point[axis] - boundary->walls[wall].start[axis];
}

static span span_along(const gn_step_context *ctx, const gn_boundary *boundary,
                       const gn_periodic_box *box, int axis) {
    const gn_scene *s = &ctx->scene;
    if (gn_scene_periodic_along(s, axis))
        return (span){-INFINITY, INFINITY, ctx->period[axis], box->start[axis]};
    const int lower = gn_scene_wall_facing(s, axis, 1.0),
              upper = gn_scene_wall_facing(s, axis, -1.0);
    if (lower < 0 || upper < 0) return (span){0};
    const double low = s->walls[lower].point[axis], high = s->walls[upper].point[axis];
    span x = {low + moved(boundary, lower, axis), high + moved(boundary, upper, axis), 0.0,
              high - low};
    x.now = x.upper - x.lower;
    return x;
}

/* Finds the extent of active particles, radii included. */
static bool extent_along(const gn_dem *dem, int axis, double *lower, double *upper) {
    const gn_particles *q = &dem->particles;
    *lower = INFINITY;
    *upper = -INFINITY;
    for (size_t p = 0; p < q->soa.count; p++) {
        if (!gn_particle_is_active(q, p)) continue;
        const double *x = q->pos + 4 * p;
        *lower = fmin(*lower, x[axis] - x[3]);
        *upper = fmax(*upper, x[axis] + x[3]);
    }
    return *lower < *upper;
}

/* Returns the largest gap, m, between specimen and walls that enclose it; with a larger gap the
 * volume between the walls is not that of the specimen. Loose grains may be as far from walls as
 * from each other. */
static double allowed_gap(const gn_step_context *ctx, const gn_dem *dem, double between) {
    if (ctx->effects & GN_FX_BONDS) return gn_dem_mean_radius(dem);
    return pow(between / (double)gn_dem_present_count(dem), 1.0 / (double)ctx->scene.dimension);
}

bool gn_space_closed(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box, double *now, double *start) {
    const int dimension = (int)ctx->scene.dimension;
    span side[3];
    *now = *start = 1.0;
    if (!ctx->scene.has_specimen || !gn_dem_present_count(dem)) return false;
    for (int a = 0; a < dimension; a++) {
        side[a] = span_along(ctx, boundary, box, a);
        if (!(side[a].now > 0.0 && side[a].start > 0.0)) return false;
        *now *= side[a].now;
        *start *= side[a].start;
    }
    const double allowed = allowed_gap(ctx, dem, *now);
    for (int a = 0; a < dimension; a++) {
        double lower, upper;
        if (gn_scene_periodic_along(&ctx->scene, a)) continue;
        if (!extent_along(dem, a, &lower, &upper)) return false;
        if (lower - side[a].lower > allowed || side[a].upper - upper > allowed) return false;
    }
    return true;
}

static bool is_periodic_all_round(const gn_step_context *ctx) {
    return ctx->effects & GN_FX_PERIODIC && !gn_scene_half_periodic(&ctx->scene);
}

/* Returns the growth of the volume inside a membrane; several bodies under one membrane move apart.
 * */
static double membrane_growth(const gn_membrane *membrane) {
    const double *f = membrane->state->gradient;
    double cofactor[9];
    if (membrane->state->bodies != 1) return 1.0;
    gn_cofactor3(f, cofactor);
    const double growth = gn_dot3(f, cofactor);
    return growth > 0.0 ? growth : 1.0;
}

double gn_space_volume(const gn_step_context *ctx, const gn_dem *dem, const gn_membrane *membrane,
                       const gn_boundary *boundary, const gn_solids *solids,
                       const gn_periodic_box *box, const gn_approach *approach) {
    double now, start;
    if (membrane->state) return gn_membrane_volume(ctx, membrane) * membrane_growth(membrane);
    if (is_periodic_all_round(ctx) || !ctx->scene.has_specimen) return ctx->volume;
    if (gn_space_closed(ctx, dem, boundary, box, &now, &start))
        return ctx->effects & GN_FX_BONDS ? ctx->volume * now / start : now;
    if (gn_scene_test(&ctx->scene)->sides_stand)
        return ctx->volume *
               (1.0 - gn_ends_shortening(ctx, dem, boundary, solids, approach) / ctx->test_length);
    return ctx->volume;
}

double gn_space_area(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box) {
    const gn_test *t = &ctx->scene.test;
    const gn_test_descriptor *d = gn_scene_test(&ctx->scene);
    double now, start;
    if (d->periodic_sides) return gn_box_section(ctx);
    if (!d->prism || t->given.area > 0.0 || t->given.diameter > 0.0) return ctx->test_area;
    if (ctx->effects & GN_FX_MEMBRANE || !gn_space_closed(ctx, dem, boundary, box, &now, &start))
        return ctx->test_area;
    const span along = span_along(ctx, boundary, box, (int)t->axis);
    if (!(ctx->effects & GN_FX_BONDS)) return now / along.now;
    return ctx->test_area * (now / along.now) / (start / along.start);
}

double gn_space_shortening(const gn_step_context *ctx, const gn_boundary *boundary,
                           const gn_periodic_box *box, int axis) {
    const span x = span_along(ctx, boundary, box, axis);
    return x.now > 0.0 && x.start > 0.0 ? 1.0 - x.now / x.start : NAN;
}
