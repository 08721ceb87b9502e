/* Eigenvalues of symmetric matrices: all of a small dense one, or the largest of a large implicit
 * one. */
#ifndef GN_BASE_EIGEN_H
#define GN_BASE_EIGEN_H

#include "base/error.h"

#include <stddef.h>

/* Finds all eigenpairs of the symmetric matrix a [n][n] (destroyed) by cyclic Jacobi rotations
 * (Golub & Van Loan, Matrix Computations, 8.5). values [n] are descending; row k of vectors [n][n]
 * belongs to value k. Errors are a few n units of round-off of the Frobenius norm. */
void gn_eigen_symmetric(int n, double *a, double *values, double *vectors);

/* Computes y = S x for a symmetric S. */
typedef void gn_operator(const void *context, const double *x, double *y);

typedef struct gn_eigen_top {
    double value;    /* Ritz value; it exceeds the largest eigenvalue by round-off at most */
    double residual; /* |S x - value x| of the unit Ritz vector x: an eigenvalue is within this
                        distance */
    int vectors;     /* number of products S x */
} gn_eigen_top;

/* A vector may contain only those entries of a longer one that do not vanish identically; `place`
 * has their indices in the longer one, ascending. All sums then equal those of the longer vector to
 * the bit if the entries form complete groups of GN_EIGEN_GROUP, each of which starts at a multiple
 * of that. */
enum { GN_EIGEN_GROUP = 8 };

/* An operator S that is symmetric and positive semi-definite in the metric of B, x . B S y = S x .
 * B y, where B is symmetric and positive semi-definite. Lengths are sqrt(x . B x). */
typedef struct gn_eigen_system {
    size_t n;
    gn_operator *apply, *metric; /* S x; B x, NULL: B = 1 */
    const void *context;
    const size_t *place; /* [n] see GN_EIGEN_GROUP; NULL: vectors are complete */
    int threads;
} gn_eigen_system;

/* Finds the largest eigenvalue of a positive semi-definite S by thick-restart Lanczos (Wu & Simon
 * 2000) with full reorthogonalisation. `vector` [n] is the start vector (of any nonzero length)
 * and, on return, the unit Ritz vector. The search ends when residual <= tolerance * value, or
 * after 4000 products with the residual reached by then. The result has the same bits for any
 * number of threads if that of `apply` has. */
gneiss_status gn_eigen_largest(const gn_eigen_system *system, double tolerance, double *vector,
                               gn_eigen_top *top, gneiss_error *error);

/* Returns x . y, with the same bits for any number of threads. */
double gn_eigen_dot(size_t n, const double *x, const double *y, int threads);
/* Returns x . y of vectors that are parts of a longer one, see GN_EIGEN_GROUP. */
double gn_eigen_dot_of(const gn_eigen_system *system, const double *x, const double *y);

#endif
