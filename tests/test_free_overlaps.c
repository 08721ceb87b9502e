/* Overlaps of a packing that are free of stress between particles without a bond (bonds.c), and the
 * warning of a specimen that holds energy at rest. */
#include "surface_helpers.h"

#include "boundary/overlap.h"
#include "run/run.h"

/* Four discs or spheres of 10 mm in a row; neighbours overlap by 1 mm. The right half is another
 * cohesive group, so that the pair in the middle has no bond. */
static const char *const row =
    "dimension: %d\nspecimen: {particles: [[0, 0%s, 0.01], [0.019, 0%s, 0.01], "
    "[0.038, 0%s, 0.01], [0.057, 0%s, 0.01]]}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e7, contact_modulus: 1e9, kratio: 2, "
    "friction: 0.3, tensile_strength: 1e5, shear_strength: 1e5, bond_tension_limit: 10, "
    "bond_shear_limit: 10}]\n"
    "law: {stiffness: %s}\nrun: {threads: 1}\n%s";

static gn_world *row_of_four(int dimension, const char *law, const char *more) {
    const char *z = dimension == 3 ? ", 0" : "";
    return world_of(row, dimension, z, z, z, z, law, more);
}

static double kinetic(const gn_world *w) {
    double sum = 0.0;
    for (size_t p = 0; p < w->dem.particles.soa.count; p++) {
        const double *v = w->dem.particles.vel + 4 * p;
        sum += 0.5 * gn_dot3(v, v) / v[3];
    }
    return sum;
}

#define UPPER(group) "sets: [{name: u, select: {ids: [2, 3]}, group: " #group "}]\n"

static void unbonded_neighbours_of_a_bonded_packing_are_free_of_stress(void **state) {
    (void)state;
    static const char *const cases[] = {
        UPPER(2) "bonds: {}\ntime: {end: 1}\n",
        UPPER(0) "bonds: {}\ntime: {end: 1}\n",
        "bonds: {overlap_range: 0.01}\ntime: {end: 1}\n",
        UPPER(2) "bonds: {}\ntime: {end: 1}\nstages:\n- {name: a, end: {steps: 5}}\n"
                 "- {name: b, bonds: {enabled: off}, end: {time: 1}}\n",
    };
    static const char *const laws[] = {"uniform", "harmonic"};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int dimension = 2; dimension <= 3; dimension++)
            for (int law = 0; law < 2; law++) {
                gn_world *w = row_of_four(dimension, laws[law], cases[k]);
                run_steps(w, 20);
                assert_true(kinetic(w) < 1e-20);
                assert_int_equal(w->dem.broken_tension + w->dem.broken_shear, 0);
                assert_int_equal(w->dem.bonds_at_start, k == 1 ? 1 : k == 2 ? 0 : 2);
                assert_int_equal(w->dem.bonds.contacts.soa.count, 3);
                assert_int_equal(w->dem.pairs.contacts.soa.count, 0);
                world_end(w);
            }
}

/* The middle pair repels with k (d0 - d) from the initial distance on, and never attracts. */
static void a_free_overlap_presses_from_its_distance_of_the_start_on(void **state) {
    (void)state;
    for (int sense = -1; sense <= 1; sense += 2) {
        char more[400];
        snprintf(more, sizeof more,
                 "sets: [{name: l, select: {ids: [0, 1]}, motion: {vx: 0, vy: 0, vz: 0}}, "
                 "{name: u, select: {ids: [2, 3]}, group: 2, motion: {vx: %d, vy: 0, vz: 0}}]\n"
                 "bonds: {}\ntime: {end: 1, step: 1e-6}\n",
                 -sense);
        gn_world *w = row_of_four(3, "uniform", more);
        run_steps(w, 11);
        const gn_energy e = measured_step(w);
        const double u = 11e-6;
        assert_near(e.elastic_normal, sense > 0 ? 0.5 * 1e7 * u * u : 0.0,
                    1e-3 * 0.5 * 1e7 * u * u);
        world_end(w);
    }
}

/* *found: the text of the warning, "" without it. */
static void burst_of(const char *scene_text, gn_run *run, char found[GNEISS_MESSAGE_SIZE]) {
    gn_scene scene;
    gn_warnings list;
    gneiss_error error = {0};
    *found = 0;
    assert_ok(gn_scene_parse(scene_text, "s.yaml", NULL, NULL, 0, &scene, &error), &error);
    assert_ok(gn_run_create(&scene, run, &error), &error);
    assert_ok(gn_run_steps(run, 3, &error), &error);
    assert_ok(gn_run_warnings(run, &list, &error), &error);
    for (size_t c = 0; c < list.count; c++)
        if (strcmp(list.warning[c].name, "stressed_at_start") == 0)
            snprintf(found, GNEISS_MESSAGE_SIZE, "%s", list.warning[c].text);
}

static void energy_stored_at_rest_causes_a_warning(void **state) {
    (void)state;
    static const char *const cases[] = {"bonds: {}\ntime: {end: 1}\n",
                                        "bonds: {passive_gaps: false}\ntime: {end: 1}\n",
                                        "bonds: {enabled: off}\ntime: {end: 1}\n"};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        text *t = calloc(1, sizeof *t);
        gn_run run;
        char found[GNEISS_MESSAGE_SIZE];
        add(t, row, 3, ", 0", ", 0", ", 0", ", 0", "uniform", cases[k]);
        burst_of(t->s, &run, found);
        assert_true(!*found == (k == 0));
        /* The energy is 3 k u^2/2 with u = 1 mm. */
        if (*found && !strstr(found, "stored 15 J")) fail_msg("%s", found);
        gn_run_free(&run);
        free(t);
    }
}

