/* The particles' part of a step: forces, motion, and what both sum up to. */
#include "world/particle_step.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/balance.h"
#include "frame/ledger.h"
#include "frame/step_change.h"
#include "frame/step_context.h"
#include "kernels/contact.h"
#include "kernels/motion.h"
#include "measure/energy.h"
#include "membrane/membrane.h"
#include "particles/active_pairs.h"
#include "particles/dem.h"
#include "particles/flow.h"
#include "particles/parameters.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "world/space.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

gn_motion_args gn_dem_motion_args(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  bool measure) {
    gn_motion_args a = {0};
    a.particles = &dem->particles;
    a.lists = GN_LIST_COUNT;
    for (int l = 0; l < GN_LIST_COUNT; l++) a.partials[l] = &dem->list[l].partials;
    a.wall_contacts = ctx->effects & GN_FX_WALLS ? &boundary->contacts : NULL;
    a.wall_first = boundary->first;
    a.prescribed = ctx->effects & GN_FX_PRESCRIBED ? &dem->prescribed : NULL;
    a.dt_past = ctx->dt_past;
    a.dt = ctx->dt;
    memcpy(a.gravity, ctx->scene.gravity, sizeof a.gravity);
    a.damping = ctx->scene.background_coefficient;
    a.damping_spin = gn_scene_spin_damping(&ctx->scene);
    a.changes = dem->near.on;
    a.hold = dem->hold.count ? &dem->hold : NULL;
    a.damping_lead = ctx->scene.background_velocity == GN_VELOCITY_INSTANT ? 0.5 : 0.0;
    a.measure = measure;
    return a;
}

static void list_args(const gn_world *w, bool measure, gn_contact_args args[GN_LIST_COUNT]) {
    for (int l = 0; l < GN_LIST_COUNT; l++)
        args[l] = gn_dem_contact_args(&w->ctx, &w->dem, &w->box, &w->dem.list[l], measure);
}

/* --- forces and motion --- */

void gn_dem_forces(gn_world *w, bool measure) {
    gn_dem *d = &w->dem;
    if (w->ctx.effects & GN_FX_PRESCRIBED)
        gn_prescription_update(&w->ctx, &w->dem, w->ctx.time + 0.5 * w->ctx.dt);
    if (!d->particles.soa.count) return;
    gn_dem_confine(&w->ctx, &w->dem, &w->dem.bonds.contacts);
    if (w->ctx.dt_past > 0.0 && w->ctx.dt != w->ctx.dt_past && w->ctx.effects & GN_FX_ENERGY) {
        d->vel_past = gn_rows_copy(&d->particles, d->particles.vel);
        d->spin_past = gn_rows_copy(&d->particles, d->particles.spin);
    }
    gn_contact_args contacts[GN_LIST_COUNT];
    list_args(w, measure, contacts);
    gn_motion_args motion = gn_dem_motion_args(&w->ctx, &w->dem, &w->boundary, measure);
    gn_dem_sweep(w, contacts, &motion);
}

/* In block order, whoever worked on them. */
static gn_contact_sums add_contact_sums(const gn_contact_sums *blocks, size_t count) {
    gn_contact_sums total = {0};
    for (size_t b = 0; b < count; b++) gn_contact_sums_add(&total, &blocks[b]);
    return total;
}

static gn_motion_sums add_motion_sums(const gn_motion_sums *blocks, size_t count) {
    gn_motion_sums total = {.bad = -1};
    for (size_t b = 0; b < count; b++) gn_motion_sums_add(&total, &blocks[b]);
    return total;
}

static void add_up(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                   gn_dem_sums *s) {
    const gn_dem *d = dem;
    s->contacts = (gn_contact_sums){0};
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contact_list *list = &d->list[l];
        s->list[l] =
            add_contact_sums(list->sums, list->contacts.soa.count ? list->partials.blocks : 0);
        gn_contact_sums_add(&s->contacts, &s->list[l]);
    }
    s->walls = add_contact_sums(boundary->sums, ctx->effects & GN_FX_WALLS ? d->motion_blocks : 0);
    if (boundary->body_contacts.soa.count) gn_contact_sums_add(&s->walls, &boundary->body_sums);
    if (boundary->pairs.count) gn_contact_sums_add(&s->walls, &boundary->pairs.sums);
    s->motion = add_motion_sums(d->motion_sums, d->motion_blocks);
}

static void follow_change(const gn_step_context *ctx, gn_dem *dem) {
    gn_dem *d = dem;
    const size_t count = d->particles.soa.count;
    double *halves = d->done.step_change;
    halves[0] = halves[1] = 0.0;
    if (!d->vel_past) return;
    gn_rows_add_step_change(ctx, d->vel_past, d->particles.vel, count, halves);
    gn_rows_add_step_change(ctx, d->spin_past, d->particles.spin, count, halves);
    gn_free(d->vel_past);
    gn_free(d->spin_past);
    d->vel_past = d->spin_past = NULL;
}

