/* Expands X(number) over the numbers of kernel variants, as literals that can be part of a name. */
#ifndef GN_KERNELS_EXPAND_H
#define GN_KERNELS_EXPAND_H

/* clang-format off */
#define GN_EACH_16(X, h)                                                                           \
    X(0x##h##0) X(0x##h##1) X(0x##h##2) X(0x##h##3) X(0x##h##4) X(0x##h##5) X(0x##h##6)            \
    X(0x##h##7) X(0x##h##8) X(0x##h##9) X(0x##h##a) X(0x##h##b) X(0x##h##c) X(0x##h##d)            \
    X(0x##h##e) X(0x##h##f)
#define GN_EACH_128(X)                                                                             \
    GN_EACH_16(X, 0) GN_EACH_16(X, 1) GN_EACH_16(X, 2) GN_EACH_16(X, 3)                            \
    GN_EACH_16(X, 4) GN_EACH_16(X, 5) GN_EACH_16(X, 6) GN_EACH_16(X, 7)
#define GN_EACH_256(X)                                                                             \
    GN_EACH_128(X)                                                                                 \
    GN_EACH_16(X, 8) GN_EACH_16(X, 9) GN_EACH_16(X, a) GN_EACH_16(X, b)                            \
    GN_EACH_16(X, c) GN_EACH_16(X, d) GN_EACH_16(X, e) GN_EACH_16(X, f)
/* clang-format on */

#define GN_BIT(v, b) (((v) >> (b)) & 1)

#endif
