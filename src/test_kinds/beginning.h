/* Where the test begins in a history. */
#ifndef GN_TEST_KINDS_BEGINNING_H
#define GN_TEST_KINDS_BEGINNING_H

#include <stdbool.h>
#include <stddef.h>

/* What ends bear before they move, as of particles that stick out into them, is no strength of the
 * specimen. So the test begins with the last row before its strain grows; and where stress falls
 * from there, at its least once it has risen again: by a twentieth of what that row has, or above
 * it. A specimen that is under load already, and is loaded further, begins with all of its load. */
typedef struct gn_beginning {
    size_t rows;  /* looked at */
    size_t first; /* the last of them before the strain grew */
    size_t least; /* of the least stress since: the test begins here, once it has */
    bool moved;   /* the strain has grown */
    bool begun;
} gn_beginning;

/* Goes on with rows from `beginning->rows` to before `rows`; zeroed: from the first. strain 1
 * (NULL or NaN: nothing is known of it), stress Pa, both positive in the sense of the test. */
void gn_beginning_look(gn_beginning *beginning, const double *strain, const double *stress,
                       size_t rows);

#endif
