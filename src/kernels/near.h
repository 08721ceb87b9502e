/* Selection of the pairs of a block on which a contact kernel has to work, and packing of their
 * columns (particles/active_pairs.h). */
#ifndef GN_KERNELS_NEAR_H
#define GN_KERNELS_NEAR_H

#include "base/instruction_sets.h"
#include "kernels/partials.h"

#include <stdbool.h>

/* Number of pairs that the functions below process at once; a byte has their bits. */
enum { GN_NEAR_GROUP = 8 };

/* Bounds of the motion of a block of particles. They are per block, because most particles are far
 * from the most violent collision. */
typedef struct gn_near_path {
    double margin; /* m, largest deviation from the position predicted by the velocity */
    double last;   /* m/s, largest change of a velocity in the last step */
    double change; /* m/s, largest change of a velocity since the active pairs were found */
    double drift;  /* m, largest displacement by these changes */
} gn_near_path;

typedef struct gn_near_args {
    const double *pos, *vel;  /* [particles][4] x y z, radius; velocity */
    const double *prefetched; /* rows of four that are read next; NULL: none */
    const int32_t *i, *j;     /* [count] and padding of GN_LANES_MAX */
    const int32_t *particle;  /* [particles] of the block, as in gn_partials */
    size_t count, particles;
    double widening;           /* factor on sums of radii, so that no contact is missed */
    const gn_near_path *paths; /* [blocks of particles + 1], the last one zero */
    double ahead,
        behind; /* s, intervals after and before the instant for which pairs are selected */
    bool periodic;
    double period[3], inverse_period[3]; /* m, 1/m */
} gn_near_args;

typedef struct gn_near_kernels {
    /* Finds pairs that touch, may touch within the interval `ahead`, or may have touched within the
     * interval `behind`, and marks them as bits in `act`; returns their number. */
    size_t (*find)(const gn_near_args *args, uint8_t *act);
    /* `pack` copies doubles (or 32-bit numbers) of the items marked in `act` from `groups` groups
     * to a contiguous array; `unpack` copies doubles back to their places, with zeros between them;
     * `repack` converts an array of the items in `was` to one of the items in `act`, with zeros for
     * new items. Both arrays need room for one more group at the end. */
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
