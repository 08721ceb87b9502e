/* Formation and removal of bonds. */
#ifndef GN_PARTICLES_BONDS_H
#define GN_PARTICLES_BONDS_H

#include "frame/parts.h"

#include <stdbool.h>

/* Returns the energy of the springs of all contacts between particles, J. */
double gn_contacts_stored(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_periodic_box *box);
/* Tells whether that energy exceeds rounding, so that particles at rest would start to move. */
bool gn_stored_matters(const gn_step_context *ctx, const gn_dem *dem, double stored);

#endif
