/* Search for near pairs of particles in a hierarchy of cell grids by size. */
#ifndef GN_NEIGH_NEIGH_H
#define GN_NEIGH_NEIGH_H

#include "base/error.h"
#include "kernels/partials.h"
#include "soa/records.h"

/* A query for all pairs with |x_j - x_i| - r_i - r_j <= margin + range (r_i + r_j). */
typedef struct gn_pair_query {
    const gn_particles *particles; /* removed particles (inverse mass 0) are left out */
    int dimension;
    double margin; /* m, >= 0 */
    double range;  /* >= 0 */
    bool periodic;
    double period[3]; /* m; 0: not periodic along this axis */
    int threads;
} gn_pair_query;

/* Pairs (i, j) with i < j, sorted by i, then j. */
typedef struct gn_pair_list {
    size_t count;
    int32_t (*pair)[2]; /* [count]; gn_alloc'ed */
} gn_pair_list;

/* Finds all pairs of a query. Particles of similar size (within a factor of two) share a grid whose
 * cells are as wide as their largest interaction. Each particle searches its own grid and the
 * coarser ones (Ogarko & Luding 2012), so that the work is linear for any size ratio. The list is
 * the same for any number of threads. GNEISS_ERROR_INPUT if a periodic box is narrower than twice
 * the largest interaction. */
gneiss_status gn_pairs_find(const gn_pair_query *query, gn_pair_list *list, gneiss_error *error);
void gn_pair_list_free(gn_pair_list *list);

/* Sorts particles along a Morton (Z) curve over their bounding box: order[k] is the present place
 * of the k-th particle. Ties are ordered by id. `order` [count]. */
gneiss_status gn_morton_order(const gn_particles *particles, int dimension, int32_t *order,
                              gneiss_error *error);

/* Numbers the rows of a list's partial force sums by block, and lists the rows of each particle.
 * Replaces the content of *partials. */
gneiss_status gn_partials_build(const gn_contacts *contacts, size_t particle_count, int threads,
                                gn_partials *partials, gneiss_error *error);
gneiss_status gn_element_partials_build(const gn_elements *elements, size_t node_count, int threads,
                                        gn_partials *partials, gneiss_error *error);
void gn_partials_free(gn_partials *partials);

/* Returns the memory of partial sums of `items` items with `members` particles each. */
size_t gn_partials_bytes(const gn_partials *partials, size_t items, int members);

#endif
