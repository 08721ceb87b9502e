/* Numbers of particles that sources bring and sinks remove, for any steps at which they act. */
#include "inflow/removal.h"
#include "inflow/sources.h"
#include "surface_helpers.h"

#include "run/run.h"

#include <unistd.h>

#define SOFT                                                                                       \
    "materials: [{name: m, density: 2500, contact_modulus: 1 MPa, kratio: 2}]\n"                   \
    "law: {stiffness: arithmetic}\n"

static void run_of(const char *scene_text, gn_run *run) {
    gn_scene scene;
    gneiss_error error = {0};
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, run, &error), &error);
}

static bool warns(const gn_run *run, const char *name, const char *words) {
    gn_warnings list;
    gneiss_error error = {0};
    assert_ok(gn_run_warnings(run, &list, &error), &error);
    for (size_t k = 0; k < list.count; k++)
        if (strcmp(list.warning[k].name, name) == 0) {
            if (!strstr(list.warning[k].text, words)) fail_msg("%s", list.warning[k].text);
            return true;
        }
    return false;
}

/* --- sources --- */

/* A source that is active from 0 to its end supplies rate times end, which falls between two
 * rebuilds. */
static void a_source_brings_its_rate_times_its_end(void **state) {
    (void)state;
    const double one = 2500 * 4.0 / 3.0 * pi * pow(0.6e-3, 3);
    static const struct {
        int dimension;
        const char *fed;
        double end, number, mass;
    } cases[] = {{3, "rate: 1e4, end: 5 ms", 20e-3, 50, 0},
                 {3, "rate: 1e5, end: 1 ms, velocity: [0, 0, -1]", 20e-3, 100, 0},
                 {3, "mass_rate: 0.02, end: 5 ms", 20e-3, 0, 1e-4},
                 {2, "rate: 1e4, start: 2 ms, end: 7 ms, velocity: [0, -0.1]", 20e-3, 50, 0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        gn_run run;
        text *t = calloc(1, sizeof *t);
        const bool space = cases[k].dimension == 3;
        add(t,
            "dimension: %d\n" SOFT "%ssources: [{name: s, %s, mean_radius: 0.6 mm, %s}]\n"
            "domain: {min: [-1, -1%s], max: [2, 2%s]}\ntime: {end: %g}\nrun: {threads: 1}\n",
            cases[k].dimension,
            space ? "" : "specimen: {particles: [[0.5, 0.5, 1e-3]], group: 0}\n",
            space ? "box: {size: [60 mm, 60 mm, 60 mm]}"
                  : "rectangle: {width: 60 mm, height: 60 mm}",
            cases[k].fed, space ? ", -1" : "", space ? ", 2" : "", cases[k].end);
        run_of(t->s, &run);
        while (run.world.ctx.time < cases[k].end) run_steps(&run.world, 1);
        const gn_source_state *s = &run.world.dem.flow.sources[0];
        if (cases[k].mass > 0.0)
            assert_near(s->mass, cases[k].mass, 1.01 * one);
        else
            assert_near(s->number, cases[k].number, 0.0);
        assert_true(!warns(&run, "source_behind", ""));
        gn_run_free(&run);
        free(t);
    }
}

/* 300 particles are due in 40 steps, without a check in between: a warning gives the number that
 * entered. */
static void a_run_too_short_for_its_source_says_so(void **state) {
    (void)state;
    gn_run run;
    run_of("dimension: 3\n" SOFT
           "sources: [{name: s, box: {size: [60 mm, 60 mm, 60 mm]}, rate: 3e6, mean_radius: 0.6 "
           "mm}]\n"
           "domain: {min: [-1, -1, -1], max: [2, 2, 2]}\ntime: {end: 100 us, step: 2.5 us}\n"
           "run: {threads: 1}\n",
           &run);
    assert_near(gn_flow_late(&run.world.ctx, &run.world.dem, 0), 300, 1e-6);
    run_steps(&run.world, 40);
    assert_true(warns(&run, "source_behind", "up to 50 steps late"));
    gn_run_free(&run);
}

/* A source that stops before the end of the run needs no other end, and supplies at most its total.
 * */
static void a_late_source_is_described_as_it_is_given(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        gn_run run;
        gn_warnings list;
        gneiss_error error = {0};
        text *t = calloc(1, sizeof *t);
        add(t,
            "dimension: 3\n" SOFT
            "sources: [{name: s, box: {size: [60 mm, 60 mm, 60 mm]}, rate: 3e6, mean_radius: 0.6 "
            "mm, %s}]\ndomain: {min: [-1, -1, -1], max: [2, 2, 2]}\n"
            "time: {end: 100 us, step: 2.5 us}\nrun: {threads: 1}\n",
            k ? "total: 100" : "end: 90 us");
        run_of(t->s, &run);
        if (k) assert_near(gn_flow_late(&run.world.ctx, &run.world.dem, 0), 100, 1e-9);
        if (k) assert_near(gn_flow_expected(&run.world.ctx, &run.world.dem, 0), 100, 1e-9);
        run_steps(&run.world, 40);
        assert_true(warns(&run, "source_behind", "a longer run"));
        assert_ok(gn_run_warnings(&run, &list, &error), &error);
        for (size_t n = 0; n < list.count; n++)
            if (strcmp(list.warning[n].name, "source_behind") == 0)
                assert_true(!strstr(list.warning[n].text, "an end of the source") == !k);
        gn_run_free(&run);
        free(t);
    }
}

