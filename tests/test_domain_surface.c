/* The boundary of a body: closed surfaces compared with closed forms and with each other. */
#include "test.h"

#include "domain_help.h"

#include <stdbool.h>

static void assert_surface_refused(builder *b, const char *text) {
    gn_domain *d = NULL;
    assert_int_equal(gn_domain_surface(&b->mesh, 3, "tool.stl", &d, &failure), GNEISS_ERROR_INPUT);
    assert_null(d);
    if (!strstr(failure.message, text) || !strstr(failure.message, "tool.stl"))
        fail_msg("no \"%s\" in \"%s\"", text, failure.message);
    drop(b);
}

enum { MOST = 24 };

/* Cells of a lattice with planes at `at`; the surface of the solid ones. */
typedef struct lattice {
    int cells[3];
    double at[3][MOST + 1];
    bool solid[MOST][MOST][MOST];
} lattice;

static bool is_solid(const lattice *l, const int c[3]) {
    for (int k = 0; k < 3; k++)
        if (c[k] < 0 || c[k] >= l->cells[k]) return false;
    return l->solid[c[0]][c[1]][c[2]];
}

static builder lattice_surface(const lattice *l) {
    static int32_t ids[MOST + 1][MOST + 1][MOST + 1];
    memset(ids, -1, sizeof ids);
    builder b = {0};
    int c[3];
    for (c[0] = 0; c[0] < l->cells[0]; c[0]++)
        for (c[1] = 0; c[1] < l->cells[1]; c[1]++)
            for (c[2] = 0; c[2] < l->cells[2]; c[2]++)
                for (int face = 0; face < 6; face++) {
                    int axis = face / 2, side = face % 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
                    int beside[3] = {c[0], c[1], c[2]};
                    beside[axis] += side ? 1 : -1;
                    if (!is_solid(l, c) || is_solid(l, beside)) continue;
                    int32_t quad[4];
                    for (int q = 0; q < 4; q++) {
                        int n[3] = {c[0], c[1], c[2]};
                        n[axis] += side;
                        n[u] += q == 1 || q == 2;
                        n[v] += q >= 2;
                        int32_t *id = &ids[n[0]][n[1]][n[2]];
                        if (*id < 0)
                            *id = add_node(&b, l->at[0][n[0]], l->at[1][n[1]], l->at[2][n[2]]);
                        quad[q] = *id;
                    }
                    int first = (c[0] + c[1] + c[2]) % 2;
                    for (int t = 0; t < 2; t++) {
                        int32_t i = quad[first], j = quad[(first + 1 + t) % 4];
                        int32_t k = quad[(first + 2 + t) % 4];
                        add_triangle(&b, i, side ? j : k, side ? k : j);
                    }
                }
    return b;
}

/* All cells of the unit cube solid; the planes are denser at the lower end with `power` > 1. */
static lattice *solid_cube(int cells, double power) {
    lattice *l = calloc(1, sizeof *l);
    for (int k = 0; k < 3; k++) {
        l->cells[k] = cells;
        for (int i = 0; i <= cells; i++) l->at[k][i] = pow((double)i / cells, power);
    }
    for (int i = 0; i < cells; i++)
        for (int j = 0; j < cells; j++)
            for (int k = 0; k < cells; k++) l->solid[i][j][k] = true;
    return l;
}

static gn_domain *lattice_domain(lattice *l) {
    builder b = lattice_surface(l);
    free(l);
    return surface(&b);
}

/* Prism of a regular polygon with its caps as fans; axis along z, base at z = 0. */
static builder prism(int sides, double radius, double height) {
    builder b = {0};
    int32_t low = add_node(&b, 0, 0, 0), high = add_node(&b, 0, 0, height);
    for (int i = 0; i < sides; i++) {
        double angle = 2 * M_PI * i / sides, x = radius * cos(angle), y = radius * sin(angle);
        add_node(&b, x, y, 0);
        add_node(&b, x, y, height);
    }
    for (int i = 0; i < sides; i++) {
        int32_t a = 2 + 2 * i, c = 2 + 2 * ((i + 1) % sides);
        add_triangle(&b, low, c, a);
        add_triangle(&b, high, a + 1, c + 1);
        add_triangle(&b, a, c, c + 1);
        add_triangle(&b, a, c + 1, a + 1);
    }
    return b;
}

