#include "limits.h"

#include <immintrin.h>
#include <stdlib.h>
#include <time.h>

enum { CHAINS = 12, REPEATS = 5 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Twelve independent chains, which hide the latency of one. Returns operations. */
#define CHAIN_LOOP(name, target_name, vector, lanes, set, fmadd)                                   \
    __attribute__((target(target_name))) static double name(long rounds) {                         \
        vector a[CHAINS];                                                                          \
        _Pragma("GCC unroll 12") for (int k = 0; k < CHAINS; k++) a[k] = set(1.0F + (float)k);     \
        const vector x = set(0.999F), y = set(1e-3F);                                              \
        for (long r = 0; r < rounds; r++)                                                          \
            _Pragma("GCC unroll 12") for (int k = 0; k < CHAINS; k++) {                            \
                a[k] = fmadd(a[k], x, y);                                                          \
                __asm__ volatile("" : "+v"(a[k]));                                                 \
            }                                                                                      \
        return 2.0 * (lanes)*CHAINS * (double)rounds;                                              \
    }

CHAIN_LOOP(double512, "avx512f", __m512d, 8, _mm512_set1_pd, _mm512_fmadd_pd)
CHAIN_LOOP(single512, "avx512f", __m512, 16, _mm512_set1_ps, _mm512_fmadd_ps)
CHAIN_LOOP(double256, "avx2,fma", __m256d, 4, _mm256_set1_pd, _mm256_fmadd_pd)
CHAIN_LOOP(single256, "avx2,fma", __m256, 8, _mm256_set1_ps, _mm256_fmadd_ps)

double bench_limit_flops(int single) {
    int wide = __builtin_cpu_supports("avx512f");
    double (*chains)(long) =
        wide ? (single ? single512 : double512) : (single ? single256 : double256);
    double best = 0.0;
    for (int k = 0; k < REPEATS; k++) {
        double start = now(), operations = chains(2000000), rate = operations / (now() - start);
        if (rate > best) best = rate;
    }
    return best;
}

__attribute__((target_clones("avx512f", "avx2", "default"))) static void
triad(double *restrict a, const double *restrict b, const double *restrict c, size_t count) {
    for (size_t k = 0; k < count; k++) a[k] = b[k] + 0.5 * c[k];
}

double bench_limit_triad(size_t bytes) {
    size_t count = bytes / (3 * sizeof(double));
    double *a = calloc(3 * count, sizeof *a), best = 0.0;
    if (!a) return 0.0;
    for (size_t k = 0; k < 3 * count; k++) a[k] = 1.0;
    size_t sweeps = ((size_t)200 << 20) / bytes + 1;
    for (int r = 0; r < REPEATS; r++) {
        double start = now();
        for (size_t s = 0; s < sweeps; s++) {
            triad(a, a + count, a + 2 * count, count);
            __asm__ volatile("" : : "r"(a) : "memory");
        }
        double rate = (double)(sweeps * 3 * count * sizeof *a) / (now() - start);
        if (rate > best) best = rate;
    }
    free(a);
    return best;
}
