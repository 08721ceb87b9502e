/* The row of a history at which the test begins. */
#ifndef GN_TEST_KINDS_BEGINNING_H
#define GN_TEST_KINDS_BEGINNING_H

#include <stdbool.h>
#include <stddef.h>

/* The beginning of the test. Stress at the ends before they move, as from particles that protrude
 * into them, is no strength of the specimen. The test therefore begins with the last row before its
 * strain grows. If the stress decreases from there, the test begins with the row of the least
 * stress, once the stress has risen again by a twentieth of the first row's, or above it. A
 * specimen that is already loaded, and is loaded further, begins with all of its load. */
typedef struct gn_beginning {
    size_t rows;  /* number of rows examined */
    size_t first; /* the last such row before the strain grew */
    /* the row of the least stress since then, where the test begins if the stress rises again */
    size_t least;
    bool moved; /* the strain has grown */
    bool begun;
} gn_beginning;

/* Continues with the rows from `beginning->rows` to before `rows`; if zeroed, begins with the first
 * row. strain (1; NULL or NaN: unknown) and stress (Pa) are positive in the sense of the test. */
void gn_beginning_update(gn_beginning *beginning, const double *strain, const double *stress,
                         size_t rows);

#endif
