/* The volume and the area that walls, a membrane or a periodic box enclose at present. */
#ifndef GN_WORLD_SPACE_H
#define GN_WORLD_SPACE_H

#include "frame/parts.h"

#include <stdbool.h>

/* Tells whether walls or periodic sides enclose the specimen along every axis. `now` and `start`
 * receive the products of the distances of opposite sides, m3 (2D: m2), at present and at the
 * start. The walls of an axis are the first two that face each other across it. */
bool gn_space_closed(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box, double *now, double *start);

/* Returns the volume to which the mean stress of the specimen refers, m3 (2D: m2 x 1 m): the
 * present volume inside walls, a membrane or a periodic box; in an oedometer test the volume by the
 * positions of its ends; otherwise the volume at the start. */
double gn_space_volume(const gn_step_context *ctx, const gn_dem *dem, const gn_membrane *membrane,
                       const gn_boundary *boundary, const gn_solids *solids,
                       const gn_periodic_box *box, const gn_approach *approach);

/* Returns the area to which forces of the ends refer, m2: the present area between walls or of a
 * periodic box; otherwise the area at the start, which the scene may give. */
double gn_space_area(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     const gn_periodic_box *box);

/* Returns the shortening along an axis of the walls or the periodic box that enclose the specimen,
 * over their distance at the start; NaN: nothing encloses it along the axis. */
double gn_space_shortening(const gn_step_context *ctx, const gn_boundary *boundary,
                           const gn_periodic_box *box, int axis);

#endif
