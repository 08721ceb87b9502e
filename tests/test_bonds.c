/* Bonds: stiffness and strength by every model, breaking, contacts that remain of broken bonds;
 * energy of bonded pairs, damping, loads and walls. */
#include "particles/observe.h"
#include "world_helpers.h"

/* --- parameters of Rojek et al. 2012 --- */

enum { MODELS = 6 };
static const char *const models[MODELS] = {"uniform",     "arithmetic",      "harmonic",
                                           "mean_radius", "mean_arithmetic", "mean_harmonic"};
static const double E_c = 8e9, sigma_c = 30e6, tau_c = 50e6, kappa = 2.5;

/* Three particles in a row, of radii 1, 2 and 1.5 mm, bonded across small gaps. */
static const double radii[3] = {1e-3, 2e-3, 1.5e-3};

static gn_world *row_of_three(int dimension, const char *model) {
    double x1 = 3.05e-3, x2 = x1 + 3.6e-3;
    const char *zero = dimension == 3 ? "0, 0, " : "0, ";
    return world_of(
        "dimension: %d\nspecimen: {particles: [[0, %s1e-3], [%g, %s2e-3], [%g, %s1.5e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 3e7, contact_modulus: %g, "
        "kratio: %g, friction: 0.3, tensile_strength: %g, shear_strength: %g, "
        "bond_tension_limit: 70, bond_shear_limit: 90}]\n"
        "law: {stiffness: %s}\nbonds: {}\ntime: {end: 1}\nrun: {threads: 1}\n",
        dimension, zero, x1, zero, x2, zero, E_c, kappa, sigma_c, tau_c, model);
}

static double least(double a, double b) {
    return a < b ? a : b;
}

/* k_n, R_n, R_t of the bond between particles p and p + 1. In 3D k_n = 2 E_c r, R = 4 sigma_c r^2
 * (eq. 20-33); in 2D a slice of 1 m: section 2 r x 1 m, length 2 r. */
static void expected_law(int dimension, int model, int p, double *kn, double *rn, double *rt) {
    double a = radii[p], b = radii[p + 1], r = 0.0, r2 = 0.0, n = 0.0;
    if (model == 0) {
        *kn = 3e7;
        *rn = 70;
        *rt = 90;
        return;
    }
    if (model == 1) r = 0.5 * (a + b), r2 = r * r;
    if (model == 2) r = 2 * a * b / (a + b), r2 = least(a, b) * least(a, b);
    for (int k = 0; model >= 3 && k < (model == 3 ? 3 : 2); k++) {
        double c = radii[k], d = k < 2 ? radii[k + 1] : 0.0, mean = 0.5 * (c + d);
        r += model == 3 ? c : model == 4 ? mean : 2 * c * d / (c + d);
        r2 += model == 3 ? c * c : model == 4 ? mean * mean : least(c, d) * least(c, d);
        n++;
    }
    if (model >= 3) r /= n, r2 /= n;
    *kn = dimension == 3 ? 2 * E_c * r : E_c;
    *rn = dimension == 3 ? 4 * sigma_c * r2 : 2 * sigma_c * sqrt(r2);
    *rt = dimension == 3 ? 4 * tau_c * r2 : 2 * tau_c * sqrt(r2);
}

static void stiffness_and_strength_follow_every_model(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int model = 0; model < MODELS; model++) {
            gn_world *w = row_of_three(dimension, models[model]);
            assert_int_equal(w->dem.bonds.contacts.soa.count, 2);
            for (size_t c = 0; c < 2; c++) {
                int i = w->dem.particles.id[w->dem.bonds.contacts.i[c]],
                    j = w->dem.particles.id[w->dem.bonds.contacts.j[c]];
                double kn, rn, rt;
                expected_law(dimension, model, i < j ? i : j, &kn, &rn, &rt);
                assert_close(w->dem.bonds.contacts.kn[c], kn, 1e-14);
                assert_close(w->dem.bonds.contacts.kt[c], kn / kappa, 1e-14);
                assert_close(w->dem.bonds.contacts.rn[c], rn, 1e-14);
                assert_close(w->dem.bonds.contacts.rt[c], rt, 1e-14);
                assert_true(w->dem.bonds.contacts.mu[c] == 0.3);
            }
            world_end(w);
        }
}

