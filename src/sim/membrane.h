/* Pressure on the surface of a packed specimen, as of a cell: dead loads on its skin particles that
 * may follow the deformation. */
#ifndef GN_SIM_MEMBRANE_H
#define GN_SIM_MEMBRANE_H

#include "sim/world.h"

/* Finds the skin and what of the surface each of its particles has (membrane_skin.c). Call with
 * masses and sets applied. Does nothing without a membrane. */
gneiss_status gn_membrane_create(gn_world *world, gneiss_error *error);

/* The least change of the areas after which their moment about 0, with particles where they were at
 * the start, is `moment`, m3 (0: none). */
void gn_membrane_balance(gn_world *world, const double moment[3]);

/* The skin of particles without a shape, by what a ball of the radius `probe` touches from outside
 * (membrane_free.c). */
gneiss_status gn_membrane_free_skin(gn_world *world, double probe, gneiss_error *error);

/* Applied forces of the instant; before the forces of a step. */
void gn_membrane_press(gn_world *world);

/* Pa: of the last step; what it adds to the mean stress of the specimen, between centres and
 * surface.
 */
double gn_membrane_pressure(const gn_world *world);
void gn_membrane_stress(const gn_world *world, double stress[9]);

/* m2: what it covers, at the start; of particles that have not broken off. */
double gn_membrane_area(const gn_world *world);

/* c = adj(a)^T: what turns and stretches areas as a does lengths (Nanson: J F^-T dA). */
void gn_cofactor3(const double a[9], double c[9]);

#endif
