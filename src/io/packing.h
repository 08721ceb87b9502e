/* Packings as text: `x y z r` per line (2D: `x y r`), # comments, the format that YADE reads. */
#ifndef GN_IO_PACKING_H
#define GN_IO_PACKING_H

#include "base/error.h"

#include <stddef.h>

typedef struct gn_packing {
    size_t count;
    double *sphere; /* [count][4]: x y z r in m (2D: z = 0); gn_alloc'ed */
} gn_packing;

/* Reads a packing. `dimension` 2 reads x y r (or x y z r with every z equal), 3 reads x y z r;
 * separated by blanks, tabs or commas. Refused with file:line:column: NaN, infinity, radius <= 0,
 * wrong number of columns, no particles, not a number; all GNEISS_ERROR_INPUT, as is a missing
 * file. `scale` multiplies everything. */
gneiss_status gn_packing_read(const char *path, int dimension, double scale, gn_packing *packing,
                              gneiss_error *error);
/* Writes the format of gn_packing_read: a # line with `header`, then numbers with 17 significant
 * digits, so that reading gives the same doubles. The file is written completely or not at all. */
gneiss_status gn_packing_write(const char *path, int dimension, const gn_packing *packing,
                               const char *header, gneiss_error *error);
void gn_packing_free(gn_packing *packing);

#endif
