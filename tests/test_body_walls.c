/* Free rigid bodies on plane walls. */
#include "body_helpers.h"

#include "boundary/body_walls.h"
#include "run/run.h"

static gn_rigid *body(gn_world *w) {
    return &w->boundary.bodies[0];
}

/* Returns the largest residual over a number of steps. */
static double worst_residual(gn_world *w, int64_t steps) {
    double worst = 0.0;
    for (int64_t k = 0; k < steps; k++) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    return worst;
}

/* --- parts of the stiffness --- */

static void parts_do_not_depend_on_how_faces_are_cut(void **state) {
    (void)state;
    gn_world *w = world_of("%swalls: [{name: f, point: [0, 0, -9], normal: [0, 0, 1], stiffness: "
                           "1}]\nbodies: [{name: b, box: {size: [1, 2, 3]}, stiffness: 1, free: "
                           "true, density: 1}, {name: c, cylinder: {diameter: 1, height: 2, sides: "
                           "48}, stiffness: 1, free: true, density: 1}]\ntime: {end: 1}\n",
                           head3);
    const double *part = w->boundary.vertex_part;
    for (int v = 0; v < 8; v++) assert_close(part[v], 0.25, 1e-12);
    for (int v = 8; v < 104; v++) assert_near(part[v], 1.0 / 48, 1e-12);
    assert_true(part[104] == 0.0 && part[105] == 0.0); /* middles of the ends */
    world_end(w);
    w = world_of("%swalls: [{name: f, point: [0, -9], normal: [0, 1], stiffness: 1}]\n"
                 "bodies: [{name: b, polygon: [[0, 0], [0, 1], [1, 1], [2, 1], [2, 0]], stiffness: "
                 "1, free: true, density: 1}]\ntime: {end: 1}\n",
                 head2);
    for (int v = 0; v < 5; v++) assert_near(w->boundary.vertex_part[v], v == 2 ? 0.0 : 0.5, 1e-12);
    world_end(w);
}

/* --- bounces --- */

/* A cube of 2 kg hits a wall at 1 m/s on a spring of 1 MN/m: on a face, on a corner below its
 * centre; in the plane on a side. `steps` of an undamped half wave, 0: automatic. */
static gn_world *bouncing(int dimension, const char *rotation, double restitution,
                          const char *time) {
    if (dimension == 2)
        return world_of(
            "%sdamping: {contact: {restitution: %g}}\n"
            "walls: [{name: f, point: [0, 0], normal: [0, 1], stiffness: 2e6}]\n"
            "bodies: [{name: b, polygon: [[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]], origin: [0, "
            "0.01], stiffness: 2e6, free: true, density: 200, initial_velocity: [0, -1]}]\n"
            "time: {%s}\n",
            head2, restitution, time);
    return world_of(
        "%sdamping: {contact: {restitution: %g}}\n"
        "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e6}]\n"
        "bodies: [{name: b, box: {size: [0.1, 0.1, 0.1]}, origin: [0, 0, 0.01], rotation: [%s], "
        "stiffness: 2e6, free: true, density: 2000, initial_velocity: [0, 0, -1]}]\n"
        "time: {%s}\n",
        head3, restitution, rotation, time);
}

/* The diagonal of the cube along z. */
static const char on_a_corner[] = "0.675510858856 , -0.675510858856, 0";

static void a_body_rebounds_with_the_restitution(void **state) {
    (void)state;
    const char *const rotation[] = {"0, 0, 0", on_a_corner, "0, 0, 0"};
    const double wanted[] = {1.0, 0.8, 0.5};
    for (int shape = 0; shape < 3; shape++)
        for (int k = 0; k < 6; k++) {
            int up = shape == 2 ? 1 : 2;
            gn_world *w = bouncing(shape == 2 ? 2 : 3, rotation[shape], wanted[k % 3],
                                   k < 3 ? "end: 1" : "step: 1e-5, end: 1");
            double impulse = 0.0;
            for (int n = 0; n < 20000 && w->ctx.time < 0.05; n++) {
                measured_step(w);
                impulse -= 0.5 * (w->ctx.dt + w->ctx.dt_past) * w->boundary.walls[0].force[up];
            }
            assert_near(body(w)->velocity[up], wanted[k % 3], 0.01);
            assert_close(impulse, 2.0 * (body(w)->velocity[up] + 1.0), 0.02);
            assert_near(length3(body(w)->spin), 0.0, 1e-9);
            if (k >= 3) assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 1e-3);
            world_end(w);
        }
}

