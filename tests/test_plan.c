/* Errors by cause, and predictions for a test: src/accuracy, src/plan. */
#include "world_helpers.h"

#include "accuracy/accuracy.h"
#include "plan/estimate.h"
#include "plan/propose.h"
#include "run/budget.h"

#include <math.h>

/* --- laws --- */

static gn_slope power(void) {
    return (gn_slope){.form = GN_SLOPE_POWER,
                      .coefficient = -0.02,
                      .coefficient_error = 0.1,
                      .exponent = 1.5,
                      .exponent_error = 0.2,
                      .reference = 0.01};
}

static void every_form_of_a_law_is_evaluated(void **state) {
    (void)state;
    gn_slope s = power();
    assert_near(gn_slope_at(&s, 0.04), -0.02 * 8.0, 1e-15);
    s.form = GN_SLOPE_LINEAR;
    assert_near(gn_slope_at(&s, 0.05), -0.02 * 0.04, 1e-15);
    s.form = GN_SLOPE_EXPONENTIAL;
    assert_near(gn_slope_at(&s, 0.02), -0.02 * exp(-2.0), 1e-15);
    s.form = GN_SLOPE_RATIO;
    assert_near(gn_slope_at(&s, 0.04), 7.0, 1e-13);
    s.form = GN_SLOPE_CONSTANT;
    assert_near(gn_slope_at(&s, 123.0), -0.02, 0.0);
}

/* At the reference the error of a power law is that of its coefficient; away from it the error of
 * the exponent adds to that. */
static void the_error_of_a_power_grows_away_from_its_reference(void **state) {
    (void)state;
    gn_slope s = power();
    assert_near(gn_slope_error_at(&s, 0.01), 0.002, 1e-15);
    assert_near(gn_slope_error_at(&s, 0.04), 0.16 * hypot(0.1, 0.2 * log(4.0)), 1e-15);
}

static void the_study_that_is_compiled_in_has_laws_of_compression_and_tension(void **state) {
    (void)state;
    const char *cases[] = {"compression", "tension"};
    const char *effects[] = {"velocity", "packing", "round-off"};
    for (int c = 0; c < 2; c++)
        for (int e = 0; e < 3; e++)
            assert_non_null(gn_slope_find(cases[c], "strength", effects[e], e > 0));
    assert_null(gn_slope_find("compression", "strength", "moon", false));
    assert_true(gn_slope_base_of("compression", "modulus over uniform strain") > 0.0);
    assert_true(isnan(gn_slope_base_of("compression", "moon")));
}

/* --- causes --- */

static gn_test_groups usual(void) {
    return (gn_test_groups){.study = "compression",
                            .floors = "compression",
                            .speed = 0.01,
                            .safety = 0.9,
                            .particles = 2000,
                            .packings = 1,
                            .across = 10,
                            .step_ratio = 1,
                            .damping = 0.7};
}

static double error_of(gn_test_groups g, const char *reading, const char *cause) {
    gn_error_causes c;
    assert_true(gn_causes_predict(&g, reading, &c));
    const gn_error_cause *found = gn_causes_find(&c, cause);
    return found ? found->error : NAN;
}

static void the_total_is_the_root_of_the_sum_of_squares(void **state) {
    (void)state;
    gn_error_causes c = {0};
    gn_causes_add(&c, "one", 0.03, false);
    gn_causes_add(&c, "two", 0.04, true);
    assert_near(gn_causes_total(&c), 0.05, 1e-16);
}

/* The closed form of three causes: 0.02 and 0.03 of one sense, 0.01 of the other, 0.04 of none. */
static void biases_of_one_sense_add_up(void **state) {
    (void)state;
    gn_error_causes c = {0};
    gn_causes_add(&c, "velocity", 0.02, false);
    gn_causes_add(&c, "mass scaling", 0.03, false);
    gn_causes_add(&c, "step", 0.01, false);
    gn_causes_add(&c, "packing", 0.04, false);
    c.cause[0].bias = 0.02;
    c.cause[1].bias = 0.03;
    c.cause[2].bias = -0.01;
    assert_near(gn_causes_total(&c), hypot(0.05, 0.04), 1e-16);
    assert_near(gn_causes_without_scatter(&c), 0.05, 1e-16);
    /* The uncertainty of the law is half of one cause. */
    c.cause[1].bias = 0.015;
    assert_near(gn_causes_without_scatter(&c), hypot(0.035, sqrt(0.03 * 0.03 - 0.015 * 0.015)),
                1e-16);
}