/* --- sinks --- */

enum { GRAINS = 12 };

/* Grains of 2 mm in a row, each 0.37 mm higher than the previous one, fly down. */
static void add_grains(text *t, int dimension, double speed) {
    add(t, "dimension: %d\n" SOFT "specimen: {group: 0, particles: [", dimension);
    for (int k = 0; k < GRAINS; k++)
        add(t, "%s[%g, %s%g, 1e-3]", k ? ", " : "", 4e-3 * k, dimension == 3 ? "0, " : "",
            5e-3 + 0.37e-3 * k);
    add(t,
        "]}\nsets: [{name: s, select: {all: true}, initial_velocity: [0, %s%g]}]\n"
        "domain: {min: [-1, -1%s], max: [1, 1%s]}\ntime: {end: 20 ms}\nrun: {threads: 1}\n",
        dimension == 3 ? "0, " : "", -speed, dimension == 3 ? ", -1" : "",
        dimension == 3 ? ", 1" : "");
}

/* Every grain is entirely inside for some steps, fewer than the lists are valid for. */
static void a_thin_sink_takes_all_that_pass(void **state) {
    (void)state;
    static const char *const sinks[][2] = {
        {"box: {size: [0.1, 0.04, 2.5 mm]}, origin: [-0.02, -0.02, 0]",
         "rectangle: {width: 0.1, height: 2.5 mm}, origin: [-0.02, 0]"},
        {"box: {size: [0.1, 0.04, 2.02 mm]}, origin: [-0.02, -0.02, 0]",
         "polygon: [[-0.02, -0.1 mm], [0.08, 0], [0.08, 2.3 mm], [-0.02, 2.2 mm]]"}};
    for (int dimension = 2; dimension <= 3; dimension++)
        for (int k = 0; k < 2; k++) {
            gn_run run;
            text *t = calloc(1, sizeof *t);
            add_grains(t, dimension, 1.0);
            add(t, "sinks: [{name: k, %s}]\n", sinks[k][dimension == 2]);
            run_of(t->s, &run);
            while (run.world.ctx.time < 20e-3) run_steps(&run.world, 1);
            assert_near(run.world.dem.flow.sinks[0].number, GRAINS, 0.0);
            assert_true(!warns(&run, "sink_too_thin", ""));
            gn_run_free(&run);
            free(t);
        }
}

/* Every grain is entirely inside for less than a step, or for an instant only. */
static void a_sink_as_thick_as_a_grain_takes_all_that_pass(void **state) {
    (void)state;
    static const struct {
        const char *thickness, *below;
        double speed;
    } cases[] = {{"2 mm", "0", 1.0},       {"2 mm", "0.3 mm", 1.0}, {"2.0005 mm", "0", 1.0},
                 {"2 mm", "-0.1 mm", 7.0}, {"2.01 mm", "0", 20.0},  {"2.01 mm", "0.7 mm", 20.0}};
    for (int dimension = 2; dimension <= 3; dimension++)
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
            gn_run run;
            text *t = calloc(1, sizeof *t);
            const bool space = dimension == 3;
            add_grains(t, dimension, cases[k].speed);
            add(t, "sinks: [{name: k, %s%s%s, origin: [-0.02, %s%s]}]\n",
                space ? "box: {size: [0.1, 0.04, " : "rectangle: {width: 0.1, height: ",
                cases[k].thickness, space ? "]}" : "}", space ? "-0.02, " : "", cases[k].below);
            run_of(t->s, &run);
            while (run.world.ctx.time < 20e-3) run_steps(&run.world, 1);
            assert_near(run.world.dem.flow.sinks[0].number, GRAINS, 0.0);
            assert_true(!warns(&run, "sink_too_thin", ""));
            gn_run_free(&run);
            free(t);
        }
}

