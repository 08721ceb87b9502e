/* The springs of the linearised system: what gn_step_limits and gn_step_holds work on. Inside
 * src/limit/springs.c, step_limits.c, step_holds.c and equilibrium.c, and for who has the springs
 * as a part of a larger system (src/timestep/coupled_limit.c). */
#ifndef GN_LIMIT_SPRINGS_H
#define GN_LIMIT_SPRINGS_H

#include "limit/step_limits.h"

#include <stdbool.h>

enum { GN_DOFS_MAX = 6 };

/* An active contact. The normal points from i to j; j < 0: a wall. */
typedef struct gn_spring {
    int32_t i, j;
    double n[3], arm_i, arm_j, kn, kt, cn;
    double bend, twist; /* against the difference of the spins, across the normal and along it */
} gn_spring;

typedef struct gn_springs {
    const gn_spectrum *spectrum;
    int threads, dofs;
    bool space, rotation, damped, bends;
    size_t particles, springs;
    int32_t *member; /* [particles] place in the specimen; NULL: all of it, in its order */
    double *weight;  /* [particles] d > 0, see gn_block_of; NULL: all the same */
    const double *all_weights; /* the same of all particles of the specimen, for springs that lead
                                * out of the system; NULL: all the same */
    int32_t *local;    /* [of the specimen] place among the members, -1: outside; NULL: all of it */
    gn_spring *spring; /* [springs] */
    size_t *first;     /* [particles + 1] into entry */
    /* 2 * spring + (0: the particle is i, 1: it is j), ascending for each particle */
    uint32_t *entry;
    double *scale; /* [particles][dofs]: M^-1/2, 0 for what cannot move */
    double *moved; /* [particles][dofs]: scratch of the operator, M^-1/2 x */
} gn_springs;

/* With `inside` [particles of the specimen] only the springs of those particles. One that leads
 * outside is held fast there and counts twice if the other end can move (|a - b|^2 <= 2|a|^2 +
 * 2|b|^2): with every particle outside taken as a block of its own, of which all springs count
 * twice, the whole system is never above the larger of the two. */
gneiss_status gn_springs_build(const gn_spectrum *spectrum, const uint8_t *inside, gn_springs *y,
                               gneiss_error *error);
/* With d of all particles instead of "twice": |a - b|^2 <= (1 + d_b/d_a)|a|^2 + (1 + d_a/d_b)|b|^2.
 */
gneiss_status gn_springs_build_weighed(const gn_spectrum *spectrum, const uint8_t *inside,
                                       const double *weights, gn_springs *y, gneiss_error *error);
/* Some of the particles of the system of all of them, with all their springs, whose ends are both
 * among them. */
gneiss_status gn_springs_pick(const gn_springs *all, const uint8_t *inside, gn_springs *y,
                              gneiss_error *error);
void gn_springs_free(gn_springs *y);

/* Contact k of bonds, pairs, wall contacts and further springs counted through; false: not active.
 */
bool gn_spring_make(const gn_spectrum *spectrum, size_t k, gn_spring *s);
size_t gn_spring_count(const gn_spectrum *spectrum);

/* Particles of contact k of bonds and pairs counted through; without looking whether it is active.
 */
size_t gn_spring_pairs(const gn_spectrum *spectrum);
void gn_spring_ends(const gn_spectrum *spectrum, size_t k, int32_t *i, int32_t *j);

/* Marks the neighbours of what is marked [particles of the specimen] as well, with one more than
 * the highest mark so far. */
void gn_springs_mark_neighbours(const gn_spectrum *spectrum, uint8_t highest, uint8_t *marked);

/* Whether any degree of freedom of a particle of the specimen can move; false for i < 0. */
bool gn_spectrum_can_move(const gn_spectrum *spectrum, int32_t i);
/* The same of a member of the system. */
bool gn_springs_can_move(const gn_springs *y, int32_t i);

/* Place of a particle's degree of freedom in v x y z, w x y z. */
int gn_springs_component(const gn_springs *y, int dof);

/* Place in the specimen. */
static inline size_t gn_springs_place(const gn_springs *y, size_t p) {
    return y->member ? (size_t)y->member[p] : p;
}

/* The scaled diagonal blocks of one particle, [n][n]. Springs with two movable ends count twice (|a
 * - b|^2 <= 2|a|^2 + 2|b|^2), or 1 + d_j/d_i times (|a - b|^2 <= (1 + e)|a|^2 + (1 + 1/e)|b|^2). */
typedef struct gn_block {
    int n, contacts;
    double a[GN_DOFS_MAX * GN_DOFS_MAX], b[GN_DOFS_MAX * GN_DOFS_MAX];
    double kn_max;
} gn_block;
void gn_block_of(const gn_springs *y, size_t p, gn_block *m);
/* out = A + 2 tau B; returns the trace. */
double gn_block_at(const gn_block *m, double tau, double *out);
/* |S^4|_F^(1/4) or the trace, whichever is smaller: not below the largest eigenvalue of S >= 0, and
 * cheap. */
double gn_block_upper(int n, const double *s, double trace);
/* Marks [particles of the specimen] the members whose own block is above the step 1/tau, unmarks
 * the others; returns how many are marked. */
size_t gn_springs_above(const gn_springs *y, double tau, uint8_t *marked);
/* Looks for weights, y->weight, which the caller or gn_springs_free frees, with which every block
 * of the system is below the step 1/tau. A particle whose block is above gets more weight, which
 * leaves more of its springs to its neighbours. Only those with mark 1 [particles of the specimen]
 * are above to start with; those with the highest have neighbours outside. Whether it found them;
 * with `left` [particles, zero] it marks there for which ones it does not, and is false only
 * without memory: all others are below, whatever weights the marked ones have up to theirs. */
bool gn_springs_settle(gn_springs *y, double tau, const uint8_t *marked, uint8_t highest,
                       uint8_t *left);
/* Whether all eigenvalues of S are below `most`: most I - S has a Cholesky factor. */
bool gn_block_below(int n, const double *s, double most);
/* The largest eigenvalue of A + 2 tau B from above, round-off included, and its vector. */
double gn_block_top(const gn_block *m, double tau, double *vector);

/* What one of the parts works on that the particles are dealt out in: its own particles, [begin,
 * end), and the springs that touch them, ascending. */
typedef struct gn_spring_part {
    size_t begin, end, springs;
    uint32_t *spring; /* NULL: all of them */
} gn_spring_part;

/* The operator of the springs, dealt out among threads. */
typedef struct gn_spring_operator {
    const gn_springs *system;
    gn_spring_part *part;
    int parts;
} gn_spring_operator;
gneiss_status gn_spring_operator_make(const gn_springs *y, gn_spring_operator *o,
                                      gneiss_error *error);
void gn_spring_operator_free(gn_spring_operator *o);
/* out = scale (stiffness K + viscosity C) scale x, [particles][dofs], the same for any number of
 * threads. */
void gn_springs_apply(const gn_spring_operator *o, double stiffness, double viscosity,
                      const double *x, double *out);

/* Sets what is sharp in `limit`, which has the bound, and the fastest mode x [particles][dofs], by
 * Lanczos. */
gneiss_status gn_springs_mode(const gn_springs *y, double tolerance, double *x,
                              gn_step_limit *limit, gneiss_error *error);
/* Bound and, with a tolerance, the sharp limit. */
gneiss_status gn_springs_limits(gn_springs *y, double tolerance, gn_step_limit *limit,
                                gneiss_error *error);

/* splitmix64 (Steele, Lea & Flood 2014). */
static inline uint64_t gn_scramble(uint64_t place) {
    uint64_t z = (place + 1) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

#endif
