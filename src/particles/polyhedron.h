/* Virtual polyhedra about particles (Santasusana 2013, 4.6.2): a particle with n contacts is
 * represented by a polyhedron with n faces that touch it. Where neighbours are missing, at the
 * surface of a body, so are faces: their number is estimated from the density of contacts on the
 * other sides. */
#ifndef GN_PARTICLES_POLYHEDRON_H
#define GN_PARTICLES_POLYHEDRON_H

#include <stdbool.h>
#include <stddef.h>

/* Returns the surface of a polyhedron of n equal faces about a sphere over that of the sphere (2D:
 * perimeter of a polygon about a circle). */
double gn_polyhedron_ratio(int dimension, double n);

/* The faces of one particle. */
typedef struct gn_polyhedron {
    double whole; /* number of faces, missing ones included; fractional if some are missing */
    bool open;    /* some faces are missing */
} gn_polyhedron;

/* `direction` [count][3]: unit vectors to the neighbours; the function changes their order in 2D.
 */
gn_polyhedron gn_polyhedron_about(int dimension, size_t count, double (*direction)[3]);

#endif
