/* Energy added by a change of the step. */
#ifndef GN_FRAME_STEP_CHANGE_H
#define GN_FRAME_STEP_CHANGE_H

#include "frame/parts.h"
#include "soa/records.h"

#include <stddef.h>

/* For a step whose length differs from the last one: gn_rows_copy copies rows [.][4] before the
 * step (NULL: no memory); gn_rows_add_step_change adds the resulting change of energy to its
 * halves. */
double *gn_rows_copy(const gn_particles *of, const double *rows);
void gn_rows_add_step_change(const gn_step_context *ctx, const double *past, const double *now,
                             size_t count, double halves[2]);

#endif
