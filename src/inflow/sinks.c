/* Sinks that are thin: what passes through them between two lists, and what never fits. */
#include "base/vec3.h"
#include "frame/step_context.h"
#include "pack/domain.h"
#include "particles/dem.h"
#include "particles/flow.h"
#include "scene/flow_def.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

double gn_sink_width(const gn_step_context *ctx, const gn_dem *dem, size_t sink) {
    const gn_flow_region *r = &ctx->scene.sinks[sink].region;
    const gn_domain *region = dem->flow.region[ctx->scene.source_count + sink];
    double lower[3], upper[3], width = INFINITY, around = 0.0;
    if (!region) return INFINITY;
    gn_domain_bounds(region, lower, upper);
    for (int a = 0; a < gn_domain_dimension(region); a++) width = fmin(width, upper[a] - lower[a]);
    for (size_t k = 0; k < r->corner_count; k++) {
        const double *x = r->corners + 2 * k, *y = r->corners + 2 * ((k + 1) % r->corner_count);
        around += hypot(y[0] - x[0], y[1] - x[1]);
    }
    /* A long strip has 2 A/P, any other polygon less than its width. */
    return around > 0.0 ? fmin(width, 2.0 * gn_domain_volume(region) / around) : width;
}

static double largest_radius(const gn_step_context *ctx, const gn_dem *dem) {
    double most = gn_flow_largest_radius(ctx, dem);
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        most = fmax(most, dem->particles.pos[4 * p + 3]);
    return most;
}

/* Tells whether a particle can be wholly in it for hardly longer than lists may stand: the skin
 * grows to six times that of the start. */
static bool is_thin(const gn_step_context *ctx, const gn_dem *dem, size_t sink) {
    return ctx->scene.sinks[sink].remove &&
           gn_sink_width(ctx, dem, sink) - 2.0 * dem->flow.largest < 12.0 * dem->verlet.skin_start;
}

enum { PLACES = 16, HALVINGS = 40 };
/* Of a radius: as much is a particle inside that only rounding keeps from it. */
static const double rounding = 1e-9;

/* m: how deep a particle's centre was in a region at a share of its last step, counted backwards.
 */
static double depth_before(const gn_step_context *ctx, const gn_dem *dem, const gn_domain *region,
                           size_t particle, double share) {
    const gn_particles *q = &dem->particles;
    double at[3];
    for (int a = 0; a < 3; a++)
        at[a] = q->pos[4 * particle + a] - share * ctx->dt_past * q->vel[4 * particle + a];
    return gn_domain_depth(region, at);
}

/* The largest depth between two shares of the last step; on a line through a convex region depth
 * has one maximum. */
static double deepest_between(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_domain *region, size_t particle, double from, double to) {
    for (int k = 0; k < HALVINGS; k++) {
        const double low = from + 0.382 * (to - from), high = to - 0.382 * (to - from);
        if (depth_before(ctx, dem, region, particle, low) >
            depth_before(ctx, dem, region, particle, high))
            to = high;
        else
            from = low;
    }
    return depth_before(ctx, dem, region, particle, 0.5 * (from + to));
}

/* Tells whether it was wholly inside at any instant of the last step. Depth changes along the way
 * by no more than the way, which is at most half of the smallest radius (paths.c). */
static bool passed(const gn_step_context *ctx, const gn_dem *dem, size_t sink, size_t particle) {
    const gn_domain *region = dem->flow.region[ctx->scene.source_count + sink];
    const double *v = dem->particles.vel + 4 * particle,
                 needed = (1.0 - rounding) * dem->particles.pos[4 * particle + 3],
                 part = ctx->dt_past * sqrt(gn_dot3(v, v)) / PLACES;
    double deepest = -INFINITY;
    int best = 0;
    for (int k = 0; k <= PLACES; k++) {
        const double depth = depth_before(ctx, dem, region, particle, (double)k / PLACES);
        if (depth > deepest) {
            deepest = depth;
            best = k;
        }
    }
    if (deepest >= needed || deepest + part < needed) return deepest >= needed;
    return deepest_between(ctx, dem, region, particle, fmax(0, best - 1) / PLACES,
                           fmin(PLACES, best + 1) / PLACES) >= needed;
}

bool gn_sink_takes(const gn_step_context *ctx, const gn_dem *dem, size_t sink, size_t particle) {
    return gn_sink_has(ctx, dem, sink, dem->particles.pos + 4 * particle) ||
           (is_thin(ctx, dem, sink) && passed(ctx, dem, sink, particle));
}

/* Tells whether its centre is in the box about the region, the last way added. */
static bool is_near(const gn_step_context *ctx, const gn_dem *dem, const double lower[3],
                    const double upper[3], size_t p) {
    const double *x = dem->particles.pos + 4 * p, *v = dem->particles.vel + 4 * p;
    for (int a = 0; a < (int)ctx->scene.dimension; a++) {
        const double way = ctx->dt_past * fabs(v[a]);
        if (x[a] + way < lower[a] || x[a] - way > upper[a]) return false;
    }
    return gn_particle_is_active(&dem->particles, p);
}

bool gn_sinks_are_due(const gn_step_context *ctx, const gn_dem *dem) {
    for (size_t k = 0; k < ctx->scene.sink_count; k++) {
        const gn_domain *region = dem->flow.region[ctx->scene.source_count + k];
        double lower[3], upper[3];
        if (!region || !is_thin(ctx, dem, k)) continue;
        gn_domain_bounds(region, lower, upper);
        for (size_t p = 0; p < dem->particles.soa.count; p++)
            if (is_near(ctx, dem, lower, upper, p) && gn_sink_takes(ctx, dem, k, p)) return true;
    }
    return false;
}

void gn_sinks_listed(const gn_step_context *ctx, gn_dem *dem) {
    if (ctx->scene.sink_count) dem->flow.largest = largest_radius(ctx, dem);
}

bool gn_sink_is_too_thin(const gn_step_context *ctx, const gn_dem *dem, size_t sink, char *text,
                         size_t size) {
    const double width = gn_sink_width(ctx, dem, sink), most = 2.0 * largest_radius(ctx, dem),
                 least = 2.0 * dem->radius_min;
    if (!ctx->scene.sinks[sink].remove || !(width < (1.0 - rounding) * most)) return false;
    snprintf(text, size, "sink '%s' is %.4g m thick, and removes what is wholly inside: %s",
             ctx->scene.sinks[sink].name, width,
             width < (1.0 - rounding) * least
                 ? "it is thinner than any particle, and never removes one"
                 : "it is thinner than the largest particles, and never removes these");
    if (strlen(text) + 40 < size)
        snprintf(text + strlen(text), size - strlen(text), " (diameters of %.4g to %.4g m)", least,
                 most);
    return true;
}
