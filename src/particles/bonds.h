/* Formation and removal of bonds. */
#ifndef GN_PARTICLES_BONDS_H
#define GN_PARTICLES_BONDS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>

/* Returns the energy of the springs of all contacts between particles, J. */
double gn_contacts_stored(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_periodic_box *box);
/* Tells whether the stored energy `stored`, J, exceeds rounding, so that particles at rest would
 * start to move. */
bool gn_stored_matters(const gn_step_context *ctx, const gn_dem *dem, double stored);
/* gn_bonds_add forms bonds between the pairs at their present positions in addition to the present
 * bonds; gn_bonds_dissolve turns all intact bonds into unbonded contacts. The lists must be rebuilt
 * after either. */
gneiss_status gn_bonds_add(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
void gn_bonds_dissolve(const gn_step_context *ctx, gn_dem *dem);
/* Multiplies the strengths of all intact bonds, so that none breaks or softens; yield stresses are
 * unchanged. */
void gn_bonds_strengthen(gn_dem *dem, double factor);

#endif
