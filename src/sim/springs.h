/* The springs of the linearised system: what gn_step_limits and gn_step_holds work on. Inside
 * src/sim/springs.c and timestep.c only. */
#ifndef GN_SIM_SPRINGS_H
#define GN_SIM_SPRINGS_H

#include "sim/timestep.h"

#include <stdbool.h>

/* An active contact. The normal points from i to j; j < 0: a wall. */
typedef struct gn_spring {
    int32_t i, j;
    double n[3], arm_i, arm_j, kn, kt, cn;
} gn_spring;

typedef struct gn_springs {
    const gn_spectrum *spectrum;
    int threads, dofs;
    bool space, rotation, damped;
    size_t particles, springs;
    int32_t *member;   /* [particles] place in the specimen; NULL: all of it, in its order */
    double *weight;    /* [particles] d > 0, see particle_block; NULL: all the same */
    int32_t *local;    /* [of the specimen] place among the members, -1: outside; NULL: all of it */
    gn_spring *spring; /* [springs] */
    size_t *first;     /* [particles + 1] into entry */
    uint32_t
        *entry; /* 2 * spring + (0: the particle is i, 1: it is j), ascending for each particle */
    double *scale; /* [particles][dofs]: M^-1/2, 0 for what cannot move */
    double *moved; /* [particles][dofs]: scratch of the operator, M^-1/2 x */
} gn_springs;

/* With `inside` [particles of the specimen] only the springs of those particles. One that leads
 * outside is held fast there and counts twice if the other end can move (|a - b|^2 <= 2|a|^2 +
 * 2|b|^2): with every particle outside taken as a block of its own, of which all springs count
 * twice, the whole system is never above the larger of the two. */
gneiss_status gn_springs_build(const gn_spectrum *spectrum, const uint8_t *inside, gn_springs *y,
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

#endif
