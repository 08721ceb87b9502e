/* The fit of touching spheres: centres and radii such that neighbours touch each other and the
 * boundary, by the Levenberg-Marquardt method (Labra & Onate 2009; Labra 2012, ch. 3).
 *
 * With s = r_i + r_j and d = 2 or 3 dimensions, the sum of squares is
 *
 *     1/2 sum_pairs w_c s^(d-2) (|x_i - x_j| - (1 - overlap) s)^2          pairs of particles
 *   + 1/2 sum_walls w_b (2 r)^(d-2) (depth - r)^2                          planes near a particle
 *   + 1/2 sum_particles stiffness 2^d r^(d-2) (r - wanted)^2               springs on the radii
 *
 * Weights are constant within an iteration (Gauss-Newton). w_c is 1 where the spheres are too
 * close, `pull` where the gap is within reach (`gap`, or the pair is held), else 0. The first two
 * are Labra's residuals divided by about two radii, weighted so that a relative overlap costs
 * energy in proportion to volume: the springs then exert the same pressure on particles of any
 * size, and as that pressure decreases to zero the sum of the volumes reaches a maximum under the
 * constraint of no overlap. At such a maximum the mean number of contacts of a particle is that of
 * its unknowns: 6 in 2D and 8 in 3D. */
#ifndef GN_PACK_FIT_H
#define GN_PACK_FIT_H

#include "pack/domain.h"
#include "soa/records.h"

#include <stdint.h>

typedef struct gn_fit_law {
    double overlap;   /* wanted overlap over r_i + r_j */
    double gap;       /* relative gap up to which pairs are pulled together; 0: only held ones */
    double pull;      /* ratio of the weight of a gap to that of an overlap */
    double stiffness; /* relative stiffness of the springs on the radii */
    /* overlap over r_i + r_j from which further overlap has 20 times the weight; 0: none */
    double most;
    bool fixed_radii;
} gn_fit_law;

/* Limits and tolerances of a stage. */
typedef struct gn_fit_goal {
    int iterations; /* largest number of iterations of Levenberg-Marquardt */
    int products;   /* largest number of products of conjugate gradients per iteration */
    double solve;   /* relative residual (preconditioned) at which conjugate gradients stop */
    /* relative decrease of the sum of squares over five iterations below which the stage ends */
    double decrease;
    double reach; /* relative gap up to which neighbours are listed */
    int renew;    /* iterations between two neighbour searches */
} gn_fit_goal;

typedef struct gn_fit_state {
    int iteration; /* number of the iteration, counted through all stages */
    /* ratio of the sum of squares to that of a packing in which every sphere overlaps by its size;
     * dimensionless */
    double energy;
    double gap_rms; /* root mean square gap of active pairs over r_i + r_j */
    double overlap_max;
    size_t pairs; /* number of active pairs */
} gn_fit_state;

/* Called after every iteration; returning false stops the fit. */
typedef bool gn_fit_watch(void *context, const gn_fit_state *state);

typedef struct gn_fit gn_fit;

/* Creates a fit. `row` [count][4] x y z r is copied. `wanted`, `least`, `most` [count] are the rest
 * lengths of the springs on the radii and the bounds of the radii; they are borrowed and may be
 * changed between stages. `domain` is borrowed. */
gneiss_status gn_fit_create(const gn_domain *domain, size_t count, const double *row,
                            const double *wanted, const double *least, const double *most,
                            int threads, gn_fit **out, gneiss_error *error);
void gn_fit_free(gn_fit *fit);

/* Runs one stage; *go_on is false if `watch` ended it. The result has the same bits for any number
 * of threads. */
gneiss_status gn_fit_run(gn_fit *fit, const gn_fit_law *law, const gn_fit_goal *goal,
                         gn_fit_watch *watch, void *context, bool *go_on, gneiss_error *error);

/* Holds the pairs that touch or overlap: from now on they are pulled together at any gap within the
 * reach of the search. */
gneiss_status gn_fit_hold(gn_fit *fit, gneiss_error *error);
void gn_fit_release(gn_fit *fit);

/* Returns the present x y z r, [count][4]. */
const double *gn_fit_rows(const gn_fit *fit);

#endif
