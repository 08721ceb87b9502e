/* Bonded oscillators, damping, loads, prescribed motion and walls against closed forms; every run
 * keeps its energy ledger. */
#include "world_helpers.h"

static const double m0 = 2500.0 * 4.0 / 3.0 * 3.14159265358979323846 * 1e-9; /* sphere of 1 mm */
static const double k0 = 2e7;

/* Two bonded spheres of radius 1 mm along x; `more` holds sets, damping and time. */
static gn_world *bonded_pair(double dt, const char *more) {
    return world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
                    "materials: [{name: m, density: 2500, normal_stiffness: %g, kratio: 2, "
                    "bond_tension_limit: 1e30, bond_shear_limit: 1e30}]\n"
                    "law: {stiffness: uniform}\nbonds: {}\n%stime: {step: %.17g, end: 1000}\n"
                    "run: {threads: 1}\n",
                    k0, more, dt);
}

static void an_oscillating_pair_keeps_its_energy(void **state) {
    (void)state;
    double omega = sqrt(2.0 * k0 / m0);
    gn_world *w = bonded_pair(0.2 / omega, "sets:\n  - {name: a, select: {ids: [0]}, "
                                           "initial_velocity: [7, 0, 0]}\n"
                                           "  - {name: b, select: {ids: [1]}, "
                                           "initial_velocity: [-7, 0, 0]}\n");
    gn_energy e = measured_step(w);
    double start = gn_energy_stored(&e), largest = 0.0;
    assert_close(start, m0 * 49.0, 1e-12);
    for (int k = 0; k < 100; k++) {
        run_steps(w, 999);
        e = measured_step(w);
        largest = fmax(largest, fabs(gn_energy_residual(&e)));
        assert_true(e.friction == 0.0 && e.contact_damping == 0.0 && e.background_damping == 0.0);
    }
    /* Positions of 2 mm are rounded to 4e-19 m, the stretch oscillates by 5 um. */
    assert_true(largest < 1e-10);
    assert_true(e.elastic_normal > 0.0);
    world_end(w);
}

/* A mass on a bond to a held one: frequency sqrt(k/m) and the decay exp(-a t/2) of viscous damping.
 * The scheme's own frequency has an error of (w dt)^2/24. */
static void viscous_damping_lets_an_oscillator_decay_exponentially(void **state) {
    (void)state;
    double omega = sqrt(k0 / m0), fine = 0.02, a = 0.1 * omega, v = 1.0;
    char more[512];
    snprintf(more, sizeof more,
             "damping: {background: {model: viscous, coefficient: %.17g}}\n"
             "sets:\n  - {name: h, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0}}\n"
             "  - {name: a, select: {ids: [1]}, initial_velocity: [%g, 0, 0]}\n",
             a, v);
    gn_world *w = bonded_pair(fine / omega, more);
    double damped = sqrt(omega * omega - 0.25 * a * a), worst = 0.0;
    measured_step(w);
    while (w->ctx.time < 40.0 / omega) {
        run_steps(w, 1);
        double t = w->ctx.time, want = v / damped * exp(-0.5 * a * t) * sin(damped * t);
        double phase = omega * t * fine * fine / 24.0 + fine * fine;
        double off = fabs(pos_of(w, 1)[0] - 2e-3 - want) / (v / damped * exp(-0.5 * a * t));
        worst = fmax(worst, off / phase);
    }
    assert_true(worst < 1.0);
    gn_energy e = measured_step(w);
    assert_true(e.background_damping > 0.9 * 0.5 * m0 * v * v);
    assert_true(fabs(gn_energy_residual(&e)) < 1e-10);
    world_end(w);
}

/* --- non-viscous damping --- */

static gn_world *pushed_sphere(const char *model, double a) {
    return world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: %g, kratio: 2}]\n"
        "law: {stiffness: uniform}\ndamping: {background: {model: %s, coefficient: %g}}\n"
        "sets: [{name: a, select: {all: true}, force: [3e-3, -4e-3, 0]}]\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
        "time: {step: 5e-7, end: 1}\nrun: {threads: 1}\n",
        k0, model, a);
}

