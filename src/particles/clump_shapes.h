/* Shapes of clumps: their spheres, mass and inertia. */
#ifndef GN_PARTICLES_CLUMP_SHAPES_H
#define GN_PARTICLES_CLUMP_SHAPES_H

#include "base/error.h"
#include "scene/scene.h"

#include <stddef.h>

typedef struct gn_clump_shape {
    size_t count;
    double *sphere; /* [count][4] m: x y z r, in the frame of the principal axes about the centre */
    double mass, inertia[3]; /* kg; kg m2 about the principal axes */
    double turn[4];          /* from that frame to the frame of the scene's rows */
    double share; /* factor of the masses of free spheres with which they are members, (0, 1] for
                     spheres that make up the mass */
    double reach; /* m, distance of the farthest point of a sphere from the centre */
    int material;
} gn_clump_shape;

/* Makes the shape `index` of the scene's list. GNEISS_ERROR_INPUT: a surface is not closed, or has
 * no room for that many spheres. */
gneiss_status gn_clump_shape_make(const gn_scene *scene, size_t index, gn_clump_shape *shape,
                                  gneiss_error *error);
void gn_clump_shape_free(gn_clump_shape *shape);

/* Returns the mass of a free sphere of the shape, kg, and its moment of inertia, kg m2. */
double gn_clump_ball_mass(const gn_scene *scene, const gn_clump_shape *shape, size_t sphere);
double gn_clump_ball_inertia(const gn_scene *scene, const gn_clump_shape *shape, size_t sphere);

#endif
