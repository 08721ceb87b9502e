/* One line of progress: rewritten in place and never wider than the terminal, or whole, a line a
 * call, where there is none. */
#ifndef GN_CLI_LINE_H
#define GN_CLI_LINE_H

#include <stdbool.h>
#include <stddef.h>

enum { GN_LINE_FIELDS = 12, GN_LINE_TEXT = 96 };

typedef struct gn_line_field {
    int rank; /* what is less important has a higher one; 0 is never left out */
    char text[GN_LINE_TEXT], brief[GN_LINE_TEXT]; /* brief "": there is no shorter way to say it */
    bool shortened, dropped;
} gn_line_field;

/* Zeroed to begin with. */
typedef struct gn_line {
    size_t count;
    gn_line_field field[GN_LINE_FIELDS];
} gn_line;

/* Adds a field; the pointer is good for gn_line_brief. */
gn_line_field *gn_line_add(gn_line *line, int rank, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void gn_line_brief(gn_line_field *field, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Leaves out what does not fit into so many characters, first the longer words, then fields, the
 * least important first; 0: everything fits. The text goes to `out`. */
void gn_line_fit(gn_line *line, size_t width, char *out, size_t size);

/* To standard error. `last`: the cursor goes on to the next line. */
void gn_line_show(gn_line *line, bool last);

#endif
