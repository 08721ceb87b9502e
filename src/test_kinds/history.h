/* A growing table of doubles with named columns: the record of a run. */
#ifndef GN_TEST_KINDS_HISTORY_H
#define GN_TEST_KINDS_HISTORY_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

enum { GN_COLUMN_NAME_SIZE = 96 };

typedef struct gn_column {
    char name[GN_COLUMN_NAME_SIZE]; /* "stress", "wall_top_force_z" */
    char unit[24];
    char text[160];
    bool absent;   /* the scene has no such quantity: NaN in every row */
    double *value; /* [rows] */
} gn_column;

typedef struct gn_history {
    size_t column_count, row_count, row_capacity;
    gn_column *columns; /* [column_count] */
} gn_history;

/* Adds a column; allowed only while the table has no rows. */
gneiss_status gn_history_add_column(gn_history *history, const char *name, const char *unit,
                                    const char *text, gneiss_error *error);

/* Appends a row of `column_count` values. */
gneiss_status gn_history_append(gn_history *history, const double *row, gneiss_error *error);

/* Removes those rows from `begin` on for which `keep` (indexed by row) is false. */
void gn_history_keep(gn_history *history, size_t begin, const bool *keep);

/* Returns the values of a column by name, NULL if there is none. Valid until the next append. */
const double *gn_history_column(const gn_history *history, const char *name);

void gn_history_free(gn_history *history);

#endif
