/* The coarse level of a preconditioner: relative motions of groups of neighbours, which the
 * preconditioner's blocks of single particles do not resolve. The unknowns are the rigid motions of
 * every group, which gives a small dense system (the coarse level of Nicolaides 1987; Smith,
 * Bjorstad & Gropp 1996, ch. 2). */
#ifndef GN_LIMIT_COARSE_H
#define GN_LIMIT_COARSE_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gn_coarse {
    size_t particles, groups, n; /* n = 6 groups */
    double *arm;                 /* [particles][3] arm from the centre of its group, m */
    double *factor;              /* [n][n] Cholesky factor, lower triangle */
    double *x;                   /* [n] right-hand side and solution */
} gn_coarse;

/* Creates groups of consecutive particles, which are numbered along a space-filling curve. `pos`
 * [particles][4]. */
gneiss_status gn_coarse_create(gn_coarse *coarse, size_t particles, const double *pos,
                               gneiss_error *error);
void gn_coarse_free(gn_coarse *coarse);

/* A spring of energy 1/2 e.(k_t e + (k_n - k_t)(e.n) n). Its displacement e is the sum of by_p[k]
 * u_p[k] and by_q[k] u_q[k] over the six components k of its particles p and q; q < 0: of p alone.
 */
typedef struct gn_coarse_spring {
    int32_t p, q;
    double n[3], kn, kt;
    double by_p[6][3], by_q[6][3];
} gn_coarse_spring;
void gn_coarse_add(gn_coarse *coarse, const gn_coarse_spring *spring);
/* Adds a resistance to each component of particle p. */
void gn_coarse_ground(gn_coarse *coarse, size_t p, const double ground[6]);

/* Factors the matrix after all springs were added. */
void gn_coarse_factor(gn_coarse *coarse);

/* Sets x of group g to the work of the loads `r` [particles][6] of its particles on its six rigid
 * motions. */
void gn_coarse_gather(const gn_coarse *coarse, size_t g, const double *r, const uint8_t *free);
/* Replaces x by K^-1 x. */
void gn_coarse_solve(const gn_coarse *coarse);
/* Adds the motion of particle p with its group to z [6]. */
void gn_coarse_spread(const gn_coarse *coarse, size_t p, unsigned free, double *z);

static inline size_t gn_coarse_first(const gn_coarse *coarse, size_t g) {
    return coarse->particles * g / coarse->groups;
}

#endif
