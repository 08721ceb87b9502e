/* Lists, linear system and iterations of the fit, for its tests. */
#ifndef GN_PACK_FIT_PRIVATE_H
#define GN_PACK_FIT_PRIVATE_H

#include "neigh/neigh.h"
#include "pack/fit.h"
#include "sched/pace.h"

typedef double gn_d4 __attribute__((vector_size(32)));
typedef float gn_f4 __attribute__((vector_size(16)));

/* Number of particles in a block. Sums are formed in blocks and added up in order, so that their
 * bits do not depend on the number of threads. */
enum { GN_FIT_BLOCK = 256 };

/* A row of the Jacobian for one particle, times the root of its weight: n x y z, then -(1 -
 * overlap) for pairs or -1 for planes. Single precision suffices, because the row determines the
 * direction of a step and not its goal. */
typedef gn_f4 gn_fit_term;

struct gn_fit {
    int dimension, threads;
    gn_pace pace; /* pace of the iterations */
    size_t count, blocks;
    const gn_domain *domain;
    const double *wanted, *least, *most;

    gn_d4 *x, *trial;       /* [count] x y z r */
    gn_particles particles; /* particles in the form that the search takes */

    /* First neighbour of particle i; its neighbours are [first[i], first[i + 1]). */
    size_t *first;      /* [count + 1] */
    size_t capacity;    /* capacity of the arrays below */
    int32_t *neighbour; /* [first[count]] */
    uint8_t *held;      /* [first[count]] */
    gn_pair_list hold;  /* held pairs, sorted */
    bool holding;
    uint8_t *near_wall; /* [count] */

    /* Terms at x with nonzero weight: [first_term[i], first_term[i] + terms[i]), with room for the
     * planes. */
    size_t *first_term;
    int32_t *terms;
    size_t term_capacity;
    gn_fit_term *term;
    int32_t *partner; /* index of the partner; `count` (a row of zeros) for planes */

    gn_d4 *gradient;       /* [count] */
    double *local;         /* [count][2] diagonal of springs and damping: centre, radius */
    float *inverse;        /* [count][16] inverse of the diagonal block */
    gn_d4 *step;           /* [count] */
    gn_d4 *r, *z, *p, *ap; /* [count + 1] vectors of conjugate gradients; p[count] is zero */

    double *partial; /* [blocks][GN_FIT_SUMS] */
    double damping;  /* damping of Levenberg-Marquardt, relative to the diagonal block */
    gn_fit_state state;
};

enum { GN_FIT_SUMS = 5 }; /* energy, scale, squared gaps, their number, largest overlap */

static inline size_t gn_fit_block_end(const gn_fit *fit, size_t block) {
    size_t end = (block + 1) * GN_FIT_BLOCK;
    return end < fit->count ? end : fit->count;
}

static inline double gn_d4_sum(gn_d4 a) {
    return (a[0] + a[1]) + (a[2] + a[3]);
}

/* Builds neighbour lists for the present rows. */
gneiss_status gn_fit_lists(gn_fit *fit, double reach, gneiss_error *error);

/* Computes energy and figures for the rows `x`; with `terms` also the terms and the gradient. */
void gn_fit_assemble(gn_fit *fit, const gn_fit_law *law, const gn_d4 *x, bool terms,
                     gn_fit_state *state);

/* Solves (J^T J + damping D) step = -gradient by conjugate gradients with the inverse diagonal
 * blocks as preconditioner. Returns the number of products. */
int gn_fit_solve(gn_fit *fit, const gn_fit_law *law, int products, double tolerance);

#endif
