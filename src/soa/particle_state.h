/* The state of particles as given by their inverse mass. An inverse mass of 0 means that the
 * particle does not take part in the motion: it was removed, or is dormant (particles/dormant.h).
 * */
#ifndef GN_SOA_PARTICLE_STATE_H
#define GN_SOA_PARTICLE_STATE_H

#include "soa/records.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a particle moves and has contacts: it is neither removed nor dormant. Of the nodes
 * of finite elements: whether it has a mass. */
static inline bool gn_particle_is_active(const gn_particles *particles, size_t p) {
    return particles->vel[4 * p + 3] > 0.0;
}

#endif
