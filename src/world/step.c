/* One step of the model: lists, forces of all parts, motion, and the ledger. Each part implements
 * its own share (particle_step.h, boundary.h, solids.h); features that only some scenes use are
 * hooked into the places of frame/feature.h. */
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

/* Books time between two places of a step, in the steps in which the sweep does. Lists and elements
 * have their own. */
typedef struct watch {
    gn_world *w;
    bool runs;
    double mark;
} watch;

static void start(watch *t) {
    if (t->runs) t->mark = gn_now();
}

static void lap(watch *t, gn_phase phase) {
    if (!t->runs || (phase == GN_PHASE_exchange && !t->w->features.holds)) return;
    double now = gn_now();
    t->w->ctx.seconds[phase] += GN_BOOKED * (now - t->mark);
    t->mark = now;
}

/* Bonds made with a load beyond their strength break in the first evaluation: the energy that
 * contacts lose there counts as stored at the start, and so does the energy removed by a sink or
 * the domain before. */
static void begin_ledger(gn_energy *e) {
    e->stored_at_start = gn_energy_stored(e) + e->removed;
#define X(name, text) e->stored_at_start += e->name;
    GN_CONTACT_LOSSES(X)
#undef X
}

/* Takes the readings of the particles and of their contacts. */
static void read_particles(gn_world *w) {
    gn_energy *e = &w->ledger.energy;
    gn_dem_measure(w, e, w->ledger.stress);
    gn_boundary_measure(&w->ctx, &w->boundary, e);
    if (w->ctx.step == 0) begin_ledger(e);
    w->ledger.balance = (gn_balance){0};
    gn_dem_balance(&w->dem, &w->boundary, &w->ledger.balance);
    gn_boundary_balance(&w->ctx, &w->boundary, &w->ledger.balance);
    w->ledger.reading = *e;
}

/* Elements have a ledger of their own, which is added to the reading only. In a model with
 * particles elements are no part of the specimen; without particles they are the specimen. */
static gneiss_status read_elements(gn_world *w, gneiss_error *error) {
    if (!w->ctx.scene.has_specimen) gn_elements_stress(&w->solids, w->ledger.stress);
    gn_elements_balance(&w->solids, &w->ledger.balance);
    gn_elements_book(&w->solids, &w->ledger.reading);
    GN_TRY(gn_features_run(w, GN_HOOK_READ, error));
    w->ledger.unbalanced = fmin(w->ledger.balance.ratio, GN_UNBALANCED_MOST);
    return GNEISS_OK;
}

/* Moves held blocks, and rigid walls and bodies. Works are trapezoidal: one half closes the
 * interval that led here, one opens the coming one, and the reading lies between them. */
static gneiss_status move(gn_world *w, watch *time, gneiss_error *error) {
    start(time);
    gn_dem_move(&w->ctx, &w->dem, &w->boundary, w->ctx.measure);
    lap(time, GN_PHASE_motion);
    gn_boundary_book(&w->ctx, &w->boundary, GN_HALF_BEFORE, &w->ledger.energy);
    gn_boundary_kick(&w->ctx, &w->dem, &w->boundary, &w->ledger);
    gn_dem_book(&w->dem, GN_HALF_BEFORE, &w->ledger.energy);
    GN_TRY(gn_features_run(w, GN_HOOK_WORK, error));
    if (w->ctx.measure) read_particles(w);
    gn_dem_book(&w->dem, GN_HALF_AFTER, &w->ledger.energy);
    gn_boundary_move(&w->ctx, &w->dem, &w->boundary, &w->ledger);
    gn_boundary_book(&w->ctx, &w->boundary, GN_HALF_AFTER, &w->ledger.energy);
    lap(time, GN_PHASE_walls);
    return gn_features_run(w, GN_HOOK_MOVED, error);
}

static gneiss_status finish(gn_world *w, watch *time, gneiss_error *error) {
    const bool measure = w->ctx.measure;
    GN_TRY(move(w, time, error));
    GN_TRY(gn_dem_check_paths(&w->ctx, &w->dem, &w->boundary, measure, error));
    GN_TRY(gn_boundary_check_paths(&w->ctx, &w->dem, &w->boundary, error));
    lap(time, GN_PHASE_motion);
    GN_TRY(gn_elements_move(&w->ctx, &w->solids, &w->ledger, w->ctx.seconds, measure, error));
    start(time);
    GN_TRY(gn_features_run(w, GN_HOOK_ELEMENTS_MOVED, error));
    lap(time, GN_PHASE_exchange);
    if (measure) GN_TRY(read_elements(w, error));
    return gn_elements_check_paths(&w->ctx, &w->dem, &w->solids, error);
}

static gneiss_status find_forces(gn_world *w, watch *time, gneiss_error *error) {
    GN_TRY(gn_features_run(w, GN_HOOK_BEFORE_FORCES, error));
    /* Blocks that no feature holds move with their forces. */
    gn_dem_forces(w, w->ctx.measure || w->ctx.sums);
    start(time);
    gn_boundary_forces(&w->ctx, &w->dem, &w->boundary);
    lap(time, GN_PHASE_walls);
    gn_elements_forces(&w->ctx, &w->solids, w->ctx.seconds, w->ctx.measure);
    start(time);
    GN_TRY(gn_features_run(w, GN_HOOK_ACT, error));
    lap(time, GN_PHASE_exchange);
    return GNEISS_OK;
}

gneiss_status gn_world_step(gn_world *w, bool measure, gneiss_error *error) {
    watch time = {w, w->ctx.step % GN_BOOKED == 0, 0.0};
    w->ctx.measure = measure;
    w->ctx.sums = false;
    GN_TRY(gn_features_run(w, GN_HOOK_BEFORE_LISTS, error));
    const int64_t broken = w->dem.broken_tension + w->dem.broken_shear;
    GN_TRY(gn_world_refresh_lists(w, error));
    GN_TRY(gn_features_run(w, GN_HOOK_LIMIT, error));
    GN_TRY(gn_features_run(w, GN_HOOK_READING, error));
    GN_TRY(find_forces(w, &time, error));
    gneiss_status status = finish(w, &time, error);
    w->ctx.time += w->ctx.dt;
    w->ctx.dt_past = w->ctx.dt;
    w->ctx.step++;
    if (status == GNEISS_OK)
        status = gn_timestep_check_after_breaks(&w->ctx, &w->dem, &w->boundary, &w->solids,
                                                &w->zones, broken, error);
    return status == GNEISS_OK ? gn_features_run(w, GN_HOOK_AFTER_STEP, error) : status;
}
