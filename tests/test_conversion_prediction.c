/* Prediction of the step of a body with converting elements, before the first conversion. */
#include "conversion_helpers.h"
#include "solids/element_walls.h"

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
    gneiss_status status = gn_conversion_try(w, f, &error);
    if (status == GNEISS_OK && !*f->halt) status = gn_conversion_try_more(w, f, &error);
    if (status != GNEISS_OK) fail_msg("%s", error.message);
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

/* Held first, then drawn, with another step. */
static const char pulled_later[] =
    "run: {threads: 1}\nstages: [{name: hold, elements: {motions: {right: {motion: {vx: 0}}}}, "
    "end: "
    "{time: 0.1 ms}}, {name: pull, elements: {motions: {right: {motion: {vx: 2 mm/s}}}}, time: "
    "{safety: 0.4}, end: {time: 0.5 s}}, {name: stay, elements: {motions: {right: {motion: {vx: "
    "0}}}}}]";

static void a_limit_is_found_in_the_stage_that_brings_it(void **state) {
    (void)state;
    const double pull = 1e6 / modulus * 60e-3 / 2e-3;
    block s = bar("", "");
    s.rest = pulled_later;
    gn_world *w = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    assert_int_equal(f.stage, 1);
    assert_near(f.time, 0.1e-3 + pull, 0.011 * pull);
    assert_int_equal(f.course.count, 3);
    assert_near(f.course.part[1].begin, 0.1e-3, 1e-15);
    assert_near(f.course.part[1].end, 0.5001, 1e-12);
    assert_near(f.course.part[2].end, 1.0, 1e-12);
    assert_false(f.course.part[0].open || f.course.part[1].open || f.course.part[1].guessed);
    assert_near(f.course.part[0].dt, w->ctx.dt, 0.0);
    assert_near(f.course.part[1].dt, 0.4 / 0.9 * w->ctx.dt, 1e-9 * w->ctx.dt);
    /* Its loads come to 0.5 s of pulling. */
    assert_near(f.reach, 0.5 / pull, 0.01 * f.reach);
    try_it(w, &f);
    assert_string_equal(f.halt, "");
    assert_int_equal(w->stages.now, 2);
    gn_foreseen_free(&f);
    world_end(w);
}

/* Weight that a stage brings at once, on a bar that hangs from its left end: rho g l/E. */
static void loads_are_those_of_the_stage(void **state) {
    (void)state;
    block s = bar("", "");
    s.elements = ", motions: [{name: left, box: {min: [-1, -1], max: [1e-6, 1]}, motion: {vx: 0, "
                 "vy: 0}}]";
    s.convert = "stress: 1e6, every: 10";
    s.rest = "run: {threads: 1}\nstages: [{name: light, gravity: [100, 0], end: {time: 0.25}}, "
             "{name: heavy, gravity: [1e4, 0], end: {time: 0.25}}]";
    gn_world *w = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    assert_int_equal(f.stage, 1);
    assert_near(f.time, 0.25, 1e-9);
    assert_near(f.rise, 0.0, 1e-9); /* at once */
    /* At 16 mm or so, where the box begins. */
    assert_near(f.most * 1e6, density * 1e4 * 44e-3, 0.1 * f.most * 1e6);
    gn_foreseen_free(&f);
    world_end(w);
}

static void a_stage_that_waits_for_rest_is_taken_for_over(void **state) {
    (void)state;
    block s = bar("", "");
    s.rest = "run: {threads: 1}\nstages: [{name: hold, elements: {motions: {right: {motion: {vx: "
             "0}}}}, gravity: [0, -1], end: {unbalanced: 0.01}}, {name: pull, elements: {motions: "
             "{right: {motion: {vx: 2 mm/s}}}}}]";
    gn_world *w = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    const double settled = GN_SETTLING * 60e-3 / sqrt(modulus / density);
    const double pull = 1e6 / modulus * 60e-3 / 2e-3;
    assert_true(f.course.part[0].open && f.course.part[0].guessed);
    assert_near(f.course.part[0].end, settled, 1e-9 * settled);
    assert_int_equal(f.stage, 1);
    assert_near(f.time, settled + pull, 0.02 * pull);
    gn_foreseen_free(&f);
    world_end(w);
}

/* A bar that is held at its ends swings with 2 l/c at the slowest. */
static void waves_are_as_long_as_the_bar_has_them(void **state) {
    (void)state;
    const block s = bar("", "");
    gn_world *w = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    const double period = 2.0 * 60e-3 / sqrt(modulus / density);
    assert_near(f.period, period, 0.1 * period);
    assert_near(f.rise, f.time, 0.06 * f.time); /* it grows evenly */
    assert_near(f.burst, sqrt(modulus * density) * 2e-3 / 1e6, 1e-6 * f.burst);
    gn_foreseen_free(&f);
    world_end(w);
}

/* --- walls --- */

