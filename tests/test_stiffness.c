/* Elastic constants of packings without a time step (static/network.h, measure/stiffness.h): closed
 * forms of lattices and of isotropic packings, bounds, threads. */
#include "world_helpers.h"

#include "base/eigen.h"
#include "kernels/law.h"
#include "static/first_break.h"
#include "static/network.h"

static const double kn = 3e6;

/* A bonded specimen with the uniform law. `rho`: k_t/k_n. */
static gn_world *bonded(int dimension, const char *specimen, double rho, double stiffness,
                        const char *more) {
    char ratio[64] = "0";
    if (rho > 0.0) snprintf(ratio, sizeof ratio, "%.17g, friction: 0.5", 1.0 / rho);
    return world_of("dimension: %d\nspecimen: %s\nmaterials: [{name: m, density: 2000, "
                    "normal_stiffness: %.17g, kratio: %s, bond_tension_limit: 1e9, "
                    "bond_shear_limit: 1e9}]\nlaw: {stiffness: uniform}\ntime: {end: 1}\n%s",
                    dimension, specimen, stiffness, ratio, more);
}

static const char hexagonal[] = "{lattice: {kind: hexagonal, radius: 1 mm, cells: [6, 4, 1]}}",
                  hexagonal_box[] =
                      "periodic: {min: [0, 0], max: [12e-3, 0.01385640646055101895]}\n",
                  fcc[] = "{lattice: {kind: fcc, radius: 1 mm, cells: [4, 4, 4]}}",
                  fcc_box[] = "periodic: {min: [0, 0, 0], max: [0.011313708498984760, "
                              "0.011313708498984760, 0.011313708498984760]}\n",
                  discs[] = "{rectangle: {width: 40 mm, height: 40 mm}, particles: 500}",
                  spheres[] = "{box: {size: [20 mm, 20 mm, 20 mm]}, particles: 700}",
                  one_thread[] = "bonds: {interaction_range: 0.05}\nrun: {threads: 1}\n";

static gn_network network_of(gn_world *w) {
    gn_network found;
    gneiss_error error = {0};
    if (gn_network_stiffness(w, &found, &error) != GNEISS_OK) fail_msg("%s", error.message);
    world_end(w);
    return found;
}

static gn_network periodic(int dimension, double rho, const char *more) {
    char sections[512];
    snprintf(sections, sizeof sections, "%s%s", dimension == 3 ? fcc_box : hexagonal_box, more);
    return network_of(bonded(dimension, dimension == 3 ? fcc : hexagonal, rho, kn, sections));
}

static const char touching[] = "bonds: {}\nrun: {threads: 1}\n";

/* --- lattices --- */

/* k_n = E/(sqrt 3 (1 - nu)), k_t = k_n (1 - 3 nu)/(1 + nu) with the constants in the plane, for
 * 1 m of thickness (Tavarez & Plesha 2007, quoted in Santasusana 2013, 5.5-5.6). By uniform stress
 * nu = (1 - rho)/(2 + 2 rho). */
static void a_hexagonal_lattice_has_the_constants_of_tavarez_and_plesha(void **state) {
    (void)state;
    const double ratios[] = {0.05, 0.2, 0.7, 1.0};
    for (int k = 0; k < 4; k++) {
        const double rho = ratios[k];
        const gn_network x = periodic(2, rho, touching);
        const double *c = x.network.c, nu = c[1] / c[0], e = c[0] * (1.0 - nu * nu);
        assert_close(e / (sqrt(3.0) * (1.0 - nu)), kn, 1e-10);
        assert_near((1.0 - 3.0 * nu) / (1.0 + nu), rho, 1e-10);
        assert_close(c[8], c[0] * (1.0 - nu) / 2.0, 1e-10);
        for (int a = 0; a < 9; a++) assert_near(c[a], x.strained.c[a], 1e-10 * c[0]);
        assert_near(gn_isotropic_of(&x.network).anisotropy, 0.0, 1e-10);
        assert_near(gn_isotropic_of(&x.network).poisson, (1.0 - rho) / 4.0, 1e-10);
        assert_true(x.has_stressed);
        assert_near(gn_isotropic_of(&x.stressed).poisson, (1.0 - rho) / (2.0 + 2.0 * rho), 1e-10);
        assert_int_equal(x.boundary, 0);
    }
}

