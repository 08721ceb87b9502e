/* Contact parameters from the materials of a scene, for `gneiss check`. */
#ifndef GN_CLI_PLAN_LAW_H
#define GN_CLI_PLAN_LAW_H

#include "frame/parts.h"
#include "world/world.h"

gneiss_status gn_print_law(const gn_world *world, int *warnings, gneiss_error *error);

#endif
