/* The boundary of a body: closed forms and polygons. */
#include "test.h"

#include "domain_help.h"

static gn_domain *polygon(const double *corners, size_t count) {
    gn_domain *d = NULL;
    make_ok(gn_domain_polygon(corners, count, &d, &failure));
    return d;
}

/* --- closed forms --- */

static void test_box_depth_and_volume(void **state) {
    (void)state;
    gn_domain *d;
    const double lower[3] = {-1, 0, 2}, upper[3] = {1, 3, 3};
    make_ok(gn_domain_box(lower, upper, &d, &failure));
    assert_int_equal(gn_domain_dimension(d), 3);
    assert_close(gn_domain_volume(d), 6, 1e-15);
    double low[3], high[3];
    gn_domain_bounds(d, low, high);
    for (int k = 0; k < 3; k++) {
        assert_true(low[k] == lower[k]);
        assert_true(high[k] == upper[k]);
    }
    assert_close(gn_domain_depth(d, (double[]){0.25, 1, 2.75}), 0.25, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){0, -0.5, 2.5}), -0.5, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){4, -4, 2.5}), -5, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){3, 5, 4}), -3, 1e-15);
    assert_true(gn_domain_depth(d, (double[]){1, 1, 2.5}) == 0);
    gn_domain_free(d);
}

static void test_box_corner_gives_three_planes_nearest_first(void **state) {
    (void)state;
    gn_domain *d;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    make_ok(gn_domain_box((double[]){0, 0, 0}, (double[]){1, 1, 1}, &d, &failure));
    assert_int_equal(gn_domain_planes(d, (double[]){0.9, 0.05, 0.02}, 0.125, p), 3);
    assert_plane(&p[0], 0, 0, 1, 0.02);
    assert_plane(&p[1], 0, 1, 0, 0.05);
    assert_plane(&p[2], -1, 0, 0, 0.1);
    assert_int_equal(gn_domain_planes(d, (double[]){0.5, 0.5, 0.5}, 0.49, p), 0);
    assert_int_equal(gn_domain_planes(d, (double[]){0.5, 0.5, 0.5}, 0.51, p), 6);
    assert_int_equal(gn_domain_planes(d, (double[]){4, -4, 0.5}, 0.01, p), 1);
    assert_plane(&p[0], -0.6, 0.8, 0, -5);
    gn_domain_free(d);
}

static void test_rectangle_ignores_z(void **state) {
    (void)state;
    gn_domain *d;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    make_ok(gn_domain_rectangle((double[]){0, 0}, (double[]){2, 1}, &d, &failure));
    assert_int_equal(gn_domain_dimension(d), 2);
    assert_close(gn_domain_volume(d), 2, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){1.75, 0.5, 9}), 0.25, 1e-15);
    assert_int_equal(gn_domain_planes(d, (double[]){1.9, 0.2, 9}, 0.3, p), 2);
    assert_plane(&p[0], -1, 0, 0, 0.1);
    assert_plane(&p[1], 0, 1, 0, 0.2);
    gn_domain_free(d);
}

static void test_disc_has_one_tangent_plane(void **state) {
    (void)state;
    gn_domain *d;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    make_ok(gn_domain_disc((double[]){1, 2}, 5, &d, &failure));
    assert_close(gn_domain_volume(d), 25 * M_PI, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){1, 2, 0}), 5, 1e-15);
    assert_int_equal(gn_domain_planes(d, (double[]){1 + 2.4, 2 + 3.2, 0}, 1.5, p), 1);
    assert_plane(&p[0], -0.6, -0.8, 0, 1);
    assert_int_equal(gn_domain_planes(d, (double[]){1 + 2.4, 2 + 3.2, 0}, 0.5, p), 0);
    assert_int_equal(gn_domain_planes(d, (double[]){1 + 6, 2 + 8, 0}, 0.5, p), 1);
    assert_plane(&p[0], -0.6, -0.8, 0, -5);
    gn_domain_free(d);
}

