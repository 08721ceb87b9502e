/* Packings as text: `x y z r` per line (2D: `x y r`), # comments, the format that YADE reads; or
 * columns in any order that a header names. */
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

/* Meaning of units and materials in a file. */
typedef struct gn_packing_words {
    void *units; /* first argument of `unit` */
    /* Reads "1 mm" as 0.001 if `wanted` is "m"; false: `reason` states why (gn_units_read). */
    bool (*unit)(void *units, const char *text, const char *wanted, double *value, char *reason,
                 size_t reason_size);
    const void *materials;                                    /* first argument of `material` */
    int (*material)(const void *materials, const char *name); /* number, base 0; -1: unknown */
    size_t material_count;
} gn_packing_words;

/* Reads a packing. `dimension` 2 reads x y r (or x y z r with every z equal), 3 reads x y z r;
 * separated by blanks, tabs or commas. Refused with file:line:column: NaN, infinity, radius <= 0,
 * wrong number of columns, no particles, not a number; all GNEISS_ERROR_INPUT, as is a missing
 * file. `scale` multiplies everything. */
gneiss_status gn_packing_read(const char *path, int dimension, double scale, gn_packing *packing,
                              gneiss_error *error);
/* As gn_packing_read; a header may name columns (docs/files.md): a first row of names, a comment of
 * names alone, or `#format` of YADE. Rows are sorted by id if there is such a column. Refused as
 * well: unknown names, units and materials, an id that occurs twice, files of other programs, which
 * are recognised by their beginning. `words` is needed for units and materials. */
gneiss_status gn_packing_read_columns(const char *path, int dimension, double scale,
                                      const gn_packing_words *words, gn_packing *packing,
                                      gneiss_error *error);
/* Writes the format of gn_packing_read: a # line with `header`, then numbers with 17 significant
 * digits, so that reading gives the same doubles. The file is written completely or not at all. */
gneiss_status gn_packing_write(const char *path, int dimension, const gn_packing *packing,
                               const char *header, gneiss_error *error);
void gn_packing_free(gn_packing *packing);

#endif
