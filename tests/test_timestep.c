/* The stable step: closed forms, Bloch waves on lattices, packings. */
#include "limit/springs.h"
#include "limit/step_limits.h"
#include "timestep_specimen.h"

#include <complex.h>

/* --- closed forms --- */

/* One sphere of radius 1 mm pressed `overlap` into the wall y = 0; v_r = -(v + a w x n). */
static specimen *on_wall(double overlap, const gn_touch_side *side, const double *alpha) {
    static const double normal[4] = {0.0, 1.0, 0.0, 0.0}, point[4] = {0.5, 0.0, 0.1, 0.0};
    double x[4] = {0.0, 1e-3 - overlap, 0.0, 1e-3};
    specimen *s = make(3, 1, x, GN_FX_ROTATION);
    assert_int_equal(
        gn_soa_create(&gn_wall_contact_record, &s->walls, 1, GN_FX_WALLS | GN_FX_WALL_SHEAR, NULL),
        GNEISS_OK);
    s->assembly.wall_contacts = &s->walls;
    s->assembly.wall_normals = normal;
    s->spectrum.wall_point = point;
    s->spectrum.wall_side = side;
    s->spectrum.wall_damping = alpha;
    return s;
}

static void a_particle_on_a_wall_is_one_oscillator(void **state) {
    (void)state;
    const gn_touch_side k = {.stiffness = 3e6, .part = 1.0};
    specimen *s = on_wall(1e-6, &k, NULL);
    gn_step_limit limit = limits_of(s, 1e-10);
    double step = 2.0 / sqrt(3e6 * inverse_mass(s, 0));
    assert_close(limit.sharp, step, 1e-12);
    assert_close(limit.bound, step, 1e-11); /* the wall is immovable: factor 1 */
    assert_close(limit.literature, step, 1e-14);
    assert_close(limit.frequency, 2.0 / step, 1e-12);
    assert_int_equal(limit.springs, 1);
    destroy(s);
}

static void a_tangential_wall_spring_couples_with_rotation(void **state) {
    (void)state;
    const gn_touch_side k = {
        .stiffness = 3e6, .kratio = 1.5, .friction = 0.3, .part = 1.0}; /* k_t = 2e6 */
    specimen *s = on_wall(1e-5, &k, NULL);
    double arm = 1e-3 - 1e-5;
    double w2 = 2e6 * (inverse_mass(s, 0) + arm * arm * s->p.spin[3]);
    gn_step_limit limit = limits_of(s, 1e-10);
    assert_close(limit.sharp, 2.0 / sqrt(w2), 1e-12);
    assert_close(limit.bound, 2.0 / sqrt(w2), 1e-11);
    s->spectrum.arm_factor = 0.0;
    w2 = 2e6 * (inverse_mass(s, 0) + 1e-6 * s->p.spin[3]);
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-12);
    destroy(s);
}

static void a_damped_wall_contact_has_the_known_limit(void **state) {
    (void)state;
    const gn_touch_side k = {.stiffness = 3e6, .part = 1.0};
    const double alpha = 0.6;
    specimen *s = on_wall(1e-6, &k, &alpha);
    double step = 2.0 / sqrt(3e6 * inverse_mass(s, 0)) * (sqrt(1.0 + alpha * alpha) - alpha);
    gn_step_limit limit = limits_of(s, 1e-8);
    assert_close(limit.sharp, step, 1e-10);
    assert_close(limit.bound, step, 1e-11);
    destroy(s);
}

static void a_wall_that_is_not_touched_does_not_count(void **state) {
    (void)state;
    const gn_touch_side k = {
        .stiffness = 3e6, .kratio = 1.5, .friction = 0.3, .part = 1.0}; /* k_t = 2e6 */
    specimen *s = on_wall(-1e-6, &k, NULL);
    gn_step_limit limit = limits_of(s, 1e-8);
    assert_int_equal(limit.springs, 0);
    assert_true(limit.sharp == INFINITY && limit.bound == INFINITY && limit.sharp_low == INFINITY);
    assert_true(limit.literature == INFINITY);
    destroy(s);
}