/* The first half kick starts from rest and is not damped; then the acceleration is (1 - a) F/m. */
static void nonviscous_damping_slows_a_push_by_its_fraction(void **state) {
    (void)state;
    static const char *const kinds[] = {"nonviscous_vector", "nonviscous_component"};
    for (int k = 0; k < 2; k++) {
        gn_world *w = pushed_sphere(kinds[k], 0.4);
        int64_t steps = 10000;
        double F[2] = {3e-3, -4e-3}, dt = w->ctx.dt;
        measured_step(w);
        run_steps(w, steps - 1);
        for (int a = 0; a < 2; a++) {
            double want = F[a] / m0 * dt * (0.5 + 0.6 * (double)(steps - 1));
            assert_close(vel_of(w, 0)[a], want, 2.2e-16 * 4.0 * (double)steps);
        }
        assert_true(vel_of(w, 0)[2] == 0.0);
        assert_true(spin_of(w, 0)[0] ==
                    0.0); /* without moment and spin there is no damping and no NaN */
        gn_energy e = measured_step(w);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-10);
        assert_close(e.background_damping / e.work_applied, 0.4, 2.0 / (double)steps);
        world_end(w);
    }
}

static void nonviscous_damping_books_what_an_oscillator_loses(void **state) {
    (void)state;
    static const char *const kinds[] = {"nonviscous_vector", "nonviscous_component"};
    for (int k = 0; k < 2; k++) {
        char more[512];
        snprintf(more, sizeof more,
                 "damping: {background: {model: %s, coefficient: 0.3}}\n"
                 "sets: [{name: a, select: {ids: [0]}, initial_velocity: [0.01, 0.003, 0]}]\n",
                 kinds[k]);
        gn_world *w = bonded_pair(0.02 / sqrt(2.0 * k0 / m0), more);
        gn_energy e = measured_step(w);
        double start = gn_energy_stored(&e), before = start;
        for (int n = 0; n < 40; n++) {
            run_steps(w, 99);
            e = measured_step(w);
            assert_true(e.background_damping >= 0.0);
            assert_true(gn_energy_stored(&e) <= before * (1.0 + 1e-6));
            before = gn_energy_stored(&e);
        }
        /* The pair drifts on with half the momentum; the oscillation is damped. */
        assert_true(e.background_damping > 0.3 * start);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-6);
        world_end(w);
    }
}

/* --- loads --- */

static void free_fall_is_the_exact_parabola(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++) {
        bool space = dimension == 3;
        gn_world *w =
            world_of("dimension: %d\nspecimen: {particles: [[0, %s1e-3]]}\n"
                     "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
                     "law: {stiffness: uniform}\ngravity: [%s-9.81]\ndomain: {min: [-99, -99%s], "
                     "max: [99, 99%s]}\n"
                     "sets: [{name: a, select: {all: true}, initial_velocity: [%s2.0]}]\n"
                     "time: {step: 4e-6, end: 1}\nrun: {threads: 1}\n",
                     dimension, space ? "0, 0, " : "0, ", space ? "0, 0, " : "0, ",
                     space ? ", -99" : "", space ? ", 99" : "", space ? "0, 0.5, " : "0.5, ");
        int64_t steps = 50000;
        run_steps(w, steps);
        double t = 4e-6 * (double)steps;
        /* The scheme is exact for a constant force; each step rounds x and v once or twice. */
        double allowed = 2.2e-16 * 2.0 * (double)steps * 2.0;
        int up = dimension - 1;
        assert_near(pos_of(w, 0)[up], 2.0 * t - 0.5 * 9.81 * t * t, allowed);
        assert_near(pos_of(w, 0)[up - 1], 0.5 * t, allowed);
        double height = pos_of(w, 0)[up];
        gn_energy e = measured_step(w);
        assert_true(fabs(gn_energy_residual(&e)) < 1e-10);
        assert_close(e.work_gravity, mass_of(w, 0) * -9.81 * height, 1e-10);
        world_end(w);
    }
}

static void an_applied_force_is_shared_by_mass(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [1e-2, 0, 0, 2e-3]]}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
                 "law: {stiffness: uniform}\n"
                 "sets: [{name: a, select: {all: true}, force: [0, 9e-3, 0]}]\n"
                 "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
                 "time: {step: 1e-6, end: 1}\nrun: {threads: 1}\n");
    run_steps(w, 10000);
    double want = 0.5 * 9e-3 / (9.0 * m0) * pow(w->ctx.time, 2);
    assert_close(pos_of(w, 0)[1], want, 2.2e-16 * 4e4);
    assert_close(pos_of(w, 1)[1], want, 2.2e-16 * 4e4);
    world_end(w);
}

/* One end is held, the other pulled at a constant velocity: the reactions are the spring force, and
 * the work equals the stored energy. */
