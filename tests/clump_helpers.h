/* Unions of spheres, and the closed form of those on a line. */
#ifndef GN_TESTS_CLUMP_HELPERS_H
#define GN_TESTS_CLUMP_HELPERS_H

#include "surface_helpers.h"

#include "surfaces/sphere_union.h"

/* Adds the integrals of 1, x, x2 and y2 over the part of a ball about x = c between x = low and x =
 * high; a section has the area pi (r2 - (x - c)2) and the second moment area2/(4 pi). */
static inline void add_part(double c, double r, double low, double high, double sum[4]) {
    const double at[2] = {low - c, high - c};
    double power[6]; /* integrals of (x - c)^k */
    for (int k = 0; k < 6; k++) power[k] = (pow(at[1], k + 1) - pow(at[0], k + 1)) / (k + 1);
    const double area[3] = {r * r * power[0] - power[2], r * r * power[1] - power[3],
                            r * r * power[2] - power[4]};
    sum[0] += pi * area[0];
    sum[1] += pi * (area[1] + c * area[0]);
    sum[2] += pi * (area[2] + 2.0 * c * area[1] + c * c * area[0]);
    sum[3] += 0.25 * pi * (pow(r, 4) * power[0] - 2.0 * r * r * power[2] + power[4]);
}

/* The closed form of balls on the x axis, of which each meets the next one alone. */
static inline void chain(size_t count, const double (*ball)[2], double sum[4]) {
    double low = ball[0][0] - ball[0][1];
    memset(sum, 0, 4 * sizeof *sum);
    for (size_t k = 0; k < count; k++) {
        double high = ball[k][0] + ball[k][1];
        if (k + 1 < count) {
            const double d = ball[k + 1][0] - ball[k][0];
            high = ball[k][0] +
                   (d * d + ball[k][1] * ball[k][1] - ball[k + 1][1] * ball[k + 1][1]) / (2.0 * d);
        }
        add_part(ball[k][0], ball[k][1], low, high, sum);
        low = high;
    }
}

static inline gn_sphere_union union_of(const double *sphere, size_t count, int dimension) {
    gn_sphere_union u;
    gneiss_error error = {0};
    assert_ok(gn_sphere_union_measure(sphere, count, dimension, &u, &error), &error);
    assert_true(u.error < 1e-12);
    return u;
}

#endif
