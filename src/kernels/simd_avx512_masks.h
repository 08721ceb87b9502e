/* Masks of either precision are bits in a mask register, of type gn_m. */
#ifndef GN_KERNELS_SIMD_AVX512_MASKS_H
#define GN_KERNELS_SIMD_AVX512_MASKS_H

GN_INLINE gn_m gn_m_none(void) {
    return 0;
}
GN_INLINE gn_m gn_and(gn_m a, gn_m b) {
    return (gn_m)(a & b);
}
GN_INLINE gn_m gn_or(gn_m a, gn_m b) {
    return (gn_m)(a | b);
}
GN_INLINE gn_m gn_not(gn_m a) {
    return (gn_m)~a;
}
GN_INLINE unsigned gn_bits(gn_m m) {
    return m;
}

#endif
