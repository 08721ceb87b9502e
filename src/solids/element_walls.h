/* Walls that elements pass through, because elements have no contact with walls, and when this
 * happens (element_walls.c). Only with `couple`, where elements are a part of the loaded body. */
#ifndef GN_SOLIDS_ELEMENT_WALLS_H
#define GN_SOLIDS_ELEMENT_WALLS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

typedef struct gn_wall_passed {
    size_t touching; /* number of nodes of elements on the wall at the start that no motion holds
                        there */
    size_t behind;   /* largest number of nodes behind the wall */
    double deepest;  /* m, largest depth of these nodes */
    double time;     /* s, first time at which a node is behind; 0: from the start */
} gn_wall_passed;

/* Returns the counts for a wall at its present position and time. */
gn_wall_passed gn_wall_passed_now(const gn_step_context *ctx, const gn_boundary *boundary,
                                  const gn_solids *solids, size_t wall);
/* Predicts for each of passed[walls], before a run has begun, which nodes will be behind the wall:
 * all nodes at the start; later driven nodes, by the motions of the first stage. Walls with a servo
 * count as fixed. */
gneiss_status gn_wall_predict_passed(const gn_step_context *ctx, const gn_solids *solids,
                                     gn_wall_passed *passed, gneiss_error *error);

#endif
