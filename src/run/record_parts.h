/* What the files of the history share. */
#ifndef GN_RUN_RECORD_PARTS_H
#define GN_RUN_RECORD_PARTS_H

#include "run/record.h"
#include "sim/parts.h"

/* Change of the distance of the ends, m, positive in the sense of the test (ends.c). */
double gn_record_deflection(const gn_world *world);
/* Forces of the ends along the axis, N, positive in the sense of the test. An end that is only
 * watched (what loads it is a traction) has the force of the other one. */
void gn_record_end_forces(const gn_world *world, double *lower, double *upper);

#endif
