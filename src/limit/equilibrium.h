/* Displacements that bring the linearised system into equilibrium: the operator of the stability
 * limit, solved by preconditioned conjugate gradients. */
#ifndef GN_LIMIT_EQUILIBRIUM_H
#define GN_LIMIT_EQUILIBRIUM_H

#include "limit/coarse.h"
#include "limit/step_limits.h"

/* Components of a particle: v x y z, w x y z, whatever of them there are. */
enum { GN_COMPONENTS = 6 };

typedef struct gn_equilibrium {
    int iterations;
    double residual; /* what is left of the load, over it, in the metric of the diagonal */
    int32_t loose;   /* id of a particle with a load that touches nothing; -1: none */
} gn_equilibrium;

/* What resists velocities, where displacements come at `rate` (1/s, 0: at rest): dashpots as
 * springs of c_n rate, and drag (1/s) as one of m drag rate at every particle. */
typedef struct gn_viscosity {
    double rate, drag;
} gn_viscosity;

/* What a solution has made to come to the next ones of nearly the same system sooner. {0}: nothing
 * yet. To be emptied when particles are numbered anew. */
typedef struct gn_preconditioner {
    size_t particles;
    float (*inverse)[36]; /* [particles] of their blocks; zero in what cannot move */
    double *ground;       /* [particles][6] what resists everywhere, N/m and N m */
    double *weight;       /* [particles][6] 1/diagonal; 0 in what cannot move */
    gn_coarse coarse;
    int uses;
} gn_preconditioner;
void gn_preconditioner_free(gn_preconditioner *made);

/* K u = f for the active springs, fixed components at rest. `load` [particles][6], N and N m; `u`
 * the same, m and rad. Motions that no spring resists are resisted by 1e-6 of the diagonal: far
 * from an equilibrium unless the load has no part in them. Deterministic for any number of threads.
 */
gneiss_status gn_equilibrium_solve(const gn_spectrum *spectrum, gn_viscosity viscosity,
                                   const double *load, double tolerance, gn_preconditioner *made,
                                   double *u, gn_equilibrium *found, gneiss_error *error);

#endif
