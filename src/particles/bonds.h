/* Formation and removal of bonds. */
#ifndef GN_PARTICLES_BONDS_H
#define GN_PARTICLES_BONDS_H

#include "frame/parts.h"

#include <stdbool.h>

/* J, what the springs of all contacts between particles hold. */
double gn_contacts_stored(const gn_step_context *ctx, const gn_dem *dem,
                          const gn_periodic_box *box);
/* Tells whether that is more than rounding, and lets particles at rest spring apart. */
bool gn_stored_matters(const gn_step_context *ctx, const gn_dem *dem, double stored);

#endif
