/* time.start: first_break: equilibria up to the first break without steps, and the steps that
 * follow them. */
#include "world_helpers.h"

#include "run/run.h"
#include "static/first_break.h"

#include <unistd.h>

static const char law[] = "materials: [{name: m, density: 2000, normal_stiffness: 1e6, kratio: 2, "
                          "friction: 0.3, bond_tension_limit: 1, bond_shear_limit: 1}]\n"
                          "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n"
                          "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n";
static const double kn = 1e6, kt = 5e5, strength = 1.0;

static gn_first_break begin(gn_world *w) {
    gn_first_break found;
    gneiss_error error = {0};
    if (gn_first_break_start(w, NULL, &found, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return found;
}

/* `count` spheres of 1 mm in a row along an axis, bonded; the first is held, the last moves. */
static void row(text *t, int count, char axis, const char *rest, const char *motion) {
    add(t, "specimen:\n  particles:\n");
    for (int k = 0; k < count; k++)
        add(t, "  - [%g, 0, %g, 1 mm]\n", axis == 'x' ? 2e-3 * k : 0.0,
            axis == 'z' ? 2e-3 * k : 0.0);
    add(t,
        "  group: 1\n%s%ssets:\n"
        "- {name: foot, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}\n"
        "- {name: head, select: {ids: [%d]}, motion: {%s}}\n",
        law, rest, count - 1, motion);
}

static gn_world *chain(int count, const char *rest, const char *time) {
    text t = {0};
    row(&t, count, 'x', rest, "vx: 1 mm/s, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0");
    return world_of("%s%srun: {threads: 1}\n", t.s, time);
}

static const char plain[] = "time: {start: first_break, end: 1}\n";

/* --- closed forms --- */

/* n springs in series: F = k v t/n, so that the first breaks at n R/(k v), after displacements and
 * velocities that are linear along the chain. Residual loads may be 1e-5 of the forces, which
 * accumulate along the bonds. */
static void a_chain_breaks_when_its_springs_say(void **state) {
    (void)state;
    enum { COUNT = 11, BONDS = COUNT - 1 };
    gn_world *w = chain(COUNT, "", plain);
    double speed = 1e-3, time = BONDS * strength / (kn * speed);
    gn_first_break found = begin(w);
    assert_near(found.time, time, 1e-4 * time);
    assert_near(w->ctx.time, 0.9 * time, 1e-3 * time);
    for (int k = 0; k < COUNT; k++) {
        double part = (double)k / BONDS, u = pos_of(w, k)[0] - 2e-3 * k;
        assert_near(u, part * speed * w->ctx.time, 1e-4 * speed * w->ctx.time);
        assert_near(vel_of(w, k)[0], part * speed, 1e-4 * speed);
    }
    assert_near(found.start, w->ctx.time, 0.0);
    assert_int_equal(found.steps, w->ctx.step);
    assert_near((double)w->ctx.step * w->ctx.dt, w->ctx.time, 0.5 * w->ctx.dt);
    world_end(w);
}

/* With one group per particle a load advances by one bond per iteration, so that a chain would need
 * as many iterations as particles for every solution; groups transmit it in one iteration. */
static void a_long_chain_needs_fewer_iterations_than_it_has_particles(void **state) {
    (void)state;
    enum { COUNT = 481 };
    gn_world *w = chain(COUNT, "", plain);
    gn_first_break found = begin(w);
    assert_true(found.unbalanced <= 1e-5);
    assert_in_range(found.iterations, 1, COUNT / 2 * found.solutions);
    world_end(w);
}

/* The work of the walls is the stored elastic energy and the kinetic energy of the motion. */
static void the_ledger_goes_on_without_a_residual(void **state) {
    (void)state;
    gn_world *w =
        chain(11, "damping: {background: {model: nonviscous_vector, coefficient: 0.7}}\n", plain);
    begin(w);
    gn_energy e = measured_step(w);
    double stored = 0.5 * kn / 10.0 * 1e-6 * w->ctx.time * w->ctx.time;
    assert_near(e.work_prescribed, stored, 1e-3 * stored);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    run_steps(w, 500);
    e = measured_step(w);
    assert_near(gn_energy_residual(&e), 0.0, 1e-6);
    world_end(w);
}

/* Raised masses have the weight of their own mass, and its work. */
static void raised_masses_weigh_what_they_did(void **state) {
    (void)state;
    double work[2];
    for (int k = 0; k < 2; k++) {
        text t = {0};
        row(&t, 6, 'z', "gravity: [0, 0, 1000]\n", "vx: 0, vy: 0, vz: 1 mm/s, wx: 0, wy: 0, wz: 0");
        gn_world *w = world_of("%stime: {start: first_break, end: 1%s}\nrun: {threads: 1}\n", t.s,
                               k ? ", mass_scaling: {factor: 2, gravity: own_mass}" : "");
        begin(w);
        work[k] = w->ledger.energy.work_gravity;
        world_end(w);
    }
    assert_near(work[1], work[0], 1e-6 * work[0]);
}

/* A column that hangs from its foot under its weight, and is pulled in the direction of gravity:
 * bond k (from the foot) carries k v t/n and the weight hanging below it, less the support of the
 * head. With both ends held the weights w of the free spheres are carried half by each: the bond at
 * the foot has (n - 1) w/2 more than the mean. */
static void a_column_carries_its_weight(void **state) {
    (void)state;
    enum { COUNT = 6, BONDS = COUNT - 1 };
    text t = {0};
    row(&t, COUNT, 'z', "gravity: [0, 0, 1000]\n", "vx: 0, vy: 0, vz: 1 mm/s, wx: 0, wy: 0, wz: 0");
    gn_world *w = world_of("%s%srun: {threads: 1}\n", t.s, plain);
    double weight = 1000.0 * mass_of(w, 1), half = 0.5 * (BONDS - 1) * weight;
    double time = BONDS * (strength - half) / (kn * 1e-3);
    gn_first_break found = begin(w);
    assert_in_range(half / strength * 1000.0, 10,
                    500); /* the weight has an effect and breaks no bond */
    assert_near(found.time, time, 1e-4 * BONDS * strength / (kn * 1e-3));
    assert_true(found.i == 0 || found.j == 0);
    gn_energy e = measured_step(w);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    assert_true(e.background_damping > 0.0); /* work of gravity beyond the stored energy */
    world_end(w);
}

/* A wall that has to close a gap before it shears a bond: T = (v t - gap)/(1/k_w + 1/k_t). */
static const char gap_scene[] =
    "specimen:\n  particles: [[0, 0, 0, 0.5 mm], [1.5 mm, 0, 0, 1 mm]]\n  group: 1\n%ssets:\n"
    "- {name: foot, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}\n"
    "- {name: head, select: {ids: [1]}, motion: {wx: 0, wy: 0, wz: 0}}\n"
    "walls: [{name: lid, point: [0, 0, 1.001 mm], normal: [0, 0, -1], stiffness: 1e6, motion: "
    "{vz: -1 mm/s}}]\n%srun: {threads: 1}\n";

static void a_wall_acts_when_its_gap_is_closed(void **state) {
    (void)state;
    gn_world *w = world_of(gap_scene, law, plain);
    double give = 1.0 / 1e6 + 1.0 / kt, time = (1e-6 + strength * give) / 1e-3;
    gn_first_break found = begin(w);
    /* The bond rotates by T/k_t over its length, 1e-3 rad, and its forces rotate with it. */
    assert_near(found.time, time, 2e-3 * time);
    assert_near(w->boundary.walls[0].force[2], (1e-3 * w->ctx.time - 1e-6) / give, 2e-3);
    assert_near(w->boundary.walls[0].point[2], 1.001e-3 - 1e-3 * w->ctx.time, 1e-15);
    gn_energy e = measured_step(w);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    world_end(w);
}

/* Viscous damping acts on sphere k with a m v k/n, which the springs between it and the foot carry
 * in parts: the mean force is k v t/n, and the bond at the head carries the drag of all spheres. */
static void viscous_damping_is_a_load(void **state) {
    (void)state;
    enum { COUNT = 3 };
    text t = {0};
    row(&t, COUNT, 'x', "damping: {background: {model: viscous, coefficient: 1e5 1/s}}\n",
        "vx: 100 mm/s, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0");
    gn_world *w = world_of("%s%srun: {threads: 1}\n", t.s, plain);
    double drag = 1e5 * mass_of(w, 1) * 0.05;
    gn_first_break found = begin(w);
    assert_in_range(drag / strength * 1000.0, 10, 900);
    /* The bond at the head carries half of the drag in addition to k v t/2. */
    double time = 2.0 * (strength - 0.5 * drag) / (kn * 0.1);
    assert_near(found.time, time, 1e-3 * time);
    assert_true(found.i == 2 || found.j == 2);
    world_end(w);
}

/* A bond is as strong as the weaker of its materials: the last one has half the strength. */
static void the_weaker_material_breaks_first(void **state) {
    (void)state;
    gn_world *w = world_of(
        "specimen:\n  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm], [4 mm, 0, 0, 1 mm], [6 mm, "
        "0, "
        "0, 1 mm]]\n  group: 1\n  material: m\nmaterials:\n"
        "- {name: m, density: 2000, normal_stiffness: 1e6, kratio: 2, friction: 0.3, "
        "bond_tension_limit: 1, bond_shear_limit: 1}\n"
        "- {name: weak, density: 9000, normal_stiffness: 1e6, kratio: 3, friction: 0.3, "
        "bond_tension_limit: 0.5, bond_shear_limit: 1}\n"
        "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\nsets:\n"
        "- {name: foot, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}\n"
        "- {name: head, select: {ids: [3]}, material: weak, motion: {vx: 1 mm/s, vy: 0, vz: 0, wx: "
        "0, wy: 0, wz: 0}}\n%srun: {threads: 1}\n",
        plain);
    gn_first_break found = begin(w);
    assert_near(found.time, 3.0 * 0.5 / (kn * 1e-3), 1e-4 * found.time);
    assert_true(found.i + found.j == 5);
    world_end(w);
}

/* The fractions are far from the break and close to it. */
static void the_fraction_is_taken_as_it_is(void **state) {
    (void)state;
    const double fraction[] = {1e-3, 0.5, 0.999};
    for (int k = 0; k < 3; k++) {
        char time[128];
        snprintf(time, sizeof time, "time: {start: first_break, start_fraction: %g, end: 1}\n",
                 fraction[k]);
        gn_world *w = chain(11, "", time);
        gn_first_break found = begin(w);
        /* The tolerances are the permitted shortfall, and the accuracy of the time of the break. */
        assert_near(found.start, fraction[k] * found.time, 1.2e-3 * fraction[k] * found.time);
        assert_near(found.time, 10.0 * strength / (kn * 1e-3), 1e-3 * found.time);
        assert_int_equal(w->dem.broken_tension + w->dem.broken_shear, 0);
        world_end(w);
    }
}

/* --- specimens --- */

/* A block of spheres between rough platens, with all other options. */
static gn_world *block(const char *more, const char *precision, int threads) {
    return world_of("specimen: {lattice: {kind: hcp, radius: 1 mm, cells: [8, 5, 7]}, "
                    "group: 1}\n%s%swalls:\n"
                    "- {name: low, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6, kratio: 2, "
                    "friction: 0.5, passive: true, motion: {vz: 5 mm/s}}\n"
                    "- {name: top, point: [0, 0, 23.2 mm], normal: [0, 0, -1], stiffness: "
                    "1e6, kratio: 2, friction: 0.5, passive: true, motion: {vz: -5 mm/s}}\n"
                    "time: {start: first_break, end: 1}\nrun: {threads: %d, precision: %s}\n",
                    law, more, threads, precision);
}

static const char all_else[] =
    "gravity: [0, 0, -9.81]\n"
    "damping: {background: {model: nonviscous_component, coefficient: 0.5}, contact: {restitution: "
    "0.5}}\noutput: {orientation: on}\n";

static void threads_leave_the_same_bits(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = block(all_else, "double", 1 + k);
        begin(w);
        run_steps(w, 20);
        hash[k] = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
        world_end(w);
    }
    assert_true(hash[0] == hash[1]);
}

/* Single precision resolves forces to 1e-7; increments of tangential forces add that up. */
static void mixed_precision_finds_the_same_start(void **state) {
    (void)state;
    gn_first_break found[2];
    for (int k = 0; k < 2; k++) {
        gn_world *w = block(all_else, k ? "mixed" : "double", 1);
        found[k] = begin(w);
        gn_energy e = measured_step(w);
        assert_near(gn_energy_residual(&e), 0.0, 1e-4);
        world_end(w);
    }
    assert_near(found[0].time, found[1].time, 1e-3 * found[0].time);
    assert_near(found[0].start, found[1].start, 2e-3 * found[0].start);
}

/* Kinetic energy stays that of the steady motion, step by step, up to the break. After a start at
 * rest undamped bodies would oscillate with more than that. */
static void nothing_oscillates_after_the_start(void **state) {
    (void)state;
    gn_world *w = block("", "double", 1);
    gn_first_break found = begin(w);
    double steady = measured_step(w).kinetic;
    assert_true(steady > 0.0);
    while (w->ctx.time < 0.5 * (found.start + found.time)) {
        run_steps(w, 9);
        double now = measured_step(w).kinetic;
        if (fabs(now - steady) > 0.05 * steady)
            fail_msg("%g J at t = %g s, %g J at the start", now, w->ctx.time, steady);
    }
    assert_int_equal(w->dem.broken_tension + w->dem.broken_shear, 0);
    world_end(w);
}

static void the_ledger_closes_with_everything_on(void **state) {
    (void)state;
    gn_world *w = block(all_else, "double", 1);
    gn_first_break found = begin(w);
    gn_energy e = measured_step(w);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    assert_true(found.shortfall < 0.02 * e.work_walls);
    run_steps(w, 200);
    e = measured_step(w);
    assert_near(gn_energy_residual(&e), 0.0, 1e-4);
    world_end(w);
}

/* The sets load a periodic box as they load an open one. */
static void a_periodic_box_is_solved(void **state) {
    (void)state;
    gn_world *w = world_of(
        "specimen: {lattice: {kind: cubic, radius: 1 mm, cells: [5, 5, 8]}, group: 1}\n%s"
        "periodic: {min: [0, 0, -5 mm], max: [10 mm, 10 mm, 25 mm]}\nsets:\n"
        "- {name: a, select: {end: {axis: z, side: lower, depth: 1 mm, by: surface}}, motion: {vx: "
        "0, vy: 0, vz: 0}}\n"
        "- {name: b, select: {end: {axis: z, side: upper, depth: 1 mm, by: surface}}, motion: {vx: "
        "0, vy: 0, vz: 1 mm/s}}\n%srun: {threads: 1}\n",
        law, plain);
    double time = 7.0 * strength / (kn * 1e-3);
    gn_first_break found = begin(w);
    assert_near(found.time, time, 1e-3 * time);
    world_end(w);
}

/* A row of discs in 2D. */
static void discs_are_solved(void **state) {
    (void)state;
    gn_world *w = world_of(
        "dimension: 2\nspecimen: {lattice: {kind: square, radius: 1 mm, cells: [4, 9, 1]}, group: "
        "1}\nmaterials: [{name: m, density: 2000, normal_stiffness: 1e6, kratio: 2, friction: 0.3, "
        "bond_tension_limit: 1, bond_shear_limit: 1}]\nlaw: {stiffness: uniform}\n"
        "bonds: {interaction_range: 0.01}\nsets:\n"
        "- {name: a, select: {end: {axis: y, side: lower, depth: 1 mm, by: surface}}, motion: {vx: "
        "0, vy: 0, wz: 0}}\n"
        "- {name: b, select: {end: {axis: y, side: upper, depth: 1 mm, by: surface}}, motion: {vx: "
        "0, vy: 1 mm/s, wz: 0}}\n%srun: {threads: 1}\n",
        plain);
    double time = 8.0 * strength / (kn * 1e-3);
    gn_first_break found = begin(w);
    assert_near(found.time, time, 1e-3 * time);
    world_end(w);
}

/* --- a run --- */

static void a_resumed_run_has_the_same_bits(void **state) {
    (void)state;
    gneiss_error error = {0};
    text t = {0};
    row(&t, 11, 'x', "", "vx: 1 mm/s, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0");
    add(&t, "%srun: {threads: 1}\n", plain);
    gn_run *run = calloc(2, sizeof *run);
    gn_scene scene;
    char path[] = "/tmp/gneiss_first_break_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    assert_int_equal(gn_scene_parse(t.s, "s.yaml", NULL, NULL, 0, &scene, &error), GNEISS_OK);
    assert_int_equal(gn_run_create(&scene, &run[0], &error), GNEISS_OK);
    assert_int_equal(gn_run_steps(&run[0], 10, &error), GNEISS_OK);
    assert_int_equal(gn_checkpoint_write(&run[0], path, &error), GNEISS_OK);
    if (gn_run_load(path, NULL, 0, &run[1], &error) != GNEISS_OK) fail_msg("%s", error.message);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(gn_run_steps(&run[k], 40, &error), GNEISS_OK);
        assert_int_equal(run[k].first_break.steps, run[0].world.ctx.first_step);
    }
    assert_true(gn_world_hash(&run[0].world.ctx, &run[0].world.dem, &run[0].world.boundary,
                              &run[0].world.solids, &run[0].world.box) ==
                gn_world_hash(&run[1].world.ctx, &run[1].world.dem, &run[1].world.boundary,
                              &run[1].world.solids, &run[1].world.box));
    assert_int_equal(run[0].history.row_count, run[1].history.row_count);
    gn_run_free(&run[0]);
    gn_run_free(&run[1]);
    free(run);
    unlink(path);
}

