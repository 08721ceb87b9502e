/* Neighbour lists: their skin, and their construction. */
#ifndef GN_PARTICLES_REFRESH_H
#define GN_PARTICLES_REFRESH_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Tells whether the particles should be sorted again. */
bool gn_dem_order_is_old(const gn_step_context *ctx, const gn_dem *dem);
/* Wraps particles, and their positions at the start, into the periodic box. */
void gn_dem_wrap(const gn_step_context *ctx, gn_dem *dem);

/* Adapts the skin to the lifetime of the last lists. */
void gn_dem_tune_skin(const gn_step_context *ctx, gn_dem *dem);
/* Widens the skin to `gap`, m, the largest distance by which two objects that may touch moved apart
 * in the last step. */
void gn_dem_widen_skin(const gn_step_context *ctx, gn_dem *dem, double gap);
/* Makes the next lists keep the skin, because their construction was not caused by motion. */
void gn_dem_keep_skin(const gn_step_context *ctx, gn_dem *dem);
/* Records whether the next lists are made although the motion does not require it, so that their
 * lifetime does not affect the skin. */
void gn_dem_force_lists(gn_dem *dem, bool forced);
/* Sets the bounds on paths since the lists were made, from the longest one, m. */
void gn_dem_set_paths(gn_dem *dem, double most);

/* Makes the lists for the present positions. */
gneiss_status gn_dem_make_lists(const gn_step_context *ctx, gn_dem *dem, const gn_periodic_box *box,
                                gneiss_error *error);
/* Allocates the sums of blocks and distributes the blocks of the lists among threads. */
gneiss_status gn_dem_ready_blocks(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Prepares the data that kernels read besides the records, once lists and `ref` are complete. */
void gn_dem_ready_kernels(const gn_step_context *ctx, gn_dem *dem);

#endif