static void assert_same_as_box(const gn_domain *d, uint64_t points) {
    gn_domain *box;
    gn_domain_plane p[GN_DOMAIN_PLANES], q[GN_DOMAIN_PLANES];
    make_ok(gn_domain_box((double[]){0, 0, 0}, (double[]){1, 1, 1}, &box, &failure));
    assert_close(gn_domain_volume(d), 1, 1e-13);
    for (uint64_t i = 0; i < points; i++) {
        double x[3], reach = uniform(3, 4 * i + 3, 0, 0.6);
        for (uint64_t k = 0; k < 3; k++) x[k] = uniform(3, 4 * i + k, -0.3, 1.3);
        assert_true(fabs(gn_domain_depth(d, x) - gn_domain_depth(box, x)) <= 1e-12);
        int count = gn_domain_planes(box, x, reach, p);
        assert_int_equal(gn_domain_planes(d, x, reach, q), count);
        for (int j = 0; j < count; j++)
            assert_plane(&q[j], p[j].normal[0], p[j].normal[1], p[j].normal[2], p[j].depth);
    }
    gn_domain_free(box);
}

static void test_box_of_twelve_triangles_is_the_box(void **state) {
    (void)state;
    gn_domain *d = lattice_domain(solid_cube(1, 1));
    assert_same_as_box(d, 20000);
    gn_domain_free(d);
}

static void test_finely_and_unevenly_split_box_is_the_box(void **state) {
    (void)state;
    gn_domain *d = lattice_domain(solid_cube(20, 3));
    assert_same_as_box(d, 20000);
    gn_domain_free(d);
}

static void test_split_face_gives_one_plane_over_nodes_and_edges(void **state) {
    (void)state;
    lattice *l = solid_cube(10, 1.7);
    double at[11];
    memcpy(at, l->at[0], sizeof at);
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = lattice_domain(l);
    for (int i = 5; i < 9; i++)
        for (int j = 5; j < 9; j++)
            for (int half = 0; half < 3; half++) {
                double x[3] = {half ? 0.5 * (at[i] + at[i + 1]) : at[i],
                               half == 2 ? 0.5 * (at[j] + at[j + 1]) : at[j], 0.07};
                assert_int_equal(gn_domain_planes(d, x, 0.1, p), 1);
                assert_plane(&p[0], 0, 0, 1, 0.07);
            }
    gn_domain_free(d);
}

static void test_reentrant_edge_gives_one_normal_from_edge_to_centre(void **state) {
    (void)state;
    lattice *l = solid_cube(8, 1);
    for (int i = 4; i < 8; i++)
        for (int j = 4; j < 8; j++)
            for (int k = 0; k < 8; k++) l->solid[i][j][k] = false;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = lattice_domain(l);
    assert_close(gn_domain_volume(d), 0.75, 1e-14);
    const double heights[] = {0.5, 0.55,
                              0.375}; /* points at a node of the edge, and between nodes */
    for (int i = 0; i < 3; i++) {
        double x[3] = {0.5 - 0.06, 0.5 - 0.08, heights[i]};
        assert_close(gn_domain_depth(d, x), 0.1, 1e-13);
        assert_int_equal(gn_domain_planes(d, x, 0.2, p), 1);
        assert_plane(&p[0], -0.6, -0.8, 0, 0.1);
    }
    assert_int_equal(gn_domain_planes(d, (double[]){0.6, 0.45, 0.5}, 0.2, p), 1);
    assert_plane(&p[0], 0, -1, 0, 0.05);
    gn_domain_free(d);
}

