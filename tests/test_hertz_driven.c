/* Hertz's law with the automatic step if a driving motion starts late or a force other than gravity
 * acts: nothing indicates that in advance. */
#include "run_helpers.h"

static const char *const grain =
    "materials: [{name: g, density: 2500, friction: 0, young: 1e9, poisson: 0.25, "
    "restitution: 0.7}]\n"
    "law: {stiffness: hertz}\n"
    "domain: {min: [-100, -100, -100], max: [100, 100, 100]}\n"
    "time: {end: 0.05}\nrun: {threads: 1}\n";

static const char late[] = "[[0, 0], [0.01, 0], [0.0100001, 5]]";

/* m/s along z of the last particle, and the residual, at the end. */
static double struck_by(const char *driver, double gap) {
    gn_world *w = world_of("dimension: 3\nspecimen: {particles: [%s[0, 0, %.9g, 5e-3]], group: 0}\n"
                           "%s%s",
                           strncmp(driver, "sets", 4) ? "" : "[0, 0, 0, 5e-3], ",
                           (strncmp(driver, "sets", 4) ? 5e-3 : 10e-3) + gap, driver, grain);
    run_until(w, 0.0105);
    gn_energy e = measured_step(w);
    double found = 0.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++)
        if (w->dem.particles.id[p] == w->dem.ids - 1) found = w->dem.particles.vel[4 * p + 2];
    assert_true(fabs(gn_energy_residual(&e)) < 2e-3);
    assert_true(fabs(e.step_change) < 0.02 * fabs(found * found));
    world_end(w);
    return found;
}

/* The driver is at rest for 0.01 s, then moves suddenly at V = 5 m/s: the struck object leaves at
 * the speed (1 + e) V. */
static void delayed_motion_gives_the_same_rebound(void **state) {
    (void)state;
    char driver[3][512];
    snprintf(driver[0], sizeof driver[0],
             "sets: [{name: p, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: %s}}]\n", late);
    snprintf(driver[1], sizeof driver[1],
             "walls: [{name: w, point: [0, 0, 0], normal: [0, 0, 1], motion: {vz: %s}}]\n", late);
    snprintf(driver[2], sizeof driver[2],
             "bodies: [{name: b, box: {size: [0.04, 0.04, 0.01]}, origin: [-0.02, -0.02, -0.01], "
             "motion: {vx: 0, vy: 0, vz: %s}}]\n",
             late);
    static const double gaps[] = {1e-6, 1e-4, 1e-3};
    for (int kind = 0; kind < 3; kind++)
        for (int k = 0; k < 3; k++) assert_near(struck_by(driver[kind], gaps[k]) / 5.0, 1.7, 0.01);
}

/* Stages are entered by runs. */
static void step_of_run(gn_run *run) {
    gneiss_error error = {0};
    if (gn_run_steps(run, 1, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

/* The motion is started by a stage, beside a loose lattice: the result is the same as from the
 * start. */
static void a_wall_that_a_stage_starts_strikes_as_one_that_moves_from_the_start(void **state) {
    (void)state;
    double fastest[2];
    for (int staged = 0; staged < 2; staged++) {
        gn_run *run = run_of(
            "dimension: 3\n"
            "specimen: {lattice: {kind: cubic, radius: 5e-3, cells: [4, 4, 4], origin: [1e-4, "
            "1e-4, 1e-4], spacing: 1.01}, group: 0}\n"
            "walls: [{name: p, point: [0, 0, 0], normal: [0, 0, 1]%s}]\n"
            "%s%s",
            staged ? "" : ", motion: {vz: 0.5}",
            staged ? "stages:\n  - {name: a, end: {time: 0.01}}\n"
                     "  - {name: b, walls: {p: {motion: {vz: 0.5}}}, end: {time: 0.02}}\n"
                   : "",
            grain);
        double most2 = 0.0, end = staged ? 0.02 : 0.01;
        while (run->world.ctx.time < end) {
            step_of_run(run);
            most2 = fmax(most2, run->world.dem.done.motion.speed2);
        }
        fastest[staged] = sqrt(most2);
        run_end(run);
    }
    assert_near(fastest[1], fastest[0], 0.05 * fastest[0]);
}

/* A force that begins to push a touching sphere: like a weight of the same magnitude it compresses
 * the contact to the overlap at which 4/3 E* sqrt(r) u^1.5 equals the force, and the excess of its
 * work is dissipated in the dashpot. */
static void a_force_presses_as_the_same_weight_does(void **state) {
    (void)state;
    const double r = 5e-3, modulus = 1e9 / (1.0 - 0.0625);
    static const double forces[] = {1.0, 50.0};
    for (int k = 0; k < 2; k++) {
        gn_world *w =
            world_of("dimension: 3\nspecimen: {particles: [[0, 0, 5e-3, 5e-3]], group: 0}\n"
                     "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1]}]\n"
                     "sets: [{name: a, select: {all: true}, force: [0, 0, %g]}]\n%s",
                     -forces[k], grain);
        double most = pow(forces[k] / (4.0 / 3.0 * modulus * sqrt(r)), 2.0 / 3.0);
        run_until(w, 0.05);
        gn_energy e = measured_step(w);
        assert_near(r - w->dem.particles.pos[2], most, 1e-6 * most);
        assert_true(fabs(gn_energy_residual(&e)) < 2e-3);
        world_end(w);
    }
}

/* The examined limits are known after a resume: the same steps, the same bits. */
static void delayed_motions_resume_to_the_same_bits(void **state) {
    (void)state;
    gn_run *a =
        run_of("dimension: 3\nspecimen: {particles: [[0, 0, 5.0001e-3, 5e-3], [0, 0, "
               "15.3e-3, 5e-3]], group: 0}\n"
               "walls:\n"
               "  - {name: w, point: [0, 0, 0], normal: [0, 0, 1], motion: {vz: [[0, 0], "
               "[0.01, 0], [0.02, 1], [0.04, 3]]}}\n"
               "  - {name: lid, point: [0, 0, 30e-3], normal: [0, 0, -1], servo: {force: 1, "
               "max_velocity: 0.1}}\n%s",
               grain);
    while (a->world.ctx.time < 0.013) run_steps(&a->world, 1);
    gn_run *b = resumed_of(a);
    for (int k = 0; k < 5; k++) {
        run_steps(&a->world, 300);
        run_steps(&b->world, 300);
        assert_true(gn_world_hash(&a->world.ctx, &a->world.dem, &a->world.boundary,
                                  &a->world.solids, &a->world.box) ==
                    gn_world_hash(&b->world.ctx, &b->world.dem, &b->world.boundary,
                                  &b->world.solids, &b->world.box));
    }
    run_end(a);
    run_end(b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(delayed_motion_gives_the_same_rebound),
        cmocka_unit_test(a_wall_that_a_stage_starts_strikes_as_one_that_moves_from_the_start),
        cmocka_unit_test(a_force_presses_as_the_same_weight_does),
        cmocka_unit_test(delayed_motions_resume_to_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
