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
    double sharp, low; /* s: 1/tau by Lanczos, contact damping included; lower bound of it, with the
                          residual */
    int iterations;    /* number of Lanczos vectors; 0: the limit was not computed */
    gn_side side; /* part with the fastest mode; zones include the nodes that carry particles, and
                     the particles' own motion */
    double share[GN_SIDES]; /* shares of the parts in the kinetic energy of the mode */
    int32_t particle,
        node; /* the particle or node with the largest share; -1: that of the other kind has it */
} gn_whole_limit;

typedef struct gn_coupled {
    gn_ties ties;             /* ties to the first solid */
    int32_t *place;           /* [ties] index of the particle in its record, -1: removed */
    double (*load)[3];        /* [ties] N, force of the contacts of a particle in the last step */
    gn_consistent consistent; /* consistent masses; without ties masses are lumped */
    double *before; /* [nodes of ties] m/s, velocity half a step before; with consistent masses */
    double (
        *turn)[4][3]; /* [ties] N, with slaved spins: forces on the corners that replace a moment */
    double kinetic; /* J, with consistent masses: difference of the kinetic energy to that of lumped
                       masses */
    gn_whole_limit whole; /* result of the last search */
    /* Springs instead of a constraint: [ties] N/m, N s/m, J stored, J lost in half a step, force
     * and moment of the dashpot (N, N m); [nodes of ties] scratch. NULL: there are none. */
    double *stiffness, *viscosity, *stored, *lost, (*drag)[3], (*twist)[3], *sum;
} gn_coupled;

void gn_coupled_free(gn_coupled *coupled); /* NULL is allowed */

/* Creates the zones of the scene: weights, masses, and the ties of particles to nodes. Particles
 * must have masses, and no bonds yet. */
gneiss_status gn_coupled_create(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                const gn_solids *solids, gn_zones *zones, gneiss_error *error);
/* Creates the zones of a world whose records were read from a file. */
gneiss_status gn_coupled_resume(const gn_step_context *ctx, gn_dem *dem, gn_boundary *boundary,
                                const gn_solids *solids, gn_zones *zones, gneiss_error *error);
/* Refuses contact laws that do not support contacts of a weight below 1. */
gneiss_status gn_zones_check_law(const gn_step_context *ctx, gneiss_error *error);

/* The following functions are the part of the zones in a step; zones->coupled must not be NULL.
 * gn_zones_hold finds the blocks that contain particles and nodes of zones, when lists are made. */
gneiss_status gn_zones_hold(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                            gn_zones *zones, gneiss_error *error);
/* Transfers the forces of particles to nodes; springs add their forces to both. */
void gn_zones_act(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids, gn_zones *zones,
                  gn_ledger *ledger);
/* Moves the particles with the nodes; with springs, books the work of dashpots. */
gneiss_status gn_zones_elements_moved(const gn_step_context *ctx, gn_dem *dem,
                                      const gn_solids *solids, gn_zones *zones, gn_ledger *ledger,
                                      gneiss_error *error);
/* Adds the stress and the energy of zones to those of the instant. */
void gn_zones_add_to_reading(const gn_zones *zones, gn_ledger *ledger);

/* Finds the particles that follow nodes after a conversion, and their masses. */
gneiss_status gn_coupled_recreate(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                                  gn_zones *zones, gneiss_error *error);
/* Computes only the masses of the particles that follow nodes. */
gneiss_status gn_coupled_weigh(const gn_dem *dem, const gn_solids *solids, gn_zones *zones,
                               gneiss_error *error);
/* Moves the particles of zones to the present positions of their nodes, with the velocities of
 * these; not with springs. */
void gn_coupled_follow(const gn_step_context *ctx, gn_dem *dem, const gn_solids *solids,
                       gn_zones *zones);
/* Moves, at the start, the particles that moving nodes drive, including those with springs. */
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
/* Returns the position of a particle, by its id, in the elements; NULL: it belongs to no zone. */
const gn_tie *gn_coupled_tie(const gn_coupled *q, int32_t id);

/* Sets, for particles of zones with a constraint, the inverse mass [particles], 1/kg, to that of
 * the nodes against a force at the particle's position (zone_masses.c). */
