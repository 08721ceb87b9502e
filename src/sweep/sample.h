/* Points that fill a cube evenly, and quantiles that turn their coordinates into values. */
#ifndef GN_SWEEP_SAMPLE_H
#define GN_SWEEP_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

enum { GN_SOBOL_DIMENSIONS = 21 };

/* Coordinate `dimension` of the points of a Latin hypercube, each in (0, 1): every one of the
 * `count` strata of equal width holds one point, in random order and at a random place in it
 * (McKay, Beckman & Conover 1979, Technometrics 21, 239). */
void gn_sample_latin(uint64_t seed, size_t dimension, size_t count, double *points);

/* Coordinate `dimension` (below GN_SOBOL_DIMENSIONS) of point `index` of Sobol's sequence, as a
 * fraction of 2^32: index 0 is 0. */
uint32_t gn_sobol_bits(size_t dimension, uint32_t index);

/* The same of `count` points, each in (0, 1): with a digital shift drawn from the seed, which keeps
 * the evenness of the sequence and takes its first point out of the corner. */
void gn_sample_sobol(uint64_t seed, size_t dimension, size_t count, double *points);

/* x with probability p below it in the normal distribution of mean 0 and deviation 1; p in (0, 1).
 */
double gn_normal_quantile(double p);

#endif
