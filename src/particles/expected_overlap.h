/* Expected overlaps of contacts with Hertz's law. */
#ifndef GN_PARTICLES_EXPECTED_OVERLAP_H
#define GN_PARTICLES_EXPECTED_OVERLAP_H

#include "frame/parts.h"
#include "soa/records.h"

#include <stddef.h>

/* Least expected overlap over the radius of a contact: without it the step at the start would have
 * no bound. */
#define GN_OVERLAP_LEAST 1e-6

/* Returns the radius of a contact of two particles, m: r_i r_j/(r_i + r_j). */
double gn_pair_radius(const gn_particles *particles, size_t i, size_t j);
/* Returns the square of the relative velocity of two rows, m2/s2. */
double gn_relative_speed2(const double *a, const double *b);
/* Returns the overlap, over `radius`, at which a contact of stiffness kn sqrt(overlap) stores the
 * energy of a collision whose squared speed is `speed2`, and the work of the attraction `pull`, N;
 * at least `known`. */
double gn_expected_overlap(const gn_step_context *ctx, const gn_dem *dem, double kn, double pull,
                           double inverse_mass, double speed2, double radius, double known);
/* Returns the attraction, N, that the stiffness at an overlap does not include: of DMT and liquid,
 * whose force at the touch jumps. A JKR contact is as wide at the touch as its attraction asks. */
double gn_sudden_pull(int cohesion, double adhesion, double radius);
/* Return the expected overlap of contacts with Hertz's law, m: of two particles whose stiffness is
 * kn sqrt(overlap) and attraction `pull`, and of a particle with walls and surfaces. */
double gn_pressed_meeting(const gn_step_context *ctx, const gn_dem *dem, size_t i, size_t j,
                          double kn, double pull);
double gn_pressed_touch(const gn_dem *dem, size_t particle);

#endif
