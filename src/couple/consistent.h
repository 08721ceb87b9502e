/* Accelerations of nodes that carry the particles of coupling zones, with the consistent mass N^T M
 * N that follows from the constraint v_i = sum_a N_a v_a, instead of the lumped mass. Conjugate
 * gradients are preconditioned by the lumped mass. On a simplex all quotients of both lie in [1/(d
 * + 2), 1] (the matrix of linear shape functions over its row sums), so that some ten iterations
 * give ten digits. The order of sums is fixed. */
#ifndef GN_COUPLE_CONSISTENT_H
#define GN_COUPLE_CONSISTENT_H

#include "couple/ties.h"

typedef struct gn_consistent {
    const gn_ties *ties;
    int threads;
    /* [nodes of ties + 1] first entry of a node; [..] the nodes that share a particle with it */
    int32_t *row, *column;
    double *weight; /* [..] entries of N^T M N, kg */
    /* [nodes of ties] mass of the node with the lumped mass of ties, kg */
    double *whole;
    /* [nodes of ties][3] force on the node and the particles that it carries, N */
    double *load;
    double
        *rate; /* [nodes of ties][3] accelerations, m/s2: the solution; prescribed where `fixed` */
    uint8_t *fixed;  /* [nodes of ties][3] */
    double *work[5]; /* [nodes of ties][3] */
} gn_consistent;

gneiss_status gn_consistent_create(const gn_ties *ties, gn_consistent *system, gneiss_error *error);
/* Assembles N^T M N from the masses of the particles of ties, kg; 0: removed. */
void gn_consistent_assemble(gn_consistent *system, const double *mass);
void gn_consistent_free(gn_consistent *system);

/* Computes `rate` from `load`; returns the number of iterations. */
int gn_consistent_solve(gn_consistent *system);
/* Computes out = (lump - N^T M N) rate, N, [nodes of ties][3]. If it is added to the loads, lumped
 * masses accelerate as the consistent ones do. Its sum over the nodes is zero for any rates. */
void gn_consistent_difference(const gn_consistent *system, const double *rate, double *out);

#endif