static void reactions_of_prescribed_motion_are_the_spring_force(void **state) {
    (void)state;
    gn_world *w = bonded_pair(
        1e-7, "sets:\n  - {name: h, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0}}\n"
              "  - {name: d, select: {ids: [1]}, motion: {vx: 0.01, vy: 0, vz: 0}}\n");
    measured_step(w);
    run_steps(w, 9999);
    double u = pos_of(w, 1)[0] - pos_of(w, 0)[0] - 2e-3;
    gn_energy e = measured_step(w); /* reading at the instant at which the motion starts */
    assert_close(u, 0.01 * 1e-7 * 1e4, 1e-10);
    assert_close(w->dem.set_reaction[6], k0 * u, 1e-12);  /* pulls on */
    assert_close(w->dem.set_reaction[0], -k0 * u, 1e-12); /* the reaction acts against the motion */
    assert_close(e.work_prescribed, 0.5 * k0 * u * u, 1e-9);
    assert_close(e.elastic_normal, 0.5 * k0 * u * u, 1e-12);
    assert_true(fabs(gn_energy_residual(&e)) < 1e-9);
    world_end(w);
}

/* Driven by a table, with mass: the reaction is inertia plus spring. */
static void reactions_of_an_accelerated_set_hold_inertia(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3]]}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
                 "law: {stiffness: uniform}\ngravity: [0, 0, -10]\n"
                 "sets: [{name: a, select: {all: true}, motion: {vz: [[0, 0], [1, 300]]}}]\n"
                 "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
                 "time: {step: 1e-6, end: 1}\nrun: {threads: 1}\n");
    run_steps(w, 1000);
    assert_close(w->dem.set_reaction[2], m0 * 310.0, 1e-6); /* differences of v: 2e-16 v/(a dt) */
    gn_energy e = measured_step(w);
    assert_close(e.kinetic, 0.5 * m0 * pow(300.0 * 1e-3, 2), 1e-5); /* v(-)v(+) misses (a dt/2)^2 */
    /* The half kick at the start books no inertia: m a (dt/2) v(1/2) of m (a t)^2/2. */
    assert_true(fabs(gn_energy_residual(&e)) < 1.1 * 0.5 / (1e3 * 1e3));
    world_end(w);
}

/* --- walls --- */

/* A sphere between a floor and a wall that is servo-controlled to 5 N, later 8 N. */
static void a_servo_wall_reaches_and_holds_its_force(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[0, 0, 1e-3, 1e-3]]}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 2e6, kratio: 0}]\n"
                 "law: {stiffness: uniform}\ndamping: {contact: {fraction: 0.5}}\n"
                 "walls:\n  - {name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e6}\n"
                 "  - {name: top, point: [0, 0, 2.01e-3], normal: [0, 0, -1], stiffness: 1e6, "
                 "servo: {force: [[0, 5], [5e-3, 5], [6e-3, 8]], max_velocity: 0.05}}\n"
                 "time: {step: 2e-7, end: 1}\nrun: {threads: 1}\n");
    int64_t late = 0;
    while (w->ctx.time < 12e-3) {
        run_steps(w, 1);
        assert_true(fabs(w->boundary.walls[1].velocity[2]) <= 0.05 * (1.0 + 1e-12));
        double force = w->boundary.walls[1].force[2]; /* force of the sphere on the wall, upwards */
        if (w->ctx.time > 3e-3 && w->ctx.time < 5e-3) assert_close(force, 5.0, 1e-6);
        if (w->ctx.time > 9e-3) assert_close(force, 8.0, 1e-6);
        late += w->ctx.time > 9e-3;
    }
    assert_true(late > 1000);
    assert_close(w->boundary.walls[0].force[2], -8.0, 1e-6); /* the floor carries the same */
    /* Overlaps of 8 N/1 MN/m and 8 N/2 MN/m, closed by the wall. */
    assert_close(w->boundary.walls[1].point[2], 2e-3 - 8e-6 - 4e-6, 1e-7);
    gn_energy e = measured_step(w);
    assert_close(e.elastic_wall, 0.5 * 64.0 / 1e6 + 0.5 * 64.0 / 2e6, 1e-5);
    /* Each of the two contacts closed once, at up to 0.05 m/s. */
    double touch = 4.0 * 0.5 * 2e6 * pow(0.05 * 2e-7, 2);
    assert_true(fabs(gn_energy_residual(&e)) * gn_energy_scale(&e) <=
                touch + 1e-9 * gn_energy_scale(&e));
    world_end(w);
}

/* Piecewise linear velocity is integrated exactly by midpoints as long as steps end at its corners.
 */
