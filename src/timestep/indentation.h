/* Expected overlap of Hertz contacts. */
#ifndef GN_TIMESTEP_INDENTATION_H
#define GN_TIMESTEP_INDENTATION_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

/* How far contacts of Hertz's law are expected to be pressed (indentation.c), m: of two particles
 * whose stiffness is kn sqrt(overlap), and of one with walls and surfaces. */
double gn_pressed_meeting(const gn_step_context *ctx, const gn_dem *dem, size_t i, size_t j,
                          double kn);
double gn_pressed_touch(const gn_dem *dem, size_t particle);
/* Updates the expected overlaps and the step if a kernel has found a larger overlap. */
gneiss_status gn_pressed_check(gn_world *world, gneiss_error *error);

#endif
