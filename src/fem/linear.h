/* A solid linearised at its start: what its limit of the step is found of (limit.c), and for who
 * has it as a part of a larger system (src/timestep/coupled_limit.c). */
#ifndef GN_FEM_LINEAR_H
#define GN_FEM_LINEAR_H

#include "fem/solid.h"

typedef struct gn_fem_linear {
    gn_fem_solid *solid;
    int dimension, strains;
    double *scale;     /* [nodes][dimension] M^-1/2, 0 for prescribed components */
    double *moved;     /* [nodes][dimension] scratch of the operator */
    double *stiffness; /* [nodes] sum over its elements of the traces of their blocks at it */
    double *gradient;  /* pressure form: [nodes][4] projected gradient of q, q */
    double *pressure;  /* pressure form: [nodes] scratch */
} gn_fem_linear;

/* Of the elements by themselves; with `whole` the masses are those that the nodes move with, what
 * they carry included. */
gneiss_status gn_fem_linear_make(gn_fem_solid *solid, bool whole, gn_fem_linear *y,
                                 gneiss_error *error);
/* The same but for `stiffness`, which is zero as yet. */
gneiss_status gn_fem_linear_begin(gn_fem_solid *solid, bool whole, gn_fem_linear *y,
                                  gneiss_error *error);
void gn_fem_linear_free(gn_fem_linear *y);
/* out = scale K scale x, [nodes][dimension], of the displacement form, with a gn_fem_linear; the
 * partial sums of the step, which are made anew every time, hold the forces. */
void gn_fem_linear_apply(const void *system, const double *x, double *out);

#endif
