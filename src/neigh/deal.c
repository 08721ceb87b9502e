#include "neigh/deal.h"

#include "base/memory.h"
#include "base/timer.h"

#include <math.h>
#include <omp.h>
#include <sched.h>
#include <string.h>

gneiss_status gn_deal_create(gn_deal *deal, int threads, gneiss_error *error) {
    const size_t n = (size_t)threads;
    *deal = (gn_deal){.threads = threads, .pace = gn_pace_start(threads, 32, 512, 32768)};
    deal->share = gn_alloc_array(n + 1, sizeof *deal->share);
    deal->busy = gn_alloc_array(n, sizeof *deal->busy);
    deal->mark = gn_alloc_array(n, sizeof *deal->mark);
    deal->first = gn_alloc_array(n + 1, sizeof *deal->first);
    deal->ticket = gn_alloc_array(n, sizeof *deal->ticket);
    bool held = deal->share && deal->busy && deal->mark && deal->first && deal->ticket;
    for (int l = 0; l < GN_DEAL_LISTS; l++) {
        deal->cut[l] = gn_alloc_array(n + 1, sizeof *deal->cut[l]);
        held = held && deal->cut[l];
    }
    if (!held) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %d threads", threads);
    for (size_t t = 0; t <= n; t++) deal->share[t] = (double)t / (double)n;
    return GNEISS_OK;
}

void gn_deal_free(gn_deal *deal) {
    gn_free(deal->share);
    gn_free(deal->busy);
    gn_free(deal->mark);
    gn_free(deal->first);
    gn_free(deal->ticket);
    for (int l = 0; l < GN_DEAL_LISTS; l++) gn_free(deal->cut[l]);
    gn_free(deal->owner);
    gn_free(deal->shared);
    *deal = (gn_deal){0};
}

gneiss_status gn_deal_lists(gn_deal *deal, gn_deal_list one, gn_deal_list other,
                            size_t particle_blocks, gneiss_error *error) {
    deal->list[0] = one;
    deal->list[1] = other;
    deal->team = 0;
    if (deal->owner && particle_blocks == deal->particle_blocks) return GNEISS_OK;
    gn_free(deal->owner);
    gn_free(deal->shared);
    deal->particle_blocks = particle_blocks;
    deal->owner = gn_alloc_array(particle_blocks + 1, sizeof *deal->owner);
    deal->shared = gn_alloc_array(particle_blocks + 1, sizeof *deal->shared);
    if (deal->owner && deal->shared) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %zu blocks of particles",
                   particle_blocks);
}

/* --- cuts between threads
 * -------------------------------------------------------------------------------- */

static size_t block_count(const gn_deal_list *list) {
    return list->partials ? list->partials->blocks : 0;
}