static void two_particles_swing_with_the_reduced_mass(void **state) {
    (void)state;
    double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.1e-3, 1.2e-3, -0.7e-3, 0.7e-3};
    specimen *s = make(3, 2, x, all_effects);
    bond(s, 0.5, 0.0, 0.0);
    double w2 = s->bonds.kn[0] * (inverse_mass(s, 0) + inverse_mass(s, 1));
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-12);
    destroy(s);
}

/* With u = v_j - v_i and equal spheres the tangential spring sees v_r = u - a (w_i + w_j) x n, a
 * rank-one spring per tangent direction with the inverse mass 2/m + 2 a^2/I: w^2 = k_t/m (2 + 5
 * a^2/r^2). */
static void shear_of_two_spheres_turns_them_along(void **state) {
    (void)state;
    double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.2e-3, -1.2e-3, 1.3e-3, 1e-3};
    specimen *s = make(3, 2, x, all_effects);
    bond(s, 0.1, 2.0, 0.0);
    double arm = 0.5 * s->bonds.length0[0];
    double w2 = s->bonds.kt[0] * inverse_mass(s, 0) * (2.0 + 5.0 * arm * arm / 1e-6);
    assert_true(w2 > 2.0 * s->bonds.kn[0] * inverse_mass(s, 0));
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-12);
    s->spectrum.arm_factor = 0.0;
    w2 = s->bonds.kt[0] * inverse_mass(s, 0) * 7.0;
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-12);
    destroy(s);
}

/* The frequency for discs: I = m r^2/2, w^2 = k_t/m (2 + 4 a^2/r^2). */
static void shear_of_two_discs_turns_them_along(void **state) {
    (void)state;
    double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.2e-3, 1.6e-3, 0.0, 1e-3};
    specimen *s = make(2, 2, x, all_effects);
    bond(s, 0.1, 2.0, 0.0);
    double w2 = s->bonds.kt[0] * inverse_mass(s, 0) * 6.0;
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-9);
    destroy(s);
}

static void a_free_chain_has_its_sine_frequency(void **state) {
    (void)state;
    for (size_t n = 2; n < 60; n += 7) {
        specimen *s = chain(n, 0.0, 0.0, all_effects);
        double w =
            2.0 * sqrt(s->bonds.kn[0] * inverse_mass(s, 0)) * sin(pi * (n - 1.0) / (2.0 * n));
        assert_close(limits_of(s, 1e-8).frequency, w, 1e-10);
        destroy(s);
    }
}

static void a_chain_with_fixed_ends_has_its_sine_frequency(void **state) {
    (void)state;
    for (size_t n = 1; n < 60; n += 7) {
        specimen *s = chain(n + 2, 0.0, 0.0, all_effects);
        s->fixed[0] = s->fixed[n + 1] = 0x3f;
        double w =
            2.0 * sqrt(s->bonds.kn[0] * inverse_mass(s, 0)) * sin(pi * n / (2.0 * (n + 1.0)));
        assert_close(limits_of(s, 1e-8).frequency, w, 1e-10);
        destroy(s);
    }
}

static void fixing_the_direction_of_a_spring_takes_it_away(void **state) {
    (void)state;
    specimen *s = chain(2, 0.0, 0.0, all_effects);
    s->fixed[0] = s->fixed[1] =
        1; /* both x velocities are prescribed, all other components are free */
    gn_step_limit limit = limits_of(s, 1e-8);
    assert_true(limit.sharp == INFINITY && limit.bound == INFINITY);
    assert_int_equal(limit.springs, 1);
    destroy(s);
}

