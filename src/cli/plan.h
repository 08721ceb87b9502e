/* The commands `gneiss plan` and `gneiss check`. */
#ifndef GN_CLI_PLAN_H
#define GN_CLI_PLAN_H

#include "frame/parts.h"
#include "world/world.h"

/* Prints the effects of the scene, bytes, kernels, time step, number of steps, memory and time.
 * Takes a few steps to measure the speed, and leaves the world after these steps. */
gneiss_status gn_print_plan(gn_world *world, gneiss_error *error);

/* Returns the wall time of a whole run on the world's threads, s. It is measured over a few steps;
 * the world is left after them. */
gneiss_status gn_plan_seconds(gn_world *world, double *seconds, gneiss_error *error);

/* Prints the figures of the packing, bonds per particle and warnings, and counts the latter in
 * *warnings. The world is unchanged. */
gneiss_status gn_print_check(gn_world *world, int *warnings, gneiss_error *error);

/* Prints " x LOWER to UPPER m" in the user's coordinates. */
void gn_print_range(const gn_world *world, int axis, double lower, double upper, const char *note);

#endif
