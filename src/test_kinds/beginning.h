/* The row of a history at which the test begins. */
#ifndef GN_TEST_KINDS_BEGINNING_H
#define GN_TEST_KINDS_BEGINNING_H

#include <stdbool.h>
#include <stddef.h>

/* Stress at the ends before they move, as from particles that protrude into them, is no strength of
 * the specimen. The test therefore begins with the last row before its strain grows; and if stress
 * decreases from there, with the row of the least stress once it has risen again: by a twentieth of
 * the first row's, or above it. A specimen that is already loaded, and is loaded further, begins
 * with all of its load. */
typedef struct gn_beginning {
    size_t rows;  /* rows examined */
    size_t first; /* the last such row before the strain grew */
    /* the row of the least stress since: the test begins here if the stress rises again */
    size_t least;
    bool moved; /* the strain has grown */
    bool begun;
} gn_beginning;

/* Continues with rows from `beginning->rows` to before `rows`; zeroed: from the first. strain 1
 * (NULL or NaN: unknown), stress Pa, both positive in the sense of the test. */
void gn_beginning_update(gn_beginning *beginning, const double *strain, const double *stress,
                         size_t rows);

#endif
