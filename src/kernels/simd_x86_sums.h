/* The functions of kernels/simd_sums.h in registers of AVX2 and AVX-512. */
#ifndef GN_KERNELS_SIMD_X86_SUMS_H
#define GN_KERNELS_SIMD_X86_SUMS_H

#define GN_OWN_SUMS

GN_INLINE void gn_add_plain4(double *to, const gn_real *row) {
#if GN_MIXED
    __m256d r = _mm256_cvtps_pd(_mm_loadu_ps(row));
#else
    __m256d r = _mm256_loadu_pd(row);
#endif
    _mm256_storeu_pd(to, _mm256_add_pd(_mm256_loadu_pd(to), r));
}

GN_INLINE void gn_add_two(double *to, const double *row) {
    _mm_storeu_pd(to, _mm_add_pd(_mm_loadu_pd(to), _mm_loadu_pd(row)));
}

#if GN_MIXED

GN_INLINE void gn_add_scaled4(float *to, __m128 row, __m128 factor) {
    _mm_storeu_ps(to, _mm_fmadd_ps(row, factor, _mm_loadu_ps(to)));
}

GN_INLINE void gn_add_row4(float *i, float *j, const float *row, const float *arm_i,
                           const float *arm_j, int arms) {
    __m128 r = _mm_loadu_ps(row), plus = _mm_set1_ps(1.0f), minus = _mm_set1_ps(-1.0f);
    if (arms) plus = _mm_blend_ps(plus, _mm_broadcast_ss(arm_i), 0x4);
    if (arms) minus = _mm_blend_ps(minus, _mm_broadcast_ss(arm_j), 0x4);
    gn_add_scaled4(i, r, plus);
    gn_add_scaled4(j, r, minus);
}

GN_INLINE void gn_add_scaled8(float *to, __m256 row, __m256 factor) {
    _mm256_storeu_ps(to, _mm256_fmadd_ps(row, factor, _mm256_loadu_ps(to)));
}

GN_INLINE void gn_add_row8(float *i, float *j, const float *row, const float *arm_i,
                           const float *arm_j, int arms) {
    if (!arms) {
        gn_add_row4(i, j, row, arm_i, arm_j, 0);
        return;
    }
    __m256 r = _mm256_loadu_ps(row), plus = _mm256_set1_ps(1.0f), minus = _mm256_set1_ps(-1.0f);
    gn_add_scaled8(i, r, _mm256_blend_ps(plus, _mm256_broadcast_ss(arm_i), 0xF0));
    gn_add_scaled8(j, r, _mm256_blend_ps(minus, _mm256_broadcast_ss(arm_j), 0xF0));
}

#else

GN_INLINE __m256d gn_factor4(double sign, const double *arm, int arms) {
    __m256d factor = _mm256_set1_pd(sign);
    if (arms) factor = _mm256_blend_pd(factor, _mm256_broadcast_sd(arm), 0x4);
    return factor;
}

GN_INLINE void gn_add_row4(double *i, double *j, const double *row, const double *arm_i,
                           const double *arm_j, int arms) {
    __m256d r = _mm256_loadu_pd(row);
    _mm256_storeu_pd(i, _mm256_fmadd_pd(r, gn_factor4(1.0, arm_i, arms), _mm256_loadu_pd(i)));
    _mm256_storeu_pd(j, _mm256_fmadd_pd(r, gn_factor4(-1.0, arm_j, arms), _mm256_loadu_pd(j)));
}

#if GN_W == 4

GN_INLINE void gn_add_row8(double *i, double *j, const double *row, const double *arm_i,
                           const double *arm_j, int arms) {
    gn_add_row4(i, j, row, arm_i, arm_j, 0);
    if (!arms) return;
    __m256d m = _mm256_loadu_pd(row + 4), ai = _mm256_broadcast_sd(arm_i),
            aj = _mm256_broadcast_sd(arm_j);
    _mm256_storeu_pd(i + 4, _mm256_fmadd_pd(m, ai, _mm256_loadu_pd(i + 4)));
    _mm256_storeu_pd(j + 4, _mm256_fmadd_pd(m, aj, _mm256_loadu_pd(j + 4)));
}

#else

GN_INLINE void gn_add_row8(double *i, double *j, const double *row, const double *arm_i,
                           const double *arm_j, int arms) {
    if (!arms) {
        gn_add_row4(i, j, row, arm_i, arm_j, 0);
        return;
    }
    __m512d r = _mm512_loadu_pd(row), plus = _mm512_set1_pd(1.0), minus = _mm512_set1_pd(-1.0);
    plus = _mm512_mask_broadcastsd_pd(plus, 0xF0, _mm_load_sd(arm_i));
    minus = _mm512_mask_broadcastsd_pd(minus, 0xF0, _mm_load_sd(arm_j));
    _mm512_storeu_pd(i, _mm512_fmadd_pd(r, plus, _mm512_loadu_pd(i)));
    _mm512_storeu_pd(j, _mm512_fmadd_pd(r, minus, _mm512_loadu_pd(j)));
}

#endif
#endif

#endif
