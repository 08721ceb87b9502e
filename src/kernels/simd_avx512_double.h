/* AVX-512 backend in double: eight lanes, masks in mask registers. */
#ifndef GN_KERNELS_SIMD_AVX512_DOUBLE_H
#define GN_KERNELS_SIMD_AVX512_DOUBLE_H

#define GN_W 8
typedef __m512d gn_v;
typedef __mmask8 gn_m;
#include "kernels/simd_avx512_masks.h"

GN_INLINE gn_v gn_set(double a) {
    return _mm512_set1_pd(a);
}
GN_INLINE gn_v gn_load(const double *p) {
    return _mm512_loadu_pd(p);
}
GN_INLINE void gn_store(double *p, gn_v a) {
    _mm512_storeu_pd(p, a);
}
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return _mm512_fmadd_pd(a, b, c);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return _mm512_fnmadd_pd(a, b, c);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return _mm512_sqrt_pd(a);
}
GN_INLINE gn_v gn_max(gn_v a, gn_v b) {
    return _mm512_max_pd(a, b);
}
GN_INLINE gn_v gn_round(gn_v a) {
    return _mm512_roundscale_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
GN_INLINE gn_m gn_less(gn_v a, gn_v b) {
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
GN_INLINE gn_m gn_at_least(gn_v a, gn_v b) {
    return _mm512_cmp_pd_mask(a, b, _CMP_GE_OQ);
}
GN_INLINE gn_v gn_where(gn_m m, gn_v a, gn_v b) {
    return _mm512_mask_blend_pd(m, b, a);
}
GN_INLINE gn_v gn_keep(gn_m m, gn_v a) {
    return _mm512_maskz_mov_pd(m, a);
}

/* Returns two 32-byte rows in one register. */
GN_INLINE gn_v gn_pair(const double *low, const double *high) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(low)), _mm256_loadu_pd(high),
                              1);
}

/* Gathers registers with rows (0,2), (1,3), (4,6), (5,7). */
GN_INLINE void gn_gather4(const double *rows, const int32_t *index, gn_v out[4]) {
    static const int first[4] = {0, 1, 4, 5};
    for (int k = 0; k < 4; k++)
        out[k] =
            gn_pair(rows + 4 * (int64_t)index[first[k]], rows + 4 * (int64_t)index[first[k] + 2]);
}

#define GN_OWN_EVERY
GN_INLINE void gn_gather4_every(const double *rows, int step, gn_v out[4]) {
    static const int first[4] = {0, 1, 4, 5};
    for (int k = 0; k < 4; k++) {
        const double *row = rows + 4 * step * first[k];
        out[k] = gn_pair(row, row + 8 * step);
    }
}

GN_INLINE void gn_columns4(const gn_v in[4], gn_v out[4]) {
    gn_v t0 = _mm512_unpacklo_pd(in[0], in[1]), t1 = _mm512_unpackhi_pd(in[0], in[1]);
    gn_v t2 = _mm512_unpacklo_pd(in[2], in[3]), t3 = _mm512_unpackhi_pd(in[2], in[3]);
    out[0] = _mm512_shuffle_f64x2(t0, t2, 0x88);
    out[1] = _mm512_shuffle_f64x2(t1, t3, 0x88);
    out[2] = _mm512_shuffle_f64x2(t0, t2, 0xDD);
    out[3] = _mm512_shuffle_f64x2(t1, t3, 0xDD);
}

/* Converts columns to registers with rows (0,2), (1,3), (4,6), (5,7) of the eight lanes. */
GN_INLINE void gn_columns_to_pairs(const gn_v in[4], gn_v out[4]) {
    gn_v u0 = _mm512_unpacklo_pd(in[0], in[1]), u1 = _mm512_unpackhi_pd(in[0], in[1]);
    gn_v u2 = _mm512_unpacklo_pd(in[2], in[3]), u3 = _mm512_unpackhi_pd(in[2], in[3]);
    /* 128-bit parts: u0 has rows 0 2 4 6, columns 0 1; u2 the same rows, columns 2 3 */
    __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
    __m512i high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
    out[0] = _mm512_permutex2var_pd(u0, low, u2);
    out[1] = _mm512_permutex2var_pd(u1, low, u3);
    out[2] = _mm512_permutex2var_pd(u0, high, u2);
    out[3] = _mm512_permutex2var_pd(u1, high, u3);
}

GN_INLINE void gn_store_pairs(double *rows, int stride, const gn_v pairs[4]) {
    static const int first[4] = {0, 1, 4, 5};
    for (int k = 0; k < 4; k++) {
        double *row = rows + stride * first[k];
        _mm256_storeu_pd(row, _mm512_castpd512_pd256(pairs[k]));
        _mm256_storeu_pd(row + 2 * stride, _mm512_extractf64x4_pd(pairs[k], 1));
    }
}

GN_INLINE void gn_store_rows4(double *rows, const gn_v in[4]) {
    gn_v pairs[4];
    gn_columns_to_pairs(in, pairs);
    gn_store_pairs(rows, 4, pairs);
}

/* Stores both halves of registers with rows (0,2), (1,3), (4,6), (5,7) separately, which saves
 * shuffles. */
GN_INLINE void gn_store_rows8(double *rows, const gn_v in[8]) {
    gn_v low[4], high[4];
    gn_columns_to_pairs(in, low);
    gn_columns_to_pairs(in + 4, high);
    gn_store_pairs(rows, 8, low);
    gn_store_pairs(rows + 4, 8, high);
}

GN_INLINE void gn_store_wide(double *p, gn_v a) {
    gn_store(p, a);
}

GN_INLINE void gn_store_rows4_single(float *rows, const gn_v in[4]) {
    static const int first[4] = {0, 1, 4, 5};
    gn_v pairs[4];
    gn_columns_to_pairs(in, pairs);
    for (int k = 0; k < 4; k++) {
        __m256 two = _mm512_cvtpd_ps(pairs[k]);
        _mm_storeu_ps(rows + 4 * first[k], _mm256_castps256_ps128(two));
        _mm_storeu_ps(rows + 4 * (first[k] + 2), _mm256_extractf128_ps(two, 1));
    }
}

#endif
