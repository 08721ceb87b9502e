/* Number and order of the rows of particles. The caller renumbers references to rows in other
 * parts, by the indices that these functions return. */
#ifndef GN_PARTICLES_ROWS_H
#define GN_PARTICLES_ROWS_H

#include "base/error.h"
#include "frame/parts.h"
#include "particles/flow.h"

#include <stddef.h>
#include <stdint.h>

/* Sorts particles along the Morton curve, and renumbers the lists; place[rows]: the new index of
 * each. */
gneiss_status gn_dem_sort(const gn_step_context *ctx, gn_dem *dem, int32_t *place,
                          gneiss_error *error);
/* Appends rows for new particles. Lists must be made next. */
gneiss_status gn_dem_grow(const gn_step_context *ctx, gn_dem *dem, const gn_arrival *arrivals,
                          size_t count, gneiss_error *error);
/* Drops the rows of removed particles, except those in persistent lists, if they are more than a
 * sixteenth. *place [rows]: the new index of each row, -1: none, freed by the caller; NULL: all
 * rows stay. The caller must rebuild the lists afterwards. */
gneiss_status gn_dem_drop(const gn_step_context *ctx, gn_dem *dem, int32_t **place,
                          gneiss_error *error);
/* Allocates and fills the rows of ids (gn_dem_number_ids). */
gneiss_status gn_dem_number_rows(gn_dem *dem, gneiss_error *error);

#endif