/* --- energy --- */

/* A tilted block that falls between a floor and sides, and bounces permanently. */
static gn_world *tumbling(double friction, double dt, const char *more) {
    return world_of(
        "%sgravity: [0, 0, -9.81]\n%s"
        "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e5, kratio: 2, "
        "friction: %g}, {name: l, point: [-0.1, 0, 0], normal: [1, 0, 0], stiffness: 2e5, kratio: "
        "2, friction: %g}, {name: r, point: [0.2, 0, 0], normal: [-1, 0, 0.2], stiffness: 1e5, "
        "kratio: 3, friction: %g}]\n"
        "bodies: [{name: b, box: {size: [0.1, 0.08, 0.05]}, origin: [0, 0, 0.05], rotation: [0.3, "
        "0.5, 0.2], stiffness: 2e5, kratio: 2, friction: 0.5, free: true, density: 2000, "
        "initial_velocity: [0.5, 0, 0], initial_spin: [1, 2, 3]}]\ntime: {step: %g, end: 9}\n",
        head3, more, friction, friction, friction, dt);
}

static void the_ledger_closes_while_a_block_tumbles(void **state) {
    (void)state;
    double smooth[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = tumbling(0.0, k ? 2.5e-5 : 1e-4, "");
        smooth[k] = worst_residual(w, k ? 80000 : 20000);
        world_end(w);
    }
    print_message("# smooth %.3g, a quarter of the step %.3g\n", smooth[0], smooth[1]);
    assert_true(smooth[0] < 1e-3 && smooth[1] < 0.3 * smooth[0]);
    gn_world *w = tumbling(0.3, 2.5e-5, "");
    double rough = worst_residual(w, 80000);
    assert_true(w->ledger.reading.friction > 0.02 * gn_energy_scale(&w->ledger.reading));
    world_end(w);
    w = tumbling(0.3, 2.5e-5, "damping: {contact: {restitution: 0.5}}\n");
    double damped = worst_residual(w, 80000);
    assert_true(w->ledger.reading.contact_damping > 0.02 * gn_energy_scale(&w->ledger.reading));
    assert_true(w->ledger.reading.kinetic <
                1e-6 * gn_energy_scale(&w->ledger.reading)); /* the block is at rest */
    double weight = body(w)->mass * 9.81;
    assert_close(-w->boundary.walls[0].force[2] - w->boundary.walls[2].force[2], weight, 1e-3);
    world_end(w);
    print_message("# rough %.3g, damped %.3g\n", rough, damped);
    assert_true(rough < 1e-3 && damped < 1e-3);
}

/* A block on an edge rocks to and fro. The error of its energy comes from corners that touch the
 * floor within a step. */
static void a_rocking_block_keeps_its_energy(void **state) {
    (void)state;
    gn_world *w = world_of(
        "%sgravity: [0, -9.81]\nwalls: [{name: f, point: [0, 0], normal: [0, 1], stiffness: 2e6, "
        "kratio: 2, friction: 5}]\n"
        "bodies: [{name: b, polygon: [[0, 0], [0.1, 0], [0.1, 0.2], [0, 0.2]], rotation: 0.2, "
        "stiffness: 2e6, kratio: 2, friction: 5, free: true, density: 200}]\n"
        "time: {end: 9}\n",
        head2);
    double worst = 0.0, least = 1.0, start = 4.0 * 9.81 * 0.1;
    while (w->ctx.time < 2.0) {
        gn_energy e = measured_step(w);
        double off = gn_energy_stored(&e) - e.stored_at_start - e.work_gravity + e.friction;
        worst = fmax(worst, fabs(off));
        least = fmin(least, body(w)->axes[3]);
    }
    print_message("# rocking: %.3g of the weight over the height, leans to %.3g\n", worst / start,
                  0.2 + least);
    assert_true(least < -0.25); /* the block has also rocked to the other side */
    assert_true(worst < 1e-3 * start);
    world_end(w);
}

/* --- friction --- */

