/* Ends of a test that follow a reading: the reading grows at the prescribed rate where the motion
 * of the ends alone would be unstable, and the motion always remains within its prescribed bounds.
 * */
#include "run_helpers.h"

/* Eleven spheres in a row, drawn apart by the outer ones; the bond between the sixth and seventh is
 * weak. k = 1e6 N/m each. Softening from R = 10 N at u_l = 10 um to nothing at 12.25 u_l has a
 * slope of 0.8 of the stiffness of the other nine in a row, k/9: the weak bond grows by a fifth of
 * what the ends do while it softens. A wave takes 30 us from end to end. */
static char *chain(const char *law, const char *material, const char *control, const char *run) {
    static char s[4096];
    int used = snprintf(
        s, sizeof s,
        "specimen: {particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm], [4 mm, 0, 0, 1 mm], [6 mm, 0, "
        "0, 1 mm], [8 mm, 0, 0, 1 mm], [10 mm, 0, 0, 1 mm], [12 mm, 0, 0, 1 mm], [14 mm, 0, 0, 1 "
        "mm], [16 mm, 0, 0, 1 mm], [18 mm, 0, 0, 1 mm], [20 mm, 0, 0, 1 mm]], material: a}\n"
        "materials:\n"
        "- {name: a, density: 2000, normal_stiffness: 1e6, kratio: 2, friction: 0.3, "
        "bond_tension_limit: 1e3, bond_shear_limit: 1e3%s}\n"
        "- {name: b, density: 2000, normal_stiffness: 1e6, kratio: 2, friction: 0.3, "
        "bond_tension_limit: 1e3, bond_shear_limit: 1e3%s}\n"
        "contacts: [{between: [a, b], bond_tension_limit: 10}]\n"
        "law: {stiffness: uniform%s}\nbonds: {}\n"
        "damping: {background: {model: viscous, coefficient: 3e4}}\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
        "sets:\n- {name: half, select: {ids: [6, 7, 8, 9, 10]}, material: b}\n"
        "- {name: left, select: {ids: [0]}, motion: {vx: -10 mm/s}}\n"
        "- {name: right, select: {ids: [10]}, motion: {vx: 10 mm/s}}\n"
        "- {name: here, select: {ids: [5]}}\n- {name: there, select: {ids: [6]}}\n",
        material, material, law);
    snprintf(s + used, sizeof s - (size_t)used,
             "test: {kind: tension, axis: x, lower: left, upper: right, length: 20 mm, area: 4 "
             "mm2, opening: {axis: x, lower: here, upper: there}%s}\n"
             "time: {end: 22 ms}\noutput: {history_rows: 2000, snapshots: 0}\nrun: {%s}\n",
             control, run);
    return s;
}

static const char softens[] = ", softening: ratio", ratio[] = ", fracture_ratio: 11.25";
static const char control[] = ", control: {opening: 5 mm/s, response: 2 ms, reverse: 0.5}";

