/* Who of the threads works on what in one sweep over items (contacts of up to two lists, or finite
 * elements) and particles (or nodes). Blocks of items are worked on in order, each thread in a
 * share of its own of each list; a block of particles follows as soon as the last block of items
 * that reads or loads it is done, while its partial sums are in the cache. Blocks of particles
 * whose items belong to several threads are taken, one after the other, by whoever has done with
 * its own items, once the other threads have gone past the items that it takes: nobody waits at a
 * barrier in between, and whoever was faster takes more of them. All sums are kept per block (see
 * gn_partials) and merged in block order, so that no result depends on who does what and when. */
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
    _Alignas(64) _Atomic int64_t done[GN_DEAL_LISTS]; /* sweep << 24 | first block not yet done */
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
    int32_t *owner; /* [particle_blocks] the thread that has all items of these particles, or -1 */
    size_t *shared; /* [shared_count] the blocks of particles without owner */
    size_t shared_count;
    int64_t sweeps;        /* so far */
    _Atomic int64_t drawn; /* tickets for shared blocks, so far */
    int64_t first;         /* ticket of the first shared block of the coming sweep */
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

/* Decides about the coming round of one or more sweeps; returns its number of threads. */
int gn_deal_begin(gn_deal *deal);

/* Sweep number `pass` of the round, called by every thread of a parallel region of that many; a
 * barrier has to stand between two. */
void gn_deal_sweep(gn_deal *deal, int pass, const gn_deal_work *work, void *context);

/* After the region, which took `seconds` for so many sweeps. The shares follow the threads' pace.
 */
void gn_deal_end(gn_deal *deal, int sweeps, double seconds);

#endif
