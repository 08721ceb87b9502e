#include "sched/deal.h"

#include "base/memory.h"
#include "base/processor.h"
#include "base/timer.h"

#include <math.h>
#include <omp.h>
#include <sched.h>
#include <stdlib.h>

gneiss_status gn_deal_create(gn_deal *deal, int threads, gneiss_error *error) {
    const size_t n = (size_t)threads;
    *deal = (gn_deal){.threads = threads, .pace = gn_pace_start(threads, 32, 128, 32768)};
    deal->share = gn_alloc_array(n + 1, sizeof *deal->share);
    deal->mark = gn_alloc_array(n, sizeof *deal->mark);
    deal->task_first = gn_alloc_array(n + 1, sizeof *deal->task_first);
    deal->owned_first = gn_alloc_array(n + 2, sizeof *deal->owned_first);
    deal->shared_first = gn_alloc_array(n + 2, sizeof *deal->shared_first);
    deal->deferred = gn_alloc_array(n, sizeof *deal->deferred);
    bool held = deal->share && deal->mark && deal->task_first && deal->owned_first &&
                deal->shared_first && deal->deferred;
    for (int l = 0; l < GN_LISTS_MOST; l++) {
        deal->cut[l] = gn_alloc_array(n + 1, sizeof *deal->cut[l]);
        held = held && deal->cut[l];
    }
    if (!held) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for %d threads", threads);
    for (size_t t = 0; t <= n; t++) deal->share[t] = (double)t / (double)n;
    return GNEISS_OK;
}

static void free_tasks(gn_deal *deal) {
    gn_free(deal->task);
    gn_free(deal->place);
    gn_free((void *)deal->taken);
    deal->task = deal->place = NULL;
    deal->taken = NULL;
    deal->room = 0;
}

static void free_particles(gn_deal *deal) {
    gn_free(deal->owned);
    gn_free(deal->after);
    gn_free(deal->shared);
    deal->owned = deal->after = deal->shared = NULL;
    deal->particle_blocks = 0;
}

void gn_deal_free(gn_deal *deal) {
    gn_free(deal->share);
    gn_free(deal->mark);
    gn_free(deal->task_first);
    gn_free(deal->owned_first);
    gn_free(deal->shared_first);
    gn_free(deal->deferred);
    for (int l = 0; l < GN_LISTS_MOST; l++) gn_free(deal->cut[l]);
    free_tasks(deal);
    free_particles(deal);
    *deal = (gn_deal){0};
}

static size_t block_count(const gn_deal_list *list) {
    return list->partials ? list->partials->blocks : 0;
}

/* Reserves one and a half times the size: rebuilt lists differ little in length. */
static bool hold_tasks(gn_deal *deal) {
    deal->tasks = 0;
    for (int l = 0; l < deal->lists; l++) deal->tasks += block_count(&deal->list[l]);
    if (deal->task && deal->tasks <= deal->room) return true;
    free_tasks(deal);
    const size_t room = deal->tasks + deal->tasks / 2 + 1;
    deal->task = gn_alloc_array(room, sizeof *deal->task);
    deal->place = gn_alloc_array(room, sizeof *deal->place);
    deal->taken = gn_alloc_array(room, sizeof *deal->taken);
    deal->room = room;
    if (deal->task && deal->place && deal->taken) return true;
    free_tasks(deal);
    return false;
}

static bool hold_particles(gn_deal *deal, size_t blocks) {
    if (deal->owned && blocks == deal->particle_blocks) return true;
    free_particles(deal);
    deal->owned = gn_alloc_array(blocks + 1, sizeof *deal->owned);
    deal->after = gn_alloc_array(blocks + 1, sizeof *deal->after);
    deal->shared = gn_alloc_array(blocks + 1, sizeof *deal->shared);
    deal->particle_blocks = blocks;
    if (deal->owned && deal->after && deal->shared) return true;
    free_particles(deal);
    return false;
}

gneiss_status gn_deal_lists(gn_deal *deal, const gn_deal_list *lists, int count,
                            size_t particle_blocks, gneiss_error *error) {
    deal->lists = count;
    for (int l = 0; l < count; l++) deal->list[l] = lists[l];
    deal->team = 0;
    if (hold_tasks(deal) && hold_particles(deal, particle_blocks)) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY,
                   "no memory for %zu blocks of particles and %zu blocks of their items",
                   particle_blocks, deal->tasks);
}

/* --- cuts between threads --- */

/* Returns the first block of a list whose first item belongs to `particle` or a later one. */
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