static gn_wall_passed passed_of(const char *walls) {
    char rest[400];
    gn_wall_passed passed[1];
    gneiss_error error = {0};
    block s = bar("", "");
    snprintf(rest, sizeof rest, "run: {threads: 1}\nwalls: [{name: w, stiffness: 1e9, %s}]", walls);
    s.rest = rest;
    gn_world *w = block_of(&s);
    const uint64_t hash = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    if (gn_wall_foresee_passed(w, passed, &error) != GNEISS_OK) fail_msg("%s", error.message);
    assert_true(gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) == hash);
    const gn_wall_passed now = gn_wall_passed_now(&w->ctx, &w->boundary, &w->solids, 0);
    assert_int_equal(now.behind, passed[0].time > 0.0 ? 0 : passed[0].behind);
    world_end(w);
    return passed[0];
}

/* The right end goes 2 mm in the second of the run. */
static void walls_that_elements_pass_are_known_before(void **state) {
    (void)state;
    const gn_wall_passed ahead = passed_of("point: [61 mm, 0], normal: [-1, 0]"),
                         far = passed_of("point: [62.1 mm, 0], normal: [-1, 0]"),
                         coming = passed_of(
                             "point: [64 mm, 0], normal: [-1, 0], motion: {vx: -2.5 mm/s}"),
                         floor = passed_of("point: [0, 0], normal: [0, 1]"),
                         inside = passed_of("point: [0, 1 mm], normal: [0, 1]"),
                         /* with the motion that it presses particles beside */
        platen = passed_of("point: [60 mm, 0], normal: [-1, 0], motion: {vx: 2 mm/s}");
    assert_near(ahead.time, 0.5, 1e-3);
    assert_near(ahead.deepest, 1e-3, 1e-6);
    assert_int_equal(ahead.touching, 0);
    assert_int_equal(far.behind + far.touching, 0);
    assert_near(coming.time, 4.0 / 4.5, 1e-3);
    assert_int_equal(floor.behind, 0);    /* nu = 0: nothing presses it */
    assert_int_equal(floor.touching, 29); /* those at the ends are held */
    assert_int_equal(inside.behind, 31);
    assert_near(inside.time, 0.0, 0.0);
    assert_near(inside.deepest, 1e-3, 1e-6);
    assert_int_equal(platen.behind + platen.touching, 0);
}

static void predicting_conversions_leaves_a_world_unchanged(void **state) {
    (void)state;
    const block s = bar("", "");
    gn_world *w = block_of(&s), *other = block_of(&s);
    gn_foreseen f = foreseen_of(w);
    gn_foreseen_free(&f);
    assert_true(
        gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) ==
        gn_world_hash(&other->ctx, &other->dem, &other->boundary, &other->solids, &other->box));
    run_steps(w, 200);
    run_steps(other, 200);
    assert_true(
        gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) ==
        gn_world_hash(&other->ctx, &other->dem, &other->boundary, &other->solids, &other->box));
    world_end(w);
    world_end(other);
}

static void an_unloaded_body_never_converts(void **state) {
    (void)state;
    gn_world *w = block_of(&plate);
    gn_foreseen f = foreseen_of(w);
    assert_true(f.time == INFINITY);
    assert_null(f.place);
    gn_foreseen_free(&f);
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
static void a_limit_that_is_never_reached_is_reported(void **state) {
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
    for (int k = 0; k < 20000 && !gn_conversion_begun(&w->solids); k++) run_steps(w, 1);
    assert_true(gn_conversion_begun(&w->solids));
}

/* Compares the step after the first conversion and that of the run some time later with the
 * predicted step. */
static void assert_foreseen(const block *s) {
    gn_world *w = block_of(s), *run = block_of(s);
    gn_foreseen f = foreseen_of(w);
    try_it(w, &f);
    assert_string_equal(f.halt, "");
    run_to_first(run);
    assert_near(f.time, run->ctx.time, 0.2 * f.time);
    assert_near(f.first.dt, run->ctx.dt, 0.2 * f.first.dt);
    run_steps(run, 300);
    assert_near(f.grown.dt, run->ctx.dt, 0.1 * f.grown.dt);
    gn_foreseen_free(&f);
    world_end(w);
    world_end(run);
}

static void the_step_of_a_run_is_the_predicted_one(void **state) {
    (void)state;
    const block flat = beam(false, 1, ""), fine = beam(false, 2, ""), space = beam(true, 1, "");
    assert_foreseen(&flat);
    assert_foreseen(&fine);
    assert_foreseen(&space);
}

static void the_step_of_slaved_spins_is_the_predicted_one(void **state) {
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
        cmocka_unit_test(a_limit_is_found_in_the_stage_that_brings_it),
        cmocka_unit_test(loads_are_those_of_the_stage),
        cmocka_unit_test(a_stage_that_waits_for_rest_is_taken_for_over),
        cmocka_unit_test(waves_are_as_long_as_the_bar_has_them),
        cmocka_unit_test(walls_that_elements_pass_are_known_before),
        cmocka_unit_test(predicting_conversions_leaves_a_world_unchanged),
        cmocka_unit_test(an_unloaded_body_never_converts),
        cmocka_unit_test(a_limit_that_is_never_reached_is_reported),
        cmocka_unit_test(the_step_of_a_run_is_the_predicted_one),
        cmocka_unit_test(the_step_of_slaved_spins_is_the_predicted_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