static void test_reentrant_corner_gives_one_normal_from_corner_to_centre(void **state) {
    (void)state;
    lattice *l = solid_cube(4, 1);
    for (int i = 2; i < 4; i++)
        for (int j = 2; j < 4; j++)
            for (int k = 2; k < 4; k++) l->solid[i][j][k] = false;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = lattice_domain(l);
    assert_close(gn_domain_volume(d), 0.875, 1e-14);
    assert_int_equal(gn_domain_planes(d, (double[]){0.48, 0.47, 0.44}, 0.1, p), 1);
    assert_plane(&p[0], -2. / 7, -3. / 7, -6. / 7, 0.07);
    assert_int_equal(gn_domain_planes(d, (double[]){0.47, 0.46, 0.7}, 0.1, p), 1);
    assert_plane(&p[0], -0.6, -0.8, 0, 0.05);
    gn_domain_free(d);
}

static void test_cavity_is_outside(void **state) {
    (void)state;
    lattice *l = solid_cube(5, 1);
    l->solid[2][2][2] = false;
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = lattice_domain(l);
    assert_close(gn_domain_volume(d), 1 - 0.008, 1e-14);
    assert_close(gn_domain_depth(d, (double[]){0.5, 0.5, 0.5}), -0.1, 1e-13);
    assert_close(gn_domain_depth(d, (double[]){0.5, 0.5, 0.25}), 0.15, 1e-13);
    assert_int_equal(gn_domain_planes(d, (double[]){0.5, 0.5, 0.25}, 0.3, p), 2);
    assert_plane(&p[0], 0, 0, -1, 0.15);
    assert_plane(&p[1], 0, 0, 1, 0.25);
    assert_int_equal(gn_domain_planes(d, (double[]){0.42, 0.5, 0.5}, 0.3, p), 1);
    assert_plane(&p[0], -1, 0, 0, -0.02);
    gn_domain_free(d);
}

/* A slot of width 0.02 between two lobes joined at the bottom. */
static void test_boundary_behind_a_slot_is_not_seen(void **state) {
    (void)state;
    lattice *l = solid_cube(5, 1);
    const double at[] = {0, 0.4, 0.49, 0.51, 0.6, 1};
    memcpy(l->at[0], at, sizeof at);
    for (int j = 0; j < 5; j++)
        for (int k = 1; k < 5; k++) {
            l->solid[2][j][k] = false;
            l->solid[4][j][k] = false;
        }
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = lattice_domain(l);
    assert_int_equal(gn_domain_planes(d, (double[]){0.45, 0.5, 0.7}, 0.25, p), 1);
    assert_plane(&p[0], -1, 0, 0, 0.04);
    assert_int_equal(gn_domain_planes(d, (double[]){0.55, 0.5, 0.7}, 0.25, p), 2);
    assert_plane(&p[0], 1, 0, 0, 0.04);
    assert_plane(&p[1], -1, 0, 0, 0.05);
    gn_domain_free(d);
}

static void test_hexagonal_prism_has_its_obtuse_edges(void **state) {
    (void)state;
    builder b = prism(6, 1, 2);
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = surface(&b);
    assert_close(gn_domain_volume(d), 3 * sqrt(3), 1e-14);
    assert_int_equal(gn_domain_planes(d, (double[]){0.9, 0, 1}, 0.2, p), 2);
    double angle = (120 + 105) * M_PI / 180;
    double x[3] = {1 + 0.1 * cos(angle), 0.1 * sin(angle), 1};
    assert_int_equal(gn_domain_planes(d, x, 0.2, p), 1);
    assert_plane(&p[0], -sin(M_PI / 3), 0.5, 0, 0.1 * sin(15 * M_PI / 180));
    gn_domain_free(d);
}

static void test_prism_of_many_sides_approaches_the_cylinder(void **state) {
    (void)state;
    gn_domain *cylinder;
    make_ok(gn_domain_cylinder((double[]){0, 0, 0}, 1, 1.5, &cylinder, &failure));
    for (int sides = 16; sides <= 1024; sides *= 4) {
        builder b = prism(sides, 1, 1.5);
        gn_domain *d = surface(&b);
        double sag = 1 - cos(M_PI / sides);
        assert_close(gn_domain_volume(d), 1.5 * 0.5 * sides * sin(2 * M_PI / sides), 1e-13);
        for (uint64_t i = 0; i < 2000; i++) {
            double x[3] = {uniform(5, 3 * i, -1.2, 1.2), uniform(5, 3 * i + 1, -1.2, 1.2),
                           uniform(5, 3 * i + 2, -0.2, 1.7)};
            double gap = gn_domain_depth(cylinder, x) - gn_domain_depth(d, x);
            assert_true(gap >= -1e-14 && gap <= 1.0001 * sag);
        }
        gn_domain_free(d);
    }
    gn_domain_free(cylinder);
}

