/* The gauge after particles have detached. Only outer particles have a weight in the average
 * strain, and these are the first to detach as chips and debris: a single one that has moved by the
 * size of the specimen adds a strain of some per cent. The gauge is therefore rebuilt from the
 * rest, with the positions at the start, and gives the mean displacement gradient of the remaining
 * specimen. */
#include "laboratory/strain_gauge.h"

#include "base/ball.h"
#include "base/error.h"
#include "base/memory.h"
#include "frame/frame.h"
#include "measure/measure.h"
#include "particles/dormant.h"
#include "particles/fragments.h"
#include "particles/particles.h"
#include "soa/particle_state.h"
#include "soa/records.h"
#include "solids/dormant_places.h"

#include <string.h>

/* Number of steps between checks, as for the membrane. */
enum { LOOK_INTERVAL = 100 };

/* Roles of particles (gauge.belongs): hardly bonded at the start, so that it never counted; in a
 * small separate body; part of the specimen; detached or removed, permanently. */
enum { LOOSE, APART, BELONGS, LEFT };

static gneiss_status no_room(size_t count, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a strain gauge of %zu particles",
                   count);
}

gneiss_status gn_gauge_create(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                              gneiss_error *error) {
    gn_particles *q = &dem->particles;
    const int dimension = (int)ctx->scene.dimension;
    uint8_t *counts = gn_alloc_array(q->soa.count + 1, sizeof *counts);
    const bool bonded = ctx->effects & GN_FX_BONDS;
    gauge->count = bonded ? (size_t)dem->ids : 0;
    gauge->belongs = bonded ? gn_alloc_array(gauge->count + 1, sizeof *gauge->belongs) : NULL;
    gneiss_status status =
        counts && (gauge->belongs || !bonded) ? GNEISS_OK : no_room(q->soa.count, error);
    if (status == GNEISS_OK) gn_strain_gauge_select(q, dimension, counts);
    for (size_t p = 0; status == GNEISS_OK && bonded && p < q->soa.count; p++)
        gauge->belongs[q->id[p]] = counts[p] ? BELONGS : LOOSE;
    if (status == GNEISS_OK)
        status = gn_strain_gauge_of(q, counts, dimension, &gauge->weights, error);
    gn_free(counts);
    return status;
}

/* Tells whether bonds and contacts alone determine which particles form a body. */
static bool tells_bodies(const gn_step_context *ctx, const gn_gauge *gauge) {
    return gauge->count && !ctx->scene.has_couple;
}

static int32_t largest_of(const int32_t *members, size_t count) {
    int32_t largest = 0;
    for (size_t p = 0; p < count; p++) largest = members[p] > largest ? members[p] : largest;
    return largest;
}

void gn_gauge_note_apart(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge) {
    const gn_particles *q = &dem->particles;
    if (!gauge->weights.count || !tells_bodies(ctx, gauge)) return;
    const int32_t *members = gn_dem_body_sizes(ctx, dem),
                  largest = largest_of(members, q->soa.count);
    for (size_t p = 0; p < q->soa.count; p++) {
        int32_t *belongs = &gauge->belongs[q->id[p]];
        if (*belongs == BELONGS && GN_CHIP * members[p] < largest) *belongs = APART;
    }
}

static void mark_off(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge) {
    const gn_particles *q = &dem->particles;
    if (!tells_bodies(ctx, gauge)) return;
    const int32_t *members = gn_dem_body_sizes(ctx, dem),
                  largest = largest_of(members, q->soa.count);
    for (size_t p = 0; p < q->soa.count; p++) {
        int32_t *belongs = &gauge->belongs[q->id[p]];
        const bool large = GN_CHIP * members[p] >= largest;
        if (*belongs == BELONGS && !large)
            *belongs = LEFT;
        else if (*belongs == APART && large)
            *belongs = BELONGS;
    }
}

