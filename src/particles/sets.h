/* Sets of particles. */
#ifndef GN_PARTICLES_SETS_H
#define GN_PARTICLES_SETS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>

/* Tells whether a set contains a particle, by its position at the start. */
bool gn_set_selected(const gn_step_context *ctx, const gn_dem *dem, size_t set, size_t particle);
/* gn_sets_assign sets the materials and groups of the particles of each set; gn_sets_apply, called
 * when masses are known, sets their motions and forces. */
gneiss_status gn_sets_assign(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
gneiss_status gn_sets_apply(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Updates motions and forces of sets from the scene of another stage. */
gneiss_status gn_sets_enter(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Distributes the forces of sets to their particles. */
void gn_sets_push(const gn_step_context *ctx, gn_dem *dem);
/* gn_prescription_update sets the velocities of prescribed particles; gn_reactions_sum adds up the
 * reactions of sets. */
void gn_prescription_update(const gn_step_context *ctx, gn_dem *dem, double time);
void gn_reactions_sum(const gn_step_context *ctx, gn_dem *dem);

#endif
