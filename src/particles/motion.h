/* Motion of blocks of particles, and the sums of a step. */
#ifndef GN_PARTICLES_MOTION_H
#define GN_PARTICLES_MOTION_H

#include "frame/parts.h"
#include "kernels/contact.h"
#include "kernels/motion.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether no particle of a block is active. */
bool gn_dem_is_still(const gn_dem *dem, size_t block);
/* Adds up the partial sums of a block of particles and moves it. */
void gn_dem_move_block(gn_dem *dem, const gn_motion_args *motion, size_t block);

/* Stores the velocities before a step whose length differs from that of the last step. */
void gn_dem_keep_velocities(gn_dem *dem);
/* Sets the stored velocity of a particle, or its spin if `spin`, to 0, because another part of the
 * model moves the particle. */
void gn_dem_clear_past(gn_dem *dem, size_t particle, bool spin);

/* Returns the sum over blocks, in their order. */
gn_contact_sums gn_contact_sums_of(const gn_contact_sums *blocks, size_t count);
/* Sets dem->done from the sums of blocks; `walls`: of contacts with walls and facets. */
void gn_dem_add_up(gn_dem *dem, const gn_contact_sums *walls);
/* Computes sums, bounds on paths and counts of the step, after the motion of all blocks. */
void gn_dem_moved(const gn_step_context *ctx, gn_dem *dem, const gn_contact_sums *walls);
/* Raises the bounds on paths in the last step, which were computed for the speed `counted`, m/s, to
 * those for `speed`. */
void gn_dem_count_speed(const gn_step_context *ctx, gn_dem *dem, double speed, double counted);
/* Discards the speed of the last step, if velocities do not result from a step. */
void gn_dem_forget_speed(const gn_step_context *ctx, gn_dem *dem);

#endif
