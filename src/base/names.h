/* Suggestions for unknown names: the nearest known name, or all of them. */
#ifndef GN_BASE_NAMES_H
#define GN_BASE_NAMES_H

#include <stddef.h>

typedef struct gn_names {
    const char *wanted, *nearest; /* nearest: NULL if no name is similar enough; borrowed */
    size_t least;                 /* the distance of `nearest` */
    char known[400];              /* all known names, separated by commas */
} gn_names;

/* Begins a search; `wanted` must outlive the returned object. */
gn_names gn_names_for(const char *wanted);
void gn_names_add(gn_names *names, const char *name);

enum { GN_ADVICE_SIZE = 480 };

/* Writes "; did you mean 'top'?", or "; there are top, bottom", or "; there is none" and returns
 * `text`. */
const char *gn_names_advice(const gn_names *names, char *text, size_t size);

#endif