static void a_tiny_particle_sets_the_step(void **state) {
    (void)state;
    double x[12] = {0.0, 0.0, 0.0, 1.0, 1.01, 0.0, 0.0, 0.01, 1.03, 0.0, 0.0, 0.01};
    specimen *s = make(3, 3, x, all_effects);
    s->p.vel[4 + 3] = 1e6 * s->p.vel[3];
    bond(s, 1e-6, 3.7, 0.0);
    s->p.vel[8 + 3] = s->p.vel[3];
    gn_step_limit limit = limits_of(s, 1e-10);
    assert_int_equal(limit.bound_id, 1); /* ids are in reverse order: place 1 of 3 */
    assert_int_equal(limit.sharp_id, 1);
    s->bonds.soa.count = 1; /* the only pair is that of the largest and the smallest particle */
    s->bonds.kt[0] = 0.0;
    double w2 = s->bonds.kn[0] * s->p.vel[3] * (1.0 + 1e6);
    assert_close(limits_of(s, 1e-10).sharp, 2.0 / sqrt(w2), 1e-12);
    destroy(s);
}

/* --- which contacts act --- */

static void contacts_act_by_their_state(void **state) {
    (void)state;
    double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.999e-3, 0.0, 0.0, 1e-3};
    specimen *s = make(3, 2, x, all_effects | GN_FX_FRICTION);
    bond(s, 0.1, 1.0, 0.0);
    double arm = 0.5 * 1.999e-3, kn = s->bonds.kn[0], m = inverse_mass(s, 0);
    double normal = 2.0 / sqrt(2.0 * kn * m);
    double shear = 2.0 / sqrt(kn * m * (2.0 + 5.0 * arm * arm / 1e-6));
    assert_close(limits_of(s, 1e-10).sharp, shear,
                 1e-12); /* an intact bond: k_t acts without friction */
    s->bonds.cause[0] = GN_BROKEN_TENSION;
    assert_true(limits_of(s, 1e-10).sharp == INFINITY); /* a bond broken at zero stretch is open */
    s->bonds.length0[0] = 2e-3;
    assert_close(limits_of(s, 1e-10).sharp, normal, 1e-12); /* a pressed contact without friction */
    s->bonds.mu[0] = 0.3;
    assert_close(limits_of(s, 1e-10).sharp, shear, 1e-12); /* a compressed contact with friction */
    s->p.vel[3] = 0.0;
    assert_int_equal(limits_of(s, 1e-10).springs, 0); /* one particle is removed */
    destroy(s);
}

static void pairs_touch_by_their_radii(void **state) {
    (void)state;
    double x[8] = {0.0, 0.0, 0.0, 1e-3, 1.999e-3, 0.0, 0.0, 1e-3};
    specimen *s = make(3, 2, x, GN_FX_ROTATION | GN_FX_SHEAR | GN_FX_FRICTION);
    bond(s, 0.1, 1.0, 0.0);
    s->assembly.list[1] = s->assembly.list[0];
    s->assembly.list[0] = NULL;
    assert_close(limits_of(s, 1e-10).frequency, sqrt(2.0 * s->bonds.kn[0] * inverse_mass(s, 0)),
                 1e-12);
    s->p.pos[4] = 2.001e-3;
    assert_true(limits_of(s, 1e-10).sharp == INFINITY);
    destroy(s);
}

static void a_position_that_is_not_a_number_is_refused(void **state) {
    (void)state;
    specimen *s = chain(5, 3.7, 0.0, all_effects);
    gn_step_limit limit;
    gneiss_error error = {0};
    s->p.pos[4 * 4] = NAN;
    assert_int_equal(gn_step_limits(&s->spectrum, 1e-4, &limit, &error), GNEISS_ERROR_UNSTABLE);
    assert_non_null(strstr(error.message, "particle 1")); /* places 3 and 4 have ids 1 and 0 */
    destroy(s);
}

/* --- lattices: the largest Bloch frequency over all waves that fit the periodic box --- */

typedef struct lattice {
    const char *name;
    int dimension, atoms, cells, neighbours;
    double cell[3];         /* edges of the rectangular cell, in radii */
    double atom[4][3];      /* centres, in radii */
    double neighbour[6][3]; /* one of each opposite pair, in radii */
} lattice;

