/* Rigid bodies with a weight that is given, and with spins that are free one by one. */
#include "surface_helpers.h"

#include "run/run.h"

static const char head[] =
    "dimension: 3\nspecimen: {particles: [[50, 0, 0, 1]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1, kratio: 2}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
    "run: {threads: 1}\n";
#define STEPS "time: {step: 1e-3, end: 1}\n"

/* --- mass and inertia --- */

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

/* If the centre is given as well as the weight, nothing is computed from the surface. */
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
    assert_true(fabs(gn_energy_residual(&w->ledger.reading)) < 1e-12);
    world_end(w);
}

/* --- one axis: a door --- */

/* A sphere hits a box that can only rotate about z. Its rebound depends on that axis alone: J = (1
 * + e) v/(1/m + x^2/I_z), spin x J/I_z. */
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
        assert_true(fabs(gn_energy_residual(&w->ledger.reading)) < 1e-4);
        world_end(w);
    }
}

/* --- two axes --- */

/* The body rotates freely about x and y while z is held by bearings, which do no work: energy and
 * the two components of the angular momentum are conserved. */
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

/* --- bearings that turn --- */

/* A free body on which only bearings act. */
static gn_world *driven(const char *body, double dt) {
    return world_of("%sbodies: [{name: b, stiffness: 1, free: true, %s}]\ntime: {step: %.17g, end: "
                    "99}\n",
                    head, body, dt);
}

/* A top of moments A, A, C leans by th from the z axis, about which it is driven with p. If the x
 * and y components of its angular momentum are zero, its spin about the horizontal axis in the
 * plane of the lean is -(C - A) p sin cos/(A cos2 + C sin2), with cos2 of the lean; it keeps its
 * lean, precesses with p C/(A cos2 + C sin2), and bearings do no work. */
static void a_driven_top_precesses(void **state) {
    (void)state;
    const double height[2] = {0.3, 2.0}, lean = 0.6, p = 3.0, dt = 1e-3;
    for (int k = 0; k < 2; k++) {
        double A = (1 + height[k] * height[k]) / 12, C = 1.0 / 6, s = sin(lean), c = cos(lean);
        double aside = -(C - A) * p * s * c / (A + (C - A) * s * s);
        double round = p * C / (A + (C - A) * s * s);
        char text_of[256];
        snprintf(text_of, sizeof text_of,
                 "mass: 1, box: {size: [1, 1, %g]}, rotation: [0, %.17g, 0], initial_spin: "
                 "[%.17g, 0, 0], motion: {wz: %g}",
                 height[k], lean, aside, p);
        gn_world *w = driven(text_of, dt);
        const gn_rigid *b = w->boundary.bodies;
        int own = fabs(b->inertia[0] - C) < 1e-9 ? 0 : 2; /* sorted */
        double sign = b->axes[6 + own] > 0 ? 1.0 : -1.0;
        for (int n = 0; n < 4000; n++) measured_step(w);
        double t = 4000 * dt, at[3] = {s * cos(round * t), s * sin(round * t), c};
        for (int a = 0; a < 3; a++) assert_near(sign * b->axes[3 * a + own], at[a], 2e-5);
        assert_near(b->spin[0], aside * cos(round * t), 1e-4);
        assert_near(b->spin[1], aside * sin(round * t), 1e-4);
        assert_true(b->spin[2] == p);
        assert_near(w->ledger.reading.work_walls / w->ledger.reading.rotational, 0.0, 1e-6);
        world_end(w);
    }
}

/* A bar and a brick, driven about z with x and y free: no moment acts about x and y, so that their
 * angular momentum is constant to the bit, and the energy changes by the work of the bearing, which
 * at a constant spin is the spin times the gain of the momentum about z. */
static double driven_residual(const char *size, double dt, double *change) {
    char text_of[256];
    snprintf(text_of, sizeof text_of,
             "mass: 1, box: {size: [%s]}, rotation: [0.3, 0.4, -0.7], initial_spin: [3, -2, 0], "
             "motion: {wz: 4}",
             size);
    gn_world *w = driven(text_of, dt);
    const gn_rigid *b = w->boundary.bodies;
    double kept[2] = {b->momentum[0], b->momentum[1]}, worst = 0.0, start = 0.0, most = 0.0;
    *change = 0.0;
    while (w->ctx.time < 4.0) {
        gn_energy e = measured_step(w);
        if (w->ctx.step == 1) start = e.rotational;
        most = fmax(most, e.rotational);
        *change = fmax(*change, fabs(e.rotational - start));
        worst = fmax(worst, fabs(e.rotational - start - e.work_walls));
    }
    assert_true(b->momentum[0] == kept[0] && b->momentum[1] == kept[1]);
    world_end(w);
    *change /= most;
    return worst / most;
}