static void test_cylinder_has_ends_and_a_round_side(void **state) {
    (void)state;
    gn_domain *d;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    make_ok(gn_domain_cylinder((double[]){1, 2, 3}, 5, 10, &d, &failure));
    assert_close(gn_domain_volume(d), 250 * M_PI, 1e-15);
    double low[3], high[3];
    gn_domain_bounds(d, low, high);
    assert_true(low[0] == -4 && low[1] == -3 && low[2] == 3);
    assert_true(high[0] == 6 && high[1] == 7 && high[2] == 13);
    assert_close(gn_domain_depth(d, (double[]){1 + 2.4, 2 + 3.2, 8}), 1, 1e-14);
    assert_close(gn_domain_depth(d, (double[]){1, 2, 3.5}), 0.5, 1e-14);
    assert_close(gn_domain_depth(d, (double[]){1, 2, 15}), -2, 1e-14);
    assert_close(gn_domain_depth(d, (double[]){1 + 4.8, 2 + 6.4, -1}), -5, 1e-14);
    assert_int_equal(gn_domain_planes(d, (double[]){1 + 2.4, 2 + 3.2, 12.5}, 1.5, p), 2);
    assert_plane(&p[0], 0, 0, -1, 0.5);
    assert_plane(&p[1], -0.6, -0.8, 0, 1);
    assert_int_equal(gn_domain_planes(d, (double[]){1 + 4.8, 2 + 6.4, -1}, 1, p), 1);
    assert_plane(&p[0], -0.36, -0.48, 0.8, -5);
    gn_domain_free(d);
}

static void test_sizes_that_are_none_are_refused(void **state) {
    (void)state;
    gn_domain *d = NULL;
    const double o[3] = {0, 0, 0}, flat[3] = {1, 0, 1}, odd[3] = {1, NAN, 1};
    assert_int_equal(gn_domain_box(o, flat, &d, &failure), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(failure.message, "0 to 0 m along y"));
    assert_int_equal(gn_domain_box(o, odd, &d, &failure), GNEISS_ERROR_INPUT);
    assert_int_equal(gn_domain_box(o, (double[]){1, 1, INFINITY}, &d, &failure),
                     GNEISS_ERROR_INPUT);
    assert_int_equal(gn_domain_rectangle(flat, o, &d, &failure), GNEISS_ERROR_INPUT);
    assert_int_equal(gn_domain_disc(o, 0, &d, &failure), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(failure.message, "radius"));
    assert_int_equal(gn_domain_disc(odd, 1, &d, &failure), GNEISS_ERROR_INPUT);
    assert_int_equal(gn_domain_cylinder(o, INFINITY, 1, &d, &failure), GNEISS_ERROR_INPUT);
    assert_int_equal(gn_domain_cylinder(o, 1, -1, &d, &failure), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(failure.message, "height"));
    assert_int_equal(gn_domain_cylinder(o, 1, NAN, &d, &failure), GNEISS_ERROR_INPUT);
    assert_null(d);
}

/* Polygons. */

static const double notched[] = {0, 0, 4, 0, 4, 2, 2.5, 2, 2, 1, 1.5, 2, 0, 2};

static void test_polygon_notch_tip_points_at_the_centre(void **state) {
    (void)state;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = polygon(notched, 7);
    assert_close(gn_domain_volume(d), 7.5, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){2, 0.75, 0}), 0.25, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){2, 1.5, 0}), -0.5 / sqrt(5), 1e-14);
    assert_int_equal(gn_domain_planes(d, (double[]){2.06, 0.92, 0}, 0.5, p), 1);
    assert_plane(&p[0], 0.6, -0.8, 0, 0.1);
    /* At a point between the bottom and the tip both planes are found. */
    assert_int_equal(gn_domain_planes(d, (double[]){2, 0.4, 0}, 0.7, p), 2);
    assert_plane(&p[0], 0, 1, 0, 0.4);
    assert_plane(&p[1], 0, -1, 0, 0.6);
    /* A point in the notch, which is outside of the body: the normal points into the nearer
     * flank. */
    assert_int_equal(gn_domain_planes(d, (double[]){2.1, 1.5, 0}, 0.5, p), 1);
    assert_plane(&p[0], 2 / sqrt(5), -1 / sqrt(5), 0, -0.3 / sqrt(5));
    gn_domain_free(d);
}

