/* AVX-512 backend. */
#ifndef GN_KERNELS_SIMD_AVX512_H
#define GN_KERNELS_SIMD_AVX512_H

#include <immintrin.h>

#if GN_MIXED
#include "kernels/simd_avx512_single.h"
#else
#include "kernels/simd_avx512_double.h"
#endif
#include "kernels/simd_x86_sums.h"

#endif
