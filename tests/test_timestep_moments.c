/* The stable step with bonds that carry moments: closed forms, and all springs assembled
 * independently. */
#include "timestep_specimen.h"

#include "base/random.h"

static const gn_effects with_moments = all_effects | GN_FX_BOND_MOMENTS;

static void set_beams(specimen *s, double radius) {
    for (size_t c = 0; c < s->bonds.soa.count; c++) s->bonds.beam[c] = radius;
}

/* Spheres that turn against each other across the normal move nothing else: w^2 = 2 k_b/I; along
 * it 2 k_w/I. With R = 2 r the first is 5 k_n/m, against 2 k_n/m of the normal spring; the second
 * 10 k_t/m, which is the most where k_t is 2.5 k_n. */
static void two_spheres_bend_and_twist_against_each_other(void **state) {
    (void)state;
    const double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.2e-3, -1.2e-3, 1.3e-3, 1e-3};
    for (int twists = 0; twists < 2; twists++) {
        specimen *s = make(3, 2, x, with_moments);
        bond(s, 0.1, twists ? 0.4 : 4.0, 0.0);
        set_beams(s, 2e-3);
        double kn = s->bonds.kn[0], kt = s->bonds.kt[0];
        double w2 = 2.0 * s->p.spin[3] * (twists ? kt * 4e-6 / 2.0 : kn * 4e-6 / 4.0);
        gn_step_limit limit = limits_of(s, 1e-10);
        assert_close(limit.sharp, 2.0 / sqrt(w2), 1e-9);
        /* The factor of two is exact for a pair of equals; in the bound shear comes on top of
         * bending, but not of twist. */
        if (twists) assert_close(limit.bound, limit.sharp, 1e-11);
        assert_true(limit.bound <= limit.sharp);
        destroy(s);
    }
}

/* I = m r^2/2: with k_b = k_n R^2/3 and R = 2 r, w^2 = 16/3 k_n/m. */
static void two_discs_bend_against_each_other(void **state) {
    (void)state;
    const double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.2e-3, 1.6e-3, 0.0, 1e-3};
    specimen *s = make(2, 2, x, with_moments);
    bond(s, 0.1, 4.0, 0.0);
    set_beams(s, 2e-3);
    double w2 = 16.0 / 3.0 * s->bonds.kn[0] * inverse_mass(s, 0);
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-9);
    destroy(s);
}

/* A bond that has broken carries no moments. */
static void a_broken_bond_does_not_bend(void **state) {
    (void)state;
    const double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.2e-3, -1.2e-3, 1.3e-3, 1e-3};
    specimen *s = make(3, 2, x, with_moments);
    bond(s, 0.1, 4.0, 0.0);
    set_beams(s, 2e-3);
    double bent = limits_of(s, 1e-10).sharp;
    s->bonds.cause[0] = GN_BROKEN_TENSION;
    s->bonds.length0[0] *= 1.01; /* pressed */
    double w2 = 2.0 * s->bonds.kn[0] * inverse_mass(s, 0);
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-9);
    assert_true(limits_of(s, 1e-10).sharp > bent);
    destroy(s);
}

/* Adds weight (a.u)(a.u) for a row a of a bond's 12 displacements, scaled by M^-1/2. */
static void add_row(const specimen *s, size_t c, const double a[12], double weight, double *k) {
    size_t count = 6 * s->p.soa.count, at[12];
    double scaled[12];
    for (int e = 0; e < 12; e++) {
        size_t p = (size_t)(e < 6 ? s->bonds.i[c] : s->bonds.j[c]);
        at[e] = 6 * p + (size_t)(e % 6);
        double inverse = e % 6 < 3 ? s->p.vel[4 * p + 3] : s->p.spin[4 * p + 3];
        if (s->fixed[p] >> e % 6 & 1) inverse = 0.0;
        scaled[e] = a[e] * sqrt(inverse);
    }
    for (int e = 0; e < 12; e++)
        for (int f = 0; f < 12; f++) k[at[e] * count + at[f]] += weight * scaled[e] * scaled[f];
}

