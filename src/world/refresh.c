/* Decides in every step whether the lists are rebuilt (gn_world_refresh_lists), and rebuilds those
 * of all parts in their order (gn_world_rebuild). */
#include "particles/refresh.h"
#include "base/error.h"
#include "base/timer.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "inflow/removal.h"
#include "inflow/sources.h"
#include "particles/particles.h"
#include "timestep/indentation.h"
#include "timestep/timestep.h"
#include "world/features.h"
#include "world/invariants.h"
#include "world/particle_step.h"
#include "world/ranks.h"
#include "world/world.h"

#include <math.h>

gneiss_status gn_world_rebuild(gn_world *world, gneiss_error *error) {
    const double start = gn_now();
    gn_ranks_whole(world->ctx.ranks);
    const bool first = world->dem.verlet.rebuilds == 0;
    GN_TRY(gn_world_refresh_particles(world, error));
    GN_TRY(gn_boundary_refresh(&world->ctx, &world->dem, &world->boundary, first, error));
    GN_TRY(gn_features_follow_lists(world, error));
    if (world->ctx.ranks) GN_TRY(gn_world_share_lists(world, error));
    GN_TRY(gn_depth_update(&world->ctx, &world->dem, &world->boundary, error));
    gn_world_assert_lists(&world->ctx, &world->dem, &world->boundary);
    world->ctx.seconds[GN_PHASE_lists] += gn_now() - start;
    return GNEISS_OK;
}

gn_convertible gn_world_convertible(gn_world *world) {
    return (gn_convertible){&world->ctx,         &world->dem,    &world->boundary,
                            &world->solids,      &world->zones,  &world->converted,
                            &world->most_loaded, &world->ledger, &world->outcome,
                            gn_world_rebuild,    world};
}

gneiss_status gn_world_restore(gn_world *world, gneiss_error *error) {
    GN_TRY(gn_world_restore_particles(&world->ctx, &world->dem, &world->box, error));
    GN_TRY(gn_boundary_restore(&world->ctx, &world->dem, &world->boundary, error));
    if (world->ctx.ranks) GN_TRY(gn_world_share_lists(world, error));
    return gn_features_follow_lists(world, error);
}

gneiss_status gn_world_renew_lists(gn_world *world, gneiss_error *error) {
    bool more = false;
    GN_TRY(gn_world_rebuild(world, error));
    /* A deformable surface may have come close to many particles since the last check. */
    GN_TRY(
        gn_timestep_surfaces_yield_more(&world->ctx, &world->dem, &world->boundary, &more, error));
    if (more)
        GN_TRY(gn_timestep_check(&world->ctx, &world->dem, &world->boundary, &world->solids,
                                 &world->zones, &world->ledger, false, error));
    return gn_timestep_check_lists(&world->ctx, &world->dem, &world->boundary, &world->solids,
                                   &world->zones, &world->ledger, error);
}

/* Returns the path of a particle, m, after which the lists are rebuilt even if no neighbours
 * require it, because sinks and the sides of a domain are checked then as well. */
static double farthest(const gn_step_context *ctx, const gn_dem *dem) {
    const double skin = dem->verlet.skin;
    return ctx->effects & GN_FX_WALLS || ctx->scene.has_domain || ctx->scene.sink_count
               ? skin
               : 8.0 * skin;
}

/* Returns the largest path of a particle in a step, m, if Hertzian contacts do not limit the step:
 * pairs must then be listed one step before they touch, because the step is far too long for their
 * collision. If contacts limit the step, paths are shorter, and 0 is returned. */
static double flown(const gn_step_context *ctx, const gn_dem *dem) {
    if (!(ctx->effects & GN_FX_HERTZ) || ctx->scene.step > 0.0 || ctx->step == 0) return 0.0;
    const double way = ctx->dt * sqrt(dem->done.motion.speed2);
    return way > 0.02 * dem->radius_min ? way : 0.0;
}

/* Two particles approach each other by at most twice the largest path, plus the shortening of a
 * box; a particle and a wall or a surface by the sum of their paths. A cheap bound sums up the
 * largest speeds; when it is exhausted, the true displacements are computed. */
gneiss_status gn_world_refresh_lists(gn_world *world, gneiss_error *error) {
    const gn_verlet *v = &world->dem.verlet;
    double other = gn_boundary_travel(&world->ctx, &world->boundary, false);
    const double ahead = flown(&world->ctx, &world->dem), flow = world->box.path + 2.0 * ahead;
    gn_dem_force_lists(&world->dem, false);
    const bool due =
        gn_flow_due(&world->ctx, &world->dem) || gn_sinks_are_due(&world->ctx, &world->dem);
    const double most = farthest(&world->ctx, &world->dem) - ahead;
    if (!due && v->closed + flow <= v->skin && v->drift + other <= most) return GNEISS_OK;
    double start = gn_now();
    gn_ranks_whole(world->ctx.ranks);
    gn_dem_look_at_travel(&world->ctx, &world->dem, &world->box);
    other = gn_boundary_travel(&world->ctx, &world->boundary, true);
    world->ctx.seconds[GN_PHASE_lists] += gn_now() - start;
    /* A tenth of the skin must remain as a margin, or the next step would exhaust it again. */
    if (1.1 * v->closed + 1.1 * flow <= v->skin && v->drift + other <= 0.9 * most) {
        if (!due) return GNEISS_OK;
        gn_dem_force_lists(&world->dem, true);
    }
    return gn_world_renew_lists(world, error);
}
