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

/* Where entries of a vector are those of a longer one that are not zero by themselves, `place` has
 * where they stand in it, ascending; all that sums are made of come out as of the longer one, to
 * the bit, if they are whole groups of so many of it, each from a multiple of that on. */
enum { GN_EIGEN_GROUP = 8 };

/* S that is symmetric and positive semi-definite in the metric of B, x . B S y = S x . B y, with B
 * symmetric and positive semi-definite. Lengths are sqrt(x . B x). */
typedef struct gn_eigen_system {
    size_t n;
    gn_operator *apply, *metric; /* S x; B x, NULL: B = 1 */
    const void *context;
    const size_t *place; /* [n] see above; NULL: there is no longer one */
    int threads;
} gn_eigen_system;

gneiss_status gn_eigen_largest_of(const gn_eigen_system *system, double tolerance, double *vector,
                                  gn_eigen_top *top, gneiss_error *error);

/* x . y, the same bits for any number of threads. */
double gn_eigen_dot(size_t n, const double *x, const double *y, int threads);
/* The same of entries with places. */
double gn_eigen_dot_of(const gn_eigen_system *system, const double *x, const double *y);

#endif
