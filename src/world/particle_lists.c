/* Rebuilds the lists of the particles (gn_world_refresh_particles, called by refresh.c): removal,
 * sources, sorting, then the pairs. */
#include "base/error.h"
#include "base/new.h"
#include "boundary/boundary.h"
#include "conversion/conversion.h"
#include "drive/box.h"
#include "frame/periodic_box.h"
#include "inflow/removal.h"
#include "inflow/sources.h"
#include "particles/fragments.h"
#include "particles/joint_faces.h"
#include "particles/joints.h"
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

/* Sorts the particles and renumbers everything that refers to them. */
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
static gneiss_status remove_gone(gn_world *world, gneiss_error *error) {
    GN_FREED int32_t *gone = NULL;
    GN_TRY(gn_particles_find_gone(&world->ctx, &world->dem, &world->boundary, &world->ledger, &gone,
                                  error));
    if (!gone) return GNEISS_OK;
    gn_coupled_remove(&world->ctx, &world->dem, &world->solids, &world->zones, &world->ledger,
                      gone);
    GN_TRY(gn_particles_take_out(&world->ctx, &world->dem, &world->ledger, gone, error));
    return gn_gauge_leave(&world->ctx, &world->dem, &world->gauge, error);
}

gneiss_status gn_world_arrange_particles(gn_world *world, gneiss_error *error) {
    GN_TRY(remove_gone(world, error));
    gn_dem_wrap(&world->ctx, &world->dem);
    GN_TRY(reorder(&world->ctx, &world->dem, &world->boundary, error));
    GN_TRY(gn_lists_form(&world->ctx, &world->dem, error));
    return gn_converts(&world->ctx)
               ? gn_conversion_deactivate_all(&world->ctx, &world->dem, &world->boundary,
                                              &world->solids, &world->converted, error)
               : GNEISS_OK;
}

gneiss_status gn_world_refresh_particles(gn_world *world, gneiss_error *error) {
    gn_active_pairs_repack(&world->ctx, &world->dem);
    gn_dem_tune_skin(&world->ctx, &world->dem);
    gn_dem_widen_skin(&world->ctx, &world->dem,
                      widest_gap(&world->ctx, &world->dem, &world->boundary, &world->box));
    GN_TRY(drop_removed(&world->ctx, &world->dem, &world->boundary, error));
    GN_TRY(remove_gone(world, error));
    gn_dem_wrap(&world->ctx, &world->dem);
    GN_TRY(
        gn_flow_arrive(&world->ctx, &world->dem, &world->boundary, &world->ledger, false, error));
    if (gn_dem_order_is_old(&world->ctx, &world->dem))
        GN_TRY(reorder(&world->ctx, &world->dem, &world->boundary, error));
    GN_TRY(gn_dem_make_lists(&world->ctx, &world->dem, &world->box, error));
    world->ledger.energy.friction -= gn_joints_take_change(&world->dem);
    gn_flow_listed(&world->ctx, &world->dem);
    gn_box_listed(&world->ctx, &world->dem, &world->box);
    gn_walls_listed(&world->ctx, &world->dem, &world->boundary);
    return GNEISS_OK;
}

gneiss_status gn_world_restore_particles(const gn_step_context *ctx, gn_dem *dem,
                                         const gn_periodic_box *box, gneiss_error *error) {
    gn_dem_null_particles(ctx, dem);
    GN_TRY(gn_dem_number_rows(dem, error));
    GN_TRY(gn_joint_faces_list_near(ctx, dem, error));
    GN_TRY(gn_pieces_create(ctx, dem, error));
    for (int l = 0; l < GN_LIST_COUNT; l++) GN_TRY(gn_list_changed(ctx, dem, &dem->list[l], error));
    gn_dem_ready_kernels(ctx, dem);
    GN_TRY(gn_dem_ready_blocks(ctx, dem, error));
    gn_flow_listed(ctx, dem);
    GN_TRY(gn_active_pairs_choose(ctx, dem, box, error));
    return gn_active_pairs_resume(dem, error);
}