static void a_wall_follows_its_velocity_table(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 2\nspecimen: {particles: [[0, 0, 1e-3]]}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
                 "law: {stiffness: uniform}\n"
                 "walls: [{name: w, point: [0, 1], normal: [0, -2], stiffness: 1e6, "
                 "motion: {vx: 0.5, vy: [[1e-3, 0], [2e-3, -3], [4e-3, 1]]}}]\n"
                 "time: {step: 1e-6, end: 1}\nrun: {threads: 1}\n");
    run_steps(w, 6000);
    double allowed = 2.2e-16 * 6000 * 2.0;
    assert_near(w->boundary.walls[0].point[0], 0.5 * 6e-3, allowed);
    assert_near(w->boundary.walls[0].point[1], 1.0 - 1.5e-3 - 2e-3 + 2e-3, allowed);
    assert_near(w->boundary.walls[0].velocity[1], 1.0, 1e-12);
    world_end(w);
}

/* A moving wall presses a held sphere: the work of the wall equals the energy of its spring. */
static void the_work_of_a_wall_is_booked(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[0, 0, 1e-3, 1e-3]]}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
                 "law: {stiffness: uniform}\n"
                 "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 3e6, "
                 "motion: {vz: 0.02}}]\n"
                 "sets: [{name: a, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
                 "time: {step: 1e-7, end: 1}\nrun: {threads: 1}\n");
    measured_step(w);
    run_steps(w, 10000);
    double u = w->boundary.walls[0].point[2];
    gn_energy e = measured_step(w);
    assert_close(w->boundary.walls[0].force[2], -3e6 * u, 1e-11);
    assert_close(w->dem.set_reaction[2], -3e6 * u, 1e-11);
    assert_close(e.work_walls, 0.5 * 3e6 * u * u, 1e-9);
    assert_close(e.elastic_wall, 0.5 * 3e6 * u * u, 1e-11);
    world_end(w);
}

/* The tangential spring of a spinning sphere rotates with half its spin. If it were rotated before
 * each increment, its two components would drive each other: the oscillation here grew sixfold. */
static void a_top_on_a_floor_keeps_its_energy(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0.99e-3, 1e-3]], group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, friction: 0.5}]\n"
        "law: {stiffness: uniform}\n"
        "walls:\n  - {name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6, kratio: 2, "
        "friction: 100}\n"
        "sets:\n  - {name: s, select: {ids: [0]}, force: [0, 0, -10], initial_velocity: [0.01, 0, "
        "0], "
        "initial_spin: [0, 0, 2000]}\ntime: {end: 1}\nrun: {threads: 1}\n");
    double sideways = 0.5 * 0.01 * 0.01 / vel_of(w, 0)[3];
    gn_energy e = measured_step(w);
    run_steps(w, 20000);
    e = measured_step(w);
    assert_true(fabs(gn_energy_residual(&e)) * gn_energy_scale(&e) < 1e-3 * sideways);
    assert_true(e.friction == 0.0);
    world_end(w);
}

static void a_passive_wall_is_free_of_force_at_the_start(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 3\nspecimen: {particles: [[0, 0, 0.8e-3, 1e-3], [9e-3, 0, 1.1e-3, 1e-3]]}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 0}]\n"
        "law: {stiffness: uniform}\n"
        "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 3e6, "
        "passive: true, motion: {vz: 0.1}}]\n"
        "sets: [{name: a, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
        "time: {step: 1e-6, end: 1}\nrun: {threads: 1}\n");
    run_steps(w, 1);
    assert_true(w->boundary.walls[0].force[2] == 0.0);
    run_steps(w, 500);
    /* At 50 um of travel the overlapping sphere carries the whole force, the one 100 um above none.
     * */
    assert_close(w->boundary.walls[0].force[2], -3e6 * 50e-6, 1e-9);
    run_steps(w, 1000);
    assert_close(w->boundary.walls[0].force[2], -3e6 * (150e-6 + 50e-6), 1e-9);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_oscillating_pair_keeps_its_energy),
        cmocka_unit_test(viscous_damping_lets_an_oscillator_decay_exponentially),
        cmocka_unit_test(nonviscous_damping_slows_a_push_by_its_fraction),
        cmocka_unit_test(nonviscous_damping_books_what_an_oscillator_loses),
        cmocka_unit_test(free_fall_is_the_exact_parabola),
        cmocka_unit_test(an_applied_force_is_shared_by_mass),
        cmocka_unit_test(reactions_of_prescribed_motion_are_the_spring_force),
        cmocka_unit_test(reactions_of_an_accelerated_set_hold_inertia),
        cmocka_unit_test(a_servo_wall_reaches_and_holds_its_force),
        cmocka_unit_test(a_wall_follows_its_velocity_table),
        cmocka_unit_test(the_work_of_a_wall_is_booked),
        cmocka_unit_test(a_top_on_a_floor_keeps_its_energy),
        cmocka_unit_test(a_passive_wall_is_free_of_force_at_the_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
