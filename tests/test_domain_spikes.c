/* Bodies with many sharp and re-entrant edges and corners, compared with brute-force searches. */
#include "test.h"

#include "domain_help.h"

/* A ball with spikes and pits at random, north and south poles at the ends of z. */
static builder spiky_ball(int bands, int sides) {
    builder b = {0};
    add_node(&b, 0, 0, 1);
    add_node(&b, 0, 0, -1);
    for (int i = 1; i < bands; i++)
        for (int j = 0; j < sides; j++) {
            double r = uniform(7, (uint64_t)(i * sides + j), 0.3, 1), polar = M_PI * i / bands;
            double turn = 2 * M_PI * j / sides;
            add_node(&b, r * sin(polar) * cos(turn), r * sin(polar) * sin(turn), r * cos(polar));
        }
    for (int j = 0; j < sides; j++) {
        int next = (j + 1) % sides, last = 2 + (bands - 2) * sides;
        add_triangle(&b, 0, 2 + j, 2 + next);
        add_triangle(&b, 1, last + next, last + j);
        for (int i = 0; i + 2 < bands; i++) {
            int32_t a = 2 + i * sides + j, c = 2 + i * sides + next;
            add_triangle(&b, a, a + sides, c + sides);
            add_triangle(&b, a, c + sides, c);
        }
    }
    return b;
}

