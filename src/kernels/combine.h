/* Combination of the values of two materials for a pair, and random properties of bonds. */
#ifndef GN_KERNELS_COMBINE_H
#define GN_KERNELS_COMBINE_H

#include "base/random.h"
#include "kernels/law.h"

#include <math.h>

/* Returns the stiffness of two springs in series, such that for equal values a and b it is exactly
 * that value. */
static inline double gn_series(double a, double b) {
    return a == b ? a : a + b > 0.0 ? 2.0 * a * b / (a + b) : 0.0;
}

static inline double gn_smaller(double a, double b) {
    return a < b ? a : b;
}

/* Returns a key of `contacts` if it is given, otherwise the combined value. */
#define GN_OWN(pair, key, combined)                                                                \
    ((pair)->own && (pair)->own->key != GN_COMBINED ? (pair)->own->key : (combined))

/* Returns mu_1 of a bond: that of the weaker of two materials, as for all strengths. */
static inline double gn_bond_friction(const gn_law_pair *pair) {
    return GN_OWN(pair, bond_friction, gn_smaller(pair->a->bond_friction, pair->b->bond_friction));
}

/* Returns a number uniformly distributed in (0, 1), which depends on seed, lot and draw only. */
static inline double gn_drawn(uint64_t seed, uint64_t lot, uint64_t draw) {
    double u = 0.5 * (gn_random_symmetric(seed ^ draw * UINT64_C(0x9e3779b97f4a7c15), lot) + 1.0);
    return u > 0.0 ? u : 0x1p-54;
}

/* Draws standard normal numbers (Box & Muller 1958) until one lies within +-`most`: the mean stays
 * 0. */
static inline double gn_drawn_normal(uint64_t seed, uint64_t lot, uint64_t draw, double most) {
    for (;; draw += 2) {
        double u = gn_drawn(seed, lot, draw), v = gn_drawn(seed, lot, draw + 1);
        double z = sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
        if (fabs(z) < most) return z;
    }
}

/* Returns the random factor of a property of a bond, with mean 1. Weibull: P(x < t) = 1 -
 * exp(-(t/s)^m), of mean s Gamma(1 + 1/m). */
static inline double gn_scatter_factor(const gn_scatter *scatter, uint64_t seed, uint64_t lot,
                                       uint64_t property) {
    const uint64_t draw = property << 32; /* each property is drawn independently */
    if (!lot || scatter->kind == GN_SCATTER_NONE) return 1.0;
    if (scatter->kind == GN_SCATTER_NORMAL)
        return 1.0 +
               scatter->deviation * gn_drawn_normal(seed, lot, draw, 1.0 / scatter->deviation);
    double m = scatter->modulus;
    return pow(-log(gn_drawn(seed, lot, draw)), 1.0 / m) / tgamma(1.0 + 1.0 / m);
}

#endif
