/* Sizes of a distribution that is asked for, one after the other. */
#ifndef GN_PACK_SIZES_H
#define GN_PACK_SIZES_H

#include "scene/size_def.h"

#include <stddef.h>
#include <stdint.h>

typedef struct gn_sizes {
    gn_pack_sizes kind; /* not fitted */
    double ratio;       /* largest over smallest, of uniform and normal */
    double variation;   /* standard deviation over the mean, of normal; negative: automatic */
    size_t sieve_count;
    const double
        *sieve; /* [sieve_count][2]: size over the largest, share of the mass that passes */
    int dimension;
} gn_sizes;

/* Random numbers, and how many of them were used. */
typedef struct gn_drawn {
    uint64_t seed, count;
} gn_drawn;

/* In a unit of the distribution's own: uniform and normal from 1 to the ratio, of a sieve curve
 * over the largest. */
double gn_sizes_draw(const gn_sizes *sizes, gn_drawn *drawn);
/* In the same unit: the smallest and the largest that may come, and the mean by number. */
void gn_sizes_range(const gn_sizes *sizes, double *least, double *most);
double gn_sizes_mean(const gn_sizes *sizes);
/* The same unit: the share that is no larger than a size, by number, of a sieve curve by mass. */
double gn_sizes_below(const gn_sizes *sizes, double size);
/* By how much shares of `radius` [count], which it sorts, are off at most from what was asked for,
 * at the unit of size for which that is least; *at: the size there, over the largest asked for. */
double gn_sizes_off(const gn_sizes *sizes, double *radius, size_t count, double *at);
/* Of a sieve curve: the share of the mass that passes at a size over the largest. */
double gn_sizes_share(const gn_sizes *sizes, double size);

#endif
