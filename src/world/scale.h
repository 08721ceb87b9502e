/* Files whose lengths are probably not metres. */
#ifndef GN_WORLD_SCALE_H
#define GN_WORLD_SCALE_H

#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a specimen, mesh or body from a file, without a `scale`, is so large that it does
 * not go together with the rest of the scene: a test in a laboratory, speeds and times that move it
 * by next to nothing, a specimen that is much smaller. `text`: which, its size, and why. What is
 * dense as nothing is in kg/m3 is taken for a scene in other units. */
bool gn_scale_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_solids *solids, char *text, size_t size);

#endif
