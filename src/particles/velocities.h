/* Velocities that are set from outside, between two steps. */
#ifndef GN_PARTICLES_VELOCITIES_H
#define GN_PARTICLES_VELOCITIES_H

#include "frame/parts.h"

/* Sets the velocities (m/s) and, unless NULL, spins (rad/s) of all particles, [particles][3] in
 * their present order, but for prescribed components and removed particles. Returns the gain of
 * kinetic energy, J. Lists are to be made anew before the next step. */
double gn_dem_set_velocities(const gn_step_context *ctx, gn_dem *dem, const double *velocity,
                             const double *spin);

#endif
