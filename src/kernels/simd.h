/* The SIMD vocabulary in which kernels are written. GN_SIMD (set by the build) is the header of the
 * instruction set's backend; GN_MIXED 1 selects single precision, with twice the lanes. Arithmetic
 * uses the operators + - * / on gn_v, which round every operation separately (no contraction), and
 * gn_fma and gn_fnma, which round once where they are written, so that all backends give the same
 * bits lane by lane.
 *
 * gn_real: double or float; gn_v: GN_W of them; gn_m: a mask of GN_W lanes. */
#ifndef GN_KERNELS_SIMD_H
#define GN_KERNELS_SIMD_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define GN_INLINE static inline __attribute__((always_inline))

#if GN_MIXED
typedef float gn_real;
#define GN_TINY           1e-30 /* smaller than any stiffness or length, but its inverse is finite */
#define GN_MATH(function) function##f
#else
typedef double gn_real;
#define GN_TINY           1e-150
#define GN_MATH(function) function
#endif

#ifndef GN_SIMD /* for tools that read a file without the build */
#define GN_SIMD "kernels/simd_scalar.h"
#endif
#include GN_SIMD
#ifndef GN_OWN_SUMS
#include "kernels/simd_sums.h"
#endif

/* Loads the four numbers of row index[k] into lane k. */
GN_INLINE void gn_rows4(const gn_real *rows, const int32_t *index, gn_v out[4]) {
    gn_v r[4];
    gn_gather4(rows, index, r);
    gn_columns4(r, out);
}

#ifndef GN_OWN_EVERY
GN_INLINE void gn_gather4_every(const gn_real *rows, int step, gn_v out[4]) {
    int32_t index[GN_W];
    for (int k = 0; k < GN_W; k++) index[k] = step * k;
    gn_gather4(rows, index, out);
}
#endif

/* Loads row step * k into lane k, for a literal step. */
GN_INLINE void gn_rows4_every(const gn_real *rows, int step, gn_v out[4]) {
    gn_v r[4];
    gn_gather4_every(rows, step, r);
    gn_columns4(r, out);
}

/* Loads the difference of row index[k] and the row of `first` (gathered) into lane k. */
GN_INLINE void gn_rows4_beyond(const gn_real *rows, const int32_t *index, const gn_v first[4],
                               gn_v out[4]) {
    gn_v r[4];
    gn_gather4(rows, index, r);
    for (int k = 0; k < 4; k++) r[k] = r[k] - first[k];
    gn_columns4(r, out);
}

/* Loads the difference of rows index[k] and from[k] into lane k; this takes one transposition
 * instead of two. */
GN_INLINE void gn_rows4_less(const gn_real *rows, const int32_t *index, const int32_t *from,
                             gn_v out[4]) {
    gn_v first[4];
    gn_gather4(rows, from, first);
    gn_rows4_beyond(rows, index, first, out);
}

/* Loads the sum of rows index[0][k], index[1][k], ... into lane k. */
GN_INLINE void gn_rows4_sum(const gn_real *rows, const int32_t *const *index, int count,
                            gn_v out[4]) {
    gn_v r[4], s[4];
    gn_gather4(rows, index[0], r);
    for (int n = 1; n < count; n++) {
        gn_gather4(rows, index[n], s);
        for (int k = 0; k < 4; k++) r[k] = r[k] + s[k];
    }
    gn_columns4(r, out);
}

/* Returns the index at which a parameter is read: 0 if it is uniform (`uniform` all bits set), else
 * `item`. */
GN_INLINE size_t gn_column_at(size_t item, size_t uniform) {
    return item & ~uniform;
}

/* Returns a if the literal is nonzero, else b. (A conditional expression does not accept products
 * of vector types.) */
GN_INLINE gn_v gn_pick(int literal, gn_v a, gn_v b) {
    return literal ? a : b;
}

