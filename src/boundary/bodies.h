/* Rigid bodies: frames and orientation. */
#ifndef GN_BOUNDARY_BODIES_H
#define GN_BOUNDARY_BODIES_H

#include "base/error.h"
#include "boundary/surface.h"
#include "frame/parts.h"

/* v . I^-1 v about the centre. */
double gn_rigid_compliance(const gn_rigid *body, const double v[3]);
/* Surfaces of bodies from the arrays that a checkpoint stores as well. */
gneiss_status gn_bodies_surfaces(const gn_step_context *ctx, gn_boundary *boundary,
                                 gn_solids *solids, gneiss_error *error);
/* Orientation from the start, w x y z with w >= 0. */
void gn_rigid_orientation(const gn_rigid *body, double turn[4]);

#endif
