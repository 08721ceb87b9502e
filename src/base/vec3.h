/* Products of vectors in space, and distances in periodic boxes. */
#ifndef GN_BASE_VEC3_H
#define GN_BASE_VEC3_H

#include <math.h>

/* Returns a component of the vector to the nearest image; `period` 0: not periodic. (The contact
 * kernel has a SIMD version.) */
static inline double gn_nearest(double d, double period) {
    return period > 0.0 ? d - period * nearbyint(d / period) : d;
}

static inline double gn_dot3(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void gn_cross3(const double *a, const double *b, double *r) {
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
