/* Parameters of contacts: the contact law applied to the particles of a world. */
#ifndef GN_PARTICLES_LAW_H
#define GN_PARTICLES_LAW_H

#include "frame/parts.h"
#include "kernels/law.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <stddef.h>
#include <stdint.h>

/* The largest stiffness that two particles can show which meet, and that a contact can show, before
 * the lists are made again. */
gn_law_spring gn_pair_spring(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j);
gn_law_spring gn_contact_spring(const gn_dem *dem, const gn_contacts *list, size_t c);
/* Returns the inverse mass of a particle along a unit vector, 1/kg; prescribed components count as
 * infinite mass. */
double gn_inverse_mass_along(const gn_dem *dem, size_t particle, const double n[3]);
/* Damping fraction alpha of a restitution, and of the scene's contacts; 0: none. */
double gn_restitution_fraction(double restitution);
double gn_contact_damping_fraction(const gn_scene *scene);
/* m2, in 2D m x 1 m, that stresses of a contact are over (law.c): of two particles, `overlap` m;
 * of one with walls and surfaces. */
double gn_contact_area(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t c, double overlap);
double gn_touch_area(const gn_step_context *ctx, const gn_dem *dem, size_t particle,
                     double overlap);

#endif