/* The twelve bonds of a face-centred cubic lattice with cells of a = 2 sqrt 2 r: C_11 = 2 (k_n +
 * k_t)/a, C_12 = (k_n - k_t)/a, C_44 = (k_n + k_t)/a. */
static void a_face_centred_lattice_is_cubic(void **state) {
    (void)state;
    const double rho = 0.3, kt = rho * kn, a = 2.0 * sqrt(2.0) * 1e-3;
    const gn_network x = periodic(3, rho, touching);
    for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++) {
            double want = p == q ? (p < 3 ? 2.0 : 1.0) * (kn + kt) / a
                                 : (p < 3 && q < 3 ? (kn - kt) / a : 0.0);
            assert_near(x.network.c[6 * p + q], want, 1e-10 * kn / a);
        }
    assert_close(x.fabric.fourth[0], 1.0 / 6.0, 1e-10);  /* <n_x^4> */
    assert_close(x.fabric.fourth[1], 1.0 / 12.0, 1e-10); /* <n_x^2 n_y^2> */
    assert_close(x.fabric.second[0], 1.0 / 3.0, 1e-10);
    assert_close(x.fabric.length, 2e-3, 1e-10);
}

/* In a lattice under a uniform strain nothing rotates, so that moments of bonds have no effect. */
static void bonds_with_moments_do_not_change_a_lattice(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        const gn_network x = periodic(d, 0.4, touching),
                         y = periodic(d, 0.4, "bonds: {radius_multiplier: 1}\nrun: {threads: 1}\n");
        const int n = gn_voigt_size(d);
        for (int a = 0; a < n * n; a++)
            assert_near(x.network.c[a], y.network.c[a], 1e-10 * x.network.c[0]);
    }
}

/* --- packings --- */

/* Returns the least eigenvalue of a - b over the largest entry of a. */
static double least_above(const gn_elastic *a, const gn_elastic *b) {
    const int n = gn_voigt_size(a->dimension);
    double apart[36], values[6], vectors[36], most = 0.0;
    for (int k = 0; k < n * n; k++) {
        apart[k] = a->c[k] - b->c[k];
        most = fmax(most, fabs(a->c[k]));
    }
    gn_eigen_symmetric(n, apart, values, vectors);
    return values[n - 1] / most;
}

/* Uniform strain is an admissible motion, which costs more energy than the equilibrium, and so is
 * the equilibrium without moments for bonds with them. */
static void constants_are_in_the_order_of_their_energies(void **state) {
    (void)state;
    const double ratios[] = {0.0, 0.1, 0.5, 1.0};
    for (int k = 0; k < 8; k++) {
        const int d = 2 + k / 4;
        const double rho = ratios[k % 4];
        const gn_network x = network_of(bonded(d, d == 3 ? spheres : discs, rho, kn, one_thread));
        assert_true(least_above(&x.strained, &x.network) > -1e-9);
        assert_true(least_above(&x.strained, &x.network) < 0.5);
        assert_true(x.network.c[0] < 0.9999 * x.strained.c[0]);
        assert_true(x.residual < 1e-9);
        if (rho == 0.0) continue; /* bonds with moments have a shear stiffness */
        const gn_network y =
            network_of(bonded(d, d == 3 ? spheres : discs, rho, kn,
                              "bonds: {interaction_range: 0.05, radius_multiplier: 1}\n"
                              "run: {threads: 1}\n"));
        assert_true(least_above(&y.network, &x.network) > -1e-9);
        assert_true(least_above(&x.strained, &y.network) > -1e-9);
        assert_true(y.network.c[0] > 1.00001 * x.network.c[0]);
    }
    const gn_network flat = periodic(2, 0.3, touching), cubic = periodic(3, 0.3, touching);
    assert_true(least_above(&flat.network, &flat.stressed) > -1e-9);
    assert_true(least_above(&cubic.network, &cubic.stressed) > -1e-9);
    assert_true(flat.stressed.c[0] < 0.99 * flat.network.c[0]);
}

