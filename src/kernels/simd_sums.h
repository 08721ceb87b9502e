/* Adds a contact's row to those of its two particles (an element's rows to those of its nodes):
 * force with opposite signs; moment times the arms, if there are any. Rows have the kernel's
 * precision; sums of contacts too, those of elements are double. Every product is fused with its
 * sum, in every backend. This is for backends without their own version (GN_OWN_SUMS).
 *
 * Width 8: force xyz, 0, moment xyz, 0. Width 4: force xyz, 0; with arms (2D) force xy, moment z,
 * 0. */
#ifndef GN_KERNELS_SIMD_SUMS_H
#define GN_KERNELS_SIMD_SUMS_H

GN_INLINE void gn_add_row8(gn_real *i, gn_real *j, const gn_real *row, const gn_real *arm_i,
                           const gn_real *arm_j, int arms) {
    for (int k = 0; k < 3; k++) i[k] += row[k];
    for (int k = 0; k < 3; k++) j[k] -= row[k];
    for (int k = 4; arms && k < 7; k++) i[k] = GN_MATH(fma)(row[k], *arm_i, i[k]);
    for (int k = 4; arms && k < 7; k++) j[k] = GN_MATH(fma)(row[k], *arm_j, j[k]);
}

GN_INLINE void gn_add_row4(gn_real *i, gn_real *j, const gn_real *row, const gn_real *arm_i,
                           const gn_real *arm_j, int arms) {
    for (int k = 0; k < 2 + !arms; k++) i[k] += row[k];
    for (int k = 0; k < 2 + !arms; k++) j[k] -= row[k];
    if (arms) i[2] = GN_MATH(fma)(row[2], *arm_i, i[2]);
    if (arms) j[2] = GN_MATH(fma)(row[2], *arm_j, j[2]);
}

/* Adds two numbers. */
GN_INLINE void gn_add_two(double *to, const double *row) {
    for (int k = 0; k < 2; k++) to[k] += row[k];
}

/* Adds a row of four. */
GN_INLINE void gn_add_plain4(double *to, const gn_real *row) {
    for (int k = 0; k < 4; k++) to[k] += row[k];
}

#endif