void gn_coupled_inverse_masses(const gn_step_context *ctx, const gn_dem *dem,
                               const gn_solids *solids, const gn_zones *zones, double *inverse);

/* Called before particles leave the model and lose their masses: removes their mass, momentum and
 * energy from the nodes that carry them. `gone` [particles]: nonzero for these particles. */
void gn_coupled_remove(gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                       gn_zones *zones, gn_ledger *ledger, const int32_t *gone);
/* Adds the part of the stress that elements carry at the particles of zones, Pa, [particles][6] as
 * gn_stress_particles (zone_readings.c). */
gneiss_status gn_coupled_add_stress(const gn_step_context *ctx, const gn_dem *dem,
                                    const gn_solids *solids, const gn_zones *zones, double *sigma,
                                    gneiss_error *error);
/* Computes the contribution of elements to the mean stress, Pa, [9], over the volume of the
 * particles, dormant ones included. */
gneiss_status gn_coupled_mean_stress(const gn_step_context *ctx, const gn_dem *dem,
                                     const gn_solids *solids, const gn_zones *zones,
                                     double sigma[9], gneiss_error *error);
/* Returns the number of removed particles of zones. */
size_t gn_coupled_removed_count(const gn_step_context *ctx, const gn_zones *zones);

/* Returns the energy, J, of plane waves in the elements outside of zones that run away from the
 * particles of zone `k`. The normal n points from the end of the elements into the particles; a
 * wave along n has v = -c e, a wave in the opposite direction v = c e, so that the energy is the
 * sum over elements of rho V ((v + c e)/2)^2. */
double gn_coupled_returned(const gn_step_context *ctx, const gn_solids *solids, size_t k);
/* Returns the energy of returned waves (gn_coupled_returned) over the energy that was present at
 * the start or supplied since; NaN if the latter is not above rounding, or without a ledger. */
double gn_coupled_returned_share(const gn_step_context *ctx, const gn_solids *solids,
                                 const gn_ledger *ledger, size_t k);

/* Returns the number of broken bonds in zones, where elements still hold the material together. */
size_t gn_coupled_broken(const gn_dem *dem);

/* Properties of the elements of one material in a zone and of the particles in them, along the
 * zone's n (if elements convert, the mean over the axes): moduli in an affine strain, Pa,
 * densities, kg/m3, and the share of a wave's energy that is returned because they differ. */
typedef struct gn_zone_material {
    int32_t material; /* material of the elements */
    size_t particles;
    double modulus[2], density[2], returned;
    double tension[4]; /* Pa, moduli of particles and of elements in tension with free sides, along
                          each axis for particles; 0: unknown. Only where elements convert */
} gn_zone_material;
/* Tells whether particles and elements differ by 12 % or more in the modulus, in the mean modulus
 * in tension, or in a modulus in tension for which the particles are stiffer. */
bool gn_zone_differs(const gn_zone_material *material);
enum {
    GN_ZONE_MATERIALS = 8
}; /* materials that are listed separately; the last entry stands for all further ones */

/* Properties of a zone at the start (zone_check.c). */
typedef struct gn_zone_figures {
    double width, element, diameter; /* m; means over its elements and particles */
    double least;                    /* least weight of a node of an element; it should be 0 */
    double edge;                     /* least weight of a particle; it should be 0 */
    size_t particles;                /* number of particles in elements */
    size_t beyond; /* number of particles in elements that have no weight, because they are beyond
                      the zone's edge */
    size_t shared, other; /* number of particles that are in another zone as well; index of the
                             first such zone */
    double mass; /* mass of the particles' share of the body, over the mass that elements leave to
                    them */
    size_t materials;
    gn_zone_material material[GN_ZONE_MATERIALS];
} gn_zone_figures;
void gn_zone_measure(const gn_step_context *ctx, const gn_dem *dem, const gn_solids *solids,
                     const gn_zones *zones, size_t k, gn_zone_figures *figures);
/* Tells whether the mass of a zone's particles differs from the share that the elements leave. */
bool gn_zone_is_off(const gn_zone_figures *figures);

/* Compares the particles with the elements: computes moduli and densities from the sums N m, kg and
 * m3 over particles; on entry those of the elements are sums over the particles, too. */
void gn_zone_compare(gn_zone_material *material, double stiffness, double mass, double volume);

#endif
