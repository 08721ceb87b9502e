/* How particles lie on the surfaces of the world: what `gneiss check` says of bodies. */
#ifndef GN_SIM_OVERLAP_H
#define GN_SIM_OVERLAP_H

#include "sim/world.h"

typedef struct gn_overlap {
    size_t touching; /* particles */
    double deepest;  /* m */
    size_t inside;   /* particles with their centre inside; 0 of a surface that is open */
} gn_overlap;

/* Of every surface, at the present positions, into overlap[world->boundary.surface_count]. */
gneiss_status gn_world_overlaps(const gn_world *world, gn_overlap *overlap, gneiss_error *error);

#endif
