/* Cutting tools as shapes: closed surfaces whose volumes and areas have closed forms. */
#include "test.h"

#include "mesh/mesh.h"
#include "scene/scene.h"
#include "surfaces/tool_shape.h"

#include <math.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0, pi = 3.14159265358979323846;

typedef struct sizes {
    double volume, area, lowest, highest;
    size_t facets;
} sizes;

/* The volume has the sign of the normals that the maker gave. */
static sizes measure(gn_tool_kind kind, const gn_tool_def *tool) {
    gn_mesh mesh;
    gneiss_error error;
    sizes s = {.lowest = INFINITY, .highest = -INFINITY};
    double closed;
    assert_int_equal(gn_tool_mesh(kind, tool, &mesh, &error), GNEISS_OK);
    for (size_t f = 0; f < mesh.triangles.count; f++) {
        const double *x[3];
        double a[3], b[3], n[3];
        for (size_t c = 0; c < 3; c++) x[c] = mesh.node + 3 * mesh.triangles.node[3 * f + c];
        for (int k = 0; k < 3; k++) {
            a[k] = x[1][k] - x[0][k];
            b[k] = x[2][k] - x[0][k];
        }
        for (int k = 0; k < 3; k++)
            n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        s.area += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int k = 0; k < 3; k++) s.volume += x[0][k] * n[k] / 6.0;
    }
    for (size_t v = 0; v < mesh.node_count; v++) {
        s.lowest = fmin(s.lowest, mesh.node[3 * v + 2]);
        s.highest = fmax(s.highest, mesh.node[3 * v + 2]);
    }
    s.facets = mesh.triangles.count;
    assert_int_equal(gn_mesh_close_surface(&mesh, "tool", &closed, &error), GNEISS_OK);
    assert_true(fabs(closed - s.volume) < 1e-12 * closed);
    gn_mesh_free(&mesh);
    return s;
}

static void close_to(double found, double wanted, double tolerance) {
    if (fabs(found - wanted) > tolerance * fabs(wanted))
        fail_msg("found %.12g, wanted %.12g", found, wanted);
}

/* Volume and area of a polygon (r, y) that turns about y as a prism of n sides. */
static void revolved(const double (*p)[2], int points, int n, double *volume, double *area) {
    *volume = *area = 0.0;
    for (int k = 0; k < points; k++) {
        const double *a = p[k], *b = p[(k + 1) % points];
        const double chords = 2.0 * sin(pi / n) * (a[0] + b[0]);
        *volume += 0.5 * n * sin(2.0 * pi / n) * (b[1] - a[1]) *
                   (a[0] * a[0] + a[0] * b[0] + b[0] * b[0]) / 3.0;
        *area += 0.5 * n * chords * hypot(b[1] - a[1], (b[0] - a[0]) * cos(pi / n));
    }
}

static const gn_tool_def flat = {.diameter = 0.4318,
                                 .tip_width = 0.016,
                                 .bevel_angle = 3.14159265358979323846,
                                 .bore = 0.3,
                                 .facet = 0.004};

static void a_flat_sharp_ring_has_the_volume_and_area_of_its_polygon(void **state) {
    (void)state;
    const double p[4][2] = {{0.15, -0.008}, {0.2159, -0.008}, {0.2159, 0.008}, {0.15, 0.008}};
    const int n = (int)ceil(pi * 0.4318 / 0.004);
    double volume, area;
    revolved(p, 4, n, &volume, &area);
    const sizes s = measure(GN_TOOL_DISC_CUTTER, &flat);
    close_to(s.volume, volume, 1e-12);
    close_to(s.area, area, 1e-12);
    /* The smooth ring: pi (R^2 - r^2) T. The prism has a volume smaller by (2 pi/n)^2/6. */
    close_to(s.volume, pi * (0.2159 * 0.2159 - 0.15 * 0.15) * 0.016, pow(2 * pi / n, 2) / 6);
}

static void a_bevelled_ring_with_flanks_has_the_volume_and_area_of_its_polygon(void **state) {
    (void)state;
    gn_tool_def t = flat;
    t.diameter = 0.4826;
    t.bevel_angle = 120 * degree;
    t.flank_angle = 10 * degree;
    const double top = 0.2413, edge = top - 0.008 / tan(60 * degree),
                 wide = 0.008 + (edge - 0.15) * tan(10 * degree);
    const double p[5][2] = {{0.15, -wide}, {edge, -0.008}, {top, 0.0}, {edge, 0.008}, {0.15, wide}};
    double volume, area;
    revolved(p, 5, (int)ceil(pi * t.diameter / t.facet), &volume, &area);
    const sizes s = measure(GN_TOOL_DISC_CUTTER, &t);
    close_to(s.volume, volume, 1e-12);
    close_to(s.area, area, 1e-12);
}

