/* Plane walls. */
#ifndef GN_BOUNDARY_WALLS_H
#define GN_BOUNDARY_WALLS_H

#include "frame/parts.h"

#include <stddef.h>

/* N, with which a servo wall shall be pressed. */
double gn_wall_wanted(const gn_step_context *ctx, const gn_boundary *boundary, size_t wall,
                      double time);
/* After lists have been made: what servos press. */
void gn_walls_listed(const gn_step_context *ctx, const gn_dem *dem, gn_boundary *boundary);
/* J: what the spring of a contact with a wall holds, less half a step of what it gives to the
 * particle and takes of the wall, at the velocities that led here; linear law. */
double gn_wall_held(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                    size_t row);
/* The largest share of the missing force that a servo wall takes up in a step and is stable. */
double gn_world_servo_relaxation(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, size_t wall);

#endif
