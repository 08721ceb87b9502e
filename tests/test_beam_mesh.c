/* The built-in mesh of a beam, loads that follow time, averages of a body. */
#include "fem_helpers.h"

#include "base/memory.h"

static const gn_structured_beam concrete = {.lower = {0.01, 0.0, 0.02},
                                            .length = 0.34,
                                            .height = 0.1,
                                            .thickness = 0.06,
                                            .span = 0.3,
                                            .notch_width = 0.004,
                                            .notch_depth = 0.02,
                                            .cell = 0.01,
                                            .notch_cells = 2,
                                            .growth = 1.3};

static gn_mesh beam_of(const gn_structured_beam *spec) {
    gn_mesh mesh;
    gneiss_error error = {0};
    if (gn_mesh_beam(spec, &mesh, &error)) fail_msg("%s", error.message);
    return mesh;
}

static gn_structured_beam flat(void) {
    gn_structured_beam spec = concrete;
    spec.thickness = spec.lower[2] = 0.0;
    return spec;
}

static void has_volume(const gn_structured_beam *spec) {
    int dimension = spec->thickness > 0.0 ? 3 : 2;
    gn_fem_spec s = spec_of(dimension, &rock);
    gn_fem_solid *body = body_of(&s, beam_of(spec));
    double thickness = dimension == 3 ? spec->thickness : 1.0;
    double wanted =
        (spec->length * spec->height - spec->notch_width * spec->notch_depth) * thickness;
    assert_true(fabs(body->volume - wanted) < 1e-12 * wanted);
    assert_int_equal(body->unused_nodes, 0);
    assert_int_equal(body->turned_elements, 0);
    body_end(body);
}

static void its_volume_is_that_of_the_beam_less_the_notch(void **state) {
    (void)state;
    for (int parallel = 0; parallel < 2; parallel++) {
        gn_structured_beam solid = concrete, plane = flat();
        solid.parallel = plane.parallel = parallel;
        has_volume(&solid);
        has_volume(&plane);
        plane.notch_depth = 0.0;
        plane.notch_width = 0.0;
        has_volume(&plane);
    }
}

/* Every facet of the boundary is listed once, with the normal outward: the areas of the groups are
 * those of the faces, all area vectors add up to zero, and their products with positions to the
 * volume. */
static void close_it(bool parallel) {
    gn_structured_beam spec = concrete;
    spec.parallel = parallel;
    gn_mesh m = beam_of(&spec);
    double area[16] = {0.0}, sum[3] = {0.0}, volume = 0.0;
    for (size_t t = 0; t < m.triangles.count; t++) {
        const int32_t *n = m.triangles.node + 3 * t;
        double u[3], v[3], a[3], size = 0.0;
        for (int k = 0; k < 3; k++) {
            u[k] = m.node[3 * n[1] + k] - m.node[3 * n[0] + k];
            v[k] = m.node[3 * n[2] + k] - m.node[3 * n[0] + k];
        }
        for (int k = 0; k < 3; k++) {
            a[k] = 0.5 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
            sum[k] += a[k];
            size += a[k] * a[k];
            volume += a[k] * m.node[3 * n[0] + k] / 3.0;
        }
        area[m.triangles.group[t]] += sqrt(size);
    }
    const double wanted[] = {0.1 * 0.06,
                             0.1 * 0.06,
                             (0.34 - 0.004) * 0.06,
                             0.34 * 0.06,
                             0.34 * 0.1 - 0.004 * 0.02,
                             0.34 * 0.1 - 0.004 * 0.02,
                             (2 * 0.02 + 0.004) * 0.06};
    for (int k = 0; k < 7; k++) assert_true(fabs(area[2 + k] - wanted[k]) < 1e-12);
    for (int k = 0; k < 3; k++) assert_true(fabs(sum[k]) < 1e-14);
    assert_true(fabs(volume - (0.34 * 0.1 - 0.004 * 0.02) * 0.06) < 1e-15);
    size_t count = m.triangles.count;
    gneiss_error error = {0};
    assert_int_equal(gn_mesh_boundary(&m, 3, "beam", &error), GNEISS_OK);
    assert_int_equal(m.triangles.count, count);
    gn_mesh_free(&m);
}

static void its_facets_close_it(void **state) {
    (void)state;
    close_it(false);
    close_it(true);
}

