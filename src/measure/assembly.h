/* The geometry of contacts for measures. Private to src/measure. */
#ifndef GN_MEASURE_ASSEMBLY_H
#define GN_MEASURE_ASSEMBLY_H

#include "base/ball.h"
#include "base/vec3.h"
#include "measure/measure.h"

#include <math.h>

/* Computes the vector from the centre of particle i to that of j, or to its nearest image in a
 * periodic box; z = 0 in 2D. Returns its length. */
static inline double gn_assembly_branch(const gn_assembly *assembly, size_t i, size_t j,
                                        double l[3]) {
    const double *pos = assembly->particles->pos;
    double square = 0;
    l[2] = 0;
    for (int a = 0; a < assembly->dimension; a++) {
        l[a] = pos[4 * j + a] - pos[4 * i + a];
        if (assembly->periodic) l[a] = gn_nearest(l[a], assembly->period[a]);
        square += l[a] * l[a];
    }
    return sqrt(square);
}

/* Returns the volume of a sphere, or the area of a disc (unit thickness). */
static inline double gn_particle_volume(const gn_particles *particles, size_t p, int dimension) {
    return gn_ball_volume(dimension, particles->pos[4 * p + 3]);
}

#endif
