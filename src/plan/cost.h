/* What a step costs on this machine: a lattice with the law, the precision and the effects of a
 * scene is timed for a moment. The scene itself is not run. */
#ifndef GN_PLAN_COST_H
#define GN_PLAN_COST_H

#include "world/world.h"

/* s of a processor, all threads together. */
typedef struct gn_cost {
    double particle, contact; /* of one in a step; contacts: bonds and pairs of the lists */
    double element;           /* the same */
    double row;               /* of a particle or element, of a row of the history */
} gn_cost;

/* `mixed`: the precision. GNEISS_ERROR_INPUT: what the scene is made of does not have it. */
gneiss_status gn_cost_measure(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_solids *solids, bool mixed, gn_cost *cost,
                              gneiss_error *error);

#endif