static bool is_there(const gn_dem *dem, size_t p) {
    return gn_particle_is_active(&dem->particles, p) || gn_is_dormant(dem, p);
}

static void mark_removed(gn_dem *dem, gn_gauge *gauge) {
    const gn_particles *q = &dem->particles;
    for (size_t p = 0; gauge->count && p < q->soa.count; p++)
        if (gauge->belongs[q->id[p]] != LOOSE && !is_there(dem, p)) gauge->belongs[q->id[p]] = LEFT;
}

static bool counts_on(const gn_dem *dem, const gn_gauge *gauge, size_t p) {
    const int32_t belongs = gauge->count ? gauge->belongs[dem->particles.id[p]] : LOOSE;
    return gauge->count ? belongs == BELONGS || belongs == APART : is_there(dem, p);
}

static bool has_weight_that_left(const gn_dem *dem, const gn_gauge *gauge) {
    for (size_t k = 0; k < gauge->weights.count; k++) {
        const int32_t p = dem->index_of_id[gauge->weights.id[k]];
        if (p < 0 || !counts_on(dem, gauge, (size_t)p)) return true;
    }
    return false;
}

/* Marks the particles that count; tells whether they are at least half of those at the start. */
static bool find_rest(const gn_step_context *ctx, const gn_dem *dem, const gn_gauge *gauge,
                      uint8_t *counts) {
    const gn_particles *q = &dem->particles;
    double all = 0.0, left = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double own = gn_ball_volume((int)ctx->scene.dimension, q->pos[4 * p + 3]);
        counts[p] = counts_on(dem, gauge, p);
        all += gauge->count && gauge->belongs[q->id[p]] == LOOSE ? 0.0 : own;
        left += counts[p] ? own : 0.0;
    }
    return 2.0 * left >= all;
}

static gneiss_status renew(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                           gneiss_error *error) {
    const gn_particles *q = &dem->particles;
    gneiss_status status = GNEISS_OK;
    if (!has_weight_that_left(dem, gauge)) return GNEISS_OK;
    uint8_t *counts = gn_alloc_array(q->soa.count + 1, sizeof *counts);
    if (!counts) return no_room(q->soa.count, error);
    gn_strain_gauge_free(&gauge->weights);
    if (find_rest(ctx, dem, gauge, counts))
        status = gn_strain_gauge_fast(q, counts, (int)ctx->scene.dimension, &gauge->weights, error);
    gn_free(counts);
    return status;
}

gneiss_status gn_gauge_update(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                              gneiss_error *error) {
    if (!gauge->weights.count || ctx->step % LOOK_INTERVAL != 0 || !gn_dem_has_loosened(dem))
        return GNEISS_OK;
    gn_ranks_whole(ctx->ranks);
    mark_off(ctx, dem, gauge);
    return renew(ctx, dem, gauge, error);
}

gneiss_status gn_gauge_leave(const gn_step_context *ctx, gn_dem *dem, gn_gauge *gauge,
                             gneiss_error *error) {
    if (!gauge->weights.count) return GNEISS_OK;
    mark_removed(dem, gauge);
    return renew(ctx, dem, gauge, error);
}

void gn_gauge_gradient(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_gauge *gauge, double gradient[9]) {
    gn_strain_gauge_read(&gauge->weights, &dem->particles, dem->index_of_id, gradient);
    int32_t *places = gn_element_places(ctx, solids);
    for (size_t k = 0; gn_converts(ctx) && k < gauge->weights.count; k++) {
        const int32_t p = dem->index_of_id[gauge->weights.id[k]];
        double u[3];
        if (p < 0 || !gn_is_dormant(dem, (size_t)p)) continue;
        gn_particle_travel(dem, solids, places, (size_t)p, u);
        for (int a = 0; a < 3; a++)
            for (int c = 0; c < 3; c++)
                gradient[3 * a + c] += u[a] * gauge->weights.weight[3 * k + c];
    }
    gn_free(places);
}
