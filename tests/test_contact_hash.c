/* Results have the same bits for any number of threads and any instruction set: hashes of the state
 * after 500 steps are compared. */
#include "world_helpers.h"

/* The world after 500 steps of a scene with `threads` and `isa`; some steps are measured, as in a
 * run. */
static gn_world *after_500(const char *scene_text, int threads, const char *isa,
                           const char *precision) {
    gn_world *w = world_of("%srun: {threads: %d, isa: %s, precision: %s}\n", scene_text, threads,
                           isa, precision);
    for (int k = 0; k < 10; k++) {
        measured_step(w);
        run_steps(w, 49);
    }
    return w;
}

static void check_in(const char *precision, const char *scene_text,
                     void (*happened)(const gn_world *)) {
    gn_world *w = after_500(scene_text, 1, "scalar", precision);
    uint64_t want = gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box);
    gn_energy ledger = w->ledger.reading;
    happened(w);
    world_end(w);
    for (int s = 0; s < GN_KERNEL_SETS; s++) {
        const gn_kernel_set *set = gn_kernel_set_at(s);
        if (!runs_here(set)) continue;
        for (int threads = 1; threads <= 4; threads++) {
            w = after_500(scene_text, threads, set->name, precision);
            if (gn_world_hash(&w->ctx, &w->dem, &w->boundary, &w->solids, &w->box) != want)
                fail_msg("%s on %d threads in %s precision has another state", set->name, threads,
                         precision);
            /* Sums over lanes depend on the set's width, but not on the threads. */
            if (s == 0) assert_memory_equal(&w->ledger.reading, &ledger, sizeof ledger);
            world_end(w);
        }
    }
}

static void check(const char *scene_text, void (*happened)(const gn_world *)) {
    check_in("double", scene_text, happened);
    check_in("mixed", scene_text, happened);
}

static void bonds_broke(const gn_world *w) {
    assert_true(w->dem.broken_tension > 10 && w->dem.broken_shear > 10);
    assert_true(w->dem.bonds.partials.blocks >
                8); /* there is more than one block for each thread */
}

static void a_crushed_specimen_has_one_state(void **state) {
    (void)state;
    check("dimension: 3\nspecimen: {lattice: {kind: fcc, radius: 1e-3, cells: [7, 7, 4], jitter: "
          "0.03}}\n"
          "materials: [{name: m, density: 2650, contact_modulus: 1e9, kratio: 2, friction: 0.5, "
          "tensile_strength: 3e6, shear_strength: 3e6}]\nlaw: {stiffness: harmonic}\nbonds: {}\n"
          "damping: {background: {model: nonviscous_vector, coefficient: 0.3}}\n"
          "walls:\n  - {name: low, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e6, kratio: 2, "
          "friction: 0.4, motion: {vz: 5}}\n"
          "  - {name: high, point: [0, 0, 11.2e-3], normal: [0, 0, -1], stiffness: 1e6, motion: "
          "{vz: -5}}\n"
          "time: {end: 1}\n",
          bonds_broke);
}

static void spheres_slid(const gn_world *w) {
    assert_true(w->ledger.energy.friction > 0.0 && w->ledger.energy.contact_damping > 0.0);
    assert_true(w->dem.verlet.rebuilds > 1);
}

static void a_collapsing_column_has_one_state(void **state) {
    (void)state;
    check(
        "dimension: 3\nspecimen: {lattice: {kind: cubic, radius: 1e-3, cells: [8, 8, 8], jitter: "
        "0.02}}\n"
        "materials: [{name: m, density: 2650, normal_stiffness: 1e4, kratio: 2, friction: 0.4}]\n"
        "law: {stiffness: uniform}\ndamping: {contact: {restitution: 0.5}}\ngravity: [4, 0, "
        "-9.81]\n"
        "initial: {random_velocity: 0.2}\n"
        "walls:\n  - {name: floor, point: [0, 0, 0], normal: [0, 0, 1], stiffness: 1e4, kratio: 2, "
        "friction: 0.4}\n"
        "  - {name: side, point: [17e-3, 0, 0], normal: [-1, 0, 0], stiffness: 1e4}\n"
        "time: {end: 1}\n",
        spheres_slid);
}

static void layers_slid(const gn_world *w) {
    assert_true(w->ledger.energy.friction > 0.0);
    assert_true(w->ctx.effects & GN_FX_PERIODIC);
}

static void a_periodic_shear_flow_has_one_state(void **state) {
    (void)state;
    check("dimension: 2\nspecimen: {lattice: {kind: hexagonal, radius: 1e-3, cells: [12, 7], "
          "spacing: 0.99, "
          "jitter: 0.02}}\n"
          "materials: [{name: m, density: 2650, normal_stiffness: 1e6, kratio: 2, friction: 0.4}]\n"
          "law: {stiffness: uniform}\n"
          "damping: {contact: {restitution: 0.5}}\n"
          "periodic: {min: [0, 0], max: [23.76e-3, 24.01e-3]}\n"
          "sets:\n  - {name: a, select: {box: {min: [-1, 0], max: [1, 2e-3]}}, motion: {vx: 3, vy: "
          "0}}\n"
          "  - {name: b, select: {box: {min: [-1, 11e-3], max: [1, 14e-3]}}, motion: {vx: -3, vy: "
          "0}}\n"
          "time: {end: 1}\n",
          layers_slid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_crushed_specimen_has_one_state),
        cmocka_unit_test(a_collapsing_column_has_one_state),
        cmocka_unit_test(a_periodic_shear_flow_has_one_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