/* States before the start, the first at rest, and the start state, which the first step reads. */
static void the_history_has_the_part_without_steps(void **state) {
    (void)state;
    gneiss_error error = {0};
    text t = {0};
    row(&t, 11, 'x', "", "vx: 1 mm/s, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0");
    add(&t,
        "%stest: {kind: tension, axis: x, lower: foot, upper: head, length: 20 mm, area: 4 "
        "mm2}\nrun: {threads: 1}\n",
        plain);
    gn_run *run = calloc(1, sizeof *run);
    gn_scene scene;
    assert_int_equal(gn_scene_parse(t.s, "s.yaml", NULL, NULL, 0, &scene, &error), GNEISS_OK);
    assert_int_equal(gn_run_create(&scene, run, &error), GNEISS_OK);
    assert_int_equal(gn_run_steps(run, 1, &error), GNEISS_OK);
    const double *time = gn_history_column(&run->history, "time");
    const double *stress = gn_history_column(&run->history, "stress");
    size_t rows = run->history.row_count;
    assert_in_range(rows, 5, 100);
    assert_true(time[0] == 0.0 && time[rows - 1] == run->first_break.start);
    for (size_t k = 0; k < rows; k++) {
        double expected = kn / 10.0 * 1e-3 * time[k] / 4e-6;
        assert_near(stress[k], expected, 1e-3 * expected);
        assert_true(k == 0 || time[k] > time[k - 1]);
    }
    gn_run_free(run);
    free(run);
}

