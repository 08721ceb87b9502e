/* Sinks, removal of particles, and rows for new ones. */
#ifndef GN_INFLOW_REMOVAL_H
#define GN_INFLOW_REMOVAL_H

#include "base/error.h"
#include "frame/parts.h"
#include "particles/flow.h"

#include <stdint.h>

/* Finds the particles outside of the domain and in sinks: *gone [particles], nonzero for them, is
 * freed by the caller; NULL: there are none. Books the energy of their contacts as carried away.
 * GNEISS_ERROR_UNSTABLE if the scene does not allow particles to leave the domain. Must be called
 * with the lists of the last step. */
gneiss_status gn_particles_find_gone(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                     gn_ledger *ledger, int32_t **gone, gneiss_error *error);
/* Removes the marked particles from the model with their mass and contacts. Other parts must have
 * released them before. */
gneiss_status gn_particles_take_out(const gn_step_context *ctx, gn_dem *dem, gn_ledger *ledger,
                                    const int32_t *gone, gneiss_error *error);

/* Tells whether a thin sink has a particle to remove. A sink is thin relative to the paths for
 * which lists are valid; such sinks are checked in every step. */
bool gn_sinks_are_due(const gn_step_context *ctx, const gn_dem *dem);

/* Tells whether some particles can never be entirely inside a sink, and writes a message to `text`.
 */
bool gn_sink_is_too_thin(const gn_step_context *ctx, const gn_dem *dem, size_t sink, char *text,
                         size_t size);

#endif
