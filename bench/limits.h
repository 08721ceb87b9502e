/* Limits of this machine on one core, the roofs of the roofline model to which kernels are
 * compared. */
#ifndef GN_BENCH_LIMITS_H
#define GN_BENCH_LIMITS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Measures fused multiply-adds in registers with the widest vectors, two operations each;
 * flop/s. */
double bench_limit_flops(int single);

/* Measures a = b + s c in repeated passes over three arrays of `bytes` in total, which stay in a
 * cache of that size; B/s read and written (a is not read). */
double bench_limit_triad(size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
