/* Pairs that act. In grains that flow two of three listed pairs do not touch, and a kernel that
 * works on vectors cannot leave them out one by one. So the pairs of a block that touch are found
 * first, with those that did a step ago, which acted for a part of it, and those that did two steps
 * ago, of which that is to be forgotten; their columns are packed together, the kernel works on
 * these, in the order of the list, and what it wrote goes back. What is left out would have added
 * zeros: no bit of any sum is another. */
#ifndef GN_SIM_NEAR_H
#define GN_SIM_NEAR_H

#include "kernels/contact.h"
#include "kernels/near.h"

/* A column that is packed. */
typedef struct gn_near_column {
    size_t offset; /* of its pointer within gn_contacts */
    int components;
    bool written; /* by the kernel; of pairs that never touched it is zero */
} gn_near_column;

enum { GN_NEAR_COLUMNS = 48 };

/* Where a thread packs a block. */
typedef struct gn_near_room {
    gn_contacts pairs;
    uint8_t *act;    /* [groups] bits: which of the block */
    uint16_t *place; /* [][2] of their rows, see gn_partials */
} gn_near_room;

typedef struct gn_near {
    bool on;            /* for the present lists */
    bool barred;        /* never: for who compares */
    bool fresh;         /* no sweep yet over these lists */
    bool whole;         /* in this sweep: all pairs, for nothing is known of the last ones */
    uint8_t *touched;   /* [groups of pairs][2] bits: in the last two sweeps */
    gn_near_room *room; /* [threads] */
    int threads;
    gn_uniform uniform; /* that `column` was made for */
    gn_near_column column[GN_NEAR_COLUMNS];
    int columns;
} gn_near;

typedef struct gn_world gn_world;

/* Whenever lists were made or read: whether it is worth while, by the places when they were made,
 * so that a run that goes on decides as it did. */
gneiss_status gn_near_lists(gn_world *world, gneiss_error *error);
void gn_near_free(gn_near *near);
size_t gn_near_bytes(const gn_world *world);

/* Before a sweep; a block of pairs, in place of the kernel on all of it. */
void gn_near_begin(gn_world *world, const gn_contact_args *pairs);
void gn_near_work(gn_world *world, const gn_contact_args *pairs, size_t block,
                  gn_contact_sums *sums);

#endif
