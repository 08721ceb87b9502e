/* Stability limit of the particles. */
#ifndef GN_TIMESTEP_PARTICLE_LIMIT_H
#define GN_TIMESTEP_PARTICLE_LIMIT_H

#include "base/error.h"
#include "frame/parts.h"
#include "limit/step_limits.h"

#include <stdbool.h>

/* Calls `use` with the linearised system of the particles: of the springs that act or, with
 * `listed`, of all that the lists hold. */
typedef gneiss_status gn_spectrum_user(const gn_spectrum *spectrum, void *context,
                                       gneiss_error *error);
gneiss_status gn_dem_with_spectrum(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, bool listed, gn_spectrum_user *use,
                                   void *context, gneiss_error *error);

#endif
