/* Particles that sources bring. */
#ifndef GN_INFLOW_SOURCES_H
#define GN_INFLOW_SOURCES_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a source has a particle that is due and the lists are old enough to be rebuilt for
 * it. */
bool gn_flow_due(const gn_step_context *ctx, const gn_dem *dem);

/* Inserts the particles that are due as far as they find room. At the start (`first`) all of them
 * must find room. */
gneiss_status gn_flow_arrive(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             gn_ledger *ledger, bool first, gneiss_error *error);

/* Return the time, s, by which the inflow is late, and whether that is more than a hundredth of the
 * time and more than one particle. */
double gn_flow_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k);

bool gn_flow_is_behind(const gn_step_context *ctx, const gn_dem *dem, size_t k);

/* Particles that source k brings between two checks, which are missing at the end of a run during
 * which it is still active; 0: at most one, or a hundredth of all that it brings. */
double gn_flow_late(const gn_step_context *ctx, const gn_dem *dem, size_t k);

/* Particles that source k brings until time.end by its rate, at most its total. */
double gn_flow_expected(const gn_step_context *ctx, const gn_dem *dem, size_t k);

/* Tells whether a source will bring more particles until time.end, and was not without room when it
 * last tried. */
bool gn_flow_brings(const gn_step_context *ctx, const gn_dem *dem);

/* Returns the wall behind which the whole region of source k lies; NULL: there is none. */
const char *gn_flow_wall_before(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, size_t k);

#endif
