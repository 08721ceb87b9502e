/* Which pairs of a block a contact kernel has to work on, and their columns
 * (particles/active_pairs.h). */
#ifndef GN_KERNELS_NEAR_H
#define GN_KERNELS_NEAR_H

#include "base/instruction_sets.h"
#include "kernels/partials.h"

#include <stdbool.h>

/* What the functions below look at at once; a byte has its bits. */
enum { GN_NEAR_GROUP = 8 };

/* Of the particles of a block of them: the fiercest collision of all is far from most. */
typedef struct gn_near_path {
    double margin; /* m, by which one may come to be elsewhere than its velocity tells */
    double last;   /* m/s, at most, by which a velocity changed in the last step, */
    double change; /* and since who acts was found */
    double way;    /* m, that one went besides for that, at most */
} gn_near_path;

typedef struct gn_near_args {
    const double *pos, *vel; /* [particles][4] x y z, radius; velocity */
    const double *soon;      /* rows of four that are read next; NULL: none */
    const int32_t *i, *j;    /* [count] and padding of GN_LANES_MAX */
    const int32_t *particle; /* [particles] of the block, as in gn_partials */
    size_t count, particles;
    double wider; /* sums of radii are taken so many times as long: no contact is missed */
    const gn_near_path *paths; /* [blocks of particles, and one with zeros] */
    double ahead, behind;      /* s, for which these are asked */
    bool periodic;
    double period[3], inverse_period[3]; /* m, 1/m */
} gn_near_args;

typedef struct gn_near_kernels {
    /* Those that touch, or may have done `behind` or less before, or may do within `ahead`, as bits
     * into `act`; how many. */
    size_t (*find)(const gn_near_args *args, uint8_t *act);
    /* Doubles, or numbers of 32 bits, of those in `act` from so many groups, one behind the other;
     * doubles back to where they were, with zeros between them; doubles of those in `was`, packed
     * elsewhere, as those in `act`, with zeros for who was not there. Behind both ends is room for
     * a group more. */
    void (*pack)(double *to, const double *from, const uint8_t *act, size_t groups);
    void (*pack32)(void *to, const void *from, const uint8_t *act, size_t groups);
    void (*unpack)(double *to, const double *from, const uint8_t *act, size_t groups);
    void (*repack)(double *to, const double *from, const uint8_t *was, const uint8_t *act,
                   size_t groups);
} gn_near_kernels;

#define X(set, lanes, has) extern const gn_near_kernels gn_near_table_##set;
GN_INSTRUCTION_SETS(X)
#undef X

#endif
