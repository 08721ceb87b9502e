/* The laboratory tests that are known by name. */
#ifndef GN_BASE_TEST_KIND_H
#define GN_BASE_TEST_KIND_H

#include <stdbool.h>

typedef enum gn_test_kind {
    GN_TEST_NONE,
    GN_TEST_COMPRESSION,
    GN_TEST_TENSION,
    GN_TEST_BRAZILIAN,    /* a disc pressed across its diameter */
    GN_TEST_BENDING,      /* a beam on two supports under one or two loads */
    GN_TEST_TRIAXIAL,     /* pressed along an axis, under a pressure on its sides */
    GN_TEST_BIAXIAL,      /* the same in plane strain */
    GN_TEST_HYDROSTATIC,  /* pressed from all sides alike */
    GN_TEST_OEDOMETER,    /* pressed along an axis, between sides that stand */
    GN_TEST_SHEAR,        /* one half moved along the other */
    GN_TEST_SIMPLE_SHEAR, /* the same between periodic sides */
    GN_TEST_KINDS
} gn_test_kind;

/* Sets of kinds. */
#define GN_TESTS(name)    (1u << GN_TEST_##name)
#define GN_TESTS_CONFINED (GN_TESTS(TRIAXIAL) | GN_TESTS(BIAXIAL))
#define GN_TESTS_SHEARED  (GN_TESTS(SHEAR) | GN_TESTS(SIMPLE_SHEAR))
#define GN_TESTS_PRISMS                                                                            \
    (GN_TESTS(COMPRESSION) | GN_TESTS(TENSION) | GN_TESTS(OEDOMETER) | GN_TESTS_CONFINED)
static inline bool gn_test_in(gn_test_kind kind, unsigned kinds) {
    return kinds >> kind & 1;
}

/* What is counted positive: +1 the upper end along the axis, -1 against it. */
static inline int gn_test_sign(gn_test_kind kind) {
    return gn_test_in(kind, GN_TESTS(TENSION) | GN_TESTS_SHEARED) ? 1 : -1;
}

#endif
