/* Stages of a body with elements that convert to particles. */
#include "conversion/conversion.h"
#include "couple/front.h"
#include "run_helpers.h"
#include "solids/dormant_places.h"

/* A beam bent at three points, on supports that hold its ends: elements of 2 mm, a lattice of 1 mm,
 * E = M, nu = 0. */
static const char beam[] =
    "dimension: 2\n"
    "specimen: {group: 1, lattice: {kind: square, radius: 0.5 mm, cells: [60, 16]}}\n"
    "materials: [{name: m, density: 9931, normal_stiffness: 24e9, kratio: 1, friction: 0.2, "
    "bond_tension_limit: 1e15, bond_shear_limit: 1e15}]\n"
    "law: {stiffness: uniform}\nbonds: {interaction_range: 0.01}\n"
    "couple: {convert: {box: {min: [13 mm, -1], max: [47 mm, 1]}, width: 6 mm, stress: 1e6, every: "
    "25}%s}\n"
    "elements: {rectangle: {size: [60 mm, 16 mm], cells: [30, 8]}, materials: [{young: 24e9, "
    "poisson: 0, density: 7800}], motions: [{name: a, box: {min: [3.9 mm, -1], max: [4.1 mm, "
    "1e-6]}, motion: {vx: 0, vy: 0}}, {name: b, box: {min: [55.9 mm, -1], max: [56.1 mm, 1e-6]}, "
    "motion: {vy: 0}}, {name: load, box: {min: [29.9 mm, 15.999 mm], max: [30.1 mm, 1]}, motion: "
    "{vy: %s}}]}\n"
    "damping: {background: {model: viscous, coefficient: 5e3}}\n"
    "output: {snapshots: 0, history_rows: 50, checkpoint: off}\nrun: {threads: %d}\n%s\n";

static void finish(gn_run *run) {
    gneiss_error error = {0};
    for (int k = 0; k < 20000 && !run->finished; k++)
        if (gn_run_steps(run, 1, &error) != GNEISS_OK) fail_msg("%s", error.message);
    assert_true(run->finished);
}

static double last_of(const gn_run *run, const char *column) {
    return gn_history_column(&run->history, column)[run->history.row_count - 1];
}

static const char in_stages[] =
    "time: {end: 1 ms, step: 1.5e-7}\n"
    "stages: [{name: rest, end: {time: 0.01 ms}}, {name: load, elements: {motions: {load: {motion: "
    "{vy: [[0, 0], [0.05 ms, -12 mm/s]]}}}}, end: {time: 0.23 ms}}, {name: hold, elements: "
    "{motions: {load: {motion: {vy: -1 mm/s}}}}, end: {time: 0.04 ms}}]";

/* The reference is one stage with the same steps: changes of a stage begin with it. */
static void stages_are_what_tables_are(void **state) {
    (void)state;
    gn_run *staged = run_of(beam, "", "0", 1, in_stages);
    gn_run *whole = run_of(beam, "",
                           "[[0, 0], [0.01 ms, 0], [0.06 ms, -12 mm/s], [0.23999995 ms, -12 "
                           "mm/s], [0.24000005 ms, -1 mm/s]]",
                           1, "time: {end: 0.28 ms, step: 1.5e-7}");
    finish(staged);
    finish(whole);
    assert_true(gn_elements_left_count(&staged->world.solids) < 480);
    assert_int_equal(gn_elements_left_count(&staged->world.solids),
                     gn_elements_left_count(&whole->world.solids));
    const gn_particles *a = &staged->world.dem.particles, *b = &whole->world.dem.particles;
    double most = 0.0, off = 0.0;
    assert_true(fabs((double)staged->world.ctx.step - (double)whole->world.ctx.step) <= 4.0);
    for (size_t p = 0; p < a->soa.count; p++) {
        const size_t q = (size_t)whole->world.dem.index_of_id[a->id[p]];
        for (size_t k = 0; k < 2; k++) {
            most = fmax(most, fabs(a->pos[4 * p + k] - a->start[4 * p + k]));
            off = fmax(off, fabs(a->pos[4 * p + k] - b->pos[4 * q + k]));
        }
    }
    assert_true(most > 1e-6);
    assert_true(off < 0.01 * most); /* stages end at a step, a few wave periods apart */
    assert_near(last_of(staged, "motion_load_displacement_y"),
                last_of(whole, "motion_load_displacement_y"), 3e-9);
    run_end(staged);
    run_end(whole);
}

