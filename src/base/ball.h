/* Volumes of particles. */
#ifndef GN_BASE_BALL_H
#define GN_BASE_BALL_H

#include <math.h>

/* Returns the volume of a sphere, m3; in two dimensions that of a disc of unit thickness, m2. */
static inline double gn_ball_volume(int dimension, double radius) {
    return dimension == 3 ? 4.0 / 3.0 * M_PI * radius * radius * radius : M_PI * radius * radius;
}

#endif
