#include "world/invariants.h"
#include "boundary/boundary.h"

#include "frame/frame.h"
#include "kernels/partials.h"
#include "particles/clumps.h"
#include "particles/dormant.h"
#include "particles/joint_faces.h"
#include "particles/law.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "soa/particle_state.h"
#include "soa/records.h"

#ifndef NDEBUG
#include <assert.h>

enum { ALL_PAIRS_UP_TO = 400 }; /* particles up to which all pairs are checked */

static void assert_particles(const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    size_t n = q->soa.count;
    assert(q->soa.capacity >= n + 2 || n == 0);
    for (size_t p = 0; p < n; p++) {
        assert(q->pos[4 * p + 3] > 0.0);
        assert(q->vel[4 * p + 3] >= 0.0);
        assert(q->id[p] >= 0 && q->id[p] < dem->ids);
        assert(dem->index_of_id[q->id[p]] == (int32_t)p);
        for (size_t a = 0; a < 3; a++) assert(isfinite(q->pos[4 * p + a] + q->vel[4 * p + a]));
    }
    for (size_t p = n; p < n + 2 && n > 0; p++) assert(q->pos[4 * p + 3] == 0.0);
}

/* Contacts are sorted by (i, j) and unique; padding refers to the null particles. */
static void assert_contacts(const gn_dem *dem, const gn_contacts *list) {
    int32_t n = (int32_t)dem->particles.soa.count;
    for (size_t c = 0; c < list->soa.count; c++) {
        assert(list->i[c] >= 0 && list->i[c] < list->j[c] && list->j[c] < n);
        double kn = gn_contact_spring(dem, list, c).kn;
        assert(kn >= 0.0 && isfinite(kn));
        if (c == 0) continue;
        assert(list->i[c - 1] < list->i[c] ||
               (list->i[c - 1] == list->i[c] && list->j[c - 1] < list->j[c]));
    }
    for (size_t c = list->soa.count; c < list->soa.capacity && n > 0; c++)
        assert(list->i[c] >= n && list->j[c] >= n);
}

static void assert_wall_contacts(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary) {
    const gn_wall_contacts *list = &boundary->contacts;
    if (!(ctx->effects & GN_FX_WALLS)) return;
    for (size_t p = 0; p < dem->particles.soa.count; p++) {
        assert(boundary->first[p] <= boundary->first[p + 1]);
        for (int32_t c = boundary->first[p]; c < boundary->first[p + 1]; c++) {
            assert(list->i[c] == (int32_t)p && list->wall[c] >= 0);
            assert(c == boundary->first[p] || list->wall[c - 1] < list->wall[c]);
        }
    }
    assert((size_t)boundary->first[dem->particles.soa.count] == list->soa.count);
}

/* Asserts that both ends of every contact have rows among the partial sums of the contact's block.
 */
static void assert_partials(const gn_dem *dem, const gn_contacts *list,
                            const gn_partials *partials) {
    if (list->soa.count == 0) return;
    assert(partials->blocks == gn_blocks(list->soa.count, partials->length));
    for (size_t b = 0; b <= gn_blocks(dem->particles.soa.count, GN_PARTICLE_BLOCK); b++)
        assert(b == 0 || partials->start[b - 1] <= partials->start[b]);
    for (size_t b = 0; b < partials->blocks; b++)
        assert(partials->first[b] <= partials->first[b + 1]);
}

static bool listed(const gn_contacts *list, int32_t i, int32_t j) {
    size_t c = gn_contacts_from(list, i, j);
    return c < list->soa.count && list->i[c] == i && list->j[c] == j;
}

/* Asserts that all particles nearer to each other than the skin are in exactly one of the lists. */
static void assert_complete(const gn_step_context *ctx, const gn_dem *dem) {
    const gn_particles *q = &dem->particles;
    int32_t n = (int32_t)q->soa.count;
    if (n > ALL_PAIRS_UP_TO) return;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = i + 1; j < n; j++) {
            const double *x = q->pos + 4 * (int64_t)i, *y = q->pos + 4 * (int64_t)j;
            double d[3], gap = sqrt(gn_branch(ctx, x, y, d)) - x[3] - y[3];
            bool there = gn_particle_is_active(q, i) && gn_particle_is_active(q, j);
            there = there && !gn_is_hidden_pair(ctx, dem, i, j) && !gn_clump_binds(dem, i, j);
            bool bond = listed(&dem->bonds.contacts, i, j),
                 pair = listed(&dem->pairs.contacts, i, j);
            assert(!(bond && pair));
            gn_joint_shift shift;
            if (gn_joint_between(dem, i, j, &shift) >= 0) continue;
            assert(bond || pair || !there || gap > dem->verlet.skin * (1.0 - 1e-9));
        }
}

void gn_world_assert_lists(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary) {
    assert_particles(dem);
    assert_wall_contacts(ctx, dem, boundary);
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        assert_contacts(dem, &dem->list[l].contacts);
        assert_partials(dem, &dem->list[l].contacts, &dem->list[l].partials);
    }
    assert_complete(ctx, dem);
}
#endif
