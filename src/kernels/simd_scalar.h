/* Scalar backend: one lane, plain C. Every other backend must agree with it bit for bit in the same
 * precision; in double it is the reference for all results. */
#ifndef GN_KERNELS_SIMD_SCALAR_H
#define GN_KERNELS_SIMD_SCALAR_H

#include <stdbool.h>

#define GN_W 1
typedef gn_real gn_v;
typedef bool gn_m;

GN_INLINE gn_v gn_set(double a) {
    return (gn_v)a;
}
GN_INLINE gn_v gn_load(const gn_real *p) {
    return *p;
}
GN_INLINE void gn_store(gn_real *p, gn_v a) {
    *p = a;
}
/* a b + c and c - a b, rounded once. */
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return GN_MATH(fma)(a, b, c);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return GN_MATH(fma)(-a, b, c);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return GN_MATH(sqrt)(a);
}
GN_INLINE gn_v gn_max(gn_v a, gn_v b) {
    return a > b ? a : b;
}
GN_INLINE gn_v gn_round(gn_v a) {
    return GN_MATH(nearbyint)(a);
}
GN_INLINE gn_m gn_less(gn_v a, gn_v b) {
    return a < b;
}
GN_INLINE gn_m gn_at_least(gn_v a, gn_v b) {
    return a >= b;
}
GN_INLINE gn_m gn_m_none(void) {
    return false;
}
GN_INLINE gn_m gn_and(gn_m a, gn_m b) {
    return a && b;
}
GN_INLINE gn_m gn_or(gn_m a, gn_m b) {
    return a || b;
}
GN_INLINE gn_m gn_not(gn_m a) {
    return !a;
}
GN_INLINE gn_v gn_where(gn_m m, gn_v a, gn_v b) {
    return m ? a : b;
}
/* a where the mask holds, else zero */
GN_INLINE gn_v gn_keep(gn_m m, gn_v a) {
    return m ? a : 0;
}
GN_INLINE unsigned gn_bits(gn_m m) {
    return m ? 1u : 0u;
}

/* Gathers rows index[0], index[1], ... in an order that suits the backend; gn_columns4 makes
 * columns of them, so that lane k has the numbers of row index[k]. */
GN_INLINE void gn_gather4(const gn_real *rows, const int32_t *index, gn_v out[4]) {
    const gn_real *row = rows + 4 * (int64_t)index[0];
    for (int k = 0; k < 4; k++) out[k] = row[k];
}
GN_INLINE void gn_columns4(const gn_v in[4], gn_v out[4]) {
    for (int k = 0; k < 4; k++) out[k] = in[k];
}

/* Stores lane k of the four (eight) vectors in row k. */
GN_INLINE void gn_store_rows4(gn_real *rows, const gn_v in[4]) {
    for (int k = 0; k < 4; k++) rows[k] = in[k];
}
GN_INLINE void gn_store_rows8(gn_real *rows, const gn_v in[8]) {
    for (int k = 0; k < 8; k++) rows[k] = in[k];
}

/* Stores the lanes as doubles. */
GN_INLINE void gn_store_wide(double *p, gn_v a) {
    *p = a;
}

/* Stores rows in single precision. */
GN_INLINE void gn_store_rows4_single(float *rows, const gn_v in[4]) {
    for (int k = 0; k < 4; k++) rows[k] = (float)in[k];
}

#endif
