/* Loose and wedged debris. */
#ifndef GN_TIMESTEP_DEBRIS_H
#define GN_TIMESTEP_DEBRIS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>

/* Whether, where that is so and the step is automatic, any particle has lost all bonds that it had,
 * or all but one. Whether the ledger of a step that was measured misses more than that may. */
gneiss_status gn_debris_find(const gn_step_context *ctx, gn_dem *dem, bool *some,
                             gneiss_error *error);

#endif
