/* What was probably meant by a name that nothing has. */
#ifndef GN_BASE_NAMES_H
#define GN_BASE_NAMES_H

#include <stddef.h>

typedef struct gn_names {
    const char *wanted, *nearest; /* nearest: NULL when none is near enough; borrowed */
    size_t least;                 /* its distance */
    char known[400];              /* all of them, comma separated */
} gn_names;

/* `wanted` must outlive what is returned. */
gn_names gn_names_for(const char *wanted);
void gn_names_add(gn_names *names, const char *name);

enum { GN_ADVICE_SIZE = 480 };

/* "; did you mean 'top'?", or "; there are top, bottom", or "; there is none". */
const char *gn_names_advice(const gn_names *names, char *text, size_t size);

/* Optimal string alignment distance of two names (Levenshtein with swaps of neighbours). */
size_t gn_edit_distance(const char *a, const char *b);

#endif