/* First block of a list whose first item belongs to `particle` or a later one. */
static size_t block_at(const gn_deal_list *list, int32_t particle) {
    size_t low = 0, high = block_count(list);
    while (low < high) {
        size_t mid = (low + high) / 2;
        if (list->leader[mid * list->partials->length] < particle)
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

/* The list with more items, which the others follow. */
static int lead_of(const gn_deal *deal) {
    size_t most = 0;
    int lead = 0;
    for (int l = 0; l < GN_DEAL_LISTS; l++) {
        const gn_deal_list *list = &deal->list[l];
        size_t items = block_count(list) ? block_count(list) * list->partials->length : 0;
        if (items > most) lead = l;
        if (items > most) most = items;
    }
    return lead;
}

/* Where thread t's share of a list begins: the longer list is cut by blocks, the shorter one at the
 * same particles, so that few particles have items on both sides. */
static size_t cut_of(const gn_deal *deal, int lead, int l, int t, int threads) {
    const gn_deal_list *list = &deal->list[l], *leading = &deal->list[lead];
    if (t == 0 || t == threads) return t ? block_count(list) : 0;
    size_t block = (size_t)lround(deal->share[t] * (double)block_count(leading));
    if (l == lead) return block;
    if (!block_count(list) || block >= block_count(leading)) return block_count(list);
    return block_at(list, leading->leader[block * leading->partials->length]);
}

/* Last block of items that touches a block of particles, -1: none. */
static int64_t last_touch(const gn_deal_list *list, size_t particles) {
    return block_count(list) ? list->partials->touched[1][particles] : -1;
}
static int64_t first_touch(const gn_deal_list *list, size_t particles) {
    return list->partials->touched[0][particles];
}

/* The thread whose share block b of a list belongs to. */
static int32_t holder(const gn_deal *deal, int l, int64_t b) {
    int32_t low = 0, high = deal->team - 1; /* the last one whose cut is not above b */
    while (low < high) {
        int32_t mid = (low + high + 1) / 2;
        if ((int64_t)deal->cut[l][mid] <= b)
            low = mid;
        else
            high = mid - 1;
    }
    return low;
}

/* The first and the last thread with items of a block of particles. */
typedef struct span {
    int32_t first, last;
} span;

static span threads_of(const gn_deal *deal, size_t p) {
    span s = {deal->team, -1};
    for (int l = 0; l < GN_DEAL_LISTS; l++) {
        if (last_touch(&deal->list[l], p) < 0) continue;
        int32_t first = holder(deal, l, first_touch(&deal->list[l], p));
        int32_t last = holder(deal, l, last_touch(&deal->list[l], p));
        if (first < s.first) s.first = first;
        if (last > s.last) s.last = last;
    }
    /* Particles without any item go to all in equal parts. */
    if (s.last < 0) s.first = s.last = (int32_t)(p * (size_t)deal->team / deal->particle_blocks);
    return s;
}

/* Blocks of particles with one thread get an owner, the others are listed by their last thread. */
static void deal_out(gn_deal *deal) {
    for (int t = 0; t <= deal->team; t++) deal->first[t] = 0;
    for (size_t p = 0; p < deal->particle_blocks; p++) {
        span s = threads_of(deal, p);
        deal->owner[p] = s.first == s.last ? s.first : -1;
        if (s.first != s.last) deal->first[s.last + 1]++;
    }
    for (int t = 0; t < deal->team; t++) deal->first[t + 1] += deal->first[t];
    size_t next = 0;
    for (int t = 0; t < deal->team; t++)
        for (size_t p = 0; p < deal->particle_blocks && next < deal->first[t + 1]; p++)
            if (deal->owner[p] < 0 && threads_of(deal, p).last == t) deal->shared[next++] = p;
}

void gn_deal_begin(gn_deal *deal) {
    const int threads = gn_pace_threads(&deal->pace), lead = lead_of(deal);
    bool same = deal->team == threads;
    for (int l = 0; l < GN_DEAL_LISTS; l++)
        for (int t = 0; t <= threads; t++) {
            size_t cut = cut_of(deal, lead, l, t, threads);
            same = same && cut == deal->cut[l][t];
            deal->cut[l][t] = cut;
        }
    if (same) return;
    deal->team = threads;
    deal_out(deal);
}

/* --- a sweep
 * --------------------------------------------------------------------------------------------- */

static int64_t stamped(int64_t sweep, size_t blocks) {
    return (sweep << 24) + (int64_t)blocks;
}

/* A thread in a sweep. */
typedef struct worker {
    gn_deal *deal;
    const gn_deal_work *work;
    void *context;
    int me, pass;
    int64_t sweep;
    size_t done[GN_DEAL_LISTS]; /* blocks of its share */
} worker;

static size_t size_of_share(const gn_deal *deal, int l, int t) {
    return deal->cut[l][t + 1] - deal->cut[l][t];
}

/* How many blocks of thread t's share have to be done until all of it that touches a block of
 * particles is done. */
static size_t needed(const gn_deal *deal, int l, int t, size_t p) {
    const int64_t begin = (int64_t)deal->cut[l][t], end = (int64_t)deal->cut[l][t + 1];
    const int64_t last = last_touch(&deal->list[l], p);
    if (last < begin || begin == end) return 0;
    if (first_touch(&deal->list[l], p) >= end) return 0;
    return (size_t)((last < end ? last + 1 : end) - begin);
}

static void advance(worker *k, int l, size_t wanted) {
    const gn_deal *deal = k->deal;
    while (k->done[l] < wanted) {
        k->work->items(k->context, l, deal->cut[l][k->me] + k->done[l]++);
        atomic_store_explicit(&deal->mark[k->me].done[l], stamped(k->sweep, k->done[l]),
                              memory_order_release);
    }
}

static void work_alone(worker *k) {
    const gn_deal *deal = k->deal;
    for (size_t p = 0; p < deal->particle_blocks; p++) {
        if (deal->owner[p] != k->me) continue;
        for (int l = 0; l < GN_DEAL_LISTS; l++) advance(k, l, needed(deal, l, k->me, p));
        k->work->particles(k->context, p);
    }
    for (int l = 0; l < GN_DEAL_LISTS; l++) advance(k, l, size_of_share(deal, l, k->me));
}

/* Spins until `done` has come to `wanted`; returns the seconds lost. */
static double await(const _Atomic int64_t *done, int64_t wanted) {
    enum { SPINS = 2000 };
    if (atomic_load_explicit(done, memory_order_acquire) >= wanted) return 0.0;
    const double start = gn_now();
    for (unsigned k = 1; atomic_load_explicit(done, memory_order_acquire) < wanted; k++)
        if (k % SPINS == 0)
            sched_yield(); /* the other thread may need this core */
        else
            __builtin_ia32_pause();
    return gn_now() - start;
}

/* Until all items of a shared block of particles are done; returns the seconds lost. */
static double await_items(const worker *k, size_t p) {
    const gn_deal *deal = k->deal;
    const span s = threads_of(deal, p);
    double lost = 0.0;
    for (int l = 0; l < GN_DEAL_LISTS; l++)
        for (int t = s.first; t <= s.last; t++) {
            const size_t wanted = needed(deal, l, t, p);
            if (t != k->me && wanted)
                lost += await(&deal->mark[t].done[l], stamped(k->sweep, wanted));
        }
    return lost;
}

/* Every thread draws one ticket too many of every thread's. */
static int64_t tickets(const gn_deal *deal, int t) {
    return (int64_t)(deal->first[t + 1] - deal->first[t]) + deal->team;
}

static double work_on_shared(worker *k) {
    gn_deal *deal = k->deal;
    double lost = 0.0;
    for (int turn = 0; turn < deal->team; turn++) {
        const int t = (k->me + turn) % deal->team;
        const int64_t ticket = deal->ticket[t] + k->pass * tickets(deal, t);
        const int64_t count = (int64_t)(deal->first[t + 1] - deal->first[t]);
        for (;;) {
            int64_t drawn =
                atomic_fetch_add_explicit(&deal->mark[t].drawn, 1, memory_order_relaxed) - ticket;
            if (drawn >= count) break;
            const size_t p = deal->shared[deal->first[t] + (size_t)drawn];
            lost += await_items(k, p);
            k->work->particles(k->context, p);
        }
    }
    return lost;
}

void gn_deal_sweep(gn_deal *deal, int pass, const gn_deal_work *work, void *context) {
    worker k = {.deal = deal, .work = work, .context = context, .me = omp_get_thread_num()};
    const double start = gn_now();
    k.pass = pass;
    k.sweep = deal->sweeps + pass + 1;
    work_alone(&k);
    const double lost = work_on_shared(&k);
    deal->busy[k.me].seconds += gn_now() - start - lost;
}

void gn_deal_end(gn_deal *deal, int sweeps, double seconds) {
    double busy = 0.0;
    for (int t = 0; t < deal->team; t++) busy += deal->busy[t].seconds / deal->team;
    if (deal->team > 1) gn_pace_follow(deal->team, deal->busy, deal->share);
    for (int t = 0; t < deal->team; t++) deal->busy[t].seconds = 0.0;
    gn_pace_note(&deal->pace, seconds, 1.0, 1.0 - busy / seconds);
    deal->sweeps += sweeps;
    for (int t = 0; t < deal->team; t++) deal->ticket[t] += sweeps * tickets(deal, t);
}