/* E and nu of isotropic packings by uniform strain and stress, with a = sum of k_n l^2/V. The
 * nearest isotropic tensor of uniform strain depends on C_iijj and C_ijij alone, in which the
 * directions of bonds cancel. By uniform stress they do not: means of n_z^2 over n bonds scatter by
 * about 0.3/sqrt n; the tolerance is a dozen of that, as walls order the directions too. */
static void isotropic_packings_have_the_closed_forms(void **state) {
    (void)state;
    const double ratios[] = {0.05, 0.3, 0.8, 1.0};
    for (int k = 0; k < 8; k++) {
        const int d = 2 + k / 4;
        const double rho = ratios[k % 4];
        const gn_network x = network_of(bonded(d, d == 3 ? spheres : discs, rho, kn, one_thread));
        const double a = x.fabric.modulus, scatter = 4.0 / sqrt((double)x.fabric.bonds);
        const gn_isotropic up = gn_isotropic_of(&x.strained), low = gn_isotropic_of(&x.stressed);
        assert_close(up.young,
                     d == 3 ? a * (2.0 + 3.0 * rho) / (3.0 * (4.0 + rho))
                            : a * (1.0 + rho) * (5.0 - rho) / 16.0,
                     1e-10);
        assert_near(up.poisson, d == 3 ? (1.0 - rho) / (4.0 + rho) : (1.0 - rho) / 4.0, 1e-10);
        assert_near(low.poisson,
                    d == 3 ? (1.0 - rho) / (2.0 + 3.0 * rho) : (1.0 - rho) / (2.0 + 2.0 * rho),
                    scatter);
        if (d == 3) assert_close(low.young, 5.0 * a * rho / (3.0 * (2.0 + 3.0 * rho)), scatter);
        assert_true(up.anisotropy < scatter);
    }
}

static void the_result_is_the_same_for_two_threads_and_scales_with_the_springs(void **state) {
    (void)state;
    for (int d = 2; d <= 3; d++) {
        const char *specimen = d == 3 ? spheres : discs;
        const gn_network x = network_of(bonded(d, specimen, 0.25, kn, one_thread)),
                         y = network_of(bonded(d, specimen, 0.25, kn,
                                               "bonds: {interaction_range: 0.05}\n"
                                               "run: {threads: 2}\n")),
                         z = network_of(bonded(d, specimen, 0.25, 1024.0 * kn, one_thread));
        const int n = gn_voigt_size(d);
        for (int a = 0; a < n * n; a++) {
            assert_true(x.network.c[a] == y.network.c[a]);
            assert_near(z.network.c[a], 1024.0 * x.network.c[a], 1e-13 * z.network.c[0]);
        }
        assert_int_equal(x.iterations, y.iterations);
        assert_int_equal(x.iterations, z.iterations);
    }
}

/* --- loading --- */

static gneiss_status note(void *context, const gn_first_break *so_far, gneiss_error *error) {
    (void)so_far;
    (void)error;
    ++*(int *)context;
    return GNEISS_OK;
}

/* A row of discs, clamped at one end, whose other end is moved across it: bond k transmits the
 * force F and turns by F L_k over its bending stiffness, with L_k from its middle to the end, so
 * that the displacement is sum of F/k_t + F L_k^2/k_b. */
