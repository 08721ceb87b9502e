/* Which particles bear a membrane. */
#ifndef GN_MEMBRANE_SUPPORT_H
#define GN_MEMBRANE_SUPPORT_H

#include "base/error.h"
#include "frame/parts.h"
#include "membrane/membrane.h"

#include <stdbool.h>

/* [particles] those that contacts hold against being pushed any way, of what has not come off;
 * without bonds, and where none is, all of that. */
gneiss_status gn_membrane_held(const gn_step_context *ctx, const gn_dem *dem, bool *held,
                               gneiss_error *error);

#endif
