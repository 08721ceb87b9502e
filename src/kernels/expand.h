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
/* Expansion with further arguments. */
#define GN_EACH_32(X, ...)                                                                         \
    X(0x00, __VA_ARGS__) X(0x01, __VA_ARGS__) X(0x02, __VA_ARGS__) X(0x03, __VA_ARGS__) \
    X(0x04, __VA_ARGS__) X(0x05, __VA_ARGS__) X(0x06, __VA_ARGS__) X(0x07, __VA_ARGS__) \
    X(0x08, __VA_ARGS__) X(0x09, __VA_ARGS__) X(0x0a, __VA_ARGS__) X(0x0b, __VA_ARGS__) \
    X(0x0c, __VA_ARGS__) X(0x0d, __VA_ARGS__) X(0x0e, __VA_ARGS__) X(0x0f, __VA_ARGS__) \
    X(0x10, __VA_ARGS__) X(0x11, __VA_ARGS__) X(0x12, __VA_ARGS__) X(0x13, __VA_ARGS__) \
    X(0x14, __VA_ARGS__) X(0x15, __VA_ARGS__) X(0x16, __VA_ARGS__) X(0x17, __VA_ARGS__) \
    X(0x18, __VA_ARGS__) X(0x19, __VA_ARGS__) X(0x1a, __VA_ARGS__) X(0x1b, __VA_ARGS__) \
    X(0x1c, __VA_ARGS__) X(0x1d, __VA_ARGS__) X(0x1e, __VA_ARGS__) X(0x1f, __VA_ARGS__)
/* clang-format on */

#define GN_BIT(v, b) (((v) >> (b)) & 1)

#endif
