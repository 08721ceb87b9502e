/* Rigid bodies with a weight that is given, and with spins that are free one by one. */
#include "surface_helpers.h"

#include "run/run.h"

static const char head[] =
    "dimension: 3\nspecimen: {particles: [[50, 0, 0, 1]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1, kratio: 2}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
    "run: {threads: 1}\n";
#define STEPS "time: {step: 1e-3, end: 1}\n"

/* --- what they weigh --- */

static void a_weight_may_be_given(void **state) {
    (void)state;
    gn_world *w = world_of(
        "%sbodies: [{name: b, box: {size: [1, 2, 3]}, stiffness: 1, free: true, "
        "mass: 60}, {name: c, box: {size: [1, 2, 3]}, origin: [0, 0, 9], stiffness: 1, free: true, "
        "mass: 7, inertia: [5, 4, 3]}]\n" STEPS,
        head);
    const gn_rigid *b = w->boundary.bodies;
    double least = fmin(b->inertia[0], fmin(b->inertia[1], b->inertia[2]));
    assert_close(b->mass, 60.0, 1e-15);
    assert_close(least, 60.0 * 5 / 12, 1e-12);
    assert_close(b[1].mass, 7.0, 1e-15);
    for (int a = 0; a < 3; a++) {
        assert_close(b[1].inertia[a], 5.0 - a, 1e-15);
        assert_close(b[1].position[a], 0.5 * (a + 1) + (a == 2 ? 9 : 0), 1e-12);
    }
    world_end(w);
}

/* With its centre as well nothing is asked of the surface. */
static void an_open_body_may_be_free(void **state) {
    (void)state;
    gn_world *w = world_of("%sgravity: [0, 0, -10]\nbodies: [{name: b, cylinder: {diameter: 1, "
                           "height: 2, open: true}, stiffness: 1, free: true, mass: 3, inertia: "
                           "[1, 1, 0.5], reference: [0, 0, 0.7]}]\n" STEPS,
                           head);
    const gn_rigid *b = w->boundary.bodies;
    for (int k = 0; k < 1000; k++) measured_step(w);
    assert_close(b->position[2], 0.7 - 5.0, 1e-12);
    assert_close(b->reach, sqrt(0.25 + 1.3 * 1.3), 1e-12);
    assert_true(fabs(gn_energy_residual(&w->reading)) < 1e-12);
    world_end(w);
}

/* --- one axis: a door --- */

/* A sphere hits a box that can only turn about z. What it rebounds with knows of that axis alone:
 * J = (1 + e) v/(1/m + x^2/I_z), spin x J/I_z. */
static void a_door_is_hit(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        double x = 1.5e-3, z = k % 2 ? 1e-3 : 0.0, e = k / 2 ? 0.4 : 1.0;
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[%g, 3.05e-3, %g, 1e-3]], group: 0}\n"
            "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
            "law: {stiffness: uniform}\ndamping: {contact: {restitution: %g}}\n"
            "bodies: [{name: b, box: {size: [6e-3, 4e-3, 4e-3]}, origin: [-3e-3, -2e-3, -2e-3], "
            "stiffness: 1e6, free: true, density: 2500, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: "
            "0}}]\n"
            "sets: [{name: a, select: {all: true}, initial_velocity: [0, -1, 0]}]\n"
            "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {step: 2e-8, end: 9}\n"
            "run: {threads: 1}\n",
            x, z, e);
        const gn_rigid *b = w->boundary.bodies;
        for (int n = 0; n < 10000; n++) measured_step(w);
        double mass = 2500 * 4. / 3 * 3.14159265358979 * 1e-9, inertia = 2500 * 96e-9 * 52e-6 / 12;
        double impulse = (1 + e) / (1 / mass + x * x / inertia);
        assert_near(vel_of(w, 0)[1], impulse / mass - 1.0, 0.01);
        assert_near(b->spin[2], -x * impulse / inertia, 0.01 * x * impulse / inertia);
        for (int a = 0; a < 2; a++) {
            assert_true(b->spin[a] == 0.0);
            assert_true(b->velocity[a] == 0.0);
        }
        assert_true(fabs(gn_energy_residual(&w->reading)) < 1e-4);
        world_end(w);
    }
}

