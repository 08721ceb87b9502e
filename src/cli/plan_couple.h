/* What `gneiss check` says of zones that particles and elements share. */
#ifndef GN_CLI_PLAN_COUPLE_H
#define GN_CLI_PLAN_COUPLE_H

#include "sim/world.h"

void gn_print_zones(const gn_world *world, int *warnings);

#endif
