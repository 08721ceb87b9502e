/* The state of the reader of packings. */
#ifndef GN_IO_PACKING_PRIVATE_H
#define GN_IO_PACKING_PRIVATE_H

#include "io/packing.h"

#include <stdbool.h>
#include <stdio.h>

enum { GN_PACKING_LINE = 65536, GN_PACKING_COLUMNS = 64 };

/* A column that the header names; `kind` is its index in the table of names, -1: the column is
 * skipped. */
typedef struct gn_packing_column {
    int kind;
    double factor; /* from the unit of the file to SI */
} gn_packing_column;

/* The id of a row, for sorting. */
typedef struct gn_packing_id {
    int64_t id;
    size_t row, line, at;
} gn_packing_id;

typedef struct gn_packing_reader {
    FILE *file;
    const char *path;
    gneiss_error *error;
    int dimension;
    double scale;
    const gn_packing_words *words; /* NULL: a header is not read */
    size_t line;                   /* base 1 */
    size_t columns;                /* number of columns of the first particle, 0: none yet */
    double plane;                  /* 2D with z: z of the first particle */
    size_t capacity;
    gn_packing_column column[GN_PACKING_COLUMNS]; /* [named] */
    size_t named;                                 /* columns of the header, 0: no header */
    bool states_units;
    gn_packing_id *id; /* [capacity]; NULL: no column of ids */
    size_t length;
    char text[GN_PACKING_LINE + 1];
} gn_packing_reader;

/* A field of a line. */
typedef struct gn_packing_field {
    size_t at, length; /* base 0 */
} gn_packing_field;

/* Reports GNEISS_ERROR_INPUT with path:line:column; `at` is the position in the line, base 0. */
__attribute__((format(printf, 3, 4))) gneiss_status
gn_packing_refuse(const gn_packing_reader *in, size_t at, const char *format, ...);
bool gn_packing_is_blank(char c);
/* Writes up to 40 printable characters of the text. */
const char *gn_packing_shown(const char *text, size_t length, char out[48]);
/* Reads a finite decimal number. */
gneiss_status gn_packing_number(const gn_packing_reader *in, gn_packing_field field, double *value);
/* Splits a line into at most `most` fields, which are separated by blanks or by one comma with
 * blanks around it. If the line has more, *count is most + 1, and the last field is the rest of the
 * line. */
gneiss_status gn_packing_split(const gn_packing_reader *in, gn_packing_field *field, size_t most,
                               size_t *count);

/* Refuses a regular file that begins as a file of another program. */
gneiss_status gn_packing_refuse_foreign(const gn_packing_reader *in);
/* Reads the header from a comment (with its #) or from a row; does nothing if it is no header. */
gneiss_status gn_packing_comment_header(gn_packing_reader *in);
gneiss_status gn_packing_row_header(gn_packing_reader *in, bool *is_header);
/* Reads a row whose columns are those of the header. */
gneiss_status gn_packing_named_row(gn_packing_reader *in, gn_packing *packing);
/* Sorts the rows by id. */
gneiss_status gn_packing_sort(gn_packing_reader *in, gn_packing *packing);
/* Makes room for one more particle, also in the columns that the header names. */
gneiss_status gn_packing_grow(gn_packing_reader *in, gn_packing *packing);

#endif
