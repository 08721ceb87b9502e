/* Packings as text in the format that YADE reads: `x y z r` per line (2D: `x y r`), and comments
 * that begin with #; or with columns in any order, which a header names. */
#ifndef GN_IO_PACKING_H
#define GN_IO_PACKING_H

#include "base/error.h"
#include "base/particle_columns.h"

#include <stddef.h>

typedef struct gn_packing {
    size_t count;
    double *sphere; /* [count][4]: x y z r in m (2D: z = 0); gn_alloc'ed */
    gn_particle_columns columns;
} gn_packing;

/* Functions that interpret units and materials in a file. */
typedef struct gn_packing_words {
    void *units; /* first argument of `unit` */
    /* Reads "1 mm" as 0.001 if `wanted` is "m"; false: `reason` states why (gn_units_read). */
    bool (*unit)(void *units, const char *text, const char *wanted, double *value, char *reason,
                 size_t reason_size);
    const void *materials;                                    /* first argument of `material` */
    int (*material)(const void *materials, const char *name); /* number, base 0; -1: unknown */
    size_t material_count;
} gn_packing_words;

/* Reads a packing. `dimension` 2 reads x y r (or x y z r with the same z in every line), 3 reads x
 * y z r, separated by blanks, tabs or commas; all numbers are multiplied by `scale`.
 * GNEISS_ERROR_INPUT, with file:line:column: NaN, infinity, radius <= 0, a wrong number of columns,
 * no particles, something that is not a number; also a missing file. */
gneiss_status gn_packing_read(const char *path, int dimension, double scale, gn_packing *packing,
                              gneiss_error *error);
/* Reads a packing as gn_packing_read does, but a header may name the columns (docs/files.md): a
 * first row of names, a comment that consists of names, or `#format` of YADE. Rows are sorted by id
 * if there is a column of ids. Unknown names, units and materials, an id that occurs twice, and
 * files of other programs, which are recognised by their beginning, are input errors as well.
 * `words` is needed for units and materials. */
gneiss_status gn_packing_read_columns(const char *path, int dimension, double scale,
                                      const gn_packing_words *words, gn_packing *packing,
                                      gneiss_error *error);
/* Writes the format of gn_packing_read: a # line with `header`, then numbers with 17 significant
 * digits, so that exactly the same doubles are read again. Either the whole file is written or
 * none. */
gneiss_status gn_packing_write(const char *path, int dimension, const gn_packing *packing,
                               const char *header, gneiss_error *error);
void gn_packing_free(gn_packing *packing);

#endif
