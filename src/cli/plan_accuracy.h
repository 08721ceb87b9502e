/* The command `gneiss plan SCENE --error 5%`: the cheapest settings for an error, and the scene
 * with them. */
#ifndef GN_CLI_PLAN_ACCURACY_H
#define GN_CLI_PLAN_ACCURACY_H

#include "cli/options.h"
#include "frame/parts.h"
#include "world/world.h"

/* Returns the reading that a plan concerns: "strength" or "stiffness". */
const char *gn_planned_reading(const gn_options *options, const gn_scene *scene);

/* Prints a plan and writes its scene to options->write. `setup`: processor time for making the
 * world, s. `packings` receives the number of packings whose mean has the requested error; then a
 * plan that does not reach the error fails with GNEISS_ERROR_INPUT. NULL: not needed. */
gneiss_status gn_plan_accuracy(const gn_options *options, const gn_world *world, double setup,
                               int *packings, gneiss_error *error);

/* Tells whether a file is a scene that was written for the same scene file and may be replaced. */
bool gn_plan_wrote(const char *path, const char *target);

#endif
