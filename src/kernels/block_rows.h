/* The rows in which a block sums what its contacts or elements exert (see partials.h). */
#ifndef GN_KERNELS_BLOCK_ROWS_H
#define GN_KERNELS_BLOCK_ROWS_H

#include "kernels/partials.h"

#include <string.h>

/* Those of the block that begins with item `begin`, zeroed. `row`: rows of all blocks, of `width`.
 */
static inline double *gn_clear_block_rows(const gn_partials *q, size_t begin, size_t width,
                                          double *row) {
    size_t block = begin / q->length, first = (size_t)q->first[block];
    size_t rows = (size_t)q->first[block + 1] - first;
    return memset(row + width * first, 0, width * rows * sizeof *row);
}

#endif