/* A box on a floor under inclined gravity: the horizontal component is `slope` times its weight. */
static gn_world *on_slope(int dimension, double slope, double friction, double height) {
    double turn = atan(slope), gx = 9.81 * sin(turn), gz = -9.81 * cos(turn);
    const char *damping = "damping: {contact: {fraction: 0.3}}\n";
    if (dimension == 2)
        return world_of("%s%sgravity: [%.17g, %.17g]\nwalls: [{name: f, point: [0, 0], normal: [0, "
                        "1], stiffness: 2e7, kratio: 2, friction: %g}]\n"
                        "bodies: [{name: b, polygon: [[0, 0], [0.1, 0], [0.1, %g], [0, %g]], "
                        "stiffness: 2e7, kratio: 2, friction: 5, free: true, density: 200}]\n"
                        "time: {end: 1}\n",
                        head2, damping, gx, gz, friction, height, height);
    return world_of("%s%sgravity: [%.17g, 0, %.17g]\nwalls: [{name: f, point: [0, 0, 0], normal: "
                    "[0, 0, 1], stiffness: 2e7, kratio: 2, friction: %g}]\n"
                    "bodies: [{name: b, box: {size: [0.1, 0.2, %g]}, stiffness: 2e7, kratio: 2, "
                    "friction: 5, free: true, density: 2000}]\ntime: {end: 1}\n",
                    head3, damping, gx, gz, friction, height);
}

/* Slopes of 0.48 and 0.52 at a friction of 0.5. */
static void a_box_slides_when_the_slope_is_beyond_friction(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 2; k++) {
            double slope = k ? 0.52 : 0.48, turn = atan(slope);
            gn_world *w = on_slope(dimension, slope, 0.5, 0.05);
            run_until(w, 0.1);
            double before = body(w)->velocity[0], begin = w->ctx.time;
            run_until(w, 0.3);
            double pull = (body(w)->velocity[0] - before) / (w->ctx.time - begin);
            if (k)
                assert_close(pull, 9.81 * (sin(turn) - 0.5 * cos(turn)), 0.01);
            else
                assert_near(body(w)->velocity[0], 0.0, 1e-6);
            assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 1e-3);
            world_end(w);
        }
}

/* A box of 0.1 m by 0.2 m falls over beyond a slope of 1/2; released suddenly it rocks a little. */
static void a_box_falls_over_when_its_weight_is_beyond_the_edge(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 2; k++) {
            gn_world *w = on_slope(dimension, k ? 0.55 : 0.45, 5.0, 0.2);
            run_until(w, 0.5);
            if (k)
                assert_true(length3(body(w)->spin) > 0.1);
            else
                assert_near(length3(body(w)->spin), 0.0, 1e-3);
            world_end(w);
        }
}

/* --- walls that move --- */

/* A servo presses a box against a floor that vibrates. */
static void a_servo_wall_feels_the_body(void **state) {
    (void)state;
    gn_world *w = world_of(
        "%sgravity: [0, 0, -9.81]\ndamping: {contact: {fraction: 0.3}}\n"
        "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e6, kratio: 2, "
        "friction: 0.3}, {name: t, point: [0, 0, 0.1001], normal: [0, 0, -1], stiffness: 2e6, "
        "servo: {force: 300, max_velocity: 0.1}}]\n"
        "bodies: [{name: b, box: {size: [0.1, 0.1, 0.1]}, stiffness: 2e6, kratio: 2, friction: "
        "0.3, free: true, density: 2000}]\ntime: {end: 1}\n",
        head3);
    double worst = worst_residual(w, 6000), weight = 2.0 * 9.81;
    assert_close(w->boundary.walls[1].force[2], 300.0, 1e-3);
    assert_close(-w->boundary.walls[0].force[2], 300.0 + weight, 1e-3);
    assert_true(worst < 1e-3);
    world_end(w);
}

static void the_work_of_a_moving_wall_is_in_the_ledger(void **state) {
    (void)state;
    gn_world *w = world_of(
        "%sgravity: [0, 0, -9.81]\n"
        "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e5, kratio: 2, "
        "friction: 0.3, motion: {vx: 1, vz: [[0, 0], [0.02, 0.5], [0.06, -0.5], [0.1, 0.5]]}}]\n"
        "bodies: [{name: b, box: {size: [0.1, 0.1, 0.02]}, origin: [0, 0, 1e-4], rotation: [0.01, "
        "0.02, 0], stiffness: 2e5, kratio: 2, friction: 0.3, free: true, density: 2000}]\n"
        "time: {step: 1e-5, end: 9}\n",
        head3);
    double worst = worst_residual(w, 20000);
    assert_true(w->ledger.reading.work_walls > 0.1);
    assert_true(worst < 1e-3);
    world_end(w);
}

