/* The springs of the linearised system, on which gn_step_limits and gn_step_holds operate. Used in
 * this folder and for larger systems that include these springs (src/timestep/coupled_limit.c). */
#ifndef GN_LIMIT_SPRINGS_H
#define GN_LIMIT_SPRINGS_H

#include "limit/step_limits.h"

#include <stdbool.h>

enum { GN_DOFS_MAX = 6 };

/* An active contact. The normal points from i to j; j < 0: a wall. */
typedef struct gn_spring {
    int32_t i, j;
    double n[3], arm_i, arm_j, kn, kt, cn;
    double bend, twist; /* stiffness against relative rotation, across the normal and about it */
} gn_spring;

typedef struct gn_springs {
    const gn_spectrum *spectrum;
    int threads, dofs;
    bool space, rotation, damped, bends;
    size_t particles, springs;
    int32_t *member; /* [particles] index in the specimen; NULL: all particles in their order */
    double *weight;  /* [particles] d > 0, see gn_block_of; NULL: all equal */
    /* [particles of the specimen] d of all particles, for springs that lead to particles outside;
     * NULL: all equal */
    const double *all_weights;
    /* [particles of the specimen] index among the members, -1: outside; NULL: all are members */
    int32_t *local;
    gn_spring *spring; /* [springs] */
    size_t *first;     /* [particles + 1] first entry of each particle */
    /* 2 * spring + (0: the particle is i, 1: it is j), ascending for each particle */
    uint32_t *entry;
    double *scale; /* [particles][dofs]: M^-1/2, 0 for fixed components */
    double *moved; /* [particles][dofs]: scratch of the operator, M^-1/2 x */
} gn_springs;

/* Builds the springs; with `inside` [particles of the specimen], only those of the marked
 * particles. The outer end of a spring to the outside is fixed, and the spring counts twice if that
 * end is free (|a - b|^2 <= 2|a|^2 + 2|b|^2). If every particle outside is then treated as a block
 * of its own, whose springs all count twice, the largest eigenvalue of the whole system is at most
 * the larger one of the two parts. */
gneiss_status gn_springs_build(const gn_spectrum *spectrum, const uint8_t *inside,
                               gn_springs *system, gneiss_error *error);
/* Builds the springs as above, but with factors that depend on the weights d instead of 2: |a -
 * b|^2 <= (1 + d_b/d_a)|a|^2 + (1 + d_a/d_b)|b|^2. */
gneiss_status gn_springs_build_weighed(const gn_spectrum *spectrum, const uint8_t *inside,
                                       const double *weights, gn_springs *system,
                                       gneiss_error *error);
/* Makes a system of the marked particles of `all` and of the springs between them. */
gneiss_status gn_springs_pick(const gn_springs *all, const uint8_t *inside, gn_springs *system,
                              gneiss_error *error);
void gn_springs_free(gn_springs *system);

/* Makes spring k of the active ones of bonds, pairs, wall contacts and further springs, which are
 * numbered in this order; returns false if the contact is not active. */
bool gn_spring_make(const gn_spectrum *spectrum, size_t k, gn_spring *out);
size_t gn_spring_count(const gn_spectrum *spectrum);

/* Returns the particles of contact k of bonds and pairs, active or not. */
size_t gn_spring_pairs(const gn_spectrum *spectrum);
/* Returns the contact list that contains spring *k, and makes *k the number of the contact in it.
 * NULL: it is no spring between particles, and *k becomes its number after all of those. */
const gn_contacts *gn_spring_list(const gn_spectrum *spectrum, size_t *k);
void gn_spring_ends(const gn_spectrum *spectrum, size_t k, int32_t *i, int32_t *j);

/* Tells whether any degree of freedom of a particle of the specimen is free; false for i < 0. */
bool gn_spectrum_can_move(const gn_spectrum *spectrum, int32_t i);
/* Tells whether any degree of freedom of a member of the system is free. */
bool gn_springs_can_move(const gn_springs *system, int32_t i);

/* Returns the index of a particle's degree of freedom among v x y z, w x y z. */
int gn_springs_component(const gn_springs *system, int dof);

/* Returns the index of a member in the specimen. */
static inline size_t gn_springs_place(const gn_springs *system, size_t p) {
    return system->member ? (size_t)system->member[p] : p;
}

/* The scaled diagonal blocks of one particle, [n][n]. A spring with two free ends counts twice (|a
 * - b|^2 <= 2|a|^2 + 2|b|^2), or with weights 1 + d_j/d_i times (|a - b|^2 <= (1 + e)|a|^2 + (1 +
 * 1/e)|b|^2 for any e > 0). */
typedef struct gn_block {
    int n, contacts;
    double a[GN_DOFS_MAX * GN_DOFS_MAX], b[GN_DOFS_MAX * GN_DOFS_MAX];
    double kn_max;
} gn_block;
void gn_block_of(const gn_springs *system, size_t p, gn_block *block);
/* Computes out = A + 2 tau B; returns the trace. */
double gn_block_at(const gn_block *block, double tau, double *out);
/* Returns |S^4|_F^(1/4) or the trace, whichever is smaller: a cheap upper bound of the largest
 * eigenvalue of S >= 0. */
double gn_block_upper(int n, const double *s, double trace);
/* Tells whether all eigenvalues of S are below `most`: then most I - S has a Cholesky factor. */
bool gn_block_below(int n, const double *s, double most);
/* Returns an upper bound of the largest eigenvalue of A + 2 tau B, round-off included, and its
 * vector. */
double gn_block_largest(const gn_block *block, double tau, double *vector);

/* A part of the operator: the particles [begin, end) whose results it computes, and the springs
 * that touch them, in ascending order. */
typedef struct gn_spring_part {
    size_t begin, end, springs;
    uint32_t *spring; /* NULL: all springs */
} gn_spring_part;

/* The operator of the springs, divided among threads. */
typedef struct gn_spring_operator {
    const gn_springs *system;
    gn_spring_part *part;
    int parts;
} gn_spring_operator;
gneiss_status gn_spring_operator_make(const gn_springs *system, gn_spring_operator *matrix,
                                      gneiss_error *error);
void gn_spring_operator_free(gn_spring_operator *matrix);
/* Computes out = scale (stiffness K + viscosity C) scale x, [particles][dofs]; the result is the
 * same for any number of threads. */
void gn_springs_apply(const gn_spring_operator *matrix, double stiffness, double viscosity,
                      const double *x, double *out);

/* Computes the sharp values of `limit`, which contains the bound already, and the fastest mode x
 * [particles][dofs], by Lanczos. */
gneiss_status gn_springs_mode(const gn_springs *system, double tolerance, double *x,
                              gn_step_limit *limit, gneiss_error *error);
/* Computes the bound and, with a tolerance, the sharp limit. */
gneiss_status gn_springs_limits(gn_springs *system, double tolerance, gn_step_limit *limit,
                                gneiss_error *error);

/* Computes the limit as Lanczos on all particles would, to the same relative tolerance, and sets
 * `found`. If more than a quarter of the particles could determine the limit, `found` is false and
 * `limit` is unchanged. `limit` has the rigorous bound, which particle `first` determines. The
 * result is the same for any number of threads. */
gneiss_status gn_springs_local_limit(gn_springs *system, size_t first, double tolerance,
                                     gn_step_limit *limit, bool *found, gneiss_error *error);

/* splitmix64 (Steele, Lea & Flood 2014). */
static inline uint64_t gn_hash_place(uint64_t place) {
    uint64_t z = (place + 1) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

#endif
