/* The volume and the area that walls, a membrane or a periodic box enclose at present. */
#ifndef GN_WORLD_SPACE_H
#define GN_WORLD_SPACE_H

#include "frame/parts.h"

#include <stdbool.h>

/* Tells whether walls or periodic sides close the specimen in along every axis; `now` and `start`:
 * their distances, m, multiplied. Walls are the first two across an axis that face each other. */
bool gn_space_closed(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box, double *now, double *start);

/* Returns the volume to which the mean stress of the specimen refers, m3 (2D: m2 x 1 m): the
 * present one of enclosing walls, of a membrane or of a periodic box; of an oedometer test by the
 * positions of its ends; else that at the start. */
double gn_space_volume(const gn_step_context *ctx, const gn_dem *dem, const gn_membrane *membrane,
                       const gn_boundary *boundary, const gn_solids *solids,
                       const gn_periodic_box *box, const gn_approach *approach);

/* Returns the area to which forces of the ends refer, m2: the present one between walls or of a
 * periodic box; else that at the start, also if the scene gives it. */
double gn_space_area(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box);

#endif
