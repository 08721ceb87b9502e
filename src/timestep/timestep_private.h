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

/* Creates springs, for the stability limit, of the particles that touch surfaces or are within
 * `reach` of them; the caller frees them. */
gneiss_status gn_surface_springs(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, double reach,
                                 gn_extra_spring **springs, size_t *count, gneiss_error *error);
/* Finds the expected overlaps of the present contacts (indentation.c). */
void gn_pressed_update(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary);
/* Tells whether the residual of the ledger in a measured step is larger than debris may cause
 * (debris.c). */
bool gn_debris_exceeds_ledger(const gn_ledger *ledger);
/* Counts the intact bonds of each particle in left [particles], which must be zero: 0, 1, or 2 for
 * two and more. */
void gn_bonds_left(const gn_dem *dem, uint8_t *left);
/* Keeps, of the particles marked in `adrift` [particles] because they have at most one bond, only
 * those that are wedged and store a relevant energy; requires ctx->choice.debris_reported. *any
 * tells whether there are some; otherwise `adrift` may be unchanged. */
gneiss_status gn_wedged_find(const gn_step_context *ctx, const gn_dem *dem, uint8_t *adrift,
                             bool *any, gneiss_error *error);
/* Raises `factor` [particles], the factors by which own masses are multiplied, until `step`
 * resolves the listed contacts. */
gneiss_status gn_resolution_masses(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, const gn_solids *solids,
                                   const gn_zones *zones, double step, double *factor,
                                   gneiss_error *error);
/* Finds the factors of masses with which the springs of the particles are stable at `step`
 * (gn_step_masses): the active springs or, with `listed`, all springs of the lists. */
gneiss_status gn_timestep_masses(const gn_step_context *ctx, const gn_dem *dem,
                                 const gn_boundary *boundary, bool listed, double step,
                                 const uint8_t *changed, double *factor, gneiss_error *error);
/* Called when new springs, active or listed, need a smaller step than that for which masses were
 * raised. Raises the masses of the particles at them [particles] and of their neighbours as far as
 * their own blocks require it, at their present velocities (the kinetic energy is booked as
 * step_change). Does nothing without time.mass_scaling and before the first step. `held`: s, the
 * step at which their blocks are stable afterwards; 0: unknown. */
gneiss_status gn_timestep_follow_masses(gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                        gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                        bool listed, const uint8_t *changed, double *held,
                                        gneiss_error *error);
/* Finds the shortest contact of any two distinct particles of the scene, or of a particle and a
 * wall or surface, wherever they are; also the stability limit of a single such contact, s. */
gneiss_status gn_flight_limits(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, double *stable,
                               gn_resolution *resolution, gneiss_error *error);
/* Returns the limit, s, of the particles together with the surfaces that they can displace;
 * `particles` is the limit of the particles alone (step_limit.c). */
double gn_limit_beside_surfaces(const gn_step_context *ctx, const gn_dem *dem, double particles);
/* Returns the limit, s, that the particles need so that the limit of all parts is `step`; INFINITY:
 * there is none. */
double gn_limit_needed(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       const gn_zones *zones, double step);
/* The step is not lowered while it is at most this fraction of the limit of rotated contacts; the
 * rest is a margin until the next lists. */
#define GN_TURNED_SHARE 0.95

/* Calls `use` with the linearised system of the particles: with the active springs or, with
 * `listed`, with all springs of the lists. */
typedef gneiss_status gn_spectrum_user(const gn_spectrum *spectrum, void *context,
                                       gneiss_error *error);
gneiss_status gn_timestep_with_spectrum(const gn_step_context *ctx, const gn_dem *dem,
                                        const gn_boundary *boundary, bool listed,
                                        gn_spectrum_user *use, void *context, gneiss_error *error);

#endif
