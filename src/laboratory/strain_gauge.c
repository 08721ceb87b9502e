/* Only outer particles have a weight in the average strain, and those are the ones that chips and
 * debris take along: a single one that has flown off by the size of the specimen is a strain of
 * some per cent. So the gauge is made anew of what is left, with the places of the start: the mean
 * displacement gradient of what still is the specimen. */
#include "laboratory/strain_gauge.h"

#include "base/ball.h"
#include "base/memory.h"
#include "conversion/conversion.h"
#include "particles/fragments.h"
#include "world/internal.h"

#include <string.h>

/* Steps between looks; as of the membrane. */
enum { LOOK_INTERVAL = 100 };

/* world.belongs: hardly bonded at the start, so that it never counted; in a small body of its
 * own as yet; of the specimen; came off it or was removed, for good. */
enum { LOOSE, APART, BELONGS, LEFT };

static gneiss_status no_room(size_t count, gneiss_error *error) {
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for a strain gauge of %zu particles",
                   count);
}

gneiss_status gn_gauge_create(gn_world *w, gneiss_error *error) {
    gn_particles *q = &w->dem.particles;
    const int dimension = (int)w->scene.dimension;
    uint8_t *counts = gn_alloc_array(q->soa.count + 1, sizeof *counts);
    const bool bonded = w->effects & GN_FX_BONDS;
    w->gauged = bonded ? (size_t)w->dem.ids : 0;
    w->belongs = bonded ? gn_alloc_array(w->gauged + 1, sizeof *w->belongs) : NULL;
    gneiss_status status =
        counts && (w->belongs || !bonded) ? GNEISS_OK : no_room(q->soa.count, error);
    if (status == GNEISS_OK) gn_strain_gauge_select(q, dimension, counts);
    for (size_t p = 0; status == GNEISS_OK && bonded && p < q->soa.count; p++)
        w->belongs[q->id[p]] = counts[p] ? BELONGS : LOOSE;
    if (status == GNEISS_OK) status = gn_strain_gauge_of(q, counts, dimension, &w->gauge, error);
    gn_free(counts);
    return status;
}

/* Whether bonds and contacts alone tell what holds together. */
static bool tells_bodies(const gn_world *w) {
    return w->gauged && !w->scene.has_couple;
}

static int32_t largest_of(const int32_t *members, size_t count) {
    int32_t largest = 0;
    for (size_t p = 0; p < count; p++) largest = members[p] > largest ? members[p] : largest;
    return largest;
}

void gn_gauge_note_apart(gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    if (!w->gauge.count || !tells_bodies(w)) return;
    const int32_t *members = gn_world_bodies(w), largest = largest_of(members, q->soa.count);
    for (size_t p = 0; p < q->soa.count; p++) {
        int32_t *belongs = &w->belongs[q->id[p]];
        if (*belongs == BELONGS && GN_CHIP * members[p] < largest) *belongs = APART;
    }
}

static void mark_off(gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    if (!tells_bodies(w)) return;
    const int32_t *members = gn_world_bodies(w), largest = largest_of(members, q->soa.count);
    for (size_t p = 0; p < q->soa.count; p++) {
        int32_t *belongs = &w->belongs[q->id[p]];
        const bool large = GN_CHIP * members[p] >= largest;
        if (*belongs == BELONGS && !large)
            *belongs = LEFT;
        else if (*belongs == APART && large)
            *belongs = BELONGS;
    }
}

static bool is_there(const gn_world *w, size_t p) {
    return w->dem.particles.vel[4 * p + 3] > 0.0 || gn_is_asleep(w, p);
}

static void mark_removed(gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    for (size_t p = 0; w->gauged && p < q->soa.count; p++)
        if (w->belongs[q->id[p]] != LOOSE && !is_there(w, p)) w->belongs[q->id[p]] = LEFT;
}

static bool counts_on(const gn_world *w, size_t p) {
    const int32_t belongs = w->gauged ? w->belongs[w->dem.particles.id[p]] : LOOSE;
    return w->gauged ? belongs == BELONGS || belongs == APART : is_there(w, p);
}

static bool has_weight_that_left(const gn_world *w) {
    for (size_t k = 0; k < w->gauge.count; k++) {
        const int32_t p = w->dem.index_of_id[w->gauge.id[k]];
        if (p < 0 || !counts_on(w, (size_t)p)) return true;
    }
    return false;
}

/* Who counts; whether these are half of what did at the start. */
static bool find_rest(const gn_world *w, uint8_t *counts) {
    const gn_particles *q = &w->dem.particles;
    double all = 0.0, left = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) {
        const double own = gn_ball_volume((int)w->scene.dimension, q->pos[4 * p + 3]);
        counts[p] = counts_on(w, p);
        all += w->gauged && w->belongs[q->id[p]] == LOOSE ? 0.0 : own;
        left += counts[p] ? own : 0.0;
    }
    return 2.0 * left >= all;
}

static gneiss_status renew(gn_world *w, gneiss_error *error) {
    const gn_particles *q = &w->dem.particles;
    gneiss_status status = GNEISS_OK;
    if (!has_weight_that_left(w)) return GNEISS_OK;
    uint8_t *counts = gn_alloc_array(q->soa.count + 1, sizeof *counts);
    if (!counts) return no_room(q->soa.count, error);
    gn_strain_gauge_free(&w->gauge);
    if (find_rest(w, counts))
        status = gn_strain_gauge_soon(q, counts, (int)w->scene.dimension, &w->gauge, error);
    gn_free(counts);
    return status;
}

gneiss_status gn_gauge_look(gn_world *w, gneiss_error *error) {
    if (!w->gauge.count || w->step % LOOK_INTERVAL != 0 || !gn_world_has_loosened(w))
        return GNEISS_OK;
    mark_off(w);
    return renew(w, error);
}

gneiss_status gn_gauge_leave(gn_world *w, gneiss_error *error) {
    if (!w->gauge.count) return GNEISS_OK;
    mark_removed(w);
    return renew(w, error);
}