static void test_polygon_sense_does_not_matter(void **state) {
    (void)state;
    double turned[14];
    for (int i = 0; i < 7; i++) {
        turned[2 * i] = notched[2 * (6 - i)];
        turned[2 * i + 1] = notched[2 * (6 - i) + 1];
    }
    gn_domain *a = polygon(notched, 7), *b = polygon(turned, 7);
    assert_close(gn_domain_volume(a), gn_domain_volume(b), 1e-15);
    for (uint64_t i = 0; i < 500; i++) {
        double x[3] = {uniform(1, 2 * i, -1, 5), uniform(1, 2 * i + 1, -1, 3), 0};
        assert_true(fabs(gn_domain_depth(a, x) - gn_domain_depth(b, x)) <= 1e-14);
    }
    gn_domain_free(a);
    gn_domain_free(b);
}

static void test_obtuse_corner_gives_the_sides_whose_foot_is_on_them(void **state) {
    (void)state;
    double corners[12];
    for (int i = 0; i < 6; i++) {
        corners[2 * i] = cos(i * M_PI / 3);
        corners[2 * i + 1] = sin(i * M_PI / 3);
    }
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = polygon(corners, 6);
    assert_close(gn_domain_volume(d), 1.5 * sqrt(3), 1e-14);
    /* On the bisector of the corner (1, 0) both sides are found, at equal depth. */
    double deep = 0.1 * sin(M_PI / 3);
    assert_int_equal(gn_domain_planes(d, (double[]){0.9, 0, 0}, 0.2, p), 2);
    for (int i = 0; i < 2; i++) {
        assert_close(p[i].depth, deep, 1e-13);
        assert_close(p[i].normal[0], -sin(M_PI / 3), 1e-13);
    }
    assert_true(p[0].normal[1] * p[1].normal[1] < 0);
    /* A point 0.1 from the corner, 105 degrees from the upper side: its foot is beyond the
     * corner. */
    double angle = (120 + 105) * M_PI / 180;
    double x[3] = {1 + 0.1 * cos(angle), 0.1 * sin(angle), 0};
    assert_int_equal(gn_domain_planes(d, x, 0.2, p), 1);
    assert_plane(&p[0], -sin(M_PI / 3), 0.5, 0, 0.1 * sin(15 * M_PI / 180));
    gn_domain_free(d);
}

static void test_corner_on_a_straight_side_is_no_corner(void **state) {
    (void)state;
    const double corners[] = {0, 0, 0.3, 0, 0.7, 0, 1, 0, 1, 1, 0, 1};
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = polygon(corners, 6);
    const double across[] = {0.3, 0.30000000001, 0.5, 0.7};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(gn_domain_planes(d, (double[]){across[i], 0.1, 0}, 0.2, p), 1);
        assert_plane(&p[0], 0, 1, 0, 0.1);
    }
    gn_domain_free(d);
}

static void assert_polygon_refused(const double *corners, size_t count, const char *first,
                                   const char *second) {
    gn_domain *d = NULL;
    assert_int_equal(gn_domain_polygon(corners, count, &d, &failure), GNEISS_ERROR_INPUT);
    assert_null(d);
    if (!strstr(failure.message, first) || !strstr(failure.message, second))
        fail_msg("no \"%s\" and \"%s\" in \"%s\"", first, second, failure.message);
}

static void test_crossing_polygon_names_both_edges(void **state) {
    (void)state;
    const double bow[] = {0, 0, 2, 2, 2, 0, 0, 2};
    assert_polygon_refused(bow, 4, "edge 1 from (0, 0) to (2, 2)", "edge 3 from (2, 0) to (0, 2)");
    assert_non_null(strstr(failure.message, "(1, 1)"));
    const double clockwise[] = {0, 0, 0, 4, 4, 4, 4, 1, -1, 1};
    assert_polygon_refused(clockwise, 5, "edge 1 from", "edge 4 from");
}

