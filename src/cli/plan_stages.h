/* Stages as `plan`, `check` and the end of a run show them. */
#ifndef GN_CLI_PLAN_STAGES_H
#define GN_CLI_PLAN_STAGES_H

#include "run/run.h"

/* What stands before the first step; `per_step`, s of computing. Nothing without stages. */
void gn_print_stages(const gn_world *world, double per_step);
/* Whether a stage that ends by its steps alone would last longer than the run, with the present
 * step; `text` then says which. */
bool gn_stage_is_overlong(const gn_world *world, char *text, size_t size);
/* Steps up to the end of the run, at most, at their present length. */
double gn_plan_steps(const gn_world *world);
/* How each one went. */
void gn_print_stages_done(const gn_run *run);

#endif