#define R2 1.41421356237309504880
#define R3 1.73205080756887729353
static const lattice lattices[] = {
    {"square", 2, 1, 6, 2, {2, 2, 0}, {{0}}, {{2, 0, 0}, {0, 2, 0}}},
    {"hexagonal",
     2,
     2,
     4,
     3,
     {2, 2 * R3, 0},
     {{0}, {1, R3, 0}},
     {{2, 0, 0}, {1, R3, 0}, {-1, R3, 0}}},
    {"cubic", 3, 1, 4, 3, {2, 2, 2}, {{0}}, {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}},
    {"fcc",
     3,
     4,
     4,
     6,
     {2 * R2, 2 * R2, 2 * R2},
     {{0}, {0, R2, R2}, {R2, 0, R2}, {R2, R2, 0}},
     {{0, R2, R2}, {R2, 0, R2}, {R2, R2, 0}, {0, R2, -R2}, {R2, 0, -R2}, {R2, -R2, 0}}},
};

static specimen *lattice_specimen(const lattice *l, double r) {
    int cells[3] = {l->cells, l->cells, l->dimension == 3 ? l->cells : 1};
    double x[4 * 4 * 64];
    size_t count = 0;
    for (int c = 0; c < cells[0] * cells[1] * cells[2]; c++) {
        int at[3] = {c % cells[0], c / cells[0] % cells[1], c / cells[0] / cells[1]};
        for (int a = 0; a < l->atoms; a++, count++) {
            for (int k = 0; k < 3; k++) x[4 * count + k] = r * (at[k] * l->cell[k] + l->atom[a][k]);
            x[4 * count + 3] = r;
        }
    }
    specimen *s = make(l->dimension, count, x, all_effects);
    s->assembly.periodic = true;
    for (int k = 0; k < 3; k++) s->assembly.period[k] = r * cells[k] * l->cell[k];
    return s;
}

/* Velocity of the contact of two unit movements: columns v x y z, w x y z of i and of j. */
static void contact_velocity(const double n[3], double arm, double bi[3][6], double bj[3][6]) {
    for (int k = 0; k < 6; k++) {
        double w[3] = {0.0}, turn[3];
        if (k >= 3) w[k - 3] = arm;
        turn[0] = w[1] * n[2] - w[2] * n[1];
        turn[1] = w[2] * n[0] - w[0] * n[2];
        turn[2] = w[0] * n[1] - w[1] * n[0];
        for (int p = 0; p < 3; p++) {
            bi[p][k] = (p == k ? -1.0 : 0.0) - turn[p];
            bj[p][k] = (p == k ? 1.0 : 0.0) - turn[p];
        }
    }
}

/* Largest eigenvalue of the Bloch matrix of phase angles `q` (per radius): Hermitian, as a real
 * matrix of twice the size. */
static double bloch(const lattice *l, const double q[3], double kn, double kt, double r,
                    const double *inverse) {
    double complex d[6][6] = {{0}};
    for (int c = 0; c < l->neighbours; c++) {
        const double *a = l->neighbour[c];
        double n[3] = {a[0] / 2, a[1] / 2, a[2] / 2}, bi[3][6], bj[3][6];
        double complex phase = cexp(I * (q[0] * a[0] + q[1] * a[1] + q[2] * a[2])), b[3][6],
                       f[3][6];
        contact_velocity(n, r, bi, bj);
        for (int k = 0; k < 6; k++) {
            for (int p = 0; p < 3; p++) b[p][k] = bi[p][k] + phase * bj[p][k];
            double complex along = n[0] * b[0][k] + n[1] * b[1][k] + n[2] * b[2][k];
            for (int p = 0; p < 3; p++) f[p][k] = kt * b[p][k] + (kn - kt) * along * n[p];
        }
        for (int p = 0; p < 6; p++)
            for (int k = 0; k < 6; k++)
                for (int e = 0; e < 3; e++) d[p][k] += conj(b[e][p]) * f[e][k];
    }
    double real[144], values[12], vectors[144];
    for (int p = 0; p < 6; p++)
        for (int k = 0; k < 6; k++) {
            bool out =
                l->dimension == 2 && (p == 2 || p == 3 || p == 4 || k == 2 || k == 3 || k == 4);
            double complex v = out ? 0.0 : d[p][k] * sqrt(inverse[p / 3] * inverse[k / 3]);
            real[12 * p + k] = real[12 * (p + 6) + k + 6] = creal(v);
            real[12 * (p + 6) + k] = cimag(v);
            real[12 * p + k + 6] = -cimag(v);
        }
    gn_eigen_symmetric(12, real, values, vectors);
    return values[0];
}

