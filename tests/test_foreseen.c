/* What is foretold of the step of a body whose elements convert, before it has made one. */
#include "conversion_helpers.h"

/* A bar that is drawn at its ends, of which only the middle may convert; E = M, nu = 0. */
static block bar(const char *couple, const char *time) {
    return (block){.cells = {30, 8, 0},
                   .box = "{min: [15 mm, -1], max: [45 mm, 1]}",
                   .convert = "stress: 1e6, every: 10",
                   .couple = couple,
                   .time = time,
                   .elements = ", motions: [{name: left, box: {min: [-1, -1], max: [1e-6, 1]}, "
                               "motion: {vx: 0, vy: 0}}, {name: right, box: {min: [0.059999, -1], "
                               "max: [1, 1]}, motion: {vx: 2 mm/s, vy: 0}}]"};
}

static gn_foreseen foreseen_of(gn_world *w) {
    gn_foreseen f;
    gneiss_error error = {0};
    if (gn_conversion_foresee(w, &f, &error) != GNEISS_OK) fail_msg("%s", error.message);
    return f;
}

static void try_it(gn_world *w, gn_foreseen *f) {
    gneiss_error error = {0};
    if (gn_conversion_try(w, f, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

/* sigma = E v t/l. */
static void the_time_is_that_of_a_bar_at_rest(void **state) {
    (void)state;
    const block s = bar("", "");
    gn_world *w = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    assert_near(f.time, 1e6 / modulus * 60e-3 / 2e-3, 0.011 * f.time);
    gn_foreseen_free(&f);
    world_end(w);
}

static void foreseeing_leaves_a_world_as_it_was(void **state) {
    (void)state;
    const block s = bar("", "");
    gn_world *w = block_of(&s), *other = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    gn_foreseen_free(&f);
    assert_true(gn_world_hash(w) == gn_world_hash(other));
    run_steps(w, 200);
    run_steps(other, 200);
    assert_true(gn_world_hash(w) == gn_world_hash(other));
    world_end(w);
    world_end(other);
}

static void what_nothing_loads_never_converts(void **state) {
    (void)state;
    gn_world *w = block_of(&plate);
    gn_foreseen f = foreseen_of(w);
    assert_true(f.time == INFINITY);
    assert_null(f.place);
    world_end(w);
}

/* --- the step --- */

/* Bent at three points, its ends not ready; of the mesh or finer. */
static block beam(bool space, int finer, const char *couple) {
    return (block){
        .cells = {30, 8, space ? 2 : 0},
        .space = space,
        .finer = finer,
        .box = space ? "{min: [13 mm, -1, -1], max: [47 mm, 1, 1]}"
                     : "{min: [13 mm, -1], max: [47 mm, 1]}",
        .convert = "stress: 1e6, every: 10",
        .couple = couple,
        .elements =
            space ? ", motions: [{name: a, box: {min: [3.9 mm, -1, -1], max: [4.1 mm, 1e-6, 1]}, "
                    "motion: {vx: 0, vy: 0, vz: 0}}, {name: b, box: {min: [55.9 mm, -1, -1], max: "
                    "[56.1 mm, 1e-6, 1]}, motion: {vy: 0}}, {name: c, box: {min: [29.9 mm, 15.999 "
                    "mm, -1], max: [30.1 mm, 1, 1]}, motion: {vy: [[0, 0], [0.1 ms, -5 mm/s]]}}]"
                  : ", motions: [{name: a, box: {min: [3.9 mm, -1], max: [4.1 mm, 1e-6]}, motion: "
                    "{vx: 0, vy: 0}}, {name: b, box: {min: [55.9 mm, -1], max: [56.1 mm, 1e-6]}, "
                    "motion: {vy: 0}}, {name: c, box: {min: [29.9 mm, 15.999 mm], max: [30.1 mm, "
                    "1]}, "
                    "motion: {vy: [[0, 0], [0.1 ms, -5 mm/s]]}}]",
        .rest = "damping: {background: {model: viscous, coefficient: 5e3}}\nrun: {threads: 1}\n"};
}

/* Below the limit to the end: where it would be is known all the same. */
static void what_stays_below_its_limit_is_said_to(void **state) {
    (void)state;
    block s = beam(false, 1, "");
    s.convert = "stress: 1e15, every: 10";
    gn_world *w = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    assert_true(f.time == INFINITY);
    try_it(w, &f);
    assert_string_equal(f.halt, "");
    assert_true(f.first.elements < 480 && f.first.dt > 0.0);
    gn_foreseen_free(&f);
    world_end(w);
}

/* Runs to the first conversion. */
static void run_to_first(gn_world *w) {
    for (int k = 0; k < 20000 && !gn_conversion_begun(w); k++) run_steps(w, 1);
    assert_true(gn_conversion_begun(w));
}

/* The step of the first conversion and that of the run some time later, beside what was foretold.
 */
static void assert_foreseen(const block *s) {
    gn_world *w = block_of(s), *run = block_of(s);
    gn_foreseen f = foreseen_of(w);
    try_it(w, &f);
    assert_string_equal(f.halt, "");
    run_to_first(run);
    assert_near(f.time, run->time, 0.2 * f.time);
    assert_near(f.first.dt, run->dt, 0.2 * f.first.dt);
    run_steps(run, 300);
    assert_near(f.grown.dt, run->dt, 0.2 * f.grown.dt);
    gn_foreseen_free(&f);
    world_end(w);
    world_end(run);
}

static void the_step_of_a_run_is_the_one_foretold(void **state) {
    (void)state;
    const block flat = beam(false, 1, ""), fine = beam(false, 2, ""), space = beam(true, 1, "");
    assert_foreseen(&flat);
    assert_foreseen(&fine);
    assert_foreseen(&space);
}

static void the_step_of_slaved_spins_is_the_one_foretold(void **state) {
    (void)state;
    const block flat = beam(false, 1, ", spins: slaved"), fine = beam(false, 2, ", spins: slaved"),
                space = beam(true, 1, ", spins: slaved");
    assert_foreseen(&flat);
    assert_foreseen(&fine);
    assert_foreseen(&space);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_time_is_that_of_a_bar_at_rest),
        cmocka_unit_test(foreseeing_leaves_a_world_as_it_was),
        cmocka_unit_test(what_nothing_loads_never_converts),
        cmocka_unit_test(what_stays_below_its_limit_is_said_to),
        cmocka_unit_test(the_step_of_a_run_is_the_one_foretold),
        cmocka_unit_test(the_step_of_slaved_spins_is_the_one_foretold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
