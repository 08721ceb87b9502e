/* From parameters to runs: private to the room. */
#ifndef GN_SWEEP_EXPAND_H
#define GN_SWEEP_EXPAND_H

#include "sweep/sweep.h"

/* Fills the runs from parameters and seeds, reading the scene of each. Seeds that are only counted
 * get their numbers. */
gneiss_status gn_sweep_expand(gn_sweep *sweep, gn_combine combine, gneiss_error *error);

/* Refuses parameters, and overrides of the command line, that write the same place of the scene:
 * one of the values would be told, and not be run (places.c). Values are chosen by then. */
gneiss_status gn_sweep_check_places(const gn_sweep *sweep, gneiss_error *error);

#endif
