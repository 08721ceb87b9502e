/* What this machine can do at most, on one core: the roofs that kernels are held against. */
#ifndef GN_BENCH_LIMITS_H
#define GN_BENCH_LIMITS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Fused multiply-adds in registers with the widest vectors, two operations each; flop/s. */
double bench_limit_flops(int single);

/* a = b + s c over three arrays of `bytes` in all, once in a cache of that size; B/s read and
 * written (a is not read). */
double bench_limit_triad(size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
