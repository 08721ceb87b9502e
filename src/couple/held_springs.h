/* Equilibrium of a few particles on springs to each other and to fixed particles, under a load. It
 * is used for newly released particles; whole bodies use limit/equilibrium.h. */
#ifndef GN_COUPLE_HELD_SPRINGS_H
#define GN_COUPLE_HELD_SPRINGS_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

enum { GN_HELD_DOFS = 6 }; /* x y z and rotations about them */

/* A spring between i and j, with n from i to j. By its displacement e = u_j - u_i - (a_i w_i + a_j
 * w_j) x n it exerts q = k_t e + (k_n - k_t)(e.n) n on i, -q on j, and the moments a_i n x q and
 * a_j n x q. */
typedef struct gn_held_spring {
    int32_t i, j; /* -1: that end is fixed */
    double n[3], arm_i, arm_j, kn, kt;
} gn_held_spring;

typedef struct gn_held_system {
    size_t particles, springs;
    const gn_held_spring *spring;
    const uint8_t *moves; /* [particles] bit k: component k is free */
    double *work;         /* [gn_held_work] scratch */
} gn_held_system;

static inline size_t gn_held_work(size_t particles) {
    return 5 * GN_HELD_DOFS * particles + 1;
}

/* Solves K u = load (N, N m) for u [particles][6] by conjugate gradients with a diagonal
 * preconditioner, until the residual is `tolerance` times the load in the metric of the diagonal,
 * or for at most `most` iterations. Components without resistance are regularised by 1e-3 of the
 * diagonal. Returns the number of iterations. It is serial, so that the order of sums is fixed. */
int gn_held_solve(const gn_held_system *system, const double *load, double tolerance, int most,
                  double *u);

#endif
