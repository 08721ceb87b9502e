/* Masses raised for a longer step: as much as the requested step needs, without additional weight
 * or loss of energy. */
#include "timestep/timestep.h"
#include "world_helpers.h"

#include "kernels/dashpot.h"

static gn_world *pair_with(const char *time, const char *more) {
    return world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"
                    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "
                    "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\n"
                    "law: {stiffness: uniform, rotation: off}\n"
                    "bonds: {interaction_range: 0.1}\n%stime: {end: 1, %s}\nrun: {threads: 1}\n",
                    more, time);
}

/* rock-b between platens, 2000 spheres; `more` sections of the scene. */
static gn_world *rock(const char *run, const char *time, const char *more) {
    return world_of("specimen: {file: specimens/rock-b.txt}\n"
                    "materials: [{name: m, density: 2650, contact_modulus: 1e10, kratio: 3.7, "
                    "friction: 0.5, tensile_strength: 40e6, shear_strength: 40e6}]\n"
                    "law: {stiffness: harmonic}\nbonds: {interaction_range: 0.05}\n"
                    "walls:\n"
                    "- {name: a, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 15e6, "
                    "passive: true, motion: {vz: 2}}\n"
                    "- {name: b, point: [0, 0, 46e-3], normal: [0, 0, -1], stiffness: 15e6, "
                    "passive: true, motion: {vz: -2}}\n"
                    "%stime: {end: 1, %s}\nrun: {%s}\n",
                    more, time, run);
}

/* --- how much mass --- */

/* m x''= -2 k x: the step is proportional to the root of the mass. */
static void a_pair_gets_the_square_of_the_factor(void **state) {
    (void)state;
    double m = sphere_mass(2500, 1e-3);
    gn_world *w = pair_with("estimate: bound, mass_scaling: {factor: 1.5}", "");
    for (int p = 0; p < 2; p++) assert_close(mass_of(w, p), 2.25 * m, 1e-12);
    assert_close(w->ctx.dt, 1.5 * 0.9 * 2.0 / sqrt(2e6 / m), 1e-12);
    assert_close(w->dem.raised.added, 2.0 * 1.25 * m, 1e-12);
    assert_close(gn_world_mass(&w->dem, &w->solids), 2.0 * m, 1e-12);
    world_end(w);
    /* The masses are found by iteration, to half a percent of the step. */
    w = pair_with("mass_scaling: {factor: 1.5}", "");
    for (int p = 0; p < 2; p++) assert_close(mass_of(w, p), 2.25 * m, 0.01);
    world_end(w);
}

static void a_step_that_is_there_already_adds_nothing(void **state) {
    (void)state;
    gn_world *plain = pair_with("step: auto", ""), *w;
    text t = {0};
    add(&t, "mass_scaling: {step: %.17g}", 0.9 * plain->ctx.dt);
    w = pair_with(t.s, "");
    assert_true(w->ctx.dt == plain->ctx.dt && w->dem.raised.added == 0.0 &&
                w->dem.raised.count == 0);
    for (int p = 0; p < 2; p++) assert_true(mass_of(w, p) == mass_of(plain, p));
    world_end(plain);
    world_end(w);
}

static void masses_are_raised_where_it_is_needed_and_never_lowered(void **state) {
    (void)state;
    gn_world *plain = rock("threads: 1", "step: auto", ""),
             *w = rock("threads: 1", "mass_scaling: {factor: 1.4}", "");
    size_t n = w->dem.particles.soa.count, same = 0;
    for (int p = 0; p < (int)n; p++) {
        double before = mass_of(plain, p), after = mass_of(w, p);
        assert_true(after >= before);
        same += after == before;
        /* The moment of inertia is raised as well: the sphere oscillates as before. */
        assert_close(vel_of(w, p)[3] / spin_of(w, p)[3], vel_of(plain, p)[3] / spin_of(plain, p)[3],
                     1e-15);
    }
    assert_int_equal(n - same, w->dem.raised.count);
    assert_true(same > n / 4 && w->dem.raised.count > 0);
    assert_close(w->ctx.dt, 1.4 * plain->ctx.dt, 1e-9);
    /* the trusted accuracy of Lanczos */
    assert_true(w->ctx.dt <= 0.9 * w->ctx.choice.limit.sharp * (1.0 + 1e-3));
    world_end(plain);
    world_end(w);
}

