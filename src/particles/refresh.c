#include "particles/refresh.h"

#include "base/new.h"
#include "frame/frame.h"
#include "neigh/neigh.h"
#include "particles/active_pairs.h"
#include "particles/dormant.h"
#include "particles/fragments.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "sched/hold.h"
#include "soa/single.h"

#include <math.h>
#include <string.h>

/* Flowing particles are sorted again from time to time; a bonded specimen keeps its order. The
 * decision depends on counts alone, so that every run sorts at the same step. */
bool gn_dem_order_is_old(const gn_step_context *ctx, const gn_dem *dem) {
    enum { REBUILDS_PER_SORT = 16 };
    return (!(ctx->effects & GN_FX_BONDS) || gn_scene_has_flow(&ctx->scene)) &&
           dem->verlet.rebuilds > 0 && dem->verlet.rebuilds % REBUILDS_PER_SORT == 0;
}

void gn_dem_wrap(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    if (!(ctx->effects & GN_FX_PERIODIC)) return;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < (int)ctx->scene.dimension; a++) {
            if (!gn_scene_periodic_along(&ctx->scene, a)) continue;
            double shift = floor((q->pos[4 * p + a] - ctx->scene.periodic_min[a]) / ctx->period[a]);
            q->pos[4 * p + a] -= shift * ctx->period[a];
            q->start[4 * p + a] -= shift * ctx->period[a]; /* displacements remain continuous */
        }
}

/* --- skin --- */

/* Returns the widest skin at which no particle has two images of another within reach. */
static double widest_skin(const gn_step_context *ctx, const gn_dem *dem) {
    double radius = 0.0, widest = INFINITY;
    if (!(ctx->effects & GN_FX_PERIODIC)) return widest;
    for (size_t p = 0; p < dem->particles.soa.count; p++)
        radius = fmax(radius, dem->particles.pos[4 * p + 3]);
    for (int a = 0; a < 3; a++)
        if (ctx->period[a] > 0.0)
            widest = fmin(widest, (0.5 * ctx->period[a] - 2.0 * radius) * (1.0 - 1e-9));
    return fmax(widest, dem->verlet.skin);
}

/* A rebuild costs about as much as fifteen steps. Lists that last less than 150 steps therefore
 * cost more than a tenth of the run, and the skin is widened; if they last long it may be
 * needlessly wide and is narrowed. The lifetime is counted in steps and not in seconds, so that
 * every run decides alike; forces do not depend on the skin. */
void gn_dem_tune_skin(const gn_step_context *ctx, gn_dem *dem) {
    enum { SHORT_LIFE = 160, LONG_LIFE = 2000 };
    if (ctx->scene.skin > 0.0 || dem->verlet.rebuilds == 0 || dem->verlet.forced) return;
    int64_t life = ctx->step - dem->verlet.last_step;
    double most = fmin(6.0 * dem->verlet.skin_start, widest_skin(ctx, dem));
    if (life < SHORT_LIFE) dem->verlet.skin = fmin(1.25 * dem->verlet.skin, most);
    if (life > LONG_LIFE) dem->verlet.skin = fmax(0.8 * dem->verlet.skin, dem->verlet.skin_start);
}

/* Pairs that were in contact one step ago must be listed, because their contact acted for a part of
 * the step. */
void gn_dem_widen_skin(const gn_step_context *ctx, gn_dem *dem, double gap) {
    gn_verlet *q = &dem->verlet;
    bool given = ctx->scene.skin > 0.0;
    if (given) q->skin = ctx->scene.skin;
    double needed = fmin(gap, widest_skin(ctx, dem));
    if (!(needed > q->skin)) return;
    q->skin = needed;
    if (given) q->widened = fmax(q->widened, needed);
}

void gn_dem_keep_skin(const gn_step_context *ctx, gn_dem *dem) {
    enum { NEITHER_SHORT_NOR_LONG = 1000 };
    dem->verlet.last_step = ctx->step - NEITHER_SHORT_NOR_LONG;
}

void gn_dem_force_lists(gn_dem *dem, bool forced) {
    dem->verlet.forced = forced;
}

void gn_dem_set_paths(gn_dem *dem, double most) {
    dem->verlet.drift = most;
    dem->verlet.closed = 2.0 * most;
}

/* --- lists --- */

gneiss_status gn_dem_ready_blocks(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
    bool held = true;
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        gn_contact_list *list = &dem->list[l];
        if (!list->sums) list->sums = gn_alloc_array(list->partials.blocks + 1, sizeof *list->sums);
        held = held && list->sums;
    }
    if (!dem->motion_sums) {
        dem->motion_blocks = gn_blocks(dem->particles.soa.count, GN_PARTICLE_BLOCK);
        dem->motion_sums = gn_alloc_array(dem->motion_blocks + 1, sizeof *dem->motion_sums);
        GN_TRY(gn_hold_create(&dem->hold, dem->motion_blocks, error));
    }
    bool confined = ctx->effects & GN_FX_CONFINED;
    if (confined && !dem->around)
        dem->around = gn_alloc_array(dem->particles.soa.count + 1, 2 * sizeof(double));
    if (!held || !dem->motion_sums || (confined && !dem->around))
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for block sums");
    gn_dem_sum_masses(dem);
    if (gn_converts(ctx)) GN_TRY(gn_dormant_find_blocks(dem, error));
    return gn_dem_deal(ctx, dem, error);
}

void gn_dem_ready_kernels(const gn_step_context *ctx, gn_dem *dem) {
    double period[3] = {0, 0, 0};
    if (ctx->effects & GN_FX_PERIODIC) memcpy(period, ctx->period, sizeof period);
    gn_particles_to_single(&dem->particles, dem->particles.ref, ctx->threads);
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        dem->list[l].uniform = gn_list_find_uniform(&dem->list[l].contacts);
        gn_contacts_to_single(&dem->list[l].contacts, &dem->particles, period, ctx->threads);
    }
}

gneiss_status gn_dem_make_lists(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                                gneiss_error *error) {
    GN_TRY(gn_pairs_make(ctx, dem, box, error));
    GN_TRY(gn_dem_ready_blocks(ctx, dem, error));
    memcpy(dem->particles.ref, dem->particles.pos, dem->particles.soa.count * 4 * sizeof(double));
    gn_dem_ready_kernels(ctx, dem);
    GN_TRY(gn_active_pairs_choose(ctx, dem, box, error));
    gn_dem_set_paths(dem, 0.0);
    dem->verlet.rebuilds++;
    dem->verlet.last_step = ctx->step;
    return GNEISS_OK;
}