static void a_sink_that_no_grain_fits_in_causes_a_warning(void **state) {
    (void)state;
    for (int wide = 0; wide < 2; wide++) {
        gn_run run;
        text *t = calloc(1, sizeof *t);
        char said[GNEISS_MESSAGE_SIZE];
        add_grains(t, 3, 1.0);
        add(t, "sinks: [{name: k, box: {size: [0.1, 0.04, %s]}, origin: [-0.02, -0.02, 0]}]\n",
            wide ? "2.1 mm" : "1.5 mm");
        run_of(t->s, &run);
        assert_true(gn_sink_is_too_thin(&run.world.ctx, &run.world.dem, 0, said, sizeof said) ==
                    !wide);
        run_steps(&run.world, 10);
        assert_true(warns(&run, "sink_too_thin", "thinner than any particle") == !wide);
        gn_run_free(&run);
        free(t);
    }
}

/* --- rows --- */

static double last_of(const gn_run *run, const char *column) {
    return gn_history_column(&run->history, column)[run->history.row_count - 1];
}

/* The number of steps is not a multiple of the row interval: the last step has a row all the same,
 * which a run continued from there does not keep. */
static void the_last_step_of_a_run_that_flows_has_a_row(void **state) {
    (void)state;
    const gn_override given[2][2] = {{{"time.step", "10 us"}, {"time.end", "10.03 ms"}},
                                     {{"time.step", "10 us"}, {"time.end", "20 ms"}}};
    gn_run run[2];
    gneiss_error error = {0};
    char path[] = "/tmp/flow_counts_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    for (int k = 0; k < 2; k++) {
        text *t = calloc(1, sizeof *t);
        add_grains(t, 3, 1.0);
        add(t, "output: {history_rows: 7, snapshots: 0}\n"
               "sinks: [{name: k, plane: {point: [0, 0, -1 mm], normal: [0, 0, -1]}}]\n");
        gn_scene scene;
        assert_ok(gn_scene_parse(t->s, "s.yaml", NULL, given[k], 2, &scene, &error), &error);
        assert_ok(gn_run_create(&scene, &run[k], &error), &error);
        while (!run[k].finished) assert_ok(gn_run_advance(&run[k], 10.0, NULL, &error), &error);
        assert_near(last_of(&run[k], "time"), run[k].world.ctx.time - 10e-6, 1e-9);
        assert_near(last_of(&run[k], "sink_k_number"), run[k].world.dem.flow.sinks[0].number, 0.0);
        free(t);
    }
    assert_true(run[0].world.dem.flow.sinks[0].number > 0.0);
    assert_ok(gn_checkpoint_write(&run[0], path, &error), &error);
    gn_run_free(&run[0]);
    const gn_override longer = {"time.end", "15 ms"};
    assert_ok(gn_run_load(path, &longer, 1, &run[0], &error), &error);
    const double ended = last_of(&run[0], "step");
    while (!run[0].finished) assert_ok(gn_run_advance(&run[0], 10.0, NULL, &error), &error);
    const double *step = gn_history_column(&run[0].history, "step");
    for (size_t row = 0; row < run[0].history.row_count; row++) assert_true(step[row] != ended);
    for (int k = 0; k < 2; k++) gn_run_free(&run[k]);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_source_brings_its_rate_times_its_end),
        cmocka_unit_test(a_run_too_short_for_its_source_says_so),
        cmocka_unit_test(a_late_source_is_described_as_it_is_given),
        cmocka_unit_test(a_thin_sink_takes_all_that_pass),
        cmocka_unit_test(a_sink_as_thick_as_a_grain_takes_all_that_pass),
        cmocka_unit_test(a_sink_that_no_grain_fits_in_causes_a_warning),
        cmocka_unit_test(the_last_step_of_a_run_that_flows_has_a_row),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