/* Returns true if the corners of an element mirrored at x = 4 are those of another. */
static bool mirrors(const gn_mesh *m, size_t e, size_t other) {
    int same = 0;
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < 4; b++) {
            const double *x = m->node + 3 * m->tetrahedra.node[4 * e + (size_t)a],
                         *y = m->node + 3 * m->tetrahedra.node[4 * other + (size_t)b];
            same += x[0] + y[0] == 8.0 && x[1] == y[1] && x[2] == y[2];
        }
    return same == 4;
}

/* Cells of one size give all inner nodes one mass, those at mid-span as well. */
static void parallel_diagonals_are_mirrored_at_mid_span(void **state) {
    (void)state;
    gn_structured_beam spec = {.length = 8.0,
                               .height = 3.0,
                               .thickness = 2.0,
                               .span = 8.0,
                               .cell = 1.0,
                               .growth = 1.2,
                               .parallel = true};
    gn_fem_spec s = spec_of(3, &rock);
    gn_fem_solid *body = body_of(&s, beam_of(&spec));
    const size_t count = body->mesh.tetrahedra.count;
    assert_int_equal(count, 6 * 8 * 3 * 2);
    for (size_t e = 0; e < count; e++) {
        size_t found = 0;
        for (size_t f = 0; f < count; f++) found += mirrors(&body->mesh, e, f);
        assert_int_equal(found, 1);
    }
    for (size_t n = 0; n < body->nodes.soa.count; n++) {
        const double *x = body->nodes.start + 4 * n;
        if (x[0] > 0.0 && x[0] < 8.0 && x[1] > 0.0 && x[1] < 3.0 && x[2] == 1.0)
            assert_near(1.0 / body->nodes.vel[4 * n + 3], rock.density, 1e-9);
    }
    body_end(body);
}

static void expect_nodes(const gn_fem_solid *body, const char *group, size_t count, double x,
                         double y) {
    gn_fem_set set;
    gneiss_error error = {0};
    if (gn_fem_nodes_of_group(body, group, &set, &error)) fail_msg("%s", error.message);
    assert_int_equal(set.count, count);
    for (size_t k = 0; k < count; k++) {
        const double *at = body->nodes.start + 4 * set.node[k];
        if (fabs(at[0] - x) > 1e-15 || fabs(at[1] - y) > 1e-15)
            fail_msg("%s: node at (%.17g, %.17g)", group, at[0], at[1]);
    }
    gn_fem_set_free(&set);
}

static void supports_load_and_mouth_are_where_they_belong(void **state) {
    (void)state;
    gn_structured_beam plane = flat();
    for (int dimension = 2; dimension <= 3; dimension++) {
        gn_fem_spec s = spec_of(dimension, &rock);
        gn_fem_solid *body = body_of(&s, beam_of(dimension == 3 ? &concrete : &plane));
        size_t nodes = dimension == 3 ? 7 : 1;
        expect_nodes(body, "support_left", nodes, 0.03, 0.0);
        expect_nodes(body, "support_right", nodes, 0.33, 0.0);
        expect_nodes(body, "load", nodes, 0.18, 0.1);
        expect_nodes(body, "mouth_left", nodes, 0.178, 0.0);
        expect_nodes(body, "mouth_right", nodes, 0.182, 0.0);
        gn_fem_set set;
        gneiss_error error = {0};
        assert_int_equal(gn_fem_nodes_of_group(body, "supports", &set, &error), GNEISS_OK);
        assert_int_equal(set.count, 2 * nodes);
        gn_fem_set_free(&set);
        body_end(body);
    }
}

static void cells_grow_slowly_from_the_notch_up_to_the_wanted_size(void **state) {
    (void)state;
    gn_structured_beam plane = flat();
    gn_mesh m = beam_of(&plane);
    double last = 0.0, before = 0.0, most = 0.0;
    /* Positions along the upper face. */
    double x[512];
    size_t count = 0;
    for (size_t n = 0; n < m.node_count; n++)
        if (m.node[3 * n + 1] == 0.1) x[count++] = m.node[3 * n];
    assert_true(count > 20);
    for (size_t k = 1; k < count; k++) {
        double size = x[k] - x[k - 1];
        if (before > 0.0) assert_true(fmax(size / before, before / size) < 1.35);
        before = size;
        most = fmax(most, size);
        last = x[k];
        /* The positions are mirrored about mid-span. */
        assert_true(fabs(x[k] + x[count - 1 - k] - 0.36) < 1e-14);
    }
    assert_true(fabs(last - 0.35) < 1e-15);
    assert_true(most <= 0.01 * (1.0 + 1e-9) && most > 0.008);
    gn_mesh_free(&m);
}

