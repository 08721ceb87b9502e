/* Which blocks of particles or nodes wait between their forces and their motion. */
#ifndef GN_SCHED_HOLD_H
#define GN_SCHED_HOLD_H

#include "base/error.h"
#include "kernels/motion.h"

/* For that many blocks, none held; to be freed either way. */
gneiss_status gn_hold_create(gn_hold *hold, size_t blocks, gneiss_error *error);
void gn_hold_free(gn_hold *hold);

/* Lets all go. */
void gn_hold_clear(gn_hold *hold);
/* The block of a particle is to wait from now on. */
gneiss_status gn_hold_particle(gn_hold *hold, size_t particle, gneiss_error *error);

/* The loads of a particle whose block waits: force, 0, moment, 0 with a `width` of 8; force and, in
 * the plane, moment with one of 4 (gn_row_width). */
static inline double *gn_hold_load(const gn_hold *hold, int width, size_t particle) {
    size_t slot = (size_t)hold->slot[particle / GN_PARTICLE_BLOCK];
    return hold->load + GN_BLOCK_LOAD * slot + (size_t)width * (particle % GN_PARTICLE_BLOCK);
}

#endif