/* Returns the list with the most items, which determines the cuts of the others. */
static int lead_of(const gn_deal *deal) {
    size_t most = 0;
    int lead = 0;
    for (int l = 0; l < deal->lists; l++) {
        const gn_deal_list *list = &deal->list[l];
        size_t items = block_count(list) ? block_count(list) * list->partials->length : 0;
        if (items > most) lead = l;
        if (items > most) most = items;
    }
    return lead;
}

/* Returns the block of the longer list at which thread t's share should begin, by the measured
 * shares. */
static size_t cut_wanted(const gn_deal *deal, const gn_deal_list *leading, int t, int threads) {
    if (t == 0 || t == threads) return t ? block_count(leading) : 0;
    return (size_t)lround(deal->share[t] * (double)block_count(leading));
}

/* Returns the cut of a list: the leading list is cut at a block, the others at the same particle,
 * so that few particles have items on both sides. */
static size_t cut_of(const gn_deal_list *list, const gn_deal_list *leading, size_t cut) {
    if (list == leading || cut == 0) return cut;
    if (cut >= block_count(leading) || !block_count(list)) return block_count(list);
    return block_at(list, leading->leader[cut * leading->partials->length]);
}

static void cut_lists(gn_deal *deal, int lead, int threads) {
    const gn_deal_list *leading = &deal->list[lead];
    for (int t = 0; t <= threads; t++) {
        const size_t cut = cut_wanted(deal, leading, t, threads);
        for (int l = 0; l < deal->lists; l++)
            deal->cut[l][t] = cut_of(&deal->list[l], leading, cut);
    }
    deal->team = threads;
}

/* Tells whether the present cuts are good enough. A cut that would move by less than a fiftieth of
 * a share stays: moving it changes the contents of caches, and threads take work from each other
 * anyway. */
static bool cuts_hold(const gn_deal *deal, int lead, int threads) {
    const gn_deal_list *leading = &deal->list[lead];
    if (deal->team != threads) return false;
    for (int t = 1; t < threads; t++) {
        const int64_t off =
            (int64_t)cut_wanted(deal, leading, t, threads) - (int64_t)deal->cut[lead][t];
        if (50 * llabs(off) * threads > (int64_t)block_count(leading)) return false;
    }
    return true;
}

/* Returns the last block of items that touches a block of particles, -1 if none does. */
static int64_t last_touch(const gn_deal_list *list, size_t particles) {
    return block_count(list) ? list->partials->touched[1][particles] : -1;
}
static int64_t first_touch(const gn_deal_list *list, size_t particles) {
    return list->partials->touched[0][particles];
}

/* Returns the thread whose share contains block b of a list. */
static int32_t holder(const gn_deal *deal, int l, int64_t b) {
    int32_t low = 0,
            high = deal->team - 1; /* search for the last thread whose cut is not above b */
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
    bool shared; /* no single thread owns the block */
} span;

static span threads_of(const gn_deal *deal, size_t p) {
    span s = {deal->team, -1, false};
    for (int l = 0; l < deal->lists; l++) {
        if (last_touch(&deal->list[l], p) < 0) continue;
        int32_t first = holder(deal, l, first_touch(&deal->list[l], p));
        int32_t last = holder(deal, l, last_touch(&deal->list[l], p));
        if (first < s.first) s.first = first;
        if (last > s.last) s.last = last;
    }
    /* Blocks without any item are distributed evenly, and any thread may take them, since the
     * thread to which they are assigned may be missing in this sweep. */
    s.shared = s.first != s.last;
    if (s.last < 0) s.first = s.last = (int32_t)(p * (size_t)deal->team / deal->particle_blocks);
    return s;
}

/* Returns the last block of a thread's share of a list that touches a block of particles, -1 if
 * none does. */
static int64_t last_in_share(const gn_deal *deal, int l, int t, size_t p) {
    const int64_t begin = (int64_t)deal->cut[l][t], end = (int64_t)deal->cut[l][t + 1];
    const int64_t last = last_touch(&deal->list[l], p);
    if (last < begin || begin == end || first_touch(&deal->list[l], p) >= end) return -1;
    return last < end ? last : end - 1;
}

static size_t task_of(const gn_deal *deal, int l, size_t block) {
    while (l-- > 0) block += block_count(&deal->list[l]);
    return block;
}

/* The tasks of a thread while they are put in order. `next` is the first block of each list that is
 * not yet included. */
typedef struct sequence {
    int t;
    size_t next[GN_LISTS_MOST];
    size_t length;
} sequence;

static void append(gn_deal *deal, sequence *order, int l, size_t end) {
    for (; order->next[l] < end; order->next[l]++, order->length++) {
        const size_t task = task_of(deal, l, order->next[l]);
        deal->task[deal->task_first[order->t] + order->length] = (int32_t)task;
        deal->place[task] = (int32_t)order->length;
    }
}

