/* Contacts of rigid bodies with walls and with each other in scenes with Hertz's law, which have a
 * stiffness of their own. */
#include "body_helpers.h"
#include "run_helpers.h"

#include "boundary/body_pairs.h"
#include "boundary/body_walls.h"

/* The scene of head3 with Hertz's law. */
static const char head[] =
    "dimension: 3\nspecimen: {particles: [[0, 50, 0.05, 0.02]], material: m, group: 0}\n"
    "materials: [{name: m, density: 2500, young: 1e7, poisson: 0.2, friction: 0.5}, {name: s, "
    "density: 7800, young: 2e11, poisson: 0.3, friction: 0.3, restitution: 0.5}, {name: t, "
    "density: 7800, young: 2e11, poisson: 0.3, friction: 0.6, restitution: 0.8}]\n"
    "contacts: [{between: t, restitution: 0.65, friction: 0.1}]\n"
    "law: {stiffness: hertz}\nsets: [{name: far, select: {all: true}, motion: {vx: 0, vy: 0, vz: "
    "0, wx: 0, wy: 0, wz: 0}}]\ndomain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
    "run: {threads: 1}\n";

static gn_rigid *body(gn_world *w, size_t k) {
    return &w->boundary.bodies[k];
}

static double run_to(gn_world *w, double time) {
    double worst = 0.0;
    while (w->ctx.time < time) {
        gn_energy e = measured_step(w);
        worst = fmax(worst, fabs(gn_energy_residual(&e)));
    }
    return worst;
}

/* --- the linear law, beside Hertz's --- */

/* Blocks that tumble between three walls, whose springs have half the stiffness under the linear
 * law; and blocks that collide without walls. */
static gn_world *tumbling(bool hertz, bool walls) {
    char sides[400] = "", spring[64];
    const char *wall = hertz ? "" : "stiffness: 4e5, kratio: 2, ";
    if (walls)
        snprintf(sides, sizeof sides,
                 "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], %sfriction: 0.3}, {name: "
                 "l, point: [-0.1, 0, 0], normal: [1, 0, 0], %sfriction: 0.3}, {name: r, point: "
                 "[0.2, 0, 0], normal: [-1, 0, 0.2], %sfriction: 0.4}]\n",
                 wall, wall, wall);
    snprintf(spring, sizeof spring, "stiffness: %s, kratio: 2, friction: 0.5",
             hertz && walls ? "2e5" : "4e5");
    return world_of(
        "%sgravity: [0, 0, %g]\ndamping: {contact: {restitution: 0.7}}\n%s"
        "bodies:\n  - {name: a, box: {size: [0.1, 0.08, 0.05]}, origin: [0, 0, 0.05], rotation: "
        "[0.3, 0.5, 0.2], %s, free: true, density: 2000, initial_velocity: [0.5, 0, 0], "
        "initial_spin: [1, 2, 3]}\n"
        "%s  - {name: b, box: {size: [0.05, 0.08, 0.05]}, origin: [0.12, 0, 0.06], %s, free: "
        "true, density: 2000}\ntime: {step: 2.5e-5, end: 9}\n",
        hertz ? head : head3, walls ? -9.81 : 0.0, sides, spring, walls ? "#" : "", spring);
}

static void bodies_move_as_by_the_linear_law(void **state) {
    (void)state;
    for (int walls = 0; walls < 2; walls++) {
        gn_world *h = tumbling(true, walls), *l = tumbling(false, walls);
        double start[3];
        memcpy(start, body(h, 0)->momentum, sizeof start);
        for (int n = 0; n < 20000; n++) {
            measured_step(h);
            measured_step(l);
        }
        for (size_t k = 0; k < h->ctx.scene.body_count; k++) {
            assert_memory_equal(body(h, k)->position, body(l, k)->position, 3 * sizeof(double));
            assert_memory_equal(body(h, k)->momentum, body(l, k)->momentum, 3 * sizeof(double));
        }
        assert_true(memcmp(start, body(h, 0)->momentum, sizeof start) !=
                    0); /* the blocks collided */
        assert_true(h->ledger.reading.friction > 0.0 && h->ledger.reading.contact_damping > 0.0);
        assert_near(gn_energy_residual(&h->ledger.reading), 0.0, 1e-3);
        world_end(h);
        world_end(l);
    }
}

/* --- restitution and friction: of the materials, of the pair, of the scene --- */

