/* The part of the particles in a step of the world. */
#ifndef GN_WORLD_PARTICLE_STEP_H
#define GN_WORLD_PARTICLE_STEP_H

#include "base/error.h"
#include "frame/balance.h"
#include "frame/parts.h"
#include "kernels/contact.h"
#include "kernels/motion.h"
#include "measure/energy.h"
#include "particles/contact_lists.h"

#include <stdbool.h>

/* Applies the scene of another stage, before the lists are rebuilt. */
gneiss_status gn_world_enter_particles(gn_world *world, gneiss_error *error);
/* Sorts the particles and forms their bonds, when the scene is complete. */
gneiss_status gn_world_arrange_particles(gn_world *world, gneiss_error *error);
/* Rebuilds the lists. */
gneiss_status gn_world_refresh_particles(gn_world *world, gneiss_error *error);
/* Rebuilds the data that follow from records and lists that were read from a file. */
gneiss_status gn_world_restore_particles(const gn_step_context *ctx, gn_dem *dem,
                                         const gn_periodic_box *box, gneiss_error *error);
/* Computes the forces of the instant, and moves all blocks that no feature holds, in one sweep. */
void gn_world_particle_forces(gn_world *world, bool measure);
/* Moves the held blocks, and computes the sums of the step. */
void gn_world_move_particles(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                             bool measure);
/* Computes forces at the present positions, for a search for equilibrium. Contacts take the present
 * velocities as those of a path of `span` s to these positions; 0: there was no such path. The
 * loads, including gravity and applied forces, then change the velocities over half of `kick` s,
 * without background damping; positions are undefined afterwards. With `kick` 0 nothing moves. */
void gn_world_evaluate_particles(gn_world *world, double span, double kick, bool measure);
/* gn_world_book_particles books works and the energy dissipated by contacts;
 * gn_world_measure_particles writes the stored energy and the stress, Pa, at the instant between
 * the two halves of the interval. */
void gn_world_book_particles(const gn_dem *dem, gn_half half, gn_energy *ledger);
void gn_world_measure_particles(const gn_world *world, gn_energy *ledger, double stress[9]);
/* Adds the ratio of the mean resultant on free particles to the mean contact force. */
void gn_world_balance_particles(const gn_dem *dem, const gn_boundary *boundary,
                                gn_balance *balance);
/* Returns the arguments of the motion kernel in the coming step. */
gn_motion_args gn_world_motion_args(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                    bool measure);

/* Computes walls, contacts and motion of one step, in parallel (particle_sweep.c). */
void gn_world_sweep(gn_world *world, const gn_contact_args contacts[GN_LIST_COUNT],
                    const gn_motion_args *motion);

/* Moves the held blocks of particles. */
void gn_world_sweep_held(gn_dem *dem, const gn_motion_args *motion);

#endif