static void bonds_form_within_the_range_and_the_group(void **state) {
    (void)state;
    /* Gaps of 4.9 % and 5.1 % of r_i + r_j; the last two touch but belong to another group and to
     * none. */
    gn_world *w = world_of(
        "dimension: 2\nspecimen: {particles: [[0, 0, 1], [2.098, 0, 1], [4.2, 0, 1], [6.2, 0, 1], "
        "[8.2, 0, 1]]}\n"
        "materials: [{name: m, density: 1, normal_stiffness: 1, kratio: 1, bond_tension_limit: 1, "
        "bond_shear_limit: 1}]\nlaw: {stiffness: uniform}\nbonds: {interaction_range: 0.05}\n"
        "sets: [{name: a, select: {ids: [3]}, group: 2}, {name: b, select: {ids: [4]}, group: 0}]\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
    assert_int_equal(w->dem.bonds.contacts.soa.count, 1);
    int i = w->dem.particles.id[w->dem.bonds.contacts.i[0]],
        j = w->dem.particles.id[w->dem.bonds.contacts.j[0]];
    assert_int_equal(i + j, 1);
    assert_int_equal(w->dem.particles.bonds0[w->dem.index_of_id[0]], 1);
    assert_int_equal(w->dem.particles.bonds0[w->dem.index_of_id[2]], 0);
    world_end(w);
}

/* --- a pair that is pulled and sheared --- */

static const double pair_kn = 2e7, pair_kt = 1e7, pair_rn = 50.0, pair_rt = 30.0, pair_mu = 0.4;

/* Two spheres of radius 1 mm at `distance`, the first held, the second driven without spin; v: "vx:
 * .., vy:
 * .." (tables as well). `bonds`: the bonds section, "" for none. */
static gn_world *driven_pair(int dimension, double distance, const char *v, const char *bonds,
                             double dt) {
    bool space = dimension == 3;
    return world_of(
        "dimension: %d\nspecimen: {particles: [[0, %s1e-3], [%.17g, %s1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: %g, kratio: 2, friction: %g, "
        "bond_tension_limit: %g, bond_shear_limit: %g}]\nlaw: {stiffness: uniform}\n%s"
        "sets:\n  - {name: held, select: {ids: [0]}, motion: {vx: 0, vy: 0, %swz: 0}}\n"
        "  - {name: driven, select: {ids: [1]}, motion: {%s, %swz: 0}}\n"
        "time: {step: %g, end: 1, on_unstable: warn}\nrun: {threads: 1}\n",
        dimension, space ? "0, 0, " : "0, ", distance, space ? "0, 0, " : "0, ", pair_kn, pair_mu,
        pair_rn, pair_rt, bonds, space ? "vz: 0, wx: 0, wy: 0, " : "", v,
        space ? "vz: 0, wx: 0, wy: 0, " : "", dt);
}

/* Returns the force of the only bond on particle 0, which is held: minus the reaction of its
 * support. */
static void bond_force(const gn_world *w, double f[3]) {
    for (int a = 0; a < 3; a++) f[a] = -w->dem.set_reaction[a];
}

/* Loads the pair until it breaks; checks that the last force with the bond intact lay below the
 * strength and that one more increment reached it. */
static void breaks_exactly(int dimension, const char *v, double stiffness, double limit,
                           gn_cause cause) {
    double dt = 1e-8, speed = 0.5, f[3], now = 0.0, last = 0.0;
    gn_world *w = driven_pair(dimension, 2e-3, v, "bonds: {}\n", dt);
    assert_int_equal(w->dem.bonds.contacts.soa.count, 1);
    while (w->dem.bonds.contacts.cause[0] == GN_INTACT) {
        last = now;
        assert_true(last < limit);
        assert_true(w->ctx.step < 2 * (int64_t)(limit / (stiffness * speed * dt)));
        run_steps(w, 1);
        bond_force(w, f);
        now = cause == GN_BROKEN_SHEAR ? shear_of(&w->dem.bonds.contacts, 0, f) : f[0];
    }
    double increment = stiffness * speed * dt, slide = speed * w->ctx.time / 2e-3;
    /* The rotation of the normal stretches the bond by slide^2/2 and tilts the increment by slide.
     * */
    double tilt = cause == GN_BROKEN_SHEAR ? 2.0 * slide * slide : 0.0;
    assert_true(last + increment * (1.0 + 1e-9) >= limit * (1.0 - tilt));
    assert_int_equal(w->dem.bonds.contacts.cause[0], cause);
    assert_true(w->dem.bonds.contacts.rn[0] == -pair_rn);
    assert_close(w->dem.bonds.contacts.broken_time[0], w->ctx.time - dt, 1e-15);
    assert_int_equal(w->dem.broken_tension, cause == GN_BROKEN_TENSION);
    assert_int_equal(w->dem.broken_shear, cause == GN_BROKEN_SHEAR);
    world_end(w);
}

static void a_bond_breaks_at_its_tensile_strength(void **state) {
    (void)state;
    breaks_exactly(2, "vx: 0.5, vy: 0", pair_kn, pair_rn, GN_BROKEN_TENSION);
    breaks_exactly(3, "vx: 0.5, vy: 0", pair_kn, pair_rn, GN_BROKEN_TENSION);
}

static void a_bond_breaks_at_its_shear_strength(void **state) {
    (void)state;
    breaks_exactly(2, "vx: 0, vy: 0.5", pair_kt, pair_rt, GN_BROKEN_SHEAR);
    breaks_exactly(3, "vx: 0, vy: 0.5", pair_kt, pair_rt, GN_BROKEN_SHEAR);
}

static void a_bond_does_not_break_in_compression(void **state) {
    (void)state;
    gn_world *w = driven_pair(3, 2e-3, "vx: -0.5, vy: 0", "bonds: {}\n", 1e-8);
    run_steps(w, 2001); /* the last instant is 20 us in: 10 um x 20 MN/m */
    double f[3];
    bond_force(w, f);
    assert_close(f[0], -200.0, 1e-11); /* four times the tensile strength */
    assert_int_equal(w->dem.bonds.contacts.cause[0], GN_INTACT);
    world_end(w);
}

/* Output evaluates the force at the present distance and changes nothing; beyond its strength the
 * bond is still intact, because the world has not taken the step that breaks it. */
static void reading_the_forces_changes_nothing(void **state) {
    (void)state;
    gn_world *w = driven_pair(3, 2e-3, "vx: 0.5, vy: 0.2", "bonds: {}\n", 1e-8);
    double last = 0.0;
    for (int k = 0; k < 100000 && w->dem.bonds.contacts.cause[0] == GN_INTACT; k++) {
        run_steps(w, 1);
        gn_observed seen;
        gneiss_error error;
        uint64_t before = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
        assert_int_equal(gn_dem_observe(&w->ctx, &w->dem, &w->box, &seen, &error), GNEISS_OK);
        assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == before);
        assert_null(gn_contacts_row(&w->dem.bonds.contacts));
        const double *row = gn_contacts_row(&seen.list[GN_LIST_BONDS]);
        double x[3], t[3], force[3];
        for (int a = 0; a < 3; a++) x[a] = pos_of(w, 1)[a] - pos_of(w, 0)[a];
        double distance = length3(x),
               sign = w->dem.particles.id[w->dem.bonds.contacts.i[0]] == 0 ? 1.0 : -1.0;
        for (int a = 0; a < 3; a++) force[a] = sign * row[a];
        shear_of(&w->dem.bonds.contacts, 0, t);
        last = pair_kn * (distance - 2e-3);
        if (last < pair_rn && w->dem.bonds.contacts.cause[0] == GN_INTACT)
            assert_near(force[0] * x[0] / distance + force[1] * x[1] / distance, last,
                        1e-9 * pair_rn + 1e-3 * length3(t)); /* the shear force is a step old */
        gn_observed_free(&seen);
    }
    assert_true(last >= pair_rn || w->dem.bonds.contacts.cause[0] == GN_BROKEN_TENSION);
    world_end(w);
}

