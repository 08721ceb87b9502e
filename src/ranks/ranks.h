/* The share of one rank in the work of a step, and what it exchanges with other ranks.
 *
 * Particles have one order in the whole model (Morton), and their blocks of GN_PARTICLE_BLOCK are
 * divided into one contiguous range per rank. A block of contacts belongs to the rank of its first
 * particle. Blocks are those of a single process, so that no sum depends on the number of ranks:
 *   - a rank processes its blocks of contacts, and sends the rows of partial sums that belong to
 *     particles of other ranks; the owner puts them where its own process would have put them;
 *   - a block of particles that has such rows moves after they have arrived, the others at once;
 *   - the owner sends positions and velocities of the particles that contacts of others read;
 *   - sums of blocks (energies, largest speeds, broken bonds) are gathered, and every rank adds
 *     them in block order.
 * Rows of particles and contacts of other ranks are outdated after a step, except those that own
 * contacts read. Code outside of the step calls gn_ranks_whole before it reads them. */
#ifndef GN_RANKS_RANKS_H
#define GN_RANKS_RANKS_H

#include "base/error.h"
#include "ranks/transport.h"
#include "sched/deal.h"
#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Rows of partial sums by list, and the particles of these rows. */
typedef struct gn_rank_rows {
    size_t first[GN_LISTS_MOST + 1]; /* range of `row` of each list */
    int32_t *row;
    size_t particles;
    int32_t *particle; /* [particles], each once */
} gn_rank_rows;

/* Another rank with which rows are exchanged. */
typedef struct gn_rank_peer {
    gn_rank_rows out, in; /* rows of its particles here, rows of own particles there */
    unsigned char *rows_out, *rows_in, *places_out, *places_in; /* buffers */
} gn_rank_peer;

/* Parts of arrays that are given to all ranks together. Up to GN_RANKS_DIRECT ranks send them to
 * each other, more gather them. */
typedef struct gn_rank_share {
    unsigned char *buffer;
    size_t room, *first; /* [count + 1] places of the ranks */
    gn_messages *out, *in;
} gn_rank_share;

enum { GN_RANKS_DIRECT = 8, GN_RANK_FIELDS = 6 };

typedef struct gn_ranks {
    const gn_transport *transport;
    int rank, count;
    bool whole; /* rows of all ranks are up to date */
    /* Gathers the rows of all ranks; set by the owner of the state before a sweep. */
    void (*gather)(void *context);
    void *context;

    double *share;                     /* [count] wanted shares of the work, sum 1 */
    double busy;                       /* s of processor time in sweeps since the last plan */
    double *busy_of;                   /* [count] those of all ranks */
    size_t particles;                  /* number of particles, removed ones included */
    size_t *block;                     /* [count + 1] first block of particles of each rank */
    size_t *particle;                  /* [count + 1] first particle of each rank */
    size_t *item_block[GN_LISTS_MOST]; /* [count + 1] first block of items of each rank */
    int lists;
    const gn_partials *partials[GN_LISTS_MOST]; /* of all ranks */
    gn_partials own[GN_LISTS_MOST];             /* of the own blocks, for the deal */
    /* [blocks of particles] 1: it does not move in the sweep, because it is another rank's or
     * awaits rows */
    uint8_t *waits;
    /* Own blocks of items with rows of other ranks, which are processed first: [early_count] list
     * and block, and a mark for each block of items of a list, from the first own one on. */
    size_t early_count;
    struct gn_rank_block {
        int list;
        size_t block;
    } * early;
    uint8_t *is_early[GN_LISTS_MOST];
    size_t late_count;
    int32_t *late; /* [late_count] own blocks that await rows */

    struct { /* rows of particles that contacts read */
        unsigned char *data;
        size_t bytes; /* per particle */
    } field[GN_RANK_FIELDS];
    int fields;
    gn_rank_peer *peer; /* [count] */
    gn_messages *rows_out, *rows_in, *places_out, *places_in;
    int32_t *seen; /* [particles + 1] scratch of the plan */

    size_t *range, *bytes; /* [count + 1] scratch */

    /* Set by the owner of the state: what is shared in every step, and forces on walls and sets,
     * which are shared when they are needed. */
    gn_rank_share sums, forces;
    bool forces_known; /* those of the last step */
    /* [count + 1] first contact with walls of the particles of each rank; first entries of the
     * blocks of particles near walls and of the slots of prescribed particles, by ranks */
    size_t *wall_contact, *wall_block_first, *prescribed_first;
    int32_t *wall_block, *prescribed;
} gn_ranks;

/* *ranks is NULL if the process is alone. To be freed also on failure. */
gneiss_status gn_ranks_create(gn_ranks **ranks, gneiss_error *error);
void gn_ranks_free(gn_ranks *ranks);

/* Divides lists that were just made: `list` [lists] of all items; their partial sums are replaced
 * by those of the own blocks, and the first items accordingly. */
gneiss_status gn_ranks_plan(gn_ranks *ranks, const gn_particles *particles, gn_deal_list *list,
                            int lists, gneiss_error *error);

/* The messages of a step. Rows of partial sums are sent when the early blocks are done, and taken
 * when all own blocks are; places are exchanged when own particles have moved. */
void gn_ranks_begin_step(gn_ranks *ranks);
void gn_ranks_send_rows(gn_ranks *ranks);
void gn_ranks_take_rows(gn_ranks *ranks);
void gn_ranks_exchange_places(gn_ranks *ranks);

/* An array of which each rank knows items [first[rank], first[rank + 1]). */
typedef struct gn_rank_part {
    void *data;
    size_t bytes;        /* per item */
    const size_t *first; /* [count + 1] */
    const int32_t *item; /* places of the items in `data`; NULL: they are consecutive */
} gn_rank_part;

/* Fixes the sizes of parts that are given to all ranks together, and allocates their buffer. */
gneiss_status gn_ranks_plan_share(gn_ranks *ranks, gn_rank_share *share, const gn_rank_part *part,
                                  size_t parts, gneiss_error *error);
/* Gives the items of all parts to all ranks, between begin and end. */
void gn_ranks_begin_share(gn_ranks *ranks, gn_rank_share *share, const gn_rank_part *part,
                          size_t parts);
void gn_ranks_end_share(gn_ranks *ranks, gn_rank_share *share, const gn_rank_part *part,
                        size_t parts);
/* Gives the rows of a record to all ranks: each knows items [first[rank], first[rank + 1]). Fields
 * named in `but`, a list that ends with NULL, are left out. */
void gn_ranks_gather_record(gn_ranks *ranks, const gn_record *record, const void *soa,
                            const size_t *first, const char *const *but);

/* Makes the rows of all ranks known to this one, if they are outdated. All ranks call it at the
 * same point. `ranks` may be NULL. */
static inline void gn_ranks_whole(gn_ranks *ranks) {
    if (ranks && !ranks->whole) ranks->gather(ranks->context);
}

#endif