/* Returns the sum of the lanes, in lane order. */
GN_INLINE double gn_fold(gn_v v) {
    double lanes[GN_W], sum = 0.0;
    gn_store_wide(lanes, v);
    for (int k = 0; k < GN_W; k++) sum += lanes[k];
    return sum;
}

/* A vector of three components; in 2D z stays zero and is not computed. */
typedef struct gn_v3 {
    gn_v x, y, z;
} gn_v3;

/* Vector functions; `space` is a literal: 1 in 3D, 0 in 2D. If the two particles of a contact are
 * exchanged, some arguments change sign; every function below then returns the same bits except for
 * the sign, fused products included. */
GN_INLINE gn_v gn_dot(gn_v3 a, gn_v3 b, int space) {
    gn_v s = gn_fma(a.y, b.y, a.x * b.x);
    if (space) s = gn_fma(a.z, b.z, s);
    return s;
}

/* a + s b */
GN_INLINE gn_v3 gn_axpy(gn_v3 a, gn_v s, gn_v3 b, int space) {
    gn_v3 r = {gn_fma(s, b.x, a.x), gn_fma(s, b.y, a.y), a.z};
    if (space) r.z = gn_fma(s, b.z, a.z);
    return r;
}

/* a - s b */
GN_INLINE gn_v3 gn_axmy(gn_v3 a, gn_v s, gn_v3 b, int space) {
    gn_v3 r = {gn_fnma(s, b.x, a.x), gn_fnma(s, b.y, a.y), a.z};
    if (space) r.z = gn_fnma(s, b.z, a.z);
    return r;
}

GN_INLINE gn_v3 gn_sub(gn_v3 a, gn_v3 b, int space) {
    gn_v3 r = {a.x - b.x, a.y - b.y, a.z};
    if (space) r.z = a.z - b.z;
    return r;
}

GN_INLINE gn_v3 gn_add(gn_v3 a, gn_v3 b, int space) {
    gn_v3 r = {a.x + b.x, a.y + b.y, a.z};
    if (space) r.z = a.z + b.z;
    return r;
}

GN_INLINE gn_v3 gn_scale(gn_v s, gn_v3 a, int space) {
    gn_v3 r = {s * a.x, s * a.y, a.z};
    if (space) r.z = s * a.z;
    return r;
}

/* a x b; 2D: in-plane a and b, only z is computed. */
GN_INLINE gn_v3 gn_cross(gn_v3 a, gn_v3 b, int space) {
    gn_v3 r = {gn_set(0.0), gn_set(0.0), gn_fnma(a.y, b.x, a.x * b.y)};
    if (space) {
        r.x = gn_fnma(a.z, b.y, a.y * b.z);
        r.y = gn_fnma(a.x, b.z, a.z * b.x);
    }
    return r;
}

/* a - w x b for a spin w; 2D: w along z, a and b in the plane. */
GN_INLINE gn_v3 gn_less_spin_cross(gn_v3 a, gn_v3 w, gn_v3 b, int space) {
    gn_v3 r = {gn_fma(w.z, b.y, a.x), gn_fnma(w.z, b.x, a.y), a.z};
    if (space) {
        r.x = gn_fnma(w.y, b.z, r.x);
        r.y = gn_fma(w.x, b.z, r.y);
        r.z = gn_fnma(w.x, b.y, gn_fma(w.y, b.x, a.z));
    }
    return r;
}

GN_INLINE gn_v3 gn_load3(const gn_real *columns, uint64_t stride, int space) {
    gn_v3 r = {gn_load(columns), gn_load(columns + stride), gn_set(0.0)};
    if (space) r.z = gn_load(columns + 2 * stride);
    return r;
}

GN_INLINE void gn_store3(gn_real *columns, uint64_t stride, gn_v3 a, int space) {
    gn_store(columns, a.x);
    gn_store(columns + stride, a.y);
    if (space) gn_store(columns + 2 * stride, a.z);
}

#endif