static void a_bias_has_the_sense_of_its_law(void **state) {
    (void)state;
    gn_test_groups q = usual();
    gn_error_causes c;
    assert_true(gn_causes_predict(&q, "strength", &c));
    const gn_error_cause *velocity = gn_causes_find(&c, "velocity"),
                         *packing = gn_causes_find(&c, "packing");
    assert_near(velocity->bias,
                gn_slope_at(gn_slope_find("compression", "strength", "velocity", false), 0.01),
                1e-16);
    assert_true(velocity->bias > 0 && velocity->bias < velocity->error);
    assert_true(packing->bias == 0);
}

/* The results of the study for its tests are in base.csv. */
static void packings_scatter_as_their_bonds_do(void **state) {
    (void)state;
    gn_test_groups q = usual(), areas = usual(), unknown = usual();
    double law = gn_slope_at(gn_slope_find("tension", "E", "packing", true), 2000);
    q.study = q.floors = areas.study = areas.floors = unknown.study = unknown.floors = "tension";
    areas.bonds = "dempack";
    unknown.bonds = "of a law that was never studied";
    assert_near(error_of(areas, "E", "packing"),
                2 * law * fmax(1, gn_slope_base_of("tension", "scatter over its law: E, dempack")),
                1e-12);
    assert_near(error_of(unknown, "E", "packing"), error_of(q, "E", "packing"), 0.0);
    assert_near(error_of(q, "E", "packing"),
                2 * law * gn_slope_base_of("tension", "scatter over its law: E"), 1e-12);
}

static void four_packings_halve_the_scatter_and_leave_the_bias(void **state) {
    (void)state;
    gn_test_groups one = usual(), four = usual();
    four.packings = 4;
    assert_near(error_of(four, "strength", "packing"), 0.5 * error_of(one, "strength", "packing"),
                1e-15);
    assert_near(error_of(four, "strength", "velocity"), error_of(one, "strength", "velocity"), 0.0);
}

static void slower_loading_and_more_particles_are_better(void **state) {
    (void)state;
    gn_test_groups q = usual(), slow = usual(), many = usual();
    slow.speed = 0.005;
    many.particles = 8000;
    assert_true(error_of(slow, "strength", "velocity") < error_of(q, "strength", "velocity"));
    assert_true(error_of(many, "strength", "packing") < error_of(q, "strength", "packing"));
}

static bool noted(const gn_error_causes *c, const char *words) {
    for (size_t k = 0; k < c->note_count; k++)
        if (strstr(c->note[k], words)) return true;
    return false;
}

static void a_reading_that_does_not_converge_has_no_error_of_size_and_says_so(void **state) {
    (void)state;
    gn_test_groups q = usual();
    gn_error_causes c;
    assert_true(gn_causes_predict(&q, "strength", &c));
    assert_null(gn_causes_find(&c, "size"));
    assert_true(noted(&c, "does not converge"));
}

static void scenes_beyond_the_study_are_reported(void **state) {
    (void)state;
    gn_test_groups q = usual();
    gn_error_causes c;
    q.speed = 0.5;
    assert_true(gn_causes_predict(&q, "strength", &c));
    assert_true(noted(&c, "beyond the range of the study"));
    assert_false(gn_causes_predict(&q, "taste", &c));
}

/* --- predictions --- */

/* A square lattice of discs that touch, bonded along x and y: along y each column of discs is a
 * chain of springs k_n of its own, E = k_n over 1 m of thickness and the spacing 2 r, times 2 r. */
