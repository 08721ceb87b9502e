/* The particles' part of a step: forces, motion, and their sums. */
#include "world/particle_step.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/balance.h"
#include "frame/frame.h"
#include "frame/step_change.h"
#include "kernels/motion.h"
#include "membrane/membrane.h"
#include "particles/active_pairs.h"
#include "particles/flow.h"
#include "particles/law.h"
#include "particles/motion.h"
#include "particles/particles.h"
#include "particles/sets.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "world/space.h"
#include "world/structure.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

gn_motion_args gn_world_motion_args(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
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

static void list_args(const gn_world *world, bool measure, gn_contact_args args[GN_LIST_COUNT]) {
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        args[l] = gn_dem_contact_args(&world->ctx, &world->dem, &world->box, &world->dem.list[l],
                                      measure);
        if (world->ctx.measure) args[l].structure = gn_structure_box_of(&world->ctx.scene);
    }
}

/* --- forces and motion --- */

void gn_world_particle_forces(gn_world *world, bool measure) {
    gn_dem *d = &world->dem;
    if (world->ctx.effects & GN_FX_PRESCRIBED)
        gn_prescription_update(&world->ctx, &world->dem, world->ctx.time + 0.5 * world->ctx.dt);
    if (!d->particles.soa.count) return;
    gn_dem_confine(&world->ctx, &world->dem, &world->dem.bonds.contacts);
    if (world->ctx.dt_past > 0.0 && world->ctx.dt != world->ctx.dt_past &&
        world->ctx.effects & GN_FX_ENERGY) {
        gn_ranks_whole(world->ctx.ranks);
        gn_dem_keep_velocities(d);
    }
    gn_contact_args contacts[GN_LIST_COUNT];
    list_args(world, measure, contacts);
    gn_motion_args motion =
        gn_world_motion_args(&world->ctx, &world->dem, &world->boundary, measure);
    gn_world_sweep(world, contacts, &motion);
}

/* Returns the sums over contacts of particles, bodies and facets with walls and with each other. */
static gn_contact_sums wall_sums(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary) {
    gn_contact_sums walls =
        gn_contact_sums_of(boundary->sums, ctx->effects & GN_FX_WALLS ? dem->motion_blocks : 0);
    if (boundary->body_contacts.soa.count) gn_contact_sums_add(&walls, &boundary->body_sums);
    if (boundary->pairs.count) gn_contact_sums_add(&walls, &boundary->pairs.sums);
    return walls;
}

void gn_world_move_particles(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             bool measure) {
    gn_clumps_move(ctx, dem, measure);
    if (dem->hold.count) {
        gn_motion_args motion = gn_world_motion_args(ctx, dem, boundary, measure);
        gn_world_sweep_held(dem, &motion);
        gn_clumps_move_members(ctx, dem);
    }
    const gn_contact_sums walls = wall_sums(ctx, dem, boundary);
    gn_dem_moved(ctx, dem, &walls);
}

/* --- forces without a step --- */

void gn_world_evaluate_particles(gn_world *world, double span, double kick, bool measure) {
    const double past = world->ctx.dt_past;
    if (world->ctx.effects & GN_FX_PRESCRIBED)
        gn_prescription_update(&world->ctx, &world->dem, world->ctx.time);
    world->ctx.dt_past = span;
    gn_dem_forget_speed(&world->ctx, &world->dem);
    gn_dem_confine(&world->ctx, &world->dem, &world->dem.bonds.contacts);
    gn_contact_args contacts[GN_LIST_COUNT];
    list_args(world, measure, contacts);
    gn_motion_args motion =
        gn_world_motion_args(&world->ctx, &world->dem, &world->boundary, measure);
    motion.dt_past = 0.0;
    motion.dt = kick;
    if (kick > 0.0) motion.damping = motion.damping_spin = 0.0;
    gn_world_sweep(world, contacts, &motion);
    world->ctx.dt_past = past;
    const gn_contact_sums walls = wall_sums(&world->ctx, &world->dem, &world->boundary);
    gn_dem_add_up(&world->dem, &walls);
    if (world->ctx.effects & GN_FX_PRESCRIBED) gn_reactions_sum(&world->ctx, &world->dem);
}

/* --- readings --- */

static void book_contacts(const gn_dem_sums *sums, gn_energy *energy) {
#define X(name, text) energy->name += sums->contacts.name + sums->walls.name;
    GN_CONTACT_LOSSES(X)
#undef X
}

void gn_world_book_particles(const gn_dem *dem, gn_half half, gn_energy *ledger) {
    const gn_motion_sums *m = &dem->done.motion;
    if (half == GN_HALF_BEFORE) book_contacts(&dem->done, ledger);
    ledger->background_damping += m->damping[half];
    ledger->work_gravity += m->gravity[half];
    ledger->work_applied += m->applied[half];
    ledger->work_prescribed += m->prescribed[half];
    ledger->step_change += dem->done.step_change[half];
}

void gn_world_measure_particles(const gn_world *world, gn_energy *ledger, double stress[9]) {
    const gn_dem_sums *s = &world->dem.done;
    gn_ranks_whole(world->ctx.ranks);
    const double volume =
        gn_space_volume(&world->ctx, &world->dem, &world->membrane, &world->boundary,
                        &world->solids, &world->box, &world->approach);
    ledger->kinetic = s->motion.kinetic;
    ledger->rotational = s->motion.rotational;
    ledger->elastic_normal = s->contacts.elastic_normal;
    ledger->elastic_shear = s->contacts.elastic_shear;
    ledger->elastic_bending = s->contacts.elastic_bending;
    ledger->elastic_wall = s->walls.elastic_normal;
    for (int k = 0; k < 9; k++) {
        const double clumps = world->dem.clumps.count ? world->dem.clumps.done.stress[k] : 0.0;
        stress[k] = (s->contacts.stress[k] + s->walls.stress[k] + clumps) / volume;
    }
    gn_membrane_stress(&world->ctx, &world->membrane, volume, stress);
}

/* Returns the sum, N, of the magnitudes of the forces of all contacts: of particles with each other
 * and with walls, bodies and facets, and of bodies with walls and each other. *count: number of
 * contacts that carry a force. */
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

void gn_world_balance_particles(const gn_dem *dem, const gn_boundary *boundary,
                                gn_balance *balance) {
    const double particles = (double)gn_dem_present_count(dem) - (double)dem->prescribed.count -
                             (double)gn_clumps_bound(&dem->clumps);
    const double resultant = dem->done.motion.resultant;
    double count, force = carried(dem, boundary, &count);
    balance->force = force > 0.0 ? force / count : 0.0;
    if (!(particles > 0.0)) return;
    balance->carries |= force > 0.0;
    balance->falls |= force <= 0.0 && resultant > 0.0;
    if (force > 0.0) balance->ratio = fmax(balance->ratio, resultant / particles / balance->force);
}
