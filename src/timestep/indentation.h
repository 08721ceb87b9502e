/* Expected overlap of Hertz contacts, and the largest overlap of contacts without a bond. */
#ifndef GN_TIMESTEP_INDENTATION_H
#define GN_TIMESTEP_INDENTATION_H

#include "base/error.h"
#include "frame/parts.h"

#include <stddef.h>

/* Updates the expected overlaps and the step if a kernel has found a larger overlap. */
gneiss_status gn_pressed_check(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                               gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                               gneiss_error *error);

/* Updates dem->depth from the listed contacts at the present positions, when lists are made and in
 * measured steps some steps later. Contacts both of whose sides are fixed are skipped. */
gneiss_status gn_depth_update(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                              gneiss_error *error);
gneiss_status gn_depth_update_when_due(const gn_step_context *ctx, gn_dem *dem,
                                       gn_boundary *boundary, gneiss_error *error);

/* Writes the names of the two sides of the contact. */
const char *gn_depth_text(const gn_step_context *ctx, const gn_dem *dem, char *text, size_t size);

#endif
