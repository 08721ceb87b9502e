/* Which particles bear a membrane. */
#ifndef GN_SIM_MEMBRANE_BEAR_H
#define GN_SIM_MEMBRANE_BEAR_H

#include "sim/membrane.h"

/* [particles] those that contacts hold against being pushed any way, of what has not come off;
 * without bonds, and where none is, all of that. */
gneiss_status gn_membrane_held(const gn_world *world, bool *held, gneiss_error *error);

#endif