/* --- refusals --- */

static void refused(const char *scene, const char *words) {
    gn_world *w = calloc(1, sizeof *w);
    gneiss_error error = {0};
    gn_first_break found;
    gneiss_status status = world_try(w, scene, NULL, &error);
    if (status == GNEISS_OK) {
        status = gn_first_break_start(w, NULL, &found, &error);
        gn_world_free(w);
    }
    free(w);
    assert_int_equal(status, GNEISS_ERROR_INPUT);
    if (!strstr(error.message, words)) fail_msg("'%s' not in: %s", words, error.message);
    if (strncmp(error.message, "s.yaml:", 7) != 0) fail_msg("no place: %s", error.message);
}

static const char still[] = "vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0";
static const char pulled[] = "vx: 1 mm/s, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0";

static void refuse_row(const char *rest, const char *motion, const char *time, const char *words) {
    text t = {0};
    row(&t, 3, 'x', rest, motion);
    add(&t, "%s", time);
    refused(t.s, words);
}

/* Nothing is loaded before the wall has closed the gap: rounding has no scale. */
static void an_unloaded_specimen_is_in_equilibrium(void **state) {
    (void)state;
    gn_world *w = world_of(
        "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [2, 2, 2]}}\n"
        "materials: [{name: m, density: 2650, contact_modulus: 1 GPa, kratio: 2, friction: 0.3, "
        "tensile_strength: 1 MPa, shear_strength: 1 MPa}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
        "walls:\n- {name: foot, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e7}\n"
        "- {name: head, point: [0, 0, 6.25 mm], normal: [0, 0, -1], stiffness: 1e7, motion: {vz: "
        "-1 "
        "mm/s}}\n%srun: {threads: 1}\n",
        plain);
    double top = 0.0;
    for (int id = 0; id < 32; id++) top = fmax(top, pos_of(w, id)[2] + 1e-3);
    gn_first_break found = begin(w);
    assert_true(top < 6.249e-3 && found.time > (6.25e-3 - top) / 1e-3 && found.start < found.time);
    world_end(w);
}