/* The step of a loose pair is that which resolves its collision in 10 steps, not its stability
 * limit. */
static void collisions_are_resolved_at_the_wanted_step(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        gn_world *w =
            world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2.01e-3, 0, 0, "
                     "1e-3]]}\nmaterials: [{name: m, density: 2500, normal_stiffness: 1e6, "
                     "kratio: 2}]\nlaw: {stiffness: uniform}\ntime: {end: 1, mass_scaling: "
                     "{factor: %d}}\nrun: {threads: 1}\n",
                     2 * k + 1);
        double m = sphere_mass(2500, 1e-3) * (k ? 9.0 : 1.0);
        assert_close(mass_of(w, 0), m, 1e-12);
        assert_close(w->ctx.dt, 0.1 * pi / sqrt(2e6 / m), 1e-9);
        world_end(w);
    }
}

static void dashpots_are_those_of_the_raised_mass(void **state) {
    (void)state;
    gn_world *w = rock("threads: 1", "mass_scaling: {factor: 1.4}",
                       "damping: {contact: {fraction: 0.3}}\n"),
             *plain = rock("threads: 1", "step: auto", "damping: {contact: {fraction: 0.3}}\n");
    const gn_contacts *b = &w->dem.bonds.contacts;
    for (size_t c = 0; c < b->soa.count; c++) {
        double inverse =
            w->dem.particles.vel[4 * b->i[c] + 3] + w->dem.particles.vel[4 * b->j[c] + 3];
        assert_close(b->cn[c], gn_dashpot(b->kn[c], inverse, 0.3, w->ctx.dt), 1e-12);
    }
    assert_true(w->dem.raised.count > 0);
    assert_close(w->ctx.dt, 1.4 * plain->ctx.dt, 1e-9);
    world_end(w);
    world_end(plain);
}

/* --- gravity --- */

static const double g0 = 9.81;

static gn_world *on_floor(double height, const char *time) {
    return world_of("dimension: 3\nspecimen: {particles: [[0, 0, %.17g, 1e-3]]}\n"
                    "materials: [{name: m, density: 2500, normal_stiffness: 1000, kratio: 2}]\n"
                    "law: {stiffness: uniform}\ngravity: [0, 0, -9.81]\n"
                    "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1000}]\n"
                    "time: {end: 1, %s}\nrun: {threads: 1}\n",
                    height, time);
}

static void a_grain_weighs_what_it_did(void **state) {
    (void)state;
    double m = sphere_mass(2500, 1e-3), depth = m * g0 / 1000;
    gn_world *w = on_floor(1e-3 - depth, "mass_scaling: {factor: 3, gravity: own_mass}");
    assert_close(mass_of(w, 0), 9.0 * m, 1e-12);
    run_steps(w, 1000);
    measured_step(w);
    /* The overlap is rounded by some ulps of the radius. */
    double allowed = 100 * 2.2e-16 * 1e-3;
    assert_near(pos_of(w, 0)[2], 1e-3 - depth, allowed);
    assert_near(w->boundary.walls[0].force[2], -m * g0, 1000 * allowed);
    world_end(w);
}

/* The grain is dropped from a tenth of its radius; it falls with a ninth of g and rebounds. */
static void a_raised_grain_falls_and_bounces_without_a_loss(void **state) {
    (void)state;
    double m = sphere_mass(2500, 1e-3), height = 1e-5;
    gn_world *w = on_floor(1e-3 + height, "mass_scaling: {factor: 3, gravity: own_mass}");
    gn_energy e = measured_step(w);
    double fall = sqrt(2 * height * 9.0 / g0);
    assert_close(mass_of(w, 0), 9.0 * m, 1e-12);
    while (w->ctx.time < 0.5 * fall) run_steps(w, 1);
    assert_close(vel_of(w, 0)[2], -g0 / 9.0 * (w->ctx.time - 0.5 * w->ctx.dt), 1e-9);
    while (w->ctx.time < 2.0 * fall) run_steps(w, 1);
    e = measured_step(w);
    /* A contact in ten steps is exact only on one plane wall; gravity bends its path. */
    assert_near(gn_energy_residual(&e), 0.0, 1e-3);
    assert_near(e.work_gravity, m * g0 * (1e-3 + height - pos_of(w, 0)[2]), 0.05 * m * g0 * height);
    world_end(w);
}