static void lattices_have_their_bloch_frequency(void **state) {
    (void)state;
    const double kratios[] = {0.0, 3.7, 2.0, 1.0}, r = 1e-3;
    for (size_t k = 0; k < sizeof lattices / sizeof *lattices; k++)
        for (int t = 0; t < 4; t++) {
            const lattice *l = &lattices[k];
            specimen *s = lattice_specimen(l, r);
            bond(s, 0.0, kratios[t], 0.0);
            assert_int_equal(s->bonds.soa.count, s->p.soa.count * (size_t)l->neighbours);
            double kn = s->bonds.kn[0], kt = s->bonds.kt[0], top = 0.0;
            double inverse[2] = {s->p.vel[3], s->p.spin[3]};
            int n = 2 * l->cells; /* cells hold several atoms: twice as many waves, some of them
                                     counted twice */
            for (int c = 0; c < n * n * (l->dimension == 3 ? n : 1); c++) {
                int m[3] = {c % n, c / n % n, c / n / n};
                double q[3] = {0.0};
                for (int a = 0; a < l->dimension; a++)
                    q[a] = 2.0 * pi * m[a] / (l->cells * l->cell[a]);
                top = fmax(top, bloch(l, q, kn, kt, r, inverse));
            }
            gn_step_limit limit = limits_of(s, 1e-7);
            if (fabs(limit.frequency / sqrt(top) - 1.0) > 1e-9)
                fail_msg("%s, kappa %g: w %.12g, Bloch %.12g", l->name, kratios[t], limit.frequency,
                         sqrt(top));
            destroy(s);
        }
}

static void the_bound_is_exact_for_a_cubic_lattice(void **state) {
    (void)state;
    specimen *s = lattice_specimen(&lattices[2], 1e-3);
    bond(s, 0.0, 0.0, 0.0);
    gn_step_limit limit = limits_of(s, 1e-8);
    double step = 1.0 / sqrt(s->bonds.kn[0] * inverse_mass(s, 0)); /* w^2 = 4 k_n/m */
    assert_close(limit.bound, step, 1e-11);
    assert_close(limit.sharp, step, 1e-11);
    destroy(s);
}

/* --- packings --- */

static void the_bound_is_below_the_sharp_limit_in_packings(void **state) {
    (void)state;
    const double alphas[] = {0.0, 0.1, 0.9}, kratios[] = {0.0, 3.7, 1.0, 0.3};
    for (int e = 0; e < 2; e++)
        for (int t = 0; t < 4; t++)
            for (int a = 0; a < 3; a++) {
                specimen *s =
                    rock(0.012, e ? all_effects : all_effects & ~(gn_effects)GN_FX_ROTATION);
                bond(s, 0.05, kratios[t], alphas[a]);
                for (size_t i = 0; i < s->p.soa.count; i += 7) s->fixed[i] = (uint8_t)(i % 64);
                gn_step_limit limit = limits_of(s, 1e-6); /* checks the order of the three */
                assert_true(limit.bound < limit.sharp);
                assert_true(limit.sharp < 2.0 * limit.bound);
                assert_true(limit.sharp_low > 0.999 * limit.sharp);
                destroy(s);
            }
}

