/* Stages of a run: each changes the given keys, ends at the given condition, and the next continues
 * from its state. */
#include "parts.h"
#include "world_helpers.h"

#include "kernels/softening.h"
#include "particles/sets.h"
#include "run/run.h"
#include "run/spacing.h"
#include "run/stages.h"
#include "scene/manifest.h"

#include <unistd.h>

/* --- runs of scene texts --- */

static gneiss_status try_run(gn_run *run, const char *scene_text, gneiss_error *error) {
    gn_scene scene;
    memset(run, 0, sizeof *run);
    gneiss_status status = gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, error);
    return status == GNEISS_OK ? gn_run_create(&scene, run, error) : status;
}

static gn_run *run_of(const char *scene_text) {
    gn_run *run = calloc(1, sizeof *run);
    gneiss_error error = {0};
    if (try_run(run, scene_text, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return run;
}

static void finish(gn_run *run) {
    gneiss_error error = {0};
    while (!run->finished)
        if (gn_run_advance(run, 1e3, NULL, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

static void steps(gn_run *run, int64_t count) {
    gneiss_error error = {0};
    if (gn_run_steps(run, count, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

static void run_end(gn_run *run) {
    gn_run_free(run);
    free(run);
}

static uint64_t hash_of(const char *scene_text) {
    gn_run *run = run_of(scene_text);
    finish(run);
    uint64_t hash = gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                                  &run->world.solids, &run->world.box);
    run_end(run);
    return hash;
}

static gn_stage_cause cause_of(const gn_run *run, size_t stage) {
    return (gn_stage_cause)run->world.stages.state[stage].ended;
}

/* --- scenes --- */

/* A single sphere, far from everything, with a given step. */
static const char lone[] =
    "specimen: {particles: [[0, 0, 0, 1 mm]]}\n"
    "materials: [{name: m, density: 2000, normal_stiffness: 1e6, kratio: 0}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
    "time: {step: 1 us, end: 10 ms}\nrun: {threads: 1}\n";

/* 63 spheres between walls, in a heap of three layers that are not in touch at the start. */
static const char heap[] =
    "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 2], spacing: 1.01}}\n"
    "materials: [{name: m, density: 2000, normal_stiffness: 1e4, kratio: 2, friction: 0}]\n"
    "law: {stiffness: uniform}\n"
    "damping: {background: {model: nonviscous_component, coefficient: 0.3}}\n"
    "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
    "sets: [{name: top, select: {end: {axis: z, side: upper, depth: 1.5 mm}}}]\n"
    "walls:\n"
    "- {name: floor, point: [0, 0, -1 mm], normal: [0, 0, 1], stiffness: 2e4}\n"
    "- {name: lid, point: [0, 0, 9 mm], normal: [0, 0, -1], stiffness: 2e4}\n"
    "- {name: west, point: [-1.01 mm, 0, 0], normal: [1, 0, 0], stiffness: 2e4, kratio: 2}\n"
    "- {name: east, point: [9.6 mm, 0, 0], normal: [-1, 0, 0], stiffness: 2e4, kratio: 2}\n"
    "- {name: south, point: [0, -1.01 mm, 0], normal: [0, 1, 0], stiffness: 2e4}\n"
    "- {name: north, point: [0, 9.6 mm, 0], normal: [0, -1, 0], stiffness: 2e4}\n"
    "test: {kind: compression, axis: z, lower: floor, upper: lid, length: 8 mm, area: 1 cm2}\n"
    "output: {history_rows: 100}\n";

/* Every part of it changes a quantity, and all kinds of changes are included. */
static const char changes[] =
    "stages:\n"
    "- {name: settle, gravity: [0, 0, -9.81], end: {time: 4 ms}}\n"
    "- {name: rub, materials: {m: {friction: 0.4}}, walls: {west: {friction: 0.2}}, "
    "end: {steps: 0}}\n"
    "- name: shake\n"
    "  gravity: [2, 0, -9.81]\n"
    "  damping: {background: {model: viscous, coefficient: 20}, contact: {restitution: 0.6}}\n"
    "  walls: [{name: west, motion: {vx: [[0, 0], [1 ms, 5 mm/s]]}}]\n"
    "  end: {steps: 300}\n"
    "- name: press\n"
    "  gravity: [0, 0, 0]\n"
    "  damping: {background: {model: nonviscous_vector, coefficient: 0.5}, contact: off}\n"
    "  walls: {lid: {servo: {force: [[0, 0], [1 ms, 0.2]], max_velocity: 2}}, west: {motion: "
    "off}}\n"
    "  sets: {top: {motion: {vx: 1 mm/s}}}\n"
    "  end: {time: 3 ms}\n"
    "- name: load\n"
    "  sets: {top: {motion: off, force: [0.01, 0, 0]}}\n"
    "  walls: {lid: {motion: {vz: -0.02}}}\n"
    "  time: {safety: 0.6}\n"
    "  output: {history_rows: 50}\n"
    "  end: {time: 2 ms}\n";

static char *joined(const char *first, const char *second, const char *third) {
    static char s[16384];
    snprintf(s, sizeof s, "%s%s%s", first, second, third);
    return s;
}

/* --- properties of a stage --- */

static void one_stage_has_the_bits_of_none(void **state) {
    (void)state;
    const char *time = "gravity: [0, 0, -9.81]\ntime: {end: 3 ms}\nrun: {threads: 1}\n";
    uint64_t none = hash_of(joined(heap, time, ""));
    assert_true(none == hash_of(joined(heap, time, "stages: [{name: all}]\n")));
    /* The place of a value in the file does not matter. */
    assert_true(none == hash_of(joined(heap, "time: {end: 3 ms}\nrun: {threads: 1}\n",
                                       "stages: [{name: all, gravity: [0, 0, -9.81]}]\n")));
}

/* A stage shorter than half a step takes one step, so that its changes have an effect. */
static void a_short_stage_takes_a_step(void **state) {
    (void)state;
    gn_run *run = run_of(joined(lone, "stages:\n",
                                "- {name: push, gravity: [0, 0, 1], end: {time: 1 ns}}\n"
                                "- {name: none, gravity: [0, 0, 9], end: {time: 0}}\n"
                                "- {name: fly, gravity: [0, 0, 0], end: {steps: 5}}\n"));
    finish(run);
    assert_near(run->world.stages.state[1].step, 1.0, 0.0);
    assert_near(run->world.stages.state[2].step, 1.0, 0.0);
    assert_int_equal(run->world.ctx.step, 6);
    assert_near(run->world.dem.particles.vel[2], 1e-6,
                0.51e-6); /* the kick of a half or a whole step */
    run_end(run);
}

/* Fall for 1 ms, flight for 1 ms, fall for 0.5 ms with half the weight: leap-frog has the exact
 * velocities for constant forces, up to half a step at each change. */
static void gravity_is_that_of_the_stage(void **state) {
    (void)state;
    gn_run *run = run_of(joined(lone, "stages:\n",
                                "- {name: fall, gravity: [0, 0, -10], end: {time: 1 ms}}\n"
                                "- {name: fly, gravity: [0, 0, 0], end: {steps: 1000}}\n"
                                "- {name: half, gravity: [0, 0, -5], end: {time: 0.5 ms}}\n"));
    finish(run);
    assert_near((double)run->world.ctx.step, 2500.0, 0.0);
    assert_near(vel_of(&run->world, 0)[2], -10e-3 - 2.5e-3, 11e-6);
    assert_near(gn_energy_residual(&run->world.ledger.reading), 0.0, 1e-12);
    assert_int_equal(cause_of(run, 0), GN_STAGE_TIME);
    assert_int_equal(cause_of(run, 1), GN_STAGE_STEPS);
    assert_string_equal(run->stop_reason, "0.0005 s passed, stage 'half' (3 of 3)");
    run_end(run);
}

/* The second stage gives a table, the third one inherits it and continues along it. */
static void tables_count_from_the_stage_that_gives_them(void **state) {
    (void)state;
    gn_run *run =
        run_of(joined(lone, "sets: [{name: all, select: {all: true}}]\nstages:\n",
                      "- {name: wait, end: {steps: 700}}\n"
                      "- {name: go, sets: {all: {motion: {vx: [[0, 0], [1 ms, 1]]}}}, end: {steps: "
                      "200}}\n"
                      "- {name: go on, gravity: [0, 0, 1], end: {steps: 300}}\n"));
    finish(run);
    assert_near(vel_of(&run->world, 0)[0], 0.5,
                1e-3); /* the velocity at 500 steps, minus that of half a step */
    assert_near(gn_set_travel(&run->world.ctx, &run->world.dem, &run->world.solids, 0, 0),
                0.5 * 0.5 * 0.5e-3, 1e-9);
    run_end(run);
}

static void a_stage_of_no_steps_changes_what_comes_after_it(void **state) {
    (void)state;
    const char *one = "stages:\n- {name: a, end: {steps: 50}}\n"
                      "- {name: b, gravity: [0, 0, -10], end: {steps: 0}}\n"
                      "- {name: c, end: {steps: 100}}\n";
    const char *two = "stages:\n- {name: a, end: {steps: 50}}\n"
                      "- {name: c, gravity: [0, 0, -10], end: {steps: 100}}\n";
    assert_true(hash_of(joined(lone, one, "")) == hash_of(joined(lone, two, "")));
    gn_run *run = run_of(joined(lone, "stages: [{name: a, end: {steps: 0}}]\n", ""));
    finish(run);
    assert_int_equal(run->world.ctx.step, 0);
    run_end(run);
}

/* Fifty stages of ten steps each: as many changes of gravity as in a single stage of five hundred
 * steps. */
static void fifty_stages_are_gone_through(void **state) {
    (void)state;
    text *t = calloc(1, sizeof *t);
    add(t, "%sstages:\n", lone);
    for (int k = 0; k < 50; k++)
        add(t, "- {name: s%d, gravity: [0, 0, %d], end: {steps: 10}}\n", k, k % 2 ? -10 : 10);
    gn_run *run = run_of(t->s);
    finish(run);
    assert_int_equal(run->world.ctx.step, 500);
    assert_int_equal(run->world.stages.now, 49);
    assert_near(vel_of(&run->world, 0)[2], 0.0, 51 * 10e-6);
    for (size_t k = 0; k < 50; k++)
        assert_near(run->world.stages.state[k].step, 10.0 * (double)k, 0.0);
    run_end(run);
    free(t);
}

/* --- the ledger, the bits --- */

static const char *whole(const char *run) {
    static char s[16384];
    snprintf(s, sizeof s, "%s%stime: {end: 1}\nrun: {%s}\n", heap, changes, run);
    return s;
}

/* Contacts open and close within steps, which the ledger follows to some parts in ten thousand. */
static void the_ledger_closes_over_all_changes(void **state) {
    (void)state;
    gn_run *run = run_of(whole("threads: 1"));
    finish(run);
    assert_int_equal(run->world.stages.now, 4);
    const double *residual = gn_history_column(&run->history, "energy_residual");
    for (size_t r = 0; r < run->history.row_count; r++) assert_near(residual[r], 0.0, 2e-3);
    run_end(run);
}

static void threads_do_not_matter(void **state) {
    (void)state;
    assert_true(hash_of(whole("threads: 1")) == hash_of(whole("threads: 2")));
    assert_true(hash_of(whole("threads: 1, precision: mixed")) ==
                hash_of(whole("threads: 2, precision: mixed")));
}

/* --- bonds --- */

/* Two spheres that overlap by 10 um, both held; then one is pulled away. */
static const char pair[] =
    "specimen: {particles: [[0, 0, 0, 1 mm], [1.99 mm, 0, 0, 1 mm]], group: 1}\n"
    "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: 0.3, "
    "bond_tension_limit: 0.5, bond_shear_limit: 10}]\n"
    "law: {stiffness: uniform}\nbonds: {enabled: off}\n"
    "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
    "sets:\n- {name: a, select: {ids: [0]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}\n"
    "- {name: b, select: {ids: [1]}, motion: {vx: 0, vy: 0, vz: 0, wx: 0, wy: 0, wz: 0}}\n"
    "time: {step: 1 us, end: 1}\nrun: {threads: 1}\noutput: {history_rows: 10000000}\n";
static const double overlap = 1e-5, spring = 1e5;

/* The force on the second sphere and the ledger in the first step of a stage. */
static double force_in(gn_run *run, size_t stage, gn_energy *ledger) {
    while (run->world.stages.now < stage ||
           run->world.ctx.step == (int64_t)run->world.stages.state[stage].step)
        steps(run, 1);
    *ledger = run->world.ledger.reading;
    return -run->world.dem.set_reaction[6];
}

static void bonds_begin_without_force_where_they_form(void **state) {
    (void)state;
    char *scene = joined(pair, "stages:\n- {name: touch, end: {steps: 5}}\n",
                         "- {name: bond, bonds: {enabled: on}, end: {steps: 5}}\n"
                         "- {name: pull, sets: {b: {motion: {vx: 0.1}}}, end: {steps: 40}}\n"
                         "- {name: free, bonds: {enabled: off}, end: {steps: 5}}\n");
    gn_run *run = run_of(scene);
    gn_energy e;
    steps(run, 1);
    assert_near(-run->world.dem.set_reaction[6], spring * overlap, 1e-9);
    assert_int_equal(run->world.dem.bonds.contacts.soa.count, 0);
    assert_near(force_in(run, 1, &e), 0.0, 1e-9);
    assert_int_equal(run->world.dem.bonds.contacts.soa.count, 1);
    double held = 0.5 * spring * overlap * overlap;
    assert_near(e.stage_change, -held, 1e-9 * held);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    force_in(run, 2, &e);
    steps(run, 38);
    assert_near(run->world.dem.set_reaction[6], spring * 3.8e-6, 1e-6 * spring * 3.8e-6);
    assert_near(force_in(run, 3, &e), 0.0,
                1e-9); /* without tension any more the pair is not in contact */
    /* The work of the tension over the last 0.1 um, from 3.9 to 4.0, is booked by half only. */
    assert_near(e.stage_change, -held - 0.5 * spring * 3.9e-6 * 4e-6, 1e-6 * held);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    assert_int_equal(run->world.dem.broken_tension, 0);
    run_end(run);
}

/* Ten steps of 0.1 um into a bond, then three times its stiffness: however few steps there are, all
 * of the energy that appears is booked, so that the residual is rounding only. */
static void a_change_of_stiffness_books_all_that_appears(void **state) {
    (void)state;
    gn_run *run = run_of(
        joined(pair, "stages:\n- {name: bond, bonds: {enabled: on}, end: {steps: 2}}\n",
               "- {name: pull, sets: {b: {motion: {vx: 0.1}}}, end: {steps: 10}}\n"
               "- {name: stiff, materials: {m: {normal_stiffness: 3e5}}, end: {steps: 5}}\n"
               "- {name: soft, materials: {m: {normal_stiffness: 0.5e5}}, end: {steps: 5}}\n"));
    gn_energy e;
    force_in(run, 2, &e);
    assert_near(e.stage_change, 0.5 * 2e5 * 0.9e-6 * 1e-6, 1e-6 * e.elastic_normal);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    force_in(run, 3, &e);
    assert_near(gn_energy_residual(&e), 0.0, 1e-9);
    run_end(run);
}

/* A sphere pressed against the surface on which it slides, by Hertz's law; %s: a wall or a body of
 * its material. */
static char *pressed_on(const char *what, const char *run) {
    static char s[4096];
    snprintf(s, sizeof s,
             "specimen: {particles: [[0, 0, 0.99 mm, 1 mm]]}\n"
             "materials: [{name: m, density: 2000, young: 1e7, poisson: 0.3, friction: 0.9, "
             "rolling_friction: 0.5, restitution: 0.8}]\n"
             "law: {stiffness: hertz}\n%s\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
             "sets: [{name: a, select: {all: true}, motion: {vx: 20 mm/s, vy: 0, vz: -10 mm/s, "
             "wx: 0, wy: 2, wz: 0}}]\n"
             "time: {step: 1 us, end: 1}\nrun: {%s}\noutput: {history_rows: 10000000}\n"
             "stages:\n- {name: press, end: {steps: 100}}\n"
             "- {name: stiff, materials: {m: {young: 3e7}}, end: {steps: 100}}\n"
             "- {name: soft, materials: {m: {young: 2e7, poisson: 0.1}}, end: {steps: 100}}\n"
             "- {name: smooth, materials: {m: {friction: 0.01}}, end: {steps: 100}}\n",
             what, run);
    return s;
}
static const char *const under[] = {
    "walls: [{name: b, point: [0, 0, 0], normal: [0, 0, 1], material: m}]",
    "bodies: [{name: b, material: m, box: {size: [0.1, 0.1, 0.01]}, origin: [-0.04, -0.05, "
    "-0.01]}]"};

/* The force is that of the materials of the present stage, with half of E/(1 - nu^2), and the
 * change of the energy stored in the contact, under compression, shear and rolling, is in the
 * ledger. Formerly the force was that of the first stage. */
static void walls_and_bodies_follow_materials_that_change(void **state) {
    (void)state;
    static const double young[] = {1e7, 3e7, 2e7, 2e7}, poisson[] = {0.3, 0.3, 0.1, 0.1};
    for (size_t k = 0; k < 2; k++) {
        gn_run *run = run_of(pressed_on(under[k], "threads: 1"));
        for (size_t stage = 0; stage < 4; stage++) {
            while (run->world.stages.now < stage) steps(run, 1);
            steps(run, 40);
            const gn_energy *e = &run->world.ledger.reading;
            double u = 1e-5 + 0.01 * 1e-6 * (double)(run->world.ctx.step - 1);
            double modulus = 0.5 * young[stage] / (1.0 - poisson[stage] * poisson[stage]);
            double force = -4.0 / 3.0 * modulus * sqrt(1e-3 * u) * u, damped = 0.0;
            const gn_wall_contacts *q = &run->world.boundary.contacts;
            if (q->fd) damped = q->fd[0];
            assert_near(q->row[2] - damped, -force, 1e-9 * -force);
            assert_near(gn_energy_residual(e), 0.0, 1e-6); /* the error of 100 steps of u^1.5 */
            if (stage == 3)
                assert_true(e->friction > 1e-8); /* J; earlier stages have nearly no friction */
        }
        run_end(run);
    }
}

/* A stretched and sheared bond carries no force once it is dissolved, and this does not count as
 * sliding. The normal rotates by 0.05 mrad per step, a first-order error in the residual of the
 * last step. */
static void dissolving_a_bond_is_no_friction(void **state) {
    (void)state;
    gn_run *run =
        run_of(joined(pair, "stages:\n- {name: bond, bonds: {enabled: on}, end: {steps: 2}}\n",
                      "- {name: pull, sets: {b: {motion: {vx: 0.1}}}, end: {steps: 15}}\n"
                      "- {name: shear, sets: {b: {motion: {vx: 0, vy: 0.1}}}, end: {steps: 40}}\n"
                      "- {name: free, bonds: {enabled: off}, end: {steps: 5}}\n"));
    gn_energy e;
    double stored = 0.5 * 0.5 * spring * 4e-6 * 4e-6;
    force_in(run, 3, &e);
    steps(run, 3);
    assert_near(run->world.ledger.reading.friction, 0.0, 1e-6 * stored);
    assert_near(run->world.ledger.reading.elastic_shear, 0.0, 1e-6 * stored);
    assert_near(gn_energy_residual(&run->world.ledger.reading), 0.0, 1e-5);
    run_end(run);
}

static void bonds_may_form_under_their_force(void **state) {
    (void)state;
    gn_run *run = run_of(joined(pair, "stages:\n- {name: touch, end: {steps: 5}}\n",
                                "- {name: bond, bonds: {enabled: on, passive_gaps: false}}\n"));
    gn_energy e;
    assert_near(force_in(run, 1, &e), spring * overlap, 1e-9);
    assert_near(e.stage_change, 0.0, 1e-20);
    run_end(run);
}

/* A row of four with a wider gap in its middle, which only the second forming of bonds closes. */
static void bonds_form_beside_bonds(void **state) {
    (void)state;
    gn_run *run =
        run_of("specimen: {particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm], [4.2 mm, 0, 0, 1 mm], "
               "[6.2 mm, 0, 0, 1 mm]], group: 1}\n"
               "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, "
               "bond_tension_limit: 1, bond_shear_limit: 1}]\n"
               "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n"
               "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\ntime: {end: 1 ms}\nrun: {threads: 1}\n"
               "sets: [{name: last, select: {ids: [3]}, motion: {vx: 10 mm/s}}]\n"
               "stages:\n- {name: a, end: {steps: 20}}\n"
               "- {name: b, bonds: {interaction_range: 0.2}, end: {steps: 20}}\n"
               "- {name: c, materials: {m: {bond_tension_limit: 1e-6}}, end: {steps: 50}}\n");
    steps(run, 10);
    assert_int_equal(run->world.dem.bonds.contacts.soa.count, 2);
    double before = run->world.dem.bonds.contacts.length0[0];
    steps(run, 15);
    assert_int_equal(run->world.dem.bonds.contacts.soa.count, 3);
    assert_near(run->world.dem.bonds.contacts.length0[0], before, 0.0);
    assert_near(run->world.dem.bonds.contacts.length0[1], 2.2e-3, 1e-5);
    steps(run, 30);
    assert_true(run->world.dem.broken_tension > 0); /* bonds break at the new strength */
    assert_near(gn_energy_residual(&run->world.ledger.reading), 0.0, 1e-3);
    run_end(run);
}

/* Settle, bond, confine, load. */
static char *programme(const char *run) {
    static char s[16384];
    snprintf(
        s, sizeof s,
        "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [2, 2, 2], spacing: 1.005}, group: "
        "1}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: 0.3, "
        "bond_tension_limit: 0.05, bond_shear_limit: 0.1}]\n"
        "law: {stiffness: uniform}\nbonds: {enabled: off}\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
        "damping: {background: {model: nonviscous_vector, coefficient: 0.6}}\nwalls:\n"
        "- {name: floor, point: [0, 0, -1 mm], normal: [0, 0, 1], stiffness: 1e5}\n"
        "- {name: lid, point: [0, 0, 5.29 mm], normal: [0, 0, -1], stiffness: 1e5}\n"
        "- {name: west, point: [-1.01 mm, 0, 0], normal: [1, 0, 0], stiffness: 1e5}\n"
        "- {name: east, point: [5.29 mm, 0, 0], normal: [-1, 0, 0], stiffness: 1e5}\n"
        "- {name: south, point: [0, -1.01 mm, 0], normal: [0, 1, 0], stiffness: 1e5}\n"
        "- {name: north, point: [0, 5.29 mm, 0], normal: [0, -1, 0], stiffness: 1e5}\n"
        "test: {kind: compression, axis: z, lower: floor, upper: lid, length: 6 mm, area: 40 mm2}\n"
        "time: {end: 1}\noutput: {history_rows: 200}\nrun: {%s}\nstages:\n"
        "- {name: settle, walls: {lid: {servo: {force: 0.02, max_velocity: 0.5}}}, "
        "end: {time: 5 ms}}\n"
        "- {name: bond, bonds: {enabled: on, interaction_range: 0.02}, end: {time: 0.3 ms}}\n"
        "- {name: confine, walls: {east: {servo: {force: 0.02, max_velocity: 0.5}}, "
        "north: {servo: {force: 0.02, max_velocity: 0.5}}}, end: {time: 2 ms}}\n"
        "- {name: load, walls: {lid: {motion: {vz: -30 mm/s}}}, end: {time: 2 ms}}\n",
        run);
    return s;
}

static void a_specimen_is_settled_bonded_confined_and_loaded(void **state) {
    (void)state;
    gn_run *run = run_of(programme("threads: 1"));
    finish(run);
    gn_dem *d = &run->world.dem;

    assert_true(d->bonds_at_start > 32);
    assert_true(d->broken_tension + d->broken_shear > 0);
    assert_near(gn_energy_residual(&run->world.ledger.reading), 0.0, 5e-3);
    uint64_t hash = gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                                  &run->world.solids, &run->world.box);
    run_end(run);
    assert_true(hash == hash_of(programme("threads: 2")));
    assert_true(hash_of(programme("threads: 1, precision: mixed")) ==
                hash_of(programme("threads: 2, precision: mixed")));
}

/* A checkpoint inside every stage, and at the ends of some. */
static void resumes_with_the_same_bits(const char *scene, int64_t every, size_t stages) {
    char path[] = "/tmp/gneiss_stages_XXXXXX";
    gneiss_error error = {0};
    close(mkstemp(path));
    gn_run *run = run_of(scene), *other;
    size_t seen = 0;
    while (!run->finished) {
        steps(run, every);
        seen |= (size_t)1 << run->world.stages.now;
        if (gn_checkpoint_write(run, path, &error) != GNEISS_OK) fail_msg("%s", error.message);
        run_end(run);
        run = calloc(1, sizeof *run);
        if (gn_run_load(path, NULL, 0, run, &error) != GNEISS_OK) fail_msg("%s", error.message);
    }
    other = run_of(scene);
    steps(other, run->world.ctx.step); /* the steps go past the end as well */
    assert_int_equal(seen, stages);
    assert_true(gn_world_hash(&run->world.ctx, &run->world.dem, &run->world.boundary,
                              &run->world.solids, &run->world.box) ==
                gn_world_hash(&other->world.ctx, &other->world.dem, &other->world.boundary,
                              &other->world.solids, &other->world.box));
    assert_near(run->world.ledger.energy.friction, other->world.ledger.energy.friction, 0.0);
    assert_near(run->world.ledger.energy.stage_change, other->world.ledger.energy.stage_change,
                0.0);
    assert_int_equal(run->history.row_count, other->history.row_count);
    run_end(run);
    run_end(other);
    unlink(path);
}

static void a_resumed_run_has_the_same_bits(void **state) {
    (void)state;
    resumes_with_the_same_bits(whole("threads: 1"), 211, 1 + 4 + 8 + 16);
    resumes_with_the_same_bits(whole("threads: 2, precision: mixed"), 211, 1 + 4 + 8 + 16);
    resumes_with_the_same_bits(programme("threads: 1"), 503, 1 + 2 + 4 + 8);
    resumes_with_the_same_bits(programme("threads: 2, precision: mixed"), 503, 1 + 2 + 4 + 8);
}

/* --- bonds that have gone through something --- */

/* A block is pulled and compressed, so that bonds soften and yield, gets more bonds across wider
 * gaps meanwhile, then loses all of them and falls apart; with all features that this allows. */
static char *worn(const char *coupling, const char *run) {
    static char s[16384];
    snprintf(
        s, sizeof s,
        "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: 1.005, jitter: "
        "0.01}, group: 1}\n"
        "materials: [{name: m, density: 2000, contact_modulus: 1e8, kratio: 2, friction: 0.3, "
        "tensile_strength: 1e5, shear_strength: 1e5, bond_friction: 0.5, fracture_energy: 2, "
        "shear_fracture_energy: 3, yield_stress_1: 5e4, yield_ratio_1: 3, yield_stress_2: 2e5, "
        "yield_ratio_2: 8, strength_scatter: {distribution: weibull, modulus: 8}}]\n"
        "law: {stiffness: harmonic, softening: energy, fracture_energy_of: body, coupling: %s, "
        "confinement: mean}\n"
        "bonds: {enabled: off}\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
        "gravity: [0, 0, -9.81]\n"
        "damping: {contact: {restitution: 0.7}, background: {model: viscous, coefficient: 300}}\n"
        "sets:\n- {name: low, select: {end: {axis: z, side: lower, depth: 2 mm}}, "
        "motion: {vz: 0}}\n"
        "- {name: top, select: {end: {axis: z, side: upper, depth: 2 mm}}}\n"
        "walls:\n- {name: floor, point: [0, 0, -1.1 mm], normal: [0, 0, 1], stiffness: 2e5, "
        "kratio: 2, friction: 0.2}\n"
        "time: {end: 1}\noutput: {history_rows: 100}\nrun: {%s}\nstages:\n"
        "- {name: bond, bonds: {enabled: on, interaction_range: 0.005}, end: {steps: 200}}\n"
        "- {name: pull, sets: {top: {motion: {vz: 0.2}}}, end: {time: 0.3 ms}}\n"
        "- {name: press, sets: {top: {motion: {vz: -0.2}}}, end: {time: 0.6 ms}}\n"
        "- {name: more, bonds: {interaction_range: 0.03}, end: {steps: 0}}\n"
        "- {name: again, sets: {top: {motion: {vz: 0.3}}}, end: {time: 0.6 ms}}\n"
        "- {name: free, bonds: {enabled: off}, gravity: [1, 0, -9.81], end: {time: 0.3 ms}}\n",
        coupling, run);
    return s;
}

static void materials_of_walls_and_bodies_have_the_same_bits(void **state) {
    (void)state;
    for (size_t k = 0; k < 2; k++)
        resumes_with_the_same_bits(pressed_on(under[k], "threads: 1"), 33, 0xf);
}

/* A packing is bonded, then confined: the pressure begins, rises and falls in stages, and ramps
 * last beyond the end of theirs. */
static char *confined(const char *run) {
    static char s[4096];
    snprintf(s, sizeof s,
             "specimen: {box: {size: [8 mm, 8 mm, 10 mm]}, particles: 120}\n"
             "materials: [{name: m, density: 2600, contact_modulus: 1e9, kratio: 2, friction: 0.3, "
             "tensile_strength: 3 MPa, shear_strength: 3 MPa}]\nlaw: {stiffness: harmonic}\n"
             "bonds: {enabled: off}\ntest: {kind: hydrostatic}\n"
             "damping: {background: {model: nonviscous_vector, coefficient: 0.5}}\n"
             "time: {end: 1}\noutput: {history_rows: 100}\nrun: {%s}\nstages:\n"
             "- {name: rest, end: {steps: 50}}\n"
             "- {name: bond, bonds: {enabled: on, interaction_range: 0.02}, end: {steps: 50}}\n"
             "- {name: confine, membrane: {pressure: 5 MPa, ramp: 0.1 ms}, end: {time: 60 us}}\n"
             "- {name: on, end: {time: 60 us}}\n"
             "- {name: less, membrane: {pressure: [[0, 2 MPa], [90 us, 3 MPa]]}, end: {time: "
             "120 us}}\n",
             run);
    return s;
}

static void a_membrane_of_stages_has_the_same_bits(void **state) {
    (void)state;
    const char *const mixed = "threads: 2, precision: mixed";
    assert_true(hash_of(confined("threads: 1")) == hash_of(confined("threads: 2")));
    resumes_with_the_same_bits(confined("threads: 1"), 41, 0x1f);
    resumes_with_the_same_bits(confined(mixed), 41, 0x1f);
}

static void damaged_bonds_of_several_stages_have_the_same_bits(void **state) {
    (void)state;
    const size_t seen = 1 + 2 + 4 + 16 + 32; /* the fourth has no steps */
    const char *const mixed = "threads: 2, precision: mixed";
    assert_true(hash_of(worn("linear", "threads: 1")) == hash_of(worn("linear", "threads: 2")));
    resumes_with_the_same_bits(worn("linear", "threads: 1"), 97, seen);
    resumes_with_the_same_bits(worn("quadratic", mixed), 97, seen);
}

/* Returns the bond of two particles, by their numbers in the specimen; SIZE_MAX: none. */
static size_t bond_between(const gn_world *w, int32_t a, int32_t b) {
    const gn_contacts *k = &w->dem.bonds.contacts;
    for (size_t c = 0; c < k->soa.count; c++) {
        int32_t i = w->dem.particles.id[k->i[c]], j = w->dem.particles.id[k->j[c]];
        if ((i == a && j == b) || (i == b && j == a)) return c;
    }
    return SIZE_MAX;
}

/* Runs to the step before bonds form beside bonds that have softened and yielded. */
static gn_run *before_more_bonds(int64_t step) {
    gn_run *run = run_of(worn("linear", "threads: 1"));
    steps(run, step);
    assert_int_equal(run->world.stages.now, 2);
    return run;
}

static void new_bonds_do_not_change_damaged_ones(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_run *run = run_of(worn("linear", "threads: 1"));
    while (run->world.stages.now < 4) steps(run, 1);
    gn_run *after = before_more_bonds(run->world.ctx.step - 1),
           *before = before_more_bonds(run->world.ctx.step - 1);
    if (gn_world_enter(&after->world, 3, &error) != GNEISS_OK) fail_msg("%s", error.message);
    const gn_contacts *now = &after->world.dem.bonds.contacts,
                      *old = &before->world.dem.bonds.contacts;
    assert_true(now->soa.count > old->soa.count + 20 && old->soa.count > 20);
    size_t fresh = 0, softened = 0, yielded = 0, broken = 0;
    for (size_t c = 0; c < now->soa.count; c++) {
        size_t b = bond_between(&before->world, after->world.dem.particles.id[now->i[c]],
                                after->world.dem.particles.id[now->j[c]]);
        double length = now->length0[c], yields = now->yields[c];
        if (b == SIZE_MAX) {
            assert_true(now->soft[c] == 1.0 && now->kappa[c] == 0.0 && now->plastic[c] == 0.0);
            assert_true(now->cause[c] == GN_INTACT && now->rn[c] > 0.0);
            fresh++;
            continue;
        }
        assert_true(now->soft[c] == old->soft[b] && now->kappa[c] == old->kappa[b]);
        assert_true(now->plastic[c] == old->plastic[b] && yields == old->yields[b]);
        assert_true(now->rn[c] == old->rn[b] && now->rt[c] == old->rt[b]);
        assert_true(length == old->length0[b] && now->cause[c] == old->cause[b]);
        softened += old->soft[b] < 0.9;
        yielded += old->plastic[b] < -1e-7;
        broken += old->cause[b] != GN_INTACT;
    }
    assert_int_equal(fresh, now->soa.count - old->soa.count);
    print_message("# %zu softened, %zu yielded, %zu broken, %zu new\n", softened, yielded, broken,
                  fresh);
    assert_true(softened > 5 && yielded > 5);
    finish(run);
    assert_near(gn_energy_residual(&run->world.ledger.reading), 0.0, 5e-3);
    run_end(run);
    run_end(before);
    run_end(after);
}

/* Planes cut the bonds that exist when the new ones form, not those at the start of the run. */
static void a_fracture_energy_of_the_body_holds_for_bonds_of_a_later_stage(void **state) {
    (void)state;
    const char *const parts[] = {"contact", "body"}, *const when[] = {"off", "on"};
    double end[2][2];
    for (int k = 0; k < 4; k++) {
        char scene[2048];
        snprintf(scene, sizeof scene,
                 "specimen: {lattice: {kind: cubic, radius: 1e-3, cells: [5, 5, 5]}}\n"
                 "materials: [{name: m, density: 2650, young: 1e9, poisson: 0.2, tensile_strength: "
                 "1e6, shear_strength: 1e6, fracture_energy: 30}]\n"
                 "law: {stiffness: polyhedron, softening: energy, fracture_energy_of: %s}\n"
                 "bonds: {enabled: %s}\n"
                 "periodic: {min: [0, 0, 0], max: [10e-3, 10e-3, 10e-3]}\ntime: {end: 1}\n"
                 "run: {threads: 1}\nstages:\n- {name: a, end: {steps: 2}}\n"
                 "- {name: b, bonds: {enabled: on}}\n",
                 parts[k % 2], when[k / 2]);
        gn_run *run = run_of(scene);
        steps(run, 5);
        const gn_contacts *b = &run->world.dem.bonds.contacts;
        assert_int_equal(b->soa.count, 375);
        end[k / 2][k % 2] = b->fade[GN_FADE_END * b->soa.capacity];
        run_end(run);
    }
    for (int k = 0; k < 2; k++) assert_near(end[k][0] / end[k][1], 1.5, 1e-6);
}

/* --- ends --- */

static void a_settled_heap_goes_on(void **state) {
    (void)state;
    gn_run *run = run_of(
        joined(heap, "time: {end: 1}\nrun: {threads: 1}\nstages:\n",
               "- {name: settle, walls: {lid: {servo: {force: 0.5, max_velocity: 1}}}, "
               "damping: {background: {coefficient: 0.7}}, end: {unbalanced: 0.01, time: 0.2}}\n"
               "- {name: hold, walls: {lid: {servo: {force: 1}}}, end: {held: 2 %, time: 0.1}}\n"
               "- {name: load, walls: {lid: {motion: {vz: -10 mm/s}}}, end: {strain: 0.5 %}}\n"
               "- {name: on, end: {stress: 20 kPa}}\n"));
    finish(run);
    assert_int_equal(cause_of(run, 0), GN_STAGE_UNBALANCED);
    assert_int_equal(cause_of(run, 1), GN_STAGE_HELD);
    assert_int_equal(cause_of(run, 2), GN_STAGE_STRAIN);
    assert_int_equal(cause_of(run, 3), GN_STAGE_STRESS);
    const double *strain = gn_history_column(&run->history, "strain");
    size_t first = (size_t)run->world.stages.state[2].row,
           after = (size_t)run->world.stages.state[3].row;
    assert_true(strain[after - 1] - strain[first] >= 0.005);
    /* The last row before the present one at which ends are checked. */
    assert_true(strain[after - 1 - (1 << GN_ROW_HALVINGS)] - strain[first] < 0.005);
    gn_readings r;
    gneiss_error error = {0};
    assert_int_equal(gn_run_stage_readings(run, 2, &r, &error), GNEISS_OK);
    assert_near(r.largest_strain, strain[after - 1] - strain[first], 0.0051);
    run_end(run);
}

/* Readings are kept until the run has advanced: the column is not read again. */
static void readings_are_found_once_for_a_state(void **state) {
    (void)state;
    gn_run *run = run_of(joined(heap, "time: {end: 10 ms}\nrun: {threads: 1}\nstages:\n",
                                "- {name: wait, end: {steps: 50}}\n"
                                "- {name: load, walls: {lid: {motion: {vz: -1}}}}\n"));
    const gn_readings *first, *again;
    gn_readings of_stage;
    gneiss_error error = {0};
    steps(run, 600);
    assert_int_equal(gn_run_readings(run, &first, &error), GNEISS_OK);
    const double largest = first->largest_stress;
    assert_true(largest > 0.0);
    double *stress = (double *)gn_history_column(&run->history, "stress");
    for (size_t k = 0; k < run->history.row_count; k++) stress[k] *= 2.0;
    assert_int_equal(gn_run_readings(run, &again, &error), GNEISS_OK);
    assert_int_equal(gn_run_stage_readings(run, 1, &of_stage, &error), GNEISS_OK);
    assert_ptr_equal(again, first);
    assert_true(again->largest_stress == largest && of_stage.largest_stress == largest);
    steps(run, 1);
    assert_int_equal(gn_run_readings(run, &again, &error), GNEISS_OK);
    assert_true(again->largest_stress >= 2.0 * largest);
    run_end(run);
}

static void a_run_stopped_by_time_end_names_the_unfinished_stage(void **state) {
    (void)state;
    gn_run *run = run_of(joined(heap, "time: {end: 1 ms}\nrun: {threads: 1}\nstages:\n",
                                "- {name: wait, gravity: [0, 0, -10], end: {unbalanced: 1e-9}}\n"
                                "- {name: load}\n"));
    finish(run);
    assert_string_equal(run->stop_reason,
                        "t = 0.001 s reached in stage 'wait' (1 of 2): later stages were not "
                        "reached");
    gn_warnings warnings;
    gneiss_error error = {0};
    assert_int_equal(gn_run_warnings(run, &warnings, &error), GNEISS_OK);
    assert_int_equal(warnings.count, 2);
    assert_string_equal(warnings.warning[0].name, "stages_left");
    assert_string_equal(warnings.warning[1].name, "key_without_effect");
    assert_string_equal(warnings.warning[1].text,
                        "walls[2].kratio: it changes nothing here: the wall has no friction; "
                        "walls[3].kratio: it changes nothing here: the wall has no friction");
    run_end(run);
}

/* --- beside other parts --- */

static const char mixed_scene[] =
    "specimen: {lattice: {kind: cubic, radius: 1 mm, cells: [3, 3, 3], origin: [0, 0, 1 mm]}}\n"
    "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: 0.3}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
    "damping: {contact: {restitution: 0.5}}\n"
    "elements:\n"
    "  box: {size: [8 mm, 8 mm, 2 mm], cells: [4, 4, 1], origin: [-1 mm, -1 mm, -1 mm]}\n"
    "  materials: [{young: 1e8, poisson: 0.3, density: 2000}]\n"
    "  motions: [{name: foot, group: z_lower, motion: {vx: 0, vy: 0, vz: 0}}]\n"
    "  loads: [{name: side, group: x_lower, traction: {tx: 0}}]\n"
    "  contact: {stiffness: 1e5}\n"
    "bodies:\n"
    "- {name: plate, box: {size: [8 mm, 8 mm, 1 mm]}, origin: [-1 mm, -1 mm, 7.01 mm], "
    "stiffness: 1e5, motion: {vz: 0}}\n"
    "- {name: stone, box: {size: [1 mm, 1 mm, 1 mm]}, origin: [20 mm, 0, 0], stiffness: 1e5, "
    "free: true, density: 2000}\n"
    "time: {end: 1}\n"
    "stages:\n"
    "- {name: rest, end: {time: 0.2 ms}}\n"
    "- name: weigh\n"
    "  gravity: [0, 0, -9.81]\n"
    "  damping: {background: {model: nonviscous_vector, coefficient: 0.4}}\n"
    "  elements: {loads: {side: {traction: {tx: [[0, 0], [0.1 ms, 1 kPa]]}}}}\n"
    "  end: {time: 0.3 ms}\n"
    "- name: press\n"
    "  bodies: {plate: {motion: {vz: -50 mm/s}}}\n"
    "  elements: {motions: [{name: foot, motion: {vz: 10 mm/s}}]}\n"
    "  end: {time: 0.5 ms}\n";

static const char *beside(const char *run) {
    static char s[16384];
    snprintf(s, sizeof s, "%srun: {%s}\n", mixed_scene, run);
    return s;
}

static void bodies_and_elements_take_their_part(void **state) {
    (void)state;
    gn_run *run = run_of(beside("threads: 1"));
    finish(run);
    gn_world *w = &run->world;
    double fall = 9.81 * 0.8e-3;
    assert_near(w->boundary.bodies[1].velocity[2], -fall,
                0.01 * fall); /* the error is half a step */
    assert_near(w->boundary.bodies[0].position[2] - w->boundary.bodies[0].start[2], -25e-6,
                0.05 * 25e-6);
    double travel[3];
    gn_elements_travel(&w->solids, 0, travel);
    assert_near(travel[2], 5e-6, 0.05 * 5e-6);
    assert_near(gn_energy_residual(&w->ledger.reading), 0.0, 2e-3);
    uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    run_end(run);
    assert_true(hash == hash_of(beside("threads: 2")));
}

static void the_scene_of_stages_goes_through_all_of_them(void **state) {
    (void)state;
    gn_scene scene;
    char path[4096];
    gneiss_error error = {0};
    gn_run *run = calloc(1, sizeof *run);
    const gn_override one = {"run.threads", "1"};
    snprintf(path, sizeof path, "%s/scenes/stages.yaml", test_source());
    assert_int_equal(gn_scene_load(path, &one, 1, &scene, &error), GNEISS_OK);
    assert_int_equal(gn_run_create(&scene, run, &error), GNEISS_OK);
    finish(run);
    const gn_stage_cause causes[] = {GN_STAGE_UNBALANCED, GN_STAGE_HELD, GN_STAGE_HELD,
                                     GN_STAGE_PEAK_DROP};
    for (size_t k = 0; k < 4; k++) assert_int_equal(cause_of(run, k), causes[k]);
    assert_true(run->world.dem.bonds_at_start > 1000);
    assert_near(gn_energy_residual(&run->world.ledger.reading), 0.0, 1e-3);
    const gn_readings *readings;
    assert_int_equal(gn_run_readings(run, &readings, &error), GNEISS_OK);
    assert_true(readings->peak_stress > 1e4);
    run_end(run);
}

/* The scene stored in checkpoints: its stages are restored unchanged. */
static void a_written_scene_has_the_same_stages(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_scene scene, again, one, other;
    assert_int_equal(gn_scene_parse(whole("threads: 1"), "s", NULL, NULL, 0, &scene, &error), 0);
    char *written = gn_scene_write(&scene);
    if (gn_scene_parse_saved(written, "t", NULL, 0, &again, &error)) fail_msg("%s", error.message);
    for (size_t k = 0; k < scene.stage_count; k++) {
        assert_int_equal(gn_scene_stage(&scene, k, &one, &error), GNEISS_OK);
        assert_int_equal(gn_scene_stage(&again, k, &other, &error), GNEISS_OK);
        char *first = gn_scene_write(&one), *second = gn_scene_write(&other);
        assert_string_equal(first, second);
        free(first);
        free(second);
        gn_scene_free(&one);
        gn_scene_free(&other);
    }
    free(written);
    gn_scene_free(&scene);
    gn_scene_free(&again);
}

/* Values inside stages are reached as those of a scene. */
static void overrides_reach_into_stages(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_scene scene, one;
    const gn_override overrides[] = {{"stages.load.walls.lid.motion.vz", "-1 mm/s"},
                                     {"stages[1].end.steps", "7"}};
    assert_int_equal(gn_scene_parse(whole("threads: 1"), "s", NULL, overrides, 2, &scene, &error),
                     0);
    assert_int_equal(scene.stages[1].steps, 7);
    assert_int_equal(gn_scene_stage(&scene, 4, &one, &error), GNEISS_OK);
    assert_near(one.walls[1].motion.velocity[2].value[0], -1e-3, 0.0);
    gn_scene_free(&one);
    gn_scene_free(&scene);
    const gn_override wrong = {"stages.load.walls.lid.stiffness", "3"};
    assert_int_equal(gn_scene_parse(whole("threads: 1"), "s", NULL, &wrong, 1, &scene, &error),
                     GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "--set stages.load.walls.lid.stiffness"));
    assert_non_null(gn_scene_key_at("stages.load.walls.lid.motion.vz"));
}

/* --- from another run --- */

static void finish_in(const char *scene_text, const char *folder) {
    gn_scene scene;
    gneiss_error error = {0};
    gn_run *run = calloc(1, sizeof *run);
    if (gn_scene_parse(scene_text, "a.yaml", NULL, NULL, 0, &scene, &error) ||
        gn_run_start(&scene, folder, true, run, &error))
        fail_msg("%s", error.message);
    finish(run);
    if (gn_run_finish(run, &error)) fail_msg("%s", error.message);
    run_end(run);
}

/* Two bonds between three spheres, the last of which moves away by 40 um in total, with rotation;
 * and a fourth that leaves. */
static const char drawn[] =
    "specimen: {particles: [[0, 0, 0, 1 mm], [0, 9 mm, 0, 1 mm], [2 mm, 0, 0, 1 mm], [4 mm, 0, 0, "
    "1 mm]], group: 1}\nbonds: {interaction_range: 0.01}\n"
    "domain: {min: [-9, -9, -9], max: [9, 10 mm, 9], lost: remove}\n"
    "sets:\n- {name: foot, select: {ids: [0]}, motion: {vx: 0}}\n"
    "- {name: head, select: {ids: [3]}, motion: {vx: 0.1}}\n"
    "- {name: off, select: {ids: [1]}, initial_velocity: [0, 40, 0], initial_spin: [0, 0, 1]}\n";
static const char rock[] =
    "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, "
    "bond_tension_limit: 10, bond_shear_limit: 10}]\n"
    "law: {stiffness: uniform}\ndamping: {background: {model: viscous, coefficient: 1e4}}\n"
    "time: {end: 0.4 ms}\nrun: {threads: 1}\n";

static char *again(const char *folder, const char *more, const char *bonds) {
    static char s[8192];
    snprintf(s, sizeof s, "specimen: {from: %s, group: 1%s}\n%s%s", folder, more, rock, bonds);
    return s;
}

/* Spheres of 1 mm that overlap by 0.1 mm: two with a bond, and a third of another group. */
static const char overlapping[] =
    "specimen: {particles: [[0, 0, 0, 1 mm], [1.9 mm, 0, 0, 1 mm], [0, 1.9 mm, 0, 1 mm]]}\n"
    "bonds: {}\nsets:\n- {name: other, select: {ids: [2]}, group: 2}\n";

/* Overlaps free of stress remain so in a run that continues with the bonds of another, bonded,
 * broken, dissolved or never bonded. */
static void free_overlaps_go_over_into_another_run(void **state) {
    (void)state;
    static const char *const stages[] = {
        "", "stages:\n- {name: a, end: {steps: 3}}\n- {name: b, bonds: {enabled: off}}\n"};
    for (int dissolved = 0; dissolved < 2; dissolved++) {
        char folder[] = "/tmp/gneiss_from_XXXXXX";
        assert_non_null(mkdtemp(folder));
        finish_in(joined(overlapping, rock, stages[dissolved]), folder);
        gn_run *run = run_of(again(folder, ", from_bonds: keep", "bonds: {}\n"));
        assert_int_equal(run->world.dem.bonds_at_start, !dissolved);
        assert_int_equal(run->world.dem.bonds.contacts.soa.count, 2);
        steps(run, 1);
        assert_near(run->world.ledger.reading.elastic_normal, 0.0, 1e-20);
        steps(run, 20);
        assert_near(run->world.ledger.reading.kinetic, 0.0, 1e-20);
        run_end(run);
    }
}

/* Overlaps of a packing that a later stage bonds are free of stress before, and take bonds then. */
static void overlaps_of_a_packing_wait_for_their_bonds(void **state) {
    (void)state;
    gn_run *run = run_of(joined(
        "specimen: {box: {size: [8 mm, 8 mm, 8 mm]}, particles: 60, packing: {overlap: passive}}\n",
        rock,
        "bonds: {enabled: off}\nstages:\n- {name: a, end: {steps: 10}}\n"
        "- {name: b, bonds: {enabled: on}}\n"));
    const size_t overlaps = run->world.dem.bonds.contacts.soa.count;
    assert_true(overlaps > 100);
    assert_int_equal(run->world.dem.bonds_at_start, 0);
    steps(run, 5);
    assert_near(run->world.ledger.reading.kinetic, 0.0, 1e-20);
    finish(run);
    assert_true(run->world.dem.bonds.contacts.soa.count >=
                overlaps); /* pairs at the limit of contact get bonds too */
    assert_int_equal(run->world.dem.bonds_at_start, run->world.dem.bonds.contacts.soa.count);
    for (size_t c = 0; c < run->world.dem.bonds.contacts.soa.count; c++)
        assert_true(gn_contact_bonded(&run->world.dem.bonds.contacts, c));
    assert_near(run->world.ledger.reading.kinetic, 0.0, 1e-20);
    run_end(run);
}

static void a_run_begins_where_another_ended(void **state) {
    (void)state;
    char folder[] = "/tmp/gneiss_from_XXXXXX", file[64];
    assert_non_null(mkdtemp(folder));
    finish_in(joined(drawn, rock, ""), folder);
    gn_run *other = run_of(joined(drawn, rock, ""));
    finish(other);
    assert_int_equal(other->world.dem.lost, 1);
    const int ids[] = {0, 2, 3};

    gn_run *run = run_of(again(folder, ", from_bonds: keep", "bonds: {}\n"));
    assert_int_equal(run->world.dem.particles.soa.count, 3);
    for (int k = 0; k < 3; k++) {
        assert_memory_equal(pos_of(&run->world, k), pos_of(&other->world, ids[k]), 32);
        assert_memory_equal(vel_of(&run->world, k), vel_of(&other->world, ids[k]), 24);
    }
    assert_int_equal(run->world.dem.bonds.contacts.soa.count, 2);
    steps(run, 1);
    /* Both bonds continue with their previous stretch: 20 um each. */
    assert_near(run->world.ledger.reading.elastic_normal, 2 * 0.5 * 1e5 * 400e-12, 0.02 * 4e-5);
    run_end(run);

    snprintf(file, sizeof file, "%s/results.h5", folder);
    run = run_of(again(file, ", from_velocities: rest", "bonds: {interaction_range: 0.1}\n"));
    assert_int_equal(run->world.dem.bonds.contacts.soa.count, 2);
    for (int k = 0; k < 3; k++) assert_near(length3(vel_of(&run->world, k)), 0.0, 0.0);
    steps(run, 1);
    assert_near(run->world.ledger.reading.elastic_normal, 0.0,
                0.0); /* the bond is formed again, free of stress */
    run_end(run);
    run_end(other);

    const char *later = "bonds: {enabled: on}\nstages:\n- {name: a, end: {steps: 3}}\n"
                        "- {name: b, bonds: {enabled: off}}\n";
    run = run_of(again(folder, ", from_bonds: keep", later));
    assert_int_equal(run->world.dem.bonds.contacts.soa.count, 2);
    run_end(run);

    gneiss_error error = {0};
    gn_run wrong;
    later = "stages:\n- {name: a, bonds: {enabled: off}}\n";
    assert_int_equal(try_run(&wrong, again(folder, ", from_bonds: keep", later), &error),
                     GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "stages[0].name: expected bonds in the first stage"));
    char *flat = strcat(again(folder, "", ""), "dimension: 2\n");
    assert_int_equal(try_run(&wrong, flat, &error), GNEISS_ERROR_INPUT);
    assert_non_null(
        strstr(error.message, "s.yaml:1:18: specimen.from: expected a run of a 2D scene"));
    assert_int_equal(try_run(&wrong, again(folder, ", from_bonds: keep", ""), &error),
                     GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "specimen.from_bonds: expected the section bonds"));
    assert_int_equal(try_run(&wrong, again("/nowhere", "", ""), &error), GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "specimen.from: cannot open '/nowhere'"));
    assert_int_equal(try_run(&wrong, again(folder, ", scale: 1e-3", ""), &error),
                     GNEISS_ERROR_INPUT);
    assert_non_null(strstr(error.message, "specimen.scale: needs file, surface or mesh, whose "
                                          "lengths it scales; found from"));
    FILE *broken = fopen(file, "w");
    assert_true(broken && fputs("no results", broken) >= 0 && fclose(broken) == 0);
    assert_int_not_equal(try_run(&wrong, again(folder, "", ""), &error), GNEISS_OK);
    assert_true(strncmp(error.message, "s.yaml:1:18: specimen.from: ", 28) == 0);
}

/* --- refused input --- */

static void refused(const char *stages, const char *expected) {
    gn_run run;
    gneiss_error error = {0};
    char *scene = joined(heap, "time: {end: 1 s}\n", stages);
    gneiss_status status = try_run(&run, scene, &error);
    if (status == GNEISS_OK) fail_msg("not refused: %s", stages);
    assert_int_equal(status, GNEISS_ERROR_INPUT);
    if (!strstr(error.message, expected))
        fail_msg("expected '%s', found '%s'", expected, error.message);
}

/* A servo that held a force holds a stress, and a force again. */
static void the_last_stage_decides_between_force_and_stress(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_scene scene, one;
    const char *stages =
        "stages:\n"
        "- {name: a, walls: {lid: {servo: {force: 1, max_velocity: 1}}}, end: {steps: 1}}\n"
        "- {name: b, walls: {lid: {servo: {stress: 5}}}, end: {steps: 1}}\n"
        "- {name: c, walls: {lid: {motion: {vz: 1}}}, end: {steps: 1}}\n"
        "- {name: d, walls: {lid: {servo: {force: 2, max_velocity: 1}}}}\n";
    char *all = joined(heap, "time: {end: 1}\n", stages);
    assert_int_equal(gn_scene_parse(all, "s", NULL, NULL, 0, &scene, &error), GNEISS_OK);
    for (size_t k = 0; k < 4; k++) {
        assert_int_equal(gn_scene_stage(&scene, k, &one, &error), GNEISS_OK);
        const gn_wall_def *lid = &one.walls[1];
        assert_int_equal(lid->servo.active, k != 2);
        assert_int_equal(lid->servo.force.count, k == 0 || k == 3);
        assert_int_equal(lid->servo.stress.count, k == 1);
        assert_int_equal(lid->motion.velocity[2].count, k == 2);
        gn_scene_free(&one);
    }
    gn_scene_free(&scene);
}

static void wrong_stages_are_refused_at_their_line(void **state) {
    (void)state;
    refused("stages: []\n", "s.yaml:17:9: stages: expected a number of elements in [1, 1000]");
    refused("stages:\n- {end: {time: 1}}\n- {name: b}\n", "stages[0].name: required");
    refused("stages:\n- {name: a}\n- {name: b}\n",
            "s.yaml:18:10: stages[0].name: expected a condition under end");
    refused("stages:\n- {name: a, end: {}}\n- {name: b}\n", "stages[0].end: expected a condition");
    refused("stages:\n- {name: a, end: {steps: 1}}\n- {name: a}\n",
            "s.yaml:19:10: stages[1].name: expected a unique name, found 'a' a second time");
    refused("stages:\n- {name: a, specimen: {}}\n",
            "s.yaml:18:13: stages[0].specimen: expected a key that a stage may change");
    refused("stages:\n- {name: a, sources: []}\n",
            "s.yaml:18:13: stages[0].sources: expected a key that a stage may change");
    refused("stages:\n- {name: a, walls: {lid: {motion: {}}}}\n- {name: a}\n",
            "expected a condition under end");
    refused("stages:\n- {name: a, gravty: [0, 0, 1]}\n",
            "s.yaml:18:13: stages[0].gravty: unknown key 'gravty'; did you mean 'gravity'?");
    refused("stages:\n- {name: a, walls: {lid: {motin: {vz: 1}}}}\n",
            "s.yaml:18:27: stages[0].walls[1].motin: unknown key 'motin'; did you mean 'motion'?");
    refused(
        "stages:\n- {name: a, walls: {lit: {motion: {vz: 1}}}}\n",
        "s.yaml:18:21: stages[0].walls: expected the name of an element of the scene, found 'lit'");
    refused("stages:\n- {name: a, walls: {lid: {stiffness: 1}}}\n",
            "s.yaml:18:27: stages[0].walls.lid.stiffness: expected a key that a stage may change, "
            "found 'walls.lid.stiffness': of a wall, motion, servo and friction may change");
    refused("stages:\n- {name: a, walls: [{name: [1]}]}\n",
            "stages[0].walls: expected a name (an element without one is addressed by its number, "
            "as in contacts: {0: "
            "{friction: 0.3}}), found none");
    refused(
        "contacts: [{between: m, friction: 0.2}]\n"
        "stages:\n- {name: a, contacts: [{between: m, friction: 0.3}]}\n",
        "stages[0].contacts: expected a name (an element without one is addressed by its number");
    refused("stages:\n- {name: a, walls: {lid: 3}}\n",
            "expected a section with the changed keys of 'lid'");
    refused("stages:\n- {name: a, gravity: [0, 0, 1], gravity: [0, 0, 2]}\n",
            "s.yaml:18:33: stages[0].gravity: expected once, found 'gravity' again");
    refused("stages:\n- {name: a, time: {end: 2}}\n", "it bounds the whole run");
    refused("stages:\n- {name: a, dimension: 2}\n", "it is fixed for the whole run");
    refused("stages:\n- {name: a, walls: {lid: {motion: {vz: 1 kg}}}}\n",
            "s.yaml:18:40: stages[0].walls[1].motion.vz: expected a velocity");
    refused("stages:\n- {name: a, damping: {background: {coefficient: 2}}}\n",
            "stages[0].damping.background.coefficient: expected a fraction in [0, 1), found 2");
    refused("stages:\n- {name: a}\n- {name: b, gravity: [0, 0]}\n", "stages[0].name: expected a");
    refused("stages:\n- {name: a, end: {steps: 1}}\n- {name: b, gravity: [0, 0]}\n",
            "s.yaml:19:22: stages[1].gravity: expected a list of 3 components");
    refused("stages:\n- {name: a, end: {held: 0.1}}\n",
            "expected a wall or a periodic box with a servo");
    refused("stages:\n- {name: a, end: {strain: 0.1}}\n",
            "s.yaml:18:27: stages[0].end.strain: expected a motion or load in this stage");
    refused("stages:\n- {name: a, output: {history_rows: 1}, end: {unbalanced: 0.1}}\n",
            "stages[0].end.unbalanced: expected output.history_rows above 1, as it is evaluated");
    refused("stages:\n- {name: a, end: {time: 0.7}}\n- {name: b, end: {time: 0.7}}\n",
            "s.yaml:19:25: stages[1].end.time: expected an end before time.end, 1 s, which ends "
            "the run, found at least 1.4 s");
}

static void accepted(const char *stages) {
    gn_scene scene;
    gneiss_error error = {0};
    char *given = joined(heap, "time: {end: 1 s}\n", stages);
    if (gn_scene_parse(given, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK)
        fail_msg("%s: %s", stages, error.message);
    gn_scene_free(&scene);
}

/* Motion, a load or remaining velocities may cause any end; bodies at rest or separating ones do
 * not. */
static void a_stage_that_never_ends_is_refused(void **state) {
    (void)state;
    const char *nothing = "expected a motion or load in this stage, found none";
    const char *closing = "s.yaml:18:%d: stages[%d].end.strain: expected ends that close";
    char parting[128];
    refused("stages:\n- {name: a, end: {stress: 1 kPa}, walls: {lid: {motion: {vz: 0}}}}\n",
            nothing);
    refused("stages:\n- {name: a, end: {stress: 1 kPa}, sets: {top: {force: [0, 0, 0]}}}\n",
            nothing);
    accepted("stages:\n- {name: a, end: {stress: 1 kPa}, sets: {top: {force: [0, 0, -1]}}}\n");
    accepted("membrane: {pressure: 1 kPa}\nstages:\n- {name: a, end: {stress: 1 kPa}}\n");
    /* Without a servo another condition has to end the stage; a membrane may be without
     * pressure. */
    refused("stages:\n- {name: a, end: {held: 1 %}}\n- {name: b}\n",
            "s.yaml:18:25: stages[0].end.held: expected a wall or a periodic box with a servo");
    accepted("stages:\n- {name: a, end: {held: 1 %, time: 1 ms}}\n- {name: b}\n");
    accepted("stages:\n- {name: a, membrane: {pressure: 0}, end: {held: 1 %}}\n- {name: b}\n");
    refused("membrane: {pressure: 0}\nstages:\n- {name: a, end: {stress: 1 kPa}}\n", nothing);
    accepted("stages:\n- {name: a, end: {stress: 1 kPa}, walls: {lid: {motion: {vz: [[0, 0], [1, "
             "-1]]}}}}\n");
    /* Held at its position, with the forces that the previous stage has left in it. */
    accepted("stages:\n- {name: a, walls: {lid: {motion: {vz: -1}}}, end: {strain: 1 %}}\n"
             "- {name: b, walls: {lid: {motion: {vz: 0}}}, end: {stress: 1 kPa}}\n");

    refused("stages:\n- {name: a, end: {unbalanced: 0.01}}\n", nothing);
    accepted("stages:\n- {name: a, end: {unbalanced: 0.01, time: 1 ms}}\n");
    refused("stages:\n- {name: a, end: {stress: 1 kPa}, walls: {lid: {motion: {vz: 1}}}}\n",
            "stages[0].end.stress: expected ends that close in this stage, found none");
    accepted("stages:\n- {name: a, gravity: [0, 0, -9], end: {stress: 1 kPa}, walls: {lid: "
             "{motion: {vz: 1}}}}\n");

    /* A table whose last value is 0 has ended if its stage was long enough. */
    snprintf(parting, sizeof parting,
             "s.yaml:19:27: stages[1].end.strain: expected ends that close");
    refused("stages:\n- {name: a, end: {time: 1 ms}, walls: {lid: {motion: {vz: [[0, -1], [1 ms, "
            "0]]}}}}\n- {name: b, end: {strain: 0.1}}\n",
            parting);
    accepted("stages:\n- {name: a, end: {time: 0.9 ms}, walls: {lid: {motion: {vz: [[0, -1], [1 "
             "ms, 0]]}}}}\n- {name: b, end: {strain: 0.1}}\n");
    accepted("stages:\n- {name: a, end: {time: 1 ms, unbalanced: 0.1}, walls: {lid: {motion: {vz: "
             "[[0, -1], [1 ms, 0]]}}}}\n- {name: b, end: {strain: 0.1}}\n");

    snprintf(parting, sizeof parting, closing, 27, 0);
    refused("stages:\n- {name: a, end: {strain: 0.1}, walls: {lid: {motion: {vz: 1}}}}\n", parting);
    refused("stages:\n- {name: a, end: {strain: 0.1}, walls: {west: {motion: {vx: 1}}}}\n",
            parting);
    refused(
        "stages:\n- {name: a, end: {strain: 0.1}, walls: {lid: {motion: {vz: [[0, 0], [1, 2]]}}, "
        "floor: {motion: {vz: [[0, 0], [1, -2]]}}}}\n",
        parting);
    accepted("stages:\n- {name: a, end: {strain: 0.1}, walls: {lid: {motion: {vz: 1}}, floor: "
             "{motion: {vz: 2}}}}\n");
    accepted("stages:\n- {name: a, end: {strain: 0.1}, walls: {lid: {motion: {vz: [[0, 1], [1, "
             "-1]]}}}}\n");
    accepted(
        "stages:\n- {name: a, end: {strain: 0.1}, walls: {lid: {servo: {force: 1, max_velocity: "
        "1}}}}\n");
    accepted("stages:\n- {name: a, end: {strain: 0.1, time: 1 ms}, walls: {lid: {motion: {vz: "
             "1}}}}\n");
}

static void steps_that_outlast_the_run_are_refused(void **state) {
    (void)state;
    refused("stages:\n- {name: a, time: {step: 1 us}, end: {steps: 1000001}}\n",
            "s.yaml:18:46: stages[0].end.steps: expected an end before time.end, 1 s, which ends "
            "the run, found 1.000001 s (steps of time.step, 1e-06 s): the stage would never end");
    refused("stages:\n- {name: a, end: {steps: 10}}\n"
            "- {name: b, time: {step: 1 us}, end: {steps: 100000000000000}}\n",
            "s.yaml:19:46: stages[1].end.steps: expected an end before time.end");
    accepted("stages:\n- {name: a, time: {step: 1 us}, end: {steps: 1000000}}\n");
    accepted("stages:\n- {name: a, time: {step: 1 us}, end: {steps: 1000001, time: 0.1}}\n");
    accepted("stages:\n- {name: a, end: {steps: 100000000000000}}\n"); /* the steps are too many for
                                                                          an integer step number */
}

int main(int argc, char **argv) {
    (void)argv;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_stage_has_the_bits_of_none),
        cmocka_unit_test(gravity_is_that_of_the_stage),
        cmocka_unit_test(a_short_stage_takes_a_step),
        cmocka_unit_test(tables_count_from_the_stage_that_gives_them),
        cmocka_unit_test(a_stage_of_no_steps_changes_what_comes_after_it),
        cmocka_unit_test(fifty_stages_are_gone_through),
        cmocka_unit_test(the_ledger_closes_over_all_changes),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(bonds_begin_without_force_where_they_form),
        cmocka_unit_test(a_change_of_stiffness_books_all_that_appears),
        cmocka_unit_test(walls_and_bodies_follow_materials_that_change),
        cmocka_unit_test(dissolving_a_bond_is_no_friction),
        cmocka_unit_test(bonds_may_form_under_their_force),
        cmocka_unit_test(bonds_form_beside_bonds),
        cmocka_unit_test(a_specimen_is_settled_bonded_confined_and_loaded),
        cmocka_unit_test(a_resumed_run_has_the_same_bits),
        cmocka_unit_test(a_membrane_of_stages_has_the_same_bits),
        cmocka_unit_test(materials_of_walls_and_bodies_have_the_same_bits),
        cmocka_unit_test(damaged_bonds_of_several_stages_have_the_same_bits),
        cmocka_unit_test(new_bonds_do_not_change_damaged_ones),
        cmocka_unit_test(a_fracture_energy_of_the_body_holds_for_bonds_of_a_later_stage),
        cmocka_unit_test(a_settled_heap_goes_on),
        cmocka_unit_test(readings_are_found_once_for_a_state),
        cmocka_unit_test(a_run_stopped_by_time_end_names_the_unfinished_stage),
        cmocka_unit_test(bodies_and_elements_take_their_part),
        cmocka_unit_test(a_run_begins_where_another_ended),
        cmocka_unit_test(free_overlaps_go_over_into_another_run),
        cmocka_unit_test(overlaps_of_a_packing_wait_for_their_bonds),
        cmocka_unit_test(a_written_scene_has_the_same_stages),
        cmocka_unit_test(overrides_reach_into_stages),
        cmocka_unit_test(the_last_stage_decides_between_force_and_stress),
        cmocka_unit_test(wrong_stages_are_refused_at_their_line),
        cmocka_unit_test(a_stage_that_never_ends_is_refused),
        cmocka_unit_test(steps_that_outlast_the_run_are_refused),
    };
    const struct CMUnitTest long_tests[] = {
        cmocka_unit_test(the_scene_of_stages_goes_through_all_of_them),
    };
    return run_part(argc, tests, long_tests);
}