/* --- changes during a run --- */

/* Two bonded pairs in a line, one of which collides with the other: the two spheres in the middle
 * then have twice as many springs. */
static gn_world *pairs_that_meet(const char *time) {
    return world_of("dimension: 3\nspecimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3], "
                    "[4.5e-3, 0, 0, 1e-3], [6.5e-3, 0, 0, 1e-3]]}\n"
                    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2, "
                    "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\n"
                    "law: {stiffness: uniform, rotation: off}\nbonds: {interaction_range: 0.1}\n"
                    "damping: {background: {model: nonviscous_vector, coefficient: 0.7}}\n"
                    "sets: [{name: b, select: {ids: [2, 3]}, initial_velocity: [-1, 0, 0]}]\n"
                    "time: {end: 1, %s}\nrun: {threads: 1}\n",
                    time);
}

/* With the bound, masses of particles increase when they approach, before they touch, and the step
 * does not change; the energy of this is in the ledger. With the sharp limit the step falls as
 * without mass scaling. */
static void masses_follow_the_contacts_that_form(void **state) {
    (void)state;
    for (int sharp = 0; sharp < 2; sharp++) {
        gn_world *w = pairs_that_meet(sharp ? "mass_scaling: {factor: 1.5}"
                                            : "estimate: bound, mass_scaling: {factor: 1.5}");
        const double dt = w->ctx.dt, end = mass_of(w, 0), middle = mass_of(w, 1);
        gn_energy e = {0};
        for (int k = 0; k < 400 && e.elastic_normal < 1e-9; k++) e = measured_step(w);
        assert_true(e.elastic_normal > 0.0); /* the particles were in contact */
        assert_true(sharp ? w->ctx.dt < 0.95 * dt : w->ctx.dt == dt);
        assert_true(mass_of(w, 0) == end);
        if (sharp) {
            assert_true(mass_of(w, 1) == middle);
        } else {
            double more = mass_of(w, 1) - middle;
            /* Twice the springs, at the step over 0.989 instead of over 0.9. */
            assert_close(mass_of(w, 1), 2.0 * middle * pow(0.9 / 0.989, 2.0), 1e-9);
            assert_close(mass_of(w, 2), mass_of(w, 1), 1e-12);
            assert_close(e.step_change, 0.5 * more, 1e-9); /* mass of the flying one, at 1 m/s */
            assert_near(gn_energy_residual(&e), 0.0, 1e-6);
        }
        world_end(w);
    }
}

/* --- conserved --- */

static void momentum_and_energy_of_a_free_pair_stay(void **state) {
    (void)state;
    gn_world *w = pair_with("mass_scaling: {factor: 2}",
                            "sets: [{name: a, select: {ids: [0]}, initial_velocity: [1, 0, 0]}]\n");
    double p0[3], size = 0.0;
    gn_energy e = measured_step(w);
    for (int k = 0; k < 3; k++) {
        p0[k] = mass_of(w, 0) * vel_of(w, 0)[k] + mass_of(w, 1) * vel_of(w, 1)[k];
        size += fabs(p0[k]);
    }
    run_steps(w, 500);
    e = measured_step(w);
    for (int k = 0; k < 3; k++)
        assert_near(mass_of(w, 0) * vel_of(w, 0)[k] + mass_of(w, 1) * vel_of(w, 1)[k], p0[k],
                    500 * 2.2e-16 * size);
    /* Positions are rounded by 1e-13 of the amplitude of the bond. */
    assert_near(gn_energy_residual(&e), 0.0, 1e-10);
    world_end(w);
}

/* With all other options, in both precisions, the ledger closes, with the same bits on any number
 * of threads. */
