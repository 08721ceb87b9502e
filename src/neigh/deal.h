/* Who of the threads works on what in one sweep over items (contacts of up to two lists, or finite
 * elements) and particles (or nodes). Each thread has a share of its own of each list, whose blocks
 * it works on in order; a block of particles follows as soon as the last block of items that reads
 * or loads it is done, while its partial sums are in the cache.
 *
 * Items are sorted by the first of their particles: when a particle's own come up, those that it
 * has with earlier ones are done. So a thread that works in this order leaves few particles
 * waiting, and finds their rows and partial sums in its cache.
 *
 * Blocks of particles whose items belong to several threads ("shared") come last. They go to the
 * thread with the last of these items, because most of the others are its own as well, and are
 * worked on when the other threads have done theirs. A thread that has nothing left takes shared
 * blocks of the others.
 *
 * All sums are kept per block (see gn_partials) and merged in block order, so that no result
 * depends on who does what and when. */
#ifndef GN_NEIGH_DEAL_H
#define GN_NEIGH_DEAL_H

#include "base/error.h"
#include "base/pace.h"
#include "kernels/partials.h"

#include <stdatomic.h>

enum { GN_DEAL_LISTS = 2 };

/* One list of items; without partial sums: none. */
typedef struct gn_deal_list {
    const gn_partials *partials;
    const int32_t *leader; /* [items] a particle of each, in ascending order; for two lists */
} gn_deal_list;

/* What a thread has done of each list; a cache line each. */
typedef struct gn_deal_mark {
    _Alignas(64) _Atomic int64_t done[GN_DEAL_LISTS]; /* sweep << 24 | blocks of its share done */
    _Atomic int64_t drawn; /* tickets for shared blocks that are its own, so far */
} gn_deal_mark;

typedef struct gn_deal {
    gn_pace pace;
    int threads;        /* that may be used */
    double *share;      /* [threads + 1] part of the work that comes before a thread's own */
    gn_busy *busy;      /* [threads] */
    gn_deal_mark *mark; /* [threads] */
    gn_deal_list list[GN_DEAL_LISTS];
    size_t *cut[GN_DEAL_LISTS]; /* [threads + 1] first block of a thread's share of a list */
    int team;                   /* threads of the present cuts; 0: to be planned anew */
    size_t particle_blocks;
    int32_t *owner;  /* [particle_blocks] the thread that has all items of these particles, or -1 */
    size_t *shared;  /* the blocks of particles without owner, by their threads */
    size_t *first;   /* [threads + 1] of a thread's blocks in `shared` */
    int64_t sweeps;  /* so far */
    int64_t *ticket; /* [threads] of the first of these in the coming sweep */
} gn_deal;

/* The work on one block; `list` counts from 0. Called by any thread, with the context it brought.
 */
typedef struct gn_deal_work {
    void (*items)(void *context, int list, size_t block);
    void (*particles)(void *context, size_t block);
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

/* Sweep number `pass` of the round, called by every thread of a parallel region of that many; a
 * barrier has to stand between two. */
void gn_deal_sweep(gn_deal *deal, int pass, const gn_deal_work *work, void *context);

/* After the region, which took `seconds` for so many sweeps. The shares follow the threads' pace.
 */
void gn_deal_end(gn_deal *deal, int sweeps, double seconds);

#endif
