/* Walls beside elements that convert to particles: walls load active particles. */
#include "conversion_helpers.h"
#include "solids/element_walls.h"

static const char floor_below[] =
    "walls: [{name: floor, point: [0, 0], normal: [0, 1], stiffness: 1e9, kratio: 2, friction: "
    "0.3}]\nrun: {threads: 1}\n";

static void sink(const double *x, const void *of, double u[3], double v[3]) {
    const double *how = of;
    (void)x;
    u[1] = -how[0];
    v[1] = -how[1];
}

static double lowest_active(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    double count = 0.0;
    for (size_t p = 0; p < q->soa.count; p++)
        count += is_active(w, p) && q->start[4 * p + 1] < 1e-3;
    return count;
}

/* Elements had no contact with the wall that they are in: particles activated there are free of
 * stress, and an additional overlap d stores k d^2/2 each. */
static void a_particle_activated_inside_a_wall_feels_added_loads_only(void **state) {
    (void)state;
    for (int passive = 0; passive < 2; passive++) {
        double how[2] = {1e-6, 0.0};
        char rest[200];
        block s = plate;
        snprintf(rest, sizeof rest,
                 "walls: [{name: floor, point: [0, 0.02 mm], normal: [0, 1], stiffness: 1e9%s}]\n"
                 "run: {threads: 1}\n",
                 passive ? ", passive: true" : "");
        s.rest = rest;
        gn_world *w = block_of(&s);
        (void)measured_step(w);
        set_elements(w, sink, how);
        convert(w, 12e-3, 18e-3, 0.0, 4e-3);
        const double pressed = lowest_active(w);
        assert_true(pressed > 6.0);
        assert_near(w->ledger.energy.conversion, 0.0, 1e-9 * 0.5 * 1e9 * 2e-5 * 2e-5 * pressed);
        gn_energy e = measured_step(w);
        assert_near(e.elastic_wall, 0.0, 1e-9 * 0.5 * 1e9 * 2e-5 * 2e-5 * pressed);
        how[0] = 4e-6;
        set_elements(w, sink, how);
        set_field(&w->dem.particles, sink, how);
        e = measured_step(w);
        assert_close(e.elastic_wall, 0.5 * 1e9 * 3e-6 * 3e-6 * pressed, 1e-6);
        world_end(w);
    }
}

/* The momentum of a body that falls on its particles changes by the impulse of the wall. */
static void a_body_rebounds_on_its_particles(void **state) {
    (void)state;
    const double how[2] = {0.0, 0.05};
    block s = plate;
    s.rest = floor_below;
    gn_world *w = block_of(&s);
    set_elements(w, sink, how);
    convert(w, 0.0, 30e-3, 0.0, 4e-3);
    set_elements(w, sink, how);
    set_field(&w->dem.particles, sink, how);
    run_steps(w, 1);
    const double before = whole_of(w).momentum[1];
    double impulse = 0.0;
    for (int k = 0; k < 400; k++) {
        run_steps(w, 1);
        /* The wall acts on the particles; velocities are those half a step before and after the
         * instant. */
        impulse -= w->ctx.dt * w->boundary.walls[0].force[1];
    }
    assert_near(whole_of(w).momentum[1] - before, impulse, 1e-9 * fabs(before));
    assert_true(impulse > 1.2 * fabs(before)); /* the body rebounds, and oscillates */
    gn_energy e = measured_step(w);
    assert_true(fabs(gn_energy_residual(&e)) < 1e-4);
    world_end(w);
}

/* --- walls that elements pass --- */

/* A bar pulled at its right end, only the middle of which may convert; E = M, nu = 0. */
static block bar(const char *rest) {
    return (block){.cells = {30, 8, 0},
                   .box = "{min: [15 mm, -1], max: [45 mm, 1]}",
                   .convert = "stress: 1e6, every: 10",
                   .rest = rest,
                   .elements = ", motions: [{name: left, box: {min: [-1, -1], max: [1e-6, 1]}, "
                               "motion: {vx: 0, vy: 0}}, {name: right, box: {min: [0.059999, -1], "
                               "max: [1, 1]}, motion: {vx: 2 mm/s, vy: 0}}]"};
}

static gn_wall_passed passed_of(const char *walls) {
    char rest[400];
    gn_wall_passed passed[1];
    gneiss_error error = {0};
    snprintf(rest, sizeof rest, "run: {threads: 1}\nwalls: [{name: w, stiffness: 1e9, %s}]", walls);
    const block s = bar(rest);
    gn_world *w = block_of(&s);
    const uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    if (gn_wall_predict_passed(&w->ctx, &w->solids, passed, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == hash);
    const gn_wall_passed now = gn_wall_passed_now(&w->ctx, &w->boundary, &w->solids, 0);
    assert_int_equal(now.behind, passed[0].time > 0.0 ? 0 : passed[0].behind);
    world_end(w);
    return passed[0];
}

/* The right end moves by 2 mm in the second of the run. */
static void walls_that_driven_elements_pass_are_predicted(void **state) {
    (void)state;
    const gn_wall_passed ahead = passed_of("point: [61 mm, 0], normal: [-1, 0]"),
                         far = passed_of("point: [62.1 mm, 0], normal: [-1, 0]"),
                         coming = passed_of(
                             "point: [64 mm, 0], normal: [-1, 0], motion: {vx: -2.5 mm/s}"),
                         floor = passed_of("point: [0, 0], normal: [0, 1]"),
                         inside = passed_of("point: [0, 1 mm], normal: [0, 1]"),
                         /* this platen has the motion that makes it press particles */
        platen = passed_of("point: [60 mm, 0], normal: [-1, 0], motion: {vx: 2 mm/s}");
    assert_near(ahead.time, 0.5, 1e-3);
    assert_near(ahead.deepest, 1e-3, 1e-6);
    assert_int_equal(ahead.touching, 0);
    assert_int_equal(far.behind + far.touching, 0);
    assert_near(coming.time, 4.0 / 4.5, 1e-3);
    assert_int_equal(floor.behind, 0);    /* nu = 0: it does not press against the wall */
    assert_int_equal(floor.touching, 29); /* the particles at the ends are held */
    assert_int_equal(inside.behind, 31);
    assert_near(inside.time, 0.0, 0.0);
    assert_near(inside.deepest, 1e-3, 1e-6);
    assert_int_equal(platen.behind + platen.touching, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_activated_inside_a_wall_feels_added_loads_only),
        cmocka_unit_test(a_body_rebounds_on_its_particles),
        cmocka_unit_test(walls_that_driven_elements_pass_are_predicted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
