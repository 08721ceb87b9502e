/* A solid linearised at its start: for the limit of its step (limit.c), and for larger systems of
 * which it is a part (src/timestep/coupled_limit.c). */
#ifndef GN_FEM_LINEAR_H
#define GN_FEM_LINEAR_H

#include "fem/fem.h"

typedef struct gn_fem_linear {
    gn_fem_solid *solid;
    int dimension, strains;
    double *scale;     /* [nodes][dimension] M^-1/2, 0 for prescribed components */
    double *moved;     /* [nodes][dimension] scratch of the operator */
    double *stiffness; /* [nodes] sum over the elements of a node of the traces of their blocks */
    double *gradient;  /* pressure form: [nodes][4] projected gradient of q, and q */
    double *pressure;  /* pressure form: [nodes] scratch */
} gn_fem_linear;

/* Linearises the elements. With `whole`, masses include those that nodes carry, so that they are
 * the masses of the motion. */
gneiss_status gn_fem_linear_make(gn_fem_solid *solid, bool whole, gn_fem_linear *system,
                                 gneiss_error *error);
void gn_fem_linear_free(gn_fem_linear *system);
/* Computes out = scale K scale x, [nodes][dimension], for the displacement form; `system` is a
 * gn_fem_linear. The forces use the partial sums of the step, which every step overwrites. */
void gn_fem_linear_apply(const void *system, const double *x, double *out);

#endif
