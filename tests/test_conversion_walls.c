/* Walls beside elements that convert to particles: walls load active particles. */
#include "conversion_helpers.h"

static const char floor_below[] =
    "walls: [{name: floor, point: [0, 0], normal: [0, 1], stiffness: 1e9, kratio: 2, friction: "
    "0.3}]\nrun: {threads: 1}\n";

static void sink(const double *x, const void *of, double u[3], double v[3]) {
    const double *how = of;
    (void)x;
    u[1] = -how[0];
    v[1] = -how[1];
}

static double lowest_awake(const gn_world *w) {
    const gn_particles *q = &w->dem.particles;
    double count = 0.0;
    for (size_t p = 0; p < q->soa.count; p++) count += is_awake(w, p) && q->start[4 * p + 1] < 1e-3;
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
        const double pressed = lowest_awake(w);
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

/* The momentum of a body that falls on its particles is what the wall gives it. */
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
        /* On the particles; velocities are those half a step before and after the instant. */
        impulse -= w->ctx.dt * w->boundary.walls[0].force[1];
    }
    assert_near(whole_of(w).momentum[1] - before, impulse, 1e-9 * fabs(before));
    assert_true(impulse > 1.2 * fabs(before)); /* it goes up again, and swings */
    gn_energy e = measured_step(w);
    assert_true(fabs(gn_energy_residual(&e)) < 1e-4);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_activated_inside_a_wall_feels_added_loads_only),
        cmocka_unit_test(a_body_rebounds_on_its_particles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
