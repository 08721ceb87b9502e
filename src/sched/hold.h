/* Blocks of particles or nodes that wait between the sum of their forces and their motion. */
#ifndef GN_SCHED_HOLD_H
#define GN_SCHED_HOLD_H

#include "base/error.h"
#include "kernels/motion.h"

/* Creates the flags of `blocks` blocks, none held; to be freed also on failure. */
gneiss_status gn_hold_create(gn_hold *hold, size_t blocks, gneiss_error *error);
void gn_hold_free(gn_hold *hold);

/* Releases all blocks. */
void gn_hold_clear(gn_hold *hold);
/* Marks the block of a particle as held. */
gneiss_status gn_hold_particle(gn_hold *hold, size_t particle, gneiss_error *error);

/* Returns the loads of a particle in a held block: force, 0, moment, 0 with a `width` of 8; force
 * and, in 2D, moment with one of 4 (gn_row_width). */
static inline double *gn_hold_load(const gn_hold *hold, int width, size_t particle) {
    size_t slot = (size_t)hold->slot[particle / GN_PARTICLE_BLOCK];
    return hold->load + GN_BLOCK_LOAD * slot + (size_t)width * (particle % GN_PARTICLE_BLOCK);
}

#endif
