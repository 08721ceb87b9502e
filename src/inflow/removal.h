/* Removal of particles. */
#ifndef GN_INFLOW_REMOVAL_H
#define GN_INFLOW_REMOVAL_H

#include "base/error.h"
#include "frame/parts.h"

/* Particles outside the domain (removal.c) fail the run or leave the model, those in sinks leave:
 * without mass and contacts, with their energy and that of their contacts booked as carried away.
 * Call with the lists as the last step left them. */
gneiss_status gn_dem_check_domain(gn_world *world, gneiss_error *error);

#endif
