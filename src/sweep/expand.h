/* Runs from parameters, private to src/sweep. */
#ifndef GN_SWEEP_EXPAND_H
#define GN_SWEEP_EXPAND_H

#include "sweep/sweep.h"

/* Fills the runs from parameters and seeds, reading the scene of each. Counted seeds get their
 * numbers. */
gneiss_status gn_sweep_expand(gn_sweep *sweep, gn_combine combine, gneiss_error *error);

/* Refuses parameters and overrides of the command line that write the same place of the scene,
 * because one of the reported values would not be used (places.c). Values must have been chosen. */
gneiss_status gn_sweep_check_places(const gn_sweep *sweep, gneiss_error *error);

#endif
