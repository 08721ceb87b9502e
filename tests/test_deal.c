/* Distribution of work among threads: every block is done once, particles after all their items,
 * for any number of threads, shares and forms of lists; threads take over work of a thread that
 * waits or does not arrive. */
#include "base/timer.h"
#include "sched/deal.h"
#include "smaller_team.h"
#include "world_helpers.h"

#include <omp.h>
#include <sched.h>
#include <stdatomic.h>
#include <string.h>

enum { BLOCKS_MAX = 64, PARTICLES_MAX = 96, LENGTH = 64, LISTS = 3 };

/* Lists whose blocks touch ranges of blocks of particles at random. */
typedef struct model {
    gn_partials list[LISTS];
    int32_t first[LISTS][PARTICLES_MAX], last[LISTS][PARTICLES_MAX];
    int32_t leader[LISTS][BLOCKS_MAX * LENGTH];
    size_t particle_blocks;
    _Atomic int items[LISTS][BLOCKS_MAX], particles[PARTICLES_MAX];
    _Atomic int early;  /* particles that were worked on before one of their items */
    _Atomic int still;  /* this thread waits in its first items until all others are done */
    _Atomic bool stuck; /* a block was not processed by the other threads */
} model;

static void make_list(model *m, int l, size_t blocks, uint64_t *seed) {
    gn_partials *q = &m->list[l];
    *q = (gn_partials){.blocks = blocks, .length = LENGTH};
    q->touched[0] = m->first[l];
    q->touched[1] = m->last[l];
    for (size_t c = 0; c < blocks * LENGTH; c++)
        m->leader[l][c] = (int32_t)(c * m->particle_blocks * GN_PARTICLE_BLOCK / (blocks * LENGTH));
    for (size_t p = 0; p < m->particle_blocks; p++) {
        double at = (double)(p * blocks) / (double)m->particle_blocks;
        double low = at - uniform(seed, 0.0, 0.5 * (double)blocks), high = at + 3.0;
        if (uniform(seed, 0.0, 1.0) < 0.05) low = 0.0; /* a periodic neighbour */
        m->first[l][p] = low > 0.0 ? (int32_t)low : 0;
        m->last[l][p] = high < (double)blocks ? (int32_t)high : (int32_t)blocks - 1;
        if (blocks && uniform(seed, 0.0, 1.0) > 0.1) continue;
        m->first[l][p] = INT32_MAX;
        m->last[l][p] = -1;
    }
}

static int items_done(const model *m) {
    int done = 0;
    for (int l = 0; l < LISTS; l++)
        for (size_t b = 0; b < m->list[l].blocks; b++) done += atomic_load(&m->items[l][b]);
    return done;
}

static void stand_still(model *m) {
    static const double patience = 20.0; /* s */
    const int others = (int)(m->list[0].blocks + m->list[1].blocks + m->list[2].blocks) - 1;
    const double start = gn_now();
    while (items_done(m) < others && !m->stuck) {
        m->stuck = gn_now() - start > patience;
        sched_yield();
    }
    m->still = -1;
}

static void items(void *context, int list, size_t block) {
    model *m = context;
    if (omp_get_thread_num() == m->still) stand_still(m);
    for (volatile size_t k = 0; k < 100 * (block % 7); k++) continue;
    atomic_fetch_add(&m->items[list][block], 1);
}

static void particles(void *context, size_t p) {
    model *m = context;
    for (int l = 0; l < LISTS; l++)
        for (int32_t b = m->first[l][p]; m->last[l][p] >= 0 && b <= m->last[l][p]; b++)
            if (!atomic_load(&m->items[l][b])) atomic_fetch_add(&m->early, 1);
    atomic_fetch_add(&m->particles[p], 1);
}

static void clear(model *m) {
    memset(m->items, 0, sizeof m->items);
    memset(m->particles, 0, sizeof m->particles);
    m->early = 0;
}

static void check(const model *m) {
    assert_int_equal(m->early, 0);
    for (int l = 0; l < LISTS; l++)
        for (size_t b = 0; b < m->list[l].blocks; b++) assert_int_equal(m->items[l][b], 1);
    for (size_t p = 0; p < m->particle_blocks; p++) assert_int_equal(m->particles[p], 1);
}

static void give_lists(gn_deal *deal, const model *m) {
    gn_deal_list list[LISTS];
    const int count = m->list[2].blocks ? 3 : m->list[1].blocks ? 2 : 1;
    for (int l = 0; l < count; l++) list[l] = (gn_deal_list){&m->list[l], m->leader[l]};
    if (count == 1) list[0].leader = NULL;
    assert_int_equal(gn_deal_lists(deal, list, count, m->particle_blocks, NULL), GNEISS_OK);
}

/* A round of one or two sweeps, whose second one must not run ahead of the first. */
typedef struct round_of_sweeps {
    model *m;
    gn_deal *deal;
    int sweeps;
    _Atomic int came; /* threads that took part */
} round_of_sweeps;

