/* What a test says of its specimen's size, held against the specimen. */
#ifndef GN_LABORATORY_GEOMETRY_H
#define GN_LABORATORY_GEOMETRY_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Whether length, area, diameter or thickness of a test are off by more than a tenth of what the
 * specimen has at the start, or a beam by a hundredth (laboratory/bending.h). `text` then has each
 * with both numbers, else it is "". */
bool gn_geometry_doubts(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                        const gn_solids *solids, char *text, size_t size);

/* GNEISS_ERROR_INPUT where a disc, or a specimen between platens under a pressure or in an
 * oedometer, has nothing like them: less than half or more than twice. After all parts are made. */
gneiss_status gn_geometry_check(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, const gn_solids *solids,
                                gneiss_error *error);

/* m: extent at the start of what is tested: of the particles, radii included, and of the elements
 * that are one body with them (`couple`), which may be packed in a part of it alone. */
void gn_world_body(const gn_step_context *ctx, const gn_solids *solids, double lower[3],
                   double upper[3]);

double gn_world_side(const gn_step_context *ctx, const gn_solids *solids, int axis);

#endif