/* --- the automatic step --- */

/* The springs range from displacements of metres to almost rigid ones; one body has a thousand
 * vertices. */
static void the_automatic_step_follows_any_stiffness(void **state) {
    (void)state;
    for (int power = 3; power <= 12; power += 3) {
        double stiffness = pow(10.0, power), speed = 1e-3 * sqrt(0.5 * stiffness / 2.0);
        gn_world *w = world_of(
            "%swalls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: %g}]\n"
            "bodies: [{name: b, cylinder: {diameter: 0.1, height: 0.1, sides: 500}, origin: [0, 0, "
            "1e-4], stiffness: %g, free: true, density: 2546.5, initial_velocity: [0, 0, %.17g]}]\n"
            "time: {end: 9}\n",
            head3, stiffness, stiffness, -fmin(speed, 10.0));
        double before = -body(w)->velocity[2], period = 0.0;
        bool pressed = false;
        for (int n = 0; n < 1600 && (period == 0.0 || pressed); n++) {
            measured_step(w);
            pressed = w->boundary.walls[0].force[2] != 0.0;
            period += pressed;
        }
        assert_true(period >= 32.0 && period <= 160.0);
        assert_close(body(w)->velocity[2], before, 0.01);
        world_end(w);
    }
}

/* --- at random --- */

/* A box or a prism falls, turning, between a floor and a leaning wall, at default steps, on springs
 * of 300 to 30 000 times its weight over its size; returns the largest residual. */
static double random_fall(uint64_t seed) {
    uint64_t at = 1000 * seed;
    double size[3], turn[3], spin[3], gravity = pow(10.0, uniform(&at, 0, 2));
    double friction = seed % 4 ? uniform(&at, 0, 1) : 0.0, restitution = 0.2 * (double)(seed % 6);
    for (int a = 0; a < 3; a++) {
        size[a] = uniform(&at, 0.03, 0.12);
        turn[a] = uniform(&at, -2, 2);
        spin[a] = uniform(&at, -9, 9);
    }
    double density = uniform(&at, 500, 5000),
           weight = density * size[0] * size[1] * size[2] * gravity;
    double stiffness =
        2.0 * pow(10.0, uniform(&at, 2.48, 4.48)) * weight / cbrt(size[0] * size[1] * size[2]);
    char shape[128];
    snprintf(shape, sizeof shape,
             seed % 2 ? "box: {size: [%g, %g, %g]}"
                      : "cylinder: {diameter: %g, upper_diameter: %g, height: %g, sides: %d}",
             size[0], size[1], size[2], 3 + (int)(seed % 9));
    gn_world *w = world_of(
        "%sgravity: [0, 0, -%g]\ndamping: {contact: {restitution: %g}}\n"
        "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: %g, kratio: %g, "
        "friction: %g}, {name: l, point: [-0.1, 0, 0], normal: [1, 0, 0.3], stiffness: %g, kratio: "
        "2, friction: %g}]\n"
        "bodies: [{name: b, %s, origin: [0, 0, 0.2], rotation: [%g, %g, %g], stiffness: %g, "
        "kratio: "
        "2, friction: 5, free: true, density: %g, initial_velocity: [%g, 0, 0], initial_spin: [%g, "
        "%g, %g]}]\ntime: {end: 9}\n",
        head3, gravity, restitution, stiffness, uniform(&at, 1, 4), friction, stiffness, friction,
        shape, turn[0], turn[1], turn[2], stiffness, density, uniform(&at, -1, 1), spin[0], spin[1],
        spin[2]);
    double worst = 0.0, end = 8.0 * sqrt(0.4 / gravity);
    while (w->ctx.time < end && w->ctx.step < 40000) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    world_end(w);
    return worst;
}

static void the_ledger_closes_for_random_bodies(void **state) {
    (void)state;
    double worst = 0.0;
    int above = 0, count = 24;
    for (int k = 0; k < count; k++) {
        double r = random_fall((uint64_t)k);
        worst = fmax(worst, r);
        above += r > 1e-3;
    }
    print_message("# %d of %d above 1e-3, most %.2g\n", above, count, worst);
    assert_true(worst < 1e-3);
}

