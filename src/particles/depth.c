#include "particles/depth.h"

#include "base/memory.h"
#include "frame/frame.h"
#include "particles/particles.h"
#include "soa/records.h"

#include <math.h>

static double radius(const gn_dem *dem, size_t p) {
    return dem->particles.pos[4 * p + 3];
}

/* Tells whether a particle sits in a pore: enough bonded particles to hold it are closer than its
 * radius. */
static bool in_pore(const gn_step_context *ctx, const gn_dem *dem, size_t p) {
    const gn_particles *q = &dem->particles;
    const double *x =
        q->start + 4 * p; /* positions at the start, so that a resumed run finds the same */
    int near = 0, needed = (int)ctx->scene.dimension + 1;
    for (size_t j = 0; j < q->soa.count && near < needed; j++) {
        double reach = 2.0 * radius(dem, p) + radius(dem, j), d[3];
        if (!q->bonds0 || q->bonds0[j] == 0) continue;
        near += gn_branch(ctx, x, q->start + 4 * j, d) < reach * reach;
    }
    return near >= needed;
}

/* Marks loose particles. A particle without a bond at the start is loose, unless it sits in a pore
 * of a cohesive group most of whose particles are bonded: it then belongs to the specimen and just
 * missed its bonds. (Pores are searched pair by pair; above MANY pairs all such particles count as
 * part of the specimen.) */
gneiss_status gn_loose_find(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    const double MANY = 1e9;
    const gn_particles *q = &dem->particles;
    size_t n = q->soa.count, without = 0;
    int32_t groups = 1;
    if (dem->loose) return GNEISS_OK;
    for (size_t p = 0; p < n; p++) groups = q->group[p] >= groups ? q->group[p] + 1 : groups;
    int64_t *lead = gn_alloc_array((size_t)groups, sizeof *lead); /* bonded less unbonded ones */
    dem->loose = gn_alloc((size_t)dem->ids + 1);
    if (!lead || !dem->loose) {
        gn_free(lead);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu particles", n);
    }
    for (size_t p = 0; p < n; p++) {
        bool bonded = q->bonds0 && q->bonds0[p] > 0;
        lead[q->group[p]] += bonded ? 1 : -1;
        without += !bonded;
    }
    bool look = (double)without * (double)n <= MANY;
    for (size_t p = 0; p < n; p++) {
        bool bonded = q->bonds0 && q->bonds0[p] > 0;
        bool part = q->group[p] != 0 && lead[q->group[p]] > 0;
        dem->loose[q->id[p]] = !bonded && !(part && (!look || in_pore(ctx, dem, p)));
    }
    gn_free(lead);
    return GNEISS_OK;
}

/* Overlap over radius beyond which Hertz's theory, like any law for contacts that are small
 * relative to the particles, is misleading; for particles that were not bonded at the start. In
 * bonded specimens larger overlaps at platens and among debris do not affect the readings; beyond
 * the second value a particle is passing through. */
#define GN_DEPTH_LOOSE  0.1
#define GN_DEPTH_BONDED 0.5

gneiss_status gn_depth_begin(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    GN_TRY(gn_loose_find(ctx, dem, error));
    dem->depth.looked = (double)ctx->step;
    return GNEISS_OK;
}

double gn_depth_known(const gn_dem *dem, double radius) {
    return dem->depth.excess * GN_DEPTH_LOOSE * radius;
}

void gn_depth_note(const gn_step_context *ctx, gn_dem *dem, double overlap, double radius, size_t p,
                   double second) {
    gn_depth *d = &dem->depth;
    const double id = dem->particles.id[p];
    bool loose = dem->loose[(size_t)id] || (second >= 0.0 && dem->loose[(size_t)second]);
    double excess = overlap / radius / (loose ? GN_DEPTH_LOOSE : GN_DEPTH_BONDED);
    if (!(excess > d->excess)) return;
    *d = (gn_depth){excess,
                    overlap / radius,
                    overlap,
                    ctx->time,
                    second >= 0.0 ? fmin(id, second) : id,
                    second >= 0.0 ? fmax(id, second) : second,
                    d->looked};
}
