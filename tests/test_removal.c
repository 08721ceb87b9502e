/* Particles that leave the domain: their energy and that of their contacts leave the ledger with
 * them, and their bonds are not broken. */
#include "world_helpers.h"

#include "run/history_rows.h"

/* Runs until `count` particles have left, and 10 more steps; returns the ledger then. */
static gn_energy run_until_lost(gn_world *w, int64_t count) {
    measured_step(w);
    while (w->dem.lost < count && w->ctx.step < 1000000) run_steps(w, 1);
    assert_int_equal(w->dem.lost, count);
    run_steps(w, 10);
    return measured_step(w);
}

static const double g0 = 9.81;

/* A grain on the wall with the overlap of its weight drifts across x = 10 mm. */
static void the_elastic_energy_at_a_wall_leaves_with_the_grain(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        bool space = dimension == 3;
        double m = space ? sphere_mass(2500, 1e-3) : disc_mass(2500, 1e-3), k = 1000, v = 0.2;
        double depth = m * g0 / k;
        gn_world *w = world_of(
            "dimension: %d\nspecimen: {particles: [[9e-3%s, %.17g, 1e-3]]}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: 1000, kratio: 2}]\n"
            "law: {stiffness: uniform}\ngravity: [0%s, -9.81]\n"
            "walls: [{name: f, point: [0, 0%s], normal: [0%s, 1], stiffness: %g}]\n"
            "sets: [{name: a, select: {ids: [0]}, initial_velocity: [%g, 0%s]}]\n"
            "domain: {min: [-1, -1%s], max: [10e-3, 1%s], lost: remove}\n"
            "time: {end: 1}\nrun: {threads: 1}\n",
            dimension, space ? ", 0" : "", 1e-3 - depth, space ? ", 0" : "", space ? ", 0" : "",
            space ? ", 0" : "", k, v, space ? ", 0" : "", space ? ", -1" : "", space ? ", 1" : "");
        gn_energy e = run_until_lost(w, 1);
        /* The overlap is rounded by some ulps of the radius, 1e-19 m; it oscillates by as much. */
        double pressed = 0.5 * k * depth * depth, allowed = 100 * 2.2e-16 * 1e-3 / depth;
        assert_close(e.removed, 0.5 * m * v * v + pressed, allowed);
        assert_near(gn_energy_residual(&e), 0.0, allowed);
        world_end(w);
    }
}

/* Both particles are driven, so that the bond keeps its length; the second leaves. */
static void the_elastic_energy_of_a_bond_leaves_with_the_grain(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        bool space = dimension == 3;
        double m = space ? sphere_mass(2500, 1e-3) : disc_mass(2500, 1e-3), k = 1e6, s = 1e-4;
        const char *z = space ? ", 0" : "", *vz = space ? ", vz: 0" : "";
        gn_world *w = world_of(
            "dimension: %d\nspecimen: {particles: [[0, 0%s, 1e-3], [2.1e-3, 0%s, 1e-3]]}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: %g, kratio: 2, "
            "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\n"
            "law: {stiffness: uniform}\nbonds: {interaction_range: 0.1, passive_gaps: false}\n"
            "sets: [{name: a, select: {all: true}, motion: {vx: 1, vy: 0%s}}]\n"
            "domain: {min: [-1, -1%s], max: [4e-3, 1%s], lost: remove}\n"
            "time: {end: 1}\nrun: {threads: 1}\n",
            dimension, z, z, k, vz, space ? ", -1" : "", space ? ", 1" : "");
        gn_energy e = run_until_lost(w, 1);
        /* Steps of some 1e-6 m are rounded by 1e-18 m, some thousand times; s is 1e-4 m. */
        assert_close(e.removed, 0.5 * m + 0.5 * k * s * s, 1e-10);
        assert_near(gn_energy_residual(&e), 0.0, 1e-10);
        world_end(w);
    }
}

static double column(const gn_history *h, const char *name) {
    const double *value = gn_history_column(h, name);
    assert_non_null(value);
    return value[h->row_count - 1];
}