/* --- at the start --- */

static void a_passive_wall_takes_a_body_as_it_is(void **state) {
    (void)state;
    for (int passive = 0; passive < 2; passive++) {
        gn_world *w = world_of(
            "%swalls: [{name: f, point: [0, 0, 1e-3], normal: [0, 0, 1], stiffness: 2e6%s}]\n"
            "bodies: [{name: b, box: {size: [0.1, 0.1, 0.1]}, stiffness: 2e6, free: true, density: "
            "2000}]\ntime: {end: 1}\n",
            head3, passive ? ", passive: true" : "");
        gn_body_overlap o = gn_body_walls_overlap(&w->ctx, &w->boundary, 0, 0);
        assert_true(o.vertices == 4);
        assert_close(o.deepest, 1e-3, 1e-9);
        assert_near(o.force, passive ? 0.0 : 1e3, 1e-6);
        run_steps(w, 100);
        assert_true((body(w)->velocity[2] > 0.1) == !passive);
        assert_true(passive == (body(w)->velocity[2] == 0.0));
        world_end(w);
    }
}

static void a_body_behind_a_wall_is_refused(void **state) {
    (void)state;
    char scene_text[2048];
    gn_world w;
    gneiss_error error = {0};
    snprintf(scene_text, sizeof scene_text,
             "%swalls: [{name: floor, point: [0, 0, 0.06], normal: [0, 0, 1], stiffness: 2e6}]\n"
             "bodies:\n  - {name: brick, box: {size: [0.1, 0.1, 0.1]}, stiffness: 2e6, free: true, "
             "density: 2000}\ntime: {end: 1}\n",
             head3);
    assert_true(world_try(&w, scene_text, "/tmp", &error) == GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "'brick' in front of wall 'floor'"));
    assert_non_null(strstr(error.message, "s.yaml:10:"));
}

/* --- with particles, on resume --- */

/* Spheres fall on a block that lies in a corner. */
static const char poured[] =
    "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 2e-3, cells: [4, 4, 2], origin: "
    "[2.2e-3, 2.2e-3, 13e-3], jitter: 0.2, spacing: 1.1}, group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 2e4, kratio: 2, friction: 0.3}]\n"
    "law: {stiffness: uniform}\ngravity: [-2, -1, -10]\ndamping: {contact: {restitution: 0.5}}\n"
    "walls:\n  - {name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 2e4, kratio: 2, "
    "friction: 0.3}\n"
    "  - {name: x, point: [0, 0, 0], normal: [1, 0, 0], stiffness: 2e4, kratio: 2, friction: "
    "0.3}\n"
    "  - {name: y, point: [0, 0, 0], normal: [0, 1, 0], stiffness: 2e4, kratio: 2, friction: "
    "0.3}\n"
    "bodies: [{name: b, box: {size: [15e-3, 14e-3, 8e-3]}, origin: [1e-3, 1e-3, 1e-3], rotation: "
    "[0.05, 0.02, 0.1], stiffness: 2e4, kratio: 2, friction: 0.3, free: true, density: 2000}]\n"
    "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {end: 1}\nrun: {threads: %d}\n";

static void poured_run(gn_run *run, int threads) {
    char scene_text[2048];
    snprintf(scene_text, sizeof scene_text, poured, threads);
    gn_scene scene;
    gneiss_error error = {0};
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, run, &error), &error);
}

