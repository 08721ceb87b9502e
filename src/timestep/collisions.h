/* Time step that resolves collisions. */
#ifndef GN_TIMESTEP_COLLISIONS_H
#define GN_TIMESTEP_COLLISIONS_H

#include "base/error.h"
#include "frame/parts.h"
#include "particles/dem.h"

#include <stdbool.h>
#include <stddef.h>

/* The shortest contact that can begin before the lists are made again. */
gneiss_status gn_resolution_listed(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, gn_resolution *resolution,
                                   gneiss_error *error);
/* Tells whether collisions are hardly damped. */
bool gn_world_rings(const gn_step_context *ctx, const gn_dem *dem);
/* Steps that a collision must last. */
double gn_world_contact_steps(const gn_step_context *ctx);
/* Names the two bodies of the shortest collision. */
const char *gn_resolution_text(const gn_step_context *ctx, const gn_dem *dem, char *text,
                               size_t size);

#endif