/* --- after breaking --- */

/* Overlap of a tenth of the radii, bonded: stress-free; pressed by 2 um, then sheared until it
 * breaks. */
static void a_broken_overlapping_bond_keeps_its_zero_gap(void **state) {
    (void)state;
    const double distance = 1.8e-3, dt = 1e-8, press = 2e-6;
    gn_world *w = driven_pair(3, distance,
                              "vx: [[0, -0.2], [1e-5, -0.2], [1.000001e-5, 0], [1, 0]], "
                              "vy: [[0, 0], [1e-5, 0], [1.000001e-5, 0.5], [1, 0.5]]",
                              "bonds: {}\n", dt);
    double f[3], before = 0.0, normal;
    run_steps(w, 1);
    bond_force(w, f);
    assert_true(f[0] == 0.0 && f[1] == 0.0); /* free of stress at the start */
    while (w->dem.bonds.contacts.cause[0] == GN_INTACT && w->ctx.step < 4000) {
        before = f[0];
        run_steps(w, 1);
        bond_force(w, f);
    }
    assert_int_equal(w->dem.bonds.contacts.cause[0], GN_BROKEN_SHEAR);
    assert_close(before, -pair_kn * press, 1e-2); /* compressed and slightly tilted */
    /* There is no jump: the normal force continues with the same zero gap, and the shear force
     * drops to friction. */
    double x[3], distance_now, t[3], turn;
    for (int k = 0; k < 400; k++) {
        for (int a = 0; a < 3; a++) x[a] = pos_of(w, 1)[a] - pos_of(w, 0)[a];
        distance_now = length3(x);
        run_steps(w, 1);
        bond_force(w, f);
        normal = (f[0] * x[0] + f[1] * x[1] + f[2] * x[2]) / distance_now;
        assert_near(normal, pair_kn * (distance_now - distance), 1e-14 * pair_kn * distance * 10.0);
        turn = shear_of(&w->dem.bonds.contacts, 0, t);
        assert_close(turn, pair_mu * fabs(normal), 1e-9); /* slips at mu f_n */
    }
    assert_true(fabs(normal) > 1.0);
    world_end(w);
}

