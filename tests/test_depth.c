/* Contacts of particles whose overlap exceeds the range of validity of contact laws. */
#include "surface_helpers.h"

#include "run/run.h"

static bool warns(const gn_run *run, const char *words) {
    gn_warnings list;
    gneiss_error error = {0};
    assert_ok(gn_run_warnings(run, &list, &error), &error);
    for (size_t k = 0; k < list.count; k++)
        if (strcmp(list.warning[k].name, "contacts_too_deep") == 0) {
            if (!strstr(list.warning[k].text, words)) fail_msg("%s", list.warning[k].text);
            return true;
        }
    return false;
}

static void start(gn_run *run, const char *scene_text) {
    gn_scene scene;
    gneiss_error error = {0};
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, run, &error), &error);
}

/* A grain of 1 cm comes to rest by its weight on a spring of k: on a wall,
 * a held body, a held grain. The overlap then is m g/k, which is `share` of the radius. */
static void resting(text *t, int on, double share) {
    const double mass = 2500 * 4.0 / 3.0 * pi * 1e-6, k = mass * 10.0 / (share * 0.01);
    const char *const under[] = {
        "walls: [{name: u, point: [0, 0, 0], normal: [0, 0, 1], stiffness: %g}]\n",
        ("bodies: [{name: u, box: {size: [1, 1, 0.1]}, origin: [-0.5, -0.5, -0.1], stiffness: "
         "%g}]\n"),
        "sets: [{name: u, select: {ids: [1]}, motion: {vx: 0, vy: 0, vz: 0}}]\n"};
    add(t,
        "dimension: 3\nspecimen: {particles: [[0, 0, 0.01, 0.01]%s], group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: %.17g, kratio: 2}]\n"
        "law: {stiffness: uniform}\ngravity: [0, 0, -10]\ntime: {end: 99}\n"
        "damping: {contact: {fraction: 0.9}}\nrun: {threads: 2}\n"
        "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\n",
        on == 2 ? ", [0, 0, -0.01, 0.01]" : "", k);
    add(t, under[on], k);
}

static bool same(const gn_depth *a, const gn_depth *b) {
    return a->excess == b->excess && a->share == b->share && a->overlap == b->overlap &&
           a->time == b->time && a->first == b->first && a->second == b->second &&
           a->looked == b->looked;
}

static void deep_overlaps_cause_a_warning(void **state) {
    (void)state;
    const char *const saved = "/tmp/gneiss-depth.h5";
    const char *const who[] = {"particle 0 and wall 'u'", "particle 0 and body 'u'",
                               "particles 0 and 1"};
    for (int on = 0; on < 3; on++)
        for (int deep = 0; deep < 2; deep++) {
            const double share = deep ? 0.2 : 0.05;
            text *t = calloc(1, sizeof *t);
            gn_run run, resumed;
            gneiss_error error = {0};
            resting(t, on, share);
            start(&run, t->s);
            for (int n = 0; n < 400; n++) measured_step(&run.world);
            const gn_depth *d = &run.world.dem.depth;
            assert_close(d->share, share, 0.02);
            assert_close(d->overlap, share * 0.01, 0.02);
            assert_int_equal(warns(&run, who[on]), deep);
            assert_ok(gn_checkpoint_write(&run, saved, &error), &error);
            assert_ok(gn_checkpoint_load(saved, NULL, 0, &resumed, &error), &error);
            assert_true(same(&resumed.world.dem.depth, d));
            assert_int_equal(warns(&resumed, who[on]), deep);
            for (int n = 0; n < 200; n++) measured_step(&run.world);
            for (int n = 0; n < 200; n++) measured_step(&resumed.world);
            assert_true(same(&resumed.world.dem.depth, d));
            gn_run_free(&run);
            gn_run_free(&resumed);
            free(t);
            unlink(saved);
        }
}

/* A grain by Hertz's law penetrates by almost a radius. The overlap is checked in steps without
 * readings too. */
static void soft_grains_cause_a_warning(void **state) {
    (void)state;
    gn_run run;
    start(&run, "dimension: 3\nspecimen: {particles: [[0, 0, 0.05, 0.01]], group: 0}\n"
                "materials: [{name: m, density: 2500, young: 1000, poisson: 0.25, friction: 0.5, "
                "restitution: 0.5}]\nlaw: {stiffness: hertz}\ngravity: [0, 0, -9.81]\n"
                "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], material: m}]\n"
                "time: {end: 0.3}\nrun: {threads: 1}\n");
    run_until(&run.world, 0.3);
    assert_true(run.world.dem.depth.share > 1.0);
    assert_true(warns(&run, "particle 0 and wall 'f'"));
    gn_run_free(&run);
}

/* Held grains that overlap each other and a wall, as in rough floors, exert no forces on each
 * other. */
static void held_particles_may_overlap(void **state) {
    (void)state;
    gn_run run;
    start(
        &run,
        "dimension: 3\nspecimen: {particles: [[0, 0, 0, 0.01], [0.005, 0, 0, 0.01], [0, 0, "
        "0.02, 0.01]], group: 0}\n"
        "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\nlaw: {stiffness: "
        "uniform}\nwalls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6}]\n"
        "sets: [{name: h, select: {ids: [0, 1]}, motion: {vx: 0, vy: 0, vz: 0}}]\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
    for (int n = 0; n < 200; n++) measured_step(&run.world);
    assert_true(run.world.dem.depth.share < 1e-6);
    assert_false(warns(&run, ""));
    gn_run_free(&run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(deep_overlaps_cause_a_warning),
        cmocka_unit_test(soft_grains_cause_a_warning),
        cmocka_unit_test(held_particles_may_overlap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
