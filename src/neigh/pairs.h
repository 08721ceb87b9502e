/* Finding pairs of particles that are near each other: a hierarchy of cell grids by size. */
#ifndef GN_NEIGH_PAIRS_H
#define GN_NEIGH_PAIRS_H

#include "base/error.h"
#include "kernels/partials.h"
#include "soa/records.h"

/* Which pairs are wanted: |x_j - x_i| - r_i - r_j <= margin + range (r_i + r_j). */
typedef struct gn_pair_query {
    const gn_particles *particles; /* removed ones (inverse mass 0) are left out */
    int dimension;
    double margin; /* m, >= 0 */
    double range;  /* >= 0 */
    bool periodic;
    double period[3]; /* m; 0: along this axis it has no sides */
    int threads;
} gn_pair_query;

/* Sorted by (i, j), i < j. */
typedef struct gn_pair_list {
    size_t count;
    int32_t (*pair)[2]; /* [count]; gn_alloc'ed */
} gn_pair_list;

/* Particles of like size (within a factor of two) share a grid whose cells are as wide as their
 * largest interaction, and each particle looks into its own grid and the coarser ones (Ogarko &
 * Luding 2012): the work stays linear for any size ratio. The list is the same for any number of
 * threads. GNEISS_ERROR_INPUT if a periodic box is narrower than twice the largest interaction. */
gneiss_status gn_pairs_find(const gn_pair_query *query, gn_pair_list *list, gneiss_error *error);
void gn_pair_list_free(gn_pair_list *list);

/* Order along a Morton (Z) curve over the particles' bounding box: order[k] is the present place of
 * the particle that comes k-th. Ties by id. `order` [count]. */
gneiss_status gn_morton_order(const gn_particles *particles, int dimension, int32_t *order,
                              gneiss_error *error);

/* Where the forces of a list of contacts are summed: numbering of the blocks' rows, and which rows
 * each particle has. Takes the place of what *partials held. */
gneiss_status gn_partials_build(const gn_contacts *contacts, size_t particle_count, int threads,
                                gn_partials *partials, gneiss_error *error);
gneiss_status gn_element_partials_build(const gn_elements *elements, size_t node_count, int threads,
                                        gn_partials *partials, gneiss_error *error);
void gn_partials_free(gn_partials *partials);

/* Of so many items with so many particles each. */
size_t gn_partials_bytes(const gn_partials *partials, size_t items, int members);

#endif