static void a_bond_broken_in_tension_touches_again_at_its_own_length(void **state) {
    (void)state;
    /* A pair bonded across a gap of 40 um is pulled apart until the bond breaks, then brought
     * back. */
    const double distance = 2.04e-3;
    gn_world *w = driven_pair(3, distance, "vx: [[0, 1], [4e-6, 1], [4.01e-6, -1], [1, -1]], vy: 0",
                              "bonds: {}\n", 1e-8);
    double f[3];
    int64_t pressed = 0;
    for (int k = 0; k < 2000; k++) {
        double stretch = length3(pos_of(w, 1)) - distance; /* particle 0 is held at the origin */
        run_steps(w, 1);
        bond_force(w, f);
        if (w->dem.bonds.contacts.cause[0] == GN_INTACT) continue;
        assert_int_equal(w->dem.bonds.contacts.cause[0], GN_BROKEN_TENSION);
        double want = stretch < 0.0 ? pair_kn * stretch : 0.0;
        assert_near(f[0], want, 1e-14 * pair_kn * distance);
        pressed += stretch < 0.0;
    }
    assert_true(pressed > 500);
    world_end(w);
}

/* Two free spinning particles that collide at an angle; strengths of `limit` N. */
static gn_world *meeting_pair(int dimension, const char *bonds) {
    bool space = dimension == 3;
    return world_of(
        "dimension: %d\nspecimen: {particles: [[0, %s1e-3], [2e-3, %s1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 2e7, kratio: 2, friction: 0.4, "
        "bond_tension_limit: 1e-25, bond_shear_limit: 1e-25}]\nlaw: {stiffness: uniform}\n%s"
        "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [1, 0.6%s], initial_spin: %s}\n"
        "  - {name: b, select: {ids: [1]}, initial_velocity: [0.1, -0.2%s]}\n"
        "time: {step: 2e-8, end: 1}\nrun: {threads: 1}\n",
        dimension, space ? "0, 0, " : "0, ", space ? "0, 0, " : "0, ", bonds, space ? ", 0.3" : "",
        space ? "[100, -300, 700]" : "700", space ? ", 0" : "");
}

/* The bond is gone at the first instant that loads it, before it has exerted any force. */
static void a_pair_broken_at_once_behaves_as_one_never_bonded(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        gn_world *a = meeting_pair(dimension, "bonds: {}\n"), *b = meeting_pair(dimension, "");
        assert_int_equal(a->dem.bonds.contacts.soa.count, 1);
        assert_int_equal(b->dem.bonds.contacts.soa.count, 0);
        for (int k = 0; k < (dimension == 3 ? 500 : 3000); k++) { /* discs are heavier */
            run_steps(a, 1);
            run_steps(b, 1);
            for (int p = 0; p < 2; p++) {
                assert_memory_equal(pos_of(a, p), pos_of(b, p), 4 * sizeof(double));
                assert_memory_equal(vel_of(a, p), vel_of(b, p), 4 * sizeof(double));
                assert_memory_equal(spin_of(a, p), spin_of(b, p), 4 * sizeof(double));
            }
        }
        assert_true(a->dem.bonds.contacts.cause[0] != GN_INTACT);
        assert_true(vel_of(a, 1)[0] > 0.5); /* the particles collided */
        world_end(a);
        world_end(b);
    }
}