/* Later stages choose a new step, for the converted particles and for the floor that they have
 * reached. */
static const char free_steps[] =
    "time: {end: 1 ms}\n"
    "walls: [{name: floor, point: [0, 0], normal: [0, 1], stiffness: 1e10, kratio: 2, friction: "
    "0.3}]\n"
    "stages: [{name: rest, gravity: [0, -50], end: {time: 0.01 ms}}, {name: load, gravity: [0, 0], "
    "elements: {motions: {load: {motion: {vy: [[0, 0], [0.05 ms, -12 mm/s]]}}}}, end: {time: 0.23 "
    "ms}}, {name: hold, elements: {motions: {load: {motion: {vy: 0}}}}, damping: {background: "
    "{model: viscous, coefficient: 2e4}}, end: {time: 0.03 ms}}, {name: back, elements: {motions: "
    "{load: {motion: {vy: 6 mm/s}}}}, end: {time: 0.03 ms}}]";

static void finish_alike(const char *couple) {
    gn_run *one = run_of(beam, couple, "0", 1, free_steps),
           *two = run_of(beam, couple, "0", 2, free_steps);
    gneiss_error error = {0};
    while (one->world.stages.now < 2)
        if (gn_run_steps(one, 1, &error) != GNEISS_OK) fail_msg("%s", error.message);
    if (gn_run_steps(one, 50, &error) != GNEISS_OK) fail_msg("%s", error.message);
    const double stable = one->world.ctx.stable;
    gn_run *three = resumed_of(one), *all[] = {one, two, three};
    for (int k = 0; k < 3; k++) {
        finish(all[k]);
        assert_true(gn_elements_left_count(&all[k]->world.solids) < 480);
        assert_true(gn_world_hash(&all[k]->world.ctx, &all[k]->world.dem, &all[k]->world.boundary,
                                  &all[k]->world.solids, &all[k]->world.box) ==
                    gn_world_hash(&one->world.ctx, &one->world.dem, &one->world.boundary,
                                  &one->world.solids, &one->world.box));
        /* Contacts with the floor open and close: 1e-5, and 4e-7 with half the step. */
        assert_true(fabs(gn_energy_residual(&all[k]->world.ledger.reading)) < 1e-4);
        assert_true(all[k]->world.ledger.reading.elastic_wall > 0.0);
        assert_true(fabs(all[k]->world.ledger.energy.stage_change) <
                    1e-12 * gn_energy_scale(&all[k]->world.ledger.reading));
        /* The remaining elements limit the step by their bound, those of zones together with the
         * particles. */
        assert_near(all[k]->world.ctx.stable, stable, 0.1 * stable);
    }
    /* A beam bent down towards the floor, which acts on particles only. */
    gn_warnings reported;
    if (gn_run_warnings(one, &reported, &error) != GNEISS_OK) fail_msg("%s", error.message);
    bool passed = false;
    for (size_t k = 0; k < reported.count; k++)
        passed = passed || (!strcmp(reported.warning[k].name, "elements_pass_walls") &&
                            strstr(reported.warning[k].text, "behind wall 'floor'"));
    assert_true(passed);
    for (int k = 0; k < 3; k++) run_end(all[k]);
}

static void threads_and_resumption_in_a_stage_give_the_same_bits(void **state) {
    (void)state;
    finish_alike(", spins: slaved");
}

/* Damping begins with a stage: dormant particles are saved in the present state of the run, before
 * the first conversion and after it. */
