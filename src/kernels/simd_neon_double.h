/* NEON backend in double precision: two lanes. A particle's row fills two registers. */
#ifndef GN_KERNELS_SIMD_NEON_DOUBLE_H
#define GN_KERNELS_SIMD_NEON_DOUBLE_H

#define GN_W 2
typedef float64x2_t gn_v;
typedef uint64x2_t gn_m;

GN_INLINE gn_v gn_set(double a) {
    return vdupq_n_f64(a);
}
GN_INLINE gn_v gn_load(const double *p) {
    return vld1q_f64(p);
}
GN_INLINE void gn_store(double *p, gn_v a) {
    vst1q_f64(p, a);
}
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return vfmaq_f64(c, a, b);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return vfmsq_f64(c, a, b);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return vsqrtq_f64(a);
}
GN_INLINE gn_v gn_round(gn_v a) {
    return vrndnq_f64(a);
}
GN_INLINE gn_m gn_less(gn_v a, gn_v b) {
    return vcltq_f64(a, b);
}
GN_INLINE gn_m gn_at_least(gn_v a, gn_v b) {
    return vcgeq_f64(a, b);
}
GN_INLINE gn_m gn_m_none(void) {
    return vdupq_n_u64(0);
}
GN_INLINE gn_v gn_where(gn_m m, gn_v a, gn_v b) {
    return vbslq_f64(m, a, b);
}
GN_INLINE unsigned gn_bits(gn_m m) {
    return (unsigned)((vgetq_lane_u64(m, 0) & 1) | (vgetq_lane_u64(m, 1) & 2));
}

/* Gathers first halves of rows index[0] and index[1] in registers 0 and 1, second halves in 2 and
 * 3. */
GN_INLINE void gn_gather4(const double *rows, const int32_t *index, gn_v out[4]) {
    for (int k = 0; k < 4; k++) out[k] = gn_load(rows + 4 * (int64_t)index[k % 2] + k / 2 * 2);
}

/* Transposes pairs of registers: halves of rows to columns, and back. */
GN_INLINE void gn_columns4(const gn_v in[4], gn_v out[4]) {
    for (int k = 0; k < 4; k += 2) {
        out[k] = vzip1q_f64(in[k], in[k + 1]);
        out[k + 1] = vzip2q_f64(in[k], in[k + 1]);
    }
}

GN_INLINE void gn_store_halves(double *rows, int stride, const gn_v in[4]) {
    gn_v half[4];
    gn_columns4(in, half);
    for (int k = 0; k < 4; k++) gn_store(rows + stride * (k % 2) + k / 2 * 2, half[k]);
}

GN_INLINE void gn_store_rows4(double *rows, const gn_v in[4]) {
    gn_store_halves(rows, 4, in);
}

GN_INLINE void gn_store_rows8(double *rows, const gn_v in[8]) {
    gn_store_halves(rows, 8, in);
    gn_store_halves(rows + 4, 8, in + 4);
}

GN_INLINE void gn_store_wide(double *p, gn_v a) {
    gn_store(p, a);
}

GN_INLINE void gn_store_rows4_single(float *rows, const gn_v in[4]) {
    gn_v half[4];
    gn_columns4(in, half);
    for (int k = 0; k < 2; k++)
        vst1q_f32(rows + 4 * k, vcvt_high_f32_f64(vcvt_f32_f64(half[k]), half[k + 2]));
}

#endif
