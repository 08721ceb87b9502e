#include "particles/motion.h"

#include "base/memory.h"
#include "frame/frame.h"
#include "frame/step_change.h"
#include "particles/active_pairs.h"
#include "particles/particles.h"
#include "particles/sets.h"

#include <math.h>

bool gn_dem_is_still(const gn_dem *dem, size_t block) {
    return dem->still && dem->still[block];
}

void gn_dem_move_block(gn_dem *dem, const gn_motion_args *motion, size_t block) {
    const size_t first = block * GN_PARTICLE_BLOCK, count = dem->particles.soa.count;
    const size_t last = first + GN_PARTICLE_BLOCK < count ? first + GN_PARTICLE_BLOCK : count;
    dem->motion_sums[block] = (gn_motion_sums){.bad = -1};
    if (!gn_dem_is_still(dem, block))
        dem->motion_kernel(motion, first, last, &dem->motion_sums[block]);
}

void gn_dem_keep_velocities(gn_dem *dem) {
    dem->vel_past = gn_rows_copy(&dem->particles, dem->particles.vel);
    dem->spin_past = gn_rows_copy(&dem->particles, dem->particles.spin);
}

void gn_dem_clear_past(gn_dem *dem, size_t p, bool spin) {
    double *past = spin ? dem->spin_past : dem->vel_past;
    for (int a = 0; past && a < 3; a++) past[4 * p + (size_t)a] = 0.0;
}

/* --- sums --- */

gn_contact_sums gn_contact_sums_of(const gn_contact_sums *blocks, size_t count) {
    gn_contact_sums total = {0};
    for (size_t b = 0; b < count; b++) gn_contact_sums_add(&total, &blocks[b]);
    return total;
}

static gn_motion_sums add_motion_sums(const gn_motion_sums *blocks, size_t count) {
    gn_motion_sums total = {.bad = -1};
    for (size_t b = 0; b < count; b++) gn_motion_sums_add(&total, &blocks[b]);
    return total;
}

void gn_dem_add_up(gn_dem *dem, const gn_contact_sums *walls) {
    gn_dem_sums *s = &dem->done;
    s->contacts = (gn_contact_sums){0};
    for (int l = 0; l < GN_LIST_COUNT; l++) {
        const gn_contact_list *list = &dem->list[l];
        s->list[l] =
            gn_contact_sums_of(list->sums, list->contacts.soa.count ? list->partials.blocks : 0);
        gn_contact_sums_add(&s->contacts, &s->list[l]);
    }
    s->walls = *walls;
    s->motion = add_motion_sums(dem->motion_sums, dem->motion_blocks);
    if (dem->clumps.count) gn_motion_sums_add(&s->motion, &dem->clumps.done.motion);
}

static void follow_change(const gn_step_context *ctx, gn_dem *dem) {
    const size_t count = dem->particles.soa.count;
    double *halves = dem->done.step_change;
    for (int h = 0; h < 2; h++)
        halves[h] = dem->clumps.count ? dem->clumps.done.step_change[h] : 0.0;
    if (!dem->vel_past) return;
    gn_ranks_whole(ctx->ranks);
    gn_rows_add_step_change(ctx, dem->vel_past, dem->particles.vel, count, halves);
    gn_rows_add_step_change(ctx, dem->spin_past, dem->particles.spin, count, halves);
    gn_free(dem->vel_past);
    gn_free(dem->spin_past);
    dem->vel_past = dem->spin_past = NULL;
}

void gn_dem_count_speed(const gn_step_context *ctx, gn_dem *dem, double speed, double counted) {
    dem->verlet.drift += ctx->dt * (speed - counted);
    dem->verlet.closed += 2.0 * (ctx->dt * (speed - counted));
    dem->speed_most = speed * (1.0 + 1e-6);
}

void gn_dem_moved(const gn_step_context *ctx, gn_dem *dem, const gn_contact_sums *walls) {
    gn_dem_add_up(dem, walls);
    follow_change(ctx, dem);
    if (ctx->effects & GN_FX_PRESCRIBED) gn_reactions_sum(ctx, dem);
    gn_dem_count_speed(ctx, dem, sqrt(dem->done.motion.speed2), 0.0);
    gn_active_pairs_moved(ctx, dem);
    dem->broken_tension += dem->done.list[GN_LIST_BONDS].broken_tension;
    dem->broken_shear += dem->done.list[GN_LIST_BONDS].broken_shear;
    dem->broken_joints +=
        dem->done.list[GN_LIST_JOINTS].broken_tension + dem->done.list[GN_LIST_JOINTS].broken_shear;
    dem->pressed = dem->done.list[GN_LIST_PAIRS].pressed + dem->done.walls.pressed > 0;
    dem->contact_steps += (int64_t)gn_lists_count(dem);
}

void gn_dem_forget_speed(const gn_step_context *ctx, gn_dem *dem) {
    dem->speed_most = 0.0;
    gn_active_pairs_forget(ctx, dem);
}
