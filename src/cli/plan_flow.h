/* What a run with sources costs, whose particles are yet to come. */
#ifndef GN_CLI_PLAN_FLOW_H
#define GN_CLI_PLAN_FLOW_H

#include "world/world.h"

/* From the first steps of the real thing, which it takes for some seconds: steps to the end at the
 * length that the last of them had, and what they cost with the particles that will be there then,
 * were none of them to leave. */
typedef struct gn_plan_flow {
    double steps, seconds; /* to the end of the run */
    double tried;          /* s, up to which it was run */
    double step;           /* s, the last one */
    size_t present;        /* particles that were there then */
    double most;           /* that will be, at most */
    bool touched;          /* whether any contact was seen */
} gn_plan_flow;
gneiss_status gn_plan_flow_try(gn_world *world, gn_plan_flow *plan, gneiss_error *error);
void gn_print_plan_flow(const gn_world *world, const gn_plan_flow *plan);

#endif
