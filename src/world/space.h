/* The space that walls, a membrane or a periodic box leave to the specimen, as they are now. */
#ifndef GN_WORLD_SPACE_H
#define GN_WORLD_SPACE_H

#include "frame/parts.h"

#include <stdbool.h>

/* Tells whether walls or periodic sides close the specimen in along every axis; `now` and `start`:
 * their distances, m, multiplied. Walls are the first two across an axis that face each other. */
bool gn_space_closed(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box, double *now, double *start);

/* m3 (2D: m2 x 1 m): what the mean stress of the specimen refers to. Of walls that close it in, of
 * a membrane and of a periodic box as they are; of an oedometer test as its ends are; else that of
 * the start. */
double gn_space_volume(const gn_step_context *ctx, const gn_dem *dem, const gn_membrane *membrane,
                       const gn_boundary *boundary, const gn_solids *solids,
                       const gn_periodic_box *box, const gn_approach *approach);

/* m2: what forces of the ends are over: between walls as they are, of a box as it is; else that of
 * the start, as where the scene gives it. */
double gn_space_area(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box);

#endif
