/* AVX2 backend in double precision: four lanes. Particle rows are loaded whole and transposed: a
 * hardware gather of the same numbers was measured 35-40 % slower. */
#ifndef GN_KERNELS_SIMD_AVX2_DOUBLE_H
#define GN_KERNELS_SIMD_AVX2_DOUBLE_H

#define GN_W 4
typedef __m256d gn_v;
typedef __m256d gn_m;

GN_INLINE gn_v gn_set(double a) {
    return _mm256_set1_pd(a);
}
GN_INLINE gn_v gn_load(const double *p) {
    return _mm256_loadu_pd(p);
}
GN_INLINE void gn_store(double *p, gn_v a) {
    _mm256_storeu_pd(p, a);
}
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return _mm256_fmadd_pd(a, b, c);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return _mm256_fnmadd_pd(a, b, c);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return _mm256_sqrt_pd(a);
}
GN_INLINE gn_v gn_max(gn_v a, gn_v b) {
    return _mm256_max_pd(a, b);
}
GN_INLINE gn_v gn_round(gn_v a) {
    return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
GN_INLINE gn_m gn_less(gn_v a, gn_v b) {
    return _mm256_cmp_pd(a, b, _CMP_LT_OQ);
}
GN_INLINE gn_m gn_at_least(gn_v a, gn_v b) {
    return _mm256_cmp_pd(a, b, _CMP_GE_OQ);
}
GN_INLINE gn_m gn_m_none(void) {
    return _mm256_setzero_pd();
}
GN_INLINE gn_m gn_and(gn_m a, gn_m b) {
    return _mm256_and_pd(a, b);
}
GN_INLINE gn_m gn_or(gn_m a, gn_m b) {
    return _mm256_or_pd(a, b);
}
GN_INLINE gn_m gn_not(gn_m a) {
    return _mm256_xor_pd(a, _mm256_castsi256_pd(_mm256_set1_epi64x(-1)));
}
GN_INLINE gn_v gn_where(gn_m m, gn_v a, gn_v b) {
    return _mm256_blendv_pd(b, a, m);
}
GN_INLINE gn_v gn_keep(gn_m m, gn_v a) {
    return _mm256_and_pd(m, a);
}
GN_INLINE unsigned gn_bits(gn_m m) {
    return (unsigned)_mm256_movemask_pd(m);
}

GN_INLINE void gn_transpose4(gn_v r0, gn_v r1, gn_v r2, gn_v r3, gn_v out[4]) {
    gn_v t0 = _mm256_unpacklo_pd(r0, r1), t1 = _mm256_unpackhi_pd(r0, r1);
    gn_v t2 = _mm256_unpacklo_pd(r2, r3), t3 = _mm256_unpackhi_pd(r2, r3);
    out[0] = _mm256_permute2f128_pd(t0, t2, 0x20);
    out[1] = _mm256_permute2f128_pd(t1, t3, 0x20);
    out[2] = _mm256_permute2f128_pd(t0, t2, 0x31);
    out[3] = _mm256_permute2f128_pd(t1, t3, 0x31);
}

GN_INLINE void gn_gather4(const double *rows, const int32_t *index, gn_v out[4]) {
    for (int k = 0; k < 4; k++) out[k] = gn_load(rows + 4 * (int64_t)index[k]);
}

GN_INLINE void gn_columns4(const gn_v in[4], gn_v out[4]) {
    gn_transpose4(in[0], in[1], in[2], in[3], out);
}

GN_INLINE void gn_store_rows4(double *rows, const gn_v in[4]) {
    gn_v t[4];
    gn_transpose4(in[0], in[1], in[2], in[3], t);
    for (int k = 0; k < 4; k++) gn_store(rows + 4 * k, t[k]);
}

GN_INLINE void gn_store_rows8(double *rows, const gn_v in[8]) {
    gn_v low[4], high[4];
    gn_transpose4(in[0], in[1], in[2], in[3], low);
    gn_transpose4(in[4], in[5], in[6], in[7], high);
    for (int k = 0; k < 4; k++) {
        gn_store(rows + 8 * k, low[k]);
        gn_store(rows + 8 * k + 4, high[k]);
    }
}

GN_INLINE void gn_store_wide(double *p, gn_v a) {
    gn_store(p, a);
}

GN_INLINE void gn_store_rows4_single(float *rows, const gn_v in[4]) {
    gn_v t[4];
    gn_transpose4(in[0], in[1], in[2], in[3], t);
    for (int k = 0; k < 4; k++) _mm_storeu_ps(rows + 4 * k, _mm256_cvtpd_ps(t[k]));
}

#endif