static void a_row_of_bonds_with_moments_bends_as_a_beam(void **state) {
    (void)state;
    enum { COUNT = 9, STATES = 4 };
    text t = {0};
    add(&t, "{particles: [");
    for (int k = 0; k < COUNT; k++) add(&t, "[%.17g, 0, 1e-3], ", 2e-3 * k);
    add(&t, "]}");
    gn_world *w = bonded(2, t.s, 0.4, kn,
                         "bonds: {radius_multiplier: 1}\nrun: {threads: 1}\nsets:\n"
                         "- {name: foot, select: {ids: [0]}, motion: {vx: 0, vy: 0, wz: 0}}\n"
                         "- {name: head, select: {ids: [8]}, motion: {vy: [[0, 0], [1, 1 mm/s]]}}\n"
                         "damping: {contact: {fraction: 0.9}}\n");
    const gn_contacts *list = &w->dem.bonds.contacts;
    const double along[3] = {1.0, 0.0, 0.0}, path = 1e-6;
    const double bend = gn_law_of(list->soa.effects)->moments(list, 0, along).bend;
    double soft = 0.0;
    for (int k = 0; k < COUNT - 1; k++) {
        const double arm = 2e-3 * (COUNT - 1 - k) - 1e-3;
        soft += 1.0 / (0.4 * kn) + arm * arm / bend;
    }
    gn_first_break found;
    gneiss_error error = {0};
    int states = 0;
    if (gn_static_loading(w, path, STATES, &(gn_first_break_watch){note, &states}, &found,
                          &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    assert_int_equal(states, STATES + 1);
    assert_near(pos_of(w, 8)[1], path, 1e-12 * path);
    const int32_t slot = w->dem.particles.slot[w->dem.index_of_id[8]];
    assert_close(fabs(w->dem.prescribed.load[6 * slot + 1]), path / soft, 1e-5);
    world_end(w);
}

/* --- loose parts, and bodies without constants --- */

/* A slab with a gap above it in a periodic box resists only strain along it; a single particle and
 * a single pair in the gap have no stiffness. */
static void loose_parts_resist_nothing(void **state) {
    (void)state;
    text t = {0};
    add(&t, "{particles: [");
    for (int row = 0; row < 4; row++)
        for (int k = 0; k < 6; k++)
            add(&t, "[%.17g, %.17g, 1e-3], ", 2e-3 * k + 1e-3 * (row % 2),
                sqrt(3.0) * 1e-3 * row + 1e-3);
    add(&t, "[3e-3, 12e-3, 1e-3], [8e-3, 12e-3, 1e-3], [10e-3, 12e-3, 1e-3]]}");
    const gn_network x = network_of(bonded(2, t.s, 0.3, kn,
                                           "periodic: {min: [0, 0], max: [12e-3, 20e-3]}\n"
                                           "bonds: {}\nrun: {threads: 1}\n"));
    assert_int_equal(x.particles, 26);
    assert_int_equal(x.fabric.bonds, 4 * 6 + 3 * 12 + 1);
    const double *c = x.network.c;
    assert_true(c[0] > 0.1 * x.strained.c[0]);
    for (int a = 1; a < 9; a++) assert_near(c[a], 0.0, 1e-9 * c[0]);
    /* Four rows of free width: without lateral stress, each bond along x has the whole strain, and
     * those between the rows the corresponding part. */
    assert_true(c[0] < x.strained.c[0] - x.strained.c[1] * x.strained.c[1] / x.strained.c[4] +
                           1e-9 * c[0]);
}

static void assert_refused(gn_world *w, const char *words) {
    gn_network found;
    gneiss_error error = {0};
    assert_int_equal(gn_network_stiffness(w, &found, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, words)) fail_msg("%s", error.message);
    world_end(w);
}

static void packings_without_constants_are_refused(void **state) {
    (void)state;
    assert_refused(
        bonded(3, "{particles: [[0, 0, 0, 1e-3], [5e-3, 0, 0, 1e-3]]}", 0.5, kn, "bonds: {}\n"),
        "expected bonds, found none");
    assert_refused(bonded(2, "{particles: [[0, 0, 1e-3], [2e-3, 0, 1e-3], [4e-3, 0, 1e-3]]}", 0.5,
                          kn, "bonds: {}\n"),
                   "all of them on a line");
    assert_refused(bonded(3, "{lattice: {kind: cubic, radius: 1e-3, cells: [3, 3, 1]}}", 0.5, kn,
                          "bonds: {}\n"),
                   "all of them on a plane");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hexagonal_lattice_has_the_constants_of_tavarez_and_plesha),
        cmocka_unit_test(a_face_centred_lattice_is_cubic),
        cmocka_unit_test(bonds_with_moments_do_not_change_a_lattice),
        cmocka_unit_test(constants_are_in_the_order_of_their_energies),
        cmocka_unit_test(isotropic_packings_have_the_closed_forms),
        cmocka_unit_test(the_result_is_the_same_for_two_threads_and_scales_with_the_springs),
        cmocka_unit_test(a_row_of_bonds_with_moments_bends_as_a_beam),
        cmocka_unit_test(loose_parts_resist_nothing),
        cmocka_unit_test(packings_without_constants_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