/* Pappus: a rectangle and a half disc turn about the axis. */
static void a_round_tip_converges_to_the_smooth_ring(void **state) {
    (void)state;
    gn_tool_def t = flat;
    const double r = 0.008, low = 0.15, high = 0.2159 - r;
    const double volume = pi * (high * high - low * low) * 2 * r +
                          2 * pi * (high + 4 * r / (3 * pi)) * 0.5 * pi * r * r;
    const double area = 2 * pi * (high * high - low * low) + 2 * pi * low * 2 * r +
                        2 * pi * (high + 2 * r / pi) * pi * r;
    double off[2][2];
    t.tip_radius = r;
    for (int k = 0; k < 2; k++) {
        t.facet = 1.001 * 0.5 * pi * r / (8 << k); /* 8 and 16 steps around an edge */
        const sizes s = measure(GN_TOOL_DISC_CUTTER, &t);
        off[k][0] = fabs(s.volume / volume - 1.0);
        off[k][1] = fabs(s.area / area - 1.0);
        close_to(s.highest, 0.2159, 1e-3); /* a corner of the polygon is at the top or beside it */
    }
    for (int k = 0; k < 2; k++) {
        assert_true(off[0][k] < 2e-3);
        assert_true(off[0][k] / off[1][k] > 3.5 && off[0][k] / off[1][k] < 4.5);
    }
}

static void rounding_the_ridge_keeps_the_diameter(void **state) {
    (void)state;
    gn_tool_def t = flat;
    t.bevel_angle = 120 * degree;
    t.tip_radius = 0.002;
    const sizes s = measure(GN_TOOL_DISC_CUTTER, &t);
    /* The middle of the rounding is not among the points of its chain: the sagitta of a segment is
     * missing. */
    const double step = 60 * degree / 3;
    assert_true(s.highest <= 0.2159 + 1e-12);
    assert_true(s.highest > 0.2159 - 0.002 * (1 - cos(step)));
}

static void a_finer_facet_is_a_finer_tip(void **state) {
    (void)state;
    gn_tool_def t = flat;
    const size_t coarse = measure(GN_TOOL_DISC_CUTTER, &t).facets;
    t.facet *= 0.5;
    const size_t fine = measure(GN_TOOL_DISC_CUTTER, &t).facets;
    assert_true(fine > 2 * coarse && fine < 4 * coarse); /* flanks grow away from the tip */
}

static void a_chisel_has_the_volume_of_its_outline(void **state) {
    (void)state;
    const gn_tool_def t = {.rake = 15 * degree,
                           .clearance = 8 * degree,
                           .width = 0.01,
                           .height = 0.03,
                           .length = 0.02};
    const double lean = 0.03 * tan(t.rake), rise = 0.02 * tan(t.clearance);
    const double side = 0.03 * 0.02 - 0.5 * 0.02 * rise - 0.5 * 0.03 * lean;
    const double round = (0.03 - rise) + hypot(0.02, rise) + hypot(0.03, lean) + (0.02 - lean);
    const sizes s = measure(GN_TOOL_CHISEL, &t);
    close_to(s.volume, 0.01 * side, 1e-12);
    close_to(s.area, 0.01 * round + 2 * side, 1e-12);
    assert_true(fabs(s.lowest) < 1e-15);
}

/* Rounding the edge by r removes r^2 (cot(h) - (pi/2 - h)), h half of the angle there. */
static void a_rounded_wedge_has_the_volume_of_its_outline(void **state) {
    (void)state;
    gn_tool_def t = {.angle = 60 * degree, .width = 0.01, .height = 0.03, .tip_radius = 0.002};
    const double full = 0.03 * 0.03 * tan(30 * degree), half = 30 * degree;
    const double cut = 4e-6 * (1 / tan(half) - (0.5 * pi - half));
    const sizes s = measure(GN_TOOL_WEDGE, &t);
    /* The arc of 120 degrees has steps of at most 0.3 mm: its segments miss step^2/6 of it. */
    const double missing = 4e-6 * (0.5 * pi - half) * pow(0.3 / 2, 2) / 6;
    assert_true(fabs(s.volume / 0.01 - (full - cut)) < 1.01 * missing);
    assert_true(fabs(s.lowest) < 1e-15);
}

