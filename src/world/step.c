/* One step of the model: lists, forces of all parts, exchanges between them, motion, and the
 * ledger. What a part does in each is its own affair (dem.h, boundary.h, elements.h). */
#include "base/error.h"
#include "base/timer.h"
#include "boundary/boundary.h"
#include "conversion/conversion.h"
#include "drive/box.h"
#include "drive/control.h"
#include "frame/balance.h"
#include "frame/ledger.h"
#include "kernels/contact.h"
#include "laboratory/ends.h"
#include "laboratory/strain_gauge.h"
#include "measure/energy.h"
#include "membrane/membrane.h"
#include "particles/dem.h"
#include "particles/events.h"
#include "solids/elements.h"
#include "timestep/debris.h"
#include "timestep/depth.h"
#include "timestep/indentation.h"
#include "timestep/step_limit.h"
#include "world/exchange.h"
#include "world/world.h"
#include "zones/zone_state.h"
#include "zones/zones.h"

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
    if (!t->runs || (phase == GN_PHASE_exchange && !t->w->features.count)) return;
    double now = gn_now();
    t->w->seconds[phase] += GN_BOOKED * (now - t->mark);
    t->mark = now;
}

/* Bonds that are made beyond their strength break in the first evaluation: what contacts lose there
 * was stored, as was what a sink or the domain took out before. */
static void begin_ledger(gn_energy *e) {
    e->stored_at_start = gn_energy_stored(e) + e->removed;
#define X(name, text) e->stored_at_start += e->name;
    GN_CONTACT_LOSSES(X)
#undef X
}

/* The reading of the particles and what they touch. */
static void read_particles(gn_world *w) {
    gn_energy *e = &w->ledger.energy;
    gn_dem_measure(w, e, w->ledger.stress);
    for (int k = 0; k < 9; k++) w->ledger.stress[k] += w->zones.state.stress[k];
    gn_boundary_measure(&w->ctx, &w->boundary, e);
    if (w->ctx.step == 0) begin_ledger(e);
    w->ledger.balance = (gn_balance){0};
    gn_dem_balance(&w->dem, &w->boundary, &w->ledger.balance);
    gn_boundary_balance(&w->ctx, &w->boundary, &w->ledger.balance);
    w->ledger.reading = *e;
}

/* Elements keep a ledger of their own, which is added to the reading alone. Beside particles they
 * are no part of the specimen; alone they are it. */
static void read_elements(gn_world *w) {
    if (!w->ctx.scene.has_specimen) gn_elements_stress(&w->solids, w->ledger.stress);
    gn_elements_balance(&w->solids, &w->ledger.balance);
    gn_elements_book(&w->solids, &w->ledger.reading);
    gn_exchanges_book(w, &w->ledger.reading);
}

/* What elements carry where particles are; before these have their loads. */
static gneiss_status read_zones(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_solids *solids, gn_zones *zones, double *seconds,
                                gneiss_error *error) {
    const double begin = gn_now();
    gneiss_status status =
        gn_coupled_mean_stress(ctx, dem, solids, zones, zones->state.stress, error);
    seconds[GN_PHASE_measure] += gn_now() - begin;
    return status;
}

/* What waited moves, and what moves as a whole. Works are trapezoidal: one half closes the interval
 * that led here, one opens the coming one, and the reading lies between them. */
static void move(gn_world *w, bool measure, watch *time) {
    start(time);
    gn_dem_move(&w->ctx, &w->dem, &w->boundary, measure);
    lap(time, GN_PHASE_motion);
    gn_boundary_book(&w->ctx, &w->boundary, GN_HALF_BEFORE, &w->ledger.energy);
    gn_boundary_kick(&w->ctx, &w->dem, &w->boundary, &w->ledger);
    gn_dem_book(&w->dem, GN_HALF_BEFORE, &w->ledger.energy);
    gn_box_book(&w->ctx, &w->dem, &w->box, &w->ledger);
    if (measure) read_particles(w);
    gn_dem_book(&w->dem, GN_HALF_AFTER, &w->ledger.energy);
    gn_boundary_move(&w->ctx, &w->dem, &w->boundary, &w->ledger);
    gn_boundary_book(&w->ctx, &w->boundary, GN_HALF_AFTER, &w->ledger.energy);
    lap(time, GN_PHASE_walls);
}

