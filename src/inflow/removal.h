/* Sinks, the removal of particles, and room for new ones. */
#ifndef GN_INFLOW_REMOVAL_H
#define GN_INFLOW_REMOVAL_H

#include "base/error.h"
#include "frame/parts.h"
#include "particles/flow.h"

#include <stdint.h>

/* Finds the particles outside the domain and in sinks: *gone [particles] is nonzero for them and
 * freed by the caller; NULL: there are none. Books the energy of their contacts as carried away.
 * GNEISS_ERROR_UNSTABLE if the scene does not let particles leave the domain. Must be called with
 * the lists of the last step. */
gneiss_status gn_particles_find_gone(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                     gn_ledger *ledger, int32_t **gone, gneiss_error *error);
/* Removes the marked particles from the model, with their mass and contacts, after other parts have
 * released them. */
gneiss_status gn_particles_take_out(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger,
                                    const int32_t *gone, gneiss_error *error);

/* Tells whether a sink that is thin compared with the paths for which lists are valid has a
 * particle to remove; such sinks are checked in every step. */
bool gn_sinks_are_due(const gn_step_context *ctx, const gn_dem *dem);

/* Tells whether there are particles that never are entirely inside a sink, and writes a message to
 * `text`. */
bool gn_sink_is_too_thin(const gn_step_context *ctx, const gn_dem *dem, size_t sink, char *text,
                         size_t size);

#endif
