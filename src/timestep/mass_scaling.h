/* Masses raised for a longer step. */
#ifndef GN_TIMESTEP_MASS_SCALING_H
#define GN_TIMESTEP_MASS_SCALING_H

#include "base/error.h"
#include "frame/parts.h"

/* Raises masses, if the scene says so, from the step that the world has found without. */
gneiss_status gn_dem_scale_masses(gn_world *world, gneiss_error *error);
/* Predicts the result for a step (s, safety included) with time.estimate: bound: the step over that
 * of the bound with own masses, and the added mass over the own one; INFINITY: other parts do not
 * permit such a step. */
gneiss_status gn_dem_predict_masses(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_boundary *boundary, const gn_solids *solids,
                                    const gn_zones *zones, double step, double *of_bound,
                                    double *added, gneiss_error *error);
/* Returns the kinetic energy of the added mass, with the velocities of the last half step. */
double gn_dem_added_kinetic(const gn_dem *dem);

#endif
