/* Particles that some springs hold, to others of them and to what does not move: where they are in
 * balance under a load. For the few that become free at once; whole bodies are for
 * limit/equilibrium.h. */
#ifndef GN_COUPLE_HELD_SPRINGS_H
#define GN_COUPLE_HELD_SPRINGS_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

enum { GN_HELD_DOFS = 6 }; /* x y z and turns about them */

/* With n from i to j, q = k_t e + (k_n - k_t)(e.n) n of e = u_j - u_i - (a_i w_i + a_j w_j) x n
 * acts on i, -q on j, and the moments a_i n x q and a_j n x q. */
typedef struct gn_held_spring {
    int32_t i, j; /* -1: that end does not move */
    double n[3], arm_i, arm_j, kn, kt;
} gn_held_spring;

typedef struct gn_held_system {
    size_t particles, springs;
    const gn_held_spring *spring;
    const uint8_t *moves; /* [particles] bit k: component k */
    double *work;         /* [gn_held_work] scratch */
} gn_held_system;

static inline size_t gn_held_work(size_t particles) {
    return 5 * GN_HELD_DOFS * particles + 1;
}

/* u [particles][6] of K u = load (N, N m), by conjugate gradients with the diagonal, until what is
 * left is `tolerance` of the load in the metric of the diagonal, or after `most` iterations; what
 * nothing resists is resisted by 1e-3 of the diagonal. Returns the iterations. One thread: sums
 * have one order. */
int gn_held_solve(const gn_held_system *y, const double *load, double tolerance, int most,
                  double *u);

#endif
