/* Loose and wedged debris. */
#ifndef GN_TIMESTEP_DEBRIS_H
#define GN_TIMESTEP_DEBRIS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>

/* *some: collisions are hardly damped (gn_world_rings), the step is automatic, and a particle has
 * lost all of its bonds or all but one. */
gneiss_status gn_debris_find(const gn_step_context *ctx, gn_dem *dem, bool *some,
                             gneiss_error *error);

#endif
