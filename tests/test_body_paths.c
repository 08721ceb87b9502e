/* Paths of bodies in an automatic step, and the rotation of free ones. */
#include "body_helpers.h"
#include "parts.h"

#include "run/run.h"

static const gn_rigid *body(const gn_world *w) {
    return &w->boundary.bodies[0];
}

/* --- paths --- */

/* Two grains of 2 cm far away, free if `held` is "". */
#define GRAINS(held)                                                                               \
    "dimension: 3\nspecimen: {particles: [[1, 0, 0.02, 0.02], [1.05, 0, 0.02, 0.02]], group: 0}\n" \
    "materials: [{name: m, density: 2500, normal_stiffness: 5e3, kratio: 2, friction: 0.3}]\n"     \
    "law: {stiffness: uniform}\ngravity: [0, 0, -9.81]\n" held                                     \
    "domain: {min: [-999, -999, -999], max: [999, 999, 999]}\ntime: {end: 0.5}\n"                  \
    "run: {threads: 1}\n"
#define HELD "sets: [{name: d, select: {all: true}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
#define BLOCK                                                                                      \
    "box: {size: [0.1, 0.06, 0.03]}, stiffness: 5e3, kratio: 2, friction: 0.5, "                   \
    "origin: [0, 0, 9]"

/* m, path of the farthest vertex relative to the smallest radius; rad: the largest rotation in any
 * step of the run. */
static void farthest(gn_world *w, double *path, double *turn) {
    *path = *turn = 0.0;
    while (w->ctx.time < w->ctx.scene.end) {
        run_steps(w, 1);
        for (size_t k = 0; k < w->ctx.scene.body_count; k++) {
            const gn_rigid *b = &w->boundary.bodies[k];
            double spin = length3(b->spin), speed = length3(b->velocity) + spin * b->reach;
            *path = fmax(*path, w->ctx.dt_past * speed / w->dem.radius_min);
            *turn = fmax(*turn, w->ctx.dt_past * spin);
        }
    }
}

/* Bodies that fall, fly or spin; driven, also suddenly, and in the reverse direction in between;
 * under Hertz's law; hit by a heavy body; small ones, which rotate by large angles before they have
 * moved far. */
static const char *const moving[] = {
    GRAINS(HELD) "bodies: [{name: b, " BLOCK ", free: true, density: 2500}]\n",
    GRAINS("") "bodies: [{name: b, " BLOCK ", free: true, density: 2500}]\n",
    GRAINS("") "bodies: [{name: b, " BLOCK ", free: true, density: 2500, initial_velocity: [0, 20, "
               "0]}]\n",
    GRAINS("") "bodies: [{name: b, " BLOCK ", free: true, density: 2500, initial_spin: [9, 300, "
               "9]}]\n",
    GRAINS("") "bodies: [{name: b, " BLOCK ", motion: {wz: 300}}]\n",
    GRAINS(HELD) "bodies: [{name: b, " BLOCK ", motion: {vx: [[0.2, 0], [0.2001, 80], [0.3, -80], "
                 "[0.3001, 0]], wy: [[0.35, 0], [0.35001, 500]]}}]\n",
    GRAINS(HELD) "bodies: [{name: b, " BLOCK ", motion: {vz: 0, vx: 1, vy: 0}, free: true, "
                 "density: 2500, initial_spin: [200, 0, 1]}]\n",
    GRAINS(HELD) "bodies: [{name: b, " BLOCK ", free: true, density: 25}, {name: c, box: {size: "
                 "[0.1, 0.1, 0.1]}, origin: [0, 0, 10], stiffness: 5e3, free: true, density: 9000, "
                 "initial_velocity: [0, 0, -9]}]\n",
    GRAINS(HELD) "bodies: [{name: b, box: {size: [1e-3, 2e-3, 3e-3]}, stiffness: 1e3, free: true, "
                 "density: 2500, initial_spin: [900, 0.1, 1]}]\n",
};

