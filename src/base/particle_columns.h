/* Properties of particles that a file states beside their places and radii. */
#ifndef GN_BASE_PARTICLE_COLUMNS_H
#define GN_BASE_PARTICLE_COLUMNS_H

#include "base/memory.h"

#include <stdbool.h>
#include <stdint.h>

/* Arrays of one entry for each particle, gn_alloc'ed; NULL: the file has no such column. */
typedef struct gn_particle_columns {
    int32_t *material; /* number in the list of materials, base 0 */
    int32_t *group;
    double *density;   /* kg/m3, of the particle itself */
    double *motion;    /* [count][6] m/s, rad/s */
    bool states_units; /* the header states units */
    bool renumbered;   /* the file states ids other than 0, 1, 2, ... */
} gn_particle_columns;

/* Frees the arrays; what the header states is kept. */
static inline void gn_particle_columns_free(gn_particle_columns *columns) {
    gn_free(columns->material);
    gn_free(columns->group);
    gn_free(columns->density);
    gn_free(columns->motion);
    columns->material = columns->group = NULL;
    columns->density = columns->motion = NULL;
}

#endif
