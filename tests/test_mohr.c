/* Bonds whose shear strength depends on the normal force (src/kernels/law_mohr.h): closed forms of
 * one bond, couplings, energies, threads, resumption, keys. */
#include "run_helpers.h"

/* Two spheres of 1 mm, the first one held, the second one moved along x and then across: the state
 * of both is known at every step. k_n = 1e7 N/m, k_t = 4e6 N/m, R_n = 20 N, R_t = 12 N. */
static const char *const couple =
    "dimension: 3\n"
    "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, friction: %g,\n"
    "  bond_tension_limit: 20, bond_shear_limit: 12, bond_friction: %g}]\n"
    "law: {stiffness: uniform, rotation: off, coupling: %s}\n"
    "bonds: {}\n"
    "sets:\n"
    "  - {name: held, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0}}\n"
    "  - {name: moved, select: {ids: [1]}, motion: {vx: [[0, %g], [1e-4, %g], [1.0001e-4, 0]],\n"
    "      vy: [[0, 0], [1.0001e-4, 0], [1.0002e-4, 0.1]], vz: 0}}\n"
    "time: {step: 1e-8, end: 1}\nrun: {threads: 1, precision: %s}\n";

typedef struct broke {
    double normal, shear; /* N, of the springs in the last step of the whole bond */
    double after;         /* N, tangential once it has broken */
    int cause;
} broke;

static double tangential(const gn_contacts *q) {
    double square = 0.0;
    for (size_t a = 0; a < 3; a++) {
        size_t at = a * q->soa.capacity;
        double f = q->shear ? q->shear[at] : (double)q->shear_f[at];
        square += f * f;
    }
    return sqrt(square);
}

/* The bond is stretched by `normal` newtons, then sheared until it breaks. */
static broke break_it(double mu, double mu1, const char *coupling, double normal,
                      const char *precision) {
    double speed = normal / 1e7 / 1.00005e-4;
    gn_world *w = world_of(couple, mu, mu1, coupling, speed, speed, precision);
    broke b = {0};
    for (int k = 0; k < 60000 && !w->dem.bonds.contacts.cause[0]; k++) {
        b.shear = tangential(&w->dem.bonds.contacts);
        const double *at = w->dem.particles.pos;
        b.normal = 1e7 * (hypot(at[4] - at[0], at[5] - at[1]) - 2e-3);
        run_steps(w, 1);
        b.cause = w->dem.bonds.contacts.cause[0];
        b.after = tangential(&w->dem.bonds.contacts);
    }
    world_end(w);
    return b;
}

/* A step adds k_t v dt = 4e-3 N. */
static const double step_force = 4e-3;

static void pressure_makes_a_bond_stronger_in_shear(void **state) {
    (void)state;
    const double pressed[] = {5.0, 40.0, 100.0};
    for (int k = 0; k < 3; k++) {
        broke b = break_it(0.3, 0.9, "none", -pressed[k], "double");
        assert_int_equal(b.cause, GN_BROKEN_SHEAR);
        double strength = 12.0 - 0.9 * b.normal;
        assert_true(b.shear < strength && b.shear > strength - 1.01 * step_force);
        /* The second friction acts in the step of the break. The line of the centres rotates by the
         * transverse path over the distance, and the stretch grows by 1 - cos of that angle. */
        assert_near(b.after, 0.3 * pressed[k], 0.03 * 0.3 * pressed[k] + 2.0 * step_force);
    }
}

static void tension_leaves_the_shear_strength_unless_coupled(void **state) {
    (void)state;
    broke b = break_it(0.3, 0.9, "none", 15.0, "double");
    assert_int_equal(b.cause, GN_BROKEN_SHEAR);
    assert_true(b.shear < 12.0 && b.shear > 12.0 - 1.01 * step_force);
}

