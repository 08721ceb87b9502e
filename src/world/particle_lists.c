/* When the neighbour lists of the particles are rebuilt, and the order of the work. */
#include "base/error.h"
#include "base/memory.h"
#include "base/new.h"
#include "boundary/boundary.h"
#include "boundary/surface.h"
#include "conversion/conversion.h"
#include "drive/box.h"
#include "frame/periodic_box.h"
#include "inflow/removal.h"
#include "inflow/sources.h"
#include "particles/dem.h"
#include "particles/dormant.h"
#include "particles/fragments.h"
#include "particles/lists.h"
#include "soa/single.h"
#include "world/particle_step.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

/* Sorts particles along the Morton curve and renumbers everything that points at them. */
static gneiss_status reorder(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             gneiss_error *error) {
    size_t n = dem->particles.soa.count;
    int32_t *order = gn_alloc_array(n + 1, sizeof *order),
            *place = gn_alloc_array(n + 1, sizeof *place);
    gn_particles now = {0};
    gneiss_status status =
        order && place ? gn_morton_order(&dem->particles, (int)ctx->scene.dimension, order, error)
                       : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu particles", n);
    if (status == GNEISS_OK)
        status = gn_soa_create(&gn_particle_record, &now, n, ctx->effects, error);
    if (status == GNEISS_OK) {
        gn_soa_permute(&gn_particle_record, &now, &dem->particles, order);
        gn_soa_destroy(&gn_particle_record, &dem->particles);
        dem->particles = now;
        gn_dem_null_particles(ctx, dem);
        for (size_t p = 0; p < n; p++) place[order[p]] = (int32_t)p;
        gn_dem_number_ids(dem);
    }
    if (status == GNEISS_OK) status = gn_lists_follow_rows(ctx, dem, place, error);
    if (status == GNEISS_OK) status = gn_boundary_renumber(boundary, place, error);
    gn_free(order);
    gn_free(place);
    return status;
}

/* --- periodic box --- */

static void wrap(const gn_step_context *ctx, gn_dem *dem) {
    gn_particles *q = &dem->particles;
    for (size_t p = 0; p < q->soa.count; p++)
        for (int a = 0; a < (int)ctx->scene.dimension; a++) {
            if (!gn_scene_periodic_along(&ctx->scene, a)) continue;
            double shift = floor((q->pos[4 * p + a] - ctx->scene.periodic_min[a]) / ctx->period[a]);
            q->pos[4 * p + a] -= shift * ctx->period[a];
            q->start[4 * p + a] -= shift * ctx->period[a]; /* displacements stay continuous */
        }
}

/* Allocates the sums of blocks and distributes the blocks of the lists among threads. */
static gneiss_status ready_blocks(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error) {
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
    return gn_dem_deal(dem, error);
}

/* Particles that flow are sorted again now and then; a bonded specimen by itself keeps its order.
 * The decision rests on counts alone, so that it falls at the same step in every run. */
static bool order_is_old(const gn_step_context *ctx, const gn_dem *dem) {
    enum { REBUILDS_PER_SORT = 16 };
    return (!(ctx->effects & GN_FX_BONDS) || gn_scene_has_flow(&ctx->scene)) &&
           dem->verlet.rebuilds > 0 && dem->verlet.rebuilds % REBUILDS_PER_SORT == 0;
}

/* A particle must not have two images of another within reach. */
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

/* A rebuild costs about as much as fifteen steps, so lists that live for less than 150 cost more
 * than a tenth of the run: the skin grows. Lists that live long may be needlessly wide: it shrinks
 * again. Steps and not seconds decide, so that every run does the same; forces do not depend on the
 * skin at all. */
static void tune_skin(const gn_step_context *ctx, gn_dem *dem) {
    enum { SHORT_LIFE = 160, LONG_LIFE = 2000 };
    if (ctx->scene.skin > 0.0 || dem->verlet.rebuilds == 0 || dem->flow.forced) return;
    int64_t life = ctx->step - dem->verlet.last_step;
    double most = fmin(6.0 * dem->verlet.skin_start, widest_skin(ctx, dem));
    if (life < SHORT_LIFE) dem->verlet.skin = fmin(1.25 * dem->verlet.skin, most);
    if (life > LONG_LIFE) dem->verlet.skin = fmax(0.8 * dem->verlet.skin, dem->verlet.skin_start);
}

/* --- the lists --- */

static double largest_speed(const double *rows, size_t count) {
    double most = 0.0;
    for (size_t p = 0; p < count; p++) most = fmax(most, gn_dot3(rows + 4 * p, rows + 4 * p));
    return sqrt(most);
}

static double surface_speed(const gn_boundary *boundary, const gn_surface *surface) {
    if (surface->body < 0) return largest_speed(surface->velocity, surface->vertices);
    const gn_rigid *b = &boundary->bodies[surface->body];
    return sqrt(gn_dot3(b->velocity, b->velocity)) + b->reach * sqrt(gn_dot3(b->spin, b->spin));
}

