/* Active pairs. In flowing grains two of three listed pairs do not touch, and a vector kernel
 * cannot skip single pairs. Therefore the pairs of a block are found that touch, touched in the
 * last two steps (they may have acted for a part of a step, or their state must be reset), or may
 * touch within the next few steps at their velocities. Their columns are packed together, and for
 * these steps the kernel processes them alone, in the order of the list. Omitted pairs would have
 * added zeros, so that every bit of every sum is the same. Changes of velocity are tracked in every
 * step: when they could bring an omitted pair into contact, the search is repeated. */
#ifndef GN_PARTICLES_ACTIVE_PAIRS_H
#define GN_PARTICLES_ACTIVE_PAIRS_H

#include "frame/parts.h"

#include "base/error.h"
#include "kernels/contact.h"
#include "kernels/near.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A packed column. */
typedef struct gn_active_pairs_column {
    size_t offset; /* offset of its pointer within gn_contacts */
    int components;
    bool written;  /* written by the kernel; zero for pairs that never touched */
    size_t stream; /* offset of its first component in gn_active_pairs.data */
} gn_active_pairs_column;

enum { GN_ACTIVE_PAIRS_COLUMNS = 48 };

/* The lengths of the last steps. */
typedef struct gn_active_pairs_past {
    int known;    /* number of the last steps, at most two, that followed each other */
    double dt[2]; /* s, length of the last step and the one before that */
} gn_active_pairs_past;

/* Validity of the last search. */
typedef struct gn_active_pairs_span {
    double ahead;   /* s, duration for which the search holds, see gn_near_args */
    double elapsed; /* s, time since the search */
    bool over;      /* some particle may have moved beyond its margin */
    int steps;      /* number of sweeps that used the active pairs */
} gn_active_pairs_span;

/* State that checkpoints store besides `act`, as doubles. Losses are summed in the order in which
 * pairs are packed, so that a resumed run must pack the same pairs. */
typedef struct gn_active_pairs_kept {
    double known, dt[2];                 /* gn_active_pairs_past */
    double ahead, elapsed, over, worked; /* gn_active_pairs_span */
    double steps, towards, cost, fresh,
        packed; /* members of gn_active_pairs; cost -1: not measured yet */
} gn_active_pairs_kept;

typedef struct gn_active_pairs {
    bool on;        /* active for the present lists */
    bool disabled;  /* forced off, for reference comparisons */
    bool fresh;     /* no sweep has used these lists yet */
    bool packed;    /* the columns of active pairs are packed */
    bool unsettled; /* columns of the list that the kernel writes are outdated */
    bool whole;     /* all pairs are processed in this sweep */
    bool look;      /* the active pairs are searched in this sweep */
    bool move;  /* columns of pairs that stay packed move to their new positions in this sweep */
    bool again; /* the next sweep packs the pairs of `act` from the list */
    bool take;  /* this sweep packs the pairs of `act` */
    gn_active_pairs_past past;
    gn_active_pairs_span span;
    int steps, towards;  /* number of steps for which a search should hold; 1 or -1: it is being
                            increased or decreased */
    double listed, cost; /* number of pairs; cost of the last span, in pairs processed per step */
    gn_active_pairs_kept kept; /* state read from a checkpoint, kept until lists exist */
    uint8_t *kept_act;         /* [kept_groups], NULL: none */
    size_t kept_groups;
    gn_near_path *kept_paths; /* [kept_path_count] */
    size_t kept_path_count;

    gn_near_path *paths; /* [path_count + 1] by block of particles; the last one, of the null
                            particles, is zero */
    size_t path_count;

    size_t blocks,
        stride;     /* number of blocks of pairs; distance between two blocks in the arrays below */
    size_t room;    /* pairs, with padding */
    size_t streams; /* number of allocated columns of `data` */
    int32_t *i, *j; /* [room] */
    uint16_t *place; /* [room][2] rows of the pairs' ends in the partial sums, see gn_partials */
    double *data;    /* [streams][room] */
    uint8_t *act;    /* [room/GN_NEAR_GROUP] bits that mark the active pairs of a block */
    int32_t *count;  /* [blocks] number of active pairs */

    gn_uniform uniform; /* uniform columns for which `column` was made */
    gn_active_pairs_column column[GN_ACTIVE_PAIRS_COLUMNS];
    int columns;
} gn_active_pairs;

/* Decides whether it pays to search for active pairs. The decision uses the positions at which the
 * lists were made, so that a resumed run decides alike. Called whenever lists were made or read. */
gneiss_status gn_active_pairs_choose(const gn_step_context *ctx, gn_dem *dem,
                                     const gn_periodic_box *box, gneiss_error *error);
void gn_active_pairs_free(gn_active_pairs *near);
size_t gn_active_pairs_bytes(const gn_dem *dem);

/* Writes packed columns back into the list of pairs, which is then as without packing; required
 * before columns that kernels write are read there. The state does not change, so that the
 * function also takes a constant world. */
void gn_active_pairs_settle(const gn_step_context *ctx, const gn_dem *dem);
/* Returns a view of the pairs of a block at the end of a step, whose columns may be changed: the
 * packed pairs, if the block is packed, else all. Only i, j, the count, and columns that kernels
 * write are valid. */
gn_contacts gn_active_pairs_block(const gn_dem *dem, size_t block);
/* To be called when something other than the step changes data: gn_active_pairs_repack if columns
 * of pairs change, gn_active_pairs_forget if velocities or positions do. */
void gn_active_pairs_repack(const gn_step_context *ctx, gn_dem *dem);
void gn_active_pairs_forget(const gn_step_context *ctx, gn_dem *dem);
/* Prepares a checkpoint, which also stores `paths`: settles the list and returns the state; the run
 * then continues exactly as one that reads the checkpoint. `groups`: number of groups of `act`, 0
 * if nothing is packed. */
gn_active_pairs_kept gn_active_pairs_keep(const gn_step_context *ctx, gn_dem *dem, size_t *groups);
/* Restores the state `kept` after lists were read. GNEISS_ERROR_INPUT: it marks pairs that do not
 * exist. */
gneiss_status gn_active_pairs_resume(gn_dem *dem, gneiss_error *error);

/* gn_active_pairs_begin begins a sweep; gn_active_pairs_work processes a block of pairs in place of
 * the kernel; gn_active_pairs_moved tracks the motion at the end of the sweep. */
void gn_active_pairs_begin(const gn_step_context *ctx, gn_dem *dem, const gn_contact_args *pairs);
void gn_active_pairs_work(const gn_step_context *ctx, gn_dem *dem, const gn_contact_args *pairs,
                          size_t block, gn_contact_sums *sums);
void gn_active_pairs_moved(const gn_step_context *ctx, gn_dem *dem);

#endif
