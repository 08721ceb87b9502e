/* Measured cost of a run: time of a step, memory, sources, conversions. */
#ifndef GN_CLI_PLAN_COST_H
#define GN_CLI_PLAN_COST_H

#include "frame/parts.h"
#include "world/world.h"

/* Returns the seconds per step from a few real steps, none beyond `until`. If steps are short,
 * threads may wait for each other more than they work, which a run corrects after 160 steps
 * (sched/pace.h): these steps are skipped if they take less than a second. */
gneiss_status gn_time_steps(gn_world *world, double until, double *seconds, gneiss_error *error);
/* Measures a number of steps that depends on the model alone, so that the world is in the same
 * state each time afterwards. */
gneiss_status gn_time_fixed_steps(gn_world *world, double *seconds, gneiss_error *error);

/* Prints the memory of this process, called after the world was made and has taken its trial steps.
 * `coming`: the number of particles that sources will let in after these. */
void gn_print_plan_memory(const gn_world *world, double coming);

/* The cost is measured in the first steps of the run, which are taken for some seconds: steps to
 * the end at the length of the last one, and their time with the particles that will exist then if
 * none leave. */
typedef struct gn_plan_flow {
    double steps, seconds; /* steps and seconds to the end of the run */
    double tried;          /* s, end of the trial */
    double step;           /* s, the last one */
    size_t present;        /* particles at the end of the trial */
    double most;           /* particles at the end of the run, at most */
    bool touched;          /* true if any contact was seen */
} gn_plan_flow;
gneiss_status gn_plan_flow_try(gn_world *world, gn_plan_flow *flow, gneiss_error *error);
void gn_print_plan_flow(const gn_world *world, const gn_plan_flow *flow);

#endif