/* Three in a row, and the last leaves without any force: one bond is removed, the other remains. */
static void a_bond_that_left_is_neither_broken_nor_damage(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\n"
        "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], [4e-3, 0, 0, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "
        "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\n"
        "law: {stiffness: uniform}\nbonds: {}\n"
        "sets: [{name: a, select: {all: true}, initial_velocity: [1, 0, 0]}]\n"
        "domain: {min: [-1, -1, -1], max: [6e-3, 1, 1], lost: remove}\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
    gneiss_error error = {0};
    gn_history h;
    double damage[3];
    run_until_lost(w, 1);
    assert_int_equal(gn_history_create_columns(w, &h, &error), GNEISS_OK);
    assert_int_equal(gn_history_record_step(w, &h, &error), GNEISS_OK);
    assert_true(column(&h, "bonds_intact") == 1.0 && column(&h, "damage") == 0.0);
    assert_true(column(&h, "broken_tension") == 0.0 && column(&h, "broken_shear") == 0.0);
    assert_int_equal(w->dem.bonds.contacts.cause[0], GN_INTACT);
    assert_int_equal(w->dem.bonds.contacts.cause[1], GN_BOND_LEFT);
    assert_true(w->dem.bonds.contacts.broken_time[1] > 0.0);
    gn_damage_particles(&w->dem.particles, &w->dem.bonds.contacts, damage);
    for (int p = 0; p < 3; p++) assert_true(damage[p] == 0.0);
    gn_history_free(&h);
    world_end(w);
}

/* A particle that moves while it is removed is in the middle of a step. The error of the ledger
 * after it is at most rounding (some 1e-16 of the scale per step), whichever part of the contacts
 * stores the energy; the steps before may have errors of their order. */
static void closes(const char *what, const char *scene, int64_t lost) {
    gn_world *w = world_of("%stime: {end: 1, safety: 0.1}\nrun: {threads: 1}\n", scene);
    double before = 0.0, leaving = 0.0;
    gn_energy e = {0};
    while (w->dem.lost < lost && w->ctx.step < 10000) {
        e = measured_step(w);
        leaving = gn_energy_residual(&e) - before;
        before = gn_energy_residual(&e);
    }
    assert_int_equal(w->dem.lost, lost);
    assert_true(e.removed > 0.0);
    if (!(fabs(leaving) <= 1e-12)) fail_msg("%s: off by %g", what, leaving);
    world_end(w);
}

static const char material[] =
    "materials: [{name: m, density: 2500, normal_stiffness: 1e5, kratio: 2, friction: 0.5, "
    "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\nlaw: {stiffness: uniform}\n";

/* The pair is stretched, sheared and rotating; the second particle leaves. */
static void a_swinging_bonded_pair_closes_the_ledger(void **state) {
    (void)state;
    char scene[2048];
    for (int dimension = 2; dimension <= 3; dimension++) {
        bool space = dimension == 3;
        snprintf(scene, sizeof scene,
                 "dimension: %d\n%sbonds: {}\n"
                 "specimen: {particles: [[0, 0%s, 1e-3], [2e-3, 0%s, 1e-3]]}\n"
                 "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [1, 0%s]}\n"
                 "  - {name: b, select: {ids: [1]}, initial_velocity: [1.2, 0.1%s]}\n"
                 "domain: {min: [-1, -1%s], max: [5e-3, 1%s], lost: remove}\n",
                 dimension, material, space ? ", 0" : "", space ? ", 0" : "", space ? ", 0" : "",
                 space ? ", 0.05" : "", space ? ", -1" : "", space ? ", 1" : "");
        closes(space ? "in space" : "in the plane", scene, 1);
    }
}

/* The pair moves side by side, with the bond stretched across the direction of motion. */
static void a_bond_is_removed_once_if_both_grains_are_removed_together(void **state) {
    (void)state;
    char scene[2048];
    snprintf(scene, sizeof scene,
             "%sbonds: {}\nspecimen: {particles: [[0, 0, 0, 1e-3], [0, 2e-3, 0, 1e-3], "
             "[-9e-3, 0, 0, 1e-3]]}\n"
             "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [1, 0, 0]}\n"
             "  - {name: b, select: {ids: [1]}, initial_velocity: [1, 0.5, 0]}\n"
             "domain: {min: [-1, -1, -1], max: [3e-3, 1, 1], lost: remove}\n",
             material);
    closes("both", scene, 2);
}

