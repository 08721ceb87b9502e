/* Eigenvalues of symmetric matrices: all of a small dense one, the largest of a huge implicit one.
 */
#ifndef GN_BASE_EIGEN_H
#define GN_BASE_EIGEN_H

#include "base/error.h"

#include <stddef.h>

/* All eigenpairs of the symmetric matrix a [n][n] (destroyed) by cyclic Jacobi rotations (Golub &
 * Van Loan, Matrix Computations, 8.5). values [n] descending; vectors [n][n], row k belongs to
 * value k. Errors are a few n units of round-off of the Frobenius norm. */
void gn_eigen_symmetric(int n, double *a, double *values, double *vectors);

/* y = S x for a symmetric S. */
typedef void gn_operator(const void *context, const double *x, double *y);

typedef struct gn_eigen_top {
    double value;    /* Ritz value: never above the largest eigenvalue, but for round-off */
    double residual; /* |S x - value x| for the unit Ritz vector x: an eigenvalue lies this close */
    int vectors;     /* products S x taken */
} gn_eigen_top;

/* The largest eigenvalue of a positive semi-definite S by thick-restart Lanczos (Wu & Simon 2000)
 * with full reorthogonalisation. `vector` [n]: the start (any length but zero) and, on return, the
 * unit Ritz vector. Ends at residual <= tolerance * value, or after 4000 products with the residual
 * reached. The same bits for any number of threads if `apply` gives them. */
gneiss_status gn_eigen_largest(size_t n, gn_operator *apply, const void *context, double tolerance,
                               int threads, double *vector, gn_eigen_top *top, gneiss_error *error);

/* The same for an operator S that is symmetric and positive semi-definite in the metric of B, x . B
 * S y = S x . B y; `metric` gives B x, with B symmetric and positive semi-definite. Lengths are
 * sqrt(x . B x). NULL: B = 1. */
gneiss_status gn_eigen_largest_in(size_t n, gn_operator *apply, gn_operator *metric,
                                  const void *context, double tolerance, int threads,
                                  double *vector, gn_eigen_top *top, gneiss_error *error);

/* x . y, the same bits for any number of threads. */
double gn_eigen_dot(size_t n, const double *x, const double *y, int threads);

#endif
