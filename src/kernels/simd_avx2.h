/* AVX2 backend. */
#ifndef GN_KERNELS_SIMD_AVX2_H
#define GN_KERNELS_SIMD_AVX2_H

#include <immintrin.h>

#if GN_MIXED
#include "kernels/simd_avx2_single.h"
#else
#include "kernels/simd_avx2_double.h"
#endif
#include "kernels/simd_x86_sums.h"

#endif
