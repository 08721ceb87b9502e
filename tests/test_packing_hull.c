/* The convex hull of spheres and discs against closed forms and bounds, however they are turned. */
#include "test.h"

#include "measure/delaunay.h"
#include "measure/measure.h"

#include "cloud.h"

static double hull_of(int dimension) {
    gn_particles p = particles_of_cloud(all_effects, true);
    double volume, lower[3], upper[3];
    assert_int_equal(gn_packing_hull(&p, dimension, &volume, lower, upper, NULL), GNEISS_OK);
    particles_free(&p);
    return volume;
}

/* Turns about z, then, in space, about x and y. */
static void turn_cloud(int dimension, double angle) {
    for (size_t k = 0; k < points.count; k++)
        for (int axis = 2; axis >= (dimension == 3 ? 0 : 2); axis--) {
            double *x = points.row[k], c = cos(angle * (axis + 1)), s = sin(angle * (axis + 1));
            const int a = (axis + 1) % 3, b = (axis + 2) % 3;
            const double first = x[a], second = x[b];
            x[a] = c * first - s * second;
            x[b] = s * first + c * second;
        }
}

static const double angles[] = {0, 0.3, 0.7853981633974483, 1.1};

/* Equal spheres at the places of a cubic lattice (Steiner). */
static void a_cube_of_spheres_has_its_volume_however_it_is_turned(void **state) {
    (void)state;
    for (int n = 2; n <= 11; n += 3)
        for (size_t t = 0; t < sizeof angles / sizeof *angles; t++) {
            const double r = 0.5, a = n - 1;
            points.count = 0;
            for (int k = 0; k < n * n * n; k++) cloud_add(k % n, k / n % n, k / (n * n), r);
            turn_cloud(3, angles[t]);
            assert_close(hull_of(3),
                         a * a * a + 6 * a * a * r + 3 * M_PI * a * r * r +
                             4.0 / 3.0 * M_PI * r * r * r,
                         3e-4);
        }
}

static void a_square_of_discs_has_its_area_however_it_is_turned(void **state) {
    (void)state;
    for (int n = 1; n <= 41; n += 8)
        for (size_t t = 0; t < sizeof angles / sizeof *angles; t++) {
            const double r = 0.5, a = n - 1;
            points.count = 0;
            for (int k = 0; k < n * n; k++) cloud_add(k % n, k / n, 0, r);
            turn_cloud(2, angles[t]);
            assert_close(hull_of(2), a * a + 4 * a * r + M_PI * r * r, 1e-4);
        }
}

/* One sphere, a row of them and a layer, whose centres have no volume; discs in a row. */
static void spheres_in_a_point_a_line_or_a_plane_have_a_hull(void **state) {
    (void)state;
    const double r = 0.5, ball = 4.0 / 3.0 * M_PI * r * r * r;
    for (size_t t = 0; t < sizeof angles / sizeof *angles; t++) {
        points.count = 0;
        cloud_add(0.3, -0.2, 0.1, r);
        turn_cloud(3, angles[t]);
        assert_close(hull_of(3), ball, 1e-12);
        for (int n = 2; n < 5; n++) {
            points.count = 0;
            for (int k = 0; k < n; k++) cloud_add(k, 0, 0, r);
            turn_cloud(3, angles[t]);
            assert_close(hull_of(3), ball + M_PI * r * r * (n - 1), 3e-4);
            points.count = 0;
            for (int k = 0; k < n; k++) cloud_add(k, 0, 0, r);
            turn_cloud(2, angles[t]);
            assert_close(hull_of(2), M_PI * r * r + 2 * r * (n - 1), 1e-9);
            points.count = 0;
            const double a = n - 1;
            for (int k = 0; k < n * n; k++) cloud_add(k % n, k / n, 0, r);
            turn_cloud(3, angles[t]);
            assert_close(hull_of(3), ball + 2 * a * a * r + 2 * M_PI * a * r * r, 3e-4);
        }
    }
}

