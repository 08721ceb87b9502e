/* Runs from parameters, private to src/sweep. */
#ifndef GN_SWEEP_EXPAND_H
#define GN_SWEEP_EXPAND_H

#include "sweep/sweep.h"

/* Fills the runs from parameters and seeds, reading the scene of each. Counted seeds get their
 * numbers. */
gneiss_status gn_sweep_expand(gn_sweep *sweep, gn_combine combine, gneiss_error *error);

#endif
