/* One line of progress, rewritten in place and no wider than the terminal; without a terminal, one
 * full line per call. */
#ifndef GN_CLI_LINE_H
#define GN_CLI_LINE_H

#include <stdbool.h>
#include <stddef.h>

enum { GN_LINE_FIELDS = 12, GN_LINE_TEXT = 96 };

typedef struct gn_line_field {
    int rank; /* less important fields have a higher rank; rank 0 is never dropped */
    char text[GN_LINE_TEXT], brief[GN_LINE_TEXT]; /* brief "": there is no shorter form */
    bool shortened, dropped;
} gn_line_field;

/* Zeroed initially. */
typedef struct gn_line {
    size_t count;
    gn_line_field field[GN_LINE_FIELDS];
} gn_line;

/* Adds a field; the pointer is valid for gn_line_brief. */
gn_line_field *gn_line_add(gn_line *line, int rank, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void gn_line_brief(gn_line_field *field, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Writes at most `width` characters of the line to `out`: first long texts are replaced by brief
 * ones, then fields are dropped, the least important first; `width` 0: no limit. */
void gn_line_fit(gn_line *line, size_t width, char *out, size_t size);

/* Writes the line to standard error. `last`: the cursor moves to the next line. */
void gn_line_show(gn_line *line, bool last);

#endif
