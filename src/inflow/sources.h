/* Particles that sources create. */
#ifndef GN_INFLOW_SOURCES_H
#define GN_INFLOW_SOURCES_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a particle of a source is due and the lists are old enough to be rebuilt for it. */
bool gn_flow_due(const gn_step_context *ctx, const gn_dem *dem);

/* Inserts the particles that are due, as far as there is room for them. At the start (`first`)
 * there must be room for all. */
gneiss_status gn_flow_arrive(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             gn_ledger *ledger, bool first, gneiss_error *error);

/* gn_flow_behind returns the time, s, by which the inflow of source k is late; gn_flow_is_behind
 * tells whether that is more than a hundredth of the time and more than one particle. */
double gn_flow_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k);

bool gn_flow_is_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k);

/* Returns the number of particles that source k creates between two checks, which are missing at
 * the end of a run if the source is then still active; 0: at most one, or at most a hundredth of
 * all. */
double gn_flow_late(const gn_step_context *ctx, const gn_dem *dem, size_t k);

/* Returns the number of particles that source k creates until time.end by its rate, at most its
 * total. */
double gn_flow_expected(const gn_step_context *ctx, const gn_dem *dem, size_t k);

/* Tells whether a source will create more particles until time.end; it does not count if there was
 * no room at its last attempt. */
bool gn_flow_brings(const gn_step_context *ctx, const gn_dem *dem);

/* Returns the wall behind which the whole region of source k lies; NULL: there is none. */
const char *gn_flow_wall_before(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t k);

#endif