/* By how much two things that may touch moved apart in the last step, at most. */
static double widest_gap(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                         const gn_periodic_box *box) {
    double own = largest_speed(dem->particles.vel, dem->particles.soa.count), other = own;
    for (size_t k = 0; k < ctx->scene.wall_count; k++) {
        const gn_wall *wall = &boundary->walls[k];
        other = fmax(other, fabs(gn_dot3(wall->velocity, wall->normal)));
    }
    for (size_t k = 0; k < boundary->surface_count; k++)
        other = fmax(other, surface_speed(boundary, &boundary->surfaces[k]));
    return ctx->dt_past * (own + other + gn_box_speed(box)) * (1.0 + 1e-6);
}

/* Whatever was in touch a step ago has to be listed: its contact acted for a part of the step. */
static void widen_skin(const gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary,
                       const gn_periodic_box *box) {
    gn_verlet *q = &dem->verlet;
    bool given = ctx->scene.skin > 0.0;
    if (given) q->skin = ctx->scene.skin;
    double needed = fmin(widest_gap(ctx, dem, boundary, box), widest_skin(ctx, dem));
    if (!(needed > q->skin)) return;
    q->skin = needed;
    if (given) q->widened = fmax(q->widened, needed);
}

/* Prepares the data that kernels read besides the records, once lists and `ref` are complete. */
static void ready_kernels(const gn_step_context *ctx, gn_dem *dem) {
    double period[3] = {0, 0, 0};
    if (ctx->effects & GN_FX_PERIODIC) memcpy(period, ctx->period, sizeof period);
    gn_particles_to_single(&dem->particles, dem->particles.ref, ctx->threads);
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        dem->list[l].uniform = gn_list_find_uniform(&dem->list[l].contacts);
        gn_contacts_to_single(&dem->list[l].contacts, &dem->particles, period, ctx->threads);
    }
}

/* Removes the particles that have left the domain or come into a sink. */
static gneiss_status remove_gone(gn_world *w, gneiss_error *error) {
    GN_FREED int32_t *gone = NULL;
    GN_TRY(gn_particles_find_gone(&w->ctx, &w->dem, &w->boundary, &w->ledger, &gone, error));
    if (!gone) return GNEISS_OK;
    gn_coupled_remove(&w->ctx, &w->dem, &w->solids, &w->zones, &w->ledger, gone);
    GN_TRY(gn_particles_take_out(&w->ctx, &w->dem, &w->ledger, gone, error));
    return gn_gauge_leave(&w->ctx, &w->dem, &w->gauge, error);
}

gneiss_status gn_dem_arrange(gn_world *w, gneiss_error *error) {
    GN_TRY(remove_gone(w, error));
    if (w->ctx.effects & GN_FX_PERIODIC) wrap(&w->ctx, &w->dem);
    GN_TRY(reorder(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(gn_lists_form(&w->ctx, &w->dem, error));
    return gn_converts(&w->ctx) ? gn_conversion_deactivate_all(&w->ctx, &w->dem, &w->boundary,
                                                               &w->solids, &w->zones, error)
                                : GNEISS_OK;
}

gneiss_status gn_dem_refresh(gn_world *w, gneiss_error *error) {
    gn_near_repack(&w->ctx, &w->dem);
    tune_skin(&w->ctx, &w->dem);
    widen_skin(&w->ctx, &w->dem, &w->boundary, &w->box);
    GN_TRY(gn_dem_drop(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(remove_gone(w, error));
    if (w->ctx.effects & GN_FX_PERIODIC) wrap(&w->ctx, &w->dem);
    GN_TRY(gn_flow_arrive(&w->ctx, &w->dem, &w->boundary, &w->ledger, false, error));
    if (order_is_old(&w->ctx, &w->dem)) GN_TRY(reorder(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(gn_pairs_make(&w->ctx, &w->dem, &w->box, error));
    GN_TRY(ready_blocks(&w->ctx, &w->dem, error));
    memcpy(w->dem.particles.ref, w->dem.particles.pos,
           w->dem.particles.soa.count * 4 * sizeof(double));
    ready_kernels(&w->ctx, &w->dem);
    GN_TRY(gn_near_lists(&w->ctx, &w->dem, &w->box, error));
    w->dem.verlet.drift = w->dem.verlet.closed = 0.0;
    w->dem.verlet.rebuilds++;
    w->dem.verlet.last_step = w->ctx.step;
    gn_sinks_listed(&w->ctx, &w->dem);
    gn_box_listed(&w->ctx, &w->dem, &w->box);
    gn_walls_listed(&w->ctx, &w->dem, &w->boundary);
    return GNEISS_OK;
}

gneiss_status gn_dem_restore(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                             gneiss_error *error) {
    gn_dem_null_particles(ctx, dem);
    dem->index_of_id = gn_alloc_array((size_t)dem->ids + 1, sizeof *dem->index_of_id);
    if (!dem->index_of_id)
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for particle numbers");
    GN_TRY(gn_pieces_create(ctx, dem, error));
    gn_dem_number_ids(dem);
    for (int l = 0; l < GN_LIST_COUNT; l++) GN_TRY(gn_list_changed(ctx, dem, &dem->list[l], error));
    ready_kernels(ctx, dem);
    GN_TRY(ready_blocks(ctx, dem, error));
    gn_sinks_listed(ctx, dem);
    GN_TRY(gn_near_lists(ctx, dem, box, error));
    return gn_near_resume(dem, error);
}
