/* How far bodies and walls go in an automatic step. */
#ifndef GN_TIMESTEP_BODY_PATHS_H
#define GN_TIMESTEP_BODY_PATHS_H

#include "base/error.h"
#include "frame/parts.h"

#include <stdbool.h>

/* Lowers *dt (s), of the coming step, as far as bodies ask for: no vertex goes farther in it than a
 * quarter of the smallest radius, and no body turns by more than a quarter of a
 * radian, with bearings about some of its axes by 0.01. */
void gn_bodies_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                      double *dt);

/* Lowers *dt as far as walls ask for that leave particles which press them: such a wall goes at
 * most a twentieth of the smallest radius. */
void gn_walls_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                     double *dt);

/* s: as gn_bodies_follow, from the start on, where nothing else limits the step: for the fastest
 * that bodies are driven at any time, and a hundredth of what is left of the run at most. INFINITY:
 * no body moves. */
double gn_bodies_step(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary);

/* That no spin, at the start or prescribed, moves a vertex faster than light, as velocities are
 * bounded in scenes. */
gneiss_status gn_bodies_check_speeds(const gn_step_context *ctx, const gn_boundary *boundary,
                                     gneiss_error *error);

/* That no particle went bad or too far in the step (paths.c). */
gneiss_status gn_dem_check(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, bool measure, gneiss_error *error);

#endif