static void threads_and_a_resumed_run_give_the_same_bits(void **state) {
    (void)state;
    const char *const saved = "/tmp/gneiss-body-walls.h5";
    gn_run straight, stopped, resumed;
    gneiss_error error = {0};
    poured_run(&straight, 3);
    poured_run(&stopped, 1);
    run_steps(&straight.world, 4000);
    run_steps(&stopped.world, 2777);
    const gn_wall_contacts *q = &stopped.world.boundary.body_contacts;
    double held = 0.0;
    for (size_t c = 0; c < q->soa.count; c++) held += fabs(q->shear[c]);
    assert_true(held > 0.0); /* a resumed run has energy to restore */
    assert_ok(gn_checkpoint_write(&stopped, saved, &error), &error);
    assert_ok(gn_checkpoint_load(saved, NULL, 0, &resumed, &error), &error);
    assert_true(gn_world_hash(&stopped.world.ctx, &stopped.world.dem, &stopped.world.boundary,
                              &stopped.world.solids, &stopped.world.box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    run_steps(&resumed.world, 4000 - 2777);
    assert_true(straight.world.dem.verlet.rebuilds > 2);
    assert_true(gn_world_hash(&straight.world.ctx, &straight.world.dem, &straight.world.boundary,
                              &straight.world.solids, &straight.world.box) ==
                gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                              &resumed.world.solids, &resumed.world.box));
    assert_true(memcmp(&straight.world.ledger.energy, &resumed.world.ledger.energy,
                       sizeof(gn_energy)) == 0);
    gn_run_free(&straight);
    gn_run_free(&stopped);
    gn_run_free(&resumed);
    unlink(saved);
}

/* A box of 1e-5 or 1e-6 kg rests on 1e6 N/m while all positions are relative to a grain 54 m away:
 * the step is so short that the box creeps by less than an ulp in it, and its weight does work that
 * no position shows. The supporting forces are exact. */
static void a_light_body_rests_far_from_the_grains(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double density = k ? 1e-3 : 1e-2;
        text *t = calloc(1, sizeof *t);
        gn_scene scene;
        gn_run run;
        gneiss_error error = {0};
        add(t,
            "dimension: 3\nspecimen: {particles: [[50, 0, 20, 0.01]], group: 0}\n"
            "materials: [{name: a, density: 2500, normal_stiffness: 1e5, kratio: 2}]\n"
            "law: {stiffness: uniform}\ngravity: [0, 0, -9.81]\n"
            "domain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
            "damping: {contact: {restitution: 0.5}}\n"
            "sets: [{name: d, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
            "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6, kratio: 2, "
            "friction: 0.5}]\nbodies: [{name: b, box: {size: [0.1, 0.1, 0.1]}, stiffness: 1e6, "
            "kratio: 2, friction: 0.5, free: true, density: %g}]\n"
            "time: {end: 1}\noutput: {history_rows: 1000000}\nrun: {threads: 1}\n",
            density);
        assert_ok(gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
        assert_ok(gn_run_create(&scene, &run, &error), &error);
        assert_ok(gn_run_steps(&run, 30000, &error), &error);
        assert_true(gn_run_residual(&run) < 0.01);
        assert_close(-run.world.boundary.walls[0].force[2], 9.81 * density * 1e-3, 0.01);
        gn_run_free(&run);
        free(t);
    }
}

static void particles_lie_on_a_body_that_lies_on_walls(void **state) {
    (void)state;
    gn_world *w = world_of(poured, 1);
    double worst = worst_residual(w, 12000);
    const gn_rigid *b = body(w);
    print_message("# poured: residual %.3g, speed %.3g m/s, step %.3g s\n", worst,
                  length3(b->velocity), w->ctx.dt);
    assert_true(worst < 1e-3);
    assert_true(b->position[2] > 3.9e-3 && b->position[2] < 5e-3);
    assert_true(-b->force[0] > -1.0);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_do_not_depend_on_how_faces_are_cut),
        cmocka_unit_test(a_body_rebounds_with_the_restitution),
        cmocka_unit_test(the_ledger_closes_while_a_block_tumbles),
        cmocka_unit_test(a_rocking_block_keeps_its_energy),
        cmocka_unit_test(a_box_slides_when_the_slope_is_beyond_friction),
        cmocka_unit_test(a_box_falls_over_when_its_weight_is_beyond_the_edge),
        cmocka_unit_test(a_servo_wall_feels_the_body),
        cmocka_unit_test(the_work_of_a_moving_wall_is_in_the_ledger),
        cmocka_unit_test(the_automatic_step_follows_any_stiffness),
        cmocka_unit_test(the_ledger_closes_for_random_bodies),
        cmocka_unit_test(a_passive_wall_takes_a_body_as_it_is),
        cmocka_unit_test(a_body_behind_a_wall_is_refused),
        cmocka_unit_test(threads_and_a_resumed_run_give_the_same_bits),
        cmocka_unit_test(a_light_body_rests_far_from_the_grains),
        cmocka_unit_test(particles_lie_on_a_body_that_lies_on_walls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
