/* Balance of forces as a condition for the end of a run (time.stop.unbalanced) and of a stage. */
#include "surface_helpers.h"

#include "run/run.h"

#define GRAVITY                                                                                    \
    "dimension: 3\nmaterials: [{name: m, density: 2500, contact_modulus: 5 MPa, kratio: 2, "       \
    "friction: 0.3}]\n"                                                                            \
    "law: {stiffness: harmonic}\ngravity: [0, 0, -10]\ndamping: {contact: {fraction: 0.9}}\n"      \
    "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\nrun: {threads: 1}\n"                             \
    "output: {history_rows: 400, snapshots: 0}\n"
#define GRAIN(z) "specimen: {particles: [[0, 0, " #z ", 1 mm]], group: 0}\n"
#define BY_RUN   "time: {end: 0.2, stop: {unbalanced: 0.01}}\n"
#define BY_STAGE "time: {end: 0.2}\nstages: [{name: settle, end: {unbalanced: 0.01}}]\n"

/* s: when the run ended; *number: particles then. */
static double end_and_number(const char *scene_text, bool *balanced, size_t *number) {
    gn_scene scene;
    gn_run run;
    gneiss_error error = {0};
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, &run, &error), &error);
    while (!run.finished && run.world.ctx.time < 0.21)
        assert_ok(gn_run_advance(&run, 1.0, NULL, &error), &error);
    *balanced = strstr(run.stop_reason, "unbalanced") != NULL;
    const double time = run.world.ctx.time;
    *number = gn_dem_present_count(&run.world.dem);
    gn_run_free(&run);
    return time;
}

static double end_of(const char *scene_text, bool *balanced) {
    size_t number;
    return end_and_number(scene_text, balanced, &number);
}

static const char *const floors[] = {
    "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e4}]\n",
    "bodies: [{name: f, box: {size: [20 mm, 20 mm, 2 mm]}, origin: [-10 mm, -10 mm, -2 mm], "
    "stiffness: 1e4}]\n",
    "elements: {box: {size: [20 mm, 20 mm, 10 mm], cells: [2, 2, 1], origin: [-10 mm, -10 mm, -10 "
    "mm]}, materials: [{density: 2500, young: 10 MPa, poisson: 0.2}], contact: {stiffness: 1e4}, "
    "motions: [{name: foot, group: z_lower, motion: {vx: 0, vy: 0, vz: 0}}]}\n"};

/* A grain falls for 18 mm on a wall, a body or finite elements: in the air it is not in balance. */
static void free_fall_is_no_balance(void **state) {
    (void)state;
    static const char *const ends[] = {BY_RUN, BY_STAGE};
    const double fall = sqrt(2 * 0.018 / 10.0);
    for (int floor = 0; floor < 3; floor++)
        for (int k = 0; k < 2; k++) {
            bool balanced;
            text *t = calloc(1, sizeof *t);
            add(t, GRAVITY GRAIN(19e-3) "%s%s", floors[floor], ends[k]);
            double end = end_of(t->s, &balanced);
            if (!(end > fall)) fail_msg("floor %d, end %d: %g s", floor, k, end);
            free(t);
        }
}

/* A grain in contact with only a wall or a body comes to rest on it: both are then in balance. */
static void a_grain_at_rest_on_a_wall_or_a_body_is_in_balance(void **state) {
    (void)state;
    static const char *const ends[] = {BY_RUN, BY_STAGE};
    for (int floor = 0; floor < 2; floor++)
        for (int k = 0; k < 2; k++) {
            bool balanced;
            text *t = calloc(1, sizeof *t);
            add(t, GRAVITY GRAIN(1e-3) "%s%s", floors[floor], ends[k]);
            double end = end_of(t->s, &balanced);
            if (!balanced || !(end < 0.19)) fail_msg("floor %d, end %d: %g s", floor, k, end);
            free(t);
        }
}

