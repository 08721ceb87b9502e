/* Random sizes of a requested distribution. */
#ifndef GN_PACK_SIZES_H
#define GN_PACK_SIZES_H

#include "scene/size_def.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gn_sizes {
    gn_pack_sizes kind; /* any kind but `fitted` */
    double ratio;       /* largest over smallest size; uniform and normal */
    double variation;   /* standard deviation over the mean; normal; negative: automatic */
    size_t sieve_count;
    const double
        *sieve; /* [sieve_count][2]: size over the largest, fraction of the mass that passes */
    int dimension;
} gn_sizes;

/* A random seed, and the count of random numbers used. */
typedef struct gn_drawn {
    uint64_t seed, count;
} gn_drawn;

/* Draws a size in the unit of the distribution: from 1 to the ratio for uniform and normal,
 * relative to the largest size for a sieve curve. */
double gn_sizes_draw(const gn_sizes *sizes, gn_drawn *drawn);
/* Computes the smallest and the largest possible size, and the mean by number, in the unit of
 * gn_sizes_draw. */
void gn_sizes_range(const gn_sizes *sizes, double *least, double *most);
double gn_sizes_mean(const gn_sizes *sizes);
/* Returns the largest deviation of the cumulative fractions of `radius` [count], which is sorted by
 * this, from the requested ones, for the unit of size that fits best; *at: the size at which it
 * occurs, over the largest requested one. */
double gn_sizes_off(const gn_sizes *sizes, double *radius, size_t count, double *at);
/* Returns the mass fraction that passes a sieve of this size by the sieve curve; sizes are divided
 * by the largest one. */
double gn_sizes_share(const gn_sizes *sizes, double size);

#endif