static void work_of_breaking_balances(void **state) {
    (void)state;
    /* A bond is pulled until it breaks: the whole work is released, 1/2 R_n^2/k_n and the last
     * increment. */
    gn_world *w = driven_pair(3, 2e-3, "vx: 0.5, vy: 0", "bonds: {}\n", 1e-8);
    measured_step(w);
    while (w->dem.bonds.contacts.cause[0] == GN_INTACT) run_steps(w, 1);
    gn_energy e = measured_step(w);
    double u = pair_rn / pair_kn, du = 0.5 * 1e-8;
    assert_true(e.bond_breaking >= 0.5 * pair_kn * (u - du) * (u - du));
    assert_true(e.bond_breaking <= 0.5 * pair_kn * (u + du) * (u + du));
    assert_true(fabs(gn_energy_residual(&e)) < 1e-10);
    world_end(w);
}

/* A bond is sheared until it breaks under compression, and the contact then slips: every part of
 * the work is booked. */
static void work_of_shear_breaking_and_slip_balances(void **state) {
    (void)state;
    gn_world *w = driven_pair(3, 2e-3,
                              "vx: [[0, -0.2], [1e-5, -0.2], [1.000001e-5, 0], [1, 0]], "
                              "vy: [[0, 0], [1e-5, 0], [1.000001e-5, 0.5], [1, 0.5]]",
                              "bonds: {}\n", 1e-8);
    measured_step(w);
    run_steps(w, 4000);
    gn_energy e = measured_step(w);
    assert_int_equal(w->dem.bonds.contacts.cause[0], GN_BROKEN_SHEAR);
    assert_true(e.friction > 0.0 && e.bond_breaking > 0.0);
    /* Normals rotate by v dt/d = 2.5e-6 per step, and each step's trapezoid has an error of about
     * that. */
    assert_true(fabs(gn_energy_residual(&e)) < 1e-5);
    world_end(w);
}

/* Two spheres of radii 1 and 2 mm: a hundredth of the smaller is 10 um. */
static gneiss_status close_pair(double distance, const char *bonds, gneiss_error *error) {
    char scene[1024];
    gn_world w;
    snprintf(scene, sizeof scene,
             "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm], [%.17g, 0, 0, 2 mm]]}\n"
             "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 2, "
             "bond_tension_limit: 70, bond_shear_limit: 90}]\n"
             "law: {stiffness: uniform}\n%stime: {end: 1}\nrun: {threads: 1}\n",
             distance, bonds);
    gneiss_status status = world_try(&w, scene, NULL, error);
    if (status == GNEISS_OK) gn_world_free(&w);
    return status;
}

static void bonded_centres_keep_a_distance(void **state) {
    (void)state;
    const double close[] = {1e-12, 1e-8, 9.9e-6};
    for (int k = 0; k < 3; k++) {
        gneiss_error error = {0};
        assert_int_equal(close_pair(close[k], "bonds: {}\n", &error), GNEISS_ERROR_INPUT);
        if (!strstr(error.message, "particles 0 and 1")) fail_msg("%s", error.message);
        assert_int_equal(close_pair(close[k], "bonds: {overlap_range: 0.9}\n", &error), GNEISS_OK);
        assert_int_equal(close_pair(close[k], "", &error), GNEISS_OK);
    }
    gneiss_error error = {0};
    assert_int_equal(close_pair(1.01e-5, "bonds: {}\n", &error), GNEISS_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stiffness_and_strength_follow_every_model),
        cmocka_unit_test(bonds_form_within_the_range_and_the_group),
        cmocka_unit_test(a_bond_breaks_at_its_tensile_strength),
        cmocka_unit_test(a_bond_breaks_at_its_shear_strength),
        cmocka_unit_test(a_bond_does_not_break_in_compression),
        cmocka_unit_test(reading_the_forces_changes_nothing),
        cmocka_unit_test(a_broken_overlapping_bond_keeps_its_zero_gap),
        cmocka_unit_test(a_bond_broken_in_tension_touches_again_at_its_own_length),
        cmocka_unit_test(bonded_centres_keep_a_distance),
        cmocka_unit_test(a_pair_broken_at_once_behaves_as_one_never_bonded),
        cmocka_unit_test(work_of_breaking_balances),
        cmocka_unit_test(work_of_shear_breaking_and_slip_balances),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
