/* Facets near particles. */
#ifndef GN_BOUNDARY_SURFACE_LISTS_H
#define GN_BOUNDARY_SURFACE_LISTS_H

#include "boundary/surface.h"
#include "frame/parts.h"

#include <stddef.h>

/* The surface that a row belongs to. */
const gn_surface *gn_surface_of_row(const gn_step_context *ctx, const gn_boundary *boundary,
                                    size_t row);
/* A point, a direction from the body's frame, and back. */
void gn_rigid_place(const gn_rigid *body, const double local[3], double point[3]);
void gn_rigid_direct(const gn_rigid *body, const double local[3], double direction[3]);
void gn_rigid_local(const gn_rigid *body, const double direction[3], double local[3]);

#endif