/* A cube of 2 kg hits a wall, or a body at rest, at 1 m/s; neither has a stiffness. */
static double rebound(const char *damping, const char *mine, const char *other, bool plate) {
    gn_world *w = world_of(
        "%s%swalls: [{name: f, point: [0, 0, %s], normal: [0, 0, 1]%s}]\nbodies:\n"
        "  - {name: p, box: {size: [1, 1, 0.1]}, origin: [-0.5, -0.5, %s], friction: 0.2}\n"
        "  - {name: b, box: {size: [0.1, 0.1, 0.1]}, origin: [0, 0, 0.01], stiffness: 1e6, kratio: "
        "2, %s, free: true, density: 2000, initial_velocity: [0, 0, -1]}\ntime: {end: 1}\n",
        head, damping, plate ? "-5" : "0", other, plate ? "-0.1" : "-9", mine);
    assert_true(run_to(w, 0.05) < 1e-3);
    double speed = body(w, 1)->velocity[2];
    world_end(w);
    return speed;
}

static void bodies_rebound_with_the_restitution_of_materials(void **state) {
    (void)state;
    const char *scene = "damping: {contact: {restitution: 0.3}}\n";
    for (int plate = 0; plate < 2; plate++) {
        assert_near(rebound("", "friction: 0.2", "", plate), 1.0, 0.01);
        assert_near(rebound(scene, "friction: 0.2", "", plate), 0.3, 0.01);
        assert_near(rebound("", "material: s", "", plate), 0.5, 0.01);
        assert_near(rebound(scene, "material: t", "", plate), 0.3, 0.01);
    }
    assert_near(rebound("", "material: t", ", material: s", false), 0.5, 0.01);
    assert_near(rebound("", "material: t", ", material: t", false), 0.65, 0.01);
}

/* On a floor that leans by 0.2 a box slides with friction 0.1, the value of the pair of materials t
 * and t. */
static void friction_is_that_of_materials(void **state) {
    (void)state;
    static const char *const mine[] = {"friction: 0.9", "material: t", "material: t"};
    static const char *const other[] = {"friction: 0.1", "material: s", "material: t"};
    const double mu[] = {0.1, 0.3, 0.1}, slope = atan(0.2);
    for (int k = 0; k < 3; k++) {
        gn_world *w = world_of(
            "%sdamping: {contact: {fraction: 0.3}}\ngravity: [%.17g, 0, %.17g]\n"
            "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], %s}]\n"
            "bodies: [{name: b, box: {size: [0.1, 0.2, 0.05]}, stiffness: 1e7, kratio: 2, %s, "
            "free: true, density: 2000}]\ntime: {end: 1}\n",
            head, 10 * sin(slope), -10 * cos(slope), other[k], mine[k]);
        run_to(w, 0.1);
        double before = body(w, 0)->velocity[0], begin = w->ctx.time;
        assert_true(run_to(w, 0.3) < 1e-3);
        double pull = (body(w, 0)->velocity[0] - before) / (w->ctx.time - begin);
        if (mu[k] < 0.2)
            assert_close(pull, 10 * (sin(slope) - mu[k] * cos(slope)), 0.01);
        else
            assert_near(pull, 0.0, 1e-3);
        world_end(w);
    }
}

/* --- walls that move --- */

/* A servo presses a box on a floor. */
static void a_servo_wall_feels_the_body(void **state) {
    (void)state;
    gn_world *w = world_of(
        "%sgravity: [0, 0, -9.81]\ndamping: {contact: {fraction: 0.3}}\n"
        "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], friction: 0.3}, {name: t, point: "
        "[0, 0, 0.1001], normal: [0, 0, -1], servo: {force: 300, "
        "max_velocity: 0.1}}]\n"
        "bodies: [{name: b, box: {size: [0.1, 0.1, 0.1]}, stiffness: 1e6, kratio: 2, friction: "
        "0.3, free: true, density: 2000}]\ntime: {end: 9}\n",
        head);
    double worst = run_to(w, 0.5), weight = 2.0 * 9.81;
    assert_close(w->boundary.walls[1].force[2], 300.0, 1e-3);
    assert_close(-w->boundary.walls[0].force[2], 300.0 + weight, 1e-3);
    assert_true(worst < 1e-3);
    world_end(w);
}

/* --- the automatic step --- */

