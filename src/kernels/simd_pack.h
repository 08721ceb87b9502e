/* Packs numbers, eight at a time: those selected by `bits` are stored contiguously; unpacking
 * restores their places. Whole vectors are written, so that up to eight numbers may be written
 * after the last one. */
#ifndef GN_KERNELS_SIMD_PACK_H
#define GN_KERNELS_SIMD_PACK_H

#include "kernels/simd.h"

#ifdef __AVX512VL__

GN_INLINE void gn_pack_f64(double *to, const double *from, unsigned bits) {
    _mm512_storeu_pd(to, _mm512_maskz_compress_pd((__mmask8)bits, _mm512_loadu_pd(from)));
}
GN_INLINE void gn_pack_32(void *to, const void *from, unsigned bits) {
    __m256i v = _mm256_loadu_si256((const __m256i *)from);
    _mm256_storeu_si256((__m256i *)to, _mm256_maskz_compress_epi32((__mmask8)bits, v));
}
/* Restores the places of packed numbers, with zeros elsewhere. The numbers are added to 0, so that
 * negative zeros become positive. */
GN_INLINE __m512d gn_unpacked_f64(const double *from, unsigned bits) {
    __m512d v = _mm512_add_pd(_mm512_loadu_pd(from), _mm512_setzero_pd());
    return _mm512_maskz_expand_pd((__mmask8)bits, v);
}
GN_INLINE void gn_unpack_f64(double *to, const double *from, unsigned bits) {
    _mm512_storeu_pd(to, gn_unpacked_f64(from, bits));
}
/* Converts numbers packed according to `was` to those of `bits`. */
GN_INLINE void gn_repack_f64(double *to, const double *from, unsigned was, unsigned bits) {
    _mm512_storeu_pd(to, _mm512_maskz_compress_pd((__mmask8)bits, gn_unpacked_f64(from, was)));
}

#else

GN_INLINE void gn_pack_f64(double *to, const double *from, unsigned bits) {
    for (int k = 0; k < 8; k++) {
        *to = from[k];
        to += bits >> k & 1u;
    }
}
GN_INLINE void gn_pack_32(void *to, const void *from, unsigned bits) {
    int32_t *out = to;
    const int32_t *in = from;
    for (int k = 0; k < 8; k++) {
        *out = in[k];
        out += bits >> k & 1u;
    }
}
GN_INLINE void gn_unpack_f64(double *to, const double *from, unsigned bits) {
    for (int k = 0; k < 8; k++) to[k] = 0.0;
    for (; bits; bits &= bits - 1u) to[__builtin_ctz(bits)] = *from++ + 0.0;
}
GN_INLINE void gn_repack_f64(double *to, const double *from, unsigned was, unsigned bits) {
    for (unsigned left = was | bits; left; left &= left - 1u) {
        const unsigned k = (unsigned)__builtin_ctz(left), old = was >> k & 1u;
        *to = old ? *from + 0.0 : 0.0;
        from += old;
        to += bits >> k & 1u;
    }
}

#endif
#endif