static void quadratic_coupling_adds_the_squares_of_both_shares(void **state) {
    (void)state;
    const double pulled[] = {5.0, 12.0, 19.0};
    for (int k = 0; k < 3; k++) {
        broke b = break_it(0.3, 0.9, "quadratic", pulled[k], "double");
        double share = b.normal / 20.0, strength = 12.0 * sqrt(1.0 - share * share);
        assert_true(b.shear < strength && b.shear > strength - 2.0 * step_force);
        /* If both modes reach the limit together the larger share is the cause. */
        assert_int_equal(b.cause, share > sqrt(0.5) ? GN_BROKEN_TENSION : GN_BROKEN_SHEAR);
    }
    broke b = break_it(0.3, 0.9, "quadratic", -40.0, "double");
    assert_near(b.shear, 12.0 - 0.9 * b.normal, 1.01 * step_force);
}

static void linear_coupling_takes_the_friction_of_the_pull(void **state) {
    (void)state;
    broke b = break_it(0.3, 0.5, "linear", 15.0, "double");
    assert_int_equal(b.cause, GN_BROKEN_SHEAR);
    double strength = 12.0 - 0.5 * b.normal;
    assert_true(b.shear < strength && b.shear > strength - 1.01 * step_force);
    /* The strength does not fall below zero: the bond then cannot carry the first increment of
     * shear. */
    b = break_it(0.3, 0.9, "linear", 15.0, "double");
    assert_true(b.shear <= 1.01 * step_force);
}

/* The forces agree to the rounding of forces and of the stretch in single precision. */
static void in_mixed_precision_a_bond_breaks_at_the_same_force(void **state) {
    (void)state;
    const char *const couplings[] = {"none", "quadratic", "linear"};
    const double normal[] = {-40.0, 12.0, 12.0};
    for (int k = 0; k < 3; k++) {
        broke a = break_it(0.3, 0.5, couplings[k], normal[k], "double");
        broke b = break_it(0.3, 0.5, couplings[k], normal[k], "mixed");
        assert_int_equal(a.cause, b.cause);
        assert_near(a.shear, b.shear, 1.01 * step_force + 1e-5 * a.shear);
    }
}

/* --- with moments --- */

/* Like break_it, for a bond with moments: neither particle rotates, so that they are zero.
 * */
static broke break_beam(const char *coupling, double normal, const char *precision) {
    char words[2048];
    const char *still = "wx: 0, wy: 0, wz: 0";
    double speed = normal / 1e7 / 1.00005e-4;
    snprintf(
        words, sizeof words,
        "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, friction: 0.3,\n"
        "  bond_tension_limit: 20, bond_shear_limit: 12, bond_friction: 0.5}]\n"
        "law: {stiffness: uniform, coupling: %s}\nbonds: {radius_multiplier: 1}\n"
        "sets:\n  - {name: held, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0, %s}}\n"
        "  - {name: moved, select: {ids: [1]}, motion: {vx: [[0, %g], [1e-4, %g], [1.0001e-4, "
        "0]], vy: [[0, 0], [1.0001e-4, 0], [1.0002e-4, 0.1]], vz: 0, %s}}\n"
        "time: {step: 1e-8, end: 1}\nrun: {threads: 1, precision: %s}\n",
        coupling, still, speed, speed, still, precision);
    gn_world *w = world_of("%s", words);
    assert_int_equal(w->ctx.effects & (GN_FX_MOHR | GN_FX_BOND_MOMENTS),
                     GN_FX_MOHR | GN_FX_BOND_MOMENTS);
    broke b = {0};
    for (int k = 0; k < 60000 && !w->dem.bonds.contacts.cause[0]; k++) {
        b.shear = tangential(&w->dem.bonds.contacts);
        const double *at = w->dem.particles.pos;
        b.normal = 1e7 * (hypot(at[4] - at[0], at[5] - at[1]) - 2e-3);
        run_steps(w, 1);
        b.cause = w->dem.bonds.contacts.cause[0];
    }
    world_end(w);
    return b;
}

