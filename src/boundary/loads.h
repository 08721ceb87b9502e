/* Loads on particles, for output. */
#ifndef GN_BOUNDARY_LOADS_H
#define GN_BOUNDARY_LOADS_H

#include "base/error.h"
#include "frame/parts.h"

/* Writes the loads of every particle at the present positions, N and N m, [particles][6] each, in
 * their order: `total` includes background damping and leaves out the forces of coupling zones and
 * of prescribed motions; `damping` is background damping alone. Contacts with walls and surfaces
 * enter as the last step computed them. */
gneiss_status gn_boundary_write_loads(const gn_step_context *ctx, const gn_dem *dem,
                                      const gn_boundary *boundary, const gn_periodic_box *box,
                                      double *total, double *damping, gneiss_error *error);

#endif
