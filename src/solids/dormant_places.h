/* Positions of dormant particles in their elements. */
#ifndef GN_SOLIDS_DORMANT_PLACES_H
#define GN_SOLIDS_DORMANT_PLACES_H

#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Tells whether any element has been converted. */
bool gn_elements_have_left(const gn_solids *solids);
/* Returns the number of elements that have not been converted. */
size_t gn_elements_left_count(const gn_solids *solids);
/* Returns the indices of the remaining elements [elements of the mesh] for gn_particle_travel
 * (gn_fem_places), owned by the caller; NULL if no elements convert, or without memory. */
int32_t *gn_element_places(const gn_step_context *ctx, const gn_solids *solids);
/* Returns the displacement of a particle, m. A dormant particle has that of its element; it is NaN
 * without `places`. Can be called for any world. */
void gn_particle_travel(const gn_dem *dem, const gn_solids *solids, const int32_t *places, size_t p,
                        double u[3]);
/* Returns the velocity of a particle, m/s; for dormant ones as gn_particle_travel does. */
void gn_particle_velocity(const gn_dem *dem, const gn_solids *solids, const int32_t *places,
                          size_t p, double v[3]);

#endif
