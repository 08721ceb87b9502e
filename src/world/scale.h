/* Files whose lengths are probably not metres. */
#ifndef GN_WORLD_SCALE_H
#define GN_WORLD_SCALE_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a specimen, mesh or body from a file without a `scale` is implausibly large: too
 * large for a laboratory test, so large that the speeds and times of the scene move it by a
 * negligible distance, or much larger than the specimen. `text` receives the object, its size and
 * the reason. A density that no material has in kg/m3 counts as a sign of other units. */
bool gn_scale_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_solids *solids, char *text, size_t size);

/* Appends the size of a large specimen or mesh from a file without a `scale` to the message of an
 * error that was found while the world was made, because the error may follow from it. */
void gn_scale_explain(const gn_step_context *ctx, const gn_solids *solids, gneiss_error *error);

#endif
