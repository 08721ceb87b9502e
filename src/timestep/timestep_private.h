/* Functions that the files of this folder share. */
#ifndef GN_TIMESTEP_TIMESTEP_PRIVATE_H
#define GN_TIMESTEP_TIMESTEP_PRIVATE_H

#include "base/error.h"
#include "frame/parts.h"
#include "limit/step_limits.h"
#include "particles/particles.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Springs of the particles that touch surfaces, or are within `reach` of them, for the stability
 * limit; the caller frees them. */
gneiss_status gn_surface_springs(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, double reach,
                                 gn_extra_spring **springs, size_t *count, gneiss_error *error);
/* Finds the expected overlaps of the present contacts (indentation.c). */
void gn_pressed_update(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary);
/* Tells whether the ledger of a measured step misses more than debris may (debris.c). */
bool gn_debris_exceeds_ledger(const gn_ledger *ledger);
/* Adds up the intact bonds of each particle into left [particles], which holds zeros: 0, 1, or 2
 * for more. */
void gn_bonds_left(const gn_dem *dem, uint8_t *left);
/* Reduces the particles with one bond at most (`adrift` 1, [particles]) to those that are wedged
 * and store a relevant energy, if ctx->choice.debris_reported. *any tells whether there are some;
 * otherwise `adrift` may be unchanged. */
gneiss_status gn_wedged_find(const gn_step_context *ctx, const gn_dem *dem, uint8_t *adrift,
                             bool *any, gneiss_error *error);
/* Raises `factor` [particles] to the factor of own masses at which `step` resolves the listed
 * contacts. */
gneiss_status gn_resolution_masses(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, double step, double *factor,
                                   gneiss_error *error);
/* Finds the factors at which the springs of the particles are stable at `step` (gn_step_masses):
 * the active springs or, with `listed`, all that the lists hold. */
gneiss_status gn_dem_masses(const gn_step_context *ctx, const gn_dem *dem,
                            const gn_boundary *boundary, bool listed, double step,
                            const uint8_t *changed, double *factor, gneiss_error *error);
/* After new springs, active or listed, that need a smaller step than masses were raised for: raises
 * the masses of these particles [particles] and their neighbours as far as their own blocks need
 * it, at their present velocities (the kinetic energy is booked as step_change). Does nothing
 * without time.mass_scaling and before the first step. `held`: s, the step at which their blocks
 * hold then; 0: not known. */
gneiss_status gn_dem_follow_masses(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                   gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                   bool listed, const uint8_t *changed, double *held,
                                   gneiss_error *error);
/* Finds the shortest contact of any two distinct particles, or particle and wall or surface, of the
 * scene, wherever they are, and the stability limit of one such contact alone, s. */
gneiss_status gn_flight_limits(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, double *stable,
                               gn_resolution *resolution, gneiss_error *error);
/* Returns the limit, s, of the particles and of the surfaces that yield to them, from that of the
 * particles alone (step_limit.c). */
double gn_limit_beside_surfaces(const gn_step_context *ctx, const gn_dem *dem, double particles);
/* Returns the limit of the particles, s, at which `step` is the limit of all parts; INFINITY: there
 * is none. */
double gn_limit_needed(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_zones *zones, double step);
/* Least share of its limit that rotated contacts leave until the next lists. */
#define GN_TURNED_SHARE 0.95

/* Calls `use` with the linearised system of the particles: of the springs that act or, with
 * `listed`, of all that the lists hold. */
typedef gneiss_status gn_spectrum_user(const gn_spectrum *spectrum, void *context,
                                       gneiss_error *error);
gneiss_status gn_dem_with_spectrum(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, bool listed, gn_spectrum_user *use,
                                   void *context, gneiss_error *error);

#endif
