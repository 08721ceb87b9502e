/* Spheres inside a body, for clumps. */
#ifndef GN_PACK_INSCRIBE_H
#define GN_PACK_INSCRIBE_H

#include "pack/domain.h"

/* Finds up to `count` spheres sphere[count][4] (x y z r, m) inside a body, one after the other:
 * each touches the boundary and is the largest whose centre no earlier one contains, among the
 * points of a grid of 32 cells along the longest side, from which the centre then moves to a local
 * maximum of the depth. *found: number of spheres, which is smaller than `count` when the grid is
 * covered. */
gneiss_status gn_domain_inscribe(const gn_domain *domain, size_t count, double *sphere,
                                 size_t *found, gneiss_error *error);

#endif
