/* Walls that elements would go through, as they have no contact with each other: which, and when
 * (element_walls.c). Beside `couple` alone, where elements are a part of the body that walls press.
 */
#ifndef GN_SOLIDS_ELEMENT_WALLS_H
#define GN_SOLIDS_ELEMENT_WALLS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

typedef struct gn_wall_passed {
    size_t touching; /* nodes of elements on it at the start that no motion holds against it */
    size_t behind;   /* the most that are behind it */
    double deepest;  /* m, of these */
    double time;     /* s, from when on; 0: from the start */
} gn_wall_passed;

/* Of a wall now; time: that of now. */
gn_wall_passed gn_wall_passed_now(const gn_step_context *ctx, const gn_boundary *boundary,
                                  const gn_solids *solids, size_t wall);
/* [walls] of a run that has not begun: at rest under motions and loads, of fixed zones under
 * motions alone, as particles bear the loads with the elements. Leaves the world as it was. */
gneiss_status gn_wall_foresee_passed(gn_world *world, gn_wall_passed *passed, gneiss_error *error);

#endif
