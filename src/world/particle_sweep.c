/* The parallel part of a step. The dealer (sched/deal.h) calls work_on_contacts for blocks of
 * contacts, and move for a block of particles once all of its contacts are done. */
#include "base/timer.h"
#include "boundary/boundary.h"
#include "drive/box.h"
#include "kernels/motion.h"
#include "kernels/partials.h"
#include "particles/active_pairs.h"
#include "particles/motion.h"
#include "particles/particles.h"
#include "sched/deal.h"
#include "world/particle_step.h"
#include "world/ranks.h"
#include "world/world.h"

#include <omp.h>

/* The context of a thread. The first thread books time under the phases. */
typedef struct work {
    gn_world *w;
    const gn_contact_args *contacts; /* [GN_LIST_COUNT] */
    const gn_motion_args *motion;
    const gn_ranks *ranks; /* NULL: all blocks are own ones */
    bool books;
    double mark;
} work;

static void book(work *own, gn_phase phase) {
    if (!own->books) return;
    double now = gn_now();
    own->w->ctx.seconds[phase] += GN_BOOKED * (now - own->mark);
    own->mark = now;
}

/* Waiting is not booked for the kernels, because on a machine with other load it takes most of the
 * time. */
static void waited(void *context, double seconds) {
    work *k = context;
    if (!k->books) return;
    k->w->ctx.seconds[GN_PHASE_waiting] += GN_BOOKED * seconds;
    k->mark += seconds;
}

static void work_on_block(work *k, int list, size_t block) {
    gn_world *w = k->w;
    const gn_contact_args *args = &k->contacts[list];
    const gn_phase phase = list == GN_LIST_PAIRS ? GN_PHASE_pairs : GN_PHASE_bonds;
    gn_contact_sums *sums = w->dem.list[list].sums;
    size_t length = args->partials->length, count = args->contacts->soa.count;
    size_t end = (block + 1) * length < count ? (block + 1) * length : count;
    sums[block] = (gn_contact_sums){0};
    if (list == GN_LIST_PAIRS && w->dem.near.on) {
        gn_active_pairs_work(&w->ctx, &w->dem, args, block, &sums[block]);
        book(k, phase);
        return;
    }
    w->dem.list[list].kernel(args, block * length, end, &sums[block]);
    if (args->measure && w->ctx.effects & GN_FX_CONTACT_FORCES)
        gn_box_sum_stress(&w->ctx, &w->dem, args->contacts, block * length, end,
                          sums[block].stress);
    book(k, phase);
}

/* With ranks the dealer counts own blocks only; early ones are done. */
static void work_on_contacts(void *context, int list, size_t block) {
    work *k = context;
    const gn_ranks *ranks = k->ranks;
    if (!ranks)
        work_on_block(k, list, block);
    else if (!ranks->is_early[list][block])
        work_on_block(k, list, ranks->item_block[list][ranks->rank] + block);
}

/* Adds the forces of walls to a block of particles whose contacts are done, and moves it. */
static void move_block(work *k, size_t block) {
    gn_world *w = k->w;
    size_t first = block * GN_PARTICLE_BLOCK, last = first + GN_PARTICLE_BLOCK;
    if (last > w->dem.particles.soa.count) last = w->dem.particles.soa.count;
    if (w->ctx.effects & GN_FX_WALLS && !gn_dem_is_still(&w->dem, block) &&
        gn_boundary_work(&w->ctx, &w->dem, &w->boundary, block, first, last))
        book(k, GN_PHASE_walls);
    gn_dem_move_block(&w->dem, k->motion, block);
    book(k, GN_PHASE_motion);
}

static void move(void *context, size_t block) {
    work *k = context;
    if (!k->ranks || !k->ranks->waits[block]) move_block(k, block);
}

/* The begin of a sweep with ranks: what other ranks wait for. */
static void serve_ranks(gn_world *world, const gn_contact_args *contacts, bool booked) {
    gn_ranks *ranks = world->ctx.ranks;
    gn_world_begin_exchange(world);
#pragma omp parallel num_threads(world->dem.deal.team)
    {
        work k = {world, contacts, NULL, ranks, booked && omp_get_thread_num() == 0, gn_now()};
#pragma omp for schedule(dynamic)
        for (size_t e = 0; e < ranks->early_count; e++)
            work_on_block(&k, ranks->early[e].list, ranks->early[e].block);
    }
    gn_ranks_send_rows(ranks);
}

/* The end of a sweep with ranks: own blocks that awaited rows of others move; then all ranks have
 * the sums of all blocks. Returns s of processor time of this thread without messages. */
static double join_ranks(gn_world *world, const gn_motion_args *motion, bool booked) {
    gn_ranks *ranks = world->ctx.ranks;
    work first = {world, NULL, motion, ranks, booked, gn_now()};
    gn_world_take_rows(world);
    book(&first, GN_PHASE_waiting);
    const double before = gn_thread_time();
#pragma omp parallel for schedule(dynamic) num_threads(world->dem.deal.team)
    for (size_t k = 0; k < ranks->late_count; k++) {
        work own = {world, NULL, motion, ranks, false, 0.0};
        move_block(&own, (size_t)ranks->late[k]);
    }
    const double worked = gn_thread_time() - before;
    book(&first, GN_PHASE_motion);
    gn_world_share_step(world);
    book(&first, GN_PHASE_waiting);
    return worked;
}

static void sweep_own(gn_world *world, const gn_contact_args *contacts,
                      const gn_motion_args *motion, bool booked) {
    static const gn_deal_work blocks = {work_on_contacts, move, waited};
#pragma omp parallel num_threads(world->dem.deal.team)
    {
        work k = {world, contacts, motion, .ranks = world->ctx.ranks, .mark = gn_now()};
        k.books = booked && omp_get_thread_num() == 0;
        gn_deal_sweep(&world->dem.deal, 0, &blocks, &k);
        if (booked && omp_get_num_threads() > 1) {
#pragma omp barrier
            book(&k, GN_PHASE_waiting);
        }
    }
}

void gn_world_sweep(gn_world *world, const gn_contact_args contacts[GN_LIST_COUNT],
                    const gn_motion_args *motion) {
    gn_ranks *ranks = world->ctx.ranks;
    const double before = ranks ? gn_thread_time() : 0.0;
    const bool booked = world->ctx.step % GN_BOOKED == 0;
    gn_deal_begin(&world->dem.deal);
    gn_active_pairs_begin(&world->ctx, &world->dem, &contacts[GN_LIST_PAIRS]);
    if (ranks) serve_ranks(world, contacts, booked);
    const double begin = gn_now();
    sweep_own(world, contacts, motion, booked);
    gn_deal_end(&world->dem.deal, 1, gn_now() - begin);
    if (!ranks) return;
    ranks->busy += gn_thread_time() - before;
    ranks->busy += join_ranks(world, motion, booked);
}

/* Forces on walls were computed together with the loads. */
void gn_world_sweep_held(gn_dem *dem, const gn_motion_args *motion) {
    const size_t held = dem->hold.count;
    gn_motion_args args = *motion;
    args.pass = GN_PASS_MOVE;
#pragma omp parallel for schedule(static) num_threads(dem->deal.team)
    for (size_t h = 0; h < held; h++) {
        const size_t block = (size_t)dem->hold.block[h];
        if (!gn_clumps_fill(&dem->clumps, block)) gn_dem_move_block(dem, &args, block);
    }
}