/* Orders the tasks of a thread: those that a block of its particles needs precede that block
 * directly, and the rest comes last. */
static void put_in_order(gn_deal *deal, int t) {
    sequence s = {.t = t};
    for (int l = 0; l < deal->lists; l++) s.next[l] = deal->cut[l][t];
    for (size_t k = deal->owned_first[t]; k < deal->owned_first[t + 1]; k++) {
        for (int l = 0; l < deal->lists; l++)
            append(deal, &s, l, (size_t)(last_in_share(deal, l, t, (size_t)deal->owned[k]) + 1));
        deal->after[k] = (int32_t)s.length;
    }
    for (int l = 0; l < deal->lists; l++) append(deal, &s, l, deal->cut[l][t + 1]);
    deal->task_first[t + 1] = deal->task_first[t] + s.length;
}

/* Converts counts at [t + 2] into starts at [t + 1], which filling then advances to the start of
 * the next thread. */
static void add_up(size_t *first, int threads) {
    for (int t = 0; t < threads; t++) first[t + 2] += first[t + 1];
}

/* Returns the number of thread t's entries in a list sorted by threads. */
static size_t count_of(const size_t *first, int t) {
    return first[t + 1] - first[t];
}

/* Defers the last owned blocks of a thread, as many as it has fewer shared blocks than the thread
 * with the most. */
static void defer_last_blocks(gn_deal *deal) {
    size_t most = 0;
    for (int t = 0; t < deal->team; t++)
        if (count_of(deal->shared_first, t) > most) most = count_of(deal->shared_first, t);
    for (int t = 0; t < deal->team; t++) {
        const size_t shared = count_of(deal->shared_first, t);
        const size_t owned = count_of(deal->owned_first, t);
        const size_t later = most - shared < owned ? most - shared : owned;
        deal->deferred[t] = deal->owned_first[t + 1] - later;
    }
}

/* Assigns blocks of particles to threads. A block whose items all belong to one thread is owned by
 * it; the others are assigned to the last thread with items of theirs. Every owned block therefore
 * follows at least one task; if another thread does that task, the block is late. */
static void deal_out(gn_deal *deal) {
    for (int t = 0; t < deal->team + 2; t++) deal->owned_first[t] = deal->shared_first[t] = 0;
    for (size_t p = 0; p < deal->particle_blocks; p++) {
        const span s = threads_of(deal, p);
        (s.shared ? deal->shared_first : deal->owned_first)[s.last + 2]++;
    }
    add_up(deal->owned_first, deal->team);
    add_up(deal->shared_first, deal->team);
    for (size_t p = 0; p < deal->particle_blocks; p++) {
        const span s = threads_of(deal, p);
        if (s.shared)
            deal->shared[deal->shared_first[s.last + 1]++] = (int32_t)p;
        else
            deal->owned[deal->owned_first[s.last + 1]++] = (int32_t)p;
    }
    defer_last_blocks(deal);
    deal->task_first[0] = 0;
    for (int t = 0; t < deal->team; t++) put_in_order(deal, t);
}

/* --- a sweep --- */

/* Words of a mark hold the number of the sweep and a count below 2^24. */
enum { COUNT_BITS = 24 };
static uint64_t stamped(uint64_t sweep, uint64_t number) {
    return (sweep << COUNT_BITS) + number;
}

/* Tasks [front, back) of a share that no thread has taken, stored with the last bits of the sweep
 * number. These bits may repeat, because a share with tasks is begun in every sweep between two
 * cuts. */
typedef struct range {
    uint64_t front, back;
} range;

static uint64_t packed(uint64_t sweep, range r) {
    return (sweep << (2 * COUNT_BITS)) + (r.front << COUNT_BITS) + r.back;
}

static range unpacked(uint64_t word, uint64_t sweep, uint64_t tasks) {
    const uint64_t mask = ((uint64_t)1 << COUNT_BITS) - 1;
    if (word >> (2 * COUNT_BITS) != (sweep << (2 * COUNT_BITS)) >> (2 * COUNT_BITS))
        return (range){0, tasks};
    return (range){word >> COUNT_BITS & mask, word & mask};
}

void gn_deal_begin(gn_deal *deal) {
    const int threads = gn_pace_threads(&deal->pace), lead = lead_of(deal);
    if (cuts_hold(deal, lead, threads)) return;
    cut_lists(deal, lead, threads);
    deal_out(deal);
    for (int t = 0; t < threads; t++) deal->mark[t].open = packed(deal->sweeps, (range){0, 0});
}