/* --- two axes --- */

/* Turned about x and y while z is held by bearings, which do no work: energy and the two components
 * of the angular momentum stay. */
static double lost_energy(double dt) {
    gn_world *w = world_of("%sbodies: [{name: b, box: {size: [1, 2, 3]}, rotation: [0.3, 0.4, "
                           "-0.7], stiffness: 1, free: true, density: 10, initial_spin: [3, -2, "
                           "0], motion: {wz: 0}}]\ntime: {step: %g, end: 99}\n",
                           head, dt);
    gn_rigid *b = w->boundary.bodies;
    double kept[2], start, moved = 0.0, worst = 0.0;
    memcpy(kept, b->momentum, sizeof kept);
    start = measured_step(w).rotational;
    for (int n = 0; n < (int)(8.0 / dt); n++) {
        worst = fmax(worst, fabs(measured_step(w).rotational / start - 1.0));
        moved = fmax(moved, fabs(b->spin[0] - 3.0));
        assert_true(b->spin[2] == 0.0);
    }
    assert_true(b->momentum[0] == kept[0] && b->momentum[1] == kept[1]);
    assert_true(moved > 0.5);
    world_end(w);
    return worst;
}

static void bearings_do_no_work(void **state) {
    (void)state;
    double coarse = lost_energy(4e-3), fine = lost_energy(2e-3);
    assert_true(coarse < 1e-3);
    assert_true(fabs(coarse / fine - 4.0) < 0.8);
}

/* --- what is refused --- */

static void refuse(const char *body, const char *key, const char *what) {
    char scene_text[1024];
    gn_world w;
    gneiss_error error = {0};
    snprintf(scene_text, sizeof scene_text,
             "%s" STEPS "bodies: [{name: b, box: {size: [1, 1, 1]}, stiffness: 1, %s}]\n", head,
             body);
    if (world_try(&w, scene_text, "/tmp", &error) == GNEISS_OK)
        fail_msg("expected an error: %s", body);
    if (!strstr(error.message, key) || !strstr(error.message, what) ||
        !strstr(error.message, "s.yaml:8:"))
        fail_msg("expected '%s' and '%s' in '%s'", key, what, error.message);
}

static void errors_say_where_and_what(void **state) {
    (void)state;
    refuse("free: true", "bodies[0].density", "or its mass");
    refuse("free: true, mass: 1, density: 1", "bodies[0].mass", "found both");
    refuse("mass: 1", "bodies[0].mass", "free true");
    refuse("inertia: [1, 1, 1]", "bodies[0].inertia", "free true");
    refuse("free: true, mass: 1, inertia: [1, 1, 3]", "bodies[0].inertia", "no body has that");
    refuse("free: true, mass: 1, inertia: [1, 1, 0]", "bodies[0].inertia", "expected");
    refuse("free: true, mass: 1, reference: [0, 0, 0]", "bodies[0].reference", "no inertia");
    refuse("free: true, density: 1, inertia: [1, 1, 1], reference: [0, 0, 0]",
           "bodies[0].reference", "no mass");
    refuse("free: true, mass: 1, motion: {wx: 2}", "bodies[0].motion.wx",
           "expected 0 beside spins that are free, found 2 rad/s");
    refuse("free: true, mass: 1, motion: {wx: 0}, initial_spin: [1, 0, 0]",
           "bodies[0].initial_spin", "motion.wx");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_weight_may_be_given),
        cmocka_unit_test(an_open_body_may_be_free),
        cmocka_unit_test(a_door_is_hit),
        cmocka_unit_test(bearings_do_no_work),
        cmocka_unit_test(errors_say_where_and_what),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
