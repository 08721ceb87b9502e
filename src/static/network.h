/* Elastic constants of a bonded packing without time steps: the network of its bonds as linear
 * springs, at the present positions of the particles. */
#ifndef GN_STATIC_NETWORK_H
#define GN_STATIC_NETWORK_H

#include "frame/parts.h"
#include "measure/stiffness.h"
#include "world/world.h"

typedef struct gn_network {
    double volume;        /* m3 (2D: m2 x 1 m), volume to which the specimen's mean stress refers */
    double solid;         /* m3: volume of the bonded particles */
    size_t particles;     /* number of particles with bonds */
    size_t boundary;      /* number of these that follow the strain; 0: in a periodic box */
    double depth;         /* m, largest distance of these from the hull of the centres */
    double radius_square; /* m2, mean of r^2 */
    double radius_cube;   /* m3, mean of r^3 */
    gn_bond_fabric fabric; /* fabric of the bonds */
    gn_elastic strained,
        stressed; /* results by uniform strain and by uniform stress (measure/stiffness.h) */
    bool has_stressed;
    gn_elastic network; /* results in equilibrium */
    int64_t solutions, iterations;
    double residual; /* unbalanced loads over the forces of bonds in uniform strain, as root mean
                        squares; the largest of all strains */
} gn_network;

/* Finds the stiffness of the bonds of a world. For each strain (six, 2D: three) boundary particles
 * follow the uniform strain, and may rotate; conjugate gradients (limit/equilibrium.h) bring all
 * other motions into equilibrium, repeated for the residual in double precision. Boundary particles
 * are those whose centre is within one largest radius of the convex hull of all centres. A box that
 * is periodic along all axes has none: its sides follow the strain, and displacements relative to
 * it are periodic. Sets, walls and their motions have no effect. The result is the same for any
 * number of threads. GNEISS_ERROR_INPUT: no bonds, no hull, or a box that is periodic along some
 * axes only. */
gneiss_status gn_network_stiffness(const gn_world *world, gn_network *found, gneiss_error *error);

#endif
