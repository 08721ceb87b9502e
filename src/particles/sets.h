/* Sets of particles. */
#ifndef GN_PARTICLES_SETS_H
#define GN_PARTICLES_SETS_H

#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a set contains a particle, by its position at the start. */
bool gn_set_selected(const gn_step_context *ctx, const gn_dem *dem, size_t set, size_t particle);

#endif
