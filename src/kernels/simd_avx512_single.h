/* AVX-512 backend in single precision: sixteen lanes. */
#ifndef GN_KERNELS_SIMD_AVX512_SINGLE_H
#define GN_KERNELS_SIMD_AVX512_SINGLE_H

#define GN_W 16
typedef __m512 gn_v;
typedef __mmask16 gn_m;
#include "kernels/simd_avx512_masks.h"

GN_INLINE gn_v gn_set(double a) {
    return _mm512_set1_ps((float)a);
}
GN_INLINE gn_v gn_load(const float *p) {
    return _mm512_loadu_ps(p);
}
GN_INLINE void gn_store(float *p, gn_v a) {
    _mm512_storeu_ps(p, a);
}
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return _mm512_fmadd_ps(a, b, c);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return _mm512_fnmadd_ps(a, b, c);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return _mm512_sqrt_ps(a);
}
GN_INLINE gn_v gn_max(gn_v a, gn_v b) {
    return _mm512_max_ps(a, b);
}
GN_INLINE gn_v gn_round(gn_v a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
GN_INLINE gn_m gn_less(gn_v a, gn_v b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
GN_INLINE gn_m gn_at_least(gn_v a, gn_v b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ);
}
GN_INLINE gn_v gn_where(gn_m m, gn_v a, gn_v b) {
    return _mm512_mask_blend_ps(m, b, a);
}
GN_INLINE gn_v gn_keep(gn_m m, gn_v a) {
    return _mm512_maskz_mov_ps(m, a);
}

/* Transposes four rows of four into columns in every 128-bit part; it is its own inverse. */
GN_INLINE void gn_transpose_parts(const gn_v in[4], gn_v out[4]) {
    __m512d t0 = _mm512_castps_pd(_mm512_unpacklo_ps(in[0], in[1]));
    __m512d t1 = _mm512_castps_pd(_mm512_unpackhi_ps(in[0], in[1]));
    __m512d t2 = _mm512_castps_pd(_mm512_unpacklo_ps(in[2], in[3]));
    __m512d t3 = _mm512_castps_pd(_mm512_unpackhi_ps(in[2], in[3]));
    out[0] = _mm512_castpd_ps(_mm512_unpacklo_pd(t0, t2));
    out[1] = _mm512_castpd_ps(_mm512_unpackhi_pd(t0, t2));
    out[2] = _mm512_castpd_ps(_mm512_unpacklo_pd(t1, t3));
    out[3] = _mm512_castpd_ps(_mm512_unpackhi_pd(t1, t3));
}

/* Returns rows index[0], index[4], index[8], index[12] in the four parts. */
GN_INLINE gn_v gn_quad(const float *rows, const int32_t *index) {
    gn_v r = _mm512_castps128_ps512(_mm_loadu_ps(rows + 4 * (int64_t)index[0]));
    r = _mm512_mask_broadcast_f32x4(r, 0x00F0, _mm_loadu_ps(rows + 4 * (int64_t)index[4]));
    r = _mm512_mask_broadcast_f32x4(r, 0x0F00, _mm_loadu_ps(rows + 4 * (int64_t)index[8]));
    return _mm512_mask_broadcast_f32x4(r, 0xF000, _mm_loadu_ps(rows + 4 * (int64_t)index[12]));
}

GN_INLINE void gn_gather4(const float *rows, const int32_t *index, gn_v out[4]) {
    for (int k = 0; k < 4; k++) out[k] = gn_quad(rows, index + k);
}

GN_INLINE void gn_columns4(const gn_v in[4], gn_v out[4]) {
    gn_transpose_parts(in, out);
}

GN_INLINE void gn_store_rows4(float *rows, const gn_v in[4]) {
    gn_v t[4];
    gn_transpose_parts(in, t);
    for (int k = 0; k < 4; k++) {
        float *row = rows + 4 * k;
        _mm_storeu_ps(row, _mm512_castps512_ps128(t[k]));
        _mm_storeu_ps(row + 16, _mm512_extractf32x4_ps(t[k], 1));
        _mm_storeu_ps(row + 32, _mm512_extractf32x4_ps(t[k], 2));
        _mm_storeu_ps(row + 48, _mm512_extractf32x4_ps(t[k], 3));
    }
}

GN_INLINE void gn_store_rows8(float *rows, const gn_v in[8]) {
    gn_v low[4], high[4];
    gn_transpose_parts(in, low);
    gn_transpose_parts(in + 4, high);
    const __m512i front = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
    const __m512i back = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    for (int k = 0; k < 4; k++) { /* rows k, k + 4, k + 8, k + 12 */
        __m512d l = _mm512_castps_pd(low[k]), h = _mm512_castps_pd(high[k]);
        __m512d a = _mm512_permutex2var_pd(l, front, h), b = _mm512_permutex2var_pd(l, back, h);
        double *row = (double *)(void *)(rows + 8 * k);
        _mm256_storeu_pd(row, _mm512_castpd512_pd256(a));
        _mm256_storeu_pd(row + 16, _mm512_extractf64x4_pd(a, 1));
        _mm256_storeu_pd(row + 32, _mm512_castpd512_pd256(b));
        _mm256_storeu_pd(row + 48, _mm512_extractf64x4_pd(b, 1));
    }
}

GN_INLINE void gn_store_wide(double *p, gn_v a) {
    _mm512_storeu_pd(p, _mm512_cvtps_pd(_mm512_castps512_ps256(a)));
    _mm512_storeu_pd(p + 8, _mm512_cvtps_pd(_mm512_extractf32x8_ps(a, 1)));
}

#endif