static void friction_strengthens_bonds_with_moments_alike(void **state) {
    (void)state;
    const char *const precisions[] = {"double", "mixed"};
    for (int k = 0; k < 2; k++) {
        broke pressed = break_beam("none", -40.0, precisions[k]);
        broke pulled = break_beam("none", 15.0, precisions[k]);
        broke coupled = break_beam("linear", 15.0, precisions[k]);
        const broke *all[] = {&pressed, &pulled, &coupled};
        const double strength[] = {12.0 - 0.5 * pressed.normal, 12.0, 12.0 - 0.5 * coupled.normal};
        for (int c = 0; c < 3; c++) {
            assert_int_equal(all[c]->cause, GN_BROKEN_SHEAR);
            assert_near(all[c]->shear, strength[c] - 0.5 * step_force, 0.6 * step_force + 1e-4);
        }
    }
}

/* --- mean stress --- */

/* Two rows of three discs; the outer ones move inwards by 1e-6 m, then the upper row moves
 * sideways. The bonds between the rows carry no normal force; the middle one lies between particles
 * with two compressed bonds of three, the outer ones with one of two. */
static const char *const rows =
    "dimension: 2\n"
    "specimen: {particles: [[0, 0, 1e-3], [2e-3, 0, 1e-3], [4e-3, 0, 1e-3],\n"
    "  [0, 2e-3, 1e-3], [2e-3, 2e-3, 1e-3], [4e-3, 2e-3, 1e-3]]}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, friction: 0.3,\n"
    "  bond_tension_limit: 20, bond_shear_limit: 12, bond_friction: 0.9%s}]\n"
    "law: {stiffness: uniform, rotation: off, confinement: %s%s}\nbonds: {}\n"
    "sets:\n"
    "  - {name: low, select: {ids: [0]}, motion: {vx: [[0, 0.01], [1e-4, 0.01], [1.0001e-4, 0]], "
    "vy: "
    "0}}\n"
    "  - {name: mid, select: {ids: [1]}, motion: {vx: 0, vy: 0}}\n"
    "  - {name: high, select: {ids: [2]}, motion: {vx: [[0, -0.01], [1e-4, -0.01], [1.0001e-4, "
    "0]], "
    "vy: 0}}\n"
    "  - {name: low2, select: {ids: [3]}, motion: {vx: [[0, 0.01], [1e-4, 0.01], [1.0001e-4, "
    "0.1]], "
    "vy: 0}}\n"
    "  - {name: mid2, select: {ids: [4]}, motion: {vx: [[0, 0], [1e-4, 0], [1.0001e-4, 0.1]], vy: "
    "0}}\n"
    "  - {name: high2, select: {ids: [5]}, motion: {vx: [[0, -0.01], [1e-4, -0.01], [1.0001e-4, "
    "0.1]], vy: 0}}\n"
    "time: {step: 1e-8, end: 1}\nrun: {threads: %d, precision: %s}\n";

/* Times at which the bonds 0-3 and 1-4 broke in shear, as tangential forces; they grow by k_t v t.
 */
static void shear_at_breaks(const char *confinement, const char *precision, double force[2]) {
    gn_world *w = world_of(rows, "", confinement, "", 1, precision);
    run_steps(w, 25000);
    const gn_contacts *b = &w->dem.bonds.contacts;
    force[0] = force[1] = -1.0;
    for (size_t c = 0; c < b->soa.count; c++) {
        int32_t i = w->dem.particles.id[b->i[c]], j = w->dem.particles.id[b->j[c]];
        int32_t low = i < j ? i : j, high = i < j ? j : i;
        if (high != low + 3 || low > 1) continue;
        assert_int_equal(b->cause[c], GN_BROKEN_SHEAR);
        force[low] = 4e6 * 0.1 * (b->broken_time[c] - 1.00005e-4);
    }
    world_end(w);
}

/* A row's bonds carry 10 N each. The line between the rows rotates by at most 1e-2, which changes
 * its length, and with it the pressure, by 5e-5 of itself: 1 N in 20; a quarter of a newton is
 * allowed. */
