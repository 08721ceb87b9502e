/* Loads on particles, for output. */
#ifndef GN_PARTICLES_LOADS_H
#define GN_PARTICLES_LOADS_H

#include "base/error.h"
#include "frame/parts.h"

/* What acts on every particle at the present positions, N and N m, [particles][6] each, in their
 * order: all of it but what zones of elements do and what prescribes a motion supplies, background
 * damping included; background damping. Of walls and surfaces as the last step found it. */
gneiss_status gn_world_loads(const gn_step_context *ctx, const gn_dem *dem,
                             const gn_boundary *boundary, const gn_periodic_box *box, double *total,
                             double *damping, gneiss_error *error);

#endif