/* All springs of all bonds, along and across their normals, in a dense matrix. */
static double largest_of_all(const specimen *s) {
    size_t count = 6 * s->p.soa.count;
    double *k = calloc(count * count, sizeof *k), *values = calloc(count, sizeof *values),
           *vectors = calloc(count * count, sizeof *vectors);
    for (size_t c = 0; c < s->bonds.soa.count; c++) {
        size_t i = (size_t)s->bonds.i[c], j = (size_t)s->bonds.j[c];
        double e[3][3], distance = separation(s, i, j, e[0]);
        double gap = distance - s->p.pos[4 * i + 3] - s->p.pos[4 * j + 3];
        double ai = s->p.pos[4 * i + 3] + 0.5 * gap, aj = s->p.pos[4 * j + 3] + 0.5 * gap;
        double r2 = s->bonds.beam[c] * s->bonds.beam[c];
        for (int d = 0; d < 3; d++) e[0][d] /= distance;
        const double any[3] = {fabs(e[0][0]) < 0.9, fabs(e[0][0]) >= 0.9, 0.0};
        double size = 0.0;
        for (int d = 0; d < 3; d++)
            e[1][d] = e[0][(d + 1) % 3] * any[(d + 2) % 3] - e[0][(d + 2) % 3] * any[(d + 1) % 3];
        for (int d = 0; d < 3; d++) size += e[1][d] * e[1][d];
        for (int d = 0; d < 3; d++) e[1][d] /= sqrt(size);
        for (int d = 0; d < 3; d++)
            e[2][d] = e[0][(d + 1) % 3] * e[1][(d + 2) % 3] - e[0][(d + 2) % 3] * e[1][(d + 1) % 3];
        for (int t = 0; t < 3; t++) {
            double move[12] = {0}, turn[12] = {0};
            for (int d = 0; d < 3; d++) {
                /* (w x n).e = w.(n x e) */
                double lever =
                    e[0][(d + 1) % 3] * e[t][(d + 2) % 3] - e[0][(d + 2) % 3] * e[t][(d + 1) % 3];
                move[d] = -e[t][d];
                move[6 + d] = e[t][d];
                move[3 + d] = -ai * lever;
                move[9 + d] = -aj * lever;
                turn[3 + d] = -e[t][d];
                turn[9 + d] = e[t][d];
            }
            add_row(s, c, move, t ? s->bonds.kt[c] : s->bonds.kn[c], k);
            add_row(s, c, turn, t ? s->bonds.kn[c] * r2 / 4.0 : s->bonds.kt[c] * r2 / 2.0, k);
        }
    }
    gn_eigen_symmetric((int)count, k, values, vectors);
    double top = values[0];
    free(k);
    free(values);
    free(vectors);
    return top;
}

/* Ten spheres of 0.7 to 1.3 mm, bonded to whatever is near; one is held. */
static specimen *heap(uint64_t seed, double times) {
    double x[40];
    for (size_t i = 0; i < 10; i++) {
        for (size_t d = 0; d < 3; d++) {
            size_t cell[3] = {i % 3, i / 3 % 3, i / 9};
            x[4 * i + d] = 2e-3 * (double)cell[d] + 3e-4 * gn_random_symmetric(seed, 4 * i + d);
        }
        x[4 * i + 3] = 1e-3 + 3e-4 * gn_random_symmetric(seed, 4 * i + 3);
    }
    specimen *s = make(3, 10, x, with_moments);
    bond(s, 0.4, 1.7, 0.0);
    for (size_t c = 0; c < s->bonds.soa.count; c++)
        s->bonds.beam[c] =
            times * fmin(x[4 * (size_t)s->bonds.i[c] + 3], x[4 * (size_t)s->bonds.j[c] + 3]);
    s->fixed[3] = 0x2b;
    return s;
}

static void the_limit_is_that_of_all_springs(void **state) {
    (void)state;
    double least = 1.0;
    for (uint64_t seed = 1; seed < 6; seed++)
        for (double times = 0.3; times < 4.0; times *= 2.0) {
            specimen *s = heap(seed, times);
            double step = 2.0 / sqrt(largest_of_all(s));
            gn_step_limit limit = limits_of(s, 1e-8);
            assert_close(limit.sharp, step, 1e-9);
            assert_true(limit.bound <= step * (1.0 + 1e-12));
            least = fmin(least, limit.bound / step);
            for (double part = 0.71; part < 1.3; part += 0.05) {
                gn_step_verdict v;
                assert_int_equal(
                    gn_step_holds(&s->spectrum, part * step, 1e-6, true, NULL, &v, NULL),
                    GNEISS_OK);
                if (v.holds) assert_true(part < 1.0);
                if (!v.holds) assert_true(part * step > limit.bound && v.limit <= step * 1.0001);
            }
            destroy(s);
        }
    assert_true(least > 0.6); /* a bound of the right size */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_spheres_bend_and_twist_against_each_other),
        cmocka_unit_test(two_discs_bend_against_each_other),
        cmocka_unit_test(a_broken_bond_does_not_bend),
        cmocka_unit_test(the_limit_is_that_of_all_springs),
    };
    return cmocka_run_group_tests_name("timestep_moments", tests, NULL, NULL);
}
