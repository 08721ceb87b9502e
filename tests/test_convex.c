/* Convex bodies that lie in each other: the depth of the overlap and its derivatives. */
#include "world_helpers.h"

#include "base/memory.h"
#include "surfaces/body_shape.h"
#include "surfaces/convex.h"

/* A box of half sizes, or in the plane a rectangle, about the origin. */
typedef struct shape {
    double pos[600][4];
    int32_t corner[600];
    gn_facet_set set;
    size_t vertices;
    gn_convex convex;
} shape;

static void finish(shape *s) {
    gneiss_error error = {0};
    s->set.corner = s->corner;
    s->set.pos = s->pos[0];
    assert_int_equal(gn_convex_make(&s->set, s->vertices, &s->convex, &error), GNEISS_OK);
}

/* `cut`: along which diagonal faces are cut into triangles, 0 or 1. */
static shape *box_cut(double x, double y, double z, int cut) {
    static const int32_t side[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    shape *s = calloc(1, sizeof *s);
    for (int k = 0; k < 8; k++) {
        s->pos[k][0] = (k & 1 ? x : -x);
        s->pos[k][1] = (k & 2 ? y : -y);
        s->pos[k][2] = (k & 4 ? z : -z);
    }
    for (int k = 0; k < 6; k++) {
        const int32_t *c = side[k];
        const int32_t f[6] = {c[cut], c[1 + cut], c[2 + cut], c[cut], c[2 + cut], c[(3 + cut) % 4]};
        memcpy(s->corner + 6 * k, f, sizeof f);
    }
    s->vertices = 8;
    s->set = (gn_facet_set){.corners = 3, .count = 12};
    finish(s);
    return s;
}

static shape *box(double x, double y, double z) {
    return box_cut(x, y, z, 0);
}

/* A polygon with a number of corners on a circle, oriented by `sense` +-1. */
static shape *disc(int corners, double radius, int sense) {
    shape *s = calloc(1, sizeof *s);
    for (int k = 0; k < corners; k++) {
        s->pos[k][0] = radius * cos(2.0 * pi * k * sense / corners);
        s->pos[k][1] = radius * sin(2.0 * pi * k * sense / corners);
        s->corner[2 * k] = k;
        s->corner[2 * k + 1] = (k + 1) % corners;
    }
    s->vertices = (size_t)corners;
    s->set = (gn_facet_set){.corners = 2, .count = (size_t)corners};
    finish(s);
    return s;
}

static void shape_end(shape *s) {
    gn_convex_free(&s->convex);
    free(s);
}

static gn_convex_pose pose(double x, double y, double z, double u, double v, double w) {
    gn_convex_pose p = {.place = {x, y, z}};
    gn_rotation_matrix((const double[3]){u, v, w}, p.axes);
    return p;
}

static bool meet(const shape *a, const gn_convex_pose *at_a, const shape *b,
                 const gn_convex_pose *at_b, gn_convex_overlap *o) {
    gn_convex_room room;
    gneiss_error error = {0};
    assert_int_equal(gn_convex_room_make(16, 16, &room, &error), GNEISS_OK);
    bool met = gn_convex_meet(&a->convex, at_a, &b->convex, at_b, 1e-12, &room, o);
    gn_convex_room_free(&room);
    return met;
}

/* --- shapes --- */

static void planes_are_found_whatever_the_sense_of_facets(void **state) {
    (void)state;
    shape *b = box(1, 2, 3);
    assert_int_equal(b->convex.planes, 6);
    for (size_t k = 0; k < 6; k++) assert_true(b->convex.plane[4 * k + 3] > 0.9);
    gn_convex_free(&b->convex);
    int32_t other = b->corner[0];
    b->corner[0] = b->corner[1];
    b->corner[1] = other;
    finish(b);
    assert_int_equal(b->convex.planes, 6);
    gn_convex_free(&b->convex);
    b->set.count = 11; /* a hole */
    finish(b);
    assert_int_equal(b->convex.planes, 0);
    b->set.count = 12; /* a dent */
    for (int k = 0; k < 3; k++) b->pos[7][k] *= 0.3;
    finish(b);
    assert_int_equal(b->convex.planes, 0);
    shape_end(b);
    for (int sense = -1; sense <= 1; sense += 2) {
        shape *d = disc(7, 1.0, sense);
        assert_int_equal(d->convex.planes, 7);
        for (size_t k = 0; k < 7; k++) assert_near(d->convex.plane[4 * k + 3], cos(pi / 7), 1e-12);
        shape_end(d);
    }
}

/* A rotated cube of half size 0.01 with a number of facets along each edge, with coordinates of six
 * digits (0) or in single precision as in a file, whose origin is `off` from the cube. */
static shape *from_file(int parts, double off) {
    static const double r[3] = {0.3, -0.7, 0.5};
    shape *s = calloc(1, sizeof *s);
    double m[9];
    gn_rotation_matrix(r, m);
    for (int side = 0; side < 6; side++)
        for (int q = 0; q < 6 * parts * parts; q++) {
            static const int to[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
            int cell = q / 6, axis = side / 2, row = cell / parts;
            double x[3], *at = s->pos[s->vertices];
            x[axis] = side % 2 ? 0.01 : -0.01;
            x[(axis + 1) % 3] = 0.02 * (cell % parts + to[q % 6][0]) / parts - 0.01;
            x[(axis + 2) % 3] = 0.02 * (row + to[q % 6][1]) / parts - 0.01;
            for (int k = 0; k < 3; k++) {
                char digits[32];
                snprintf(digits, sizeof digits, "%.5e", dot3(m + 3 * k, x));
                at[k] = off > 0.0 ? (double)(float)(dot3(m + 3 * k, x) + off) - off
                                  : strtod(digits, NULL);
            }
            s->corner[s->vertices] = (int32_t)s->vertices;
            s->vertices++;
        }
    s->set = (gn_facet_set){.corners = 3, .count = s->vertices / 3};
    finish(s);
    return s;
}

/* They have six planes and the same boundary as a cube; on a slab that rotates with them their
 * overlap is A d, and only a dent larger than rounding is reported. */
static void rounded_vertices_are_convex(void **state) {
    (void)state;
    const double offs[] = {0.0, 0.1, 1.0}, d = 1e-4;
    shape *slab = box(1, 1, 1);
    for (int k = 0; k < 9; k++) {
        shape *s = from_file(1 + k % 3 + (k % 3 == 2), offs[k / 3]);
        gn_convex_overlap o;
        gn_convex_pose p = pose(0, 0, 0, 0.3, -0.7, 0.5), q = pose(0, 0, 0, 0, 0, 0);
        assert_int_equal(s->convex.planes, 6);
        assert_int_equal(s->convex.polygons, 12);
        for (int n = 0; n < 3; n++) q.place[n] = (1.01 - d) * p.axes[3 * n + 2];
        assert_true(meet(slab, &p, s, &q, &o));
        assert_close(o.volume, 4e-4 * d, 0.02);
        assert_close(length3(o.along), 1.0, 0.03);
        gn_convex_free(&s->convex);
        for (size_t v = s->vertices;
             v-- > 0 && k % 3;) /* moves a vertex in the middle of a side inwards */
            if (hypot(hypot(s->pos[v][0] - s->pos[2][0], s->pos[v][1] - s->pos[2][1]),
                      s->pos[v][2] - s->pos[2][2]) == 0.0)
                for (int n = 0; n < 3; n++) s->pos[v][n] *= 0.999;
        finish(s);
        assert_int_equal(s->convex.planes == 0, k % 3 > 0);
        shape_end(s);
    }
    shape_end(slab);
}

static void thin_boxes_are_convex(void **state) {
    (void)state;
    for (int power = 2; power <= 7; power++) {
        shape *s = box(1, 1, pow(10.0, -power));
        assert_int_equal(s->convex.planes, 6);
        shape_end(s);
    }
}

/* --- closed forms --- */

static void two_faces_have_their_distance(void **state) {
    (void)state;
    shape *a = box(1, 2, 3), *b = box(1, 2, 3), *slab = box(9, 9, 1);
    gn_convex_overlap o;
    for (int power = 2; power < 9; power++) {
        double d = pow(10.0, -power);
        gn_convex_pose down = pose(0.3, 0.2, 0, 0, 0, 0), up = pose(0, 0, 4 - d, 0, 0, 0);
        assert_true(meet(slab, &down, a, &up, &o));
        assert_close(o.volume, 8 * d, 1e-6 + 2e-13 / d);
        assert_near(o.depth, d,
                    2 * d * d +
                        2e-13); /* near the sides of the box the sides are nearer than the face */
        assert_near(o.along[2], -1.0, 2 * d);
        assert_near(hypot(o.along[0], o.along[1]), 0.0, 1e-6);
        assert_near(hypot(o.point[0] + 0.3, o.point[1] + 0.2), 0.0, 1e-5);
        assert_near(o.spread[0], 1.0 / 3.0, 4 * d + 1e-6);
        assert_near(o.spread[4], 4.0 / 3.0, 4 * d + 1e-6);
        /* Two equal boxes with their sides in line. */
        down = pose(0, 0, 0, 0, 0, 0);
        up = pose(0, 0, 6 - d, 0, 0, 0);
        assert_true(meet(a, &down, b, &up, &o));
        assert_close(o.volume, 8 * d, 1e-6 + 2e-13 / d);
        assert_near(o.depth, d, 2 * d * d + 2e-13);
        assert_near(o.along[2], -1.0, 3 * d);
    }
    gn_convex_pose down = pose(0, 0, 0, 0, 0, 0), up = pose(0, 0, 6 + 1e-9, 0, 0, 0);
    assert_true(!meet(a, &down, b, &up, &o));
    shape_end(a);
    shape_end(b);
    shape_end(slab);
}

/* Two equal cubes of half size 1, stacked with their sides aligned except for rounding, which
 * decides which sides are farther in. V is 4 d, and W is 4 d^2 minus the region nearer to sides,
 * for each body d^3/6 along each of them: whichever faces of both count, the boundary is closed. */
static void sides_in_line_leave_no_gaps(void **state) {
    (void)state;
    shape *a = box(1, 1, 1), *b = box(1, 1, 1);
    const double d = 1e-5, depth = d - 2.0 * d * d / 3.0;
    uint64_t at = 1;
    double worst[2] = {0, 0};
    for (int k = 0; k < 4000; k++) {
        double size = pow(10.0, uniform(&at, -17, -11)), off[3] = {0, 0, 2.0 - d}, small[3], r[3];
        for (int n = 0; n < 3; n++) {
            off[n] += n < 2 ? size * uniform(&at, -1, 1) : 0.0;
            small[n] = size * uniform(&at, -1, 1);
            r[n] = k % 2 ? uniform(&at, -2, 2) : 0.0;
        }
        gn_convex_pose p = pose(0, 0, 0, r[0], r[1], r[2]), q = p,
                       s = pose(0, 0, 0, small[0], small[1], small[2]);
        for (int n = 0; n < 9; n++) {
            q.axes[n] = 0.0;
            for (int m = 0; m < 3; m++)
                q.axes[n] += p.axes[3 * (n / 3) + m] * s.axes[3 * m + n % 3];
        }
        for (int n = 0; n < 3; n++) q.place[n] = dot3(p.axes + 3 * n, off);
        gn_convex_overlap o;
        assert_true(meet(a, &p, b, &q, &o));
        worst[0] = fmax(worst[0], fabs(o.volume / (4.0 * d) - 1.0));
        worst[1] = fmax(worst[1], fabs(o.depth / depth - 1.0));
    }
    print_message("# off by %.2g of the volume, %.2g of the depth\n", worst[0], worst[1]);
    assert_true(worst[0] < 1e-6 && worst[1] < 1e-6);
    shape_end(a);
    shape_end(b);
}

/* A small box within a large one: all depths are those of its own faces and of the nearest plane;
 * a cube of half size s has a mean depth of s/4. */
static void a_box_within_another_one(void **state) {
    (void)state;
    shape *a = box(9, 9, 9), *b = box(0.5, 0.5, 0.5);
    gn_convex_pose p = pose(0, 0, 0, 0, 0, 0), q = pose(7, 0, 0, 0, 0, 0);
    gn_convex_overlap o;
    for (int turn = 0; turn < 2; turn++) {
        assert_true(turn ? meet(b, &q, a, &p, &o) : meet(a, &p, b, &q, &o));
        assert_close(o.volume, 1.0, 1e-12);
        assert_close(o.depth, 2.0 + 0.125, 1e-12);
        assert_near(o.along[0], turn ? 1.0 : -1.0, 1e-12);
    }
    shape_end(a);
    shape_end(b);
}

/* --- derivatives --- */

static double depth_moved(const shape *a, const gn_convex_pose *at_a, const shape *b,
                          gn_convex_pose at_b, const gn_convex_overlap *o, int way, double step) {
    gn_convex_overlap now = {0};
    double turn[3] = {0}, m[9], old[9], arm[3];
    if (way < 3) {
        at_b.place[way] += step;
    } else {
        turn[way - 3] = step;
        gn_rotation_matrix(turn, m);
        memcpy(old, at_b.axes, sizeof old);
        for (int p = 0; p < 9; p++) {
            at_b.axes[p] = 0.0;
            for (int k = 0; k < 3; k++) at_b.axes[p] += m[3 * (p / 3) + k] * old[3 * k + p % 3];
        }
        for (int k = 0; k < 3; k++) arm[k] = at_b.place[k] - at_a->place[k] - o->point[k];
        for (int k = 0; k < 3; k++)
            at_b.place[k] = at_a->place[k] + o->point[k] + dot3(m + 3 * k, arm);
    }
    return meet(a, at_a, b, &at_b, &now) ? now.depth : 0.0;
}

/* Two bodies in random poses, overlapping by a tenth to a thousandth of their size. */
static void derivatives_are_those_of_the_depth(void **state) {
    (void)state;
    uint64_t at = 1;
    double worst = 0.0, bend = 0.0, turned = 0.0;
    int met = 0;
    for (int k = 0; k < 400; k++) {
        bool plane = k % 4 == 3;
        shape *a = plane ? disc(3 + k % 5, 1.0, 1) : box(1, uniform(&at, 0.3, 2), 1.5);
        shape *b = plane ? disc(4 + k % 3, 0.7, -1) : box(0.5, 0.8, uniform(&at, 0.1, 2));
        double r[9], size = plane ? 0.0 : 1.0;
        for (int n = 0; n < 9; n++) r[n] = uniform(&at, -1, 1);
        gn_convex_pose p = pose(3, 4, 5 * size, size * r[0], size * r[1], r[2]);
        double far = length3(r + 3), low = 0.0, high = 6.0, sink = pow(10.0, -1.0 - k % 3);
        if (plane) far = hypot(r[3], r[4]);
        gn_convex_pose q;
        for (int n = 0; n < 50; n++) {
            double mid = 0.5 * (low + high) / far;
            q = pose(3 + mid * r[3], 4 + mid * r[4], size * (5 + mid * r[5]), size * r[6],
                     size * r[7], r[8]);
            gn_convex_overlap o;
            *(meet(a, &p, b, &q, &o) ? &low : &high) = mid * far;
        }
        double mid = (low - sink) / far;
        q = pose(3 + mid * r[3], 4 + mid * r[4], size * (5 + mid * r[5]), size * r[6], size * r[7],
                 r[8]);
        gn_convex_overlap o;
        if (!meet(a, &p, b, &q, &o)) fail_msg("pair %d does not meet", k);
        met++;
        assert_true(gn_convex_apart(&a->convex, &p, &b->convex, &q) < 0.0);
        for (int way = 0; way < 6; way++) {
            if (plane && (way == 2 || way == 3 || way == 4)) continue;
            double h = 1e-4 * sink, value = way < 3 ? o.along[way] : o.about[way - 3];
            double slope =
                (depth_moved(a, &p, b, q, &o, way, h) - depth_moved(a, &p, b, q, &o, way, -h)) /
                (2.0 * h);
            worst = fmax(worst, fabs(slope - value));
            if (fabs(slope - value) > 1e-5)
                fail_msg("pair %d way %d: %.9g, by differences %.9g", k, way, value, slope);
        }
        for (int way = 0; way < 6;
             way++) { /* Error h^2/2, for the rotations relative to the square of the reach. */
            if (plane && (way == 2 || way == 3 || way == 4)) continue;
            double h = 1e-3 * sink, up = depth_moved(a, &p, b, q, &o, way, h),
                   down = depth_moved(a, &p, b, q, &o, way, -h), reach2 = 0.0, arm2 = 0.0;
            double value = (up * up + down * down - 2.0 * o.depth * o.depth) / (2.0 * h * h);
            for (size_t c = 0; c < b->vertices; c++)
                reach2 = fmax(reach2, dot3(b->pos[c], b->pos[c]));
            for (int n = 0; n < 3; n++) arm2 += pow(q.place[n] - p.place[n] - o.point[n], 2.0);
            if (way < 3)
                bend = fmax(bend, fabs(value));
            else
                turned = fmax(turned, fabs(value) / fmax(reach2, arm2));
        }
        shape_end(a);
        shape_end(b);
    }
    print_message("# %d pairs: %.3g from differences; second derivatives up to %.3g and %.3g\n",
                  met, worst, bend, turned);
    assert_true(bend < 2.0 && turned < 2.0); /* limits of src/boundary/body_pairs.c */
}

/* Rotational friction depends on the spread, which must be the same for the same bodies. */
static void the_spread_does_not_depend_on_how_faces_are_cut(void **state) {
    (void)state;
    shape *floor = box(1.0, 1.0, 0.5),
          *cut[2] = {box_cut(0.5, 0.4, 0.3, 0), box_cut(0.5, 0.4, 0.3, 1)};
    const gn_convex_pose down = pose(0, 0, 0, 0, 0, 0);
    const gn_convex_pose up = pose(0.1, 0.2, 0.79, 0.02, 0.015, 0.4);
    gn_convex_overlap o[2];
    for (int k = 0; k < 2; k++) assert_true(meet(floor, &down, cut[k], &up, &o[k]));
    assert_close(o[1].depth, o[0].depth, 1e-12);
    for (int a = 0; a < 9; a++) assert_near(o[1].spread[a], o[0].spread[a], 1e-12);
    for (int k = 0; k < 2; k++) shape_end(cut[k]);
    shape_end(floor);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planes_are_found_whatever_the_sense_of_facets),
        cmocka_unit_test(rounded_vertices_are_convex),
        cmocka_unit_test(thin_boxes_are_convex),
        cmocka_unit_test(two_faces_have_their_distance),
        cmocka_unit_test(sides_in_line_leave_no_gaps),
        cmocka_unit_test(a_box_within_another_one),
        cmocka_unit_test(derivatives_are_those_of_the_depth),
        cmocka_unit_test(the_spread_does_not_depend_on_how_faces_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
