/* Loads on particles, for output. */
#ifndef GN_BOUNDARY_LOADS_H
#define GN_BOUNDARY_LOADS_H

#include "base/error.h"
#include "frame/parts.h"

/* Writes the loads of every particle at the present positions, N and N m, [particles][6], in the
 * order of the rows. `total` includes background damping, but not the forces of coupling zones and
 * of prescribed motions; `damping` is background damping alone. Contacts with walls and surfaces
 * are as the last step computed them. */
gneiss_status gn_boundary_write_loads(const gn_step_context *ctx, const gn_dem *dem,
                                      const gn_boundary *boundary, const gn_periodic_box *box,
                                      double *total, double *damping, gneiss_error *error);

#endif
