/* Particles and elements as one body: particles of zones (couple/zone.h) move with the nodes and
 * hand them their forces. */
#ifndef GN_SIM_COUPLING_H
#define GN_SIM_COUPLING_H

#include "couple/consistent.h"
#include "couple/ties.h"
#include "sim/world.h"

typedef struct gn_coupled {
    gn_ties ties;             /* of the first solid */
    int32_t *place;           /* [ties] of the particle in its record, -1: removed */
    double (*load)[3];        /* [ties] N, of the contacts of a particle in the last step */
    gn_consistent consistent; /* without ties: masses are lumped */
    double *before;           /* [nodes of ties][3] m/s, consistent: of the half step before */
    double (*turn)[4][3];     /* [ties] N, of slaved spins: what a moment is to the corners */
    double kinetic;           /* J, consistent: what it has beyond the lump's */
    /* Of springs instead: [ties] N/m, N s/m, J stored, J lost in half a step, N of the dashpot;
     * [nodes of ties] scratch. */
    double *stiffness, *viscosity, *stored, *lost, (*drag)[3], *sum;
} gn_coupled;

/* Where the scene wants it: weights, masses, and the exchange between both. After particles have
 * masses and before they have bonds. */
gneiss_status gn_coupled_create(gn_world *world, gneiss_error *error);
/* The same for a world whose records were read. */
gneiss_status gn_coupled_resume(gn_world *world, gneiss_error *error);

/* Elements were converted: who follows nodes now, and the masses of these (conversion.c). */
gneiss_status gn_coupled_again(gn_world *world, gneiss_error *error);
/* Their masses alone. */
gneiss_status gn_coupled_weigh(gn_world *world, gneiss_error *error);

/* At the start, once the particles' limit is known: stiffnesses of springs, and what they take of
 * the step (coupling_penalty.c). Without springs nothing is done. */
void gn_coupled_stiffen(gn_world *world);

/* Whether a particle, by its id, is one of a zone. */
bool gn_coupled_has(const gn_coupled *coupled, int32_t id);

/* J: energy of plane waves in the elements outside of zones that run away from the particles of
 * zone `k`: along n, from where its elements end into the particles, a wave that runs along n has v
 * = -c e, one that runs back v = c e, so that the sum over elements is of rho V ((v + c e)/2)^2. */
double gn_coupled_returned(const gn_world *world, size_t k);

/* Bonds that broke between particles of zones, which elements hold together all the same. */
size_t gn_coupled_broken(const gn_world *world);

/* What a zone is, as it was at the start (coupling_check.c). */
typedef struct gn_zone_figures {
    double width, element, diameter; /* m; means over its elements and particles */
    double least;                    /* weight of an element's node that has the least: 0 */
    size_t particles;                /* of all zones, here and below */
    size_t beyond;                   /* where particles have no weight, beyond its edge */
    /* Of particles that follow elements, along n: Pa, of an affine strain, and kg/m3; the same of
     * the elements; what of the energy of a wave their difference returns. */
    double modulus[2], density[2], returned;
} gn_zone_figures;
void gn_zone_measure(const gn_world *world, size_t k, gn_zone_figures *figures);

#endif
