/* Runs from parameters, private to src/sweep. */
#ifndef GN_SWEEP_EXPAND_H
#define GN_SWEEP_EXPAND_H

#include "sweep/sweep.h"

/* Makes the runs from parameters and seeds, and reads the scene of each. Seeds that were given by
 * their count get their numbers. */
gneiss_status gn_sweep_expand(gn_sweep *sweep, gn_combine combine, gneiss_error *error);

#endif