static void the_work_of_bearings_is_in_the_ledger(void **state) {
    (void)state;
    static const char *const size[] = {"0.2, 0.2, 2", "1, 2, 3"};
    for (int k = 0; k < 2; k++) {
        double change, coarse = driven_residual(size[k], 2e-4, &change),
                       fine = driven_residual(size[k], 1e-4, &change);
        print_message("# energy goes by %.2g, unexplained %.2g, with half the step %.2g\n", change,
                      coarse, fine);
        assert_true(change > 0.1 && fine < 1e-6);
        assert_true(fabs(coarse / fine - 4.0) < 0.8);
    }
}

/* A wheel rotates about its own axis: the work of a bearing that accelerates it to p and
 * decelerates it to p/3 is C p^2/2 and C p^2/18, for any step. Further tests: two bearings; a
 * bearing that is rotated by a table, beside a free axis. */
static void a_wheel_is_spun_up(void **state) {
    (void)state;
    gn_world *w = driven("mass: 1, box: {size: [1, 1, 1]}, inertia: [2, 2, 3], motion: {wz: [[0, "
                         "0], [1, 6], [2, 2]]}",
                         7e-3);
    for (int k = 1; k <= 2; k++) {
        while (w->ctx.time < k) measured_step(w);
        double p = w->boundary.bodies[0].spin[2];
        gn_energy e = measured_step(w);
        assert_close(e.work_walls, 1.5 * p * p, 0.02);
        assert_near(gn_energy_residual(&e), 0.0, 1e-13);
    }
    world_end(w);
    w = driven("mass: 1, box: {size: [1, 2, 3]}, rotation: [0.3, 0.4, -0.7], "
               "motion: {wz: [[0, 0], [1, 6], [2, -2]], wx: 1.5}",
               1e-3);
    double worst = 0.0;
    while (w->ctx.time < 4.0) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    print_message("# two bearings: %.2g\n", worst);
    world_end(w);
    assert_true(worst < 1e-5);
}

/* The driven angle per ten steps goes from very small to a radian, for a hundred thousand steps:
 * the error does not grow. */
static void a_driven_body_turns_for_long(void **state) {
    (void)state;
    const double spin[] = {1e-6, 1.0, 100.0};
    for (int k = 0; k < 3; k++) {
        char text_of[256];
        snprintf(text_of, sizeof text_of,
                 "mass: 1, box: {size: [1, 2, 3]}, rotation: [0.3, 0.4, -0.7], initial_spin: [%g, "
                 "0, 0], motion: {wz: %g}",
                 0.3 * spin[k], spin[k]);
        gn_world *w = driven(text_of, 1e-3);
        double worst[2] = {0, 0};
        for (int n = 0; n < 100000; n++) {
            gn_energy e = measured_step(w);
            double off = fabs(gn_energy_residual(&e));
            worst[n / 50000] = fmax(worst[n / 50000], off);
        }
        print_message("# %g rad/s: %.3g, then %.3g\n", spin[k], worst[0], worst[1]);
        assert_true(worst[1] < 1.1 * worst[0] + 1e-9);
        assert_true(worst[1] < (k == 2 ? 1e-2 : 1e-6));
        world_end(w);
    }
}

/* A paddle among spheres. A bearing prescribes its rotation about z; springs of walls and grains
 * restrain the other components. */