static void test_touching_polygon_is_refused(void **state) {
    (void)state;
    const double touch[] = {0, 0, 4, 0, 4, 2, 2, 0, 0, 2};
    assert_polygon_refused(touch, 5, "edge 1 from (0, 0) to (4, 0)", "meet at (2, 0)");
    const double spike[] = {0, 0, 4, 0, 4, 4, 4, 2, 0, 2};
    assert_polygon_refused(spike, 5, "edge 2 from (4, 0) to (4, 4)", "meet at (4, 2)");
    const double twice[] = {0, 0, 1, 0, 1, 0, 1, 1};
    assert_polygon_refused(twice, 4, "edge 2", "coincide at (1, 0");
    const double line[] = {0, 0, 1, 0, 2, 0};
    assert_polygon_refused(line, 3, "edge", "meet at");
    const double odd[] = {0, 0, 1, NAN, 2, 0};
    assert_polygon_refused(odd, 3, "finite", "nan");
    assert_polygon_refused(line, 2, "3 corners", "found 2");
}

static void test_polygon_of_ten_thousand_corners_is_a_disc(void **state) {
    (void)state;
    enum { N = 10000 };
    double *corners = malloc(2 * N * sizeof *corners);
    for (int i = 0; i < N; i++) {
        corners[2 * i] = cos(2 * M_PI * i / N);
        corners[2 * i + 1] = sin(2 * M_PI * i / N);
    }
    gn_domain *d = polygon(corners, N);
    double sag = 1 - cos(M_PI / N);
    for (uint64_t i = 0; i < 1000; i++) {
        double x[3] = {uniform(2, 2 * i, -1.2, 1.2), uniform(2, 2 * i + 1, -1.2, 1.2), 0};
        assert_true(fabs(gn_domain_depth(d, x) - (1 - hypot(x[0], x[1]))) <= 1.001 * sag);
    }
    gn_domain_free(d);
    free(corners);
}

/* Lines of a mesh: a square with a square hole. */
static void test_mesh_lines_may_have_holes(void **state) {
    (void)state;
    double node[] = {0, 0, 5, 4, 0, 5, 4, 4, 5, 0, 4, 5, 1, 1, 5, 1, 3, 5, 3, 3, 5, 3, 1, 5};
    int32_t line[] = {0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4};
    gn_mesh mesh = {.node_count = 8, .node = node, .lines = {.count = 8, .nodes = 2, .node = line}};
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = NULL;
    make_ok(gn_domain_surface(&mesh, 2, "ring", &d, &failure));
    assert_close(gn_domain_volume(d), 12, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){2, 2, 0}), -1, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){2, 0.75, 0}), 0.25, 1e-15);
    assert_close(gn_domain_depth(d, (double[]){7, 8, 0}), -5, 1e-15);
    assert_int_equal(gn_domain_planes(d, (double[]){0.4, 0.2, 0}, 1.0, p), 3);
    assert_plane(&p[0], 0, 1, 0, 0.2);
    assert_plane(&p[1], 1, 0, 0, 0.4);
    assert_plane(&p[2], -0.6, -0.8, 0, 1.0);
    gn_domain_free(d);
    mesh.lines.count = 7;
    d = NULL;
    assert_int_equal(gn_domain_surface(&mesh, 2, "ring", &d, &failure), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(failure.message, "closed loops"));
    assert_null(d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_depth_and_volume),
        cmocka_unit_test(test_box_corner_gives_three_planes_nearest_first),
        cmocka_unit_test(test_rectangle_ignores_z),
        cmocka_unit_test(test_disc_has_one_tangent_plane),
        cmocka_unit_test(test_cylinder_has_ends_and_a_round_side),
        cmocka_unit_test(test_sizes_that_are_none_are_refused),
        cmocka_unit_test(test_polygon_notch_tip_points_at_the_centre),
        cmocka_unit_test(test_polygon_sense_does_not_matter),
        cmocka_unit_test(test_obtuse_corner_gives_the_sides_whose_foot_is_on_them),
        cmocka_unit_test(test_corner_on_a_straight_side_is_no_corner),
        cmocka_unit_test(test_crossing_polygon_names_both_edges),
        cmocka_unit_test(test_touching_polygon_is_refused),
        cmocka_unit_test(test_polygon_of_ten_thousand_corners_is_a_disc),
        cmocka_unit_test(test_mesh_lines_may_have_holes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
