/* One step of the model (gn_world_step): lists, forces of all parts, motion, and the ledger.
 * Particles move in the sweep that computes their forces (gn_world_particle_forces); `move` moves
 * the blocks that a feature held back, walls and bodies. Each part implements its own share
 * (particle_step.h, boundary.h, solids.h); features that only some scenes use are hooked into the
 * places of frame/feature.h. */
#include "base/error.h"
#include "base/timer.h"
#include "boundary/boundary.h"
#include "frame/balance.h"
#include "particles/particles.h"
#include "solids/solids.h"
#include "timestep/timestep.h"
#include "world/features.h"
#include "world/particle_step.h"
#include "world/world.h"

#include <math.h>

/* Books time between two places of a step, in the same steps as the sweep does. Lists and elements
 * book their own time. */
typedef struct watch {
    gn_world *w;
    bool runs;
    double mark;
} watch;

static void start(watch *time) {
    if (time->runs) time->mark = gn_now();
}

static void lap(watch *time, gn_phase phase) {
    if (!time->runs || (phase == GN_PHASE_exchange && !time->w->features.holds)) return;
    double now = gn_now();
    time->w->ctx.seconds[phase] += GN_BOOKED * (now - time->mark);
    time->mark = now;
}

/* Bonds made with a load beyond their strength break in the first evaluation. The energy that
 * contacts lose there counts as stored at the start; so does the energy that a sink or the domain
 * removed before. */
static void begin_ledger(gn_energy *energy) {
    energy->stored_at_start = gn_energy_stored(energy) + energy->removed;
#define X(name, text) energy->stored_at_start += energy->name;
    GN_CONTACT_LOSSES(X)
#undef X
}

/* Takes the readings of the particles and of their contacts. */
static void read_particles(gn_world *world) {
    gn_energy *e = &world->ledger.energy;
    gn_world_measure_particles(world, e, world->ledger.stress);
    gn_boundary_measure(&world->ctx, &world->boundary, e);
    if (world->ctx.step == 0) begin_ledger(e);
    world->ledger.balance = (gn_balance){0};
    gn_world_balance_particles(&world->dem, &world->boundary, &world->ledger.balance);
    gn_boundary_balance(&world->ctx, &world->boundary, &world->ledger.balance);
    world->ledger.reading = *e;
    world->ledger.measured_step = world->ctx.step + 1;
    world->ledger.measured_time = world->ctx.time;
}

/* Adds the ledger of the elements, which is separate, to the reading. Elements belong to the
 * specimen only in a model without particles. */
static gneiss_status read_elements(gn_world *world, gneiss_error *error) {
    if (!world->ctx.scene.has_specimen) gn_elements_stress(&world->solids, world->ledger.stress);
    gn_elements_balance(&world->solids, &world->ledger.balance);
    gn_elements_book(&world->solids, &world->ledger.reading);
    GN_TRY(gn_features_run(world, GN_HOOK_ADD_TO_READING, error));
    world->ledger.unbalanced = fmin(world->ledger.balance.ratio, GN_UNBALANCED_MOST);
    return GNEISS_OK;
}

/* Moves held blocks, and rigid walls and bodies. Works are trapezoidal: one half closes the
 * interval that led here, one opens the coming one, and the reading lies between them. */
static gneiss_status move(gn_world *world, watch *time, gneiss_error *error) {
    start(time);
    gn_world_move_particles(&world->ctx, &world->dem, &world->boundary, world->ctx.measure);
    lap(time, GN_PHASE_motion);
    gn_boundary_book(&world->ctx, &world->boundary, GN_HALF_BEFORE, &world->ledger.energy);
    gn_boundary_kick(&world->ctx, &world->dem, &world->boundary, &world->ledger);
    gn_world_book_particles(&world->dem, GN_HALF_BEFORE, &world->ledger.energy);
    GN_TRY(gn_features_run(world, GN_HOOK_WORK, error));
    if (world->ctx.measure) read_particles(world);
    gn_world_book_particles(&world->dem, GN_HALF_AFTER, &world->ledger.energy);
    gn_boundary_move(&world->ctx, &world->dem, &world->boundary, &world->ledger);
    gn_boundary_book(&world->ctx, &world->boundary, GN_HALF_AFTER, &world->ledger.energy);
    lap(time, GN_PHASE_walls);
    return gn_features_run(world, GN_HOOK_MOVED, error);
}

static gneiss_status finish(gn_world *world, watch *time, gneiss_error *error) {
    const bool measure = world->ctx.measure;
    GN_TRY(move(world, time, error));
    GN_TRY(gn_timestep_check_particle_paths(&world->ctx, &world->dem, &world->boundary, measure,
                                            error));
    GN_TRY(gn_timestep_check_boundary_paths(&world->ctx, &world->dem, &world->boundary, error));
    lap(time, GN_PHASE_motion);
    GN_TRY(gn_elements_move(&world->ctx, &world->solids, &world->ledger, world->ctx.seconds,
                            measure, error));
    start(time);
    GN_TRY(gn_features_run(world, GN_HOOK_ELEMENTS_MOVED, error));
    lap(time, GN_PHASE_exchange);
    if (measure) GN_TRY(read_elements(world, error));
    return gn_timestep_check_element_paths(&world->ctx, &world->dem, &world->solids, error);
}

static gneiss_status find_forces(gn_world *world, watch *time, gneiss_error *error) {
    GN_TRY(gn_features_run(world, GN_HOOK_BEFORE_FORCES, error));
    /* Also moves every block that no feature holds, as soon as its forces are complete. */
    gn_world_particle_forces(world, world->ctx.measure || world->ctx.sums);
    start(time);
    gn_boundary_forces(&world->ctx, &world->dem, &world->boundary);
    lap(time, GN_PHASE_walls);
    gn_elements_forces(&world->ctx, &world->solids, world->ctx.seconds, world->ctx.measure);
    start(time);
    GN_TRY(gn_features_run(world, GN_HOOK_ACT, error));
    lap(time, GN_PHASE_exchange);
    return GNEISS_OK;
}

gneiss_status gn_world_step(gn_world *world, bool measure, gneiss_error *error) {
    watch time = {world, world->ctx.step % GN_BOOKED == 0, 0.0};
    world->ctx.measure = measure;
    world->ctx.sums = false;
    GN_TRY(gn_features_run(world, GN_HOOK_BEFORE_LISTS, error));
    const int64_t broken = world->dem.broken_tension + world->dem.broken_shear;
    GN_TRY(gn_world_refresh_lists(world, error));
    GN_TRY(gn_features_run(world, GN_HOOK_LIMIT, error));
    GN_TRY(gn_features_run(world, GN_HOOK_REQUEST_READING, error));
    GN_TRY(find_forces(world, &time, error));
    gneiss_status status = finish(world, &time, error);
    world->ctx.time += world->ctx.dt;
    world->ctx.dt_past = world->ctx.dt;
    world->ctx.step++;
    if (status == GNEISS_OK)
        status = gn_timestep_check_after_breaks(&world->ctx, &world->dem, &world->boundary,
                                                &world->solids, &world->zones, broken, error);
    return status == GNEISS_OK ? gn_features_run(world, GN_HOOK_AFTER_STEP, error) : status;
}
