/* Measured cost of a run: time of a step, memory, sources, conversions. */
#ifndef GN_CLI_PLAN_COST_H
#define GN_CLI_PLAN_COST_H

#include "frame/parts.h"
#include "world/world.h"

/* Returns the seconds per step from a few real steps, none of them after the time `until`. If steps
 * are short, threads may spend more time waiting than working; a run corrects this after 160 steps
 * (sched/pace.h). These steps are not measured if they take less than a second. */
gneiss_status gn_time_steps(gn_world *world, double until, double *seconds, gneiss_error *error);
/* Measures a number of steps that depends only on the model, so that the world always has the same
 * state afterwards. */
gneiss_status gn_time_fixed_steps(gn_world *world, double *seconds, gneiss_error *error);

/* Prints the memory of this process. It is called after the world was made and took its trial
 * steps. `coming`: the number of particles that sources will add later. */
void gn_print_plan_memory(const gn_world *world, double coming);

/* Cost of a run with sources, measured over the first steps, which take some seconds. The remaining
 * steps are assumed to be as long as the last of these, and their time is that for the particles
 * that will exist if none leave. */
typedef struct gn_plan_flow {
    double steps, seconds; /* steps and seconds to the end of the run */
    double tried;          /* s, end of the trial */
    double step;           /* s, length of the last step */
    size_t present;        /* particles at the end of the trial */
    double most;           /* largest possible number of particles at the end of the run */
    bool touched;          /* true if any contact was seen */
} gn_plan_flow;
gneiss_status gn_plan_flow_try(gn_world *world, gn_plan_flow *flow, gneiss_error *error);
void gn_print_plan_flow(const gn_world *world, const gn_plan_flow *flow);

#endif
