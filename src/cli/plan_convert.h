/* What `plan` and `check` say of elements that turn into particles. */
#ifndef GN_CLI_PLAN_CONVERT_H
#define GN_CLI_PLAN_CONVERT_H

#include "sim/conversion.h"

void gn_print_conversion(gn_world *world, int *warnings);
/* `plan`: who sleeps, before anything is tried. */
void gn_print_sleepers(const gn_world *world, const gn_foreseen *foreseen);
/* [2] of elements alone and, from the time on that was foreseen, with what has converted; dt: s, at
 * the start. */
void gn_foreseen_steps(const gn_world *world, const gn_foreseen *foreseen, double dt,
                       double steps[2]);
/* The step, steps and time; per_step: s, of either. */
void gn_print_foreseen(const gn_world *world, const gn_foreseen *foreseen, const double steps[2],
                       const double per_step[2]);

#endif