static void beside_all_else_the_ledger_closes_with_the_same_bits(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++) {
        text t = {0};
        add(&t,
            "damping: {background: {model: nonviscous_component, coefficient: 0.3}, contact: "
            "{fraction: 0.1}}\ngravity: [0, 0, -9.81]\n"
            "sets: [{name: s, select: {ids: [5, 6]}, motion: {vx: 0.1}}, {name: f, select: {ids: "
            "[9]}, force: [0, 1, 0]}]\noutput: {orientation: on}\n");
        uint64_t hash[2];
        for (int threads = 1; threads <= 2; threads++) {
            text run = {0};
            add(&run, "threads: %d, precision: %s", threads, mixed ? "mixed" : "double");
            gn_world *w = rock(run.s, "mass_scaling: {factor: 1.5, gravity: own_mass}", t.s);
            run_steps(w, 300);
            gn_energy e = measured_step(w);
            assert_true(w->dem.broken_tension + w->dem.broken_shear > 0);
            assert_near(gn_energy_residual(&e), 0.0, 0.01); /* limit of the warning of a run */
            double share = gn_timestep_added_kinetic(&w->dem);
            assert_true(share > 0.0 && share < 1.0);
            hash[threads - 1] = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
            world_end(w);
        }
        assert_true(hash[0] == hash[1]);
    }
}

/* --- refused --- */

static void refused(const char *time, const char *more, const char *expected) {
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    text t = {0};
    add(&t,
        "dimension: 3\n%s"
        "time: {end: 1, %s}\nrun: {threads: 1}\n",
        more, time);
    assert_int_equal(world_try(w, t.s, NULL, &error), GNEISS_ERROR_INPUT);
    if (!strstr(error.message, expected)) fail_msg("found: %s", error.message);
    free(w);
}

#define GRAIN                                                                                      \
    "specimen: {particles: [[0, 0, 0, 1e-3], [2e-3, 0, 0, 1e-3]]}\n"                               \
    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"                    \
    "law: {stiffness: uniform}\n"

static void wrong_keys_of_mass_scaling_are_refused_at_their_line(void **state) {
    (void)state;
    refused("mass_scaling: {}", GRAIN,
            "s.yaml:5:16: time.mass_scaling: expected either step or factor, found neither");
    refused("mass_scaling: {step: 1e-6, factor: 2}", GRAIN,
            "expected either step or factor, found both");
    refused("mass_scaling: {factor: 0.5}", GRAIN,
            "s.yaml:5:39: time.mass_scaling.factor: expected");
    refused("mass_scaling: {step: 0}", GRAIN, "time.mass_scaling.step: expected");
    refused("mass_scaling: {step: 2}", GRAIN,
            "time.mass_scaling.step: expected a step below the end");
    refused("step: 1e-6, mass_scaling: {factor: 2}", GRAIN, "expected time.step: auto");
    refused("mass_scaling: {factor: 2}", GRAIN "gravity: [0, 0, -1]\n", "expected no gravity");
    refused("mass_scaling: {factor: 2, gravity: refuse}", GRAIN "gravity: [0, 0, -1]\n",
            "gravity: refuse");
    refused("mass_scaling: {factor: 2, gravity: on}", GRAIN,
            "time.mass_scaling.gravity: expected one of refuse, own_mass, found 'on'");
    refused("mass_scaling: {factor: 2}",
            "elements: {box: {size: [1, 1, 1], cells: [2, 2, 2]}, materials: [{young: 1e9, "
            "poisson: 0.2, density: 2500}]}\n",
            "expected a specimen");
    refused("mass_scaling: {step: 0.1}",
            GRAIN "elements: {box: {size: [1, 1, 1], cells: [2, 2, 2], origin: [0, 0, 1]}, "
                  "materials: [{young: 1e9, poisson: 0.2, density: 2500}]}\n",
            "which the finite elements allow");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pair_gets_the_square_of_the_factor),
        cmocka_unit_test(a_step_that_is_there_already_adds_nothing),
        cmocka_unit_test(masses_are_raised_where_it_is_needed_and_never_lowered),
        cmocka_unit_test(collisions_are_resolved_at_the_wanted_step),
        cmocka_unit_test(dashpots_are_those_of_the_raised_mass),
        cmocka_unit_test(a_grain_weighs_what_it_did),
        cmocka_unit_test(a_raised_grain_falls_and_bounces_without_a_loss),
        cmocka_unit_test(masses_follow_the_contacts_that_form),
        cmocka_unit_test(momentum_and_energy_of_a_free_pair_stay),
        cmocka_unit_test(beside_all_else_the_ledger_closes_with_the_same_bits),
        cmocka_unit_test(wrong_keys_of_mass_scaling_are_refused_at_their_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
