/* The loads of a particle in the output are those from which the step computes its motion. */
#include "boundary/loads.h"
#include "world_helpers.h"

typedef struct loads {
    double (*total)[6], (*damping)[6];
} loads;

static loads loads_of(const gn_world *w) {
    const size_t n = w->dem.particles.soa.count;
    loads l = {calloc(n + 1, sizeof *l.total), calloc(n + 1, sizeof *l.damping)};
    gneiss_error error = {0};
    if (gn_boundary_write_loads(&w->ctx, &w->dem, &w->boundary, &w->box, l.total[0], l.damping[0],
                                &error) != GNEISS_OK)
        fail_msg("%s", error.message);
    return l;
}

static void loads_end(loads *l) {
    free(l->total);
    free(l->damping);
}

/* Takes the next step and compares, by particle and component, the change of velocity per time
 * between two half steps times the inertia with the reported load. */
static void next_step_follows(gn_world *w, double spring, double rounding) {
    const size_t n = w->dem.particles.soa.count, bytes = 4 * n * sizeof(double);
    const bool rotates = w->dem.particles.spin;
    double *v = calloc(4 * n, sizeof *v), *spin = calloc(4 * n, sizeof *spin);
    const double interval = 0.5 * (w->ctx.dt_past + w->ctx.dt);
    loads l = loads_of(w);
    double most = 0.0, allowed = rounding + spring * 2.0 * w->dem.speed_most * w->ctx.dt;
    memcpy(v, w->dem.particles.vel, bytes);
    if (rotates) memcpy(spin, w->dem.particles.spin, bytes);
    run_steps(w, 1);
    for (size_t p = 0; p < n; p++)
        for (size_t k = 0; k < (rotates ? 6U : 3U); k++) {
            const double *before = k < 3 ? v : spin,
                         *after = k < 3 ? w->dem.particles.vel : w->dem.particles.spin;
            const int32_t slot = w->dem.particles.slot ? w->dem.particles.slot[p] : -1;
            if (slot >= 0 && w->dem.prescribed.mask[slot] >> k & 1) continue;
            double change =
                (after[4 * p + k % 3] - before[4 * p + k % 3]) / interval / before[4 * p + 3];
            assert_near(l.total[p][k], change, k < 3 ? allowed : allowed * 1e-3);
            most = fmax(most, fabs(change));
        }
    assert_true(most > 10.0 * allowed);
    loads_end(&l);
    free(v);
    free(spin);
}

static const char *const damping[] = {
    "", "damping: {background: {model: viscous, coefficient: 3e3, rotation: 5e3}}\n",
    "damping: {background: {model: nonviscous_vector, coefficient: 0.6, rotation: 0.2}}\n",
    "damping: {background: {model: nonviscous_component, coefficient: 0.6}}\n",
    "damping: {background: {model: nonviscous_component, coefficient: 0.6, velocity: instant}}\n"};

/* Bonds neither slide nor open, so the loads agree to the rounding of forces of some newtons. (A
 * contact that opens would act for a part of the step that is not known in advance.) */
static void without_tangents_loads_equal_the_total_force(void **state) {
    (void)state;
    for (int dimension = 2; dimension <= 3; dimension++)
        for (size_t d = 0; d < sizeof damping / sizeof *damping; d++) {
            bool turns = strstr(damping[d], "rotation");
            if (turns) continue; /* particles without rotation have no coefficient of their own */
            gn_world *w = world_of(
                "dimension: %d\nspecimen: {lattice: {kind: %s, radius: 1 mm, cells: [4, 4%s], "
                "spacing: 0.999, jitter: 0.001}, group: 1}\n"
                "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 0, "
                "bond_tension_limit: 1e9, bond_shear_limit: 1e9}]\nbonds: {interaction_range: "
                "0.01}\n"
                "law: {stiffness: uniform, rotation: off}\ngravity: [0, -9.81%s]\n"
                "sets: [{name: pushed, select: {end: {axis: x, side: upper, depth: 2 mm}}, force: "
                "[3, 1%s]}]\n%stime: {end: 1}\nrun: {threads: 1}\n",
                dimension, dimension == 2 ? "hexagonal" : "fcc", dimension == 2 ? "" : ", 4",
                dimension == 2 ? "" : ", 2", dimension == 2 ? "" : ", 0", damping[d]);
            run_steps(w, 50);
            next_step_follows(w, 0.0, 1e-12);
            world_end(w);
        }
}

/* With tangential forces the coming step adds k_t times the tangential displacement in it, for at
 * most twelve contacts, and single precision adds 1e-7 of normal forces of 10 N. */
static void with_tangents_loads_lack_the_increment_of_a_step(void **state) {
    (void)state;
    for (int mixed = 0; mixed < 2; mixed++)
        for (size_t d = 0; d < sizeof damping / sizeof *damping; d++) {
            gn_world *w = world_of(
                "specimen: {lattice: {kind: fcc, radius: 1 mm, cells: [3, 3, 3], spacing: 0.9999, "
                "jitter: 0.001}, group: 1}\n"
                "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: "
                "0.4, bond_tension_limit: 1, bond_shear_limit: 3}]\nlaw: {stiffness: uniform}\n"
                "bonds: {interaction_range: 0.02, passive_gaps: false}\n"
                "sets: [{name: led, select: {end: {axis: z, side: upper, depth: 1 mm}}, motion: "
                "{vx: 0.01}}]\n"
                "%stime: {step: 1e-7, end: 1}\nrun: {threads: 1, precision: %s}\n",
                damping[d], mixed ? "mixed" : "double");
            run_steps(w, 100);
            next_step_follows(w, 12 * 5e4, mixed ? 1e-5 : 1e-12);
            world_end(w);
        }
}

/* A sphere on a floor that is dragged along it: weight, floor and drag. */
static void a_wall_carries_the_weight_on_it(void **state) {
    (void)state;
    gn_world *w = world_of(
        "specimen: {particles: [[0, 0, 0.999 mm, 1 mm], [10 mm, 0, 0.999 mm, 1 mm]]}\n"
        "materials: [{name: m, density: 2000, normal_stiffness: 1e5, kratio: 2, friction: 0.3}]\n"
        "law: {stiffness: uniform}\ngravity: [0, 0, -9.81]\n"
        "damping: {background: {model: viscous, coefficient: 2e3}}\n"
        "walls: [{name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e5, kratio: 2, "
        "friction: "
        "0.3}]\n"
        "sets: [{name: led, select: {ids: [1]}, motion: {vx: 0.1, vz: 0, wx: 0, wy: 0, wz: 0}}]\n"
        "time: {end: 1}\nrun: {threads: 1}\n");
    run_steps(w, 20000);
    loads l = loads_of(w);
    const int32_t free_one = w->dem.index_of_id[0], led = w->dem.index_of_id[1];
    const double weight = sphere_mass(2000, 1e-3) * 9.81;
    assert_near(l.total[free_one][2], 0.0, 1e-6 * weight);
    /* The driven sphere slides: friction acts on it, but not the damping of the others. */
    assert_near(l.total[led][0], -0.3 * 1e5 * 1e-6, 1e-3 * 0.03);
    assert_near(l.total[led][2], 1e5 * 1e-6 - weight, 1e-3 * 0.1);
    for (int k = 0; k < 3; k += 2) assert_true(l.damping[led][k] == 0.0);
    loads_end(&l);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_tangents_loads_equal_the_total_force),
        cmocka_unit_test(with_tangents_loads_lack_the_increment_of_a_step),
        cmocka_unit_test(a_wall_carries_the_weight_on_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
