/* NEON backend (any aarch64). */
#ifndef GN_KERNELS_SIMD_NEON_H
#define GN_KERNELS_SIMD_NEON_H

#include <arm_neon.h>

#if GN_MIXED
#include "kernels/simd_neon_single.h"
#else
#include "kernels/simd_neon_double.h"
#endif

GN_INLINE gn_m gn_and(gn_m a, gn_m b) {
    return a & b;
}
GN_INLINE gn_m gn_or(gn_m a, gn_m b) {
    return a | b;
}
GN_INLINE gn_m gn_not(gn_m a) {
    return ~a;
}
/* Returns b if either is NaN, as the scalar backend does. */
GN_INLINE gn_v gn_max(gn_v a, gn_v b) {
    return gn_where(gn_less(b, a), a, b);
}
GN_INLINE gn_v gn_keep(gn_m m, gn_v a) {
    return gn_where(m, a, gn_set(0.0));
}

#endif
