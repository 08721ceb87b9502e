/* Volume, centre and moments of unions of spheres and discs. */
#include "clump_helpers.h"

#include "base/rotation.h"

/* Places spheres on the x axis into space: rotated by a vector, then shifted. */
static void turn_spheres(double (*sphere)[4], size_t count, const double vector[3],
                         const double shift[3]) {
    double turn[4], axes[9];
    gn_turn_of_vector(vector, turn);
    gn_turn_axes(turn, axes);
    for (size_t k = 0; k < count; k++) {
        double x[3];
        gn_axes_direct(axes, sphere[k], x);
        for (int a = 0; a < 3; a++) sphere[k][a] = x[a] + shift[a];
    }
}

static const double turn[3] = {0.3, -1.1, 0.7}, shift[3] = {0.2, -3.0, 1.5};

static void check_chain(size_t count, const double (*ball)[2]) {
    double sphere[4][4] = {{0}}, sum[4], axes[9], q[4], along[3];
    for (size_t k = 0; k < count; k++) {
        sphere[k][0] = ball[k][0];
        sphere[k][3] = ball[k][1];
    }
    chain(count, ball, sum);
    turn_spheres(sphere, count, turn, shift);
    gn_sphere_union u = union_of(sphere[0], count, 3);
    gn_turn_of_vector(turn, q);
    gn_turn_axes(q, axes);
    for (int a = 0; a < 3; a++) along[a] = axes[3 * a];
    const double middle = sum[1] / sum[0], far = sum[2] - sum[1] * middle;
    assert_near(u.volume / sum[0], 1.0, 1e-12);
    for (int a = 0; a < 3; a++) assert_near(u.centre[a], middle * along[a] + shift[a], 1e-12);
    for (int a = 0; a < 9; a++) {
        const double product = along[a / 3] * along[a % 3], unit = a % 4 == 0 ? 1.0 : 0.0;
        const double form = 2.0 * sum[3] * product + (far + sum[3]) * (unit - product);
        assert_near(u.moment[a] / sum[2], form / sum[2], 1e-11);
    }
}

static void two_spheres_have_the_moments_of_their_closed_form(void **state) {
    (void)state;
    check_chain(2, (const double[][2]){{0.0, 1.0}, {1.2, 0.7}});
    check_chain(2, (const double[][2]){{0.0, 1.0}, {0.05, 1.0}});
    check_chain(2, (const double[][2]){{0.0, 1.0}, {1.9999, 1.0}});
    check_chain(2, (const double[][2]){{0.0, 1e-3}, {1.5e-3, 1e-3}});
}

static void a_chain_of_three_has_the_moments_of_its_closed_form(void **state) {
    (void)state;
    check_chain(3, (const double[][2]){{0.0, 1.0}, {1.5, 0.8}, {2.9, 1.1}});
}

/* Returns the volume common to three balls (Gibson and Scheraga 1987, J. Phys. Chem. 91, 4121, eq.
 * 2), from the radii and the distances of the centres that lie opposite to them. */