/* State of a thread in a sweep. */
typedef struct worker {
    gn_deal *deal;
    const gn_deal_work *work;
    void *context;
    int me;
    uint64_t sweep;
    size_t tasks; /* tasks done by this thread */
    double lost;  /* s of waiting */
} worker;

/* Returns the range of thread t's tasks that no thread has taken. */
static range open_of(const worker *thread, int t) {
    uint64_t word = atomic_load_explicit(&thread->deal->mark[t].open, memory_order_relaxed);
    return unpacked(word, thread->sweep, count_of(thread->deal->task_first, t));
}

/* Takes the next task of the worker from the front, or the last task of another thread from the
 * back. Returns its index, -1 if none is left. */
static int64_t take(const worker *thread, int t) {
    gn_deal_mark *mark = &thread->deal->mark[t];
    uint64_t word = atomic_load_explicit(&mark->open, memory_order_relaxed);
    for (;;) {
        range r = unpacked(word, thread->sweep, count_of(thread->deal->task_first, t));
        if (r.front >= r.back) return -1;
        const uint64_t place = t == thread->me ? r.front++ : --r.back;
        if (atomic_compare_exchange_weak_explicit(&mark->open, &word, packed(thread->sweep, r),
                                                  memory_order_relaxed, memory_order_relaxed))
            return (int64_t)place;
    }
}

static size_t task_at(const gn_deal *deal, int t, uint64_t place) {
    return (size_t)deal->task[deal->task_first[t] + place];
}

static void work_on_task(worker *thread, size_t task) {
    const gn_deal_list *list = thread->deal->list;
    int l = 0;
    for (; task >= block_count(&list[l]); l++) task -= block_count(&list[l]);
    thread->work->items(thread->context, l, task);
    thread->tasks++;
}

/* Does the tasks of the worker's own share until none is left. */
static void work_on_share(worker *thread) {
    const gn_deal *deal = thread->deal;
    gn_deal_mark *mark = &thread->deal->mark[thread->me];
    size_t p = deal->owned_first[thread->me];
    const size_t end = deal->deferred[thread->me];
    for (int64_t done = 0;; done++) {
        for (; p < end && deal->after[p] == done; p++)
            thread->work->particles(thread->context, (size_t)deal->owned[p]);
        const int64_t place = take(thread, thread->me);
        if (place < 0) break;
        work_on_task(thread, task_at(deal, thread->me, (uint64_t)place));
        atomic_store_explicit(&mark->done, stamped(thread->sweep, (uint64_t)place + 1),
                              memory_order_release);
    }
}

static void help_others(worker *thread) {
    for (int turn = 1; turn < thread->deal->team; turn++) {
        const int t = (thread->me + turn) % thread->deal->team;
        for (int64_t place; (place = take(thread, t)) >= 0;) {
            const size_t task = task_at(thread->deal, t, (uint64_t)place);
            work_on_task(thread, task);
            atomic_store_explicit(&thread->deal->taken[task], thread->sweep, memory_order_release);
        }
    }
}

/* Spins until `word` reaches `wanted`; returns the seconds lost. */
static double await(const _Atomic uint64_t *word, uint64_t wanted) {
    enum { SPINS = 2000 };
    if (atomic_load_explicit(word, memory_order_acquire) >= wanted) return 0.0;
    const double start = gn_now();
    for (unsigned k = 1; atomic_load_explicit(word, memory_order_acquire) < wanted; k++)
        if (k % SPINS == 0)
            sched_yield(); /* the other thread may need this core */
        else
            gn_spin_pause();
    return gn_now() - start;
}

/* Returns the number of tasks of thread t's share that must be done before all items of that share
 * that touch a block of particles are done. */
static uint64_t needed(const gn_deal *deal, int t, size_t p) {
    uint64_t wanted = 0;
    for (int l = 0; l < deal->lists; l++) {
        const int64_t last = last_in_share(deal, l, t, p);
        if (last < 0) continue;
        const uint64_t count = (uint64_t)deal->place[task_of(deal, l, (size_t)last)] + 1;
        if (count > wanted) wanted = count;
    }
    return wanted;
}

/* Waits until all items of a block of particles are done; every task has been taken by some thread.
 */
