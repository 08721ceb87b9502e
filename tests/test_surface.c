/* Closed surfaces and boundaries of meshes made by hand. */
#include "mesh_files.h"

static const double pi = 3.14159265358979323846;

static gn_mesh new_mesh(void) {
    return (gn_mesh){.lines.nodes = 2, .triangles.nodes = 3, .tetrahedra.nodes = 4};
}

/* gn_alloc'ed lists that grow by one. */
static int32_t add_node(gn_mesh *m, double x, double y, double z) {
    double *more = gn_alloc_array(m->node_count + 1, 3 * sizeof *more);
    if (m->node) memcpy(more, m->node, 24 * m->node_count);
    gn_free(m->node);
    m->node = more;
    memcpy(more + 3 * m->node_count, ((double[]){x, y, z}), 24);
    return (int32_t)m->node_count++;
}

static void add_element(gn_mesh_elements *e, const int32_t *node, int32_t group) {
    int32_t *nodes = gn_alloc_array(e->count + 1, 4 * e->nodes);
    int32_t *groups = gn_alloc_array(e->count + 1, 4);
    if (e->count) memcpy(nodes, e->node, 4 * e->nodes * e->count);
    if (e->count) memcpy(groups, e->group, 4 * e->count);
    gn_free(e->node);
    gn_free(e->group);
    e->node = nodes;
    e->group = groups;
    memcpy(nodes + e->nodes * e->count, node, 4 * e->nodes);
    groups[e->count++] = group;
}

static void add_triangle(gn_mesh *m, int32_t a, int32_t b, int32_t c) {
    add_element(&m->triangles, (int32_t[]){a, b, c}, 0);
}

/* A cube with normals outward, without its first `missing` triangles. */
static void add_cube(gn_mesh *m, double low, double high, int missing) {
    int32_t first = (int32_t)m->node_count;
    for (int k = 0; k < 8; k++)
        add_node(m, cube_corner(k, 0, low, high), cube_corner(k, 1, low, high),
                 cube_corner(k, 2, low, high));
    for (int t = missing; t < 12; t++)
        add_triangle(m, first + cube_triangle[t][0], first + cube_triangle[t][1],
                     first + cube_triangle[t][2]);
}

static void turn(gn_mesh *m, size_t triangle) {
    int32_t *node = m->triangles.node + 3 * triangle, swap = node[0];
    node[0] = node[1];
    node[1] = swap;
}