static void the_limits_have_the_same_bits_for_any_number_of_threads(void **state) {
    (void)state;
    specimen *s = rock(1.0, all_effects);
    bond(s, 0.05, 3.7, 0.4);
    gn_step_limit limit[5];
    memset(limit, 0, sizeof limit);
    for (int t = 1; t <= 4; t++) {
        s->spectrum.threads = t;
        assert_int_equal(gn_step_limits(&s->spectrum, 1e-5, &limit[t], NULL), GNEISS_OK);
        assert_int_equal(limit[t].iterations, limit[1].iterations);
        assert_int_equal(limit[t].bound_id, limit[1].bound_id);
        assert_int_equal(limit[t].sharp_id, limit[1].sharp_id);
        assert_memory_equal(&limit[t].bound, &limit[1].bound, sizeof(double));
        assert_memory_equal(&limit[t].sharp, &limit[1].sharp, sizeof(double));
        assert_memory_equal(&limit[t].sharp_low, &limit[1].sharp_low, sizeof(double));
        assert_memory_equal(&limit[t].frequency, &limit[1].frequency, sizeof(double));
        assert_memory_equal(&limit[t].literature, &limit[1].literature, sizeof(double));
    }
    destroy(s);
}

/* The limit by those particles alone that could set it; false: these are too many. */
static bool limit_by_few(specimen *s, double tolerance, gn_step_limit *limit) {
    gn_springs springs;
    size_t first = 0;
    bool found;
    while (s->p.id[first] != limit->bound_id) first++;
    assert_int_equal(gn_springs_build(&s->spectrum, NULL, &springs, NULL), GNEISS_OK);
    assert_int_equal(gn_springs_local_limit(&springs, first, tolerance, limit, &found, NULL),
                     GNEISS_OK);
    gn_springs_free(&springs);
    return found;
}

/* The limit of all lies between the two numbers, which are as near as requested. */
static void the_limit_of_a_few_particles_is_that_of_all(void **state) {
    (void)state;
    const double alphas[] = {0.0, 0.4}, kratios[] = {0.0, 3.7};
    for (int k = 0; k < 4; k++) {
        const double tolerance = k % 3 ? 1e-3 : 1e-6;
        specimen *s = rock(1.0, k < 2 ? all_effects : all_effects & ~(gn_effects)GN_FX_ROTATION);
        bond(s, 0.05, kratios[k % 2], alphas[k % 2]);
        for (size_t i = 0; i < s->p.soa.count; i += 70) s->fixed[i] = (uint8_t)(i % 64);
        gn_step_limit all = limits_of(s, 1e-8), few = all, again = all;
        assert_true(limit_by_few(s, tolerance, &few));
        assert_true(few.sharp_low <= all.sharp && all.sharp_low <= few.sharp * (1.0 + 1e-12));
        assert_true(few.sharp <= few.sharp_low * (1.0 + 1.001 * tolerance));
        assert_int_equal(few.sharp_id, all.sharp_id);
        assert_close(few.frequency, all.frequency, tolerance);
        s->spectrum.threads = 3;
        assert_true(limit_by_few(s, tolerance, &again));
        assert_memory_equal(&few.sharp, &again.sharp, sizeof few.sharp);
        assert_memory_equal(&few.sharp_low, &again.sharp_low, sizeof few.sharp_low);
        destroy(s);
    }
}

/* In a lattice every particle could set the limit. */
static void a_lattice_has_no_limit_by_few_particles(void **state) {
    (void)state;
    specimen *s = lattice_specimen(&lattices[3], 1e-3);
    bond(s, 0.0, 3.7, 0.0);
    gn_step_limit all = limits_of(s, 1e-5), few = all;
    assert_false(limit_by_few(s, 1e-3, &few));
    assert_memory_equal(&few, &all, sizeof all);
    destroy(s);
}

/* The case of equal grains that have just begun to touch: blocks are exact, no particle is left to
 * examine. */
static void pairs_that_touch_have_a_limit_by_few(void **state) {
    (void)state;
    specimen *s = lattice_specimen(&lattices[2], 1e-3);
    bond(s, 0.0, 0.0, 0.0);
    for (size_t c = 1; c < s->bonds.soa.count; c++) {
        s->bonds.cause[c] = GN_BROKEN_TENSION;
        s->bonds.length0[c] *= 0.9;
    }
    gn_step_limit all = limits_of(s, 1e-8), few = all;
    assert_true(limit_by_few(s, 1e-3, &few) && few.sharp_low > 0.999 * all.sharp);
    assert_close(few.sharp, all.sharp, 1e-6);
    destroy(s);
}

