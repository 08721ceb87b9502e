/* Bodies, walls and nodes that move so fast that they would pass through particles between two
 * steps: the run stops and names them. */
#include "world_helpers.h"

/* A sphere of radius 1 mm at the origin, 1 us a step: half a radius a step is 500 m/s. */
static const char head[] =
    "dimension: 3\nspecimen: {particles: [[0, 0, 0, 1 mm]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e4, kratio: 2}]\n"
    "law: {stiffness: uniform}\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"
    "run: {threads: 1}\ntime: {step: 1e-6, end: 1}\n";

/* The status of the first step. */
static gneiss_status first_step(const char *scene, gneiss_error *error) {
    gn_world *w = world_of("%s%s", head, scene);
    gneiss_status status = gn_world_step(w, true, error);
    world_end(w);
    return status;
}

static void passes(const char *scene) {
    gneiss_error error = {0};
    if (first_step(scene, &error) != GNEISS_OK) fail_msg("%s", error.message);
}

static void stops(const char *scene, const char *who) {
    gneiss_error error = {0};
    assert_int_equal(first_step(scene, &error), GNEISS_ERROR_UNSTABLE);
    if (!strstr(error.message, who)) fail_msg("expected %s in: %s", who, error.message);
    if (!strstr(error.message, "half the smallest radius")) fail_msg("%s", error.message);
    if (!strstr(error.message, "; a smaller time.step or a slower motion") &&
        !strstr(error.message, "; servo.max_velocity bounds it"))
        fail_msg("no remedy in: %s", error.message);
}

static void a_particle_may_move_half_a_radius_in_a_step(void **state) {
    (void)state;
    passes("sets: [{name: a, select: {all: true}, initial_velocity: [499, 0, 0]}]\n");
    stops("sets: [{name: a, select: {all: true}, initial_velocity: [501, 0, 0]}]\n", "particle 0");
}

#define PLATE(MORE)                                                                                \
    "bodies: [{name: tool, box: {size: [1, 1, 0.001]}, origin: [-0.5, -0.5, 0.02], stiffness: "    \
    "1e4, " MORE "}]\n"

static void a_body_may_move_half_a_radius_in_a_step(void **state) {
    (void)state;
    passes(PLATE("motion: {vz: -499}"));
    stops(PLATE("motion: {vz: -501}"), "body 'tool'");
    stops(PLATE("free: true, density: 1000, initial_velocity: [0, 0, -501]"), "body 'tool'");
}

/* The farthest corners are sqrt(0.5) m from the middle of the plate. */
static void spin_counts_with_the_farthest_vertex(void **state) {
    (void)state;
    passes(PLATE("reference: [0, 0, 0.02], motion: {wz: 700}"));
    stops(PLATE("reference: [0, 0, 0.02], motion: {wz: 710}"), "body 'tool'");
    stops(PLATE("reference: [0, 0, 0.02], motion: {wz: 1e8}"), "body 'tool'");
}

static void a_spin_that_is_not_a_number_is_reported(void **state) {
    (void)state;
    gneiss_error error = {0};
    gn_world *w = world_of("%s%s", head, PLATE("free: true, density: 1000"));
    w->boundary.bodies[0].momentum[1] = NAN;
    assert_int_equal(gn_world_step(w, true, &error), GNEISS_ERROR_UNSTABLE);
    assert_non_null(strstr(error.message, "body 'tool' has a velocity that is not finite"));
    world_end(w);
}

#define LID(MORE)                                                                                  \
    "walls: [{name: lid, point: [0, 0, 1], normal: [0, 0, -1], stiffness: 1e4, " MORE "}]\n"

/* The first step ends with a wall at its new velocity. */
static void a_wall_may_move_half_a_radius_in_a_step(void **state) {
    (void)state;
    passes(LID("motion: {vz: -499}"));
    stops(LID("motion: {vz: -501}"), "wall 'lid'");
    stops(LID("servo: {force: 1e9, max_velocity: 501}"), "servo.max_velocity");
}

static void a_wall_may_slide_along_itself(void **state) {
    (void)state;
    passes(LID("motion: {vx: 1e6}"));
}

/* The first measured bodies have the initial spins. */
static void a_particle_may_turn_half_a_radian_in_a_step(void **state) {
    (void)state;
    gneiss_error error = {0};
    passes("sets: [{name: a, select: {all: true}, initial_spin: [0, 4.9e5, 0]}]\n");
    const char *fast = "sets: [{name: a, select: {all: true}, initial_spin: [0, -5.1e5, 0]}]\n";
    assert_int_equal(first_step(fast, &error), GNEISS_ERROR_UNSTABLE);
    if (!strstr(error.message, "particle 0 turned")) fail_msg("%s", error.message);
}

