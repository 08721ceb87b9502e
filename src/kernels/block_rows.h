/* The rows of a block of contacts or elements: the rows of the particles that it reads, and the
 * rows in which it sums up forces (see partials.h). */
#ifndef GN_KERNELS_BLOCK_ROWS_H
#define GN_KERNELS_BLOCK_ROWS_H

#include "kernels/partials.h"
#include "kernels/simd.h"
#include "soa/field.h"

#include <string.h>

/* Clears and returns the rows of the block that begins with item `begin`. `row`: rows of all
 * blocks, of `bytes` bytes each. */
static inline void *gn_clear_block_rows(const gn_partials *partials, size_t begin, size_t bytes,
                                        void *row) {
    size_t block = begin / partials->length, first = (size_t)partials->first[block];
    size_t rows = (size_t)partials->first[block + 1] - first;
    return memset((char *)row + bytes * first, 0, bytes * rows);
}

/* The particles of a block that have not been prefetched yet. */
typedef struct gn_block_particles {
    const int32_t *next, *end;
} gn_block_particles;

/* Returns the particles of the block that begins with item `begin`; none without partial sums. */
static inline gn_block_particles gn_block_particles_of(const gn_partials *partials, size_t begin) {
    if (!partials) return (gn_block_particles){NULL, NULL};
    const int32_t *first = partials->first + begin / partials->length;
    return (gn_block_particles){partials->particle + first[0], partials->particle + first[1]};
}

/* Prefetches the next particles into the caches, from `kinds` arrays of rows of four. Particles are
 * scattered in memory, and a core cannot hide the latency of reading them. They are requested once
 * per block (not per contact), in the order of their first use and ahead of it: vectors mostly
 * refer to fewer new particles than are prefetched for each. The prefetch may exceed the end by
 * less than GN_LANES_MAX. */
GN_INLINE void gn_fetch_ahead(gn_block_particles *ahead, const gn_real *const *rows, int kinds,
                              int few) {
    if (ahead->next >= ahead->end) return;
    for (int k = 0; k < few; k++)
        for (int r = 0; r < kinds; r++) __builtin_prefetch(rows[r] + 4 * (int64_t)ahead->next[k]);
    ahead->next += few;
}

/* Returns how many particles have to be prefetched per vector, so that all are requested before the
 * last vector. */
GN_INLINE int gn_fetch_rate(const gn_block_particles *ahead, size_t vectors) {
    enum { LEAST = (GN_W + 1) / 2 };
    const size_t rate = (size_t)(ahead->end - ahead->next) / (vectors + 1) + 1;
    return rate < LEAST ? LEAST : rate > GN_LANES_MAX ? GN_LANES_MAX : (int)rate;
}

#endif