static void scenes_without_a_first_break_are_refused(void **state) {
    (void)state;
    refuse_row("", still, plain, "expected walls or sets that move, found none");
    refuse_row("", "vx: -1 mm/s, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0", plain,
               "expected a bond that breaks before time.end, found none");
    refuse_row("", pulled, "time: {start: first_break, end: 1 us}\n",
               "expected a bond that breaks before time.end, found none");
    refuse_row("", "wx: 0", plain, "expected walls or sets that move, found none");
    refuse_row("", "vx: 1e6, vy: 0, vz: 0", plain,
               "expected a start that is at least 2 steps after time 0");
}

static void scenes_beyond_statics_are_refused(void **state) {
    (void)state;
    refuse_row("", "vx: [[0, 0], [1, 1]], vy: 0, vz: 0", plain,
               "expected motions at constant velocity, found a set whose velocity changes");
    refuse_row("", pulled, "time: {start: first_break, end: 1, stop: {unbalanced: 0.5}}\n",
               "found time.stop.unbalanced");
    refuse_row("initial: {random_velocity: 1}\n", pulled, plain, "a specimen at rest");
    refuse_row("walls: [{name: w, point: [0, 0, -5 mm], normal: [0, 0, 1], stiffness: 1e6, servo: "
               "{force: 1, max_velocity: 1}}]\n",
               pulled, plain, "found a servo");
    refused("specimen: {particles: [[0, 0, 0, 1 mm]], group: 0}\nmaterials: [{name: m, density: "
            "1000, normal_stiffness: 1e5, kratio: 0}]\nlaw: {stiffness: uniform}\n"
            "time: {start: first_break, end: 1}\n",
            "time.start: first_break: expected bonded particles, found none");
    const char *pair = "specimen: {particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]}\n"
                       "materials: [{name: m, density: 1000, contact_modulus: 1e7, kratio: 1, "
                       "tensile_strength: 1e5, shear_strength: 1e5, fracture_energy: 100}]\n"
                       "law: {stiffness: arithmetic%s}\nbonds: {%s}\n"
                       "time: {start: first_break, end: 1}\n";
    text t = {0}, u = {0};
    add(&t, pair, ", softening: energy", "");
    refused(t.s, "expected bonds that break at once, found law.softening");
    add(&u, pair, "", "radius_multiplier: 1");
    refused(u.s, "expected bonds without moments, found bonds.radius_multiplier");
}

