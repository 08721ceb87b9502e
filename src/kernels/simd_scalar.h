/* Scalar backend: one lane, plain C. Every other backend must agree with it bit for bit. */
#ifndef GN_KERNELS_SIMD_SCALAR_H
#define GN_KERNELS_SIMD_SCALAR_H

#include <stdbool.h>

#define GN_W 1
typedef double gn_v;
typedef bool gn_m;

GN_INLINE gn_v gn_set(double a) {
    return a;
}
GN_INLINE gn_v gn_load(const double *p) {
    return *p;
}
GN_INLINE void gn_store(double *p, gn_v a) {
    *p = a;
}
/* a b + c and c - a b, rounded once. */
GN_INLINE gn_v gn_fma(gn_v a, gn_v b, gn_v c) {
    return fma(a, b, c);
}
GN_INLINE gn_v gn_fnma(gn_v a, gn_v b, gn_v c) {
    return fma(-a, b, c);
}
GN_INLINE gn_v gn_sqrt(gn_v a) {
    return sqrt(a);
}
GN_INLINE gn_v gn_max(gn_v a, gn_v b) {
    return a > b ? a : b;
}
GN_INLINE gn_v gn_round(gn_v a) {
    return nearbyint(a);
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
    return m ? a : 0.0;
}
GN_INLINE unsigned gn_bits(gn_m m) {
    return m ? 1u : 0u;
}

/* Lane k gets the four numbers of row index[k]. */
GN_INLINE void gn_rows4(const double *rows, const int32_t *index, gn_v out[4]) {
    const double *row = rows + 4 * (int64_t)index[0];
    for (int k = 0; k < 4; k++) out[k] = row[k];
}

/* Row k gets lane k of the four (eight) vectors. */
GN_INLINE void gn_store_rows4(double *rows, const gn_v in[4]) {
    for (int k = 0; k < 4; k++) rows[k] = in[k];
}
GN_INLINE void gn_store_rows8(double *rows, const gn_v in[8]) {
    for (int k = 0; k < 8; k++) rows[k] = in[k];
}

/* Adds a contact's row to those of its two particles: force with opposite signs; moment times the
 * arms, when there are any. Width 8: force xyz, 0, moment xyz, 0. */
GN_INLINE void gn_add_row8(double *i, double *j, const double *row, const double *arm_i,
                           const double *arm_j, int arms) {
    for (int k = 0; k < 3; k++) i[k] += row[k];
    for (int k = 0; k < 3; k++) j[k] -= row[k];
    for (int k = 4; arms && k < 7; k++) i[k] = fma(row[k], *arm_i, i[k]);
    for (int k = 4; arms && k < 7; k++) j[k] = fma(row[k], *arm_j, j[k]);
}

/* Width 4: force xyz, 0; with arms (2D) force xy, moment z, 0. */
GN_INLINE void gn_add_row4(double *i, double *j, const double *row, const double *arm_i,
                           const double *arm_j, int arms) {
    for (int k = 0; k < 2 + !arms; k++) i[k] += row[k];
    for (int k = 0; k < 2 + !arms; k++) j[k] -= row[k];
    if (arms) i[2] = fma(row[2], *arm_i, i[2]);
    if (arms) j[2] = fma(row[2], *arm_j, j[2]);
}

#endif
