/* Largest rate 1/dt at which a damped system ceases to be stable. With stiffness A and damping B,
 * both scaled by M^-1/2, it is the tau with lambda_max(A + 2 tau B) = 4 tau^2
 * (limit/step_limits.c). */
#ifndef GN_LIMIT_DAMPED_H
#define GN_LIMIT_DAMPED_H

#include "base/eigen.h"

#include <math.h>
#include <stdbool.h>

typedef struct gn_damped {
    size_t count;
    /* Computes out = (stiffness A + viscosity B) x. */
    void (*apply)(const void *context, double stiffness, double viscosity, const double *x,
                  double *out);
    gn_operator *metric; /* metric, see gn_eigen_largest */
    const void *context;
    const double *moves; /* [count] above 0 for free components; the mode is 0 in the rest */
    bool damped;         /* B is not 0 */
    const size_t *
        place; /* index in the longer vector, see gn_eigen_largest; NULL: all entries are present */
    size_t whole; /* with `place`: length of the longer vector */
    int threads;
} gn_damped;

typedef struct gn_damped_top {
    double rate;      /* 1/s: tau, from Ritz values */
    double rate_most; /* 1/s: upper bound of tau, which includes the residual */
    double frequency; /* rad/s, undamped */
    int vectors;      /* number of products with the operator */
} gn_damped_top;

/* Finds the largest rate; `mode` [count] is the fastest mode on return. */
gneiss_status gn_damped_largest(const gn_damped *system, double tolerance, double *mode,
                                gn_damped_top *top, gneiss_error *error);

/* Returns the root of 4 tau^2 = a + 2 tau b. */
static inline double gn_damped_rate(double a, double b) {
    return (b + sqrt(b * b + 4.0 * a)) / 4.0;
}

#endif