static gn_world *lattice(const char *more) {
    return world_of(
        "dimension: 2\n"
        "specimen: {lattice: {kind: square, radius: 1 mm, cells: [8, 16]}, group: 1}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e8, kratio: 2,\n"
        "             friction: 0, bond_tension_limit: 1000, bond_shear_limit: 1e5}]\n"
        "law: {stiffness: uniform}\n"
        "bonds: {interaction_range: 0.05}\n"
        "damping: {background: {model: nonviscous_vector, coefficient: 0.7}}\n"
        "sets:\n"
        "  - {name: lower, select: {end: {axis: y, side: lower, depth: 1 mm, by: surface}}, "
        "motion: {vy: -0.01}}\n"
        "  - {name: upper, select: {end: {axis: y, side: upper, depth: 1 mm, by: surface}}, "
        "motion: {vy: 0.01}}\n"
        "test: {kind: tension, axis: y, lower: lower, upper: upper, area: 16 mm2, length: 32 mm}\n"
        "time: {end: 20 ms, stop: {peak_drop: 0.2}}\n"
        "run: {threads: 1}\n%s",
        more);
}

/* 15 of 16 gaps between rows have bonds, over a length of 16 diameters. */
static void uniform_strain_of_a_lattice_is_the_stiffness_of_its_chains(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_estimate e;
    gn_world *w = lattice("");
    assert_int_equal(gn_estimate_make(&w->ctx, &w->dem, &w->solids, &e, &error), GNEISS_OK);
    assert_null(e.absent);
    double area = w->ctx.volume / 32e-3; /* m2 of the body that the engine has found */
    assert_near(e.uniform_modulus, 8.0 * 1e8 * 2e-3 / area * 15.0 / 16.0, 1e-9 * e.uniform_modulus);
    assert_near(e.poisson, 0.0, 1e-12);
    gn_world_free(w);
    free(w);
}

static void bonds_along_the_axis_break_at_their_strength_over_their_stiffness(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_estimate e;
    gn_world *w = lattice("");
    assert_int_equal(gn_estimate_make(&w->ctx, &w->dem, &w->solids, &e, &error), GNEISS_OK);
    /* R_n/(k_n L) = 1000/(1e8 0.002), because half of the bonds are stretched; the bonds across are
     * not.
     */
    assert_near(e.breaking_strain, 5e-3, 1e-12);
    gn_world_free(w);
    free(w);
}

static void a_scene_without_a_test_is_not_covered_and_says_why(void **state) {
    (void)state;
    gn_test_groups g;
    gn_world *w = world_of(
        "dimension: 3\n"
        "specimen: {particles: [[0, 0, 0, 1 mm], [2 mm, 0, 0, 1 mm]]}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e6, kratio: 2, friction: 0}]\n"
        "law: {stiffness: uniform}\ntime: {end: 1 ms}\n");
    assert_string_equal(gn_study_find_case(&w->ctx, &w->dem, &g), "the scene has no test");
    gn_world_free(w);
    free(w);
}

/* --- the plan --- */

static void
what_is_proposed_is_right_and_no_dearer_than_the_scene_where_that_is_right(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_plan plan;
    gn_world *w = lattice("");
    gn_wanted wanted = {.error = 0.9, .reading = "strength"};
    assert_int_equal(gn_plan_make(w, &wanted, 0.0, &plan, &error), GNEISS_OK);
    assert_null(plan.absent);
    assert_true(plan.reached);
    assert_true(plan.best.error <= 0.9);
    assert_true(plan.current.error > 0.9 || plan.best.seconds <= plan.current.seconds);
    gn_world_free(w);
    free(w);
}

static void an_error_below_the_floor_is_not_reached(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_plan plan;
    gn_world *w = lattice("");
    gn_wanted wanted = {.error = 1e-4, .reading = "strength"};
    assert_int_equal(gn_plan_make(w, &wanted, 0.0, &plan, &error), GNEISS_OK);
    assert_false(plan.reached);
    assert_true(plan.best.error > 1e-4);
    gn_world_free(w);
    free(w);
}

/* A particle with a single bond rolls about its neighbour. */
static void a_start_at_the_first_break_needs_bonds_that_hold_every_particle(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_plan plan;
    gn_world *w = lattice("");
    gn_wanted wanted = {.error = 0.9, .reading = "strength"};
    assert_int_equal(gn_plan_make(w, &wanted, 0.0, &plan, &error), GNEISS_OK);
    assert_null(plan.statics_refusal);
    w->dem.particles.bonds0[3] = 1;
    assert_int_equal(gn_plan_make(w, &wanted, 0.0, &plan, &error), GNEISS_OK);
    assert_non_null(plan.statics_refusal);
    assert_false(plan.best.first_break);
    gn_world_free(w);
    free(w);
}