static void no_vertex_moves_farther_than_a_quarter_of_the_smallest_radius(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof moving / sizeof *moving; k++) {
        double path, turn;
        gn_world *w = world_of("%s", moving[k]);
        farthest(w, &path, &turn);
        print_message("# %zu: %.3g of the radius, %.3g rad, %lld steps\n", k, path, turn,
                      (long long)w->ctx.step);
        assert_true(path <= 0.25 * (1.0 + 1e-12));
        assert_true(turn <= 0.25 * (1.0 + 1e-12));
        world_end(w);
    }
}

/* Free fall without neighbours, g t^2/2, is exact to rounding for any steps, also for lowered
 * ones. */
/* A gate that moves away from grains at 20 m/s: its corner passes the one that leans on it in many
 * steps. */
static void a_fast_gate_keeps_the_ledger(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 2\nbodies: [{name: gate, polygon: [[0, 0], [10e-3, 0], [10e-3, 0.1], [0, "
        "0.1]], "
        "stiffness: 1e4, motion: {vy: [[0, 0], [1e-3, 0], [1.1e-3, 20]]}}]\n"
        "walls: [{name: floor, point: [0, 0], normal: [0, 1], stiffness: 1e4}]\n"
        "specimen: {particles: [[-1.9e-3, 2e-3, 2e-3], [-5.9e-3, 2e-3, 2e-3], [-3.9e-3, 5.5e-3, "
        "2e-3]], group: 0}\n"
        "materials: [{name: g, density: 2500, normal_stiffness: 1e4, kratio: 2, friction: 0.3}]\n"
        "law: {stiffness: uniform}\ngravity: [0, -9.81]\n"
        "domain: {min: [-9, -9], max: [9, 9]}\ntime: {end: 4e-3}\nrun: {threads: 1}\n");
    run_until(w, 4e-3);
    const gn_energy e = measured_step(w);
    assert_true(fabs(gn_energy_residual(&e)) < 0.01);
    world_end(w);
}

static void a_long_fall_is_exact(void **state) {
    (void)state;
    gn_world *w = world_of("%s", moving[0]);
    while (w->ctx.time < w->ctx.scene.end) measured_step(w);
    assert_true(w->ctx.dt_lowered > 1);
    assert_close(body(w)->start[2] - body(w)->position[2], 0.5 * 9.81 * w->ctx.time * w->ctx.time,
                 1e-12);
    assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 1e-11);
    world_end(w);
}

static void a_resumed_run_lowers_its_step_alike(void **state) {
    (void)state;
    const char *const saved = "/tmp/gneiss-body-paths.h5";
    for (int k = 0; k < 2; k++) {
        gn_run straight, stopped, resumed;
        gn_run *const runs[] = {&straight, &stopped};
        gn_scene scene;
        gneiss_error error = {0};
        for (int n = 0; n < 2; n++) {
            assert_ok(
                gn_scene_parse(moving[k == 0 ? 5 : 7], "s.yaml", NULL, NULL, 0, &scene, &error),
                &error);
            assert_ok(gn_run_create(&scene, runs[n], &error), &error);
        }
        run_until(&straight.world, 0.45);
        run_until(&stopped.world, k == 0 ? 0.19 : 0.1);
        assert_ok(gn_checkpoint_write(&stopped, saved, &error), &error);
        assert_ok(gn_checkpoint_load(saved, NULL, 0, &resumed, &error), &error);
        run_until(&resumed.world, 0.45);
        assert_true(gn_world_hash(&straight.world.ctx, &straight.world.dem,
                                  &straight.world.boundary, &straight.world.solids,
                                  &straight.world.box) ==
                    gn_world_hash(&resumed.world.ctx, &resumed.world.dem, &resumed.world.boundary,
                                  &resumed.world.solids, &resumed.world.box));
        assert_true(straight.world.ctx.dt_lowered == resumed.world.ctx.dt_lowered);
        for (int n = 0; n < 2; n++) gn_run_free(runs[n]);
        gn_run_free(&resumed);
        unlink(saved);
    }
}

/* --- bodies alone --- */

/* One held grain, where only the body limits the step. */
static void a_body_alone_has_a_step(void **state) {
    (void)state;
    const char *const motions[] = {
        "free: true, density: 2500, initial_spin: [1, 30, 1]",
        "free: true, density: 2500, initial_velocity: [0, 1e-6, 0]",
        "motion: {vx: [[0.5, 0], [0.6, 3]]}",
    };
    for (int k = 0; k < 3; k++) {
        double path, turn;
        gn_world *w =
            world_of("%sbodies: [{name: b, " BLOCK ", %s}]\ntime: {end: 1}\n", head3, motions[k]);
        assert_true(w->ctx.dt <= 0.01);
        farthest(w, &path, &turn);
        assert_true(w->ctx.step >= 100 && path <= 0.25 && turn <= 0.25);
        world_end(w);
    }
    /* A body in free fall. */
    gn_world *w = world_of("%sgravity: [0, 0, -10]\nbodies: [{name: b, " BLOCK
                           ", free: true, density: 2500}]\ntime: {end: 1}\n",
                           head3);
    run_until(w, 0.99);
    assert_close(body(w)->start[2] - body(w)->position[2], 5.0 * w->ctx.time * w->ctx.time, 1e-11);
    world_end(w);
    text *t = calloc(1, sizeof *t);
    add(t, "%sbodies: [{name: b, " BLOCK "}]\ntime: {end: 1}\n", head3);
    assert_change_refused(t->s, "name: b", "name: c",
                          "time.step: required, because no moving part");
    free(t);
}

/* --- turns --- */

/* A box beside two grains of 1 m, for which a long step would be stable, spins about an oblique
 * axis; `step` seconds, 0: automatic. */
static gn_world *spinning(const double size[3], const double spin[3], const char *more,
                          double step) {
    char given[48] = "";
    if (step > 0.0) snprintf(given, sizeof given, "step: %.17g, ", step);
    return world_of(
        "dimension: 3\nspecimen: {particles: [[9, 0, 0, 1], [12, 0, 0, 1]], group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e4, kratio: 2}]\n"
        "law: {stiffness: uniform}\ndomain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
        "bodies: [{name: b, box: {size: [%g, %g, %g]}, stiffness: 1e3, free: true, density: 2500, "
        "rotation: [0.3, -0.4, 1], initial_spin: [%.17g, %.17g, %.17g]%s}]\n"
        "time: {%send: 99}\nrun: {threads: 1}\n",
        size[0], size[1], size[2], spin[0], spin[1], spin[2], more, given);
}

/* rad: how far two bodies are turned from each other; *spin: the difference of their spins, over
 * the spin. */
static double apart(const gn_rigid *a, const gn_rigid *b, double *spin) {
    double sum = 0.0, d[3];
    for (int k = 0; k < 4; k++) sum += a->turn[k] * b->turn[k];
    for (int k = 0; k < 3; k++) d[k] = a->spin[k] - b->spin[k];
    *spin = length3(d) / length3(a->spin);
    return 2.0 * sqrt(fmax(0.0, 1.0 - sum * sum));
}

/* Compares ten rotations in steps set by the scene, in which the body rotates by `turn`, with those
 * in steps of `part` rad or a little less. */
static void turns(const double size[3], const double spin[3], const char *more, double turn,
                  double part, double *angle_off, double *spin_off) {
    gn_world *w = spinning(size, spin, more, 0.0);
    double scale = turn / w->ctx.dt / length3(spin), fast[3], momentum[3];
    for (int k = 0; k < 3; k++) fast[k] = scale * spin[k];
    world_end(w);
    w = spinning(size, fast, more, 0.0);
    gn_world *fine = spinning(size, fast, more, w->ctx.dt);
    memcpy(momentum, body(w)->momentum, sizeof momentum);
    const int64_t parts = turn > part ? (int64_t)(turn / part) + 1 : 1,
                  many = part > turn ? (int64_t)(part / turn) : 1;
    while (w->ctx.time < 10.0 * 2.0 * pi / length3(fast)) {
        double start = w->ctx.time;
        run_steps(w, many);
        fine->ctx.scene.step = fine->ctx.dt = (w->ctx.time - start) / (double)parts;
        run_steps(fine, parts);
    }
    for (int k = 0; k < 3; k++) assert_true(body(w)->momentum[k] == momentum[k]);
    *angle_off = apart(body(w), body(fine), spin_off);
    world_end(w);
    world_end(fine);
}

/* Fourth order in steps of 0.02 rad is practically exact, as far as steps of 1e-3 rad of second
 * order can show. */
static void ten_turns_are_right_at_any_step(void **state) {
    (void)state;
    const double size[][3] = {
        {0.1, 0.06, 0.03}, {0.1, 0.1, 0.005}, {0.1, 0.01, 0.012}, {0.04, 0.1, 0.09}};
    const double spin[][3] = {{1, 30, 1}, {2, -5, 4}};
    const double turn[] = {0.0049, 0.06, 0.12};
    double worst = 0.0, worst_spin = 0.0, worst_held = 0.0, plain, plain_spin;
    turns(size[0], spin[0], "", 0.02, 1e-3, &plain, &plain_spin);
    assert_true(plain < 2e-5 && plain_spin < 2e-5);
    for (int s = 0; s < 4; s++)
        for (int k = 0; k < 2; k++)
            for (int t = 0; t < 3; t++) {
                double angle, off;
                turns(size[s], spin[k], "", turn[t], 0.02, &angle, &off);
                worst = fmax(worst, angle);
                worst_spin = fmax(worst_spin, off);
                if (t < 2 || k > 0) continue;
                const double flat[3] = {spin[k][0], spin[k][1], 0.0};
                turns(size[s], flat, ", motion: {wz: 0}", turn[t], 2e-3, &angle, &off);
                worst_held = fmax(worst_held, fmax(angle, off));
            }
    print_message("# after ten turns: %.2g rad, %.2g of the spin; with bearings %.2g\n", worst,
                  worst_spin, worst_held);
    assert_true(worst < 1e-3 && worst_spin < 1e-3 && worst_held < 1e-3);
}

/* A box whose farthest vertex is 0.0602 m from its centre, and twice that from a corner. */
static void spins_beyond_light_are_refused(void **state) {
    (void)state;
    text *t = calloc(1, sizeof *t);
    add(t, "%sbodies: [{name: b, " BLOCK ", motion: {wz: 1}}]\ntime: {end: 1}\n", head3);
    assert_change_refused(t->s, "wz: 1", "wz: 1e12",
                          "bodies[0].motion.wz: expected at most 2.491e");
    assert_change_refused(t->s, "wz: 1", "wx: [[0, 0], [1, -1e12]]", "bodies[0].motion.wx");
    assert_change_refused(t->s, "motion: {wz: 1}",
                          "free: true, density: 1, initial_spin: [0, 6e9, 0]",
                          "bodies[0].initial_spin: expected at most 4.983e+09 rad/s");
    assert_change_refused(t->s, "wz: 1", "wz: 1e12", "s.yaml:8:");
    free(t);
    gn_world *w =
        world_of("%sbodies: [{name: b, " BLOCK ", motion: {wz: 2.4e9}}]\ntime: {end: 1}\n", head3);
    world_end(w);
}

int main(int argc, char **argv) {
    (void)argv;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_vertex_moves_farther_than_a_quarter_of_the_smallest_radius),
        cmocka_unit_test(a_fast_gate_keeps_the_ledger),
        cmocka_unit_test(a_long_fall_is_exact),
        cmocka_unit_test(a_resumed_run_lowers_its_step_alike),
        cmocka_unit_test(a_body_alone_has_a_step),
        cmocka_unit_test(spins_beyond_light_are_refused),
    };
    const struct CMUnitTest long_tests[] = {
        cmocka_unit_test(ten_turns_are_right_at_any_step),
    };
    return run_part(argc, tests, long_tests);
}
