/* The largest stable step of the central-difference scheme: a rigorous bound and a sharp value. */
#ifndef GN_LIMIT_STEP_LIMITS_H
#define GN_LIMIT_STEP_LIMITS_H

#include "base/error.h"
#include "kernels/law.h"
#include "measure/measure.h"

/* An active contact with a surface or another object that is neither a particle nor a plane
 * wall. */
typedef struct gn_extra_spring {
    int32_t particle;
    double n[3], arm, kn, kt, cn; /* normal into the surface; m, N/m, N/m, N s/m */
} gn_extra_spring;

/* The linearised system about the present state. Active springs are intact bonds, and other
 * contacts and wall contacts while they touch (gap < 0, with length0 instead of r_i + r_j for
 * broken bonds). Contacts with surfaces are in `extra`. Fixed degrees of freedom (prescribed
 * components) do not move. */
typedef struct gn_spectrum {
    const gn_assembly *assembly;
    double arm_factor;              /* 0.5: arms r + u_n/2, 0: arms r */
    const double *wall_point;       /* [walls][4] */
    const gn_touch_side *wall_side; /* [materials][walls] */
    const double *wall_damping;     /* [walls]: damping fraction; NULL: none */
    const gn_extra_spring *extra;   /* [extra_count], by particle */
    size_t extra_count;
    double reach; /* m: contacts with a gap of up to this count as touching */
    /* [bonds, pairs, wall contacts] sliding contacts, which only resist along their normal; NULL:
     * all stick */
    const uint8_t *slips;
    const uint8_t
        *fixed;       /* [particles] bit k: component k (v xyz, w xyz) is prescribed; NULL: none */
    double dashpots;  /* factor of dashpot coefficients; 0: 1 */
    bool bonds_alone; /* only intact bonds are active */
    int threads;
} gn_spectrum;

typedef struct gn_step_limit {
    /* s: 2/w from w^2 <= 2 max_i lambda_max(M_i^-1 K_ii): never above the true limit */
    double bound;
    int32_t bound_id;  /* the particle that determines it */
    double sharp;      /* s: 2/w_max by Lanczos, contact damping included, see gn_step_limits */
    double sharp_low;  /* s: 2/sqrt(ritz value + its residual), never below `bound` */
    int32_t sharp_id;  /* the particle with the largest share of the fastest mode */
    int iterations;    /* Lanczos vectors used in total */
    double frequency;  /* w_max, rad/s, undamped */
    double literature; /* s: min_i 2 sqrt(m_i/max k_n of its contacts), one spring per particle */
    size_t springs;    /* active contacts */
} gn_step_limit;

/* Computes both limits. With contact damping c_n the explicit scheme (forces from the last
 * half-step velocity) is stable if M - dt/2 C - dt^2/4 K is positive definite: the sharp limit
 * solves dt^2/4 lambda_max(M^-1 (K + (2/dt) C)) = 1. Without any active spring every limit is
 * INFINITY. `tolerance`: relative residual at which Lanczos stops (1e-4 is ample); 0: only the
 * rigorous bound, in one cheap pass. The result is the same for any number of threads. */
gneiss_status gn_step_limits(const gn_spectrum *spectrum, double tolerance, gn_step_limit *limit,
                             gneiss_error *error);

/* The result of gn_step_holds. */
typedef struct gn_step_verdict {
    bool holds;   /* the scheme is stable at the given step */
    double limit; /* s, a stable step, if the given one is not and a limit is requested */
} gn_step_verdict;

/* Tells whether `step` is stable, at a small fraction of the cost of gn_step_limits: sums of
 * stiffness over mass decide for nearly all particles, the blocks of the rigorous bound for most
 * others; the rest is examined with its neighbours, and the shares of springs between two particles
 * are shifted until every block is below. With a `tolerance` Lanczos decides finally, on these
 * particles as a system of its own in which springs to the outside count twice. `changed`
 * [particles]: only these and their neighbours are examined, the others are known to be stable;
 * NULL: all are examined. `limit`: verdict->limit is requested, which without a tolerance costs
 * much more than the decision. A step of INFINITY asks whether no motion has any resistance, and
 * gives no limit. */
gneiss_status gn_step_holds(const gn_spectrum *spectrum, double step, double tolerance, bool limit,
                            const uint8_t *changed, gn_step_verdict *verdict, gneiss_error *error);

/* Tells whether the sums of stiffness over mass alone prove the step stable for all particles, in
 * one pass, for any directions of the springs. False is no statement. */
gneiss_status gn_step_holds_by_sums(const gn_spectrum *spectrum, double step, bool *holds,
                                    gneiss_error *error);

/* Computes the factor, at least 1, by which each particle's own mass [particles] has to be
 * multiplied for `step` to be stable, by blocks as in the rigorous bound: with such masses, and
 * moments of inertia likewise, the bound is the step, except for dashpots that grow with the
 * masses. `changed` [particles]: only for these and their neighbours, and 1 for all others and for
 * those with sufficient mass; NULL: for all. */
gneiss_status gn_step_masses(const gn_spectrum *spectrum, double step, const uint8_t *changed,
                             double *factor, gneiss_error *error);

/* Computes hashes of the active springs of each particle, without intact bonds, in any order: a
 * changed hash means changed springs. */
void gn_step_contact_hashes(const gn_spectrum *spectrum, int32_t *marks);

/* Marks the ends of the active contacts between particles whose normals have rotated by more than
 * `most` rad since they were last marked, or first seen, here; returns the number of these
 * contacts. The limit of springs that rotate relative to each other changes although they stay the
 * same. */
size_t gn_step_rotated_contacts(const gn_spectrum *spectrum, double most, uint8_t *turned);

#endif