/* A packing in which part of the contacts are bonds, and unbonded ones with gaps count as near. */
static specimen *rock_with_near_contacts(double alpha, gn_effects effects) {
    specimen *s = rock(0.012, effects);
    bond(s, 0.05, 3.7, alpha);
    for (size_t c = 0; c < s->bonds.soa.count; c += 3) {
        s->bonds.cause[c] = GN_BROKEN_TENSION;
        s->bonds.length0[c] *= 0.98;
    }
    for (size_t i = 0; i < s->p.soa.count; i += 7) s->fixed[i] = (uint8_t)(i % 64);
    return s;
}

/* A step that is said to hold is below the limit with all near contacts active, which Lanczos
 * computes; a refused step is above the limit of blocks alone, and with Lanczos within a few per
 * cent of the limit. */
static void a_step_that_holds_is_below_the_limit_of_all_near_contacts(void **state) {
    (void)state;
    for (int k = 0; k < 6; k++) {
        specimen *s = rock_with_near_contacts(k % 3 * 0.2,
                                              k < 3 ? all_effects | GN_FX_FRICTION : all_effects);
        double open = limits_of(s, 1e-5).sharp;
        s->spectrum.reach = 1e-3;
        gn_step_limit limit = limits_of(s, 1e-5);
        assert_true(limit.sharp < open);
        bool held = true;
        for (double part = 0.1; part < 1.2; part += 0.02) {
            bool holds;
            assert_int_equal(gn_step_holds_by_sums(&s->spectrum, part * limit.sharp, &holds, NULL),
                             GNEISS_OK);
            assert_true(holds ? held && part <= 1.0
                              : part > 0.3); /* the answer is neither always yes nor always no */
            held = holds;
        }
        assert_false(held);
        for (double part = 0.6; part < 1.2; part += 0.02)
            for (int lanczos = 0; lanczos < 2; lanczos++) {
                gn_step_verdict v;
                double step = part * limit.sharp;
                assert_int_equal(
                    gn_step_holds(&s->spectrum, step, lanczos ? 1e-5 : 0.0, true, NULL, &v, NULL),
                    GNEISS_OK);
                if (v.holds) assert_true(step <= limit.sharp);
                if (v.holds) continue;
                assert_true(step > limit.bound && v.limit < step &&
                            v.limit <= 1.0001 * limit.sharp);
                assert_true(v.limit >= 0.9999 * limit.bound);
                if (lanczos) assert_true(v.limit >= 0.9 * limit.sharp);
            }
        destroy(s);
    }
}

/* The limit of a particle and its neighbours alone: marks select them. */
static void a_new_contact_is_found_where_it_is(void **state) {
    (void)state;
    specimen *s = chain(20, 0.0, 0.0, all_effects);
    int32_t before[20], after[20];
    gn_step_contact_hashes(&s->spectrum, before);
    for (int p = 0; p < 20; p++) assert_int_equal(before[p], 0); /* intact bonds do not count */
    s->bonds.cause[7] = GN_BROKEN_TENSION;
    s->bonds.length0[7] *= 1.001; /* broken and in compression */
    gn_step_contact_hashes(&s->spectrum, after);
    for (int p = 0; p < 20; p++) assert_int_equal(after[p] != 0, p == 7 || p == 8);
    double sharp = limits_of(s, 1e-8).sharp;
    for (int near = 0; near < 2; near++) {
        uint8_t changed[20] = {0};
        gn_step_verdict v;
        changed[7] = changed[8] = 1;
        s->bonds.kn[near ? 7 : 15] *=
            4.0; /* the change is found only where something is marked as changed */
        assert_int_equal(gn_step_holds(&s->spectrum, 0.98 * sharp, 0.0, true, changed, &v, NULL),
                         GNEISS_OK);
        assert_int_equal(v.holds, !near);
    }
    destroy(s);
}

/* The diagonal block of each particle at tau, from the velocity of its contacts; the largest of its
 * eigenvalues over 4 tau^2 is 1 at the bound. */
