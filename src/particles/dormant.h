/* Dormant particles of a body that is still represented by elements: they have no mass and no
 * contacts, and their blocks are skipped, until their element converts. */
#ifndef GN_PARTICLES_DORMANT_H
#define GN_PARTICLES_DORMANT_H

#include "base/error.h"
#include "frame/frame.h"
#include "frame/parts.h"
#include "particles/particles.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static inline gn_dormant_particle *gn_dormant_of(const gn_dem *dem, size_t p) {
    return &dem->dormant[dem->particles.id[p]];
}
static inline bool gn_is_dormant(const gn_dem *dem, size_t p) {
    return dem->dormant && gn_dormant_of(dem, p)->inverse_mass > 0.0;
}
/* Tells whether a pair carries no force because elements that convert have the whole weight at both
 * particles. */
static inline bool gn_is_hidden_pair(const gn_step_context *ctx, const gn_dem *dem, int32_t i,
                                     int32_t j) {
    const double *part = dem->particles.blend;
    return gn_converts(ctx) && !(part[2 * (size_t)i] + part[2 * (size_t)j] > 0.0);
}
/* Returns the element that contains a particle at the start, as its index in the mesh. */
static inline size_t gn_dormant_element(const gn_dem *dem, size_t p) {
    return (size_t)gn_dormant_of(dem, p)->element;
}

/* Prepares a model with converting elements, at the start: no particle has an element yet. */
gneiss_status gn_dormant_create(gn_dem *dem, gneiss_error *error);
/* Makes all particles dormant and stores their bonds in dem->prepared. */
gneiss_status gn_dormant_deactivate_all(const gn_step_context *ctx, gn_dem *dem,
                                        gneiss_error *error);
/* Takes over the bonds of the active particles, sorted, in place of the present ones. */
gneiss_status gn_dormant_take_bonds(const gn_step_context *ctx, gn_dem *dem, gn_contacts *bonds,
                                    gneiss_error *error);
/* Activates all dormant particles with their bonds, for an evaluation of the whole packing, or
 * undoes this. Does nothing without couple.convert. */
void gn_dormant_swap(const gn_step_context *ctx, gn_dem *dem);
/* Marks the blocks of particles that are all dormant, when lists are made. */
gneiss_status gn_dormant_find_blocks(gn_dem *dem, gneiss_error *error);
/* Returns the number of dormant particles. */
size_t gn_dormant_count(const gn_dem *dem);

#endif
