/* Numbers that are not finite never become a result: every writer refuses them, names them, and
 * ends the run as failed. */
#include "io_helpers.h"
#include "world_helpers.h"

#include "io/h5.h"
#include "io/io.h"
#include "run/run.h"

#include <sys/stat.h>

static const char scene_text[] =
    "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e4, kratio: 2}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
    "run: {threads: 1}\ntime: {step: 1e-6, end: 1e-5}\noutput: {history_rows: 10}\n";

static int folder(void **state) {
    return make_fixture(state, "results.h5");
}

static void start(const fixture *f, gn_run *run) {
    gn_scene scene;
    ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, error));
    ok(gn_run_start(&scene, f->dir, false, run, error));
}

static bool has(const fixture *f, const char *name) {
    char path[200];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", f->dir, name);
    return stat(path, &info) == 0;
}

static void a_row_of_the_history_that_is_not_finite_stops_the_run(void **state) {
    gn_run run;
    gneiss_error found = {0};
    start(*state, &run);
    ok(gn_run_steps(&run, 1, error));
    run.world.ledger.energy.work_applied = NAN;
    assert_int_equal(gn_run_steps(&run, 1, &found), GNEISS_ERROR_UNSTABLE);
    assert_non_null(strstr(found.message, "step 1,"));
    assert_non_null(strstr(found.message, "history column energy_work_applied"));
    assert_int_equal(run.history.row_count, 1);
    gn_run_free(&run);
}

static void a_state_that_is_not_finite_is_no_result(void **state) {
    const fixture *f = *state;
    gn_run run;
    gneiss_error found = {0};
    start(f, &run);
    ok(gn_run_steps(&run, 2, error));
    run.world.dem.particles.start[0] = INFINITY;
    assert_int_equal(gn_run_finish(&run, &found), GNEISS_ERROR_UNSTABLE);
    assert_non_null(strstr(found.message, "displacement"));
    assert_false(has(f, "results.h5") || has(f, "summary.json"));
    gn_run_free(&run);
}

/* The failed state is stored as it is, and marked as not finished. */
static void a_failed_run_is_written_with_whatever_it_holds(void **state) {
    const fixture *f = *state;
    gn_run run;
    int64_t finished = 1;
    double displacement[3] = {0};
    start(f, &run);
    ok(gn_run_steps(&run, 2, error));
    run.world.dem.particles.start[0] = INFINITY;
    ok(gn_run_write_failure(&run, "it went bad", error));
    assert_false(has(f, "summary.json"));
    gn_h5 *file = NULL;
    ok(gn_h5_open(f->path, &file, error));
    ok(gn_h5_get_attribute_i64(file, "/", "finished", &finished, 1, error));
    ok(gn_h5_get(file, "particles/displacement", GN_F64, 1, 3, 0, displacement, error));
    gn_h5_close(file);
    assert_int_equal(finished, 0);
    assert_true(isinf(displacement[0]));
    gn_run_free(&run);
}

static void a_checkpoint_holds_finite_numbers(void **state) {
    const fixture *f = *state;
    gn_run run;
    gneiss_error found = {0};
    start(f, &run);
    ok(gn_run_steps(&run, 2, error));
    ok(gn_checkpoint_write(&run, f->path, error));
    run.world.dem.particles.ref[1] = NAN;
    assert_int_equal(gn_checkpoint_write(&run, f->path, &found), GNEISS_ERROR_UNSTABLE);
    assert_non_null(strstr(found.message, "particles/ref"));
    run.world.dem.particles.ref[1] = 0.0;
    run.world.ledger.energy.friction = NAN;
    assert_int_equal(gn_checkpoint_write(&run, f->path, &found), GNEISS_ERROR_UNSTABLE);
    assert_non_null(strstr(found.message, "world_ledger_energy"));
    gn_run_free(&run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_row_of_the_history_that_is_not_finite_stops_the_run,
                                        folder, teardown),
        cmocka_unit_test_setup_teardown(a_state_that_is_not_finite_is_no_result, folder, teardown),
        cmocka_unit_test_setup_teardown(a_failed_run_is_written_with_whatever_it_holds, folder,
                                        teardown),
        cmocka_unit_test_setup_teardown(a_checkpoint_holds_finite_numbers, folder, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
