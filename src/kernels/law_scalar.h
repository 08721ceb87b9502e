/* The functions of contact laws for one contact at a time, in double, used by walls and
 * surfaces. */
#ifndef GN_KERNELS_LAW_SCALAR_H
#define GN_KERNELS_LAW_SCALAR_H

#ifdef GN_SIMD
#error "for sources that are not compiled per instruction set"
#endif
#define GN_SIMD  "kernels/simd_scalar.h"
#define GN_MIXED 0
#include "kernels/contact_law.h"

static inline gn_v3 gn_v3_of(const double a[3]) {
    return (gn_v3){a[0], a[1], a[2]};
}

#endif
