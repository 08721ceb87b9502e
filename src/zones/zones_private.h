/* Declarations that the files of zones share. */
#ifndef GN_ZONES_ZONES_PRIVATE_H
#define GN_ZONES_ZONES_PRIVATE_H

#include "base/error.h"
#include "fem/fem.h"
#include "frame/frame.h"
#include "frame/parts.h"
#include "particles/particles.h"
#include "solids/solids.h"
#include "zones/zones.h"

#include <stddef.h>

/* Checks that each zone has elements and particles, and that the particles are in elements and
 * start at rest (zone_check.c). */
gneiss_status gn_zones_check(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                             const gn_ties *ties, gneiss_error *error);

/* Adds coupled->load to the loads of nodes, by the shape functions. */
void gn_coupled_add_to_nodes(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                             gn_coupled *q);

/* Consistent masses (zone_masses.c). The functions store velocities before the motion; compute
 * loads with which lumped masses move as consistent ones; and after the motion compute the
 * difference of the kinetic energy and of the damping to those of lumped masses. */
void gn_masses_store(const gn_solids *solids, gn_coupled *q);
void gn_masses_correct(const gn_step_context *ctx, const gn_solids *solids, gn_coupled *q);
void gn_masses_book(const gn_step_context *ctx, const gn_solids *solids, gn_coupled *q);

/* Springs in place of a constraint (zone_penalty.c). gn_penalty_create creates them, gn_penalty_set
 * sets their stiffnesses from gn_zone_state.frequency, and gn_penalty_hold makes them known to the
 * contacts of their particles with walls. The other functions are their part of a step. */
gneiss_status gn_penalty_create(gn_coupled *q, gneiss_error *error);
void gn_penalty_set(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                    const gn_zones *zones, gn_coupled *q);
void gn_penalty_hold(const gn_dem *dem, gn_boundary *boundary, const gn_solids *solids,
                     gn_zones *zones);
void gn_penalty_act(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids, gn_coupled *q,
                    gn_ledger *ledger);
void gn_penalty_follow(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       gn_coupled *q, gn_ledger *ledger);
void gn_penalty_book(const gn_coupled *coupled, gn_energy *reading);

/* Slaved spins (zone_spins.c). The first function takes over the moment on the particle of a tie
 * and sets coupled->turn; the second one sets the particle's spin to half the curl of the nodes'
 * velocity. */
void gn_spins_take_moment(gn_dem *dem, const gn_solids *solids, gn_coupled *q, int width, size_t k);
void gn_spins_set(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                  const gn_coupled *q, size_t k);

/* Returns the number of threads for a number of particles or nodes of zones: one if they are few,
 * or if the threads of the particles spend their time waiting for each other (sched/pace.h). */
static inline int gn_coupled_team(const gn_step_context *ctx, const gn_dem *dem, size_t count) {
    enum { FEW = 200 };
    return count <= FEW ? 1 : dem->deal.team > 0 ? dem->deal.team : ctx->threads;
}

#endif
