/* Energy that a change of the step adds. */
#ifndef GN_FRAME_STEP_CHANGE_H
#define GN_FRAME_STEP_CHANGE_H

#include "frame/parts.h"
#include "soa/records.h"

#include <stddef.h>

/* Of a step of another length than the last: rows [.][4] as they are before it, NULL:
 * no memory; what the change adds to the energy, in halves. */
double *gn_rows_copy(const gn_particles *of, const double *rows);
void gn_rows_add_step_change(const gn_step_context *ctx, const double *past, const double *now,
                             size_t count, double halves[2]);

#endif
