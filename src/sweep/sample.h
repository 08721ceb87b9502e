/* Points that are evenly distributed in a cube, and quantiles that convert their coordinates to
 * values. */
#ifndef GN_SWEEP_SAMPLE_H
#define GN_SWEEP_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

enum { GN_SOBOL_DIMENSIONS = 21 };

/* Computes coordinate `dimension` of the points of a Latin hypercube, each in (0, 1): each of the
 * `count` strata of equal width contains one point, in random order and at a random place (McKay,
 * Beckman & Conover 1979, Technometrics 21, 239). */
void gn_sample_latin(uint64_t seed, size_t dimension, size_t count, double *points);

/* Returns coordinate `dimension` (below GN_SOBOL_DIMENSIONS) of point `index` of Sobol's sequence,
 * as a fraction of 2^32; point 0 is 0. */
uint32_t gn_sobol_bits(size_t dimension, uint32_t index);

/* Computes coordinate `dimension` of the first `count` points of Sobol's sequence, each in (0, 1),
 * with a digital shift drawn from the seed, which preserves the evenness of the sequence and moves
 * its first point out of the corner. */
void gn_sample_sobol(uint64_t seed, size_t dimension, size_t count, double *points);

/* Returns x with probability p below it in the standard normal distribution; p in (0, 1). */
double gn_normal_quantile(double p);

#endif