static void finish(gn_run *run) {
    gneiss_error error = {0};
    while (!run->finished)
        if (gn_run_advance(run, 1e3, NULL, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

/* m/s, while the weak bond opens from 30 to 90 um, well within its softening. */
static double opening_rate(const gn_run *run) {
    const double *u = gn_history_column(&run->history, "opening"),
                 *t = gn_history_column(&run->history, "time");
    size_t a = 0, b = 0;
    while (a < run->history.row_count && u[a] < 30e-6) a++;
    while (b < run->history.row_count && u[b] < 90e-6) b++;
    assert_true(b < run->history.row_count && b > a);
    return (u[b] - u[a]) / (t[b] - t[a]);
}

/* Without control the bond opens five times as fast as the ends, to within a row; with control it
 * opens at its rate, which it has not quite reached at the beginning because of the response time
 * (2 ms of 12 ms). */
static void an_opening_grows_at_its_rate(void **state) {
    (void)state;
    gn_run *free_one = run_of("%s", chain(softens, ratio, "", "threads: 1"));
    finish(free_one);
    assert_near(opening_rate(free_one), 0.1, 0.01);
    run_end(free_one);
    gn_run *run = run_of("%s", chain(softens, ratio, control, "threads: 1"));
    finish(run);
    assert_near(opening_rate(run), 5e-3, 0.05 * 5e-3);
    const double *residual = gn_history_column(&run->history, "energy_residual");
    for (size_t r = 0; r < run->history.row_count; r++) assert_near(residual[r], 0.0, 1e-3);
    run_end(run);
}

/* A brittle bond releases more than the ends can take back in time: they move back at their largest
 * speed and no faster. */
static void the_motion_is_bounded_when_the_reading_runs_away(void **state) {
    (void)state;
    gn_run *run = run_of("%s", chain("", "", control, "threads: 1"));
    finish(run);
    const double *factor = gn_history_column(&run->history, "control"),
                 *strain = gn_history_column(&run->history, "strain");
    double least = 1.0, most = 0.0, furthest = 0.0, back = 0.0;
    for (size_t r = 0; r < run->history.row_count; r++) {
        least = fmin(least, factor[r]);
        most = fmax(most, factor[r]);
        furthest = fmax(furthest, strain[r]);
        back = fmax(back, furthest - strain[r]);
    }
    assert_int_equal(run->world.dem.broken_tension, 1);
    assert_near(least, -0.5, 0.0);
    assert_near(most, 1.0, 0.0);
    assert_true(
        back >
        0.3 * furthest); /* the ends move back until the opening has its value for that time */
    assert_near(gn_energy_residual(&run->world.ledger.reading), 0.0, 0.01);
    run_end(run);
}

static void a_scene_without_control_is_not_touched(void **state) {
    (void)state;
    gn_run *run = run_of("%s", chain(softens, ratio, "", "threads: 1"));
    assert_null(gn_history_column(&run->history, "control"));
    assert_near(gn_control_of(&run->world.ctx, "left", 0), 1.0, 0.0);
    run_end(run);
    run = run_of("%s", chain(softens, ratio, control, "threads: 1"));
    run->world.ctx.machine.factor = 0.25;
    assert_near(gn_control_of(&run->world.ctx, "left", 0), 0.25, 0.0);
    assert_near(gn_control_of(&run->world.ctx, "left", 1), 1.0, 0.0); /* across */
    assert_near(gn_control_of(&run->world.ctx, "here", 0), 1.0,
                0.0); /* this is no end of the test */
    run_end(run);
}

/* The machine at a factor of a quarter, backwards, between two readings: the prescribed motion of
 * the ends along the axis is scaled, and nothing else. */
static gn_world *machine_at(const char *scene_text, int64_t step, double factor) {
    gn_world *w = world_of("%s", scene_text);
    run_steps(w, step);
    w->ctx.machine.factor = factor;
    run_steps(w, 1);
    return w;
}

static void walls_and_bodies_are_ends_that_follow(void **state) {
    (void)state;
    gn_world *w = machine_at(
        "specimen: {lattice: {kind: cubic, radius: 1 mm, cells: [3, 3, 3]}}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e6, kratio: 2, "
        "bond_tension_limit: 1e3, bond_shear_limit: 1e3}]\n"
        "law: {stiffness: uniform}\nbonds: {}\n"
        "walls:\n- {name: foot, point: [0, 0, -1 mm], normal: [0, 0, 1], stiffness: 1e6, motion: "
        "{vx: 3 mm/s, vz: 5 mm/s}}\n"
        "- {name: side, point: [-2 mm, 0, 0], normal: [1, 0, 0], stiffness: 1e6, motion: {vz: 7 "
        "mm/s}}\n"
        "bodies: [{name: head, box: {size: [8 mm, 8 mm, 2 mm]}, origin: [2 mm, 2 mm, 6 mm], "
        "stiffness: 1e6, motion: {vz: -8 mm/s, wz: 1}}]\n"
        "test: {kind: compression, axis: z, lower: foot, upper: head, length: 6 mm, area: 36 mm2, "
        "control: {lateral_strain: 1e-3 1/s, response: 1 ms}}\n"
        "time: {end: 1}\nrun: {threads: 1}\n",
        3, -0.25);
    const gn_wall *wall = w->boundary.walls;
    assert_near(wall[0].velocity[2], -0.25 * 5e-3, 0.0);
    assert_near(wall[0].velocity[0], 3e-3, 0.0);
    assert_near(wall[1].velocity[2], 7e-3, 0.0);
    assert_near(w->boundary.bodies[0].velocity[2], 0.25 * 8e-3, 0.0);
    assert_near(w->boundary.bodies[0].spin[2], 1.0, 0.0);
    world_end(w);
}

static void motions_of_elements_are_ends_that_follow(void **state) {
    (void)state;
    gn_world *w = machine_at(
        "dimension: 2\n"
        "elements:\n  rectangle: {size: [0.04, 0.02], cells: [8, 4]}\n"
        "  materials: [{young: 1e9, poisson: 0.2, density: 2000}]\n"
        "  motions:\n  - {name: left, group: x_lower, motion: {vx: 0}}\n"
        "  - {name: right, group: x_upper, motion: {vx: 4 mm/s, vy: 0}}\n"
        "  - {name: low, box: {min: [0.01, 0], max: [0.01, 0.02]}}\n"
        "  - {name: high, box: {min: [0.03, 0], max: [0.03, 0.02]}}\n"
        "test: {kind: tension, axis: x, lower: left, upper: right, opening: {axis: x, lower: low, "
        "upper: high}, control: {opening: 1 mm/s, response: 1 ms}}\n"
        "time: {end: 1}\nrun: {threads: 1}\n",
        3, -0.25);
    double before[3], after[3];
    gn_elements_travel(&w->solids, 1, before);
    w->ctx.machine.factor = 0.5;
    run_steps(w, 1);
    gn_elements_travel(&w->solids, 1, after);
    assert_near(after[0] - before[0], 0.5 * 4e-3 * w->ctx.dt, 1e-6 * 4e-3 * w->ctx.dt);
    world_end(w);
}

static uint64_t hash_after(const char *scene, int64_t count) {
    gneiss_error error = {0};
    gn_run *run = run_of("%s", scene);
    if (gn_run_steps(run, count, &error) != GNEISS_OK) fail_msg("%s", error.message);
    uint64_t hash = gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                                  &run->world.solids, &run->world.box);
    run_end(run);
    return hash;
}

static void threads_and_a_break_do_not_matter(void **state) {
    (void)state;
    char path[] = "/tmp/gneiss_control_XXXXXX";
    gneiss_error error = {0};
    close(mkstemp(path));
    const char *precisions[] = {"double", "mixed"};
    for (int p = 0; p < 2; p++) {
        char one[64], two[64];
        snprintf(one, sizeof one, "threads: 1, precision: %s", precisions[p]);
        snprintf(two, sizeof two, "threads: 2, precision: %s", precisions[p]);
        uint64_t hash = hash_after(chain(softens, ratio, control, one), 3000);
        assert_true(hash == hash_after(chain(softens, ratio, control, two), 3000));
        gn_run *run = run_of("%s", chain(softens, ratio, control, one));
        for (int k = 0; k < 3; k++) {
            /* The run is interrupted between readings of the control. */
            if (gn_run_steps(run, k < 2 ? 997 : 3000 - 2 * 997, &error) != GNEISS_OK)
                fail_msg("%s", error.message);
            if (gn_checkpoint_write(run, path, &error) != GNEISS_OK) fail_msg("%s", error.message);
            run_end(run);
            run = calloc(1, sizeof *run);
            if (gn_run_load(path, NULL, 0, run, &error) != GNEISS_OK) fail_msg("%s", error.message);
        }
        assert_true(gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                                  &run->world.solids, &run->world.box) == hash);
        run_end(run);
    }
    unlink(path);
}

static void expect_refused(const char *said, const char *message) {
    gneiss_error error = {0};
    gn_scene scene;
    const char *said_so = chain(softens, ratio, said, "threads: 1");
    assert_int_equal(gn_scene_parse(said_so, "s.yaml", NULL, NULL, 0, &scene, &error),
                     GNEISS_ERROR_INPUT);
    if (!strstr(error.message, message)) fail_msg("%s", error.message);
}

static void unsuitable_controls_are_refused(void **state) {
    (void)state;
    expect_refused(", control: {response: 1 ms}",
                   "s.yaml:16:134: test.control: expected opening or lateral_strain, found none");
    expect_refused(", control: {opening: 1 mm/s, lateral_strain: 1, response: 1 ms}",
                   "test.control: expected opening or lateral_strain, found both");
    expect_refused(", control: {opening: 1 mm/s}",
                   "test.control.response: required, but not given");
    expect_refused(", control: {opening: 1 1/s, response: 1 ms}", "test.control.opening");
    expect_refused(", control: {opening: 0, response: 1 ms}", "test.control.opening");
    expect_refused(", control: {lateral_strain: 1 m/s, response: 1 ms}",
                   "test.control.lateral_strain");
    expect_refused(", control: {opening: 1 mm/s, response: -1}", "test.control.response");
    expect_refused(", control: {opening: 1 mm/s, response: 1, reverse: 11}",
                   "test.control.reverse");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_opening_grows_at_its_rate),
        cmocka_unit_test(the_motion_is_bounded_when_the_reading_runs_away),
        cmocka_unit_test(a_scene_without_control_is_not_touched),
        cmocka_unit_test(walls_and_bodies_are_ends_that_follow),
        cmocka_unit_test(motions_of_elements_are_ends_that_follow),
        cmocka_unit_test(threads_and_a_break_do_not_matter),
        cmocka_unit_test(unsuitable_controls_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