static void the_automatic_step_follows_any_stiffness(void **state) {
    (void)state;
    for (int power = 3; power <= 12; power += 3) {
        double stiffness = pow(10.0, power), speed = fmin(1e-3 * sqrt(0.5 * stiffness), 10.0);
        gn_world *w = world_of("%swalls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1]}]\n"
                               "bodies: [{name: b, box: {size: [0.1, 0.1, 0.1]}, origin: [0, 0, "
                               "1e-4], stiffness: %g, free: true, density: 2000, "
                               "initial_velocity: [0, 0, %.17g]}]\ntime: {end: 9}\n",
                               head, stiffness, -speed);
        int pressed = 0;
        for (int n = 0; n < 4000 && (!pressed || w->boundary.walls[0].force[2] != 0.0); n++) {
            measured_step(w);
            pressed += w->boundary.walls[0].force[2] != 0.0;
        }
        assert_true(pressed >= 32 && pressed <= 400);
        assert_close(body(w, 0)->velocity[2], speed, 0.01);
        world_end(w);
    }
}

/* --- grains --- */

/* A block falls on grains in a box of walls, with default settings; `all`: with all other options.
 * */
static void on_grains(text *lines, bool all, int threads) {
    static const char *const wall[] = {
        "0, 0, 0], normal: [0, 0, 1", "0, 0, 0], normal: [1, 0, 0", "0, 0, 0], normal: [0, 1, 0",
        "0.065, 0, 0], normal: [-1, 0, 0", "0, 0.065, 0], normal: [0, -1, 0"};
    add(lines,
        "dimension: 3\nspecimen: {lattice: {kind: hcp, radius: 4e-3, cells: [7, 4, 2], origin: "
        "[5e-3, 5e-3, 5e-3], spacing: 1.05, jitter: 0.02}, material: g, group: 0}\n"
        "materials:\n  - {name: g, density: 2500, young: 1e7, poisson: 0.25, friction: 0.4, "
        "restitution: 0.5%s}\n  - {name: s, density: 7800, young: 2e11, poisson: 0.3, friction: "
        "0.3, restitution: 0.4}\n"
        "law: {stiffness: hertz%s}\ngravity: [0, 0, -9.81]\n%swalls:\n",
        all ? ", rolling_friction: 0.1, twisting_friction: 0.1" : "", all ? ", pull: false" : "",
        all ? "damping: {contact: {restitution: 0.6}, background: {model: nonviscous_component, "
              "coefficient: 0.05}}\n"
            : "");
    for (int k = 0; k < 5; k++)
        add(lines, "  - {name: w%d, point: [%s], %s}\n", k, wall[k],
            all && k < 3 ? "material: s" : "friction: 0.3");
    add(lines, "bodies:\n  - {name: block, box: {size: [0.05, 0.04, 0.02]}, origin: [6e-3, 0.011, "
               "0.045], rotation: [0.1, 0.2, 0], stiffness: 1e5, kratio: 2, material: s, free: "
               "true, density: 3000}\n");
    if (all)
        add(lines, "  - {name: small, box: {size: [0.02, 0.02, 0.02]}, origin: [0.02, 0.02, 0.08], "
                   "rotation: [0.3, 0.2, 0.5], stiffness: 1e5, kratio: 2, friction: 0.3, free: "
                   "true, density: 2000}\n"
                   "  - {name: bar, box: {size: [0.09, 0.01, 0.01]}, origin: [-0.01, 0.05, 0.1], "
                   "friction: 0.3, motion: {vz: -0.05}}\n");
    add(lines, "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\ntime: {end: 1}\nrun: {threads: %d}\n",
        threads);
}

static void a_block_rests_on_grains_with_its_weight(void **state) {
    (void)state;
    text *lines = calloc(1, sizeof *lines);
    on_grains(lines, false, 1);
    gn_world *w = world_of("%s", lines->s);
    double worst = run_to(w, 0.6), floor_force = 0.0, weight = 9.81 * body(w, 0)->mass;
    double own = body(w, 0)->force[2];
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) weight += 9.81 * mass_of(w, (int)p);
    floor_force = -w->boundary.walls[0].force[2];
    print_message("# floor %.5g N of %.5g N, block %.5g of %.5g, ledger %.3g, speed %.3g\n",
                  floor_force, weight, own, 9.81 * body(w, 0)->mass, worst,
                  length3(body(w, 0)->velocity));
    assert_close(floor_force, weight, 0.03); /* the sides carry a small part by friction */
    assert_near(length3(body(w, 0)->velocity), 0.0, 1e-3);
    assert_true(worst < 2e-3);
    world_end(w);
    free(lines);
}

static gn_run *grains_run(int threads) {
    text *lines = calloc(1, sizeof *lines);
    on_grains(lines, true, threads);
    gn_run *run = run_of("%s", lines->s);
    free(lines);
    return run;
}