static void work_through_round(void *context) {
    static const gn_deal_work work = {items, particles, NULL};
    round_of_sweeps *r = context;
#pragma omp parallel num_threads(r->deal->team)
    for (int pass = 0; pass < r->sweeps; pass++) {
#pragma omp single
        clear(r->m);
        r->came = omp_get_num_threads();
        gn_deal_sweep(r->deal, pass, &work, r->m);
#pragma omp barrier
    }
}

/* Rounds for which up to limits[0], limits[1], ... threads arrive. */
static void work_through(model *m, int threads, int rounds, const int *limits, int limit_count) {
    gn_deal deal;
    assert_int_equal(gn_deal_create(&deal, threads, NULL), GNEISS_OK);
    for (int round = 0; round < rounds; round++) {
        if (round % 10 == 0) give_lists(&deal, m);
        round_of_sweeps r = {.m = m, .deal = &deal, .sweeps = 1 + round % 2};
        const int limit = limits[round % limit_count];
        gn_deal_begin(&deal);
        in_teams_of(limit, work_through_round, &r);
        assert_true(r.came <= limit);
        gn_deal_end(&deal, r.sweeps, 1e-5);
        check(m);
    }
    gn_deal_free(&deal);
}

static void work_through_all(const int *limits, int limit_count) {
    static const struct {
        size_t list[LISTS], particles;
    } blocks[] = {{{40, 7, 0}, 96}, {{0, 33, 0}, 50}, {{64, 64, 0}, 13}, {{3, 0, 0}, 96},
                  {{0, 0, 0}, 5},   {{40, 0, 9}, 96}, {{2, 30, 64}, 40}};
    uint64_t seed = 3;
    model *m = calloc(1, sizeof *m);
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++)
        /* The number of threads falls: a runtime with a team that grows repeatedly may leak its
         * older arrays. */
        for (int threads = 5; threads >= 1; threads--) {
            m->particle_blocks = blocks[k].particles;
            m->still = -1;
            for (int l = 0; l < LISTS; l++) make_list(m, l, blocks[k].list[l], &seed);
            work_through(m, threads, 100, limits, limit_count);
        }
    free(m);
}

static void every_block_once_and_in_time(void **state) {
    (void)state;
    static const int all[] = {5};
    work_through_all(all, 1);
}

/* The work is divided among the requested threads, and fewer arrive, sometimes or always. */
static void every_block_once_and_in_time_when_fewer_threads_come(void **state) {
    (void)state;
    static const int one[] = {1}, changing[] = {5, 1, 2, 5, 3, 1, 1, 4};
    work_through_all(one, 1);
    work_through_all(changing, 8);
}

/* A thread that is delayed with its first items, for example by another program, finds all others
 * done. */
static void other_threads_take_the_work_of_a_stalled_one(void **state) {
    (void)state;
    static const gn_deal_work work = {items, particles, NULL};
    uint64_t seed = 5;
    model *m = calloc(1, sizeof *m);
    m->particle_blocks = 96;
    make_list(m, 0, 40, &seed);
    make_list(m, 1, 17, &seed);
    make_list(m, 2, 9, &seed);
    for (int threads = 2; threads <= 4; threads++) {
        gn_deal deal;
        assert_int_equal(gn_deal_create(&deal, threads, NULL), GNEISS_OK);
        give_lists(&deal, m);
        for (int still = 0; still < threads; still++) {
            clear(m);
            gn_deal_begin(&deal);
            const double share = deal.share[1];
            m->still = still;
#pragma omp parallel num_threads(deal.team)
            gn_deal_sweep(&deal, 0, &work, m);
            gn_deal_end(&deal, 1, 1e-5);
            assert_false(m->stuck);
            check(m);
            if (still == 0) assert_true(deal.share[1] < share);
        }
        gn_deal_free(&deal);
    }
    free(m);
}

/* A slow thread gets a smaller share. */
static void shares_follow_the_pace(void **state) {
    (void)state;
    uint64_t seed = 3;
    model *m = calloc(1, sizeof *m);
    gn_deal deal;
    m->particle_blocks = 10;
    make_list(m, 0, 40, &seed);
    assert_int_equal(gn_deal_create(&deal, 2, NULL), GNEISS_OK);
    give_lists(&deal, m);
    for (int round = 0; round < 200; round++) {
        gn_deal_begin(&deal);
        assert_int_equal(deal.team, 2);
        /* The first thread takes three times as long per block: it does 10 of 40, whatever its
         * share is. */
        deal.mark[0].worked = 10;
        deal.mark[1].worked = 30;
        deal.mark[0].seconds = deal.mark[1].seconds = 4e-5; /* neither thread waits */
        gn_deal_end(&deal, 1, 4e-5);
    }
    assert_in_range(deal.cut[0][1], 9, 11);
    gn_deal_free(&deal);
    free(m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_block_once_and_in_time),
        cmocka_unit_test(every_block_once_and_in_time_when_fewer_threads_come),
        cmocka_unit_test(other_threads_take_the_work_of_a_stalled_one),
        cmocka_unit_test(shares_follow_the_pace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
