/* Functions that the files of this folder share. */
#ifndef GN_TIMESTEP_TIMESTEP_PRIVATE_H
#define GN_TIMESTEP_TIMESTEP_PRIVATE_H

#include "base/error.h"
#include "frame/parts.h"
#include "limit/step_limits.h"
#include "particles/dem.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Springs of the particles that touch surfaces, or are up to `reach` from them, for the stability
 * limit; the caller frees them. */
gneiss_status gn_surface_springs(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, const gn_solids *solids,
                                 const gn_zones *zones, double reach, gn_extra_spring **springs,
                                 size_t *count, gneiss_error *error);
/* Looks at what there is; and again, with the step, when a kernel has found more. */
void gn_pressed_look(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                     const gn_solids *solids, const gn_zones *zones);
/* Collisions in steps (collisions.c): particles that were not bonded at the start, into
 * world->dem.loose. */
gneiss_status gn_loose_find(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
bool gn_debris_told(const gn_ledger *ledger);
/* Bonds that hold, of each particle [particles], which are 0: 0, 1, 2 for more. */
void gn_bonds_left(const gn_dem *dem, uint8_t *left);
/* Of particles that hang on one bond at most (`adrift` 1, [particles]) leaves those that are wedged
 * with energy that matters, where world->dem.debris_told; *any: there are some, else `adrift` may
 * be what it was. */
gneiss_status gn_wedged_find(const gn_step_context *ctx, const gn_dem *dem, uint8_t *adrift,
                             bool *any, gneiss_error *error);
/* By what factor own masses [particles] have to be multiplied for `step` to resolve these contacts:
 * the larger of that and `factor`. */
gneiss_status gn_resolution_masses(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, double step, double *factor,
                                   gneiss_error *error);
gneiss_status gn_dem_masses(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, const gn_solids *solids,
                            const gn_zones *zones, bool listed, double step, const uint8_t *changed,
                            double *factor, gneiss_error *error);
/* After springs have come that ask for a smaller step than masses were raised for, of those that
 * act or of all that are listed: raises the masses of these particles [particles] and their
 * neighbours as far as their own blocks ask for more, at the velocities that they have (their
 * kinetic energy is booked as step_change). Nothing happens without time.mass_scaling and before
 * the first step.
 * `held`: s, the step at which their blocks hold then; 0: not known. */
gneiss_status gn_dem_follow_masses(gn_world *world, bool listed, const uint8_t *changed,
                                   double *held, gneiss_error *error);
/* The shortest contact of any two distinct particles of the scene, walls and surfaces, wherever
 * they are; and the stability limit of one such contact by itself, s. */
gneiss_status gn_flight_limits(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, double *stable,
                               gn_resolution *resolution, gneiss_error *error);
double gn_limit_beside_surfaces(const gn_step_context *ctx, const gn_dem *dem,
                                const gn_boundary *boundary, double particles);
double gn_limit_needed(const gn_step_context *ctx, const gn_dem *dem, const gn_boundary *boundary,
                       const gn_solids *solids, const gn_zones *zones, double step);
/* What has turned may leave so much of the step that it had until the next lists. */
#define GN_TURNED_SHARE 0.95

#endif