static void impossible_beams_are_refused(void **state) {
    (void)state;
    gn_structured_beam spec = concrete;
    gn_mesh mesh;
    gneiss_error error = {0};
    spec.notch_depth = 0.1;
    assert_int_equal(gn_mesh_beam(&spec, &mesh, &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "a notch inside the span and below the height"));
    assert_null(mesh.node);
    spec = concrete;
    spec.cell = 1e-7;
    assert_int_equal(gn_mesh_beam(&spec, &mesh, &error), GNEISS_ERROR_INPUT);
}

/* --- loads and averages --- */

static gn_fem_solid *block(void) {
    gn_fem_spec s = spec_of(3, &rock);
    return body_of(&s, mesh_of((double[]){0.04, 0.02, 0.03}, (int[]){4, 2, 3}, 0.1));
}

static void shares_of_facets_are_their_area_and_those_of_nodes_one(void **state) {
    (void)state;
    gn_fem_solid *body = block();
    gneiss_error error = {0};
    gn_fem_load load[2];
    gn_fem_set set;
    const double lower[3] = {0.04, -1.0, -1.0}, upper[3] = {0.04, 1.0, 1.0};
    assert_int_equal(gn_fem_load_on_facets(body, "x_upper", NULL, NULL, &load[0], &error),
                     GNEISS_OK);
    assert_int_equal(gn_fem_load_on_facets(body, NULL, lower, upper, &load[1], &error), GNEISS_OK);
    assert_int_equal(load[0].count, 12);
    double area = 0.0;
    for (size_t k = 0; k < 12; k++) {
        assert_int_equal(load[0].node[k], load[1].node[k]);
        assert_true(load[0].share[k] == load[1].share[k]);
        area += load[0].share[k];
    }
    assert_true(fabs(area - 0.02 * 0.03) < 1e-17);
    gn_fem_load_free(&load[1]);
    assert_int_equal(gn_fem_nodes_in_box(body, lower, upper, &set, &error), GNEISS_OK);
    assert_int_equal(gn_fem_load_on_nodes(body, &set, &load[1], &error), GNEISS_OK);
    double all = 0.0;
    for (size_t k = 0; k < load[1].count; k++) all += load[1].share[k];
    assert_true(fabs(all - 1.0) < 1e-15);
    /* First both values are given, then another one: the first one no longer has any effect. */
    const double first[2][3] = {{1e6, 0.0, 0.0}, {0.0, 5.0, 0.0}}, then[2][3] = {{2e6}, {0.0}};
    gn_fem_set_loads(body, load, first, 2);
    gn_fem_set_loads(body, load, then, 2);
    double sum[3] = {0.0};
    for (size_t n = 0; n < body->nodes.soa.count; n++)
        for (int k = 0; k < 3; k++) sum[k] += body->nodes.applied[4 * n + k];
    assert_true(fabs(sum[0] - 2e6 * 0.02 * 0.03) < 1e-10 && sum[1] == 0.0 && sum[2] == 0.0);
    const double aside[3] = {9.0, 9.0, 9.0};
    gn_fem_load_free(&load[1]);
    assert_int_equal(gn_fem_load_on_facets(body, NULL, aside, aside, &load[1], &error),
                     GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "found none among the 104 triangles"));
    gn_fem_load_free(&load[0]);
    gn_fem_set_free(&set);
    body_end(body);
}

/* A linear field of displacements has its gradient as the mean. */
static void the_mean_gradient_of_a_linear_field_is_its_own(void **state) {
    (void)state;
    gn_fem_solid *body = block();
    size_t nodes = body->nodes.soa.count;
    double(*weight)[3] = calloc(nodes, sizeof *weight), gradient[9];
    double g[9] = {1e-3, 2e-4, -3e-4, 4e-4, -2e-3, 5e-4, 0.0, -7e-4, 3e-3};
    for (size_t n = 0; n < nodes; n++)
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                body->nodes.pos[4 * n + a] += g[3 * a + b] * body->nodes.start[4 * n + b];
    gn_fem_strain_weights(body, weight);
    gn_fem_mean_gradient(body, (const double(*)[3])weight, gradient);
    for (int k = 0; k < 9; k++) assert_true(fabs(gradient[k] - g[k]) < 1e-15);
    free(weight);
    body_end(body);
}

