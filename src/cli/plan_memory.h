/* Memory of a run, as `gneiss plan` prints it. */
#ifndef GN_CLI_PLAN_MEMORY_H
#define GN_CLI_PLAN_MEMORY_H

#include "frame/parts.h"
#include "world/world.h"

/* Beyond what the world holds after its trial steps. */
typedef struct gn_plan_growth {
    double particles; /* that sources will let in */
    double rows;      /* of the history, over those that are expected with the first step */
} gn_plan_growth;

/* Prints the memory of this process, called after the world was made and has taken its trial steps.
 */
void gn_print_plan_memory(const gn_world *world, const gn_plan_growth *growth);

#endif
