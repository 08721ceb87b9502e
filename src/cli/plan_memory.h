/* The memory that a run takes, as `gneiss plan` prints it. */
#ifndef GN_CLI_PLAN_MEMORY_H
#define GN_CLI_PLAN_MEMORY_H

#include "world/world.h"

/* After the world was made and has taken its trial steps, in the process that did so. */
void gn_print_plan_memory(const gn_world *world);

#endif