static void a_sharp_pick_has_the_volume_and_area_of_its_polygon(void **state) {
    (void)state;
    const gn_tool_def t = {.angle = 80 * degree, .diameter = 0.02, .height = 0.03, .facet = 0.002};
    const double cone = 0.01 / tan(40 * degree);
    const double p[4][2] = {{0, 0}, {0.01, cone}, {0.01, 0.03}, {0, 0.03}};
    double volume, area;
    revolved(p, 4, (int)ceil(pi * 0.02 / 0.002), &volume, &area);
    const sizes s = measure(GN_TOOL_PICK, &t);
    close_to(s.volume, volume, 1e-12);
    close_to(s.area, area, 1e-12);
    assert_true(fabs(s.lowest) < 1e-15);
    close_to(s.highest, 0.03, 1e-12);
}

/* A spherical cap, a truncated cone and a cylinder. */
static void a_rounded_pick_converges_to_the_smooth_one(void **state) {
    (void)state;
    gn_tool_def t = {.angle = 80 * degree, .diameter = 0.02, .height = 0.03, .tip_radius = 0.004};
    const double half = 40 * degree, r = 0.004, a = r * cos(half), cap = r * (1 - sin(half));
    const double edge = 0.01 / tan(half) - r * (1 / sin(half) - 1);
    const double volume = pi * cap * (3 * a * a + cap * cap) / 6 +
                          pi * (edge - cap) * (a * a + a * 0.01 + 1e-4) / 3 +
                          pi * 1e-4 * (0.03 - edge);
    double off[2];
    for (int k = 0; k < 2; k++) {
        t.facet = 0.0008 / (1 << k);
        off[k] = fabs(measure(GN_TOOL_PICK, &t).volume / volume - 1.0);
    }
    assert_true(off[0] < 5e-3);
    assert_true(off[0] / off[1] > 3.3 && off[0] / off[1] < 4.7);
}

static void refused(gn_tool_kind kind, const gn_tool_def *tool, const char *key) {
    gn_mesh mesh;
    gneiss_error error = {0};
    assert_int_equal(gn_tool_mesh(kind, tool, &mesh, &error), GNEISS_ERROR_INPUT);
    if (strncmp(error.message, key, strlen(key)) != 0) fail_msg("%s", error.message);
}

static void sizes_that_do_not_fit_are_refused_by_their_key(void **state) {
    (void)state;
    gn_tool_def t = flat;
    t.tip_radius = 0.0081;
    refused(GN_TOOL_DISC_CUTTER, &t, "tip_radius: ");
    t = flat;
    t.bore = 0.44;
    refused(GN_TOOL_DISC_CUTTER, &t, "bore: ");
    t = flat;
    t.facet = 1e-9;
    refused(GN_TOOL_DISC_CUTTER, &t, "facet: ");
    t = (gn_tool_def){
        .rake = 80 * degree, .clearance = 12 * degree, .width = 1, .height = 1, .length = 9};
    refused(GN_TOOL_CHISEL, &t, "clearance_angle: ");
    t.rake = 20 * degree;
    refused(GN_TOOL_CHISEL, &t, "height: ");
    t.length = 0.2;
    refused(GN_TOOL_CHISEL, &t, "length: ");
    t = (gn_tool_def){.angle = 80 * degree, .diameter = 0.02, .height = 0.01};
    refused(GN_TOOL_PICK, &t, "height: ");
    t.height = 0.05;
    t.tip_radius = 0.014;
    refused(GN_TOOL_PICK, &t, "tip_radius: ");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_sharp_ring_has_the_volume_and_area_of_its_polygon),
        cmocka_unit_test(a_bevelled_ring_with_flanks_has_the_volume_and_area_of_its_polygon),
        cmocka_unit_test(a_round_tip_converges_to_the_smooth_ring),
        cmocka_unit_test(rounding_the_ridge_keeps_the_diameter),
        cmocka_unit_test(a_finer_facet_is_a_finer_tip),
        cmocka_unit_test(a_chisel_has_the_volume_of_its_outline),
        cmocka_unit_test(a_rounded_wedge_has_the_volume_of_its_outline),
        cmocka_unit_test(a_sharp_pick_has_the_volume_and_area_of_its_polygon),
        cmocka_unit_test(a_rounded_pick_converges_to_the_smooth_one),
        cmocka_unit_test(sizes_that_do_not_fit_are_refused_by_their_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
