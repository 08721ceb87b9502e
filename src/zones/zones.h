/* Zones in which particles and elements share one body: their particles (couple/zone.h) move with
 * the nodes and transfer their forces to them. */
#ifndef GN_ZONES_ZONES_H
#define GN_ZONES_ZONES_H

#include "base/error.h"
#include "couple/consistent.h"
#include "couple/ties.h"
#include "frame/parts.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The part of a model that sets its step. */
typedef enum gn_side { GN_SIDE_PARTICLES, GN_SIDE_ELEMENTS, GN_SIDE_ZONE, GN_SIDES } gn_side;

/* Stability limit of particles and elements as one system (coupled_limit.c). */
typedef struct gn_whole_limit {
    double sharp, low; /* s: 1/tau by Lanczos, contact damping included; with its residual */
    int iterations;    /* number of Lanczos vectors; 0: the limit was not computed */
    gn_side side; /* location of the fastest mode; zones include the nodes that carry particles and
                     the particles' own motion */
    double share[GN_SIDES]; /* shares of the kinetic energy of the mode */
    int32_t particle,
        node; /* the particle or node with the largest share, -1: it is of the other kind */
} gn_whole_limit;

typedef struct gn_coupled {
    gn_ties ties;             /* ties to the first solid */
    int32_t *place;           /* [ties] of the particle in its record, -1: removed */
    double (*load)[3];        /* [ties] N, of the contacts of a particle in the last step */
    gn_consistent consistent; /* without ties: masses are lumped */
    double *before;           /* [nodes of ties][3] m/s, consistent: of the half step before */
    double (*turn)[4][3];     /* [ties] N, slaved spins: forces of a moment on the corners */
    double kinetic;       /* J, with consistent masses: kinetic energy in addition to that of lumped
                             masses */
    gn_whole_limit whole; /* result of the last search */
    /* Springs instead of a constraint: [ties] N/m, N s/m, J stored, J lost in half a step, N and
     * N m of the dashpot; [nodes of ties] scratch. NULL: none. */
    double *stiffness, *viscosity, *stored, *lost, (*drag)[3], (*twist)[3], *sum;
} gn_coupled;

void gn_coupled_free(gn_coupled *coupled); /* NULL is allowed */

/* Where the scene wants it: weights, masses, and the exchange between both. After particles have
 * masses and before they have bonds. */
gneiss_status gn_coupled_create(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                const gn_solids *solids, gn_zones *zones, gneiss_error *error);
/* Makes the zones' state for a world whose records were read from a file. */
gneiss_status gn_coupled_resume(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                const gn_solids *solids, gn_zones *zones, gneiss_error *error);
/* Refuses contact laws that do not support contacts of a weight below 1. */
gneiss_status gn_zones_check_law(const gn_step_context *ctx, gneiss_error *error);

/* The zones' part of a step, with coupled != NULL. Holds the blocks of their particles and nodes
 * when lists are made. */
gneiss_status gn_zones_hold(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                            gn_zones *zones, gneiss_error *error);
/* Hands the forces of particles to nodes, or adds those of springs to both. */
void gn_zones_act(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids, gn_zones *zones,
                  gn_ledger *ledger);
/* Moves the particles with the nodes, or books the work of dashpots. */
gneiss_status gn_zones_elements_moved(const gn_step_context *ctx, gn_dem *dem,
                                      const gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                      gneiss_error *error);
/* Adds their stress and energy to those of the instant. */
void gn_zones_add_to_reading(const gn_zones *zones, gn_ledger *ledger);

/* Finds the particles that follow nodes after a conversion, and their masses. */
gneiss_status gn_coupled_recreate(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                                  gn_zones *zones, gneiss_error *error);
/* Finds only the masses of the particles that follow nodes. */
gneiss_status gn_coupled_weigh(const gn_dem *dem, const gn_solids *solids, gn_zones *zones,
                               gneiss_error *error);
/* Puts the particles of zones where the nodes are now, with their velocities; not for springs. */
void gn_coupled_follow(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                       gn_zones *zones);
/* Places, at the start, the particles that moving nodes drive, also those with springs. */
void gn_coupled_begin(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                      gn_zones *zones);

/* Sets the stiffnesses of springs and their effect on the step at the start, once the limit of the
 * particles is known (zone_penalty.c). Does nothing without springs. */
void gn_coupled_stiffen(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                        gn_zones *zones);
/* Finds the effect of slaved spins on the step (gn_zone_state.turned) at the present positions;
 * `more`: it has grown (zone_spins.c). */