static gneiss_status finish(gn_world *w, bool measure, watch *time, gneiss_error *error) {
    move(w, measure, time);
    GN_TRY(gn_box_move(&w->ctx, &w->dem, &w->box, &w->ledger, error));
    GN_TRY(gn_events_note(&w->ctx, &w->dem, error));
    GN_TRY(gn_dem_check(&w->ctx, &w->dem, &w->boundary, measure, error));
    GN_TRY(gn_boundary_check(&w->ctx, &w->dem, &w->boundary, error));
    lap(time, GN_PHASE_motion);
    GN_TRY(gn_elements_move(&w->ctx, &w->solids, &w->ledger, w->seconds, measure, error));
    start(time);
    GN_TRY(gn_exchanges_follow(w, error));
    lap(time, GN_PHASE_exchange);
    if (measure) read_elements(w);
    if (measure) w->ledger.unbalanced = fmin(w->ledger.balance.ratio, GN_UNBALANCED_MOST);
    return gn_elements_check(&w->ctx, &w->dem, &w->solids, error);
}

/* Wedged debris gains some tenths of its energy in every collision of a few steps. Counted by
 * steps, so that it does not depend on what is written, or resumed. */
enum { DEBRIS_EVERY = 20 };

gneiss_status gn_world_step(gn_world *w, bool measure, gneiss_error *error) {
    bool debris = false;
    watch time = {w, w->ctx.step % GN_BOOKED == 0, 0.0};
    if (gn_converts(&w->ctx)) GN_TRY(gn_conversion_look(w, error));
    const int64_t broken = w->dem.broken_tension + w->dem.broken_shear;
    GN_TRY(gn_world_refresh_lists(w, error));
    GN_TRY(gn_pressed_check(w, error));
    gn_world_follow_bodies(&w->ctx, &w->dem, &w->boundary);
    if (w->ctx.effects & GN_FX_ENERGY && (w->ctx.step + 1) % DEBRIS_EVERY == 0)
        GN_TRY(gn_debris_find(&w->ctx, &w->dem, &debris, error));
    measure |= debris;
    if (measure)
        GN_TRY(gn_depth_look_again(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->zones, error));

    if (measure && w->ctx.scene.has_couple)
        GN_TRY(read_zones(&w->ctx, &w->dem, &w->solids, &w->zones, w->seconds, error));
    GN_TRY(gn_gauge_look(&w->ctx, &w->dem, &w->gauge, error));
    gn_control_look(w);
    GN_TRY(gn_membrane_press(&w->ctx, &w->dem, error));
    /* What does not wait for an exchange moves with its forces. A box asks for the stress in every
     * step. */
    gn_dem_forces(w, measure || gn_box_moves(&w->ctx, &w->box));
    start(&time);
    gn_boundary_forces(&w->ctx, &w->dem, &w->boundary);
    lap(&time, GN_PHASE_walls);
    gn_elements_forces(&w->ctx, &w->solids, w->seconds, measure);

    start(&time);
    GN_TRY(gn_exchanges_act(w, error));
    lap(&time, GN_PHASE_exchange);

    gn_ends_look(w, false);
    gneiss_status status = finish(w, measure, &time, error);
    w->ctx.time += w->ctx.dt;
    w->ctx.dt_past = w->ctx.dt;
    w->ctx.step++;
    if (status == GNEISS_OK) status = gn_world_check_apart(w, broken, error);
    return status == GNEISS_OK && debris ? gn_world_check_debris(w, error) : status;
}
