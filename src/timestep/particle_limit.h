/* Stability limit of the particles. */
#ifndef GN_TIMESTEP_PARTICLE_LIMIT_H
#define GN_TIMESTEP_PARTICLE_LIMIT_H

#include "base/error.h"
#include "frame/parts.h"
#include "limit/equilibrium.h"
#include "limit/step_limits.h"

#include <stdbool.h>

/* Calls `use` with the linearised system of the particles: of the springs that act or, with
 * `listed`, of all that the lists hold. */
typedef gneiss_status gn_spectrum_user(const gn_spectrum *spectrum, void *context,
                                       gneiss_error *error);
gneiss_status gn_dem_with_spectrum(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_boundary *boundary, bool listed, gn_spectrum_user *use,
                                   void *context, gneiss_error *error);

/* Finds the displacements that bring the linearised system into equilibrium with `load`, see
 * gn_equilibrium_solve.
 * `slips`: see gn_spectrum, `rate`: gn_viscosity. */
gneiss_status gn_dem_relax(const gn_step_context *ctx, const gn_dem *dem,
                           const gn_boundary *boundary, const uint8_t *slips, double rate,
                           const double *load, double tolerance, gn_preconditioner *made, double *u,
                           gn_equilibrium *found, gneiss_error *error);
/* The limit of the particles alone (particle_limit.c): of what has come to act since the last look,
 * or, `full`, of all. *due: it has changed, or that of what they touch. */
gneiss_status gn_dem_limit(gn_world *world, bool full, bool *due, gneiss_error *error);
/* The limit of the particles whose contacts have turned since the last look. */
gneiss_status gn_dem_limit_turned(gn_world *world, bool *due, gneiss_error *error);
/* Finds whether the step of the world is stable with all listed contacts in touch; otherwise
 * dem.listed is a step that is. `full`: considers all contacts. */
gneiss_status gn_dem_limit_listed(gn_world *world, bool full, bool *fine, gneiss_error *error);
/* Finds whether the step is so short that the sums of stiffness of near contacts prove it stable,
 * without a look at changes. */
gneiss_status gn_dem_limit_far(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_boundary *boundary, const gn_solids *solids,
                               const gn_zones *zones, bool *far, gneiss_error *error);
/* The shortest collision among what is listed; among all of the scene, when nothing is listed that
 * collides. *shorter: than known before. */
gneiss_status gn_dem_resolve_listed(const gn_step_context *ctx, gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    const gn_zones *zones, bool *shorter, gneiss_error *error);
gneiss_status gn_dem_resolve_flight(const gn_step_context *ctx, gn_dem *dem,
                                    const gn_boundary *boundary, bool *shorter,
                                    gneiss_error *error);
/* Forgets what was found of lists and collisions. */
void gn_dem_limit_anew(gn_dem *dem);

#endif
