/* What `gneiss check` says of zones that particles and elements share. */
#ifndef GN_CLI_PLAN_COUPLE_H
#define GN_CLI_PLAN_COUPLE_H

#include "sim/world.h"

/* Of `plan`: the limit of particles and elements as one. */
void gn_print_whole_limit(const gn_world *world);
void gn_print_zones(const gn_world *world, int *warnings);

#endif