static void a_damped_contact_closes_the_ledger(void **state) {
    (void)state;
    char scene[2048];
    snprintf(scene, sizeof scene,
             "%sbonds: {}\ndamping: {contact: {fraction: 0.2}}\n"
             "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
             "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [1, 0, 0]}\n"
             "  - {name: b, select: {ids: [1]}, initial_velocity: [1.2, 0.1, 0]}\n"
             "domain: {min: [-1, -1, -1], max: [3e-3, 1, 1], lost: remove}\n",
             material);
    closes("damped", scene, 1);
}

/* Unbonded particles collide off centre, with friction, and the first leaves during the contact. */
static void a_collision_that_is_left_closes_the_ledger(void **state) {
    (void)state;
    static const char *const dashpots[] = {"", "damping: {contact: {fraction: 0.2}}\n"};
    char scene[2048];
    for (int k = 0; k < 2; k++) {
        snprintf(scene, sizeof scene,
                 "%slaw: {stiffness: uniform}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 100, kratio: 2, "
                 "friction: 0.5}]\n"
                 "specimen: {particles: [[0, 0, 0, 1e-3], [2.001e-3, 0.4e-3, 0, 1e-3]], "
                 "group: 0}\n"
                 "sets:\n  - {name: a, select: {ids: [0]}, initial_velocity: [3, 0, 0]}\n"
                 "  - {name: b, select: {ids: [1]}, initial_velocity: [2.5, 0, 0.2]}\n"
                 "domain: {min: [-1, -1, -1], max: [3e-3, 1, 1], lost: remove}\n",
                 dashpots[k]);
        closes(k ? "with a dashpot" : "without", scene, 1);
    }
}

/* A grain slides and rolls on a floor, and oscillates on it. */
static void slides_over(const char *what, const char *floor) {
    char scene[2048];
    snprintf(scene, sizeof scene,
             "%s%sgravity: [0, 0, -50]\nspecimen: {particles: [[0.1e-3, 0.2e-3, 1e-3, 1e-3]], "
             "group: 0}\n"
             "sets: [{name: a, select: {ids: [0]}, initial_velocity: [1, 0.1, 0]}]\n"
             "domain: {min: [-1, -1, -1], max: [5e-3, 1, 1], lost: remove}\n",
             material, floor);
    closes(what, scene, 1);
}

static void a_grain_that_slides_closes_the_ledger(void **state) {
    (void)state;
    slides_over("on a wall", "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], "
                             "stiffness: 1e4, kratio: 2, friction: 0.3}]\n");
    slides_over("on a body", "bodies: [{name: b, box: {size: [1, 1, 0.1]}, "
                             "origin: [-0.5, -0.5, -0.1], stiffness: 1e4, kratio: 2, "
                             "friction: 0.3}]\n");
    slides_over("with a dashpot", "damping: {contact: {fraction: 0.2}}\n"
                                  "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], "
                                  "stiffness: 1e4, kratio: 2, friction: 0.3}]\n");
    slides_over("on a free body", "damping: {contact: {fraction: 0.2}}\n"
                                  "bodies: [{name: b, box: {size: [0.1, 0.1, 0.01]}, "
                                  "origin: [-0.05, -0.05, -0.01], stiffness: 1e4, kratio: 2, "
                                  "friction: 0.3, free: true, density: 2500}]\n");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_elastic_energy_at_a_wall_leaves_with_the_grain),
        cmocka_unit_test(the_elastic_energy_of_a_bond_leaves_with_the_grain),
        cmocka_unit_test(a_bond_that_left_is_neither_broken_nor_damage),
        cmocka_unit_test(a_swinging_bonded_pair_closes_the_ledger),
        cmocka_unit_test(a_bond_is_removed_once_if_both_grains_are_removed_together),
        cmocka_unit_test(a_damped_contact_closes_the_ledger),
        cmocka_unit_test(a_collision_that_is_left_closes_the_ledger),
        cmocka_unit_test(a_grain_that_slides_closes_the_ledger),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