gneiss_status gn_coupled_turn_faster(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_solids *solids, gn_zones *zones, bool *more,
                                     gneiss_error *error);

/* Tells whether a particle, by its id, belongs to a zone. */
bool gn_coupled_has(const gn_coupled *q, int32_t id);
/* Returns its position in the elements; NULL: it belongs to no zone. */
const gn_tie *gn_coupled_tie(const gn_coupled *q, int32_t id);

/* [particles] 1/kg: for particles of zones with a constraint the inverse mass of the nodes against
 * a force at their position, in place of their own (zone_masses.c). */
void gn_coupled_inverse_masses(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_solids *solids, const gn_zones *zones, double *inverse);

/* Removes the mass, momentum and energy of particles that leave the model from the nodes that carry
 * them; to be called before they lose their masses. `gone` [particles]: nonzero for these. */
void gn_coupled_remove(gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       gn_zones *zones, gn_ledger *ledger, const int32_t *gone);
/* Adds the part of the stress that elements carry at the particles of zones, Pa, [particles][6] as
 * gn_stress_particles (zone_readings.c). */
gneiss_status gn_coupled_add_stress(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_solids *solids, const gn_zones *zones, double *sigma,
                                    gneiss_error *error);
/* Returns the share of elements in the mean stress, Pa, [9], over the volume of the particles,
 * dormant ones included. */
gneiss_status gn_coupled_mean_stress(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_solids *solids, const gn_zones *zones,
                                     double sigma[9], gneiss_error *error);
/* Returns the number of removed particles of zones. */
size_t gn_coupled_removed_count(const gn_step_context *ctx, const gn_zones *zones);

/* J: energy of plane waves in the elements outside of zones that run away from the particles of
 * zone `k`: along n, from where its elements end into the particles, a wave that runs along n has v
 * = -c e, one that runs back v = c e, so that the sum over elements is of rho V ((v + c e)/2)^2. */
double gn_coupled_returned(const gn_step_context *ctx, const gn_solids *solids, size_t k);
/* Returns that energy relative to the energy present at the start or supplied since; NaN without
 * such energy beyond rounding, or without a ledger. */
double gn_coupled_returned_share(const gn_step_context *ctx, const gn_solids *solids,
                                 const gn_ledger *ledger, size_t k);

/* Returns the number of broken bonds in zones, where elements still hold the material together. */
size_t gn_coupled_broken(const gn_dem *dem);

/* Properties of the particles in elements of one material and of these elements, along the zone's n
 * (for conversion the mean over the axes): Pa in an affine strain, kg/m3, and the share of the
 * energy of a wave that their difference returns. */
typedef struct gn_zone_material {
    int32_t material; /* material of the elements */
    size_t particles;
    double modulus[2], density[2], returned;
    double tension[4]; /* Pa, moduli of particles and of elements in tension along each axis of
                          particles with free sides; 0: unknown. Only where elements convert */
} gn_zone_material;
/* Tells whether they differ by 12 % or more of the modulus, of the mean of those in tension, or of
 * one in which the particles are stiffer. */
bool gn_zone_differs(const gn_zone_material *material);
enum {
    GN_ZONE_MATERIALS = 8
}; /* materials that are listed separately; the last entry stands for all further ones */

/* Properties of a zone at the start (zone_check.c). */
typedef struct gn_zone_figures {
    double width, element, diameter; /* m; means over its elements and particles */
    double least;                    /* weight of an element's node that has the least: 0 */
    double edge;                     /* weight of its particle that has the least: 0 */
    size_t particles;                /* number of particles in elements */
    size_t beyond;                   /* number of these without weight, beyond the zone's edge */
    size_t shared,
        other;   /* number of particles that are in another zone as well; the first such zone */
    double mass; /* mass of their share of the body over that which elements leave to them */
    size_t materials;
    gn_zone_material material[GN_ZONE_MATERIALS];
} gn_zone_figures;
void gn_zone_measure(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                     const gn_zones *zones, size_t k, gn_zone_figures *figures);
/* Tells whether the mass of a zone's particles differs from the share that the elements leave. */
bool gn_zone_is_off(const gn_zone_figures *figures);

/* Moduli and densities of particles with these sums, N m, kg and m3, beside the elements'; on entry
 * those of the elements are sums over the particles. */
void gn_zone_compare(gn_zone_material *material, double stiffness, double mass, double volume);

#endif
