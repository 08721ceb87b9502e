/* Choice and supervision of the time step. */
#ifndef GN_TIMESTEP_STEP_LIMIT_H
#define GN_TIMESTEP_STEP_LIMIT_H

#include "base/effects.h"
#include "base/error.h"
#include "frame/parts.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* s: limit of all parts together, from that of the particles alone (step_limit.c). */
double gn_limit_of_all(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, double particles);
/* s: the limits of the particles and all bodies of elements, each by itself: the least, undamped.
 */
double gn_world_sharp_limit(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_zones *zones);
double gn_world_bound(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids);
/* Checks the stability limit and lowers an automatic step (step_limit.c). `full`: Lanczos even if
 * the rigorous bound is above the step. */
gneiss_status gn_world_check_step(gn_world *world, bool full, gneiss_error *error);
/* Updates the limit of loose grains at the end of a run for the output, after the state has been
 * saved. The step is unchanged. */
gneiss_status gn_world_last_look(gn_world *world, gneiss_error *error);
/* Checks the step, as gn_world_check_step does, after a step in which bonds broke: the specimen may
 * have come apart. */
gneiss_status gn_world_check_apart(gn_world *world, int64_t broken_before, gneiss_error *error);
/* Checks the step after one that was measured because of debris: debris that makes energy counts.
 */
gneiss_status gn_world_check_debris(gn_world *world, gneiss_error *error);
/* Checks the step against all events that are possible until the new lists are made again. */
gneiss_status gn_world_check_lists(gn_world *world, gneiss_error *error);
/* Lowers an automatic step as bodies ask for that move far in it (body_paths.h). */
void gn_world_follow_bodies(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary);
/* Writes the warning about a given step: it does not resolve collisions, or contacts that may form
 * need a smaller one. "": there is none. */
const char *gn_world_step_warning(const gn_step_context *ctx, const gn_dem *dem, char *text,
                                  size_t size);
/* Share of the limit that non-viscous damping leaves; 1 without it. */
double gn_world_nonviscous_share(const gn_step_context *ctx);
/* The share for a scene with these effects. */
double gn_scene_nonviscous_share(const gn_scene *scene, gn_effects effects);

#endif
