/* A program in two parts. Long runs over code that its other tests cover as well take minutes under
 * a sanitizer: called with an argument the program runs only these, without one only the others,
 * and meson.build makes a test of each. */
#ifndef GN_TESTS_PARTS_H
#define GN_TESTS_PARTS_H

#define run_part(argc, tests, long_tests)                                                          \
    ((argc) > 1 ? cmocka_run_group_tests(long_tests, NULL, NULL)                                   \
                : cmocka_run_group_tests(tests, NULL, NULL))

#endif