/* The unit cube, its edge from (0, 0, 0) to (1, 0, 0) split on one side only, at x = 0.4 and z =
 * `off`; the triangle between the split and the whole edge closes the surface. */
static gn_domain *cube_with_needle(double off) {
    builder b = {0};
    for (int i = 0; i < 8; i++) add_node(&b, i & 1, i >> 1 & 1, i >> 2);
    int32_t middle = add_node(&b, 0.4, 0, off);
    const int32_t node[][3] = {{0, 2, 1},      {1, 2, 3},      {0, middle, 4}, {middle, 1, 5},
                               {middle, 5, 4}, {0, 1, middle}, {4, 5, 7},      {4, 7, 6},
                               {2, 6, 7},      {2, 7, 3},      {0, 4, 6},      {0, 6, 2},
                               {1, 3, 7},      {1, 7, 5}};
    for (int i = 0; i < 14; i++) add_triangle(&b, node[i][0], node[i][1], node[i][2]);
    return surface(&b);
}

static void test_triangles_without_area_change_nothing(void **state) {
    (void)state;
    gn_domain *d = cube_with_needle(0);
    assert_same_as_box(d, 20000);
    /* Points in the plane of the bottom, near the edge with the needle. */
    for (int i = 1; i < 10; i++)
        assert_close(gn_domain_depth(d, (double[]){0.1 * i, -0.1, 0}), -0.1, 1e-13);
    gn_domain_free(d);
}

static void test_slivers_turned_over_do_not_turn_the_side(void **state) {
    (void)state;
    gn_domain *box;
    make_ok(gn_domain_box((double[]){0, 0, 0}, (double[]){1, 1, 1}, &box, &failure));
    const double off[] = {1e-9, -1e-9, 3e-14, -3e-14};
    for (int i = 0; i < 4; i++) {
        gn_domain *d = cube_with_needle(off[i]);
        for (uint64_t j = 0; j < 20000; j++) {
            double x[3];
            for (uint64_t k = 0; k < 3; k++) x[k] = uniform(13, 3 * j + k, -0.5, k ? 0.5 : 1);
            assert_true(fabs(gn_domain_depth(d, x) - gn_domain_depth(box, x)) <= 2e-9);
        }
        gn_domain_free(d);
    }
    gn_domain_free(box);
}

