/* Sources and sinks: their regions and sizes, and counts of particles. */
#include "particles/flow.h"

#include "base/error.h"
#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "pack/domain.h"
#include "pack/sizes.h"
#include "particles/particles.h"
#include "scene/flow_def.h"
#include "scene/place.h"
#include "scene/scene.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <string.h>

/* --- regions --- */

static gneiss_status make_region(const gn_flow_region *region, gn_domain **domain,
                                 gneiss_error *error) {
    double upper[3];
    for (int a = 0; a < 3; a++) upper[a] = region->origin[a] + region->size[a];
    if (region->has_rectangle) return gn_domain_rectangle(region->origin, upper, domain, error);
    if (region->has_disc)
        return gn_domain_disc(region->origin, 0.5 * region->diameter, domain, error);
    if (region->corner_count)
        return gn_domain_polygon(region->corners, region->corner_count, domain, error);
    if (region->has_box) return gn_domain_box(region->origin, upper, domain, error);
    return gn_domain_cylinder(region->origin, 0.5 * region->diameter, region->height, domain,
                              error);
}

static gneiss_status at(const gn_step_context *ctx, gn_scene_place where, const char *list,
                        gneiss_status status, gneiss_error *error) {
    if (status == GNEISS_OK) return status;
    return gn_fail_context(error, "%s: ", gn_scene_at(&ctx->scene, where, list).text);
}

static gn_sizes sizes_of(const gn_step_context *ctx, size_t source) {
    const gn_source_def *d = &ctx->scene.sources[source];
    return (gn_sizes){d->sizes,       d->size_ratio, d->size_variation,
                      d->sieve_count, d->sieve,      (int)ctx->scene.dimension};
}

static gneiss_status make_regions(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_flow *f = &dem->flow;
    const gn_scene *s = &ctx->scene;
    for (size_t k = 0; k < s->source_count; k++) {
        const gn_source_def *d = &s->sources[k];
        const gn_sizes sizes = sizes_of(ctx, k);
        f->unit[k] = d->mean_radius / gn_sizes_mean(&sizes);
        GN_TRY(at(ctx, d->where, "sources", make_region(&d->region, &f->region[k], error), error));
    }
    for (size_t k = 0; k < s->sink_count; k++) {
        const gn_sink_def *d = &s->sinks[k];
        gn_domain **region = &f->region[s->source_count + k];
        if (d->has_plane) continue;
        GN_TRY(at(ctx, d->where, "sinks", make_region(&d->region, region, error), error));
    }
    return GNEISS_OK;
}

gneiss_status gn_flow_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_flow *f = &dem->flow;
    if (!gn_scene_has_flow(&ctx->scene)) return GNEISS_OK;
    f->regions = ctx->scene.source_count + ctx->scene.sink_count;
    f->region = gn_alloc_array(f->regions + 1, sizeof(gn_domain *));
    f->unit = gn_alloc_array(ctx->scene.source_count + 1, sizeof *f->unit);
    if (!f->region || !f->unit)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for sources and sinks");
    return make_regions(ctx, dem, error);
}

gneiss_status gn_flow_create(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    gn_flow *f = &dem->flow;
    if (!gn_scene_has_flow(&ctx->scene)) return GNEISS_OK;
    f->sources = gn_alloc_array(ctx->scene.source_count + 1, sizeof *f->sources);
    f->sinks = gn_alloc_array(ctx->scene.sink_count + 1, sizeof *f->sinks);
    if (f->sources && f->sinks) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for sources and sinks");
}

void gn_flow_free(gn_flow *flow) {
    for (size_t k = 0; flow->region && k < flow->regions; k++) gn_domain_free(flow->region[k]);
    gn_free((void *)flow->region);
    gn_free(flow->unit);
    gn_free(flow->sources);
    gn_free(flow->sinks);
    gn_free(flow->lost);
    *flow = (gn_flow){0};
}

/* --- expected particles --- */

static void radii(const gn_step_context *ctx, const gn_dem *dem, double *least, double *most) {
    *least = INFINITY;
    *most = 0.0;
    for (size_t k = 0; k < ctx->scene.source_count; k++) {
        const gn_sizes sizes = sizes_of(ctx, k);
        double low, high;
        gn_sizes_range(&sizes, &low, &high);
        *least = fmin(*least, low * dem->flow.unit[k]);
        *most = fmax(*most, high * dem->flow.unit[k]);
    }
}

double gn_flow_least_radius(const gn_step_context *ctx, const gn_dem *dem) {
    double least, most;
    radii(ctx, dem, &least, &most);
    return least;
}

double gn_flow_largest_radius(const gn_step_context *ctx, const gn_dem *dem) {
    double least, most;
    radii(ctx, dem, &least, &most);
    return most;
}

