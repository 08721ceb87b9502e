/* Cost of a run with sources, whose particles do not exist yet. */
#ifndef GN_CLI_PLAN_FLOW_H
#define GN_CLI_PLAN_FLOW_H

#include "frame/parts.h"
#include "world/world.h"

/* The cost is measured in the first steps of the run, which are taken for some seconds: steps to
 * the end at the length of the last one, and their time with the particles that will exist then if
 * none leave. */
typedef struct gn_plan_flow {
    double steps, seconds; /* to the end of the run */
    double tried;          /* s, end of the trial */
    double step;           /* s, the last one */
    size_t present;        /* particles at the end of the trial */
    double most;           /* particles at the end of the run, at most */
    bool touched;          /* true if any contact was seen */
} gn_plan_flow;
gneiss_status gn_plan_flow_try(gn_world *world, gn_plan_flow *flow, gneiss_error *error);
void gn_print_plan_flow(const gn_world *world, const gn_plan_flow *flow);

#endif