static void await_items(worker *thread, size_t p) {
    const gn_deal *deal = thread->deal;
    const span s = threads_of(deal, p);
    const double before = thread->lost;
    for (int t = s.first; t <= s.last; t++) {
        const uint64_t wanted = needed(deal, t, p), own = open_of(thread, t).back;
        if (!wanted) continue;
        if (own)
            thread->lost +=
                await(&deal->mark[t].done, stamped(thread->sweep, wanted < own ? wanted : own));
        for (uint64_t place = own; place < wanted; place++)
            thread->lost += await(&deal->taken[task_at(deal, t, place)], thread->sweep);
    }
    if (thread->work->waited && thread->lost > before)
        thread->work->waited(thread->context, thread->lost - before);
}

/* Returns the first of a thread's owned blocks that need a task taken by another thread. */
static size_t first_late(const worker *thread, int t) {
    const gn_deal *deal = thread->deal;
    const uint64_t own = open_of(thread, t).back;
    size_t low = deal->owned_first[t], high = deal->deferred[t];
    while (low < high) {
        const size_t mid = (low + high) / 2;
        if ((uint64_t)deal->after[mid] <= own)
            low = mid + 1;
        else
            high = mid;
    }
    return low;
}

/* Takes one of `count` entries; returns -1 if none is left. */
static int64_t draw(_Atomic uint64_t *drawn, uint64_t sweep, uint64_t count) {
    const uint64_t none = stamped(sweep, 0);
    uint64_t word = atomic_load_explicit(drawn, memory_order_relaxed);
    for (;;) {
        const uint64_t number = word < none ? 0 : word - none;
        if (number >= count) return -1;
        if (atomic_compare_exchange_weak_explicit(drawn, &word, none + number + 1,
                                                  memory_order_relaxed, memory_order_relaxed))
            return (int64_t)number;
    }
}

/* Moves shared and late blocks, whose items several threads processed. */
static void work_on_the_rest(worker *thread) {
    const gn_deal *deal = thread->deal;
    for (int turn = 0; turn < deal->team; turn++) {
        const int t = (thread->me + turn) % deal->team;
        const size_t late = first_late(thread, t);
        const size_t shared = count_of(deal->shared_first, t);
        const size_t count = shared + deal->owned_first[t + 1] - late;
        for (int64_t n; (n = draw(&thread->deal->mark[t].drawn, thread->sweep, count)) >= 0;) {
            const size_t p = (size_t)n < shared
                                 ? (size_t)deal->shared[deal->shared_first[t] + (size_t)n]
                                 : (size_t)deal->owned[late + (size_t)n - shared];
            await_items(thread, p);
            thread->work->particles(thread->context, p);
        }
    }
}

void gn_deal_sweep(gn_deal *deal, int pass, const gn_deal_work *work, void *context) {
    worker k = {.deal = deal, .work = work, .context = context, .me = omp_get_thread_num()};
    const double start = gn_thread_time();
    k.sweep = deal->sweeps + (uint64_t)pass + 1;
    work_on_share(&k);
    help_others(&k);
    work_on_the_rest(&k);
    deal->mark[k.me].seconds += fmax(0.0, gn_thread_time() - start - k.lost);
    deal->mark[k.me].worked += k.tasks;
}

/* Returns the number of tasks that a thread did beyond its own (negative: others did some of its
 * own), as a fraction of its own. A difference of one per sweep is due to the order of arrival and
 * counts as zero. */
static double surplus(const gn_deal *deal, int t, int sweeps) {
    static const double most = 0.5;
    const double own = (double)count_of(deal->task_first, t) * sweeps;
    const double more = (double)deal->mark[t].worked - own;
    if (fabs(more) <= sweeps) return 0.0;
    return fmin(most, fmax(-most, more / fmax(own, 1.0)));
}

/* Adapts the shares: a thread that did more than its share gets a larger one. */
static void follow_pace(gn_deal *deal, int sweeps) {
    static const double pace = 0.05;
    double before = 0.0, total = 0.0;
    for (int t = 0; t < deal->team; t++) {
        const double end = t + 1 < deal->team ? deal->share[t + 1] : 1.0;
        total += (end - before) * (1.0 + pace * surplus(deal, t, sweeps));
        before = end;
        deal->share[t + 1] = total;
    }
    for (int t = 0; t <= deal->team; t++) deal->share[t] /= total;
}

void gn_deal_end(gn_deal *deal, int sweeps, double seconds) {
    double busy = 0.0;
    for (int t = 0; t < deal->team; t++) busy += deal->mark[t].seconds / deal->team;
    gn_pace_note(&deal->pace, seconds, 1.0, 1.0 - busy / seconds);
    if (deal->team > 1) follow_pace(deal, sweeps);
    for (int t = 0; t < deal->team; t++) {
        deal->mark[t].seconds = 0.0;
        deal->mark[t].worked = 0;
    }
    deal->sweeps += (uint64_t)sweeps;
}