/* Grains at rest beside a body that still falls. */
static void a_falling_body_is_no_balance(void **state) {
    (void)state;
    bool balanced;
    text *t = calloc(1, sizeof *t);
    add(t,
        GRAVITY GRAIN(1e-3) "%sbodies: [{name: b, box: {size: [2 mm, 2 mm, 2 mm]}, origin: [20 mm, "
                            "0, 20 mm], stiffness: 1e4, free: true, density: 2500}]\n" BY_RUN,
        floors[0]);
    assert_true(end_of(t->s, &balanced) > sqrt(2 * 0.02 / 10.0));
    free(t);
}

/* Grains without weight and contacts carry no load. */
static void grains_without_contacts_are_not_in_balance(void **state) {
    (void)state;
    bool balanced;
    text *t = calloc(1, sizeof *t);
    add(t, GRAVITY GRAIN(5e-3) "%s" BY_RUN, floors[0]);
    char *g = strstr(t->s, "-10]");
    memcpy(g, "0.0]", 4);
    assert_near(end_of(t->s, &balanced), 0.2, 1e-3);
    assert_true(!balanced);
    free(t);
}

/* A source that still has grains to insert, or begins later, prevents the end of the run and the
 * stage; one that is blocked by grains at rest, or would begin after the end, does not. */
static void a_source_with_grains_to_come_keeps_a_run_going(void **state) {
    (void)state;
    static const char *const ends[] = {BY_RUN, BY_STAGE};
    static const struct {
        const char *source, *grain;
        double after;
        size_t number;
    } cases[] = {
        {"box: {size: [10 mm, 10 mm, 4 mm]}, origin: [0, 0, 1 mm], rate: 40, total: 5", "", 0.1, 5},
        {"box: {size: [10 mm, 10 mm, 4 mm]}, origin: [0, 0, 1 mm], rate: 40, end: 0.1", "", 0.075,
         4},
        {"box: {size: [10 mm, 10 mm, 4 mm]}, origin: [5 mm, 0, 1 mm], rate: 1000, total: 1, start: "
         "0.1",
         GRAIN(1e-3), 0.1, 2},
        {"box: {size: [10 mm, 10 mm, 4 mm]}, origin: [5 mm, 0, 1 mm], rate: 1000, start: 0.3",
         GRAIN(1e-3), 0.0, 1},
        {"box: {size: [0.1 mm, 0.1 mm, 0.1 mm]}, origin: [0, 0, 1 mm], rate: 1000", "", 0.0, 1}};
    for (size_t k = 0; k < 2 * (sizeof cases / sizeof *cases); k++) {
        bool balanced;
        size_t number;
        text *t = calloc(1, sizeof *t);
        add(t, GRAVITY "%s%s%ssources: [{name: s, mean_radius: 1 mm, %s}]\n", cases[k / 2].grain,
            floors[0], ends[k % 2], cases[k / 2].source);
        const double end = end_and_number(t->s, &balanced, &number);
        if (!balanced || !(end > cases[k / 2].after) || number != cases[k / 2].number)
            fail_msg("case %zu: %g s, %zu grains", k, end, number);
        free(t);
    }
}

/* Two grains that fall and hardly touch. */
static void the_ratio_that_is_reported_is_bounded(void **state) {
    (void)state;
    gn_world *w =
        world_of("%s", GRAVITY "specimen: {particles: [[0, 0, 0, 1 mm], [1.9999999999e-3, "
                               "0, 0, 1 mm]], group: 0}\ntime: {end: 1}\n");
    measured_step(w);
    assert_true(w->ledger.balance.ratio > 1000.0);
    assert_near(w->ledger.unbalanced, 1000.0, 0.0);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_fall_is_no_balance),
        cmocka_unit_test(a_grain_at_rest_on_a_wall_or_a_body_is_in_balance),
        cmocka_unit_test(a_falling_body_is_no_balance),
        cmocka_unit_test(grains_without_contacts_are_not_in_balance),
        cmocka_unit_test(the_ratio_that_is_reported_is_bounded),
        cmocka_unit_test(a_source_with_grains_to_come_keeps_a_run_going),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
