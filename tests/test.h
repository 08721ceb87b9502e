/* Headers of every cmocka test, in the order that cmocka requires. */
#ifndef GN_TESTS_TEST_H
#define GN_TESTS_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* cmocka 1.1 writes a skipped test as `not ok`, which meson shows as a failure: a test therefore
 * makes everything that it needs. */
#undef skip

/* |a - b| <= tolerance * max(|a|, |b|); prints both on failure. */
#define assert_close(a, b, tolerance)                                                              \
    do {                                                                                           \
        double gn_a = (a), gn_b = (b);                                                             \
        if (!(fabs(gn_a - gn_b) <= (tolerance)*fmax(fabs(gn_a), fabs(gn_b))))                      \
            fail_msg("%s = %.17g, %s = %.17g, relative difference %.3g > %.3g", #a, gn_a, #b,      \
                     gn_b, fabs(gn_a - gn_b) / fmax(fabs(gn_a), fabs(gn_b)), (double)(tolerance)); \
    } while (0)

/* Root of the source tree, for scenes and specimens. */
static inline const char *test_source(void) {
    const char *root = getenv("GNEISS_SOURCE");
    return root ? root : ".";
}

#endif
