/* Measured time of a step. */
#ifndef GN_CLI_PLAN_TIME_H
#define GN_CLI_PLAN_TIME_H

#include "frame/parts.h"
#include "world/world.h"

/* Returns the seconds per step from a few real steps, none beyond `until`. If steps are short,
 * threads may wait for each other more than they work, which a run corrects after 160 steps
 * (sched/pace.h): these steps are skipped if they take less than a second. */
gneiss_status gn_time_steps(gn_world *world, double until, double *seconds, gneiss_error *error);
/* Measures a number of steps that depends on the model alone, so that the world is in the same
 * state each time afterwards. */
gneiss_status gn_time_fixed_steps(gn_world *world, double *seconds, gneiss_error *error);

#endif