static void a_step_costs_something_in_both_precisions(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_cost cost;
    gn_world *w = lattice("");
    for (int mixed = 0; mixed < 2; mixed++) {
        assert_int_equal(gn_cost_measure(&w->ctx, &w->dem, &w->solids, mixed, &cost, &error),
                         GNEISS_OK);
        assert_true(cost.particle + cost.contact > 0.0);
    }
    gn_world_free(w);
    free(w);
}

/* --- the budget --- */

static void a_run_that_is_not_covered_has_a_reason_instead_of_a_budget(void **state) {
    (void)state;
    gn_budget *b;
    gneiss_error error = {0};
    gn_history h = {0};
    gn_readings r = {0};
    gn_world *w = lattice("gravity: [0, 0]\n");
    w->ctx.scene.test.kind = GN_TEST_NONE;
    assert_int_equal(gn_budget_create(w, &h, &r, &b, &error), GNEISS_OK);
    assert_string_equal(b->absent, "the scene has no test");
    free(b);
    gn_world_free(w);
    free(w);
}

static void ends_out_of_balance_count_with_half_of_their_difference(void **state) {
    (void)state;
    gn_budget *b;
    gneiss_error error = {0};
    gn_history h = {0};
    assert_int_equal(gn_history_add_column(&h, "time", "s", "", &error), GNEISS_OK);
    assert_int_equal(gn_history_add_column(&h, "stress", "Pa", "", &error), GNEISS_OK);
    for (int k = 0; k < 30; k++)
        assert_int_equal(gn_history_append(&h, (double[]){1e-6 * k, 1e5 * k}, &error), GNEISS_OK);
    gn_readings r = {.peak_stress = 1e7,
                     .young_modulus_average = 1e10,
                     .largest_strain = 0.005,
                     .end_imbalance = 0.6};
    gn_world *w = lattice("");
    assert_int_equal(gn_budget_create(w, &h, &r, &b, &error), GNEISS_OK);
    gn_error_cause *velocity = gn_causes_find(&b->of[GN_READING_peak_stress], "velocity");
    assert_non_null(velocity);
    assert_near(velocity->error, 0.3, 1e-15);
    assert_true(velocity->measured);
    free(b);
    gn_history_free(&h);
    gn_world_free(w);
    free(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_of_a_law_is_evaluated),
        cmocka_unit_test(the_error_of_a_power_grows_away_from_its_reference),
        cmocka_unit_test(the_study_that_is_compiled_in_has_laws_of_compression_and_tension),
        cmocka_unit_test(the_total_is_the_root_of_the_sum_of_squares),
        cmocka_unit_test(biases_of_one_sense_add_up),
        cmocka_unit_test(a_bias_has_the_sense_of_its_law),
        cmocka_unit_test(packings_scatter_as_their_bonds_do),
        cmocka_unit_test(four_packings_halve_the_scatter_and_leave_the_bias),
        cmocka_unit_test(slower_loading_and_more_particles_are_better),
        cmocka_unit_test(a_reading_that_does_not_converge_has_no_error_of_size_and_says_so),
        cmocka_unit_test(scenes_beyond_the_study_are_reported),
        cmocka_unit_test(uniform_strain_of_a_lattice_is_the_stiffness_of_its_chains),
        cmocka_unit_test(bonds_along_the_axis_break_at_their_strength_over_their_stiffness),
        cmocka_unit_test(a_scene_without_a_test_is_not_covered_and_says_why),
        cmocka_unit_test(
            what_is_proposed_is_right_and_no_dearer_than_the_scene_where_that_is_right),
        cmocka_unit_test(an_error_below_the_floor_is_not_reached),
        cmocka_unit_test(a_start_at_the_first_break_needs_bonds_that_hold_every_particle),
        cmocka_unit_test(a_step_costs_something_in_both_precisions),
        cmocka_unit_test(a_run_that_is_not_covered_has_a_reason_instead_of_a_budget),
        cmocka_unit_test(ends_out_of_balance_count_with_half_of_their_difference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