static void friction_may_see_the_mean_stress_around_a_bond(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        double own[2], mean[2];
        const char *precision = k ? "mixed" : "double";
        shear_at_breaks("own", precision, own);
        shear_at_breaks("mean", precision, mean);
        for (int c = 0; c < 2; c++) assert_near(own[c], 12.0, 0.25);
        assert_near(mean[0], 12.0 + 0.9 * 10.0 / 2.0, 0.25);
        assert_near(mean[1], 12.0 + 0.9 * 2.0 * 10.0 / 3.0, 0.25);
    }
}

static void the_mean_stress_is_the_same_for_any_threads_and_absent_else(void **state) {
    (void)state;
    gn_world *one = world_of(rows, "", "mean", "", 1, "double");
    gn_world *two = world_of(rows, "", "mean", "", 2, "double");
    gn_world *own = world_of(rows, "", "own", "", 1, "double");
    run_steps(one, 12000);
    run_steps(two, 12000);
    assert_int_equal(gn_world_hash(&one->ctx, &one->dem, &one->boundary, &one->solids, &one->box),
                     gn_world_hash(&two->ctx, &two->dem, &two->boundary, &two->solids, &two->box));
    for (size_t c = 0; c < one->dem.bonds.contacts.soa.count; c++) {
        assert_true(one->dem.bonds.contacts.confined[c] > 0.0);
        assert_near(one->dem.bonds.contacts.confined[c], two->dem.bonds.contacts.confined[c], 0.0);
    }
    assert_null(own->dem.bonds.contacts.confined);
    assert_null(own->dem.bonds.contacts.section);
    assert_null(own->dem.around);
    world_end(one);
    world_end(two);
    world_end(own);
}

/* --- scenes --- */

static const char *const crushed =
    "dimension: %d\n"
    "specimen: {lattice: {kind: %s, radius: 1e-3, cells: [4, 4, %d], spacing: 0.99, jitter: "
    "0.02}}\n"
    "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
    "tensile_strength: 1e6, shear_strength: 1e6%s}]\n"
    "law: {stiffness: harmonic%s}\nbonds: {interaction_range: 0.05}\n"
    "damping: {contact: {restitution: 0.8}}\n"
    "sets:\n"
    "  - {name: low, select: {end: {axis: x, side: lower, depth: 1.2e-3}}, motion: {vx: 2}}\n"
    "  - {name: high, select: {end: {axis: x, side: upper, depth: 1.2e-3}}, motion: {vx: -2}}\n"
    "time: {end: 1}\nrun: {threads: %d, precision: %s}\n";

static gn_world *crush(int dimension, const char *key, const char *law, int threads,
                       const char *precision) {
    return world_of(crushed, dimension, dimension == 3 ? "fcc" : "hexagonal", 6, key, law, threads,
                    precision);
}

static void without_its_keys_the_linear_kernel_runs(void **state) {
    (void)state;
    gn_world *w = crush(3, "", "", 1, "double");
    assert_int_equal(w->ctx.effects & (GN_FX_MOHR | GN_FX_COUPLED_LINEAR | GN_FX_COUPLED_QUADRATIC),
                     0);
    assert_null(w->dem.bonds.contacts.mu1);
    world_end(w);
}

static void a_vanishing_friction_of_bonds_is_the_linear_law(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++) {
        const char *precision = mixed ? "mixed" : "double";
        gn_world *a = crush(3, "", "", 1, precision);
        gn_world *b = crush(3, ", bond_friction: 1e-30", "", 1, precision);
        assert_true(b->ctx.effects & GN_FX_MOHR);
        run_steps(a, 400);
        run_steps(b, 400);
        assert_true(a->dem.broken_shear > 10);
        assert_int_equal(a->dem.broken_shear, b->dem.broken_shear);
        assert_int_equal(gn_world_hash(&a->ctx, &a->dem, &a->boundary, &a->solids, &a->box),
                         gn_world_hash(&b->ctx, &b->dem, &b->boundary, &b->solids, &b->box));
        world_end(a);
        world_end(b);
    }
}

