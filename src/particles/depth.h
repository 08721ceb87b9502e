/* Particles that were not bonded at the start, and the contact with the largest relative overlap.
 * */
#ifndef GN_PARTICLES_DEPTH_H
#define GN_PARTICLES_DEPTH_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

/* Finds the loose particles, dem->loose, when it is first called. */
gneiss_status gn_loose_find(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);

/* Begins a check of overlaps; the loose particles must be known. */
gneiss_status gn_depth_begin(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Returns the overlap, m, that a contact of this radius must exceed to replace the one in
 * dem->depth. */
double gn_depth_known(const gn_dem *dem, double radius);
/* Stores an overlap, m, in dem->depth if it is the largest so far, relative to `radius`, the
 * smaller radius of the contact. `second`: see gn_depth. */
void gn_depth_note(const gn_step_context *ctx, gn_dem *dem, double overlap, double radius, size_t p,
                   double second);

#endif