/* Caps of both and the frustum of the cone that touches them. */
static double cone_volume(double big, double small, double apart) {
    const double c = (big - small) / apart, s2 = 1 - c * c, x = big * c, y = small * c;
    return M_PI * (2 * big * big * big / 3 + big * big * x - x * x * x / 3) +
           M_PI / 3 * (apart + y - x) * s2 * (big * big + big * small + small * small) +
           M_PI * (2 * small * small * small / 3 - small * small * y + y * y * y / 3);
}

static void two_spheres_of_unlike_size_have_a_cone_about_them(void **state) {
    (void)state;
    for (size_t t = 0; t < sizeof angles / sizeof *angles; t++)
        for (double small = 0.1; small < 1; small += 0.3) {
            points.count = 0;
            cloud_add(0, 0, 0, 1);
            cloud_add(1 + small, 0, 0, small);
            turn_cloud(3, angles[t]);
            assert_close(hull_of(3), cone_volume(1, small, 1 + small), 3e-4);
        }
}

/* The hull of the farthest points in many directions is a lower bound. */
static double inner_hull(int dimension) {
    enum { MANY = 6000 };
    double *all = malloc(MANY * 3 * sizeof *all), volume;
    for (int k = 0; k < MANY; k++) {
        const double z = dimension == 3 ? 1 - (2 * k + 1.0) / MANY : 0,
                     turn = dimension == 3 ? M_PI * (3 - sqrt(5)) * k : 2 * M_PI * k / MANY;
        const double n[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
        double most = -INFINITY;
        for (size_t p = 0; p < points.count; p++) {
            const double *x = points.row[p];
            double reach = n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + x[3];
            if (reach <= most) continue;
            most = reach;
            for (int a = 0; a < dimension; a++) all[k * dimension + a] = x[a] + x[3] * n[a];
        }
    }
    assert_int_equal(gn_hull_volume(all, MANY, dimension, &volume, NULL), GNEISS_OK);
    free(all);
    return volume;
}

static void assert_bounded(int dimension, const char *what) {
    const double volume = hull_of(dimension), least = inner_hull(dimension);
    if (!(volume > least * (1 - 2e-4) && volume < least * 1.003))
        fail_msg("%s in %dD: %g of %g", what, dimension, volume, least);
    turn_cloud(dimension, 0.4);
    assert_close(hull_of(dimension), volume, 3e-4);
}

/* Radii differ by three, or one is larger than all others together; inner spheres are left out
 * beforehand. */
static void spheres_of_many_sizes_have_one_hull_however_they_are_turned(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        cloud_random(2000, dimension);
        assert_bounded(dimension, "many");
        cloud_random(40, dimension);
        assert_bounded(dimension, "few");
        cloud_random(2000, dimension);
        points.row[17][3] = 0.01;
        assert_bounded(dimension, "a large one among small ones");
        points.count = 0;
        for (int k = 0; k < 1331; k++)
            cloud_add(k % 11, k / 11 % 11, dimension == 3 ? k / 121 : 0, 0.5);
        for (size_t k = 0; k < points.count; k++)
            if (k % 11 > 3 && k / 11 % 11 > 3) points.row[k][0] -= 7, points.row[k][1] *= 0.1;
        assert_bounded(dimension, "a lattice with a part elsewhere");
    }
}

static void a_place_far_from_the_origin_changes_nothing(void **state) {
    (void)state;
    cloud_random(300, 3);
    const double volume = hull_of(3);
    for (size_t k = 0; k < points.count; k++) points.row[k][2] += 1e3;
    assert_close(hull_of(3), volume, 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cube_of_spheres_has_its_volume_however_it_is_turned),
        cmocka_unit_test(a_square_of_discs_has_its_area_however_it_is_turned),
        cmocka_unit_test(spheres_in_a_point_a_line_or_a_plane_have_a_hull),
        cmocka_unit_test(two_spheres_of_unlike_size_have_a_cone_about_them),
        cmocka_unit_test(spheres_of_many_sizes_have_one_hull_however_they_are_turned),
        cmocka_unit_test(a_place_far_from_the_origin_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