#define BLOCK(SPEED)                                                                               \
    "elements: {box: {size: [0.01, 0.01, 0.01], cells: [1, 1, 1], origin: [0.1, 0, 0]}, "          \
    "materials: [{young: 1e6, poisson: 0.2, density: 1000}], contact: {stiffness: 1e3}, motions: " \
    "[{name: all, group: body, motion: {vx: " SPEED "}}]}\n"

static void a_node_may_move_half_a_radius_in_a_step(void **state) {
    (void)state;
    passes(BLOCK("-499"));
    stops(BLOCK("-501"), "elements: a node");
}

/* At the automatic step a free grain flies a part of its radius in a step, and touches for one or
 * two steps: from any direction, the step is that of the contact when it begins. */
static void a_flight_ends_with_the_step_of_the_contact(void **state) {
    (void)state;
    for (int k = 0; k < 40; k++) {
        gn_world *w = world_of(
            "dimension: 3\nspecimen: {particles: [[0, 0, %.17g, 0.45e-3]], "
            "group: 0}\nmaterials: [{name: m, density: 2200, young: 650 MPa, poisson: 0.37, "
            "restitution: 0.5}]\nlaw: {stiffness: hertz}\n"
            "walls: [{name: floor, point: [0, 0, 0], normal: [0, 0, 1]}]\n"
            "sets: [{name: a, select: {ids: [0]}, initial_velocity: [0, 0, -2]}]\n"
            "domain: {min: [-9, -9, -9], max: [9, 9, 9]}\nrun: {threads: 1}\ntime: {end: 1}\n",
            0.45e-3 * (25.0 + 0.013 * k));
        gneiss_error error = {0};
        double worst = 0.0;
        while (w->ctx.step < 5000 && (vel_of(w, 0)[2] < 0.0 || w->dem.particles.pos[2] < 0.46e-3)) {
            if (gn_world_step(w, true, &error) != GNEISS_OK) fail_msg("%s", error.message);
            worst = fmax(worst, fabs(gn_energy_residual(&w->ledger.reading)));
        }
        if (worst > 0.01) fail_msg("from %d: residual %g", k, worst);
        assert_near(vel_of(w, 0)[2], 1.0, 0.01);
        world_end(w);
    }
}

/* Grains at rest on a wall that moves away, slowly or fast, lose contact within a step: they are
 * not carried along, and fall. A wall that moves away needs no bound. */
static void a_wall_that_retreats_unloads_its_contacts(void **state) {
    (void)state;
    static const char *const motions[] = {"[[0, 0], [5 ms, 0], [5.1 ms, -2]]",
                                          "[[0, 0], [5 ms, 0], [5.1 ms, -20]]",
                                          "[[0, 0], [5 ms, 0], [5.1 ms, -60]]",
                                          "[[0, 0], [5 ms, 0], [5.01 ms, -600]]",
                                          "-20",
                                          "-60",
                                          "-900"};
    for (size_t k = 0; k < sizeof motions / sizeof *motions; k++) {
        double worst = 0.0;
        gn_world *w = world_of(
            "dimension: 2\nmaterials: [{name: g, density: 2500, contact_modulus: 1 MPa, kratio: 2, "
            "friction: 0.3}]\nlaw: {stiffness: harmonic}\ngravity: [0, -9.81]\n"
            "damping: {contact: {restitution: 0.5}}\nspecimen: {lattice: {kind: square, radius: 1 "
            "mm, cells: [6, 6], origin: [0, 0]}, group: 0}\nwalls: [{name: f, point: [0, 0], "
            "normal: [0, 1], stiffness: 1e6, motion: {vy: %s}}]\n"
            "domain: {min: [-90, -90], max: [90, 90]}\ntime: {end: 8 ms}\nrun: {threads: 1}\n",
            motions[k]);
        while (w->ctx.time < 8e-3) {
            measured_step(w);
            worst = fmax(worst, fabs(gn_energy_residual(&w->ledger.reading)));
        }
        /* Runs with run.residual_limit stop. */
        if (worst > 0.1) fail_msg("%s: residual %g", motions[k], worst);
        assert_true(vel_of(w, 0)[1] < -0.02);
        world_end(w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_may_move_half_a_radius_in_a_step),
        cmocka_unit_test(a_body_may_move_half_a_radius_in_a_step),
        cmocka_unit_test(spin_counts_with_the_farthest_vertex),
        cmocka_unit_test(a_spin_that_is_not_a_number_is_reported),
        cmocka_unit_test(a_wall_may_move_half_a_radius_in_a_step),
        cmocka_unit_test(a_wall_may_slide_along_itself),
        cmocka_unit_test(a_particle_may_turn_half_a_radian_in_a_step),
        cmocka_unit_test(a_node_may_move_half_a_radius_in_a_step),
        cmocka_unit_test(a_wall_that_retreats_unloads_its_contacts),
        cmocka_unit_test(a_flight_ends_with_the_step_of_the_contact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
