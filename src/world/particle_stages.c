/* Applies the scene of the next stage to the particles. */
#include "base/error.h"
#include "base/memory.h"
#include "boundary/contact_rows.h"
#include "particles/bonds.h"
#include "particles/law.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "world/particle_step.h"
#include "world/world.h"

#include <math.h>

/* Forms or dissolves the bonds that the stage requires. The lists are those of the last step and
 * contain all contacts that carry a force. */
static gneiss_status enter_bonds(const gn_step_context *ctx, gn_dem *dem, gn_stages *stages,
                                 gneiss_error *error) {
    bool said = ctx->scene.bonds_stage == stages->now + 1, on = ctx->scene.bonds == GN_SWITCH_ON;
    if (!(ctx->effects & GN_FX_BONDS)) return GNEISS_OK;
    if (on && said) return gn_bonds_add(ctx, dem, error);
    if (!on) gn_bonds_dissolve(ctx, dem);
    return GNEISS_OK;
}

/* Computes the parameters of contacts with walls and surfaces by Hertz's law again, and books the
 * change of the stored energy. */
static gneiss_status enter_hertz(const gn_step_context *ctx, gn_dem *dem,
                                 const gn_boundary *boundary, gn_ledger *ledger,
                                 gneiss_error *error) {
    gn_hertz_pair *before;
    gneiss_status status = gn_hertz_renew(ctx, dem, &before, error);
    if (status == GNEISS_OK && before)
        ledger->energy.stage_change += gn_touches_gain(ctx, dem, boundary, before);
    gn_free(before);
    return status;
}

gneiss_status gn_world_enter_particles(gn_world *world, gneiss_error *error) {
    if (!world->ctx.scene.has_specimen) return GNEISS_OK;
    double stored = gn_contacts_stored(&world->ctx, &world->dem, &world->box);
    GN_TRY(enter_hertz(&world->ctx, &world->dem, &world->boundary, &world->ledger, error));
    GN_TRY(gn_dem_take_effects(&world->ctx, &world->dem, error));
    GN_TRY(enter_bonds(&world->ctx, &world->dem, &world->stages, error));
    world->ledger.energy.stage_change +=
        gn_contacts_stored(&world->ctx, &world->dem, &world->box) - stored;
    gn_dem_step_changed(&world->ctx, &world->dem); /* dashpots */
    gn_active_pairs_forget(&world->ctx,
                           &world->dem); /* velocities and parameters may have changed */
    return gn_sets_enter(&world->ctx, &world->dem, error);
}
