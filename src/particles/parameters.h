/* Parameters of contacts and bonds, and motions of sets, from the scene. */
#ifndef GN_PARTICLES_PARAMETERS_H
#define GN_PARTICLES_PARAMETERS_H

#include "base/error.h"
#include "frame/parts.h"
#include "kernels/partials.h"
#include "neigh/neigh.h"
#include "soa/records.h"

#include <stddef.h>

/* The contact law applied to particles (law.c). gn_contact_set writes the parameters of a new
 * contact, whose ends are known; gn_contacts_set_dashpots writes those of all contacts of a list
 * that depend on the step. */
void gn_contact_set(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list, size_t c);
void gn_contacts_set_dashpots(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *list);
/* Computes the quantities of the packing as a whole that parameters depend on; `pairs` are the
 * contacts to average over. */
gneiss_status gn_law_derive(const gn_step_context *ctx, gn_dem *dem, const gn_pair_list *pairs,
                            gneiss_error *error);
/* Effective Hertz-Mindlin parameters of all pairs of materials, walls and bodies included
 * (law.c). */
gneiss_status gn_hertz_prepare(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Computes them again from the scene of another stage; the caller frees *before. */
gneiss_status gn_hertz_renew(const gn_step_context *ctx, gn_dem *dem, gn_hertz_pair **before,
                             gneiss_error *error);
/* Updates the parameters of all contacts of a list from the present materials; damage and other
 * history stay. */
gneiss_status gn_contacts_take_materials(const gn_step_context *ctx, const gn_dem *dem,
                                         gn_contacts *list, gneiss_error *error);
/* Motions and forces of sets as the scene has them now. */
gneiss_status gn_sets_enter(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* gn_bonds_add forms bonds between the pairs at their present positions in addition to the present
 * bonds; gn_bonds_dissolve turns all intact bonds into unbonded contacts. The lists must be rebuilt
 * after either. */
gneiss_status gn_bonds_add(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
void gn_bonds_dissolve(const gn_step_context *ctx, gn_dem *dem);
/* Sets (sets.c): first materials and groups, then, when masses are known, motions and forces. */
gneiss_status gn_sets_assign(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
gneiss_status gn_sets_apply(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
/* Velocities of prescribed particles and sums of the reactions. */
void gn_prescription_update(const gn_step_context *ctx, gn_dem *dem, double time);
void gn_reactions_sum(const gn_step_context *ctx, gn_dem *dem);
/* Performs a step of zero length on a copy of a list, in double (observe.c): failures of bonds stay
 * in the copy, which the caller owns, also on failure. `partials`: of the list, with rows of
 * double; NULL: forces are in the rows of the copy alone. */
gneiss_status gn_contacts_evaluate(const gn_step_context *ctx, const gn_dem *dem,
                                   const gn_periodic_box *box, const gn_contacts *list,
                                   const gn_partials *partials, gn_contacts *copy,
                                   gneiss_error *error);
/* The pressure around bonds whose friction sees it, before their forces (confinement.c). */
void gn_dem_confine(const gn_step_context *ctx, const gn_dem *dem, gn_contacts *contacts);

/* Multiplies the strengths of all intact bonds, so that none breaks or softens; yield stresses are
 * unchanged. */
void gn_bonds_strengthen(gn_dem *dem, double factor);

#endif
