/* Expected overlap of Hertz contacts. */
#ifndef GN_TIMESTEP_INDENTATION_H
#define GN_TIMESTEP_INDENTATION_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

/* Updates the expected overlaps and the step if a kernel has found a larger overlap. */
gneiss_status gn_pressed_check(gn_world *world, gneiss_error *error);

/* From where Hertz's theory, and any spring between what should hardly touch, misleads: of what was
 * not bonded at the start. Bonded specimens are pressed further by platens, and among debris,
 * without harm to what is read of them; from here on a particle is on its way through. */
#define GN_DEPTH_LOOSE  0.1
#define GN_DEPTH_BONDED 0.5

/* Looks at what is listed, as it is now, into world->dem.depth: whenever lists are made, and in
 * measured steps if that was some steps ago. What cannot move is left out. */
gneiss_status gn_depth_look(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                            gneiss_error *error);
gneiss_status gn_depth_look_again(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                  gneiss_error *error);

/* Whose contact it was. */
const char *gn_depth_text(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);

#endif
