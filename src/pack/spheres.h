/* Spheres x y z r as a particle record. */
#ifndef GN_PACK_SPHERES_H
#define GN_PACK_SPHERES_H

#include "soa/records.h"

/* Makes a record from `row` [count][4], copied, with id k for row k and mass 1 kg (the neighbour
 * search ignores particles without mass). The caller destroys the record; on failure there is
 * nothing to destroy. */
gneiss_status gn_particles_of_spheres(const double *row, size_t count, gn_particles *particles,
                                      gneiss_error *error);

#endif