void gn_dem_move(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary, bool measure) {
    gn_dem *d = dem;
    if (d->hold.count) {
        gn_motion_args motion = gn_dem_motion_args(ctx, dem, boundary, measure);
        gn_dem_sweep_held(dem, &motion);
    }
    add_up(ctx, dem, boundary, &d->done);
    follow_change(ctx, dem);
    if (ctx->effects & GN_FX_PRESCRIBED) gn_reactions_sum(ctx, dem);
    double speed = sqrt(d->done.motion.speed2);
    d->speed_most = speed * (1.0 + 1e-6);
    gn_near_moved(ctx, dem);
    d->verlet.drift += ctx->dt * speed;
    d->verlet.closed += 2.0 * (ctx->dt * speed);
    d->broken_tension += d->done.list[GN_LIST_BONDS].broken_tension;
    d->broken_shear += d->done.list[GN_LIST_BONDS].broken_shear;
    d->pressed = d->done.list[GN_LIST_PAIRS].pressed + d->done.walls.pressed > 0;
    d->contact_steps += (int64_t)gn_lists_count(d);
}

/* --- at another state than the last --- */

void gn_dem_evaluate(gn_world *w, double span, double kick, bool measure) {
    gn_dem *d = &w->dem;
    const double past = w->ctx.dt_past;
    if (w->ctx.effects & GN_FX_PRESCRIBED) gn_prescription_update(&w->ctx, &w->dem, w->ctx.time);
    w->ctx.dt_past = span;
    d->speed_most = 0.0;
    gn_near_forget(&w->ctx, &w->dem);
    gn_dem_confine(&w->ctx, &w->dem, &w->dem.bonds.contacts);
    gn_contact_args contacts[GN_LIST_COUNT];
    list_args(w, measure, contacts);
    gn_motion_args motion = gn_dem_motion_args(&w->ctx, &w->dem, &w->boundary, measure);
    motion.dt_past = 0.0;
    motion.dt = kick;
    if (kick > 0.0) motion.damping = motion.damping_spin = 0.0;
    gn_dem_sweep(w, contacts, &motion);
    w->ctx.dt_past = past;
    add_up(&w->ctx, &w->dem, &w->boundary, &d->done);
    if (w->ctx.effects & GN_FX_PRESCRIBED) gn_reactions_sum(&w->ctx, &w->dem);
}

/* --- what came of it --- */

static void book_contacts(const gn_dem_sums *s, gn_energy *e) {
#define X(name, text) e->name += s->contacts.name + s->walls.name;
    GN_CONTACT_LOSSES(X)
#undef X
}

void gn_dem_book(const gn_dem *dem, gn_half half, gn_energy *ledger) {
    const gn_motion_sums *m = &dem->done.motion;
    if (half == GN_HALF_BEFORE) book_contacts(&dem->done, ledger);
    ledger->background_damping += m->damping[half];
    ledger->work_gravity += m->gravity[half];
    ledger->work_applied += m->applied[half];
    ledger->work_prescribed += m->prescribed[half];
    ledger->step_change += dem->done.step_change[half];
}

void gn_dem_measure(const gn_world *w, gn_energy *ledger, double stress[9]) {
    const gn_dem_sums *s = &w->dem.done;
    const double volume =
        gn_space_volume(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box, &w->approach);
    ledger->kinetic = s->motion.kinetic;
    ledger->rotational = s->motion.rotational;
    ledger->elastic_normal = s->contacts.elastic_normal;
    ledger->elastic_shear = s->contacts.elastic_shear;
    ledger->elastic_bending = s->contacts.elastic_bending;
    ledger->elastic_wall = s->walls.elastic_normal;
    for (int k = 0; k < 9; k++) stress[k] = (s->contacts.stress[k] + s->walls.stress[k]) / volume;
    gn_membrane_stress(&w->ctx, &w->dem, volume, stress);
}

/* N: sizes of the forces of all contacts of particles, with each other and with walls, bodies and
 * facets, and of bodies with walls and each other; *count: of those that carry. */
static double carried(const gn_dem *dem, const gn_boundary *boundary, double *count) {
    const gn_dem_sums *s = &dem->done;
    const gn_wall_contacts *lists[] = {&boundary->contacts, &boundary->body_contacts};
    const gn_contact_sums none = {0},
                          *bodies = boundary->pairs.count ? &boundary->pairs.sums : &none;
    double force = s->contacts.force + bodies->force;
    *count = s->contacts.carrying + bodies->carrying;
    for (int k = 0; k < 2; k++)
        for (size_t c = 0; c < lists[k]->soa.count; c++) {
            const double *row = lists[k]->row + 8 * c, size = sqrt(gn_dot3(row, row));
            force += size;
            *count += size > 0.0;
        }
    return force;
}

void gn_dem_balance(const gn_dem *dem, const gn_boundary *boundary, gn_balance *balance) {
    const double particles = (double)gn_world_present(dem) - (double)dem->prescribed.count;
    const double resultant = dem->done.motion.resultant;
    double count, force = carried(dem, boundary, &count);
    balance->force = force > 0.0 ? force / count : 0.0;
    if (!(particles > 0.0)) return;
    balance->carries |= force > 0.0;
    balance->falls |= force <= 0.0 && resultant > 0.0;
    if (force > 0.0) balance->ratio = fmax(balance->ratio, resultant / particles / balance->force);
}
