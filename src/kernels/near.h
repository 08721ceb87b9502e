/* Which pairs of a block a contact kernel has to work on, and their columns (sim/near.h). */
#ifndef GN_KERNELS_NEAR_H
#define GN_KERNELS_NEAR_H

#include "base/instruction_sets.h"
#include "kernels/partials.h"

#include <stdbool.h>

/* What the functions below look at at once; a byte has its bits. */
enum { GN_NEAR_GROUP = 8 };

typedef struct gn_near_args {
    const double *pos;       /* [particles][4] x y z, radius */
    const double *soon[3];   /* rows of four that are read next; NULL: no more of them */
    const int32_t *i, *j;    /* [count] and padding of GN_LANES_MAX */
    const int32_t *particle; /* [particles] of the block, as in gn_partials */
    size_t count, particles;
    double wider; /* sums of radii are taken so many times as long: no contact is missed */
    bool periodic;
    double period[3], inverse_period[3]; /* m, 1/m */
} gn_near_args;

typedef struct gn_near_kernels {
    /* Those that touch, or touched one or two times ago, as bits into `act`; how many. `touched`:
     * bits as they were left, of the last time and the one before that, group by group. */
    size_t (*find)(const gn_near_args *args, uint8_t *touched, uint8_t *act);
    /* Doubles, or numbers of 32 bits, of those in `act` from so many groups, one behind the other;
     * doubles back to where they were. Behind both ends is room for a group more. */
    void (*pack)(double *to, const double *from, const uint8_t *act, size_t groups);
    void (*pack32)(void *to, const void *from, const uint8_t *act, size_t groups);
    void (*unpack)(double *to, const double *from, const uint8_t *act, size_t groups);
} gn_near_kernels;

#define X(set, lanes, has) extern const gn_near_kernels gn_near_table_##set;
GN_INSTRUCTION_SETS(X)
#undef X

#endif
