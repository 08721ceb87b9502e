/* Work distribution among threads for one sweep over items (contacts of some lists, or finite
 * elements) and particles (or nodes). Each thread has a share of each list and processes its blocks
 * in order. A block of particles follows as soon as the last block of items that reads or loads it
 * is done, while its partial sums are in the cache.
 *
 * Items are sorted by their first particle: when a particle's own items are reached, those that it
 * shares with earlier particles are done. A thread that processes items in this order therefore
 * keeps few particles waiting, and finds their rows and partial sums in its cache.
 *
 * A thread whose items are done takes blocks from the far end of other threads' shares: a processor
 * core is often slower than its neighbour, briefly or permanently (other programs, other machines
 * on the same host), and the next sweep cannot be cut for that in advance. A parallel region may
 * also get a smaller team than it requests (OMP_THREAD_LIMIT, OMP_DYNAMIC, a caller's own region),
 * so that no work may depend on the thread of its share: every task and every block of particles
 * can be done by any thread of the team.
 *
 * Blocks of particles whose items were processed by several threads come last. "Shared" blocks lie
 * at the cuts; they are assigned to the thread with the last of their items, because most of the
 * others are its own as well. Blocks without any item are distributed evenly. "Late" blocks lie at
 * the end of a share of which other threads took a part. Each of these is moved by its own thread
 * or an idle one once its items are done. A thread with fewer shared blocks defers the last blocks
 * of its own until then, so that all threads have the same work at the end and seldom take data
 * from another core's cache.
 *
 * All sums are kept per block (see gn_partials) and merged in block order, so that results do not
 * depend on the assignment of work and its timing. */
#ifndef GN_SCHED_DEAL_H
#define GN_SCHED_DEAL_H

#include "base/error.h"
#include "kernels/partials.h"
#include "sched/pace.h"
#include "soa/field.h"

#include <stdatomic.h>

/* A list of items; without partial sums it is empty. */
typedef struct gn_deal_list {
    const gn_partials *partials;
    /* [items] a particle of each item, in ascending order; needed only with several lists */
    const int32_t *leader;
} gn_deal_list;

/* Progress of a thread's share in the present sweep, on a cache line of its own. A word of an
 * earlier sweep means that the share has not been begun. */
typedef struct gn_deal_mark {
    _Alignas(64) _Atomic uint64_t open; /* range of its tasks that no thread has taken */
    /* number of tasks that the thread has done itself, from the front */
    _Atomic uint64_t done;
    _Atomic uint64_t drawn; /* number of its shared and late blocks that are taken */
    /* tasks of any share that the thread has done in this round */
    size_t worked;
    double seconds; /* processor time in this round without waiting, s */
} gn_deal_mark;

typedef struct gn_deal {
    gn_pace pace;
    int threads;        /* largest number of threads */
    double *share;      /* [threads + 1] fraction of the work before a thread's own */
    gn_deal_mark *mark; /* [threads] */
    int lists;
    gn_deal_list list[GN_LISTS_MOST];
    size_t *cut[GN_LISTS_MOST]; /* [threads + 1] first block of a thread's share of a list */
    int team;                   /* threads of the present cuts; 0: cuts are to be made */
    uint64_t sweeps;            /* number of sweeps so far */

    /* Tasks are blocks of items, list after list. */
    size_t tasks, room;
    int32_t *task;      /* [tasks] by threads, in the order in which their particles need them */
    size_t *task_first; /* [threads + 1] */
    int32_t *place;     /* [tasks] index of each task among those of its thread */
    _Atomic uint64_t
        *taken; /* [tasks] number of the last sweep in which another thread did the task */

    /* Blocks of particles by threads: "owned" blocks have all items in one share; "shared" ones
     * include those without items. */
    size_t particle_blocks;
    int32_t *owned;       /* [particle_blocks] */
    int32_t *after;       /* [particle_blocks] number of tasks of its share before it; > 0 */
    size_t *owned_first;  /* [threads + 2] */
    size_t *deferred;     /* [threads] owned blocks from here on wait until all tasks are done */
    int32_t *shared;      /* [particle_blocks] */
    size_t *shared_first; /* [threads + 2] */
} gn_deal;

/* Callbacks for the work on one block; `list` has base 0. Any thread calls them, with the context
 * that it passed. */
typedef struct gn_deal_work {
    void (*items)(void *context, int list, size_t block);
    void (*particles)(void *context, size_t block);
    /* Called after a thread has waited for another one for `seconds`; may be NULL. */
    void (*waited)(void *context, double seconds);
} gn_deal_work;

/* Creates a deal for up to `threads` threads, initially with equal shares. It is to be freed also
 * on failure. */
gneiss_status gn_deal_create(gn_deal *deal, int threads, gneiss_error *error);
void gn_deal_free(gn_deal *deal);

/* Sets the lists, `count` of them, and the number of particle blocks; to be called again whenever a
 * list was rebuilt. */
gneiss_status gn_deal_lists(gn_deal *deal, const gn_deal_list *lists, int count,
                            size_t particle_blocks, gneiss_error *error);

/* Chooses the team (deal->team threads) and the cuts of the coming round of one or more sweeps. */
void gn_deal_begin(gn_deal *deal);

/* Does sweep number `pass` of the round. Every thread of a parallel region calls it that requested
 * deal->team threads (it may have got fewer); a barrier must separate two sweeps. */
void gn_deal_sweep(gn_deal *deal, int pass, const gn_deal_work *work, void *context);

/* Ends the round, whose region took `seconds` for `sweeps` sweeps, and adapts the shares to the
 * threads' pace. */
void gn_deal_end(gn_deal *deal, int sweeps, double seconds);

#endif