static double common_volume(const double r[3], const double d[3]) {
    double r2[3], d2[3], e[3], q[3], sum[3] = {0, 0, 0}, volume;
    for (int k = 0; k < 3; k++) {
        r2[k] = r[k] * r[k];
        d2[k] = d[k] * d[k];
    }
    for (int k = 0; k < 3; k++) {
        const int m = (k + 1) % 3, n = (k + 2) % 3;
        e[k] = (r2[m] - r2[n]) / d2[k];
    }
    for (int k = 0; k < 3; k++) {
        const int m = (k + 1) % 3, n = (k + 2) % 3;
        q[k] =
            d[k] * (d2[m] + d2[n] - d2[k] + r2[m] + r2[n] - 2.0 * r2[k] + e[k] * (d2[m] - d2[n]));
        sum[0] += r2[k] * d2[k];
        sum[1] += d2[k];
        sum[2] += r2[k] * d2[k] * d2[k];
    }
    const double w = sqrt(sum[0] * sum[1] - 2.0 * sum[2] +
                          d2[0] * d2[1] * d2[2] * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0] - 1.0));
    volume = w / 6.0;
    for (int k = 0; k < 3; k++) {
        const int m = (k + 1) % 3, n = (k + 2) % 3;
        volume -= 0.5 * d[k] * (r2[m] + r2[n] - d2[k] * (1.0 / 6.0 - 0.5 * e[k] * e[k])) *
                  atan2(2.0 * w, q[k]);
        volume += 2.0 / 3.0 * r2[k] * r[k] *
                  (atan2(d[m] * w * (1.0 - e[m]), r[k] * q[m]) +
                   atan2(d[n] * w * (1.0 + e[n]), r[k] * q[n]));
    }
    return volume;
}

static double ball_volume(double r) {
    return 4.0 / 3.0 * pi * r * r * r;
}

/* Returns the volume common to two balls at a distance. */
static double lens_volume(double a, double b, double d) {
    const double s = a + b - d, t = d * d + 2.0 * d * (a + b) - 3.0 * (a - b) * (a - b);
    return pi * s * s * t / (12.0 * d);
}

static void three_spheres_that_meet_have_the_volume_of_their_closed_form(void **state) {
    (void)state;
    const double radius[2][3] = {{1.0, 1.0, 1.0}, {1.0, 0.9, 0.75}},
                 at[2][3] = {{1.0, 0.5, 0.86602540378443864676}, {0.8, 0.3, 0.9}};
    for (int k = 0; k < 2; k++) {
        const double *r = radius[k], x = at[k][1], y = at[k][2];
        double sphere[3][4] = {{0, 0, 0, r[0]}, {at[k][0], 0, 0, r[1]}, {x, y, 0, r[2]}};
        const double d[3] = {hypot(x - at[k][0], y), hypot(x, y), at[k][0]};
        turn_spheres(sphere, 3, turn, shift);
        double volume = common_volume(r, d);
        for (int a = 0; a < 3; a++)
            volume += ball_volume(r[a]) - lens_volume(r[(a + 1) % 3], r[(a + 2) % 3], d[a]);
        assert_near(union_of(sphere[0], 3, 3).volume / volume, 1.0, 1e-11);
    }
}

/* Spheres with many triple overlaps. */
static void make_cluster(double (*sphere)[4], int count) {
    uint64_t at = 0;
    for (int k = 0; k < count; k++) {
        for (int a = 0; a < 3; a++) sphere[k][a] = uniform(&at, -1.0, 1.0);
        sphere[k][3] = uniform(&at, 0.3, 0.7);
    }
}

/* Sections across another direction have other patterns, so that agreement shows the accuracy. */
static void check_direction(int count) {
    double sphere[80][4], axes[9], q[4];
    make_cluster(sphere, count);
    gn_sphere_union u = union_of(sphere[0], (size_t)count, 3);
    turn_spheres(sphere, (size_t)count, turn, shift);
    gn_sphere_union v = union_of(sphere[0], (size_t)count, 3);
    gn_turn_of_vector(turn, q);
    gn_turn_axes(q, axes);
    assert_near(v.volume / u.volume, 1.0, 1e-11);
    for (int a = 0; a < 3; a++)
        assert_near(v.centre[a], dot3(axes + 3 * a, u.centre) + shift[a], 1e-11);
    for (int a = 0; a < 9; a++) {
        double turned = 0.0;
        for (int b = 0; b < 9; b++)
            turned += axes[3 * (a / 3) + b / 3] * u.moment[b] * axes[3 * (a % 3) + b % 3];
        assert_near(v.moment[a] / u.moment[0], turned / u.moment[0], 1e-10);
    }
}

