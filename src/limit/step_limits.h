/* The largest stable step of the central-difference scheme: a rigorous bound and a sharp value. */
#ifndef GN_LIMIT_STEP_LIMITS_H
#define GN_LIMIT_STEP_LIMITS_H

#include "base/error.h"
#include "kernels/law.h"
#include "measure/measure.h"

/* An active contact with something that is not a particle and not a plane wall. */
typedef struct gn_extra_spring {
    int32_t particle;
    double n[3], arm, kn, kt, cn; /* normal into the surface; m, N/m, N/m, N s/m */
} gn_extra_spring;

/* The linearised system about the present state. Active springs: bonds that hold; other contacts
 * and wall contacts while they touch (gap < 0, with length0 instead of r_i + r_j for broken bonds).
 * Contacts with surfaces come as `extra`. Fixed degrees of freedom (prescribed components) count as
 * immovable. */
typedef struct gn_spectrum {
    const gn_assembly *assembly;
    double arm_factor;              /* 0.5: arms r + u_n/2, 0: arms r */
    const double *wall_point;       /* [walls][4] */
    const gn_touch_side *wall_side; /* [materials][walls] */
    const double *wall_damping;     /* [walls]: damping fraction; NULL: none */
    const gn_extra_spring *extra;   /* [extra_count], by particle */
    size_t extra_count;
    double reach;         /* m: contacts with a gap of up to this count as touching as well */
    const uint8_t *slips; /* [bonds, pairs, wall contacts] those that slide, which nothing but the
                           * normal spring resists; NULL: all stick */
    const uint8_t *fixed; /* [particles] bit k: component k (v xyz, w xyz) prescribed; NULL: none */
    double dashpots;      /* their coefficients count so many times; 0: once */
    int threads;
} gn_spectrum;

typedef struct gn_step_limit {
    /* s: 2/w from w^2 <= 2 max_i lambda_max(M_i^-1 K_ii): never above the true limit */
    double bound;
    int32_t bound_id;  /* the particle that sets it */
    double sharp;      /* s: 2/w_max by Lanczos, contact damping included (see below) */
    double sharp_low;  /* s: 2/sqrt(ritz value + its residual), never below `bound` */
    int32_t sharp_id;  /* the particle with the largest share in the fastest mode */
    int iterations;    /* Lanczos vectors used in total */
    double frequency;  /* w_max, rad/s, undamped */
    double literature; /* s: min_i 2 sqrt(m_i/max k_n of its contacts), one spring per particle */
    size_t springs;    /* active contacts */
} gn_step_limit;

/* With contact damping c_n the explicit scheme (forces from the last half-step velocity) is stable
 * if M - dt/2 C - dt^2/4 K is positive definite: the sharp limit solves dt^2/4 lambda_max(M^-1 (K +
 * (2/dt) C)) = 1. Without any active spring every limit is INFINITY. `tolerance`: relative residual
 * at which Lanczos stops (1e-4 is plenty). Deterministic for any number of threads. */
gneiss_status gn_step_limits(const gn_spectrum *spectrum, double tolerance, gn_step_limit *limit,
                             gneiss_error *error);

/* Only the rigorous bound (cheap: one pass), damping included: used to watch a run. */
gneiss_status gn_step_bound(const gn_spectrum *spectrum, gn_step_limit *limit, gneiss_error *error);

/* What gn_step_holds finds. */
typedef struct gn_step_verdict {
    bool holds;   /* the scheme is stable at the step asked for */
    double limit; /* s, if not, and if it is asked for: a step that is */
} gn_step_verdict;

/* Whether `step` is stable, at a small part of the cost of gn_step_limits: sums of stiffness over
 * mass settle nearly all particles, the blocks of the rigorous bound most others; what is left is
 * taken with its neighbours, and the shares of springs between two particles are shifted until
 * every block is below. With a `tolerance` Lanczos has the last word, on these particles as a
 * system of its own in which springs that lead out of it count twice. `changed` [particles]: only
 * these and their neighbours are looked at, the rest has been found to hold before; NULL: all are.
 * `limit`: whether verdict->limit is asked for, which without a tolerance costs much more than
 * whether the step holds. A step of INFINITY asks whether nothing resists any motion, and no limit
 * comes of it. */
gneiss_status gn_step_holds(const gn_spectrum *spectrum, double step, double tolerance, bool limit,
                            const uint8_t *changed, gn_step_verdict *verdict, gneiss_error *error);

/* Whether the sums of stiffness over mass by themselves settle it for all particles: one pass, and
 * however the springs are directed. False says nothing. */
gneiss_status gn_step_holds_by_sums(const gn_spectrum *spectrum, double step, bool *holds,
                                    gneiss_error *error);

/* By what factor, at least 1, each particle's own mass [particles] has to be multiplied for `step`
 * to hold, by blocks as in the rigorous bound: with such masses, and moments of inertia alike, the
 * bound is the step, but for dashpots that grow with the masses. `changed` [particles]: only of
 * these and their neighbours, and 1 for all others and for who has as much already; NULL: of all.
 */
gneiss_status gn_step_masses(const gn_spectrum *spectrum, double step, const uint8_t *changed,
                             double *factor, gneiss_error *error);

/* Hashes of the active springs of each particle, intact bonds left out, in any order: another one
 * means that there are others. */
void gn_step_marks(const gn_spectrum *spectrum, int32_t *marks);

/* Marks the ends of the active contacts between particles whose normals have turned by more than
 * `most` rad since they were last marked, or first seen, here; returns how many contacts these are.
 * The limit of springs that turn against each other changes although they stay the same. */
size_t gn_step_turned(const gn_spectrum *spectrum, double most, uint8_t *turned);

#endif
