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
 * contacts while they touch (gap < 0; the gap of a broken bond is relative to length0 instead of
 * r_i + r_j). Contacts with surfaces are in `extra`. Prescribed degrees of freedom are fixed. */
typedef struct gn_spectrum {
    const gn_assembly *assembly;
    double arm_factor;              /* 0.5: arms are r + u_n/2; 0: arms are r */
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
    double dashpots;  /* factor by which dashpot coefficients are multiplied; 0: 1 */
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
    double limit; /* s, a stable step, if the given step is not stable and a limit is requested */
} gn_step_verdict;

/* Tells whether `step` is stable, at a small fraction of the cost of gn_step_limits. Sums of
 * stiffness over mass decide for nearly all particles, the blocks of the rigorous bound for most
 * others. The remaining ones are examined with their neighbours: the shares of springs between two
 * particles are shifted until every block is below the limit. With a `tolerance` Lanczos has the
 * final decision, on these particles as a system of its own in which springs to the outside count
 * twice. `changed` [particles]: only these and their neighbours are examined, because the others
 * are known to be stable; NULL: all are examined. `limit`: verdict->limit is requested; without a
 * tolerance this costs much more than the decision. With a step of INFINITY the question is whether
 * any motion has a resistance, and there is no limit. */
gneiss_status gn_step_holds(const gn_spectrum *spectrum, double step, double tolerance, bool limit,
                            const uint8_t *changed, gn_step_verdict *verdict, gneiss_error *error);

/* Tells whether the sums of stiffness over mass alone prove that the step is stable for all
 * particles, whatever the directions of their springs; one pass. False proves nothing. */
gneiss_status gn_step_holds_by_sums(const gn_spectrum *spectrum, double step, bool *holds,
                                    gneiss_error *error);

/* Computes the factor, at least 1, by which each particle's own mass [particles] has to be
 * multiplied for `step` to be stable by the blocks of the rigorous bound. With such masses, and
 * moments of inertia multiplied likewise, the bound equals the step, except for dashpots that grow
 * with the masses. `changed` [particles]: only these and their neighbours are computed, and all
 * others get the factor 1; NULL: all are computed. */
gneiss_status gn_step_masses(const gn_spectrum *spectrum, double step, const uint8_t *changed,
                             double *factor, gneiss_error *error);

/* Computes a hash of the active springs of each particle, except intact bonds, independent of their
 * order: if the hash has changed, the springs have. */
void gn_step_contact_hashes(const gn_spectrum *spectrum, int32_t *marks);

/* Marks the ends of the active contacts between particles whose normals have rotated by more than
 * `most` rad since this function last marked or first saw them; returns the number of these
 * contacts. If springs rotate relative to each other, the limit changes although the springs stay
 * the same. */
size_t gn_step_rotated_contacts(const gn_spectrum *spectrum, double most, uint8_t *turned);

#endif