static void the_ledger_closes_while_bonds_break(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int c = 0; c < 3; c++) {
            static const char *const laws[] = {"", ", coupling: quadratic", ", coupling: linear"};
            gn_world *w = crush(dimension, ", bond_friction: 0.9", laws[c], 1, "double");
            run_steps(w, 600);
            assert_true(w->dem.broken_shear + w->dem.broken_tension > 10);
            gn_energy e = measured_step(w);
            assert_true(fabs(gn_energy_residual(&e)) < 2e-3);
            assert_true(e.bond_breaking > 0.0);
            world_end(w);
        }
}

static void threads_give_the_same_bits(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++) {
        const char *precision = mixed ? "mixed" : "double";
        gn_world *a = crush(3, ", bond_friction: 0.9", ", coupling: quadratic", 1, precision);
        gn_world *b = crush(3, ", bond_friction: 0.9", ", coupling: quadratic", 2, precision);
        run_steps(a, 400);
        run_steps(b, 400);
        assert_true(a->dem.broken_shear > 10);
        assert_int_equal(gn_world_hash(&a->ctx, &a->dem, &a->boundary, &a->solids, &a->box),
                         gn_world_hash(&b->ctx, &b->dem, &b->boundary, &b->solids, &b->box));
        world_end(a);
        world_end(b);
    }
}

/* A scene with all other options: two materials, walls, gravity, a periodic direction, dampings,
 * orientations. */
static const char *const busy =
    "dimension: 3\n"
    "specimen: {lattice: {kind: fcc, radius: 1e-3, cells: [4, 4, 5], spacing: 0.99, jitter: 0.02},"
    " material: a}\n"
    "materials:\n"
    "  - {name: a, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
    "tensile_strength: 1e6, shear_strength: 1e6, bond_friction: 0.9}\n"
    "  - {name: b, density: 2650, contact_modulus: 2e9, kratio: 3, friction: 0.3, "
    "tensile_strength: 2e6, shear_strength: 1e6, bond_friction: 0.2}\n"
    "law: {stiffness: arithmetic, coupling: linear}\nbonds: {interaction_range: 0.05}\n"
    "damping: {contact: {restitution: 0.8}, background: {model: viscous, coefficient: 100}}\n"
    "gravity: [0, 0, -9.81]\n"
    "periodic: {min: [-1, 0, -1], max: [1, 1.12e-2, 1]}\n"
    "sets:\n"
    "  - {name: some, select: {ids: [3, 40, 41, 42, 60]}, material: b}\n"
    "walls:\n"
    "  - {name: low, point: [0, 0, -1e-3], normal: [0, 0, 1], stiffness: 1e6, kratio: 2, "
    "friction: 0.4, motion: {vz: 4}}\n"
    "  - {name: high, point: [0, 0, 15e-3], normal: [0, 0, -1], stiffness: 1e6, motion: {vz: -4}}\n"
    "time: {end: 1}\noutput: {orientation: on}\nrun: {threads: %d, precision: %s}\n";

static void beside_all_else_threads_and_resumption_give_the_same_bits(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++) {
        const char *precision = mixed ? "mixed" : "double";
        gn_run *a = run_of(busy, 1, precision), *b = run_of(busy, 2, precision);
        run_steps(&a->world, 400);
        run_steps(&b->world, 400);
        assert_true(a->world.dem.broken_shear > 10);
        end_alike(a, b, 0, 200, 5e-3);
    }
}

