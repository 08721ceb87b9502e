/* AVX2 backend in single precision: eight lanes. */
#ifndef GN_KERNELS_SIMD_AVX2_SINGLE_H
#define GN_KERNELS_SIMD_AVX2_SINGLE_H

#define GN_W 8
typedef __m256 gn_v;
typedef __m256 gn_m;

GN_INLINE gn_v gn_set(double a) {
    return _mm256_set1_ps((float)a);
}
GN_INLINE gn_v gn_load(const float *p) {
    return _mm256_loadu_ps(p);
}
GN_INLINE void gn_store(float *p, gn_v a) {
    _mm256_storeu_ps(p, a);
}
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return _mm256_fmadd_ps(a, b, c);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return _mm256_fnmadd_ps(a, b, c);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return _mm256_sqrt_ps(a);
}
GN_INLINE gn_v gn_max(gn_v a, gn_v b) {
    return _mm256_max_ps(a, b);
}
GN_INLINE gn_v gn_round(gn_v a) {
    return _mm256_round_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
GN_INLINE gn_m gn_less(gn_v a, gn_v b) {
    return _mm256_cmp_ps(a, b, _CMP_LT_OQ);
}
GN_INLINE gn_m gn_at_least(gn_v a, gn_v b) {
    return _mm256_cmp_ps(a, b, _CMP_GE_OQ);
}
GN_INLINE gn_m gn_m_none(void) {
    return _mm256_setzero_ps();
}
GN_INLINE gn_m gn_and(gn_m a, gn_m b) {
    return _mm256_and_ps(a, b);
}
GN_INLINE gn_m gn_or(gn_m a, gn_m b) {
    return _mm256_or_ps(a, b);
}
GN_INLINE gn_m gn_not(gn_m a) {
    return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
}
GN_INLINE gn_v gn_where(gn_m m, gn_v a, gn_v b) {
    return _mm256_blendv_ps(b, a, m);
}
GN_INLINE gn_v gn_keep(gn_m m, gn_v a) {
    return _mm256_and_ps(m, a);
}
GN_INLINE unsigned gn_bits(gn_m m) {
    return (unsigned)_mm256_movemask_ps(m);
}

/* Transposes four rows of four into columns in both 128-bit parts; it is its own inverse. */
GN_INLINE void gn_transpose_parts(const gn_v in[4], gn_v out[4]) {
    __m256d t0 = _mm256_castps_pd(_mm256_unpacklo_ps(in[0], in[1]));
    __m256d t1 = _mm256_castps_pd(_mm256_unpackhi_ps(in[0], in[1]));
    __m256d t2 = _mm256_castps_pd(_mm256_unpacklo_ps(in[2], in[3]));
    __m256d t3 = _mm256_castps_pd(_mm256_unpackhi_ps(in[2], in[3]));
    out[0] = _mm256_castpd_ps(_mm256_unpacklo_pd(t0, t2));
    out[1] = _mm256_castpd_ps(_mm256_unpackhi_pd(t0, t2));
    out[2] = _mm256_castpd_ps(_mm256_unpacklo_pd(t1, t3));
    out[3] = _mm256_castpd_ps(_mm256_unpackhi_pd(t1, t3));
}

GN_INLINE void gn_gather4(const float *rows, const int32_t *index, gn_v out[4]) {
    for (int k = 0; k < 4; k++)
        out[k] =
            _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(rows + 4 * (int64_t)index[k])),
                                 _mm_loadu_ps(rows + 4 * (int64_t)index[k + 4]), 1);
}

GN_INLINE void gn_columns4(const gn_v in[4], gn_v out[4]) {
    gn_transpose_parts(in, out);
}

GN_INLINE void gn_store_rows4(float *rows, const gn_v in[4]) {
    gn_v t[4];
    gn_transpose_parts(in, t);
    for (int k = 0; k < 4; k++) {
        _mm_storeu_ps(rows + 4 * k, _mm256_castps256_ps128(t[k]));
        _mm_storeu_ps(rows + 4 * k + 16, _mm256_extractf128_ps(t[k], 1));
    }
}

GN_INLINE void gn_store_rows8(float *rows, const gn_v in[8]) {
    gn_v low[4], high[4];
    gn_transpose_parts(in, low);
    gn_transpose_parts(in + 4, high);
    for (int k = 0; k < 4; k++) {
        _mm256_storeu_ps(rows + 8 * k, _mm256_permute2f128_ps(low[k], high[k], 0x20));
        _mm256_storeu_ps(rows + 8 * k + 32, _mm256_permute2f128_ps(low[k], high[k], 0x31));
    }
}

GN_INLINE void gn_store_wide(double *p, gn_v a) {
    _mm256_storeu_pd(p, _mm256_cvtps_pd(_mm256_castps256_ps128(a)));
    _mm256_storeu_pd(p + 4, _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1)));
}

#endif
