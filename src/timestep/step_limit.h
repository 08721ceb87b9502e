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

/* The limits of the parts together (step_limit.c), s: of all, from that of the particles alone; of
 * particles and the surfaces that give way to them; and the other way round, the limit of the
 * particles at which `step` is that of all, INFINITY: none would do. */
double gn_limit_of_all(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, const gn_zones *zones, double particles);
/* s: the limits of the particles and all bodies of elements, each by itself: the least, undamped.
 */
double gn_world_sharp_limit(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                            const gn_zones *zones);
double gn_world_bound(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                      const gn_zones *zones);
/* Checks the stability limit and lowers an automatic step (step_limit.c). `full`: Lanczos even if
 * the rigorous bound is above the step. */
gneiss_status gn_world_check_step(gn_world *world, bool full, gneiss_error *error);
/* Finds the limit of loose grains as they lie at the end of a run, long after the last look maybe:
 * for what is written, when the state has been saved. The step stays. */
gneiss_status gn_world_last_look(gn_world *world, gneiss_error *error);
/* What gn_world_check_step does after a step in which bonds broke, for a specimen that may have
 * come apart by it. */
gneiss_status gn_world_check_apart(gn_world *world, int64_t broken_before, gneiss_error *error);
/* The same after a step that was measured because of debris: what of it makes energy counts. */
gneiss_status gn_world_check_debris(gn_world *world, gneiss_error *error);
/* The same for what the lists, just made, let happen before they are made again. */
gneiss_status gn_world_check_lists(gn_world *world, gneiss_error *error);
/* Lowers an automatic step as bodies ask for that move far in it (body_paths.h). */
void gn_world_follow_bodies(gn_step_context *ctx, gn_dem *dem, const gn_boundary *boundary);
/* What is to be said of a given step: that it does not resolve collisions, or that contacts which
 * may form need a smaller one. "" : nothing. */
const char *gn_world_step_warning(const gn_step_context *ctx, const gn_dem *dem, char *text,
                                  size_t size);
/* What non-viscous damping leaves of the limit, 1 without it. */
double gn_world_nonviscous_share(const gn_step_context *ctx);
/* Of a scene that calls for these effects. */
double gn_scene_nonviscous_share(const gn_scene *scene, gn_effects effects);

#endif
