/* What `plan` and `check` say of elements that turn into particles. */
#ifndef GN_CLI_PLAN_CONVERT_H
#define GN_CLI_PLAN_CONVERT_H

#include "sim/world.h"

void gn_print_conversion(const gn_world *world, int *warnings);
/* `plan`: the step that all of the particles would have, were they awake. */
gneiss_status gn_print_sleepers(gn_world *world, gneiss_error *error);

#endif