/* Six times the volume between a triangle and a point. */
static double six_volumes(const gn_mesh *m, const int32_t *node, const double from[3]) {
    double a[3][3];
    for (int k = 0; k < 3; k++)
        for (int d = 0; d < 3; d++) a[k][d] = m->node[3 * node[k] + d] - from[d];
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
           a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/* Returns the volume of triangles [first, past) by their sense alone. */
static double signed_volume(const gn_mesh *m, size_t first, size_t past) {
    double sum = 0.0;
    for (size_t t = first; t < past; t++)
        sum += six_volumes(m, m->triangles.node + 3 * t, (const double[3]){0}) / 6.0;
    return sum;
}

static double close_surface(gn_mesh *m) {
    double volume = NAN;
    ok(gn_mesh_close_surface(m, "body", &volume, error));
    return volume;
}

static void refuse_surface(gn_mesh *m, const char *message) {
    double volume;
    fails(gn_mesh_close_surface(m, "body", &volume, error), GNEISS_ERROR_INPUT, message);
    gn_mesh_free(m);
}

/* ---- closed surfaces */

static void a_cube_has_its_volume_and_stays_as_it_is(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    add_cube(&m, -1.0, 2.0, 0);
    int32_t before[36];
    memcpy(before, m.triangles.node, sizeof before);
    assert_close(close_surface(&m), 27.0, 1e-14);
    assert_memory_equal(m.triangles.node, before, sizeof before);
    gn_mesh_free(&m);
}

static void inverted_triangles_are_turned(void **state) {
    (void)state;
    for (unsigned pattern = 0; pattern < 4096; pattern += 91) {
        gn_mesh m = new_mesh();
        add_cube(&m, 3.0, 5.0, 0);
        for (size_t t = 0; t < 12; t++)
            if (pattern >> t & 1) turn(&m, t);
        assert_close(close_surface(&m), 8.0, 1e-14);
        for (size_t t = 0; t < 12; t++)
            assert_true(six_volumes(&m, m.triangles.node + 3 * t, (const double[]){4, 4, 4}) > 1.0);
        gn_mesh_free(&m);
    }
}

static void the_volume_far_from_the_origin_is_exact(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    add_cube(&m, 1048576.0, 1048577.0, 0);
    assert_close(close_surface(&m), 1.0, 1e-14);
    gn_mesh_free(&m);
}

static void a_body_in_a_cavity_in_a_body_counts_thrice(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    add_cube(&m, 4.0, 5.0, 0); /* a body in the cavity */
    add_cube(&m, 2.0, 7.0, 0); /* the cavity */
    add_cube(&m, 0.0, 9.0, 0);
    add_cube(&m, 10.0, 12.0, 0); /* a body beside the others */
    for (size_t t = 0; t < 24; t += 5) turn(&m, t);
    assert_close(close_surface(&m), 729.0 - 125.0 + 1.0 + 8.0, 1e-14);
    assert_close(signed_volume(&m, 0, 12), 1.0, 1e-12);
    assert_close(signed_volume(&m, 12, 24), -125.0, 1e-12);
    assert_close(signed_volume(&m, 24, 36), 729.0, 1e-12);
    assert_close(signed_volume(&m, 36, 48), 8.0, 1e-12);
    gn_mesh_free(&m);
}

static void bodies_may_touch_in_a_corner(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    add_cube(&m, 0.0, 1.0, 0);
    add_cube(&m, 1.0, 3.0, 0);
    add_cube(&m, 1.0, 2.0, 0); /* a cavity whose corner is a corner of its body */
    for (size_t k = 0; k < 3 * m.triangles.count; k++) {
        int32_t *node = &m.triangles.node[k];
        if (*node == 8 || *node == 16) *node = 7; /* all three nodes are at (1 1 1) */
    }
    for (int32_t k = 17; k < 24; k++)
        for (int d = 0; d < 3; d++)
            if (m.node[3 * k + d] == 1.0) m.node[3 * k + d] = 1.125; /* off the walls */
    double volume = close_surface(&m);
    double cavity = signed_volume(&m, 24, 36);
    assert_in_range(-cavity * 1000.0, 600, 900);
    assert_close(volume, 1.0 + 8.0 + cavity, 1e-12);
    gn_mesh_free(&m);
}

static void open_surfaces_are_refused_with_an_edge_and_a_count(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    refuse_surface(&m, "body: expected a surface, found no triangles");
    m = new_mesh();
    add_cube(&m, 0.0, 1.0, 2);
    refuse_surface(&m, "body: the edge from (0 0 0) to (1 0 0) belongs to 1 triangle: expected a "
                       "closed surface (two at every edge), found 4 open edges and 0 with more");
    m = new_mesh();
    add_cube(&m, 0.0, 0.5, 0);
    add_triangle(&m, 0, 7, add_node(&m, 2.0, 2.0, 2.0));
    refuse_surface(&m, "found 3 open edges and 0 with more than two");
    m = new_mesh();
    add_cube(&m, 0.0, 0.5, 0);
    add_triangle(&m, 1, 3, 0);
    refuse_surface(
        &m, "from (0 0 0) to (0.5 0.5 0) belongs to 3 triangles: expected a closed surface (two at "
            "every edge), found 0 open edges and 3 with more");
}

/* The projective plane in six nodes: closed, but without an inside. */
static void a_one_sided_surface_is_refused(void **state) {
    (void)state;
    static const int triangle[10][3] = {{1, 2, 5}, {1, 2, 6}, {1, 3, 4}, {1, 3, 6}, {1, 4, 5},
                                        {2, 3, 4}, {2, 3, 5}, {2, 4, 6}, {3, 5, 6}, {4, 5, 6}};
    gn_mesh m = new_mesh();
    for (int k = 0; k < 6; k++) add_node(&m, cos(k), sin(2 * k), k * k);
    for (int t = 0; t < 10; t++)
        add_triangle(&m, triangle[t][0] - 1, triangle[t][1] - 1, triangle[t][2] - 1);
    refuse_surface(&m, "expected a surface with an inside, found a one-sided one");
}

static void surfaces_without_a_volume_are_refused(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    for (int k = 0; k < 3; k++) add_node(&m, k == 1, k == 2, 0.3);
    add_triangle(&m, 0, 1, 2);
    add_triangle(&m, 0, 2, 1);
    refuse_surface(&m, "found one of 2 triangles at (0 0 0.3) that encloses");
    m = new_mesh();
    add_cube(&m, 0.0, 1e200, 0);
    refuse_surface(&m, "expected surfaces that enclose a volume");
}

static void surfaces_that_lie_on_each_other_are_refused(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    add_cube(&m, 0.0, 1.0, 0);
    add_cube(&m, 0.0, 1.0, 0);
    refuse_surface(&m, "found two surfaces that lie on each other");
}

/* ---- boundaries in 3D */

/* Cubes of side 1 beginning at cell (0 0 0), each cut into six tetrahedra along the diagonal (Kuhn
 * 1960), a division that is continuous across cubes; every third tetrahedron has inverted
 * orientation. Nodes on a grid of `side`. */
static gn_mesh cubes(const int (*cell)[3], int count, int side) {
    static const int way[6][2] = {{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}};
    gn_mesh m = new_mesh();
    for (int k = 0; k < side * side * side; k++)
        add_node(&m, k % side, k / side % side, k / side / side);
    const int step[3] = {1, side, side * side};
    for (int c = 0; c < count; c++) {
        int32_t low = cell[c][0] + side * (cell[c][1] + side * cell[c][2]);
        for (int w = 0; w < 6; w++) {
            int32_t a = low + step[way[w][0]], b = a + step[way[w][1]];
            int32_t high = low + step[0] + step[1] + step[2];
            bool even = (way[w][1] - way[w][0] + 3) % 3 == 1;
            bool outward = (6 * c + w) % 3 != 0;
            int32_t node[] = {low, even == outward ? a : b, even == outward ? b : a, high};
            add_element(&m.tetrahedra, node, 1);
        }
    }
    return m;
}

static void the_boundary_of_an_l_shape_is_closed_and_outward(void **state) {
    (void)state;
    static const int cell[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    gn_mesh m = cubes(cell, 3, 3);
    ok(gn_mesh_boundary(&m, 3, "l", error));
    assert_int_equal(m.triangles.count, 2 * (5 + 4 + 5));
    assert_close(signed_volume(&m, 0, m.triangles.count), 3.0, 1e-14);
    assert_close(close_surface(&m), 3.0, 1e-14);
    for (size_t e = 0; e < m.tetrahedra.count; e++) {
        const int32_t *node = m.tetrahedra.node + 4 * e;
        assert_close(six_volumes(&m, node + 1, m.node + 3 * node[0]), 1.0, 1e-14);
    }
    gn_mesh_free(&m);
}

static void the_boundary_around_a_cavity_points_into_it(void **state) {
    (void)state;
    int cell[26][3], count = 0;
    for (int k = 0; k < 27; k++)
        if (k != 13) memcpy(cell[count++], (int[]){k % 3, k / 3 % 3, k / 9}, sizeof *cell);
    gn_mesh m = cubes(cell, 26, 4);
    ok(gn_mesh_boundary(&m, 3, "shell", error));
    assert_int_equal(m.triangles.count, 2 * (54 + 6));
    int32_t before[120 * 3];
    memcpy(before, m.triangles.node, sizeof before);
    assert_close(close_surface(&m), 26.0, 1e-14);
    assert_memory_equal(m.triangles.node, before, sizeof before);
    gn_mesh_free(&m);
}

static void a_boundary_face_keeps_its_groups(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    for (int k = 0; k < 4; k++) add_node(&m, k == 1, k == 2, k == 3);
    add_element(&m.tetrahedra, (int32_t[]){0, 1, 2, 3}, 1);
    add_element(&m.triangles, (int32_t[]){3, 1, 0}, 6);
    add_element(&m.triangles, (int32_t[]){1, 2, 3}, 8);
    m.triangles.also = gn_alloc_array(1, sizeof *m.triangles.also);
    m.triangles.also[m.triangles.also_count++] = (gn_mesh_membership){1, 9};
    ok(gn_mesh_boundary(&m, 3, "one", error));
    assert_int_equal(m.triangles.count, 4);
    for (size_t t = 0; t < 4; t++) {
        const int32_t *node = m.triangles.node + 3 * t;
        int sum = node[0] + node[1] + node[2];
        assert_int_equal(m.triangles.group[t], sum == 4 ? 6 : sum == 6 ? 8 : 0);
        if (sum == 6) assert_int_equal(m.triangles.also[0].element, t);
    }
    assert_int_equal(m.triangles.also_count, 1);
    assert_int_equal(m.triangles.also[0].group, 9);
    gn_mesh_free(&m);
}

static void refuse_boundary(gn_mesh *m, int dimension, const char *message) {
    size_t lines = m->lines.count, triangles = m->triangles.count;
    fails(gn_mesh_boundary(m, dimension, "body", error), GNEISS_ERROR_INPUT, message);
    assert_int_equal(m->lines.count, lines);
    assert_int_equal(m->triangles.count, triangles);
    gn_mesh_free(m);
}

static void tetrahedra_that_do_not_fit_are_refused(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    refuse_boundary(&m, 3, "body: expected a mesh of tetrahedra, found none");
    for (int kind = 0; kind < 3; kind++) {
        m = new_mesh();
        for (int k = 0; k < 4; k++) add_node(&m, k == 1, k == 2, k == 3);
        add_node(&m, 1, 1, kind == 0 ? 0 : kind == 1 ? 2 : -2);
        add_element(&m.tetrahedra, (int32_t[]){0, 1, 2, 3}, 1);
        add_element(&m.tetrahedra, (int32_t[]){0, 1, 2, 4}, 1);
        if (kind == 2) add_element(&m.tetrahedra, (int32_t[]){2, 1, 0, add_node(&m, 0, 0, -1)}, 1);
        refuse_boundary(&m, 3,
                        kind == 0   ? "found tetrahedron number 2 with none at (0 0 0)"
                        : kind == 1 ? "found two elements on the same side at (0 0 0) (0 1 0)"
                                    : "found three elements at (0 1 0) (0 0 0) (1 0 0)");
    }
}

/* ---- boundaries in 2D */

/* A square of 3 x 3 cells without the middle one, two triangles each, every other inside out. */
static gn_mesh frame(double z) {
    gn_mesh m = new_mesh();
    for (int k = 0; k < 16; k++) add_node(&m, k % 4, k / 4, z);
    for (int c = 0; c < 9; c++) {
        if (c == 4) continue;
        int32_t a = c % 3 + 4 * (c / 3);
        add_triangle(&m, a, a + 1, a + 5);
        add_triangle(&m, a, a + 4, a + 5);
    }
    return m;
}

static void the_boundary_around_a_hole_has_the_domain_on_its_left(void **state) {
    (void)state;
    gn_mesh m = frame(0.7);
    add_element(&m.lines, (int32_t[]){0, 4}, 3);  /* an element on the outer side */
    add_element(&m.lines, (int32_t[]){5, 6}, 4);  /* an element on the hole */
    add_element(&m.lines, (int32_t[]){0, 5}, 99); /* an element inside */
    ok(gn_mesh_boundary(&m, 2, "frame", error));
    assert_int_equal(m.lines.count, 12 + 4);
    double area = 0.0;
    int named = 0, leaving[16] = {0};
    for (size_t k = 0; k < m.lines.count; k++) {
        int32_t a = m.lines.node[2 * k], b = m.lines.node[2 * k + 1];
        area += (m.node[3 * a] * m.node[3 * b + 1] - m.node[3 * b] * m.node[3 * a + 1]) / 2.0;
        leaving[a]++;
        leaving[b]--;
        int32_t group = a + b == 4 ? 3 : a + b == 11 && abs(a - b) == 1 ? 4 : 0;
        assert_int_equal(m.lines.group[k], group);
        named += group != 0;
    }
    assert_close(area, 8.0, 1e-14);
    assert_int_equal(named, 2);
    for (int k = 0; k < 16; k++) assert_int_equal(leaving[k], 0);
    gn_mesh_free(&m);
}

static void triangles_that_are_no_plane_mesh_are_refused(void **state) {
    (void)state;
    gn_mesh m = new_mesh();
    refuse_boundary(&m, 2, "expected a mesh of triangles, found none");
    m = frame(0.0);
    m.node[2] = 1e-3;
    refuse_boundary(&m, 2, "two dimensions), found z from 0 to 0.001");
    m = frame(0.0);
    m.node[3] = 2.0;
    refuse_boundary(&m, 2, "found triangle number 3 with none");
    m = frame(0.0);
    add_triangle(&m, 0, 1, 6);
    refuse_boundary(&m, 2, "found two elements on the same side at (0 0 0) (1 0 0)");
}

static void a_plane_turned_in_space_is_a_plane(void **state) {
    (void)state;
    gn_mesh m = frame(0.0);
    for (size_t k = 0; k < m.node_count; k++) {
        double *x = m.node + 3 * k, back[3] = {x[0], x[1], x[2]};
        for (int turned = 0; turned < 7;
             turned++) { /* seven rotations make a turn about the x axis, rounded each time */
            double y = x[1], angle = 2.0 * pi / 7.0;
            x[1] = y * cos(angle) - x[2] * sin(angle);
            x[2] = y * sin(angle) + x[2] * cos(angle);
        }
        assert_true(fabs(x[1] - back[1]) < 1e-14);
    }
    ok(gn_mesh_boundary(&m, 2, "frame", error));
    gn_mesh_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cube_has_its_volume_and_stays_as_it_is),
        cmocka_unit_test(inverted_triangles_are_turned),
        cmocka_unit_test(the_volume_far_from_the_origin_is_exact),
        cmocka_unit_test(a_body_in_a_cavity_in_a_body_counts_thrice),
        cmocka_unit_test(bodies_may_touch_in_a_corner),
        cmocka_unit_test(open_surfaces_are_refused_with_an_edge_and_a_count),
        cmocka_unit_test(a_one_sided_surface_is_refused),
        cmocka_unit_test(surfaces_without_a_volume_are_refused),
        cmocka_unit_test(surfaces_that_lie_on_each_other_are_refused),
        cmocka_unit_test(the_boundary_of_an_l_shape_is_closed_and_outward),
        cmocka_unit_test(the_boundary_around_a_cavity_points_into_it),
        cmocka_unit_test(a_boundary_face_keeps_its_groups),
        cmocka_unit_test(tetrahedra_that_do_not_fit_are_refused),
        cmocka_unit_test(the_boundary_around_a_hole_has_the_domain_on_its_left),
        cmocka_unit_test(triangles_that_are_no_plane_mesh_are_refused),
        cmocka_unit_test(a_plane_turned_in_space_is_a_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
