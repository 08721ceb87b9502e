/* `gneiss plan` and `gneiss check`. */
#ifndef GN_CLI_PLAN_H
#define GN_CLI_PLAN_H

#include "world/world.h"

/* Effects, bytes, kernels, step, steps, memory, time. Takes a few steps to measure the speed, so
 * the world is not at its start afterwards. */
gneiss_status gn_print_plan(gn_world *world, gneiss_error *error);

/* Wall time of a whole run on the world's threads, by a few of its steps, s; the same holds. */
gneiss_status gn_plan_seconds(gn_world *world, double *seconds, gneiss_error *error);

/* Packing figures, bonds per particle, and what looks wrong; *warnings counts those. The world is
 * as before. */
gneiss_status gn_print_check(gn_world *world, int *warnings, gneiss_error *error);

/* "  x  LOWER to UPPER m" as the user sees them. */
void gn_print_range(const gn_world *world, int axis, double lower, double upper, const char *note);

#endif
