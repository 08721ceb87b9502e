/* Parameters of contacts: the contact law applied to particles. */
#ifndef GN_PARTICLES_LAW_H
#define GN_PARTICLES_LAW_H

#include "base/error.h"
#include "frame/parts.h"
#include "kernels/law.h"
#include "neigh/neigh.h"
#include "scene/scene.h"
#include "soa/records.h"

#include <stddef.h>
#include <stdint.h>

/* Return the largest stiffness before the lists are rebuilt, of two particles if they come into
 * contact, and of a contact. */
gn_law_spring gn_pair_spring(const gn_step_context *ctx, const gn_dem *dem, int32_t i, int32_t j);
gn_law_spring gn_contact_spring(const gn_dem *dem, const gn_contacts *list, size_t c);
/* Returns the inverse mass of a particle along a unit vector, 1/kg; prescribed components count as
 * infinite mass. */
double gn_inverse_mass_along(const gn_dem *dem, size_t particle, const double n[3]);
/* Return the damping fraction alpha that gives a restitution, and the fraction of the scene's
 * contacts; 0: no damping. */
double gn_restitution_fraction(double restitution);
double gn_contact_damping_fraction(const gn_scene *scene);
/* Return the area to which stresses of a contact refer, m2 (2D: m x 1 m): of two particles whose
 * overlap is `overlap` m, and of a particle with walls and surfaces. */
double gn_contact_area(const gn_step_context *ctx, const gn_dem *dem, const gn_contacts *list,
                       size_t c, double overlap);
double gn_touch_area(const gn_step_context *ctx, const gn_dem *dem, size_t particle,
                     double overlap);

/* gn_contact_set writes the parameters of a new contact, whose ends are known;
 * gn_contacts_set_dashpots writes those of all contacts of a list that depend on the step. */
void gn_contact_set(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list, size_t c);
void gn_contacts_set_dashpots(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list);
/* Computes the quantities of the packing as a whole that parameters depend on; `pairs` are the
 * contacts to average over. */
gneiss_status gn_law_derive(const gn_step_context *ctx, gn_dem *dem, const gn_pair_list *pairs,
                            gneiss_error *error);
/* Computes the effective Hertz-Mindlin parameters of all pairs of materials, walls and bodies
 * included. */
gneiss_status gn_hertz_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Computes the Hertz-Mindlin parameters again from the scene of another stage; the caller frees
 * *before, the former ones. */
gneiss_status gn_hertz_renew(const gn_step_context *ctx, gn_dem *dem, gn_hertz_pair **before,
                             gneiss_error *error);
/* Updates the parameters of all contacts of a list from the present materials; damage and other
 * history stay. */
gneiss_status gn_contacts_take_materials(const gn_step_context *ctx, const gn_dem *dem,
                                         gn_contacts *list, gneiss_error *error);
/* Computes the pressure around bonds that friction uses, before their forces (confinement.c). */
void gn_dem_confine(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *contacts);

#endif