double gn_flow_widest_radius(const gn_step_context *ctx, const gn_dem *dem) {
    double most = gn_flow_largest_radius(ctx, dem);
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        most = fmax(most, dem->particles.pos[4 * p + 3]);
    return most;
}

void gn_flow_listed(const gn_step_context *ctx, gn_dem *dem) {
    if (ctx->scene.sink_count) dem->flow.largest = gn_flow_widest_radius(ctx, dem);
}

double gn_flow_mean_radius(const gn_step_context *ctx) {
    double sum = 0.0;
    for (size_t k = 0; k < ctx->scene.source_count; k++) sum += ctx->scene.sources[k].mean_radius;
    return sum / (double)ctx->scene.source_count;
}

void gn_flow_bounds(const gn_step_context *ctx, const gn_dem *dem, double lower[3],
                    double upper[3]) {
    for (int a = 0; a < 3; a++) {
        lower[a] = INFINITY;
        upper[a] = -INFINITY;
    }
    for (size_t k = 0; k < ctx->scene.source_count; k++) {
        double low[3], high[3];
        gn_domain_bounds(dem->flow.region[k], low, high);
        for (int a = 0; a < 3; a++) {
            lower[a] = fmin(lower[a], low[a]);
            upper[a] = fmax(upper[a], high[a]);
        }
    }
}

/* --- removed particles --- */

static double beyond(const gn_sink_def *def, const double x[3]) {
    double way[3];
    for (int a = 0; a < 3; a++) way[a] = x[a] - def->point[a];
    return gn_dot3(way, def->normal);
}

bool gn_sink_has(const gn_step_context *ctx, const gn_dem *dem, size_t sink, const double x[4]) {
    const gn_sink_def *d = &ctx->scene.sinks[sink];
    const gn_domain *region = dem->flow.region[ctx->scene.source_count + sink];
    if (!d->remove) return false;
    return (region ? gn_domain_depth(region, x) : beyond(d, x)) >= x[3];
}

/* Kinetic energy and momentum are those of the last half step. */
static void count_crossing(gn_dem *dem, size_t sink, size_t p, double sense) {
    gn_sink_state *s = &dem->flow.sinks[sink];
    const double *v = dem->particles.vel + 4 * p, mass = 1.0 / v[3];
    s->number += sense;
    s->mass += sense * mass;
    s->energy += sense * 0.5 * mass * gn_dot3(v, v);
    for (int a = 0; a < 3; a++) s->momentum[a] += sense * mass * v[a];
}

void gn_flow_count(const gn_step_context *ctx, gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    for (size_t k = 0; dem->verlet.rebuilds > 0 && k < ctx->scene.sink_count; k++) {
        const gn_sink_def *d = &ctx->scene.sinks[k];
        for (size_t p = 0; !d->remove && p < q->soa.count; p++) {
            bool before = beyond(d, q->ref + 4 * p) >= 0.0, now = beyond(d, q->pos + 4 * p) >= 0.0;
            if (before != now && gn_particle_is_active(q, p))
                count_crossing(dem, k, p, now ? 1.0 : -1.0);
        }
    }
}

gneiss_status gn_flow_note_lost(const gn_step_context *ctx, gn_dem *dem, size_t p,
                                gneiss_error *error) {
    gn_flow *f = &dem->flow;
    const gn_particles *q = &dem->particles;
    GN_TRY(gn_grow(&f->lost, f->lost_count, f->lost_count + 1, &f->lost_room, "lost particles",
                   error));
    gn_lost *l = &f->lost[f->lost_count++];
    dem->lost++;
    *l = (gn_lost){.id = q->id[p], .time = ctx->time};
    gn_user_point(ctx, q->pos + 4 * p, l->place);
    memcpy(l->velocity, q->vel + 4 * p, sizeof l->velocity);
    return GNEISS_OK;
}

void gn_flow_row(const gn_step_context *ctx, gn_dem *dem) {
    for (size_t k = 0; gn_scene_has_flow(&ctx->scene) && k < ctx->scene.sink_count; k++) {
        dem->flow.sinks[k].row_mass = dem->flow.sinks[k].mass;
        dem->flow.sinks[k].row_time = ctx->time;
    }
}

size_t gn_dem_present_count(const gn_dem *dem) {
    size_t count = 0;
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        count += gn_particle_is_active(&dem->particles, p);
    return count;
}

uint64_t gn_flow_hash(const gn_step_context *ctx, const gn_dem *dem, uint64_t h) {
    const gn_flow *f = &dem->flow;
    if (!gn_scene_has_flow(&ctx->scene)) return h;
    h = gn_hash_bytes(f->sources, ctx->scene.source_count * sizeof *f->sources, h);
    for (size_t k = 0; k < ctx->scene.sink_count; k++)
        h = gn_hash_bytes(&f->sinks[k], offsetof(gn_sink_state, row_mass), h);
    return h;
}