/* A cubic block of 5 x 5 x 5 (5 x 5) spheres that touch, bonded, in which a wall or a body begins
 * 0.4 mm deep. */
static void a_wall_or_body_inside_particles_at_the_start_causes_a_warning(void **state) {
    (void)state;
    static const struct {
        const char *what[2], *more;
        bool warned;
    } cases[] = {
        {{"walls: [{name: f, point: [0, 0.4 mm], normal: [0, 1], stiffness: 1e7}]",
          "walls: [{name: f, point: [0, 0, 0.4 mm], normal: [0, 0, 1], stiffness: 1e7}]"},
         "",
         true},
        {{"walls: [{name: f, point: [0, 0.4 mm], normal: [0, 1], stiffness: 1e7, passive: true}]",
          "walls: [{name: f, point: [0, 0, 0.4 mm], normal: [0, 0, 1], stiffness: 1e7, passive: "
          "true}]"},
         "",
         false},
        {{"walls: [{name: f, point: [0, 0], normal: [0, 1], stiffness: 1e7}]",
          "walls: [{name: f, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e7}]"},
         "",
         false},
        {{"bodies: [{name: f, polygon: [[-0.01, -0.01], [0.03, -0.01], [0.03, 0.4 mm], [-0.01, 0.4 "
          "mm]], stiffness: 1e7}]",
          "bodies: [{name: f, box: {size: [40 mm, 40 mm, 10 mm]}, origin: [-10 mm, -10 mm, -9.6 "
          "mm], stiffness: 1e7}]"},
         "",
         true}};
    for (size_t k = 0; k < 2 * (sizeof cases / sizeof *cases); k++) {
        text *t = calloc(1, sizeof *t);
        gn_run run;
        char found[GNEISS_MESSAGE_SIZE], said[GNEISS_MESSAGE_SIZE];
        const bool space = k & 1;
        add(t,
            "dimension: %d\nspecimen: {lattice: {kind: %s, radius: 2 mm, cells: [5, 5%s]}}\n"
            "materials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2, "
            "tensile_strength: 1e6, shear_strength: 1e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
            "run: {threads: 1}\ntime: {end: 1}\n%s\n",
            space ? 3 : 2, space ? "cubic" : "square", space ? ", 5" : "",
            cases[k / 2].what[space]);
        burst_of(t->s, &run, found);
        if (!*found == cases[k / 2].warned) fail_msg("%s%s", t->s, found);
        /* There are 25 (5) contacts of k u^2/2 with u = 0.4 mm. */
        if (*found && !strstr(found, space ? "stored 20 J" : "stored 4 J")) fail_msg("%s", found);
        gn_run_free(&run);
        gn_world *w = world_of("%s", t->s);
        gn_overlap overlap[1];
        gneiss_error error = {0};
        assert_ok(gn_boundary_overlaps(&w->ctx, &w->dem, &w->boundary, overlap, &error), &error);
        assert_true(gn_overlap_bursts(&w->ctx, &w->dem, &w->boundary, &w->box, overlap, said,
                                      sizeof said) == cases[k / 2].warned);
        world_end(w);
        free(t);
    }
}

/* Ends of a test that begin inside particles are reported as initial_stress. */
static void ends_of_a_test_do_not_count_as_walls_inside_particles(void **state) {
    (void)state;
    for (int side = 0; side < 2; side++) {
        text *t = calloc(1, sizeof *t);
        gn_run run;
        char found[GNEISS_MESSAGE_SIZE];
        add(t,
            "dimension: 2\nspecimen: {lattice: {kind: square, radius: 2 mm, cells: [5, 5]}}\n"
            "materials: [{name: m, density: 2500, contact_modulus: 1e9, kratio: 2, "
            "tensile_strength: 1e6, shear_strength: 1e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
            "walls: [{name: f, point: [0, 0.1 mm], normal: [0, 1], stiffness: 1e7}, "
            "{name: u, point: [0, 19.9 mm], normal: [0, -1], stiffness: 1e7, motion: {vy: -0.01}}"
            "%s]\ntest: {kind: compression, axis: y, lower: f, upper: u}\n"
            "run: {threads: 1}\ntime: {end: 1}\n",
            side ? ", {name: s, point: [0.3 mm, 0], normal: [1, 0], stiffness: 1e7}" : "");
        burst_of(t->s, &run, found);
        if (!*found != !side) fail_msg("%s%s", t->s, found);
        gn_run_free(&run);
        free(t);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unbonded_neighbours_of_a_bonded_packing_are_free_of_stress),
        cmocka_unit_test(a_free_overlap_presses_from_its_distance_of_the_start_on),
        cmocka_unit_test(energy_stored_at_rest_causes_a_warning),
        cmocka_unit_test(a_wall_or_body_inside_particles_at_the_start_causes_a_warning),
        cmocka_unit_test(ends_of_a_test_do_not_count_as_walls_inside_particles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