/* A unit cube with one side cut in two and a strip of zero width between: two needles. */
static void test_strip_without_width_changes_nothing(void **state) {
    (void)state;
    builder b = {0};
    for (int i = 0; i < 8; i++) add_node(&b, i & 1, i >> 1 & 1, i >> 2);
    int32_t a = add_node(&b, 0.4, 0, 0), c = add_node(&b, 0.6, 0, 0);
    int32_t e = add_node(&b, 0.4, 0, 0), f = add_node(&b, 0.6, 0, 0);
    const int32_t node[][3] = {{0, 2, a}, {a, 2, c}, {c, 2, 3}, {c, 3, 1}, {0, e, 4},
                               {e, f, 4}, {f, 5, 4}, {f, 1, 5}, {0, a, e}, {a, f, e},
                               {a, c, f}, {c, 1, f}, {4, 5, 7}, {4, 7, 6}, {2, 6, 7},
                               {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    b.mesh.node[3 * e + 2] = b.mesh.node[3 * f + 2] = 1e-10;
    for (int i = 0; i < 20; i++) add_triangle(&b, node[i][0], node[i][1], node[i][2]);
    gn_domain *d = surface(&b), *box;
    make_ok(gn_domain_box((double[]){0, 0, 0}, (double[]){1, 1, 1}, &box, &failure));
    for (uint64_t j = 0; j < 20000; j++) {
        double x[3];
        for (uint64_t k = 0; k < 3; k++) x[k] = uniform(17, 3 * j + k, -0.5, k ? 0.5 : 1);
        assert_true(fabs(gn_domain_depth(d, x) - gn_domain_depth(box, x)) <= 2e-10);
    }
    gn_domain_free(d);
    gn_domain_free(box);
}

static void test_parts_that_meet_in_a_point_keep_their_sides(void **state) {
    (void)state;
    lattice *l = solid_cube(2, 1);
    memset(l->solid, 0, sizeof l->solid);
    l->solid[0][0][0] = l->solid[1][1][1] = true;
    gn_domain *d = lattice_domain(l), *low, *high;
    make_ok(gn_domain_box((double[]){0, 0, 0}, (double[]){0.5, 0.5, 0.5}, &low, &failure));
    make_ok(gn_domain_box((double[]){0.5, 0.5, 0.5}, (double[]){1, 1, 1}, &high, &failure));
    for (uint64_t i = 0; i < 5000; i++) {
        double x[3];
        for (uint64_t k = 0; k < 3; k++) x[k] = uniform(11, 3 * i + k, -0.2, 1.2);
        double expected = fmax(gn_domain_depth(low, x), gn_domain_depth(high, x));
        assert_true(fabs(gn_domain_depth(d, x) - expected) <= 1e-12);
    }
    gn_domain_free(d);
    gn_domain_free(low);
    gn_domain_free(high);
}

/* A cube with two cavities, tetrahedra that share one point: above it both are equally near. */
static void test_hollows_that_meet_in_a_point_keep_their_sides(void **state) {
    (void)state;
    lattice *l = solid_cube(1, 1);
    builder b = lattice_surface(l);
    free(l);
    int32_t tip = add_node(&b, 0.5, 0.5, 0.5);
    for (int side = -1; side <= 1; side += 2) {
        int32_t near = add_node(&b, 0.5 + side * 0.1, 0.5, 0.2);
        int32_t left = add_node(&b, 0.5 + side * 0.3, 0.5 - side * 0.2, 0.2);
        int32_t right = add_node(&b, 0.5 + side * 0.3, 0.5 + side * 0.2, 0.2);
        add_triangle(&b, tip, left, near);
        add_triangle(&b, tip, right, left);
        add_triangle(&b, tip, near, right);
        add_triangle(&b, near, left, right);
    }
    gn_domain_plane p[GN_DOMAIN_PLANES];
    gn_domain *d = surface(&b);
    assert_close(gn_domain_volume(d), 1 - 2 * 0.04 * 0.3 / 3, 1e-14);
    assert_close(gn_domain_depth(d, (double[]){0.5, 0.5, 0.6}), 0.1, 1e-13);
    assert_int_equal(gn_domain_planes(d, (double[]){0.5, 0.53, 0.54}, 0.3, p), 1);
    assert_plane(&p[0], 0, 0.6, 0.8, 0.05);
    assert_true(gn_domain_depth(d, (double[]){0.5, 0.5, 0.4}) > 0);
    assert_true(gn_domain_depth(d, (double[]){0.57, 0.5, 0.4}) < 0);
    gn_domain_free(d);
}

static void test_surface_that_cuts_itself_names_both_triangles(void **state) {
    (void)state;
    builder b = prism(6, 1, 2), other = prism(5, 1, 2);
    int32_t first = (int32_t)b.mesh.node_count;
    for (size_t i = 0; i < other.mesh.node_count; i++) {
        const double *x = other.mesh.node + 3 * i;
        add_node(&b, x[0] + 1.5, x[1] + 0.1, x[2] + 0.3);
    }
    for (size_t i = 0; i < other.mesh.triangles.count; i++) {
        const int32_t *n = other.mesh.triangles.node + 3 * i;
        add_triangle(&b, first + n[0], first + n[1], first + n[2]);
    }
    drop(&other);
    assert_surface_refused(&b, "expected a surface that does not cut itself; triangles ");
    int low = 0, high = 0, of = 0;
    double at[3];
    const char *text = strstr(failure.message, "triangles ");
    assert_int_equal(sscanf(text, "triangles %d and %d (of %d) meet at (%lf, %lf, %lf)", &low,
                            &high, &of, &at[0], &at[1], &at[2]),
                     6);
    assert_int_equal(of, 44);
    assert_true(low >= 1 && low <= 24 && high >= 25 && high <= 44);
    assert_true(at[0] >= 0.5 && at[0] <= 1 && at[2] >= 0.3 && at[2] <= 2);
}

static void test_two_bodies_on_one_face_are_refused(void **state) {
    (void)state;
    builder b = {0};
    for (int cube = 0; cube < 2; cube++) {
        lattice *l = solid_cube(1, 1);
        builder one = lattice_surface(l);
        free(l);
        int32_t first = (int32_t)b.mesh.node_count;
        for (size_t i = 0; i < one.mesh.node_count; i++) {
            const double *x = one.mesh.node + 3 * i;
            add_node(&b, x[0] + cube, x[1] + 0.25 * cube, x[2]);
        }
        for (size_t i = 0; i < one.mesh.triangles.count; i++) {
            const int32_t *n = one.mesh.triangles.node + 3 * i;
            add_triangle(&b, first + n[0], first + n[1], first + n[2]);
        }
        drop(&one);
    }
    assert_surface_refused(&b, "does not cut itself");
}

static void test_bad_surfaces_are_refused(void **state) {
    (void)state;
    builder b = prism(6, 1, 2);
    b.mesh.triangles.count--;
    assert_surface_refused(&b, "closed surface");
    b = prism(6, 1, 2);
    int32_t *node = b.mesh.triangles.node, swap = node[0];
    node[0] = node[1], node[1] = swap;
    assert_surface_refused(&b, "turn");
    b = prism(6, 1, 2);
    for (size_t i = 0; i < b.mesh.triangles.count; i++) {
        node = b.mesh.triangles.node + 3 * i;
        swap = node[0], node[0] = node[1], node[1] = swap;
    }
    assert_surface_refused(&b, "outward");
    b = prism(6, 1, 2);
    b.mesh.node[7] = NAN;
    assert_surface_refused(&b, "finite coordinates");
    b = prism(6, 1, 2);
    b.mesh.triangles.node[4] = 14;
    assert_surface_refused(&b, "there are 14 nodes");
    b = prism(6, 1, 2);
    for (size_t i = 0; i < 3 * b.mesh.node_count; i++) b.mesh.node[i] = 3;
    assert_surface_refused(&b, "size");
    b = (builder){0};
    assert_surface_refused(&b, "found 0");
    lattice *l = solid_cube(2, 1);
    memset(l->solid, 0, sizeof l->solid);
    l->solid[0][0][0] = l->solid[1][1][0] = true;
    b = lattice_surface(l);
    free(l);
    assert_surface_refused(&b, "belongs to 4 triangles");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_of_twelve_triangles_is_the_box),
        cmocka_unit_test(test_finely_and_unevenly_split_box_is_the_box),
        cmocka_unit_test(test_split_face_gives_one_plane_over_nodes_and_edges),
        cmocka_unit_test(test_reentrant_edge_gives_one_normal_from_edge_to_centre),
        cmocka_unit_test(test_reentrant_corner_gives_one_normal_from_corner_to_centre),
        cmocka_unit_test(test_cavity_is_outside),
        cmocka_unit_test(test_boundary_behind_a_slot_is_not_seen),
        cmocka_unit_test(test_hexagonal_prism_has_its_obtuse_edges),
        cmocka_unit_test(test_prism_of_many_sides_approaches_the_cylinder),
        cmocka_unit_test(test_triangles_without_area_change_nothing),
        cmocka_unit_test(test_slivers_turned_over_do_not_turn_the_side),
        cmocka_unit_test(test_strip_without_width_changes_nothing),
        cmocka_unit_test(test_parts_that_meet_in_a_point_keep_their_sides),
        cmocka_unit_test(test_hollows_that_meet_in_a_point_keep_their_sides),
        cmocka_unit_test(test_surface_that_cuts_itself_names_both_triangles),
        cmocka_unit_test(test_two_bodies_on_one_face_are_refused),
        cmocka_unit_test(test_bad_surfaces_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
