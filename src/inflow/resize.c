/* The number of rows of particles changes: some come in behind the others, rows of those that are
 * gone are left out. */
#include "base/ball.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/step_context.h"
#include "neigh/pairs.h"
#include "particles/dem.h"
#include "particles/flow.h"
#include "particles/fragments.h"
#include "particles/lists.h"
#include "scene/flow_def.h"
#include "scene/scene.h"
#include "sched/hold.h"
#include "soa/field.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <string.h>

/* What goes by the number of particles or of their blocks is made anew when the lists are. */
static gneiss_status forget_sizes(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  gneiss_error *error) {
    gn_dem *d = dem;
    gn_free(d->motion_sums);
    gn_free(d->around);
    gn_free(d->pieces.parent);
    gn_free(d->pieces.members);
    gn_free(d->pieces.volume);
    d->motion_sums = NULL;
    d->around = NULL;
    d->pieces = (gn_pieces){0};
    gn_hold_free(&d->hold);
    gn_boundary_resized(boundary);
    return gn_pieces_create(ctx, dem, error);
}

/* --- more --- */

static void fill(const gn_step_context *ctx, gn_dem *dem, const gn_arrival *a, size_t p) {
    gn_particles *q = &dem->particles;
    const gn_source_def *d = &ctx->scene.sources[a->source];
    int material = gn_scene_find_material(&ctx->scene, d->material);
    double r = a->sphere[3], mass = ctx->scene.materials[material].density *
                                    gn_ball_volume((int)ctx->scene.dimension, r);
    memcpy(q->pos + 4 * p, a->sphere, sizeof a->sphere);
    memcpy(q->start + 4 * p, a->sphere, sizeof a->sphere);
    memcpy(q->ref + 4 * p, a->sphere, sizeof a->sphere);
    memcpy(q->vel + 4 * p, a->velocity, sizeof a->velocity);
    q->vel[4 * p + 3] = 1.0 / mass;
    if (q->spin)
        q->spin[4 * p + 3] = 1.0 / ((ctx->effects & GN_FX_SPACE ? 0.4 : 0.5) * mass * r * r);
    q->id[p] = (int32_t)dem->ids++;
    q->material[p] = material;
    if (q->slot) q->slot[p] = -1;
    if (q->orientation) q->orientation[4 * p] = 1.0;
    dem->radius_min = fmin(dem->radius_min, r);
    if (dem->loose) dem->loose[q->id[p]] = 1;
}

/* Tables by id for `ids` of them. */
static gneiss_status grow_tables(gn_dem *dem, size_t ids, gneiss_error *error) {
    gn_dem *d = dem;
    int32_t *index = gn_alloc_array(ids + 1, sizeof *index);
    uint8_t *loose = d->loose ? gn_alloc(ids + 1) : NULL;
    if (!index || (d->loose && !loose)) {
        gn_free(index);
        gn_free(loose);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particle numbers", ids);
    }
    if (loose) memcpy(loose, d->loose, (size_t)d->ids);
    gn_free(d->loose);
    gn_free(d->index_of_id);
    d->loose = loose;
    d->index_of_id = index;
    return GNEISS_OK;
}

/* `order` [count]: old places, -1: a new one. */
static gneiss_status take_rows(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                               const int32_t *order, size_t count, gneiss_error *error) {
    gn_particles now = {0};
    GN_TRY(gn_soa_create(&gn_particle_record, &now, count, ctx->effects, error));
    gn_soa_permute(&gn_particle_record, &now, &dem->particles, order);
    gn_soa_destroy(&gn_particle_record, &dem->particles);
    dem->particles = now;
    gn_dem_null_particles(ctx, dem);
    return forget_sizes(ctx, dem, boundary, error);
}

gneiss_status gn_dem_grow(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          const gn_arrival *arrivals, size_t count, gneiss_error *error) {
    size_t before = dem->particles.soa.count, after = before + count;
    if ((size_t)dem->ids + count > INT32_MAX - 2 * GN_LANES_MAX)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "step %lld, t = %g s: sources: %lld particles that came in are more than "
                       "the engine can number",
                       (long long)ctx->step, ctx->time, (long long)dem->ids);
    int32_t *order = gn_alloc_array(after + 1, sizeof *order);
    if (!order) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", after);
    for (size_t p = 0; p < after; p++) order[p] = p < before ? (int32_t)p : -1;
    gneiss_status status = grow_tables(dem, (size_t)dem->ids + count, error);
    if (status == GNEISS_OK) status = take_rows(ctx, dem, boundary, order, after, error);
    gn_free(order);
    GN_TRY(status);
    for (size_t k = 0; k < count; k++) {
        const double *v = arrivals[k].velocity;
        fill(ctx, dem, &arrivals[k], before + k);
        /* What follows flights looks at the fastest. */
        dem->done.motion.speed2 = fmax(dem->done.motion.speed2, gn_dot3(v, v));
    }
    gn_dem_number_ids(dem);
    return gn_lists_follow_rows(ctx, dem, NULL, error);
}

/* --- fewer --- */

/* Places of those that stay, -1 of the others; returns how many stay. */
static size_t find_stays(const gn_dem *dem, int32_t *place, int32_t *order) {
    const gn_particles *q = &dem->particles;
    size_t count = 0;
    for (size_t p = 0; p < q->soa.count; p++) place[p] = gn_particle_is_active(q, p) ? 1 : -1;
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contacts *list = &dem->list[l].contacts;
        if (!gn_list_kinds[l]->persistent) continue;
        for (size_t c = 0; c < list->soa.count; c++) place[list->i[c]] = place[list->j[c]] = 1;
    }
    for (size_t p = 0; p < q->soa.count; p++) {
        if (place[p] < 0) continue;
        order[count] = (int32_t)p;
        place[p] = (int32_t)count++;
    }
    return count;
}

static gneiss_status drop(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          const int32_t *order, size_t count, const int32_t *place,
                          gneiss_error *error) {
    GN_TRY(take_rows(ctx, dem, boundary, order, count, error));
    gn_dem_number_ids(dem);
    GN_TRY(gn_lists_follow_rows(ctx, dem, place, error));
    return gn_boundary_renumber(boundary, place, error);
}

gneiss_status gn_dem_drop(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                          gneiss_error *error) {
    size_t n = dem->particles.soa.count;
    if (!gn_scene_has_flow(&ctx->scene) || n == 0) return GNEISS_OK;
    int32_t *place = gn_alloc_array(n + 1, sizeof *place),
            *order = gn_alloc_array(n + 1, sizeof *order);
    gneiss_status status = GNEISS_OK;
    if (!place || !order)
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    size_t stay = status == GNEISS_OK ? find_stays(dem, place, order) : 0;
    /* Some rows of nothing cost less than taking them out; one at least is there. */
    if (status == GNEISS_OK && stay > 0 && n - stay > n / 16)
        status = drop(ctx, dem, boundary, order, stay, place, error);
    gn_free(place);
    gn_free(order);
    return status;
}
