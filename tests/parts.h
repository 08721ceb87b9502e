/* A program in two parts. Long runs over code that its other tests run as well take minutes under a
 * sanitizer: called with an argument it runs these alone, without one the others alone, and
 * meson.build makes a test of each. */
#ifndef GN_TESTS_PARTS_H
#define GN_TESTS_PARTS_H

#define run_part(argc, tests, long_tests)                                                          \
    ((argc) > 1 ? cmocka_run_group_tests(long_tests, NULL, NULL)                                   \
                : cmocka_run_group_tests(tests, NULL, NULL))

#endif
