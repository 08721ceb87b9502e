/* The command `gneiss plan SCENE --error 5%`: the cheapest settings for an error, and the scene
 * with them. */
#ifndef GN_CLI_PLAN_ACCURACY_H
#define GN_CLI_PLAN_ACCURACY_H

#include "cli/options.h"
#include "frame/parts.h"
#include "world/world.h"

/* `setup`: processor time, s, for making the world. */
gneiss_status gn_plan_accuracy(const gn_options *options, const gn_world *world, double setup,
                               gneiss_error *error);

#endif
