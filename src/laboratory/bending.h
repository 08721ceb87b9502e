/* What a bending test says of its beam, held against the beam. */
#ifndef GN_LABORATORY_BENDING_H
#define GN_LABORATORY_BENDING_H

#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Whether span, load_span, height, notch or thickness of a bending test are off by more than a
 * hundredth of what the scene shows: where supports and loads hold the specimen at the start, and
 * its extent. `text` then has each with both numbers, else it is "". */
bool gn_bending_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, char *text, size_t size);

/* Whether all of the upper end is beside all of the lower one along the beam: no support, or no
 * load, is between. False where a wall is among them. */
bool gn_bending_outside(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids);

#endif
