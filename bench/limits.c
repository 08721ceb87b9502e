#include "limits.h"

#include <stdlib.h>
#include <time.h>

enum { CHAINS = 12, REPEATS = 5 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Twelve independent chains hide the latency of a single one. Returns the number of operations. */
#define CHAIN_LOOP(name, attribute, vector, lanes, set, fmadd, registers)                          \
    attribute static double name(long rounds) {                                                    \
        vector a[CHAINS];                                                                          \
        _Pragma("GCC unroll 12") for (int k = 0; k < CHAINS; k++) a[k] = set(1.0F + (float)k);     \
        const vector x = set(0.999F), y = set(1e-3F);                                              \
        for (long r = 0; r < rounds; r++)                                                          \
            _Pragma("GCC unroll 12") for (int k = 0; k < CHAINS; k++) {                            \
                a[k] = fmadd(a[k], x, y);                                                          \
                __asm__ volatile("" : registers(a[k]));                                            \
            }                                                                                      \
        return 2.0 * (lanes)*CHAINS * (double)rounds;                                              \
    }

typedef double chain_loop(long rounds);

#if defined(__x86_64__)

#include <immintrin.h>

#define WIDE   __attribute__((target("avx512f")))
#define NARROW __attribute__((target("avx2,fma")))
CHAIN_LOOP(double512, WIDE, __m512d, 8, _mm512_set1_pd, _mm512_fmadd_pd, "+v")
CHAIN_LOOP(single512, WIDE, __m512, 16, _mm512_set1_ps, _mm512_fmadd_ps, "+v")
CHAIN_LOOP(double256, NARROW, __m256d, 4, _mm256_set1_pd, _mm256_fmadd_pd, "+v")
CHAIN_LOOP(single256, NARROW, __m256, 8, _mm256_set1_ps, _mm256_fmadd_ps, "+v")

static chain_loop *widest(int single) {
    if (__builtin_cpu_supports("avx512f")) return single ? single512 : double512;
    return single ? single256 : double256;
}

#define CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

#elif defined(__aarch64__)

#include <arm_neon.h>

#define FMADD_F64(a, x, y) vfmaq_f64(y, a, x)
#define FMADD_F32(a, x, y) vfmaq_f32(y, a, x)
CHAIN_LOOP(double128, float64x2_t, 2, vdupq_n_f64, FMADD_F64, "+w")
CHAIN_LOOP(single128, float32x4_t, 4, vdupq_n_f32, FMADD_F32, "+w")

static chain_loop *widest(int single) {
    return single ? single128 : double128;
}

#define CLONES

#else
#error "which fused products does this processor have?"
#endif

double bench_limit_flops(int single) {
    chain_loop *chains = widest(single);
    double best = 0.0;
    for (int k = 0; k < REPEATS; k++) {
        double start = now(), operations = chains(2000000), rate = operations / (now() - start);
        if (rate > best) best = rate;
    }
    return best;
}

CLONES static void triad(double *restrict a, const double *restrict b, const double *restrict c,
                         size_t count) {
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
