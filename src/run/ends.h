/* The two ends of a test. */
#ifndef GN_RUN_ENDS_H
#define GN_RUN_ENDS_H

#include "sim/internal.h"

/* Change of the distance of the ends, m, positive in the sense of the test. */
double gn_ends_deflection(const gn_world *world);
/* Forces of the ends along the axis, N, positive in the sense of the test. An end that is only
 * watched (what loads it is a traction) has the force of the other one. */
void gn_ends_forces(const gn_world *world, double *lower, double *upper);

#endif
