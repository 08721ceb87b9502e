/* Output on stages in `plan`, `check` and at the end of a run. */
#ifndef GN_CLI_PLAN_STAGES_H
#define GN_CLI_PLAN_STAGES_H

#include "run/run.h"

/* Prints the stages before the first step; `per_step`: computing time, s. Prints nothing if the
 * scene has no stages. */
void gn_print_stages(const gn_world *world, double per_step);
/* True if a stage that ends by its steps alone would, with the present step, last longer than the
 * run; `text` then states which. */
bool gn_stage_is_overlong(const gn_world *world, char *text, size_t size);
/* Returns the largest number of steps up to the end of the run, at the present step. */
double gn_plan_steps(const gn_world *world);
/* Prints the end of each stage. */
void gn_print_stages_done(const gn_run *run);

#endif
