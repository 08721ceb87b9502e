/* Cost of a step on this machine: a lattice with the law, the precision and the effects of a scene
 * is timed briefly. The scene itself is not run. */
#ifndef GN_PLAN_COST_H
#define GN_PLAN_COST_H

#include "frame/parts.h"
#include "world/world.h"

/* Processor time in s, summed over threads. */
typedef struct gn_cost {
    double particle, contact; /* per item and step; contacts are bonds and pairs of the lists */
    double element;           /* per element and step */
    double row;               /* per particle or element, and row of the history */
} gn_cost;

/* Measures the cost; `mixed` is the precision. GNEISS_ERROR_INPUT: parts of the scene do not
 * support it. */
gneiss_status gn_cost_measure(const gn_step_context *ctx, const gn_dem *dem,
                              const gn_solids *solids, bool mixed, gn_cost *cost,
                              gneiss_error *error);

#endif
