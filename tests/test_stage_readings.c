/* Readings of one stage of a run do not depend on earlier stages. */
#include "world_helpers.h"

#include "run/run.h"
#include "run/stages.h"

static gn_run *run_of(const char *scene_text) {
    gn_run *run = calloc(1, sizeof *run);
    gneiss_error error = {0};
    gn_scene scene;
    if (gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error) != GNEISS_OK ||
        gn_run_create(&scene, run, &error) != GNEISS_OK ||
        gn_run_steps(run, 61, &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    return run;
}

static void run_end(gn_run *run) {
    gn_run_free(run);
    free(run);
}

/* A row for every step: 20 of a stage, 40 of the next; the readings of the second depend on its
 * rows only. */
static const char block[] =
    "specimen: {lattice: {kind: cubic, radius: 1 mm, cells: [4, 4, 4]}}\n"
    "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 0.5, friction: 0.3, "
    "bond_tension_limit: 100, bond_shear_limit: 100}]\n"
    "law: {stiffness: uniform}\nbonds: {}\n"
    "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
    "sets:\n- {name: low, select: {end: {axis: z, side: lower, depth: 1 mm}}, motion: {vx: 0, vz: "
    "0}}\n"
    "- {name: top, select: {end: {axis: z, side: upper, depth: 1 mm}}, motion: {vx: 0, vz: 0}}\n"
    "time: {step: 1 us, end: 1 s}\nrun: {threads: 1}\noutput: {history_rows: 1000000}\n"
    "stages: [{name: before, end: {steps: 20}}, {name: load, end: {steps: 40}}, {name: after}]\n";

static const char *const tests[] = {
    "membrane: {pressure: 1 kPa}\n"
    "test: {kind: triaxial, axis: z, lower: low, upper: top, length: 8 mm, area: 64 mm2}\n",
    "test: {kind: shear, axis: x, normal: z, lower: low, upper: top, length: 8 mm, area: 64 mm2}\n",
    "test: {kind: bending, axis: z, lower: low, upper: top, span: 8 mm, "
    "opening: {axis: x, lower: low, upper: top}}\n",
};

/* Rows as in a test: the stress rises and falls, all other columns grow, bonds break from the 11th
 * row of the stage on, in addition to as many before. */
static void write_rows(gn_run *run, double before) {
    const size_t first = (size_t)run->world.stages.state[1].row,
                 last = (size_t)run->world.stages.state[2].row;
    assert_int_equal(last - first, 40);
    for (size_t c = 0; c < run->history.column_count; c++) {
        gn_column *column = &run->history.columns[c];
        bool bonds = strncmp(column->name, "broken_", 7) == 0,
             stress = strncmp(column->name, "stress", 6) == 0,
             ways = strstr(column->name, "strain") || strcmp(column->name, "dilation") == 0 ||
                    strcmp(column->name, "deflection") == 0 || strcmp(column->name, "opening") == 0;
        for (size_t r = first; r < last; r++) {
            double k = (double)(r - first), slope = 1.0 + 0.01 * (double)(c % 7);
            if (bonds) column->value[r] = 1000.0 * before + 10.0 * fmax(0.0, k - 10.0);
            if (stress) column->value[r] = slope * 1e6 * (k < 30 ? k : 60.0 - k);
            if (ways) column->value[r] = before * (double)(c + 1) + 1e-3 * slope * k;
        }
    }
}

static void displacements_count_from_the_start_of_the_stage(void **state) {
    (void)state;
    gneiss_error error = {0};
    for (size_t k = 0; k < sizeof tests / sizeof *tests; k++) {
        char scene[4096];
        snprintf(scene, sizeof scene, "%s%s", block, tests[k]);
        gn_run *run = run_of(scene);
        gn_readings found[2];
        for (int before = 0; before < 2; before++) {
            write_rows(run, before);
            assert_int_equal(gn_run_stage_readings(run, 1, &found[before], &error), GNEISS_OK);
        }
        const double *one = &found[0].young_modulus, *other = &found[1].young_modulus;
        size_t there = 0;
        for (int r = 0; r < GN_READING_COUNT; r++) {
            assert_string_equal(found[0].reason[r], found[1].reason[r]);
            if (isnan(one[r]) && isnan(other[r])) continue;
            there++;
            assert_near(other[r], one[r], 1e-9 * fabs(one[r])); /* roundings of 1e-3 beside 50 */
        }
        assert_true(there >= 6);
        run_end(run);
    }
}

int main(void) {
    const struct CMUnitTest all[] = {
        cmocka_unit_test(displacements_count_from_the_start_of_the_stage),
    };
    return cmocka_run_group_tests(all, NULL, NULL);
}
