/* When the neighbour lists of the particles are rebuilt, and the order of the work. */
#include "base/error.h"
#include "base/new.h"
#include "boundary/boundary.h"
#include "conversion/conversion.h"
#include "drive/box.h"
#include "frame/periodic_box.h"
#include "inflow/removal.h"
#include "inflow/sources.h"
#include "particles/fragments.h"
#include "particles/lists.h"
#include "particles/particles.h"
#include "particles/refresh.h"
#include "particles/rows.h"
#include "world/particle_step.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

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

/* Returns an upper bound of the distance by which two objects that may touch moved apart in the
 * last step. */
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

/* Sorts the particles and renumbers everything that points at them. */
static gneiss_status reorder(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             gneiss_error *error) {
    const size_t n = dem->particles.soa.count;
    GN_FREED int32_t *place = gn_alloc_array(n + 1, sizeof *place);
    if (!place) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sort %zu particles", n);
    GN_TRY(gn_dem_sort(ctx, dem, place, error));
    return gn_boundary_renumber(boundary, place, error);
}

/* Drops the rows of removed particles if they are many. */
static gneiss_status drop_removed(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  gneiss_error *error) {
    GN_FREED int32_t *place = NULL;
    GN_TRY(gn_dem_drop(ctx, dem, &place, error));
    if (!place) return GNEISS_OK;
    gn_boundary_resized(boundary);
    return gn_boundary_renumber(boundary, place, error);
}

/* Removes the particles that have left the domain or entered a sink. */
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
    gn_dem_wrap(&w->ctx, &w->dem);
    GN_TRY(reorder(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(gn_lists_form(&w->ctx, &w->dem, error));
    return gn_converts(&w->ctx) ? gn_conversion_deactivate_all(&w->ctx, &w->dem, &w->boundary,
                                                               &w->solids, &w->converted, error)
                                : GNEISS_OK;
}

gneiss_status gn_dem_refresh(gn_world *w, gneiss_error *error) {
    gn_near_repack(&w->ctx, &w->dem);
    gn_dem_tune_skin(&w->ctx, &w->dem);
    gn_dem_widen_skin(&w->ctx, &w->dem, widest_gap(&w->ctx, &w->dem, &w->boundary, &w->box));
    GN_TRY(drop_removed(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(remove_gone(w, error));
    gn_dem_wrap(&w->ctx, &w->dem);
    GN_TRY(gn_flow_arrive(&w->ctx, &w->dem, &w->boundary, &w->ledger, false, error));
    if (gn_dem_order_is_old(&w->ctx, &w->dem))
        GN_TRY(reorder(&w->ctx, &w->dem, &w->boundary, error));
    GN_TRY(gn_dem_make_lists(&w->ctx, &w->dem, &w->box, error));
    gn_flow_listed(&w->ctx, &w->dem);
    gn_box_listed(&w->ctx, &w->dem, &w->box);
    gn_walls_listed(&w->ctx, &w->dem, &w->boundary);
    return GNEISS_OK;
}

gneiss_status gn_dem_restore(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                             gneiss_error *error) {
    gn_dem_null_particles(ctx, dem);
    GN_TRY(gn_dem_number_rows(dem, error));
    GN_TRY(gn_pieces_create(ctx, dem, error));
    for (int l = 0; l < GN_LIST_COUNT; l++) GN_TRY(gn_list_changed(ctx, dem, &dem->list[l], error));
    gn_dem_ready_kernels(ctx, dem);
    GN_TRY(gn_dem_ready_blocks(ctx, dem, error));
    gn_flow_listed(ctx, dem);
    GN_TRY(gn_near_lists(ctx, dem, box, error));
    return gn_near_resume(dem, error);
}
