/* Contribution of surfaces to the stability limit. */
#ifndef GN_TIMESTEP_SURFACE_LIMIT_H
#define GN_TIMESTEP_SURFACE_LIMIT_H

#include "boundary/surface.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a surface gives way to particles; its largest inverse mass, 1/kg. */
bool gn_surface_yields(const gn_boundary *boundary, const gn_surface *surface);
double gn_surface_give(const gn_boundary *boundary, const gn_surface *surface);
/* Names the free body whose contacts need steps a thousand times shorter than those of all other
 * parts, because it is light or stiff. "": there is none. */
const char *gn_world_light_body(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, char *text, size_t size);

#endif
