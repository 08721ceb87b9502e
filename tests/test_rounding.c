/* Energies due to rounding of positions: they do not count as errors of a scene at rest, and do not
 * hide the errors of a slow scene. */
#include "world_helpers.h"

#include "run/history_rows.h"

/* Takes `count` steps, all recorded; returns the largest residual of any row. */
static double largest_residual(gn_world *w, int64_t count) {
    gneiss_error error = {0};
    gn_history h;
    double largest = 0.0;
    if (gn_history_create_columns(w, &h, &error) != GNEISS_OK) fail_msg("%s", error.message);
    for (int64_t k = 0; k < count; k++) {
        if (gn_history_record_step(w, &h, &error) != GNEISS_OK) fail_msg("%s", error.message);
        largest = fmax(largest, fabs(gn_energy_residual(&w->ledger.reading)));
    }
    gn_history_free(&h);
    return largest;
}

/* Below this a run does not warn. */
static const double warning = 0.01;

static void elements_at_rest_beside_the_origin_close_their_ledger(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 2\nelements:\n"
                 "  rectangle: {size: [20e-3, 20e-3], cells: [4, 4], origin: [0.3, 0.3]}\n"
                 "  materials: [{young: 30e9, poisson: 0.25, density: 2500}]\n"
                 "time: {end: 1}\nrun: {threads: 1}\n");
    assert_true(largest_residual(w, 2000) < warning);
    world_end(w);
}

static void a_bonded_lattice_at_rest_far_away_closes_its_ledger(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 2\nspecimen: {lattice: {kind: hexagonal, radius: 1e-3, "
                 "cells: [10, 8], spacing: 1.01, jitter: 0.02, origin: [1, 1]}}\n"
                 "materials: [{name: m, density: 2500, kratio: 3.7, contact_modulus: 10e9, "
                 "tensile_strength: 20e6, shear_strength: 20e6}]\n"
                 "law: {stiffness: harmonic}\nbonds: {}\ntime: {end: 1}\nrun: {threads: 1}\n");
    assert_true(largest_residual(w, 5000) < warning);
    world_end(w);
}

/* An error of a twentieth of the energy: 1 mm/s, at 0.3 m, after 10000 steps. */
static void a_slow_flight_that_gains_energy_is_found(void **state) {
    (void)state;
    gn_world *w =
        world_of("dimension: 3\nspecimen: {particles: [[0.3, 0, 0, 1e-3], [0.31, 0, 0, 1e-3]]}\n"
                 "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"
                 "law: {stiffness: uniform}\n"
                 "sets: [{name: a, select: {all: true}, initial_velocity: [1e-3, 0, 0]}]\n"
                 "time: {step: 1e-6, end: 1}\nrun: {threads: 1}\n");
    assert_true(largest_residual(w, 10000) < 1e-3);
    for (int p = 0; p < 2; p++) vel_of(w, p)[0] *= sqrt(1.05);
    assert_near(largest_residual(w, 2), 0.05 / 1.05, 1e-4);
    world_end(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elements_at_rest_beside_the_origin_close_their_ledger),
        cmocka_unit_test(a_bonded_lattice_at_rest_far_away_closes_its_ledger),
        cmocka_unit_test(a_slow_flight_that_gains_energy_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