static const char stirred[] =
    "dimension: 3\nspecimen: {lattice: {kind: hcp, radius: 2e-3, cells: [8, 5, 2], origin: "
    "[2.2e-3, 2.2e-3, 2.2e-3], jitter: 0.02, spacing: 1.03}, group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 2e4, kratio: 2, friction: 0.3}]\n"
    "law: {stiffness: uniform}\ngravity: [0, 0, -10]\ndamping: {contact: {restitution: 0.5}}\n"
    "walls:\n  - {name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e4, kratio: 2, "
    "friction: 0.3}\n"
    "  - {name: a, point: [0, 0, 0], normal: [1, 0, 0], stiffness: 2e4}\n"
    "  - {name: b, point: [0, 0, 0], normal: [0, 1, 0], stiffness: 2e4}\n"
    "  - {name: c, point: [42e-3, 0, 0], normal: [-1, 0, 0], stiffness: 2e4}\n"
    "  - {name: d, point: [0, 42e-3, 0], normal: [0, -1, 0], stiffness: 2e4}\n"
    "bodies:\n  - {name: b1, box: {size: [20e-3, 6e-3, 8e-3]}, origin: [8e-3, 14e-3, 19e-3], "
    "rotation: [0.2, 0.1, 0], stiffness: 2e4, kratio: 2, friction: 0.3, free: true, density: "
    "2000, motion: {wz: [[0, 0], [0.05, 40]]}}\n"
    "  - {name: b2, box: {size: [8e-3, 8e-3, 8e-3]}, origin: [14e-3, 13e-3, 31e-3], stiffness: "
    "2e4, kratio: 2, friction: 0.3, free: true, density: 2000, motion: {wx: 5, wy: 0}}\n"
    "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {end: 1}\nrun: {threads: %d}\n";

static void stirred_run(gn_run *run, int threads) {
    char scene_text[4096];
    snprintf(scene_text, sizeof scene_text, stirred, threads);
    gn_scene scene;
    gneiss_error error = {0};
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, run, &error), &error);
}

static void a_paddle_stirs_grains(void **state) {
    (void)state;
    const char *const saved = "/tmp/gneiss-body-spins.h5";
    gn_run straight, stopped, resumed;
    gneiss_error error = {0};
    stirred_run(&straight, 3);
    stirred_run(&stopped, 1);
    double worst = 0.0;
    while (stopped.world.ctx.time < 0.1) {
        gn_energy e = measured_step(&stopped.world);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    const gn_energy *e = &stopped.world.ledger.reading;
    print_message("# stirred: work %.3g of %.3g J, residual %.3g\n", e->work_walls,
                  gn_energy_scale(e), worst);
    assert_true(e->work_walls > 0.1 * gn_energy_scale(e) && worst < 1e-3);
    assert_ok(gn_checkpoint_write(&stopped, saved, &error), &error);
    assert_ok(gn_checkpoint_load(saved, NULL, 0, &resumed, &error), &error);
    run_steps(&resumed.world, 1000);
    run_steps(&straight.world, resumed.world.ctx.step);
    assert_true(gn_world_hash(&straight.world.ctx, &straight.world.dem, &straight.world.boundary,
                              &straight.world.solids, &straight.world.box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    assert_true(straight.world.ledger.energy.work_walls == resumed.world.ledger.energy.work_walls);
    gn_run_free(&straight);
    gn_run_free(&stopped);
    gn_run_free(&resumed);
    unlink(saved);
}

/* --- refused input --- */

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
    refuse("free: true, mass: 1, inertia: [1, 1, 3]", "bodies[0].inertia", "this is impossible");
    refuse("free: true, mass: 1, inertia: [1, 1, 0]", "bodies[0].inertia", "expected");
    refuse("free: true, mass: 1, reference: [0, 0, 0]", "bodies[0].reference", "no inertia");
    refuse("free: true, density: 1, inertia: [1, 1, 1], reference: [0, 0, 0]",
           "bodies[0].reference", "no mass");
    refuse("free: true, mass: 1, motion: {wx: 2}, initial_spin: [1, 0, 0]",
           "bodies[0].initial_spin", "motion.wx");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_weight_may_be_given),
        cmocka_unit_test(an_open_body_may_be_free),
        cmocka_unit_test(a_door_is_hit),
        cmocka_unit_test(bearings_do_no_work),
        cmocka_unit_test(a_driven_top_precesses),
        cmocka_unit_test(the_work_of_bearings_is_in_the_ledger),
        cmocka_unit_test(a_wheel_is_spun_up),
        cmocka_unit_test(a_driven_body_turns_for_long),
        cmocka_unit_test(a_paddle_stirs_grains),
        cmocka_unit_test(errors_say_where_and_what),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
