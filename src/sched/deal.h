/* Who of the threads works on what in one sweep over items (contacts of up to two lists, or finite
 * elements) and particles (or nodes). Each thread has a share of its own of each list, whose blocks
 * it works on in order; a block of particles follows as soon as the last block of items that reads
 * or loads it is done, while its partial sums are in the cache.
 *
 * Items are sorted by the first of their particles: when a particle's own come up, those that it
 * has with earlier ones are done. So a thread that works in this order leaves few particles
 * waiting, and finds their rows and partial sums in its cache.
 *
 * A thread that has none of its own items left takes blocks from the far end of the others' shares:
 * a processor core is often slower than its neighbour, for a moment or for long (other programs,
 * other machines on the same host), and nobody can cut the next sweep for that in advance. A
 * parallel region may also get a smaller team than it asks for (OMP_THREAD_LIMIT, OMP_DYNAMIC, a
 * caller's own region), so that no work may depend on the thread whose share it is in: every task
 * and every block of particles can be done by any thread that came.
 *
 * Blocks of particles whose items were worked on by several threads come last: those at the cuts
 * ("shared"; they go to the thread with the last of these items, because most of the others are
 * its own as well), those without any item, which are shared out evenly, and those at the end of a
 * share of which others took a part ("late"). Each is worked on by its own thread or another that
 * has nothing left, when its items are done. Who has fewer shared blocks puts off the last blocks
 * of its own until then, so that all have as much to do at the end and seldom take what lies in
 * another core's cache.
 *
 * All sums are kept per block (see gn_partials) and merged in block order, so that no result
 * depends on who does what and when. */
#ifndef GN_SCHED_DEAL_H
#define GN_SCHED_DEAL_H

#include "base/error.h"
#include "kernels/partials.h"
#include "sched/pace.h"

#include <stdatomic.h>

enum { GN_DEAL_LISTS = 2 };

/* One list of items; without partial sums: none. */
typedef struct gn_deal_list {
    const gn_partials *partials;
    const int32_t *leader; /* [items] a particle of each, in ascending order; for two lists */
} gn_deal_list;

/* How far a thread's share is in the present sweep; a cache line each. A word of an earlier sweep
 * stands for a share that nobody has begun. */
typedef struct gn_deal_mark {
    _Alignas(64) _Atomic uint64_t open; /* which of its tasks nobody has taken: a range */
    _Atomic uint64_t done;              /* how many it has done itself, from the front */
    _Atomic uint64_t drawn;             /* how many of its shared and late blocks are taken */
    size_t worked;                      /* tasks of any share that it has done in this round */
    double seconds; /* of a processor, in this round, in which it did not wait */
} gn_deal_mark;

typedef struct gn_deal {
    gn_pace pace;
    int threads;        /* that may be used */
    double *share;      /* [threads + 1] part of the work that comes before a thread's own */
    gn_deal_mark *mark; /* [threads] */
    gn_deal_list list[GN_DEAL_LISTS];
    size_t *cut[GN_DEAL_LISTS]; /* [threads + 1] first block of a thread's share of a list */
    int team;                   /* threads of the present cuts; 0: to be planned anew */
    uint64_t sweeps;            /* so far */

    /* Blocks of items as tasks, those of the second list after those of the first. */
    size_t tasks, room;
    int32_t *task;      /* [tasks] by threads, in the order in which their particles need them */
    size_t *task_first; /* [threads + 1] */
    int32_t *place;     /* [tasks] the place of each among its thread's */
    _Atomic uint64_t *taken; /* [tasks] the sweep in which another thread last did it */

    /* Blocks of particles by threads: those whose items are all in one share, and the shared,
     * which include those without items. */
    size_t particle_blocks;
    int32_t *owned;       /* [particle_blocks] */
    int32_t *after;       /* [particle_blocks] how many tasks of its share come before it; > 0 */
    size_t *owned_first;  /* [threads + 2] */
    size_t *put_off;      /* [threads] from this one on they come when all tasks are done */
    int32_t *shared;      /* [particle_blocks] */
    size_t *shared_first; /* [threads + 2] */
} gn_deal;

/* The work on one block; `list` counts from 0. Called by any thread, with the context it brought.
 */
typedef struct gn_deal_work {
    void (*items)(void *context, int list, size_t block);
    void (*particles)(void *context, size_t block);
    /* After a thread has waited for another one, so many s; may be NULL. */
    void (*waited)(void *context, double seconds);
} gn_deal_work;

/* For up to `threads` threads, with equal shares to begin with. To be freed either way. */
gneiss_status gn_deal_create(gn_deal *deal, int threads, gneiss_error *error);
void gn_deal_free(gn_deal *deal);

/* The lists and the number of particles' blocks from now on; again whenever a list was made anew.
 */
gneiss_status gn_deal_lists(gn_deal *deal, gn_deal_list one, gn_deal_list other,
                            size_t particle_blocks, gneiss_error *error);

/* Decides about the coming round of one or more sweeps, by deal->team threads. */
void gn_deal_begin(gn_deal *deal);

/* Sweep number `pass` of the round, called by every thread of a parallel region that asked for that
 * many and may have got fewer; a barrier has to stand between two. */
void gn_deal_sweep(gn_deal *deal, int pass, const gn_deal_work *work, void *context);

/* After the region, which took `seconds` for so many sweeps. The shares follow the threads' pace.
 */
void gn_deal_end(gn_deal *deal, int sweeps, double seconds);

#endif