/* Most points on three of eighty such spheres are inside others. */
static void moments_do_not_depend_on_the_direction_of_sections(void **state) {
    (void)state;
    check_direction(20);
    check_direction(80);
}

static void many_spheres_agree_with_random_points(void **state) {
    (void)state;
    enum { POINTS = 200000 };
    double sphere[20][4], sum[3] = {0, 0, 0}, second = 0.0;
    uint64_t at = 1000;
    make_cluster(sphere, 20);
    gn_sphere_union u = union_of(sphere[0], 20, 3);
    const double box = 3.4 * 3.4 * 3.4 / POINTS;
    for (int k = 0; k < POINTS; k++) {
        double x[3];
        bool inside = false;
        for (int a = 0; a < 3; a++) x[a] = uniform(&at, -1.7, 1.7);
        for (int s = 0; s < 20 && !inside; s++) {
            double d[3];
            for (int a = 0; a < 3; a++) d[a] = x[a] - sphere[s][a];
            inside = length3(d) < sphere[s][3];
        }
        if (!inside) continue;
        const double y = x[1] - u.centre[1], z = x[2] - u.centre[2];
        sum[0] += box;
        sum[1] += box * x[0];
        second += box * (y * y + z * z);
    }
    /* Five standard deviations of a share of 0.4 of so many points. */
    assert_near(sum[0] / u.volume, 1.0, 0.015);
    assert_near(sum[1] / sum[0], u.centre[0], 0.02);
    assert_near(second / u.moment[0], 1.0, 0.025);
}

static void a_sphere_inside_another_one_counts_nothing(void **state) {
    (void)state;
    const double sphere[3][4] = {{0, 0, 0, 1}, {0.2, 0.1, -0.3, 0.5}, {0, 0, 0, 1}};
    gn_sphere_union u = union_of(sphere[0], 3, 3);
    assert_near(u.volume, ball_volume(1.0), 1e-13);
    for (int a = 0; a < 9; a++)
        assert_near(u.moment[a], a % 4 == 0 ? 0.4 * ball_volume(1.0) : 0.0, 1e-12);
}

/* Two equal discs: twice a disc less the lens, whose second moments about the middle are known from
 * those of a circular segment. */
static void discs_in_the_plane_are_exact(void **state) {
    (void)state;
    const double r = 0.7, d = 0.9, half = acos(0.5 * d / r);
    const double sphere[2][4] = {{1.0, 2.0, 0, r}, {1.0, 2.0 + d, 0, r}};
    gn_sphere_union u = union_of(sphere[0], 2, 2);
    const double segment = 0.5 * r * r * (2.0 * half - sin(2.0 * half));
    assert_near(u.volume, 2.0 * (pi * r * r - segment), 1e-13);
    assert_near(u.centre[1], 2.0 + 0.5 * d, 1e-13);
    /* Polar second moment of a segment about the centre of its disc. */
    const double h = r * cos(half), c = r * sin(half);
    const double polar = 0.5 * half * pow(r, 4) - h * c * (h * h / 2.0 + c * c / 6.0);
    /* First moment of a disc without its segment, along y from the centre of the disc. */
    const double first = -2.0 / 3.0 * pow(c, 3), area = pi * r * r - segment;
    const double own = 0.5 * pi * pow(r, 4) - polar;
    const double moment = 2.0 * (own - d * first + 0.25 * d * d * area);
    assert_near(u.moment[8], moment, 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_spheres_have_the_moments_of_their_closed_form),
        cmocka_unit_test(a_chain_of_three_has_the_moments_of_its_closed_form),
        cmocka_unit_test(three_spheres_that_meet_have_the_volume_of_their_closed_form),
        cmocka_unit_test(moments_do_not_depend_on_the_direction_of_sections),
        cmocka_unit_test(many_spheres_agree_with_random_points),
        cmocka_unit_test(a_sphere_inside_another_one_counts_nothing),
        cmocka_unit_test(discs_in_the_plane_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
