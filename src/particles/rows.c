#include "particles/rows.h"

#include "base/ball.h"
#include "base/new.h"
#include "base/vec3.h"
#include "frame/frame.h"
#include "neigh/neigh.h"
#include "particles/flow.h"
#include "particles/fragments.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "sched/hold.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#include <math.h>
#include <string.h>

/* `order` [count]: old indices, -1: a new particle. */
static gneiss_status take_rows(const gn_step_context *ctx, gn_dem *dem, const int32_t *order,
                               size_t count, gneiss_error *error) {
    gn_particles now = {0};
    GN_TRY(gn_soa_create(&gn_particle_record, &now, count, ctx->effects, error));
    gn_soa_permute(&gn_particle_record, &now, &dem->particles, order);
    gn_soa_destroy(&gn_particle_record, &dem->particles);
    dem->particles = now;
    gn_dem_null_particles(ctx, dem);
    return GNEISS_OK;
}

/* Changes the number of rows, and frees the arrays that depend on it or on the number of blocks;
 * these are allocated when lists are made. */
static gneiss_status change_count(const gn_step_context *ctx, gn_dem *dem, const int32_t *order,
                                  size_t count, gneiss_error *error) {
    GN_TRY(take_rows(ctx, dem, order, count, error));
    gn_free(dem->motion_sums);
    gn_free(dem->around);
    gn_free(dem->pieces.parent);
    gn_free(dem->pieces.members);
    gn_free(dem->pieces.volume);
    dem->motion_sums = NULL;
    dem->around = NULL;
    dem->pieces = (gn_pieces){0};
    gn_hold_free(&dem->hold);
    return gn_pieces_create(ctx, dem, error);
}

gneiss_status gn_dem_sort(const gn_step_context *ctx, gn_dem *dem, int32_t *place,
                          gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    GN_FREED int32_t *order = gn_alloc_array(n + 1, sizeof *order);
    if (!order) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu particles", n);
    GN_TRY(gn_morton_order(&dem->particles, (int)ctx->scene.dimension, order, error));
    GN_TRY(take_rows(ctx, dem, order, n, error));
    for (size_t p = 0; p < n; p++) place[order[p]] = (int32_t)p;
    gn_dem_number_ids(dem);
    return gn_lists_follow_rows(ctx, dem, place, error);
}

gneiss_status gn_dem_number_rows(gn_dem *dem, gneiss_error *error) {
    GN_TRY(gn_new(&dem->index_of_id, (size_t)dem->ids + 1, "particle numbers", error));
    gn_dem_number_ids(dem);
    return GNEISS_OK;
}

/* --- new rows --- */

static void fill(const gn_step_context *ctx, gn_dem *dem, const gn_arrival *arrival, size_t p) {
    gn_particles *q = &dem->particles;
    const gn_source_def *d = &ctx->scene.sources[arrival->source];
    int material = gn_scene_find_material(&ctx->scene, d->material);
    double r = arrival->sphere[3], mass = ctx->scene.materials[material].density *
                                          gn_ball_volume((int)ctx->scene.dimension, r);
    memcpy(q->pos + 4 * p, arrival->sphere, sizeof arrival->sphere);
    memcpy(q->start + 4 * p, arrival->sphere, sizeof arrival->sphere);
    memcpy(q->ref + 4 * p, arrival->sphere, sizeof arrival->sphere);
    memcpy(q->vel + 4 * p, arrival->velocity, sizeof arrival->velocity);
    q->vel[4 * p + 3] = 1.0 / mass;
    if (q->spin)
        q->spin[4 * p + 3] = 1.0 / ((ctx->effects & GN_FX_SPACE ? 0.4 : 0.5) * mass * r * r);
    q->id[p] = (int32_t)dem->ids++;
    q->material[p] = material;
    if (q->slot) q->slot[p] = -1;
    if (q->clump) q->clump[p] = -1;
    if (q->orientation) q->orientation[4 * p] = 1.0;
    dem->radius_min = fmin(dem->radius_min, r);
    if (dem->loose) dem->loose[q->id[p]] = 1;
    /* The limit for particles in flight uses the largest speed. */
    dem->done.motion.speed2 =
        fmax(dem->done.motion.speed2, gn_dot3(arrival->velocity, arrival->velocity));
}

/* Enlarges tables by id to `ids` entries. */
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

gneiss_status gn_dem_grow(const gn_step_context *ctx, gn_dem *dem, const gn_arrival *arrivals,
                          size_t count, gneiss_error *error) {
    size_t before = dem->particles.soa.count, after = before + count;
    if ((size_t)dem->ids + count > INT32_MAX - 2 * GN_LANES_MAX)
        return gn_fail(error, GNEISS_ERROR_INPUT,
                       "step %lld, t = %g s: sources: %lld particles that came in are more than "
                       "the engine can number",
                       (long long)ctx->step, ctx->time, (long long)dem->ids);
    int32_t *order = NULL;
    GN_TRY(gn_new(&order, after + 1, "particles", error));
    for (size_t p = 0; p < after; p++) order[p] = p < before ? (int32_t)p : -1;
    gneiss_status status = grow_tables(dem, (size_t)dem->ids + count, error);
    if (status == GNEISS_OK) status = change_count(ctx, dem, order, after, error);
    gn_free(order);
    GN_TRY(status);
    for (size_t k = 0; k < count; k++) fill(ctx, dem, &arrivals[k], before + k);
    gn_dem_number_ids(dem);
    return gn_lists_follow_rows(ctx, dem, NULL, error);
}

/* --- removal of rows --- */

/* Finds the new rows of the remaining particles, -1 for the others; returns the number of remaining
 * particles. */
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

gneiss_status gn_dem_drop(const gn_step_context *ctx, gn_dem *dem, int32_t **place,
                          gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    *place = NULL;
    if (!gn_scene_has_flow(&ctx->scene) || n == 0) return GNEISS_OK;
    GN_FREED int32_t *to = gn_alloc_array(n + 1, sizeof *to),
                     *order = gn_alloc_array(n + 1, sizeof *order);
    if (!to || !order) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    const size_t stay = find_stays(dem, to, order);
    /* A few empty rows cost less than removing them; at least one row remains. */
    if (stay == 0 || n - stay <= n / 16) return GNEISS_OK;
    GN_TRY(change_count(ctx, dem, order, stay, error));
    gn_dem_number_ids(dem);
    GN_TRY(gn_lists_follow_rows(ctx, dem, to, error));
    *place = to;
    to = NULL;
    return GNEISS_OK;
}