/* The angle may be given for materials, for pairs and for walls. */
static void an_angle_of_friction_stands_for_its_tangent(void **state) {
    (void)state;
    gn_scene scene;
    gneiss_error error = {0};
    const char *const words =
        "specimen: {particles: [[0, 0, 0, 1e-3]]}\nbonds: {}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, friction: 20 "
        "deg, "
        "bond_friction: 0.7330382858376184 rad, bond_tension_limit: 1, bond_shear_limit: 1}]\n"
        "contacts: [{between: m, bond_friction: 45 deg}]\n"
        "walls: [{name: w, point: [0, 0, -1e-3], normal: [0, 0, 1], stiffness: 1e6, kratio: 2, "
        "friction: 0 deg}]\nlaw: {stiffness: uniform}\ntime: {end: 1}\n";
    if (gn_scene_parse(words, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    assert_near(scene.materials[0].friction, 0.36397023426620234, 1e-15);
    assert_near(scene.materials[0].bond_friction, 0.9004040442978399, 1e-15); /* 42 degrees */
    assert_near(scene.contacts[0].bond_friction, 1.0, 1e-15);
    assert_near(scene.walls[0].friction, 0.0, 0.0);
    gn_scene_free(&scene);
}

static void bad_values_are_refused_at_their_place(void **state) {
    (void)state;
    static const struct {
        const char *material, *law, *says;
    } bad[] = {
        {"bond_friction: -1", "stiffness: uniform", "s.yaml:2:89: materials[0].bond_friction"},
        {"bond_friction: 0.5 N", "stiffness: uniform", "s.yaml:2:89: materials[0].bond_friction"},
        {"bond_friction: 90 deg", "stiffness: uniform",
         "bond_friction: expected a coefficient such as '0.5' or an angle of friction such as '30 "
         "deg', found '90 deg' (expected an angle in [0, 90) deg)"},
        {"bond_friction: -1 deg", "stiffness: uniform", "(expected an angle in [0, 90) deg)"},
        {"friction: 1", "stiffness: uniform, coupling: cubic",
         "s.yaml:3:37: law.coupling: expected one of none, quadratic, linear, found 'cubic'"},
        {"bond_friction: 0", "stiffness: uniform, coupling: linear",
         "s.yaml:3:37: law.coupling: expected a bond_friction above 0"},
        {"bond_friction: 0", "stiffness: uniform, confinement: mean",
         "s.yaml:3:40: law.confinement: expected a bond_friction above 0"},
        {"bond_friction: 1", "stiffness: uniform, confinement: all",
         "s.yaml:3:40: law.confinement: expected one of own, mean, found 'all'"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char words[1024];
        gn_world w;
        gneiss_error error = {0};
        snprintf(words, sizeof words,
                 "specimen: {particles: [[0, 0, 0, 1e-3]]}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e7, kratio: 2.5, %s, "
                 "bond_tension_limit: 1, bond_shear_limit: 1}]\n"
                 "law: {%s}\nbonds: {}\ntime: {end: 1}\n",
                 bad[k].material, bad[k].law);
        assert_int_equal(world_try(&w, words, NULL, &error), GNEISS_ERROR_INPUT);
        if (!strstr(error.message, bad[k].says)) fail_msg("%s", error.message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressure_makes_a_bond_stronger_in_shear),
        cmocka_unit_test(tension_leaves_the_shear_strength_unless_coupled),
        cmocka_unit_test(quadratic_coupling_adds_the_squares_of_both_shares),
        cmocka_unit_test(linear_coupling_takes_the_friction_of_the_pull),
        cmocka_unit_test(in_mixed_precision_a_bond_breaks_at_the_same_force),
        cmocka_unit_test(friction_strengthens_bonds_with_moments_alike),
        cmocka_unit_test(an_angle_of_friction_stands_for_its_tangent),
        cmocka_unit_test(friction_may_see_the_mean_stress_around_a_bond),
        cmocka_unit_test(the_mean_stress_is_the_same_for_any_threads_and_absent_else),
        cmocka_unit_test(without_its_keys_the_linear_kernel_runs),
        cmocka_unit_test(a_vanishing_friction_of_bonds_is_the_linear_law),
        cmocka_unit_test(the_ledger_closes_while_bonds_break),
        cmocka_unit_test(threads_give_the_same_bits),
        cmocka_unit_test(beside_all_else_threads_and_resumption_give_the_same_bits),
        cmocka_unit_test(bad_values_are_refused_at_their_place),
    };
    return cmocka_run_group_tests_name("mohr", tests, NULL, NULL);
}