static double largest_block(const specimen *s, double tau) {
    size_t count = s->p.soa.count;
    double *k = calloc(count * 36, sizeof *k), top = 0.0;
    for (size_t c = 0; c < s->bonds.soa.count; c++)
        for (int end = 0; end < 2; end++) {
            size_t i = (size_t)s->bonds.i[c], j = (size_t)s->bonds.j[c], p = end ? j : i;
            double n[3], distance = separation(s, i, j, n), b[2][3][6], m[6];
            double gap = distance - s->p.pos[4 * i + 3] - s->p.pos[4 * j + 3];
            for (int e = 0; e < 3; e++) n[e] /= distance;
            contact_velocity(n, s->p.pos[4 * p + 3] + 0.5 * gap, b[0], b[1]);
            for (int e = 0; e < 6; e++)
                m[e] = sqrt(e < 3 ? s->p.vel[4 * p + 3] : s->p.spin[4 * p + 3]);
            for (int e = 0; e < 6; e++)
                for (int f = 0; f < 6; f++) {
                    double along = 0.0, all = 0.0, normal[2] = {0.0, 0.0};
                    for (int d = 0; d < 3; d++) {
                        all += b[end][d][e] * b[end][d][f];
                        normal[0] += n[d] * b[end][d][e];
                        normal[1] += n[d] * b[end][d][f];
                    }
                    along = normal[0] * normal[1];
                    k[36 * p + 6 * e + f] +=
                        2.0 * m[e] * m[f] *
                        ((s->bonds.kn[c] + 2.0 * tau * s->bonds.cn[c]) * along +
                         s->bonds.kt[c] * (all - along));
                }
        }
    for (size_t p = 0; p < count; p++) {
        double values[6], vectors[36];
        gn_eigen_symmetric(6, k + 36 * p, values, vectors);
        top = fmax(top, values[0]);
    }
    free(k);
    return top;
}

static void the_bound_is_that_of_the_worst_block(void **state) {
    (void)state;
    for (int a = 0; a < 3; a++) {
        specimen *s = rock(0.02, all_effects);
        bond(s, 0.05, 1.5, (double[]){0.0, 0.1, 0.9}[a]);
        double tau = 1.0 / limits_of(s, 1e-4).bound;
        assert_close(largest_block(s, tau), 4.0 * tau * tau, 1e-11);
        destroy(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_on_a_wall_is_one_oscillator),
        cmocka_unit_test(a_tangential_wall_spring_couples_with_rotation),
        cmocka_unit_test(a_damped_wall_contact_has_the_known_limit),
        cmocka_unit_test(a_wall_that_is_not_touched_does_not_count),
        cmocka_unit_test(two_particles_swing_with_the_reduced_mass),
        cmocka_unit_test(shear_of_two_spheres_turns_them_along),
        cmocka_unit_test(shear_of_two_discs_turns_them_along),
        cmocka_unit_test(a_free_chain_has_its_sine_frequency),
        cmocka_unit_test(a_chain_with_fixed_ends_has_its_sine_frequency),
        cmocka_unit_test(fixing_the_direction_of_a_spring_takes_it_away),
        cmocka_unit_test(a_tiny_particle_sets_the_step),
        cmocka_unit_test(contacts_act_by_their_state),
        cmocka_unit_test(pairs_touch_by_their_radii),
        cmocka_unit_test(a_position_that_is_not_a_number_is_refused),
        cmocka_unit_test(lattices_have_their_bloch_frequency),
        cmocka_unit_test(the_bound_is_exact_for_a_cubic_lattice),
        cmocka_unit_test(the_bound_is_below_the_sharp_limit_in_packings),
        cmocka_unit_test(the_limits_have_the_same_bits_for_any_number_of_threads),
        cmocka_unit_test(the_limit_of_a_few_particles_is_that_of_all),
        cmocka_unit_test(a_lattice_has_no_limit_by_few_particles),
        cmocka_unit_test(pairs_that_touch_have_a_limit_by_few),
        cmocka_unit_test(the_bound_is_that_of_the_worst_block),
        cmocka_unit_test(a_step_that_holds_is_below_the_limit_of_all_near_contacts),
        cmocka_unit_test(a_new_contact_is_found_where_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
