/* Accelerations of nodes that carry the particles of zones with the mass N^T M N that the
 * constraint v_i = sum_a N_a v_a gives them, instead of its lump. Conjugate gradients with the lump
 * as preconditioner, of whose quotients with a simplex all lie in [1/(d + 2), 1] (the matrix of
 * linear shape functions over its row sums): some ten rounds give ten digits. Sums have a fixed
 * order. */
#ifndef GN_COUPLE_CONSISTENT_H
#define GN_COUPLE_CONSISTENT_H

#include "couple/ties.h"

typedef struct gn_consistent {
    const gn_ties *ties;
    int threads;
    int32_t *row, *column; /* [nodes of ties + 1], [..]: the nodes that have a particle with one */
    double *weight;        /* [..] kg, of N^T M N */
    double *whole;         /* [nodes of ties] kg, of the node with the lump */
    double *load;          /* [nodes of ties][3] N: on the node and the particles it carries */
    double *rate;          /* [nodes of ties][3] m/s2: what is looked for; given where `fixed` */
    uint8_t *fixed;        /* [nodes of ties][3] */
    double *work[5];       /* [nodes of ties][3] */
} gn_consistent;

gneiss_status gn_consistent_create(const gn_ties *t, gn_consistent *y, gneiss_error *error);
/* N^T M N, of the masses of the particles of ties, kg; 0: removed. */
void gn_consistent_weigh(gn_consistent *y, const double *mass);
void gn_consistent_free(gn_consistent *y);

/* rate from load. Returns the number of rounds. */
int gn_consistent_solve(gn_consistent *y);
/* out = (lump - N^T M N) rate, N, [nodes of ties][3]: with this on top of the loads the lumped
 * masses accelerate as the consistent ones do. Adds up to zero whatever the rates are. */
void gn_consistent_difference(const gn_consistent *y, const double *rate, double *out);

#endif
