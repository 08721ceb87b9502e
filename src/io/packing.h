/* Packings as text in the format that YADE reads: `x y z r` per line (2D: `x y r`), and comments
 * that begin with #. */
#ifndef GN_IO_PACKING_H
#define GN_IO_PACKING_H

#include "base/error.h"

#include <stddef.h>

typedef struct gn_packing {
    size_t count;
    double *sphere; /* [count][4]: x y z r in m (2D: z = 0); gn_alloc'ed */
} gn_packing;

/* Reads a packing. `dimension` 2 reads x y r (or x y z r with the same z in every line), 3 reads x
 * y z r, separated by blanks, tabs or commas; all numbers are multiplied by `scale`.
 * GNEISS_ERROR_INPUT, with file:line:column: NaN, infinity, radius <= 0, a wrong number of columns,
 * no particles, something that is not a number; also a missing file. */
gneiss_status gn_packing_read(const char *path, int dimension, double scale, gn_packing *packing,
                              gneiss_error *error);
/* Writes the format of gn_packing_read: a # line with `header`, then numbers with 17 significant
 * digits, which are read as the same doubles. The file is written completely or not at all. */
gneiss_status gn_packing_write(const char *path, int dimension, const gn_packing *packing,
                               const char *header, gneiss_error *error);
void gn_packing_free(gn_packing *packing);

#endif
