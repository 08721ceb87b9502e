/* Memory of a run, as `gneiss plan` prints it. */
#ifndef GN_CLI_PLAN_MEMORY_H
#define GN_CLI_PLAN_MEMORY_H

#include "frame/parts.h"
#include "world/world.h"

/* Prints the memory of this process, called after the world was made and has taken its trial steps.
 * `coming`: the number of particles that sources will let in after these. */
void gn_print_plan_memory(const gn_world *world, double coming);

#endif
