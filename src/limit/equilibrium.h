/* Displacements that bring the linearised system into equilibrium: the operator of the stability
 * limit is inverted by preconditioned conjugate gradients. */
#ifndef GN_LIMIT_EQUILIBRIUM_H
#define GN_LIMIT_EQUILIBRIUM_H

#include "limit/coarse.h"
#include "limit/step_limits.h"

/* Components of a particle: v x y z, w x y z; some may not exist. */
enum { GN_COMPONENTS = 6 };

typedef struct gn_equilibrium {
    int iterations;
    double residual; /* norm of the residual over that of the load, in the metric of the diagonal */
    int32_t unsupported; /* id of a particle with a load but without contacts; -1: none */
} gn_equilibrium;

/* Resistance to velocities for displacements at `rate` (1/s, 0: at rest): dashpots act as springs
 * of c_n rate, and drag (1/s) as one of m drag rate at every particle. */
typedef struct gn_viscosity {
    double rate, drag;
} gn_viscosity;

/* Data of a solution that accelerate later solutions of nearly the same system. {0}: none yet. To
 * be freed when particles are renumbered. */
typedef struct gn_preconditioner {
    size_t particles;
    float (*inverse)[36]; /* [particles] inverse blocks; zero for fixed components */
    double *ground;       /* [particles][6] regularisation, N/m and N m */
    double *weight;       /* [particles][6] 1/diagonal; 0 for fixed components */
    gn_coarse coarse;
    int uses;
} gn_preconditioner;
void gn_preconditioner_free(gn_preconditioner *made);

/* Solves K u = f for the active springs, with fixed components at rest. `load` [particles][6], N
 * and N m; `u` has the same shape, m and rad. Motions without resistance are regularised by 1e-6 of
 * the diagonal: far from an equilibrium unless the load is orthogonal to them. The result is the
 * same for any number of threads. */
gneiss_status gn_equilibrium_solve(const gn_spectrum *spectrum, gn_viscosity viscosity,
                                   const double *load, double tolerance, gn_preconditioner *made,
                                   double *u, gn_equilibrium *found, gneiss_error *error);

#endif