static double triple(const double u[3], const double v[3], const double w[3]) {
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* Returns true if x is in the star-shaped body: below the triangle that the ray from the centre
 * intersects. */
static bool inside_star(const gn_mesh *m, const double x[3]) {
    for (size_t t = 0; t < m->triangles.count; t++) {
        const int32_t *n = m->triangles.node + 3 * t;
        const double *a = m->node + 3 * n[0], *b = m->node + 3 * n[1], *c = m->node + 3 * n[2];
        double u = triple(x, b, c), v = triple(a, x, c), w = triple(a, b, x);
        if (u >= 0 && v >= 0 && w >= 0) return u + v + w < triple(a, b, c);
    }
    fail_msg("the ray meets no triangle");
    return false;
}

static void test_sign_holds_at_spikes_and_pits(void **state) {
    (void)state;
    builder b = spiky_ball(12, 16), keep = spiky_ball(12, 16);
    gn_domain *d = surface(&b);
    int inside = 0;
    for (uint64_t i = 0; i < 20000; i++) {
        double x[3];
        for (uint64_t k = 0; k < 3; k++) x[k] = uniform(8, 3 * i + k, -0.8, 0.8);
        bool expected = inside_star(&keep.mesh, x);
        inside += expected;
        if ((gn_domain_depth(d, x) > 0) != expected)
            fail_msg("wrong side at %g %g %g", x[0], x[1], x[2]);
    }
    assert_true(inside > 2000 && inside < 18000);
    drop(&keep);
    gn_domain_free(d);
}

static void test_planes_touch_the_boundary_in_order(void **state) {
    (void)state;
    builder b = spiky_ball(12, 16);
    gn_domain *d = surface(&b);
    gn_domain_plane p[GN_DOMAIN_PLANES];
    int several = 0;
    for (uint64_t i = 0; i < 20000; i++) {
        double x[3], reach = 0.15;
        for (uint64_t k = 0; k < 3; k++) x[k] = uniform(9, 3 * i + k, -0.8, 0.8);
        double depth = gn_domain_depth(d, x);
        int count = gn_domain_planes(d, x, reach, p);
        if (depth < 0)
            assert_int_equal(count, 1);
        else
            assert_true((count > 0) == (depth <= reach));
        several += count > 1;
        for (int j = 0; j < count; j++) {
            double foot[3];
            for (int k = 0; k < 3; k++) foot[k] = x[k] - p[j].depth * p[j].normal[k];
            assert_true(fabs(gn_domain_depth(d, foot)) <= 1e-9);
            assert_true(p[j].depth >= p[j ? j - 1 : 0].depth && p[j].depth <= reach);
        }
        if (count) assert_true(fabs(p[0].depth - depth) <= 1e-12);
    }
    assert_true(several > 500);
    gn_domain_free(d);
}

static double distance(const double a[3], const double b[3]) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* The closest point of triangle t, by trying its plane and then each edge. */
static void closest(const gn_mesh *m, size_t t, const double x[3], double at[3]) {
    const double *p[3];
    double u[3], v[3], w[3], n[3], foot[3], nearest = INFINITY;
    for (int c = 0; c < 3; c++) p[c] = m->node + 3 * m->triangles.node[3 * t + c];
    for (int k = 0; k < 3; k++) u[k] = p[1][k] - p[0][k], v[k] = p[2][k] - p[0][k];
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    double n2 = 0, height = 0;
    for (int k = 0; k < 3; k++) n2 += n[k] * n[k], height += n[k] * (x[k] - p[0][k]);
    for (int k = 0; k < 3; k++) {
        foot[k] = x[k] - height * n[k] / n2;
        u[k] = p[0][k] - foot[k], v[k] = p[1][k] - foot[k], w[k] = p[2][k] - foot[k];
    }
    if (triple(u, v, n) >= 0 && triple(v, w, n) >= 0 && triple(w, u, n) >= 0) {
        memcpy(at, foot, sizeof foot);
        return;
    }
    for (int e = 0; e < 3; e++) {
        const double *a = p[e], *b = p[(e + 1) % 3];
        double along = 0, length2 = 0;
        for (int k = 0; k < 3; k++) {
            along += (x[k] - a[k]) * (b[k] - a[k]);
            length2 += (b[k] - a[k]) * (b[k] - a[k]);
        }
        for (int k = 0; k < 3; k++)
            foot[k] = a[k] + fmin(fmax(along / length2, 0), 1) * (b[k] - a[k]);
        if (distance(foot, x) >= nearest) continue;
        nearest = distance(foot, x);
        memcpy(at, foot, sizeof foot);
    }
}

/* Returns true if the whole line from x to the foot is inside, by samples. */
static bool seen(const gn_domain *d, const double x[3], const double foot[3]) {
    enum { SAMPLES = 2000 };
    for (int i = 0; i < SAMPLES; i++) {
        double y[3], part = i < SAMPLES - 1 ? i / (SAMPLES - 1.0) : 1 - 1e-6;
        for (int k = 0; k < 3; k++) y[k] = x[k] + part * (foot[k] - x[k]);
        if (gn_domain_depth(d, y) <= 0) return false;
    }
    return true;
}

/* Distances of the feet within reach that no triangle through the foot undercuts and that are
 * visible from x. */
static int count_minima(const gn_mesh *m, const gn_domain *d, const double x[3], double reach) {
    static double feet[1024][3], found[64][3];
    size_t triangles = m->triangles.count;
    int count = 0;
    assert_true(triangles <= 1024);
    for (size_t t = 0; t < triangles; t++) closest(m, t, x, feet[t]);
    for (size_t t = 0; t < triangles; t++) {
        bool minimum = distance(feet[t], x) <= reach;
        for (int i = 0; i < count && minimum; i++) minimum = distance(found[i], feet[t]) > 1e-9;
        for (size_t u = 0; u < triangles && minimum; u++) {
            double at[3];
            if (distance(feet[u], x) >= distance(feet[t], x) - 1e-12) continue;
            closest(m, u, feet[t], at);
            minimum = distance(at, feet[t]) > 1e-9;
        }
        if (minimum && seen(d, x, feet[t])) memcpy(found[count++], feet[t], sizeof found[0]);
    }
    return count;
}

static void test_planes_are_all_minima_that_are_seen(void **state) {
    (void)state;
    builder b = spiky_ball(12, 16), keep = spiky_ball(12, 16);
    gn_domain *d = surface(&b);
    gn_domain_plane p[GN_DOMAIN_PLANES];
    for (uint64_t i = 0; i < 1000; i++) {
        double x[3];
        for (uint64_t k = 0; k < 3; k++) x[k] = uniform(23, 3 * i + k, -0.6, 0.6);
        if (gn_domain_depth(d, x) < 0) continue;
        int expected = count_minima(&keep.mesh, d, x, 0.25);
        int count = gn_domain_planes(d, x, 0.25, p);
        if (count != (expected < GN_DOMAIN_PLANES ? expected : GN_DOMAIN_PLANES))
            fail_msg("%d planes for %d minima at %g %g %g", count, expected, x[0], x[1], x[2]);
    }
    drop(&keep);
    gn_domain_free(d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sign_holds_at_spikes_and_pits),
        cmocka_unit_test(test_planes_touch_the_boundary_in_order),
        cmocka_unit_test(test_planes_are_all_minima_that_are_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
