/* NEON backend in single precision: four lanes. A particle's row fills a register. */
#ifndef GN_KERNELS_SIMD_NEON_SINGLE_H
#define GN_KERNELS_SIMD_NEON_SINGLE_H

#define GN_W 4
typedef float32x4_t gn_v;
typedef uint32x4_t gn_m;

GN_INLINE gn_v gn_set(double a) {
    return vdupq_n_f32((float)a);
}
GN_INLINE gn_v gn_load(const float *p) {
    return vld1q_f32(p);
}
GN_INLINE void gn_store(float *p, gn_v a) {
    vst1q_f32(p, a);
}
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return vfmaq_f32(c, a, b);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return vfmsq_f32(c, a, b);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return vsqrtq_f32(a);
}
GN_INLINE gn_v gn_round(gn_v a) {
    return vrndnq_f32(a);
}
GN_INLINE gn_m gn_less(gn_v a, gn_v b) {
    return vcltq_f32(a, b);
}
GN_INLINE gn_m gn_at_least(gn_v a, gn_v b) {
    return vcgeq_f32(a, b);
}
GN_INLINE gn_m gn_m_none(void) {
    return vdupq_n_u32(0);
}
GN_INLINE gn_v gn_where(gn_m m, gn_v a, gn_v b) {
    return vbslq_f32(m, a, b);
}
GN_INLINE unsigned gn_bits(gn_m m) {
    const uint32x4_t bits = {1, 2, 4, 8};
    return vaddvq_u32(m & bits);
}

GN_INLINE void gn_gather4(const float *rows, const int32_t *index, gn_v out[4]) {
    for (int k = 0; k < 4; k++) out[k] = gn_load(rows + 4 * (int64_t)index[k]);
}

/* Transposes four rows of four into columns; it is its own inverse. */
GN_INLINE void gn_columns4(const gn_v in[4], gn_v out[4]) {
    float64x2_t t0 = vreinterpretq_f64_f32(vzip1q_f32(in[0], in[1]));
    float64x2_t t1 = vreinterpretq_f64_f32(vzip2q_f32(in[0], in[1]));
    float64x2_t t2 = vreinterpretq_f64_f32(vzip1q_f32(in[2], in[3]));
    float64x2_t t3 = vreinterpretq_f64_f32(vzip2q_f32(in[2], in[3]));
    out[0] = vreinterpretq_f32_f64(vzip1q_f64(t0, t2));
    out[1] = vreinterpretq_f32_f64(vzip2q_f64(t0, t2));
    out[2] = vreinterpretq_f32_f64(vzip1q_f64(t1, t3));
    out[3] = vreinterpretq_f32_f64(vzip2q_f64(t1, t3));
}

GN_INLINE void gn_store_columns(float *rows, int stride, const gn_v in[4]) {
    gn_v row[4];
    gn_columns4(in, row);
    for (int k = 0; k < 4; k++) gn_store(rows + stride * k, row[k]);
}

GN_INLINE void gn_store_rows4(float *rows, const gn_v in[4]) {
    gn_store_columns(rows, 4, in);
}

GN_INLINE void gn_store_rows8(float *rows, const gn_v in[8]) {
    gn_store_columns(rows, 8, in);
    gn_store_columns(rows + 4, 8, in + 4);
}

GN_INLINE void gn_store_wide(double *p, gn_v a) {
    vst1q_f64(p, vcvt_f64_f32(vget_low_f32(a)));
    vst1q_f64(p + 2, vcvt_high_f64_f32(a));
}

#endif