static void effects_that_come_with_a_stage_can_be_resumed(void **state) {
    (void)state;
    char *const undamped = strdup(beam), *const damping = strstr(undamped, "damping:");
    assert_non_null(damping);
    memmove(damping, strchr(damping, '\n') + 1, strlen(strchr(damping, '\n')));
    gneiss_error error = {0};
    gn_run *one = run_of(
        undamped, "", "0", 1,
        "time: {end: 1 ms}\n"
        "stages: [{name: rest, end: {time: 0.01 ms}}, {name: load, damping: {background: {model: "
        "viscous, coefficient: 5e3}}, elements: {motions: {load: {motion: {vy: [[0, 0], [0.05 ms, "
        "-12 mm/s]]}}}}, end: {time: 0.23 ms}}, {name: hold, elements: {motions: {load: {motion: "
        "{vy: 0}}}}, end: {time: 0.03 ms}}]");
    static const size_t stages[] = {1, 2};
    gn_run *resumed[2];
    for (size_t k = 0; k < 2; k++) {
        while (!one->finished && one->world.stages.now < stages[k])
            if (gn_run_steps(one, 1, &error) != GNEISS_OK) fail_msg("%s", error.message);
        assert_false(one->finished);
        if (gn_run_steps(one, 50, &error) != GNEISS_OK) fail_msg("%s", error.message);
        resumed[k] = resumed_of(one);
    }
    finish(one);
    assert_true(gn_elements_left_count(&one->world.solids) < 480);
    assert_true(one->world.ctx.scene.background_coefficient > 0.0);
    for (size_t k = 0; k < 2; k++) {
        finish(resumed[k]);
        assert_true(gn_world_hash(&resumed[k]->world.ctx, &resumed[k]->world.dem,
                                  &resumed[k]->world.boundary, &resumed[k]->world.solids,
                                  &resumed[k]->world.box) ==
                    gn_world_hash(&one->world.ctx, &one->world.dem, &one->world.boundary,
                                  &one->world.solids, &one->world.box));
        run_end(resumed[k]);
    }
    run_end(one);
    free(undamped);
}

static void changes_that_dormant_particles_would_miss_are_refused(void **state) {
    (void)state;
    static const char *const changes[][3] = {
        {"materials: {m: {friction: 0.5}}", "materials", "materials: {m: {f"},
        {"bonds: {enabled: false}", "bonds", "bonds: {e"},
        {"damping: {contact: {fraction: 0.1}}", "damping.contact", "contact: {f"}};
    for (size_t k = 0; k < sizeof changes / sizeof *changes; k++) {
        char stages[400], words[200];
        int line = 1;
        text *t = calloc(1, sizeof *t);
        snprintf(stages, sizeof stages,
                 "time: {end: 1 ms}\nstages: [{name: a, end: {time: 0.1 ms}}, {name: b, %s}]",
                 changes[k][0]);
        add(t, beam, "", "0", 1, stages);
        for (const char *c = t->s; c < strstr(t->s, "stages:"); c++) line += *c == '\n';
        snprintf(words, sizeof words,
                 "s.yaml:%d:%zu: stages[1].%s: expected the value before this stage", line,
                 (size_t)(strstr(stages, changes[k][2]) - strstr(stages, "stages:")) + 1,
                 changes[k][1]);
        gn_scene scene;
        gneiss_error error = {0};
        assert_int_equal(gn_scene_parse(t->s, "s.yaml", NULL, NULL, 0, &scene, &error),
                         GNEISS_ERROR_INPUT);
        if (!strstr(error.message, words)) fail_msg("%s", error.message);
        free(t);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stages_are_what_tables_are),
        cmocka_unit_test(threads_and_resumption_in_a_stage_give_the_same_bits),
        cmocka_unit_test(effects_that_come_with_a_stage_can_be_resumed),
        cmocka_unit_test(changes_that_dormant_particles_would_miss_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
