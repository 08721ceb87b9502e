/* What a step takes, by taking some. */
#ifndef GN_CLI_PLAN_TIME_H
#define GN_CLI_PLAN_TIME_H

#include "world/world.h"

/* Seconds per step from a few steps of the real thing, none behind `until`. Where steps are short
 * threads may wait for each other more than they work, of which a run makes something after 160
 * steps (sched/pace.h): those are left out, if they come within a second. */
gneiss_status gn_time_steps(gn_world *world, double until, double *seconds, gneiss_error *error);
/* The same of a number of steps that goes by the model alone, so that what is done with it after
 * them is the same every time. */
gneiss_status gn_time_some(gn_world *world, double *seconds, gneiss_error *error);

#endif