static void deform(gn_fem_solid *body, double f[3][3]) {
    for (size_t n = 0; n < body->nodes.soa.count; n++)
        for (int a = 0; a < 3; a++) {
            const double *x = body->nodes.start + 4 * n;
            body->nodes.pos[4 * n + a] = f[a][0] * x[0] + f[a][1] * x[1] + f[a][2] * x[2];
        }
}

static void rotation_does_not_stiffen_and_stretch_does(void **state) {
    (void)state;
    gn_fem_solid *body = block();
    double f[3][3], factor;
    rotation((double[]){1.0, 2.0, 3.0}, 1.1, f);
    deform(body, f);
    factor = gn_fem_stiffening(body);
    assert_true(factor >= 1.0 && factor < 1.0 + 1e-12);
    double stretch[3][3] = {{1.05, 0, 0}, {0, 1.0, 0}, {0, 0, 1.0}};
    deform(body, stretch);
    factor = gn_fem_stiffening(body);
    assert_true(factor > 1.05 && factor < 1.12);
    body_end(body);
}

/* The stiffening factor guarantees that a step of bound/factor is stable about the stretched state;
 * the bound of the start alone is not stable for a large stretch. */
static double growth_after(double share, double stretch) {
    gn_fem_material m = rock;
    m.poisson = 0.0;
    gn_fem_spec s = spec_of(2, &m);
    gn_fem_solid *body = body_of(&s, mesh_of((double[]){0.04, 0.01, 0.0}, (int[]){16, 4, 0}, 0.0));
    gneiss_error error = {0};
    gn_fem_set all;
    const double lower[3] = {-1, -1, -1}, upper[3] = {1, 1, 1}, ends[2][2] = {{-1, 0}, {0.04, 1}};
    double f[3][3] = {{stretch, 0, 0}, {0, 1, 0}, {0, 0, 1}}, factor;
    for (int e = 0; e < 2; e++) {
        int32_t motion;
        double low[3] = {ends[e][0], lower[1], lower[2]},
               high[3] = {ends[e][1], upper[1], upper[2]};
        assert_int_equal(gn_fem_nodes_in_box(body, low, high, &all, &error), GNEISS_OK);
        assert_int_equal(gn_fem_prescribe(body, &all, 1u, (double[3]){0.0}, &motion, &error),
                         GNEISS_OK);
        gn_fem_set_free(&all);
    }
    gn_fem_limit limit = fem_limits(body);
    deform(body, f);
    for (size_t n = 0; n < body->nodes.soa.count; n++)
        for (int k = 0; k < 2; k++) /* these displacements are far below the stretch */
            if (body->nodes.slot[n] < 0 || k == 1)
                body->nodes.pos[4 * n + k] += 1e-9 * sin(1.0 + 12.9898 * (double)(2 * n + k));
    factor = gn_fem_stiffening(body);
    double dt = share * (share < 1.0 ? limit.bound / factor : limit.sharp), speed = 0.0;
    gneiss_status status = GNEISS_OK;
    for (int k = 0; k < 4000 && status == GNEISS_OK; k++)
        status = gn_fem_step(body, dt, false, &error);
    for (size_t n = 0; n < body->nodes.soa.count; n++)
        for (int k = 0; k < 2; k++) speed = fmax(speed, fabs(body->nodes.vel[4 * n + k]));
    body_end(body);
    return status == GNEISS_OK ? speed : INFINITY;
}

static void the_limit_divided_by_the_stiffening_is_stable_when_stretched(void **state) {
    (void)state;
    /* A shift of 1e-9 m in a mode of 1e7 rad/s is 1e-2 m/s. */
    assert_true(growth_after(0.99, 1.3) < 0.1);
    assert_true(growth_after(1.0, 1.3) > 1.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(its_volume_is_that_of_the_beam_less_the_notch),
        cmocka_unit_test(its_facets_close_it),
        cmocka_unit_test(parallel_diagonals_are_mirrored_at_mid_span),
        cmocka_unit_test(supports_load_and_mouth_are_where_they_belong),
        cmocka_unit_test(cells_grow_slowly_from_the_notch_up_to_the_wanted_size),
        cmocka_unit_test(impossible_beams_are_refused),
        cmocka_unit_test(shares_of_facets_are_their_area_and_those_of_nodes_one),
        cmocka_unit_test(the_mean_gradient_of_a_linear_field_is_its_own),
        cmocka_unit_test(rotation_does_not_stiffen_and_stretch_does),
        cmocka_unit_test(the_limit_divided_by_the_stiffening_is_stable_when_stretched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