/* Blocks, a bar that compresses them, grains that resist rolling, dashpots without tension. */
static void threads_and_a_resumed_run_give_the_same_bits(void **state) {
    (void)state;
    gn_run *straight = grains_run(3), *stopped = grains_run(1);
    double held = 0.0; /* energy that a resumed run has to restore */
    while (held == 0.0 && stopped->world.ctx.step < 90000) {
        run_steps(&stopped->world, 7);
        const gn_body_pairs *q = &stopped->world.boundary.pairs;
        for (size_t c = 0; c < q->count; c++) held += length3(q->pair[c].shear);
    }
    assert_true(held > 0.0);
    end_resumed_alike(straight, stopped, 2000);
}

/* --- bodies without a stiffness --- */

static const char *warning(const gn_run *run, gn_warnings *list, const char *name) {
    gneiss_error error = {0};
    assert_ok(gn_run_warnings(run, list, &error), &error);
    for (size_t k = 0; k < list->count; k++)
        if (strcmp(list->warning[k].name, name) == 0) return list->warning[k].text;
    return NULL;
}

/* A cube near a floor, near another body, far from both; with a stiffness. */
static void bodies_without_a_stiffness_cause_a_warning(void **state) {
    (void)state;
    static const char *const origin[] = {"0, 0, 0.01", "0, 0, 7.05", "0, 0, 3", "0, 0, 0.01"};
    for (int k = 0; k < 4; k++) {
        char scene_text[2048];
        gn_scene scene;
        gn_run run;
        gn_warnings list;
        gneiss_error error = {0};
        snprintf(scene_text, sizeof scene_text,
                 "%swalls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1]}]\nbodies: [{name: cube, "
                 "box: {size: [0.1, 0.1, 0.1]}, origin: [%s], %sfree: true, density: 2000}, "
                 "{name: lid, box: {size: [1, 1, 0.1]}, origin: [0, 0, 7.2]}]\ntime: {step: 1e-4, "
                 "end: 1}\n",
                 head, origin[k], k == 3 ? "stiffness: 1e5, " : "");
        assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
        assert_ok(gn_run_create(&scene, &run, &error), &error);
        const char *said = warning(&run, &list, "bodies_without_stiffness");
        assert_int_equal(said != NULL, k < 2);
        if (said) assert_non_null(strstr(said, "1 body, as 'cube', passes through"));
        gn_run_free(&run);
    }
}

static void refuse(const char *what, const char *keys, const char *key, const char *why) {
    char scene_text[2048];
    gn_world w;
    gneiss_error error = {0};
    snprintf(scene_text, sizeof scene_text, "%s%s: [{name: b, %s, %s}]\ntime: {end: 1}\n", head,
             what, *what == 'w' ? "point: [0, 0, 0], normal: [0, 0, 1]" : "box: {size: [1, 1, 1]}",
             keys);
    if (world_try(&w, scene_text, "/tmp", &error) == GNEISS_OK) fail_msg("accepted: %s", keys);
    if (!strstr(error.message, key) || !strstr(error.message, why))
        fail_msg("expected '%s' and '%s' in '%s'", key, why, error.message);
}

static void errors_say_where_and_what(void **state) {
    (void)state;
    refuse("bodies", "stiffness: 1e5, friction: 0.3", "bodies[0].kratio", "friction");
    refuse("bodies", "stiffness: 1e5, material: s", "bodies[0].kratio", "friction");
    refuse("bodies", "kratio: 2", "bodies[0].kratio", "without a stiffness");
    refuse("bodies", "stiffness: 1e5, material: s, friction: 0.3, kratio: 2", "bodies[0].friction",
           "beside a material");
    refuse("walls", "stiffness: 1e5", "walls[0].stiffness", "law.stiffness hertz");
    refuse("walls", "kratio: 2", "walls[0].kratio", "law.stiffness hertz");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bodies_move_as_by_the_linear_law),
        cmocka_unit_test(bodies_rebound_with_the_restitution_of_materials),
        cmocka_unit_test(friction_is_that_of_materials),
        cmocka_unit_test(a_servo_wall_feels_the_body),
        cmocka_unit_test(the_automatic_step_follows_any_stiffness),
        cmocka_unit_test(a_block_rests_on_grains_with_its_weight),
        cmocka_unit_test(threads_and_a_resumed_run_give_the_same_bits),
        cmocka_unit_test(bodies_without_a_stiffness_cause_a_warning),
        cmocka_unit_test(errors_say_where_and_what),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