static void bad_fractions_are_refused(void **state) {
    (void)state;
    refuse_row("", pulled, "time: {start: first_break, start_fraction: 0, end: 1}\n",
               "time.start_fraction");
    refuse_row("", pulled, "time: {start: first_break, start_fraction: 1, end: 1}\n",
               "time.start_fraction");
    refuse_row("", pulled, "time: {start_fraction: 0.5, end: 1}\n",
               "needs time.start: first_break; found rest");
    refuse_row("", pulled, "time: {start: break, end: 1}\n", "time.start");
}

/* A falling grain, and a row without support, under gravity. */
static void unsupported_particles_are_refused(void **state) {
    (void)state;
    text t = {0};
    add(&t,
        "specimen:\n  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm], [9 mm, 0, 0, 1 mm]]\n"
        "  group: 1\n%sgravity: [0, 0, -9.81]\nsets:\n"
        "- {name: foot, select: {ids: [0]}, motion: {%s}}\n- {name: head, select: {ids: [1]}, "
        "motion: {%s}}\n%s",
        law, still, pulled, plain);
    refused(t.s, "particle 2 is driven off and nothing holds it");
    text u = {0};
    add(&u,
        "specimen:\n  particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm], [9 mm, 0, 0, 1 mm], [11 "
        "mm, 0, 0, 1 mm]]\n  group: 1\n%sgravity: [0, 0, -9.81]\nsets:\n"
        "- {name: foot, select: {ids: [0]}, motion: {%s}}\n- {name: head, select: {ids: [1]}, "
        "motion: {%s}}\n%s",
        law, still, pulled, plain);
    refused(u.s, "is driven off and nothing holds it");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chain_breaks_when_its_springs_say),
        cmocka_unit_test(a_long_chain_needs_fewer_iterations_than_it_has_particles),
        cmocka_unit_test(the_ledger_goes_on_without_a_residual),
        cmocka_unit_test(a_column_carries_its_weight),
        cmocka_unit_test(raised_masses_weigh_what_they_did),
        cmocka_unit_test(a_wall_acts_when_its_gap_is_closed),
        cmocka_unit_test(viscous_damping_is_a_load),
        cmocka_unit_test(the_weaker_material_breaks_first),
        cmocka_unit_test(the_fraction_is_taken_as_it_is),
        cmocka_unit_test(threads_leave_the_same_bits),
        cmocka_unit_test(mixed_precision_finds_the_same_start),
        cmocka_unit_test(nothing_oscillates_after_the_start),
        cmocka_unit_test(the_ledger_closes_with_everything_on),
        cmocka_unit_test(a_periodic_box_is_solved),
        cmocka_unit_test(discs_are_solved),
        cmocka_unit_test(a_resumed_run_has_the_same_bits),
        cmocka_unit_test(the_history_has_the_part_without_steps),
        cmocka_unit_test(an_unloaded_specimen_is_in_equilibrium),
        cmocka_unit_test(scenes_without_a_first_break_are_refused),
        cmocka_unit_test(scenes_beyond_statics_are_refused),
        cmocka_unit_test(bad_fractions_are_refused),
        cmocka_unit_test(unsupported_particles_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
